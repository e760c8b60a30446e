"""Our medium and integrator against stock Mitsuba, by the statistics of independent passes.

Each pair is the same physics twice, and neither side is a reference image: zscores.py says what
agreement means. Spread and bias are printed: pytest -s.
"""

import mitsuba as mi
import numpy as np
import pytest
import render_scenes as scenes
from scipy import stats
from zscores import assert_agree, render_passes

SPP = 8

OURS = {"type": "analyticvolpath"}
VOLPATH = {"type": "volpath"}
# Too dark whenever Russian roulette is active, so it gets none.
VOLPATHMIS = {"type": "volpathmis", "rr_depth": 1000}

# What a pair compares: a scene with an integrator, made when the variant is set.
SIDES = {
    "stock grid": lambda: (scenes.ball(scenes.linear_grid_fog()), VOLPATH),
    "linear": lambda: (scenes.ball(scenes.linear_fog()), OURS),
    "stock homogeneous": lambda: (scenes.ball(scenes.homogeneous_fog()), VOLPATH),
    "constant": lambda: (scenes.ball(scenes.constant_fog()), OURS),
    "stock tracking": lambda: (scenes.valley(scenes.tracked_exponential_fog()), VOLPATH),
    "exponential": lambda: (scenes.valley(scenes.exponential_fog()), OURS),
    "exponential, volpath": lambda: (scenes.valley(scenes.exponential_fog()), VOLPATH),
    "exponential, volpathmis": lambda: (scenes.valley(scenes.exponential_fog()), VOLPATHMIS),
}


def render(scene, integrator, side, max_depth=6, spp=SPP, **options):
    """Passes of a scene; `side` 0 and 1 have different seeds."""
    return render_passes(scene, integrator | {"max_depth": max_depth} | options, side, spp)


@pytest.fixture(scope="module")
def passes_of(variant):
    """Passes of a named side, rendered once per variant."""
    done = {}

    def passes(name, side):
        if (name, side) not in done:
            done[name, side] = render(*SIDES[name](), side)
        return done[name, side]

    return passes


@pytest.mark.parametrize(
    "variant",
    ["scalar_rgb", "scalar_spectral", "llvm_ad_rgb", "llvm_ad_mono", "llvm_ad_spectral"],
    indirect=True,
)
@pytest.mark.parametrize(
    ("stock", "ours"),
    [
        ("stock grid", "linear"),
        ("stock homogeneous", "constant"),
        ("stock tracking", "exponential"),
        ("exponential, volpath", "exponential"),
        ("exponential, volpathmis", "exponential"),
    ],
)
def test_medium_agrees_with_stock(passes_of, stock, ours):
    assert_agree(passes_of(stock, 0), passes_of(ours, 1))


CHROMATIC = {
    "rgb": {"type": "rgb", "value": [0.4, 1.2, 3.0]},
    "spectral": {"type": "spectrum", "value": [(360, 3.0), (550, 1.2), (830, 0.4)]},
}
COLOURED_ALBEDO = {
    "rgb": {"type": "rgb", "value": [0.95, 0.8, 0.5]},
    "spectral": {"type": "spectrum", "value": [(360, 0.5), (550, 0.8), (830, 0.95)]},
}


@pytest.mark.parametrize(
    "variant", ["scalar_rgb", "scalar_spectral", "llvm_ad_rgb", "llvm_ad_spectral"], indirect=True
)
@pytest.mark.parametrize("albedo", ["grey", "coloured"])
def test_chromatic_extinction_agrees_with_volpathmis(variant, albedo):
    """volpathmis: volpath follows one channel, and its error bars lie."""
    colours = variant.split("_")[-1]
    fog = scenes.constant_fog(
        profile="exponential",
        scale_height=0.7,
        bbox_min=[-1, -1, -1],
        bbox_max=[1, 1, 1],
        sigma_t=CHROMATIC[colours],
        albedo=0.8 if albedo == "grey" else COLOURED_ALBEDO[colours],
    )
    scene = scenes.ball(fog, pixel_format="rgb")
    assert_agree(render(scene, VOLPATHMIS, 0), render(scene, OURS, 1))


