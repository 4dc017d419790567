#!/usr/bin/python3
"""Surfaces of scans whose evidence was spoiled: a program for the judge of open scans (open_scans.py).

    spoiled_evidence.py BRIO KIND REPORT IN OUT

IN is a PLY file with normals nx ny nz and places of scanners x_origin y_origin z_origin. KIND says what is left of them, and
how wrong it is. BRIO makes the surface OUT of it; a line of REPORT says what it told of the evidence. The same file is spoiled
in the same way."""
import json
import os
import subprocess
import sys
import zlib

import numpy as np

import ply

NORMALS, ORIGINS = ['nx', 'ny', 'nz'], ['x_origin', 'y_origin', 'z_origin']


# --- ways to be wrong ---

def rotated(normals, degrees, rng):
    """Directions off by an angle whose standard deviation is `degrees`, to any side."""
    side = np.cross(normals, rng.normal(size=normals.shape))
    side /= np.maximum(np.linalg.norm(side, axis=1), 1e-300)[:, None]
    angle = np.radians(degrees) * rng.normal(size=(len(normals), 1))
    return np.cos(angle) * normals + np.sin(angle) * side


def chosen(count, share, rng):
    return rng.random(count) < share


def flipped(normals, share, rng):
    return np.where(chosen(len(normals), share, rng)[:, None], -normals, normals)


def mirrored(points, origins, share, rng):
    """Scanners of some points on the other side of these."""
    return np.where(chosen(len(points), share, rng)[:, None], 2 * points - origins, origins)


def displaced(points, origins, share, rng):
    """Each scanner is off by a share of the size of what it saw, each in another direction."""
    places, of = np.unique(origins, axis=0, return_inverse=True)
    off = rng.normal(size=places.shape)
    off *= share * np.linalg.norm(np.ptp(points, axis=0)) / np.linalg.norm(off, axis=1)[:, None]
    return origins + off[of.ravel()]


# Of each kind: what becomes of the normals and of the origins; None: they are left out.
KINDS = {
    'none': (None, None),
    'origins': (None, lambda p, o, rng: o),
    'origins off by 5 % of the size': (None, lambda p, o, rng: displaced(p, o, 0.05, rng)),
    'origins, 10 % behind': (None, lambda p, o, rng: mirrored(p, o, 0.1, rng)),
    'origins, 50 % behind': (None, lambda p, o, rng: mirrored(p, o, 0.5, rng)),
    'origins, all behind': (None, lambda p, o, rng: mirrored(p, o, 1, rng)),
    'normals': (lambda n, rng: n, None),
    'normals off by 5 degrees': (lambda n, rng: rotated(n, 5, rng), None),
    'normals off by 20 degrees': (lambda n, rng: rotated(n, 20, rng), None),
    'normals, 10 % flipped': (lambda n, rng: flipped(n, 0.1, rng), None),
    'normals, 50 % flipped': (lambda n, rng: flipped(n, 0.5, rng), None),
    'normals, all flipped': (lambda n, rng: -n, None),
    'both': (lambda n, rng: n, lambda p, o, rng: o),
    'both, normals 50 % flipped': (lambda n, rng: flipped(n, 0.5, rng), lambda p, o, rng: o),
    'both, normals all flipped': (lambda n, rng: -n, lambda p, o, rng: o),
}


def spoil(rows, kind, rng):
    """The rows of points with what a kind leaves of their evidence."""
    points = np.stack([rows[axis] for axis in 'xyz'], 1)
    of_normals, of_origins = KINDS[kind]
    names, values = list('xyz'), [points]
    if of_normals:
        names += NORMALS
        values.append(of_normals(np.stack([rows[axis] for axis in NORMALS], 1), rng))
    if of_origins:
        names += ORIGINS
        values.append(of_origins(points, np.stack([rows[axis] for axis in ORIGINS], 1), rng))
    return ply.columns(names, np.hstack(values), '<f8')


def read_rows(path):
    with open(path, 'rb') as f:
        (_, count, properties), *_ = ply.read_header(f)
        return ply.read_rows(f, count, properties, 0)


def main():
    brio, kind, report, source, out = sys.argv[1:]
    rng = np.random.default_rng(zlib.crc32(('%s %s' % (os.path.basename(source), kind)).encode()))
    points = out + '.points.ply'
    ply.write_elements(points, [('vertex', spoil(read_rows(source), kind.replace('_', ' '), rng))])
    done = subprocess.run([brio, 'surface', points, '-o', out, '--json', '--quiet'], capture_output=True, text=True)
    os.remove(points)
    if done.returncode == 0:
        facts = json.loads(done.stdout)
        with open(report, 'a', encoding='utf-8') as f:
            print(json.dumps({'file': os.path.basename(source), 'orientation': facts['orientation'],
                              'agreement': facts.get('agreement')}), file=f)
    return done.returncode


if __name__ == '__main__':
    sys.exit(main())
