"""Two methods that the thesis compares with, or that came after it, written for this bench: the crust, and the choice of samples
of the robust co-cone. Both go over the Delaunay tetrahedra that brio makes.

crust: Delaunay triangles of samples and poles together whose corners are all samples, and whose normals are near the lines from
their corners to poles. It needs two triangulations, the second one of three times as many points.
robust_samples: the samples on the big Delaunay balls outside of the solid; the tight co-cone of these is the surface.

Based on: [Amenta Bern 1999] (3-dimensional crust, with its filter by normals, without its walk for a manifold)
          [Dey Goswami 2006] Provable surface reconstruction from noisy samples"""
import itertools
import resource
import subprocess

import numpy as np
from scenes import ply

NORMALS = np.pi / 6  # a triangle leans by no more from the poles of its corners
NEAREST, BIG = 5, 3  # a ball is big that is larger than so many times the mean distance of the nearest samples
DEEP = np.radians(10)  # balls that meet at more lie on one side
FACETS = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))


def tetrahedra(brio, path, made):
    """Corners of the finite ones; the seconds of the processor."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run([brio, 'delaunay', path, '-o', made, '--quiet', '--threads', '1'], check=True)
    return ply.read_cells(made, 'tetrahedron', 4)[1], resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def balls(points, tets):
    """Centre and radius of each ball; a flat one has an infinite radius."""
    a, b, c, d = (points[tets[:, i]] for i in range(4))
    b, c, d = b - a, c - a, d - a
    volume = 2 * (b * np.cross(c, d)).sum(1)
    square = [(x * x).sum(1)[:, None] for x in (b, c, d)]
    with np.errstate(all='ignore'):
        centre = (square[0] * np.cross(c, d) + square[1] * np.cross(d, b) + square[2] * np.cross(b, c)) / volume[:, None]
        radius = np.linalg.norm(centre, axis=1)
    flat = ~np.isfinite(radius)
    return np.where(flat[:, None], 0, centre) + a, np.where(flat, np.inf, radius)


def facets(tets):
    """Of all facets: sorted corners, their tetrahedron, and the corner opposite."""
    all_ = np.concatenate([tets[:, list(f)] for f in FACETS])
    return np.sort(all_, 1), np.tile(np.arange(len(tets)), 4), np.concatenate([tets[:, i] for i in range(4)])


def pairs(tets):
    """The tetrahedra on both sides of each facet, -1 outside; its corners; the corner opposite of the first."""
    corners, owner, opposite = facets(tets)
    order = np.lexsort(corners.T)
    corners, owner, opposite = corners[order], owner[order], opposite[order]
    same = np.append((corners[1:] == corners[:-1]).all(1), False)
    first = ~np.insert(same[:-1], 0, False)
    other = np.where(same, np.append(owner[1:], -1), -1)
    return owner[first], other[first], corners[first], opposite[first]


def hull_normals(points, tets):
    """Of each point on the hull, the mean of the normals there, outwards; zero for others."""
    _, other, corners, opposite = pairs(tets)
    hull = other < 0
    corners, opposite = corners[hull], opposite[hull]
    a, b, c = (points[corners[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    normal *= -np.sign(((points[opposite] - a) * normal).sum(1))[:, None]
    normals = np.zeros_like(points)
    for i in range(3): np.add.at(normals, corners[:, i], normal)
    return normals


def farthest(count, owner, distance, allowed):
    """Of each point, the index of the farthest allowed entry, or -1."""
    index = np.flatnonzero(allowed)
    index = index[np.argsort(distance[index], kind='stable')]
    best = np.full(count, -1)
    best[owner[index]] = index
    return best


def poles(points, tets):
    """The centres that are poles, and of each point the direction to its first pole."""
    centre, radius = balls(points, tets)
    owner, tet = tets.reshape(-1), np.repeat(np.arange(len(tets)), 4)
    ray = centre[tet] - points[owner]
    normals = hull_normals(points, tets)
    on_hull, finite = normals.any(1), np.isfinite(radius[tet])
    first = farthest(len(points), owner, radius[tet], finite & ~on_hull[owner])
    direction = np.where(on_hull[:, None], normals, np.where(first[:, None] >= 0, ray[first], 0))
    second = farthest(len(points), owner, radius[tet], finite & ((ray * direction[owner]).sum(1) < 0))
    chosen = np.unique(tet[np.concatenate([first[first >= 0], second[second >= 0]])])
    return centre[chosen], direction


def crust(brio, samples, folder):
    """Writes the crust; returns its path, and the seconds of the two triangulations."""
    made, out = f'{folder}/tets.ply', f'{folder}/crust.ply'
    points = ply.read_cells(samples, 'face', 3)[0]
    tets, one = tetrahedra(brio, samples, made)
    centres, direction = poles(points, tets)
    ply.write_points(f'{folder}/both.ply', np.concatenate([points, centres]))
    both, two = tetrahedra(brio, f'{folder}/both.ply', made)
    corners = np.unique(facets(both)[0], axis=0)
    corners = corners[corners[:, 2] < len(points)]
    a, b, c = (points[corners[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    with np.errstate(all='ignore'):
        lean = [abs((normal * direction[corners[:, i]]).sum(1)) / np.linalg.norm(normal, axis=1) /
                np.linalg.norm(direction[corners[:, i]], axis=1) for i in range(3)]
    kept = corners[np.min(lean, 0) >= np.cos(NORMALS)]
    ply.write_mesh(out, points, kept)
    return out, one + two


def common(a, b):
    """Shares of the triangles of each file that are in the other one. The vertices of both are the same samples."""
    found = [set(map(tuple, np.sort(ply.read_mesh(path)[1], 1))) for path in (a, b)]
    both = len(found[0] & found[1])
    return both / len(found[0]), both / len(found[1])


def robust_samples(brio, samples, folder):
    """Writes the samples on the big balls that are outside, and returns the path."""
    from scipy.spatial import cKDTree
    points = ply.read_cells(samples, 'face', 3)[0]
    tets, _ = tetrahedra(brio, samples, f'{folder}/tets.ply')
    centre, radius = balls(points, tets)
    near = cKDTree(points).query(points, NEAREST + 1)[0][:, 1:].mean(1)
    big = radius > BIG * near[tets].min(1)
    a, b, _, _ = pairs(tets)
    inner = b >= 0
    square = ((centre[a] - centre[b]) ** 2).sum(1)
    with np.errstate(all='ignore'):
        cosine = (radius[a] ** 2 + radius[b] ** 2 - square) / (2 * radius[a] * radius[b])
    deep = inner & big[a] & big[b] & (np.nan_to_num(cosine, nan=1, posinf=1, neginf=1) > -np.cos(DEEP))
    parent = spread(len(tets), a[~inner][big[a[~inner]]], a[deep], b[deep])
    out = f'{folder}/robust.ply'
    ply.write_points(out, points[np.unique(tets[parent])])
    return out


def spread(count, seeds, a, b):
    """What a walk over the pairs (a, b) reaches from the seeds: a mask."""
    reached = np.zeros(count, bool)
    reached[seeds] = True
    for _ in itertools.count():
        one = reached[a] ^ reached[b]
        if not one.any(): return reached
        reached[a[one]] = reached[b[one]] = True
