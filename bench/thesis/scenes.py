"""Surfaces that stand in for those of the thesis' chapter 3, whose samples are not public: what is true of each is known.

Each is a triangle mesh, from formulas or from `brio generate solid`, and samples of it: evenly spread, on a part of it, or with
noise. The models beside the project are used where they are there; knot.pts has no mesh, but a known genus."""
import collections
import json
import os
import subprocess
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
SHARED = os.path.join(os.environ.get('BRIO_SHARED', os.path.join(HERE, '..', '..', '..', 'shared')), 'data')
sys.path.insert(1, os.path.join(HERE, '..', 'quality'))
import ply
import sampling
from chapter3 import SOLIDS

# samples: path of the points; truth: path of a mesh, or None; spacing: the mean distance of a sample from the next one
Scene = collections.namedtuple('Scene', 'samples truth components genus points spacing')


# --- meshes by formula

def patch(function, u, v):
    """A grid of points of a function of two numbers, cut into triangles."""
    s, t = np.meshgrid(np.linspace(*u), np.linspace(*v), indexing='ij')
    n, m = s.shape
    at = np.arange(n * m).reshape(n, m)
    a, b, c, d = at[:-1, :-1].ravel(), at[1:, :-1].ravel(), at[1:, 1:].ravel(), at[:-1, 1:].ravel()
    return function(s.ravel(), t.ravel()), np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def together(*meshes):
    points, triangles, first = [], [], 0
    for p, t in meshes:
        points.append(p)
        triangles.append(t + first)
        first += len(p)
    return np.concatenate(points), np.concatenate(triangles)


FULL = 2 * np.pi


def torus(great=1.0, small=0.4):
    def at(u, v):
        r = great + small * np.cos(v)
        return np.stack([r * np.cos(u), r * np.sin(u), small * np.sin(v)], 1)
    return patch(at, (0, FULL, 241), (0, FULL, 121))


def knot(radius=0.55):
    """A tube about a trefoil."""
    def axis(t):
        return np.stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)], 1)

    def at(u, v):
        h = 1e-4
        along = axis(u + h) - axis(u - h)
        along /= np.linalg.norm(along, axis=1)[:, None]
        bend = axis(u + h) + axis(u - h) - 2 * axis(u)
        side = bend - (bend * along).sum(1)[:, None] * along
        side /= np.linalg.norm(side, axis=1)[:, None]
        return axis(u) + radius * (np.cos(v)[:, None] * side + np.sin(v)[:, None] * np.cross(along, side))
    return patch(at, (0, FULL, 481), (0, FULL, 61))


def turned(profile, around=121):
    """The surface that a polyline (distance from the axis, height) describes."""
    profile = np.asarray(profile, float)

    def at(u, v):
        k = np.minimum(u.astype(int), len(profile) - 2)
        place = profile[k] * (1 - (u - k))[:, None] + profile[k + 1] * (u - k)[:, None]
        return np.stack([place[:, 0] * np.cos(v), place[:, 0] * np.sin(v), place[:, 1]], 1)
    return patch(at, (0, len(profile) - 1, 2 * len(profile) - 1), (0, FULL, around))


def arc(radius, first, last, steps=40, height=0.0):
    """Part of a circle about a point of the axis, as a profile: angles from the lowest point on."""
    a = np.linspace(first, last, steps)
    return list(zip(radius * np.sin(a), height - radius * np.cos(a)))


def ball():
    return turned(arc(1, 0, np.pi))


def shell():
    """A bowl with a thick wall: the inner side of its bottom is what a scanner may not reach."""
    lip = 0.62 * np.pi
    return turned(arc(1, 0, lip) + arc(0.72, lip, 0))


def face(corner, u, v, steps=41):
    corner, u, v = (np.asarray(x, float) for x in (corner, u, v))
    return patch(lambda s, t: corner + s[:, None] * u + t[:, None] * v, (0, 1, steps), (0, 1, steps))


def cube_and_cylinder():
    """A cube with an edge of 2, and a cylinder on it."""
    radius, height, half = 0.5, 0.8, 1.0
    sides = [face((s * half, -half, -half), (0, 2, 0), (0, 0, 2)) for s in (-1, 1)] + \
            [face((-half, s * half, -half), (2, 0, 0), (0, 0, 2)) for s in (-1, 1)] + [face((-half, -half, -half), (2, 0, 0), (0, 2, 0))]

    def top(u, v):  # from the circle to the edge of the square
        c, s = np.cos(v), np.sin(v)
        edge = half / np.maximum(abs(c), abs(s))
        r = radius * (1 - u) + edge * u
        return np.stack([r * c, r * s, np.full_like(u, half)], 1)
    return together(*sides, patch(top, (0, 1, 41), (0, FULL, 401)),
                    turned([(radius, half), (radius, half + height), (0, half + height)]))


def stamp():
    """A block with a raised cross on it, whose walls are steep."""
    def top(u, v):
        bar = np.minimum(np.maximum(abs(u) - 0.15, abs(v) - 0.6), np.maximum(abs(v) - 0.15, abs(u) - 0.6))
        return np.stack([u, v, 0.4 + 0.15 * np.clip(0.5 - bar / 0.06, 0, 1)], 1)
    sides = [face((s, -1, -0.4), (0, 2, 0), (0, 0, 0.8)) for s in (-1, 1)] + \
            [face((-1, s, -0.4), (2, 0, 0), (0, 0, 0.8)) for s in (-1, 1)] + [face((-1, -1, -0.4), (2, 0, 0), (0, 2, 0))]
    return together(*sides, patch(top, (-1, 1, 201), (-1, 1, 201)))


