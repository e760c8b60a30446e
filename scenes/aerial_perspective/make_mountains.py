"""Makes the mountain range of `aerial_perspective.xml`.

    python scenes/aerial_perspective/make_mountains.py

writes mountains.ply beside this file (fixed seed, so that a second run gives the same bytes).
Lengths are kilometres, z is up at the origin of coordinates, which lies at sea level; the mesh
follows the curvature of the Earth. It is a fan from 5 to 80 km ahead (+y) of the origin, its rows
closer to each other where they are near.
"""

from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
EARTH = 6371.0  # km
NEAR, FAR = 5.0, 80.0  # km
HALF_ANGLE = np.radians(33)
ROWS, COLUMNS = 170, 160


def lattice_noise(rng, x, y, wavelength):
    """Smooth noise in [-1, 1]: random values on a square lattice, cubic fade between them."""
    n = int(2 * FAR / wavelength) + 3
    value = rng.uniform(-1, 1, (n, n))
    u, v = (x + FAR) / wavelength, (y + FAR) / wavelength
    i, j = np.floor(u).astype(int) % (n - 1), np.floor(v).astype(int) % (n - 1)
    s, t = (w * w * (3 - 2 * w) for w in (u - np.floor(u), v - np.floor(v)))
    low = value[j, i] * (1 - s) + value[j, i + 1] * s
    high = value[j + 1, i] * (1 - s) + value[j + 1, i + 1] * s
    return low * (1 - t) + high * t


def height(rng, x, y):
    """Of the terrain, km: crests where the noise changes its sign, valleys between them."""
    crests = 0.0
    strength = 1.0
    for wavelength in (14.0, 7.0, 3.5, 1.8, 0.9):
        octave = (1 - np.abs(lattice_noise(rng, x, y, wavelength))) ** 2
        crests = crests + strength * octave
        strength = strength * 0.52 * np.clip(octave, 0.3, 1)
    distance = np.hypot(x, y)
    rise = np.clip((distance - NEAR) / 25, 0, 1) ** 0.7  # foothills first
    return 0.05 + rise * (0.2 + 2.9 * np.clip(crests - 0.75, 0, None) / 0.95) ** 1.3


def mountains(rng):
    distance = NEAR * (FAR / NEAR) ** np.linspace(0, 1, ROWS)[:, None]
    angle = np.linspace(-HALF_ANGLE, HALF_ANGLE, COLUMNS)
    x, y = distance * np.sin(angle), distance * np.cos(angle)
    z = height(rng, x, y) - distance**2 / (2 * EARTH)
    z[[0, -1]] -= 3.5  # both ends lie under the ground
    points = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    corner = (np.arange(ROWS - 1)[:, None] * COLUMNS + np.arange(COLUMNS - 1)).ravel()
    right, far = corner + 1, corner + COLUMNS
    faces = np.concatenate(
        [np.stack([corner, right, far + 1], 1), np.stack([corner, far + 1, far], 1)]
    )
    return points, faces


def write_ply(path, points, faces):
    rows = np.empty(len(faces), dtype=[("n", "u1"), ("v", "<i4", 3)])
    rows["n"], rows["v"] = 3, faces
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(points)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    path.write_bytes(header.encode() + points.astype("<f4").tobytes() + rows.tobytes())


def main():
    write_ply(HERE / "mountains.ply", *mountains(np.random.default_rng(7)))


if __name__ == "__main__":
    main()
