"""Advice that is true: every hint, every warning and every error that proposes something, evoked, and then followed.

ROWS has a row for each sentence of cli/run/sentences.h: a line that evokes it, and what follows. Following it solves the
problem, or leads to another, true, end. ERRORS has the same for the sentences of errors, in cli/ and src/, that say what to
do. The sources are searched: a sentence without a row fails the test, and so does a row without its sentence.
"""

import glob
import math
import os
import random
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from math import cos, pi, sin, sqrt

from brio_cli import CliTest, CUBE, PLY_WITH_PROPERTIES, main, OCTAHEDRON, OCTAHEDRON_FACES

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
SHARED = os.path.join(ROOT, "..", "shared", "repro")
STRINGS = r'(?:"(?:[^"\\\n]|\\.)*"\s*(?:PRI\w+\s*)?)+'
# What makes a sentence of an error an advice.
ADVISES = re.compile(r"did you mean|-\w+.* is missing|is missing(, or|: -)|needs? -|\bgive one|\bname (one of|the col)|ignores (the|both)|\bscale the|only one of --|"
                     r"write points, or|export it without|it was built without")


def joined(strings):
    strings = re.sub(r"PRI\w+", '"u"', strings)
    return "".join(re.findall(r'"((?:[^"\\\n]|\\.)*)"', strings)).replace('\\"', '"')


# Evoked by no input of a few vertices: an offset whose faults could not be mended (a large mesh that crosses itself does),
# a page for 60,000 points, an explanation of over 5,000 (test_view.py), and over 200,000 tetrahedra in tiles (test_tiles.py).
UNSEEN = {"WARNING_PROVEN", "WARNING_FILTRATION", "WARNING_EXPLAIN", "WARNING_CHOSEN"}


def sentences():
    """The rows of the table in the sources: name and sentence."""
    with open(os.path.join(ROOT, "cli", "run", "sentences.h")) as f:
        text = f.read().replace("\\\n", "")
    return {name: joined(strings) for name, strings in re.findall(r"#define ((?:HINT|WARNING)_\w+)\s+(%s)" % STRINGS, text)}


def pattern(sentence):
    """What a printed sentence matches."""
    parts = re.split(r"%[-+.*0-9lz]*[a-z]", sentence.replace("%%", "\0"))
    return ".*".join(re.escape(part.replace("\0", "%")) for part in parts)


def advising_errors():
    """Sentences of errors in the sources that say what to do."""
    found = set()
    for folder in "cli", "src":
        for path in glob.glob(os.path.join(ROOT, folder, "**", "*.[ch]"), recursive=True):
            if path.endswith(("sentences.h", "glossary.c", "manual.c")):
                continue
            with open(path) as f:
                text = re.sub(r"/\*.*?\*/", "", f.read(), flags=re.S)
            for call in re.findall(r"(?:cli_fail\w*|FAIL|brio_fail|BRIO_REQUIRE|BRIO_EXPECT|wrong|unclear\w*)\s*\((.*?);\n", text, re.S):
                found.update(s for s in map(joined, re.findall(STRINGS, call)) if ADVISES.search(s))
    return found


def explode(points, faces):
    """The same faces, each with its vertices to itself."""
    corners = [points[v] for face in faces for v in face]
    return corners, [tuple(range(3 * i, 3 * i + 3)) for i in range(len(faces))]


class Ends:
    """A line that ends with an exit code and says so in these words."""

    def __init__(self, code, words, line):
        self.code, self.words, self.line = code, words, line


class Silent:
    """A line that ends well and does not say the sentence any more."""

    def __init__(self, line):
        self.line = line


