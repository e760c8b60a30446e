"""Arguments and results as NumPy arrays: checks, broadcasting, and float types."""

from collections.abc import Callable, Sequence
from itertools import combinations, pairwise
from typing import NamedTuple

import numpy as np

from . import _native

UNIT_TOLERANCE = 1e-5  # of the length of a direction: what float32 keeps, and the library allows


class Argument(NamedTuple):
    """An argument as the caller gave it: `item` is the shape of one, `check` its range."""

    name: str
    value: object
    item: tuple[int, ...]
    check: Callable[[str, np.ndarray], None]


def point(name, value) -> Argument:
    """Points (..., 3), finite lengths."""
    return Argument(name, value, (3,), _check_finite)


def corner(name, value) -> Argument:
    """Corners of boxes (..., 3), lengths that may be infinite."""
    return Argument(name, value, (3,), _check_number)


def direction(name, value) -> Argument:
    """Unit vectors (..., 3)."""
    return Argument(name, value, (3,), _check_unit)


def amount(name, value) -> Argument:
    """Numbers from 0 to infinity, both included."""
    return Argument(name, value, (), _check_amount)


def number(name, value) -> Argument:
    """Finite numbers."""
    return Argument(name, value, (), _check_finite)


def positive(name, value) -> Argument:
    """Finite numbers above 0."""
    return Argument(name, value, (), _check_positive)


def limit(name, value) -> Argument:
    """Numbers that may be infinite."""
    return Argument(name, value, (), _check_number)


def unchecked(name, value) -> Argument:
    """Numbers whose range the library checks."""
    return Argument(name, value, (), lambda name, array: None)


def spectrum(name, value, n: int) -> Argument:
    """Numbers of `n` wavelengths (..., n), whose range the library checks."""
    return unchecked(name, value)._replace(item=(n,))


def segment(o, d, t) -> tuple[Argument, Argument, Argument]:
    """Segments: origins, directions and lengths."""
    return point("o", o), direction("d", d), amount("t", t)


def answer(
    model: _native.Model | None, question: str, *inputs: Argument | int, outputs=1, width=()
):
    """Ask `question` for every item of the broadcast arguments.

    Returns an array of the shape of the broadcast items, followed by `width`; a tuple of such
    arrays if there are several `outputs`.
    """
    results = answers(model, question, *inputs, shapes=[width] * outputs)
    return results if outputs > 1 else results[0]


def answers(
    model: _native.Model | None,
    question: str,
    *inputs: Argument | int,
    shapes: Sequence[tuple[int, ...]],
) -> tuple:
    """`answer` with an output for each of `shapes`, which are those of one item."""
    arguments = [argument for argument in inputs if isinstance(argument, Argument)]
    batch, arrays = broadcast(arguments)
    items = iter([_items(array, a.item) for array, a in zip(arrays, arguments, strict=True)])
    results = [np.empty(batch + shape, arrays[0].dtype) for shape in shapes]
    n = int(np.prod(batch, dtype=np.intp))
    _native.ask(
        model, question, n, [i if isinstance(i, int) else next(items) for i in inputs], results
    )
    return tuple(result[()] for result in results)


def function(name: str, **arguments):
    """The C function `name` of numbers, for every item of the broadcast arguments."""
    inputs = [unchecked(key, value) for key, value in arguments.items()]
    return answer(None, name, *inputs)


def complex_function(name: str, argument: str, value):
    """The C function `name` of a complex number, whose value is complex, for every item."""
    array = np.asarray(value)
    if array.dtype.kind not in "fiubc":
        raise ValueError(f"{argument} must be an array of complex numbers, got {value!r}")
    parts = {"x": array.real, "y": array.imag}
    inputs = [unchecked(key, part) for key, part in parts.items()]
    result = answer(None, name, *inputs, width=(2,))
    return result.view(np.result_type(result.dtype, np.complex64))[..., 0][()]


