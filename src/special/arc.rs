//! What columns around a planet and the Chapman function are made of: a piece of a ray that
//! leads outwards.
//!
//! Lengths are in scale heights: r is the distance from the centre, p that of the perigee, where
//! the ray's line is closest to the centre. A piece of a ray that leads outwards, from r₀ = p + a
//! over the heights y = 0 … Y, has the column
//!
//!     A(p, a, Y) = ∫ e^(−y) ds = ∫_√a^√(a+Y) e^(a − x²) g(x²) dx,
//!     g(w) = 2 (w + p)/√(w + 2p)                                          (1)
//!
//! relative to the density at its inner end; [`super::decay`] evaluates it. g is singular at
//! w = −2p only, so that one rule serves all p ≥ 1, from the horizontal to the vertical. Rays
//! that pass the centre at p < 1 have a core, r ≤ 1, with the column
//!
//!     ∫ e^(−r) ds = Σ (−1)ⁿ/n! Mₙ,   Mₙ = ∫ rⁿ ds = (s rⁿ + n p² Mₙ₋₂)/(n + 1)   (2)
//!
//! s being the distance from the perigee, M₀ = s and M₁ = (s r + p² artanh(s/r))/2; beyond it
//! they have (1) from r₀ = 1. Short pieces of a core, Y ≤ (a + 2p)/4, have (1) as well.
//!
//! The derivatives of columns are made of further integrals of e^(−y), which have the
//! exponentials of (1) in common: with the factors y, 1/r (g without w + p, since ds = g d√w),
//! and with the distance δ from the inner end, which is y (w + a + 2p) over the sum of the two
//! distances from the perigee.

use super::decay::{decay, decay_each};
use super::rel::phi;
use crate::real::{Real, either, either_each};

/// Integrals over the piece of (1), relative to the density at its inner end, in scale heights:
///
///     ∫e^(−y) ds,  ∫y e^(−y) ds,  ∫e^(−y)/r ds,  ∫δ e^(−y)/r ds,  ∫e^(−y) dy,  ∫δ e^(−y) dy
pub type Moments<R> = [R; 6];

/// A(p, a, Y) of (1): `perigee` = p ≥ 0, `start` = a ≥ 0 and the `range` Y ≥ 0 in scale
/// heights; Y may be infinite. p and a may be as large as the format holds.
pub fn arc<R: Real>(perigee: R, start: R, range: R) -> R {
    let zero = perigee.lit(0.0);
    let Cut {
        perigee,
        core,
        cuts,
        begin,
        skipped,
    } = Cut::new(perigee, start, range);
    let (half, quarter) = (perigee * perigee.lit(0.5), perigee.lit(0.25));
    let outside = decay(root(begin), range - skipped, |w| {
        (w + perigee) / w.mul_add(quarter, half).sqrt()
    });
    let inside = |perigee: R| {
        let end = R::select(cuts, (start + range).min(core), zero);
        let start = R::select(cuts, start, zero);
        let column = series(perigee, end) - series(perigee, start);
        (perigee + start).exp() * column.max(zero)
    };
    either(
        cuts,
        || inside(R::select(cuts, perigee, zero)) + (-skipped).exp() * outside,
        || outside,
    )
}

/// Where the series (2) takes over from the quadrature.
struct Cut<R: Real> {
    /// p, not quite 0: g is 0/0 at the centre itself.
    perigee: R,
    /// Height of the core, in which there is the series.
    core: R,
    /// Whether the piece begins in the core, and the quadrature at its edge.
    cuts: R::Mask,
    /// Where the quadrature begins.
    begin: R,
    /// How much of the range lies before that.
    skipped: R,
}

impl<R: Real> Cut<R> {
    fn new(perigee: R, start: R, range: R) -> Self {
        let least = if perigee.digits() <= 24 {
            1e-37
        } else {
            1e-300
        };
        let perigee = perigee.max(perigee.lit(least));
        let core = perigee.lit(1.0) - perigee;
        // A piece that is short beside its distance from the singularity needs no series.
        let long = (start + perigee + perigee).lt(range * range.lit(4.0));
        let cuts = start.lt(core) & long;
        let begin = R::select(cuts, core, start);
        Self {
            perigee,
            core,
            cuts,
            begin,
            skipped: (begin - start).min(range),
        }
    }
}

/// A(p, a, Y) of [`arc`], and what its derivatives are made of.
pub fn moments<R: Real>(perigee: R, start: R, range: R) -> Moments<R> {
    let zero = perigee.lit(0.0);
    let Cut {
        perigee,
        core,
        cuts,
        begin,
        skipped,
    } = Cut::new(perigee, start, range);
    let outside = outer_moments(perigee, begin, range - skipped);
    either_each(
        cuts,
        || {
            let perigee = R::select(cuts, perigee, perigee.lit(0.5));
            let end = R::select(cuts, (start + range).min(core), zero);
            let start = R::select(cuts, start, zero);
            let (inside, length) = core_moments(perigee, start, end);
            join(inside, skipped, length, outside)
        },
        || outside,
    )
}

