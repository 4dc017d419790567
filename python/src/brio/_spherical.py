"""Voronoi diagrams on spheres and circles, under scipy's names, by convex hulls."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._arrays import Floats, as_floats, as_number, as_rows, freeze_all
from ._calls import Progress
from ._hull import ConvexHull
from ._points import thin
from ._scipy import other_class
from .errors import ArgumentError

Lists = list[list[int]]


class SphericalVoronoi:
    """The Voronoi diagram of points on a sphere, or on a circle.

    A facet of the convex hull of the points has a Voronoi vertex above it. The hull is exact, of the points moved onto the
    sphere. Names, shapes and types are those of ``scipy.spatial.SphericalVoronoi``.

    Parameters
    ----------
    points : array_like, shape (n, 2) or (n, 3)
    radius : float
    center : array_like, shape (ndim,), optional
        The default is the origin.
    threshold : float
        Points nearer to each other than `threshold` times the radius, or farther from the sphere than that, are refused.
    threads, progress, fallback
        As for Delaunay.

    Attributes
    ----------
    points, center : ndarray of float64
    radius : float
    vertices : ndarray of float64, shape (nvertices, ndim)
        Points on one circle, as the corners of a cube's face, have a vertex for each of their triangles, at one place.
    regions : list of lists of int
        The vertices of each point's region; sort_vertices_of_regions puts them in order.

    Examples
    --------
    >>> import brio
    >>> axes = brio.SphericalVoronoi([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
    >>> [len(region) for region in axes.regions]
    [4, 4, 4, 4, 4, 4]
    >>> axes.calculate_areas().round(6).tolist()
    [2.094395, 2.094395, 2.094395, 2.094395, 2.094395, 2.094395]
    """

    points: Floats
    center: Floats
    radius: float
    vertices: Floats
    regions: Lists

    def __new__(cls, points: Any = None, radius: Any = 1, center: Any = None, threshold: Any = 1e-6, *,
                fallback: str | None = None, **options: Any) -> Any:
        if points is None:  # of pickle
            return object.__new__(cls)
        other = other_class("SphericalVoronoi", points, fallback, {}, (points, radius, center, threshold))
        return object.__new__(cls) if other is None else other

    def __init__(self, points: Any, radius: Any = 1, center: Any = None, threshold: Any = 1e-6, *, threads: int = 0,
                 progress: bool | Progress | None = None, fallback: str | None = None) -> None:
        self.points = as_rows(points, "points", (2, 3)).copy()
        self._dim = self.points.shape[1]
        if radius is None:
            raise ArgumentError("`radius` is `None`. A number is wanted.")
        self.radius = as_number(radius, "radius")
        self.center = np.zeros(self._dim) if center is None else as_floats(center, "center").copy()
        if self.center.shape != (self._dim,):
            raise ArgumentError(f"center: an array of shape ({self._dim},) is wanted, not of shape {self.center.shape}")
        near = as_number(threshold, "threshold") * self.radius
        if not (0 < self.radius < np.inf and 0 <= near < np.inf):
            raise ArgumentError(f"radius and threshold: positive numbers are wanted, not {radius!r} and {threshold!r}")
        self._refuse(near)
        self._build(threads, progress)
        freeze_all(self.__dict__)

    def _refuse(self, near: float) -> None:
        """Refuses points that are not on the sphere, that span less than it, or that are one point."""
        if not np.isfinite(self.points).all():
            raise ArgumentError("points: there are coordinates that are not finite")
        if len(self.points) == 0 or np.linalg.matrix_rank(self.points - self.points[0], tol=near) < self._dim:
            raise ArgumentError(f"Rank of input points must be at least {self._dim}")
        space = np.zeros((len(self.points), 3))
        space[:, : self._dim] = self.points
        if near > 0 and not thin(space, near).all():
            raise ArgumentError("Duplicate generators present.")
        if np.abs(np.linalg.norm(self.points - self.center, axis=1) - self.radius).max() >= max(near, 1e-9 * self.radius):
            raise ArgumentError("Radius inconsistent with generators.")

    def _build(self, threads: int, progress: bool | Progress | None) -> None:
        offsets = self.points - self.center
        hull = ConvexHull(offsets / np.linalg.norm(offsets, axis=1)[:, None], threads=threads, progress=progress)
        self.vertices = self.radius * hull.equations[:, :-1] + self.center
        self._simplices: NDArray[np.int32] = hull.simplices
        corners = self._simplices.ravel()
        order = np.argsort(corners, kind="stable")
        ends = np.cumsum(np.bincount(corners, minlength=len(self.points))).tolist()
        at = (order // self._dim).tolist()
        self.regions = [at[i:j] for i, j in zip([0, *ends[:-1]], ends)]

    def sort_vertices_of_regions(self) -> None:
        """Puts the vertices of each region in counterclockwise order, as seen from outside of the sphere."""
        if self._dim != 3:
            raise TypeError("Only supported for three-dimensional point sets")
        corners = self._simplices.tolist()
        for point, region in enumerate(self.regions):
            after = {}  # of a corner of the triangles at the point: the triangle that begins there, and the corner where it ends
            for triangle in region:
                k = corners[triangle].index(point)
                after[corners[triangle][(k + 1) % 3]] = triangle, corners[triangle][(k + 2) % 3]
            first = region[0]
            at = corners[first][(corners[first].index(point) + 1) % 3]
            ordered = []
            for _ in region:
                triangle, at = after[at]
                ordered.append(triangle)
            self.regions[point] = ordered

    def calculate_areas(self) -> Floats:
        """Computes the area of each region; on a circle, the length of its arc.

        Returns
        -------
        ndarray of float64, shape (n,)
        """
        return self._arcs() if self._dim == 2 else self._areas()

    def _arcs(self) -> Floats:
        """Half the arc between a point and each of its two neighbours."""
        ends = (self.points - self.center)[self._simplices]
        cross = ends[:, 0, 0] * ends[:, 1, 1] - ends[:, 0, 1] * ends[:, 1, 0]
        angles = np.arctan2(cross, (ends[:, 0] * ends[:, 1]).sum(axis=1)) % (2 * np.pi)  # edges are counterclockwise
        out = np.zeros(len(self.points))
        np.add.at(out, self._simplices, angles[:, None] / 2)
        return self.radius * out

    def _areas(self) -> Floats:
        """Solid angles of the triangles of a point and two vertices that follow each other."""
        self.sort_vertices_of_regions()
        sizes = np.array([len(region) for region in self.regions])
        here = np.concatenate([np.array(region, np.int64) for region in self.regions])
        there = np.concatenate([np.roll(np.array(region, np.int64), -1) for region in self.regions])
        owner = np.repeat(np.arange(len(sizes)), sizes)
        a = (self.points[owner] - self.center) / self.radius
        b, c = ((self.vertices[k] - self.center) / self.radius for k in (here, there))
        volume = (a * np.cross(b, c)).sum(axis=1)
        below = 1 + (a * b).sum(axis=1) + (b * c).sum(axis=1) + (c * a).sum(axis=1)
        angles = 2 * np.arctan2(volume, below)
        areas: Floats = np.asarray(self.radius**2 * np.bincount(owner, angles, minlength=len(sizes)), np.float64)
        return areas

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(freeze_all(state))

    def __repr__(self) -> str:
        return f"<brio.SphericalVoronoi of {len(self.points)} points: {len(self.vertices)} vertices>"
