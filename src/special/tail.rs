//! The tail of a Gaussian in closed form, near enough to start an iteration from.
//!
//!     erfcx(x) = e^(x²) erfc(x) ≈ (2/√π)/S(x),   S(x) = x + √(x² + 4/π),   x ≥ 0   (1)
//!
//! is exact at 0 and ∞ and at most 1.6 % high between. A step Δ along the tail changes ln erfc by
//!
//!     ℓ = Δ (2x + Δ) + ln(S(x + Δ)/S(x))                                 (2)
//!
//! of which the inverse is a square root, and one step of Newton's method. Both are relative: the
//! shortest steps keep their digits.

use crate::real::Real;
use crate::special::rel::psi;
use std::f64::consts::{FRAC_2_SQRT_PI, PI};

/// S(x) of (1) for x ≥ 0.
pub fn steepness<R: Real>(x: R) -> R {
    x + root(x)
}

/// ln erfc(x) by (1), for x ≥ 0.
pub fn log_erfc<R: Real>(x: R) -> R {
    (x.lit(FRAC_2_SQRT_PI) / steepness(x)).ln() - x * x
}

/// Δ ≥ 0 with erfc(x + Δ) = e^(−ℓ) erfc(x) by (1), for x ≥ 0 and ℓ = `decrease` ≥ 0.
pub fn outwards<R: Real>(x: R, decrease: R) -> R {
    let half = x + x.lit(0.5) / root(x);
    let step = decrease / (half + half.mul_add(half, decrease).sqrt());
    let (change, slope) = change(x, step);
    (step + (decrease - change) / slope).max(x.lit(0.0))
}

/// Δ in [0, x] with erfc(x − Δ) = e^ℓ erfc(x) by (1), for x ≥ 0 and ℓ = `increase` ≥ 0; x if
/// erfc(0) is less.
pub fn inwards<R: Real>(x: R, increase: R) -> R {
    let zero = x.lit(0.0);
    let half = x + x.lit(0.5) / root(x);
    let radicand = half.mul_add(half, -increase).max(zero);
    let step = (increase / (half + radicand.sqrt())).min(x);
    let (change, _) = change(x - step, step);
    let inner = x - step;
    let slope = inner + inner + x.lit(1.0) / root(inner);
    (step + (increase - change) / slope).max(zero).min(x)
}

fn root<R: Real>(x: R) -> R {
    x.mul_add(x, x.lit(4.0 / PI)).sqrt()
}

/// (2) from `x` to `x + step`, and its derivative by the step.
fn change<R: Real>(x: R, step: R) -> (R, R) {
    let end = x + step;
    let (here, there) = (root(x), root(end));
    let sum = x + end;
    let growth = step * (x.lit(1.0) + sum / (here + there)) / (x + here);
    (
        step * sum + growth * psi(-growth),
        end + end + x.lit(1.0) / there,
    )
}
