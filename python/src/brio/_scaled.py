"""Numbers beyond the range of doubles: mantissas m and exponents e, arrays of one shape, stand for m * 2**e.

Products of coordinates leave that range long before the coordinates do. Scaling by powers of two rounds nothing.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._arrays import Floats

Scaled = tuple[Floats, NDArray[np.int32]]
_OF_ZERO = np.int32(-(2**20))  # the exponent of 0: below all others, also in products of four numbers


def split(values: Any) -> Scaled:
    """Returns numbers as mantissas, whose magnitudes are 0 or at least 1/2 and below 1, and exponents."""
    mantissa, exponent = np.frexp(values)
    return mantissa, np.where(mantissa == 0, _OF_ZERO, exponent)


def shifted(values: Any, exponent: Any) -> Any:
    """Returns values * 2**exponent as doubles: infinite, or 0, where they leave the range."""
    with np.errstate(over="ignore", under="ignore"):
        return np.ldexp(values, exponent)


def difference(a: Floats, b: Floats) -> Scaled:
    """Returns a - b, rounded as doubles are; also where that overflows."""
    with np.errstate(over="ignore"):
        direct = a - b
    over = np.isinf(direct)
    mantissa, exponent = split(np.where(over, a / 2 - b / 2, direct) if over.any() else direct)
    return mantissa, exponent + over


def product(a: Scaled, b: Scaled) -> Scaled:
    mantissa, exponent = split(a[0] * b[0])
    return mantissa, exponent + a[1] + b[1]


def minus(a: Scaled, b: Scaled) -> Scaled:
    top = np.maximum(a[1], b[1])
    mantissa, exponent = split(shifted(a[0], a[1] - top) - shifted(b[0], b[1] - top))
    return mantissa, exponent + top


def cross(a: Scaled, b: Scaled) -> Scaled:
    """Returns the cross products of rows: of 3 numbers rows of 3, of 2 numbers one number each."""

    def term(i: Any, j: Any) -> Scaled:
        return minus(product(_column(a, i), _column(b, j)), product(_column(a, j), _column(b, i)))

    return term(0, 1) if a[0].shape[1] == 2 else term([1, 2, 0], [2, 0, 1])


def _column(rows: Scaled, k: Any) -> Scaled:
    return rows[0][:, k], rows[1][:, k]


def aligned(number: Scaled, axis: int | tuple[int, ...]) -> Scaled:
    """Gives numbers along an axis one exponent, the largest; that axis is left out of the exponents."""
    top = number[1].max(axis=axis, keepdims=True)
    return shifted(number[0], number[1] - top), top.squeeze(axis)


def total(number: Scaled, divisor: int = 1) -> float:
    """Returns the sum of all numbers, divided; it is infinite, or 0, only where it leaves the range itself."""
    mantissa, exponent = aligned((number[0].ravel(), number[1].ravel()), 0)
    return float(shifted(mantissa.sum() / divisor, exponent))


def run_sums(number: Scaled, starts: NDArray[np.int64]) -> Scaled:
    """Returns the sums of runs along the first axis; run k begins at starts[k], and none is empty."""
    sizes = np.diff(starts, append=len(number[0]))
    top = np.maximum.reduceat(number[1], starts, axis=0)
    mantissa, exponent = split(np.add.reduceat(shifted(number[0], number[1] - np.repeat(top, sizes, axis=0)), starts, axis=0))
    return mantissa, exponent + top


def units(rows: Scaled) -> tuple[Floats, Scaled]:
    """Returns vectors of length 1, NaN for rows of zeros, and the lengths."""
    near, top = aligned(rows, 1)
    lengths = np.linalg.norm(near, axis=1)
    with np.errstate(invalid="ignore"):
        directions: Floats = near / lengths[:, None]
    return directions, (lengths, top)
