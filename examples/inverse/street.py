"""What fog is in this photograph? Visibility, scale height and colour of a foggy street.

    python examples/inverse/street.py [--steps N] [--spp N] [--output street_fit.png]

The photograph is a render of scenes/street.xml by `analyticvolpath`; the street is known, and so is
the light. The search begins with a fog that is shallow, thin and grey.
"""

import argparse
from pathlib import Path

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

from fit import Positive, Share, fit, plot, report  # noqa: E402

import analytic_media  # noqa: E402, F401  (the plugins)

SCENE = str(Path(__file__).parents[2] / "scenes" / "street.xml")
START = {
    "fog.visibility.value.value": Positive(start=400),  # m
    "fog.scale_height": Positive(start=4),  # m
    "fog.albedo.value.value": Share(start=0.6),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--spp", type=int, default=16, help="paths per pixel in each step")
    parser.add_argument("--output", default="street_fit.png")
    options = parser.parse_args()

    scene = mi.load_file(SCENE, res_x=96, res_y=60)
    params = mi.traverse(scene)
    truth = {key: np.array(params[key]).squeeze() for key in START}
    photograph = mi.render(scene, spp=1024, seed=12345)

    course = fit(scene, photograph, START, options.steps, options.spp, max_depth=8)
    worst = report(course, truth)
    plot(course, truth, options.output)
    raise SystemExit(worst > 0.02)


if __name__ == "__main__":
    main()
