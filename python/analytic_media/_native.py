"""The C library: the only file with pointers.

Declarations come from the header that lies beside the library, so nothing that C says is said
again here. Questions about arrays go through `ask`, those of hosts through a `Recording`.
"""

import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import cffi
import numpy as np

_PACKAGE = Path(__file__).parent
_SOURCE_TREE = _PACKAGE.parents[1]
_LIBRARY = "libanalytic_media.so"
_HEADER = "analytic_media.h"


def declarations(header: str) -> str:
    """What cffi can read of a C header: declarations and numeric constants.

    Conditions are resolved as for a C11 compiler: the header only ever asks for C++ or C23.
    """
    text = re.sub(r"//[^\n]*|/\*.*?\*/", "", header, flags=re.DOTALL)
    kept, taken = [], [True]
    for line in text.splitlines():
        match line.split():
            case ["#if" | "#ifdef", *_]:
                taken.append(False)
            case ["#ifndef", *_]:
                taken.append(True)
            case ["#else"]:
                taken[-1] = not taken[-1]
            case ["#endif"]:
                taken.pop()
            case ["#include", *_] | ["#define", _]:
                pass
            case _ if all(taken):
                kept.append(line)
    # cffi would look for the value of a constant here, not in the library.
    return "\n".join(kept).replace("extern const double", "extern double")


def _find(name: str, places: Sequence[Path]) -> Path:
    for place in places:
        if (place / name).is_file():
            return place / name
    looked = ", ".join(str(place) for place in places)
    raise ImportError(f"{name} not found in {looked}: run 'make build' or 'cargo build --release'")


def _library() -> Path:
    chosen = os.environ.get("ANALYTIC_MEDIA_LIBRARY")
    if chosen is None:
        return _find(_LIBRARY, [_PACKAGE / "lib", _SOURCE_TREE / "target" / "release"])
    if not Path(chosen).is_file():
        raise ImportError(f"ANALYTIC_MEDIA_LIBRARY must name a file, got {chosen!r}")
    return Path(chosen).resolve()


def _load() -> tuple[cffi.FFI, Any]:
    ffi = cffi.FFI()
    header = _find(_HEADER, [_PACKAGE / "lib", _SOURCE_TREE / "include"])
    ffi.cdef(declarations(header.read_text(encoding="utf-8")))
    path = _library()
    lib = ffi.dlopen(str(path))
    if lib.am_abi_version() != lib.AM_ABI_VERSION:
        raise ImportError(
            f"{path} has ABI version {lib.am_abi_version()} but {header} is for version "
            f"{lib.AM_ABI_VERSION}: rebuild analytic-media"
        )
    return ffi, lib


_ffi, _lib = _load()


def version() -> str:
    """Version of the library, for example "0.1.0"."""
    return _ffi.string(_lib.am_version()).decode()


def constant(name: str) -> float | tuple[float, ...]:
    """A constant of the header: a number, or several."""
    value = getattr(_lib, name)
    return value if isinstance(value, float) else tuple(value)


def _check(status: int) -> None:
    """ValueError for a bad argument, RuntimeError for a bug, with the library's own text."""
    if status == _lib.AM_STATUS_OK:
        return
    message = _ffi.string(_lib.am_last_error()).decode()
    raise (RuntimeError if status == _lib.AM_STATUS_PANIC else ValueError)(message)


def choices(enum: str) -> dict[str, int]:
    """Names and numbers of an enum of the library, for example "event_rule"."""
    names = sorted(_ffi.typeof(f"enum am_{enum}").elements.items())
    return {name.removeprefix(f"AM_{enum.upper()}_").lower(): number for number, name in names}


# ---- Profiles and media ----------------------------------------------------------------------


class Parameter(NamedTuple):
    """A parameter of a profile: `default` is None if it must be given."""

    name: str
    size: int
    offset: int
    default: tuple[float, ...] | None


class Kind(NamedTuple):
    """A kind of profile, as the library describes it."""

    number: int
    name: str
    parameters: tuple[Parameter, ...]


class Model(NamedTuple):
    """A checked profile or medium: what questions are asked of.

    `name` is the C name, "profile" or "medium"; `owned` keeps alive what `pointer` borrows.
    """

    name: str
    pointer: Any
    owned: tuple = ()


def kind(name: str) -> Kind:
    """The kind of profile called `name`."""
    number = _ffi.new("uint32_t *")
    _check(_lib.am_profile_kind(name.encode(), number))
    return _describe(number[0])


