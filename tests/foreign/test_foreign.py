"""test_foreign.py: files that other programs write are read, and files that brio writes are read by them.

BRIO_FILES names the example program 03_files, which reads one file and writes another. Each class of tests is skipped
with its reason where the other program's package is missing; to run them all, use a Python that has numpy, laspy, lazrs,
laszip, meshio, trimesh, pypcd4 and pye57.
"""

import importlib
import os
import subprocess
import sys
import tempfile
import unittest

FILES = os.environ.get("BRIO_FILES", "03_files")
SHARED = os.environ.get("BRIO_SHARED", "")
PLY_TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4",
             "double": "f8"}


def missing(*names):
    """The reason to skip a test that needs packages, or an empty text."""
    for name in names:
        try:
            importlib.import_module(name)
        except ImportError:
            return f"the Python package {name} is missing"
    return ""


try:
    import numpy
except ImportError:
    print("skipped: the Python package numpy is missing")
    sys.exit(77)


def main():
    """Runs the tests of the file that was started, and says what was skipped."""
    result = unittest.main(verbosity=1, exit=False).result
    for test, reason in result.skipped:
        print(f"skipped: {test.id()}: {reason}")
    if result.testsRun == len(result.skipped) and result.wasSuccessful():
        sys.exit(77)
    sys.exit(not result.wasSuccessful())


class ForeignTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.random = numpy.random.default_rng(1)

    def path(self, name):
        return os.path.join(self.folder, name)

    def convert(self, source, target):
        run = subprocess.run([FILES, source, target], capture_output=True, check=False)
        self.assertEqual(run.returncode, 0, run.stderr.decode())

    def read(self, path):
        """The points of a file as an array of records, through a PLY file."""
        ply = self.path("read.ply")
        self.convert(path, ply)
        with open(ply, "rb") as file:
            data = file.read()
        start = data.index(b"end_header\n") + len("end_header\n")
        types, count = [], 0
        for line in data[:start].decode().splitlines():
            words = line.split()
            if words[:2] == ["element", "vertex"]:
                count = int(words[2])
            elif words[0] == "property" and words[1] != "list":
                types.append((words[2], "<" + PLY_TYPES[words[1]]))
        return numpy.frombuffer(data, dtype=types, count=count, offset=start)

    def expect_equal(self, a, b, what):
        self.assertTrue(numpy.array_equal(numpy.array(a), numpy.array(b)), what)


FLAGS = ["synthetic", "key_point", "withheld", "overlap"]


