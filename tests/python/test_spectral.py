"""Weights of paths that carry several wavelengths, through NumPy.

tests/spectral.rs has the exact expectations; here they are integrators in a few lines, whose
means are closed forms to within their standard errors.
"""

import numpy as np
import pytest

import analytic_media as am
from analytic_media import spectral

SIGMA_A, SIGMA_S = np.array([0.1, 0.6, 0.0]), np.array([2.0, 0.3, 0.0])
LENGTH = 1.3

# A mean is that far from its closed form by a chance of 7e-6; all 42 of this file are within, but
# for a chance of 3e-4, if they are right.
SIGMAS = 4.5


def assert_mean(samples, expected):
    """Means of the rows of `samples` (paths, n) are `expected` to within SIGMAS standard errors."""
    error = samples.std(axis=0) / np.sqrt(len(samples))
    z = (samples.mean(axis=0) - expected) / np.maximum(error, 1e-12)
    assert np.all(np.abs(z) < SIGMAS), (samples.mean(axis=0), expected, z)


@pytest.mark.parametrize("rule", ["maximum", "average", "history"])
@pytest.mark.parametrize("absorption", ["sampled", "weighted"])
def test_tracking_through_a_slab(rng, rule, absorption):
    """Paths that scatter forwards only: transmittance and single scattering at each wavelength."""
    paths, majorant = 100_000, 2.4
    position, bounces = np.zeros(paths), np.zeros(paths, int)
    weights = np.ones((paths, 3))
    inside = np.arange(paths)
    while len(inside):
        position[inside] += rng.exponential(1 / majorant, len(inside))
        inside = inside[position[inside] < LENGTH]
        chances, factors = spectral.null_collision_probabilities(
            SIGMA_A, SIGMA_S, majorant, weights[inside], rule=rule, absorption=absorption
        )
        event = (rng.random((len(inside), 1)) >= np.cumsum(chances, axis=-1)[:, :2]).sum(axis=-1)
        weights[inside] *= factors[np.arange(len(inside)), event]
        bounces[inside] += event == 1
        weights[inside[event == 0]] = 0
        inside = inside[(event != 0) & (weights[inside].max(axis=-1) > 0)]
    through = np.exp(-(SIGMA_A + SIGMA_S) * LENGTH)
    assert_mean(weights * (bounces == 0)[:, None], through)
    assert_mean(weights * (bounces == 1)[:, None], through * SIGMA_S * LENGTH)
    if rule == "history":
        assert weights.sum(axis=-1).max() < 3 * (1 + 1e-12)


def test_a_flight_for_all_wavelengths(rng):
    """Flights of a hero through a slab collide and pass at each wavelength as they should."""
    sigma_t, n = np.array([0.3, 2.0, 0.05]), 100_000
    throughput = np.array([1.0, 0.25, 3.0])
    heroes = spectral.hero_probabilities(throughput)
    np.testing.assert_allclose(heroes, throughput / 4.25)
    hero = rng.choice(3, n, p=heroes)
    t = rng.exponential(1 / sigma_t[hero])
    collides = t < LENGTH
    depth = sigma_t * np.minimum(t, LENGTH)[:, None]
    logs = np.where(collides[:, None], np.log(sigma_t), 0) - depth
    weights = spectral.mis_weights(logs, heroes)
    np.testing.assert_allclose(weights @ heroes, 1, rtol=1e-14)
    passed = np.exp(-sigma_t * LENGTH)
    assert_mean(weights * ~collides[:, None], passed)
    assert_mean(weights * collides[:, None], 1 - passed)


def test_large_optical_depths():
    tau = np.array([[0.0, 1.0, 200.0], [1000.0, 1001.0, 1200.0]])
    weights = spectral.mis_weights(-tau)
    np.testing.assert_allclose(weights[1], weights[0], rtol=1e-12)
    np.testing.assert_allclose(weights.mean(axis=-1), 1, rtol=1e-14)
    single = spectral.mis_weights(-tau.astype(np.float32))
    np.testing.assert_allclose(single, weights, rtol=1e-6, atol=1e-30)
    assert spectral.mis_weights([-np.inf, -900.0]).tolist() == [0, 2]


