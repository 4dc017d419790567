"""Every parameter with a shape, times every kind of array: the result of plain float64, or a sentence.

KINDS has a row for each kind of array and a column for each class of parameters; PARAMETERS has a row for each parameter.
The tests walk through all pairs.
"""

import numpy as np
import pytest

import brio

RIGHT, REFUSED = "right", "refused"
GENERATOR = np.random.default_rng(11)


class Frame:
    """What numpy sees of a DataFrame or a Series of pandas."""

    def __init__(self, array):
        self.array = array

    def __array__(self, dtype=None, copy=None):
        return self.array if dtype is None else self.array.astype(dtype)


class Tensor:
    """What a tensor of torch shows: it records gradients and is on another device."""

    def __init__(self, array, detached=False, here=False):
        self.array, self.detached, self.here = array, detached, here

    def detach(self):
        return Tensor(self.array, True, self.here)

    def cpu(self):
        return Tensor(self.array, self.detached, True)

    def __array__(self, dtype=None, copy=None):
        if not (self.detached and self.here):
            raise RuntimeError("Can't call numpy() on a tensor that requires grad")
        return self.array


class Capsule:
    """What speaks DLPack alone."""

    def __init__(self, array):
        self.array = np.ascontiguousarray(array)

    def __dlpack__(self, **options):
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


def unaligned(array):
    out = np.frombuffer(bytearray(array.nbytes + 1), np.uint8)[1:].view(array.dtype).reshape(array.shape)
    out[...] = array
    return out


def read_only(array):
    out = array.copy()
    out.flags.writeable = False
    return out


def strided(array):
    return np.repeat(array, 2, axis=-1)[..., ::2]


def backwards(array):
    return array[::-1].copy()[::-1]


def torch_of(array):
    return pytest.importorskip("torch").tensor(array)


def pandas_of(array):
    pandas = pytest.importorskip("pandas")
    return pandas.Series(array) if array.ndim == 1 else pandas.DataFrame(array)


def masked(array):
    out = np.ma.masked_array(array)
    out[0] = np.ma.masked
    return out


