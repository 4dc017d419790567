"""The report: each claim of the thesis beside what was found here. It is made of results that are kept beside it, so that a
change of a sentence, or of a verdict, needs no new runs, and so that a test can tell whether it is what would be written."""
import json
import os
import platform
import shutil
import subprocess
import figures
import plot
from verdicts import (ABOUT, FINISHES, LINEAR, LOCATION, NEARLY, NOISE, SLIGHTLY, SLOWER, TENTH, WASTED)


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

Written by `make thesis` (bench/thesis): chapters 3 to 5 of [Choi 2003].

The first sections are chapter 3: surfaces of samples whose truth is known, from formulas and from `brio generate solid`, and
of the models beside the project where they are there (`shared`). The labels of the poles are the greedy ones unless said.
Distances are in spacings, the mean distance of a sample from the next one: both ways, and on the foot and the shell, of which
only a part was sampled, from the surface. The crust of [2, 4] and the choice of samples of the robust co-cone are written for
the bench (baselines.py). The samples of the thesis are not public; those of figures 3.1 to 3.12 are replaced.

The other sections are chapters 4 and 5 with the strategies of this program in place of the programs that were compared there.
hull is `--locate history --first-conflict`, CGAL `hierarchy`, pyramid `jump`, its simplified form `walk`; a BRIO is `--order
brio-octree`, pure locality `octree`; the headline and the sections on an eighth of the memory take the tuned `brio`. Each run
has one thread. Times are seconds of reading, order and insertion, the sort of the result included.

Sections whose names end with CGAL run CGAL {cgal} itself, with its hierarchy, one insertion after the other; its vertices and
cells are in a scratch file, too. What differs still: hull and pyramid had storage of their own, here they share one;
iso-surfaces are those of marching tetrahedra, which have more vertices than those of marching cubes, so the level of detail is
chosen for the number of points; the raw scan of happy has 1,099,005 points here, 2,643,633 there, that of the dragon 469,193,
1.7 million there.

Memory is held by a memory cgroup, which counts the pages of scratch and input files too; arrays are in scratch files
then. Limits are shares of what the same work takes without one. A run is stopped after {patience:g} times the first
limited run of its figure, in the headline at {finishes} times its time without a limit, beyond which it does not count as
finished. *Not shown* is what was stopped, or left out, too early to tell.

The sections on page faults need no cgroup: the program counts the pages of its points, tetrahedra and history that an
insertion touches, {page} bytes each, in a cache that drops the page least recently used. These counts are the same on every
machine.

Rules of the verdicts: growth is linear when the time a point differs by {linear:g} times at most, near-linear up to
{nearly:g} times. A run thrashes from where a point takes {slower} times what one took early on; a run that was stopped does
not thrash by that alone. "About" is within {about:.0%}, "a tenth of the points" between {tenth[0]:.0%} and {tenth[1]:.0%}, "slightly"
by {slightly:g} times at most; ratios under {noise:g} say nothing. A search is wasted that saves at most {wasted:.0%} of the
steps. A share of the time from {location[0]:.0%} to {location[1]:.0%} is significant, but not overwhelming. Sizes differ from
the thesis': each section names both, as far as the thesis says them.

{machine}, {cores} cores, commit {commit}; {size}; {minutes:.0f} minutes in all. The load was {load:.1f} when it began: over the number of
cores, the machine had other work, and times say little.{earlier}
'''
EARLIER = '''

