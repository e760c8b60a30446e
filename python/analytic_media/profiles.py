"""Profiles: where the matter is, as a relative density along rays, in closed form.

Lengths are in scene units. A point is `x`, the origin of a ray `o`, its direction `d` (a unit
vector), a distance along it `t`. An altitude is `up · x - base_height`.

Arrays broadcast like those of NumPy; points and directions have the shape (..., 3), all else
(...). If every floating-point array among the arguments is float32, so is the result; otherwise
it is float64. Python numbers do not count. ValueError names the argument that is outside its
range, its value and the range.

The C library says which parameters a profile has, and checks them. Equation numbers are those
of "Sampling Analytic Participating Media".
"""

from collections.abc import Mapping, Sequence
from functools import partial
from inspect import Parameter, Signature
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _gradients, _native

Result = np.floating | np.ndarray
Value = float | tuple[float, float, float]


def _default(parameter: _native.Parameter):
    if parameter.default is None:
        return Parameter.empty
    return parameter.default if parameter.size > 1 else parameter.default[0]


def _value(parameter: _native.Parameter, values: list[float]) -> Value:
    own = tuple(values[parameter.offset : parameter.offset + parameter.size])
    return own if parameter.size > 1 else own[0]


def _numbers(parameter: _native.Parameter, value) -> list[float]:
    expected = "a number" if parameter.size == 1 else f"{parameter.size} numbers"
    shape = () if parameter.size == 1 else (parameter.size,)
    array = _arrays.real(value)
    if array is None or array.shape != shape:
        raise ValueError(f"{parameter.name} must be {expected}, got {value!r}")
    return array.astype(np.float64).ravel().tolist()


class Profile:
    """A relative density: dimensionless, 0 or more, known along every ray.

    Profiles cannot be changed, compare by value, and can be pickled. Parameters are keywords.
    """

    __slots__ = ("_model", "_parameters")
    _kind: _native.Kind

    def __init_subclass__(cls, kind: str):
        cls._kind = _native.kind(kind)
        ordered = sorted(cls._kind.parameters, key=lambda p: p.default is not None)
        cls.__signature__ = Signature(
            [Parameter(p.name, Parameter.KEYWORD_ONLY, default=_default(p)) for p in ordered]
        )

    def __init__(self, **parameters: float | Sequence[float]):
        bound = self._bind(parameters)
        values: list[float] = []
        for parameter in self._kind.parameters:
            values += _numbers(parameter, bound[parameter.name])
        object.__setattr__(self, "_model", _native.profile(self._kind.number, values))
        kept = {p.name: _value(p, values) for p in self._kind.parameters}
        ordered = {name: kept[name] for name in self.__signature__.parameters}
        object.__setattr__(self, "_parameters", MappingProxyType(ordered))

    @classmethod
    def _bind(cls, parameters: dict) -> dict:
        """The parameters with their defaults; TypeError if one is unknown or missing."""
        known = cls.__signature__.parameters
        for name in parameters:
            if name not in known:
                has = ", ".join(known) or "none"
                raise TypeError(f"{cls.__name__} has no parameter {name!r}; its parameters: {has}")
        given = {name: p.default for name, p in known.items()} | parameters
        for name, value in given.items():
            if value is Parameter.empty:
                raise TypeError(f"{cls.__name__} needs the parameter {name!r}")
        return given

    @property
    def parameters(self) -> Mapping[str, Value]:
        """Names and values of the parameters."""
        return self._parameters

    # ---- Questions

    def density(self, x: ArrayLike) -> Result:
        """Relative density at the points `x` (..., 3); dimensionless, >= 0."""
        return _arrays.answer(self._model, "density", _arrays.point("x", x))

    def column(self, o: ArrayLike, d: ArrayLike, t: ArrayLike) -> Result:
        """Column: the integral of the density from `o` to the distance `t` >= 0; a length.

        `t` may be infinite, and so may the column. It does not decrease with `t`.
        """
        return _arrays.answer(self._model, "column", *_arrays.segment(o, d, t))

    def column_value_and_gradient(
        self, o: ArrayLike, d: ArrayLike, t: ArrayLike
    ) -> tuple[Result, dict[str, Result]]:
        """The column, and its derivatives by every parameter, by `o`, `d` and `t`.

        A mapping from names to arrays: of the shape of the column, with an axis of length 3 more
        for vectors. `d` (and `up`, and axes) count as free vectors: the derivatives are those of
        the integral of the density over o + s d, 0 <= s <= t; to turn a direction, take the part
        perpendicular to it. All are 0 where the column is infinite.
        """
        return self._with_gradient("column", *_arrays.segment(o, d, t))

    def inv_column(self, o: ArrayLike, d: ArrayLike, column: ArrayLike) -> Result:
        """The smallest distance at which the ray has gathered `column`, a length >= 0.

        Infinite if it never does.
        """
        ray = _arrays.point("o", o), _arrays.direction("d", d)
        return _arrays.answer(self._model, "inv_column", *ray, _arrays.amount("column", column))

    def inv_reached_column(self, o: ArrayLike, d: ArrayLike, column: ArrayLike) -> Result:
        """`inv_column` of a column that the ray is known to gather, at less cost.

        Anything where it does not.
        """
        ray = _arrays.point("o", o), _arrays.direction("d", d)
        amount = _arrays.amount("column", column)
        return _arrays.answer(self._model, "inv_reached_column", *ray, amount)

    def inv_column_value_and_gradient(
        self, o: ArrayLike, d: ArrayLike, column: ArrayLike
    ) -> tuple[Result, dict[str, Result]]:
        """The distance `inv_column`, and its derivatives: by the parameters, `o`, `d`, `column`.

        By the implicit function theorem, -(those of the column) / density. All are 0 where the
        distance is infinite, and where there is no matter at that distance.
        """
        ray = _arrays.point("o", o), _arrays.direction("d", d)
        return self._with_gradient("inv_column", *ray, _arrays.amount("column", column))

    def _with_gradient(self, question, *arguments):
        parts = [*_gradients.parameters(self._kind), *_gradients.of_ray(arguments[-1].name)]
        width = (1 + _gradients.size(parts),)
        question = f"{question}_value_and_gradient"
        rows = _arrays.answer(self._model, question, *arguments, width=width)
        return rows[..., 0][()], _gradients.split(rows[..., 1:], parts)

    def bounds(self, o: ArrayLike, d: ArrayLike, t: ArrayLike) -> tuple[Result, Result]:
        """(inf, sup) of the density on the segment of length `t` >= 0, which may be infinite.

        True bounds: rounding cannot put the density outside them.
        """
        return _arrays.answer(self._model, "bounds", *_arrays.segment(o, d, t), outputs=2)

    def bounds_box(self, lo: ArrayLike, hi: ArrayLike) -> tuple[Result, Result]:
        """(inf, sup) of the density in axis-aligned boxes; true bounds, as above.

        `lo` and `hi` (..., 3) are opposite corners; their coordinates may be infinite.
        """
        corners = _arrays.corner("lo", lo), _arrays.corner("hi", hi)
        return _arrays.answer(self._model, "bounds_in_box", *corners, outputs=2)

    # ---- Values, not objects

    def __setattr__(self, name, value):
        raise AttributeError(f"profiles cannot be changed: make a new {type(self).__name__}")

    __delattr__ = __setattr__

    def __repr__(self):
        listed = ", ".join(f"{name}={value!r}" for name, value in self.parameters.items())
        return f"{type(self).__name__}({listed})"

    def __eq__(self, other):
        if not isinstance(other, Profile):
            return NotImplemented
        return type(self) is type(other) and self.parameters == other.parameters

    def __hash__(self):
        return hash((type(self), *self.parameters.values()))

    def __reduce__(self):
        return partial(type(self), **self.parameters), ()