# kind: how it is made; what comes of it as numbers, as complex values, as indices, as properties
KINDS = {
    "list": (lambda a: a.tolist(), RIGHT, RIGHT, RIGHT, RIGHT),
    "tuple": (lambda a: tuple(map(tuple, a.tolist())) if a.ndim > 1 else tuple(a.tolist()), RIGHT, RIGHT, RIGHT, RIGHT),
    "list of rows": (lambda a: list(a), RIGHT, RIGHT, RIGHT, RIGHT),
    "read-only": (read_only, RIGHT, RIGHT, RIGHT, RIGHT),
    "strided": (strided, RIGHT, RIGHT, RIGHT, RIGHT),
    "backwards": (backwards, RIGHT, RIGHT, RIGHT, RIGHT),
    "Fortran": (np.asfortranarray, RIGHT, RIGHT, RIGHT, RIGHT),
    "unaligned": (unaligned, RIGHT, RIGHT, RIGHT, RIGHT),
    "other byte order": (lambda a: a.astype(a.dtype.newbyteorder()), RIGHT, RIGHT, RIGHT, RIGHT),
    "float32": (lambda a: a.astype(np.float32), RIGHT, RIGHT, REFUSED, RIGHT),
    "float16": (lambda a: a.astype(np.float16), RIGHT, RIGHT, REFUSED, RIGHT),
    "longdouble": (lambda a: a.astype(np.longdouble), RIGHT, RIGHT, REFUSED, RIGHT),
    "int8": (lambda a: a.astype(np.int8), RIGHT, RIGHT, RIGHT, RIGHT),
    "int32": (lambda a: a.astype(np.int32), RIGHT, RIGHT, RIGHT, RIGHT),
    "int64": (lambda a: a.astype(np.int64), RIGHT, RIGHT, RIGHT, RIGHT),
    "uint8": (lambda a: a.astype(np.uint8), RIGHT, RIGHT, RIGHT, RIGHT),
    "uint32": (lambda a: a.astype(np.uint32), RIGHT, RIGHT, RIGHT, RIGHT),
    "uint64": (lambda a: a.astype(np.uint64), RIGHT, RIGHT, RIGHT, RIGHT),
    "objects that are numbers": (lambda a: a.astype(object), RIGHT, RIGHT, None, RIGHT),
    "matrix": (lambda a: np.asmatrix(a) if a.ndim == 2 else a, RIGHT, RIGHT, RIGHT, RIGHT),
    "frame": (Frame, RIGHT, RIGHT, RIGHT, RIGHT),
    "tensor": (Tensor, RIGHT, RIGHT, RIGHT, RIGHT),
    "DLPack": (Capsule, RIGHT, RIGHT, RIGHT, RIGHT),
    "pandas": (pandas_of, RIGHT, RIGHT, RIGHT, RIGHT),
    "torch": (torch_of, RIGHT, RIGHT, RIGHT, RIGHT),
    "complex": (lambda a: a.astype(complex), REFUSED, RIGHT, REFUSED, RIGHT),
    "masked": (masked, REFUSED, REFUSED, REFUSED, REFUSED),
    "masked, in a list": (lambda a: [masked(a)] if a.ndim == 1 else list(masked(a)), REFUSED, REFUSED, REFUSED, REFUSED),
    "of dimension 0": (lambda a: np.float64(1), REFUSED, REFUSED, REFUSED, REFUSED),
    "a number": (lambda a: 1, REFUSED, REFUSED, REFUSED, REFUSED),
    "text": (lambda a: "1 2 3", REFUSED, REFUSED, REFUSED, REFUSED),
    "strings": (lambda a: a.astype(str), REFUSED, REFUSED, REFUSED, RIGHT),
    "dates": (lambda a: a.astype("datetime64[s]"), REFUSED, REFUSED, REFUSED, RIGHT),
    "records": (lambda a: np.zeros(len(a), "f8,f8"), REFUSED, REFUSED, REFUSED, RIGHT),
    "objects that are none": (lambda a: np.array([object()] * len(a)), REFUSED, REFUSED, REFUSED, RIGHT),
    "ragged": (lambda a: [[1, 2], [3]], REFUSED, REFUSED, None, REFUSED),
    "a dict": (lambda a: {1: 2}, REFUSED, REFUSED, REFUSED, REFUSED),
    "one row less": (lambda a: a[:-1], None, REFUSED, None, REFUSED),
    "an axis more": (lambda a: a[None], None, None, REFUSED, REFUSED),
    "no rows": (lambda a: a[:0], None, REFUSED, None, REFUSED),
}
NUMBERS, VALUES, INDICES, PROPERTIES = range(1, 5)

PLANE = GENERATOR.integers(0, 60, (30, 2)).astype(float)
SPACE = GENERATOR.integers(0, 60, (30, 3)).astype(float)
WEIGHTS = np.arange(30.0)
FACES = np.array([[0, 1, 2], [1, 2, 3]])
MESH = brio.Mesh(SPACE, FACES, properties={"number": np.arange(30)})
NATURAL = brio.Delaunay(PLANE)
BALL = np.clip(np.rint(20 * GENERATOR.normal(size=(60, 3)) + 60), 0, 120)


def cells(vor):
    return vor.vertices, vor.volumes


def surface(mesh):
    return mesh.vertices, mesh.face_vertices, mesh.tetrahedra, mesh.edges


def converted(box, tmp_path):
    MESH.write(tmp_path / "a.ply")
    brio.convert(tmp_path / "a.ply", tmp_path / "b.ply", box=box)
    return brio.read(tmp_path / "b.ply").vertices


