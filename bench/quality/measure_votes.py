"""Measures the log-odds of src/reconstruct/labeled_delaunay/vote_weight.c on generated solids.

    measure_votes.py MODELS [--models N] [--noise 0,0.3] [--brio PROGRAM] [--counts FILE] [--seed S]

MODELS is a folder of make_corpus.py, the half to choose by. Each model is sampled evenly, by 20,000 points, and at random, by
as many; with each noise, in spacings. `brio delaunay` triangulates the samples. For every tetrahedron and each of its samples
the program finds what vote_graph.c finds: the cosine between the axis of the sample and the direction to the Voronoi vertex, and
the inradius in spacings of the sample. Random points in the tetrahedron tell its share inside the model. The axis points
outwards where its product with the model's normal at the sample is positive.

A cell of the table is the log-odds of the share of tetrahedra on the side to which the axis points. In each row both sides
weigh equally: four votes of one tetrahedron must not count four times what its thickness alone tells. A tetrahedron
counts once for each of its samples, and every model the same. Infinite tetrahedra are outside, and are in the last row.
They are nearly all of it and nearly all ahead, so that to weigh both sides equally there says little: look at the counts
before that row is used.

Prints the tables as C, for each noise one. --counts adds up in a file, so that models can be measured in several runs."""
import argparse
import os
import subprocess
import sys
import tempfile

import numpy as np

import ply
import sampling
from inside import Inside

# As in vote_weight.c.
DIRECTIONS, THICKNESS, MOST = 20, np.array([0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 1]), 6.0
NEAREST = 6      # shortest edges whose mean is the spacing of a sample: src/dual/spacing.c
PROBES = 4       # random points in a tetrahedron
PRIOR = 0.5      # tetrahedra of each side in a cell that none was seen in, so that the log-odds stay finite
FACETS = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])  # opposite each vertex


# --- the features, as vote_graph.c has them ---

def triangulate(brio, points):
    """The Delaunay tetrahedra of the points, as brio has them."""
    with tempfile.TemporaryDirectory(prefix='brio-votes-') as folder:
        samples, result = os.path.join(folder, 'points.ply'), os.path.join(folder, 'tetrahedra.ply')
        ply.write_points(samples, points)
        subprocess.run([brio, 'delaunay', samples, '-o', result, '--quiet', '--threads', '1'], check=True)
        return ply.read_cells(result, 'tetrahedron', 4)[1]


def unit(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300)


def hull_of(points, tets):
    """The facets that only one tetrahedron has, and their unit outward normals."""
    facets, own = tets[:, FACETS].reshape(-1, 3), np.repeat(np.arange(len(tets)), 4)
    opposite = tets.reshape(-1)
    key = np.sort(facets, axis=1) @ np.array([len(points) ** 2, len(points), 1])
    _, first, uses = np.unique(key, return_index=True, return_counts=True)
    alone = first[uses == 1]
    a, b, c = (points[facets[alone, i]] for i in range(3))
    normal = unit(np.cross(unit(b - a), unit(c - a)))
    inwards = np.einsum('ij,ij->i', normal, points[opposite[alone]] - a) > 0
    return facets[alone], np.where(inwards[:, None], -normal, normal)


def centres_of(points, tets):
    """Circumcentres; not finite where the tetrahedron is flat."""
    o = points[tets[:, 0]]
    a, b, c = (points[tets[:, i]] - o for i in (1, 2, 3))
    squares = [(v * v).sum(1)[:, None] for v in (a, b, c)]
    bc, ca, ab = np.cross(b, c), np.cross(c, a), np.cross(a, b)
    with np.errstate(divide='ignore', invalid='ignore'):
        return o + (squares[0] * bc + squares[1] * ca + squares[2] * ab) / (2 * (a * bc).sum(1)[:, None])


def axes_of(points, tets, centres, hull):
    """The axis of each sample: the unit vector to the farthest Voronoi vertex of its cell, on the hull the sum of the outward
    normals."""
    radius = np.linalg.norm(centres - points[tets[:, 0]], axis=1)
    order = np.argsort(np.where(np.isfinite(radius), radius, -1), kind='stable')
    farthest = np.zeros(len(points), np.int64)
    for slot in range(4):  # later entries replace earlier ones: the last is the farthest
        best = np.full(len(points), -1)
        best[tets[order, slot]] = np.arange(len(order))
        farthest = best if slot == 0 else np.maximum(farthest, best)
    axes = centres[order[farthest]] - points
    facets, normals = hull
    sums = np.zeros_like(points)
    for corner in range(3):
        np.add.at(sums, facets[:, corner], normals)
    on_hull = np.zeros(len(points), bool)
    on_hull[facets] = True
    return unit(np.where(on_hull[:, None], sums, axes))


def spacing_of(points, tets):
    """The mean length of the shortest Delaunay edges of each sample."""
    pairs = np.concatenate([tets[:, [i, j]] for i in range(4) for j in range(i)])
    pairs = np.unique(np.sort(pairs, axis=1), axis=0)
    length = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    end, length = pairs.T.reshape(-1), np.concatenate([length, length])
    order = np.lexsort((length, end))
    end, length = end[order], length[order]
    rank = np.arange(len(end)) - np.searchsorted(end, end)
    near = rank < NEAREST
    return np.bincount(end[near], length[near], len(points)) / np.maximum(np.bincount(end[near], minlength=len(points)), 1)


