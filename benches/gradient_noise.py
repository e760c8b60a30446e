"""Noise of the gradients of an image loss: `prbanalyticvolpath` against stock `prbvolpath`.

    python benches/gradient_noise.py [--scene NAME] [--variant NAME] [--rounds N] [--seconds S]

Three scenes, seen from outside of the medium, as stock requires. The adjoint image is fixed: the
derivative of the mean squared difference to a render with other parameters. Every method takes it
back to the parameters of the medium, with seeds of its own in each pass:

    ours                prbanalyticvolpath on the analytic medium
    stock, our medium   prbvolpath on the same medium, by delta tracking
    stock, grid         prbvolpath on a 64³ grid of the density, whose derivatives Dr.Jit takes to
                        the parameters through the formula that the grid is filled by

Rounds are interleaved, and of about equal process CPU time. Noise is the variance over the passes
of a round times the CPU time of a pass. Prints that of stock over ours: of the means over all
rounds, and the range of the rounds.
"""

import argparse
import time

import drjit as dr
import mitsuba as mi
import numpy as np

RESOLUTION = 64
SIZE = (48, 32)
DEPTH = 16
HG = {"type": "hg", "g": 0.6}
FOG = {"type": "analytic", "sigma_t": 1.0, "albedo": 0.9, "phase": HG}
LAYER = {"profile": "exponential", "scale_height": 0.5, "base_height": 0.0}
HAZE = {"profile": "exponential", "scale_height": 2.0, "base_height": 0.0}
PLANET = {"profile": "spherical", "center": [0, 0, 0], "radius": 4.0, "scale_height": 0.4}


def colour(*values):
    return {"type": "rgb", "value": list(values)}


def sun(direction):
    return {"type": "directional", "direction": direction, "irradiance": colour(3, 2.7, 2.2)}


def sky():
    return {"type": "constant", "radiance": colour(0.3, 0.4, 0.6)}


def camera(origin, target, fov):
    return {
        "type": "perspective",
        "to_world": mi.ScalarTransform4f().look_at(origin, target, [0, 0, 1]),
        "fov": fov,
        "film": {
            "type": "hdrfilm",
            "width": SIZE[0],
            "height": SIZE[1],
            "pixel_format": "rgb",
            "rfilter": {"type": "box"},
        },
        "sampler": {"type": "independent"},
    }


def landscape(medium):
    """A box of fog over a floor with a stone in it, in the sun, under a sky."""
    box = mi.ScalarTransform4f().translate([0, 0, 1.5]).scale([3, 3, 1.5])
    floor = mi.ScalarTransform4f().translate([0, 0, 0.01]).scale([2.99, 2.99, 1])
    grey = {"type": "diffuse", "reflectance": colour(0.3, 0.3, 0.25)}
    return {
        "type": "scene",
        "sensor": camera([0, -9, 2.2], [0, 0, 1.0], 38),
        "fog": {"type": "cube", "to_world": box, "bsdf": {"type": "null"}, "interior": medium},
        "floor": {"type": "rectangle", "to_world": floor, "bsdf": grey},
        "stone": {"type": "sphere", "center": [0.6, -0.3, 0.7], "radius": 0.5, "bsdf": grey},
        "sun": sun([0.5, 0.6, -0.6]),
        "sky": sky(),
    }


def planet(medium):
    """A planet with its atmosphere, from space, in the sun alone."""
    ground = {"type": "diffuse", "reflectance": colour(0.1, 0.15, 0.2)}
    return {
        "type": "scene",
        "sensor": camera([0, -22, 3], [0, 0, 0], 34),
        "air": {"type": "sphere", "radius": 7.0, "bsdf": {"type": "null"}, "interior": medium},
        "ground": {"type": "sphere", "radius": 4.0, "bsdf": ground},
        "sun": sun([1.0, 0.5, -0.2]),
    }


CUBE = {"bbox_min": [-3, -3, 0], "bbox_max": [3, 3, 3]}
SPHERE = {"bsphere_center": [0, 0, 0], "bsphere_radius": 7.0}

