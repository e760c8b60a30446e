"""How the comparison is made: references, then rounds in which every method takes its turn.

1. References: a converged image of the exact medium, and of each grid, whose image differs.
   Two halves with independent seeds measure the reference's own noise, which is subtracted.
2. Per variant, a ladder of 2, 8, 32, ... samples per pixel warms up the kernels, finds the cost
   of a sample, and gives the left end of the convergence plot.
3. Rounds: each method in turn renders a new image for the same process CPU time. Interleaving
   spreads changes of the machine's speed over all methods. Images are accumulated.

A method's noise is measured against the reference of its own medium; its error against the
exact one contains the bias of the grid as well.
"""

import itertools
import tempfile
from dataclasses import dataclass, field

import numpy as np
from tqdm import tqdm

from .methods import EXACT, OURS, TRACKED, colour_mode, methods_for, reference_integrator
from .statistics import Reference, efficiency, errors, spread
from .worker import Job, Worker

LADDER = (2, 8, 32, 128)
WARM_UP_SAMPLES = 2
SEEDS_PER_WORKER = 100_000
ERROR_KINDS = ("mse", "mse_trimmed", "mse_exact", "mse_exact_trimmed")


@dataclass
class Options:
    """What to compare and how long. Times are process CPU seconds.

    `seconds` is spent by each method in each round, `reference_seconds` on each reference. With
    `spp` set, every method renders that many samples per pixel in a round instead. `strategies`
    adds the other ways of our integrator to treat colour.
    """

    scene: str
    variants: tuple = ("scalar_rgb", "llvm_ad_rgb")
    resolutions: tuple = (64, 256)
    rounds: int = 5
    seconds: float = 6.0
    reference_seconds: float = 45.0
    spp: int | None = None
    strategies: bool = False
    parameters: dict = field(default_factory=dict)


@dataclass
class Result:
    """Numbers of every variant and method, and the images behind them."""

    references: dict  # colour mode -> medium -> Reference
    variants: dict  # variant -> numbers, as in summary.json
    images: dict  # (variant, method key) -> accumulated image


def run(options, is_grey):
    """Carry out the whole protocol. `is_grey`: no medium has chromatic extinction."""
    references, numbers, images = {}, {}, {}
    with (
        tempfile.TemporaryDirectory(prefix="analytic-media-") as folder,
        Workers(options, folder) as workers,
    ):
        for mode in dict.fromkeys(map(colour_mode, options.variants)):
            variant = reference_variant(mode, options.variants)
            references[mode] = make_references(options, variant, is_grey, workers)
        for variant in options.variants:
            own = references[colour_mode(variant)]
            numbers[variant], pictures = run_variant(options, variant, own, workers)
            images.update({(variant, key): image for key, image in pictures.items()})
            workers.close(variant)
    return Result(references, numbers, images)


class Workers:
    """The render processes, started when first asked for."""

    def __init__(self, options, folder):
        self._options, self._folder = options, folder
        self._seeds = itertools.count(1, SEEDS_PER_WORKER)
        self._started = {}

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for variant in {variant for variant, _ in self._started}:
            self.close(variant)

    def get(self, variant, medium):
        key = (variant, medium)
        if key not in self._started:
            scene, parameters = self._options.scene, self._options.parameters
            job = Job(scene, variant, medium, self._folder, next(self._seeds), parameters)
            self._started[key] = Worker(job)
        return self._started[key]

    def close(self, variant):
        for key in [key for key in self._started if key[0] == variant]:
            self._started.pop(key).close()


def reference_variant(mode, variants):
    """The variant that renders the references of a colour mode: a vectorised one, if listed."""
    of_mode = [variant for variant in variants if colour_mode(variant) == mode]
    return next((v for v in of_mode if not v.startswith("scalar")), of_mode[0])


def make_references(options, variant, is_grey, workers):
    """A converged image for the exact medium and for each grid."""
    references = {}
    media = [EXACT, *options.resolutions]
    for medium in tqdm(media, desc=f"references, {variant}", unit="image"):
        name, no_roulette = reference_integrator(medium, is_grey, variant)
        renderer = Timed(workers.get(variant, medium), {"type": name}, roulette=not no_roulette)
        renderer.climb(options.reference_seconds / 20)
        spp = options.spp * options.rounds if options.spp else None
        first, second = (renderer.image(options.reference_seconds / 2, spp) for _ in range(2))
        if first.spp != second.spp:  # the halves need equal weights
            second = renderer.image(None, first.spp)
        details = {
            "integrator": name,
            "russian_roulette": not no_roulette,
            "variant": variant,
            "spp": first.spp + second.spp,
            "cpu_seconds": first.cpu_seconds + second.cpu_seconds,
        }
        references[medium] = Reference.from_halves(first.pixels, second.pixels, details)
    return references


