"""The pictures of planets, of fog layers and of coloured media.

    python docs/images/make_planets.py [--spp 1024] [--variant llvm_ad_rgb] [NAME ...]

writes NAME.png beside this file, for every picture below or for those named. No denoising: the
more samples per pixel, the less noise; 1024 take some 20 minutes of CPU per picture.
"""

import argparse
import gc
from pathlib import Path

import mitsuba as mi
import numpy as np
from make_equal_time import srgb
from PIL import Image as Picture

import analytic_media as am
from analytic_media.compare.figures import exposure

HERE = Path(__file__).parent
SCENES = HERE.parents[1] / "scenes"
WIDTH, HEIGHT = 480, 270
PASS = 64  # samples per pixel of one rendering


def from_file(name, width=WIDTH, height=HEIGHT):
    def load():
        return mi.load_file(str(SCENES / f"{name}.xml"), res_x=width, res_y=height)

    return load


def from_preset(preset, view, **options):
    def load():
        size = {"width": WIDTH if view != "fisheye" else HEIGHT, "height": HEIGHT}
        return mi.load_dict(preset(view, **size, **options))

    return load


# Each picture is a row of (scene, number of its camera, whether that is a fisheye).
PICTURES = {
    "fog_layers": [(from_file("fog_layers"), 0, False)],
    "earth_noon": [(from_file("earth_noon"), 0, False), (from_file("earth_noon"), 1, True)],
    "earth_sunset": [(from_file("earth_sunset"), 0, False), (from_file("earth_sunset"), 1, True)],
    "earth_orbit": [(from_file("earth_orbit"), 0, False)],
    "aerial_perspective": [(from_file("aerial_perspective"), 0, False)],
    "ocean": [(from_file("ocean"), 0, False)],
    "skin": [(from_file("skin", width=240, height=300), 0, False)],
    "sky_patch": [(from_file("sky_patch"), 0, False)],
    "mars_sunset": [
        (from_preset(am.presets.mars, "horizon", dust=0.4, sun_zenith=85, sun_azimuth=0), 0, False)
    ],
    "titan_orbit": [
        (from_preset(am.presets.titan, "orbit", altitude=2e6, fov=60, sun_zenith=75), 0, False)
    ],
}


def render(load, camera, spp):
    """The mean of passes with different seeds: all samples at once would not fit the memory."""
    scene, total = load(), 0.0
    passes = max(1, round(spp / PASS))
    for seed in range(passes):
        image = mi.render(scene, sensor=camera, spp=min(spp, PASS), seed=seed)
        total = total + np.array(image, dtype=np.float64)[..., :3]
    return total / passes


def round_window(image):
    """The circle of a fisheye on white."""
    y, x = (np.indices(image.shape[:2]) + 0.5) / HEIGHT * 2 - 1
    return np.where((x**2 + y**2 < 1)[..., None], image, 1.0)


def draw(name, spp):
    row = [(render(load, camera, spp), fisheye) for load, camera, fisheye in PICTURES[name]]
    factor = exposure(row[0][0])
    panels = [round_window(srgb(factor * i)) if fisheye else srgb(factor * i) for i, fisheye in row]
    picture = np.concatenate(panels, axis=1)
    Picture.fromarray(np.round(255 * picture).astype(np.uint8)).save(
        HERE / f"{name}.png", optimize=True
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(PICTURES)}")
    parser.add_argument("--spp", type=int, default=1024, help="samples per pixel")
    parser.add_argument("--variant", default="llvm_ad_rgb")
    options = parser.parse_args()
    mi.set_variant(options.variant)
    for name in options.names or PICTURES:
        print(name, flush=True)
        draw(name, options.spp)
        gc.collect()  # a living medium would be part of the next kernel


if __name__ == "__main__":
    main()
