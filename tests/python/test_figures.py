"""The figures of the article: the command that writes them, and the numbers behind them."""

import subprocess
import sys

import matplotlib.image
import numpy as np
import pytest

from analytic_media import cli, special
from analytic_media.figures import FIGURES, bessel, chapman, erfcx, lower, measure

WITHOUT_MITSUBA = """
import sys
sys.modules["mitsuba"] = sys.modules["drjit"] = None   # importing them fails
from analytic_media import cli
sys.exit(cli.main(sys.argv[1:]))
"""


def figures(*arguments):
    return cli.main(["figures", *map(str, arguments)])


@pytest.fixture(scope="module")
def all_figures(tmp_path_factory):
    folder = tmp_path_factory.mktemp("figures") / "new"
    assert figures("--output", folder) == 0
    return folder


def test_without_names_all_are_written_and_nothing_else(all_figures):
    assert {path.name for path in all_figures.iterdir()} == {f"{name}.png" for name in FIGURES}


@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_is_a_picture_with_curves(all_figures, name):
    path = all_figures / f"{name}.png"
    assert 20e3 < path.stat().st_size < 200e3
    pixels = matplotlib.image.imread(path)[..., :3]
    colours = np.unique(pixels.reshape(-1, 3), axis=0)
    coloured = np.ptp(pixels, axis=-1) > 0.2  # neither paper nor text
    assert len(colours) > 50
    assert np.mean(coloured) > 0.002


def test_a_subset_in_the_default_folder(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert figures("erfcx", "bessel_k1", "erfcx") == 0
    assert capsys.readouterr().out.split() == ["figures/erfcx.png", "figures/bessel_k1.png"]
    assert len(list((tmp_path / "figures").iterdir())) == 2


def test_an_unknown_name_lists_the_known_ones(tmp_path, capsys):
    folder = tmp_path / "new"
    assert figures("erfcx", "chapmann", "--output", folder) == 2
    message = capsys.readouterr().err
    assert "unknown figure chapmann; known: " in message
    assert all(name in message for name in FIGURES)
    assert not folder.exists(), "nothing half-made"


def test_a_folder_that_cannot_be_made_is_named(tmp_path, capsys):
    blocked = tmp_path / "file"
    blocked.touch()
    assert figures("erfcx", "--output", blocked) == 1
    assert str(blocked) in capsys.readouterr().err


def test_the_command_needs_no_mitsuba(tmp_path):
    command = [sys.executable, "-c", WITHOUT_MITSUBA, "figures", "erfcx", "--output", tmp_path]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "erfcx.png").is_file()


# ---- Numbers ---------------------------------------------------------------------------------


def worst(curves):
    """Greatest value of each curve; a curve has no gaps in these figures."""
    return {key: float(np.max(curve)) for key, curve in curves.items()}


def test_eq_46_is_as_far_off_as_documented():
    errors = worst(chapman.curves(special.chapman_huestis, measure.Answers.relative))
    assert list(errors) == [1, 10, 20, 40, 60, 80, 100]
    assert 5e-7 < errors[1] < 2e-6  # z = 6600
    assert 6e-5 < errors[100] < 1e-4  # z = 66
    assert max(errors.values()) == errors[100]


def test_ours_is_accurate_at_every_scale_height():
    relative = worst(chapman.curves(special.chapman, measure.Answers.relative))
    assert 1e-7 < max(relative.values()) < 7e-7
    fewest = min(chapman.digits(np.array(list(relative.values()))))
    assert fewest > 6.1


def test_schueler_and_kocifaj_err_by_percents():
    degrees = np.linspace(0, 90, 721)
    schueler = chapman.percent(special.chapman_schueler, degrees)
    assert all(-15.5 < p.min() < -10 and p.max() < 0.01 for p in schueler.values())
    kocifaj = chapman.percent(special.chapman_kocifaj, degrees)
    assert all(0.3 < np.abs(p).max() < 0.5 for p in kocifaj.values())


def test_below_the_horizontal_eq_48_loses_digits_and_ours_does_not():
    article = answered_below(lower.article)
    assert 3e-4 < article[1] < 2e-3
    assert max(answered_below(special.chapman_rescaled).values()) < 7e-7


def answered_below(formula):
    below = lower.ANGLES[lower.ANGLES.min(axis=1) >= 90]
    return {h: lower.answers(formula, h, below).relative().max() for h in lower.SCALE_HEIGHTS}


def test_the_article_rescaled_is_ours_for_large_planets():
    z, surface, cosine = 6600.0, 6550.0, np.array([0.5, 0, -0.05, -0.15])
    found = lower.article(z, surface, cosine)
    np.testing.assert_allclose(found, special.chapman_rescaled(z, surface, cosine), rtol=2e-6)
    single = lower.article(*(np.float32(a) for a in np.broadcast_arrays(z, surface, cosine)))
    assert single.dtype == np.float32


def test_the_horizontal_series_is_for_large_z():
    series = bessel.curve(special.chapman_horizontal_huestis)
    z = measure.middles(bessel.Z)
    assert series[z < 0.2].min() > 0.5
    assert series[z > 200].max() < 5e-7
    assert bessel.curve(special.bessel_k1_scaled).max() < 7e-7


def test_the_fit_of_erfcx_keeps_the_stated_bounds_up_to_a_thousand():
    fit = erfcx.answers(special.erfcx_golubev)
    assert fit.absolute().max() < erfcx.STATED_ABSOLUTE
    assert fit.relative()[erfcx.X < 1e3].max() < erfcx.STATED
    assert erfcx.STATED < fit.relative().max() < 1.8e-6
    assert erfcx.answers(special.erfcx).relative().max() < 5e-7


def test_intervals_meet_and_exact_ones_are_gaps():
    rows = measure.intervals(0, 90, 180)
    assert (rows[0, 0], rows[-1, -1]) == (0, 90)
    assert np.array_equal(rows[1:, 0], rows[:-1, -1])
    assert np.isnan(measure.greatest(np.array([[0.0, 0.0], [0.0, 1e-7]]))).tolist() == [True, False]


def test_a_horizontal_ray_has_cosine_0():
    assert chapman.cos_zenith(90) == 0
    np.testing.assert_allclose(chapman.cos_zenith([0, 60, 120]), [1, 0.5, -0.5], rtol=1e-15)
