#!/usr/bin/python3
"""Faces that run through each other, before and after smoothing and simplifying: of samples of the shared models and of scans.

    crossings.py BRIO [--every N] [--scans NAME,...] [--only NAME ...]      a line for each set, and sums
    crossings.py BRIO --of REPORT IN OUT        a program for the judge of open scans: a line of REPORT for the points IN

Each way makes a surface of the points and counts the pairs of faces that cross, exactly (brio check --self-intersections). The
first way moves no point. Simplified surfaces are also measured against the number of faces that was asked for."""
import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile

import corpus
import open_scans
import ply
import sampling
from shared_sets import SHARED

WAYS = {'as it is': ['--noise', 'keep'], 'smoothed': ['--noise', 'smooth'], 'by default': [], 'simplified': ['--simplify'],
        'crust': ['--method', 'power-crust', '--triangulate'], 'crust, simplified': ['--method', 'power-crust', '--simplify']}
SAMPLINGS = ['even', 'noisy']
SHARE = 0.1 # of its faces that a surface is asked to have


def facts_of(brio, *arguments):
    done = subprocess.run([brio, *arguments, '--json', '--quiet'], capture_output=True, text=True)
    return json.loads(done.stdout) if done.returncode in (0, corpus.NOT_SOUND) and done.stdout else {}


def examine(brio, points, mesh):
    """Pairs of crossing faces for each way, and for a tenth of the default's faces; and by how much that number is missed."""
    found = {}
    for way, options in WAYS.items():
        facts = facts_of(brio, 'surface', points, '-o', mesh, '--self-intersections', *options)
        found[way] = facts.get('certificate', {}).get('self_intersections')
        if way == 'by default' and facts:
            wanted = int(SHARE * facts['faces'])
            fewer = facts_of(brio, 'simplify', mesh, '--faces', str(wanted), '-o', mesh + '.few.ply')
            found['a tenth'] = facts_of(brio, 'check', mesh + '.few.ply', '--self-intersections', '--open')['certificate']['self_intersections']
            found['beside the number'] = abs(fewer['faces'] - wanted) / wanted
    return found


def of_judge(brio, report, source, out):
    found = examine(brio, source, out)
    shutil.copyfile(out + '.few.ply', out)
    with open(report, 'a', encoding='utf-8') as f:
        print(json.dumps({'set': os.path.basename(source)[:-len('-points.ply')], **found}), file=f)


def samples(options, folder):
    """The samples of each model that is taken: a name and a file."""
    models = corpus.models_of('corpus', os.path.join(SHARED, 'data', 'corpus'), options.only)
    for model in models[::options.every]:
        points, triangles = ply.read_mesh(model.path)
        for way in SAMPLINGS:
            path = os.path.join(folder, 'points.ply')
            ply.write_points(path, sampling.sample(model.name, way, points, triangles).points)
            yield '%s-%s' % (model.name, way), path


def scans(options, folder):
    """What is found of the scans, as the judge makes them."""
    report = os.path.join(folder, 'report')
    command = ' '.join([sys.executable, os.path.abspath(__file__), options.brio, '--of', report, 'IN', 'OUT'])
    subprocess.run(['/usr/bin/python3', open_scans.JUDGE, '--command', command, '--scans', options.scans, '--every',
                    str(options.every), '--only', ','.join(options.only or [])], check=True, stdout=subprocess.DEVNULL)
    with open(report, encoding='utf-8') as f:
        return [json.loads(line) for line in f]


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('brio', type=os.path.abspath)
    parser.add_argument('--of', nargs=3, metavar=('REPORT', 'IN', 'OUT'))
    parser.add_argument('--every', type=int, default=4, help='models to take: every N-th')
    parser.add_argument('--scans', default=','.join(open_scans.SCANS))
    parser.add_argument('--only', nargs='+', metavar='NAME')
    return parser.parse_args()


def main():
    options = read_arguments()
    if options.of:
        of_judge(options.brio, *options.of)
        return 0
    rows = []
    with tempfile.TemporaryDirectory(prefix='brio-crossings-') as folder:
        for name, path in samples(options, folder):
            rows.append({'set': name, **examine(options.brio, path, os.path.join(folder, 'mesh.ply'))})
            print(json.dumps(rows[-1]), flush=True)
        if options.scans:
            rows += scans(options, folder)
    for way in [*WAYS, 'a tenth']:
        counts = [row[way] for row in rows if row.get(way) is not None]
        print('%-18s %d sets, %d of them with crossings, %d pairs' % (way, len(counts), sum(c > 0 for c in counts), sum(counts)))
    off = [row['beside the number'] for row in rows if 'beside the number' in row]
    print('a tenth of the faces: missed by at most %.2f %%, by over 1 %% in %d of %d' % (100 * max(off), sum(x > 0.01 for x in off), len(off)))
    return 0


if __name__ == '__main__':
    sys.exit(main())
