#pragma once

#include <mitsuba/core/properties.h>
#include <mitsuba/render/medium.h>
#include <mitsuba/render/phase.h>

namespace mitsuba {

template <typename Float, typename Spectrum>
class AnalyticMedium final : public Medium<Float, Spectrum> {
public:
    MI_IMPORT_BASE(Medium)
    MI_IMPORT_TYPES()

    AnalyticMedium(const Properties &props) : Base(props) {}

    std::tuple<Mask, Float, Float> intersect_aabb(const Ray3f & /* ray */) const override {
        return { true, 0.f, dr::Infinity<Float> };
    }

    UnpolarizedSpectrum get_majorant(const MediumInteraction3f & /* mi */,
                                     Mask /* active */) const override {
        return 1.f;
    }

    std::tuple<UnpolarizedSpectrum, UnpolarizedSpectrum, UnpolarizedSpectrum>
    get_scattering_coefficients(const MediumInteraction3f & /* mi */,
                                Mask /* active */) const override {
        return { 0.75f, 0.f, 1.f };
    }

    std::string to_string() const override { return "AnalyticMedium[]"; }

    MI_DECLARE_CLASS(AnalyticMedium)
};

} // namespace mitsuba
