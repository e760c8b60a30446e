"""Derivatives as mappings from names to arrays, from the rows of numbers that the library gives."""

from collections.abc import Sequence

import numpy as np

from . import _native

Parts = Sequence[tuple[str, int]]  # names and sizes of what a row holds, in its order


def parameters(kind: _native.Kind) -> Parts:
    """The parameters of a profile."""
    return [(p.name, p.size) for p in kind.parameters]


def of_ray(last: str) -> Parts:
    """Origin, direction and the last argument of the question."""
    return [("o", 3), ("d", 3), (last, 1)]


def size(parts: Parts) -> int:
    """Numbers in a row."""
    return sum(width for _, width in parts)


def split(rows: np.ndarray, parts: Parts) -> dict[str, np.ndarray]:
    """The derivatives by each part: `rows` has one row of numbers at the end of its shape."""
    named, first = {}, 0
    for name, width in parts:
        own = rows[..., first : first + width]
        named[name] = own if width > 1 else own[..., 0][()]
        first += width
    return named
