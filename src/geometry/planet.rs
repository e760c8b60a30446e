//! Altitudes above a sphere, and rays past it, where single precision has to tell metres apart
//! at the scale of a planet.
//!
//! With d = x − c, R the radius of the sphere and m the largest |dᵢ|, the altitude |d| − R is
//!
//!     h = ((m − R)(m + R) + Σ' dᵢ²)/(|d| + R)                             (1)
//!
//! where Σ' is over the two smaller components, and dᵢ counts with the part that the
//! subtraction x − c rounds away. With the origin of coordinates on the surface and an axis
//! through the centre, nothing large is left in (1): the error of h is a few ulps of h and of
//! the distance from that axis. Elsewhere it is a few ulps of R.
//!
//! Along a ray, r is the distance from the centre where the ray starts, x₁ = d · direction,
//! p = √(r² − x₁²) the distance of closest approach (at t = −x₁, the perigee), and
//!
//!     h(t) − h(0) = t (2 x₁ + t)/(r + r(t)),   r(t) = √(p² + (x₁ + t)²)   (2)
//!     h(0) − h_p  = x₁²/(r + p)                                          (3)
//!
//! The ray's line crosses the shell at the altitude h_s, of radius r_s, at
//!
//!     t = −x₁ ∓ X,   X = √((h_s − h_p)(r_s + p)),   t₋ t₊ = (h(0) − h_s)(r + r_s)   (4)
//!
//! (draft, Eq. 46–47, where X comes from a difference of squares). The sum of like signs gives one
//! of the roots, their product the other, so neither cancels.
//!
//! `tests/geometry.rs` states the errors.

use super::{Ray, Vector, dot, norm};
use crate::real::{Real, difference};

/// The surface that altitudes are counted from.
#[derive(Clone, Copy, Debug)]
pub struct Sphere<R> {
    /// Centre of the planet.
    pub center: Vector<R>,
    /// R, length > 0.
    pub radius: R,
}

/// A ray as the centre of a sphere sees it.
#[derive(Clone, Copy, Debug)]
pub struct Passage<R> {
    /// h, altitude of the start.
    pub altitude: R,
    /// r, distance of the start from the centre.
    pub radius: R,
    /// x₁: how far beyond the perigee the ray starts; negative if the perigee lies ahead.
    pub along: R,
    /// p, distance of the ray's line from the centre, at most r.
    pub perigee: R,
}

/// The parts of (1).
struct Offset<R> {
    /// d, rounded.
    vector: Vector<R>,
    /// |d|.
    radius: R,
    altitude: R,
    /// Sum of the absolute values of the terms of (1).
    size: R,
}

impl<R: Real> Sphere<R> {
    /// Altitude of `point`, length; −R in the centre.
    pub fn altitude(&self, point: Vector<R>) -> R {
        self.offset(point).altitude
    }

    fn offset(&self, point: Vector<R>) -> Offset<R> {
        let parts: [(R, R); 3] = std::array::from_fn(|i| difference(point[i], self.center[i]));
        let vector = parts.map(|(d, _)| d);
        let radius = norm(vector);
        let [a, b, c] = vector.map(Real::abs);
        let (low, high) = (a.min(b), a.max(b));
        let (large, middle, small) = (high.max(c), low.max(high.min(c)), low.min(c));

        let sum = radius + self.radius;
        let terms = [
            (large - self.radius) * ((large + self.radius) / sum),
            middle * (middle / sum),
            small * (small / sum),
        ];
        let rest = parts
            .iter()
            .fold(sum.lit(0.0), |rest, (d, lost)| rest + (*d / sum) * *lost);
        let size = terms.iter().fold(rest.abs(), |size, x| size + x.abs());
        Offset {
            vector,
            radius,
            altitude: terms[0] + ((terms[1] + terms[2]) + (rest + rest)),
            size,
        }
    }

