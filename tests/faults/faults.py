"""faults.py BRIO LIBRARY [options]: faults at every point of runs of the program, and a table of what came of them.

Every command line of cases.py runs with a fault at its first point of a kind, its second, and so on until a run meets none. A
point is answered if the run ends with an exit code that fits the fault and a message that names what failed; or as without
the fault, with the same bits in every file and the same report. Whatever comes, every output is the old file or the new one,
no other file stays, and no memory that a good run frees is left.
"""

import argparse
import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import signal
import sys
import tempfile
import time

import cases
from server import CUT, ERROR, FOREVER, INTERRUPT, MAP, MEMORY, NONE, OPEN, OTHER, READ, Server, SHORT, SIGNAL, THREAD, \
    UNSEEN, WRITE

HERE = pathlib.Path(__file__).resolve().parent
OLD = b"an old file\n"
# rename, renameat: no single call makes a file without a name replace another, so that between two calls it has a temporary name.
# In a set of files, which are exchanged with old ones, the old ones have such names for some calls.
GIVING_NAMES = (82, 264)


class Kind:
    """A kind of fault.   span  how many calls fail from the k-th on."""

    def __init__(self, name, kind, detail=0, span=1, groups="commands scratch formats"):
        self.name, self.kind, self.detail, self.span, self.groups = name, kind, detail, span, groups.split()


ALL = "commands scratch formats threads"
KINDS = [
    Kind("memory refused", MEMORY, groups=ALL), Kind("memory refused from then on", MEMORY, span=FOREVER),
    Kind("thread refused", THREAD, groups=ALL), Kind("threads refused from then on", THREAD, span=FOREVER, groups=ALL),
    Kind("mapping refused", ERROR, MAP), Kind("mappings refused from then on", ERROR, MAP, FOREVER),
    Kind("open fails", ERROR, OPEN), Kind("read fails", ERROR, READ), Kind("write, flush, close, rename fails", ERROR, WRITE),
    Kind("disk full from then on", ERROR, WRITE, FOREVER), Kind("another call fails", ERROR, OTHER),
    Kind("all calls fail from then on", ERROR, OPEN | READ | WRITE | MAP | OTHER, FOREVER),
    Kind("short read or write", SHORT), Kind("all reads and writes short", SHORT, span=FOREVER),
    Kind("EINTR", INTERRUPT), Kind("EINTR three times", INTERRUPT, span=3),
    Kind("SIGINT twice", SIGNAL, signal.SIGINT, 2),
    *(Kind(name, SIGNAL, getattr(signal, name)) for name in ("SIGINT", "SIGKILL")),
    *(Kind(name, SIGNAL, getattr(signal, name), groups="commands formats")
      for name in ("SIGTERM", "SIGHUP", "SIGPIPE", "SIGXFSZ")),
    Kind("scratch files cut", CUT, groups="scratch"),
]


# Facts that differ from run to run, with the number of threads, or where a file cannot be looked at (streamed).
UNSTEADY = "streamed seconds peak_bytes threads internals rounds created destroyed walk_steps insphere_calls exact_calls".split()

# For every check of the project: lines that hold this, and the kinds of faults in them.
SHORT_PART = [
    (r"delaunay {i}/cube.xyz -o {o}/a.vtu --json$", None),
    (r"a\.node --neighbors", ["write, flush, close, rename fails"]),
    (r"^--version|^help", ["write, flush, close, rename fails", "all calls fail from then on"]),
    (r"mesh.ply {o}/a\.stl", ["memory refused"]),
    (r"convert {i}/cube.xyz {o}/a\.npy", ["another call fails"]),
    (r"info .*gltf\.gltf", ["memory refused"]),
    (r"alpha .*f\.txt", ["SIGINT twice"]),
    (r"locate .*a\.csv --json", ["memory refused", "write, flush, close, rename fails", "SIGINT twice", "SIGKILL"]),
]


def ends_in_a_handler(kind):
    """Such a run ends in the midst of its work, and frees nothing."""
    return kind.kind == CUT or kind.name == "SIGINT twice"


