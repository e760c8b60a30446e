//! Paths that carry several wavelengths: expected values, computed exactly, are those of the
//! wavelengths one by one.

mod common;

use analytic_media::real::Real;
use analytic_media::real::dual::Dual;
use analytic_media::spectral::{
    Absorption, Collision, EventRule, Events, hero_probabilities, null_collision_probabilities,
    spectral_mis_weights,
};
use common::arithmetic::{Arithmetic, in_every_arithmetic};
use common::random::Random;

const RULES: [EventRule; 3] = [EventRule::Maximum, EventRule::Average, EventRule::History];
const ABSORPTIONS: [Absorption; 2] = [Absorption::Sampled, Absorption::Weighted];

fn choices() -> impl Iterator<Item = (EventRule, Absorption)> {
    let with = |rule| ABSORPTIONS.map(|absorption| (rule, absorption));
    RULES.into_iter().flat_map(with)
}

fn close(got: f64, expected: f64, tolerance: f64, what: &str) {
    let error = (got - expected).abs();
    assert!(
        error <= tolerance * expected.abs().max(1.0),
        "{what}: {got:e}, expected {expected:e}, error {error:.1e}"
    );
}

// ---- Spectral multiple importance sampling

/// Densities of the wavelengths λ.
const WAVELENGTHS: [f64; 3] = [0.6, 0.3, 0.1];

/// p(ρ|λ) of four paths: of any size, not possible at some wavelengths, of sum 1.
const PATHS: [[f64; 3]; 4] = [
    [0.5, 0.3, 0.0],
    [0.3, 0.1, 1e-3],
    [0.0, 0.6, 0.9],
    [0.2, 0.0, 0.099],
];

/// f over p: what a path counts at a wavelength.
const VALUES: [[f64; 3]; 4] = [
    [1.0, 2.0, 0.0],
    [0.3, 0.7, 5.0],
    [0.0, 1.5, 0.25],
    [4.0, 0.0, 1.0],
];

/// All sets of `n` wavelengths, drawn independently, with their probabilities.
fn sets(n: usize) -> Vec<(Vec<usize>, f64)> {
    (0..n).fold(vec![(vec![], 1.0)], |sets, _| {
        let longer = |(set, chance): (Vec<usize>, f64)| {
            (0..3).map(move |k| ([&set[..], &[k]].concat(), chance * WAVELENGTHS[k]))
        };
        sets.into_iter().flat_map(longer).collect()
    })
}

/// E[F] over the sets of wavelengths, heroes, and paths. `heroes` are the probabilities of a set;
/// `logs` what is passed for a path and a wavelength, and `densities` the density of the latter.
fn expectation(
    n: usize,
    paths: &[[f64; 3]],
    values: &[[f64; 3]],
    heroes: impl Fn(&[usize]) -> Vec<f64>,
    logs: impl Fn(f64, usize) -> f64,
) -> f64 {
    let mut mean = 0.0;
    for (set, chance) in sets(n) {
        let heroes = heroes(&set);
        for (path, value) in paths.iter().zip(values) {
            let drawn: f64 = heroes.iter().zip(&set).map(|(q, k)| q * path[*k]).sum();
            let logs: Vec<f64> = set.iter().map(|k| logs(path[*k], *k)).collect();
            let weights = spectral_mis_weights(&logs, &heroes);
            let of = |(weight, k): (&f64, &usize)| weight * value[*k] / WAVELENGTHS[*k];
            let f: f64 = weights.iter().zip(&set).map(of).sum();
            mean += chance * drawn * f / n as f64;
        }
    }
    mean
}

fn integral(paths: &[[f64; 3]], values: &[[f64; 3]]) -> f64 {
    let terms = paths.iter().flatten().zip(values.iter().flatten());
    terms.map(|(p, value)| p * value).sum()
}

fn uniform(set: &[usize]) -> Vec<f64> {
    vec![1.0 / set.len() as f64; set.len()]
}

