#pragma once

#include <functional>
#include <type_traits>

#include <mitsuba/core/properties.h>
#include <mitsuba/core/ray.h>
#include <mitsuba/render/bsdf.h>
#include <mitsuba/render/emitter.h>
#include <mitsuba/render/integrator.h>
#include <mitsuba/render/phase.h>
#include <mitsuba/render/records.h>

#include "channels.h"
#include "integrators/distance_sampling.h"
#include "integrators/lit_segment.h"
#include "integrators/spread.h"
#include "integrators/survey.h"
#include "spectral_sampling.h"

namespace mitsuba {

/**!

.. _integrator-analyticvolpath:

Analytic volumetric path tracer (:monosp:`analyticvolpath`)
-----------------------------------------------------------

.. pluginparameters::

 * - max_depth
   - |int|
   - Longest path depth, -1 for no limit: 1 is directly visible light, 2 single scattering, and so
     on. (Default: -1)

 * - rr_depth
   - |int|
   - Path depth after which Russian roulette may end a path: those that carry less than two
     fifths of what they began with. (Default: 1; stock integrators take 5)

 * - hide_emitters
   - |bool|
   - Hide directly visible emitters. (Default: no)

 * - emitter_samples
   - |int|
   - Light samples per vertex, stratified over the light sources, of which one is traced: that is
     chosen by the light it would bring. (Default: 0, which stands for 2 where there are several
     light sources, such as sun and sky, and for 1 otherwise)

 * - paths
   - |int|
   - Paths per camera ray, 1 to 64: that many for each sample of the sampler. They are spread evenly
     over what may become of their first two flights and vertices, and have the ray and its
     wavelengths in common. 0 stands for 4, and for 1 in spectral variants. (Default: 1)

 * - spectral_sampling
   - |string|
   - How paths through media are drawn whose extinction varies with colour or wavelength. ``mis``:
     from one channel, chosen by what the path would lose in it, and weighted by the balance
     heuristic over all. ``single``: a path is for one channel only. ``average``: from the mean
     extinction. ``tracking``: from the greatest extinction, with null collisions. (Default:
     ``mis``)

 * - event_probabilities
   - |string|
   - For ``tracking``: the probabilities of scattering and of null collisions are in proportion to
     the coefficients' ``maximum`` over the channels, to their ``average``, or to their average
     weighted by the throughput of the path, ``history``. (Default: ``history``)

 * - absorption
   - |string|
   - ``weight``: paths go on with what is not absorbed. ``analogue``: they end with the probability
     of absorption. (Default: ``weight``)

 * - distance_sampling
   - |string|
   - Where media are lit by light sources at a point (``point``, ``spot``, ``projector``), as seen
     along each segment of a path. ``free_flight``: where its flight collides. ``equiangular``: at a
     distance of its own, drawn by equiangular sampling, which takes another light sample. ``mis``:
     at both, weighted by the power heuristic. For lamps in fog. Other light sources, the paths
     themselves, and scenes without such lights, are treated as by ``free_flight``. (Default:
     ``free_flight``)

A volumetric path tracer for :ref:`analytic <medium-analytic>` media and their sums,
:ref:`overlap <medium-overlap>`. Free flights are drawn by
inverting the optical depth, and light is attenuated by the exact transmittance, so there are no
null collisions and no estimates of visibility through the medium. Where the extinction varies with
wavelength, one path serves all channels: ``spectral_sampling`` says how. In scenes without an
environment, rays that meet no surface, or only an index-matched boundary of their medium, are made
to collide more often than in nature, at a lower weight: a clear sky before black space is as free
of noise as a cloud. Light sources are combined with phase functions and BSDFs by multiple
importance sampling.

Parameters and path depth are those of ``volpath``. Roulette spares paths that carry two fifths of
what they began with, and passing an index-matched boundary plays none. Stock media in the same
scene are rendered by delta tracking, and their transmittance is estimated by ratio tracking. For
derivatives there is ``prbanalyticvolpath``.

.. tabs::
    .. code-tab:: xml

        <integrator type="analyticvolpath">
            <integer name="max_depth" value="16"/>
        </integrator>

    .. code-tab:: python

        'type': 'analyticvolpath',
        'max_depth': 16

*/
template <typename Float, typename Spectrum>
class AnalyticVolpathIntegrator final : public MonteCarloIntegrator<Float, Spectrum> {
public:
    MI_IMPORT_BASE(MonteCarloIntegrator, m_max_depth, m_rr_depth, m_hide_emitters)
    MI_IMPORT_TYPES(Scene, Sensor, Sampler, Emitter, EmitterPtr, BSDF, BSDFPtr, Medium, MediumPtr,
                    PhaseFunction, PhaseFunctionPtr, PhaseFunctionContext, ShapePtr)
    using AnalyticPtr = dr::replace_scalar_t<Float, const FormulaMedium<Float, Spectrum> *>;
    using Flight = typename FormulaMedium<Float, Spectrum>::Flight;
    using FlightVariates = typename FormulaMedium<Float, Spectrum>::FlightVariates;

    AnalyticVolpathIntegrator(const Properties &props) : Base(props), m_rules(props) {
        // Vertices behind which little is to come cost as much as others.
        if (!props.has_property("rr_depth"))
            m_rr_depth = DefaultRouletteDepth;
        int64_t samples = props.get<int64_t>("emitter_samples", 0);
        if (samples < 0 || samples > 64)
            Throw("emitter_samples must be between 0 (automatic) and 64, got %i", samples);
        m_emitter_samples = (uint32_t) samples;
        int64_t paths = props.get<int64_t>("paths", 1);
        if (paths < 0 || paths > 64)
            Throw("paths must be between 0 (automatic) and 64, got %i", paths);
        m_paths = paths > 0 ? (uint32_t) paths : AutomaticPaths;
        m_distances = one_of(props, "distance_sampling", distance_names(), m_distances);
    }