class Case:
    """A command line with its folders, the reference run, and the judge of faulted ones."""

    def __init__(self, asked, group, line, inputs, old):
        self.group, self.line = group, line
        self.folder = tempfile.mkdtemp(prefix="brio-faults-", dir=asked.folder)
        self.places = {"i": inputs, "o": os.path.join(self.folder, "out"), "s": os.path.join(self.folder, "scratch")}
        for name in "os":
            os.mkdir(self.places[name])
        self.server = Server([asked.brio, *line.format(**self.places).split()], asked.library, self.folder)
        self.old = {}
        self.reference = self.server.run()
        self.new = self.snapshot()
        if old:
            self.old = dict.fromkeys(self.new, OLD)
        self.restore()
        again = self.server.run()
        if again.code != 0 or self.told(again) != self.told(self.reference) or self.snapshot() != self.new:
            self.close()
            raise RuntimeError("%s: not the same twice, or exit code %s: %s" % (line, again.code, again.err))

    def close(self):
        self.server.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def snapshot(self):
        found = {}
        for entry in os.scandir(self.places["o"]):
            with open(entry.path, "rb") as f:
                found[entry.name] = f.read()
        return found

    def restore(self):
        for entry in os.scandir(self.places["s"]):
            os.unlink(entry.path)
        found = self.snapshot()
        for name in found.keys() - self.old.keys():
            os.unlink(os.path.join(self.places["o"], name))
        for name, content in self.old.items():
            if found.get(name) != content:
                with open(os.path.join(self.places["o"], name), "wb") as f:
                    f.write(content)

    def told(self, came):
        """What a run said, without what differs from run to run."""
        text = came.out.decode(errors="replace")
        if "--json" in self.line:
            facts = json.loads(text)
            for name in UNSTEADY:
                facts.pop(name, None)
            return facts, came.err
        steady = [[line for line in said.splitlines() if not re.match(r"\s*(seconds|time|peak memory|memory|threads)\b", line)]
                  for said in (text, came.err)]
        return tuple(steady)  # where the output goes to standard output, the report goes to standard error

    # --- the judge ---

    def place_of(self, path):
        for name in "ios":
            if os.path.join(self.folder, path).startswith(self.places[name]):
                return name
        return "-"

    def codes(self, kind, came):
        """The exit codes that fit a fault, besides that of a good run."""
        place = self.place_of(came.path)
        if kind.kind == MEMORY or (kind.kind == ERROR and kind.detail == MAP):
            return {4}
        if kind.kind == ERROR and kind.span > 1:
            return {2, 4, 6}
        if kind.kind == ERROR:
            return {"i": {2}, "o": {6}, "s": {2, 4}}.get(place, {6} if kind.detail == WRITE else {2, 4, 6})
        if kind.kind == INTERRUPT:
            # Reports, tables and weights go through stdio, which does not try again. Only a signal that asks to stop comes with it.
            if place == "-" or (place == "o" and "--at" in self.line):
                return {6}
            return {2} if came.path.endswith("weights.txt") else set()
        if kind.kind == SIGNAL and kind.detail in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            return {130} if came.caught else {130, -kind.detail}
        if kind.kind == SIGNAL and (kind.detail == signal.SIGKILL or not came.caught):
            return {-kind.detail}
        return {4} if kind.kind == CUT else set()

    def wrong_files(self, came, keeps_failing):
        """What is wrong with the outputs.   keeps_failing  nothing can be undone: every later call fails, too."""
        found = self.snapshot()
        if os.listdir(self.places["s"]):
            return "scratch files stay"
        states = set()
        for name in found.keys() | self.new.keys():
            content = found.get(name)
            if ".part-" in name and came.code == -signal.SIGKILL and (came.call in GIVING_NAMES or ".node --" in self.line):
                continue
            if name not in self.new:
                return "a file stays: %s" % name
            if content not in (self.old.get(name), self.new[name]):
                return "half a file: %s" % name
            if self.old.get(name) != self.new[name]:
                states.add("new" if content == self.new[name] else "old")
        if came.code == 0 and "old" in states:
            return "exit code 0, and no new file"
        if len(states) == 2 and ".node" in self.line and came.code >= 0 and not keeps_failing:
            return "some files of a set are new, some old"
        return ""

    def wrong_words(self, came, kind):
        if came.code < 0 or kind.name == "SIGINT twice" or (came.call == 1 and came.path.endswith("err")):
            return ""
        if kind.kind in (ERROR, INTERRUPT) and (kind.span > 1 or self.place_of(came.path) == "-"):
            return ""  # standard error may be what failed
        if not re.search(r"^brio: .+", came.err, re.M):
            return "no message"
        if came.code in (2, 6) and not re.search(r"brio-faults-|standard (in|out)put|/", came.err):
            return "no file is named: %s" % came.err.strip()
        return ""

    def wrong(self, kind, came):
        """What is wrong with a run, or nothing."""
        if came.code is None:
            return "does not end"
        if came.code != 0 and came.code not in self.codes(kind, came):
            return "exit code %s: %s" % (came.code, came.err.strip()[:300])
        files = self.wrong_files(came, kind.span > 1)
        if files:
            return files
        if came.code == 0:
            fails = kind.kind == INTERRUPT or (kind.kind == ERROR and kind.detail & WRITE)
            mute = fails and self.place_of(came.path) == "-"
            try:
                said = self.told(came)
            except ValueError:
                return "no report"
            good = self.told(self.reference)
            if said != good and not (mute and said[0] == good[0]):
                return "another report: %s %s" % (came.out[:200], came.err[:200])
        elif self.wrong_words(came, kind):
            return self.wrong_words(came, kind)
        if came.code >= 0 and not ends_in_a_handler(kind) and came.live > self.reference.live:
            return "%d blocks of memory stay" % (came.live - self.reference.live)
        return ""

    # --- the loop ---

    def points(self, kind, most):
        """Faults at point 1, 2, ...: (points, failures, those answered by failing)."""
        tried, refused, failures = 0, 0, []
        single = kind.kind == SHORT and kind.span > 1
        for k in range(1, most + 1):
            came = self.server.run(kind.kind, k, min(FOREVER, k + kind.span - 1), kind.detail)
            if came.code == UNSEEN:
                return 0, 0, []
            if not came.struck:
                break
            tried += 1
            wrong = self.wrong(kind, came)
            refused += came.code != 0
            if wrong:
                failures.append("%s | %s, k = %d, call %d of %s | %s" % (self.line, kind.name, k, came.call, came.path, wrong))
            self.restore()
            if single:
                break
        return tried, refused, failures


