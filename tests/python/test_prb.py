"""`prbanalyticvolpath`: its images are those of `analyticvolpath`, its derivatives those of images.

Differences are of its images, with common random numbers. Every derivative is that of a mean over
the image, with weights, in a direction: a parameter's own value, or a change in absolute
terms.
"""

import gc

import mitsuba as mi
import numpy as np
import pytest
import render_scenes as scenes
from zscores import assert_agree, render_passes

dr = pytest.importorskip("drjit", reason="Dr.Jit is not installed")

SIZE = 12
PATHS = {"max_depth": 5, "rr_depth": 1000}
SPP, SEEDS = 512, 12
STEP = 0.1

EXPONENTIAL = {"type": "analytic", "sigma_t": 0.6, "albedo": 0.8, "phase": scenes.PHASE}
EXPONENTIAL |= scenes.EXPONENTIAL
LINEAR = {"type": "analytic", "profile": "linear", "gradient": -0.2, "density": 1.2}
LINEAR |= {"sigma_t": 0.3, "albedo": 0.6}
PLANET = {"type": "analytic", "profile": "spherical", "radius": 20.0, "center": [0, 0, -20.0]}
PLANET |= {
    "phase": scenes.PHASE,
    "bsphere_center": [0, 0, -20.0],
    "bsphere_radius": 26.0,
    "scale_height": 1.5,
}
COLOURS = {
    "rgb": {"type": "rgb", "value": [0.3, 0.6, 1.2]},
    "spectral": {"type": "spectrum", "value": [(360, 1.2), (550, 0.6), (830, 0.3)]},
}


def without(scene, *names):
    return {name: part for name, part in scene.items() if name not in names}


def height_fog(_):
    scene = scenes.valley(EXPONENTIAL | scenes.VALLEY_BOX, size=SIZE, pixel_format="rgb")
    # Spectra that are alike would be one parameter.
    return without(scene, "lamp") | {"sky": scenes.sky(0.65)}


def overlap(_):
    medium = {"type": "overlap", "low": EXPONENTIAL, "high": LINEAR} | scenes.VALLEY_BOX
    return without(scenes.valley(medium, size=SIZE, pixel_format="rgb"), "lamp")


def planet(_):
    """Black space: collisions are forced on rays that leave."""
    scene = scenes.valley(PLANET | {"sigma_t": 0.2, "albedo": 0.5}, size=SIZE, pixel_format="rgb")
    return without(scene, "sky", "lamp", "glow")


def chromatic(colours):
    """In a ball with a boundary, seen from outside."""
    fog = EXPONENTIAL | {"sigma_t": COLOURS[colours], "base_height": -1.0}
    return without(scenes.ball(fog, size=SIZE, pixel_format="rgb"), "lamp")


def two_media(_):
    """A ball of another medium, unbounded, in the fog."""
    scene = height_fog(_)
    fog = scene["sensor"]["medium"]
    inner = {"type": "analytic", "sigma_t": 1.5, "albedo": 0.7}
    null = {"type": "null"}
    ball = scenes.sphere([-0.8, 0.3, 1.0], 0.6, bsdf=null, interior=inner, exterior=fog)
    return scene | {"glow": ball}


# The directions by the ends of names: relative (a factor), or absolute.
RELATIVE = {"relative": True}
FOG = {"sigma_t": RELATIVE, "albedo": RELATIVE, "scale_height": RELATIVE, "base_height": 1.0}
SCENES = {
    "height fog": (
        height_fog,
        FOG
        | {"sun.irradiance": RELATIVE, "sky.radiance": RELATIVE}
        | {"glow.emitter.radiance": RELATIVE, "floor.bsdf.brdf_0.reflectance": RELATIVE},
    ),
    "overlap": (
        overlap,
        {"high.gradient": 0.1, "high.density": RELATIVE, "low.scale_height": RELATIVE}
        | {"high.albedo": RELATIVE, "low.sigma_t": RELATIVE},
    ),
    "planet": (
        planet,
        {"sigma_t": RELATIVE, "scale_height": RELATIVE, "phase_function.g": 1.0}
        | {"medium.radius": 1.5, "medium.center": (0.3, 0, 1.5)},
    ),
    "chromatic": (chromatic, {"sigma_t": RELATIVE, "albedo": RELATIVE, "base_height": 1.0}),
}
VARIANTS = ["llvm_ad_rgb", "llvm_ad_spectral"]
jit = pytest.mark.parametrize("variant", VARIANTS, indirect=True)
rgb = pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)


