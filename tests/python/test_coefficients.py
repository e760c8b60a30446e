"""The ways to state a medium, through NumPy and recorded. How accurate: tests/coefficients.rs."""

import inspect
import re

import numpy as np
import pytest

import analytic_media as am
from analytic_media import coefficients as c
from analytic_media.presets import rayleigh

FUNCTIONS = [
    name
    for name, function in inspect.getmembers(c, inspect.isfunction)
    if function.__module__ == c.__name__
]

# A range for each argument, log-uniform.
RANGES = {
    "albedo": (1e-3, 0.99),
    "contrast": (1e-3, 0.9),
    "transmittance": (1e-3, 0.99),
    "opacity": (1e-12, 0.99),
    "refraction": (1e-6, 0.5),
    "refractive_index": (1.1, 3),
    "refractivity": (1e-6, 1e-2),
    "wavelength": (300, 900),
    "king_factor": (1, 1.2),
    "number_density": (1e24, 1e26),
    "cross_section": (1e-31, 1e-20),
    "molecular_mass": (1e-26, 1e-25),
    "polarizability_volume": (1e-30, 1e-29),
    "polarizability": (1e-6, 1),
}


def arguments(function, rng, n=1000):
    names = inspect.signature(getattr(c, function)).parameters
    ranges = [RANGES.get(name, (1e-3, 10)) for name in names]
    return [np.exp(rng.uniform(np.log(low), np.log(high), n)) for low, high in ranges]


# Polarisabilities in C m²/V are below what single precision holds.
@pytest.mark.parametrize("function", [f for f in FUNCTIONS if f != "polarizability"])
def test_single_precision_and_nodes_agree_with_double(function, rng, llvm):
    """The arguments are rounded first; 1 - albedo and the like have lost digits then."""
    rounded = [a.astype(np.float32) for a in arguments(function, rng)]
    exact = getattr(c, function)(*(a.astype(float) for a in rounded))
    single = getattr(c, function)(*rounded)
    assert (exact.dtype, single.dtype) == (np.float64, np.float32)
    np.testing.assert_allclose(single, exact, rtol=1e-5)
    recorded = am.jit.special(function, *(llvm.Float(a) for a in rounded))
    np.testing.assert_allclose(np.array(recorded), exact, rtol=1e-5)


PAIRS = [
    ("sigma_t_from_mean_free_path", "mean_free_path"),
    ("sigma_t_from_transmittance", "transmittance"),
    ("sigma_t_from_opacity", "opacity"),
    ("sigma_t_from_visibility", "visibility"),
    ("sigma_a_from_extinction_index", "extinction_index"),
    ("sigma_t_from_mass", "mass_density"),
    ("sigma_t_from_number", "number_density"),
    ("polarizability_volume", "polarizability"),
    ("refraction_from_density", "density_from_refraction"),
    ("refraction_from_refractivity", "refractivity_from_refraction"),
    ("refraction_from_index", "refractive_index"),
    ("gas_refractivity", "gas_density"),
]


@pytest.mark.parametrize(("there", "back"), PAIRS)
def test_pairs_undo_each_other(there, back, rng):
    first, *rest = arguments(there, rng)
    found = getattr(c, back)(getattr(c, there)(first, *rest), *rest)
    np.testing.assert_allclose(found, first, rtol=1e-12)


def test_parts_and_albedo_undo_each_other(rng):
    sigma_a, sigma_s = arguments("sigma_t_from_parts", rng)
    sigma_t, albedo = c.sigma_t_from_parts(sigma_a, sigma_s), c.albedo_from_parts(sigma_a, sigma_s)
    np.testing.assert_allclose(c.sigma_s_from_albedo(sigma_t, albedo), sigma_s, rtol=1e-12)
    absorbed = c.sigma_a_from_albedo(sigma_t, albedo)
    assert np.all(np.abs(absorbed - sigma_a) <= 1e-12 * sigma_t)
    assert c.albedo_from_parts(0, 0) == 0


def test_small_opacities_keep_their_digits():
    assert c.sigma_t_from_opacity(1e-20, 2) == pytest.approx(0.5e-20, rel=1e-15)
    assert c.opacity(1e-20, 2) == pytest.approx(2e-20, rel=1e-15)


