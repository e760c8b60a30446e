"""The medium as a scene and a program see it: parameters, their names, and what is refused."""

import mitsuba as mi
import numpy as np
import pytest
import render_scenes as scenes

scalar_and_llvm = pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"], indirect=True)
scalar_rgb = pytest.mark.parametrize("variant", ["scalar_rgb"], indirect=True)

EXPONENTIAL = {"type": "analytic", "profile": "exponential", "scale_height": 2.0}
LINEAR = {"type": "analytic", "profile": "linear", "gradient": -0.5, "density": 1.0}
CONSTANT = {"type": "analytic"}
BOX = {"bbox_min": [0, 0, 0], "bbox_max": [1, 1, 1]}
SPHERE = {"bsphere_center": [0, 0, 0], "bsphere_radius": 2.0}


def grid(values=(0.2, 0.8)):
    array = np.array(values, dtype=np.float32).reshape(2, 1, 1)
    return {"type": "gridvolume", "grid": mi.VolumeGrid(array), "raw": True}


# ---- Parameters


@scalar_and_llvm
@pytest.mark.parametrize(
    ("medium", "names"),
    [
        (CONSTANT, []),
        (LINEAR, ["up", "base_height", "gradient", "density"]),
        (EXPONENTIAL, ["up", "base_height", "scale_height"]),
    ],
    ids=["constant", "linear", "exponential"],
)
def test_traverse_shows_every_parameter_as_differentiable(variant, medium, names):
    """Constants, so their values are UniformSpectrum objects, as in stock media."""
    params = mi.traverse(mi.load_dict(medium | {"phase": scenes.PHASE}))
    spectra = ["sigma_t.value.value", "albedo.value.value"]
    assert set(params.keys()) == {*names, "max_density", "scale", *spectra, "phase_function.g"}
    for name in (*names, "scale", *spectra):
        assert params.flags(name) == mi.ParamFlags.Differentiable, name


@scalar_and_llvm
def test_a_box_is_exposed_and_can_be_moved(variant):
    medium = mi.load_dict(EXPONENTIAL | BOX)
    params = mi.traverse(medium)
    assert "max_density" not in params
    params["bbox_max"] = [1, 1, 4]
    params.update()
    assert "bbox_max = [1, 1, 4]," in str(medium)


@scalar_and_llvm
def test_a_sphere_is_exposed_and_can_be_moved(variant):
    medium = mi.load_dict(EXPONENTIAL | SPHERE)
    params = mi.traverse(medium)
    ray = mi.Ray3f([0, 0, 0], [0, 0, 1])
    assert medium.intersect_aabb(ray)[2] == 2
    params["bsphere_center"] = [0, 0, 1]
    params["bsphere_radius"] = 4.0
    params.update()
    assert medium.intersect_aabb(ray)[2] == 5
    assert "bsphere_center = [0, 0, 1]," in str(medium)
    assert "bsphere_radius = 4," in str(medium)


@scalar_and_llvm
def test_max_density_limits_the_bound_of_a_box(variant):
    """A density of e in the corner of the box; `max_density` matters only below it."""
    box = {"bbox_min": [0, 0, -2], "bbox_max": [1, 1, 1]}
    at = mi.MediumInteraction3f()

    def bound(**options):
        return np.array(mi.load_dict(EXPONENTIAL | box | options).get_majorant(at)).flat[0]

    assert bound() == pytest.approx(np.e, rel=1e-6)
    assert bound(max_density=5.0) == pytest.approx(np.e, rel=1e-6)
    assert bound(max_density=0.5) == 0.5
    assert "max_density" in mi.traverse(mi.load_dict(EXPONENTIAL | box | {"max_density": 5.0}))


@scalar_rgb
def test_scalar_variants_check_what_is_changed(variant):
    params = mi.traverse(mi.load_dict(EXPONENTIAL))
    params["scale"] = -1.0
    with pytest.raises(RuntimeError, match="scale must be finite and >= 0, got -1"):
        params.update()


