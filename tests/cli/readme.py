"""The README shows the reports of the program as they are."""

import pathlib
import re

from brio_cli import CliTest, main

README = pathlib.Path(__file__).resolve().parents[2] / "README.md"
# What a run costs: different each time.
COSTS = ("seconds", "memory")


class Readme(CliTest):
    def test_the_commands_run_and_report_what_is_shown(self):
        shown = README.read_text(encoding="utf-8")
        commands = re.findall(r"(?m)^    \$ brio (.*)$", shown)
        kept = lambda lines: [line for line in lines.splitlines() if not line.startswith(COSTS)]
        reports = {commands[1]: "The second line reports", commands[2]: "and the third"}
        self.assertGreater(len(commands), 10)
        for command in commands:  # one after the other, as a reader types them
            if command not in reports:
                self.expect(0, *command.split(), "--quiet")
                continue
            block = re.search(reports[command] + r"\n\n```\n(.*?)```", shown, re.S).group(1)
            text = self.expect(0, *command.split()).text
            self.assertEqual(kept(block), kept(text))
            labels = [[line.split("  ")[0] for line in lines.splitlines()] for lines in (block, text)]
            self.assertEqual(*labels)


if __name__ == "__main__":
    main()
