"""Rayleigh scattering by gases: cross-sections per molecule, in m²; wavelengths in nm."""

import numpy as np

from ..coefficients import STANDARD_NUMBER_DENSITY, rayleigh_air, rayleigh_cross_section

PHASE = {"type": "rayleigh"}

air = rayleigh_air


def carbon_dioxide(wavelength):
    """Sneep and Ubachs, "Direct measurement of the Rayleigh scattering cross section in various
    gases", JQSRT 92 (2005): refractive index (of Bideau-Mehu et al. 1973) and King factor, as
    in Table 1 of He et al., Atmos. Chem. Phys. 21 (2021)."""
    nu = wavenumber(wavelength)
    refractivity = 1.1427e3 * (
        5799.25 / (128908.9**2 - nu**2)
        + 120.05 / (89223.8**2 - nu**2)
        + 5.3334 / (75037.5**2 - nu**2)
        + 4.3244 / (67837.7**2 - nu**2)
        + 0.1218145e-4 / (2418.136**2 - nu**2)
    )
    return cross_section(wavelength, refractivity, 1.1364 + 25.3e-12 * nu**2)


def nitrogen(wavelength):
    """Sneep and Ubachs (2005), for wavelengths above 468 nm: within 0.03 % down to 360 nm."""
    nu = wavenumber(wavelength)
    refractivity = 1e-8 * (5677.465 + 318.81874e12 / (14.4e9 - nu**2))
    return cross_section(wavelength, refractivity, 1.034 + 3.17e-12 * nu**2)


def wavenumber(wavelength):
    """1/cm."""
    return 1e7 / np.asarray(wavelength)


def cross_section(wavelength, refractivity, king_factor):
    """Of a gas with the refractivity n - 1 at 288.15 K and 1013.25 hPa, as those above are."""
    return rayleigh_cross_section(wavelength, refractivity, STANDARD_NUMBER_DENSITY, king_factor)
