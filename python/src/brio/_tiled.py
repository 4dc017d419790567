"""Triangulations of more points than fit in memory: tile after tile, on a disk."""

import weakref
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from types import TracebackType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._arrays import MOST_TILES, Floats, as_array, as_box, as_count, as_number, as_path, as_rows, as_text, as_weights, frozen
from ._calls import Path, Progress, name_guilty, reporting
from ._files import as_reading
from .errors import ArgumentError, NotFiniteError

_BLOCK = 65536  # points at a time: as brio reads files
_STARS = {False: 0, "ordered-faces": 1, True: 2, "ordered": 3}


class TilePart:
    """The simplices that belong to one tile: those whose lexicographically least vertex is one of its points.

    The arrays are read-only views of what the library made, and stay valid after the triangulation is closed.

    Attributes
    ----------
    tile : int
    points : ndarray of float64, shape (n, 3)
        The vertices of the simplices, also those that are points of other tiles.
    weights : ndarray of float64, shape (n,), or None
    indices : ndarray of uint64, shape (n,)
        Of each vertex, its number in the order in which points were added.
    simplices : ndarray of uint32, shape (nsimplex, 4)
        Rows of `points`, positive: ``indices[simplices]`` are points of all tiles.
    """

    def __init__(self, owner: "TiledDelaunay", tile: int, made: tuple[Any, ...]) -> None:
        handle, points, weights, indices, simplices = made
        self.tile = tile
        self.points: Floats = np.asarray(points)
        self.weights: Floats | None = None if weights is None else np.asarray(weights)
        self.indices: NDArray[np.uint64] = np.asarray(indices)
        self.simplices: NDArray[np.uint32] = np.asarray(simplices)
        self._handle, self._owner = handle, owner

    @cached_property
    def neighbors(self) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """Tile and row of the simplex beyond the facet opposite to each vertex, two arrays of shape (nsimplex, 4).

        The tile is -1 at the hull. The first call for a triangulation reads all parts, and writes files; it needs the
        triangulation, which must not be closed.
        """
        out = np.full((len(self.simplices), 8), -1, np.int32).view(np.uint32)
        self._owner._call(_native.tiles_neighbors, self._handle, out)
        both = frozen(out.view(np.int32).reshape(-1, 4, 2))
        return both[:, :, 0], both[:, :, 1]

    def __repr__(self) -> str:
        return f"<brio.TilePart {self.tile}: {len(self.simplices)} simplices>"


class TileFaces(NamedTuple):
    """The faces of an alpha shape that belong to one tile; its arrays are the reader's.

    Attributes
    ----------
    tile : int
    points : ndarray of float64, shape (n, 3)
    indices : ndarray of uint64, shape (n,)
        Of each vertex, its number in the order in which points were added.
    faces : ndarray of uint32, shape (nfaces, 3)
        Rows of `points`, counterclockwise seen from outside.
    """

    tile: int
    points: Floats
    indices: NDArray[np.uint64]
    faces: NDArray[np.uint32]