    TensorXf render(Scene *scene, Sensor *sensor, UInt32 seed, uint32_t spp, bool develop,
                    bool evaluate) override {
        m_survey = look_at(scene, sensor->medium());
        m_surveyed = scene;
        struct Forget {
            const Scene *&scene;
            ~Forget() { scene = nullptr; }
        } forget{ m_surveyed }; // after a failure too: another scene may get the same address
        return Base::render(scene, sensor, seed, spp, develop, evaluate);
    }

    std::pair<Spectrum, Mask> sample(const Scene *scene, Sampler *sampler,
                                     const RayDifferential3f &ray, const Medium *medium,
                                     Float * /* aovs */, Mask active) const override {
        MI_MASKED_FUNCTION(ProfilerPhase::SamplingIntegratorSample, active);
        Survey own;
        const Survey &found = scene == m_surveyed ? m_survey : (own = look_at(scene, medium));

        Path path;
        path.active = active && m_max_depth > 0;
        path.ray = Ray3f(ray);
        path.medium = medium;
        path.last = dr::zeros<Interaction3f>();
        path.count_emission = !m_hide_emitters;
        path.valid = !m_hide_emitters && scene->environment() != nullptr;
        path.sampler = sampler;
        path.behind = false;
        if (m_paths == 1) {
            trace(scene, found, path);
            return { path.result, path.valid };
        }

        path.spread.draw(sampler, active);
        struct Sum {
            UInt32 paths = 0;
            Spectrum result = 0.f;
            Mask valid;
            Sampler *sampler;
            DRJIT_STRUCT(Sum, paths, result, valid, sampler)
        } sum;
        sum.valid = path.valid;
        sum.sampler = sampler;
        dr::tie(sum) = dr::while_loop(
            dr::make_tuple(sum), [this](const Sum &s) { return s.paths < m_paths; },
            [this, scene, path, kept = KeptSurvey(found)](Sum &s) {
                Path one = path;
                one.sampler = s.sampler;
                one.spread.turn = Float(s.paths) / (ScalarFloat) m_paths;
                trace(scene, kept, one);
                s.result += one.result / (ScalarFloat) m_paths;
                s.valid |= one.valid && s.paths == 0u; // any of them stands for all
                s.paths += 1u;
            },
            "analyticvolpath paths");
        return { sum.result, sum.valid };
    }

    std::string to_string() const override {
        std::ostringstream oss;
        oss << "AnalyticVolpathIntegrator[" << std::endl
            << "  max_depth = " << (int32_t) m_max_depth << "," << std::endl
            << "  rr_depth = " << m_rr_depth << "," << std::endl
            << "  hide_emitters = " << m_hide_emitters << "," << std::endl
            << "  emitter_samples = " << m_emitter_samples << "," << std::endl
            << "  paths = " << m_paths << "," << std::endl
            << m_rules.to_string() << "," << std::endl
            << "  distance_sampling = " << name_of(distance_names(), m_distances) << std::endl
            << "]";
        return oss.str();
    }

    MI_DECLARE_CLASS(AnalyticVolpathIntegrator)

private:
    /// Shadow rays that less than this gets through are traced with a lower probability.
    static constexpr ScalarFloat DimTransmittance = 0.25f;
    /// What is more probable than this needs no variate.
    static constexpr ScalarFloat AlmostSure = 0.999f;
    /// Paths that carry less than this end with a higher probability than others.
    static constexpr ScalarFloat DimThroughput = 0.4f;
    /// Where nothing is lost, paths have to end as well: sooner where weights grow without bound.
    static constexpr ScalarFloat MaxSurvival = 0.99f, MaxSurvivalUnbounded = 0.95f;
    /// How much more probable than in nature collisions are on rays that leave the scene: those
    /// from the camera, and others. Measured on the sky of the Earth, docs/performance.md.
    static constexpr ScalarFloat CameraGain = 16.f, ScatteredGain = 4.f;
    static constexpr uint32_t DefaultRouletteDepth = 1;
    /// More have less noise where a ray stands for all wavelengths.
    static constexpr uint32_t AutomaticPaths = is_spectral_v<Spectrum> ? 1 : 4;
    /// Equiangular sampling follows phase functions up to this asymmetry, that of g = 0.98.
    static constexpr ScalarFloat MaxForwardness = 100.f;
    /// Colours or wavelengths of a path.
    static constexpr size_t Channels = dr::size_v<UnpolarizedSpectrum>;

    /// What the body of a loop knows of the scene: JIT variants may come back to it later.
    using KeptSurvey =
        std::conditional_t<dr::is_jit_v<Float>, Survey, std::reference_wrapper<const Survey>>;

    /// State of a path between two vertices.
    struct Path {
        Mask active;
        Ray3f ray;
        MediumPtr medium = nullptr;
        Spectrum throughput = 1.f;
        Spectrum result = 0.f;
        Float eta = 1.f;
        UInt32 depth = 0;
        /// Where the path scattered last, and the density of the direction it took there.
        Interaction3f last;
        Float last_pdf = 1.f;
        /// Emission counts fully: it could not have been sampled from the last vertex.
        Mask count_emission;
        /// Went on from a null collision: the light behind it has been counted.
        Mask behind;
        Mask valid;
        Sampler *sampler = nullptr;
        Spread<Float> spread;

        DRJIT_STRUCT(Path, active, ray, medium, throughput, result, eta, depth, last, last_pdf,
                     count_emission, behind, valid, sampler, spread)
    };

    /// Where a ray ends: at a surface, in a collision, or outside the scene.
    struct Vertex {
        SurfaceInteraction3f si;
        MediumInteraction3f mi;
        /// Number of its variates among those that are spread over the paths of a ray.
        UInt32 step;
        /// Collided with the medium, and scatters there.
        Mask scatters;
        /// What scatters there, in the medium or at a surface.
        Interaction3f here;
        BSDFPtr bsdf;
        PhaseFunctionPtr phase;
        /// Collided with nothing real: goes on from mi.p in the same direction.
        Mask passes;
        /// Collided, and ends there.
        Mask absorbed;
        /// Leaves a medium of ours, and the scene: what is behind it needs no sampling.
        Mask escapes;
        /// Throughput of the light from behind the vertex.
        Spectrum background;
        /// Escapes, and counts as something that is seen.
        Mask visible;
        /// The medium before the vertex, where equiangular sampling has looked for light.
        LitSegment<Float, Spectrum> lit;
    };

