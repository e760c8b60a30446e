"""The report's plots, each returned as PNG bytes."""

import io

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from .methods import EXACT, TRACKED

DPI = 110
BLOCK = 8  # pixels along a side over which maps of bias are averaged
STYLE = {
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.alpha": 0.25,
    "legend.frameon": False,
}
STRATEGY_COLOURS = {
    None: "#c8102e",
    "single": "#f4a261",
    "average": "#b5651d",
    "tracking": "#d16ba5",
}
MARKERS = {"analyticvolpath": "o", "volpath": "s", "volpathmis": "^"}


def png(figure):
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=DPI, bbox_inches="tight")
    plt.close(figure)
    return buffer.getvalue()


def exposure(image):
    """Factor that brings the 99th percentile of the reference to 0.9."""
    return 0.9 / max(float(np.percentile(image, 99)), 1e-12)


def picture(image, factor, zoom=1):
    """Linear RGB or luminance as an sRGB PNG, each pixel repeated `zoom` times along both axes."""
    linear = np.clip(np.nan_to_num(image * factor), 0, 1)
    linear = np.broadcast_to(linear, (*linear.shape[:2], 3))
    srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    pixels = np.round(255 * srgb).astype(np.uint8)
    buffer = io.BytesIO()
    plt.imsave(buffer, pixels.repeat(zoom, axis=0).repeat(zoom, axis=1), format="png")
    return buffer.getvalue()


def block_average(values, block=BLOCK):
    """Mean over blocks of pixels; an incomplete last row or column is left out."""
    block = max(1, min(block, *values.shape))
    rows, columns = values.shape[0] // block, values.shape[1] // block
    cut = values[: rows * block, : columns * block]
    return cut.reshape(rows, block, columns, block).mean(axis=(1, 3))


def maps(titled, limit, label, columns=3):
    """Signed maps side by side with one colour bar. `titled`: list of (title, values)."""
    rows = -(-len(titled) // columns)
    height, width = titled[0][1].shape
    size = (3.9 * columns + 0.9, rows * (3.9 * height / width + 0.45))
    figure, axes = plt.subplots(rows, columns, figsize=size, squeeze=False, layout="constrained")
    for axis in axes.flat:
        axis.axis("off")
    for axis, (title, values) in zip(axes.flat, titled, strict=False):
        shown = axis.imshow(values, cmap="RdBu_r", vmin=-limit, vmax=limit, interpolation="nearest")
        axis.set_title(title, fontsize=9.5)
    figure.colorbar(shown, ax=axes, label=label, shrink=0.9, pad=0.01, extend="both")
    return png(figure)


def difference_maps(methods, images, exact):
    """Accumulated image less the exact reference, mean of the channels, for every method."""
    titled = [
        (methods[key]["label"], (image - exact.image).mean(axis=-1))
        for key, image in images.items()
    ]
    spread = max(np.percentile(np.abs(values), 95) for _, values in titled)
    return maps(titled, max(float(spread), 1e-12), "radiance: image − exact reference")


def bias_maps(references):
    """References of the grids less the exact one, in percent, averaged over blocks of pixels.

    A title states what the noise of the two references leaves in a block (one standard deviation).
    """
    exact = references[EXACT]
    brightness = float(exact.image.mean())
    exact_blocks = block_average(exact.image.mean(axis=-1))
    titled = []
    for medium, reference in references.items():
        if medium == EXACT:
            continue
        blocks = block_average(reference.image.mean(axis=-1))
        noise = np.sqrt(reference.noise_variance + exact.noise_variance) / BLOCK
        title = f"{medium}³ grid (noise of a block: ±{100 * noise / brightness:.2g} %)"
        titled.append((title, 100 * (blocks / np.maximum(exact_blocks, 1e-12) - 1)))
    spread = max(np.percentile(np.abs(values), 99) for _, values in titled)
    columns = min(len(titled), 3)
    return maps(titled, max(float(spread), 1e-6), "percent of the exact radiance", columns)


def colours(methods):
    """Ours in red, our other strategies in lighter hues, delta tracking of the exact medium in
    black, a hue per grid."""
    media = sorted({m["medium"] for m in methods.values() if isinstance(m["medium"], int)})
    hues = plt.get_cmap("viridis")(np.linspace(0.15, 0.75, max(len(media), 1)))

    def colour(method):
        if method["medium"] == EXACT:
            return STRATEGY_COLOURS[method["strategy"]]
        if method["medium"] == TRACKED:
            return "#222222"
        return hues[media.index(method["medium"])]

    return {key: colour(method) for key, method in methods.items()}


def convergence(methods, against="mse"):
    """MSE over samples and over CPU time; faint: the warm-up ladder, full: accumulated rounds."""
    colour = colours(methods)
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(1, 2, figsize=(11.5, 4.6), sharey=True, layout="constrained")
        for key, method in methods.items():
            look = {
                "color": colour[key],
                "marker": MARKERS[method["integrator"]],
                "markersize": 5,
                "linestyle": "--" if method["integrator"] == "volpathmis" else "-",
            }
            for axis, x in zip(axes, ("spp", "cpu_seconds"), strict=True):
                for part, alpha in (("ladder", 0.45), ("accumulated", 1.0)):
                    points = [(r[x], r[against]) for r in method[part] if r[against] > 0]
                    label = method["label"] if part == "accumulated" else None
                    axis.loglog(*np.array(points or [(np.nan,) * 2]).T, **look, alpha=alpha,
                                label=label)  # fmt: skip
        for axis in axes:
            axis.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            axis.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
            axis.xaxis.set_minor_formatter(NullFormatter())
        axes[0].set(xlabel="samples per pixel", ylabel="mean squared error")
        axes[1].set(xlabel="process CPU time / s")
        axes[1].legend(fontsize=8.5, loc="lower left")
    return png(figure)


def transmittance(bias):
    """Exact transmittance of the fan, and the relative error of each grid."""
    elevation = bias["elevation_degrees"]
    with plt.rc_context(STYLE):
        figure, (upper, lower) = plt.subplots(
            2, 1, figsize=(8.5, 5.6), sharex=True, layout="constrained"
        )
        upper.plot(elevation, bias["exact"], color="#c8102e", lw=2.5, label="exact")
        hues = plt.get_cmap("viridis")(np.linspace(0.15, 0.75, max(len(bias["grids"]), 1)))
        for (resolution, grid), hue in zip(bias["grids"].items(), hues, strict=True):
            upper.plot(elevation, grid["transmittance"], color=hue, ls="--",
                       label=f"{resolution}³ grid")  # fmt: skip
            lower.plot(elevation, 100 * np.array(grid["relative_bias"]), color=hue,
                       label=f"{resolution}³ grid")  # fmt: skip
        lower.axhline(0, color="#c8102e", lw=1)
        upper.set(ylabel="transmittance to the first surface", ylim=(-0.02, 1.05))
        lower.set(ylabel="error of the grid / %", xlabel="elevation of the camera ray / degrees")
        upper.legend()
        lower.legend()
    return png(figure)
