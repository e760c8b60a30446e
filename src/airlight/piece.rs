//! The variable of integration.
//!
//! The paper splits the ray at the foot of the light (Eq. 20) and substitutes v = u + √(1 + u²)
//! before it (Eq. 9) and w = u − √(1 + u²) beyond it (Eq. 15), u = s/h. With
//!
//!     q = 1/(D + |s|),   D = √(h² + s²)
//!
//! they are v = hq and w = −hq: the tangent of half the angle from the ray, seen from the light. On
//! either side
//!
//!     dx/D² = 2 dq/(1 + h²q²),   D + s = h²q before the foot, 1/q beyond it,
//!
//! so the integrand is rational but for one exponential, regular as h → 0, and an infinite ray ends at
//! q = 0. Differences are formed without cancelling:
//!
//!     q₂ − q₁ = ± (s₂ − s₁) (1 + (|s₁| + |s₂|)/(D₁ + D₂)) q₁ q₂.

use super::frame::Frame;
use crate::real::Real;

/// A part of the ray on one side of the foot.
#[derive(Clone, Copy, Debug)]
pub struct Piece<R> {
    /// −1 before the foot, 1 beyond it.
    pub sign: R,
    /// q where the piece begins, 1/length.
    pub start: R,
    /// |q − `start`| where it ends, or where next to nothing is left, 1/length.
    pub range: R,
    /// Path from t0 to the beginning and from there to the light, length.
    pub path: R,
}

impl<R: Real> Piece<R> {
    /// The piece from `first` to `last` (signed distances from the foot) of length `length`; `before`
    /// it the ray has come a way. It ends early where the least extinction `sigma_t` leaves
    /// e^(−`depth`).
    pub(crate) fn new(
        frame: &Frame<R>,
        sign: R,
        [first, last]: [R; 2],
        length: R,
        before: R,
        (sigma_t, depth): (R, f64),
    ) -> Self {
        let (zero, one) = (sign.lit(0.0), sign.lit(1.0));
        let (depth, least) = (sign.lit(depth), sign.lit(frame.least()));
        let (near, far) = ((sign * first).max(zero), (sign * last).max(zero));
        let (here, there) = (frame.distance(near), frame.distance(far));
        let (start, end) = (one / (here + near), one / (there + far));
        let range = length * start * (one + (near + far) / (here + there)) * end;
        // Beyond the foot κ (1/q − 1/q₁), before it κ h² (q − q₁) is the exponent.
        let beyond = start * (depth * start / depth.mul_add(start, sigma_t));
        let within = depth / (sigma_t * frame.height * frame.height).max(least);
        Self {
            sign,
            start,
            range: range.min(R::select(sign.lt(zero), within, beyond)),
            path: before + here,
        }
    }

    /// Growth of the path D + s from the start to q = `start` + `step`, length ≥ 0.
    pub(crate) fn growth(&self, frame: &Frame<R>, step: R, q: R) -> R {
        let beyond = -step / (self.start * q);
        R::select(
            self.sign.lt(self.sign.lit(0.0)),
            frame.height * frame.height * step,
            beyond,
        )
    }
}
