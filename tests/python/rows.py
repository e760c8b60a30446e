"""Rows of the tables in tests/reference, and the profiles in them."""

import json
from pathlib import Path

import analytic_media as am

TABLES = Path(__file__).parents[1] / "reference"


def read(name):
    """All rows, as they are."""
    data = json.loads((TABLES / f"{name}.json").read_text())
    assert len(data["rows"]) == data["count"]
    return data["rows"]


def table(name):
    """All rows, with their profiles; components of sums are sorted."""
    selected = read(name)
    for row in selected:
        parts = row.get("components") or [row]
        parts.sort(key=lambda part: part["profile"]["type"])
        row["profiles"] = [profile(part["profile"]) for part in parts]
    return selected


def profile(description):
    """The profile of a row."""
    d = description
    match d["type"]:
        case "constant":
            return am.Constant()
        case "linear":
            return am.Linear(gradient=d["a"], density=d["k"], up=d["up"])
        case "exponential":
            return am.Exponential(scale_height=d["H"], base_height=d["h0"], up=d["up"])
        case "sphere_exp":
            return am.Spherical(center=d["c"], radius=d["R"], scale_height=d["H"])
        case "sphere_tent":
            return am.Tent(center=d["c"], radius=d["R"], height=d["h_c"], width=d["w"])
        case "gaussian":
            return am.Gaussian(center=d["c"], sigma=d["s"])
        case other:
            raise ValueError(f"{other} is not a profile of the tables")
