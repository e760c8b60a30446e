"""Writes the stock twin of a scene file: its grids, and an XML that Mitsuba alone can render.

The XML is edited as text: Mitsuba's own writer renames parameters and, in 3.9.1, decomposes
some transforms wrongly.
"""

import copy
import os
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import media, twin

DEFAULT_PHASE = ElementTree.Element("phase", type="isotropic")
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
    numbers = twin.analytic_nodes(state)
    elements = own_media(root)
    if len(numbers) != len(elements):
        raise twin.SceneError(f"{scene}: media in included files cannot be voxelised")
    found = [(media.read_medium(state, n), e) for n, e in zip(numbers, elements, strict=True)]
    chosen = [(m, element) for m, element in found if medium in (None, m.name)]
    if not chosen:
        names = [m.name for m, _ in found]
        raise twin.SceneError(f"{scene}: no 'analytic' medium with id '{medium}', found {names}")
    boxes = [twin.medium_bbox(state, m, VARIANT) for m, _ in chosen]
    grids = [media.grids(m, box, resolution) for (m, _), box in zip(chosen, boxes, strict=True)]

    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for number, ((m, element), own) in enumerate(zip(chosen, grids, strict=True)):
        stem = m.name or f"medium{number}"

        def volume(grid, quantity, name, stem=stem, m=m):
            label = f"{stem}_{quantity}" if m.is_overlap else stem
            path = folder / f"{label}_{resolution}.vol"
            grid.write(path)
            written.append(Written(m.name, path, grid.nbytes, grid.bbox))
            return volume_element(name, path.name)

        if m.is_overlap:
            replace_overlap(root, element, m, own, volume)
        else:
            replace_element(element, m, volume(own.extinction, "sigma_t", "sigma_t"))
    edit_scene(root, scene, folder, parameters or {})
    target = folder / f"{scene.stem}_{resolution}.xml"
    ElementTree.indent(root, "    ")
    ElementTree.ElementTree(root).write(target, encoding="utf-8")
    return target, written


def read_xml(scene):
    parser = ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
    return ElementTree.parse(scene, parser).getroot()


def own_media(root):
    """The elements of our media; those that are nested in an overlap are part of it."""
    ours = [e for e in root.iter("medium") if e.get("type") in ("analytic", "overlap")]
    nested = [c for e in ours if e.get("type") == "overlap" for c in e.iter("medium") if c is not e]
    return [e for e in ours if not any(e is child for child in nested)]


def volume_element(name, filename):
    volume = ElementTree.Element("volume", type="gridvolume", name=name)
    volume.append(parameter("string", "filename", filename))
    volume.append(parameter("boolean", "use_grid_bbox", "true"))
    return volume


def replace_element(element, medium, volume):
    """Turn an `analytic` element into `heterogeneous` on top of `gridvolume`."""
    [component] = medium.components
    own = media.own_parameters() - ({"albedo"} if component.albedo is None else set())
    for child in list(element):
        if child.get("name") in own or child.tag is ElementTree.Comment:
            element.remove(child)
    added = [volume]
    if component.albedo is not None:
        kind = "float" if np.ndim(component.albedo) == 0 else "rgb"
        text = ", ".join(repr(float(v)) for v in np.atleast_1d(component.albedo))
        added.append(parameter(kind, "albedo", text))
    insert(element, medium, added)


def replace_overlap(root, element, medium, grids, volume):
    """Turn an `overlap` element into `heterogeneous`, its phase functions into a `blendphase`."""
    phases = [phase_of(child, root) for child in element.iter("medium") if child is not element]
    # Of those that are alike, one with an id is kept: there may be other references to it.
    pairs = sorted(
        zip(phases, medium.components, strict=True), key=lambda pair: "id" in pair[0].attrib
    )
    numbered = {c.phase: p for p, c in pairs}
    *first, result = [numbered.get(phase, DEFAULT_PHASE) for phase in grids.phases]
    for number in reversed(range(len(first))):
        blend = ElementTree.Element("phase", type="blendphase")
        blend.append(volume(grids.blends[number], f"phase{number}", "weight"))
        blend.extend([first[number], result])
        result = blend
    for child in list(element):
        if child.get("name") != "sample_emitters":
            element.remove(child)
    extinction = volume(grids.extinction, "sigma_t", "sigma_t")
    insert(element, medium, [extinction, volume(grids.albedo, "albedo", "albedo"), result])


def phase_of(medium, root):
    """The phase function that a medium states, a copy of the one that it refers to, or the
    default; without a name of its own."""
    phase = medium.find("phase")
    if phase is None:
        known = {phase.get("id"): phase for phase in root.iter("phase")}
        referred = [known[ref.get("id")] for ref in medium.findall("ref") if ref.get("id") in known]
        phase = copy.deepcopy(referred[0] if referred else DEFAULT_PHASE)
        phase.attrib.pop("id", None)
    phase.attrib.pop("name", None)
    return phase


def insert(element, medium, added):
    element.set("type", "heterogeneous")
    added += [
        parameter("float", "scale", repr(medium.sigma_max)),
        parameter("boolean", "has_spectral_extinction", str(not medium.is_grey).lower()),
    ]
    for position, child in enumerate(added):
        element.insert(position, child)


def parameter(kind, name, value):
    return ElementTree.Element(kind, name=name, value=value)


def edit_scene(root, scene, folder, parameters):
    """A stock integrator, the given parameters as defaults, and file names that still lead home."""
    for integrator in root.iter("integrator"):
        if integrator.get("type") == twin.OUR_INTEGRATOR:
            integrator.set("type", "volpath")
            for child in list(integrator):
                if child.get("name") not in twin.PATH_PARAMETERS:
                    integrator.remove(child)
    for default in root.iter("default"):
        if default.get("name") in parameters:
            default.set("value", str(parameters[default.get("name")]))
    for string in root.iter("string"):
        value = string.get("value")
        if string.get("name") == "filename" and (scene.parent / value).is_file():
            string.set("value", os.path.relpath(scene.parent / value, folder))
    note = f" Stock twin of {scene.name}, made by analytic-media voxelize "
    root.insert(0, ElementTree.Comment(note))
