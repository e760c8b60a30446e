"""`distance_sampling`: its strategies against each other, stock volpath and closed forms.

zscores.py says what agreement means. Spread and bias are printed: pytest -s.
"""

import gc

import mitsuba as mi
import numpy as np
import pytest
import render_scenes as scenes
from scipy import integrate, stats
from zscores import assert_agree, render_passes

dr = pytest.importorskip("drjit", reason="Dr.Jit is not installed")

everywhere = pytest.mark.parametrize(
    "variant", ["scalar_rgb", "scalar_spectral", "llvm_ad_rgb", "llvm_ad_spectral"], indirect=True
)
scalar_and_llvm = pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"], indirect=True)
scalar_rgb = pytest.mark.parametrize("variant", ["scalar_rgb"], indirect=True)
llvm_rgb = pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)
strategies = pytest.mark.parametrize("strategy", ["equiangular", "mis"])

VOLPATH = {"type": "volpath"}
VOLPATHMIS = {"type": "volpathmis", "rr_depth": 1000}  # too dark while it plays roulette


def ours(strategy, **options):
    return {"type": "analyticvolpath", "distance_sampling": strategy} | options


# ---- Means


def colour(variant, red, green, blue):
    """A coefficient that varies with colour, or with wavelength."""
    if "spectral" in variant:
        return {"type": "spectrum", "value": [(360, blue), (550, green), (830, red)]}
    if "mono" in variant:
        return green
    return {"type": "rgb", "value": [red, green, blue]}


PROFILES = {"constant": {}, "exponential": {"profile": "exponential", "scale_height": 0.7}}
media = pytest.mark.parametrize(
    ("profile", "chromatic"),
    [("constant", False), ("exponential", True)],
    ids=["constant, grey", "exponential, chromatic"],
)


def fog(variant, profile="exponential", chromatic=True, **options):
    coefficients = {"sigma_t": 0.8, "albedo": 0.9}
    if chromatic:
        coefficients = {
            "sigma_t": colour(variant, 0.5, 0.8, 1.2),
            "albedo": colour(variant, 0.95, 0.85, 0.7),
        }
    box = {"bbox_min": [-1, -1, -1], "bbox_max": [1, 1, 1]}
    return scenes.constant_fog(**coefficients | PROFILES[profile] | box | options)


def headlight(position, target, intensity):
    return {
        "type": "spot",
        "to_world": mi.ScalarTransform4f().look_at(position, target, [0, 0, 1]),
        "intensity": {"type": "uniform", "value": intensity},
        "cutoff_angle": 50,
    }


LIGHTS = ("lamp", "headlight")


OUTSIDE = {"lamp": [-0.1, -0.8, 1.15], "headlight": [1.2, -0.8, -0.3]}
INSIDE = {"lamp": [-0.1, -0.5, 0.62], "headlight": [0.2, -0.6, -0.48]}


def lantern(medium, space=False, lights=OUTSIDE, **film):
    """The ball of fog with a lamp and a headlight close to it, a glowing sphere, a sun and a sky.
    In black `space` it is a cube with the lamp and the headlight only, and no boundary.

    The lights are outside of the fog, since inside of it the variance of free flights is infinite.
    """
    found = scenes.ball(medium, **{"pixel_format": "rgb"} | film)
    found["lamp"] = scenes.lamp(lights["lamp"], 0.6)
    found["headlight"] = headlight(lights["headlight"], [0, 0.2, 0.1], 1.2)
    if space:
        del found["sky"], found["sun"], found["glow"], found["fog"]
        found["sensor"]["medium"] = medium
    return found


def passes(scene, integrator, side, spp=4, max_depth=4):
    return render_passes(scene, {"max_depth": max_depth} | integrator, side, spp)


@pytest.fixture(scope="module")
def reference(variant):
    """Passes of free flights, rendered once per variant and scene."""
    done = {}

    def render(name, made):
        if name not in done:
            done[name] = passes(made, ours("free_flight"), 0, spp=8)
        return done[name]

    return render


@everywhere
@media
@strategies
def test_strategies_agree(variant, reference, profile, chromatic, strategy):
    made = lantern(fog(variant, profile, chromatic))
    assert_agree(reference(f"{profile} {chromatic}", made), passes(made, ours(strategy), 1))


