"""The ways to state a medium in a scene: the same image by each, and errors for all mixtures."""

import gc
from itertools import combinations

import mitsuba as mi
import numpy as np
import pytest
import render_scenes as scenes

from analytic_media import coefficients as c
from analytic_media.compare import media

dr = pytest.importorskip("drjit", reason="Dr.Jit is not installed")

scalar_and_llvm = pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"], indirect=True)
scalar_rgb = pytest.mark.parametrize("variant", ["scalar_rgb"], indirect=True)
spectral = pytest.mark.parametrize("variant", ["scalar_spectral"], indirect=True)
llvm_ad_rgb = pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)
mono = pytest.mark.parametrize("variant", ["llvm_ad_mono"], indirect=True)
every = pytest.mark.parametrize(
    "variant", ["scalar_rgb", "scalar_spectral", "llvm_ad_rgb"], indirect=True
)

SIGMA_T, ALBEDO = 1.2, 0.8
DISTANCE, CONTRAST, ATTENUATION, SECTION = 2.5, 0.02, 0.4, 1e-28

# Each parametrisation, of the extinction `s` and the albedo ALBEDO: numbers or arrays.
STATED = {
    "sigma_t": lambda s: {"sigma_t": s},
    "sigma_a": lambda s: {"sigma_a": s * (1 - ALBEDO), "sigma_s": s * ALBEDO},
    "mean_free_path": lambda s: {"mean_free_path": c.mean_free_path(s)},
    "transmittance": lambda s: {
        "transmittance": c.transmittance(s, DISTANCE),
        "at_distance": DISTANCE,
    },
    "opacity": lambda s: {"opacity": c.opacity(s, DISTANCE), "at_distance": DISTANCE},
    "visibility": lambda s: {"visibility": c.visibility(s)},
    "contrast": lambda s: {"visibility": c.visibility(s, CONTRAST), "contrast": CONTRAST},
    "mass_density": lambda s: {
        "mass_density": c.mass_density(s, ATTENUATION),
        "mass_attenuation": ATTENUATION,
    },
    "number_density": lambda s: {
        "number_density": c.number_density(s, SECTION),
        "cross_section": SECTION,
    },
    "extinction_index": lambda s: {
        "extinction_index": rgb_or_number(c.extinction_index(s * (1 - ALBEDO), wavelengths())),
        "sigma_s": s * ALBEDO,
    },
}


def wavelengths():
    return np.array(c.RGB_WAVELENGTHS)


def rgb_or_number(value):
    return {"type": "rgb", "value": value.tolist()} if np.ndim(value) else float(value)


def fog(name, sigma_t=SIGMA_T):
    """A medium of that extinction, stated the way `name` says."""
    stated = STATED[name](sigma_t)
    stated = {k: v if isinstance(v, dict) else rgb_or_number(v) for k, v in stated.items()}
    albedo = {} if "sigma_s" in stated else {"albedo": ALBEDO}
    return {"type": "analytic", "phase": scenes.PHASE} | stated | albedo


def coefficients(medium, wavelengths=()):
    """(sigma_t, albedo) at a point, per channel."""
    at = mi.MediumInteraction3f()
    if mi.is_spectral:
        at.wavelengths = wavelengths
    scattering, _, extinction = (
        np.array(x).ravel() for x in medium.get_scattering_coefficients(at)
    )
    return extinction, scattering / extinction


def key_of(params, name):
    """The key of a quantity of the scene's medium."""
    [key] = [key for key, _ in params if key.endswith(f".{name}.value.value")]
    return key


def render(medium, seed=1):
    scene = scenes.ball(medium, pixel_format="rgb", size=24)
    scene["integrator"] = {"type": "analyticvolpath", "max_depth": 6}
    return np.array(mi.render(mi.load_dict(scene), spp=8, seed=seed))


# ---- The same medium