def load(name, variant):
    """A scene, its parameters, and the directions: keys and changes."""
    gc.collect()
    make, named = SCENES[name]
    scene = mi.load_dict(make(variant.split("_")[-1]))
    params = mi.traverse(scene)
    directions = {}
    for end, change in named.items():
        key = next(k for k in params.keys() if _is(k, end))  # noqa: SIM118
        directions[key] = params[key] if change is RELATIVE else type(params[key])(change)
    return scene, params, {key: type(params[key])(dr.detach(d)) for key, d in directions.items()}


def _is(key, name):
    return any(
        key.endswith(name + value) for value in ("", ".value", ".value.value", ".value.values")
    )


@pytest.fixture
def weights(rng):
    return rng.uniform(0.5, 1.5, (SIZE, SIZE, 3))


def integrator(name="prbanalyticvolpath", **options):
    return mi.load_dict({"type": name} | PATHS | options)


def backward(scene, params, directions, weights, spp, seed, **options):
    """Derivatives in all directions, by one reverse pass."""
    for key in directions:
        dr.enable_grad(params[key])
        dr.set_grad(params[key], 0)
    params.update()
    adjoint = mi.TensorXf(weights / weights.size)
    integrator(**options).render_backward(scene, params, adjoint, seed=seed, spp=spp)
    found = [_dot(dr.grad(params[key]), direction) for key, direction in directions.items()]
    for key in directions:
        dr.disable_grad(params[key])
    params.update()
    return found


def _dot(a, b):
    return float(np.sum(np.array(a, dtype=float) * np.array(b, dtype=float)))


def difference(scene, params, key, direction, weights, seed):
    """Of the order 4: that of the order 2 is up to 0.5 % off with this step."""
    value = type(params[key])(params[key])

    def mean(step):
        params[key] = value + step * direction
        params.update()
        image = mi.render(scene, integrator=integrator(), spp=SPP, seed=seed)
        return np.mean(np.array(image, dtype=float) * weights)

    near, far = ((mean(step) - mean(-step)) / (2 * step) for step in (STEP, 2 * STEP))
    params[key] = value
    params.update()
    return (4 * near - far) / 3