# The medium, what it stands in, the lowest and highest corner of the grid, and its parameters.
SCENES = {
    "height fog": (FOG | LAYER | CUBE, landscape, ([-3, -3, 0], [3, 3, 3]), ("",)),
    "overlap": (
        {"type": "overlap", "low": FOG | LAYER, "high": FOG | HAZE | {"sigma_t": 0.2}} | CUBE,
        landscape,
        ([-3, -3, 0], [3, 3, 3]),
        ("low.", "high."),
    ),
    "planet": (
        FOG | PLANET | SPHERE | {"sigma_t": 0.6, "phase": {"type": "rayleigh"}},
        planet,
        ([-7, -7, -7], [7, 7, 7]),
        ("",),
    ),
}
# The medium of the picture that the loss compares with differs by these factors.
OTHER = {"sigma_t": 1.3, "scale_height": 1.2, "albedo": 0.95}
PARAMETERS = tuple(OTHER)


def key(prefix, name):
    return prefix + (name if name == "scale_height" else f"{name}.value.value")


class Analytic:
    """The scene with our medium."""

    def __init__(self, name, integrator):
        medium, scene, _, parts = SCENES[name]
        self.scene = mi.load_dict(scene(medium))
        self.params = mi.traverse(self.scene)
        prefix = next(k for k in self.params.keys() if "interior_medium." in k)  # noqa: SIM118
        prefix = prefix[: prefix.index("interior_medium.")] + "interior_medium."
        self.keys = [key(prefix + part, p) for part in parts for p in PARAMETERS]
        self.names = [part + p for part in parts for p in PARAMETERS]
        self.integrator = mi.load_dict({"type": integrator, "max_depth": DEPTH})

    def render(self, factors, spp, seed):
        values = {k: type(self.params[k])(self.params[k]) for k in self.keys}
        for k, n in zip(self.keys, self.names, strict=True):
            self.params[k] = values[k] * factors.get(n.split(".")[-1], 1.0)
        self.params.update()
        integrator = mi.load_dict({"type": "analyticvolpath", "max_depth": DEPTH})
        image = mi.render(self.scene, integrator=integrator, spp=spp, seed=seed)
        dr.eval(image)
        for k in self.keys:
            self.params[k] = values[k]
        self.params.update()
        return image

    def gradient(self, adjoint, spp, seed):
        for k in self.keys:
            dr.enable_grad(self.params[k])
            dr.set_grad(self.params[k], 0)
        self.params.update()
        self.integrator.render_backward(self.scene, self.params, adjoint, seed=seed, spp=spp)
        return np.array([np.array(dr.grad(self.params[k])).sum() for k in self.keys])


