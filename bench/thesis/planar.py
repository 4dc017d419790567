"""Figure 3.4: power crusts of curves in the plane, and the picture of their making.

The links of a curve are known, since its samples are made one after the other. The crust is right if it has these links and no
others, the power shape if its Euler characteristic is that of what the curves enclose."""
import json
import os
import subprocess

import numpy as np
from scenes import ply

FULL = 2 * np.pi
# name: (curves as (function of an angle, number of samples), Euler characteristic of the inside)
CURVES = {
    'star': ([(lambda a: (1 + 0.35 * np.sin(5 * a)), 160)], 1),
    'bean': ([(lambda a: 1 + 0.3 * np.cos(2 * a) + 0.15 * np.sin(3 * a), 90)], 1),
    'ring': ([(lambda a: 1 + 0 * a, 110), (lambda a: 0.45 + 0.05 * np.cos(3 * a), 60)], 0),
}


def sample(name):
    """(points, links) of a scene, with every sample moved along its curve by up to a fifth of the spacing."""
    points, links, rng = [], [], np.random.default_rng(list(name.encode()))
    for radius, count in CURVES[name][0]:
        a = (np.arange(count) + 0.2 * rng.uniform(-1, 1, count)) / count * FULL
        first = sum(map(len, points))
        points.append(np.stack([radius(a) * np.cos(a), radius(a) * np.sin(a), 0 * a], 1))
        links += [(first + i, first + (i + 1) % count) for i in range(count)]
    return np.concatenate(points), {tuple(sorted(x)) for x in links}


def read_edges(path):
    """Vertices (rows of the file) and edges of a PLY file of brio's."""
    with open(path, 'rb') as f:
        vertices = edges = None
        for name, count, properties in ply.read_header(f):
            rows = ply.read_rows(f, count, properties, 0)
            if name == 'vertex': vertices = rows
            elif name == 'edge': edges = np.stack([rows['vertex1'], rows['vertex2']], 1)
    return vertices, edges


def paths(folder, name): return (os.path.join(folder, f'plane-{name}-{what}.ply') for what in ('points', 'crust', 'shape'))


def measure(brio, folder, name):
    points, links = sample(name)
    given, crust, shape = paths(folder, name)
    ply.write_points(given, points)
    done = subprocess.run([brio, 'medial', given, '-o', shape, '--crust', crust, '--json', '--quiet'], stdout=subprocess.PIPE, check=False)
    result = {'points': len(points), 'status': 'done' if done.returncode == 0 else 'no answer', 'wall': 0, 'memory': '', 'needed': '',
              'links': len(links), 'true_euler': CURVES[name][1], 'right': False}
    if done.returncode: return result
    certificate = json.loads(done.stdout)['certificate']
    vertices, edges = read_edges(crust)
    found = {tuple(sorted(e)) for e in vertices['sample'][edges].tolist()}
    inner, joined = read_edges(shape)
    result.update(closed=certificate['closed'], found=len(found), common=len(found & links), euler=len(inner) - len(joined))
    result['right'] = found == links and result['euler'] == result['true_euler'] and result['closed']
    return result


# --- the picture

SIZE, GAP = 280, 10


def draw(folder, out, name='star'):
    """Samples; with the inner circles; the crust with the shape of its inside."""
    given, crust, shape = paths(folder, name)
    if not os.path.exists(shape): return
    points = ply.read_cells(given, 'face', 3)[0][:, :2]
    vertices, edges = read_edges(crust)
    inner, joined = read_edges(shape)
    centres = np.stack([inner['x'], inner['y']], 1)
    low, scale = points.min(0), (SIZE - 20) / np.ptp(points, axis=0).max()

    def place(p): return np.column_stack([10 + (p[:, 0] - low[0]) * scale, SIZE - 10 - (p[:, 1] - low[1]) * scale])

    def lines(a, ends, style):
        a = place(a)
        words = ''.join(f'M{a[i][0]:.1f} {a[i][1]:.1f}L{a[j][0]:.1f} {a[j][1]:.1f}' for i, j in ends)
        return f'<path d="{words}" fill="none" {style}/>'

    dots = ''.join(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="1.6" fill="#33507d"/>' for x, y in place(points))
    circles = ''.join(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{r * scale:.1f}" fill="none" stroke="#c0651f" stroke-width="0.5"/>'
                      for (x, y), r in zip(place(centres), inner['radius']))
    at = np.stack([vertices['x'], vertices['y']], 1)
    curve = lines(at, edges, 'stroke="#222" stroke-width="1.6"')
    panels = [dots, dots + circles, curve + lines(centres, joined, 'stroke="#c0651f" stroke-width="1.2"')]
    width = len(panels) * (SIZE + GAP)
    with open(out, 'w') as f:
        f.write(f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{SIZE}" viewBox="0 0 {width} {SIZE}">'
                f'<rect width="{width}" height="{SIZE}" fill="white"/>\n')
        for i, panel in enumerate(panels): f.write(f'<g transform="translate({i * (SIZE + GAP)} 0)">{panel}</g>\n')
        f.write('</svg>\n')
