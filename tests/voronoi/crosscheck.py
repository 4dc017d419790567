"""crosscheck.py VOROPP_SOURCE [N]: cells of brio against those of voro++, a separate program, which is compiled here.

Uniform points, a thermal crystal and weighted points in a box: volumes, and faces with a neighbour and an area, agree
to 1e-9. voro++ decides by tolerances, so faces of hardly any area may be in one result alone. BRIO names the program.
Skips itself where there is no compiler or no voro++."""

import json
import os
import shutil
import struct
import subprocess
import sys
import tempfile

BRIO = os.environ.get("BRIO", "brio")
SKIP = 77
TOLERANCE = 1e-9  # of a volume and an area, relative to those of the mean cell


def skip(reason):
    print("skipped:", reason)
    sys.exit(SKIP)


def compile_driver(source, folder):
    compiler = os.environ.get("CXX") or shutil.which("c++") or shutil.which("g++")
    if not compiler:
        skip("no C++ compiler")
    driver = os.path.join(folder, "voropp_cells")
    made = subprocess.run([compiler, "-O2", "-o", driver, source, "-lvoro++"], capture_output=True, text=True)
    if made.returncode:
        skip("voro++ (Debian: voro++-dev) cannot be used: " + made.stderr.strip().split("\n")[0])
    return driver


class Numbers:
    """Random numbers that are the same with every version of Python: a multiplicative generator modulo 2^61 - 1."""

    def __init__(self, seed):
        self.state = seed * 48271 + 11

    def uniform(self):
        self.state = self.state * 437799614237992725 % ((1 << 61) - 1)
        return self.state / ((1 << 61) - 1)

    def bell(self):
        return sum(self.uniform() for _ in range(12)) - 6


def uniform_points(n):
    r = Numbers(1)
    return [(r.uniform(), r.uniform(), r.uniform()) for _ in range(n)]


def thermal_crystal(n):
    """A face-centred cubic crystal in the unit cube, atoms displaced by 5 % of a cell in the mean."""
    r, side = Numbers(2), round((n / 4) ** (1 / 3))
    base = [(0.25, 0.25, 0.25), (0.75, 0.75, 0.25), (0.75, 0.25, 0.75), (0.25, 0.75, 0.75)]
    return [tuple((c + b + 0.05 * r.bell()) / side for c, b in zip(cell, at))
            for cell in ((i, j, k) for i in range(side) for j in range(side) for k in range(side)) for at in base]


def in_box(points):
    return [p for p in points if all(0 < x < 1 for x in p)]


def write_doubles(path, numbers):
    with open(path, "wb") as f:
        f.write(struct.pack("<%dd" % len(numbers), *numbers))


def cells_of_voropp(driver, folder, points, radii):
    raw, listing = os.path.join(folder, "points.raw"), os.path.join(folder, "voropp.txt")
    write_doubles(raw, [x for p in points for x in p])
    command = [driver, raw, "0,0,0,1,1,1", "--cells", listing]
    if radii:
        write_doubles(raw + ".radii", radii)
        command.append(raw + ".radii")
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    cells = {}
    with open(listing) as f:
        for line in f:
            words = line.split()
            cells[int(words[0])] = float(words[1]), {int(n): float(a) for n, a in (w.split(":") for w in words[2:])}
    return cells


def cells_of_brio(folder, points, radii):
    xyz, out, faces = (os.path.join(folder, name) for name in ("points.xyz", "brio.csv", "faces.csv"))
    with open(xyz, "w") as f:
        f.writelines("%r %r %r\n" % p for p in points)
    command = [BRIO, "voronoi", xyz, "-o", out, "--faces", faces, "--box", "0,0,0,1,1,1", "--json"]
    if radii:
        with open(xyz + ".weights", "w") as f:
            f.writelines("%r\n" % (r * r) for r in radii)
        command += ["--weights", xyz + ".weights"]
    facts = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
    with open(out) as f:
        cells = {int(row[0]): (float(row[1]), {}) for row in (line.split(",") for line in list(f)[1:])}
    with open(faces) as f:
        for row in (line.split(",") for line in list(f)[1:]):
            cells[int(row[0])][1][int(row[1])] = float(row[2])
    return cells, facts


def compare(name, ours, theirs, facts):
    """Prints the greatest differences; returns whether they are within the tolerance."""
    empty = {s for s, (v, _) in ours.items() if v == 0}
    volume = 1 / len(ours)
    area = volume ** (2 / 3)
    wrong_sites = (set(ours) - empty) ^ set(theirs)
    common = set(ours) & set(theirs)
    volumes = max(abs(ours[s][0] - theirs[s][0]) for s in common) / volume
    areas = faces = alone = 0
    for s in common:
        a, b = ours[s][1], theirs[s][1]
        faces += len(a)
        alone += len(set(a) ^ set(b))
        areas = max([areas, *(abs(a.get(n, 0) - b.get(n, 0)) for n in set(a) | set(b))])
    areas /= area
    error = facts["box_error"]
    print("%-28s %6d cells, %7d faces: volumes differ by %.1e of a mean cell, areas by %.1e; %d faces in one alone; "
          "sum of volumes off by %.1e" % (name, len(common), faces, volumes, areas, alone, error))
    sys.stdout.flush()
    return volumes < TOLERANCE and areas < TOLERANCE and error < 1e-12 and not wrong_sites


def main():
    source, n = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 20000
    folder = tempfile.mkdtemp(prefix="brio-voropp-")
    try:
        driver = compile_driver(source, folder)
        r, right = Numbers(3), True
        for name, points in (("uniform", in_box(uniform_points(n))), ("crystal", in_box(thermal_crystal(n)))):
            spacing = len(points) ** (-1 / 3)
            radii = [spacing * (0.2 + 0.4 * r.uniform()) for _ in points]
            for kind, weights in (("", None), (", weighted", radii)):
                ours, facts = cells_of_brio(folder, points, weights)
                right &= compare(name + kind, ours, cells_of_voropp(driver, folder, points, weights), facts)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return 0 if right else 1


if __name__ == "__main__":
    sys.exit(main())