# Name: (line that evokes, exit code, what follows). A plain line ends well. {hint} is the command between the apostrophes
# of the sentence as it was printed, with the output out.ply.
ROWS = {
    "HINT_EXAMPLE": ("surface", 1, ["surface scan.ply -o surface.ply"]),
    "HINT_OUTPUTS": ("surface scan.ply -o out.xyz", 1,
                     ["surface scan.ply -o out." + e for e in "ply obj off stl vtu vtp glb".split()]),
    "HINT_DISTANCE": ("offset scan.ply -D -50 -o out.ply", 3, ["offset scan.ply -D -0.01 -o out.ply"]),
    "HINT_SOLID": ("medial few.xyz -o out.ply", 3, ["surface few.xyz -o out.ply"]),
    "HINT_CHECK": ("subdivide three.off -o out.ply", 3, [Ends(5, "not manifold", "check three.off")]),
    "HINT_LABELING": ("medial open.off -o out.ply", 3, [Silent("medial open.off --labeling global -o out.ply")]),
    "HINT_ALPHA": ("alpha few.xyz --alpha 1e-9 -o out.ply", 3,
                   ["alpha few.xyz --alpha 9 -o out.ply", "alpha few.xyz --alpha auto -o out.ply"]),
    "HINT_LEVEL": ("iso ball.map --level 9 -o out.ply", 3,
                   ["iso ball.map --level -4 -o out.ply", "iso ball.map --level 1 --sigma -o out.ply"]),
    "HINT_TRIANGLES": ("subdivide squares.off -o out.ply", 3, ["convert squares.off out.stl", "subdivide out.stl -o out.ply"]),
    "HINT_METHODS": ("surface corner.xyz -o out.ply", 3, ["help methods"]),
    "HINT_SCRATCH": ("delaunay many.ply --max-memory 20M", 4, ["delaunay many.ply --max-memory 20M --scratch ."]),
    "HINT_LIMIT": ("hull scan.ply -o out.ply --max-memory 100K --scratch .", 4,
                   ["hull scan.ply -o out.ply --max-memory 100M --scratch ."]),
    "HINT_PIECES": ("surface many.ply -o out.ply --max-memory 32M", 4,
                    ["surface many.ply -o out.ply --max-memory 32M --method cocone --pieces 30"]),
    "HINT_ESTIMATE": ("delaunay scan.ply --max-memory 3M", 4, ["{hint}"]),
    "HINT_OPEN": ("check open.off", 5, ["check open.off --open"]),
    "HINT_REPORT": ("check open.off", 5, ["{hint}"]),
    "HINT_ISO": ("iso few.xyz --level 1 -o out.ply", 2, ["surface few.xyz -o out.ply", "iso ball.map --level -4 -o out.ply"]),
    "HINT_INPUT_FORMAT": ("info few.what", 2, ["info few.what --input-format xyz",
                                               Ends(2, "line 1", "info words.doc --input-format xyz")]),
    "HINT_SURFACE": ("check scan.ply", 2, ["surface scan.ply -o out.ply", "check out.ply"]),
    "HINT_PROPERTIES": ("interpolate values.csv --at few.xyz --property p -o out.csv", 2,
                        ["{hint}", "interpolate values.csv --at few.xyz --property q -o out.csv"]),
    "HINT_HOLES": ("surface scan.ply --open 0.001 -o out.ply", 3, ["surface scan.ply --open 5 -o out.ply"]),
    "HINT_COMPONENTS": ("surface scan.ply --min-component 1e6 -o out.ply", 3, ["surface scan.ply --min-component 9 -o out.ply"]),
    "HINT_COCONE": ("surface corner.xyz -o out.ply", 3, ["surface corner.xyz -o out.ply --method cocone --boundaries"]),
    "HINT_PLANE": ("surface plane_zx.xyz -o out.ply", 3, ["{hint}"]),
    "HINT_LINE": ("surface line.xyz -o out.ply", 3, []),
    "HINT_MERGE": ("check apart.off", 5, ["{hint}", "check out.ply"]),

    "WARNING_DENSITY": ("surface sparse.ply --method cocone --density -o out.ply", 0,
                        [Silent("surface dense.ply --method cocone --density -o out.ply"),
                         Silent("surface sparse.ply --method labeled-delaunay -o out.ply")]),
    "WARNING_GUESS": ("surface cube.ply -o out.ply", 0, ["help methods", "alpha cube.ply --alpha auto -o out.ply"]),
    "WARNING_BRIDGES": ("surface half.xyz --closed -o out.ply", 0, [Silent("surface half.xyz --open auto -o out.ply")]),
    "WARNING_UNSEEN": ("check capped.ply --samples half.xyz", 0, [Silent("check part.ply --open --samples half.xyz")]),
    "WARNING_STEPS": ("surface steps.xyz -o out.ply", 0, [Silent("surface steps.xyz --noise keep -o out.ply")]),
    "WARNING_LEFT_OUT": ("check oct.off --samples scan.ply", 0, [Silent("check capped.ply --samples half.xyz")]),
    "WARNING_ASIDE": ("surface lots.xyz -o out.ply", 0, [Silent("surface lots.xyz --ignore-normals -o out.ply")]),
    "WARNING_MORE_FACES": ("simplify open.off --faces 2 -o out.ply", 0, [Silent("simplify oct.off --faces 8 -o out.ply")]),
    "WARNING_THETA": ("surface scan.ply --method cocone --theta 0.1 -o out.ply", 0,
                      [Silent("surface scan.ply --method cocone --theta 0.3 -o out.ply")]),
    "WARNING_LOST": ("convert values.ply out.off", 0, [Silent("convert values.ply out.ply")]),
    "WARNING_RENAMED": ("convert names.csv out.las", 0, [Silent("convert names.csv out.npy")]),
    "WARNING_DROPPED": ("info invalid.xyz --drop-invalid", 0,
                        ["convert invalid.xyz out.xyz --drop-invalid", Silent("info out.xyz --drop-invalid")]),
    "WARNING_MISSING": ("info cut.las --salvage", 0, [Silent("info whole.las --salvage")]),
    "WARNING_OVERRULED": ("delaunay weighted.csv --weights w.txt", 0, [Silent("delaunay weighted.csv")]),
    "WARNING_RADII": ("delaunay radii.csv", 0, [Silent("delaunay radii.csv --unweighted")]),
    "WARNING_TETRAHEDRA": ("medial ball.ply --sides both -o out.vtp", 0, [Silent("medial ball.ply --sides both -o out.vtu")]),
    "WARNING_SINGLE": ("convert far.off out.stl", 0, [Silent("convert far.off out.ply")]),
    "WARNING_DOUBLE": ("convert far.off out.ply --float32", 0, [Silent("convert far.off out.ply")]),
    "WARNING_MERGED": ("convert pair.xyz out.ply --float32", 0, [Silent("convert pair.xyz out.ply")]),
    "WARNING_MOVED": ("convert cube.ply out.npy --float32", 0, [Silent("convert cube.ply out.npy")]),
    "WARNING_CONNECTED": ("surface oct.off -o out.ply", 0, [Silent("surface ball.ply -o out.ply")]),
    "WARNING_FACES": ("medial scan.ply -o out.xyz", 0, [Silent("medial scan.ply -o out.ply")]),
    "WARNING_EDGES": ("medial scan.ply -o out.xyz", 0, [Silent("medial scan.ply -o out.ply")]),
    "WARNING_NAMES": ("delaunay values.ply -o out.node", 0, [Silent("delaunay values.ply -o out.ply")]),
    "WARNING_PROPERTIES": ("hull values.ply -o out.off", 0, [Silent("hull values.ply -o out.ply")]),
    "WARNING_IDLE_ASCII": ("generate cube -n 9 -o out.las --ascii", 0, [Silent("generate cube -n 9 -o out.las")]),
    "WARNING_RARE_DOUBLES": ("generate cube -n 9 -o out.pcd", 0, [Silent("generate cube -n 9 -o out.pcd --float32")]),
    "WARNING_IDLE_FLOAT32": ("generate cube -n 9 -o out.xyz --float32", 0, [Silent("generate cube -n 9 -o out.xyz")]),
    "WARNING_NOT_FINITE": ("interpolate missing.csv --at few.xyz --property q -o out.csv", 0,
                           [Silent("interpolate values.csv --at few.xyz --property q -o out.csv")]),
    "WARNING_COINCIDENT": ("interpolate twice.csv --at few.xyz --property q -o out.csv", 0,
                           ["convert twice.csv out.csv --merge",
                            Silent("interpolate out.csv --at few.xyz --property q -o out.npy")]),
    "WARNING_IN_PLANE": ("locate plane_zx.xyz --at few.xyz -o out.csv", 0,
                         [Silent("locate plane_zx.xyz --at few.xyz --plane fit -o out.csv")]),
    "WARNING_ON_LINE": ("locate line.xyz --at few.xyz -o out.csv", 0, [Silent("locate few.xyz --at few.xyz -o out.csv")]),
    "WARNING_BEYOND": ("alpha tiny.xyz --alpha 1 --filtration out.txt -o out.ply", 0,
                       [Silent("alpha few.xyz --alpha auto --filtration out.txt -o out.ply")]),
    "WARNING_SET_ASIDE": ("interpolate values.csv --at values.csv --property q -o out.ply", 0, ["info out.ply"]),
    "WARNING_SELF": ("surface clusters.ply --method power-crust --self-intersections -o out.ply", 0,
                     [Ends(5, "intersects itself", "check out.ply --self-intersections")]),
    "WARNING_PAGE": ("view half.xyz --points 10 -o page.html", 0, [Silent("view half.xyz -o page.html")]),
    "WARNING_COLOURS": ("surface deep.ply -o out.ply", 0, [Silent("surface deep.ply -o out.glb")]),
    "WARNING_APART": ("check apart.off --open", 0, ["{hint}", Silent("check out.ply --open")]),
    "WARNING_OUTSIDE": ("voronoi few.xyz --box 0,0,0,0.2,1,1 -o out.csv", 0,
                        ["{hint}", Silent("voronoi few.xyz --box 0,0,0,1,1,1 -o out.csv")]),
    "WARNING_CELLS": ("voronoi scan.ply --view page.html", 0, [Silent("voronoi few.xyz --box 0,0,0,1,1,1 --view page.html")]),
    "WARNING_CELL": ("voronoi atoms.extxyz -o out.csv", 0, [Silent("voronoi atoms.extxyz --periodic xyz -o out.csv")]),
    "WARNING_FULL": ("alpha few.xyz --cell 9,9,9 --alpha 1000 -o out.ply", 0, [Silent("alpha few.xyz --cell 9,9,9 --alpha auto -o out.ply")]),
    "WARNING_NUMBERED": ("info ids.xyz", 0, [Silent("info ids.xyz --columns -,x,y,z")]),
    "WARNING_ROUNDED": ("info numbers.csv", 0, [Silent("info numbers.csv --columns x,y,z,-")]),
}

