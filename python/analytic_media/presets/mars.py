"""Mars: a little carbon dioxide, and dust.

Radius, pressure, gravity, molar mass, scale height and distance from the sun are those of NASA's
Mars Fact Sheet (Williams, nssdc.gsfc.nasa.gov/planetary/factsheet/marsfact.html).
"""

from . import rayleigh
from .atmosphere import Planet, exponential, tabulated
from .earth import at_least_zero
from .scene import medium, scene

RADIUS = 3.3895e6  # m
TOP = 120e3  # m: exp(-10.8) of the gas is above
SCALE_HEIGHT = 11.1e3  # m
PRESSURE, GRAVITY, MOLAR_MASS = 636.0, 3.73, 43.34e-3  # Pa, m/s², kg/mol
AVOGADRO = 6.02214076e23  # 1/mol: exact (SI 2019)
COLUMN = PRESSURE / GRAVITY / MOLAR_MASS * AVOGADRO  # molecules/m²
SUN_DISTANCE = 1.524  # au

# Lemmon et al., "Atmospheric Imaging Results from the Mars Exploration Rovers", Science 306 (2004):
# 0.9 measured by both rovers as the dust of a storm settled, well mixed with the gas.
DUST_OPTICAL_DEPTH = 0.9
DUST_SCALE_HEIGHT = 11.56e3  # m

# Wolff et al., J. Geophys. Res. 114, E00D04 (2009), for an effective radius of 1.5 µm, as the Mars
# Planetary Climate Model has it (optprop_dustvis_TM.dat): absorption in the blue, by iron oxides.
# The extinction is grey within 3 % from 600 to 880 nm there; we take it as grey.
DUST_WAVELENGTHS = (388.0, 650.0, 700.0)  # nm
DUST_ALBEDO = (0.73, 0.967, 0.975)

# Chen-Chen, Pérez-Hoyos and Sánchez-Lavega, "Characterisation of Martian dust aerosol phase
# function from sky radiance measurements by MSL engineering cameras", Icarus 330 (2019), Eq. 1 and
# its mean parameters: a sum of two Henyey-Greenstein functions, at 650 nm.
DUST_PHASE = {
    "type": "blendphase",
    "weight": 0.743,  # of the second
    "broad": {"type": "hg", "g": 0.094},
    "forward": {"type": "hg", "g": 0.889},
}

# Geometric albedos in B, V and R of Mallama, Krobusek and Pavlov, Icarus 282 (2017), Table 7, times
# 3/2, which is the albedo of a Lambertian sphere; at the effective wavelengths of the bands
# (Bessell, PASP 102, 1990).
GROUND_WAVELENGTHS = (436.0, 545.0, 641.0)  # nm
GROUND = (0.132, 0.255, 0.375)


def planet(dust: float = DUST_OPTICAL_DEPTH) -> Planet:
    """The atmosphere of Mars; see `mars`."""
    layers = {
        "molecules": exponential(
            SCALE_HEIGHT, lambda w: COLUMN * rayleigh.carbon_dioxide(w), 1.0, rayleigh.PHASE
        )
    }
    if at_least_zero("dust", dust):
        albedo = tabulated(DUST_WAVELENGTHS, DUST_ALBEDO)
        layers["dust"] = exponential(DUST_SCALE_HEIGHT, dust, albedo, DUST_PHASE)
    return Planet(RADIUS, TOP, layers, tabulated(GROUND_WAVELENGTHS, GROUND), SUN_DISTANCE)


def mars(
    view: str = "horizon", unit: str | float = "km", *, dust: float = DUST_OPTICAL_DEPTH, **options
) -> dict:
    """A scene under, in or above the atmosphere of Mars, for mi.load_dict.

    * `dust`: vertical optical depth in visible light; 0 for none

    Everything else is in `presets.scene.scene`.
    """
    return scene(planet(dust), view, unit, **options)


def mars_medium(
    unit: str | float = "km",
    *,
    dust: float = DUST_OPTICAL_DEPTH,
    max_density: float | None = None,
) -> dict:
    """The atmosphere of Mars alone: an `overlap` medium around (0, 0, -radius)."""
    return medium(planet(dust), unit, max_density)
