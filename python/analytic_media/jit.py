"""The same questions for Dr.Jit, and for any other library that records or differentiates.

The formulas of the C library run operation by operation on the arrays of a *host*, so they
become part of its own graph: fused into its kernels, differentiated by its own rules.

    H = mi.Float(20); dr.enable_grad(H)
    p = am.jit.Profile(am.Exponential(scale_height=20), scale_height=H)
    dr.backward(p.column(o, d, t))                        # H.grad

    fog = am.jit.Medium([(p, sigma_t), (am.Constant(), 0.01)])
    fog.transmittance(o, d, t)

Any Dr.Jit float type of a JIT backend will do, with or without derivatives; points and
directions are `Point3f`, `Vector3f`, or lists or tuples of three numbers or arrays. Numbers
become literals of the kernel: wrap in `dr.opaque` what changes from one launch to the next.
Nothing is evaluated, so what arrays hold is not checked: outside their range, results are NaN
or meaningless.

Another library takes part as a `Host`, for example `Host(np, np.float64, digits=53)`.
"""

import math
import operator
import sys
from collections.abc import Callable, Iterable, Sequence
from itertools import chain
from numbers import Real
from typing import Any

from . import _native, profiles, scattering

Array = Any  # a number of the host
Point = Any  # three of them: a vector of Dr.Jit, a list or a tuple


class Host:
    """What a library offers to compute formulas: operators, and a namespace of functions.

    * `namespace`: has sqrt, exp, log, abs, minimum, maximum and, unless given, where
    * `literal`: makes a number of the host from a Python number
    * `digits`: bits of the significand, 24 (single precision) or 53 (double)
    * `select(mask, a, b)`: a where the mask is set, else b
    * `fma(a, b, c)`: a · b + c, with one rounding if the library can
    * `detach(a)`: the value of a without its derivatives
    """

    neg = staticmethod(operator.neg)
    add = staticmethod(operator.add)
    sub = staticmethod(operator.sub)
    mul = staticmethod(operator.mul)
    div = staticmethod(operator.truediv)
    less = staticmethod(operator.lt)
    less_equal = staticmethod(operator.le)
    mask_and = staticmethod(operator.and_)
    mask_or = staticmethod(operator.or_)
    mask_not = staticmethod(operator.invert)

    def __init__(
        self,
        namespace: Any,
        literal: Callable[[float], Array],
        digits: int,
        *,
        select: Callable | None = None,
        fma: Callable = lambda a, b, c: a * b + c,
        detach: Callable = lambda a: a,
    ):
        self.sqrt, self.exp, self.log = namespace.sqrt, namespace.exp, namespace.log
        self.abs, self.min, self.max = namespace.abs, namespace.minimum, namespace.maximum
        self.literal = literal
        self.digits = digits
        self.select = select or namespace.where
        self.fma = fma
        self.detach = detach


