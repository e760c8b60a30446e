"""The rescaled Chapman function above and below the horizontal."""

import numpy as np

from .. import special
from . import measure
from .chapman import RADIUS, RAYS, SCALE_HEIGHTS, cos_zenith, finish, plot
from .style import FLOAT32_ROUNDING, GUIDE, panels, rounding_line

PLANET_RADIUS = 6550.0
ANGLES = measure.intervals(80, 100, 80)  # degrees
HORIZON = 180 - np.degrees(np.arcsin(PLANET_RADIUS / RADIUS))


def article(z, surface, cos_zenith):
    """The article's `RescaledChapman`, in the arithmetic of its arguments."""
    near = special.chapman_huestis(z, np.abs(cos_zenith)) * np.exp(surface - z)
    descent = np.minimum(cos_zenith, 0)  # upwards the perigee is not asked for
    perigee = z * np.sqrt(1 - descent * descent)
    tangent = special.chapman_horizontal_huestis(perigee) * np.exp(surface - perigee)
    return np.where(cos_zenith < 0, 2 * tangent - near, near)


FORMULAS = {"article: Eq. 46 to 48": article, "ours": special.chapman_rescaled}


def answers(formula, scale_height, degrees=ANGLES):
    """`formula` for a ray from `RADIUS`, in float32, with the truth."""
    z, surface = RADIUS / scale_height, PLANET_RADIUS / scale_height
    return measure.ask(formula, special.chapman_rescaled, z, surface, cos_zenith(degrees))


def curves(formula):
    """For each scale height the greatest relative error of each interval of angles."""
    return {h: measure.greatest(answers(formula, h).relative()) for h in SCALE_HEIGHTS}


def chapman_lower_hemisphere():
    """The function on the left, errors of the article's formulas and of ours on the right."""
    figure, (value, theirs, ours) = panels(3, width=3.8, sharex=True)
    x = measure.middles(ANGLES)
    exact = {h: answers(special.chapman_rescaled, h, x).exact for h in SCALE_HEIGHTS}
    plot(value, x, {h: np.log10(y) for h, y in exact.items()})
    value.axvline(HORIZON, color=GUIDE, linestyle="--", linewidth=1, label="horizon")
    value.set(title="value", ylabel=r"$\log_{10}\,C_r$", xlim=(80, 100))
    ours.sharey(theirs)
    for axis, (name, formula) in zip((theirs, ours), FORMULAS.items(), strict=True):
        plot(axis, x, curves(formula))
        rounding_line(axis, FLOAT32_ROUNDING)
        axis.set(title=name, yscale="log")
    theirs.set_ylabel("|relative error|, greatest within ¼ degree")
    title = f"Rescaled Chapman function, planet of radius {PLANET_RADIUS:g}, {RAYS}"
    return finish(figure, (value, theirs, ours), title)
