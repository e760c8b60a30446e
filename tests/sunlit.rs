//! Fog in the sun: radiances against the integral (1) of `src/airlight/sunlit.rs` by adaptive
//! quadrature, which shares no closed form with them but the columns of the integrand.

mod common;

use analytic_media::airlight::sunlit::{SunlitFog, check_kind};
use analytic_media::geometry::Ray;
use analytic_media::profile::{AnyProfile, Kind};
use analytic_media::real::Real;
use analytic_media::real::dual::Dual;
use common::arithmetic::{Arithmetic, Errors, in_every_arithmetic};
use common::random::Random;

const INFINITY: f64 = f64::INFINITY;

/// A fog of one channel, and a segment in it. The phase function is 1.
#[derive(Clone, Debug)]
struct Case {
    regime: String,
    kind: Kind,
    values: Vec<f64>,
    sigma_s: f64,
    sigma_t: f64,
    origin: [f64; 3],
    direction: [f64; 3],
    t: f64,
    sun: [f64; 3],
}

impl Case {
    fn radiance<R: Real>(&self, lift: impl Fn(f64) -> R) -> R {
        let values: Vec<R> = self.values.iter().map(|v| lift(*v)).collect();
        let profile = AnyProfile::from_values(self.kind, &values);
        let fog = SunlitFog::new(profile, vec![lift(self.sigma_s)], vec![lift(self.sigma_t)]);
        let ray = Ray {
            origin: self.origin.map(&lift),
            direction: self.direction.map(&lift),
        };
        let mut channels = fog.radiance(&ray, lift(self.t), self.sun.map(&lift), lift(1.0));
        channels.next().expect("a fog has a channel")
    }

    fn rounded(&self, round: impl Fn(f64) -> f64) -> Self {
        Self {
            regime: self.regime.clone(),
            kind: self.kind,
            values: self.values.iter().map(|x| round(*x)).collect(),
            sigma_s: round(self.sigma_s),
            sigma_t: round(self.sigma_t),
            origin: self.origin.map(&round),
            direction: self.direction.map(&round),
            t: round(self.t),
            sun: self.sun.map(&round),
        }
    }
}

// ---- Reference

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// 1 − cos θ, θ the angle between two vectors, without cancellation.
fn versine(a: [f64; 3], b: [f64; 3]) -> f64 {
    let c: [f64; 3] = std::array::from_fn(|i| b[i] - a[i]);
    let cross = [
        a[1] * c[2] - a[2] * c[1],
        a[2] * c[0] - a[0] * c[2],
        a[0] * c[1] - a[1] * c[0],
    ];
    let lengths = (dot(a, a) * dot(b, b)).sqrt();
    if dot(a, b) < 0.0 {
        return 1.0 - dot(a, b) / lengths;
    }
    dot(cross, cross) / (lengths * (lengths + dot(a, b)))
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

/// Points and weights of a Gauss–Legendre rule on [−1, 1], by Newton's method.
fn gauss_legendre<const N: usize>() -> [(f64, f64); N] {
    std::array::from_fn(|i| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (N as f64 + 0.5)).cos();
        let mut slope = 0.0;
        for _ in 0..20 {
            let (mut before, mut value) = (1.0, x);
            for n in 2..=N {
                let n = n as f64;
                (before, value) = (
                    value,
                    ((2.0 * n - 1.0) * x * value - (n - 1.0) * before) / n,
                );
            }
            slope = N as f64 * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    })
}

/// ∫ₐᵇ f to 1e-14 of the sum so far, by halving: 16 points of Gauss and Legendre have 1e-14 of
/// a whole where both halves agree with it to 1e-9.
struct Quadrature([(f64, f64); 16]);

impl Quadrature {
    fn of(&self, f: &impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        let points = self.0.iter();
        points.map(|(x, w)| half * w * f(middle + half * x)).sum()
    }

