"""Signals: a run ends soon, with its status, and leaves no half of a file."""

import contextlib
import json
import os
import shutil
import signal
import subprocess
import threading
import time

from brio_cli import BRIO, CliTest, CUBE, main


class Interrupt(CliTest):
    def start(self, *arguments, **how):
        process = subprocess.Popen([BRIO, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   cwd=self.folder, **how)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.kill)
        return process

    def wait_for_stage(self, process, stages):
        """Reads the progress until one of the stages shows; False when the run ended before."""
        for line in process.stderr:
            if any(line.decode().startswith(stage) for stage in stages):
                return True
        return False

    def interrupted(self, number, stages, *arguments):
        process = self.start(*arguments, "--progress")
        shown = self.wait_for_stage(process, stages)
        process.send_signal(number)
        drain = threading.Thread(target=process.stdout.read)
        drain.start()
        process.stderr.read()
        drain.join()
        return process.wait(timeout=60), shown

    def test_signals_in_a_big_run(self):
        points = self.cloud("a.ply", 400000)
        for number in [signal.SIGINT, signal.SIGTERM]:
            code, shown = self.interrupted(number, ["insert", "order"], "delaunay", points, "-o", self.path("out.vtu"))
            self.assertTrue(shown, "the run showed no stage of the triangulation")
            self.assertEqual(code, 130)
            self.assert_only(self.folder, "a.ply")

    def test_signal_while_the_file_is_written(self):
        points = self.cloud("a.ply", 100000)
        code, _ = self.interrupted(signal.SIGINT, ["write"], "delaunay", points, "--ascii", "-o", self.path("out.vtu"))
        self.assertIn(code, [0, 130])  # 0 when the file was complete before the signal came
        self.assert_only(self.folder, "a.ply", *(["out.vtu"] if code == 0 else []))

    def test_end_that_nothing_can_catch_leaves_no_file(self):
        """A file of a temporary name stayed behind."""
        try:
            os.close(os.open(self.folder, os.O_TMPFILE | os.O_WRONLY))
        except OSError as error:
            self.skipTest("the file system has no files without names: %s" % error)
        points = self.cloud("a.ply", 100000)
        code, shown = self.interrupted(signal.SIGKILL, ["write"], "delaunay", points, "--ascii", "-o", self.path("out.vtu"))
        self.assertTrue(shown and code in [0, -signal.SIGKILL], code)
        self.assert_only(self.folder, "a.ply", *(["out.vtu"] if code == 0 else []))

    def test_signal_while_standard_input_waits(self):
        process = self.start("delaunay", "-", "--input-format", "xyz", "-o", self.path("out.vtu"),
                             stdin=subprocess.PIPE)
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        try:
            self.assertEqual(process.wait(timeout=10), 130)
        finally:
            process.stdin.close()
        self.assert_only(self.folder)

    def expect_interruption(self, process):
        """One signal must end a run that waits."""
        time.sleep(0.5)
        self.assertIsNone(process.poll(), "the run did not wait")
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=10), 130)

    def fifo(self, name, other_side):
        """A FIFO whose other side is not there, or is there and stalls."""
        os.mkfifo(self.path(name))
        if other_side:
            file = os.open(self.path(name), os.O_RDWR | os.O_NONBLOCK)
            self.addCleanup(os.close, file)
        return self.path(name)

    def test_output_fifo_that_nobody_reads_ignored_signals(self):
        points = self.cloud("a.ply", 20000)
        for name in ["alone.ply", "stalled.ply"]:
            fifo = self.fifo(name, other_side=name == "stalled.ply")
            self.expect_interruption(self.start("delaunay", points, "-o", fifo, "--quiet"))
        self.assert_only(self.folder, "a.ply", "alone.ply", "stalled.ply")

    def test_standard_output_that_nobody_reads(self):
        points = self.cloud("a.ply", 20000)
        self.expect_interruption(self.start("delaunay", points, "-o", "-", "--format", "ply"))

    def test_report_that_nobody_reads(self):
        fifo = os.open(self.fifo("out", other_side=True), os.O_WRONLY)
        self.addCleanup(os.close, fifo)
        with contextlib.suppress(BlockingIOError):
            os.set_blocking(fifo, False)
            while True:
                os.write(fifo, b"full" * 1024)
        os.set_blocking(fifo, True)
        process = subprocess.Popen([BRIO, "info", self.xyz("a.xyz", CUBE), "--json"], stdout=fifo)
        self.addCleanup(process.kill)
        self.expect_interruption(process)

    def test_input_fifo_that_nobody_writes(self):
        for name in ["alone.ply", "stalled.ply"]:
            fifo = self.fifo(name, other_side=name == "stalled.ply")
            self.expect_interruption(self.start("delaunay", fifo, "-o", self.path("out.vtu")))
            self.expect_interruption(self.start("delaunay", self.xyz("a.xyz", CUBE), "--weights", fifo))
        self.assert_only(self.folder, "a.xyz", "alone.ply", "stalled.ply")

    def test_fifos_carry_points(self):
        points, a, b = self.cloud("a.ply", 20000), self.fifo("a.fifo", False), self.fifo("b.fifo", False)
        first = self.start("delaunay", a, "--input-format", "ply", "-o", b, "--format", "ply")
        last = self.start("check", b, "--input-format", "ply")
        with open(points, "rb") as source, open(a, "wb") as sink:
            shutil.copyfileobj(source, sink)
        self.assertEqual((first.wait(timeout=60), last.wait(timeout=60)), (0, 0))

    def test_signals_that_the_caller_ignored_stay_ignored(self):
        """A script's `brio ... &` ended at the Ctrl-C that was meant for another program."""
        for number in signal.SIGINT, signal.SIGTERM, signal.SIGHUP:
            process = self.start("delaunay", "-", "--input-format", "xyz", "--quiet", stdin=subprocess.PIPE,
                                 preexec_fn=lambda: signal.signal(number, signal.SIG_IGN))
            time.sleep(0.3)
            process.send_signal(number)
            time.sleep(0.2)
            process.stdin.write(b"".join(b"%d %d %d\n" % point for point in CUBE))
            process.stdin.close()
            self.assertEqual(process.wait(timeout=30), 0, number)

    def test_json_of_an_interrupted_run(self):
        process = self.start("delaunay", self.cloud("a.ply", 400000), "--json", "--progress")
        self.assertTrue(self.wait_for_stage(process, ["insert", "order"]))
        process.send_signal(signal.SIGINT)
        process.stderr.read()
        facts = json.loads(process.stdout.read())
        self.assertEqual((process.wait(), facts["exit"]), (130, 130))


if __name__ == "__main__":
    main()
