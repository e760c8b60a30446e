//! The density of a Gaussian along a ray, its integral, and the inverse of that.
//!
//!     ρ(s) = e^(−E(s)),   E(s) = E_p + κ² (x + s)²                        (1)
//!     N(t) = ∫₀ᵗ ρ ds                                                     (2)
//!     ∫₀ᴸ e^(−E(s)) ds = ρ(0) ∫₀ᴸ e^(−κs (2κx + κs)) ds,  x ≥ 0           (3)
//!
//! The ray starts x beyond its perigee, the point of highest density (before it, if x < 0).
//! (3) is the Gauss–Legendre rule of [`super::gauss_legendre`], up to where the integrand is
//! below rounding: nothing cancels, be the segment short, far out in the tail or infinite. A ray
//! that leads outwards is (3), one that leads inwards is (3) from its other end, one that passes
//! its perigee is two of them.
//!
//! The inverse starts from erfc, in logarithms so that tails do not vanish. With y = κ|x|, and
//! T = ∫ ρ ds/ρ(0) the tail that lies outwards of the start,
//!
//!     ln erfc(y₁) = ln erfc(y) + ln(1 ∓ N/(ρ(0) T)),   κt = ±(y₁ − y)     (4)
//!
//! upper signs outwards. Steps that are exact for exponentials,
//! s = Δ/ρ ψ(−ρ′Δ/ρ²) with Δ what is missing, polish it.
//!
//! | function | relative error f64, f32 |
//! |---|---|
//! | [`Bell::column`], times 1 + E(0) | 2e-14, 3e-7 |
//! | N(N⁻¹(c)), times 1 + E(0) | 2e-14, 5e-7 |
//! | [`Bell::guess`], 99.9 % of all columns | 6e-3; 1e-4 on average |
//!
//! `tests/gaussian.rs` asserts them.

use super::gauss_legendre::{integrate, integrate_each};
use super::rel::psi;
use crate::geometry::{Vector, dot, norm};
use crate::real::{Real, either, either_each, polynomial};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_2_SQRT_PI};

/// Integrals along a segment; distances are multiplied by κ.
#[derive(Clone, Copy, Debug)]
pub struct Moments<R> {
    /// ∫ρ ds, the column.
    pub column: R,
    /// ∫E ρ ds.
    pub exponent: R,
    /// κ ∫s ρ ds.
    pub distance: R,
    /// κ ∫(x + s) ρ ds and κ² ∫s (x + s) ρ ds.
    pub along: [R; 2],
    /// ρ at the end.
    pub density: R,
}

/// (1).
#[derive(Clone, Copy, Debug)]
pub struct Bell<R> {
    /// x, length: how far beyond the perigee the ray starts; negative if the perigee is ahead.
    pub along: R,
    /// κ, 1/length, > 0.
    pub rate: R,
    /// E(0).
    pub exponent: R,
    /// E_p, at most E(0).
    pub least: R,
}

/// A segment as pieces that lead away from the perigee.
struct Sides<R: Real> {
    /// Begins before the perigee.
    inwards: R::Mask,
    /// Begins before it, and ends behind it: there are two pieces.
    turns: R::Mask,
    /// Ends before it: the piece leads back.
    falls: R::Mask,
    /// Where the first piece begins, from the perigee.
    near: R,
    /// Its length.
    length: R,
    /// The length of the second piece, from the perigee.
    beyond: R,
}