    fn halve(&self, f: &impl Fn(f64) -> f64, a: f64, b: f64, sum: f64) -> f64 {
        let middle = 0.5 * (a + b);
        let halves = self.of(f, a, middle) + self.of(f, middle, b);
        let error = (self.of(f, a, b) - halves).abs();
        if error <= 1e-9 * halves || error <= 1e-16 * sum + 1e-290 {
            return halves;
        }
        let first = self.halve(f, a, middle, sum);
        first + self.halve(f, middle, b, sum + first)
    }
}

/// (1), and the exponents that rounding acts on: σ_t m, and the altitudes in scale heights.
fn reference(case: &Case) -> (f64, f64) {
    // Rate at which the integrand falls; logarithm of the density; exponent of (1).
    let (rate, log_density): (f64, Box<dyn Fn(f64) -> f64>);
    let exponent: Box<dyn Fn(f64) -> f64>;
    let mut condition = 0.0;
    if case.kind == Kind::Constant {
        let kappa = versine(case.direction, case.sun);
        let loss = case.sigma_t * kappa;
        rate = loss;
        log_density = Box::new(|_| 0.0);
        exponent = Box::new(move |s| loss * s);
    } else {
        let up = [case.values[0], case.values[1], case.values[2]];
        let (base, height) = (case.values[3], case.values[4]);
        let start = (dot(up, case.origin) - base) / height;
        let along = dot(up, case.direction) / height;
        let towards_sun = dot(up, case.sun) / height;
        let ground = (-start).exp();
        let sigma = case.sigma_t;
        let column = move |s: f64| {
            if along == 0.0 {
                ground * s
            } else {
                -ground * (-along * s).exp_m1() / along
            }
        };
        rate = if along > 0.0 {
            0.6 * along
        } else {
            sigma * ground
        };
        log_density = Box::new(move |s| -start - along * s);
        exponent =
            Box::new(move |s| sigma * (column(s) + ground * (-along * s).exp() / towards_sun));
        let end = if case.t.is_finite() {
            along * case.t
        } else {
            0.0
        };
        condition = start.abs().max((start + end).abs());
        if towards_sun <= 0.0 {
            return (0.0, 0.0);
        }
    }
    // Beyond that, nothing is left to see.
    let end = case.t.min(60.0 / rate);
    if end == INFINITY {
        return (INFINITY, 0.0);
    }
    let clearest = exponent(0.0).min(exponent(end));
    let integrand = |s: f64| (clearest - exponent(s) + log_density(s)).exp();
    // Panels that grow, so that a first e-fold of any length is found.
    let quadrature = Quadrature(gauss_legendre());
    let edges: Vec<f64> = (0..=40).rev().map(|k| end * 0.5f64.powi(k)).collect();
    let mut sum = quadrature.of(&integrand, 0.0, edges[0]);
    for edge in edges.windows(2) {
        sum += quadrature.halve(&integrand, edge[0], edge[1], sum);
    }
    (case.sigma_s * (-clearest).exp() * sum, clearest + condition)
}

// ---- Cases

/// μ of a ray or the sun: vertical, horizontal, nearly so, or any.
fn cosine(random: &mut Random) -> (&'static str, f64) {
    match random.index(6) {
        0 => ("horizontal", 0.0),
        1 => (
            "near-horizontal",
            random.sign() * random.magnitude(1e-9, 1e-3),
        ),
        2 => ("vertical", random.sign()),
        _ => ("slant", random.between(-1.0, 1.0)),
    }
}

