"""Meshes: vertices with polygons, tetrahedra, edges, and properties of vertices and polygons."""

import base64
import html
import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._arrays import (Floats, as_array, as_count, as_number, as_path, as_rows, as_text, freeze_all, frozen,
                      refuse_masked)
from ._calls import Progress, of_points, reporting
from ._points import nearest
from ._properties import (Properties, as_properties, carry, colors_of, for_means, from_means, normals_of,
                          scalars)
from .errors import ArgumentError, Error

Indices = NDArray[np.uint32]


@dataclass(frozen=True)
class Certificate:
    """What the connectivity of a mesh's polygons says about the surface.

    ``closed``: every edge has two faces. ``manifold``: no edge has more, and the faces at a vertex form one fan.
    ``oriented``: the two faces of an edge run along it in opposite directions. ``genera`` has the genus of each component,
    that with the most faces first. ``volume`` is positive if faces are seen counterclockwise from outside.
    """

    closed: bool
    manifold: bool
    oriented: bool
    components: int
    genus: int
    genera: list[int]
    boundary_edges: int
    boundary_loops: int
    nonmanifold_edges: int
    nonmanifold_vertices: int
    flipped_edges: int
    area: float
    volume: float


@dataclass(frozen=True)
class Distance:
    """Distances between two surfaces, in the unit of the coordinates."""

    mean: float
    rms: float
    p95: float
    hausdorff: float
    normal_consistency: float
    diagonal: float


@dataclass(frozen=True)
class Coverage:
    """What of a surface points do not show, and what of the points it leaves.

    Lengths are in spacings of the points there. ``far_share``: of the area, what is farther than five spacings from all points.
    ``bridges``: sets of faces that span gaps: over 2.5 spacings away somewhere, one of them over 5. ``bridge_share``: of the
    area, that of the bridges. ``bridge_radius``: of the largest one, how far it is from all points, and ``bridge_centre``:
    where; both in the unit of the coordinates. ``left_out``: how many points are farther than two spacings from the surface.
    ``bridge``: of each polygon, whether it is part of a bridge.
    """

    far_share: float
    bridges: int
    bridge_share: float
    bridge_radius: float
    bridge_centre: tuple[float, float, float]
    left_out: int
    bridge: NDArray[np.bool_]


def as_indices(values: Any, name: str, columns: int) -> Indices:
    """Returns rows of indices as the library takes them."""
    array = as_array(values, name)
    if array.ndim != 2 or array.shape[1] != columns or array.dtype.kind not in "iu":
        raise ArgumentError(f"{name}: rows of {columns} indices are wanted, not {array.dtype} of shape {array.shape}")
    if array.size and (array.min() < 0 or array.max() >= 2**32 - 1):
        raise ArgumentError(f"{name}: an index is out of range")
    return np.require(array, np.uint32, ["C", "A"]).reshape(array.shape)


def as_polygons(faces: Any) -> tuple[NDArray[np.uint64], Indices]:
    """Returns offsets and corners of triangles, of rows of k corners, or of a list of polygons."""
    refuse_masked(faces, "faces")
    try:
        array = as_array(faces, "faces")
    except ValueError:  # polygons of several sizes
        array = np.empty(0, object)
    if array.ndim == 2 and array.dtype.kind in "iu":
        k = array.shape[1]
        return np.arange(0, k * len(array) + 1, k, dtype=np.uint64), as_indices(array, "faces", k).ravel()
    if array.size and array.dtype != object:
        raise ArgumentError(f"faces: rows of indices, or a list of polygons, are wanted, not {array.ndim} axes of {array.dtype}")
    try:
        polygons = [list(face) for face in faces]
    except TypeError as error:
        raise ArgumentError(f"faces: rows of indices, or a list of polygons, are wanted: {error}") from error
    corners = [as_indices([polygon], "faces", len(polygon)) for polygon in polygons]
    offsets = np.zeros(len(corners) + 1, np.uint64)
    np.cumsum([c.shape[1] for c in corners], out=offsets[1:])
    return offsets, np.concatenate([c.ravel() for c in corners]) if corners else np.empty(0, np.uint32)


