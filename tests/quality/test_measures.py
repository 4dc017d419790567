"""The measures of bench/quality, held against solids whose answers are known. Needs numpy and scipy."""

import importlib.util
import os
import sys
import tempfile
import unittest

if not all(importlib.util.find_spec(module) for module in ("numpy", "scipy")):
    print("skipped: no numpy or scipy")
    sys.exit(77)

import numpy as np

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "..", "bench", "quality"))
import corpus_tables
import measure_votes
import ply
import sampling
from inside import Inside
from thickness import Thickness

BRIO = os.environ.get("BRIO", "brio")
SIDES = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2),
         (1, 3, 7), (1, 7, 5)]


def box(low, high):
    corners = np.array([[z, y, x] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    return np.array(low) + corners * (np.array(high) - np.array(low)), np.array(SIDES)


def hollow_box():
    """A cube of side 4 with a cubic void of side 2."""
    outer, inner = box((0, 0, 0), (4, 4, 4)), box((1, 1, 1), (3, 3, 3))
    return np.vstack([outer[0], inner[0]]), np.vstack([outer[1], inner[1][:, ::-1] + 8])


class Meshes(unittest.TestCase):
    def test_a_box_faces_outwards(self):
        points, triangles = box((0, 0, 0), (1, 2, 3))
        areas, normals = sampling.areas_and_normals(points, triangles)
        out = points[triangles].mean(1) - np.array([0.5, 1, 1.5])
        self.assertAlmostEqual(areas.sum(), 22)
        self.assertTrue(((out * normals).sum(1) > 0).all())

    def test_a_file_is_read_as_it_was_written(self):
        points, triangles = box((0, 0, 0), (1, 2, 3))
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "box.ply")
            ply.write_mesh(path, points, triangles)
            found = ply.read_mesh(path)
            ply.write_points(path, points / 3, points)
            self.assertTrue((ply.read_mesh(path)[0] == points / 3).all())
        self.assertTrue((found[0] == points).all() and (found[1] == triangles).all())


class Sampling(unittest.TestCase):
    def test_first_come_is_one_after_the_other(self):
        points = np.random.default_rng(1).random((400, 3))
        kept = []
        for i, point in enumerate(points):
            if not kept or np.linalg.norm(points[kept] - point, axis=1).min() > 0.15:
                kept.append(i)
        self.assertEqual(np.flatnonzero(sampling.first_come(points, 0.15)).tolist(), kept)

    def test_even_points_keep_their_distance(self):
        points, triangles = box((0, 0, 0), (1, 2, 3))
        found, normals, radius = sampling.even_points(points, triangles, 500, np.random.default_rng(1))
        apart = np.linalg.norm(found[:, None] - found[None], axis=2) + np.eye(len(found)) * 9
        self.assertGreaterEqual(apart.min(), radius)
        self.assertAlmostEqual(len(found), 500, delta=15)
        self.assertTrue((np.abs(normals).max(1) > 0.999).all())

    def test_noise_moves_the_points_only(self):
        samples = sampling.sample("box", "noisy", *box((0, 0, 0), (1, 2, 3)))
        radius = np.linalg.norm(samples.exact[1:] - samples.exact[0], axis=1).min()
        self.assertAlmostEqual((samples.points - samples.exact).std() / radius, 0.3, delta=0.06)
        self.assertIsNone(sampling.sample("box", "vertices", *box((0, 0, 0), (1, 2, 3))))


class Shapes(unittest.TestCase):
    def test_the_inside_of_a_hollow_box(self):
        probes = np.random.default_rng(1).random((20000, 3)) * 5 - 0.5
        in_outer = ((probes > 0) & (probes < 4)).all(1)
        in_void = ((probes > 1) & (probes < 3)).all(1)
        self.assertTrue((Inside(*hollow_box())(probes) == (in_outer & ~in_void)).all())

    def test_a_plate_is_as_thick_as_it_is(self):
        mesh = box((0, 0, 0), (4, 4, 0.2))
        for way, spacings in [("random", 0.2 / np.sqrt(35.2 / 20000)), ("sparse", 0.2 / np.sqrt(35.2 / 4000))]:
            found = Thickness(*mesh).thinnest(sampling.sample("plate", way, *mesh))
            self.assertLess(found, spacings)
            self.assertGreater(found, (0.7 if way == "random" else 0.85) * spacings)

    def test_a_gap_counts_as_a_wall_does(self):
        points, triangles = box((0, 0, 0), (2, 2, 2))
        mesh = np.vstack([points, points + np.array([0, 0, 2.1])]), np.vstack([triangles, triangles + 8])
        facing = Thickness(*mesh)
        places = facing.points[:len(facing.at)]
        between = np.minimum(np.abs(places[:, 2] - 2), np.abs(places[:, 2] - 2.1)) < 1e-9
        off_the_rim = (np.abs(places[:, :2] - 1) < 0.9).all(1)
        self.assertTrue(np.allclose(facing.at[between & off_the_rim], 0.1, rtol=0.02))
        self.assertTrue((facing.at[~between] > 0.9).all())


class Votes(unittest.TestCase):
    def test_a_regular_tetrahedron(self):
        points = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], float)
        tets = np.array([[0, 1, 2, 3]])
        self.assertAlmostEqual(measure_votes.inradius_of(points, tets)[0], 1 / np.sqrt(3))
        self.assertTrue(np.allclose(measure_votes.centres_of(points, tets), 0))
        self.assertTrue(np.allclose(measure_votes.spacing_of(points, tets), 2 * np.sqrt(2)))
        facets, normals = measure_votes.hull_of(points, tets)
        self.assertTrue((np.einsum("ij,ikj->ik", normals, points[facets]) > 0).all())
        axes = measure_votes.axes_of(points, tets, np.zeros((1, 3)), (facets, normals))
        self.assertTrue(np.allclose(axes, points / np.sqrt(3)))

    def test_votes_of_a_ball(self):
        points = np.random.default_rng(1).normal(size=(500, 3))
        points /= np.linalg.norm(points, axis=1)[:, None]
        tets = measure_votes.triangulate(BRIO, points)
        counts = measure_votes.count_votes(points, points, tets, np.ones(len(tets)))
        hull = measure_votes.hull_of(points, tets)[0]
        self.assertEqual(counts.sum(), 4 * len(tets) + 3 * len(hull))
        self.assertEqual(counts[-1, 10:, 1].sum(), counts[..., 1].sum())  # ahead, and outside: the infinite ones alone
        self.assertGreater(counts[-1, 19, 1], 0.9 * counts[-1, :, 1].sum())

    def test_log_odds(self):
        counts = np.zeros((1, 3, 2))
        counts[0] = [[30, 10], [0, 0], [10, 30]]
        table = measure_votes.log_odds(counts)
        self.assertAlmostEqual(table[0, 0], -np.log(35 / 15))
        self.assertAlmostEqual(table[0, 2], np.log(35 / 15))
        self.assertEqual(table[0, 1], 0)


class Page(unittest.TestCase):
    def test_runs_are_counted_by_thickness(self):
        row = {"corpus": "c", "model": "m", "sampling": "even", "method": "power crust", "thinnest": "1.20", "right": "1",
               "sound": "1", "genus": "2", "true_genus": "2", "normals": "0.9", "chamfer": "0.1", "seconds": "1", "crossings": "0"}
        rows = [row, {**row, "thinnest": "inf", "right": "0", "genus": "4"}]
        text = corpus_tables.section("Title", rows, "%d models")
        self.assertIn("| 1 to 1.5 | 1 of 1, 100 % |", text)
        self.assertIn("| 12 and more | 0 of 1, 0 % |", text)
        self.assertIn("| power crust | 1 of 1, 100 % | 0 of 1, 0 % |", text)
        self.assertIn("| even | power crust | 1 of 2, 50 % | 1.00 | 0.9000 | 0.1000 | 0 | 1.0 |", text)


if __name__ == "__main__":
    unittest.main()