fn cases() -> Vec<Case> {
    let mut random = Random::with_seed(71);
    let mut cases = vec![];
    for i in 0..600 {
        let constant = i % 4 == 0;
        let (name, mu) = cosine(&mut random);
        let direction = random.direction_with(mu);
        let height = random.magnitude(0.1, 1e4);
        let near = i % 3 == 0;
        let sun = if near {
            // Nearly where the ray leads.
            let angle = random.magnitude(1e-7, 0.1);
            let aside = random.direction();
            unit(std::array::from_fn(|k| direction[k] + angle * aside[k]))
        } else {
            let mu = random.pick(&[1.0, 0.5, 0.1, 0.01]);
            random.direction_with(mu)
        };
        let length = match random.index(4) {
            0 => ("infinite", INFINITY),
            1 => ("tiny", height * random.magnitude(1e-9, 1e-5)),
            _ => ("finite", height * random.magnitude(1e-2, 10.0)),
        };
        let sigma_t = random.magnitude(1e-3, 30.0) / height;
        let origin = [1.0, 1.0, random.between(-1.0, 3.0)].map(|x| x * height);
        let (kind, values) = if constant {
            (Kind::Constant, vec![])
        } else {
            (
                Kind::Exponential,
                vec![0.0, 0.0, 1.0, 0.25 * height, height],
            )
        };
        let sun_name = if near { "to the sun" } else { "aside" };
        let kind_name = if constant { "constant" } else { name };
        cases.push(Case {
            regime: format!("{kind_name}, {}, {sun_name}", length.0),
            kind,
            values,
            sigma_s: random.between(0.1, 1.0) * sigma_t,
            sigma_t,
            origin,
            direction,
            t: length.1,
            sun,
        });
    }
    cases
}

#[test]
fn radiances_are_the_integral() {
    in_every_arithmetic!(check_integral);
}

fn check_integral<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(a: &Arithmetic<L, O>) {
    let mut errors = Errors::new();
    for case in cases() {
        let case = case.rounded(|x| a.round(x));
        let (expected, exponent) = reference(&case);
        let got = (a.lower)(case.radiance(&a.lift));
        if expected < 1e6 * a.least() {
            assert!(
                (0.0..1e7 * a.least()).contains(&got),
                "{}: {got:e} {case:?}",
                a.name
            );
            continue;
        }
        if expected == INFINITY {
            assert_eq!(got, INFINITY, "{}: {case:?}", a.name);
            continue;
        }
        let error = (got / expected - 1.0).abs();
        let tolerance = if a.single { 5e-7 } else { 1e-15 } * (1.0 + exponent);
        errors
            .entry(case.regime.clone())
            .or_default()
            .push((error, tolerance));
    }
    a.print("relative error", &errors);
    for (regime, errors) in errors {
        for (error, tolerance) in errors {
            assert!(
                error <= tolerance,
                "{} {regime}: {error:e} > {tolerance:e}",
                a.name
            );
        }
    }
}

// ---- Edges

fn layers(origin: f64, direction: [f64; 3], t: f64, sun: [f64; 3]) -> Case {
    Case {
        regime: String::new(),
        kind: Kind::Exponential,
        values: vec![0.0, 0.0, 1.0, 0.0, 2.0],
        sigma_s: 0.25,
        sigma_t: 0.5,
        origin: [0.0, 0.0, origin],
        direction,
        t,
        sun,
    }
}

const UP: [f64; 3] = [0.0, 0.0, 1.0];
const ASIDE: [f64; 3] = [1.0, 0.0, 0.0];

/// Known without a calculation, or by a short one.
#[test]
fn edges_have_their_values() {
    in_every_arithmetic!(check_edges);
}

