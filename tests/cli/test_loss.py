"""What a run would lose or get wrong: it says so, or does not begin."""

import math
import os
import re
import struct

import formats
import whole_files
from brio_cli import OCTAHEDRON, OCTAHEDRON_FACES, CliTest, main

CUBES = [(x, y, z) for x in range(4) for y in range(4) for z in range(4)]
TYPES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d"}


class LossTest(CliTest):
    def vertices(self, name):
        """The columns of the vertices of a binary PLY file, by name, and the type of each."""
        with open(self.path(name), "rb") as f:
            header, data = f.read().split(b"end_header\n", 1)
        vertex = header.decode().split("element vertex ")[1].split("element")[0].splitlines()
        fields = [line.split()[1:] for line in vertex[1:] if line.startswith("property")]
        rows = struct.iter_unpack("<" + "".join(TYPES[kind] for kind, _ in fields), data[:int(vertex[0]) * struct.calcsize(
            "<" + "".join(TYPES[kind] for kind, _ in fields))])
        columns = list(zip(*rows)) or [()] * len(fields)
        return {name: values for (_, name), values in zip(fields, columns)}, {name: kind for kind, name in fields}

    def positions(self, columns):
        return list(zip(columns["x"], columns["y"], columns["z"]))

    def ply(self, name, rows, columns):
        """A text of points; columns: (type, name) of what follows x, y, z."""
        lines = ["ply", "format ascii 1.0", "element vertex %d" % len(rows)]
        lines += ["property double " + axis for axis in "xyz"] + ["property %s %s" % column for column in columns]
        return self.file(name, "\n".join(lines + ["end_header"] + [" ".join(map(repr, row)) for row in rows]) + "\n")


def ball(n, centre=(0, 0, 0), radius=1):
    """Points spread evenly over a sphere."""
    points = []
    for i in range(n):
        z, angle = 1 - (2 * i + 1) / n, i * 2.399963229728653
        r = math.sqrt(1 - z * z)
        points.append(tuple(c + radius * u for c, u in zip(centre, (r * math.cos(angle), r * math.sin(angle), z))))
    return points


class FilesNamedTwice(CliTest):
    """An output that is the input, or another output."""

    def refuse(self, *arguments):
        before = {name: self.content(name) for name in os.listdir(self.folder)}
        self.usage("name the same file", *arguments)
        self.assertEqual({name: self.content(name) for name in os.listdir(self.folder)}, before)

    def content(self, name):
        path = self.path(name)
        if not os.path.isfile(path):
            return None
        with open(path, "rb") as f:
            return f.read()

    def test_output_over_the_input(self):
        points = self.cloud("a.ply", 60, "ball")
        other = self.file("b.xyz", "0 0 0\n")
        for how in [("surface",), ("delaunay",), ("hull",), ("alpha", "--alpha", "auto"), ("medial",),
                    ("offset", "-D", "1"), ("subdivide",), ("iso", "--level", "1"),
                    ("interpolate", "--at", other, "--property", "p")]:
            self.refuse(how[0], points, *how[1:], "-o", points)
        table = self.file("a.csv", "x,y,z\n0,0,0\n")
        self.refuse("voronoi", table, "-o", table)
        self.refuse("locate", table, "--at", other, "-o", table)

    def test_output_over_the_input_by_another_name(self):
        points = self.cloud("a.ply", 60, "ball")
        os.symlink("a.ply", self.path("link.ply"))
        os.link(points, self.path("hard.ply"))
        os.symlink(".", self.path("folder"))
        for name in ["./a.ply", "link.ply", "hard.ply", "folder/a.ply", points]:
            self.refuse("surface", "a.ply", "-o", name)
        self.refuse("surface", "link.ply", "-o", "hard.ply")

    def test_second_output_over_the_input(self):
        points = self.cloud("a.ply", 60, "ball")
        for how in [("surface", "--normals"), ("surface", "--method", "power-crust", "--normals"),
                    ("medial", "--crust"), ("alpha", "--alpha", "auto", "--filtration"), ("voronoi", "--faces")]:
            self.refuse(how[0], points, *how[1:], "./a.ply", "-o", self.path("out.vtu"))

    def test_output_over_another_input(self):
        points, rows = self.cloud("a.ply", 60, "ball"), self.file("rows.ply", "1\n" * 60)
        self.refuse("delaunay", points, "--weights", rows, "-o", rows)
        self.refuse("locate", points, "--at", self.file("at.csv", "0 0 0\n"), "-o", "at.csv")

    def test_two_outputs_that_are_not_there_yet(self):
        points = self.cloud("a.ply", 60, "ball")
        os.symlink(".", self.path("folder"))
        os.symlink("new.ply", self.path("ahead.ply"))
        for name in ["./new.ply", "folder/new.ply", "ahead.ply"]:
            self.refuse("surface", points, "-o", "new.ply", "--normals", name)

    def test_the_files_of_a_pair_of_tetgen(self):
        self.tetrahedra("a", [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 1, 2, 3)])
        self.refuse("delaunay", "a.node", "-o", "a.ele")
        self.refuse("delaunay", "a.ele", "-o", "a.node")

    def test_devices_may_be_named_twice(self):
        points = self.cloud("a.ply", 60, "ball")
        self.expect(0, "alpha", points, "--alpha", "auto", "--format", "ply", "-o", "/dev/null", "--filtration",
                    "/dev/null")

    def test_an_input_may_be_named_twice(self):
        points, mesh = self.cloud("a.ply", 60, "ball"), self.path("hull.ply")
        self.expect(0, "locate", points, "--at", points, "-o", self.path("out.csv"))
        self.expect(0, "hull", points, "-o", mesh)
        self.expect(0, "compare", mesh, mesh)