    /// The throughput of a path for the one channel that a variate chooses.
    static UnpolarizedSpectrum one_channel(const Float &u) {
        const UnpolarizedSpectrum chance = 1.f / (ScalarFloat) Channels;
        const UInt32 channel = choose_channel(chance, u);
        UnpolarizedSpectrum one = 0.f;
        for (size_t i = 0; i < Channels; ++i)
            one[i] = dr::select(channel == (uint32_t) i, (ScalarFloat) Channels, 0.f);
        return one;
    }

    Survey look_at(const Scene *scene, const Medium *medium) const {
        Survey found = survey<Float, Spectrum>(scene, medium);
        if (m_emitter_samples > 0)
            found.emitter_samples = m_emitter_samples;
        // Where collisions bring no light, what is behind them need not be sampled.
        found.sky &= m_max_depth > 1;
        if (m_distances == DistanceSampling::FreeFlight || !found.analytic || m_max_depth < 2)
            found.points.clear();
        return found;
    }

    /// Traces a path to its end.
    void trace(const Scene *scene, const Survey &found, Path &path) const {
        if (m_rules.sampling == SpectralSampling::Single && Channels > 1)
            path.throughput *= one_channel(path.sampler->next_1d(path.active));
        dr::tie(path) = dr::while_loop(
            dr::make_tuple(path), [](const Path &p) { return p.active; },
            [this, scene, kept = KeptSurvey(found)](Path &p) { extend(scene, kept, p); },
            "analyticvolpath");
    }

    /// A variate of the path, or in its place, in its first steps, one that is spread over the
    /// paths of a ray.
    Float spread(const Path &path, const UInt32 &step, size_t slot, const Float &u) const {
        return m_paths > 1 ? path.spread(step, slot, u) : u;
    }

    // ---- Media

    /// Our medium behind a pointer; in scalar variants null if it is not ours.
    static AnalyticPtr as_analytic(const Survey &found, const MediumPtr &medium) {
        if constexpr (dr::is_jit_v<Float>)
            return dr::reinterpret_array<AnalyticPtr>(medium);
        else if (found.foreign)
            return dynamic_cast<AnalyticPtr>(medium);
        else
            return static_cast<AnalyticPtr>(medium);
    }

    static Mask is_analytic(const Survey &found, const AnalyticPtr &medium, const Mask &active) {
        if constexpr (dr::is_jit_v<Float>)
            return found.foreign ? active && medium->is_analytic(active) : active;
        else
            return active && medium != nullptr;
    }

    /// The end of a ray: infinite, where it is only the largest number.
    static Float limit(const Float &reach) {
        return dr::select(reach < dr::Largest<Float>, reach, dr::Infinity<Float>);
    }

    /// Traces the ray of `path` to its next vertex, and weighs the throughput accordingly.
    Vertex next_vertex(const Scene *scene, const Survey &found, Path &path) const {
        Vertex v;
        v.mi = dr::zeros<MediumInteraction3f>();
        v.step = 0;
        v.scatters = v.passes = v.absorbed = v.escapes = v.visible = v.lit.active = false;

        Mask in_medium = path.active && path.medium != nullptr;
        if (!found.media())
            in_medium = false;
        AnalyticPtr analytic = as_analytic(found, path.medium);
        Mask in_ours = is_analytic(found, analytic, in_medium), in_foreign = in_medium && !in_ours;

        const UnpolarizedSpectrum throughput = unpolarized_spectrum(path.throughput);
        const Float reach = path.ray.maxt;
        Float t = dr::Infinity<Float>;
        UnpolarizedSpectrum chance = 0.f;
        const FlightVariates u = variates(found, path, in_medium);

        const bool ours = found.analytic && dr::any_or<true>(in_ours);
        Flight flight = dr::zeros<Flight>();
        if (ours && found.sky) {
            flight =
                analytic->sample_flight(m_rules, path.ray, limit(reach), throughput, u, in_ours);
            dr::masked(t, in_ours) = flight.t;
        }
        if (found.foreign && dr::any_or<true>(in_foreign)) {
            UInt32 channel = 0;
            if constexpr (is_rgb_v<Spectrum>) {
                chance = channel_chances(throughput);
                channel = choose_channel(chance, u.event);
            } else {
                chance[0] = 1.f; // stock media know the first wavelength only
            }
            v.mi = path.medium->sample_interaction(path.ray, u.place[0], channel, in_foreign);
            dr::masked(t, in_foreign) = v.mi.t;
        }
        // The ray needs to be traced only as far as the flight goes, unless more of it is lit.
        if (!found.lit())
            path.ray.maxt = dr::minimum(reach, t);
        PreliminaryIntersection3f hit =
            scene->ray_intersect_preliminary(path.ray, false, path.active);
        Mask collided = in_medium && (found.lit() ? t < hit.t : !hit.is_valid()) && t < reach;
        const Float end = dr::minimum(dr::minimum(t, hit.t), limit(reach));

        Float boost = 1.f; // of collisions over what they are in nature
        v.background = path.throughput;
        if (ours && found.sky)
            end_flight(found, flight, analytic, path.ray, end, throughput, in_ours && !collided);
        else if (ours) {
            v.escapes = in_ours && !hit.is_valid();
            if (found.permeable)
                v.escapes |= leaves(scene, path.ray, path.medium, hit, dr::Infinity<Float>,
                                    in_ours && hit.is_valid());
            const Float gain =
                dr::select(v.escapes, dr::select(path.depth == 0u, CameraGain, ScatteredGain), 1.f);
            flight =
                analytic->sample_collision(m_rules, path.ray, end, gain, throughput, u, in_ours);
            dr::masked(t, in_ours) = flight.t;
            collided |= in_ours && dr::isfinite(flight.t);
            // A path that is bound to collide stands for those that do not, too.
            const Float seen = dr::sum(channel_chances(throughput) * (1.f - flight.past));
            v.visible = v.escapes && !path.behind && u.event < seen;
            if (found.lit())
                boost = dr::minimum(gain, dr::rcp(seen));
            dr::masked(v.background, v.escapes) *= dr::select(path.behind, 0.f, flight.past);
        }
        if (ours && found.lit())
            light_medium(scene, found, path, v, analytic, dr::minimum(hit.t, limit(reach)), t,
                         boost, in_ours);
        if (ours) {
            const Mask meets = in_ours && collided;
            dr::masked(path.throughput, in_ours) *= flight.weight;
            v.scatters |= meets && flight.scatters;
            v.passes |= meets && flight.passes;
            v.absorbed = meets && !flight.scatters && !flight.passes;
            dr::masked(path.behind, in_ours) = v.escapes && meets && flight.passes;
        }
        if (found.foreign && dr::any_or<true>(in_foreign))
            track(path, v, chance, end, collided && in_foreign, in_foreign);

        v.si = hit.compute_surface_interaction(path.ray, +RayFlags::All,
                                               path.active && hit.is_valid() && !collided);
        dr::masked(v.mi.t, collided) = t;
        dr::masked(v.mi.p, collided) = path.ray(t);
        dr::masked(v.mi.wi, collided) = -path.ray.d;
        dr::masked(v.mi.sh_frame, collided) = Frame3f(v.mi.wi);
        dr::masked(v.mi.time, collided) = path.ray.time;
        dr::masked(v.mi.wavelengths, collided) = path.ray.wavelengths;
        dr::masked(v.mi.medium, collided) = path.medium;
        return v;
    }

