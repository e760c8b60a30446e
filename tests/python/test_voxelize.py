"""The grid of a medium, and the stock twin of a scene that uses it."""

import numpy as np
import pytest

import analytic_media as am
from analytic_media.voxelize import voxel_centres, voxelize

BOX = ((-2.0, -3.0, 0.0), (2.0, 5.0, 1.0))


def test_samples_are_the_exact_density_at_voxel_centres():
    """A trilinear gridvolume has its samples at voxel centres."""
    profile = am.Linear(gradient=-0.5, density=1.0, base_height=0.25, up=(0, 0, 1))
    grid = voxelize(profile, BOX, 5)
    z = (np.arange(5) + 0.5) / 5
    assert grid.data.shape == (5, 5, 5, 1)
    np.testing.assert_allclose(grid.data[:, 0, 0, 0], 1.0 - 0.5 * (z - 0.25), rtol=1e-7)
    assert np.all(grid.data == grid.data[:, :1, :1])


def test_axes_are_not_mixed_up():
    """`up` along x must vary along the last axis of (z, y, x)."""
    grid = voxelize(am.Exponential(scale_height=2.0, up=(1, 0, 0)), BOX, 4)
    xs = voxel_centres(BOX, 4)[0]
    np.testing.assert_allclose(grid.data[1, 2, :, 0], np.exp(-xs / 2.0), rtol=1e-6)


def test_interpolation_is_exact_for_a_linear_density():
    """Trilinear interpolation reproduces an affine density between the outer voxel centres."""
    profile = am.Linear(gradient=0.4, density=1.0, up=(0, 0.6, 0.8))
    grid = voxelize(profile, BOX, 6)
    inner = np.random.default_rng(1).uniform(0.1, 0.9, (50, 3))
    lower, upper = map(np.array, BOX)
    points = lower + inner * (upper - lower)
    np.testing.assert_allclose(grid.density(points), profile.density(points), rtol=1e-6)


def test_file_is_read_back_by_mitsuba(tmp_path):
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    grid = voxelize(am.Exponential(scale_height=0.5), BOX, 3)
    grid.write(tmp_path / "fog.vol")
    read = mi.VolumeGrid(str(tmp_path / "fog.vol"))
    np.testing.assert_array_equal(np.array(read).reshape(grid.data.shape), grid.data)
    volume = mi.load_dict(
        {"type": "gridvolume", "filename": str(tmp_path / "fog.vol"), "use_grid_bbox": True}
    )
    np.testing.assert_allclose(np.array(volume.bbox().min).ravel(), BOX[0], atol=1e-6)
    np.testing.assert_allclose(np.array(volume.bbox().max).ravel(), BOX[1], atol=1e-6)


@pytest.mark.parametrize(
    ("bbox", "resolution", "message"),
    [
        (BOX, 1, "resolution must be a whole number >= 2, got 1"),
        (BOX, 2.5, "resolution must be a whole number >= 2, got 2.5"),
        (((0, 0, 0), (1, 0, 1)), 4, "lower corner below its upper corner"),
        (((0, 0, 0), (1, np.inf, 1)), 4, "three finite lengths"),
    ],
)
def test_bad_arguments_are_named(bbox, resolution, message):
    with pytest.raises(ValueError, match=message):
        voxelize(am.Constant(), bbox, resolution)
