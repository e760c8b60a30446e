"""What a scene says about its media: profiles, coefficients, boxes; and the same on a grid."""

from dataclasses import dataclass
from functools import reduce

import mitsuba as mi
import numpy as np

from .. import coefficients
from ..profiles import Profile
from ..voxelize import Grid, voxelize


def as_it_is(coefficient):
    return coefficient


# What a scene may state beside the albedo, and the extinction that it makes; and beside sigma_s,
# and the absorption. The list of the plugin is in mitsuba_plugin/src/coefficients.h.
EXTINCTION = {
    ("sigma_t",): as_it_is,
    ("mean_free_path",): coefficients.sigma_t_from_mean_free_path,
    ("transmittance", "at_distance"): coefficients.sigma_t_from_transmittance,
    ("opacity", "at_distance"): coefficients.sigma_t_from_opacity,
    ("visibility", "contrast"): coefficients.sigma_t_from_visibility,
    ("mass_density", "mass_attenuation"): coefficients.sigma_t_from_mass,
    ("number_density", "cross_section"): coefficients.sigma_t_from_number,
}
ABSORPTION = {
    ("sigma_a",): as_it_is,
    ("extinction_index",): lambda index: coefficients.sigma_a_from_extinction_index(
        index, wavelengths()
    ),
}
DEFAULTS = {"sigma_t": 1.0, "albedo": 0.75, "contrast": 0.05}
COEFFICIENTS = {name for names in (*EXTINCTION, *ABSORPTION) for name in names}
COEFFICIENTS |= {"sigma_s", "albedo", "scale"}
BOUNDS = ("bbox_min", "bbox_max", "bsphere_center", "bsphere_radius", "max_density")


def profile_classes():
    """The Python class of each profile, by its name in scenes."""
    return {cls._kind.name: cls for cls in Profile.__subclasses__()}


def own_parameters():
    """The parameters that `analytic` and `overlap` have and `heterogeneous` has not, or that
    mean something else there."""
    of_profiles = {p.name for cls in Profile.__subclasses__() for p in cls._kind.parameters}
    return {"profile", "has_spectral_extinction", *BOUNDS, *COEFFICIENTS, *of_profiles}


class SceneError(ValueError):
    """The scene cannot be compared or voxelised; the message says why."""


@dataclass
class Component:
    """A profile, and its coefficients at density 1.

    `sigma_t` is a float (grey, 1/length) or an array of three (rgb), and so is `albedo`, which is
    None where the node's own property is to be kept as it is. `phase` is the number of the phase
    function's node, None if it is isotropic.
    """

    profile: object
    sigma_t: object
    albedo: object
    phase: int | None


@dataclass
class SceneMedium:
    """An `analytic` medium, which has one component, or an `overlap` of several.

    `bbox` is None if the medium fills all of space, and the box of `bsphere`, (centre, radius), if
    it ends at a sphere; `max_density` is the density that stock
    integrators see at most, or None.
    """

    name: str
    components: list
    bbox: tuple | None
    bsphere: tuple | None
    max_density: float | None

    @property
    def is_grey(self):
        return all(np.ndim(c.sigma_t) == 0 for c in self.components)

    @property
    def is_overlap(self):
        return len(self.components) > 1

    @property
    def sigma_t(self):
        """Of all components at density 1, per channel."""
        return sum(np.asarray(c.sigma_t, dtype=float) for c in self.components)

    @property
    def sigma_max(self):
        return float(np.max(self.sigma_t))

    @property
    def strongest_channel(self):
        return int(np.argmax(self.sigma_t))

    def optical_depth(self, origins, directions, lengths):
        """Of segments, in the strongest channel."""
        return sum(
            at(c.sigma_t, self.strongest_channel) * c.profile.column(origins, directions, lengths)
            for c in self.components
        )


