"""Our media against stock Mitsuba on voxels: equal-time renders, and a report of them."""

import json
from datetime import UTC, datetime
from pathlib import Path

from . import bias, protocol, report, twin
from .environment import environment
from .media import grids as grids_of
from .methods import EXACT

SCHEMA = 1
GEOMETRY_VARIANT = "scalar_rgb"  # camera rays and boxes are the same in all


def compare(options, output, command):
    """Render as `options` (protocol.Options) say; write summary.json and report.html to `output`.

    `command` is how the user asked for it, for the record. Returns the summary. Raises
    twin.SceneError for a scene that has no twin.
    """
    output = Path(output)
    for variant in options.variants:  # what one of them cannot do is said before rendering starts
        read_scene(options, variant)
    state, media = read_scene(options, GEOMETRY_VARIANT)
    output.mkdir(parents=True, exist_ok=True)

    fan = bias.camera_fan(state, GEOMETRY_VARIANT)
    transmittance = []
    for medium in media:
        box = twin.medium_bbox(state, medium, GEOMETRY_VARIANT)
        grids = [grids_of(medium, box, n).extinction for n in options.resolutions]
        transmittance.append(bias.transmittance_bias(fan, medium, box, grids))

    result = protocol.run(options, is_grey=all(medium.is_grey for medium in media))
    summary = {
        "schema": SCHEMA,
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "command": command,
        "environment": environment(),
        "scene": str(options.scene),
        "parameters": options.parameters,
        "options": {
            "rounds": options.rounds,
            "seconds": options.seconds,
            "reference_seconds": options.reference_seconds,
            "spp": options.spp,
            "resolutions": list(options.resolutions),
            "strategies": options.strategies,
        },
        "references": {
            mode: {str(medium): describe(r, of_mode) for medium, r in of_mode.items()}
            for mode, of_mode in result.references.items()
        },
        "transmittance": transmittance,
        "variants": result.variants,
    }
    (output / "summary.json").write_text(json.dumps(summary, indent=1) + "\n")
    report.write(output / "report.html", summary, result)
    return summary


def read_scene(options, variant):
    """The parsed scene and its analytic media, checked for what the comparison needs."""
    state = twin.parse(options.scene, variant, options.parameters)
    twin.integrator_node(state)
    media = twin.read_media(state)
    if not media:
        raise twin.SceneError(f"scene {options.scene} has no 'analytic' medium to compare")
    return state, media


def describe(reference, references):
    """The numbers of a reference, and how far it is from the exact one."""
    exact = references[EXACT]
    mean = float(reference.image.mean())
    numbers = {**reference.details, "mean": mean, "noise_variance": reference.noise_variance}
    if reference is not exact:
        noise = reference.noise_variance + exact.noise_variance
        squared = float(((reference.image - exact.image) ** 2).mean())
        numbers["relative_bias_of_mean"] = mean / float(exact.image.mean()) - 1
        numbers["squared_bias"] = squared - noise
    return numbers
