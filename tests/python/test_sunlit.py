"""Fog in the sun on NumPy and Dr.Jit arrays, against SciPy's quadrature of the definition."""

import numpy as np
import pytest
from scipy.integrate import quad

import analytic_media as am

H = 20.0
FOG = am.Exponential(scale_height=H, base_height=5)
SIGMA_S, SIGMA_T = (0.01, 0.02, 0.03), (0.012, 0.03, 0.03)
EYE = np.array((3.0, -2.0, 9.0))
HORIZONTAL, SLANT = np.array((1.0, 0, 0)), np.array((0.6, 0, 0.8))
DIRECTIONS = np.array((HORIZONTAL, SLANT, (0.6, 0, -0.8), (0.0, 0, 1), (0.28, 0.96, 0)))
SUNS = np.array(((0.0, 0.6, 0.8), (0.6, 0, 0.8), (0.8, 0, 0.6), (0, 0.0, 1)))


def integral(profile, sigma_s, sigma_t, direction, t, sun):
    """sigma_s times the integral of density and transmittances, from the columns of `profile`."""

    def scattered(s):
        point = EYE + s * direction
        column = profile.column(EYE, direction, s) + profile.column(point, sun, np.inf)
        return profile.density(point) * np.exp(-sigma_t * column)

    return sigma_s * quad(scattered, 0, t, epsabs=0, epsrel=1e-13, limit=200)[0]


@pytest.mark.parametrize("t", [1e-6, 40.0, 150.0])
def test_radiances_are_the_integral(t):
    got = am.sunlit_fog(FOG, SIGMA_S, SIGMA_T, EYE, DIRECTIONS[:, None], t, SUNS, phase=1)
    assert got.shape == (5, 4, 3)
    for i, direction in enumerate(DIRECTIONS):
        for k, sun in enumerate(SUNS):
            for channel in range(3):
                sigma = SIGMA_S[channel], SIGMA_T[channel]
                expected = integral(FOG, *sigma, direction, t, sun)
                np.testing.assert_allclose(got[i, k, channel], expected, rtol=1e-12)


def test_constant_fog():
    """The irradiance is that at the eye: surfaces of the same are perpendicular to the light."""
    sigma_s, sigma_t, t = 0.02, 0.05, 60.0
    got = am.sunlit_fog(am.Constant(), sigma_s, sigma_t, EYE, DIRECTIONS[:, None], t, SUNS, phase=1)
    for i, direction in enumerate(DIRECTIONS):
        for k, sun in enumerate(SUNS):
            rate = sigma_t * (1 - direction @ sun)
            expected = quad(lambda s, rate=rate: sigma_s * np.exp(-rate * s), 0, t, epsrel=1e-13)[0]
            np.testing.assert_allclose(got[i, k], expected, rtol=1e-12)


def test_the_sun_sets():
    suns = [(1, 0, 0), (0.8, 0, -0.6)]
    assert np.all(am.sunlit_fog(FOG, 0.01, 0.02, EYE, HORIZONTAL, [[1], [np.inf]], suns) == 0)


def test_phase_functions():
    def radiance(phase):
        return am.sunlit_fog(FOG, SIGMA_S, SIGMA_T, EYE, DIRECTIONS, 30, SLANT, phase)

    cosine = DIRECTIONS @ SLANT
    g = 0.6
    henyey_greenstein = (1 - g**2) / (1 + g**2 - 2 * g * cosine) ** 1.5 / (4 * np.pi)
    by_value = radiance(henyey_greenstein)
    np.testing.assert_array_equal(
        radiance(lambda mu: (1 - g**2) / (1 + g**2 - 2 * g * mu) ** 1.5 / (4 * np.pi)), by_value
    )
    # Forward scattering is into the sun.
    assert by_value[1, 0] / radiance(1)[1, 0] == henyey_greenstein.max()
    isotropic = am.sunlit_fog(FOG, SIGMA_S, SIGMA_T, EYE, DIRECTIONS, 30, SLANT)
    np.testing.assert_allclose(isotropic, radiance(1) / (4 * np.pi), rtol=1e-15)


def test_shapes_and_types():
    single = am.sunlit_fog(FOG, 0.01, 0.02, np.float32(EYE), np.float32(DIRECTIONS), 30, SLANT)
    assert single.shape == (5,) and single.dtype == np.float64
    arrays = [np.float32(x) for x in (EYE, DIRECTIONS, 30, SLANT, 0.25)]
    single = am.sunlit_fog(FOG, SIGMA_S, SIGMA_T, *arrays)
    double = am.sunlit_fog(FOG, SIGMA_S, SIGMA_T, *(np.float64(x) for x in arrays))
    assert single.shape == (5, 3) and single.dtype == np.float32
    np.testing.assert_allclose(single, double, rtol=1e-5)
    assert np.ndim(am.sunlit_fog(FOG, 0.01, 0.02, EYE, SLANT, 30, SLANT)) == 0


