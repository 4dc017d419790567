"""The runs that are given faults: small inputs, and command lines over all commands, formats and ways.

In a command line {i} is the folder of inputs, {o} that of outputs, {s} that of scratch files."""

import os
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]


def extensions():
    """What the first byte of a file of tests/fuzz/corpus/read says: places in the list of corpus.h. None: a wrapping."""
    text = (ROOT / "tests/unit/corpus.h").read_text(encoding="utf-8")
    names = re.search(r"corpus_names\[CORPUS_CHOICES\] = \{(.*?)\};", text, re.S).group(1)
    return [name or None for name in re.findall(r'"a\.(\w+)"|NULL', names)]


MADE = [
    "generate sphere -n 150 -o sphere.ply", "generate cube -n 120 -o cube.xyz", "generate grid -n 5 -o grid.xyz",
    "generate ball -n 60 -o ball.npy", "generate scan -n 300 -o scan.ply", "generate sphere -n 600 -o big.ply",
    "generate cube -n 9000 -o thousands.ply", "generate torus -n 400 -o torus.xyz --ascii",
    "surface sphere.ply -o mesh.ply", "surface sphere.ply -o mesh.off", "hull cube.xyz -o hull.obj",
    "delaunay cube.xyz -o solid.node", "delaunay cube.xyz -o solid.vtu", "generate sphere -n 2500 -o more.ply",
]


