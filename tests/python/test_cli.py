"""The command line: what it refuses, and with which words."""

import xml.etree.ElementTree as ElementTree

import pytest

from analytic_media import cli

mi = pytest.importorskip("mitsuba")

SCENE = """
<scene version="3.0.0">
    <default name="sigma" value="0.5"/>
    <integrator type="analyticvolpath">
        <integer name="max_depth" value="4"/><integer name="paths" value="2"/>
    </integrator>
    <medium type="analytic" id="fog">
        <string name="profile" value="linear"/>
        <float name="gradient" value="-0.5"/><float name="density" value="1"/>
        <float name="sigma_t" value="$sigma"/>
        <float name="albedo" value="0.9"/>
        <point name="bbox_min" value="-1, -1, 0"/><point name="bbox_max" value="1, 1, 2"/>
    </medium>
    <sensor type="perspective">
        <ref id="fog"/>
        <film type="hdrfilm">
            <integer name="width" value="4"/><integer name="height" value="4"/>
        </film>
        <sampler type="independent"><integer name="sample_count" value="2"/></sampler>
    </sensor>
    <emitter type="constant"/>
    <shape type="sphere"/>
</scene>
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "fog.xml"
    path.write_text(SCENE)
    return path


def run(*arguments):
    """Exit code, whether argparse raises it or main returns it."""
    try:
        return cli.main([str(a) for a in arguments])
    except SystemExit as end:
        return end.code


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "required: COMMAND"),
        (("paint",), "invalid choice"),
        (("compare", "{scene}", "--time", "-1"), "must be finite and > 0, got -1"),
        (("compare", "{scene}", "--rounds", "0"), "must be finite and > 0, got 0"),
        (("compare", "{scene}", "--rounds", "two"), "invalid int value"),
        (("compare", "{scene}", "--resolutions", "64,1"), "between 2 and 1024 voxels, got 1"),
        (("compare", "{scene}", "--resolutions", "64,64"), "each resolution once"),
        (("compare", "{scene}", "--variant", "scalar_ultraviolet"), "unknown variant"),
        (("compare", "{scene}", "-D", "spp"), "must be NAME=VALUE, got spp"),
        (("compare", "{scene}", "-D", "speed=3"), "speed"),
        (("compare", "missing.xml"), "missing.xml does not exist"),
        (("voxelize", "{scene}", "--resolution", "4096"), "between 2 and 1024 voxels, got 4096"),
        (("voxelize", "{scene}", "--medium", "smoke"), "no 'analytic' medium with id 'smoke'"),
    ],
)
def test_bad_usage_exits_with_2_and_says_why(scene, tmp_path, capsys, arguments, words):
    output = tmp_path / "out"
    filled = [a.format(scene=scene) for a in arguments]
    if filled and filled[0] in ("compare", "voxelize"):
        filled += ["--output", output]
    assert run(*filled) == 2
    assert words in capsys.readouterr().err
    assert not output.exists(), "nothing half-made"


def test_help_names_the_commands(capsys):
    assert run("--help") == 0
    text = capsys.readouterr().out
    assert all(name in text for name in ("compare", "voxelize", "doctor"))


def test_voxelize_writes_a_scene_for_stock_mitsuba(scene, tmp_path, capsys):
    """The twin renders without our plugins: it names stock ones only."""
    output = tmp_path / "voxels"
    assert run("voxelize", scene, "--resolution", "4", "--output", output, "-D", "sigma=0.25") == 0
    assert "box (-1, -1, 0) to (1, 1, 2)" in capsys.readouterr().out
    written = output / "fog_4.xml"
    text = written.read_text()
    assert "analytic" not in text.replace("analytic-media voxelize", "")
    assert "paths" not in text  # unknown to volpath
    assert '<float name="scale" value="0.25"' in text
    mi.set_variant("scalar_rgb")
    mi.file_resolver().prepend(str(output))
    image = mi.render(mi.load_file(str(written)), spp=2)
    assert image.shape == (4, 4, 3)


SHARED = """
<scene version="3.0.0">
    <phase type="hg" id="droplets"><float name="g" value="0.8"/></phase>
    <medium type="overlap" id="fog">
        <point name="bbox_min" value="-1, -1, 0"/>
        <point name="bbox_max" value="1, 1, 2"/>
        <medium type="analytic" name="a"><ref id="droplets"/></medium>
        <medium type="analytic" name="b">{second}</medium>
    </medium>
    <shape type="sphere"><ref name="interior" id="fog"/></shape>
</scene>
"""


@pytest.mark.parametrize(
    ("second", "kinds"),
    [
        ('<ref id="droplets"/>', ["hg"]),
        ('<phase type="hg"><float name="g" value="0.5"/></phase>', ["blendphase", "hg", "hg"]),
        ('<phase type="isotropic"/>', ["blendphase", "hg", "isotropic"]),
    ],
    ids=["the same", "another", "of another kind"],
)
def test_voxelized_overlaps_keep_their_phase_functions(tmp_path, second, kinds):
    """By reference or stated; those that two components share are not blended."""
    scene = tmp_path / "scene.xml"
    scene.write_text(SHARED.format(second=second))
    assert run("voxelize", scene, "--resolution", "4", "--output", tmp_path) == 0
    medium = ElementTree.parse(tmp_path / "scene_4.xml").find("medium")
    assert [phase.get("type") for phase in medium.iter("phase")] == kinds
    assert medium.find(".//phase[@type='hg']/float[@name='g']").get("value") == "0.8"
    mi.set_variant("scalar_rgb")
    mi.file_resolver().prepend(str(tmp_path))
    mi.load_file(str(tmp_path / "scene_4.xml"))


@pytest.mark.parametrize("swap", [False, True], ids=["stated first", "referred to first"])
def test_voxelized_overlaps_keep_what_others_refer_to(tmp_path, swap):
    """A phase function that is stated in an overlap may serve other media as well."""
    components = [
        '<phase type="hg" id="own"><float name="g" value="0.8"/></phase>',
        '<ref id="own"/>',
    ]
    first, second = reversed(components) if swap else components
    text = SHARED.replace('<ref id="droplets"/>', first).format(second=second)
    other = '<medium type="homogeneous" id="other"><ref id="own"/></medium>'
    scene = tmp_path / "scene.xml"
    scene.write_text(text.replace("<shape", other + "<shape"))
    assert run("voxelize", scene, "--resolution", "4", "--output", tmp_path) == 0
    medium = ElementTree.parse(tmp_path / "scene_4.xml").find("medium[@id='fog']")
    assert [phase.get("type") for phase in medium.iter("phase")] == ["hg"]
    mi.set_variant("scalar_rgb")
    mi.file_resolver().prepend(str(tmp_path))
    mi.load_file(str(tmp_path / "scene_4.xml"))