class SinglePrecision(LossTest):
    """--float32 and STL merged the points of a country's grid."""

    GRID = (500000.123, 4100000.456, 200)

    def far(self, radius, n=3000):
        return self.xyz("far.xyz", ball(n, self.GRID, radius))

    def box(self, side=12, step=0.05):
        """Points of a grid: their heights are single numbers."""
        steps = range(side)
        return self.xyz("box.xyz", [(500000.123 + step * x, 4100000.456 + step * y, 100 + z)
                                    for x in steps for y in steps for z in steps])

    def test_single_precision_that_would_merge_points_gives_way(self):
        points = self.box()
        for extension in ["ply", "vtu"]:
            run = self.expect(0, "delaunay", points, "-o", self.path("out." + extension), "--float32")
            self.assertRegex(run.err, r"warning: .*out\.\w+: in double precision: .* would merge \d+ of 1728 points")
        columns, kinds = self.vertices("out.ply")
        self.assertEqual(kinds["x"], "double")
        self.assertEqual(len(set(self.positions(columns))), 1728)
        facts = self.facts("delaunay", points, "-o", self.path("out.ply"), "--float32")
        self.assertIs(facts["float32"], False)
        self.assertNotIn("moved", facts)

    def test_single_precision_that_would_move_points_over_their_neighbours_gives_way(self):
        points, out = self.far(2.0), self.path("out.ply")
        for method in ["labeled-delaunay", "power-crust", "cocone"]:
            run = self.expect(0, "surface", points, "--method", method, "-o", out, "--float32")
            self.assertRegex(run.err, r"warning: .*out.ply: in double precision: single precision would")
            self.assertEqual(self.vertices("out.ply")[1]["x"], "double")

    def test_single_precision_that_cannot_hold_a_coordinate_gives_way(self):
        points = self.xyz("huge.xyz", ball(300, radius=1e39))
        run = self.expect(0, "hull", points, "-o", self.path("out.ply"), "--float32")
        self.assertRegex(run.err, r"warning: .* in double precision: single precision cannot hold -?[\d.]+e\+3\d")
        self.assertEqual(self.vertices("out.ply")[1]["x"], "double")

    def test_single_precision_says_how_far_it_moves_points(self):
        points = self.far(200.0)
        exact = self.facts("surface", points, "-o", self.path("exact.ply"))
        self.assertNotIn("moved", exact)
        for name, option in [("out.ply", ["--float32"]), ("out.stl", [])]:
            run = self.expect(0, "surface", points, "-o", self.path(name), *option)
            self.assertRegex(run.err, r"warning: .* move points by up to 0\.1\d")
            facts = self.facts("surface", points, "-o", self.path(name), *option)
            self.assertTrue(0.1 < facts["moved"] < 0.2, facts["moved"])
            self.assertNotIn("merged", facts)
        here, there = (self.positions(self.vertices(name)[0]) for name in ("exact.ply", "out.ply"))
        self.assertAlmostEqual(max(map(math.dist, here, there)), facts["moved"])

    def test_single_precision_that_moves_nothing_says_nothing(self):
        points = self.xyz("a.xyz", [(x, y, z) for x in range(4) for y in range(4) for z in range(4)])
        run = self.expect(0, "hull", points, "-o", self.path("out.ply"), "--float32")
        self.assertEqual(run.err, "")

    def test_faces_of_points_that_are_thinned_out_are_named(self):
        """All faces of a mesh went, and nothing was said."""
        mesh = self.off("a.off", OCTAHEDRON, OCTAHEDRON_FACES)
        run = self.expect(0, "convert", mesh, "--thin", "1.5", "-o", self.path("out.ply"))
        self.assertIn("out.ply is without: faces of dropped points", run.err)
        facts = self.facts("convert", mesh, "--thin", "0.5", "-o", self.path("out.ply"))
        self.assertEqual((facts["lost"], facts["faces"]), ([], 8))

    def test_some_points_that_merge_are_counted(self):
        twin = (0.1, 0.2, 0.3), (0.1 + 1e-12, 0.2, 0.3)
        points = self.xyz("a.xyz", ball(4000) + [twin[0], twin[1]])
        facts = self.facts("generate", "cube", "-n", 9, "-o", self.path("b.ply"))
        self.assertNotIn("merged", facts)
        run = self.expect(0, "delaunay", points, "-o", self.path("out.ply"), "--float32")
        self.assertRegex(run.err, "warning: .* single precision merges 1 points with others")
        self.assertEqual(self.vertices("out.ply")[1]["x"], "float")

    def test_a_stl_file_that_would_merge_the_points_is_refused_before_the_work(self):
        points, ground = self.far(2.0), self.box()
        for how in [("surface",), ("hull",), ("offset", "-D", "1"), ("alpha", "--alpha", "auto")]:
            self.usage(r"far.xyz: .* would move points by up to 0.\d+, and most are 0.\d+ from the next: an STL", how[0],
                       points, *how[1:], "-o", "out.stl")
            self.usage(r"box.xyz: .* would merge \d+ of 1728 points with others: an STL", how[0], ground, *how[1:], "-o",
                       "out.stl")
        self.usage("cannot hold", "hull", self.xyz("huge.xyz", ball(300, radius=1e39)), "-o", "o.stl")
        self.assertFalse(os.path.exists(self.path("out.stl")))

    def test_a_finished_surface_is_written_as_stl_with_a_word_for_what_merges(self):
        self.expect(0, "generate", "torus", "-n", 3000, "-o", self.path("torus.ply"))
        run = self.expect(0, "surface", self.path("torus.ply"), "--method", "power-crust", "-o", self.path("crust.stl"))
        self.assertRegex(run.err, r"warning: .*crust.stl: single precision merges \d+ points with others")

    def test_las_says_how_far_its_steps_move_points(self):
        points = self.ply("a.ply", [p + (i,) for i, p in enumerate(ball(50))], [("int", "a")])
        facts = self.facts("interpolate", points, "--at", self.xyz("at.xyz", ball(50, radius=math.pi / 9)), "--property",
                           "a", "-o", self.path("out.las"))
        self.assertTrue(0 < facts["moved"] < 1e-9, facts["moved"])
        grid = self.xyz("grid.xyz", [(x / 100, 0.25, 0) for x in range(9)])
        self.assertNotIn("moved", self.facts("interpolate", points, "--at", grid, "--property", "a", "-o",
                                             self.path("out.las")))


