"""test_mpi.py BUILD: brio-mpi against brio, oversubscribed on this machine: equal reports for every number of ranks, output,
and hosts that are network namespaces. test_mpi_faults.py has failures.

BRIO_LONG=1 adds the larger inputs, and every set for every number of ranks; BRIO_MPI_HOSTS=0 leaves out the namespaces, which
need root."""

import json
import os
import random
import shutil
import subprocess
import sys
import unittest

from mpi_case import BRIO, LONG, SAME, SHARED, MpiCase, facts_of


class Mpi(MpiCase):
    # --- equal results ---

    def test_ranks_of_every_number(self):
        path = self.generate("cube", 20000)
        for ranks in (1, 2, 3, 5, 8):
            facts = self.same(ranks, path)
            self.assertEqual(facts["ranks"]["count"], ranks)
            self.assertEqual(facts["ranks"]["far_asked"] > 0, ranks > 1)

    def test_kinds_of_points(self):
        for i, (kind, points) in enumerate((("clusters", 8000), ("grid", 4000), ("sphere", 800), ("scan", 6000))):
            self.same((2, 3, 5, 8)[i], self.generate(kind, points))

    def test_weights_and_ties(self):
        path = self.generate("cube", 6000)
        self.same(3, path, "--weights-mod=-10")
        rng = random.Random(3)
        ties = [[rng.randrange(6) for _ in range(3)] for _ in range(3000)]
        self.same(5, self.rows("ties.xyz", ties), tiles=1)
        self.same(2, self.rows("same.xyz", [[1, 2, 3]] * 500))
        self.same(3, self.rows("plane.xyz", [[x, y, 4] for x in range(20) for y in range(20)]))

    def test_cells_of_ranks_are_counted_and_summed(self):
        counts = "weighted points duplicates hidden dimension cells bounded faces box_volume".split()
        sets = [(self.generate("cube", 8000), "--box=0,0,0,1,1,1"), (self.generate("clusters", 4000, "b.ply"),),
                (self.generate("grid", 2000, "c.ply"), "--box=-1,-1,-1,20,20,20", "--weights-mod=-12")]
        for arguments in sets:
            plain = self.one(*arguments, command="voronoi")
            sums = set()
            for ranks, tiles in ((1, 1), (1, 4), (2, 3), (3, 2), (5, 1), (8, 2)):
                many = self.mpi(ranks, *arguments, "--tiles-per-rank", tiles, command="voronoi")
                self.assertEqual({k: plain.get(k) for k in counts}, {k: many.get(k) for k in counts}, (ranks, arguments))
                self.assertEqual(many["ranks"]["count"], ranks)
                sums.add(many["volume"])
            self.assertEqual(len(sums), 1, "the sum is exact")
            self.assertAlmostEqual(sums.pop() / plain["volume"], 1, delta=1e-14)

    def written(self, *arguments, ranks, tiles=2, box=()):
        """Compares the tables of cells that ranks write with those of one process, byte for byte."""
        for end in ("npy", "csv"):
            one, many = self.folder / ("one." + end), self.folder / ("many." + end)
            one_faces, many_faces = self.folder / "one-faces.csv", self.folder / "many-faces.csv"
            self.one(arguments[0], *arguments[1:], *box, "-o", one, "--faces", one_faces, command="voronoi")
            for faces in ((), ("--faces", many_faces)):
                self.mpi(ranks, *arguments, *box, "--tiles-per-rank", tiles, "-o", many, *faces, command="voronoi")
                self.assertEqual(one.read_bytes(), many.read_bytes(), (ranks, arguments))
            self.assertEqual(one_faces.read_bytes(), many_faces.read_bytes(), (ranks, arguments))
        self.assertEqual(self.names("many"), ["many-faces.csv", "many.csv", "many.npy"])

    def test_cells_are_written_as_by_one_process(self):
        self.written(self.generate("cube", 20000), ranks=3, box=["--box=0,0,0,1,1,1"])  # several blocks of the file a rank
        self.written(self.generate("clusters", 3000), "--weights-mod=-10", ranks=5, tiles=1)
        self.written(self.generate("grid", 700), ranks=8)  # all ranks in one block
        self.written(self.rows("few.xyz", [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]), ranks=5)

    def test_cells_of_many_files_are_numbered_as_one_input(self):
        rng = random.Random(9)
        rows = [[round(rng.gauss(0, 1), 2) for _ in range(3)] for _ in range(2000)]
        parts = [self.rows("%d.xyz" % i, rows[i * 500:i * 500 + 500]) for i in range(4)]
        for ranks in (3, 5):
            for end in ("npy", "csv"):
                self.one(self.rows("whole.xyz", rows), "-o", self.folder / ("a." + end), "--faces", self.folder / "f.csv",
                         command="voronoi")
                self.mpi(ranks, *parts, "-o", self.folder / ("b." + end), "--faces", self.folder / "g.csv", command="voronoi")
                for a, b in (("a." + end, "b." + end), ("f.csv", "g.csv")):
                    self.assertEqual((self.folder / a).read_bytes(), (self.folder / b).read_bytes(), (ranks, a))

    def test_an_older_table_is_whole_until_the_new_one_is(self):
        path, real, link = self.generate("cube", 900), self.folder / "real.npy", self.folder / "out.npy"
        link.symlink_to("real.npy")
        real.write_bytes(b"older")
        real.chmod(0o640)
        part = self.folder / "real.npy.part"
        part.write_text("no folder", encoding="ascii")
        self.fails(6, "real.npy.part: is in the way", path, "-o", link, command="voronoi")
        self.assertEqual(real.read_bytes(), b"older")
        part.unlink()
        part.mkdir()
        (part / "mine").write_text("", encoding="ascii")
        self.fails(6, "real.npy.part: is in the way", path, "-o", link, command="voronoi")
        (part / "mine").unlink()
        for name in (".brio-part", "0.rows"):  # what a killed job leaves
            (part / name).write_text("", encoding="ascii")
        self.one(path, "-o", self.folder / "one.npy", command="voronoi")
        self.mpi(3, path, "-o", link, command="voronoi")
        self.assertEqual(real.read_bytes(), (self.folder / "one.npy").read_bytes())
        self.assertEqual(real.stat().st_mode & 0o777, 0o640)
        self.assertTrue(link.is_symlink())
        self.assertEqual(self.names("real"), ["real.npy"])

    def surface(self, ranks, path, *options):
        """Compares the surface of ranks with that of one process, byte for byte."""
        one, many = self.folder / "one.ply", self.folder / "many.ply"
        line = [BRIO, "surface", str(path), *options, "-o", str(one), "--quiet"]
        subprocess.run(line, check=True)
        facts = self.mpi(ranks, path, *options, "-o", many, "--tiles-per-rank", 2, command="surface")
        self.assertEqual(one.read_bytes(), many.read_bytes(), (ranks, path, options))
        self.assertEqual(self.names("many"), ["many.ply"])
        return facts["ranks"]

    def test_surfaces_are_those_of_one_process(self):
        scan, sphere = self.generate("scan", 6000, "scan.ply"), self.generate("sphere", 1500, "sphere.ply")
        for ranks in (1, 2, 3, 5):
            done = self.surface(ranks, scan)
            self.assertEqual(done["count"], ranks)
            self.assertGreater(done["triangulations"], 0)
            self.assertEqual(done["part_bytes"] > 0, ranks > 1)  # cuts go to other ranks
            self.assertEqual(done["bytes"] > 0, ranks > 1)
        rng = random.Random(4)
        rows = [[rng.gauss(0, 1) for _ in range(3)] for _ in range(1200)]
        rows = [[c / sum(x * x for x in row) ** 0.5 + rng.gauss(0, 0.02) for c in row] for row in rows]
        noisy = self.rows("noisy.xyz", rows + rows[:300])  # some twice
        half = self.rows("half.xyz", [row for row in rows if row[2] > -0.2])
        for i, arguments in enumerate(((sphere,), (noisy,), (half,), (noisy, "--closed", "--noise", "keep"))):
            self.surface((2, 3, 5, 3)[i], *arguments)

    @unittest.skipUnless(LONG, "BRIO_LONG=1")
    def test_surfaces_of_every_set_for_every_number_of_ranks(self):
        rng = random.Random(5)
        sets = [self.generate(kind, points, kind + ".ply") for kind, points in (("scan", 40000), ("sphere", 3000),
                                                                                ("clusters", 5000))]
        for noise in (0.01, 0.05):
            rows = [[rng.gauss(0, 1) for _ in range(3)] for _ in range(6000)]
            rows = [[c / sum(x * x for x in row) ** 0.5 + rng.gauss(0, noise) for c in row] for row in rows]
            sets += [self.rows("noisy-%g.xyz" % noise, rows + rows[:900])]
            sets += [self.rows("open-%g.xyz" % noise, [row for row in rows if row[2] > -0.3 and abs(row[0]) > 0.2])]
        sets += [path for path in (self.thinned("scan/bunny_raw.ply", 4), self.thinned("scan/dragon_raw.ply", 8)) if path]
        for path in sets:
            for ranks in (1, 2, 3, 5, 8):
                self.surface(ranks, path)

    def test_wrong_calls_for_surfaces(self):
        path = self.generate("scan", 2000)
        plane = self.rows("plane.xyz", [[x, y, 4] for x in range(9) for y in range(9)])
        for code, text, *arguments in ((1, "ranks make surfaces by labeled-delaunay", path, "-o", "x.ply", "--method=cocone"),
                                       (1, "--polygons is for", path, "-o", "x.ply", "--polygons"),
                                       (1, "ranks show nothing", path, "--view", "x.html"),
                                       (1, "one argument too many", path, path, "-o", "x.ply"),
                                       (3, "bound no solid", plane, "-o", "x.ply")):
            result = self.mpi(2, *arguments, check=False, command="surface")
            self.assertIn(text, result.stderr)
            self.assertEqual(facts_of(result)["exit"], code, result.stderr)
            if code == 3:
                self.assertIn("plane.xyz: ", result.stderr)
                self.assertIn("--plane xy", " ".join(facts_of(result)["hints"]))

    def test_reports_of_ranks_had_no_warnings(self):
        path = self.rows("few.xyz", [[x % 5, x * 7 % 11, x * x % 13] for x in range(60)])
        said = [self.one(path, "-o", self.folder / "one.ply", command="surface"),
                self.mpi(2, path, "-o", self.folder / "one.ply", command="surface")]
        self.assertTrue(said[0]["warnings"])
        self.assertEqual(said[0]["warnings"], said[1]["warnings"])

    def test_a_report_stood_behind_a_surface_on_standard_output(self):
        path, one = self.generate("sphere", 300), self.folder / "one.ply"
        self.one(path, "-o", one, command="surface")
        line = self.line(2, path, "-o", "-", "--format", "ply", command="surface")[:-1]  # no JSON
        result = subprocess.run(line, capture_output=True, timeout=300, check=True)
        self.assertEqual(result.stdout, one.read_bytes())
        self.assertIn(b"triangulations", result.stderr)

    def test_wrong_calls_for_cells(self):
        path = self.generate("cube", 300)
        plane = self.rows("plane.xyz", [[x, y, 4] for x in range(9) for y in range(9)])
        for code, text, *arguments in ((1, "not x0,y0,z0", path, "--box=1"), (1, "write cells to .npy", path, "-o", "x.vtu"),
                                       (1, "write cells to .npy", path, "-o", "-"), (1, "side by side", path, "-o", "/dev/null",
                                        "--format=csv"),
                                       (1, "ranks show nothing", path, "--view", "x.html"),
                                       (1, "--compress", path, "-o", "x.npy", "--compress"),
                                       (1, "name the same file", path, "-o", "x.csv", "--faces", "x.csv"), (3, "in a plane", plane)):
            result = self.mpi(2, *arguments, check=False, command="voronoi")
            self.assertIn(text, result.stderr)
            self.assertEqual(facts_of(result)["exit"], code, result.stderr)

    def test_scans_and_lidar(self):
        files = [SHARED / "data" / name for name in ("lidar/csite4.ply", "scan/bunny_raw.ply")]
        files += [SHARED / "data" / name for name in ("lidar/autzen.ply", "lidar/room_scan1.ply")] if LONG else []
        there = [path for path in files if path.exists()]
        if not there:
            self.skipTest("no ../shared/data")
        for ranks, path in zip((3, 5, 2, 8), there):
            self.same(ranks, path)

    def thinned(self, name, every):
        """Every so many points of a file of ../shared/data, as text; None if it is not there."""
        path = SHARED / "data" / name
        if not path.exists():
            return None
        whole, out = self.folder / "whole.xyz", self.folder / (path.stem + ".xyz")
        subprocess.run([BRIO, "convert", str(path), str(whole), "--quiet"], check=True)
        lines = [line for line in whole.read_text(encoding="ascii").splitlines() if line[:1] in "-0123456789"]
        out.write_text("\n".join(lines[::every]) + "\n", encoding="ascii")
        return out

    @unittest.skipUnless(LONG, "BRIO_LONG=1")
    def test_every_set_for_every_number_of_ranks(self):
        rng = random.Random(12)
        sets = [(self.generate("cube", 100000, "cube.ply"),), (self.generate("clusters", 50000, "clusters.ply"),),
                (self.generate("scan", 50000, "scan.ply"),), (self.generate("grid", 30000, "grid.ply"),),
                (self.generate("sphere", 3000, "sphere.ply"),), (self.generate("cube", 50000, "w.ply"), "--weights-mod=-12"),
                (self.rows("ties.xyz", [[rng.randrange(9) for _ in range(3)] for _ in range(20000)]),),
                (self.rows("same.xyz", [[1, 2, 3]] * 20000),)]
        sets += [(path,) for path in (self.thinned("lidar/csite4.ply", 10), self.thinned("scan/bunny_raw.ply", 8)) if path]
        for arguments in sets:
            for ranks in (1, 2, 3, 5, 8):
                self.same(ranks, *arguments)
            if arguments[0].name not in ("same.xyz", "sphere.ply"):
                self.written(*arguments, ranks=3)

    def test_many_files_are_one_input(self):
        rng = random.Random(8)
        rows = [[round(rng.gauss(0, 1), 2) for _ in range(3)] for _ in range(3000)]
        whole = self.one(self.rows("whole.xyz", rows))
        parts = [self.rows("%d.xyz" % i, rows[i * 600:i * 600 + 600]) for i in range(5)]
        for ranks in (2, 5, 7):
            facts = self.mpi(ranks, *parts)
            self.assertEqual({k: whole[k] for k in SAME}, {k: facts[k] for k in SAME})

    def test_output_is_complete_and_names_the_input(self):
        path = self.generate("cube", 3000)
        out = self.folder / "out.pvtu"
        facts = self.mpi(3, path, "-o", out)
        index = out.read_text(encoding="utf-8")
        self.assertEqual(index.count("<Piece"), 12)
        self.assertEqual(sorted(os.listdir(self.folder / "out")), sorted("%d.vtu" % i for i in range(12)))
        self.assertEqual(sorted(path.name for path in self.folder.glob("out*")), ["out", "out.pvtu"])
        tetrahedra = 0
        for i in range(12):
            line = [BRIO, "info", str(self.folder / "out" / ("%d.vtu" % i)), "--json"]
            tetrahedra += json.loads(subprocess.run(line, capture_output=True, text=True, check=True).stdout)["tetrahedra"]
        self.assertEqual(tetrahedra, facts["tetrahedra"])

    def test_an_older_output_is_whole_until_the_new_one_is(self):
        out, small = self.folder / "out.pvtu", self.generate("cube", 500, "small.ply")
        self.mpi(2, small, "-o", out)
        before = {path.name: path.read_bytes() for path in [out, *(self.folder / "out").iterdir()]}
        (self.folder / "out.part").write_text("no folder", encoding="ascii")
        self.fails(6, "out.part: is in the way", self.generate("cube", 900), "-o", out)
        self.assertEqual(before, {path.name: path.read_bytes() for path in [out, *(self.folder / "out").iterdir()]})
        os.remove(self.folder / "out.part")
        (self.folder / "out.part").mkdir()
        for name in (".brio-part", "0.vtu", "5.vtu"):  # what a killed job leaves: ranks write side by side
            (self.folder / "out.part" / name).write_text("", encoding="ascii")
        self.mpi(3, self.folder / "a.ply", "-o", out)
        self.assertIn("Source=\"out-1/11.vtu\"", out.read_text(encoding="utf-8"))
        self.assertEqual(sorted(path.name for path in self.folder.glob("out*")), ["out-1", "out.pvtu"])
        self.fails(1, "--tiles writes .pvtu", small, "-o", self.folder / "out.ply")

    # --- hosts ---

    def test_hosts_that_are_network_namespaces(self):
        if os.geteuid() != 0 or os.environ.get("BRIO_MPI_HOSTS") == "0" or not shutil.which("ip"):
            self.skipTest("needs root, and ip")
        hosts = Hosts(self.folder, 3)
        try:
            hosts.make()
        except (OSError, subprocess.CalledProcessError) as error:
            self.skipTest("no network namespaces: %s" % error)
        try:
            self.same(6, self.generate("cube", 20000), launch=hosts.launch(2))
        finally:
            hosts.remove()


