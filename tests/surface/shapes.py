"""shapes.py [--short] [--only WORD,...] [--samplings NAME,...] [--options "..."] [--tsv FILE]: surfaces of known shapes, most
of them open, against the truth.

Each shape is sampled evenly, at random, and in lines as a scanner's: 1.6 spacings from line to line, 1 / 1.6 along a line. Nothing
but the points is given. Of the surface it prints
  area       in per cent of the true one; a surface ends at its last samples, so that half a spacing along each rim is missing
  invented   area farther than 2.5 spacings from the shape, in per cent
  missing    area of the shape farther than 2 spacings from the surface
  turned     area of the rest that looks the wrong way, each component turned as suits it best
  parts      components; crumbs, of under a hundredth of the area, are counted apart as shards
  loops      boundary loops, and the true number; of spheres with holes it has to be one for each hole that stays open
  halves     holes that are neither open nor filled: 10 to 90 per cent of their area is covered
A run is right if these are what the shape has: area to 3 per cent, the three others at most 2, 2 and 1, no shards, no halves.

BRIO names the program. Needs numpy and scipy."""
import argparse
import json
import os
import subprocess
import sys
import tempfile

SKIPPED = 77
try:
    import numpy as np
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree
except ImportError as missing:
    print("skipped: data.shapes: " + str(missing))
    sys.exit(SKIPPED)

BRIO = os.environ.get("BRIO", "brio")
SAMPLINGS = ("even", "random", "lines")
AREA, INVENTED, MISSING, TURNED = 3, 2, 2, 1
PITCH = 1.6


# --- pieces of shapes: maps of the unit square ---

class Rectangle:
    def __init__(self, corner, along, up):
        self.corner, self.along, self.up = (np.array(a, float) for a in (corner, along, up))
        self.normal = np.cross(self.along, self.up)
        self.area = np.linalg.norm(self.normal)
        self.normal /= self.area

    def at(self, u, v):
        p = self.corner + u[:, None] * self.along + v[:, None] * self.up
        return p, np.tile(self.normal, (len(u), 1))

    def even(self, v):
        return v

    def height(self):
        return np.linalg.norm(self.up)

    def length(self, v):
        return np.linalg.norm(self.along)


class Cylinder:
    """Round the z axis."""
    def __init__(self, radius, low, high, angle=2 * np.pi, inwards=False):
        self.radius, self.low, self.high, self.angle, self.sign = radius, low, high, angle, -1 if inwards else 1
        self.area = radius * angle * (high - low)

    def at(self, u, v):
        a = self.angle * u
        n = np.stack([np.cos(a), np.sin(a), np.zeros_like(a)], 1)
        p = self.radius * n
        p[:, 2] = self.low + v * (self.high - self.low)
        return p, self.sign * n

    def even(self, v):
        return v

    def height(self):
        return self.high - self.low

    def length(self, v):
        return self.radius * self.angle


class Band:
    """Of a sphere, between two angles from the north pole."""

    def __init__(self, radius, begin, end):
        self.radius, self.begin, self.end = radius, begin, end
        self.area = 2 * np.pi * radius ** 2 * (np.cos(begin) - np.cos(end))

    def at(self, u, v):
        a, t = 2 * np.pi * u, self.begin + v * (self.end - self.begin)
        n = np.stack([np.sin(t) * np.cos(a), np.sin(t) * np.sin(a), np.cos(t)], 1)
        return self.radius * n, n

    def even(self, v):
        """The parameter below which the share v of the area is."""
        c = np.cos(self.begin) + v * (np.cos(self.end) - np.cos(self.begin))
        return (np.arccos(np.clip(c, -1, 1)) - self.begin) / (self.end - self.begin)

    def height(self):
        return self.radius * (self.end - self.begin)

    def length(self, v):
        return 2 * np.pi * self.radius * np.sin(self.begin + v * (self.end - self.begin))


class Disk:
    """Level, round the z axis."""

    def __init__(self, radius, z, down=False, inner=0):
        self.radius, self.inner, self.z, self.sign = radius, inner, z, -1 if down else 1
        self.area = np.pi * (radius ** 2 - inner ** 2)

    def at(self, u, v):
        a, r = 2 * np.pi * u, self.inner + v * (self.radius - self.inner)
        p = np.stack([r * np.cos(a), r * np.sin(a), np.full(len(u), float(self.z))], 1)
        return p, np.tile([0., 0, self.sign], (len(u), 1))

    def even(self, v):
        r = np.sqrt(self.inner ** 2 + v * (self.radius ** 2 - self.inner ** 2))
        return (r - self.inner) / (self.radius - self.inner)

    def height(self):
        return self.radius - self.inner

    def length(self, v):
        return 2 * np.pi * (self.inner + v * (self.radius - self.inner))


