"""brio view and --view: the page holds what the file holds. Its blocks are read here by other code, in Python: to the
last bit for what is exact, within half a step for what is rounded. That the bundle is that of its sources is tested here, too,
since it needs no node. What the page shows is in tests/browser."""

import array
import base64
import hashlib
import html.parser
import json
import math
import os
import random
import re
import struct
import unittest
import zlib

from brio_cli import CliTest, CUBE, OCTAHEDRON, OCTAHEDRON_FACES, PLY_WITH_PROPERTIES, main

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
KINDS = {"int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "float32": "f", "float64": "d"}


class Page(html.parser.HTMLParser):
    """The elements of a page: layers, each with its description and its blocks."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.blocks, self.layers, self.scene, self.tags = {}, [], None, []
        self.element = None
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        self.element = dict(attributes) if tag == "script" else None

    def handle_endtag(self, tag):
        self.element = None

    def handle_data(self, data):
        e = self.element
        if not e:
            return
        if e.get("id") == "scene":
            self.scene = json.loads(data)
        elif e.get("class") == "layer":
            self.layers.append(json.loads(data))
        elif "data-name" in e:
            raw = base64.b64decode(data, validate=True)
            self.blocks[int(e["data-layer"]), e["data-name"]] = zlib.decompress(raw) if e["data-packed"] == "1" else raw

    def column(self, layer, name, n, width):
        """The numbers of a column of differences."""
        raw, out, before = self.blocks[layer, name], [], 0
        assert len(raw) == n * width, (name, len(raw), n, width)
        for i in range(n):
            z = sum(raw[p * n + i] << 8 * p for p in range(width))
            before = (before + ((z >> 1) ^ -(z & 1))) % 256 ** width
            out.append(before)
        return out

    def reals(self, layer, name, n, kind):
        raw, out, before, width = self.blocks[layer, name], [], 0, 8 if kind == "d" else 4
        assert len(raw) == n * width
        for i in range(n):
            before ^= sum(raw[p * n + i] << 8 * p for p in range(width))
            out.append(before)
        return [struct.unpack("<" + kind, struct.pack("<Q" if width == 8 else "<I", x))[0] for x in out]

    def corners(self, layer, name, n, size):
        return list(zip(*(self.column(layer, "%s-%d" % (name, k), n, 4) for k in range(size))))

    def triangles(self, layer):
        """As src/page/triangles.c describes them."""
        raw, n = self.blocks[layer, "triangles"], self.layers[layer]["triangles"]
        named, edges, corners, out = iter(raw[n:]), [], [], []
        new = last = 0

        def number():
            x = shift = 0
            for byte in named:
                x |= (byte & 127) << shift
                shift += 7
                if byte < 128:
                    return x
            raise AssertionError("the block of triangles ends early")

        def signed():
            z = number()
            return (z >> 1) ^ -(z & 1)

        for code in raw[:n]:
            if code >> 4 == 15:
                t = []
                for _ in range(3):
                    t.append(new - signed())
                    new += t[-1] == new
                corners += t
                edges.append((t[1], t[0]))
            else:
                a, b = edges[-1 - (code >> 4)]
                low = code & 15
                c = new if low == 0 else last + signed() if low == 15 else corners[-low]
                new += low == 0
                if low in (0, 15):
                    corners.append(c)
                t = [a, b, c]
            last = t[2]
            edges += [(t[2], t[1]), (t[0], t[2])]
            out.append(tuple(t))
        assert next(named, None) is None, "bytes are left"
        return out


def turned(triangle):
    """The triangle from its least corner on."""
    k = triangle.index(min(triangle))
    return triangle[k:] + triangle[:k]


class ViewTest(CliTest):
    def page(self, *arguments, name="page.html", **how):
        self.expect(0, "view", *arguments, "-o", self.path(name), "--quiet", **how)
        return self.read(name)

    def read(self, name):
        with open(self.path(name), encoding="utf-8") as f:
            return Page(f.read())

    def vertices(self, page, layer=0):
        """The exact vertices in the order of the file."""
        meta = page.layers[layer]
        n = meta["vertices"]
        numbers = page.column(layer, "vertices", n, 4)
        places = list(zip(*(page.reals(layer, "exact-" + axis, n, "d") for axis in "xyz")))
        return numbers, places


class Holds(ViewTest):
    def test_points_to_the_last_bit_and_near_them_the_rounded_ones(self):
        draw = random.Random(5)
        points = [tuple(draw.choice((1, -1)) * draw.random() * 10 ** draw.randint(-9, 3) for _ in range(3)) for _ in range(700)]
        page = self.page(self.xyz("p.xyz", points))
        meta = page.layers[0]
        numbers, places = self.vertices(page)
        self.assertEqual(sorted(numbers), list(range(700)))
        self.assertEqual([struct.pack("<3d", *p) for p in places], [struct.pack("<3d", *points[v]) for v in numbers])
        for k, axis in enumerate("xyz"):
            for q, p in zip(page.column(0, axis, 700, 3), places):
                self.assertLessEqual(abs(meta["low"][k] + meta["step"] * q - p[k]), 0.51 * meta["step"])

    def test_extreme_coordinates(self):
        for points in ([(1e308, 0, 0), (-1e308, 1, 2)], [(5e-324, 0, 0), (0, 0, 0)], [(7.5, 7.5, 7.5)], [(1e150, -1e-150, 0)] * 3):
            page = self.page(self.xyz("p.xyz", points))
            numbers, places = self.vertices(page)
            self.assertEqual([places[numbers.index(v)] for v in range(len(points))], [tuple(map(float, p)) for p in points])

    def test_faces_properties_and_certificate(self):
        self.expect(0, "generate", "scan", "-n", 700, "-o", self.path("scan.ply"), "--quiet")
        self.expect(0, "surface", self.path("scan.ply"), "-o", self.path("s.ply"), "--quiet", "--ascii")
        facts = self.facts("check", self.path("s.ply"), code=0)
        page = self.page(self.path("s.ply"))
        meta = page.layers[0]
        with open(self.path("s.ply")) as f:
            head, body = f.read().split("end_header\n")
        rows = body.splitlines()
        names = re.findall(r"property (\w+) (\w+)$", head.split("element face")[0], re.M)
        n, faces = meta["vertices"], meta["faces"]
        numbers, places = self.vertices(page)
        for v, place in zip(numbers, places):
            self.assertEqual(place, tuple(map(float, rows[v].split()[:3])))
        triangles = page.triangles(0)
        of_file = [tuple(map(int, row.split()[1:4])) for row in rows[n:n + faces]]
        for f, t in zip(page.column(0, "faces", faces, 4), triangles):
            self.assertEqual(turned(tuple(numbers[v] for v in t)), turned(of_file[f]))
        for p in meta["properties"]:
            kind = KINDS[p["type"]]
            column = [name for _, name in names].index(p["name"])
            if kind in "fd":
                values = page.reals(0, p["block"], n, kind)
                expected = [struct.unpack("<" + kind, struct.pack("<" + kind, float(rows[v].split()[column])))[0] for v in numbers]
            else:
                values = page.column(0, p["block"], n, struct.calcsize(kind))
                expected = [int(rows[v].split()[column]) % 256 ** struct.calcsize(kind) for v in numbers]
            self.assertEqual(values, expected, p["name"])
        for name in ("closed", "manifold", "oriented", "components", "genus", "boundary_edges", "boundary_loops"):
            self.assertEqual(meta["certificate"][name], facts["certificate"][name], name)

    def test_polygons_and_their_numbers(self):
        quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        page = self.page(self.off("cube.off", CUBE, quads))
        numbers, _ = self.vertices(page)
        sizes, order = page.column(0, "corners", 6, 4), page.column(0, "faces", 6, 4)
        self.assertEqual(sizes, [4] * 6)
        self.assertEqual(sorted(order), list(range(6)))
        triangles = [set(numbers[v] for v in t) for t in page.triangles(0)]
        for i, f in enumerate(order):
            self.assertEqual(triangles[2 * i] | triangles[2 * i + 1], set(quads[f]))

    def test_edges_that_are_wrong_are_named(self):
        # a boundary about two triangles, an edge of three faces, and an edge whose faces disagree
        points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (5, 0, 0), (6, 0, 0), (5, 1, 0), (6, 1, 1)]
        page = self.page(self.off("wrong.off", points, [(0, 1, 2), (1, 0, 3), (0, 1, 4), (5, 6, 7), (5, 6, 8)]))
        meta = page.layers[0]
        numbers, _ = self.vertices(page)
        named = {name: sorted(tuple(sorted((numbers[a], numbers[b]))) for a, b in page.corners(0, name, meta[name], 2))
                 for name in ("boundary", "nonmanifold", "flipped")}
        self.assertEqual(named["nonmanifold"], [(0, 1)])
        self.assertEqual(named["flipped"], [(5, 6)])
        self.assertEqual(named["boundary"], [(0, 2), (0, 3), (0, 4), (1, 2), (1, 3), (1, 4), (5, 7), (5, 8), (6, 7), (6, 8)])

    def test_crossing_faces(self):
        points = [(0, 0, 0), (2, 0, 0), (0, 2, 0), (0.5, 0.5, -1), (0.5, 0.5, 1), (3, 3, 0), (9, 9, 9), (10, 9, 9), (9, 10, 9)]
        path = self.off("x.off", points, [(0, 1, 2), (3, 4, 5), (6, 7, 8)])
        self.assertNotIn((0, "crossing"), self.page(path).blocks)
        page = self.page(path, "--self-intersections")
        order = page.column(0, "faces", 3, 4)
        self.assertEqual({f: mark for f, mark in zip(order, page.column(0, "crossing", 3, 1))}, {0: 1, 1: 1, 2: 0})
        self.assertEqual(page.layers[0]["certificate"]["self_intersections"], 1)

    def test_tetrahedra_and_what_is_seen_of_them(self):
        path = self.tetrahedra("t", CUBE[:5], [(0, 1, 2, 4), (1, 2, 3, 4)])
        page = self.page(path)
        numbers, _ = self.vertices(page)
        self.assertEqual([tuple(numbers[v] for v in t) for t in page.corners(0, "tetrahedra", 2, 4)], [(0, 1, 2, 4), (1, 2, 3, 4)])
        hull = {frozenset(numbers[v] for v in t) for t in page.corners(0, "hull", page.layers[0]["hull"], 3)}
        self.assertEqual(len(hull), 6)
        self.assertNotIn(frozenset((1, 2, 4)), hull)

    def test_every_type_of_property(self):
        page = self.page(self.file("p.ply", PLY_WITH_PROPERTIES))
        numbers, _ = self.vertices(page)
        of = {p["name"]: p for p in page.layers[0]["properties"]}
        self.assertEqual(page.column(0, of["red"]["block"], 5, 1), [[10, 20, 30, 40, 255][v] for v in numbers])
        self.assertEqual(page.reals(0, of["quality"]["block"], 5, "d"), [[0.25, 0.5, 0.125, 1e-9, -7][v] for v in numbers])

    def test_rounded_properties_know_what_is_missing_and_clouds_keep_normals(self):
        """More than 250,000 points are rounded; a property that is NaN has the step 0, which no number has."""
        n, names = 250001, ("x", "y", "z", "nx", "ny", "nz", "height")
        rows = array.array("d", [0]) * (7 * n)
        for i in range(n):
            rows[7 * i:7 * i + 7] = array.array("d", (i, i % 7, 0, 0, 0, 1, math.nan if i % 5 == 0 else i / n))
        head = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n%send_header\n" % (
            n, "".join("property double %s\n" % name for name in names))
        page = self.page(self.file("p.ply", head.encode() + rows.tobytes()))
        of = {p["name"]: p for p in page.layers[0]["properties"]}
        self.assertLessEqual({"nx", "ny", "nz", "height"}, set(of))
        column, low, high = page.column(0, of["height"]["block"], n, 2), of["height"]["low"], of["height"]["high"]
        places = page.column(0, "x", n, 3)
        for step, place in zip(column, places):
            i = round(page.layers[0]["low"][0] + page.layers[0]["step"] * place)
            self.assertEqual(step == 0, i % 5 == 0)
            if step:
                self.assertAlmostEqual(low + (step - 1) / 65534 * (high - low), i / n, delta=0.51 * (high - low) / 65534)

    def test_thinned_clouds_are_even_and_named(self):
        path = self.cloud("c.xyz", 4000)
        run = self.expect(0, "view", path, "-o", self.path("t.html"), "--points", 1000)
        self.assertIn("3000 points are not on the page", run.err)
        page = self.read("t.html")
        meta = page.layers[0]
        self.assertEqual((meta["vertices"], meta["all_vertices"]), (1000, 4000))
        numbers, places = self.vertices(page)
        self.assertEqual(len(set(numbers)), 1000)
        octants = {}
        for p in places:
            octants[tuple(x > 0.5 for x in p)] = octants.get(tuple(x > 0.5 for x in p), 0) + 1
        self.assertTrue(all(90 < count < 160 for count in octants.values()), octants)

    def test_without_points_there_is_a_page(self):
        self.assertEqual(self.page(self.file("e.ply", "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\n"
                                             "property float y\nproperty float z\nend_header\n")).layers[0]["vertices"], 0)


class Explains(ViewTest):
    """How a surface came to be, on a page. tests/unit/test_explanation.c holds it against the library."""

    def lists(self, page, name, n):
        counts = page.column(0, name, n, 4)
        return [sum(counts[:i]) for i in range(n + 1)]

    def test_poles_labels_and_faces_are_those_of_the_surface(self):
        self.expect(0, "generate", "scan", "-n", "150", "-o", self.path("few.ply"))
        self.expect(0, "surface", self.path("few.ply"), "--noise", "keep", "-o", self.path("out.ply"), "--view", self.path("page.html"), "--explain")
        page = self.read("page.html")
        m = page.layers[0]["explanation"]
        n, t = m["samples"], m["tetrahedra"]
        self.assertEqual((m["method"], n), ("labeled-delaunay", m["all_samples"]))
        self.assertAlmostEqual(m["theta"], math.pi / 8, places=15)
        place = list(zip(*(page.reals(0, "e-place-%d" % k, n, "d") for k in range(3))))
        ball = list(zip(*(page.reals(0, "e-pole-%d" % k, n, "d") for k in range(8))))
        points = page.column(0, "e-point", n, 4)
        for s in range(n):
            for pole in ball[s][:4], ball[s][4:]:
                if math.isfinite(pole[3]):
                    self.assertAlmostEqual(math.dist(pole[:3], place[s]), pole[3], delta=1e-9 * pole[3])
                    self.assertGreater(min(math.dist(pole[:3], p) for p in place), (1 - 1e-9) * pole[3])
        vertices, tetrahedra = self.lists(page, "e-vertices", n), self.lists(page, "e-tetrahedra", n)
        near = list(zip(*(page.reals(0, "e-vertex-%d" % k, m["vertices"], "f") for k in range(3))))
        corners = list(zip(*(page.column(0, "e-tetrahedron-%d" % k, t, 4) for k in range(3))))
        taken, side, sure = (page.column(0, "e-" + name, t, 1) for name in ("taken", "side", "confidence"))
        self.assertEqual((set(side), max(sure) <= 254), ({0, 2}, True))

        def sample(s, local):
            at = [x + d for x, d in zip(place[s], near[vertices[s] + local])]
            return points[min(range(n), key=lambda other: math.dist(place[other], at))]

        found = {frozenset((points[s], *(sample(s, c) for k, c in enumerate(corners[i], 1) if k != bit)))
                 for s in range(n) for i in range(tetrahedra[s], tetrahedra[s + 1]) for bit in (1, 2, 3) if taken[i] >> bit & 1}
        number = {p: points[s] for s, p in enumerate(place)}
        of = [number[p] for p in zip(*(page.reals(0, "exact-" + k, page.layers[0]["vertices"], "d") for k in "xyz"))]
        self.assertEqual(found, {frozenset(of[v] for v in f) for f in page.triangles(0)})

    def test_lengths_beyond_single_precision_were_nothing_or_infinite(self):
        points = [[int(x) for x in p] for p in ((3, 0, 1), (-5, 2, 0), (1, 4, -2), (0, -3, 6), (2, 2, 2), (-1, -4, -3), (4, -2, -5), (-3, 1, 5))]
        seen = []
        for exponent in 0, 900, -900:
            few = self.xyz("few.xyz", [[x * 2.0 ** exponent for x in p] for p in points])
            self.expect(0, "surface", few, "--method", "tight-cocone", "-o", self.path("out.ply"), "--view", self.path("page.html"), "--explain")
            page = self.read("page.html")
            m = page.layers[0]["explanation"]
            self.assertEqual(m["exponent"] == 0, exponent == 0)
            near = [x * 2.0 ** (m["exponent"] - exponent) for k in range(3) for x in page.reals(0, "e-vertex-%d" % k, m["vertices"], "f")]
            seen.append(["none" if math.isnan(x) else x for x in near])
        self.assertGreater(len({x for x in seen[0] if x != "none"}), 10)
        self.assertEqual(seen[1], seen[0])
        self.assertEqual(seen[2], seen[0])

    def test_memory_of_an_explanation_was_not_counted(self):
        self.expect(0, "generate", "sphere", "-n", "20000", "-o", self.path("many.npy"))
        needed = []
        for more in [], ["--explain"]:
            result = self.expect(4, "surface", self.path("many.npy"), "-o", self.path("out.ply"), "--view", self.path("page.html"), "--max-memory", "15M", *more)
            needed.append(float(re.search(r"about ([0-9.]+) MiB needed", result.err).group(1)))
        self.assertGreater(needed[1], needed[0] + 20)

    def test_of_many_samples_an_even_choice(self):
        self.expect(0, "generate", "sphere", "-n", "5400", "-o", self.path("many.npy"))
        report = self.expect(0, "surface", self.path("many.npy"), "--method", "cocone", "-o", self.path("out.ply"), "--view", self.path("page.html"), "--explain")
        self.assertIn("the page explains an even choice of 5000 of 5400 samples", report.err)
        m = self.read("page.html").layers[0]["explanation"]
        self.assertEqual((m["samples"], m["all_samples"]), (5000, 5400))
        self.assertLess(os.path.getsize(self.path("page.html")), 8e6)

    def test_wrong_uses(self):
        few = self.xyz("few.xyz", CUBE)
        for words, said in (("--explain", "--explain has no meaning without --view"), ("--explain --picture a.png", "without --view"),
                            ("--explain --view p.html --method cocone --pieces 2", "--explain and --pieces exclude each other"),
                            ("--explain --view p.html --curves", "--explain is for --method")):
            result = self.expect(1, "surface", few, "-o", self.path("out.ply"), *words.replace("a.png", self.path("a.png")).replace("p.html", self.path("p.html")).split())
            self.assertIn(said, result.err, words)


class Command(ViewTest):
    def test_several_files_are_layers(self):
        facts = self.facts("view", self.off("o.off", OCTAHEDRON, OCTAHEDRON_FACES), self.xyz("p.xyz", CUBE), "--side-by-side",
                           "--title", "both & <more>", "-o", self.path("page.html"))
        self.assertEqual((facts["layers"], facts["vertices"], facts["faces"], facts["exact"]), (2, 14, 8, True))
        self.assertEqual(facts["bytes"], os.path.getsize(self.path("page.html")))
        page = self.read("page.html")
        self.assertEqual([m["name"] for m in page.layers], ["o.off", "p.xyz"])
        self.assertEqual((page.scene["title"], page.scene["beside"]), ("both & <more>", 1))

    def test_results_of_other_commands(self):
        scan = self.cloud("scan.ply", 600, "scan")
        for line in ("surface", "hull", "alpha --alpha auto", "delaunay", "tree", "simplify --faces 100"):
            command, *rest = line.split()
            if command == "simplify":
                self.expect(0, "hull", scan, "-o", self.path("mesh.ply"), "--quiet")
            source = self.path("mesh.ply") if command == "simplify" else scan
            run = self.expect(0, command, source, *rest, "--view", self.path("v.html"))
            meta = self.read("v.html").layers[0]
            self.assertGreater(meta["faces"] + meta["tetrahedra"] + meta["edges"], 0, command)
            self.assertIn("vertices", meta["report"])
            self.assertRegex(run.text, r"page of --view +\d")
            os.remove(self.path("v.html"))

    def test_a_page_beside_the_output(self):
        scan = self.cloud("scan.ply", 600, "scan")
        self.expect(0, "surface", scan, "-o", self.path("s.ply"), "--view", self.path("v.html"), "--quiet")
        self.assertTrue(os.path.exists(self.path("s.ply")))
        self.assertEqual(self.read("v.html").layers[0]["name"], "s.ply")

    def test_a_page_on_standard_output(self):
        run = self.expect(0, "view", self.xyz("p.xyz", CUBE), "-o", "-", "--quiet")
        self.assertEqual(Page(run.out.decode()).layers[0]["vertices"], 8)

    def test_layers_are_called_by_names_without_folders(self):
        scan = self.xyz("p.xyz", CUBE)
        with open(scan, "rb") as f:
            page = self.page("-", stdin=f.read())
        self.assertEqual(page.layers[0]["name"], "a stream")
        self.expect(0, "hull", scan, "--view", self.path("v.html"), "--quiet")
        self.assertEqual(self.read("v.html").layers[0]["name"], "p.xyz")

    def test_wrong_uses(self):
        p = self.xyz("p.xyz", CUBE)
        self.usage("no output: -o FILE is missing", "view", p)
        self.usage("p.ply: a page is .html or .htm", "view", p, "-o", self.path("p.ply"))
        self.usage("--view and the input name the same file|a page is .html", "hull", p, "--view", p)
        self.usage("--view has no meaning for info", "info", p, "--view", self.path("v.html"))
        self.usage("--view has no meaning for convert", "convert", p, self.path("q.ply"), "--view", self.path("v.html"))
        self.usage("name the same file", "hull", p, "-o", self.path("v.html"), "--view", self.path("v.html"), "--format", "ply")
        self.usage("--ascii has no meaning here", "view", p, "-o", self.path("page.html"), "--ascii")
        self.usage("too many: '13'", "view", *range(1, 14), "-o", self.path("page.html"))
        self.expect(6, "view", p, "-o", self.path("nowhere/page.html"))
        self.expect(2, "view", p, self.path("missing.ply"), "-o", self.path("page.html"))
        self.assertFalse(os.path.exists(self.path("page.html")))

    def test_faces_that_cross_others_were_counted_and_not_shown(self):
        points = [(0, -1, 0), (2, -1, 0), (1, 1, 2), (0, 1, 0), (2, 1, 0), (1, -1, 2)]
        mesh = self.off("cross.off", points, [(0, 1, 2), (3, 4, 5)])
        for more, count in ((), -1), (("--self-intersections",), 1):
            self.expect(5, "check", mesh, *more, "--view", self.path("flaws.html"), "--picture", self.path("flaws.png"), "--quiet")
            page = self.read("flaws.html")
            self.assertEqual(page.layers[0]["certificate"]["self_intersections"], count)
            self.assertEqual((0, "crossing") in page.blocks, count > 0)
            self.assertTrue(os.path.exists(self.path("flaws.png")))

    def test_tetrahedra_that_fail_were_not_shown(self):
        mesh = self.path("t.vtu")
        self.expect(0, "delaunay", self.cloud("c.xyz", 50), "-o", mesh, "--quiet")
        for more, code in ((), 0), (("--weights-mod", "3"), 5):
            page = self.path("t%d.html" % code)
            self.expect(code, "check", mesh, *more, "--view", page, "--quiet")
            self.assertGreater(self.read("t%d.html" % code).layers[0]["tetrahedra"], 0)
        if os.path.exists("/dev/full"):
            os.symlink("/dev/full", self.path("full.html"))
            run = self.expect(6, "check", mesh, "--weights-mod", "3", "--view", self.path("full.html"))
            self.assertIn("full.html: ", run.err, "why there is no page was not said")
            self.assertNotIn("inside the sphere", run.err)

    def test_names_are_not_taken_for_html(self):
        evil = "a<img src=x onerror=alert(1)>.xyz"
        self.xyz(evil, CUBE)
        page = self.page(self.path(evil))
        self.assertEqual(page.layers[0]["name"], evil)
        self.assertNotIn("img", [tag for tag, _ in page.tags])


class Text(ViewTest):
    """The page without data."""

    def test_it_asks_for_nothing(self):
        page = self.page(self.xyz("p.xyz", CUBE))
        for tag, attributes in page.tags:
            self.assertFalse({"src", "href"} & set(attributes), tag)
        policy = [a["content"] for tag, a in page.tags if a.get("http-equiv") == "Content-Security-Policy"]
        self.assertIn("default-src 'none'", policy[0])
        self.assertNotIn("connect-src", policy[0])

    def test_it_is_small(self):
        self.assertLess(os.path.getsize(os.path.join(ROOT, "web", "page.html")), 85000)

    def test_the_bundle_is_that_of_its_sources(self):
        folder, digest = os.path.join(ROOT, "web", "src"), hashlib.sha256()
        for name in sorted(os.listdir(folder)):
            with open(os.path.join(folder, name), "rb") as f:
                digest.update(name.encode() + b"\n" + f.read())
        with open(os.path.join(ROOT, "web", "page.html"), encoding="utf-8") as f:
            found = re.search(r'data-sources="(\w+)"', f.read())
        self.assertEqual(found.group(1), digest.hexdigest(), "stale: sh scripts/setup.sh web && node web/build.mjs")


if __name__ == "__main__":
    main()
