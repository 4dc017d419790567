"""brio delaunay: facts, orders, locations, weights, what reaches the output."""

import re

from brio_cli import (CliTest, COMMON_FACTS, count, CUBE, FLAT, FLAT_WRONG, main, number, OCTAHEDRON,
                      OCTAHEDRON_FACES, PLY_WITH_PROPERTIES)


class Usage(CliTest):
    def test_files_beside_node(self):
        cloud = self.cloud("a.xyz", 100)
        self.expect(0, "delaunay", cloud, "-o", self.path("t.ele"), "--neighbors", "--faces", "--edges", "--quiet")
        self.assert_only(self.folder, "a.xyz", "t.node", "t.ele", "t.neigh", "t.face", "t.edge")
        rows = {}
        for name in ("ele", "neigh", "face", "edge"):
            with open(self.path("t." + name), encoding="ascii") as f:
                rows[name] = [list(map(int, line.split())) for line in f if not line.startswith("#")][1:]
        self.assertEqual(len(rows["ele"]), len(rows["neigh"]))
        hull = sum(row.count(-1) for row in rows["neigh"])
        self.assertEqual(sum(row[-1] for row in rows["face"]), hull)
        self.assertEqual(100 - len(rows["edge"]) + len(rows["face"]) - len(rows["ele"]), 1, "Euler")

    def test_output_that_cannot_hold_tetrahedra(self):
        self.usage("cannot hold", "delaunay", "a.xyz", "-o", "out.obj")

    def test_two_sources_of_weights(self):
        self.usage("only one of", "delaunay", "a.xyz", "--weights", "w", "--weights-mod", "-3")


