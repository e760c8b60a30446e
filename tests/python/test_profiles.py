"""Profiles on NumPy arrays: their parameters, limits, and shapes."""

import copy
import pickle

import numpy as np
import pytest

import analytic_media as am
from analytic_media import _native

HORIZONTAL, UP, DOWN = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)
TILTED = (0.6, 0.0, 0.8)

PROFILES = [
    am.Constant(),
    am.Linear(gradient=-0.05, density=1.5, base_height=2, up=TILTED),
    am.Linear(gradient=0.02, density=-0.1),
    am.Exponential(scale_height=8, base_height=-3),
    am.Exponential(scale_height=0.5, up=TILTED),
    am.Spherical(center=(0, 0, -40), radius=40, scale_height=8),
    am.Tent(center=(0, 0, -40), radius=40, height=6, width=12),
    am.Gaussian(center=(1, 2, 3), sigma=5),
    am.AnisotropicGaussian(
        center=(1, -2, 0), axis_u=(6, 0, 8), axis_v=(0, 8, 0), axis_w=(-4.8, 0, 3.6)
    ),
    am.RadialGaussian(center=(0, 0, -40), radius=40, scale_height=8),
]
each_profile = pytest.mark.parametrize("profile", PROFILES, ids=repr)
each_float = pytest.mark.parametrize("dtype", [np.float64, np.float32], ids=["f64", "f32"])


# ---- Parameters


def test_every_kind_of_the_library_has_a_class():
    classes = {cls._kind.number: cls for cls in am.Profile.__subclasses__()}
    for kind in _native.kinds():
        words = kind.name.split("_")
        assert classes[kind.number].__name__ == "".join(word.capitalize() for word in words)
        assert classes[kind.number].__doc__


def test_names_orders_and_defaults_come_from_the_library():
    p = am.Exponential(scale_height=3)
    assert p.parameters == {"scale_height": 3.0, "base_height": 0.0, "up": UP}
    q = am.Linear(gradient=1, density=2, base_height=4, up=[0, 1, 0])
    assert q.parameters == {"gradient": 1, "density": 2, "base_height": 4, "up": (0, 1, 0)}
    assert am.Constant().parameters == {}
    assert next(iter(am.Exponential.__signature__.parameters)) == "scale_height"


def test_a_parameter_reaches_the_formula_that_it_names():
    x = (3.0, 4.0, 5.0)
    linear = am.Linear(gradient=0.25, density=2, base_height=1, up=(0, 1, 0))
    assert linear.density(x) == 2 + 0.25 * (4 - 1)
    exponential = am.Exponential(scale_height=2, base_height=1, up=(1, 0, 0))
    assert exponential.density(x) == pytest.approx(np.exp(-(3 - 1) / 2), rel=1e-15)


@each_profile
def test_profiles_are_values(profile):
    assert eval(repr(profile), vars(am)) == profile
    assert pickle.loads(pickle.dumps(profile)) == profile == copy.deepcopy(profile)
    assert hash(copy.copy(profile)) == hash(profile)
    assert profile != am.Exponential(scale_height=1e3)
    with pytest.raises(AttributeError, match="cannot be changed"):
        profile.scale_height = 3
    with pytest.raises(TypeError):
        profile.parameters["up"] = UP


# ---- What is true of every profile


def blur(profile, dtype):
    """Error of a whole column: the edges of a tent are as sharp as altitudes are exact."""
    return 100 * np.finfo(dtype).eps if isinstance(profile, am.Tent) else 0


@each_profile
def test_column_is_the_integral_of_the_density(profile, rays):
    """Against Gauss-Legendre quadrature on 400 panels; the clamp of `Linear` is a kink."""
    o, d = rays
    t = 15.0
    nodes, weights = np.polynomial.legendre.leggauss(4)
    edges = np.linspace(0, t, 401)
    s = ((edges[1:] + edges[:-1])[:, None] + np.diff(edges)[:, None] * nodes).ravel() / 2
    w = (np.diff(edges)[:, None] * weights / 2).ravel()
    integral = profile.density(o[:, None] + s[:, None] * d[:, None]) @ w
    np.testing.assert_allclose(profile.column(o, d, t), integral, rtol=1e-10, atol=1e-4)


@each_profile
def test_columns_add_up(profile, rays):
    o, d = rays
    first, second = 3.25, 7.5
    parts = profile.column(o, d, first) + profile.column(o + first * d, d, second)
    np.testing.assert_allclose(parts, profile.column(o, d, first + second), rtol=2e-13, atol=1e-13)


@each_profile
def test_column_is_the_same_backwards(profile, rays):
    o, d = rays
    t = 11.0
    back = profile.column(o + t * d, -d, t)
    np.testing.assert_allclose(back, profile.column(o, d, t), rtol=1e-13, atol=1e-13)


