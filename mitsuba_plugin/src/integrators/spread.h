// Variates that are spread evenly over the paths of one camera ray.

#pragma once

#include <mitsuba/core/math.h>
#include <mitsuba/render/sampler.h>

namespace mitsuba {

/// What a variate of a step decides, of a flight and the vertex where it ends.
enum SpreadSlot : uint32_t {
    /// Whether the flight collides, and in which channel.
    Event = 0,
    /// Where: one for each of the components that have a variate.
    Place = 1,
    /// The direction that leads on from the vertex.
    Lobe = 5,
    Direction = 6,
    /// Its light samples, and which of them is traced.
    Light = 8,
    LightChoice = 12,
    SpreadSlots = 13
};

/**
 * The variates of a path up to its second vertex, by a lattice that is shifted at random (Cranley
 * and Patterson 1976): those of number k of n paths are k/n apart from those of the first, around
 * the unit interval. Each path by itself has variates that are uniform and independent.
 */
template <typename Float_> struct Spread {
    using Float = Float_;
    using UInt32 = dr::uint32_array_t<Float>;
    using Mask = dr::mask_t<Float>;

    /// Flights, and vertices, whose variates are spread: more bring nothing.
    static constexpr uint32_t Steps = 2;
    using Shift = dr::Array<Float, Steps * SpreadSlots>;

    /// Variates of the first path, step by step.
    Shift shift = 0.f;
    /// k/n.
    Float turn = 0.f;
    /// How many flights and vertices the path has had.
    UInt32 flights = 0, vertices = 0;

    /// Draws those of the first path.
    template <typename Sampler> void draw(Sampler *sampler, const Mask &active) {
        for (size_t i = 0; i < dr::size_v<Shift>; ++i)
            shift[i] = sampler->next_1d(active);
    }

    /// That of a step; `u`, where the step is none of those.
    Float operator()(const UInt32 &step, size_t slot, const Float &u) const {
        Float of_step = shift[slot];
        for (uint32_t i = 1; i < Steps; ++i)
            of_step = dr::select(step == i, shift[i * SpreadSlots + slot], of_step);
        of_step += turn;
        of_step -= dr::select(of_step < 1.f, 0.f, 1.f);
        return dr::select(step < Steps, dr::minimum(of_step, dr::OneMinusEpsilon<Float>), u);
    }

    DRJIT_STRUCT(Spread, shift, turn, flights, vertices)
};

} // namespace mitsuba
