"""Renders whose pixels are known by thought: white furnaces, exact shadows, survival fractions."""

import mitsuba as mi
import numpy as np
import pytest
import render_scenes as scenes
from scipy import stats
from zscores import render_passes

import analytic_media as am

BOX = {"bbox_min": [-1, -1, -1], "bbox_max": [1, 1, 1]}
EXPONENTIAL = {"profile": "exponential", "scale_height": 0.8, "base_height": -0.5}
PROFILES = {
    "constant": {"profile": "constant"},
    "linear": {"profile": "linear", "gradient": -1.0, "density": 0.7},  # none above 0.7
    "exponential": EXPONENTIAL,
}
INTEGRATORS = {
    name: {"type": name, "max_depth": -1, "rr_depth": 100_000}
    for name in ("analyticvolpath", "volpath", "volpathmis")
}
profiles = pytest.mark.parametrize("profile", PROFILES)
scalar_and_llvm = pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"], indirect=True)
scalar_rgb = pytest.mark.parametrize("variant", ["scalar_rgb"], indirect=True)


def fog(profile, **options):
    return {"type": "analytic"} | PROFILES[profile] | BOX | options


def profile_object(profile, up):
    parameters = {key: value for key, value in PROFILES[profile].items() if key != "profile"}
    if profile == "constant":
        return am.Constant()
    return {"linear": am.Linear, "exponential": am.Exponential}[profile](up=up, **parameters)


# ---- White furnace


def furnace(medium, inside, size=16):
    """A ball of fog under a sky of radiance 1 and nothing else."""
    origin = [0, -0.5, 0.1] if inside else [0, -3, 0.4]
    ball = scenes.sphere([0, 0, 0], 1, bsdf={"type": "null"}, interior=medium)
    sensor = scenes.camera(
        origin, [0, 0, 0], 25, medium=medium if inside else None, pixel_format="rgb", size=size
    )
    return {"type": "scene", "sensor": sensor, "ball": ball, "sky": scenes.sky(1.0)}


@scalar_rgb
@profiles
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("inside", [False, True], ids=["outside", "inside"])
def test_every_path_of_a_white_furnace_brings_1(variant, profile, integrator, inside):
    """Nothing is absorbed, and what light a path finds is never shared with a light sample."""
    medium = fog(profile, sigma_t=3.0, albedo=1.0, sample_emitters=False)
    scene = furnace(medium, inside) | {"integrator": INTEGRATORS[integrator]}
    image = np.array(mi.render(mi.load_dict(scene), spp=16))
    np.testing.assert_allclose(image, 1, rtol=2e-6)


@scalar_and_llvm
@profiles
@pytest.mark.parametrize("colour", ["grey", "chromatic"])
def test_white_furnace_with_light_samples(variant, profile, colour):
    """1 in the mean: light and phase samples share, and colours are weighted."""
    sigma_t = 2.0 if colour == "grey" else {"type": "rgb", "value": [0.5, 2.0, 6.0]}
    medium = fog(profile, sigma_t=sigma_t, albedo=1.0, phase=scenes.PHASE)
    integrator = {"type": "analyticvolpath", "max_depth": -1}
    passes = render_passes(furnace(medium, True), integrator, 0, spp=64)
    of_pass = passes.mean(1)
    error = of_pass.std(0, ddof=1) / np.sqrt(len(of_pass))
    print(f"\n    {of_pass.mean(0)} ± {error}", end="")
    assert (error < 0.005).all()
    assert (abs(of_pass.mean(0) - 1) <= 4 * error).all()


# ---- Limits


@scalar_and_llvm
@pytest.mark.parametrize(
    "uniform",
    [
        {"profile": "exponential", "scale_height": 1e30},
        {"profile": "linear", "gradient": 0.0, "density": 1.0},
    ],
    ids=lambda profile: profile["profile"],
)
def test_falloff_0_is_the_constant_profile(variant, uniform):
    """The formulas are smooth through it: the same image, bit for bit."""
    images = []
    for profile in ({"profile": "constant"}, uniform):
        scene = scenes.ball(scenes.constant_fog(**profile), pixel_format="rgb")
        scene["integrator"] = {"type": "analyticvolpath", "max_depth": 8}
        images.append(np.array(mi.render(mi.load_dict(scene), spp=8, seed=3)))
    np.testing.assert_array_equal(*images)


# ---- Transmittance