@pytest.mark.parametrize(
    "variant", ["scalar_spectral_polarized", "llvm_ad_mono_polarized"], indirect=True
)
def test_polarised_variants_agree_with_stock(variant):
    """Gold polarises, so that Mueller matrices meet the medium.

    Without the glowing sphere, whose light is NaN at times to volpath in scalar polarised variants.
    """
    sides = []
    for fog in (scenes.homogeneous_fog(), scenes.constant_fog()):
        scene = scenes.ball(fog) | {"stone": scenes.sphere([0.2, 0, -0.1], 0.5, bsdf=scenes.GOLD)}
        del scene["glow"]
        sides.append(scene)
    assert_agree(render(sides[0], VOLPATH, 0, spp=4), render(sides[1], OURS, 1, spp=4))


# ---- Features of a scene, in one variant: stock volpath renders the same scene

scalar_rgb = pytest.mark.parametrize("variant", ["scalar_rgb"], indirect=True)


def assert_like_volpath(scene, spp=SPP, pixels=4096, **options):
    assert_agree(
        render(scene, VOLPATH, 0, spp=spp, **options),
        render(scene, OURS, 1, spp=spp, **options),
        pixels,
    )


@scalar_rgb
@pytest.mark.parametrize("max_depth", [2, 3])
def test_max_depth_means_what_it_does_in_volpath(variant, max_depth):
    assert_like_volpath(scenes.valley(scenes.exponential_fog()), max_depth=max_depth)


def assert_same_brightness(a, b):
    """Of whole images, whose means are normal where pixels are not."""
    assert stats.ttest_ind(a.mean((1, 2)), b.mean((1, 2)), equal_var=False).pvalue > 1e-4


@scalar_rgb
def test_max_depth_of_1_is_the_sky_behind_the_fog(variant):
    """It needs samples for the edge of the floor only: volpath plays for each to get through."""
    scene = scenes.valley(scenes.exponential_fog())
    volpath, ours = (render(scene, of, seed, max_depth=1) for of, seed in ((VOLPATH, 0), (OURS, 1)))
    assert_same_brightness(volpath, ours)
    assert ours.var(0).sum() < 0.2 * volpath.var(0).sum()


@scalar_rgb
def test_roulette_changes_no_mean(variant):
    """At depth 1 it plays at nearly every vertex of a dark fog."""
    scene = scenes.ball(scenes.constant_fog(sigma_t=4.0, albedo=0.6))
    assert_same_brightness(
        render(scene, OURS, 0, max_depth=16, rr_depth=1000),
        render(scene, OURS, 1, max_depth=16, rr_depth=1),
    )


@scalar_rgb
def test_rough_boundary_agrees_with_volpath(variant):
    """Lights are seen through it by chance only, so pixels are far from normal."""
    boundary = {"type": "roughdielectric", "int_ior": 1.2, "alpha": 0.3}
    scene = scenes.ball(scenes.constant_fog(), boundary)
    assert_same_brightness(render(scene, VOLPATH, 0), render(scene, OURS, 1))


@scalar_rgb
@pytest.mark.parametrize(
    "boundary",
    [
        {"type": "mask", "opacity": 0.4, "bsdf": scenes.GREY},
        {"type": "thindielectric"},
        {"type": "dielectric", "int_ior": 1.2},
    ],
    ids=lambda boundary: boundary["type"],
)
def test_boundary_agrees_with_volpath(variant, boundary):
    assert_like_volpath(scenes.ball(scenes.constant_fog(), boundary))


def in_black_space(boundary=None):
    """Collisions are forced in it, where a ray leaves; a light outside lies behind some rays."""
    scene = scenes.ball({"type": "ref", "id": "medium"}, boundary)
    del scene["sky"], scene["floor"]
    behind = scenes.glowing_sphere([0.4, 1.6, 0.3], 0.3, 2)
    return {"type": "scene", "medium": scenes.constant_fog(), **scene, "behind": behind}


