"""test_mpi.py BUILD: brio-mpi against brio, oversubscribed on this machine: equal reports for every number of ranks, output,
failures of one rank, a rank that is killed, a run that goes on, and hosts that are network namespaces.

BRIO_LONG=1 adds the larger inputs; BRIO_MPI_HOSTS=0 leaves out the namespaces, which need root."""

import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

BUILD = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build-mpi").resolve()
BRIO, MPI = str(BUILD / "brio"), str(BUILD / "brio-mpi")
SHARED = pathlib.Path(os.environ.get("BRIO_SHARED", pathlib.Path(__file__).resolve().parents[2] / "../shared")).resolve()
SAME = "points vertices duplicates hidden dimension tetrahedra hull_facets checksum weighted".split()
LONG = os.environ.get("BRIO_LONG") == "1"
MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none"]


def facts_of(result):
    return json.loads(result.stdout[result.stdout.index("{"):result.stdout.rindex("}") + 1])


class Mpi(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="brio-mpi-test-"))
        self.scratch = self.folder / "scratch"
        self.scratch.mkdir()

    def tearDown(self):
        shutil.rmtree(self.folder, ignore_errors=True)

    def mpi(self, ranks, *arguments, launch=(), check=True, command="delaunay"):
        line = [*MPIRUN, *launch, "-n", str(ranks), MPI, command, *map(str, arguments), "--scratch", str(self.scratch),
                "--json"]
        result = subprocess.run(line, capture_output=True, text=True, timeout=300, check=False)
        if check:
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(os.listdir(self.scratch), [])
            return facts_of(result)
        return result

    def one(self, *arguments, command="delaunay"):
        line = [BRIO, command, *map(str, arguments), "--json"]
        return json.loads(subprocess.run(line, capture_output=True, text=True, check=True).stdout)

    def same(self, ranks, *arguments, tiles=2, launch=()):
        plain = self.one(*arguments)
        many = self.mpi(ranks, *arguments, "--tiles-per-rank", tiles, launch=launch)
        self.assertEqual({k: plain[k] for k in SAME}, {k: many[k] for k in SAME}, (ranks, arguments))
        return many

    def generate(self, kind, points, name="a.ply"):
        path = self.folder / name
        subprocess.run([BRIO, "generate", kind, "--points", str(points), "-o", str(path), "--quiet"], check=True)
        return path

    def rows(self, name, rows):
        path = self.folder / name
        path.write_text("\n".join(" ".join(map(str, row)) for row in rows) + "\n", encoding="ascii")
        return path

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

    def test_wrong_calls_for_cells(self):
        path = self.generate("cube", 300)
        plane = self.rows("plane.xyz", [[x, y, 4] for x in range(9) for y in range(9)])
        for code, text, *arguments in ((1, "not x0,y0,z0", path, "--box=1"), (1, "not written", path, "-o", "x.npy"),
                                       (3, "in a plane", plane)):
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

    # --- failures ---

    def fails(self, code, words, *arguments, ranks=3):
        result = self.mpi(ranks, *arguments, check=False)
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertIn(words, result.stderr)
        self.assertEqual(facts_of(result)["exit"], code)
        return result

    def test_a_bad_point_names_its_rank(self):
        rows = [[i, i * i % 7, i % 5] for i in range(1000)]
        good = self.rows("good.xyz", rows)
        bad = self.rows("bad.xyz", rows[:500] + [["nan", 0, 0]])
        result = self.fails(2, "rank 1 on ", good, bad, ranks=2)
        self.assertIn("bad.xyz", result.stderr)
        self.assertEqual(os.listdir(self.scratch), [])

    def test_too_little_memory_and_no_folder(self):
        path = self.generate("cube", 30000)
        out = self.folder / "out.pvtu"
        self.fails(4, "rank ", path, "--max-memory", "6M", "-o", out)
        self.assertFalse(out.exists() or (self.folder / "out").exists() or (self.folder / "out.part").exists())
        shutil.rmtree(self.scratch)
        self.scratch.mkdir()
        self.assertEqual(self.same(3, path)["resumed"], 0)

    def test_a_rank_is_killed_and_the_next_run_goes_on(self):
        path = self.generate("cube", 150000)
        line = [*MPIRUN, "-n", "3", MPI, "delaunay", str(path), "--scratch", str(self.scratch), "--tiles-per-rank", "6",
                "--json"]
        job = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        end = time.monotonic() + 120
        while time.monotonic() < end and not list(self.scratch.glob("*/tile-1")):
            time.sleep(0.02)
        ranks = subprocess.run(["ps", "--ppid", str(job.pid), "-o", "pid="], capture_output=True, text=True, check=True)
        os.kill(int(ranks.stdout.split()[1]), signal.SIGKILL)
        _, errors = job.communicate(timeout=120)
        self.assertNotEqual(job.returncode, 0)
        self.assertIn("exited on signal 9", errors)
        facts = self.same(3, path, tiles=6)
        self.assertGreater(facts["resumed"], 0)

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
