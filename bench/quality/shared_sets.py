"""What brio's surfaces of the shared data are worth, beside other programs' figures.

Every set is reconstructed by `brio surface`: the power crust with its defaults throughout, with --sharp where edges are
sharp; the default method, the labeled Delaunay triangulation, on models; the co-cones on models and scans. Surfaces of models
are judged by meshq.py, an independent program beside the data, the others by the certificate that brio prints."""
import collections
import concurrent.futures
import importlib.util
import json
import os
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
SHARED = os.environ.get('BRIO_SHARED', os.path.join(HERE, '..', '..', '..', 'shared'))
JUDGE = os.path.join(SHARED, 'tools', 'meshq.py')
PROCESSES = 2
NO_ANSWER = 3
COLUMNS = ['set', 'method', 'judge', 'answer', 'closed', 'manifold', 'flipped_edges', 'components', 'genus', 'faces',
           'chamfer', 'mean_to_truth', 'mean_from_truth', 'p95_to_truth', 'p95_from_truth', 'hausdorff',
           'normal_consistency']
METHODS = {'labeled Delaunay': ['--method', 'labeled-delaunay'],
           'power crust': ['--method', 'power-crust', '--polygons'],
           'power crust, sharp': ['--method', 'power-crust', '--polygons', '--sharp'], 'co-cone': ['--method', 'cocone'],
           'tight co-cone': ['--method', 'tight-cocone']}
SHARP = ['fandisk', 'mechpart']
WITH_TRUTH = ['bunny', 'rocker_arm', 'knot2', 'mechpart', 'fandisk', 'bracket', 'cheese', 'armadillo', 'club']
TRUTH = dict({name: name for name in WITH_TRUTH}, anchor_scan='anchor_truth')
# genera of the components of the true surface
TRUE_TOPOLOGY = {'bunny': '0', 'rocker_arm': '1', 'knot2': '1 + 1', 'mechpart': '3', 'fandisk': '0', 'bracket': '3',
                 'cheese': '133', 'anchor_scan': '4', 'armadillo': '0', 'club': 'open'}

Rival = collections.namedtuple('Rival', 'topology chamfer normals')
# The figures of data/README.md, by the same judge; the original's options there are those of its defaults.
ORIGINAL = {
    'bunny': Rival('0', '0.0553', '.9949'), 'rocker_arm': Rival('1, 9 to 16 flipped', '0.0602', '.9942'),
    'mechpart': Rival('2 components, 4 in all, 417 flipped', '0.0648', '.9891'),
    'fandisk': Rival('0, 8,055 flipped', '0.0600', '.9896'), 'bracket': Rival('5 or 6', '1.2 to 1.3', ''),
    'cheese': Rival('2 to 7 components, 110 to 128 in all', '0.76 to 0.87', ''),
    'anchor_scan': Rival('4 components, 26 in all', '0.23', ''), 'knot2': Rival('1 + 1', '0.0665', '.9847'),
    'armadillo': Rival('1', '0.0496', '.9878'), 'club': Rival('closed over', '0.0480', '.9902')}
ADVANCING_FRONT = {
    'bunny': Rival('0', '0.0545', '.9962'), 'rocker_arm': Rival('1', '0.0552', '.9974'),
    'mechpart': Rival('3', '0.0688', '.9800'), 'fandisk': Rival('0', '0.0570', '.9954'),
    'bracket': Rival('678 boundary edges', '', ''), 'cheese': Rival('865 boundary edges', '', ''),
    'anchor_scan': Rival('43 components, 4,526 boundary edges', '0.23', ''), 'knot2': Rival('1 + 1', '0.0548', '.9925'),
    'armadillo': Rival('7 boundary edges', '0.0488', '.9897'), 'club': Rival('8 boundary edges', '0.0441', '.9901')}

Task = collections.namedtuple('Task', 'name path method')


# --- what is to be done ---

