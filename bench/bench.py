#!/usr/bin/env python3
"""bench.py BRIO PEERS OUT.csv [options]: brio against other libraries on the same points, one process a run.

The programs of a comparison run in turn, A B C A B C ..., and medians are compared. brio's time is seconds.order +
seconds.insert, the canonical order of its output included; a peer's is that of its construction call alone. Every run
adds a line to OUT.csv. PEERS is the folder of the drivers of bench/peers; one that is not there is left out."""
import argparse
import collections
import csv
import functools
import json
import os
import platform
import re
import statistics
import subprocess
import tempfile
from points import read_points

HERE = os.path.dirname(os.path.abspath(__file__))
DATA = os.path.join(os.environ.get('BRIO_SHARED', os.path.join(HERE, '..', '..', 'shared')), 'data')
COLUMNS = ['machine', 'compiler', 'commit', 'distribution', 'n', 'program', 'threads', 'seconds', 'peak_bytes',
           'tetrahedra']

# distribution: kind of `brio generate`, exponent of the weights of its regular triangulation
GENERATED = {'uniform': ('cube', -30), 'ball': ('ball', -30), 'clusters': ('clusters', -60), 'grid': ('grid', -10),
             'sphere': ('sphere', -30), 'torus': ('torus', -30), 'cylinder': ('cylinder', -30),
             'depth': ('depth', -10), 'moment': ('moment', -40)}
MOMENT_SIZES = [1000, 3000]  # n^2 / 2 tetrahedra
SCANS = ['happy_raw', 'dragon_raw', 'bunny_raw', 'csite4', 'autzen']
OTHER_NAMES = {'grid_100': 'grid_1m'}

Set = collections.namedtuple('Set', 'distribution n ply exponent')  # n is None for a file, ply for a generated set
Program = collections.namedtuple('Program', 'name threads command')
Result = collections.namedtuple('Result', 'seconds peak_bytes tetrahedra library')


# --- sets ---

def number_of(text):
    """'1e5', '100k', '1m' -> how many; ValueError for other words."""
    unit = {'k': 1000, 'm': 1000000}.get(text[-1:], 1)
    number = int(float(text.rstrip('km')) * unit)
    if number < 1: raise ValueError(text)
    return number


def name_of(s):
    if s.n is None: return s.distribution
    short = f'{s.n // 1000000}m' if s.n % 1000000 == 0 else f'{s.n // 1000}k' if s.n % 1000 == 0 else str(s.n)
    return f'{s.distribution}_{short}'


def files_of_data():
    """name: (path, exponent) of each scan and lidar set of the shared data."""
    files = {}
    table = os.path.join(DATA, 'EXPECTED.tsv')
    if os.path.exists(table):
        with open(table) as f:
            for row in csv.reader(f, delimiter='\t'):
                if row and row[0].startswith(('scan/', 'lidar/')):
                    files[os.path.basename(row[0])[:-len('.ply')]] = os.path.join(DATA, row[0]), int(row[6])
    return files


def sets_of(names, sizes, files):
    """The sets that the names mean, those of one distribution by growing n."""
    sets = []
    for name in names:
        name = OTHER_NAMES.get(name, name)
        distribution, _, size = name.rpartition('_')
        if name in files and os.path.exists(files[name][0]):
            sets.append(Set(name, None, *files[name]))
        elif name in GENERATED:
            of_name = MOMENT_SIZES if name == 'moment' else sorted(sizes)
            sets += [Set(name, n, None, GENERATED[name][1]) for n in of_name]
        elif distribution in GENERATED and re.fullmatch(r'\d+[km]?', size):
            sets.append(Set(distribution, number_of(size), None, GENERATED[distribution][1]))
        else:
            print(f'{name}: left out, there is no such set here')
    return sets


def prepare(brio, s, folder):
    """The set as a PLY for brio and as raw doubles for the peers, and its number of points."""
    ply, raw = s.ply or os.path.join(folder, 'points.ply'), os.path.join(folder, 'points.f64')
    if s.n is not None:
        kind = GENERATED[s.distribution][0]
        subprocess.run([brio, 'generate', kind, '-n', str(s.n), '-o', ply, '--quiet'], check=True)
    points = read_points(ply).astype('<f8')
    points.tofile(raw)
    return ply, raw, len(points)


# --- runs ---

def comparisons(options, ply, raw, exponent):
    """Lists of programs that do the same work, brio first."""
    def brio(name, threads, *more):
        return Program(name, threads, [options.brio, 'delaunay', ply, '--json', '--threads', str(threads), *more])

    def peer(name, threads, *more):
        return Program(name, threads, [os.path.join(options.peers, name), raw, *more])

    several, weights = options.threads, f'--weights-mod={exponent}'
    yield [brio('brio delaunay', 1), peer('cgal_delaunay', 1), peer('tetgen_delaunay', 1), peer('qhull_delaunay', 1)]
    if several > 1:
        yield [brio('brio delaunay', several), peer('cgal_delaunay_parallel', several, str(several))]
    yield [brio('brio regular', 1, weights), peer('cgal_regular', 1, str(exponent))]


def is_peer(program):
    return not program.name.startswith('brio')