def kinds() -> list[Kind]:
    """All kinds of profile."""
    found = []
    try:
        while True:
            found.append(_describe(len(found)))
    except ValueError:
        return found


def _describe(number: int) -> Kind:
    name = _ffi.new("char[AM_NAME_SIZE]")
    count = _ffi.new("uint32_t *")
    _check(_lib.am_profile_describe(number, _ffi.addressof(name), count))
    parameters = tuple(_parameter(number, index) for index in range(count[0]))
    return Kind(number, _ffi.string(name).decode(), parameters)


def _parameter(number: int, index: int) -> Parameter:
    got = _ffi.new("am_parameter *")
    _check(_lib.am_profile_parameter(number, index, got))
    default = None if got.required else tuple(got.defaults)[: got.size]
    return Parameter(_ffi.string(got.name).decode(), got.size, got.offset, default)


def profile(number: int, values: Sequence[float]) -> Model:
    """A profile with the values of its parameters, one after the other; ValueError if bad."""
    pointer = _ffi.new("am_profile *", {"kind": number, "values": list(values)})
    _check(_lib.am_profile_check(pointer))
    return Model("profile", pointer)


def medium(profiles: Sequence[Model], sigma_t: np.ndarray) -> Model:
    """A medium; `sigma_t` has the shape (components, channels). ValueError if bad."""
    structs = _ffi.new("am_profile[]", [p.pointer[0] for p in profiles])
    numbers = _ffi.new("double[]", sigma_t.ravel().tolist())
    pointer = _ffi.new("am_medium *", [structs, numbers, *sigma_t.shape])
    _check(_lib.am_medium_check(pointer))
    return Model("medium", pointer, (structs, numbers))


def sunlit_fog(profile: Model, sigma_s: np.ndarray, sigma_t: np.ndarray) -> Model:
    """A fog in the sun; coefficients have the shape (channels,). ValueError if bad."""
    numbers = [_ffi.new("double[]", sigma.tolist()) for sigma in (sigma_s, sigma_t)]
    pointer = _ffi.new("am_sunlit_fog *", [profile.pointer[0], *numbers, len(sigma_t)])
    _check(_lib.am_sunlit_fog_check(pointer))
    return Model("sunlit_fog", pointer, tuple(numbers))


def planet(center: Sequence[float], radius: float) -> Model:
    """A sphere that altitudes are counted from; ValueError if bad."""
    pointer = _ffi.new("am_planet *", [list(center), radius])
    _check(_lib.am_planet_check(pointer))
    return Model("planet", pointer)


def airlight(light: dict, phase: dict, sigma_s: np.ndarray, sigma_t: np.ndarray) -> Model:
    """A point light in a uniform medium, with its coefficients per channel; ValueError if bad."""
    numbers = [_ffi.new("double[]", sigma.tolist()) for sigma in (sigma_s, sigma_t)]
    light = light | {"kind": choices("light_kind")[light["kind"]]}
    phase = phase | {"kind": choices("phase_kind")[phase["kind"]]}
    pointer = _ffi.new("am_airlight *", [light, phase, *numbers, len(sigma_s)])
    _check(_lib.am_airlight_check(pointer))
    return Model("airlight", pointer, tuple(numbers))


def radiance_with_phase(model: Model, phase, o, d, t0, t1) -> np.ndarray:
    """Air-light with `phase`, a function of the cosine, in place of the phase function of `model`.

    Raises what `phase` raised.
    """
    errors: list[BaseException] = []

    @_ffi.callback("double(double, void *)")
    def callback(cosine, _):
        try:
            return float(phase(cosine))
        except BaseException as error:  # must not reach C
            errors.append(error)
            return 0.0

    result = np.empty(model.pointer.n_channels)
    points = [_ffi.new("double[]", x.tolist()) for x in (o, d)]
    output = _ffi.cast("double *", result.ctypes.data)
    status = _lib.am_airlight_radiance_with_phase(
        model.pointer, callback, _ffi.NULL, *points, float(t0), float(t1), output
    )
    if errors:
        raise errors[0]
    _check(status)
    return result


