"""The scenes of coloured media render in rgb and in spectral variants."""

from pathlib import Path

import mitsuba as mi
import numpy as np
import pytest

import analytic_media  # noqa: F401 (the plugins)

SCENES = Path(__file__).parents[2] / "scenes"


def small_picture(name):
    """Of 40 times 30 pixels, as red, green and blue."""
    scene = mi.load_file(str(SCENES / f"{name}.xml"), res_x="40", res_y="30")
    return np.array(mi.render(scene, spp=4, seed=1))[..., :3]


@pytest.mark.parametrize("variant", ["scalar_rgb", "scalar_spectral"], indirect=True)
@pytest.mark.parametrize(
    ("name", "darkest", "brightest"), [("ocean", 0, 2), ("skin", 2, 0), ("sky_patch", 0, 2)]
)
def test_scene_has_its_colour(variant, name, darkest, brightest):
    """Water absorbs red, skin absorbs blue, and air scatters blue: mean colours in that order.

    What is under water in spectral variants is bluer than sRGB can be: its red is below 0.
    """
    image = small_picture(name)
    assert np.isfinite(image).all()
    colour = image.mean(axis=(0, 1))
    assert colour[darkest] < colour[1] < colour[brightest]
    assert colour[1] > 0


def test_sky_patch_is_as_bright_in_rgb_as_in_spectral_variants():
    """One file states the coefficients by wavelength; three channels of them come close."""
    luminances = []
    for variant in ("scalar_rgb", "scalar_spectral"):
        mi.set_variant(variant)
        luminances.append(float(np.mean(small_picture("sky_patch") @ (0.2126, 0.7152, 0.0722))))
    assert luminances[0] == pytest.approx(luminances[1], rel=0.1)
