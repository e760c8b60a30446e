"""Makes the meshes and the sky of the valley that `height_fog.xml` and `fog_bank.xml` show.

    python scenes/valley/make_valley.py

writes terrain.ply, walls.ply, roofs.ply, trees.ply and sky.exr beside this file (fixed seed,
so that a second run gives the same bytes). Lengths are metres, z is up, the valley runs along y.
"""

from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
HALF_WIDTH = 800.0  # the terrain covers [-800, 800]² m
VERTICES = 129  # per side
TREES = 700


def lattice_noise(rng, x, y, wavelength):
    """Smooth noise in [-1, 1]: random values on a square lattice, cubic fade between them."""
    n = int(np.ceil(2 * HALF_WIDTH / wavelength)) + 2
    value = rng.uniform(-1, 1, (n, n))
    u, v = (x + HALF_WIDTH) / wavelength, (y + HALF_WIDTH) / wavelength
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    fade = [w * w * (3 - 2 * w) for w in (u - i, v - j)]
    low = value[j, i] * (1 - fade[0]) + value[j, i + 1] * fade[0]
    high = value[j + 1, i] * (1 - fade[0]) + value[j + 1, i + 1] * fade[0]
    return low * (1 - fade[1]) + high * fade[1]


class Terrain:
    """Height field: a winding valley floor near z = 2 m between ridges of 100 to 240 m."""

    def __init__(self, rng):
        axis = np.linspace(-HALF_WIDTH, HALF_WIDTH, VERTICES)
        x, y = np.meshgrid(axis, axis)
        across = np.abs(x - self.river(y)) / 330
        slope = np.clip(across - 0.22, 0, None)
        ridge = 150 * slope**1.6 / (1 + 0.45 * slope**1.6)
        rough = sum(a * lattice_noise(rng, x, y, w) for a, w in ((34, 330), (15, 150), (6, 70)))
        far_end = 110 * np.clip((y - 420) / 380, 0, 1) ** 1.5
        floor = 2.0 + 1.5 * lattice_noise(rng, x, y, 90)
        rise = np.clip(slope / 0.5, 0, 1)
        self.axis, self.x, self.y = axis, x, y
        self.z = np.maximum(floor + ridge + rise * rough + far_end * (0.25 + rise), 0.3)

    @staticmethod
    def river(y):
        """x of the valley's axis."""
        return 70 * np.sin(y / 260) + 0.03 * y

    def height(self, x, y):
        """z at (x, y), bilinear."""
        step = self.axis[1] - self.axis[0]
        u, v = (np.asarray(x) + HALF_WIDTH) / step, (np.asarray(y) + HALF_WIDTH) / step
        i = np.clip(u.astype(int), 0, VERTICES - 2)
        j = np.clip(v.astype(int), 0, VERTICES - 2)
        s, t = u - i, v - j
        z = self.z
        return (z[j, i] * (1 - s) + z[j, i + 1] * s) * (1 - t) + (
            z[j + 1, i] * (1 - s) + z[j + 1, i + 1] * s
        ) * t

    def mesh(self):
        points = np.stack([self.x, self.y, self.z], axis=-1).reshape(-1, 3)
        corner = (np.arange(VERTICES - 1)[:, None] * VERTICES + np.arange(VERTICES - 1)).ravel()
        right, up = corner + 1, corner + VERTICES
        faces = np.concatenate(
            [np.stack([corner, right, up + 1], 1), np.stack([corner, up + 1, up], 1)]
        )
        return points, faces


def place(points, at, size, angle):
    """Unit-box points scaled by `size`, turned by `angle` about z and moved to `at`."""
    c, s = np.cos(angle), np.sin(angle)
    turned = points * size @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    return turned + at


BOX = np.array([[x, y, z] for z in (0, 1) for y in (-0.5, 0.5) for x in (-0.5, 0.5)])
BOX_FACES = np.array(
    [[0, 1, 5], [0, 5, 4], [1, 3, 7], [1, 7, 5], [3, 2, 6], [3, 6, 7], [2, 0, 4], [2, 4, 6],
     [4, 5, 7], [4, 7, 6]]
)  # fmt: skip
GABLE = np.array(  # the last two points are the ends of the ridge
    [[-0.56, -0.6, 0], [0.56, -0.6, 0], [0.56, 0.6, 0], [-0.56, 0.6, 0]]
    + [[-0.56, 0, 1], [0.56, 0, 1]]
)
GABLE_FACES = np.array([[0, 1, 5], [0, 5, 4], [2, 3, 4], [2, 4, 5], [1, 2, 5], [3, 0, 4]])
SPIRE = np.array(
    [[-0.55, -0.55, 0], [0.55, -0.55, 0], [0.55, 0.55, 0], [-0.55, 0.55, 0], [0, 0, 1]]
)
SPIRE_FACES = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])


