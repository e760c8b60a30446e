//! Free flights follow their density: chi-square tests, inverses, and the density itself.

mod common;

use analytic_media::geometry::Ray;
use analytic_media::medium::{Medium, opacity};
use analytic_media::profile::{AnyProfile, Kind};
use analytic_media::sampling::{free_flight, pdf, pdf_within, sample_optical_depth};
use common::random::Random;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Chance that all goodness-of-fit tests together reject a correct sampler.
const SIGNIFICANCE: f64 = 0.01;
const SAMPLES: usize = 20_000;
const BINS: usize = 50;

type Component = (Kind, Vec<f64>, [f64; 2]);

/// A medium with two channels.
fn medium(components: &[Component]) -> Medium<f64> {
    let profile = |(kind, values, _): &Component| {
        AnyProfile::new(*kind, values).expect("the parameters are valid")
    };
    let sigma_t = components.iter().flat_map(|(_, _, sigma)| *sigma);
    Medium::new(components.iter().map(profile).collect(), sigma_t.collect())
}

fn media() -> Vec<(&'static str, Medium<f64>)> {
    let constant = (Kind::Constant, vec![], [0.3, 0.05]);
    let thinning = (
        Kind::Linear,
        vec![0.0, 0.0, 1.0, 0.0, -0.1, 1.0],
        [0.4, 0.1],
    );
    let layer = |base, height| {
        (
            Kind::Exponential,
            vec![0.0, 0.0, 1.0, base, height],
            [0.5, 1.0],
        )
    };
    vec![
        ("constant", medium(std::slice::from_ref(&constant))),
        ("linear", medium(std::slice::from_ref(&thinning))),
        ("exponential", medium(&[layer(0.0, 3.0)])),
        ("two layers", medium(&[layer(0.0, 3.0), layer(-2.0, 0.7)])),
        (
            "three kinds",
            medium(&[constant, thinning, layer(1.0, 2.0)]),
        ),
    ]
}

fn rays() -> [Ray<f64>; 5] {
    let ray = |direction| Ray {
        origin: [0.3, -0.2, 2.0],
        direction,
    };
    [
        ray([0.0, 0.0, 1.0]),
        ray([0.0, 0.0, -1.0]),
        ray([1.0, 0.0, 0.0]),
        ray([0.8, 0.0, 0.6]),
        ray([0.8, 0.0, -0.6]),
    ]
}

/// A medium, a ray, and how far flights may go.
struct Case {
    name: String,
    medium: Medium<f64>,
    ray: Ray<f64>,
    t_max: f64,
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, medium) in media() {
        for ray in rays() {
            for t_max in [4.0, f64::INFINITY] {
                let name = format!("{name} along {:?} up to {t_max}", ray.direction);
                let medium = medium.clone();
                cases.push(Case {
                    name,
                    medium,
                    ray,
                    t_max,
                });
            }
        }
    }
    cases
}

impl Case {
    fn depth(&self, channel: usize, t: f64) -> f64 {
        let mut depths = self.medium.optical_depth(&self.ray, t);
        depths.nth(channel).expect("the channel exists")
    }

    /// The distance of the flight that the variate `u` stands for.
    fn flight(&self, channel: usize, u: f64, opacity: f64) -> f64 {
        let tau = sample_optical_depth(u, opacity);
        free_flight(&self.medium, channel, &self.ray, self.t_max, tau)
    }

    fn pdf(&self, channel: usize, t: f64) -> f64 {
        let mut densities = pdf(&self.medium, &self.ray, t);
        densities.nth(channel).expect("the channel exists")
    }

    fn pdf_within(&self, channel: usize, t: f64) -> f64 {
        let mut densities = pdf_within(&self.medium, &self.ray, self.t_max, t);
        densities.nth(channel).expect("the channel exists")
    }
}

/// Probability that correct samples look at least as unlikely as these `counts`.
fn p_value(counts: &[f64], expected: &[f64]) -> f64 {
    let terms = counts.iter().zip(expected);
    let statistic: f64 = terms.map(|(n, e)| (n - e) * (n - e) / e).sum();
    let freedom = counts.len() as f64 - 1.0;
    ChiSquared::new(freedom).expect("bins").sf(statistic)
}

/// ∫ f over [a, b] by Simpson's rule with 64 intervals.
fn integral(f: impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    let h = (b - a) / 64.0;
    let inner = (1..64).map(|i| f(a + f64::from(i) * h) * if i % 2 == 1 { 4.0 } else { 2.0 });
    (f(a) + f(b) + inner.sum::<f64>()) * h / 3.0
}

/// Flights against the integral of their pdf over bins of distance; flights that leave are a
/// bin of their own. The bins come from the pdf alone, not from the sampler's inverse.
#[test]
fn flights_follow_their_density() {
    let cases = cases();
    let tests = 2 * cases.len();
    let threshold = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / tests as f64); // Šidák
    let mut random = Random::with_seed(17);
    let mut least: f64 = 1.0;
    for case in &cases {
        for limited in [false, true] {
            let total = case.depth(0, case.t_max);
            let limit = if limited { opacity(total) } else { 1.0 };
            let reach = if case.t_max.is_finite() {
                case.t_max
            } else {
                12.0
            };
            let density = |t| case.pdf(0, t) / limit;
            let edge = |i: usize| reach * i as f64 / BINS as f64;

            let mut counts = vec![0.0; BINS + 1];
            for _ in 0..SAMPLES {
                let t = case.flight(0, random.unit(), limit);
                let bin = (t / reach * BINS as f64).min(BINS as f64) as usize;
                counts[bin] += 1.0;
            }
            let inside = |i| integral(density, edge(i), edge(i + 1)) * SAMPLES as f64;
            let mut expected: Vec<f64> = (0..BINS).map(inside).collect();
            expected.push(SAMPLES as f64 - expected.iter().sum::<f64>());
            let (counts, expected) = pool(&counts, &expected);
            let p = p_value(&counts, &expected);
            least = least.min(p);
            assert!(
                p > threshold,
                "{} (limited: {limited}): p = {p:e} < {threshold:e}\n{counts:?}\n{expected:?}",
                case.name
            );
        }
    }
    println!("{tests} tests, least p {least:.2e}, threshold {threshold:.2e}");
}

