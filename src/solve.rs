//! Root of an increasing function: bracketed, with steps that are exact for exponentials.
//!
//! Near t the integrand is taken for f e^(−κ s), κ = −f′/f; the distance at which it has
//! gathered Δ is
//!
//!     s = Δ/f ψ(κ Δ/f),   ψ(y) = −ln(1 − y)/y                        (1)
//!
//! Newton's step is ψ = 1. (1) converges cubically, and is exact for one exponential layer
//! and for the uniform medium. A step that leaves the bracket, or is undefined because the
//! integrand vanishes, becomes a bisection.

use crate::real::{Mask, Real};
use crate::special::rel::psi;

/// What is known of the function at a point: its value, slope and curvature.
pub struct Sample<R> {
    /// g(t).
    pub value: R,
    /// f = g′(t) ≥ 0.
    pub slope: R,
    /// f′ = g″(t).
    pub curvature: R,
}

/// An interval that contains the root.
#[derive(Clone, Copy)]
pub struct Bracket<R> {
    /// Not beyond the root.
    pub low: R,
    /// Not before the root; may be infinite.
    pub high: R,
}

/// Steps of a recorded solve; scalars and lanes stop as soon as all are done.
const STEPS: usize = 10;

impl<R: Real> Bracket<R> {
    /// (1) from `t`, where `missing` = target − g(t); else the middle of the bracket.
    fn step(&self, t: R, missing: R, slope: R, curvature: R) -> R {
        let (zero, one) = (t.lit(0.0), t.lit(1.0));
        let dense = zero.lt(slope);
        let slope = R::select(dense, slope, one);
        let straight = missing / slope;
        let y = -(curvature / slope) * straight;
        let modelled = dense & y.lt(one);
        let next = t + straight * psi(R::select(modelled, y, zero));
        let inside = modelled & self.low.le(next) & next.le(self.high);
        let middle = t.lit(0.5) * (self.low + self.high);
        let ahead = self.low + self.low + one;
        let middle = R::select(self.high.is_bounded(), middle, ahead);
        R::select(inside, next, middle)
    }
}

/// The t in the bracket with g(t) = `target` > 0, from the guess `t`.
///
/// `sample` is g without derivatives, for the iteration; `attached` is g with derivatives,
/// for one last step: that step carries ∂t/∂θ = −(∂g/∂θ)/f, the implicit function theorem,
/// so that derivatives never run through the iteration.
pub fn increasing<R: Real>(
    sample: impl Fn(R) -> Sample<R>,
    attached: impl Fn(R) -> R,
    target: R,
    mut bracket: Bracket<R>,
    mut t: R,
) -> R {
    let goal = target.detach();
    // The step after this test is cubic, so what remains is below the rounding error.
    let tolerance = goal.unit_roundoff().sqrt() * goal.lit(0.1) * goal;
    let mut done = t.lit(1.0).lt(t.lit(0.0));
    for _ in 0..STEPS {
        let here = sample(t);
        let missing = goal - here.value;
        let short = t.lit(0.0).lt(missing);
        bracket.low = R::select(!done & short, t, bracket.low);
        bracket.high = R::select(!done & !short, t, bracket.high);
        let next = bracket.step(t, missing, here.slope, here.curvature);
        t = R::select(done, t, next);
        done = done | missing.abs().le(tolerance);
        if !(!done).any() {
            break;
        }
    }
    let slope = sample(t).slope;
    let dense = t.lit(0.0).lt(slope);
    let missing = target - attached(t);
    t + R::select(dense, missing, t.lit(0.0)) / R::select(dense, slope, t.lit(1.0))
}
