//! The Chapman function: the column of a ray to infinity through an exponential atmosphere
//! around a planet, relative to that of a vertical ray.
//!
//!     C(z, θ) = ∫₀^∞ exp(z − √(z² + t (2 z cos θ + t))) dt               (article, Eq. 42)
//!     C_r(z, θ) = e^(Z − z) C(z, θ)                                      (article, Eq. 43)
//!
//! z = r/H is the distance from the centre and Z = R/H the radius of the planet, in scale heights,
//! cos θ is positive upwards. With the perigee p = z sin θ, the depth of it a = z − p, and A the
//! column of a piece that leads outwards ([`super::arc`]),
//!
//!     C(z, θ) = A(p, a, ∞)                              0° ≤ θ ≤ 90°     (1)
//!     C(z, θ) = e^a (A(p, 0, ∞) + A(p, 0, a))           θ > 90°          (2)
//!
//! (2) adds the two sides of the perigee where the article subtracts (Eq. 48), so nothing cancels.
//! The planet is transparent: a ray that leads down gathers what lies below it, and C grows to
//! 2 e^z − 1 at the nadir. Where it overflows it is ∞, and the logarithm is still a number.
//!
//! e^a would multiply the rounding error of a, so a is kept as a sum of two numbers:
//!
//!     a = z cos²θ/(1 + sin θ)                                            (3)
//!
//! in which nothing cancels either.
//!
//! | function | relative error f64, f32 |
//! |---|---|
//! | [`chapman`] and its parts, [`rescaled`], z ≥ 0 | 9e-14, 1e-6 |
//! | [`log_chapman`], [`log_rescaled`], over 1 + the value's own size | 2e-14, 1e-6 |
//!
//! The worst that has been seen; `tests/functions.rs` asserts 1e-12 and 2e-6 on the reference tables.

use super::arc::arc;
use super::bessel;
use crate::real::{Real, difference, either};

/// C(z, θ) of (1) and (2): `z` ≥ 0 finite, −1 ≤ `cos_zenith` ≤ 1.
pub fn chapman<R: Real>(z: R, cos_zenith: R) -> R {
    Slant::new(z, cos_zenith).chapman().value()
}

/// ln C(z, θ), finite where C overflows.
pub fn log_chapman<R: Real>(z: R, cos_zenith: R) -> R {
    Slant::new(z, cos_zenith).chapman().ln()
}

/// C_r of Eq. 43: `surface` = Z, finite. H C_r is the column of the ray where the density at the
/// surface is 1.
pub fn rescaled<R: Real>(z: R, surface: R, cos_zenith: R) -> R {
    Slant::new(z, cos_zenith)
        .chapman()
        .rescale(z, surface)
        .value()
}

/// ln C_r(z, θ), finite where C_r overflows or vanishes.
pub fn log_rescaled<R: Real>(z: R, surface: R, cos_zenith: R) -> R {
    Slant::new(z, cos_zenith).chapman().rescale(z, surface).ln()
}

/// (1) alone, for 0 ≤ `cos_zenith` ≤ 1: half the cost in recorded formulas.
pub fn upper<R: Real>(z: R, cos_zenith: R) -> R {
    Slant::new(z, cos_zenith).upper()
}

/// C(z, 90°) = z e^z K₁(z).
pub fn horizontal<R: Real>(z: R) -> R {
    bessel::k1_scaled(z)
}

/// (2) alone, for −1 ≤ `cos_zenith` ≤ 0.
pub fn lower<R: Real>(z: R, cos_zenith: R) -> R {
    Slant::new(z, cos_zenith).lower().value()
}

/// A ray as the centre sees it, in scale heights.
struct Slant<R: Real> {
    descends: R::Mask,
    /// p.
    perigee: R,
    /// a, rounded, and the rest of it.
    depth: (R, R),
}

impl<R: Real> Slant<R> {
    fn new(z: R, cos_zenith: R) -> Self {
        let (zero, one) = (z.lit(0.0), z.lit(1.0));
        // sin θ = √(1 − cos²θ) as a sum of two numbers.
        let square = cos_zenith * cos_zenith;
        let square_rest = cos_zenith.product_rest(cos_zenith);
        let other = one - square;
        let other_rest = ((one - other) - square) - square_rest;
        let some = zero.lt(other);
        let sine = R::select(some, other, one).sqrt();
        let missing = other_rest + (other - sine * sine - sine.product_rest(sine));
        let sine_rest = R::select(some, missing / (sine + sine), zero);
        let sine = R::select(some, sine, zero);

        // (3), numerator and denominator too as sums of two numbers.
        let below = one + sine;
        let below_rest = (sine - (below - one)) + sine_rest;
        let above = z * square;
        let above_rest = z.product_rest(square) + z * square_rest;
        let depth = above / below;
        let missing = above - depth * below - depth.product_rest(below);
        let rest = (missing + above_rest - depth * below_rest) / below;
        Self {
            descends: cos_zenith.lt(zero),
            perigee: z.mul_add(sine, z * sine_rest),
            depth: (depth, rest),
        }
    }

    /// (1) or (2)
    fn chapman(&self) -> Scaled<R> {
        let zero = self.perigee.lit(0.0);
        let of_descent = |x: R| R::select(self.descends, x, zero);
        Scaled {
            factor: either(self.descends, || self.both_sides(), || self.upper()),
            exponent: of_descent(self.depth.0),
            rest: of_descent(self.depth.1),
        }
    }

    /// (1)
    fn upper(&self) -> R {
        arc(self.perigee, self.depth.0, self.perigee.lit(f64::INFINITY))
    }

    /// (2)
    fn lower(&self) -> Scaled<R> {
        Scaled {
            factor: self.both_sides(),
            exponent: self.depth.0,
            rest: self.depth.1,
        }
    }

    /// (2) without e^a.
    fn both_sides(&self) -> R {
        let zero = self.perigee.lit(0.0);
        let outwards = |range| arc(self.perigee, zero, range);
        outwards(zero.lit(f64::INFINITY)) + outwards(self.depth.0)
    }
}

/// `factor` e^(`exponent` + `rest`), the rest being what rounding took from the exponent.
struct Scaled<R> {
    factor: R,
    exponent: R,
    rest: R,
}

impl<R: Real> Scaled<R> {
    /// Times e^(Z − z).
    fn rescale(self, z: R, surface: R) -> Self {
        let (shift, shift_rest) = difference(surface, z);
        let (exponent, rest) = difference(self.exponent, -shift);
        Self {
            exponent,
            rest: rest + shift_rest + self.rest,
            ..self
        }
    }

    fn value(self) -> R {
        let (half, one) = (self.rest.lit(0.5), self.rest.lit(1.0));
        // The rest of an exponent that does not overflow is far smaller.
        let rest = self.rest.max(-half).min(half);
        self.factor * (self.exponent.exp() * (one + rest))
    }

    fn ln(self) -> R {
        self.exponent + (self.factor.ln() + self.rest)
    }
}
