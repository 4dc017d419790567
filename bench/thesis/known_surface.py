#!/usr/bin/env python3
"""known_surface.py BRIO FOLDER [--map FILE] [--runs N] [--only PART ...] [--levels L ...]

The Delaunay triangulation of a known surface, by the strategies of chapter 4.

PART is one of
    growth   what a point costs against the number of points, located by the history DAG alone, by tracing, by walks:
             counts, on the iso-surface of a chain of atoms at several resolutions -> FOLDER/known_surface.svg
    shares   how many triangles and edges of meshes are Delaunay, and what tracing them costs
    times    the processor's seconds of the strategies on the butterfly subdivisions of the map's iso-surface, as the
             thesis made its sets B-1 and B-2: the runs alternate, and each ratio is that of the medians

Tables go to standard output and, as they are, to FOLDER/known_surface.md. FILE is a CCP4 map; without it `shares` and
`times` use the chain of atoms, too. Debian's numpy is needed for `shares`, gnuplot for the plot."""
import argparse
import json
import math
import os
import random
import resource
import shutil
import statistics
import subprocess
import sys

LEVEL = 1.5  # standard deviations above the mean of the map
BASE = 131000  # vertices of the map's surface; subdivided once and twice there are about 500 thousand and 2 million
RESOLUTIONS = [25, 50, 100, 200, 400]
STRATEGIES = {'walk': ['walk'], 'history': ['history'], 'history, random order': ['history', '--order', 'random'],
              'trace': ['trace'], 'trace, BRIO order': ['trace', '--order', 'brio'], 'neighbour': ['neighbour']}


class Report:
    def __init__(self, path):
        self.file = open(path, 'w')

    def line(self, text=''):
        print(text, flush=True)
        print(text, file=self.file, flush=True)

    def table(self, head, rows):
        """Rows are printed as they come."""
        self.line('| ' + ' | '.join(head) + ' |')
        self.line('|' + '---|' * len(head))
        for row in rows:
            self.line('| ' + ' | '.join(row) + ' |')
        self.line()


class Bench:
    def __init__(self, brio, folder, map_file):
        self.brio, self.folder, self.map = brio, folder, map_file

    def path(self, name):
        return os.path.join(self.folder, name)

    def run(self, *arguments):
        """The facts of a run on one thread, with the processor's seconds as `cpu`."""
        command = [self.brio, *arguments, '--json', '--quiet', '--threads', '1']
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        facts = json.loads(subprocess.run(command, stdout=subprocess.PIPE, check=True, text=True).stdout)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        facts['cpu'] = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return facts

    def delaunay(self, mesh, *arguments):
        return self.run('delaunay', self.path(mesh), '--locate', *arguments)

    def chain(self):
        """The field of our own: a random chain of carbon atoms, coiled up."""
        path, rng, at = self.path('chain.pdb'), random.Random(1), (0.0, 0.0, 0.0)
        with open(path, 'w') as f:
            for i in range(120):
                f.write('ATOM  %5d  CA  ALA A%4d    %8.3f%8.3f%8.3f  1.00  0.00           C\n'
                        % (i + 1, i + 1, *at))
                step = [rng.gauss(0, 1) - 0.15 * x for x in at]
                length = math.sqrt(sum(x * x for x in step))
                at = tuple(x + 2.2 * s / length for x, s in zip(at, step))
        return path

    def chain_surface(self, resolution, *arguments):
        name = 'chain_%d%s.ply' % (resolution, ''.join(arguments))
        if not os.path.exists(self.path(name)):
            self.run('iso', self.chain(), '--level', '1', '--resolution', str(resolution), *arguments,
                     '-o', self.path(name))
        return name

    def base(self):
        """The iso-surface that is subdivided."""
        if not self.map:
            return self.chain_surface(200)
        if not os.path.exists(self.path('base.ply')):
            self.run('iso', self.map, '--level', str(LEVEL), '--sigma', '-n', str(BASE), '-o',
                     self.path('base.ply'))
        return 'base.ply'

    def subdivided(self, levels):
        name = 'b%d.ply' % levels
        if not os.path.exists(self.path(name)):
            self.run('subdivide', self.path(self.base()), '--levels', str(levels), '-o', self.path(name))
        return name


def per_point(facts, key):
    return {**facts, **facts['internals']}[key] / facts['points']


# --- growth

