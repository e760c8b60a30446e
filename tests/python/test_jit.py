"""Recorded formulas: as Dr.Jit arrays with derivatives, and on hosts of a few lines."""

import math
from collections import Counter

import numpy as np
import pytest

import analytic_media as am
from analytic_media import _native

UP, TILTED = (0.0, 0.0, 1.0), (0.6, 0.0, 0.8)
PROFILES = {
    "constant": am.Constant(),
    "linear": am.Linear(gradient=-0.05, density=1.5, base_height=2, up=TILTED),
    "exponential": am.Exponential(scale_height=8, base_height=-3, up=TILTED),
}
each_profile = pytest.mark.parametrize("profile", PROFILES.values(), ids=PROFILES)

RAY = {"o": (1.0, -2.0, 3.0), "d": (0.36, 0.48, 0.8)}


def components(number, vector):
    return [number(x) for x in vector]


def close(got, expected):
    """To within 1e-12; what is the same for all rays may be a single number."""
    expected = np.asarray(expected)
    got = np.broadcast_to(np.array(got), expected.shape)
    np.testing.assert_allclose(got, expected, rtol=1e-12, atol=1e-300)


# ---- Values


def test_profiles_agree_with_numpy(llvm, rays):
    o, d = rays
    point, direction = llvm.Array3f64(o.T), llvm.Array3f64(d.T)
    for profile in PROFILES.values():
        recorded = am.jit.Profile(profile)
        for question, inputs in (("column", (4.0,)), ("inv_column", (4.0,)), ("bounds", (4.0,))):
            got = getattr(recorded, question)(point, direction, *inputs)
            expected = getattr(profile, question)(o, d, *inputs)
            close(got, expected)
        close(recorded.density(point), profile.density(o))
        close(recorded.bounds_box(point, point + 1), profile.bounds_box(o, o + 1))


@pytest.mark.parametrize("sigma_t", [(0.1, 0.02), ((0.1, 0.2, 0.3), (0.02, 0, 0.05))])
def test_media_agree_with_numpy(llvm, rays, sigma_t):
    o, d = rays
    point, direction = llvm.Array3f64(o.T), llvm.Array3f64(d.T)
    pairs = list(zip((PROFILES["exponential"], PROFILES["linear"]), sigma_t, strict=True))
    medium, recorded = am.Medium(pairs), am.jit.Medium(pairs)

    def check(question, first, second, *numbers):
        got = getattr(recorded, question)(*first, *numbers)
        expected = getattr(medium, question)(*second, *numbers)
        if isinstance(sigma_t[0], tuple) and question != "free_flight":
            got = np.moveaxis(np.array(got), -2, -1)
        close(got, expected)

    ray, rays_ = (point, direction), (o, d)
    for question in ("optical_depth", "transmittance", "opacity", "pdf", "bounds"):
        check(question, ray, rays_, 4.0)
    check("pdf_within", ray, rays_, 5.0, 4.0)
    check("free_flight", ray, rays_, 20.0, 0.5)
    check("extinction", (point,), (o,))
    check("bounds_box", (point, point + 1), (o, o + 1))


def test_a_color_gives_channels(llvm):
    import mitsuba as mi

    medium = am.jit.Medium([(PROFILES["constant"], mi.Color3f(0.1, 0.2, 0.3))])
    got = medium.transmittance(mi.Point3f(0), mi.Vector3f(0, 0, 1), mi.Float(2))
    np.testing.assert_allclose(np.ravel(got), np.exp([-0.2, -0.4, -0.6]), rtol=1e-6)
    t = medium.free_flight(mi.Point3f(0), UP, 100, mi.Float(0.6), channel=2)
    assert type(t) is mi.Float and t[0] == pytest.approx(2)


