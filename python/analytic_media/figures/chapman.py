"""The Chapman function for r = 6600 over the zenith angle, and approximations of it."""

import numpy as np

from .. import special
from . import measure
from .style import FLOAT32_ROUNDING, panels, plain_numbers, rounding_line, shades

RADIUS = 6600.0
SCALE_HEIGHTS = (1, 10, 20, 40, 60, 80, 100)
ANGLES = measure.intervals(0, 90, 180)  # degrees
ZENITH_ANGLE = "zenith angle / degrees"
VALUE = "C(r/H, θ), dimensionless"
RAYS = f"r = {RADIUS:g}, float32"
FORMULAS = {
    "article: Eq. 46": special.chapman_huestis,
    "ours": special.chapman,
}


def cos_zenith(degrees):
    """Exactly 0 at 90 degrees."""
    return np.sin(np.radians(90 - np.asarray(degrees)))


def answers(formula, scale_height, degrees=ANGLES):
    """`formula` for a ray from `RADIUS`, in float32, with the truth."""
    return measure.ask(formula, special.chapman, RADIUS / scale_height, cos_zenith(degrees))


def curves(formula, error):
    """For each scale height the greatest `error` of each interval of angles."""
    return {h: measure.greatest(error(answers(formula, h))) for h in SCALE_HEIGHTS}


def plot(axis, x, by_scale_height, **look):
    """A curve per scale height."""
    for (h, y), colour in zip(by_scale_height.items(), shades(len(by_scale_height)), strict=True):
        axis.plot(x, y, color=colour, label=f"H = {h}", **look)


def finish(figure, axes, title):
    """Title, one legend beside the axes, and the axis of angles."""
    entries = {}
    for axis in axes:
        axis.set_xlabel(ZENITH_ANGLE)
        handles, labels = axis.get_legend_handles_labels()
        entries = dict(zip(labels, handles, strict=True)) | entries
    figure.suptitle(title)
    figure.legend(entries.values(), entries.keys(), loc="outside right center")
    return figure


def chapman():
    """Values: ours as lines, Eq. 46 as dots."""
    figure, axes = panels(2, sharey=True)
    for axis, first, step in zip(axes, (0, 80), (5, 0.5), strict=True):
        lines, dots = np.linspace(first, 90, 400), np.arange(first, 90 + step, step)
        plot(axis, lines, {h: answers(special.chapman, h, lines).found for h in SCALE_HEIGHTS})
        for h in SCALE_HEIGHTS:
            found = answers(special.chapman_huestis, h, dots).found
            label = "Eq. 46" if h == SCALE_HEIGHTS[-1] else None
            axis.plot(dots, found, "k.", markersize=3, clip_on=False, label=label)
        axis.set(yscale="log", xlim=(first, 90))
        plain_numbers(axis.yaxis)
    axes[0].set_ylabel(VALUE)
    return finish(figure, axes, f"Chapman function, {RAYS}; lines: ours, dots: article, Eq. 46")


def compared(error, shown=np.asarray):
    """`shown` errors of Eq. 46 and of ours, in panels with the same axes."""
    figure, axes = panels(2, sharey=True)
    for axis, (name, formula) in zip(axes, FORMULAS.items(), strict=True):
        greatest = curves(formula, error)
        plot(axis, measure.middles(ANGLES), {h: shown(y) for h, y in greatest.items()})
        axis.set(title=name, xlim=(0, 90))
    return figure, axes


def chapman_absolute_error():
    figure, axes = compared(measure.Answers.absolute)
    axes[0].set(yscale="log", ylabel="|error|, greatest within ½ degree")
    return finish(figure, axes, f"Absolute error of the Chapman function, {RAYS}")


def chapman_relative_error():
    figure, axes = compared(measure.Answers.relative)
    for axis in axes:
        rounding_line(axis, FLOAT32_ROUNDING)
    axes[0].set(yscale="log", ylabel="|relative error|, greatest within ½ degree")
    return finish(figure, axes, f"Relative error of the Chapman function, {RAYS}")


def digits(relative):
    """Correct decimal digits."""
    return -np.log10(relative)


def chapman_digits():
    figure, axes = compared(measure.Answers.relative, digits)
    for axis in axes:
        rounding_line(axis, digits(FLOAT32_ROUNDING))
    axes[0].set(ylim=(3.5, 8), ylabel="correct digits, fewest within ½ degree")
    return finish(figure, axes, f"Precision of the Chapman function, {RAYS}")


def percent(formula, degrees):
    """Signed relative errors in percent, for each scale height."""
    return {h: 100 * answers(formula, h, degrees).signed() for h in SCALE_HEIGHTS}


def chapman_schueler():
    """Values near the horizontal, where they differ from the true ones, and relative error."""
    figure, (value, error) = panels(2)
    degrees = np.linspace(80, 90, 401)
    found = {h: answers(special.chapman_schueler, h, degrees) for h in SCALE_HEIGHTS}
    plot(value, degrees, {h: a.exact for h, a in found.items()}, linestyle=":")
    plot(value, degrees, {h: a.found for h, a in found.items()})
    value.set(title="value; dotted: true", ylabel=VALUE, yscale="log", xlim=(80, 90))
    plain_numbers(value.yaxis)
    degrees = np.linspace(0, 90, 721)
    plot(error, degrees, percent(special.chapman_schueler, degrees))
    error.set(title="relative error", ylabel="error / %", xlim=(0, 90))
    return finish(figure, (value, error), f"Schüler's approximation, Eq. 49, {RAYS}")


def chapman_kocifaj():
    figure, (axis,) = panels(1, width=5.6)
    degrees = np.linspace(0, 90, 721)
    plot(axis, degrees, percent(special.chapman_kocifaj, degrees))
    axis.set(xlim=(0, 90), ylabel="relative error / %")
    return finish(figure, (axis,), f"Kocifaj's form (draft, Eq. 45), {RAYS}")
