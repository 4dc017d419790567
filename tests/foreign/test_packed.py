"""test_packed.py: what Python's gzip, zstandard and NumPy compress and archive is read. As test_foreign.py."""

import gzip
import io
import subprocess
import unittest

from test_foreign import FILES, ForeignTest, missing, numpy


def lacks(library):
    """The reason to skip what the build of brio cannot read: its zlib or libzstd is missing."""
    packed = {"zlib": gzip.compress(b"1 2 3\n"), "libzstd": bytes.fromhex("28b52ffd0000010000")}[library]
    run = subprocess.run([FILES, "-", "/dev/null"], input=packed, capture_output=True, check=False)
    return "brio is built without " + library if b"built without " + library.encode() in run.stderr else ""


class PackedTest(ForeignTest):
    def put(self, name, data):
        with open(self.path(name), "wb") as file:
            file.write(data)
        return self.path(name)

    def expect_same(self, name, data, pack):
        """A file, compressed as a whole and in two pieces, and from a pipe, is the file."""
        plain = self.read(self.put(name, data))
        cut = len(data) // 3
        for packed in pack(data), pack(data[:cut]) + pack(data[cut:]):
            self.expect_equal(plain, self.read(self.put(name + ".packed", packed)) if name.endswith(".ply") else
                              self.read(self.put(name + ".gz", packed)), name)
        run = subprocess.run([FILES, "-", self.path("pipe.ply")], input=pack(data), capture_output=True, check=False)
        self.assertEqual(run.returncode, 0, run.stderr.decode())

    def files(self):
        """A text and a binary PLY, both longer than a buffer."""
        rows = self.random.standard_normal((8000, 4))
        text = io.StringIO()
        text.write("# x y z v\n")
        numpy.savetxt(text, rows)
        header = ("ply\nformat binary_little_endian 1.0\nelement vertex 30000\nproperty double x\nproperty double y\n"
                  "property double z\nend_header\n").encode()
        return [("a.xyz", text.getvalue().encode()),
                ("a.ply", header + self.random.integers(0, 99, (30000, 3)).astype("<f8").tobytes())]

    def expect_failure(self, data, words):
        run = subprocess.run([FILES, self.put("a.xyz.gz", data), self.path("b.ply")], capture_output=True, check=False)
        self.assertNotEqual(run.returncode, 0)
        self.assertIn(words, run.stderr.decode())


@unittest.skipIf(lacks("zlib"), lacks("zlib"))
class GzipTest(PackedTest):
    def test_levels(self):
        for name, data in self.files():
            for level in 0, 1, 6:
                self.expect_same(name, data, lambda part, level=level: gzip.compress(part, level))

    def test_name_in_the_header(self):
        name, data = self.files()[0]
        with gzip.open(self.path("a.xyz.gz"), "wb") as file:
            file.write(data)
        self.expect_equal(self.read(self.put(name, data)), self.read(self.path("a.xyz.gz")), "gzip.open")

    def test_las(self):
        if missing("laspy", "lazrs"):
            self.skipTest(missing("laspy", "lazrs"))
        import laspy
        for form in 3, 7:
            las = laspy.create(point_format=form)
            las.x, las.y, las.z = (self.random.integers(0, 10**6, 60000) * 0.01 for _ in range(3))
            las.write(self.path("a.laz"))
            with open(self.path("a.laz"), "rb") as file:
                self.put("b.laz.gz", gzip.compress(file.read(), 1))
            self.expect_equal(self.read(self.path("a.laz")), self.read(self.path("b.laz.gz")), f"LAZ, format {form}")

    def test_damage(self):
        data = gzip.compress(self.files()[0][1])
        self.expect_failure(data[:-9], "breaks off")
        self.expect_failure(data + b"more", "what follows the compressed data is none")
        self.expect_failure(data[:-6] + bytes([data[-6] ^ 1]) + data[-5:], "damaged near byte")
        self.expect_failure(gzip.compress(data), "only one level")


