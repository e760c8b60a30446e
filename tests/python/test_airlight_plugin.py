"""The integrator airlight against Monte Carlo of single scattering, and what it refuses.

In a room that is convex nothing stands between lights and medium, so that the unshadowed medium of
airlight is the physical one.
"""

import gc

import mitsuba as mi
import numpy as np
import pytest
import render_scenes as scenes
from zscores import assert_agree, render_passes

AIRLIGHT = {"type": "airlight"}
ONCE = {"type": "analyticvolpath", "max_depth": 2, "distance_sampling": "mis"}
STOCK = {"type": "volpath", "max_depth": 2}

BOX = {"bbox_min": [-4, -4, -1.1], "bbox_max": [4, 4.1, 4]}
FOG = {"type": "analytic", "sigma_t": 0.4, "albedo": 0.8, "phase": scenes.PHASE}
COLOURS = FOG | {
    "sigma_t": {"type": "rgb", "value": [0.2, 0.4, 0.9]},
    "albedo": {"type": "rgb", "value": [0.9, 0.8, 0.6]},
}
LAYERS = FOG | {"profile": "exponential", "scale_height": 1.5, "base_height": -1.0}


def spot(origin, target, intensity=4.0, **options):
    return {
        "type": "spot",
        "to_world": mi.ScalarTransform4f().look_at(origin, target, [0, 0, 1]),
        "intensity": {"type": "uniform", "value": intensity},
    } | options


def room(fog, lights=("lamp", "spot"), **film):
    """Two planes with a camera between them; every pixel sees one of them through fog."""
    wall = mi.ScalarTransform4f().look_at([0, 3, 0], [0, 0, 0], [0, 0, 1])
    available = {
        "lamp": scenes.lamp([0.6, 0.5, 0.4], 3),
        # Out of the picture: close to a light, stock images are too skewed for statistics.
        "high lamp": scenes.lamp([0.6, 0.5, 2.6], 6),
        "spot": spot([-1.5, 1.0, 1.5], [0.8, 0.6, -1], cutoff_angle=25, beam_width=15),
        "sun": scenes.sun(),
    }
    return {
        "type": "scene",
        "sensor": scenes.camera([0, -3, 0.3], [0, 0, 0.2], 50, medium=fog, **film),
        "floor": scenes.floor(-1, 30),
        "wall": {
            "type": "rectangle",
            "to_world": wall @ mi.ScalarTransform4f().scale(30),
            "bsdf": scenes.grey(0.5),
        },
    } | {name: available[name] for name in lights}


def render(scene, integrator, spp=1, passes=1, side=0):
    return render_passes(scene, integrator, side, spp, passes)


def mean(scene, integrator, spp=64):
    return render(scene, integrator, spp).mean(axis=(0, 1))


VARIANTS = [
    "scalar_rgb",
    "scalar_spectral",
    "llvm_ad_rgb",
    "llvm_ad_mono",
    "llvm_ad_spectral",
]


