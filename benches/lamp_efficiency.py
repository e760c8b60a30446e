"""Lamps in fog: efficiency of `distance_sampling` near them.

    python benches/lamp_efficiency.py [--variant NAME] [--rounds N] [--passes N]

A road at night, in a fog that thins out upwards: a street lamp (`point`), and the headlights of
a car that comes along (two `spot`). Efficiency is 1/(variance × process CPU time). Rounds are
interleaved; each renders some passes of every method, with seeds of its own, and takes the variance
over them pixel by pixel, relative to the square of the pixel's mean over all rounds of `mis`. It is
averaged over the pixels whose rays pass the lamp or a headlight at less than half a metre, and over
the whole picture. Prints the efficiency over that of `free_flight`: median and range of the rounds.
"""

import argparse
import time

import mitsuba as mi
import numpy as np

VARIANTS = ("scalar_rgb", "llvm_ad_rgb")
METHODS = ("free_flight", "equiangular", "mis")
EYE = np.array([0.0, -12.0, 1.6])
LAMP = np.array([2.5, 4.0, 4.0])
HEADLIGHTS = np.array([[-2.0, 12.0, 0.7], [-0.8, 12.0, 0.7]])
NEAR = 0.5  # m
WIDTH, HEIGHT, FIELD = 96, 60, 50
SAMPLES = {"scalar": 16, "llvm": 64}


def colour(red, green, blue):
    return {"type": "rgb", "value": [red, green, blue]}


def headlight(position):
    to_world = mi.ScalarTransform4f().look_at(position, position + [0.1, -10, -0.4], [0, 0, 1])
    intensity = colour(900, 950, 1000)
    return {"type": "spot", "to_world": to_world, "cutoff_angle": 30, "intensity": intensity}


def road(method):
    fog = {
        "type": "analytic",
        "profile": "exponential",
        "scale_height": 6.0,
        "sigma_t": 0.03,
        "albedo": 0.95,
        "bbox_min": [-100, -100, -1],
        "bbox_max": [100, 100, 40],
        "phase": {"type": "hg", "g": 0.6},
    }
    scene = {
        "type": "scene",
        "integrator": {"type": "analyticvolpath", "max_depth": 8, "distance_sampling": method},
        "sensor": {
            "type": "perspective",
            "fov": FIELD,
            "to_world": mi.ScalarTransform4f().look_at(EYE, EYE + [0, 1, 0], [0, 0, 1]),
            "film": {
                "type": "hdrfilm",
                "width": WIDTH,
                "height": HEIGHT,
                "pixel_format": "rgb",
                "rfilter": {"type": "box"},
            },
            "sampler": {"type": "independent"},
            "medium": fog,
        },
        "ground": {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f().scale([100, 100, 1]),
            "bsdf": {"type": "diffuse", "reflectance": colour(0.1, 0.1, 0.1)},
        },
        "lamp": {"type": "point", "position": LAMP, "intensity": colour(120, 80, 30)},
    }
    return scene | {f"light{i}": headlight(at) for i, at in enumerate(HEADLIGHTS)}


def regions():
    """The pixels whose central rays pass a light at less than NEAR, and all pixels."""
    slope = np.tan(np.radians(FIELD / 2))
    x = (2 * (np.arange(WIDTH) + 0.5) / WIDTH - 1) * slope
    z = (1 - 2 * (np.arange(HEIGHT) + 0.5) / HEIGHT) * slope * HEIGHT / WIDTH
    rays = np.stack(np.broadcast_arrays(x, 1.0, z[:, None]), axis=-1)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    passes = {"street lamp": [LAMP], "headlights": HEADLIGHTS}
    near = {
        name: np.min([np.linalg.norm(np.cross(rays, at - EYE), axis=-1) for at in lights], 0) < NEAR
        for name, lights in passes.items()
    }
    return near | {"picture": np.full((HEIGHT, WIDTH), True)}


def measure(variant, rounds, passes):
    import analytic_media  # noqa: F401, registers the plugins

    mi.set_variant(variant)
    scenes = {method: mi.load_dict(road(method)) for method in METHODS}
    samples = SAMPLES[variant.split("_")[0]]
    seconds = {method: [] for method in METHODS}
    images = {method: [] for method in METHODS}
    for turn in range(-1, rounds):
        for method, scene in scenes.items():
            seeds = (turn + 1) * passes + np.arange(passes)
            start = time.process_time()
            found = [np.array(mi.render(scene, spp=samples, seed=int(seed))) for seed in seeds]
            if turn >= 0:  # the first turn compiles the kernels
                seconds[method].append(time.process_time() - start)
                images[method].append(found)

    mean = np.mean(images["mis"], axis=(0, 1))
    noise = {m: (np.var(images[m], axis=1, ddof=1) / mean**2).mean(-1) for m in METHODS}
    for method in METHODS[1:]:
        for name, pixels in regions().items():
            cost = {m: noise[m][:, pixels].mean(1) * seconds[m] for m in (METHODS[0], method)}
            ratio = cost[METHODS[0]] / cost[method]
            print(
                f"{variant}: {method}, {name} ({pixels.sum()} pixels): {np.median(ratio):.3g} "
                f"times free_flight ({ratio.min():.3g} to {ratio.max():.3g})"
            )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--variant", action="append", help="may be repeated")
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--passes", type=int, default=8, help="of a method in a round")
    options = parser.parse_args()
    for one in options.variant or VARIANTS:
        measure(one, options.rounds, options.passes)
