"""The README shows the reports of the program as they are."""

import pathlib
import re

from brio_cli import CliTest, main

README = pathlib.Path(__file__).resolve().parents[2] / "README.md"
# What a run costs: different each time.
COSTS = ("seconds", "memory")


class Readme(CliTest):
    def test_the_readme_shows_the_reports(self):
        shown = README.read_text(encoding="utf-8")
        commands = re.findall(r"(?m)^    \$ brio (.*)$", shown)
        kept = lambda lines: [line for line in lines.splitlines() if not line.startswith(COSTS)]
        self.expect(0, *commands[0].split(), "--quiet")
        for command, words in ((commands[1], "The second line reports"), (commands[2], "and the third")):
            block = re.search(words + r"\n\n```\n(.*?)```", shown, re.S).group(1)
            text = self.expect(0, *command.split()).text
            self.assertEqual(kept(block), kept(text))
            labels = [[line.split("  ")[0] for line in lines.splitlines()] for lines in (block, text)]
            self.assertEqual(*labels)

    def test_the_commands_run_one_after_the_other(self):
        commands = re.findall(r"(?m)^    \$ brio (.*)$", README.read_text(encoding="utf-8"))
        self.assertGreater(len(commands), 10)
        for command in commands:
            self.expect(0, *command.split(), "--quiet")


if __name__ == "__main__":
    main()
