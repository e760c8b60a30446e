#pragma once

#include <optional>
#include <vector>

#include <mitsuba/core/properties.h>
#include <mitsuba/core/ray.h>
#include <mitsuba/render/bsdf.h>
#include <mitsuba/render/integrator.h>
#include <mitsuba/render/records.h>
#include <mitsuba/render/sensor.h>
#include <mitsuba/render/shape.h>

#include "integrators/light_source.h"
#include "integrators/single_scattering.h"

namespace mitsuba {

/**!

.. _integrator-airlight:

Air-light (:monosp:`airlight`)
------------------------------

.. pluginparameters::

 * - max_depth
   - |int|
   - 2, so that scenes of path tracers can be rendered: light is scattered once. (Default: 2)

 * - shadow_steps
   - |int|
   - Parts of a ray, at equal angles seen from a light source, that are tested for shadow: those
     whose middle the light does not reach are left dark. 0 leaves the medium without shadows.
     (Default: 0)

Single scattering without noise: the light that a medium scatters towards the camera is a formula
for every ray and light source, not a random walk. Surfaces are lit directly, with shadows, and seen
through the medium. What noise is left is that of the pixel filter, at the edges of things.

The camera is in one :ref:`analytic <medium-analytic>` medium, or looks at its box or sphere from
outside. The profile is ``constant`` for light from ``point`` and ``spot`` emitters; from
``directional`` ones it may be ``exponential`` as well. Of phase functions,
``isotropic``, ``hg`` and ``rayleigh`` are known; directional light takes any. Other emitters, other
media and surfaces that let light through are errors.

The medium itself is not shadowed, unless ``shadow_steps`` says so, and light that is scattered more
than once is left out: the picture is that of ``analyticvolpath`` with ``max_depth`` 2, where
nothing stands between lights and medium. Towards a directional light an exponential medium reaches
to infinity, whatever its box. A constant one is lit through the sides of its box; without a box the
irradiance is that at the camera, for a fog without an end lets no light in. It may not be a sphere.

Source: Pegoraro, Schott and Parker, "An Analytical Approach to Single Scattering for Anisotropic
Media and Light Distributions", Graphics Interface 2009.

.. tabs::
    .. code-tab:: xml

        <integrator type="airlight"/>

    .. code-tab:: python

        'type': 'airlight'

*/
template <typename Float, typename Spectrum>
class AirlightIntegrator final : public SamplingIntegrator<Float, Spectrum> {
public:
    MI_IMPORT_BASE(SamplingIntegrator)
    MI_IMPORT_TYPES(Scene, Sensor, Sampler, Emitter, BSDFPtr, Medium)
    using LightSource = mitsuba::LightSource<Float, Spectrum>;
    using SingleScattering = mitsuba::SingleScattering<Float, Spectrum>;

    AirlightIntegrator(const Properties &props) : Base(props) {
        const int64_t steps = props.get<int64_t>("shadow_steps", 0);
        if (steps < 0 || steps > 4096)
            Throw("shadow_steps must be between 0 (no shadows) and 4096, got %i", steps);
        m_shadow_steps = (uint32_t) steps;
        const int64_t depth = props.get<int64_t>("max_depth", 2);
        if (depth != 2)
            Throw("max_depth must be 2: airlight renders light that is scattered once; got %i",
                  depth);
    }

    TensorXf render(Scene *scene, Sensor *sensor, UInt32 seed, uint32_t spp, bool develop,
                    bool evaluate) override {
        m_prepared.emplace(scene, sensor->medium());
        m_prepared_scene = scene;
        struct Forget {
            AirlightIntegrator &self;
            ~Forget() {
                self.m_prepared_scene = nullptr;
                self.m_prepared.reset();
            }
        } forget{ *this }; // after a failure too: another scene may get the same address
        return Base::render(scene, sensor, seed, spp, develop, evaluate);
    }

    std::pair<Spectrum, Mask> sample(const Scene *scene, Sampler * /* sampler */,
                                     const RayDifferential3f &ray, const Medium *medium,
                                     Float * /* aovs */, Mask active) const override {
        MI_MASKED_FUNCTION(ProfilerPhase::SamplingIntegratorSample, active);
        if (scene == m_prepared_scene)
            return see(scene, *m_prepared, Ray3f(ray), active);
        return see(scene, Prepared(scene, medium), Ray3f(ray), active);
    }

    std::string to_string() const override {
        std::ostringstream oss;
        oss << "AirlightIntegrator[" << std::endl
            << "  shadow_steps = " << m_shadow_steps << std::endl
            << "]";
        return oss.str();
    }

    MI_DECLARE_CLASS(AirlightIntegrator)

private:
    /// What of a scene a picture is made of; anything that has no closed form is an error.
    struct Prepared {
        SingleScattering scattering;
        std::vector<LightSource> lights;

