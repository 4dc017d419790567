"""What the tests of the command line share: runs of the program, files for its input, the facts of every report.

BRIO names the program. Python's standard library is all that is needed.
"""

import json
import math
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

BRIO = os.environ.get("BRIO", "brio")

CUBE = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
# Two flat tetrahedra over and under a triangle: the sphere of either holds the apex of the other.
FLAT = [(1, 0, 0), (-0.5, 0.8, 0), (-0.5, -0.8, 0), (0, 0, 0.1), (0, 0, -0.1)]
FLAT_WRONG = [(0, 1, 2, 3), (0, 2, 1, 4)]
FLAT_RIGHT = [(0, 1, 4, 3), (1, 2, 4, 3), (2, 0, 4, 3)]
OCTAHEDRON = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
OCTAHEDRON_FACES = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
# Points with two properties of their own.
PLY_WITH_PROPERTIES = (
    "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nproperty double quality\nend_header\n"
    "0 0 0 10 0.25\n1 0 0 20 0.5\n0 1 0 30 0.125\n0 0 1 40 1e-9\n1 1 1 255 -7\n")


class Run:
    """What a run of the program gave."""

    def __init__(self, code, out, err):
        self.code, self.out, self.err = code, out, err

    @property
    def text(self):
        return self.out.decode()


def number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def count(value):
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def vector(value):
    return isinstance(value, list) and len(value) == 3 and all(map(number, value))


CERTIFICATE = {"closed": bool, "manifold": bool, "oriented": bool, "components": count, "genus": int, "genera": list,
               "genus_by_component": list,
               "boundary_edges": count, "boundary_loops": count, "self_intersections": type(None)}
COMMON_FACTS = {"command": str, "input": str, "threads": count, "seconds": {"total": number}, "peak_bytes": count}


