#!/usr/bin/env python3
"""bench.py BRIO PEERS OUT.csv [--runs N] [--only NAME ...]: brio against other libraries, one thread, same points, same run.

Each pair runs in turn, A B A B ..., one process a run; the ratio is that of the medians. brio's time is seconds.order +
seconds.insert, the canonical order of the output included; a peer's is that of its construction call alone. One CSV line a run."""
import argparse, json, os, platform, statistics, subprocess, sys, tempfile
import numpy as np

SHARED = os.environ.get('BRIO_SHARED', os.path.join(os.path.dirname(__file__), '..', '..', 'shared'))
# name: (kind of `brio generate`, n) or a file of the shared data; exponent of --weights-mod for the regular triangulation
SETS = {
    'uniform_1m': ('cube', 1000000, -30), 'ball_1m': ('ball', 1000000, -30), 'grid_100': ('grid', 1000000, -10),
    'sphere_500k': ('sphere', 500000, -30), 'torus_500k': ('torus', 500000, -30), 'cylinder_300k': ('cylinder', 300000, -30),
    'happy_raw': ('scan/happy_raw.ply', None, -30), 'dragon_raw': ('scan/dragon_raw.ply', None, -29),
    'bunny_raw': ('scan/bunny_raw.ply', None, -30), 'csite4': ('lidar/csite4.ply', None, -7),
    'autzen': ('lidar/autzen.ply', None, -4),
}
SCALARS = {'float': '<f4', 'double': '<f8', 'uchar': 'u1', 'ushort': '<u2', 'int': '<i4'}


def points_of(path):
    """x, y, z of a binary little-endian PLY."""
    with open(path, 'rb') as f:
        row, count, vertex = [], 0, False
        for line in iter(f.readline, b'end_header\n'):
            w = line.decode().split()
            if w[0] == 'element':
                vertex = w[1] == 'vertex'
                count = int(w[2]) if vertex else count
            elif w[0] == 'property' and vertex:
                row.append((w[2], SCALARS[w[1]]))
        a = np.fromfile(f, np.dtype(row), count)
    return np.stack([a[c].astype('<f8') for c in 'xyz'], 1)


def prepare(brio, name, folder):
    """The set as a PLY for brio and as raw doubles for the peers; None where it is not there."""
    source, n, _ = SETS[name]
    ply = os.path.join(folder, name + '.ply')
    if n is None:
        ply = os.path.join(SHARED, 'data', source)
        if not os.path.exists(ply):
            print(f'{name}: skipped, {ply} is not there')
            return None
    else:
        subprocess.run([brio, 'generate', source, '-n', str(n), '-o', ply, '--quiet'], check=True)
    raw = os.path.join(folder, name + '.f64')
    points_of(ply).tofile(raw)
    return ply, raw


def run_brio(brio, ply, weights):
    out = subprocess.run([brio, 'delaunay', ply, '--json', '--threads', '1'] + weights, capture_output=True, check=True)
    d = json.loads(out.stdout)
    return d['seconds']['order'] + d['seconds']['insert'], d['peak_bytes'], d['tetrahedra']


def run_peer(command):
    with open(os.devnull) as nothing:
        p = subprocess.Popen(command, stdin=nothing, stdout=subprocess.PIPE)
        text = p.stdout.read().split()
        _, status, usage = os.wait4(p.pid, 0)
    if status: raise RuntimeError(f'{command}: {status}')
    return float(text[2]), usage.ru_maxrss * 1024, int(text[1])


def main():
    a = argparse.ArgumentParser()
    a.add_argument('brio'), a.add_argument('peers'), a.add_argument('out')
    a.add_argument('--runs', type=int, default=5), a.add_argument('--only', nargs='*', default=list(SETS))
    a = a.parse_args()
    commit = subprocess.run(['git', 'describe', '--always', '--dirty'], capture_output=True, text=True).stdout.strip()
    fresh = not os.path.exists(a.out)
    with tempfile.TemporaryDirectory() as folder, open(a.out, 'a') as csv:
        if fresh: csv.write('machine,commit,set,points,program,threads,seconds,peak_bytes,tetrahedra\n')
        for name in a.only:
            files = prepare(a.brio, name, folder)
            if not files: continue
            points, exponent = os.path.getsize(files[1]) // 24, str(SETS[name][2])
            for kind, peer, weights in (('delaunay', ['cgal_delaunay', files[1]], []),
                                        ('regular', ['cgal_regular', files[1], exponent], ['--weights-mod', exponent])):
                command = [os.path.join(a.peers, peer[0])] + peer[1:]
                runs = {'brio ' + kind: [], peer[0]: []}
                for _ in range(a.runs):
                    for program in runs:
                        r = run_brio(a.brio, files[0], weights) if program.startswith('brio') else run_peer(command)
                        runs[program].append(r)
                        csv.write(f'{platform.machine()}-{os.cpu_count()},{commit},{name},{points},{program},1,{r[0]:.4f},{r[1]},{r[2]}\n')
                mine, theirs = ([statistics.median(r[i] for r in v) for i in (0, 1)] for v in runs.values())
                same = {r[2] for v in runs.values() for r in v}
                print(f'{name:14} {kind:9} brio {mine[0]:8.3f} s {mine[1] / 1e6:7.0f} MB   CGAL {theirs[0]:8.3f} s {theirs[1] / 1e6:7.0f} MB   '
                      f'ratio {theirs[0] / mine[0]:5.2f}   memory {mine[1] / theirs[1]:4.2f}   {"same count" if len(same) == 1 else "COUNTS DIFFER"}', flush=True)


main()
