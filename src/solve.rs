//! Root of an increasing function: bracketed, with steps that are exact for exponentials.
//!
//! Near t the integrand is taken for f e^(−κ s), κ = −f′/f; the distance at which it has
//! gathered Δ is
//!
//!     s = Δ/f ψ(κ Δ/f),   ψ(y) = −ln(1 − y)/y                        (1)
//!
//! Newton's step is ψ = 1. (1) converges cubically, and is exact for one exponential layer
//! and for the uniform medium. A step beyond an end of the bracket goes to that end, for the
//! root may be there; if the end has been tried, or the integrand vanishes, it becomes a
//! bisection. `tests/solver.rs` states how many steps that takes.

use crate::real::{Mask, Real};
use crate::special::rel::psi;

/// An interval that contains the root.
#[derive(Clone, Copy)]
pub struct Bracket<R> {
    /// Not beyond the root.
    pub low: R,
    /// Not before the root; may be infinite.
    pub high: R,
}

/// Where the iteration starts.
#[derive(Clone, Copy)]
pub struct Start<R> {
    /// Holds the root.
    pub bracket: Bracket<R>,
    /// In the bracket.
    pub guess: R,
    /// Whether the guess is known to be within a few per cent.
    pub near: bool,
}

/// How far the iteration goes.
struct Limits {
    /// Most steps; a recorded solve takes them all.
    steps: usize,
    /// Δ relative to the target from which one more step is the last.
    missing: f64,
}

impl Limits {
    fn of<R: Real>(x: R, near: bool) -> Self {
        let (few, many, missing) = match (x.digits() <= 24, near) {
            (true, true) => (2, 12, 1e-4),
            (true, false) => (6, 12, 1e-4),
            (false, true) => (5, 40, 1e-8),
            (false, false) => (12, 40, 1e-8),
        };
        // Plain numbers stop when all are done, and may take their time.
        let steps = if R::DERIVATIVES { few } else { many };
        Self { steps, missing }
    }
}

/// A bracket that has been narrowed to points which were tried.
struct Search<R: Real> {
    bracket: Bracket<R>,
    low_tried: R::Mask,
    high_tried: R::Mask,
}

/// Where to go next.
struct Step<R: Real> {
    t: R,
    /// (1) holds to its third order, so that what remains after the step is negligible.
    exact: R::Mask,
}

impl<R: Real> Search<R> {
    fn within(bracket: Bracket<R>) -> Self {
        let no = bracket.low.lt(bracket.low);
        Self {
            bracket,
            low_tried: no,
            high_tried: no,
        }
    }

    /// Keeps the side of `t` that holds the root.
    fn narrow(&mut self, t: R, short: R::Mask) {
        let Bracket { low, high } = &mut self.bracket;
        *low = R::select(short, t, *low);
        *high = R::select(short, *high, t);
        self.low_tried = self.low_tried | short;
        self.high_tried = self.high_tried | !short;
    }

    /// (1) from `t`, where `missing` = Δ, or what replaces it.
    fn step(&self, t: R, goal: R, missing: R, (slope, curvature): (R, R)) -> Step<R> {
        let (zero, one) = (t.lit(0.0), t.lit(1.0));
        let dense = zero.lt(slope);
        let slope = R::select(dense, slope, one);
        let straight = missing / slope;
        let y = -(curvature / slope) * straight;
        // Where the model never gathers Δ, the density falls more slowly than it says.
        let modelled = dense & y.is_bounded();
        let next = t + straight * psi(R::select(modelled, y.min(t.lit(0.98)), zero));
        // Far beyond the root ln g is closer to a straight line than g: down into a planet the
        // density grows, and may have had its summit in between.
        let excess = -missing / goal;
        let far = dense & t.lit(10.0).lt(excess) & excess.is_bounded();
        let ratio = one + R::select(far, excess, zero);
        let back = t - goal * ratio / slope * ratio.ln();
        let next = R::select(far, back, next);

        let Bracket { low, high } = self.bracket;
        let bounded = high.is_bounded();
        // Where next to nothing is left before a gap, the model leads beyond all other matter.
        let leap = R::select(bounded | t.le(zero), next, t * t.lit(1e3));
        let next = next.min(leap);
        let middle = R::select(
            bounded,
            middle(low, R::select(bounded, high, low)),
            t + t + one,
        );
        let before = (modelled | far) & next.lt(low);
        let beyond = !(modelled | far) | high.lt(next) | !next.is_bounded();
        let untried = !self.high_tried & bounded & dense;
        let next = R::select(before, R::select(self.low_tried | far, middle, low), next);
        let next = R::select(beyond, R::select(untried, high, middle), next);

        let near = (next - t).abs().le(t.lit(0.01) * t);
        let exact = modelled & y.abs().lt(t.lit(0.1)) & near;
        Step { t: next, exact }
    }
}

