"""What a grid does to the transmittance: a fan of camera rays, exact against interpolated."""

from dataclasses import dataclass

import mitsuba as mi
import numpy as np

from . import twin

STEPS = 8192  # midpoint rule along a ray: 8 or more points per voxel at 256³
RAYS = 96


@dataclass
class Fan:
    """Rays through the middle column of the image, each up to the first visible surface."""

    origins: np.ndarray
    directions: np.ndarray
    lengths: np.ndarray
    elevation: np.ndarray  # degrees above the horizontal, z up


def camera_fan(state, variant, rays=RAYS):
    scene = twin.instantiate(twin.without_media(state), variant)
    sensor = scene.sensors()[0]
    hits = []
    for k in range(rays):
        ray, _ = sensor.sample_ray(0.0, 0.5, mi.ScalarPoint2f(0.5, (k + 0.5) / rays), 0.5)
        hits.append(([*ray.o], [*ray.d], distance(scene, ray)))
    origins, directions, lengths = (
        np.array(values, dtype=float) for values in zip(*hits, strict=True)
    )
    elevation = np.degrees(np.arcsin(np.clip(directions[:, 2], -1, 1)))
    return Fan(origins, directions, lengths, elevation)


def distance(scene, ray):
    """Length of a ray up to the first surface that is not an index-matched boundary."""
    travelled = 0.0
    while True:
        si = scene.ray_intersect(ray)
        travelled += float(si.t)
        if not si.is_valid() or not mi.has_flag(si.bsdf().flags(), mi.BSDFFlags.Null):
            return travelled
        ray = si.spawn_ray(ray.d)


def clip_to_box(fan, bbox):
    """The part of each ray inside the box: (first points, lengths), 0 where it misses."""
    lower, upper = np.asarray(bbox)
    with np.errstate(divide="ignore", invalid="ignore"):
        sides = (np.stack([lower, upper])[:, None] - fan.origins) / fan.directions
    near = np.maximum(np.nanmax(sides.min(axis=0), axis=-1), 0)
    far = np.minimum(np.nanmin(sides.max(axis=0), axis=-1), fan.lengths)
    lengths = np.maximum(far - near, 0)
    return fan.origins + near[:, None] * fan.directions, lengths


def transmittance_bias(fan, medium, bbox, grids):
    """Transmittances of the fan in the medium's strongest channel, exact and on each grid.

    `grids` hold the extinction relative to the medium's `sigma_max`.
    """
    starts, lengths = clip_to_box(fan, bbox)
    exact = np.exp(-medium.optical_depth(starts, fan.directions, lengths))
    result = {
        "medium": medium.name,
        "elevation_degrees": fan.elevation.tolist(),
        "exact": exact.tolist(),
        "grids": {},
    }
    middle = (np.arange(STEPS) + 0.5) / STEPS
    channel = 0 if medium.is_grey else medium.strongest_channel
    for grid in grids:
        columns = [
            length * np.mean(grid.density(start + (middle * length)[:, None] * direction, channel))
            for start, direction, length in zip(starts, fan.directions, lengths, strict=True)
        ]
        transmittance = np.exp(-medium.sigma_max * np.array(columns))
        # A ray through the ground is dark on both sides.
        relative = np.divide(transmittance, exact, where=exact > 0, out=np.ones_like(exact)) - 1
        result["grids"][grid.resolution] = {
            "transmittance": transmittance.tolist(),
            "relative_bias": relative.tolist(),
            "mean_relative_bias": float(np.mean(relative)),
            "largest_relative_bias": float(relative[np.argmax(np.abs(relative))]),
            "grid_bytes": int(grid.nbytes),
        }
    return result