    /// Whether a ray in a medium hits its index-matched boundary, and there is nothing behind, up
    /// to the distance `reach`.
    static Mask leaves(const Scene *scene, const Ray3f &ray, const MediumPtr &medium,
                       const PreliminaryIntersection3f &hit, const Float &reach, Mask active) {
        if (dr::none_or<false>(active))
            return false;
        const ShapePtr shape = hit.shape;
        const BSDFPtr bsdf = shape->bsdf();
        active &= shape->is_medium_transition() && !shape->is_emitter() && bsdf != nullptr &&
                  (bsdf->flags() & +BSDFFlags::All) == +BSDFFlags::Null;
        const MediumPtr inside = shape->interior_medium(), outside = shape->exterior_medium();
        active &=
            (medium == inside && outside == nullptr) || (medium == outside && inside == nullptr);
        if (dr::none_or<false>(active))
            return false;
        Ray3f rest = ray;
        const Point3f p = ray(hit.t);
        const Float skipped = (1.f + dr::max(dr::abs(p))) * math::RayEpsilon<Float>;
        rest.o = dr::fmadd(rest.d, skipped, p);
        rest.maxt = dr::clip(reach - hit.t - skipped, 0.f, dr::Largest<Float>);
        return active && !scene->ray_test(rest, active);
    }

    /// Weighs flights that have been drawn for longer, and end at `end` without a collision.
    void end_flight(const Survey &found, Flight &flight, const AnalyticPtr &medium,
                    const Ray3f &ray, const Float &end, const UnpolarizedSpectrum &throughput,
                    const Mask &active) const {
        UnpolarizedSpectrum weight = 1.f;
        if (found.chromatic || found.absorbers)
            weight = medium->passing_weight(m_rules, ray, end, throughput, active);
        dr::masked(flight.weight, active) = weight;
    }

    FlightVariates variates(const Survey &found, Path &path, const Mask &active) const {
        FlightVariates u{ 0.f, 0.f, 0.f };
        if (!found.media())
            return u;
        if (found.chromatic || found.foreign || !found.sky)
            u.event = path.sampler->next_1d(active);
        if (found.analytic && m_rules.has_events())
            u.kind = path.sampler->next_1d(active);
        for (size_t i = 0; i < found.variates(); ++i)
            u.place[i] = path.sampler->next_1d(active);

        const UInt32 step = path.spread.flights;
        u.event = spread(path, step, SpreadSlot::Event, u.event);
        for (size_t i = 0; i < found.variates(); ++i)
            u.place[i] = spread(path, step, SpreadSlot::Place + i, u.place[i]);
        if (m_paths > 1)
            dr::masked(path.spread.flights, active) += 1;
        return u;
    }

    /// Delta tracking: weighs a step through a stock medium, and decides what a collision is.
    void track(Path &path, Vertex &v, const UnpolarizedSpectrum &chance, const Float &end,
               const Mask &collided, const Mask &active) const {
        const UnpolarizedSpectrum &majorant = v.mi.combined_extinction;
        Float length = dr::maximum(end - v.mi.mint, 0.f);
        // Relative to the thinnest channel that counts. The length is infinite where a ray leaves a
        // medium that has a box but no boundary.
        UnpolarizedSpectrum excess = majorant - thinnest(chance, majorant);
        UnpolarizedSpectrum relative = dr::select(excess != 0.f, dr::exp(-length * excess), 1.f);
        UnpolarizedSpectrum weight =
            balance(relative, chance, relative * dr::select(collided, majorant, 1.f));

        Float real = dr::mean(dr::select(majorant > 0.f, v.mi.sigma_t / majorant, 0.f));
        Mask scatters = collided && path.sampler->next_1d(active) < real,
             passes = collided && !scatters;
        dr::masked(weight, scatters) *= v.mi.sigma_s / real;
        dr::masked(weight, passes) *= v.mi.sigma_n / (1.f - real);
        dr::masked(path.throughput, active) *= weight;
        v.scatters |= scatters;
        v.passes |= passes;
    }

