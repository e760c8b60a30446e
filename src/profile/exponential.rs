//! Exponential profile: plane-parallel layers with scale height H.
//!
//!     ρ(h) = exp(−h/H)                                               (article, Eq. 32)
//!     N(t) = ρ(min(h₀, h₁)) t φ(|μ| t/H),   φ(x) = (1 − e⁻ˣ)/x       (34)
//!     t(N) = s ψ(μ s/H),  s = N/ρ(h₀),      ψ(y) = −ln(1 − y)/y      (35)
//!
//! h₀ and h₁ are the altitudes of the ends of the segment. (34) starts from the denser end,
//! so it neither overflows nor cancels, and gives the same column in both directions. (34)
//! and (35) are smooth through μ = 0: a horizontal ray is no special case, and falloff
//! 1/H = 0 is the uniform medium, bit for bit. In (35) y = μ s/H ≥ 1 means that the whole
//! column up to infinity is less than N. From so high up that ρ(h₀) vanishes in the number
//! format, a descending ray reaches N at
//!
//!     t(N) = (H/|μ|) (ln(|μ| N/H) + h₀/H)                            (35, for y → −∞)
//!
//! With M = ∫ s ρ ds and M′ likewise from the denser end, x = |μ| t/H,
//!
//!     M′ = ρ t² φ₁(x),   M = M′ or t N − M′,   φ₁ = −φ′                      (37)
//!     ∂N/∂H = (h N + |μ| M′)/H²,   ∂N/∂o = −up N/H,   ∂N/∂d = −up M/H        (38)
//!
//! with ρ and h at the denser end.
//!
//! Relative error, times the condition of h/H: below 8e-16 (f64), 6e-7 (f32).
//! The article's listing of (34) has the wrong sign of the height and drops it for
//! horizontal rays; see `docs/accuracy.md`.

use super::gradient::Gradient;
use super::{Parameter, Profile};
use crate::error::{self, Error};
use crate::geometry::{Plane, Ray, Vector, climb};
use crate::real::{Real, either};
use crate::special::rel::{phi, phi_moment, psi};
use glam::DVec3;

/// ρ(h) = exp(−`falloff` h), h the altitude above `plane`.
#[derive(Clone, Copy, Debug)]
pub struct Exponential<R> {
    /// Where h = 0, ρ = 1.
    pub plane: Plane<R>,
    /// n = 1/H, 1/length.
    pub falloff: R,
}

pub(super) const PARAMETERS: &[Parameter] = &[
    Parameter::UP,
    Parameter::BASE_HEIGHT,
    Parameter::required("scale_height"),
];

pub(super) fn check(values: &[f64]) -> Result<(), Error> {
    error::unit("up", [values[0], values[1], values[2]])?;
    error::finite("base_height", values[3])?;
    error::positive("scale_height", values[4])?;
    Ok(())
}

pub(super) fn from_values<R: Real>(values: &[R]) -> Exponential<R> {
    Exponential {
        plane: Plane {
            up: [values[0], values[1], values[2]],
            base_height: values[3],
        },
        falloff: values[4].lit(1.0) / values[4],
    }
}

impl Exponential<f64> {
    /// Layers that thin out by a factor e per `1/falloff` of altitude; 0 is uniform.
    ///
    /// # Errors
    /// If `falloff` is negative or not finite, or `up` is not a unit vector.
    pub fn with_falloff(falloff: f64, base_height: f64, up: DVec3) -> Result<Self, Error> {
        Ok(Self {
            plane: Plane {
                up: error::unit("up", up.to_array())?,
                base_height: error::finite("base_height", base_height)?,
            },
            falloff: error::not_negative("falloff", falloff)?,
        })
    }
}

impl<R: Real> Exponential<R> {
    /// ρ at an altitude, which may be infinite.
    pub(crate) fn at(&self, altitude: R) -> R {
        (-climb(self.falloff, altitude)).exp()
    }
}

/// Infimum and supremum of exp(−`falloff` h) between two altitudes.
pub(super) fn between<R: Real>(falloff: R, (low, high): (R, R)) -> (R, R) {
    let at = |altitude: R| (-climb(falloff, altitude)).exp();
    // The product h/H and its exponential are rounded too.
    let widen = |altitude: R| {
        let exponent = climb(falloff, altitude).abs();
        let one = altitude.lit(1.0);
        let error = (exponent + one) * altitude.unit_roundoff() * altitude.lit(4.0);
        R::select(exponent.is_bounded(), error, altitude.lit(0.0))
    };
    let one = low.lit(1.0);
    // The density may be infinite where the factor is 0.
    let factor = (one - widen(high)).max(one.lit(0.0));
    let some = one.lit(0.0).lt(factor);
    let inf = R::select(some, at(high), factor) * factor;
    let sup = at(low) * (one + widen(low));
    (inf, sup)
}

impl<R: Real> Profile<R> for Exponential<R> {
    /// (32)
    fn density(&self, point: Vector<R>) -> R {
        (-(self.plane.altitude(point) * self.falloff)).exp()
    }

