"""Free flights of the plugins follow their closed form: chi-square tests of where paths scatter.

`analyticvolpath` draws flights inside its kernels. What the tests see is where it asks a phase
function for a direction: one that keeps the distance takes the place of the media's own. Paths
that leave are weighed differently from those that collide, so that the distribution is that of
the distance given a collision, (1 - T(t)) / (1 - T(t_max)), from columns in double precision.
"""

import gc
from functools import cache

import mitsuba as mi
import numpy as np
import pytest
from scipy.stats import chi2

import analytic_media as am

dr = pytest.importorskip("drjit", reason="Dr.Jit is not installed")

scalar_and_llvm = pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"], indirect=True)

FLIGHTS = 150_000
BINS = 32
REACH = 10.0
DIRECTION = [0.6, 0.0, 0.8]

PLANET = {"center": [0.0, 0.0, -100.0], "radius": 100.0}
# Class, parameters, extinction. Optical depths up to the end are between 2 and 5.
COMPONENTS = {
    "constant": (am.Constant, {}, 0.4),
    "linear": (am.Linear, {"gradient": -0.1, "density": 1.0}, 0.7),
    "exponential": (am.Exponential, {"scale_height": 3.0}, 1.2),
    "spherical": (am.Spherical, PLANET | {"scale_height": 3.0}, 1.2),
    "tent": (am.Tent, PLANET | {"height": 4.0, "width": 3.0}, 1.2),
    "gaussian": (am.Gaussian, {"center": [3.0, 1.0, 4.0], "sigma": 2.5}, 0.9),
    "anisotropic_gaussian": (
        am.AnisotropicGaussian,
        {
            "center": [3.0, 0.0, 4.0],
            "axis_u": [1.2, 0.0, 1.6],
            "axis_v": [0.0, 1.5, 0.0],
            "axis_w": [-2.4, 0.0, 1.8],
        },
        0.9,
    ),
    "radial_gaussian": (am.RadialGaussian, PLANET | {"scale_height": 3.0}, 1.2),
}
OVERLAPS = [
    ("exponential", "tent"),
    ("spherical", "gaussian", "linear"),
    ("constant", "anisotropic_gaussian", "radial_gaussian", "tent"),
]
MEDIA = [(name,) for name in COMPONENTS] + OVERLAPS
each_medium = pytest.mark.parametrize("names", MEDIA, ids="+".join)

# Chance that all tests together reject a correct sampler is 1 %: Šidák, both variants and lights.
THRESHOLD = 1 - 0.99 ** (1 / (4 * len(MEDIA)))


class Log:
    """Distances at which paths along DIRECTION scattered first."""

    def __init__(self):
        self.scalar = not dr.is_jit_v(mi.Float)
        self.values = [] if self.scalar else dr.zeros(mi.Float, 2 * FLIGHTS)
        self.count = None if self.scalar else dr.zeros(mi.UInt, 1)

    def keep(self, mei, active):
        # Plain numbers: a kernel may outlive the memory of an array of NumPy.
        first = dr.dot(mei.wi, mi.Vector3f(*DIRECTION)) < -1 + 1e-6
        if self.scalar:
            if first:
                self.values.append(mei.t)
            return
        active &= first
        slot = dr.scatter_inc(self.count, mi.UInt(0), active)
        dr.scatter(self.values, mei.t, slot, active & (slot < 2 * FLIGHTS))

    def distances(self):
        if self.scalar:
            return np.array(self.values)
        return np.array(self.values)[: self.count[0]]


@cache
def log_phase(variant):
    """Registers the isotropic phase function `logged`, of which `log` is the current log."""

    class Logged(mi.PhaseFunction):
        log = None

        def __init__(self, props):
            mi.PhaseFunction.__init__(self, props)
            self.m_flags = mi.PhaseFunctionFlags.Isotropic
            self.m_components = [self.m_flags]

        def sample(self, ctx, mei, sample1, sample2, active=True):
            Logged.log.keep(mei, active)
            return mi.warp.square_to_uniform_sphere(sample2), mi.Spectrum(1), dr.inv_four_pi

        def eval_pdf(self, ctx, mei, wo, active=True):
            return mi.Spectrum(dr.inv_four_pi), dr.inv_four_pi

        def traverse(self, callback):
            pass

    mi.register_phase("logged", Logged)
    return Logged


