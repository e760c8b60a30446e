#pragma once

#include "media/analytic.h"
#include "media/formula.h"
#include "phase/mixture.h"

namespace mitsuba {

/**!

.. _medium-overlap:

Overlapping media (:monosp:`overlap`)
-------------------------------------

.. pluginparameters::

 * - (Nested plugins)
   - |medium|
   - The components: :ref:`analytic <medium-analytic>` media, 1 to 16, under any names. Each
     has its profile, coefficients and phase function, but neither a box nor a sphere nor
     ``max_density``.
   - |exposed|, |differentiable|

 * - bbox_min, bbox_max
   - |point|
   - Corners of the axis-aligned box, in world space, that the medium fills. Both or neither.
     (Default: all of space)
   - |exposed|

 * - bsphere_center, bsphere_radius
   - |point|, |float|
   - The sphere that the medium fills, instead of a box. Both or neither.
   - |exposed|

 * - max_density
   - |float|
   - Stock integrators see the density of every component clamped to this value. (Default: 1
     without a box, none with one)
   - |exposed|

 * - has_spectral_extinction
   - |bool|
   - Whether the extinction varies with wavelength. (Default: if that of a component does)

 * - sample_emitters
   - |bool|
   - Whether to sample light sources from inside the medium. (Default: yes)

The sum of several analytic media: fog over haze, or the gases and aerosols of an atmosphere. Light
is attenuated by all components, and scattered by the one that it meets: the phase function is a
mixture, weighted at every point and in every channel by what each component scatters there. The
free-flight distance is that of the sum: the first collision of any component, each by its own
inverse. Stock integrators render the same medium by delta tracking.

.. tabs::
    .. code-tab:: xml

        <medium type="overlap" id="air">
            <medium type="analytic" name="fog">
                <string name="profile" value="exponential"/>
                <float name="scale_height" value="20"/>
                <float name="sigma_t" value="0.02"/>
                <float name="albedo" value="0.95"/>
                <phase type="hg"><float name="g" value="0.8"/></phase>
            </medium>
            <medium type="analytic" name="haze">
                <float name="sigma_t" value="0.001"/>
            </medium>
        </medium>

    .. code-tab:: python

        'type': 'overlap',
        'fog': {
            'type': 'analytic',
            'profile': 'exponential',
            'scale_height': 20.0,
            'sigma_t': 0.02,
            'albedo': 0.95,
            'phase': {'type': 'hg', 'g': 0.8}
        },
        'haze': {
            'type': 'analytic',
            'sigma_t': 0.001
        }

*/
template <typename Float, typename Spectrum>
class OverlapMedium final : public FormulaMedium<Float, Spectrum> {
public:
    MI_IMPORT_BASE(FormulaMedium, m_phase_function, m_components, m_extent, complete,
                   traverse_extent)
    MI_IMPORT_TYPES(Medium, PhaseFunction)
    using Analytic = AnalyticMedium<Float, Spectrum>;

    OverlapMedium(const Properties &props) : Base(props) {
        bool chromatic = false;
        for (auto &prop : props.objects()) {
            if (prop.try_get<PhaseFunction>())
                Throw("\"%s\" is a phase function: those of an overlap belong to its components",
                      prop.name());
            if (const Medium *medium = prop.try_get<Medium>()) {
                add(name_of(prop.name(), medium), medium);
                chromatic |= medium->has_spectral_extinction();
            }
        }
        if (m_components.empty())
            Throw("an overlap needs at least one nested medium of the type analytic");
        m_phase_function = new MixturePhaseFunction<Float, Spectrum>(m_components);
        complete(props, chromatic);
    }

    void traverse(TraversalCallback *cb) override {
        traverse_extent(cb);
        for (size_t i = 0; i < m_components.size(); ++i)
            cb->put(m_names[i], m_components[i], ParamFlags::Differentiable);
    }

    std::string to_string() const override {
        std::ostringstream oss;
        oss << "OverlapMedium[" << std::endl << m_extent.to_string();
        for (size_t i = 0; i < m_components.size(); ++i)
            oss << "  " << m_names[i] << " = [" << std::endl
                << "  " << string::indent(m_components[i]->to_string()) << "]," << std::endl;
        oss << "  phase = " << m_phase_function << std::endl << "]";
        return oss.str();
    }

    MI_DECLARE_CLASS(OverlapMedium)

private:
    /// Unnamed plugins of an XML file go by their ids.
    static std::string name_of(std::string_view name, const Medium *medium) {
        const bool unnamed = name.substr(0, 5) == "_arg_" && !medium->id().empty();
        return std::string(unnamed ? medium->id() : name);
    }

    /// Takes over what a nested medium is made of; the medium itself is not kept, for it would
    /// be a part of every kernel.
    void add(const std::string &name, const Medium *medium) {
        const auto *analytic = dynamic_cast<const Analytic *>(medium);
        if (!analytic)
            Throw("\"%s\" must be a medium of the type analytic, got %s", name,
                  medium->class_name());
        if (analytic->bounded())
            Throw("\"%s\" must have no box, no sphere and no max_density of its own: they belong "
                  "to the overlap",
                  name);
        m_components.push_back(analytic->component());
        m_names.push_back(name);
    }

    std::vector<std::string> m_names;
};

} // namespace mitsuba
