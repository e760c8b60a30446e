"""The differentiable integrator `prbanalyticvolpath`, for the JIT variants of Mitsuba."""

import importlib
import sys


def register(_old=None, variant=None) -> None:
    """Makes the integrator known to the variant of Mitsuba that is set."""
    if variant is None or "_ad_" not in variant:
        return
    name = f"{__name__}.integrator"
    loaded = sys.modules.get(name)
    if loaded:
        importlib.reload(loaded)
    else:
        importlib.import_module(name)
