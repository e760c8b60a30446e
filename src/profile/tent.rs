//! Tent profile: a layer around a planet whose density rises and falls linearly, like ozone.
//!
//!     ρ(h) = max(0, 1 − |h − h_c|/w),   h = |x − c| − R                   (1)
//!
//! A column consists of pieces that lead outwards through one flank of the tent. Over a piece
//! of length s that climbs from r₁ to r₂ = r₁ + Δ and starts x₁ ≥ 0 beyond the perigee p,
//!
//!     ∫ (r − r₁) ds = sΔ/2 − p² u³ (1/(1 − u²) − L(u)),   u = s/(r₁ + r₂),  (2)
//!     L(u) = (artanh u − u)/u³ = 1/3 + u²/5 + u⁴/7 + …,
//!     1 − u² = 2 (r₁(r₁ + r₂) + x₁ s)/(r₁ + r₂)²
//!
//! in which the difference is at least a third of the first term; 2 artanh u is the difference
//! of the two asinh(x/p) of the textbook form, whose large terms (2) has without. Lengths come
//! from climbs, s = Δ(r₁ + r₂)/(x₁ + √(x₁² + Δ(r₁ + r₂))).
//!
//! Its derivatives are lengths and angles of these parts, for ρ′ = ±1/w in (4) of
//! [`super::gradient`]: with the distance δ from the start of a part,
//!
//!     ∫ ds/r = 2 artanh u,   ∫ δ ds/r = u (s − 2 x₁ u² L(u))              (3)
//!     ∂N/∂R = ∂N/∂h_c = (S₊ − S₋)/w,   ∂N/∂w = (S₊ + S₋ − N)/w            (4)
//!
//! S₋ and S₊ being the lengths below and above h_c.
//!
//! The inverse is not closed: the bracketed iteration of `solve` finds it between the two distances of those at
//! which the ray crosses the edges and the top of the layer, from the parabola through them.
//!
//! Relative error of the column, times the condition of (h − h_c)/w: below 1e-15 (f64),
//! 6e-7 (f32).

use super::gradient::{Gradient, Pull, around, at_end, to_perigee};
use super::layers::{self, Layers};
use super::{Parameter, Profile};
use crate::error::{self, Error};
use crate::geometry::planet::{Passage, Piece, Sphere};
use crate::geometry::{Ray, Vector};
use crate::real::{Real, either, polynomial};
use crate::solve::{Bracket, Start};

/// ρ(h) = max(0, 1 − |h − `height`|/`width`), h the altitude above `sphere`.
#[derive(Clone, Copy, Debug)]
pub struct Tent<R> {
    /// Where h = 0.
    pub sphere: Sphere<R>,
    /// h_c, altitude at which ρ = 1.
    pub height: R,
    /// w, length: half the thickness of the layer.
    pub width: R,
}

pub(super) const PARAMETERS: &[Parameter] = &[
    Parameter::CENTER,
    Parameter::required("radius"),
    Parameter::required("height"),
    Parameter::required("width"),
];

pub(super) fn check(values: &[f64]) -> Result<(), Error> {
    error::finite_vector("center", [values[0], values[1], values[2]])?;
    error::positive("radius", values[3])?;
    error::finite("height", values[4])?;
    error::positive("width", values[5])?;
    Ok(())
}

pub(super) fn from_values<R: Real>(values: &[R]) -> Tent<R> {
    Tent {
        sphere: Sphere {
            center: [values[0], values[1], values[2]],
            radius: values[3],
        },
        height: values[4],
        width: values[5],
    }
}

/// The part of a piece between two altitudes.
struct Part<R> {
    /// s
    length: R,
    /// ∫ (r − r₁) ds, by (2).
    bend: R,
    /// Δ
    climb: R,
    /// x₁
    along: R,
    /// Distance of its start from that of the piece.
    offset: R,
    /// u and L(u).
    u: R,
    rest: R,
}