@everywhere
@media
def test_mis_agrees_with_stock(variant, profile, chromatic):
    made = lantern(fog(variant, profile, chromatic))
    stock = VOLPATHMIS if chromatic else VOLPATH
    assert_agree(passes(made, stock, 0, spp=8), passes(made, ours("mis"), 1))


@scalar_and_llvm
@strategies
def test_strategies_agree_in_space(variant, reference, strategy):
    """No environment, so that collisions are forced."""
    made = lantern(fog(variant), space=True)
    assert_agree(reference("space", made), passes(made, ours(strategy), 1), pixels=3500)


@scalar_and_llvm
def test_strategies_agree_on_lights_in_the_fog(variant):
    """Pixel by pixel where the noise is bounded; whole images of free flights, whose is not."""
    made = lantern(fog(variant), lights=INSIDE)
    sides = {
        strategy: passes(made, ours(strategy), side)
        for side, strategy in enumerate(("free_flight", "equiangular", "mis"))
    }
    assert_agree(sides["equiangular"], sides["mis"])
    flights, mis = (sides[strategy].mean((1, 2)) for strategy in ("free_flight", "mis"))
    assert stats.ttest_ind(flights, mis, equal_var=False).pvalue > 1e-4
    assert sides["mis"].var(0).mean() < 0.5 * sides["free_flight"].var(0).mean()


@scalar_and_llvm
@pytest.mark.parametrize("space", [False, True], ids=["sky", "space"])
@pytest.mark.parametrize(
    "options",
    [
        {"spectral_sampling": "single"},
        {"spectral_sampling": "average"},
        {"spectral_sampling": "tracking"},
        {"spectral_sampling": "tracking", "absorption": "analogue"},
        {"absorption": "analogue"},
        {"emitter_samples": 3},
    ],
    ids=lambda options: " ".join(map(str, options.values())),
)
def test_other_options_go_with_it(variant, reference, options, space):
    """In a sum with a component that does not scatter."""
    medium = {
        "type": "overlap",
        "fog": fog(variant),
        "haze": scenes.constant_fog(sigma_t=0.2, albedo=0.9, phase={"type": "rayleigh"}),
        "ozone": scenes.constant_fog(sigma_t=colour(variant, 0.1, 0.3, 0.05), albedo=0.0),
        "bbox_min": [-1, -1, -1],
        "bbox_max": [1, 1, 1],
    }
    for corner in ("bbox_min", "bbox_max"):
        del medium["fog"][corner]
    made = lantern(medium, space)
    spp = 12 if options.get("spectral_sampling") == "single" else 4
    assert_agree(
        reference(f"sum {space}", made),
        passes(made, ours("mis", **options), 1, spp=spp),
        pixels=3500,
    )


@pytest.mark.parametrize(
    "variant",
    ["llvm_ad_mono", "scalar_spectral_polarized", "llvm_ad_mono_polarized"],
    indirect=True,
)
@strategies
def test_strategies_agree_in_other_variants(variant, reference, strategy):
    """Gold polarises, so that Mueller matrices meet the medium."""
    made = lantern(fog(variant)) | {"stone": scenes.sphere([0.2, 0, -0.1], 0.4, bsdf=scenes.GOLD)}
    del made["glow"]  # NaN to stock in polarised variants
    assert_agree(reference("gold", made), passes(made, ours(strategy), 1))


@scalar_and_llvm
@strategies
def test_strategies_agree_beside_stock_media(variant, reference, strategy):
    """Only what is in media of ours is lit by equiangular sampling."""
    made = lantern(fog(variant, chromatic=False))
    fog_of_stock = {"type": "homogeneous", "sigma_t": 1.5, "albedo": 0.8, "phase": scenes.PHASE}
    made["stone"] = scenes.sphere(
        [-0.1, -0.3, 0.0],
        0.4,
        bsdf={"type": "null"},
        interior=fog_of_stock,
        exterior=made["fog"]["interior"],
    )
    assert_agree(reference("stock", made), passes(made, ours(strategy), 1))


