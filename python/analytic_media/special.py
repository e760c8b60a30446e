"""Special functions: the Chapman function and its relatives, exponential integrals, approximations.

Arguments broadcast; float32 in gives float32 out, everything else is float64. A number outside its
range raises ValueError with name, range and value. Equation numbers are those of "Sampling Analytic
Participating Media".

    z = 6371 / 8.4                                    # radius over scale height
    chapman(z, cos_zenith=[1, 0.5, 0])                # 1, 1.99, 34.5 times the vertical column

Functions named after an author are approximations, for comparison: `docs/accuracy.md` has their
errors.
"""

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays

Result = np.floating | np.ndarray


def chapman(z: ArrayLike, cos_zenith: ArrayLike) -> Result:
    """Chapman function: column of a ray to infinity over that of a vertical ray (Eq. 42).

    * `z`: distance from the centre in scale heights, finite, >= 0
    * `cos_zenith`: of the direction, in [-1, 1]; below the horizontal the ray passes through the
      planet, and the value grows to 2 exp(z) - 1 or infinity

    Relative error below 1e-13, in float32 1e-6.
    """
    return _arrays.function("chapman", z=z, cos_zenith=cos_zenith)


def log_chapman(z: ArrayLike, cos_zenith: ArrayLike) -> Result:
    """Natural logarithm of `chapman`, finite where that overflows."""
    return _arrays.function("log_chapman", z=z, cos_zenith=cos_zenith)


def chapman_rescaled(z: ArrayLike, surface: ArrayLike, cos_zenith: ArrayLike) -> Result:
    """exp(surface - z) times `chapman` (Eq. 43); `surface` is the planet's radius in scale heights.

    Times the scale height it is the column of a ray where the density at the surface is 1.
    """
    return _arrays.function("chapman_rescaled", z=z, surface=surface, cos_zenith=cos_zenith)


def log_chapman_rescaled(z: ArrayLike, surface: ArrayLike, cos_zenith: ArrayLike) -> Result:
    """Natural logarithm of `chapman_rescaled`, finite where that overflows or vanishes."""
    return _arrays.function("log_chapman_rescaled", z=z, surface=surface, cos_zenith=cos_zenith)


def chapman_upper(z: ArrayLike, cos_zenith: ArrayLike) -> Result:
    """`chapman` of rays that do not lead down, `cos_zenith` in [0, 1]."""
    return _arrays.function("chapman_upper", z=z, cos_zenith=cos_zenith)


def chapman_lower(z: ArrayLike, cos_zenith: ArrayLike) -> Result:
    """`chapman` of rays that do not lead up, `cos_zenith` in [-1, 0]."""
    return _arrays.function("chapman_lower", z=z, cos_zenith=cos_zenith)


def bessel_k1_scaled(z: ArrayLike) -> Result:
    """z exp(z) K1(z) for z >= 0: `chapman` of horizontal rays. 1 at 0 (Eq. 47)."""
    return _arrays.function("bessel_k1_scaled", z=z)


def erfcx(x: ArrayLike) -> Result:
    """exp(x²) erfc(x) for any finite x. Relative error below 5e-16, in float32 5e-7."""
    return _arrays.function("erfcx", x=x)


def expint_ei(z: ArrayLike) -> np.complexfloating | np.ndarray:
    """Exponential integral Ei(z), complex, principal branch; real on the real axis.

    |error| below 1e-12 |Ei|, in complex64 2e-6 |Ei|, for imaginary parts up to 1000.
    """
    return _arrays.complex_function("expint_ei", "z", z)


def expint_ei_scaled(z: ArrayLike) -> np.complexfloating | np.ndarray:
    """exp(-z) (Ei(z) - i pi sgn(Im z)), complex: about 1/z for large |z|, and never overflows."""
    return _arrays.complex_function("expint_ei_scaled", "z", z)


def expint_e1(x: ArrayLike) -> Result:
    """Exponential integral E1(x) = -Ei(-x) for x > 0. Relative error 1e-12, in float32 2e-6."""
    return _arrays.function("expint_e1", x=x)


def expint_e1_scaled(x: ArrayLike) -> Result:
    """exp(x) E1(x) for x > 0: about 1/x for large x."""
    return _arrays.function("expint_e1_scaled", x=x)


# ---- Approximations --------------------------------------------------------------------------


def chapman_huestis(z: ArrayLike, cos_zenith: ArrayLike) -> Result:
    """`chapman` for large z > 0, by two terms of an expansion (Eq. 46 to 48; Huestis, 2001).

    Relative error upwards 8 % at z = 1, 3e-5 at 100, 1e-6 beyond 800. Rays that pass near the
    centre diverge.
    """
    return _arrays.function("chapman_huestis", z=z, cos_zenith=cos_zenith)


def chapman_horizontal_huestis(z: ArrayLike) -> Result:
    """`bessel_k1_scaled` for large z > 0, by three terms of its series (Eq. 47; Huestis, 2001)."""
    return _arrays.function("chapman_horizontal_huestis", z=z)


def chapman_schueler(z: ArrayLike, cos_zenith: ArrayLike) -> Result:
    """`chapman` upwards, z > 0 (Eq. 49; Schüler, 2012). Relative error up to 15 %."""
    return _arrays.function("chapman_schueler", z=z, cos_zenith=cos_zenith)


def chapman_kocifaj(z: ArrayLike, cos_zenith: ArrayLike) -> Result:
    """`chapman` upwards, z > 0, with square roots alone (draft, Eq. 45; Kocifaj, 1996).

    Relative error 16 % at z = 1, 0.4 % beyond 100.
    """
    return _arrays.function("chapman_kocifaj", z=z, cos_zenith=cos_zenith)


def erfcx_golubev(x: ArrayLike) -> Result:
    """`erfcx` for x >= 0 by the article's fit (`Exp2Erfc`). Relative error 1.5e-6."""
    return _arrays.function("erfcx_golubev", x=x)


def erfcx_ren_mackenzie(x: ArrayLike) -> Result:
    """`erfcx` for x >= 0 (draft, Eq. 44; Ren and MacKenzie, 2007). Relative error 3.4e-3."""
    return _arrays.function("erfcx_ren_mackenzie", x=x)
