"""brio medial: the power shape, its facts and its files."""

from brio_cli import CERTIFICATE, CliTest, COMMON_FACTS, count, CUBE, main, number, OCTAHEDRON, OCTAHEDRON_FACES


class Usage(CliTest):
    def test_wrong_options(self):
        points = self.xyz("a.xyz", CUBE)
        self.usage("no faces", "medial", points, "-o", "x.ply", "--labeling", "mesh")
        self.usage("less than 1", "medial", points, "-o", "x.ply", "--scale", "0.5")
        self.usage("not above 0", "medial", points, "-o", "x.ply", "--redundancy", "-1")
        self.usage("obj", "medial", points, "-o", "x.obj")


class NoAnswer(CliTest):
    def test_medial_axis_of_a_plane(self):
        points = self.xyz("a.xyz", [(x, y, 0) for x in range(6) for y in range(6)])
        self.expect(3, "medial", points, "-o", self.path("out.ply"))
        self.assert_only(self.folder, "a.xyz")

    def test_medial_axis_of_an_open_mesh(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES[:-1])
        run = self.expect(3, "medial", mesh, "-o", self.path("out.ply"))
        self.assertIn("along 3 edges", run.err)
        self.assertIn("--labeling global", run.err)
        self.assert_only(self.folder, "m.off")


class Facts(CliTest):
    def test_facts_of_a_run(self):
        points, out = self.cloud("a.ply", 2000, "sphere"), self.path("out.ply")
        counts = "samples poles inner outer unlabelled vertices edges triangles tetrahedra".split()
        seconds = {key: number for key in "read noise delaunay poles power label shape write total".split()}
        schema = {**COMMON_FACTS, **{key: count for key in counts}, "labeling": str, "method": str, "noise": number,
                  "smoothed": bool, "seconds": seconds}
        facts = self.facts("medial", points, "-o", out)
        self.assert_schema(facts, schema)
        self.assertEqual((facts["samples"], facts["unlabelled"]), (2000, 0))
        self.assertEqual(facts["labeling"], self.facts("surface", points, "-o", self.path("mesh.ply"), "--method", "power-crust")["labeling"])
        self.assertEqual(facts["poles"], facts["inner"] + facts["outer"])
        self.assertEqual(set(self.facts("info", out)["properties"]), {"radius", "side"})
        mesh = self.path("mesh.ply")
        facts = self.facts("medial", mesh, "-o", out, "--sides", "both")
        self.assert_schema(facts, schema)
        self.assertEqual(facts["labeling"], "mesh")
        self.assertEqual(self.facts("medial", mesh, "-o", out, "--labeling", "global")["labeling"], "global")

    def test_faces_of_a_mesh_are_sampled(self):
        """An octahedron has six vertices; its medial axis has more."""
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES)
        facts = self.facts("medial", mesh, "-o", self.path("out.ply"))
        self.assertGreater(facts["samples"], 5000)
        self.assertAlmostEqual(facts["spacing"], 0.01 * 12 ** 0.5, delta=1e-9)
        coarse = self.facts("medial", mesh, "-o", self.path("out.ply"), "--spacing", "0.2")
        self.assertLess(coarse["samples"], 1000)
        points = self.cloud("torus.ply", 500, "torus")
        self.usage("--spacing is for closed meshes", "medial", points, "-o", self.path("out.ply"), "--spacing", "0.1")

    def test_medial_facts_without_an_output(self):
        facts = self.facts("medial", self.cloud("torus.ply", 500, "torus"))
        self.assertEqual(facts["vertices"] - facts["edges"] + facts["triangles"] - facts["tetrahedra"], 0)

    def test_medial_simplified_with_its_crust(self):
        points, crust = self.cloud("a.ply", 2000, "torus"), self.path("crust.ply")
        whole = self.facts("medial", points, "-o", self.path("out.vtp"))
        facts = self.facts("medial", points, "-o", self.path("out.vtp"), "--simplify", "--crust", crust)
        self.assertLess(facts["vertices"], whole["vertices"])
        self.assertGreater(facts["left_out"], 0)
        self.assert_schema(facts, {"certificate": CERTIFICATE})
        self.assertEqual((facts["certificate"]["closed"], facts["certificate"]["genus"]), (True, 1))
        self.assertTrue(self.facts("check", crust)["certificate"]["manifold"])


