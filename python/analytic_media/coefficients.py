"""The ways to state what matter does to light, and those back.

sigma_t, sigma_a and sigma_s are the coefficients of extinction, absorption and scattering, in
1/length; the albedo is that of single scattering. Lengths are in any one unit, unless a function
says metres or nanometres (nm). Arguments broadcast; float32 in gives float32 out, everything else
is float64. A number outside its range raises ValueError with name, range and value. Equation
numbers are those of "Sampling Analytic Participating Media".

    sigma_t = sigma_t_from_visibility(200)                       # fog: 0.015
    air = sigma_t_from_number(STANDARD_NUMBER_DENSITY, rayleigh_air([680, 550, 440]))  # 1/m

Functions that undo each other do so to 1e-12, as far as the number between them holds what is asked
for: a transmittance near 1 tells little of sigma_t, the opacity then tells all of it.
"""

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._arrays import function as _evaluate

Result = np.floating | np.ndarray

# What red, green and blue stand for, nm: Bruneton and Neyret, "Precomputed Atmospheric Scattering"
# (2008), Section 4. Light without colour is green.
RGB_WAVELENGTHS = _native.constant("AM_RGB_WAVELENGTHS")

# Molecules of a gas at 288.15 K and 1013.25 hPa, 1/m³: Bodhaine et al. (1999), Section 2.
STANDARD_NUMBER_DENSITY = _native.constant("AM_STANDARD_NUMBER_DENSITY")


# ---- Absorption, scattering, albedo ----------------------------------------------------------


def sigma_t_from_parts(sigma_a: ArrayLike, sigma_s: ArrayLike) -> Result:
    """sigma_a + sigma_s; both finite, >= 0 (Eq. 1)."""
    return _evaluate("sigma_t_from_parts", sigma_a=sigma_a, sigma_s=sigma_s)


def albedo_from_parts(sigma_a: ArrayLike, sigma_s: ArrayLike) -> Result:
    """sigma_s / (sigma_a + sigma_s); both finite, >= 0; 0 where both are (Eq. 2)."""
    return _evaluate("albedo_from_parts", sigma_a=sigma_a, sigma_s=sigma_s)


def sigma_a_from_albedo(sigma_t: ArrayLike, albedo: ArrayLike) -> Result:
    """(1 - albedo) sigma_t, for `sigma_t` >= 0 and `albedo` in [0, 1] (Eq. 1 and 2)."""
    return _evaluate("sigma_a_from_albedo", sigma_t=sigma_t, albedo=albedo)


def sigma_s_from_albedo(sigma_t: ArrayLike, albedo: ArrayLike) -> Result:
    """albedo · sigma_t, for `sigma_t` >= 0 and `albedo` in [0, 1] (Eq. 2)."""
    return _evaluate("sigma_s_from_albedo", sigma_t=sigma_t, albedo=albedo)


# ---- Distances -------------------------------------------------------------------------------


def sigma_t_from_mean_free_path(mean_free_path: ArrayLike) -> Result:
    """1 / mean_free_path, a length > 0 that may be infinite (Eq. 3)."""
    return _evaluate("sigma_t_from_mean_free_path", mean_free_path=mean_free_path)


def mean_free_path(sigma_t: ArrayLike) -> Result:
    """1 / sigma_t, for `sigma_t` >= 0; infinite where that is 0 (Eq. 3)."""
    return _evaluate("mean_free_path", sigma_t=sigma_t)


def sigma_t_from_transmittance(transmittance: ArrayLike, at_distance: ArrayLike) -> Result:
    """-ln(transmittance) / at_distance, for a transmittance in (0, 1] and a length > 0 (Eq. 21)."""
    return _evaluate(
        "sigma_t_from_transmittance", transmittance=transmittance, at_distance=at_distance
    )


def transmittance(sigma_t: ArrayLike, at_distance: ArrayLike) -> Result:
    """exp(-sigma_t · at_distance), for `sigma_t` >= 0 and a length > 0 (Eq. 21)."""
    return _evaluate("transmittance", sigma_t=sigma_t, at_distance=at_distance)


def sigma_t_from_opacity(opacity: ArrayLike, at_distance: ArrayLike) -> Result:
    """-ln(1 - opacity) / at_distance, for an opacity in [0, 1) and a length > 0 (Eq. 21).

    As precise for small opacities.
    """
    return _evaluate("sigma_t_from_opacity", opacity=opacity, at_distance=at_distance)


