//! Free flight: the distance to the next collision, and its probability.
//!
//!     p(t) = σ_t(t) e^(−τ(t)),   P(no collision before t) = e^(−τ(t))  (article, Eq. 15–24)
//!     τ* = −ln(1 − ξ O),   t* = τ⁻¹(τ*)                               (24)
//!
//! With O = 1 the flight may leave the segment (infinite distance); with O the opacity of the
//! segment a collision in it is certain, and p is divided by O. The article's first equality
//! of (24) lacks `1 −`.

use crate::geometry::Ray;
use crate::medium::{Medium, attenuate, opacity, transmittance};
use crate::profile::Profile;
use crate::real::Real;
use crate::solve::{self, Bracket};
use crate::special::rel::psi;

/// τ* of (24): the optical depth of a flight, from the uniform variate `u` in [0, 1) and the
/// `opacity` that collisions are limited to (1: the flight may leave the segment).
pub fn sample_optical_depth<R: Real>(u: R, opacity: R) -> R {
    let y = u * opacity;
    y * psi(y)
}

/// t* of (24): the smallest distance, up to `t_max`, at which the ray has gathered the
/// optical depth `tau` ≥ 0 in `channel`; infinite if it gathers less.
///
/// One component: its inverse in closed form. A sum: bracketed iteration, residual
/// |τ(t) − τ| ≤ 1e-12 max(1, τ) in f64 and 1e-6 max(1, τ) in f32.
pub fn free_flight<R: Real>(
    medium: &Medium<R>,
    channel: usize,
    ray: &Ray<R>,
    t_max: R,
    tau: R,
) -> R {
    let t = if medium.profiles().len() == 1 {
        inverse(medium, 0, channel, ray, tau)
    } else {
        sum_inverse(medium, channel, ray, t_max, tau)
    };
    R::select(t.le(t_max), t, t.lit(f64::INFINITY))
}

/// Density of `t` as a flight in every channel, 1/length: σ_t(t) e^(−τ(t)); 0 for a flight
/// without collision.
///
/// Other channels than the one that was sampled give the weights of spectral MIS.
pub fn pdf<R: Real>(medium: &Medium<R>, ray: &Ray<R>, t: R) -> impl Iterator<Item = R> {
    let inside = t.is_bounded();
    let t = R::select(inside, t, t.lit(0.0));
    medium
        .extinction(ray.at(t))
        .zip(medium.optical_depth(ray, t))
        .map(move |(sigma, tau)| {
            let through = transmittance(tau);
            // Where nothing gets through, σ_t may be infinite.
            let some = inside & tau.lit(0.0).lt(through);
            R::select(
                some,
                R::select(some, sigma, through) * through,
                tau.lit(0.0),
            )
        })
        .collect::<Vec<_>>()
        .into_iter()
}

/// Density of `t` as a flight that must end before `t_max`, in every channel: `pdf` over the
/// opacity of the segment.
pub fn pdf_within<R: Real>(
    medium: &Medium<R>,
    ray: &Ray<R>,
    t_max: R,
    t: R,
) -> impl Iterator<Item = R> {
    let within = t.le(t_max);
    medium
        .optical_depth(ray, t_max)
        .zip(pdf(medium, ray, t))
        .map(move |(depth, density)| {
            let normalisation = opacity(depth);
            let some = t.lit(0.0).lt(normalisation) & within;
            let quotient = density / R::select(some, normalisation, t.lit(1.0));
            R::select(some, quotient, t.lit(0.0))
        })
        .collect::<Vec<_>>()
        .into_iter()
}

/// The distance at which one component alone has gathered `tau`.
fn inverse<R: Real>(
    medium: &Medium<R>,
    component: usize,
    channel: usize,
    ray: &Ray<R>,
    tau: R,
) -> R {
    let sigma_t = medium.sigma_t(component, channel);
    let clear = sigma_t.le(tau.lit(0.0));
    let sigma_t = R::select(clear, tau.lit(1.0), sigma_t);
    let t = medium.profiles()[component].inv_column(ray, tau / sigma_t);
    R::select(clear & tau.lit(0.0).lt(tau), tau.lit(f64::INFINITY), t)
}