/// Bisects the logarithm of a wide bracket: an end far beyond all matter is soon forgotten.
fn middle<R: Real>(low: R, high: R) -> R {
    let wide = (low * low.lit(8.0)).lt(high);
    let end = R::select(wide, high, low.lit(1.0));
    let ratio = (R::select(wide, low, end) / end).max(low.lit(1e-3));
    R::select(wide, end * ratio.sqrt(), low.lit(0.5) * (low + high))
}

/// The t in the bracket with g(t) = `target` > 0.
///
/// `value` is g and `slopes` are g′ ≥ 0 and g″, without derivatives by parameters, for the
/// iteration; `attached` is g with them, for one last step. That step carries
/// ∂t/∂θ = −(∂g/∂θ)/f, the implicit function theorem, so that derivatives never run through
/// the iteration; numbers without derivatives need no such step.
pub fn increasing<R: Real>(
    value: impl Fn(R) -> R,
    slopes: impl Fn(R) -> (R, R),
    attached: impl Fn(R) -> R,
    target: R,
    start: Start<R>,
) -> R {
    let (t, stride) = iterate(value, &slopes, target.detach(), start);
    if R::DERIVATIVES {
        t + last_step(t, target - attached(t), slopes(t).0, stride)
    } else {
        t
    }
}

/// The t in the bracket with g(t) = `goal` > 0, without its derivatives, and the step that led
/// there.
pub fn iterate<R: Real>(
    value: impl Fn(R) -> R,
    slopes: impl Fn(R) -> (R, R),
    goal: R,
    start: Start<R>,
) -> (R, R) {
    let limits = Limits::of(goal, start.near);
    let tolerance = goal * goal.lit(limits.missing);
    let rounding = goal * (goal.lit(4.0) * goal.unit_roundoff());

    let mut t = start.guess;
    let mut search = Search::within(start.bracket);
    let mut done = t.lt(t);
    let mut stride = t.lit(0.0);
    for _ in 0..limits.steps {
        let missing = goal - value(t);
        let rest = missing.abs();
        // Where nothing is missing, the density may vanish, and a step lead anywhere.
        done = done | rest.le(rounding);
        search.narrow(t, t.lit(0.0).lt(missing));
        let next = search.step(t, goal, missing, slopes(t));
        stride = R::select(done, stride, (next.t - t).abs());
        let moved = (t * t.unit_roundoff()).lt((next.t - t).abs());
        t = R::select(done, t, next.t);
        done = done | (rest.le(tolerance) & next.exact) | !moved;
        if !(!done).any() {
            break;
        }
    }
    (t, stride)
}

/// Newton's step with the derivatives of `missing`; its value counts only if it is no longer
/// than the `stride` before it.
fn last_step<R: Real>(t: R, missing: R, slope: R, stride: R) -> R {
    let (zero, one) = (t.lit(0.0), t.lit(1.0));
    let dense = zero.lt(slope) & t.is_bounded();
    let step = R::select(dense, missing, zero) / R::select(dense, slope, one);
    let plain = step.detach();
    step - R::select(plain.abs().le(stride), zero, plain)
}
