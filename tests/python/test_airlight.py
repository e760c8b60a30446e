"""Air-light and exponential integrals against the reference tables, through NumPy and recorded.

All rows of airlight.json, to 1e-9 in double and 1e-4 in single precision, and of expint.json, to
1e-12 and 2e-6. Single precision is compared with double precision of the rounded arguments where it
does not hold them.
"""

import math

import numpy as np
import pytest
import rows

import analytic_media as am
from analytic_media import scattering, special
from analytic_media.scattering import Cone, HenyeyGreenstein, Isotropic, Lobes, Rayleigh, Spot

EYE, ALONG = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)


def phase(row):
    match row["phase"]["type"]:
        case "isotropic":
            return Isotropic()
        case "rayleigh":
            return Rayleigh()
        case _:
            return HenyeyGreenstein(row["phase"]["g"])


def intensity(row, axis):
    match row["light"]["type"]:
        case "isotropic":
            return Isotropic()
        case "lobes":
            return Lobes(row["light"]["p"], axis)
        case _:
            return Spot(row["light"]["p"], axis)


KEYS = ("kappa_s", "kappa_t", "h", "x_h", "x_a", "x_b")


def numbers(row, single):
    """The numbers of a row and its axis, as the format holds them."""
    values = [float(row[key]) for key in KEYS] + row["v_l"]
    rounded = np.float32(values).astype(float) if single else np.array(values)
    return [*rounded[:6], tuple(rounded[6:])]


def in_numpy(row, values, dtype):
    s, t, h, x_h, x_a, x_b, axis = values
    ray = [np.array(x, dtype) for x in (s, t, EYE, ALONG, x_a, x_b, (x_h, h, 0))]
    result = am.airlight(*ray, phase=phase(row), intensity=intensity(row, axis))
    assert result.dtype == dtype
    return float(result)


def check(row, got, expected, single):
    """What is below the least normal number of single precision may be flushed to 0."""
    tolerance, least = (1e-4, 1.2e-38) if single else (1e-9, 0)
    assert math.isfinite(got)
    assert abs(got - expected) <= max(tolerance * expected, least), (got, expected, row)


def test_rows_in_double_precision():
    for row in rows.read("airlight"):
        check(row, in_numpy(row, numbers(row, False), np.float64), float(row["L"]), False)


def test_rows_in_single_precision():
    for row in rows.read("airlight"):
        values = numbers(row, True)
        expected = in_numpy(row, values, np.float64)
        check(row, in_numpy(row, values, np.float32), expected, True)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5, 1e-7])
def test_rows_within_a_tolerance(tolerance):
    """Two rows of 420 may miss it: tests/airlight_methods.rs has counts and worst errors."""
    missed, below = 0, 0
    for row in rows.read("airlight"):
        s, t, h, x_h, x_a, x_b, axis = numbers(row, False)
        expected = float(row["L"])
        ray = EYE, ALONG, x_a, x_b
        lamp = am.AirLight((x_h, h, 0), s, t, phase(row), intensity(row, axis))
        got, error = lamp.estimate(*ray, tolerance)
        assert got == lamp.radiance(*ray, tolerance=tolerance)
        assert error <= tolerance
        missed += abs(got - expected) > tolerance * expected
        below += abs(got - expected) > max(error, 1e-11) * expected
    assert missed <= 2
    assert below <= 0.05 * 420


def test_a_tolerance_is_that_of_its_ray():
    """Lanes of a batch take what the worst of them needs, so each ray keeps its own."""
    tolerance = np.array([1e-2, 1e-4, 1e-6, 1e-8] * 3)
    ends = np.linspace(1, 12, 12)
    lamp = am.AirLight((4, 0.3, 0), [0.1, 0.2], [0.5, 2], HenyeyGreenstein(0.9))
    exact = lamp.radiance(EYE, ALONG, 0, ends)
    got, error = lamp.estimate(EYE, ALONG, 0, ends, tolerance)
    assert got.shape == error.shape == (12, 2)
    assert np.all(abs(got - exact) <= tolerance[:, None] * exact)
    assert np.all(error <= tolerance[:, None])
    single = lamp.radiance(np.float32(EYE), np.float32(ALONG), np.float32(0), np.float32(ends))
    loose = am.airlight(0.1, 0.5, EYE, ALONG, 0, ends, (4, 0.3, 0), HenyeyGreenstein(0.9),
                        tolerance=1e-3)  # fmt: skip
    np.testing.assert_allclose(loose, exact[:, 0], rtol=1e-3)
    np.testing.assert_allclose(single, exact, rtol=1e-4)