    fn density_along(&self, ray: &Ray<R>, t: R) -> (R, R) {
        let density = self.density(ray.at(t));
        let rate = self.plane.cos_zenith(ray.direction) * self.falloff;
        (density, -(rate * density))
    }

    /// (34); infinite segments have the limit for t → ∞.
    fn column(&self, ray: &Ray<R>, t: R) -> R {
        let (zero, one, infinity) = (t.lit(0.0), t.lit(1.0), t.lit(f64::INFINITY));
        let (start, end) = self.plane.ends(ray, t);
        let rate = self.plane.cos_zenith(ray.direction) * self.falloff;
        // One mask for both, so that a horizontal ray has the derivatives of one side.
        let descends = rate.lt(zero);
        let densest = self.at(R::select(descends, end, start));
        let decay = R::select(descends, -rate, rate);

        let finite = t.is_bounded();
        let t = R::select(finite, t, zero);
        let effective = t * phi(decay * t);
        // Where the density overflows, a segment without length still has no column.
        let column = R::select(zero.lt(effective), densest, zero) * effective;

        let ascends = zero.lt(rate);
        let scale = one / R::select(ascends, rate, one);
        let endless = R::select(ascends, densest * scale, infinity);
        R::select(finite, column, endless)
    }

    /// (34), (37) and (38): two exponentials, as many as (34) alone.
    fn column_value_and_gradient(&self, ray: &Ray<R>, t: R) -> (R, Gradient<R>) {
        let (zero, one, infinity) = (t.lit(0.0), t.lit(1.0), t.lit(f64::INFINITY));
        let (start, end) = self.plane.ends(ray, t);
        let n = self.falloff;
        let rate = self.plane.cos_zenith(ray.direction) * n;
        let descends = rate.lt(zero);
        let lower = R::select(descends, end, start);
        let densest = self.at(lower);
        let decay = R::select(descends, -rate, rate);

        let finite = t.is_bounded();
        let length = R::select(finite, t, zero);
        let relative = phi_moment(decay * length);
        let effective = length * relative.phi;
        let some = zero.lt(effective);
        let inner = R::select(some, densest, zero);
        let moment = length * (length * relative.moment);
        let other = length * (length * (relative.phi - relative.moment));

        let ascends = zero.lt(rate);
        let scale = one / R::select(ascends, rate, one);
        let endless = R::select(ascends, densest * scale, infinity);
        let value = R::select(finite, inner * effective, endless);
        let from_below = R::select(finite, inner * moment, endless * scale);
        let from_start = R::select(descends, inner * other, from_below);

        let last = R::select(descends, densest, densest * relative.exp);
        let (column, moment) = (n * value, n * from_start);
        let up = self.plane.up;
        let by_up = |i: usize| -(ray.origin[i] * column + ray.direction[i] * moment);
        let by_height = n * (lower * column + decay * from_below);
        let gradient = Gradient {
            parameters: [by_up(0), by_up(1), by_up(2), column, by_height]
                .into_iter()
                .collect(),
            origin: up.map(|x| -(x * column)),
            direction: up.map(|x| -(x * moment)),
            last: R::select(finite, last, zero),
        };
        (value, gradient.of(value))
    }

    /// (35)
    fn inv_column(&self, ray: &Ray<R>, column: R) -> R {
        let (zero, one, infinity) = (column.lit(0.0), column.lit(1.0), column.lit(f64::INFINITY));
        let start = self.plane.altitude(ray.origin) * self.falloff;
        let rate = self.plane.cos_zenith(ray.direction) * self.falloff;
        // Just above the least normal number.
        let vanishing = if column.digits() <= 24 {
            1.2e-38
        } else {
            2.3e-308
        };

        let density = (-start).exp();
        let vanishes = density.lt(column.lit(vanishing)) & zero.lt(column);
        let finite = column.is_bounded();
        let straight = R::select(finite, column, zero) / density.max(column.lit(vanishing));
        let y = climb(rate, straight);
        let descends = rate.lt(zero);
        let reached = y.lt(one) & (descends | !vanishes);
        // ψ must not see what is not reached, even unselected; nor y = −∞.
        let beyond = column.lit(-1e16);
        let near = reached & beyond.lt(y) & finite & !vanishes;
        either(
            near,
            || R::select(near, straight, one) * psi(R::select(near, y, zero)),
            || {
                let far = reached & !near & finite;
                let rate = R::select(far, -rate, one);
                let descent = ((rate * R::select(far, column, one)).ln() + start) / rate;
                R::select(far, descent.max(zero), infinity)
            },
        )
    }

    fn bounds(&self, ray: &Ray<R>, t: R) -> (R, R) {
        between(self.falloff, self.plane.range(ray, t))
    }

    fn bounds_in_box(&self, lo: Vector<R>, hi: Vector<R>) -> (R, R) {
        between(self.falloff, self.plane.range_in_box(lo, hi))
    }

    fn detach(&self) -> Self {
        Self {
            plane: self.plane.detach(),
            falloff: self.falloff.detach(),
        }
    }
}
