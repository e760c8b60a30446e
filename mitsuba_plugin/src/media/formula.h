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
     * A flight along `ray`: the distance of its collision, infinite if it passes; its weight; and
     * the transmittance of all the way.
     *
     * Flights collide with `gain` times the probability of the model, but at most surely, and are
     * weighted for it. That is of use where the light behind the medium is added without sampling.
     *
     * Think of the components as one behind the other: the optical depth at which the flight ends
     * lies in one of them, which it has met then. Those before it have been passed; those behind
     * it may collide earlier, each independently. A component that does not scatter only weakens
     * the flight. What there are more than variates are taken for one, whose optical depth is the
     * sum of theirs.
     *
     * \param reach  where the flight ends at the latest: may be infinite
     * \param throughput  of the path so far: the channel to sample is chosen in proportion to
     *    what it loses
     * \param u_event  uniform variate in [0, 1)
     * \param u  uniform variates in [0, 1), as many as there are components
     */
    std::tuple<Float, UnpolarizedSpectrum, UnpolarizedSpectrum>
    sample_flight(const Ray3f &ray, const Float &reach, const Float &gain,
                  const UnpolarizedSpectrum &throughput, const Float &u_event, const Vector4f &u,
                  Mask active) const {
        MI_MASKED_FUNCTION(ProfilerPhase::MediumSample, active);
        const MediumInteraction3f mi = interaction(ray);
        const Segment segment = inside(ray, reach);
        const std::vector<Part> parts = sampled_parts(segment, mi, active);
        UnpolarizedSpectrum depth = 0.f;
        for (const Part &part : parts)
            depth += part.depth;
        const UnpolarizedSpectrum past =
            dr::exp(-(depth + absorbed(segment, segment.length, mi, active)));

        // Whether it collides, and in which channel.
        const UnpolarizedSpectrum start = channel_chances(throughput), lost = opacity(depth),
                                  loss = start * lost;
        const Float natural = dr::sum(loss), chance = dr::minimum(gain * natural, 1.f),
                    safe = dr::maximum(chance, Tiny);
        Mask collides = active && u_event < chance;
        UInt32 channel = 0;
        if (m_has_spectral_extinction)
            channel = choose_channel(channel_chances(loss), u_event / safe);

        Float t = dr::Infinity<Float>;
        if (dr::any_or<true>(collides))
            t = first_collision(parts, segment, channel, of_channel(lost, channel), u, collides);
        t = dr::select(collides, t, dr::Infinity<Float>);
        collides &= dr::isfinite(t);

        UnpolarizedSpectrum weight = passing_weight(segment, start, depth, mi, active);
        if (dr::any_or<true>(collides))
            weight = dr::select(
                collides,
                collision_weight(ray, segment, dr::select(collides, t, 0.f), start, mi, active) *
                    (natural / safe),
                weight);
        return { segment.near + t, weight, past };
    }

    /// Transmittance over the distance `t`, which may be infinite.
    UnpolarizedSpectrum transmittance(const Ray3f &ray, Float t, Mask active) const {
        MI_MASKED_FUNCTION(ProfilerPhase::MediumEvaluate, active);
        const MediumInteraction3f mi = interaction(ray);
        const Segment segment = inside(ray, t);
        return dr::exp(-(depth_of(true, segment, segment.length, mi, active) +
                         absorbed(segment, segment.length, mi, active)));
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
    /// Stands for probabilities of 0 in denominators.
    static constexpr ScalarFloat Tiny = 1e-30f;

    void update() {
        dr::make_opaque(m_max_density);
        for (ref<Component> &component : m_components)
            component->find_bound(m_extent, m_max_density);
    }

    /// The part of a ray that is inside the medium.
    struct Segment {
        Point3f o;
        Vector3f d;
        /// Distance of `o` from the origin of the ray.
        Float near;
        /// 0 if the ray misses the medium; may be infinite.
        Float length;
    };

    Segment inside(const Ray3f &ray, const Float &reach) const {
        auto [hit, near, far] = m_extent.clip(ray);
        near = dr::select(hit, near, 0.f);
        return { ray(near), ray.d, near,
                 dr::select(hit, dr::maximum(dr::minimum(reach, far) - near, 0.f), 0.f) };
    }

    /// Components whose flights are sampled together: one, or those beyond the variates.
    struct Part {
        std::vector<const Component *> components;
        std::vector<UnpolarizedSpectrum> sigma_t;
        /// Optical depth of the segment.
        UnpolarizedSpectrum depth = 0.f;
    };

    std::vector<Part> sampled_parts(const Segment &segment, const MediumInteraction3f &mi,
                                    Mask active) const {
        std::vector<Part> parts;
        for (const ref<Component> &component : m_components) {
            if (!component->scatters())
                continue;
            if (parts.size() < dr::size_v<Vector4f>)
                parts.emplace_back();
            Part &part = parts.back();
            const UnpolarizedSpectrum sigma_t = component->sigma_t(mi, active);
            part.components.push_back(component.get());
            part.sigma_t.push_back(sigma_t);
            part.depth += optical_depth(sigma_t, *component, segment, segment.length);
        }
        return parts;
    }

    /// Of one component over the distance `t`.
    static UnpolarizedSpectrum optical_depth(const UnpolarizedSpectrum &sigma_t,
                                             const Component &component, const Segment &segment,
                                             const Float &t) {
        const Float column = component.profile().column(segment.o, segment.d, t);
        // Nothing of an infinite column is nothing.
        return dr::select(sigma_t > 0.f, sigma_t * column, 0.f);
    }

    /// Optical depth of what scatters, or of what does not.
    UnpolarizedSpectrum depth_of(bool scattering, const Segment &segment, const Float &t,
                                 const MediumInteraction3f &mi, Mask active) const {
        UnpolarizedSpectrum depth = 0.f;
        for (const ref<Component> &component : m_components)
            if (component->scatters() == scattering)
                depth += optical_depth(component->sigma_t(mi, active), *component, segment, t);
        return depth;
    }

    UnpolarizedSpectrum absorbed(const Segment &segment, const Float &t,
                                 const MediumInteraction3f &mi, Mask active) const {
        return depth_of(false, segment, t, mi, active);
    }

    /// 1 - exp(-depth), as precise for thin media.
    static UnpolarizedSpectrum opacity(const UnpolarizedSpectrum &depth) {
        const UnpolarizedSpectrum half = dr::tanh(dr::minimum(.5f * depth, 44.f));
        return 2.f * half / (1.f + half);
    }

    /// Optical depths relative to the thinnest channel that counts: nothing that matters
    /// underflows.
    static UnpolarizedSpectrum relative(const UnpolarizedSpectrum &chance,
                                        const UnpolarizedSpectrum &depth) {
        const Float least = thinnest(chance, depth);
        return dr::select(depth > least, depth - least, 0.f);
    }

    /// Distance of the collision of a flight that has one, of the probability `lost`.
    Float first_collision(const std::vector<Part> &parts, const Segment &segment,
                          const UInt32 &channel, const Float &lost, const Vector4f &u,
                          const Mask &active) const {
        Float t = dr::Infinity<Float>, rest = -dr::log(1.f - u[0] * lost);
        Mask met = false;
        for (size_t i = 0; i < parts.size(); ++i) {
            const Float depth = of_channel(parts[i].depth, channel);
            const Mask meets = !met && rest < depth;
            // As if there were no other.
            const Float own = i > 0 ? dr::select(met, -dr::log(1.f - u[i]), rest) : rest;
            const Mask collides = active && own < depth && (met || meets);
            if (dr::any_or<true>(collides))
                t = dr::minimum(t, dr::select(collides, distance(parts[i], segment, channel, own),
                                              dr::Infinity<Float>));
            met |= meets;
            rest = dr::maximum(rest - depth, 0.f);
        }
        return t;
    }

    /// Where a part has gathered the optical depth `tau`, which it does in the segment.
    Float distance(const Part &part, const Segment &segment, const UInt32 &channel,
                   const Float &tau) const {
        if (part.components.size() == 1) {
            const Float sigma_t = of_channel(part.sigma_t[0], channel);
            const Float t = part.components[0]->profile().inv_column(
                segment.o, segment.d, tau / dr::select(sigma_t > 0.f, sigma_t, 1.f));
            return dr::minimum(t, segment.length);
        }
        std::vector<const Profile<Float, Spectrum> *> profiles;
        std::vector<Float> sigma_t;
        for (size_t i = 0; i < part.components.size(); ++i) {
            profiles.push_back(&part.components[i]->profile());
            sigma_t.push_back(of_channel(part.sigma_t[i], channel));
        }
        const Float t = Profile<Float, Spectrum>::free_flight(profiles, sigma_t, segment.o,
                                                              segment.d, segment.length, tau);
        return dr::minimum(t, segment.length);
    }

    /// Contribution over probability of a flight without collision, by the balance heuristic over
    /// the channels that might have been sampled.
    UnpolarizedSpectrum passing_weight(const Segment &segment, const UnpolarizedSpectrum &start,
                                       const UnpolarizedSpectrum &depth,
                                       const MediumInteraction3f &mi, Mask active) const {
        const UnpolarizedSpectrum through = dr::exp(-absorbed(segment, segment.length, mi, active));
        if (!m_has_spectral_extinction)
            return through;
        const UnpolarizedSpectrum densities = dr::exp(-relative(start, depth));
        return balance(through * densities, start, densities);
    }

    /// The same of a collision at the distance `t`.
    UnpolarizedSpectrum collision_weight(const Ray3f &ray, const Segment &segment, const Float &t,
                                         const UnpolarizedSpectrum &start, MediumInteraction3f mi,
                                         Mask active) const {
        mi.t = segment.near + t;
        mi.p = ray(mi.t);
        auto [extinction, albedo] = collision(mi, active);
        const UnpolarizedSpectrum weight = albedo * dr::exp(-absorbed(segment, t, mi, active));
        if (!m_has_spectral_extinction)
            return weight;
        const UnpolarizedSpectrum depth = depth_of(true, segment, t, mi, active),
                                  densities = dr::exp(-relative(start, depth)) * extinction;
        return balance(weight * densities, start, densities);
    }

    /// What coefficients are evaluated at.
    MediumInteraction3f interaction(const Ray3f &ray) const {
        MediumInteraction3f mi = dr::zeros<MediumInteraction3f>();
        mi.wavelengths = ray.wavelengths;
        mi.time = ray.time;
        mi.p = ray.o;
        return mi;
    }

    /// Extinction by what scatters, but for a factor that channels share, and the part of it that
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
            if (!component->scatters())
                continue;
            UnpolarizedSpectrum part = component->sigma_t(mi, active) * component->density(mi.p);
            extinction += part;
            scattering += part * component->albedo(mi, active);
        }
        return { extinction, dr::select(extinction > 0.f, scattering / extinction, 0.f) };
    }

    MI_TRAVERSE_CB(Base, m_components, m_extent, m_max_density)
};

} // namespace mitsuba

DRJIT_CALL_TEMPLATE_INHERITED_BEGIN(mitsuba::FormulaMedium, mitsuba::Medium)
DRJIT_CALL_GETTER(is_analytic)
DRJIT_CALL_METHOD(sample_flight)
DRJIT_CALL_METHOD(transmittance)
DRJIT_CALL_END()
