"""Presets: their numbers against published ones, and their scenes against stock Mitsuba."""

import gc
import xml.etree.ElementTree as xml
from pathlib import Path

import mitsuba as mi
import numpy as np
import pytest
import render_scenes as scenes
from zscores import assert_agree, render_passes

import analytic_media as am
from analytic_media import presets
from analytic_media.compare.media import profile_classes
from analytic_media.presets import rayleigh
from analytic_media.presets.atmosphere import RGB_WAVELENGTHS
from analytic_media.presets.earth import planet as earth_planet

SCENES = Path(__file__).parents[2] / "scenes"

variants = pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"], indirect=True)
scalar_rgb = pytest.mark.parametrize("variant", ["scalar_rgb"], indirect=True)
llvm_ad_rgb = pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)

PLANETS = {"earth": presets.earth, "mars": presets.mars, "titan": presets.titan}
MEDIA = {
    "earth": presets.earth_medium,
    "mars": presets.mars_medium,
    "titan": presets.titan_medium,
}


# ---- Numbers


def zenith_optical_depth(planet, name, wavelength):
    """From the ground up, by the coefficient and the profile that a scene gets."""
    layer = planet.layers[name]
    radius = planet.radius
    profile = profile_classes()[layer.profile](
        center=(0, 0, -radius), radius=radius, **layer.lengths
    )
    sigma_t = layer.optical_depth(np.asarray(wavelength)) / layer.thickness
    return sigma_t * profile.column((0, 0, 0), (0, 0, 1), planet.top)


# Bodhaine et al. (1999), Table 3: at sea level, 45° latitude. The fit of their Eq. 29, which the
# preset uses, is good to 1e-4.
BODHAINE = [
    (400, 0.36022), (450, 0.22111), (500, 0.14336), (550, 0.09707), (600, 0.06809),
    (650, 0.04919), (700, 0.03642), (800, 0.02123),
]  # fmt: skip


@pytest.mark.parametrize(("wavelength", "expected"), BODHAINE)
def test_rayleigh_optical_depth_is_the_published_one(wavelength, expected):
    found = zenith_optical_depth(earth_planet(), "molecules", wavelength)
    assert found == pytest.approx(expected, rel=2e-4)


@pytest.mark.parametrize(("wavelength", "expected"), [(450, 0.144), (550, 0.122), (1000, 0.081)])
def test_aerosol_optical_depth_is_the_published_one(wavelength, expected):
    found = zenith_optical_depth(earth_planet(), "aerosol", wavelength)
    assert found == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(
    ("wavelength", "cross_section"), [(543.52, 3.08e-25), (604.61, 5.18e-25), (632.82, 3.36e-25)]
)
def test_ozone_agrees_with_measurements_at_laser_lines(wavelength, cross_section):
    """Anderson and Mauersberger, Geophys. Res. Lett. 19 (1992); at room temperature, and our bins
    are 10 nm wide."""
    found = zenith_optical_depth(earth_planet(ozone=300), "ozone", wavelength)
    assert found == pytest.approx(300 * 2.687e20 * cross_section, rel=0.04)


def test_nitrogen_scatters_as_air_does():
    """Four fifths of air is nitrogen, and oxygen differs by less than a tenth."""
    wavelengths = np.array([400.0, 550.0, 700.0])
    np.testing.assert_allclose(rayleigh.nitrogen(wavelengths), rayleigh.air(wavelengths), rtol=0.04)


def test_carbon_dioxide_has_its_published_refractivity():
    """4.5e-4 at 0 °C and 589 nm (Kaye and Laby), here at 15 °C; with a King factor of 1.14 it
    scatters 2.6 times as much as air of the refractivity 2.77e-4 and the King factor 1.05."""
    found = rayleigh.carbon_dioxide(589.3) / rayleigh.air(589.3)
    expected = (4.49e-4 * 273.15 / 288.15 / 2.77e-4) ** 2 * 1.1436 / 1.0486
    assert found == pytest.approx(expected, rel=0.01)


def test_colours_are_the_coefficients_at_their_wavelengths():
    mi.set_variant("scalar_rgb")
    layer = earth_planet().layers["molecules"]
    found = presets.earth_medium("km")["molecules"]["sigma_t"]["value"]
    expected = 1000 * layer.optical_depth(np.array(RGB_WAVELENGTHS)) / layer.thickness
    assert found == pytest.approx(expected)