class Soup:
    """Collects copies of small meshes into one."""

    def __init__(self):
        self.points, self.faces, self.count = [], [], 0

    def add(self, points, faces):
        self.points.append(points)
        self.faces.append(faces + self.count)
        self.count += len(points)

    def mesh(self):
        return np.concatenate(self.points), np.concatenate(self.faces)


def village(rng, terrain):
    """A church and some forty houses on the valley floor; the walls and the roofs apart."""
    walls, roofs = Soup(), Soup()

    def house(x, y, size, angle, roof):
        at = np.array([x, y, terrain.height(x, y) - 1.0])
        walls.add(place(BOX, at, size, angle), BOX_FACES)
        top = at + np.array([0, 0, size[2]])
        roofs.add(place(GABLE, top, [size[0], size[1], roof], angle), GABLE_FACES)

    church = np.array([terrain.river(-150.0) - 8, -150.0])
    house(*church, np.array([34, 15, 14]), 0.5, 11)
    tower_at = np.array([*(church + [-19, -10.5]), terrain.height(*church) - 1])
    walls.add(place(BOX, tower_at, [11, 11, 40], 0.5), BOX_FACES)
    roofs.add(place(SPIRE, tower_at + [0, 0, 40], [11, 11, 30], 0.5), SPIRE_FACES)

    taken = [church, church + [-19, -10]]
    while len(taken) < 42:
        y = rng.uniform(-560, 320)
        spot = np.array([terrain.river(y) + rng.normal(0, 75), y])
        if min(np.hypot(*(spot - other)) for other in taken) < 27:
            continue
        taken.append(spot)
        size = np.array([rng.uniform(10, 17), rng.uniform(8, 10), rng.uniform(6, 9)])
        house(*spot, size, rng.normal(0.4, 0.5), rng.uniform(4, 6.5))
    return walls, roofs, np.array(taken)


def fir(sides=6):
    """Three stacked cones of unit height, base radius 0.5."""
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    soup = Soup()
    for bottom, top, radius in ((0.06, 0.55, 0.5), (0.36, 0.8, 0.36), (0.64, 1.0, 0.22)):
        points = np.concatenate([ring * radius + [0, 0, bottom], [[0, 0, top]]])
        faces = np.array([[k, (k + 1) % sides, sides] for k in range(sides)])
        soup.add(points, faces)
    return soup.mesh()


def forest(rng, terrain, houses):
    soup = Soup()
    points, faces = fir()
    planted = 0
    while planted < TREES:
        x, y = rng.uniform(-620, 620), rng.uniform(-680, 780)
        off = abs(x - terrain.river(y))
        dense = 0.25 if off < 95 else np.exp(-(((off - 150) / 130) ** 2))
        clear = np.hypot(*(houses - [x, y]).T).min() > 20 and np.hypot(x - 40, y + 640) > 60
        if rng.uniform() > dense or not clear:
            continue
        size = rng.uniform(11, 24)
        at = np.array([x, y, terrain.height(x, y) - 0.6])
        soup.add(place(points, at, [size * 0.42, size * 0.42, size], rng.uniform(0, 6)), faces)
        planted += 1
    return soup


def write_ply(name, points, faces):
    rows = np.empty(len(faces), dtype=[("n", "u1"), ("v", "<i4", 3)])
    rows["n"], rows["v"] = 3, faces
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(points)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    (HERE / name).write_bytes(header.encode() + points.astype("<f4").tobytes() + rows.tobytes())


def write_sky(width=64, height=32):
    """Radiance map, latitude and longitude: pale horizon, blue zenith, haze below the horizon."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    theta = np.pi * (np.arange(height)[:, None] + 0.5) / height
    up = np.cos(theta)
    rise = np.clip(up, 0, 1) ** 0.55
    horizon, zenith = np.array([0.95, 0.93, 0.9]), np.array([0.2, 0.36, 0.72])
    ground = horizon * (0.3 + 0.7 * np.exp(np.minimum(up, 0) / 0.25)[..., None])  # haze below
    sky = horizon * (1 - rise[..., None]) + zenith * rise[..., None]
    image = np.where(up[..., None] >= 0, sky, ground) * np.ones((1, width, 1))
    mi.Bitmap(image.astype(np.float32)).write(str(HERE / "sky.exr"))


def main():
    rng = np.random.default_rng(20)
    terrain = Terrain(rng)
    walls, roofs, houses = village(rng, terrain)
    write_ply("terrain.ply", *terrain.mesh())
    write_ply("walls.ply", *walls.mesh())
    write_ply("roofs.ply", *roofs.mesh())
    write_ply("trees.ply", *forest(rng, terrain, houses).mesh())
    write_sky()


if __name__ == "__main__":
    main()
