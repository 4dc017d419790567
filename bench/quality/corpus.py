"""Runs methods on samples of closed models of known topology, and judges their surfaces.

A folder of models has MODELS.tsv (model, vertices, faces, components, genus) and a PLY file each. Every model is sampled
(sampling.py), every method makes a surface of the samples, `brio check` tells its topology and `brio compare` its distance
from the model. A run is right if the surface is closed, manifold and oriented, with the components of the model, and as many
handles in all. Poisson reconstruction is a program of its own (poisson.py), and gets normals: the true ones, or
its own estimate. All others get points alone. All run on one thread; seconds are those of the processor."""
import collections
import concurrent.futures
import csv
import json
import os
import resource
import subprocess
import sys
import tempfile

import ply
import sampling
from thickness import Thickness

HERE = os.path.dirname(os.path.abspath(__file__))
BRIO_METHODS = {'labeled Delaunay': ['--method', 'labeled-delaunay'], 'power crust': ['--method', 'power-crust'],
                'power crust, greedy': ['--method', 'power-crust', '--labeling', 'greedy'],
                'tight co-cone': ['--method', 'tight-cocone']}
POISSON_METHODS = {'Poisson, true normals': 'given', 'Poisson, estimated normals': 'estimated'}
METHODS = [*BRIO_METHODS, *POISSON_METHODS]
COLUMNS = ['corpus', 'model', 'sampling', 'method', 'points', 'thinnest', 'crossings', 'sound', 'components',
           'true_components', 'genus', 'true_genus', 'right', 'chamfer', 'normals', 'seconds']
KEY = COLUMNS[:4]
PATIENCE = 600          # seconds for a program
POINTS_COMPARED = 20000 # on each surface, by brio compare
NOT_SOUND = 5           # exit status of brio check

Model = collections.namedtuple('Model', 'corpus name path components genus')
# brio: the program. poisson: the Python that has PyMeshLab, or None.
Programs = collections.namedtuple('Programs', 'brio poisson')


# --- what there is ---

def models_of(corpus, folder, only):
    with open(os.path.join(folder, 'MODELS.tsv'), newline='', encoding='utf-8') as f:
        rows = list(csv.DictReader(f, delimiter='\t'))
    return [Model(corpus, row['model'], os.path.join(folder, row['model'] + '.ply'), int(row['components']), int(row['genus']))
            for row in rows if not only or row['model'] in only]


def missing_poisson(python):
    """The reason why there is no Poisson reconstruction, or None."""
    if not os.path.exists(python):
        return 'no ' + python
    done = subprocess.run([python, '-c', 'import pymeshlab'], capture_output=True, text=True)
    return '%s has no PyMeshLab' % python if done.returncode else None


# --- a run ---

def run(command):
    """The facts that a program prints as JSON, or None if it failed or took too long; and its processor time."""
    def used():
        u = resource.getrusage(resource.RUSAGE_CHILDREN)
        return u.ru_utime + u.ru_stime
    begin = used()
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors='replace', timeout=PATIENCE,
                              env={**os.environ, 'OMP_NUM_THREADS': '1'})
    except subprocess.TimeoutExpired:
        return None, used() - begin
    return json.loads(done.stdout) if done.returncode in (0, NOT_SOUND) and done.stdout else None, used() - begin


def reconstruct(programs, method, points, mesh):
    """Makes the surface; returns its seconds, or None if there is no surface."""
    if method in BRIO_METHODS:
        facts, seconds = run([programs.brio, 'surface', points, '-o', mesh, '--json', '--quiet', '--threads', '1',
                              *BRIO_METHODS[method]])
        return seconds if facts else None
    facts, _ = run([programs.poisson, os.path.join(HERE, 'poisson.py'), points, mesh, '--normals', POISSON_METHODS[method]])
    return facts['seconds'] if facts else None


def judge(brio, model, mesh):
    """The columns that tell what a surface is worth."""
    checked, _ = run([brio, 'check', mesh, '--json', '--quiet'])
    compared, _ = run([brio, 'compare', mesh, model.path, '--json', '--quiet', '--threads', '1',
                       '--samples', str(POINTS_COMPARED)])
    found = {}
    if checked:
        c = checked['certificate']
        sound = c['closed'] and c['manifold'] and c['oriented']
        found.update(sound=int(sound), components=c['components'], genus=c['genus'] if sound else '-',
                     right=int(sound and (c['components'], c['genus']) == (model.components, model.genus)))
    if compared:
        found.update(chamfer='%.4f' % compared['percent_of_diagonal']['mean'],
                     normals='%.4f' % compared['normal_consistency'])
    return found


def rows_of_samples(programs, model, methods, common, points):
    for method in methods:
        row = dict({column: '-' for column in COLUMNS}, **common, method=method, sound=0, right=0)
        mesh = points + '.surface.ply'
        seconds = reconstruct(programs, method, points, mesh)
        if seconds is not None:
            row.update(judge(programs.brio, model, mesh), seconds='%.2f' % seconds)
            os.remove(mesh)
        yield {column: str(value) for column, value in row.items()}


def examine(programs, model, samplings, methods):
    """The rows of a model. Each process examines one model at a time: processor time is that of its children."""
    points, triangles = ply.read_mesh(model.path)
    crossings = run([programs.brio, 'check', model.path, '--self-intersections', '--json', '--quiet'])[0]
    thickness, rows = Thickness(points, triangles), []
    with tempfile.TemporaryDirectory(prefix='brio-quality-') as folder:
        for way in samplings:
            samples = sampling.sample(model.name, way, points, triangles)
            if samples is None:
                continue
            path = os.path.join(folder, way + '.ply')
            ply.write_points(path, samples.points, samples.normals)
            common = dict(corpus=model.corpus, model=model.name, sampling=way, points=len(samples.points),
                          thinnest='%.2f' % thickness.thinnest(samples),
                          true_components=model.components, true_genus=model.genus,
                          crossings=crossings['certificate']['self_intersections'] if crossings else '-')
            rows += rows_of_samples(programs, model, methods, common, path)
    return rows


def run_all(programs, models, samplings, methods, processes):
    """Yields the rows of each model as it is done."""
    with concurrent.futures.ProcessPoolExecutor(processes) as pool:
        jobs = [pool.submit(examine, programs, model, samplings, methods) for model in models]
        for count, job in enumerate(concurrent.futures.as_completed(jobs), 1):
            rows = job.result()
            right = sum(row['right'] == '1' for row in rows)
            name = rows[0]['model'] if rows else 'no samples'
            print('%d of %d models: %s, right %d of %d' % (count, len(jobs), name, right, len(rows)), file=sys.stderr, flush=True)
            yield rows