@scalar_and_llvm
@pytest.mark.parametrize("name", STATED)
def test_every_parametrisation_renders_the_same_image(variant, name):
    """Coefficients may differ by a rounding, for which hardly a path of a seed goes another way."""
    gc.collect()
    expected = render(fog("sigma_t") | ({"has_spectral_extinction": True} if varies(name) else {}))
    found = render(fog(name))
    same = np.isclose(found, expected, rtol=1e-5, atol=1e-8).all(axis=-1)
    assert same.mean() > 0.99
    assert found.mean() == pytest.approx(expected.mean(), rel=1e-3)


def varies(name):
    """Whether the extinction varies with wavelength for Mitsuba."""
    return name == "extinction_index"


# Single precision holds no transmittance close to 0 or 1, and no opacity close to 1.
TELLING = {"transmittance": [1.2], "opacity": [1e-6, 1e-2, 1.2]}


@every
@pytest.mark.parametrize(
    ("name", "sigma_t"),
    [(name, s) for name in STATED for s in TELLING.get(name, [1e-6, 1e-2, 1.2, 30.0])],
)
def test_numbers_give_the_coefficients(variant, name, sigma_t):
    if name == "extinction_index" and mi.is_spectral:
        return  # of no number: test_extinction_index_is_that_of_the_wavelength
    found, albedo = coefficients(mi.load_dict(fog(name, sigma_t)), [400, 500, 600, 700])
    np.testing.assert_allclose(found, sigma_t, rtol=2e-6)
    np.testing.assert_allclose(albedo, ALBEDO, rtol=1e-6)


@scalar_and_llvm
@pytest.mark.parametrize("name", STATED)
def test_colours_give_the_coefficients(variant, name):
    sigma_t = np.array([0.3, 0.7, 1.4])
    medium = mi.load_dict(fog(name, sigma_t))
    found, albedo = coefficients(medium)
    np.testing.assert_allclose(found, sigma_t, rtol=2e-6)
    np.testing.assert_allclose(albedo, ALBEDO, rtol=1e-6)
    assert medium.has_spectral_extinction()


@scalar_rgb
def test_round_trips_are_exact_in_double_precision(variant):
    """What scenes state, by the functions of the library: to 1e-12 of (sigma_t, albedo)."""
    sigma_t = np.array([1e-3, 0.1, 1.2, 2.0])
    for name, state in STATED.items():
        stated = state(sigma_t[1:]) if name == "extinction_index" else state(sigma_t)
        stated = {k: np.array(v["value"]) if isinstance(v, dict) else v for k, v in stated.items()}
        names = tuple(stated)
        if "sigma_s" in stated:
            absorption = next(f for n, f in media.ABSORPTION.items() if n[0] == names[0])
            absorbed = absorption(stated[names[0]])
            found = c.sigma_t_from_parts(absorbed, stated["sigma_s"])
            albedo = c.albedo_from_parts(absorbed, stated["sigma_s"])
            np.testing.assert_allclose(albedo, ALBEDO, rtol=1e-12)
        else:
            extinction = next(f for n, f in media.EXTINCTION.items() if n[0] == names[0])
            found = extinction(*stated.values())
        expected = sigma_t[1:] if name == "extinction_index" else sigma_t
        np.testing.assert_allclose(found, expected, rtol=1e-12, err_msg=name)


@scalar_rgb
def test_scale_multiplies_every_parametrisation(variant):
    for name in STATED:
        found, albedo = coefficients(mi.load_dict(fog(name) | {"scale": 3.0}))
        np.testing.assert_allclose(found, 3 * SIGMA_T, rtol=2e-6, err_msg=name)
        np.testing.assert_allclose(albedo, ALBEDO, rtol=1e-6, err_msg=name)


# ---- Spectra


