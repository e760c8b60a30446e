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
        m_bbox = ScalarBoundingBox3f(props.get<ScalarPoint3f>("bbox_min"),
                                     props.get<ScalarPoint3f>("bbox_max"));
        if (!dr::all(dr::isfinite(m_bbox.min) & dr::isfinite(m_bbox.max)))
            Throw("bbox_min and bbox_max must be finite, got %s and %s", m_bbox.min, m_bbox.max);
        if (!dr::all(m_bbox.min < m_bbox.max))
            Throw("bbox_min must be less than bbox_max in every coordinate, got %s and %s",
                  m_bbox.min, m_bbox.max);
    }

    /// Whether a scene gave a box.
    bool bounded() const { return m_bounded; }
    const ScalarBoundingBox3f &bbox() const { return m_bbox; }

    /// The part of a ray inside, as distances from its origin; empty (valid is false) if it misses.
    std::tuple<Mask, Float, Float> clip(const Ray3f &ray) const {
        if (!m_bounded)
            return { true, Float(0.f), Float(dr::Infinity<Float>) };
        auto [hit, near, far] = m_bbox.ray_intersect(ray);
        near = dr::maximum(near, 0.f);
        return { hit && near < far, near, far };
    }

    /// Whether a point is inside.
    Mask contains(const Point3f &p) const { return !m_bounded || Mask(m_bbox.contains(p)); }

    std::string to_string() const {
        std::ostringstream oss;
        if (m_bounded)
            oss << "  bbox_min = " << m_bbox.min << "," << std::endl
                << "  bbox_max = " << m_bbox.max << "," << std::endl;
        return oss.str();
    }

private:
    bool m_bounded = false;
    ScalarBoundingBox3f m_bbox;
};

} // namespace mitsuba
