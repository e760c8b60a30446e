"""Errors of float32 arithmetic.

Arguments are rounded to float32 first, and the truth is our float64 function at the rounded ones:
what remains is the error of a formula and of its arithmetic. It scatters from one argument to the
next, so curves show the greatest error of each interval of arguments.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

SAMPLES = 64  # arguments in each interval


class Answers(NamedTuple):
    """Results of a formula in float32, and the true ones, both as float64."""

    found: np.ndarray
    exact: np.ndarray

    def absolute(self) -> np.ndarray:
        return np.abs(self.found - self.exact)

    def relative(self) -> np.ndarray:
        return self.absolute() / np.abs(self.exact)

    def signed(self) -> np.ndarray:
        """Relative, positive where the formula's result is too large."""
        return self.found / self.exact - 1


def ask(formula: Callable, truth: Callable, *arguments) -> Answers:
    """`formula` in float32 beside `truth` in float64."""
    rounded = [np.float32(a) for a in np.broadcast_arrays(*arguments)]
    return Answers(
        formula(*rounded).astype(np.float64),
        truth(*(a.astype(np.float64) for a in rounded)),
    )


def intervals(first: float, last: float, n: int) -> np.ndarray:
    """`n` equal intervals from `first` to `last`, as rows of arguments, ends included."""
    ends = np.linspace(first, last, n + 1)
    return np.linspace(ends[:-1], ends[1:], SAMPLES, axis=1)


def middles(rows: np.ndarray) -> np.ndarray:
    """Where to plot intervals."""
    return rows.mean(axis=1)


def greatest(errors: np.ndarray) -> np.ndarray:
    """Greatest error of each interval; NaN, a gap in a curve, where all results are exact."""
    worst = errors.max(axis=1)
    return np.where(worst > 0, worst, np.nan)
