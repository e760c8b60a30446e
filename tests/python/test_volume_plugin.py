"""The volume: a profile as stock Mitsuba's media and programs look it up."""

import mitsuba as mi
import numpy as np
import pytest

import analytic_media as am

scalar_and_llvm = pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"], indirect=True)

BOX = {"bbox_min": [-2, -2, -2], "bbox_max": [2, 2, 2]}
PROFILES = {
    "constant": ({}, am.Constant()),
    "linear": (
        {"gradient": -0.5, "density": 0.5, "up": [0.6, 0, 0.8]},
        am.Linear(gradient=-0.5, density=0.5, up=(0.6, 0, 0.8)),
    ),
    "exponential": (
        {"scale_height": 1.5, "base_height": 0.5},
        am.Exponential(scale_height=1.5, base_height=0.5),
    ),
}


def volume(profile, **options):
    parameters, _ = PROFILES[profile]
    return {"type": "analyticvolume", "profile": profile} | parameters | BOX | options


def look_up(loaded, points):
    values = []
    for point in points:
        interaction = mi.Interaction3f()
        interaction.p = mi.Point3f(*(float(x) for x in point))
        values.append(np.array(loaded.eval_1(interaction)).item())
    return np.array(values)


@scalar_and_llvm
@pytest.mark.parametrize("profile", PROFILES)
def test_values_are_those_of_the_profile(variant, profile, rng):
    points = rng.uniform(-2, 2, (50, 3)).astype(np.float32).astype(float)
    _, reference = PROFILES[profile]
    got = look_up(mi.load_dict(volume(profile, scale=2.5)), points)
    np.testing.assert_allclose(got, 2.5 * reference.density(points), rtol=2e-6, atol=1e-7)


@scalar_and_llvm
def test_outside_of_the_box_there_is_nothing(variant):
    loaded = mi.load_dict(volume("constant"))
    np.testing.assert_array_equal(
        look_up(loaded, [[0, 0, 1.99], [0, 0, 2.01], [-3, 0, 0]]), [1, 0, 0]
    )
    assert list(loaded.bbox().min) == BOX["bbox_min"]
    assert list(loaded.bbox().max) == BOX["bbox_max"]


@scalar_and_llvm
@pytest.mark.parametrize("profile", PROFILES)
def test_max_is_the_supremum_in_the_box(variant, profile):
    """All three are monotone in height, so it is at a corner."""
    _, reference = PROFILES[profile]
    corners = np.stack(np.meshgrid(*3 * [[-2.0, 2.0]]), -1).reshape(-1, 3)
    expected = 2.5 * reference.density(corners).max()
    assert mi.load_dict(volume(profile, scale=2.5)).max() == pytest.approx(expected, rel=2e-6)


@scalar_and_llvm
def test_changed_parameters_take_effect(variant):
    loaded = mi.load_dict(volume("exponential"))
    params = mi.traverse(loaded)
    assert set(params.keys()) == {"up", "base_height", "scale_height", "scale"}
    params["scale_height"] = 3.0
    params["scale"] = 0.5
    params.update()
    expected = 0.5 * am.Exponential(scale_height=3.0, base_height=0.5).density([0.0, 0.0, 1.0])
    assert look_up(loaded, [[0, 0, 1]]) == pytest.approx(expected, rel=2e-6)
    bottom = 0.5 * np.exp(2.5 / 3.0)
    assert loaded.max() == pytest.approx(bottom, rel=2e-6)


@scalar_and_llvm
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"scale": -1.0}, r"scale must be finite and >= 0, got -1"),
        ({"scale_height": 0.0}, r"scale_height must be .*> 0, got 0"),
        ({"gradient": 1.0}, r'profile "exponential" has no parameter "gradient"'),
        ({"profile": "cubic"}, r"profile.*cubic"),
        ({"bbox_min": None, "bbox_max": None}, r'"bbox_min" is missing'),
        ({"bbox_max": None}, r'"bbox_max" is missing'),
        ({"bbox_min": [3, 0, 0]}, r"bbox_min must be less than bbox_max"),
        ({"to_world": "identity"}, r"to_world is not supported"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_bad_input_is_refused(variant, options, message):
    """The message names parameter, value and range; the next valid volume loads."""
    if "to_world" in options:
        options = {"to_world": mi.ScalarTransform4f()}
    given = volume("exponential") | options
    with pytest.raises(RuntimeError, match=message):
        mi.load_dict({key: value for key, value in given.items() if value is not None})
    mi.load_dict(volume("exponential"))