class Grid:
    """The scene with a stock medium, whose grid is filled from the parameters."""

    def __init__(self, name):
        medium, scene, (lo, hi), parts = SCENES[name]
        self.parts = [medium[p.rstrip(".")] if p else medium for p in parts]
        self.names = [part + p for part in parts for p in PARAMETERS]
        lo, hi = np.array(lo), np.array(hi)
        to_world = mi.ScalarTransform4f().translate(lo).scale(hi - lo)

        def volume(value):
            # Grids that are alike would be merged.
            grid = mi.VolumeGrid(np.full((RESOLUTION,) * 3, value, dtype=np.float32))
            return {"type": "gridvolume", "grid": grid, "raw": True, "to_world": to_world}

        phase = self.parts[0]["phase"]
        stock = {"type": "heterogeneous", "sigma_t": volume(1), "albedo": volume(0.5)}
        stock["phase"] = phase
        self.scene = mi.load_dict(scene(stock))
        self.params = mi.traverse(self.scene)
        self.sigma_t, self.albedo = (
            next(k for k in self.params.keys() if k.endswith(f"{n}.data"))  # noqa: SIM118
            for n in ("sigma_t", "albedo")
        )
        self.integrator = mi.load_dict({"type": "prbvolpath", "max_depth": DEPTH})
        # Centres of voxels, x the fastest.
        i = dr.arange(mi.UInt32, RESOLUTION**3)
        index = [i % RESOLUTION, i // RESOLUTION % RESOLUTION, i // RESOLUTION**2]
        self.centres = mi.Point3f(
            *(
                a + (b - a) * (mi.Float(n) + 0.5) / RESOLUTION
                for a, b, n in zip(lo, hi, index, strict=True)
            )
        )

    def gradient(self, adjoint, spp, seed):
        import analytic_media as am

        values = [mi.Float(part[p]) for part in self.parts for p in PARAMETERS]
        dr.enable_grad(values)
        extinction, scattering = mi.Float(0), mi.Float(0)
        for part, (sigma_t, scale_height, albedo) in zip(
            self.parts, zip(*[iter(values)] * 3, strict=True), strict=True
        ):
            kind = {"exponential": am.Exponential, "spherical": am.Spherical}[part["profile"]]
            place = {name: part[name] for name in ("center", "radius") if name in part}
            profile = am.jit.Profile(kind, scale_height=scale_height, **place)
            # Below the ground, where no light gets, the density would grow without bound.
            density = sigma_t * dr.minimum(profile.density(self.centres), 1)
            extinction += density
            scattering += density * albedo
        shape = (RESOLUTION,) * 3 + (1,)
        self.params[self.sigma_t] = mi.TensorXf(extinction, shape)
        self.params[self.albedo] = mi.TensorXf(scattering / extinction, shape)
        self.params.update()
        image = mi.render(
            self.scene, self.params, integrator=self.integrator, spp=1, spp_grad=spp, seed=seed
        )
        dr.set_grad(image, adjoint)
        dr.enqueue(dr.ADMode.Backward, image)
        dr.traverse(dr.ADMode.Backward)
        return np.array([np.array(dr.grad(value)).item() for value in values])


METHODS = {
    "ours": lambda name: Analytic(name, "prbanalyticvolpath"),
    "stock, our medium": lambda name: Analytic(name, "prbvolpath"),
    "stock, grid": Grid,
}


def cost_of(one, adjoint, spp):
    """CPU time of a pass, once its kernels are compiled."""
    one.gradient(adjoint, spp, 0)
    start = time.process_time()
    one.gradient(adjoint, spp, 1)
    return time.process_time() - start


def measure(name, rounds, passes, seconds):
    """Noise by round and parameter, for each method."""
    methods = {method: make(name) for method, make in METHODS.items()}
    ours = methods["ours"]
    difference = ours.render({}, 512, 1) - ours.render(OTHER, 512, 2)
    adjoint = mi.TensorXf(2 / np.prod(difference.shape) * difference)
    spp, cost = {}, {}
    for method, one in methods.items():
        short, long = (cost_of(one, adjoint, samples) for samples in (8, 72))
        slope = max((long - short) / 64, 1e-4)
        spp[method] = int(np.clip(seconds / passes / slope, 8, 4096))
    noise = {method: [] for method in methods}
    means = {method: [] for method in methods}
    for turn in range(rounds):
        for method, one in methods.items():
            start = time.process_time()
            found = np.array(
                [one.gradient(adjoint, spp[method], 100 + turn * passes + i) for i in range(passes)]
            )
            cost[method] = (time.process_time() - start) / passes
            noise[method].append(found.var(0, ddof=1) * cost[method])
            means[method].append(found.mean(0))
    for method in methods:
        print(
            f"    {method}: {spp[method]} spp, {cost[method]:.2f} s a pass, gradient "
            f"{np.mean(means[method], 0)}"
        )
    return ours.names, {method: np.array(rows) for method, rows in noise.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", action="append", choices=SCENES, help="may be repeated")
    parser.add_argument("--variant", default="llvm_ad_rgb")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--passes", type=int, default=16, help="of a method in a round")
    parser.add_argument("--seconds", type=float, default=24.0, help="CPU time of a method's round")
    options = parser.parse_args()

    import analytic_media  # noqa: F401, registers the plugins

    mi.set_variant(options.variant)
    everything = {}
    for scene in options.scene or SCENES:
        print(scene)
        names, noise = measure(scene, options.rounds, options.passes, options.seconds)
        for method in list(METHODS)[1:]:
            ratios = noise[method] / noise["ours"]
            pooled = noise[method].mean(0) / noise["ours"].mean(0)
            everything.setdefault(method, []).extend(pooled)
            for name, ratio, column in zip(names, pooled, ratios.T, strict=True):
                print(f"  {method}, {name}: {ratio:.3g} ({column.min():.3g} to {column.max():.3g})")
            print(f"  {method}, geometric mean: {np.exp(np.log(pooled).mean()):.3g}", flush=True)
    for method, ratios in everything.items():
        print(f"all, {method}: {np.exp(np.mean(np.log(ratios))):.3g}")


if __name__ == "__main__":
    main()
