"""run_expected.py TABLE FOLDER [--most-points N]: the triangulations of real and hostile point sets.

Each row of the table names a file of the folder, its number of points, and the dimension and the numbers of vertices,
tetrahedra and hull facets of its Delaunay triangulation; then the exponent E of its weights and the same four numbers of
the regular triangulation with the weights ldexp((i * 7919) mod 1000, E). Both are computed, verified, and compared.

BRIO names the program. Python's standard library is all that is needed.
"""

import argparse
import concurrent.futures
import csv
import json
import os
import subprocess
import sys

BRIO = os.environ.get("BRIO", "brio")
PROCESSES = 2
SKIPPED = 77
COUNTS = {"dimension": "dim", "vertices": "vertices", "tetrahedra": "tetrahedra", "hull_facets": "hull_facets"}


def read_table(path):
    with open(path, newline="") as f:
        return list(csv.DictReader((line for line in f if not line.startswith("#")), delimiter="\t"))


def expectation(row, weighted):
    prefix = "r" if weighted else ""
    expected = {key: int(row[prefix + column]) for key, column in COUNTS.items()}
    return {"points": int(row["points"]), **expected, "verified": True}


def facts_of(command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace")
    try:
        facts = json.loads(done.stdout)
    except ValueError:
        facts = {}
    if done.returncode:
        reason = facts.get("error") or done.stderr.strip() or "no message"
        facts["failed"] = "exit status %d: %s" % (done.returncode, reason)
    return facts


def compare(folder, row, weighted):
    """The differences between what a run gives and what is expected of it."""
    command = [BRIO, "delaunay", os.path.join(folder, row["file"]), "--json", "--verify", "--quiet"]
    if weighted:
        command += ["--weights-mod", row["weight_exponent"]]
    facts = facts_of(command)
    name = row["file"] + (" weighted" if weighted else "")
    failed = "failed" in facts
    differences = ["%s: %s" % (name, facts["failed"])] if failed else []
    for key, expected in expectation(row, weighted).items():
        if facts.get(key) != expected and (key in facts or not failed):
            differences.append("%s: %s %s, expected %s" % (name, key, facts.get(key), expected))
    return differences


def run_all(folder, rows):
    """Compares every row both ways, the largest first so that none of them is left for the end."""
    rows = sorted(rows, key=lambda row: -int(row["points"]))
    with concurrent.futures.ThreadPoolExecutor(PROCESSES) as pool:
        runs = [pool.submit(compare, folder, row, weighted) for row in rows for weighted in (False, True)]
        wrong = 0
        for run in runs:
            differences = run.result()
            wrong += bool(differences)
            for line in differences:
                print(line, flush=True)
    return len(runs), wrong


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("table")
    parser.add_argument("folder")
    parser.add_argument("--most-points", type=int, default=sys.maxsize, help="leave out larger point sets")
    options = parser.parse_args()
    if not os.path.exists(options.table):
        print("skipped: data.expected: the table is not there: " + options.table)
        return SKIPPED
    rows = [row for row in read_table(options.table) if int(row["points"]) <= options.most_points]
    runs, wrong = run_all(options.folder, rows)
    print("%d runs over %d files, %d wrong" % (runs, len(rows), wrong))
    return 1 if wrong or not rows else 0


if __name__ == "__main__":
    sys.exit(main())