def work(asked, group, line, inputs, old):
    """All kinds of faults in one command line: {kind: (points, refusals, failures)}."""
    try:
        case = Case(asked, group, line, inputs, old)
    except RuntimeError as error:
        return {KINDS[0].name: (0, 0, [str(error)])}
    try:
        chosen = asked.kinds or (asked.short and next(kinds for lines, kinds in SHORT_PART if re.search(lines, line)))
        kinds = [kind for kind in KINDS if group in kind.groups and (not chosen or kind.name in chosen)]
        return {kind.name: case.points(kind, asked.most) for kind in kinds}
    finally:
        case.close()


def lines_of(asked, formats):
    groups = {"commands": cases.COMMANDS, "scratch": cases.SCRATCH, "threads": cases.THREADS,
              "formats": ["info {i}/%s --json" % name for name in formats]}
    placed = [(i / len(lines), group, line) for group, lines in groups.items() for i, line in enumerate(lines)]
    chosen = [(group, line) for _, group, line in sorted(placed) if group in asked.groups]  # a spread, wherever it ends
    wanted = "|".join(lines for lines, _ in SHORT_PART) if asked.short else asked.only or ""
    return [pair for pair in chosen if re.search(wanted, pair[1])]


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("brio", type=os.path.abspath)
    parser.add_argument("library", type=os.path.abspath)
    parser.add_argument("--groups", nargs="+", default=["commands", "scratch", "formats", "threads"])
    parser.add_argument("--kinds", nargs="+")
    parser.add_argument("--only", help="command lines that hold this")
    parser.add_argument("--short", action="store_true", help="the part that is a test")
    parser.add_argument("--most", type=int, default=1 << 30, help="points of a kind in a line")
    parser.add_argument("--minutes", type=float, default=0, help="begin no line after so long")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--folder", default="/dev/shm" if os.access("/dev/shm", os.W_OK) else None)
    return parser.parse_args()


def show(totals, seconds):
    print("%-34s %8s %9s %9s %9s" % ("kind of fault", "points", "answered", "refusals", "failures"))
    sums = [0, 0, 0]
    for kind in KINDS:
        points, refused, failed = totals.get(kind.name, (0, 0, 0))
        if points:
            print("%-34s %8d %9d %9d %9d" % (kind.name, points, points - failed, refused, failed))
        sums = [a + b for a, b in zip(sums, (points, refused, failed))]
    print("%-34s %8d %9d %9d %9d" % ("all", sums[0], sums[0] - sums[2], sums[1], sums[2]))
    print("%.0f seconds of processor time" % seconds)


def main():
    asked = parse()
    totals, failures, started = {}, [], time.monotonic()
    inputs = tempfile.mkdtemp(prefix="brio-faults-in-", dir=asked.folder)
    try:
        formats = cases.make_inputs(asked.brio, inputs, HERE.parent / "fuzz" / "corpus" / "read")
        chosen = lines_of(asked, formats)
        with concurrent.futures.ProcessPoolExecutor(asked.jobs) as pool:
            futures = {pool.submit(work, asked, group, line, inputs, i % 2 == 0): line for i, (group, line) in enumerate(chosen)}
            for future in concurrent.futures.as_completed(futures):
                if asked.minutes and time.monotonic() - started > 60 * asked.minutes:
                    left = sum(other.cancel() for other in futures)
                    asked.minutes = 0
                    print("%d lines are left out: time is up" % left)
                if future.cancelled():
                    continue
                done = future.result()
                print("%6d points: %s" % (sum(row[0] for row in done.values()), futures[future]), flush=True)
                for name, (points, refused, failed) in done.items():
                    before = totals.get(name, (0, 0, 0))
                    totals[name] = (before[0] + points, before[1] + refused, before[2] + len(failed))
                    failures += failed
                    for line in failed[:20]:
                        print("FAILED " + line, flush=True)
    finally:
        shutil.rmtree(inputs, ignore_errors=True)
    used = os.times().children_user + os.times().children_system + time.process_time()
    show(totals, used)
    return 1 if failures or not totals else 0


if __name__ == "__main__":
    sys.exit(main())
