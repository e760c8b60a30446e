"""The plugins load in every variant, and refuse a Mitsuba they were not built for."""

import subprocess
import sys

import mitsuba as mi
import pytest

from analytic_media import _build, _plugins

BOX = {"bbox_min": [0, 0, 0], "bbox_max": [1, 1, 1]}
PLUGINS = {
    "AnalyticMedium": {"type": "analytic"},
    "OverlapMedium": {"type": "overlap", "fog": {"type": "analytic"}},
    "AnalyticVolume": {"type": "analyticvolume", **BOX},
    "AnalyticVolpathIntegrator": {"type": "analyticvolpath"},
}


def test_every_variant_of_the_wheel_is_built():
    """`mi.variants()` is the wheel's own list; a developer build may hold fewer."""
    if set(_build.VARIANTS) != set(mi.variants()):
        pytest.skip(f"developer build with {', '.join(_build.VARIANTS)}")
    assert tuple(mi.variants()) == _build.VARIANTS


@pytest.mark.parametrize("variant", [v for v in _build.VARIANTS if v.startswith("scalar")])
@pytest.mark.parametrize("class_name", PLUGINS)
def test_plugin_loads_by_its_name(variant, class_name):
    """The object names its class, so a loader that leads to another plugin shows."""
    mi.set_variant(variant)
    assert mi.load_dict(PLUGINS[class_name]).class_name() == class_name


def test_worker_process_finds_the_plugins():
    """The file resolver is per process; importing the package is all a worker needs."""
    code = (
        "import analytic_media, mitsuba as mi; mi.set_variant('scalar_rgb');"
        "mi.load_dict({'type': 'analytic'})"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd="/")


def test_another_mitsuba_version_is_refused(monkeypatch):
    monkeypatch.setattr(mi, "__version__", "3.8.0")
    with pytest.raises(ImportError, match=r"built for Mitsuba 3\.9\.1 but 3\.8\.0"):
        _plugins.register()