@spectral
def test_spectra_give_the_coefficients_at_their_wavelengths(variant):
    nm = [360.0, 460.0, 560.0, 660.0, 760.0, 860.0]
    values = [30.0, 10.0, 5.0, 4.0, 2.0, 8.0]
    spectrum = {"type": "spectrum", "value": list(zip(nm, values, strict=True))}
    found, _ = coefficients(mi.load_dict({"type": "analytic", "mean_free_path": spectrum}), nm[:4])
    np.testing.assert_allclose(found, 1 / np.array(values[:4]), rtol=1e-6)


@spectral
def test_extinction_index_is_that_of_the_wavelength(variant):
    nm = np.array([400.0, 500.0, 600.0, 700.0])
    medium = mi.load_dict({"type": "analytic", "extinction_index": 1e-7, "sigma_s": 0.5})
    found, albedo = coefficients(medium, nm)
    np.testing.assert_allclose(found, 0.5 + 4e9 * np.pi * 1e-7 / nm, rtol=1e-6)
    np.testing.assert_allclose(albedo, 0.5 / found, rtol=1e-6)
    assert medium.has_spectral_extinction()


@mono
def test_light_without_colour_is_green(variant):
    medium = mi.load_dict({"type": "analytic", "extinction_index": 1e-7, "sigma_s": 0.5})
    found, _ = coefficients(medium)
    np.testing.assert_allclose(found, 0.5 + 4e9 * np.pi * 1e-7 / 550, rtol=1e-6)
    found, _ = coefficients(mi.load_dict(RAYLEIGH))
    expected = c.STANDARD_NUMBER_DENSITY * c.rayleigh_air(550)
    np.testing.assert_allclose(found, expected, rtol=1e-6)
    assert not medium.has_spectral_extinction()


@spectral
@pytest.mark.parametrize("factor", [1.0, 50.0, 1e25, 1e-28])
def test_colours_of_any_size_become_spectra(variant, factor):
    """Mitsuba's spectra for colours end at 1, and fade out near 0: ours are multiples of those."""
    nm = [450.0, 520.0, 550.0, 620.0]
    colour = {"type": "rgb", "value": [0.2 * factor, 0.6 * factor, 0.9 * factor]}
    medium = {"type": "analytic", "number_density": colour, "cross_section": 1 / factor}
    found, _ = coefficients(mi.load_dict(medium), nm)
    assert 0.8 < found[0] < 1.0
    assert 0.4 < found[1] < 0.8
    assert 0.1 < found[3] < 0.4


@spectral
@pytest.mark.parametrize("name", ["mean_free_path", "visibility"])
def test_spectra_of_divisors_have_to_cover_all_wavelengths(variant, name):
    """Outside of its wavelengths, a spectrum is 0."""
    spectrum = {"type": "spectrum", "value": [(400, 10.0), (700, 20.0)]}
    with pytest.raises(RuntimeError, match=f"{name} must be > 0 .*got 0.*400 to 700 nm"):
        mi.load_dict({"type": "analytic", name: spectrum})
    mi.load_dict({"type": "analytic", "sigma_t": spectrum})


# ---- Changes


@scalar_and_llvm
@pytest.mark.parametrize("name", STATED)
def test_parameters_are_exposed_under_their_names(variant, name):
    medium = fog(name)
    params = mi.traverse(mi.load_dict(medium))
    for key in set(medium) - {"type", "phase"}:
        assert params.flags(f"{key}.value.value") == mi.ParamFlags.Differentiable
        assert f"  {key} = " in str(mi.load_dict(medium))
    others = {key.split(".")[0] for key, _ in params} & media.COEFFICIENTS
    assert others - {"contrast", "scale"} == set(medium) - {"type", "phase", "contrast"}


@scalar_and_llvm
@pytest.mark.parametrize("name", ["mean_free_path", "opacity", "visibility", "number_density"])
def test_parameters_can_be_changed(variant, name):
    medium = mi.load_dict(fog(name))
    params = mi.traverse(medium)
    for key, value in STATED[name](0.4).items():
        params[f"{key}.value.value"] = float(value)
    params.update()
    np.testing.assert_allclose(coefficients(medium)[0], 0.4, rtol=2e-6)


