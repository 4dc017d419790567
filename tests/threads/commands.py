"""The program's parallel work, with more threads than processors, under the thread sanitizer: no race is reported, and every
output has the bytes of one thread.

commands.py [--long]. BRIO names the program, built with the option BRIO_STRESS: threads give way at random, and share little work,
too. The short version tries one number of threads and holds that nothing fails; the long one tries more, on larger inputs, and
compares the files with those of one thread.
"""

import os
import subprocess
import sys
import tempfile

BRIO = os.environ["BRIO"]
LONG = "--long" in sys.argv
TEAMS = (2, 3, 8) if LONG else (3,)
MANY = 4000 if LONG else 1200
FEW = 900 if LONG else 400
RACE = 66  # the sanitizer's exit status

# Inputs, made by one thread: name, arguments.
INPUTS = [
    ("ball.ply", "generate ball -n %d" % MANY),
    ("torus.ply", "generate torus -n %d" % MANY),
    ("few.ply", "generate torus -n %d --seed 2" % FEW),
    ("scan.ply", "generate scan -n %d --noise 0.6 --views 4" % (2 * FEW)),
    ("places.ply", "generate cube -n %d" % MANY),
    ("solid.ply", "generate solid --resolution %d" % (48 if LONG else 24)),
    ("cloud.las", "convert torus.ply"),
    ("grid.ply", "generate grid -n %d" % MANY),
    ("surface.ply", "surface few.ply"),
    ("fine.ply", "subdivide surface.ply --levels 1"),
    ("small.ply", "simplify surface.ply --faces 900"),
]

# Outputs, made by one thread and by several: the line's files beside -o are named with @, which is the folder of the run.
COMMANDS = [
    ("p.ply", "generate torus -n %d" % MANY),
    ("p.ply", "generate scan -n %d --views 3 --truth @truth.ply --truth-resolution 20" % FEW),
    ("p.ply", "generate depth -n %d" % FEW),
    ("p.ply", "generate solid --kind machined --resolution 24 --seed 3"),
    ("p.ply", "generate solid --kind implicit --resolution 20 --seed 4"),
    ("t.vtu", "delaunay ball.ply --verify --compress"),
    ("t.ply", "delaunay ball.ply --weights-mod -16"),
    ("t.node", "delaunay grid.ply --order brio-octree --neighbors --faces --edges"),
    ("t.vtu", "delaunay torus.ply --order brio-kdtree"),
    ("t.vtu", "delaunay ball.ply --order octree"),
    ("t.ply", "delaunay ball.ply --plane xy"),
    ("c.vtu", "voronoi ball.ply --box 0,0,0,1,1,1"),
    ("c.csv", "voronoi torus.ply --faces @faces.csv"),
    ("c.npy", "voronoi grid.ply --weights-mod -16"),
    ("l.csv", "locate ball.ply --at places.ply"),
    ("i.csv", "interpolate values.csv --at places.ply --property q"),
    ("i.csv", "interpolate values.csv --at places.ply --property q --method linear"),
    ("z.ply", "iso atoms.pdb --level 0.3"),
    ("s.ply", "surface torus.ply --simplify --self-intersections --vertex-normals"),
    ("s.vtp", "surface scan.ply --noise smooth --normals @n.ply --compress"),
    ("s.ply", "surface scan.ply --noise keep --open 4"),
    ("s.ply", "surface few.ply --method power-crust --polygons"),
    ("s.ply", "surface few.ply --method power-crust -R 0.5 --open 4 --simplify"),
    ("s.ply", "surface scan.ply --method power-crust --labeling greedy"),
    ("s.ply", "surface few.ply --method power-crust --labeling theoretical"),
    ("s.ply", "surface torus.ply --method cocone --boundaries --density"),
    ("s.ply", "surface scan.ply --method cocone --pieces 4"),
    ("s.ply", "surface few.ply --method cocone --extraction pruned"),
    ("s.ply", "surface few.ply --method tight-cocone"),
    ("m.ply", "medial few.ply --simplify --crust @crust.ply"),
    ("m.ply", "medial solid.ply --sides both"),
    ("o.ply", "offset few.ply -D 0.05"),
    ("h.ply", "hull ball.ply"),
    ("a.ply", "alpha ball.ply -A auto --filtration @f.txt"),
    ("d.ply", "subdivide solid.ply --levels 1"),
    ("v.las", "convert cloud.las"),
    ("v.ply", "convert cloud.las --thin 0.05"),
    ("v.ply", "convert scan.ply --drop-outliers 8"),
    ("v.vtp", "convert fine.ply --compress"),
    ("", "compare surface.ply fine.ply"),
    ("", "check fine.ply --self-intersections"),
]


def write_texts(folder):
    """Inputs that the program does not generate: points with a property, atoms."""
    places = [((i * 37) % 101 / 101, (i * 53) % 211 / 211, (i * 71) % 307 / 307) for i in range(FEW)]
    with open(os.path.join(folder, "values.csv"), "w") as f:
        f.write("x,y,z,q\n" + "".join("%r,%r,%r,%r\n" % (x, y, z, x * y - z) for x, y, z in places))
    with open(os.path.join(folder, "atoms.pdb"), "w") as f:
        for i, (x, y, z) in enumerate(places[:40]):
            f.write("ATOM  %5d  C   ALA A%4d    %8.3f%8.3f%8.3f  1.00  0.00           C\n"
                    % (i + 1, i + 1, 9 * x, 9 * y, 9 * z))
        f.write("END\n")


def run(folder, inputs, output, line, threads):
    """The exit status, what the sanitizer said, and the bytes that the run wrote, by file."""
    command = [os.path.join(inputs, w) if os.path.exists(os.path.join(inputs, w)) else w.replace("@", folder + "/")
               for w in line.split()]
    command = [BRIO] + command + ["--quiet", "--threads", str(threads)]
    if output:
        command += ["-o", os.path.join(folder, output)]
    done = subprocess.run(command, capture_output=True)
    files = {}
    for name in sorted(os.listdir(folder)):
        with open(os.path.join(folder, name), "rb") as f:
            files[name] = f.read()
        if folder != inputs:
            os.remove(os.path.join(folder, name))
    return done.returncode, done.stderr.decode(errors="replace"), files


def main():
    failures = 0
    os.environ["BRIO_STRESS"] = "1"
    with tempfile.TemporaryDirectory(prefix="brio-threads-") as top:
        inputs, folder = os.path.join(top, "in"), os.path.join(top, "out")
        os.mkdir(inputs)
        os.mkdir(folder)
        write_texts(inputs)
        for name, line in INPUTS:
            code, said, _ = run(inputs, inputs, name, line, 1)
            if code:
                sys.exit("%s: exit %d: %s" % (line, code, said))
        for output, line in COMMANDS:
            expected = run(folder, inputs, output, line, 1) if LONG else None
            for threads in TEAMS:
                found = run(folder, inputs, output, line, threads)
                expected = expected or found
                ok = found[0] == expected[0] != RACE and found[0] in (0, 5) and found[2] == expected[2]
                failures += not ok
                if not ok:
                    print("FAILED %s, %d threads: exit %d, of one thread %d, %s\n%s%s"
                          % (line, threads, found[0], expected[0],
                             [n for n in expected[2] if found[2].get(n) != expected[2][n]], expected[1][:200], found[1][:6000]))
            print("%s %s" % ("ok" if not failures else "--", line), flush=True)
    print("%d commands, %d failures" % (len(COMMANDS), failures))
    sys.exit(failures != 0)


main()
