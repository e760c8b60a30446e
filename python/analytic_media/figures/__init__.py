"""Figures of the article "Sampling Analytic Participating Media", drawn from this library.

Each is a function without arguments that returns a matplotlib figure; its name is that of the file.
`docs/figures.md` shows them all.
"""

from collections.abc import Iterable, Iterator
from pathlib import Path

import matplotlib

from . import bessel, chapman, erfcx, lower
from .style import DPI, STYLE

FIGURES = {
    draw.__name__: draw
    for draw in (
        chapman.chapman,
        chapman.chapman_absolute_error,
        chapman.chapman_relative_error,
        chapman.chapman_digits,
        chapman.chapman_schueler,
        chapman.chapman_kocifaj,
        lower.chapman_lower_hemisphere,
        bessel.bessel_k1,
        erfcx.erfcx,
        erfcx.erfcx_errors,
    )
}


class UnknownFigure(ValueError):
    """A name that is not in `FIGURES`."""


def draw(names: Iterable[str], folder: str | Path) -> Iterator[Path]:
    """Write figures to `folder` as PNG, and yield each path once it is there. No names: all."""
    names = tuple(dict.fromkeys(names)) or tuple(FIGURES)
    unknown = [name for name in names if name not in FIGURES]
    if unknown:
        raise UnknownFigure(f"unknown figure {', '.join(unknown)}; known: {', '.join(FIGURES)}")
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for name in names:
        path = folder / f"{name}.png"
        with matplotlib.rc_context(STYLE):
            FIGURES[name]().savefig(path, dpi=DPI)
        yield path
