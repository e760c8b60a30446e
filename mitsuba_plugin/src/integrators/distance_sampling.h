// How the distances at which light of point-like sources is scattered are drawn.

#pragma once

#include "choice.h"

namespace mitsuba {

/// Where a ray through a medium looks for the light of point-like sources.
enum class DistanceSampling {
    /// Where its flight collides.
    FreeFlight,
    /// At a distance of its own, from the light's point of view.
    Equiangular,
    /// At both, weighted by multiple importance sampling.
    Mis
};

inline Names<DistanceSampling> distance_names() {
    return { { "free_flight", DistanceSampling::FreeFlight },
             { "equiangular", DistanceSampling::Equiangular },
             { "mis", DistanceSampling::Mis } };
}

} // namespace mitsuba
