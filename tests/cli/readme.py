"""The README shows the reports of the program as they are."""

import json
import pathlib
import re
import subprocess

from brio_cli import BRIO, CliTest, main

README = pathlib.Path(__file__).resolve().parents[2] / "README.md"
# What a run costs: different each time.
COSTS = ("seconds", "memory")


class Demonstration(CliTest):
    def test_a_page_of_the_scan_and_its_surface(self):
        """What `make demo` runs, which is the first command of the README."""
        script = README.parent / "scripts" / "demo.sh"
        said = subprocess.run(["sh", str(script), BRIO, self.folder], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=True).stdout
        self.assertRegex(said, r"open \S+/demo.html in a browser\n$")
        page = pathlib.Path(self.path("demo.html")).read_text(encoding="utf-8")
        layers = [json.loads(text) for text in re.findall(r'class="layer">(.*?)</script>', page)]
        self.assertEqual([layer["name"] for layer in layers], ["scan.ply", "demo.ply"])
        self.assertEqual((layers[1]["certificate"]["closed"], layers[1]["certificate"]["genus"]), (True, 3))
        self.assertTrue(pathlib.Path(self.path("demo.png")).read_bytes().startswith(b"\x89PNG"))


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