@dataclass
class Image:
    pixels: np.ndarray
    spp: int
    cpu_seconds: float
    wall_seconds: float


class Timed:
    """One integrator of a worker, which learns what a sample costs."""

    def __init__(self, worker, plugin, roulette=True):
        self._worker, self._plugin, self._roulette = worker, plugin, roulette
        self._seconds_per_sample = None

    def image(self, seconds, spp=None):
        """Render `spp` samples per pixel, or as many as take about `seconds` of CPU time."""
        if spp is None:
            spp = max(1, round(seconds / self._seconds_per_sample))
        pixels, cpu, wall = self._worker.render(self._plugin, spp, self._roulette)
        self._seconds_per_sample = cpu / spp
        return Image(pixels, spp, cpu, wall)

    def climb(self, seconds):
        """Compile, then render ever more samples until a step costs `seconds`; the images."""
        for _ in range(2):
            self.image(None, WARM_UP_SAMPLES)
        steps = []
        for spp in LADDER:
            if steps and spp * self._seconds_per_sample > seconds:
                break
            steps.append(self.image(None, spp))
        return steps


def run_variant(options, variant, references, workers):
    """All rounds of one variant: (numbers for summary.json, accumulated images)."""
    methods = methods_for(variant, options.resolutions, options.strategies)
    exact = references[EXACT]
    timed = {m: Timed(workers.get(variant, m.medium), m.plugin) for m in methods}
    runs = {m: Run(references[m.converges_to], exact) for m in methods}

    steps = len(methods) * (options.rounds + 1)
    with tqdm(total=steps, desc=variant, unit="image") as progress:
        for method in methods:
            progress.set_postfix_str(f"warm-up: {method.key}")
            runs[method].ladder = [
                runs[method].record(image)
                for image in timed[method].climb((options.seconds or 1) / 2)
            ]
            progress.update()
        for number in range(options.rounds):
            for method in methods:
                progress.set_postfix_str(f"round {number + 1}: {method.key}")
                runs[method].add(timed[method].image(options.seconds, options.spp))
                progress.update()
    numbers = {
        "methods": {method.key: runs[method].numbers(method) for method in methods},
        "efficiency_ratios": {kind: efficiency_ratios(runs, kind) for kind in ERROR_KINDS},
    }
    return numbers, {method.key: runs[method].mean for method in methods}


class Run:
    """The rounds of one method: each image by itself, and all so far averaged."""

    def __init__(self, own, exact):
        self._own, self._exact = own, exact
        self.ladder, self.rounds, self.accumulated = [], [], []
        self.mean, self._samples, self._cpu = 0.0, 0, 0.0

    def record(self, image):
        return {
            "spp": image.spp,
            "cpu_seconds": image.cpu_seconds,
            "wall_seconds": image.wall_seconds,
            **errors(image.pixels, self._own, self._exact),
        }

    def add(self, image):
        self._samples += image.spp
        self._cpu += image.cpu_seconds
        self.mean = self.mean + (image.pixels - self.mean) * np.float32(image.spp / self._samples)
        self.rounds.append({**self.record(image), "mean": float(np.mean(image.pixels))})
        self.accumulated.append(
            {
                "spp": self._samples,
                "cpu_seconds": self._cpu,
                **errors(self.mean, self._own, self._exact),
            }
        )

    def numbers(self, method):
        return {
            "label": method.label,
            "integrator": method.integrator,
            "medium": method.medium,
            "strategy": method.strategy,
            "ladder": self.ladder,
            "rounds": self.rounds,
            "accumulated": self.accumulated,
            "efficiency": {
                kind: spread([efficiency(r, kind) for r in self.rounds]) for kind in ERROR_KINDS
            },
        }


def efficiency_ratios(runs, kind):
    """Ours over each other method, round by round; over the best grid method of the round, and
    over the best stock one that tracks our own medium."""

    def per_round(method):
        return np.array([efficiency(r, kind) for r in runs[method].rounds])

    ours = per_round(OURS)
    ratios = {m.key: spread(ours / per_round(m)) for m in runs if m != OURS}
    groups = {
        "best_grid": [m for m in runs if m.uses_grid],
        "best_tracking": [m for m in runs if m.medium == TRACKED],
    }
    for name, group in groups.items():
        if group:
            ratios[name] = spread(ours / np.fmax.reduce([per_round(m) for m in group]))
    return ratios
