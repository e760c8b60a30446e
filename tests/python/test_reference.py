"""Columns, free flights and bounds against the reference tables, in every arithmetic.

A row's tolerance is the target of the arithmetic times the row's own sensitivity to rounded
coordinates (`sens`, `cond`), as in tests/reference.rs. The worst errors are printed: pytest -s.
"""

from collections import defaultdict

import numpy as np
import pytest
import rows

import analytic_media as am

DOUBLE, SINGLE = 1e-12, 2e-6
TARGETS = {"float64": DOUBLE, "float32": SINGLE}


def numbers(selected, key):
    return np.array([row[key] for row in selected], dtype=float)


class Batched:
    """The batched C functions, through NumPy."""

    def __init__(self, dtype):
        self.dtype, self.target = np.dtype(dtype), TARGETS[dtype]

    def ask(self, selected, models, question, *keys):
        """Results in float64, a row each; `models` makes the model of a row."""
        results = [self._one(row, models, question, keys) for row in selected]
        return np.array(results, dtype=np.float64)

    def _one(self, row, models, question, keys):
        inputs = [np.array(row[key], dtype=float).astype(self.dtype) for key in keys]
        result = getattr(models(row), question)(*inputs)
        assert np.asarray(result).dtype == self.dtype
        return result


class Recorded:
    """Recorded nodes: rows of the same kinds of profile are lanes of one recording."""

    def __init__(self, number, dtype, host=None):
        self.number, self.host, self.target = number, host, TARGETS[dtype]

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


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # NumPy's, as a host: 0/0 not selected
def test_columns(arithmetic, report):
    selected = rows.table("columns")
    assert len(selected) > 150
    got = arithmetic.ask(selected, lambda row: row["profiles"][0], "column", "origin", "dir", "t")
    expected = numbers(selected, "column")
    sens = np.array([max(row["sens"] or 1, 1) for row in selected])

    exact = np.isinf(expected) | (expected == 0)
    with np.errstate(invalid="ignore", divide="ignore"):
        error = np.where(exact, 0, np.abs(got - expected) / expected / sens)
    assert_rows(np.where(exact, got == expected, error <= arithmetic.target), selected, got)
    report("columns, worst relative error over sens", error, selected)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_free_flights(arithmetic, report):
    selected = rows.table("inverse")
    assert len(selected) > 100

    def medium(row):
        mu = [component["mu"] for component in row["components"]]
        return am.Medium(zip(row["profiles"], mu, strict=True))

    got = arithmetic.ask(selected, medium, "free_flight", "origin", "dir", "t_max", "tau")
    expected, tau, total, mu_at_t = (
        numbers(selected, key) for key in ("t", "tau", "tau_max", "mu_at_t")
    )
    cond = np.array([max(row["cond"] or 1, 1) for row in selected])

    # Within rounding of the whole optical depth, "inf" and a distance are both right.
    edge = np.abs(tau - total) <= arithmetic.target * total
    endless = np.isinf(expected) | np.isinf(got)
    with np.errstate(invalid="ignore"):
        error = np.abs(got - expected)
    # The optical depth that the error in t amounts to.
    residual = np.where(endless, 0, error * mu_at_t / np.maximum(tau, 1))
    close = (error <= arithmetic.target * cond * expected) | (residual <= arithmetic.target)
    assert_rows(np.where(endless, (got == expected) | edge, close), selected, got)
    report("free flights, worst residual", residual, selected)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("domain", ["segment", "box"])
def test_bounds(arithmetic, report, domain):
    selected = [row for row in rows.table("majorant") if row["domain"] == domain]
    assert len(selected) > 50
    question = (
        ("bounds", "origin", "dir", "t") if domain == "segment" else ("bounds_box", "lo", "hi")
    )
    inf, sup = arithmetic.ask(selected, lambda row: row["profiles"][0], *question).T
    true_inf, true_sup = numbers(selected, "inf"), numbers(selected, "sup")

    # In single precision they bound the density of the rounded inputs.
    if arithmetic.target == DOUBLE:
        assert_rows((inf <= true_inf) & (sup >= true_sup), selected, inf, sup)
    scale = np.array([condition(row) for row in selected]) * np.minimum(true_sup, 1e300)
    for got, expected in ((inf, true_inf), (sup, true_sup)):
        with np.errstate(invalid="ignore", divide="ignore"):
            error = np.where(got == expected, 0, np.abs(got - expected) / scale)
        assert_rows(error <= arithmetic.target, selected, inf, sup)
        report("bounds, widest", error, selected)


def condition(row):
    """Relative change of the density per relative change of the coordinates."""
    p = row["profile"]
    if row["domain"] == "box":
        extent = max(abs(x) for x in row["lo"] + row["hi"])
    else:
        t = float(row["t"])
        extent = max(abs(x) for x in row["origin"]) + (t if np.isfinite(t) else 0)
    scale = 0
    if p["type"] == "exponential":
        scale = (extent + abs(p["h0"])) / p["H"]
    elif p["type"] == "linear":
        sup = float(row["sup"])
        scale = (abs(p["a"]) * extent + abs(p["k"])) / (sup if 0 < sup < np.inf else 1)
    return 1 + 3 * scale
