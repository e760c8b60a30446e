"""The stock twin of a scene, and the comparison with it."""

import json

import numpy as np
import pytest

mi = pytest.importorskip("mitsuba")

from analytic_media.compare import compare, statistics, twin, worker  # noqa: E402
from analytic_media.compare.methods import (  # noqa: E402
    EXACT,
    OURS,
    STRATEGIES,
    TRACKED,
    colour_mode,
    methods_for,
)
from analytic_media.compare.protocol import Options  # noqa: E402

VARIANT = "scalar_rgb"
SCENE = """
<scene version="3.0.0">
    <default name="spp" value="4"/>
    <integrator type="analyticvolpath"><integer name="max_depth" value="6"/></integrator>
    <medium type="analytic" id="fog">
        <string name="profile" value="exponential"/>
        <float name="scale_height" value="0.5"/>
        SIGMA
        <float name="scale" value="2"/>
        <point name="bbox_min" value="-2, -2, -1"/><point name="bbox_max" value="2, 2, 1"/>
        <phase type="hg"><float name="g" value="0.4"/></phase>
    </medium>
    <sensor type="perspective">
        <transform name="to_world">
            <lookat origin="0, -1.8, 0" target="0, 0, 0" up="0, 0, 1"/>
        </transform>
        <ref id="fog"/>
        <film type="hdrfilm">
            <integer name="width" value="16"/><integer name="height" value="10"/>
            <rfilter type="box"/>
        </film>
        <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
    </sensor>
    <emitter type="constant"/>
    <shape type="sphere"><float name="radius" value="0.4"/></shape>
</scene>
"""
GREY = '<float name="sigma_t" value="0.3"/><float name="albedo" value="0.9"/>'
CHROMATIC = '<rgb name="sigma_t" value="0.1, 0.2, 0.4"/><rgb name="albedo" value="0.9, 0.8, 0.7"/>'
SPECTRUM = '<spectrum name="sigma_t" value="360:0.4, 550:0.2, 830:0.1"/>'
SCATTERING = '<float name="sigma_s" value="0.15"/><float name="sigma_a" value="0.05"/>'


@pytest.fixture
def scene(tmp_path):
    def write(sigma=GREY):
        path = tmp_path / "scene.xml"
        path.write_text(SCENE.replace("SIGMA", sigma))
        return path

    return write


def properties(node):
    return {key: repr(node.props[key]) for key in node.props.keys()}  # noqa: SIM118


def the_medium(state):
    return next(n.props for n in state.nodes if n.props.plugin_name() == "heterogeneous")


def test_twin_changes_the_medium_and_nothing_else(scene, tmp_path):
    """Same nodes in the same order; the grid is the one node more."""
    state = twin.parse(scene(), VARIANT)
    copy, _ = twin.voxelised(state, 4, VARIANT, tmp_path)
    assert len(copy.nodes) == len(state.nodes) + 1
    for old, new in zip(state.nodes, copy.nodes, strict=False):
        if old.props.plugin_name() != "analytic":
            assert new.props.plugin_name() == old.props.plugin_name()
            assert properties(new) == properties(old)
    assert len(twin.analytic_nodes(state)) == 1, "the original stays as it was"


def test_grey_twin_has_one_channel_and_no_spectral_bookkeeping(scene, tmp_path):
    copy, [(_, grid)] = twin.voxelised(twin.parse(scene(), VARIANT), 4, VARIANT, tmp_path)
    props = the_medium(copy)
    assert props["scale"] == pytest.approx(0.6)  # sigma_t 0.3 times scale 2
    assert props["albedo"] == pytest.approx(0.9)
    assert props["has_spectral_extinction"] is False
    assert grid.data.shape == (4, 4, 4, 1)
    assert props.id() == "fog"


def test_chromatic_twin_has_a_channel_per_colour(scene, tmp_path):
    state = twin.parse(scene(CHROMATIC), VARIANT)
    copy, [(medium, grid)] = twin.voxelised(state, 4, VARIANT, tmp_path)
    props = the_medium(copy)
    assert props["scale"] == pytest.approx(0.8)
    assert props["has_spectral_extinction"] is True
    np.testing.assert_allclose(grid.data[0, 0, 0] / grid.data[0, 0, 0, 2], [0.25, 0.5, 1], 1e-6)
    assert not medium.is_grey


