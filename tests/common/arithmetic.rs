//! The arithmetics in which formulas are tested against the reference tables, and what is asked of
//! them.

use super::rows::{number, point};
use analytic_media::geometry::{Ray, Vector};
use analytic_media::profile::{AnyProfile, Kind};
use analytic_media::real::Real;
use analytic_media::real::lanes::Lanes;
use serde_json::Value;
use std::collections::BTreeMap;

/// An arithmetic under test: how numbers get in and out, and what is asked of it.
pub struct Arithmetic<L, O> {
    pub name: &'static str,
    pub lift: L,
    pub lower: O,
    pub single: bool,
}

/// Runs `$check(&arithmetic)` in every arithmetic.
macro_rules! in_every_arithmetic {
    ($check:ident) => {
        $check(&$crate::common::arithmetic::Arithmetic {
            name: "f64",
            lift: |x: f64| x,
            lower: |x: f64| x,
            single: false,
        });
        $check(&$crate::common::arithmetic::Arithmetic {
            name: "f32",
            lift: |x: f64| x as f32,
            lower: |x: f32| f64::from(x),
            single: true,
        });
        $check(&$crate::common::arithmetic::Arithmetic {
            name: "f64 lanes",
            lift: <analytic_media::real::lanes::F64Lanes as analytic_media::real::lanes::Lanes>::splat,
            lower: |x: analytic_media::real::lanes::F64Lanes| f64::from($crate::common::arithmetic::last(x)),
            single: false,
        });
        $check(&$crate::common::arithmetic::Arithmetic {
            name: "f32 lanes",
            lift: |x: f64| <analytic_media::real::lanes::F32Lanes as analytic_media::real::lanes::Lanes>::splat(x as f32),
            lower: |x: analytic_media::real::lanes::F32Lanes| f64::from($crate::common::arithmetic::last(x)),
            single: true,
        });
        for (single, name) in [(false, "f64 nodes"), (true, "f32 nodes")] {
            let host = $crate::common::host::Host::new(single);
            $check(&$crate::common::arithmetic::Arithmetic {
                name,
                lift: |x: f64| host.input(x),
                lower: |node: analytic_media::real::node::Node<'_>| host.value(node.slot()),
                single,
            });
        }
    };
}
pub(crate) use in_every_arithmetic;

pub fn last<L: Lanes>(lanes: L) -> L::Scalar
where
    L::Scalar: Default,
{
    let mut value = L::Scalar::default();
    lanes.scatter(|_, lane| value = lane);
    value
}

impl<R: Real, L: Fn(f64) -> R, O: Fn(R) -> f64> Arithmetic<L, O> {
    pub fn vector(&self, value: &Value) -> Vector<R> {
        point(value).map(&self.lift)
    }

    pub fn ray(&self, row: &Value) -> Ray<R> {
        let (origin, direction) = (self.vector(&row["origin"]), self.vector(&row["dir"]));
        Ray { origin, direction }
    }

    pub fn profile(&self, (kind, values): &(Kind, Vec<f64>)) -> AnyProfile<R> {
        let values: Vec<R> = values.iter().map(|v| (self.lift)(*v)).collect();
        AnyProfile::from_values(*kind, &values)
    }

    pub fn number(&self, value: &Value) -> R {
        (self.lift)(number(value))
    }
}

impl<L, O> Arithmetic<L, O> {
    /// What may be wrong apart from roundings of inputs.
    pub fn target(&self) -> f64 {
        if self.single { 1e-6 } else { 1e-12 }
    }

    pub fn roundoff(&self) -> f64 {
        0.5 * if self.single {
            f64::from(f32::EPSILON)
        } else {
            f64::EPSILON
        }
    }

    /// A number as the format holds it.
    pub fn round(&self, x: f64) -> f64 {
        if self.single { f64::from(x as f32) } else { x }
    }

    /// Below this, values have an absolute error.
    pub fn least(&self) -> f64 {
        if self.single {
            f64::from(f32::MIN_POSITIVE)
        } else {
            f64::MIN_POSITIVE
        }
    }

    /// The largest number of the format.
    pub fn largest(&self) -> f64 {
        if self.single {
            f64::from(f32::MAX)
        } else {
            f64::MAX
        }
    }

    /// Prints the largest error in each regime, and the largest share of its tolerance.
    pub fn print(&self, what: &str, errors: &Errors) {
        let rows: usize = errors.values().map(Vec::len).sum();
        println!(
            "{}: {rows} rows, worst {what}, share of the tolerance",
            self.name
        );
        let largest = |worst: f64, x: f64| worst.max(x);
        for (regime, errors) in errors {
            let worst = errors.iter().map(|(error, _)| *error).fold(0.0, largest);
            let share = errors.iter().map(|(error, tolerance)| error / tolerance);
            let share = share.fold(0.0, largest);
            println!(
                "    {regime:28} {:4} rows {worst:8.1e} {share:5.2}",
                errors.len()
            );
        }
    }
}

/// Errors and tolerances by regime.
pub type Errors = BTreeMap<String, Vec<(f64, f64)>>;
