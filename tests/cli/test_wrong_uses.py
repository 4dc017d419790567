"""A table of wrong uses: each ends with its exit code, with a sentence that names what is wrong, and changes no file."""

import gzip
import io
import os
import re
import struct
import subprocess
import zipfile

import formats
from brio_cli import BRIO, CliTest, CUBE, FLAT, FLAT_RIGHT, main, OCTAHEDRON, OCTAHEDRON_FACES

HERE = os.path.dirname(os.path.abspath(__file__))
PNG = bytes.fromhex("89504e470d0a1a0a0000000d49484452000000010000000108060000001f15c489"
                    "0000000d49444154789c6360000002000001e221bc330000000049454e44ae426082")
MANY = 2**63
SECONDS = 30  # within which every run must end
EXTENSIONS = [kind["format"] for kind in formats.formats()]


def pcd(data, points=2, body=b""):
    return ("# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH %d\nHEIGHT 1\n"
            "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS %d\nDATA %s\n" % (points, points, data)).encode() + body


def ptx(points="2\n1\n"):
    return (points + "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 0.5\n4 5 6 0.5\n").encode()


def npy(shape, kind="'<f8'", body=b""):
    header = "{'descr': %s, 'fortran_order': False, 'shape': %s, }" % (kind, shape)
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", 118) + header.ljust(117).encode() + b"\n" + body


def e57_header(pages=1, xml=48, length=100):
    return (b"ASTM-E57" + struct.pack("<2I4Q", 1, 0, 1024 * pages, xml, length, 1024)).ljust(1024, b"\0")


def archive():
    """A ZIP in a ZIP."""
    inner, outer = io.BytesIO(), io.BytesIO()
    for stream, content in ((inner, b"0 0 0\n"), (outer, inner.getvalue)):
        with zipfile.ZipFile(stream, "w") as z:
            z.writestr("a.zip", content if isinstance(content, bytes) else content())
    return outer.getvalue()