@scalar_rgb
def test_scalar_variants_check_what_is_changed(variant):
    params = mi.traverse(mi.load_dict(fog("mean_free_path")))
    params["mean_free_path.value.value"] = -2.0
    with pytest.raises(RuntimeError, match=r"mean_free_path must be > 0 .*got -2"):
        params.update()


@llvm_ad_rgb
@pytest.mark.parametrize("name", ["mean_free_path", "opacity", "visibility"])
def test_changed_parameters_compile_nothing(variant, name):
    gc.collect()
    scene = scenes.ball(fog(name), pixel_format="rgb", size=8)
    scene = mi.load_dict(scene | {"integrator": {"type": "analyticvolpath", "max_depth": 3}})
    params = mi.traverse(scene)
    key = key_of(params, name)
    mi.render(scene, spp=1)
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.kernel_history_clear()
        params[key] = params[key] * 0.9
        params.update()
        dr.eval(mi.render(scene, spp=1, seed=1))
        kernels = [k for k in dr.kernel_history() if k["type"] == dr.KernelType.JIT]
    # Those of the update are new the first time.
    assert max(kernels, key=lambda k: k["size"])["cache_hit"]


DERIVATIVES = {
    "mean_free_path": ("mean_free_path", lambda s: -(s**2)),
    "opacity": ("opacity", lambda s: np.exp(s * DISTANCE) / DISTANCE),
    "transmittance": ("transmittance", lambda s: -np.exp(s * DISTANCE) / DISTANCE),
    "visibility": ("visibility", lambda s: -s / c.visibility(s)),
}


@llvm_ad_rgb
@pytest.mark.parametrize("name", DERIVATIVES)
def test_gradients_flow_to_the_parameters(variant, name):
    medium = mi.load_dict(fog(name))
    params = mi.traverse(medium)
    parameter, derivative = DERIVATIVES[name]
    key = f"{parameter}.value.value"
    dr.enable_grad(params[key])
    params.update()
    sigma_t = medium.get_scattering_coefficients(mi.MediumInteraction3f())[2]
    dr.backward(sigma_t[0])
    np.testing.assert_allclose(np.array(dr.grad(params[key])), derivative(SIGMA_T), rtol=1e-5)


@llvm_ad_rgb
def test_gradient_of_an_image_flows_to_the_mean_free_path(variant):
    """Through prbvolpath: by the chain rule that of sigma_t, with the same random numbers."""
    gradients = {}
    for name in ("sigma_t", "mean_free_path"):
        gc.collect()
        box = {"bbox_min": [-1, -1, -1], "bbox_max": [1, 1, 1]}
        scene = scenes.ball(fog(name) | box, size=16)
        scene = mi.load_dict(scene | {"integrator": {"type": "prbvolpath", "max_depth": 4}})
        params = mi.traverse(scene)
        key = key_of(params, name)
        dr.enable_grad(params[key])
        params.update()
        dr.backward(dr.mean(mi.render(scene, params, spp=16, seed=3), axis=None))
        gradients[name] = np.array(dr.grad(params[key])).item()
    assert gradients["sigma_t"] != 0
    expected = -(SIGMA_T**2) * gradients["sigma_t"]
    assert gradients["mean_free_path"] == pytest.approx(expected, rel=1e-3)


# ---- What does not go together


def fitting(a, b):
    """Whether some parametrisation has both."""
    beside_albedo = [{*names, "albedo"} for names in media.EXTINCTION]
    beside_sigma_s = [{*names, "sigma_s"} for names in media.ABSORPTION]
    return any({a, b} <= names for names in beside_albedo + beside_sigma_s)


PARAMETERS = sorted(media.COEFFICIENTS - {"scale"})