class Mesh:
    """Points, polygons, tetrahedra or edges over them, and properties of points and polygons.

    Parameters
    ----------
    vertices : array_like, shape (n, 3)
    faces : array_like of int, shape (m, k), or a list of polygons, optional
    tetrahedra : array_like of int, shape (t, 4), optional
    edges : array_like of int, shape (e, 2), optional
    properties : dict of arrays, optional
        Each with one row a vertex.
    face_properties : dict of arrays, optional
        Each with one row a face.

    Attributes
    ----------
    vertices : ndarray of float64, shape (n, 3)
    faces : ndarray of uint32, shape (m, 3)
        Triangles; polygons are cut into fans.
    face_offsets, face_vertices : ndarray
        The polygons: f has the vertices ``face_vertices[face_offsets[f]:face_offsets[f + 1]]``.
    tetrahedra : ndarray of uint32, shape (t, 4)
    edges : ndarray of uint32, shape (e, 2)
        Edges of their own, such as those of a medial axis.
    properties : dict of ndarray
    face_properties : dict of ndarray
        Of the polygons: row f belongs to polygon f.
    normals : ndarray of float64, shape (n, 3)
        Of the vertices; 0 where there are no faces.
    certificate : Certificate
    cell : ndarray of float64, shape (3, 3), or None
        The vectors of the cell in which the points of a file of atoms repeat, a row each: ``brio.Voronoi(mesh.vertices,
        cell=mesh.cell, periodic=mesh.periodic)``. It is what the file said; no function of a mesh uses it, and no file
        that is written has it.
    periodic : tuple of bool, or None
        Which of these vectors repeat.

    Examples
    --------
    >>> import brio
    >>> tetrahedron = brio.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                         [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    >>> tetrahedron.certificate.closed, round(tetrahedron.certificate.volume, 6)
    (True, 0.166667)
    """

    _handle: Any
    properties: Properties
    face_properties: Properties

    def __init__(self, vertices: Any, faces: Any = None, *, tetrahedra: Any = None, edges: Any = None,
                 properties: dict[str, Any] | None = None, face_properties: dict[str, Any] | None = None) -> None:
        rows = as_rows(vertices, "vertices")
        offsets, corners = (None, None) if faces is None else as_polygons(faces)
        tets = None if tetrahedra is None else as_indices(tetrahedra, "tetrahedra", 4)
        ends = None if edges is None else as_indices(edges, "edges", 2)
        for name, indices in (("faces", corners), ("tetrahedra", tets), ("edges", ends)):
            if indices is not None and indices.size and indices.max() >= len(rows):
                raise ArgumentError(f"{name}: there is no vertex {indices.max()}; there are {len(rows)}",
                                    np.flatnonzero(indices.ravel() >= len(rows)))
        self._take(_native.mesh(rows, offsets, corners, tets, ends, {}, None, {}))
        self.properties = as_properties({} if properties is None else properties, len(rows))
        self.face_properties = as_properties({} if face_properties is None else face_properties,
                                             len(self.face_offsets) - 1, "face property", "face")

    @classmethod
    def _of(cls, handle: Any) -> Any:
        """Makes an object of what the library made."""
        mesh = cls.__new__(cls)
        mesh._take(handle)
        return mesh

    def _take(self, handle: Any) -> None:
        views = _native.mesh_views(handle)
        self._handle = handle
        self.vertices: Floats = np.asarray(views["vertices"])
        self.face_offsets: NDArray[np.uint64] = np.asarray(views["face_offsets"])
        self.face_vertices: Indices = np.asarray(views["face_vertices"])
        self.tetrahedra: Indices = np.asarray(views["tetrahedra"])
        self.edges: Indices = np.asarray(views["edges"])
        self._steps: Floats = np.stack([np.asarray(views["coordinate_step"]), np.asarray(views["coordinate_origin"])])
        cell = views["cell"]
        self.cell: Floats | None = None if cell is None else np.reshape(np.asarray(cell[0], float), (3, 3))
        self.periodic: tuple[bool, ...] | None = None if cell is None else tuple(map(bool, cell[1]))
        self.properties = {k: np.asarray(v) for k, v in views["properties"].items()}
        self.face_properties = {k: np.asarray(v) for k, v in views["face_properties"].items()}

    def _sound_properties(self) -> Properties:
        """The properties, of which the caller may have put any into the dict."""
        return as_properties(self.properties, len(self.vertices))

    def _sound_face_properties(self) -> Properties:
        return as_properties(self.face_properties, len(self.face_offsets) - 1, "face property", "face")

    @property
    def polygons(self) -> list[list[int]]:
        """The faces as lists of vertices."""
        flat, ends = self.face_vertices.tolist(), self.face_offsets.tolist()
        return [flat[i:j] for i, j in zip(ends[:-1], ends[1:])]

    @cached_property
    def faces(self) -> Indices:
        if len(self.face_offsets) == 1:
            return frozen(np.empty((0, 3), np.uint32))
        sizes = np.diff(self.face_offsets).astype(np.int64)
        if (sizes == 3).all():
            return self.face_vertices.reshape(-1, 3)
        count = np.maximum(sizes - 2, 0)
        first = np.repeat(self.face_offsets[:-1].astype(np.int64), count)
        step = np.arange(len(first)) - np.repeat(np.cumsum(count) - count, count) + 1
        corners = [self.face_vertices[first], self.face_vertices[first + step], self.face_vertices[first + step + 1]]
        return frozen(np.stack(corners, axis=1))

    @cached_property
    def normals(self) -> Floats:
        views = _native.mesh_views(_native.mesh_with_normals(self._handle))["properties"]
        return frozen(np.stack([np.asarray(views[name]).astype(np.float64) for name in ("nx", "ny", "nz")], axis=1))

    @cached_property
    def certificate(self) -> Certificate:
        return Certificate(**_native.mesh_certificate(self._handle))

    def simplify(self, faces: int = 0, *, tolerance: float = 0, progress: bool | Progress | None = None) -> "Mesh":
        """Simplifies a surface of triangles: edges collapse, those of least error first (Garland and Heckbert 1997).

        Components, genus and boundary stay; the surface stays manifold and oriented, and its vertices and triangles keep
        properties.

        Parameters
        ----------
        faces : int
            Stops at this number of triangles; 0: as few as the tolerance allows.
        tolerance : float
            The most that a new vertex may be away from the planes of the triangles that it stands for, as the root of
            the mean of squares, in the unit of the mesh; 0: any distance.

        Returns
        -------
        Mesh

        Examples
        --------
        >>> import brio, numpy as np
        >>> rng = np.random.default_rng(1)
        >>> ball = rng.normal(size=(1000, 3))
        >>> ball /= np.linalg.norm(ball, axis=1)[:, None]
        >>> surface = brio.reconstruct(ball)
        >>> len(surface.simplify(500).faces)
        500
        """
        faces = as_count(faces, "faces", most=2**63 - 1)
        with reporting(progress) as report:
            return self._changed(lambda numbered: _native.mesh_simplified(numbered, faces, tolerance, report))

    def select(self, which: Any) -> "Mesh":
        """Chooses vertices, with their properties. Faces, tetrahedra and edges stay if all their vertices do.

        Parameters
        ----------
        which : array_like of bool, shape (n,), or of int, shape (k,)
            A mask, such as that of thin or outliers, or indices, which give the order.

        Returns
        -------
        Mesh

        Examples
        --------
        >>> import brio
        >>> square = brio.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
        >>> square.select([True, True, True, False])
        <brio.Mesh: 3 vertices, 1 faces>
        """
        count = len(self.vertices)
        chosen = as_array(which, "which")
        if chosen.dtype.kind == "b" and chosen.shape == (count,):
            chosen = np.flatnonzero(chosen)
        elif chosen.ndim != 1 or (chosen.size and chosen.dtype.kind not in "iu"):
            raise ArgumentError(f"which: a mask of {count} or indices are wanted, not {chosen.dtype} of shape {chosen.shape}")
        chosen = chosen.astype(np.int64)
        if chosen.size and (chosen.min() < 0 or chosen.max() >= count or len(np.unique(chosen)) < len(chosen)):
            raise ArgumentError(f"which: indices from 0 to {count - 1} are wanted, each at most once")
        place = np.full(count, -1, np.int64)
        place[chosen] = np.arange(len(chosen))
        properties = {name: values[chosen] for name, values in self._sound_properties().items()}
        sizes = np.diff(self.face_offsets).astype(np.int64)
        corners = place[self.face_vertices]
        lost = np.bincount(np.repeat(np.arange(len(sizes)), sizes)[corners < 0], minlength=len(sizes)) > 0
        offsets = np.concatenate([[0], np.cumsum(sizes[~lost])]).astype(np.uint64)
        left = corners[~np.repeat(lost, sizes)].astype(np.uint32)

        def rest(rows: Indices) -> Indices | None:
            moved = place[rows]
            kept: Indices = moved[(moved >= 0).all(axis=1)].astype(np.uint32)
            return kept if len(kept) else None

        of_faces = {name: values[~lost] for name, values in self._sound_face_properties().items()}
        faces = (offsets, left) if len(offsets) > 1 else (None, None)
        mesh: Mesh = Mesh._of(_native.mesh(np.ascontiguousarray(self.vertices[chosen]), *faces, rest(self.tetrahedra),
                                           rest(self.edges), {}, self._steps, {}))
        mesh.properties = properties
        mesh.face_properties = of_faces
        return mesh

    def carry_properties(self, source: "Mesh", samples: Any = None, *, threads: int = 0,
                         progress: bool | Progress | None = None) -> None:
        """Gives the vertices the properties of points, such as the colours of the samples of a surface.

        A property whose name is taken becomes input_NAME, or input_NAME_2 and so on. Values keep their types.

        Parameters
        ----------
        source : Mesh
            The points and their properties.
        samples : array_like of int, shape (n,), optional
            The point of `source` that each vertex takes the properties of; the default is the nearest one (among equally
            near ones, the lexicographically first).

        Examples
        --------
        >>> import brio
        >>> scan = brio.Mesh([[0, 0, 0], [9, 0, 0]], properties={"colour": [[255, 0, 0], [0, 0, 255]]})
        >>> mesh = brio.Mesh([[8, 0, 0], [1, 1, 0], [10, 0, 0]])
        >>> mesh.carry_properties(scan)
        >>> mesh.properties["colour"].tolist()
        [[0, 0, 255], [255, 0, 0], [0, 0, 255]]
        """
        count = len(as_mesh(source, "source").vertices)
        if samples is None:
            rows = nearest(source.vertices, self.vertices, threads, progress)
        else:
            rows = as_array(samples, "samples")
            if rows.shape != (len(self.vertices),) or rows.dtype.kind not in "iu":
                raise ArgumentError(f"samples: one index a vertex is wanted, {len(self.vertices)}, "
                                    f"not {rows.dtype} of shape {rows.shape}")
            if rows.size and (rows.min() < 0 or rows.max() >= count):
                raise ArgumentError(f"samples: indices from 0 to {count - 1} are wanted")
        carry(source._sound_properties(), rows, self.properties)

    def keep_components(self, *, largest: bool = False, least_faces: int = 0) -> "Mesh":
        """Drops components, sets of faces joined across edges, and the vertices that they alone use.

        Parameters
        ----------
        largest : bool
            Keeps one component, that of the largest area.
        least_faces : int
            Drops the components of fewer faces, before the largest one is looked for.

        Returns
        -------
        Mesh

        Examples
        --------
        >>> import brio
        >>> two = brio.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 0, 0], [7, 0, 0], [5, 2, 0]], [[0, 1, 2], [3, 4, 5]])
        >>> two.keep_components(largest=True).vertices.tolist()
        [[5.0, 0.0, 0.0], [7.0, 0.0, 0.0], [5.0, 2.0, 0.0]]
        """
        least_faces = as_count(least_faces, "least_faces", most=2**63 - 1)
        return self._changed(lambda numbered: _native.mesh_kept_components(numbered, largest, least_faces))

    def merge_vertices(self, distance: float = 0, *, progress: bool | Progress | None = None) -> "Mesh":
        """Merges vertices at equal positions, or near each other, so that faces that meet there share them.

        Of each set of merged vertices the one of the lexicographically least position stays, the first of coincident
        ones, with its properties. Faces lose corners that are equal; faces, tetrahedra and edges with too few are dropped.

        Parameters
        ----------
        distance : float
            Vertices at most so far apart become one, and so does a chain of them; 0: equal positions only.

        Returns
        -------
        Mesh

        Examples
        --------
        >>> import brio
        >>> apart = brio.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [3, 4, 5]])
        >>> apart.merge_vertices().faces.tolist()
        [[0, 1, 2], [1, 3, 2]]
        """
        distance = as_number(distance, "distance")
        with reporting(progress) as report:
            return self._changed(lambda numbered: _native.mesh_merged_vertices(numbered, distance, report))

    def subdivide(self, levels: int = 1, *, progress: bool | Progress | None = None) -> "Mesh":
        """Subdivides a surface of triangles smoothly, by the butterfly scheme: `levels` times each becomes four.

        Old vertices keep their indices and positions. A new vertex receives the mean of the properties of its edge's
        ends or, for properties that are no floating-point numbers, those of one end. Properties keep names, shapes and
        types. Triangles have the properties of the one that they are part of.

        Returns
        -------
        Mesh

        Examples
        --------
        >>> import brio
        >>> len(brio.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).subdivide(2).faces)
        16
        """
        properties = self._sound_properties()
        handle = self._copy(for_means(properties, len(self.vertices)), self._face_numbers())
        with reporting(progress) as report:
            mesh: Mesh = Mesh._of(_native.mesh_subdivided(handle, as_count(levels, "levels"), report))
        mesh.properties = from_means(mesh.properties, properties)
        self._carry_face_properties(mesh)
        return mesh

    def _changed(self, change: Callable[[Any], Any]) -> "Mesh":
        """Returns what `change` makes of this mesh with vertices and faces numbered; properties follow the numbers."""
        properties = self._sound_properties()
        numbers = {"number": np.arange(len(self.vertices), dtype=np.uint32)}
        mesh: Mesh = Mesh._of(change(self._copy(numbers, self._face_numbers())))
        rows = mesh.properties.pop("number")
        carry(properties, rows, mesh.properties)
        self._carry_face_properties(mesh)
        return mesh

    def _face_numbers(self) -> Properties:
        """The number of each face, if properties are to follow it."""
        if not self._sound_face_properties():
            return {}
        return {"number": np.arange(len(self.face_offsets) - 1, dtype=np.uint32)}

    def _carry_face_properties(self, mesh: "Mesh") -> None:
        """Gives a mesh whose faces have the numbers of faces of this one their properties."""
        rows = mesh.face_properties.pop("number", None)
        if rows is not None:
            carry(self._sound_face_properties(), rows, mesh.face_properties)

    def self_intersections(self, *, threads: int = 0, progress: bool | Progress | None = None) -> int:
        """Counts, exactly, the pairs of faces that meet in more than common corners and edges."""
        with reporting(progress) as report:
            pairs: int = _native.mesh_self_intersections(self._handle, threads, report)
        return pairs

    def distance(self, other: "Mesh", *, samples: int = 0, seed: int = 1, threads: int = 0,
                 progress: bool | Progress | None = None) -> Distance:
        """Compares two surfaces by random points on each (0: 100,000) and their exact distances from the other."""
        there, count = as_mesh(other, "other")._handle, as_count(samples, "samples", most=2**63 - 1)
        start = as_count(seed, "seed", most=2**64 - 1)
        with reporting(progress) as report:
            return Distance(**_native.mesh_distance(self._handle, there, count, start, threads, report))

    def signed_distances(self, points: Any, *, threads: int = 0,
                         progress: bool | Progress | None = None) -> Floats:
        """Measures how far points are from the nearest point of the faces; points inside, or behind the faces, have negative
        distances.

        Of a closed surface the side is exact, whichever way its faces look. Of any other one it is that of the triangles at
        the nearest point; where these disagree, of their normals, weighted by angles.

        Parameters
        ----------
        points : array_like, shape (n, 3)

        Returns
        -------
        ndarray of float64, shape (n,)

        Examples
        --------
        >>> import brio
        >>> square = brio.Mesh([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], [[0, 1, 2], [0, 2, 3]])
        >>> square.signed_distances([[1, 1, 3], [1, 1, -1], [2, 6, 3]]).tolist()
        [3.0, -1.0, 5.0]
        """
        rows = as_rows(points, "points")
        out = np.empty(len(rows))
        of_points(lambda p, w, t, report: _native.mesh_signed_distances(self._handle, p, out, t, report), rows, None,
                  threads, progress)
        return frozen(out)

    def coverage(self, points: Any, *, threads: int = 0, progress: bool | Progress | None = None) -> Coverage:
        """Compares the surface, of any origin, with the points that it is to go through.

        Parameters
        ----------
        points : array_like, shape (n, 3)

        Returns
        -------
        Coverage

        Examples
        --------
        A sheet over a grid of points whose middle is missing:

        >>> import brio, numpy as np
        >>> grid = np.array([[x, y, 0] for x in range(30) for y in range(30) if abs(x - 15) > 8 or abs(y - 15) > 8])
        >>> lid = brio.Mesh([[0, 0, 0], [29, 0, 0], [29, 29, 0], [0, 29, 0], [15, 15, 0]],
        ...                 [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
        >>> lid.subdivide(4).coverage(grid).bridges
        1
        """
        rows = as_rows(points, "points")
        bridge = np.empty(len(self.face_offsets) - 1, np.uint8)
        facts = of_points(lambda p, w, t, report: _native.mesh_coverage(self._handle, p, bridge, t, report), rows, None,
                          threads, progress)
        return Coverage(**facts, bridge=frozen(bridge.astype(bool)))

    def left_out(self, points: Any, *, threads: int = 0,
                 progress: bool | Progress | None = None) -> NDArray[np.bool_]:
        """Finds the points that the surface leaves: those farther than two spacings away, which coverage counts.

        Parameters
        ----------
        points : array_like, shape (n, 3)

        Returns
        -------
        ndarray of bool, shape (n,)
        """
        rows = as_rows(points, "points")
        out = np.empty(len(rows), np.uint8)
        of_points(lambda p, w, t, report: _native.mesh_left_out(self._handle, p, out, t, report), rows, None, threads,
                  progress)
        return frozen(out.astype(bool))

    def _copy(self, properties: Properties, face_properties: Properties | None = None) -> Any:
        """Returns an object of the library with what this mesh has now, and with these properties."""
        faces = self.face_offsets if len(self.face_offsets) > 1 else None
        return _native.mesh(self.vertices, faces, None if faces is None else self.face_vertices,
                            self.tetrahedra if len(self.tetrahedra) else None, self.edges if len(self.edges) else None,
                            properties, self._steps, face_properties if face_properties and faces is not None else {})

    def write(self, path: str | os.PathLike[str], *, ascii: bool = False, float32: bool = False, compress: bool = False,
              comment: str | None = None, progress: bool | Progress | None = None) -> None:
        """Writes a file, in the format of its extension; see docs/formats.md for what each keeps.

        Files take integers of at most 32 bits and doubles. Properties of other types are converted to these, or refused
        with ArgumentError if that would change a value.

        Parameters
        ----------
        path : str or path
        ascii : bool
            Text, in formats with a text and a binary form.
        float32 : bool
            Coordinates in single precision, in formats with both.
        compress : bool
            Compressed by zlib: VTU and VTP.
        comment : str, optional
            A line for the header.
        """
        handle = self._for_files()
        comment = None if comment is None else as_text(comment, "comment")
        with reporting(progress) as report:
            _native.write(as_path(path), handle, (ascii, float32, compress, comment), 0, report)

    def _for_files(self) -> Any:
        """The mesh with properties of the types that files have."""
        return self._copy(scalars(self._sound_properties()), scalars(self._sound_face_properties()))

    # --- for other packages, none of which is needed otherwise ---

    def to_trimesh(self) -> Any:
        """Returns a trimesh.Trimesh or, without faces, a trimesh.PointCloud.

        Colours (see `vertex_colors`) become the colours of its vertices. A Trimesh has the normals of the properties nx, ny
        and nz, and the properties as `vertex_attributes` and, if all polygons are triangles, `face_attributes`; a PointCloud has the properties in its `metadata`.
        """
        import trimesh

        colors = self.vertex_colors()
        shown = None if colors is None else np.rint(255 * colors).astype(np.uint8)
        properties = {name: np.array(values) for name, values in self._sound_properties().items()}
        if not len(self.faces):
            return trimesh.PointCloud(np.array(self.vertices), colors=shown, metadata=properties)
        triangles = len(self.faces) == len(self.face_offsets) - 1
        of_faces = {name: np.array(values) for name, values in self._sound_face_properties().items() if triangles}
        return trimesh.Trimesh(np.array(self.vertices), self.faces.astype(np.int64), process=False, vertex_colors=shown,
                               vertex_normals=normals_of(self._sound_properties()), vertex_attributes=properties,
                               face_attributes=of_faces)

    def to_open3d(self) -> Any:
        """Returns an open3d.geometry.TriangleMesh or, without faces, a PointCloud.

        Colours (see `vertex_colors`) come along, without the opacity, which Open3D does not have. Normals are those of the
        properties nx, ny and nz; a mesh without these gets those of its faces.
        """
        import open3d

        rows = open3d.utility.Vector3dVector
        given, colors = normals_of(self._sound_properties()), self.vertex_colors()
        vertices = rows(np.array(self.vertices))
        if not len(self.faces):
            cloud = open3d.geometry.PointCloud(vertices)
            if given is not None:
                cloud.normals = rows(given)
            if colors is not None:
                cloud.colors = rows(np.ascontiguousarray(colors[:, :3]))
            return cloud
        mesh = open3d.geometry.TriangleMesh(vertices, open3d.utility.Vector3iVector(self.faces.astype(np.int32)))
        mesh.vertex_normals = rows(np.array(self.normals) if given is None else given)
        if colors is not None:
            mesh.vertex_colors = rows(np.ascontiguousarray(colors[:, :3]))
        return mesh

    def vertex_colors(self) -> Floats | None:
        """Returns the colours of the vertices, from 0 to 1, or None.

        They are the properties red, green and blue, and alpha if it is there, or one property color, colour, rgb or rgba of
        rows of 3 or 4 numbers; capitals do not matter. Unsigned integers of 8 and 16 bits are parts of 255 and of 65535.
        Integers of more than 8 bits that are all at most 255 are parts of 255, as many LAS files have them. Floating-point
        numbers are taken as they are.

        Returns
        -------
        ndarray of float64, shape (n, 3) or (n, 4), or None

        Examples
        --------
        >>> import brio, numpy as np
        >>> brio.Mesh([[0, 0, 0]], properties={"red": [51], "green": [0], "blue": [255]}).vertex_colors().tolist()
        [[0.2, 0.0, 1.0]]
        """
        return colors_of(self._sound_properties())

    def to_pyvista(self) -> Any:
        """Returns a pyvista.UnstructuredGrid of tetrahedra if there are some, else a pyvista.PolyData."""
        import pyvista

        if len(self.tetrahedra):
            out = pyvista.UnstructuredGrid({pyvista.CellType.TETRA: self.tetrahedra.astype(np.int64)},
                                           np.array(self.vertices))
        elif len(self.faces):
            sizes = np.diff(self.face_offsets).astype(np.int64)
            cells = np.insert(self.face_vertices.astype(np.int64), self.face_offsets[:-1].astype(np.int64), sizes)
            out = pyvista.PolyData(np.array(self.vertices), cells)
        else:
            out = pyvista.PolyData(np.array(self.vertices))
        for name, values in self._sound_properties().items():
            out.point_data[name] = np.array(values)
        for name, values in self._sound_face_properties().items() if not len(self.tetrahedra) else ():
            out.cell_data[name] = np.array(values)
        return out

    def to_meshio(self) -> Any:
        """Returns a meshio.Mesh."""
        import meshio

        sizes = np.diff(self.face_offsets).astype(np.int64)
        cells = []
        of_faces = {name: [values[sizes == k] for k in np.unique(sizes)]
                    for name, values in self._sound_face_properties().items()}
        for k in np.unique(sizes):
            starts = self.face_offsets[:-1][sizes == k].astype(np.int64)
            rows = self.face_vertices[starts[:, None] + np.arange(k)].astype(np.int64)
            cells.append(({3: "triangle", 4: "quad"}.get(int(k), "polygon"), rows))
        for kind, rows in (("tetra", self.tetrahedra), ("line", self.edges)):
            if len(rows):
                cells.append((kind, rows.astype(np.int64)))
                for values in of_faces.values():  # no other cells have properties
                    values.append(np.zeros((len(rows), *values[0].shape[1:]), values[0].dtype))
        if not cells:
            cells = [("vertex", np.arange(len(self.vertices)).reshape(-1, 1))]
        data = {name: np.array(values) for name, values in self._sound_properties().items()}
        return meshio.Mesh(np.array(self.vertices), cells, point_data=data, cell_data=of_faces if len(sizes) else {})

    def __getstate__(self) -> dict[str, Any]:
        """What pickle and copy take; the object of the library is made again."""
        return {name: value for name, value in self.__dict__.items() if name != "_handle"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(freeze_all({"face_properties": {}, "cell": None, "periodic": None, **state}))
        views = {name: np.ascontiguousarray(state[name])
                 for name in ("vertices", "face_offsets", "face_vertices", "tetrahedra", "edges")}
        self._handle = _native.mesh(views["vertices"], views["face_offsets"], views["face_vertices"],
                                    views["tetrahedra"], views["edges"], {}, self._steps, {})
        self.__dict__.update({name: frozen(array) for name, array in views.items()})

    def __repr__(self) -> str:
        parts = [f"{len(self.vertices)} vertices"]
        for count, name in ((len(self.face_offsets) - 1, "faces"), (len(self.tetrahedra), "tetrahedra"),
                            (len(self.edges), "edges")):
            if count:
                parts.append(f"{count} {name}")
        return f"<brio.{type(self).__name__}: {', '.join(parts)}>"

    def _repr_html_(self) -> str:
        """A small picture and what is certain, for a cell of a notebook; brio.view(mesh) shows the whole there."""
        from ._view import picture

        words = [html.escape(repr(self)[6:-1])]
        if len(self.face_offsets) > 1:
            c = self.certificate
            words += ["closed" if c.closed else f"{c.boundary_loops} boundary loops", "manifold" if c.manifold else "not manifold",
                      "oriented" if c.oriented else "not oriented", f"{c.components} components, genus {c.genus}"]
        try:
            png = base64.b64encode(picture(self, size=(360, 240)).png).decode("ascii")
        except Error:  # a mesh that no picture can show
            return f"<p>{', '.join(words)}</p>"
        return (f'<figure style="margin: 0"><img width="360" height="240" alt="{words[0]}" src="data:image/png;base64,{png}">'
                f"<figcaption>{', '.join(words)}</figcaption></figure>")


def as_mesh(value: Any, name: str) -> Mesh:
    if not isinstance(value, Mesh):
        raise ArgumentError(f"{name}: a Mesh is wanted, not {type(value).__name__}")
    return value


def simplify(mesh: Mesh, faces: int = 0, *, tolerance: float = 0, progress: bool | Progress | None = None) -> Mesh:
    """Simplifies a surface of triangles: see Mesh.simplify."""
    return as_mesh(mesh, "mesh").simplify(faces, tolerance=tolerance, progress=progress)
