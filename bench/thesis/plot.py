"""The plots, by gnuplot: one SVG a figure."""
import shutil
import subprocess

HEAD = '''set terminal svg size 700,450 background "white"
set key top left
set grid
set xlabel "points inserted"
set title "{title}"
set ylabel "{y}"
'''


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
            name = f'$c{len(blocks)}'
            blocks.append(f'{name} << EOD\n' + ''.join(f'{a} {b}\n' for a, b in points) + 'EOD\n')
            curves.append(f'{name} using 1:2 with lines linewidth 2 title "{label}{more}"')
    if not curves: return ''
    return HEAD.format(title=f'{figure.name}: {figure.title}', y=y) + ''.join(blocks) + \
        f'set output "{path}"\nplot ' + ', '.join(curves) + '\n'


def draw(found, folder):
    if not shutil.which('gnuplot'):
        print('gnuplot is not installed: no plots')
        return
    for figure, results in found:
        script = _script(figure, results, f'{folder}/figure-{figure.name}.svg')
        if script: subprocess.run(['gnuplot'], input=script.encode(), check=True)