    /// Which shadow rays are traced further, and what their light is to be multiplied by: of dim
    /// ones only some. Those carry DimTransmittance then, or a rounding less: whether they draw a
    /// variate at the next surface must not hang on that.
    static std::pair<Mask, Float> spare(Sampler *sampler, const UnpolarizedSpectrum &carried,
                                        const Mask &active) {
        const Float chance = dr::max(carried) / DimTransmittance;
        const Mask dim = active && chance < AlmostSure;
        if (dr::none_or<false>(dim))
            return { active, 1.f };
        const Mask ends = dim && sampler->next_1d(dim) >= chance;
        return { active && !ends, dr::select(ends, 0.f, dr::select(dim, dr::rcp(chance), 1.f)) };
    }

    /// Transmittance of everything between a vertex and a light source at the end of `ray`.
    Spectrum transmittance(const Scene *scene, const Survey &found, Sampler *sampler, Ray3f ray,
                           MediumPtr medium, const Mask &infinite, Mask active) const {
        Float beyond = dr::select(infinite, dr::Infinity<Float>, 0.f);
        if (!found.permeable && !found.foreign) {
            // What gets through the medium is known before the ray is traced: through thick fog
            // only some rays are.
            Spectrum result = dr::select(active, Spectrum(1.f), 0.f);
            Mask in_medium = active && medium != nullptr;
            if (found.media() && dr::any_or<true>(in_medium)) {
                UnpolarizedSpectrum through =
                    as_analytic(found, medium)->transmittance(ray, ray.maxt + beyond, in_medium);
                const auto [traced, weight] = spare(sampler, through, in_medium);
                active &= traced || !in_medium;
                dr::masked(result, in_medium) *= through * weight;
            }
            dr::masked(result, active) = dr::select(scene->ray_test(ray, active), 0.f, result);
            return result;
        }

        struct Shadow {
            Mask active;
            Ray3f ray;
            Float rest;
            MediumPtr medium;
            Spectrum result;
            Sampler *sampler;
            DRJIT_STRUCT(Shadow, active, ray, rest, medium, result, sampler)
        } shadow = {
            active, ray, ray.maxt, medium, dr::select(active, Spectrum(1.f), 0.f), sampler
        };

        dr::tie(shadow) = dr::while_loop(
            dr::make_tuple(shadow), [](const Shadow &s) { return s.active; },
            [this, scene, kept = KeptSurvey(found), beyond](Shadow &s) {
                pass(scene, kept, beyond, s);
            },
            "analyticvolpath shadow");
        return shadow.result;
    }

    /// One step of a shadow ray: up to the next surface, or to a null collision in a stock medium.
    template <typename Shadow>
    void pass(const Scene *scene, const Survey &found, const Float &beyond, Shadow &s) const {
        s.ray.maxt = s.rest;
        Mask in_medium = s.active && s.medium != nullptr;
        AnalyticPtr analytic = as_analytic(found, s.medium);
        Mask in_ours = is_analytic(found, analytic, in_medium), in_foreign = in_medium && !in_ours;

        bool tracks = found.foreign && dr::any_or<true>(in_foreign);
        MediumInteraction3f mi = dr::zeros<MediumInteraction3f>();
        if (tracks) {
            mi = s.medium->sample_interaction(s.ray, s.sampler->next_1d(in_foreign), 0, in_foreign);
            dr::masked(s.ray.maxt, in_foreign) = dr::minimum(s.rest, mi.t);
        }
        PreliminaryIntersection3f hit = scene->ray_intersect_preliminary(s.ray, false, s.active);
        Mask surface = s.active && hit.is_valid(),
             collided = in_foreign && !surface && mi.t < s.rest,
             arrives = s.active && !surface && !collided;

        if (tracks) {
            Float length = dr::maximum(dr::minimum(s.ray.maxt, hit.t) - mi.mint, 0.f);
            // Drawn from the first channel: the others are weighted.
            UnpolarizedSpectrum weight =
                dr::exp(length * (mi.combined_extinction[0] - mi.combined_extinction));
            dr::masked(weight, collided) *= mi.sigma_n / mi.combined_extinction[0];
            dr::masked(s.result, in_foreign) *= weight;
        }
        if (found.analytic && dr::any_or<true>(in_ours)) {
            Float end = dr::select(surface, hit.t, s.rest + beyond);
            dr::masked(s.result, in_ours) *= analytic->transmittance(s.ray, end, in_ours);
        }
        if (dr::any_or<true>(surface)) {
            const auto [traced, weight] = spare(s.sampler, unpolarized_spectrum(s.result), surface);
            dr::masked(s.result, surface) *= weight;
            surface &= traced;
            if (found.analytic) {
                const Mask left = leaves(scene, s.ray, s.medium, hit, s.rest, in_ours && surface);
                arrives |= left;
                surface &= !left;
            }
        }
        if (dr::any_or<true>(surface)) {
            SurfaceInteraction3f si =
                hit.compute_surface_interaction(s.ray, +RayFlags::All, surface);
            Spectrum through = si.bsdf(s.ray)->eval_null_transmission(si, surface);
            dr::masked(s.result, surface) *= si.to_world_mueller(through, si.wi, si.wi);
            Mask crosses = surface && si.is_medium_transition();
            dr::masked(s.medium, crosses) = si.target_medium(s.ray.d);
            dr::masked(s.ray, surface) = si.spawn_ray(s.ray.d);
        }

        dr::masked(s.ray.o, collided) = s.ray(s.ray.maxt);
        s.rest -= dr::select(hit.is_valid(), hit.t, s.ray.maxt);
        s.active &= !arrives && s.rest > 0.f && dr::any(unpolarized_spectrum(s.result) != 0.f);
    }

    // ---- Light sources at a point

