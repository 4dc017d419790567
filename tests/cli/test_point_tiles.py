"""convert --tiles: the files of all tiles together are the file without tiles; indexes; what a run leaves behind."""

import collections
import json
import os
import random
import resource
import shutil
import signal
import struct
import subprocess
import time
import unittest
import xml.etree.ElementTree

from brio_cli import BRIO, CliTest, main

posix_alone = unittest.skipIf(os.environ.get("BRIO_EMULATED") == "wine", "skipped: Windows has no such names, limits, locks or disks")

LIDAR = os.path.join(os.path.dirname(__file__), "..", "..", "..", "shared", "data", "lidar")
RANGES = {"char": (-2**7, 2**7 - 1), "uchar": (0, 2**8 - 1), "short": (-2**15, 2**15 - 1), "ushort": (0, 2**16 - 1),
          "int": (-2**31, 2**31 - 1), "uint": (0, 2**32 - 1)}
FORMATS = "laz las ply npy csv xyz pcd e57 ptx pts xyzrgb xyzn vtp vtu vtk off obj node".split()


class PointTiles(CliTest):
    def scratch(self):
        os.makedirs(self.path("scratch"), exist_ok=True)
        return self.path("scratch")

    def tiles(self, count, *arguments, **how):
        """The facts of a run with tiles, which leaves nothing in the scratch folder."""
        facts = self.facts("convert", *arguments, "--tiles", str(count), "--scratch", self.scratch(), **how)
        self.assertEqual(os.listdir(self.scratch()), [])
        return facts

    def bytes_of(self, name):
        with open(self.path(name), "rb") as f:
            return f.read()

    def features(self, index):
        with open(self.path(index), encoding="utf-8") as f:
            cloud = json.load(f)
        self.assertEqual(cloud["type"], "FeatureCollection")
        return cloud["features"]

    def files(self, index):
        """The paths of the files that an index names."""
        if index.endswith(".pvtp"):
            names = [piece.get("Source") for piece in xml.etree.ElementTree.parse(self.path(index)).iter("Piece")]
        else:
            names = [feature["assets"]["data"]["href"] for feature in self.features(index)]
        return [os.path.join(os.path.dirname(self.path(index)), name) for name in names]

    def rows(self, path):
        """The head and the points of a file as lines of text."""
        self.expect(0, "convert", path, self.path("rows.csv"), "--quiet")
        with open(self.path("rows.csv"), encoding="utf-8") as f:
            return f.readline(), f.read().splitlines()

    def same(self, whole, index):
        """Compares the files of tiles with the one file of all points, as multisets; and their orders."""
        head, all_rows = self.rows(self.path(whole))
        place = {row: i for i, row in enumerate(all_rows)}
        found = collections.Counter()
        for path in self.files(index):
            of_tile, rows = self.rows(path)
            self.assertEqual(of_tile, head)
            found.update(rows)
            if len(place) == len(all_rows):
                places = [place.get(row, -1) for row in rows]
                self.assertEqual(places, sorted(places), "the order of the input")
        self.assertEqual(found, collections.Counter(all_rows))

    def random_ply(self, name, count, rng, at=None):
        """Points with properties of random types."""
        properties = [(rng.choice([*RANGES, "float", "double"]), "p%d" % i) for i in range(rng.randrange(7))]
        if rng.random() < 0.5:
            properties += [(rng.choice(("uchar", "ushort", "float")), colour) for colour in ("red", "green", "blue")][:3]
            properties[-3:] = [(properties[-3][0], colour) for colour in ("red", "green", "blue")]
        with open(self.path(name), "w", encoding="ascii") as f:
            f.write("ply\nformat ascii 1.0\nelement vertex %d\n" % count)
            f.writelines("property double %s\n" % axis for axis in "xyz")
            f.writelines("property %s %s\n" % each for each in properties)
            f.write("end_header\n")
            for _ in range(count):
                row = list(at or [round(rng.gauss(0, 1), 3) for _ in range(3)])
                for kind, of in properties:
                    if of in ("red", "green", "blue"):
                        row.append(round(rng.random(), 3) if kind == "float" else rng.randrange(256))
                    else:
                        row.append(rng.randint(*RANGES[kind]) if kind in RANGES else round(rng.gauss(0, 100), 2))
                f.write(" ".join(map(str, row)) + "\n")
        return self.path(name)

    def test_files_together_are_the_file_without_tiles(self):
        rng = random.Random(1)
        for form in FORMATS:
            edges = ((0, None), (1, None), (5, None), (30, (1, 2, 3))) if form in ("laz", "ply", "e57", "vtp") else ()
            for count, at in ((400, None), *edges):
                tiles = rng.randint(1, 12)
                with self.subTest(format=form, count=count, tiles=tiles):
                    points = self.random_ply("in.ply", count, rng, at)
                    whole = self.facts("convert", points, self.path("whole." + form))
                    facts = self.tiles(tiles, points, "-o", self.path("out.vpc"), "--format", form)
                    for key in "points", "lost", "renamed", "moved", "merged":
                        self.assertEqual(facts.get(key), whole.get(key), key)
                    self.same("whole." + form, "out.vpc")
                    self.assertEqual(facts["tiles"], sum(f["properties"]["pc:count"] > 0 for f in self.features("out.vpc")))
                    self.assertEqual(facts["largest_tile"], max(f["properties"]["pc:count"] for f in self.features("out.vpc")))

    def test_tiles_have_about_as_many_points(self):
        points = self.cloud("a.ply", 200000, "clusters")
        facts = self.tiles(7, points, self.path("out.vpc"), "--format", "ply")
        self.assertEqual((facts["points"], facts["tiles"]), (200000, 7))
        self.assertLess(facts["largest_tile"], 1.1 * 200000 / 7)
        self.assertEqual(facts["scratch_bytes"], 2 * 24 * 200000)

    def test_files_are_the_same_for_every_number_of_threads(self):
        points = self.random_ply("in.ply", 70000, random.Random(3))
        for form in "laz", "vtp", "ply":
            written = []
            for threads in "1", "3":
                self.tiles(5, points, self.path("t%s.vpc" % threads), "--format", form, "--threads", threads)
                written.append([self.bytes_of(path) for path in self.files("t%s.vpc" % threads)])
            self.assertEqual(*written, form)

    def las(self, name, count, rng, wkt=b"", offset=1000.0):
        """A LAS file of version 1.4, point format 7, with an extra number, a scale of 0.01 and a coordinate system."""
        extra = struct.pack("<2xBB32s4x", 3, 0, b"deviation").ljust(192, b"\0")
        records = [(b"LASF_Spec", 4, extra)] + ([(b"LASF_Projection", 2112, wkt + b"\0")] if wkt else [])
        vlrs = b"".join(struct.pack("<H16sHH32s", 0, user, number, len(data), b"") + data for user, number, data in records)
        rows = b"".join(struct.pack("<3iHBBBBhHd3HH", *(rng.randrange(100000) for _ in range(3)), rng.randrange(65536), 0x11, 0,
                                    rng.randrange(20), rng.randrange(256), rng.randrange(-30000, 30000), rng.randrange(100),
                                    1e8 + rng.randrange(10**6) / 1e3, *(rng.randrange(65536) for _ in range(3)),
                                    rng.randrange(65536)) for _ in range(count))
        header = struct.pack("<4sHHIHH8sBB32s32sHHHIIBHI20s", b"LASF", 0, 16, 0, 0, 0, b"", 1, 4, b"scanner", b"maker", 61, 2024, 375,
                             375 + len(vlrs), len(records), 7, 38, 0, b"")
        header += struct.pack("<6d", 0.01, 0.01, 0.01, offset, -offset, 0) + struct.pack("<6d", *(0,) * 6)
        header += struct.pack("<QQIQ15Q", 0, 0, 0, count, count, *(0,) * 14)
        return self.file(name, header + vlrs + rows)

    def test_tiles_of_lidar_keep_all(self):
        points = self.las("a.las", 3000, random.Random(5), b'PROJCS["here"]')
        kept = ("format", "version", "coordinate_step", "coordinate_origin", "properties", "crs", "metadata")
        for form in "las", "laz":
            self.facts("convert", points, self.path("whole." + form))
            self.tiles(4, points, self.path("out.vpc"), *(["--format", "las"] if form == "las" else []))
            self.same("whole." + form, "out.vpc")
            whole = self.facts("info", self.path("whole." + form))
            for path in self.files("out.vpc"):
                tile = self.facts("info", path)
                self.assertEqual({key: tile.get(key) for key in kept}, {key: whole.get(key) for key in kept})
                self.assertEqual(os.path.splitext(path)[1], "." + form)
                with open(path, "rb") as f:
                    header = f.read(375)
                self.assertEqual(header[26:33], b"scanner")
                count, = struct.unpack_from("<Q", header, 247)
                self.assertEqual((count, struct.unpack_from("<Q", header, 255)[0]), (tile["points"],) * 2)  # first returns
        self.assertEqual({feature["properties"]["datetime"] for feature in self.features("out.vpc")}, {"2024-03-01T00:00:00Z"})
        names = {schema["name"] for schema in self.features("out.vpc")[0]["properties"]["pc:schemas"]}
        self.assertLessEqual({"X", "Intensity", "Classification", "GpsTime", "Red", "deviation"}, names)

    def test_schemas_were_those_of_the_input(self):
        """A format lacks some properties, and has others by other types."""
        cloud = self.file("a.ply", "ply\nformat ascii 1.0\nelement vertex 9\nproperty double x\nproperty double y\nproperty double z\n"
                          "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float nx\nproperty float ny\nproperty float nz\n"
                          "property int count\nend_header\n" + "".join("%d %d %d 1 2 3 0 0 1 -7\n" % (i, i * i, i % 3) for i in range(9)))
        sizes = {"int8": (1, "signed"), "uint8": (1, "unsigned"), "int16": (2, "signed"), "uint16": (2, "unsigned"), "int32": (4, "signed"),
                 "uint32": (4, "unsigned"), "float32": (4, "floating"), "float64": (8, "floating")}
        names = {"red": "Red", "green": "Green", "blue": "Blue", "nx": "NormalX", "ny": "NormalY", "nz": "NormalZ"}
        for form in "laz", "las", "ply", "e57", "xyzrgb", "npy", "csv", "obj":
            with self.subTest(form):
                self.tiles(2, cloud, self.path("out.vpc"), "--format", form)
                schemas = [(s["name"], s["size"], s["type"]) for s in self.features("out.vpc")[0]["properties"]["pc:schemas"]]
                held = self.facts("info", self.files("out.vpc")[0]).get("properties", {})
                held = {names.get(name, name): sizes[kind] for name, kind in held.items()}
                self.assertEqual(schemas[:3], [(axis, 8, "floating") for axis in "XYZ"])
                written = {name: (size, kind) for name, size, kind in schemas[3:]}
                self.assertEqual({name: written.get(name) for name in names.values() if name in held or name in written},
                                 {name: held.get(name) for name in names.values() if name in held or name in written})
                self.assertEqual(len(written), len(held))

    def test_one_grid_fits_all_tiles(self):
        # each tile would fit a grid of less decimals, and each file had another one
        with open(self.path("a.csv"), "w", encoding="ascii") as f:
            f.write("x,y,z\n")
            f.writelines("%d,%.1f,0\n" % (i, i / 10) for i in range(500))
            f.writelines("%d.123,%d,1\n" % (i, i) for i in range(500, 1000))
        self.facts("convert", self.path("a.csv"), self.path("whole.las"))
        self.tiles(6, self.path("a.csv"), self.path("out.vpc"), "--format", "las")
        self.same("whole.las", "out.vpc")
        keys = "coordinate_step", "coordinate_origin"
        whole = self.facts("info", self.path("whole.las"))
        for path in self.files("out.vpc"):
            tile = self.facts("info", path)
            self.assertEqual([tile[key] for key in keys], [whole[key] for key in keys])

    def test_real_lidar(self):
        if not os.path.isdir(LIDAR):
            self.skipTest("skipped: no ../shared/data")
        points = os.path.join(LIDAR, "csite4.ply")
        facts = self.tiles(9, points, self.path("out.vpc"))
        self.assertEqual(facts["tiles"], 9)
        self.facts("convert", points, self.path("whole.laz"))
        self.same("whole.laz", "out.vpc")

    def test_options_work_before_the_division(self):
        rng = random.Random(7)
        with open(self.path("a.csv"), "w", encoding="ascii") as f:
            f.writelines("%.3f;%.3f;%.3f;%d\n" % (*(rng.gauss(0, 1) for _ in range(3)), i) for i in range(2000))
        self.file("bad.csv", "x,y,z,q\n0,0,0,1\nnan,0,0,2\n" + "".join("%d,%d,%d,3\n" % (i, i * i, i) for i in range(40)))
        self.facts("generate", "cube", "-n", "900", "-o", self.path("torn.ply"))
        self.file("torn.ply", self.bytes_of("torn.ply")[:-1000])
        for form, arguments in (
                ("ply", ["a.csv", "--crop", "-1,-1,-1,1,0.5,1"]), ("ply", ["a.csv", "--thin", "0.3"]), ("laz", ["a.csv", "--drop-outliers", "8"]),
                ("ply", ["a.csv", "--crop", "-1,-1,-1,1,0.5,1", "--thin", "0.2", "--drop-outliers", "6"]),
                ("ply", ["a.csv", "--float32"]), ("pcd", ["a.csv", "--float32", "--compress"]), ("vtp", ["a.csv", "--compress"]),
                ("ply", ["a.csv", "--ascii"]), ("ply", ["a.csv", "--columns", "y,z,x,q"]), ("ply", ["a.csv", "--columns", "x,y,z,-"]),
                ("ply", ["bad.csv", "--drop-invalid"]), ("ply", ["torn.ply", "--salvage"]), ("ply", ["a.csv", "--crop", "8,8,8,9,9,9"])):
            with self.subTest(form, arguments=arguments):
                given = [self.path(arguments[0]), *arguments[1:]]
                whole = self.facts("convert", *given, "-o", self.path("whole." + form))
                facts = self.tiles(4, *given, "-o", self.path("out.vpc"), "--format", form)
                for key in whole:
                    if key not in ("output", "seconds", "peak_bytes", "warnings", "hints", "streamed"):
                        self.assertEqual(facts.get(key), whole[key], key)
                self.assertEqual(len(facts.get("warnings", [])), len(whole.get("warnings", [])))
                self.same("whole." + form, "out.vpc")

    def test_a_dark_beginning_was_taken_for_all_colours(self):
        with open(self.path("dark.csv"), "w", encoding="ascii") as f:  # two blocks; each tile but one is dark
            f.write("x,y,z,red,green,blue\n")
            f.writelines("%d,0,0,%d,0,0\n" % (i, 200 if i > 69000 else i % 2) for i in range(70000))
        for form in "ply", "vtp", "obj":
            self.tiles(9, self.path("dark.csv"), self.path("out.vpc"), "--format", form)
            self.facts("convert", self.path("dark.csv"), self.path("whole." + form))
            self.same("whole." + form, "out.vpc")

    def test_origins_of_glb_are_numbers_of_single_precision(self):
        """Programs keep the places of nodes in single precision, and would move tiles against each other."""
        draw = random.Random(3)
        cloud = self.file("map.csv", "x,y,z\n" + "".join("%r,%r,%r\n" % (638982.55 + 90 * draw.random(), 4912345.75 + 90 * draw.random(), 3 * draw.random())
                                                        for _ in range(2000)))
        self.tiles(4, cloud, self.path("map.vpc"), "--format", "glb")
        origins = set()
        for path in self.files("map.vpc"):
            with open(path, "rb") as f:
                head = struct.unpack("<5I", f.read(20))
                node, = json.loads(f.read(head[3]))["nodes"]
            origins.add(tuple(node["translation"]))
            self.assertEqual(struct.unpack("3f", struct.pack("3f", *node["translation"])), tuple(node["translation"]))
        self.assertEqual(len(origins), 4)

    def test_a_tile_had_other_colours_where_those_of_all_are_no_colours(self):
        with open(self.path("a.csv"), "w", encoding="ascii") as f:
            f.write("x,y,z,red,green,blue\n")
            f.writelines("%d,0,0,%s,%d,%d\n" % (i, i / 4 if i < 20 else i, 70000 if i == 25 else i, -1 if i == 5 else 1) for i in range(40))
        for form in "vtp", "vtu", "vtk", "obj", "glb", "ply", "laz":
            with self.subTest(form):
                whole = self.facts("convert", self.path("a.csv"), self.path("whole." + form))
                facts = self.tiles(8, self.path("a.csv"), self.path("out.vpc"), "--format", form)
                self.same("whole." + form, "out.vpc")
                self.assertEqual([facts.get(key) for key in ("lost", "renamed", "moved")], [whole.get(key) for key in ("lost", "renamed", "moved")])

    def test_scans_of_tiles_had_other_numbers(self):
        with open(self.path("a.csv"), "w", encoding="ascii") as f:
            f.write("x,y,z,scan,x_origin,y_origin,z_origin\n")
            f.writelines("%d,0,0,%d,%d,0,0\n" % (i, i // 10, i // 10 * 5) for i in range(40))
        for tiles in 1, 3, 4:
            facts = self.tiles(tiles, self.path("a.csv"), self.path("out.vpc"), "--format", "e57")
            self.assertEqual((facts["lost"], facts.get("renamed")), ([], None))
            for path in self.files("out.vpc"):
                head, rows = self.rows(path)
                columns = head.strip().split(",")
                for row in rows:
                    point = dict(zip(columns, map(float, row.split(","))))
                    self.assertEqual(point["scan"], point["x"] // 10)
        facts = self.tiles(3, self.path("a.csv"), self.path("out.vpc"), "--format", "ptx")  # the last tile begins with no 0
        self.assertIn("scan", facts["lost"])

    def test_faces_are_left_out(self):
        self.file("a.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n")
        facts = self.tiles(2, self.path("a.off"), self.path("out.pvtp"))
        self.assertEqual((facts["lost"], facts["points"], facts["faces"]), (["faces"], 4, 0))
        self.assertIn("out.pvtp is without: faces", facts["warnings"][0])

    def test_several_inputs(self):
        rng = random.Random(9)
        with open(self.path("all.csv"), "w", encoding="ascii") as all_points:
            all_points.write("x,y,z,a,b\n")
            for name, head in (("1.csv", "x,y,z,a,b\n"), ("2.csv", "b,a,x,y,z\n"), ("3.csv", "x,y,z,a,b\n")):
                rows = [[rng.randrange(1000) for _ in range(5)] for _ in range(rng.randrange(300))]
                all_points.writelines(",".join(map(str, row)) + "\n" for row in rows)
                if head[0] == "b":
                    rows = [[row[4], row[3], *row[:3]] for row in rows]
                self.file(name, head + "".join(",".join(map(str, row)) + "\n" for row in rows))
        inputs = [self.path("%d.csv" % i) for i in (1, 2, 3)]
        facts = self.tiles(3, *inputs, self.path("out.vpc"), "--format", "ply")
        self.assertEqual(facts["input"], inputs)
        self.facts("convert", self.path("all.csv"), self.path("whole.ply"))
        self.same("whole.ply", "out.vpc")
        self.facts("convert", self.path("all.csv"), self.path("thin.ply"), "--thin", "200")
        self.tiles(3, *inputs, "-o", self.path("thin.vpc"), "--format", "ply", "--thin", "200")
        self.same("thin.ply", "thin.vpc")
        self.usage("two outputs", "convert", *inputs[:2], "-o", self.path("x.ply"))
        self.usage("3 inputs; several go with --tiles", "convert", *inputs, "-o", self.path("x.ply"))

    def test_inputs_that_do_not_go_together_are_refused(self):
        rng = random.Random(2)
        first = self.las("a.las", 50, rng, b'PROJCS["here"]')
        others = {"another coordinate system": self.las("b.las", 50, rng, b'PROJCS["there"]'),
                  "is not in both": self.file("c.csv", "x,y,z,q\n1,2,3,4\n")}
        for words, other in others.items():
            run = self.expect(2, "convert", first, other, self.path("out.vpc"), "--tiles", "2", "--scratch", self.scratch())
            self.assertRegex(run.err, os.path.basename(other) + ".*" + words)
        self.assertFalse(any(name.startswith("out") for name in os.listdir(self.folder)))

    def test_inputs_of_different_codes_of_coordinate_systems_were_taken(self):
        """Systems that are told by their codes alone differ if these do, and one without a code is not one with it."""
        head = "ply\nformat ascii 1.0\n%selement vertex 1\nproperty double x\nproperty double y\nproperty double z\nend_header\n1 2 3\n"
        first, same, other, none = (self.file(name, head % crs) for name, crs in (
            ("a.ply", "comment crs EPSG:25832\n"), ("b.ply", "comment crs EPSG:25832\n"), ("c.ply", "comment crs EPSG:25833\n"), ("d.ply", "")))
        self.assertEqual(self.tiles(2, first, same, "-o", self.path("out.vpc"))["points"], 2)
        for a, b in ((first, other), (first, none), (none, first)):
            run = self.expect(2, "convert", a, b, self.path("x.vpc"), "--tiles", "2", "--scratch", self.scratch())
            self.assertRegex(run.err, os.path.basename(b) + ".*another coordinate system")

    def test_standard_input_and_pipes(self):
        points = self.random_ply("in.ply", 500, random.Random(4))
        with open(points, "rb") as f:
            facts = self.tiles(3, "-", "-o", self.path("out.vpc"), "--thin", "0.1", stdin=f.read())
        whole = self.facts("convert", points, self.path("whole.laz"), "--thin", "0.1")
        self.assertEqual(facts["points"], whole["points"])
        self.same("whole.laz", "out.vpc")

    def test_the_index_is_a_virtual_point_cloud(self):
        points = self.random_ply("in.ply", 900, random.Random(6))
        facts = self.tiles(5, points, self.path("out.vpc"))
        for number, feature in enumerate(self.features("out.vpc")):
            of = feature["properties"]
            self.assertEqual((feature["type"], feature["stac_version"], feature["links"]), ("Feature", "1.0.0", []))
            self.assertEqual(feature["assets"]["data"]["href"], "./out/%d.laz" % number)
            tile = self.facts("info", self.path("out/%d.laz" % number))
            self.assertEqual((of["pc:count"], of["pc:encoding"], of["datetime"], of["proj:wkt2"]), (tile["points"], "laz", None, ""))
            for k in range(6):
                self.assertAlmostEqual(of["proj:bbox"][k], (tile["box"]["min"] + tile["box"]["max"])[k], delta=1e-9)
            ring = feature["geometry"]["coordinates"][0]
            self.assertEqual((len(ring), ring[0]), (5, ring[4]))
            self.assertEqual((min(ring), max(ring)), (of["proj:bbox"][:2], of["proj:bbox"][3:5]))
        self.assertEqual(sum(f["properties"]["pc:count"] for f in self.features("out.vpc")), facts["points"])

    def test_the_index_of_vtk_names_the_arrays_of_the_files(self):
        for more in [], ["--ascii"], ["--compress"], ["--float32"]:
            self.tiles(3, self.random_ply("in.ply", 300, random.Random(8)), self.path("out.pvtp"), *more)
            index = xml.etree.ElementTree.parse(self.path("out.pvtp")).getroot()
            self.assertEqual(index.get("type"), "PPolyData")

            def arrays(tree, section, tag):
                return [[a.get(key) for key in ("type", "Name", "NumberOfComponents")] for a in tree.iter(section).__next__().iter(tag)]

            for path in self.files("out.pvtp"):
                with open(path, "rb") as f:
                    head = f.read().partition(b"<AppendedData")[0].replace(b"</VTKFile>", b"").strip() + b"</VTKFile>"
                tile = xml.etree.ElementTree.fromstring(head)
                for section in "Points", "PointData":
                    self.assertEqual(arrays(index, "P" + section, "PDataArray"), arrays(tile, section, "DataArray"))
            self.assertEqual(sum(self.facts("info", path)["points"] for path in self.files("out.pvtp")), 300)

    @posix_alone
    def test_names_that_have_to_be_quoted(self):
        points = self.random_ply("in.ply", 60, random.Random(1))
        for name in 'a"b\\c\n&<d>.vpc', 'a"b&<d>.pvtp', "a#b.VPC":
            for _ in range(2):  # the second run finds the files of the first one by its index
                self.tiles(2, points, "-o", self.path(name))
            self.assertTrue(all(os.path.exists(path) for path in self.files(name)))
            self.assertEqual(len([n for n in os.listdir(self.folder) if n.startswith(name[:3])]), 2)
            for path in self.files(name):
                os.remove(path)
            os.rmdir(os.path.dirname(path))
            os.remove(self.path(name))

    def test_files_of_another_format_stayed(self):
        points = self.random_ply("in.ply", 60, random.Random(1))
        self.tiles(3, points, self.path("out.vpc"), "--format", "ply")
        self.tiles(2, points, self.path("out.vpc"), "--format", "las")
        self.assertEqual(sorted(os.listdir(self.folder)), ["in.ply", "out-1", "out.vpc", "scratch"])
        os.mkdir(self.path("out.part"))  # what a killed run leaves
        self.file("out.part/0.npy", "half")
        self.file("out.part/.brio-part", "3 .npy")
        self.tiles(2, points, self.path("out.vpc"))
        self.assertEqual(sorted(os.listdir(self.folder)), ["in.ply", "out", "out.vpc", "scratch"])
        self.assertEqual(sorted(os.listdir(self.path("out"))), ["0.laz", "1.laz"])

    def test_the_older_output_stayed_when_a_run_was_killed_behind_its_index(self):
        points = self.random_ply("in.ply", 60, random.Random(1))
        self.tiles(2, points, self.path("out.vpc"), "--format", "ply")
        os.rename(self.path("out"), self.path("keep"))
        self.tiles(3, points, self.path("out.vpc"))
        os.rename(self.path("out"), self.path("out-1"))  # as it is behind the index: a run names a folder, then the index, then removes the older one
        self.file("out.vpc", self.bytes_of("out.vpc").replace(b"./out/", b"./out-1/"))
        os.rename(self.path("keep"), self.path("out"))
        self.file("out/.brio-part", "    2 .ply           ")
        self.file("out/7.ply", "mine")
        self.tiles(2, points, self.path("out.vpc"))
        self.assertEqual(sorted(os.listdir(self.folder)), ["in.ply", "out", "out-2", "out.vpc", "scratch"])
        self.assertEqual(os.listdir(self.path("out")), ["7.ply"])

    def test_inputs_were_removed_with_the_older_output(self):
        points = self.random_ply("in.ply", 60, random.Random(1))
        self.tiles(2, points, self.path("out.vpc"))
        self.usage("0.laz: a file of the older output that -o replaces", "convert", self.path("out/0.laz"), "-o", self.path("out.vpc"), "--tiles", "2",
                   "--scratch", self.scratch())
        self.assertEqual(sorted(os.listdir(self.path("out"))), ["0.laz", "1.laz"])
        self.tiles(2, *self.files("out.vpc"), "-o", self.path("again.vpc"))

    @posix_alone
    def test_an_input_by_a_link_was_removed_with_the_older_output(self):
        self.tiles(2, self.random_ply("in.ply", 60, random.Random(1)), self.path("out.vpc"))
        os.symlink("out/0.laz", self.path("link.laz"))
        self.usage("link.laz: a file of the older output that -o replaces", "convert", self.path("link.laz"), "-o", self.path("out.vpc"), "--tiles", "2",
                   "--scratch", self.scratch())
        self.assertEqual(sorted(os.listdir(self.path("out"))), ["0.laz", "1.laz"])

    @posix_alone
    def test_files_of_the_user_beside_a_link_were_removed(self):
        points, mine, there = self.random_ply("in.ply", 60, random.Random(1)), self.path("mine"), self.path("there")
        commands = (("convert", "out.vpc", "laz"), ("convert", "out.pvtp", "vtp"), ("delaunay", "out.pvtu", "vtu"), ("alpha", "out.pvtp", "vtp"))
        for command, name, extension in commands:
            more = ("--alpha", "1e9") if command == "alpha" else ()
            for folder in mine, there:
                os.mkdir(folder)
            os.symlink("../there/next-" + name, os.path.join(mine, name))  # a link to a link, which leads to nothing yet
            os.symlink(name, os.path.join(there, "next-" + name))
            os.mkdir(os.path.join(mine, "out"))
            for i in range(2):
                self.file("mine/out/%d.%s" % (i, extension), "mine")
            for folder in "out", "out-1", "out":
                self.facts(command, points, *more, "-o", os.path.join(mine, name), "--tiles", "2", "--scratch", self.scratch())
                self.assertEqual(sorted(os.listdir(there)), sorted([folder, name, "next-" + name]), command)
                self.assertEqual(sorted(os.listdir(os.path.join(there, folder))), ["0." + extension, "1." + extension])
                self.assertIn(b"%s/1.%s" % (folder.encode(), extension.encode()), self.bytes_of("there/" + name))
                self.assertEqual([self.bytes_of("mine/out/%d.%s" % (i, extension)) for i in range(2)], [b"mine"] * 2)
                self.assertEqual(sorted(os.listdir(mine)), ["out", name])
            shutil.rmtree(mine)
            shutil.rmtree(there)

    @posix_alone
    def test_files_behind_a_link_in_place_of_the_older_folder_were_removed(self):
        points, out = self.random_ply("in.ply", 60, random.Random(1)), self.path("out.vpc")
        self.tiles(2, points, "-o", out)
        os.rename(self.path("out"), self.path("mine"))
        os.symlink("mine", self.path("out"))
        self.tiles(2, points, "-o", out)
        self.assertEqual(sorted(os.listdir(self.path("mine"))), ["0.laz", "1.laz"])
        self.assertIn(b"./out-1/0.laz", self.bytes_of("out.vpc"))

    @posix_alone
    def test_a_link_to_nothing_had_the_name_of_the_folder(self):
        points = self.random_ply("in.ply", 60, random.Random(1))
        os.symlink("nowhere", self.path("out"))
        self.tiles(2, points, "-o", self.path("out.vpc"))
        self.assertEqual(sorted(os.listdir(self.folder)), ["in.ply", "out", "out-1", "out.vpc", "scratch"])
        os.symlink("nowhere", self.path("out.part"))
        run = self.expect(6, "convert", self.path("none.ply"), "-o", self.path("out.vpc"), "--tiles", "2", "--scratch", self.scratch())
        self.assertIn("out.part: is in the way", run.err)  # said before the input is opened

    @posix_alone
    def test_a_link_of_the_output_led_to_another_kind_of_name(self):
        points = self.random_ply("in.ply", 60, random.Random(1))
        for end, code, sentence in (("out", 1, "no name of a .vpc file"), (".vpc", 1, "no name of a .vpc file"),
                                    ("out.pvtp", 1, "no name of a .vpc file"), ("none/out.vpc", 6, "cannot write into the folder .*none")):
            os.symlink(end, self.path("link.vpc"))
            run = self.expect(code, "convert", points, "-o", self.path("link.vpc"), "--tiles", "2", "--scratch", self.scratch())
            self.assertRegex(run.err, sentence)
            os.remove(self.path("link.vpc"))
        self.assertEqual(sorted(os.listdir(self.folder)), ["in.ply", "scratch"])

    def test_files_that_the_index_of_another_program_names_were_removed(self):
        points = self.random_ply("in.ply", 60, random.Random(1))
        for name, rewrite in (("out.vpc", lambda text: json.dumps(json.loads(text), indent=2).encode()), ("out.pvtp", lambda text: text.replace(b"\n<P", b"\n  <P"))):
            self.tiles(2, points, "-o", self.path(name))
            self.file(name, rewrite(self.bytes_of(name)))
            before = [self.bytes_of(path) for path in self.files(name)]
            self.tiles(2, points, "-o", self.path(name))
            self.assertEqual([self.bytes_of("out/%d.%s" % (i, "laz" if name == "out.vpc" else "vtp")) for i in range(2)], before)
            shutil.rmtree(self.path("out"))
            shutil.rmtree(self.path("out-1"))

    @posix_alone
    def test_line_ends_in_a_name_were_blanks_in_the_index_of_vtk(self):
        points, name = self.random_ply("in.ply", 60, random.Random(1)), "a\tb\nc\rd.pvtp"
        for _ in range(2):  # the second run finds the files of the first one by its index
            self.tiles(2, points, "-o", self.path(name))
            self.assertTrue(all(os.path.exists(path) for path in self.files(name)))
        self.assertEqual(sorted(os.listdir(self.folder)), sorted([name[:-5] + "-1", name, "in.ply", "scratch"]))

    def test_standard_input_named_twice_was_empty_the_second_time(self):
        self.usage("standard input is named twice", "convert", "-", "-", "-o", self.path("x.vpc"), "--tiles", "2", "--scratch", self.scratch())

    def test_what_cannot_be_is_refused(self):
        points, out, how = self.random_ply("in.ply", 20, random.Random(1)), self.path("x.vpc"), ["--tiles", "2", "--scratch", self.scratch()]
        for words, arguments in (("writes an index, .vpc", [self.path("x.laz"), *how]), ("writes an index, .vpc", ["-o", "-", "--format", "laz", *how]),
                                 ("writes an index, .vpc", [self.path(".vpc"), *how]), ("--tiles needs --scratch", [out, "--tiles", "2"]),
                                 ("--merge: not with --tiles", [out, *how, "--merge"]), ("70000 are more than 65536", [out, "--tiles", "70000", *how[2:]]),
                                 ("an index of .vtp files", [self.path("x.pvtp"), "--format", "laz", *how]), ("cannot be compressed", [out, "--compress", *how]),
                                 ("have points alone, and an STL file has triangles alone", [out, "--format", "stl", *how]),
                                 ("an index of tiles", [out]), ("--format zzz", [out, "--format", "zzz", *how]),
                                 ("expected A B, got one file", how)):
            with self.subTest(words):
                self.usage(words, "convert", points, *arguments)
        self.expect(2, "convert", points, out, "--tiles", "2", "--scratch", self.path("missing"))
        self.expect(2, "convert", self.file("bad.ply", "ply\nnothing"), out, *how)
        self.expect(2, "convert", self.file("nan.csv", "x,y,z\n1,2,3\nnan,1,2\n"), out, *how)
        self.expect(6, "convert", points, self.path("missing/x.vpc"), *how)
        self.assertEqual(os.listdir(self.scratch()), [])
        self.assertFalse(any(name.startswith("x") for name in os.listdir(self.folder)))

    def test_too_little_memory_is_said_before_the_work(self):
        points, how = self.cloud("a.npy", 300000), ["--format", "vtp", "--scratch", self.scratch(), "--max-memory"]
        run = self.expect(4, "convert", points, self.path("out.vpc"), "--tiles", "1", *how, "38M")
        self.assertRegex(run.err, r"the largest of 1 tiles has 300000 points.*take about 2 tiles")
        self.facts("convert", points, self.path("out.vpc"), "--tiles", "2", *how, "38M")
        self.facts("convert", points, self.path("out.vpc"), "--tiles", "1", "--format", "laz", *how[2:], "38M")
        run = self.expect(4, "convert", points, self.path("out.vpc"), "--tiles", "3", *how, "12M")
        self.assertIn("points in tiles need about", run.err)
        self.assertEqual(os.listdir(self.scratch()), [])

    def test_memory_is_that_of_blocks(self):
        points = self.cloud("big.ply", 3000000)  # 72 MB
        facts = self.tiles(3, points, self.path("out.vpc"), "--threads", "1")
        self.assertLess(facts["peak_bytes"], 40e6)

    @posix_alone
    def test_a_full_disk_is_said(self):
        points, command = self.cloud("a.ply", 20000), ["convert", self.path("a.ply"), self.path("out.vpc"), "--tiles", "2"]
        self.tiles(3, points, self.path("out.vpc"), "--format", "ply")
        before = {path: self.bytes_of(path) for path in [self.path("out.vpc"), *self.files("out.vpc")]}
        for size, form, words in ((100000, "laz", "cannot write a scratch file: File too large"), (481000, "csv", r"out\.part/\d.csv: File too large")):
            run = subprocess.run([BRIO, *command, "--scratch", self.scratch(), "--format", form, "--quiet"], stderr=subprocess.PIPE, check=False, preexec_fn=lambda most=size: (
                signal.signal(signal.SIGXFSZ, signal.SIG_IGN), resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))))
            self.assertEqual(run.returncode, 6, run.stderr)
            self.assertRegex(run.stderr.decode(), words)
            self.assertEqual(sorted(os.listdir(self.folder)), ["a.ply", "out", "out.vpc", "scratch"])
            self.assertEqual(os.listdir(self.scratch()), [])
            self.assertEqual({path: self.bytes_of(path) for path in before}, before)

    @posix_alone
    def test_too_small_a_disk_is_said_before_the_work(self):
        points, disk = self.cloud("a.ply", 100000), self.scratch()  # 2.4 MB, twice
        line = 'mount -t tmpfs -o size=$2 none "$1" && shift 2 && exec "$0" "$@"'
        for size, words in (("4m", "a.ply need about 5 MB more on this disk, which has room for 4 MB"), ("5200k", None)):
            run = subprocess.run(["unshare", "-rm", "sh", "-c", line, BRIO, disk, size, "convert", points, self.path("out.vpc"), "--tiles", "2",
                                  "--scratch", disk, "--quiet"], stderr=subprocess.PIPE, check=False)
            if run.returncode in (1, 32, 126, 127):
                self.skipTest("skipped: no disks of one's own here: " + run.stderr.decode())
            self.assertEqual(run.returncode, 6 if words else 0, run.stderr)
            self.assertIn(words or "", run.stderr.decode())

    def test_runs_killed_at_random_moments_leave_the_older_output(self):
        points = self.cloud("a.ply", 60000)
        command = ("convert", points, "-o", self.path("out.vpc"), "--format", "csv", "--tiles", "5", "--scratch", self.scratch())
        begin = time.monotonic()
        self.facts(*command)
        seconds = time.monotonic() - begin
        before = [self.bytes_of(path) for path in self.files("out.vpc")]
        rng = random.Random(3)
        for _ in range(50 if os.environ.get("BRIO_LONG") else 5):
            process = subprocess.Popen([BRIO, *command, "--quiet"], stdout=subprocess.DEVNULL)
            time.sleep(rng.random() * seconds)
            process.kill()
            process.wait()
            self.assertEqual([self.bytes_of(path) for path in self.files("out.vpc")], before)
            self.assertEqual(os.listdir(self.scratch()), [])  # scratch files have no names
            self.facts(*command)
            self.assertEqual([self.bytes_of(path) for path in self.files("out.vpc")], before)
            self.assertEqual(len(os.listdir(self.folder)), 4, os.listdir(self.folder))

    def test_an_interrupted_run_leaves_nothing(self):
        points = self.cloud("a.ply", 300000)
        for wait in 0.05, 0.3, 0.6:
            process = subprocess.Popen([BRIO, "convert", points, self.path("out.vpc"), "--format", "csv", "--tiles", "8", "--scratch", self.scratch(), "--quiet"],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(wait)
            process.send_signal(signal.SIGINT)
            if process.wait() == 0:
                break
            self.assertEqual(process.returncode, 130)
            self.assertEqual(sorted(os.listdir(self.folder)), ["a.ply", "scratch"])
            self.assertEqual(os.listdir(self.scratch()), [])

    def test_tiles_of_tetrahedra_were_not_compressed(self):
        points = self.cloud("a.ply", 300)
        self.facts("delaunay", points, "-o", self.path("t.pvtu"), "--compress", "--tiles", "2", "--scratch", self.scratch())
        self.assertIn(b"vtkZLibDataCompressor", self.bytes_of("t/0.vtu"))


if __name__ == "__main__":
    main()
