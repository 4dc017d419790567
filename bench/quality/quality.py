#!/usr/bin/python3
"""What the surfaces of brio are worth: makes docs/measured/quality.md, and the CSV files beside it that the page shows.

    quality.py BRIO DOCS [--parts PART ...] [--only NAME ...] [--methods NAME ...] [--samplings NAME ...]
               [--solids FOLDER] [--poisson PYTHON] [--processes N]
               [--rivals] [--scans NAME ...] [--evidence KIND ...] [--every N]

Parts:
  corpus  models of known topology beside the project, sampled in five ways: quality-corpus.csv
  solids  the same on generated solids with even seeds, which make_corpus.py makes first: quality-corpus.csv
  shared  the samples beside the project, and their judge: quality.csv
  scans   partial scans of these models, and their judge: quality-scans.csv (open_scans.py)
  page    nothing is measured; the page is written in any case
What is missing is skipped, and named. With --parts, --only, --methods or --samplings all other lines of the CSV files stay
as they are. After each model the corpus' lines are written: a run may be cut off, and the rest be measured with --only.

BRIO_SHARED is the folder beside the project (default: ../shared). PYTHON has PyMeshLab: scripts/setup.sh quality installs it in
out/quality-env. Everything but seconds is the same on every machine."""
import argparse
import csv
import os
import subprocess
import sys

import corpus
import corpus_tables
import open_scans
import shared_sets
from sampling import SAMPLINGS

HERE = os.path.dirname(os.path.abspath(__file__))
OUT = os.path.join(HERE, '..', '..', 'out')
PARTS = ['corpus', 'solids', 'shared', 'scans', 'page']
SEEDS = '1-120'  # 60 to judge by, half of each kind
# The vertices of generated solids are those of a grid: no sampling that anybody has.
SOLID_SAMPLINGS = [way for way in SAMPLINGS if way != 'vertices']


# --- the CSV files ---

def rows_of(path, key):
    if not os.path.exists(path):
        return {}
    with open(path, newline='', encoding='utf-8') as f:
        return {tuple(row[column] for column in key): row for row in csv.DictReader(f)}


def write_rows(path, columns, rows):
    with open(path + '.part', 'w', newline='', encoding='utf-8') as f:
        writer = csv.DictWriter(f, columns, lineterminator='\n')
        writer.writeheader()
        writer.writerows(rows)
    os.replace(path + '.part', path)


# --- the parts ---

def skip(what, reason):
    print('skipped: %s: %s' % (what, reason), flush=True)


def wanted_methods(options):
    """Those of the corpora: Poisson reconstruction where it is installed."""
    methods = [m for m in corpus.METHODS if not options.methods or m in options.methods]
    reason = corpus.missing_poisson(options.poisson) if set(methods) & set(corpus.POISSON_METHODS) else None
    if reason:
        skip('Poisson reconstruction', reason)
        methods = [m for m in methods if m not in corpus.POISSON_METHODS]
    return methods


def measure_corpus(options, name, folder, samplings):
    """Adds the rows of a folder of models to quality-corpus.csv, after each model."""
    path = os.path.join(options.docs, 'quality-corpus.csv')
    programs, done = corpus.Programs(options.brio, options.poisson), rows_of(path, corpus.KEY)
    samplings = [way for way in samplings if not options.samplings or way in options.samplings]
    models = corpus.models_of(name, folder, options.only)
    for rows in corpus.run_all(programs, models, samplings, wanted_methods(options), options.processes):
        done.update({tuple(row[column] for column in corpus.KEY): row for row in rows})
        write_rows(path, corpus.COLUMNS, [done[key] for key in sorted(done)])


def measure_shared_corpus(options):
    folder = os.path.join(shared_sets.SHARED, 'data', 'corpus')
    if not os.path.exists(os.path.join(folder, 'MODELS.tsv')):
        return skip('corpus', 'there is no ' + os.path.join(folder, 'MODELS.tsv'))
    return measure_corpus(options, 'corpus', folder, SAMPLINGS)


def measure_solids(options):
    if not os.path.exists(os.path.join(options.solids, 'MODELS.tsv')):
        subprocess.run([sys.executable, os.path.join(HERE, 'make_corpus.py'), options.solids, '--seeds', SEEDS, '--half', 'judge',
                        '--brio', options.brio], check=True)
    measure_corpus(options, 'solids', options.solids, SOLID_SAMPLINGS)


def measure_shared(options):
    reason = shared_sets.reason_to_skip()
    if reason:
        return skip('shared', reason)
    path = os.path.join(options.docs, 'quality.csv')
    key = ['set', 'method']
    partly = options.only or options.methods
    done = rows_of(path, key) if partly else {}
    for row in shared_sets.run_all(options.brio, options.only, options.methods):
        done[row['set'], row['method']] = row
    tasks = [(task.name, task.method) for task in shared_sets.tasks_of(None, None)]
    return write_rows(path, shared_sets.COLUMNS, [done[task] for task in tasks if task in done])


