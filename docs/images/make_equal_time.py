"""The README's picture: the height fog after equal CPU time, and what is wrong with each image.

    python docs/images/make_equal_time.py [--seconds 8] [--variant llvm_ad_rgb]

writes equal_time.png beside this file. Both methods get the same process CPU time; the converged
image that they are compared with is analyticvolpath's, for eight times as long.
"""

import argparse
import io
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image as Picture

from analytic_media.compare.figures import block_average, exposure
from analytic_media.compare.methods import EXACT
from analytic_media.compare.protocol import Timed
from analytic_media.compare.worker import Job, Worker

HERE = Path(__file__).parent
SCENE = HERE.parents[1] / "scenes" / "height_fog.xml"
GRID = 256
BLOCK = 4  # pixels along a side over which errors are averaged
LIMIT = 1.0  # of the relative error that is shown


def render(variant, seconds):
    """The converged image, ours, and stock volpath's on the grid."""
    with tempfile.TemporaryDirectory() as folder:

        def timed(medium, integrator, seed):
            worker = Timed(
                Worker(Job(str(SCENE), variant, medium, folder, seed)), {"type": integrator}
            )
            worker.climb(seconds / 4)
            return worker

        ours = timed(EXACT, "analyticvolpath", 1)
        converged, image = ours.image(8 * seconds), ours.image(seconds)
        return converged, image, timed(GRID, "volpath", 100_000).image(seconds)


def srgb(linear):
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def draw(converged, images):
    """`images`: title -> Image."""
    factor = exposure(converged.pixels)
    figure, axes = plt.subplots(2, 2, figsize=(8, 5.2), layout="constrained")
    for (title, image), (top, bottom) in zip(images.items(), axes.T, strict=True):
        squared = np.mean((image.pixels - converged.pixels) ** 2, axis=-1)
        brightness = block_average(converged.pixels.mean(axis=-1), BLOCK)
        relative = np.sqrt(block_average(squared, BLOCK)) / brightness
        top.imshow(srgb(factor * image.pixels))
        top.set_title(f"{title}\n{image.cpu_seconds:.1f} s of CPU, {image.spp} spp", fontsize=9)
        shown = bottom.imshow(relative, cmap="magma", vmin=0, vmax=LIMIT)
        bottom.set_title(f"mean squared error {squared.mean():.2e}", fontsize=9)
    for axis in axes.flat:
        axis.set_axis_off()
    bar = figure.colorbar(shown, ax=axes[1], shrink=0.9, format="{x:.0%}", extend="max")
    bar.set_label("relative error (RMS)", fontsize=9)
    bar.ax.tick_params(labelsize=8)
    write(figure, HERE / "equal_time.png")


def write(figure, path):
    """With 5 bits per colour: noise does not compress."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=100)
    picture = Picture.open(buffer).convert("RGB")
    picture.point(lambda value: value & 0xF8 | value >> 5).save(path, optimize=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=8, help="process CPU time of each image")
    parser.add_argument("--variant", default="llvm_ad_rgb")
    options = parser.parse_args()
    converged, ours, stock = render(options.variant, options.seconds)
    draw(
        converged,
        {"analyticvolpath, analytic medium": ours, f"stock volpath, {GRID}³ grid": stock},
    )


if __name__ == "__main__":
    main()