impl<R: Real> Part<R> {
    /// The part between the altitudes `low` and `high`; `joins` another part at `low`.
    fn of(piece: &Piece<R>, low: R, high: R, joins: bool) -> Self {
        let (zero, one) = (low.lit(0.0), low.lit(1.0));
        let least = low.lit(if low.digits() <= 24 { 1e-37 } else { 1e-300 });
        let root = |square: R| square.max(least).sqrt();
        // Altitudes round by more than a short climb measures: its parts must add up to it.
        let from = (low - piece.altitude).max(zero);
        let below = piece.outer.le(high);
        let whole = below & low.le(piece.altitude);
        let short = if joins {
            below & piece.climb.lt(high - low)
        } else {
            whole
        };
        let clipped = (piece.outer.min(high) - piece.altitude.max(low)).min(piece.climb);
        let climb = R::select(whole | short, piece.climb - from, clipped);
        let some = zero.lt(climb) & low.lt(piece.outer);
        let climb = R::select(some, climb, zero);
        let inner = R::select(some, piece.radius, one);
        let along = R::select(some, piece.along, one);
        let perigee = R::select(some, piece.perigee, zero);
        let from = R::select(some, from, zero);

        let r1 = inner + from;
        let before = from * (inner + r1);
        let x1 = root(along.mul_add(along, before));
        let sum = r1 + r1 + climb;
        let square = climb * sum;
        let s = square / (x1 + root(x1.mul_add(x1, square)));

        let u = (s / sum).min(one);
        let rest = r1.mul_add(sum, x1 * s) * ((one + one) / (sum * sum));
        let rest = rest.max(least);
        let artanh = artanh_rest(u, rest);
        let bent = (perigee * u) * (perigee * u) * (u * (one / rest - artanh));
        Self {
            length: s,
            bend: (from.lit(0.5) * s * climb - bent).max(zero),
            climb,
            along: x1,
            offset: before / (along + x1),
            u,
            rest: artanh,
        }
    }

    /// (3)
    fn angles(&self) -> [R; 2] {
        let two = self.u.lit(2.0);
        let bent = self.u * self.u * self.rest;
        let angle = two * (self.u + self.u * bent);
        let lever = self.u * (self.length - two * self.along * bent);
        [angle, lever]
    }

    /// ∫ρ′/r ds, ∫s ρ′/r ds, ∫ρ′ x/r ds and ∫s ρ′ x/r ds times w/ρ′, where the piece starts at
    /// the distance `from` and leads back where `inwards`.
    fn pull(&self, from: R, inwards: R::Mask) -> [R; 4] {
        let back = |x: R| R::select(inwards, -x, x);
        let start = from + back(self.offset);
        let [angle, lever] = self.angles();
        let fall = self.length * self.climb - self.bend;
        [
            angle,
            start * angle + back(lever),
            back(self.climb),
            start * back(self.climb) + fall,
        ]
    }
}

/// L(u) of (2), where `rest` = 1 − u².
fn artanh_rest<R: Real>(u: R, rest: R) -> R {
    /// 1/(2k + 3): the first one left out is below a quarter of the roundoff.
    const SERIES: [f64; 25] = {
        let mut c = [0.0; 25];
        let mut k = 0;
        while k < c.len() {
            c[k] = 1.0 / (2.0 * k as f64 + 3.0);
            k += 1;
        }
        c
    };
    let (half, one) = (u.lit(0.5), u.lit(1.0));
    let small = u.lt(half);
    let terms = if u.digits() <= 24 { 11 } else { 25 };
    either(
        small,
        || {
            let near = R::select(small, u, half);
            polynomial(near * near, &SERIES[..terms])
        },
        || {
            let far = R::select(small, half, u);
            let rest = R::select(small, one, rest);
            let sum = one + far;
            (half * (sum * (sum / rest)).ln() - far) / (far * (far * far))
        },
    )
}

impl<R: Real> Tent<R> {
    /// (1)
    fn at(&self, altitude: R) -> R {
        let one = altitude.lit(1.0);
        (one - (altitude - self.height).abs() / self.width).max(altitude.lit(0.0))
    }

