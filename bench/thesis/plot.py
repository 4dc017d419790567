"""The plots, by gnuplot: one SVG a figure."""
import glob
import os
import shutil
import subprocess

HEAD = '''set terminal svg size 800,450 background "white" font "sans-serif,13"
set key outside right top Left reverse
set grid linecolor "#dddddd"
set xlabel "points inserted, thousands"
set title "{title}"
set ylabel "{y}"
'''
LOGARITHMIC = 'set logscale xy\n'  # sets from a hundred thousand points to tens of millions


def _columns(kind, r):
    """Curves of a run: (what it adds to the label, [(x, y)])."""
    if kind == 'tetrahedra': return [('', [(x['points'], x['tetrahedra'] / x['points']) for x in r['rounds']])]
    if kind == 'location':
        return [(', all', [(x['points'], x['seconds']) for x in r['rounds']]),
                (', location', [(x['points'], x['locate_seconds']) for x in r['rounds']])]
    if kind == 'history':
        return [('', [(x['points'], x['history']) for x in r['rounds']]),
                (', live', [(x['points'], x['tetrahedra']) for x in r['rounds']])]
    return [('' if r['status'] == 'done' else f' ({r["status"]})', r['curve'])]


def _script(figure, results, path):
    y = {'tetrahedra': 'tetrahedra a point', 'history': 'tetrahedra'}.get(figure.kind, 'seconds')
    blocks, curves = [], []
    for label, r in results.items():
        for more, points in _columns(figure.kind, r):
            if not points: continue
            n, name = len(blocks), f'$c{len(blocks)}'
            blocks.append(f'{name} << EOD\n' + ''.join(f'{a / 1e3} {b}\n' for a, b in points) + 'EOD\n')
            curves.append(f'{name} using 1:2 with lines linewidth 2 linetype {n % 8 + 1} '
                          f'dashtype {n // 8 + 1} title "{label}{more}"')
    if not curves: return ''
    head = HEAD.format(title=f'{figure.name}: {figure.title}', y=y) + (LOGARITHMIC if figure.name == 'headline' else '')
    return head + ''.join(blocks) + \
        f'set output "{path}"\nplot ' + ', '.join(curves) + '\n'


def clear(folder):
    """Removes the plots of an earlier call, which a report would take for its own."""
    for old in glob.glob(f'{folder}/figure-*.svg') + glob.glob(f'{folder}/figure-*.png'): os.remove(old)


def path(figure, folder): return f'{folder}/figure-{figure.name}.{"png" if figure.kind == "surfaces" else "svg"}'


def draw(figure, results, folder):
    if figure.kind in ('table', 'pages', 'none', 'surfaces', 'plane'): return
    script = _script(figure, results, path(figure, folder))
    if script and shutil.which('gnuplot'): subprocess.run(['gnuplot'], input=script.encode(), check=True)
