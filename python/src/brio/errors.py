"""Exceptions: one for each status of the library, with the sentence that explains the failure."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _native


class Error(Exception):
    """What the library refuses or fails to do.

    Attributes
    ----------
    status : int
        The number of ``brio_status``; 0 where the Python package itself refused.
    sentence : str
        What is wrong, and where.
    indices : ndarray of int64
        The points, or other rows of the input, that are to blame; empty where that is not known.
    reason : str
        What it is about, for programs, such as "no_inside" or "open_mesh": a name of ``brio_reason`` of brio/context.h. ""
        where the class says it all.
    """

    status = 0

    def __init__(self, sentence: str, indices: Any = (), reason: str = "") -> None:
        super().__init__(sentence)
        self.sentence = sentence
        self.reason = reason
        self.indices: NDArray[np.int64] = np.asarray(indices, dtype=np.int64)

    def __str__(self) -> str:
        return self.sentence

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.sentence, self.indices, self.reason)


class ArgumentError(Error, ValueError):
    """An argument outside of its documented range."""

    status = 10


class NotOfferedError(ArgumentError, NotImplementedError):
    """Something of scipy's that brio does not offer. ``fallback="scipy"`` asks scipy for it."""

    status = 0


class NotFiniteError(Error, ValueError):
    """NaN or an infinity among coordinates or weights; ``indices`` has all such points."""

    status = 11


class NoAnswerError(Error, RuntimeError):
    """The input has no answer of the kind asked for."""

    status = 20


class CheckError(Error):
    """A check found the object wrong."""

    status = 21


class OutOfMemoryError(Error, MemoryError):
    """The system or a limit refused memory."""

    status = 30


class TooLargeError(Error, OverflowError):
    """More objects than indices can name."""

    status = 31


class CancelledError(Error):
    """The progress function asked to stop."""

    status = 32


class OpenError(Error, OSError):
    """A file is missing or unreadable."""

    status = 40


class FormatError(Error, ValueError):
    """A file is malformed, truncated, or of an unknown format."""

    status = 41


class WriteError(Error, OSError):
    """A file could not be written; nothing half-written is left behind."""

    status = 42


class InternalError(Error, RuntimeError):
    """A fault of the library."""

    status = 90


_BY_STATUS: dict[int, type[Error]] = {
    kind.status: kind
    for kind in (ArgumentError, NotFiniteError, NoAnswerError, CheckError, OutOfMemoryError, TooLargeError,
                 CancelledError, OpenError, FormatError, WriteError, InternalError)
}


def _make_error(status: int, sentence: str, points: Any = (), reason: str = "") -> Error:
    """Makes the exception of a failure; called by the module of C."""
    return _BY_STATUS.get(status, InternalError)(sentence, points, reason)


_native.set_make_error(_make_error)

__all__ = ["ArgumentError", "CancelledError", "CheckError", "Error", "FormatError", "InternalError", "NoAnswerError",
           "NotFiniteError", "NotOfferedError", "OpenError", "OutOfMemoryError", "TooLargeError", "WriteError"]
