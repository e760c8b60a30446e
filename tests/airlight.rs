//! Air-light against the reference table, in every arithmetic.
//!
//! All rows of airlight.json, to 1e-9 in double and 1e-4 in single precision. Single precision is
//! compared with double precision of the rounded arguments, which is tested against the table.
//! Worst errors per regime: `--nocapture`.

mod common;

use analytic_media::real::Real;
use common::arithmetic::{Arithmetic, Errors, in_every_arithmetic};
use common::lamps::scene;
use common::rows::{number, table};

fn rows<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(a: &Arithmetic<L, O>) {
    let mut errors = Errors::new();
    let tolerance = if a.single { 1e-4 } else { 1e-9 };
    for row in table("airlight") {
        let (air, ray, t0, t1) = scene(&row, &a.lift);
        let got = (a.lower)(air.radiance(&ray, t0, t1)[0]);
        let expected = if a.single {
            let (air, ray, t0, t1) = scene(&row, |x| a.round(x));
            air.radiance(&ray, t0, t1)[0]
        } else {
            number(&row["L"])
        };
        let size = expected.max(a.least());
        let error = if got == expected {
            0.0
        } else {
            (got - expected).abs() / size
        };
        assert!(got.is_finite(), "{}: {got} {row}", a.name);
        assert!(
            error <= tolerance,
            "{}: {got:e}, expected {expected:e}, error {error:e}: {row}",
            a.name
        );
        let regime = row["regime"].as_str().expect("a row has a regime");
        let regime = regime.split('_').take(3).collect::<Vec<_>>().join(" ");
        errors.entry(regime).or_default().push((error, tolerance));
    }
    a.print("relative error of radiance", &errors);
}

#[test]
fn radiance_matches_the_table() {
    in_every_arithmetic!(rows);
}