@scalar_and_llvm
def test_both_parametrisations_are_exposed_under_their_names(variant):
    params = mi.traverse(mi.load_dict(CONSTANT | {"sigma_a": 0.1, "sigma_s": 0.3}))
    assert {"sigma_a.value.value", "sigma_s.value.value"} <= set(params.keys())


@scalar_and_llvm
def test_to_string_prints_physical_values(variant):
    medium = EXPONENTIAL | BOX | {"base_height": 1.5, "sigma_t": 0.25, "albedo": 0.5, "scale": 3.0}
    text = str(mi.load_dict(medium))
    for name, value in (("scale_height", "2"), ("base_height", "1.5"), ("scale", "3")):
        assert f"{name} = {value}," in text
    for part in ('profile = "exponential"', "bbox_max = [1, 1, 1]", "0.25", "0.5"):
        assert part in text


@scalar_rgb
def test_defaults(variant):
    params = mi.traverse(mi.load_dict(CONSTANT))
    values = {"sigma_t.value.value": 1.0, "albedo.value.value": 0.75, "scale": 1.0}
    assert {name: params[name] for name in values} == values


def render(medium):
    scene = scenes.ball(medium, pixel_format="rgb", size=24)
    scene["integrator"] = {"type": "analyticvolpath", "max_depth": 6}
    return np.array(mi.render(mi.load_dict(scene), spp=8, seed=1))


@scalar_and_llvm
@pytest.mark.parametrize("integrator", ["analyticvolpath", "volpath"])
def test_changed_parameters_make_the_medium_that_a_scene_would_state(variant, integrator):
    """The bound that stock integrators track against is updated too: bit for bit the same."""
    stated = {"sigma_t": 2.5, "albedo": 0.25, "scale": 2.0, "scale_height": 0.5}
    stated |= {"base_height": 0.75, "up": [0.6, 0.0, 0.8]}
    box = {"bbox_min": [-1, -1, -1], "bbox_max": [1, 1, 1]}

    def scene(**options):
        fog = EXPONENTIAL | box | {"sigma_t": 1.0, "albedo": 0.5, "phase": scenes.PHASE} | options
        dictionary = scenes.ball(fog, pixel_format="rgb", size=24)
        return mi.load_dict(dictionary | {"integrator": {"type": integrator, "max_depth": 6}})

    expected = np.array(mi.render(scene(**stated), spp=4, seed=1))
    changed = scene()
    before = np.array(mi.render(changed, spp=4, seed=1))
    params = mi.traverse(changed)
    prefix = scenes.medium_prefix(params)
    for name, value in stated.items():
        key = prefix + (f"{name}.value.value" if name in ("sigma_t", "albedo") else name)
        params[key] = value
    params.update()
    after = np.array(mi.render(changed, spp=4, seed=1))
    assert not np.allclose(before, expected)
    np.testing.assert_array_equal(after, expected)


@scalar_rgb
def test_changed_parameters_are_checked(variant):
    """Where values are at hand: scalar variants. JIT variants would have to read them back."""
    params = mi.traverse(mi.load_dict(EXPONENTIAL))
    params["scale_height"] = -3.0
    with pytest.raises(RuntimeError, match=r"scale_height must be .*> 0, got -3"):
        params.update()


@scalar_and_llvm
def test_parts_and_albedo_are_the_same_medium(variant):
    """Powers of two, so that sums and ratios are exact: bit for bit the same image."""
    parts = render(scenes.constant_fog() | {"sigma_t": 2.0, "albedo": 0.75})
    fog = {k: v for k, v in scenes.constant_fog().items() if k not in ("sigma_t", "albedo")}
    np.testing.assert_array_equal(render(fog | {"sigma_a": 0.5, "sigma_s": 1.5}), parts)


