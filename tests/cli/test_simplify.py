"""brio simplify: fewer triangles."""

import os
import unittest

from brio_cli import CliTest, CUBE, main, OCTAHEDRON, OCTAHEDRON_FACES

MODELS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "shared", "data", "model")


class Simplify(CliTest):
    def scan_surface(self):
        self.cloud("scan.ply", 4000, "scan")
        self.facts("surface", self.path("scan.ply"), "-o", self.path("mesh.ply"))
        return self.path("mesh.ply")

    def test_number_of_faces(self):
        mesh, out = self.scan_surface(), self.path("out.ply")
        before = self.facts("check", mesh, "--open", "--self-intersections")["certificate"]
        for wanted in [2000, 600]:
            facts = self.facts("simplify", mesh, "--faces", wanted, "-o", out)
            self.assertLessEqual(abs(facts["faces"] - wanted), 0.01 * wanted)
            after = self.facts("check", out, "--open", "--self-intersections")["certificate"]
            self.assertEqual([after[k] for k in ("genera", "components", "boundary_edges", "self_intersections")],
                             [before[k] for k in ("genera", "components", "boundary_edges", "self_intersections")])

    def test_error(self):
        mesh, out = self.scan_surface(), self.path("out.ply")
        fine, coarse = (self.facts("simplify", mesh, "--error", d, "-o", out)["faces"] for d in (0.001, 0.01))
        self.assertLess(coarse, fine)
        self.assertLess(self.facts("compare", out, mesh)["p95"], 0.02)

    def test_properties_stay(self):
        header = ("ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
                  "property uchar red\nelement face 8\nproperty list uchar int vertex_indices\nproperty short part\nend_header\n")
        rows = "".join("%g %g %g %d\n" % (*p, 10 * i) for i, p in enumerate(OCTAHEDRON))
        rows += "".join("3 %d %d %d %d\n" % (*f, -i) for i, f in enumerate(OCTAHEDRON_FACES))
        self.facts("simplify", self.file("a.ply", header + rows), "--faces", 6, "-o", self.path("out.ply"))
        facts = self.facts("info", self.path("out.ply"))
        self.assertEqual((facts["properties"], facts["face_properties"]), ({"red": "uint8"}, {"part": "int16"}))

    def test_what_cannot_be_reached_is_said(self):
        run = self.expect(0, "simplify", self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES[:5]), "--faces", 2, "-o", self.path("o.ply"))
        self.assertIn("5 faces are left, more than the 2 asked for", run.err)

    def test_polygons_and_edges_of_three_faces(self):
        """A mesh that is no manifold of triangles was refused."""
        cube = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3), (0, 1, 7)]
        facts = self.facts("simplify", self.off("c.off", CUBE, cube), "--faces", 4, "-o", self.path("o.ply"))
        self.assertEqual(facts["faces_before"], 7)
        self.assertGreater(facts["certificate"]["nonmanifold_edges"], 0)

    def test_wrong_uses(self):
        mesh, out = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES), self.path("s.ply")
        self.usage("--faces N or --error D is missing", "simplify", mesh, "-o", out)
        self.usage("-o FILE is missing", "simplify", mesh, "--faces", 4)
        self.expect(3, "simplify", self.xyz("p.xyz", CUBE), "--faces", 4, "-o", out)

    @unittest.skipUnless(os.path.isdir(MODELS), "skipped: no ../shared/data")
    def test_shared_models(self):
        for name, genus in [("rocker_arm.ply", 1), ("bracket.ply", 3), ("knot2.ply", 2)]:
            facts = self.facts("simplify", os.path.join(MODELS, name), "--faces", 700, "-o", self.path("o.ply"))
            self.assertLessEqual(abs(facts["faces"] - 700), 7)
            after = self.facts("check", self.path("o.ply"), "--self-intersections")["certificate"]
            self.assertEqual((after["genus"], after["self_intersections"]), (genus, 0))


if __name__ == "__main__":
    main()