@pytest.mark.parametrize(
    ("method", "terms", "tolerance"),
    [
        ("quadrature", 8, 1e-2),
        ("quadrature", 48, 1e-12),
        ("closed_form", 6, 1e-2),
        ("closed_form", 20, 1e-4),
        ("combined", 6, 1e-2),
    ],
)
def test_methods(method, terms, tolerance):
    """All agree where the paper's formulas are at their best: H of order 1, a smooth function."""
    lamp = am.AirLight((2, 1.5, 0), [0.1, 0.3], [0.6, 0.9], Rayleigh())
    ends = np.array([[1.0, 3.0], [6.0, np.inf]])
    exact = lamp.radiance(EYE, ALONG, 0, ends)
    got = lamp.radiance(EYE, ALONG, 0, ends, method=method, terms=terms)
    assert got.shape == (2, 2, 2)
    np.testing.assert_allclose(got, exact, rtol=tolerance)


def test_the_first_reformulation_is_wrong_beyond_the_light():
    """Before it, v < 1 and it is the combined one; beyond it, v grows and its series diverges."""
    before, beyond = (
        {
            method: am.airlight(0.1, 0.6, EYE, ALONG, 0, end, (2, 1.5, 0), phase=Rayleigh(),
                                method=method, terms=6)
            for method in ("first", "combined")
        }
        for end in (2, 9)
    )  # fmt: skip
    assert before["first"] == before["combined"]
    exact = am.airlight(0.1, 0.6, EYE, ALONG, 0, 9, (2, 1.5, 0), phase=Rayleigh())
    assert abs(beyond["first"] / exact - 1) > 10 * abs(beyond["combined"] / exact - 1)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"tolerance": 0}, "tolerance must be finite and > 0, got 0.0"),
        ({"tolerance": 1e-3, "method": "first"}, "give tolerance alone, or method and terms"),
        ({"method": "first"}, "give tolerance alone, or method and terms, got method"),
        ({"method": "third", "terms": 6}, "method must be one of quadrature, closed_form, "),
        ({"method": "quadrature", "terms": 9}, "terms must be a multiple of 8 in"),
        ({"method": "combined", "terms": 21}, r"terms must be in \[1, 20\], got 21"),
        ({"tolerance": 1e-3, "phase": abs}, "tolerance must be None for a phase function"),
    ],
)
def test_bad_choices(options, message):
    with pytest.raises(ValueError, match=message):
        am.airlight(0.1, 0.6, EYE, ALONG, 0, 2, (2, 1.5, 0), **options)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # NumPy's, as a host
@pytest.mark.parametrize("host", ["NumPy", "llvm_ad_rgb"])
def test_rows_recorded(request, host):
    """Rows of the same kinds, and exponents, are lanes of one recording."""
    single = host == "llvm_ad_rgb"
    number = request.getfixturevalue("llvm").Float if single else np.asarray
    own = None if single else am.jit.Host(np, np.float64, 53)
    groups = {}
    for row in rows.read("airlight"):
        key = row["phase"]["type"], row["light"]["type"], row["light"].get("p")
        groups.setdefault(key, []).append(row)
    for selected in groups.values():
        values = [numbers(row, single) for row in selected]
        s, t, h, x_h, x_a, x_b = (number([v[i] for v in values]) for i in range(6))
        axis = tuple(number([v[6][i] for v in values]) for i in range(3))
        kind = phase(selected[0])
        if isinstance(kind, HenyeyGreenstein):
            kind = HenyeyGreenstein(number([row["phase"]["g"] for row in selected]))
        recorded = am.jit.AirLight((x_h, h, 0), s, t, kind, intensity(selected[0], axis), host=own)
        got = np.array(recorded.radiance(EYE, ALONG, x_a, x_b), dtype=float)
        for row, value, found in zip(selected, values, got, strict=True):
            expected = in_numpy(row, value, np.float64) if single else float(row["L"])
            check(row, found, expected, single)