# Files of the table, beside those that setUp makes with functions of CliTest.
FILES = {
    "cols.xyz": "0 0\n1 1\n", "word.xyz": "0 0 0\n1 x 0\n", "nan.xyz": "0 0 0\nnan 0 0\n0 inf 0\n", "two.xyz": "0 0 0\n1 1 1\n",
    "row.csv": "x,y,z\n1,2\n", "weights.txt": "1\n2\n", "nan.txt": "1\nnan\n" + "1\n" * 6, "doc.what": "0 0 0\n",
    "face.off": "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "face.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
    "corner.node": "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n", "corner.ele": "1 4 0\n0 0 1 2 4\n",
    "alone.ele": "1 4 0\n0 0 1 2 3\n", "dimension.node": "1 2 0 0\n0 0 0\n",
    "many.ply": "ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty double x\nproperty double y\n"
                "property double z\nend_header\n" % MANY,
    "corners.ply": "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
                   "element face 1\nproperty list uint int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n4294967295 0 1 2\n",
    "noz.ply": "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\nend_header\n0 0\n",
    "many.off": "OFF\n%d 0 0\n0 0 0\n" % MANY, "many.node": "%d 3 0 0\n0 0 0 0\n" % MANY, "many.ptx": ptx("%d\n1\n" % MANY),
    "many.pcd": pcd("binary", MANY), "text.pcd": pcd("ascii", MANY), "lzf.pcd": pcd("binary_compressed", MANY),
    "sizes.pcd": pcd("binary_compressed", 2, struct.pack("<II", 2**32 - 1, 24)),
    "plain.pcd": pcd("binary_compressed", 2, struct.pack("<II", 4, 2**32 - 1) + bytes(4)),
    "more.pcd": pcd("ascii", 1, b"1 2 3\n4 5 6\n"), "zip.pcd": pcd("zip"),
    "many.npy": npy("(%d, 3)" % MANY), "flat.npy": npy("(6,)", body=bytes(48)), "object.npy": npy("(6, 3)", "'|O'"),
    "columns.npy": npy("(3, 2)", body=bytes(48)), "many.stl": bytes(80) + struct.pack("<I", 2**32 - 1) + bytes(50),
    "many.las": b"LASF" + bytes(20) + b"\1\4" + bytes(68) + struct.pack("<HII", 375, 375, 0) + b"\0" +
                struct.pack("<HI", 20, 0) + bytes(20) + struct.pack("<6d", *[1] * 6) + bytes(68) + struct.pack("<Q", MANY) +
                bytes(120),
    "cut.e57": e57_header(pages=MANY // 1024), "sum.e57": e57_header(), "version.e57": b"ASTM-E57" + b"\2" * 40,
    "more.off": "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 2 1\n", "more.stl": bytes(80) + struct.pack("<I", 1) + bytes(100),
    "more.node": "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 0 0 2\n", "tail.node": "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n", "tail.ele": "1 4 0\n0 0 1 2 3\n1 0 1 2 3\n",
    "more.ply": "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
                "end_header\n0 0 0\n1 0 0\n2 0 0\n",
    "twice.xyz.gz": gzip.compress(gzip.compress(b"0 0 0\n")), "zip.ply": archive(), "zip.las": archive(), "a.zip": archive(),
}

# The line behind `brio`, the exit code, and words of the message. {old} is an output that is there, {new} one that is not.
INPUTS = [
    ("missing.ply", "missing.ply: No such file"), ("no/a.ply", "no/a.ply: No such file"), ("folder", "folder: Is a directory"),
    ("folder.ply", "folder.ply: Is a directory"), ("cube.xyz/", "cube.xyz/: Not a directory"),
    ("doc.what", "doc.what: unknown format, expected"), ("a.zip", "a.zip: a zip archive without arrays"), ("twice.xyz.gz", "twice.xyz.gz, decompressed: it is compressed again"),
    ("zip.ply", "zip.ply: "), ("zip.las", "zip.las: a zip archive without arrays"),
    ("cols.xyz", "cols.xyz: line 1: expected 3 numbers, found 2"), ("word.xyz", "word.xyz: line 2: expected a number, found"),
    ("row.csv", "row.csv: line 2: expected 3 numbers, found 2"),
    ("nan.xyz", "nan.xyz: point 1: x is NaN (2 such points in all)"), ("face.off", "face.off: face 0", "index 7"),
    ("face.obj", "face.obj: face 0", "index 9"), ("corner.node", "corner.ele: line 2: corner 4"),
    ("alone.ele", "alone.node: No such file"), ("dimension.node", "dimension.node: 2 dimensions, expected 3"),
    ("many.ply", "many.ply: the header promises"), ("corners.ply", "corners.ply: ends at byte"), ("noz.ply", "noz.ply: ", " z"),
    ("many.off", "many.off: line 2: the number of vertices"), ("many.node", "many.node: line 1: "),
    ("many.ptx", "many.ptx: line 1: the number of columns"), ("many.pcd", "many.pcd: the header promises"),
    ("text.pcd", "text.pcd: the header promises"), ("lzf.pcd", "lzf.pcd: ", "4 GiB at most"),
    ("sizes.pcd", "sizes.pcd: the size of the data promises"), ("plain.pcd", "plain.pcd: byte ", "the header announces 24"),
    ("more.pcd", "more.pcd: line 13: a row behind point 1 of 1"), ("zip.pcd", "zip.pcd: line 11: expected DATA ascii"),
    ("more.off", "more.off: line 7: a row behind face 1 of 1"), ("more.node", "more.node: line 6: a row behind point 4 of 4"),
    ("tail.node", "tail.ele: line 3: "), ("more.ply", "more.ply: line 10: a row behind vertex 2 of 2"),
    ("more.stl", "more.stl: byte 80: 1 triangles are announced"),
    ("many.npy", "many.npy: the header promises"), ("flat.npy", "flat.npy: byte ", "shape"),
    ("object.npy", "object.npy: byte ", "expected a type"), ("columns.npy", "columns.npy: byte ", "3 to 4096 columns"),
    ("many.stl", "many.stl: the header promises"), ("many.las", "many.las: the header promises"),
    ("cut.e57", "cut.e57: ends at byte 1024, its header announces"),
    ("version.e57", "version.e57: byte 8: version"),
    ("cube.xyz --input-format ply", "cube.xyz: line 1: expected ply"),
    ("cube.xyz --input-format las", "cube.xyz: byte 0: expected LASF"),
    ("cube.xyz --input-format e57", "cube.xyz: ", "E57"),
    ("cube.xyz --input-format npy", "cube.xyz: "), ("cube.xyz --input-format stl", "cube.xyz: "),
]

USES = [
    # outputs
    ("delaunay cube.xyz -o folder.ply", 6, "folder.ply: is a folder"),
    ("delaunay cube.xyz -o no/{new}.ply", 6, "no/", "cannot write into the folder no: No such file"),
    ("delaunay cube.xyz -o cube.xyz/{new}.ply", 6, "cannot write into the folder cube.xyz: "),
    ("delaunay cube.xyz -o {new}.doc", 1, "{new}.doc: this version writes", "--format"),
    ("delaunay cube.xyz -o {old}.ply --format doc", 1, "--format doc: this version writes"),
    ("delaunay cube.xyz -o {new}.pcd", 1, "{new}.pcd: ", "cannot hold the result"),
    ("delaunay cube.xyz -o {new}.gltf", 1, "{new}.gltf: ", "read, not written"),
    ("delaunay cube.xyz -o -", 1, "-o - needs --format"),
    ("delaunay cube.xyz -o - --format node", 1, "cannot hold the two files .node and .ele"),
    ("delaunay cube.xyz -o - --format ply --json", 1, "--json and -o - both want standard output"),
    ("check oct.off -o {old}.ply", 1, "writes no file"),
    # tetrahedra, cells and surfaces where they cannot be
    ("delaunay cube.xyz -o {old}.off", 1, "{old}.off: a file of this format cannot hold"),
    ("delaunay cube.xyz -o {old}.obj", 1, "{old}.obj: a file of this format cannot hold"),
    ("delaunay cube.xyz -o {new}.las", 1, "{new}.las: a file of this format cannot hold"),
    ("surface cube.xyz -o {old}.node", 1, "{old}.node: a file of this format cannot hold"),
    ("medial cube.xyz -o {old}.obj", 1, "{old}.obj: a file of this format cannot hold"),
    ("hull cube.xyz -o {new}.xyz", 1, "{new}.xyz: a file of this format cannot hold"),
    ("voronoi cube.xyz -o {old}.ply", 1, "{old}.ply: a file of this format cannot hold cells"),
    ("delaunay cube.xyz -o {old}.ply --neighbors", 1, "--neighbors: only with -o x.node"),
    ("delaunay cube.xyz --edges", 1, "--edges: only with -o x.node"),
    ("delaunay cube.xyz -o {old}.node --faces --plane xy", 1, "--faces: not with --plane"),
    # operands
    ("delaunay -o {old}.ply", 1, "delaunay: expected IN, got no argument"),
    ("delaunay cube.xyz two.xyz -o {old}.ply", 1, "delaunay: one argument too many: 'two.xyz'"),
    ("compare oct.off", 1, "compare: expected A B, got one argument"), ("compare - -", 1, "standard input"),
    ("delaunay - --weights - -o {old}.ply", 1, "both want standard input"),
    ("locate - --at - -o {old}.csv", 1, "standard input"), ("surface cube.xyz", 1, "-o FILE is missing"),
    ("locate cube.xyz -o {old}.csv", 1, "--at FILE is missing"),
    ("interpolate cube.xyz --at cube.xyz -o {old}.csv", 1, "--property NAME is missing"),
    ("interpolate cube.xyz --at cube.xyz --property q -o {old}.csv", 2, "cube.xyz: ", "no property 'q'"),
    ("interpolate cube.xyz --at nan.xyz --property q -o {old}.csv", 2, ": "),
    ("delauny cube.xyz", 1, "unknown command 'delauny'; did you mean 'delaunay'"),
    ("generate cub -n 5 -o {old}.ply", 1, "unknown kind 'cub'; did you mean 'cube'"),
    # options
    ("delaunay cube.xyz -o {old}.ply --wieghts w", 1, "unknown option '--wieghts'; did you mean '--weights'"),
    ("delaunay cube.xyz -o {old}.ply --neighbours", 1, "unknown option '--neighbours'; did you mean '--neighbors'"),
    ("delaunay cube.xyz -o {old}.ply --max-memory", 1, "--max-memory needs a value"),
    ("delaunay cube.xyz -o {old}.ply --max-memory 8X", 1, "--max-memory: '8X' is not a size such as 500M"),
    ("delaunay cube.xyz -o {old}.ply --max-memory 8GiBs", 1, "--max-memory: '8GiBs' is not a size"),
    ("delaunay cube.xyz -o {old}.ply --max-memory -8G", 1, "--max-memory: '-8G' is not a size"),
    ("delaunay cube.xyz -o {old}.ply --max-memory 1K", 4, "memory"),
    ("delaunay cube.xyz -o {old}.ply --threads 2000", 1, "--threads: 2000 is not between 0 and 1024"),
    ("delaunay cube.xyz -o {old}.ply --threads 1.5", 1, "--threads: '1.5' is not a whole number"),
    ("delaunay cube.xyz -o {old}.ply --scratch no", 2, "no: not a writable folder"),
    ("delaunay cube.xyz -o {old}.ply --scratch cube.xyz", 2, "cube.xyz: not a writable folder"),
    ("delaunay cube.xyz -o {old}.ply --scratch /proc", 2, "/proc: not a writable folder"),
    ("delaunay cube.xyz -o {old}.ply --weights weights.txt", 2, "weights.txt:2: ", "2 weights for 8 points"),
    ("delaunay cube.xyz -o {old}.ply --weights nan.txt", 2, "nan.txt:2: expected one finite number"),
    ("delaunay cube.xyz -o {old}.ply --weights no.txt", 2, "no.txt: No such file"),
    ("delaunay cube.xyz -o {old}.ply --weights-mod 99999", 1, "--weights-mod: ", "not a finite double"),
    ("delaunay cube.xyz -o {old}.ply --order bri", 1, "--order: unknown name 'bri', expected brio, brio-octree"),
    ("delaunay cube.xyz -o {old}.ply --round-ratio 2", 1, "--round-ratio: 2 is not between 0 and 1"),
    ("delaunay cube.xyz -o {old}.ply --locate trace", 2, "cube.xyz: expected a surface mesh"),
    ("delaunay cube.xyz --input-format zip", 1, "--input-format: unknown format 'zip'"),
    ("surface cube.xyz -o {old}.ply --theta 9 --method cocone", 1, "--theta: 9 is not between"),
    ("surface cube.xyz -o {old}.ply --normals {old}.ply", 1, "--normals and -o name the same file"),
    ("alpha cube.xyz -o {old}.ply --alpha two", 1, "--alpha: expected a number or auto, got 'two'"),
    ("offset oct.off -o {old}.ply", 1, "--distance D is missing"),
    ("offset oct.off -o {old}.ply --distance 1e999", 1, "--distance: '1e999' is not a finite number"),
    ("voronoi cube.xyz -o {new}.vtu --box 0,0,0,1,1", 1, "--box: '0,0,0,1,1' is not"),
    ("voronoi cube.xyz -o {new}.vtu --box 1,1,1,0,0,0", 1, "--box: x from 1 to 0 is empty"),
    ("generate cube -o {old}.ply", 1, "-n N"), ("generate cube -n 5.5 -o {old}.ply", 1, "--points: '5.5' is not a whole number"),
    ("generate cube -n 1e18 -o {old}.ply", 1, "--points: '1e18' is not a whole number", "with all its digits"),
    # 0, where the program would take the default in its place
    ("delaunay cube.xyz -o {old}.ply --max-memory 0", 1, "--max-memory: '0' is not above 0"),
    ("delaunay cube.xyz -o {old}.ply --order octree --block-size 0", 1, "--block-size: '0' is not above 0"),
    ("delaunay cube.xyz -o {old}.ply --record-every 0", 1, "--record-every: '0' is not above 0"),
    ("surface cube.xyz -o {old}.ply --method cocone --theta 0", 1, "--theta: '0' is not above 0"),
    ("surface cube.xyz -o {old}.ply --method cocone --theta 1e-999", 1, "--theta: '1e-999' is not above 0"),
    ("surface cube.xyz -o {old}.ply --method cocone --pieces 0", 1, "--pieces: '0' is not above 0"),
    ("surface cube.xyz -o {old}.ply --method power-crust -R 0", 1, "--sampling-density: '0' is not above 0"),
    ("offset oct.off -o {old}.ply -D 1 -R -1", 1, "--sampling-density: '-1' is not above 0"),
    ("medial oct.off -o {old}.ply --scale 0", 1, "--scale: '0' is not above 0"),
    ("medial oct.off -o {old}.ply --redundancy -0", 1, "--redundancy: '-0' is not above 0"),
    ("compare oct.off oct.off --samples 0", 1, "--samples: '0' is not above 0"),
    ("convert cube.xyz {old}.ply --drop-outliers 0", 1, "--drop-outliers: '0' is not above 0"),
    ("convert cube.xyz {old}.ply --drop-outliers 64", 1, "--drop-outliers: 64 is not between 1 and 63"),
    ("generate scan -n 9 -o {old}.ply --views 0", 1, "--views: '0' is not above 0"),
    ("generate solid --resolution 0 -o {old}.ply", 1, "--resolution: '0' is not above 0"),
    ("iso cube.xyz -n 0 -o {old}.ply", 1, "--points: '0' is not above 0"),
    ("iso cube.xyz --resolution 0 -o {old}.ply", 1, "--resolution: '0' is not above 0"),
    ("subdivide oct.off --levels 99 -o {old}.ply", 1, "--levels: 99 is not between"),
    # what has no answer
    ("surface two.xyz -o {old}.ply", 3, "two.xyz: 2 distinct points"), ("surface void.xyz -o {old}.ply", 3, "void.xyz: no points, no surface"),
    ("alpha cube.xyz -o {old}.ply --alpha -1", 3, "cube.xyz: no tetrahedron"),
    ("subdivide cube.xyz -o {old}.ply", 3, "cube.xyz: has no faces"),
    ("check cube.xyz", 2, "cube.xyz: expected faces or tetrahedra"), ("compare cube.xyz cube.xyz", 2, "cube.xyz: expected a surface"),
    ("iso cube.xyz -o {old}.ply --level 1", 2, "cube.xyz: unknown format, expected .map"),
]


def contents(folder):
    """Every file below a folder with its bytes, and every folder."""
    found = {}
    for place, _, names in os.walk(folder):
        found[place] = None
        for name in names:
            with open(os.path.join(place, name), "rb") as f:
                found[os.path.join(place, name)] = f.read()
    return found


class WrongUses(CliTest):
    def setUp(self):
        super().setUp()
        self.xyz("cube.xyz", CUBE)
        self.off("oct.off", OCTAHEDRON, OCTAHEDRON_FACES)
        self.tetrahedra("flat", FLAT, FLAT_RIGHT)
        self.file("void.xyz", "")
        for name, content in FILES.items():
            self.file(name, content)
        for extension in EXTENSIONS:
            self.file("png." + extension, PNG)
            self.file("void." + extension, "")
            self.file("old." + extension, "old")
        self.file("old.csv", "old")
        os.mkdir(self.path("folder"))
        os.mkdir(self.path("folder.ply"))

    def run_line(self, line, stdin=b""):
        names = line.replace("{old}", "old").replace("{new}", "new").split()
        done = subprocess.run([BRIO, *names], input=stdin, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              cwd=self.folder, timeout=SECONDS)
        return done.returncode, done.stderr.decode(errors="replace")

    def expect_use(self, line, code, *words):
        found, message = self.run_line(line)
        self.assertEqual(found, code, "brio %s\n%s" % (line, message))
        for word in words:
            self.assertIn(word.replace("{old}", "old").replace("{new}", "new"), message, "brio " + line)
        self.assertRegex(message, r"\A(brio: .+\n)+\Z", line)

    def expect_table(self, rows):
        before = contents(self.folder)
        for row in rows:
            with self.subTest(row[0]):
                self.expect_use(*row)
                self.assertEqual(contents(self.folder), before, "a file was written, changed or lost")

    def test_uses(self):
        self.assertGreater(len(USES) + len(INPUTS), 40)
        self.expect_table(USES)

    def test_inputs(self):
        self.expect_table(("info " + row[0], 2, *row[1:]) for row in INPUTS)

    def test_inputs_of_work_with_an_output(self):
        self.expect_table(("delaunay %s -o {old}.ply" % row[0], 2, *row[1:]) for row in INPUTS[::4])

    def test_pictures_and_empty_files(self):
        self.expect_table(("info png." + e, 2, "png.%s: " % e) for e in EXTENSIONS)
        self.expect_table(("info void." + e, 2, "void.%s: " % e) for e in EXTENSIONS
                          if e not in ("obj", "xyz", "pts", "xyzrgb", "xyzn", "bnpts"))  # no points are a file of these

    def test_control_characters_of_a_name_do_not_reach_the_terminal(self):
        for name in ("\x1b[31mred.xyz", "bell\x07\x7f.xyz"):
            done = subprocess.run([BRIO, "info", name], stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=self.folder)
            self.assertEqual(done.returncode, 2)
            self.assertRegex(done.stderr, rb"\Abrio: [ -~]+: No such file or directory\n\Z")

    def test_no_control_character_of_any_text_reaches_the_terminal(self):
        """U+009B, one character that begins a command of terminals, went through; wrong bytes, too."""
        names = ["\u009b31mred", "\u0085", "a\u202eb", "\u2066x", "\x1b[31mred"]
        shown = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069]")
        for i, name in enumerate(names):
            with open(self.path("names.csv"), "w", encoding="utf-8") as f:
                f.write("x,y,z,%s\n1,2,3,4\n" % name)
            for line in (["info", "names.csv"], ["convert", "names.csv", "p.obj"], ["info", "none" + name],
                         ["delaunay", "names.csv", "-o", name + "/x.ply"], ["hull", name], [name],
                         ["info", "names.csv", "--" + name], ["delaunay", "names.csv", "--scratch", name]):
                for json in [], ["--json"]:
                    done = subprocess.run([BRIO, *line, *json], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                          cwd=self.folder)
                    for text in done.stdout, done.stderr:
                        self.assertIsNone(shown.search(text.decode("utf-8")), line)
        done = subprocess.run([BRIO, "info", b"\x9b31m\xff"], stderr=subprocess.PIPE, cwd=self.folder)
        self.assertRegex(done.stderr, rb"\Abrio: \?31m\?: No such")

    def test_unreadable_file(self):
        if os.geteuid() == 0:
            self.skipTest("root may read every file")
        os.chmod(self.path("cube.xyz"), 0)
        self.expect_use("info cube.xyz", 2, "cube.xyz: Permission denied")

    def test_unwritable_output(self):
        if os.geteuid() == 0:
            self.skipTest("root may write every file")
        os.chmod(self.path("old.ply"), 0o400)
        self.expect_use("delaunay cube.xyz -o old.ply", 6, "old.ply: Permission denied")

    def test_e57_with_a_wrong_checksum(self):
        code, message = self.run_line("info sum.e57")
        self.assertEqual(code, 2)
        if "without the library expat" in message:
            self.skipTest("brio was built without the library expat")
        self.assertIn("sum.e57: the page at byte 0 is damaged: its checksum is", message)

    def test_e57_from_a_pipe(self):
        code, message = self.run_line("info -", e57_header())
        self.assertEqual(code, 2)
        self.assertIn("standard input: an E57 file", message)
        self.assertIn("which a pipe does not allow", message)


