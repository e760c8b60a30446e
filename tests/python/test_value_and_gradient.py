"""Values with their derivatives, on NumPy arrays: against differences of the values themselves."""

import numpy as np
import pytest

import analytic_media as am

UP = (0.0, 0.0, 1.0)
PROFILES = [
    am.Constant(),
    am.Linear(gradient=0.1, density=1.5, base_height=0.3, up=(0.0, 0.6, 0.8)),
    am.Exponential(scale_height=3, base_height=0.3, up=(0.0, 0.6, 0.8)),
    am.Spherical(center=(0.1, 0.2, -30), radius=29, scale_height=4),
    am.Tent(center=(0.1, 0.2, -30), radius=29, height=1.5, width=60),
    am.Gaussian(center=(0.4, -0.2, 1), sigma=4),
    am.AnisotropicGaussian(
        center=(0.4, -0.2, 1), axis_u=(3, 0, 0), axis_v=(0, 4, 0), axis_w=(0, 0, 5)
    ),
    am.RadialGaussian(center=(0.1, 0.2, -30), radius=29, scale_height=4),
]
FOG = am.Exponential(scale_height=8)
HAZE = am.Spherical(center=(0, 0, -50), radius=50, scale_height=5)
GREY = am.Medium([(FOG, 0.2), (HAZE, 0.1)])
RGB = am.Medium([(FOG, (0.2, 0.3, 0.4)), (HAZE, (0.1, 0, 0.2))])


def name(profile):
    return type(profile).__name__


def moved(profile, parameter, index, step):
    """`profile` with a component of a parameter moved."""
    values = dict(profile.parameters)
    if index is None:
        values[parameter] += step
    else:
        vector = list(values[parameter])
        vector[index] += step
        values[parameter] = tuple(vector)
    return type(profile)(**values)


def difference(f, step=1e-5):
    return (f(step) - f(-step)) / (2 * step)


def close(got, expected, scale):
    np.testing.assert_allclose(got, expected, rtol=1e-6, atol=1e-6 * np.max(np.abs(scale)))


@pytest.mark.parametrize("profile", PROFILES, ids=name)
def test_columns_have_the_derivatives_of_differences(rays, profile):
    o, d = rays
    value, gradient = profile.column_value_and_gradient(o, d, 3.0)
    np.testing.assert_allclose(value, profile.column(o, d, 3.0), rtol=1e-13)
    assert list(gradient) == [*_parameters(profile), "o", "d", "t"]
    close(gradient["t"], difference(lambda h: profile.column(o, d, 3.0 + h)), value)
    for i in range(3):
        e = np.eye(3)[i]
        close(
            gradient["o"][:, i], difference(lambda h, e=e: profile.column(o + h * e, d, 3.0)), value
        )
    for parameter in profile.parameters:
        by = gradient[parameter]
        if parameter == "up" or parameter.startswith("axis"):
            assert by.shape == value.shape + (3,)
        elif by.ndim == value.ndim:
            f = lambda h, p=parameter: moved(profile, p, None, h).column(o, d, 3.0)  # noqa: E731
            close(by, difference(f), value)
        else:
            for i in range(3):
                f = lambda h, p=parameter, i=i: moved(profile, p, i, h).column(o, d, 3.0)  # noqa: E731
                close(by[:, i], difference(f), value)


def _parameters(profile):
    """Names in the order in which the library passes them."""
    return [p.name for p in profile._kind.parameters]


@pytest.mark.parametrize("profile", PROFILES, ids=name)
def test_turning_a_ray_uses_the_part_across_it(rays, profile):
    o, d = rays
    _, gradient = profile.column_value_and_gradient(o, d, 3.0)
    side = np.cross(d, (0.3, -0.5, 0.7))
    side /= np.linalg.norm(side, axis=-1, keepdims=True)

    def turned(angle):
        return profile.column(o, np.cos(angle) * d + np.sin(angle) * side, 3.0)

    expected = difference(turned)
    close(np.sum(gradient["d"] * side, axis=-1), expected, profile.column(o, d, 3.0))


@pytest.mark.parametrize("profile", PROFILES, ids=name)
def test_along_the_ray_there_is_nothing_new(rays, profile):
    o, d = rays
    value, gradient = profile.column_value_and_gradient(o, d, 3.0)
    start, end = profile.density(o), profile.density(o + 3 * d)
    scale = np.maximum(np.maximum(start, end), value) + 1e-300
    by_o = np.sum(gradient["o"] * d, axis=-1)
    by_d = np.sum(gradient["d"] * d, axis=-1)
    np.testing.assert_allclose((by_o - (end - start)) / scale, 0, atol=1e-11)
    np.testing.assert_allclose((by_d - (3 * end - value)) / scale, 0, atol=1e-11)


