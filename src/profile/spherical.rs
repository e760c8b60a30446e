//! Exponential profile around a planet: spherical layers with scale height H.
//!
//!     ρ(h) = exp(−h/H),   h = |x − c| − R                            (article, Eq. 36)
//!     N(t) = H ρ(h_i) (A(p, a, Y) + A(p, 0, Y′))                      (1)
//!
//! A is the column of a piece that leads outwards, relative to the density ρ(h_i) at its inner
//! end, all in scale heights (see [`crate::special::arc`]). A ray that climbs is one piece; one
//! that descends is the same piece seen from its other end; one that passes its perigee is two
//! pieces that begin there. Heights come from differences that do not cancel
//! ([`crate::geometry::planet`]), so the shortest segment is as accurate as the infinite one, and
//! there is no switch between formulas. The article's difference of two Chapman functions is
//! wrong by up to 100 % for 10 m above Earth, in single precision.
//!
//! Its derivatives are made of further integrals over the same pieces, with the exponentials of
//! (1): ρ′/r = −ρ/(Hr) and ρ′ x/r = ∂ρ/∂s in (4) of [`super::gradient`], and
//!
//!     ∂N/∂R = N/H,   ∂N/∂H = ∫hρ ds/H²                                (3)
//!
//! The inverse is an iteration. It starts where g of A is taken for its value at the start,
//!
//!     N(t) ≈ H ρ(h₀) g(a) √π/2 (erfcx(√a) − e^(−Y) erfcx(√(a+Y)))     (2)
//!
//! which the closed approximation of [`crate::special::tail`] inverts: exact for short flights, and
//! within a few per cent where the ray bends through several scale heights.
//!
//! There is no ground: below R the density goes on growing, and where it leaves the number format
//! it is ∞, as is the column of a segment that touches such a point; a segment of length 0 has
//! the column 0. Segments within one scale height of the centre have an error relative to the
//! whole column there.

use super::exponential::between;
use super::gradient::{Gradient, Pull, around, at_end, to_perigee};
use super::layers::{self, Layers};
use super::{Parameter, Profile};
use crate::error::{self, Error};
use crate::geometry::planet::{Passage, Sphere};
use crate::geometry::{Ray, Vector};
use crate::real::{Real, either, either_each};
use crate::solve::{Bracket, Start};
use crate::special::arc::{Moments, arc, moments};
use crate::special::rel::psi;
use crate::special::tail;
use std::f64::consts::FRAC_2_SQRT_PI;

/// ρ(h) = exp(−`falloff` h), h the altitude above `sphere`.
#[derive(Clone, Copy, Debug)]
pub struct Spherical<R> {
    /// Where h = 0, ρ = 1.
    pub sphere: Sphere<R>,
    /// n = 1/H, 1/length.
    pub falloff: R,
}

pub(super) const PARAMETERS: &[Parameter] = &[
    Parameter::CENTER,
    Parameter::required("radius"),
    Parameter::required("scale_height"),
];

pub(super) fn check(values: &[f64]) -> Result<(), Error> {
    for value in &values[..3] {
        error::finite("center", *value)?;
    }
    error::positive("radius", values[3])?;
    error::positive("scale_height", values[4])?;
    Ok(())
}

pub(super) fn from_values<R: Real>(values: &[R]) -> Spherical<R> {
    Spherical {
        sphere: Sphere {
            center: [values[0], values[1], values[2]],
            radius: values[3],
        },
        falloff: values[4].lit(1.0) / values[4],
    }
}

impl<R: Real> Spherical<R> {
    /// ρ at an altitude, which may be infinite.
    fn at(&self, altitude: R) -> R {
        (-(altitude * self.falloff)).exp()
    }