class DamagedFiles(CliTest):
    """Files that are cut or changed end with 0 or 2, at once, and a message names the file."""

    def expect_end(self, name, content, codes=(0, 2)):
        done = subprocess.run([BRIO, "info", self.file(name, content), "--quiet"], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, timeout=SECONDS)
        self.assertIn(done.returncode, codes, "%s: %s" % (name, done.stderr))
        if done.returncode:
            self.assertIn(name.encode() + b": ", done.stderr)

    def test_truncations(self):
        formats = {"pcd": pcd("ascii", 2, b"1 2 3\n4 5 6\n"), "ptx": ptx()}
        self.xyz("cube.xyz", CUBE)
        for extension in ("ply", "vtu", "node", "las", "npy", "stl", "obj", "off"):
            kind = ("hull", self.path("cube.xyz")) if extension in ("stl", "obj", "off") else ("generate", "cube", "-n", "9")
            self.expect(0, *kind, "-o", self.path("a." + extension), "--quiet")
            with open(self.path("a." + extension), "rb") as f:
                formats[extension] = f.read()
        for extension, content in formats.items():
            for k in range(10):
                self.expect_end("cut." + extension, content[:len(content) * k // 10])

    def test_changed_laz(self):
        with open(os.path.join(HERE, "..", "unit", "laz_samples.h"), encoding="ascii") as f:
            text = f.read()
        state = 1
        for name in ("laz_format_3", "laz_format_8"):
            body = re.search(r"\b%s\[\w*\] = \{(.*?)\}" % name, text, re.S).group(1)
            content = bytes(int(number, 0) for number in re.findall(r"\w+", body))
            self.assertEqual(content[:4], b"LASF")
            self.expect_end("a.laz", content, codes=(0,))
            for _ in range(75):
                changed = bytearray(content)
                for _ in range(1 + state % 4):
                    state = (state * 6364136223846793005 + 1442695040888963407) % 2**64
                    changed[(state >> 33) % len(content)] ^= 1 << (state >> 20) % 8
                self.expect_end("a.laz", bytes(changed))


if __name__ == "__main__":
    main()
