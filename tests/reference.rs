//! Columns, inverses and bounds against the reference tables, in every arithmetic.
//!
//! The tables were computed with 50 digits or more, see `tests/reference/README.md`. All rows are
//! tested. A tolerance is the target of the arithmetic, and what rounding of the inputs alone may
//! do to the result: `sens` for columns; for inverses the sum over the inputs; bounds are those of
//! the rounded inputs. Worst errors per regime: `--nocapture`.

mod common;

use analytic_media::geometry::{Ray, Vector};
use analytic_media::medium::Medium;
use analytic_media::profile::{AnyProfile, Kind, Profile};
use analytic_media::real::Real;
use analytic_media::sampling;
use common::arithmetic::{Arithmetic, Errors, in_every_arithmetic};
use common::rows::{number, point, profile, regime, table};
use serde_json::Value;

fn columns<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(a: &Arithmetic<L, O>) {
    let mut errors = Errors::new();
    for row in table("columns") {
        let profile = a.profile(&profile(&row["profile"]));
        let got = (a.lower)(profile.column(&a.ray(&row), a.number(&row["t"])));
        // Where the column is beyond the format, it is infinite.
        let expected = a.round(number(&row["column"]));
        let sens = row["sens"].as_f64().unwrap_or(1.0);
        let tolerance = a.target() + 4.0 * a.roundoff() * sens;
        let error = if got == expected {
            0.0
        } else {
            (got - expected).abs() / expected.max(a.least())
        };
        assert!(
            error <= tolerance,
            "{}: column {got:e}, expected {expected:e}, sens {sens}: {row}",
            a.name
        );
        errors
            .entry(regime(&row))
            .or_default()
            .push((error, tolerance));
    }
    a.print("relative error of columns", &errors);
}

#[test]
fn columns_match_the_table() {
    in_every_arithmetic!(columns);
}

/// The inputs of a row of inverses.
#[derive(Clone)]
struct Flight {
    kinds: Vec<Kind>,
    /// Parameters of the profiles, extinctions, origin, direction.
    values: Vec<f64>,
}

impl Flight {
    fn of(row: &Value) -> Self {
        let components = row["components"].as_array().expect("components");
        let (kinds, mut values) = (components.iter().map(|c| profile(&c["profile"]))).fold(
            (vec![], vec![]),
            |(mut kinds, mut all), (kind, values)| {
                kinds.push(kind);
                all.extend(values);
                (kinds, all)
            },
        );
        values.extend(components.iter().map(|c| number(&c["mu"])));
        values.extend(point(&row["origin"]));
        values.extend(point(&row["dir"]));
        Self { kinds, values }
    }

    fn lift<R: Real>(&self, lift: impl Fn(f64) -> R) -> (Medium<R>, Ray<R>) {
        let lifted: Vec<R> = self.values.iter().map(|v| lift(*v)).collect();
        let mut rest = &lifted[..];
        let mut take = |n: usize| {
            let (head, tail) = rest.split_at(n);
            rest = tail;
            head
        };
        let profiles = self
            .kinds
            .iter()
            .map(|kind| AnyProfile::from_values(*kind, take(kind.size())));
        let profiles: Vec<_> = profiles.collect();
        let medium = Medium::new(profiles, take(self.kinds.len()).to_vec());
        let mut vector = || -> Vector<R> { take(3).try_into().expect("three coordinates") };
        let (origin, direction) = (vector(), vector());
        (medium, Ray { origin, direction })
    }

    fn depth(&self, t: f64) -> f64 {
        let (medium, ray) = self.lift(|x| x);
        medium.optical_depth(&ray, t).next().expect("a channel")
    }

    /// What a rounding of every input does to the optical depth, at most.
    fn uncertainty(&self, t: f64, roundoff: f64) -> f64 {
        let depth = self.depth(t);
        let shifted = (0..self.values.len()).map(|i| {
            let mut other = self.clone();
            other.values[i] *= 1.0 + roundoff;
            other.depth(t)
        });
        let shifted = shifted.chain([self.depth(t * (1.0 + roundoff))]);
        shifted.map(|other| (other - depth).abs()).sum()
    }
}