def tasks_of(only, wanted):
    """Each surface to make, folder by folder, and the sets in the order of their names."""
    tasks = []
    for folder in ['model', 'scan', 'lidar', 'hostile']:
        where = os.path.join(SHARED, 'data', folder)
        if not os.path.isdir(where):
            print('skipped: no folder', where)
            continue
        for file in sorted(os.listdir(where)):
            name = os.path.splitext(file)[0]
            if name == 'anchor_truth' or (only and name not in only): continue
            methods = [m for m in METHODS if m == 'power crust' or folder == 'model' or (folder == 'scan' and 'cone' in m)]
            tasks += [Task(f'{folder}/{name}', os.path.join(where, file), m) for m in methods
                      if (m != 'power crust, sharp' or name in SHARP) and (not wanted or m in wanted)]
    return tasks


def reason_to_skip():
    for path in [os.path.join(SHARED, 'data', 'model'), JUDGE]:
        if not os.path.exists(path): return 'the shared data are not there: ' + path
    for module in ['numpy', 'scipy']:
        if not importlib.util.find_spec(module): return f'the judge needs {module}, which {sys.executable} has not'
    return None


# --- doing it ---

def run(command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors='replace')
    return done.returncode, done.stdout, done.stderr.strip()


def certified(certificate):
    """The columns of topology, as brio's own certificate has them."""
    return {'judge': 'certificate', 'closed': int(certificate['closed']), 'manifold': int(certificate['manifold']),
            'flipped_edges': 0 if certificate['oriented'] else 'some', 'components': certificate['components'],
            'genus': certificate['genus'] if certificate['closed'] else '-'}


def judged(mesh, name):
    """The columns that the judge fills."""
    truth = [os.path.join(SHARED, 'data', 'model', TRUTH[name] + '.ply')] if name in TRUTH else []
    status, out, error = run([sys.executable, JUDGE, mesh] + truth)
    if status: raise RuntimeError(f'{name}: the judge failed: {error}')
    q = json.loads(out)
    row = {'judge': 'meshq', 'closed': int(q['watertight']),
           'manifold': int(q['nonmanifold_edges'] + q['nonmanifold_vertices'] == 0),
           'flipped_edges': q['flipped_edges'], 'components': q['components'],
           'genus': '-' if q['genus'] is None else q['genus']}
    if truth:
        row.update(chamfer=q['chamfer'], hausdorff=q['hausdorff'], normal_consistency=q['normal_consistency'])
        for way in ['to_truth', 'from_truth']:
            row.update({f'mean_{way}': q[way]['mean'], f'p95_{way}': q[way]['p95']})
    return {key: f'{value:.4f}' if isinstance(value, float) else value for key, value in row.items()}


def examine(brio, task):
    """One line of the CSV."""
    folder, name = task.name.split('/')
    row = dict({column: '-' for column in COLUMNS}, set=task.name, method=task.method)
    with tempfile.TemporaryDirectory(prefix='brio-quality-') as place:
        mesh = os.path.join(place, 'surface.ply')
        status, out, error = run([brio, 'surface', task.path, '-o', mesh, '--json', '--quiet'] + METHODS[task.method])
        if status == NO_ANSWER: return dict(row, answer='no inside')
        if status: raise RuntimeError(f'{task.name}: exit status {status}: {error}')
        facts = json.loads(out)
        found = judged(mesh, name) if folder == 'model' else certified(facts['certificate'])
        return dict(row, answer='surface', faces=facts['faces'], **found)


# --- the page ---

def topology_of(row):
    if row['answer'] != 'surface': return row['answer']
    words = [] if row['components'] in (1, '1') else [f"{row['components']} components"]
    words.append('open' if row['genus'] == '-' else f"{row['genus']}{' in all' if words else ''}")
    if row['flipped_edges'] not in (0, '0'): words.append(f"{row['flipped_edges']} flipped")
    if row['manifold'] not in (1, '1'): words.append('not manifold')
    return ', '.join(words)


