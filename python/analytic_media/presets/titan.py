"""Titan: nitrogen under a haze whose scale height is a fortieth of the moon's radius."""

import numpy as np

from . import rayleigh
from .atmosphere import Planet, exponential
from .earth import at_least_zero
from .scene import medium, scene

RADIUS = 2.5747e6  # m: Zebker et al., Science 324 (2009)
TOP = 600e3  # m: exp(-9.2) of the haze is above
SUN_DISTANCE = 9.58  # au: of Saturn (NASA's Saturn Fact Sheet)

# At the surface, by the Huygens probe: Fulchignoni et al., Nature 438 (2005).
PRESSURE, TEMPERATURE = 146.7e3, 93.65  # Pa, K
GRAVITY = 1.352  # m/s² (NASA's Saturnian Satellite Fact Sheet)
MOLECULE = 28.0134e-3 / 6.02214076e23  # kg, nitrogen
BOLTZMANN = 1.380649e-23  # J/K: exact (SI 2019)
COLUMN = PRESSURE / GRAVITY / MOLECULE  # molecules/m²
SCALE_HEIGHT = COLUMN / (PRESSURE / BOLTZMANN / TEMPERATURE)  # 20.6 km, in the cold troposphere

# Tomasko et al., Planet. Space Sci. 56 (2008), from the descent of Huygens, as fitted by Bazzon,
# Schmid and Buenzli, Astron. Astrophys. 572, A6 (2014), Eq. A.8-A.13: optical depths of the haze
# above 80 km, from 30 to 80 km and below, (coefficient, exponent) of the wavelength in nm. The
# scale height is that above 80 km. Below, the haze is nearly uniform: our single exponential has
# the same column, with more of it near the ground and less at 80 km.
HAZE_OPTICAL_DEPTH = ((1.012e7, -2.339), (2.029e4, -1.409), (6.270e2, -0.9706))
HAZE_SCALE_HEIGHT = 65e3  # m

# Doose et al., Icarus 270 (2016), above 200 km, as plotted by Barnes et al., Astron. J. 156 (2018),
# Fig. 4; below 500 nm the line through the first two. Below 80 km it is (0.565 + ω) / 1.5 (Doose
# et al., as in Es-sayeh et al., Planet. Sci. J. 4, 2023); ours is the mean of both.
HAZE_WAVELENGTHS = (500.0, 600.0, 700.0, 800.0)  # nm
HAZE_ALBEDO_ABOVE = (0.844, 0.901, 0.9285, 0.9355)
HAZE_ASYMMETRY = 0.76  # 0.73 to 0.80 from 360 to 830 nm in Table 1 of Tomasko et al. (2008)

GROUND = 0.1  # 0.02 to 0.15 in the visible: García Muñoz et al., Nature Astronomy 1 (2017), Methods


def haze_optical_depth(wavelength):
    """Of the whole vertical column."""
    return sum(factor * wavelength**exponent for factor, exponent in HAZE_OPTICAL_DEPTH)


def haze_albedo(wavelength):
    """Of single scattering."""
    x, y = np.array(HAZE_WAVELENGTHS), np.array(HAZE_ALBEDO_ABOVE)
    slope = (y[1] - y[0]) / (x[1] - x[0])
    above = np.interp(wavelength, x, y) - slope * np.maximum(x[0] - wavelength, 0)
    return (above + (0.565 + above) / 1.5) / 2


def planet(haze: float = 1.0) -> Planet:
    """The atmosphere of Titan; see `titan`."""
    layers = {
        "molecules": exponential(
            SCALE_HEIGHT, lambda w: COLUMN * rayleigh.nitrogen(w), 1.0, rayleigh.PHASE
        )
    }
    if at_least_zero("haze", haze):
        layers["haze"] = exponential(
            HAZE_SCALE_HEIGHT,
            lambda w: haze * haze_optical_depth(w),
            haze_albedo,
            {"type": "hg", "g": HAZE_ASYMMETRY},
        )
    return Planet(RADIUS, TOP, layers, GROUND, SUN_DISTANCE)


def titan(view: str = "horizon", unit: str | float = "km", *, haze: float = 1.0, **options) -> dict:
    """A scene under, in or above the atmosphere of Titan, for mi.load_dict.

    * `haze`: times what the Huygens probe met in 2005; 0 for none

    Everything else is in `presets.scene.scene`. The gas absorbs nothing here: methane does, beyond
    600 nm.
    """
    return scene(planet(haze), view, unit, **options)


def titan_medium(
    unit: str | float = "km", *, haze: float = 1.0, max_density: float | None = None
) -> dict:
    """The atmosphere of Titan alone: an `overlap` medium around (0, 0, -radius)."""
    return medium(planet(haze), unit, max_density)