@jit
@pytest.mark.parametrize("name", SCENES)
def test_gradients_agree_with_differences(variant, weights, name):
    """Within 1 %, or 3 standard errors, which are small."""
    if name == "planet":  # air is brighter than black space, and darkens the ground
        weights[SIZE // 2 :] *= -1
    scene, params, directions = load(name, variant)
    adjoint = np.array(
        [backward(scene, params, directions, weights, SPP, seed) for seed in range(SEEDS)]
    )
    wrong = []
    for (key, direction), found in zip(directions.items(), adjoint.T, strict=True):
        differences = np.array(
            [
                difference(scene, params, key, direction, weights, 100 + seed)
                for seed in range(SEEDS)
            ]
        )
        got, expected = found.mean(), differences.mean()
        error = np.hypot(found.std(ddof=1), differences.std(ddof=1)) / np.sqrt(SEEDS)
        print(
            f"\n    {key}: {got:.5f}, differences {expected:.5f}: {got / expected - 1:+.2%}, "
            f"error {error / abs(expected):.2%}",
            end="",
        )
        if error > 0.03 * abs(expected) or abs(got - expected) > max(
            0.01 * abs(expected), 3 * error
        ):
            wrong.append(key)
    assert not wrong


@rgb
@pytest.mark.parametrize("name", ["height fog", "chromatic"])
def test_forward_mode_agrees_with_reverse_mode(variant, weights, name):
    """The same paths: equal but for rounding. Two parameters at once, whose derivatives add up."""
    scene, params, directions = load(name, variant)
    directions = {key: directions[key] for key in list(directions)[:2]}
    reverse = sum(backward(scene, params, directions, weights, 64, 3, follow_adjoint=False))
    for key in directions:
        dr.enable_grad(params[key])
    params.update()
    for key, direction in directions.items():
        dr.set_grad(params[key], direction)
    image = integrator().render_forward(scene, params, seed=3, spp=64)
    assert np.mean(np.array(image) * weights) == pytest.approx(reverse, rel=1e-4)


# ---- Paths that follow the adjoint image


@rgb
def test_paths_are_as_many_as_asked_for(variant, rng):
    """A tenth goes to every pixel alike, the rest in proportion."""
    from analytic_media.prb import camera

    for samples, pixels in ((1, 100), (16, 100), (64, 1000)):
        importance = rng.uniform(0, 1, pixels) ** 8
        found = np.diff(np.array(camera.counts(mi.Float(importance), samples)), prepend=0)
        assert found.sum() == samples * pixels
        least = max(samples // 10, 1)
        expected = least + (samples - least) * importance / importance.mean()
        assert np.abs(found - expected).max() <= 2 + 1e-4 * expected.max()
    even = np.array(camera.counts(mi.Float(np.zeros(7)), 16))
    np.testing.assert_array_equal(even, 16 * np.arange(1, 8))


@jit
@pytest.mark.parametrize("rfilter", ["box", "gaussian"])
@pytest.mark.parametrize("crop", [False, True])
def test_paths_that_follow_the_adjoint_have_the_same_mean(variant, rng, rfilter, crop):
    """With less noise, where the adjoint is that of a corner of the image."""
    gc.collect()
    scene = height_fog("")
    width, height = (SIZE - 3, SIZE - 2) if crop else (SIZE, SIZE)
    scene["sensor"]["film"] |= {"rfilter": {"type": rfilter}, "sample_border": crop}
    if crop:
        scene["sensor"]["film"] |= {"crop_offset_x": 2, "crop_offset_y": 1}
        scene["sensor"]["film"] |= {"crop_width": width, "crop_height": height}
    scene = mi.load_dict(scene)
    params = mi.traverse(scene)
    key = next(k for k in params.keys() if k.endswith("scale_height"))  # noqa: SIM118
    weights = np.zeros((height, width, 3))
    weights[-4:, :3] = rng.uniform(-0.5, 1.5, (4, 3, 3))
    even, followed = (
        np.ravel(
            [
                backward(scene, params, {key: params[key]}, weights, 32, seed, follow_adjoint=on)
                for seed in range(16)
            ]
        )
        for on in (False, True)
    )
    error = np.hypot(even.std(ddof=1), followed.std(ddof=1)) / 4
    print(f"\n    {even.mean():.5f}, {followed.mean():.5f}, error {error:.5f}", end="")
    assert abs(even.mean() - followed.mean()) < 3.5 * error
    assert followed.var(ddof=1) < 0.5 * even.var(ddof=1)


@rgb
def test_an_infinite_adjoint_is_followed_by_no_paths(variant, weights):
    from analytic_media.prb import camera

    gc.collect()
    weights[3, 4] = np.inf
    film = mi.load_dict(scenes.film("rgb", SIZE))
    film.prepare([])
    found = np.array(camera.importance(film, mi.TensorXf(weights)))
    expected = np.where(np.isfinite(weights), weights, 0).sum(-1).ravel()
    np.testing.assert_allclose(found, expected, rtol=1e-5)


# ---- Images


@pytest.mark.parametrize(
    ("variant", "make"),
    [
        ("llvm_ad_rgb", overlap),
        ("llvm_ad_rgb", two_media),
        ("llvm_ad_spectral", chromatic),
        ("llvm_ad_mono", overlap),
    ],
    indirect=["variant"],
    ids=lambda value: getattr(value, "__name__", value),
)
def test_images_agree_with_analyticvolpath(variant, make):
    gc.collect()
    scene = make(variant.split("_")[-1])
    scene["sensor"] |= {"film": scenes.film("rgb", 32)}
    passes = [
        render_passes(scene, {"type": name, "max_depth": 6}, side, spp=16)
        for side, name in enumerate(("analyticvolpath", "prbanalyticvolpath"))
    ]
    assert_agree(*passes, pixels=1024)


@rgb
def test_hidden_emitters_and_alpha_agree_with_analyticvolpath(variant):
    """The hidden light is outside of the fog, in front of it."""
    gc.collect()
    scene = scenes.ball(scenes.constant_fog(), pixel_format="luminance_alpha", size=32)
    scene["glow"] = scenes.glowing_sphere([0.2, -1.6, 0.3], 0.15, 3)
    del scene["floor"]
    options = {"max_depth": 4, "hide_emitters": True}
    passes = [
        render_passes(scene, {"type": name} | options, side, spp=16)
        for side, name in enumerate(("analyticvolpath", "prbanalyticvolpath"))
    ]
    assert_agree(*passes, pixels=700)


@pytest.mark.parametrize("variant", ["llvm_ad_spectral_polarized"], indirect=True)
def test_polarised_variants_are_refused(variant):
    with pytest.raises(RuntimeError, match=r"carries no polarisation.*use llvm_ad_spectral"):
        mi.load_dict({"type": "prbanalyticvolpath"})


# ---- Cost


@rgb
def test_memory_does_not_depend_on_the_length_of_paths(variant, weights):
    peaks = {}
    for max_depth in (8, 64, 256):
        scene, params, directions = load("height fog", variant)
        directions = {key: directions[key] for key in list(directions)[:2]}
        backward(scene, params, directions, weights, 64, 0, max_depth=max_depth)
        dr.sync_thread()
        gc.collect()
        dr.flush_malloc_cache()
        dr.detail.malloc_clear_statistics()
        backward(scene, params, directions, weights, 64, 1, max_depth=max_depth)
        peaks[max_depth] = dr.detail.malloc_watermark(dr.JitBackend.LLVM)
    print(f"\n    bytes: {peaks}", end="")
    assert max(peaks.values()) <= 1.01 * min(peaks.values())


@rgb
def test_changed_parameters_reuse_every_kernel(variant, weights):
    """But for those that seed the sampler: they are small."""
    scene, params, directions = load("height fog", variant)
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        history = []
        for seed in range(3):
            for key, direction in directions.items():
                params[key] = params[key] + 0.1 * direction
            params.update()
            dr.kernel_history_clear()
            backward(scene, params, directions, weights, 4, seed)
            history.append([k for k in dr.kernel_history() if k.get("operation_count", 0) > 100])
    first, *_, again = history
    assert first
    assert {k["hash"] for k in again} <= {k["hash"] for k in first}
    assert all(k["cache_hit"] for k in again)


@rgb
def test_frozen_functions_give_the_same_derivatives(variant, weights):
    """After a first call: what a medium is made of has to be read before."""
    scene, params, directions = load("height fog", variant)
    key = next(k for k in directions if k.endswith("scale_height"))
    adjoint, path = mi.TensorXf(weights / weights.size), integrator()

    def gradient(scene, value, seed):
        params[key] = value
        params.update()
        path.render_backward(scene, params, adjoint, seed=seed, spp=256)
        return dr.grad(params[key])

    def means(function):
        found = []
        for height in (1.5, 0.9):
            value = mi.Float(height)
            dr.make_opaque(value)
            dr.enable_grad(value)
            found.append(function(scene, value, dr.opaque(mi.UInt32, 7))[0])
        return found

    expected = means(gradient)
    assert expected[0] != pytest.approx(expected[1], rel=0.2)
    assert means(dr.freeze(gradient)) == pytest.approx(expected, rel=1e-4)


# ---- Coefficients

STATED = {
    "sigma_t": {"sigma_t": 0.7, "albedo": 0.3},
    "colour": {"sigma_t": {"type": "rgb", "value": [0.5, 1.5, 4.0]}, "albedo": 0.3},
    "sigma_a": {"sigma_a": 0.2, "sigma_s": 0.5},
    "mean_free_path": {"mean_free_path": 2.0},
    "transmittance": {"transmittance": 0.4, "at_distance": 3.0},
    "opacity": {"opacity": 0.4, "at_distance": 3.0},
    "visibility": {"visibility": 5.0},
    "mass": {"mass_density": 0.3, "mass_attenuation": 2.0, "scale": 1.5},
    "number": {"number_density": 0.3, "cross_section": 2.0},
}


@pytest.mark.parametrize("variant", VARIANTS, indirect=True)
@pytest.mark.parametrize("stated", STATED)
def test_coefficients_are_those_of_the_medium(variant, stated):
    from analytic_media.prb import media

    gc.collect()
    fog = mi.load_dict({"type": "analytic"} | scenes.EXPONENTIAL | STATED[stated])
    it = dr.zeros(mi.MediumInteraction3f)
    it.p = mi.Point3f(0.3, -0.2, 1.1)
    if variant.endswith("spectral"):
        it.wavelengths = mi.Spectrum([450, 500, 600, 650])
    sigma_s, _, sigma_t = fog.get_scattering_coefficients(it)
    one = media.Medium(fog, [str(fog)])
    extinction, scattering = media.Place(one, it).at(it.p)
    np.testing.assert_allclose(np.array(extinction), np.array(sigma_t), rtol=1e-5)
    np.testing.assert_allclose(np.array(scattering), np.array(sigma_s), rtol=1e-5)


# ---- What does not work


@rgb
def test_stock_media_are_refused(variant):
    gc.collect()
    scene = mi.load_dict(scenes.ball(scenes.homogeneous_fog(), size=4))
    with pytest.raises(ValueError, match="needs media of the types analytic and overlap"):
        integrator().render(scene, spp=1)


@rgb
def test_no_light_samples_are_refused(variant):
    with pytest.raises(RuntimeError, match="emitter_samples must be between 1 and 64, got 0"):
        integrator(emitter_samples=0)