/// E[F] = I for wavelengths of different densities, whatever the hero is chosen by: all that may
/// happen is enumerated.
#[test]
fn mis_is_unbiased() {
    let by_size = |set: &[usize]| {
        let weights: Vec<f64> = set.iter().map(|k| [0.2, 3.0, -1.0][*k]).collect();
        hero_probabilities(&weights).to_vec()
    };
    let expected = integral(&PATHS, &VALUES);
    for n in 1..=4 {
        let log = |p: f64, _: usize| p.ln();
        let got = expectation(n, &PATHS, &VALUES, uniform, log);
        close(got, expected, 1e-14, "uniform heroes");
        let got = expectation(n, &PATHS, &VALUES, by_size, log);
        close(got, expected, 1e-14, "heroes by size");
    }
}

/// (62) as printed has the densities of the wavelengths in its sum. For a single path that counts
/// the same at all wavelengths, E[F]/I is Σ_set p(set) n / (3 Σ_k p(λ_k)): fractions.
#[test]
fn mis_as_printed_is_biased() {
    let (path, value) = ([[1.0; 3]], [[1.0; 3]]);
    let printed = |p: f64, k: usize| p.ln() + WAVELENGTHS[k].ln();
    for (n, expected) in [(1, 1.0), (2, 57.0 / 70.0), (3, 422867.0 / 546000.0)] {
        let got = expectation(n, &path, &value, uniform, printed);
        close(got / 3.0, expected, 1e-14, "(62)");
        let got = expectation(n, &path, &value, uniform, |p, _| p.ln());
        close(got / 3.0, 1.0, 1e-14, "corrected");
    }
    let got = expectation(2, &PATHS, &VALUES, uniform, printed);
    let ratio = got / integral(&PATHS, &VALUES);
    assert!((ratio - 1.0).abs() > 0.03, "{ratio}");
}

/// Optical depths of any size: only their differences count, and the mean weight is 1.
#[test]
fn mis_takes_optical_depths_of_any_size() {
    let mut random = Random::with_seed(31);
    for depth in [0.0, 1.0, 87.0, 200.0, 1e3, 1e6] {
        for n in 1..=6 {
            // Multiples of 1/16, which f32 holds with the depth.
            let steps: Vec<f64> = (0..n).map(|_| random.index(1000) as f64 / 16.0).collect();
            let heroes = hero_probabilities(&steps);
            let shifted: Vec<f64> = steps.iter().map(|x| -depth - x).collect();
            let weights = spectral_mis_weights(&shifted, &heroes);
            let logs: Vec<f64> = steps.iter().map(|x| -x).collect();
            assert_eq!(weights, spectral_mis_weights(&logs, &heroes));
            let mean: f64 = weights.iter().zip(&heroes).map(|(w, q)| w * q).sum();
            close(mean, 1.0, 1e-14, "mean weight");

            let single = |x: &f64| *x as f32;
            let logs: Vec<f32> = shifted.iter().map(single).collect();
            let chances: Vec<f32> = heroes.iter().map(single).collect();
            for (got, expected) in spectral_mis_weights(&logs, &chances).iter().zip(&weights) {
                close(f64::from(*got), *expected, 2e-6, "f32");
            }
        }
    }
}

