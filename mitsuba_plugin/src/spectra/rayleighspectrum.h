#pragma once

#include <mitsuba/core/properties.h>
#include <mitsuba/render/interaction.h>
#include <mitsuba/render/texture.h>

#include "functions.h"
#include "wavelengths.h"

namespace mitsuba {

/**!

.. _spectrum-rayleighspectrum:

Rayleigh scattering of air (:monosp:`rayleighspectrum`)
-------------------------------------------------------

.. pluginparameters::

 * - number_density
   - |float|
   - Molecules per cubic metre. (Default: 2.546899e25, at 288.15 K and 1013.25 hPa)
   - |exposed|, |differentiable|

The scattering coefficient of dry air, in 1/m, which is its extinction too: Bodhaine et al. (1999),
Eq. 29. At the wavelengths of the ray in spectral variants, at 680, 550 and 440 nm in RGB variants,
and at 550 nm in monochrome ones. For other units of length, give the medium a ``scale``.

.. tabs::
    .. code-tab:: xml

        <medium type="analytic">
            <spectrum type="rayleighspectrum" name="sigma_t"/>
            <float name="albedo" value="1"/>
            <phase type="rayleigh"/>
        </medium>

    .. code-tab:: python

        'type': 'analytic',
        'sigma_t': {'type': 'rayleighspectrum'},
        'albedo': 1.0,
        'phase': {'type': 'rayleigh'}

*/
template <typename Float, typename Spectrum>
class RayleighSpectrum final : public Texture<Float, Spectrum> {
public:
    MI_IMPORT_BASE(Texture)
    MI_IMPORT_TYPES()

    RayleighSpectrum(const Properties &props) : Base(props) {
        m_number_density =
            props.get<ScalarFloat>("number_density", (ScalarFloat) AM_STANDARD_NUMBER_DENSITY);
        check();
        dr::make_opaque(m_number_density);
    }

    void traverse(TraversalCallback *cb) override {
        cb->put("number_density", m_number_density, ParamFlags::Differentiable);
    }

    void parameters_changed(const std::vector<std::string> & /* keys */ = {}) override {
        if constexpr (!dr::is_jit_v<Float>)
            check();
        dr::make_opaque(m_number_density);
    }

    UnpolarizedSpectrum eval(const SurfaceInteraction3f &si, Mask active) const override {
        MI_MASKED_FUNCTION(ProfilerPhase::TextureEvaluate, active);
        return m_number_density * AM_FUNCTION(am_rayleigh_air).channels(wavelengths<Spectrum>(si));
    }

    ScalarFloat max() const override {
        double cross_section = 0.0;
        am_rayleigh_air_f64(shortest_wavelength<Spectrum>(), &cross_section);
        return (ScalarFloat) (density() * cross_section);
    }

    std::string to_string() const override {
        std::ostringstream oss;
        oss << "RayleighSpectrum[number_density = " << density() << "]";
        return oss.str();
    }

    MI_DECLARE_CLASS(RayleighSpectrum)

private:
    double density() const { return dr::slice(dr::detach(m_number_density)); }

    void check() const {
        const std::string problem =
            AM_FUNCTION(am_sigma_t_from_number).problem(density(), 1.0 /* cross-section */);
        if (!problem.empty())
            Throw("%s", problem);
    }

    Float m_number_density;

    MI_TRAVERSE_CB(Base, m_number_density)
};

} // namespace mitsuba