def test_arguments_broadcast():
    """A grid of extinctions, rays and lights is the same as one at a time."""
    extinction = np.array([0.1, 2.0]).reshape(2, 1, 1)
    ends = np.array([1.0, 5.0, np.inf]).reshape(3, 1)
    lights = np.array([[0, 2, 0], [3, 0.1, 1], [-1, 1, 0], [2, -1, 0.5]])
    grid = am.airlight(0.1, extinction, EYE, ALONG, 0, ends, lights)
    assert grid.shape == (2, 3, 4)
    for i, j, k in np.ndindex(grid.shape):
        one = am.airlight(0.1, extinction[i, 0, 0], EYE, ALONG, 0, ends[j, 0], lights[k])
        assert one == pytest.approx(grid[i, j, k], rel=1e-14)


def test_channels_are_those_of_one_at_a_time():
    """Channels share their points: those of the thinnest."""
    sigma_s, sigma_t = (0.1, 0.2, 0.3), (0.1, 0.4, 1.5)
    lamp = am.AirLight((1, 2, 0), sigma_s, sigma_t, HenyeyGreenstein(0.8))
    got = lamp.radiance(np.zeros((4, 3)), ALONG, 0, [0.5, 1, 7, np.inf])
    assert got.shape == (4, 3)
    for channel in range(3):
        one = am.AirLight((1, 2, 0), sigma_s[channel], sigma_t[channel], HenyeyGreenstein(0.8))
        expected = one.radiance(np.zeros((4, 3)), ALONG, 0, [0.5, 1, 7, np.inf])
        np.testing.assert_allclose(got[:, channel], expected, rtol=1e-9)


def test_own_phase_function():
    """A function of the cosine, against the same one of the library."""

    def rayleigh(cosine):
        return 3 / (16 * math.pi) * (1 + cosine**2)

    arguments = 0.3, 0.5, EYE, ALONG, 0, [1.0, np.inf], (2, 1, 0)
    got = am.airlight(*arguments, phase=rayleigh)
    np.testing.assert_allclose(got, am.airlight(*arguments, phase=Rayleigh()), rtol=1e-10)

    def broken(cosine):
        raise ArithmeticError("no value")

    with pytest.raises(ArithmeticError, match="no value"):
        am.airlight(*arguments, phase=broken)


def test_cone_is_mitsuba_s_spot(llvm):
    """Intensity along a ray past the emitter, from thin slices of a medium without extinction."""
    import mitsuba as mi

    spot = mi.load_dict(
        {
            "type": "spot",
            "cutoff_angle": 30,
            "beam_width": 20,
            "to_world": mi.ScalarTransform4f().look_at([0, 2, 0], [0.5, 0, 0], [0, 0, 1]),
        }
    )
    axis = np.array([0.5, -2, 0]) / math.hypot(0.5, 2)
    x = np.linspace(-3, 3, 61)
    at = mi.Interaction3f()
    at.p = mi.Point3f(llvm.Float(x), 0, 0)
    _, arriving = spot.sample_direction(at, mi.Point2f(0.5))
    cone = Cone(axis, math.radians(30), math.radians(20))
    origin = np.stack([x - 0.5e-6, 0 * x, 0 * x], axis=-1)
    slices = am.airlight(4 * math.pi, 0, origin, ALONG, 0, 1e-6, (0, 2, 0), intensity=cone) / 1e-6
    expected = np.array(arriving[0]) / mi.Spectrum(1.0)[0]
    ratio = slices[30] / expected[30]
    np.testing.assert_allclose(slices, ratio * expected, rtol=2e-5, atol=2e-6 * slices.max())


def test_derivatives_of_recorded_air_light(llvm):
    """By the height of the light, the extinction and g, against differences in double precision."""
    import drjit as dr

    def scene(height, extinction, g):
        return am.airlight(
            1, extinction, EYE, ALONG, 0, 6, (2, height, 0), phase=HenyeyGreenstein(g)
        )

    at = np.array([1.5, 0.4, 0.6])
    height, extinction, g = (llvm.Float(x) for x in at)
    dr.enable_grad(height, extinction, g)
    lamp = am.jit.AirLight((2, height, 0), 1, extinction, HenyeyGreenstein(g))
    dr.backward(lamp.radiance(EYE, ALONG, 0, llvm.Float(6)))
    for i, variable in enumerate((height, extinction, g)):
        step = np.zeros(3)
        step[i] = 1e-5
        expected = (scene(*(at + step)) - scene(*(at - step))) / 2e-5
        assert variable.grad[0] == pytest.approx(expected, rel=1e-3)


