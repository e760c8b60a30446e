//! The modified Bessel function K₁, scaled.
//!
//!     z e^z K₁(z) = C(z, 90°) = A(z, 0, ∞)                             (article, Eq. 47)
//!
//! is the column of a horizontal ray through an exponential atmosphere, in scale heights: the
//! integral of [`super::arc`], which needs no intervals of its own. 1 at z = 0, √(πz/2) for large z.

use super::arc::arc;
use crate::real::Real;

/// z e^z K₁(z) for z ≥ 0. Relative error below 2e-14 (f64) and 6e-7 (f32); costs the exponentials
/// of one quadrature.
pub fn k1_scaled<R: Real>(z: R) -> R {
    arc(z, z.lit(0.0), z.lit(f64::INFINITY))
}
