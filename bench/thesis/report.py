"""The report: each claim of the thesis beside what was found here."""
import os
import platform
import shutil
import subprocess
import plot
from verdicts import FINISHES, LINEAR, NEARLY


def _machine():
    model = platform.machine()
    if os.path.exists('/proc/cpuinfo'):
        with open('/proc/cpuinfo') as f:
            model = next((line.split(':', 1)[1].strip() for line in f if line.startswith('model name')), model)
    return model


def commit():
    here = os.path.dirname(os.path.abspath(__file__))
    command = ['git', '-C', here, 'describe', '--always', '--dirty']
    return subprocess.run(command, capture_output=True, text=True).stdout.strip() or 'unknown'


WORDS = {True: 'holds', False: 'does not hold', None: 'not shown'}
HEAD = '''# The experiments of the thesis

Written by `make thesis` (bench/thesis): chapters 4 and 5 of [Choi 2003] with the strategies of this program in place of
the programs that were compared there. hull is `--locate history
--all-conflicts`, CGAL `hierarchy`, pyramid `jump`, its simplified form `walk`; a BRIO is `--order brio-octree`, pure
locality `octree`; the first three sections take the tuned `brio`. Each run has one thread. Times are seconds of reading, order and insertion, the sort of the result included.

Memory is held by a memory cgroup, which counts the pages of scratch and input files too; arrays are in scratch files
then. Limits are shares of what the same work takes without one. A run is stopped after {patience:g} times the first
limited run of its figure, in the headline at {finishes} times its time without a limit, beyond which it does not count as
finished. *Not shown* is what was stopped, or left out, too early to tell; a run that was stopped after it had taken longer
than a claim asks for does tell.

Rules of the verdicts: growth is linear when the time a point differs by {linear:g} times at most, near-linear up to
{nearly:g} times. Sizes differ from the thesis': each section names both, as far as the thesis says them.

{machine}, commit {commit}; {size}; {minutes:.0f} minutes in all.
'''


def _row(label, r):
    memory = f'{r["memory"] / 2**20:.0f}' if r['memory'] else ''
    wall = f'{r["wall"]:.1f}' + ('' if r['status'] == 'done' else f' ({r["status"]} at {r["reached"]} %)')
    numbers = [f'{r[k]:,}' if k in r and r[k] != '' else '' for k in ('tetrahedra', 'created', 'destroyed', 'history')]
    return f'| {label} | {r["points"]:,} | {memory} | {wall} | ' + ' | '.join(numbers) + ' |\n'


def _thesis_size(name):
    """Points of the thesis' set that stands behind one of ours, or None."""
    kind, _, number = name.partition('-')
    if kind == 'happy': return int(number) * 2643633
    return {'mtd': 185000, 'b1': 525296}.get(kind)


def _sizes(g, results):
    """Points of each set of a figure, in the thesis and here."""
    sizes = {r.set: results[r.label]['points'] for r in g.runs if r.label in results}
    words = [f'{name} {here:,} points, in the thesis {_thesis_size(name):,}' for name, here in sizes.items()
             if _thesis_size(name)]
    return f'\nSizes: {"; ".join(words)}.\n' if words and g.whose == 'Thesis' else ''


def _section(f, g, results, verdict, images):
    holds, words = verdict
    f.write(f'\n## {g.name}: {g.title}\n\n{g.whose}: {g.claim}\n\nHere: **{WORDS[holds]}**. {words}.\n')
    if not results: return
    f.write(_sizes(g, results))
    f.write('\n| run | points | memory, MiB | seconds | tetrahedra | created | destroyed | history |\n'
            '|---|--:|--:|--:|--:|--:|--:|--:|\n')
    for label, r in results.items(): f.write(_row(label, r))
    if images is not None: f.write(f'\n![{g.title}]({images}figure-{g.name}.svg)\n')


def write(path, found, bench, images):
    """The report, with its plots in a folder beside it: images, '' or 'folder/'."""
    o = bench.options
    verdicts = {g.name: g.verdict(results) if results else (None, 'Left out') for g, results in found}
    with open(path, 'w') as f:
        size = 'all points' if o.shrink == 1 else f'every {o.shrink}th point'
        f.write(HEAD.format(patience=o.patience, finishes=FINISHES, linear=LINEAR, nearly=NEARLY, machine=_machine(), commit=bench.commit, size=size,
                            minutes=bench.minutes()))
        if bench.no_limits: f.write(f'\nRuns with little memory were left out: {bench.no_limits}.\n')
        if bench.left_out: f.write(f'\nLeft out, the time being over: {"; ".join(bench.left_out)}.\n')
        f.write('\n| figure | claim | here |\n|---|---|---|\n')
        for g, _ in found: f.write(f'| {g.name} | {"" if g.whose == "Thesis" else g.whose + ": "}{g.claim} | {WORDS[verdicts[g.name][0]]} |\n')
        for g, results in found:
            drawn = os.path.exists(plot.path(g, o.out))
            _section(f, g, results, verdicts[g.name], images if drawn else None)


def publish(path, found, bench):
    """The report elsewhere, with the plots in images/thesis beside it."""
    folder = os.path.join(os.path.dirname(path) or '.', 'images', 'thesis')
    os.makedirs(folder, exist_ok=True)
    for g, _ in found:
        if os.path.exists(plot.path(g, bench.options.out)): shutil.copy(plot.path(g, bench.options.out), folder)
    write(path, found, bench, 'images/thesis/')