    /// Infimum and supremum between two altitudes; the higher one may be infinite.
    fn between(&self, (low, high): (R, R)) -> (R, R) {
        let (zero, one) = (low.lit(0.0), low.lit(1.0));
        let widen = |altitude: R| {
            let size = one + (altitude.abs() + self.height.abs()) / self.width;
            size * one.unit_roundoff() * one.lit(4.0)
        };
        let endless = !high.is_bounded();
        let high = R::select(endless, self.height + self.width, high).max(low);
        let densest = self.height.max(low).min(high);
        let sup = self.at(densest);
        let sup = R::select(zero.lt(sup), sup + widen(densest), zero);
        let inf = (self.at(low) - widen(low)).min(self.at(high) - widen(high));
        (R::select(endless, zero, inf.max(zero)), sup)
    }

    /// The parts of a piece that leads outwards, below and above the peak, and their columns.
    fn parts(&self, piece: &Piece<R>) -> [(Part<R>, R); 2] {
        let (zero, one) = (piece.altitude.lit(0.0), piece.altitude.lit(1.0));
        let (bottom, top) = (self.height - self.width, self.height + self.width);

        let below = Part::of(piece, bottom, self.height, false);
        let start = (piece.altitude - bottom).max(zero) / self.width;
        let lower = start * below.length + below.bend / self.width;

        let above = Part::of(piece, self.height, top, true);
        let start = one - (piece.altitude - self.height).max(zero) / self.width;
        let upper = start * above.length - above.bend / self.width;
        [(below, lower), (above, upper.max(zero))]
    }

    /// The column of a piece that leads outwards.
    fn gathered(&self, piece: &Piece<R>) -> R {
        let [(_, lower), (_, upper)] = self.parts(piece);
        lower + upper
    }
}

impl<R: Real> Layers<R> for Tent<R> {
    fn sphere(&self) -> &Sphere<R> {
        &self.sphere
    }

    fn column_of(&self, passage: &Passage<R>, t: R) -> R {
        let (first, second, turns) = passage.pieces(t);
        let second = either(turns, || self.gathered(&second), || t.lit(0.0));
        self.gathered(&first) + R::select(turns, second, t.lit(0.0))
    }

    fn slopes(&self, passage: &Passage<R>, t: R) -> (R, R) {
        let (zero, one) = (t.lit(0.0), t.lit(1.0));
        let altitude = passage.altitude + passage.rise(t);
        let radius = passage.radius_at(t);
        let some = zero.lt(radius);
        let mu = (passage.along + t) / R::select(some, radius, one);
        let density = self.at(altitude);
        let slope = R::select(altitude.lt(self.height), mu, -mu) / self.width;
        (density, R::select(zero.lt(density), slope, zero))
    }

    /// Between which of the distances where the ray crosses the edges and the top of the layer it
    /// gathers `goal`, and where on the parabola between them.
    fn start(&self, passage: &Passage<R>, goal: R) -> Start<R> {
        let (zero, one) = (goal.lit(0.0), goal.lit(1.0));
        let edges = [-self.width, zero, self.width].map(|w| self.height + w);
        let [low, top, high] = edges.map(|altitude| passage.crossings(altitude));
        let inwards = [high.0, top.0, low.0];
        let outwards = [low.1, top.1, high.1];
        let reached = [high.2, top.2, low.2, low.2, top.2, high.2];

        let mut bracket = Bracket {
            low: zero,
            high: goal.lit(f64::INFINITY),
        };
        let (mut before, mut after) = (zero, goal + goal);
        for (t, known) in inwards.into_iter().chain(outwards).zip(reached) {
            let ahead = known & zero.lt(t) & t.is_bounded();
            let t = R::select(ahead, t, zero);
            let gathered = self.column_of(passage, t);
            let short = gathered.lt(goal);
            let raise = ahead & short & bracket.low.lt(t);
            let lower = ahead & !short & t.lt(bracket.high);
            before = R::select(raise, gathered, before);
            after = R::select(lower, gathered, after);
            bracket.low = R::select(raise, t, bracket.low);
            bracket.high = R::select(lower, t, bracket.high);
        }
        let bounded = bracket.high.is_bounded();
        let high = R::select(bounded, bracket.high, bracket.low + one);
        let span = (high - bracket.low).max(one.lit(1e-30));
        // N(s) = a s + b s², from the density where it begins and the column of the whole.
        let density = self.slopes(passage, bracket.low).0;
        let curve = ((after - before) / span - density) / span;
        let missing = goal - before;
        let radicand = density
            .mul_add(density, one.lit(4.0) * curve * missing)
            .max(zero);
        let sum = (density + radicand.sqrt()).max(one.lit(1e-30));
        let guess = bracket.low + (missing + missing) / sum;
        Start {
            bracket,
            guess: guess.min(high).max(bracket.low),
            near: true,
        }
    }
}