# parameter: its class, what it is given, and a call that returns arrays
PARAMETERS = {
    "Delaunay(points), plane": (NUMBERS, PLANE, lambda a, _: brio.Delaunay(a).simplices),
    "Delaunay(points), space": (NUMBERS, SPACE, lambda a, _: brio.Delaunay(a).simplices),
    "Delaunay(weights)": (NUMBERS, WEIGHTS, lambda a, _: brio.Delaunay(SPACE, a).simplices),
    "Delaunay.find_simplex(xi)": (NUMBERS, PLANE, lambda a, _: NATURAL.find_simplex(a)),
    "Delaunay.lift_points(x)": (NUMBERS, PLANE, lambda a, _: NATURAL.lift_points(a)),
    "Delaunay.plane_distance(xi)": (NUMBERS, PLANE, lambda a, _: NATURAL.plane_distance(a)),
    "Delaunay.add_points(points)": (NUMBERS, SPACE[:5], lambda a, _: added(brio.Delaunay(SPACE), a).simplices),
    "Voronoi(points), plane": (NUMBERS, PLANE, lambda a, _: cells(brio.Voronoi(a))),
    "Voronoi(points), space": (NUMBERS, SPACE, lambda a, _: cells(brio.Voronoi(a))),
    "Voronoi(weights)": (NUMBERS, WEIGHTS, lambda a, _: cells(brio.Voronoi(SPACE, a))),
    "Voronoi(box), space": (NUMBERS, np.array([[0.0, 0, 0], [50, 60, 70]]), lambda a, _: cells(brio.Voronoi(SPACE, box=a))),
    "Voronoi(box), plane": (NUMBERS, np.array([0.0, 0, 50, 60]), lambda a, _: cells(brio.Voronoi(PLANE, box=a))),
    "Voronoi.add_points(points)": (NUMBERS, SPACE[:5], lambda a, _: cells(added(brio.Voronoi(SPACE), a))),
    "ConvexHull(points), plane": (NUMBERS, PLANE, lambda a, _: brio.ConvexHull(a).simplices),
    "ConvexHull(points), space": (NUMBERS, SPACE, lambda a, _: brio.ConvexHull(a).simplices),
    "ConvexHull.add_points(points)": (NUMBERS, SPACE[:5], lambda a, _: added(brio.ConvexHull(SPACE), a).simplices),
    "alpha_complex(points)": (NUMBERS, SPACE, lambda a, _: brio.alpha_complex(a).values),
    "alpha_complex(weights)": (NUMBERS, WEIGHTS, lambda a, _: brio.alpha_complex(SPACE, a).values),
    "AlphaShape(points)": (NUMBERS, PLANE, lambda a, _: surface(brio.AlphaShape(a, 500.0))),
    "Mesh(vertices)": (NUMBERS, SPACE, lambda a, _: brio.Mesh(a).vertices),
    "thin(points)": (NUMBERS, SPACE, lambda a, _: brio.thin(a, 10)),
    "outliers(points)": (NUMBERS, SPACE, lambda a, _: brio.outliers(a)),
    "reconstruct(points)": (NUMBERS, BALL, lambda a, _: surface(brio.reconstruct(a))),
    "oriented_normals(points)": (NUMBERS, BALL, lambda a, _: brio.oriented_normals(a)),
    "offset(points)": (NUMBERS, BALL, lambda a, _: surface(brio.offset(a, 30.0))),
    "medial_axis(points)": (NUMBERS, BALL, lambda a, _: surface(brio.medial_axis(a))),
    "convert(box)": (NUMBERS, np.array([[0.0, 0, 0], [50, 60, 40]]), converted),
    "LinearNDInterpolator(points)": (NUMBERS, SPACE, lambda a, _: brio.LinearNDInterpolator(a, WEIGHTS)(SPACE)),
    "LinearNDInterpolator(values)": (VALUES, WEIGHTS, lambda a, _: brio.LinearNDInterpolator(SPACE, a)(SPACE)),
    "LinearNDInterpolator(...)(xi)": (NUMBERS, SPACE, lambda a, _: brio.LinearNDInterpolator(SPACE, WEIGHTS)(a)),
    "NaturalNeighbourInterpolator(values)": (VALUES, WEIGHTS, lambda a, _: brio.NaturalNeighbourInterpolator(PLANE, a)(PLANE)),
    "Mesh(faces)": (INDICES, FACES, lambda a, _: surface(brio.Mesh(SPACE, a))),
    "Mesh(tetrahedra)": (INDICES, np.array([[0, 1, 2, 3], [1, 2, 3, 4]]), lambda a, _: surface(brio.Mesh(SPACE, tetrahedra=a))),
    "Mesh(edges)": (INDICES, FACES[:, :2], lambda a, _: surface(brio.Mesh(SPACE, edges=a))),
    "Mesh.select(which)": (INDICES, np.arange(20), lambda a, _: surface(MESH.select(a))),
    "Mesh.carry_properties(samples)": (INDICES, np.arange(30)[::-1].copy(), lambda a, _: carried(a)),
    "Mesh(properties)": (PROPERTIES, WEIGHTS, lambda a, _: brio.Mesh(SPACE, properties={"w": a}).properties["w"]),
    "reconstruct(attributes)": (PROPERTIES, np.arange(60.0),
                                lambda a, _: brio.reconstruct(BALL, attributes={"w": a}).properties["w"]),
}