def test_recording_works_in_a_symbolic_loop(llvm):
    """Distances after three collisions of the same optical depth."""
    import drjit as dr

    fog = am.jit.Medium([(PROFILES["exponential"], 0.2)])
    d = components(llvm.Float64, RAY["d"])

    def step(i, t):
        o = [llvm.Float64(x) + t * y for x, y in zip(RAY["o"], d, strict=True)]
        return i + 1, t + fog.free_flight(o, d, math.inf, llvm.Float64(0.1))

    zero = dr.opaque(llvm.Float64, 0, 4)
    _, t = dr.while_loop((llvm.UInt(0), zero), lambda i, _: i < 3, step, mode="symbolic")
    whole = am.Medium([(PROFILES["exponential"], 0.2)])
    expected = whole.free_flight(RAY["o"], RAY["d"], math.inf, 0.3)
    np.testing.assert_allclose(t, expected, rtol=1e-12)


def test_kernels_survive_a_change_of_parameters(llvm):
    import drjit as dr

    def launch(scale_height):
        value = dr.opaque(llvm.Float, scale_height)
        fog = am.jit.Profile(PROFILES["exponential"], scale_height=value)
        o = [dr.opaque(llvm.Float, x) for x in RAY["o"]]
        dr.eval(fog.column(o, RAY["d"], dr.opaque(llvm.Float, 5)))
        return [kernel["hash"] for kernel in dr.kernel_history() if "hash" in kernel]

    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.kernel_history_clear()
        assert launch(20) == launch(30) != []


# ---- Derivatives

QUESTIONS = {
    "density": lambda m, v: m.density(v["o"]),
    "column": lambda m, v: m.column(v["o"], v["d"], v["t"]),
    "inv_column": lambda m, v: m.inv_column(v["o"], v["d"], v["t"]),
    "transmittance": lambda m, v: m.transmittance(v["o"], v["d"], v["t"]),
    "free_flight": lambda m, v: m.free_flight(v["o"], v["d"], 50.0, v["t"]),
    "pdf": lambda m, v: m.pdf(v["o"], v["d"], v["t"]),
}


def questions(model):
    return [q for q in QUESTIONS if hasattr(model, q)]


def flat(values):
    """(name, index or None) of every number."""
    return [
        (name, i)
        for name, value in values.items()
        for i in (range(3) if isinstance(value, tuple) else [None])
    ]


def finite_difference(function, values, name, i):
    """Central difference with respect to one number, relative error about 1e-9."""

    def at(shift):
        moved = dict(values)
        moved[name] = (
            tuple(x + shift * (k == i) for k, x in enumerate(values[name]))
            if (i is not None)
            else values[name] + shift
        )
        return function(moved)

    step = 1e-5
    return (8 * (at(step / 2) - at(-step / 2)) - (at(step) - at(-step))) / (6 * step)


def gradients(llvm, values, function):
    """All derivatives of `function` of these values, by reverse mode."""
    import drjit as dr

    arrays = {  # opaque: what is constant must not be folded away
        name: [dr.opaque(llvm.Float64, x) for x in v]
        if isinstance(v, tuple)
        else dr.opaque(llvm.Float64, v)
        for name, v in values.items()
    }
    dr.enable_grad(arrays)
    dr.backward(function(arrays), flags=dr.ADFlag.Default | dr.ADFlag.AllowNoGrad)
    grads = {}
    for name, i in flat(values):
        array = arrays[name] if i is None else arrays[name][i]
        grads[name, i] = dr.grad(array)[0]
    return grads


@each_profile
def test_derivatives_of_profiles(llvm, profile):
    """With respect to the ray and every parameter, against finite differences."""
    values = {**RAY, "t": 4.0, **profile.parameters}
    names = list(profile.parameters)
    for question in questions(profile):
        ask = QUESTIONS[question]

        def plain(v, ask=ask):
            return ask(type(profile)(**{name: v[name] for name in names}), v)

        def recorded(v, ask=ask):
            return ask(am.jit.Profile(profile, **{name: v[name] for name in names}), v)

        got = gradients(llvm, values, recorded)
        for (name, i), gradient in got.items():
            # `d` and `up` may be off the unit sphere by 1e-5, as far as the step goes.
            expected = finite_difference(plain, values, name, i)
            assert gradient == pytest.approx(expected, rel=1e-6, abs=1e-8), (question, name, i)


