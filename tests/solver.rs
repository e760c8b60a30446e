//! Free flight through sums of components: the residual, and the steps that it takes.
//!
//! Random sums of two to four components of every kind, seen in every direction, through
//! finite and infinite segments; optical depths from 1e-8 of what the segment holds to
//! 1 − 1e-6 of it.

mod common;

use analytic_media::profile::Kind;
use analytic_media::real::Real;
use analytic_media::sampling;
use common::counted::{Counted, questions};
use common::random::{Random, medium, ray};

const CASES: usize = 50_000;

/// An arithmetic, and what is asked of it.
struct Arithmetic<L, O> {
    lift: L,
    lower: O,
    roundoff: f64,
    target: f64,
}

/// What a solve of each case took.
struct Steps(Vec<usize>);

impl Steps {
    fn mean(&self) -> f64 {
        self.0.iter().sum::<usize>() as f64 / self.0.len() as f64
    }

    /// How many solves took more than `limit` steps.
    fn beyond(&self, limit: usize) -> usize {
        self.0.iter().filter(|n| **n > limit).count()
    }
}

/// A part of `total`, or any optical depth if the total is not a number to take parts of.
fn target_depth(random: &mut Random, total: f64) -> f64 {
    let part = match random.index(3) {
        0 => random.magnitude(1e-8, 1.0),
        1 => 1.0 - random.magnitude(1e-6, 1.0),
        _ => random.unit(),
    };
    let plain = random.magnitude(1e-6, 50.0);
    if total < 1e30 && random.unit() < 0.75 {
        part * total
    } else {
        plain
    }
}

/// Solves random cases, checks |τ(t) − τ| and returns the steps. `any` of a mask is asked
/// once per step.
fn solve<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(a: &Arithmetic<L, O>) -> Steps {
    let mut random = Random::with_seed(20);
    let mut steps = Vec::new();
    for case in 0..CASES {
        let lift = |x| Counted((a.lift)(x));
        let round = |x| (a.lower)((a.lift)(x));
        let components = random.components();
        let (m, r) = (medium(&components, lift), ray(&random.ray(10.0), lift));
        let t_max = round(random.pick(&[f64::INFINITY, 0.1, 1.0, 10.0, 1e3]));
        let depth = |t| (a.lower)(m.optical_depth(&r, lift(t)).next().expect("a channel").0);
        let extinction = |t| (a.lower)(m.extinction(r.at(lift(t))).next().expect("a channel").0);
        let total = depth(t_max);
        let (_, sup) = m.bounds(&r, lift(t_max)).next().expect("a channel");
        let tau = round(target_depth(&mut random, total));
        // Deep inside a planet the density grows beyond what the format can tell apart.
        if tau > total || tau == 0.0 || (a.lower)(sup.0) > 1e6 {
            continue;
        }

        let flight = || sampling::free_flight(&m, 0, &r, lift(t_max), lift(tau));
        let (t, count) = questions(flight);
        let t = (a.lower)(t.0);
        steps.push(count);
        if t.is_infinite() || t > 1e30 {
            assert!(
                a.roundoff > 1e-10 || t.is_finite(),
                "case {case}: t = {t:e}, but τ({t_max:e}) = {total:e}: {components:?} {r:?}"
            );
            continue;
        }
        // Rounding of positions and of t itself, times the attenuation there, and rounding of τ.
        let sigma = extinction(t).max(extinction(t * (1.0 + 4.0 * a.roundoff)));
        // Altitudes are rounded like the radius of the planet they are counted from.
        let scale = components.iter().map(|(kind, values, _)| match kind {
            Kind::Spherical => values[3] / values[4],
            Kind::Tent => values[3] / values[5],
            _ => 0.0,
        });
        let condition = 100.0 + 16.0 * scale.fold(0.0, f64::max);
        let rounding = a.roundoff * (8.0 * (30.0 + t) * sigma + condition * tau);
        let residual = (depth(t) - tau).abs();
        assert!(
            t <= t_max && residual <= a.target * tau.max(1.0) + rounding,
            "case {case}: τ({t:e}) is off by {residual:e} from {tau:e}, t_max {t_max:e}, \
             {count} steps: {components:?} {r:?}"
        );
    }
    assert!(steps.len() > CASES / 2, "most cases have a solution");
    Steps(steps)
}

/// One more evaluation of the column finds out whether the optical depth is reached at all, so
/// that there are less than three on average. A recorded solve takes 12 steps.
#[test]
fn sums_are_solved_in_double_precision() {
    let steps = solve(&Arithmetic {
        lift: |x| x,
        lower: |x| x,
        roundoff: f64::EPSILON / 2.0,
        target: 1e-12,
    });
    println!("f64: {:.2} steps on average", steps.mean());
    assert!(steps.mean() < 2.0);
    assert!(
        steps.beyond(6) * 1000 < steps.0.len(),
        "nearly all need at most 6"
    );
}

/// As above; a recorded single-precision solve takes 6 steps.
#[test]
fn sums_are_solved_in_single_precision() {
    let steps = solve(&Arithmetic {
        lift: |x| x as f32,
        lower: f64::from,
        roundoff: f64::from(f32::EPSILON) / 2.0,
        target: 1e-6,
    });
    println!("f32: {:.2} steps on average", steps.mean());
    assert!(steps.mean() < 1.9);
    assert!(
        steps.beyond(4) * 100 < steps.0.len(),
        "nearly all need at most 4"
    );
}
