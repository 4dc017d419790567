"""--picture: the picture shows what the mesh is. PNG files are read here by other code. The oracle for triangles projects them anew,
by what include/brio/page.h says of the projection, and finds the nearest one for each sample of a pixel."""

import json
import math
import pathlib
import random
import re
import struct
import zlib

from brio_cli import CliTest, CUBE, main

BACKGROUND, BOUNDARY = (238, 240, 243), (26, 158, 255)
MARGIN, SAMPLES = 0.04, 3
QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def read_png(data):
    """Width, height, and the rows of pixels of a PNG file of 8 bits and three colours. Every checksum has to be right."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed, names = 8, b"", []
    while at < len(data):
        size, name = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        assert zlib.crc32(name + body) == struct.unpack(">I", data[at + 8 + size:at + 12 + size])[0], name
        names.append(name)
        if name == b"IHDR":
            width, height, *kind = struct.unpack(">IIBBBBB", body)
            assert kind == [8, 2, 0, 0, 0]
        packed += body if name == b"IDAT" else b""
        at += 12 + size
    assert names[0] == b"IHDR" and names[-1] == b"IEND"
    raw, rows, above, filters = zlib.decompress(packed), [], bytes(3 * width), set()
    assert len(raw) == height * (3 * width + 1)
    for y in range(height):
        line = bytearray(raw[y * (3 * width + 1) + 1:(y + 1) * (3 * width + 1)])
        kind = raw[y * (3 * width + 1)]
        filters.add(kind)
        for i in range(3 * width):
            left, up, corner = line[i - 3] if i > 2 else 0, above[i], above[i - 3] if i > 2 else 0
            guess = left + up - corner
            nearest = min((left, up, corner), key=lambda c: abs(guess - c))
            line[i] = (line[i] + [0, left, up, (left + up) // 2, nearest][kind]) % 256
        rows.append([tuple(line[3 * x:3 * x + 3]) for x in range(width)])
        above = bytes(line)
    return width, height, rows, filters


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    return tuple(x / math.sqrt(dot(a, a)) for x in a)


class Projection:
    """Where points are in a picture: x, y in pixels from the upper left corner, z towards the eye in the same unit."""

    def __init__(self, points, look, width, height):
        back = unit(look)
        self.right = unit(cross((0, 0, 1), back))
        self.up, self.back = cross(back, self.right), back
        flat = [(dot(p, self.right), -dot(p, self.up)) for p in points]
        low, high = [min(c) for c in zip(*flat)], [max(c) for c in zip(*flat)]
        room = (width * (1 - 2 * MARGIN), height * (1 - 2 * MARGIN))
        self.scale = min(r / (h - l) for r, l, h in zip(room, low, high) if h > l)
        self.centre, self.middle = (width / 2, height / 2), [(l + h) / 2 for l, h in zip(low, high)]

    def __call__(self, p):
        flat = (dot(p, self.right), -dot(p, self.up))
        return tuple(c + self.scale * (x - m) for c, x, m in zip(self.centre, flat, self.middle)) + (self.scale * dot(p, self.back),)


def over(triangle, x, y):
    """The height of a projected triangle over (x, y), or None; and how near (x, y) is to its edges."""
    a, b, c = triangle
    area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    w = [((r[0] - q[0]) * (y - q[1]) - (r[1] - q[1]) * (x - q[0])) / area for q, r in ((b, c), (c, a), (a, b))]
    return dot(w, (a[2], b[2], c[2])) if min(w) >= 0 else None


def from_segment(a, b, x, y):
    d = (b[0] - a[0], b[1] - a[1])
    t = max(0, min(1, ((x - a[0]) * d[0] + (y - a[1]) * d[1]) / (dot(d, d) or 1)))
    return math.hypot(x - a[0] - t * d[0], y - a[1] - t * d[1])


class PictureTest(CliTest):
    def picture(self, *arguments, size="120x80", command="view"):
        facts = self.facts(command, *arguments, "--picture", self.path("p.png"), "--picture-size", size)
        with open(self.path("p.png"), "rb") as f:
            data = f.read()
        width, height, rows, self.filters = read_png(data)
        self.assertEqual("%dx%d" % (width, height), size)
        self.assertEqual(facts["picture"]["bytes"], len(data))
        return rows, facts["picture"]

    def ply(self, name, points, faces=(), vertex=(), face=(), rows=lambda i: "", marks=lambda i: ""):
        head = ["ply", "format ascii 1.0", "element vertex %d" % len(points), *("property double " + c for c in "xyz"),
                *("property " + p for p in vertex)]
        if faces:
            head += ["element face %d" % len(faces), "property list uchar int vertex_indices", *("property " + p for p in face)]
        body = ["%r %r %r %s" % (*p, rows(i)) for i, p in enumerate(points)]
        body += ["%d %s %s" % (len(f), " ".join(map(str, f)), marks(i)) for i, f in enumerate(faces)]
        return self.file(name, "\n".join([*head, "end_header", *body]) + "\n")


class Shows(PictureTest):
    def test_every_pixel_has_the_colour_of_the_nearest_triangle(self):
        draw, hues = random.Random(7), [(200 * (h & 1), 200 * (h >> 1 & 1), 200 * (h >> 2)) for h in range(1, 7)]
        for look in ((3, -2, 1), (-1, 0.2, -2)):
            faces, points = [], []
            for i in range(len(hues)):
                corners = [tuple(draw.uniform(-1, 1) for _ in range(3)) for _ in range(3)]
                (a, b, c), n = corners, len(points)
                front = dot(cross([y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, c)]), look) > 0
                points += corners
                faces.append((n, n + 1, n + 2) if front else (n, n + 2, n + 1))
            mesh = self.ply("soup.ply", points, faces, face=["uchar red", "uchar green", "uchar blue"], marks=lambda i: "%d %d %d" % hues[i])
            rows, facts = self.picture(mesh, "--look=%s,%s,%s" % look, size="78x52")
            project = Projection(points, look, 78, 52)
            self.assertAlmostEqual(facts["pixel"] * project.scale, 1, 9)
            for got, wanted in zip(facts["look"], unit(look)):
                self.assertAlmostEqual(got, wanted, 12)
            triangles = [[project(points[v]) for v in f] for f in faces]
            judged = [0, 0]
            for y in range(52):
                for x in range(78):
                    if any(from_segment(t[k], t[k - 1], x + 0.5, y + 0.5) < 2.2 for t in triangles for k in range(3)):
                        continue  # where the boundaries are marked
                    heights = [(z, i) for i, t in enumerate(triangles) for z in [over(t, x + 0.5, y + 0.5)] if z is not None]
                    pixel = rows[y][x]
                    judged[bool(heights)] += 1
                    if not heights:
                        self.assertEqual(pixel, BACKGROUND, (x, y))
                    elif len(heights) == 1 or sorted(heights)[-1][0] > sorted(heights)[-2][0] + 3:
                        hue = hues[max(heights)[1]]
                        light = max(pixel) / 200
                        self.assertTrue(0.2 < light < 1.2 and all(abs(p - light * h) <= 2 for p, h in zip(pixel, hue)), (x, y, pixel, hue))
            self.assertTrue(min(judged) > 60, judged)

    def test_a_boundary_is_marked_and_a_closed_mesh_has_none(self):
        square = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0)]
        rows, _ = self.picture(self.ply("square.ply", square, [(0, 1, 2, 3)]), "--look", "0,0,1")
        blue = [(x, y) for y, row in enumerate(rows) for x, p in enumerate(row) if p == BOUNDARY]
        # seen along z, y is upright: the square fills the width up to the margin
        self.assertTrue(abs(min(x for x, _ in blue) - 120 * MARGIN) < 2 and abs(max(x for x, _ in blue) + 1 - 120 * (1 - MARGIN)) < 2)
        self.assertTrue(len(blue) > 2 * 110 + 2 * 55)
        rows, _ = self.picture(self.ply("cube.ply", CUBE, QUADS))
        self.assertFalse(any(p == BOUNDARY for row in rows for p in row))

    def test_the_side_that_looks_away_has_another_colour(self):
        triangle = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
        mesh = self.ply("one.ply", triangle, [(0, 1, 2)])
        front, back = (self.picture(mesh, "--look", look)[0][60][x] for look, x in (("0,0,1", 40), ("0,0,-1", 80)))
        self.assertLess(max(front) - min(front), 20, "grey")
        self.assertGreater(back[0], back[2] + 30, "reddish")

    def test_a_property_is_shown_by_the_colour_map(self):
        square = [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)]
        mesh = self.ply("square.ply", square, [(0, 1, 2, 3)], vertex=["double depth"], rows=lambda i: square[i][0] * 50 - 10)
        rows, facts = self.picture(mesh, "--look", "0,-1,0", "--colour-by", "depth", size="80x80")
        self.assertEqual((facts["low"], facts["high"]), (-10, 40))
        left, middle, right = (rows[40][x] for x in (6, 40, 73))
        self.assertTrue(left[2] > left[1] and middle[1] > middle[0] and right[0] > 2 * right[2] and right[1] > 2 * right[2], (left, middle, right))
        same, facts = self.picture(mesh, "--look", "0,-1,0", "--colour-by", "x", size="80x80")
        self.assertEqual((same, facts["low"], facts["high"]), (rows, 0, 1))
        plain, facts = self.picture(mesh, "--look", "0,-1,0", "--colour-by", "none", size="80x80")
        self.assertTrue("low" not in facts and max(plain[40][40]) - min(plain[40][40]) < 20)
        self.usage('no mesh of the picture has a property "heat"', "view", mesh, "--picture", self.path("q.png"), "--colour-by", "heat")

    def test_points_are_discs_in_their_colours(self):
        cloud = self.ply("two.ply", [(0, 0, 0), (1, 0, 0)], vertex=["uchar red", "uchar green", "uchar blue"], rows=lambda i: ("250 20 30", "20 30 250")[i])
        rows, facts = self.picture(cloud, "--look", "0,-1,0", size="100x40")
        for colour, centre in ((0, 100 * MARGIN), (2, 100 * (1 - MARGIN))):
            mine = [(x, y) for y, row in enumerate(rows) for x, p in enumerate(row) if p[colour] > 150 and p[2 - colour] < 60]
            self.assertTrue(15 < len(mine) < 64, len(mine))
            self.assertTrue(all(math.hypot(x + 0.5 - centre, y + 0.5 - 20) < 4.5 for x, y in mine))
        self.assertAlmostEqual(facts["pixel"], 1 / 92)

    def test_colours_of_16_bits_that_are_all_dark_were_bright(self):
        """White is what the type and the whole file tell, in pictures and on pages, as it is for files that are written."""
        look = ("--look", "0,-1,0")
        for kind, value, seen in (("ushort", 255, 0), ("ushort", 65280, 255), ("uchar", 255, 255), ("float", 1, 255), ("float", 255, 255), ("double", 0.5, 128)):
            cloud = self.ply("p.ply", [(0, 0, 0), (1, 0, 0)], vertex=[kind + " red", kind + " green", kind + " blue"], rows=lambda i: "%r 0 0" % value)
            rows, _ = self.picture(cloud, *look, size="100x40")
            brightest = max(p[0] - p[1] for row in rows for p in row)
            self.assertLess(abs(brightest - seen), 30, (kind, value, brightest))
            self.expect(0, "view", cloud, "-o", self.path("p.html"), "--quiet")
            white = json.loads(re.search(r'class="layer">(.*?)</script>', pathlib.Path(self.path("p.html")).read_text(encoding="utf-8")).group(1))["white"]
            self.assertEqual(white, {"ushort": 65535, "uchar": 255, "double": 1}.get(kind, 255 if value > 1 else 1))

    def test_faces_that_cross_others_are_red_where_they_are_looked_for(self):
        points = [(0, -1, 0), (2, -1, 0), (1, 1, 2), (0, 1, 0), (2, 1, 0), (1, -1, 2)]
        mesh = self.off("cross.off", points, [(0, 1, 2), (3, 4, 5)])
        red = lambda rows: sum(p[0] > 1.8 * p[1] and p[0] > 1.8 * p[2] for row in rows for p in row)
        self.assertEqual(red(self.picture(mesh)[0]), 0)
        self.assertGreater(red(self.picture(mesh, "--self-intersections")[0]), 500)

    def test_tetrahedra_are_cut_in_half_towards_the_eye(self):
        points, cells = self.cloud("c.xyz", 200), self.path("c.vtu")
        self.expect(0, "delaunay", points, "-o", cells, "--quiet")
        rows, _ = self.picture(cells, "--look", "0,-1,0.0001", size="90x90")
        self.assertGreater(sum(p != BACKGROUND for row in rows for p in row), 4000)
        self.assertGreater(len({p for row in rows for p in row}), 40, "facets of many directions, not one side of a cube")

    def test_a_complex_was_hidden_by_marks_of_faults_that_are_none(self):
        rows, _ = self.picture(self.cloud("scan.ply", 300, "scan"), command="medial", size="180x120")
        colours = {p for row in rows for p in row}
        self.assertFalse(colours & {BOUNDARY, (255, 61, 166), (242, 217, 26)}, "marks")
        self.assertFalse(any(r > b + 30 for r, g, b in colours), "another side")

    def test_edges_are_lines(self):
        rows, _ = self.picture(self.cloud("c.xyz", 50), command="tree", size="160x120")
        dark = sum(max(p) < 160 for row in rows for p in row)
        self.assertTrue(500 < dark < 6000, dark)

    def test_layers_stand_side_by_side(self):
        a, b = (self.ply("%s.ply" % c, CUBE, QUADS, vertex=["uchar red", "uchar green", "uchar blue"], rows=lambda i: c) for c in ("200 10 10", "10 10 200"))
        rows, _ = self.picture(a, b, "--side-by-side")
        self.assertTrue(rows[40][30][0] > 2 * rows[40][30][2] and rows[40][90][2] > 2 * rows[40][90][0])
        one, _ = self.picture(a, b)
        self.assertFalse(one[40][90][2] > 2 * one[40][90][0])


    def test_layers_of_one_property_have_one_range(self):
        a, b = (self.ply("%d.ply" % v, CUBE, QUADS, vertex=["double heat"], rows=lambda i: v) for v in (0, 8))
        rows, facts = self.picture(a, b, "--side-by-side", "--colour-by", "heat")
        self.assertEqual((facts["low"], facts["high"]), (0, 8))
        low, high = rows[40][30], rows[40][90]
        self.assertTrue(low[2] > 2 * low[1] and high[0] > 2 * high[2], (low, high))


class Look(PictureTest):
    def test_the_direction_that_shows_most(self):
        look = self.picture(self.ply("cube.ply", CUBE, QUADS))[1]["look"]
        sides = sum(abs(x) > 0.3 for x in look)
        self.assertEqual(sides, 3, "three sides of a cube: %r" % look)
        for normal in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0.6, -0.6, 0.5)):
            n = unit(normal)
            u = unit(cross(n, (0.1, 0.2, 0.9)))
            v = cross(n, u)
            plate = [tuple(i * a + j * b for a, b in zip(u, v)) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
            look = self.picture(self.ply("plate.ply", plate, [(0, 1, 2, 3)]))[1]["look"]
            self.assertGreater(dot(look, n), 0.5, "the front of a plate that looks to %r" % (normal,))


    def test_directions_of_any_length(self):
        cube = self.ply("cube.ply", CUBE, QUADS)
        for scale in (1e-320, 8e307):
            look = self.picture(cube, "--look=%r,%r,%r" % (scale, -2 * scale, scale))[1]["look"]
            self.assertAlmostEqual(dot(look, look), 1, 12)
            self.assertGreater(dot(look, unit((1, -2, 1))), 1 - 1e-6)


class Bytes(PictureTest):
    def test_do_not_depend_on_the_number_of_threads(self):
        cloud, seen = self.cloud("c.ply", 3000, "scan"), set()
        self.expect(0, "surface", cloud, "-o", self.path("s.ply"), "--quiet")
        for threads in (1, 2, 5):
            self.picture(self.path("s.ply"), cloud, "--threads", threads, "--colour-by", "y")
            with open(self.path("p.png"), "rb") as f:
                seen.add(f.read())
        self.assertEqual(len(seen), 1)

    def test_rows_and_codes_of_every_kind_are_read_back(self):
        """A cloud of random colours packs badly, an empty picture well."""
        draw = random.Random(3)
        cloud = self.ply("c.ply", [(draw.random(), 0, draw.random()) for _ in range(4000)], vertex=["uchar red", "uchar green", "uchar blue"],
                         rows=lambda i: "%d %d %d" % tuple(draw.randrange(256) for _ in range(3)))
        _, facts = self.picture(cloud, "--look", "0,1,0", size="200x141")
        self.assertTrue(len(self.filters) > 2 and 30000 < facts["bytes"] < 3 * 200 * 141)
        rows, facts = self.picture(self.ply("empty.ply", []), size="1000x3")
        self.assertEqual({p for row in rows for p in row}, {BACKGROUND})
        self.assertLess(facts["bytes"], 600)
        self.picture(self.ply("one.ply", [(5, 5, 5)]), size="1x1")


class Uses(PictureTest):
    def test_every_command_that_makes_a_mesh_has_one_without_another_output(self):
        for line in (("hull",), ("alpha", "--alpha", "auto"), ("surface",), ("delaunay",)):
            facts = self.facts(line[0], self.cloud("c.ply", 300, "sphere"), *line[1:], "--picture", self.path("p.png"), "--view", self.path("p.html"))
            self.assertGreater(facts["picture"]["bytes"], 1000)
            self.assertGreater(facts["view_bytes"], 1000)

    def test_colours_of_faces_that_are_dropped_colour_nothing(self):
        """They were read as if of what is made in their place, beyond their end; or that could not be made."""
        draw, colours = random.Random(5), ["uchar red", "uchar green", "uchar blue"]
        points, corner = [tuple(draw.random() for _ in range(3)) for _ in range(400)], [(0, 1, 2)]
        painted = self.ply("painted.ply", points, corner, face=colours, marks=lambda i: "200 20 20")
        plain = self.ply("plain.ply", points, corner)
        for line in (("delaunay",), ("delaunay", "--plane", "xy"), ("terrain",), ("hull",), ("alpha", "--alpha", "auto"), ("surface",)):
            shown = [self.picture(file, *line[1:], command=line[0])[0] for file in (painted, plain)]
            self.assertTrue(shown[0] == shown[1], line)

    def test_wrong_uses(self):
        cube = self.ply("cube.ply", CUBE, QUADS)
        for words, arguments in (("a picture is .png", ("--picture", "x.jpg")), ("has no meaning without --picture", ("--look", "1,0,0", "-o", "x.html")),
                                 ("is no direction", ("--picture", "x.png", "--look", "0,0,0")), ("is no direction", ("--picture", "x.png", "--look", "1,2")),
                                 ("is no size", ("--picture", "x.png", "--picture-size", "300")), ("1 to 16384 pixels", ("--picture", "x.png", "--picture-size", "20000x2")),
                                 ("no output", ()), *(("has no meaning without a page", ("--picture", "x.png", *option))
                                                     for option in (("--points", "5"), ("--exact",), ("--title", "t")))):
            self.usage(words, "view", cube, *arguments)
        self.usage("1 to 16384 pixels", "surface", self.path("missing.ply"), "--picture", "x.png", "--picture-size", "16385x2")
        self.usage("--picture has no meaning for info", "info", cube, "--picture", self.path("x.png"))


if __name__ == "__main__":
    main()
