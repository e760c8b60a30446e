"""Media: sums of profiles, each with an attenuation coefficient per channel."""

from collections.abc import Iterable, Sequence
from operator import index

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _gradients, _native
from .profiles import Profile, Result

Coefficient = float | Sequence[float]


class Medium:
    """A sum of components (profile, sigma_t).

    `sigma_t` is the attenuation coefficient at relative density 1, in 1/length, finite and
    >= 0: a number, or a sequence with one per channel (colour, wavelength); all components have
    the same number of them. Results then have one axis more, of that length, at the end.

    Arguments and results are those of profiles: see `analytic_media.profiles`. Equation numbers
    are those of "Sampling Analytic Participating Media".

        fog = Medium([(Exponential(scale_height=20), 0.1), (Constant(), 0.01)])
        fog.transmittance(o=(0, 0, 2), d=(1, 0, 0), t=[10, 20, 30])
    """

    __slots__ = ("_components", "_model", "_width")

    def __init__(self, components: Iterable[tuple[Profile, Coefficient]]):
        pairs = [_component(component) for component in components]
        if not pairs:
            raise ValueError("components must have at least one (profile, sigma_t), got none")
        width = pairs[0][1].shape
        for number, (_, sigma_t) in enumerate(pairs):
            if sigma_t.shape != width:
                raise ValueError(
                    f"sigma_t must have the same shape in all components, got {width} in the "
                    f"first and {sigma_t.shape} in component {number}"
                )
        rows = np.array([sigma_t.reshape(-1) for _, sigma_t in pairs])
        model = _native.medium([profile._model for profile, _ in pairs], rows)
        kept = tuple((p, tuple(s.tolist()) if s.ndim else s.item()) for p, s in pairs)
        for name, value in (("_components", kept), ("_model", model), ("_width", width)):
            object.__setattr__(self, name, value)

    @property
    def components(self) -> tuple[tuple[Profile, float | tuple[float, ...]], ...]:
        """The pairs (profile, sigma_t)."""
        return self._components

    @property
    def channels(self) -> int | None:
        """Number of channels; None if sigma_t is a number."""
        return self._width[0] if self._width else None

    # ---- Questions

    def extinction(self, x: ArrayLike) -> Result:
        """Attenuation coefficient at the points `x` (..., 3), 1/length."""
        return self._answer("extinction", _arrays.point("x", x))

    def optical_depth(self, o: ArrayLike, d: ArrayLike, t: ArrayLike) -> Result:
        """Optical depth from `o` to the distance `t` >= 0 (Eq. 10); dimensionless.

        `t` may be infinite, and so may the optical depth. It does not decrease with `t`.
        """
        return self._answer("optical_depth", *_arrays.segment(o, d, t))

    def optical_depth_value_and_gradient(
        self, o: ArrayLike, d: ArrayLike, t: ArrayLike
    ) -> tuple[Result, dict]:
        """The optical depth, and its derivatives by everything that it depends on.

        A mapping: "o", "d" and "t" lead to arrays of the shape of the optical depth, with an axis
        of length 3 more for vectors; "components" leads to a tuple with one mapping per
        component, from "sigma_t" and the names of the parameters of its profile to such arrays.
        "sigma_t" is the derivative by the coefficient of the same channel; those of other
        channels do not count. See `Profile.column_value_and_gradient` about vectors. All are 0
        where the optical depth is infinite.
        """
        question = "optical_depth_value_and_gradient"
        return self._with_gradient(question, self._width, *_arrays.segment(o, d, t))

    def transmittance(self, o: ArrayLike, d: ArrayLike, t: ArrayLike) -> Result:
        """exp(-optical depth) (Eq. 11), in [0, 1]."""
        return self._answer("transmittance", *_arrays.segment(o, d, t))

    def opacity(self, o: ArrayLike, d: ArrayLike, t: ArrayLike) -> Result:
        """1 - transmittance (Eq. 9), in [0, 1]; exact for thin media too."""
        return self._answer("opacity", *_arrays.segment(o, d, t))

    def free_flight(
        self, o: ArrayLike, d: ArrayLike, t_max: ArrayLike, tau: ArrayLike, channel: int = 0
    ) -> Result:
        """The smallest distance at which the ray has gathered the optical depth `tau` >= 0.

        Infinite, no collision, if that is beyond `t_max` >= 0. For a random flight
        `tau = -log1p(-u)` with u uniform in [0, 1) (Eq. 15-24). `channel` is the one that `tau`
        belongs to. Shape (...), whatever the number of channels.
        """
        return _arrays.answer(self._model, "free_flight", *self._flight(o, d, t_max, tau, channel))

    def free_flight_value_and_gradient(
        self, o: ArrayLike, d: ArrayLike, t_max: ArrayLike, tau: ArrayLike, channel: int = 0
    ) -> tuple[Result, dict]:
        """The distance `free_flight`, and its derivatives.

        As those of `optical_depth_value_and_gradient`, with "tau" in place of "t" and without an
        axis for channels. By the implicit function theorem, -(those of the optical depth) /
        extinction. All are 0 where there is no collision. `t_max` does not move a collision.
        """
        arguments = self._flight(o, d, t_max, tau, channel)
        return self._with_gradient("free_flight_value_and_gradient", (), *arguments)

    def _flight(self, o, d, t_max, tau, channel):
        channels = self.channels or 1
        if not 0 <= index(channel) < channels:
            raise ValueError(f"channel must be from 0 to {channels - 1}, got {channel}")
        ray = _arrays.point("o", o), _arrays.direction("d", d)
        limits = _arrays.amount("t_max", t_max), _arrays.amount("tau", tau)
        return index(channel), *ray, *limits

    def pdf(self, o: ArrayLike, d: ArrayLike, t: ArrayLike) -> Result:
        """Probability density of the free flight `t` >= 0, 1/length; 0 for an infinite one.

        extinction · transmittance. The probability of no collision is the transmittance.
        """
        return self._answer("pdf", *_arrays.segment(o, d, t))

    def pdf_within(self, o: ArrayLike, d: ArrayLike, t_max: ArrayLike, t: ArrayLike) -> Result:
        """`pdf` of flights that must end before `t_max`: over the opacity up to there."""
        o, d, t_max = _arrays.segment(o, d, t_max)
        limit = t_max._replace(name="t_max")
        return self._answer("pdf_within", o, d, limit, _arrays.amount("t", t))

    def bounds(self, o: ArrayLike, d: ArrayLike, t: ArrayLike) -> tuple[Result, Result]:
        """(minorant, majorant) of the extinction on the segment of length `t` >= 0, 1/length."""
        return self._answer("bounds", *_arrays.segment(o, d, t), outputs=2)

    def bounds_box(self, lo: ArrayLike, hi: ArrayLike) -> tuple[Result, Result]:
        """(minorant, majorant) of the extinction in axis-aligned boxes, 1/length.

        `lo` and `hi` (..., 3) are opposite corners; their coordinates may be infinite.
        """
        corners = _arrays.corner("lo", lo), _arrays.corner("hi", hi)
        return self._answer("bounds_in_box", *corners, outputs=2)

    def _with_gradient(self, question, width, *arguments):
        components = [
            [("sigma_t", 1), *_gradients.parameters(profile._kind)]
            for profile, _ in self.components
        ]
        ray = _gradients.of_ray(arguments[-1].name)
        sizes = [_gradients.size(parts) for parts in [*components, ray]]
        width = (*width, 1 + sum(sizes))
        rows = _arrays.answer(self._model, question, *arguments, width=width)
        value, *own, along = np.split(rows, np.cumsum([1, *sizes[:-1]]), axis=-1)
        each = tuple(map(_gradients.split, own, components))
        return value[..., 0][()], {"components": each, **_gradients.split(along, ray)}

    def _answer(self, question, *arguments, outputs=1):
        return _arrays.answer(self._model, question, *arguments, outputs=outputs, width=self._width)

    # ---- Values, not objects

    def __setattr__(self, name, value):
        raise AttributeError("media cannot be changed: make a new Medium")

    __delattr__ = __setattr__

    def __repr__(self):
        return f"Medium({list(self.components)!r})"

    def __eq__(self, other):
        return self.components == other.components if isinstance(other, Medium) else NotImplemented

    def __hash__(self):
        return hash(self.components)

    def __reduce__(self):
        return Medium, (self.components,)


def _component(component) -> tuple[Profile, np.ndarray]:
    try:
        profile, sigma_t = component
    except (TypeError, ValueError):
        message = f"components must be pairs (profile, sigma_t), got {component!r}"
        raise ValueError(message) from None
    if not isinstance(profile, Profile):
        raise ValueError(f"components must begin with a profile, got {profile!r}")
    return profile, _arrays.channels("sigma_t", sigma_t)