@unittest.skipIf(missing("laspy", "lazrs"), missing("laspy", "lazrs"))
class LasTest(ForeignTest):
    """All fields of all formats, plain and compressed by two encoders, one point of four channels of the scanner."""

    def make(self, form, n=60000):
        import laspy
        random = self.random
        header = laspy.LasHeader(point_format=form, version="1.4" if form >= 6 else "1.2")
        header.scales, header.offsets = [0.01, 0.01, 0.00025], [638982.55, 4000000, -7.3]
        header.add_extra_dim(laspy.ExtraBytesParams("amplitude", "f4"))
        header.add_extra_dim(laspy.ExtraBytesParams("deviation", "u2", scales=numpy.array([0.01]),
                                                    offsets=numpy.array([1.5])))
        las = laspy.LasData(header)
        las.points = laspy.ScaleAwarePointRecord.zeros(n, header=header)
        t = numpy.arange(n)
        las.X = (numpy.sin(t * 0.01) * 2e4 + random.integers(-200, 200, n)).astype(numpy.int32)
        las.Y = numpy.where(t % 997 == 0, 2**31 - 1, t * 3 % 60000)
        las.Z = random.integers(-2**31, 2**31, n) // (1 + t % 3 * 100000)
        for name in las.point_format.dimension_names:
            size = las.point_format.dimension_by_name(name).num_bits
            if name in "XYZ" or name in ("amplitude", "deviation", "gps_time"):
                continue
            low, high = (-2**(size - 1), 2**(size - 1)) if name in ("scan_angle", "scan_angle_rank") else (0, 2**size)
            if name == "scan_angle_rank":
                low, high = -90, 90
            las[name] = numpy.where(random.random(n) < 0.3, random.integers(low, high, n), (t // 50) % high)
        if "gps_time" in las.point_format.dimension_names:
            las.gps_time = 3e5 + numpy.cumsum(random.random(n) < 0.7) * 1e-5 + (t % 5000 == 0) * random.random(n) * 1e9
        las.amplitude = random.standard_normal(n)
        las.deviation = random.integers(0, 65536, n) * 0.01 + 1.5
        return las

    def expect_points(self, las, points, what):
        for axis in "xyz":
            self.expect_equal(las[axis], points[axis], f"{what}: {axis}")
        for name in las.point_format.dimension_names:
            if name in FLAGS:
                self.expect_equal(las[name], points["classification_flags"] >> FLAGS.index(name) & 1, f"{what}: {name}")
            elif name in ("red", "green", "blue"):  # the points come by PLY, whose colours have 8 bits
                self.expect_equal(las[name] >> 8, points[name], f"{what}: {name}")
            elif name not in "XYZ":
                self.expect_equal(las[name], points[name], f"{what}: {name}")

    def test_read(self):
        import laspy
        backends = [laspy.LazBackend.Lazrs]
        if not missing("laszip"):
            backends.append(laspy.LazBackend.Laszip)
        for form in (0, 1, 2, 3, 6, 7, 8):
            las = self.make(form)
            las.write(self.path("a.las"))
            self.expect_points(las, self.read(self.path("a.las")), f"format {form}")
            for backend in backends:
                las.write(self.path("a.laz"), laz_backend=backend)
                self.expect_points(las, self.read(self.path("a.laz")), f"format {form}, {backend}")

    def test_pipe(self):
        for form in (3, 8):
            las = self.make(form)
            las.write(self.path("a.laz"))
            with open(self.path("a.laz"), "rb") as file:
                data = file.read()
            run = subprocess.run(["sh", "-c", f"cat | '{FILES}' - {self.path('pipe.ply')}"], input=data,
                                 capture_output=True, check=False)
            self.assertEqual(run.returncode, 0, run.stderr.decode())
            self.expect_points(las, self.read(self.path("pipe.ply")), f"pipe, format {form}")

    def test_written(self):
        """What brio writes as LAS and as LAZ is the same to every decoder."""
        import laspy
        backends = [laspy.LazBackend.Lazrs, laspy.LazBackend.LazrsParallel]
        if not missing("laszip"):
            backends.append(laspy.LazBackend.Laszip)
        for form in (0, 1, 2, 3, 6, 7, 8):
            las = self.make(form, 120000)
            las.write(self.path("a.las"))
            self.convert(self.path("a.las"), self.path("b.las"))
            self.convert(self.path("a.las"), self.path("b.laz"))
            plain = laspy.read(self.path("b.las"))
            for name in las.point_format.dimension_names:
                self.expect_equal(las[name], plain[name], f"format {form}: {name}")
            for backend in backends:
                packed = laspy.read(self.path("b.laz"), laz_backend=backend)
                self.assertEqual(packed.header.point_format, plain.header.point_format)
                for name in plain.point_format.dimension_names:
                    self.expect_equal(plain[name], packed[name], f"format {form}, {backend}: {name}")
            self.expect_points(las, self.read(self.path("b.laz")), f"format {form}")

    def test_names_of_all_fields_are_opened(self):
        """Properties with the names of laspy's own fields, whose values fit none of them."""
        import laspy
        names = {"X", "Y", "Z"}
        for form in range(11):
            names |= set(laspy.PointFormat(form).dimension_names)
        names -= {"red", "green", "blue"}  # which are colours whatever their values
        names = sorted(names | {"Intensity", "bit_fields", "raw_classification", "x_t", "a" * 40, "a" * 41, "\u03bc" * 20})
        with open(self.path("a.ply"), "w") as file:
            file.write("ply\nformat ascii 1.0\nelement vertex 5\n")
            file.writelines(f"property double {name}\n" for name in ["x", "y", "z"] + names)
            file.write("end_header\n")
            file.writelines("%d 0 0 %s\n" % (i, " ".join(["%.2f" % (i + 0.25)] * len(names))) for i in range(5))
        for target in ("b.las", "b.laz"):
            self.convert(self.path("a.ply"), self.path(target))
            las = laspy.read(self.path(target))
            extra = list(las.point_format.extra_dimension_names)
            self.assertEqual(len(set(extra)), len(names) - ("gps_time" in names))
            for name in extra:
                self.expect_equal(las[name], numpy.arange(5) + 0.25, name)

    def test_what_stands_beside_the_points(self):
        import laspy
        wkt = 'PROJCS["own",GEOGCS["base"],UNIT["m",1],AUTHORITY["EPSG","32633"]]'
        las = self.make(7, 1000)
        las.header.system_identifier, las.header.generating_software = "OWN", "own 1"
        las.header.global_encoding.gps_time_type = laspy.header.GpsTimeType.STANDARD
        las.header.global_encoding.wkt = True
        las.header.vlrs.append(laspy.vlrs.known.WktCoordinateSystemVlr(wkt))
        las.evlrs = laspy.vlrs.vlrlist.VLRList([laspy.VLR("own", 5, "note", bytes(70000))])
        las.write(self.path("a.las"))
        for target in ("b.las", "b.laz"):
            self.convert(self.path("a.las"), self.path(target))
            read = laspy.read(self.path(target))
            self.assertEqual(read.vlrs.get("WktCoordinateSystemVlr")[0].string, wkt)
            self.assertEqual([(v.user_id, v.record_id, len(v.record_data)) for v in read.evlrs], [("own", 5, 70000)])
            self.assertEqual((read.header.system_identifier, read.header.generating_software), ("OWN", "own 1"))
            self.assertEqual(read.header.global_encoding.value & 17, 17)
            self.assertEqual(read.header.creation_date, las.header.creation_date)

    def test_chunks_of_different_sizes(self):
        import io
        import lazrs
        for form in (3, 7):
            las = self.make(form, 1000)
            buffer = io.BytesIO()
            las.write(buffer)
            plain = bytearray(buffer.getvalue())
            record = las.point_format.size
            start = int.from_bytes(plain[96:100], "little")
            vlr = lazrs.LazVlr.new_for_compression(form, las.point_format.num_extra_bytes,
                                                   use_variable_size_chunks=True)
            chunks = io.BytesIO()
            chunks.write(bytes(start))
            compressor = lazrs.LasZipCompressor(chunks, vlr)
            for begin, end in ((0, 1), (1, 400), (400, 1000)):
                compressor.compress_many(numpy.frombuffer(plain, numpy.uint8)[start + begin * record:
                                                                             start + end * record])
                compressor.finish_current_chunk()
            compressor.done()
            size = int.from_bytes(plain[94:96], "little")
            data = bytes(vlr.record_data())
            head = bytes(2) + b"laszip encoded".ljust(16, b"\0") + (22204).to_bytes(2, "little") + \
                len(data).to_bytes(2, "little") + bytes(32)
            shift = len(head) + len(data)
            body = bytearray(chunks.getvalue()[start:])
            body[:8] = (int.from_bytes(body[:8], "little") + shift).to_bytes(8, "little")
            plain[96:100] = (start + shift).to_bytes(4, "little")
            plain[100:104] = (int.from_bytes(plain[100:104], "little") + 1).to_bytes(4, "little")
            plain[104] |= 128
            with open(self.path("v.laz"), "wb") as file:
                file.write(bytes(plain[:size]) + head + data + bytes(plain[size:start]) + bytes(body))
            self.expect_points(las, self.read(self.path("v.laz")), f"chunks, format {form}")

    def test_write(self):
        """What brio writes of a file is that file, to the last bit of every field."""
        import laspy
        for form in (0, 1, 2, 3, 6, 7, 8):
            las = self.make(form, 5000)
            las.write(self.path("a.laz"))
            self.convert(self.path("a.laz"), self.path("b.las"))
            again = laspy.read(self.path("b.las"))
            self.assertEqual(again.header.point_format.id, form)
            self.expect_equal(las.header.scales, again.header.scales, "scales")
            self.expect_equal(las.header.offsets, again.header.offsets, "offsets")
            for name in las.point_format.dimension_names:
                self.expect_equal(las[name], again[name], f"format {form}: {name}")

    def test_lidar(self):
        """Real points through LAS, LAZ and back. Those on a grid keep their last bit."""
        import laspy
        folder = os.path.join(SHARED, "data", "lidar")
        if not os.path.isdir(folder):
            self.skipTest("there is no folder of shared data")
        for name, exact in (("csite4", True), ("room_scan1", False)):
            points = self.read(os.path.join(folder, name + ".ply"))
            self.convert(os.path.join(folder, name + ".ply"), self.path("a.las"))
            laspy.read(self.path("a.las")).write(self.path("a.laz"))
            plain, compressed = self.read(self.path("a.las")), self.read(self.path("a.laz"))
            for axis in "xyz":
                self.expect_equal(plain[axis], compressed[axis], f"{name}: {axis}")
                if exact:
                    self.expect_equal(points[axis].astype(float), plain[axis], f"{name}: {axis}")
                self.assertLess(numpy.abs(points[axis].astype(float) - plain[axis]).max(), 1e-7)


class NpyTest(ForeignTest):
    def test_rows(self):
        for kind in ("<f8", ">f8", "<f4", "<i4", "<u2", "<i8"):
            for order in "CF":
                rows = numpy.array(self.random.integers(0, 60000, (100, 5)), dtype=kind, order=order)
                numpy.save(self.path("a.npy"), rows)
                points = self.read(self.path("a.npy"))
                for i, name in enumerate(("x", "y", "z", "column4", "column5")):
                    self.expect_equal(rows[:, i].astype(float), points[name].astype(float), f"{kind} {order} {name}")

    def test_records(self):
        records = numpy.zeros(50, dtype=[("red", "u1"), ("z", "<f4"), ("x", "<f8"), ("y", ">i2"), ("time", "<f8")])
        for name in records.dtype.names:
            records[name] = self.random.integers(0, 200, 50)
        numpy.save(self.path("a.npy"), records)
        points = self.read(self.path("a.npy"))
        self.convert(self.path("a.npy"), self.path("b.npy"))
        again = numpy.load(self.path("b.npy"))
        for name in records.dtype.names:
            self.expect_equal(records[name].astype(float), points[name].astype(float), name)
            self.expect_equal(records[name].astype(float), again[name].astype(float), name)

    def test_names_with_escapes(self):
        names = ["x", "y", "z", "a\\b", "\\", "it's", 'so "called"', "\\'\"", "h\u00f6he", "x" * 63]
        records = numpy.zeros(5, dtype=[(name, "<f8") for name in names])
        for name in names:
            records[name] = self.random.standard_normal(5)
        numpy.save(self.path("a.npy"), records)
        self.convert(self.path("a.npy"), self.path("b.npy"))
        again = numpy.load(self.path("b.npy"))
        self.assertEqual(again.dtype.names, (*names[:5], "it_s", "so__called_", "\\__", *names[8:]))
        for name, written in zip(names, again.dtype.names):
            self.expect_equal(records[name], again[written], name)

    def test_names_in_utf8_of_version_2(self):
        """As brio 0.1 wrote them; NumPy reads such a name as Latin-1."""
        fields = ", ".join("('%s', '<f8')" % name for name in ("x", "y", "z", "h\u00f6he"))
        text = "{'descr': [%s], 'fortran_order': False, 'shape': (1,), }\n" % fields
        header = text.encode()
        with open(self.path("a.npy"), "wb") as f:
            f.write(b"\x93NUMPY\x02\x00" + len(header).to_bytes(4, "little") + header + numpy.arange(4.0).tobytes())
        self.convert(self.path("a.npy"), self.path("b.npy"))
        self.assertEqual(numpy.load(self.path("b.npy")).dtype.names, ("x", "y", "z", "h\u00f6he"))

    def test_write_rows(self):
        rows = self.random.standard_normal((30, 3))
        numpy.save(self.path("a.npy"), rows)
        self.convert(self.path("a.npy"), self.path("b.npy"))
        self.expect_equal(rows, numpy.load(self.path("b.npy")), "rows")


@unittest.skipIf(missing("trimesh"), missing("trimesh"))
class TrimeshStlTest(ForeignTest):
    def test_both_ways(self):
        import trimesh
        sphere = trimesh.creation.icosphere(subdivisions=2)
        for kind in ("stl", "stl_ascii"):
            with open(self.path("a.stl"), "wb") as file:
                data = sphere.export(file_type=kind)
                file.write(data.encode() if isinstance(data, str) else data)
            self.convert(self.path("a.stl"), self.path("b.stl"))
            self.convert(self.path("a.stl"), self.path("b.ply"))
            for name in ("b.stl", "b.ply"):
                again = trimesh.load(self.path(name))
                self.assertTrue(again.is_watertight)
                self.assertEqual((len(again.vertices), len(again.faces)), (len(sphere.vertices), len(sphere.faces)))
                self.assertAlmostEqual(again.volume, sphere.volume, places=5)


@unittest.skipIf(missing("meshio"), missing("meshio"))
class MeshioStlTest(ForeignTest):
    def test_both_ways(self):
        import meshio
        points = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
        faces = numpy.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
        for binary in (False, True):
            meshio.Mesh(points, [("triangle", faces)]).write(self.path("a.stl"), binary=binary)
            self.convert(self.path("a.stl"), self.path("b.stl"))
            again = meshio.read(self.path("b.stl"))
            self.assertEqual((len(again.points), len(again.cells_dict["triangle"])), (4, 4))


@unittest.skipIf(missing("pypcd4"), missing("pypcd4"))
class PcdTest(ForeignTest):
    def test_read(self):
        from pypcd4 import Encoding, PointCloud
        n = 5000
        names, types = ("x", "y", "z", "intensity", "ring"), (numpy.float32,) * 4 + (numpy.uint16,)
        columns = [self.random.standard_normal(n).astype(numpy.float32).round(2) for _ in range(4)]
        columns.append(self.random.integers(0, 64, n).astype(numpy.uint16))
        cloud = PointCloud.from_points(columns, names, types)
        for encoding in (Encoding.ASCII, Encoding.BINARY, Encoding.BINARY_COMPRESSED):
            cloud.save(self.path("a.pcd"), encoding)
            points = self.read(self.path("a.pcd"))
            for name, column in zip(names, columns):
                found = points[name].astype(column.dtype) if encoding is Encoding.ASCII else points[name]
                self.expect_equal(column, found, f"{encoding}: {name}")


@unittest.skipIf(missing("pye57"), missing("pye57"))
class E57Test(ForeignTest):
    """Files that libE57Format writes, against what it reads of them."""

    COLUMNS = {"intensity": "intensity", "colorRed": "red", "colorGreen": "green", "colorBlue": "blue",
               "rowIndex": "row_index", "columnIndex": "column_index"}

    def read(self, path):
        run = subprocess.run([FILES, path, self.path("probe.ply")], capture_output=True, check=False)
        if b"without the library expat" in run.stderr:
            self.skipTest("brio was built without the library expat")
        return super().read(path)

    def make(self, poses, n=30000):
        import pye57
        random = self.random
        file = pye57.E57(self.path("a.e57"), mode="w")
        for rotation, translation in poses:
            data = {name: random.standard_normal(n) * 10 for name in ("cartesianX", "cartesianY", "cartesianZ")}
            data["intensity"] = random.random(n)
            data.update({name: random.integers(0, 256, n).astype("u1") for name in self.COLUMNS if "color" in name})
            data.update(rowIndex=numpy.arange(n) // 300, columnIndex=numpy.arange(n) % 300,
                        cartesianInvalidState=(numpy.arange(n) % 7 == 3).astype("i1"))
            file.write_scan_raw(data, rotation=numpy.array(rotation), translation=numpy.array(translation))
        file.close()

    def expect_scan(self, scan, points):
        import pye57
        file = pye57.E57(self.path("a.e57"))
        raw = file.read_scan(scan, ignore_missing_fields=True, intensity=True, colors=True, row_column=True)
        for k, axis in enumerate("xyz"):
            self.assertLess(numpy.abs(raw["cartesian" + axis.upper()] - points[axis]).max(), 1e-12, axis)
        for name, column in self.COLUMNS.items():
            self.expect_equal(raw[name], points[column], name)

    def test_one_scan(self):
        self.make([([1, 0, 0, 0], [0, 0, 0])])
        points = self.read(self.path("a.e57"))
        self.assertNotIn("scan", points.dtype.names)
        self.expect_scan(0, points)

    def test_scans_with_poses(self):
        self.make([([1, 0, 0, 0], [0, 0, 0]), ([0.5, 0.5, -0.5, 0.5], [100, -2, 0.3]), ([0.8, 0, 0.6, 0], [0, 0, 7])])
        points = self.read(self.path("a.e57"))
        for scan in range(3):
            self.expect_scan(scan, points[points["scan"] == scan])

    def test_scaled_integers(self):
        """Numbers of odd widths and of none, to the last bit."""
        import pye57
        from pye57 import libe57
        n, random = 5000, self.random
        file = pye57.E57(self.path("a.e57"), mode="w")
        image = file.image_file
        prototype, scan = libe57.StructureNode(image), libe57.StructureNode(image)
        fields = {"cartesianX": libe57.ScaledIntegerNode(image, 0, -5000000, 5000000, 0.001, 638982.55),
                  "cartesianY": libe57.FloatNode(image, 0.0, libe57.FloatPrecision.E57_DOUBLE, -1e300, 1e300),
                  "cartesianZ": libe57.ScaledIntegerNode(image, 0, 0, 2**40, 1e-7, -7.3),
                  "rowIndex": libe57.IntegerNode(image, 0, 0, 2**18), "returnIndex": libe57.IntegerNode(image, 3, 3, 3)}
        for name, node in fields.items():
            prototype.set(name, node)
        points = libe57.CompressedVectorNode(image, prototype, libe57.VectorNode(image, True))
        scan.set("guid", libe57.StringNode(image, "{1}"))
        scan.set("points", points)
        file.data3d.append(scan)
        data = {"cartesianX": random.integers(-5000000, 5000001, n) * 0.001 + 638982.55,
                "cartesianY": random.standard_normal(n), "cartesianZ": random.integers(0, 2**40 + 1, n) * 1e-7 - 7.3,
                "rowIndex": random.integers(0, 2**18 + 1, n), "returnIndex": numpy.full(n, 3, "u1")}
        writer = points.writer(self.buffers(image, data, n))
        writer.write(n)
        writer.close()
        file.close()
        file = pye57.E57(self.path("a.e57"))
        expected = {name: numpy.zeros(n) for name in data}
        reader = file.data3d[0]["points"].reader(self.buffers(file.image_file, expected, n))
        self.assertEqual(reader.read(), n)
        reader.close()
        found = self.read(self.path("a.e57"))
        for name, column in zip(data, ("x", "y", "z", "row_index", "return_index")):
            self.expect_equal(expected[name], found[column], name)

    @staticmethod
    def buffers(image, arrays, n):
        from pye57 import libe57
        buffers = libe57.VectorSourceDestBuffer()
        for name, array in arrays.items():
            buffers.append(libe57.SourceDestBuffer(image, name, array, n, True, True))
        return buffers

    def test_pipe(self):
        self.make([([1, 0, 0, 0], [0, 0, 0])], 100)
        with open(self.path("a.e57"), "rb") as file:
            run = subprocess.run(["sh", "-c", f"cat | '{FILES}' - {self.path('pipe.ply')}"], stdin=file,
                                 capture_output=True, check=False)
        self.assertNotEqual(run.returncode, 0)
        self.assertIn(b"which a pipe does not allow", run.stderr)


if __name__ == "__main__":
    main()
