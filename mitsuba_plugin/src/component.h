// One kind of matter in a medium: where it is, what it does to light, and how it scatters.

#pragma once

#include <mitsuba/core/object.h>
#include <mitsuba/render/phase.h>

#include "coefficients.h"
#include "extent.h"
#include "profile.h"

namespace mitsuba {

/// The most components of a medium, for arrays of them.
constexpr size_t MaxComponents = 16;

template <typename Float, typename Spectrum> class Component final : public Object {
public:
    MI_IMPORT_TYPES(PhaseFunction)
    using Profile = mitsuba::Profile<Float, Spectrum>;
    using Extent = mitsuba::Extent<Float, Spectrum>;

    Component(const Properties &props, PhaseFunction *phase)
        : m_profile(props), m_coefficients(props), m_phase(phase) {
        if (has_flag(phase->flags(), PhaseFunctionFlags::Microflake))
            Throw("the phase function must not depend on the direction of travel, got %s",
                  phase->class_name());
    }

    /// Whether a scene states the extinction by colour or wavelength.
    bool chromatic() const { return m_coefficients.chromatic(); }
    const Profile &profile() const { return m_profile; }
    const Coefficients<Float, Spectrum> &coefficients() const { return m_coefficients; }
    const PhaseFunction *phase() const { return m_phase.get(); }
    /// False if a scene gives the albedo 0, and has not changed anything since.
    bool scatters() const { return m_coefficients.scatters(); }

    /// Relative density at `p`: finite, so that sums and ratios of several are numbers.
    Float density(const Point3f &p) const {
        return dr::minimum(m_profile.density(p), dr::sqrt(dr::Largest<ScalarFloat>));
    }

    /// Extinction coefficient at relative density 1.
    template <typename Interaction>
    UnpolarizedSpectrum sigma_t(const Interaction &it, Mask active) const {
        return m_coefficients.sigma_t(it, active);
    }

    /// Single-scattering albedo.
    template <typename Interaction>
    UnpolarizedSpectrum albedo(const Interaction &it, Mask active) const {
        return m_coefficients.albedo(it, active);
    }

    /// Scattering coefficient at `it`.
    template <typename Interaction>
    UnpolarizedSpectrum scattering(const Interaction &it, Mask active) const {
        return sigma_t(it, active) * albedo(it, active) * density(it.p);
    }

    /// The bound of the density that stock integrators track against.
    const Float &bound() const { return m_bound; }

    /// Finds the bound: the supremum in the box, if there is one, but at most `limit`.
    void find_bound(const Extent &extent, const Float &limit) {
        m_bound = limit;
        if (extent.boxed())
            m_bound = dr::minimum(m_profile.max_in_box(extent.min(), extent.max()), limit);
        m_bound = dr::detach(m_bound);
        dr::make_opaque(m_bound);
    }

    void traverse(TraversalCallback *cb) override {
        m_profile.traverse(cb);
        m_coefficients.traverse(cb);
        cb->put("phase_function", m_phase, ParamFlags::Differentiable);
    }

    void parameters_changed(const std::vector<std::string> & /* keys */ = {}) override {
        m_profile.update();
        m_coefficients.update();
    }

    /// A line for each parameter.
    std::string to_string() const override {
        std::ostringstream oss;
        oss << m_profile.to_string() << m_coefficients.to_string()
            << "  phase = " << string::indent(m_phase) << std::endl;
        return oss.str();
    }

    MI_DECLARE_CLASS(Component)

private:
    Profile m_profile;
    Coefficients<Float, Spectrum> m_coefficients;
    ref<PhaseFunction> m_phase;
    Float m_bound;

    MI_TRAVERSE_CB(Object, m_profile, m_coefficients, m_phase, m_bound)
};

} // namespace mitsuba
