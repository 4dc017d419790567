"""crosscheck.py FOLDER [--sets N] [--points N]: brio against CGAL, Qhull, voro++ and GUDHI, each a program of its own in
FOLDER (tests/oracles/peers), on random sets, on degenerate ones, and on sets of ../shared/data where that is there.

Prints a table: peer, what, inputs, simplices compared, differences; exit status 1 if a row that must agree has differences.

Simplices are compared by positions: of coincident points one peer may name another index. What is exact on both sides has to be
the same, ties too, since CGAL and GUDHI (which triangulates with CGAL) break ties by the same perturbation. Qhull and voro++
compute in doubles: their volumes and areas have a tolerance, and Qhull's Delaunay triangulation is compared on random sets alone.
"""

import os
import subprocess
import sys
import tempfile

import numpy as np

TOLERANCE = 1e-9  # of volumes and areas, relative: to the hull's; of cells to those of the mean cell
VALUES = 1e-12    # of alpha values, relative, or to 1e-12 of the greatest value
NONE = 0xffffffff
HERE = os.path.dirname(os.path.abspath(__file__))


# --- sets ---

class Set:
    def __init__(self, points, weights=None, parameter=0.0):
        self.x, self.w, self.parameter = np.ascontiguousarray(points, float) + 0.0, weights, parameter

    def bytes(self):
        n, dimension = self.x.shape
        head = np.array([n, dimension, self.w is not None], "<u8").tobytes() + np.float64(self.parameter).tobytes()
        return head + self.x.tobytes() + (b"" if self.w is None else np.ascontiguousarray(self.w, float).tobytes())

    def positions(self):
        """The number of each point's position."""
        if not len(self.x):
            return np.zeros(0, int)
        return np.unique(self.x, axis=0, return_inverse=True)[1].reshape(-1)


def sphere(rng, n, d):
    p = rng.normal(size=(n, d))
    return p / np.linalg.norm(p, axis=1)[:, None]


def random_sets(count, dimension, seed, most=120):
    """General position but for luck: uniform, normal, near a sphere, flat boxes."""
    rng = np.random.default_rng([seed, dimension])
    for i in range(count):
        n, kind = int(rng.integers(dimension + 2, most)), i % 4
        p = rng.random((n, dimension)) if kind != 1 else rng.normal(size=(n, dimension))
        if kind == 2:
            p = sphere(rng, n, dimension) * (1 + 1e-6 * rng.random((n, 1)))
        if kind == 3:
            p = p * ([1] * (dimension - 1) + [1e-4]) + 10
        yield p


def lattice(rng, d):
    axes = [np.arange(float(rng.integers(1, 5))) for _ in range(d)]
    return np.stack([a.ravel() for a in np.meshgrid(*axes)], axis=1) * float(2.0 ** rng.integers(-3, 4))


