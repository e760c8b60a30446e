"""The scenes of air-light: what throws shadows in them, and that they render."""

from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np
import pytest

import analytic_media  # noqa: F401 (the plugins)

SCENES = Path(__file__).parents[2] / "scenes"
NAMES = ["airlight_bench", "airlight_stage", "airlight_road", "airlight_lighthouse"]
each_scene = pytest.mark.parametrize("name", NAMES)


def load(name, **settings):
    small = {"res_x": "40", "res_y": "25", "spp": "4"}
    return mi.load_file(str(SCENES / f"{name}.xml"), **small, **settings)


def shadowed(scene, rng):
    """The share of points that the camera sees and some light does not reach."""
    n = 20_000
    pixel = mi.Point2f(rng.random((2, n)).astype(np.float32))
    ray, _ = scene.sensors()[0].sample_ray(0, 0.5, pixel, mi.Point2f(0.5))
    hit = scene.ray_intersect(ray)
    end = np.minimum(np.array(hit.t), 60)
    point = ray(mi.Float((0.999 * end * rng.random(n)).astype(np.float32)))
    blocked = np.zeros(n, bool)
    here = dr.zeros(mi.Interaction3f)
    here.p = point
    for light in scene.emitters():
        there, _ = light.sample_direction(here, mi.Point2f(0.5))
        shadow = mi.Ray3f(point, there.d, 0.9999 * there.dist, 0.0, mi.Color0f())
        blocked |= np.array(scene.ray_test(shadow))
    return blocked.mean()


@pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)
@each_scene
def test_what_is_left_of_sunken_objects_throws_no_shadow(variant, rng, name):
    assert shadowed(load(name), rng) > 0.005
    assert shadowed(load(name, sink="-1000"), rng) == 0


@pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"], indirect=True)
@pytest.mark.parametrize("integrator", ["analyticvolpath", "airlight"])
@each_scene
def test_scenes_render(variant, integrator, name):
    """Nearly every pixel has light in it; on the stage those in the cones of light have."""
    image = np.array(mi.render(load(name, integrator=integrator), seed=1))[..., :3]
    assert np.isfinite(image).all() and image.min() >= 0
    assert 0.02 < image.mean() < 0.5
    lit = (image.max(axis=-1) > 0).mean()
    assert lit > (0.2 if name == "airlight_stage" else 0.9)