def test_half_a_visibility_of_fog_leaves_what_its_definition_says():
    fog = presets.height_fog(visibility=200, scale_height=15)
    medium = am.Medium([(am.Exponential(scale_height=fog["scale_height"]), fog["sigma_t"])])
    assert medium.transmittance((0, 0, 0), (1, 0, 0), 200) == pytest.approx(0.05)


# ---- Scenes


@pytest.mark.parametrize("variant", ["scalar_rgb", "scalar_spectral"], indirect=True)
@pytest.mark.parametrize("view", ["horizon", "fisheye", "orbit"])
@pytest.mark.parametrize("name", PLANETS)
def test_views_render(variant, name, view):
    scene = PLANETS[name](view, width=16, height=9, spp=4, sun_zenith=80)
    image = np.array(mi.render(mi.load_dict(scene)))
    assert np.isfinite(image).all()
    assert image.mean() > 0


@pytest.mark.parametrize("variant", ["llvm_ad_rgb", "llvm_ad_spectral"], indirect=True)
@pytest.mark.parametrize("name", PLANETS)
def test_scenes_load_in_jit_variants(variant, name):
    """Rendering them would compile kernels for minutes; the Earth is rendered below."""
    gc.collect()
    assert len(mi.load_dict(PLANETS[name]()).emitters()) == 1


@scalar_rgb
@pytest.mark.parametrize("name", MEDIA)
def test_medium_is_that_of_the_scene(variant, name):
    assert MEDIA[name]("m") == PLANETS[name](unit="m")["air"]


@scalar_rgb
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"unit": "mile"}, "unit"),
        ({"unit": -1.0}, "unit"),
        ({"view": "moon"}, "view"),
        ({"ground": "cube"}, "ground"),
        ({"aerosol": -0.1}, "aerosol"),
        ({"view": "fisheye", "altitude": 2.0}, "altitude"),
    ],
)
def test_bad_arguments_are_named(variant, options, message):
    with pytest.raises(ValueError, match=message):
        presets.earth(**options)


def without_air(scene, max_depth=2):
    """The same scene in a vacuum."""
    rest = {key: value for key, value in scene.items() if key != "air"}
    sensor = {key: value for key, value in scene["sensor"].items() if key != "medium"}
    return rest | {"sensor": sensor, "integrator": {"type": "path", "max_depth": max_depth}}


@variants
@pytest.mark.parametrize("unit", ["m", "km"])
@pytest.mark.parametrize("elevation", [-40, -8])
def test_ground_has_no_specks(variant, unit, elevation):
    """In a vacuum every pixel of the ground near the camera shines alike: nothing shadows it."""
    options = {"elevation": elevation, "fov": 10, "sun_zenith": 60, "width": 64, "height": 64}
    scene = presets.earth("horizon", unit, **options)
    irradiance = np.array(mi.traverse(mi.load_dict(scene["sun"]))["irradiance.value"]).ravel()
    image = np.array(mi.render(mi.load_dict(without_air(scene)), spp=4))
    expected = np.broadcast_to(0.1 / np.pi * irradiance * 0.5, image.shape)
    np.testing.assert_allclose(image, expected, rtol=2e-3)


@scalar_rgb
@pytest.mark.parametrize(("zenith", "azimuth"), [(20, 0), (50, 90), (80, 200)])
def test_fisheye_is_equisolid(variant, zenith, azimuth):
    """A star shows up where the projection says: at sin(θ/2) / sin(45°) of the circle."""
    z, a = np.radians([zenith, azimuth])
    direction = np.array([np.sin(z) * np.sin(a), np.sin(z) * np.cos(a), np.cos(z)])
    scene = without_air(presets.earth("fisheye", width=100, height=100, spp=16))
    del scene["sun"], scene["ground"]
    scene["star"] = scenes.glowing_sphere((100 * direction).tolist(), 2, 1)
    image = np.array(mi.render(mi.load_dict(scene))).mean(axis=2)
    y, x = (np.indices(image.shape) + 0.5) / 50 - 1
    centre = np.array([(image * x).sum(), -(image * y).sum()]) / image.sum()
    radius = np.sin(z / 2) / np.sin(np.pi / 4)
    np.testing.assert_allclose(centre, radius * np.array([np.sin(a), np.cos(a)]), atol=5e-3)


def statements(element):
    """The parameters that an XML element of a medium states."""
    numbers = {
        child.get("name"): [float(number) for number in child.get("value").split(",")]
        for child in element
        if child.tag in ("float", "rgb", "point")
    }
    return {name: value if len(value) > 1 else value[0] for name, value in numbers.items()}