class Facts(CliTest):
    def test_facts_of_a_run(self):
        keys = ("points vertices duplicates hidden tetrahedra hull_facets created destroyed walk_steps insphere_calls "
                "exact_calls").split()
        facts = self.facts("delaunay", self.cloud("a.ply", 2000), "-o", self.path("out.vtu"))
        seconds = {key: number for key in "read order insert write total".split()}
        self.assert_schema(facts, {**COMMON_FACTS, **{key: count for key in keys}, "dimension": int,
                                   "seconds": seconds})
        self.assertRegex(facts["checksum"], r"\A[0-9a-f]{16}\Z")
        self.assertEqual(facts["points"], facts["vertices"] + facts["duplicates"] + facts["hidden"])
        self.assertEqual(facts["created"] - facts["destroyed"], facts["tetrahedra"] + facts["hull_facets"])
        self.assertNotIn("verified", facts)

    def test_checksums_have_their_leading_zeros(self):
        cubes = [self.facts("delaunay", self.cloud("c%d.ply" % n, n))["checksum"] for n in range(5, 60)]
        self.assertTrue(any(checksum.startswith("0") for checksum in cubes), "no checksum here begins with 0")
        self.assertEqual({len(checksum) for checksum in cubes}, {16})

    def test_orders(self):
        points = self.cloud("a.ply", 6000)
        orders = [["brio"], ["brio-octree"], ["brio-kdtree"], ["octree"], ["hilbert"], ["random"], ["input"],
                  ["brio-octree", "--block-size", "50"], ["octree", "--block-size", "1"],
                  ["brio-kdtree", "--round-ratio", "0.3"]]
        runs = [self.facts("delaunay", points, "--threads", "1", "--order", *order) for order in orders]
        self.assertEqual(len({run["checksum"] for run in runs}), 1)
        self.assertEqual(len({run["created"] for run in runs}), len(runs))
        for order in ["brio", "hilbert", "random", "input"]:
            self.usage("octree", "delaunay", points, "--order", order, "--block-size", "9")
        for order in ["octree", "hilbert", "random", "input"]:
            self.usage("has no rounds", "delaunay", points, "--order", order, "--round-ratio", "0.3")

    def test_counters_of_rounds(self):
        points = self.cloud("a.ply", 9000)
        keys = "points tetrahedra created destroyed walk_steps insphere_calls history".split()
        for arguments in [["--rounds"], ["--rounds", "--order", "brio-octree"], ["--rounds", "--order", "hilbert"],
                          ["--record-every", "4000"]]:
            facts = self.facts("delaunay", points, *arguments)
            for entry in facts["rounds"]:
                self.assert_schema(entry, {**{key: count for key in keys}, "locate_seconds": number, "seconds": number})
                self.assertEqual(entry["created"] - entry["destroyed"], entry["tetrahedra"])
            self.assertEqual(facts["rounds"][-1]["created"], facts["created"])
        self.assertEqual([entry["points"] for entry in facts["rounds"]], [4000, 8000, 9000])
        table = self.expect(0, "delaunay", points, "--rounds").text.split("\nrounds")[1]
        self.assertRegex(table, r"\A +\n +points +tetrahedra .*history +locate_seconds +seconds\n( +[0-9.]+){9}\n")
        self.assertNotIn("rounds", self.facts("delaunay", points))
        self.usage("only one of", "delaunay", points, "--rounds", "--record-every", "9")

    def test_history_is_counted(self):
        points = self.cloud("a.ply", 3000)
        plain = self.facts("delaunay", points)
        path = self.facts("delaunay", points, "--locate", "history")
        conflicts = self.facts("delaunay", points, "--locate", "history", "--all-conflicts")
        plain, path_counts, conflicts = (f["internals"] for f in (plain, path, conflicts))
        self.assertEqual((plain["history"], plain["history_tests"]), (0, 0))
        self.assertEqual(path_counts["history"], path["created"])
        self.assertGreater(path_counts["history_tests"], 3000)
        self.assertGreater(conflicts["history_tests"], path_counts["history_tests"])
        first = self.facts("delaunay", points, "--locate", "history", "--first-conflict")
        self.assertEqual(first["checksum"], path["checksum"])
        first = first["internals"]
        self.assertLess(first["history_tests"], conflicts["history_tests"])
        self.assertTrue(0 < first["history_conflicts"] < conflicts["history_conflicts"])
        self.assertEqual(path_counts["history_conflicts"], 0)
        self.usage("only one of", "delaunay", points, "--locate", "history", "--all-conflicts", "--first-conflict")
        self.usage("--first-conflict goes with", "delaunay", points, "--first-conflict")

    def test_page_touches_are_counted(self):
        points = self.cloud("a.ply", 1500)
        plain = self.facts("delaunay", points)
        for order, locate in (("random", "hierarchy"), ("brio-octree", "walk"), ("octree", "history"), ("random", "jump")):
            facts = self.facts("delaunay", points, "--order", order, "--locate", locate, "--page-size", "256", "--cache-size", "16K",
                               "--rounds")
            caches = {c["cache_pages"]: c["page_faults"] for c in facts["caches"]}
            self.assertEqual((facts["checksum"], facts["page_faults"]), (plain["checksum"], caches[64]))
            self.assertEqual(min(caches.values()), facts["pages"])
            self.assertEqual(sorted(caches.values(), reverse=True), list(caches.values()))
            last = facts["rounds"][-1]
            self.assertEqual([last[k] for k in ("pages", "page_touches", "page_faults")],
                             [facts[k] for k in ("pages", "page_touches", "page_faults")])
        self.assertNotIn("caches", plain)
        self.usage("power of two", "delaunay", points, "--page-size", "1000")
        self.usage("--cache-size goes with", "delaunay", points, "--cache-size", "1M")

    def test_failed_verification_would_write_nothing_new(self):
        facts = self.facts("delaunay", self.cloud("a.ply", 300), "--verify", "-o", self.path("out.ply"))
        self.assertIs(facts["verified"], True)
        self.assertIn("verify", facts["seconds"])