class Voronoi(CliTest):
    def test_facets_of_points_and_of_a_mesh(self):
        points, out = self.cloud("a.ply", 1000, "torus"), self.path("out.ply")
        facts = self.facts("medial", points, "-o", out, "--method", "voronoi")
        self.assertEqual(facts["method"], "voronoi")
        self.assertGreater(facts["faces"], 500)
        self.assertGreaterEqual(facts["by_angle"] + facts["by_ratio"], facts["faces"])
        self.assertEqual(set(self.facts("info", out)["properties"]), {"radius", "side"})
        strict = self.facts("medial", points, "-o", out, "--method", "voronoi", "--theta", "1.2", "--rho", "30")
        self.assertLess(strict["faces"], facts["faces"])
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES)
        self.assertGreater(self.facts("medial", mesh, "-o", out, "--method", "voronoi", "--spacing", "0.2")["faces"], 50)

    def test_options_of_the_other_method_are_refused(self):
        points = self.cloud("a.ply", 100, "torus")
        for option in (["--simplify"], ["--scale", "2"], ["--redundancy", "1"], ["--scale-axis", "2"], ["--sharp"],
                       ["--crust", self.path("c.ply")], ["--labeling", "greedy"], ["--sampling-density", "0.4"]):
            self.usage("is for --method power-shape", "medial", points, "-o", self.path("x.ply"), "--method", "voronoi", *option)
        for option in ("--theta", "--rho"):
            self.usage("is for --method voronoi", "medial", points, "-o", self.path("x.ply"), option, "0.5")
        self.usage("less than 1", "medial", points, "-o", self.path("x.ply"), "--scale-axis", "0.5")
        self.expect(1, "medial", points, "-o", self.path("x.ply"), "--method", "voronoi", "--theta", "2")

    def test_scale_axis_leaves_balls_out(self):
        points = self.cloud("a.ply", 1500, "torus")
        whole = self.facts("medial", points, "-o", self.path("out.ply"))
        facts = self.facts("medial", points, "-o", self.path("out.ply"), "--scale-axis", "1.3")
        self.assertGreater(facts["left_out"], 0)
        self.assertLess(facts["vertices"], whole["vertices"])


class Files(CliTest):
    def test_power_shape_in_files(self):
        points = self.cloud("a.ply", 300, "torus")
        facts = self.facts("medial", points, "-o", self.path("out.ply"), "--ascii")
        n, e, t, k = (facts[key] for key in "vertices edges triangles tetrahedra".split())
        self.assertEqual(n - e + t - k, 0)  # a solid torus
        self.assertGreater(k, 0)
        with open(self.path("out.ply")) as f:
            lines = f.read().split("end_header\n")[1].splitlines()
        rows = [tuple(map(float, line.split())) for line in lines[:n]]
        faces = [tuple(map(int, line.split()))[1:] for line in lines[n:n + t]]
        solids = [tuple(map(int, line.split()))[1:] for line in lines[n + t:n + t + k]]
        edges = [tuple(map(int, line.split())) for line in lines[n + t + k:]]
        self.assertEqual((len(rows), len(faces), len(solids), len(edges)), (n, t, k, e))
        self.assertTrue(all(0 <= a < b < n for a, b in edges))
        sides = {tuple(sorted((f[i], f[i - 1]))) for f in faces for i in range(3)}
        self.assertTrue(sides <= set(edges))
        facets = {tuple(sorted(q[:i] + q[i + 1:])) for q in solids for i in range(4)}
        self.assertTrue(facets <= {tuple(sorted(f)) for f in faces})
        self.expect(0, "medial", points, "-o", self.path("out.vtp"))
        arrays, piece = self.appended_arrays("out.vtp")
        self.assertEqual(piece, {"NumberOfPoints": str(n), "NumberOfVerts": "0", "NumberOfLines": str(e),
                                 "NumberOfStrips": "0", "NumberOfPolys": str(t)})
        self.assertEqual(arrays["Points", "Points"], tuple(x for row in rows for x in row[:3]))
        self.assertEqual(arrays["PointData", "radius"], tuple(row[3] for row in rows))
        self.assertEqual(arrays["PointData", "side"], (-1,) * n)
        self.assertEqual(arrays["Lines", "connectivity"], tuple(v for edge in edges for v in edge))
        self.assertEqual(arrays["Lines", "offsets"], tuple(range(2, 2 * e + 1, 2)))
        self.assertEqual(arrays["Polys", "connectivity"], tuple(v for face in faces for v in face))
        self.assertEqual(arrays["Polys", "offsets"], tuple(range(3, 3 * t + 1, 3)))
        self.assertEqual(arrays["Verts", "connectivity"], ())
        self.expect(0, "medial", points, "-o", self.path("out.vtu"))
        arrays, _ = self.appended_arrays("out.vtu")
        self.assertEqual(arrays["Cells", "types"], (10,) * k + (7,) * t + (3,) * e)
        self.assertEqual(arrays["Cells", "connectivity"][:4 * k], tuple(v for q in solids for v in q))
        self.assertEqual(arrays["Cells", "connectivity"][4 * k + 3 * t:], tuple(v for edge in edges for v in edge))
        self.assertEqual(arrays["Cells", "offsets"][-1], 4 * k + 3 * t + 2 * e)
        for extension in ("ply", "vtu"):  # tetrahedra survive writing and reading
            self.expect(0, "medial", points, "-o", self.path("out." + extension))
            info = self.facts("info", self.path("out." + extension))
            self.assertEqual((info["points"], info["faces"], info["tetrahedra"]), (n, t, k))
        self.expect(0, "medial", points, "-o", self.path("out.xyz"))
        info = self.facts("info", self.path("out.vtp"))
        self.assertEqual((info["points"], info["faces"], info["tetrahedra"]), (n, t, 0))


if __name__ == "__main__":
    main()
