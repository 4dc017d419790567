"""Readers are linear in the size of the file, whatever it has many of: memory by what the report counts, and, in the long part,
processor time."""

import json
import os
import resource
import subprocess
import unittest

from brio_cli import BRIO, CliTest, main
from counts import FAMILIES

LONG = os.environ.get("BRIO_LONG")
FEWER = 20  # of what takes a tenth of a second
FREE = 8 << 20  # bytes that any file may need: blocks of readers and writers
MOST_TIMES = 10  # of four times the count: 4 where time is linear, 16 where it goes with the square


class Counts(CliTest):
    def measured(self, name, n):
        """Bytes at the peak, seconds of processor time, and the size of the file."""
        _, file, make = FAMILIES[name]
        content = make(n)
        path = self.file(file, content)
        command = ["iso", path, "--level", "0.01", "--resolution", "16", "-o", self.path("o.ply")] if file.endswith(".pdb") else ["info", path]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        run = subprocess.run([BRIO, *command, "--threads", "1", "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.assertIn(run.returncode, (0, 2, 3), run.stderr)
        return (json.loads(run.stdout).get("peak_bytes", 0),
                after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, len(content))

    def test_memory(self):
        for name, (n, _, _) in FAMILIES.items():
            with self.subTest(name):
                few, _, _ = self.measured(name, n // FEWER)
                many, _, large = self.measured(name, 4 * (n // FEWER))
                self.assertLess(many, 5 * few + FREE)
                self.assertLess(many, 100 * large + FREE)

    @unittest.skipUnless(LONG, "skipped: in make check-all")
    def test_processor_time(self):
        for name, (n, _, _) in FAMILIES.items():
            with self.subTest(name):
                least = lambda count: min(self.measured(name, count)[1] for _ in range(3))
                few, many = least(n), least(4 * n)
                self.assertLess(many, MOST_TIMES * few + 0.1)


if __name__ == "__main__":
    main()