def opacity(sigma_t: ArrayLike, at_distance: ArrayLike) -> Result:
    """1 - exp(-sigma_t · at_distance), for `sigma_t` >= 0 and a length > 0 (Eq. 21).

    As precise for small opacities.
    """
    return _evaluate("opacity", sigma_t=sigma_t, at_distance=at_distance)


def sigma_t_from_visibility(visibility: ArrayLike, contrast: ArrayLike = 0.05) -> Result:
    """-ln(contrast) / visibility (Koschmieder, 1924).

    * `visibility`: the distance at which a black object against the horizon keeps `contrast`; a
      length > 0 that may be infinite
    * `contrast`: in (0, 1); 0.05 for the meteorological optical range (WMO-No. 8), which the preset
      `height_fog` uses, 0.02 in Koschmieder's work
    """
    return _evaluate("sigma_t_from_visibility", visibility=visibility, contrast=contrast)


def visibility(sigma_t: ArrayLike, contrast: ArrayLike = 0.05) -> Result:
    """-ln(contrast) / sigma_t, for `sigma_t` >= 0; infinite where that is 0 (Koschmieder, 1924)."""
    return _evaluate("visibility", sigma_t=sigma_t, contrast=contrast)


# ---- Matter ----------------------------------------------------------------------------------


def sigma_a_from_extinction_index(extinction_index: ArrayLike, wavelength: ArrayLike) -> Result:
    """4π extinction_index / wavelength, in 1/m (Eq. 4).

    * `extinction_index`: imaginary part of the index of refraction, >= 0
    * `wavelength`: in vacuum, nm, > 0
    """
    return _evaluate(
        "sigma_a_from_extinction_index", extinction_index=extinction_index, wavelength=wavelength
    )


def extinction_index(sigma_a: ArrayLike, wavelength: ArrayLike) -> Result:
    """sigma_a · wavelength / 4π, for `sigma_a` >= 0 in 1/m and a wavelength > 0 in nm (Eq. 4)."""
    return _evaluate("extinction_index", sigma_a=sigma_a, wavelength=wavelength)


def sigma_t_from_mass(mass_density: ArrayLike, mass_attenuation: ArrayLike) -> Result:
    """mass_density · mass_attenuation, in 1/m, from kg/m³ and m²/kg, both >= 0 (Eq. 5)."""
    return _evaluate(
        "sigma_t_from_mass", mass_density=mass_density, mass_attenuation=mass_attenuation
    )


def mass_density(sigma_t: ArrayLike, mass_attenuation: ArrayLike) -> Result:
    """sigma_t / mass_attenuation, in kg/m³, from 1/m, >= 0, and m²/kg, > 0 (Eq. 5)."""
    return _evaluate("mass_density", sigma_t=sigma_t, mass_attenuation=mass_attenuation)


def sigma_t_from_number(number_density: ArrayLike, cross_section: ArrayLike) -> Result:
    """number_density · cross_section, in 1/m, from 1/m³ and m², both >= 0 (Eq. 5)."""
    return _evaluate(
        "sigma_t_from_number", number_density=number_density, cross_section=cross_section
    )


def number_density(sigma_t: ArrayLike, cross_section: ArrayLike) -> Result:
    """sigma_t / cross_section, in 1/m³, from 1/m, >= 0, and m², > 0 (Eq. 5)."""
    return _evaluate("number_density", sigma_t=sigma_t, cross_section=cross_section)


# ---- Refraction ------------------------------------------------------------------------------
#
# The refraction L = (η² - 1)/(η² + 2) of a mixture is the sum of those of its parts, each weighted
# by the fraction of the volume that it has before mixing.


def polarizability_volume(polarizability: ArrayLike) -> Result:
    """α / (4π ε0), in m³, of a polarisability α >= 0 in C m²/V. Tables have it in Å³ = 1e-30 m³."""
    return _evaluate("polarizability_volume", polarizability=polarizability)


def polarizability(polarizability_volume: ArrayLike) -> Result:
    """4π ε0 α', in C m²/V, of a polarisability volume α' >= 0 in m³."""
    return _evaluate("polarizability", polarizability_volume=polarizability_volume)