/// Wavelengths that are never the hero, and paths that a wavelength, or no hero, has.
#[test]
fn mis_has_edges() {
    const NEVER: f64 = f64::NEG_INFINITY;
    let weights = |logs: &[f64], heroes: &[f64]| spectral_mis_weights(logs, heroes).to_vec();
    assert_eq!(weights(&[-3.0], &[1.0]), [1.0]);
    assert_eq!(weights(&[NEVER], &[1.0]), [0.0]);
    assert_eq!(weights(&[-3.0, NEVER], &[0.5, 0.5]), [2.0, 0.0]);
    assert_eq!(weights(&[NEVER, -3.0], &[1.0, 0.0]), [0.0, 0.0]);
    assert_eq!(weights(&[-1e3, -1e3], &[1.0, 0.0]), [1.0, 1.0]);
    assert_eq!(weights(&[-1e3, 0.0], &[1.0, 0.0]), [1.0, 1e150]);
    assert_eq!(weights(&[0.0, -1e3], &[1.0, 0.0]), [1.0, 0.0]);
    assert_eq!(spectral_mis_weights(&[-1e3f32, 0.0], &[1.0, 0.0])[1], 1e15);
    // The hero is all but impossible: 1/q.
    let weights = spectral_mis_weights(&[-1e3f32, 0.0], &[1.0, 1e-12]);
    assert!((weights[1] * 1e-12 - 1.0).abs() < 1e-6 && weights[0] == 0.0);
}

// ---- Null collisions

/// A medium in three wavelengths and the majorant of a flight.
struct Coefficients {
    name: &'static str,
    sigma_a: [f64; 3],
    sigma_s: [f64; 3],
    majorant: f64,
}

fn media() -> Vec<Coefficients> {
    let medium = |name, sigma_a, sigma_s, majorant| Coefficients {
        name,
        sigma_a,
        sigma_s,
        majorant,
    };
    vec![
        medium("grey", [0.5; 3], [1.5; 3], 2.0),
        medium("chromatic", [0.1, 0.6, 0.2], [2.0, 0.3, 1.0], 2.1),
        medium("loose majorant", [0.1, 0.6, 0.2], [2.0, 0.3, 1.0], 5.0),
        medium(
            "clear at a wavelength",
            [0.0, 0.6, 0.2],
            [0.0, 0.3, 1.0],
            1.2,
        ),
        medium("absorbing", [0.4, 0.1, 0.0], [0.0; 3], 0.4),
        medium("scattering", [0.0; 3], [0.4, 0.1, 1.3], 1.3),
        medium("majorant too small", [0.1, 0.6, 0.2], [2.0, 0.3, 1.0], 1.5),
    ]
}

impl Coefficients {
    fn sigma_t(&self, i: usize) -> f64 {
        self.sigma_a[i] + self.sigma_s[i]
    }

    fn sigma(&self, event: usize, i: usize) -> f64 {
        match event {
            0 => self.sigma_a[i],
            1 => self.sigma_s[i],
            _ => self.majorant - self.sigma_t(i),
        }
    }

    /// Whether a wavelength has the event, and by history a path weight too.
    fn has(&self, event: usize, rule: EventRule, weights: &[f64; 3]) -> bool {
        let all = rule != EventRule::History || *weights == [0.0; 3];
        (0..3).any(|i| (all || weights[i] > 0.0) && self.sigma(event, i) > 0.0)
    }

    fn events(&self, rule: EventRule, absorption: Absorption, weights: &[f64; 3]) -> Events<f64> {
        let collision = Collision {
            sigma_a: &self.sigma_a,
            sigma_s: &self.sigma_s,
            majorant: self.majorant,
            path_weights: weights,
        };
        null_collision_probabilities(rule, absorption, &collision)
    }
}

/// Path weights times their probability, of the paths through a slab by what they end with.
#[derive(Default)]
struct Outcome {
    passed: [f64; 3],
    scattered_once: [f64; 3],
    absorbed: [f64; 3],
}

fn add(sum: &mut [f64; 3], chance: f64, weights: &[f64; 3]) {
    for (sum, weight) in sum.iter_mut().zip(weights) {
        *sum += chance * weight;
    }
}

/// A slab of the length 1 that scatters forwards only, followed to its first absorption or second
/// scattering.
struct Slab<'a> {
    medium: &'a Coefficients,
    rule: EventRule,
    absorption: Absorption,
    /// Probability that a flight of optical depth σ̄ has k collisions, and that it has k or more.
    exactly: Vec<f64>,
    at_least: Vec<f64>,
}

