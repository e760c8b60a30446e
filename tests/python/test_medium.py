"""Media on NumPy arrays: sums of profiles, channels, and free flight."""

import copy
import pickle

import numpy as np
import pytest

import analytic_media as am

UP = (0.0, 0.0, 1.0)
FOG = am.Exponential(scale_height=8)
HAZE = am.Constant()
LAYER = am.Linear(gradient=-0.05, density=1.2)
GREY = am.Medium([(FOG, 0.2), (HAZE, 0.01), (LAYER, 0.05)])
RGB = am.Medium([(FOG, (0.2, 0.3, 0.4)), (HAZE, (0.01, 0, 0.02))])


def test_optical_depth_is_the_sum_of_the_columns(rays):
    o, d = rays
    parts = [sigma * p.column(o, d, 7) for p, sigma in GREY.components]
    np.testing.assert_allclose(GREY.optical_depth(o, d, 7), sum(parts), rtol=1e-15)
    parts = [p.column(o, d, 7)[:, None] * np.array(sigma) for p, sigma in RGB.components]
    np.testing.assert_allclose(RGB.optical_depth(o, d, 7), sum(parts), rtol=1e-15)


def test_extinction_is_the_sum_of_the_densities(rays):
    x, _ = rays
    parts = [sigma * p.density(x) for p, sigma in GREY.components]
    np.testing.assert_allclose(GREY.extinction(x), sum(parts), rtol=1e-15)


def test_transmittance_and_opacity(rays):
    o, d = rays
    tau = RGB.optical_depth(o, d, 7)
    np.testing.assert_allclose(RGB.transmittance(o, d, 7), np.exp(-tau), rtol=1e-13)
    np.testing.assert_allclose(RGB.opacity(o, d, 7), -np.expm1(-tau), rtol=1e-13)
    thin = am.Medium([(HAZE, 1e-12)])
    assert thin.opacity((0, 0, 0), UP, 1) == pytest.approx(1e-12, rel=1e-12)


def test_no_attenuation_of_an_infinite_column_is_none():
    clear = am.Medium([(HAZE, (0.0, 1.0))])
    assert clear.optical_depth((0, 0, 0), UP, np.inf).tolist() == [0, np.inf]
    assert clear.transmittance((0, 0, 0), UP, np.inf).tolist() == [1, 0]


def test_shapes(rays):
    o, d = rays
    assert GREY.channels is None and RGB.channels == 3
    assert GREY.transmittance(o, d, 1).shape == (200,)
    assert RGB.transmittance(o, d, 1).shape == (200, 3)
    assert RGB.transmittance((0, 0, 0), UP, 1).shape == (3,)
    assert RGB.transmittance(o[:, None], d[:, None], [1, 2]).shape == (200, 2, 3)
    assert RGB.free_flight(o, d, 10, 1).shape == (200,)
    assert am.Medium([(HAZE, [1.0])]).transmittance(o, d, 1).shape == (200, 1)
    minorant, majorant = RGB.bounds_box([[0, 0, 0]] * 4, (1, 1, 1))
    assert minorant.shape == majorant.shape == (4, 3)
    assert RGB.pdf_within(np.float32(o), np.float32(d), 9, 1).dtype == np.float32


@pytest.mark.parametrize("dtype", [np.float64, np.float32], ids=["f64", "f32"])
def test_free_flight_inverts_the_optical_depth(rays, rng, dtype):
    o, d = (a.astype(dtype) for a in rays)
    tau = -np.log1p(-rng.uniform(size=200)).astype(dtype)
    for medium, channel in ((GREY, None), (RGB, 2)):
        t = medium.free_flight(o, d, 8, tau, channel=channel or 0)
        total = medium.optical_depth(o, d, 8)
        got = medium.optical_depth(o, d, np.where(np.isinf(t), 0, t))
        if channel is not None:
            total, got = total[:, channel], got[:, channel]
        hit = np.isfinite(t)
        assert 0.1 < hit.mean() < 0.99
        assert np.all(t[hit] <= 8)
        target = 1e-12 if dtype == np.float64 else 2e-6
        assert np.all(np.abs(got - tau)[hit] <= 3 * target * np.maximum(1, tau)[hit])
        assert np.all(tau[~hit] >= total[~hit] * (1 - target))


def test_free_flight_of_zero_and_beyond():
    assert GREY.free_flight((0, 0, 0), UP, 10, 0) == 0
    assert GREY.free_flight((0, 0, 0), UP, 10, np.inf) == np.inf
    assert GREY.free_flight((0, 0, 0), UP, 0, 1) == np.inf
    assert am.Medium([(FOG, 0.0)]).free_flight((0, 0, 0), UP, np.inf, 1e-9) == np.inf
    assert am.Medium([(HAZE, 2.0)]).free_flight((0, 0, 0), UP, np.inf, 3) == 1.5


def test_pdf_is_that_of_the_free_flight():
    """∫ pdf = opacity, and with pdf_within 1; pdf = -dT/dt."""
    o, d, t_max = (0, 0, 1), (0.6, 0, 0.8), 12.0
    nodes, weights = np.polynomial.legendre.leggauss(60)
    t, w = (nodes + 1) * t_max / 2, weights * t_max / 2
    np.testing.assert_allclose(w @ RGB.pdf(o, d, t), RGB.opacity(o, d, t_max), rtol=1e-12)
    np.testing.assert_allclose(w @ RGB.pdf_within(o, d, t_max, t), 1, rtol=1e-12)
    step = 1e-5
    slope = RGB.transmittance(o, d, t - step) - RGB.transmittance(o, d, t + step)
    np.testing.assert_allclose(RGB.pdf(o, d, t), slope / (2 * step), rtol=1e-6)
    assert np.all(RGB.pdf(o, d, np.inf) == 0)
    assert np.all(RGB.pdf_within(o, d, t_max, t_max + 1) == 0)


def test_bounds_contain_the_extinction(rays, rng):
    o, d = rays
    inf, sup = RGB.bounds(o, d, 9)
    extinction = RGB.extinction(o + rng.uniform(0, 9, (50, 200, 1)) * d)
    assert np.all((inf <= extinction) & (extinction <= sup))
    lo, hi = np.minimum(o, o + d), np.maximum(o, o + d)
    inf, sup = RGB.bounds_box(lo, hi)
    extinction = RGB.extinction(lo + rng.uniform(size=(50, 200, 3)) * (hi - lo))
    assert np.all((inf <= extinction) & (extinction <= sup))


def test_media_are_values():
    for medium in (GREY, RGB):
        assert pickle.loads(pickle.dumps(medium)) == medium == copy.deepcopy(medium)
        assert hash(copy.copy(medium)) == hash(medium)
        assert eval(repr(medium), vars(am)) == medium
    assert GREY != RGB
    assert GREY.components[0] == (FOG, 0.2) and RGB.components[0] == (FOG, (0.2, 0.3, 0.4))
    with pytest.raises(AttributeError, match="cannot be changed"):
        GREY.components = ()
