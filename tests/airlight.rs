//! Air-light against the reference table, in every arithmetic.
//!
//! All rows of airlight.json, to 1e-9 in double and 1e-4 in single precision. Single precision is
//! compared with double precision of the rounded arguments, which is tested against the table.
//! Worst errors per regime: `--nocapture`.

mod common;

use analytic_media::airlight::AirLight;
use analytic_media::airlight::light::{Intensity, Light};
use analytic_media::airlight::phase::Phase;
use analytic_media::geometry::Ray;
use analytic_media::real::Real;
use common::arithmetic::{Arithmetic, Errors, in_every_arithmetic};
use common::rows::{number, point, table};
use serde_json::Value;

/// The medium, light, ray and segment of a row.
fn scene<R: Real>(row: &Value, lift: impl Fn(f64) -> R) -> (AirLight<R>, Ray<R>, R, R) {
    let get = |key: &str| lift(number(&row[key]));
    let exponent = row["light"]["p"].as_u64().unwrap_or(0) as u32;
    let intensity = match row["light"]["type"].as_str().expect("a light has a type") {
        "isotropic" => Intensity::Isotropic,
        "lobes" => Intensity::Lobes { exponent },
        "spot" => Intensity::Spot { exponent },
        other => panic!("{other} is not a light of the table"),
    };
    let phase = match row["phase"]["type"].as_str().expect("a phase has a type") {
        "isotropic" => Phase::Isotropic,
        "rayleigh" => Phase::Rayleigh,
        "hg" => Phase::HenyeyGreenstein {
            g: lift(number(&row["phase"]["g"])),
        },
        other => panic!("{other} is not a phase function of the table"),
    };
    let air = AirLight {
        light: Light {
            position: [get("x_h"), get("h"), lift(0.0)],
            axis: point(&row["v_l"]).map(&lift),
            intensity,
        },
        phase,
        sigma_s: vec![get("kappa_s")],
        sigma_t: vec![get("kappa_t")],
    };
    let ray = Ray {
        origin: [0.0, 0.0, 0.0].map(&lift),
        direction: [1.0, 0.0, 0.0].map(&lift),
    };
    (air, ray, get("x_a"), get("x_b"))
}

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