class Shape:
    """Pieces without the caps that `holes` cut out of a sphere of radius 1: (direction, angle)."""

    def __init__(self, pieces, loops, holes=(), points=6000, parts=1):
        self.pieces, self.loops, self.holes, self.points, self.parts = pieces, loops, holes, points, parts
        self.area = sum(p.area for p in pieces) - sum(2 * np.pi * (1 - np.cos(a)) for _, a in holes)
        self.spacing = np.sqrt(self.area / points)

    def without_holes(self, p, n):
        keep = np.ones(len(p), bool)
        for direction, angle in self.holes:
            keep &= p @ direction < np.cos(angle)
        return p[keep], n[keep]

    def random(self, count, rng):
        share = np.array([p.area for p in self.pieces])
        which = rng.choice(len(share), count, p=share / share.sum())
        got = [piece.at(rng.random(k), piece.even(rng.random(k))) for piece, k in zip(self.pieces, np.bincount(which, minlength=len(share)))]
        return self.without_holes(*(np.concatenate(a) for a in zip(*got)))

    def even(self, rng):
        """No two nearer than a radius at which about as many remain as are wanted."""
        p, _ = self.random(10 * self.points, rng)
        return p[thinned(p, 0.8 * self.spacing)]

    def lines(self, rng):
        got = []
        for piece in self.pieces:
            rows = max(2, int(piece.height() / self.spacing / PITCH))
            for v in (np.arange(rows) + 0.5) / rows:
                count = max(3, int(piece.length(v) / self.spacing * PITCH))
                u = (np.arange(count) + rng.random() + 0.1 * rng.normal(size=count)) / count
                got.append(self.without_holes(*piece.at(np.clip(u, 0, 1), np.full(count, v)))[0])
        return np.concatenate(got)


def thinned(p, radius):
    near = cKDTree(p).query_pairs(radius, output_type="ndarray")
    near = np.concatenate([near, near[:, ::-1]])
    near = near[np.argsort(near[:, 0], kind="stable")]
    start = np.searchsorted(near[:, 0], np.arange(len(p) + 1))
    free, keep = np.ones(len(p), bool), np.zeros(len(p), bool)
    for i in range(len(p)):
        if free[i]:
            keep[i] = True
            free[near[start[i]:start[i + 1], 1]] = False
    return keep


def box(inside, without=()):
    """The walls of the unit cube, named by axis and side, but for some."""
    walls = []
    for axis in range(3):
        for side in (0, 1):
            if (axis, side) in without:
                continue
            corner, along, up = np.zeros(3), np.roll([0., 1, 0], axis), np.roll([0., 0, 1], axis)
            corner[axis] = side
            out = side == 1
            walls.append(Rectangle(corner, along, up) if out != inside else Rectangle(corner, up, along))
    return walls


def cup(wall):
    r, h = 1, 2
    return [Cylinder(r, 0, h), Disk(r, 0, down=True), Cylinder(r - wall, wall, h, inwards=True), Disk(r - wall, wall),
            Disk(r, h, inner=r - wall)]


def holes_of(size, points, count):
    """Holes of a given number of spacings across, far apart."""
    angle = size * np.sqrt(4 * np.pi / points) / 2
    k = np.arange(count) + 0.5
    z, a = 1 - 2 * k / count, np.pi * (1 + 5 ** 0.5) * k
    r = np.sqrt(1 - z * z)
    return [(np.array([r[i] * np.cos(a[i]), r[i] * np.sin(a[i]), z[i]]), angle) for i in range(count)]


