"""Fog in the sun: what it scatters once towards the eye, in closed form."""

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _native
from .profiles import Profile, Result

Phase = ArrayLike | Callable[[np.ndarray], ArrayLike]


def sunlit_fog(
    profile: Profile,
    sigma_s: float | Sequence[float],
    sigma_t: float | Sequence[float],
    eye: ArrayLike,
    direction: ArrayLike,
    t: ArrayLike,
    sun_direction: ArrayLike,
    phase: Phase = 1 / (4 * math.pi),
    bounds: tuple[ArrayLike, ArrayLike] | None = None,
) -> Result:
    """Radiance of a fog in the sun, per unit of irradiance perpendicular to the light, 1/sr.

    Light that is scattered once between `eye` and the distance `t`, which may be infinite.

    * `profile`: `Exponential` or `Constant`
    * `sigma_s`, `sigma_t`: coefficients of scattering and attenuation at relative density 1, in
      1/length, finite and >= 0: numbers, or sequences with one per channel; results then have one
      axis more, of that length, at the end
    * `eye` (..., 3), `direction` (..., 3), `t` (...): the segment
    * `sun_direction` (..., 3): towards the sun, a unit vector
    * `phase`: the value of the phase function, 1/sr, (...), or a function of the cosine of the
      scattering angle, which is 1 where `direction` is `sun_direction`; isotropic unless given

    * `bounds`: two corners (..., 3) of a box that a constant fog fills; it holds the segment, and
      light enters through its sides

    In an exponential fog the light comes from beyond it, and is 0 from a sun at the horizon or
    below it. A constant fog has no end unless it has `bounds`: the irradiance is that at `eye`.
    `docs/airlight.md` has the formulas.

        fog = am.Exponential(scale_height=20)
        am.sunlit_fog(fog, 0.01, 0.01, (0, 0, 2), (1, 0, 0), 300, (0.6, 0, 0.8))
    """
    if not isinstance(profile, Profile):
        raise ValueError(f"profile must be a profile, got {profile!r}")
    scattering = _arrays.channels("sigma_s", sigma_s)
    attenuation = _arrays.channels("sigma_t", sigma_t)
    if scattering.shape != attenuation.shape:
        raise ValueError(
            f"sigma_s and sigma_t must have the same shape, got {scattering.shape} and "
            f"{attenuation.shape}"
        )
    model = _native.sunlit_fog(profile._model, scattering.reshape(-1), attenuation.reshape(-1))
    value = phase(_cosine(direction, sun_direction)) if callable(phase) else phase
    length = _arrays.amount("t", t) if bounds is None else _arrays.number("t", t)
    arguments = [
        _arrays.point("eye", eye),
        _arrays.direction("direction", direction),
        length,
        _arrays.direction("sun_direction", sun_direction),
        _arrays.number("phase", value),
    ]
    if bounds is None:
        return _arrays.answer(model, "radiance", *arguments, width=attenuation.shape)
    arguments += [_arrays.point("bounds", corner) for corner in bounds]
    return _arrays.answer(model, "radiance_in_box", *arguments, width=attenuation.shape)


def _cosine(a: ArrayLike, b: ArrayLike) -> np.ndarray:
    """Cosine of the angle between unit vectors, in [-1, 1] in spite of rounding."""
    return np.clip(np.sum(np.multiply(a, b), axis=-1), -1, 1)