def test_derivatives_of_a_sum(llvm):
    """Of a medium of two components; its free flight has no closed form."""
    first, second = PROFILES["exponential"], PROFILES["linear"]
    values = {
        **RAY, "t": 0.8, "a": 0.11, "b": 0.07, "scale_height": 8.0, "base_height": -3.0,
        "gradient": -0.05, "density": 1.5,
    }  # fmt: skip

    def plain(v, ask):
        e = am.Exponential(scale_height=v["scale_height"], base_height=v["base_height"], up=TILTED)
        li = am.Linear(gradient=v["gradient"], density=v["density"], base_height=2, up=TILTED)
        return ask(am.Medium([(e, v["a"]), (li, v["b"])]), v)

    def recorded(v, ask):
        e = am.jit.Profile(first, scale_height=v["scale_height"], base_height=v["base_height"])
        li = am.jit.Profile(second, gradient=v["gradient"], density=v["density"])
        return ask(am.jit.Medium([(e, v["a"]), (li, v["b"])]), v)

    for question in ("transmittance", "free_flight", "pdf"):
        ask = QUESTIONS[question]
        got = gradients(llvm, values, lambda v, ask=ask: recorded(v, ask))
        for (name, i), gradient in got.items():
            expected = finite_difference(lambda v, ask=ask: plain(v, ask), values, name, i)
            assert gradient == pytest.approx(expected, rel=1e-5, abs=1e-7), (question, name, i)


@each_profile
def test_derivatives_in_closed_form(llvm, profile):
    """dN/dt is the density at the end; dt/dN its inverse; dN/dH etc. of the exponential."""
    values = {**RAY, "t": 4.0}
    end = np.add(RAY["o"], np.multiply(4.0, RAY["d"]))
    column = gradients(llvm, values, lambda v: QUESTIONS["column"](am.jit.Profile(profile), v))
    assert column["t", None] == pytest.approx(profile.density(end), rel=1e-13)

    values["t"] = profile.column(RAY["o"], RAY["d"], 4.0)
    back = gradients(llvm, values, lambda v: QUESTIONS["inv_column"](am.jit.Profile(profile), v))
    assert back["t", None] == pytest.approx(1 / profile.density(end), rel=1e-13)


def test_derivatives_of_the_exponential_in_closed_form(llvm):
    """∂N/∂b = N/H, ∂N/∂x = -up N/H."""
    profile = PROFILES["exponential"]
    values = {**RAY, "t": 4.0, "base_height": -3.0}
    got = gradients(
        llvm,
        values,
        lambda v: QUESTIONS["column"](am.jit.Profile(profile, base_height=v["base_height"]), v),
    )
    rate = profile.column(RAY["o"], RAY["d"], 4.0) / 8
    assert got["base_height", None] == pytest.approx(rate, rel=1e-13)
    for i in range(3):
        assert got["o", i] == pytest.approx(-TILTED[i] * rate, rel=1e-13, abs=1e-15)


@each_profile
@pytest.mark.parametrize("name", ["Float", "Float64"])
def test_inverse_of_a_column_that_is_reached(llvm, profile, name, rays):
    """As precise as it gets, and without derivatives."""
    import drjit as dr

    number = getattr(llvm, name)
    o, d = ([number(x) for x in a.T] for a in rays)
    recorded = am.jit.Profile(profile)
    column = recorded.column(o, d, number(4.0))
    dr.enable_grad(column)
    t = recorded.inv_reached_column(o, d, column)
    assert not dr.grad_enabled(t)
    again, column, t = (np.array(x) for x in (recorded.column(o, d, t), column, t))
    density = np.array(recorded.density([a + t * b for a, b in zip(o, d, strict=True)]))
    some = (column > 1e-6) & np.isfinite(column)
    assert some.mean() > 0.3
    target = 1e-12 if name == "Float64" else 2e-6
    assert np.all((abs(again - column) <= target * (column + t * density))[some])


