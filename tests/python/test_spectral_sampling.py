"""The strategies of `spectral_sampling` against each other, stock volpathmis and closed forms.

zscores.py says what agreement means. Spread and bias are printed: pytest -s.
"""

import gc

import mitsuba as mi
import numpy as np
import pytest
import render_scenes as scenes
from scipy import stats
from zscores import assert_agree, render_passes

dr = pytest.importorskip("drjit", reason="Dr.Jit is not installed")

STRATEGIES = {
    "mis": {},
    "single": {"spectral_sampling": "single"},
    "average": {"spectral_sampling": "average"},
    "tracking": {"spectral_sampling": "tracking"},
    "tracking by maximum": {"spectral_sampling": "tracking", "event_probabilities": "maximum"},
    "tracking by average": {"spectral_sampling": "tracking", "event_probabilities": "average"},
    "mis, analogue": {"absorption": "analogue"},
    "tracking, analogue": {"spectral_sampling": "tracking", "absorption": "analogue"},
}
# Where colours are far apart, few samples carry most of the light.
HEAVY_TAILED = ("average", "tracking by maximum", "tracking by average")
others = pytest.mark.parametrize("strategy", [name for name in STRATEGIES if name != "mis"])
strategies = pytest.mark.parametrize("strategy", STRATEGIES)
colourful = pytest.mark.parametrize(
    "variant", ["scalar_rgb", "scalar_spectral", "llvm_ad_rgb", "llvm_ad_spectral"], indirect=True
)
scalar_and_llvm = pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"], indirect=True)
scalar_rgb = pytest.mark.parametrize("variant", ["scalar_rgb"], indirect=True)

VOLPATHMIS = {"type": "volpathmis", "rr_depth": 1000}  # too dark while it plays roulette


def ours(strategy, **options):
    return {"type": "analyticvolpath"} | STRATEGIES[strategy] | options


def colour(variant, red, green, blue):
    """A coefficient that varies with colour, or with wavelength."""
    if "spectral" in variant:
        return {"type": "spectrum", "value": [(360, blue), (550, green), (830, red)]}
    if "mono" in variant:
        return green
    return {"type": "rgb", "value": [red, green, blue]}


def fog(variant, **options):
    """Colours a factor of 2 apart: the noise of every strategy is near enough to normal."""
    coefficients = {
        "sigma_t": colour(variant, 0.8, 1.2, 1.7),
        "albedo": colour(variant, 0.95, 0.85, 0.7),
    }
    return scenes.constant_fog(
        **coefficients | {"profile": "exponential", "scale_height": 0.7} | options
    )


def components(variant):
    """A sum with a component that does not scatter."""
    return {
        "type": "overlap",
        "fog": fog(variant),
        "haze": scenes.constant_fog(sigma_t=0.3, albedo=0.9),
        "ozone": scenes.constant_fog(sigma_t=colour(variant, 0.1, 0.3, 0.05), albedo=0.0),
    }


BALL = {"bbox_min": [-1, -1, -1], "bbox_max": [1, 1, 1]}


def scene(medium, space=False, **film):
    """The ball of fog; in black `space`, no sky is behind it and the fog is lit by the sun."""
    found = scenes.ball(medium | BALL, pixel_format="rgb", **film)
    if space:
        del found["sky"], found["fog"]
        found["sensor"]["medium"] = medium | BALL
    return found


def passes(scene, integrator, side, spp=4, max_depth=4):
    if integrator.get("spectral_sampling") == "single":
        spp *= 4  # so that as many paths are for each channel
    return render_passes(scene, {"max_depth": max_depth} | integrator, side, spp)


@pytest.fixture(scope="module")
def reference(variant):
    """Passes by the default strategy, rendered once per variant and scene."""
    done = {}

    def render(name, made):
        if name not in done:
            done[name] = passes(made, ours("mis"), 0)
        return done[name]

    return render


# ---- Means


@colourful
@others
def test_strategies_agree(variant, reference, strategy):
    made = scene(fog(variant))
    assert_agree(reference("ball", made), passes(made, ours(strategy), 1))


@colourful
def test_mis_agrees_with_volpathmis(variant, reference):
    made = scene(fog(variant))
    assert_agree(passes(made, VOLPATHMIS, 1), reference("ball", made))


@scalar_and_llvm
@pytest.mark.parametrize("space", [False, True], ids=["sky", "space"])
@others
def test_strategies_agree_in_a_sum(variant, reference, strategy, space):
    """Before a sky and before black space, where collisions are forced."""
    made = scene(components(variant), space)
    assert_agree(reference(f"sum {space}", made), passes(made, ours(strategy), 1), pixels=3500)


@pytest.mark.parametrize(
    "variant",
    ["llvm_ad_mono", "scalar_spectral_polarized", "llvm_ad_mono_polarized"],
    indirect=True,
)
@pytest.mark.parametrize("strategy", ["single", "average", "tracking", "tracking, analogue"])
def test_strategies_agree_in_other_variants(variant, reference, strategy):
    made = scene(fog(variant))
    del made["glow"]  # NaN to stock in polarised variants
    assert_agree(reference("ball", made), passes(made, ours(strategy), 1))


