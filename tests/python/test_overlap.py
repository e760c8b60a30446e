"""Sums of analytic media: against one medium, against stock, and part by part."""

import gc

import mitsuba as mi
import numpy as np
import pytest
import render_scenes as scenes
from zscores import assert_agree, render_passes

dr = pytest.importorskip("drjit", reason="Dr.Jit is not installed")

SPP = 2
PATHS = {"max_depth": 6}

OURS = {"type": "analyticvolpath"}
VOLPATH = {"type": "volpath"}
# Too dark whenever Russian roulette is active, so it gets none.
VOLPATHMIS = {"type": "volpathmis", "rr_depth": 1000}

scalar_and_llvm = pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"], indirect=True)
scalar_rgb = pytest.mark.parametrize("variant", ["scalar_rgb"], indirect=True)
llvm_ad_rgb = pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)


def hg(g):
    return {"type": "hg", "g": g}


def rgb(*value):
    return {"type": "rgb", "value": list(value)}


def layer(scale_height, **options):
    profile = {"profile": "exponential", "scale_height": scale_height, "base_height": 0.25}
    return {"type": "analytic"} | profile | options


LOW = layer(0.5, sigma_t=0.9, albedo=0.95, phase=hg(0.7))
HIGH = layer(3.0, sigma_t=0.3, albedo=0.5, phase=hg(-0.4))
BOX = scenes.VALLEY_BOX


def overlap(**options):
    """Two layers, which differ in everything."""
    return {"type": "overlap", "low": LOW, "high": HIGH} | options


def render(scene, integrator, side, spp=SPP):
    return render_passes(scene, integrator | PATHS, side, spp)


# ---- Renders


@scalar_and_llvm
@pytest.mark.parametrize("integrator", [OURS, VOLPATH], ids=lambda i: i["type"])
def test_one_component_is_that_medium(variant, integrator):
    """With the same random numbers: paths differ only where rounding changes a decision."""
    alone = LOW | BOX
    summed = {"type": "overlap", "fog": LOW} | BOX
    first, second = (
        np.array(mi.render(mi.load_dict(scenes.valley(fog) | {"integrator": integrator}), spp=4))
        for fog in (alone, summed)
    )
    assert np.isclose(first, second, rtol=1e-4).mean() > 0.998


@scalar_and_llvm
@pytest.mark.parametrize("stock", [VOLPATH, VOLPATHMIS], ids=lambda stock: stock["type"])
def test_two_layers_agree_with_stock_integrators(variant, stock):
    scene = scenes.valley(overlap() | BOX)
    assert_agree(render(scene, stock, 0), render(scene, OURS, 1))


@scalar_and_llvm
def test_uniform_components_are_a_homogeneous_medium(variant):
    """Of summed coefficients, and a blend of their phase functions in proportion to scattering."""
    first = {"type": "analytic", "sigma_t": 0.5, "albedo": 0.9, "phase": hg(0.6)}
    second = {"type": "analytic", "sigma_t": 0.7, "albedo": 0.6, "phase": hg(-0.5)}
    scattered = 0.45, 0.42
    blend = {"type": "blendphase", "weight": scattered[1] / sum(scattered)}
    blend |= {"first": first["phase"], "second": second["phase"]}
    stock = {"type": "homogeneous", "sigma_t": 1.2, "albedo": sum(scattered) / 1.2, "phase": blend}
    ours = {"type": "overlap", "first": first, "second": second}
    assert_agree(
        render(scenes.ball(stock), VOLPATH, 0),
        render(scenes.ball(ours), OURS, 1),
    )


COLOURS = {
    "low": {"sigma_t": [0.2, 0.6, 1.8], "albedo": [0.95, 0.9, 0.7]},
    "high": {"sigma_t": [0.9, 0.5, 0.3], "albedo": [0.4, 0.7, 0.95]},
}


@scalar_and_llvm
def test_colours_agree_with_a_grey_medium_for_each(variant):
    """Extinction, albedo and phase function differ by colour and height.

    Stock volpath renders each colour alone: volpathmis can do all at once, but where components
    have opposite colours some of its samples are a hundred times as bright as the picture.
    """

    def scene(colour):
        low, high = (
            base | {name: colour(values) for name, values in COLOURS[part].items()}
            for part, base in (("low", LOW), ("high", HIGH))
        )
        box = {"bbox_min": [-1, -1, -1], "bbox_max": [1, 1, 1]}
        return scenes.ball(overlap(low=low, high=high) | box, pixel_format="rgb")

    stock = [render(scene(lambda values, i=i: values[i]), VOLPATH, i)[..., i] for i in range(3)]
    ours = render(scene(lambda values: rgb(*values)), OURS, 3)
    assert_agree(np.stack(stock, axis=-1), ours)


