"""periodic.py: cells in space that repeats, volumes and neighbours included, of brio, voro++ and freud, in one run.

  periodic.py --brio PROGRAM [-n POINTS] [--repeat N] [--voropp PROGRAM]

Uniform points in a cube. Each library runs in a process of its own: brio as bench/periodic.c (target bench_periodic) and from
Python, voro++ as bench/peers/voropp_periodic.cpp, freud from Python. What is measured begins with the points in memory and ends
with volumes and neighbours there. Prints medians of wall and processor seconds, and ratios to brio in a cubic cell on one thread,
of programs and of Python."""

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

TILTED = [[1, 0, 0], [0.3, 1, 0], [0.2, -0.4, 1]]


def points_of(count):
    return np.random.default_rng(1).random((count, 3))


def brio_cells(points, cell):
    import brio

    vor = brio.Voronoi(points, threads=1, cell=cell)
    return vor.volumes.sum(), len(vor.neighbor_points)


def whole_cells(points, cell):
    import brio

    vor = brio.Voronoi(points, threads=1, cell=cell)
    return vor.volumes.sum() + 0 * vor.face_areas[0], len(vor.neighbor_points)


def freud_cells(points, cell):
    import freud

    freud.parallel.set_num_threads(1)
    (x, _, _), (xy, y, _), (xz, yz, z) = cell
    box = freud.box.Box(x, y, z, xy / y, xz / z, yz / z)
    voro = freud.locality.Voronoi()
    voro.compute((box, box.wrap(points - 0.5)))
    return voro.volumes.sum(), len(voro.nlist)


WAYS = {
    "Python: brio, cubic cell": lambda p: brio_cells(p, np.eye(3)),
    "Python: brio, with sizes of faces": lambda p: whole_cells(p, np.eye(3)),
    "Python: freud, cubic cell": lambda p: freud_cells(p, np.eye(3)),
    "Python: freud, triclinic cell": lambda p: freud_cells(p @ TILTED, np.array(TILTED)),
}
BRIO = {
    "brio, open box, 1 thread": ("open", "1"),
    "brio, cubic cell, 1 thread": ("box", "1"),
    "brio, triclinic cell, 1 thread": ("tilted", "1"),
    "brio, cubic cell, 2 threads": ("box", "2"),
}
VOROPP = {"voro++, cubic cell": np.eye(3), "voro++, triclinic cell": np.array(TILTED)}


def spent():
    return resource.getrusage(resource.RUSAGE_SELF).ru_utime + resource.getrusage(resource.RUSAGE_SELF).ru_stime


def one(way, count):
    """Runs one way, in this process, and prints what it took and found."""
    points = points_of(count)
    WAYS[way](points[:1000])  # modules are loaded
    used, start = spent(), time.perf_counter()
    volume, faces = WAYS[way](points)
    print(json.dumps([time.perf_counter() - start, spent() - used, volume, faces / count]))


def measure(way, options):
    if way in BRIO:
        made = subprocess.run([options.brio, str(options.n), *BRIO[way]], capture_output=True, text=True, check=True)
        row = [float(x) for x in made.stdout.split()]
        return [row[0] + row[2], row[1] + row[3], row[4], row[5]]
    if way in VOROPP:
        cell = VOROPP[way]
        with tempfile.NamedTemporaryFile() as raw:
            (points_of(options.n) @ cell).tofile(raw.name)
            rows = [cell[0][0], cell[1][0], cell[1][1], cell[2][0], cell[2][1], cell[2][2]]
            made = subprocess.run([options.voropp, raw.name, ",".join(map(str, rows))], capture_output=True, text=True, check=True)
        cells, volume, faces, wall, cpu = made.stdout.split()[:5]
        return [float(wall), float(cpu), float(volume), int(faces) / options.n]
    command = [sys.executable, os.path.abspath(__file__), "-n", str(options.n), "--one", way]
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("-n", type=int, default=100000)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--brio")
    parser.add_argument("--voropp")
    parser.add_argument("--one")
    options = parser.parse_args()
    if options.one:
        return one(options.one, options.n)
    ways = list(BRIO) + (list(VOROPP) if options.voropp else []) + list(WAYS)
    try:
        import freud  # noqa: F401
    except ImportError:
        print("freud is not installed")
        ways = [way for way in ways if "freud" not in way]
    runs = {way: [] for way in ways}
    for _ in range(options.repeat):  # in turn, so that what else the machine does falls on all
        for way in ways:
            runs[way].append(measure(way, options))
    medians = {way: [statistics.median(run[k] for run in rows) for k in range(4)] for way, rows in runs.items()}
    print(f"{options.n} uniform points: seconds of wall and processor time, ratio of these, volume, faces a point")
    for way in ways:
        wall, cpu, volume, faces = medians[way]
        reference = medians["Python: brio, cubic cell" if way in WAYS else "brio, cubic cell, 1 thread"]
        ratios = [medians[way][k] / reference[k] for k in range(2)]
        print(f"{way:34} {wall:8.3f} {cpu:8.3f}   {ratios[0]:6.2f} {ratios[1]:6.2f}   {volume:.12f} {faces:8.4f}")


if __name__ == "__main__":
    main()