def test_twin_of_scattering_and_absorption(scene, tmp_path):
    copy, _ = twin.voxelised(twin.parse(scene(SCATTERING), VARIANT), 4, VARIANT, tmp_path)
    assert the_medium(copy)["scale"] == pytest.approx(0.4)
    assert the_medium(copy)["albedo"] == pytest.approx(0.75)


def test_twin_keeps_depths_of_the_integrator(scene, tmp_path):
    copy, _ = twin.voxelised(twin.parse(scene(), VARIANT), 4, VARIANT, tmp_path)
    twin.set_integrator(copy, "volpathmis", rr_depth=6)
    props = twin.integrator_node(copy).props
    assert (props.plugin_name(), props["max_depth"], props["rr_depth"]) == ("volpathmis", 6, 6)


@pytest.fixture
def scene_of_three_paths(scene):
    path = scene()
    depth = '<integer name="max_depth" value="6"/>'
    assert depth in SCENE
    path.write_text(path.read_text().replace(depth, depth + '<integer name="paths" value="3"/>'))
    return path


def test_own_parameters_are_nothing_to_stock_integrators(scene_of_three_paths):
    state = twin.parse(scene_of_three_paths, VARIANT)
    assert twin.own_parameters(state) == {"max_depth": 6, "paths": 3}
    twin.set_integrator(state, "volpath")
    assert "paths" not in twin.integrator_node(state).props
    assert twin.own_parameters(state) == {}


def test_scene_is_rendered_with_its_own_parameters(scene_of_three_paths, tmp_path, monkeypatch):
    made, load = [], mi.load_dict
    monkeypatch.setattr(mi, "load_dict", lambda settings: made.append(settings) or load(settings))
    job = worker.Job(str(scene_of_three_paths), VARIANT, "exact", str(tmp_path), 0)
    renderer = worker._Renderer(job)
    for plugin in OURS.plugin, {"type": "volpath"}:
        renderer.render(plugin, 1, True)
    assert [settings.get("paths") for settings in made[-2:]] == [3, None]


def test_medium_without_a_box_is_voxelised_around_scene_and_camera(tmp_path):
    """Sphere of radius 0.4 at the origin, camera at y = -1.8, 5 % of the longest side around."""
    path = tmp_path / "scene.xml"
    box = '<point name="bbox_min" value="-2, -2, -1"/><point name="bbox_max" value="2, 2, 1"/>'
    assert box in SCENE
    path.write_text(SCENE.replace("SIGMA", GREY).replace(box, ""))
    _, [(_, grid)] = twin.voxelised(twin.parse(path, VARIANT), 4, VARIANT, tmp_path)
    np.testing.assert_allclose(grid.bbox[0], [-0.51, -1.91, -0.51], rtol=1e-5)
    np.testing.assert_allclose(grid.bbox[1], [0.51, 0.51, 0.51], rtol=1e-5)


def test_scene_without_our_medium_is_refused(tmp_path):
    path = tmp_path / "empty.xml"
    path.write_text('<scene version="3.0.0"><integrator type="volpath"/></scene>')
    with pytest.raises(twin.SceneError, match="no 'analytic' medium"):
        compare(Options(str(path), variants=(VARIANT,)), tmp_path / "report", "test")
    assert not (tmp_path / "report").exists()


def test_noise_of_the_reference_is_subtracted():
    """E[(x - r)²] = Var(x) + Var(r) for independent noise of known variances."""
    rng = np.random.default_rng(3)
    first, second, image = (rng.normal(1.0, s, (200, 200, 3)) for s in (0.2, 0.2, 0.5))
    reference = statistics.Reference.from_halves(first, second, {})
    assert reference.noise_variance == pytest.approx(0.02, rel=0.02)
    assert statistics.mse(image, reference) == pytest.approx(0.25, rel=0.02)


def test_trimmed_mean_drops_the_brightest_pixels():
    squared = np.ones((100, 100, 3))
    squared[0, :10] = 1e6  # a thousandth of the pixels
    assert statistics.trimmed_mean(squared) == pytest.approx(1.0)


