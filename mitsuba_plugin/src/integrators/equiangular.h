// Equiangular sampling: distances along a ray in proportion to the light that a point sheds on it.

#pragma once

#include <drjit/array.h>
#include <drjit/math.h>

namespace mitsuba {

namespace dr = drjit;

/**
 * The segment of a ray as it is seen from a point: uniform in the angle θ at which it is seen.
 *
 *     s = h tan θ                                                  (1)
 *     p(s) = h / (Δ (h² + s²)),   Δ = θ(b) - θ(a)                  (2)
 *     Δ = atan2(h (b - a), h² + a b);   atan2(h, a) for b = ∞      (3)
 *     s - a = (h² + a²) sin φ / (h cos φ - a sin φ),   φ = u Δ     (4)
 *
 * h is the distance of the point from the line, s that of a place on it from the point's foot,
 * positive in the direction of the ray; the segment reaches from a to b. (3) and (4) are
 * differences of (1) without their cancellation, which a short segment far away would suffer.
 *
 * The density (2) is that of the falling off with the inverse square of the distance: in a clear
 * medium and with an isotropic phase function every sample brings the same light.
 *
 * Through the point itself, h is taken for a few roundings of its distance: the density stays
 * finite, and (2) that of (4).
 *
 * Source: Kulla and Fajardo, "Importance Sampling Techniques for Path Tracing in Participating
 * Media", Computer Graphics Forum 31(4), EGSR 2012, section 4.
 */
template <typename Vector, typename Float = dr::value_t<Vector>> class Equiangular {
public:
    /**
     * \param point   less the start of the segment
     * \param d       direction of the ray, a unit vector
     * \param length  of the segment; may be infinite
     */
    Equiangular(const Vector &point, const Vector &d, const Float &length)
        : m_d(d), m_a(-dr::dot(point, d)), m_length(length) {
        const Float rounding = 16.f * dr::Epsilon<Float> * dr::norm(point);
        m_h = dr::maximum(dr::norm(dr::fmadd(d, m_a, point)), dr::maximum(rounding, Tiny));
        const Mask finite = dr::isfinite(length);
        const Float bounded = dr::select(finite, length, 0.f);
        m_angle = dr::atan2(dr::select(finite, m_h * bounded, m_h),
                            dr::select(finite, dr::square(m_h) + m_a * (m_a + bounded), m_a));
    }

    /// Distance from the start of the segment (4), of the uniform variate `u` in [0, 1).
    Float sample(const Float &u) const {
        const auto [sin, cos] = dr::sincos(u * m_angle);
        const Float r = far(m_a), h = m_h / r, rest = h * cos - m_a / r * sin;
        return dr::minimum(r * sin / dr::maximum(rest, dr::Epsilon<Float> * h), m_length);
    }

    /// Density (2) of a place, given less the point: 1/length, 0 if there is no segment.
    Float pdf(const Vector &place) const {
        const Float r = far(dr::dot(place, m_d));
        return dr::select(m_angle > 0.f, m_h / r / (m_angle * r), 0.f);
    }

private:
    using Mask = dr::mask_t<Float>;

    /// The square is above the smallest normal number in single precision.
    static constexpr dr::scalar_t<Float> Tiny = 1e-18f;

    /// Distance of a place from the point.
    Float far(const Float &s) const { return dr::sqrt(dr::square(m_h) + dr::square(s)); }

    Vector m_d;
    Float m_a, m_h, m_length;
    /// Δ (3), in radians, up to π.
    Float m_angle;
};

} // namespace mitsuba
