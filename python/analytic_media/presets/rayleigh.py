"""Rayleigh scattering by gases: cross-sections per molecule, in m²; wavelengths in nm."""

import numpy as np

# Number density of a gas at 288.15 K and 1013.25 hPa, 1/m³: Bodhaine et al. (1999), Section 2.
# The refractive indices below are those of gases at this density.
STANDARD_DENSITY = 2.546899e25

PHASE = {"type": "rayleigh"}


def air(wavelength):
    """Dry air with 360 ppm of carbon dioxide.

    Bodhaine, Wood, Dutton and Slusser, "On Rayleigh Optical Depth Calculations", J. Atmos.
    Oceanic Technol. 16 (1999), Eq. 29, which fits their computation to 0.01 % from 250 to 850 nm.
    """
    x = (np.asarray(wavelength) / 1000) ** 2  # µm²
    fit = (1.0455996 - 341.29061 / x - 0.90230850 * x) / (1 + 0.0027059889 / x - 85.968563 * x)
    return 1e-32 * fit


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
    return cross_section(nu, refractivity, 1.1364 + 25.3e-12 * nu**2)


def nitrogen(wavelength):
    """Sneep and Ubachs (2005), for wavelengths above 468 nm: within 0.03 % down to 360 nm."""
    nu = wavenumber(wavelength)
    refractivity = 1e-8 * (5677.465 + 318.81874e12 / (14.4e9 - nu**2))
    return cross_section(nu, refractivity, 1.034 + 3.17e-12 * nu**2)


def wavenumber(wavelength):
    """1/cm."""
    return 1e7 / np.asarray(wavelength)


def cross_section(nu, refractivity, king_factor):
    """24 π³ ν⁴ / N² ((n² - 1) / (n² + 2))² F: Sneep and Ubachs (2005), Eq. 1.

    `refractivity` is n - 1 at the density N = STANDARD_DENSITY.
    """
    index2 = (1 + refractivity) ** 2
    lorentz = ((index2 - 1) / (index2 + 2)) ** 2
    return 24 * np.pi**3 * (100 * nu) ** 4 / STANDARD_DENSITY**2 * lorentz * king_factor
