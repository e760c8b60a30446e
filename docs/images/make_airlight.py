"""The picture of air-light: four scenes without noise, beside as many by path tracing.

    python docs/images/make_airlight.py [--variant llvm_ad_rgb]

writes airlight.png beside this file: left the integrator airlight with 16 samples per pixel, right
analyticvolpath with 64.
"""

import argparse
from pathlib import Path

import mitsuba as mi
import numpy as np
from make_equal_time import srgb
from PIL import Image as Picture

import analytic_media  # noqa: F401 (the plugins)
from analytic_media.compare.figures import exposure

HERE = Path(__file__).parent
SCENES = HERE.parents[1] / "scenes"
NAMES = ("airlight_bench", "airlight_stage", "airlight_road", "airlight_lighthouse")
METHODS = {"airlight": 16, "analyticvolpath": 64}


def image_of(name, integrator, spp):
    scene = mi.load_file(str(SCENES / f"{name}.xml"), integrator=integrator, spp=spp)
    return np.array(mi.render(scene))[..., :3]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--variant", default="llvm_ad_rgb")
    mi.set_variant(parser.parse_args().variant)

    rows = []
    for name in NAMES:
        images = [image_of(name, integrator, spp) for integrator, spp in METHODS.items()]
        scale = exposure(images[0])
        rows.append(np.hstack([srgb(scale * image) for image in images]))
    pixels = np.round(255 * np.vstack(rows)).astype(np.uint8)
    Picture.fromarray(pixels).save(HERE / "airlight.png", optimize=True)


if __name__ == "__main__":
    main()