@each_profile
@each_float
def test_column_does_not_decrease(profile, rays, dtype):
    """By more than its own rounding, 4 ulp: it levels off where the medium thins out."""
    o, d = (a.astype(dtype) for a in rays)
    t = np.concatenate([[0], np.geomspace(1e-6, 1e6, 400), [np.inf]]).astype(dtype)
    column = profile.column(o[:, None], d[:, None], t)
    assert column.dtype == dtype
    assert np.all(column[:, 0] == 0)
    before, after = column[:, :-1], column[:, 1:]
    eps = np.finfo(dtype).eps
    assert np.all(after >= before * (1 - 4 * eps) - blur(profile, dtype))


@each_profile
@each_float
@pytest.mark.parametrize("question", ["inv_column", "inv_reached_column"])
def test_inverse_undoes_the_column(profile, rays, dtype, question):
    """To within the target, times what an error in t amounts to: t · density / column."""
    o, d = (a.astype(dtype)[:, None] for a in rays)
    t = np.geomspace(1e-3, 10, 20).astype(dtype)
    column = profile.column(o, d, t)
    inverse = getattr(profile, question)(o, d, column)
    reached = np.isfinite(inverse) & (column > 0)
    assert reached.mean() > 0.3
    inverse = np.where(reached, inverse, 0)
    end = np.float64(o) + inverse[..., None] * np.float64(d)
    error = np.abs(profile.column(o, d, inverse) - column)
    target = 1e-12 if dtype == np.float64 else 2e-6
    expected = target * (column + inverse * profile.density(end)) + blur(profile, dtype)
    assert np.all((error <= expected)[reached])


@each_profile
def test_inverse_of_nothing_and_of_too_much(profile, rays):
    o, d = rays
    assert np.all(profile.inv_column(o, d, 0) == 0)
    endless = profile.column(o, d, np.inf)
    finite = np.isfinite(endless)
    too_much = profile.inv_column(o[finite], d[finite], 1.001 * endless[finite] + 1e-300)
    assert np.all(np.isinf(too_much))


@each_profile
@each_float
def test_bounds_contain_the_density(profile, rays, rng, dtype):
    o, d = (a.astype(dtype) for a in rays)
    t = dtype(9)
    inf, sup = profile.bounds(o, d, t)
    points = o + rng.uniform(0, 9, (50, 200, 1)).astype(dtype) * d
    density = profile.density(points)
    assert np.all((inf <= density) & (density <= sup))

    lo, hi = np.minimum(o, o + t * d), np.maximum(o, o + t * d)
    box_inf, box_sup = profile.bounds_box(lo, hi)
    inside = lo + rng.uniform(0, 1, (50, 200, 3)).astype(dtype) * (hi - lo)
    density = profile.density(np.clip(inside, lo, hi))
    assert np.all((box_inf <= density) & (density <= box_sup))


# ---- Limits


@each_float
@pytest.mark.parametrize(
    "uniform",
    [
        am.Exponential(scale_height=1e30, base_height=5, up=TILTED),
        am.Linear(gradient=0, density=1, base_height=5, up=TILTED),
    ],
    ids=["falloff 0", "gradient 0"],
)
def test_no_falloff_is_constant_bit_for_bit(uniform, rays, rng, dtype):
    o, d = (a.astype(dtype) for a in rays)
    amount = rng.lognormal(0, 3, 200).astype(dtype)
    constant = am.Constant()
    for question in ("column", "inv_column"):
        got, expected = (getattr(p, question)(o, d, amount) for p in (uniform, constant))
        assert np.array_equal(got, expected), question
    assert np.array_equal(uniform.density(o), constant.density(o))
    media = [am.Medium([(p, 0.3)]) for p in (uniform, constant)]
    for question in ("optical_depth", "transmittance", "opacity", "pdf"):
        got, expected = (getattr(m, question)(o, d, amount) for m in media)
        assert np.array_equal(got, expected), question


@each_float
@pytest.mark.parametrize(
    "profile",
    [
        am.Exponential(scale_height=7, base_height=1),
        am.Linear(gradient=-0.03, density=1, base_height=1),
    ],
    ids=["exponential", "linear"],
)
def test_rays_turn_through_the_horizon_smoothly(profile, dtype):
    """For small mu = cos zenith, N(mu) = N(0) (1 + c mu + O(mu²)), |c| < 1.5 for these rays."""
    mu = np.array([0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-3])
    mu = np.concatenate([-mu[:0:-1], mu])
    d = np.stack([np.sqrt(1 - mu**2), 0 * mu, mu], -1).astype(dtype)
    o, t = np.array([0, 0, 2], dtype), dtype(20)
    eps = np.finfo(dtype).eps
    for result in (profile.column(o, d, t), profile.inv_column(o, d, t / 2)):
        level = result[mu == 0]
        change = np.abs(result / level - 1)
        assert np.all(change <= 1.5 * np.abs(mu) + 4 * eps)
        middle = (result + result[::-1]) / 2
        assert np.all(np.abs(middle / level - 1) <= 3 * mu**2 + 4 * eps)
        assert np.all(np.diff(result) <= 0) or np.all(np.diff(result) >= 0)