def test_polarised_variants_leave_volpathmis_out():
    names = [m.integrator for m in methods_for("llvm_ad_mono_polarized", (8,))]
    assert names == ["analyticvolpath", "volpath", "volpath"]


@pytest.mark.parametrize(
    ("variant", "mode"),
    [
        ("scalar_rgb", "rgb"),
        ("llvm_ad_rgb", "rgb"),
        ("scalar_spectral_polarized", "spectral_polarized"),
        ("cuda_ad_spectral_polarized", "spectral_polarized"),
        ("llvm_ad_mono", "mono"),
    ],
)
def test_colour_mode(variant, mode):
    assert colour_mode(variant) == mode


@pytest.mark.parametrize("sigma", [GREY, CHROMATIC], ids=["grey", "chromatic"])
def test_tiny_comparison_writes_summary_and_report(scene, tmp_path, sigma):
    """Every method, two rounds of a few samples: the files are there and complete."""
    options = Options(str(scene(sigma)), (VARIANT,), (4, 8), rounds=2, spp=3)
    compare(options, tmp_path / "report", "test")
    summary = json.loads((tmp_path / "report/summary.json").read_text())

    assert summary["schema"] == 1
    assert summary["environment"]["packages"]["mitsuba"] == mi.__version__
    assert set(summary["references"]["rgb"]) == {EXACT, "4", "8"}
    reference = summary["references"]["rgb"]["4"]
    expected = "volpath" if sigma == GREY else "volpathmis"
    assert (reference["integrator"], reference["russian_roulette"]) == (expected, sigma == GREY)
    [transmittance] = summary["transmittance"]
    assert transmittance["grids"]["8"]["grid_bytes"] == 8**3 * 4 * (1 if sigma == GREY else 3)

    numbers = summary["variants"][VARIANT]
    assert set(numbers["methods"]) == {m.key for m in methods_for(VARIANT, (4, 8))}
    for method in numbers["methods"].values():
        assert [r["spp"] for r in method["accumulated"]] == [3, 6]
        assert all(r["cpu_seconds"] > 0 for r in method["rounds"])
    assert set(numbers["efficiency_ratios"]) == set(numbers["methods"][OURS.key]["efficiency"])
    assert "best_grid" in numbers["efficiency_ratios"]["mse"]

    html = (tmp_path / "report/report.html").read_text()
    assert html.count("data:image/png;base64,") >= 10
    # With the colon: "http" alone turns up in base64 now and then.
    assert "http:" not in html and "https:" not in html, "self-contained"


def test_strategies_are_compared_with_spectral_mis(scene, tmp_path):
    """Ours has a ratio to each strategy; they are neither grids nor stock methods."""
    options = Options(str(scene(CHROMATIC)), (VARIANT,), (4,), rounds=2, spp=2, strategies=True)
    summary = compare(options, tmp_path / "report", "test")

    numbers = summary["variants"][VARIANT]
    strategies = {m["strategy"]: key for key, m in numbers["methods"].items() if m["strategy"]}
    assert set(strategies) == set(STRATEGIES)
    for kind, ratios in numbers["efficiency_ratios"].items():
        assert set(strategies.values()) <= set(ratios), kind
        assert set(ratios) <= {*numbers["methods"], "best_grid", "best_tracking"}
    assert "analyticvolpath (single), exact medium" in (tmp_path / "report/report.html").read_text()


def test_best_stock_methods_are_stock_methods():
    """Were a strategy of ours twice as efficient as all else, no best stock method would be it."""
    from analytic_media.compare.protocol import efficiency_ratios

    class Rounds:
        def __init__(self, mse):
            self.rounds = [{"mse": mse, "cpu_seconds": 1.0}]

    methods = methods_for(VARIANT, (4,), strategies=True)
    errors = {EXACT: 1.0, TRACKED: 3.0, 4: 5.0}
    runs = {m: Rounds(0.5 if m.strategy else errors[m.medium]) for m in methods}
    ratios = efficiency_ratios(runs, "mse")
    assert ratios["best_tracking"]["median"] == pytest.approx(3)
    assert ratios["best_grid"]["median"] == pytest.approx(5)
    assert ratios["analyticvolpath (single)@exact"]["median"] == pytest.approx(0.5)