@pytest.mark.parametrize("d", [(0.6, 0.0, -0.8), (0.96, 0.0, -0.28)])
def test_derivatives_of_columns_past_a_perigee(llvm, d):
    """Where a piece of a column begins at the perigee, whatever the parameters are."""
    planet = {"center": (0.0, 0.0, -50.0), "radius": 50.0, "scale_height": 8.0}
    values = {"o": (0.0, 1.0, 3.0), "d": d, "t": 90.0, **planet}

    def plain(v):
        return QUESTIONS["column"](am.Spherical(**{name: v[name] for name in planet}), v)

    def recorded(v):
        profile = am.jit.Profile(am.Spherical, **{name: v[name] for name in planet})
        return QUESTIONS["column"](profile, v)

    got = gradients(llvm, values, recorded)
    for (name, i), gradient in got.items():
        if name != "d":  # of unit length, for a planet
            expected = finite_difference(plain, values, name, i)
            assert gradient == pytest.approx(expected, rel=1e-6, abs=1e-7), (name, i)


@each_profile
@pytest.mark.parametrize("question", ["column", "inv_column"])
@pytest.mark.parametrize("d", [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)])
@pytest.mark.parametrize("t", [0.0, 1e-9, 1.0, 1e3, math.inf])
def test_derivatives_are_never_nan(llvm, profile, question, d, t):
    """Horizontal rays, empty and endless segments, columns that are never reached."""
    straight = {"linear": am.Linear(gradient=-0.05, density=1.5)}
    profile = straight.get(profile._kind.name, profile)
    values = {"o": (0.0, 0.0, 2.0), "d": d, "t": t, **profile.parameters}
    got = gradients(
        llvm,
        values,
        lambda v: QUESTIONS[question](
            am.jit.Profile(profile, **{name: v[name] for name in profile.parameters}), v
        ),
    )
    assert not any(math.isnan(gradient) for gradient in got.values()), got


# ---- Other hosts


class CountingHost:
    """Computes nothing, and counts the operations."""

    digits = 24

    def __init__(self):
        self.counts = Counter()

    def __getattr__(self, operation):
        def count(*_):
            self.counts[operation] += 1
            return operation

        return count


class PrintingHost:
    """Writes a program, one operation per line."""

    digits = 53

    def __init__(self):
        self.lines = []

    def __getattr__(self, operation):
        def write(*arguments):
            self.lines.append(f"v{len(self.lines)} = {operation}({', '.join(map(str, arguments))})")
            return self.lines[-1].split()[0]

        return write


POINT, SEGMENT = (["x"] * 3,), (["o"] * 3, ["d"] * 3, "t")
ARGUMENTS = {
    "density": POINT,
    "bounds_box": POINT * 2,
    "extinction": POINT,
    "free_flight": (*SEGMENT, "tau"),
}
COSTS = {  # different operations in single precision, literals aside
    "constant": {"density": 0, "column": 0, "inv_column": 0, "bounds": 0, "bounds_box": 0},
    "linear": {"density": 6, "column": 36, "inv_column": 36, "bounds": 116, "bounds_box": 153},
    "exponential": {"density": 8, "column": 71, "inv_column": 78, "bounds": 129, "bounds_box": 166},
    "exponential medium": {"transmittance": 77, "free_flight": 86, "pdf": 97},
    "exponential and constant": {"transmittance": 82, "free_flight": 1587, "pdf": 106},
}


def counting(name, host):
    """The model called `name`, on a host that counts."""
    if name in PROFILES:
        return am.jit.Profile(PROFILES[name], host=host)
    count = 1 if name == "exponential medium" else 2
    names = ["exponential", "constant"][:count]
    return am.jit.Medium([(PROFILES[name], "sigma_t") for name in names], host=host)


