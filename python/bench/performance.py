"""performance.py [--write PAGE] [--quick]: brio.Delaunay against scipy's, and against the call of C that it makes.

All times but those of two threads are processor time of one thread, conversion of arrays included. What is compared runs in
turns, and medians are shown: of processes of their own for C, of one process for Python. --write puts the table, and all
that is said of the run, between the marks of a page: docs/measured/python.md.
"""

import argparse
import os
import pathlib
import platform
import statistics
import subprocess
import sys
import tempfile
import threading
import time

import numpy as np

import brio

ROOT = pathlib.Path(__file__).resolve().parents[2]
BEGIN, END = "<!-- measured -->", "<!-- end -->"


def seconds(work, least=1e-3):
    """Processor time of a call, repeated until it can be measured."""
    begin, calls = time.process_time(), 0
    while True:
        work()
        calls += 1
        taken = time.process_time() - begin
        if taken >= least:
            return taken / calls


def libraries():
    """The optional libraries that the module is linked with, and so the static library."""
    named = {"zlib": "libz.", "zstd": "libzstd.", "expat": "libexpat.", "cjson": "libcjson."}
    wanted = [start for name, start in named.items() if brio.build_info()[name]]
    lines = subprocess.run(["ldd", brio._native.__file__], check=True, capture_output=True, text=True).stdout.splitlines()
    return [line.split()[2] for line in lines if line.strip().startswith(tuple(wanted))] if wanted else []


def build_c(folder):
    library = next(p for p in (ROOT / "build/libbrio.a", ROOT / "build-ci/libbrio.a") if p.exists())
    program = folder / "call"
    subprocess.run(["cc", "-O2", "-I%s" % (ROOT / "include"), str(pathlib.Path(__file__).with_name("call.c")), str(library),
                    *libraries(), "-lm", "-lpthread", "-o", str(program)], check=True)
    return program


def call_c(program, path, d, times):
    out = subprocess.run([program, path, str(d), str(times)], check=True, capture_output=True, text=True).stdout
    return [float(line) for line in out.split()]


def whole(points):
    tri = brio.Delaunay(points, threads=1)
    return tri.simplices


def against_scipy(rounds):
    import scipy
    import scipy.spatial

    rows = []
    for d, wanted in ((2, 5), (3, 25)):
        points = np.random.default_rng(d).random((100_000, d))
        mine, theirs = [], []
        whole(points)
        for _ in range(rounds):
            theirs.append(seconds(lambda: scipy.spatial.Delaunay(points).simplices))
            mine.append(seconds(lambda: whole(points)))
        ratio = statistics.median(t / m for t, m in zip(theirs, mine))
        rows.append(f"| 10^5 points in {d}-D: times faster than scipy {scipy.__version__} | {wanted} | {ratio:.1f} "
                    f"({statistics.median(theirs):.3f} s, {statistics.median(mine):.3f} s) |")
    return rows


def against_c(program, folder, rounds):
    rows = []
    for d in (2, 3):
        for n, times in ((10, 400), (1_000_000, 3)):
            points = np.random.default_rng(n + d).random((n, d))
            path = folder / "points"
            points.tofile(path)
            c, py = [], []
            for _ in range(rounds):
                c.append(statistics.median(call_c(program, path, d, times + 1)[-times:]))
                py.append(statistics.median(seconds(lambda: whole(points)) for _ in range(times)))
            if n == 10:
                over = 1e6 * statistics.median(p - q for p, q in zip(py, c))
                rows.append(f"| 10 points in {d}-D: over the call of C | 30 microseconds | {over:.1f} microseconds |")
            else:
                over = 100 * (statistics.median(p / q for p, q in zip(py, c)) - 1)
                rows.append(f"| 10^6 points in {d}-D: over the call of C | 3 % | {over:.1f} % "
                            f"({statistics.median(c):.3f} s, {statistics.median(py):.3f} s) |")
    return rows


def side_by_side(rounds):
    """Two Python threads, a call each, against one call after the other: wall-clock time."""
    sets = [np.random.default_rng(k).random((100_000, 3)) for k in range(2)]
    ratios = []
    for _ in range(rounds):
        begin = time.monotonic()
        for points in sets:
            brio.Delaunay(points, threads=1)
        alone = time.monotonic() - begin
        threads = [threading.Thread(target=brio.Delaunay, args=(p,), kwargs={"threads": 1}) for p in sets]
        begin = time.monotonic()
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        ratios.append((time.monotonic() - begin) / alone)
    return [f"| two threads side by side, of the time of one after the other | below 1 | {statistics.median(ratios):.2f} |"]


def conditions(rounds, load):
    """What the figures depend on, in a paragraph."""
    processors = len(os.sched_getaffinity(0))
    quiet = "" if load < 0.5 * processors else " The machine was busy: figures of two runs differ by several per cent."
    return (f"CPython {platform.python_version()}, numpy {np.__version__}, {platform.machine()}, {processors} processors, "
            f"load {load:.1f} at the beginning; medians of {rounds} rounds.{quiet}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    rounds, load = 3 if options.quick else 9, os.getloadavg()[0]
    rows = against_scipy(rounds)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        rows += against_c(build_c(folder), folder, rounds)
    rows += side_by_side(rounds)
    lines = ["| what | wanted | measured |", "|---|---|---|", *rows, "", conditions(rounds, load)]
    print("\n".join(lines))
    if options.write:
        page = pathlib.Path(options.write)
        text = page.read_text(encoding="utf-8")
        head, rest = text.split(BEGIN)
        page.write_text(head + BEGIN + "\n" + "\n".join(lines) + "\n" + END + rest.split(END)[1], encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
