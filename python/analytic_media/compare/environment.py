"""Versions and machine, as a report should state them."""

import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

PACKAGES = ("analytic-media", "mitsuba", "drjit", "numpy")


def environment():
    return {
        "packages": {name: package_version(name) for name in PACKAGES},
        "python": platform.python_version(),
        "system": platform.platform(),
        "processor": processor(),
        "cores": len(os.sched_getaffinity(0))
        if hasattr(os, "sched_getaffinity")
        else os.cpu_count(),
    }


def package_version(name):
    """The installed version, or None."""
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def cpu_info():
    """The first processor's lines of /proc/cpuinfo as a dictionary; empty where there is none."""
    path = Path("/proc/cpuinfo")
    if not path.exists():
        return {}
    first = path.read_text().split("\n\n")[0]
    pairs = (line.split(":", 1) for line in first.splitlines() if ":" in line)
    return {key.strip(): value.strip() for key, value in pairs}


def processor():
    return cpu_info().get("model name") or platform.processor() or platform.machine()
