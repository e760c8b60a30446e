"""Error of air-light against its cost: quadrature and the closed form.

    python docs/images/make_airlight_cost.py

runs `cargo test --release --test airlight_methods`, reads the tables that it prints, and writes
airlight_cost.png beside this file. Errors are those of all rows of the tables, costs those of a ray
past a light in a medium with Henyey and Greenstein's phase function, double precision.
"""

import re
import subprocess
from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, NullFormatter

HERE = Path(__file__).parent
COMMAND = "cargo test --release --test airlight_methods -- --nocapture --test-threads=1"
METHODS = {
    "quadrature": (r"HG, {} points", r"quadrature, {} points", (8, 16, 24, 32, 48)),
    "closed form": (r"HG, closed form, {} terms", r"closed form, {} terms", (4, 6, 12, 20)),
}


def cells(text, name):
    """Numbers of the line of a table that is called `name`."""
    (line,) = re.findall(rf"^\| {re.escape(name)} \|([-\d.e| ]*)\|$", text, re.MULTILINE)
    return [float(cell) for cell in line.split("|")]


def main():
    text = subprocess.run(
        COMMAND.split(), cwd=HERE.parents[1], capture_output=True, text=True, check=True
    ).stdout
    figure, axes = plt.subplots(1, 2, figsize=(8.6, 3.6), sharey=True, layout="constrained")
    for (method, (cost, error, numbers)), colour in zip(
        METHODS.items(), ("#1f4e9c", "#c8102e"), strict=True
    ):
        costs = [cells(text, cost.format(n)) for n in numbers]
        errors = [cells(text, error.format(n)) for n in numbers]
        for axis, column in zip(axes, (0, 2), strict=True):
            x = [row[column] for row in costs]
            for share, style, name in ((0, ":", "half of the rows"), (1, "-", "nine in ten")):
                y = [row[share] for row in errors]
                axis.plot(x, y, style, marker="o", markersize=4, color=colour,
                          label=f"{method}, {name}")  # fmt: skip
            for n, at, row in zip(numbers, x, errors, strict=True):
                axis.annotate(str(n), (at, row[1]), xytext=(4, 4), textcoords="offset points",
                              fontsize=8, color=colour)  # fmt: skip
    axes[0].set(xscale="log", yscale="log", xlabel="recorded operations", ylabel="relative error")
    axes[1].set(xscale="log", xlabel="ns per ray, one channel, double precision")
    ticks = (2e3, 5e3, 1e4, 2e4, 5e4), (5e2, 1e3, 2e3, 5e3, 1e4)
    for axis, marks in zip(axes, ticks, strict=True):
        axis.set_xticks(marks)
        axis.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.xaxis.set_minor_formatter(NullFormatter())
        axis.grid(alpha=0.3)
        axis.spines[["top", "right"]].set_visible(False)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4,
                  frameon=False, fontsize=8)  # fmt: skip
    figure.suptitle("Air-light: error against cost, by points or terms", fontsize=10.5)
    figure.savefig(HERE / "airlight_cost.png", dpi=110)


if __name__ == "__main__":
    main()
