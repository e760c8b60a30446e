"""exp(x²) erfc(x) and the article's fit of it."""

import numpy as np

from .. import special
from . import measure
from .style import ARTICLE, FLOAT32_ROUNDING, GUIDE, OURS, panels, rounding_line

X = 10 ** measure.intervals(-3, 5, 240)
STATED = 1.091639525e-6  # the article's greatest relative error
STATED_ABSOLUTE = 9.69658452e-7
FORMULAS = (
    ("article: fit, float32", special.erfcx_golubev, ARTICLE),
    ("ours, float32", special.erfcx, OURS),
)


def answers(formula):
    return measure.ask(formula, special.erfcx, X)


def erfcx():
    """Values: ours as a line, the fit as dots, near 0 and far out."""
    figure, (near, far) = panels(2)
    for axis, x, dots in (
        (near, np.linspace(0, 6, 400), np.linspace(0, 6, 25)),
        (far, np.geomspace(1e-2, 1e4, 400), np.geomspace(1e-2, 1e4, 25)),
    ):
        axis.plot(x, special.erfcx(np.float32(x)), color=OURS, label="ours, float32")
        axis.plot(dots, special.erfcx_golubev(np.float32(dots)), ".", color=ARTICLE,
                  label="article: fit, float32")  # fmt: skip
        axis.set(xlabel="x", xlim=(x[0], x[-1]))
    x = np.geomspace(0.3, 1e4, 100)
    far.plot(x, 1 / (x * np.sqrt(np.pi)), color=GUIDE, linestyle="--", label="1/(x√π)")
    far.set(xscale="log", yscale="log")
    near.set(ylim=(0, 1.02), ylabel="exp(x²) erfc(x)")
    far.legend()
    figure.suptitle("exp(x²) erfc(x)")
    return figure


def erfcx_errors():
    figure, (absolute, relative) = panels(2)
    for label, formula, colour in FORMULAS:
        found = answers(formula)
        for axis, error in ((absolute, found.absolute()), (relative, found.relative())):
            axis.plot(measure.middles(X), measure.greatest(error), color=colour, label=label)
    for axis, stated in ((absolute, STATED_ABSOLUTE), (relative, STATED)):
        axis.axhline(
            stated, color=ARTICLE, linestyle="--", linewidth=1, label="article: stated bound"
        )
        axis.set(xscale="log", yscale="log", xlabel="x", xlim=(X[0, 0], X[-1, -1]))
    rounding_line(relative, FLOAT32_ROUNDING)
    absolute.set(title="absolute", ylabel="greatest error of an interval")
    relative.set(title="relative", ylim=(5e-8, 3e-6))
    figure.legend(*relative.get_legend_handles_labels(), loc="outside right center")
    figure.suptitle("Errors of exp(x²) erfc(x)")
    return figure