    /// The ray as the centre sees it.
    pub fn passage(&self, ray: &Ray<R>) -> Passage<R> {
        let offset = self.offset(ray.origin);
        let (d, e) = (offset.vector, ray.direction);
        let cross = std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            d[j] * e[k] - d[k] * e[j]
        });
        Passage {
            altitude: offset.altitude,
            radius: offset.radius,
            along: dot(d, e),
            perigee: norm::<R, 3>(cross).min(offset.radius),
        }
    }

    /// Rounding error of the altitude of `point`, from its coordinates and from (1). Bounds
    /// are widened by it.
    fn rounding(point: Vector<R>, offset: &Offset<R>) -> R {
        let sum = point.iter().fold(offset.size, |sum, x| sum + x.abs());
        sum * sum.unit_roundoff() * sum.lit(8.0)
    }

    /// Lowest and highest altitude on a segment of length `t`, which may be infinite,
    /// rounding included.
    pub fn range(&self, ray: &Ray<R>, t: R) -> (R, R) {
        let passage = self.passage(ray);
        let error = Self::rounding(ray.origin, &self.offset(ray.origin));
        let further = |t: R| t * t.unit_roundoff() * t.lit(16.0) + error;

        let start = passage.altitude;
        let finite = t.is_bounded();
        let length = R::select(finite, t, t.lit(0.0));
        let end = start + passage.rise(length);
        let end = (end - further(length), end + further(length));

        let before = -passage.along;
        let turns = t.lit(0.0).lt(before) & before.le(t);
        let lowest = start - passage.depth() - further(before.abs());
        let low = R::select(turns, lowest, (start - error).min(end.0));
        let high = (start + error).max(end.1);
        let high = R::select(finite, high, t.lit(f64::INFINITY));
        (low.max(-self.radius), high)
    }

    /// Lowest and highest altitude in the box between the corners `lo` and `hi`, which may be
    /// infinite, rounding included.
    pub fn range_in_box(&self, lo: Vector<R>, hi: Vector<R>) -> (R, R) {
        let center = self.center;
        let near = std::array::from_fn(|i| center[i].max(lo[i]).min(hi[i]));
        let far = std::array::from_fn(|i| {
            let (below, above) = (center[i] - lo[i], hi[i] - center[i]);
            R::select(below.lt(above), hi[i], lo[i])
        });
        let of = |corner: Vector<R>| {
            let finite = (corner[0].abs() + corner[1].abs() + corner[2].abs()).is_bounded();
            let point = std::array::from_fn(|i| R::select(finite, corner[i], center[i]));
            let offset = self.offset(point);
            (finite, offset.altitude, Self::rounding(point, &offset))
        };
        let (_, low, error) = of(near);
        let low = (low - error).max(-self.radius);
        let (finite, high, error) = of(far);
        let high = R::select(finite, high + error, high.lit(f64::INFINITY));
        (low, high)
    }

    /// The distance at which the ray enters the planet, and infinity if it never does. From
    /// the surface or below it, a ray that leads down is in at once, one that leads up leaves.
    pub fn hit(&self, ray: &Ray<R>) -> R {
        let passage = self.passage(ray);
        let zero = self.radius.lit(0.0);
        let (inwards, _, crosses) = passage.crossings(zero);
        let hits = crosses & passage.along.lt(zero);
        R::select(hits, inwards.max(zero), zero.lit(f64::INFINITY))
    }

    /// Where the ray is below the shell at `altitude`: the distances of entrance, 0 if it
    /// starts there, and exit; infinite both if it never is.
    pub fn shell(&self, ray: &Ray<R>, altitude: R) -> (R, R) {
        let (inwards, outwards, crosses) = self.passage(ray).crossings(altitude);
        let (zero, infinity) = (altitude.lit(0.0), altitude.lit(f64::INFINITY));
        let meets = crosses & zero.le(outwards);
        let enter = R::select(meets, inwards.max(zero), infinity);
        (enter, R::select(meets, outwards, infinity))
    }

    /// μ of the horizon, −√(1 − R²/r²): rays from `point` that lead further down hit the
    /// planet. 0 on the surface, and below it, where there is no horizon.
    pub fn horizon(&self, point: Vector<R>) -> R {
        let altitude = self.altitude(point).max(self.radius.lit(0.0));
        let radius = self.radius + altitude;
        let height = altitude.max(altitude.lit(if altitude.digits() <= 24 {
            1e-37
        } else {
            1e-300
        }));
        -(height.sqrt() * ((radius + self.radius) / radius).sqrt()) / radius.sqrt()
    }

    /// The same sphere without derivatives.
    pub fn detach(&self) -> Self {
        Self {
            center: self.center.map(Real::detach),
            radius: self.radius.detach(),
        }
    }
}

