// Variates that are spread evenly over the paths of one camera ray.

#pragma once

#include <mitsuba/core/math.h>
#include <mitsuba/render/sampler.h>

namespace mitsuba {

/// What a variate decides.
enum SpreadSlot : uint32_t {
    /// Whether the first flight collides, and in which channel.
    Event = 0,
    /// Where: one for each of the components that have a variate.
    Place = 1,
    /// The direction that leads on from the first vertex.
    Lobe = 5,
    Direction = 6,
    /// Its light samples, and which of them is traced.
    Light = 8,
    LightChoice = 12,
    SpreadSlots = 13
};

/**
 * The variates of a path up to its first vertex, by a lattice that is shifted at random (Cranley
 * and Patterson 1976): those of number k of n paths are k/n apart from those of the first, around
 * the unit interval. Each path by itself has variates that are uniform and independent.
 */
template <typename Float_> struct Spread {
    using Float = Float_;
    using Mask = dr::mask_t<Float>;
    using Shift = dr::Array<Float, SpreadSlots>;

    /// Variates of the first path.
    Shift shift = 0.f;
    /// k/n.
    Float turn = 0.f;
    /// The first flight through a medium is still to come, and the first vertex.
    Mask flight = false, vertex = false;

    /// Draws those of the first path.
    template <typename Sampler> void draw(Sampler *sampler, const Mask &active) {
        for (size_t i = 0; i < SpreadSlots; ++i)
            shift[i] = sampler->next_1d(active);
        flight = vertex = active;
    }

    Float operator()(size_t slot) const {
        const Float u = shift[slot] + turn;
        return dr::minimum(u - dr::select(u < 1.f, 0.f, 1.f), dr::OneMinusEpsilon<Float>);
    }

    DRJIT_STRUCT(Spread, shift, turn, flight, vertex)
};

} // namespace mitsuba
