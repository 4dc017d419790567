"""How much memory a call will take, before the work."""

from typing import Any

from . import _calls, _native
from ._arrays import Floats
from ._calls import UNLIMITED, Limits, Progress
from .errors import OutOfMemoryError

Task = tuple[int, int, int, int]  # a method's number, and whether polygons, whether simplified, in how many pieces
TRIANGULATION: Task = (-1, 0, 0, 0)


def estimate(points: Floats, weights: Floats | None, task: Task, threads: int, progress: bool | Progress | None,
             limits: Limits = UNLIMITED, cell: Floats | None = None, unused: tuple[int, ...] = (0, 0, 0)) -> int:
    """Estimates the bytes that a task holds at its peak, with its result and without the points."""

    def call(p: Floats, w: Floats | None, threads: int, report: Any) -> Any:
        return _native.estimate(p, w, task, cell, unused, threads, report)

    need: int = _calls.of_points(call, points, weights, threads, progress, limits)
    return need


def require_memory(points: Floats, weights: Floats | None, task: Task, threads: int, limits: Limits,
                   cell: Floats | None = None, unused: tuple[int, ...] = (0, 0, 0)) -> None:
    """Refuses work that is estimated over its limit, unless the large arrays are in files."""
    scratch, most = limits
    if most is None or scratch is not None:
        return
    need = estimate(points, weights, task, threads, None, limits, cell, unused)
    if need > most:
        raise OutOfMemoryError(f"about {need / 2**20:.1f} MiB needed, over the limit of {most / 2**20:.1f} MiB (max_memory)")