class Profile:
    """A profile with the questions of `analytic_media.Profile`, answered by a host.

    `values` replace parameters of `profile` by arrays of the host; they are not checked.
    `profile` may be a class, such as `am.Exponential`, if `values` are all that it needs.
    `host` is Dr.Jit, in the float type of the arguments, unless another one is given.
    Raises TypeError for a parameter that the profile does not have.
    """

    def __init__(
        self,
        profile: profiles.Profile | type[profiles.Profile],
        *,
        host: Host | None = None,
        **values: Array,
    ):
        given = {} if isinstance(profile, type) else profile.parameters
        self._kind = profile._kind
        self._values = profile._bind({**given, **values})
        self._host = host

    def density(self, x: Point) -> Array:
        """Relative density at the point `x`; dimensionless, >= 0."""
        return self._ask("density", _point("x", x))[0]

    def column(self, o: Point, d: Point, t: Array) -> Array:
        """Column from `o` to the distance `t` (0 to infinity), a length."""
        return self._ask("column", *_segment(o, d, t))[0]

    def inv_column(self, o: Point, d: Point, column: Array) -> Array:
        """The smallest distance at which the ray has gathered `column`; infinite if never."""
        return self._ask("inv_column", _point("o", o), _point("d", d), _number("column", column))[0]

    def inv_reached_column(self, o: Point, d: Point, column: Array) -> Array:
        """`inv_column` of a column that the ray is known to gather, at less cost.

        Anything where it does not. Has no derivatives.
        """
        inputs = _point("o", o), _point("d", d), _number("column", column)
        return self._ask("inv_reached_column", *inputs)[0]

    def bounds(self, o: Point, d: Point, t: Array) -> tuple[Array, Array]:
        """(inf, sup) of the density on the segment of length `t`."""
        return self._ask("bounds", *_segment(o, d, t), outputs=2)

    def bounds_box(self, lo: Point, hi: Point) -> tuple[Array, Array]:
        """(inf, sup) of the density in the box with the opposite corners `lo` and `hi`."""
        corners = _point("lo", lo), _point("hi", hi)
        return self._ask("bounds_in_box", *corners, outputs=2)

    def _flat(self) -> list[Array]:
        """The values of the parameters, one after the other."""
        flat: list[Array] = []
        for parameter in self._kind.parameters:
            value = self._values[parameter.name]
            flat += (_number if parameter.size == 1 else _point)(parameter.name, value)
        return flat

    def _ask(self, question, *inputs, outputs=1):
        host = self._host or _drjit_host(chain(self._flat(), *inputs))
        recording = _native.Recording(host)
        model = recording.profile(self._kind.number, _lift(host, self._flat()))
        results = recording.ask(model, question, [_lift(host, i) for i in inputs], outputs, 1)
        return tuple(result for (result,) in results)


class Medium:
    """A medium with the questions of `analytic_media.Medium`, answered by a host.

    `components` are pairs (profile, sigma_t): a profile of this module or a plain one, and a
    number, an array of the host, or a sequence of them, one per channel. With channels, results
    are lists, one array per channel. `host` is as for `Profile`; sigma_t is not checked.
    """

    def __init__(
        self,
        components: Iterable[tuple[Profile | profiles.Profile, Array | Sequence[Array]]],
        *,
        host: Host | None = None,
    ):
        pairs = list(components)
        if not pairs:
            raise ValueError("components must have at least one (profile, sigma_t), got none")
        self._profiles = [p if isinstance(p, Profile) else Profile(p) for p, _ in pairs]
        rows = [_components(sigma_t) for _, sigma_t in pairs]
        if len({None if row is None else len(row) for row in rows}) != 1:
            raise ValueError("sigma_t must have the same number of channels in all components")
        self._scalar = rows[0] is None
        self._sigma_t = [
            [s] if row is None else row for row, (_, s) in zip(rows, pairs, strict=True)
        ]
        self._host = host

    def extinction(self, x: Point) -> Array | list[Array]:
        """Attenuation coefficient at the point `x`, 1/length."""
        return self._ask("extinction", _point("x", x))[0]

    def optical_depth(self, o: Point, d: Point, t: Array) -> Array | list[Array]:
        """Optical depth from `o` to the distance `t` (0 to infinity), dimensionless."""
        return self._ask("optical_depth", *_segment(o, d, t))[0]

    def transmittance(self, o: Point, d: Point, t: Array) -> Array | list[Array]:
        """exp(-optical depth)."""
        return self._ask("transmittance", *_segment(o, d, t))[0]

    def opacity(self, o: Point, d: Point, t: Array) -> Array | list[Array]:
        """1 - transmittance."""
        return self._ask("opacity", *_segment(o, d, t))[0]

    def free_flight(self, o: Point, d: Point, t_max: Array, tau: Array, channel: int = 0) -> Array:
        """The distance up to `t_max` at which the ray has gathered `tau`; infinite if never."""
        ray = _point("o", o), _point("d", d)
        limits = _number("t_max", t_max), _number("tau", tau)
        return self._ask("free_flight", operator.index(channel), *ray, *limits, single=True)[0]

    def pdf(self, o: Point, d: Point, t: Array) -> Array | list[Array]:
        """Probability density of the free flight `t`, 1/length."""
        return self._ask("pdf", *_segment(o, d, t))[0]

    def pdf_within(self, o: Point, d: Point, t_max: Array, t: Array) -> Array | list[Array]:
        """`pdf` of flights that must end before `t_max`."""
        o, d, t = _segment(o, d, t)
        return self._ask("pdf_within", o, d, _number("t_max", t_max), t)[0]

    def bounds(self, o: Point, d: Point, t: Array) -> tuple:
        """(minorant, majorant) of the extinction on the segment of length `t`, 1/length."""
        return self._ask("bounds", *_segment(o, d, t), outputs=2)

    def bounds_box(self, lo: Point, hi: Point) -> tuple:
        """(minorant, majorant) of the extinction in the box between `lo` and `hi`, 1/length."""
        corners = _point("lo", lo), _point("hi", hi)
        return self._ask("bounds_in_box", *corners, outputs=2)

    def _ask(self, question, *inputs, outputs=1, single=False):
        parameters = [profile._flat() for profile in self._profiles]
        arrays = [i for i in inputs if not isinstance(i, int)]
        host = self._host or _drjit_host(chain(*parameters, *self._sigma_t, *arrays))
        recording = _native.Recording(host)
        parts = [
            recording.profile(profile._kind.number, _lift(host, values))
            for profile, values in zip(self._profiles, parameters, strict=True)
        ]
        model = recording.medium(parts, [_lift(host, row) for row in self._sigma_t])
        lifted = [i if isinstance(i, int) else _lift(host, i) for i in inputs]
        width = 1 if single else len(self._sigma_t[0])
        results = recording.ask(model, question, lifted, outputs, width)
        return tuple(r[0] if single or self._scalar else r for r in results)


