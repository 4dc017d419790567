#!/usr/bin/env python3
"""thesis.py BRIO [options]: the experiments of chapters 3 to 5 of the thesis, as tables, plots, pictures and verdicts.

Every run of chapters 4 and 5 is one process. Runs that name a share of memory have their arrays in scratch files, and are held to it by a
memory cgroup (root, v1 or v2). Where none can be made those runs are left out, and the report says so. A run over its
time is stopped, and counts as stopped, with the share of its points that it had inserted. OUT/runs.csv has a line a run,
OUT/curves.csv the course of each, OUT/figure-*.svg the plots, OUT/thesis-experiments.md the claims of the thesis beside
what was found. Runs that count page touches need no cgroup. Figures whose names end with CGAL run that library, by a program of
`bench/peers`; they are left out where it is not built. Chapter 3 makes surfaces (chapter3.py, surfaces.py), and reads no clock but in one
figure."""
import argparse
import csv
import json
import os
import shutil
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
import data
import figures
import limits
import pictures
import plot
import report
import surfaces
import verdicts

LEAST_MEMORY = 12 << 20  # below, the program itself hardly fits
COLUMNS = ['figure', 'label', 'set', 'points', 'order_name', 'locate', 'memory', 'status', 'reached', 'wall', 'order',
           'insert', 'peak_bytes', 'vertices', 'tetrahedra', 'created', 'destroyed', 'walk_steps', 'history', 'history_tests', 'pages',
           'page_touches']


