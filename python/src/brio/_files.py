"""Files, and what this build of the library reads and writes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from . import _native
from ._arrays import MOST_TILES, as_box, as_count, as_number, as_path, as_text
from ._calls import Path, Progress, reporting
from ._mesh import Mesh
from .errors import ArgumentError


@dataclass(frozen=True)
class Conversion:
    """What convert did.

    Attributes
    ----------
    points_read, points : int
        Read, and written.
    faces, tetrahedra, edges : int
        Written.
    outliers, thinned : int
        Points that these options dropped.
    streamed : bool
        Block by block; else the whole file was in memory.
    lost : list of str
        What the other format cannot hold: "faces", "tetrahedra", "edges", names of properties, and "precision" if
        coordinates, or whole numbers of a text, were rounded.
    merged, degenerate : int
        Vertices that others stand for by `merge`, and faces, tetrahedra and edges dropped by that.
    tiles, largest_tile : int
        Files that were written by `tiles`, and the points of the largest.
    """

    points_read: int
    points: int
    faces: int
    tetrahedra: int
    edges: int
    outliers: int
    thinned: int
    streamed: bool
    lost: list[str]
    merged: int = 0
    degenerate: int = 0
    tiles: int = 0
    largest_tile: int = 0


def as_reading(format: str | None, columns: str | Sequence[str | None] | None, drop_invalid: bool,
               salvage: bool) -> tuple[str | None, str | None, bool, bool]:
    """Options of reading as the library takes them."""
    return None if format is None else as_text(format, "format"), _columns(columns), drop_invalid, salvage


def _columns(columns: str | Sequence[str | None] | None) -> str | None:
    if columns is None:
        return None
    if isinstance(columns, str):
        return as_text(columns, "columns")
    try:
        names = ["-" if name is None else as_text(name, "columns") for name in columns]
    except TypeError as error:
        raise ArgumentError(f"columns: a list of names is wanted, not {columns!r}") from error
    for name in names:
        if "," in name:
            raise ArgumentError(f"columns: a name without commas is wanted, not {name!r}")
    return ",".join(names)


def read(path: Path, *, format: str | None = None, columns: str | Sequence[str | None] | None = None,
         drop_invalid: bool = False, salvage: bool = False, threads: int = 0, progress: bool | Progress | None = None, scratch: Path | None = None, max_memory: float | None = None) -> Mesh:
    """Reads a file of points or of a mesh: PLY, XYZ, OBJ, OFF, VTU, LAS, LAZ, PCD, STL, NPY and others.

    Parameters
    ----------
    path : str or path
    format : str, optional
        The extension of a format, such as "ply", for a file with another name; the default is by the name, and by the
        content where it tells the format.
    columns : sequence of str, optional
        The names of the columns of a text of points, in their order: "x", "y" and "z" have to be there; None or "-"
        leaves a column out, as it happens to columns behind the last name. "x,y,z,-,nx" says the same. The default is the
        file's line of names or, without one, that the first three are the coordinates.
    drop_invalid : bool
        Leaves out points whose coordinates are not finite, and what uses them, instead of refusing the file.
    salvage : bool
        Of a file that ends early, keeps the points that are whole.
    threads, progress, scratch, max_memory
        As for Delaunay. The mesh has its arrays in `scratch` then.

    Returns
    -------
    Mesh
        Without faces if the file has points alone.

    Examples
    --------
    >>> import brio, os, tempfile
    >>> path = os.path.join(tempfile.mkdtemp(), "three.ply")
    >>> brio.write(path, [[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> brio.read(path)
    <brio.Mesh: 3 vertices>
    >>> path = os.path.join(tempfile.mkdtemp(), "two.xyz")
    >>> with open(path, "w") as file:
    ...     _ = file.write("7 100 0 0 0\\n8 200 0 0 1\\n")
    >>> scan = brio.read(path, columns=[None, "heat", "x", "y", "z"])
    >>> scan.vertices.tolist(), scan.properties["heat"].tolist()
    ([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [100.0, 200.0])
    >>> path = os.path.join(tempfile.mkdtemp(), "stations.dat")
    >>> with open(path, "w") as file:
    ...     _ = file.write("1 2 3\\n")
    >>> brio.read(path, format="xyz").vertices.tolist()
    [[1.0, 2.0, 3.0]]
    """
    how = as_reading(format, columns, drop_invalid, salvage)
    with reporting(progress, (scratch, max_memory)) as report:
        mesh: Mesh = Mesh._of(_native.read(as_path(path), how, threads, report))
    return mesh


def write(path: Path, mesh: Any, **options: Any) -> None:
    """Writes a Mesh, or an array of points, in the format of the file's extension; options as for Mesh.write."""
    (mesh if isinstance(mesh, Mesh) else Mesh(mesh)).write(path, **options)


def convert(source: Path, target: Path, *, columns: str | Sequence[str | None] | None = None,
            drop_invalid: bool = False, salvage: bool = False, box: Any = None,
            outliers: int = 0, factor: float = 3.0, thin: float = 0.0, merge: bool | float = False, ascii: bool = False, float32: bool = False,
            compress: bool = False, comment: str | None = None, tiles: int = 0, scratch: Path | None = None, threads: int = 0,
            progress: bool | Progress | None = None) -> Conversion:
    """Converts a file to another format, or chooses among its points, or both; large files block by block.

    First come the points in the box, of these those that are no outliers, of these a thinned set; merging comes last. The
    points keep their order and all properties. A face, tetrahedron or edge stays if all its vertices stay.

    Parameters
    ----------
    source, target : str or path
    columns, drop_invalid, salvage
        As for read.
    box : array_like, shape (2, 3) or (6,), optional
        The lower corner and the upper one; its border belongs to it.
    outliers : int
        The neighbours by which outliers judges; 0 keeps outliers.
    factor : float
        As for outliers.
    thin : float
        The spacing; 0 keeps all points.
    merge : bool or float
        Merges vertices at equal positions (True), or at most this distance apart, as Mesh.merge_vertices does.
    ascii, float32, compress, comment
        As for Mesh.write.
    tiles : int
        The points of a file of any size in as many files of about equal numbers of points, by their places, at most
        65,536; 0 writes one file. `target` then has a # in the place of a file's number, as in "folder/#.laz", and the
        folder is there. No index is written: `brio convert --tiles` writes one. Faces, tetrahedra and edges are left
        out, and named. Where this fails, files may be there.
    scratch : str or path
        With `tiles`: a folder with room for twice the points.

    Returns
    -------
    Conversion

    Examples
    --------
    >>> import brio, os, tempfile
    >>> folder = tempfile.mkdtemp()
    >>> a, b = os.path.join(folder, "a.ply"), os.path.join(folder, "b.xyz")
    >>> brio.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).write(a)
    >>> done = brio.convert(a, b, box=[0, 0, 0, 1, 0.5, 0])
    >>> done.points_read, done.points, done.lost
    (3, 2, [])
    """
    corners = None if box is None else as_box(box, 3)
    comment = None if comment is None else as_text(comment, "comment")
    divides = as_count(tiles, "tiles", most=MOST_TILES), b"" if scratch is None else as_path(scratch, "scratch", "a folder")
    neighbours = as_count(outliers, "outliers", most=63)
    merges, distance = (merge, 0.0) if isinstance(merge, bool) else (True, as_number(merge, "merge"))
    with reporting(progress) as report:
        choice = neighbours, as_number(factor, "factor"), as_number(thin, "thin"), merges, distance
        facts = _native.convert(as_path(source), as_path(target), as_reading(None, columns, drop_invalid, salvage),
                                (ascii, float32, compress, comment), corners, choice, divides, threads, report)
    return Conversion(**facts)


def build_info() -> dict[str, Any]:
    """Says how the library was built.

    Returns
    -------
    dict
        "version"; "zlib", "zstd", "expat", "cjson": whether the library reads what needs these libraries (gzip, npz and
        compressed VTU; zstd; E57; glTF); "free_threaded": whether the module was built for CPython without the lock of
        the interpreter.

    Examples
    --------
    >>> import brio
    >>> brio.build_info()["version"] == brio.__version__
    True
    """
    facts: dict[str, Any] = _native.build_info()
    return facts
