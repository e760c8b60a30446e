// Equiangular sampling: distances along a ray in proportion to the light that a point sheds on it.

#pragma once

#include <drjit/array.h>
#include <drjit/math.h>

namespace mitsuba {

namespace dr = drjit;

/**
 * The segment of a ray as it is seen from a point, from a to b on the ray.
 *
 * s is the distance of a place from the foot of the point, positive in the direction of the ray, h
 * that of the point from the line, and r that of the place from the point. ψ is the angle by which
 * the point's light is scattered back along the ray, from 0 far before the point to π far behind:
 *
 *     tan(ψ/2) = (r + s)/h,   dψ = h ds/(h² + s²)                      (1)
 *
 * Kulla and Fajardo draw ψ uniformly: the density of s falls off like the light, with the inverse
 * square of r. Phase functions with a forward peak vary as much as that, so ψ gets a peak, too, the
 * Poisson kernel P, whose integral χ is an angle from 0 to π:
 *
 *     P(ψ) = k/(cos²(ψ/2) + k² sin²(ψ/2)) = 2k/((1 - s/r) + k² (1 + s/r)),   P(0)/P(π) = k²   (2)
 *     tan(χ/2) = k tan(ψ/2)                                            (3)
 *     p(s) = P(ψ) h/(X (h² + s²)),   X = χ(b) - χ(a)                   (4)
 *     s - a = h/2 (τ - τ(a)) (1 + 1/(τ τ(a))),   τ = tan(ψ/2)          (5)
 *
 * k = 1 is uniform in ψ. For a Henyey-Greenstein phase function of the asymmetry g, and
 * k = (1 + g)/(1 - g), what is left of it is 1/√(cos²(ψ/2) + k² sin²(ψ/2)): in a clear medium and
 * on the whole line its variance is at most 0.24 of its mean squared, however large g is.
 *
 * With k, all that the point sheds on the segment is X/h. A point that is one of several, chosen in
 * proportion to that, and a place have the joint density
 *
 *     p(point, s) = P(ψ)/((h² + s²) Σ X/h)                             (6)
 *
 * Differences of τ and χ are formed without cancellation, for short segments far away. Through the
 * point itself, h is taken for a few roundings of its distance, in density and samples alike.
 *
 * Source: Kulla and Fajardo, "Importance Sampling Techniques for Path Tracing in Participating
 * Media", Computer Graphics Forum 31(4), EGSR 2012, section 4, for k = 1.
 */
template <typename Vector, typename Float = dr::value_t<Vector>> class Equiangular {
public:
    /**
     * \param point   less the start of the segment
     * \param d       direction of the ray, a unit vector
     * \param length  of the segment; may be infinite
     * \param k       the root of P(0)/P(π), > 0
     */
    Equiangular(const Vector &point, const Vector &d, const Float &length, const Float &k)
        : m_d(d), m_length(length), m_k(k) {
        const Float a = -dr::dot(point, d), rounding = 16.f * dr::Epsilon<Float> * dr::norm(point);
        m_h = dr::maximum(dr::norm(dr::fmadd(d, a, point)), dr::maximum(rounding, Tiny));
        m_tau = advance(a) / m_h;

        const dr::mask_t<Float> finite = dr::isfinite(length);
        const Float bounded = dr::select(finite, length, 0.f), b = a + bounded,
                    difference =
                        bounded / m_h * (advance(a) + advance(b)) / (distance(a) + distance(b));
        m_half = dr::atan2(
            dr::select(finite, k * difference, 1.f),
            dr::select(finite, dr::fmadd(k * m_tau, k * advance(b) / m_h, 1.f), k * m_tau));
    }

    /// Distance from the start of the segment (5), of the uniform variate `u` in [0, 1).
    Float sample(const Float &u) const {
        const auto [sin, cos] = dr::sincos(u * m_half);
        const Float start = m_k * m_tau, rest = dr::maximum(cos - start * sin, dr::Epsilon<Float>),
                    difference = sin * dr::fmadd(start, start, 1.f) / (rest * m_k),
                    tau = m_tau + difference;
        return dr::minimum(.5f * m_h * (difference + difference / (tau * m_tau)), m_length);
    }

    /// X/h: what the point sheds on the segment, 1/length.
    Float exposure() const { return 2.f * m_half / m_h; }

    /// Density (6) of a place, given less the point: 1/length; 0 if there is no segment.
    ///
    /// \param exposures  sum over all points; that of this one leaves (4)
    Float pdf(const Vector &place, const Float &exposures) const {
        const Float s = dr::dot(place, m_d), r = distance(s),
                    peak = 2.f * m_k / ((1.f - s / r) + dr::square(m_k) * (1.f + s / r));
        return dr::select(exposures > 0.f, peak / (exposures * dr::square(r)), 0.f);
    }

private:
    /// The square is above the smallest normal number in single precision.
    static constexpr dr::scalar_t<Float> Tiny = 1e-18f;

    /// r
    Float distance(const Float &s) const { return dr::sqrt(dr::square(m_h) + dr::square(s)); }

    /// r + s
    Float advance(const Float &s) const {
        const Float sum = distance(s) + dr::abs(s);
        return dr::select(s < 0.f, m_h * (m_h / sum), sum);
    }

    Vector m_d;
    Float m_length, m_k, m_h;
    /// tan(ψ/2) at the start.
    Float m_tau;
    /// X/2, in radians.
    Float m_half;
};

} // namespace mitsuba
