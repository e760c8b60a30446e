"""Several paths per camera ray (`paths` of analyticvolpath), spread over their first decisions."""

import mitsuba as mi
import numpy as np
import pytest
import render_scenes as scenes
from zscores import assert_agree, render_passes

OURS = {"type": "analyticvolpath", "max_depth": 5}
SPREAD = OURS | {"paths": 4}

scalar_and_llvm = pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"], indirect=True)
scalar_rgb = pytest.mark.parametrize("variant", ["scalar_rgb"], indirect=True)


def colour(red, green, blue):
    return {"type": "rgb", "value": [red, green, blue]}


def sum_of_fogs(**options):
    """Two flights race in it, drawn from one channel."""
    fog = {"sigma_t": colour(0.8, 1.2, 1.7), "albedo": colour(0.95, 0.85, 0.7)}
    return {
        "type": "overlap",
        "fog": scenes.constant_fog(**scenes.EXPONENTIAL | fog),
        "haze": scenes.constant_fog(sigma_t=0.4, albedo=0.9),
    } | options


def twice_through_a_mask():
    """Rays pass a mask before they scatter for the first time, and the fog more than once."""
    mask = {"type": "mask", "opacity": 0.4, "bsdf": scenes.GREY}
    found = scenes.ball(sum_of_fogs(), mask, pixel_format="rgb")
    second = scenes.sphere([0.3, -1.6, 0.2], 0.4, bsdf={"type": "null"}, interior=sum_of_fogs())
    return found | {"second": second}


def space():
    """Collisions are forced, also behind the boundary."""
    found = scenes.ball(sum_of_fogs(), pixel_format="rgb")
    del found["sky"], found["floor"]
    return found


def glass():
    """A lens before the fog: what happens at its two surfaces is not spread."""
    found = scenes.ball(sum_of_fogs(), pixel_format="rgb")
    return found | {"lens": scenes.sphere([0, -1.7, 0.2], 0.5, bsdf={"type": "dielectric"})}


SCENES = {
    "glass": glass,
    "mask": twice_through_a_mask,
    "space": space,
    "valley": lambda: scenes.valley(sum_of_fogs(**scenes.VALLEY_BOX), pixel_format="rgb"),
}


def sides(made, **options):
    """Passes of one path per ray, and of as many paths by four per ray."""
    return [
        render_passes(made, of | options, side, spp)
        for side, (of, spp) in enumerate(((OURS, 8), (SPREAD, 2)))
    ]


@scalar_rgb
@pytest.mark.parametrize("name", SCENES)
def test_means_are_those_of_one_path(variant, name):
    assert_agree(*sides(SCENES[name]()))


@scalar_rgb
@pytest.mark.parametrize("strategy", ["single", "tracking"])
def test_means_are_those_of_one_path_in_other_strategies(variant, strategy):
    assert_agree(*sides(space(), spectral_sampling=strategy))


@pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)
def test_means_are_those_of_one_path_in_loops(variant):
    """One loop is within another there."""
    assert_agree(*sides(space()))


@scalar_and_llvm
def test_alpha_is_that_of_one_path(variant):
    film = {"pixel_format": "rgba", "size": 16}
    made = space() | {"sensor": scenes.camera([0, -3, 0.4], [0, 0, 0], 25, **film)}
    one, four = (of[..., 3].mean(1) for of in sides(made))
    error = np.sqrt((one.var(ddof=1) + four.var(ddof=1)) / len(one))
    assert 0 < four.mean() < 1
    assert abs(one.mean() - four.mean()) < 4 * error


@scalar_and_llvm
def test_paths_have_less_noise_than_as_many_samples(variant):
    """In a ball of fog in space much of the noise is that of where the first flight collides."""
    made = space()
    made["sensor"]["film"].update(width=32, height=32)
    one, four = (of.var(0, ddof=1).mean() for of in sides(made))
    assert four < 0.9 * one


@scalar_rgb
@pytest.mark.parametrize("paths", [-1, 65])
def test_bad_numbers_are_named(variant, paths):
    with pytest.raises(RuntimeError, match=rf"paths must be between 0 \(.*\) and 64, got {paths}"):
        mi.load_dict(OURS | {"paths": paths})


@scalar_rgb
def test_the_number_is_printed(variant):
    assert "paths = 3," in str(mi.load_dict(OURS | {"paths": 3}))


@pytest.mark.parametrize(
    ("variant", "paths"),
    [("scalar_rgb", 4), ("llvm_ad_mono", 4), ("scalar_spectral", 1), ("llvm_ad_spectral", 1)],
    indirect=["variant"],
)
def test_the_automatic_number_is_that_of_the_variant(variant, paths):
    assert f"paths = {paths}," in str(mi.load_dict(OURS | {"paths": 0}))