class TiledDelaunay:
    """The Delaunay or regular triangulation of more points than fit in memory: in tiles, one after the other, on a disk.

    It is the triangulation that ``brio.Delaunay`` makes of all points, ties and hidden points included, with the same
    checksum. Points are added in blocks, of which nothing is kept; each simplex is in the part of one tile.

    Parameters
    ----------
    points : array_like, shape (n, 3), or iterator, optional
        As of `add`; then all is triangulated at once. Without points, `add` them and `run`.
    weights : array_like, shape (n,), optional
        With weights w, distances are power distances: squared distance minus w.
    scratch : str or path
        A folder with room for about 190 bytes a point; for cells in order 240, with their faces 850. Its files go with
        this object.
    tiles : int
        How many, at most 65,536. Of each, about 520 bytes a point are in memory. Fewer are faster.
    stars : bool or str
        True keeps what `cells` and `alpha_shape` need, 16 bytes for each simplex of two tiles. "ordered" counts before the
        work what cells in the order of their points need as well, "ordered-faces" with their faces.
    key : int
        Not 0: a number, below 2**64, that tells these points from others. After a process was killed, the next one with
        the same folder, key and number of tiles goes on with its files: see `has_points`.
    threads : int
        The most threads of the library; 0 is one for each processor.
    progress : bool or callable, optional
        As of ``brio.Delaunay``.
    max_memory : int, optional
        The most bytes that the library holds for this object, parts that are in use included. What would need more is
        refused before the work, with the number of tiles that would do.

    Attributes
    ----------
    tiles : int
    facts : dict
        Counts: points, vertices, duplicates, hidden, simplices, hull; the dimension; tiles that hold points, how many of
        these an earlier process had done (resumed), the most points and simplices in memory at a time, the most bytes in
        the folder (scratch_bytes), what the work was and how long it took. They stay after `close`.
    has_points : bool
        Whether an earlier process with this key left all points in the folder, so that none are to be added.
    min_bound, max_bound : ndarray, shape (3,)
    checksum : int
        That of ``brio.Delaunay`` of all points.

    Examples
    --------
    >>> import brio, numpy as np, tempfile
    >>> points = np.random.default_rng(1).random((2000, 3))
    >>> with tempfile.TemporaryDirectory() as folder, brio.TiledDelaunay(scratch=folder, tiles=4) as tri:
    ...     for block in np.array_split(points, 10):
    ...         tri.add(block)
    ...     tri.run()
    ...     same = tri.checksum == brio.Delaunay(points).checksum
    ...     count = sum(len(part.simplices) for part in tri)
    >>> same, count == tri.facts["simplices"]
    (True, True)
    """

    def __init__(self, points: Any = None, weights: Any = None, *, scratch: Path, tiles: int = 8,
                 stars: bool | str = False, key: int = 0, threads: int = 0, progress: bool | Progress | None = None,
                 max_memory: float | None = None) -> None:
        if isinstance(stars, bool | str) and stars in _STARS:
            kept = _STARS[stars]
        else:
            raise ArgumentError(f"stars: one of {', '.join(map(repr, _STARS))}, not {stars!r}")
        self.threads, self.progress = threads, progress
        self.tiles = as_count(tiles, "tiles", 1, MOST_TILES)
        self._limits = None, max_memory
        self._last: dict[str, Any] | None = None
        folder, number = as_path(scratch, "scratch", "a folder"), as_count(key, "key", most=2**64 - 1)
        with reporting(progress, self._limits) as report:
            self._handle = _native.tiles_new(folder, self.tiles, kept, number, threads, report)
        self._end = weakref.finalize(self, _native.tiles_close, self._handle)
        try:
            self._begin(points, weights)
        except BaseException:  # its traceback keeps this object, but the files go at once
            self._end()
            raise

    def _begin(self, points: Any, weights: Any) -> None:
        if points is None and weights is not None:
            raise ArgumentError("weights: there are no points; they come with the points")
        if points is not None and not self.has_points:
            self.add(points, weights)
        if points is not None:
            self.run()

    def _call(self, function: Callable[..., Any], *arguments: Any) -> Any:
        with reporting(self.progress, self._limits) as report:
            return function(*arguments, self.threads, report)

    # --- points ---

    def add(self, points: Any, weights: Any = None) -> None:
        """Appends points. They are read in blocks, copied to the folder, and not kept.

        Parameters
        ----------
        points : array_like, shape (n, 3), or iterator
            An array that is on a disk, such as a numpy.memmap or what h5py and zarr open, is not read as a whole. An
            iterator gives such arrays or, with weights, pairs of points and weights.
        weights : array_like, shape (n,), optional
            Of all points, or of none.
        """
        with reporting(self.progress, self._limits) as report:
            for rows, heavy in _blocks(points, weights):
                self._add(rows, heavy, report)

    def _add(self, rows: Floats, weights: Floats | None, report: Any) -> None:
        try:
            _native.tiles_add(self._handle, rows, weights, self.threads, report)
        except NotFiniteError as error:
            name_guilty(error, rows, weights)
            error.indices += self._facts["points"] - error.indices[0]  # those before the first are there
            raise

    def read(self, path: Path, *, format: str | None = None, columns: str | Sequence[str | None] | None = None,
             drop_invalid: bool = False, salvage: bool = False, weights: str | None = None) -> None:
        """Appends the points of a file; see `docs/formats.md` for those that are never in memory as a whole.

        Parameters
        ----------
        path, format, columns, drop_invalid, salvage
            As of ``brio.read``.
        weights : str, optional
            The property of the points that has their weights.
        """
        how, heavy = as_reading(format, columns, drop_invalid, salvage), None if weights is None else as_text(weights, "weights")
        self._call(_native.tiles_read, self._handle, as_path(path), how, heavy)

    def run(self) -> None:
        """Divides the points into tiles, and triangulates these.

        What was interrupted, or failed for want of memory, while tiles were triangulated, goes on where it was when it is
        called again.
        """
        self._call(_native.tiles_run, self._handle)

    # --- questions ---

    @property
    def _facts(self) -> dict[str, Any]:
        facts: dict[str, Any] = _native.tiles_facts(self._handle) if self._last is None else self._last
        return facts

    @property
    def facts(self) -> dict[str, Any]:
        """Counts; see the class."""
        return {name: value for name, value in self._facts.items() if name not in ("has_points", "low", "high")}

    @property
    def has_points(self) -> bool:
        """Whether the folder has all points of an earlier process."""
        return bool(self._facts["has_points"])

    @property
    def min_bound(self) -> Floats:
        """The least coordinates of all points."""
        return np.array(self._facts["low"])

    @property
    def max_bound(self) -> Floats:
        """The greatest ones."""
        return np.array(self._facts["high"])

    @cached_property
    def checksum(self) -> int:
        """That of brio.Delaunay of all points. Sorts all vertices, with 40 bytes of disk for each."""
        total: int = self._call(_native.tiles_checksum, self._handle)
        return total

    def part(self, tile: int) -> TilePart:
        """Reads the simplices of a tile, 0 to tiles - 1. They are the same, in the same order, in every call."""
        which = as_count(tile, "tile", most=self.tiles - 1)
        return TilePart(self, which, self._call(_native.tiles_part, self._handle, which))

    def __iter__(self) -> Iterator[TilePart]:
        """The parts of all tiles, each read when it is its turn; together they are the triangulation."""
        return (self.part(tile) for tile in range(self.tiles))

    def cells(self, take: Callable[[dict[str, NDArray[Any]]], Any], *, box: Any = None, ordered: bool = False,
              areas: bool = True, centroids: bool = True, faces: bool = True, vertices: bool = False) -> dict[str, Any]:
        """Computes the Voronoi or power cells of all vertices, some thousands at a time.

        The numbers are those of ``brio.Voronoi``, bit for bit. It needs `stars`.

        Parameters
        ----------
        take : callable
            Called with a dict of arrays for each block of cells, by the names of ``brio.Voronoi(...).cells``: "site" (the
            number of each cell's point), "volume", "bounded", and what is asked for. It may keep them. What it raises
            ends the work.
        box : array_like, shape (2, 3) or (6,), optional
            Clips the cells.
        ordered : bool
            In the order of their points; else tile after tile. Sorts in the folder, 56 bytes a cell and, with faces, 40 a
            face. Not with vertices.
        areas, centroids, faces, vertices : bool
            What is computed beside volumes. Vertices bring faces.

        Returns
        -------
        dict
            Counts of cells, bounded ones and faces, of points outside of the box; the sum of the volumes and that of the
            box.

        Examples
        --------
        >>> import brio, numpy as np, tempfile
        >>> points, volumes = np.random.default_rng(1).random((500, 3)), np.zeros(500)
        >>> def take(cells):
        ...     volumes[cells["site"]] = cells["volume"]
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     with brio.TiledDelaunay(points, scratch=folder, tiles=4, stars=True) as tri:
        ...         _ = tri.cells(take, box=[0, 0, 0, 1, 1, 1], faces=False)
        >>> round(float(volumes.sum()), 12)
        1.0
        """
        if not callable(take):
            raise ArgumentError(f"take: a function of a block of cells is wanted, not {take!r}")
        corners = None if box is None else as_box(box, 3)
        chosen = (int(ordered), int(not areas), int(not centroids), int(not (faces or vertices)), 0, int(vertices))

        def give(raw: dict[str, Any]) -> None:
            take({name: np.asarray(part) for name, part in raw.items() if part is not None and not isinstance(part, float)})

        facts: dict[str, Any] = self._call(_native.tiles_cells, self._handle, give, chosen, corners)
        return facts

    def alpha_shape(self, alpha: float, take: Callable[[TileFaces], Any] | None = None) -> dict[str, Any]:
        """Makes the boundary of an alpha shape, tile after tile: the faces of ``brio.AlphaShape``. It needs `stars`.

        Parameters
        ----------
        alpha : float
            A squared radius.
        take : callable, optional
            Called with the TileFaces of each tile that has faces. Where parts of the solid touch, vertices are not
            doubled. What it raises ends the work.

        Returns
        -------
        dict
            The simplices of the triangulation by dimension; the tetrahedra of the complex, the faces of the boundary,
            vertices in no tetrahedron of the complex ("uncovered"), simplices that bound no tetrahedron ("singular_...").
        """
        if take is not None and not callable(take):
            raise ArgumentError(f"take: a function of the faces of a tile is wanted, not {take!r}")

        def give(tile: int, *arrays: Any) -> None:
            take(TileFaces(tile, *map(np.asarray, arrays)))  # type: ignore[misc]

        number = as_number(alpha, "alpha")
        facts: dict[str, Any] = self._call(_native.tiles_alpha, self._handle, number, None if take is None else give)
        return facts

    # --- the end ---

    def close(self) -> None:
        """Removes the files. Parts that were read, facts, and a checksum that was asked for stay."""
        if self._last is None:
            last = self._facts
            _native.tiles_close(self._handle)
            self._last = last
            self._end.detach()

    def __enter__(self) -> "TiledDelaunay":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()

    def __repr__(self) -> str:
        facts = self._facts
        return f"<brio.TiledDelaunay of {facts['points']} points: {facts['simplices']} simplices in {self.tiles} tiles>"


def _blocks(points: Any, weights: Any) -> Iterator[tuple[Floats, Floats | None]]:
    """Points and weights, some at a time, as the library takes them."""
    if not isinstance(points, Iterator):
        yield from _slices(points, weights)
        return
    if weights is not None:
        raise ArgumentError("weights: an iterator of points gives them in pairs: (points, weights)")
    for block in points:
        yield from _slices(*block) if isinstance(block, tuple) and len(block) == 2 else _slices(block, None)


def _slices(points: Any, weights: Any) -> Iterator[tuple[Floats, Floats | None]]:
    """Slices of an array, which may be on a disk."""
    rows = points if len(getattr(points, "shape", ())) == 2 else as_array(points, "points")
    if rows.ndim != 2 or rows.shape[1] != 3:
        as_rows(rows, "points")
    count = rows.shape[0]
    heavy = None if weights is None else as_weights(weights, count)
    for first in range(0, count, _BLOCK):
        part = as_rows(rows[first : first + _BLOCK], "points")
        yield part, None if heavy is None else heavy[first : first + _BLOCK]