class Formats(LossTest):
    """What a format cannot hold went without a word."""

    def test_properties_that_a_format_cannot_hold(self):
        points = self.ply("a.ply", [p + (i,) for i, p in enumerate(ball(60))], [("uchar", "red")])
        for extension in ["obj", "off", "stl"]:
            for how in [("hull",), ("surface", "--method", "cocone")]:
                run = self.expect(0, how[0], points, *how[1:], "-o", self.path("out." + extension))
                self.assertRegex(run.err, r"without the properties, which the format cannot hold: red\b")
                run = self.expect(0, how[0], points, *how[1:], "-o", self.path("out." + extension), "--quiet")
                self.assertEqual(run.err, "")
        run = self.expect(0, "delaunay", points, "-o", self.path("out.node"))
        self.assertRegex(run.err, "without the names of the properties: red")

    def test_a_property_that_a_format_has_a_place_for_is_not_called_lost(self):
        points = self.file("i.csv", "x,y,z,intensity\n1,2,3,4\n5,6,7,8\n2,2,9,3\n")
        for form, lost in ("pts", []), ("ptx", []), ("xyzrgb", ["intensity"]):
            self.assertEqual(self.facts("convert", points, "-o", self.path("out." + form))["lost"], lost, form)

    def test_nothing_is_said_of_properties_that_no_input_had(self):
        run = self.expect(0, "surface", self.xyz("a.xyz", CUBES), "-o", self.path("out.off"))
        self.assertEqual(run.err, "")

    def test_parts_of_the_medial_axis(self):
        points = self.xyz("a.xyz", [tuple(c * s for c, s in zip(p, (3, 2, 1))) for p in ball(900)])
        run = self.expect(0, "medial", points, "-o", self.path("out.xyz"))
        for part in ["tetrahedra", "faces", "edges"]:
            self.assertIn("out.xyz: without the %s, which the format cannot hold\n" % part, run.err)
        self.assertEqual(self.expect(0, "medial", points, "-o", self.path("out.ply")).err, "")

    def test_edges_of_a_hull(self):
        points = self.xyz("a.xyz", [(i, i, i) for i in range(5)])
        run = self.run_brio("hull", points, "-o", self.path("out.obj"))
        self.assertIn("without the edges", run.err)

    def test_options_that_change_nothing_in_the_format(self):
        points = self.xyz("a.xyz", ball(50))
        for name, option in [("out.obj", "float32"), ("out.glb", "ascii")]:
            run = self.expect(0, "hull", points, "-o", self.path(name), "--" + option)
            self.assertIn("%s: --%s changes nothing in this format\n" % (name, option), run.err)
        run = self.expect(0, "voronoi", points, "-o", self.path("out.vtu"), "--float32", "--ascii")
        self.assertRegex(run.err, "--ascii changes nothing.*\n.*--float32 changes nothing")
        run = self.expect(0, "locate", points, "--at", points, "-o", self.path("out.csv"), "--float32")
        self.assertIn("--float32 changes nothing", run.err)
        for name in ["out.ply", "out.obj", "out.stl"]:
            self.assertNotIn("changes nothing", self.expect(0, "hull", points, "-o", self.path(name), "--ascii").err)

    def test_places_that_have_the_property_keep_it(self):
        """The interpolation was refused when it was finished."""
        points = self.ply("a.ply", [p + (float(i),) for i, p in enumerate(ball(60))], [("double", "heat")])
        places = self.ply("at.ply", [(0.1 * i, 0, 0, -1.0 - i) for i in range(5)], [("double", "heat")])
        self.expect(0, "interpolate", points, "--at", places, "--property", "heat", "-o", self.path("out.ply"))
        columns, _ = self.vertices("out.ply")
        self.assertEqual(columns["input_heat"], (-1, -2, -3, -4, -5))
        self.assertTrue(all(value >= 0 for value in columns["heat"]))


