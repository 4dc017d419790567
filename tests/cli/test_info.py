"""brio info: what a file holds."""

import os
import subprocess

from brio_cli import (BRIO, CliTest, COMMON_FACTS, count, CUBE, main, number, OCTAHEDRON, OCTAHEDRON_FACES,
                      PLY_WITH_PROPERTIES, vector)


class Info(CliTest):
    def test_facts_of_a_run(self):
        facts = self.facts("info", self.cloud("a.ply", 500))
        self.assert_schema(facts, {**COMMON_FACTS, "points": count, "faces": count, "tetrahedra": count,
                                   "box": {"min": vector, "max": vector}, "duplicates": count, "spacing": number,
                                   "estimate_bytes": {"delaunay": count, "surface": count, "medial": count,
                                                      "offset": count, "plane": count, "voronoi": count,
                                                      "hull": count, "alpha": count, "locate": count,
                                                      "interpolate": count, "cocone": count, "explained": count}, "properties": dict})

    def test_info_of_an_empty_file(self):
        facts = self.facts("info", self.file("a.xyz", ""))
        self.assertEqual((facts["points"], facts["box"], facts["spacing"]), (0, None, None))

    def test_info_of_one_place(self):
        facts = self.facts("info", self.xyz("a.xyz", [(1, 2, 3)] * 5))
        self.assertEqual((facts["duplicates"], facts["spacing"]), (4, None))

    def test_info_of_a_mesh(self):
        facts = self.facts("info", self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES))
        self.assertEqual((facts["points"], facts["faces"], facts["tetrahedra"]), (6, 8, 0))

    def test_info_spacing_of_a_grid(self):
        facts = self.facts("info", self.cloud("a.xyz", 1000, "grid"))
        self.assertEqual((facts["spacing"], facts["box"]), (1, {"min": [0, 0, 0], "max": [9, 9, 9]}))

    def test_info_spacing_at_extreme_scales(self):
        for scale in [1e-200, 1e200]:
            facts = self.facts("info", self.xyz("a.xyz", [tuple(scale * c for c in p) for p in CUBE]))
            self.assertAlmostEqual(facts["spacing"] / scale, 1)

    def test_properties_are_named(self):
        facts = self.facts("info", self.file("a.ply", PLY_WITH_PROPERTIES))
        self.assertEqual(facts["properties"], {"red": "uint8", "quality": "float64"})
        self.assertEqual(facts["ranges"], {"red": [10, 255], "quality": [-7, 0.5]})

    def test_version_of_a_las_file(self):
        facts = self.facts("info", self.cloud("a.las", 100))
        self.assertEqual((facts["format"], facts["version"]), ("las", "1.2, point format 0"))
        self.assertEqual(len(facts["coordinate_step"]), 3)

    def test_formats_that_begin_alike_have_their_names(self):
        """A VTP file was called vtu, and LAZ las."""
        for name in ["a.vtp", "a.vtu", "a.vtk", "a.las", "a.laz"]:
            self.expect(0, "generate", "cube", "-n", 9, "-o", self.path(name))
            self.assertEqual(self.facts("info", self.path(name))["format"], name[2:])
            with open(self.path(name), "rb") as f:
                self.file("nameless", f.read())
            self.assertEqual(self.facts("info", self.path("nameless"))["format"], name[2:])


    def test_offsets_of_a_mesh_are_estimated_by_its_faces(self):
        """They were estimated by its points, of which a cube has eight: 16 kB for a hundred times as much."""
        mesh = self.off("a.off", OCTAHEDRON, OCTAHEDRON_FACES)
        by_faces = self.facts("info", mesh)["estimate_bytes"]["offset"]
        by_points = self.facts("info", self.xyz("a.xyz", OCTAHEDRON))["estimate_bytes"]["offset"]
        self.assertGreater(by_faces, by_points + 1000 * len(OCTAHEDRON))
        if "asan" in subprocess.run(["ldd", BRIO], stdout=subprocess.PIPE).stdout.decode():
            self.skipTest("the sanitizer's memory counts")
        out = self.facts("offset", mesh, "--distance", "0.02", "-o", self.path("out.ply"))
        if os.environ.get("BRIO_EMULATED"):
            self.skipTest("the memory of what runs the program counts")
        self.assertGreater(by_faces, 0.5 * out["peak_bytes"])


if __name__ == "__main__":
    main()