class TestAgainstMonteCarlo:
    """Per-pixel z-scores.

    Shadow rays of path tracers, stock and ours, end 0.1 % short of a light at a point, and so does
    their transmittance: their images are 0.02 to 0.2 % too bright here, which 4 samples per pixel
    and pass do not resolve.
    """

    @pytest.mark.parametrize("variant", VARIANTS, indirect=True)
    @pytest.mark.parametrize("fog", [FOG, COLOURS], ids=["grey", "colours"])
    def test_point_and_spot(self, variant, fog):
        rgb = {"pixel_format": "rgb"} if fog is COLOURS and "mono" not in variant else {}
        scene = room(fog | BOX, **rgb)
        ours = render(scene, AIRLIGHT, spp=4, passes=32)
        assert_agree(ours, render(scene, ONCE, spp=4, passes=32, side=1))

    @pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)
    @pytest.mark.parametrize(
        "phase",
        [{"type": "isotropic"}, {"type": "rayleigh"}, {"type": "hg", "g": -0.6}],
        ids=lambda phase: phase["type"],
    )
    def test_phase_functions_against_stock(self, variant, phase):
        scene = room(FOG | BOX | {"phase": phase}, lights=["high lamp"])
        ours = render(scene, AIRLIGHT, spp=4, passes=32)
        assert_agree(ours, render(scene, STOCK, spp=32, passes=32, side=1))

    @pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_spectral"], indirect=True)
    def test_sun_in_exponential_fog(self, variant):
        scene = room(LAYERS, lights=["sun"])
        ours = render(scene, AIRLIGHT, spp=4, passes=32)
        assert_agree(ours, render(scene, ONCE, spp=4, passes=32, side=1))

    @pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"], indirect=True)
    def test_sun_in_a_box(self, variant):
        """Light enters through the top and two sides."""
        scene = room(COLOURS | BOX, lights=["sun"], pixel_format="rgb")
        ours = render(scene, AIRLIGHT, spp=4, passes=32)
        assert_agree(ours, render(scene, ONCE, spp=16, passes=32, side=1))

    @pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)
    def test_camera_outside(self, variant):
        box = {"bbox_min": [-3, -1, -1.1], "bbox_max": [3, 4.1, 4]}
        scene = room(FOG | box)
        ours = render(scene, AIRLIGHT, spp=4, passes=32)
        assert_agree(ours, render(scene, ONCE, spp=4, passes=32, side=1))

    @pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)
    def test_no_noise_but_that_of_edges(self, variant):
        scene = room(FOG | BOX)
        ours, theirs = (render(scene, i, spp=4, passes=8).var(0) for i in (AIRLIGHT, ONCE))
        # Pixels have gradients: what is left is where in a pixel a sample lies.
        assert np.median(ours) < 1e-2 * np.median(theirs)


@pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)
class TestPolarisation:
    def test_intensity(self, variant):
        plain = mean(room(FOG | BOX), AIRLIGHT)
        mi.set_variant("llvm_ad_spectral_polarized")
        try:
            polarised = mean(room(FOG | BOX), AIRLIGHT)
        finally:
            mi.set_variant(variant)
        np.testing.assert_allclose(polarised, plain, rtol=0.01)


@pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"], indirect=True)
class TestSun:
    def test_constant_fog_is_lit_at_the_camera(self, variant):
        """Along a ray: the fog by the formula of the C library, and the wall at its end."""
        import analytic_media as am

        scene = mi.load_dict(room(FOG, lights=["sun"]) | {"integrator": AIRLIGHT})
        image = np.array(mi.render(scene, spp=1, seed=0))
        sun = -np.array([0.3, 0.4, -1.0]) / np.linalg.norm([0.3, 0.4, -1.0])
        sensor = scene.sensors()[0]
        ray, _ = sensor.sample_ray(0, 0.5, [0.5 / 64, 0.5 / 64], [0.5, 0.5])
        o, d = np.array(ray.o).ravel(), np.array(ray.d).ravel()
        t = (3 - o[1]) / d[1]
        cos, g = d @ sun, scenes.PHASE["g"]
        phase = (1 - g**2) / (4 * np.pi * (1 + g**2 - 2 * g * cos) ** 1.5)
        expected = am.sunlit_fog(am.Constant(), 0.32, 0.4, o, d, t, sun, phase=phase)
        wall = 0.5 / np.pi * -sun[1] * np.exp(-0.4 * t * (1 - cos))
        np.testing.assert_allclose(image[0, 0, 0], expected + wall, rtol=0.01)


@pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)
class TestShadows:
    """A ball between the lamp and the camera throws a shadow into the fog."""

    def scene(self):
        ball = {"ball": scenes.sphere([0.3, -0.4, 0.3], 0.4, bsdf=scenes.grey(0.5))}
        return room(FOG | BOX) | ball

    def test_steps_approach_the_truth(self, variant):
        truth = render(self.scene(), ONCE, spp=4096).mean(0)
        images = {
            steps: render(self.scene(), AIRLIGHT | {"shadow_steps": steps}, spp=16).mean(0)
            for steps in (0, 8, 64, 256)
        }
        errors = {
            steps: abs(image - truth).mean() / truth.mean() for steps, image in images.items()
        }
        print(f"\n    mean error over mean: {errors}", end="")
        assert errors[0] > 0.03
        assert errors[8] < errors[0] / 2
        assert errors[256] < errors[0] / 5

    def test_parts_add_up(self, variant):
        """Where nothing is in the way, steps change nothing."""
        whole, parts = (
            render(room(FOG | BOX), AIRLIGHT | {"shadow_steps": steps}, spp=4) for steps in (0, 32)
        )
        np.testing.assert_allclose(parts, whole, rtol=1e-3, atol=1e-5)


def with_bad(**parts):
    return room(FOG | BOX) | parts


REFUSED = {
    "the sensor is in no medium": lambda: with_bad(sensor=scenes.camera([0, -3, 0], [0, 0, 0], 50)),
    "cannot render the light of Area": lambda: with_bad(
        glow=scenes.glowing_sphere([0, 0, 0], 0.2, 1)
    ),
    'cannot render the light of ConstantBackgroundEmitter "sky"': lambda: with_bad(
        sky=scenes.sky()
    ),
    'the light "lamp" must be inside of the medium': lambda: with_bad(
        lamp=scenes.lamp([0, 0, 9], 1)
    ),
    'the shape "pane" must be opaque': lambda: with_bad(
        pane=scenes.sphere([0, 0, 0], 0.1, bsdf={"type": "null"})
    ),
    "must have one component, got 2": lambda: room({"type": "overlap", "a": FOG, "b": FOG} | BOX),
    'must be constant or exponential, got "linear"': lambda: room(
        FOG | BOX | {"profile": "linear", "gradient": 0.1, "density": 1}
    ),
    'must be constant for light of "lamp"': lambda: room(LAYERS | BOX),
    "must be an analytic one": lambda: room(scenes.homogeneous_fog()),
    "is constant and a sphere": lambda: room(
        FOG | {"bsphere_center": [0, 0, 0], "bsphere_radius": 9}, lights=["sun"]
    ),
    "must be isotropic, hg or rayleigh, got BlendPhaseFunction": lambda: room(
        FOG
        | BOX
        | {
            "phase": {
                "type": "blendphase",
                "weight": 0.5,
                "a": {"type": "isotropic"},
                "b": {"type": "hg"},
            }
        }
    ),
    "projects a texture": lambda: with_bad(
        spot=spot(
            [0, 0, 1],
            [0, 0, 0],
            texture={"type": "bitmap", "bitmap": mi.Bitmap(np.ones((4, 4, 3), dtype=np.float32))},
        )
    ),
}


@pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"], indirect=True)
class TestRefusals:
    @pytest.mark.parametrize("message", REFUSED)
    def test_names_the_object(self, variant, message):
        gc.collect()
        scene = mi.load_dict(REFUSED[message]())
        with pytest.raises(RuntimeError, match=message):
            # mi.render() would hide the message behind one of its own.
            mi.load_dict(AIRLIGHT).render(scene, spp=1)

    @pytest.mark.parametrize("steps", [-1, 4097])
    def test_shadow_steps(self, variant, steps):
        with pytest.raises(RuntimeError, match=rf"shadow_steps must be between 0 .* got {steps}"):
            mi.load_dict(AIRLIGHT | {"shadow_steps": steps})

    def test_max_depth(self, variant):
        mi.load_dict(AIRLIGHT | {"max_depth": 2})
        with pytest.raises(RuntimeError, match=r"max_depth must be 2.* got 3"):
            mi.load_dict(AIRLIGHT | {"max_depth": 3})

    def test_to_string(self, variant):
        text = str(mi.load_dict(AIRLIGHT | {"shadow_steps": 7}))
        assert "AirlightIntegrator" in text
        assert "shadow_steps = 7" in text