impl<R: Real> Bell<R> {
    /// The standard Gaussian e^(−|d + s e|²/2).
    pub fn standard(d: Vector<R>, e: Vector<R>) -> Self {
        let half = e[0].lit(0.5);
        let speed = norm(e);
        let unit = e.map(|x| x / speed);
        let cross = std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            d[j] * unit[k] - d[k] * unit[j]
        });
        let distance: R = norm::<R, 3>(cross);
        let exponent = half * dot(d, d);
        Self {
            along: dot(d, unit) / speed,
            rate: speed * half.lit(FRAC_1_SQRT_2),
            exponent,
            least: (half * distance * distance).min(exponent),
        }
    }

    /// E at the finite distance `t`, counted from the start or from the perigee: from where
    /// the exponent is smaller.
    fn exponent_at(&self, t: R) -> R {
        let here = self.exponent.abs().le(self.least.abs());
        let from = R::select(here, self.exponent, self.least);
        let before = R::select(here, self.along, t.lit(0.0));
        let moved = R::select(here, t, self.along + t);
        let gained = (self.rate * moved) * (self.rate * (before + before + moved));
        (from + gained).max(self.least)
    }

    /// Density at the finite distance `t`, and its derivative by `t`.
    pub fn density_along(&self, t: R) -> (R, R) {
        let density = (-self.exponent_at(t)).exp();
        let rate = self.rate * (self.rate * (self.along + t));
        let some = t.lit(0.0).lt(density);
        let change = R::select(some, rate, t.lit(0.0)) * density;
        (density, -(change + change))
    }

    /// The length beyond which (3) has nothing left to gather.
    fn reach(&self, near: R) -> R {
        let cutoff = near.lit(if near.digits() <= 24 { 17.0 } else { 37.0 });
        let start = near * self.rate;
        let last = cutoff / (start + start.mul_add(start, cutoff).sqrt());
        let endless = near.lit(if near.digits() <= 24 { 1e37 } else { 1e300 });
        (last / self.rate).min(endless)
    }

    /// (3) over ρ(0): outwards from `near` ≥ 0 beyond the perigee, over a length that may be
    /// infinite.
    fn outwards(&self, near: R, length: R) -> R {
        let start = near * self.rate;
        integrate(
            length.min(self.reach(near)),
            |s| {
                let x = s * self.rate;
                x * (start + start + x)
            },
            |s| s.lit(1.0),
        )
    }

    /// The two sides of the perigee, for a segment of the length `t`.
    fn sides(&self, t: R) -> Sides<R> {
        let zero = t.lit(0.0);
        let end = self.along + t;
        let inwards = self.along.lt(zero);
        let turns = inwards & zero.lt(end);
        let falls = inwards & !turns;
        Sides {
            inwards,
            turns,
            falls,
            near: R::select(falls, -end, R::select(turns, zero, self.along)),
            length: R::select(turns, -self.along, t),
            beyond: R::select(turns, end, zero),
        }
    }

    /// (2); t may be infinite.
    pub fn column(&self, t: R) -> R {
        let zero = t.lit(0.0);
        let Sides {
            turns,
            falls,
            near,
            length,
            beyond,
            ..
        } = self.sides(t);
        let gathered =
            self.outwards(near, length) + either(turns, || self.outwards(zero, beyond), || zero);

        let arrival = self.exponent_at(R::select(falls, t, zero));
        let inner = R::select(turns, self.least, arrival);
        // Where the density overflows, a segment without length still has no column.
        let some = zero.lt(gathered);
        R::select(some, (-inner).exp(), zero) * gathered
    }

    /// (2) and its moments, with the exponentials of (2); t may be infinite.
    pub fn moments(&self, t: R) -> Moments<R> {
        let zero = t.lit(0.0);
        let Sides {
            inwards,
            turns,
            falls,
            near,
            length,
            beyond,
        } = self.sides(t);
        // The inner ends of both pieces lie here; the first leads back from there.
        let from = R::select(turns, -self.along, R::select(falls, t, zero)) * self.rate;
        let first = self.outward_moments(near, length);
        let second = either_each(turns, || self.outward_moments(zero, beyond), || [zero; 5]);

        let [column, gained, distance, along, along_distance] = first;
        let back = |x: R| R::select(inwards, -x, x);
        let [
            more,
            more_gained,
            more_distance,
            more_along,
            more_along_distance,
        ] = second;
        let sums = [
            column + more,
            gained + more_gained,
            from * column + back(distance) + (from * more + more_distance),
            back(along) + more_along,
            back(from * along) + along_distance + (from * more_along + more_along_distance),
        ];

        let finite = t.is_bounded();
        let last = self.exponent_at(R::select(finite, t, zero));
        let inner = R::select(turns, self.least, R::select(falls, last, self.exponent));
        // Where the density overflows, a segment without length still has no column.
        let some = zero.lt(sums[0]);
        let density = R::select(some, (-inner).exp(), zero);
        let [column, gained, distance, along, along_distance] = sums.map(|x| density * x);
        let inner = R::select(zero.lt(column), inner, zero);
        Moments {
            column,
            exponent: inner * column + gained,
            distance,
            along: [along, along_distance],
            density: R::select(finite, (-last).exp(), zero),
        }
    }

    /// As [`Bell::outwards`], and the same with these factors: the exponent gained, the
    /// distance δ from the inner end, that from the perigee, and δ times that; times κ.
    fn outward_moments(&self, near: R, length: R) -> [R; 5] {
        let start = near * self.rate;
        integrate_each(
            length.min(self.reach(near)),
            |s| {
                let x = s * self.rate;
                x * (start + start + x)
            },
            |s| {
                let x = s * self.rate;
                let along = start + x;
                [s.lit(1.0), x * (start + along), x, along, x * along]
            },
        )
    }

    /// A fast estimate of the distance at which the ray has gathered `column` ≥ 0; beyond all
    /// matter if it never does. Not an iteration, and without quadrature.
    pub fn guess(&self, column: R) -> R {
        self.estimate(column, erfcx_fast(self.height(self.along)))
    }

    /// y = κ|x|, so that erfc(y) is finite in logarithms.
    fn height(&self, along: R) -> R {
        (along.abs() * self.rate).min(along.lit(1e15))
    }

    /// (4), where `erfcx` is e^(y²) erfc(y): T = erfcx √π/(2κ).
    fn estimate(&self, column: R, erfcx: R) -> R {
        let (zero, one, two) = (column.lit(0.0), column.lit(1.0), column.lit(2.0));
        let some = zero.lt(column) & column.is_bounded();
        let column = R::select(some, column, one);
        let inwards = self.along.lt(zero);
        let y = self.height(self.along);
        let own = erfcx.ln() - y * y;

        // N in the unit of erfc at the start, and of erfc itself.
        let scaled = (column * self.rate * column.lit(FRAC_2_SQRT_PI)).ln();
        let share = (scaled - erfcx.ln() + self.exponent).min(zero);
        let rest = (one - share.exp()).max(one.unit_roundoff());
        let added = scaled + self.least;
        let sum = own.max(added) + (one + (-(own - added).abs()).exp()).ln();
        let end = -R::select(inwards, sum, own + rest.ln());

        // Beyond the perigee, erfc counts from the other side.
        let across = end.lt(zero);
        let other = two - R::select(across, -end, zero).min(one).exp();
        let end = R::select(across, -other.max(one.unit_roundoff()).ln(), end);
        let y1 = inverse_fast(end.max(zero));
        let y1 = R::select(across, -y1, y1);
        // Near by, the errors of two estimates cancel.
        let near = y1.lt(y + y) & y.lt(y1 + y1);
        let start = R::select(near, inverse_fast(-own), y);
        let far = R::select(inwards, start - y1, y1 - start).max(zero) / self.rate;

        // Next to the start, where (4) cancels, an exponential.
        let (density, change) = self.density_along(zero);
        let dense = zero.lt(density) & density.is_bounded();
        let density = R::select(dense, density, one);
        let straight = column / density;
        let bend = -(change / density) * straight;
        let modelled = dense & bend.lt(one.lit(0.9)) & one.lit(-1e6).lt(bend);
        let near = straight * psi(R::select(modelled, bend, zero));
        let short = modelled & (near * self.rate).lt(one.lit(0.05));
        R::select(some, R::select(short, near, far), zero)
    }

    /// The smallest t with N(t) = `column`; infinite if there is none.
    pub fn inv_column(&self, column: R) -> R {
        let (zero, one, infinity) = (column.lit(0.0), column.lit(1.0), column.lit(f64::INFINITY));
        let plain = self.detach();
        let total = plain.column(infinity);
        let some = zero.lt(column);
        let reached = some & column.lt(total);

        let goal = R::select(reached, column, total.min(one) * column.lit(0.5)).detach();
        let tail = plain.outwards(plain.along.abs(), infinity);
        let erfcx = (tail * plain.rate * tail.lit(FRAC_2_SQRT_PI)).max(tail.lit(1e-30));
        let last = plain.reach(plain.along.max(zero)) + (-plain.along).max(zero);
        let steps = if column.digits() <= 24 { 1 } else { 2 };
        let mut t = plain.estimate(goal, erfcx).min(last);
        for _ in 0..steps {
            t = (t + plain.step(t, goal - plain.column(t)))
                .max(zero)
                .min(last);
        }
        // One more step carries the derivatives of the parameters, by the implicit function
        // theorem. Where hardly anything is left to gather, it is noise.
        let missing = R::select(reached, column, goal) - self.column(t);
        let step = plain.step(t, missing);
        let fine = step.detach().abs().le(t * t.lit(0.01));
        let t = t + R::select(fine, step, step - step.detach());
        R::select(reached, t, R::select(some, infinity, zero))
    }

    /// How much further than `t` the ray gathers `missing`, for an exponential.
    fn step(&self, t: R, missing: R) -> R {
        let (zero, one) = (t.lit(0.0), t.lit(1.0));
        let (density, change) = self.density_along(t);
        let dense = zero.lt(density) & density.is_bounded();
        let density = R::select(dense, density, one);
        let straight = R::select(dense, missing, zero) / density;
        let bend = -(change / density) * straight;
        straight * psi(bend.min(t.lit(0.9)).max(t.lit(-1e6)))
    }

    /// The same without derivatives.
    pub fn detach(&self) -> Self {
        Self {
            along: self.along.detach(),
            rate: self.rate.detach(),
            exponent: self.exponent.detach(),
            least: self.least.detach(),
        }
    }
}