@scalar_rgb
@pytest.mark.parametrize(
    ("a", "b"), [pair for pair in combinations(PARAMETERS, 2) if not fitting(*pair)]
)
def test_parameters_of_two_parametrisations_exclude_each_other(variant, a, b):
    with pytest.raises(RuntimeError, match=rf'"({a}|{b})" and "({a}|{b})" exclude each other'):
        mi.load_dict({"type": "analytic", a: 0.5, b: 0.5})


@scalar_rgb
@pytest.mark.parametrize(
    ("a", "b"), [pair for pair in combinations(STATED, 2) if pair != ("visibility", "contrast")]
)
def test_two_whole_parametrisations_exclude_each_other(variant, a, b):
    with pytest.raises(RuntimeError, match=r'"\w+" and "\w+" exclude each other: give one of'):
        mi.load_dict(fog(a) | fog(b))


@scalar_rgb
@pytest.mark.parametrize(
    ("stated", "missing"),
    [
        ({"sigma_a": 1.0}, "sigma_s"),
        ({"sigma_s": 1.0}, "sigma_a"),
        ({"transmittance": 0.5}, "at_distance"),
        ({"transmittance": 0.5, "albedo": 0.5}, "at_distance"),
        ({"opacity": 0.5}, "at_distance"),
        ({"at_distance": 1.0}, "transmittance"),
        ({"contrast": 0.5}, "visibility"),
        ({"mass_density": 1.0}, "mass_attenuation"),
        ({"mass_attenuation": 1.0}, "mass_density"),
        ({"number_density": 1.0}, "cross_section"),
        ({"cross_section": 1.0}, "number_density"),
        ({"extinction_index": 1.0}, "sigma_s"),
    ],
)
def test_what_is_missing_is_named(variant, stated, missing):
    with pytest.raises(RuntimeError, match=f'"{missing}" is missing'):
        mi.load_dict({"type": "analytic"} | stated)


AT = {"at_distance": 1.0}


@every
@pytest.mark.parametrize(
    ("stated", "message"),
    [
        ({"mean_free_path": 0.0}, r"mean_free_path must be > 0 and may be infinite, got 0"),
        ({"mean_free_path": -3}, r"mean_free_path must be > 0 and may be infinite, got -3"),
        ({"transmittance": 0.0} | AT, r"transmittance must be in \(0, 1\], got 0"),
        ({"transmittance": 1.5} | AT, r"transmittance must be in \(0, 1\], got 1\.5"),
        ({"opacity": 1.0} | AT, r"opacity must be in \[0, 1\), got 1"),
        ({"opacity": 0.5, "at_distance": 0.0}, r"at_distance must be finite and > 0, got 0"),
        ({"visibility": -1.0}, r"visibility must be > 0 and may be infinite, got -1"),
        ({"visibility": 1.0, "contrast": 1.0}, r"contrast must be in \(0, 1\), got 1"),
        (
            {"mass_density": -1.0, "mass_attenuation": 1.0},
            r"mass_density must be finite and >= 0, got -1",
        ),
        (
            {"number_density": 1.0, "cross_section": -1.0},
            r"cross_section must be finite and >= 0, got -1",
        ),
        (
            {"extinction_index": -1.0, "sigma_s": 1.0},
            r"extinction_index must be finite and >= 0, got -1",
        ),
        (
            {"mean_free_path": {"type": "rgb", "value": [1.0, -2.0, 1.0]}},
            r"mean_free_path must be > 0 and may be infinite, got -2",
        ),
        (
            {"visibility": {"type": "spectrum", "value": [(360, 1.0), (600, -2.0), (830, 1.0)]}},
            r"visibility must be > 0 and may be infinite, got -2",
        ),
    ],
)
def test_values_out_of_range_are_named(variant, stated, message):
    with pytest.raises(RuntimeError, match=message):
        mi.load_dict({"type": "analytic"} | stated)