def plain(value):
    """A colour of a dictionary as a list."""
    return value["value"] if isinstance(value, dict) else value


@scalar_rgb
def test_xml_has_the_numbers_of_the_preset(variant):
    preset = presets.earth_medium("km")
    medium = xml.parse(SCENES / "earth" / "air.xml").getroot().find("medium")
    assert statements(medium) == {key: preset[key] for key in ("bsphere_center", "bsphere_radius")}
    layers = {layer.get("name"): layer for layer in medium.findall("medium")}
    assert set(layers) == {key for key, value in preset.items() if isinstance(value, dict)}
    for name, layer in layers.items():
        for key, value in statements(layer).items():
            assert value == pytest.approx(plain(preset[name][key]), rel=1e-6), (name, key)
        assert layer.find("string").get("value") == preset[name]["profile"]
        assert layer.find("phase").get("type") == preset[name]["phase"]["type"]


@scalar_rgb
@pytest.mark.parametrize(
    ("name", "view"),
    [
        ("earth_noon", {"sun_zenith": 40, "sun_azimuth": 30}),
        ("earth_sunset", {"sun_zenith": 88, "sun_azimuth": 10}),
        ("earth_orbit", {"view": "orbit", "sun_zenith": 60, "sun_azimuth": 60}),
    ],
)
def test_xml_scene_is_the_preset(variant, name, view):
    """Camera and sun; and it loads."""
    ours = mi.load_file(str(SCENES / f"{name}.xml"))
    preset = mi.load_dict(presets.earth(**view))
    for question in (position, field_of_view, sunlight):
        np.testing.assert_allclose(question(ours), question(preset), rtol=1e-4, atol=1e-5)


def position(scene):
    return np.array(scene.sensors()[0].world_transform().matrix)


def field_of_view(scene):
    return mi.traverse(scene.sensors()[0])["x_fov"]


def sunlight(scene):
    params = mi.traverse(scene.emitters()[0])
    towards = np.array(params["to_world"].matrix)[:3, 2]
    return np.concatenate([towards, np.array(params["irradiance.value"]).ravel()])


# ---- Statistics of renders

VIEWS = {
    "horizon": {"view": "horizon", "elevation": 5, "fov": 12, "sun_zenith": 75},
    "limb": {"view": "orbit", "elevation": -25, "fov": 12, "sun_zenith": 75},
}
VOLPATH = {"type": "volpath"}
VOLPATHMIS = {"type": "volpathmis", "rr_depth": 1000}  # too dark while it plays roulette
OURS = {"type": "analyticvolpath"}


def passes(scene, integrator, side, spp=4, max_depth=5):
    scene["sensor"]["film"] = scenes.film("rgb")
    return render_passes(scene, integrator | {"max_depth": max_depth}, side, spp)


def grey(value):
    """The scene in green light, for which stock volpath is a fair reference."""
    if isinstance(value, dict):
        if value.get("type") == "rgb":
            return value["value"][1]
        if value.get("type") == "spectrum":
            return {"type": "uniform", "value": 1.0}
        return {key: grey(entry) for key, entry in value.items()}
    return value


@llvm_ad_rgb
@pytest.mark.parametrize("view", VIEWS)
def test_metres_and_kilometres_agree(variant, view):
    a, b = (presets.earth(unit=unit, **VIEWS[view]) for unit in ("m", "km"))
    assert_agree(passes(a, OURS, 0), passes(b, OURS, 1))


@pytest.mark.parametrize(
    ("variant", "view"),
    [("scalar_rgb", "horizon"), ("llvm_ad_rgb", "horizon"), ("llvm_ad_rgb", "limb")],
    indirect=["variant"],
)
def test_earth_agrees_with_delta_tracking(variant, view):
    scene = grey(presets.earth(**VIEWS[view]))
    spp = 2 if variant == "scalar_rgb" else 4
    assert_agree(passes(scene, VOLPATH, 0, spp), passes(scene, OURS, 1, spp))


@llvm_ad_rgb
@pytest.mark.parametrize("view", VIEWS)
def test_coloured_earth_agrees_with_volpathmis(variant, view):
    """With a boundary: without one, stock integrators lose the light that leaves."""
    scene = presets.earth(**VIEWS[view], boundary=True)
    assert_agree(passes(scene, VOLPATHMIS, 0, spp=12), passes(scene, OURS, 1, spp=12))
