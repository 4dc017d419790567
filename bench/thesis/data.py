"""The thesis' class of data: raw scans, in translated copies, and molecular iso-surfaces, one of them refined by subdivision;
and the kinds of points that chapter 5.8 asks for."""
import os
import subprocess
import sys
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
SHARED = os.path.join(os.environ.get('BRIO_SHARED', os.path.join(HERE, '..', '..', '..', 'shared')), 'data')

sys.path.append(os.path.join(HERE, '..'))
from points import read_points


def _header(n):
    lines = ['ply', 'format binary_little_endian 1.0', f'element vertex {n}'] + [f'property float {c}' for c in 'xyz']
    return ('\n'.join(lines) + '\nend_header\n').encode()


def write_copies(points, copies, path):
    """Copies beside each other along x, an eighth of the width apart, in single precision as scans have it."""
    step = 1.125 * (points[:, 0].max() - points[:, 0].min())
    with open(path, 'wb') as f:
        f.write(_header(copies * len(points)))
        for i in range(copies):
            (points + np.array([i * step, 0, 0])).astype('<f4').tofile(f)


BLOCK = 2000  # points of a block, about


def sequence(points, order):
    """The order of insertion, as `brio delaunay --order` describes it: blocks are cells of an octree, depth first, and points of
    one block are in random order; in a BRIO, of rounds each of which has half of the points before it."""
    rng = np.random.default_rng(3)
    shuffled = rng.permutation(len(points))
    if order == 'random': return shuffled
    levels = max(1, int(np.ceil(np.log2(max(1, len(points) / BLOCK)) / 2)))  # a surface meets a quarter of the cells of a level
    extent = np.ptp(points, axis=0).max() or 1
    cell = np.minimum((points - points.min(0)) / extent * 2 ** levels, 2 ** levels - 1).astype(np.int64)
    code = sum(((cell[:, k] >> bit) & 1) << (3 * bit + k) for bit in range(levels) for k in range(3))
    rounds = np.zeros(len(points), int) if order == 'octree' else -rng.geometric(0.5, len(points))
    return shuffled[np.lexsort((code[shuffled], rounds[shuffled]))]


class Data:
    """Sets by name, each made when it is first asked for, all removed by close()."""

    def __init__(self, brio, folder, shrink):
        self.brio, self.folder, self.shrink, self.made = brio, folder, shrink, {}

    def _scan(self):
        real = os.path.join(SHARED, 'scan', 'happy_raw.ply')
        if os.path.exists(real): return read_points(real)[::self.shrink]
        print('happy_raw is not here; a simulated scan stands in')
        path = os.path.join(self.folder, 'simulated.ply')
        self._call('generate', 'scan', '-n', str(1100000 // self.shrink), '-o', path)
        points = read_points(path)
        os.remove(path)
        return points

    def _call(self, *arguments):
        subprocess.run([self.brio, *arguments, '--quiet'], check=True)

    def _dragon(self):
        real = os.path.join(SHARED, 'scan', 'dragon_raw.ply')
        if os.path.exists(real): return read_points(real)[::self.shrink]
        return self._scan()

    def _lidar(self, n):
        """Points of an airborne scan, in its own sequence; lines over hills stand in."""
        real = os.path.join(SHARED, 'lidar', 'autzen.ply')
        if os.path.exists(real):
            points = read_points(real)
            return points[:n] - points[0]
        i, rng = np.arange(n), np.random.default_rng(8)
        a_line = int(np.sqrt(n))
        x, y = (i // a_line + 0.1 * rng.random(n)) / a_line, (i % a_line + 0.1 * rng.random(n)) / a_line
        return np.column_stack([x, y, 0.05 * np.sin(9 * x) * np.cos(7 * y) + 0.02 * (rng.random(n) < 0.1) * rng.random(n)])

    def _mtd(self, path):
        """An iso-surface of MTD's size."""
        volume, mesh = os.path.join(SHARED, 'volume', '3ek3-2fofc.map'), path + '.mesh.ply'
        self._call('iso', volume, '--sigma', '--level', '1', '-n', str(185000 // self.shrink), '-o', mesh)
        write_copies(read_points(mesh), 1, path)
        os.remove(mesh)

    def _surface(self, path, levels):
        """An iso-surface that one level of subdivision brings to B-1's size."""
        level0, volume = os.path.join(self.folder, 'iso.ply'), os.path.join(SHARED, 'volume', '3ek3-2fofc.map')
        if not os.path.exists(level0):
            self._call('iso', volume, '--sigma', '--level', '1', '-n', str(131000 // self.shrink), '-o', level0)
        fine = path + '.fine.ply'
        self._call('subdivide', level0, '--levels', str(levels), '-o', fine)
        write_copies(read_points(fine), 1, path)
        os.remove(fine)

    def path(self, name):
        """happy-COPIES, part-K (every Kth point of happy), dragon, mtd, b1, b2, or KIND-N with KIND of figures.KINDS."""
        if name in self.made: return self.made[name]
        path = os.path.join(self.folder, name + '.ply')
        kind, _, number = name.partition('-')
        if kind == 'happy':
            write_copies(self._scan(), int(number), path)
        elif kind == 'part':
            write_copies(self._scan()[::int(number)], 1, path)
        elif kind == 'uniform':
            self._call('generate', 'cube', '-n', number, '-o', path)
        elif kind == 'lidar':
            write_copies(self._lidar(int(number)), 1, path)
        elif number:
            self._call('generate', kind, '-n', number, '-o', path)
        elif kind == 'dragon':
            write_copies(self._dragon(), 1, path)
        elif kind == 'mtd':
            self._mtd(path)
        else:
            self._surface(path, {'b1': 1, 'b2': 2}[name])
        self.made[name] = path
        return path

    def raw(self, name, order):
        """The points of a set as doubles, in an order of insertion: random, octree or brio-octree."""
        path = f'{self.path(name)}.{order}.raw'
        if not os.path.exists(path):
            points = read_points(self.path(name)).astype('<f8')
            points[sequence(points, order)].tofile(path)
        return path

    def points(self, name):
        with open(self.path(name), 'rb') as f:
            for line in iter(f.readline, b'end_header\n'):
                if line.startswith(b'element vertex'): return int(line.split()[2])

    def drop(self, name):
        """Frees the disk of a large set."""
        if name in self.made: os.remove(self.made.pop(name))

    def close(self):
        for name in list(self.made): self.drop(name)
        if os.path.exists(os.path.join(self.folder, 'iso.ply')): os.remove(os.path.join(self.folder, 'iso.ply'))