impl Slab<'_> {
    fn new(medium: &Coefficients, rule: EventRule, absorption: Absorption) -> Slab<'_> {
        let next = |p: &f64, k: usize| p * medium.majorant / k as f64;
        let mut exactly = vec![(-medium.majorant).exp()];
        for k in 1..60 {
            exactly.push(next(&exactly[k - 1], k));
        }
        let at_least = (0..exactly.len()).map(|k| exactly[k..].iter().sum());
        Slab {
            medium,
            rule,
            absorption,
            at_least: at_least.collect(),
            exactly,
        }
    }

    /// All that may follow `k` collisions, by the events so far.
    fn follow(&self, k: usize, scattered: bool, chance: f64, weights: [f64; 3], to: &mut Outcome) {
        let end = if scattered {
            &mut to.scattered_once
        } else {
            &mut to.passed
        };
        add(end, chance * self.exactly[k], &weights);
        if k + 1 == self.exactly.len() {
            return;
        }
        let events = self.medium.events(self.rule, self.absorption, &weights);
        let after = |event: usize| std::array::from_fn(|i| weights[i] * events.weights[event][i]);
        let [absorption, scattering, null] = events.probabilities.map(|p| chance * p);
        if !scattered {
            let collides = self.at_least[k + 1];
            add(&mut to.absorbed, absorption * collides, &after(0));
            self.follow(k + 1, true, scattering, after(1), to);
        }
        self.follow(k + 1, scattered, null, after(2), to);
    }
}

/// Transmittance, single scattering and absorption of a homogeneous slab, as expected values over
/// all sequences of events, are the closed forms at each wavelength, by every rule.
#[test]
fn tracking_is_unbiased() {
    for medium in media() {
        for (rule, absorption) in choices() {
            let mut got = Outcome::default();
            let slab = Slab::new(&medium, rule, absorption);
            slab.follow(0, false, 1.0, [1.0, 0.5, 2.0], &mut got);
            for (i, start) in [1.0, 0.5, 2.0].into_iter().enumerate() {
                let what = format!("{} {rule:?} {absorption:?} {i}", medium.name);
                let sigma_t = medium.sigma_t(i);
                let through = start * (-sigma_t).exp();
                close(got.passed[i], through, 1e-14, &what);
                close(
                    got.scattered_once[i],
                    medium.sigma_s[i] * through,
                    1e-14,
                    &what,
                );
                let absorbed = if absorption == Absorption::Weighted {
                    0.0
                } else {
                    start * medium.sigma_a[i] * opacity(sigma_t)
                };
                close(got.absorbed[i], absorbed, 1e-14, &what);
            }
        }
    }
}

/// (1 − e^(−σ))/σ.
fn opacity(sigma_t: f64) -> f64 {
    if sigma_t > 0.0 {
        -(-sigma_t).exp_m1() / sigma_t
    } else {
        1.0
    }
}

fn random_medium(random: &mut Random) -> (Coefficients, [f64; 3]) {
    let sigma = |random: &mut Random| -> [f64; 3] {
        std::array::from_fn(|_| {
            if random.unit() < 0.2 {
                0.0
            } else {
                random.magnitude(1e-6, 1e3)
            }
        })
    };
    let (sigma_a, sigma_s) = (sigma(random), sigma(random));
    let most = (0..3).map(|i| sigma_a[i] + sigma_s[i]).fold(0.0, f64::max);
    let majorant = most * random.pick(&[1.0, 1.0, 1.5, 10.0]);
    let medium = Coefficients {
        name: "random",
        sigma_a,
        sigma_s,
        majorant,
    };
    let weights = std::array::from_fn(|_| random.pick(&[0.0, 1e-12, 1e-3, 1.0, 7.0]));
    (medium, weights)
}