def measure_scans(options):
    reason = open_scans.reason_to_skip()
    if reason:
        return skip('scans', reason)
    path = os.path.join(options.docs, 'quality-scans.csv')
    done = rows_of(path, open_scans.KEY)
    for rows in open_scans.run_all(options):
        done.update({tuple(row[column] for column in open_scans.KEY): row for row in rows})
        write_rows(path, open_scans.COLUMNS, [done[key] for key in sorted(done)])
    print('\n'.join(open_scans.program_table(list(done.values()))), flush=True)
    return None


# --- the page ---

def write_page(docs):
    shared = list(rows_of(os.path.join(docs, 'quality.csv'), ['set', 'method']).values())
    of_corpus = {'corpus': [], 'solids': []}
    for row in rows_of(os.path.join(docs, 'quality-corpus.csv'), corpus.KEY).values():
        of_corpus[row['corpus']].append(row)
    page = HEAD + ''.join(corpus_tables.section(title, of_corpus[name], intro) for name, title, intro in CORPORA)
    page += open_scans.section(list(rows_of(os.path.join(docs, 'quality-scans.csv'), open_scans.KEY).values()))
    with open(os.path.join(docs, 'quality.md'), 'w', encoding='utf-8') as f:
        f.write(page + shared_sets.sections(shared))


HEAD = '''# Quality of surfaces

Made by `make quality` together with [quality-corpus.csv](quality-corpus.csv) and [quality.csv](quality.csv), which show
every change as a difference; do not edit. Nothing but the seconds depends on the machine or the number of threads.

'''

JUDGED = '''Each was sampled in several ways (bench/quality/sampling.py), points alone but for Poisson
reconstruction, which gets the true normals or estimates them. Right: closed, manifold, oriented, with as many components as
the model, and as many handles in all. Unsound: not closed, not manifold or not oriented, or no surface at all. Handles off,
of sound surfaces: the mean difference of the numbers of handles. Normals: mean |cos| between the normals at nearest
points. Chamfer: mean distance both ways, in per cent of the diagonal; distances are to the triangles of the other surface,
so that a surface is at distance 0 from itself and no floor has to be taken off. Seconds of one processor, mean.'''

CORPORA = [('corpus', 'Models of known topology', '''%d closed models beside the project, organic and mechanical. The log-odds of the
default method were measured on generated solids, a few of its constants were compared on these models, too
([decisions/011](../decisions/011-samples-vote.md)). ''' + JUDGED),
           ('solids', 'Generated solids', '%d solids of `brio generate solid`, even seeds: none was used to choose a constant. ' + JUDGED)]


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('brio', type=os.path.abspath)
    parser.add_argument('docs')
    parser.add_argument('--parts', nargs='+', choices=PARTS, default=PARTS)
    parser.add_argument('--only', nargs='+', metavar='NAME', help='models and sets')
    parser.add_argument('--methods', nargs='+', metavar='NAME', 
                        choices=list(dict.fromkeys([*corpus.METHODS, *shared_sets.METHODS, *open_scans.DEFAULT_EVIDENCE, 'evidence'])))
    parser.add_argument('--samplings', nargs='+', metavar='NAME', choices=SAMPLINGS)
    parser.add_argument('--solids', default=os.path.join(OUT, 'solids-judge'), metavar='FOLDER')
    parser.add_argument('--poisson', default=os.path.join(OUT, 'quality-env', 'bin', 'python'), metavar='PYTHON')
    parser.add_argument('--rivals', action='store_true', help='other programs on the scans, too')
    parser.add_argument('--scans', nargs='+', metavar='NAME', choices=open_scans.SCANS)
    parser.add_argument('--evidence', nargs='+', metavar='KIND', choices=list(open_scans.KINDS))
    parser.add_argument('--every', type=int, default=open_scans.EVERY, help='models of the scans: every N-th')
    parser.add_argument('--peers', default=os.path.join(HERE, '..', '..', 'build-bench'), metavar='FOLDER')
    parser.add_argument('--open3d', default=os.path.join(OUT, 'open3d-env', 'bin', 'python'), metavar='PYTHON')
    parser.add_argument('--processes', type=int, default=2)
    return parser.parse_args()


def main():
    options = read_arguments()
    for part, measure in [('corpus', measure_shared_corpus), ('solids', measure_solids), ('shared', measure_shared),
                          ('scans', measure_scans)]:
        if part in options.parts:
            measure(options)
    write_page(options.docs)
    return 0


if __name__ == '__main__':
    sys.exit(main())