def added(built, points):
    built.add_points(points)
    return built


def carried(samples):
    mesh = brio.Mesh(SPACE)
    mesh.carry_properties(MESH, samples)
    return mesh.properties["number"]


def expect_equal(found, wanted):
    found, wanted = (x if isinstance(x, tuple | list) else (x,) for x in (found, wanted))
    assert len(found) == len(wanted)
    for a, b in zip(found, wanted):
        a, b = np.asarray(a), np.asarray(b)
        assert np.array_equal(a, b, equal_nan=a.dtype.kind in "fc" and b.dtype.kind in "fc")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("parameter", PARAMETERS)
def test_every_parameter_takes_every_kind_of_array_or_refuses_it(parameter, kind, tmp_path):
    which, plain, call = PARAMETERS[parameter]
    make, expected = KINDS[kind][0], KINDS[kind][which]
    if kind == "tuple" and parameter in ("LinearNDInterpolator(points)", "LinearNDInterpolator(...)(xi)"):
        expected = None  # for scipy a tuple has an array for each coordinate
    given = make(plain)
    if expected == REFUSED:
        with pytest.raises((brio.ArgumentError, brio.NotFiniteError, IndexError)) as caught:
            call(given, tmp_path)
        assert str(caught.value)
    elif expected is None:  # either: a sentence, or a result that the shape asks for
        try:
            call(given, tmp_path)
        except (brio.Error, IndexError) as error:
            assert str(error)
    else:
        found, wanted = call(given, tmp_path), call(plain, tmp_path)
        if which == PROPERTIES and kind in ("strings", "dates", "records", "objects that are none"):
            assert len(found) == len(wanted)
        else:
            expect_equal(found, wanted)


@pytest.mark.parametrize("parameter", [name for name, row in PARAMETERS.items() if row[0] == NUMBERS])
def test_booleans_are_the_numbers_0_and_1(parameter, tmp_path):
    _, plain, call = PARAMETERS[parameter]
    results = []
    for given in (plain > 30, (plain > 30).astype(float)):
        try:
            results.append(call(given, tmp_path))
        except brio.Error as error:
            results.append((type(error).__name__, str(error)))
    expect_equal(*[[repr(r)] if isinstance(r, tuple) and isinstance(r[0], str) else r for r in results])


@pytest.mark.parametrize("box", [np.zeros((3, 2)), np.zeros((1, 6)), np.zeros((6, 1)), np.zeros((2, 3, 1)), np.zeros((2, 2)), 5,
                                 np.zeros(4), []])
def test_boxes_of_another_shape(box, tmp_path):
    """Boxes of shape (3, 2), as pyvoro's limits, were taken in silence as other boxes."""
    brio.write(tmp_path / "a.ply", SPACE)
    with pytest.raises(brio.ArgumentError, match="box"):
        brio.Voronoi(SPACE, box=box)
    with pytest.raises(brio.ArgumentError, match="box"):
        brio.convert(tmp_path / "a.ply", tmp_path / "b.ply", box=box)


def test_integers_that_doubles_cannot_hold():
    for big in (2**53 + 1, -(2**53) - 1, 2**63 - 1):
        for points in (np.array([[big, 0, 0]]), [[big, 0, 0]], np.array([[big, 0, 0]], object)):
            with pytest.raises(brio.ArgumentError, match=str(big)):
                brio.Delaunay(points)
    with pytest.raises(brio.ArgumentError, match="18446744073709551615"):
        brio.Delaunay(np.array([[2**64 - 1, 0, 0]], np.uint64))
    assert brio.Delaunay([[2**53, 0, 0], [2**60, 0, 0]]).points[1, 0] == 2.0**60


