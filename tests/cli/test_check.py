"""brio check: surfaces and tetrahedra that are right, and each way to be wrong."""

from brio_cli import (CERTIFICATE, CliTest, COMMON_FACTS, CUBE, FLAT, FLAT_RIGHT, FLAT_WRONG, main, OCTAHEDRON,
                      OCTAHEDRON_FACES)


class Facts(CliTest):
    def test_facts_of_a_run(self):
        mesh = self.facts("check", self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES))
        self.assert_schema(mesh, {**COMMON_FACTS, "certificate": CERTIFICATE})
        tetrahedra = self.facts("check", self.tetrahedra("t", FLAT, FLAT_RIGHT))
        self.assert_schema(tetrahedra, {**COMMON_FACTS, "verified": bool, "canonical": bool})

    def test_surface_held_against_its_points(self):
        """A lid over half a ball, made of two triangles or of many."""
        half = [p for p in self.sphere(3000) if p[2] > 0.1]
        points, lid = self.xyz("half.xyz", half), self.path("closed.ply")
        self.expect(0, "surface", points, "--closed", "-o", lid, "--quiet")
        self.facts("subdivide", lid, "-o", self.path("fine.ply"))
        for mesh in [lid, self.path("fine.ply")]:
            facts = self.facts("check", mesh, "--samples", points)
            self.assertEqual((facts["bridges"]["number"], facts["points_left_out"]), (1, 0))
            self.assertTrue(0.2 < facts["bridges"]["area_share"] < 0.4)
            self.assertLess(max(abs(x) for x in facts["bridges"]["largest_centre"]), 0.4)
            self.assertTrue(5 < facts["far_area_percent"] < 30)
        self.expect(0, "surface", points, "-o", self.path("open.ply"), "--quiet")
        facts = self.facts("check", self.path("open.ply"), "--open", "--samples", points)
        self.assertEqual((facts["bridges"]["number"], facts["far_area_percent"]), (0, 0))

    def test_check_of_points_alone(self):
        self.bad_input("points only", "check", self.xyz("a.xyz", CUBE))


class Surfaces(CliTest):
    def test_closed_surface(self):
        facts = self.facts("check", self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES))
        c = facts["certificate"]
        self.assertEqual((c["closed"], c["manifold"], c["oriented"]), (True, True, True))
        self.assertEqual((c["components"], c["genus"], c["genera"], c["boundary_loops"]), (1, 0, [0], 0))
        self.assertIsNone(c["self_intersections"])

    def test_open_surface(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES[:-1])
        facts = self.facts("check", mesh, code=5)
        self.assertEqual((facts["certificate"]["closed"], facts["certificate"]["boundary_edges"]), (False, 3))
        self.assertEqual((facts["exit"], "not closed" in facts["error"]), (5, True))
        self.assertFalse(self.facts("check", mesh, "--open")["certificate"]["closed"])

    def test_surface_with_a_flipped_face(self):
        faces = [OCTAHEDRON_FACES[0][::-1]] + OCTAHEDRON_FACES[1:]
        mesh = self.off("m.off", OCTAHEDRON, faces)
        self.assertFalse(self.facts("check", mesh, "--open", code=5)["certificate"]["oriented"])

    def test_surface_with_a_face_too_many(self):
        mesh = self.off("m.off", OCTAHEDRON + [(3, 3, 3)], OCTAHEDRON_FACES + [(0, 2, 6)])
        self.assertFalse(self.facts("check", mesh, "--open", code=5)["certificate"]["manifold"])

    def test_failed_check_reports_to_people_too(self):
        run = self.expect(5, "check", self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES[:-1]))
        self.assertRegex(run.text, r"closed +no")
        self.assertRegex(run.err, r"\Abrio: \S+m\.off: the surface is not closed: 3 boundary edges in 1 loop\nbrio: hint: --open")

    def test_check_of_self_intersections(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES)
        facts = self.facts("check", mesh, "--self-intersections")
        self.assertEqual(facts["certificate"]["self_intersections"], 0)
        twice = self.off("t.off", OCTAHEDRON + [(x + .5, y, z) for x, y, z in OCTAHEDRON],
                         OCTAHEDRON_FACES + [tuple(v + len(OCTAHEDRON) for v in face) for face in OCTAHEDRON_FACES])
        self.assertIn("pairs of faces", self.expect(5, "check", twice, "--self-intersections").err)
        self.expect(0, "check", twice)


class Tetrahedra(CliTest):
    def test_right_tetrahedra(self):
        facts = self.facts("check", self.tetrahedra("t", FLAT, FLAT_RIGHT))
        self.assertEqual((facts["verified"], facts["canonical"]), (True, True))

    def test_wrong_tetrahedra(self):
        facts = self.facts("check", self.tetrahedra("t", FLAT, FLAT_WRONG), code=5)
        self.assertEqual((facts["verified"], facts["exit"]), (False, 5))

    def test_tetrahedra_that_leave_a_part_uncovered(self):
        self.expect(5, "check", self.tetrahedra("t", FLAT, FLAT_RIGHT[:2]))

    def test_tetrahedra_that_overlap(self):
        self.expect(5, "check", self.tetrahedra("t", FLAT, FLAT_RIGHT + FLAT_RIGHT[:1]))

    def test_neighbours_on_one_side_of_their_facet(self):
        points = [(1, 2, 0), (0, 2, 1), (2, 0, 1), (0, 1, 2), (0, 0, 0), (0, 1, 1), (0, 2, 2), (0, 1, 0)]
        right = [(5, 4, 7, 2), (5, 4, 2, 3), (0, 4, 2, 7), (0, 5, 7, 2), (0, 5, 2, 3), (0, 1, 7, 5), (0, 1, 5, 3),
                 (0, 6, 3, 2), (0, 6, 1, 3)]
        self.assertTrue(self.facts("check", self.tetrahedra("t", points, right))["verified"])
        wrong = right[:5] + [(0, 1, 6, 5)] + right[6:]
        self.assertFalse(self.facts("check", self.tetrahedra("t", points, wrong), code=5)["verified"])

    def test_other_triangulation_of_a_cube_is_verified_but_not_canonical(self):
        fives = [[(0, 1, 2, 4), (3, 2, 1, 7), (5, 1, 4, 7), (6, 4, 2, 7), (1, 2, 4, 7)],
                 [(1, 3, 0, 5), (2, 0, 3, 6), (4, 0, 5, 6), (7, 3, 6, 5), (0, 3, 5, 6)]]
        found = [self.facts("check", self.tetrahedra("t", CUBE, five)) for five in fives]
        self.assertTrue(all(f["verified"] for f in found))
        self.assertFalse(all(f["canonical"] for f in found))

    def test_index_out_of_range_is_a_fault_of_the_file(self):
        self.expect(2, "check", self.tetrahedra("t", FLAT, [(0, 1, 2, 9)]))

    def test_output_of_delaunay_passes(self):
        for extension in ["ply", "node"]:
            out = self.path("out." + extension)
            self.expect(0, "delaunay", self.cloud("a.xyz", 500), "-o", out, "--weights-mod", "-12")
            weights = ["--weights-mod", "-12"] if extension == "node" else []
            facts = self.facts("check", out, *weights)
            self.assertEqual((facts["verified"], facts["canonical"], facts["weighted"]), (True, True, True))

    def test_weighted_output_fails_as_unweighted(self):
        out = self.path("out.ply")
        self.expect(0, "delaunay", self.cloud("a.xyz", 500), "-o", out, "--weights-mod", "-12")
        self.assertFalse(self.facts("check", out, "--unweighted", code=5)["verified"])


if __name__ == "__main__":
    main()
