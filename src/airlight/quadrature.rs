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
struct Integral<'a, R, P> {
    air: &'a AirLight<R>,
    phase: &'a P,
    frame: Frame<R>,
    points: usize,
    /// The least σ_t, 1/length.
    sigma_t: R,
    sums: Vec<R>,
}

/// [`AirLight::radiance`] with the phase function `phase` in place of its own.
pub fn radiance<R: Real, P: PhaseFunction<R>>(
    air: &AirLight<R>,
    phase: &P,
    ray: &Ray<R>,
    t0: R,
    t1: R,
) -> Vec<R> {
    let points = if t0.digits() <= 24 { 24 } else { 48 };
    radiance_by(air, phase, ray, t0, t1, points)
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
    let zero = t0.lit(0.0);
    let frame = Frame::new(ray, &air.light);
    let first_sigma = *air.sigma_t.first().expect("there is a channel");
    let mut integral = Integral {
        air,
        phase,
        frame,
        points,
        sigma_t: air.sigma_t.iter().fold(first_sigma, |a, b| a.min(*b)),
        sums: vec![zero; air.sigma_t.len()],
    };
    let intensity = air.light.intensity;
    pieces(&frame, &intensity, t0, t1, |sign, ends, length, before| {
        integral.piece(zero.lit(sign), ends, length, before);
    });
    let scatter = |(sum, sigma): (R, &R)| sum * *sigma;
    integral
        .sums
        .into_iter()
        .zip(&air.sigma_s)
        .map(scatter)
        .collect()
}

impl<R: Real, P: PhaseFunction<R>> Integral<'_, R, P> {
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

    /// Adds one piece.
    fn piece(&mut self, sign: R, ends: [R; 2], length: R, before: R) {
        let frame = self.frame;
        let cut = (self.sigma_t, self.depth());
        let piece = Piece::new(&frame, sign, ends, length, before, cut);
        let stretch = Stretch::new(&piece, self.scale(&piece));
        let mut sums = vec![sign.lit(0.0); self.sums.len()];
        for chunk in rule(self.points).chunks_exact(CHUNK) {
            let chunk: &[(f64, f64); CHUNK] = chunk.try_into().expect("a multiple of 8 points");
            self.chunk(&piece, &stretch, chunk, &mut sums);
        }
        for (total, sum) in self.sums.iter_mut().zip(sums) {
            *total = *total + stretch.length * sum;
        }
    }

    fn chunk(
        &self,
        piece: &Piece<R>,
        stretch: &Stretch<R>,
        rule: &[(f64, f64); CHUNK],
        sums: &mut [R],
    ) {
        let frame = &self.frame;
        let height = frame.height;
        let zero = height.lit(0.0);
        let exp = R::exp_each(rule.map(|(x, _)| stretch.length * zero.lit(x)));
        let nodes: [(R, R); CHUNK] = std::array::from_fn(|k| {
            let (step, q, slope) = stretch.at(exp[k]);
            let point = Point::new(piece.sign, q, height);
            let value = self.air.light.intensity.value(&frame.toward(&point))
                * self.phase.value(point.deflection());
            let weight = zero.lit(2.0 * rule[k].1) * slope * point.norm;
            (weight * value, piece.path + piece.growth(frame, step, q))
        });
        for (sum, sigma) in sums.iter_mut().zip(&self.air.sigma_t) {
            let decay = R::exp_each(nodes.map(|(_, path)| -*sigma * path));
            *sum = (0..CHUNK).fold(*sum, |sum, k| nodes[k].0.mul_add(decay[k], sum));
        }
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

/// A radiance, and what it cost.
#[derive(Clone, Debug)]
pub struct Estimate<R> {
    /// As [`AirLight::radiance`].
    pub radiance: Vec<R>,
    /// Difference from the next smaller rule, the largest of all channels, relative.
    pub error: R,
    /// Points of each piece.
    pub points: usize,
}

/// The rules that [`radiance_within`] tries.
const RULES: [usize; 6] = [8, 16, 24, 32, 48, 64];

/// [`AirLight::radiance`] by the smallest rule whose difference from the one before is at most
/// `tolerance`, relative; by 64 points if none is.
///
/// For numbers that formulas may branch on: not for lanes or recorded nodes.
pub fn radiance_within<R: Real<Mask = bool>>(
    air: &AirLight<R>,
    ray: &Ray<R>,
    t0: R,
    t1: R,
    tolerance: R,
) -> Estimate<R> {
    let by = |points| radiance_by(air, &air.phase, ray, t0, t1, points);
    let zero = t0.lit(0.0);
    let mut radiance = by(RULES[0]);
    let mut error = zero;
    for points in RULES.into_iter().skip(1) {
        let better = by(points);
        let differences = better.iter().zip(&radiance).map(|(b, r)| {
            let difference = (*b - *r).abs();
            R::select(difference.le(zero), zero, difference / b.abs())
        });
        error = differences.fold(zero, R::max);
        radiance = better;
        if error.le(tolerance) {
            return Estimate {
                radiance,
                error,
                points,
            };
        }
    }
    let points = RULES[RULES.len() - 1];
    Estimate {
        radiance,
        error,
        points,
    }
}