/// Probabilities sum to 1, are 0 only where there is nothing, and times the weights they are
/// the coefficients over the majorant.
#[test]
fn probabilities_are_probabilities() {
    let mut random = Random::with_seed(32);
    for _ in 0..2000 {
        let (medium, weights) = random_medium(&mut random);
        for (rule, absorption) in choices() {
            let events = medium.events(rule, absorption, &weights);
            let (a, s) = (medium.sigma_a, medium.sigma_s);
            let what = format!("{a:?} {s:?} {weights:?} {rule:?} {absorption:?}");
            close(events.probabilities.iter().sum(), 1.0, 4e-16, &what);
            for event in 0..3 {
                let weighted = event == 0 && absorption == Absorption::Weighted;
                let may_happen = !weighted && medium.has(event, rule, &weights);
                let nothing_else = event == 2 && events.probabilities[2] == 1.0;
                let happens = events.probabilities[event] > 0.0;
                assert_eq!(happens, may_happen || nothing_else, "{what} {event}");
                assert!(
                    events.weights[event].iter().all(|w| w.is_finite()),
                    "{what}"
                );
                if may_happen {
                    check_weights(&medium, &events, event, &what);
                }
            }
        }
    }
}

fn check_weights(medium: &Coefficients, events: &Events<f64>, event: usize, what: &str) {
    for (i, weight) in events.weights[event].iter().enumerate() {
        let expected = medium.sigma(event, i) / medium.majorant;
        close(events.probabilities[event] * weight, expected, 1e-14, what);
    }
}

/// By history, a collision leaves the sum of the path weights as it was; with absorption as a
/// weight, it does not grow.
#[test]
fn history_keeps_the_sum_of_weights() {
    let mut random = Random::with_seed(33);
    for _ in 0..500 {
        let (medium, weights) = random_medium(&mut random);
        let total: f64 = weights.iter().sum();
        if total == 0.0 || medium.majorant == 0.0 {
            continue;
        }
        for absorption in ABSORPTIONS {
            let events = medium.events(EventRule::History, absorption, &weights);
            for event in 0..3 {
                if events.probabilities[event] == 0.0 {
                    continue;
                }
                let terms = weights.iter().zip(&events.weights[event]);
                let after: f64 = terms.map(|(w, factor)| w * factor).sum();
                if absorption == Absorption::Sampled {
                    close(after / total, 1.0, 1e-13, "sum of weights");
                } else {
                    assert!(after <= total * (1.0 + 1e-13), "{after} {total}");
                }
            }
        }
    }
}

/// Without a majorant, without weights, with nothing but absorption.
#[test]
fn collisions_have_edges() {
    let [clear, black] = [(0.0, 0.0), (0.7, 0.7)].map(|(sigma, majorant)| Coefficients {
        name: "edge",
        sigma_a: [sigma; 3],
        sigma_s: [0.0; 3],
        majorant,
    });
    for (rule, absorption) in choices() {
        for weights in [[1.0; 3], [0.0; 3], [0.0, 1e-300, 0.0]] {
            let events = clear.events(rule, absorption, &weights);
            assert_eq!(events.probabilities, [0.0, 0.0, 1.0]);
            assert_eq!(events.weights[2].to_vec(), [1.0; 3]);
            let events = black.events(rule, absorption, &weights);
            if absorption == Absorption::Weighted {
                assert_eq!(events.probabilities, [0.0, 0.0, 1.0]);
                assert_eq!(events.weights[2].to_vec(), [0.0; 3]);
            } else {
                assert_eq!(events.probabilities, [1.0, 0.0, 0.0]);
                assert_eq!(events.weights[0].to_vec(), [1.0; 3]);
            }
        }
    }
    // Weights that are all 0 count as equal.
    let medium = &media()[1];
    let equal = medium.events(EventRule::Average, Absorption::Sampled, &[1.0; 3]);
    let dead = medium.events(EventRule::History, Absorption::Sampled, &[0.0; 3]);
    assert_eq!(equal.probabilities, dead.probabilities);
    // An event that only wavelengths of next to no weight have: a limited weight.
    let rare = Coefficients {
        name: "rare",
        sigma_a: [1.0, 0.0, 0.0],
        sigma_s: [0.0, 1.0, 1.0],
        majorant: 1.0,
    };
    let events = rare.events(EventRule::History, Absorption::Sampled, &[1e-200, 1.0, 1.0]);
    assert_eq!(events.weights[0][0], 1e150);
}

