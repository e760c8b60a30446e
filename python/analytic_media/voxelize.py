"""Samples a profile on a regular grid: what a renderer without closed forms has to do."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class Grid:
    """Relative densities at the voxel centres of an axis-aligned box.

    `data` is float32 with shape (z, y, x, channels); `bbox` is (lower corner, upper corner) in
    scene units. Trilinear interpolation between the samples, constant in the outer half voxel.
    """

    data: np.ndarray
    bbox: tuple

    @property
    def resolution(self):
        return self.data.shape[0]

    @property
    def nbytes(self):
        return self.data.nbytes

    def times(self, colour):
        """The same grid with one channel per entry of `colour`, each scaled by it."""
        data = self.data * np.asarray(colour, dtype=np.float32)
        return Grid(np.ascontiguousarray(data), self.bbox)

    def density(self, x, channel=0):
        """Interpolated density of a channel at points `x` (..., 3) inside the box."""
        lower, upper = (np.asarray(corner, dtype=float) for corner in self.bbox)
        n = self.resolution
        place = np.clip((x - lower) / (upper - lower) * n - 0.5, 0, n - 1)
        cell = np.minimum(place.astype(int), n - 2)
        frac = place - cell
        values = self.data[..., channel]
        result = np.zeros(place.shape[:-1])
        for dz in (0, 1):
            for dy in (0, 1):
                for dx in (0, 1):
                    corner = np.array([dx, dy, dz])
                    weight = np.prod(np.where(corner, frac, 1 - frac), axis=-1)
                    i, j, k = np.moveaxis(cell + corner, -1, 0)
                    result += weight * values[k, j, i]
        return result

    def write(self, path):
        """Write Mitsuba's `.vol` format: version 3, float32, with the box in the header."""
        nz, ny, nx, channels = self.data.shape
        header = b"VOL\x03" + np.array([1, nx, ny, nz, channels], "<i4").tobytes()
        header += np.concatenate(self.bbox).astype("<f4").tobytes()
        Path(path).write_bytes(header + self.data.astype("<f4").tobytes())


def voxel_centres(bbox, resolution):
    """The three coordinate axes, each with the `resolution` voxel centres of the box."""
    lower, upper = bbox
    middle = (np.arange(resolution) + 0.5) / resolution
    return [low + (high - low) * middle for low, high in zip(lower, upper, strict=True)]


def voxelize(profile, bbox, resolution):
    """Sample `profile.density` at the centres of `resolution`³ voxels of the box `bbox`.

    `bbox` is (lower corner, upper corner), each three finite lengths with lower < upper;
    `resolution` is the number of voxels along every side, at least 2.
    """
    lower, upper = (np.asarray(corner, dtype=float) for corner in bbox)
    if lower.shape != (3,) or upper.shape != (3,) or not np.all(np.isfinite([lower, upper])):
        raise ValueError(f"bbox must be two corners of three finite lengths, got {bbox}")
    if np.any(lower >= upper):
        raise ValueError(f"bbox must have its lower corner below its upper corner, got {bbox}")
    if resolution != int(resolution) or resolution < 2:
        raise ValueError(f"resolution must be a whole number >= 2, got {resolution}")
    resolution = int(resolution)

    xs, ys, zs = voxel_centres((lower, upper), resolution)
    data = np.empty((resolution,) * 3 + (1,), dtype=np.float32)
    points = np.empty((resolution, resolution, 3))
    points[..., 0], points[..., 1] = xs, ys[:, None]
    for k, z in enumerate(zs):  # a slab at a time: 256³ points would be 400 MB
        points[..., 2] = z
        data[k, ..., 0] = profile.density(points)
    return Grid(data, (tuple(lower), tuple(upper)))
