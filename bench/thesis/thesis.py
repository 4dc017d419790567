#!/usr/bin/env python3
"""thesis.py BRIO [options]: the experiments of chapters 4 and 5 of the thesis, as tables, plots and verdicts.

Every run is one process with its arrays in scratch files; runs that name a share of memory are held to it by a memory
cgroup (root, v1 or v2). Where none can be made those runs are left out, and the report says so. A run over its time is
stopped, and counts as stopped. OUT/runs.csv has a line a run, OUT/curves.csv the course of each, OUT/figure-*.svg the
plots, OUT/thesis-experiments.md the claims of the thesis beside what was found."""
import argparse
import csv
import json
import os
import shutil
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
import data
import figures
import limits
import plot
import report

LEAST_MEMORY = 12 << 20  # below, the program itself hardly fits
COLUMNS = ['figure', 'label', 'set', 'points', 'order_name', 'locate', 'memory', 'status', 'reached', 'wall', 'order',
           'insert', 'peak_bytes', 'vertices', 'tetrahedra', 'created', 'destroyed', 'walk_steps', 'history']


def options_of_call():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument('brio')
    a.add_argument('--out', default='out/thesis', help='folder of the results (default out/thesis)')
    a.add_argument('--report', help='also write the report there')
    a.add_argument('--scratch', help='folder of the data and the scratch files (default: OUT)')
    a.add_argument('--full', action='store_true', help='full sizes (default: a fourth)')
    a.add_argument('--shrink', type=int, help='every so manieth point only')
    a.add_argument('--copies', type=int, nargs='+', help='numbers of copies of the scan (default 1 2 4, full 1 2 4 10)')
    a.add_argument('--memory', type=int, metavar='MIB', help='of figures 5.5, 5.6 (4 times) and the headline (full: 256)')
    a.add_argument('--only', nargs='+', metavar='FIGURE', help='4.5 5.1 ... 5.8-order 5.8-blocks eighth-happy headline')
    a.add_argument('--limit', type=float, metavar='S', help='most seconds a run (default 60, full 1800)')
    a.add_argument('--patience', type=float, default=6, metavar='X',
                   help='most seconds of a run, as a multiple of the first of its figure (default 6)')
    o = a.parse_args()
    o.shrink = o.shrink or (1 if o.full else 4)
    o.copies = o.copies or ([1, 2, 4, 10] if o.full else [1, 2, 4])
    o.memory = (o.memory or 256 // o.shrink) << 20
    o.limit = o.limit or (1800 if o.full else 60)
    o.scratch = o.scratch or o.out
    return o


class Bench:
    def __init__(self, options):
        self.options, self.no_limits, self.peaks = options, limits.reason(), {}
        os.makedirs(options.out, exist_ok=True)
        self.folder = tempfile.mkdtemp(prefix='thesis-', dir=options.scratch)
        self.data = data.Data(os.path.abspath(options.brio), self.folder, options.shrink)

    def close(self):
        self.data.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def command(self, r):
        points = self.data.points(r.set)
        return [os.path.abspath(self.options.brio), 'delaunay', self.data.path(r.set), '--json', '--threads', '1',
                '--order', r.order, '--locate', r.locate, *r.options, *(
                    [] if r.share else ['--record-every', str(max(1, points // 40))])]

    def memory(self, r):
        """Bytes of a run: its share of the peak without a limit, or what it names."""
        if not r.share or r.share > 1: return r.share
        key = r.set, r.locate
        if key not in self.peaks:
            done = self.measure(figures.run('', r.set, 'brio-octree', r.locate), None, None)
            if done['status'] != 'done': sys.exit(f'{r.set}, {r.locate}: {done["status"]} without a limit')
            self.peaks[key] = done['peak_bytes']
        return max(LEAST_MEMORY, int(r.share * self.peaks[key]))

    def measure(self, r, memory, most_seconds):
        """A dict of what a run gave."""
        command = self.command(r) + (['--scratch', self.folder] if memory else [])
        done = limits.run(command, memory, most_seconds)
        points = self.data.points(r.set)
        begin = next((t for t, stage, _ in done.marks if stage == 'insert'), 0)
        result = {'points': points, 'memory': memory or '', 'wall': done.seconds, 'order': begin, 'insert': '',
                  'reached': max([p for _, stage, p in done.marks if stage == 'insert'], default=0), 'rounds': [],
                  'curve': [(points * p / 100, t - begin) for t, stage, p in done.marks if stage == 'insert']}
        result['status'] = 'done' if done.code == 0 else 'stopped' if done.stopped else f'failed ({done.code})'
        if done.code == 0:
            facts = json.loads(done.out)
            result.update({k: facts[k] for k in COLUMNS if k in facts}, rounds=facts.get('rounds', []))
            result.update(order=facts['seconds']['order'], insert=facts['seconds']['insert'], reached=100,
                          wall=facts['seconds']['read'] + facts['seconds']['order'] + facts['seconds']['insert'])
            if result['rounds']: result['curve'] = [(x['points'], x['seconds']) for x in result['rounds']]
        return result

    def figure(self, f, write):
        """label: result of each run of a figure."""
        results, first = {}, None
        for r in f.runs:
            if r.share and self.no_limits: continue
            memory = self.memory(r)
            most = max(30, self.options.patience * first) if first and memory else self.options.limit
            result = self.measure(r, memory, min(most, self.options.limit))
            if memory and result['status'] == 'done': first = first or result['wall']
            write(f, r, result)
            results[r.label] = result
            print(f'{f.name:14} {r.label:18} {result["points"]:>9} points  {result["status"]:8} {result["wall"]:8.1f} s',
                  flush=True)
        return results


def main():
    o = options_of_call()
    bench = Bench(o)
    if bench.no_limits: print(f'{bench.no_limits}: the runs with little memory are left out')
    found = []
    try:
        with open(f'{o.out}/runs.csv', 'w', newline='') as a, open(f'{o.out}/curves.csv', 'w', newline='') as b:
            runs, curves = csv.writer(a, lineterminator='\n'), csv.writer(b, lineterminator='\n')
            runs.writerow(COLUMNS)
            curves.writerow(['figure', 'label', 'points', 'seconds', 'tetrahedra', 'locate_seconds', 'history'])

            def write(f, r, result):
                row = {**result, 'figure': f.name, 'label': r.label, 'set': r.set, 'order_name': r.order, 'locate': r.locate}
                runs.writerow([row.get(c, '') for c in COLUMNS])
                for x in result['rounds']:
                    curves.writerow([f.name, r.label] + [x[c] for c in ('points', 'seconds', 'tetrahedra',
                                                                        'locate_seconds', 'history')])
                if not result['rounds']: curves.writerows([f.name, r.label, p, s, '', '', ''] for p, s in result['curve'])
                a.flush(), b.flush()

            for f in figures.figures(2000000 // o.shrink, o.memory, o.copies):
                if o.only and f.name not in o.only: continue
                found.append((f, bench.figure(f, write)))
                report.write(f'{o.out}/thesis-experiments.md', found, o, bench.no_limits)
        if o.report: shutil.copy(f'{o.out}/thesis-experiments.md', o.report)
        plot.draw(found, o.out)
    finally:
        bench.close()


main()
