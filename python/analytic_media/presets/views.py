"""Cameras for planets: z is up at the origin of coordinates, which lies on the ground."""

from dataclasses import dataclass

import numpy as np

from .atmosphere import Planet, Unit

NEAR = 0.1  # m
MIRROR = 10.0  # radius of the fisheye's mirror, m
MEDIUM = {"type": "ref", "id": "air"}


@dataclass(frozen=True)
class Film:
    width: int
    height: int
    spp: int

    def parts(self) -> dict:
        """Film and sampler of a sensor."""
        film = {
            "type": "hdrfilm",
            "width": self.width,
            "height": self.height,
            "rfilter": {"type": "box"},
        }
        return {"film": film, "sampler": {"type": "independent", "sample_count": self.spp}}


def horizon(planet: Planet, unit: Unit, film: Film, altitude=2.0, elevation=12.0, fov=70.0) -> dict:
    """A camera that looks towards +y, `elevation` degrees above the horizontal.

    * `altitude`: of the camera, m
    * `fov`: angle across the picture, degrees
    """
    angle = np.radians(elevation)
    direction = np.array([0, np.cos(angle), np.sin(angle)])
    return {"sensor": perspective(planet, unit, film, altitude, direction, fov)}


def orbit(planet: Planet, unit: Unit, film: Film, altitude=400e3, elevation=None, fov=40.0) -> dict:
    """`horizon` from space: by default the camera looks at the limb."""
    if elevation is None:
        elevation = -np.degrees(np.arccos(planet.radius / (planet.radius + altitude)))
    return horizon(planet, unit, film, altitude, elevation, fov)


def fisheye(planet: Planet, unit: Unit, film: Film, altitude=25.0) -> dict:
    """The whole sky, in the circle that touches the picture's nearer edges.

    Mitsuba has no fisheye camera, but photographers have used a mirror ball: an orthographic
    camera looks down at a mirror of radius MIRROR metres, whose top is `altitude` metres above
    the ground. Its projection is equisolid: the distance from the centre goes with sin(θ/2) of
    the zenith angle θ. +y is up and +x right, as on a map; outside of the circle the picture shows
    the ground. A path is one vertex longer, and the few metres of air before the mirror count.
    """
    if altitude < 2 * MIRROR:
        raise ValueError(f"altitude must be >= {2 * MIRROR:g} m for a fisheye, got {altitude}")
    to_world = looking(unit, [0, 0, altitude + 1], [0, 0, -1], up=[0, 1, 0])
    # At the horizon the normal of the mirror is inclined by 45°. Film x grows to the left.
    half_width = unit.length(MIRROR * np.sin(np.pi / 4)) * max(film.width / film.height, 1)
    mirror = {
        "type": "sphere",
        "center": [0.0, 0.0, unit.length(altitude - MIRROR)],
        "radius": unit.length(MIRROR),
        "bsdf": {"type": "conductor", "material": "none"},
    }
    sensor = {
        "type": "orthographic",
        "to_world": to_world.scale([half_width, half_width, 1]),
        "near_clip": unit.length(NEAR),
        "far_clip": unit.length(altitude + 1),
        "medium": MEDIUM,
        **film.parts(),
    }
    return {"sensor": sensor, "mirror": mirror}


VIEWS = {"horizon": horizon, "orbit": orbit, "fisheye": fisheye}


def perspective(planet, unit, film, altitude, direction, fov) -> dict:
    return {
        "type": "perspective",
        "to_world": looking(unit, [0, 0, altitude], direction, up=[0, 0, 1]),
        "fov": fov,
        "fov_axis": "x",
        "near_clip": unit.length(NEAR),
        "far_clip": unit.length(4 * (planet.radius + planet.top + altitude)),
        "medium": MEDIUM,
        **film.parts(),
    }


def looking(unit, position, direction, up):
    """Camera to world, for a position in metres."""
    import mitsuba as mi

    origin = np.array([unit.length(metres) for metres in position])
    # The target is as far away as the origin is, for float32 to keep the direction.
    target = origin + np.asarray(direction) * max(np.linalg.norm(origin), 1.0)
    return mi.ScalarTransform4f().look_at(origin.tolist(), target.tolist(), up)
