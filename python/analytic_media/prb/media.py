"""Mitsuba's `analytic` and `overlap` media as formulas that Dr.Jit differentiates.

Values are those of the scene's objects at the time of the call, with their derivatives: nothing
is copied that an optimiser changes.
"""

import re

import drjit as dr
import mitsuba as mi

from .. import jit, profiles

# By their names in a scene.
PROFILES = {
    "constant": profiles.Constant,
    "linear": profiles.Linear,
    "exponential": profiles.Exponential,
    "spherical": profiles.Spherical,
    "radial_gaussian": profiles.RadialGaussian,
    "tent": profiles.Tent,
    "gaussian": profiles.Gaussian,
    "anisotropic_gaussian": profiles.AnisotropicGaussian,
}
# Stands for infinite columns, whose derivatives would not be numbers.
LARGE = 1e25


class _Children(mi.TraversalCallback):
    """The objects that an object is made of, by their names."""

    def __init__(self, parent):
        super().__init__()
        self.objects = {}
        parent.traverse(self)

    def put(self, name, value, flags, cpptype=None):
        if isinstance(value, mi.Object):
            self.objects[name] = value


class Component:
    """One kind of matter: its profile, and its coefficients where the density is 1."""

    def __init__(self, owner, text: str):
        """`text` is what the owner prints: it says what kind of a profile it is."""
        values = mi.traverse(owner)
        self._objects = _Children(owner).objects
        self._scale = values["scale"]
        self._factors = _factors(text)
        profile = PROFILES[re.search(r'profile = "(\w+)"', text)[1]]
        names = profile.__signature__.parameters
        self.profile = jit.Profile(profile, **{name: values[name] for name in names})

    def coefficients(self, it):
        """Extinction and scattering where the density is 1, 1/length, at an interaction."""
        stated = self._stated(it)
        if "albedo" in self._objects:
            return stated, stated * self._value("albedo", it)
        scattering = self._scale * self._value("sigma_s", it)
        return stated + scattering, scattering

    def _stated(self, it):
        """The extinction, or the absorption beside sigma_s."""
        for (first, second), formula in FORMULAS.items():
            if first in self._objects:
                inputs = [self._value(name, it) for name in (first, second) if name]
                return self._scale * formula(*inputs)
        raise NotImplementedError(
            "prbanalyticvolpath does not know the extinction of a medium stated by "
            f"{', '.join(n for n in self._objects if n != 'phase_function')}"
        )

    def _value(self, name, it):
        return mi.Spectrum(self._factors.get(name, 1.0) * self._objects[name].eval(it))


# How extinction may be stated: that of am.coefficients.
FORMULAS = {
    ("sigma_t", None): lambda sigma_t: sigma_t,
    ("sigma_a", None): lambda sigma_a: sigma_a,
    ("mean_free_path", None): lambda length: 1 / length,
    ("transmittance", "at_distance"): lambda passes, length: -dr.log(passes) / length,
    ("opacity", "at_distance"): lambda stays, length: -dr.log(1 - stays) / length,
    ("visibility", "contrast"): lambda length, contrast: -dr.log(contrast) / length,
    ("mass_density", "mass_attenuation"): lambda density, attenuation: density * attenuation,
    ("number_density", "cross_section"): lambda density, section: density * section,
}


def _factors(text: str) -> dict[str, float]:
    """What the volumes of quantities are multiplied by: the medium prints it, where it is not 1."""
    return {name: float(x) for name, x in re.findall(r"(\w+) = ([-+.e\d]+) \* ", text)}


class Medium:
    """A sum of components. `pointer` is what shapes and sensors call it."""

    def __init__(self, medium, texts):
        self.pointer = mi.MediumPtr(medium)
        parts = zip(_parts(medium), texts, strict=True)
        self.components = [Component(part, text) for part, text in parts]


def _parts(medium):
    """The objects that the components of a medium belong to."""
    if medium.class_name() == "AnalyticMedium":
        return [medium]
    if medium.class_name() == "OverlapMedium":
        return list(_Children(medium).objects.values())
    raise ValueError(
        "prbanalyticvolpath needs media of the types analytic and overlap, got "
        f"{medium.class_name()}: use prbvolpath for others"
    )


class Place:
    """Where flights of a medium are: coefficients of its components for the wavelengths of rays."""

    def __init__(self, medium: Medium, it):
        self.profiles = [component.profile for component in medium.components]
        pairs = [component.coefficients(it) for component in medium.components]
        self.sigma_t = [sigma_t for sigma_t, _ in pairs]
        self.sigma_s = [sigma_s for _, sigma_s in pairs]

    def columns(self, o, d, t):
        """The column of each component up to the distance `t`: finite."""
        columns = [profile.column(o, d, t) for profile in self.profiles]
        return [dr.select(column < LARGE, column, LARGE) for column in columns]

    def depth(self, columns):
        """Optical depth by channel."""
        parts = zip(self.sigma_t, columns, strict=True)
        return sum((sigma_t * column for sigma_t, column in parts), mi.Spectrum(0))

    def at(self, p):
        """Extinction and scattering at the point `p`, 1/length."""
        extinction, scattering = mi.Spectrum(0), mi.Spectrum(0)
        parts = zip(self.profiles, self.sigma_t, self.sigma_s, strict=True)
        for profile, sigma_t, sigma_s in parts:
            density = dr.minimum(profile.density(p), LARGE)
            extinction += sigma_t * density
            scattering += sigma_s * density
        return extinction, scattering


class Known:
    """What the media of the last scene print: to print reads values back, so it is done once."""

    def __init__(self):
        self._texts = {}

    def look_up(self, media):
        """The texts of the components of each medium."""
        # The media are kept with them, for others may get their addresses.
        self._texts = {
            id(medium): self._texts.get(id(medium)) or (medium, [str(p) for p in _parts(medium)])
            for medium in media
        }
        return [texts for _, texts in self._texts.values()]


def find(scene, sensors_medium, known: Known) -> list[Medium]:
    """The media of a scene, each once."""
    found = []
    for shape in scene.shapes():
        found += [shape.interior_medium(), shape.exterior_medium()]
    found += [sensor.get_medium() for sensor in scene.sensors()] + [sensors_medium]
    unique = list({id(medium): medium for medium in found if medium is not None}.values())
    return [Medium(*pair) for pair in zip(unique, known.look_up(unique), strict=True)]
