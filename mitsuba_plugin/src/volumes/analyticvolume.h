#pragma once

#include <mitsuba/core/properties.h>
#include <mitsuba/render/interaction.h>
#include <mitsuba/render/volume.h>

#include "extent.h"
#include "profile.h"

namespace mitsuba {

/**!

.. _volume-analyticvolume:

Analytic volume (:monosp:`analyticvolume`)
------------------------------------------

.. pluginparameters::

 * - profile
   - |string|
   - A profile, with the parameters that :ref:`analytic <medium-analytic>` lists for it. (Default:
     ``constant``)

 * - scale
   - |float|
   - Multiplies the density. (Default: 1)
   - |exposed|, |differentiable|

 * - bbox_min, bbox_max
   - |point|
   - Corners of the axis-aligned box, in world space, outside of which the volume is 0.

A density profile as an exact volume, for the stock medium ``heterogeneous``: delta tracking of the
true density, without a grid. ``to_world`` is not supported; profiles have their own axes.

.. tabs::
    .. code-tab:: xml

        <medium type="heterogeneous" id="fog">
            <volume name="sigma_t" type="analyticvolume">
                <string name="profile" value="exponential"/>
                <float name="scale_height" value="20"/>
                <float name="scale" value="0.02"/>
                <point name="bbox_min" x="-500" y="-500" z="0"/>
                <point name="bbox_max" x="500" y="500" z="200"/>
            </volume>
        </medium>

    .. code-tab:: python

        'type': 'heterogeneous',
        'sigma_t': {
            'type': 'analyticvolume',
            'profile': 'exponential',
            'scale_height': 20.0,
            'scale': 0.02,
            'bbox_min': [-500, -500, 0],
            'bbox_max': [500, 500, 200]
        }

*/
template <typename Float, typename Spectrum>
class AnalyticVolume final : public Volume<Float, Spectrum> {
public:
    MI_IMPORT_BASE(Volume, m_bbox, m_channel_count)
    MI_IMPORT_TYPES()

    AnalyticVolume(const Properties &props) : Base(props), m_profile(props), m_extent(props) {
        if (props.has_property("to_world"))
            Throw("to_world is not supported: move the profile by its own parameters");
        if (!m_extent.boxed())
            Throw("\"bbox_min\" is missing: a volume needs bbox_min and bbox_max");
        m_scale = props.get<ScalarFloat>("scale", 1.f);
        if (!(dr::slice(m_scale) >= 0.f) || !dr::isfinite(dr::slice(m_scale)))
            Throw("scale must be finite and >= 0, got %f", dr::slice(m_scale));
        m_bbox = ScalarBoundingBox3f(props.get<ScalarPoint3f>("bbox_min"),
                                     props.get<ScalarPoint3f>("bbox_max"));
        m_channel_count = 1;
        dr::make_opaque(m_scale);
    }

    void traverse(TraversalCallback *cb) override {
        m_profile.traverse(cb);
        cb->put("scale", m_scale, ParamFlags::Differentiable);
    }

    void parameters_changed(const std::vector<std::string> & /* keys */ = {}) override {
        m_profile.update();
        dr::make_opaque(m_scale);
    }

    UnpolarizedSpectrum eval(const Interaction3f &it, Mask active) const override {
        return eval_1(it, active);
    }

    Float eval_1(const Interaction3f &it, Mask active) const override {
        MI_MASKED_FUNCTION(ProfilerPhase::TextureEvaluate, active);
        active &= m_extent.contains(it.p);
        return dr::select(active, m_scale * m_profile.density(it.p), 0.f);
    }

    ScalarFloat max() const override {
        Float sup = m_scale * m_profile.max_in_box(m_bbox.min, m_bbox.max);
        return dr::slice(dr::detach(sup));
    }

    std::string to_string() const override {
        std::ostringstream oss;
        oss << "AnalyticVolume[" << std::endl
            << m_profile.to_string() << m_extent.to_string()
            << "  scale = " << dr::slice(dr::detach(m_scale)) << std::endl
            << "]";
        return oss.str();
    }

    MI_DECLARE_CLASS(AnalyticVolume)

private:
    Profile<Float, Spectrum> m_profile;
    Extent<Float, Spectrum> m_extent;
    Float m_scale;

    MI_TRAVERSE_CB(Base, m_profile, m_extent, m_scale)
};

} // namespace mitsuba