@scalar_and_llvm
@strategies
def test_white_furnace_in_every_channel(variant, strategy):
    """Nothing is absorbed: 1 in the mean, whatever the colours."""
    white = {"sigma_t": {"type": "rgb", "value": [1.1, 1.5, 2.0]}, "albedo": 1.0}
    medium = fog(variant, **white, **BALL)
    ball = scenes.sphere([0, 0, 0], 1, bsdf={"type": "null"}, interior=medium)
    sensor = scenes.camera([0, -3, 0.4], [0, 0, 0], 25, pixel_format="rgb", size=16)
    furnace = {"type": "scene", "sensor": sensor, "ball": ball, "sky": scenes.sky(1.0)}
    of_pass = passes(furnace, ours(strategy), 0, spp=32, max_depth=-1).mean(1)
    error = of_pass.std(0, ddof=1) / np.sqrt(len(of_pass))
    assert (error < 0.02).all()
    assert (abs(of_pass.mean(0) - 1) <= 4 * error).all(), (of_pass.mean(0), error)


# ---- Closed forms and symmetries


def slab(sigma_t, albedo=0.0, thickness=1.0, **options):
    """A plane slab before a sky of radiance 1, which a camera looks straight through."""
    box = {"bbox_min": [-50, -50, 0], "bbox_max": [50, 50, thickness]}
    coefficients = {"sigma_t": sigma_t, "albedo": albedo}
    medium = {"type": "analytic"} | coefficients | box | options
    sensor = {
        "type": "orthographic",
        "to_world": mi.ScalarTransform4f().look_at([0, 0, 2], [0, 0, 0], [0, 1, 0]),
        "film": scenes.film("rgb", size=8),
        "sampler": {"type": "independent"},
        "medium": medium,
    }
    return {"type": "scene", "sensor": sensor, "sky": scenes.sky(1.0)}


@scalar_and_llvm
@strategies
def test_absorbing_slab_is_its_closed_form(variant, strategy):
    """A slab that does not scatter is a weight, in every strategy: no noise."""
    sigma_t = np.array([0.1, 1.0, 5.0])
    made = slab({"type": "rgb", "value": sigma_t.tolist()}) | {"integrator": ours(strategy)}
    image = np.array(mi.render(mi.load_dict(made), spp=64, seed=1))
    mean, expected = image.mean((0, 1)), np.exp(-sigma_t)
    # A path for one channel brings three times its light a third of the time.
    tolerance = 0.15 if strategy == "single" else 1e-5
    np.testing.assert_allclose(mean, expected, rtol=tolerance)


@scalar_and_llvm
@strategies
def test_optical_depths_of_200(variant, strategy):
    """No NaN, and no black channel where light gets through."""
    sigma_t = {"type": "rgb", "value": [0.5, 100.0, 200.0]}
    made = slab(sigma_t, albedo=0.9) | {"integrator": ours(strategy, max_depth=64)}
    image = np.array(mi.render(mi.load_dict(made), spp=256, seed=1))
    assert np.isfinite(image).all()
    assert (image >= 0).all()
    if strategy not in HEAVY_TAILED:
        # e^-0.5 of the sky and more; the albedo of thick fog is above 0.3.
        assert image[..., 0].mean() > np.exp(-0.5)
        assert (image[..., 1:].mean((0, 1)) > 0.2).all()


@scalar_and_llvm
def test_volpath_loses_what_underflows(variant):
    """It follows one of the colours, whose transmittance is 0 in single precision beyond an optical
    depth of 88 to 103: where that is green or blue, red light that passes is lost. By volpathmis,
    as by ours, the slab is nearly white in red."""
    made = slab(1.0)
    del made["sensor"]["medium"]
    medium = {"type": "homogeneous", "albedo": 0.99, "scale": 200.0}
    medium["sigma_t"] = {"type": "rgb", "value": [0.5 / 200, 0.5, 1.0]}
    made["boundary"] = {
        "type": "cube",
        "to_world": mi.ScalarTransform4f().translate([0, 0, 0.5]).scale([50, 50, 0.5]),
        "bsdf": {"type": "null"},
        "interior": medium,
    }
    fog = slab({"type": "rgb", "value": [0.5, 100.0, 200.0]}, albedo=0.99)
    roulette = {"rr_depth": 1000, "max_depth": 64}
    red = {}
    for name, which, integrator in [
        ("ours", fog, ours("mis")),
        ("volpathmis", made, VOLPATHMIS),
        ("volpath", made, {"type": "volpath"}),
    ]:
        loaded = mi.load_dict(which | {"integrator": integrator | roulette})
        red[name] = np.array(mi.render(loaded, spp=512, seed=1))[..., 0].mean()
    print(f"\n    red: {red}", end="")
    assert red["ours"] == pytest.approx(red["volpathmis"], rel=0.05)
    assert red["volpath"] < 0.5 * red["ours"]