def models_table(rows):
    of_set = collections.defaultdict(dict)
    for row in rows: of_set[row['set'].partition('/')[2]][row['method']] = row
    lines = ['| samples | true genus | program | genus | chamfer | p95 to, from | normals | faces |',
             '|---|---|---|---|---|---|---|---|']
    for name in TRUE_TOPOLOGY:
        true = TRUE_TOPOLOGY[name]
        for method, row in of_set[name].items():
            lines.append(f"| {name} | {true} | brio, {method} | {topology_of(row)} | {row['chamfer']} | "
                         f"{row['p95_to_truth']}, {row['p95_from_truth']} | {row['normal_consistency']} | {row['faces']} |")
        for program, figures in [('original power crust', ORIGINAL), ('CGAL advancing front', ADVANCING_FRONT)]:
            r = figures[name]
            lines.append(f'| {name} | {true} | {program} | {r.topology} | {r.chamfer} | | {r.normals} | |')
    return lines


def others_table(rows):
    lines = ['| set | program | closed | manifold | genus | faces |', '|---|---|---|---|---|---|']
    for row in rows:
        lines.append(f"| {row['set']} | brio, {row['method']} | {row['closed']} | {row['manifold']} | {topology_of(row)} "
                     f"| {row['faces']} |")
    return lines


def sections(rows):
    """The sections of the page, as text."""
    with_truth = [r for r in rows if r['set'].partition('/')[2] in TRUTH]
    hostile = [r for r in rows if r['set'].startswith('hostile/')]
    others = [r for r in rows if r not in with_truth and r not in hostile]
    surfaces = [r for r in hostile if r['answer'] == 'surface']
    sound = [r for r in surfaces if (str(r['closed']), str(r['manifold']), str(r['flipped_edges'])) == ('1', '1', '0')]
    return SECTIONS.format(models='\n'.join(models_table(with_truth)), others='\n'.join(others_table(others)),
                           hostile=len(hostile), surfaces=len(surfaces), sound=len(sound), none=len(hostile) - len(surfaces))


def run_all(brio, only, wanted):
    """Yields the row of each surface, in the order of the tasks."""
    with concurrent.futures.ThreadPoolExecutor(PROCESSES) as pool:
        for row in pool.map(lambda task: examine(brio, task), tasks_of(only, wanted)):
            print(f"{row['set']:36} {row['method']:20} {topology_of(row):32} chamfer {row['chamfer']}", flush=True)
            yield row


SECTIONS = '''## Models with a truth

Distances are in per cent of the diagonal of the truth's box, measured both ways: chamfer is the mean of both means, p95
the 95th percentile to and from the truth. Normals: mean |cos| between the normals at nearest points. Figures below the
distance of the samples that the judge spreads (800,000 on each surface) mean nothing. The other programs' figures are
those of the README beside the shared data: the same samples, the same judge.

{models}

## Sharp edges

![An edge of fandisk: the triangles of the model, the power crust without and with --sharp -R 0.4](images/sharp.png)

No sample of fandisk is on its edges, and the triangles of the model, the truth of the table, cut them off (left). So does
the power crust (middle), and the figures of the table are the better for it. With `--sharp -R 0.4` (right) the faces
beside an edge meet in it. Within 1.5 sample spacings of the edges, 9.0 % of the crust without it, 4.0 % with `--sharp`
and 2.9 % with `--sharp -R 0.4` have a normal more than 20 degrees off those of all faces beside the edge. On a cube with
3,000 random samples, none on the edges, the crust is 0.22, 0.11 and 0.03 spacings off the edges, on a hexagonal prism
0.18, 0.09 and 0.02. The samples of mechpart are on its edges: to discard more of them costs distance.

## Models without a truth, scans, lidar

Scans of open surfaces: the power crust and the tight co-cone close them, the co-cone leaves them open; what matters here
is that the result is sound.

{others}

## Hostile sets

{hostile} small point sets from bug trackers and test suites: duplicates, collinear, coplanar and cospherical points,
lattices, pairs 1e-13 apart, huge coordinates. {surfaces} have a surface, {sound} of them closed, manifold and
oriented; of {none} brio says that they have no inside (exit status 3).
'''
