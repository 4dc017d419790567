"""LAS and LAZ: what a file says beside its points is kept, shown or named; extra bytes of every kind; files that end early."""

import os
import struct
import subprocess

from brio_cli import BRIO, CliTest, main
from whole_files import described, las, vlr

WKT = 'PROJCS["own zone",GEOGCS["base",AUTHORITY["EPSG","4326"]],UNIT["m",1],AUTHORITY["EPSG","32633"]]'
KEYS = struct.pack("<12H", 1, 1, 0, 2, 3072, 0, 1, 25832, 1026, 34737, 9, 0)
TYPES = "xBbHhIiQqfd"  # of extra bytes, by their number


class Las(CliTest):
    def convert(self, source, target, *options):
        return self.facts("convert", self.path(source), self.path(target), *options)

    def columns(self, name):
        """The properties of a file by their names."""
        with open(self.path("columns.csv"), "wb") as f:
            f.write(self.expect(0, "convert", self.path(name), "-o", "-", "--format", "csv").out)
        with open(self.path("columns.csv")) as f:
            rows = [line.rstrip("\n").split(",") for line in f]
        return {name: [float(row[k]) for row in rows[1:]] for k, name in enumerate(rows[0])}

    def make(self, name, **how):
        return self.file(name, las(**how))

    def header(self, name):
        with open(self.path(name), "rb") as f:
            return f.read()

    def records(self, name):
        """User, number and bytes of all records of variable length."""
        data, found = self.header(name), []
        at, early = struct.unpack("<H", data[94:96])[0], struct.unpack("<I", data[100:104])[0]
        late, count = struct.unpack("<QI", data[235:247]) if data[25] >= 4 else (0, 0)
        for i in range(early + count):
            if i == early:
                at = late
            user, ident = data[at + 2:at + 18].rstrip(b"\0").decode(), struct.unpack("<H", data[at + 18:at + 20])[0]
            length = struct.unpack("<H" if i < early else "<Q", data[at + 20:at + (22 if i < early else 28)])[0]
            at += 54 if i < early else 60
            found.append((user, ident, data[at:at + length]))
            at += length
        return found

    # --- extra bytes

    def test_several_lists_of_extra_bytes_are_one(self):
        # only the last one counted, from the first extra byte on
        extra = lambda i: struct.pack("<HBf", 3840 + i, i, i / 2)
        self.make("a.las", extra=extra, vlrs=[vlr("LASF_Spec", 4, described("deviation", 3)),
                                              vlr("LASF_Spec", 4, described("confidence", 1) + described("height", 9))])
        columns = self.columns("a.las")
        self.assertEqual(columns["deviation"], [3840, 3841, 3842, 3843])
        self.assertEqual((columns["confidence"], columns["height"]), ([0, 1, 2, 3], [0, 0.5, 1, 1.5]))

    def test_extra_bytes_described_behind_the_points(self):
        self.make("a.las", minor=4, form=6, extra=lambda i: struct.pack("<h", -i),
                  evlrs=[vlr("LASF_Spec", 4, described("step", 4), late=True)])
        self.assertEqual(self.columns("a.las")["step"], [0, -1, -2, -3])

    def test_extra_bytes_of_every_type(self):
        kinds = range(1, 31)
        width = lambda k: (k - 1) // 10 + 1
        extra = lambda i: b"".join(struct.pack("<%d%s" % (width(k), TYPES[(k - 1) % 10 + 1]), *range(i, i + width(k)))
                                   for k in kinds)
        self.make("a.las", extra=extra, vlrs=[vlr("LASF_Spec", 4, b"".join(described("n%d" % k, k) for k in kinds))])
        for name in ("a.las", "b.las", "b.laz"):
            if name != "a.las":
                self.assertEqual(self.convert("a.las", name)["lost"], [], name)
            columns = self.columns(name)
            for k in kinds:
                for j in range(width(k)):
                    one = "n%d" % k if width(k) == 1 else "n%d_%d" % (k, j)
                    self.assertEqual(columns[one], [j, 1 + j, 2 + j, 3 + j], (name, one))

    def test_scaled_numbers_and_their_descriptions_are_kept(self):
        extra = lambda i: struct.pack("<hQ", 100 * i - 7, 2 ** 40 + i)
        lists = described("deviation", 4, 31, (0.01,), (2.5,), "own text") + described("stamp", 7, 1, text="ns")
        self.make("a.las", extra=extra, vlrs=[vlr("LASF_Spec", 4, lists)])
        self.convert("a.las", "b.las")
        self.assertEqual(self.records("b.las"), [("LASF_Spec", 4, lists)])
        self.assertEqual(self.columns("b.las"), self.columns("a.las"))
        # other values than the description has become numbers of their own type
        self.file("c.csv", "x,y,z,deviation\n0,0,0,0.12345\n")
        self.convert("c.csv", "c.las")
        self.assertEqual(self.columns("c.las")["deviation"], [0.12345])

    def test_integers_beyond_doubles_are_named(self):
        self.make("a.las", extra=lambda i: struct.pack("<Q", 2 ** 53 + i), vlrs=[vlr("LASF_Spec", 4, described("t", 7))])
        self.assertEqual(self.convert("a.las", "b.las")["lost"], ["last digits of integers of 64 bits"])

    def test_extra_bytes_that_are_not_read_are_named(self):
        four = lambda i: struct.pack("<I", i)
        cases = {"nothing describes": [], "without a type": [vlr("LASF_Spec", 4, described("blob", 0, 4))],
                 "reserved type": [vlr("LASF_Spec", 4, described("odd", 77))],
                 "not in the records": [vlr("LASF_Spec", 4, described("wide", 10))]}
        for why, lists in cases.items():
            self.make("a.las", extra=four, vlrs=lists)
            self.assertIn(why, " ".join(self.convert("a.las", "b.las")["lost"]), why)
            self.assertIn(why, " ".join(self.facts("info", self.path("a.las"))["left_out"]), why)

    # --- what a file says beside its points

    def test_everything_is_kept_from_las_to_las(self):
        long = bytes(range(256)) * 300
        own = [("own", 7, b"note"), ("LASF_Spec", 0, bytes([2]) + b"ground".ljust(15, b"\0"))]
        self.make("a.las", form=7, minor=4, encoding=17 + 8, system=b"OWN SCANNER", software=b"own 1", date=(123, 2024),
                  vlrs=[vlr("LASF_Projection", 2112, WKT.encode() + b"\0")] + [vlr(*r) for r in own],
                  evlrs=[vlr("own", 8, long, late=True)])
        for name in ("b.las", "b.laz"):
            self.assertEqual(self.convert("a.las", name)["lost"], [], name)
            records = [r for r in self.records(name) if r[0] != "laszip encoded"]
            self.assertEqual(records, [("LASF_Projection", 2112, WKT.encode() + b"\0")] + own + [("own", 8, long)], name)
            data = self.header(name)
            self.assertEqual(data[6:8], b"\x19\0")
            self.assertEqual((data[26:58].rstrip(b"\0"), data[58:90].rstrip(b"\0")), (b"OWN SCANNER", b"own 1"))
            self.assertEqual(struct.unpack("<HH", data[90:94]), (123, 2024))

    def test_the_type_of_times_is_kept(self):
        # without the flag, times are seconds of a week
        for form, minor in ((1, 2), (6, 4)):
            self.make("a.las", form=form, minor=minor, encoding=1)
            self.convert("a.las", "b.las")
            self.assertEqual(self.header("b.las")[6] & 1, 1)
        self.assertEqual(self.convert("a.las", "b.ply")["lost"], ["las.gps_time"])

    def test_keys_of_a_coordinate_system(self):
        keys = [vlr("LASF_Projection", 34735, KEYS), vlr("LASF_Projection", 34737, b"own name|\0")]
        self.make("a.las", vlrs=keys)
        self.assertEqual({k: self.facts("info", self.path("a.las"))["crs"][k] for k in ("code", "name")},
                         {"code": "EPSG:25832", "name": "own name"})
        self.assertEqual(self.convert("a.las", "b.las")["lost"], [])
        self.assertEqual([r[1] for r in self.records("b.las")], [34735, 34737])
        self.assertEqual(self.convert("a.las", "b.ply")["lost"], ["crs"])
        run = self.expect(3, "convert", self.path("a.las"), self.path("c.ply"), "--crs", self.path("c.prj"))
        self.assertRegex(run.err, "no coordinate system as well-known text.*EPSG:25832")
        self.assertFalse(os.path.exists(self.path("c.ply")) or os.path.exists(self.path("c.prj")))

    def test_text_of_a_coordinate_system(self):
        for late in (False, True):
            record = [vlr("LASF_Projection", 2112, WKT.encode() + b"\0", late=late)]
            self.make("a.las", minor=4, form=6, encoding=16, **{"evlrs" if late else "vlrs": record})
            self.assertEqual(self.facts("info", self.path("a.las"))["crs"],
                             {"wkt": WKT, "code": "EPSG:32633", "name": "own zone"})
            report = self.convert("a.las", "b.ply", "--crs", self.path("b.prj"))
            self.assertEqual(report["lost"], [])
            with open(self.path("b.prj")) as f:
                self.assertEqual(f.read(), WKT)
            os.unlink(self.path("b.prj"))
            # a pipe's points go by before its last records
            with open(self.path("a.las"), "rb") as f:
                run = subprocess.run("cat | '%s' convert - '%s' --json" % (BRIO, self.path("c.ply")), shell=True, input=f.read(),
                                     capture_output=True, check=True)
            self.assertIn(b'"lost": ["records behind the points of a pipe"]' if late else b'"lost": ["crs"]', run.stdout)

    def test_a_coordinate_system_in_the_comments_of_ply(self):
        long = WKT[:-1] + "".join(',AXIS["axis %d \u00e4  of  blanks",EAST]' % i for i in range(40)) + "]"
        for wkt in (WKT, long):
            self.make("a.las", minor=4, form=6, encoding=16, vlrs=[vlr("LASF_Projection", 2112, wkt.encode() + b"\0")])
            for options in ([], ["--ascii"]):
                self.assertEqual(self.convert("a.las", "b.ply", "--crs-comment", *options)["lost"], [])
                with open(self.path("b.ply"), "rb") as f:
                    lines = f.read().split(b"end_header")[0].split(b"\n")
                self.assertLess(max(map(len, lines)), 220)
                self.assertEqual(self.convert("b.ply", "c.las")["lost"], [])
                self.assertEqual(self.records("c.las")[0][2].rstrip(b"\0").decode(), wkt)
        self.make("k.las", vlrs=[vlr("LASF_Projection", 34735, KEYS)])
        self.assertEqual(self.convert("k.las", "k.ply", "--crs-comment")["lost"], [])
        self.assertEqual(self.facts("info", self.path("k.ply"))["crs"], {"code": "EPSG:25832"})
        self.usage("comments of PLY files only", "convert", self.path("k.las"), self.path("k.npy"), "--crs-comment")
        self.file("o.ply", "ply\nformat ascii 1.0\ncomment crs of mine\nelement vertex 0\nproperty float x\nproperty float y\n"
                           "property float z\nend_header\n")
        self.assertNotIn("crs", self.facts("info", self.path("o.ply")))

    def test_waveforms_and_indices_are_named(self):
        self.make("a.las", form=4, minor=3, vlrs=[vlr("LASF_Spec", 100, bytes(26))])
        self.assertEqual(self.convert("a.las", "b.las")["lost"], ["waveforms"])
        self.make("a.las", minor=4, form=6, vlrs=[vlr("copc", 1, bytes(160))],
                  evlrs=[vlr("copc", 1000, bytes(32), late=True), vlr("LAStools", 30, bytes(8), late=True)])
        self.assertEqual(self.convert("a.las", "b.las")["lost"], ["COPC index", "LAStools index"])

    def test_records_that_end_early_are_named(self):
        whole = las(minor=4, form=6, evlrs=[vlr("own", 1, bytes(100), late=True)])
        for missing, name in ((1, "record own/1, which ends early"), (110, "records behind the points, which end early")):
            self.file("a.las", whole[:-missing])
            self.assertEqual(self.convert("a.las", "b.las")["lost"], [name])

    # --- versions, times, colours

    def test_version_1_5(self):
        for encoding, shift, moved in ((17, 0, 0), (17 + 64, 1000, 0), (17 + 64, 1300, 3e8)):
            self.make("a.las", minor=5, form=6, encoding=encoding, shift=shift)
            self.assertEqual(self.facts("info", self.path("a.las"))["version"], "1.5, point format 6")
            self.assertEqual(self.columns("a.las")["gps_time"], [moved + i for i in range(4)])
        self.file("a.las", las(minor=5, form=6).replace(b"\1\5", b"\1\6", 1))
        self.bad_input("version 1.6, expected 1.0 to 1.5", "info", self.path("a.las"))

    def test_colours_of_8_bits_are_found_over_the_whole_file(self):
        late = lambda i: (0, 7, 255) if i < 69999 else (0, 7, 256)
        for n, rgb, depth in ((70000, late, None), (69999, late, "8"), (9, lambda i: (0, 0, 0), None)):
            self.make("a.las", form=2, n=n, rgb=rgb)
            self.convert("a.las", "a.laz")
            for name in ("a.las", "a.laz"):
                metadata = self.facts("info", self.path(name)).get("metadata", {})
                self.assertEqual(metadata.get("colour.depth"), depth, (n, name))

    def test_colours_of_bytes_become_those_of_16_bits(self):
        self.file("a.csv", "x,y,z,red,green,blue\n0,0,0,1,2,255\n")
        self.convert("a.csv", "b.npy")
        self.file("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                  "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n0 0 0 1 2 255\n")
        self.convert("a.ply", "b.las")
        columns = self.columns("b.las")
        self.assertEqual([columns[c] for c in ("red", "green", "blue")], [[257], [514], [65535]])

    # --- names

    def test_names_of_fields_are_no_names_of_extra_bytes(self):
        # the intensity of a scan from 0 to 1 stood in the file twice, and other readers refused it
        self.file("a.csv", "x,y,z,intensity,Classification,return_number,synthetic\n0,0,0,0.5,7,16,1.5\n")
        report = self.convert("a.csv", "b.las")
        self.assertEqual(report["lost"], [])
        self.assertEqual(report["renamed"], ["intensity", "Classification", "return_number", "synthetic"])
        columns = self.columns("b.las")
        self.assertEqual([columns[c][0] for c in ("intensity_2", "classification", "return_number_2", "synthetic_2")],
                         [0.5, 7, 16, 1.5])

    def test_long_names_and_other_alphabets(self):
        names = ["long_name_that_goes_on_and_on_for_ever_%d" % i for i in range(3)] + ["\u03bc" * 17, "\u03bc" * 18]
        self.file("a.csv", "x,y,z,%s\n0,0,0,1,2,3,4,5\n" % ",".join(names))
        report = self.convert("a.csv", "b.las")
        self.assertEqual((report["lost"], report["renamed"]), ([], names))
        columns = self.columns("b.las")
        self.assertEqual([columns[c] for c in list(columns)[-5:]], [[1], [2], [3], [4], [5]])
        self.assertTrue(all(len(c.encode()) <= 32 for c in columns))

    # --- files that are damaged, or of other programs

    def test_a_file_that_ends_early(self):
        whole = las(n=60000, form=3, rgb=lambda i: (i % 65536, 9, 9))
        self.file("a.las", whole)
        self.convert("a.las", "a.laz")
        with open(self.path("a.laz"), "rb") as f:
            packed = f.read()
        for name, data, least in (("b.las", whole[:-50], 59998), ("b.laz", packed[:-200], 50001), ("c.laz", packed[:-3], 59990)):
            self.file(name, data)
            self.expect(2, "convert", self.path(name), self.path("d.las"))
            report = self.convert(name, "d.las", "--salvage")
            self.assertGreaterEqual(report["points"], least, name)
            self.assertEqual(report["points"] + report.get("missing", 0), 60000, name)
            columns = self.columns("d.las")
            self.assertEqual(columns["red"], list(range(report["points"])), name)

    def test_laszip_1_is_called_so(self):
        self.make("a.las")
        self.convert("a.las", "a.laz")
        data = bytearray(self.header("a.laz"))
        at = data.index(b"laszip encoded") - 2 + 54
        data[at + 34 + 4] = 1  # the version of the first item
        self.file("b.laz", bytes(data))
        self.bad_input("compressed by LASzip 1", "info", self.path("b.laz"))

    def test_compressed_into_a_pipe(self):
        self.make("a.las", n=60000, form=7, minor=4)
        self.convert("a.las", "b.laz")
        piped = self.expect(0, "convert", self.path("a.las"), "-o", "-", "--format", "laz").out
        self.file("c.laz", piped)
        self.assertEqual(self.columns("c.laz"), self.columns("b.laz"))
        with open(self.path("b.laz"), "rb") as f:
            b = f.read()
        for threads in ("1", "2"):
            self.convert("a.las", "d.laz", "--threads", threads)
            with open(self.path("d.laz"), "rb") as f:
                self.assertTrue(f.read() == b, threads)

    def test_compressed_files_of_no_points_and_of_one(self):
        for n in (0, 1, 2):
            for form, minor in ((0, 2), (6, 4)):
                self.make("a.las", n=n, form=form, minor=minor)
                self.convert("a.las", "b.laz")
                self.assertEqual(self.facts("info", self.path("b.laz"))["points"], n)

    def test_files_of_other_people(self):
        folder = os.environ.get("BRIO_SHARED", "")
        if not os.path.exists(os.path.join(folder, "repro", "reports", "chunk0.laz")):
            self.skipTest("skipped: no files of shared/repro")
        at = lambda *name: os.path.join(folder, "repro", *name)
        with open(at("reports", "two_extra_vlrs.las"), "rb") as f:
            self.file("a.las", f.read())
        columns = self.columns("a.las")
        self.assertEqual((columns["deviation"], columns["confidence"]), ([3840, 1], [6, 2]))
        self.facts("convert", at("reports", "chunk0.laz"), self.path("b.las"))
        self.assertEqual(self.columns("b.las")["x"], list(range(10)))
        self.assertEqual(self.facts("info", at("reports", "truncated.las"), "--salvage")["missing"], 1)
        for name, depth in (("f6_rgb8.las", "8"), ("f6_rgb8_14.las", "8"), ("f6_rgb16.las", None)):
            self.assertEqual(self.facts("info", at("field", name))["metadata"].get("colour.depth"), depth)


if __name__ == "__main__":
    main()
