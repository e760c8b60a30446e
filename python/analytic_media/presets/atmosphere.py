"""Atmospheres as media of a scene: layers around a planet, their coefficients, their colours.

Presets compute in metres and nanometres; `Unit` turns the results into scene units.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..coefficients import RGB_WAVELENGTHS

# What spectral variants of Mitsuba sample; a step of 5 nm leaves the interpolation of a Rayleigh
# coefficient 1e-3 of its value at 360 nm, less at longer wavelengths.
WAVELENGTHS = np.arange(360.0, 831.0, 5.0)  # nm

METRES = {"m": 1.0, "km": 1000.0}

Spectrum = Callable[[np.ndarray], np.ndarray]  # of wavelengths in nm


@dataclass(frozen=True)
class Unit:
    """The scene's unit of length."""

    metres: float

    @classmethod
    def of(cls, unit: str | float):
        """From "m", "km", or the number of metres that one unit has."""
        if isinstance(unit, str) and unit in METRES:
            return cls(METRES[unit])
        if isinstance(unit, str) or not 0 < unit < np.inf:
            raise ValueError(f'unit must be "m", "km" or a number of metres > 0, got {unit!r}')
        return cls(float(unit))

    def length(self, metres: float) -> float:
        return metres / self.metres


@dataclass(frozen=True)
class Layer:
    """A gas or a kind of particle in an atmosphere.

    * `lengths`: those parameters of the profile that are lengths, m
    * `thickness`: its vertical column at density 1, m
    * `optical_depth`: of the whole vertical column, dimensionless
    * `albedo`: of single scattering, 0 to 1
    """

    profile: str
    lengths: dict[str, float]
    thickness: float
    optical_depth: Spectrum
    albedo: Spectrum | float
    phase: dict


def exponential(scale_height: float, optical_depth: Spectrum, albedo, phase: dict) -> Layer:
    """A layer that thins out by a factor e every `scale_height` metres."""
    lengths = {"scale_height": scale_height}
    return Layer("spherical", lengths, scale_height, optical_depth, albedo, phase)


def tent(height: float, width: float, optical_depth: Spectrum, albedo, phase: dict) -> Layer:
    """A layer around the altitude `height`, gone `width` metres above and below it."""
    lengths = {"height": height, "width": width}
    return Layer("tent", lengths, width, optical_depth, albedo, phase)


@dataclass(frozen=True)
class Planet:
    """A planet and its atmosphere.

    * `radius`: of the ground, m
    * `top`: altitude at which the atmosphere ends, m
    * `layers`: name -> Layer
    * `ground`: albedo of the Lambertian ground
    * `sun_distance`: in astronomical units
    """

    radius: float
    top: float
    layers: dict[str, Layer]
    ground: Spectrum | float
    sun_distance: float

    def medium(self, unit: Unit, max_density: float | None = None) -> dict:
        """The `overlap` medium of all layers, centred below the origin of coordinates."""
        center = [0.0, 0.0, -unit.length(self.radius)]
        medium = {
            "type": "overlap",
            "bsphere_center": center,
            "bsphere_radius": unit.length(self.radius + self.top),
        }
        if max_density is not None:
            medium["max_density"] = max_density
        for name, layer in self.layers.items():
            medium[name] = {
                "type": "analytic",
                "profile": layer.profile,
                "center": center,
                "radius": unit.length(self.radius),
                **{key: unit.length(metres) for key, metres in layer.lengths.items()},
                "sigma_t": colour(layer.optical_depth, unit.metres / layer.thickness),
                "albedo": colour(layer.albedo),
                "phase": layer.phase,
            }
        return medium


def colour(value: Spectrum | float, scale: float = 1.0) -> dict | float:
    """What a scene says for `scale` times a spectrum: a number if it is grey, a tabulated
    spectrum in Mitsuba's spectral variants, else red, green and blue."""
    if not callable(value):
        return scale * value
    if is_spectral():
        values = scale * value(WAVELENGTHS)
        pairs = zip(WAVELENGTHS.tolist(), values.tolist(), strict=True)
        return {"type": "spectrum", "value": list(pairs)}
    return {"type": "rgb", "value": (scale * value(np.array(RGB_WAVELENGTHS))).tolist()}


def is_spectral() -> bool:
    """Whether the current variant of Mitsuba renders wavelengths."""
    import mitsuba as mi

    return "spectral" in (mi.variant() or "")


def tabulated(wavelengths, values) -> Spectrum:
    """Linear between the given wavelengths, in nm, constant beyond them."""
    return lambda wavelength: np.interp(wavelength, wavelengths, values)