/// One wavelength: σ/σ̄, and weights of 1 where absorption is sampled.
#[test]
fn one_wavelength_is_delta_tracking() {
    for rule in RULES {
        let collision = Collision {
            sigma_a: &[0.25],
            sigma_s: &[0.5],
            majorant: 1.0,
            path_weights: &[0.3],
        };
        let events = null_collision_probabilities(rule, Absorption::Sampled, &collision);
        assert_eq!(events.probabilities, [0.25, 0.5, 0.25]);
        assert!(events.weights.iter().all(|weights| weights[..] == [1.0]));
        let events = null_collision_probabilities(rule, Absorption::Weighted, &collision);
        close(events.probabilities[1], 2.0 / 3.0, 1e-15, "(74)");
        assert_eq!(events.probabilities[0], 0.0);
        close(events.weights[1][0], 0.75, 1e-15, "(74)");
    }
    assert_eq!(hero_probabilities(&[-0.3])[0], 1.0);
}

// ---- Both

/// Wavelengths in another order give the same in that order.
#[test]
fn order_does_not_matter() {
    let turn = |x: [f64; 3]| [x[2], x[0], x[1]];
    let mut random = Random::with_seed(34);
    for _ in 0..300 {
        let (medium, weights) = random_medium(&mut random);
        let turned = Coefficients {
            sigma_a: turn(medium.sigma_a),
            sigma_s: turn(medium.sigma_s),
            ..medium
        };
        for (rule, absorption) in choices() {
            let a = medium.events(rule, absorption, &weights);
            let b = turned.events(rule, absorption, &turn(weights));
            for event in 0..3 {
                close(
                    b.probabilities[event],
                    a.probabilities[event],
                    1e-15,
                    "probability",
                );
                for i in 0..3 {
                    let expected = a.weights[event][(i + 2) % 3];
                    close(b.weights[event][i], expected, 1e-14, "weight");
                }
            }
        }
        let logs = medium.sigma_a.map(|x| -x);
        let heroes: [f64; 3] = std::array::from_fn(|i| hero_probabilities(&weights)[i]);
        let a = spectral_mis_weights(&logs, &heroes);
        let b = spectral_mis_weights(&turn(logs), &turn(heroes));
        for i in 0..3 {
            close(b[i], a[(i + 2) % 3], 1e-14, "weight");
        }
    }
}

/// f32, lanes and recorded nodes against the formulas in f64.
#[test]
fn every_arithmetic_agrees() {
    in_every_arithmetic!(check_arithmetic);
}