@unittest.skipIf(missing("zstandard"), missing("zstandard"))
@unittest.skipIf(lacks("libzstd"), lacks("libzstd"))
class ZstdTest(PackedTest):
    def test_levels(self):
        import zstandard
        for name, data in self.files():
            for level in -5, 9:
                for sums in False, True:
                    packer = zstandard.ZstdCompressor(level=level, write_checksum=sums, write_content_size=sums)
                    self.expect_same(name, data, packer.compress)

    def test_long_window_and_skippable_frame(self):
        import zstandard
        name, data = self.files()[0]
        window = zstandard.ZstdCompressionParameters(window_log=28)
        stream = zstandard.ZstdCompressor(compression_params=window).compressobj()
        packed = b"\x5f\x2a\x4d\x18\x03\0\0\0abc" + stream.compress(data) + stream.flush()
        self.expect_equal(self.read(self.put(name, data)), self.read(self.put("b.xyz.zst", packed)), "long window")

    def test_damage(self):
        import zstandard
        data = zstandard.ZstdCompressor(write_checksum=True).compress(self.files()[0][1])
        self.expect_failure(data[:-9], "breaks off")
        self.expect_failure(data + b"more", "what follows the compressed data is none")
        self.expect_failure(data[:-1] + bytes([data[-1] ^ 1]), "damaged near byte")


class NpzTest(PackedTest):
    def saves(self):
        return [numpy.savez] if lacks("zlib") else [numpy.savez, numpy.savez_compressed]

    def test_arrays(self):
        n = 5000
        points, faces = self.random.standard_normal((n, 3)), self.random.integers(0, n, (70, 3))
        normals = points.astype("f4")
        label = self.random.integers(0, 9, n).astype(">i2")
        for save in self.saves():
            for order in "CF":
                save(self.path("a.npz"), points=numpy.asarray(points, order=order), faces=numpy.asarray(faces, order=order),
                     normals=numpy.asarray(normals, order=order), label=label, big=numpy.arange(n), mask=label > 4,
                     volume=numpy.zeros((2, 3, 4)), name=numpy.array("scan"), words=numpy.array(["a", "bc"]))
                found = self.read(self.path("a.npz"))
                for i, (axis, normal) in enumerate(zip("xyz", ("nx", "ny", "nz"))):
                    self.expect_equal(points[:, i], found[axis], axis)
                    self.expect_equal(normals[:, i], found[normal], normal)
                for name, column in (("label", label), ("big", numpy.arange(n)), ("mask", label > 4)):
                    self.expect_equal(column, found[name], name)
                self.convert(self.path("a.npz"), self.path("a.off"))
                with open(self.path("a.off")) as file:
                    lines = file.read().splitlines()
                self.assertEqual([list(map(int, line.split()[1:])) for line in lines[-70:]], faces.tolist())

    def test_names(self):
        points = self.random.standard_normal((100, 3))
        records = numpy.zeros(100, dtype=[("x", "f8"), ("y", "f8"), ("z", "f8"), ("i", "u1")])
        for i, axis in enumerate("xyz"):
            records[axis] = points[:, i]
        for save in self.saves():
            for arrays in ({"xyz": points}, {"cloud": points}, {"points": records}, dict(zip("xyz", points.T))):
                save(self.path("a.npz"), **arrays)
                found = self.read(self.path("a.npz"))
                for i, axis in enumerate("xyz"):
                    self.expect_equal(points[:, i], found[axis], str(list(arrays)))
            save(self.path("a.npz"), points)
            self.expect_equal(points[:, 1], self.read(self.path("a.npz"))["y"], "arr_0")

    def test_pipe(self):
        points = self.random.standard_normal((40000, 3))
        for save in self.saves():
            save(self.path("a.npz"), points=points)
            with open(self.path("a.npz"), "rb") as file:
                data = file.read()
            run = subprocess.run(["sh", "-c", f"cat | '{FILES}' - {self.path('pipe.ply')}"], input=data,
                                 capture_output=True, check=False)
            self.assertEqual(run.returncode, 0, run.stderr.decode())
            self.expect_equal(points[:, 2], self.read(self.path("pipe.ply"))["z"], "pipe")
            if not lacks("zlib"):
                self.expect_equal(points[:, 2], self.read(self.put("b.npz.gz", gzip.compress(data, 1)))["z"], "npz.gz")

    def test_zip64(self):
        """As an archive over 4 GiB begins: NumPy forces numbers of 64 bits in the entries' own headers."""
        points = self.random.standard_normal((10, 3))
        with open(self.path("a.npz"), "wb") as file:
            numpy.savez(file, points=points)
        self.expect_equal(points[:, 0], self.read(self.path("a.npz"))["x"], "zip64")


if __name__ == "__main__":
    unittest.main(verbosity=1)
