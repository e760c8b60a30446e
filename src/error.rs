//! The one error of constructors: which argument, what it must be, what it was.

use std::fmt;
use std::ops::RangeInclusive;

/// An argument outside its range.
#[derive(Clone, Debug, PartialEq)]
pub struct Error {
    /// Name of the argument.
    pub argument: &'static str,
    /// What the argument must be, for example "must be finite and > 0".
    pub reason: &'static str,
    /// The value that was given.
    pub value: String,
}

impl Error {
    pub(crate) fn new(
        argument: &'static str,
        reason: &'static str,
        value: impl fmt::Debug,
    ) -> Self {
        Self {
            argument,
            reason,
            value: format!("{value:?}"),
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}, got {}", self.argument, self.reason, self.value)
    }
}

impl std::error::Error for Error {}

/// `value`, if it is finite.
pub(crate) fn finite(argument: &'static str, value: f64) -> Result<f64, Error> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(Error::new(argument, "must be finite", value))
    }
}

/// `vector`, if its components are finite.
pub(crate) fn finite_vector(argument: &'static str, vector: [f64; 3]) -> Result<[f64; 3], Error> {
    if vector.iter().all(|x| x.is_finite()) {
        Ok(vector)
    } else {
        Err(Error::new(argument, "must be finite", vector))
    }
}

/// `value`, if it is finite and greater than zero.
pub(crate) fn positive(argument: &'static str, value: f64) -> Result<f64, Error> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(Error::new(argument, "must be finite and > 0", value))
    }
}

/// `value`, if it is finite and not negative.
pub(crate) fn not_negative(argument: &'static str, value: f64) -> Result<f64, Error> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(Error::new(argument, "must be finite and >= 0", value))
    }
}

/// `vector`, if its length is one to within 1e-5: the error of a unit vector in `f32`.
pub(crate) fn unit(argument: &'static str, vector: [f64; 3]) -> Result<[f64; 3], Error> {
    let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    if (length - 1.0).abs() <= 1e-5 {
        Ok(vector)
    } else {
        Err(Error::new(argument, "must be a unit vector", vector))
    }
}

/// `value`, if it is the cosine of an angle.
pub(crate) fn cosine(argument: &'static str, value: f64) -> Result<f64, Error> {
    within(argument, value, -1.0..=1.0, "must be in [-1, 1]")
}

/// `value`, if it is the cosine of the zenith angle of a direction that does not lead down.
pub(crate) fn upward_cosine(argument: &'static str, value: f64) -> Result<f64, Error> {
    within(argument, value, 0.0..=1.0, "must be in [0, 1]")
}

/// `value`, if it is the cosine of the zenith angle of a direction that does not lead up.
pub(crate) fn downward_cosine(argument: &'static str, value: f64) -> Result<f64, Error> {
    within(argument, value, -1.0..=0.0, "must be in [-1, 0]")
}

/// `value`, if it is a probability.
pub(crate) fn probability(argument: &'static str, value: f64) -> Result<f64, Error> {
    within(argument, value, 0.0..=1.0, "must be in [0, 1]")
}

/// `value`, if it is a number below ∞; −∞ is.
pub(crate) fn below_infinity(argument: &'static str, value: f64) -> Result<f64, Error> {
    within(
        argument,
        value,
        f64::NEG_INFINITY..=f64::MAX,
        "must be a number < inf",
    )
}

fn within(
    argument: &'static str,
    value: f64,
    range: RangeInclusive<f64>,
    reason: &'static str,
) -> Result<f64, Error> {
    if range.contains(&value) {
        Ok(value)
    } else {
        Err(Error::new(argument, reason, value))
    }
}