@pytest.mark.parametrize(
    "variant",
    [
        "scalar_spectral",
        "llvm_ad_mono",
        "llvm_ad_spectral",
        "scalar_spectral_polarized",
        "llvm_ad_mono_polarized",
    ],
    indirect=True,
)
def test_other_variants_agree_with_stock(variant):
    """Where light is polarised, gold makes it so, and Mueller matrices meet the mixture.

    Without the glowing sphere, whose light is NaN at times to volpath in scalar polarised variants.
    """
    scene = scenes.valley(overlap() | BOX)
    del scene["glow"]
    if variant.endswith("polarized"):
        scene["stone"] = scenes.sphere([0.5, 0, 0.4], 0.4, bsdf=scenes.GOLD)
    assert_agree(render(scene, VOLPATH, 0), render(scene, OURS, 1))


# ---- The mixture of phase functions


def coloured():
    return mi.load_dict(
        overlap(
            low=LOW | {"sigma_t": rgb(0.2, 0.6, 1.8)},
            high=HIGH | {"albedo": rgb(0.4, 0.7, 0.0)},
        )
    )


def interaction(height, *width):
    mei = mi.MediumInteraction3f()
    if width:
        mei = dr.zeros(mi.MediumInteraction3f, *width)
    mei.wi = [0.6, 0, 0.8]
    mei.sh_frame = mi.Frame3f(mei.wi)
    mei.p = [0, 0, height]
    return mei


def shares(height):
    """Of the scattering, per channel: (2, 3)."""
    density = np.exp(-(height - 0.25) / np.array([0.5, 3.0]))
    sigma_s = np.array([[0.2, 0.6, 1.8], [0.3, 0.3, 0.3]])
    sigma_s *= np.array([[0.95] * 3, [0.4, 0.7, 0.0]]) * density[:, None]
    return sigma_s / sigma_s.sum(0), sigma_s.sum(1) / sigma_s.sum()


def henyey_greenstein(g, cos_theta):
    return (1 - g**2) / (4 * np.pi * (1 + g**2 - 2 * g * cos_theta) ** 1.5)


@scalar_and_llvm
@pytest.mark.parametrize("height", [-1.0, 0.5, 3.0])
def test_mixture_is_weighted_by_local_scattering(variant, height):
    phase = coloured().phase_function()
    wo = np.array([0.0, 0.28, -0.96])
    value, pdf = phase.eval_pdf(mi.PhaseFunctionContext(), interaction(height), wo)
    cos_theta = -np.dot([0.6, 0, 0.8], wo)
    parts = np.array([henyey_greenstein(g, cos_theta) for g in (0.7, -0.4)])
    share, chance = shares(height)
    np.testing.assert_allclose(np.array(value).ravel(), parts @ share, rtol=1e-5)
    np.testing.assert_allclose(np.array(pdf).ravel(), parts @ chance, rtol=1e-5)


@scalar_and_llvm
def test_mixture_samples_what_it_evaluates(variant):
    phase, mei, ctx = coloured().phase_function(), interaction(0.5), mi.PhaseFunctionContext()
    for u in (0.0, 0.2, 0.4, 0.6, 0.8, 0.999999):
        wo, weight, pdf = phase.sample(ctx, mei, u, [0.3, 0.7])
        value, expected = phase.eval_pdf(ctx, mei, wo)
        np.testing.assert_allclose(np.array(pdf), np.array(expected), rtol=1e-5)
        np.testing.assert_allclose(np.array(weight * pdf), np.array(value), rtol=1e-5)


@scalar_and_llvm
@pytest.mark.parametrize("common", [hg(0.7), {"type": "isotropic"}], ids=lambda p: p["type"])
def test_components_that_scatter_alike_are_as_one(variant, common):
    """One object, and kinds without parameters: the mixture does without weights."""
    own = mi.load_dict(common)
    low, high = (LOW | {"phase": own}, HIGH | {"phase": own})
    if common["type"] == "isotropic":
        high = HIGH | {"phase": common}
    mixture = mi.load_dict(overlap(low=low, high=high)).phase_function()
    ctx, mei, wo = mi.PhaseFunctionContext(), interaction(0.5), np.array([0.0, 0.28, -0.96])
    for mixed, alone in (
        (mixture.eval_pdf(ctx, mei, wo), own.eval_pdf(ctx, mei, wo)),
        (mixture.sample(ctx, mei, 0.4, [0.3, 0.7]), own.sample(ctx, mei, 0.4, [0.3, 0.7])),
    ):
        for a, b in zip(mixed, alone, strict=True):
            np.testing.assert_array_equal(np.array(a), np.array(b))


