//! What decays like a Gaussian: the integral that columns around a centre are made of.
//!
//!     D(a, Y) = ∫_√a^√(a+Y) e^(a − x²) g(x²) dx                          (1)
//!
//! With x² = a + y, y is the exponent gained since the start: e^(−y) = 1 there and e^(−Y) at
//! the end. The Chapman function and columns around a planet have a smooth algebraic g (see
//! `super::arc`), erfcx and columns of Gaussians a constant one.
//!
//! The start is factored out and the length of the interval is Y/(√(a+Y) + √a), so nothing
//! cancels, however short the interval or large a. One rule of [`super::gauss_legendre`]
//! serves every interval; what lies beyond Y = 17 (f32) or 37 (f64) is below rounding.
//! There is no switch between methods, hence no seam: D grows with Y by sums of positive
//! terms.

use super::gauss_legendre::{integrate, integrate_each};
use crate::real::Real;

/// (1) from `start` = √a ≥ 0 over the exponent `range` = Y ≥ 0, which may be infinite.
pub fn decay<R: Real>(start: R, range: R, g: impl Fn(R) -> R) -> R {
    integrate(
        length(start, range),
        |step| step * (start + start + step),
        |step| {
            let x = start + step;
            g(x * x)
        },
    )
}

/// (1) for several g at once, with the exponentials of one: functions of x and of y = x² − a.
pub fn decay_each<R: Real, const M: usize>(
    start: R,
    range: R,
    g: impl Fn(R, R) -> [R; M],
) -> [R; M] {
    let gained = |step: R| step * (start + start + step);
    integrate_each(length(start, range), gained, |step| {
        g(start + step, gained(step))
    })
}

/// √(a + Y) − √a, up to where nothing is left.
fn length<R: Real>(start: R, range: R) -> R {
    let (cutoff, vanishing) = if start.digits() <= 24 {
        (17.0, 1e-37)
    } else {
        (37.0, 1e-300)
    };
    let range = range.min(range.lit(cutoff));
    let end = start.mul_add(start, range).max(range.lit(vanishing)).sqrt();
    range / (end + start)
}