# Before a sky, flights are drawn before rays are traced; in space, collisions are forced.
LIGHTS = {
    "sky": {"type": "constant"},
    "space": {"type": "point", "position": [0.0, 0.0, 20.0]},
}


def flights(variant, names, light="sky"):
    """Distances of first collisions, of about FLIGHTS paths."""
    parts = {
        name: {"type": "analytic", "profile": name, "sigma_t": sigma_t, "phase": {"type": "logged"}}
        | parameters
        for name, (_, parameters, sigma_t) in ((name, COMPONENTS[name]) for name in names)
    }
    medium = {"type": "overlap"} | parts if len(parts) > 1 else parts[names[0]]
    ball = {"bsphere_center": [0.0, 0.0, 0.0], "bsphere_radius": REACH}
    film = {"type": "hdrfilm", "width": 1, "height": 1, "rfilter": {"type": "box"}}
    phase = log_phase(variant)
    phase.log = Log()
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "analyticvolpath", "max_depth": 2},
            "sensor": {
                "type": "radiancemeter",
                "origin": [0.0, 0.0, 0.0],
                "direction": DIRECTION,
                "medium": medium | ball,
                "film": film,
            },
            "light": LIGHTS[light],
        }
    )
    # Components of a sum write to the same log, which one kernel may not do at several places.
    with (
        dr.scoped_set_flag(dr.JitFlag.SymbolicLoops, False),
        dr.scoped_set_flag(dr.JitFlag.SymbolicCalls, False),
        dr.scoped_set_flag(dr.JitFlag.SymbolicConditionals, False),
    ):
        # With one seed for all, inverses would be tested by the same variates in the same bins.
        dr.eval(mi.render(scene, spp=FLIGHTS, seed=MEDIA.index(names)))
    found = phase.log.distances()
    phase.log = None
    del scene
    gc.collect()  # a living medium would be part of every kernel
    return found


def p_value(distances, names, factor=1.0):
    """Chance that flights through a medium of `factor` times the extinction look less likely."""
    pairs = [
        (profile(**parameters), factor * sigma_t)
        for profile, parameters, sigma_t in map(COMPONENTS.get, names)
    ]
    medium = am.Medium(pairs)

    def cdf(t):
        opacity = medium.opacity(np.zeros(3), DIRECTION, t)
        return opacity / medium.opacity(np.zeros(3), DIRECTION, REACH)

    # Edges of about equal probability; what falls between them is exact.
    fine = np.linspace(0, REACH, 2000)
    share, first = np.unique(cdf(fine), return_index=True)
    edges = np.interp(np.linspace(0, 1, BINS + 1), share, fine[first])
    edges[0], edges[-1] = 0, REACH
    expected = len(distances) * np.diff(cdf(edges))
    assert (expected > 1000).all()
    counts, _ = np.histogram(distances, edges)
    assert counts.sum() == len(distances), "flights end inside the medium"
    return chi2.sf(((counts - expected) ** 2 / expected).sum(), BINS - 1)


@scalar_and_llvm
@pytest.mark.parametrize("light", LIGHTS)
@each_medium
def test_flights_follow_their_closed_form(variant, names, light):
    distances = flights(variant, names, light)
    assert len(distances) > 0.8 * FLIGHTS
    p = p_value(distances, names)
    assert p > THRESHOLD, f"p = {p:.1e}, threshold {THRESHOLD:.1e}"


@scalar_and_llvm
@pytest.mark.parametrize("names", [("constant",), ("spherical",), OVERLAPS[-1]], ids="+".join)
@pytest.mark.parametrize("factor", [0.97, 1.03])
def test_an_extinction_off_by_3_percent_is_noticed(variant, names, factor):
    """By the same test, at the same threshold."""
    p = p_value(flights(variant, names), names, factor)
    assert p < THRESHOLD, f"p = {p:.1e}, threshold {THRESHOLD:.1e}"
