"""The Earth: air, ozone and aerosol.

Sources of the numbers stand beside them. Rayleigh coefficients come from Bodhaine et al. (1999):
their column at sea level and 45° latitude, and the density there, give the scale height.
"""

import numpy as np

from ..coefficients import STANDARD_NUMBER_DENSITY
from . import rayleigh
from .atmosphere import Planet, exponential, tabulated, tent
from .scene import medium, scene

RADIUS = 6.371e6  # m: mean radius R1 of the ellipsoid GRS 80 (Moritz 2000)
TOP = 100e3  # m: exp(-12) of the air is above

# Molecules above 1 m² at sea level, 1013.25 hPa: the factor of Bodhaine et al. (1999), Eq. 30,
# over that of Eq. 29.
COLUMN = 0.0021520 / 1e-32
SCALE_HEIGHT = COLUMN / STANDARD_NUMBER_DENSITY  # 8450 m, at 288.15 K

# Global annual means of the aerosol: Kinne, "The MACv2 aerosol climatology", Tellus B 71 (2019),
# Table 2.
AEROSOL_WAVELENGTHS = (450.0, 550.0, 1000.0)  # nm
AEROSOL_OPTICAL_DEPTH = (0.144, 0.122, 0.081)
AEROSOL_ALBEDO = (0.902, 0.941, 0.956)
AEROSOL_ASYMMETRY = 0.702  # at 550 nm; 0.718 and 0.693 at the other two
AEROSOL_SCALE_HEIGHT = 2000.0  # m: mean altitude of the four layers of Kinne's Table 3

# Cross-section of ozone at 233 K, m², in bins of 10 nm from 360 nm on: measurements of Gorshelev
# et al. and Serdyuchenko et al., Atmos. Meas. Tech. 7 (2014), in the bins of Bruneton's reference
# implementation (2017), github.com/ebruneton/precomputed_atmospheric_scattering,
# atmosphere/demo/demo.cc, kOzoneCrossSection; so are the tent and the Dobson unit.
OZONE_CROSS_SECTION = (
    1.18e-27, 2.182e-28, 2.818e-28, 6.636e-28, 1.527e-27, 2.763e-27, 5.52e-27,
    8.451e-27, 1.582e-26, 2.316e-26, 3.669e-26, 4.924e-26, 7.752e-26, 9.016e-26,
    1.48e-25, 1.602e-25, 2.139e-25, 2.755e-25, 3.091e-25, 3.5e-25, 4.266e-25,
    4.672e-25, 4.398e-25, 4.701e-25, 5.019e-25, 4.305e-25, 3.74e-25, 3.215e-25,
    2.662e-25, 2.238e-25, 1.852e-25, 1.473e-25, 1.209e-25, 9.423e-26, 7.455e-26,
    6.566e-26, 5.105e-26, 4.15e-26, 4.228e-26, 3.237e-26, 2.451e-26, 2.801e-26,
    2.534e-26, 1.624e-26, 1.465e-26, 2.078e-26, 1.383e-26, 7.105e-27,
)  # fmt: skip
OZONE_BINS = np.arange(365.0, 836.0, 10.0)  # their centres, nm
OZONE_HEIGHT, OZONE_WIDTH = 25e3, 15e3  # m
DOBSON_UNIT = 2.687e20  # molecules/m²

GROUND = 0.1  # albedo: Bruneton (2017), demo.cc, kGroundAlbedo


def planet(aerosol: float = 0.122, ozone: float = 300.0) -> Planet:
    """The Earth's atmosphere; see `earth`."""
    shape = np.array(AEROSOL_OPTICAL_DEPTH) / AEROSOL_OPTICAL_DEPTH[1]
    cross_section = tabulated(OZONE_BINS, OZONE_CROSS_SECTION)
    layers = {
        "molecules": exponential(
            SCALE_HEIGHT, lambda w: COLUMN * rayleigh.air(w), 1.0, rayleigh.PHASE
        )
    }
    if at_least_zero("aerosol", aerosol):
        layers["aerosol"] = exponential(
            AEROSOL_SCALE_HEIGHT,
            angstrom(AEROSOL_WAVELENGTHS, aerosol * shape),
            tabulated(AEROSOL_WAVELENGTHS, AEROSOL_ALBEDO),
            {"type": "hg", "g": AEROSOL_ASYMMETRY},
        )
    if at_least_zero("ozone", ozone):
        layers["ozone"] = tent(
            OZONE_HEIGHT,
            OZONE_WIDTH,
            lambda w: ozone * DOBSON_UNIT * cross_section(w),
            0.0,
            {"type": "isotropic"},
        )
    return Planet(RADIUS, TOP, layers, GROUND, sun_distance=1.0)


def at_least_zero(name: str, value: float) -> float:
    if not 0 <= value < np.inf:
        raise ValueError(f"{name} must be finite and >= 0, got {value!r}")
    return value


def angstrom(wavelengths, optical_depths):
    """Linear in the logarithms of both: Ångström's law between the given wavelengths, the nearest
    exponent beyond them."""
    x, y = np.log(wavelengths), np.log(optical_depths)

    def optical_depth(wavelength):
        at = np.log(wavelength)
        i = np.clip(np.searchsorted(x, at) - 1, 0, len(x) - 2)
        return np.exp(y[i] + (y[i + 1] - y[i]) * (at - x[i]) / (x[i + 1] - x[i]))

    return optical_depth


def earth(
    view: str = "horizon",
    unit: str | float = "km",
    *,
    aerosol: float = 0.122,
    ozone: float = 300.0,
    **options,
) -> dict:
    """A scene under, in or above the Earth's atmosphere, for mi.load_dict.

    * `aerosol`: vertical optical depth at 550 nm; 0 for none
    * `ozone`: column in Dobson units; 0 for none

    Everything else is in `presets.scene.scene`. Radiance is in W/(m² sr nm), averaged over what
    each colour channel sees.

        image = mi.render(mi.load_dict(am.earth(sun_zenith=85)))
    """
    return scene(planet(aerosol, ozone), view, unit, **options)


def earth_medium(
    unit: str | float = "km",
    *,
    aerosol: float = 0.122,
    ozone: float = 300.0,
    max_density: float | None = None,
) -> dict:
    """The Earth's atmosphere alone: an `overlap` medium around (0, 0, -radius)."""
    return medium(planet(aerosol, ozone), unit, max_density)
