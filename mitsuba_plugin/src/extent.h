// What a medium fills: all of space, or the box or the sphere that a scene gives.

#pragma once

#include <mitsuba/core/bbox.h>
#include <mitsuba/core/properties.h>
#include <mitsuba/core/ray.h>

#include "traverse.h"

namespace mitsuba {

template <typename Float, typename Spectrum> class Extent {
public:
    MI_IMPORT_TYPES()

    /// Reads `bbox_min` and `bbox_max`, or `bsphere_center` and `bsphere_radius`, or nothing.
    Extent(const Properties &props) {
        const bool box = both(props, "bbox_min", "bbox_max"),
                   sphere = both(props, "bsphere_center", "bsphere_radius");
        if (box && sphere)
            Throw("bbox_min and bsphere_radius exclude each other: give a box or a sphere");
        if (box)
            read_box(props);
        if (sphere)
            read_sphere(props);
        update();
    }

    /// Exposes what a scene gave.
    void traverse(TraversalCallback *cb) {
        if (m_shape == Shape::Box) {
            cb->put("bbox_min", m_min, ParamFlags::NonDifferentiable);
            cb->put("bbox_max", m_max, ParamFlags::NonDifferentiable);
        }
        if (m_shape == Shape::Sphere) {
            cb->put("bsphere_center", m_center, ParamFlags::NonDifferentiable);
            cb->put("bsphere_radius", m_radius, ParamFlags::NonDifferentiable);
        }
    }

    /// Keeps box and sphere out of compiled kernels.
    void update() {
        if (m_shape == Shape::Sphere) {
            using Float64 = dr::float64_array_t<Float>;
            const Float64 radius(m_radius), centre = dr::norm(Point<Float64, 3>(m_center));
            m_power = Float((centre - radius) * (centre + radius));
        }
        dr::make_opaque(m_min, m_max, m_center, m_radius, m_power);
    }

    /// Whether a scene gave a box or a sphere.
    bool bounded() const { return m_shape != Shape::Everything; }
    /// Whether a scene gave a box.
    bool boxed() const { return m_shape == Shape::Box; }
    const Point3f &min() const { return m_min; }
    const Point3f &max() const { return m_max; }

    /// The part of a ray inside, as distances from its origin; empty (valid is false) if it misses.
    std::tuple<Mask, Float, Float> clip(const Ray3f &ray) const {
        if (!bounded())
            return { true, Float(0.f), Float(dr::Infinity<Float>) };
        auto [hit, near, far] =
            boxed() ? BoundingBox3f(m_min, m_max).ray_intersect(ray) : intersect_sphere(ray);
        near = dr::maximum(near, 0.f);
        return { hit && near < far, near, far };
    }

    /// Whether a point is inside.
    Mask contains(const Point3f &p) const {
        if (!bounded())
            return true;
        if (boxed())
            return dr::all(p >= m_min && p <= m_max);
        return power(p) <= 0.f;
    }

    std::string to_string() const {
        std::ostringstream oss;
        if (m_shape == Shape::Box)
            oss << "  bbox_min = " << dr::slice(m_min) << "," << std::endl
                << "  bbox_max = " << dr::slice(m_max) << "," << std::endl;
        if (m_shape == Shape::Sphere)
            oss << "  bsphere_center = " << dr::slice(m_center) << "," << std::endl
                << "  bsphere_radius = " << dr::slice(m_radius) << "," << std::endl;
        return oss.str();
    }

    AM_TRAVERSE_MEMBERS(m_min, m_max, m_center, m_radius, m_power)

private:
    enum class Shape { Everything, Box, Sphere };

    /// Whether a scene gives two parameters that go together.
    static bool both(const Properties &props, const char *first, const char *second) {
        const bool has_first = props.has_property(first), has_second = props.has_property(second);
        if (has_first != has_second)
            Throw("\"%s\" is missing: give %s and %s, or neither", has_first ? second : first,
                  first, second);
        return has_first;
    }

    void read_box(const Properties &props) {
        const auto min = props.get<ScalarPoint3f>("bbox_min"),
                   max = props.get<ScalarPoint3f>("bbox_max");
        if (!dr::all(dr::isfinite(min) & dr::isfinite(max)))
            Throw("bbox_min and bbox_max must be finite, got %s and %s", min, max);
        if (!dr::all(min < max))
            Throw("bbox_min must be less than bbox_max in every coordinate, got %s and %s", min,
                  max);
        m_shape = Shape::Box;
        m_min = min;
        m_max = max;
    }

    void read_sphere(const Properties &props) {
        const auto center = props.get<ScalarPoint3f>("bsphere_center");
        const auto radius = props.get<ScalarFloat>("bsphere_radius");
        if (!dr::all(dr::isfinite(center)))
            Throw("bsphere_center must be finite, got %s", center);
        if (!(radius > 0.f) || !dr::isfinite(radius))
            Throw("bsphere_radius must be finite and > 0, got %f", radius);
        m_shape = Shape::Sphere;
        m_center = center;
        m_radius = radius;
    }

    /// |p - c|² - R²: positive outside. Near the origin of coordinates it is as precise as the
    /// point, however large a sphere passes there, for the large terms have been subtracted.
    Float power(const Point3f &p) const {
        const Vector3f v(p);
        return dr::dot(v, v - 2.f * Vector3f(m_center)) + m_power;
    }

    /// Where the line of a ray enters and leaves the sphere.
    std::tuple<Mask, Float, Float> intersect_sphere(const Ray3f &ray) const {
        const Float q = power(ray.o);
        const Vector3f v = ray.o - m_center;
        const Float b = dr::dot(v, ray.d), perigee = dr::norm(v - b * ray.d);
        // Seen from outside, b² and q are large and nearly the same; inside, q is negative.
        const Float square =
            dr::select(q > 0.f, (m_radius - perigee) * (m_radius + perigee), dr::square(b) - q);
        const Mask hit = square > 0.f;
        // One root is a sum of two terms of the same sign, and q is the product of both roots.
        const Float sum = -(b + dr::copysign(dr::sqrt(dr::maximum(square, 0.f)), b)),
                    other = q / dr::select(hit, sum, 1.f);
        return { hit, dr::minimum(sum, other), dr::maximum(sum, other) };
    }

    Shape m_shape = Shape::Everything;
    Point3f m_min, m_max;
    Point3f m_center;
    Float m_radius;
    /// power() of the origin of coordinates, from double precision.
    Float m_power;
};

} // namespace mitsuba
