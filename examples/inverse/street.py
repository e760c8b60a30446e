"""What fog is in this photograph? Visibility, scale height and colour of a foggy street.

    make street                             # or, after make build:
    .venv/bin/python examples/inverse/street.py [--steps N] [--spp N] [--output FILE]

The photograph is a render of scenes/street.xml by `analyticvolpath`; the street is known, and so is
the light. The search begins with a fog that is shallow, thin and grey.
"""

from pathlib import Path

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

from fit import Colour, Positive, run  # noqa: E402

import analytic_media  # noqa: E402, F401  (the plugins)

SCENE = str(Path(__file__).parents[2] / "scenes" / "street.xml")
MAX_DEPTH = 8
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


if __name__ == "__main__":
    scene = mi.load_file(SCENE, res_x=96, res_y=60, max_depth=MAX_DEPTH)
    run(scene, apply, START, TRUTH, steps=120, spp=64, max_depth=MAX_DEPTH, photograph_spp=4096)
