// Colours and wavelengths: distances are drawn from one channel, and weighted for all of them.

#pragma once

#include <drjit/array.h>
#include <drjit/math.h>

namespace mitsuba {

namespace dr = drjit;

/// Probability of drawing from each channel: in proportion to the throughput of a path.
template <typename Channels> Channels channel_chances(const Channels &throughput) {
    Channels weight = dr::maximum(throughput, 0.f);
    dr::value_t<Channels> sum = dr::sum(weight);
    return dr::select(sum > 0.f, weight / sum, 1.f / dr::size_v<Channels>);
}

/// The channel that a uniform variate chooses.
template <typename Channels, typename Float = dr::value_t<Channels>>
dr::uint32_array_t<Float> choose_channel(const Channels &chance, const Float &u) {
    dr::uint32_array_t<Float> channel = 0;
    Float cdf = 0.f;
    for (size_t i = 0; i + 1 < dr::size_v<Channels>; ++i) {
        cdf += chance[i];
        dr::masked(channel, u >= cdf) = (uint32_t) i + 1;
    }
    return channel;
}

/// The value of the channel number `channel`.
template <typename Channels, typename Float = dr::value_t<Channels>>
Float of_channel(const Channels &values, const dr::uint32_array_t<Float> &channel) {
    Float value = values[0];
    for (size_t i = 1; i < dr::size_v<Channels>; ++i)
        dr::masked(value, channel == (uint32_t) i) = values[i];
    return value;
}

/// The smallest value of the channels that may be chosen.
template <typename Channels>
dr::value_t<Channels> thinnest(const Channels &chance, const Channels &values) {
    return dr::min(
        dr::select(chance > 0.f, values, dr::Infinity<dr::scalar_t<dr::value_t<Channels>>>));
}

/// Contribution over probability by the balance heuristic: `densities` are those of the sample in
/// each channel. What divides both alike does not matter.
template <typename Channels>
Channels balance(const Channels &contribution, const Channels &chance, const Channels &densities) {
    dr::value_t<Channels> pdf = dr::sum(chance * densities);
    return dr::select(pdf > 0.f, contribution / pdf, 0.f);
}

} // namespace mitsuba