fn check_edges<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(a: &Arithmetic<L, O>) {
    let of = |case: &Case| (a.lower)(case.radiance(&a.lift));
    let near = |got: f64, expected: f64, what: &str| {
        let error = (got - expected).abs() / expected;
        assert!(
            error <= 8.0 * a.roundoff(),
            "{} {what}: {got} {expected}",
            a.name
        );
    };
    // The sun at the horizon, below it, almost up, and the densest of fogs.
    for sun in [ASIDE, [0.8, 0.0, -0.6], [0.0, 0.0, -1.0]] {
        for t in [0.0, 1.0, INFINITY] {
            for direction in [UP, ASIDE, [0.0, 0.0, -1.0]] {
                assert_eq!(
                    of(&layers(1.0, direction, t, sun)),
                    0.0,
                    "{} {sun:?}",
                    a.name
                );
            }
        }
    }
    assert!((0.0..1e-29).contains(&of(&layers(1.0, UP, INFINITY, [1.0, 0.0, 1e-30]))));
    assert_eq!(of(&layers(-1e5, UP, 3.0, UP)), 0.0);
    assert_eq!(of(&layers(-1e5, ASIDE, INFINITY, [0.6, 0.0, 0.8])), 0.0);
    // Into the zenith sun nothing is lost on the way: κ = 0, and N = H.
    let depth: f64 = 0.5 * 2.0;
    near(
        of(&layers(0.0, UP, INFINITY, UP)),
        0.25 * 2.0 * (-depth).exp(),
        "κ = 0",
    );
    // Horizontal and endless: ρ is 1 all the way.
    let horizontal = layers(0.0, ASIDE, INFINITY, UP);
    near(of(&horizontal), 0.25 / 0.5 * (-depth).exp(), "horizontal");
    // The ground far below is dark, and what is above it the same as from a horizontal ray.
    near(
        of(&layers(0.0, [0.0, 0.0, -1.0], INFINITY, UP)),
        0.25 * (-depth).exp(),
        "down",
    );
    // A segment without length, and coefficients of zero.
    assert_eq!(of(&layers(0.0, UP, 0.0, UP)), 0.0);
    let pale = |sigma_s, sigma_t, t| Case {
        sigma_s,
        sigma_t,
        t,
        ..horizontal.clone()
    };
    assert_eq!(of(&pale(0.0, 0.0, INFINITY)), 0.0);
    assert_eq!(of(&pale(0.0, 0.5, INFINITY)), 0.0);
    near(of(&pale(0.25, 0.0, 3.0)), 0.75, "clear");
    assert_eq!(of(&pale(0.25, 0.0, INFINITY)), INFINITY);
    // Constant: away from the sun the light is lost on both ways; into it, on none.
    let constant = |direction, t| Case {
        kind: Kind::Constant,
        values: vec![],
        ..layers(0.0, direction, t, UP)
    };
    near(of(&constant([0.0, 0.0, -1.0], INFINITY)), 0.25, "away");
    near(of(&constant(ASIDE, INFINITY)), 0.5, "aside");
    near(of(&constant(UP, 7.0)), 0.25 * 7.0, "into the sun");
    assert_eq!(of(&constant(UP, INFINITY)), INFINITY);
}

/// Channels share the columns, the phase function is a factor, and kinds without a closed form
/// are named.
#[test]
fn fogs_have_channels() {
    let values = [0.0, 0.0, 1.0, 0.0, 2.0];
    let profile = AnyProfile::from_values(Kind::Exponential, &values);
    let fog = SunlitFog::new(profile, vec![0.25, 0.1, 0.0], vec![0.5, 0.1, 0.3]);
    let ray = Ray {
        origin: [0.0; 3],
        direction: [0.6, 0.0, 0.8],
    };
    let got: Vec<f64> = fog.radiance(&ray, 4.0, UP, 0.125).collect();
    for (channel, (sigma_s, sigma_t)) in [(0.25, 0.5), (0.1, 0.1), (0.0, 0.3)]
        .into_iter()
        .enumerate()
    {
        let one = Case {
            sigma_s,
            sigma_t,
            ..layers(0.0, ray.direction, 4.0, UP)
        };
        assert_eq!(got[channel], 0.125 * one.radiance(|x| x));
    }
    assert!(check_kind(Kind::Constant).is_ok() && check_kind(Kind::Exponential).is_ok());
    let refused = check_kind(Kind::Tent).expect_err("a tent has no closed form");
    assert_eq!(
        refused.to_string(),
        "profile must be constant or exponential, got \"tent\""
    );
}

// ---- Derivatives

type Number = Dual<f64, 17>;

/// By scale height, base height, coefficients, ray and sun: dual numbers against central
/// differences, also where the ray leads to the sun (κ = 0) and where it is horizontal.
#[test]
fn radiances_have_derivatives() {
    let slant = [0.6, 0.0, 0.8];
    let rays = [
        slant,
        ASIDE,
        UP,
        [0.0, 0.0, -1.0],
        [0.8, 0.0, 0.6],
        [1.0, 0.0, 1e-6],
    ];
    for kind in [Kind::Exponential, Kind::Constant] {
        for direction in rays {
            for t in [0.01, 1.3, 6.0] {
                check_derivatives(kind, direction, t, slant);
            }
        }
    }
}

