"""Bad input gets an error that names the argument, its value, and what is allowed."""

import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import numpy as np
import pytest

import analytic_media as am
from analytic_media import _native

ORIGIN, UP = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)
P = am.Exponential(scale_height=4)
M = am.Medium([(P, (0.1, 0.2, 0.3)), (am.Constant(), (0.1, 0.2, 0.3))])
NAN, INF = np.nan, np.inf


def make(*components):
    return lambda: am.Medium(components)


def shapes(o, d, t):
    return lambda: P.column(np.zeros(o), np.broadcast_to(UP, d), np.zeros(t))


VALUES = {
    # Parameters of profiles
    "scale_height must be finite and > 0, got 0.0": lambda: am.Exponential(scale_height=0),
    "scale_height must be finite and > 0, got -3.0": lambda: am.Exponential(scale_height=-3),
    "scale_height must be finite and > 0, got NaN": lambda: am.Exponential(scale_height=NAN),
    "scale_height must be finite and > 0, got inf": lambda: am.Exponential(scale_height=INF),
    "scale_height must be a number, got 'high'": lambda: am.Exponential(scale_height="high"),
    "scale_height must be a number, got '3'": lambda: am.Exponential(scale_height="3"),
    "scale_height must be a number, got [1, 2]": lambda: am.Exponential(scale_height=[1, 2]),
    "scale_height must be a number, got None": lambda: am.Exponential(scale_height=None),
    "base_height must be finite, got NaN": lambda: am.Exponential(scale_height=1, base_height=NAN),
    "gradient must be finite, got inf": lambda: am.Linear(gradient=INF, density=1),
    "density must be finite, got NaN": lambda: am.Linear(gradient=1, density=NAN),
    "up must be a unit vector, got [0.0, 0.0, 2.0]": lambda: am.Linear(
        gradient=1, density=1, up=(0, 0, 2)
    ),
    "up must be a unit vector, got [0.0, 0.0, 0.0]": lambda: am.Exponential(
        scale_height=1, up=(0, 0, 0)
    ),
    "up must be 3 numbers, got (0, 1)": lambda: am.Exponential(scale_height=1, up=(0, 1)),
    # Components of media
    "sigma_t must be finite and >= 0, got -1.0": make((P, -1)),
    "sigma_t must be finite and >= 0, got NaN": make((P, (0.1, NAN))),
    "sigma_t must be finite and >= 0, got inf": make((P, INF)),
    "sigma_t must be a number or a sequence of numbers, got 'red'": make((P, "red")),
    "sigma_t must be a number or a sequence of numbers, got []": make((P, [])),
    "sigma_t must be a number or a sequence of numbers, got [[1, 2]]": make((P, [[1, 2]])),
    "the same shape in all components, got (2,) in the first and (3,) in component 1": make(
        (P, (1, 2)), (P, (1, 2, 3))
    ),
    "components must have at least one (profile, sigma_t), got none": make(),
    "components must be pairs (profile, sigma_t), got Exponential": make(P),
    "components must begin with a profile, got 'fog'": make(("fog", 1)),
    "channel must be from 0 to 2, got 3": lambda: M.free_flight(ORIGIN, UP, 1, 1, channel=3),
    "channel must be from 0 to 2, got -1": lambda: M.free_flight(ORIGIN, UP, 1, 1, channel=-1),
    # Arguments
    "x must be finite, got nan": lambda: P.density((0, 0, NAN)),
    "o must be finite, got inf at index (1, 2)": lambda: P.column([ORIGIN, (0, 0, INF)], UP, 1),
    "x must have the shape (..., 3), got (2,)": lambda: P.density((1, 2)),
    "x must have the shape (..., 3), got ()": lambda: P.density(1),
    "x must be an array of real numbers, got 'abc'": lambda: P.density("abc"),
    "x must be an array of real numbers, got 1j": lambda: P.density(1j),
    "o must be an array of real numbers, got [(0.0, 0.0, 0.0), (1, 2)]": lambda: P.column(
        [ORIGIN, (1, 2)], UP, 1
    ),
    "d must be a unit vector (to within 1e-05), got the length 2 of [0. 0. 2.]": lambda: P.column(
        ORIGIN, (0, 0, 2), 1
    ),
    "d must be a unit vector (to within 1e-05), got the length 0 of": lambda: P.column(
        ORIGIN, ORIGIN, 1
    ),
    "d must be a unit vector (to within 1e-05), got the length nan of": lambda: M.transmittance(
        ORIGIN, (0, NAN, 1), 1
    ),
    "got the length 1.00002 of [0.      0.      1.00002] at index (1,)": lambda: P.column(
        ORIGIN, [UP, (0, 0, 1.00002)], 1
    ),
    "t must be >= 0 and may be infinite, got -1.0": lambda: P.column(ORIGIN, UP, -1),
    "t must be >= 0 and may be infinite, got nan at index (1,)": lambda: P.bounds(
        ORIGIN, UP, [1, NAN]
    ),
    "t must be >= 0 and may be infinite, got -inf": lambda: M.pdf(ORIGIN, UP, -INF),
    "column must be >= 0 and may be infinite, got -0.5": lambda: P.inv_column(ORIGIN, UP, -0.5),
    "t_max must be >= 0 and may be infinite, got -2.0": lambda: M.free_flight(ORIGIN, UP, -2, 1),
    "t_max must be >= 0 and may be infinite, got -3.0": lambda: M.pdf_within(ORIGIN, UP, -3, 1),
    "tau must be >= 0 and may be infinite, got nan": lambda: M.free_flight(ORIGIN, UP, 1, NAN),
    "lo must be a number, got nan at index (1,)": lambda: P.bounds_box((0, NAN, 0), UP),
    "hi must be a number, got nan at index (2,)": lambda: M.bounds_box(ORIGIN, (0, 0, NAN)),
    "d has the shape (5, 3), which does not broadcast against o with the shape (4, 3)": shapes(
        (4, 3), (5, 3), ()
    ),
    "t has the shape (2,), which does not broadcast against d with the shape (5, 3)": shapes(
        (3,), (5, 3), 2
    ),
}


