"""Tells Mitsuba where the plugins of this package are."""

from importlib.util import find_spec
from pathlib import Path


def register() -> bool:
    """Put the package's folder first in Mitsuba's file resolver.

    The resolver belongs to the process: a worker process has to import this package as well.
    Returns False, and does nothing, where Mitsuba is not installed or the plugins are not
    built. Raises ImportError if Mitsuba has another version than the plugins were built for.
    """
    if find_spec("mitsuba") is None:
        return False
    try:
        from ._build import MITSUBA_VERSION
    except ModuleNotFoundError:
        return False

    import mitsuba as mi

    if mi.__version__ != MITSUBA_VERSION:
        raise ImportError(
            f"analytic_media was built for Mitsuba {MITSUBA_VERSION} but {mi.__version__} is "
            f"installed: run 'pip install mitsuba=={MITSUBA_VERSION}' or rebuild analytic-media"
        )
    mi.file_resolver().prepend(str(Path(__file__).parent))

    from . import prb

    mi.detail.add_variant_callback(prb.register)
    prb.register(variant=mi.variant())
    return True
