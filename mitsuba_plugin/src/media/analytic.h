#pragma once

#include <mitsuba/core/properties.h>
#include <mitsuba/core/spectrum.h>
#include <mitsuba/render/interaction.h>
#include <mitsuba/render/medium.h>
#include <mitsuba/render/phase.h>
#include <mitsuba/render/volume.h>

#include "coefficients.h"
#include "extent.h"
#include "profile.h"

namespace mitsuba {

/**!

.. _medium-analytic:

Analytic medium (:monosp:`analytic`)
------------------------------------

.. pluginparameters::

 * - profile
   - |string|
   - Where the matter is: ``constant``, ``linear`` or ``exponential``. (Default: ``constant``)

 * - sigma_t
   - |float|, |spectrum|
   - Extinction coefficient where the relative density is 1, in inverse scene units. Constant in
     space. (Default: 1)
   - |exposed|, |differentiable|

 * - albedo
   - |float|, |spectrum| or |volume|
   - Single-scattering albedo, 0 to 1. (Default: 0.75)
   - |exposed|, |differentiable|

 * - sigma_a, sigma_s
   - |float|, |spectrum|
   - Absorption and scattering coefficients, in inverse scene units. Both, and instead of
     ``sigma_t`` and ``albedo``.
   - |exposed|, |differentiable|

 * - scale
   - |float|
   - Multiplies the coefficients. (Default: 1)
   - |exposed|, |differentiable|

 * - up
   - |vector|
   - Unit vector; the altitude of a point x is ``dot(up, x) - base_height``.
     ``linear`` and ``exponential``. (Default: 0, 0, 1)
   - |exposed|, |differentiable|

 * - base_height
   - |float|
   - Where the altitude is 0, in scene units. ``linear`` and ``exponential``. (Default: 0)
   - |exposed|, |differentiable|

 * - scale_height
   - |float|
   - Altitude over which the density falls by a factor e, in scene units, greater than 0.
     ``exponential`` only.
   - |exposed|, |differentiable|

 * - gradient, density
   - |float|
   - The density is ``max(0, density + gradient * altitude)``. ``linear`` only.
   - |exposed|, |differentiable|

 * - bbox_min, bbox_max
   - |point|
   - Corners of the axis-aligned box, in world space, that the medium fills. Both or neither.
     (Default: all of space)
   - |exposed|

 * - max_density
   - |float|
   - Without a box, stock integrators see the density clamped to this value; they need a bound.
     (Default: 1)
   - |exposed|

 * - has_spectral_extinction
   - |bool|
   - Whether the extinction varies with wavelength. (Default: no if it is given as |float|)

 * - sample_emitters
   - |bool|
   - Whether to sample light sources from inside the medium. (Default: yes)

 * - (Nested plugin)
   - |phase|
   - Phase function. (Default: isotropic)
   - |exposed|, |differentiable|

A medium whose optical depth, transmittance and free flight are formulas: no grid, no null
collisions. The integrator :ref:`analyticvolpath <integrator-analyticvolpath>` uses the formulas;
``volpath``, ``volpathmis`` and ``prbvolpath`` render the same medium by delta tracking, with the
supremum of the density in the box as the majorant.

.. tabs::
    .. code-tab:: xml

        <medium type="analytic" id="fog">
            <string name="profile" value="exponential"/>
            <float name="scale_height" value="20"/>
            <float name="sigma_t" value="0.02"/>
            <float name="albedo" value="0.95"/>
            <point name="bbox_min" x="-500" y="-500" z="0"/>
            <point name="bbox_max" x="500" y="500" z="200"/>
        </medium>

    .. code-tab:: python

        'type': 'analytic',
        'profile': 'exponential',
        'scale_height': 20.0,
        'sigma_t': 0.02,
        'albedo': 0.95,
        'bbox_min': [-500, -500, 0],
        'bbox_max': [500, 500, 200]

*/
template <typename Float, typename Spectrum>
class AnalyticMedium final : public Medium<Float, Spectrum> {
public:
    MI_IMPORT_BASE(Medium, m_is_homogeneous, m_has_spectral_extinction, m_phase_function)
    MI_IMPORT_TYPES()

