"""Memory: limits, estimates, what the system refuses, scratch files."""

import contextlib
import json
import os
import resource
import subprocess

from brio_cli import BRIO, CliTest, CUBE, main


class Memory(CliTest):
    def test_sizes_in_each_unit(self):
        points = self.xyz("a.xyz", CUBE * 100)
        for size, code in [("1K", 4), ("1KiB", 4), ("0.001M", 4), ("100000kb", 0), ("1g", 0), ("1.5GiB", 0),
                           ("2e9", 0)]:
            self.expect(code, "delaunay", points, "--max-memory", size)

    def test_limit_of_one_kilobyte(self):
        points = self.xyz("a.xyz", CUBE)
        for arguments in [("delaunay", points), ("surface", points, "-o", "x.ply"), ("info", points),
                          ("generate", "cube", "-n", "1000", "-o", "x.xyz")]:
            self.expect(4, *arguments, "--max-memory", "1K")
        self.assert_only(self.folder, "a.xyz")

    def test_estimate_over_the_limit_is_refused_before_the_start(self):
        points = self.cloud("a.ply", 200000)
        run = self.expect(4, "delaunay", points, "--max-memory", "20M")
        self.assertRegex(run.err, "about .* needed")  # the sentence of the estimate; on the way there are others

    def assert_estimated(self, estimate, *arguments):
        peak = self.facts(*arguments)["peak_bytes"]
        self.assertLess(abs(estimate - peak), 0.15 * peak, arguments)

    def test_estimates_are_within_15_per_cent_of_the_peak(self):
        if self.facts("generate", "cube", "-n", "10")["peak_bytes"] > 12 << 20:
            self.skipTest("this build takes memory for itself")
        for kind in ["cube", "scan", "grid", "sphere", "torus"]:
            points = self.cloud(f"{kind}.ply", 60000, kind)
            for threads in ["1", "2"]:
                estimates = self.facts("info", points, "--threads", threads)["estimate_bytes"]
                self.assert_estimated(estimates["delaunay"], "delaunay", points, "--threads", threads)
        surface = self.path("surface.ply")
        points = self.cloud("few.ply", 20000, "scan")
        self.assert_estimated(self.facts("info", points)["estimate_bytes"]["surface"], "surface", points, "-o", surface)
        explained = self.facts("surface", points, "-o", surface, "--explain", "--view", self.path("v.html"))["peak_bytes"]
        self.assertLess(explained, 1.15 * self.facts("info", points)["estimate_bytes"]["explained"])  # which adds what is not needed at once
        self.assert_estimated(self.facts("info", points)["estimate_bytes"]["medial"], "medial", points)
        self.assert_estimated(self.facts("info", points)["estimate_bytes"]["offset"], "offset", points, "-o", surface,
                              "--distance", "0.01")
        self.facts("surface", points, "-o", surface, "--method", "cocone")
        self.assert_estimated(self.facts("info", surface)["estimate_bytes"]["subdivide"],
                              "subdivide", surface, "-o", self.path("fine.ply"))

    def test_limit_between_two_estimates(self):
        """Weights that hide most points take less memory: the estimate knows."""
        points = self.cloud("a.ply", 60000)
        self.expect(4, "delaunay", points, "--max-memory", "18M")
        self.facts("delaunay", points, "--max-memory", "18M", "--weights-mod", "-3")

    def test_memory_that_the_system_refuses(self):
        points = self.cloud("a.ply", 200000)

        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (40 << 20, 40 << 20))

        if self.run_brio("--version", preexec_fn=limit).code:
            self.skipTest("this build does not start in 40 MB of address space")
        self.expect(4, "delaunay", points, "--threads", "1", "-o", self.path("x.vtu"), preexec_fn=limit)
        self.assert_only(self.folder, "a.ply")

    def test_scratch_folder_takes_the_big_arrays(self):
        points = self.cloud("a.ply", 50000)
        os.mkdir(self.path("scratch"))
        plain = self.facts("delaunay", points)
        mapped = self.facts("delaunay", points, "--scratch", self.path("scratch"))
        self.assertEqual(plain["checksum"], mapped["checksum"])
        self.assert_only(self.path("scratch"))

    def cut_scratch_files(self, process, folder):
        """Cuts what the process has open in the folder, which has no name there; how many files that were."""
        cut = 0
        for name in os.listdir("/proc/%d/fd" % process.pid):
            path = "/proc/%d/fd/%s" % (process.pid, name)
            with contextlib.suppress(OSError):
                if os.readlink(path).startswith(folder):
                    os.truncate(path, 0)
                    cut += 1
        return cut

    def test_scratch_file_that_is_cut_ends_the_run_with_a_message(self):
        """It was the end of the process by SIGBUS; then two threads said it in each other's words."""
        points, folder = self.cloud("a.ply", 200000), os.path.realpath(self.folder)
        os.mkdir(self.path("scratch"))
        for extra in [], ["--json"], ["--threads", "1"]:
            process = subprocess.Popen([BRIO, "delaunay", points, "-o", "out.vtu", "--scratch", "scratch", "--progress", *extra],
                                       cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            for line in process.stderr:
                if line.startswith(b"insert"):
                    break
            cut = self.cut_scratch_files(process, os.path.join(folder, "scratch"))
            out, err = process.communicate(timeout=120)
            self.assertGreater(cut, 0)
            self.assertEqual(process.returncode, 4, err)
            self.assertRegex(err.decode(), r"brio: scratch: a scratch file was cut from outside")
            self.assertEqual(err.count(b"cut from outside"), 1, err)
            if extra == ["--json"]:
                self.assertEqual(json.loads(out)["exit"], 4)
            self.assert_only(self.folder, "a.ply", "scratch")
            self.assert_only(self.path("scratch"))

    def test_scratch_folder_that_is_missing(self):
        self.expect(2, "delaunay", self.xyz("a.xyz", CUBE), "--scratch", self.path("missing"))


if __name__ == "__main__":
    main()