/// Joins neighbours until each bin expects at least 5 samples.
fn pool(counts: &[f64], expected: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (mut pooled, mut sums) = (vec![0.0], vec![0.0]);
    for (n, e) in counts.iter().zip(expected) {
        if sums[sums.len() - 1] >= 5.0 {
            pooled.push(0.0);
            sums.push(0.0);
        }
        let last = sums.len() - 1;
        pooled[last] += n;
        sums[last] += e;
    }
    if sums.len() > 1 && sums[sums.len() - 1] < 5.0 {
        let (n, e) = (pooled.pop().expect("a bin"), sums.pop().expect("a bin"));
        let last = sums.len() - 1;
        pooled[last] += n;
        sums[last] += e;
    }
    (pooled, sums)
}

/// u ↦ t ↦ O(t)/O = u.
#[test]
fn flights_undo_the_opacity() {
    let mut random = Random::with_seed(18);
    for case in cases() {
        for channel in 0..2 {
            let limit = opacity(case.depth(channel, case.t_max));
            for _ in 0..200 {
                let u = random.unit();
                let t = case.flight(channel, u, limit);
                let back = opacity(case.depth(channel, t)) / limit;
                assert!(t <= case.t_max, "{}: t = {t} for u = {u}", case.name);
                assert!(
                    (back - u).abs() <= 1e-13,
                    "{}: {back} for u = {u}",
                    case.name
                );
            }
        }
    }
}

/// The pdf of every channel is the derivative of its opacity, whichever channel was sampled.
#[test]
fn pdf_is_the_derivative_of_the_opacity() {
    let step = 1e-5;
    for case in cases() {
        for channel in 0..2 {
            for t in [0.1, 0.7, 2.0, 3.5] {
                let through = |t: f64| (-case.depth(channel, t)).exp();
                let slope = (through(t - step) - through(t + step)) / (2.0 * step);
                let density = case.pdf(channel, t);
                let close = |got: f64, expected: f64| (got - expected).abs() <= 1e-8;
                assert!(
                    close(density, slope),
                    "{}: {density} at {t}, not {slope}",
                    case.name
                );
                let limit = opacity(case.depth(channel, case.t_max));
                let within = case.pdf_within(channel, t);
                assert!(
                    close(within, slope / limit),
                    "{}: {within} at {t}",
                    case.name
                );
            }
            assert_eq!(case.pdf(channel, f64::INFINITY), 0.0);
            assert_eq!(case.pdf_within(channel, 1e3 + case.t_max), 0.0);
        }
    }
}

/// Nothing to gather: at once. More than there is: never.
#[test]
fn edges_of_the_optical_depth() {
    for case in cases() {
        let flight = |t_max, tau| free_flight(&case.medium, 0, &case.ray, t_max, tau);
        let total = case.depth(0, case.t_max);
        assert_eq!(flight(case.t_max, 0.0), 0.0, "{}", case.name);
        if total.is_finite() {
            assert_eq!(
                flight(case.t_max, 1.01 * total),
                f64::INFINITY,
                "{}",
                case.name
            );
            assert_eq!(flight(0.01, total), f64::INFINITY, "{}", case.name);
        }
        assert_eq!(flight(0.0, 0.5), f64::INFINITY, "{}", case.name);
        assert_eq!(
            flight(case.t_max, f64::INFINITY),
            f64::INFINITY,
            "{}",
            case.name
        );
    }
}

/// A component without attenuation is not there.
#[test]
fn clear_components_do_not_matter() {
    let ray = &rays()[0];
    let layer = (Kind::Exponential, vec![0.0, 0.0, 1.0, 0.0, 3.0], [0.5, 0.0]);
    let clear = (Kind::Constant, vec![], [0.0, 0.0]);
    let both = medium(&[layer.clone(), clear.clone()]);
    let alone = medium(&[layer]);
    let flight = |medium, channel| free_flight(medium, channel, ray, f64::INFINITY, 0.2);
    assert!((flight(&both, 0) - flight(&alone, 0)).abs() <= 1e-14);
    assert_eq!(flight(&both, 1), f64::INFINITY);
    assert_eq!(both.optical_depth(ray, f64::INFINITY).nth(1), Some(0.0));
    assert_eq!(
        medium(&[clear]).optical_depth(ray, f64::INFINITY).next(),
        Some(0.0)
    );
}

/// τ* = −ln(1 − ξ O) keeps its digits for small ξ and thin media.
#[test]
fn sampled_depths_keep_small_numbers() {
    for u in [1e-300, 1e-20, 1e-9, 0.3, 0.999_999] {
        for limit in [1e-12, 0.5, 1.0] {
            let expected = -f64::ln_1p(-u * limit);
            let got = sample_optical_depth(u, limit);
            assert!(
                (got - expected).abs() <= 5e-16 * expected,
                "{u} {limit}: {got}"
            );
        }
    }
}