def radiance_by(
    model: Model, method: int, terms: int, arrays: Sequence[np.ndarray], output: np.ndarray
) -> None:
    """Air-light by a method of choice, for contiguous origins, directions, t0 and t1 in double
    precision."""
    items = [_strided(Items(a, stride)) for a, stride in zip(arrays, (3, 3, 1, 1), strict=True)]
    out = _ffi.cast("double *", output.ctypes.data)
    n = arrays[-1].size
    _check(_lib.am_airlight_radiance_by(model.pointer, method, terms, n, *items, out))


# ---- Arrays ----------------------------------------------------------------------------------

_FORMS = {np.dtype(np.float32): ("f32", "float"), np.dtype(np.float64): ("f64", "double")}


class Items(NamedTuple):
    """Memory of an argument: item `i` starts `i * stride` numbers after the first."""

    array: np.ndarray
    stride: int


def _strided(items: Items):
    """An `am_array`."""
    form, number = _FORMS[items.array.dtype]
    data = _ffi.cast(f"const {number} *", items.array.ctypes.data)
    return _ffi.new(f"am_array_{form} *", [data, items.stride])[0]


def ask(model: Model | None, question: str, n: int, inputs: Sequence[Items | int], outputs) -> None:
    """Ask `question` for `n` items; write to `outputs`, contiguous arrays of one float type.

    Without a model, `question` is a function of numbers.
    """
    form, number = _FORMS[outputs[0].dtype]
    function = getattr(_lib, f"am_{_prefix(model)}{question}_batch_{form}")
    arguments = [item if isinstance(item, int) else _strided(item) for item in inputs]
    results = [_ffi.cast(f"{number} *", output.ctypes.data) for output in outputs]
    _check(function(*_pointer(model), n, *arguments, *results))


def _prefix(model: Model | None) -> str:
    return f"{model.name}_" if model else ""


def _pointer(model: Model | None) -> list:
    return [model.pointer] if model else []


# ---- Recording -------------------------------------------------------------------------------


class Recording:
    """Questions that a host computes, operation by operation.

    `host` has `digits` and a method for each of `OPERATIONS`. Its values stay in Python; the
    library sees their slots, and what it makes of them is a `Program`. That depends on the kinds of
    models and on the question alone, so it is kept.
    """

    _programs: ClassVar[dict[tuple, "Program"]] = {}

    def __init__(self, host):
        self._host = host
        self._values = [None]
        # What a program depends on, but for the question.
        self._kinds: list = [host.digits]

    def profile(self, number: int, values: Sequence) -> Model:
        """A profile of the kind `number` with values of the host."""
        self._kinds.append(number)
        return Model("profile", _ffi.new("am_profile_nodes *", [number, self._put(values)]))

    def medium(self, profiles: Sequence[Model], sigma_t: Sequence[Sequence]) -> Model:
        """A medium; `sigma_t` has a row of values of the host, one per channel, per profile."""
        structs = _ffi.new("am_profile_nodes[]", [p.pointer[0] for p in profiles])
        slots = _ffi.new("am_node[]", [slot for row in sigma_t for slot in self._put(row)])
        pointer = _ffi.new("am_medium_nodes *", [structs, slots, len(sigma_t), len(sigma_t[0])])
        return Model("medium", pointer, (structs, slots))

    def sunlit_fog(self, profile: Model, sigma_s: Sequence, sigma_t: Sequence) -> Model:
        """A fog in the sun; coefficients are values of the host, one per channel."""
        slots = [_ffi.new("am_node[]", self._put(sigma)) for sigma in (sigma_s, sigma_t)]
        fields = [profile.pointer[0], *slots, len(sigma_t)]
        return Model("sunlit_fog", _ffi.new("am_sunlit_fog_nodes *", fields), tuple(slots))

    def airlight(self, light: dict, phase: dict, sigma_s: Sequence, sigma_t: Sequence) -> Model:
        """A point light in a uniform medium, its numbers values of the host."""
        kinds = choices("light_kind")[light["kind"]], choices("phase_kind")[phase["kind"]]
        self._kinds += [*kinds, light["exponent"]]
        slots = [_ffi.new("am_node[]", self._put(row)) for row in (sigma_s, sigma_t)]
        pointer = _ffi.new("am_airlight_nodes *", {"n_channels": len(sigma_s)})
        pointer.sigma_s, pointer.sigma_t = slots
        pointer.light.kind, pointer.phase.kind = kinds
        pointer.light.exponent = light["exponent"]
        for name in ("position", "axis"):
            setattr(pointer.light, name, self._put(light[name]))
        for name in ("cutoff_angle", "beam_width"):
            setattr(pointer.light, name, *self._put([light[name]]))
        (pointer.phase.g,) = self._put([phase["g"]])
        return Model("airlight", pointer, tuple(slots))

    def ask(
        self, model: Model | None, question: str, inputs: Sequence, outputs: int, width: int
    ) -> list:
        """The results of `question`: `outputs` lists of `width` values of the host.

        Without a model, `question` is a function of numbers. `inputs` are tuples of one value
        (numbers) or three (points), or ints (indices).
        """
        function = f"am_{_prefix(model)}{question}_record"
        arguments = [self._argument(value) for value in inputs]
        indices = [i for i in inputs if isinstance(i, int)]
        key = (function, *self._kinds, *indices, len(self._values), outputs, width)
        program = self._programs.get(key)
        if program is None:
            slots = [_ffi.new("am_node[]", width) for _ in range(outputs)]
            program = Program(len(self._values))
            handle = _ffi.new_handle(program)
            fields = {"tape": handle, "digits": self._host.digits, **_ENTRIES}
            table = _ffi.new("am_host_table *", fields)
            _check(getattr(_lib, function)(table, *_pointer(model), *arguments, *slots))
            program.keep([slot for row in slots for slot in row])
            self._programs[key] = program
        results = program.run(self._host, self._values)
        return [results[i : i + width] for i in range(0, len(results), width)]

    def _argument(self, value):
        if isinstance(value, int):
            return value
        slots = self._put(value)
        return slots[0] if len(slots) == 1 else _ffi.new("am_node[]", slots)

    def _put(self, values: Sequence) -> list[int]:
        first = len(self._values)
        self._values += values
        return list(range(first, len(self._values)))