@llvm_ad_rgb
@pytest.mark.parametrize("height", [-1.0, 0.5, 3.0])
def test_mixture_passes_chi_square(variant, height):
    import mitsuba.chi2

    medium, ctx = coloured(), mi.PhaseFunctionContext()
    phase = medium.phase_function()

    def sample(u):
        return phase.sample(ctx, interaction(height, dr.width(u)), u[0], mi.Point2f(u[1], u[2]))[0]

    def pdf(wo):
        return phase.eval_pdf(ctx, interaction(height, dr.width(wo)), wo)[1]

    test = mitsuba.chi2.ChiSquareTest(
        domain=mitsuba.chi2.SphericalDomain(), sample_func=sample, pdf_func=pdf, sample_dim=3
    )
    assert test.run(), test.messages


@scalar_and_llvm
@pytest.mark.parametrize("dark", [{"albedo": 0.0}, {"sigma_t": 0.0}], ids=["albedo", "sigma_t"])
def test_mixture_of_nothing_is_a_phase_function(variant, dark):
    medium = mi.load_dict(overlap(low=LOW | dark, high=HIGH | dark))
    phase, mei, ctx = medium.phase_function(), interaction(0.5), mi.PhaseFunctionContext()
    wo, weight, pdf = phase.sample(ctx, mei, 0.3, [0.3, 0.7])
    assert np.array(pdf).item() > 0
    np.testing.assert_allclose(np.array(weight).ravel(), 1, rtol=1e-5)
    np.testing.assert_allclose(np.linalg.norm(np.array(wo)), 1, rtol=1e-5)


@scalar_and_llvm
def test_infinite_densities_make_no_nan(variant):
    """Far below the ground, where exp overflows single precision."""
    phase = coloured().phase_function()
    value, pdf = phase.eval_pdf(mi.PhaseFunctionContext(), interaction(-1000.0), [0, 0, 1])
    assert np.isfinite(np.array(value)).all()
    assert np.isfinite(np.array(pdf)).all()


# ---- Stock integrators need bounds


@scalar_and_llvm
@pytest.mark.parametrize("options", [{}, {"max_density": 0.5}, BOX, BOX | {"max_density": 0.5}])
def test_majorant_bounds_the_sum_and_null_collisions_fill_it(variant, options, rng):
    medium = mi.load_dict(overlap() | options)
    mei = mi.MediumInteraction3f()
    majorant = np.array(medium.get_majorant(mei)).ravel()
    sup = np.exp(-(-0.5 - 0.25) / np.array([0.5, 3.0])) if "bbox_min" in options else np.ones(2)
    if "bbox_min" not in options or "max_density" in options:
        sup = np.minimum(sup, options.get("max_density", 1.0))
    np.testing.assert_allclose(majorant, sup @ [0.9, 0.3], rtol=1e-5)
    for z in rng.uniform(-2, 6, 20):
        mei.p = mi.Point3f(0, 0, float(z))
        parts = medium.get_scattering_coefficients(mei)
        scattered, null, total = (np.array(part).ravel() for part in parts)
        assert (total <= majorant * (1 + 1e-6)).all()
        assert (scattered <= total).all()
        np.testing.assert_allclose(null + total, majorant, rtol=1e-5)


# ---- Parameters


@scalar_and_llvm
def test_components_are_exposed_by_name(variant):
    params = mi.traverse(mi.load_dict(overlap()))
    own = ["scale_height", "base_height", "up", "scale", "sigma_t.value.value"]
    own += ["albedo.value.value", "phase_function.g"]
    names = {f"{part}.{name}" for part in ("low", "high") for name in own}
    assert set(params.keys()) == names | {"max_density"}
    for name in names:
        assert params.flags(name) & mi.ParamFlags.NonDifferentiable == 0, name


@scalar_rgb
def test_unnamed_components_go_by_their_ids(variant):
    medium = mi.load_string(
        '<medium version="3.0.0" type="overlap"><medium type="analytic" id="haze"/></medium>'
    )
    assert "haze.scale" in mi.traverse(medium)


@scalar_and_llvm
@pytest.mark.parametrize("integrator", [OURS, VOLPATH], ids=lambda i: i["type"])
def test_changed_parameters_make_the_overlap_that_a_scene_would_state(variant, integrator):
    """The bound that stock integrators track against is updated too: bit for bit the same."""
    stated = {"sigma_t": 0.5, "albedo": 0.25, "scale": 2.0, "scale_height": 1.0}

    def scene(low):
        fog = overlap(low=low) | BOX
        return mi.load_dict(scenes.valley(fog, size=24) | {"integrator": integrator | PATHS})

    expected = np.array(mi.render(scene(LOW | stated), spp=4, seed=1))
    changed = scene(LOW)
    before = np.array(mi.render(changed, spp=4, seed=1))
    params = mi.traverse(changed)
    keys = list(params.keys())
    for name, value in stated.items():
        suffix = ".value.value" if name in ("sigma_t", "albedo") else ""
        (key,) = (key for key in keys if key.endswith(f"low.{name}{suffix}"))
        params[key] = value
    params.update()
    after = np.array(mi.render(changed, spp=4, seed=1))
    assert not np.allclose(before, expected)
    np.testing.assert_array_equal(after, expected)


