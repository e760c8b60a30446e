"""Air-light: light of a point source that a uniform medium scatters once towards the eye.

    lamp = AirLight(light=(0, 2, 0), sigma_s=(0.1, 0.2, 0.3), sigma_t=0.4, phase=Rayleigh())
    lamp.radiance(o=(-5, 0, 0), d=(1, 0, 0), t0=0, t1=20)      # per channel

    airlight(0.1, 0.4, eye=(-5, 0, 0), direction=(1, 0, 0), t0=0, t1=[1, 10, inf], light=(0, 2, 0))

Radiance is per unit intensity of the light on its axis, 1/(length² sr), and arrives at `t0`: what
lies in front of it does not count. The medium is everywhere between the light and the ray, and
nothing casts a shadow. Relative error below 1e-9, in float32 1e-4. Formulas and their errors:
`docs/airlight.md`.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _native
from .profiles import Result

Vector = Sequence[float]

# ---- Phase functions -------------------------------------------------------------------------


@dataclass(frozen=True)
class Isotropic:
    """The same in all directions: the phase function 1/(4 pi), or a light of intensity 1."""


ISOTROPIC = Isotropic()


@dataclass(frozen=True)
class Rayleigh:
    """Phase function of particles that are small against the wavelength."""


@dataclass(frozen=True)
class HenyeyGreenstein:
    """Phase function of Henyey and Greenstein; `g` in (-1, 1) is its mean cosine, > 0 forward."""

    g: float


Phase = Isotropic | Rayleigh | HenyeyGreenstein

# ---- Intensities -----------------------------------------------------------------------------


@dataclass(frozen=True)
class Lobes:
    """Intensity cos(theta)**exponent, an even number: two lobes. theta is the angle from `axis`."""

    exponent: int
    axis: Vector


@dataclass(frozen=True)
class Spot:
    """Intensity max(0, cos(theta))**exponent, a whole number: one lobe."""

    exponent: int
    axis: Vector


@dataclass(frozen=True)
class Cone:
    """Intensity 1 up to `beam_width`, then linear in theta down to 0 at `cutoff_angle`, radians.

    The emitter `spot` of Mitsuba, whose defaults are 20 degrees and three quarters of that.
    """

    axis: Vector
    cutoff_angle: float = math.radians(20)
    beam_width: float | None = None


Intensity = Isotropic | Lobes | Spot | Cone

# ---- A light in a medium ---------------------------------------------------------------------


class AirLight:
    """A point light in a uniform medium: what rays are asked for.

    * `light`: position, three finite lengths
    * `sigma_s`, `sigma_t`: scattering and extinction coefficient, 1/length, finite and >= 0:
      numbers, or sequences with one per channel. Results then have one axis more, at the end.
    * `phase`: Isotropic, Rayleigh, HenyeyGreenstein, or a function of the cosine of the angle of
      scattering (1 is forward), a number, of integral 1 over the sphere
    * `intensity`: Isotropic, Lobes, Spot or Cone
    """

    def __init__(
        self,
        light: Vector,
        sigma_s: float | Sequence[float],
        sigma_t: float | Sequence[float],
        phase: Phase | Callable[[float], float] = ISOTROPIC,
        intensity: Intensity = ISOTROPIC,
    ):
        given = _arrays.channels("sigma_s", sigma_s), _arrays.channels("sigma_t", sigma_t)
        try:
            pairs = np.broadcast_arrays(*given)
        except ValueError:
            raise ValueError(
                f"sigma_s and sigma_t must have the same number of channels, got {sigma_s!r} "
                f"and {sigma_t!r}"
            ) from None
        self._width = pairs[0].shape
        self._own = phase if callable(phase) else None
        known = ISOTROPIC if self._own else phase
        self._model = _native.airlight(
            describe_light(light, intensity), describe_phase(known), *(p.reshape(-1) for p in pairs)
        )

    def radiance(
        self,
        o: ArrayLike,
        d: ArrayLike,
        t0: ArrayLike,
        t1: ArrayLike,
        *,
        tolerance: ArrayLike | None = None,
        method: str | None = None,
        terms: int | None = None,
    ) -> Result:
        """Radiance towards the point at `t0` of the segment from `t0` to `t1` (Eq. 4).

        `o` and `d` are points and unit vectors (..., 3); `t0` is finite, `t1` may be infinite. 0
        where `t1` <= `t0`.

        * `tolerance`: relative error that will do, > 0, (...): saves time, ray by ray
        * `method` and `terms`, for comparisons, in double precision: "quadrature" with so many
          points (8, 16, ... 64) for each piece of a ray, or with a series of 1 to 20 terms
          "closed_form", or as the paper has them "combined", "first" and "second", whose errors
          are large in many media
        """
        segment = _segment(o, d, t0, t1)
        given = {"tolerance": tolerance, "method": method, "terms": terms}
        chosen = [name for name, value in given.items() if value is not None]
        if self._own is not None and chosen:
            raise ValueError(f"{chosen[0]} must be None for a phase function of your own")
        if chosen not in ([], ["tolerance"], ["method", "terms"]):
            raise ValueError(f"give tolerance alone, or method and terms, got {', '.join(chosen)}")
        if tolerance is not None:
            return self.estimate(o, d, t0, t1, tolerance)[0]
        if method is not None:
            return self._by(method, terms, segment)
        if self._own is None:
            return _arrays.answer(self._model, "radiance", *segment, width=self._width)
        shape, arrays = _arrays.broadcast(segment)
        channels = self._width or (1,)
        result = np.empty(shape + channels, arrays[0].dtype)
        for item in np.ndindex(*shape):
            numbers = [array[item].astype(float) for array in arrays]
            result[item] = _native.radiance_with_phase(self._model, self._own, *numbers)
        return result.reshape(shape + self._width)[()]

    def estimate(
        self, o: ArrayLike, d: ArrayLike, t0: ArrayLike, t1: ArrayLike, tolerance: ArrayLike
    ) -> tuple[Result, Result]:
        """`radiance` with a `tolerance`, and an estimate of its relative error."""
        if self._own is not None:
            raise ValueError("a phase function of your own has no estimate")
        return _arrays.answer(
            self._model,
            "radiance_within",
            *_segment(o, d, t0, t1),
            _arrays.positive("tolerance", tolerance),
            outputs=2,
            width=self._width,
        )

    def _by(self, method: str, terms: int, arguments: list[_arrays.Argument]) -> Result:
        known = _native.choices("airlight_method")
        if method not in known:
            raise ValueError(f"method must be one of {', '.join(known)}, got {method!r}")
        shape, arrays = _arrays.broadcast(arguments)
        double = [np.ascontiguousarray(array, np.float64) for array in arrays]
        result = np.empty(shape + (self._width or (1,)))
        _native.radiance_by(self._model, known[method], terms, double, result)
        return result.reshape(shape + self._width)[()]


def _segment(o, d, t0, t1) -> list[_arrays.Argument]:
    """Part of a ray, from `t0` to `t1`."""
    ray = _arrays.point("o", o), _arrays.direction("d", d)
    return [*ray, _arrays.number("t0", t0), _arrays.limit("t1", t1)]


def describe_light(position, intensity: Intensity) -> dict:
    """The fields of `am_light`."""
    fields = {"position": list(position), "axis": [0, 0, 1], "exponent": 0}
    fields |= {"cutoff_angle": 1, "beam_width": 0}
    match intensity:
        case Isotropic():
            return fields | {"kind": "isotropic"}
        case Lobes(exponent, axis) | Spot(exponent, axis):
            kind = type(intensity).__name__.lower()
            return fields | {"kind": kind, "exponent": exponent, "axis": list(axis)}
        case Cone(axis, cutoff, beam):
            beam = 0.75 * cutoff if beam is None else beam
            angles = {"cutoff_angle": cutoff, "beam_width": beam}
            return fields | {"kind": "cone", "axis": list(axis)} | angles
    raise ValueError(f"intensity must be Isotropic, Lobes, Spot or Cone, got {intensity!r}")


def describe_phase(phase: Phase) -> dict:
    """The fields of `am_phase`."""
    match phase:
        case Isotropic():
            return {"kind": "isotropic", "g": 0}
        case Rayleigh():
            return {"kind": "rayleigh", "g": 0}
        case HenyeyGreenstein(g):
            return {"kind": "henyey_greenstein", "g": g}
    raise ValueError(
        "phase must be Isotropic, Rayleigh, HenyeyGreenstein or a function of the cosine, "
        f"got {phase!r}"
    )


def airlight(
    kappa_s: ArrayLike,
    kappa_t: ArrayLike,
    eye: ArrayLike,
    direction: ArrayLike,
    t0: ArrayLike,
    t1: ArrayLike,
    light: ArrayLike,
    phase: Phase | Callable[[float], float] = ISOTROPIC,
    intensity: Intensity = ISOTROPIC,
    *,
    tolerance: float | None = None,
    method: str | None = None,
    terms: int | None = None,
) -> Result:
    """Radiance of a point light that a uniform medium scatters once (Eq. 4), for many of each.

    * `kappa_s`, `kappa_t`: scattering and extinction coefficient, 1/length, >= 0
    * `eye`, `direction`, `light`: points and unit vectors (..., 3)
    * `t0`, `t1`: ends of the segment; `t1` may be infinite

    All of these broadcast. `phase` and `intensity` are those of `AirLight`, which serves channels
    that differ in their coefficients alone at a lower cost; `tolerance`, a number, `method` and
    `terms` those of `AirLight.radiance`.
    """
    medium = _arrays.number("kappa_s", kappa_s), _arrays.number("kappa_t", kappa_t)
    ray = _arrays.point("o", eye)._replace(name="eye"), _arrays.direction("direction", direction)
    ends = _arrays.number("t0", t0), _arrays.limit("t1", t1)
    shape, arrays = _arrays.broadcast([*medium, *ray, *ends, _arrays.point("light", light)])
    flat = [a.reshape(-1, 3) if a.ndim > len(shape) else a.reshape(-1) for a in arrays]
    scattering, extinction, eyes, directions, starts, stops, lights = flat
    # One question for all rays of the same light in the same medium.
    keys = np.column_stack([scattering, extinction, lights])
    different, which = np.unique(keys, axis=0, return_inverse=True)
    result = np.empty(len(keys), arrays[0].dtype)
    for number, (s, t, *position) in enumerate(different.tolist()):
        model = AirLight(position, s, t, phase, intensity)
        here = np.flatnonzero(which.reshape(-1) == number)
        rays = (a[here] for a in (eyes, directions, starts, stops))
        result[here] = model.radiance(*rays, tolerance=tolerance, method=method, terms=terms)
    return result.reshape(shape)[()]