def options_of_call():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument('brio')
    a.add_argument('--out', default='out/thesis', help='folder of the results (default out/thesis)')
    a.add_argument('--report', help='also write the report there, its results (.json) and plots beside it')
    a.add_argument('--keep', action='store_true', help='with --only: the results of other figures stay as REPORT has them')
    a.add_argument('--again', action='store_true', help='write REPORT again from its results, without any runs')
    a.add_argument('--scratch', help='folder of the data and the scratch files (default: OUT)')
    a.add_argument('--full', action='store_true', help='full sizes (default: a fourth)')
    a.add_argument('--shrink', type=int, help='every so manieth point only')
    a.add_argument('--copies', type=int, nargs='+', help='numbers of copies of the scan (default 1 2 4, full 1 2 4 10)')
    a.add_argument('--headline', type=int, nargs='+', metavar='COPIES', help='the same for the headline (default 5 10, full 10 20)')
    a.add_argument('--memory', type=int, metavar='MIB', help='of figures 5.5, 5.6 (4 times) and the headline (full: 256)')
    a.add_argument('--only', nargs='+', metavar='FIGURE', help='4.5 5.1 ... 5.8-order 5.8-blocks eighth-happy headline')
    a.add_argument('--minutes', type=float, help='most of all runs together; the rest is left out (default 10, full 45)')
    a.add_argument('--peers', default='build-bench', help='folder of the programs of bench/peers (default build-bench)')
    a.add_argument('--patience', type=float, default=6, metavar='X',
                   help='most time of a limited run, as a multiple of the first one of its figure (default 6)')
    o = a.parse_args()
    if (o.again or o.keep) and not o.report: a.error('--again and --keep go with --report')
    o.shrink = o.shrink or (1 if o.full else 4)
    o.copies = o.copies or ([1, 2, 4, 10] if o.full else [1, 2, 4])
    o.headline = o.headline or ([10, 20] if o.full else [5, 10])
    o.memory = (o.memory or 256 // o.shrink) << 20
    o.minutes = o.minutes or (45 if o.full else 10)
    o.scratch = o.scratch or o.out
    return o


class Bench:
    def __init__(self, options):
        self.options, self.no_limits, self.free = options, limits.reason(), {}
        self.library = ''
        self.left_out, self.begin, self.commit = [], time.monotonic(), report.commit()
        self.load = os.getloadavg()[0]
        os.makedirs(options.out, exist_ok=True)
        self.folder = tempfile.mkdtemp(prefix='thesis-', dir=options.scratch)
        self.data = data.Data(os.path.abspath(options.brio), self.folder, options.shrink)
        self.surfaces = surfaces.Surfaces(os.path.abspath(options.brio), self.folder)
        self.cgal = os.path.abspath(f'{options.peers}/cgal_hierarchy')

    def close(self):
        self.data.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def command(self, r):
        if r.locate == 'CGAL': return [self.cgal, self.data.raw(r.set, r.order)]
        points = self.data.points(r.set)
        return [os.path.abspath(self.options.brio), 'delaunay', self.data.path(r.set), '--json', '--threads', '1',
                '--order', r.order, '--locate', r.locate, *r.options, *(
                    [] if r.share or '--rounds' in r.options else ['--record-every', str(max(1, points // 40))])]

    def without_limit(self, name, locate):
        """What a BRIO takes without a limit."""
        if (name, locate) not in self.free:
            r = figures.hull('', name, 'brio-octree') if locate == 'history' else figures.run('', name, 'brio-octree', locate)
            self.measure(r, None, self.seconds_left())
        return self.free.get((name, locate))

    def memory(self, r):
        """Bytes of a run: its share of the peak without a limit, or what it names."""
        share, locate = r.share if isinstance(r.share, tuple) else (r.share, r.locate)
        if not share or share > 1: return share
        free = self.without_limit(r.set, locate)
        return free and max(LEAST_MEMORY, int(share * free['peak_bytes']))

    def minutes(self):
        return (time.monotonic() - self.begin) / 60

    def seconds_left(self):
        return 60 * (self.options.minutes - self.minutes())

    def most_seconds(self, r, memory, results, first):
        """When a run is stopped: by its clock, or by the first limited run of its figure, seconds a point."""
        most = self.seconds_left()
        if r.clock in results:
            clock = results[r.clock]
            most = min(most, 10 + 1.2 * verdicts.FINISHES * clock['wall'] / clock['points'] * self.data.points(r.set))
        elif memory:
            free = None if first else self.without_limit(r.set, r.locate)
            if free: first = 3 * free['wall'] / free['points']
            most = min(most, max(20, self.options.patience * (first or 0) * self.data.points(r.set)))
        return most

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
            if r.locate == 'CGAL': self.library = facts['library'].partition('-')[2]
            counts = {**facts, **facts['internals']}
            result.update({k: counts[k] for k in COLUMNS if k in counts}, rounds=facts.get('rounds', []), caches=facts.get('caches', []))
            result.update(order=facts['seconds']['order'], insert=facts['seconds']['insert'], reached=100,
                          wall=facts['seconds']['read'] + facts['seconds']['order'] + facts['seconds']['insert'])
            if not memory and r.order.startswith('brio'): self.free[r.set, r.locate] = result
            if result['rounds']: result['curve'] = [(x['points'], x['seconds']) for x in result['rounds']]
        return result

    def possible(self, f, r, results):
        """Whether a run can be made, and would tell something."""
        if f.kind in ('surfaces', 'plane'): return True
        if r.locate == 'CGAL' and not os.path.exists(self.cgal): return False
        if r.share and self.no_limits: return False
        if r.needs and results.get(r.needs, {}).get('status') != 'done': return False
        if self.seconds_left() > 10: return True
        self.left_out.append(f'{f.name}: {r.label}')
        return False

    def surface(self, f, r, results):
        """A run of chapter 3, where its data are there."""
        result = self.surfaces.measure(r)
        if not result: return
        results[r.label] = result
        told = 'right' if result['right'] else result['status']
        print(f'{f.name:14} {r.label:28} {result["points"]:>9} points  {told}', flush=True)

    def figure(self, f, write):
        """label: result of each run of a figure."""
        results, first = {}, None
        for r in f.runs:
            if not self.possible(f, r, results): continue
            if f.kind in ('surfaces', 'plane'):
                self.surface(f, r, results)
                continue
            memory = self.memory(r)
            if r.share and not memory: continue
            result = self.measure(r, memory, self.most_seconds(r, memory, results, first))
            free = self.free.get((r.set, r.locate))
            result['needed'] = free['peak_bytes'] if free else ''
            if memory and result['status'] == 'done': first = first or result['wall'] / result['points']
            write(f, r, result)
            results[r.label] = result
            print(f'{f.name:14} {r.label:18} {result["points"]:>9} points  {result["status"]:8} {result["wall"]:8.1f} s',
                  flush=True)
        return results


def main():
    o = options_of_call()
    if o.again: return report.publish(o.report, report.kept(os.path.splitext(o.report)[0] + '.json'), None)
    before = report.kept(os.path.splitext(o.report)[0] + '.json') if o.keep else None
    bench = Bench(o)
    plot.clear(o.out)
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

            for f in figures.figures(2000000 // o.shrink, o.memory, o.copies, o.headline):
                if o.only and f.name not in o.only:
                    if o.report: found.append((f, {}))  # the page has all figures
                    continue
                found.append((f, bench.figure(f, write)))
                plot.draw(*found[-1], o.out)
                if f.kind in ('surfaces', 'plane'): pictures.draw(f.name, bench.surfaces, plot.path(f, o.out))
                report.write(f'{o.out}/thesis-experiments.md', report.facts(bench, found), '')
        if o.report:
            facts = report.facts(bench, found)
            if before: facts = report.with_earlier(facts, before, o.only or [])
            report.publish(o.report, facts, o.out)
    finally:
        bench.close()


main()
