//! The one error of constructors: which argument, what it must be, what it was.

use std::f64::consts::FRAC_PI_2;
use std::fmt;

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
    check(argument, value, value.is_finite(), "must be finite")
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
    let good = value.is_finite() && value > 0.0;
    check(argument, value, good, "must be finite and > 0")
}

/// `value`, if it is finite and not negative.
pub(crate) fn not_negative(argument: &'static str, value: f64) -> Result<f64, Error> {
    let good = value.is_finite() && value >= 0.0;
    check(argument, value, good, "must be finite and >= 0")
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

/// `value`, if it is greater than zero; it may be infinite.
pub(crate) fn positive_or_infinite(argument: &'static str, value: f64) -> Result<f64, Error> {
    let good = value > 0.0;
    check(argument, value, good, "must be > 0 and may be infinite")
}

/// `value`, if it is the cosine of an angle.
pub(crate) fn cosine(argument: &'static str, value: f64) -> Result<f64, Error> {
    let good = (-1.0..=1.0).contains(&value);
    check(argument, value, good, "must be in [-1, 1]")
}

/// `value`, if it is the cosine of the zenith angle of a direction that does not lead down.
pub(crate) fn upward_cosine(argument: &'static str, value: f64) -> Result<f64, Error> {
    fraction(argument, value)
}

/// `value`, if it is the cosine of the zenith angle of a direction that does not lead up.
pub(crate) fn downward_cosine(argument: &'static str, value: f64) -> Result<f64, Error> {
    let good = (-1.0..=0.0).contains(&value);
    check(argument, value, good, "must be in [-1, 0]")
}

/// `value`, if it is a part of a whole: none, all, or between.
pub(crate) fn fraction(argument: &'static str, value: f64) -> Result<f64, Error> {
    let good = (0.0..=1.0).contains(&value);
    check(argument, value, good, "must be in [0, 1]")
}

/// `value`, if it is a part of a whole, and not nothing.
pub(crate) fn some_fraction(argument: &'static str, value: f64) -> Result<f64, Error> {
    let good = value > 0.0 && value <= 1.0;
    check(argument, value, good, "must be in (0, 1]")
}

/// `value`, if it is a part of a whole, and not all.
pub(crate) fn partial_fraction(argument: &'static str, value: f64) -> Result<f64, Error> {
    let good = (0.0..1.0).contains(&value);
    check(argument, value, good, "must be in [0, 1)")
}

/// `value`, if it is a part of a whole, neither nothing nor all.
pub(crate) fn proper_fraction(argument: &'static str, value: f64) -> Result<f64, Error> {
    let good = value > 0.0 && value < 1.0;
    check(argument, value, good, "must be in (0, 1)")
}

/// `value`, if it is finite and at least one.
pub(crate) fn at_least_one(argument: &'static str, value: f64) -> Result<f64, Error> {
    let good = value.is_finite() && value >= 1.0;
    check(argument, value, good, "must be finite and >= 1")
}

/// `value`, if it is a wavelength in nm that the fit of the Rayleigh cross-section of air covers.
pub(crate) fn rayleigh_wavelength(argument: &'static str, value: f64) -> Result<f64, Error> {
    let good = (200.0..=2000.0).contains(&value);
    check(argument, value, good, "must be in [200, 2000] nm")
}

/// `value`, if it is a probability.
pub(crate) fn probability(argument: &'static str, value: f64) -> Result<f64, Error> {
    fraction(argument, value)
}

/// `value`, if it is a number below ∞; −∞ is.
pub(crate) fn below_infinity(argument: &'static str, value: f64) -> Result<f64, Error> {
    let good = value < f64::INFINITY;
    check(argument, value, good, "must be a number < inf")
}

/// `value`, if it is an angle in radians of less than a quarter turn, and not nothing.
pub(crate) fn acute(argument: &'static str, value: f64) -> Result<f64, Error> {
    let good = value > 0.0 && value < FRAC_PI_2;
    check(argument, value, good, "must be in (0, pi/2) radians")
}

/// `value`, if it is the mean cosine of a phase function that is smooth.
pub(crate) fn asymmetry(argument: &'static str, value: f64) -> Result<f64, Error> {
    let good = value.abs() < 1.0;
    check(argument, value, good, "must be in (-1, 1)")
}

fn check(
    argument: &'static str,
    value: f64,
    good: bool,
    reason: &'static str,
) -> Result<f64, Error> {
    if good {
        Ok(value)
    } else {
        Err(Error::new(argument, reason, value))
    }
}