class Everything(LossTest):
    """A file with everything that its format allows: what is not in the mesh is named."""

    def test_there_is_a_file_for_every_format(self):
        for kind in formats.formats():
            self.assertTrue(formats.everything_of(kind), "%s: tests/cli/formats.py has no file of it: add a row to EVERYTHING, "
                            "with a file that has all that the format allows" % kind["name"])

    def compressed(self):
        """The LAS file as LAZ, which brio writes without waveforms, with an index."""
        self.expect(0, "convert", self.path("all.las"), self.path("made.laz"), "--quiet")
        with open(self.path("made.laz"), "rb") as f:
            return whole_files.with_index(f.read())

    def test_what_is_not_read_is_named(self):
        for extension, (content, kept, left_out, *metadata) in formats.EVERYTHING.items():
            name = self.file("all." + extension, content or self.compressed())
            facts = self.facts("info", name)
            self.assertEqual(list(facts["properties"]), kept, extension)
            self.assertEqual(sorted(facts.get("left_out", [])), sorted(left_out), extension)
            run = self.facts("convert", name, self.path("out.ply"), "--quiet")
            self.assertEqual(sorted(set(run["lost"]) - {"colour depth", "precision"}), sorted(sum(metadata, left_out)), extension)

    def test_what_stays_of_faces(self):
        """The kinds of files above that say something of faces; in PLY, strips beside the faces would have nothing."""
        ply = formats.PLY.replace("element tristrips 1\n", "element tristrips 0\n").replace("3 0 1 3\n", "")
        for name, content, kept in [("a.ply", ply, {"flags": "uint8"}), ("a.vtp", formats.EVERYTHING["vtp"][0], {"area": "float32"}),
                                    ("a.vtu", formats.EVERYTHING["vtu"][0], {"area": "float32"}),
                                    ("a.vtk", formats.EVERYTHING["vtk"][0], {"area": "float32"}),
                                    ("a.off", formats.OFF, {c: "float64" for c in ["red", "green", "blue"]})]:
            self.assertEqual(self.facts("info", self.file(name, content))["face_properties"], kept, name)

    def test_properties_of_faces_that_a_format_cannot_hold(self):
        mesh = self.file("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                         "property float z\nelement face 1\nproperty list uchar int vertex_indices\nproperty uchar red\n"
                         "property uchar green\nproperty uchar blue\nproperty float heat\nend_header\n"
                         "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 1 2 3 0.5\n")
        colours = [c + " of faces" for c in ["red", "green", "blue"]]
        for extension, lost in [("ply", []), ("vtu", []), ("vtp", []), ("vtk", []), ("off", ["heat of faces"]),
                                ("obj", colours + ["heat of faces"]), ("stl", colours + ["heat of faces"]),
                                ("glb", colours + ["heat of faces"]), ("xyz", ["faces"] + colours + ["heat of faces"])]:
            facts = self.facts("convert", mesh, self.path("out." + extension))
            self.assertEqual(facts["lost"], lost, extension)
        run = self.expect(0, "subdivide", mesh, "-o", self.path("out.glb"))
        self.assertIn('without the properties, which the format cannot hold: "red of faces"', run.err)
        self.assertEqual(self.expect(0, "subdivide", mesh, "-o", self.path("out.ply")).err, "")
        kept = self.facts("info", self.path("out.ply"))["face_properties"]
        self.assertEqual(kept, {"red": "uint8", "green": "uint8", "blue": "uint8", "heat": "float32"})

    def test_what_a_writer_changes_is_named(self):
        quads = self.off("a.off", CUBES[:4], [(0, 1, 3, 2)])
        for extension in ["stl", "glb"]:
            lost = self.facts("convert", quads, self.path("out." + extension))["lost"]
            self.assertEqual(lost, ["polygons of more than three corners"])
        points = self.ply("b.ply", [(0, 0, 0, 5)], [("int", "heat")])
        self.assertEqual(self.facts("convert", points, self.path("out.node"))["lost"], ["names of properties"])


