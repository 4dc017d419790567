"""Jobs of brio-mpi for tests, oversubscribed on this machine, and what one process says."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build-mpi").resolve()
BRIO, MPI = str(BUILD / "brio"), str(BUILD / "brio-mpi")
SHARED = pathlib.Path(os.environ.get("BRIO_SHARED", pathlib.Path(__file__).resolve().parents[2] / "../shared")).resolve()
SAME = "points vertices duplicates hidden dimension tetrahedra hull_facets checksum weighted".split()
LONG = os.environ.get("BRIO_LONG") == "1"
MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none"]


def facts_of(result):
    return json.loads(result.stdout[result.stdout.index("{"):result.stdout.rindex("}") + 1])


class MpiCase(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="brio-mpi-test-"))
        self.scratch = self.folder / "scratch"
        self.scratch.mkdir()

    def tearDown(self):
        shutil.rmtree(self.folder, ignore_errors=True)

    def line(self, ranks, *arguments, launch=(), command="delaunay", program=(MPI,)):
        """The command line of a job."""
        return [*MPIRUN, *launch, "-n", str(ranks), *program, command, *map(str, arguments), "--scratch", str(self.scratch),
                "--json"]

    def mpi(self, ranks, *arguments, launch=(), check=True, command="delaunay", program=(MPI,)):
        line = self.line(ranks, *arguments, launch=launch, command=command, program=program)
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

    def fails(self, code, words, *arguments, ranks=3, command="delaunay", program=(MPI,)):
        """Runs a job that ends on all ranks with one sentence."""
        result = self.mpi(ranks, *arguments, check=False, command=command, program=program)
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertIn(words, result.stderr)
        self.assertEqual(facts_of(result)["exit"], code)
        return result

    def names(self, beginning):
        """What is in the folder under names of an output."""
        return sorted(path.name for path in self.folder.iterdir() if path.name.startswith(beginning))
