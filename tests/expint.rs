//! Exponential integrals against expint.json, in every arithmetic.
//!
//! All rows, to 1e-12 in double and 2e-6 in single precision: Ei, Ei beyond its jump, the scaled
//! form, E₁ and its scaled form. The error of a complex number is that of the point in the plane.
//! Rows whose arguments single precision does not hold are compared with double precision of the
//! rounded arguments, and values that it does not hold are left out. Worst errors per regime:
//! `--nocapture`.

mod common;

use analytic_media::real::Real;
use analytic_media::special::expint::{e1, e1_scaled, ei, ei_scaled, unjumped};
use common::arithmetic::{Arithmetic, Errors, in_every_arithmetic};
use common::rows::{number, table};
use serde_json::Value;

/// Compares `got` with the numbers of the row called `keys`.
fn check<L, O>(
    a: &Arithmetic<L, O>,
    errors: &mut Errors,
    row: &Value,
    keys: [&str; 2],
    got: [f64; 2],
    rounded: &dyn Fn() -> [f64; 2],
) {
    let expected = if a.single && row["f32"] == false {
        rounded()
    } else {
        keys.map(|key| match key {
            "" => 0.0,
            _ => number(&row[key]),
        })
    };
    let size = expected[0].hypot(expected[1]);
    // An exponential near the ends of the range has fewer digits, or none.
    if size > 0.1 * a.largest() || size < 1e3 * a.least() {
        return;
    }
    let error = (got[0] - expected[0]).hypot(got[1] - expected[1]) / size;
    let tolerance = if a.single { 2e-6 } else { 1e-12 };
    assert!(
        error <= tolerance,
        "{}: {keys:?} is {got:?}, error {error:e}: {row}",
        a.name
    );
    let regime = row["regime"].as_str().expect("a row has a regime");
    let regime = format!("{regime} {}", keys[0]);
    errors.entry(regime).or_default().push((error, tolerance));
}

fn rows<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(a: &Arithmetic<L, O>) {
    let mut errors = Errors::new();
    for row in table("expint") {
        let argument = |key: &str| number(&row[key]);
        let x = argument("x");
        let mut check = |keys, got: [f64; 2], rounded: &dyn Fn() -> [f64; 2]| {
            check(a, &mut errors, &row, keys, got, rounded);
        };
        if row["kind"] == "E1" {
            let (lifted, x) = ((a.lift)(x), a.round(x));
            let real = |value: R| [(a.lower)(value), 0.0];
            check(["e1", ""], real(e1(lifted)), &|| [e1(x), 0.0]);
            check(["exp_x_e1", ""], real(e1_scaled(lifted)), &|| {
                [e1_scaled(x), 0.0]
            });
            continue;
        }
        let y = argument("y");
        let (re, im) = ((a.lift)(x), (a.lift)(y));
        let (x, y) = (a.round(x), a.round(y));
        let lower = |value: [R; 2]| value.map(&a.lower);
        check(
            ["scaled_re", "scaled_im"],
            lower(ei_scaled(re, im)),
            &|| ei_scaled(x, y),
        );
        check(["re", "im"], lower(ei(re, im)), &|| ei(x, y));
        check(["re", "im_minus_sgn_pi"], lower(unjumped(re, im)), &|| {
            unjumped(x, y)
        });
    }
    a.print("error", &errors);
}

#[test]
fn exponential_integrals_match_the_table() {
    in_every_arithmetic!(rows);
}
