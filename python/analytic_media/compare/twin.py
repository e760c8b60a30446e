"""The stock twin of a scene: every `analytic` medium becomes a voxel grid, all else stays.

The scene is edited between parsing and instantiation, as a list of nodes with properties, so
shapes, emitters, sensors and references come through untouched.
"""

from dataclasses import dataclass
from pathlib import Path

import mitsuba as mi
import numpy as np

import analytic_media as am

from ..voxelize import voxelize

PATH_TRACERS = ("analyticvolpath", "volpath", "volpathmis", "prbvolpath")
PATH_PARAMETERS = ("max_depth", "rr_depth", "hide_emitters")

# The parameters of `analytic` that say where the matter is; the rest means the same to
# `heterogeneous`.
PROFILE_PARAMETERS = {
    "constant": (),
    "linear": ("gradient", "density", "base_height", "up"),
    "exponential": ("scale_height", "base_height", "up"),
}
PROFILE_TYPES = {"constant": "Constant", "linear": "Linear", "exponential": "Exponential"}
COEFFICIENTS = ("sigma_t", "sigma_a", "sigma_s", "albedo", "scale")
BOUNDS = ("bbox_min", "bbox_max", "max_density")
OWN_PARAMETERS = {"profile", "has_spectral_extinction", *BOUNDS, *COEFFICIENTS}.union(
    *PROFILE_PARAMETERS.values()
)


class SceneError(ValueError):
    """The scene cannot be compared or voxelised; the message says why."""


@dataclass
class AnalyticMedium:
    """What an `analytic` node says: a profile, its coefficients at density 1, and its box.

    `sigma_t` is a float (grey, 1/length) or an array of three (rgb); `albedo` is None where the
    node's own property is to be kept as it is. `bbox` is None if the medium fills all of space.
    """

    name: str
    profile: object
    sigma_t: object
    albedo: object
    bbox: tuple | None

    @property
    def is_grey(self):
        return np.ndim(self.sigma_t) == 0

    @property
    def sigma_max(self):
        return float(np.max(self.sigma_t))


def parse(path, variant, parameters=None):
    """Parse the scene file for `variant`; `parameters` are its $names and their values."""
    path = Path(path)
    if not path.is_file():
        raise SceneError(f"scene {path} does not exist")
    mi.set_variant(variant)
    mi.file_resolver().prepend(str(path.parent.resolve()))
    config = mi.parser.ParserConfig(variant)
    given = {name: str(value) for name, value in (parameters or {}).items()}
    try:
        state = mi.parser.parse_file(config, str(path), **given)
        mi.parser.transform_upgrade(config, state)
    except RuntimeError as error:
        raise SceneError(f"scene {path}: {error}") from error
    return state


def instantiate(state, variant):
    """The Mitsuba scene of a parsed state, which stays as it is."""
    config = mi.parser.ParserConfig(variant)
    resolved = mi.parser.ParserState(state)
    mi.parser.transform_all(config, resolved)
    return mi.parser.instantiate(config, resolved)


def analytic_nodes(state):
    return [node for node in state.nodes if node.props.plugin_name() == "analytic"]


def integrator_node(state):
    """The scene's one integrator, which has to be a volumetric path tracer."""
    nodes = [node for node in state.nodes if node.type == mi.ObjectType.Integrator]
    if len(nodes) != 1 or nodes[0].props.plugin_name() not in PATH_TRACERS:
        found = [node.props.plugin_name() for node in nodes]
        raise SceneError(f"the scene needs one integrator of {PATH_TRACERS}, found {found}")
    return nodes[0]


def integrator_parameters(state):
    """max_depth, rr_depth and hide_emitters as far as the scene states them."""
    props = integrator_node(state).props
    return {key: props[key] for key in PATH_PARAMETERS if key in props}


def set_integrator(state, plugin, **changes):
    """Replace the scene's path tracer by `plugin` with the same depth parameters."""
    node = integrator_node(state)
    props = mi.Properties(plugin)
    props.set_id(node.props.id())
    for key, value in {**integrator_parameters(state), **changes}.items():
        props[key] = value
    node.props = props


def read_medium(node):
    """The AnalyticMedium that an `analytic` node describes."""
    props = node.props
    kind = props.get("profile", "constant")
    if kind not in PROFILE_TYPES:
        raise SceneError(f"medium '{props.id()}': profile '{kind}' cannot be voxelised")
    given = {key: props[key] for key in PROFILE_PARAMETERS[kind] if key in props}
    if "up" in given:
        given["up"] = tuple(float(c) for c in given["up"])
    sigma_t, albedo = read_coefficients(props)
    corners = [key in props for key in ("bbox_min", "bbox_max")]
    if corners[0] != corners[1]:
        raise SceneError(f"medium '{props.id()}': bbox_min and bbox_max go together")
    bbox = None
    if all(corners):
        bbox = tuple(tuple(float(c) for c in props[key]) for key in ("bbox_min", "bbox_max"))
    profile = getattr(am, PROFILE_TYPES[kind])(**given)
    return AnalyticMedium(props.id(), profile, sigma_t, albedo, bbox)


