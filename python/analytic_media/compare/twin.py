"""The stock twin of a scene: each of our media becomes a voxel grid, all else stays.

The scene is edited between parsing and instantiation, as a list of nodes with properties, so
shapes, emitters, sensors and references come through untouched.
"""

from pathlib import Path

import mitsuba as mi
import numpy as np

from . import media
from .media import SceneError

OUR_INTEGRATOR = "analyticvolpath"
PATH_TRACERS = (OUR_INTEGRATOR, "volpath", "volpathmis", "prbvolpath")
PATH_PARAMETERS = ("max_depth", "rr_depth", "hide_emitters")


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
        mi.parser.transform_resolve(config, state)
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
    """Numbers of the nodes of our media; those that are nested in an overlap are part of it."""
    plugins = [node.props.plugin_name() for node in state.nodes]
    nested = {
        number
        for node, plugin in zip(state.nodes, plugins, strict=True)
        if plugin == "overlap"
        for number in media.children(state, node, mi.ObjectType.Medium)
    }
    ours = [n for n, plugin in enumerate(plugins) if plugin in ("analytic", "overlap")]
    return [number for number in ours if number not in nested]


def read_media(state):
    """The SceneMedium of each of our media."""
    return [media.read_medium(state, number) for number in analytic_nodes(state)]


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


def own_parameters(state):
    """All that the scene states of its `analyticvolpath`; nothing, if its integrator is another."""
    props = integrator_node(state).props
    return dict(props.items()) if props.plugin_name() == OUR_INTEGRATOR else {}


def set_integrator(state, plugin, **changes):
    """Replace the scene's path tracer by `plugin` with the same depth parameters."""
    node = integrator_node(state)
    props = mi.Properties(plugin)
    props.set_id(node.props.id())
    for key, value in {**integrator_parameters(state), **changes}.items():
        props[key] = value
    node.props = props


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
    """A copy in which each of our media is an empty box-less stock one."""
    copy = mi.parser.ParserState(state)
    for number in analytic_nodes(copy):
        props = mi.Properties("homogeneous")
        props.set_id(copy.nodes[number].props.id())
        copy.nodes[number].props = props
    return copy


def enclosed(state):
    """A copy in which media with chromatic extinction end at a shape that does not scatter.

    Stock integrators take the length of a ray that leaves a medium without meeting a surface for
    infinite, and its transmittance over probability, 0/0, for 0: all that is seen through the
    medium is black.
    """
    copy = mi.parser.ParserState(state)
    for number in analytic_nodes(copy):
        medium = media.read_medium(copy, number)
        if not medium.is_grey and not has_boundary(copy, number):
            enclose(copy, number, medium.bbox, medium.bsphere)
    return copy


def has_boundary(state, number):
    """Whether a shape refers to the medium."""
    return any(
        number in media.children(state, node, mi.ObjectType.Medium)
        for node in state.nodes
        if node.type == mi.ObjectType.Shape
    )


def enclose(state, number, bbox, bsphere=None):
    """Puts the medium into the sphere, or into the box; nothing without either."""
    if bsphere is not None:
        props = mi.Properties("sphere")
        props["center"], props["radius"] = mi.ScalarPoint3f(bsphere[0]), bsphere[1]
    elif bbox is not None:
        props = mi.Properties("cube")
        lower, upper = np.asarray(bbox)
        place = mi.ScalarTransform4f().translate(list((lower + upper) / 2))
        props["to_world"] = place.scale(list((upper - lower) / 2))
    else:
        return
    props["bsdf"] = append(state, mi.ObjectType.BSDF, mi.Properties("null"))
    props["interior"] = mi.Properties.ResolvedReference(number)
    shape = append(state, mi.ObjectType.Shape, props)
    root = state.nodes[0].props
    root[f"boundary_{number}"] = shape
    state.nodes[0].props = root


def voxelised(state, resolution, variant, folder, only=None):
    """A copy of the parsed scene with our media as grids of `resolution`³ voxels.

    The grids are written to `folder`. `only` limits the change to these identifiers.
    Returns the new state and a list of (SceneMedium, Grid of its extinction).
    """
    copy = mi.parser.ParserState(state)
    pairs = []
    for number in analytic_nodes(copy):
        medium = media.read_medium(copy, number)
        if only is not None and medium.name not in only:
            continue
        bbox = medium_bbox(state, medium, variant)
        grids = media.grids(medium, bbox, resolution)
        replace_node(copy, number, medium, grids, Path(folder), resolution)
        if not medium.is_grey and not has_boundary(copy, number):
            enclose(copy, number, bbox)
        pairs.append((medium, grids.extinction))
    if not pairs:
        wanted = f"with id in {sorted(only)} " if only else ""
        raise SceneError(f"the scene has no 'analytic' medium {wanted}to voxelise")
    return copy, pairs


def replace_node(state, number, medium, grids, folder, resolution):
    """Turn a node of ours into `heterogeneous` on top of `gridvolume`."""
    name = medium.name or "medium"

    def volume(grid, quantity):
        path = folder / f"{name}_{quantity}_{resolution}.vol"
        grid.write(path)
        props = mi.Properties("gridvolume")
        props["filename"] = str(path.resolve())
        props["use_grid_bbox"] = True
        return append(state, mi.ObjectType.Volume, props)

    old, props = state.nodes[number].props, mi.Properties("heterogeneous")
    props.set_id(old.id())
    if medium.is_overlap:
        props["phase"] = blended(state, grids, volume)
        props["albedo"] = volume(grids.albedo, "albedo")
        props["sample_emitters"] = old.get("sample_emitters", True)
    else:
        albedo = medium.components[0].albedo
        own = media.own_parameters() - ({"albedo"} if albedo is None else set())
        for key in old.keys():  # noqa: SIM118 (Properties is not a mapping)
            if key not in own:
                props[key] = old[key]
        if albedo is not None:
            props["albedo"] = albedo if np.ndim(albedo) == 0 else mi.ScalarColor3f(albedo)
    props["scale"] = medium.sigma_max
    # Stock integrators skip their spectral bookkeeping where all channels agree.
    props["has_spectral_extinction"] = not medium.is_grey
    props["sigma_t"] = volume(grids.extinction, "sigma_t")
    state.nodes[number].props = props


def blended(state, grids, volume):
    """The phase functions of an overlap, mixed by `blendphase` as the scattering is."""
    *first, last = grids.phases
    result = phase(state, last)
    for number in reversed(range(len(first))):
        props = mi.Properties("blendphase")
        props["first"] = phase(state, first[number])
        props["second"] = result
        props["weight"] = volume(grids.blends[number], f"phase{number}")
        result = append(state, mi.ObjectType.PhaseFunction, props)
    return result


def phase(state, number):
    if number is None:
        return append(state, mi.ObjectType.PhaseFunction, mi.Properties("isotropic"))
    return mi.Properties.ResolvedReference(number)


def append(state, kind, props):
    """Adds a node; the reference to it."""
    node = mi.parser.SceneNode()
    node.type, node.props = kind, props
    state.nodes.append(node)
    return mi.Properties.ResolvedReference(len(state.nodes) - 1)
