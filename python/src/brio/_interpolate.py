"""Interpolation of values at scattered points, under scipy's names."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._arrays import Floats, as_floats, as_threads, as_values
from ._delaunay import Delaunay, as_tolerance
from ._tolerance import coordinates as barycentric
from ._tolerance import find_within
from ._points import nearest
from .errors import ArgumentError, NoAnswerError, NotOfferedError

_NATURAL, _LINEAR = 0, 1


def coordinates(args: Any, ndim: int | None = None) -> Floats:
    """Takes positions as one array, or as a tuple of arrays of their coordinates, as scipy does."""
    if isinstance(args, tuple) and len(args) == 1:
        args = args[0]
    if isinstance(args, tuple):
        parts = [as_floats(part, "xi") for part in args]
        try:
            return np.stack(np.broadcast_arrays(*parts), axis=-1)
        except ValueError as error:
            raise ArgumentError(f"xi: coordinates that do not fit each other: {error}") from error
    array = as_floats(args, "xi")
    if array.ndim == 0:
        raise ArgumentError("xi: a position is an array of coordinates, not a number")
    if array.ndim == 1:
        if ndim is not None and array.size % ndim:
            raise ArgumentError(f"xi: {array.size} numbers are no positions of {ndim} coordinates")
        array = array.reshape(-1, 1 if ndim is None else ndim)
    return array


class _Interpolator:
    """What both methods share."""

    _method = _LINEAR

    def __init__(self, points: Any, values: Any, fill_value: complex = np.nan, rescale: bool = False, *,
                 tol: float | None = None, threads: int = 0) -> None:
        self.threads = as_threads(threads)
        self.tol = as_tolerance(tol)
        self.offset: Floats | None = None
        self.scale: Floats | None = None
        if isinstance(points, Delaunay):
            if rescale:
                raise ArgumentError("Rescaling is not supported when passing a Delaunay triangulation as ``points``.")
            self.tri = points
        else:
            rows = coordinates(points)
            if rescale:
                self.offset, self.scale = rows.mean(axis=0), np.ptp(rows, axis=0)
                self.scale[~(self.scale > 0)] = 1
                rows = (rows - self.offset) / self.scale
            self.tri = Delaunay(rows, threads=threads)
        self.points = self.tri.points
        self._set_values(values, fill_value)

    def _set_values(self, values: Any, fill_value: complex) -> None:
        array = as_values(values, "values")
        if array.ndim == 0 or len(array) != self.tri.npoints:
            raise ArgumentError(f"values: one row a point is wanted: {self.tri.npoints}, not an array of shape {array.shape}")
        self.is_complex = array.dtype.kind == "c"
        self.values_shape = array.shape[1:]
        flat = array.reshape(len(array), math.prod(self.values_shape))
        if self.is_complex:
            flat = np.concatenate([flat.real, flat.imag], axis=1)
        self.values = np.ascontiguousarray(flat)
        self.fill_value = complex(fill_value) if self.is_complex else float(np.real(fill_value))

    def __call__(self, *args: Any) -> NDArray[Any]:
        """Interpolates at positions: an array of shape (..., ndim), or an array for each coordinate.

        Returns
        -------
        ndarray, shape (...) and then that of a value
            `fill_value` outside of the hull.
        """
        if self.tri.npoints != len(self.values):
            raise ArgumentError(f"the triangulation has {self.tri.npoints} points, and there are values at {len(self.values)}: "
                                "points were added to it")
        xi = coordinates(args, self.tri.ndim)
        if xi.shape[-1] != self.tri.ndim:
            raise ArgumentError(f"number of dimensions in xi does not match x: {xi.shape[-1]} and {self.tri.ndim}")
        rows = np.ascontiguousarray(xi.reshape(-1, self.tri.ndim))
        if self.offset is not None and self.scale is not None:
            rows = (rows - self.offset) / self.scale
        finite = np.flatnonzero(np.isfinite(rows).all(axis=1))
        out = np.full((len(rows), self.values.shape[1]), np.nan)
        inside = np.zeros(len(rows), np.bool_)
        found = np.empty((len(finite), out.shape[1]))
        near = rows if len(finite) == len(rows) else rows[finite]
        self._interpolate(near, found)
        inside[finite] = self._fill_beside(near, found)
        out[finite] = found
        return self._shaped(out, inside).reshape(xi.shape[:-1] + self.values_shape)

    def _fill_beside(self, rows: Floats, out: Floats) -> NDArray[np.bool_]:
        """Interpolates at positions that are outside of the hull within the tolerance; returns which positions are inside."""
        inside = np.ones(len(rows), np.bool_)
        maybe = np.flatnonzero(np.isnan(out).any(axis=1)) if out.shape[1] else np.arange(len(rows))
        outside = maybe[self.tri._find(rows[maybe], 0) < 0]
        inside[outside] = False
        if self.tol and len(outside):
            simplex = find_within(self.tri, rows[outside], self.tol)
            near, simplex = outside[simplex >= 0], simplex[simplex >= 0]
            if len(near):
                shares = barycentric(self.tri, simplex, rows[near])
                out[near] = np.einsum("qk,qkc->qc", shares, self.values[self.tri.representatives[self.tri.simplices[simplex]]])
                inside[near] = True
        return inside

    def _interpolate(self, rows: Floats, out: Floats) -> None:
        if not self.values.shape[1]:  # the library takes no values of 0 numbers
            return
        if self.tri.ndim == 2:
            _native.interpolate2(self.tri._locator, rows, self.values, int(self._method == _NATURAL), out, None)
        else:
            _native.interpolate(self.tri._locator, rows, self.values, self._method, self.tri.npoints, out,
                                self.threads, None)

    def _shaped(self, out: Floats, inside: NDArray[np.bool_]) -> NDArray[Any]:
        half = out.shape[1] // 2
        result: NDArray[Any] = out[:, :half] + 1j * out[:, half:] if self.is_complex else out
        if not np.isnan(self.fill_value):
            result[~inside] = self.fill_value
        return result

    def __repr__(self) -> str:
        return f"<brio.{type(self).__name__} of {len(self.values)} points: values of shape {self.values_shape}>"


class LinearNDInterpolator(_Interpolator):
    """Linear interpolation in the triangles or tetrahedra of scattered points.

    Parameters
    ----------
    points : array_like, shape (n, 2) or (n, 3); a tuple of arrays of coordinates; or a Delaunay
    values : array_like, shape (n, ...)
        Real or complex.
    fill_value : number
        For positions outside of the hull.
    rescale : bool
        Scales the points to a unit box first.
    tol : float, optional
        As for Delaunay.find_simplex: positions that are outside of the hull by rounding are inside. With 0 the hull is exact.
    threads : int

    Examples
    --------
    >>> import brio
    >>> height = brio.LinearNDInterpolator([[0, 0], [1, 0], [0, 1], [1, 1]], [0, 1, 1, 2])
    >>> height([[0.25, 0.5], [2, 2]]).tolist()
    [0.75, nan]
    """

    _method = _LINEAR


class NaturalNeighbourInterpolator(_Interpolator):
    """Sibson's interpolation by natural neighbours: smooth except at the points.

    Parameters
    ----------
    points, values, fill_value, rescale, tol, threads
        As for LinearNDInterpolator; a Delaunay must have no weights.

    Examples
    --------
    >>> import brio
    >>> height = brio.NaturalNeighbourInterpolator([[0, 0], [2, 0], [0, 2], [2, 2], [1, 1]], [0, 0, 0, 0, 1])
    >>> round(float(height(1.5, 1)), 6)
    0.5
    """

    _method = _NATURAL

    def __init__(self, points: Any, values: Any, fill_value: complex = np.nan, rescale: bool = False, *,
                 tol: float | None = None, threads: int = 0) -> None:
        if isinstance(points, Delaunay) and points.weights is not None:
            raise ArgumentError("natural neighbours are those of points without weights")
        super().__init__(points, values, fill_value, rescale, tol=tol, threads=threads)


def _in_order(points: Floats, values: NDArray[Any]) -> tuple[Floats, NDArray[Any]]:
    order = np.argsort(points[:, 0], kind="stable")
    return points[order, 0], values[order]


def _linear_on_line(points: Floats, values: NDArray[Any], xi: Floats, fill_value: complex) -> NDArray[Any]:
    places, rows = _in_order(points, values)
    if len(places) < 2:
        raise NoAnswerError("linear interpolation needs two points at least")
    last = np.clip(np.searchsorted(places, xi, side="left"), 1, len(places) - 1)
    begin, end = places[last - 1], places[last]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(end > begin, (xi - begin) / (end - begin), 0.0)
    share = share.reshape(xi.shape + (1,) * (rows.ndim - 1))
    out: NDArray[Any] = np.asarray((1 - share) * rows[last - 1] + share * rows[last])
    out[~((xi >= places[0]) & (xi <= places[-1]))] = fill_value
    return out


def _nearest_on_line(points: Floats, values: NDArray[Any], xi: Floats) -> NDArray[Any]:
    places, rows = _in_order(points, values)
    out: NDArray[Any] = rows[np.searchsorted((places[1:] + places[:-1]) / 2, xi, side="left")]
    return out


def _nearest_values(points: Floats, values: NDArray[Any], xi: Floats, rescale: bool, threads: int) -> NDArray[Any]:
    """The values at the nearest points; NaN at positions that are not finite."""
    if not len(points):
        raise NoAnswerError("there are no points, and so no nearest one")
    rows = xi.reshape(-1, points.shape[1])
    if rescale:
        scale = np.ptp(points, axis=0)
        scale[~(scale > 0)] = 1
        points, rows = points / scale, rows / scale
    space, places = np.zeros((len(points), 3)), np.zeros((len(rows), 3))
    space[:, : points.shape[1]], places[:, : points.shape[1]] = points, rows
    finite = np.isfinite(places).all(axis=1)
    index = np.zeros(len(places), np.int64)
    index[finite] = nearest(space, places[finite], threads, None)
    out: NDArray[Any] = values[index]
    if not finite.all():
        out = out.astype(np.result_type(out.dtype, np.float64))
        out[~finite] = np.nan
    return out.reshape(xi.shape[:-1] + values.shape[1:])


def griddata(points: Any, values: Any, xi: Any, method: str = "linear", fill_value: complex = np.nan, rescale: bool = False, *,
             tol: float | None = None, threads: int = 0, fallback: str | None = None) -> NDArray[Any]:
    """Interpolates values at scattered points of one, two or three coordinates, at other positions, as scipy's griddata.

    Parameters
    ----------
    points : array_like, shape (n, ndim) or (n,); or a tuple of arrays of coordinates
    values : array_like, shape (n, ...)
        Real or complex.
    xi : array_like, shape (..., ndim); or a tuple of arrays of coordinates, such as those of a grid
    method : "linear", "nearest" or "natural"
        "natural" is not scipy's: Sibson's interpolation, in the plane and in space. scipy's "cubic" is not offered.
    fill_value, rescale, tol
        As for LinearNDInterpolator; with "nearest" all positions have a value.
    threads : int
    fallback : "scipy", optional
        Asks scipy for methods and dimensions that brio does not offer.

    Returns
    -------
    ndarray, of the shape of the positions and then that of a value

    Examples
    --------
    >>> import brio, numpy as np
    >>> x, y = np.mgrid[0:1:3j, 0:1:3j]
    >>> brio.griddata([[0, 0], [1, 0], [0, 1], [1, 1]], [0, 1, 1, 2], (x, y)).tolist()
    [[0.0, 0.5, 1.0], [0.5, 1.0, 1.5], [1.0, 1.5, 2.0]]
    """
    if fallback not in (None, "scipy"):
        raise ArgumentError(f'fallback: None or "scipy", not {fallback!r}')
    rows = coordinates(points)
    if rows.ndim != 2:
        raise ArgumentError(f"points: rows of coordinates are wanted, not an array of shape {rows.shape}")
    ndim = rows.shape[1]
    offered = ("linear", "nearest") if ndim == 1 else ("linear", "nearest", "natural") if ndim in (2, 3) else ()
    if method not in offered:
        if fallback == "scipy":
            import scipy.interpolate

            other: NDArray[Any] = scipy.interpolate.griddata(points, values, xi, method, fill_value, rescale)
            return other
        if method not in ("linear", "nearest", "natural", "cubic"):
            raise ArgumentError(f"method: one of linear, nearest and natural is wanted, not {method!r}")
        raise NotOfferedError(f"interpolation by {method!r} of points of {ndim} coordinates is not offered; "
                              'fallback="scipy" asks scipy for it')
    if ndim > 1 and method != "nearest":
        kind = LinearNDInterpolator if method == "linear" else NaturalNeighbourInterpolator
        return kind(rows, values, fill_value, rescale, tol=tol, threads=threads)(xi)
    if not np.isfinite(rows).all():
        raise ArgumentError("points: there are coordinates that are not finite")
    array = as_values(values, "values")
    if array.ndim == 0 or len(array) != len(rows):
        raise ArgumentError(f"values: one row a point is wanted: {len(rows)}, not an array of shape {array.shape}")
    if ndim > 1:
        places = coordinates(xi, ndim)
        if places.shape[-1] != ndim:
            raise ArgumentError(f"number of dimensions in xi does not match x: {places.shape[-1]} and {ndim}")
        return _nearest_values(rows, array, places, rescale, as_threads(threads))
    line = as_floats(xi[0] if isinstance(xi, tuple) and len(xi) == 1 else xi, "xi")
    return _nearest_on_line(rows, array, line) if method == "nearest" else _linear_on_line(rows, array, line, fill_value)