    /**
     * Adds light of a source at a point that the medium scatters along the ray of `path`, up to the
     * distance `end`. The light source is chosen by what it would shed on the ray in the clear,
     * the distance drawn by equiangular sampling.
     *
     * That is an estimate beside the path, which goes on from its flight: what else the path finds
     * does not suffer, wherever the light is.
     *
     * \param t, boost  of the flight's collision: its distance, and how much more probable it is
     *    than in nature
     */
    DRJIT_NOINLINE void light_medium(const Scene *scene, const Survey &found, Path &path, Vertex &v,
                                     AnalyticPtr analytic, Float end, Float t, Float boost,
                                     Mask in_ours) const {
        const Ray3f &ray = path.ray;
        const auto [hit, near, far] = path.medium->intersect_aabb(ray);
        LitSegment<Float, Spectrum> &lit = v.lit;
        lit.near = near;
        lit.far = dr::minimum(far, end);
        lit.active = in_ours && hit && lit.near < lit.far && path.depth + 1u < m_max_depth &&
                     path.medium->use_emitter_sampling();
        if (dr::none_or<false>(lit.active))
            return;

        const UnpolarizedSpectrum throughput = unpolarized_spectrum(path.throughput);
        const bool mis = m_distances == DistanceSampling::Mis;
        if (mis) {
            const Mask collides = lit.active && dr::isfinite(t) && t <= lit.far;
            const Float at = dr::select(collides, t, 0.f);
            lit.flight_pdf =
                boost * analytic->scattering_at(m_rules, ray, at, throughput, collides).second;
        }

        lit.forwardness = forwardness(path, lit);
        const UInt32 index = found.points.size() > 1
                                 ? lit.choose(scene, found, ray, path.sampler->next_1d(lit.active))
                                 : lit.choose_only(scene, found, ray);
        const EmitterPtr emitter = lit.emitter(scene, index);
        const Point3f light = lit.position(emitter, ray);
        const Float u = path.sampler->next_1d(lit.active);
        const MediumInteraction3f mi = place(path, lit.near + lit.seen_from(ray, light).sample(u));

        const auto [scattered, natural] =
            analytic->scattering_at(m_rules, ray, mi.t, throughput, lit.active);
        const auto [ds, radiance] = emitter->sample_direction(mi, Point2f(.5f), lit.active);
        const auto [phase, phase_pdf] = path.medium->phase_function()->eval_pdf(
            PhaseFunctionContext(path.sampler), mi, ds.d, lit.active);
        const Float pdf = lit.pdf(ray, light, mi.p),
                    flight_pdf = boost * natural * scene->pdf_emitter(index, lit.active) *
                                 (ScalarFloat) found.emitter_samples,
                    weight = (mis ? mis_weight(pdf, flight_pdf) : 1.f) / pdf;
        const Spectrum value = path.throughput * phase * scattered * radiance * weight;
        // Not finite in the light source itself.
        const Float brightness = dr::sum(unpolarized_spectrum(value));
        const Mask arrives = lit.active && brightness > 0.f && dr::isfinite(brightness);
        if (dr::any_or<true>(arrives))
            dr::masked(path.result, arrives) +=
                value * transmittance(scene, found, path.sampler, mi.spawn_ray_to(ds.p),
                                      path.medium, false, arrives);
    }

    /// Weight, by MIS, of light of a source at a point where a flight has collided.
    DRJIT_NOINLINE Float weight_of_flight(const Survey &found, const Path &path, const Vertex &v,
                                          const DirectionSample3f &ds) const {
        return mis_weight(v.lit.flight_pdf * ds.pdf * (ScalarFloat) found.emitter_samples,
                          v.lit.pdf(path.ray, ds.p, v.mi.p));
    }

    /// A place in the medium of a path, at the distance `t` on its ray.
    static MediumInteraction3f place(const Path &path, const Float &t) {
        MediumInteraction3f mi = dr::zeros<MediumInteraction3f>();
        mi.t = t;
        mi.p = path.ray(t);
        mi.wi = -path.ray.d;
        mi.sh_frame = Frame3f(mi.wi);
        mi.time = path.ray.time;
        mi.wavelengths = path.ray.wavelengths;
        mi.medium = path.medium;
        return mi;
    }

    /// The asymmetry of the phase function, (1 + g)/(1 - g) of that of Henyey and Greenstein, where
    /// the ray enters the medium.
    static Float forwardness(const Path &path, const LitSegment<Float, Spectrum> &lit) {
        const MediumInteraction3f mi = place(path, lit.near);
        const PhaseFunctionContext context(path.sampler);
        const PhaseFunctionPtr phase = path.medium->phase_function();
        const Float forwards = phase->eval_pdf(context, mi, path.ray.d, lit.active).second,
                    backwards = phase->eval_pdf(context, mi, -path.ray.d, lit.active).second,
                    ratio = dr::cbrt(forwards / backwards);
        return dr::select(dr::isfinite(ratio),
                          dr::clip(ratio, 1.f / MaxForwardness, MaxForwardness), 1.f);
    }

    // ---- Path tracing

