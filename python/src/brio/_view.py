"""Pages that show meshes in a browser, or in a cell of a notebook, and pictures of them."""

from __future__ import annotations

import html
import os
import pathlib
import tempfile
import webbrowser
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from . import _native
from ._arrays import as_count, as_path, as_rows, as_text
from ._calls import Path, Progress, reporting
from ._shown import mesh_of
from .errors import ArgumentError

__all__ = ["Page", "Picture", "picture", "view"]


class Page:
    """A page that `view` made. As the last value of a notebook's cell it is shown there.

    Attributes
    ----------
    html : str
        The whole page.
    height : int
        Of the cell's frame, in pixels.
    """

    def __init__(self, text: str, height: int = 520) -> None:
        self.html, self.height = text, height

    def __repr__(self) -> str:
        return "<brio.Page of %.1f MB: save(path), open()>" % (len(self.html) / 1e6)

    def save(self, path: Path) -> None:
        """Writes the page to a file, such as page.html."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.html)

    def open(self) -> str:
        """Opens the page in a browser; returns the temporary file that it wrote for that, which stays."""
        number, path = tempfile.mkstemp(suffix=".html", prefix="brio-")
        os.close(number)
        self.save(path)
        webbrowser.open(pathlib.Path(path).as_uri())
        return path

    def _repr_html_(self) -> str:
        return ('<iframe srcdoc="%s" style="width: 100%%; height: %dpx; border: 0" title="brio"></iframe>'
                % (html.escape(self.html), self.height))


@dataclass(frozen=True)
class Picture:
    """A picture that `picture` made. As the last value of a notebook's cell it is shown there.

    Attributes
    ----------
    png : bytes
        The file.
    look : tuple of float
        The direction of the eye, a unit vector.
    pixel : float
        The length of a pixel, in the unit of the meshes.
    range : tuple of float
        The least and the greatest value of the colour map; 0 and 0 without one.
    """

    png: bytes
    look: tuple[float, float, float]
    pixel: float
    range: tuple[float, float]

    def __repr__(self) -> str:
        return "<brio.Picture of %.0f kB: save(path)>" % (len(self.png) / 1e3)

    def save(self, path: Path) -> None:
        """Writes the picture to a file, such as picture.png."""
        with open(path, "wb") as file:
            file.write(self.png)

    def _repr_png_(self) -> bytes:
        return self.png


def layers_of(meshes: Sequence[Any], names: Sequence[str] | None) -> tuple[tuple[Any, str | None, None], ...]:
    """Takes what is to be shown, with its names, as the native functions want it."""
    list_of = [mesh_of(m) for m in meshes]
    words = [as_text(name, "names") for name in names] if names is not None else [None] * len(list_of)
    if len(words) != len(list_of):
        raise ArgumentError("names: %d for %d meshes" % (len(words), len(list_of)))
    return tuple((m._for_files(), name, None) for m, name in zip(list_of, words))


def picture(*meshes: Any, look: Any = None, colour_by: str | None = None, size: tuple[int, int] = (960, 640),
            self_intersections: bool = False, side_by_side: bool = False, dark: bool = False, threads: int = 0,
            progress: bool | Progress | None = None) -> Picture:
    """Draws a picture of meshes, or arrays of points, without a graphics card and without a browser.

    Parameters
    ----------
    meshes : Mesh, Delaunay, Voronoi, ConvexHull, or array_like, shape (n, 3)
        One to twelve: over each other, or side by side; of space that repeats and living ones, too. Cells are those that
        end; without a box not those that reach beyond the points by over a quarter of their extent; of over 8,000 an even choice.
    look : array_like, shape (3,), optional
        The direction of the eye; by default, of some directions the one that shows most.
    colour_by : str, optional
        A property of vertices or faces, "x", "y" or "z", by a colour map; "none" for one colour. By default the colours of
        the meshes.
    size : tuple of int
        Pixels: the width and the height.
    self_intersections : bool
        Finds the faces that run through each other, and shows them in red.
    side_by_side : bool
    dark : bool
        A dark background.

    Returns
    -------
    Picture

    Examples
    --------
    >>> import brio
    >>> picture = brio.picture(brio.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]), look=(0, 0, 1), size=(200, 100))
    >>> picture.png[1:4], [round(x) for x in picture.look]
    (b'PNG', [0, 0, 1])
    """
    layers = layers_of(meshes, None)
    direction = as_rows([(0.0, 0.0, 0.0) if look is None else look], "look")[0]
    if look is not None and not direction.any():
        raise ArgumentError("look: no direction")
    width, height = (as_count(n, "size", 1) for n in size)
    options = (width, height, None if colour_by is None else as_text(colour_by, "colour_by"), self_intersections, side_by_side, dark)
    with tempfile.TemporaryDirectory(prefix="brio-") as folder:
        path = os.path.join(folder, "picture.png")
        with reporting(progress) as report:
            seen = _native.write_picture(as_path(path), layers, options, tuple(direction.tolist()), threads, report)
        with open(path, "rb") as file:
            return Picture(file.read(), *seen)


def view(*meshes: Any, names: Sequence[str] | None = None, title: str | None = None, points: int = 0, exact: bool = False,
         self_intersections: bool = False, side_by_side: bool = False, height: int = 520, threads: int = 0,
         progress: bool | Progress | None = None) -> Page:
    """Makes a page that shows meshes, or arrays of points, in a browser or in a cell of a notebook.

    The page needs no network. It shows points, faces, edges and tetrahedra, properties as colours, and the certificate;
    docs/view.md describes it.

    Parameters
    ----------
    meshes : Mesh, Delaunay, Voronoi, ConvexHull, or array_like, shape (n, 3)
        One to twelve: layers of one scene; of space that repeats and living ones, too. Cells are those that end; without a
        box not those that reach beyond the points by over a quarter of their extent; of over 8,000 an even choice.
    names : sequence of str, optional
        A name for each.
    title : str, optional
    points : int
        Clouds of more points are thinned evenly to this number; 0 stands for 5,000,000.
    exact : bool
        Every number to the last bit, also of more than 250,000 vertices.
    self_intersections : bool
        Finds the faces that run through each other.
    side_by_side : bool
        Opens with the meshes side by side, instead of over each other.
    height : int
        Of the frame in a notebook, in pixels.

    Returns
    -------
    Page

    Examples
    --------
    >>> import brio
    >>> page = brio.view(brio.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]), names=["a triangle"])
    >>> "a triangle" in page.html
    True
    """
    layers = layers_of(meshes, names)
    options = (None if title is None else as_text(title, "title"), as_count(points, "points"), exact, self_intersections, side_by_side)
    with tempfile.TemporaryDirectory(prefix="brio-") as folder:
        path = os.path.join(folder, "page.html")
        with reporting(progress) as report:
            _native.write_page(as_path(path), layers, options, threads, report)
        with open(path, encoding="utf-8") as file:
            return Page(file.read(), as_count(height, "height", 1))
