"""Every command has long runs, at which moments.py measures how soon a signal ends them. Here the table is held against the
list of commands; in make check-all each line of it is tried on small inputs, too."""

import os
import re
import subprocess
import unittest

from brio_cli import BRIO, CliTest, main
from long_runs import RUNS, Inputs


class Moments(CliTest):
    def test_every_command_has_long_runs(self):
        text = subprocess.run([BRIO, "help"], stdout=subprocess.PIPE, check=True).stdout.decode()
        commands = set(re.findall(r"(?m)^  ([a-z]+)  +\S", text.split("\nhelp:")[0]))
        self.assertGreater(len(commands), 10)
        self.assertEqual(commands, set(RUNS))

    @unittest.skipUnless(os.environ.get("BRIO_LONG"), "skipped: in make check-all")
    def test_the_lines_run(self):
        inputs = Inputs(self.folder, 0.002)
        for templates in RUNS.values():
            for template in templates:
                with self.subTest(template):
                    run = self.run_brio(*inputs.line(template), "--quiet")
                    self.assertIn(run.code, (0, 3, 5), run.err)  # few points may have no surface


if __name__ == "__main__":
    main()
