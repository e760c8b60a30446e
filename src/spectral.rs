//! Several wavelengths on one path: which event a null collision is, and what a path counts.
//!
//! Null collisions (article, Eq. 68–74). Flights are drawn against a scalar majorant σ̄, and a
//! collision is an absorption, a scattering, or null, with the coefficients
//!
//!     σ_n = σ̄ − σ_a − σ_s                                                             (68)
//!     w_e = σ_e / (σ̄ P_e),  e ∈ {a, s, n}: what multiplies the path weights            (72)
//!     P_e = m_e / (m_a + m_s + m_n),  m_e = max_i |σ_e,i|, Σ_i |σ_e,i|, Σ_i |w_i σ_e,i|  (73)
//!     absorption as a weight: m_a = 0, w_a = 0                                          (74)
//!
//! The third m, by the path weights so far, keeps their sum from growing (Kutz et al., 2017,
//! *Spectral and Decomposition Tracking*); by the first two, weights have no bound.
//!
//! Spectral multiple importance sampling (Eq. 61–66). The path ρ is drawn for a hero wavelength,
//! the wavelength k with the probability q_k, and counts for all n:
//!
//!     F = 1/n Σ_i [f_i(ρ) / p(λ_i)] / Σ_k q_k p(ρ|λ_k) = 1/n Σ_i [f_i / (p(λ_i) p(ρ|λ_i))] w_i
//!     w_i = p(ρ|λ_i) / Σ_k q_k p(ρ|λ_k),   Σ_i q_i w_i = 1
//!
//! The article's (61) and (62) put the density p(λ_k) of each wavelength in the sum, which is right
//! only if all are equal. p(λ_i) divides f_i, and nothing else.
//!
//! `docs/spectral.md` has both as an integrator uses them.

use crate::real::Real;
use smallvec::SmallVec;

/// A number per wavelength: few, so that they need no allocation.
pub type Spectrum<R> = SmallVec<[R; 4]>;

/// What the probability of an event is in proportion to (73).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventRule {
    /// The largest coefficient of all wavelengths.
    Maximum,
    /// The mean coefficient.
    Average,
    /// The mean of the coefficients, each weighted by the path weight so far.
    History,
}

/// What becomes of absorption.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Absorption {
    /// It is an event, at which a path ends (73).
    Sampled,
    /// It is in the weights of the other events (74). Right where nothing is emitted.
    Weighted,
}

/// A collision in flight against a majorant.
#[derive(Clone, Copy, Debug)]
pub struct Collision<'a, R> {
    /// σ_a per wavelength, 1/length, ≥ 0.
    pub sigma_a: &'a [R],
    /// σ_s per wavelength, 1/length, ≥ 0.
    pub sigma_s: &'a [R],
    /// σ̄, 1/length, ≥ 0: the same for all wavelengths. Where it is below σ_a + σ_s, σ_n is
    /// negative, and so are weights.
    pub majorant: R,
    /// Path weight per wavelength, of either sign; for [`EventRule::History`].
    pub path_weights: &'a [R],
}

/// Absorption, scattering and null collision.
#[derive(Clone, Debug)]
pub struct Events<R> {
    /// Probability of each event.
    pub probabilities: [R; 3],
    /// What each event multiplies the path weights by, per wavelength.
    pub weights: [Spectrum<R>; 3],
}

/// Probabilities (73, 74) and weights (72) of the events at a collision.
///
/// Probabilities sum to 1. One is 0 only where no wavelength has both the coefficient and, by
/// [`EventRule::History`], a path weight; the weights of such an event are 0. Weights are limited
/// to ±1e150, in single precision ±1e15.
///
/// * Path weights that are all 0 count as equal.
/// * If all that might happen is absorption, and it is a weight, the event is null, with weight 0.
/// * Without a majorant nothing happens: the event is null, with weight 1.
pub fn null_collision_probabilities<R: Real>(
    rule: EventRule,
    absorption: Absorption,
    collision: &Collision<R>,
) -> Events<R> {
    let shares = shares(collision);
    let mut masses = match rule {
        EventRule::Maximum => shares.each_ref().map(|share| largest(share)),
        EventRule::Average => shares
            .each_ref()
            .map(|share| sum(share.iter().map(|x| x.abs()))),
        EventRule::History => {
            let importance = importance(collision.path_weights);
            let weighted =
                |share: &Spectrum<R>| sum(share.iter().zip(&importance).map(|(x, w)| x.abs() * *w));
            shares.each_ref().map(weighted)
        }
    };
    if absorption == Absorption::Weighted {
        masses[0] = masses[0].lit(0.0);
    }
    let probabilities = normalised(masses);
    let mut weights = shares;
    for (spectrum, probability) in weights.iter_mut().zip(probabilities) {
        for weight in spectrum {
            *weight = quotient(*weight, probability);
        }
    }
    Events {
        probabilities,
        weights,
    }
}

