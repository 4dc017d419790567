"""brio restricted: against an independent computation in exact rational numbers, and on surfaces of known topology.

The judge knows nothing of Delaunay triangulations: it clips each face by the bisectors of each sample with all others, in
fractions, with the surface moved by a vector so small that it decides ties and nothing else."""

import itertools
import json
import math
import os
import random
from fractions import Fraction

from brio_cli import CliTest, main, OCTAHEDRON, OCTAHEDRON_FACES

SHIFT = [Fraction(1, 2 ** 60), Fraction(1, 2 ** 120), Fraction(1, 2 ** 180)]
CUBE_CORNERS = [(x, y, z) for x in (0, 4) for y in (0, 4) for z in (0, 4)]
CUBE_FACES = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7),
              (1, 7, 3)]


def scaled(points, factor, by=(0, 0, 0)): return [tuple(factor * c + b for c, b in zip(p, by)) for p in points]


def ring(long, short, outer=8, inner=3):
    """A torus of integer corners, roughly."""
    points, faces = [], []
    for i in range(long):
        for j in range(short):
            u, v = 2 * math.pi * i / long, 2 * math.pi * j / short
            r = outer + inner * math.cos(v)
            points.append((round(r * math.cos(u)), round(r * math.sin(u)), round(inner * math.sin(v))))
            a, b = i * short + j, (i + 1) % long * short + j
            c, d = (i + 1) % long * short + (j + 1) % short, i * short + (j + 1) % short
            faces += [(a, b, c), (a, c, d)]
    return points, faces


def ball(levels, radius=1.0):
    """An octahedron with its faces cut in four, on a sphere."""
    points, faces = [tuple(map(float, p)) for p in OCTAHEDRON], list(OCTAHEDRON_FACES)
    for _ in range(levels):
        middle, cut = {}, []
        for a, b, c in faces:
            m = []
            for u, v in ((a, b), (b, c), (c, a)):
                key = (min(u, v), max(u, v))
                if key not in middle:
                    p = [s + t for s, t in zip(points[u], points[v])]
                    length = sum(x * x for x in p) ** 0.5
                    middle[key] = len(points)
                    points.append(tuple(x / length for x in p))
                m.append(middle[key])
            cut += [(a, m[0], m[2]), (b, m[1], m[0]), (c, m[2], m[1]), tuple(m)]
        faces = cut
    return [tuple(radius * x for x in p) for p in points], faces


class Judge:
    """Counts by clipping polygons. Corners of polygons are named by their exact places."""

    def __init__(self, samples, points, faces):
        self.samples = [tuple(map(Fraction, s)) for s in samples]
        self.points = [tuple(Fraction(c) + d for c, d in zip(p, SHIFT)) for p in points]
        self.faces = faces
        self.piece = {}  # (face, sample): the polygon
        for f, s in itertools.product(range(len(faces)), range(len(samples))):
            polygon = self.clip(f, s)
            if polygon: self.piece[f, s] = polygon

    def nearer(self, p, a, b):
        """Positive where p is nearer to a than to b."""
        a, b = self.samples[a], self.samples[b]
        return sum((x - y) * (2 * c - x - y) for x, y, c in zip(a, b, p))

    def clip(self, f, s):
        polygon = [self.points[v] for v in self.faces[f]]
        for t in range(len(self.samples)):
            if t == s or self.samples[t] == self.samples[s]: continue
            at = [self.nearer(p, s, t) for p in polygon]
            if all(x >= 0 for x in at): continue
            if all(x <= 0 for x in at): return None
            kept = []
            for i, p in enumerate(polygon):
                j = (i + 1) % len(polygon)
                if at[i] >= 0: kept.append(p)
                if at[i] * at[j] < 0:
                    share = at[i] / (at[i] - at[j])
                    kept.append(tuple(x + share * (y - x) for x, y in zip(p, polygon[j])))
            polygon = kept
        return polygon

    def nearest(self, p):
        square = [sum((x - y) ** 2 for x, y in zip(p, s)) for s in self.samples]
        return frozenset(i for i, q in enumerate(square) if q == min(square))

    def crossings(self):
        """(face, place, nearest samples) of each point where a face meets a Voronoi edge."""
        found = {}
        for (f, _), polygon in self.piece.items():
            for p in polygon:
                near = self.nearest(p)
                if len(near) > 2: found[f, p] = near
        return [(f, p, near) for (f, p), near in found.items()]

    @staticmethod
    def parts(items, joints):
        parent = {i: i for i in items}

        def find(i):
            while parent[i] != i: i = parent[i]
            return i

        for i, j in joints: parent[find(i)] = find(j)
        return len({find(i) for i in items})

    def cells(self):
        """(cells that meet the surface, those that do not in a disk)."""
        all_cells, bad = {s for _, s in self.piece}, 0
        for s in all_cells:
            mine = {f: p for (f, t), p in self.piece.items() if t == s}
            sides = {}
            for f, polygon in mine.items():
                for i, p in enumerate(polygon): sides.setdefault(frozenset((p, polygon[i - 1])), []).append(f)
            corners = {p for polygon in mine.values() for p in polygon}
            joints = [tuple(fs) for fs in sides.values() if len(fs) == 2]
            bad += not (self.parts(mine, joints) == 1 and len(corners) - len(sides) + len(mine) == 1)
        return len(all_cells), bad

    def facets(self):
        """The same of facets and arcs."""
        segments = {}
        for (f, s), polygon in self.piece.items():
            for i, p in enumerate(polygon):
                near = self.nearest(tuple((x + y) / 2 for x, y in zip(p, polygon[i - 1])))
                if len(near) == 2: segments.setdefault(near, set()).add((f, frozenset((p, polygon[i - 1]))))
        bad = 0
        for mine in segments.values():
            ends = {}
            for segment in mine:
                for p in segment[1]: ends.setdefault(p, []).append(segment)
            joints = [tuple(at) for at in ends.values() if len(at) == 2]
            bad += not (self.parts(mine, joints) == 1 and len(ends) - len(mine) == 1)
        return len(segments), bad