    AnalyticMedium(const Properties &props)
        : Base(props), m_profile(props), m_extent(props), m_coefficients(props) {
        m_is_homogeneous = false;
        m_has_spectral_extinction =
            props.get<bool>("has_spectral_extinction", m_coefficients.chromatic()) &&
            dr::size_v<UnpolarizedSpectrum> > 1;
        if (has_flag(m_phase_function->flags(), PhaseFunctionFlags::Microflake))
            Throw("the phase function must not depend on the direction of travel, got %s",
                  m_phase_function->class_name());
        if (m_extent.bounded() && props.has_property("max_density"))
            Throw("max_density and bbox_min exclude each other: the box has its own bound");
        const auto clamp = props.get<ScalarFloat>("max_density", 1.f);
        if (!(clamp > 0.f) || !dr::isfinite(clamp))
            Throw("max_density must be finite and > 0, got %f", clamp);
        m_max_density = clamp;
        update();
    }

    void traverse(TraversalCallback *cb) override {
        m_profile.traverse(cb);
        m_extent.traverse(cb);
        if (!m_extent.bounded())
            cb->put("max_density", m_max_density, ParamFlags::NonDifferentiable);
        m_coefficients.traverse(cb);
        Base::traverse(cb);
    }

    void parameters_changed(const std::vector<std::string> & /* keys */ = {}) override {
        m_profile.update();
        m_extent.update();
        m_coefficients.update();
        update();
    }

    // ---- Stock integrators: delta tracking

    std::tuple<Mask, Float, Float> intersect_aabb(const Ray3f &ray) const override {
        return m_extent.clip(ray);
    }

    UnpolarizedSpectrum get_majorant(const MediumInteraction3f &mi, Mask active) const override {
        MI_MASKED_FUNCTION(ProfilerPhase::MediumEvaluate, active);
        return dr::detach(m_coefficients.sigma_t(mi, active)) * m_max_density;
    }

    std::tuple<UnpolarizedSpectrum, UnpolarizedSpectrum, UnpolarizedSpectrum>
    get_scattering_coefficients(const MediumInteraction3f &mi, Mask active) const override {
        MI_MASKED_FUNCTION(ProfilerPhase::MediumEvaluate, active);
        Float density = dr::minimum(m_profile.density(mi.p), m_max_density);
        density = dr::select(m_extent.contains(mi.p), density, 0.f);
        UnpolarizedSpectrum at_one = m_coefficients.sigma_t(mi, active), sigma_t = at_one * density,
                            sigma_s = sigma_t * m_coefficients.albedo(mi, active),
                            sigma_n = dr::detach(at_one) * m_max_density - sigma_t;
        return { sigma_s & active, dr::maximum(sigma_n, 0.f) & active, sigma_t & active };
    }

    // ---- Our integrator: formulas

    /// True. Stock media answer the same call with false.
    bool is_analytic() const { return true; }

    /**
     * Distance of the next collision on `ray`, infinite if there is none in the medium.
     *
     * \param throughput  of the path so far: the channel to sample is chosen in proportion to it
     * \param u_channel, u  uniform variates in [0, 1)
     */
    Float sample_flight(const Ray3f &ray, const UnpolarizedSpectrum &throughput, Float u_channel,
                        Float u, Mask active) const {
        MI_MASKED_FUNCTION(ProfilerPhase::MediumSample, active);
        MediumInteraction3f mi = interaction(ray);
        UnpolarizedSpectrum sigma_t = m_coefficients.sigma_t(mi, active);
        Float chosen = sigma_t[0];
        if (m_has_spectral_extinction) {
            UnpolarizedSpectrum weight = selection(throughput);
            Float cdf = 0.f;
            for (size_t i = 0; i + 1 < dr::size_v<UnpolarizedSpectrum>; ++i) {
                cdf += weight[i];
                dr::masked(chosen, u_channel >= cdf) = sigma_t[i + 1];
            }
        }
        Float column = -dr::log(1.f - u) / chosen;
        auto [hit, near, far] = m_extent.clip(ray);
        Float t = near + m_profile.inv_column(ray(dr::select(hit, near, 0.f)), ray.d, column);
        return dr::select(active && hit && t < far && chosen > 0.f, t, dr::Infinity<Float>);
    }