class Hosts:
    """Namespaces as hosts: a bridge, and for each a pair of devices and its own name of a host."""

    def __init__(self, folder, count):
        self.folder, self.count, self.tag = folder, count, "bm%d" % (os.getpid() % 1000)

    def name(self, i):
        return "%s-%d" % (self.tag, i)

    @staticmethod
    def ip(*words):
        subprocess.run(["ip", *words], check=True, capture_output=True)

    def make(self):
        self.ip("link", "add", self.tag, "type", "bridge")
        self.ip("addr", "add", "10.213.7.1/24", "dev", self.tag)
        self.ip("link", "set", self.tag, "up")
        for i in range(self.count):
            name = self.name(i)
            self.ip("netns", "add", name)
            self.ip("link", "add", "v" + name, "type", "veth", "peer", "name", "eth0", "netns", name)
            self.ip("link", "set", "v" + name, "master", self.tag, "up")
            self.ip("-n", name, "addr", "add", "10.213.7.%d/24" % (i + 10), "dev", "eth0")
            self.ip("-n", name, "link", "set", "eth0", "up")
            self.ip("-n", name, "link", "set", "lo", "up")
        agent = self.folder / "agent.sh"
        agent.write_text("#!/bin/sh\n# agent.sh [options] HOST COMMAND...: in place of ssh.\n"
                         "while [ \"${1#-}\" != \"$1\" ]; do shift; done\nhost=${1#*@}; shift\n"
                         "exec ip netns exec %s-$((${host##*.} - 10)) unshare --uts sh -c \"hostname host-${host##*.}; $*\"\n"
                         % self.tag, encoding="ascii")
        agent.chmod(0o755)

    def launch(self, ranks_each):
        hosts = ",".join("10.213.7.%d:%d" % (i + 10, ranks_each) for i in range(self.count))
        return ["--host", hosts, "--mca", "plm_rsh_agent", str(self.folder / "agent.sh"), "--mca", "oob_tcp_if_include",
                "10.213.7.0/24", "--mca", "btl_tcp_if_include", "10.213.7.0/24", "--mca", "btl", "self,tcp", "--mca",
                "orte_keep_fqdn_hostnames", "1"]

    def remove(self):
        for i in range(self.count):
            subprocess.run(["ip", "netns", "del", self.name(i)], check=False, capture_output=True)
        subprocess.run(["ip", "link", "del", self.tag], check=False, capture_output=True)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:], verbosity=1)