impl<R: Real> Profile<R> for Tent<R> {
    /// (1)
    fn density(&self, point: Vector<R>) -> R {
        self.at(self.sphere.altitude(point))
    }

    fn density_along(&self, ray: &Ray<R>, t: R) -> (R, R) {
        self.slopes(&self.sphere.passage(ray), t)
    }

    fn column(&self, ray: &Ray<R>, t: R) -> R {
        self.column_of(&self.sphere.passage(ray), t)
    }

    /// (4), and (4) of [`super::gradient`].
    fn column_value_and_gradient(&self, ray: &Ray<R>, t: R) -> (R, Gradient<R>) {
        let passage = self.sphere.passage(ray);
        let (first, second, turns) = passage.pieces(t);
        let (zero, one) = (t.lit(0.0), t.lit(1.0));
        let inwards = passage.along.lt(zero);
        // The inner ends of both pieces lie here; the first leads back from there.
        let from = R::select(
            turns,
            -passage.along,
            R::select(inwards, at_end(t, |t| t), zero),
        );
        let (mut value, mut rising, mut falling) = (zero, zero, zero);
        let mut pull = [zero; 4];
        for (piece, exists, inwards) in [
            (first, !turns | turns, inwards),
            (second, turns, !turns & turns),
        ] {
            let [(below, lower), (above, upper)] = self.parts(&piece);
            let add = |sum: &mut R, x: R| *sum = *sum + R::select(exists, x, zero);
            add(&mut value, lower + upper);
            add(&mut rising, below.length);
            add(&mut falling, above.length);
            let (below, above) = (below.pull(from, inwards), above.pull(from, inwards));
            for (sum, (below, above)) in pull.iter_mut().zip(below.into_iter().zip(above)) {
                add(sum, below - above);
            }
        }
        let slope = one / self.width;
        let [across, across_lever, along, along_lever] = pull.map(|x| x * slope);
        let pull = Pull {
            across: [across, across_lever],
            along: [along, along_lever],
        };
        let by_ray = pull.by_ray(to_perigee(self.sphere.center, ray), ray.direction);
        let higher = (falling - rising) * slope;
        let wider = (rising + falling - value) * slope;
        let last = at_end(t, |t| self.slopes(&passage, t).0);
        around(value, by_ray, &[higher, higher, wider], last)
    }

    fn inv_column(&self, ray: &Ray<R>, column: R) -> R {
        layers::inv_column(self, ray, column, |column, total| column.lt(total))
    }

    fn inv_reached_column(&self, ray: &Ray<R>, column: R) -> R {
        layers::inv_reached_column(self, ray, column)
    }

    fn guess_inv_column(&self, ray: &Ray<R>, column: R) -> R {
        self.start(&self.sphere.passage(ray), column).guess
    }

    fn closed_inverse(&self) -> bool {
        false
    }

    fn bounds(&self, ray: &Ray<R>, t: R) -> (R, R) {
        self.between(self.sphere.range(ray, t))
    }

    fn bounds_in_box(&self, lo: Vector<R>, hi: Vector<R>) -> (R, R) {
        self.between(self.sphere.range_in_box(lo, hi))
    }

    fn detach(&self) -> Self {
        Self {
            sphere: self.sphere.detach(),
            height: self.height.detach(),
            width: self.width.detach(),
        }
    }
}