@scalar_rgb
@strategies
@pytest.mark.parametrize("max_depth", [2, 3])
def test_max_depth_means_the_same(variant, strategy, max_depth):
    made = lantern(fog(variant, chromatic=False), space=True)
    # Free flights are skewed near a light: few samples of them have a mean that is too low.
    sides = [
        passes(made, ours(which), side, spp=spp, max_depth=max_depth)
        for side, (which, spp) in enumerate({"free_flight": 32, strategy: 8}.items())
    ]
    assert_agree(*sides, pixels=3500)


@scalar_and_llvm
@strategies
def test_without_lights_at_a_point_nothing_changes(variant, strategy):
    """Path for path."""
    made = lantern(fog(variant), size=32)
    for light in LIGHTS:
        del made[light]
    images = [
        np.array(mi.render(mi.load_dict(made | {"integrator": ours(which)}), spp=4, seed=1))
        for which in ("free_flight", strategy)
    ]
    np.testing.assert_array_equal(*images)


@scalar_and_llvm
@pytest.mark.parametrize("kind", ["envmap", "sunsky", "directionalarea", "projector"])
def test_other_kinds_of_lights_do_no_harm(variant, kind):
    """JIT variants record calls of all lights of a scene, wherever they go."""
    bitmap = mi.Bitmap(np.full((4, 8, 3), 0.5, dtype=np.float32))
    texture = {"type": "bitmap", "bitmap": bitmap, "raw": True}
    made = lantern(fog(variant), size=16)
    del made["sky"], made["glow"]
    made["other"] = {
        "envmap": {"type": "envmap", "bitmap": bitmap},
        "sunsky": {"type": "sunsky"},
        "directionalarea": {
            "type": "rectangle",
            "emitter": {"type": "directionalarea", "radiance": {"type": "uniform", "value": 1.0}},
        },
        "projector": {"type": "projector", "irradiance": texture, "fov": 60},
    }[kind]
    image = np.array(mi.render(mi.load_dict(made | {"integrator": ours("mis")}), spp=16))
    assert np.isfinite(image).all()
    assert (image.mean((0, 1)) > 0).all()


@scalar_and_llvm
@strategies
def test_media_that_do_not_sample_emitters_stay_dark(variant, strategy):
    """Light at a point meets them by light samples only."""
    made = lantern(fog(variant, sample_emitters=False), space=True, size=16)
    del made["stone"], made["floor"]
    image = np.array(mi.render(mi.load_dict(made | {"integrator": ours(strategy)}), spp=4))
    assert (image == 0).all()


# ---- Single scattering along given rays, in a medium that hardly weakens light


SIGMA_S = 1e-16  # 1/length
INTENSITY = 1e16


def scattered(a, h, strategy, phase, **medium):
    """Radiance of rays in the direction of x, from (a, h, 0), with a lamp at the origin."""
    gc.collect()  # a living medium would be part of every kernel
    fog = {"type": "analytic", "sigma_t": SIGMA_S, "albedo": 1.0, "phase": phase} | medium
    fog = mi.load_dict(fog)
    scene = mi.load_dict({"type": "scene", "lamp": scenes.lamp([0, 0, 0], INTENSITY)})
    integrator = mi.load_dict(ours(strategy, max_depth=2))
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(7, len(a))
    rays = mi.RayDifferential3f(mi.Point3f(mi.Float(a), mi.Float(h), 0), mi.Vector3f(1, 0, 0))
    found, _, _ = integrator.sample(scene, sampler, rays, fog)
    return np.array(found[0], dtype=np.float64)


def seen(a, b, h):
    """The integral of 1/(h² + s²) from a to b."""
    return (np.arctan(b / h) - np.arctan(a / h)) / h


ISOTROPIC = {"type": "isotropic"}
HEIGHTS = np.float32([1e-2, 0.3, 1.0, 40.0, 3000.0])


