"""Compile time of the render kernel: analyticvolpath on our fog against stock on a grid.

Dr.Jit translates a scene and its integrator into one kernel and has LLVM compile it, before the
first sample. Each measurement is a fresh process with an empty kernel cache; the methods take
turns, so that other load on the machine meets both. Prints the medians and their ratio.

    python benches/kernel_compile.py [--variant llvm_ad_rgb] [--rounds 3]
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile

METHODS = {
    "stock": "volpath, heterogeneous with gridvolume",
    "ours": "analyticvolpath, analytic exponential",
}
BOX = {"bbox_min": [-1, -1, -1], "bbox_max": [1, 1, 1]}


def fog(method):
    if method == "ours":
        return {"type": "analytic", "profile": "exponential", "scale_height": 0.5, **BOX}
    import mitsuba as mi
    import numpy as np

    grid = mi.VolumeGrid(np.ones((16, 16, 16), dtype=np.float32))
    to_world = mi.ScalarTransform4f().translate(-1).scale(2)
    volume = {"type": "gridvolume", "grid": grid, "to_world": to_world, "raw": True}
    return {"type": "heterogeneous", "sigma_t": volume, "has_spectral_extinction": False}


def measure(method, variant):
    """Milliseconds and operations of the largest kernel of a render."""
    import drjit as dr
    import mitsuba as mi

    import analytic_media  # noqa: F401  (registers the plugins)

    mi.set_variant(variant)
    look_at = mi.ScalarTransform4f().look_at([0, -4, 1], [0, 0, 0], [0, 0, 1])
    film = {"type": "hdrfilm", "width": 32, "height": 32, "rfilter": {"type": "box"}}
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "analyticvolpath" if method == "ours" else "volpath"},
            "sensor": {"type": "perspective", "to_world": look_at, "film": film},
            "fog": {"type": "cube", "bsdf": {"type": "null"}, "interior": fog(method)},
            "stone": {"type": "sphere", "radius": 0.4},
            "sun": {"type": "directional", "direction": [0.3, 0.4, -1]},
            "sky": {"type": "constant"},
        }
    )
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.eval(mi.render(scene, spp=1))
        kernels = [k for k in dr.kernel_history() if k["type"] == dr.KernelType.JIT]
    kernel = max(kernels, key=lambda k: k["operation_count"])
    if kernel["cache_hit"]:
        raise RuntimeError("the kernel cache is not empty")
    return {
        "milliseconds": kernel["codegen_time"] + kernel["backend_time"],
        "operations": kernel["operation_count"],
    }


def measure_apart(method, variant):
    """The same, in a process whose home, where Dr.Jit keeps its kernels, is empty."""
    with tempfile.TemporaryDirectory() as home:
        command = [sys.executable, __file__, "--measure", method, "--variant", variant]
        environment = os.environ | {"HOME": home}
        process = subprocess.run(
            command, env=environment, check=True, capture_output=True, text=True
        )
    return json.loads(process.stdout.splitlines()[-1])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--variant", default="llvm_ad_rgb", help="a JIT variant")
    parser.add_argument("--rounds", type=int, default=3, help="measurements of each method")
    parser.add_argument("--measure", choices=METHODS, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.measure:
        print(json.dumps(measure(arguments.measure, arguments.variant)))
        return

    results = {method: [] for method in METHODS}
    for _ in range(arguments.rounds):
        for method, measured in results.items():
            measured.append(measure_apart(method, arguments.variant))
    medians = {}
    for method, measured in results.items():
        times = sorted(m["milliseconds"] for m in measured)
        medians[method] = statistics.median(times)
        print(
            f"{METHODS[method]:40} {measured[0]['operations']:6} operations, "
            f"{medians[method]:7.0f} ms ({times[0]:.0f} to {times[-1]:.0f})"
        )
    print(f"ratio of compile times, ours over stock: {medians['ours'] / medians['stock']:.2f}")


if __name__ == "__main__":
    main()
