"""Surfaces of samples, and what comes with them: medial axes, offsets, normals of points."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _calls, _native
from ._arrays import MOST_TILES, Floats, as_count, as_number, as_rows, as_weights, frozen
from ._calls import Limits, Path, Progress, reporting
from ._estimate import TRIANGULATION, Task, estimate, require_memory
from ._mesh import Mesh
from ._periodic import as_cell, as_periodic
from ._points import nearest
from ._properties import Properties, as_properties, carry
from .errors import ArgumentError

_ALL_POINTS, _OWN_VERTICES, _MAY_END, _AT_DISTANCE = 1, 2, 4, 8


class _Method(NamedTuple):
    """What the library knows of a method."""

    name: str
    number: int
    options: frozenset[str]
    traits: int


_TABLE = [_Method(name, number, frozenset(options.split()), traits) for name, number, options, traits in _native.surface_methods()]
_METHODS = {method.name: method for method in _TABLE if not method.traits & _AT_DISTANCE}
_NOISE = {"auto": 0, "keep": 1, "smooth": 2}
_LABELING = {"global": 0, "greedy": 1, "naive": 2, "theoretical": 3}
_EXTRACTION = {"labels": 0, "candidates": 1, "pruned": 2, "walk": 3}
_SIDES = {"inner": 0, "outer": 1, "both": 2}
_NAMES = {"noise": _NOISE, "labeling": _LABELING, "extraction": _EXTRACTION, "sides": _SIDES}


class Surface(Mesh):
    """A surface of samples: a Mesh, and

    Attributes
    ----------
    points : ndarray of float64, shape (n, 3)
        The samples.
    samples : ndarray of int64, shape (nvertices,), or None
        The sample that each vertex is, maybe moved; None where vertices are no samples.
    report : dict
        Of "labeled-delaunay": what the surface is worth, by the names of ``brio surface --json``: `holes`, `bridges`,
        `far_area_percent`, `uncertain_share`, `orientation`, `agreement` and others. None where nothing was told. Of other methods: empty.
    """

    points: Floats
    samples: NDArray[np.int64] | None = None
    report: dict[str, Any]


def _options(options: dict[str, Any]) -> dict[str, Any]:
    """Options as the module takes them: names become numbers."""
    out = dict(options)
    for key, names in _NAMES.items():
        value = out.get(key)
        if isinstance(value, str):
            if value not in names:
                raise ArgumentError(f"{key}: one of {', '.join(names)}, not {value!r}")
            out[key] = names[value]
    return out


def _run(function: Any, points: Floats, options: dict[str, Any], number: float, out: NDArray[Any] | None, threads: int,
         progress: bool | Progress | None, limits: Limits) -> Surface:
    def call(p: Floats, w: None, t: int, report: Any) -> Any:
        return function(p, _options(options), number, out, t, report)

    made = _calls.of_points(call, points, None, threads, progress, limits)
    handle, report = made if isinstance(made, tuple) else (made, {})
    surface: Surface = Surface._of(handle)
    surface.points, surface.report = points, report
    return surface


def _surface(method: _Method, points: Floats, options: dict[str, Any], distance: float, out: NDArray[Any] | None,
             threads: int, progress: bool | Progress | None, limits: Limits) -> Surface:
    chosen = {**options, "method": method.number}
    require_memory(points, None, _task(method, options), threads, limits)
    surface = _run(_native.surface, points, chosen, distance, out, threads, progress, limits)
    if "confidence" not in method.options:  # the report judges what such a method did
        surface.report = {}
    return surface


def _task(method: _Method, options: dict[str, Any]) -> Task:
    """What is estimated of a method with its options."""
    wanted = {name: int(options[name]) for name in ("simplify", "triangulate", "pieces") if isinstance(options.get(name), int)}
    simplify, pieces = int(wanted.get("simplify", 0) != 0), min(max(wanted.get("pieces", 0), 0), 2**31)
    polygons = int("polygons" in method.options and not simplify and not wanted.get("triangulate", 0))
    return method.number, polygons, simplify, pieces


def estimate_memory(points: Any, weights: Any = None, *, method: str | None = None, cell: Any = None, periodic: Any = True,
                    threads: int = 0, progress: bool | Progress | None = None, **options: Any) -> int:
    """Estimates the bytes that the library will hold at its peak, the result included and the points not.

    It is within 15 % for points that are spread evenly, or scanned; others can need more. To make sure, set `max_memory`.

    Parameters
    ----------
    points : array_like, shape (n, 3), or (n, 2) for a triangulation, or Mesh
    weights : array_like, shape (n,), optional
    method : str, optional
        Of ``brio.reconstruct``, whose `options` are taken. None: of ``brio.Delaunay``.
    cell, periodic
        As of PeriodicDelaunay.
    threads, progress
        As for Delaunay.

    Returns
    -------
    int

    Examples
    --------
    >>> import brio, numpy as np
    >>> points = np.random.default_rng(1).random((10_000, 3))
    >>> brio.estimate_memory(points) < brio.estimate_memory(points, method="labeled-delaunay")
    True
    """
    if method is not None:
        if weights is not None or cell is not None:
            raise ArgumentError("method: of a surface, whose samples have neither weights nor a cell")
        which = _method(method)
        return estimate(_split(points)[0], None, _task(which, options), threads, progress)
    if options:
        raise ArgumentError(f"{', '.join(options)}: of surfaces, and there is no method")
    rows = points.vertices if isinstance(points, Mesh) else as_rows(points, "points", (2, 3) if cell is None else (3,))
    unused = tuple(int(not repeats) for repeats in as_periodic(periodic))
    vectors = None if cell is None else as_cell(cell)
    return estimate(rows, as_weights(weights, len(rows)), TRIANGULATION, threads, progress, cell=vectors, unused=unused)


def _split(points: Any) -> tuple[Floats, Properties]:
    """Positions, and the properties of a Mesh."""
    if isinstance(points, Mesh):
        return points.vertices, points._sound_properties()
    return as_rows(points, "points"), {}


def _method(method: Any) -> _Method:
    """The method of a name, which may have underscores for hyphens."""
    name = method.replace("_", "-") if isinstance(method, str) else method
    if not isinstance(name, str) or name not in _METHODS:
        raise ArgumentError(f"method: one of {', '.join(_METHODS)}, not {method!r}")
    return _METHODS[name]


def _evidence(method: _Method, options: dict[str, Any], properties: Properties, normals: Any,
              origins: Any) -> dict[str, Floats]:
    """What tells the outside, as options of the module."""
    out: dict[str, Floats] = {}
    pieces = options.get("pieces", 0)
    takes = "evidence" in method.options and not (isinstance(pieces, int) and pieces > 1)
    for name, given, columns in (("normals", normals, ("nx", "ny", "nz")),
                                 ("origins", origins, ("x_origin", "y_origin", "z_origin"))):
        if given is None and takes and all(c in properties for c in columns):
            given = np.stack([np.asarray(properties[c], np.float64) for c in columns], 1)
        if given is None or given is False:
            continue
        if not takes:
            raise ArgumentError(f"{name}: {method.name} takes none" + (" in pieces" if "evidence" in method.options else ""))
        out[name] = as_rows(np.atleast_2d(np.asarray(given, np.float64)), name)
    return out


def _holes(method: _Method, options: dict[str, Any]) -> dict[str, Any]:
    """The options of the library for `open`: "auto", the default where a surface may end, is none of its numbers."""
    if not (method.traits & _MAY_END and "open" in method.options):
        return options
    if options.get("open", "auto") != "auto":
        return {"holes": 1, **options}
    return {name: value for name, value in options.items() if name != "open"}


def reconstruct(points: Any, method: str = "labeled-delaunay", *, normals: Any = None, origins: Any = None,
                attributes: dict[str, Any] | None = None, threads: int = 0, progress: bool | Progress | None = None,
                scratch: Path | None = None, max_memory: float | None = None, **options: Any) -> Surface:
    """Reconstructs a surface from samples of it.

    Parameters
    ----------
    points : array_like, shape (n, 3), or Mesh
    method : str
        "labeled-delaunay" (default): a manifold, oriented surface of triangles of the samples; options `noise`
        ("auto", "keep", "smooth"), `open`, `confidence`, `simplify`, `seed`, `tiles`. `open`: "auto" (default) leaves holes open
        where the samples end, 0 closes all, K > 0 leaves those open whose radii are over K spacings. `confidence`: unless it
        is 0, vertices and faces have the property `confidence`. `tiles`, with `scratch`: the triangulations are made in
        that many tiles, for the same surface in less memory.
        "power-crust": closed, manifold, oriented, of polygons; options `noise`, `open`, `sharp`, `sampling_density`,
        `labeling`, `triangulate`, `simplify`, `seed`.
        "cocone": triangles of the samples, maybe open; options `theta`, `boundaries`, `density`, `pieces`,
        `extraction`, `seed`. "tight-cocone": the same, closed.
        The options are those of ``brio/surface.h`` and, `extraction` and two values of `labeling`, ``brio/laboratory.h``.
    normals : array_like, shape (n, 3), or False, optional
        Normals of the samples, which point outwards; some may be wrong or 0. By default the properties nx, ny, nz of a
        Mesh, if it has them; False: none. Not for "power-crust", which takes none.
    origins : array_like, shape (n, 3) or (3,), or False, optional
        The place of the scanner that saw each sample, or all of them: outside is on its side. By default the properties
        x_origin, y_origin, z_origin of a Mesh; False: none. Not for "power-crust".
    attributes : dict of arrays, optional
        Each with one row a point; carried to the vertices as properties. Those of a Mesh are carried anyway. A vertex that
        is no sample has the attributes of the nearest one. A name that the surface has becomes input_NAME.
    threads, progress, scratch, max_memory
        As for Delaunay.

    Returns
    -------
    Surface
        A Mesh with `points` and `samples`; `certificate` says what it is.

    Examples
    --------
    >>> import brio, numpy as np
    >>> rng = np.random.default_rng(1)
    >>> ball = rng.normal(size=(1000, 3))
    >>> ball /= np.linalg.norm(ball, axis=1)[:, None]
    >>> surface = brio.reconstruct(ball)
    >>> surface.certificate.closed, surface.certificate.genus
    (True, 0)
    """
    which = _method(method)
    rows, carried = _split(points)
    options = _holes(which, {**options, **_evidence(which, options, carried, normals, origins)})
    carried = {**carried, **as_properties({} if attributes is None else attributes, len(rows), "attribute", "point")}
    samples = None if which.traits & _OWN_VERTICES else np.empty(len(rows), np.uint32)
    if "confidence" in which.options:
        options = {"confidence": 1, **options}
    if as_count(options.get("tiles", 0), "tiles", most=MOST_TILES) and scratch is None:
        raise ArgumentError("tiles: scratch is wanted, too, the folder where they are")
    surface = _surface(which, rows, options, 0.0, samples, threads, progress, (scratch, max_memory))
    if samples is not None:
        surface.samples = frozen(samples[: len(surface.vertices)].astype(np.int64))
    _carry(surface, carried, threads)
    return surface


def _carry(surface: Surface, attributes: Properties, threads: int) -> None:
    """Gives the vertices the attributes of their samples."""
    if not attributes:
        return
    samples = surface.samples
    rows = nearest(surface.points, surface.vertices, threads, None) if samples is None else samples
    carry(attributes, rows, surface.properties)


def oriented_normals(points: Any, method: str = "labeled-delaunay", *, threads: int = 0,
                     progress: bool | Progress | None = None, scratch: Path | None = None, max_memory: float | None = None,
                     **options: Any) -> Floats:
    """Finds the unit normals of samples, which point out of the surface through them.

    Parameters
    ----------
    points, method, threads, progress, scratch, max_memory, options
        As for reconstruct.

    Returns
    -------
    ndarray of float64, shape (n, 3)

    Examples
    --------
    >>> import brio, numpy as np
    >>> rng = np.random.default_rng(1)
    >>> ball = rng.normal(size=(1000, 3))
    >>> ball /= np.linalg.norm(ball, axis=1)[:, None]
    >>> normals = brio.oriented_normals(ball)
    >>> bool(((normals * ball).sum(axis=1) > 0.9).all())
    True
    """
    rows, _ = _split(points)
    normals = np.empty((len(rows), 3))
    which = _method(method)
    if which.traits & _OWN_VERTICES:
        _surface(which, rows, options, 0.0, normals, threads, progress, (scratch, max_memory))
        return normals
    surface = reconstruct(rows, method, threads=threads, progress=progress, scratch=scratch, max_memory=max_memory, **options)
    samples = None if surface.samples is None else surface.samples.astype(np.uint32)
    with reporting(None, (scratch, max_memory)) as report:
        _native.point_normals(rows, surface._handle, samples, normals, threads, report)
    return normals


def _is_solid(points: Any, options: dict[str, Any]) -> bool:
    """Whether the faces of a mesh count. With `labeling` its points do."""
    return isinstance(points, Mesh) and len(points.face_offsets) > 1 and "labeling" not in options


def _of_mesh(mesh: Mesh, call: Any, progress: bool | Progress | None, limits: Limits) -> Surface:
    """What a function of the module makes of a closed mesh."""
    with reporting(progress, limits) as report:
        surface: Surface = Surface._of(call(mesh._copy({}), report))
    surface.points, surface.report = mesh.vertices, {}
    return surface


def offset(points: Any, distance: float, *, error: float | None = None, threads: int = 0,
           progress: bool | Progress | None = None, scratch: Path | None = None, max_memory: float | None = None,
           **options: Any) -> Surface:
    """Computes the surface at `distance` outside a closed mesh, or outside the power crust of samples; inside for a negative
    distance.

    Of a mesh with faces, the faces count, not the vertices: the result is round about their convex edges and sharp over
    concave ones outside, the other way round inside, and nowhere farther than `error` from the exact offset.

    Parameters
    ----------
    points : Mesh with faces, or array_like, shape (n, 3), or Mesh
    distance : float
        In the unit of the points.
    error : float, optional
        Of a mesh with faces; a hundredth of the distance if it is not given.
    threads, progress, scratch, max_memory
        As for Delaunay.
    options
        Of points: those of "power-crust" without `open`. With `labeling` a mesh goes by its points.

    Returns
    -------
    Surface
        Closed, manifold and oriented.

    Examples
    --------
    >>> import brio, numpy as np
    >>> cube = brio.ConvexHull(np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T)
    >>> cube = brio.Mesh(cube.points, cube.simplices)
    >>> round(brio.offset(cube, -0.1).certificate.volume, 6)
    0.512
    >>> rng = np.random.default_rng(1)
    >>> ball = rng.normal(size=(1000, 3))
    >>> ball /= np.linalg.norm(ball, axis=1)[:, None]
    >>> far = np.linalg.norm(brio.offset(ball, 0.5).vertices, axis=1)
    >>> bool(abs(far - 1.5).max() < 0.05)
    True
    """
    far, limits = as_number(distance, "distance"), (scratch, max_memory)
    if _is_solid(points, options):
        if options:
            raise ArgumentError(f"{', '.join(options)}: for points, and this mesh has faces, which count")
        most = 0.0 if error is None else as_number(error, "error")
        return _of_mesh(points, lambda m, report: _native.mesh_offset(m, far, most, threads, report), progress, limits)
    if error is not None:
        raise ArgumentError("error: for closed meshes; the error of an offset of points is that of the points")
    rows, _ = _split(points)
    method = next(method for method in _TABLE if method.traits & _AT_DISTANCE)
    return _surface(method, rows, options, far, None, threads, progress, limits)


class BallUnion(Surface):
    """The surface of a union of balls: a Mesh whose faces have the property "ball", and

    Attributes
    ----------
    volume, area : float
        Of the union and of its surface, by formulas; exact up to rounding.
    areas : ndarray, shape (n,)
        Of each ball, its area on the surface.
    components, tunnels, voids : int
        The Betti numbers of the union.
    exposed : int
        Balls that reach the surface.
    """

    volume: float
    area: float
    areas: Floats
    components: int
    tunnels: int
    voids: int
    exposed: int


def ball_union(centres: Any, radii: Any, *, error: float = 0.0, threads: int = 0,
               progress: bool | Progress | None = None) -> BallUnion:
    """Computes the union of balls: its volume, its area, and its surface as a closed, manifold mesh.

    Parameters
    ----------
    centres : array_like, shape (n, 3)
    radii : array_like, shape (n,)
        Where they are 0 there is no ball.
    error : float
        No triangle is farther from its ball's sphere; 0: a thousandth of the diagonal of the balls' box.

    Returns
    -------
    BallUnion

    Examples
    --------
    >>> import brio, math
    >>> two = brio.ball_union([[0, 0, 0], [1, 0, 0]], [1, 1])
    >>> bool(abs(two.volume - 27 / 12 * math.pi) < 1e-12), two.components, two.certificate.closed
    (True, 1, True)
    """
    rows = as_rows(centres, "centres")
    sizes = np.asarray(radii, np.float64)
    if sizes.shape != (len(rows),):
        raise ArgumentError(f"radii: {len(rows)} numbers are wanted, one a centre")
    if not (sizes >= 0).all():
        raise ArgumentError("radii: numbers of 0 or more are wanted")
    areas = np.zeros(len(rows))
    with reporting(progress) as report:
        handle, found = _native.ball_union(rows, sizes * sizes, areas, as_number(error, "error"), threads, report)
    surface: BallUnion = BallUnion._of(handle)
    surface.points, surface.report = rows, found
    surface.areas = frozen(areas)
    for name, value in found.items():
        setattr(surface, name, value)
    return surface


def medial_axis(points: Any, *, method: str = "power-shape", sides: str = "inner", spacing: float | None = None,
                threads: int = 0, progress: bool | Progress | None = None, scratch: Path | None = None,
                max_memory: float | None = None, **options: Any) -> Surface:
    """Approximates the medial axis of a closed mesh, or of a sampled surface.

    A mesh with faces says itself what is inside, and its faces are sampled.

    Parameters
    ----------
    points : Mesh with faces, or array_like, shape (n, 3), or Mesh
    method : "power-shape" or "voronoi"
        The power shape of the samples' poles, or facets of the samples' Voronoi diagram.
    sides : "inner", "outer" or "both"
    spacing : float, optional
        Of a mesh with faces: no place of a face is farther from a sample. A hundredth of the diagonal of its box if it is
        not given.
    threads, progress, scratch, max_memory
        As for Delaunay.
    options
        `scale`, `redundancy` and `scale_axis` simplify the power shape; `theta` and `rho` are of "voronoi"; `noise`, `labeling`, `sharp`, `sampling_density`, `seed`. With `labeling` a mesh
        goes by its points.

    Returns
    -------
    Surface
        Vertices with the properties "radius" and "side" (-1 inner, 1 outer), `edges`, `faces` and `tetrahedra`.

    Examples
    --------
    >>> import brio, numpy as np
    >>> rng = np.random.default_rng(1)
    >>> ball = rng.normal(size=(1000, 3))
    >>> ball /= np.linalg.norm(ball, axis=1)[:, None]
    >>> axis = brio.medial_axis(ball)
    >>> bool(abs(axis.properties["radius"] - 1).max() < 0.1)
    True
    """
    if method not in ("power-shape", "voronoi"):
        raise ArgumentError(f"method: one of power-shape, voronoi, not {method!r}")
    others = ("scale", "redundancy", "scale_axis", "sharp", "sampling_density") if method == "voronoi" else ("theta", "rho")
    for name in others:
        if name in options:
            raise ArgumentError(f"{name}: {method} does not have it")
    options = {**options, "sides": sides, **({"voronoi": 1} if method == "voronoi" else {})}
    if _is_solid(points, options):
        if spacing is None:
            wide = 0.01 * float(np.linalg.norm(np.ptp(points.vertices, axis=0)))
        else:
            wide = as_number(spacing, "spacing")
        chosen = _options(options)
        return _of_mesh(points, lambda m, report: _native.mesh_shape(m, wide, chosen, threads, report), progress,
                        (scratch, max_memory))
    if spacing is not None:
        raise ArgumentError("spacing: for closed meshes; points are samples already")
    rows, _ = _split(points)
    return _run(_native.power_shape, rows, options, 0.0, None, threads, progress, (scratch, max_memory))
