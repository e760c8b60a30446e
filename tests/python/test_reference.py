"""Columns, free flights and bounds against the reference tables, in every arithmetic.

All rows, with the tolerances of tests/reference.rs. The worst errors are printed: pytest -s.
"""

from collections import defaultdict
from functools import cache

import numpy as np
import pytest
import rows

import analytic_media as am

SINGLE_ROUNDING = 0.5**24


class Arithmetic:
    """A floating-point format and what is asked of it."""

    def __init__(self, dtype):
        self.dtype = np.dtype(dtype)
        self.single = self.dtype == np.float32
        self.target = 1e-6 if self.single else 1e-12
        self.roundoff = float(np.finfo(dtype).eps) / 2
        self.least = float(np.finfo(dtype).tiny)

    def rounded(self, values):
        """Numbers as the format holds them: beyond it they are infinite."""
        with np.errstate(over="ignore", under="ignore"):
            return np.asarray(values, dtype=float).astype(self.dtype).astype(float)


def numbers(selected, key):
    return np.array([row[key] for row in selected], dtype=float)


class Batched(Arithmetic):
    """The batched C functions, through NumPy."""

    def ask(self, selected, models, question, *keys):
        """Results in float64, a row each; `models` makes the model of a row."""
        results = [self._one(row, models, question, keys) for row in selected]
        return np.array(results, dtype=np.float64)

    def _one(self, row, models, question, keys):
        inputs = [np.array(row[key], dtype=float).astype(self.dtype) for key in keys]
        result = getattr(models(row), question)(*inputs)
        assert np.asarray(result).dtype == self.dtype
        return result


class Rounded(Arithmetic):
    """Double precision, of inputs in single precision."""

    def __init__(self):
        super().__init__("float32")

    def ask(self, selected, question, *keys):
        return np.array([self._one(row, question, keys) for row in selected])

    def _one(self, row, question, keys):
        (profile,) = row["profiles"]
        own = {name: self.rounded(value).tolist() for name, value in profile.parameters.items()}
        return getattr(type(profile)(**own), question)(*(self.rounded(row[key]) for key in keys))


class Recorded(Arithmetic):
    """Recorded nodes: rows of the same kinds of profile are lanes of one recording."""

    def __init__(self, number, dtype, host=None):
        super().__init__(dtype)
        self.number, self.host = number, host

    def ask(self, selected, models, question, *keys):
        groups = defaultdict(list)
        for i, row in enumerate(selected):
            groups[tuple(type(profile) for profile in row["profiles"])].append(i)
        results = {}
        for indices in groups.values():
            group = [selected[i] for i in indices]
            got = self._group(group, models, question, keys)
            results |= dict(zip(indices, got, strict=True))
        return np.array([results[i] for i in range(len(selected))])

    def lanes(self, values):
        """Numbers of the host, a lane each; vectors as lists of three."""
        array = np.array(values, dtype=float)
        if array.ndim == 2:
            return [self.lanes(column) for column in array.T]
        return self.number(array)

    def _group(self, group, models, question, keys):
        inputs = [self.lanes([np.array(row[key], dtype=float) for row in group]) for key in keys]
        recorded = []
        for position, profile in enumerate(group[0]["profiles"]):
            values = {
                name: self.lanes([row["profiles"][position].parameters[name] for row in group])
                for name in profile.parameters
            }
            recorded.append(am.jit.Profile(profile, host=self.host, **values))
        if "components" in group[0]:
            sigma_t = [
                self.lanes([row["components"][position]["mu"] for row in group])
                for position in range(len(recorded))
            ]
            pairs = zip(recorded, sigma_t, strict=True)
            model = am.jit.Medium(pairs, host=self.host)
        else:
            (model,) = recorded
        result = getattr(model, question)(*inputs)
        outputs = result if isinstance(result, tuple) else (result,)
        columns = [np.broadcast_to(np.asarray(o, dtype=float), len(group)) for o in outputs]
        return np.stack(columns, -1) if len(columns) > 1 else columns[0]


@pytest.fixture(params=["NumPy f64", "NumPy f32", "nodes f64", "llvm_ad_rgb nodes f32"])
def arithmetic(request):
    match request.param:
        case "NumPy f64":
            return Batched("float64")
        case "NumPy f32":
            return Batched("float32")
        case "nodes f64":
            return Recorded(np.asarray, "float64", am.jit.Host(np, np.float64, 53))
        case _:
            return Recorded(request.getfixturevalue("llvm").Float, "float32")


@pytest.fixture
def report(request):
    """Prints the worst of some errors, and the row that it belongs to."""

    def say(what, errors, selected):
        worst = int(np.argmax(errors))
        where = f"row {selected[worst]['id']}, {selected[worst]['regime']}"
        print(f"\n{request.node.name}: {len(errors)} {what} {errors[worst]:.1e} ({where})", end="")

    return say