@llvm_rgb
@strategies
@pytest.mark.parametrize(
    ("start", "end"),
    [(-np.inf, np.inf), (-90, -5), (-5, 3), (2, 80), (1000, 1001)],
    ids=lambda x: f"{x:g}",
)
def test_every_sample_is_the_closed_form(variant, strategy, start, end):
    """Isotropic scattering without extinction: what equiangular sampling is made for. From outside
    of the medium's box and from inside; towards the light, away from it and past it."""
    box = {}
    if np.isfinite(start):
        box = {"bbox_min": [start, -1e4, -1], "bbox_max": [end, 1e4, 1]}
    a, h = np.meshgrid(np.float32([-200, -7, -1e-3, 0, 0.5, 40]), HEIGHTS)
    a, h = (np.repeat(x.ravel(), 64) for x in (a, h))
    found = scattered(a, h, strategy, ISOTROPIC, **box)
    a, h = a.astype(float), h.astype(float)
    entry, exit = np.maximum(a, start), np.maximum(end, a)
    expected = SIGMA_S * INTENSITY / (4 * np.pi) * seen(np.minimum(entry, exit), exit, h)
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-9)


def henyey_greenstein(cos, g):
    return (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * cos) ** 1.5)


@llvm_rgb
@pytest.mark.parametrize("g", [0.5, -0.5, 0.8, 0.95])
def test_noise_is_bounded_whatever_the_forward_peak(variant, g):
    """Of the whole line: the relative variance is π²/8 - 1 at most, and the mean is right."""
    count = 100_000
    found = scattered(
        np.full(count, -500.0), np.full(count, 0.5), "equiangular", {"type": "hg", "g": g}
    )
    # s = -h / tan(ψ)
    integral, _ = integrate.quad(
        lambda psi: henyey_greenstein(np.cos(psi), g), np.arctan2(0.5, 500.0), np.pi
    )
    expected = SIGMA_S * INTENSITY * integral / 0.5
    error = found.std(ddof=1) / np.sqrt(count)
    assert abs(found.mean() - expected) <= 4 * error, (found.mean(), expected, error)
    assert found.var() / expected**2 <= 1.05 * (np.pi**2 / 8 - 1)


@llvm_rgb
@pytest.mark.parametrize("g", [0.0, 0.7, -0.7])
def test_distances_are_distributed_like_their_density(variant, g):
    """Small balls of fog along the ray tell how many samples fall there: each has the brightness
    that quadrature gives it, within 4 standard errors (Šidák: 1 of 700 correct runs fails)."""
    count, h, sigma = 1_000_000, 0.5, 0.05
    phase = {"type": "hg", "g": g} if g else ISOTROPIC
    for centre in (-3.0, -1.0, -0.4, 0.0, 0.3, 0.7, 2.0):
        ball = {"profile": "gaussian", "center": [centre, h, 0], "sigma": sigma}
        found = scattered(np.full(count, -4.0), np.full(count, h), "equiangular", phase, **ball)

        def light(s, centre=centre):
            r = np.hypot(h, s)
            density = np.exp(-0.5 * ((s - centre) / sigma) ** 2)
            return density * henyey_greenstein(-s / r, g) / r**2

        integral, _ = integrate.quad(light, centre - 8 * sigma, centre + 8 * sigma)
        expected = SIGMA_S * INTENSITY * integral
        error = found.std(ddof=1) / np.sqrt(count)
        assert error < 0.05 * expected
        assert abs(found.mean() - expected) <= 4 * error, (centre, found.mean(), expected, error)


@llvm_rgb
@strategies
def test_rays_through_the_light_are_finite(variant, strategy):
    """Its own pixel is bright, but neither infinite nor NaN; from the light itself, too."""
    a = np.repeat(np.float32([-200, -1, -1e-6, 0, 1e-6, 3]), 1000)
    h = np.tile(np.float32([0, 1e-30, 1e-12, 1e-7]), len(a) // 4)
    found = scattered(a, h, strategy, ISOTROPIC)
    assert np.isfinite(found).all()
    assert (found >= 0).all()


# ---- Properties


@scalar_rgb
def test_bad_values_are_named(variant):
    with pytest.raises(
        RuntimeError, match=r"distance_sampling.*free_flight, equiangular, mis.*delta"
    ):
        mi.load_dict(ours("delta"))


@scalar_rgb
def test_the_strategy_is_printed(variant):
    assert "distance_sampling = free_flight" in str(mi.load_dict({"type": "analyticvolpath"}))
    assert "distance_sampling = mis" in str(mi.load_dict(ours("mis")))
