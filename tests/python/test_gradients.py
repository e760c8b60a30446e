"""Derivatives of a render with respect to the medium, by stock prbvolpath, against differences.

prbvolpath differentiates its delta tracking of our medium; the differences are between renders of
analyticvolpath, which shares nothing with it but the formulas of the density.
"""

import gc

import mitsuba as mi
import numpy as np
import pytest
import render_scenes as scenes

dr = pytest.importorskip("drjit", reason="Dr.Jit is not installed")

BOX = {"bbox_min": [-1, -1, -1], "bbox_max": [1, 1, 1]}
ANALYTIC = {"type": "analytic", "sigma_t": 1.5, "albedo": 0.7, "phase": scenes.PHASE}
# The ball lies on one side of the base height, so that its parts do not cancel in a gradient.
EXPONENTIAL = {"profile": "exponential", "scale_height": 0.8, "base_height": -1.0}
LINEAR = {"profile": "linear", "gradient": -0.3, "density": 1.0, "base_height": -1.0}
HIGH = {"profile": "exponential", "scale_height": 4.0, "base_height": -1.0}
OVERLAP = {
    "type": "overlap",
    "low": ANALYTIC | EXPONENTIAL,
    "high": ANALYTIC | HIGH | {"sigma_t": 0.6, "albedo": 0.3, "phase": {"type": "isotropic"}},
}

PATHS = {"max_depth": 8, "rr_depth": 1000}
SPP, SEEDS = 256, range(12)


def load(medium):
    """A ball of fog seen from outside: prbvolpath starts every path in vacuum."""
    sensor = scenes.camera([0, -3, 0.4], [0, 0, 0], 36, size=32)
    medium = medium | BOX
    ball = scenes.sphere([0, 0, 0], 1, bsdf={"type": "null"}, interior=medium)
    lights = {"sun": scenes.sun(), "sky": scenes.sky(0.5)}
    scene = mi.load_dict({"type": "scene", "sensor": sensor, "ball": ball} | lights)
    params = mi.traverse(scene)
    prefix = scenes.medium_prefix(params).removesuffix("low.")
    return scene, params, prefix


def key_of(prefix, name):
    return prefix + (f"{name}.value.value" if name.endswith(("sigma_t", "albedo")) else name)


def gradients_by_adjoint(scene, params, keys):
    """Of the mean of the image: one array of `keys` per seed."""
    for key in keys:
        dr.enable_grad(params[key])
    params.update()
    integrator = mi.load_dict({"type": "prbvolpath"} | PATHS)
    gradients = []
    for seed in SEEDS:
        image = mi.render(scene, params, integrator=integrator, spp=1, spp_grad=SPP, seed=seed)
        dr.backward(dr.mean(image, axis=None))
        gradients.append([np.array(dr.grad(params[key])).item() for key in keys])
        for key in keys:
            dr.set_grad(params[key], 0)
    for key in keys:
        dr.disable_grad(params[key])
    return np.array(gradients)


def gradients_by_differences(scene, params, key):
    """Common random numbers make the difference of two renders far less noisy than either."""
    integrator = mi.load_dict({"type": "analyticvolpath"} | PATHS)
    value = np.array(params[key]).item()
    step = 0.1 * abs(value)

    def mean(changed, seed):
        params[key] = changed
        params.update()
        image = mi.render(scene, integrator=integrator, spp=SPP, seed=seed)
        return np.array(image).mean(dtype=float)

    differences = [mean(value + step, seed) - mean(value - step, seed) for seed in SEEDS]
    params[key] = value
    params.update()
    return np.array(differences) / (2 * step)


@pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)
@pytest.mark.parametrize(
    ("medium", "names"),
    [
        (ANALYTIC | EXPONENTIAL, ["sigma_t", "albedo", "scale", "scale_height", "base_height"]),
        (ANALYTIC | LINEAR, ["gradient", "density"]),
        (OVERLAP, ["low.scale_height", "high.albedo", "high.scale"]),
    ],
    ids=["exponential", "linear", "overlap"],
)
def test_gradients_agree_with_differences(variant, medium, names):
    """Within 2 %, of which the noise may be a third."""
    gc.collect()
    scene, params, prefix = load(medium)
    keys = [key_of(prefix, name) for name in names]
    adjoint = gradients_by_adjoint(scene, params, keys).T
    for name, key, by_adjoint in zip(names, keys, adjoint, strict=True):
        by_differences = gradients_by_differences(scene, params, key)
        got, expected = by_adjoint.mean(), by_differences.mean()
        noise = np.hypot(by_adjoint.std(ddof=1), by_differences.std(ddof=1)) / np.sqrt(len(SEEDS))
        print(
            f"\n    {name}: {got:.5f}, differences {expected:.5f}: {got / expected - 1:+.2%}, "
            f"noise {noise / abs(expected):.2%}",
            end="",
        )
        assert noise <= 0.007 * abs(expected), name
        assert got == pytest.approx(expected, rel=0.02), name
