"""What Dr.Jit compiles: parameters are data, so changing them compiles nothing.

The compile time itself is measured by benches/kernel_compile.py.
"""

import gc

import mitsuba as mi
import pytest
import render_scenes as scenes

dr = pytest.importorskip("drjit", reason="Dr.Jit is not installed")

INTEGRATORS = ["analyticvolpath", "volpath"]
FOGS = {
    "linear": (scenes.linear_fog, {"gradient": 0.3, "density": 0.9, "up": [0.0, 0.0, 1.0]}),
    "exponential": (
        scenes.exponential_fog,
        {"scale_height": 0.7, "base_height": 0.1, "up": [0.6, 0.0, 0.8]},
    ),
}
COMMON = {"scale": 1.5, "sigma_t.value.value": 0.8, "albedo.value.value": 0.4}


def kernels():
    """The kernels launched since the last call."""
    return [k for k in dr.kernel_history() if k["type"] == dr.KernelType.JIT]


@pytest.fixture
def history():
    """Kernels are recorded; earlier ones and living media of other tests are gone."""
    gc.collect()
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.kernel_history_clear()
        yield
        dr.kernel_history_clear()


def load(medium, integrator):
    scene = scenes.ball(medium, size=16)
    return mi.load_dict(scene | {"integrator": {"type": integrator, "max_depth": 6}})


@pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("fog", FOGS)
def test_changed_parameters_reuse_every_kernel(variant, history, fog, integrator):
    make, own = FOGS[fog]
    scene = load(make(), integrator)
    dr.eval(mi.render(scene, spp=2, seed=0))
    first = kernels()
    assert first
    params = mi.traverse(scene)
    prefix = scenes.medium_prefix(params)
    for name, value in (own | COMMON).items():
        params[prefix + name] = value
        params.update()
        kernels()
        dr.eval(mi.render(scene, spp=2, seed=1))
        again = kernels()
        assert {k["hash"] for k in again} <= {k["hash"] for k in first}, name
        assert all(k["cache_hit"] for k in again), name


@pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)
def test_kernel_is_no_larger_than_stock_tracking_a_grid(variant, history):
    """Compile time follows the number of operations, which is exact and does not depend on load."""
    sizes = {}
    for medium, integrator in (
        (scenes.linear_grid_fog(), "volpath"),
        (scenes.exponential_fog(), "analyticvolpath"),
    ):
        gc.collect()
        scene = load(medium, integrator)
        kernels()
        dr.eval(mi.render(scene, spp=2, seed=0))
        sizes[integrator] = max(k["operation_count"] for k in kernels())
    print(f"\n    operations: {sizes}", end="")
    assert sizes["analyticvolpath"] <= 1.5 * sizes["volpath"]


@pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)
def test_lights_at_a_point_cost_nothing_where_there_are_none(variant, history):
    """With `distance_sampling`, the kernel is that of free flights."""

    def hashes(strategy):
        gc.collect()
        scene = scenes.ball(scenes.exponential_fog(), size=16)
        del scene["lamp"]
        integrator = {"type": "analyticvolpath", "distance_sampling": strategy, "max_depth": 6}
        # In parallel, light sources would get their numbers, which kernels hold, in any order.
        scene = mi.load_dict(scene | {"integrator": integrator}, parallel=False)
        kernels()
        dr.eval(mi.render(scene, spp=2, seed=0))
        return {k["hash"] for k in kernels()}

    assert hashes("free_flight") == hashes("mis")


@pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)
def test_frozen_functions_render_the_same_images(variant):
    """Even where they trace paths twice: stock integrators then end shadow rays too early."""
    gc.collect()
    scene = mi.load_dict(
        scenes.valley(scenes.exponential_fog() | scenes.VALLEY_BOX, size=16)
        | {"sky": scenes.sky(0.65)}
    )
    params = mi.traverse(scene)
    key = next(k for k in params.keys() if k.endswith("scale_height"))  # noqa: SIM118
    integrator = mi.load_dict({"type": "analyticvolpath", "max_depth": 4})

    def mean(scene, value, seed):
        params[key] = value
        params.update()
        images = [mi.render(scene, integrator=integrator, seed=seed + i, spp=64) for i in range(2)]
        return dr.mean(images[0] + images[1], axis=None)

    def means(function):
        found = []
        for height in (1.5, 0.9, 0.5):
            value = mi.Float(height)
            dr.make_opaque(value)
            found.append(function(scene, value, dr.opaque(mi.UInt32, 7)).array[0])
        return found

    expected = means(mean)
    assert expected[0] != pytest.approx(expected[2], rel=0.05)
    assert means(dr.freeze(mean)) == pytest.approx(expected, rel=1e-5)