class Values(LossTest):
    """Values that interpolation leaves out, or that spoil those beside them."""

    def test_values_of_coincident_points(self):
        points = self.ply("a.ply", [p + (float(i),) for i, p in enumerate(CUBES + CUBES[:5])], [("double", "heat")])
        how = ["interpolate", points, "--at", points, "--property", "heat", "-o", self.path("out.csv")]
        self.assertRegex(self.expect(0, *how).err, "5 points are at the positions of others: the value of the first")
        self.assertEqual(self.facts(*how)["duplicates"], 5)
        with open(self.path("out.csv")) as f:
            self.assertEqual([float(line) for line in f.read().split()[1:]], list(range(64)) + list(range(5)))

    def test_values_that_are_not_finite(self):
        points = self.ply("a.ply", [p + (math.nan if i == 3 else 1.0,) for i, p in enumerate(CUBES)], [("double", "heat")])
        run = self.expect(0, "interpolate", points, "--at", points, "--property", "heat", "-o", self.path("out.csv"))
        self.assertRegex(run.err, "1 values of 'heat' are not finite")


class Properties(LossTest):
    """Colours and intensities vanished, in surfaces whose vertices are no samples most of all."""

    COLUMNS = [("uchar", "red"), ("ushort", "intensity"), ("uchar", "classification"), ("float", "nx"), ("int", "odd.name-1"),
               ("double", "side"), ("short", "input_nx")]

    def coloured(self, points=None):
        points = points or ball(1500)
        rows = [p + (i % 256, 3 * i, i % 5, 0.5, -i, i + 0.25, -(i % 9)) for i, p in enumerate(points)]
        return self.ply("a.ply", rows, self.COLUMNS), rows

    def expect_nearest(self, name, rows, renamed=()):
        """Every vertex has the properties of a sample that is as near as any."""
        columns, kinds = self.vertices(name)
        renamed = dict(renamed)
        own = [renamed.get(name, name) for _, name in self.COLUMNS]
        for (kind, _), name in zip(self.COLUMNS, own):
            self.assertEqual(kinds[name], kind)
        for v, at in enumerate(self.positions(columns)):
            values = tuple(columns[name][v] for name in own)
            row = rows[-values[4]]
            self.assertEqual(values, row[3:])
            if v % 97 == 0:
                least = min(math.dist(at, other[:3]) for other in rows)
                self.assertLessEqual(math.dist(at, row[:3]), least * (1 + 1e-9) + 1e-12)

    def test_properties_of_every_surface(self):
        points, rows = self.coloured()
        for how in [("surface", "--method", "power-crust"), ("surface", "--method", "power-crust", "--simplify"),
                    ("surface", "--method", "cocone"), ("surface", "--method", "tight-cocone"), ("hull",),
                    ("alpha", "--alpha", "auto"), ("offset", "-D", "0.2"), ("offset", "-D", "-0.2", "--simplify")]:
            self.expect(0, how[0], points, *how[1:], "-o", self.path("out.ply"))
            self.expect_nearest("out.ply", rows)

    def test_properties_beside_the_surface_s_own(self):
        points, rows = self.coloured()
        for option in [(), ("--simplify",)]:
            self.expect(0, "surface", points, "-o", self.path("out.ply"), *option)
            columns, kinds = self.vertices("out.ply")
            self.assertEqual([kinds[name] for name in ("nx", "input_nx", "input_input_nx")], ["float", "float", "short"])
            self.assertEqual(set(columns["input_nx"]), {0.5})
            for v, number in enumerate(columns["odd.name-1"]):
                self.assertEqual(columns["intensity"][v], -3 * number)

    def test_properties_of_smoothed_samples(self):
        noisy = [tuple(c + 0.02 * math.sin(37 * i + 11 * k) for k, c in enumerate(p)) for i, p in enumerate(ball(1500))]
        points, rows = self.coloured(noisy)
        for method in ["power-crust", "labeled-delaunay"]:
            facts = self.facts("surface", points, "--method", method, "--noise", "smooth", "-o", self.path("out.ply"))
            columns, _ = self.vertices("out.ply")
            self.assertIs(facts["smoothed"], True)
            for v, number in enumerate(columns["odd.name-1"]):
                self.assertEqual(columns["intensity"][v], -3 * number)

    def test_properties_of_the_medial_axis_and_of_its_crust(self):
        points, rows = self.coloured([tuple(c * s for c, s in zip(p, (3, 2, 1))) for p in ball(1500)])
        self.expect(0, "medial", points, "-o", self.path("out.ply"), "--crust", self.path("crust.ply"))
        self.expect_nearest("out.ply", rows, {"side": "input_side"})
        self.expect_nearest("crust.ply", rows)

    def test_properties_beside_the_normals(self):
        points, rows = self.coloured()
        for method in ["power-crust", "labeled-delaunay"]:
            self.expect(0, "surface", points, "--method", method, "-o", self.path("out.ply"), "--normals",
                        self.path("normals.ply"))
            columns, kinds = self.vertices("normals.ply")
            self.assertEqual(columns["intensity"], tuple(row[4] for row in rows))
            self.assertEqual([kinds[name] for name in ("nx", "ny", "input_nx", "input_input_nx")],
                             ["double", "double", "float", "short"])

    def test_a_property_is_not_lost_for_the_name_of_a_coordinate(self):
        points = self.ply("a.ply", [p + (i, 7) for i, p in enumerate(ball(20))], [("int", "X"), ("int", "X_2")])
        self.expect(0, "delaunay", points, "-o", self.path("out.ply"))
        columns, _ = self.vertices("out.ply")
        self.assertEqual(columns["X_2"], tuple(range(20)))
        self.assertEqual(set(columns["X_2_2"]), {7})

    def test_two_properties_of_one_name_are_refused(self):
        points = self.ply("a.ply", [(0, 0, 0, 1, 2)], [("int", "a"), ("int", "a")])
        self.bad_input("two properties named a", "info", points)