# Words of a sentence: lines that evoke it with their exit code, and what follows.
ERRORS = {
    "unknown command '%s'; did you mean '%s'?": ("delauny few.xyz", 1, ["delaunay few.xyz"]),
    "unknown kind '%s'; did you mean '%s'?": ("generate cub -n 9 -o out.ply", 1, ["generate cube -n 9 -o out.ply"]),
    "--%s: unknown name '%s', expected %s; did you mean '%s'?": ("delaunay few.xyz --order hilbrt", 1,
                                                                ["delaunay few.xyz --order hilbert"]),
    "unknown option '%s'; did you mean '--%s'?": ("delaunay few.xyz --verfy", 1, ["delaunay few.xyz --verify"]),
    "--tiles needs --scratch DIR, where the tiles are": ("delaunay few.xyz --tiles 2", 1, ["delaunay few.xyz --tiles 2 --scratch ."]),
    "the vectors of the cell are too %s": ("delaunay few.xyz --cell 1e140,1e140,1e140", 1, ["delaunay few.xyz --cell 9,9,9"]),
    "--error is for the mesh: -o OUT is missing": ("balls axis.ply --error 0.01", 1, ["balls axis.ply --error 0.01 -o out.ply"]),
    "no alpha: --alpha A or --alpha auto is missing": ("alpha few.xyz -o out.ply", 1, ["alpha few.xyz --alpha auto -o out.ply"]),
    "no property: --property NAME is missing": ("interpolate values.csv --at few.xyz -o out.csv", 1,
                                                ["interpolate values.csv --at few.xyz --property q -o out.csv"]),
    "the level of the surface is missing: --level L": ("iso ball.map -o out.ply", 1, ["iso ball.map --level -4 -o out.ply"]),
    "-n chooses the resolution: give one of -n and --resolution": (
        "iso ball.map --level -4 -n 99 --resolution 9 -o out.ply", 1,
        ["iso ball.map --level -4 -n 99 -o out.ply", "iso ball.map --level -4 --resolution 9 -o out.ply"]),
    "no places: --at FILE is missing": ("locate few.xyz -o out.csv", 1, ["locate few.xyz --at few.xyz -o out.csv"]),
    "only one of --first-conflict and --all-conflicts": (
        "delaunay scan.ply --locate history --first-conflict --all-conflicts", 1,
        ["delaunay scan.ply --locate history --first-conflict"]),
    "no surface: --surface FILE is missing": ("restricted oct.off -o out.ply", 1, ["restricted oct.off --surface oct.off -o out.ply"]),
    "simplify: --faces N or --error D is missing": ("simplify oct.off -o out.ply", 1, ["simplify oct.off --faces 8 -o out.ply"]),
    "no distance: --distance D is missing": ("offset scan.ply -o out.ply", 1, ["offset scan.ply --distance 0.01 -o out.ply"]),
    "no output: -o FILE is missing": ("hull few.xyz", 1, ["hull few.xyz -o out.ply"]),
    "no output: --%s needs -o FILE": ("delaunay few.xyz --ascii", 1, ["delaunay few.xyz --ascii -o out.ply"]),
    "the number of points is missing, or too large: -n N": ("generate cube -o out.ply", 1, ["generate cube -n 9 -o out.ply"]),
    "-o - needs --format": ("delaunay few.xyz -o -", 1, ["delaunay few.xyz -o - --format ply"]),
    "-o - needs --format: vtu, npy or csv": ("voronoi few.xyz -o -", 1, ["voronoi few.xyz -o - --format csv"]),
    "; name one of these with --format": ("delaunay few.xyz -o out.doc", 1, ["delaunay few.xyz -o out.doc --format ply"]),
    "only one of --weights, --weights-mod and --unweighted can hold": (
        "delaunay few.xyz --weights-mod -9 --unweighted", 1, ["delaunay few.xyz --weights-mod -9"]),
    "only one of --rounds and --record-every": ("delaunay few.xyz --rounds --record-every 2", 1, ["delaunay few.xyz --rounds"]),
    "--unweighted ignores the property": ("delaunay negative.csv", 2, ["delaunay negative.csv --unweighted"]),
    "--unweighted ignores both, --weights FILE overrules them": (
        "delaunay both.csv", 2, ["delaunay both.csv --unweighted", "delaunay both.csv --weights w.txt"]),
    "name the columns in their order (--columns x,y,z,-": ("info survey.csv", 2, ["info survey.csv --columns -,y,x,z"]),
    "write points, or one separator that is no comma": ("info commas.txt", 2, ["info few.xyz"]),
    "the squared radii of one solid are beyond doubles: scale the points down": (
        "alpha huge.xyz --alpha auto -o out.ply", 3, ["alpha few.xyz --alpha auto -o out.ply"]),
    "are beyond doubles: scale the points up": ("alpha tiny.xyz --alpha 0 -o out.ply", 3, ["alpha few.xyz --alpha 1 -o out.ply"]),
    "doubles cannot hold vertex": ("offset vast.xyz -D 1e307 -o out.ply", 3, ["offset scan.ply -D 0.1 -o out.ply"]),
    "doubles cannot hold the distances: scale the meshes down": ("compare vast.off vast2.off", 3, ["compare oct.off oct.off"]),
    # what this build has, or files of other programs, decide: the words of these are tested with the readers
    "it was built without": None, "export it without": None,
}


