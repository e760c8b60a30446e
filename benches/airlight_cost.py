"""Single scattering without noise: how long path tracing takes for an error of 1 %.

    python benches/airlight_cost.py [--variant NAME] [--rounds N]

Renders the four scenes of air-light, without what throws shadows, by `airlight` with 16 samples per
pixel, which the edges of things need, and by path tracers with max_depth 2. Their variance, pixel
by pixel over some passes, says how many samples they need until the root of the mean square error
is 1 % of the mean of the image. Prints that CPU time over the time of one air-light image, as
median and range of the rounds, which are interleaved. Variances near a light have no bound, so the
medians are what to look at.
"""

import argparse
import time
from pathlib import Path

import mitsuba as mi
import numpy as np

import analytic_media  # noqa: F401 (the plugins)

SCENES = Path(__file__).parent.parent / "scenes"
NAMES = ("bench", "stage", "road", "lighthouse")
TRACERS = {
    "volpath": {"type": "volpath", "max_depth": 2},
    "analyticvolpath": {"type": "analyticvolpath", "max_depth": 2},
    "analyticvolpath, mis": {
        "type": "analyticvolpath",
        "max_depth": 2,
        "distance_sampling": "mis",
    },
}
SAMPLES, PASSES, ERROR = 16, 6, 0.01


def timed(scene, integrator, seed):
    start = time.process_time()
    image = np.array(mi.render(scene, integrator=integrator, spp=SAMPLES, seed=seed))[..., :3]
    return image, time.process_time() - start


def seconds_to_error(scene, integrator, seed):
    """CPU time until the error is ERROR times the mean of the image."""
    images, times = zip(*(timed(scene, integrator, seed + i) for i in range(PASSES)), strict=True)
    variance = np.var(images, axis=0, ddof=1).mean() / np.mean(images) ** 2
    return np.mean(times) * variance / ERROR**2


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--variant", default="llvm_ad_rgb")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    mi.set_variant(options.variant)

    print(f"| {options.variant} | {' | '.join(TRACERS)} |\n|{'---|' * (1 + len(TRACERS))}")
    for name in NAMES:
        file = str(SCENES / f"airlight_{name}.xml")
        scene = mi.load_file(file, sink="-1000", res_x="160", res_y="100")
        ours = mi.load_dict({"type": "airlight"})
        tracers = {title: mi.load_dict(tracer) for title, tracer in TRACERS.items()}
        for integrator in (ours, *tracers.values()):
            timed(scene, integrator, 0)  # compiles
        ratios = {title: [] for title in tracers}
        for round_ in range(options.rounds):
            one = timed(scene, ours, round_)[1]
            for title, tracer in tracers.items():
                ratios[title].append(seconds_to_error(scene, tracer, 100 * round_) / one)
        cells = (f"{np.median(r):.0f} ({min(r):.0f} to {max(r):.0f})" for r in ratios.values())
        print(f"| {name} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
