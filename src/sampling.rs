//! Free flight: the distance to the next collision, and its probability.
//!
//!     p(t) = σ_t(t) e^(−τ(t)),   P(no collision before t) = e^(−τ(t))  (article, Eq. 15–24)
//!     τ* = −ln(1 − ξ O),   t* = τ⁻¹(τ*)                               (24)
//!
//! With O = 1 the flight may leave the segment (infinite distance); with O the opacity of the
//! segment a collision in it is certain, and p is divided by O. The article's first equality
//! of (24) lacks `1 −`.

use crate::geometry::Ray;
use crate::medium::{Medium, MediumGradient, attenuate, opacity, transmittance};
use crate::profile::Profile;
use crate::real::Real;
use crate::solve::{self, Bracket, Start};
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
    let [first, rest @ ..] = medium.profiles() else {
        unreachable!("a medium has a component");
    };
    let t = if rest.is_empty() && first.closed_inverse() {
        alone(medium, 0, channel, ray, tau)
    } else {
        sum_inverse(medium, channel, ray, t_max, tau)
    };
    R::select(t.le(t_max), t, t.lit(f64::INFINITY))
}

/// t* of [`free_flight`], and its derivatives by the medium, the ray and `tau`, by the implicit
/// function theorem: ∂t/∂θ = −(∂τ/∂θ)/σ_t(t). Those by σ_t are by that of `channel`. All are 0
/// where there is no collision.
pub fn free_flight_value_and_gradient<R: Real>(
    medium: &Medium<R>,
    channel: usize,
    ray: &Ray<R>,
    t_max: R,
    tau: R,
) -> (R, MediumGradient<R>) {
    let t = free_flight(medium, channel, ray, t_max, tau);
    let reached = t.is_bounded();
    let end = R::select(reached, t, t.lit(0.0));
    let (_, depth) = medium.optical_depth_value_and_gradient_in(channel, ray, end);
    (t, depth.implicit(reached))
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

/// The distance at which one component alone has gathered `tau`; a guess, if its inverse is not
/// in closed form.
fn alone<R: Real>(medium: &Medium<R>, component: usize, channel: usize, ray: &Ray<R>, tau: R) -> R {
    let sigma_t = medium.sigma_t(component, channel);
    let clear = sigma_t.le(tau.lit(0.0));
    let sigma_t = R::select(clear, tau.lit(1.0), sigma_t);
    let t = medium.profiles()[component].guess_inv_column(ray, tau / sigma_t);
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
    let start = start(&plain, channel, &plain_ray, t_max, goal, &shares);
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
        start,
    );
    let beyond = R::select(some, tau.lit(f64::INFINITY), zero);
    R::select(reached, t.max(zero).min(t_max), beyond)
}

/// Bounds of t with τ(t) = `tau`, and a guess between them, from the inverses of the components.
///
/// No component gathers more than τ, so t ≤ min_c t_c(τ); of n components one has gathered at
/// least τ/n, so t ≥ min_c t_c(τ/n). Where each has gathered the same fraction of its part of
/// τ(t_max), they have of their sum: t is between the first and the last of these distances. An
/// inverse that is not in closed form bounds nothing, and is a guess.
///
/// `shares` are the components' parts of τ(t_max). The guess is 1/t = Σ 1/t_c(τ), exact for
/// uniform components, or the mean of the equal fractions where none reaches τ alone.
fn start<R: Real>(
    medium: &Medium<R>,
    channel: usize,
    ray: &Ray<R>,
    t_max: R,
    tau: R,
    shares: &[R],
) -> Start<R> {
    let (zero, one, infinity) = (tau.lit(0.0), tau.lit(1.0), tau.lit(f64::INFINITY));
    let share = tau.lit(1.0 / shares.len() as f64);
    let total = shares.iter().copied().fold(zero, |a, b| a + b);
    let finite = total.is_bounded();
    let total = R::select(finite, total, one);

    let (mut low, mut high) = (infinity, t_max);
    let (mut first, mut last) = (infinity, zero);
    let (mut mean, mut rate) = (zero, zero);
    for (c, part) in shares.iter().enumerate() {
        let closed = medium.profiles()[c].closed_inverse();
        let own = alone(medium, c, channel, ray, tau);
        let reaches = tau.le(*part);
        let own_rate = one / R::select(reaches, own, one).max(tau.lit(1e-30));
        rate = rate + R::select(reaches, own_rate, zero);

        let some = finite & zero.lt(*part);
        let part = R::select(some, *part / total, zero);
        let until = alone(medium, c, channel, ray, tau * part).min(t_max);
        mean = mean + part * R::select(until.is_bounded(), until, zero);
        if closed {
            high = high.min(own);
            low = low.min(alone(medium, c, channel, ray, tau * share));
            first = first.min(R::select(some, until, infinity));
            last = last.max(R::select(some, until, zero));
        } else {
            (low, first, last) = (zero, zero, infinity);
        }
    }
    let high = high.min(R::select(finite, last, infinity));
    let low = low.max(R::select(finite, first, zero)).min(high);
    let guess = R::select(zero.lt(rate), one / rate.max(tau.lit(1e-30)), mean);
    Start {
        bracket: Bracket { low, high },
        guess: guess.max(low).min(high),
        near: false,
    }
}