@scalar_rgb
def test_integers_are_numbers(variant):
    found, _ = coefficients(mi.load_dict({"type": "analytic", "mean_free_path": 4}))
    np.testing.assert_array_equal(found, 0.25)


@scalar_rgb
def test_a_grid_is_no_coefficient(variant):
    grid = {"type": "gridvolume", "grid": mi.VolumeGrid(np.ones((2, 2, 2, 1), np.float32))}
    with pytest.raises(RuntimeError, match="mean_free_path must be constant in space"):
        mi.load_dict({"type": "analytic", "mean_free_path": grid | {"raw": True}})


# ---- The twin for comparisons


@scalar_rgb
@pytest.mark.parametrize("name", STATED)
def test_compare_reads_every_parametrisation(variant, name):
    props = mi.Properties("analytic")
    for key, value in (fog(name) | {"scale": 2.0}).items():
        if isinstance(value, dict) and value["type"] == "rgb":
            props[key] = mi.ScalarColor3f(value["value"])
        elif isinstance(value, float):
            props[key] = value
    sigma_t, albedo = media.read_coefficients(props)
    np.testing.assert_allclose(sigma_t, 2 * SIGMA_T, rtol=1e-6)
    np.testing.assert_allclose(albedo, ALBEDO, rtol=1e-6)


# ---- Rayleigh

RAYLEIGH = {"type": "analytic", "sigma_t": {"type": "rayleighspectrum"}, "albedo": 1.0}


@every
def test_rayleighspectrum_has_the_numbers_of_the_library(variant):
    nm = [400.0, 500.0, 600.0, 800.0] if mi.is_spectral else list(c.RGB_WAVELENGTHS)
    medium = mi.load_dict(RAYLEIGH)
    found, albedo = coefficients(medium, nm)
    expected = c.sigma_t_from_number(c.STANDARD_NUMBER_DENSITY, c.rayleigh_air(nm))
    np.testing.assert_allclose(found, expected, rtol=1e-6)
    np.testing.assert_array_equal(albedo, 1)
    assert medium.has_spectral_extinction()
    assert "number_density = 2.5469e+25" in str(medium)


@every
def test_rayleighspectrum_loads_from_xml(variant):
    medium = mi.load_string(
        """<medium version="3.0.0" type="analytic">
               <spectrum type="rayleighspectrum" name="sigma_t"/>
               <float name="albedo" value="1"/>
               <float name="scale" value="1000"/>
               <phase type="rayleigh"/>
           </medium>"""
    )
    found, _ = coefficients(medium, [550.0] * 4)
    expected = 1000 * c.STANDARD_NUMBER_DENSITY * c.rayleigh_air(550)
    assert found[1] == pytest.approx(expected, rel=1e-6)


@scalar_and_llvm
def test_rayleighspectrum_can_be_changed(variant):
    medium = mi.load_dict(
        RAYLEIGH | {"sigma_t": {"type": "rayleighspectrum", "number_density": 1e25}}
    )
    params = mi.traverse(medium)
    assert params.flags("sigma_t.value.number_density") == mi.ParamFlags.Differentiable
    params["sigma_t.value.number_density"] = 3e25
    params.update()
    found, _ = coefficients(medium)
    np.testing.assert_allclose(found, 3e25 * c.rayleigh_air(c.RGB_WAVELENGTHS), rtol=1e-6)


@scalar_rgb
def test_rayleighspectrum_checks_its_density(variant):
    bad = {"type": "rayleighspectrum", "number_density": -1.0}
    with pytest.raises(RuntimeError, match="number_density must be finite and >= 0, got -1"):
        mi.load_dict(bad)
    params = mi.traverse(mi.load_dict({"type": "rayleighspectrum"}))
    params["number_density"] = -2.0
    with pytest.raises(RuntimeError, match="number_density must be finite and >= 0, got -2"):
        params.update()