def test_example_of_the_documentation():
    """Coefficients over the majorant are 1/4 and 0, 1/2 and 1/4, 1/4 and 3/4."""
    chances, weights = spectral.null_collision_probabilities([0.25, 0], [0.5, 0.25], 1, [1, 3])
    np.testing.assert_allclose(chances, [1 / 16, 5 / 16, 10 / 16])
    np.testing.assert_allclose(weights, [[4, 0], [1.6, 0.8], [0.4, 1.2]])
    chances, _ = spectral.null_collision_probabilities(
        [0.25, 0], [0.5, 0.25], 1, rule="maximum", absorption="weighted"
    )
    np.testing.assert_allclose(chances, [0, 0.4, 0.6])


def test_shapes_and_types():
    sigma = np.full((4, 1, 5), 0.1, np.float32)
    majorant = np.array([1, 2, 3], np.float32)
    chances, weights = spectral.null_collision_probabilities(sigma, sigma, majorant)
    assert chances.shape == (4, 3, 3) and weights.shape == (4, 3, 3, 5)
    assert chances.dtype == weights.dtype == np.float32
    np.testing.assert_allclose(chances.sum(axis=-1), 1, rtol=3e-7)
    np.testing.assert_allclose(chances[0, :, 0], 0.1 / majorant, rtol=1e-6)
    assert spectral.mis_weights([0.0]).tolist() == [1]
    assert spectral.mis_weights(np.zeros((7, 2)), [0.5, 0.5]).dtype == np.float64
    assert spectral.mis_weights(np.zeros((0, 2))).shape == (0, 2)
    assert spectral.hero_probabilities(np.float32([0, 0])).tolist() == [0.5, 0.5]
    # Not contiguous, and strides that are not one.
    wide = np.arange(24.0).reshape(2, 3, 4)
    for view in (wide[:, ::2, 1:3], wide[..., ::2], wide.transpose(2, 0, 1)[..., :2]):
        expected = view / view.sum(axis=-1, keepdims=True)
        np.testing.assert_allclose(spectral.hero_probabilities(view), expected)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda f: f([0, -1], [1, 1], 2),
            r"sigma_a must be finite and >= 0, got -1.0 \(wavelength",
        ),
        (lambda f: f([0, 1], [1, np.inf], 2), r"sigma_s must be finite and >= 0, got inf"),
        (lambda f: f([0, 1], [1, 1], [2, np.nan]), r"majorant .*>= 0, got NaN at item 1"),
        (lambda f: f([0, 1], [1, 1], 2, [1, np.inf]), r"path_weights must be finite, got inf"),
        (lambda f: f([0, 1], [1, 1, 1], 2), r"sigma_s must have the shape \(..., 2\), got \(3,\)"),
        (lambda f: f(0.5, [1, 1], 2), r"sigma_a must have the shape \(..., n wavelengths\)"),
        (lambda f: f([], [], 2), r"n >= 1, got \(0,\)"),
        (lambda f: f(["red"], [1], 2), r"sigma_a must have the shape"),
        (lambda f: f([0], [1], 2, rule="best"), r"maximum, average, history, got 'best'"),
        (lambda f: f([0], [1], 2, absorption="no"), r"absorption must be one of sampled, weighted"),
        (lambda _: spectral.mis_weights([0, np.inf]), r"log_densities must be a number < inf"),
        (lambda _: spectral.mis_weights([0, np.nan]), r"log_densities .*, got NaN"),
        (lambda _: spectral.mis_weights([0, 1], [0.5, 0.4]), r"must have the sum 1, got 0.9"),
        (lambda _: spectral.mis_weights([0, 1], [1.5, -0.5]), r"in \[0, 1\], got 1.5"),
        (lambda _: spectral.hero_probabilities([np.nan]), r"path_weights must be finite, got NaN"),
    ],
)
def test_bad_arguments_are_named(call, message):
    with pytest.raises(ValueError, match=message):
        call(am.spectral.null_collision_probabilities)