# ---- Exponential integrals


def complex_rows():
    return [row for row in rows.read("expint") if row["kind"] == "Ei"]


@pytest.mark.parametrize("dtype", ["complex128", "complex64"])
@pytest.mark.parametrize("function", ["expint_ei", "expint_ei_scaled"])
def test_complex_rows(function, dtype):
    scaled = function.endswith("scaled")
    keys = ("scaled_re", "scaled_im") if scaled else ("re", "im")
    for row in complex_rows():
        z = np.dtype(dtype).type(complex(row["x"], row["y"]))
        if dtype == "complex64" and not row["f32"]:
            expected = complex(getattr(am, function)(complex(z)))
        else:
            expected = complex(*(float(row[key]) for key in keys))
        limits = np.finfo(dtype)
        if not float(limits.tiny) < abs(expected) < 0.1 * float(limits.max):
            continue
        got = getattr(am, function)(z)
        assert got.dtype == dtype
        tolerance = 1e-12 if dtype == "complex128" else 2e-6
        assert abs(complex(got) - expected) <= tolerance * abs(expected), row


@pytest.mark.parametrize("host", ["NumPy", "llvm_ad_rgb"])
@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # NumPy's, as a host
def test_complex_rows_recorded(request, host):
    single = host == "llvm_ad_rgb"
    number = request.getfixturevalue("llvm").Float if single else np.asarray
    own = None if single else am.jit.Host(np, np.float64, 53)
    selected = [row for row in complex_rows() if row["f32"] or not single]
    x, y = (number([row[key] for row in selected]) for key in ("x", "y"))
    parts = am.jit.special("expint_ei_scaled", x, y, host=own)
    got = np.array(parts[0], dtype=float) + 1j * np.array(parts[1], dtype=float)
    expected = np.array([complex(row["scaled_re_f64"], row["scaled_im_f64"]) for row in selected])
    error = np.abs(got - expected) / np.abs(expected)
    assert error.max() <= (2e-6 if single else 1e-12)


def test_real_rows():
    for row in rows.read("expint"):
        if row["kind"] == "E1":
            assert special.expint_e1_scaled(row["x"]) == pytest.approx(
                row["exp_x_e1_f64"], rel=1e-12
            )
            if row["e1_f64"]:
                assert am.expint_e1(row["x"]) == pytest.approx(row["e1_f64"], rel=1e-12)


# ---- Mistakes


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: am.AirLight((0, 1, 0), -1, 1), r"sigma_s must be finite and >= 0, got -1"),
        (lambda: am.AirLight((0, 1, 0), (1, 2), (1, 2, 3)), r"same number of channels"),
        (lambda: am.AirLight((0, np.inf, 0), 1, 1), r"light.position must be finite"),
        (
            lambda: am.AirLight((0, 1, 0), 1, 1, HenyeyGreenstein(1)),
            r"phase.g must be in \(-1, 1\)",
        ),
        (lambda: am.AirLight((0, 1, 0), 1, 1, phase="mie"), r"phase must be Isotropic, .*'mie'"),
        (
            lambda: am.AirLight((0, 1, 0), 1, 1, intensity=Lobes(3, (0, 0, 1))),
            r"light.exponent must be even and in \[2, 1024\], got 3",
        ),
        (
            lambda: am.AirLight((0, 1, 0), 1, 1, intensity=Spot(2, (0, 0, 2))),
            r"light.axis must be a unit vector",
        ),
        (
            lambda: am.AirLight((0, 1, 0), 1, 1, intensity=Cone((0, 0, 1), 0.5, 0.6)),
            r"light.beam_width must be in \[0, cutoff_angle\], got 0.6",
        ),
        (lambda: am.airlight(1, 1, EYE, (1, 1, 0), 0, 1, (0, 1, 0)), r"direction must be a unit"),
        (lambda: am.airlight(1, 1, EYE, ALONG, -np.inf, 1, (0, 1, 0)), r"t0 must be finite"),
        (lambda: am.expint_e1(0), r"x must be finite and > 0, got 0"),
        (lambda: am.expint_ei("one"), r"z must be an array of complex numbers"),
    ],
)
def test_mistakes_are_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_names():
    assert scattering.airlight is am.airlight