UPS = {
    "up": [0, 0, 1],
    "down": [0, 0, -1],
    "horizontal": [1, 0, 0],
    "slanted": [0.6, 0, 0.8],
}
RAY_EPSILON = 1500 * 2.0**-24
LIGHT_POINT = np.array([0.4, -0.3, 3.0])


def shadow_of_fog(medium, light):
    """Light falls through a cube of fog on a floor, which the camera sees from below the cube.

    The cube is the medium's own box: a boundary shape would cost it Mitsuba's ray epsilon.
    """
    sensor = scenes.camera(
        [0, -0.5, -1.1], [0, 0, -2], 90, medium=medium, pixel_format="rgb", size=32
    )
    return {
        "type": "scene",
        "integrator": {
            "type": "aov",
            "aovs": "p:position",
            "nested": {"type": "analyticvolpath", "max_depth": 2},
        },
        "sensor": sensor,
        "floor": scenes.floor(-2, 30),
        "light": light,
    }


def towards(light, points):
    """Unit vectors and distances to the light."""
    if light == "sun":
        return np.broadcast_to([0.0, 0.0, 1.0], points.shape), np.inf
    offset = LIGHT_POINT - points
    distance = np.linalg.norm(offset, axis=-1)
    return offset / distance[:, None], distance


def box_segment(o, d):
    """Where rays enter and leave the cube from -1 to 1."""
    with np.errstate(divide="ignore"):
        a, b = (-1 - o) / d, (1 - o) / d
    near = np.minimum(a, b).max(-1)
    far = np.maximum(a, b).min(-1)
    inside = near < far
    return np.where(inside, near, 0), np.where(inside, far, 0)


def render_shadow(profile, direction, light, sigma_t, extra=()):
    """Radiance of every pixel, and as closed forms: without fog, and the optical depth."""
    up = UPS[direction]
    options = {} if profile == "constant" else {"up": up}
    medium = fog(profile, sigma_t=sigma_t, albedo=0.0, **options)
    if light == "sun":
        source = scenes.sun(2.0) | {"direction": [0, 0, -1]}
    else:
        source = scenes.lamp(LIGHT_POINT.tolist(), 10.0)
    scene = shadow_of_fog(medium, source) | dict(extra)
    image = np.array(mi.render(mi.load_dict(scene), spp=1))
    o = image[..., -3:].reshape(-1, 3).astype(float)

    d, distance = towards(light, o)
    irradiance = 2.0 if light == "sun" else 10.0 / distance**2
    # Shadow rays start Mitsuba's ray epsilon above the floor.
    start = o + np.array([0, 0, 1]) * RAY_EPSILON * (1 + abs(o).max(-1, keepdims=True))
    shadow, _ = towards(light, start)
    near, far = box_segment(start, shadow)
    model = am.Medium([(profile_object(profile, up), sigma_t)])
    depth = model.optical_depth(start + near[:, None] * shadow, shadow, far - near)
    # On the edges of the cube, a few pixels are on the other side by rounding.
    clear = abs(far - near) >= 1e-3
    got = image[..., 0].reshape(-1).astype(float)
    return got[clear], (0.5 / np.pi * irradiance * d[:, 2])[clear], depth[clear]


directions = pytest.mark.parametrize(
    ("profile", "direction"),
    [("constant", "up")] + [(p, d) for p in ("linear", "exponential") for d in UPS],
)


@scalar_and_llvm
@directions
@pytest.mark.parametrize("light", ["sun", "lamp"])
@pytest.mark.parametrize("sigma_t", [0.3, 20.0])
def test_light_arrives_with_the_exact_transmittance(variant, profile, direction, light, sigma_t):
    """Absorbing fog between light and floor: no noise, so every pixel is a closed form."""
    # Where there are boundaries to pass, thick fog plays no roulette for shadow rays.
    far_away = scenes.sphere([0, 0, -100], 1, bsdf={"type": "null"})
    extra = {"boundary": far_away} if sigma_t > 1 else {}
    got, bare, depth = render_shadow(profile, direction, light, sigma_t, extra)
    assert depth.max() > 0.3  # the fog does lie between
    error = abs(got / (bare * np.exp(-depth)) - 1)
    assert error.max() <= 1e-5 * (1 + depth.max()), (error.max(), depth[error.argmax()])