def degenerate_sets(count, dimension, seed):
    """Lattices, cospherical points of a lattice, small integers with duplicates, planes and lines, doubles on a sphere."""
    rng = np.random.default_rng([seed, dimension, 1])
    ball = np.stack([a.ravel() for a in np.meshgrid(*[np.arange(-7.0, 8)] * dimension)], axis=1)
    shells = [ball[(ball ** 2).sum(1) == r] for r in (25, 26, 41, 45, 50) if ((ball ** 2).sum(1) == r).sum() > dimension + 1]
    for i in range(count):
        kind, n = i % 6, int(rng.integers(dimension + 1, 60))
        if kind == 0:
            p = lattice(rng, dimension)
        elif kind == 1:
            shell = shells[int(rng.integers(len(shells)))]
            p = np.concatenate([shell, rng.integers(-3, 4, (n % 5, dimension))])
        elif kind == 2:
            p = rng.integers(0, int(rng.integers(2, 7)), (n, dimension)).astype(float)
        elif kind == 3:  # coplanar, collinear, and one point off
            p = rng.integers(0, 6, (n, dimension)).astype(float)
            p[:, -1] = p[:, 0] * rng.integers(-1, 2) + 1 + (p[:, 1] if dimension == 3 and rng.integers(2) else 0)
            p[0, -1] += rng.integers(2)
        elif kind == 4:
            p = sphere(rng, n, dimension)
        else:
            p = rng.random((n, dimension))
            p = np.concatenate([p, p[rng.integers(0, n, n // 2 + 1)]])
        yield rng.permutation(p)


def weights_for(points, rng):
    """None, few values that tie, values that hide points, or those that flatten all lifted points of a lattice."""
    n, kind = len(points), int(rng.integers(3))
    if kind == 0:
        return rng.integers(0, 4, n).astype(float)
    if kind == 1:
        return rng.random(n) * float(np.ptp(points, axis=0).max() or 1) ** 2 * float(rng.choice([0.01, 0.3]))
    whole = np.round(points)
    return (whole ** 2).sum(1) if (whole == points).all() else rng.random(n) * 0.01


def weighted(sets, seed):
    rng = np.random.default_rng([seed, 7])
    return [Set(p, weights_for(p, rng)) for p in sets]


# --- programs ---

def run(program, mode, sets):
    with tempfile.TemporaryDirectory() as folder:
        data, out = os.path.join(folder, "sets"), os.path.join(folder, "out")
        with open(data, "wb") as f:
            for s in sets:
                f.write(s.bytes())
        subprocess.run([program, mode, data, out], check=True, stdout=subprocess.DEVNULL)
        with open(out, "rb") as f:
            raw = f.read()
    at, results = 0, []
    while at < len(raw):
        status, rows, columns = (int(x) for x in np.frombuffer(raw, "<u8", 3, at))
        at += 24
        index = np.frombuffer(raw, "<u4", rows * columns, at).reshape(rows, columns)
        at += 4 * rows * columns
        value = np.frombuffer(raw, "<f8", rows, at)
        at += 8 * rows
        results.append((status, index, value, np.frombuffer(raw, "<f8", 8, at)))
        at += 64
    return results


def by_positions(index, position, first=0):
    """Rows of sorted positions; the first columns stay. Missing indices come last."""
    table = np.append(position, NONE).astype(np.int64)
    where = np.minimum(index[:, first:].astype(np.int64), len(position))
    return np.concatenate([index[:, :first].astype(np.int64), np.sort(table[where], axis=1)], axis=1)


def sorted_rows(rows, value=None):
    order = np.lexsort(rows.T[::-1])
    return rows[order], None if value is None else value[order]


def row_differences(a, b):
    """How many rows are in one of them alone."""
    a, b = sorted_rows(a)[0], sorted_rows(b)[0]
    if a.shape == b.shape and (a == b).all():
        return 0
    return len(set(map(tuple, a.tolist())) ^ set(map(tuple, b.tolist()))) or abs(len(a) - len(b))


# --- comparisons: simplices compared, differences ---

def compare_simplices(s, ours, theirs, first=0):
    if ours[0] or theirs[0]:
        return 0, int((ours[0] == 0) != (theirs[0] == 0))
    position = s.positions()
    a, b = by_positions(ours[1], position, first), by_positions(theirs[1], position, first)
    return len(a), row_differences(a, b)


def compare_filtration(s, ours, theirs):
    count, wrong = compare_simplices(s, ours, theirs)
    if wrong or not count:
        return count, wrong
    position = s.positions()
    _, a = sorted_rows(by_positions(ours[1], position), ours[2])
    _, b = sorted_rows(by_positions(theirs[1], position), theirs[2])
    most = np.abs(b).max()
    return count, int((np.abs(a - b) > VALUES * np.maximum(np.abs(b), 1e-3 * most)).sum())


def compare_hull(s, ours, theirs):
    if ours[0] or theirs[0]:
        return 0, int((ours[0] == 0) != (theirs[0] == 0))
    position = s.positions()
    wrong = row_differences(by_positions(ours[1], position), by_positions(theirs[1], position))
    wrong += int(abs(ours[3][0] - theirs[3][0]) > TOLERANCE * abs(ours[3][0]))
    return len(ours[1]), wrong + int(abs(ours[3][1] - theirs[3][1]) > TOLERANCE * ours[3][1])


def compare_measures(s, ours, theirs):
    """Volumes and areas alone: Qhull joins facets within its tolerance, and then has fewer vertices."""
    if ours[0] or theirs[0]:
        return 0, int((ours[0] == 0) != (theirs[0] == 0))
    return 2, sum(int(abs(ours[3][k] - theirs[3][k]) > TOLERANCE * abs(ours[3][k])) for k in (0, 1))


def compare_cells(s, ours, theirs):
    """Volumes and faces of cells; a face in one result alone must have hardly any area."""
    n = max(len(s.x), 1)
    table = {}
    for sign, (_, index, value, _) in ((1, ours), (-1, theirs)):
        for (site, neighbour), x in zip(index.tolist(), value.tolist()):
            table[site, neighbour] = table.get((site, neighbour), 0) + sign * x
    unit = {True: 1 / n, False: (1 / n) ** (2 / 3)}
    return len(table), sum(abs(x) > TOLERANCE * unit[k[1] == NONE] for k, x in table.items())


# --- tables ---

class Table:
    def __init__(self, folder):
        self.folder, self.wrong = folder, 0
        print("%-8s %-40s %9s %13s %12s" % ("peer", "what", "inputs", "compared", "differences"))

    def program(self, name):
        path = os.path.join(self.folder, name + "_sets")
        return path if os.access(path, os.X_OK) else None

    def row(self, peer, what, mode, sets, compare=compare_simplices, must_agree=True):
        if not self.program(peer):
            print("%-8s %-40s skipped: it was not built: its library is missing" % (peer, what))
            return
        ours, theirs = run(self.program("brio"), mode, sets), run(self.program(peer), mode, sets)
        assert len(ours) == len(theirs) == len(sets)
        total = differences = 0
        for i, (s, a, b) in enumerate(zip(sets, ours, theirs)):
            count, wrong = compare(s, a, b)
            total, differences = total + count, differences + wrong
            if wrong and differences < 200:
                print("  set %d of %d points: %d differences, status %d and %d" % (i, len(s.x), wrong, a[0], b[0]))
        self.wrong += differences if must_agree else 0
        print("%-8s %-40s %9d %13d %12d" % (peer, what, len(sets), total, differences), flush=True)


def middle_alpha(brio, points):
    """Sets with alphas in the middle of the widest gap among the middle values of tetrahedra. Where all of these are equal but
    for rounding, as those of points on a sphere are, the alpha is above them."""
    sets = [Set(p) for p in points]
    for s, (status, index, value, _) in zip(sets, run(brio, "filtration", sets)):
        values = np.unique(value[index[:, 3] != NONE]) if not status else np.array([1.0, 2.0])
        values = values[np.isfinite(values)]
        middle = values[len(values) // 4:len(values) * 3 // 4 + 2] if len(values) > 1 else np.array([0, 2.0])
        gap = int(np.argmax(np.diff(middle))) if len(middle) > 1 else 0
        low, high = float(middle[gap]), float(middle[min(gap + 1, len(middle) - 1)])
        s.parameter = (low + high) / 2 if high - low > 1e-9 * high else 1.5 * high
    return sets


def compare_shapes(s, ours, theirs):
    return compare_simplices(s, ours, theirs, first=1)


def small_sets(table, count):
    for dimension, space in ((3, "space"), (2, "plane")):
        random, degenerate = list(random_sets(count, dimension, 1)), list(degenerate_sets(count, dimension, 2))
        table.row("cgal", "Delaunay, %s, random" % space, "delaunay", [Set(p) for p in random])
        table.row("cgal", "Delaunay, %s, degenerate" % space, "delaunay", [Set(p) for p in degenerate])
        table.row("cgal", "regular, %s, random" % space, "delaunay", weighted(random, 3))
        table.row("cgal", "regular, %s, degenerate" % space, "delaunay", weighted(degenerate, 4))
        table.row("qhull", "Delaunay, %s, random" % space, "delaunay", [Set(p) for p in random if np.ptp(p, axis=0).min() > 0.1])
    random, degenerate = list(random_sets(count, 3, 5)), list(degenerate_sets(count, 3, 6))
    some = [p for p in random[:count // 4] + degenerate[:count // 4]]
    table.row("cgal", "alpha shapes", "shape", middle_alpha(table.program("brio"), some), compare_shapes)
    full = [p for p in degenerate if np.linalg.matrix_rank(p - p[0]) == 3]
    table.row("qhull", "hulls, random", "hull", [Set(p) for p in random], compare_hull)
    table.row("qhull", "hulls, degenerate", "hull", [Set(p) for p in full], compare_hull)
    table.row("gudhi", "alpha filtration, random", "filtration", [Set(p) for p in random[:count // 4]], compare_filtration)
    table.row("gudhi", "alpha filtration, degenerate", "filtration", [Set(p) for p in full[:count // 4]], compare_filtration)
    table.row("gudhi", "weighted alpha filtration, random", "filtration", weighted(random[:count // 8], 8), compare_filtration)
    table.row("gudhi", "weighted alpha filtration, degenerate", "filtration", weighted(full[:count // 8], 9), compare_filtration)


def boxed_sets(table, count):
    """Cells in the unit cube: random sites, lattices, weights of which some hide sites."""
    rng = np.random.default_rng(11)
    plain = [rng.random((int(rng.integers(1, 300)), 3)) for _ in range(count // 4)]
    grids = []
    for _ in range(count // 8):
        g = lattice(rng, 3)
        grids.append((g + 0.5 * (g.max() / 4 + 1e-3)) / (g.max() * 1.5 + 1e-2))
    heavy = [Set(p, (rng.random(len(p)) * len(p) ** (-1 / 3)) ** 2) for p in plain]
    table.row("voropp", "cells in a box, random", "cells", [Set(p) for p in plain], compare_cells)
    table.row("voropp", "cells in a box, lattices", "cells", [Set(p) for p in grids], compare_cells)
    table.row("voropp", "power cells in a box", "cells", heavy, compare_cells)


def shared_points(brio_program, most):
    """Points of the sets beside the project, read by brio."""
    root = os.environ.get("BRIO_SHARED") or os.path.join(HERE, "..", "..", "..", "shared")
    for kind in "hostile", "model", "scan", "lidar", "volume":
        folder = os.path.join(root, "data", kind)
        for name in sorted(os.listdir(folder)) if os.path.isdir(folder) else []:
            with tempfile.TemporaryDirectory() as out:
                npy = os.path.join(out, "points.npy")
                done = subprocess.run([brio_program, "convert", os.path.join(folder, name), npy, "--quiet"],
                                      stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                if done.returncode or not os.path.exists(npy):
                    continue
                p = np.load(npy)
                if p.dtype.names:
                    p = np.stack([p[k].astype(float) for k in "xyz"], axis=1)
                if p.ndim == 2 and p.shape[1] >= 3 and 0 < len(p) <= most:
                    yield kind, p[:, :3].astype(float)


def shared_sets(table, brio_program, most):
    found = list(shared_points(brio_program, most))
    if not found:
        print("skipped: the sets of ../shared/data: they are not there")
        return
    for kind in sorted({k for k, _ in found}):
        points = [p for k, p in found if k == kind]
        table.row("cgal", "Delaunay, shared: %s" % kind, "delaunay", [Set(p) for p in points])
        table.row("cgal", "regular, shared: %s" % kind, "delaunay",
                  [Set(p, np.arange(len(p)) * 7919 % 1000 * (float(np.ptp(p, axis=0).max()) / 1e4 + 1e-9) ** 2) for p in points])
        table.row("cgal", "Delaunay of x and y, shared: %s" % kind, "delaunay", [Set(p[:, :2]) for p in points])
        table.row("qhull", "hulls: volume, area, shared: %s" % kind, "hull",
                  [Set(p) for p in points if np.linalg.matrix_rank(p - p[0]) == 3], compare_measures, must_agree=False)


def option(name, default):
    return int(sys.argv[sys.argv.index(name) + 1]) if name in sys.argv else default


def main():
    table = Table(sys.argv[1])
    small_sets(table, option("--sets", 2000))
    boxed_sets(table, option("--sets", 2000))
    shared_sets(table, os.environ.get("BRIO", os.path.join(sys.argv[1], "brio")), option("--points", 120000))
    print("%d differences" % table.wrong)
    return 1 if table.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