@scalar_and_llvm
@strategies
def test_permuting_channels_permutes_the_image(variant, strategy):
    """In the mean: the channel that a variate chooses is another."""
    of_pass = []
    for side, order in enumerate(([0, 1, 2], [2, 0, 1])):
        values = [[0.7, 1.3, 2.0], [0.95, 0.85, 0.7]]
        sigma_t, albedo = ({"type": "rgb", "value": [v[i] for i in order]} for v in values)
        made = scene(fog(variant, sigma_t=sigma_t, albedo=albedo))
        images = np.empty_like(found := passes(made, ours(strategy), side))
        images[..., order] = found
        of_pass.append(images)
    assert_agree(*of_pass)


@scalar_and_llvm
@strategies
def test_a_channel_without_extinction_sees_through(variant, strategy):
    """Its pixels are those of the scene without fog."""
    sigma_t = {"type": "rgb", "value": [0.0, 1.0, 1.5]}
    foggy, clear = scene(fog(variant, sigma_t=sigma_t)), scene(fog(variant, sigma_t=0.0))
    a, b = passes(foggy, ours(strategy), 0)[..., :1], passes(clear, ours("mis"), 1)[..., :1]
    if strategy in HEAVY_TAILED:
        assert stats.ttest_ind(a.mean((1, 2)), b.mean((1, 2)), equal_var=False).pvalue > 1e-4
    else:
        assert_agree(a, b, pixels=2000)


@scalar_and_llvm
@pytest.mark.parametrize("strategy", ["average", "tracking", "tracking by maximum"])
def test_grey_media_are_the_same_path_for_path(variant, strategy):
    """Where channels agree, no strategy has anything to choose."""
    images = []
    for integrator in (ours("mis"), ours(strategy)):
        # Said to be chromatic, though it is not.
        grey = scene(fog(variant, sigma_t=1.2, albedo=0.8, has_spectral_extinction=False), size=32)
        loaded = mi.load_dict(grey | {"integrator": integrator | {"max_depth": 6}})
        images.append(np.array(mi.render(loaded, spp=64, seed=5)))
    np.testing.assert_allclose(images[0].mean(), images[1].mean(), rtol=0.01)


@pytest.mark.parametrize("variant", ["scalar_rgb"], indirect=True)
@strategies
def test_grey_is_mono(variant, strategy):
    """All channels of a grey medium are alike, by every strategy that serves all at once."""
    made = scene(fog(variant, sigma_t=1.2, albedo=0.8), size=32)
    loaded = mi.load_dict(made | {"integrator": ours(strategy, max_depth=6)})
    image = np.array(mi.render(loaded, spp=16, seed=5))
    spread = np.ptp(image, axis=-1)
    if strategy == "single":
        assert spread.max() > 0
    else:
        assert spread.max() <= 1e-5 * image.max()


# ---- Properties


@scalar_rgb
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"spectral_sampling": "hero"}, r"spectral_sampling.*single, average, mis, tracking.*hero"),
        (
            {"spectral_sampling": "tracking", "event_probabilities": "best"},
            r"event_probabilities.*maximum, average, history.*best",
        ),
        ({"absorption": "never"}, r"absorption.*weight, analogue.*never"),
        ({"event_probabilities": "maximum"}, r"event_probabilities.*spectral_sampling.*mis"),
    ],
)
def test_bad_properties_are_named(variant, options, message):
    with pytest.raises(RuntimeError, match=message):
        mi.load_dict({"type": "analyticvolpath"} | options)


@scalar_rgb
def test_properties_are_printed(variant):
    text = str(mi.load_dict(ours("tracking by maximum", absorption="analogue")))
    assert "spectral_sampling = tracking" in text
    assert "event_probabilities = maximum" in text
    assert "absorption = analogue" in text


# ---- Polarisation


@pytest.mark.parametrize("variant", ["scalar_spectral_polarized"], indirect=True)
@pytest.mark.parametrize("phase", ["rayleigh", "hg"])
def test_polarised_light_has_the_intensity_of_unpolarised_light(variant, phase):
    """And no more polarisation than in stock, whose phase functions are scalar, Rayleigh's too."""
    made = scene(fog(variant, phase={"type": phase}), size=32)
    del made["glow"]  # NaN to stock in polarised variants
    stokes = {"type": "stokes", "nested": ours("mis", max_depth=4)}
    image = np.array(mi.render(mi.load_dict(made | {"integrator": stokes}), spp=4))
    assert image.shape[-1] == 15  # intensity, then the four parameters, in three colours
    assert image[..., 3:6].mean() > 0.1
    assert (image[..., 6:] == 0).all()

    polarised = passes(made, ours("mis"), 0, spp=8).mean((1, 2))
    gc.collect()
    mi.set_variant("scalar_spectral")
    try:
        plain = passes(made, ours("mis"), 1, spp=8).mean((1, 2))
    finally:
        gc.collect()
        mi.set_variant(variant)
    assert stats.ttest_ind(polarised, plain, equal_var=False).pvalue > 1e-4
