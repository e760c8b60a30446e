"""Efficiency of the ways to treat colour, on three scenes: spectral MIS over all else.

    python benches/spectral_efficiency.py [--scene NAME] [--variant NAME] [--rounds N] [--time S]

Runs `analytic-media compare --strategies` on each scene, in all variants, and prints a table in
Markdown: how many times the efficiency of `analyticvolpath` with spectral MIS is that of its other
strategies, of the best stock method on our own medium, and of the best stock method on a grid. The
best is that of each round. Cells are the median and the range over the rounds; images of stock
methods have heavy tails, so each row is given a second time without the 0.1 % of pixels with the
largest errors. Rows of means are geometric, over the scenes' medians. A second table has the means
over each stock method by itself.

A scene's report and summary.json go to a folder of its own; --print makes the tables of what is
there already.
"""

import argparse
import json
from pathlib import Path

import numpy as np

SCENES = Path(__file__).parent.parent / "scenes"
NAMES = ("ocean", "skin", "sky_patch")
VARIANTS = ("scalar_rgb", "scalar_spectral", "llvm_ad_rgb", "llvm_ad_spectral")
COLUMNS = {
    "`single`": "analyticvolpath (single)@exact",
    "`average`": "analyticvolpath (average)@exact",
    "`tracking`": "analyticvolpath (tracking)@exact",
    "best stock, our medium": "best_tracking",
    "best stock, grid": "best_grid",
}
STOCK = {
    f"`{integrator}`, {medium}": f"{integrator}@{key}"
    for medium, key in {"our medium": "tracked", "64³ grid": 64, "256³ grid": 256}.items()
    for integrator in ("volpath", "volpathmis")
}
ERRORS = {"all": "mse", "trimmed": "mse_trimmed"}


def measure(name, options):
    """Runs the comparison of one scene."""
    from analytic_media.compare import compare
    from analytic_media.compare.protocol import Options

    compare(
        Options(
            scene=str(SCENES / f"{name}.xml"),
            variants=tuple(options.variant or VARIANTS),
            resolutions=tuple(options.resolutions),
            rounds=options.rounds,
            seconds=options.time,
            reference_seconds=options.reference_time or 7.5 * options.time,
            strategies=True,
        ),
        options.output / name,
        "benches/spectral_efficiency.py",
    )


def table(summaries):
    """Markdown of all variants, scene by scene, and of the means over the scenes."""
    lines = [row("variant", "scene", "pixels", *COLUMNS), row(*["---"] * (3 + len(COLUMNS)))]
    for variant in variants(summaries):
        for pixels, kind in ERRORS.items():
            of_scenes = ratios(summaries, variant, kind, COLUMNS)
            for name, cells in of_scenes.items():
                lines.append(row(f"`{variant}`", name, pixels, *map(cell, cells)))
            means = map(geometric_mean, zip(*of_scenes.values(), strict=True))
            lines.append(row(f"`{variant}`", "**mean**", pixels, *means))
    return "\n".join(lines)


def stock_table(summaries):
    """Markdown of the means over the scenes, stock method by stock method."""
    lines = [row("variant", "pixels", *STOCK), row(*["---"] * (2 + len(STOCK)))]
    for variant in variants(summaries):
        for pixels, kind in ERRORS.items():
            of_scenes = ratios(summaries, variant, kind, STOCK)
            means = map(geometric_mean, zip(*of_scenes.values(), strict=True))
            lines.append(row(f"`{variant}`", pixels, *means))
    return "\n".join(lines)


def variants(summaries):
    """Those of any scene, in order."""
    return dict.fromkeys(v for summary in summaries.values() for v in summary["variants"])


def ratios(summaries, variant, kind, columns):
    """Of each scene that was rendered in the variant, in the order of the columns."""
    return {
        name: [
            summary["variants"][variant]["efficiency_ratios"][kind].get(key)
            for key in columns.values()
        ]
        for name, summary in summaries.items()
        if variant in summary["variants"]
    }


def row(*cells):
    return f"| {' | '.join(cells)} |"


def cell(ratio):
    """Median and range, if there are any."""
    return f"{ratio['median']:.3g} ({ratio['min']:.3g} to {ratio['max']:.3g})" if ratio else "–"


def geometric_mean(ratios):
    if not all(ratios):
        return "–"
    return f"**{np.exp(np.mean([np.log(ratio['median']) for ratio in ratios])):.3g}**"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", action="append", choices=NAMES, help="may be repeated")
    parser.add_argument("--variant", action="append", help="may be repeated")
    parser.add_argument("--resolutions", type=int, nargs="+", default=[64, 256], metavar="N")
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--time", type=float, default=6.0, help="CPU seconds of a method's round")
    parser.add_argument("--reference-time", type=float, help="CPU seconds of a reference")
    parser.add_argument("--output", type=Path, default=Path("report/spectral"))
    parser.add_argument("--print", action="store_true", help="measure nothing")
    options = parser.parse_args()

    names = options.scene or NAMES
    for name in () if options.print else names:
        measure(name, options)
    summaries = {
        name: json.loads((options.output / name / "summary.json").read_text()) for name in names
    }
    print(table(summaries), stock_table(summaries), sep="\n\n")


if __name__ == "__main__":
    main()
