#!/usr/bin/env python3
"""medial_axis.py BRIO: medial axes against axes that are known, by the power shape and by Voronoi facets, as a table.

Samples of an ellipsoid, a box, a torus and a capsule, no place of the surface farther than h from one. Distances in h: of the
result's vertices from the true axis, largest and mean; of 2,000 places of the true axis from the nearest vertex, largest and
mean. The same with noise of 0.1 h, where the axes are simplified: --simplify, and --scale-axis 1.2.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

PLACES = 2000
HALF = np.array([1, 0.7, 0.5])


def grid(rng, u, v):
    """Cells of the unit square, a random place in the middle half of each."""
    i, j = np.meshgrid(np.arange(u), np.arange(v), indexing="ij")
    return (i.ravel() + rng.uniform(0.25, 0.75, u * v)) / u, (j.ravel() + rng.uniform(0.25, 0.75, u * v)) / v


def revolved(rng, h, length, profile):
    rings = int(np.ceil(length / h))
    rows = []
    for i in range(rings):
        cells = max(1, int(np.ceil(2 * np.pi * profile(np.array([(i + 0.5) / rings]))[0][0] / h)))
        a = 2 * np.pi * (np.arange(cells) + rng.uniform(0.25, 0.75, cells)) / cells
        r, z = profile((i + rng.uniform(0.25, 0.75, cells)) / rings)
        rows.append(np.column_stack([r * np.cos(a), r * np.sin(a), z]))
    return np.vstack(rows)


def ellipsoid(rng, h):
    return revolved(rng, h / 1.5, np.pi, lambda t: (np.sin(np.pi * t), np.cos(np.pi * t))) * [1.5, 1, 0.6]


def ellipsoid_off(p):
    a, b = (2.25 - 0.36) / 1.5, 1 - 0.36
    k = np.maximum(np.hypot(p[:, 0] / a, p[:, 1] / b), 1)
    return np.hypot(np.hypot(p[:, 0], p[:, 1]) * (1 - 1 / k), p[:, 2])


def ellipsoid_axis(rng):
    a, r = rng.uniform(0, 2 * np.pi, PLACES), np.sqrt(rng.uniform(0, 1, PLACES))
    return np.column_stack([r * np.cos(a) * 1.26, r * np.sin(a) * 0.64, 0 * a])


def torus(rng, h):
    return revolved(rng, h, 0.8 * np.pi, lambda t: (1 + 0.4 * np.cos(2 * np.pi * t), 0.4 * np.sin(2 * np.pi * t)))


def torus_off(p):
    return np.hypot(np.hypot(p[:, 0], p[:, 1]) - 1, p[:, 2])


def torus_axis(rng):
    a = rng.uniform(0, 2 * np.pi, PLACES)
    return np.column_stack([np.cos(a), np.sin(a), 0 * a])


def capsule(rng, h):
    def profile(t):
        s = t * (2 + 0.5 * np.pi)
        a, b = s / 0.5, (s - 2) / 0.5
        cap, top = a < np.pi / 2, b > np.pi / 2
        return (np.where(cap, 0.5 * np.sin(a), np.where(top, 0.5 * np.sin(b), 0.5)),
                np.where(cap, -1 - 0.5 * np.cos(a), np.where(top, 1 - 0.5 * np.cos(b), s - 0.25 * np.pi - 1)))

    return revolved(rng, h, 2 + 0.5 * np.pi, profile)


def capsule_off(p):
    return np.hypot(np.hypot(p[:, 0], p[:, 1]), np.maximum(np.abs(p[:, 2]) - 1, 0))


def capsule_axis(rng):
    z = rng.uniform(-1, 1, PLACES)
    return np.column_stack([0 * z, 0 * z, z])


def box(rng, h):
    rows = []
    for k in range(3):
        u, v = (k + 1) % 3, (k + 2) % 3
        for side in (-1, 1):
            s, t = grid(rng, int(np.ceil(2 * HALF[u] / h)), int(np.ceil(2 * HALF[v] / h)))
            p = np.empty((len(s), 3))
            p[:, k], p[:, u], p[:, v] = side * HALF[k], HALF[u] * (2 * s - 1), HALF[v] * (2 * t - 1)
            rows.append(p)
    return np.vstack(rows)


def box_off(p):
    """To the box, then away from the nearest side until another one, or the one across, is as near."""
    x = np.minimum(np.abs(p), HALF)
    depth = np.sort(HALF - x, axis=1)
    across = np.take_along_axis(x, np.argmin(HALF - x, axis=1)[:, None], 1)[:, 0]
    return np.linalg.norm(np.abs(p) - x, axis=1) + np.minimum(depth[:, 1] - depth[:, 0], across)


def box_axis(rng):
    p = HALF * rng.uniform(-1, 1, (PLACES, 3))
    depth = HALF - np.abs(p)
    near, rows = np.argmin(depth, axis=1), np.arange(PLACES)
    p[rows, near] = np.copysign(HALF[near] - np.minimum(np.sort(depth, axis=1)[:, 1], HALF[near]), p[rows, near])
    return p


SHAPES = [("ellipsoid", ellipsoid, ellipsoid_off, ellipsoid_axis), ("box", box, box_off, box_axis),
          ("torus", torus, torus_off, torus_axis), ("capsule", capsule, capsule_off, capsule_axis)]


def vertices(path):
    """The positions of an ASCII PLY file, whose vertices begin with x, y, z."""
    head, body = path.read_text().split("end_header\n")
    count = int(next(line.split()[2] for line in head.splitlines() if line.startswith("element vertex")))
    return np.array([line.split()[:3] for line in body.splitlines()[:count]], float)


def nearest(places, points):
    return np.array([np.sqrt(((points - p) ** 2).sum(1).min()) for p in places])


def row(brio, folder, name, samples, off, axis, h, options):
    points, out = folder / "p.xyz", folder / "a.ply"
    np.savetxt(points, samples, fmt="%.17g")
    run = subprocess.run([brio, "medial", points, "-o", out, "--ascii", "--json", *options], capture_output=True, text=True)
    if run.returncode:
        raise SystemExit(run.stderr)
    found = vertices(out)
    there, back = off(found) / h, nearest(axis, found) / h
    print("| %s | %g | %d | %s | %d | %.3f | %.3f | %.2f | %.2f |" % (
        name, h, json.loads(run.stdout)["samples"], " ".join(options) or "power shape", len(found), there.max(), there.mean(),
        back.max(), back.mean()))


def main(brio):
    print("| shape | h | samples | how | vertices | off the axis: most | mean | axis from result: most | mean |")
    print("|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for shape, sample, off, on in SHAPES:
            axis = on(np.random.default_rng(5))
            for h in (0.2, 0.1, 0.05):
                samples = sample(np.random.default_rng(1), h)
                for options in ([], ["--method", "voronoi"]):
                    row(brio, folder, shape, samples, off, axis, h, options)
            noisy = samples + np.random.default_rng(2).normal(0, 0.1 * h / 3 ** 0.5, samples.shape)
            for options in ([], ["--method", "voronoi"], ["--simplify"], ["--scale-axis", "1.2"]):
                row(brio, folder, shape + ", noise", noisy, off, axis, h, [*options, "--noise", "keep"])


if __name__ == "__main__":
    main(*sys.argv[1:])