def assert_rows(good, selected, *values):
    """Fails with the first rows that are not `good`, and their values."""
    bad = [(selected[i], *(value[i] for value in values)) for i in np.flatnonzero(~good)[:3]]
    assert not bad, bad


def depth(row, values, t):
    """Optical depth of a sum in double precision; `values` are those of `flight_inputs`."""
    rest = iter(values)
    pairs = []
    for profile, component in zip(row["profiles"], row["components"], strict=True):
        own = {name: take(rest, value) for name, value in profile.parameters.items()}
        pairs.append((type(profile)(**own), take(rest, component["mu"])))
    origin, direction = take(rest, row["origin"]), take(rest, row["dir"])
    return am.Medium(pairs).optical_depth(origin, direction, t)


def take(numbers, like):
    """The next number, or as many as `like` has."""
    return next(numbers) if np.ndim(like) == 0 else [next(numbers) for _ in like]


def flight_inputs(row):
    """Every number that a row of inverses depends on, in the order of `depth`."""
    parts = []
    for profile, component in zip(row["profiles"], row["components"], strict=True):
        parts += [*profile.parameters.values(), component["mu"]]
    return np.hstack([*parts, row["origin"], row["dir"]])


@cache
def flights():
    """The rows of inverses, and what a single precision rounding of each input does to τ."""
    selected = rows.table("inverse")
    shifts = []
    for row in selected:
        values = flight_inputs(row)
        t = float(row["t_max"] if row["t"] == "inf" else row["t"])
        plain = depth(row, values, t)
        moved = [depth(row, values, t * (1 + SINGLE_ROUNDING))]
        for i in range(len(values)):
            factors = np.ones_like(values)
            factors[i] += SINGLE_ROUNDING
            moved.append(depth(row, values * factors, t))
        shifts.append(np.abs(np.array(moved) - plain).sum() if np.isfinite(plain) else 0)
    return selected, np.array(shifts)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # NumPy's, as a host: 0/0 not selected
def test_columns(arithmetic, report):
    selected = rows.table("columns")
    got = arithmetic.ask(selected, lambda row: row["profiles"][0], "column", "origin", "dir", "t")
    expected = arithmetic.rounded(numbers(selected, "column"))
    sens = np.array([row["sens"] or 1 for row in selected])

    with np.errstate(invalid="ignore"):
        error = np.abs(got - expected) / np.maximum(expected, arithmetic.least)
    error = np.where(got == expected, 0, error)
    assert_rows(error <= arithmetic.target + 4 * arithmetic.roundoff * sens, selected, got)
    report("columns, worst relative error", error, selected)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_free_flights(arithmetic, report):
    selected, shifts = flights()

    def medium(row):
        mu = [component["mu"] for component in row["components"]]
        return am.Medium(zip(row["profiles"], mu, strict=True))

    got = arithmetic.ask(selected, medium, "free_flight", "origin", "dir", "t_max", "tau")
    expected, tau, total = (numbers(selected, key) for key in ("t", "tau", "tau_max"))

    # An infinite answer stands for all distances beyond the end.
    reached = zip(selected, got, strict=True)
    reached = [depth(row, flight_inputs(row), t) if np.isfinite(t) else 0 for row, t in reached]
    missing = np.where(np.isfinite(got), np.abs(reached - tau), np.maximum(total - tau, 0))
    residual = np.where(got == expected, 0, missing / np.maximum(tau, 1))
    uncertainty = shifts * (arithmetic.roundoff / SINGLE_ROUNDING) / np.maximum(tau, 1)
    tolerance = arithmetic.target * np.minimum(tau, 1) + 2 * uncertainty
    assert_rows(residual <= tolerance, selected, got, residual, tolerance)
    report("free flights, worst residual", residual, selected)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("domain", ["segment", "box"])
def test_bounds(arithmetic, report, domain):
    selected = [row for row in rows.table("majorant") if row["domain"] == domain]
    question = (
        ("bounds", "origin", "dir", "t") if domain == "segment" else ("bounds_box", "lo", "hi")
    )
    inf, sup = arithmetic.ask(selected, lambda row: row["profiles"][0], *question).T
    true_inf, true_sup = numbers(selected, "inf"), numbers(selected, "sup")
    if arithmetic.single:
        # Of the rounded inputs, whose bounds in double precision are true.
        true_inf, true_sup = Rounded().ask(selected, *question).T
        true_inf, true_sup = arithmetic.rounded(true_inf), arithmetic.rounded(true_sup)
    assert_rows((inf <= true_inf) & (true_sup <= sup), selected, inf, sup)
    with np.errstate(invalid="ignore"):
        excess = sup / np.maximum(true_sup, arithmetic.least) - 1
        lost = true_inf - inf
    excess = np.where(sup == true_sup, 0, excess)
    # Beside the supremum, an infimum may be next to nothing.
    near = (inf == true_inf) | (true_inf <= 1.5 * inf) | (lost <= 1e-3 * true_sup)
    assert_rows((excess <= 0.5) & near, selected, inf, sup)
    report("bounds, widest", excess, selected)