    /// One vertex: emission found, light sampled, next direction.
    void extend(const Scene *scene, const Survey &found, Path &path) const {
        Vertex v = next_vertex(scene, found, path);
        const Mask outside = path.active && !v.scatters && !v.passes && !v.absorbed;

        if (m_hide_emitters)
            skip_emitters(scene, path, v, outside);
        add_emission(scene, found, path, v, outside || v.escapes);

        Mask surface = outside && v.si.is_valid() && !v.escapes;
        UInt32 next_depth = path.depth + 1;
        Mask goes_on = next_depth < m_max_depth;
        v.scatters &= goes_on;
        path.valid |= v.visible && goes_on && path.depth == 0u;
        path.active &= surface || v.scatters || v.passes;
        if (dr::none_or<false>(path.active))
            return;

        v.here = dr::select(v.scatters, Interaction3f(v.mi), Interaction3f(v.si));
        v.bsdf = dr::zeros<BSDFPtr>();
        v.phase = dr::zeros<PhaseFunctionPtr>();
        Mask samples_light = false, medium_samples_light = false;
        if (dr::any_or<true>(surface)) {
            v.bsdf = v.si.bsdf(path.ray);
            samples_light = surface && goes_on && has_flag(v.bsdf->flags(), BSDFFlags::Smooth);
        }
        if (found.media() && dr::any_or<true>(v.scatters)) {
            dr::masked(v.phase, v.scatters) = path.medium->phase_function();
            medium_samples_light = v.scatters && path.medium->use_emitter_sampling();
            // Light of sources at a point may have been found on the way.
            if (found.only_points && m_distances == DistanceSampling::Equiangular)
                samples_light |= medium_samples_light && !v.lit.active;
            else
                samples_light |= medium_samples_light;
        }

        if (m_paths > 1) {
            const Mask spreads = v.scatters || samples_light;
            v.step = dr::select(spreads, path.spread.vertices, Spread<Float>::Steps);
            dr::masked(path.spread.vertices, spreads) += 1;
        }

        // ---- Light sources
        if (dr::any_or<true>(samples_light))
            dr::masked(path.result, samples_light) +=
                path.throughput * sample_lights(scene, found, path, v, samples_light);

        // ---- Next direction
        Float u1 = path.sampler->next_1d(path.active);
        Point2f u2 = path.sampler->next_2d(path.active);
        u1 = spread(path, v.step, SpreadSlot::Lobe, u1);
        for (size_t i = 0; i < 2; ++i)
            u2[i] = spread(path, v.step, SpreadSlot::Direction + i, u2[i]);
        Spectrum weight = 1.f;
        Float pdf = 1.f, eta = 1.f;
        Vector3f direction = path.ray.d;
        UInt32 lobes = +BSDFFlags::Null;

        if (dr::any_or<true>(surface)) {
            auto [bs, bsdf_weight] = v.bsdf->sample(BSDFContext(), v.si, u1, u2, surface);
            dr::masked(weight, surface) = v.si.to_world_mueller(bsdf_weight, -bs.wo, v.si.wi);
            dr::masked(pdf, surface) = bs.pdf;
            dr::masked(eta, surface) = bs.eta;
            dr::masked(direction, surface) = v.si.to_world(bs.wo);
            dr::masked(lobes, surface) = bs.sampled_type;
        }
        if (found.media() && dr::any_or<true>(v.scatters)) {
            auto [wo, phase_weight, phase_pdf] =
                v.phase->sample(PhaseFunctionContext(path.sampler), v.mi, u1, u2, v.scatters);
            dr::masked(weight, v.scatters) = phase_weight;
            dr::masked(pdf, v.scatters) = phase_pdf;
            dr::masked(direction, v.scatters) = wo;
            dr::masked(lobes, v.scatters) = +BSDFFlags::DiffuseReflection;
        }

        // ---- Move on
        Mask scattered = (surface && !has_flag(lobes, BSDFFlags::Null)) || v.scatters;
        dr::masked(path.throughput, path.active) *= weight;
        path.eta *= eta;
        dr::masked(path.ray, surface || v.scatters) = v.here.spawn_ray(direction);
        dr::masked(path.ray.o, v.passes) = v.mi.p;
        path.ray.maxt = dr::Largest<Float>;
        if (found.media() && found.permeable) {
            Mask crosses = surface && v.si.is_medium_transition();
            dr::masked(path.medium, crosses) = v.si.target_medium(direction);
        }

        dr::masked(path.last, scattered) = v.here;
        dr::masked(path.last_pdf, scattered) = pdf;
        path.valid |= scattered && !v.escapes && path.depth == 0u;
        dr::masked(path.depth, scattered) = next_depth;
        Mask unsampled =
            (surface && has_flag(lobes, BSDFFlags::Delta)) || (v.scatters && !medium_samples_light);
        dr::masked(path.count_emission, scattered) = unsampled;

        path.active &= pdf > 0.f && path.depth < m_max_depth &&
                       dr::any(unpolarized_spectrum(path.throughput) != 0.f);
        play_roulette(path, scattered);
    }

    /// Replaces the first hit by what is behind the area lights on the way.
    void skip_emitters(const Scene *scene, const Path &path, Vertex &v, const Mask &outside) const {
        Mask skip = outside && v.si.is_valid() && path.depth == 0u;
        if (dr::any_or<true>(skip))
            skip &= v.si.shape->is_emitter();
        if (dr::none_or<false>(skip))
            return;
        Ray3f ray = v.si.spawn_ray(path.ray.d);
        PreliminaryIntersection3f pi = Base::skip_area_emitters(scene, ray, true, skip);
        dr::masked(v.si, skip) = pi.compute_surface_interaction(ray, +RayFlags::All, skip);
    }

    /// Light that the ray has run into: a surface that shines, or the environment.
    void add_emission(const Scene *scene, const Survey &found, Path &path, const Vertex &v,
                      const Mask &outside) const {
        const SurfaceInteraction3f &si = v.si;
        EmitterPtr emitter = si.emitter(scene);
        Mask shines = outside && emitter != nullptr;
        if (m_hide_emitters)
            shines &= path.depth > 0u;
        if (dr::none_or<false>(shines))
            return;
        Mask shared = shines && path.depth > 0u && !path.count_emission;
        Float mis = 1.f;
        if (dr::any_or<true>(shared)) {
            DirectionSample3f ds(scene, si, path.last);
            Float light_pdf = scene->pdf_emitter_direction(path.last, ds, shared) *
                              (ScalarFloat) found.emitter_samples;
            dr::masked(mis, shared) = mis_weight(path.last_pdf, light_pdf);
        }
        const Spectrum throughput = dr::select(v.escapes, v.background, path.throughput);
        dr::masked(path.result, shines) += throughput * emitter->eval(si, shines) * mis;
    }

    /// Light that a source would send from a vertex along the path, were nothing in between.
    struct LightSample {
        Mask active = false;
        /// From the vertex to the light source.
        Ray3f ray = dr::zeros<Ray3f>();
        Mask infinite = false;
        Spectrum value = 0.f;

        DRJIT_STRUCT(LightSample, active, ray, infinite, value)
    };

