// What our media have in common: a sum of components, whose optical depth, transmittance and free
// flight are formulas.

#pragma once

#include <mitsuba/core/properties.h>
#include <mitsuba/core/spectrum.h>
#include <mitsuba/render/interaction.h>
#include <mitsuba/render/medium.h>

#include "channels.h"
#include "component.h"
#include "extent.h"

namespace mitsuba {

/// Medium is the only base and comes first: its pointers are ours, in Dr.Jit's registry too.
template <typename Float, typename Spectrum> class FormulaMedium : public Medium<Float, Spectrum> {
public:
    MI_IMPORT_BASE(Medium, m_is_homogeneous, m_has_spectral_extinction)
    MI_IMPORT_TYPES()
    using Component = mitsuba::Component<Float, Spectrum>;

    void parameters_changed(const std::vector<std::string> & /* keys */ = {}) override {
        for (ref<Component> &component : m_components)
            component->parameters_changed();
        m_extent.update();
        update();
    }

    // ---- Stock integrators: delta tracking

    std::tuple<Mask, Float, Float> intersect_aabb(const Ray3f &ray) const override {
        return m_extent.clip(ray);
    }

    UnpolarizedSpectrum get_majorant(const MediumInteraction3f &mi, Mask active) const override {
        MI_MASKED_FUNCTION(ProfilerPhase::MediumEvaluate, active);
        UnpolarizedSpectrum majorant = 0.f;
        for (const ref<Component> &component : m_components)
            majorant += dr::detach(component->sigma_t(mi, active)) * component->bound();
        return majorant;
    }

    std::tuple<UnpolarizedSpectrum, UnpolarizedSpectrum, UnpolarizedSpectrum>
    get_scattering_coefficients(const MediumInteraction3f &mi, Mask active) const override {
        MI_MASKED_FUNCTION(ProfilerPhase::MediumEvaluate, active);
        Mask inside = m_extent.contains(mi.p);
        UnpolarizedSpectrum majorant = 0.f, sigma_t = 0.f, sigma_s = 0.f;
        for (const ref<Component> &component : m_components) {
            Float density = dr::minimum(component->density(mi.p), component->bound());
            density = dr::select(inside, density, 0.f);
            UnpolarizedSpectrum at_one = component->sigma_t(mi, active), part = at_one * density;
            majorant += dr::detach(at_one) * component->bound();
            sigma_t += part;
            sigma_s += part * component->albedo(mi, active);
        }
        return { sigma_s & active, dr::maximum(majorant - sigma_t, 0.f) & active,
                 sigma_t & active };
    }

    // ---- Our integrator: formulas

    /// True. Stock media answer the same call with false.
    bool is_analytic() const { return true; }

    /// Number of components.
    size_t components() const { return m_components.size(); }

    /**
     * Distance of the next collision on `ray`, infinite if there is none in the medium.
     *
     * Components collide independently of each other, so the first of their collisions is that of
     * the sum, and a component needs an inverse only if it comes before those found so far. What
     * there are more than variates are taken for one, whose optical depth is the sum of theirs.
     *
     * \param throughput  of the path so far: the channel to sample is chosen in proportion to it
     * \param u_channel  uniform variate in [0, 1)
     * \param u  uniform variates in [0, 1), as many as there are components
     */
    Float sample_flight(const Ray3f &ray, const UnpolarizedSpectrum &throughput, Float u_channel,
                        const Vector4f &u, Mask active) const {
        MI_MASKED_FUNCTION(ProfilerPhase::MediumSample, active);
        const MediumInteraction3f mi = interaction(ray);
        UInt32 channel = 0;
        if (m_has_spectral_extinction)
            channel = choose_channel(channel_chances(throughput), u_channel);

        auto [hit, near, far] = m_extent.clip(ray);
        near = dr::select(hit, near, 0.f);
        const Point3f o = ray(near);
        Float t = dr::select(hit, far - near, 0.f);
        Mask collides = false;
        auto find = [&](const Float &next) {
            collides |= next < t;
            t = dr::minimum(t, next);
        };
        const size_t count = m_components.size(), alone = count > dr::size_v<Vector4f> ? 3 : count;
        for (size_t i = 0; i < alone; ++i) {
            const Float sigma_t = of_channel(m_components[i]->sigma_t(mi, active), channel);
            find(next_collision(m_components[i]->profile(), o, ray.d, t, optical_depth(u[i]),
                                sigma_t, i == 0));
        }
        if (alone < count) {
            std::vector<const Profile<Float, Spectrum> *> profiles;
            std::vector<Float> sigma_t;
            for (size_t i = alone; i < count; ++i) {
                profiles.push_back(&m_components[i]->profile());
                sigma_t.push_back(of_channel(m_components[i]->sigma_t(mi, active), channel));
            }
            find(Profile<Float, Spectrum>::free_flight(profiles, sigma_t, o, ray.d, t,
                                                       optical_depth(u[alone])));
        }
        return dr::select(active && hit && collides, near + t, dr::Infinity<Float>);
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
        auto [extinction, albedo] = collision(mi, active);
        const UnpolarizedSpectrum weight = dr::select(collided, albedo, 1.f);
        if (!m_has_spectral_extinction)
            return weight;

        const UnpolarizedSpectrum depth = optical_depth(ray, t, mi, active),
                                  chance = channel_chances(throughput);
        // Relative to the thinnest channel that counts, nothing that matters underflows.
        const Float least = thinnest(chance, depth);
        const UnpolarizedSpectrum densities =
            dr::exp(-dr::select(depth > least, depth - least, 0.f)) *
            dr::select(collided, extinction, 1.f);
        return dr::select(chance > 0.f, balance(weight * densities, chance, densities), 0.f);
    }

    /// Transmittance over the distance `t`, which may be infinite.
    UnpolarizedSpectrum transmittance(const Ray3f &ray, Float t, Mask active) const {
        MI_MASKED_FUNCTION(ProfilerPhase::MediumEvaluate, active);
        return dr::exp(-optical_depth(ray, t, interaction(ray), active));
    }

    MI_DECLARE_CLASS(FormulaMedium)

protected:
    FormulaMedium(const Properties &props)
        : Base(props), m_extent(props), m_limited(props.has_property("max_density")) {
        m_is_homogeneous = false;
        const auto limit = props.get<ScalarFloat>("max_density", 1.f);
        if (!(limit > 0.f) || !dr::isfinite(limit))
            Throw("max_density must be finite and > 0, got %f", limit);
        // A box has a bound of its own.
        m_max_density = m_extent.boxed() && !m_limited ? dr::Infinity<ScalarFloat> : limit;
    }

    /// To be called by constructors once there are components; `chromatic`: some of them are.
    void complete(const Properties &props, bool chromatic) {
        m_has_spectral_extinction = props.get<bool>("has_spectral_extinction", chromatic) &&
                                    dr::size_v<UnpolarizedSpectrum> > 1;
        update();
        for (const ref<Component> &component : m_components)
            if (!dr::isfinite(dr::slice(component->bound())))
                Throw("the density has no bound in the box: max_density is needed");
    }

    /// Exposes where the medium ends, and what stock integrators take for its largest density.
    void traverse_extent(TraversalCallback *cb) {
        m_extent.traverse(cb);
        if (!m_extent.boxed() || m_limited)
            cb->put("max_density", m_max_density, ParamFlags::NonDifferentiable);
    }

    std::vector<ref<Component>> m_components;
    Extent<Float, Spectrum> m_extent;
    /// A scene gives `max_density`.
    bool m_limited;
    Float m_max_density;

private:
    void update() {
        dr::make_opaque(m_max_density);
        for (ref<Component> &component : m_components)
            component->find_bound(m_extent, m_max_density);
    }

    /// Of a flight, from a uniform variate.
    static Float optical_depth(const Float &u) { return -dr::log(1.f - u); }

    /// Where one component gathers the optical depth `tau`; any distance beyond `t_max`, if that
    /// comes first. `likely`: there is no point in finding that out before.
    static Float next_collision(const Profile<Float, Spectrum> &profile, const Point3f &o,
                                const Vector3f &d, const Float &t_max, const Float &tau,
                                const Float &sigma_t, bool likely) {
        const Float column = tau / sigma_t;
        if constexpr (!dr::is_jit_v<Float>) {
            if (!(sigma_t > 0.f) || (!likely && profile.column(o, d, t_max) < column))
                return dr::Infinity<Float>;
        }
        return dr::select(sigma_t > 0.f, profile.inv_column(o, d, column), dr::Infinity<Float>);
    }

    /// What coefficients are evaluated at.
    MediumInteraction3f interaction(const Ray3f &ray) const {
        MediumInteraction3f mi = dr::zeros<MediumInteraction3f>();
        mi.wavelengths = ray.wavelengths;
        mi.time = ray.time;
        mi.p = ray.o;
        return mi;
    }

    /// Extinction at a collision, but for a factor that channels share, and the part of it that
    /// is scattering.
    std::pair<UnpolarizedSpectrum, UnpolarizedSpectrum> collision(const MediumInteraction3f &mi,
                                                                  Mask active) const {
        if (m_components.size() == 1) {
            UnpolarizedSpectrum extinction = 1.f;
            if (m_has_spectral_extinction)
                extinction = m_components[0]->sigma_t(mi, active);
            return { extinction, m_components[0]->albedo(mi, active) };
        }
        UnpolarizedSpectrum extinction = 0.f, scattering = 0.f;
        for (const ref<Component> &component : m_components) {
            UnpolarizedSpectrum part = component->sigma_t(mi, active) * component->density(mi.p);
            extinction += part;
            scattering += part * component->albedo(mi, active);
        }
        return { extinction, dr::select(extinction > 0.f, scattering / extinction, 0.f) };
    }

    /// Of the distance `t`, which may be infinite; coefficients do not depend on where `mi` is.
    UnpolarizedSpectrum optical_depth(const Ray3f &ray, const Float &t,
                                      const MediumInteraction3f &mi, Mask active) const {
        auto [hit, near, far] = m_extent.clip(ray);
        const Float length = dr::select(hit, dr::maximum(dr::minimum(t, far) - near, 0.f), 0.f);
        const Point3f o = ray(dr::select(hit, near, 0.f));
        UnpolarizedSpectrum depth = 0.f;
        for (const ref<Component> &component : m_components) {
            const UnpolarizedSpectrum sigma_t = component->sigma_t(mi, active);
            const Float column = component->profile().column(o, ray.d, length);
            // Nothing of an infinite column is nothing.
            depth += dr::select(sigma_t > 0.f, sigma_t * column, 0.f);
        }
        return depth;
    }

    MI_TRAVERSE_CB(Base, m_components, m_extent, m_max_density)
};

} // namespace mitsuba

DRJIT_CALL_TEMPLATE_INHERITED_BEGIN(mitsuba::FormulaMedium, mitsuba::Medium)
DRJIT_CALL_GETTER(is_analytic)
DRJIT_CALL_METHOD(sample_flight)
DRJIT_CALL_METHOD(flight_weight)
DRJIT_CALL_METHOD(transmittance)
DRJIT_CALL_END()