def test_vertical_rays():
    p = am.Exponential(scale_height=4)
    assert p.column((0, 0, 0), UP, np.inf) == pytest.approx(4, rel=1e-15)
    assert p.column((0, 0, 0), UP, 4) == pytest.approx(4 * -np.expm1(-1), rel=1e-15)
    assert p.column((0, 0, 0), DOWN, 4) == pytest.approx(4 * np.expm1(1), rel=1e-15)
    assert p.column((0, 0, 0), DOWN, np.inf) == np.inf
    assert p.column((0, 0, 0), HORIZONTAL, np.inf) == np.inf
    assert p.inv_column((0, 0, 0), UP, 4.001) == np.inf


def test_linear_is_empty_beyond_its_top():
    p = am.Linear(gradient=-0.1, density=1)  # a triangle of height 10
    assert p.column((0, 0, 0), UP, np.inf) == p.column((0, 0, 0), UP, 10) == 5
    assert p.column((0, 0, 30), DOWN, 20) == pytest.approx(0, abs=1e-15)  # 1 - 0.1 · 10, rounded
    assert p.inv_column((0, 0, 30), DOWN, 5) == 30
    assert p.density((0, 0, 11)) == 0
    assert p.bounds((0, 0, 5), UP, np.inf)[0] == 0


# ---- Shapes and types


def test_scalars_give_scalars():
    p = am.Exponential(scale_height=4)
    assert isinstance(p.density((0, 0, 1)), np.float64)
    assert isinstance(p.density(np.float32([0, 0, 1])), np.float32)
    inf, sup = p.bounds((0, 0, 0), UP, 1)
    assert isinstance(inf, np.float64) and isinstance(sup, np.float64)


@pytest.mark.parametrize(
    ("o", "d", "t", "shape"),
    [
        ((3,), (3,), (), ()),
        ((5, 3), (3,), (), (5,)),
        ((3,), (3,), (5,), (5,)),
        ((4, 1, 3), (5, 3), (), (4, 5)),
        ((4, 1, 3), (1, 5, 3), (2, 1, 1), (2, 4, 5)),
        ((1, 3), (3,), (1, 1), (1, 1)),
        ((0, 3), (3,), (), (0,)),
        ((2, 0, 3), (2, 1, 3), (1,), (2, 0)),
    ],
)
def test_everything_broadcasts(rng, o, d, t, shape):
    p = am.Exponential(scale_height=4, up=TILTED)
    o, d, t = rng.normal(size=o), rng.normal(size=d), rng.uniform(0, 5, t)
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    got = p.column(o, d, t)
    assert np.shape(got) == shape
    full = [np.broadcast_to(a, (*shape, 3)).reshape(-1, 3) for a in (o, d)]
    each = zip(*full, np.broadcast_to(t, shape).ravel(), strict=True)
    expected = np.array([p.column(*ray) for ray in each])
    assert np.array_equal(np.ravel(got), expected)


@each_float
def test_views_need_no_copies_to_be_right(rng, dtype):
    """Strided, reversed, transposed, misaligned and byte-swapped arrays."""
    p = am.Exponential(scale_height=4, base_height=1, up=TILTED)
    wide = rng.normal(size=(12, 7)).astype(dtype)
    swapped = wide[:, :3].astype(np.dtype(dtype).newbyteorder())
    packed = np.zeros(12, np.dtype([("id", "u1"), ("x", dtype, 3)]))  # unaligned
    packed["x"] = wide[:, :3]
    views = [wide[:, 2:5], wide[::-1, :3], wide.T[:3].T, wide[::3, ::3], packed["x"], swapped]
    for x in views:
        expected = np.array([p.density(np.array(point, dtype)) for point in x])
        got = p.density(x)
        assert got.dtype == np.dtype(dtype)
        assert np.array_equal(got, expected)


def test_float_types():
    p, o, d, t = am.Exponential(scale_height=4), (0, 0, 0), UP, 2
    single, double = np.float32, np.float64
    assert p.column(single(o), single(d), single(t)).dtype == single
    assert p.column(single(o), d, t).dtype == single  # Python numbers do not count
    assert p.column(single(o), d, np.array([1, 2])).dtype == single  # nor do integers
    assert p.column(single(o), double(d), t).dtype == double
    assert p.column(single(o), d, double(t)).dtype == double
    assert p.column(np.float16(o), d, t).dtype == double
    assert p.column(o, d, t).dtype == double
