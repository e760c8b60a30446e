"""Writes the stock twin of a scene file: its grids, and an XML that Mitsuba alone can render.

The XML is edited as text: Mitsuba's own writer renames parameters and, in 3.9.1, decomposes
some transforms wrongly.
"""

import os
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..voxelize import voxelize
from . import twin

VARIANT = "scalar_rgb"  # the scene is only parsed, any rgb variant serves


@dataclass
class Written:
    """What was made of one medium."""

    medium: str
    path: Path
    nbytes: int
    bbox: tuple


def write_twin(scene, resolution, folder, medium=None, parameters=None):
    """Write `NAME_RESOLUTION.vol` for every analytic medium of `scene`, or for the one with the
    identifier `medium`, and `SCENE_RESOLUTION.xml` that uses them, to `folder`.

    Returns (path of the XML, list of Written). Raises twin.SceneError or ValueError, and then
    writes nothing.
    """
    scene, folder = Path(scene), Path(folder)
    state = twin.parse(scene, VARIANT, parameters)
    root = read_xml(scene)
    nodes = twin.analytic_nodes(state)
    elements = [e for e in root.iter("medium") if e.get("type") == "analytic"]
    if len(nodes) != len(elements):
        raise twin.SceneError(f"{scene}: media in included files cannot be voxelised")
    chosen = [
        (twin.read_medium(node), element)
        for node, element in zip(nodes, elements, strict=True)
        if medium in (None, node.props.id())
    ]
    if not chosen:
        found = [node.props.id() for node in nodes]
        raise twin.SceneError(f"{scene}: no 'analytic' medium with id '{medium}', found {found}")
    boxes = [twin.medium_bbox(state, m, VARIANT) for m, _ in chosen]
    grids = [
        voxelize(m.profile, box, resolution) for (m, _), box in zip(chosen, boxes, strict=True)
    ]

    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for number, ((m, element), grid) in enumerate(zip(chosen, grids, strict=True)):
        if not m.is_grey:
            grid = grid.times(m.sigma_t / m.sigma_max)
        path = folder / f"{m.name or f'medium{number}'}_{resolution}.vol"
        grid.write(path)
        replace_element(element, m, path.name)
        written.append(Written(m.name, path, grid.nbytes, grid.bbox))
    edit_scene(root, scene, folder, parameters or {})
    target = folder / f"{scene.stem}_{resolution}.xml"
    ElementTree.indent(root, "    ")
    ElementTree.ElementTree(root).write(target, encoding="utf-8")
    return target, written


def read_xml(scene):
    parser = ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
    return ElementTree.parse(scene, parser).getroot()


def replace_element(element, medium, filename):
    """Turn an `analytic` element into `heterogeneous` on top of `gridvolume`."""
    keep_albedo = medium.albedo is None
    for child in list(element):
        name = child.get("name")
        own = name in twin.OWN_PARAMETERS and not (name == "albedo" and keep_albedo)
        if own or child.tag is ElementTree.Comment:
            element.remove(child)
    element.set("type", "heterogeneous")
    volume = ElementTree.Element("volume", type="gridvolume", name="sigma_t")
    volume.append(parameter("string", "filename", filename))
    volume.append(parameter("boolean", "use_grid_bbox", "true"))
    added = [
        volume,
        parameter("float", "scale", repr(medium.sigma_max)),
        parameter("boolean", "has_spectral_extinction", str(not medium.is_grey).lower()),
    ]
    if not keep_albedo:
        kind = "float" if np.ndim(medium.albedo) == 0 else "rgb"
        text = ", ".join(repr(float(v)) for v in np.atleast_1d(medium.albedo))
        added.append(parameter(kind, "albedo", text))
    for position, child in enumerate(added):
        element.insert(position, child)


def parameter(kind, name, value):
    return ElementTree.Element(kind, name=name, value=value)


def edit_scene(root, scene, folder, parameters):
    """A stock integrator, the given parameters as defaults, and file names that still lead home."""
    for integrator in root.iter("integrator"):
        if integrator.get("type") == "analyticvolpath":
            integrator.set("type", "volpath")
    for default in root.iter("default"):
        if default.get("name") in parameters:
            default.set("value", str(parameters[default.get("name")]))
    for string in root.iter("string"):
        value = string.get("value")
        if string.get("name") == "filename" and (scene.parent / value).is_file():
            string.set("value", os.path.relpath(scene.parent / value, folder))
    note = f" Stock twin of {scene.name}, made by analytic-media voxelize "
    root.insert(0, ElementTree.Comment(note))