@dataclass
class MediumGrids:
    """A medium on a grid, as `heterogeneous` takes it.

    `extinction` is relative to the medium's `sigma_max`. `albedo` is None where it does not vary.
    `phases` are those of an overlap, each once; `blends` are, for all but the last of them, the
    share of the scattering that belongs to the phase functions after it.
    """

    extinction: Grid
    albedo: Grid | None
    phases: list
    blends: list


def at(colour, channel):
    return float(np.broadcast_to(colour, (3,))[channel])


def read_medium(state, number):
    """The SceneMedium that an `analytic` or `overlap` node describes."""
    node = state.nodes[number]
    if node.props.plugin_name() == "overlap":
        nested = children(state, node, mi.ObjectType.Medium)
        components = [read_component(state, state.nodes[child]) for child in nested]
        for component in components:
            if component.albedo is None:
                raise SceneError(f"medium '{node.props.id()}': albedo must be a number or rgb")
    else:
        components = [read_component(state, node)]
        if "sigma_s" not in node.props:
            components[0].albedo = None
    return SceneMedium(node.props.id(), components, *read_bounds(node.props))


def children(state, node, kind):
    """Numbers of the nodes of a kind that are nested in `node`."""
    properties = [node.props[key] for key in node.props.keys()]  # noqa: SIM118 (not a mapping)
    references = [p for p in properties if isinstance(p, mi.Properties.ResolvedReference)]
    return [r.index() for r in references if state.nodes[r.index()].type == kind]


def read_component(state, node):
    props = node.props
    kind = props.get("profile", "constant")
    if kind not in profile_classes():
        raise SceneError(f"medium '{props.id()}': profile '{kind}' cannot be voxelised")
    cls = profile_classes()[kind]
    given = {p.name: props[p.name] for p in cls._kind.parameters if p.name in props}
    given = {name: vector(value) for name, value in given.items()}
    [phase] = children(state, node, mi.ObjectType.PhaseFunction) or [None]
    if phase is not None and state.nodes[phase].props.plugin_name() == "isotropic":
        phase = None
    return Component(cls(**given), *read_coefficients(props), phase)


def vector(value):
    return float(value) if np.ndim(value) == 0 else tuple(float(c) for c in value)


def read_bounds(props):
    """(box, sphere, max_density), each None if the medium has none."""
    name = props.id()
    max_density = float(props["max_density"]) if "max_density" in props else None
    for pair in (("bbox_min", "bbox_max"), ("bsphere_center", "bsphere_radius")):
        if (pair[0] in props) != (pair[1] in props):
            raise SceneError(f"medium '{name}': {pair[0]} and {pair[1]} go together")
    if "bbox_min" in props:
        return (vector(props["bbox_min"]), vector(props["bbox_max"])), None, max_density
    if "bsphere_radius" in props:
        centre, radius = np.array(vector(props["bsphere_center"])), float(props["bsphere_radius"])
        box = tuple(centre - radius), tuple(centre + radius)
        # Below its datum a planet's density goes beyond all bounds; stock integrators see 1.
        return box, (tuple(centre), radius), max_density or 1.0
    return None, None, max_density


def read_coefficients(props):
    """(sigma_t, albedo) at density 1, scale included; albedo None: not a number or rgb."""
    scale = props.get("scale", 1.0)
    if "sigma_s" in props:
        sigma_s, sigma_a = read_colour(props, "sigma_s"), read_stated(props, ABSORPTION)
        sigma_t = coefficients.sigma_t_from_parts(sigma_a, sigma_s)
        return simplify(sigma_t * scale), simplify(coefficients.albedo_from_parts(sigma_a, sigma_s))
    try:
        albedo = simplify(read_colour(props, "albedo"))
    except SceneError:
        albedo = None
    return simplify(read_stated(props, EXTINCTION) * scale), albedo


def read_stated(props, parametrisations):
    """What the parametrisation that the scene uses makes of its parameters."""
    given = [names for names in parametrisations if names[0] in props]
    names = given[0] if given else next(iter(parametrisations))
    return parametrisations[names](*(read_colour(props, name) for name in names))


