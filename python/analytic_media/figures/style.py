"""The look that all figures share."""

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

DPI = 110
STYLE = {
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 10.5,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "legend.frameon": False,
    "lines.linewidth": 1.3,
}
OURS, ARTICLE, GUIDE = "#c8102e", "#1f4e9c", "#666666"
FLOAT32_ROUNDING = 2.0**-24  # relative, half a unit in the last place of 1


def panels(columns, height=3.9, width=4.6, **options):
    """A figure with axes side by side; a list of axes even if there is one."""
    figure = Figure(figsize=(width * columns + 0.9, height), layout="constrained")
    axes = figure.subplots(1, columns, squeeze=False, **options)
    return figure, list(axes.flat)


def shades(n):
    """Colours for `n` ordered curves, dark to light, none too pale for a white page."""
    return matplotlib.colormaps["viridis"](np.linspace(0, 0.9, n))


def plain_numbers(axis):
    """Tick labels 1, 10, 100 on a logarithmic axis that spans few decades."""
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def rounding_line(axis, level):
    """Where float32 cannot do better: `level` is what `FLOAT32_ROUNDING` is on the axis."""
    axis.axhline(level, color=GUIDE, linestyle=":", label="rounding to\nfloat32, 6e-8")