def growth_row(bench, mesh):
    history = bench.delaunay(mesh, 'history', '--order', 'random')
    conflicts = bench.delaunay(mesh, 'history', '--order', 'random', '--all-conflicts')
    trace = bench.delaunay(mesh, 'trace')
    traced = bench.delaunay(mesh, 'trace', '--all-conflicts')
    walk, neighbour = bench.delaunay(mesh, 'walk'), bench.delaunay(mesh, 'neighbour')
    if len({f['checksum'] for f in (history, conflicts, trace, traced, walk, neighbour)}) != 1:
        sys.exit('%s: the triangulations differ' % mesh)
    tests = [per_point(f, 'history_tests') for f in (history, trace, conflicts, traced)]
    return [walk['points'], *tests, per_point(trace, 'trace_intersections'), per_point(walk, 'walk_steps'),
            per_point(neighbour, 'walk_steps')]


GROWTH_PLOT = '''set terminal svg size 1300,420 background "white"
set output "%s"
set multiplot layout 1,3
set logscale x
set format x "10^{%%L}"
set xlabel "points"
set yrange [0:*]
set grid
set key top left Left reverse
set title "history DAG: nodes held against a point, one path"
plot $conforming using 1:2 with linespoints lw 2 lc 1 title "history alone", \\
     $conforming using 1:3 with linespoints lw 2 lc 2 title "traced"
set title "the same, all conflicts"
plot $conforming using 1:4 with linespoints lw 2 lc 1 title "history alone", \\
     $conforming using 1:5 with linespoints lw 2 lc 2 title "traced"
set title "tetrahedra entered for a point"
set yrange [0:10]
plot $conforming using 1:6 with linespoints lw 2 lc 2 title "all tracings, triangles Delaunay", \\
     $marching using 1:6 with linespoints lw 2 lc 3 title "all tracings, triangles not all Delaunay", \\
     $conforming using 1:7 with linespoints lw 2 lc 7 title "walks, BRIO order", \\
     $conforming using 1:8 with linespoints lw 2 lc 8 title "walks from neighbours, BRIO order"
unset multiplot
'''


def growth(bench, report):
    head = ['points', 'history', 'traced', 'history, all conflicts', 'traced, all conflicts', 'trace intersections',
            'walk steps', 'walk steps from neighbours']
    blocks = ''
    for name, arguments in (('conforming', ['--delaunay-conforming']), ('marching', [])):
        rows = []
        for resolution in RESOLUTIONS if arguments else RESOLUTIONS[:-1]:
            rows.append(growth_row(bench, bench.chain_surface(resolution, *arguments)))
            print('growth: %s, %d points' % (name, rows[-1][0]), file=sys.stderr, flush=True)
        report.line('Counts for a point, %s iso-surface of a chain of atoms:\n' % name)
        report.table(head, [[str(row[0])] + ['%.2f' % x for x in row[1:]] for row in rows])
        blocks += '$%s << EOD\n%sEOD\n' % (name, ''.join(' '.join(map(str, row)) + '\n' for row in rows))
    if shutil.which('gnuplot'):
        script = blocks + GROWTH_PLOT % bench.path('known_surface.svg')
        subprocess.run(['gnuplot'], input=script, text=True, check=True)


# --- shares

def read_lists(path, size):
    """The index lists of a PLY file that brio wrote, all of one size, and the vertices."""
    import numpy
    with open(path, 'rb') as f:
        data = f.read()
    end = data.index(b'end_header\n') + len(b'end_header\n')
    counts, width, element = [], 0, None
    for word in (line.split() for line in data[:end].decode().splitlines()):
        if word[0] == 'element':
            element = word[1]
            counts.append(int(word[2]))
        elif word[0] == 'property' and element == 'vertex':
            width += {'double': 8, 'float': 4, 'uchar': 1}[word[1]]
    places = numpy.frombuffer(data, dtype=[('p', '<f8', 3), ('rest', 'V%d' % (width - 24))], count=counts[0],
                              offset=end)['p']
    lists = numpy.frombuffer(data, dtype=[('n', 'u1'), ('v', '<i4', size)], count=counts[1],
                             offset=end + counts[0] * width)['v']
    return places, lists


def keys(simplices):
    import numpy
    key = numpy.zeros(len(simplices), dtype=numpy.uint64)
    for column in numpy.sort(simplices, axis=1).T.astype(numpy.uint64):
        key = key * numpy.uint64(1 << 21) + column
    return key


