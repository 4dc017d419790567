"""--tiles: the same report as without, and the same cells; files for each tile, runs that are killed and resumed."""

import fcntl
import json
import os
import random
import re
import resource
import signal
import struct
import subprocess
import time
import unittest
import xml.etree.ElementTree

from brio_cli import BRIO, CliTest, main

# tests/targets says by what a program of another system runs
posix_alone = unittest.skipIf(os.environ.get("BRIO_EMULATED") == "wine", "skipped: Windows has no such names, limits, locks or disks")

SAME = "points vertices duplicates hidden dimension tetrahedra hull_facets checksum weighted".split()


class Tiles(CliTest):
    def rows(self, name, count, weight=False):
        rng = random.Random(5)
        with open(self.path(name), "w", encoding="ascii") as f:
            f.write("x,y,z" + (",weight" if weight else "") + "\n")
            for _ in range(count):
                row = [round(rng.gauss(0, 1), 3) for _ in range(3)] + ([rng.randrange(3) / 100] if weight else [])
                f.write(",".join(map(str, row)) + "\n")
        return self.path(name)

    def bytes_of(self, name):
        with open(self.path(name), "rb") as f:
            return f.read()

    def scratch(self):
        os.makedirs(self.path("scratch"), exist_ok=True)
        return self.path("scratch")

    def same(self, *arguments, tiles=3):
        plain = self.facts("delaunay", *arguments)
        tiled = self.facts("delaunay", *arguments, "--tiles", str(tiles), "--scratch", self.scratch())
        self.assertEqual({key: plain[key] for key in SAME}, {key: tiled[key] for key in SAME})
        self.assertEqual(os.listdir(self.scratch()), [])
        return tiled

    def test_reports_are_those_without_tiles(self):
        facts = self.same(self.rows("a.csv", 3000), tiles=5)
        self.assertEqual(facts["tiles"], 5)
        self.assertGreater(facts["found"], 0)
        self.assertGreater(self.same(self.rows("w.csv", 3000, weight=True), tiles=4)["hidden"], 0)
        self.same(self.path("w.csv"), "--unweighted")
        self.same(self.path("a.csv"), "--weights-mod", "-9")

    def shapes(self, *arguments, tiles=3):
        """Compares alpha shapes: the reports, and the faces by the points of the input. Returns the report."""
        plain = self.facts("alpha", *arguments, "-o", self.path("whole.ply"))
        tiled = self.facts("alpha", *arguments, "--tiles", str(tiles), "--scratch", self.scratch(), "-o", self.path("tiled.ply"))
        self.assertEqual(os.listdir(self.scratch()), [])
        for report in (plain, tiled):
            for key in ("area", "volume"):
                report["certificate"][key] = "%.11g" % report["certificate"][key]
        for report in (plain, tiled):
            report.update(report.pop("internals", {}))
        same = "alpha radius samples simplices tetrahedra vertices faces split uncovered singular_vertices singular_edges singular_facets certificate".split()
        self.assertEqual({key: plain[key] for key in same}, {key: tiled[key] for key in same})
        self.assertEqual(self.placed_faces("whole.ply"), self.placed_faces("tiled.ply"))
        return tiled

    def placed_faces(self, name):
        """Faces of a PLY file by the places of their vertices, each from its least one on, sorted."""
        self.expect(0, "convert", self.path(name), self.path("text.off"))
        with open(self.path("text.off"), encoding="ascii") as f:
            words = [word for line in f if not line.startswith("#") for word in line.split()]
        n, m = int(words[1]), int(words[2])
        places = [tuple(words[4 + 3 * i:7 + 3 * i]) for i in range(n)]
        rest = words[4 + 3 * n:]
        faces = []
        for i in range(m):
            face = [places[int(v)] for v in rest[4 * i + 1:4 * i + 4]]
            first = face.index(min(face))
            faces.append(tuple(face[first:] + face[:first]))
        return sorted(faces)

    def test_alpha_shapes_are_those_without_tiles(self):
        facts = self.shapes(self.rows("a.csv", 3000), "--alpha", "0.05", tiles=5)
        self.assertEqual(facts["tiles"], 5)
        self.assertGreater(facts["split"], 0)
        self.shapes(self.rows("w.csv", 3000, weight=True), "--alpha", "0.03", tiles=4)
        self.shapes(self.path("w.csv"), "--unweighted", "--alpha", "0.5", tiles=1)
        with open(self.path("grid.csv"), "w", encoding="ascii") as f:
            f.write("x,y,z\n" + "".join("%d,%d,%d\n" % (i % 9, i // 9 % 9, i // 81) for i in range(729)))
        self.shapes(self.path("grid.csv"), "--alpha", "0.75")  # exactly the radius of each cube's sphere
        self.shapes(self.path("grid.csv"), "--alpha", "1", "--threads", "3", tiles=7)

    def same_surface(self, *arguments, tiles=3, files=()):
        """Compares surfaces and what is written beside them byte for byte. Returns the report."""
        beside = [(option, self.path("whole-" + name), self.path("tiled-" + name)) for option, name in files]
        plain = self.facts("surface", *arguments, "-o", self.path("whole.ply"), *sum(([o, w] for o, w, _ in beside), []))
        tiled = self.facts("surface", *arguments, "-o", self.path("tiled.ply"), *sum(([o, t] for o, _, t in beside), []),
                           "--tiles", str(tiles), "--scratch", self.scratch())
        self.assertEqual(os.listdir(self.scratch()), [])
        self.assertEqual(tiled["tiles"], tiles)
        same = "samples vertices faces certificate bridges holes energy".split()
        self.assertEqual({key: plain.get(key) for key in same}, {key: tiled.get(key) for key in same})
        for _, whole, other in [(None, self.path("whole.ply"), self.path("tiled.ply"))] + beside:
            self.assertEqual(self.bytes_of(whole), self.bytes_of(other))
        return tiled

    def test_surfaces_are_those_without_tiles(self):
        self.facts("generate", "scan", "--points", "9000", "-o", self.path("scan.ply"))
        self.same_surface(self.path("scan.ply"), tiles=1)
        self.same_surface(self.path("scan.ply"), tiles=2)
        self.same_surface(self.path("scan.ply"), "--closed", "--threads", "2", tiles=7, files=[("--normals", "normals.ply")])
        self.same_surface(self.path("scan.ply"), "--open", "4", "--noise", "smooth", "--simplify", tiles=64)
        rows = self.path("few.csv")  # with twins, a property, and a stray
        with open(rows, "w", encoding="ascii") as f:
            rng = random.Random(9)
            f.write("x,y,z,height\n")
            for i in range(900):
                p = [rng.gauss(0, 1) for _ in range(3)]
                r = sum(c * c for c in p) ** 0.5
                f.write(("%.3f,%.3f,%.3f,%d\n" % (*[c / r for c in p], i)) * (1 + (i % 50 == 0)))
            f.write("9,9,9,0\n")
        self.same_surface(rows, tiles=5)

    def test_surfaces_of_few_points_in_tiles(self):
        rng = random.Random(4)
        for n in (4, 5, 8, 20, 50) if not os.environ.get("BRIO_LONG") else range(4, 51):
            with open(self.path("few.csv"), "w", encoding="ascii") as f:
                f.write("x,y,z,height\n" + "".join("%.2f,%.2f,%.2f,%d\n" % (*(rng.random() for _ in range(3)), i) for i in range(n)))
            plain = self.run_brio("surface", self.path("few.csv"), "--closed", "-o", self.path("x.ply"))
            if plain.code == 0:
                self.same_surface(self.path("few.csv"), "--closed", tiles=rng.choice((1, 2, 7)))
            else:  # the points bound no solid
                tiled = self.expect(3, "surface", self.path("few.csv"), "--closed", "-o", self.path("x.ply"), "--tiles", "2", "--scratch", self.scratch())
                self.assertEqual((plain.code, plain.err), (3, tiled.err))
                self.assertEqual(os.listdir(self.scratch()), [])

    @unittest.skipUnless(os.environ.get("BRIO_LONG"), "skipped: long")
    def test_larger_surfaces_in_any_number_of_tiles(self):
        self.facts("generate", "scan", "--points", "30000", "-o", self.path("scan.ply"))
        for tiles in (1, 2, 7, 64):
            for more in ((), ("--closed", "--noise", "smooth"), ("--open", "6"), ("--simplify",), ("--noise", "keep", "--vertex-normals")):
                with self.subTest((tiles, more)):
                    self.same_surface(self.path("scan.ply"), *more, tiles=tiles, files=[("--normals", "normals.ply"), ("--left-out", "out.ply")])

    def test_points_in_a_plane_need_no_tiles(self):
        with open(self.path("ring.csv"), "w", encoding="ascii") as f:
            f.write("x,y,z\n0,0,1\n1,0,1\n1,1,1\n0,1,1\n")
        self.expect(0, "surface", self.path("ring.csv"), "-o", self.path("a.ply"))
        self.expect(0, "surface", self.path("ring.csv"), "-o", self.path("b.ply"), "--tiles", "2", "--scratch", self.scratch())
        self.assertEqual(self.bytes_of("a.ply"), self.bytes_of("b.ply"))

    def test_what_surfaces_do_not_do_in_tiles_is_refused(self):
        path, scratch, out = self.rows("a.csv", 50), self.scratch(), self.path("o.ply")
        for more, sentence in ((("--tiles", "2"), "--tiles needs --scratch DIR"),
                               (("--tiles", "2", "--scratch", scratch, "--method", "cocone"), "--tiles is for --method labeled-delaunay, and the method is cocone"),
                               (("--tiles", "2", "--scratch", scratch, "--sharp"), "the method is power-crust"),
                               (("--tiles", "2", "--scratch", scratch, "--curves"), "the method is curves"),
                               (("--tiles", "2", "--scratch", scratch, "--method", "curves"), "the method is curves"),
                               (("--tiles", "70000", "--scratch", scratch), "70000 are more than 65536"),
                               (("--tiles", "0", "--scratch", scratch), "tiles")):
            self.assertIn(sentence, self.expect(1, "surface", path, "-o", out, *more).err)
            self.assertFalse(os.path.exists(out))

    @posix_alone
    def test_a_killed_surface_in_tiles_leaves_no_output(self):
        self.facts("generate", "scan", "--points", "9000", "-o", self.path("scan.ply"))
        arguments = [BRIO, "surface", self.path("scan.ply"), "-o", self.path("o.ply"), "--tiles", "4", "--scratch", self.scratch()]
        for wait in (0.05, 0.2, 0.4):
            child = subprocess.Popen(arguments, stderr=subprocess.DEVNULL)
            time.sleep(wait)
            child.kill()
            if child.wait() == 0:
                os.remove(self.path("o.ply"))
            self.assertFalse(os.path.exists(self.path("o.ply")))
        self.facts("surface", self.path("scan.ply"), "-o", self.path("o.ply"), "--tiles", "4", "--scratch", self.scratch())
        self.assertEqual(os.listdir(self.scratch()), [])  # what the killed ones left, too

    def test_files_in_a_folder_that_is_no_store_were_removed(self):
        mine = os.path.join(self.scratch(), "brio-tiles-1")
        os.mkdir(mine)
        with open(os.path.join(mine, "mine.txt"), "w", encoding="ascii") as f:
            f.write("mine")
        with open(os.path.join(self.scratch(), "brio-tiles-2"), "w", encoding="ascii") as f:
            f.write("a file")
        os.mkdir(os.path.join(self.scratch(), "brio-tiles-3"))  # of a process that was killed before it locked it
        self.facts("surface", self.rows("a.csv", 500), "-o", self.path("o.ply"), "--tiles", "2", "--scratch", self.scratch())
        self.assertEqual(sorted(os.listdir(self.scratch())), ["brio-tiles-1", "brio-tiles-2"])
        self.assertEqual(os.listdir(mine), ["mine.txt"])

    def test_surfaces_are_counted_before_the_work(self):
        self.rows("a.csv", 60000)
        limits = ("--scratch", self.scratch(), "-o", self.path("o.ply"), "--max-memory", "11M", "--tiles")
        self.assertIn("each tile needs about 15.6 MB of the 11.5 MB that are allowed: take about 2 times as many tiles",
                      self.expect(4, "surface", self.path("a.csv"), *limits, "2").err)
        with open(self.path("twice.csv"), "w", encoding="ascii") as f:  # points that are given twice need it once
            f.write("x,y,z\n" + "".join("%r,%r,%r\n" % p for p in [(i % 7, i % 11 / 3, i % 13 / 5) for i in range(40000)]))
        self.expect(0, "surface", self.path("twice.csv"), *limits, "1")
        self.assertEqual(os.listdir(self.scratch()), [])

    @posix_alone
    def test_a_disk_too_small_for_a_surface_in_tiles_is_said_before_the_work(self):
        self.facts("generate", "scan", "--points", "5000", "-o", self.path("scan.ply"))
        line = 'mount -t tmpfs -o size=$2 none "$1" && shift 2 && exec "$0" "$@"'
        run = subprocess.run(["unshare", "-rm", "sh", "-c", line, BRIO, self.scratch(), "3800k", "surface", self.path("scan.ply"), "--tiles", "2",
                              "--scratch", self.scratch(), "-o", self.path("o.ply"), "--quiet"], stderr=subprocess.PIPE, check=False)
        if run.returncode in (1, 32, 126, 127):
            self.skipTest("skipped: no disks of one's own here: " + run.stderr.decode())
        self.assertEqual(run.returncode, 4, run.stderr)  # under three quarters of what is needed, as without tiles
        self.assertIn("4990 points need about 5 MB of scratch files, and this disk has room for 4 MB", run.stderr.decode())

    @posix_alone
    def test_a_disk_that_fills_leaves_no_surface_of_tiles(self):
        self.facts("generate", "scan", "--points", "5000", "-o", self.path("scan.ply"))
        for most in (1000, 150000, 400000):  # bytes of a file: in the points, in a tile, in the arrays
            run = subprocess.run([BRIO, "surface", self.path("scan.ply"), "--tiles", "2", "--scratch", self.scratch(), "--quiet", "-o",
                                  self.path("o.ply")], stderr=subprocess.PIPE, check=False, preexec_fn=lambda most=most: (
                                      signal.signal(signal.SIGXFSZ, signal.SIG_IGN), resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))))
            self.assertIn(run.returncode, (4, 6), run.stderr)
            self.assertIn("File too large", run.stderr.decode())
            self.assertFalse(os.path.exists(self.path("o.ply")))
            self.assertEqual(os.listdir(self.scratch()), [])

    @posix_alone
    def test_an_interrupted_surface_of_tiles_leaves_nothing(self):
        self.facts("generate", "scan", "--points", "20000", "-o", self.path("scan.ply"))
        for wait in (0.1, 0.3, 0.6):
            process = subprocess.Popen([BRIO, "surface", self.path("scan.ply"), "--tiles", "8", "--scratch", self.scratch(), "--quiet", "-o",
                                        self.path("o.ply")], stderr=subprocess.DEVNULL)
            time.sleep(wait)
            process.send_signal(signal.SIGINT)
            code = process.wait()
            self.assertIn(code, (130, -signal.SIGINT, 0))  # it may not have begun to listen, or have ended
            self.assertEqual(os.path.exists(self.path("o.ply")), code == 0)
            if code != -signal.SIGINT:
                self.assertEqual(os.listdir(self.scratch()), [])

    def test_alpha_shapes_go_to_a_file_for_each_tile(self):
        scratch, index = self.scratch(), self.path("shape.pvtp")
        facts = self.facts("alpha", self.rows("a.csv", 3000), "--alpha", "0.05", "--tiles", "4", "--scratch", scratch, "-o", index)
        pieces = [p.get("Source") for p in xml.etree.ElementTree.parse(index).iter("Piece")]
        self.assertEqual(len(pieces), 4)
        faces = sum(self.facts("info", self.path(piece))["faces"] for piece in pieces)
        self.assertEqual(faces, facts["faces"])
        first = [self.bytes_of(piece) for piece in pieces]
        self.facts("alpha", self.path("a.csv"), "--alpha", "0.05", "--tiles", "4", "--scratch", scratch, "-o", index, "--threads", "3")
        self.assertEqual(first, [self.bytes_of(p.get("Source")) for p in xml.etree.ElementTree.parse(index).iter("Piece")])
        self.assertEqual(os.listdir(scratch), [])

    def test_what_alpha_does_not_do_in_tiles_is_refused(self):
        points, tiled = self.rows("a.csv", 100), ("--tiles", "2", "--scratch", self.scratch())
        for more, sentence in ((("--alpha", "auto", "-o", "x.ply"), "--alpha auto: not with --tiles"),
                               (("--alpha", "1", "--filtration", "f.txt"), "--filtration: not with --tiles"),
                               (("--alpha", "1", "--view", "v.html"), "--view: not with --tiles"),
                               (("--alpha", "1", "--cell", "9,9,9", "-o", "x.ply"), "--cell, --periodic: not with --tiles"),
                               (("--alpha", "1", "-o", "x.stl"), r"--tiles writes \.ply, and \.pvtp"),
                               (("--alpha", "1"), "no output: -o FILE is missing")):
            self.assertRegex(self.expect(1, "alpha", points, *tiled, *more).err, sentence)
        self.assertRegex(self.expect(3, "alpha", points, *tiled, "--alpha", "1e-9", "-o", self.path("x.pvtp")).err, "no tetrahedron has a value of at most alpha")
        self.assertFalse(os.path.exists(self.path("x.pvtp")) or os.path.exists(self.path("x.part")))
        self.assertEqual(os.listdir(self.scratch()), [])

    def cells(self, *arguments, tiles=3):
        """Compares tables of cells and of faces, and the report."""
        reports = {}
        for name, more in (("whole", ()), ("tiled", ("--tiles", str(tiles), "--scratch", self.scratch()))):
            for kind in ("csv", "npy"):
                reports[name] = self.facts("voronoi", *arguments, *more, "-o", self.path("%s.%s" % (name, kind)),
                                           "--faces", self.path(name + "-faces.csv"))
        for end in (".csv", ".npy", "-faces.csv"):
            with open(self.path("whole" + end), "rb") as a, open(self.path("tiled" + end), "rb") as b:
                self.assertEqual(a.read(), b.read(), end)
        for key in reports["whole"]:
            if key not in ("output", "seconds", "peak_bytes", "warnings"):  # with tiles, duplicates are not outside
                self.assertEqual(reports["whole"][key], reports["tiled"][key], key)
        self.assertEqual(reports["tiled"]["tiles"], tiles if reports["tiled"]["points"] else 0)
        self.assertEqual(os.listdir(self.scratch()), [])
        return reports["tiled"]

    def test_a_box_without_points_had_no_volume(self):
        self.rows("none.csv", 0)
        self.assertEqual(self.cells(self.path("none.csv"), "--box", "0,0,0,1,2,3")["box_volume"], 6)

    def test_cells_are_those_without_tiles(self):
        cloud = self.rows("a.csv", 2000)
        self.assertEqual(self.cells(cloud)["cells"], 2000)
        box = self.cells(cloud, "--box", "-1,-1,-1,1,1.5,2", "--weights-mod", "-9", tiles=7)
        self.assertLess(box["box_error"], 1e-12)
        self.assertTrue(box["warnings"])
        self.assertGreater(self.cells(self.rows("w.csv", 2000, weight=True))["hidden"], 0)
        with open(self.path("grid.xyz"), "w", encoding="ascii") as f:  # ties everywhere, and duplicates
            f.writelines("%d %d %d\n" % (x, y, z % 6) for x in range(7) for y in range(7) for z in range(7))
        self.assertEqual(self.cells(self.path("grid.xyz"), tiles=4)["duplicates"], 49)

    def test_lines_of_cells_in_tiles_had_no_names(self):
        run = self.expect(0, "voronoi", self.rows("a.csv", 50), "--tiles", "2", "--scratch", self.scratch(), "-o",
                          self.path("x.csv"))
        self.assertRegex(run.out.decode(), "(?m)^largest tile  .*\n^scratch bytes ")
        self.assertNotIn("resumed", run.out.decode())

    def test_what_cells_in_tiles_have_not_is_refused(self):
        cloud, folder = self.rows("a.csv", 20), self.scratch()
        self.usage("writes cells to .npy and .csv", "voronoi", cloud, "--tiles", "2", "--scratch", folder, "-o", self.path("x.vtu"))
        self.usage("--cell, --periodic: not with --tiles", "voronoi", cloud, "--cell", "9,9,9", "--tiles", "2", "--scratch", folder, "-o", self.path("x.csv"))
        self.usage("--tiles needs --scratch", "voronoi", cloud, "--tiles", "2", "-o", self.path("x.csv"))
        with open(self.path("flat.xyz"), "w", encoding="ascii") as f:
            f.writelines("%d %d 0\n" % (i, i * i) for i in range(9))
        run = self.expect(3, "voronoi", self.path("flat.xyz"), "--tiles", "2", "--scratch", folder, "-o", self.path("x.csv"))
        self.assertIn("without tiles only", run.err)
        self.assertFalse(os.path.exists(self.path("x.csv")))
        self.assertEqual(os.listdir(folder), [])

    def layer(self, name):
        with open(self.path(name), encoding="utf-8") as f:
            return json.loads(re.search(r'class="layer">(.*?)</script>', f.read()).group(1))

    def test_what_is_shown_is_what_is_shown_without_tiles(self):
        cloud, how = self.rows("a.csv", 2000), ("--tiles", "5", "--scratch", self.scratch())
        for command, more in (("delaunay", ()), ("delaunay", ("--weights-mod", "-9")), ("voronoi", ("--box", "-1,-1,-1,1,1.5,2"))):
            facts = self.facts(command, cloud, *more, *how, "--view", self.path("tiled.html"), "--picture", self.path("p.png"), "--picture-size", "90x60")
            plain = self.facts(command, cloud, *more, "--view", self.path("whole.html"))
            tiled, whole = self.layer("tiled.html"), self.layer("whole.html")
            for key in ("all_vertices" if command == "voronoi" else "hull", "tetrahedra", "faces"):
                self.assertEqual(tiled[key], whole[key], (command, key))
            self.assertEqual(tiled["name"], "a.csv")
            self.assertEqual(os.path.getsize(self.path("p.png")), facts["picture"]["bytes"])
            left_out, plainly = ([w for w in f.get("warnings", []) if w.startswith("--view")] for f in (facts, plain))
            self.assertEqual((left_out, len(left_out)), (plainly, command == "voronoi"))
            if command == "delaunay":
                self.assertEqual((tiled["tetrahedra"], tiled["hull"]), (facts["tetrahedra"], facts["hull_facets"]))
                self.assertEqual([p["name"] for p in tiled["properties"]], ["point", "weight"] if more else ["point"])
            else:
                for key in ("components", "closed", "manifold"):
                    self.assertEqual(tiled["certificate"][key], whole["certificate"][key], key)
                self.assertAlmostEqual(tiled["certificate"]["volume"], whole["certificate"]["volume"], delta=1e-9)
        both = self.facts("voronoi", cloud, *how, "-o", self.path("c.csv"), "--view", self.path("v.html"))
        self.facts("voronoi", cloud, "-o", self.path("d.csv"))
        self.assertEqual(self.bytes_of("c.csv"), self.bytes_of("d.csv"))
        self.facts("voronoi", cloud, "--view", self.path("w.html"))
        tiled, whole = (self.layer(name)["certificate"] for name in ("v.html", "w.html"))
        self.assertEqual(tiled["components"], whole["components"])
        self.assertLess(tiled["components"], both["bounded"])
        self.assertAlmostEqual(tiled["volume"], whole["volume"], delta=1e-9)
        self.assertEqual(os.listdir(self.scratch()), [])

    def test_of_many_tetrahedra_and_cells_an_even_choice_is_shown(self):
        how = ("--tiles", "3", "--scratch", self.scratch())
        run = self.expect(0, "delaunay", self.cloud("many.npy", 32000), *how, "--view", self.path("t.html"), "--json")
        all_of_them, layer = json.loads(run.out)["tetrahedra"], self.layer("t.html")
        self.assertIn("--view: shows an even choice of 200000 of %d tetrahedra" % all_of_them, run.err)
        self.assertGreater(all_of_them, layer["tetrahedra"])
        self.assertEqual(layer["tetrahedra"], 200000)
        run = self.expect(0, "voronoi", self.cloud("sites.npy", 8500), *how, "--box", "0,0,0,1,1,1", "--view", self.path("c.html"))
        self.assertIn("500 of 8500 cells are not shown", run.err)
        self.assertEqual(self.layer("c.html")["certificate"]["components"], 8000)
        self.assertLess(abs(self.layer("c.html")["certificate"]["volume"] - 8000 / 8500), 0.01)

    def test_standard_input(self):
        with open(self.rows("a.csv", 500), "rb") as f:
            data = f.read()
        run = subprocess.run([BRIO, "delaunay", "-", "--tiles", "2", "--scratch", self.scratch(), "--json"], input=data,
                             capture_output=True, check=True)
        self.assertIn(self.facts("delaunay", self.path("a.csv"))["checksum"], run.stdout.decode())
        self.assertEqual(os.listdir(self.scratch()), [])

    def test_files_of_tiles(self):
        cloud = self.rows("a.csv", 800)
        facts = self.facts("delaunay", cloud, "--tiles", "3", "--scratch", self.scratch(), "-o", self.path("out.pvtu"))
        with open(self.path("out.pvtu"), encoding="utf-8") as f:
            pieces = re.findall(r'<Piece Source="(.*?)"/>', f.read())
        self.assertEqual(pieces, ["out/%d.vtu" % i for i in range(3)])
        self.assertEqual(sorted(os.listdir(self.path("out"))), ["0.vtu", "1.vtu", "2.vtu"])
        self.assertEqual(sum(self.facts("info", self.path(piece))["tetrahedra"] for piece in pieces), facts["tetrahedra"])

    def read_ply(self, name):
        """The head, the rows of the points, and the tetrahedra, each with its vertices sorted."""
        head, _, rows = self.bytes_of(name).partition(b"end_header\n")
        count = int(re.search(rb"element tetrahedron (\d+)", head).group(1))
        tetrahedra = struct.iter_unpack("<B4I", rows[len(rows) - 17 * count:])
        return head, rows[:len(rows) - 17 * count], sorted(sorted(t[1:]) for t in tetrahedra)

    def test_one_file_for_all_tiles(self):
        self.facts("generate", "scan", "-n", "1500", "-o", self.path("scan.ply"))
        for weights in [], ["--weights-mod", "-20"]:
            with self.subTest(weights):
                command = ["delaunay", self.path("scan.ply"), *weights, "-o"]
                whole = self.facts(*command, self.path("whole.ply"))
                self.assertEqual((whole["hidden"], whole["duplicates"]), (0, 0))
                tiles = self.facts(*command, self.path("tiles.ply"), "--tiles", "4", "--scratch", self.scratch())
                self.assertEqual(tiles["checksum"], whole["checksum"])
                self.assertEqual(self.read_ply("tiles.ply"), self.read_ply("whole.ply"))
                self.assertEqual(os.listdir(self.scratch()), [])
        piped = subprocess.run([BRIO, *command, "-", "--format", "ply", "--tiles", "4", "--scratch", self.scratch(),
                                "--quiet"], stdout=subprocess.PIPE, check=True).stdout
        self.assertEqual(piped, self.bytes_of("tiles.ply"))

    def test_a_dark_beginning_was_taken_for_all_colours(self):
        with open(self.path("dark.csv"), "w", encoding="ascii") as f:  # two blocks
            rng = random.Random(4)
            f.write("x,y,z,red,green,blue\n")
            for i in range(70000):
                x, y, colour = rng.random(), rng.random(), 200 if i > 69000 else 0
                f.write("%.5f,%.5f,%d,%d,0,%d\n" % (x, y, i % 2, colour, colour))
        self.facts("delaunay", self.path("dark.csv"), "-o", self.path("x.ply"), "--tiles", "2", "--scratch", self.scratch())
        head, _, rows = self.bytes_of("x.ply").partition(b"end_header\n")
        self.assertIn(b"property uchar red", head)
        colours = [rows[27 * i + 24:27 * i + 27] for i in range(70000)]
        self.assertEqual(colours, [bytes((200, 0, 200)) if i > 69000 else bytes(3) for i in range(70000)])

    def test_one_file_says_what_it_says_without_tiles(self):
        rng = random.Random(8)

        def write(name, head, row):
            with open(self.path(name), "w", encoding="ascii") as f:
                f.write(head + "\n")
                f.writelines(row % tuple(rng.random() for _ in range(4)) + "\n" for _ in range(600))
            return self.path(name)

        for name, head, row, more in (
                ("far.csv", "x,y,z,a", "41%f,51%f,%f,%f", ["--float32"]),
                ("wide.csv", "x,y,z,a", "4100%.6f,5100%.6f,%f,%f", ["--float32"]),
                ("near.csv", "x,y,z,a", "%f,%f,%f,%f", ["--float32"]),
                ("radii.csv", "x,y,z,radius", "%f,%f,%f,0.0%.0f", []),
                ("deep.csv", "x,y,z,red,green,blue", "%.4f,%.4f,%.4f,%.4f,0.123,0.5", [])):
            with self.subTest(name):
                command = ["delaunay", write(name, head, row), *more, "-o", self.path("out.ply")]
                whole = self.facts(*command)
                tiles = self.facts(*command, "--tiles", "2", "--scratch", self.scratch())
                for key in "warnings", "hints", "float32", "moved", "merged":
                    self.assertEqual(tiles.get(key), whole.get(key), key)
                self.assertTrue(whole["warnings"])

    def test_a_file_that_changed_between_two_readings_was_mixed(self):
        cloud = self.rows("a.csv", 20000)
        command = (BRIO, "delaunay", cloud, "--tiles", "4", "--scratch", self.scratch(), "-o", self.path("out.ply"), "--quiet")
        process = subprocess.Popen(command, stderr=subprocess.PIPE)
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and process.poll() is None:
            folders = [name for name in os.listdir(self.scratch()) if name.startswith("brio-tiles-")]
            if folders and "tile-0" in os.listdir(os.path.join(self.scratch(), folders[0])):
                break
            time.sleep(0.002)
        if process.poll() is None:
            with open(cloud, "r+b") as f:  # the same rows, one digit is another
                f.seek(8)
                digit = f.read(1)
                f.seek(8)
                f.write(b"2" if digit == b"1" else b"1")
            os.utime(cloud, ns=(1, 1))
        message = process.communicate()[1].decode()
        if process.returncode == 0:
            self.skipTest("the run was over before the file was changed")
        self.assertEqual(process.returncode, 2, message)
        self.assertIn("a.csv: the file changed between two readings", message)
        self.assertFalse(os.path.exists(self.path("out.ply")))

    def test_a_wrong_radius_was_counted_from_its_block(self):
        with open(self.path("r.csv"), "w", encoding="ascii") as f:
            f.write("x,y,z,radius\n")
            f.writelines("%d,%d,%d,%d\n" % (i % 41, i % 43, i % 47, -1 if i == 66000 else 0) for i in range(66001))
        run = self.expect(2, "delaunay", self.path("r.csv"), "--tiles", "2", "--scratch", self.scratch())
        self.assertIn("point 66000 (counted from 0) has the radius -1", run.err)

    def test_one_file_needs_an_input_that_is_read_twice(self):
        run = subprocess.run([BRIO, "delaunay", "-", "--tiles", "2", "--scratch", self.scratch(), "-o",
                              self.path("x.ply")], input=b"", stderr=subprocess.PIPE, check=False)
        self.assertEqual(run.returncode, 1)
        self.assertIn("read twice", run.stderr.decode())

    def test_an_older_output_was_lost_when_a_run_failed(self):
        cloud, index = self.rows("a.csv", 800), self.path("a&b.pvtu")
        command = ("delaunay", cloud, "--threads", "1", "--tiles", "3", "--scratch", self.scratch(), "-o", index)

        def pieces():
            names = [piece.get("Source") for piece in xml.etree.ElementTree.parse(index).iter("Piece")]
            return {name: self.bytes_of(name) for name in names}

        self.facts(*command)
        before = pieces()
        self.assertEqual(list(before), ["a&b/%d.vtu" % i for i in range(3)])
        os.mkdir(self.path("a&b.part"))
        with open(self.path("a&b.part/0.vtu"), "w", encoding="ascii") as f:
            f.write("left by a run that was killed")
        with open(self.path("a&b.part/.brio-part"), "wb"):
            pass
        size = max(map(len, before.values()))
        self.assertLess(len(before["a&b/0.vtu"]), size)
        run = subprocess.run([BRIO, *command, "--quiet"], stderr=subprocess.PIPE, check=False, preexec_fn=lambda: (
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN), resource.setrlimit(resource.RLIMIT_FSIZE, (size - 1,) * 2)))
        self.assertEqual(run.returncode, 6, run.stderr)
        self.assertEqual(pieces(), before)
        self.assertEqual(sorted(os.listdir(self.folder)), ["a&b", "a&b.pvtu", "a.csv", "scratch"])
        for name in "a&b-1", "a&b":
            self.facts(*command)
            self.assertEqual(list(pieces().values()), list(before.values()))
            self.assertEqual(sorted(os.listdir(self.folder)), sorted([name, "a&b.pvtu", "a.csv", "scratch"]))
        os.mkdir(self.path("b"))
        with open(self.path("b/0.vtu"), "w", encoding="ascii") as f:
            f.write("no output of this index")
        self.facts(*command[:-1], self.path("b.pvtu"))
        self.assertEqual(os.listdir(self.path("b")), ["0.vtu"])

    def test_a_folder_of_the_user_was_emptied(self):
        cloud = self.rows("a.csv", 300)
        command = ("delaunay", cloud, "--tiles", "2", "--scratch", self.scratch(), "-o", self.path("out.pvtu"))
        os.mkdir(self.path("mine"))
        for name in "0.vtu", "other":
            with open(self.path("mine/" + name), "w", encoding="ascii") as f:
                f.write("mine")
        part = self.path("out.part")
        for lay in os.symlink, os.rename:
            lay(self.path("mine"), part)
            self.assertIn("out.part: is in the way", self.expect(6, *command).err)
            self.assertEqual(sorted(os.listdir(part)), ["0.vtu", "other"])
            if os.path.islink(part):
                os.remove(part)
        for name in "0.vtu", "other":
            os.rename(os.path.join(part, name), self.path(name))
        os.rmdir(part)
        os.rename(self.path("other"), part)
        self.assertIn("out.part: is in the way", self.expect(6, *command).err)
        self.assertFalse(os.path.exists(self.path("out.pvtu")))

    def test_a_file_that_the_older_index_does_not_name_was_removed(self):
        cloud = self.rows("a.csv", 300)
        command = ("delaunay", cloud, "--scratch", self.scratch(), "-o", self.path("out.pvtu"), "--tiles")
        self.facts(*command, "2")
        with open(self.path("out/2.vtu"), "w", encoding="ascii") as f:
            f.write("mine")
        self.facts(*command, "3")
        self.assertEqual(os.listdir(self.path("out")), ["2.vtu"])
        self.assertEqual(sorted(os.listdir(self.path("out-1"))), ["0.vtu", "1.vtu", "2.vtu"])

    def test_the_folder_of_a_run_that_was_killed_before_its_index_stayed(self):
        cloud = self.rows("a.csv", 300)
        command = ("delaunay", cloud, "--tiles", "2", "--scratch", self.scratch(), "-o", self.path("out.pvtu"))
        self.facts(*command)
        os.rename(self.path("out"), self.path("out-1"))  # as it is when a run is killed before the index is there
        with open(self.path("out-1/.brio-part"), "wb"):
            pass
        os.remove(self.path("out.pvtu"))
        self.facts(*command)
        self.assertEqual(sorted(os.listdir(self.folder)), ["a.csv", "out", "out.pvtu", "scratch"])

    @posix_alone
    def test_two_runs_with_one_output_mixed_their_files(self):
        cloud = self.rows("a.csv", 300)
        os.mkdir(self.path("out.part"))
        with open(self.path("out.part/.brio-part"), "wb") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            run = self.expect(6, "delaunay", cloud, "--tiles", "2", "--scratch", self.scratch(), "-o",
                              self.path("out.pvtu"))
        self.assertIn("that of a run that goes on", run.err)
        self.assertEqual(os.listdir(self.path("out.part")), [".brio-part"])

    def test_options_of_the_files_of_tiles_were_ignored(self):
        cloud, tiled = self.rows("a.csv", 300), ("--tiles", "2", "--scratch", self.scratch(), "-o")
        for command, index, extension in (("delaunay",), ".pvtu", "vtu"), (("alpha", "--alpha", "1e9"), ".pvtp", "vtp"):
            for name, option, sentence in (("x" + index, "--float32", index + ": --float32: the files of tiles have double precision"),
                                           ("x" + index, "--format=obj", "--format obj: --tiles writes .ply, and " + index),
                                           ("x.ply", "--format=stl", "--format stl: --tiles writes .ply, and " + index)):
                self.assertIn(sentence, self.expect(1, *command, cloud, *tiled, self.path(name), option).err)
            self.facts(*command, cloud, *tiled, self.path("X" + index.upper()), "--format", extension)
            self.assertEqual(sorted(os.listdir(self.path("X"))), ["0." + extension, "1." + extension])
            for name in os.listdir(self.path("X")):
                os.remove(self.path("X/" + name))
            os.rmdir(self.path("X"))

    def test_more_tiles_than_points_made_a_wrong_triangulation(self):
        rng = random.Random(6)  # a part that could not be cut had a home without a border
        with open(self.path("wide.csv"), "w", encoding="ascii") as f:
            f.write("x,y,z\n")
            f.writelines("%r,%r,%r\n" % tuple(rng.choice((-1, 1)) * 10 ** rng.uniform(-20, 20) for _ in range(3))
                         for _ in range(60))
        self.same(self.path("wide.csv"), tiles=300)

    @posix_alone
    def test_the_index_was_no_xml(self):
        cloud = self.rows("a.csv", 300)
        self.facts("delaunay", cloud, "--tiles", "2", "--scratch", self.scratch(), "-o", self.path('a&b <"c".pvtu'))
        pieces = xml.etree.ElementTree.parse(self.path('a&b <"c".pvtu')).iter("Piece")
        self.assertEqual([piece.get("Source") for piece in pieces], ['a&b <"c"/%d.vtu' % i for i in range(2)])

    def test_tiles_without_tetrahedra_lacked_the_weights_that_the_index_names(self):
        cloud = self.rows("w.csv", 8, weight=True)
        self.facts("delaunay", cloud, "--tiles", "8", "--scratch", self.scratch(), "-o", self.path("out.pvtu"))
        infos = [self.facts("info", self.path("out/%d.vtu" % i)) for i in range(8)]
        self.assertIn(0, [info["tetrahedra"] for info in infos])
        for info in infos:
            self.assertEqual(list(info["properties"]), ["point", "weight"])

    def test_a_killed_run_is_resumed(self):
        cloud = self.rows("a.csv", 20000)
        plain = self.facts("delaunay", cloud)["checksum"]
        facts = self.facts("delaunay", cloud, *self.kill(cloud))
        self.assertEqual(facts["checksum"], plain)
        self.assertGreaterEqual(facts["resumed"], 3)
        self.assertEqual(os.listdir(self.scratch()), [])

    def test_what_a_failed_machine_left_is_made_anew(self):
        cloud = self.rows("a.csv", 20000)
        plain = self.facts("delaunay", cloud)["checksum"]
        for damaged, most in (("tile-1", 2), ("points", 0), ("state", 0)):
            command = self.kill(cloud)
            folder, = os.listdir(self.scratch())
            with open(os.path.join(self.scratch(), folder, damaged), "r+b") as f:
                f.seek(-64, os.SEEK_END)
                byte = f.read(1)[0]
                f.seek(-64, os.SEEK_END)
                f.write(bytes([byte ^ 1]))
            facts = self.facts("delaunay", cloud, *command)
            self.assertEqual(facts["checksum"], plain)
            if most:
                self.assertGreaterEqual(facts["resumed"], most)
            else:
                self.assertEqual(facts["resumed"], 0)

    def test_points_beside_the_named_file_were_those_of_a_killed_run(self):
        rng = random.Random(7)

        def nodes():
            with open(self.path("a.node"), "w", encoding="ascii") as f:
                f.write("20000 3 0 0\n")
                f.writelines("%d %f %f %f\n" % (i, *(rng.random() for _ in range(3))) for i in range(20000))

        with open(self.path("a.ele"), "w", encoding="ascii") as f:
            f.write("1 4 0\n0 0 1 2 3\n")
        nodes()
        command = self.kill(self.path("a.ele"))
        nodes()
        self.assertEqual(self.facts("delaunay", self.path("a.ele"), *command)["checksum"],
                         self.facts("delaunay", self.path("a.node"))["checksum"])

    def kill(self, cloud):
        """Runs until three tiles are there, and kills. Returns the options."""
        command = ("--tiles", "8", "--scratch", self.scratch())
        process = subprocess.Popen([BRIO, "delaunay", cloud, *command, "--quiet"], stdout=subprocess.DEVNULL)
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and process.poll() is None:
            folders = [name for name in os.listdir(self.scratch()) if name.startswith("brio-tiles-")]
            if folders and "tile-2" in os.listdir(os.path.join(self.scratch(), folders[0])):
                break
            time.sleep(0.002)
        process.send_signal(signal.SIGKILL)
        if process.wait() != -signal.SIGKILL:
            self.skipTest("the run was over before it could be killed")
        return command

    def test_runs_killed_at_random_moments_go_on(self):
        cloud = self.rows("a.csv", 5000)
        command = ("delaunay", cloud, "--tiles", "3", "--scratch", self.scratch(), "-o", self.path("x.pvtu"))
        begin = time.monotonic()
        plain = self.facts(*command)["checksum"]
        seconds = time.monotonic() - begin
        rng = random.Random(3)
        for _ in range(50 if os.environ.get("BRIO_LONG") else 3):
            process = subprocess.Popen([BRIO, *command, "--quiet"], stdout=subprocess.DEVNULL)
            time.sleep(rng.random() * seconds)
            process.kill()
            process.wait()
            pieces = xml.etree.ElementTree.parse(self.path("x.pvtu")).iter("Piece")
            self.assertTrue(all(os.path.exists(self.path(piece.get("Source"))) for piece in pieces))
            self.assertEqual(self.facts(*command)["checksum"], plain)
            self.assertEqual(os.listdir(self.scratch()), [])

    @posix_alone
    def test_a_full_disk_is_said(self):
        cloud = self.rows("a.csv", 5000)
        for size in (1000, 150000, 240000):  # in the points, in a tile
            with self.subTest(size):
                run = subprocess.run([BRIO, "delaunay", cloud, "--tiles", "2", "--scratch", self.scratch(), "--quiet"],
                                     stderr=subprocess.PIPE, check=False, preexec_fn=lambda most=size: (
                                         signal.signal(signal.SIGXFSZ, signal.SIG_IGN),
                                         resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))))
                self.assertEqual(run.returncode, 6, run.stderr)
                self.assertRegex(run.stderr.decode(), r"brio-tiles-\w+/[\w.-]+: cannot write: File too large")
                self.assertEqual(os.listdir(self.scratch()), [])

    @posix_alone
    def test_too_small_a_disk_is_said_before_the_work(self):
        cloud, disk = self.rows("a.csv", 20000), self.scratch()
        line = 'mount -t tmpfs -o size=$3 none "$1" && shift 3 && exec "$0" "$@"'
        for size, need, command in (("2m", 3, ["delaunay"]), ("3m", 4, ["voronoi", "-o", self.path("c.npy")]),
                                    ("9m", 16, ["voronoi", "-o", self.path("c.npy"), "--faces", self.path("f.csv")])):
            with self.subTest(command[0]):
                run = subprocess.run(["unshare", "-rm", "sh", "-c", line, BRIO, disk, cloud, size, *command, cloud,
                                      "--tiles", "2", "--scratch", disk, "--quiet"], stderr=subprocess.PIPE, check=False)
                if run.returncode in (1, 32, 126, 127):
                    self.skipTest("skipped: no disks of one's own here: " + run.stderr.decode())
                self.assertEqual(run.returncode, 6, run.stderr)
                self.assertRegex(run.stderr.decode(), r"20000 points need about %d MB more on this disk, which has room "
                                 r"for \d MB" % need)

    def test_an_interrupted_run_leaves_nothing(self):
        cloud = self.rows("a.csv", 20000)
        process = subprocess.Popen([BRIO, "delaunay", cloud, "--tiles", "8", "--scratch", self.scratch(), "--quiet"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        process.wait()
        self.assertEqual(os.listdir(self.scratch()), [])

    def test_too_little_memory_is_said_before_the_work(self):
        run = self.expect(4, "delaunay", self.rows("a.csv", 60000), "--tiles", "2", "--scratch", self.scratch(),
                          "--max-memory", "13M")
        self.assertRegex(run.err, r"the largest of 2 tiles has \d+ points.*take about \d+ tiles")
        self.assertEqual(os.listdir(self.scratch()), [])

    def test_cells_are_counted_before_the_work(self):
        cloud = self.rows("a.csv", 20000)
        limits = ["--scratch", self.scratch(), "--max-memory", "24M"]
        self.expect(0, "delaunay", cloud, "--tiles", "2", *limits)
        run = self.expect(4, "voronoi", cloud, "--tiles", "2", *limits, "-o", self.path("c.npy"))
        tiles = re.search(r"the largest of 2 tiles has \d+ points.*take about (\d+) tiles", run.err).group(1)
        facts = self.facts("voronoi", cloud, "--tiles", tiles, *limits, "-o", self.path("c.npy"))
        self.assertEqual(facts["cells"], 20000)

    def test_what_waits_for_many_tiles_is_a_part_of_the_memory(self):
        cloud, limits = self.rows("a.csv", 2000), ["--tiles", "500", "--scratch", self.scratch(), "--max-memory"]
        for command in (["delaunay", cloud], ["voronoi", cloud, "-o", self.path("c.npy")], ["alpha", cloud, "--alpha", "0.1"],
                        ["convert", cloud, self.path("a.vpc")]):
            with self.subTest(command[0]):
                self.facts(*command, *limits, "20M")
        run = self.expect(4, "delaunay", cloud, *limits, "8M")
        self.assertIn("500 tiles need about", run.err)
        self.assertEqual(os.listdir(self.scratch()), [])

    def test_what_a_page_shows_was_outside_of_the_memory(self):
        cloud, limits = self.cloud("many.npy", 32000), ["--tiles", "8", "--scratch", self.scratch(), "--max-memory", "40M"]
        for shown in (["--view", self.path("v.html")], ["--picture", self.path("v.png")]):
            facts = self.facts("delaunay", cloud, *limits, *shown)
            self.assertTrue(any("an even choice of 26214 of" in words for words in facts["warnings"]))
            self.assertLess(facts["peak_bytes"], 40 << 20)
            facts = self.facts("voronoi", cloud, *limits, *shown)
            self.assertTrue(any("cells" in words for words in facts["warnings"]), facts["warnings"])
            self.assertLess(facts["peak_bytes"], 40 << 20)

    def test_the_certificate_of_an_alpha_shape_is_counted_before_the_work(self):
        cloud, limits = self.rows("a.csv", 40000), ["--tiles", "2", "--scratch", self.scratch(), "--max-memory", "70M"]
        self.facts("voronoi", cloud, *limits)
        run = self.expect(4, "alpha", cloud, "--alpha", "1e-3", "--json", *limits)
        self.assertRegex(run.err, r"the largest of 2 tiles has \d+ points.*take about \d+ tiles")

    def test_flat_points(self):
        with open(self.path("flat.xyz"), "w", encoding="ascii") as f:
            f.writelines("%d %d 2\n" % (i % 20, i // 20) for i in range(400))
        self.same(self.path("flat.xyz"))
        run = self.expect(3, "delaunay", self.path("flat.xyz"), "--weights-mod", "-9", "--tiles", "2", "--scratch",
                          self.scratch())
        self.assertIn("in a plane", run.err)


class Usage(CliTest):
    def test_wrong_usage(self):
        cloud, folder = self.cloud("a.xyz", 50), self.folder
        self.usage("--tiles needs --scratch", "delaunay", cloud, "--tiles", "2")
        self.usage("not with --weights FILE", "delaunay", cloud, "--tiles", "2", "--scratch", folder, "--weights", "w")
        self.usage("writes .ply, and .pvtu", "delaunay", cloud, "--tiles", "2", "--scratch", folder, "-o", self.path("x.vtu"))
        self.usage("writes .ply, and .pvtu", "delaunay", cloud, "--tiles", "2", "--scratch", folder, "-o", self.path(".pvtu"))
        self.usage("--tiles goes with", "delaunay", cloud, "--tiles", "2", "--scratch", folder, "--verify")
        self.usage("--tiles goes with", "delaunay", cloud, "--tiles", "2", "--scratch", folder, "--plane", "xy")
        self.usage("70000", "delaunay", cloud, "--tiles", "70000", "--scratch", folder)


if __name__ == "__main__":
    main()
