"""The Chapman function of horizontal rays, z exp(z) K1(z)."""

from .. import special
from . import measure
from .style import ARTICLE, FLOAT32_ROUNDING, GUIDE, OURS, panels, rounding_line

Z = 10 ** measure.intervals(-1, 4, 200)


def curve(formula):
    """Greatest relative error of each interval of `Z`."""
    return measure.greatest(measure.ask(formula, special.bessel_k1_scaled, Z).relative())


def bessel_k1():
    """Eq. 47 in both arithmetics, so that the error of the series stands alone; and ours."""
    figure, (axis,) = panels(1, width=6.2)
    z = measure.middles(Z)
    series = special.chapman_horizontal_huestis(z) / special.bessel_k1_scaled(z) - 1
    axis.plot(z, abs(series), color=GUIDE, linestyle="--", label="Eq. 47, float64")
    axis.plot(z, curve(special.chapman_horizontal_huestis), color=ARTICLE,
              label="article: Eq. 47, float32")  # fmt: skip
    axis.plot(z, curve(special.bessel_k1_scaled), color=OURS, label="ours, float32")
    rounding_line(axis, FLOAT32_ROUNDING)
    axis.set(xscale="log", yscale="log", xlim=(z[0], z[-1]), ylim=(1e-9, 10))
    axis.set(xlabel="z = r/H", ylabel="|relative error|, greatest of an interval")
    axis.set_title("Horizontal rays: z exp(z) K₁(z)")
    axis.legend()
    return figure
