"""Planets: altitudes, and where rays meet the ground and the top of the atmosphere.

Float32 keeps metres apart at the scale of a planet, best where the origin of coordinates is on the
surface and the centre on an axis. Arrays broadcast as in `profiles`.
"""

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _native

Result = np.floating | np.ndarray


class Planet:
    """A sphere that altitudes are counted from.

    * `center`: a point, finite
    * `radius`: length, > 0
    """

    __slots__ = ("_center", "_model", "_radius")

    def __init__(self, center: ArrayLike, radius: float):
        centers, radii = _arrays.real(center), _arrays.real(radius)
        if centers is None or centers.shape != (3,):
            raise ValueError(f"center must be 3 numbers, got {center!r}")
        if radii is None or radii.shape != ():
            raise ValueError(f"radius must be a number, got {radius!r}")
        self._center = tuple(centers.astype(np.float64).tolist())
        self._radius = float(radii)
        self._model = _native.planet(self._center, self._radius)

    @property
    def center(self) -> tuple[float, float, float]:
        """The centre, a point."""
        return self._center

    @property
    def radius(self) -> float:
        """The radius, a length."""
        return self._radius

    def altitude(self, x: ArrayLike) -> Result:
        """Altitude of the points `x` (..., 3): a length, negative below the surface."""
        return _arrays.answer(self._model, "altitude", _arrays.point("x", x))

    def horizon(self, x: ArrayLike) -> Result:
        """Cosine of the zenith angle of the horizon seen from `x` (..., 3).

        Rays that lead further down hit the planet. 0 on the surface and below it.
        """
        return _arrays.answer(self._model, "horizon", _arrays.point("x", x))

    def hit(self, o: ArrayLike, d: ArrayLike) -> Result:
        """Distance at which rays enter the planet; infinite if they never do.

        From the surface or below it, a ray that leads down is in at once, one that leads up leaves.
        """
        return _arrays.answer(self._model, "hit", _arrays.point("o", o), _arrays.direction("d", d))

    def shell(self, o: ArrayLike, d: ArrayLike, altitude: ArrayLike) -> tuple[Result, Result]:
        """(enter, leave): where rays are below `altitude`; infinite if they never are.

        `enter` is 0 where a ray starts inside.
        """
        ray = _arrays.point("o", o), _arrays.direction("d", d)
        height = _arrays.number("altitude", altitude)
        return _arrays.answer(self._model, "shell", *ray, height, outputs=2)

    def __repr__(self):
        return f"Planet(center={self._center!r}, radius={self._radius!r})"
