//! Constant profile: what every other profile meets in a limit.
//!
//!     ρ = 1                                                          (article, Eq. 25)
//!     N(t) = t                                                       (26)
//!     t(N) = N                                                       (27)

use super::gradient::Gradient;
use super::{Parameter, Profile};
use crate::error::Error;
use crate::geometry::{Ray, Vector};
use crate::real::Real;

/// ρ = 1 everywhere.
#[derive(Clone, Copy, Debug)]
pub struct Constant;

pub(super) const PARAMETERS: &[Parameter] = &[];

pub(super) fn check(_: &[f64]) -> Result<(), Error> {
    Ok(())
}

pub(super) fn from_values<R: Real>(_: &[R]) -> Constant {
    Constant
}

impl<R: Real> Profile<R> for Constant {
    fn density(&self, point: Vector<R>) -> R {
        point[0].lit(1.0)
    }

    fn density_along(&self, _: &Ray<R>, t: R) -> (R, R) {
        (t.lit(1.0), t.lit(0.0))
    }

    /// (26), exact.
    fn column(&self, _: &Ray<R>, t: R) -> R {
        t
    }

    /// ∂N/∂t = 1, and nothing else matters.
    fn column_value_and_gradient(&self, _: &Ray<R>, t: R) -> (R, Gradient<R>) {
        let (zero, one) = (t.lit(0.0), t.lit(1.0));
        let gradient = Gradient {
            parameters: [].into_iter().collect(),
            origin: [zero; 3],
            direction: [zero; 3],
            last: one,
        };
        (t, gradient.of(t))
    }

    /// (27), exact.
    fn inv_column(&self, _: &Ray<R>, column: R) -> R {
        column
    }

    fn bounds(&self, _: &Ray<R>, t: R) -> (R, R) {
        (t.lit(1.0), t.lit(1.0))
    }

    fn bounds_in_box(&self, lo: Vector<R>, _: Vector<R>) -> (R, R) {
        (lo[0].lit(1.0), lo[0].lit(1.0))
    }

    fn detach(&self) -> Self {
        *self
    }
}