def test_masked_faces_and_missing_numbers():
    faces = np.ma.masked_array(FACES, mask=False)
    faces[1, 2] = np.ma.masked
    for given in (faces, list(faces), [[0, 1, 2], np.ma.masked_array([1, 2, 3], [False, True, False])]):
        with pytest.raises(brio.ArgumentError, match="masked"):
            brio.Mesh(SPACE, given)
    with pytest.raises(brio.NotFiniteError, match="point 0: z is NaN"):
        brio.Delaunay([[0, 0, None], [1, 2, 3]])


@pytest.mark.parametrize("threads", [-1, -(2**31)])
def test_fewer_than_no_threads(threads, tmp_path):
    brio.write(tmp_path / "a.ply", SPACE)
    tri = brio.Delaunay(PLANE)
    for call in (lambda: brio.Delaunay(SPACE, threads=threads), lambda: brio.Delaunay(PLANE, threads=threads),
                 lambda: brio.Voronoi(SPACE, threads=threads), lambda: brio.ConvexHull(PLANE, threads=threads),
                 lambda: brio.LinearNDInterpolator(tri, PLANE[:, 0], threads=threads),
                 lambda: brio.read(tmp_path / "a.ply", threads=threads), lambda: brio.reconstruct(BALL, threads=threads),
                 lambda: brio.convert(tmp_path / "a.ply", tmp_path / "b.ply", threads=threads),
                 lambda: brio.thin(SPACE, 1.0, threads=threads), lambda: MESH.self_intersections(threads=threads)):
        with pytest.raises(brio.ArgumentError, match="threads"):
            call()


@pytest.mark.parametrize("name", ["x\0y", "\ud800", "ok\udfff"])
def test_names_that_c_cannot_have(name, tmp_path):
    for call in (lambda: brio.Mesh(SPACE, properties={name: WEIGHTS}), lambda: MESH.write(tmp_path / "a.ply", comment=name),
                 lambda: brio.read(tmp_path / "a.xyz", columns=["x", "y", "z", name]),
                 lambda: brio.read(tmp_path / "a.xyz", format=name), lambda: brio.read(str(tmp_path / name[:2])),
                 lambda: brio.reconstruct(BALL, attributes={name: np.arange(60)})):
        with pytest.raises((brio.ArgumentError, brio.OpenError)):
            call()


def test_names_longer_than_files_have_them(tmp_path):
    with pytest.raises(brio.ArgumentError, match="500 bytes"):
        brio.Mesh(SPACE, properties={"a" * 500: WEIGHTS}).write(tmp_path / "a.ply")


def test_paths_that_are_not_utf8(tmp_path):
    """Errors that name such a path were a UnicodeDecodeError."""
    import os

    if os.name == "nt":  # names are UTF-16 there, and one with half a pair has no UTF-8
        for kind, call in ((brio.OpenError, lambda: brio.read("b\udcff.xyz")), (brio.WriteError, lambda: brio.write("b\udcff.ply", SPACE))):
            with pytest.raises(kind, match=r"b\\xed\\xb3\\xbf") as caught:
                call()
            str(caught.value).encode()
        return
    folder = os.fsencode(tmp_path) + b"/b\xff"
    try:
        os.mkdir(folder)
    except OSError:
        pytest.skip("this file system takes UTF-8 alone")
    good, bad = os.fsdecode(folder + b"/good.xyz"), os.fsdecode(folder + b"/bad.xyz")
    with open(good, "w") as file:
        file.write("1 2 3\n4 5 6\n")
    with open(bad, "w") as file:
        file.write("1 2 3\nfoo\n")
    assert len(brio.read(good).vertices) == 2
    for kind, call in ((brio.FormatError, lambda: brio.read(bad)), (brio.OpenError, lambda: brio.read(bad + "x")),
                       (brio.WriteError, lambda: brio.write(os.fsdecode(folder + b"/no\xfe/x.ply"), SPACE)),
                       (brio.OpenError, lambda: brio.convert(bad + "x", tmp_path / "q.ply")),
                       (brio.FormatError, lambda: brio.convert(bad, tmp_path / "q.ply"))):
        with pytest.raises(kind, match=r"b\\xff") as caught:
            call()
        str(caught.value).encode()  # it can be printed
    assert brio.convert(good, os.fsdecode(folder + b"/o.ply")).points == 2
