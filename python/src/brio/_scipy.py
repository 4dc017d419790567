"""What scipy takes and brio does not: other dimensions, Qhull's options, sites that are farthest."""

from typing import Any

import numpy as np

from ._arrays import as_floats
from .errors import ArgumentError, NotOfferedError

# Options of Qhull that ask for what brio does anyway, or for a representation that it does not have.
_HARMLESS = {"Qbb", "Qc", "Qz", "Q12", "Qt", "Qx", "Qs", "Pp"}


def qhull_words(options: str | bytes | None) -> list[str]:
    """Returns the options of Qhull one by one."""
    text = options.decode(errors="replace") if isinstance(options, bytes) else str(options or "")
    return text.split()


def why_not(points: Any, furthest_site: bool, qhull_options: str | bytes | None) -> str | None:
    """Returns a sentence that says what is not offered, or None."""
    other = [option for option in qhull_words(qhull_options) if option not in _HARMLESS]
    if other:
        return f"Qhull's option {other[0]} is not offered: brio does not use Qhull"
    if furthest_site:
        return "the triangulation of farthest sites is not offered"
    shape = np.shape(points) if isinstance(points, np.ndarray) else as_floats(points, "points").shape
    if len(shape) == 2 and shape[1] not in (2, 3):
        return f"points of {shape[1]} coordinates are not offered: only 2 and 3"
    return None


def other_class(name: str, points: Any, fallback: str | None, options: dict[str, Any],
                arguments: tuple[Any, ...] | None = None) -> Any:
    """Returns scipy's object if brio does not offer what is asked for and `fallback` is "scipy"; None if brio does.

    It is made of `arguments`, or else of the points.
    """
    if fallback not in (None, "scipy"):
        raise ArgumentError(f'fallback: None or "scipy", not {fallback!r}')
    reason = why_not(points, options.get("furthest_site", False), options.get("qhull_options"))
    if reason is None:
        return None
    if fallback is None:
        raise NotOfferedError(f'{reason}; fallback="scipy" asks scipy for it')
    import scipy.spatial

    return getattr(scipy.spatial, name)(*((points,) if arguments is None else arguments), **options)
