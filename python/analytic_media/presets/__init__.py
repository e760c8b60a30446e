"""Presets: atmospheres and fog as dictionaries for mi.load_dict, with a source for every number.

    mi.set_variant("llvm_ad_rgb")
    image = mi.render(mi.load_dict(am.earth(view="horizon", unit="km", sun_zenith=87)))

The variant has to be set before: colours are red, green and blue, or spectra.
"""

from .earth import earth, earth_medium
from .fog import height_fog
from .mars import mars, mars_medium
from .titan import titan, titan_medium

__all__ = [
    "earth",
    "earth_medium",
    "height_fog",
    "mars",
    "mars_medium",
    "titan",
    "titan_medium",
]
