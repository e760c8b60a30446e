//! Columns of spherical media by the article's formulas and by ours, against the reference table.

mod common;

use analytic_media::geometry::Ray;
use analytic_media::profile::{AnyProfile, Kind, Profile};
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

/// Prints a table in Markdown: `--nocapture`. Where the article's expansion holds, for infinite
/// rays upwards from z = r/H ≥ 100, it must be as good as it says, or this comparison is unfair.
#[test]
fn columns_of_spherical_media() {
    let mut regimes = BTreeMap::<String, (usize, [Worst; 4])>::new();
    let mut beyond = 0;
    for row in table("columns") {
        let (kind, values) = profile(&row["profile"]);
        let expected = number(&row["column"]);
        if kind != Kind::Spherical {
            continue;
        }
        if !(f64::from(f32::MIN_POSITIVE)..=f64::from(f32::MAX)).contains(&expected) {
            beyond += 1;
            continue;
        }
        let got = [
            f64::from(article(&row, &values, |x| x as f32)),
            f64::from(ours(&row, &values, |x| x as f32)),
            article(&row, &values, |x| x),
            ours(&row, &values, |x| x),
        ];
        let (rows, worst) = regimes.entry(regime(&row)).or_default();
        *rows += 1;
        for (worst, got) in worst.iter_mut().zip(got) {
            worst.see(got, expected);
        }
        if regime(&row) == "sphexp up inf" && values[3] / values[4] >= 100.0 {
            let error = (got[2] - expected).abs() / expected;
            assert!(error < 1e-5, "{error:e}: {row}");
        }
    }
    println!("| rays | rows | article, `f32` | ours, `f32` | article, `f64` | ours, `f64` |");
    println!("|---|---|---|---|---|---|");
    for (regime, (rows, worst)) in &regimes {
        let name = regime.trim_start_matches("sphexp ");
        let cells = worst.map(Worst::text).join(" | ");
        println!("| {name} | {rows} | {cells} |");
    }
    println!("\nAnd {beyond} rows beyond the range of single precision.");
}