@pytest.mark.parametrize("message", VALUES)
def test_value(message):
    with pytest.raises(ValueError, match=re.escape(message)):
        VALUES[message]()


@pytest.mark.parametrize(
    ("message", "call"),
    [
        (
            "Exponential has no parameter 'scale'; its parameters: scale_height, up, base_height",
            lambda: am.Exponential(scale_height=1, scale=2),
        ),
        ("Constant has no parameter 'up'; its parameters: none", lambda: am.Constant(up=UP)),
        ("Exponential needs the parameter 'scale_height'", lambda: am.Exponential()),
        ("Linear needs the parameter 'density'", lambda: am.Linear(gradient=1)),
    ],
)
def test_parameters_that_are_not_there(message, call):
    with pytest.raises(TypeError, match=re.escape(message)):
        call()


def test_unit_vectors_of_single_precision_pass(rays):
    _, d = rays
    P.column(ORIGIN, d.astype(np.float32), 1)


def test_a_bad_value_in_single_precision_is_found_too():
    with pytest.raises(ValueError, match="o must be finite, got inf"):
        P.column(np.float32([0, 0, INF]), np.float32(UP), np.float32(1))


def test_errors_belong_to_their_thread():
    """Two threads fail at the same time, over and over, each with its own text."""
    barrier = Barrier(2)

    def fail(name, value):
        messages = set()
        for _ in range(300):
            barrier.wait()
            with pytest.raises(ValueError) as caught:
                am.Linear(**{"gradient": 1, "density": 1, name: value})
            messages.add(str(caught.value))
        return messages

    with ThreadPoolExecutor(2) as pool:
        first = pool.submit(fail, "gradient", NAN)
        second = pool.submit(fail, "density", INF)
    assert first.result() == {"gradient must be finite, got NaN"}
    assert second.result() == {"density must be finite, got inf"}


def test_threads_share_profiles(rays):
    o, d = rays
    expected = P.column(o, d, 3)
    with ThreadPoolExecutor(4) as pool:
        results = list(pool.map(lambda _: P.column(o, d, 3), range(200)))
    assert all(np.array_equal(result, expected) for result in results)


# ---- The library and its header


def load(**environment):
    source = Path(am.__file__).parents[1]
    command = [sys.executable, "-c", "import analytic_media"]
    done = subprocess.run(
        command, env={"PYTHONPATH": str(source), **environment}, capture_output=True, text=True
    )
    assert done.returncode != 0
    return done.stderr.strip().splitlines()[-1]


def test_a_library_that_is_not_there():
    message = load(ANALYTIC_MEDIA_LIBRARY="/nowhere/lib.so")
    assert message == (
        "ImportError: ANALYTIC_MEDIA_LIBRARY must name a file, got '/nowhere/lib.so'"
    )


def test_a_library_of_another_version(monkeypatch):
    class OtherLibrary:
        AM_ABI_VERSION = 1

        @staticmethod
        def am_abi_version():
            return 2

    monkeypatch.setattr(_native.cffi.FFI, "dlopen", lambda *_: OtherLibrary)
    with pytest.raises(ImportError, match="has ABI version 2 but"):
        _native._load()


def test_declarations_come_from_the_header():
    header = """
    #ifndef GUARD_H
    #define GUARD_H
    #include <stdint.h>
    #define COUNT 3  // how many
    /* a type: int bad; */
    enum colour
    #if defined(__cplusplus)
      : int32_t
    #endif
    { RED = 0 };
    #ifndef __cplusplus
    #if __STDC_VERSION__ >= 202311L
    typedef enum colour colour;
    #else
    typedef int32_t colour;
    #endif
    #endif
    colour paint(int n);
    #endif
    """
    lines = [line.split() for line in _native.declarations(header).splitlines() if line.strip()]
    assert lines == [
        ["#define", "COUNT", "3"],
        ["enum", "colour"],
        ["{", "RED", "=", "0", "};"],
        ["typedef", "int32_t", "colour;"],
        ["colour", "paint(int", "n);"],
    ]
