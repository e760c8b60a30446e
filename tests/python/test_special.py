"""Special functions against the reference tables, through NumPy and recorded in Dr.Jit.

All rows, as in tests/functions.rs: to 1e-12 in double and 2e-6 in single precision; logarithms to
that times 1 + their size. The worst errors are printed: pytest -s.
"""

import numpy as np
import pytest
import rows
import scipy.special

import analytic_media as am
from analytic_media import special


class NumPy:
    """The batched C functions."""

    def __init__(self, dtype):
        self.dtype = np.dtype(dtype)

    def ask(self, function, *arguments):
        result = getattr(special, function)(*(a.astype(self.dtype) for a in arguments))
        assert result.dtype == self.dtype
        return result.astype(float)


class Recorded:
    """Recorded on a host."""

    def __init__(self, number, dtype, host=None):
        self.number, self.dtype, self.host = number, np.dtype(dtype), host

    def ask(self, function, *arguments):
        lifted = [self.number(a) for a in arguments]
        return np.array(am.jit.special(function, *lifted, host=self.host), dtype=float)


@pytest.fixture(params=["NumPy f64", "NumPy f32", "nodes f64", "llvm_ad_rgb nodes f32"])
def arithmetic(request):
    match request.param:
        case "NumPy f64":
            return NumPy("float64")
        case "NumPy f32":
            return NumPy("float32")
        case "nodes f64":
            return Recorded(np.asarray, "float64", am.jit.Host(np, np.float64, 53))
        case _:
            return Recorded(request.getfixturevalue("llvm").Float, "float32")


# Function, table, column, arguments.
FUNCTIONS = [
    ("chapman", "chapman", "C", ("z", "cos_theta")),
    ("log_chapman", "chapman", "log_C", ("z", "cos_theta")),
    ("chapman_rescaled", "chapman", "Cr", ("z", "Z", "cos_theta")),
    ("log_chapman_rescaled", "chapman", "log_Cr", ("z", "Z", "cos_theta")),
    ("bessel_k1_scaled", "bessel_k1", "zexpzK1", ("z",)),
    ("erfcx", "erfcx", "erfcx", ("x",)),
]


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # NumPy's, as a host: overflow not selected
@pytest.mark.parametrize(("function", "table", "column", "keys"), FUNCTIONS)
def test_rows(arithmetic, function, table, column, keys):
    selected = rows.read(table)
    single = arithmetic.dtype == np.float32
    arguments = [np.array([row[key] for row in selected], dtype=float) for key in keys]
    exact = np.array([float(row[column]) for row in selected])
    if single:
        # Where single precision does not hold the arguments, double precision of the rounded ones.
        arguments = [a.astype(np.float32).astype(float) for a in arguments]
        held = np.array([row["f32"] for row in selected])
        exact = np.where(held, exact, getattr(special, function)(*arguments))
    with np.errstate(over="ignore", under="ignore"):
        expected = exact.astype(arithmetic.dtype).astype(float)

    got = arithmetic.ask(function, *arguments)
    logarithm = function.startswith("log")
    least = np.finfo(arithmetic.dtype).tiny
    size = 1 + np.abs(expected) if logarithm else np.maximum(expected, least)
    with np.errstate(invalid="ignore"):
        error = np.where(got == expected, 0, np.abs(got - expected) / size)
    worst = int(np.argmax(np.nan_to_num(error, nan=np.inf)))
    assert error[worst] <= (2e-6 if single else 1e-12), (selected[worst], got[worst])
    print(
        f"\n{function}: {len(selected)} rows {error[worst]:.1e}, {selected[worst]['regime']}",
        end="",
    )


def test_erfcx_is_that_of_scipy(rng):
    x = rng.uniform(-20, 100, 1000)
    np.testing.assert_allclose(am.erfcx(x), scipy.special.erfcx(x), rtol=2e-13)


def test_k1_is_that_of_scipy(rng):
    z = 10 ** rng.uniform(-3, 6, 1000)
    np.testing.assert_allclose(am.bessel_k1_scaled(z), z * scipy.special.k1e(z), rtol=1e-13)


def test_rescaled_chapman_times_the_scale_height_is_the_column_of_a_ray(rng):
    """Eq. 43 and 44: an infinite ray from any altitude, at any angle."""
    radius, scale_height = 6371.0, 8.4
    air = am.Spherical(center=(0, 0, 0), radius=radius, scale_height=scale_height)
    r = radius + rng.uniform(0, 80, 200)
    mu = rng.uniform(-0.15, 1, 200)
    zero = np.zeros(200)
    column = air.column(
        np.stack([zero, zero, r], -1), np.stack([np.sqrt(1 - mu**2), zero, mu], -1), np.inf
    )
    found = special.chapman_rescaled(r / scale_height, radius / scale_height, mu)
    np.testing.assert_allclose(scale_height * found, column, rtol=1e-11)


def test_arguments_broadcast_and_keep_float32():
    z = np.array([[1.0], [100.0]], dtype=np.float32)
    value = am.chapman(z, np.float32([1, 0.5, 0]))
    assert (value.shape, value.dtype) == ((2, 3), np.float32)
    assert isinstance(am.chapman(10, 0.5), np.float64)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: am.chapman(-1, 0), r"z must be finite and >= 0, got -1"),
        (lambda: am.chapman(np.inf, 0), r"z must be finite"),
        (
            lambda: am.chapman([1, 2], [0, 1.5]),
            r"cos_zenith must be in \[-1, 1\], got 1.5 at item 1",
        ),
        (lambda: am.chapman(1, np.nan), r"cos_zenith must be in \[-1, 1\], got NaN"),
        (lambda: special.chapman_upper(1, -0.1), r"cos_zenith must be in \[0, 1\], got -0.1"),
        (lambda: special.chapman_lower(1, 0.1), r"cos_zenith must be in \[-1, 0\], got 0.1"),
        (lambda: special.chapman_rescaled(1, np.inf, 1), r"surface must be finite, got inf"),
        (lambda: special.chapman_huestis(0, 1), r"z must be finite and > 0, got 0"),
        (lambda: special.erfcx_golubev(-1), r"x must be finite and >= 0, got -1"),
        (lambda: am.erfcx(np.nan), r"x must be finite, got NaN"),
        (lambda: am.erfcx("one"), r"x must be an array of real numbers"),
        (lambda: am.chapman([1, 2], [0, 0, 0]), r"does not broadcast"),
    ],
)
def test_bad_arguments_are_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_derivatives_of_recorded_functions(llvm):
    """dC/dμ and dC/dz against differences in double precision."""
    import drjit as dr

    z, mu = llvm.Float([10, 800, 800]), llvm.Float([0.5, 0.1, -0.02])
    dr.enable_grad(z, mu)
    dr.backward(dr.sum(am.jit.special("log_chapman", z, mu)))
    z0, mu0 = np.array(dr.detach(z), dtype=float), np.array(dr.detach(mu), dtype=float)
    by_z = am.log_chapman(z0 * (1 + 1e-5), mu0) - am.log_chapman(z0 * (1 - 1e-5), mu0)
    by_mu = am.log_chapman(z0, mu0 + 1e-6) - am.log_chapman(z0, mu0 - 1e-6)
    np.testing.assert_allclose(np.array(z.grad), by_z / (2e-5 * z0), rtol=1e-3)
    np.testing.assert_allclose(np.array(mu.grad), by_mu / 2e-6, rtol=1e-3)
