"""crosscheck_periodic.py VOROPP_SOURCE [N] [--cgal PROGRAM]: cells in space that repeats, against voro++, a separate program, which
is compiled here; with --cgal, counts against CGAL's periodic triangulations (bench/peers/cgal_periodic.cpp).

1 to N points in boxes and triclinic cells, uniform, in a thermal crystal and with radii: volumes, and faces with a neighbour
and an area, agree to 1e-9; volumes add up to that of the cell to 1e-12. 20 cubic sets have as many vertices and tetrahedra as
CGAL finds, without weights and with. BRIO names the program. Skips itself where there is no compiler or no voro++."""

import os
import struct
import subprocess
import sys
import tempfile

from crosscheck import BRIO, TOLERANCE, Numbers, compile_driver, thermal_crystal, uniform_points
import json

TILTED, THIN = [1, 0.3, 1, 0.2, -0.4, 1], [3, 0.5, 0.5, 1.25, 0.125, 0.75]  # bx,bxy,by,bxz,byz,bz


def vectors_of(c):
    return [(c[0], 0, 0), (c[1], c[2], 0), (c[3], c[4], c[5])]


def in_cell(shares, cell):
    v = vectors_of(cell)
    return [tuple(sum(s * w[k] for s, w in zip(share, v)) for k in range(3)) for share in shares]


def cells_of_voropp(driver, folder, points, cell, radii):
    raw, heavy, listing = (os.path.join(folder, name) for name in ("points.raw", "radii.raw", "voropp.txt"))
    with open(raw, "wb") as f:
        f.write(struct.pack("<%dd" % (3 * len(points)), *(x for p in points for x in p)))
    command = [driver, raw, ",".join("%.17g" % x for x in cell)]
    if radii:
        with open(heavy, "wb") as f:
            f.write(struct.pack("<%dd" % len(radii), *radii))
        command.append(heavy)
    subprocess.run(command + ["--cells", listing], check=True, stdout=subprocess.DEVNULL)
    cells = {}
    with open(listing) as f:
        for line in f:
            site, volume, *faces = line.split()
            cells[int(site)] = float(volume), sorted((int(a), float(b)) for a, b in (face.split(":") for face in faces))
    return cells


def write_points(folder, points, radii):
    path = os.path.join(folder, "points.csv")
    with open(path, "w") as f:
        f.write("x,y,z%s\n" % (",weight" if radii else ""))
        for i, p in enumerate(points):
            f.write("%.17g,%.17g,%.17g%s\n" % (*p, ",%.17g" % radii[i] ** 2 if radii else ""))
    return path


def run_brio(command, *arguments):
    made = subprocess.run([BRIO, command, *arguments, "--json"], capture_output=True, text=True)
    if made.returncode:
        sys.exit("brio %s: %s" % (command, made.stderr))
    return json.loads(made.stdout)


def cells_of_brio(folder, points, cell, radii):
    out, faces = os.path.join(folder, "cells.csv"), os.path.join(folder, "faces.csv")
    vectors = ",".join("%.17g" % x for v in vectors_of(cell) for x in v)
    facts = run_brio("voronoi", write_points(folder, points, radii), "--cell", vectors, "-o", out, "--faces", faces)
    cells = {}
    with open(out) as f:
        next(f)
        for line in f:
            site, volume = line.split(",")[:2]
            cells[int(site)] = float(volume), []
    with open(faces) as f:
        names = next(f).strip().split(",")
        site, neighbour, area = (names.index(name) for name in ("site", "neighbour", "area"))
        for line in f:
            row = line.split(",")
            cells[int(row[site])][1].append((int(row[neighbour]), float(row[area])))
    return facts, cells


def areas(faces, neighbour):
    return sorted(area for other, area in faces if other == neighbour)


def compare(name, ours, theirs, mean):
    """Returns the greatest difference of a volume, and how many faces one result has alone, in shares of the mean cell."""
    worst, alone = 0.0, 0
    tolerance = TOLERANCE * mean ** (2 / 3)
    for site in set(ours) | set(theirs):
        volume, faces = ours.get(site, (0.0, []))
        other, others = theirs.get(site, (0.0, []))
        worst = max(worst, abs(volume - other) / mean)
        for neighbour in {n for n, _ in faces} | {n for n, _ in others}:
            a, b = ([x for x in areas(part, neighbour) if x > tolerance] for part in (faces, others))
            alone += len(a) != len(b) or any(abs(x - y) > 10 * tolerance for x, y in zip(a, b))
    right = worst <= TOLERANCE and not alone
    print("%-40s %8d cells: volumes to %.1e, %d faces differ%s" % (name, len(ours), worst, alone, "" if right else ": WRONG"))
    return right


def against_voropp(source, folder, n):
    driver, right = compile_driver(source, folder), True
    for count in sorted({1, 2, 5, 40, n}):
        for kind, cell in (("box", [1, 0, 1, 0, 0, 1]), ("wide box", [4, 0, 1, 0, 0, 2]), ("tilted", TILTED), ("thin", THIN)):
            shares = thermal_crystal(count) if count == n and kind == "box" else uniform_points(count)
            points, r = in_cell([tuple(x % 1 for x in s) for s in shares], cell), Numbers(count)
            mean = cell[0] * cell[2] * cell[5] / len(points)
            for radii in (None, [0.3 * mean ** (1 / 3) * r.uniform() for _ in points]):
                facts, ours = cells_of_brio(folder, points, cell, radii)
                theirs = cells_of_voropp(driver, folder, points, cell, radii)
                right &= compare("%s%s" % (kind, ", radii" if radii else ""), ours, theirs, mean)
                right &= abs(facts["volume"] / facts["cell_volume"] - 1) < 1e-12
    return right


def against_cgal(program, folder):
    right, text, heavy = True, os.path.join(folder, "points.txt"), os.path.join(folder, "weights.txt")
    for seed in range(20):
        r, n = Numbers(seed + 7), 50 * (seed + 1)
        points = [(r.uniform(), r.uniform(), r.uniform()) for _ in range(n)]
        if seed % 4 == 3:  # ties
            points = sorted({tuple(int(8 * x) / 8 for x in p) for p in points})
        radii = [(r.uniform() / 65) ** 0.5 for _ in points]
        with open(text, "w") as f:
            f.writelines("%.17g %.17g %.17g\n" % p for p in points)
        with open(heavy, "w") as f:
            f.writelines("%.17g\n" % x ** 2 for x in radii)
        for weighted in (False, True):
            facts = run_brio("delaunay", write_points(folder, points, radii if weighted else None), "--cell", "1,1,1")
            counts = subprocess.run([program, text, "1"] + ([heavy] if weighted else []), capture_output=True, text=True, check=True)
            same = [facts["vertices"], facts["tetrahedra"]] == [int(x) for x in counts.stdout.split()]
            print("CGAL, %5d points, weights %d: %d vertices, %d tetrahedra%s" % (
                len(points), weighted, facts["vertices"], facts["tetrahedra"], "" if same else ": WRONG, " + counts.stdout))
            right &= same
    return right


def main():
    arguments = sys.argv[1:]
    cgal = arguments.pop() if "--cgal" in arguments else None
    if cgal:
        arguments.remove("--cgal")
    with tempfile.TemporaryDirectory(prefix="brio-periodic-") as folder:
        right = against_voropp(arguments[0], folder, int(arguments[1]) if len(arguments) > 1 else 1000)
        if cgal:
            right &= against_cgal(cgal, folder)
    sys.exit(not right)


if __name__ == "__main__":
    main()