def read_coefficients(props):
    """(sigma_t, albedo) at density 1, scale included; albedo None: keep the node's property."""
    scale = props.get("scale", 1.0)
    if "sigma_s" in props or "sigma_a" in props:
        sigma_s, sigma_a = (read_colour(props, key, 0.0) for key in ("sigma_s", "sigma_a"))
        sigma_t = sigma_s + sigma_a
        albedo = np.divide(sigma_s, sigma_t, where=sigma_t > 0, out=np.zeros_like(sigma_t * 1.0))
        return simplify(sigma_t * scale), simplify(albedo)
    return simplify(read_colour(props, "sigma_t", 1.0) * scale), None


def read_colour(props, key, default):
    """A float or rgb property as an array of one or three numbers."""
    if key not in props:
        return np.array(default)
    kind = props.type(key)
    if kind in (mi.Properties.Type.Float, mi.Properties.Type.Integer):
        return np.array(float(props[key]))
    if kind == mi.Properties.Type.Color:
        if not mi.is_rgb and len(set(props[key])) > 1:
            raise SceneError(
                f"medium '{props.id()}': chromatic {key} has a voxel twin in rgb variants only, "
                f"not in {mi.variant()}"
            )
        return np.array([float(c) for c in props[key]])
    if kind == mi.Properties.Type.Spectrum:
        text = repr(props[key])
        if "uniform=" in text:
            return np.array(float(text.split("uniform=")[1].rstrip("]")))
    raise SceneError(f"medium '{props.id()}': {key} must be a number or an rgb colour")


def simplify(values):
    """Three equal channels are one grey number."""
    values = np.asarray(values, dtype=float)
    if values.ndim == 0 or np.all(values == values[0]):
        return float(values.flat[0])
    return values


def medium_bbox(state, medium, variant):
    """The medium's own box, or, if it fills all of space, the scene's, 5 % larger, with the
    sensor inside."""
    if medium.bbox is not None:
        return medium.bbox
    scene = instantiate(without_media(state), variant)
    corners = [[float(c) for c in corner] for corner in (scene.bbox().min, scene.bbox().max)]
    for sensor in scene.sensors():
        corners.append([float(c) for c in sensor.bbox().min])
    corners = np.array(corners)[np.all(np.isfinite(corners), axis=-1)]
    if len(corners) < 2:
        raise SceneError(f"medium '{medium.name}' has no bbox_min and bbox_max, nor has the scene")
    lower, upper = corners.min(axis=0), corners.max(axis=0)
    margin = 0.05 * np.max(upper - lower)
    return tuple(map(float, lower - margin)), tuple(map(float, upper + margin))


def without_media(state):
    """A copy in which every analytic medium is an empty box-less stock one."""
    copy = mi.parser.ParserState(state)
    for node in analytic_nodes(copy):
        props = mi.Properties("homogeneous")
        props.set_id(node.props.id())
        node.props = props
    return copy


def voxelised(state, resolution, variant, folder, media=None):
    """A copy of the parsed scene with its analytic media as grids of `resolution`³ voxels.

    The grids are written to `folder`. `media` limits the change to these identifiers.
    Returns the new state and a list of (AnalyticMedium, Grid).
    """
    copy = mi.parser.ParserState(state)
    pairs = []
    for node in analytic_nodes(copy):
        if media is not None and node.props.id() not in media:
            continue
        medium = read_medium(node)
        grid = voxelize(medium.profile, medium_bbox(state, medium, variant), resolution)
        if not medium.is_grey:
            grid = grid.times(medium.sigma_t / medium.sigma_max)
        filename = Path(folder) / f"{medium.name or 'medium'}_{resolution}.vol"
        grid.write(filename)
        replace_node(copy, node, medium, grid, filename)
        pairs.append((medium, grid))
    if not pairs:
        wanted = f"with id in {sorted(media)} " if media else ""
        raise SceneError(f"the scene has no 'analytic' medium {wanted}to voxelise")
    return copy, pairs


def replace_node(state, node, medium, grid, filename):
    """Turn an `analytic` node into `heterogeneous` on top of `gridvolume`."""
    old = node.props
    props = mi.Properties("heterogeneous")
    props.set_id(old.id())
    for key in old.keys():  # noqa: SIM118 (Properties is not a mapping)
        if key not in OWN_PARAMETERS or (key == "albedo" and medium.albedo is None):
            props[key] = old[key]
    if medium.albedo is not None:
        grey = np.ndim(medium.albedo) == 0
        props["albedo"] = medium.albedo if grey else mi.ScalarColor3f(medium.albedo)
    props["scale"] = medium.sigma_max
    # Stock integrators skip their spectral bookkeeping where all channels agree.
    props["has_spectral_extinction"] = not medium.is_grey

    volume = mi.parser.SceneNode()
    volume.type = mi.ObjectType.Volume
    volume.props = mi.Properties("gridvolume")
    volume.props["filename"] = str(Path(filename).resolve())
    volume.props["use_grid_bbox"] = True
    props["sigma_t"] = mi.Properties.ResolvedReference(len(state.nodes))
    node.props = props  # before append, which may move the list
    state.nodes.append(volume)
