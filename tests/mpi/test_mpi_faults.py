"""test_mpi_faults.py BUILD: jobs of brio-mpi that fail. One sentence ends all ranks, nothing is half-written, and the same command
goes on to the same result.

BRIO_LONG=1 kills 50 jobs instead of 5, interrupts 72 instead of 9, and starves a rank of memory at more places."""

import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest

from mpi_case import LONG, MPI, MPIRUN, MpiCase, facts_of


NO_SHARED_MEMORY = ["--mca", "btl", "self,tcp"]  # Open MPI itself waits for ever where it can map none


class Faults(MpiCase):
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
        os.kill(self.ranks_of(job)[1], signal.SIGKILL)
        self.wait_for_end(job)
        self.assertNotEqual(job.returncode, 0)
        facts = self.same(3, path, tiles=6)
        self.assertGreater(facts["resumed"], 0)

    # --- one rank that fails ---

    def of_rank(self, rank, words):
        """Starts a rank by a shell that does something first."""
        return ["sh", "-c", 'if [ "$OMPI_COMM_WORLD_RANK" = %d ]; then %s; fi; exec "$@"' % (rank, words), "sh", MPI]

    def goes_on(self, one, out, *arguments, command="voronoi"):
        """Runs the same command without the fault: the bytes are those of one process, and nothing else is left."""
        self.mpi(3, *arguments, "-o", out, command=command)
        self.assertEqual(out.read_bytes(), one.read_bytes())
        self.assertEqual(self.names("out"), [out.name])

    def starved(self, words, code, texts):
        """Whether the job failed of rank 1, whose limits `words` lower; nothing of an output is left then."""
        out = self.folder / "out.npy"
        result = self.mpi(3, self.path, "-o", out, command="voronoi", check=False, launch=NO_SHARED_MEMORY,
                          program=self.of_rank(1, words))
        if result.returncode == 0:
            out.unlink()
            return False
        self.assertEqual(result.returncode, code, (words, result.stderr))
        self.assertIn("brio-mpi: rank 1 on ", result.stderr)
        self.assertTrue(any(text in result.stderr for text in texts), (words, result.stderr))
        self.assertEqual(self.names("out"), [], words)
        return True

    def least_memory(self):
        """The kilobytes of address space with which MPI begins, in steps of 5,000."""
        for limit in range(40000, 1000000, 5000):
            line = [*MPIRUN, *NO_SHARED_MEMORY, "-n", "1", *self.of_rank(0, "ulimit -v %d" % limit), "--help"]
            if not subprocess.run(line, capture_output=True, check=False).returncode:
                return limit + 5000
        return self.skipTest("MPI begins with no limit")

    def test_one_rank_without_memory_ends_all(self):
        self.path, one = self.generate("cube", 60000), self.folder / "one.npy"
        self.one(self.path, "-o", one, command="voronoi")
        least = self.least_memory()
        limits = range(least, least + 50000, 2500) if LONG else (least + 5000, least + 15000, least + 25000)
        failed = sum(self.starved("ulimit -v %d" % limit, 4, ("memory",)) for limit in limits)
        self.assertGreaterEqual(failed, len(limits) // 3)
        self.goes_on(one, self.folder / "out.npy", self.path)

    def test_one_rank_whose_files_may_not_grow_ends_all(self):
        self.path, one = self.generate("cube", 60000), self.folder / "one.npy"
        self.one(self.path, "-o", one, command="voronoi")
        limits = range(200, 6000, 400) if LONG else (400, 2000)  # blocks of 512 bytes
        failed = sum(self.starved("ulimit -f %d" % limit, 6, ("File too large",)) for limit in limits)
        self.assertGreaterEqual(failed, len(limits) // 2)
        self.goes_on(one, self.folder / "out.npy", self.path)

    def test_a_full_disk_of_one_rank_or_of_the_output_ends_all(self):
        disk = self.folder / "disk"
        disk.mkdir()
        if os.geteuid() or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1500k", "none", str(disk)], check=False,
                                          capture_output=True).returncode:
            self.skipTest("no disk of this size")
        try:
            path, out = self.generate("cube", 60000), disk / "out.npy"
            out.write_bytes(b"older")
            for output in (("-o", out), ("--faces", disk / "out.csv")):
                result = self.fails(6, "No space left on device", path, *output, command="voronoi")
                self.assertIn("out.", result.stderr)
                self.assertEqual(os.listdir(disk), ["out.npy"])
                self.assertEqual(out.read_bytes(), b"older")
            self.fails(6, "No space left on device", path, "-o", disk / "out.pvtu")
            self.assertEqual(os.listdir(disk), ["out.npy"])
            # the scratch folder of rank 1 alone is on it
            program = self.of_rank(1, 'set -- $(echo "$@" | sed "s|--scratch [^ ]*|--scratch %s|")' % disk)
            result = self.fails(6, "rank 1 on ", path, "-o", self.folder / "out.npy", command="voronoi", program=program)
            self.assertRegex(result.stderr, "No space left on device|has room for")
            self.assertEqual(self.names("out"), [])
        finally:
            subprocess.run(["umount", str(disk)], check=False)

    def test_a_file_that_is_bad_in_its_middle_names_its_rank(self):
        good, bad, out = self.generate("cube", 20000, "a.laz"), self.generate("cube", 20000, "b.laz"), self.folder / "out.npy"
        whole = bad.read_bytes()
        bad.write_bytes(whole[:len(whole) // 2])
        result = self.fails(2, "rank 1 on ", good, bad, "-o", out, ranks=2, command="voronoi")
        self.assertIn("b.laz", result.stderr)
        self.assertEqual((self.names("out"), os.listdir(self.scratch)), ([], []))
        result = self.fails(2, "rank 0 on ", bad, "-o", out, command="voronoi")  # all ranks read it together
        self.assertEqual((self.names("out"), os.listdir(self.scratch)), ([], []))
        bad.write_bytes(whole)
        one = self.folder / "one.npy"
        self.one(bad, "-o", one, command="voronoi")
        self.goes_on(one, out, bad)

    def test_one_host_without_the_scratch_folder_ends_all(self):
        program = self.of_rank(1, 'set -- $(echo "$@" | sed "s|--scratch [^ ]*|--scratch /nowhere|")')
        self.fails(2, "rank 1 on ", self.generate("cube", 500), program=program)

    # --- surfaces ---

    def test_a_surface_that_fails_on_one_rank_ends_all(self):
        path, one, out = self.generate("scan", 8000), self.folder / "one.ply", self.folder / "out.ply"
        self.one(path, "-o", one, command="surface")
        bad = self.rows("bad.xyz", [[0, 0, 0], [1, 2, 3], ["nan", 0, 0]])
        self.fails(2, "bad.xyz", bad, "-o", out, command="surface")
        poor = self.of_rank(1, 'set -- "$@" --max-memory 4M')
        self.fails(4, "rank 1 on ", path, "-o", out, command="surface", program=poor)
        nowhere = self.of_rank(2, 'set -- $(echo "$@" | sed "s|--scratch [^ ]*|--scratch /nowhere|")')
        self.fails(2, "rank 2 on ", path, "-o", out, command="surface", program=nowhere)
        self.assertEqual((self.names("out"), os.listdir(self.scratch)), ([], []))
        self.goes_on(one, out, path, command="surface")

    def test_a_full_disk_of_a_surface_ends_all(self):
        disk = self.folder / "disk"
        disk.mkdir()
        if os.geteuid() or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=600k", "none", str(disk)], check=False,
                                          capture_output=True).returncode:
            self.skipTest("no disk of this size")
        try:
            path, out = self.generate("scan", 20000), disk / "out.ply"
            out.write_bytes(b"older")
            self.fails(6, "No space left on device", path, "-o", out, command="surface")
            self.assertEqual((os.listdir(disk), out.read_bytes()), (["out.ply"], b"older"))
            for rank in (0, 1):  # the scratch folder of this rank alone is on it
                program = self.of_rank(rank, 'set -- $(echo "$@" | sed "s|--scratch [^ ]*|--scratch %s|")' % disk)
                result = self.mpi(3, path, "-o", self.folder / "out.ply", check=False, command="surface", program=program)
                self.assertIn(result.returncode, (4, 6), result.stderr)
                self.assertIn("rank %d on " % rank, result.stderr)
                self.assertEqual((self.names("out"), os.listdir(disk)), ([], ["out.ply"]))
        finally:
            subprocess.run(["umount", str(disk)], check=False)

    def test_a_surface_that_is_killed_leaves_the_older_output(self):
        path, out, rng = self.generate("scan", 20000), self.folder / "out.ply", random.Random(7)
        start = time.monotonic()
        self.mpi(3, path, "-o", out, command="surface")
        whole, expected, ended = time.monotonic() - start, out.read_bytes(), 0
        for _ in range(12 if LONG else 3):
            ended += self.kill(self.line(3, path, "-o", out, command="surface"), rng.uniform(0, whole), rng)
            self.assertEqual(out.read_bytes(), expected)
        self.assertGreater(ended, 0)
        self.mpi(3, path, "-o", out, command="surface", check=False)
        self.assertEqual(out.read_bytes(), expected)

    def test_a_rank_without_any_memory_ends_all(self):
        # it had no room to say so, and the others waited for ever
        path = self.generate("scan", 800)
        for command, output, rank, memory in (("surface", "out.ply", 0, 10), ("surface", "out.ply", 1, 10),
                                              ("surface", "out.ply", 1, 2200), ("delaunay", "out.pvtu", 1, 10)):
            poor = self.of_rank(rank, 'set -- "$@" --max-memory %d' % memory)
            result = self.fails(4, "brio-mpi: rank %d on " % rank, path, "-o", self.folder / output, command=command, program=poor)
            self.assertEqual(len(re.findall(r"rank \d on ", result.stderr)), 1, result.stderr)
        self.assertEqual((self.names("out"), os.listdir(self.scratch)), ([], []))

    def test_one_rank_with_another_command_line_ends_all(self):
        path = self.generate("cube", 300)
        self.fails(1, "rank 1 on ", path, program=self.of_rank(1, 'set -- "$@" --nothing'))
        self.mpi(3, path, program=self.of_rank(1, 'set -- "$@" --threads 1'))

    # --- ranks that are interrupted ---

    def wait_until_they_catch(self, job, ranks):
        """Waits until all ranks of a job have their handler of SIGINT. Returns their processes in order, or those that are left."""
        end = time.monotonic() + 60
        while job.poll() is None and time.monotonic() < end:
            found = self.ranks_of(job)
            try:
                caught = [int(line.split()[1], 16) for pid in found
                          for line in pathlib.Path("/proc/%d/status" % pid).read_text(encoding="ascii").splitlines()
                          if line.startswith("SigCgt")]
            except OSError:
                continue
            if len(caught) == ranks and all(mask >> (signal.SIGINT - 1) & 1 for mask in caught):
                return found
            time.sleep(0.005)
        return []

    def interrupt(self, line, ranks, share, whole, which):
        """Runs a job, and interrupts mpirun (`which` is None) or a rank after this share of its time. Returns what it says."""
        with subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as job:
            start = time.monotonic()
            pids = self.wait_until_they_catch(job, ranks)
            time.sleep(max(0, share * (whole - (time.monotonic() - start))))
            try:
                os.kill(pids[which] if pids and which is not None else job.pid, signal.SIGINT)
            except ProcessLookupError:
                pass
            out, errors = job.communicate(timeout=60)
            return subprocess.CompletedProcess(line, job.returncode, out, errors)

    def interrupted(self, command, path, out, keeps):
        """Interrupts jobs at some moments: each ends with one sentence and nothing of an output, or was complete."""
        line, rng = self.line(3, path, "-o", out, command=command), random.Random(command)
        start = time.monotonic()
        subprocess.run(line, check=True, capture_output=True)
        whole, count = time.monotonic() - start, 0
        for which in (None, 0, 1, 2) * 6 if LONG else (None, 0, 1):
            for path in self.folder.glob(out.stem + "*"):
                shutil.rmtree(path) if path.is_dir() else path.unlink()
            result = self.interrupt(line, 3, rng.uniform(0, 0.9), whole, which)
            facts = facts_of(result)
            count += "error" in facts
            if "error" in facts:
                self.assertEqual((facts["error"], facts["exit"]), ("interrupted", 130), result.stderr)
                said = [row for row in result.stderr.splitlines() if row.startswith("brio-mpi:")]
                self.assertEqual(said, ["brio-mpi: interrupted"])
                self.assertEqual(self.names(out.stem), [], (command, which))
            self.assertTrue(keeps or not os.listdir(self.scratch), (command, which, result.stderr))
        self.assertGreater(count, 0)

    def test_jobs_that_are_interrupted_end_with_one_sentence(self):
        # they said "the exchange with other ranks failed", and each rank its own
        self.interrupted("surface", self.generate("scan", 16000, "scan.ply"), self.folder / "out.ply", False)
        cube = self.generate("cube", 60000, "cube.ply")
        self.interrupted("delaunay", cube, self.folder / "out.pvtu", True)
        self.interrupted("voronoi", cube, self.folder / "out.npy", True)

    # --- ranks that are killed ---

    def ranks_of(self, job):
        found = subprocess.run(["ps", "--ppid", str(job.pid), "-o", "pid=,stat="], capture_output=True, text=True, check=False)
        return [int(line.split()[0]) for line in found.stdout.splitlines() if not line.split()[1].startswith("Z")]

    def wait_for_end(self, job):
        """Waits for a job of which a rank was killed: no other rank goes on. The mpirun of Open MPI 4.1 may wait for itself
        then, for ever, in PMIx_server_finalize: it is ended here."""
        try:
            job.communicate(timeout=30)
        except subprocess.TimeoutExpired:
            self.assertEqual(self.ranks_of(job), [])
            job.kill()
            job.communicate()

    def kill(self, line, moment, rng):
        """Starts a job, and kills a rank, or all, after so many seconds. Returns whether it was ended so."""
        with subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as job:
            time.sleep(moment)
            ranks = self.ranks_of(job)
            for pid in ranks if rng.random() < 0.3 else rng.sample(ranks, min(len(ranks), 1)):
                try:
                    os.kill(pid, signal.SIGKILL)
                except ProcessLookupError:
                    pass
            self.wait_for_end(job)
            return job.returncode != 0

    def test_jobs_that_are_killed_at_any_moment_leave_nothing_half_written(self):
        path, rng = self.generate("cube", 40000), random.Random(2026)
        kinds = [("voronoi", "npy", ("--faces", self.folder / "out.faces.csv")), ("voronoi", "csv", ()), ("delaunay", "pvtu", ())]
        for command, end, more in kinds:
            with self.subTest(command=command, end=end):
                self.killed(path, command, self.folder / ("out." + end), more, rng)

    def tables(self, out, more):
        """The bytes of an output. Of an index and its files their number and all their names."""
        if out.suffix == ".pvtu":
            index = out.read_text(encoding="utf-8")
            folder = self.folder / index.split('Source="')[1].split("/")[0]
            self.assertEqual(sorted(os.listdir(folder)), sorted("%d.vtu" % i for i in range(index.count("<Piece"))))
            return sorted(path.read_bytes() for path in folder.iterdir())
        return [path.read_bytes() for path in (out, *more[1:])]

    def killed(self, path, command, out, more, rng):
        arguments = (path, "-o", out, *more)
        start = time.monotonic()
        facts = self.mpi(3, *arguments, command=command)
        whole, expected, ended = time.monotonic() - start, self.tables(out, more), 0
        for _ in range(17 if LONG else 2):
            ended += self.kill(self.line(3, *arguments, command=command), rng.uniform(0, whole), rng)
            self.assertEqual(self.tables(out, more), expected)  # the older output
            if rng.random() < 0.5:
                continue  # the next job is killed, too, as it goes on
            again = self.mpi(3, *arguments, command=command)
            self.assertEqual(self.tables(out, more), expected)
            self.assertEqual(again.get("checksum"), facts.get("checksum"))
        again = self.mpi(3, *arguments, command=command)
        self.assertEqual((again.get("checksum"), again.get("volume")), (facts.get("checksum"), facts.get("volume")))
        self.assertGreater(ended, 0)
        left = [name for name in self.names("out") if name.startswith(out.name) or name.startswith("out-") or name == "out"]
        self.assertEqual([name for name in left if "part" in name], [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:], verbosity=1)
