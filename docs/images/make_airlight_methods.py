"""The paper's comparison of air-light: its first reformulation, the combined one, Monte Carlo.

    python docs/images/make_airlight_methods.py

writes airlight_methods.png beside this file, a row for each scene: the first reformulation alone
and the combined one, both as they are printed and with 4 terms, in double precision; the
integrator airlight; and analyticvolpath with 64 samples per pixel, whose medium has shadows. Prints
how far the formulas are from airlight: on average over the mean, and the median of what is lit.

Formulas are evaluated through the middle of each pixel, as a difference from airlight's own.
"""

from pathlib import Path

import mitsuba as mi
import numpy as np
from make_airlight import NAMES, SCENES
from make_equal_time import srgb
from PIL import Image as Picture

import analytic_media as am
from analytic_media.compare.figures import exposure
from analytic_media.scattering import Cone, HenyeyGreenstein, Isotropic, Rayleigh

WIDTH, HEIGHT, TERMS = 240, 150, 4


def load(name, integrator, spp):
    size = {"res_x": str(WIDTH), "res_y": str(HEIGHT)}
    path = str(SCENES / f"{name}.xml")
    return mi.load_file(path, integrator=integrator, spp=str(spp), **size)


def medium(scene):
    """Coefficients, phase function and box of the only medium."""
    parameters = dict(mi.traverse(scene))
    found = {key.split(".", 1)[1]: value for key, value in parameters.items() if "." in key}
    sigma_t = np.broadcast_to(np.array(found["sigma_t.value.value"]).ravel(), 3)
    g = found.get("phase_function.g")
    phase = Rayleigh() if g is None else HenyeyGreenstein(float(g))
    box = [np.array(found[key]) for key in ("bbox_min", "bbox_max")]
    return sigma_t * float(found["albedo.value.value"]), sigma_t, phase, box


def lights(scene):
    """Position, intensity on the axis, and how it falls, of each."""
    for emitter in scene.emitters():
        values = mi.traverse(emitter)
        colour = np.array(values["intensity.value"]).ravel()
        if "position" in values:
            yield np.array(values["position"]).ravel(), colour, Isotropic()
            continue
        matrix = np.array(values["to_world"].matrix).reshape(4, 4)
        axis = matrix[:3, 2] / np.linalg.norm(matrix[:3, 2])
        angles = (np.radians(float(values[key])) for key in ("cutoff_angle", "beam_width"))
        yield matrix[:3, 3], colour, Cone(tuple(axis), *angles)


def rays(scene, box):
    """Rays through the pixels, and where they end: at a surface or where they leave the box."""
    sensor = scene.sensors()[0]
    rows = []
    for y in range(HEIGHT):
        for x in range(WIDTH):
            at = [(x + 0.5) / WIDTH, (y + 0.5) / HEIGHT]
            ray, _ = sensor.sample_ray(0, 0.5, at, [0.5, 0.5])
            rows.append([*ray.o, *ray.d, scene.ray_intersect(ray).t])
    o, d, t = np.split(np.array(rows), [3, 6], axis=1)
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    with np.errstate(divide="ignore"):
        leaves = np.max([(side - o) / d for side in box], axis=0).min(axis=1)
    return o, d, np.minimum(t[:, 0], leaves)


def air(scene, **method):
    """The light that the medium scatters, by NumPy: shape (HEIGHT, WIDTH, 3)."""
    sigma_s, sigma_t, phase, box = medium(scene)
    o, d, end = rays(scene, box)
    total = np.zeros((HEIGHT, WIDTH, 3))
    for position, colour, intensity in lights(scene):
        lamp = am.AirLight(position.tolist(), sigma_s, sigma_t, phase, intensity)
        total += (colour * lamp.radiance(o, d, 0, end, **method)).reshape(total.shape)
    return total


def main():
    mi.set_variant("scalar_rgb")
    rows = []
    for name in NAMES:
        scene = load(name, "airlight", 16)
        images = {"airlight": np.array(mi.render(scene))[..., :3]}
        exact = air(scene)
        for method in ("first", "combined"):
            images[method] = images["airlight"] + air(scene, method=method, terms=TERMS) - exact
            difference = np.nan_to_num(abs(images[method] - images["airlight"]))
            share = difference.mean() / images["airlight"].mean()
            lit = exact > 0
            median = np.median(difference[lit] / exact[lit])
            print(f"{name}, {method}: {share:.1g}, median {median:.1g}")
        images["Monte Carlo"] = np.array(mi.render(load(name, "analyticvolpath", 64)))[..., :3]
        scale = exposure(images["airlight"])
        order = ("first", "combined", "airlight", "Monte Carlo")
        rows.append(np.hstack([srgb(scale * np.nan_to_num(images[key])) for key in order]))
    pixels = np.round(255 * np.vstack(rows)).astype(np.uint8)
    Picture.fromarray(pixels).save(Path(__file__).with_name("airlight_methods.png"), optimize=True)


if __name__ == "__main__":
    main()
