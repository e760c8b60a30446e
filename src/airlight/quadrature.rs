//! Air-light by quadrature: Gauss–Legendre of fixed order on each side of the foot.
//!
//! Towards small q the integrand has a peak of the phase function (poles at hq = ±i (1 − g)/(1 + g)
//! for Henyey–Greenstein) and, beyond the foot, the layer q ~ κ_t in which e^(−κ_t/q) sets in. With
//!
//!     q = b sinh t,   b = min(peak/h, κ_t),
//!
//! both are spread over lengths of order 1 in t, whatever g and H. Channels share the points, and all
//! but the exponential.

use super::AirLight;
use super::frame::{Frame, Point};
use super::phase::PhaseFunction;
use super::piece::Piece;
use super::segment::pieces;
use crate::geometry::Ray;
use crate::real::Real;
use crate::special::gauss_legendre::rule;
use crate::special::rel::psi;

/// Points that are evaluated together, for [`Real::exp_each`].
const CHUNK: usize = 8;

/// What all pieces have in common.
pub(crate) struct Integral<'a, R, P> {
    air: &'a AirLight<R>,
    phase: &'a P,
    frame: Frame<R>,
    points: usize,
    /// The least σ_t, 1/length.
    sigma_t: R,
}

/// Points on each side of the foot and of each edge of the light that serve all of the table.
pub(crate) fn usual_points<R: Real>(like: R) -> usize {
    if like.digits() <= 24 { 24 } else { 48 }
}

/// [`AirLight::radiance`] with the phase function `phase` in place of its own.
pub fn radiance<R: Real, P: PhaseFunction<R>>(
    air: &AirLight<R>,
    phase: &P,
    ray: &Ray<R>,
    t0: R,
    t1: R,
) -> Vec<R> {
    radiance_by(air, phase, ray, t0, t1, usual_points(t0))
}

/// The same with `points` on each side of the foot and of each edge of the light, a multiple of 8.
pub fn radiance_by<R: Real, P: PhaseFunction<R>>(
    air: &AirLight<R>,
    phase: &P,
    ray: &Ray<R>,
    t0: R,
    t1: R,
    points: usize,
) -> Vec<R> {
    let integral = Integral::new(air, phase, ray, points);
    let mut totals = vec![t0.lit(0.0); air.sigma_t.len()];
    integral.pieces(t0, t1, |piece| {
        let mut sums = vec![t0.lit(0.0); totals.len()];
        let length = integral.terms(piece, |channel, _, terms| {
            let sum = &mut sums[channel];
            *sum = terms.iter().fold(*sum, |sum, (a, b)| a.mul_add(*b, sum));
        });
        for (total, sum) in totals.iter_mut().zip(sums) {
            *total = *total + length * sum;
        }
    });
    air.scattered(totals)
}

impl<'a, R: Real, P: PhaseFunction<R>> Integral<'a, R, P> {
    /// By `points` for each piece.
    pub fn new(air: &'a AirLight<R>, phase: &'a P, ray: &Ray<R>, points: usize) -> Self {
        let first_sigma = *air.sigma_t.first().expect("there is a channel");
        Self {
            air,
            phase,
            frame: Frame::new(ray, &air.light),
            points,
            sigma_t: air.sigma_t.iter().fold(first_sigma, |a, b| a.min(*b)),
        }
    }

    /// Calls `add` for each piece of the segment from `t0` to `t1`.
    pub fn pieces(&self, t0: R, t1: R, mut add: impl FnMut(&Piece<R>)) {
        let cut = (self.sigma_t, self.depth());
        let intensity = &self.air.light.intensity;
        pieces(&self.frame, intensity, t0, t1, |sign, ends, length, way| {
            let sign = t0.lit(sign);
            add(&Piece::new(&self.frame, sign, ends, length, way, cut));
        });
    }

    /// Optical depth beyond which nothing counts, even where a light begins with cosᵖ.
    fn depth(&self) -> f64 {
        let exponent = f64::from(self.air.light.intensity.exponent());
        let rounding = if self.sigma_t.digits() <= 24 {
            17.0
        } else {
            37.0
        };
        rounding + 1.5 * exponent
    }