class CliTest(unittest.TestCase):
    """A test of the program in a folder that the test's end removes."""

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="brio-cli-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def file(self, name, content):
        if isinstance(content, str):
            content = content.encode()
        with open(self.path(name), "wb") as f:
            f.write(content)
        return self.path(name)

    def xyz(self, name, points):
        return self.file(name, "".join("%r %r %r\n" % tuple(p) for p in points))

    def off(self, name, points, faces):
        lines = ["OFF", "%d %d 0" % (len(points), len(faces))]
        lines += ["%r %r %r" % tuple(p) for p in points]
        lines += [" ".join(map(str, (len(f),) + tuple(f))) for f in faces]
        return self.file(name, "\n".join(lines) + "\n")

    def tetrahedra(self, name, points, tetrahedra):
        node = ["%d 3 0 0" % len(points)] + ["%d %r %r %r" % ((i,) + tuple(p)) for i, p in enumerate(points)]
        ele = ["%d 4 0" % len(tetrahedra)] + ["%d %d %d %d %d" % ((i,) + tuple(t)) for i, t in enumerate(tetrahedra)]
        self.file(name + ".ele", "\n".join(ele) + "\n")
        return self.file(name + ".node", "\n".join(node) + "\n")

    def cloud(self, name, n, kind="cube"):
        self.expect(0, "generate", kind, "-n", n, "-o", self.path(name), "--quiet")
        return self.path(name)

    @staticmethod
    def sphere(n):
        """Points spread evenly on the unit sphere."""
        turn = math.pi * (1 + math.sqrt(5))
        z = [1 - (2 * k + 1) / n for k in range(n)]
        return [(math.cos(turn * k) * math.sqrt(1 - c * c), math.sin(turn * k) * math.sqrt(1 - c * c), c) for k, c in enumerate(z)]

    def ball_map(self, name, size=20):
        """A CCP4 map whose values fall with the distance from the middle."""
        header = struct.pack("<10i", size, size, size, 2, 0, 0, 0, size, size, size)
        header += struct.pack("<6f", size, size, size, 90, 90, 90) + struct.pack("<3i", 1, 2, 3)
        header = header.ljust(208, b"\0") + b"MAP \x44\x44\0\0"
        middle = (size - 1) / 2
        distance = lambda *p: sum((x - middle) ** 2 for x in p) ** 0.5
        values = [distance(x, y, z) for z in range(size) for y in range(size) for x in range(size)]
        return self.file(name, header.ljust(1024, b"\0") + struct.pack("<%df" % len(values), *[-v for v in values]))

    def run_brio(self, *arguments, stdin=b"", stdout=subprocess.PIPE, preexec_fn=None):
        done = subprocess.run([BRIO, *map(str, arguments)], input=stdin, stdout=stdout, stderr=subprocess.PIPE,
                              preexec_fn=preexec_fn, cwd=self.folder, timeout=120)
        return Run(done.returncode, done.stdout, done.stderr.decode(errors="replace"))

    def expect(self, code, *arguments, **how):
        run = self.run_brio(*arguments, **how)
        self.assertEqual(run.code, code, "brio %s\n%s" % (" ".join(map(str, arguments)), run.err))
        if code:
            self.assertRegex(run.err, r"\A(brio: .+\n)+\Z")
        return run

    def facts(self, *arguments, code=0, **how):
        run = self.expect(code, *arguments, "--json", **how)
        self.assertEqual(run.text.count("\n"), 1, "one line, one object")
        return json.loads(run.text, parse_constant=lambda c: self.fail("JSON with " + c))

    def usage(self, message, *arguments, **how):
        run = self.expect(1, *arguments, **how)
        self.assertRegex(run.err, message)
        self.assertRegex(run.err, r"brio: see 'brio (\w+ )?--help'\n\Z")
        self.assertEqual(run.out, b"")

    def methods(self):
        """The names that `brio surface --method` takes, in the order of its help."""
        of_method = self.expect(0, "surface", "--help").text.split("  --method ")[1].split("\n  --")[0]
        return re.findall(r"(?m)^ {6}([a-z-]+)", of_method)

    def bad_input(self, message, *arguments, **how):
        run = self.expect(2, *arguments, **how)
        self.assertRegex(run.err, message)
        return run

    def assert_only(self, folder, *names):
        self.assertEqual(sorted(os.listdir(folder)), sorted(names))

    def assert_schema(self, value, schema, where=""):
        for key, kind in schema.items():
            self.assertIn(key, value, where)
            if isinstance(kind, dict):
                self.assert_schema(value[key], kind, where + key + ".")
            elif isinstance(kind, type):
                self.assertIs(type(value[key]), kind, where + key)
            else:
                self.assertTrue(kind(value[key]), "%s%s: %r" % (where, key, value[key]))

    def appended_arrays(self, name):
        """The arrays of a VTK file by section and name, and the attributes of its piece."""
        with open(self.path(name), "rb") as f:
            xml, data = f.read().split(b"\n_", 1)
        codes = {"Int32": "i", "UInt32": "I", "Int64": "q", "UInt8": "B", "Int8": "b", "Float64": "d"}
        arrays, section = {}, None
        for tag in re.findall(r"<(\w+)([^>]*)>", xml.decode()):
            if tag[0] != "DataArray":
                section = tag[0]
                continue
            facts = dict(re.findall(r'(\w+)="([^"]*)"', tag[1]))
            at = int(facts["offset"])
            size, = struct.unpack_from("<Q", data, at)
            code = codes[facts["type"]]
            count = size // struct.calcsize(code)
            arrays[section, facts["Name"]] = struct.unpack_from("<%d%s" % (count, code), data, at + 8)
        return arrays, dict(re.findall(r'(NumberOf[PVLS]\w+)="(\d+)"', xml.decode()))


def main():
    """Runs the tests of the file that was started. Exits with 77 where every test skipped itself."""
    program = unittest.main(exit=False)
    result = program.result
    if result.testsRun and len(result.skipped) == result.testsRun and result.wasSuccessful():
        for test, reason in result.skipped:
            print("skipped: %s: %s" % (test.id(), reason))
        sys.exit(77)
    sys.exit(not result.wasSuccessful())
