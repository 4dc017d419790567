"""random_calls.py [--seed N] [--calls N | --minutes M]: random calls of the package, held against properties.

Each call takes an array as C-contiguous float64, and the same numbers in another form: of another type, in another order of
memory, strided, reversed, unaligned, read-only, as lists or objects; or it takes something hostile: NaN, infinities, other
shapes, other kinds, nothing, far too much. What must hold:

- the same numbers in another form have the same result, bit for bit, or fail with the same exception;
- a failure is one of `brio.errors`, with a sentence, and none of the library's own faults; for memory it may be Python's;
- the caller's arrays are as they were.

A call that breaks this is printed with its seed, which repeats it, and the exit status is 1.
"""

import argparse
import sys
import time
import warnings

import numpy as np

import brio

warnings.simplefilter("ignore")
FAULTS = (brio.InternalError, brio.CheckError)


# --- arrays ---


class Subclass(np.ndarray):
    """An array of a class of the caller's own."""


class Wrapped:
    """Something that is an array when asked for it."""

    def __init__(self, values):
        self.values = values

    def __array__(self, dtype=None, copy=None):
        return np.array(self.values, dtype=dtype)


def base(rng, columns):
    """Numbers as C-contiguous float64: random, of a grid with ties, of a sphere, hostile but finite."""
    n = int(rng.choice([0, 1, 2, 3, 4, 5, 7, 12, 30, 60]))
    kind = rng.integers(5)
    if kind == 0:
        return rng.random((n, columns))
    if kind == 1:
        return rng.integers(-2, 3, (n, columns)).astype(float)
    if kind == 2:
        rows = rng.normal(size=(n, columns))
        return rows / np.linalg.norm(rows, axis=1, keepdims=True)
    if kind == 3:
        return rng.choice([0, -0.0, 1, 1e-300, 1e300, -1e150, 5e-324, 1 + 2.0**-52], (n, columns))
    return np.repeat(rng.random((max(n // 3, 1), columns)), 3, axis=0)


def unaligned(a):
    raw = bytearray(a.nbytes + 1)
    out = np.frombuffer(raw, np.uint8)[1:].view(np.float64).reshape(a.shape)
    out[...] = a
    return out


def spread(a):
    out = np.full((2 * a.shape[0], 3 * a.shape[1]), np.nan)
    out[::2, ::3] = a
    return out[::2, ::3]


def frozen(a):
    a = a.copy()
    a.flags.writeable = False
    return a


FORMS = {
    "list": lambda a: a.tolist() if len(a) else a,
    "tuple": lambda a: tuple(map(tuple, a.tolist())) if len(a) else a,
    "Fortran": np.asfortranarray,
    "strided": spread,
    "reversed": lambda a: a[::-1].copy()[::-1],
    "columns reversed": lambda a: a[:, ::-1].copy()[:, ::-1],
    "other byte order": lambda a: a.astype(a.dtype.newbyteorder()),
    "long double": lambda a: a.astype(np.longdouble),
    "objects": lambda a: a.astype(object),
    "unaligned": unaligned,
    "read-only": frozen,
    "subclass": lambda a: a.view(Subclass),
    "wrapped": Wrapped,
    "memoryview": lambda a: memoryview(a) if len(a) else a,
    "transposed twice": lambda a: a.T.copy().T,
}


def hostile(rng, columns):
    a = base(rng, columns)
    spoilt = a.copy()
    if len(a):
        spoilt[rng.integers(len(a)), rng.integers(columns)] = rng.choice([np.nan, np.inf, -np.inf])
    things = [
        spoilt, a[:, : columns - 1], np.hstack([a, a]), a[0] if len(a) else a, a[None], a.ravel(), np.array(1.5), None, "points",
        b"bytes", object(), {}, [[]], [[1, 2, 3], [4, 5]], a.astype(complex), a.astype("U8"), np.ma.masked_invalid(spoilt),
        np.array([[None] * columns]), np.array([["a"] * columns], object), np.zeros((4, columns), "datetime64[s]"),
        np.zeros(4, [("x", "f8"), ("y", "f8"), ("z", "f8")]), np.broadcast_to(0.5, (2**41, columns)),
        [[10**400] * columns], np.full((5, columns), 2**63, np.uint64), np.zeros((0, columns + 1)), iter([1, 2, 3])]
    return things[rng.integers(len(things))]


# --- calls ---


def parts(result):
    """All arrays and numbers of a result."""
    if isinstance(result, (tuple, list)):
        return [part for item in result for part in parts(item)]
    if isinstance(result, brio.Mesh):
        return [result.vertices, result.face_offsets, result.face_vertices, result.tetrahedra, result.edges]
    return [np.asarray(result)]


def of_triangulation(p, o):
    t = brio.Delaunay(p, **o)
    t.verify()
    return [t.simplices, t.neighbors, t.representatives, t.convex_hull, t.find_simplex(t.points), t.checksum]


def of_diagram(p, o):
    v = brio.Voronoi(p, **o)
    return [v.vertices, v.ridge_points, v.point_region]


def of_hull(p, o):
    h = brio.ConvexHull(p)
    return [h.simplices, h.vertices, h.volume, h.area]


def of_complex(p, o):
    c = brio.alpha_complex(p, **o)
    return [c.auto_alpha(), [v for _, v in c.filtration()]]


def of_mesh(p, o):
    m = brio.Mesh(p, [[0, 1, 2]] if len(np.asarray(p)) > 2 else None)
    return [m, m.normals, m.certificate.closed]


def interpolated(kind):
    def call(p, o):
        rows = np.asarray(p, float)
        return kind(p, rows[:, 0] - rows[:, 1])(rows * 0.5 + 0.25)

    return call


def weighted(rng, n):
    kind = rng.integers(4)
    if kind == 0:
        return {"weights": rng.random(n)}
    if kind == 1:
        return {"weights": rng.integers(0, 9, n)[::-1]}
    return {}


CALLS = [
    ("Delaunay", (2, 3), of_triangulation, True), ("Voronoi", (2, 3), of_diagram, True),
    ("ConvexHull", (2, 3), of_hull, False), ("alpha_complex", (2, 3), of_complex, True),
    ("thin", (3,), lambda p, o: brio.thin(p, 0.3), False), ("outliers", (3,), lambda p, o: brio.outliers(p, 4), False),
    ("LinearNDInterpolator", (2, 3), interpolated(brio.LinearNDInterpolator), False),
    ("NaturalNeighbourInterpolator", (2, 3), interpolated(brio.NaturalNeighbourInterpolator), False),
    ("reconstruct", (3,), lambda p, o: brio.reconstruct(p), False),
    ("cocone", (3,), lambda p, o: brio.reconstruct(p, "cocone"), False),
    ("oriented_normals", (3,), lambda p, o: brio.oriented_normals(p), False),
    ("offset", (3,), lambda p, o: brio.offset(p, 0.1), False),
    ("medial_axis", (3,), lambda p, o: brio.medial_axis(p), False), ("Mesh", (3,), of_mesh, False)]


TRIANGLE = brio.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
HOSTILE = {  # where a call above looks at the points itself, and arrays of other uses
    "Mesh": lambda p, o: brio.Mesh(p), "faces": lambda p, o: brio.Mesh(np.zeros((9, 3)), p),
    "tetrahedra": lambda p, o: brio.Mesh(np.zeros((9, 3)), tetrahedra=p),
    "properties": lambda p, o: brio.Mesh(np.zeros((4, 3)), properties={"a": p}), "select": lambda p, o: TRIANGLE.select(p),
    "samples": lambda p, o: brio.Mesh(np.zeros((4, 3))).carry_properties(TRIANGLE, p),
    "weights": lambda p, o: brio.Delaunay(np.zeros((4, 3)), p), "values": lambda p, o: brio.LinearNDInterpolator(np.eye(3), p),
    "xi": lambda p, o: brio.LinearNDInterpolator(np.eye(3), [1, 2, 3])(p), "LinearNDInterpolator": lambda p, o: brio.LinearNDInterpolator(p, [1.0, 2.0, 3.0]),
           "NaturalNeighbourInterpolator": lambda p, o: brio.NaturalNeighbourInterpolator([[0, 0, 0]], p)}


def outcome(call, points, options):
    """The parts of the result, or the exception."""
    try:
        return parts(call(points, options))
    except brio.Error as error:
        assert not isinstance(error, FAULTS), "%s: %s" % (type(error).__name__, error)
        assert error.sentence, "a failure without a sentence"
        return error
    except MemoryError as error:
        return error


def same(a, b):
    if isinstance(a, Exception) or isinstance(b, Exception):
        return type(a) is type(b)
    return len(a) == len(b) and all(
        x.shape == y.shape and x.dtype == y.dtype and np.array_equal(x, y, equal_nan=x.dtype.kind == "f") for x, y in zip(a, b))


def attempt(seed):
    """One random call, or two of the same numbers.   Returns its name and what came of it."""
    rng = np.random.default_rng(seed)
    name, dimensions, call, takes_weights = CALLS[rng.integers(len(CALLS))]
    columns = int(rng.choice(dimensions))
    if rng.random() < 0.4:
        thing = hostile(rng, columns)
        if rng.random() < 0.3:
            name = list(HOSTILE)[rng.integers(len(HOSTILE))]
        got = outcome(HOSTILE.get(name, call), thing, {})
        return name, type(got).__name__ if isinstance(got, Exception) else "fine"
    a = base(rng, columns)
    options = weighted(rng, len(a)) if takes_weights else {}
    before = a.tobytes(), {k: v.tobytes() for k, v in options.items()}
    form = list(FORMS)[rng.integers(len(FORMS))]
    if form == "tuple" and "Interpolator" in name:  # which take a tuple for the coordinates along each axis, as scipy's do
        form = "list"
    other = FORMS[form](a)
    as_it_was = other.tobytes() if isinstance(other, np.ndarray) and other.dtype != object else None
    first, second = outcome(call, a, options), outcome(call, other, options)
    assert same(first, second), "%s: %s\n%s\n%s" % (name, form, first, second)
    assert before == (a.tobytes(), {k: v.tobytes() for k, v in options.items()}), "%s changed its input" % name
    assert as_it_was is None or as_it_was == other.tobytes(), "%s changed its input, %s" % (name, form)
    return name, type(first).__name__ if isinstance(first, Exception) else "fine"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--calls", type=int, default=0)
    parser.add_argument("--minutes", type=float, default=1)
    asked = parser.parse_args()
    end, outcomes, wrong, n = time.process_time() + 60 * asked.minutes, {}, 0, 0
    while n < asked.calls if asked.calls else time.process_time() < end:
        try:
            what = " ".join(attempt(asked.seed + n))
        except Exception as error:
            wrong += 1
            what = "WRONG %s" % type(error).__name__
            print("--seed %d --calls 1: %s: %s" % (asked.seed + n, type(error).__name__, error), flush=True)
        outcomes[what] = outcomes.get(what, 0) + 1
        n += 1
    for what in sorted(outcomes):
        print("%8d %s" % (outcomes[what], what))
    print("%d calls, %d wrong" % (n, wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