def hollow():
    """Rays leave the fog for a hole in it, and meet it again."""
    hole = scenes.sphere([-0.3, -0.5, 0.4], 0.3, bsdf={"type": "null"})
    return in_black_space() | {"hole": hole | {"exterior": {"type": "ref", "id": "medium"}}}


def shining():
    """The boundary itself is a light source."""
    scene = in_black_space()
    scene["fog"] |= {"emitter": {"type": "area", "radiance": {"type": "uniform", "value": 0.3}}}
    return scene


def shaded():
    """Outside of the fog one stone stands before the lamp, and one behind it."""
    before, behind = (
        scenes.sphere([x, -x, x], radius, bsdf=scenes.GREY) for x, radius in ((0.9, 0.25), (2, 0.4))
    )
    return in_black_space() | {"before": before, "behind the lamp": behind}


@scalar_rgb
@pytest.mark.parametrize("made", [in_black_space, hollow, shining, shaded])
def test_boundary_in_black_space_agrees_with_volpath(variant, made):
    assert_like_volpath(made())


@scalar_rgb
def test_collisions_are_forced_behind_a_boundary(variant):
    """A mask of opacity 0 is the same boundary, but it might scatter."""

    def sunlit(boundary=None):
        scene = in_black_space(boundary)
        return {name: scene[name] for name in ("type", "sensor", "medium", "fog", "sun")}

    mask = {"type": "mask", "opacity": 0.0, "bsdf": scenes.GREY}
    masked, bare = render(sunlit(mask), OURS, 0), render(sunlit(), OURS, 1)
    assert_same_brightness(masked, bare)
    assert bare.var(0).sum() < 0.6 * masked.var(0).sum()


@scalar_rgb
def test_hidden_emitters_agree_with_volpath(variant):
    """Alpha too: it says where something other than an emitter is seen.

    The hidden light is outside of the fog: through a medium, volpath does not hide lights.
    """
    scene = scenes.ball(scenes.constant_fog(), pixel_format="luminance_alpha")
    scene["glow"] = scenes.glowing_sphere([0.2, -1.6, 0.3], 0.15, 3)
    del scene["floor"]
    sides = [
        render(scene, integrator, side, hide_emitters=True)
        for side, integrator in enumerate((VOLPATH, OURS))
    ]
    assert_agree(*sides, pixels=3000)


def mixed(outer, inner, **film):
    """Media side by side and nested, the camera in the outer one."""
    grid = scenes.linear_grid_fog()
    scene = scenes.valley(outer, **film)
    medium = scene["sensor"]["medium"]
    null = {"type": "null"}
    return scene | {
        "left": scenes.sphere([-1.2, 0, 0.9], 0.6, bsdf=null, interior=inner, exterior=medium),
        "nested": scenes.sphere([-1.2, 0, 0.9], 0.3, bsdf=null, interior=medium, exterior=inner),
        "right": scenes.sphere([0.3, 0.1, 1.5], 0.5, bsdf=null, interior=grid, exterior=medium),
    }


@pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"], indirect=True)
@pytest.mark.parametrize("outer", ["ours", "stock"])
def test_mixed_media_agree_with_volpath(variant, outer):
    """Delta and ratio tracking where the medium is stock's, formulas where it is ours."""
    if outer == "ours":
        media = scenes.exponential_fog(sigma_t=0.4), scenes.homogeneous_fog()
    else:
        media = scenes.tracked_exponential_fog(), scenes.constant_fog(sigma_t=2.0)
    assert_like_volpath(mixed(*media))


@scalar_rgb
def test_tracked_volume_is_the_same_medium_to_stock(variant):
    """Same density, majorant and seed: the same random walk, bit for bit."""
    first, second = (
        mi.render(mi.load_dict(scenes.valley(fog) | {"integrator": VOLPATH}), spp=4)
        for fog in (scenes.exponential_fog(), scenes.tracked_exponential_fog())
    )
    np.testing.assert_array_equal(np.array(first), np.array(second))
