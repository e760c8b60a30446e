//! φ and ψ against `exp_m1` and `ln_1p`, which are good to an ulp.
//!
//! The bounds are those of the table in `src/special/mod.rs`.

mod common;

use analytic_media::special::rel::{phi, psi};
use common::random::Random;

const POINTS: usize = 200_000;

/// Largest relative error of `got` over log-spaced arguments.
fn worst(arguments: impl Iterator<Item = f64>, got: impl Fn(f64) -> (f64, f64)) -> f64 {
    let error = |x| {
        let (got, expected) = got(x);
        assert!(got > 0.0, "not positive at {x:e}");
        (got - expected).abs() / expected
    };
    arguments.map(error).fold(0.0, f64::max)
}

fn phi_exact(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { -(-x).exp_m1() / x }
}

fn psi_exact(y: f64) -> f64 {
    if y == 0.0 { 1.0 } else { -(-y).ln_1p() / y }
}

/// Arguments of φ: from nothing to beyond the range of exp, denser around the switch at 1.
fn phi_arguments(seed: u64) -> impl Iterator<Item = f64> {
    let mut random = Random::with_seed(seed);
    (0..POINTS).map(move |i| match i % 3 {
        0 => random.magnitude(1e-20, 1e4),
        1 => random.between(0.0, 3.0),
        _ => random.between(0.9, 1.1),
    })
}

/// Arguments of ψ: both signs, close to 1, and denser around the switches at −1 and 1/2.
fn psi_arguments(seed: u64) -> impl Iterator<Item = f64> {
    let mut random = Random::with_seed(seed);
    (0..POINTS).map(move |i| match i % 5 {
        0 => -random.magnitude(1e-20, 1e15),
        1 => random.between(-2.0, 0.9),
        2 => 1.0 - random.magnitude(1e-9, 1.0),
        3 => random.between(-1.1, -0.9),
        _ => random.between(0.4, 0.6),
    })
}

#[test]
fn phi_in_double_precision() {
    let error = worst(phi_arguments(1), |x| (phi(x), phi_exact(x)));
    println!("phi f64 {error:.2e}");
    assert!(error <= 4e-16, "{error:e}");
}

#[test]
fn phi_in_single_precision() {
    let round = |x: f64| f64::from(x as f32);
    let error = worst(phi_arguments(2).map(round), |x| {
        (f64::from(phi(x as f32)), phi_exact(x))
    });
    println!("phi f32 {error:.2e}");
    assert!(error <= 2e-7, "{error:e}");
}

#[test]
fn psi_in_double_precision() {
    let error = worst(psi_arguments(3), |y| (psi(y), psi_exact(y)));
    println!("psi f64 {error:.2e}");
    assert!(error <= 5e-16, "{error:e}");
}

#[test]
fn psi_in_single_precision() {
    let round = |y: f64| f64::from(y as f32);
    let inside = psi_arguments(4).map(round).filter(|y| *y < 1.0);
    let error = worst(inside, |y| (f64::from(psi(y as f32)), psi_exact(y)));
    println!("psi f32 {error:.2e}");
    assert!(error <= 2e-7, "{error:e}");
}

/// φ(0) = ψ(0) = 1 exactly: a horizontal ray is the uniform medium bit for bit.
#[test]
fn both_are_one_at_zero() {
    assert_eq!((phi(0.0f64), phi(0.0f32)), (1.0, 1.0));
    assert_eq!((psi(0.0f64), psi(0.0f32), psi(-0.0f64)), (1.0, 1.0, 1.0));
}

/// y = x φ(x) and x = y ψ(y).
#[test]
fn they_undo_each_other() {
    let mut random = Random::with_seed(5);
    for _ in 0..10_000 {
        let x = random.magnitude(1e-12, 10.0);
        let y = x * phi(x);
        let back = y * psi(y);
        // dx/dy = 1/(1 − y)
        assert!(
            (back - x).abs() <= 1e-15 * (x + y / (1.0 - y)),
            "{x:e} {back:e}"
        );
    }
}