class Hints(CliTest):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.sentences, cls.files = sentences(), None

    @classmethod
    def tearDownClass(cls):
        if cls.files:
            shutil.rmtree(cls.files)

    def setUp(self):
        super().setUp()
        self.subject = ""
        if not Hints.files:
            self.make_files()
            Hints.files = tempfile.mkdtemp(prefix="brio-hints-")
            shutil.copytree(self.folder, Hints.files, dirs_exist_ok=True)
        else:
            shutil.copytree(Hints.files, self.folder, dirs_exist_ok=True)

    def make_files(self):
        few = [(0.1, 0.2, 0.3), (0.9, 0.15, 0.2), (0.2, 0.8, 0.25), (0.3, 0.3, 0.95), (0.7, 0.75, 0.7)]
        self.cloud("scan.ply", 1500, "torus"), self.cloud("cube.ply", 900), self.cloud("ball.ply", 300, "sphere")
        self.expect(0, "generate", "scan", "-n", "2000", "--noise", "1", "-o", "noisy.ply", "--quiet")
        self.cloud("sparse.ply", 60, "torus")
        self.expect(0, "generate", "scan", "-n", "60000", "-o", "many.ply", "--quiet"), self.cloud("dense.ply", 1500, "torus")
        self.file("atoms.extxyz", "1\nLattice=\"2 2 2\"\nC 0 0 0\n")
        self.xyz("few.xyz", few), self.xyz("few.what", few), self.xyz("few4.xyz", few[:4]), self.xyz("corner.xyz", [(0.236, 0.103, 0.396), (0.155, 0.067, 0.402), (0.918, 0.8, 0.765), (0.222, 0.537, 0.277)])
        self.expect(0, "medial", "cube.ply", "-o", "axis.ply", "--quiet")
        self.xyz("tiny.xyz", [[x * 1e-200 for x in p] for p in few]), self.xyz("huge.xyz", [[x * 1e200 for x in p] for p in few])
        self.xyz("line.xyz", [(i, 2 * i, 3 * i) for i in range(9)]), self.xyz("one.xyz", [(1, 2, 3)] * 5)
        flat = [(a, b + a * a / 50) for a in range(6) for b in range(6)]
        for name, place in [("xy", lambda a, b: (a, b, 0)), ("yz", lambda a, b: (0, a, b)), ("zx", lambda a, b: (a, 0, b)),
                            ("oblique", lambda a, b: (a, b, a + 2 * b)), ("steep", lambda a, b: (a, 64 * a + b, 0))]:
            self.xyz("plane_%s.xyz" % name, [place(a, b) for a, b in flat])
        self.off("oct.off", OCTAHEDRON, OCTAHEDRON_FACES), self.off("open.off", OCTAHEDRON, OCTAHEDRON_FACES[:-1])
        self.off("three.off", OCTAHEDRON, OCTAHEDRON_FACES + [(0, 1, 2)])
        self.off("apart.off", *explode(OCTAHEDRON, OCTAHEDRON_FACES))
        self.off("squares.off", CUBE, [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
        self.off("far.off", [(4100000.456 + 0.1 * x, 5100000.1 + 0.1 * y, z / 10) for x, y, z in OCTAHEDRON], OCTAHEDRON_FACES)
        for name, size in ("vast.off", 1e308), ("vast2.off", 1.5e308):
            self.off(name, [[size * x for x in p] for p in OCTAHEDRON], OCTAHEDRON_FACES)
        self.xyz("half.xyz", [p for p in self.sphere(2000) if p[2] > 0]), self.cloud("clusters.ply", 300, "clusters")
        self.expect(0, "surface", "half.xyz", "--closed", "-o", "capped.ply", "--quiet")
        self.expect(0, "surface", "half.xyz", "-o", "part.ply", "--quiet")
        lots = random.Random(5)
        signed = [(p, lots.choice((-1, 1))) for p in self.sphere(2000)]
        self.file("lots.xyz", "# x y z nx ny nz\n" + "".join("%r %r %r %r %r %r\n" % (*p, *(s * x for x in p)) for p, s in signed))
        rays = [((i % 60 - 30) / 60, (i // 60 - 25) / 60) for i in range(3000)]
        deep = [round((10 + 3 * math.sin(2 * x) + 2 * x) / 0.5) * 0.5 for x, _ in rays]
        self.xyz("steps.xyz", [(x * z, y * z, z) for (x, y), z in zip(rays, deep)])
        self.xyz("vast.xyz", [[1.79e308 * x for x in p] for p in self.sphere(300)])
        self.xyz("pair.xyz", [(i % 40, i // 40, i * i % 7) for i in range(3000)] + [(0.3, 0.3, 0.3), (0.3 + 1e-12, 0.3, 0.3)])
        self.ball_map("ball.map", 12)
        self.expect(0, "convert", "ball.ply", "ball.xyz", "--quiet")
        with open(self.path("ball.xyz"), encoding="utf-8") as f:
            rows = [line for line in f if line[0] not in "#x"]
        self.file("deep.ply", "ply\nformat ascii 1.0\nelement vertex %d\n" % len(rows) + "".join(
            "property %s\n" % p for p in ("double x", "double y", "double z", "ushort red", "ushort green", "ushort blue"))
            + "end_header\n" + "".join("%s %d 1 65535\n" % (row.strip(), i) for i, row in enumerate(rows)))
        self.file("words.doc", "one two\n"), self.file("w.txt", "".join("%d\n" % (i % 3) for i in range(8)))
        corners = ["%d,%d,%d" % p for p in CUBE]
        for name, value in [("values", str), ("missing", lambda i: "NA" if i == 3 else str(i))]:
            self.file(name + ".csv", "x,y,z,q\n" + "".join("%s,%s\n" % (p, value(i)) for i, p in enumerate(corners)))
        self.file("twice.csv", "x,y,z,q\n" + "".join("%s,%d\n" % (p, i) for i, p in enumerate(corners + corners[:2])))
        self.file("weighted.csv", "x,y,z,weight\n" + "".join("%s,0.5\n" % p for p in corners))
        self.file("radii.csv", "x,y,z,radius\n" + "".join("%s,0.5\n" % p for p in corners))
        self.file("negative.csv", "x,y,z,radius\n" + "".join("%s,-1\n" % p for p in corners))
        self.file("both.csv", "x,y,z,radius,weight\n" + "".join("%s,2,3\n" % p for p in corners))
        self.file("values.ply", PLY_WITH_PROPERTIES)
        self.file("ids.xyz", "".join("%d %r %r %r\n" % (i + 1, *p) for i, p in enumerate(few)))
        self.file("numbers.csv", "x,y,z,id\n0,0,0,9007199254740993\n1,0,0,9007199254740992\n0,1,0,-36028797018963969\n")
        self.file("names.csv", "x,y,z,%s\n0,0,0,1\n1,0,0,2\n" % ("a" * 40))
        self.file("invalid.xyz", "0 0 0\nnan 0 0\n1 0 0\n0 1 0\n")
        self.expect(0, "generate", "cube", "-n", "90", "-o", "whole.las", "--quiet")
        with open(self.path("whole.las"), "rb") as f:
            self.file("cut.las", f.read()[:-100])
        self.file("survey.csv", "id;lat;lon;alt\n1;0;0;0\n2;1;0;0\n3;0;1;0\n4;0;0;1\n")
        self.file("commas.txt", "1,5 2\n")

    def command_of(self, message):
        """The command that a sentence proposes."""
        found = re.search(r"'brio (.*?)'(?: |$)", message)
        self.assertTrue(found, message)
        return found.group(1).replace("OUT", "out.ply").replace("FILE", self.subject)

    def follow(self, message, steps, words):
        for step in steps:
            code, expected = 0, None
            if isinstance(step, Ends):
                code, expected, line = step.code, step.words, step.line
            else:
                line = step.line if isinstance(step, Silent) else step
            run = self.expect(code, *shlex.split(self.command_of(message) if line == "{hint}" else line))
            if expected:
                self.assertIn(expected, run.err)
            if isinstance(step, Silent):
                self.assertNotRegex(run.err, words)

    def test_every_sentence_has_a_row(self):
        self.assertEqual(set(ROWS) | UNSEEN, set(self.sentences))

    def test_sentences_stand_in_the_table_alone(self):
        for path in glob.glob(os.path.join(ROOT, "cli", "**", "*.c"), recursive=True):
            with open(path) as f:
                text = f.read()
            self.assertEqual(re.findall(r"cli_(?:hint|warn)\(r, (?!HINT_|WARNING_)[^)]*", text), [], path)
        with open(os.path.join(ROOT, "cli", "run", "sentences.h")) as f:
            names = set(re.findall(r"#define (\w+_\w+) ", f.read())) - {"BRIO_CLI_SENTENCES_H"}
        used = set()
        for path in glob.glob(os.path.join(ROOT, "cli", "**", "*.c"), recursive=True):
            with open(path) as f:
                used |= set(re.findall(r"\b(?:HINT|WARNING)_\w+", f.read()))
        self.assertEqual(names, used)

    def test_rows(self):
        for name, (line, code, steps) in ROWS.items():
            with self.subTest(name):
                kind = "hint" if name.startswith("HINT") else "warning"
                words = "brio: %s: %s\n" % (kind, pattern(self.sentences[name]))
                self.subject = shlex.split(line)[1] if " " in line else ""
                if name == "WARNING_MISSING" and self.run_brio(*shlex.split(line)).code == 2:
                    print("skipped: %s: no reader of LAS keeps the points of a file that ends early" % name)
                    continue
                err = self.expect(code, *shlex.split(line)).err
                self.assertRegex(err, words)
                self.follow(re.search(words, err).group(0), steps, words)

    def test_errors(self):
        found = advising_errors()
        for sentence in sorted(found):
            self.assertTrue(any(key in sentence for key in ERRORS), "no row for: " + sentence)
        for key, row in ERRORS.items():
            with self.subTest(key):
                self.assertTrue([s for s in found if key in s], "no such sentence")
                if row is None:
                    continue
                line, code, steps = row
                sentence = min((s for s in found if key in s), key=len)
                err = self.expect(code, *shlex.split(line)).err
                self.assertRegex(err, pattern(sentence) if "x,y,z" not in key else re.escape(key))
                self.follow(err, steps, "")

    def test_examples_can_be_run(self):
        """An example that is given as a hint works, if there are files of its names."""
        text = self.expect(0, "--help").text
        for command in re.findall(r"(?m)^  ([a-z]+)  +\w", text.split("\nhelp:")[0]):
            run = self.run_brio(command)
            found = re.search("brio: hint: for example: brio (.*)\n", run.err)
            self.assertTrue(found, command)
            arguments = shlex.split(found.group(1))
            for name, source in [("points.ply", "cube.ply"), ("surface.ply", "oct.off"), ("truth.ply", "oct.off"),
                                 ("mesh.ply", "oct.off"), ("samples.ply", "oct.off"), ("atoms.xyz", "cube.ply"), ("places.xyz", "few.xyz")]:
                self.expect(0, "convert", source, name, "--quiet")
            self.file("stations.csv", "x,y,z,temperature\n" + "".join("%d,%d,%d,%d\n" % (*p, i) for i, p in enumerate(CUBE)))
            self.ball_map("emd_1234.map", 12)
            self.file("ground.csv", "x,y,z,classification\n" + "".join("%d,%d,%d,2\n" % p for p in CUBE))
            self.expect(0, "convert", "ground.csv", "survey.laz", "--quiet")
            if "scan.laz" in arguments:  # which brio does not write
                arguments = ["convert", "scan.ply", "out.ply"]
            if command == "generate":
                arguments[arguments.index("-n") + 1] = "600"
            self.expect(0, *arguments)

    # --- classes ---

    def test_flat_points_are_told_what_helps_whatever_was_tried(self):
        tries = [["surface", "--method", m] for m in ("labeled-delaunay", "power-crust", "cocone", "tight-cocone")]
        tries += [["alpha", "--alpha", "auto"], ["alpha", "--alpha", "1"], ["medial"], ["offset", "-D", "0.1"]]
        for name in "xy", "yz", "zx", "oblique", "steep":
            for command, *options in tries:
                run = self.run_brio(command, "plane_%s.xyz" % name, *options, "-o", "out.ply")
                if name == "oblique" and run.code == 0:  # its coordinates are rounded, and so it has a thickness
                    continue
                if name == "steep" and run.code == 0:  # six short rows far apart: these are curves, too
                    self.assertTrue(command == "medial" or "power-crust" in options, options)
                    continue
                self.assertEqual(run.code, 3, run.err)
                err = run.err
                hints = re.findall("brio: hint: (.*)\n", err)
                self.assertEqual(len(hints), 1, err)
                self.assertGreaterEqual(self.facts(*shlex.split(self.command_of(hints[0])))["triangles"], 50, hints)
        for name in "line", "one":
            for command, *options in tries:
                err = self.expect(3, command, name + ".xyz", *options, "-o", "out.ply").err
                self.assertEqual(re.findall("brio: hint: (.*)\n", err), [self.sentences["HINT_LINE"]], name)

    def test_no_hint_proposes_what_was_done(self):
        for line, code, words in [("alpha few.xyz --alpha auto -o out.ply", 0, "--alpha auto"),
                                  ("surface few4.xyz --method cocone --pieces 3 --max-memory 1K -o out.ply", 4, "--pieces"),
                                  ("info scan.ply --max-memory 1K", 4, "brio info"),
                                  ("convert scan.ply out.xyz --max-memory 1K", 4, "brio info"),
                                  ("delaunay scan.ply --max-memory 1K --scratch .", 4, "--scratch"),
                                  ("medial squares.off --labeling global -o out.ply", 3, "--labeling global"),
                                  ("check open.off", 5, "--merge"), ("check three.off", 5, "--open")]:
            run = self.expect(code, *shlex.split(line))
            self.assertNotRegex(run.err, "hint: .*" + words, line)

    def test_an_open_surface_of_the_hint_is_open(self):
        half = [p for p in self.sphere(2000) if p[2] > 0]
        self.xyz("half.xyz", half)
        for given in [("--boundaries",), ()]:
            certificate = self.facts("surface", "half.xyz", "--method", "cocone", *given, "-o", "out.ply")["certificate"]
            self.assertEqual((certificate["closed"], certificate["boundary_loops"]), (False, 1))
            self.assertAlmostEqual(certificate["area"], 6.283, delta=0.2)

    def test_sampling_density_tells_good_from_bad(self):
        warns = lambda *a: bool(re.search("hardly show", self.expect(0, *a, "--method", "cocone", "--density", "-o", "out.ply").err))
        self.xyz("half.xyz", [p for p in self.sphere(2000) if p[2] > 0])
        self.expect(0, "generate", "scan", "-n", "20000", "-o", "a.ply", "--quiet")
        self.expect(0, "generate", "scan", "-n", "1000", "-o", "b.ply", "--quiet")
        self.assertFalse(warns("surface", "half.xyz"))
        self.assertFalse(warns("surface", "a.ply"))
        self.assertTrue(warns("surface", "b.ply"))
        self.assertTrue(warns("surface", "sparse.ply"))
        self.assertTrue(warns("surface", "cube.ply"))

    def test_density_of_shapes(self):
        shapes = os.path.join(SHARED, "field", "shapes.py")
        if not os.path.exists(shapes):
            self.skipTest("no generator of shapes beside the project")
        for kind in "hemisphere", "indoor", "frame":
            subprocess.run([sys.executable, shapes, kind, self.path("shape.xyz")], check=True, stdout=subprocess.DEVNULL)
            run = self.expect(0, "surface", "shape.xyz", "--method", "cocone", "--density", "-o", "out.ply")
            self.assertNotIn("hardly show", run.err, kind)

    def test_noise_is_better_with_the_method_of_the_warning(self):
        self.expect(0, "generate", "scan", "-n", "20000", "--noise", "0.6", "-o", "a.ply", "--quiet")
        run = self.expect(0, "surface", "a.ply", "--method", "cocone", "--density", "-o", "out.ply")
        self.assertIn("with noise --method labeled-delaunay", run.err)
        self.assertEqual(self.facts("surface", "a.ply", "-o", "out.ply")["certificate"]["genus"], 3)

    def test_numbers_of_rows_are_not_coordinates(self):
        for first in 0, 1:
            for order in ([3, 0, 4, 2, 1], range(5)):
                self.file("n.xyz", "".join("%d 0.%d 0.5 0.2\n" % (i + first, i) for i in order))
                self.assertIn("numbers the rows", self.expect(0, "info", "n.xyz").err)
        for rows in ["0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 1 9\n", "1 0 0\n2 0 0\n3 1 0\n4 1 1\n", "1 0 0 9\n2 0 0 9\n4 1 0 9\n5 1 1 9\n",
                     "x y z q\n1 0 0 9\n2 0 0 9\n3 1 0 9\n4 1 1 9\n", "1.5 0 0 9\n2 0 0 9\n3 1 0 9\n4 1 1 9\n"]:
            self.file("n.xyz", rows)
            self.assertNotIn("numbers the rows", self.expect(0, "info", "n.xyz").err, rows)

    def test_every_command_that_reads_points_says_so(self):
        for line in ["delaunay ids.xyz", "surface ids.xyz -o out.ply", "hull ids.xyz -o out.ply", "convert ids.xyz out.ply",
                     "voronoi ids.xyz -o out.csv", "locate few.xyz --at ids.xyz -o out.csv", "info ids.xyz"]:
            self.assertIn("ids.xyz: its first column numbers the rows", self.expect(0, *line.split()).err, line)
            if not line.startswith("locate"):
                self.assertNotIn("numbers", self.expect(0, *line.split(), "--columns", "-,x,y,z").err, line)

    def test_sites_of_voro(self):
        path = os.path.join(SHARED, "reports", "voro_ids.xyz")
        if not os.path.exists(path):
            self.skipTest("no reports beside the project")
        self.expect(0, "voronoi", path, "--box", "0,0,0,1,1,1", "--columns", "-,x,y,z", "-o", "out.csv")
        with open(self.path("out.csv")) as f:
            volumes = [float(line.split(",")[1]) for line in f.readlines()[1:]]
        for volume, right in zip(volumes, [0.157, 0.231, 0.155, 0.184, 0.271]):
            self.assertAlmostEqual(volume, right, delta=0.0006)
        err = self.expect(0, "voronoi", path, "--box", "0,0,0,1,1,1", "-o", "out.csv").err
        self.assertIn("5 of 5 points are outside the box" if "5 of 5" in err else "4 of 5 points are outside the box", err)

    def test_a_cube_in_parts(self):
        path = os.path.join(SHARED, "reports", "split_cube.obj")
        if not os.path.exists(path):
            self.skipTest("no reports beside the project")
        self.assertIn("16 vertices are at the positions of others", self.expect(5, "check", path).err)
        done = self.facts("convert", path, "out.ply", "--merge")
        self.assertEqual((done["points"], done["merged_vertices"], done["degenerate"]), (8, 16, 0))
        self.assertTrue(self.facts("check", "out.ply")["certificate"]["closed"])

    def test_whole_numbers_that_doubles_do_not_hold(self):
        facts = self.facts("convert", "numbers.csv", "out.ply")
        self.assertEqual(facts["lost"], ["precision"])
        self.assertRegex(facts["warnings"][-1] + facts["warnings"][0], r"line 2: .*\(column id; 2 in all\)")
        self.file("exact.csv", "x,y,z,id\n0,0,0,9007199254740992\n1,0,0,-18014398509481984\n0,1,0,1e300\n9007199254740994,0,0,1\n")
        self.assertEqual(self.facts("convert", "exact.csv", "out.ply")["lost"], [])
        self.file("axis.xyz", "0 0 0\n0 36028797018963969 0\n")
        self.assertRegex(self.expect(0, "info", "axis.xyz").err, r"line 2: .*\(column y; 1 in all\)")


if __name__ == "__main__":
    main()