def sunlit_fog(
    profile: Profile | profiles.Profile,
    sigma_s: Array | Sequence[Array],
    sigma_t: Array | Sequence[Array],
    eye: Point,
    direction: Point,
    t: Array,
    sun_direction: Point,
    phase: Array | Callable = 1 / (4 * math.pi),
    *,
    host: Host | None = None,
) -> Array | list[Array]:
    """`analytic_media.sunlit_fog`, answered by a host; with channels a list, one array each.

    A callable `phase` gets the cosine as an array of the host.
    """
    part = profile if isinstance(profile, Profile) else Profile(profile)
    sigmas = {"sigma_s": _components(sigma_s), "sigma_t": _components(sigma_t)}
    if len({None if row is None else len(row) for row in sigmas.values()}) != 1:
        raise ValueError("sigma_s and sigma_t must have the same number of channels")
    scalar = sigmas["sigma_t"] is None
    scattering, attenuation = ([sigma_s], [sigma_t]) if scalar else sigmas.values()
    o, d, length = _point("eye", eye), _point("direction", direction), _number("t", t)
    sun = _point("sun_direction", sun_direction)
    value = phase(sum(a * b for a, b in zip(d, sun, strict=True))) if callable(phase) else phase
    inputs = [o, d, length, sun, _number("phase", value)]
    host = host or part._host or _drjit_host(chain(part._flat(), scattering, attenuation, *inputs))
    recording = _native.Recording(host)
    lifted = recording.profile(part._kind.number, _lift(host, part._flat()))
    model = recording.sunlit_fog(lifted, _lift(host, scattering), _lift(host, attenuation))
    arguments = [_lift(host, i) for i in inputs]
    (radiance,) = recording.ask(model, "radiance", arguments, 1, len(attenuation))
    return radiance[0] if scalar else radiance


