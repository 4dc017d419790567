#!/usr/bin/env python3
"""plot.py BENCH.csv FOLDER: draws the runs of the newest commit in a file of bench.py with gnuplot.

FOLDER/bench_ratios.svg   bars: how many times brio's seconds each peer takes, on the largest set of each distribution
FOLDER/bench_growth.svg   a panel a distribution: seconds per million points against the number of points"""
import collections
import csv
import os
import shutil
import statistics
import subprocess
import sys

PEERS = {'cgal_delaunay': 'brio delaunay', 'cgal_delaunay_parallel': 'brio delaunay', 'cgal_regular': 'brio regular',
         'tetgen_delaunay': 'brio delaunay', 'qhull_delaunay': 'brio delaunay'}


def medians(path):
    """(distribution, n): {(program, threads): median of the seconds}, of the last line's machine and commit."""
    with open(path, newline='') as f:
        rows = list(csv.DictReader(f))
    newest = [r for r in rows if r['tetrahedra'] and all(r[c] == rows[-1][c] for c in ('machine', 'commit'))]
    seconds = collections.defaultdict(list)
    for r in newest:
        seconds[r['distribution'], int(r['n']), r['program'], int(r['threads'])].append(float(r['seconds']))
    result = collections.defaultdict(dict)
    for (distribution, n, program, threads), times in seconds.items():
        result[distribution, n][program, threads] = max(statistics.median(times), 1e-4)
    return result


def block(name, rows):
    """Data that a gnuplot script holds itself."""
    return f'${name} << EOD\n' + ''.join(' '.join(map(str, r)) + '\n' for r in rows) + 'EOD\n'


def label(program):
    name, threads = program
    return f'{name.replace("_", " ")}, {threads}'


def ratios(results):
    largest = {}
    for distribution, n in sorted(results): largest[distribution] = n
    bar = {}  # (set, peer): its height
    for distribution, n in largest.items():
        m = results[distribution, n]
        for name, threads in m:
            mine = m.get((PEERS.get(name), threads))
            if mine: bar[f'"{distribution} {n}"', (name, threads)] = m[name, threads] / mine
    if not bar: return ''
    programs = sorted({p for _, p in bar})
    rows = [[name] + [bar.get((name, p), 'NaN') for p in programs] for name in sorted({name for name, _ in bar})]
    bars = [f'$ratios using {i + 2}:xtic(1) title "{label(p)}"' for i, p in enumerate(programs)]
    return block('ratios', rows) + '''set terminal svg size 1000,500 background "white"
set title "seconds of a peer / seconds of brio, same points, same number of threads"
set style data histograms
set style histogram clustered gap 1
set style fill solid 0.8 noborder
set logscale y
set yrange [0.2:*]
set grid ytics
set key outside
set xtics rotate by -35
plot ''' + ', '.join(bars + ['1 with lines dashtype 2 linecolor "black" title "brio"']) + '\n'


def curves_of(source, programs):
    """The arguments of plot: a curve a program."""
    return ', '.join(f'{source} using 1:{i + 2} with linespoints linecolor {i + 1} title "{label(p)}"'
                     for i, p in enumerate(programs))


def growth(results):
    """A panel for each distribution that was measured at several numbers of points, and one for the legend."""
    numbers = collections.defaultdict(list)
    for distribution, n in sorted(results): numbers[distribution].append(n)
    numbers = {d: ns for d, ns in numbers.items() if len(ns) > 1}
    if not numbers: return ''
    programs = sorted({p for d, ns in numbers.items() for n in ns for p in results[d, n]})
    lines = len(numbers) // 3 + 1
    script = f'''set terminal svg size 1100,{300 * lines + 50} background "white"
set multiplot layout {lines},3 title "seconds per million points against the number of points"
set logscale xy
set format x "10^{{%L}}"
set grid
unset key
'''
    for d, ns in numbers.items():
        rows = [[n] + [results[d, n][p] * 1e6 / n if p in results[d, n] else 'NaN' for p in programs] for n in ns]
        script += block(d, rows) + f'set title "{d}"\nplot {curves_of("$" + d, programs)}\n'
    script += block('nothing', [['NaN'] * (len(programs) + 1)])
    script += 'unset logscale\nunset border\nunset tics\nunset title\nset key center center\n'
    return script + f'plot [0:1] [0:1] {curves_of("$nothing", programs)}\nunset multiplot\n'


def main():
    path, folder = sys.argv[1:]
    if not shutil.which('gnuplot'):
        print('gnuplot is not installed: the plots are left out')
        return
    results = medians(path)
    for name, script in (('bench_ratios.svg', ratios(results)), ('bench_growth.svg', growth(results))):
        if not script: continue
        target = os.path.join(folder, name)
        subprocess.run(['gnuplot'], input=f'set output "{target}"\n' + script, text=True, check=True)
        print('wrote', target)


main()