def make_inputs(brio, folder, corpus):
    """Fills the folder with inputs. Returns the names of the files that are one of each format."""
    for line in MADE:
        subprocess.run([brio, *line.split(), "--quiet"], cwd=folder, check=True)
    with open(os.path.join(folder, "weights.txt"), "w", encoding="ascii") as f:
        f.writelines("%d.5\n" % (i % 7) for i in range(120))
    with open(os.path.join(folder, "valued.csv"), "w", encoding="ascii") as f:
        f.write("x,y,z,height\n" + "".join("%d,%d,%d,%d.25\n" % (i % 4, i // 4 % 4, i * i % 11, i) for i in range(40)))
    with open(os.path.join(folder, "atoms.pdb"), "w", encoding="ascii") as f:
        for i in range(4):
            f.write("ATOM  %5d  C   ALA A   1    %8.3f%8.3f%8.3f  1.00  0.00           C\n" % (i, i, i % 2, 0))
        f.write("END\n")
    formats, known = [], extensions()
    for name in sorted(os.listdir(corpus)):
        with open(os.path.join(corpus, name), "rb") as f:
            choice, content = f.read(1)[0], f.read()
        if choice < len(known) and known[choice]:
            file = "%s.%s" % (name, known[choice])
            with open(os.path.join(folder, file), "wb") as f:
                f.write(content)
            if subprocess.run([brio, "info", file], cwd=folder, capture_output=True).returncode == 0:
                formats.append(file)
    return formats


COMMANDS = """
delaunay {i}/cube.xyz -o {o}/a.vtu --json
delaunay {i}/cube.xyz -o {o}/a.ply --json --verify
delaunay {i}/grid.xyz -o {o}/a.node --neighbors --faces --edges --json
delaunay {i}/cube.xyz --weights {i}/weights.txt -o {o}/a.vtu --json
delaunay {i}/grid.xyz --weights-mod 2 --json
delaunay {i}/cube.xyz --plane xy -o {o}/a.ply --json
delaunay {i}/cube.xyz --order octree --locate history --json
delaunay {i}/cube.xyz --order brio-kdtree --locate jump --rounds --json
delaunay {i}/cube.xyz --order random --locate hierarchy --json
delaunay {i}/mesh.ply --locate trace --json
delaunay {i}/cube.xyz -o - --format ply --quiet
delaunay {i}/cube.xyz
surface {i}/sphere.ply -o {o}/a.ply --json
surface {i}/scan.ply -o {o}/a.stl --noise smooth --open 4 --normals {o}/n.ply --json
surface {i}/sphere.ply -o {o}/a.vtp --simplify --vertex-normals --self-intersections --json
surface {i}/sphere.ply -o {o}/a.obj --method power-crust --json
surface {i}/sphere.ply -o {o}/a.off --method power-crust --labeling greedy --sharp --polygons --json
surface {i}/sphere.ply -o {o}/a.off --labeling naive --json
surface {i}/sphere.ply -o {o}/a.off --labeling theoretical --json
surface {i}/sphere.ply -o {o}/a.ply --method cocone --json
surface {i}/sphere.ply -o {o}/a.ply --method cocone --extraction walk --boundaries --density --json
surface {i}/big.ply -o {o}/a.ply --method cocone --pieces 3 --json
surface {i}/sphere.ply -o {o}/a.glb --method tight-cocone --json
medial {i}/sphere.ply -o {o}/a.vtp --simplify --crust {o}/c.ply --json
medial {i}/mesh.ply -o {o}/a.xyz --json
offset {i}/sphere.ply --distance 0.1 -o {o}/a.ply --json
offset {i}/mesh.ply --distance 0.1 --simplify -o {o}/a.ply --json
voronoi {i}/cube.xyz -o {o}/a.vtu --json
voronoi {i}/cube.xyz --weights {i}/weights.txt --box 0,0,0,1,1,1 -o {o}/a.csv --faces {o}/f.csv --json
voronoi {i}/cube.xyz -o {o}/a.npy --json
hull {i}/cube.xyz -o {o}/a.ply --json
hull {i}/grid.xyz --polygons -o {o}/a.off --json
alpha {i}/cube.xyz --alpha auto -o {o}/a.ply --filtration {o}/f.txt --json
alpha {i}/cube.xyz --alpha 0.05 -o {o}/a.ply --filtration {o}/f.sparse --json
interpolate {i}/valued.csv --at {i}/cube.xyz --property height -o {o}/a.csv --json
interpolate {i}/valued.csv --at {i}/cube.xyz --property height --method linear -o {o}/a.ply --json
locate {i}/cube.xyz --at {i}/grid.xyz -o {o}/a.csv --json
locate {i}/cube.xyz --at {i}/grid.xyz -o {o}/a.npy --json
locate {i}/cube.xyz --at {i}/grid.xyz -o - --format csv
iso {i}/atoms.pdb --level 1 --resolution 8 -o {o}/a.ply --json
iso {i}/atoms.pdb --level 0.5 --resolution 6 --delaunay-conforming -o {o}/a.ply --json
subdivide {i}/mesh.ply -o {o}/a.ply --json
simplify {i}/mesh.ply --faces 20 -o {o}/a.ply --json
check {i}/mesh.ply --self-intersections --json
check {i}/solid.node --json
check {i}/solid.vtu
compare {i}/mesh.ply {i}/mesh.off --samples 200 --json
info {i}/cube.xyz --json
info {i}/mesh.ply
generate sphere -n 90 -o {o}/a.las --json
generate scan -n 60 -o {o}/a.vtp --compress --json
convert {i}/cube.xyz {o}/a.ply --json
convert {i}/sphere.ply {o}/a.las --json
convert {i}/mesh.ply {o}/a.glb --json
convert {i}/mesh.ply {o}/a.vtu --compress --json
convert {i}/mesh.ply {o}/a.stl --json
convert {i}/cube.xyz {o}/a.xyz --thin 0.2 --drop-outliers 8 --crop 0,0,0,1,1,1 --json
convert {i}/cube.xyz {o}/a.npy --json
convert {i}/cube.xyz {o}/a.e57 --json
convert {i}/cube.xyz {o}/a.ptx --json
convert {i}/ball.npy {o}/a.node --json
convert {i}/cube.xyz - --format xyz --quiet
help surface
delaunay --help
--version
""".strip().splitlines()

# With the big arrays in scratch files.
SCRATCH = """
delaunay {i}/big.ply -o {o}/a.vtu --scratch {s} --json
delaunay {i}/big.ply --scratch {s} --max-memory 4M --threads 2 --json
delaunay {i}/big.ply --weights-mod 1 -o {o}/a.ply --scratch {s} --json
surface {i}/sphere.ply -o {o}/a.ply --scratch {s} --json
surface {i}/sphere.ply -o {o}/a.ply --method power-crust --scratch {s} --json
surface {i}/big.ply -o {o}/a.ply --method cocone --pieces 3 --scratch {s} --json
voronoi {i}/cube.xyz -o {o}/a.vtu --scratch {s} --json
convert {i}/mesh.ply {o}/a.vtu --scratch {s} --json
""".strip().splitlines()

# Large enough for two threads.
THREADS = """
delaunay {i}/thousands.ply --threads 4 --json
surface {i}/more.ply --threads 4 -o {o}/a.ply --json
surface {i}/more.ply --threads 4 --method cocone -o {o}/a.ply --json
surface {i}/more.ply --threads 4 --method power-crust -o {o}/a.ply --json
voronoi {i}/thousands.ply --threads 4 -o {o}/a.npy --json
convert {i}/thousands.ply {o}/a.ply --threads 4 --thin 0.05 --drop-outliers 8 --json
""".strip().splitlines()