    /// The pieces of the segment of length `t`.
    fn cut(&self, passage: &Passage<R>, t: R) -> Cut<R> {
        let (zero, infinity) = (t.lit(0.0), t.lit(f64::INFINITY));
        // From there on, nothing is left to gather.
        let far = t.lit(1e3) * (passage.radius + t.lit(1.0) / self.falloff);
        let finite = t.lt(far);
        let length = R::select(finite, t, zero);

        let rise = passage.rise(length);
        let end = passage.along + length;
        let above = height_above(passage.perigee, end, passage.radius_at(length));
        let (rise, above) = (
            R::select(finite, rise, infinity),
            R::select(finite, above, infinity),
        );
        let descends = passage.along.lt(zero);
        let turns = descends & (zero.lt(end) | !finite);
        let falls = descends & !turns;

        let depth = passage.depth();
        let drop = R::select(turns, depth, R::select(falls, -rise, zero)).max(zero);
        Cut {
            start: R::select(falls, above, R::select(turns, zero, depth)),
            range: R::select(turns, depth, rise.abs()),
            above: R::select(turns, above, zero),
            altitude: passage.altitude - drop,
            turns,
            falls,
        }
    }
}

/// A segment in pieces that lead outwards: one, or two where it `turns` at its perigee.
struct Cut<R: Real> {
    /// Height above the perigee of the inner end of the first piece, and how much the piece rises.
    start: R,
    range: R,
    /// How much the second piece rises from the perigee; 0 if there is none.
    above: R,
    /// Altitude of the inner end of both.
    altitude: R,
    turns: R::Mask,
    /// The one piece leads inwards.
    falls: R::Mask,
}

/// Height above the perigee at the distance `along` from it and `radius` from the centre.
fn height_above<R: Real>(perigee: R, along: R, radius: R) -> R {
    let sum = radius + perigee;
    let some = sum.lit(0.0).lt(sum);
    along * (along / R::select(some, sum, sum.lit(1.0)))
}

impl<R: Real> Layers<R> for Spherical<R> {
    fn sphere(&self) -> &Sphere<R> {
        &self.sphere
    }

    /// (1)
    fn column_of(&self, passage: &Passage<R>, t: R) -> R {
        let zero = t.lit(0.0);
        let cut = self.cut(passage, t);
        let n = self.falloff;
        let perigee = passage.perigee * n;
        let gathered = arc(perigee, cut.start * n, cut.range * n)
            + either(cut.turns, || arc(perigee, zero, cut.above * n), || zero);
        let inner = self.at(cut.altitude);
        let some = zero.lt(gathered);
        R::select(some, inner, zero) * R::select(some, gathered, zero) / n
    }

    fn slopes(&self, passage: &Passage<R>, t: R) -> (R, R) {
        let density = self.at(passage.altitude + passage.rise(t));
        let radius = passage.radius_at(t);
        let some = radius.lit(0.0).lt(radius);
        let mu = (passage.along + t) / R::select(some, radius, radius.lit(1.0));
        let rate = mu * self.falloff;
        (density, -(rate * density))
    }

    /// (2)
    fn start(&self, passage: &Passage<R>, column: R) -> Start<R> {
        let n = self.falloff;
        let (zero, one, two) = (n.lit(0.0), n.lit(1.0), n.lit(2.0));
        let (perigee, start) = (passage.perigee * n, passage.depth() * n);
        let x = start.sqrt();
        let (tiny, least) = if n.digits() <= 24 {
            (1e-30, 1.2e-38)
        } else {
            (1e-200, 2.3e-308)
        };
        let g = two * (start + perigee) / (start + two * perigee + n.lit(tiny)).sqrt();
        let amount = column * n / g.max(n.lit(tiny));

        // Amounts relative to the whole tail beyond the start.
        let altitude = passage.altitude * n;
        let density = (-altitude).exp();
        let vanishes = density.le(n.lit(least));
        let part = tail::steepness(x) * amount / R::select(vanishes, one, density);
        let descends = passage.along.lt(zero);

        // Ahead, the tail becomes thinner by what is gathered.
        let left = part.min(n.lit(0.9999));
        let climb = tail::outwards(x, left * psi(R::select(descends, zero, left)));

        // Towards the perigee it becomes thicker, and beyond it is thinner again.
        let before = tail::log_erfc(x);
        let large = vanishes | n.lit(1e6).lt(part);
        let modest = R::select(large, one, part);
        let from_far = (n.lit(FRAC_2_SQRT_PI) * amount.max(n.lit(least))).ln() + altitude - start;
        let increase = R::select(large, from_far - before, modest * psi(-modest)).max(zero);
        let sum = before + increase;
        let turns = descends & zero.lt(sum);
        let beyond = (two - R::select(turns, sum, zero).min(one).exp()).max(n.lit(1e-4));
        let past = tail::outwards(zero, -beyond.ln());
        let fall = tail::inwards(x, increase);

        let end = R::select(turns, past, R::select(descends, x - fall, x + climb));
        let step = R::select(descends, fall, climb);
        let height = |x: R| x * x + two * perigee;
        let (here, there) = (x * height(x).sqrt(), end * height(end).sqrt());
        let sum = (here + there).max(n.lit(tiny));
        let difference = step * (x + end) * (height(x) + end * end) / sum;
        let t = R::select(turns, sum, difference) / n;
        Start {
            bracket: Bracket {
                low: zero,
                high: n.lit(f64::INFINITY),
            },
            guess: R::select(t.is_bounded(), t, zero),
            near: true,
        }
    }
}