class AirLight:
    """A point light in a uniform medium, as `analytic_media.AirLight`, answered by a host.

    The position of the light, coefficients, and the numbers of `phase` and `intensity` may be
    arrays of the host (axes: three of them); they are not checked. Exponents are numbers. With
    channels, radiance is a list, one array per channel.
    """

    def __init__(
        self,
        light: Point,
        sigma_s: Array | Sequence[Array],
        sigma_t: Array | Sequence[Array],
        phase: scattering.Phase = scattering.ISOTROPIC,
        intensity: scattering.Intensity = scattering.ISOTROPIC,
        *,
        host: Host | None = None,
    ):
        self._light = scattering.describe_light(_point("light", light), intensity)
        self._light["axis"] = _point("axis", self._light["axis"])
        self._phase = scattering.describe_phase(phase)
        rows = [_components(sigma) for sigma in (sigma_s, sigma_t)]
        self._scalar = rows == [None, None]
        channels = max(len(row or [None]) for row in rows)
        self._coefficients = [
            [sigma] * channels if row is None else row
            for row, sigma in zip(rows, (sigma_s, sigma_t), strict=True)
        ]
        if any(len(row) != channels for row in self._coefficients):
            raise ValueError("sigma_s and sigma_t must have the same number of channels")
        self._host = host

    def radiance(self, o: Point, d: Point, t0: Array, t1: Array) -> Array | list[Array]:
        """Radiance towards the point at `t0` of the segment from `t0` to `t1` (to infinity)."""
        inputs = _point("o", o), _point("d", d), _number("t0", t0), _number("t1", t1)
        light, phase = dict(self._light), dict(self._phase)
        angles = light["cutoff_angle"], light["beam_width"], phase["g"]
        values = chain(light["position"], light["axis"], angles, *self._coefficients, *inputs)
        host = self._host or _drjit_host(values)
        for name in ("position", "axis"):
            light[name] = _lift(host, light[name])
        light["cutoff_angle"], light["beam_width"], phase["g"] = _lift(host, angles)
        recording = _native.Recording(host)
        coefficients = [_lift(host, row) for row in self._coefficients]
        model = recording.airlight(light, phase, *coefficients)
        lifted = [_lift(host, i) for i in inputs]
        (radiance,) = recording.ask(model, "radiance", lifted, 1, len(coefficients[0]))
        return radiance[0] if self._scalar else radiance


def special(function: str, *arguments: Array, host: Host | None = None) -> Array | list[Array]:
    """A function of `analytic_media.special` or `analytic_media.coefficients`, answered by a host:
    `special("chapman", z, mu)`.

    A complex one, "expint_ei" or "expint_ei_scaled", has the real and the imaginary part as
    arguments, and as a list of results. Arguments are not checked. Raises AttributeError for a
    function that does not exist.
    """
    inputs = [_number(f"argument {i}", value) for i, value in enumerate(arguments)]
    host = host or _drjit_host(chain(*inputs))
    recording = _native.Recording(host)
    lifted = [_lift(host, i) for i in inputs]
    width = 2 if function.startswith("expint_ei") else 1
    (value,) = recording.ask(None, function, lifted, 1, width)
    return value if width > 1 else value[0]


# ---- Numbers, points, channels ---------------------------------------------------------------


def _components(value) -> list[Array] | None:
    """The components of a list, a tuple or a vector of Dr.Jit; None for a number."""
    if isinstance(value, list | tuple):
        return list(value)
    drjit = sys.modules.get("drjit")
    if drjit and drjit.is_array_v(value) and drjit.size_v(value) != drjit.Dynamic:
        return list(value)
    return None


def _point(name: str, value: Point) -> list[Array]:
    components = _components(value)
    if components is None or len(components) != 3:
        got = type(value).__name__ if components is None else len(components)
        raise ValueError(f"{name} must have three components, got {got}")
    return components


def _number(name: str, value: Array) -> list[Array]:
    components = _components(value)
    if components is not None:
        raise ValueError(f"{name} must be a number, got {len(components)} components")
    return [value]


def _segment(o: Point, d: Point, t: Array) -> tuple[list[Array], ...]:
    return _point("o", o), _point("d", d), _number("t", t)


def _lift(host: Host, values: Iterable[Array]) -> tuple[Array, ...]:
    return tuple(host.literal(float(v)) if isinstance(v, Real) else v for v in values)


def _drjit_host(values: Iterable[Array]) -> Host:
    """Dr.Jit, in the float type of the arrays among `values`."""
    import drjit as dr

    types = {type(value) for value in values if dr.is_jit_v(value)}
    if not types:
        raise TypeError(
            "there must be an array of a JIT backend of Dr.Jit among the arguments or "
            "parameters, or a host; for numbers and NumPy ask the profile or medium itself"
        )
    if len({dr.type_v(t) for t in types if dr.is_float_v(t)}) != 1:
        names = ", ".join(sorted(f"{t.__module__}.{t.__name__}" for t in types))
        raise TypeError(f"arrays must be of one precision, single or double, got {names}")
    number = dr.expr_t(*types)
    digits = 53 if dr.type_v(number) == dr.VarType.Float64 else 24
    return Host(dr, number, digits, select=dr.select, fma=dr.fma, detach=dr.detach)