def wavelengths():
    """Those that the channels of the variant stand for, in nm."""
    if mi.is_rgb:
        return np.array(coefficients.RGB_WAVELENGTHS)
    if mi.is_monochromatic:
        return np.array(coefficients.RGB_WAVELENGTHS[1])
    raise SceneError(
        f"an extinction_index has a voxel twin in rgb and mono variants only, not in {mi.variant()}"
    )


def read_colour(props, key):
    """A float, rgb or spectrum property as an array of one or three numbers.

    Three are red, green and blue in every variant: grids hold no more, and spectral variants of
    `gridvolume` make smooth spectra of them again.
    """
    if key not in props:
        if key not in DEFAULTS:
            raise SceneError(f"medium '{props.id()}': {key} is missing")
        return np.array(DEFAULTS[key])
    kind = props.type(key)
    if kind in (mi.Properties.Type.Float, mi.Properties.Type.Integer):
        return np.array(float(props[key]))
    if kind == mi.Properties.Type.Color:
        return np.array([float(c) for c in props[key]])
    if kind == mi.Properties.Type.Spectrum:
        return rgb_of_spectrum(props[key], bounded=key == "albedo")
    raise SceneError(
        f"medium '{props.id()}': {key} must be a number, an rgb colour or a spectrum of wavelengths"
    )


def rgb_of_spectrum(spectrum, bounded):
    """The colour that Mitsuba gives a spectrum in rgb variants: a uniform one has one number."""
    if spectrum.is_uniform():
        return np.array(spectrum.values[0])
    colour = mi.spectrum_list_to_srgb(
        spectrum.wavelengths, spectrum.values, bounded=bounded, d65=True
    )
    return np.array([float(c) for c in colour])


def simplify(values):
    """Three equal channels are one grey number."""
    values = np.asarray(values, dtype=float)
    if values.ndim == 0 or np.all(values == values[0]):
        return float(values.flat[0])
    return values


def grids(medium, bbox, resolution):
    """The medium on `resolution`³ voxels of `bbox`."""
    densities = [clamped(voxelize(c.profile, bbox, resolution), medium) for c in medium.components]
    if not medium.is_overlap:
        [density], [component] = densities, medium.components
        colour = component.sigma_t if medium.is_grey else component.sigma_t / medium.sigma_max
        extinction = density if medium.is_grey else density.times(colour)
        return MediumGrids(extinction, None, [component.phase], [])

    def total(weights):
        parts = zip(densities, weights, strict=True)
        return reduce(np.add, (d.times(np.atleast_1d(w)).data for d, w in parts))

    sigma_t = [np.asarray(c.sigma_t) / medium.sigma_max for c in medium.components]
    sigma_s = [s * c.albedo for s, c in zip(sigma_t, medium.components, strict=True)]
    extinction, scattering = total(sigma_t), total(sigma_s)
    albedo = ratio(scattering, extinction)

    amounts = {}  # of what scatters alike
    for c, d, s in zip(medium.components, densities, sigma_s, strict=True):
        if np.any(s > 0):
            amounts[c.phase] = amounts.get(c.phase, 0.0) + d.data * np.float32(np.mean(s))
    blends, after = [], 0.0
    for amount in reversed(amounts.values()):
        blends.append(ratio(after, after + amount))
        after = after + amount
    return MediumGrids(
        Grid(extinction, densities[0].bbox),
        Grid(albedo, densities[0].bbox),
        list(amounts) or [None],
        [Grid(blend, densities[0].bbox) for blend in reversed(blends[1:])],
    )


def clamped(grid, medium):
    if medium.max_density is None:
        return grid
    return Grid(np.minimum(grid.data, np.float32(medium.max_density)), grid.bbox)


def ratio(part, whole):
    """part/whole, and 0 where there is nothing."""
    return np.divide(part, whole, where=whole > 0, out=np.zeros_like(whole))
