"""What fog is in this photograph? Visibility, scale height and colour of a foggy street.

    make street                             # or, after make build:
    .venv/bin/python examples/inverse/street.py [--steps N] [--spp N] [--output FILE]

The photograph is a render of scenes/street.xml by `analyticvolpath`; the street is known, and so is
the light. The search begins with a fog that is shallow, thin and grey.
"""

import argparse
from pathlib import Path

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

from fit import Colour, Positive, fit, plot, report  # noqa: E402

import analytic_media  # noqa: E402, F401  (the plugins)

SCENE = str(Path(__file__).parents[2] / "scenes" / "street.xml")
START = {
    "visibility": Positive(start=400),  # m
    "scale_height": Positive(start=4),  # m
    "albedo": Colour(start=0.6),
}
TRUTH = {"visibility": 110.0, "scale_height": 12.0, "albedo": np.array([0.97, 0.94, 0.88])}


def apply(params, visibility, scale_height, albedo):
    params["fog.visibility.value.value"] = visibility
    params["fog.scale_height"] = scale_height
    params["fog.albedo.value.value"] = albedo


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=120)
    parser.add_argument("--spp", type=int, default=32, help="paths per pixel in each step")
    parser.add_argument("--photograph-spp", type=int, default=4096)
    parser.add_argument("--output", default="street_fit.png")
    options = parser.parse_args()

    scene = mi.load_file(SCENE, res_x=96, res_y=60)
    photograph = mi.render(scene, spp=options.photograph_spp, seed=12345)

    course = fit(scene, apply, photograph, START, options.steps, options.spp, max_depth=8)
    worst = report(course, TRUTH)
    plot(course, TRUTH, options.output)
    raise SystemExit(int(worst > 0.02))


if __name__ == "__main__":
    main()
