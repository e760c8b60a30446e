"""Paths that carry several wavelengths: probabilities and weights for an integrator.

Spectra have the shape (..., n wavelengths); all have the same n, and the rest of their shapes
broadcasts. float32 in gives float32 out, everything else is float64. A number outside its range
raises ValueError with name, range and value. Equation numbers are those of "Sampling Analytic
Participating Media"; `docs/spectral.md` has the formulas, and how an integrator uses them.

    tau = medium.optical_depth(eye, sky, t)                       # (..., n)
    q = hero_probabilities(throughput)
    throughput *= albedo * mis_weights(np.log(medium.extinction(x)) - tau, q)
"""

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _native

_CHOICES = {"rule": "event_rule", "absorption": "absorption"}  # enums of the C library


def null_collision_probabilities(
    sigma_a: ArrayLike,
    sigma_s: ArrayLike,
    majorant: ArrayLike,
    path_weights: ArrayLike | None = None,
    *,
    rule: str = "history",
    absorption: str = "sampled",
) -> tuple[np.ndarray, np.ndarray]:
    """Probabilities of the events at a collision, and what each multiplies path weights by.

    Events are 0: absorption, 1: scattering, 2: null. Returns the probabilities (..., 3), whose sum
    is 1 (Eq. 73), and the weights (..., 3, n) (Eq. 72).

    * `sigma_a`, `sigma_s` (..., n): coefficients, 1/length, finite, >= 0
    * `majorant` (...): that of the flight, the same for all wavelengths, finite, >= 0
    * `path_weights` (..., n): the weights of the path so far, finite; 1 unless given
    * `rule`: what a probability is in proportion to: "maximum", the largest coefficient of all
      wavelengths; "average", their mean; "history", their mean weighted by `path_weights`, which
      keeps the sum of the path weights
    * `absorption`: "sampled", an event at which paths end; or "weighted", in the weights of the
      other events (Eq. 74), which is right where nothing is emitted
    """
    n = _wavelengths("sigma_a", sigma_a)
    weights = [1.0] * n if path_weights is None else path_weights
    return _arrays.answers(
        None,
        "null_collision_probabilities",
        n,
        _choice("rule", rule),
        _choice("absorption", absorption),
        _arrays.spectrum("sigma_a", sigma_a, n),
        _arrays.spectrum("sigma_s", sigma_s, n),
        _arrays.unchecked("majorant", majorant),
        _arrays.spectrum("path_weights", weights, n),
        shapes=[(3,), (3, n)],
    )


def mis_weights(
    log_densities: ArrayLike, hero_probabilities: ArrayLike | None = None
) -> np.ndarray:
    """Weights of spectral multiple importance sampling (Eq. 61 to 66, corrected), (..., n).

    The density of a path under each wavelength, over the mean of all by `hero_probabilities`.
    Times contribution over density it is what the path counts at that wavelength.

    * `log_densities` (..., n): natural logarithms, below inf, -inf where a wavelength does not have
      the path; for a free flight minus the optical depth, plus the logarithm of the extinction if
      it ends in a collision. Probability densities of the wavelengths themselves are no part of it
    * `hero_probabilities` (..., n): those by which the wavelength that draws paths was chosen, in
      [0, 1], of sum 1; equal unless given

    The mean of the weights by `hero_probabilities` is 1. Only differences of logarithms count.
    """
    n = _wavelengths("log_densities", log_densities)
    heroes = [1 / n] * n if hero_probabilities is None else hero_probabilities
    (weights,) = _arrays.answers(
        None,
        "spectral_mis_weights",
        n,
        _arrays.spectrum("log_densities", log_densities, n),
        _arrays.spectrum("hero_probabilities", heroes, n),
        shapes=[(n,)],
    )
    return weights


def hero_probabilities(path_weights: ArrayLike) -> np.ndarray:
    """Probabilities in proportion to the size of `path_weights` (..., n); equal if all are 0."""
    n = _wavelengths("path_weights", path_weights)
    spectrum = _arrays.spectrum("path_weights", path_weights, n)
    (chances,) = _arrays.answers(None, "hero_probabilities", n, spectrum, shapes=[(n,)])
    return chances


def _wavelengths(name: str, value: ArrayLike) -> int:
    array = _arrays.real(value)
    if array is None or array.ndim == 0 or array.shape[-1] == 0:
        got = repr(value) if array is None else array.shape
        raise ValueError(f"{name} must have the shape (..., n wavelengths), n >= 1, got {got}")
    return array.shape[-1]


def _choice(name: str, value: str) -> int:
    choices = _native.choices(_CHOICES[name])
    if value not in choices:
        raise ValueError(f"{name} must be one of {', '.join(choices)}, got {value!r}")
    return choices[value]