def shapes():
    tall, sphere = np.pi / 2, [Band(1, 0, np.pi)]
    all_shapes = {
        "hemisphere": Shape([Band(1, 0, tall)], 1),
        "pipe": Shape([Cylinder(1, 0, 4)], 2),
        "bowl": Shape([Band(1, 2 * np.pi / 3, np.pi)], 1),
        "half cylinder": Shape([Cylinder(1, 0, 3, np.pi)], 1),
        "strip": Shape([Cylinder(10, 0, 0.3, 2)], 1, points=600),  # three spacings wide; of a plane, brio says that it is one
        "patch": Shape([Cylinder(3, 0, 1, 1 / 3)], 1),
        "room": Shape(box(True), 0),
        "room without a wall": Shape(box(True, [(0, 0)]), 1),
        "crossing sheets": Shape([Rectangle([-1, -1, 0], [2, 0, 0], [0, 2, 0]),
                                  Rectangle([-1, 0.02, -1], [2, 0, 0], [0, 0, 2])], None, parts=None),
    }
    for size, count in ((2, 12), (3, 12), (5, 12), (8, 8), (12, 6), (20, 4)):
        all_shapes["holes of %d" % size] = Shape(sphere, count, holes_of(size, 12000, count), points=12000)
    for spacings in (0.5, 1, 2, 3, 5):
        one = Shape(cup(0.05), 0)
        all_shapes["cup, wall of %g" % spacings] = Shape(cup(0.05), 0, points=int(one.area * (spacings / 0.05) ** 2))
    return all_shapes


SHORT = ("hemisphere", "room without a wall", "holes of 12", "cup, wall of 1")


# --- what came of it ---

def write_points(path, p):
    with open(path, "wb") as f:
        head = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(p)
        f.write((head + "".join("property double %s\n" % c for c in "xyz") + "end_header\n").encode())
        f.write(np.ascontiguousarray(p, "<f8").tobytes())


def read_stl(path):
    """The triangles of a binary STL file, and their corners, merged."""
    with open(path, "rb") as f:
        f.seek(80)
        count = int(np.frombuffer(f.read(4), "<u4")[0])
        rows = np.frombuffer(f.read(), np.dtype([("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")]), count)
    v, to = np.unique(rows["v"].reshape(-1, 3), axis=0, return_inverse=True)
    return v.astype(float), np.asarray(to).reshape(-1, 3)


def areas_and_normals(v, f):
    n = np.cross(v[f[:, 1]] - v[f[:, 0]], v[f[:, 2]] - v[f[:, 0]])
    twice = np.linalg.norm(n, axis=1)
    return twice / 2, n / np.maximum(twice, 1e-300)[:, None]


def scattered(v, f, area, count, rng):
    i = rng.choice(len(f), count, p=area / area.sum())
    s, t = rng.random(count), rng.random(count)
    s, t = np.where(s + t > 1, 1 - s, s), np.where(s + t > 1, 1 - t, t)
    a = v[f[i, 0]]
    return a + s[:, None] * (v[f[i, 1]] - a) + t[:, None] * (v[f[i, 2]] - a), i


def parts_of(v, f):
    a, b = f.ravel(), np.roll(f, -1, 1).ravel()
    key = np.minimum(a, b) * len(v) + np.maximum(a, b)
    _, edge = np.unique(key, return_inverse=True)
    face = np.arange(len(a)) // 3
    together = coo_matrix((np.ones(len(a)), (face, len(f) + edge)), (len(f) + edge.max() + 1,) * 2)
    label = connected_components(together, False)[1][:len(f)]
    return np.unique(label, return_inverse=True)[1]


def halves_of(shape, v, f, area, rng):
    """How many holes are covered in part, and how many are open."""
    halves = still_open = 0
    middle = v[f].mean(1)
    middle /= np.linalg.norm(middle, axis=1)[:, None]
    for direction, angle in shape.holes:
        inner = np.cos(0.8 * angle)
        near = np.flatnonzero(middle @ direction > np.cos(min(np.pi, 2 * angle + 4 * shape.spacing)))
        S = scattered(v, f[near], area[near], 40000, rng)[0] if len(near) else np.zeros((0, 3))
        share = (S @ direction > inner * np.linalg.norm(S, axis=1)).mean() if len(S) else 0
        covered = share * area[near].sum() / (2 * np.pi * (1 - inner))
        halves += 0.1 < covered < 0.9
        still_open += covered < 0.5
    return halves, still_open


