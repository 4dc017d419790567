"""Calls of the module of C: progress, and the indices of guilty points."""

import os
import sys
from collections.abc import Callable
from types import TracebackType
from typing import Any

import numpy as np

from ._arrays import Floats, as_number, as_path
from .errors import ArgumentError, NotFiniteError

Path = str | os.PathLike[str]
Progress = Callable[[str, float], Any]
Limits = tuple[Path | None, float | None]  # the folder of scratch files, and the most bytes; of one call
UNLIMITED: Limits = (None, None)


def _as_limits(limits: Limits) -> tuple[bytes | None, int]:
    """Limits as the module takes them."""
    scratch, max_memory = limits
    most = 0.0 if max_memory is None else as_number(max_memory, "max_memory")
    if max_memory is not None and not 1 <= most < 2**63:
        raise ArgumentError(f"max_memory: a number of bytes, at least 1, is wanted, not {max_memory!r}")
    return None if scratch is None else as_path(scratch, "scratch", "a folder"), int(most)


class _Line:
    """A line on standard error, where tqdm is not installed."""

    def __call__(self, stage: str, fraction: float) -> None:
        print(f"\r{stage:24s}{100 * fraction:4.0f} %", end="", file=sys.stderr, flush=True)

    def close(self) -> None:
        print(file=sys.stderr)


class _Bar:
    """A bar of tqdm."""

    def __init__(self, tqdm: Any) -> None:
        self.bar = tqdm(total=100, unit="%", leave=False)

    def __call__(self, stage: str, fraction: float) -> None:
        self.bar.set_description(stage, refresh=False)
        self.bar.update(max(0.0, 100 * fraction - self.bar.n))

    def close(self) -> None:
        self.bar.close()


def _bar() -> _Line | _Bar:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return _Line()
    return _Bar(tqdm)


class reporting:
    """Shows a bar during the call if `progress` is True; a function is called as it is. Gives what the module takes."""

    __slots__ = ("progress", "limits", "bar")

    def __init__(self, progress: bool | Progress | None, limits: Limits = UNLIMITED) -> None:
        self.progress = progress
        self.limits = None if limits == UNLIMITED else _as_limits(limits)
        self.bar: _Line | _Bar | None = None

    def __enter__(self) -> Any:
        if self.progress is True:
            self.bar = _bar()
        told = self.bar or self.progress or None
        return told if self.limits is None else (told, *self.limits)

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        if self.bar:
            self.bar.close()


def name_guilty(error: NotFiniteError, points: Floats, weights: Floats | None = None) -> None:
    """Gives an error the indices of all points that are not finite."""
    guilty = ~np.isfinite(points).all(axis=-1)
    if weights is not None:
        guilty |= ~np.isfinite(weights)
    error.indices = np.flatnonzero(guilty)


def of_points(function: Callable[..., Any], points: Floats, weights: Floats | None, threads: int,
              progress: bool | Progress | None, limits: Limits = UNLIMITED) -> Any:
    """Calls function(points, weights, threads, report)."""
    with reporting(progress, limits) as report:
        try:
            return function(points, weights, threads, report)
        except NotFiniteError as error:
            name_guilty(error, points, weights)
            raise