fn radiance<R: Real>(kind: Kind, x: &[R]) -> R {
    let profile = AnyProfile::from_values(kind, &x[..5]);
    let fog = SunlitFog::new(profile, vec![x[5]], vec![x[6]]);
    let ray = Ray {
        origin: [x[7], x[8], x[9]],
        direction: [x[10], x[11], x[12]],
    };
    let mut channels = fog.radiance(&ray, x[13], [x[14], x[15], x[16]], x[0].lit(1.0));
    channels.next().expect("a fog has a channel")
}

fn check_derivatives(kind: Kind, direction: [f64; 3], t: f64, sun: [f64; 3]) {
    let fog = [0.0, 0.0, 1.0, 0.2, 2.0, 0.3, 0.7];
    let inputs = [&fog[..], &[0.1, -0.2, 0.4], &direction, &[t], &sun].concat();
    let variables = inputs.iter().enumerate();
    let variables: Vec<Number> = variables.map(|(i, x)| Dual::variable(*x, i)).collect();
    let result = radiance(kind, &variables);
    for i in 0..inputs.len() {
        let step = 1e-5;
        let shifted = |sign: f64| {
            let mut moved = inputs.clone();
            moved[i] += sign * step;
            radiance(kind, &moved)
        };
        let expected = (shifted(1.0) - shifted(-1.0)) / (2.0 * step);
        let (got, scale) = (result.gradient[i], 1.0 + expected.abs());
        assert!(
            (got - expected).abs() <= 1e-8 * scale,
            "{kind:?} {direction:?} {t}: derivative {i} is {got}, by differences {expected}"
        );
    }
}

/// Finite wherever the radiance is, where it vanishes and on endless rays too.
#[test]
fn derivatives_are_finite() {
    let suns = [UP, ASIDE, [0.6, 0.0, -0.8], [1.0, 0.0, 1e-30]];
    for kind in [Kind::Exponential, Kind::Constant] {
        for (direction, sun) in [UP, ASIDE, [0.0, 0.0, -1.0]]
            .into_iter()
            .flat_map(|direction| suns.map(|sun| (direction, sun)))
        {
            for (t, sigma_t) in [(0.0, 0.7), (2.0, 0.0), (INFINITY, 0.7), (1e300, 0.7)] {
                let fog = [0.0, 0.0, 1.0, 0.2, 2.0, 0.3, sigma_t, 0.1, -0.2, 0.4];
                let inputs = [&fog[..], &direction, &[t], &sun].concat();
                let variables = inputs.iter().enumerate();
                let variables: Vec<Number> =
                    variables.map(|(i, x)| Dual::variable(*x, i)).collect();
                let result = radiance(kind, &variables);
                let finite = result.gradient.iter().all(|x| x.is_finite());
                let endless = result.value.is_infinite() || t == 1e300;
                assert!(
                    finite || endless,
                    "{kind:?} {direction:?} {sun:?} {t}: {result:?}"
                );
            }
        }
    }
}

/// A segment in a box, from numbers in [0, 1).
fn in_box<R: Real>(u: &[f64; 12], sigma_t: f64, part: [f64; 2], lift: impl Fn(f64) -> R) -> R {
    let unit = |v: [f64; 3]| v.map(|x| x / v.iter().map(|x| x * x).sum::<f64>().sqrt());
    let corner: [f64; 3] = std::array::from_fn(|i| 1.0 + 3.0 * u[i]);
    let [from, to]: [[f64; 3]; 2] =
        [3, 6].map(|k| std::array::from_fn(|i| corner[i] * (2.0 * u[k + i] - 1.0)));
    let sun = unit(std::array::from_fn(|i| u[9 + i] - 0.5));
    let step: [f64; 3] = std::array::from_fn(|i| to[i] - from[i]);
    let length = step.iter().map(|x| x * x).sum::<f64>().sqrt();
    let origin = std::array::from_fn(|i| from[i] + part[0] * step[i]);
    let fog = SunlitFog::new(
        AnyProfile::from_values(Kind::Constant, &[]),
        vec![lift(0.25)],
        vec![lift(sigma_t)],
    );
    let ray = Ray {
        origin: origin.map(&lift),
        direction: unit(step).map(&lift),
    };
    let bounds = [corner.map(|x| lift(-x)), corner.map(&lift)];
    let t = lift((part[1] - part[0]) * length);
    let sun = sun.map(&lift);
    fog.radiance_in_box(&ray, t, sun, lift(1.0), bounds)
        .next()
        .expect("a channel")
}