fn inverses<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(a: &Arithmetic<L, O>) {
    let mut errors = Errors::new();
    for row in table("inverse") {
        let flight = Flight::of(&row);
        let (medium, ray) = flight.lift(&a.lift);
        let (t_max, tau) = (a.number(&row["t_max"]), a.number(&row["tau"]));
        let got = (a.lower)(sampling::free_flight(&medium, 0, &ray, t_max, tau));

        let (tau, total) = (number(&row["tau"]), number(&row["tau_max"]));
        let expected = number(&row["t"]);
        // An infinite answer stands for all distances beyond the end.
        let (end, missing) = if got.is_finite() {
            (got, (flight.depth(got) - tau).abs())
        } else {
            (number(&row["t_max"]), (total - tau).max(0.0))
        };
        let residual = missing / tau.max(1.0);
        // In units that double precision can see.
        let single = f64::from(f32::EPSILON) / 2.0;
        let uncertainty = flight.uncertainty(end, single) * (a.roundoff() / single);
        let tolerance = a.target() * tau.min(1.0) + 2.0 * uncertainty / tau.max(1.0);
        assert!(
            got == expected || residual <= tolerance,
            "{}: t {got:e}, expected {expected:e}, residual {residual:e} > {tolerance:e}: {row}",
            a.name
        );
        let residual = if got == expected { 0.0 } else { residual };
        errors
            .entry(regime(&row))
            .or_default()
            .push((residual, tolerance));
    }
    a.print("residual of free flights", &errors);
}

#[test]
fn free_flights_match_the_table() {
    in_every_arithmetic!(inverses);
}

fn bounds<R: Real>(row: &Value, profile: &AnyProfile<R>, lift: impl Fn(f64) -> R) -> (R, R) {
    let vector = |key: &str| point(&row[key]).map(&lift);
    if row["domain"] == "box" {
        profile.bounds_in_box(vector("lo"), vector("hi"))
    } else {
        let (origin, direction) = (vector("origin"), vector("dir"));
        profile.bounds(&Ray { origin, direction }, lift(number(&row["t"])))
    }
}

fn majorants<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64>(a: &Arithmetic<L, O>) {
    let mut errors = Errors::new();
    for row in table("majorant") {
        let (kind, values) = profile(&row["profile"]);
        let (inf, sup) = bounds(&row, &a.profile(&(kind, values.clone())), &a.lift);
        let (inf, sup) = ((a.lower)(inf), (a.lower)(sup));
        // In single precision of the rounded inputs, whose bounds in double precision are true.
        let (true_inf, true_sup) = if a.single {
            let values: Vec<f64> = values.iter().map(|v| a.round(*v)).collect();
            bounds(&row, &AnyProfile::from_values(kind, &values), |x| {
                a.round(x)
            })
        } else {
            (number(&row["inf"]), number(&row["sup"]))
        };
        let (true_inf, true_sup) = (a.round(true_inf), a.round(true_sup));
        let excess = if sup == true_sup {
            1.0
        } else {
            sup / true_sup.max(a.least())
        };
        assert!(
            inf <= true_inf && true_sup <= sup,
            "{}: [{inf:e}, {sup:e}] are not bounds: {row}",
            a.name
        );
        // Beside the supremum, an infimum may be next to nothing.
        let lost = true_inf - inf;
        assert!(
            excess <= 1.5 && (true_inf <= 1.5 * inf || lost <= 1e-3 * true_sup),
            "{}: [{inf:e}, {sup:e}] is wide: {row}",
            a.name
        );
        errors
            .entry(regime(&row))
            .or_default()
            .push((excess - 1.0, 0.5));
    }
    a.print("excess of the supremum", &errors);
}

#[test]
fn bounds_match_the_table() {
    in_every_arithmetic!(majorants);
}
