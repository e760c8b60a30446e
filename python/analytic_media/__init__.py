"""Participating media in closed form, for NumPy and for Mitsuba 3.

    import analytic_media as am

    fog = am.Medium([(am.Exponential(scale_height=20), 0.1)])
    fog.transmittance(o=(0, 0, 2), d=(1, 0, 0), t=50)

`am.airlight` is what a point light adds in a uniform one, with the phase functions and lights of
`am.scattering`. `am.special` has the functions behind it, `am.coefficients` the ways to state a
medium, and `am.spectral` the weights of paths that carry several wavelengths; `am.jit` asks the
same of Dr.Jit arrays; `am.earth()` and its like are scenes for Mitsuba. Importing the package makes
its plugins known to Mitsuba, if it is installed.
"""

from . import coefficients, jit, presets, scattering, special, spectral
from ._native import version as _version
from ._plugins import register as _register
from .geometry import Planet
from .medium import Medium
from .presets import earth, height_fog, mars, titan
from .profiles import (
    AnisotropicGaussian,
    Constant,
    Exponential,
    Gaussian,
    Linear,
    Profile,
    RadialGaussian,
    Spherical,
    Tent,
)
from .scattering import AirLight, airlight
from .special import (
    bessel_k1_scaled,
    chapman,
    erfcx,
    expint_e1,
    expint_e1_scaled,
    expint_ei,
    expint_ei_scaled,
    log_chapman,
)

__all__ = [
    "AirLight",
    "AnisotropicGaussian",
    "Constant",
    "Exponential",
    "Gaussian",
    "Linear",
    "Medium",
    "Planet",
    "Profile",
    "RadialGaussian",
    "Spherical",
    "Tent",
    "airlight",
    "bessel_k1_scaled",
    "chapman",
    "coefficients",
    "earth",
    "erfcx",
    "expint_e1",
    "expint_e1_scaled",
    "expint_ei",
    "expint_ei_scaled",
    "height_fog",
    "jit",
    "log_chapman",
    "mars",
    "presets",
    "scattering",
    "special",
    "spectral",
    "titan",
]
__version__ = _version()

_register()