    /**
     * Weight of a flight of length `t` that ends in a collision (`collided`) or at a surface:
     * contribution over probability, by the balance heuristic over the channels that might have
     * been sampled.
     */
    UnpolarizedSpectrum flight_weight(const Ray3f &ray, Float t, Mask collided,
                                      const UnpolarizedSpectrum &throughput, Mask active) const {
        MI_MASKED_FUNCTION(ProfilerPhase::MediumEvaluate, active);
        MediumInteraction3f mi = interaction(ray);
        mi.t = t;
        mi.p = ray(dr::select(collided, t, 0.f));
        UnpolarizedSpectrum weight =
            dr::select(collided, m_coefficients.albedo(mi, active && collided), 1.f);
        if (!m_has_spectral_extinction)
            return weight;

        UnpolarizedSpectrum sigma_t = m_coefficients.sigma_t(mi, active),
                            depth = optical_depth(ray, t, sigma_t), chance = selection(throughput);
        // Relative to the thinnest channel that counts, nothing that matters underflows.
        Float thinnest = dr::min(dr::select(chance > 0.f, depth, dr::Infinity<Float>));
        UnpolarizedSpectrum relative =
            dr::exp(-dr::select(depth > thinnest, depth - thinnest, 0.f)) *
            dr::select(collided, sigma_t, 1.f);
        Float pdf = dr::sum(chance * relative);
        return dr::select(chance > 0.f && pdf > 0.f, weight * relative / pdf, 0.f);
    }

    /// Transmittance over the distance `t`, which may be infinite.
    UnpolarizedSpectrum transmittance(const Ray3f &ray, Float t, Mask active) const {
        MI_MASKED_FUNCTION(ProfilerPhase::MediumEvaluate, active);
        MediumInteraction3f mi = interaction(ray);
        return dr::exp(-optical_depth(ray, t, m_coefficients.sigma_t(mi, active)));
    }

    std::string to_string() const override {
        std::ostringstream oss;
        oss << "AnalyticMedium[" << std::endl
            << m_profile.to_string() << m_extent.to_string() << m_coefficients.to_string()
            << "  phase = " << string::indent(m_phase_function) << std::endl
            << "]";
        return oss.str();
    }

    MI_DECLARE_CLASS(AnalyticMedium)

private:
    /// The bound of the density that stock integrators track against.
    void update() {
        if (m_extent.bounded())
            m_max_density = dr::detach(m_profile.max_in_box(m_extent.min(), m_extent.max()));
        dr::make_opaque(m_max_density);
    }

    /// What coefficients are evaluated at.
    MediumInteraction3f interaction(const Ray3f &ray) const {
        MediumInteraction3f mi = dr::zeros<MediumInteraction3f>();
        mi.wavelengths = ray.wavelengths;
        mi.time = ray.time;
        mi.p = ray.o;
        return mi;
    }

    /// Probability of sampling each channel.
    UnpolarizedSpectrum selection(const UnpolarizedSpectrum &throughput) const {
        UnpolarizedSpectrum weight = dr::maximum(throughput, 0.f);
        Float sum = dr::sum(weight);
        return dr::select(sum > 0.f, weight / sum, 1.f / dr::size_v<UnpolarizedSpectrum>);
    }

    UnpolarizedSpectrum optical_depth(const Ray3f &ray, const Float &t,
                                      const UnpolarizedSpectrum &sigma_t) const {
        auto [hit, near, far] = m_extent.clip(ray);
        Float length = dr::select(hit, dr::maximum(dr::minimum(t, far) - near, 0.f), 0.f);
        Float column = m_profile.column(ray(dr::select(hit, near, 0.f)), ray.d, length);
        return dr::select(sigma_t > 0.f, sigma_t * column, 0.f);
    }

    Profile<Float, Spectrum> m_profile;
    Extent<Float, Spectrum> m_extent;
    Coefficients<Float, Spectrum> m_coefficients;
    Float m_max_density;

    MI_TRAVERSE_CB(Base, m_profile, m_extent, m_coefficients, m_max_density)
};

} // namespace mitsuba

DRJIT_CALL_TEMPLATE_INHERITED_BEGIN(mitsuba::AnalyticMedium, mitsuba::Medium)
DRJIT_CALL_GETTER(is_analytic)
DRJIT_CALL_METHOD(sample_flight)
DRJIT_CALL_METHOD(flight_weight)
DRJIT_CALL_METHOD(transmittance)
DRJIT_CALL_END()