/// Weights of spectral multiple importance sampling: w_i of the file's head.
///
/// * `log_densities`: ln p(ρ|λ_i), −∞ ≤ … < ∞; what all have in common may be left out. For a free
///   flight that is −τ_i, plus ln σ_t,i if it ends in a collision.
/// * `hero_probabilities`: q_i ≥ 0, of sum 1.
///
/// Only differences of the logarithms count, so optical depths may be of any size. A weight is at
/// most 1/q_i; where q_i is 0, it may be anything, and is limited to 1e150 (in single precision
/// 1e15). All are 0 where no wavelength that may be the hero has such a path.
pub fn spectral_mis_weights<R: Real>(log_densities: &[R], hero_probabilities: &[R]) -> Spectrum<R> {
    let Some(first) = log_densities.first() else {
        return Spectrum::new();
    };
    let (zero, never) = (first.lit(0.0), first.lit(f64::NEG_INFINITY));
    let candidates = log_densities
        .iter()
        .zip(hero_probabilities)
        .map(|(log, chance)| R::select(zero.lt(*chance), *log, never));
    // The scale cancels, so it needs no derivative.
    let scale = candidates.fold(never, R::max).detach();
    let scale = R::select(never.lt(scale), scale, zero);
    let mut densities: Spectrum<R> = log_densities.iter().map(|x| relative(*x, scale)).collect();
    let mean = sum(densities
        .iter()
        .zip(hero_probabilities)
        .map(|(density, chance)| *chance * *density));
    for density in &mut densities {
        *density = quotient(*density, mean);
    }
    densities
}

/// Probabilities of the wavelengths in proportion to the size of their path weights; equal where
/// all are 0.
pub fn hero_probabilities<R: Real>(path_weights: &[R]) -> Spectrum<R> {
    let mut chances = importance(path_weights);
    let total = sum(chances.iter().copied());
    for chance in &mut chances {
        *chance = *chance / total;
    }
    chances
}

/// σ_a/σ̄, σ_s/σ̄ and σ_n/σ̄; 0, 0 and 1 without a majorant.
fn shares<R: Real>(collision: &Collision<R>) -> [Spectrum<R>; 3] {
    let (zero, one) = (collision.majorant.lit(0.0), collision.majorant.lit(1.0));
    let clear = collision.majorant.le(zero);
    let majorant = R::select(clear, one, collision.majorant);
    let mut shares = [Spectrum::new(), Spectrum::new(), Spectrum::new()];
    for (sigma_a, sigma_s) in collision.sigma_a.iter().zip(collision.sigma_s) {
        let sigma_a = R::select(clear, zero, *sigma_a);
        let sigma_s = R::select(clear, zero, *sigma_s);
        // A majorant that is the sum of the two leaves nothing.
        let sigma_n = majorant - (sigma_a + sigma_s);
        for (share, sigma) in shares.iter_mut().zip([sigma_a, sigma_s, sigma_n]) {
            share.push(sigma / majorant);
        }
    }
    shares
}

/// `masses` over their sum; the last is sure if there is none.
fn normalised<R: Real>([absorption, scattering, null]: [R; 3]) -> [R; 3] {
    let total = absorption + scattering + null;
    let none = total.le(total.lit(0.0));
    let one = total.lit(1.0);
    let null = R::select(none, one, null);
    let total = R::select(none, one, total);
    [absorption, scattering, null].map(|mass| mass / total)
}

/// |w| over the largest, so that their sum is at least 1; 1 each if all are 0.
fn importance<R: Real>(path_weights: &[R]) -> Spectrum<R> {
    let largest = largest(path_weights);
    let one = largest.lit(1.0);
    let none = largest.le(largest.lit(0.0));
    let scale = R::select(none, one, largest);
    let relative = |w: &R| R::select(none, one, w.abs() / scale);
    path_weights.iter().map(relative).collect()
}

/// p/p₀ from logarithms, limited where it is of no wavelength that may be the hero.
fn relative<R: Real>(log: R, scale: R) -> R {
    let zero = log.lit(0.0);
    let possible = log.lit(f64::NEG_INFINITY).lt(log);
    let most = log.lit(by_precision(log, 40.0, 350.0));
    let difference = R::select(possible, log - scale, zero).min(most);
    R::select(possible, difference.exp(), zero)
}

/// x/y for y ≥ 0, limited in size so that its square is finite, and derivatives are; 0 where y is 0.
fn quotient<R: Real>(x: R, y: R) -> R {
    let (zero, one) = (y.lit(0.0), y.lit(1.0));
    let limit = y.lit(by_precision(y, 1e15, 1e150));
    let some = zero.lt(y);
    let beyond = some & (y * limit).lt(x.abs());
    let within = R::select(beyond, zero, x) / R::select(some, y, one);
    let extreme = R::select(x.lt(zero), -limit, limit);
    R::select(beyond, extreme, R::select(some, within, zero))
}

fn by_precision<R: Real>(x: R, single: f64, double: f64) -> f64 {
    if x.digits() > 24 { double } else { single }
}

/// max_i |x_i|.
fn largest<R: Real>(spectrum: &[R]) -> R {
    let sizes = spectrum.iter().map(|x| x.abs());
    sizes.reduce(R::max).expect("a spectrum has a wavelength")
}

fn sum<R: Real>(numbers: impl Iterator<Item = R>) -> R {
    numbers
        .reduce(|a, b| a + b)
        .expect("a spectrum has a wavelength")
}