@llvm_ad_rgb
@pytest.mark.parametrize("fog", [LOW, overlap()], ids=lambda fog: fog["type"])
@pytest.mark.parametrize("integrator", [OURS, VOLPATH], ids=lambda i: i["type"])
def test_frozen_renders_follow_parameters(variant, fog, integrator):
    """Dr.Jit finds all variables of a medium, those of its components too."""
    gc.collect()
    scene = mi.load_dict(scenes.valley(fog | BOX, size=24) | {"integrator": integrator | PATHS})
    params = mi.traverse(scene)
    (key, *_) = (key for key in list(params.keys()) if key.endswith("scale_height"))

    @dr.freeze
    def frozen(scene, seed):
        return mi.render(scene, spp=4, seed=seed)

    images = []
    for scale_height in (0.5, 2.0):
        params[key] = scale_height
        params.update()
        images.append(np.array(frozen(scene, mi.UInt32(1))))
        np.testing.assert_array_equal(images[-1], np.array(mi.render(scene, spp=4, seed=1)))
    assert not np.allclose(*images)


@scalar_rgb
def test_changed_components_are_checked(variant):
    params = mi.traverse(mi.load_dict(overlap()))
    params["low.scale_height"] = -3.0
    with pytest.raises(RuntimeError, match=r"scale_height must be .*> 0, got -3"):
        params.update()


@scalar_and_llvm
def test_to_string_prints_every_component(variant):
    text = str(mi.load_dict(overlap(bsphere_center=[0, 0, -5], bsphere_radius=7.0)))
    for part in ("OverlapMedium", "low = [", "high = [", "scale_height = 0.5", "scale_height = 3"):
        assert part in text
    assert "bsphere_radius = 7," in text


@scalar_rgb
def test_colour_of_one_component_is_colour_of_the_sum(variant):
    assert not mi.load_dict(overlap()).has_spectral_extinction()
    assert coloured().has_spectral_extinction()
    assert mi.load_dict(overlap()).use_emitter_sampling()
    assert not mi.load_dict(overlap(sample_emitters=False)).use_emitter_sampling()


REFUSED = {
    "no component": ({"type": "overlap"}, "an overlap needs at least one nested medium"),
    "too many components": (
        {"type": "overlap"} | {f"fog{i}": LOW for i in range(17)},
        "a medium must have at most 16 components, got 17",
    ),
    "stock component": (
        {"type": "overlap", "fog": {"type": "homogeneous"}},
        '"fog" must be a medium of the type analytic, got HomogeneousMedium',
    ),
    "overlap in an overlap": (
        {"type": "overlap", "fog": {"type": "overlap", "low": LOW}},
        '"fog" must be a medium of the type analytic, got OverlapMedium',
    ),
    "component with a box": (
        {"type": "overlap", "fog": LOW | BOX},
        '"fog" must have no box, no sphere and no max_density of its own',
    ),
    "component with a sphere": (
        {"type": "overlap", "fog": LOW | {"bsphere_center": [0, 0, 0], "bsphere_radius": 1.0}},
        '"fog" must have no box, no sphere and no max_density of its own',
    ),
    "component with max_density": (
        {"type": "overlap", "fog": LOW | {"max_density": 2.0}},
        '"fog" must have no box, no sphere and no max_density of its own',
    ),
    "phase function of its own": (
        {"type": "overlap", "low": LOW, "phase": hg(0.5)},
        '"phase" is a phase function: those of an overlap belong to its components',
    ),
    "bad component": (
        {"type": "overlap", "fog": LOW | {"scale_height": 0.0}},
        "scale_height must be .*> 0, got 0",
    ),
    "coefficients of its own": (overlap(sigma_t=1.0), "sigma_t"),
    "max_density 0": (overlap(max_density=0.0), "max_density must be finite and > 0, got 0"),
}


@scalar_and_llvm
@pytest.mark.parametrize("case", REFUSED)
def test_bad_input_is_refused_and_leaves_nothing(variant, case):
    medium, message = REFUSED[case]
    with pytest.raises(RuntimeError, match=message):
        mi.load_dict(medium)
    assert "OverlapMedium" in str(mi.load_dict(overlap()))