class Program:
    """Operations on slots. The first ones, `given` with slot 0, are given; each step has the next.

    Slot 0 stands for what could not be recorded: an interrupt in a callback leaves it behind.
    """

    def __init__(self, given: int):
        self._given = given
        self._steps: list[tuple[str, tuple]] = []
        self._known: dict[tuple, int] = {}
        self._results: list[int] = []
        self._operations: set[str] = set()

    def literal(self, value: float) -> int:
        return self._slot(value.hex(), "literal", (value,))  # 0.0 is another number than -0.0

    def operate(self, name: str, slots: tuple[int, ...]) -> int:
        return 0 if 0 in slots else self._slot(slots, name, slots)

    def _slot(self, operands, name, arguments) -> int:
        """That of a step: the same for the same step."""
        new = self._given + len(self._steps)
        slot = self._known.setdefault((name, operands), new)
        if slot == new:
            self._steps.append((name, arguments))
        return slot

    def keep(self, results: list[int]) -> None:
        """Ends the recording: keeps the steps that the slots `results` depend on."""
        needed = set(results)
        for slot, (name, arguments) in reversed(list(enumerate(self._steps, self._given))):
            if slot in needed and name != "literal":
                needed.update(arguments)
        moved = {slot: slot for slot in range(self._given)}
        kept = []
        for slot, (name, arguments) in enumerate(self._steps, self._given):
            if slot in needed:
                moved[slot] = self._given + len(kept)
                known = arguments if name == "literal" else tuple(moved[i] for i in arguments)
                kept.append((name, known))
        self._steps, self._known = kept, {}
        self._results = [moved[slot] for slot in results]
        self._operations = {name for name, _ in kept}

    def run(self, host, given: Sequence) -> list:
        """The results, computed by `host`. Raises what a method of the host raises."""
        operations = {name: getattr(host, name) for name in self._operations}
        values = list(given)
        for name, arguments in self._steps:
            if name != "literal":
                arguments = [values[slot] for slot in arguments]
            values.append(operations[name](*arguments))
        return [values[slot] for slot in self._results]


def _entry(name: str, signature):
    """The function for an entry of the host table."""
    if name == "literal":
        return _ffi.callback(signature, lambda tape, x: _ffi.from_handle(tape).literal(x))
    return _ffi.callback(
        signature, lambda tape, *slots: _ffi.from_handle(tape).operate(name, slots)
    )


_ENTRIES = {
    name: _entry(name, field.type)
    for name, field in _ffi.typeof("am_host_table").fields
    if field.type.kind == "function"
}

# What a host computes.
OPERATIONS = tuple(_ENTRIES)
