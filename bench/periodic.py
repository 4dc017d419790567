"""periodic.py: cells in space that repeats, volumes and neighbours included, of brio, voro++ and freud, in one run.

  periodic.py [-n POINTS] [--repeat N] [--voropp PROGRAM]

Uniform points in a cube. Each library runs in a process of its own: brio and freud from Python, voro++ as the program
bench/peers/voropp_periodic.cpp, which --voropp names. What is measured begins with the points in memory and ends with volumes and
neighbours there. Prints the median of wall and processor seconds, and the ratio to brio in a cubic cell on one thread."""

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


def brio_cells(points, threads, **options):
    import brio

    vor = brio.Voronoi(points, threads=threads, **options)
    if "box" in options:
        return vor.cells["volume"].sum(), len(vor.cells["face_neighbours"])
    return vor.volumes.sum(), len(vor.neighbor_points)


def freud_cells(points, cell):
    import freud

    freud.parallel.set_num_threads(1)
    (x, _, _), (xy, y, _), (xz, yz, z) = cell
    box = freud.box.Box(x, y, z, xy / y, xz / z, yz / z)
    voro = freud.locality.Voronoi()
    voro.compute((box, box.wrap(points - 0.5)))
    return voro.volumes.sum(), len(voro.nlist)


WAYS = {
    "brio, open box, 1 thread": lambda p: brio_cells(p, 1, box=[[0, 0, 0], [1, 1, 1]]),
    "brio, cubic cell, 1 thread": lambda p: brio_cells(p, 1, cell=np.eye(3)),
    "brio, triclinic cell, 1 thread": lambda p: brio_cells(p @ TILTED, 1, cell=TILTED),
    "brio, cubic cell, 2 threads": lambda p: brio_cells(p, 2, cell=np.eye(3)),
    "freud, cubic cell": lambda p: freud_cells(p, np.eye(3)),
    "freud, triclinic cell": lambda p: freud_cells(p @ TILTED, np.array(TILTED)),
}
REFERENCE = "brio, cubic cell, 1 thread"
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
    parser.add_argument("--voropp")
    parser.add_argument("--one")
    options = parser.parse_args()
    if options.one:
        return one(options.one, options.n)
    ways = list(WAYS) + (list(VOROPP) if options.voropp else [])
    try:
        import freud  # noqa: F401
    except ImportError:
        print("freud is not installed")
        ways = [way for way in ways if not way.startswith("freud")]
    runs = {way: [] for way in ways}
    for _ in range(options.repeat):  # in turn, so that what else the machine does falls on all
        for way in ways:
            runs[way].append(measure(way, options))
    medians = {way: [statistics.median(run[k] for run in rows) for k in range(4)] for way, rows in runs.items()}
    print(f"{options.n} uniform points: seconds of wall and processor time, ratio of these, volume, faces a point")
    for way in ways:
        wall, cpu, volume, faces = medians[way]
        ratios = [medians[way][k] / medians[REFERENCE][k] for k in range(2)]
        print(f"{way:32} {wall:8.3f} {cpu:8.3f}   {ratios[0]:6.2f} {ratios[1]:6.2f}   {volume:.12f} {faces:8.4f}")


if __name__ == "__main__":
    main()
