"""Gradient descent on the parameters of a medium, and its picture: for both examples.

    unknowns = {"scale_height": Positive(start=4), "albedo": Colour(start=0.5)}

    def apply(params, scale_height, albedo):
        params["fog.scale_height"] = scale_height
        params["fog.albedo.value.value"] = albedo

    course = fit(scene, apply, target, unknowns, steps=200, spp=16, max_depth=8)
    plot(course, truth, "fit.png")

or all of it, with a photograph that is rendered, from the command line: `run`.

`apply` sets parameters of `mi.traverse(scene)` to what the unknowns say. Steps are those of Adam,
in variables that keep every unknown in its range.
"""

import argparse
import time
from dataclasses import dataclass, field

import drjit as dr
import matplotlib.pyplot as plt
import mitsuba as mi
import numpy as np

INTEGRATOR = {"type": "prbanalyticvolpath"}


@dataclass(frozen=True)
class Positive:
    """A number above 0: its logarithm is what takes steps."""

    start: float
    type = staticmethod(lambda: mi.Float)

    forward = staticmethod(dr.log)
    inverse = staticmethod(dr.exp)


@dataclass(frozen=True)
class Colour:
    """A colour whose channels are between 0 and 1: their log-odds are what takes steps."""

    start: float
    type = staticmethod(lambda: mi.Color3f)

    @staticmethod
    def forward(x):
        return dr.log(x / (1 - x))

    @staticmethod
    def inverse(x):
        return 1 / (1 + dr.exp(-x))


@dataclass
class Course:
    """What happened, step by step."""

    target: np.ndarray
    first: np.ndarray = None
    last: np.ndarray = None
    losses: list[float] = field(default_factory=list)
    values: dict[str, list[np.ndarray]] = field(default_factory=dict)
    compiled: list[int] = field(default_factory=list)  # kernels, in each step
    seconds: float = 0.0

    def found(self, name):
        """The mean of the last quarter of the steps, which noise moves less than one of them."""
        tail = self.values[name][-(len(self.losses) // 4) :]
        return np.mean(tail, axis=0)


def fit(scene, apply, target, unknowns, steps, spp, max_depth, rate=0.1):
    """Looks for the unknowns that make `scene` look like the image `target`.

    The loss is the mean of the squared difference, each pixel's relative to its brightness in
    `target`. The square is the product of two independent renders, so that noise, which depends on
    the unknowns, too, is no part of it. In the second half the rate of the steps falls to a tenth.
    """
    integrator = mi.load_dict(INTEGRATOR | {"max_depth": max_depth})
    params = mi.traverse(scene)
    optimizer = mi.ad.Adam(lr=rate, beta_2=0.98)  # forgets the steep slopes of the start
    for name, unknown in unknowns.items():
        optimizer[name] = unknown.forward(unknown.type()(unknown.start))

    target = mi.TensorXf(target)
    scale = 1 / (target + 0.1 * dr.mean(target, axis=None))
    course = Course(np.array(target), values={name: [] for name in unknowns})
    _set(apply, params, unknowns, lambda name: unknowns[name].start)
    course.first = np.array(mi.render(scene, spp=256))
    began = time.time()
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
        for step in range(steps):
            optimizer.set_learning_rate(rate * 0.1 ** max(0, 2 * step / steps - 1))
            values = {name: u.inverse(optimizer[name]) for name, u in unknowns.items()}
            apply(params, **values)
            params.update()
            images = [
                mi.render(scene, params, integrator=integrator, spp=spp // 2, seed=2 * step + i)
                for i in range(2)
            ]
            loss = dr.mean(dr.prod([(image - target) * scale for image in images]), axis=None)
            dr.backward(loss)
            optimizer.step()

            course.losses.append(loss.array[0])
            for name, value in values.items():
                course.values[name].append(np.array(value).squeeze())
            kernels = dr.kernel_history([dr.KernelType.JIT])
            course.compiled.append(sum(_is_new(kernel) for kernel in kernels))
    course.seconds = time.time() - began
    _set(apply, params, unknowns, lambda name: course.found(name).tolist())
    course.last = np.array(mi.render(scene, spp=256))
    return course


def _set(apply, params, unknowns, value_of):
    """Sets the parameters of the scene to known values."""
    apply(params, **{name: unknown.type()(value_of(name)) for name, unknown in unknowns.items()})
    params.update()


def _is_new(kernel):
    """Not met before in this process: compiled, or read from the cache on the disk."""
    return not kernel["cache_hit"] or kernel["cache_disk"]


def report(course, truth):
    """Prints what was found, and returns the largest relative error."""
    worst = 0.0
    for name, expected in truth.items():
        found = course.found(name)
        error = np.max(np.abs(found / expected - 1))
        worst = max(worst, error)
        start = np.round(course.values[name][0], 3)
        print(f"{name}: from {start} to {np.round(found, 4)}, true {expected}: {error:.1%} off")
    print(f"{len(course.losses)} steps in {course.seconds:.0f} s")
    first, later = course.compiled[0], course.compiled[1:]
    print(f"new kernels: {first} in the first step, {sum(later)} in all the others")
    return worst


def plot(course, truth, path):
    """Images before, after and wanted; below, the loss and the parameters by step."""
    brightest = np.percentile(course.target, 99)
    figure, axes = plt.subplots(2, 3, figsize=(12, 6.4), layout="constrained")
    images = {"start": course.first, "found": course.last, "photograph": course.target}
    for axis, (title, image) in zip(axes[0], images.items(), strict=True):
        axis.imshow(np.clip(0.9 * image / brightest, 0, 1) ** (1 / 2.2))
        axis.set_title(title)
        axis.axis("off")
    loss, relative, errors = axes[1]
    # Noise makes single values of an estimate of 0 negative.
    loss.semilogy(np.abs(np.convolve(course.losses, np.full(8, 1 / 8), "valid")))
    loss.set(title="loss, mean of 8 steps", xlabel="step")
    for name, expected in truth.items():
        values = np.array(course.values[name]).reshape(len(course.losses), -1) / expected
        for channel, column in enumerate(values.T):
            label = name if values.shape[1] == 1 else f"{name}, {['red', 'green', 'blue'][channel]}"
            relative.plot(column, label=label)
            errors.semilogy(np.abs(column - 1))
    relative.set(title="parameter over its true value", xlabel="step")
    relative.legend(fontsize="small")
    errors.axhline(0.02, color="grey", linestyle=":")
    errors.set(title="relative error (dotted: 2 %)", xlabel="step")
    figure.savefig(path, dpi=110)


def run(scene, apply, unknowns, truth, steps, spp, max_depth, photograph_spp):
    """Renders a photograph of the scene as it is, and looks for its unknowns.

    Ends the program with status 1 if one of them is more than 2 % off.
    """
    parser = argparse.ArgumentParser()
    parser.add_argument("--steps", type=int, default=steps)
    parser.add_argument("--spp", type=int, default=spp, help="paths per pixel in each step")
    parser.add_argument("--photograph-spp", type=int, default=photograph_spp)
    parser.add_argument("--output", default="fit.png")
    options = parser.parse_args()

    photograph = mi.render(scene, spp=options.photograph_spp, seed=12345)
    course = fit(scene, apply, photograph, unknowns, options.steps, options.spp, max_depth)
    worst = report(course, truth)
    plot(course, truth, options.output)
    raise SystemExit(int(worst > 0.02))