def judge(shape, mesh, certificate, rng):
    v, f = mesh
    area, normal = areas_and_normals(v, f)
    T, NT = shape.random(200000, rng)
    S, face = scattered(v, f, area, 100000, rng)
    distance, nearest = cKDTree(T).query(S)
    far = distance > 2.5 * shape.spacing
    missing = (cKDTree(S).query(T[:40000])[0] > 2 * shape.spacing).mean()
    part = parts_of(v, f)
    size = np.bincount(part, area)
    wrong = ((normal[face] * NT[nearest]).sum(1) < 0) & ~far
    counts, bad = np.bincount(part[face[~far]], minlength=len(size)), np.bincount(part[face], wrong, len(size))
    # whatever two sheets have in common may look either way
    turned = 0 if shape.parts is None else np.minimum(bad, counts - bad).sum() / max(1, (~far).sum())
    halves, still_open = halves_of(shape, v, f, area, rng)
    shards = int((size < 0.01 * size.sum()).sum())
    loops = certificate["boundary_loops"]
    expected = shape.loops if not shape.holes else still_open
    figures = dict(area=100 * area.sum() / shape.area, invented=100 * far.mean(), missing=100 * missing, turned=100 * turned,
                   parts=len(size) - shards, shards=shards, loops=loops, of=expected, halves=halves, open=still_open)
    rim = 60 * shape.spacing * perimeter(v, f) / shape.area
    filled = filled_share(shape, still_open)
    right = [-AREA - rim <= figures["area"] - 100 <= AREA + filled, figures["invented"] <= INVENTED + filled,
             figures["missing"] <= MISSING, figures["turned"] <= TURNED, not shards, not halves, certificate["manifold"],
             expected is None or loops == expected, shape.parts is None or figures["parts"] == shape.parts]
    return figures, all(right)


def filled_share(shape, still_open):
    if not shape.holes:
        return 0
    cap = 2 * np.pi * (1 - np.cos(shape.holes[0][1]))
    return 100 * cap * (len(shape.holes) - still_open) / shape.area


def perimeter(v, f):
    a, b = f.ravel(), np.roll(f, -1, 1).ravel()
    key = np.minimum(a, b) * len(v) + np.maximum(a, b)
    _, first, count = np.unique(key, return_index=True, return_counts=True)
    rim = first[count == 1]
    return np.linalg.norm(v[a[rim]] - v[b[rim]], axis=1).sum()


def surface_of(p, options):
    with tempfile.TemporaryDirectory() as folder:
        source, made = os.path.join(folder, "points.ply"), os.path.join(folder, "surface.stl")
        write_points(source, p)
        done = subprocess.run([BRIO, "surface", source, "-o", made, "--json", "--triangulate"] + options, capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(done.stderr.strip())
        return read_stl(made), json.loads(done.stdout)


def run(name, shape, sampling, options):
    rng = np.random.default_rng([SAMPLINGS.index(sampling)] + [ord(c) for c in name])
    p = shape.random(shape.points, rng)[0] if sampling == "random" else getattr(shape, sampling)(rng)
    mesh, report = surface_of(p, options)
    return (len(p),) + judge(shape, mesh, report["certificate"], rng) + (report,)


HEAD = "shape\tsampling\tpoints\tarea\tinvented\tmissing\tturned\tparts\tshards\tloops\tof\thalves\topen\tnoise\tright"


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("--short", action="store_true")
    a.add_argument("--only", default="")
    a.add_argument("--samplings", default=",".join(SAMPLINGS))
    a.add_argument("--options", default="")
    a.add_argument("--tsv")
    a = a.parse_args()
    out = open(a.tsv, "w") if a.tsv else None
    rows = [HEAD]
    print(HEAD)
    wrong = 0
    for name, shape in shapes().items():
        if a.only and not any(w in name for w in a.only.split(",")) or a.short and name not in SHORT:
            continue
        for sampling in ("even",) if a.short else a.samplings.split(","):
            try:
                n, f, right, report = run(name, shape, sampling, a.options.split())
                row = "%s\t%s\t%d\t%.1f\t%.1f\t%.1f\t%.1f\t%d\t%d\t%d\t%s\t%d\t%d\t%.3f\t%d" % (
                    name, sampling, n, f["area"], f["invented"], f["missing"], f["turned"], f["parts"], f["shards"], f["loops"],
                    f["of"], f["halves"], f["open"], report["noise"], right)
            except RuntimeError as e:
                row, right = "%s\t%s\t%s" % (name, sampling, str(e).split("\n")[0]), False
            wrong += not right
            rows.append(row)
            print(row, flush=True)
    if out:
        out.write("\n".join(rows) + "\n")
    print("%d of %d right" % (len(rows) - 1 - wrong, len(rows) - 1))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
