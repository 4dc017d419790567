"""run.py FOLDER [--minutes N] [--total] [--jobs N] [--subjects NAME...] [--keep]: runs the fuzzers built in FOLDER (preset fuzz).

Each runs for N minutes of processor time, from its committed corpus and what earlier runs found (out/fuzz/corpus). Prints a
row for each: executions, executions a second of processor time, edges of the program that were reached, findings. An input
that makes a fuzzer stop is a finding, kept in out/fuzz/findings. The exit status is 1 if there is one.
out/fuzz/results.json has the sums of all runs: executions, minutes, the most edges, findings, of each fuzzer; --table prints
them as docs/measured/reliability.md has them, and runs nothing. With --total, earlier minutes count: each fuzzer runs for what it lacks.
--jobs: so many fuzzers at a time.
--keep: afterwards adds to the committed corpus the smallest inputs that reach all that was reached, those under 700 bytes.
"""

import argparse
import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import threading

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
SUMS = threading.Lock()  # of results.json
SLICE = 300  # seconds of the clock between two looks at the processor time
MOST_FINDINGS = 3  # of a subject, before it is left
LONGEST_KEPT, MOST_KEPT = 700, 60  # bytes, inputs of a subject


def run_for(command, log):
    """Runs a program; its exit status and processor seconds."""
    child = subprocess.Popen(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL)
    _, status, used = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    return child.returncode, used.ru_utime + used.ru_stime


def last_number(pattern, text, before=0):
    found = re.findall(pattern, text)
    return int(found[-1]) if found else before


def options_of(subject, findings):
    options = ["-artifact_prefix=%s/" % findings, "-max_len=4096", "-timeout=60", "-rss_limit_mb=3000", "-print_final_stats=1",
               "-len_control=0"]
    words = HERE / ("%s.dict" % subject)
    return options + (["-dict=%s" % words] if words.exists() else [])


def run_subject(program, subject, minutes, out):
    """Row of the table: executions, processor seconds, edges, findings. Adds each slice to the sums of all runs."""
    corpus, findings = out / "corpus" / subject, out / "findings" / subject
    for folder in corpus, findings:
        folder.mkdir(parents=True, exist_ok=True)
    row = {"executions": 0, "seconds": 0.0, "edges": 0, "all": 0, "findings": 0}
    kept = [str(folder) for folder in [HERE / "corpus" / subject] if folder.is_dir()]
    command = [str(program), *options_of(subject, findings), str(corpus), *kept]
    while row["seconds"] < 60 * minutes and row["findings"] < MOST_FINDINGS:
        left = 60 * minutes - row["seconds"]
        with open(out / ("%s.log" % subject), "w+", encoding="utf-8", errors="replace") as log:
            status, seconds = run_for([*command, "-max_total_time=%d" % max(1, min(SLICE, left))], log)
            log.seek(0)
            text = log.read()
        part = {"seconds": seconds, "findings": int(status != 0), "edges": last_number(r"cov: (\d+)", text),
                "all": last_number(r"\((\d+) inline 8-bit counters\)", text),
                "executions": last_number(r"stat::number_of_executed_units: (\d+)", text, last_number(r"#(\d+)\s", text))}
        add_up(out / "results.json", subject, part)
        for name, joined in ("seconds", sum), ("findings", sum), ("executions", sum), ("edges", max), ("all", max):
            row[name] = joined([row[name], part[name]])
        if status:
            findings.mkdir(parents=True, exist_ok=True)  # somebody may have cleaned up
            shutil.copy(out / ("%s.log" % subject), findings / ("%d.log" % row["findings"]))
    return row


def keep_smallest(program, subject, out):
    kept = HERE / "corpus" / subject
    kept.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as merged:
        subprocess.run([str(program), "-merge=1", "-max_len=%d" % LONGEST_KEPT, merged, str(kept), str(out / "corpus" / subject)],
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
        inputs = sorted(pathlib.Path(merged).iterdir(), key=lambda path: (path.stat().st_size, path.name))
        room = max(0, MOST_KEPT - len(list(kept.iterdir())))
        step = max(1, len(inputs) // room if room else len(inputs) + 1)  # small and large ones
        for path in inputs[::step][:room]:
            shutil.copy(path, kept / path.name[:12])


def sums_of(path):
    return json.loads(path.read_text()) if path.exists() else {}


def add_up(path, subject, row):
    """Adds a run to the sums of all runs. A run that is cut off leaves the file as it was or as it is to be."""
    with SUMS:
        sums = sums_of(path)
        own = sums.setdefault(subject, {"executions": 0, "minutes": 0.0, "edges": 0, "all": 0, "findings": 0})
        own["executions"] += row["executions"]
        own["minutes"] = round(own["minutes"] + row["seconds"] / 60, 3)
        own["edges"] = max(own["edges"], row["edges"])
        own["all"] = row["all"] or own["all"]
        own["findings"] += row["findings"]
        written = path.with_suffix(".new")
        written.write_text(json.dumps(sums, indent=2) + "\n")
        written.replace(path)


def print_table(path):
    print("| fuzzer | executions | a second | minutes | edges |\n|---|---|---|---|---|")
    for subject, own in sums_of(path).items():
        print("| %s | %s | %s | %s | %s |" % (
            subject, format(own["executions"], ","), format(round(own["executions"] / max(60 * own["minutes"], 1e-9)), ","),
            format(own["minutes"], ",.1f"), format(own["edges"], ",")))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, nargs="?")
    parser.add_argument("--minutes", type=float, default=1)
    parser.add_argument("--total", action="store_true")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--subjects", nargs="+")
    parser.add_argument("--keep", action="store_true")
    parser.add_argument("--table", action="store_true")
    asked = parser.parse_args()
    out = ROOT / "out" / "fuzz"
    if asked.table:
        return print_table(out / "results.json")
    if not asked.folder:
        parser.error("FOLDER is missing")
    out.mkdir(parents=True, exist_ok=True)
    subjects = asked.subjects or sorted(path.stem[len("fuzz_"):] for path in HERE.glob("fuzz_*.c"))
    earlier = sums_of(out / "results.json") if asked.total else {}
    minutes = {subject: asked.minutes - earlier.get(subject, {"minutes": 0.0})["minutes"] for subject in subjects}
    findings = 0
    print("%-14s %12s %9s %8s %8s %8s" % ("subject", "executions", "a second", "minutes", "edges", "findings"), flush=True)

    def run(subject):
        program = asked.folder.resolve() / ("fuzz_%s" % subject)
        row = run_subject(program, subject, minutes[subject], out)
        if asked.keep:
            keep_smallest(program, subject, out)
        return row

    with concurrent.futures.ThreadPoolExecutor(asked.jobs) as pool:
        for subject, row in zip(subjects, pool.map(run, subjects)):
            findings += row["findings"]
            print("%-14s %12d %9.0f %8.1f %8d %8d" % (subject, row["executions"], row["executions"] / max(row["seconds"], 1e-9),
                                                      row["seconds"] / 60, row["edges"], row["findings"]), flush=True)
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
