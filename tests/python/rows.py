"""Rows of the tables in tests/reference, and the profiles in them."""

import json
from pathlib import Path

import analytic_media as am

TABLES = Path(__file__).parents[1] / "reference"


def table(name):
    """The rows that are about profiles of this package; components of sums are sorted."""
    rows = json.loads((TABLES / f"{name}.json").read_text())["rows"]
    for row in rows:
        parts = row.get("components") or [row]
        parts.sort(key=lambda part: part["profile"]["type"])
        row["profiles"] = [profile(part["profile"]) for part in parts]
    return [row for row in rows if None not in row["profiles"]]


def profile(description):
    """The profile of a row; None if there is none like it yet."""
    d = description
    match d["type"]:
        case "constant":
            return am.Constant()
        case "linear":
            return am.Linear(gradient=d["a"], density=d["k"], up=d["up"])
        case "exponential":
            return am.Exponential(scale_height=d["H"], base_height=d["h0"], up=d["up"])
    return None