impl<R: Real> Passage<R> {
    /// r(t), distance from the centre at the finite distance `t`.
    pub fn radius_at(&self, t: R) -> R {
        norm([self.perigee, self.along + t])
    }

    /// (2) for t ≥ 0, which may be infinite.
    pub fn rise(&self, t: R) -> R {
        let finite = t.is_bounded();
        let length = R::select(finite, t, t.lit(0.0));
        let sum = self.radius + self.radius_at(length);
        let some = t.lit(0.0).lt(sum);
        let slope = (self.along + self.along + length) / R::select(some, sum, t.lit(1.0));
        R::select(finite, length * slope, t.lit(f64::INFINITY))
    }

    /// (3): how far below the start the perigee lies, ahead or behind.
    pub fn depth(&self) -> R {
        let sum = self.radius + self.perigee;
        let some = sum.lit(0.0).lt(sum);
        let sum = R::select(some, sum, sum.lit(1.0));
        self.along * (self.along / sum)
    }
}

impl<R: Real> Passage<R> {
    /// (4): where the line crosses the shell at `altitude`, inwards and outwards; negative
    /// behind the start. The mask is set if it does.
    pub fn crossings(&self, altitude: R) -> (R, R, R::Mask) {
        let (zero, one) = (altitude.lit(0.0), altitude.lit(1.0));
        let gap = altitude - self.altitude;
        let shell = self.radius + gap;
        let above = gap + self.depth();
        let crosses = zero.le(above) & zero.le(shell);
        let half = above.max(zero).sqrt() * (shell + self.perigee).max(zero).sqrt();

        let behind = zero.le(self.along);
        let sum = self.along.abs() + half;
        let some = zero.lt(sum);
        let other = gap * ((self.radius + shell) / R::select(some, sum, one));
        let inwards = R::select(behind, -sum, -other);
        let outwards = R::select(behind, other, sum);
        (inwards, outwards, crosses)
    }
}

/// A piece of a ray that leads outwards, seen from its inner end.
#[derive(Clone, Copy, Debug)]
pub struct Piece<R> {
    /// Altitude of the inner end.
    pub altitude: R,
    /// Altitude of the outer end; may be infinite.
    pub outer: R,
    /// Distance of the inner end from the centre.
    pub radius: R,
    /// Distance of the inner end from the perigee, ≥ 0.
    pub along: R,
    /// Distance of the ray's line from the centre.
    pub perigee: R,
    /// How much higher the outer end is, ≥ 0; may be infinite.
    pub climb: R,
}

impl<R: Real> Passage<R> {
    /// The segment of length `t`, which may be infinite, in pieces that lead outwards: one, or two
    /// where the mask is set, for the segment passes its perigee.
    pub fn pieces(&self, t: R) -> (Piece<R>, Piece<R>, R::Mask) {
        let (zero, infinity) = (t.lit(0.0), t.lit(f64::INFINITY));
        let finite = t.is_bounded();
        let length = R::select(finite, t, zero);
        let end = self.along + length;
        let inwards = self.along.lt(zero);
        let turns = inwards & (zero.lt(end) | !finite);
        let falls = inwards & !turns;

        let (depth, rise, radius) = (self.depth(), self.rise(length), self.radius_at(length));
        let end_altitude = R::select(finite, self.altitude + rise, infinity);
        let pick = |at_perigee, at_end, at_start| {
            R::select(turns, at_perigee, R::select(falls, at_end, at_start))
        };
        let first = Piece {
            altitude: self.altitude + pick(-depth, rise, zero),
            outer: R::select(inwards, self.altitude, end_altitude),
            radius: pick(self.perigee, radius, self.radius),
            along: pick(zero, -end, self.along),
            perigee: self.perigee,
            climb: pick(depth, -rise, R::select(finite, rise, infinity)).max(zero),
        };
        let sum = radius + self.perigee;
        let some = zero.lt(sum);
        let above = end * (end / R::select(some, sum, t.lit(1.0)));
        let second = Piece {
            outer: end_altitude,
            climb: R::select(finite, above, infinity),
            ..first
        };
        (first, second, turns)
    }
}
