#pragma once

#include <mitsuba/core/properties.h>
#include <mitsuba/render/volume.h>

namespace mitsuba {

template <typename Float, typename Spectrum>
class AnalyticVolume final : public Volume<Float, Spectrum> {
public:
    MI_IMPORT_BASE(Volume)
    MI_IMPORT_TYPES()

    AnalyticVolume(const Properties &props) : Base(props) {}

    UnpolarizedSpectrum eval(const Interaction3f & /* it */, Mask /* active */) const override {
        return 1.f;
    }

    std::string to_string() const override { return "AnalyticVolume[]"; }

    MI_DECLARE_CLASS(AnalyticVolume)
};

} // namespace mitsuba
