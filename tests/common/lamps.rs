//! Lights, media and segments of airlight.json.

use super::rows::{number, point};
use analytic_media::airlight::AirLight;
use analytic_media::airlight::light::{Intensity, Light};
use analytic_media::airlight::phase::Phase;
use analytic_media::geometry::Ray;
use analytic_media::real::Real;
use serde_json::Value;

/// The medium, light, ray and segment of a row.
pub fn scene<R: Real>(row: &Value, lift: impl Fn(f64) -> R) -> (AirLight<R>, Ray<R>, R, R) {
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