/// The least and the greatest distance from the centre, rounding included.
#[derive(Clone, Copy, Debug)]
pub struct Distances<R> {
    near: R,
    far: R,
}

impl<R: Real> Distances<R> {
    fn widened(near: (R, R), far: (R, R)) -> Self {
        let error = |size: R| {
            let error = size * size.unit_roundoff() * size.lit(8.0);
            R::select(error.is_bounded(), error, size.lit(0.0))
        };
        Self {
            near: (near.0 - error(near.1)).max(near.0.lit(0.0)),
            far: far.0 + error(far.1),
        }
    }
}

/// Distances of the points d + s e, 0 ≤ s ≤ t ≤ ∞, in standard deviations. `magnitude` is what
/// the coordinates amounted to that d was computed from.
pub fn on_segment<R: Real>(d: Vector<R>, e: Vector<R>, t: R, magnitude: Vector<R>) -> Distances<R> {
    let zero = t.lit(0.0);
    let (speed, start) = (norm(e), norm(d));
    let bell = Bell::standard(d, e);
    let finite = t.is_bounded();
    let length = R::select(finite, t, zero);
    let end = norm(std::array::from_fn::<R, 3, _>(|i| {
        length.mul_add(e[i], d[i])
    }));
    let size = magnitude.iter().fold(zero, |sum, x| sum + *x) + start;

    let before = -bell.along;
    let turns = zero.lt(before) & before.lt(t);
    let perigee = bell.least.max(zero).sqrt() * zero.lit(std::f64::consts::SQRT_2);
    let near = R::select(turns, perigee, start.min(R::select(finite, end, start)));
    let far = R::select(finite, start.max(end), zero.lit(f64::INFINITY));
    Distances::widened((near, size), (far, size + length * speed))
}