@scalar_and_llvm
def test_albedo_may_be_a_grid(variant):
    """Of one value everywhere it changes nothing; of two it does."""
    fog = scenes.constant_fog()
    to_world = mi.ScalarTransform4f().scale(2).translate(-0.5)
    same = grid((0.8, 0.8)) | {"to_world": to_world}
    np.testing.assert_allclose(render(fog | {"albedo": same}), render(fog), rtol=1e-4)
    varied = render(fog | {"albedo": grid((0.0, 1.0)) | {"to_world": to_world}})
    assert not np.allclose(varied, render(fog), rtol=0.05)


@scalar_rgb
def test_integers_are_numbers(variant):
    params = mi.traverse(mi.load_dict(EXPONENTIAL | {"scale_height": 3, "scale": 2}))
    assert params["scale_height"] == 3
    assert params["scale"] == 2


# ---- Bad input

NAN, INF = float("nan"), float("inf")
REFUSED = {
    "scale height 0": (EXPONENTIAL | {"scale_height": 0.0}, r"scale_height must be .*> 0, got 0"),
    "scale height < 0": (EXPONENTIAL | {"scale_height": -3.0}, r"scale_height .*> 0, got -3"),
    "scale height NaN": (EXPONENTIAL | {"scale_height": NAN}, r"scale_height .*finite.*got NaN"),
    "scale height inf": (EXPONENTIAL | {"scale_height": INF}, r"scale_height .*finite.*got inf"),
    "base height NaN": (EXPONENTIAL | {"base_height": NAN}, r"base_height .*finite.*got NaN"),
    "gradient inf": (LINEAR | {"gradient": INF}, r"gradient .*finite.*got inf"),
    "density NaN": (LINEAR | {"density": NAN}, r"density .*finite.*got NaN"),
    "up not unit": (EXPONENTIAL | {"up": [0, 0, 2]}, r"up must be a unit vector.*got .*2"),
    "up zero": (EXPONENTIAL | {"up": [0, 0, 0]}, r"up must be a unit vector.*got .*0"),
    "up NaN": (LINEAR | {"up": [0, 0, NAN]}, r"up must be .*got .*NaN"),
    "sigma_t < 0": (CONSTANT | {"sigma_t": -0.5}, r"sigma_t must be finite and >= 0, got -0\.5"),
    "sigma_t NaN": (CONSTANT | {"sigma_t": NAN}, r"sigma_t must be finite and >= 0, got (-?)nan"),
    "sigma_t inf": (CONSTANT | {"sigma_t": INF}, r"sigma_t must be finite and >= 0, got inf"),
    "sigma_t rgb < 0": (
        CONSTANT | {"sigma_t": {"type": "rgb", "value": [1.0, -0.25, 1.0]}},
        r"sigma_t must be finite and >= 0, got -0\.25",
    ),
    "sigma_t spectrum < 0": (
        CONSTANT | {"sigma_t": {"type": "spectrum", "value": [(400, 0.5), (700, -0.25)]}},
        r"sigma_t must be finite and >= 0, got -0\.25",
    ),
    "sigma_a < 0": (
        CONSTANT | {"sigma_a": -0.5, "sigma_s": 1.0},
        r"sigma_a must be finite and >= 0, got -0\.5",
    ),
    "albedo > 1": (CONSTANT | {"albedo": 1.5}, r"albedo must be between 0 and 1, got 1\.5"),
    "albedo < 0": (CONSTANT | {"albedo": -0.5}, r"albedo must be between 0 and 1, got -0\.5"),
    "albedo rgb > 1": (
        CONSTANT | {"albedo": {"type": "rgb", "value": [0.5, 0.5, 1.25]}},
        r"albedo must be between 0 and 1, got 1\.25",
    ),
    "scale < 0": (CONSTANT | {"scale": -1.0}, r"scale must be finite and >= 0, got -1"),
    "max_density 0": (
        CONSTANT | {"max_density": 0.0},
        r"max_density must be finite and > 0, got 0",
    ),
    "sphere without radius": (
        CONSTANT | {"bsphere_center": [0, 0, 0]},
        r'"bsphere_radius" is missing',
    ),
    "sphere without centre": (CONSTANT | {"bsphere_radius": 1.0}, r'"bsphere_center" is missing'),
    "sphere of radius 0": (
        CONSTANT | SPHERE | {"bsphere_radius": 0.0},
        r"bsphere_radius must be finite and > 0, got 0",
    ),
    "sphere NaN": (
        CONSTANT | SPHERE | {"bsphere_center": [0, NAN, 0]},
        r"bsphere_center must be finite, got ",
    ),
    "box and sphere": (
        CONSTANT | BOX | SPHERE,
        r"bbox_min and bsphere_radius exclude each other",
    ),
    "box without a bound": (
        EXPONENTIAL | {"bbox_min": [0, 0, -9999], "bbox_max": [1, 1, 1]},
        r"density has no bound in the box: max_density is needed",
    ),
    "unknown profile": (
        CONSTANT | {"profile": "cubic"},
        r"profile.*cubic.*constant.*linear.*exponential|profile.*constant.*exponential.*cubic",
    ),
    "parameter of another profile": (
        EXPONENTIAL | {"gradient": 1.0},
        r'profile "exponential" has no parameter "gradient"; it has .*scale_height',
    ),
    "parameter of constant": (
        CONSTANT | {"scale_height": 1.0},
        r'profile "constant" has no parameter "scale_height"; it has none',
    ),
    "misspelt parameter": (CONSTANT | {"sigmat": 1.0}, r"sigmat"),
    "missing parameter": (
        CONSTANT | {"profile": "exponential"},
        r'profile "exponential" needs the parameter "scale_height"',
    ),
    "both parametrisations": (
        CONSTANT | {"sigma_t": 1.0, "sigma_a": 0.5, "sigma_s": 0.5},
        r'"sigma_t" and "sigma_a" exclude each other',
    ),
    "albedo beside parts": (
        CONSTANT | {"albedo": 0.5, "sigma_a": 0.5, "sigma_s": 0.5},
        r'"albedo" and "sigma_a" exclude each other',
    ),
    "sigma_a alone": (CONSTANT | {"sigma_a": 0.5}, r'"sigma_s" is missing'),
    "sigma_s alone": (CONSTANT | {"sigma_s": 0.5}, r'"sigma_a" is missing'),
    "box of one corner": (CONSTANT | {"bbox_min": [0, 0, 0]}, r'"bbox_max" is missing'),
    "box of the other corner": (CONSTANT | {"bbox_max": [0, 0, 0]}, r'"bbox_min" is missing'),
    "box in the wrong order": (
        CONSTANT | {"bbox_min": [0, 2, 0], "bbox_max": [1, 1, 1]},
        r"bbox_min must be less than bbox_max in every coordinate, got \[0, 2, 0\] and \[1, 1, 1\]",
    ),
    "box NaN": (
        CONSTANT | {"bbox_min": [0, NAN, 0], "bbox_max": [1, 1, 1]},
        r"bbox_min and bbox_max must be finite, got ",
    ),
    "sigma_t a grid": (CONSTANT | {"sigma_t": grid}, r"sigma_t must be constant in space"),
    "microflake phase": (
        CONSTANT | {"phase": {"type": "sggx", "S": {"type": "gridvolume", "grid": "sggx"}}},
        r"phase function must not depend on the direction of travel",
    ),
}


@scalar_and_llvm
@pytest.mark.parametrize("case", REFUSED)
def test_bad_input_is_refused_and_leaves_nothing(variant, case):
    """The message names parameter, value and range; the next valid medium loads."""
    medium, message = REFUSED[case]
    medium = {key: value() if callable(value) else value for key, value in medium.items()}
    if "phase" in medium:
        ones = np.ones((2, 2, 2, 6), dtype=np.float32)
        medium["phase"]["S"] = {"type": "gridvolume", "grid": mi.VolumeGrid(ones)}
    with pytest.raises(RuntimeError, match=message):
        mi.load_dict(medium)
    assert "AnalyticMedium" in str(mi.load_dict(EXPONENTIAL | BOX))
