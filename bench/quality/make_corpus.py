"""Writes a corpus of random solids, to choose and to judge surface reconstruction by.

    make_corpus.py OUT [--seeds 1-60] [--half choose|judge] [--kinds implicit,machined] [--resolution R] [--brio PROGRAM]

The folder OUT receives a file for each solid, a binary little-endian PLY of float x y z and triangles as `uchar int`
lists, and MODELS.tsv: name, vertices, faces, components, genus. Pairs of seeds alternate between the kinds. Odd seeds are there to
choose methods and constants by, even ones to judge the choice: --half takes one of the two. Models that are there already
are kept. Needs numpy.
"""
import argparse
import json
import os
import subprocess
import sys
import time

from ply import read_mesh, write_mesh


def make_model(arguments, kind, seed, path):
    """Makes the solid of a seed; returns its components and genus."""
    made = path + '.made.ply'
    command = [arguments.brio, 'generate', 'solid', '--kind', kind, '--seed', str(seed), '-o', made, '--json', '--quiet']
    if arguments.resolution:
        command += ['--resolution', str(arguments.resolution)]
    facts = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)['certificate']
    write_mesh(path, *read_mesh(made))
    os.remove(made)
    return facts['components'], facts['genus']


def counted(arguments, path):
    """Components and genus of a model that is there already."""
    checked = subprocess.run([arguments.brio, 'check', path, '--json', '--quiet'], capture_output=True, text=True)
    facts = json.loads(checked.stdout)['certificate']
    return facts['components'], facts['genus']


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('out')
    parser.add_argument('--seeds', default='1-60', metavar='A-B')
    parser.add_argument('--half', choices=('choose', 'judge'))
    parser.add_argument('--kinds', default='implicit,machined', type=lambda text: text.split(','))
    parser.add_argument('--resolution', type=int)
    parser.add_argument('--brio', default=os.path.join(os.path.dirname(__file__), '..', '..', 'build', 'brio'))
    return parser.parse_args()


def main():
    arguments = read_arguments()
    first, _, last = arguments.seeds.partition('-')
    os.makedirs(arguments.out, exist_ok=True)
    rows = []
    for seed in range(int(first), int(last or first) + 1):
        half = 'choose' if seed % 2 else 'judge'
        if arguments.half not in (None, half):
            continue
        kind = arguments.kinds[seed // 2 % len(arguments.kinds)]
        name = '%s_%04d_%s' % (kind, seed, half)
        path = os.path.join(arguments.out, name + '.ply')
        start = time.time()
        components, genus = counted(arguments, path) if os.path.exists(path) else make_model(arguments, kind, seed, path)
        points, triangles = read_mesh(path)
        rows.append('%s\t%d\t%d\t%d\t%d' % (name, len(points), len(triangles), components, genus))
        print('%s\t%.1f s' % (rows[-1], time.time() - start), flush=True)
    with open(os.path.join(arguments.out, 'MODELS.tsv'), 'w', encoding='utf-8') as f:
        f.write('\n'.join(['model\tvertices\tfaces\tcomponents\tgenus', *rows]) + '\n')


if __name__ == '__main__':
    sys.exit(main())
