//! The Chapman function, its relatives, and columns of spherical media, by the article's formulas and
//! by ours, against the reference tables. Prints tables in Markdown: `--nocapture`.

mod common;

use analytic_media::geometry::Ray;
use analytic_media::profile::{AnyProfile, Kind, Profile};
use analytic_media::special::approximations::{
    chapman_horizontal_huestis, chapman_huestis, erfcx_golubev,
};
use analytic_media::special::bessel::k1_scaled;
use analytic_media::special::chapman::chapman;
use analytic_media::special::erfcx::erfcx;
use common::article::{self, Scalar, Start};
use common::rows::{number, point, profile, regime, table};
use serde_json::Value;
use std::collections::BTreeMap;

/// The article's formula, from the radius and the cosine of a ray, which are rounded once.
fn article<R: Scalar>(row: &Value, values: &[f64], lift: impl Fn(f64) -> R) -> R {
    let (origin, direction) = (point(&row["origin"]), point(&row["dir"]));
    let d: [f64; 3] = std::array::from_fn(|i| origin[i] - values[i]);
    let radius = d.iter().map(|x| x * x).sum::<f64>().sqrt();
    let along: f64 = d.iter().zip(direction).map(|(x, e)| x * e).sum();
    let start = Start {
        radius: lift(radius),
        mu: lift((along / radius).clamp(-1.0, 1.0)),
    };
    article::column(
        start,
        lift(number(&row["t"])),
        lift(values[3]),
        lift(values[4]),
    )
}

/// Our formula, from coordinates, each of which is rounded.
fn ours<R: Scalar>(row: &Value, values: &[f64], lift: impl Fn(f64) -> R) -> R {
    let values: Vec<R> = values.iter().map(|x| lift(*x)).collect();
    let ray = Ray {
        origin: point(&row["origin"]).map(&lift),
        direction: point(&row["dir"]).map(&lift),
    };
    AnyProfile::from_values(Kind::Spherical, &values).column(&ray, lift(number(&row["t"])))
}

/// The worst relative error, and how many rows are not numbers although the result is.
#[derive(Clone, Copy, Default)]
struct Worst {
    error: f64,
    broken: usize,
}

impl Worst {
    fn see(&mut self, got: f64, expected: f64) {
        if got.is_finite() {
            self.error = self.error.max((got - expected).abs() / expected);
        } else {
            self.broken += 1;
        }
    }

    fn text(self) -> String {
        match self.broken {
            0 => format!("{:.1e}", self.error),
            n if self.error == 0.0 => format!("{n} not finite"),
            n => format!("{:.1e}; {n} not finite", self.error),
        }
    }
}

/// The worst errors by regime.
type Regimes = BTreeMap<String, (usize, [Worst; 4])>;

fn see(regimes: &mut Regimes, regime: String, got: [f64; 4], expected: f64) {
    let (rows, worst) = regimes.entry(regime).or_default();
    *rows += 1;
    for (worst, got) in worst.iter_mut().zip(got) {
        worst.see(got, expected);
    }
}

fn print(what: &str, regimes: &Regimes) {
    println!("| {what} | rows | article, `f32` | ours, `f32` | article, `f64` | ours, `f64` |");
    println!("|---|---|---|---|---|---|");
    for (name, (rows, worst)) in regimes {
        let cells = worst.map(Worst::text).join(" | ");
        println!("| {name} | {rows} | {cells} |");
    }
    println!();
}

/// Whether single precision holds a number.
fn is_single(x: f64) -> bool {
    (f64::from(f32::MIN_POSITIVE)..=f64::from(f32::MAX)).contains(&x)
}

/// The size of z as a regime.
fn size(z: f64) -> &'static str {
    match z {
        ..1.0 => "z < 1",
        1.0..10.0 => "1 ≤ z < 10",
        10.0..100.0 => "10 ≤ z < 100",
        100.0..1000.0 => "100 ≤ z < 1000",
        _ => "1000 ≤ z",
    }
}

/// Rows that single precision holds: the functions themselves, not what rounding of arguments does.
fn single_rows(name: &str) -> impl Iterator<Item = Value> {
    table(name).into_iter().filter(|row| row["f32"] == true)
}

#[test]
fn chapman_functions() {
    let mut regimes = Regimes::new();
    for row in single_rows("chapman") {
        let [z, mu, expected] = ["z", "cos_theta", "C"].map(|key| number(&row[key]));
        if !is_single(expected) {
            continue;
        }
        let got = [
            f64::from(chapman_huestis(z as f32, mu as f32)),
            f64::from(chapman(z as f32, mu as f32)),
            chapman_huestis(z, mu),
            chapman(z, mu),
        ];
        let side = if mu < 0.0 { "down" } else { "up" };
        let near = if z * (1.0 - (1.0 - mu * mu).sqrt()) < 1.0 {
            "grazing"
        } else {
            "steep"
        };
        see(
            &mut regimes,
            format!("{side}, {near}, {}", size(z)),
            got,
            expected,
        );
        if mu >= 0.0 && z >= 300.0 {
            let error = (got[2] - expected).abs() / expected;
            assert!(error < 1e-5, "{error:e}: {row}");
        }
    }
    print("Chapman function", &regimes);

    let mut regimes = Regimes::new();
    for row in single_rows("bessel_k1") {
        let (z, expected) = (number(&row["z"]), number(&row["zexpzK1"]));
        let got = [
            f64::from(chapman_horizontal_huestis(z as f32)),
            f64::from(k1_scaled(z as f32)),
            chapman_horizontal_huestis(z),
            k1_scaled(z),
        ];
        see(&mut regimes, size(z).into(), got, expected);
    }
    print("z eᶻ K₁(z)", &regimes);

    let mut regimes = Regimes::new();
    for row in single_rows("erfcx") {
        let (x, expected) = (number(&row["x"]), number(&row["erfcx"]));
        let got = [
            f64::from(erfcx_golubev(x as f32)),
            f64::from(erfcx(x as f32)),
            erfcx_golubev(x),
            erfcx(x),
        ];
        see(&mut regimes, regime_of_erfcx(x).into(), got, expected);
    }
    print("exp(x²) erfc(x)", &regimes);
}

fn regime_of_erfcx(x: f64) -> &'static str {
    match x {
        ..0.5 => "x < 0.5",
        0.5..4.0 => "0.5 ≤ x < 4",
        4.0..27.0 => "4 ≤ x < 27",
        _ => "27 ≤ x",
    }
}

/// Where the article's expansion holds, for infinite
/// rays upwards from z = r/H ≥ 100, it must be as good as it says, or this comparison is unfair.
#[test]
fn columns_of_spherical_media() {
    let mut regimes = Regimes::new();
    let mut beyond = 0;
    for row in table("columns") {
        let (kind, values) = profile(&row["profile"]);
        let expected = number(&row["column"]);
        if kind != Kind::Spherical {
            continue;
        }
        if !is_single(expected) {
            beyond += 1;
            continue;
        }
        let got = [
            f64::from(article(&row, &values, |x| x as f32)),
            f64::from(ours(&row, &values, |x| x as f32)),
            article(&row, &values, |x| x),
            ours(&row, &values, |x| x),
        ];
        let name = regime(&row).trim_start_matches("sphexp ").to_string();
        see(&mut regimes, name, got, expected);
        if regime(&row) == "sphexp up inf" && values[3] / values[4] >= 100.0 {
            let error = (got[2] - expected).abs() / expected;
            assert!(error < 1e-5, "{error:e}: {row}");
        }
    }
    print("rays", &regimes);
    println!("And {beyond} rows beyond the range of single precision.");
}
