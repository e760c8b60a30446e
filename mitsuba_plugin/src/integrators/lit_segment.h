// The segment of a ray in a medium, and the light sources at a point that light it.

#pragma once

#include <type_traits>
#include <vector>

#include <mitsuba/core/ray.h>
#include <mitsuba/render/emitter.h>
#include <mitsuba/render/scene.h>

#include "integrators/equiangular.h"
#include "integrators/survey.h"

namespace mitsuba {

template <typename Float, typename Spectrum> struct LitSegment {
    MI_IMPORT_TYPES(Scene, EmitterPtr)
    using View = Equiangular<Vector3f>;

    /// There is one: what is said of others has no meaning.
    Mask active;
    /// From where to where, as distances on the ray.
    Float near, far;
    /// How much more the medium scatters forwards than backwards: k of Equiangular.
    Float forwardness;
    /// Sum of what the light sources shed on it, 1/length, if they were alike.
    Float exposures;
    /// Density at which the flight along the ray has collided where it has, 1/length.
    Float flight_pdf;

    /// What is seen of it from a light source.
    View seen_from(const Ray3f &ray, const Point3f &light) const {
        return { light - ray(near), ray.d, far - near, forwardness };
    }

    /// Density of the choice of a light source and a place by equiangular sampling, 1/length.
    Float pdf(const Ray3f &ray, const Point3f &light, const Point3f &place) const {
        return seen_from(ray, light).pdf(place - light, exposures);
    }

    /// Chooses a light source in proportion to what it would shed on the segment in the clear, by
    /// the uniform variate `u`: its number among the emitters. Finds the sum over all.
    UInt32 choose(const Scene *scene, const Survey &found, const Ray3f &ray, const Float &u) {
        struct Choice {
            UInt32 next, chosen;
            Float sum, u;
            DRJIT_STRUCT(Choice, next, chosen, sum, u)
        } choice{ 0, 0, 0.f, u };
        const uint32_t size = (uint32_t) found.points.size();
        const Numbers numbers = load(found.points);
        dr::tie(choice) = dr::while_loop(
            dr::make_tuple(choice), [size](const Choice &c) { return c.next < size; },
            [scene, numbers, ray, segment = *this](Choice &c) {
                const UInt32 index = dr::gather<UInt32>(numbers, c.next, segment.active);
                const Float exposure = segment.exposure(scene, index, ray);
                c.sum += exposure;
                // What is left of the variate is as uniform.
                const Float share = dr::select(c.sum > 0.f, exposure / c.sum, 0.f);
                const Mask takes = c.u < share;
                dr::masked(c.chosen, takes) = index;
                c.u = dr::select(takes, c.u / share, (c.u - share) / (1.f - share));
                c.next += 1u;
            },
            "analyticvolpath choice");
        exposures = choice.sum;
        return choice.chosen;
    }

    /// The only light source.
    UInt32 choose_only(const Scene *scene, const Survey &found, const Ray3f &ray) {
        const UInt32 index = found.points[0];
        exposures = exposure(scene, index, ray);
        return index;
    }

    EmitterPtr emitter(const Scene *scene, const UInt32 &index) const {
        return dr::gather<EmitterPtr>(scene->emitters_dr(), index, active);
    }

    Point3f position(const EmitterPtr &emitter, const Ray3f &ray) const {
        return emitter->sample_position(ray.time, Point2f(.5f), active).first.p;
    }

    DRJIT_STRUCT(LitSegment, active, near, far, forwardness, exposures, flight_pdf)

private:
    Float exposure(const Scene *scene, const UInt32 &index, const Ray3f &ray) const {
        return seen_from(ray, position(emitter(scene, index), ray)).exposure();
    }

    /// Numbers of emitters, as loops can read them.
    using Numbers = std::conditional_t<dr::is_jit_v<Float>, UInt32, const uint32_t *>;

    static Numbers load(const std::vector<uint32_t> &numbers) {
        if constexpr (dr::is_jit_v<Float>)
            return dr::load<UInt32>(numbers.data(), numbers.size());
        else
            return numbers.data();
    }
};

} // namespace mitsuba
