"""Small scenes in which every pixel sees scattered light, for statistics of renders.

The functions return dicts for mi.load_dict, without an integrator; a medium is a dict too.
"""

import mitsuba as mi
import numpy as np

PHASE = {"type": "hg", "g": 0.5}


def film(pixel_format="luminance", size=64):
    """Pixels that do not share samples, so that their statistics are independent."""
    return {
        "type": "hdrfilm",
        "width": size,
        "height": size,
        "pixel_format": pixel_format,
        "component_format": "float32",
        "rfilter": {"type": "box"},
    }


def camera(origin, target, fov, medium=None, **film_options):
    sensor = {
        "type": "perspective",
        "to_world": mi.ScalarTransform4f().look_at(origin, target, [0, 0, 1]),
        "fov": fov,
        "near_clip": 1e-3,
        "film": film(**film_options),
        "sampler": {"type": "independent"},
    }
    return sensor | ({"medium": medium} if medium else {})


def grey(reflectance):
    return {
        "type": "twosided",
        "bsdf": {"type": "diffuse", "reflectance": {"type": "uniform", "value": reflectance}},
    }


GOLD = {"type": "conductor", "material": "Au"}
GREY = {"type": "diffuse", "reflectance": {"type": "uniform", "value": 0.5}}


def sky(radiance=1.0):
    return {"type": "constant", "radiance": {"type": "uniform", "value": radiance}}


def sun(irradiance=1.0):
    return {
        "type": "directional",
        "direction": [0.3, 0.4, -1.0],
        "irradiance": {"type": "uniform", "value": irradiance},
    }


def lamp(position, intensity):
    return {
        "type": "point",
        "position": position,
        "intensity": {"type": "uniform", "value": intensity},
    }


def sphere(center, radius, **options):
    return {"type": "sphere", "center": center, "radius": radius, **options}


def glowing_sphere(center, radius, radiance):
    emitter = {"type": "area", "radiance": {"type": "uniform", "value": radiance}}
    return sphere(center, radius, emitter=emitter)


def floor(height, size):
    to_world = mi.ScalarTransform4f().translate([0, 0, height]).scale([size, size, 1])
    return {"type": "rectangle", "to_world": to_world, "bsdf": grey(0.5)}


def ball(medium, boundary=None, **film_options):
    """A unit ball of fog that fills the picture, seen from outside.

    A stone lies in it, the floor cuts through its boundary, and it is lit by every kind of light:
    a glowing sphere inside, a lamp, a sun and a sky outside.
    """
    return {
        "type": "scene",
        "sensor": camera([0, -3, 0.4], [0, 0, 0], 25, **film_options),
        "fog": sphere([0, 0, 0], 1, bsdf=boundary or {"type": "null"}, interior=medium),
        "stone": sphere([0.25, 0.1, -0.25], 0.3, bsdf=grey(0.7)),
        "floor": floor(-0.55, 3),
        "glow": glowing_sphere([-0.4, 0.2, 0.3], 0.2, 1.5),
        "lamp": lamp([1.5, -1.5, 1.5], 3),
        "sun": sun(),
        "sky": sky(),
    }


def valley(medium, **film_options):
    """Fog over a floor, seen from inside it: no boundary but the medium's own."""
    return {
        "type": "scene",
        "sensor": camera([0, -3, 0.6], [0, 0, 0.9], 60, medium=medium, **film_options),
        "stone": sphere([0.5, 0, 0.4], 0.4, bsdf=grey(0.7)),
        "floor": floor(0, 20),
        "glow": glowing_sphere([-0.8, 0.5, 1.2], 0.3, 1.5),
        "lamp": lamp([1.5, 2.5, 3.5], 5),
        "sun": sun(),
        "sky": sky(),
    }


VALLEY_BOX = {"bbox_min": [-6, -6, -0.5], "bbox_max": [6, 6, 5]}
EXPONENTIAL = {"profile": "exponential", "scale_height": 1.5, "base_height": 0.25}


def constant_fog(**options):
    return {"type": "analytic", "sigma_t": 1.2, "albedo": 0.8, "phase": PHASE} | options


def homogeneous_fog():
    """`constant_fog`, as stock has it."""
    return {"type": "homogeneous", "sigma_t": 1.2, "albedo": 0.8, "phase": PHASE}


def exponential_fog(**options):
    return (
        {"type": "analytic", "sigma_t": 0.5, "albedo": 0.8, "phase": PHASE}
        | EXPONENTIAL
        | VALLEY_BOX
        | options
    )


def tracked_exponential_fog():
    """`exponential_fog`, as a volume of ours in the stock medium."""
    volume = {"type": "analyticvolume", "scale": 0.5} | EXPONENTIAL | VALLEY_BOX
    # Without a boundary, a medium with "spectral" extinction loses the rays that leave in stock.
    stock = {"type": "heterogeneous", "sigma_t": volume, "has_spectral_extinction": False}
    return stock | {"albedo": 0.8, "phase": PHASE}


TILT = 30  # degrees, of the axis of the linear fog
LOW, HIGH = 0.2, 1.8  # its densities 1 below and 1 above the centre of the ball


def linear_fog(**options):
    up = [np.sin(np.radians(TILT)), 0, np.cos(np.radians(TILT))]
    density = {"profile": "linear", "density": (LOW + HIGH) / 2, "gradient": (HIGH - LOW) / 2}
    fog = {"type": "analytic", "up": up, "sigma_t": 1.5, "albedo": 0.8, "phase": PHASE}
    # The box is no tighter than the grid's: the ball is the boundary.
    return fog | density | {"bbox_min": [-1.1] * 3, "bbox_max": [1.1] * 3} | options


def linear_grid_fog():
    """`linear_fog` in a grid two voxels high: between the voxel centres, which lie 1 below and 1
    above the centre of the ball, trilinear interpolation is linear."""
    grid = mi.VolumeGrid(np.array([LOW, HIGH], dtype=np.float32).reshape(2, 1, 1))
    to_world = mi.ScalarTransform4f().rotate([0, 1, 0], TILT).scale(4).translate(-0.5)
    volume = {"type": "gridvolume", "grid": grid, "raw": True, "to_world": to_world}
    stock = {"type": "heterogeneous", "sigma_t": volume, "scale": 1.5, "albedo": 0.8}
    return stock | {"phase": PHASE}


def medium_prefix(params):
    """What the names of the parameters of a scene's fog begin with."""
    keys = list(params.keys())
    return next(key for key in keys if key.endswith("base_height")).removesuffix("base_height")
