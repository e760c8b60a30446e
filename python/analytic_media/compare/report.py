"""Writes report.html: one file, pictures inside."""

import base64
from importlib.resources import files

import numpy as np
from jinja2 import Environment, StrictUndefined

from . import figures
from .methods import EXACT, OURS, colour_mode


def write(path, summary, result):
    """`summary` is what summary.json holds, `result` the protocol.Result behind it."""
    source = files(__package__).joinpath("template.html").read_text(encoding="utf-8")
    environment = Environment(autoescape=True, undefined=StrictUndefined)
    environment.filters.update(number=number, percent=percent, times=times, mib=mib)
    template = environment.from_string(source)
    html = template.render(
        summary=summary,
        ours=OURS.key,
        modes=[mode_section(*item) for item in result.references.items()],
        variants=[variant_section(name, summary, result) for name in result.variants],
        fans=[
            {"plot": embed(figures.transmittance(fan)), "numbers": fan}
            for fan in summary["transmittance"]
            if fan["grids"]
        ],
    )
    path.write_text(html, encoding="utf-8")


def embed(png):
    return "data:image/png;base64," + base64.b64encode(png).decode()


def zoom_for(image):
    """Repeat pixels of small images, so that browsers do not blur them."""
    return max(1, round(320 / image.shape[1]))


def mode_section(mode, references):
    exact = references[EXACT].image
    factor = figures.exposure(exact)
    pictures = [
        {
            "title": "exact medium" if medium == EXACT else f"{medium}³ grid",
            "png": embed(figures.picture(reference.image, factor, zoom_for(exact))),
        }
        for medium, reference in references.items()
    ]
    bias = embed(figures.bias_maps(references)) if len(references) > 1 else None
    return {"name": mode, "pictures": pictures, "bias": bias}


def variant_section(variant, summary, result):
    exact = result.references[colour_mode(variant)][EXACT]
    factor = figures.exposure(exact.image)
    methods = summary["variants"][variant]["methods"]
    images = {key: result.images[variant, key] for key in methods}
    return {
        "name": variant,
        "numbers": summary["variants"][variant],
        "pictures": [
            {
                "key": key,
                "png": embed(figures.picture(image, factor, zoom_for(exact.image))),
                "method": methods[key],
                "final": methods[key]["accumulated"][-1],
                "relative_mean": float(np.mean(image) / np.mean(exact.image) - 1),
            }
            for key, image in images.items()
        ],
        "differences": embed(figures.difference_maps(methods, images, exact)),
        "noise": embed(figures.convergence(methods, "mse")),
        "error": embed(figures.convergence(methods, "mse_exact")),
    }


def number(value, digits=3):
    return "–" if value is None else f"{value:.{digits}g}"


def times(value):
    """A ratio as it is read aloud: 4.2×."""
    if value is None:
        return "–"
    return (
        f"{value:.0f}×" if value >= 99.5 else f"{value:.1f}×" if value >= 9.95 else f"{value:.2f}×"
    )


def percent(value):
    return f"{100 * value:+.2f} %"


def mib(value):
    return f"{value / 2**20:.1f} MiB"
