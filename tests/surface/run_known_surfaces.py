"""run_known_surfaces.py FOLDER: the triangulations of the meshes of a folder, located along their edges.

Every mesh of the folder must give the same checksum with --locate trace and neighbour as without, closed or not; some
must be closed.

BRIO names the program. Python's standard library is all that is needed.
"""

import json
import os
import subprocess
import sys

BRIO = os.environ.get("BRIO", "brio")
SKIPPED = 77
CHECK_FAILED = 5
WAYS = [["trace"], ["trace", "--order", "brio"], ["trace", "--subgraph", "mst"], ["neighbour"]]


def facts_of(*arguments, allowed=()):
    done = subprocess.run([BRIO, *arguments, "--json", "--quiet"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True, errors="replace")
    if done.returncode and done.returncode not in allowed:
        raise RuntimeError("brio %s: exit status %d: %s" % (" ".join(arguments), done.returncode, done.stderr.strip()))
    return json.loads(done.stdout)


def compare(path):
    """Whether the mesh is closed, and the ways along it that give another triangulation."""
    closed = facts_of("check", path, allowed=[CHECK_FAILED])["certificate"]["closed"]
    plain = facts_of("delaunay", path)["checksum"]
    wrong = [way for way in WAYS if facts_of("delaunay", path, "--locate", *way)["checksum"] != plain]
    print("%s: %s: %s" % (os.path.basename(path), "closed" if closed else "open",
                          "wrong: %s" % wrong if wrong else "the same"), flush=True)
    return closed, wrong


def main():
    folder = sys.argv[1]
    if not os.path.isdir(folder):
        print("skipped: data.known_surfaces: the meshes are not there: " + folder)
        return SKIPPED
    paths = sorted(os.path.join(folder, name) for name in os.listdir(folder) if name.endswith(".ply"))
    results = [compare(path) for path in paths if facts_of("info", path)["faces"]]
    return 1 if any(wrong for _, wrong in results) or not any(closed for closed, _ in results) else 0


if __name__ == "__main__":
    sys.exit(main())
