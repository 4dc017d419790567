"""memory_limit.py BRIO [--points N]: runs in a memory cgroup of exactly the bytes that `brio info` estimates.

For each command that has an estimate: the estimate, the peak of a run without a limit, and what became of the run in the
cgroup. It fits, or it ends with exit code 4 and a message; the system must not kill it. Only root may make cgroups."""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent.parent / "bench" / "thesis"))
import limits  # noqa: E402

EXTRA = {"offset": ["--distance", "0.01"], "voronoi": [], "hull": [], "alpha": ["--alpha", "auto"]}
OUTPUTS = {"delaunay": "vtu", "surface": "ply", "medial": "ply", "offset": "ply", "voronoi": "csv", "hull": "ply", "alpha": "ply"}


def facts(command, **how):
    done = subprocess.run(command, capture_output=True, check=False, **how)
    try:
        return done.returncode, json.loads(done.stdout), done.stderr.decode()
    except ValueError:
        return done.returncode, {}, done.stderr.decode()


def answer_of(code, message):
    if code == 0:
        return "fits"
    return "refused: " + message.splitlines()[0] if code == 4 and message else "FAILED: exit code %d %s" % (code, message)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("brio", type=os.path.abspath)
    parser.add_argument("--points", type=int, default=60000)
    asked = parser.parse_args()
    reason = limits.reason()
    if reason:
        print("skipped: " + reason)
        return 77
    failed = 0
    print("%-9s %-7s %10s %10s  %s" % ("command", "points", "estimate", "peak", "in a cgroup of the estimate"))
    with tempfile.TemporaryDirectory() as folder:
        for kind in "cube", "scan", "sphere", "grid":
            points = os.path.join(folder, kind + ".ply")
            subprocess.run([asked.brio, "generate", kind, "-n", str(asked.points), "-o", points, "--quiet"], check=True)
            estimates = facts([asked.brio, "info", points, "--json"])[1]["estimate_bytes"]
            for name in sorted(set(estimates) & set(OUTPUTS)):
                output = os.path.join(folder, "out." + OUTPUTS[name])
                command = [asked.brio, name, points, "-o", output, *EXTRA.get(name, []), "--json"]
                code, free, message = facts(command)
                if code:
                    continue  # no answer for these points
                os.unlink(output)
                with limits.Group(int(estimates[name])) as group:
                    code, _, message = facts(command, preexec_fn=group.join)
                answer = answer_of(code, message)
                failed += answer.startswith("FAILED")
                print("%-9s %-7s %10d %10d  %s" % (name, kind, estimates[name], free["peak_bytes"], answer), flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
