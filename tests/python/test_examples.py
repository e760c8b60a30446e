"""The examples of gradients begin to find what they look for; docs/inverse.md has whole runs."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples" / "inverse"


@pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)
@pytest.mark.parametrize(
    ("name", "steps", "unknown", "before", "after"),
    [
        ("street", 25, "visibility", 400, (80, 220)),  # m; true: 110
        ("sunset", 12, "optical_depth", 0.5, (0.1, 0.4)),  # true: 0.122
    ],
)
def test_examples_move_towards_the_truth(variant, tmp_path, name, steps, unknown, before, after):
    picture = tmp_path / "fit.png"
    options = ["--steps", steps, "--spp", 4, "--photograph-spp", 64, "--output", picture]
    run = subprocess.run(
        [sys.executable, EXAMPLES / f"{name}.py", *map(str, options)],
        capture_output=True,
        text=True,
    )
    start, found = re.search(rf"{unknown}: from ([\d.]+) to ([\d.]+)", run.stdout).groups()
    assert float(start) == pytest.approx(before)
    assert after[0] < float(found) < after[1], run.stdout
    assert re.search(r"new kernels: \d+ in the first step, 0 in all the others", run.stdout)
    assert picture.stat().st_size > 10_000
