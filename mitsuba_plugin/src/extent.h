// The box that a medium fills: all of space, unless a scene gives its corners.

#pragma once

#include <mitsuba/core/bbox.h>
#include <mitsuba/core/properties.h>
#include <mitsuba/core/ray.h>

namespace mitsuba {

template <typename Float, typename Spectrum> class Extent {
public:
    MI_IMPORT_TYPES()

    /// Reads `bbox_min` and `bbox_max`: both, or neither.
    Extent(const Properties &props) {
        const bool has_min = props.has_property("bbox_min"),
                   has_max = props.has_property("bbox_max");
        if (has_min != has_max)
            Throw("\"%s\" is missing: give bbox_min and bbox_max, or neither",
                  has_min ? "bbox_max" : "bbox_min");
        m_bounded = has_min;
        if (!m_bounded)
            return;
        const auto min = props.get<ScalarPoint3f>("bbox_min"),
                   max = props.get<ScalarPoint3f>("bbox_max");
        if (!dr::all(dr::isfinite(min) & dr::isfinite(max)))
            Throw("bbox_min and bbox_max must be finite, got %s and %s", min, max);
        if (!dr::all(min < max))
            Throw("bbox_min must be less than bbox_max in every coordinate, got %s and %s", min,
                  max);
        m_min = min;
        m_max = max;
        update();
    }

    /// Exposes the corners, if a scene gave them.
    void traverse(TraversalCallback *cb) {
        if (!m_bounded)
            return;
        cb->put("bbox_min", m_min, ParamFlags::NonDifferentiable);
        cb->put("bbox_max", m_max, ParamFlags::NonDifferentiable);
    }

    /// Keeps the corners out of compiled kernels.
    void update() { dr::make_opaque(m_min, m_max); }

    /// Whether a scene gave a box.
    bool bounded() const { return m_bounded; }
    const Point3f &min() const { return m_min; }
    const Point3f &max() const { return m_max; }

    /// The part of a ray inside, as distances from its origin; empty (valid is false) if it misses.
    std::tuple<Mask, Float, Float> clip(const Ray3f &ray) const {
        if (!m_bounded)
            return { true, Float(0.f), Float(dr::Infinity<Float>) };
        auto [hit, near, far] = BoundingBox3f(m_min, m_max).ray_intersect(ray);
        near = dr::maximum(near, 0.f);
        return { hit && near < far, near, far };
    }

    /// Whether a point is inside.
    Mask contains(const Point3f &p) const {
        if (!m_bounded)
            return true;
        return dr::all(p >= m_min && p <= m_max);
    }

    std::string to_string() const {
        std::ostringstream oss;
        if (m_bounded)
            oss << "  bbox_min = " << dr::slice(m_min) << "," << std::endl
                << "  bbox_max = " << dr::slice(m_max) << "," << std::endl;
        return oss.str();
    }

    /// Shows the corners to Dr.Jit, which keeps track of the variables that objects hold.
    template <typename Payload, typename Callback>
    void traverse_1_cb_ro(Payload *payload, Callback fn) const {
        dr::traverse_1_fn_ro(m_min, payload, fn);
        dr::traverse_1_fn_ro(m_max, payload, fn);
    }
    template <typename Payload, typename Callback>
    void traverse_1_cb_rw(Payload *payload, Callback fn) {
        dr::traverse_1_fn_rw(m_min, payload, fn);
        dr::traverse_1_fn_rw(m_max, payload, fn);
    }

private:
    bool m_bounded = false;
    Point3f m_min, m_max;
};

} // namespace mitsuba
