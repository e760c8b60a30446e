// Light that a medium of a scene scatters once, in closed form: questions of the C ABI.

#pragma once

#include <array>
#include <string>

#include <mitsuba/core/ray.h>
#include <mitsuba/render/medium.h>
#include <mitsuba/render/phase.h>

#include "bridge.h"
#include "integrators/equiangular.h"
#include "integrators/light_source.h"
#include "media/formula.h"

namespace mitsuba {

template <typename Float, typename Spectrum> class SingleScattering {
public:
    MI_IMPORT_TYPES(Medium, PhaseFunction, PhaseFunctionContext)
    using FormulaMedium = mitsuba::FormulaMedium<Float, Spectrum>;
    using Component = mitsuba::Component<Float, Spectrum>;
    using Extent = mitsuba::Extent<Float, Spectrum>;
    using LightSource = mitsuba::LightSource<Float, Spectrum>;

    /// Of a medium of ours with one component, constant or exponential: others are an error.
    explicit SingleScattering(const Medium *medium) {
        if (!medium)
            Throw("airlight: the sensor is in no medium; nest a medium in it, or refer to one");
        m_medium = dynamic_cast<const FormulaMedium *>(medium);
        if (!m_medium)
            Throw("airlight: the medium %s \"%s\" must be an analytic one", medium->class_name(),
                  medium->id());
        if (m_medium->components() != 1)
            Throw("airlight: the medium \"%s\" must have one component, got %u", medium->id(),
                  m_medium->components());
        const std::string &profile = matter().profile().name();
        m_constant = profile == "constant";
        if (!m_constant && profile != "exponential")
            Throw("airlight: the profile of the medium \"%s\" must be constant or exponential, got "
                  "\"%s\"",
                  medium->id(), profile);
        matter().coefficients().require_uniform();
    }

    const Extent &extent() const { return m_medium->extent(); }

    /// Throws unless what the medium scatters of this light has a closed form.
    void require(const LightSource &light) const {
        if (light.directional()) {
            if (m_constant && extent().bounded() && !extent().boxed())
                Throw("airlight: the medium \"%s\" is constant and a sphere, in which the way of "
                      "light from \"%s\" has no closed form; give it a box, or no bounds",
                      m_medium->id(), light.emitter->id());
            return;
        }
        if (!m_constant)
            Throw("airlight: the medium \"%s\" must be constant for light of \"%s\"; exponential "
                  "ones are for directional light",
                  m_medium->id(), light.emitter->id());
        if (!dr::all_nested(extent().contains(light.position)))
            Throw("airlight: the light \"%s\" must be inside of the medium \"%s\"",
                  light.emitter->id(), m_medium->id());
        phase_kind();
    }

    /// Transmittance over the distance `t` of a ray.
    UnpolarizedSpectrum transmittance(const Ray3f &ray, const Float &t, Mask active) const {
        return m_medium->transmittance(ray, t, active);
    }

    /**
     * What the medium leaves of the light on its way to a surface.
     *
     * \param ray     from the camera to the surface, in the distance `t`
     * \param shadow  from the surface to the light, in the distance `distance`
     */
    UnpolarizedSpectrum illumination(const LightSource &light, const Ray3f &ray, const Float &t,
                                     const Ray3f &shadow, const Float &distance,
                                     Mask active) const {
        if (!light.directional())
            return transmittance(shadow, distance, active);
        if (in_box())
            return transmittance(shadow, dr::Infinity<Float>, active);
        // A constant fog has no end: irradiance is that at the camera.
        const Float column =
            m_constant ? -t * dr::dot(ray.d, shadow.d)
                       : matter().profile().column(shadow.o, shadow.d, dr::Infinity<Float>);
        const UnpolarizedSpectrum sigma_t = this->sigma_t(ray, active);
        return dr::exp(-dr::select(sigma_t > 0.f, sigma_t * column, 0.f));
    }

    /// Radiance that the segment of `ray` from `t0` to `t1` scatters towards `t0`, per unit
    /// intensity or irradiance of the light.
    UnpolarizedSpectrum radiance(const LightSource &light, const Ray3f &ray, const Float &t0,
                                 const Float &t1, Mask active) const {
        const UnpolarizedSpectrum extinction = sigma_t(ray, active),
                                  scattering =
                                      extinction *
                                      matter().albedo(FormulaMedium::interaction(ray), active);
        if (!light.directional())
            return from_point(light, ray, t0, t1, scattering, extinction);
        MediumInteraction3f mi = FormulaMedium::interaction(ray);
        mi.wi = -ray.d;
        mi.sh_frame = Frame3f(mi.wi);
        const Spectrum phase =
            matter()
                .phase()
                ->eval_pdf(PhaseFunctionContext(nullptr), mi, -light.axis, active)
                .first;
        return unpolarized_spectrum(phase) *
               from_sun(light, ray(t0), ray.d, t1 - t0, scattering, extinction);
    }

    /// Ends of the part `i` of `n` of a segment: at equal angles seen from a light at a point; of
    /// equal loss on the way, where the light is directional.
    Float part(const LightSource &light, const Ray3f &ray, const Float &t0, const Float &t1,
               const Float &u) const {
        const Point3f o = ray(t0);
        if (!light.directional())
            return t0 +
                   Equiangular<Vector3f>(light.position - o, ray.d, t1 - t0, Float(1.f)).sample(u);
        const auto &profile = matter().profile();
        const Float sigma = dr::max(sigma_t(ray, true)), column = profile.column(o, ray.d, t1 - t0),
                    loss = 1.f - dr::exp(-sigma * column),
                    wanted = -dr::log(dr::maximum(1.f - u * loss, 0.f)) / sigma;
        return t0 + dr::select(wanted < column, profile.inv_column(o, ray.d, wanted), t1 - t0);
    }

private:
    static constexpr size_t Channels = dr::size_v<UnpolarizedSpectrum>;

    /// Whether directional light enters the medium through the sides of a box.
    bool in_box() const { return m_constant && extent().boxed(); }

    const Component &matter() const { return m_medium->component(0); }

    UnpolarizedSpectrum sigma_t(const Ray3f &ray, Mask active) const {
        return matter().sigma_t(FormulaMedium::interaction(ray), active);
    }

    /// The kind of the medium's phase function, as the C ABI numbers it; another is an error.
    uint32_t phase_kind() const {
        const std::string_view name = matter().phase()->class_name();
        if (name == "IsotropicPhaseFunction")
            return AM_PHASE_KIND_ISOTROPIC;
        if (name == "RayleighPhaseFunction")
            return AM_PHASE_KIND_RAYLEIGH;
        if (name == "HGPhaseFunction")
            return AM_PHASE_KIND_HENYEY_GREENSTEIN;
        Throw(
            "airlight: the phase function of the medium \"%s\" must be isotropic, hg or rayleigh, "
            "got %s",
            m_medium->id(), name);
    }

    /// Mean cosine of the phase function.
    Float mean_cosine() const {
        if (phase_kind() != AM_PHASE_KIND_HENYEY_GREENSTEIN)
            return 0.f;
        auto *phase = const_cast<PhaseFunction *>(matter().phase());
        return Exposed(phase).template value<Float>("g");
    }

    static uint32_t light_kind(const LightSource &light) {
        return light.kind == LightSource::Kind::Spot ? AM_LIGHT_KIND_CONE : AM_LIGHT_KIND_ISOTROPIC;
    }

    UnpolarizedSpectrum from_point(const LightSource &light, const Ray3f &ray, const Float &t0,
                                   const Float &t1, const UnpolarizedSpectrum &sigma_s,
                                   const UnpolarizedSpectrum &sigma_t) const {
        UnpolarizedSpectrum result;
        if constexpr (dr::is_jit_v<Float>) {
            Tape<Float> tape;
            am_airlight_nodes air{};
            const auto scattering = tape.inputs(sigma_s), extinction = tape.inputs(sigma_t);
            air.light.kind = light_kind(light);
            copy(tape.inputs(light.position), air.light.position);
            copy(tape.inputs(light.axis), air.light.axis);
            air.light.cutoff_angle = tape.input(light.cutoff);
            air.light.beam_width = tape.input(light.beam_width);
            air.phase = { phase_kind(), tape.input(mean_cosine()) };
            air.sigma_s = scattering.data();
            air.sigma_t = extinction.data();
            air.n_channels = Channels;
            const auto o = tape.inputs(ray.o), d = tape.inputs(ray.d);
            std::array<am_node, Channels> out;
            tape.finish(am_airlight_radiance_record(tape.table(), &air, o.data(), d.data(),
                                                    tape.input(t0), tape.input(t1), out.data()));
            for (size_t i = 0; i < Channels; ++i)
                result[i] = tape[out[i]];
        } else {
            const auto scattering = numbers(sigma_s), extinction = numbers(sigma_t);
            am_airlight air{};
            air.light.kind = light_kind(light);
            copy(light.position, air.light.position);
            copy(light.axis, air.light.axis);
            air.light.cutoff_angle = light.cutoff;
            air.light.beam_width = light.beam_width;
            air.phase = { phase_kind(), mean_cosine() };
            air.sigma_s = scattering.data();
            air.sigma_t = extinction.data();
            air.n_channels = Channels;
            am_airlight_radiance_f32(&air, ray.o.data(), ray.d.data(), t0, t1, result.data());
        }
        return result;
    }

    UnpolarizedSpectrum from_sun(const LightSource &light, const Point3f &o, const Vector3f &d,
                                 const Float &t, const UnpolarizedSpectrum &sigma_s,
                                 const UnpolarizedSpectrum &sigma_t) const {
        const Vector3f sun = -light.axis;
        UnpolarizedSpectrum result;
        if constexpr (dr::is_jit_v<Float>) {
            Tape<Float> tape;
            const auto scattering = tape.inputs(sigma_s), extinction = tape.inputs(sigma_t);
            const am_sunlit_fog_nodes fog{ matter().profile().record_parameters(tape),
                                           scattering.data(), extinction.data(), Channels };
            const auto from = tape.inputs(o), along = tape.inputs(d), towards = tape.inputs(sun);
            std::array<am_node, Channels> out;
            const am_node length = tape.input(t), phase = tape.input(Float(1.f));
            if (in_box()) {
                const auto min = tape.inputs(extent().min()), max = tape.inputs(extent().max());
                tape.finish(am_sunlit_fog_radiance_in_box_record(
                    tape.table(), &fog, from.data(), along.data(), length, towards.data(), phase,
                    min.data(), max.data(), out.data()));
            } else {
                tape.finish(am_sunlit_fog_radiance_record(tape.table(), &fog, from.data(),
                                                          along.data(), length, towards.data(),
                                                          phase, out.data()));
            }
            for (size_t i = 0; i < Channels; ++i)
                result[i] = tape[out[i]];
        } else {
            const auto scattering = numbers(sigma_s), extinction = numbers(sigma_t);
            const am_sunlit_fog fog{ matter().profile().plain(), scattering.data(),
                                     extinction.data(), Channels };
            if (in_box())
                am_sunlit_fog_radiance_in_box_f32(&fog, o.data(), d.data(), t, sun.data(), 1.f,
                                                  extent().min().data(), extent().max().data(),
                                                  result.data());
            else
                am_sunlit_fog_radiance_f32(&fog, o.data(), d.data(), t, sun.data(), 1.f,
                                           result.data());
        }
        return result;
    }

    static std::array<double, Channels> numbers(const UnpolarizedSpectrum &values) {
        std::array<double, Channels> numbers;
        copy(values, numbers);
        return numbers;
    }

    template <typename From, typename To> static void copy(const From &from, To &to) {
        for (size_t i = 0; i < std::size(to); ++i)
            to[i] = from[i];
    }

    const FormulaMedium *m_medium = nullptr;
    bool m_constant = false;
};

} // namespace mitsuba
