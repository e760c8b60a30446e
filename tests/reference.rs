//! Columns, inverses and bounds against the reference tables, in every arithmetic.
//!
//! The tables were computed with 50 digits or more, see `tests/reference/README.md`. A row's
//! tolerance is the target of the arithmetic (1e-12 in double, 2e-6 in single precision)
//! times the row's own sensitivity to rounded coordinates.

mod common;

use analytic_media::geometry::{Ray, Vector};
use analytic_media::medium::Medium;
use analytic_media::profile::{AnyProfile, Kind, Profile};
use analytic_media::real::Real;
use analytic_media::real::lanes::{F32Lanes, F64Lanes, Lanes};
use analytic_media::sampling;
use common::host::Host;
use common::rows::{number, point, profile, table};
use serde_json::Value;

/// An arithmetic under test: how numbers get in and out, and what is asked of it.
struct Arithmetic<L, O> {
    name: &'static str,
    lift: L,
    lower: O,
    target: f64,
}

const DOUBLE: f64 = 1e-12;
const SINGLE: f64 = 2e-6;

/// Runs `$check(&arithmetic)` in every arithmetic.
macro_rules! in_every_arithmetic {
    ($check:ident) => {
        $check(&Arithmetic {
            name: "f64",
            lift: |x: f64| x,
            lower: |x: f64| x,
            target: DOUBLE,
        });
        $check(&Arithmetic {
            name: "f32",
            lift: |x: f64| x as f32,
            lower: |x: f32| f64::from(x),
            target: SINGLE,
        });
        $check(&Arithmetic {
            name: "f64 lanes",
            lift: F64Lanes::splat,
            lower: |x: F64Lanes| f64::from(last(x)),
            target: DOUBLE,
        });
        $check(&Arithmetic {
            name: "f32 lanes",
            lift: |x: f64| F32Lanes::splat(x as f32),
            lower: |x: F32Lanes| f64::from(last(x)),
            target: SINGLE,
        });
        for (single, name, target) in [(false, "f64 nodes", DOUBLE), (true, "f32 nodes", SINGLE)] {
            let host = Host::new(single);
            $check(&Arithmetic {
                name,
                lift: |x: f64| host.input(x),
                lower: |node: analytic_media::real::node::Node<'_>| host.value(node.slot()),
                target,
            });
        }
    };
}

fn last<L: Lanes>(lanes: L) -> L::Scalar
where
    L::Scalar: Default,
{
    let mut value = L::Scalar::default();
    lanes.scatter(|_, lane| value = lane);
    value
}

impl<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64> Arithmetic<L, O> {
    fn vector(&self, value: &Value) -> Vector<R> {
        point(value).map(&self.lift)
    }

    fn ray(&self, row: &Value) -> Ray<R> {
        let (origin, direction) = (self.vector(&row["origin"]), self.vector(&row["dir"]));
        Ray { origin, direction }
    }

    fn profile(&self, (kind, values): &(Kind, Vec<f64>)) -> AnyProfile<R> {
        let values: Vec<R> = values.iter().map(|v| (self.lift)(*v)).collect();
        AnyProfile::from_values(*kind, &values)
    }

    fn number(&self, value: &Value) -> R {
        (self.lift)(number(value))
    }
}

/// The least normal number of single precision. Below it, values in single precision have an
/// absolute error.
const LEAST: f64 = f32::MIN_POSITIVE as f64;

/// |got − expected| within `tolerance` of it; infinities and zeros must be exact.
fn close(got: f64, expected: f64, tolerance: f64, target: f64) -> bool {
    if expected.is_infinite() || expected == 0.0 {
        return got == expected;
    }
    let underflow = if target == SINGLE { LEAST } else { 0.0 };
    (got - expected).abs() <= tolerance * expected.abs() + underflow
}

fn columns<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(a: &Arithmetic<L, O>) {
    let mut rows = 0;
    let mut worst = (0.0, String::new());
    for row in table("columns") {
        let Some(description) = profile(&row["profile"]) else {
            continue;
        };
        let got = (a.lower)(
            a.profile(&description)
                .column(&a.ray(&row), a.number(&row["t"])),
        );
        let expected = number(&row["column"]);
        let sens = row["sens"].as_f64().unwrap_or(1.0).max(1.0);
        assert!(
            close(got, expected, a.target * sens, a.target),
            "{}: column {got:e}, expected {expected:e}, sens {sens}: {row}",
            a.name
        );
        if expected.is_finite() && (expected > LEAST || a.target == DOUBLE && expected > 0.0) {
            let error = (got - expected).abs() / expected / sens;
            if error > worst.0 {
                worst = (error, row["id"].to_string());
            }
        }
        rows += 1;
    }
    assert!(rows > 150, "the table has rows of these profiles");
    println!(
        "{}: {rows} columns, worst error over sens {:.1e} (row {})",
        a.name, worst.0, worst.1
    );
}

#[test]
fn columns_match_the_table() {
    in_every_arithmetic!(columns);
}