@scalar_and_llvm
@pytest.mark.parametrize("profile", PROFILES)
def test_roulette_for_shadow_rays_keeps_the_transmittance(variant, profile):
    """Below a transmittance of 1/4 a ray counts for 1/4 or not at all."""
    got, bare, depth = render_shadow(profile, "up", "sun", 2.0)
    share, p = got / bare, np.exp(-depth)
    dim = p < 0.25 - 1e-3
    assert dim.sum() > 100
    assert set(np.round(share[dim], 4)) == {0.0, 0.25}
    variance = np.sum((p * (0.25 - p))[dim])
    assert abs(np.sum((share - p)[dim])) <= 4 * np.sqrt(variance)


@scalar_and_llvm
@profiles
def test_thick_fog_gives_finite_pixels(variant, profile):
    """Optical depths to hundreds, and a hundredfold between colours: exp(-τ) underflows."""
    sigma_t = {"type": "rgb", "value": [1.0, 50.0, 400.0]}
    scene = scenes.ball(fog(profile, sigma_t=sigma_t, albedo=0.9), pixel_format="rgb", size=32)
    scene["integrator"] = {"type": "analyticvolpath", "max_depth": 16}
    image = np.array(mi.render(mi.load_dict(scene), spp=16))
    assert np.isfinite(image).all()
    assert (image >= 0).all()
    assert image.max() < 100


# ---- Free flight


@scalar_and_llvm
@directions
def test_survivors_of_free_flight_are_binomial(variant, profile, direction):
    """A glowing wall at another distance in every pixel: the camera sees the share of paths whose
    flight reaches it, so the pixels together test the distribution of flights (χ², 1e-4)."""
    up, size, spp = UPS[direction], 24, 4096
    options = {} if profile == "constant" else {"up": up}
    # No box: the wall is what ends a flight.
    medium = {"type": "analytic", "sigma_t": 1.5, "albedo": 0.0} | PROFILES[profile] | options
    to_world = mi.ScalarTransform4f().translate([0, 0, 0.2]).rotate([1, 0, 0], 220).scale(20)
    glow = {"type": "area", "radiance": 1.0}
    wall = {"type": "rectangle", "to_world": to_world, "emitter": glow}
    sensor = scenes.camera([0, 0, -0.9], [0, 0.1, 0.1], 70, medium=medium, size=size)
    scene = {"type": "scene", "sensor": sensor, "wall": wall}
    scene["integrator"] = {"type": "analyticvolpath", "max_depth": 1}
    loaded = mi.load_dict(scene)
    image = np.array(mi.render(loaded, spp=spp), dtype=float).reshape(-1)

    # Probability of a pixel: two Gauss points across it each way.
    gauss = (np.array([-1, 1]) / np.sqrt(3) + 1) / 2
    x = ((np.arange(size)[:, None] + gauss) / size).ravel()
    positions = np.stack(np.meshgrid(x, x), -1).reshape(-1, 2)
    o, d, t = first_hits(loaded, positions)
    survival = am.Medium([(profile_object(profile, up), 1.5)]).transmittance(o, d, t)
    p = survival.reshape(size, 2, size, 2).mean((1, 3)).ravel()
    testable = (spp * p > 10) & (spp * (1 - p) > 10)
    assert testable.sum() > 400
    z = (image - p)[testable] / np.sqrt(p * (1 - p) / spp)[testable]
    significance = stats.chi2.sf(np.sum(z**2), testable.sum())
    print(f"\n    {testable.sum()} pixels, p = {significance:.3f}, mean z {z.mean():+.3f}", end="")
    assert significance > 1e-4
    assert abs(z.mean()) < 4 / np.sqrt(testable.sum())


def first_hits(scene, positions):
    """Rays through positions in the picture, and the distance to what they hit."""
    dr = pytest.importorskip("drjit")
    sensor = scene.sensors()[0]
    if dr.is_jit_v(mi.Float):
        ray, _ = sensor.sample_ray(0, 0.5, mi.Point2f(positions.T), mi.Point2f(0.5))
        si = scene.ray_intersect(ray)
        return *(np.array(v, dtype=float).T for v in (ray.o, ray.d)), np.array(si.t, dtype=float)
    rays = [sensor.sample_ray(0, 0.5, mi.Point2f(*p), mi.Point2f(0.5))[0] for p in positions]
    t = [scene.ray_intersect(ray).t for ray in rays]
    return (np.array(v, dtype=float) for v in ([r.o for r in rays], [r.d for r in rays], t))
