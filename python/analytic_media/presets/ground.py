"""The ground of a planet, for scenes whose origin of coordinates lies on it.

Mitsuba's sphere computes with the distance from its centre: at 6371 km a float32 is off by
0.25 m, more than the offset of rays that start near the origin. A mesh has its vertices there.
"""

import hashlib
import os
import tempfile
from pathlib import Path

import numpy as np

SECTORS = 96
FIRST_RING = 3e-5  # in radii: 190 m on Earth, whose chords sink 3 mm into the ground
GROWTH = 0.12  # of a ring's distance to the next: chords 60 km away sink 1 m on Earth
WIDEST = np.radians(4)


def shape(kind: str | None, radius: float, bsdf: dict) -> dict:
    """The planet of `radius` scene units below the origin, as a dictionary of shapes.

    `kind` is "mesh" for cameras near the origin, "sphere" for those far away, None for no ground.
    """
    if kind is None:
        return {}
    if kind == "sphere":
        sphere = {"type": "sphere", "center": [0.0, 0.0, -radius], "radius": radius}
        return {"ground": sphere | {"bsdf": bsdf}}
    if kind == "mesh":
        return {"ground": {"type": "ply", "filename": str(cached(radius)), "bsdf": bsdf}}
    raise ValueError(f'ground must be "mesh", "sphere" or None, got {kind!r}')


def rings() -> np.ndarray:
    """Angles from the origin of all rings of vertices, as seen from the centre."""
    angles = [FIRST_RING]
    while angles[-1] < np.pi - WIDEST:
        angles.append(angles[-1] + min(GROWTH * angles[-1], WIDEST))
    return np.array(angles)


def mesh(radius: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(vertices, normals, faces) of the sphere, fine at the origin and coarse far from it.

    Altitudes come from 1 - cos θ = 2 sin²(θ/2): next to the origin they are exact to a float32 of
    their own size.
    """
    theta = rings()[:, None]
    phi = 2 * np.pi * np.arange(SECTORS) / SECTORS
    flat = np.ones_like(phi)
    across = np.sin(theta) * np.array([[np.cos(phi)], [np.sin(phi)]])
    around = np.stack([*across, np.cos(theta) * flat], axis=-1).reshape(-1, 3)
    drop = (-2 * np.sin(theta / 2) ** 2 * flat).ravel()
    normals = np.concatenate([[[0, 0, 1]], around, [[0, 0, -1]]])
    points = np.concatenate([[[0, 0, 0]], np.c_[around[:, :2], drop], [[0, 0, -2]]])
    return radius * points, normals, faces(len(theta))


def faces(count: int) -> np.ndarray:
    """Triangles between `count` rings and the two poles, seen from outside."""
    here = np.arange(SECTORS)
    after = (here + 1) % SECTORS
    first, last = 1, 1 + (count - 1) * SECTORS
    cap = np.stack([0 * here, first + here, first + after], axis=1)
    closing = np.stack([last + here, 0 * here + last + SECTORS, last + after], axis=1)
    start = first + SECTORS * np.arange(count - 1)[:, None]
    a, b = start + here, start + after
    c, d = a + SECTORS, b + SECTORS
    quads = np.stack([np.stack([a, c, d], axis=-1), np.stack([a, d, b], axis=-1)])
    return np.concatenate([cap, quads.reshape(-1, 3), closing])


def cached(radius: float) -> Path:
    """A PLY file of the mesh among the system's temporary files, written if it is not there."""
    data = ply(*mesh(radius))
    name = f"analytic_media_ground_{hashlib.sha256(data).hexdigest()[:16]}.ply"
    path = Path(tempfile.gettempdir()) / name
    if not path.exists():
        handle, partial = tempfile.mkstemp(dir=path.parent, suffix=".ply")
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        os.replace(partial, path)  # another process may be reading
    return path


def ply(points, normals, faces) -> bytes:
    """The mesh as a binary PLY file."""
    rows = np.empty(len(faces), dtype=[("n", "u1"), ("v", "<i4", 3)])
    rows["n"], rows["v"] = 3, faces
    properties = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n{properties}"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    vertices = np.concatenate([points, normals], axis=1).astype("<f4")
    return header.encode() + vertices.tobytes() + rows.tobytes()