def test_strategy_is_a_property_of_the_integrator():
    plugins = [m.plugin for m in methods_for(VARIANT, (), strategies=True)]
    expected = [{"type": "analyticvolpath", "spectral_sampling": name} for name in STRATEGIES]
    assert plugins[:4] == [{"type": "analyticvolpath"}, *expected]


# ---- Spectral variants

SPECTRAL = "scalar_spectral"
spectral = pytest.mark.parametrize("variant", [SPECTRAL], indirect=True)


@spectral
@pytest.mark.parametrize("sigma", [CHROMATIC, SPECTRUM], ids=["rgb", "spectrum"])
def test_coloured_media_are_compared_in_spectral_variants(variant, scene, tmp_path, sigma):
    options = Options(str(scene(sigma)), (variant,), (4,), rounds=2, spp=2)
    summary = compare(options, tmp_path / "report", "test")
    references = summary["references"]["spectral"]
    assert references[EXACT]["integrator"] == "analyticvolpath"
    assert references["4"]["integrator"] == "volpathmis"
    methods = summary["variants"][variant]["methods"]
    assert all(r["mean"] > 0 for method in methods.values() for r in method["rounds"])


@spectral
def test_grid_has_the_colour_of_the_medium_in_spectral_variants(variant, scene, tmp_path):
    """gridvolume makes a smooth spectrum of three channels, whose colour under D65 they are."""
    state = twin.parse(scene(CHROMATIC), variant)
    copy, _ = twin.voxelised(state, 4, variant, tmp_path)
    [volume] = [n.props for n in copy.nodes if n.props.plugin_name() == "gridvolume"]
    grid = mi.load_dict(
        {"type": "gridvolume", "filename": volume["filename"], "use_grid_bbox": True}
    )
    wavelengths = np.linspace(360, 830, 96)
    place = mi.MediumInteraction3f()
    place.p = mi.ScalarPoint3f(0, 0, 0)
    values = []
    for four in wavelengths.reshape(-1, 4):
        place.wavelengths = four
        values.extend(grid.eval(place))
    colour = mi.spectrum_list_to_srgb(wavelengths.tolist(), values, bounded=False, d65=True)
    np.testing.assert_allclose(np.array(colour) / colour[2], [0.25, 0.5, 1], rtol=0.02)


def test_spectrum_is_voxelised_with_the_colour_that_mitsuba_gives_it(scene):
    [medium] = twin.read_media(twin.parse(scene(SPECTRUM), VARIANT))
    loaded = mi.load_file(str(scene(SPECTRUM)))
    own = mi.traverse(loaded)["fog.sigma_t.value.value"]
    np.testing.assert_allclose(medium.sigma_t, 2 * np.array(own), rtol=1e-5)


def test_camera_rays_pass_index_matched_boundaries(tmp_path):
    """A box with a null BSDF stands before a sphere of radius 0.4, 1.8 away from the camera,
    whose rays start at its near clipping plane, at 0.01."""
    from analytic_media.compare import bias

    box = '<shape type="cube"><bsdf type="null"/></shape>'
    path = tmp_path / "scene.xml"
    path.write_text(SCENE.replace("SIGMA", GREY).replace("</scene>", box + "</scene>"))
    fan = bias.camera_fan(twin.parse(path, VARIANT), VARIANT, rays=11)
    assert fan.lengths[5] == pytest.approx(1.8 - 0.4 - 0.01, abs=1e-3)
    assert fan.lengths[0] > fan.lengths[5] + 0.1, "the outermost ray grazes the sphere"


def test_transmittance_of_a_fine_grid_is_nearly_exact(scene, tmp_path):
    """The trilinear error of exp(-z/H) is (cell/H)²/12 at most, here 0.1 %, plus the edges."""
    from analytic_media.compare import bias, media

    state = twin.parse(scene(), VARIANT)
    [medium] = twin.read_media(state)
    fan = bias.camera_fan(state, VARIANT, rays=12)
    grids = [media.grids(medium, medium.bbox, n).extinction for n in (8, 40)]
    result = bias.transmittance_bias(fan, medium, medium.bbox, grids)
    coarse, fine = (abs(result["grids"][n]["largest_relative_bias"]) for n in (8, 40))
    assert fine < 2e-3 < coarse