        Prepared(const Scene *scene, const Medium *medium) : scattering(medium) {
            for (const auto &shape : scene->shapes())
                if (shape->is_instance() || shape->is_medium_transition() ||
                    (shape->bsdf() && has_flag(shape->bsdf()->flags(), BSDFFlags::Null)))
                    Throw("airlight: the shape \"%s\" must be opaque, and no instance; a box or a "
                          "sphere can bound the medium",
                          shape->id());
            for (const auto &emitter : scene->emitters()) {
                lights.emplace_back(const_cast<Emitter *>(emitter.get()));
                scattering.require(lights.back());
            }
        }
    };

    /// Radiance along a ray from the camera.
    std::pair<Spectrum, Mask> see(const Scene *scene, const Prepared &prepared, const Ray3f &ray,
                                  const Mask &active) const {
        const SingleScattering &scattering = prepared.scattering;
        const SurfaceInteraction3f si = scene->ray_intersect(ray, active);
        const Mask surface = active && si.is_valid();
        const auto [hit, near, far] = scattering.extent().clip(ray);
        const Float end = dr::minimum(far, si.t);
        const Mask inside = active && hit && near < end;

        Spectrum reflected = 0.f;
        UnpolarizedSpectrum air = 0.f;
        for (const LightSource &light : prepared.lights) {
            reflected += lit(scene, scattering, light, ray, si, surface);
            air += light.spectrum(ray.wavelengths, inside) *
                   in_scattered(scene, scattering, light, ray, near, end, inside);
        }
        const UnpolarizedSpectrum through = scattering.transmittance(ray, si.t, surface);
        const Spectrum result = dr::select(surface, reflected * through, 0.f) +
                                depolarizer<Spectrum>(dr::select(inside, air, 0.f));
        return { result, surface || inside };
    }

    /// Light that a surface reflects towards the camera, as seen from nearby (Eq. 7).
    Spectrum lit(const Scene *scene, const SingleScattering &scattering, const LightSource &light,
                 const Ray3f &ray, const SurfaceInteraction3f &si, Mask active) const {
        if (dr::none_or<false>(active)) // then there is no BSDF to ask
            return 0.f;
        auto [ds, arriving] = light.emitter->sample_direction(si, Point2f(0.f), active);
        const BSDFPtr bsdf = si.bsdf();
        active &= ds.pdf > 0.f && has_flag(bsdf->flags(), BSDFFlags::Smooth);
        const Vector3f wo = si.to_local(ds.d);
        Spectrum value = bsdf->eval(BSDFContext(), si, wo, active);
        value = si.to_world_mueller(value, -wo, si.wi);
        active &= dr::any(unpolarized_spectrum(value * arriving) != 0.f);
        const Ray3f shadow = si.spawn_ray_to(ds.p);
        active &= !scene->ray_test(shadow, active);
        const UnpolarizedSpectrum through =
            scattering.illumination(light, ray, si.t, shadow, ds.dist, active);
        return dr::select(active, value * arriving * through, 0.f);
    }

    /// Light that the medium scatters once into the ray, between the distances `near` and `end`,
    /// per unit intensity or irradiance.
    UnpolarizedSpectrum in_scattered(const Scene *scene, const SingleScattering &scattering,
                                     const LightSource &light, const Ray3f &ray, const Float &near,
                                     const Float &end, const Mask &active) const {
        if (dr::none_or<false>(active))
            return 0.f;
        if (m_shadow_steps == 0)
            return scattering.radiance(light, ray, near, end, active);

        Parts parts{ 0, near, 0.f, active };
        dr::tie(parts) = dr::while_loop(
            dr::make_tuple(parts), [](const Parts &p) { return p.active; },
            [&](Parts &p) { add_part(scene, scattering, light, ray, near, end, p); }, "airlight");
        return parts.sum;
    }

    /// Parts of a ray that have been added up.
    struct Parts {
        UInt32 count;
        /// Where they end.
        Float end;
        UnpolarizedSpectrum sum;
        Mask active;
        DRJIT_STRUCT(Parts, count, end, sum, active)
    };

    /// Adds the next part, if the light reaches its middle.
    void add_part(const Scene *scene, const SingleScattering &scattering, const LightSource &light,
                  const Ray3f &ray, const Float &near, const Float &end, Parts &parts) const {
        const ScalarFloat width = 1.f / (ScalarFloat) m_shadow_steps;
        const Float u = Float(parts.count) * width;
        const Mask last = parts.count + 1u >= m_shadow_steps;
        const Float from = parts.end,
                    to = dr::select(last, end, scattering.part(light, ray, near, end, u + width)),
                    middle = scattering.part(light, ray, near, end, u + .5f * width);
        const Ray3f shadow = light.ray_from(ray(middle), ray);
        const Mask reached = parts.active && !scene->ray_test(shadow, parts.active);
        const UnpolarizedSpectrum in_front = scattering.transmittance(
            Ray3f(ray(near), ray.d, ray.time, ray.wavelengths), from - near, reached);
        dr::masked(parts.sum, reached) +=
            in_front * scattering.radiance(light, ray, from, to, reached);
        parts.end = to;
        parts.count += 1u;
        parts.active &= !last;
    }

    uint32_t m_shadow_steps;
    /// Of the scene that is being rendered.
    std::optional<Prepared> m_prepared;
    const Scene *m_prepared_scene = nullptr;
};

} // namespace mitsuba
