// What of a scene an integrator has to provide for: found out once, instead of at every vertex.

#pragma once

#include <algorithm>
#include <vector>

#include <mitsuba/render/bsdf.h>
#include <mitsuba/render/emitter.h>
#include <mitsuba/render/medium.h>
#include <mitsuba/render/scene.h>
#include <mitsuba/render/sensor.h>
#include <mitsuba/render/shape.h>

#include "media/formula.h"

namespace mitsuba {

/// Uniform variates of a flight.
constexpr size_t MaxVariates = 4;

/// Which kinds of media and boundaries occur in a scene.
struct Survey {
    /// Some medium is ours.
    bool analytic = false;
    /// Some medium is not ours and needs delta and ratio tracking.
    bool foreign = false;
    /// Some medium of ours has an extinction that varies with wavelength.
    bool chromatic = false;
    /// Some component of a medium of ours does not scatter.
    bool absorbers = false;
    /// Rays that leave the scene see an environment.
    bool sky = false;
    /// Some surface lets light through without scattering it, or bounds a medium.
    bool permeable = false;
    /// The most components that a medium of ours has.
    size_t components = 0;
    /// Light sources at a point: their numbers among the emitters of the scene. Without those that
    /// are never sampled.
    std::vector<uint32_t> points;
    /// There are no others.
    bool only_points = false;
    /// Light samples per vertex: sun and sky get one each.
    uint32_t emitter_samples = 1;

    bool media() const { return analytic || foreign; }
    /// Rays through media are lit by light sources at a point.
    bool lit() const { return !points.empty(); }
    /// Uniform variates that a flight takes.
    size_t variates() const { return std::min(std::max(components, size_t(foreign)), MaxVariates); }
};

/// Looks at every shape and sensor of `scene`, and at the medium that rays start in.
template <typename Float, typename Spectrum>
Survey survey(const Scene<Float, Spectrum> *scene, const Medium<Float, Spectrum> *initial) {
    using Medium = mitsuba::Medium<Float, Spectrum>;
    Survey found;
    auto look_at = [&](const Medium *medium) {
        if (!medium)
            return;
        if (auto *ours = dynamic_cast<const FormulaMedium<Float, Spectrum> *>(medium)) {
            found.analytic = true;
            found.components = std::max(found.components, ours->components());
            found.chromatic |= medium->has_spectral_extinction();
            found.absorbers |= ours->absorbs();
        } else {
            found.foreign = true;
        }
    };
    for (uint32_t i = 0; i < scene->emitters().size(); ++i) {
        const Emitter<Float, Spectrum> &emitter = *scene->emitters()[i];
        if (has_flag(emitter.flags(), EmitterFlags::DeltaPosition) && emitter.sampling_weight() > 0)
            found.points.push_back(i);
    }
    found.only_points = found.points.size() == scene->emitters().size();
    found.emitter_samples = scene->emitters().size() > 1 ? 2 : 1;
    found.sky = scene->environment() != nullptr;
    look_at(initial);
    for (const auto &sensor : scene->sensors())
        look_at(sensor->medium());
    for (const auto &shape : scene->shapes()) {
        if (shape->is_instance()) { // of a group, which does not tell what it holds
            found.analytic = found.foreign = found.chromatic = found.absorbers = true;
            found.permeable = true;
            found.components = MaxVariates;
            return found;
        }
        look_at(shape->interior_medium());
        look_at(shape->exterior_medium());
        found.permeable |= shape->is_medium_transition() ||
                           (shape->bsdf() && has_flag(shape->bsdf()->flags(), BSDFFlags::Null));
    }
    return found;
}

} // namespace mitsuba
