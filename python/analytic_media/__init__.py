"""Participating media in closed form, for NumPy and for Mitsuba 3.

    import analytic_media as am

    fog = am.Medium([(am.Exponential(scale_height=20), 0.1)])
    fog.transmittance(o=(0, 0, 2), d=(1, 0, 0), t=50)

`am.sunlit_fog` is what fog in the sun scatters towards the eye. `am.special` has the functions
behind it, `am.coefficients` the ways to state a medium, and `am.spectral` the weights of paths that
carry several wavelengths; `am.jit` asks the same of Dr.Jit arrays; `am.earth()` and its like are
scenes for Mitsuba. Importing the package makes its plugins known to Mitsuba, if it is installed.
"""

from . import coefficients, jit, presets, special, spectral
from ._native import version as _version
from ._plugins import register as _register
from .airlight import sunlit_fog
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
from .special import bessel_k1_scaled, chapman, erfcx, log_chapman

__all__ = [
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
    "bessel_k1_scaled",
    "chapman",
    "coefficients",
    "earth",
    "erfcx",
    "height_fog",
    "jit",
    "log_chapman",
    "mars",
    "presets",
    "special",
    "spectral",
    "sunlit_fog",
    "titan",
]
__version__ = _version()

_register()