def delaunay_shares(bench, mesh):
    """The shares of a mesh's triangles and edges that are in the Delaunay triangulation of its vertices."""
    import numpy
    bench.run('delaunay', bench.path(mesh), '-o', bench.path('tetrahedra.ply'))
    places, faces = read_lists(bench.path(mesh), 3)
    _, tets = read_lists(bench.path('tetrahedra.ply'), 4)
    _, first, name = numpy.unique(places, axis=0, return_index=True, return_inverse=True)
    faces, tets = first[name.reshape(-1)][faces], first[name.reshape(-1)][tets]
    facets = numpy.unique(numpy.concatenate([keys(numpy.delete(tets, i, axis=1)) for i in range(4)]))
    edges = numpy.unique(numpy.concatenate([keys(tets[:, [i, j]]) for i in range(4) for j in range(i)]))
    own = numpy.unique(numpy.concatenate([keys(faces[:, [i, i - 1]]) for i in range(3)]))
    return numpy.isin(keys(faces), facets).mean(), numpy.isin(own, edges).mean()


def shares_row(bench, name, mesh):
    triangles, edges = delaunay_shares(bench, mesh)
    trace, history = bench.delaunay(mesh, 'trace'), bench.delaunay(mesh, 'history', '--order', 'random')
    return [name, str(trace['points']), '%.2f %%' % (100 * triangles), '%.2f %%' % (100 * edges),
            '%.2f' % per_point(trace, 'trace_intersections'), '%.1f' % per_point(trace, 'history_tests'),
            '%.1f' % per_point(history, 'history_tests')]


def shares(bench, report):
    base = bench.base()
    makers = [('marching tetrahedra', base), ('the same subdivided', bench.subdivided(1))]
    bench.run('surface', bench.path(base), '--method', 'cocone', '-o', bench.path('cocone.ply'))
    makers.append(('co-cone of the same vertices', 'cocone.ply'))
    if bench.map:
        bench.run('iso', bench.map, '--level', str(LEVEL), '--sigma', '--delaunay-conforming', '-n',
                  str(BASE), '-o', bench.path('conforming.ply'))
        makers.append(('conforming iso-surface', 'conforming.ply'))
    else:
        makers.append(('conforming iso-surface', bench.chain_surface(200, '--delaunay-conforming')))
    report.line('Delaunay triangles and edges of meshes, and counts for a point:\n')
    report.table(['mesh', 'points', 'triangles', 'edges', 'trace intersections', 'nodes, traced', 'nodes, history'],
                 (shares_row(bench, *maker) for maker in makers))


# --- times

STAGES = ['subgraph', 'order', 'insert']


def times_of(bench, mesh, runs):
    """For each strategy a list of runs: the processor's seconds of the process, and the clock's of the stages."""
    seconds = {name: [] for name in STRATEGIES}
    for run in range(runs):
        for name, arguments in STRATEGIES.items():
            facts = bench.delaunay(mesh, *arguments)
            seconds[name].append([facts['cpu']] + [facts['seconds'].get(stage, 0) for stage in STAGES])
            print('times: %s, run %d, %s: %.2f' % (mesh, run + 1, name, facts['cpu']), file=sys.stderr, flush=True)
    return facts['points'], seconds


def times(bench, report, runs, all_levels):
    for levels in all_levels:
        points, seconds = times_of(bench, bench.subdivided(levels), runs)
        cpu = {name: statistics.median(run[0] for run in lists) for name, lists in seconds.items()}
        report.line('%d points (subdivided %d times), one thread, medians of %d alternating runs. Processor: seconds of the '
                    'process, reading and checksum included; the stages are by the clock.\n'
                    % (points, levels, runs))
        report.table(['strategy', 'processor', 'ratio to the walk'] + STAGES,
                     [[name, '%.2f' % cpu[name], '%.2f' % (cpu[name] / cpu['walk'])] +
                      ['%.2f' % statistics.median(run[i + 1] for run in seconds[name]) for i in range(3)]
                      for name in STRATEGIES])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('brio')
    parser.add_argument('folder')
    parser.add_argument('--map')
    parser.add_argument('--runs', type=int, default=3)
    parser.add_argument('--levels', type=int, nargs='*', default=[1, 2], help='of subdivision, for times')
    parser.add_argument('--only', nargs='*', default=['growth', 'shares', 'times'])
    options = parser.parse_args()
    os.makedirs(options.folder, exist_ok=True)
    bench = Bench(options.brio, options.folder, options.map)
    report = Report(bench.path('known_surface.md'))
    if 'growth' in options.only: growth(bench, report)
    if 'shares' in options.only: shares(bench, report)
    if 'times' in options.only: times(bench, report, options.runs, options.levels)


main()
