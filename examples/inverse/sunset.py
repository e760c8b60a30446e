"""How hazy was this sunset? Load and scale height of the aerosol in a planet's atmosphere.

    make sunset                             # or, after make build:
    .venv/bin/python examples/inverse/sunset.py [--steps N] [--spp N] [--output FILE]

The photograph is a render of scenes/earth_sunset.xml by `analyticvolpath`. Air, ozone, the ground
and the sun are known; of the aerosol, its colour. The search begins with four times the load, in a
layer twice as deep.
"""

from pathlib import Path

import mitsuba as mi

mi.set_variant("llvm_ad_rgb")

from fit import Positive, run  # noqa: E402

import analytic_media  # noqa: E402, F401  (the plugins)

SCENE = str(Path(__file__).parents[2] / "scenes" / "earth_sunset.xml")
MAX_DEPTH = 5
GREEN = 0.061  # σ_t of the aerosol on the ground in the scene, 1/km
START = {
    "optical_depth": Positive(start=0.5),  # of the vertical, in green
    "scale_height": Positive(start=4.0),  # km
}
TRUTH = {"optical_depth": 2.0 * GREEN, "scale_height": 2.0}


def apply(params, optical_depth, scale_height):
    params["air.aerosol.scale"] = optical_depth / (GREEN * scale_height)
    params["air.aerosol.scale_height"] = scale_height


if __name__ == "__main__":
    scene = mi.load_file(SCENE, res_x=64, res_y=36, max_depth=MAX_DEPTH)
    run(scene, apply, START, TRUTH, steps=200, spp=32, max_depth=MAX_DEPTH, photograph_spp=16384)