def run(program, limit):
    """A Result, or the words for why there is none."""
    try:
        done = subprocess.run(program.command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, timeout=limit if is_peer(program) else None)
    except subprocess.TimeoutExpired:
        return f'over {limit:g} s'
    if done.returncode: return f'failed, status {done.returncode}'
    if is_peer(program):
        _, tetrahedra, seconds, peak, library = done.stdout.decode().split()
        return Result(float(seconds), int(peak), int(tetrahedra), library)
    facts = json.loads(done.stdout)
    seconds = facts['seconds']['order'] + facts['seconds']['insert']
    return Result(seconds, facts['peak_bytes'], facts['tetrahedra'], 'brio')


def measure(programs, skipped, options, record):
    """name: list of Results, or the words for why there are none. A slow peer repeats less: it has less noise."""
    results = {p.name: 'skipped: no answer for fewer points' if p.name in skipped else [] for p in programs}
    for _ in range(options.runs):
        for p in programs:
            done = results[p.name]
            if isinstance(done, str) or is_peer(p) and sum(r.seconds for r in done) > options.limit / 12: continue
            result = run(p, options.limit)
            record(p, result)
            if isinstance(result, str):
                results[p.name] = result
            else:
                done.append(result)
    return results


# --- what is printed and written ---

def show(name, programs, results):
    """One line a program: medians, and how many times brio's they are."""
    mine = results[programs[0].name]
    for p in programs:
        runs = results[p.name]
        line = f'{name:14} {p.name:22} {p.threads}  '
        if isinstance(runs, str):
            print(line + runs, flush=True)
            continue
        seconds, peak = (statistics.median(r[i] for r in runs) for i in (0, 1))
        line += f'{seconds:9.4f} s {peak / 1e6:7.0f} MB'
        if is_peer(p) and not isinstance(mine, str):
            times, memory = (x / statistics.median(r[i] for r in mine) for i, x in ((0, seconds), (1, peak)))
            more = runs[0].tetrahedra - mine[0].tetrahedra
            count = f'{more:+d} tetrahedra' if more else 'same count'
            line += f'  {times:6.2f} x time {memory:6.2f} x memory  {count:18} {runs[0].library}'
        print(line, flush=True)


def machine():
    model = platform.machine()
    if os.path.exists('/proc/cpuinfo'):
        with open('/proc/cpuinfo') as f:
            model = next((line.split(':', 1)[1].strip() for line in f if line.startswith('model name')), model)
    return f'{model}, {os.cpu_count()} threads'


@functools.lru_cache
def compiler(path):
    """The compiler that a program names in its own file."""
    with open(path, 'rb') as f:
        names = re.findall(rb'(clang) version ([\d.]+)|(GCC): \([^)]*\) ([\d.]+)', f.read())
    return ' '.join(word.decode().lower() for word in max(names, default=[b'unknown']) if word)


def commit():
    command = ['git', '-C', HERE, 'describe', '--always', '--dirty']
    return subprocess.run(command, capture_output=True, text=True).stdout.strip() or 'unknown'


def open_csv(path):
    """The file to add to; one with other columns is kept beside it."""
    head = ','.join(COLUMNS) + '\n'
    if os.path.exists(path):
        with open(path) as f:
            if f.readline() != head: os.replace(path, path + '.before')
    fresh = not os.path.exists(path)
    f = open(path, 'a', newline='')
    if fresh: f.write(head)
    return f


def options_of_call():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument('brio'), a.add_argument('peers'), a.add_argument('out')
    a.add_argument('--runs', type=int, default=3, help='runs of each program (default 3)')
    a.add_argument('--only', nargs='+', metavar='NAME',
                   help='distributions (uniform), sets (uniform_1m) or scans (happy_raw)')
    a.add_argument('--sizes', nargs='+', type=number_of, default=[10000, 100000], metavar='N', help='default 1e4 1e5')
    a.add_argument('--all', action='store_true', help='every scan and lidar set of the shared data')
    a.add_argument('--threads', type=int, default=2, help='of the runs in several threads (default 2; 1: none)')
    a.add_argument('--limit', type=float, default=120, metavar='S',
                   help='seconds that a run of a peer may take (default 120)')
    return a.parse_args()


def bench(s, options, write, left_out, unanswered):
    """All comparisons on one set. left_out: peers not installed; unanswered: those that failed on fewer such points."""
    with tempfile.TemporaryDirectory() as folder:
        ply, raw, n = prepare(options.brio, s, folder)

        def record(p, r):
            numbers = [r, '', ''] if isinstance(r, str) else [f'{r.seconds:.4f}', r.peak_bytes, r.tetrahedra]
            write(compiler(p.command[0]), [s.distribution, n, p.name, p.threads] + numbers)

        for programs in comparisons(options, ply, raw, s.exponent):
            missing = {p.name for p in programs if is_peer(p) and not os.path.exists(p.command[0])}
            for name in sorted(missing - left_out): print(f'{name}: left out, its library is not installed')
            left_out |= missing
            programs = [p for p in programs if p.name not in missing]
            results = measure(programs, unanswered, options, record)
            unanswered |= {p.name for p in programs if is_peer(p) and isinstance(results[p.name], str)}
            show(name_of(s), programs, results)


def main():
    options = options_of_call()
    files = files_of_data()
    names = options.only or [*GENERATED, *(files if options.all else SCANS)]
    machine_name, commit_name = machine(), commit()
    left_out, unanswered = set(), collections.defaultdict(set)
    with open_csv(options.out) as out:
        writer = csv.writer(out, lineterminator='\n')

        def write(compiler_name, columns):
            writer.writerow([machine_name, compiler_name, commit_name] + columns)
            out.flush()

        for s in sets_of(names, options.sizes, files):
            bench(s, options, write, left_out, unanswered[s.distribution])


main()
