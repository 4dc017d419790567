"""Time and memory of conversions of a large file of points.

convert.py BRIO FOLDER [POINTS]: makes a LAS file of POINTS (25,000,000: 500 MB) points on a torus in FOLDER, converts it to
each format that is written in blocks, and thins it. Prints a line of seconds and peak resident MiB for each.
"""

import json
import os
import subprocess
import sys


def run(brio, *arguments):
    out = subprocess.run([brio, *arguments, "--json"], check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    return json.loads(out.stdout)


def main():
    brio, folder, points = sys.argv[1], sys.argv[2], sys.argv[3] if len(sys.argv) > 3 else "25000000"
    source, target = os.path.join(folder, "a.las"), os.path.join(folder, "b")
    os.makedirs(folder, exist_ok=True)
    run(brio, "generate", "torus", "-n", points, "-o", source)
    print("%s points, %.0f MB" % (points, os.path.getsize(source) / 1e6))
    cases = [(extension, []) for extension in ("ply", "las", "xyz", "npy")]
    cases += [("ply", ["--crop", "0,0,-1,2,2,1"]), ("las", ["--thin", "0.003"]), ("las", ["--thin", "0.02"])]
    for extension, options in cases:
        path = target + "." + extension
        facts = run(brio, "convert", source, path, *options)
        print("to %s %-24s %6.2f s %8.1f MiB %9d points" % (extension, " ".join(options), facts["seconds"]["total"],
                                                              facts["peak_bytes"] / 2 ** 20, facts["points"]))
        sys.stdout.flush()
        os.remove(path)
    os.remove(source)


if __name__ == "__main__":
    main()