class Restricted(CliTest):
    def run_restricted(self, samples, points, faces, *options):
        with open(self.path("s.xyz"), "w") as f: f.writelines("%r %r %r\n" % tuple(map(float, p)) for p in samples)
        mesh = self.off("m.off", points, faces)
        run = self.run_brio("restricted", self.path("s.xyz"), "--surface", mesh, "-o", self.path("t.off"), "--json", *options)
        self.assertIn(run.code, (0, 5), run.err)
        facts = json.loads(run.out)
        self.assertEqual(run.code == 0, facts["closed_ball"])
        with open(self.path("t.off")) as f: words = " ".join(line for line in f if not line.startswith("#")).split()
        n, m = int(words[1]), int(words[2])
        lists = words[4 + 3 * n:]
        triangles = [tuple(map(int, lists[4 * i + 1:4 * i + 4])) for i in range(m)]
        return facts, triangles


class Judged(Restricted):
    def judge(self, samples, points, faces):
        """Compares a run with the judge; returns whether it is certified."""
        facts, triangles = self.run_restricted(samples, points, faces)
        judge = Judge(samples, points, faces)
        crossings = judge.crossings()
        self.assertEqual((facts["voronoi_cells"], facts["bad_cells"]), judge.cells())
        # A Voronoi edge of k nearest samples is that of k - 2 triangles.
        edges = {near for _, _, near in crossings}
        self.assertEqual(len(set(map(frozenset, triangles))), len(triangles))
        self.assertEqual(len(triangles), sum(len(near) - 2 for near in edges))
        self.assertEqual(facts["crossings"], sum(len(near) - 2 for _, _, near in crossings))
        for t in triangles: self.assertTrue(any(set(t) <= near for near in edges), t)
        if all(len(near) == 3 for near in edges):
            self.assertEqual((facts["voronoi_facets"], facts["bad_facets"]), judge.facets())
            twice = [near for near in edges if sum(n == near for _, _, n in crossings) > 1]
            self.assertEqual((facts["voronoi_edges"], facts["bad_edges"]), (len(edges), len(twice)))
        return facts["closed_ball"]

    def random_samples(self):
        """Samples near small surfaces, in general position and on coarse grids."""
        rng = random.Random(1)
        two = (scaled(OCTAHEDRON, 3) + scaled(OCTAHEDRON, 2, (9, 1, 0)),
               OCTAHEDRON_FACES + [tuple(v + 6 for v in f) for f in OCTAHEDRON_FACES])
        for points, faces in ((scaled(OCTAHEDRON, 4), OCTAHEDRON_FACES), (CUBE_CORNERS, CUBE_FACES), ring(4, 3), two):
            for size, n in ((1000, 6), (1000, 12), (6, 14)):
                low, high = ([f(p[k] for p in points) for k in range(3)] for f in (min, max))
                samples = {tuple(low[k] + Fraction(rng.randrange(size + 1) * 64 // size, 64) * (high[k] - low[k]) for k in range(3))
                           for _ in range(n)}
                yield sorted(samples), points, faces

    def corners(self):
        """The corners of the surface, and those with the middles of the faces."""
        points, faces = ball(1, 8.0)
        sphere = ([tuple(map(round, p)) for p in points], faces)
        long = [ring(6, 3), ring(5, 4)] if os.environ.get("BRIO_LONG") else []
        for points, faces in ((scaled(OCTAHEDRON, 4), OCTAHEDRON_FACES), (CUBE_CORNERS, CUBE_FACES), sphere, *long):
            yield points, points, faces
            if len(faces) < 30 or long:
                middles = [tuple(Fraction(round(Fraction(64 * sum(points[v][k] for v in f), 3)), 64) for k in range(3)) for f in faces]
                yield points + middles, points, faces

    def ties(self):
        """Grids: Voronoi edges through corners of the surface and in its faces, samples on one sphere by four and eight."""
        octahedron, grid = scaled(OCTAHEDRON, 2), list(itertools.product((0, 2, 4), repeat=3))
        yield octahedron + [(0, 0, 0)], octahedron, OCTAHEDRON_FACES
        yield CUBE_CORNERS + [(2, 2, 2)], CUBE_CORNERS, CUBE_FACES
        yield grid, CUBE_CORNERS, CUBE_FACES
        yield [p for p in grid if p != (2, 2, 2)], CUBE_CORNERS, CUBE_FACES
        yield list(itertools.product((0, 4), (0, 2, 4), (0, 4))), CUBE_CORNERS, CUBE_FACES
        yield list(itertools.product((1, 3), repeat=3)), CUBE_CORNERS, CUBE_FACES
        yield [(1, 1, 1), (3, 3, 1), (3, 1, 3), (1, 3, 3)], CUBE_CORNERS, CUBE_FACES

    def test_every_answer_is_the_judges(self):
        answers = [self.judge(*one) for one in itertools.chain(self.random_samples(), self.corners(), self.ties())]
        self.assertGreaterEqual(min(answers.count(True), answers.count(False)), 10, answers)


class Certified(Restricted):
    def test_dense_samples_are_certified_and_sparse_ones_are_not(self):
        """A sphere and a torus: the restricted triangulation is a closed manifold of the same genus where it is certified."""
        points, faces = ball(4)
        for n, expected in ((3, None), (66, True), (200, True)):
            samples = points[:n] if n > 3 else points[:6]
            facts, triangles = self.run_restricted(samples, points, faces)
            if expected is not None: self.assertIs(facts["homeomorphic"], expected, n)
            if facts["homeomorphic"]:
                self.assertEqual(tuple(facts["certificate"][k] for k in ("closed", "manifold", "genus")), (True, True, 0))
                self.assertEqual(len(triangles), 2 * facts["voronoi_cells"] - 4)
        few, _ = self.run_restricted([(1, 0, 0), (-1, 0, 0), (0, 0.2, 0), (0, -0.1, 0.1)], points, faces)
        self.assertFalse(few["homeomorphic"])
        self.assertGreater(few["bad_cells"] + few["bad_facets"] + few["bad_edges"], 0)

    def test_genus_one(self):
        points, faces = ring(40, 16, 80, 30)
        facts, _ = self.run_restricted(points, points, faces)
        self.assertEqual((facts["homeomorphic"], facts["certificate"]["closed"], facts["certificate"]["genus"]), (True, True, 1))
        facts, _ = self.run_restricted(points[::37], points, faces)
        self.assertFalse(facts["homeomorphic"])

    def test_scales(self):
        """Powers of two of the coordinates change nothing, up to where squares have no doubles."""
        points, faces = ball(2)
        samples = points[:40]
        plain, triangles = self.run_restricted(samples, points, faces)
        for factor in (2.0 ** -500, 2.0 ** 400):
            facts, again = self.run_restricted(scaled(samples, factor), scaled(points, factor), faces)
            self.assertEqual(triangles, again)
            for key in ("closed_ball", "voronoi_cells", "bad_cells", "bad_facets", "bad_edges", "crossings"):
                self.assertEqual(facts[key], plain[key], key)


class Usage(CliTest):
    def test_wrong_uses(self):
        cloud, mesh = self.cloud("a.ply", 100, "sphere"), self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES)
        self.usage("--surface", "restricted", cloud)
        self.usage("standard input", "restricted", "-", "--surface", "-")
        self.assertIn("found no faces", self.expect(2, "restricted", cloud, "--surface", cloud).err)
        holed = self.off("h.off", OCTAHEDRON, OCTAHEDRON_FACES[:-1])
        self.assertIn("no closed manifold", self.expect(1, "restricted", cloud, "--surface", holed).err)
        quads = self.off("q.off", CUBE_CORNERS, [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
        self.assertIn("must be triangles", self.expect(1, "restricted", cloud, "--surface", quads).err)
        flat = self.xyz("f.xyz", [(x, y, 0) for x in range(3) for y in range(3)])
        self.assertIn("dimension 2", self.expect(3, "restricted", flat, "--surface", mesh).err)


if __name__ == "__main__":
    main()