/// The definition by the midpoint rule: (1) of `sunlit_box`, side by side.
#[test]
fn a_box_is_lit_through_its_sides() {
    let mut random = fastrand::Rng::with_seed(2026);
    for _ in 0..200 {
        let u: [f64; 12] = std::array::from_fn(|_| random.f64());
        let sigma_t = 10f64.powf(random.f64() * 3.0 - 2.0);
        let got = in_box(&u, sigma_t, [0.0, 1.0], |x| x);
        // Short parts, with the light of their middle.
        const N: usize = 4000;
        let corner: [f64; 3] = std::array::from_fn(|i| 1.0 + 3.0 * u[i]);
        let at = |k: usize, i: usize| corner[i] * (2.0 * u[k + i] - 1.0);
        let step: [f64; 3] = std::array::from_fn(|i| at(6, i) - at(3, i));
        let length = step.iter().map(|x| x * x).sum::<f64>().sqrt();
        let sun: [f64; 3] = std::array::from_fn(|i| u[9 + i] - 0.5);
        let norm = sun.iter().map(|x| x * x).sum::<f64>().sqrt();
        let expected: f64 = (0..N)
            .map(|k| {
                let x = (k as f64 + 0.5) / N as f64;
                let way = (0..3).map(|i| {
                    let side = corner[i].copysign(sun[i]);
                    (side - at(3, i) - x * step[i]) / (sun[i] / norm)
                });
                let way = way.fold(f64::INFINITY, f64::min);
                0.25 * (-sigma_t * (x * length + way)).exp() * length / N as f64
            })
            .sum();
        let error = (got / expected - 1.0).abs();
        assert!(error < 1e-5 * (1.0 + sigma_t), "{got} {expected} {error:e}");
    }
}

/// A segment in a box is the sum of its parts, in every arithmetic, and nothing is infinite for a sun
/// along a side.
#[test]
fn parts_of_a_segment_in_a_box_add_up() {
    fn check<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(a: &Arithmetic<L, O>) {
        let mut random = fastrand::Rng::with_seed(2027);
        for case in 0..200 {
            let mut u: [f64; 12] = std::array::from_fn(|_| random.f64());
            if case % 4 == 0 {
                u[9 + case % 3] = 0.5;
            }
            let sigma_t = 10f64.powf(random.f64() * 3.0 - 2.0);
            let of = |part| (a.lower)(in_box(&u, sigma_t, part, &a.lift));
            let exact = |part| in_box(&u, sigma_t, part, |x| x);
            let cut = random.f64();
            let [whole, first, second] = [[0.0, 1.0], [0.0, cut], [cut, 1.0]].map(of);
            let corner: [f64; 3] = std::array::from_fn(|i| 1.0 + 3.0 * u[i]);
            let square = |i: usize| (2.0 * corner[i] * (u[6 + i] - u[3 + i])).powi(2);
            let way = (0..3).map(square).sum::<f64>().sqrt() * cut;
            let sum = first + second * (-sigma_t * way).exp();
            let unit = if a.single { 2e-6 } else { 1e-14 };
            let depth = 1.0 + sigma_t * 20.0;
            assert!(
                (sum - whole).abs() <= unit * depth * whole + a.least(),
                "{}",
                a.name
            );
            let expected = exact([0.0, 1.0]);
            let error = (whole - expected).abs();
            assert!(error <= unit * depth * expected + a.least(), "{}", a.name);
        }
    }
    in_every_arithmetic!(check);
}
