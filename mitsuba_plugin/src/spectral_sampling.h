// How paths through coloured media are drawn: from which extinction, and which events follow.

#pragma once

#include <sstream>
#include <string>

#include "channels.h"
#include "choice.h"

namespace mitsuba {

/// Which extinction the distances of a path are drawn from.
enum class SpectralSampling {
    /// That of one channel, the only one that the path is for.
    Single,
    /// The mean over the channels.
    Average,
    /// That of a channel, weighted by the balance heuristic over all.
    Mis,
    /// The greatest over the channels: the others collide with nothing at times.
    Tracking
};

/// What the probabilities of the events of a collision are in proportion to.
enum class EventRule {
    /// The greatest coefficient over the channels.
    Maximum,
    /// Their mean.
    Average,
    /// Their mean, weighted by the throughput of the path.
    History
};

/// What an integrator asks of the media.
struct FlightRules {
    SpectralSampling sampling = SpectralSampling::Mis;
    EventRule events = EventRule::History;
    /// Absorption ends paths, instead of weakening them.
    bool analogue = false;

    FlightRules() = default;
    explicit FlightRules(const Properties &props) {
        sampling = one_of(props, "spectral_sampling", sampling_names(), sampling);
        events = one_of(props, "event_probabilities", event_names(), events);
        analogue = one_of(props, "absorption", absorption_names(), false);
        if (props.has_property("event_probabilities") && sampling != SpectralSampling::Tracking)
            Throw("\"event_probabilities\" is for \"spectral_sampling\" = \"tracking\" only, got "
                  "\"%s\"",
                  name_of(sampling_names(), sampling));
    }

    /// Whether a flight takes a variate for what happens where it ends.
    bool has_events() const { return analogue || sampling == SpectralSampling::Tracking; }

    /// Whether a path never carries more than it began with in the mean of its channels.
    bool bounded() const {
        return sampling == SpectralSampling::Mis || sampling == SpectralSampling::Single;
    }

    std::string to_string() const {
        std::ostringstream oss;
        oss << "  spectral_sampling = " << name_of(sampling_names(), sampling) << "," << std::endl;
        if (sampling == SpectralSampling::Tracking)
            oss << "  event_probabilities = " << name_of(event_names(), events) << "," << std::endl;
        oss << "  absorption = " << name_of(absorption_names(), analogue);
        return oss.str();
    }

private:
    static Names<SpectralSampling> sampling_names() {
        return { { "single", SpectralSampling::Single },
                 { "average", SpectralSampling::Average },
                 { "mis", SpectralSampling::Mis },
                 { "tracking", SpectralSampling::Tracking } };
    }

    static Names<EventRule> event_names() {
        return { { "maximum", EventRule::Maximum },
                 { "average", EventRule::Average },
                 { "history", EventRule::History } };
    }

    static Names<bool> absorption_names() { return { { "weight", false }, { "analogue", true } }; }
};

/// The number that a flight is drawn from, out of those of the channels.
template <typename Channels, typename Float = dr::value_t<Channels>> struct Drawn {
    SpectralSampling from;
    dr::uint32_array_t<Float> channel = 0;

    Float operator()(const Channels &values) const {
        if (from == SpectralSampling::Average)
            return dr::mean(values);
        if (from == SpectralSampling::Tracking)
            return dr::max(values);
        return of_channel(values, channel);
    }
};

/// Probabilities of scattering, of absorption and of a null collision.
template <typename Float> struct EventChances {
    Float scattering, absorption, null;
};

/// Of a collision with what scatters `sigma_s`, absorbs `sigma_a`, and is padded by `sigma_n`
/// (article, Eq. 73); without absorption as an event (Eq. 74), that is 0.
template <typename Channels, typename Float = dr::value_t<Channels>>
EventChances<Float> event_chances(const FlightRules &rules, const Channels &throughput,
                                  const Channels &sigma_s, const Channels &sigma_a,
                                  const Channels &sigma_n) {
    const Channels share = channel_chances(throughput);
    auto size = [&](const Channels &sigma) -> Float {
        switch (rules.events) {
        case EventRule::Maximum:
            return dr::max(sigma);
        case EventRule::Average:
            return dr::mean(sigma);
        default:
            return dr::sum(share * sigma);
        }
    };
    const Float s = size(sigma_s), a = rules.analogue ? size(sigma_a) : Float(0.f),
                n = size(sigma_n), sum = s + a + n, unit = dr::select(sum > 0.f, dr::rcp(sum), 0.f);
    return { s * unit, a * unit, n * unit };
}

} // namespace mitsuba
