"""What a small file can claim: each count is read up to its limit and refused past it, with the number, in little memory."""

import io
import json
import struct
import zipfile
import zlib

from brio_cli import CliTest, main

MOST, ELEMENTS, LEVELS = 4096, 256, 64  # src/io/limits.h
PLY = "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty double z\n"


def array(shape, kind, body):
    head = "{'descr': '%s', 'fortran_order': False, 'shape': %s, }" % (kind, shape)
    head += " " * (-(len(head) + 11) % 64) + "\n"
    return b"\x93NUMPY\x02\0" + struct.pack("<I", len(head)) + head.encode() + body


def overlapping(count):
    """An archive whose entries all name one body."""
    data = array("(100000, 3)", "<f8", bytes(2400000))
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    packed = packer.compress(data) + packer.flush()
    facts = struct.pack("<III", zlib.crc32(data), len(packed), len(data))
    body = struct.pack("<IHHHHH", 0x04034b50, 20, 0, 8, 0, 0) + facts + struct.pack("<HH", 10, 0) + b"points.npy" + packed
    table = b""
    for i in range(count):
        name = b"p%d.npy" % i if i else b"points.npy"
        table += struct.pack("<IHHHHHH", 0x02014b50, 20, 20, 0, 8, 0, 0) + facts
        table += struct.pack("<HHHHHII", len(name), 0, 0, 0, 0, 0, 0) + name
    return body + table + struct.pack("<IHHHHIIH", 0x06054b50, 0, 0, count, count, len(table), len(body), 0)


def glb(nodes, primitives, points):
    scene = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(nodes))}],
             "nodes": [{"mesh": 0, "translation": [i, 0, 0]} for i in range(nodes)],
             "meshes": [{"primitives": [{"attributes": {"POSITION": k}, "mode": 0} for k in range(primitives)]}],
             "accessors": [{"bufferView": 0, "componentType": 5120, "count": points, "type": "VEC3"}] * primitives,
             "bufferViews": [{"buffer": 0, "byteLength": 3 * points}], "buffers": [{"byteLength": 3 * points}]}
    text = json.dumps(scene, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary = bytes(3 * points + -3 * points % 4)
    chunks = struct.pack("<II", len(text), 0x4e4f534a) + text + struct.pack("<II", len(binary), 0x004e4942) + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


class Limits(CliTest):
    def refused(self, name, content, message):
        """Refused, with a memory that the file explains."""
        path = self.file(name, content)
        run = self.expect(2, "info", path, "--json")
        facts = json.loads(run.text)
        self.assertRegex(facts["error"], message)
        self.assertLess(facts.get("peak_bytes", 0), 128 << 20)
        self.expect(2, "convert", path, self.path("out.ply"))

    def read(self, name, content, points):
        self.assertEqual(self.facts("info", self.file(name, content))["points"], points)

    def test_columns_of_a_text(self):
        row = "1 2 3 " + "4 " * (MOST - 3) + "\n"
        self.read("a.xyz", row * 2, 2)
        self.refused("b.xyz", row * 2 + "1 2 3 " + "4 " * (MOST - 2) + "\n", "line 3: 4097 numbers in a row")
        self.refused("c.csv", ",".join("xyz") + ",a" * MOST + "\n1,2,3\n", "line 1: 4097 numbers in a row")

    def test_words_of_a_comment_are_no_columns(self):
        self.read("a.xyz", "# " + "word " * 20000 + "\n1 2 3\n", 1)

    def test_names_that_are_alike(self):
        count = MOST - 3
        facts = self.facts("info", self.file("a.csv", "x,y,z" + ",a" * count + "\n1,2,3" + ",4" * count + "\n"))
        self.assertEqual(len(facts["properties"]), count)

    def test_few_wide_rows_among_many_short_ones(self):
        """606 kB became 4.4 GB."""
        self.refused("a.xyz", "1 2 3 " + "4 " * 3000 + "\n" + "1 2 3\n" * 100000, "rows lack [0-9]{7,8} numbers")
        self.read("b.xyz", "1 2 3" + " 4" * 60 + "\n" + "1 2 3\n" * 100000, 100001)
        self.read("c.xyz", "1 2 3 " + "4 " * 3000 + "\n" + "1 2 3\n" * 300, 301)

    def test_properties_and_elements_of_ply(self):
        names = lambda count: "".join("property uchar a%d\n" % i for i in range(count))
        self.read("a.ply", PLY + names(MOST - 3) + "end_header\n1 2 3" + " 4" * (MOST - 3) + "\n", 1)
        self.refused("b.ply", PLY + names(MOST - 2) + "end_header\n1 2 3" + " 4" * (MOST - 2) + "\n",
                     "line 4100: 4097 numbers in a row, expected at most 4096")
        elements = lambda count: "".join("element e%d 0\n" % i for i in range(count))
        self.read("c.ply", PLY + elements(ELEMENTS - 1) + "end_header\n1 2 3\n", 1)
        self.refused("d.ply", PLY + elements(ELEMENTS) + "end_header\n1 2 3\n", "257 elements, expected at most 256")

    def test_entries_of_an_archive_that_overlap(self):
        self.refused("a.npz", overlapping(2), "the entries points.npy and p1.npy of the archive overlap|the entries p1.npy "
                     "and points.npy of the archive overlap")

    def test_entries_in_any_order_do_not_overlap(self):
        out = io.BytesIO()
        with zipfile.ZipFile(out, "w") as z:
            for name in "b", "points", "a":
                z.writestr(name + ".npy", array("(2, 3)" if name == "points" else "(2,)", "<f8", bytes(48 if name == "points" else 16)))
        self.read("a.npz", out.getvalue(), 2)

    def test_instances_of_gltf(self):
        """794 kB asked for 29 GB; 10,000 nodes of 10,000 primitives for 1e8 triangles."""
        self.refused("a.glb", glb(12000, 1, 100000), "would be 4800000000 numbers from [0-9]+ bytes, expected at most")
        self.refused("b.glb", glb(10000, 10000, 2), "would be [0-9]+ numbers")
        self.read("c.glb", glb(1000, 1, 100), 100000)

    def test_levels_of_json(self):
        nested = lambda levels: b'{"asset":{"version":"2.0"},"a":' + b"[" * levels + b"]" * levels + b"}"
        self.refused("a.gltf", nested(LEVELS), "65 levels, the most are 64")

    def test_what_is_written_can_be_read(self):
        count = MOST - 2
        wide = self.file("w.node", "1 3 %d 0\n0 1 2 3%s\n" % (count, " 4" * count))
        self.assertEqual(self.facts("info", wide)["points"], 1)
        for name in "out.ply", "out.csv", "out.npy":
            run = self.expect(1, "convert", wide, self.path(name))
            self.assertIn("at most 4093", run.err)


if __name__ == "__main__":
    main()