def inradius_of(points, tets):
    corners = points[tets]
    a, b, c = (corners[:, i] - corners[:, 0] for i in (1, 2, 3))
    area = sum(np.linalg.norm(np.cross(corners[:, f[1]] - corners[:, f[0]], corners[:, f[2]] - corners[:, f[0]]), axis=1) / 2
               for f in FACETS)
    return np.abs((np.cross(a, b) * c).sum(1)) / (2 * np.maximum(area, 1e-300))


# --- what is seen ---

def column_of(cosine):
    return np.clip(((cosine + 1) / 2 * DIRECTIONS).astype(np.int64), 0, DIRECTIONS - 1)


def share_inside(points, tets, inside, rng):
    """The share of each tetrahedron that is inside, by random points in it."""
    weights = rng.dirichlet(np.ones(4), (len(tets), PROBES))
    probes = np.einsum('tpi,tik->tpk', weights, points[tets]).reshape(-1, 3)
    return inside(probes).reshape(-1, PROBES).mean(1)


def add(counts, row, column, ahead):
    """ahead: the share on the side to which the axis points."""
    np.add.at(counts, (row, column, 1), ahead)
    np.add.at(counts, (row, column, 0), 1 - ahead)


def count_votes(points, outwards, tets, inside_share):
    """How many tetrahedra of each thickness and direction are behind [.., 0] and ahead [.., 1] of their samples.
    outwards  of each sample, a vector that points out of the model."""
    counts = np.zeros((len(THICKNESS) + 1, DIRECTIONS, 2))
    hull, centres, spacing = hull_of(points, tets), centres_of(points, tets), spacing_of(points, tets)
    axes, inradius = axes_of(points, tets, centres, hull), inradius_of(points, tets)
    turned = (axes * outwards).sum(1) < 0
    for slot in range(4):
        p = tets[:, slot]
        cosine = np.nan_to_num((unit(centres - points[p]) * axes[p]).sum(1))
        row = np.searchsorted(THICKNESS, inradius / spacing[p], 'right')
        add(counts, row, column_of(cosine), np.where(turned[p], inside_share, 1 - inside_share))
    facets, normals = hull
    for corner in range(3):
        p = facets[:, corner]
        add(counts, np.full(len(p), len(THICKNESS)), column_of((normals * axes[p]).sum(1)), np.where(turned[p], 0., 1.))
    return counts


def measure_model(brio, path, noise, seed):
    """The counts of both samplings of a model. Noise is in radii of the disks of the even samples (sampling.py)."""
    name = os.path.basename(path)
    rng = np.random.default_rng([seed, *name.encode()])
    mesh = ply.read_mesh(path)
    even, normals, radius = sampling.even_points(*mesh, sampling.MANY, rng)
    inside, counts = Inside(*mesh), 0
    for exact, outwards in [(even, normals), sampling.random_points(*mesh, sampling.MANY, rng)]:
        points = exact + rng.normal(0, noise * radius, exact.shape) if noise else exact
        tets = triangulate(brio, points)
        counts = counts + count_votes(points, outwards, tets, share_inside(points, tets, inside, rng))
    return counts / counts.sum()


# --- the table ---

def log_odds(counts):
    """By thickness and direction; 0 where nothing was seen."""
    behind, ahead = counts[..., 0], counts[..., 1]
    scale = 1 / np.maximum(counts.sum(1, keepdims=True), 1e-300)  # both sides of a row weigh equally
    seen = behind + ahead > 0
    least = PRIOR * counts[counts > 0].min()
    odds = np.log((ahead + least) * scale[..., 1]) - np.log((behind + least) * scale[..., 0])
    return np.clip(np.where(seen, odds, 0), -MOST, MOST)


def as_c(name, table):
    rows = ['    {' + ', '.join('%.1ff' % x for x in row) + '},' for row in table]
    return '\n'.join(['static const float %s[THICKNESSES][DIRECTIONS] = {' % name, *rows, '};'])


def read_counts(path):
    return dict(np.load(path)) if path and os.path.exists(path) else {}


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('folder', metavar='MODELS')
    parser.add_argument('--models', type=int, help='only the first N, of all kinds by turns')
    parser.add_argument('--noise', default='0,0.3', type=lambda text: [float(word) for word in text.split(',')])
    parser.add_argument('--brio', default=os.path.join(os.path.dirname(__file__), '..', '..', 'build', 'brio'))
    parser.add_argument('--counts', help='counts of single models, added to and read')
    parser.add_argument('--seed', type=int, default=1)
    return parser.parse_args()


def models_of(folder, most):
    """The models in the order of their seeds, which alternates between the kinds."""
    names = [name[:-4] for name in os.listdir(folder) if name.endswith('.ply') and name.count('.') == 1]
    return sorted(names, key=lambda name: name.split('_')[1])[:most]


def main():
    arguments = read_arguments()
    counts, names = read_counts(arguments.counts), models_of(arguments.folder, arguments.models)
    for noise in arguments.noise:
        for name in names:
            key = '%s %g' % (name, noise)
            if key not in counts:
                path = os.path.join(arguments.folder, name + '.ply')
                counts[key] = measure_model(arguments.brio, path, noise, arguments.seed)
                print(key, file=sys.stderr, flush=True)
                if arguments.counts:
                    np.savez(arguments.counts, **counts)
        table = log_odds(sum(counts['%s %g' % (name, noise)] for name in names))
        print(as_c('CLEAN' if noise == 0 else 'NOISY_%g' % noise, table), flush=True)
    return 0


if __name__ == '__main__':
    sys.exit(main())
