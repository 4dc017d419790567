"""The report: each claim of the thesis beside what was found here."""
import os
import platform
import subprocess


def _machine():
    model = platform.machine()
    if os.path.exists('/proc/cpuinfo'):
        with open('/proc/cpuinfo') as f:
            model = next((line.split(':', 1)[1].strip() for line in f if line.startswith('model name')), model)
    return model


def _commit():
    here = os.path.dirname(os.path.abspath(__file__))
    command = ['git', '-C', here, 'describe', '--always', '--dirty']
    return subprocess.run(command, capture_output=True, text=True).stdout.strip() or 'unknown'


def _row(label, r):
    memory = f'{r["memory"] / 2**20:.0f}' if r['memory'] else ''
    wall = f'{r["wall"]:.1f}' + ('' if r['status'] == 'done' else f' ({r["status"]} at {r["reached"]} %)')
    numbers = [f'{r[k]:,}' if k in r and r[k] != '' else '' for k in ('tetrahedra', 'created', 'destroyed', 'history')]
    return f'| {label} | {r["points"]:,} | {memory} | {wall} | ' + ' | '.join(numbers) + ' |\n'


def write(path, found, options, no_limits):
    with open(path, 'w') as f:
        f.write('# The experiments of the thesis\n\n'
                'Written by `make thesis` (bench/thesis): chapters 4 and 5 of [Choi 2003] with the strategies of this\n'
                'program in place of the programs that were compared there: hull is `--locate history`, CGAL `hierarchy`,\n'
                'pyramid `jump`, its simplified form `walk`; BRIO is `brio-octree` (`brio` in the last three), pure\n'
                'locality `octree`. One thread; seconds of reading, order and insertion, the sort of the result included.\n'
                'Memory is held by a memory cgroup, which counts the pages of scratch and input files; MiB in the tables.\n\n')
        f.write(f'{_machine()}, commit {_commit()}, every {options.shrink}th point, at most {options.limit:g} s a run.\n')
        if no_limits: f.write(f'\nFigures with little memory were left out: {no_limits}.\n')
        f.write('\n| figure | claim | here |\n|---|---|---|\n')
        verdicts = {g.name: g.verdict(results) if results else (None, 'left out') for g, results in found}
        words = {True: 'holds', False: 'does not hold', None: 'not shown'}
        for g, _ in found: f.write(f'| {g.name} | {g.claim} | {words[verdicts[g.name][0]]} |\n')
        for g, results in found:
            f.write(f'\n## {g.name}: {g.title}\n\nThesis: {g.claim}\n\n')
            f.write(f'Here: **{words[verdicts[g.name][0]]}**. {verdicts[g.name][1]}.\n\n')
            if not results: continue
            f.write('| run | points | memory | seconds | tetrahedra | created | destroyed | history |\n'
                    '|---|---|---|---|---|---|---|---|\n')
            for label, r in results.items(): f.write(_row(label, r))