def test_mixture_is_a_sum_of_refractions():
    """Half ethanol, half water, by volume: between 1.333 and 1.361."""
    mixture = c.refraction_from_index([1.333, 1.361]) @ [0.5, 0.5]
    assert c.refractive_index(mixture) == pytest.approx(1.347, rel=1e-4)


def test_visibility_of_the_preset_has_the_default_contrast():
    fog = am.height_fog(visibility=200, scale_height=15)
    assert fog["sigma_t"] == c.sigma_t_from_visibility(200)
    assert c.visibility(fog["sigma_t"]) == pytest.approx(200, rel=1e-15)


# ---- Rayleigh

WAVELENGTHS = np.arange(360.0, 831.0, 1.0)


def test_rayleigh_functions_are_the_published_formulas():
    """Written out once more, in double precision: Bodhaine et al. (1999), Eq. 29; Sneep and Ubachs
    (2005), Eq. 1."""
    x = (WAVELENGTHS / 1000) ** 2
    fit = (1.0455996 - 341.29061 / x - 0.90230850 * x) / (1 + 0.0027059889 / x - 85.968563 * x)
    np.testing.assert_allclose(rayleigh.air(WAVELENGTHS), 1e-32 * fit, rtol=1e-14)

    square = (1 + 3e-4) ** 2
    lorentz = (square - 1) / (square + 2)
    expected = 24 * np.pi**3 / (WAVELENGTHS * 1e-9) ** 4 * (lorentz / 2.546899e25) ** 2 * 1.05
    found = c.rayleigh_cross_section(WAVELENGTHS, 3e-4, king_factor=1.05)
    np.testing.assert_allclose(found, expected, rtol=1e-12)


# Cross-sections at 400, 550 and 700 nm, by the formula in NumPy.
BEFORE = {
    "nitrogen": [1.713875904245326e-30, 4.630819585723268e-31, 1.739150474165733e-31],
    "carbon_dioxide": [4.352304518818234e-30, 1.1637162782583083e-30, 4.350774729100936e-31],
}


@pytest.mark.parametrize("gas", BEFORE)
def test_gases_of_the_presets_have_not_changed(gas):
    found = getattr(rayleigh, gas)(np.array([400.0, 550.0, 700.0]))
    np.testing.assert_allclose(found, BEFORE[gas], rtol=1e-12)


# ---- Bad input

NAN, INF = np.nan, np.inf


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: c.sigma_t_from_parts(-1, 1), "sigma_a must be finite and >= 0, got -1.0"),
        (lambda: c.sigma_a_from_albedo(1, 1.5), "albedo must be in [0, 1], got 1.5"),
        (
            lambda: c.sigma_t_from_mean_free_path(0),
            "mean_free_path must be > 0 and may be infinite",
        ),
        (lambda: c.sigma_t_from_transmittance(0, 1), "transmittance must be in (0, 1], got 0.0"),
        (lambda: c.sigma_t_from_transmittance(0.5, 0), "at_distance must be finite and > 0, got 0"),
        (
            lambda: c.sigma_t_from_opacity([0.5, 1], 1),
            "opacity must be in [0, 1), got 1.0 at item 1",
        ),
        (
            lambda: c.sigma_t_from_visibility(NAN),
            "visibility must be > 0 and may be infinite, got NaN",
        ),
        (lambda: c.sigma_t_from_visibility(9, 1), "contrast must be in (0, 1), got 1.0"),
        (lambda: c.extinction_index(1, INF), "wavelength must be finite and > 0, got inf"),
        (lambda: c.mass_density(1, 0), "mass_attenuation must be finite and > 0, got 0.0"),
        (lambda: c.refractive_index(1), "refraction must be in [0, 1), got 1.0"),
        (lambda: c.refraction_from_index(0.5), "refractive_index must be finite and >= 1, got 0.5"),
        (lambda: c.rayleigh_air(0.55), "wavelength must be in [200, 2000] nm, got 0.55"),
        (lambda: c.mean_free_path("red"), "sigma_t must be an array of real numbers, got 'red'"),
    ],
)
def test_bad_arguments_are_named(call, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        call()