# --- samples

def scanned(points, normals, spacing, rng):
    """Six scans of a block: each has what faces it, a quarter of it twice, noise, and a shift by which it does not fit; the
    scanner from above has all of it, the others two thirds."""
    taken = []
    for axis in range(3):
        for sign in (-1, 1):
            facing = sign * normals[:, axis] > 0.5
            which = np.flatnonzero(facing)
            if (axis, sign) != (2, 1): which = rng.permutation(which)[:2 * len(which) // 3]
            shift = rng.normal(0, 0.15 * spacing, 3)
            taken.append(points[which] + shift + rng.normal(0, 0.1 * spacing, (len(which), 3)))
    return np.concatenate(taken)


def far_from_edges(points, spacing, half=1.0):
    """Samples of the cube none of which is on, or near, an edge of it."""
    near = (abs(abs(points) - half) < 0.4 * spacing).sum(1)
    return near < 2


# name: (mesh, genus, number of samples, what is sampled)
FORMULAS = {
    'torus': (torus, 1, 6000, None),
    'knot': (knot, 1, 1500, None),
    'foot': (ball, 0, 5000, lambda p, n, s, rng: p[p[:, 2] < 0.72]),
    'shell': (shell, 0, 9000, lambda p, n, s, rng: p[~((np.linalg.norm(p, axis=1) < 0.86) & (p[:, 2] < -0.5))]),
    'cube': (cube_and_cylinder, 0, 4000, lambda p, n, s, rng: p[far_from_edges(p, s)]),
    'stamp': (stamp, 0, 9000, scanned),
}
# name: (file, components, genus, whether its faces are the truth)
MODELS = {'shared-knot': ('model/knot.pts', 1, 1, False), 'shared-hand': ('corpus/hand_closed.ply', 1, 0, True),
          'shared-part': ('model/mechpart.ply', 1, 3, True)}


def mean_spacing(points):
    from scipy.spatial import cKDTree
    distance, _ = cKDTree(points).query(points, 2)
    return float(distance[:, 1].mean())


class Scenes:
    """Scenes by name, each made in a folder when it is first asked for."""

    def __init__(self, brio, folder):
        self.brio, self.folder, self.made = brio, folder, {}

    def path(self, name): return os.path.join(self.folder, name + '.ply')

    def facts(self, *command):
        done = subprocess.run([self.brio, *command, '--json', '--quiet'], stdout=subprocess.PIPE, check=False, text=True)
        return json.loads(done.stdout)

    def _mesh(self, name):
        """(points, triangles, components, genus, number of samples, what is sampled)."""
        if name in FORMULAS:
            make, genus, count, part = FORMULAS[name]
            return (*make(), 1, genus, count, part)
        kind, seed, count = SOLIDS[name]
        made = self.facts('generate', 'solid', '--kind', kind, '--seed', str(seed), '--resolution', '72',
                          '-o', self.path('made'))['certificate']
        return (*ply.read_mesh(self.path('made')), made['components'], made['genus'], count, None)

    def _generated(self, name):
        points, triangles, components, genus, count, part = self._mesh(name)
        rng = np.random.default_rng(list(name.encode()))
        samples, normals, radius = sampling.even_points(points, triangles, count, rng)
        if part: samples = part(samples, normals, radius, rng)
        ply.write_mesh(self.path(name + '-truth'), points, triangles)
        ply.write_points(self.path(name), samples)
        return Scene(self.path(name), self.path(name + '-truth'), components, genus, len(samples), mean_spacing(samples))

    def _scan(self):
        """A simulated laser scan, with its views, noise, and places that no view sees."""
        self.facts('generate', 'scan', '-n', '12000', '-o', self.path('scan'), '--truth', self.path('scan-truth'), '--truth-resolution', '100')
        points = ply.read_cells(self.path('scan'), 'face', 3)[0]
        c = self.facts('check', self.path('scan-truth'))['certificate']
        return Scene(self.path('scan'), self.path('scan-truth'), c['components'], c['genus'], len(points), mean_spacing(points))

    def _model(self, name):
        """A model beside the project, or None."""
        if name in MODELS:
            file, components, genus, mesh = MODELS[name]
            path = os.path.join(SHARED, file)
        else:
            path = os.path.join(SHARED, 'corpus', name.partition('-')[2] + '.ply')
            if not os.path.exists(path): return None
            c = self.facts('check', path)['certificate']
            mesh, components, genus = True, c['components'], c['genus']
        if not os.path.exists(path): return None
        self.facts('convert', path, self.path(name))
        points = ply.read_mesh(self.path(name))[0] if mesh else np.loadtxt(path)[:, :3]
        ply.write_points(self.path(name), points)
        return Scene(self.path(name), path if mesh else None, components, genus, len(points), mean_spacing(points))

    def scene(self, name):
        """None where the data are not there."""
        if name not in self.made:
            self.made[name] = self._scan() if name == 'scan' else self._model(name) if name.startswith('shared-') else self._generated(name)
        return self.made[name]
