// The phase function of several components: theirs, weighted by what each scatters at the point.

#pragma once

#include <algorithm>
#include <array>

#include <mitsuba/core/properties.h>
#include <mitsuba/render/interaction.h>
#include <mitsuba/render/phase.h>

#include "component.h"

namespace mitsuba {

/**
 * In every channel, with the local scattering coefficients s_i of the components,
 *
 *     p = sum(s_i p_i) / sum(s_i).
 *
 * A component is sampled in proportion to the mean of s_i over the channels. Where nothing
 * scatters, all components count the same. Components that share a phase function are as one.
 */
template <typename Float, typename Spectrum>
class MixturePhaseFunction final : public PhaseFunction<Float, Spectrum> {
public:
    MI_IMPORT_BASE(PhaseFunction, m_flags, m_components)
    MI_IMPORT_TYPES(PhaseFunctionContext)
    using Parts = std::vector<ref<Component<Float, Spectrum>>>;

    MixturePhaseFunction(const Parts &parts) : Base(Properties("mixture")), m_parts(parts) {
        m_flags = 0;
        for (const auto &part : m_parts) {
            for (size_t i = 0; i < part->phase()->component_count(); ++i)
                m_components.push_back(part->phase()->flags(i));
            m_flags |= part->phase()->flags();
        }
        const Base *first = m_parts.front()->phase();
        if (std::all_of(m_parts.begin(), m_parts.end(),
                        [&](const auto &part) { return alike(first, part->phase()); }))
            m_common = first;
    }

    std::tuple<Vector3f, Spectrum, Float> sample(const PhaseFunctionContext &ctx,
                                                 const MediumInteraction3f &mi, Float sample1,
                                                 const Point2f &sample2,
                                                 Mask active) const override {
        MI_MASKED_FUNCTION(ProfilerPhase::PhaseFunctionSample, active);
        if (m_common)
            return m_common->sample(ctx, mi, sample1, sample2, active);
        const Weights weights = weigh(mi, active);
        // What is left of the variate in each part's share of [0, 1) is uniform again.
        Vector3f wo = dr::zeros<Vector3f>();
        Float low = 0.f;
        for (size_t i = 0; i < m_parts.size(); ++i) {
            const bool last = i + 1 == m_parts.size();
            const Float high = last ? Float(1.f) : low + weights.chance[i];
            const Mask chosen = active && sample1 >= low && (last || sample1 < high);
            if (dr::any_or<true>(chosen)) {
                const Float rest = dr::select(chosen, (sample1 - low) / (high - low), 0.f);
                auto [direction, weight, pdf] = m_parts[i]->phase()->sample(
                    ctx, mi, dr::minimum(rest, dr::OneMinusEpsilon<Float>), sample2, chosen);
                dr::masked(wo, chosen) = direction;
            }
            low = high;
        }
        auto [value, pdf] = mix(weights, ctx, mi, wo, active);
        return { wo, value * dr::select(pdf > 0.f, dr::rcp(pdf), 0.f), pdf };
    }

    std::pair<Spectrum, Float> eval_pdf(const PhaseFunctionContext &ctx,
                                        const MediumInteraction3f &mi, const Vector3f &wo,
                                        Mask active) const override {
        MI_MASKED_FUNCTION(ProfilerPhase::PhaseFunctionEvaluate, active);
        if (m_common)
            return m_common->eval_pdf(ctx, mi, wo, active);
        return mix(weigh(mi, active), ctx, mi, wo, active);
    }

    /// Names its parts by their classes: the medium prints their parameters.
    std::string to_string() const override {
        std::ostringstream oss;
        oss << "MixturePhaseFunction[";
        for (size_t i = 0; i < m_parts.size(); ++i)
            oss << (i > 0 ? ", " : "") << m_parts[i]->phase()->class_name();
        oss << "]";
        return oss.str();
    }

    MI_DECLARE_CLASS(MixturePhaseFunction)

private:
    /// Whether two phase functions are one object, or of the kind that has no parameters.
    static bool alike(const Base *a, const Base *b) {
        const char *isotropic = "IsotropicPhaseFunction";
        return a == b || (a->class_name() == isotropic && b->class_name() == isotropic);
    }

    /// Of each part: its share of the scattering, and the probability of sampling it.
    struct Weights {
        std::array<UnpolarizedSpectrum, MaxComponents> share;
        std::array<Float, MaxComponents> chance;
    };

    Weights weigh(const MediumInteraction3f &mi, Mask active) const {
        Weights weights;
        UnpolarizedSpectrum sum = 0.f;
        for (size_t i = 0; i < m_parts.size(); ++i) {
            weights.share[i] = m_parts[i]->scattering(mi, active);
            sum += weights.share[i];
        }
        const Float mean = dr::mean(sum);
        const ScalarFloat equal = 1.f / (ScalarFloat) m_parts.size();
        for (size_t i = 0; i < m_parts.size(); ++i) {
            UnpolarizedSpectrum &share = weights.share[i];
            weights.chance[i] = dr::select(mean > 0.f, dr::mean(share) / mean, equal);
            share = dr::select(sum > 0.f, share / sum, equal);
        }
        return weights;
    }

    std::pair<Spectrum, Float> mix(const Weights &weights, const PhaseFunctionContext &ctx,
                                   const MediumInteraction3f &mi, const Vector3f &wo,
                                   Mask active) const {
        Spectrum value = 0.f;
        Float pdf = 0.f;
        for (size_t i = 0; i < m_parts.size(); ++i) {
            auto [part_value, part_pdf] = m_parts[i]->phase()->eval_pdf(ctx, mi, wo, active);
            value += part_value * weights.share[i];
            pdf += part_pdf * weights.chance[i];
        }
        return { value, pdf };
    }

    Parts m_parts;
    /// What scatters like all parts, if they do not differ: it needs no weights.
    const Base *m_common = nullptr;

    MI_TRAVERSE_CB(Base, m_parts)
};

} // namespace mitsuba
