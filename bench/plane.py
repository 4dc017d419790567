#!/usr/bin/env python3
"""plane.py BRIO [CGAL_DRIVER] [--points N] [--runs R]: triangulations of the plane against scipy's Delaunay and, where its
driver (bench/peers/cgal_delaunay2) is given, CGAL's. All get the same uniform points and one thread.

The programs run in turn, one process a run, and medians are compared. Times are processor seconds, so other work on the
machine matters little: brio's are those of its whole process, reading and checksum included; scipy's and CGAL's are those
of the construction call alone. Needs numpy and scipy."""
import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile

SCIPY = """import numpy, sys, time
from scipy.spatial import Delaunay
points = numpy.fromfile(sys.argv[1]).reshape(-1, 2)
start = time.process_time()
triangles = len(Delaunay(points).simplices)
print(triangles, time.process_time() - start)"""


def make_points(folder, n):
    """n uniform points: raw doubles x y, and a PLY with z = 0."""
    import numpy
    points = numpy.random.default_rng(1).random((n, 2))
    raw, ply = os.path.join(folder, 'points.raw'), os.path.join(folder, 'points.ply')
    points.tofile(raw)
    with open(ply, 'wb') as f:
        f.write(b'ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty double x\nproperty double y\n'
                b'property double z\nend_header\n' % n)
        numpy.column_stack([points, numpy.zeros(n)]).astype('<f8').tofile(f)
    return raw, ply


def output_of(*command):
    environment = dict(os.environ, OMP_NUM_THREADS='1')
    return subprocess.run(command, stdout=subprocess.PIPE, check=True, encoding='utf-8', env=environment).stdout


def run_brio(brio, ply):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    facts = json.loads(output_of(brio, 'delaunay', ply, '--plane', 'xy', '--threads', '1', '--json'))
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return facts['triangles'], after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def run_scipy(raw):
    triangles, seconds = output_of(sys.executable, '-c', SCIPY, raw).split()
    return int(triangles), float(seconds)


def run_cgal(driver, raw):
    words = output_of(driver, raw).split()
    return int(words[1]), float(words[2])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('brio')
    parser.add_argument('cgal', nargs='?')
    parser.add_argument('--points', type=float, default=1e6)
    parser.add_argument('--runs', type=int, default=3)
    a = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        raw, ply = make_points(folder, int(a.points))
        programs = {'brio': lambda: run_brio(a.brio, ply), 'scipy': lambda: run_scipy(raw)}
        if a.cgal: programs['cgal'] = lambda: run_cgal(a.cgal, raw)
        times = {name: [] for name in programs}
        for _ in range(a.runs):
            results = {name: run() for name, run in programs.items()}
            if len({triangles for triangles, _ in results.values()}) != 1: sys.exit(f'different triangles: {results}')
            for name, (_, seconds) in results.items(): times[name].append(seconds)
    medians = {name: statistics.median(seconds) for name, seconds in times.items()}
    for name, seconds in medians.items():
        print(f'{name:6} {seconds:8.3f} s   {seconds / medians["brio"]:6.2f} times brio')


if __name__ == '__main__':
    main()
