"""Makes the ear of `skin.xml`.

    python scenes/skin/make_ear.py

writes ear.ply beside this file. Lengths are millimetres. The ear stands in the xz-plane and is thin
along y: 4 mm in the middle, 7 mm along its rim, less towards the lobe; its edge is sharp.
"""

from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
RINGS, SECTORS = 40, 96
WIDTH, HEIGHT = 17.0, 29.0  # half of each, mm


def outline(angle):
    """Points (x, z) of the edge: an oval, narrower and pulled forward at the lobe."""
    x, z = np.cos(angle), np.sin(angle)
    narrow = 1 - 0.36 * np.clip(-z, 0, 1) ** 1.5 + 0.06 * np.clip(z, 0, 1)
    return WIDTH * x * narrow - 5 * np.clip(-z, 0, 1) ** 2, HEIGHT * z


def half_thickness(r, angle):
    """mm; `r` is 0 in the middle and 1 at the edge."""
    along = np.cos(angle - np.radians(60))  # the rim is thickest above and ahead, gone at the lobe
    rim = 1.5 * np.exp(-(((r - 0.84) / 0.1) ** 2)) * np.clip(0.7 + 0.5 * along, 0, 1)
    fold = 0.9 * np.exp(-(((r - 0.45) / 0.1) ** 2)) * np.clip(0.3 + along, 0, 1)
    return (2.0 + rim + fold) * np.sqrt(1 - r**4)


def ear():
    """(points, faces): two sheets that meet at the edge."""
    r = np.linspace(0, 1, RINGS + 1)[1:, None]
    angle = np.linspace(0, 2 * np.pi, SECTORS, endpoint=False)
    x, z = (r * edge for edge in outline(angle))
    y = half_thickness(r, angle)
    front = np.stack([x, -y, z], axis=-1).reshape(-1, 3)
    back = np.stack([x, y, z], axis=-1)[:-1].reshape(-1, 3)  # its edge is that of the front
    middle = half_thickness(0, 0.0)
    points = np.concatenate([front, back, [[0, -middle, 0], [0, middle, 0]]])

    def sheet(rings, centre):
        turn = np.roll(rings, -1, axis=1)
        inner, outer = rings[:-1], rings[1:]
        inner_turn, outer_turn = turn[:-1], turn[1:]
        fan = np.stack([np.full(SECTORS, centre), rings[0], turn[0]], axis=-1)
        quads = [
            np.stack([inner, outer, outer_turn], axis=-1).reshape(-1, 3),
            np.stack([inner, outer_turn, inner_turn], axis=-1).reshape(-1, 3),
        ]
        return np.concatenate([fan, *quads])

    numbers = np.arange(RINGS * SECTORS).reshape(RINGS, SECTORS)
    edge = numbers[-1:]
    behind = np.concatenate([RINGS * SECTORS + numbers[:-1], edge])
    faces = [sheet(numbers, len(points) - 2), sheet(behind, len(points) - 1)[:, ::-1]]
    return points, np.concatenate(faces)


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
    write_ply(HERE / "ear.ply", *ear())


if __name__ == "__main__":
    main()
