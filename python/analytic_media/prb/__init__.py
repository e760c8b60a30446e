"""The differentiable integrator `prbanalyticvolpath`, for the JIT variants of Mitsuba."""

import importlib
import sys

NAME = "prbanalyticvolpath"


def register(_old=None, variant=None) -> None:
    """Makes the integrator known to the variant of Mitsuba that is set."""
    if variant is not None and "_ad_" in variant:
        import mitsuba as mi

        mi.register_integrator(NAME, _create)


def _create(props):
    """The integrator, from the classes of the variant: those of Mitsuba are made anew for each."""
    import mitsuba as mi

    if "polarized" in mi.variant():
        raise RuntimeError(
            f"{NAME} carries no polarisation, and the variant is {mi.variant()}: "
            f"use {mi.variant().removesuffix('_polarized')}"
        )
    module = sys.modules.get(f"{__name__}.integrator")
    if module is None:
        module = importlib.import_module(".integrator", __name__)
    elif mi.variant() != module.VARIANT:
        importlib.reload(module)
    return module.PrbAnalyticVolpath(props)