@pytest.mark.parametrize("profile", PROFILES, ids=name)
def test_inverses_are_implicit(rays, profile):
    o, d = rays
    column = 0.5 * profile.column(o, d, 3.0)
    t, gradient = profile.inv_column_value_and_gradient(o, d, column)
    np.testing.assert_array_equal(t, profile.inv_column(o, d, column))
    _, forward = profile.column_value_and_gradient(o, d, np.where(np.isfinite(t), t, 0))
    density = forward.pop("t")
    some = density > 0
    np.testing.assert_allclose(gradient["column"][some], 1 / density[some], rtol=1e-13)
    for key, by in forward.items():
        rho = density.reshape(density.shape + (1,) * (by.ndim - density.ndim))[some]
        np.testing.assert_allclose(gradient[key][some], -by[some] / rho, rtol=1e-12, atol=1e-300)


def test_optical_depths_sum_their_components(rays):
    o, d = rays
    tau, gradient = RGB.optical_depth_value_and_gradient(o, d, 3.0)
    np.testing.assert_allclose(tau, RGB.optical_depth(o, d, 3.0), rtol=1e-13)
    parts = [p.column_value_and_gradient(o, d, 3.0) for p, _ in RGB.components]
    sigmas = [np.array(sigma) for _, sigma in RGB.components]
    for own, (column, by), sigma in zip(gradient["components"], parts, sigmas, strict=True):
        np.testing.assert_allclose(own["sigma_t"], np.repeat(column[:, None], 3, 1), rtol=1e-14)
        expected = by["scale_height"][:, None] * sigma
        np.testing.assert_allclose(own["scale_height"], expected, rtol=1e-13)
    for key in ("o", "d", "t"):
        terms = [
            by[key][:, None] * _fit(s, by[key]) for (_, by), s in zip(parts, sigmas, strict=True)
        ]
        np.testing.assert_allclose(gradient[key], sum(terms), rtol=1e-12, atol=1e-14)


def _fit(sigma, by):
    return sigma if by.ndim == 1 else sigma[:, None]


@pytest.mark.parametrize("medium", [GREY, RGB], ids=["grey", "rgb"])
def test_free_flights_have_the_derivatives_of_differences(rays, medium):
    o, d = rays
    tau = 0.5 * am.Medium([(p, np.atleast_1d(s)[-1]) for p, s in medium.components]).optical_depth(
        o, d, 4.0
    )
    channel = (medium.channels or 1) - 1
    t, gradient = medium.free_flight_value_and_gradient(o, d, np.inf, tau, channel)
    np.testing.assert_array_equal(t, medium.free_flight(o, d, np.inf, tau, channel))
    assert t.shape == gradient["tau"].shape == gradient["components"][1]["sigma_t"].shape

    def flight(h, component, parameter):
        pairs = list(medium.components)
        profile, sigma = pairs[component]
        if parameter == "sigma_t":
            own = np.atleast_1d(np.array(sigma, dtype=float))
            own[channel] += h
            pairs[component] = (profile, own if np.ndim(sigma) else own[0])
        else:
            pairs[component] = (moved(profile, parameter, None, h), sigma)
        return am.Medium(pairs).free_flight(o, d, np.inf, tau, channel)

    for component, own in enumerate(gradient["components"]):
        for parameter in ("sigma_t", "scale_height"):
            f = lambda h, c=component, p=parameter: flight(h, c, p)  # noqa: E731
            close(own[parameter], difference(f), t)
    f = lambda h: medium.free_flight(o, d, np.inf, tau * (1 + h), channel)  # noqa: E731
    close(gradient["tau"] * tau, difference(f), t)


def test_no_collision_has_no_derivative():
    t, gradient = GREY.free_flight_value_and_gradient((0, 0, 0), UP, 1.0, [0.01, 50.0])
    assert np.isfinite(t[0]) and t[1] == np.inf
    every = [gradient["o"], gradient["d"], gradient["tau"][:, None]]
    for own in gradient["components"]:
        every += [by.reshape(2, -1) for by in own.values()]
    table = np.concatenate(every, axis=1)
    assert np.all(table[1] == 0) and np.any(table[0] != 0)


def test_infinite_columns_have_no_derivative():
    value, gradient = FOG.column_value_and_gradient((0, 0, 0), [(1, 0, 0), UP], np.inf)
    assert value.tolist() == [np.inf, 8]
    assert all(np.all(by[0] == 0) for by in gradient.values())
    assert gradient["scale_height"][1] == pytest.approx(1, rel=1e-14)
    assert gradient["base_height"][1] == pytest.approx(1, rel=1e-14)


def test_scalars_and_formats():
    value, gradient = FOG.column_value_and_gradient((0, 0, 0), UP, 3.0)
    assert np.ndim(value) == 0 and np.ndim(gradient["scale_height"]) == 0
    assert gradient["up"].shape == gradient["o"].shape == (3,)
    single = np.float32
    o, d = np.zeros((5, 3), single), np.tile(np.array(UP, single), (5, 1))
    value, gradient = FOG.column_value_and_gradient(o, d, np.full(5, 3, single))
    assert value.dtype == single and all(by.dtype == single for by in gradient.values())
    with pytest.raises(ValueError, match="t must be >= 0"):
        FOG.column_value_and_gradient((0, 0, 0), UP, -1)
    with pytest.raises(ValueError, match="channel must be from 0 to 2, got 3"):
        RGB.free_flight_value_and_gradient((0, 0, 0), UP, 1, 1, channel=3)
