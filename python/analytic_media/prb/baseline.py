"""Baselines: what is left of a path in the mean, by other paths.

The density of collisions has a known integral, 1 - T(end), whatever the parameters. So a constant
may be taken off the light that multiplies the derivative of the density, and given back with the
derivative of 1 - T(end): the mean stays the same, and the noise is that of the difference. The
constant must not depend on what comes after on the same path. It is the mean light behind events
of the same kind, over other paths nearby.
"""

from dataclasses import dataclass, field

import drjit as dr
import mitsuba as mi

from . import flight

# Paths that a mean is taken of, at least.
NEIGHBOURS = 32


@dataclass
class Record:
    """A path's first event of a kind: its weight, and the light of the path before it."""

    weight: object = field(default_factory=lambda: mi.Spectrum(0))
    before: object = field(default_factory=lambda: mi.Spectrum(0))
    met: object = field(default_factory=lambda: mi.Bool(False))

    def note(self, event, throughput, light):
        """Takes note of an event with the weight `throughput`, after which more light comes."""
        first = event & ~self.met
        self.weight = dr.select(first, throughput, self.weight)
        self.before = dr.select(first, light, self.before)
        self.met |= first

    def mean(self, light, samples, independent):
        """Light behind the events per weight: for each path, the mean of others nearby.

        Paths of a pixel follow each other, `samples` of each. Where they are not independent, those
        of the same pixel are left out.
        """
        behind = dr.select(self.met, light - self.before, 0)
        pixels = 1 if independent and samples >= NEIGHBOURS else -(-NEIGHBOURS // samples) + 1
        count = dr.width(behind)

        def others(value):
            value = value + dr.zeros(mi.Float, count)
            near = _spread(value, samples * pixels, count)
            return near - (value if independent else _spread(value, samples, count))

        weight = mi.Spectrum([others(x) for x in self.weight])
        return flight.each(weight > 0, mi.Spectrum([others(x) for x in behind]) / weight, 0)


def _spread(value, size, count):
    """Sums over blocks of successive values, for each of the values."""
    sums = dr.block_sum(value, size)
    return dr.gather(mi.Float, sums, dr.arange(mi.UInt32, count) // size)
