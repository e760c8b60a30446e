"""Planets on NumPy arrays: altitudes, the horizon, and where rays meet ground and shells."""

import numpy as np
import pytest

import analytic_media as am

RADIUS = 6371.0
EARTH = am.Planet(center=(0, 0, -RADIUS), radius=RADIUS)
UP, DOWN = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)


@pytest.fixture
def rays(rng):
    o = rng.uniform((-100, -100, 0.1), (100, 100, 80), (5000, 3))
    d = rng.normal(size=(5000, 3)) * (1, 1, 0.3)
    return o, d / np.linalg.norm(d, axis=-1, keepdims=True)


def test_altitudes(rays):
    o, _ = rays
    expected = np.linalg.norm(o - EARTH.center, axis=-1) - RADIUS
    np.testing.assert_allclose(EARTH.altitude(o), expected, atol=1e-11)
    assert EARTH.altitude((0, 0, 0)) == 0
    assert EARTH.altitude((0, 0, 2.5)) == 2.5


def test_single_precision_tells_metres_apart():
    """Near the origin; subtracting the radius from the distance is half a kilometre off in m."""
    planet = am.Planet(center=(0, 0, -6.371e6), radius=6.371e6)
    z = np.float32([0.01, 1.25, 1700.5])
    x = np.stack([np.float32([0, 3, 2000]), 0 * z, z], -1)
    altitude = planet.altitude(x)
    assert altitude.dtype == np.float32
    np.testing.assert_allclose(altitude, planet.altitude(np.float64(x)), rtol=3e-7)


def test_rays_hit_the_ground(rays):
    o, d = rays
    t = EARTH.hit(o, d)
    below = d @ UP < 0
    assert 0.05 < np.isfinite(t).mean() < below.mean()
    hit = np.isfinite(t)
    ground = o[hit] + t[hit, None] * d[hit]
    np.testing.assert_allclose(EARTH.altitude(ground), 0, atol=1e-9)
    # Those that miss stay above.
    miss = ~hit & below
    along = np.linspace(0, 3000, 400)[:, None, None]
    assert np.all(EARTH.altitude(o[miss] + along * d[miss]) > 0)


def test_the_horizon_parts_rays(rays):
    o, d = rays
    zenith = (o - EARTH.center) / np.linalg.norm(o - EARTH.center, axis=-1, keepdims=True)
    mu = np.einsum("...i,...i", d, zenith)
    horizon = EARTH.horizon(o)
    clear = np.abs(mu - horizon) > 1e-12
    assert np.array_equal((mu < horizon)[clear], np.isfinite(EARTH.hit(o, d))[clear])


def test_shells(rays):
    o, d = rays
    enter, leave = EARTH.shell(o, d, 100)
    assert np.all(enter == 0)
    np.testing.assert_allclose(EARTH.altitude(o + leave[:, None] * d), 100, rtol=1e-10)
    enter, leave = EARTH.shell((0, 0, 400), DOWN, [100, 500, -7000])
    assert np.array_equal(enter, [300, 0, np.inf])
    assert np.array_equal(leave, [2 * RADIUS + 500, 2 * RADIUS + 900, np.inf])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (((0, 0, 0), 0), "radius must be finite and > 0, got 0.0"),
        (((0, 0, np.nan), 1), "center must be finite, got [0.0, 0.0, NaN]"),
        (((0, 0), 1), "center must be 3 numbers"),
        (((0, 0, 0), (1, 2)), "radius must be a number"),
    ],
)
def test_bad_planets(arguments, message):
    with pytest.raises(ValueError, match=message.replace("[", r"\[")):
        am.Planet(*arguments)


def test_bad_rays():
    with pytest.raises(ValueError, match="d must be a unit vector"):
        EARTH.hit((0, 0, 0), (0, 0, 2))
    with pytest.raises(ValueError, match="altitude must be finite"):
        EARTH.shell((0, 0, 0), UP, np.inf)