/// Distances of the points between the corners `lo` and `hi`, which may be infinite, in
/// standard deviations; `center` likewise, in absolute values.
pub fn in_box<R: Real>(lo: Vector<R>, hi: Vector<R>, center: Vector<R>) -> Distances<R> {
    let zero = lo[0].lit(0.0);
    let near: Vector<R> = std::array::from_fn(|i| lo[i].max(-hi[i]).max(zero));
    let far: Vector<R> = std::array::from_fn(|i| lo[i].abs().max(hi[i].abs()));
    let sum = |x: Vector<R>| x[0] + x[1] + x[2];
    let center = sum(center) + sum(center);
    let endless = !sum(far).is_bounded();
    let bounded = far.map(|x| R::select(endless, zero, x));
    let farthest = R::select(endless, zero.lit(f64::INFINITY), norm(bounded));
    let size = (sum(near) + center, sum(bounded) + center);
    Distances::widened((norm(near), size.0), (farthest, size.1))
}

/// Infimum and supremum of e^(−r²/2) between two distances.
pub fn between<R: Real>(distances: Distances<R>) -> (R, R) {
    let one = distances.near.lit(1.0);
    let at = |r: R| {
        let exponent = r * (r * one.lit(0.5));
        let error = (exponent + one) * one.unit_roundoff() * one.lit(4.0);
        (
            (-exponent).exp(),
            R::select(exponent.is_bounded(), error, one),
        )
    };
    let (inf, low) = at(distances.far);
    let (sup, high) = at(distances.near);
    (inf * (one - low).max(one.lit(0.0)), sup * (one + high))
}

/// e^(x²) erfc(x) for x ≥ 0, to 4e-5: x → 1/(1 + 0.7 x) times a polynomial in it, which has
/// the right value at 0 and the right limit at ∞; the least greatest relative error.
fn erfcx_fast<R: Real>(x: R) -> R {
    const FIT: [f64; 6] = [
        0.35 * FRAC_2_SQRT_PI,
        0.395355641,
        0.284761624,
        0.211931355,
        -0.44793723,
        0.160955901,
    ];
    let t = x.lit(1.0) / x.mul_add(x.lit(0.7), x.lit(1.0));
    t * polynomial(t, &FIT)
}

/// The y ≥ 0 with −ln erfc(y) = `logarithm` ≥ 0, to 1.1e-4: √`logarithm` times a rational
/// function of it that is right at 0 and at ∞, fitted like the other.
fn inverse_fast<R: Real>(logarithm: R) -> R {
    const TOP: [f64; 5] = [
        0.0,
        1.0 / FRAC_2_SQRT_PI,
        1.40905289,
        1.27225908,
        0.27885195,
    ];
    const BOTTOM: [f64; 5] = [1.0, 1.59340701, 1.89151387, 1.27728694, 0.27885195];
    let w = logarithm.max(logarithm.lit(1e-30)).sqrt();
    let x = w.min(w.lit(1e6));
    w * (polynomial(x, &TOP) / polynomial(x, &BOTTOM))
}