@pytest.mark.parametrize(
    ("name", "question"), [(n, q) for n, costs in COSTS.items() for q in costs]
)
def test_cost_of_a_formula(name, question):
    host = CountingHost()
    getattr(counting(name, host), question)(*ARGUMENTS.get(question, SEGMENT))
    counts = {k: n for k, n in host.counts.items() if k != "literal"}
    listed = ", ".join(f"{n} {k}" for k, n in sorted(counts.items()))
    print(f"\n{name}, {question}: {sum(counts.values())} operations: {listed}", end="")
    assert sum(counts.values()) <= COSTS[name][question]


@each_profile
def test_a_printed_program_computes_the_same(profile):
    """Straight-line code over Python floats."""
    host = PrintingHost()
    result = am.jit.Profile(profile, host=host).column(
        ["o[0]", "o[1]", "o[2]"], ["d[0]", "d[1]", "d[2]"], "t"
    )
    scope = {
        "literal": float, "inf": math.inf, "o": RAY["o"], "d": RAY["d"], "t": 4.0,
        "neg": lambda a: -a, "abs": abs, "sqrt": math.sqrt, "exp": math.exp, "log": math.log,
        "add": lambda a, b: a + b, "sub": lambda a, b: a - b, "mul": lambda a, b: a * b,
        "div": lambda a, b: a / b, "min": min, "max": max, "fma": lambda a, b, c: a * b + c,
        "less": lambda a, b: a < b, "less_equal": lambda a, b: a <= b,
        "mask_and": lambda a, b: a and b, "mask_or": lambda a, b: a or b,
        "mask_not": lambda a: not a, "select": lambda m, a, b: a if m else b,
        "detach": lambda a: a,
    }  # fmt: skip
    assert set(_native.OPERATIONS) <= set(scope)
    exec("\n".join(host.lines), scope)
    got = eval(result, scope)
    assert got == pytest.approx(profile.column(RAY["o"], RAY["d"], 4.0), rel=1e-14)


# ---- Errors


class FailingHost(CountingHost):
    def exp(self, _):
        raise ZeroDivisionError("exp is out of order")


def test_an_error_of_the_host_comes_back():
    for _ in range(3):
        host = FailingHost()
        with pytest.raises(ZeroDivisionError, match="out of order"):
            am.jit.Profile(PROFILES["exponential"], host=host).column(*SEGMENT)
    assert am.jit.Profile(PROFILES["constant"], host=host).column(*SEGMENT) == "t"


def test_there_must_be_a_jit_array():
    with pytest.raises(TypeError, match="an array of a JIT backend"):
        am.jit.Profile(PROFILES["exponential"]).column(RAY["o"], RAY["d"], 4.0)


def test_precisions_do_not_mix(llvm):
    with pytest.raises(TypeError, match="one precision"):
        am.jit.Profile(PROFILES["exponential"], scale_height=llvm.Float(3)).column(
            RAY["o"], RAY["d"], llvm.Float64(4)
        )


def test_shapes_of_the_arguments(llvm):
    p = am.jit.Profile(PROFILES["exponential"])
    number, vector = llvm.Float([1, 2, 3]), llvm.Array3f(1, 2, 3)
    with pytest.raises(ValueError, match="x must have three components, got Float"):
        p.density(number)
    with pytest.raises(ValueError, match="o must have three components, got 2"):
        p.column((0, 0), vector, 1)
    with pytest.raises(ValueError, match="t must be a number, got 3 components"):
        p.column(vector, vector, vector)
    with pytest.raises(ValueError, match="scale_height must be a number, got 3 components"):
        am.jit.Profile(PROFILES["exponential"], scale_height=vector).density(vector)
    with pytest.raises(ValueError, match="same number of channels"):
        am.jit.Medium([(p, [1, 2]), (p, 3)])
    with pytest.raises(ValueError, match="at least one"):
        am.jit.Medium([])
    with pytest.raises(ValueError, match="channel must be < 2, got 2"):
        am.jit.Medium([(p, [1, 2])]).free_flight(vector, vector, 1, number, channel=2)


def test_parameters_that_are_not_there():
    with pytest.raises(TypeError, match="Exponential has no parameter 'scale'"):
        am.jit.Profile(PROFILES["exponential"], scale=3)