class Representatives(LossTest):
    """Points that are no vertex had nothing to tell which vertex stands for them."""

    def test_representatives_of_duplicates(self):
        points = ball(40)
        name = self.xyz("a.xyz", points + points[5:9])
        self.expect(0, "delaunay", name, "-o", self.path("out.ply"))
        self.assertEqual(self.vertices("out.ply")[0]["representative"], tuple(range(40)) + (5, 6, 7, 8))
        self.expect(0, "check", self.path("out.ply"))
        self.expect(0, "delaunay", name, "-o", self.path("out.vtu"))
        arrays, _ = self.appended_arrays("out.vtu")
        self.assertEqual(arrays["PointData", "representative"], tuple(range(40)) + (5, 6, 7, 8))

    def test_representatives_of_hidden_points(self):
        inside = self.ply("a.ply", [p + (1.0,) for p in ball(40)] + [(0.5, 0, 0, -9.0)], [("double", "weight")])
        facts = self.facts("delaunay", inside, "-o", self.path("out.ply"))
        self.assertEqual(facts["hidden"], 1)
        representatives = self.vertices("out.ply")[0]["representative"]
        self.assertEqual(representatives[:40], tuple(range(40)))
        nearest = min(range(40), key=lambda i: math.dist(ball(40)[i], (0.5, 0, 0)))
        self.assertEqual(representatives[40], nearest)

    def test_no_representatives_where_every_point_is_a_vertex(self):
        self.expect(0, "delaunay", self.xyz("a.xyz", ball(40)), "-o", self.path("out.ply"))
        self.assertNotIn("representative", self.vertices("out.ply")[0])

    def test_representatives_in_the_plane(self):
        flat = self.xyz("a.xyz", [(0, 0, 0), (1, 0, 5), (0, 1, 2), (1, 0, 3), (1, 1, 1)])
        self.expect(0, "delaunay", flat, "--plane", "xy", "-o", self.path("out.ply"))
        self.assertEqual(self.vertices("out.ply")[0]["representative"], (0, 1, 2, 1, 4))

    def test_a_property_of_that_name_is_kept(self):
        points = self.ply("a.ply", [p + (i,) for i, p in enumerate(ball(9) * 2)], [("int", "representative")])
        run = self.expect(0, "delaunay", points, "-o", self.path("out.ply"))
        self.assertRegex(run.err, "the property representative of the points is now input_representative")
        columns, _ = self.vertices("out.ply")
        self.assertEqual(columns["representative"], tuple(range(9)) * 2)
        self.assertEqual(columns["input_representative"], tuple(range(18)))