class Answers(CliTest):
    def test_delaunay_of_an_empty_file(self):
        facts = self.facts("delaunay", self.file("a.xyz", ""), "-o", self.path("out.ply"))
        self.assertEqual((facts["points"], facts["dimension"], facts["tetrahedra"]), (0, -1, 0))
        self.assertEqual(self.facts("info", self.path("out.ply"))["points"], 0)

    def test_delaunay_of_fewer_dimensions(self):
        for points, dimension in [([(1, 2, 3)], 0), ([(0, 0, 0), (1, 1, 1), (2, 2, 2)], 1), (CUBE[:4], 2), (CUBE, 3)]:
            facts = self.facts("delaunay", self.xyz("a.xyz", points), "--verify")
            self.assertEqual((facts["dimension"], facts["verified"]), (dimension, True))

    def test_duplicates_are_counted(self):
        points = self.xyz("a.xyz", CUBE + CUBE[:3] + [(-0.0, 0.0, -0.0)])
        self.assertEqual(self.facts("delaunay", points)["duplicates"], 4)
        self.assertEqual(self.facts("info", points)["duplicates"], 4)

    def test_every_order_and_number_of_threads_gives_the_same(self):
        points = self.cloud("a.ply", 3000)
        runs = [[], ["--order", "hilbert"], ["--order", "random"], ["--order", "input"], ["--threads", "1"],
                ["--seed", "99"], ["--round-ratio", "0.5"], ["--locate", "walk"], ["--locate", "jump"],
                ["--locate", "hierarchy"], ["--locate", "history"], ["--locate", "history", "--all-conflicts"]]
        self.assertEqual(len({self.facts("delaunay", points, *run)["checksum"] for run in runs}), 1)

    def test_every_location_gives_the_same(self):
        mesh = self.path("torus.ply")
        self.expect(0, "iso", self.ball_map("a.map"), "--level", "-6", "-o", mesh)
        plain = self.facts("delaunay", mesh)["checksum"]
        for location in ["walk", "jump", "hierarchy", "history", "trace", "neighbour"]:
            facts = self.facts("delaunay", mesh, "--locate", location, "--verify")
            self.assertTrue(facts["checksum"] == plain and facts["verified"], location)
            self.assertEqual("subgraph" in facts, location in ("trace", "neighbour"))
            self.assertEqual(facts["internals"]["trace_intersections"] > 0, location == "trace")
        for kind in ["bounded", "mst", "tree", "all"]:
            facts = self.facts("delaunay", mesh, "--locate", "trace", "--subgraph", kind)
            self.assertEqual((facts["checksum"], facts["subgraph"]["kind"]), (plain, kind))
        self.assertEqual(self.facts("delaunay", mesh, "--locate", "trace")["subgraph"]["max_degree"], 3)
        # the memory was estimated of edges that were not there yet, and refused
        limited = self.facts("delaunay", mesh, "--locate", "trace", "--max-memory", "500M")
        self.assertEqual(limited["checksum"], plain)

    def test_meshes_to_go_along(self):
        faces = OCTAHEDRON_FACES + [(0, 1, 2)]  # edges of three faces
        mesh = self.off("m.off", OCTAHEDRON + [(9, 9, 9), (1, 0, 0)], faces)
        plain = self.facts("delaunay", mesh)["checksum"]
        facts = self.facts("delaunay", mesh, "--locate", "trace", "-o", self.path("t.ply"))
        self.assertEqual((facts["checksum"], facts["subgraph"]["kind"], facts["duplicates"]), (plain, "mst", 1))
        self.assertEqual(self.facts("info", self.path("t.ply"))["faces"], 0)
        self.expect(3, "delaunay", mesh, "--locate", "trace", "--subgraph", "bounded")
        points = self.expect(2, "delaunay", self.xyz("p.xyz", CUBE), "--locate", "trace")
        self.assertIn("found no faces", points.err)
        self.usage("--locate trace and neighbour", "delaunay", mesh, "--subgraph", "mst")
        self.expect(4, "delaunay", self.cloud("c.ply", 2000), "--locate", "history", "--max-memory", "1M")


class Output(CliTest):
    def test_properties_survive(self):
        self.expect(0, "delaunay", self.file("a.ply", PLY_WITH_PROPERTIES), "-o", self.path("b.ply"), "--ascii")
        with open(self.path("b.ply")) as f:
            header, _, body = f.read().partition("end_header\n")
        names = re.findall(r"(?m)^property (?!list)(\w+) (\w+)$", header)
        self.assertEqual([name for _, name in names], ["x", "y", "z", "red", "quality"])
        rows = [list(map(float, line.split())) for line in body.splitlines()[:5]]
        self.assertEqual([row[3] for row in rows], [10, 20, 30, 40, 255])
        self.assertEqual([row[4] for row in rows], [0.25, 0.5, 0.125, 1e-9, -7])

    def test_faces_of_the_input_do_not_reach_the_output(self):
        mesh = self.off("m.off", OCTAHEDRON, OCTAHEDRON_FACES)
        self.expect(0, "delaunay", mesh, "-o", self.path("b.ply"))
        facts = self.facts("info", self.path("b.ply"))
        self.assertEqual((facts["points"], facts["faces"]), (6, 0))
        self.assertEqual(facts["tetrahedra"], 4)

    def test_tetrahedra_of_the_input_are_replaced(self):
        wrong = self.tetrahedra("t", FLAT, FLAT_WRONG)
        self.expect(0, "delaunay", wrong, "-o", self.path("b.ply"))
        self.assertEqual(self.facts("check", self.path("b.ply"))["tetrahedra"], 3)


