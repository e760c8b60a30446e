//! The segment of a ray in pieces: on one side of the foot, and between the kinks of the light.

use super::frame::Frame;
use super::light::{Intensity, Lit};
use crate::real::{Mask, Real};

/// Calls `add(sign, ends, length, way)` for every piece of the segment from `t0` to `t1`: −1 before the
/// foot or 1 beyond it, the ends as signed distances from the foot, the length, and the way from `t0`
/// to its beginning. Pieces that are empty in all lanes are left out.
pub(crate) fn pieces<R: Real>(
    frame: &Frame<R>,
    intensity: &Intensity<R>,
    t0: R,
    t1: R,
    mut add: impl FnMut(f64, [R; 2], R, R),
) {
    let zero = t0.lit(0.0);
    // A length, not a difference of distances from the foot, so that a short one is exact.
    let length = (t1.min(frame.far()) - t0).max(zero);
    let from = t0 + frame.start;
    let to = from + length;
    let Lit { first, last, kinks } = intensity.lit(frame, from, to);
    let foot = zero.max(first).min(last);
    // Whatever the light does not cut off keeps the exact ends.
    let way = |s: R| R::select(to.le(s), length, R::select(s.le(from), zero, s - from));
    let mut piece = |sign: f64, a: R, b: R| {
        let (before, after) = (way(a), way(b));
        if before.lt(after).any() {
            add(sign, [a, b], (after - before).max(zero), before);
        }
    };
    match kinks {
        None => {
            piece(-1.0, first, foot);
            piece(1.0, foot, last);
        }
        Some((begin, end)) => {
            let (low, high) = (begin.min(foot), end.min(foot));
            piece(-1.0, first, low);
            piece(-1.0, low, high);
            piece(-1.0, high, foot);
            let (low, high) = (begin.max(foot), end.max(foot));
            piece(1.0, foot, low);
            piece(1.0, low, high);
            piece(1.0, high, last);
        }
    }
}
