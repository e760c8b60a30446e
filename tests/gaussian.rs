//! The Gaussian along a ray: its integral against Simpson's rule, the estimate that inversion
//! starts from, and the residual of the inverse.

mod common;

use analytic_media::real::Real;
use analytic_media::special::gaussian::Bell;
use common::random::Random;

/// A Gaussian of any width that is not denser than 1, and a ray from within 25 standard
/// deviations of its perigee.
fn bell(random: &mut Random, widest: f64) -> Bell<f64> {
    let rate = random.magnitude(1e-6, 1e6);
    let x = random.sign() * random.magnitude(1e-6, widest);
    let least = random.pick(&[0.0, 1.0, 10.0]) * random.unit();
    Bell {
        along: x / rate,
        rate,
        exponent: x.mul_add(x, least),
        least,
    }
}

fn lift<R: Real>(bell: &Bell<f64>, lift: impl Fn(f64) -> R) -> Bell<R> {
    Bell {
        along: lift(bell.along),
        rate: lift(bell.rate),
        exponent: lift(bell.exponent),
        least: lift(bell.least),
    }
}

/// Simpson's rule with 20 000 intervals.
fn simpson(bell: &Bell<f64>, t: f64) -> f64 {
    let n = 20_000;
    let at = |k: usize| bell.density_along(t * k as f64 / n as f64).0;
    let sum = (0..n / 2).map(|k| at(2 * k) + 4.0 * at(2 * k + 1) + at(2 * k + 2));
    sum.sum::<f64>() * t / n as f64 / 3.0
}

#[test]
fn columns_are_integrals_of_the_density() {
    let mut random = Random::with_seed(1);
    let mut worst = (0.0f64, 0.0f64);
    for _ in 0..500 {
        let bell = bell(&mut random, 8.0);
        let t = random.magnitude(1e-3, 20.0) / bell.rate;
        let expected = simpson(&bell, t);
        let error = (bell.column(t) / expected - 1.0).abs();
        let single = lift(&bell, |x| x as f32);
        let got = f64::from(single.column(t as f32));
        let condition = 1.0 + bell.exponent;
        worst.0 = worst.0.max(error);
        if expected > 1e-30 / bell.rate {
            worst.1 = worst.1.max((got / expected - 1.0).abs() / condition);
        }
    }
    println!(
        "worst relative error {:.1e}, in f32 over 1 + E {:.1e}",
        worst.0, worst.1
    );
    assert!(worst.0 < 1e-10, "Simpson's rule is no better");
    assert!(worst.1 < 4e-7);
}

/// What inversion leaves: |N(t) − N| over N, and over what a rounded exponent does to N.
fn residual<R: Real + Into<f64>>(bell: &Bell<f64>, share: f64, of: impl Fn(f64) -> R) -> f64 {
    let bell = lift(bell, &of);
    let total: f64 = bell.column(of(f64::INFINITY)).into();
    let column = of(total * share);
    let plain: f64 = column.into();
    if plain < 1e-30 {
        return 0.0; // nothing
    }
    let t = bell.inv_column(column);
    let got: f64 = bell.column(t).into();
    let exponent: f64 = bell.exponent.into();
    (got - plain).abs() / plain / (1.0 + exponent)
}

#[test]
fn inverses_undo_columns() {
    let mut random = Random::with_seed(2);
    let (mut double, mut single) = ((0.0, String::new()), (0.0, String::new()));
    for _ in 0..100_000 {
        let narrow = bell(&mut random, 6.0);
        let wide = bell(&mut random, 25.0);
        let share = match random.index(3) {
            0 => random.magnitude(1e-12, 1.0),
            1 => 1.0 - random.magnitude(1e-6, 1.0),
            _ => random.unit(),
        };
        let error = residual(&wide, share, |x| x);
        if error > double.0 || error.is_nan() {
            double = (error, format!("{share:e} {wide:?}"));
        }
        let error = residual(&narrow, share, |x| x as f32);
        if error > single.0 || error.is_nan() {
            single = (error, format!("{share:e} {narrow:?}"));
        }
    }
    println!("worst residual f64 {double:?}\n f32 {single:?}");
    assert!(double.0 < 1e-12, "{double:?}");
    assert!(single.0 < 1e-6, "{single:?}");
}

/// The estimate lies within 0.6 % of the inverse, but in the last thousandth of the matter.
#[test]
fn estimates_are_close() {
    let mut random = Random::with_seed(3);
    let mut worst = (0.0, String::new());
    let mut sum = 0.0;
    let cases = 100_000;
    for _ in 0..cases {
        let bell = bell(&mut random, 25.0);
        let total = bell.column(f64::INFINITY);
        let share = match random.index(2) {
            0 => random.magnitude(1e-12, 1.0),
            _ => random.unit(),
        };
        let column = total * share.min(0.999);
        if column == 0.0 {
            continue;
        }
        let (t, guess) = (bell.inv_column(column), bell.guess(column));
        let error = (guess / t - 1.0).abs();
        sum += error;
        if error > worst.0 || error.is_nan() {
            worst = (error, format!("{share:e} {bell:?} {t:e} {guess:e}"));
        }
    }
    println!("worst {worst:?}, mean {:.1e}", sum / f64::from(cases));
    assert!(worst.0 < 6e-3, "{worst:?}");
}