/// The moments of two pieces, the first of which rises by `range` over `length`.
fn join<R: Real>(first: Moments<R>, range: R, length: R, second: Moments<R>) -> Moments<R> {
    let [column, height, inverse, lever, fall, fall_lever] = second;
    let moved = [
        column,
        height + range * column,
        inverse,
        lever + length * inverse,
        fall,
        fall_lever + length * fall,
    ];
    let decay = (-range).exp();
    std::array::from_fn(|k| first[k] + decay * moved[k])
}

/// (1) from the height `begin` above the perigee.
fn outer_moments<R: Real>(perigee: R, begin: R, range: R) -> Moments<R> {
    let two = perigee.lit(2.0);
    let diameter = perigee + perigee;
    let start = root(begin);
    let from = start * (begin + diameter).sqrt();
    decay_each(start, range, |x, gained| {
        let height = x * x;
        let chord = (height + diameter).sqrt();
        let inverse = two / chord;
        let ds = (height + perigee) * inverse;
        let fall = x + x;
        let sum = x.mul_add(chord, from);
        let some = sum.lit(0.0).lt(sum);
        let sum = R::select(some, sum, sum.lit(1.0));
        let distance = gained * ((height + begin + diameter) / sum);
        [
            ds,
            gained * ds,
            inverse,
            distance * inverse,
            fall,
            distance * fall,
        ]
    })
}

/// (2) between two heights above the perigee p < 1, and the length of the piece.
fn core_moments<R: Real>(perigee: R, start: R, end: R) -> (Moments<R>, R) {
    let (low, high) = (series_moments(perigee, start), series_moments(perigee, end));
    let inner = perigee + start;
    let scale = inner.exp();
    let [inverse, column, radius] =
        [0, 1, 2].map(|k| scale * (high.0[k] - low.0[k]).max(perigee.lit(0.0)));
    let range = (end - start).max(perigee.lit(0.0));
    let fall = range * phi(range);
    let length = high.1 - low.1;
    let moments = [
        column,
        radius - inner * column,
        inverse,
        fall - low.1 * inverse,
        fall,
        column - length * (-range).exp(),
    ];
    (moments, length)
}

/// ∫e^(−r) rʲ ds for j = −1, 0, 1 from the perigee p < 1 to the height `height` above it, by
/// (2), and the distance s.
fn series_moments<R: Real>(perigee: R, height: R) -> ([R; 3], R) {
    let (zero, one) = (perigee.lit(0.0), perigee.lit(1.0));
    let square = perigee * perigee;
    let radius = perigee + height;
    let distance = root(height * (radius + perigee));

    // M₋₁ and M₀, then (2).
    let mut moments = (((radius + distance) / perigee).max(one).ln(), distance);
    let mut sums = [moments.0 - moments.1, moments.1, zero];
    let mut power = one;
    // (−1)ⁿ⁻¹/(n − 1)!, of the moment Mₙ in the last sum.
    let mut factor = 1.0;
    let terms = if perigee.digits() <= 24 { 11 } else { 19 };
    for n in 1..terms {
        let degree = f64::from(n);
        power = power * radius;
        let moment = (distance * power + square * moments.0 * perigee.lit(degree))
            * perigee.lit(1.0 / (degree + 1.0));
        let own = -factor / degree;
        let next = -own / (degree + 1.0);
        for (sum, factor) in sums.iter_mut().zip([next, own, factor]) {
            *sum = *sum + moment * perigee.lit(factor);
        }
        factor = own;
        moments = (moments.1, moment);
    }
    (sums, distance)
}

/// √x for x ≥ 0, whose derivative at 0, where that of √x is infinite, is 0: pieces that begin at
/// the perigee do so whatever the parameters are. (A ray whose origin happens to be its perigee
/// loses the derivative of that piece by the origin.)
fn root<R: Real>(x: R) -> R {
    let zero = x.lit(0.0);
    let some = zero.lt(x);
    R::select(some, R::select(some, x, x.lit(1.0)).sqrt(), zero)
}

/// (2) from the perigee p < 1 to the height `height` above it, p + height ≤ 1.
fn series<R: Real>(perigee: R, height: R) -> R {
    let one = perigee.lit(1.0);
    let square = perigee * perigee;
    let radius = perigee + height;
    let distance = root(height * (radius + perigee));

    // p² artanh(s/r) = p² ln((r + s)/p); nothing through the centre.
    let some = perigee.lit(0.0).lt(square);
    let sum = (radius + distance) / R::select(some, perigee, one);
    let area = R::select(some, square * sum.max(one).ln(), perigee.lit(0.0));

    let mut moments = (distance, (distance * radius + area) * perigee.lit(0.5));
    let mut sum = moments.0 - moments.1;
    let mut power = radius;
    let mut factor = -1.0;
    let terms = if perigee.digits() <= 24 { 11 } else { 19 };
    for n in 2..terms {
        power = power * radius;
        factor /= -f64::from(n);
        let degree = f64::from(n);
        let moment = (distance * power + square * moments.0 * perigee.lit(degree))
            * perigee.lit(1.0 / (degree + 1.0));
        sum = sum + moment * perigee.lit(factor);
        moments = (moments.1, moment);
    }
    sum
}