fn inverses<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(a: &Arithmetic<L, O>) {
    let mut rows = 0;
    let mut worst = (0.0, String::new());
    for row in table("inverse") {
        let components = row["components"].as_array().expect("components");
        let Some(profiles) = components
            .iter()
            .map(|c| profile(&c["profile"]))
            .collect::<Option<Vec<_>>>()
        else {
            continue;
        };
        let medium = Medium::new(
            profiles.iter().map(|p| a.profile(p)).collect(),
            components.iter().map(|c| a.number(&c["mu"])).collect(),
        );
        let (t_max, tau) = (a.number(&row["t_max"]), a.number(&row["tau"]));
        let ray = a.ray(&row);
        let t = sampling::free_flight(&medium, 0, &ray, t_max, tau);
        let (got, expected) = ((a.lower)(t), number(&row["t"]));
        let (tau, total) = (number(&row["tau"]), number(&row["tau_max"]));
        // Within rounding of the whole optical depth, both answers are right.
        let edge = (tau - total).abs() <= a.target * total;
        if expected.is_infinite() || got.is_infinite() {
            assert!(
                got == expected || edge,
                "{}: t {got:e}, expected {expected:e}: {row}",
                a.name
            );
        } else {
            // The optical depth that the error in t amounts to, as in the targets: a residual.
            let residual = (got - expected).abs() * number(&row["mu_at_t"]) / tau.max(1.0);
            let cond = row["cond"].as_f64().unwrap_or(1.0);
            let relative = (got - expected).abs() / expected.abs();
            assert!(
                relative <= a.target * cond.max(1.0) || residual <= a.target,
                "{}: t {got:e}, expected {expected:e}, residual {residual:e}: {row}",
                a.name
            );
            if residual > worst.0 {
                worst = (residual, row["id"].to_string());
            }
        }
        rows += 1;
    }
    assert!(rows > 100, "the table has rows of these profiles");
    println!(
        "{}: {rows} inverses, worst residual {:.1e} (row {})",
        a.name, worst.0, worst.1
    );
}

#[test]
fn free_flights_match_the_table() {
    in_every_arithmetic!(inverses);
}

fn majorants<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(a: &Arithmetic<L, O>) {
    let mut rows = 0;
    for row in table("majorant") {
        let Some(description) = profile(&row["profile"]) else {
            continue;
        };
        let p = a.profile(&description);
        let (inf, sup) = if row["domain"] == "box" {
            p.bounds_in_box(a.vector(&row["lo"]), a.vector(&row["hi"]))
        } else {
            p.bounds(&a.ray(&row), a.number(&row["t"]))
        };
        let (inf, sup) = ((a.lower)(inf), (a.lower)(sup));
        let (true_inf, true_sup) = (number(&row["inf"]), number(&row["sup"]));
        // In double precision nothing is lost on the way in, so bounds are bounds; in single
        // precision they bound the density of the rounded inputs.
        if a.target == DOUBLE {
            assert!(
                inf <= true_inf && sup >= true_sup,
                "{}: not bounds [{inf:e}, {sup:e}]: {row}",
                a.name
            );
        }
        let condition = condition(&row);
        for (got, expected) in [(inf, true_inf), (sup, true_sup)] {
            let scale = if expected.is_finite() {
                true_sup.min(1e300)
            } else {
                expected
            };
            let near = got == expected
                || (got - expected).abs() <= a.target * condition * scale
                || a.target == SINGLE && got.max(expected) <= LEAST;
            assert!(near, "{}: bounds [{inf:e}, {sup:e}]: {row}", a.name);
        }
        rows += 1;
    }
    assert!(rows > 180, "the table has rows of these profiles");
    println!("{}: {rows} bounds", a.name);
}

/// Relative change of the density per relative change of the coordinates: what `sens` is in
/// the table of columns.
fn condition(row: &Value) -> f64 {
    let p = &row["profile"];
    let largest = |key: &str| largest_of(&row[key]);
    let extent = if row["domain"] == "box" {
        largest("lo").max(largest("hi"))
    } else {
        let t = number(&row["t"]);
        largest("origin") + if t.is_finite() { t } else { 0.0 }
    };
    let scale = match p["type"].as_str() {
        Some("exponential") => (extent + number(&p["h0"]).abs()) / number(&p["H"]),
        Some("linear") => {
            let sup = number(&row["sup"]);
            let sup = if sup > 0.0 && sup.is_finite() {
                sup
            } else {
                1.0
            };
            (number(&p["a"]).abs() * extent + number(&p["k"]).abs()) / sup
        }
        Some("sphere_tent") => {
            let sup = number(&row["sup"]);
            let radius = number(&p["R"]) + number(&p["h_c"]);
            (extent + radius) / number(&p["w"]) / if sup > 0.0 { sup } else { 1.0 }
        }
        // Where the supremum lies in the tail, the exponent itself is large.
        Some("gaussian") => {
            let (sigma, center) = (number(&p["s"]), largest_of(&p["c"]));
            let exponent = -number(&row["sup"]).max(1e-300).ln();
            (extent + center) / sigma * (1.0 + (2.0 * exponent).max(0.0).sqrt())
        }
        _ => 0.0,
    };
    1.0 + 3.0 * scale
}

/// The largest absolute value of three coordinates.
fn largest_of(vector: &Value) -> f64 {
    point(vector).iter().fold(0.0f64, |m, x| m.max(x.abs()))
}

#[test]
fn bounds_match_the_table() {
    in_every_arithmetic!(majorants);
}