class Weights(CliTest):
    # A light point at the centre of four heavy ones has no power cell.
    POINTS = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1), (0, 0, 0)]

    def weighted_ply(self, kind="double"):
        rows = "".join("%r %r %r %d\n" % (*p, 0 if p == (0, 0, 0) else 10) for p in self.POINTS)
        return self.file("w.ply", "ply\nformat ascii 1.0\nelement vertex 5\nproperty double x\nproperty double y\n"
                                  "property double z\nproperty %s weight\nend_header\n%s" % (kind, rows))

    def test_file_of_weights_with_comments(self):
        weights = self.file("w.txt", "# heavy corners\n10\n 10 # one more\n\n10\r\n1e1\n0\n")
        facts = self.facts("delaunay", self.xyz("a.xyz", self.POINTS), "--weights", weights, "--verify")
        self.assertEqual((facts["hidden"], facts["vertices"], facts["tetrahedra"]), (1, 4, 1))
        self.assertEqual((facts["weighted"], facts["verified"]), (True, True))

    def test_property_named_weight_is_used(self):
        for kind in ["double", "float", "int"]:
            self.assertEqual(self.facts("delaunay", self.weighted_ply(kind))["hidden"], 1)

    def test_property_is_ignored_when_unweighted(self):
        facts = self.facts("delaunay", self.weighted_ply(), "--unweighted")
        self.assertEqual((facts["hidden"], facts["weighted"]), (0, False))

    def test_file_wins_over_the_property(self):
        weights = self.file("w.txt", "0\n" * 5)
        self.assertEqual(self.facts("delaunay", self.weighted_ply(), "--weights", weights)["hidden"], 0)

    def test_modular_weights_are_those_of_the_rule(self):
        points = self.cloud("a.xyz", 2000)
        weights = self.file("w.txt", "".join("%r\n" % (i * 7919 % 1000 * 2.0 ** -14) for i in range(2000)))
        by_file = self.facts("delaunay", points, "--weights", weights)
        by_rule = self.facts("delaunay", points, "--weights-mod", "-14")
        self.assertEqual(by_file["checksum"], by_rule["checksum"])
        self.assertGreater(by_rule["hidden"], 0)

    def test_weights_through_standard_input(self):
        points = self.xyz("a.xyz", self.POINTS)
        self.assertEqual(self.facts("delaunay", points, "--weights", "-", stdin=b"10\n10\n10\n10\n0\n")["hidden"], 1)

    def test_output_holds_the_weights(self):
        points = self.xyz("a.xyz", self.POINTS)
        weights = self.file("w.txt", "10\n10\n10\n10\n0\n")
        self.expect(0, "delaunay", points, "--weights", weights, "-o", self.path("b.ply"))
        self.assertTrue(self.facts("check", self.path("b.ply"))["weighted"])

    def test_too_few_weights(self):
        run = self.expect(2, "delaunay", self.xyz("a.xyz", self.POINTS), "--weights", self.file("w.txt", "1\n2\n3\n"))
        self.assertRegex(run.err, r"w\.txt:3: .*3 weights for 5 points")

    def test_too_many_weights(self):
        weights = self.file("w.txt", "#\n" + "1\n" * 9)
        run = self.expect(2, "delaunay", self.xyz("a.xyz", self.POINTS), "--weights", weights)
        self.assertRegex(run.err, r"w\.txt:7: .*9 weights for 5 points")

    def test_weight_that_is_no_number(self):
        for text in ["1\nheavy\n", "1\nnan\n", "1\n1e999\n", "1\n2 3\n"]:
            run = self.expect(2, "delaunay", self.xyz("a.xyz", self.POINTS), "--weights", self.file("w.txt", text))
            self.assertRegex(run.err, r"w\.txt:2: ")

    def test_file_of_one_endless_line(self):
        weights = self.file("w.txt", "1" * 100000)
        self.expect(2, "delaunay", self.xyz("a.xyz", self.POINTS), "--weights", weights)

    def test_missing_file_of_weights(self):
        self.expect(2, "delaunay", self.xyz("a.xyz", self.POINTS), "--weights", "missing.txt")


if __name__ == "__main__":
    main()