    /// Calls `add(channel, k, terms)` for the points k, k + 1, … of the rule, 8 at a time: pairs whose
    /// products are the terms of its sum. Returns what the sum has to be multiplied with.
    pub fn terms(&self, piece: &Piece<R>, mut add: impl FnMut(usize, usize, [(R, R); CHUNK])) -> R {
        let stretch = Stretch::new(piece, self.scale(piece));
        for (chunk, rule) in rule(self.points).chunks_exact(CHUNK).enumerate() {
            let rule: &[(f64, f64); CHUNK] = rule.try_into().expect("a multiple of 8 points");
            let nodes = self.nodes(piece, &stretch, rule);
            for (channel, sigma) in self.air.sigma_t.iter().enumerate() {
                let decay = R::exp_each(nodes.map(|(_, path)| -*sigma * path));
                let term = |k: usize| (nodes[k].0, decay[k]);
                add(channel, chunk * CHUNK, std::array::from_fn(term));
            }
        }
        stretch.length
    }

    /// Weight times phase function and intensity, and the way that light has come.
    fn nodes(
        &self,
        piece: &Piece<R>,
        stretch: &Stretch<R>,
        rule: &[(f64, f64); CHUNK],
    ) -> [(R, R); CHUNK] {
        let frame = &self.frame;
        let height = frame.height;
        let zero = height.lit(0.0);
        let exp = R::exp_each(rule.map(|(x, _)| stretch.length * zero.lit(x)));
        std::array::from_fn(|k| {
            let (step, q, slope) = stretch.at(exp[k]);
            let point = Point::new(piece.sign, q, height);
            let value = self.air.light.intensity.value(&frame.toward(&point))
                * self.phase.value(point.deflection());
            let weight = zero.lit(2.0 * rule[k].1) * slope * point.norm;
            (weight * value, piece.path + piece.growth(frame, step, q))
        })
    }

    /// b: the least q at which something happens, 1/length.
    fn scale(&self, piece: &Piece<R>) -> R {
        let before = piece.sign.lt(piece.sign.lit(0.0));
        let largest = R::select(before, piece.start + piece.range, piece.start);
        let [forward, backward] = self.phase.peaks(largest);
        let peak = R::select(before, forward, backward) / self.frame.height;
        let layer = self.sigma_t.max(largest.lit(1e-5) * largest);
        let layer = R::select(before, largest, layer);
        peak.min(layer).min(largest)
    }
}

/// q = b sinh t from the end of a piece with the smaller q: there, nothing may cancel.
struct Stretch<R> {
    /// Length in t.
    length: R,
    /// The smaller q, 1/length.
    least: R,
    /// √(b² + q²) there.
    cosh: R,
    /// `least` minus q where the piece begins.
    offset: R,
}

impl<R: Real> Stretch<R> {
    fn new(piece: &Piece<R>, scale: R) -> Self {
        let (zero, one) = (scale.lit(0.0), scale.lit(1.0));
        let before = piece.sign.lt(zero);
        let offset = R::select(before, zero, -piece.range);
        let least = (piece.start + offset).max(zero);
        let most = R::select(before, piece.start + piece.range, piece.start);
        let cosh = |q: R| q.mul_add(q, scale * scale).sqrt();
        // sinh(t₂ − t₁) by the addition theorem, over its own cancellation.
        let product = most.mul_add(cosh(least), least * cosh(most));
        let sinh = piece.range * (most + least) / product;
        let grown = sinh * sinh / (one + sinh.mul_add(sinh, one).sqrt()) + sinh;
        Self {
            length: grown * psi(-grown),
            cosh: cosh(least),
            least,
            offset,
        }
    }

    /// Step from where the piece begins, q, and dq/dt where t has grown by the logarithm of `exp`.
    fn at(&self, exp: R) -> (R, R, R) {
        let (half, one) = (exp.lit(0.5), exp.lit(1.0));
        let inverse = one / exp;
        let less = exp - one;
        let rise = half * less * less * inverse;
        let sinh = half * less * (one + inverse);
        let grown = self.least.mul_add(rise, self.cosh * sinh);
        let slope = self.least.mul_add(sinh, self.cosh * (one + rise));
        (self.offset + grown, self.least + grown, slope)
    }
}
