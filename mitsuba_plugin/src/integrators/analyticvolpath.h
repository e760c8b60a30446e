#pragma once

#include <mitsuba/core/properties.h>
#include <mitsuba/render/integrator.h>

namespace mitsuba {

template <typename Float, typename Spectrum>
class AnalyticVolpathIntegrator final : public MonteCarloIntegrator<Float, Spectrum> {
public:
    MI_IMPORT_BASE(MonteCarloIntegrator)
    MI_IMPORT_TYPES(Scene, Sampler, Medium)

    AnalyticVolpathIntegrator(const Properties &props) : Base(props) {}

    std::pair<Spectrum, Mask> sample(const Scene * /* scene */, Sampler * /* sampler */,
                                     const RayDifferential3f & /* ray */,
                                     const Medium * /* medium */, Float * /* aovs */,
                                     Mask active) const override {
        return { Spectrum(0.f), active };
    }

    std::string to_string() const override { return "AnalyticVolpathIntegrator[]"; }

    MI_DECLARE_CLASS(AnalyticVolpathIntegrator)
};

} // namespace mitsuba
