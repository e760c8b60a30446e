"""`analytic-media doctor`: what is installed, which variants work, and why the others do not."""

import ctypes.util
import os
import platform
import subprocess
import sys
from pathlib import Path

from .compare.environment import cpu_info, package_version, processor

PROBE_TIMEOUT = 120  # seconds for one variant, a first kernel compilation included
PLUGINS = ("analytic", "analyticvolume", "analyticvolpath")
CPU_FLAGS = ("avx2", "fma", "f16c", "bmi2")  # what the Mitsuba wheel and our plugin are built for

# Renders 4x4 pixels of a foggy sphere in a process of its own, since a variant that does not work
# may take its process down.
PROBE = """
import sys
import numpy as np
import mitsuba as mi
import analytic_media
mi.set_variant(sys.argv[1])
scene = mi.load_dict({
    "type": "scene",
    "integrator": {"type": "analyticvolpath", "max_depth": 4},
    "light": {"type": "constant"},
    "ball": {"type": "sphere", "bsdf": {"type": "null"}, "interior": {
        "type": "analytic", "profile": "exponential", "scale_height": 1.0, "sigma_t": 1.0}},
    "sensor": {"type": "perspective",
               "to_world": mi.ScalarTransform4f().look_at([0, -4, 0], [0, 0, 0], [0, 0, 1]),
               "film": {"type": "hdrfilm", "width": 4, "height": 4},
               "sampler": {"type": "independent", "sample_count": 4}},
})
image = np.array(mi.render(scene, seed=1))
assert np.all(np.isfinite(image)) and image.mean() > 0, f"the image is wrong: {image}"
"""


def doctor(write=print):
    """Report to `write`, line by line; True if at least one variant renders."""
    write("Packages")
    for name in ("analytic-media", "mitsuba", "drjit", "numpy", "cffi"):
        write(f"  {name:<16}{package_version(name) or 'not installed'}")
    write(f"  {'Python':<16}{platform.python_version()}")

    write("Machine")
    write(f"  {'processor':<16}{processor()}")
    write(f"  {'instructions':<16}{instructions()}")
    write(f"  {'LLVM':<16}{llvm_library() or MISSING_LLVM}")
    write(f"  {'NVIDIA driver':<16}{ctypes.util.find_library('cuda') or 'not found'}")

    write("Files")
    folder = Path(__file__).parent
    libraries = sorted((folder / "lib").glob("libanalytic_media.*"))
    write(f"  {'Rust library':<16}{libraries[0] if libraries else 'not found'}")
    for name in PLUGINS:
        found = sorted((folder / "plugins").glob(f"{name}.*"))
        write(f"  {name:<16}{found[0] if found else 'not found: run make build'}")

    if package_version("mitsuba") is None:
        write("Mitsuba is not installed: the NumPy functions work alone, the plugins do not.")
        return False
    import mitsuba as mi

    write("Variants")
    working = 0
    for variant in mi.variants():
        problem = probe(variant)
        working += problem is None
        write(f"  {variant:<30}{'works' if problem is None else problem}")
    write(f"{working} of {len(mi.variants())} variants work.")
    return working > 0


MISSING_LLVM = "not found: install libllvm19, or set DRJIT_LIBLLVM_PATH; llvm_* variants need it"


def instructions():
    """Which of the needed instruction sets this processor has."""
    flags = cpu_info().get("flags", "").split()
    if not flags:
        return "unknown (no /proc/cpuinfo)"
    missing = [flag for flag in CPU_FLAGS if flag not in flags]
    if missing:
        return f"{', '.join(missing)} missing: Mitsuba's wheel needs {', '.join(CPU_FLAGS)}"
    return ", ".join(CPU_FLAGS)


def llvm_library():
    """The LLVM that Dr.Jit finds: the path in the environment, or the system's."""
    chosen = os.environ.get("DRJIT_LIBLLVM_PATH")
    if chosen:
        return chosen if Path(chosen).exists() else f"DRJIT_LIBLLVM_PATH={chosen} does not exist"
    names = ("LLVM", *(f"LLVM-{major}" for major in range(25, 15, -1)))
    return next(filter(None, map(ctypes.util.find_library, names)), None)


def probe(variant):
    """None if `variant` renders with our plugins, else the reason in one line."""
    try:
        done = subprocess.run(
            [sys.executable, "-c", PROBE, variant],
            capture_output=True,
            text=True,
            timeout=PROBE_TIMEOUT,
        )
    except subprocess.TimeoutExpired:
        return f"no picture after {PROBE_TIMEOUT} s"
    if done.returncode == 0:
        return None
    return reason(variant, done.returncode, done.stderr)


def reason(variant, code, stderr):
    """The most telling line of a failed probe."""
    if variant.startswith("cuda") and ctypes.util.find_library("cuda") is None:
        return "no NVIDIA driver (libcuda) on this machine"
    if variant.startswith("llvm") and "LLVM" in stderr and llvm_library() is None:
        return MISSING_LLVM
    lines = [line.strip() for line in stderr.splitlines() if line.strip()]
    if code < 0:
        return f"the process ended by signal {-code}" + (f": {lines[-1]}" if lines else "")
    return lines[-1] if lines else f"the process ended with code {code}"
