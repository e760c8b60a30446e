// What our media have in common: a sum of components, whose optical depth, transmittance and free
// flight are formulas.

#pragma once

#include <algorithm>
#include <array>

#include <mitsuba/core/properties.h>
#include <mitsuba/core/spectrum.h>
#include <mitsuba/render/interaction.h>
#include <mitsuba/render/medium.h>

#include "channels.h"
#include "component.h"
#include "extent.h"
#include "spectral_sampling.h"

namespace mitsuba {

/// What became of a path on its way through a medium.
template <typename Float, typename UnpolarizedSpectrum> struct Flight {
    /// Distance of the collision, infinite if there is none.
    Float t;
    /// Contribution over probability.
    UnpolarizedSpectrum weight;
    /// Transmittance of all the way.
    UnpolarizedSpectrum past;
    /// Of a collision: it scatters, or it is a null collision; else it absorbs.
    dr::mask_t<Float> scatters, passes;

    DRJIT_STRUCT(Flight, t, weight, past, scatters, passes)
};

/// Variates of a flight, uniform in [0, 1).
template <typename Float> struct FlightVariates {
    /// Whether it collides, and in which channel.
    Float event;
    /// What a collision is.
    Float kind;
    /// Where: as many as there are components.
    Vector<Float, 4> place;

    DRJIT_STRUCT(FlightVariates, event, kind, place)
};

/// Medium is the only base and comes first: its pointers are ours, in Dr.Jit's registry too.
template <typename Float, typename Spectrum> class FormulaMedium : public Medium<Float, Spectrum> {
public:
    MI_IMPORT_BASE(Medium, m_is_homogeneous, m_has_spectral_extinction)
    MI_IMPORT_TYPES()
    using Component = mitsuba::Component<Float, Spectrum>;
    using Flight = mitsuba::Flight<Float, UnpolarizedSpectrum>;
    using FlightVariates = mitsuba::FlightVariates<Float>;

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
    const Component &component(size_t i) const { return *m_components[i]; }
    /// What the medium fills.
    const Extent<Float, Spectrum> &extent() const { return m_extent; }
    /// Whether some of them do not scatter.
    bool absorbs() const {
        return std::any_of(m_components.begin(), m_components.end(),
                           [](const auto &component) { return !component->scatters(); });
    }

    /**
     * A flight along `ray` by the `rules` of an integrator, drawn before it is known where the ray
     * ends: it collides where that is farther.
     *
     * The first collision of several components is the first of any, each of which collides
     * independently. A component that does not scatter only weakens the flight. What there are more
     * than variates are taken for one, whose optical depth is the sum of theirs.
     *
     * \param throughput  of the path so far: where a channel is sampled, it is chosen in proportion
     *    to it
     */
    Flight sample_flight(const FlightRules &rules, const Ray3f &ray, const Float &reach,
                         const UnpolarizedSpectrum &throughput, const FlightVariates &u,
                         Mask active) const {
        MI_MASKED_FUNCTION(ProfilerPhase::MediumSample, active);
        const MediumInteraction3f mi = interaction(ray);
        const Segment segment = inside(ray, reach);
        const Matter matter = this->matter(true, mi, active);
        Drawn drawn{ sampling(rules) };
        if (m_has_spectral_extinction && drawn.from == SpectralSampling::Mis)
            drawn.channel = choose_channel(channel_chances(throughput), u.event);

        Float t = dr::Infinity<Float>;
        const Float tau = -dr::log(1.f - u.place[0]);
        for (size_t i = 0; i < matter.parts(); ++i) {
            const Float own = i > 0 ? -dr::log(1.f - u.place[i]) : tau;
            t = dr::minimum(t, distance(matter, i, segment, drawn, own, false));
        }
        const Mask collides = active && t < segment.length;

        Flight flight{ dr::select(collides, segment.near + t, dr::Infinity<Float>), 1.f, 1.f, false,
                       false };
        if (matter.count > 0 && dr::any_or<true>(collides))
            collide(flight, rules, ray, segment, matter, drawn, dr::select(collides, t, 0.f), tau,
                    1.f, throughput, u.kind, mi, collides);
        return flight;
    }

    /**
     * A flight along `ray` that is known to end at `reach`, which may be infinite.
     *
     * It collides with `gain` times the probability of the model, but at most surely, and is
     * weighted for it. That is of use where the light behind the medium is added without sampling.
     *
     * Think of the components as one behind the other: the optical depth at which the flight ends
     * lies in one of them, which it has met then. Those before it have been passed; those behind
     * it may collide earlier, each independently.
     *
     * \param throughput  of the path so far: where a channel is sampled, it is chosen in proportion
     *    to what it loses
     */
    Flight sample_collision(const FlightRules &rules, const Ray3f &ray, const Float &reach,
                            const Float &gain, const UnpolarizedSpectrum &throughput,
                            const FlightVariates &u, Mask active) const {
        MI_MASKED_FUNCTION(ProfilerPhase::MediumSample, active);
        const MediumInteraction3f mi = interaction(ray);
        const Segment segment = inside(ray, reach);
        Matter matter = this->matter(true, mi, active);
        matter.find_columns(segment);
        const UnpolarizedSpectrum depth = matter.depth(),
                                  through = unabsorbed(segment, segment.length, mi, active);

        // Whether it collides, and what the distance is drawn from.
        const UnpolarizedSpectrum start = channel_chances(throughput);
        Drawn drawn{ sampling(rules) };
        Float natural, lost;
        if (drawn.from == SpectralSampling::Mis) {
            const UnpolarizedSpectrum losses = opacity(depth), loss = start * losses;
            natural = dr::sum(loss);
            if (m_has_spectral_extinction)
                drawn.channel =
                    choose_channel(channel_chances(loss),
                                   u.event / dr::maximum(dr::minimum(gain * natural, 1.f), Tiny));
            lost = of_channel(losses, drawn.channel);
        } else {
            Float sum = 0.f;
            for (size_t i = 0; i < matter.parts(); ++i)
                sum += matter.depth(i, drawn);
            lost = natural = opacity(sum);
        }
        const Float chance = dr::minimum(gain * natural, 1.f);
        Mask collides = active && u.event < chance;

        Float t = dr::Infinity<Float>, tau = 0.f;
        if (dr::any_or<true>(collides)) {
            tau = -dr::log(1.f - u.place[0] * lost);
            t = first_collision(matter, segment, drawn, tau, u.place, collides);
        }
        t = dr::select(collides, t, dr::Infinity<Float>);
        collides &= dr::isfinite(t);

        Flight flight{ segment.near + t, through * passing_weight(drawn, start, depth),
                       through * dr::exp(-depth), false, false };
        if (matter.count > 0 && dr::any_or<true>(collides))
            collide(flight, rules, ray, segment, matter, drawn, dr::select(collides, t, 0.f), tau,
                    natural / dr::maximum(chance, Tiny), throughput, u.kind, mi, collides);
        return flight;
    }

    /// The weight of a flight that `sample_flight` has drawn for longer, and that passes up to the
    /// distance `reach`, which may be infinite.
    UnpolarizedSpectrum passing_weight(const FlightRules &rules, const Ray3f &ray,
                                       const Float &reach, const UnpolarizedSpectrum &throughput,
                                       Mask active) const {
        MI_MASKED_FUNCTION(ProfilerPhase::MediumSample, active);
        const MediumInteraction3f mi = interaction(ray);
        const Segment segment = inside(ray, reach);
        return unabsorbed(segment, segment.length, mi, active) *
               passing_weight(Drawn{ sampling(rules) }, channel_chances(throughput),
                              matter(true, mi, active).depth(segment, segment.length));
    }

    /**
     * What flights along `ray` bring from the distance `t`, for estimates that choose the distance
     * by other means.
     *
     * \return what gets there times the scattering coefficient, 1/length: by tracking, where null
     *    collisions have flights of their own, what has not collided with the majorant; and the
     *    density of the collisions of `sample_flight`, 1/length
     */
    std::pair<UnpolarizedSpectrum, Float> scattering_at(const FlightRules &rules, const Ray3f &ray,
                                                        const Float &t,
                                                        const UnpolarizedSpectrum &throughput,
                                                        Mask active) const {
        MI_MASKED_FUNCTION(ProfilerPhase::MediumEvaluate, active);
        MediumInteraction3f mi = interaction(ray);
        const Segment segment = inside(ray, t);
        Matter matter = this->matter(true, mi, active);
        if (matter.count == 0)
            return { 0.f, 0.f };
        matter.find_columns(segment);
        const UnpolarizedSpectrum depth = matter.depth(),
                                  past = unabsorbed(segment, segment.length, mi, active);
        mi.t = t;
        mi.p = ray(t);
        const Coefficients at = coefficients(matter, mi, active);
        // The factor that coefficients of a single component leave out.
        const Float density = components() == 1 ? matter.component[0]->density(mi.p) : Float(1.f);

        const SpectralSampling from = sampling(rules);
        UnpolarizedSpectrum through = dr::exp(-depth);
        Float pdf = dr::sum(channel_chances(throughput) * at.extinction * through);
        if (from == SpectralSampling::Average)
            pdf = dr::mean(at.extinction) * dr::exp(-dr::mean(depth));
        if (from == SpectralSampling::Tracking) {
            Float sum = 0.f;
            for (size_t i = 0; i < matter.parts(); ++i)
                sum += matter.depth(i, Drawn{ from });
            through = dr::exp(-sum);
            pdf = at.bound * dr::exp(-sum);
        }
        return { through * past * at.scattering() * density, pdf * density };
    }

    /// Transmittance over the distance `t`, which may be infinite.
    UnpolarizedSpectrum transmittance(const Ray3f &ray, Float t, Mask active) const {
        MI_MASKED_FUNCTION(ProfilerPhase::MediumEvaluate, active);
        const MediumInteraction3f mi = interaction(ray);
        const Segment segment = inside(ray, t);
        return unabsorbed(segment, segment.length, mi, active) *
               dr::exp(-matter(true, mi, active).depth(segment, segment.length));
    }

    /// What coefficients along a ray are evaluated at.
    static MediumInteraction3f interaction(const Ray3f &ray) {
        MediumInteraction3f mi = dr::zeros<MediumInteraction3f>();
        mi.wavelengths = ray.wavelengths;
        mi.time = ray.time;
        mi.p = ray.o;
        return mi;
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
        if (m_components.size() > MaxComponents)
            Throw("a medium must have at most %u components, got %u", MaxComponents,
                  m_components.size());
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
    using Drawn = mitsuba::Drawn<UnpolarizedSpectrum>;

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

    /// A path for one channel has a throughput in that one only, which is all that MIS needs; and
    /// channels that are alike need nothing else.
    SpectralSampling sampling(const FlightRules &rules) const {
        const bool single = rules.sampling == SpectralSampling::Single;
        return single || !m_has_spectral_extinction ? SpectralSampling::Mis : rules.sampling;
    }

    /// Nothing of an infinite column is nothing.
    template <typename Value> static Value times(const Value &sigma_t, const Float &column) {
        return dr::select(sigma_t > 0.f, sigma_t * column, 0.f);
    }

    /// Some of the components. Those that have no variate of their own are the last part.
    struct Matter {
        size_t count = 0;
        std::array<const Component *, MaxComponents> component;
        std::array<UnpolarizedSpectrum, MaxComponents> sigma_t;
        std::array<Float, MaxComponents> column;

        size_t parts() const { return std::min(count, dr::size_v<Vector4f>); }
        /// One more than the last component of a part.
        size_t end(size_t part) const { return part + 1 < parts() ? part + 1 : count; }

        void find_columns(const Segment &segment) {
            for (size_t i = 0; i < count; ++i)
                column[i] = component[i]->profile().column(segment.o, segment.d, segment.length);
        }
        UnpolarizedSpectrum depth() const {
            UnpolarizedSpectrum sum = 0.f;
            for (size_t i = 0; i < count; ++i)
                sum += times(sigma_t[i], column[i]);
            return sum;
        }
        /// The optical depth over the distance `t`.
        UnpolarizedSpectrum depth(const Segment &segment, const Float &t) const {
            UnpolarizedSpectrum sum = 0.f;
            for (size_t i = 0; i < count; ++i)
                sum += times(sigma_t[i], component[i]->profile().column(segment.o, segment.d, t));
            return sum;
        }
        /// The optical depth of a part, of what flights are drawn from.
        Float depth(size_t part, const Drawn &drawn) const {
            Float sum = 0.f;
            for (size_t i = part; i < end(part); ++i)
                sum += times(drawn(sigma_t[i]), column[i]);
            return sum;
        }
    };

    /// The components that scatter, or those that do not.
    Matter matter(bool scatters, const MediumInteraction3f &mi, Mask active) const {
        Matter matter;
        for (const ref<Component> &component : m_components) {
            if (component->scatters() != scatters)
                continue;
            matter.component[matter.count] = component.get();
            matter.sigma_t[matter.count++] = component->sigma_t(mi, active);
        }
        return matter;
    }

    /// What gets past the components that do not scatter, over the distance `t`.
    UnpolarizedSpectrum unabsorbed(const Segment &segment, const Float &t,
                                   const MediumInteraction3f &mi, Mask active) const {
        if (!absorbs())
            return 1.f;
        return dr::exp(-matter(false, mi, active).depth(segment, t));
    }

    /// 1 - exp(-depth), as precise for thin media.
    template <typename Value> static Value opacity(const Value &depth) {
        const Value half = dr::tanh(dr::minimum(.5f * depth, 44.f));
        return 2.f * half / (1.f + half);
    }

    /// Distance of the collision of a flight that ends at the optical depth `tau`.
    Float first_collision(const Matter &matter, const Segment &segment, const Drawn &drawn,
                          const Float &tau, const Vector4f &u, const Mask &active) const {
        Float t = dr::Infinity<Float>, rest = tau;
        Mask met = false;
        for (size_t i = 0; i < matter.parts(); ++i) {
            const Float depth = matter.depth(i, drawn);
            const Mask meets = !met && rest < depth;
            // As if there were no other.
            const Float own = i > 0 ? dr::select(met, -dr::log(1.f - u[i]), rest) : rest;
            const Mask collides = active && own < depth && (met || meets);
            if (dr::any_or<true>(collides)) {
                const Float place =
                    dr::minimum(distance(matter, i, segment, drawn, own, true), segment.length);
                t = dr::minimum(t, dr::select(collides, place, dr::Infinity<Float>));
            }
            met |= meets;
            rest = dr::maximum(rest - depth, 0.f);
        }
        return t;
    }

    /// Where a part has gathered the optical depth `tau`; infinite, or beyond the segment, if it
    /// does not, unless it is `known` to.
    Float distance(const Matter &matter, size_t part, const Segment &segment, const Drawn &drawn,
                   const Float &tau, bool known) const {
        if (matter.end(part) == part + 1) {
            const Float sigma_t = drawn(matter.sigma_t[part]);
            const Float column = tau / dr::select(sigma_t > 0.f, sigma_t, 1.f);
            const Profile<Float, Spectrum> &profile = matter.component[part]->profile();
            const Float t = known ? profile.inv_reached_column(segment.o, segment.d, column)
                                  : profile.inv_column(segment.o, segment.d, column);
            return dr::select(sigma_t > 0.f, t, dr::Infinity<Float>);
        }
        std::vector<const Profile<Float, Spectrum> *> profiles;
        std::vector<Float> sigma_t;
        for (size_t i = part; i < matter.end(part); ++i) {
            profiles.push_back(&matter.component[i]->profile());
            sigma_t.push_back(drawn(matter.sigma_t[i]));
        }
        return Profile<Float, Spectrum>::free_flight(profiles, sigma_t, segment.o, segment.d,
                                                     segment.length, tau);
    }

    /// Contribution over probability of a flight that collides with nothing of the optical depth
    /// `depth`.
    UnpolarizedSpectrum passing_weight(const Drawn &drawn, const UnpolarizedSpectrum &start,
                                       const UnpolarizedSpectrum &depth) const {
        if (!m_has_spectral_extinction || drawn.from == SpectralSampling::Tracking)
            return 1.f;
        return over_probability(drawn, start, depth, 1.f);
    }

    /// exp(-depth) `extinction` in every channel, over the probability density of the way: by the
    /// balance heuristic over the channels that might have been chosen, or of the mean.
    ///
    /// In logarithms up to a common factor, so that nothing that matters underflows.
    static UnpolarizedSpectrum over_probability(const Drawn &drawn,
                                                const UnpolarizedSpectrum &start,
                                                const UnpolarizedSpectrum &depth,
                                                const UnpolarizedSpectrum &extinction) {
        if (drawn.from == SpectralSampling::Average) {
            const Float mean = dr::mean(depth), density = dr::mean(extinction);
            const UnpolarizedSpectrum excess = dr::select(depth == mean, 0.f, depth - mean);
            return dr::select(density > 0.f, dr::exp(-excess) * extinction / density, 0.f);
        }
        const Float least = thinnest(start, depth);
        const UnpolarizedSpectrum densities =
            dr::exp(-dr::select(depth > least, depth - least, 0.f)) * extinction;
        return balance(densities, start, densities);
    }

    /// Decides what a flight collides with at the distance `t`, where a single component has
    /// gathered the optical depth `tau`; `scarcity` is the probability of the model that it
    /// collides at all over that of the flight.
    void collide(Flight &flight, const FlightRules &rules, const Ray3f &ray, const Segment &segment,
                 const Matter &matter, const Drawn &drawn, const Float &t, const Float &tau,
                 const Float &scarcity, const UnpolarizedSpectrum &throughput, const Float &u,
                 MediumInteraction3f mi, const Mask &active) const {
        mi.t = segment.near + t;
        mi.p = ray(mi.t);
        const Coefficients at = coefficients(matter, mi, active);
        UnpolarizedSpectrum weight = unabsorbed(segment, t, mi, active) * scarcity;
        Mask scatters = active, passes = false;
        if (drawn.from == SpectralSampling::Tracking) {
            const EventChances<Float> chances =
                event_chances(rules, throughput, at.scattering(), at.absorption(), at.padding());
            scatters &= u < chances.scattering;
            passes = active && !scatters && u < chances.scattering + chances.null;
            const Float chance = dr::select(scatters, chances.scattering, chances.null);
            const Float density = at.bound * chance;
            weight *= dr::select(
                density > 0.f, dr::select(scatters, at.scattering(), at.padding()) / density, 0.f);
        } else {
            UnpolarizedSpectrum real = at.albedo;
            const UnpolarizedSpectrum start = channel_chances(throughput);
            if (m_has_spectral_extinction) {
                const UnpolarizedSpectrum &sigma_t = matter.sigma_t[0];
                const UnpolarizedSpectrum depth =
                    matter.count == 1 ? sigma_t * (tau / dr::maximum(drawn(sigma_t), Tiny))
                                      : matter.depth(segment, t);
                real *= over_probability(drawn, start, depth, at.extinction);
            }
            if (rules.analogue) {
                const Float survival = dr::clip(dr::sum(start * real), 0.f, 1.f);
                scatters &= u < survival;
                real /= dr::maximum(survival, Tiny);
            }
            weight *= real;
        }
        dr::masked(flight.weight, active) = weight;
        flight.scatters = scatters;
        flight.passes = passes;
    }

    /// What scatters at a place: coefficients but for a factor that all have in common.
    struct Coefficients {
        UnpolarizedSpectrum extinction = 0.f, albedo = 0.f;
        /// Majorant of the extinction over the channels.
        Float bound = 0.f;

        UnpolarizedSpectrum scattering() const { return extinction * albedo; }
        UnpolarizedSpectrum absorption() const { return extinction * (1.f - albedo); }
        /// The coefficient of null collisions (article, Eq. 68).
        UnpolarizedSpectrum padding() const { return dr::maximum(bound - extinction, 0.f); }
    };

    Coefficients coefficients(const Matter &matter, const MediumInteraction3f &mi,
                              Mask active) const {
        Coefficients at;
        if (m_components.size() == 1) {
            // Its density is the common factor.
            at.extinction = matter.sigma_t[0];
            at.albedo = matter.component[0]->albedo(mi, active);
            at.bound = dr::max(at.extinction);
            return at;
        }
        UnpolarizedSpectrum scattering = 0.f;
        for (size_t i = 0; i < matter.count; ++i) {
            const UnpolarizedSpectrum part = matter.sigma_t[i] * matter.component[i]->density(mi.p);
            at.extinction += part;
            scattering += part * matter.component[i]->albedo(mi, active);
            at.bound += dr::max(part);
        }
        at.albedo = dr::select(at.extinction > 0.f, scattering / at.extinction, 0.f);
        return at;
    }

    MI_TRAVERSE_CB(Base, m_components, m_extent, m_max_density)
};

} // namespace mitsuba

DRJIT_CALL_TEMPLATE_INHERITED_BEGIN(mitsuba::FormulaMedium, mitsuba::Medium)
DRJIT_CALL_GETTER(is_analytic)
DRJIT_CALL_METHOD(sample_flight)
DRJIT_CALL_METHOD(sample_collision)
DRJIT_CALL_METHOD(passing_weight)
DRJIT_CALL_METHOD(scattering_at)
DRJIT_CALL_METHOD(transmittance)
DRJIT_CALL_END()