def refraction_from_density(
    mass_density: ArrayLike, molecular_mass: ArrayLike, polarizability_volume: ArrayLike
) -> Result:
    """L by the Lorentz-Lorenz equation (Eq. 6).

    * `mass_density`: kg/m³, >= 0
    * `molecular_mass`: kg, > 0
    * `polarizability_volume`: m³, >= 0
    """
    return _evaluate(
        "refraction_from_density",
        mass_density=mass_density,
        molecular_mass=molecular_mass,
        polarizability_volume=polarizability_volume,
    )


def density_from_refraction(
    refraction: ArrayLike, molecular_mass: ArrayLike, polarizability_volume: ArrayLike
) -> Result:
    """kg/m³: the inverse of `refraction_from_density`, for a polarisability volume > 0."""
    return _evaluate(
        "density_from_refraction",
        refraction=refraction,
        molecular_mass=molecular_mass,
        polarizability_volume=polarizability_volume,
    )


def refractivity_from_refraction(refraction: ArrayLike) -> Result:
    """η - 1 of a refraction L in [0, 1); as precise for gases (Eq. 6)."""
    return _evaluate("refractivity_from_refraction", refraction=refraction)


def refraction_from_refractivity(refractivity: ArrayLike) -> Result:
    """L of a refractivity η - 1 >= 0; as precise for gases (Eq. 6)."""
    return _evaluate("refraction_from_refractivity", refractivity=refractivity)


def refractive_index(refraction: ArrayLike) -> Result:
    """η of a refraction L in [0, 1) (Eq. 6)."""
    return _evaluate("refractive_index", refraction=refraction)


def refraction_from_index(refractive_index: ArrayLike) -> Result:
    """L of a refractive index η >= 1 (Eq. 6)."""
    return _evaluate("refraction_from_index", refractive_index=refractive_index)


def gas_refractivity(
    mass_density: ArrayLike, molecular_mass: ArrayLike, polarizability_volume: ArrayLike
) -> Result:
    """η - 1 of a gas; low by (η - 1)/6 of itself (Eq. 7). Arguments: `refraction_from_density`."""
    return _evaluate(
        "gas_refractivity",
        mass_density=mass_density,
        molecular_mass=molecular_mass,
        polarizability_volume=polarizability_volume,
    )


def gas_density(
    refractivity: ArrayLike, molecular_mass: ArrayLike, polarizability_volume: ArrayLike
) -> Result:
    """kg/m³: the inverse of `gas_refractivity`, for a polarisability volume > 0."""
    return _evaluate(
        "gas_density",
        refractivity=refractivity,
        molecular_mass=molecular_mass,
        polarizability_volume=polarizability_volume,
    )


# ---- Rayleigh scattering ---------------------------------------------------------------------


def rayleigh_air(wavelength: ArrayLike) -> Result:
    """Cross-section of a molecule of dry air with 360 ppm of carbon dioxide, m².

    `wavelength` is that in vacuum, 200 to 2000 nm. Bodhaine, Wood, Dutton and Slusser, "On Rayleigh
    Optical Depth Calculations", J. Atmos. Oceanic Technol. 16 (1999), Eq. 29, which fits their
    computation to 0.01 % from 250 to 850 nm, to 0.4 % at 200 nm and to 3 % at 2000 nm.
    """
    return _evaluate("rayleigh_air", wavelength=wavelength)


def rayleigh_cross_section(
    wavelength: ArrayLike,
    refractivity: ArrayLike,
    number_density: ArrayLike = STANDARD_NUMBER_DENSITY,
    king_factor: ArrayLike = 1.0,
) -> Result:
    """Cross-section of a molecule of a gas, m²: (24π³/λ⁴) (L/n)² F.

    Sneep and Ubachs, "Direct measurement of the Rayleigh scattering cross section in various
    gases", JQSRT 92 (2005), Eq. 1.

    * `wavelength`: λ in vacuum, nm, > 0
    * `refractivity`: η - 1 of the gas at the number density n; >= 0
    * `number_density`: n, 1/m³, > 0
    * `king_factor`: F >= 1; 1 for round molecules
    """
    return _evaluate(
        "rayleigh_cross_section",
        wavelength=wavelength,
        refractivity=refractivity,
        number_density=number_density,
        king_factor=king_factor,
    )
