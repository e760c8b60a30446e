#pragma once

#include "media/formula.h"

namespace mitsuba {

/**!

.. _medium-analytic:

Analytic medium (:monosp:`analytic`)
------------------------------------

.. pluginparameters::

 * - profile
   - |string|
   - Where the matter is. In layers: ``constant``, ``linear`` or ``exponential``; around a planet:
     ``spherical``, ``radial_gaussian`` or ``tent``; in a ball: ``gaussian`` or
     ``anisotropic_gaussian``. (Default: ``constant``)

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
   - Absorption and scattering coefficients, in inverse scene units, instead of ``sigma_t`` and
     ``albedo``.
   - |exposed|, |differentiable|

 * - mean_free_path
   - |float|, |spectrum|
   - Instead of ``sigma_t``: its inverse, in scene units, greater than 0.
   - |exposed|, |differentiable|

 * - transmittance, at_distance
   - |float|, |spectrum|
   - Instead of ``sigma_t``: what passes, above 0 and at most 1, over a distance in scene units.
   - |exposed|, |differentiable|

 * - opacity, at_distance
   - |float|, |spectrum|
   - Instead of ``sigma_t``: what does not pass, 0 to below 1, over a distance in scene units.
   - |exposed|, |differentiable|

 * - visibility, contrast
   - |float|, |spectrum|
   - Instead of ``sigma_t``: the distance, in scene units, at which a black object against the
     horizon keeps the contrast, between 0 and 1. (Default contrast: 0.05)
   - |exposed|, |differentiable|

 * - mass_density, mass_attenuation
   - |float|, |spectrum|
   - Instead of ``sigma_t``: their product, from kg/m³ and m²/kg, in 1/m.
   - |exposed|, |differentiable|

 * - number_density, cross_section
   - |float|, |spectrum|
   - Instead of ``sigma_t``: their product, from 1/m³ and m², in 1/m.
   - |exposed|, |differentiable|

 * - extinction_index
   - |float|, |spectrum|
   - Instead of ``sigma_a``, beside ``sigma_s``: the imaginary part of the index of refraction. The
     absorption, in 1/m, is that at the wavelengths of the ray in spectral variants, at 680, 550 and
     440 nm in RGB variants, and at 550 nm in monochrome ones.
   - |exposed|, |differentiable|

 * - scale
   - |float|
   - Multiplies the coefficients; converts those in 1/m where a scene has another unit of length.
     (Default: 1)
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
     ``exponential``, ``spherical``, and ``radial_gaussian`` at the altitude 0.
   - |exposed|, |differentiable|

 * - gradient, density
   - |float|
   - The density is ``max(0, density + gradient * altitude)``. ``linear`` only.
   - |exposed|, |differentiable|

 * - center
   - |point|
   - Of the planet, or of the ball. ``spherical``, ``radial_gaussian``, ``tent``, ``gaussian`` and
     ``anisotropic_gaussian``.
   - |exposed|, |differentiable|

 * - radius
   - |float|
   - Of the planet, in scene units, greater than 0: the altitude of a point is its distance from
     ``center`` less ``radius``. ``spherical``, ``radial_gaussian`` and ``tent``.
   - |exposed|, |differentiable|

 * - height, width
   - |float|
   - The density is 1 at the altitude ``height``, and falls in proportion to the distance from
     there to 0 at ``height - width`` and ``height + width``; in scene units. ``tent`` only.
   - |exposed|, |differentiable|

 * - sigma
   - |float|
   - Standard deviation, in scene units, greater than 0. ``gaussian`` only.
   - |exposed|, |differentiable|

 * - axis_u, axis_v, axis_w
   - |vector|
   - Axes at right angles, whose lengths are the standard deviations, in scene units.
     ``anisotropic_gaussian`` only.
   - |exposed|, |differentiable|

 * - bbox_min, bbox_max
   - |point|
   - Corners of the axis-aligned box, in world space, that the medium fills. Both or neither.
     (Default: all of space)
   - |exposed|

 * - bsphere_center, bsphere_radius
   - |point|, |float|
   - The sphere, in world space, that the medium fills, instead of a box: the end of an atmosphere.
     Both or neither.
   - |exposed|

 * - max_density
   - |float|
   - Stock integrators see the density clamped to this value; they need a bound. (Default: 1
     without a box, none with one)
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
supremum of the density in the box or ``max_density``, whichever is less, as the majorant. A sum of
several is an :ref:`overlap <medium-overlap>`.

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
class AnalyticMedium final : public FormulaMedium<Float, Spectrum> {
public:
    MI_IMPORT_BASE(FormulaMedium, m_phase_function, m_components, m_extent, m_limited, complete,
                   traverse_extent)
    MI_IMPORT_TYPES()

    AnalyticMedium(const Properties &props) : Base(props) {
        m_components.push_back(new Component<Float, Spectrum>(props, m_phase_function.get()));
        complete(props, m_components[0]->chromatic());
    }

    /// The matter alone, for a medium that has its own extent.
    ref<Component<Float, Spectrum>> component() const { return m_components[0]; }
    /// Whether a scene says where the medium ends, or what stock integrators take for its
    /// largest density.
    bool bounded() const { return m_extent.bounded() || m_limited; }

    void traverse(TraversalCallback *cb) override {
        traverse_extent(cb);
        m_components[0]->traverse(cb);
    }

    std::string to_string() const override {
        std::ostringstream oss;
        oss << "AnalyticMedium[" << std::endl
            << m_extent.to_string() << m_components[0]->to_string() << "]";
        return oss.str();
    }

    MI_DECLARE_CLASS(AnalyticMedium)
};

} // namespace mitsuba