class Constant(Profile, kind="constant"):
    """Density 1 everywhere (Eq. 25-27)."""

    __slots__ = ()


class Linear(Profile, kind="linear"):
    """Density affine in altitude, clamped: max(0, density + gradient · altitude) (Eq. 28-31).

    * `gradient`: change of density per altitude, 1/length, finite
    * `density`: density at the base height, finite; negative is empty there
    * `base_height`: where the altitude is 0, length, finite
    * `up`: direction in which altitude grows, unit vector
    """

    __slots__ = ()


class Exponential(Profile, kind="exponential"):
    """Density exponential in altitude: exp(-altitude / scale_height) (Eq. 32-35).

    * `scale_height`: altitude over which the density falls by a factor e, length, > 0
    * `base_height`: where the density is 1, length, finite
    * `up`: direction in which altitude grows, unit vector
    """

    __slots__ = ()


class Spherical(Profile, kind="spherical"):
    """Density exponential in altitude above a sphere: exp(-altitude / scale_height) (Eq. 36-48).

    There is no ground: below the sphere the density goes on growing.

    * `center`: centre of the planet, point, finite
    * `radius`: where the density is 1, length, > 0
    * `scale_height`: altitude over which the density falls by a factor e, length, > 0
    """

    __slots__ = ()


class Tent(Profile, kind="tent"):
    """Density piecewise linear in altitude above a sphere, as that of ozone:
    max(0, 1 - |altitude - height| / width).

    * `center`: centre of the planet, point, finite
    * `radius`: where the altitude is 0, length, > 0
    * `height`: altitude at which the density is 1, length, finite
    * `width`: altitude above and below it where the density is 0, length, > 0
    """

    __slots__ = ()


class Gaussian(Profile, kind="gaussian"):
    """Isotropic Gaussian: exp(-|x - center|² / (2 sigma²)).

    * `center`: point where the density is 1, finite
    * `sigma`: standard deviation, length, > 0
    """

    __slots__ = ()


class AnisotropicGaussian(Profile, kind="anisotropic_gaussian"):
    """Gaussian with three axes: exp(-(u² + v² + w²) / 2), u = dot(x - center, axis_u) / |axis_u|².

    * `center`: point where the density is 1, finite
    * `axis_u`, `axis_v`, `axis_w`: orthogonal; their lengths are the standard deviations, > 0
    """

    __slots__ = ()


class RadialGaussian(Profile, kind="radial_gaussian"):
    """Gaussian in the distance r from a centre: exp(-(r² - radius²) / (2 radius scale_height)).

    Touches `Spherical` at the radius, in value and slope, and has a closed inverse.

    * `center`: centre of the planet, point, finite
    * `radius`: where the density is 1, length, > 0
    * `scale_height`: altitude over which the density falls by a factor e there, length, > 0
    """

    __slots__ = ()
