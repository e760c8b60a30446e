"""Makes the ground of the scenes that are seen from near the Earth's surface.

    python scenes/earth/make_ground.py

writes ground.ply beside this file: the whole globe, in kilometres, fine near the origin of
coordinates. `analytic_media.presets.ground` says why it is not a sphere.
"""

from pathlib import Path

from analytic_media.presets import ground

RADIUS = 6371.0  # km


def main():
    (Path(__file__).parent / "ground.ply").write_bytes(ground.ply(*ground.mesh(RADIUS)))


if __name__ == "__main__":
    main()
