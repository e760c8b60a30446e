"""A planet, the sun and a camera: dictionaries for mi.load_dict."""

from . import ground as grounds
from . import sun
from .atmosphere import Planet, Unit, colour
from .views import MEDIUM, VIEWS, Film


def medium(planet: Planet, unit: str | float, max_density: float | None) -> dict:
    """The atmosphere alone; see `Planet.medium`."""
    return planet.medium(Unit.of(unit), max_density)


def scene(
    planet: Planet,
    view: str = "horizon",
    unit: str | float = "km",
    *,
    ground: str | None = "auto",
    boundary: bool = False,
    sun_zenith: float = 60.0,
    sun_azimuth: float = 30.0,
    max_density: float | None = None,
    integrator: str = "analyticvolpath",
    max_depth: int = 64,
    width: int = 640,
    height: int = 360,
    spp: int = 64,
    **camera: float,
) -> dict:
    """A complete scene.

    The origin of coordinates lies on the ground, z is up, the centre of the planet is at
    (0, 0, -radius). The medium has the name "air"; the camera is in it.

    * `view`: "horizon" (`altitude`, `elevation`, `fov`), "orbit" (the same, from space) or
      "fisheye" (`altitude`); further arguments go to the view: see `presets.views`
    * `unit`: of the scene: "m", "km", or a number of metres; all arguments are in metres
    * `ground`: "mesh" for views from near the ground, "sphere" for those from space, "auto" for
      the one that suits the view; None leaves it to the caller, who must keep rays out of the
      planet
    * `boundary`: whether a sphere that lets all light through surrounds the atmosphere. Stock
      `volpath` and `volpathmis` lose the light that leaves a coloured medium without one
    * `sun_zenith`, `sun_azimuth`: of the sun, in degrees; the azimuth from the direction of view
      to the right
    * `max_density`: the density that stock integrators track at most; see the medium `overlap`
    """
    scale = Unit.of(unit)
    if view not in VIEWS:
        raise ValueError(f"view must be one of {', '.join(VIEWS)}, got {view!r}")
    if ground == "auto":
        ground = "sphere" if view == "orbit" else "mesh"
    bsdf = {"type": "diffuse", "reflectance": reflectance(planet)}
    result = {
        "type": "scene",
        "integrator": {"type": integrator, "max_depth": max_depth},
        "air": planet.medium(scale, max_density),
        "sun": sun.emitter(sun_zenith, sun_azimuth, planet.sun_distance),
        **grounds.shape(ground, scale.length(planet.radius), bsdf),
        **VIEWS[view](planet, scale, Film(width, height, spp), **camera),
    }
    return with_boundary(result) if boundary else result


def with_boundary(scene: dict) -> dict:
    """The scene with a `null` sphere around its medium; a camera outside is in no medium then."""
    center, radius = (scene["air"][key] for key in ("bsphere_center", "bsphere_radius"))
    sphere = {
        "type": "sphere",
        "center": center,
        "radius": radius,
        "bsdf": {"type": "null"},
        "interior": MEDIUM,
    }
    height = scene["sensor"]["to_world"].matrix[2, 3]  # the camera is above the origin
    outside = height > center[2] + radius
    sensor = {k: v for k, v in scene["sensor"].items() if k != "medium" or not outside}
    return scene | {"sensor": sensor, "boundary": sphere}


def reflectance(planet: Planet) -> dict:
    """The ground's albedo, as a BSDF wants it: a number would not do."""
    value = colour(planet.ground)
    return value if isinstance(value, dict) else {"type": "uniform", "value": value}
