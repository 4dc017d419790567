"""Samples of a closed triangle mesh, in five ways.

    vertices  the vertices of the mesh, if it has 1,500 or more: adaptive, often on the edges
    even      20,000 points, evenly spread, seldom on the edges
    random    20,000 points, uniformly random by area
    sparse    4,000 points, evenly spread
    noisy     as even, with Gaussian noise of 0.3 spacings (radii of the disks) in each coordinate

The same name of a model gives the same samples. Evenly spread points are those of a random order that are no closer than a
radius to any before them, until no more fit (Poisson disks)."""
import collections

import numpy as np
from scipy.spatial import cKDTree

SAMPLINGS = ('vertices', 'even', 'random', 'sparse', 'noisy')
LEAST_VERTICES, MANY, FEW = 1500, 20000, 4000
NOISE = 0.3           # of the samples `noisy`, in radii of their disks
CANDIDATES = 8        # random points for each evenly spread one
TRIES, NEAR = 5, 0.01 # to find the radius: how often, and the error of the number of points that is near enough

# points: what a program is given. exact: the same without noise. normals: of the mesh there, outwards.
Samples = collections.namedtuple('Samples', 'points exact normals')


def areas_and_normals(points, triangles):
    """Of each triangle."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    return lengths / 2, normals / np.maximum(lengths, 1e-300)[:, None]


def random_points(points, triangles, count, rng):
    """Points uniformly random by area, and the normals of their triangles."""
    areas, normals = areas_and_normals(points, triangles)
    chosen = rng.choice(len(triangles), count, p=areas / areas.sum())
    u, v = np.sqrt(rng.random(count)), rng.random(count)
    weights = np.stack([1 - u, u * (1 - v), u * v], 1)
    return np.einsum('ni,nik->nk', weights, points[triangles[chosen]]), normals[chosen]


def first_come(points, radius):
    """Which points have a disk of their own: each that is no closer than the radius to such a point before it."""
    near = cKDTree(points).query_pairs(radius, output_type='ndarray')  # the lower index first
    kept, open_ = np.zeros(len(points), bool), np.ones(len(points), bool)
    while len(near):
        first = open_.copy()
        first[near[:, 1]] = False
        kept |= first
        open_ &= ~first
        open_[near[first[near[:, 0]], 1]] = False
        near = near[open_[near].all(1)]
    return kept | open_


def even_points(points, triangles, count, rng):
    """About `count` points, evenly spread, their normals, and the radius of their disks."""
    candidates, normals = random_points(points, triangles, CANDIDATES * count, rng)
    radius = 0.75 * np.sqrt(areas_and_normals(points, triangles)[0].sum() / count)
    for _ in range(TRIES):
        kept = first_come(candidates, radius)
        share = kept.sum() / count
        if abs(share - 1) < NEAR:
            break
        radius *= np.sqrt(share)
    return candidates[kept], normals[kept], radius


def vertex_normals(points, triangles):
    areas, normals = areas_and_normals(points, triangles)
    sums = np.zeros_like(points)
    for corner in range(3):
        np.add.at(sums, triangles[:, corner], areas[:, None] * normals)
    return sums / np.maximum(np.linalg.norm(sums, axis=1), 1e-300)[:, None]


def sample(name, sampling, points, triangles):
    """The samples of a model, or None where the sampling makes no sense."""
    rng = np.random.default_rng(list(('%s %s' % (name, sampling)).encode()))
    if sampling == 'vertices':
        return Samples(points, points, vertex_normals(points, triangles)) if len(points) >= LEAST_VERTICES else None
    if sampling == 'random':
        exact, normals = random_points(points, triangles, MANY, rng)
        return Samples(exact, exact, normals)
    exact, normals, radius = even_points(points, triangles, FEW if sampling == 'sparse' else MANY, rng)
    noise = NOISE * radius if sampling == 'noisy' else 0
    return Samples(exact + rng.normal(0, noise, exact.shape) if noise else exact, exact, normals)