impl<R: Real> Profile<R> for Spherical<R> {
    /// (36)
    fn density(&self, point: Vector<R>) -> R {
        self.at(self.sphere.altitude(point))
    }

    fn density_along(&self, ray: &Ray<R>, t: R) -> (R, R) {
        self.slopes(&self.sphere.passage(ray), t)
    }

    /// (1)
    fn column(&self, ray: &Ray<R>, t: R) -> R {
        self.column_of(&self.sphere.passage(ray), t)
    }

    /// (1), (3), and (4) of [`super::gradient`].
    fn column_value_and_gradient(&self, ray: &Ray<R>, t: R) -> (R, Gradient<R>) {
        let passage = self.sphere.passage(ray);
        let cut = self.cut(&passage, t);
        let (zero, n) = (t.lit(0.0), self.falloff);
        let perigee = passage.perigee * n;
        let first = moments(perigee, cut.start * n, cut.range * n);
        let second = either_each(
            cut.turns,
            || moments(perigee, zero, cut.above * n),
            || [zero; 6],
        );

        // The inner ends of both pieces lie here; the first leads back from there.
        let from = R::select(
            cut.turns,
            -passage.along,
            R::select(cut.falls, at_end(t, |t| t), zero),
        ) * n;
        let inwards = cut.turns | cut.falls;
        let back = |x: R| R::select(inwards, -x, x);
        let [column, height, inverse, lever, fall, fall_lever] = first;
        let first = [
            column,
            height,
            inverse,
            from * inverse + back(lever),
            back(fall),
            back(from * fall) + fall_lever,
        ];
        let [column, height, inverse, lever, fall, fall_lever] = second;
        let second = [
            column,
            height,
            inverse,
            from * inverse + lever,
            fall,
            from * fall + fall_lever,
        ];
        let sums: Moments<R> = std::array::from_fn(|k| first[k] + second[k]);
        let [column, height, inverse, lever, fall, fall_lever] = sums;

        let inner = R::select(zero.lt(column), self.at(cut.altitude), zero);
        let height = cut.altitude * n * column + height;
        let value = inner * column / n;
        let pull = Pull {
            across: [-(inner * inverse * n), -(inner * lever)],
            along: [-(inner * fall), -(inner * fall_lever / n)],
        };
        let by_ray = pull.by_ray(to_perigee(self.sphere.center, ray), ray.direction);
        let last = at_end(t, |t| self.at(passage.altitude + passage.rise(t)));
        around(value, by_ray, &[inner * column, inner * height], last)
    }

    /// (1), inverted by iteration from (2).
    fn inv_column(&self, ray: &Ray<R>, column: R) -> R {
        layers::inv_column(self, ray, column, |column, total| {
            column.le(total) & column.is_bounded()
        })
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
        between(self.falloff, self.sphere.range(ray, t))
    }

    fn bounds_in_box(&self, lo: Vector<R>, hi: Vector<R>) -> (R, R) {
        between(self.falloff, self.sphere.range_in_box(lo, hi))
    }

    fn detach(&self) -> Self {
        Self {
            sphere: self.sphere.detach(),
            falloff: self.falloff.detach(),
        }
    }
}