Of an earlier run, of commit {commit}, {minutes:.0f} minutes at a load of {load:.1f} when it began, are {figures}.'''


def facts(bench, found):
    """All that a report is made of, as JSON can hold it."""
    o = bench.options
    return {'machine': _machine(), 'cores': os.cpu_count(), 'load': bench.load, 'commit': bench.commit, 'shrink': o.shrink, 'memory': o.memory, 'copies': o.copies,
            'headline': o.headline, 'patience': o.patience, 'minutes': round(bench.minutes()), 'no_limits': bench.no_limits,
            'left_out': bench.left_out, 'cgal': bench.library, 'plots': [f.name for f, _ in found if os.path.exists(plot.path(f, o.out))],
            'figures': {f.name: {k: _slim(r) for k, r in results.items()} for f, results in found}}


ROUND = ('points', 'tetrahedra', 'seconds', 'locate_seconds', 'history', 'pages')


def _slim(r):
    """A result without what no verdict and no table asks for; curves of at most 100 points."""
    kept = dict(r)
    if 'curve' not in r: return {k: round(v, 4) if isinstance(v, float) else v for k, v in kept.items()}
    every = len(r['rounds']) // 60 + 1
    kept['rounds'] = [{k: x[k] for k in ROUND if k in x} for x in r['rounds'][::every]]
    every = len(r['curve']) // 100 + 1
    kept['curve'] = [[p, round(s, 3)] for p, s in r['curve'][:-1:every] + r['curve'][-1:]]
    return kept


def with_earlier(facts, before, names):
    """The results of a run, and of an earlier one those of the figures that it left out."""
    figures_ = {name: results or (before['figures'].get(name, {}) if name not in names else {}) for name, results in facts['figures'].items()}
    taken = [name for name, results in figures_.items() if results and not facts['figures'][name]]
    facts = {**facts, 'figures': figures_, 'left_out': [x for x in facts['left_out'] if x.partition(':')[0] not in taken]}
    facts['plots'] = [name for name in figures_ if name in facts['plots'] or (name in taken and name in before['plots'])]
    older = [{**e, 'figures': [n for n in e['figures'] if n in taken]} for e in before.get('earlier', [])]
    named = [n for e in older for n in e['figures']]
    one = {'figures': [n for n in taken if n not in named], **{k: before[k] for k in ('commit', 'minutes', 'load')}}
    facts['earlier'] = [e for e in [*older, one] if e['figures']]
    return facts


def figures_of(facts):
    return figures.figures(2000000 // facts['shrink'], facts['memory'], facts['copies'], facts['headline'])


def _row(label, r):
    memory = f'{r["memory"] / 2**20:.0f}' if r['memory'] else ''
    wall = f'{r["wall"]:.1f}' + ('' if r['status'] == 'done' else f' ({r["status"]} at {r["reached"]} %)')
    numbers = [f'{r[k]:,}' if k in r and r[k] != '' else '' for k in ('tetrahedra', 'created', 'destroyed', 'history')]
    numbers.append(f'{r["history_tests"] / r["vertices"]:.1f}' if r.get('history_tests') else '')
    return f'| {label} | {r["points"]:,} | {memory} | {wall} | ' + ' | '.join(numbers) + ' |\n'


TABLE = ('\n| run | points | memory, MiB | seconds | tetrahedra | created | destroyed | history | tests in it a point |\n'
         '|---|--:|--:|--:|--:|--:|--:|--:|--:|\n')
SHARES = (2, 4, 8, 16, 32)


def _page_row(label, r):
    """Faults a point in caches of the largest powers of two within shares of the pages."""
    each = []
    for share in SHARES:
        fit = [c['page_faults'] for c in r['caches'] if c['cache_pages'] * share <= r['pages']]
        each.append(f'{fit[-1] / r["points"]:.2f}')
    return f'| {label} | {r["points"]:,} | {r["pages"]:,} | {r["page_touches"] / r["points"]:.0f} | ' + ' | '.join(each) + ' |\n'


PAGES = ('\n| run | points | pages | touches a point | ' + ' | '.join(f'faults in 1/{s}' for s in SHARES) + ' |\n'
         '|---|--:|--:|--:|' + '--:|' * len(SHARES) + '\n')


def _surface_row(label, r):
    """A run of chapter 3: what the surface is, and what it should be."""
    def number(key, form=','): return format(r[key], form) if key in r else ''
    sound = r.get('closed') and r.get('manifold') and r.get('oriented')
    handles = number('genus') if sound else '' if r['status'] != 'done' or 'closed' not in r else 'not closed' if not r['closed'] else 'not a manifold'
    return f'| {label} | {r["points"]:,} | {r["true_genus"]} | {handles or r["status"]} | {number("components")} | {number("faces")} | ' \
        f'{number("boundary_edges")} | {number("nonmanifold_edges")} | {number("mean", ".3f")} | {number("farthest", ".2f")} |\n'


SURFACES = ('\n| run | points | true genus | genus | parts | faces | edges of one face | of three or more | mean distance | farthest |\n'
            '|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n')


def _thesis_size(name):
    """Points of the thesis' set that stands behind one of ours, or None."""
    kind, _, number = name.partition('-')
    if kind == 'happy': return int(number) * 2643633
    return {'dragon': 1700000, 'mtd': 185000, 'b1': 525296, 'b2': 2000000}.get(kind)


def _sizes(g, results):
    """Points of each set of a figure, in the thesis and here."""
    sizes = {r.set: results[r.label]['points'] for r in g.runs if r.label in results}
    words = [f'{name} {here:,} points, in the thesis {_thesis_size(name):,}' for name, here in sizes.items()
             if _thesis_size(name)]
    return f'\nSizes: {"; ".join(words)}.\n' if words and g.whose == 'Thesis' else ''


def verdict_of(g, results):
    return g.verdict(results) if results else (None, 'Left out')


def earlier(facts):
    return ''.join(EARLIER.format(**{**e, 'figures': ', '.join(e['figures'])}) for e in facts.get('earlier', []))


def _section(f, g, results, plots, images):
    holds, words = verdict_of(g, results)
    f.write(f'\n## {g.name}: {g.title}\n\n{g.whose}: {g.claim}\n\nHere: **{WORDS[holds]}**. {words}.\n')
    if not results: return
    f.write(_sizes(g, results))
    if g.kind == 'pages':
        f.write(PAGES)
        for label, r in results.items():
            if r['status'] == 'done': f.write(_page_row(label, r))
    elif g.kind == 'surfaces':
        f.write(SURFACES)
        for label, r in results.items(): f.write(_surface_row(label, r))
    elif g.kind == 'plane':
        f.write('\n| curve | samples | links | found | of them true | Euler characteristic | true |\n|---|--:|--:|--:|--:|--:|--:|\n')
        for label, r in results.items():
            f.write(f'| {label} | ' + ' | '.join(str(r.get(k, '')) for k in ('points', 'links', 'found', 'common', 'euler', 'true_euler')) + ' |\n')
    elif g.kind != 'none':
        f.write(TABLE)
        for label, r in results.items(): f.write(_row(label, r))
    if g.name in plots: f.write(f'\n![{g.title}]({images}{os.path.basename(plot.path(g, images))})\n')


def write(path, facts, images):
    """The report, with its plots in a folder beside it: images, '' or 'folder/'."""
    found = [(g, facts['figures'][g.name]) for g in figures_of(facts) if g.name in facts['figures']]
    with open(path, 'w') as f:
        size = 'all points' if facts['shrink'] == 1 else f'every {facts["shrink"]}th point'
        f.write(HEAD.format(patience=facts['patience'], finishes=FINISHES, linear=LINEAR, nearly=NEARLY, slower=SLOWER, about=ABOUT,
                            tenth=TENTH, slightly=SLIGHTLY, noise=NOISE, wasted=WASTED, location=LOCATION, page=figures.PAGE,
                            size=size, earlier=earlier(facts), cgal=facts['cgal'] or '(left out: not installed)', **{k: facts[k] for k in ('machine', 'cores', 'load', 'commit', 'minutes')}))
        if facts['no_limits']: f.write(f'\nRuns with little memory were left out: {facts["no_limits"]}.\n')
        if facts['left_out']: f.write(f'\nLeft out, the time being over: {"; ".join(facts["left_out"])}.\n')
        f.write('\n| figure | claim | here |\n|---|---|---|\n')
        for g, results in found:
            whose = '' if g.whose == 'Thesis' else g.whose + ': '
            f.write(f'| {g.name} | {whose}{g.claim} | {WORDS[verdict_of(g, results)[0]]} |\n')
        for g, results in found: _section(f, g, results, facts['plots'], images)


def keep(path, facts):
    """Results a line a run, which shows what a new run changed."""
    head = {k: v for k, v in facts.items() if k != 'figures'}
    with open(path, 'w') as f:
        f.write(json.dumps(head)[:-1] + ', "figures": {\n')
        f.write(',\n'.join(f'{json.dumps(name)}: {{\n' + ',\n'.join(
            f'{json.dumps(label)}: {json.dumps(r)}' for label, r in results.items()) + '}'
            for name, results in facts['figures'].items()))
        f.write('}}\n')


def kept(path):
    with open(path) as f: return json.load(f)


def publish(path, facts, drawn):
    """The report elsewhere, with its results beside it and the plots, from the folder `drawn` if there is one, in
    images/thesis."""
    folder = os.path.join(os.path.dirname(path) or '.', 'images', 'thesis')
    if drawn:
        os.makedirs(folder, exist_ok=True)
        wanted = {os.path.basename(plot.path(g, folder)) for g in figures_of(facts) if g.name in facts['plots']}
        for old in os.listdir(folder):
            if old not in wanted: os.remove(os.path.join(folder, old))
        for g in figures_of(facts):
            if os.path.exists(plot.path(g, drawn)): shutil.copy(plot.path(g, drawn), folder)
        keep(os.path.splitext(path)[0] + '.json', facts)
    write(path, facts, 'images/thesis/')