    /**
     * Light that reaches the vertex straight from light sources and leaves along the path.
     *
     * Of several samples one is traced, which stands for all: it is chosen by the light it would
     * bring (resampled importance sampling; Talbot, Cline and Egbert 2005). A shadow ray costs more
     * than all else about a sample.
     */
    Spectrum sample_lights(const Scene *scene, const Survey &found, const Path &path,
                           const Vertex &v, const Mask &active) const {
        LightSample kept = draw_light(scene, found, path, v, 0, active);
        Float weight = brightness(path, kept), total = weight;
        for (uint32_t i = 1; i < found.emitter_samples; ++i) {
            const LightSample other = draw_light(scene, found, path, v, i, active);
            const Float own = brightness(path, other);
            total += own;
            Float u = path.sampler->next_1d(active);
            if (i == 1)
                u = spread(path, v.step, SpreadSlot::LightChoice, u);
            const Mask replaces = u * total < own;
            kept = dr::select(replaces, other, kept);
            weight = dr::select(replaces, own, weight);
        }
        if (found.emitter_samples > 1)
            kept.value *=
                dr::select(weight > 0.f, total / weight, 0.f) / (ScalarFloat) found.emitter_samples;
        return trace_light(scene, found, path, v, kept);
    }

    /// Sample number `index` of the light sources: the unit interval that chooses one of them is
    /// divided between the samples.
    LightSample draw_light(const Scene *scene, const Survey &found, const Path &path,
                           const Vertex &v, uint32_t index, Mask active) const {
        Point2f u = path.sampler->next_2d(active);
        if (index < 2)
            for (size_t i = 0; i < 2; ++i)
                u[i] = spread(path, v.step, SpreadSlot::Light + 2 * index + i, u[i]);
        u.x() = (u.x() + (ScalarFloat) index) / (ScalarFloat) found.emitter_samples;
        auto [ds, light] = scene->sample_emitter_direction(v.here, u, false, active);
        active &= ds.pdf != 0.f;
        if (dr::none_or<false>(active))
            return {};

        Spectrum value = 0.f;
        Float value_pdf = 0.f;
        Mask at_surface = active && !v.scatters, at_medium = active && v.scatters;
        if (dr::any_or<true>(at_surface)) {
            Vector3f wo = v.si.to_local(ds.d);
            auto [bsdf_value, bsdf_pdf] = v.bsdf->eval_pdf(BSDFContext(), v.si, wo, at_surface);
            dr::masked(value, at_surface) = v.si.to_world_mueller(bsdf_value, -wo, v.si.wi);
            dr::masked(value_pdf, at_surface) = bsdf_pdf;
        }
        if (found.media() && dr::any_or<true>(at_medium)) {
            auto [phase_value, phase_pdf] =
                v.phase->eval_pdf(PhaseFunctionContext(path.sampler), v.mi, ds.d, at_medium);
            dr::masked(value, at_medium) = phase_value;
            dr::masked(value_pdf, at_medium) = phase_pdf;
        }
        active &= dr::any(unpolarized_spectrum(value) != 0.f);
        Mask twice = false;
        if (found.lit()) {
            twice = at_medium && v.lit.active &&
                    has_flag(ds.emitter->flags(), EmitterFlags::DeltaPosition);
            if (m_distances == DistanceSampling::Equiangular)
                active &= !twice;
        }
        Float mis = mis_weight(ds.pdf * (ScalarFloat) found.emitter_samples,
                               dr::select(ds.delta, 0.f, value_pdf));
        if (found.lit() && m_distances == DistanceSampling::Mis && dr::any_or<true>(twice))
            dr::masked(mis, twice) *= weight_of_flight(found, path, v, ds);

        const Mask infinite = active && has_flag(ds.emitter->flags(), EmitterFlags::Infinite);
        // The size of the scene is no part of it: a frozen function would not know it.
        const Ray3f ray = dr::select(infinite, v.here.spawn_ray(ds.d), v.here.spawn_ray_to(ds.p));
        return { active, ray, infinite, dr::select(active, value * light * mis, 0.f) };
    }

    /// What the camera would get of a light sample.
    static Float brightness(const Path &path, const LightSample &light) {
        return dr::sum(unpolarized_spectrum(path.throughput * light.value));
    }

    /// What gets through to the vertex of a light sample.
    Spectrum trace_light(const Scene *scene, const Survey &found, const Path &path, const Vertex &v,
                         const LightSample &light) const {
        if (dr::none_or<false>(light.active))
            return 0.f;
        const Mask at_surface = light.active && !v.scatters;
        MediumPtr medium = path.medium;
        if (found.media() && found.permeable && dr::any_or<true>(at_surface)) {
            Mask crosses = at_surface && v.si.is_medium_transition();
            dr::masked(medium, crosses) = v.si.target_medium(light.ray.d);
        }
        const Spectrum through = transmittance(scene, found, path.sampler, light.ray, medium,
                                               light.infinite, light.active);
        return dr::select(light.active, light.value * through, 0.f);
    }

    /// Ends paths that carry little, and makes up for them by the rest. Those that carry two fifths
    /// of what they began with, or more, are as good as spared: measured, docs/performance.md.
    void play_roulette(Path &path, const Mask &scattered) const {
        Mask plays = path.active && scattered && path.depth > m_rr_depth;
        if (dr::none_or<false>(plays))
            return;
        Float brightest = dr::max(unpolarized_spectrum(path.throughput));
        const ScalarFloat most = m_rules.bounded() ? MaxSurvival : MaxSurvivalUnbounded;
        Float survival = dr::minimum(brightest * dr::square(path.eta) / DimThroughput, most);
        path.active &= path.sampler->next_1d(plays) < survival || !plays;
        dr::masked(path.throughput, plays) *= dr::rcp(dr::detach(survival));
    }

    /// Power heuristic with exponent 2.
    static Float mis_weight(const Float &a, const Float &b) {
        Float w = dr::square(a) / (dr::square(a) + dr::square(b));
        return dr::select(dr::isfinite(w), w, 0.f);
    }

    /// Light samples per vertex, 0 for what the survey says.
    uint32_t m_emitter_samples;
    /// Paths per camera ray, at least 1.
    uint32_t m_paths;
    FlightRules m_rules;
    DistanceSampling m_distances = DistanceSampling::FreeFlight;
    Survey m_survey;
    /// The scene that `m_survey` is about, while it is being rendered.
    const Scene *m_surveyed = nullptr;
};

} // namespace mitsuba
