"""Fog near the ground."""

import numpy as np

from ..coefficients import sigma_t_from_visibility

# Contrast that the eye still sees at the distance called visibility: Koschmieder's law with the
# threshold of the World Meteorological Organization's meteorological optical range (WMO-No. 8,
# Volume I, Chapter 9): 5 % of the light is left.
CONTRAST = 0.05


def height_fog(
    visibility: float,
    scale_height: float,
    base_height: float = 0.0,
    *,
    albedo: float = 1.0,
    asymmetry: float = 0.85,
    box: tuple | None = None,
) -> dict:
    """Fog that thins out with height: an `analytic` medium. Lengths are in scene units.

    * `visibility`: meteorological optical range at the base height, > 0
    * `scale_height`: altitude over which the fog thins out by a factor e, > 0
    * `albedo`, `asymmetry`: of single scattering. Droplets of water absorb next to nothing and have
      0.85 (Bohren and Clothiaux, "Fundamentals of Atmospheric Radiation", 2006, Section 5.2).
    * `box`: two opposite corners of the space that the fog fills; None: all of it
    """
    if not 0 < visibility < np.inf:
        raise ValueError(f"visibility must be finite and > 0, got {visibility!r}")
    fog = {
        "type": "analytic",
        "profile": "exponential",
        "scale_height": scale_height,
        "base_height": base_height,
        "sigma_t": float(sigma_t_from_visibility(visibility, CONTRAST)),
        "albedo": albedo,
        "phase": {"type": "hg", "g": asymmetry},
    }
    if box is not None:
        fog["bbox_min"], fog["bbox_max"] = (list(corner) for corner in box)
    return fog
