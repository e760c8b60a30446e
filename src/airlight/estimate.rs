//! The error of air-light, and how many points reach a tolerance.
//!
//! The n points of a Gauss rule know more of the integrand than its integral: its coefficients in
//! Legendre polynomials up to the degree n − 1,
//!
//!     a_j = √(2j + 1) Σ_k w_k f(x_k) P_j(2x_k − 1).
//!
//! With A the larger of |a_(n−1)|, |a_(n−2)| and B that of the two before, the coefficients fall by A/B
//! in two degrees, where they are. A rule of m points errs in what lies at and above the degree 2m, and
//! until there the decay slows down: half of it is counted on,
//!
//!     error of m points ≈ A (A/B)^(m/2 − n/4).                                          (1)
//!
//! m = n is an estimate of the error, any other m a forecast: one small rule says how large the next
//! one has to be. `tests/airlight_methods.rs` counts how often (1) is below the error.
//! Source: null rules, Berntsen and Espelid (1991), *Error estimation in automatic quadrature routines*;
//! that (1) continues their decay is derived here.

use super::AirLight;
use super::closed_form;
use super::light::power;
use super::quadrature::{Integral, usual_points};
use crate::geometry::Ray;
use crate::real::{Mask, Real};
use crate::special::gauss_legendre::highest;

/// A radiance, its error and its cost.
#[derive(Clone, Debug)]
pub struct Estimate<R> {
    /// As [`AirLight::radiance`].
    pub radiance: Vec<R>,
    /// Estimate of its relative error in every channel.
    pub error: Vec<R>,
    /// Points of each piece that were evaluated, of all rules together; 0 for the closed form.
    pub points: usize,
}

/// What is left of a relative error when the radiance is 0 as well.
pub(crate) fn relative<R: Real>(error: R, radiance: R) -> R {
    let zero = error.lit(0.0);
    let size = radiance.abs();
    let dark = size.le(zero);
    let ratio = error / R::select(dark, error.lit(1.0), size);
    R::select(dark, zero, ratio)
}

/// Coefficients of one piece and channel at the end of their decay.
#[derive(Clone, Copy, Debug)]
struct Decay<R> {
    /// A, of the same unit as the integral.
    last: R,
    /// A/B ≤ 1.
    ratio: R,
}

impl<R: Real> Decay<R> {
    fn new(coefficients: [R; 4]) -> Self {
        let [a, b, c, d] = coefficients.map(R::abs);
        let (last, before) = (a.max(b), c.max(d));
        let some = last.lit(0.0).lt(before);
        let ratio = last.min(before) / R::select(some, before, last.lit(1.0));
        Self { last, ratio }
    }
}

/// A radiance by one rule, and what its points say about larger ones.
struct Trial<R> {
    points: usize,
    radiance: Vec<R>,
    /// Of every channel, of every piece, with σ_s.
    decays: Vec<Vec<Decay<R>>>,
}

impl<R: Real> Trial<R> {
    fn new(air: &AirLight<R>, ray: &Ray<R>, t0: R, t1: R, points: usize) -> Self {
        let zero = t0.lit(0.0);
        let integral = Integral::new(air, &air.phase, ray, points);
        let mut totals = vec![zero; air.sigma_t.len()];
        let mut decays = vec![Vec::new(); totals.len()];
        let polynomials = highest(points);
        integral.pieces(t0, t1, |piece| {
            let mut sums = vec![(zero, [zero; 4]); totals.len()];
            let length = integral.terms(piece, |channel, first, terms| {
                let (sum, coefficients) = &mut sums[channel];
                for (k, (a, b)) in terms.into_iter().enumerate() {
                    let term = a * b;
                    *sum = *sum + term;
                    for (c, p) in coefficients.iter_mut().zip(polynomials[first + k]) {
                        *c = term.mul_add(zero.lit(p), *c);
                    }
                }
            });
            for (channel, (sum, coefficients)) in sums.into_iter().enumerate() {
                totals[channel] = totals[channel] + length * sum;
                let scale = length * air.sigma_s[channel];
                decays[channel].push(Decay::new(coefficients.map(|c| scale * c)));
            }
        });
        let radiance = air.scattered(totals);
        Self {
            points,
            radiance,
            decays,
        }
    }

    /// Relative error of `points` in every channel (1).
    fn error(&self, points: usize) -> Vec<R> {
        let steps = (points / 2 - self.points / 4) as u32;
        let error = |(decays, radiance): (&Vec<Decay<R>>, &R)| {
            let sum = decays.iter().fold(radiance.lit(0.0), |sum, decay| {
                decay.last.mul_add(power(decay.ratio, steps), sum)
            });
            relative(sum, *radiance)
        };
        self.decays.iter().zip(&self.radiance).map(error).collect()
    }

    /// Whether `points` are known to be enough, in all channels and lanes.
    fn reaches(&self, points: usize, tolerance: R) -> bool {
        let within = |error: R| !(!error.le(tolerance)).any();
        self.error(points).into_iter().all(within)
    }

    fn estimate(self, points: usize) -> Estimate<R> {
        Estimate {
            error: self.error(self.points),
            radiance: self.radiance,
            points,
        }
    }
}

/// The rules that [`AirLight::radiance_within`] chooses from.
const RULES: [usize; 6] = [8, 16, 24, 32, 48, 64];

impl<R: Real> AirLight<R> {
    /// [`AirLight::radiance`] by quadrature with `points` on each side of the foot and of each edge of
    /// the light, one of 8, 16, … 64, and an estimate of its error.
    pub fn radiance_estimated(&self, ray: &Ray<R>, t0: R, t1: R, points: usize) -> Estimate<R> {
        Trial::new(self, ray, t0, t1, points).estimate(points)
    }

    /// [`AirLight::radiance`] at the least cost that keeps the relative error `tolerance`, as far as
    /// (1) knows.
    ///
    /// In closed form where that is exact; else by the rule that the coefficients of 8 points ask for,
    /// and a larger one should its own coefficients disagree. At most 64 points, in single precision
    /// 24. All lanes take what the worst of them needs. A recording cannot choose: it takes as many
    /// points as [`AirLight::radiance`], whatever the tolerance.
    pub fn radiance_within(&self, ray: &Ray<R>, t0: R, t1: R, tolerance: R) -> Estimate<R> {
        let trial = |points| Trial::new(self, ray, t0, t1, points);
        let recorded = t0.lt(t0).any();
        if recorded {
            let points = usual_points(t0);
            return trial(points).estimate(points);
        }
        if let Some(radiance) = closed_form::isotropic(self, ray, t0, t1) {
            return Estimate {
                error: vec![t0.lit(closed_form::EXACT); radiance.len()],
                radiance,
                points: 0,
            };
        }
        let most = if t0.digits() <= 24 {
            2
        } else {
            RULES.len() - 1
        };
        let (mut index, mut spent) = (0, 0);
        loop {
            let trial = trial(RULES[index]);
            spent += RULES[index];
            let enough = (index..most).find(|i| trial.reaches(RULES[*i], tolerance));
            let next = enough.unwrap_or(most);
            if next == index {
                return trial.estimate(spent);
            }
            index = next;
        }
    }
}