def broadcast(arguments: list[Argument]) -> tuple[tuple[int, ...], list[np.ndarray]]:
    """Shape of the items, and the checked arguments broadcast to it, in one float type."""
    arrays = [_real(argument) for argument in arguments]
    given = {
        array.itemsize
        for array, argument in zip(arrays, arguments, strict=True)
        if hasattr(argument.value, "dtype") and array.dtype.kind == "f"
    }
    dtype = np.float32 if given == {4} else np.float64
    arrays = [array.astype(dtype, copy=False) for array in arrays]
    for array, argument in zip(arrays, arguments, strict=True):
        argument.check(argument.name, array)

    batches = [a.shape[: a.ndim - len(arg.item)] for a, arg in zip(arrays, arguments, strict=True)]
    try:
        shape = np.broadcast_shapes(*batches)
    except ValueError:
        raise ValueError(_mismatch(arguments, arrays, batches)) from None
    full = [np.broadcast_to(a, shape + arg.item) for a, arg in zip(arrays, arguments, strict=True)]
    return shape, full


def _mismatch(arguments, arrays, batches) -> str:
    for (a, first, shape), (b, second, other) in combinations(
        zip(arguments, arrays, batches, strict=True), 2
    ):
        try:
            np.broadcast_shapes(shape, other)
        except ValueError:
            return (
                f"{b.name} has the shape {second.shape}, which does not broadcast against "
                f"{a.name} with the shape {first.shape}"
            )
    raise AssertionError("shapes that do not broadcast have a pair that does not")


def real(value) -> np.ndarray | None:
    """`value` as an array of real numbers; None if it is not that."""
    try:
        array = np.asarray(value)
    except ValueError:  # rows of different lengths
        return None
    return array if array.dtype.kind in "fiub" else None


def channels(name: str, value) -> np.ndarray:
    """A coefficient as it is (), or one per channel (n,); double precision."""
    array = real(value)
    if array is None or array.ndim > 1 or array.size == 0:
        raise ValueError(f"{name} must be a number or a sequence of numbers, got {value!r}")
    return array.astype(np.float64)


def _real(argument: Argument) -> np.ndarray:
    array = real(argument.value)
    if array is None:
        got = argument.value
        raise ValueError(f"{argument.name} must be an array of real numbers, got {got!r}")
    if argument.item and array.shape[-1:] != argument.item:
        shape = f"(..., {argument.item[0]})"
        raise ValueError(f"{argument.name} must have the shape {shape}, got {array.shape}")
    return array


def _items(array: np.ndarray, item: tuple[int, ...]) -> _native.Items:
    """Where the items of a broadcast array lie; copied only if one stride cannot say it."""
    stride = _stride(array, item)
    if stride is None:
        array = np.ascontiguousarray(array)
        stride = item[0] if item else 1
    return _native.Items(array, stride)


def _stride(array: np.ndarray, item: tuple[int, ...]) -> int | None:
    """The stride between items, in numbers; None if there is not one stride for all."""
    size, width = array.itemsize, item[0] if item else 1
    batch = array.ndim - len(item)
    if item and array.strides[-1] != size:
        return None
    axes = [(n, s) for n, s in zip(array.shape[:batch], array.strides, strict=False) if n != 1]
    if all(step == 0 for _, step in axes):
        return 0
    nested = all(outer == n * inner for (_, outer), (n, inner) in pairwise(axes))
    step = axes[-1][1]
    return step // size if nested and step >= width * size and step % size == 0 else None


# ---- Ranges ----------------------------------------------------------------------------------


def _require(good: np.ndarray, name: str, reason: str, values: np.ndarray) -> None:
    if np.all(good):
        return
    index = tuple(int(i) for i in np.unravel_index(np.argmin(good), np.shape(good)))
    where = f" at index {index}" if index else ""
    raise ValueError(f"{name} must be {reason}, got {values[index]}{where}")


def _check_finite(name, array):
    _require(np.isfinite(array), name, "finite", array)


def _check_positive(name, array):
    _require(np.isfinite(array) & (array > 0), name, "finite and > 0", array)


def _check_number(name, array):
    _require(~np.isnan(array), name, "a number", array)


def _check_amount(name, array):
    _require(array >= 0, name, ">= 0 and may be infinite", array)


def _check_unit(name, array):
    length = np.sqrt(np.einsum("...i,...i", array, array, dtype=np.float64))
    good = np.abs(length - 1) <= UNIT_TOLERANCE
    _require(good, name, f"a unit vector (to within {UNIT_TOLERANCE:g})", _Lengths(length, array))


class _Lengths(NamedTuple):
    """Shows an offending direction with its length."""

    length: np.ndarray
    array: np.ndarray

    def __getitem__(self, index):
        return f"the length {self.length[index]:.9g} of {self.array[index]}"