class Radii(LossTest):
    """Only the property weight was known, and not the radii that brio medial writes."""

    def balls(self, columns, *values):
        rows = [p + tuple(v(i) for v in values) for i, p in enumerate(ball(60))]
        return self.ply("a.ply", rows, [("double", name) for name in columns])

    def radius(self, i):
        return 0.1 + i % 7 / 50

    def checksum(self, *arguments):
        return self.facts("delaunay", *arguments)["checksum"]

    def test_a_radius_is_the_root_of_a_weight(self):
        weighted = self.checksum(self.balls(["weight"], lambda i: self.radius(i) ** 2))
        unweighted = self.checksum(self.path("a.ply"), "--unweighted")
        points = self.balls(["radius"], self.radius)
        self.assertNotEqual(weighted, unweighted)
        self.assertEqual(self.checksum(points), weighted)
        self.assertEqual(self.checksum(points, "--unweighted"), unweighted)
        both = self.balls(["radius", "weight"], self.radius, lambda i: self.radius(i) ** 2)
        self.assertEqual(self.checksum(both), weighted)

    def test_radii_are_said_to_weigh(self):
        points = self.balls(["radius"], self.radius)
        for how in [("delaunay",), ("voronoi", "--json"), ("alpha", "--alpha", "auto", "--json"),
                    ("locate", "--at", points, "--json")]:
            run = self.expect(0, how[0], points, *how[1:])
            self.assertRegex(run.err, "radius squared")
        self.assertEqual(self.expect(0, "delaunay", points, "--unweighted").err, "")
        self.assertEqual(self.expect(0, "delaunay", points, "--quiet").err, "")

    def test_weights_that_are_not_the_squares_of_the_radii(self):
        points = self.balls(["radius", "weight"], self.radius, lambda i: self.radius(i) ** 2 + (i == 17))
        for how in [("delaunay",), ("voronoi", "--json"), ("alpha", "--alpha", "auto", "--json")]:
            self.bad_input(r"point 17 \(counted from 0\) has the weight .* and the radius", how[0], points, *how[1:])
        self.expect(0, "delaunay", points, "--unweighted")
        self.expect(0, "info", points)

    def test_radii_that_are_none(self):
        for wrong in [-0.5, 1e200, math.nan]:
            points = self.balls(["radius"], lambda i: wrong if i == 3 else 1.0)
            self.bad_input(r"point 3 \(counted from 0\) has the radius", "delaunay", points)
            self.expect(0, "info", points)

    def test_radii_of_the_medial_axis(self):
        points = self.xyz("b.xyz", [tuple(c * s for c, s in zip(p, (3, 2, 1))) for p in ball(900)])
        self.expect(0, "medial", points, "-o", self.path("axis.ply"))
        self.assertIs(self.facts("delaunay", self.path("axis.ply"))["weighted"], True)

    def test_a_file_of_weights_overrules_properties(self):
        rows = self.file("rows.txt", "".join("%r\n" % (self.radius(i) ** 2) for i in range(60)))
        points = self.balls(["weight", "radius"], lambda i: 5.0 + i, lambda i: 1.0)
        run = self.expect(0, "delaunay", points, "--weights", rows, "-o", self.path("out.ply"))
        self.assertRegex(run.err, "--weights overrules the property weight")
        columns, _ = self.vertices("out.ply")
        self.assertEqual(columns["weight"], tuple(self.radius(i) ** 2 for i in range(60)))
        self.assertEqual(columns["input_weight"], tuple(5.0 + i for i in range(60)))
        self.assertEqual(set(columns["input_radius"]), {1.0})
        self.expect(0, "check", self.path("out.ply"))  # the old weights stood there, and the check failed

    def test_weights_that_were_ignored_do_not_fail_the_check(self):
        points = self.balls(["weight"], lambda i: self.radius(i) ** 2)
        for option in [(), ("--plane", "xy")]:
            self.expect(0, "delaunay", points, "--unweighted", "-o", self.path("out.ply"), *option)
            self.assertIn("input_weight", self.vertices("out.ply")[0])
        self.expect(0, "delaunay", points, "--unweighted", "-o", self.path("out.ply"))
        self.expect(0, "check", self.path("out.ply"))


class SelfIntersections(LossTest):
    """The report said - of self-intersections, as if there were none."""

    def test_what_was_not_counted_is_called_so(self):
        mesh = self.path("hull.ply")
        run = self.expect(0, "hull", self.xyz("a.xyz", ball(40)), "-o", mesh)
        self.assertRegex(run.text, r"self-intersections +not counted\n")
        self.assertIsNone(self.facts("check", mesh)["certificate"]["self_intersections"])
        self.assertRegex(self.expect(0, "check", mesh, "--self-intersections").text, r"self-intersections +0\n")

    def test_a_surface_that_intersects_itself_is_said_to(self):
        points = self.cloud("a.ply", 300, "clusters")
        how = ["surface", points, "--method", "power-crust", "-o", self.path("out.ply"), "--self-intersections"]
        run = self.expect(0, *how)
        pairs = self.facts(*how)["certificate"]["self_intersections"]
        self.assertGreater(pairs, 0)
        self.assertIn("brio: warning: the surface intersects itself: %d pairs of faces\n" % pairs, run.err)
        run = self.expect(0, "surface", points, "--method", "tight-cocone", "-o", self.path("out.ply"), "--self-intersections")
        self.assertEqual(run.err, "")


if __name__ == "__main__":
    main()