fn check_arithmetic<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(a: &Arithmetic<L, O>) {
    let mut random = Random::with_seed(35);
    let lift = |x: &[f64]| -> Vec<R> { x.iter().map(|x| (a.lift)(*x)).collect() };
    let mut worst: f64 = 0.0;
    let mut compare = |got: R, expected: f64, what: &str| {
        let limit = if a.single { 1e15 } else { 1e150 };
        let (got, expected) = ((a.lower)(got), expected.min(limit));
        let error = (got - expected).abs() / expected.abs().max(1.0);
        assert!(
            error <= 20.0 * a.roundoff(),
            "{} {what}: {got} {expected}",
            a.name
        );
        worst = worst.max(error / a.roundoff());
    };
    for _ in 0..200 {
        let (mut medium, weights) = random_medium(&mut random);
        let weights = weights.map(|x| a.round(x));
        medium.sigma_a = medium.sigma_a.map(|x| a.round(x));
        medium.sigma_s = medium.sigma_s.map(|x| a.round(x));
        // Without the cancellation of a tight majorant, which is that of the arguments.
        medium.majorant = a.round(2.0 * medium.majorant);
        let (sigma_a, sigma_s) = (lift(&medium.sigma_a), lift(&medium.sigma_s));
        let collision = Collision {
            sigma_a: &sigma_a,
            sigma_s: &sigma_s,
            majorant: (a.lift)(medium.majorant),
            path_weights: &lift(&weights),
        };
        for (rule, absorption) in choices() {
            let exact = medium.events(rule, absorption, &weights);
            let got = null_collision_probabilities(rule, absorption, &collision);
            for event in 0..3 {
                compare(
                    got.probabilities[event],
                    exact.probabilities[event],
                    "probability",
                );
                for (got, exact) in got.weights[event].iter().zip(&exact.weights[event]) {
                    compare(*got, *exact, "weight");
                }
            }
        }
        let logs = medium.sigma_s.map(|x| -x);
        let heroes = hero_probabilities(&weights)
            .iter()
            .map(|x| a.round(*x))
            .collect::<Vec<_>>();
        let exact = spectral_mis_weights(&logs, &heroes);
        let got = spectral_mis_weights(&lift(&logs), &lift(&heroes));
        for ((got, exact), q) in got.iter().zip(&exact).zip(&heroes) {
            if *q > 0.0 {
                compare(*got, *exact, "MIS weight");
            }
        }
        for (got, exact) in hero_probabilities(&lift(&weights)).iter().zip(&heroes) {
            compare(*got, *exact, "hero");
        }
    }
    println!("{}: worst error {worst:.1} roundoffs", a.name);
}

type Number = Dual<f64, 10>;

/// Derivatives by all numbers: those of differences where the formula is smooth, and finite at its
/// edges.
#[test]
fn derivatives_are_finite() {
    let evaluate = |rule, absorption, x: &[Number; 10]| {
        let collision = Collision {
            sigma_a: &x[0..3],
            sigma_s: &x[3..6],
            majorant: x[6],
            path_weights: &x[7..10],
        };
        let events = null_collision_probabilities(rule, absorption, &collision);
        let mis = spectral_mis_weights(&x[3..6], &hero_probabilities(&x[7..10]));
        let weights = events.weights.into_iter().flatten().chain(mis);
        events
            .probabilities
            .into_iter()
            .chain(weights)
            .collect::<Vec<_>>()
    };
    let inputs = |x: &[f64; 10]| std::array::from_fn(|i| Number::variable(x[i], i));
    let smooth = [0.1, 0.6, 0.2, 2.0, 0.3, 1.0, 2.5, 0.4, 1.0, 0.2];
    let edges = [
        [0.0; 10],
        [0.1, 0.6, 0.2, 0.0, 0.0, 0.0, 0.6, 0.0, 0.0, 1.0],
        [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0],
        [
            0.0,
            0.0,
            0.0,
            f64::NEG_INFINITY,
            -1e3,
            0.0,
            0.0,
            0.0,
            1.0,
            0.0,
        ],
    ];
    for (rule, absorption) in choices() {
        let results = evaluate(rule, absorption, &inputs(&smooth));
        for i in 0..10 {
            let step = 1e-6;
            let shifted = |sign: f64| {
                let mut moved = smooth;
                moved[i] += sign * step;
                evaluate(rule, absorption, &inputs(&moved))
            };
            for ((result, above), below) in results.iter().zip(shifted(1.0)).zip(shifted(-1.0)) {
                let expected = (above.value - below.value) / (2.0 * step);
                close(result.gradient[i], expected, 1e-7, "derivative");
            }
        }
        for edge in &edges {
            for result in evaluate(rule, absorption, &inputs(edge)) {
                let finite =
                    result.value.is_finite() && result.gradient.iter().all(|g| g.is_finite());
                assert!(finite, "{rule:?} {absorption:?} {edge:?}: {result:?}");
            }
        }
    }
}