def test_drjit(llvm):
    """Values of every channel, and derivatives by the scale height and the length."""
    import drjit as dr

    def polar(cosine):
        return 1 + cosine * cosine

    scale_height, t = llvm.Float(H), llvm.Float(30)
    dr.enable_grad(scale_height, t)
    fog = am.jit.Profile(FOG, scale_height=scale_height)
    direction = llvm.Array3f(np.float32(DIRECTIONS.T))
    ray = EYE.tolist(), direction, t
    got = am.jit.sunlit_fog(fog, SIGMA_S, SIGMA_T, *ray, SUNS[0].tolist(), polar)
    expected = am.sunlit_fog(FOG, SIGMA_S, SIGMA_T, EYE, DIRECTIONS, 30, SUNS[0], polar)
    for channel in range(3):
        np.testing.assert_allclose(got[channel].numpy(), expected[:, channel], rtol=1e-5)
    alone = am.jit.sunlit_fog(FOG, 0.02, 0.03, *ray, SUNS[0].tolist(), polar)
    np.testing.assert_allclose(alone.numpy(), expected[:, 1], rtol=1e-5)
    with pytest.raises(ValueError, match="must have the same number of channels"):
        am.jit.sunlit_fog(FOG, 0.02, SIGMA_T, *ray, SUNS[0].tolist())

    def by_differences(step):
        def at(sign):
            profile = am.Exponential(scale_height=H + sign * step[0], base_height=5)
            end = 30 + sign * step[1]
            return am.sunlit_fog(profile, 0.02, 0.03, EYE, DIRECTIONS, end, SUNS[0], polar).sum()

        return (at(1) - at(-1)) / (2 * max(step))

    dr.backward(dr.sum(got[1]))
    np.testing.assert_allclose(scale_height.grad[0], by_differences((1e-4, 0)), rtol=1e-4)
    np.testing.assert_allclose(t.grad[0], by_differences((0, 1e-4)), rtol=1e-4)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"profile": am.Linear(gradient=-1, density=1)}, 'constant or exponential, got "linear"'),
        ({"profile": "fog"}, "profile must be a profile, got 'fog'"),
        ({"sigma_s": -1}, "sigma_s must be finite and >= 0, got -1.0"),
        ({"sigma_t": np.inf}, "sigma_t must be finite and >= 0, got inf"),
        ({"sigma_s": (1, 2)}, r"sigma_s and sigma_t must have the same shape, got \(2,\) and \(\)"),
        ({"sigma_s": []}, "sigma_s must be a number or a sequence"),
        ({"direction": (1, 1, 0)}, "direction must be a unit vector"),
        ({"sun_direction": (0, 0, 2)}, "sun_direction must be a unit vector"),
        ({"t": -1}, "t must be >= 0 and may be infinite, got -1.0"),
        ({"phase": np.nan}, "phase must be finite, got nan"),
    ],
)
def test_bad_arguments_are_named(change, message):
    arguments = {
        "profile": FOG,
        "sigma_s": 0.01,
        "sigma_t": 0.02,
        "eye": EYE,
        "direction": SLANT,
        "t": 1,
        "sun_direction": SLANT,
    }
    with pytest.raises(ValueError, match=message):
        am.sunlit_fog(**{**arguments, **change})


def test_a_box_is_lit_through_its_sides():
    """A ray across a box, the sun in the zenith: the way of light is the same everywhere, and the
    air-light (1 - exp(-sigma_t t)) exp(-sigma_t h) of an albedo of 1, times the phase function."""
    corners = (-3, -3, 0), [(3, 3, 2), (3, 3, 5)]
    got = am.sunlit_fog(
        am.Constant(), 0.5, 0.5, (-2, 0, 1), (1, 0, 0), 4, (0, 0, 1), phase=1, bounds=corners
    )
    expected = (1 - np.exp(-0.5 * 4)) * np.exp(-0.5 * np.array([1, 4]))
    np.testing.assert_allclose(got, expected, rtol=1e-14)


def test_a_box_needs_a_constant_fog():
    with pytest.raises(ValueError, match='profile must be constant in a box, got "exponential"'):
        am.sunlit_fog(
            am.Exponential(scale_height=2), 0.5, 0.5, (0, 0, 1), (1, 0, 0), 1, (0, 0, 1),
            bounds=((-3, -3, 0), (3, 3, 2)),
        )  # fmt: skip
