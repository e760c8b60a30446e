//! Sine, cosine and the angle of a point against the standard library.
//!
//! The bounds are those of the table in `src/special/angle.rs`.

mod common;

use analytic_media::real::dual::Dual;
use analytic_media::special::angle::{atan2, sin_cos};
use common::random::Random;

const POINTS: usize = 100_000;

/// Angles of both signs: tiny, of order 1, large, and next to the multiples of π/4.
fn angles(seed: u64) -> impl Iterator<Item = f64> {
    let mut random = Random::with_seed(seed);
    (0..POINTS).map(move |i| match i % 4 {
        0 => random.magnitude(1e-12, 1.0),
        1 => random.between(-10.0, 10.0),
        2 => random.between(-1000.0, 1000.0),
        _ => {
            let step = random.between(-1200.0, 1200.0).round() * std::f64::consts::FRAC_PI_4;
            step + random.between(-1e-6, 1e-6)
        }
    })
}

#[test]
fn sine_and_cosine() {
    let (mut single, mut double) = (0.0f64, 0.0f64);
    for x in angles(1) {
        let (sin, cos) = sin_cos(x);
        double = double.max((sin - x.sin()).abs()).max((cos - x.cos()).abs());
        let rounded = x as f32;
        let (sin, cos) = sin_cos(rounded);
        let x = f64::from(rounded);
        let error = |got: f32, exact: f64| (f64::from(got) - exact).abs();
        single = single.max(error(sin, x.sin())).max(error(cos, x.cos()));
    }
    println!("sin, cos: f64 {double:.2e}, f32 {single:.2e}");
    assert!(double <= 2e-16 && single <= 1e-7);
}

#[test]
fn angle_of_a_point() {
    let mut random = Random::with_seed(2);
    let (mut single, mut double) = (0.0f64, 0.0f64);
    for i in 0..POINTS {
        let sign = |k: usize| if i >> k & 1 == 0 { 1.0 } else { -1.0 };
        let y = sign(0) * random.magnitude(1e-6, 1e3);
        let x = sign(1) * random.magnitude(1e-6, 1e3);
        double = double.max((atan2(y, x) / y.atan2(x) - 1.0).abs());
        let (y, x) = (y as f32, x as f32);
        let exact = f64::from(y).atan2(f64::from(x));
        single = single.max((f64::from(atan2(y, x)) / exact - 1.0).abs());
    }
    println!("atan2: f64 {double:.2e}, f32 {single:.2e}");
    assert!(double <= 8e-16 && single <= 4e-7);
    assert_eq!(atan2(0.0, 0.0), 0.0);
    assert_eq!(atan2(0.0, 2.0), 0.0);
    assert_eq!(atan2(2.0, 0.0), std::f64::consts::FRAC_PI_2);
    assert_eq!(atan2(0.0, -2.0), std::f64::consts::PI);
}

/// Rounding to the next integer has no derivative.
#[test]
fn derivatives() {
    for x in angles(3).take(1000) {
        let (sin, cos) = sin_cos(Dual::<f64, 1>::variable(x, 0));
        assert!((sin.gradient[0] - cos.value).abs() <= 1e-13, "{x}");
        assert!((cos.gradient[0] + sin.value).abs() <= 1e-13, "{x}");
    }
}
