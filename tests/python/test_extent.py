"""Media that end at a sphere: precise at the size of a planet, and the same to every integrator."""

import mitsuba as mi
import numpy as np
import pytest
import render_scenes as scenes
from zscores import assert_agree, render_passes

scalar_and_llvm = pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"], indirect=True)

# In kilometres: the origin of coordinates is on the planet's surface, the medium ends above it.
CENTER, RADIUS = np.array([0.0, 0.0, -6360.0]), 6460.0


def atmosphere():
    sphere = {"bsphere_center": CENTER.tolist(), "bsphere_radius": RADIUS}
    return mi.load_dict({"type": "analytic"} | sphere)


def directions(rng, n):
    d = rng.normal(size=(n, 3))
    return (d / np.linalg.norm(d, axis=1, keepdims=True)).astype(np.float32)


def clip(medium, origins, towards):
    """What intersect_aabb says, as arrays."""
    answers = []
    for o, d in zip(origins.tolist(), towards.tolist(), strict=True):
        ray = mi.Ray3f(mi.Point3f(*o), mi.Vector3f(*d))
        answers.append([np.array(x).item() for x in medium.intersect_aabb(ray)])
    hit, near, far = zip(*answers, strict=True)
    return np.array(hit, dtype=bool), np.array(near), np.array(far)


def exact(origins, towards):
    """Both roots in double precision, nan where the line misses."""
    d = towards.astype(float)
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    v = origins.astype(float) - CENTER
    b, q = (v * d).sum(1), (v * v).sum(1) - RADIUS**2
    with np.errstate(invalid="ignore"):
        root = np.sqrt(b * b - q)
    return -b - root, -b + root


@scalar_and_llvm
def test_the_end_of_an_atmosphere_seen_from_within(variant, rng):
    """Origins near that of the coordinates, up to 1 m below the end: the distance to it is right
    to rounding, though the planet is 10 000 000 times as large."""
    altitudes = np.concatenate([rng.uniform(0, 99, 100), 100 - 10 ** rng.uniform(-3, 0, 100)])
    origins = np.zeros((200, 3), np.float32)
    origins[:, 2] = altitudes
    towards = directions(rng, 200)
    hit, near, far = clip(atmosphere(), origins, towards)
    assert hit.all()
    assert (near == 0).all()
    _, expected = exact(origins, towards)
    # The rounding of altitudes, over the slope at which the ray leaves.
    rounding = 4 * 2**-24 * (100 + expected)
    radius = origins[:, 2] + 6360.0
    slope = np.sqrt(RADIUS**2 - radius**2 * (1 - towards[:, 2] ** 2)) / RADIUS
    error = np.abs(far - expected) * slope
    print(f"\n    worst error over bound: {np.max(error / rounding):.2f}", end="")
    assert (error <= rounding).all()


@scalar_and_llvm
def test_the_end_of_an_atmosphere_seen_from_orbit(variant, rng):
    origins = (CENTER + directions(rng, 200) * rng.uniform(6470, 50000, (200, 1))).astype(
        np.float32
    )
    targets = CENTER + directions(rng, 200) * rng.uniform(0, 6450, (200, 1))
    towards = targets - origins
    towards = (towards / np.linalg.norm(towards, axis=1, keepdims=True)).astype(np.float32)
    hit, near, far = clip(atmosphere(), origins, towards)
    expected_near, expected_far = exact(origins, towards)
    assert hit.all()
    size = np.abs(origins).max(1)
    slope = (expected_far - expected_near) / (2 * RADIUS)
    for got, expected in ((near, expected_near), (far, expected_far)):
        error = np.abs(got - expected) * slope / (2**-24 * (size + RADIUS))
        print(f"\n    worst error in roundings: {error.max():.1f}", end="")
        assert (error <= 8).all()


@scalar_and_llvm
def test_rays_that_miss_the_sphere(variant, rng):
    """They pass it, or it is behind them."""
    medium = atmosphere()
    origins = (CENTER + [[0, 0, 7000.0]] * 50).astype(np.float32)
    away = directions(rng, 50)
    away[:, 2] = np.abs(away[:, 2])
    level = np.tile(np.float32([[1, 0, 0]]), (50, 1))
    for towards in (away, level):
        assert not clip(medium, origins, towards)[0].any()


@scalar_and_llvm
def test_density_ends_at_the_sphere(variant):
    medium = mi.load_dict(
        {"type": "analytic", "bsphere_center": [1, 0, 0], "bsphere_radius": 2.0, "sigma_t": 0.5}
    )
    mei = mi.MediumInteraction3f()
    for x, expected in ((-0.99, 0.5), (2.99, 0.5), (-1.01, 0.0), (3.01, 0.0)):
        mei.p = mi.Point3f(x, 0, 0)
        sigma_t = np.array(medium.get_scattering_coefficients(mei)[2]).ravel()
        np.testing.assert_array_equal(sigma_t, expected)


@scalar_and_llvm
@pytest.mark.parametrize("integrator", ["analyticvolpath", "volpath"])
def test_a_medium_that_ends_at_a_sphere_needs_no_boundary(variant, integrator):
    """It fills all of space but for its sphere; stock has a homogeneous ball with a boundary."""
    sphere = {"bsphere_center": [0, 0, 0], "bsphere_radius": 1.0}
    stock = scenes.ball(scenes.homogeneous_fog())
    ours = scenes.ball(None)
    del ours["fog"]
    ours["sensor"]["medium"] = scenes.constant_fog(**sphere)

    def render(scene, plugin, side):
        return render_passes(scene, {"type": plugin, "max_depth": 6}, side, spp=2)

    assert_agree(render(stock, "volpath", 0), render(ours, integrator, 1))