fn sum_inverse<R: Real>(medium: &Medium<R>, channel: usize, ray: &Ray<R>, t_max: R, tau: R) -> R {
    let (zero, one) = (tau.lit(0.0), tau.lit(1.0));
    let depth = |medium: &Medium<R>, ray: &Ray<R>, t| {
        medium.attenuate(channel, |profile| profile.column(ray, t))
    };
    let plain = medium.detach();
    let plain_ray = ray.detach();
    let t_max = t_max.detach();
    let shares = plain.shares(channel, |profile| profile.column(&plain_ray, t_max));
    let total = shares.iter().copied().fold(zero, |a, b| a + b);
    let some = zero.lt(tau);
    let reached = some & tau.le(total);

    let goal = R::select(reached, tau, total.min(one)).detach();
    let (bracket, guess) = bracket(&plain, channel, &plain_ray, t_max, goal, &shares);
    let slopes = |t| {
        let components = plain.profiles().iter().enumerate();
        components.fold((zero, zero), |(slope, curvature), (c, profile)| {
            let sigma = plain.sigma_t(c, channel);
            let (density, change) = profile.density_along(&plain_ray, t);
            let curvature = curvature + attenuate(sigma, change);
            (slope + attenuate(sigma, density), curvature)
        })
    };
    let t = solve::increasing(
        |t| depth(&plain, &plain_ray, t),
        slopes,
        |t| depth(medium, ray, t),
        R::select(reached, tau, goal),
        bracket,
        guess,
    );
    let beyond = R::select(some, tau.lit(f64::INFINITY), zero);
    R::select(reached, t.max(zero).min(t_max), beyond)
}

/// Bounds of t with τ(t) = `tau`, and a guess between them, from closed inverses alone.
///
/// No component gathers more than τ, so t ≤ min_c t_c(τ); of n components one has gathered
/// at least τ/n, so t ≥ min_c t_c(τ/n). Where each component has only the nth part of
/// τ(t_max) − τ before it, no more than that remains of their sum, so t ≤ max_c of these
/// distances: a finite bound for media that thin out.
///
/// `shares` are the components' parts of τ(t_max). The guess 1/t = Σ 1/t_c(τ) is exact for
/// uniform components.
fn bracket<R: Real>(
    medium: &Medium<R>,
    channel: usize,
    ray: &Ray<R>,
    t_max: R,
    tau: R,
    shares: &[R],
) -> (Bracket<R>, R) {
    let share = tau.lit(1.0 / shares.len() as f64);
    let total = shares.iter().copied().fold(tau.lit(0.0), |a, b| a + b);
    let rest = (total - tau) * share;

    let (zero, one) = (tau.lit(0.0), tau.lit(1.0));
    let mut low = tau.lit(f64::INFINITY);
    let mut high = t_max;
    let mut tail = zero;
    let mut rate = zero;
    for (c, part) in shares.iter().enumerate() {
        let alone = inverse(medium, c, channel, ray, tau);
        high = high.min(alone);
        low = low.min(inverse(medium, c, channel, ray, tau * share));
        let before = *part - rest;
        let thins = zero.lt(before) & before.is_bounded();
        let until = inverse(medium, c, channel, ray, R::select(thins, before, one));
        tail = tail.max(R::select(thins, until, zero));
        rate = rate + one / alone.max(tau.lit(1e-30));
    }
    let tail = R::select(rest.is_bounded() & zero.lt(tail), tail, high);
    let high = high.min(tail.max(low));
    let low = low.min(high);
    let harmonic = one / rate.max(tau.lit(1e-30));
    let guess = R::select(high.is_bounded() | tau.lit(1e-30).lt(rate), harmonic, low);
    (Bracket { low, high }, guess.max(low).min(high))
}
