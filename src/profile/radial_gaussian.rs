//! Gaussian in radius around a planet: the osculating companion of the spherical exponential.
//!
//!     ρ(r) = exp(−(r² − R²)/(2RH)) = exp(−h/H · (r + R)/(2R)),   h = r − R    (1)
//!
//! At r = R it has the value and the slope of exp(−h/H), elsewhere it lies below; for Earth within
//! 0.1 % over ±10 km. Along a ray it is a Gaussian in t, see [`crate::special::gaussian`]: its
//! inverse is closed, which that of the exponential is not. The exponent comes from the altitude,
//! so there is no normalisation e^(R/2H) that would overflow, and what [`crate::geometry::planet`]
//! says of the precision of altitudes holds here.
//!
//! Its derivatives are moments of it, from the exponentials of the column itself: ρ′/r = −ρ/(RH)
//! in (4) of [`super::gradient`], and with E the exponent in (1)
//!
//!     ∂N/∂H = ∫E ρ ds/H,   ∂N/∂R = N/H + ∫E ρ ds/R                           (2)
//!
//! Relative error of the column, times the condition of the exponent: below 2e-14 (f64),
//! 6e-7 (f32).

use super::gradient::{Gradient, Pull, around, to_perigee};
use super::{Parameter, Profile};
use crate::error::Error;
use crate::geometry::planet::Sphere;
use crate::geometry::{Ray, Vector};
use crate::real::Real;
use crate::special::gaussian::Bell;

/// ρ = exp(−`falloff` h (1 + h/2R)), h the altitude above `sphere`.
#[derive(Clone, Copy, Debug)]
pub struct RadialGaussian<R> {
    /// Where h = 0, ρ = 1; R is its radius.
    pub sphere: Sphere<R>,
    /// 1/H, 1/length.
    pub falloff: R,
}

pub(super) const PARAMETERS: &[Parameter] = super::spherical::PARAMETERS;

pub(super) fn check(values: &[f64]) -> Result<(), Error> {
    super::spherical::check(values)
}

pub(super) fn from_values<R: Real>(values: &[R]) -> RadialGaussian<R> {
    RadialGaussian {
        sphere: Sphere {
            center: [values[0], values[1], values[2]],
            radius: values[3],
        },
        falloff: values[4].lit(1.0) / values[4],
    }
}

impl<R: Real> RadialGaussian<R> {
    /// The exponent of (1) at an altitude ≥ −R, which may be infinite.
    fn exponent(&self, altitude: R) -> R {
        let ratio = altitude / (self.sphere.radius + self.sphere.radius);
        (altitude * self.falloff) * (altitude.lit(1.0) + ratio)
    }

    fn bell(&self, ray: &Ray<R>) -> Bell<R> {
        let passage = self.sphere.passage(ray);
        let diameter = self.sphere.radius + self.sphere.radius;
        Bell {
            along: passage.along,
            rate: self.falloff.sqrt() / diameter.sqrt(),
            exponent: self.exponent(passage.altitude),
            least: self.exponent(passage.altitude - passage.depth()),
        }
    }

    /// Infimum and supremum between two altitudes.
    fn between(&self, (low, high): (R, R)) -> (R, R) {
        let (zero, one) = (low.lit(0.0), low.lit(1.0));
        let at = |altitude: R| {
            let exponent = self.exponent(altitude);
            let error = (exponent.abs() + one) * one.unit_roundoff() * one.lit(8.0);
            let error = R::select(exponent.is_bounded(), error, one);
            ((-exponent).exp(), error)
        };
        let (inf, below) = at(high);
        let (sup, above) = at(low);
        // The density may be infinite where the factor is 0.
        let factor = (one - below).max(zero);
        let some = zero.lt(factor);
        (R::select(some, inf, zero) * factor, sup * (one + above))
    }
}

impl<R: Real> Profile<R> for RadialGaussian<R> {
    /// (1)
    fn density(&self, point: Vector<R>) -> R {
        (-self.exponent(self.sphere.altitude(point))).exp()
    }

    fn density_along(&self, ray: &Ray<R>, t: R) -> (R, R) {
        self.bell(ray).density_along(t)
    }

    fn column(&self, ray: &Ray<R>, t: R) -> R {
        self.bell(ray).column(t)
    }

    /// (2), and (4) of [`super::gradient`].
    fn column_value_and_gradient(&self, ray: &Ray<R>, t: R) -> (R, Gradient<R>) {
        let bell = self.bell(ray);
        let moments = bell.moments(t);
        let n = self.falloff;
        let by_ray = Pull::of_bell(bell.rate, &moments)
            .by_ray(to_perigee(self.sphere.center, ray), ray.direction);
        let shape = [
            moments.column * n + moments.exponent / self.sphere.radius,
            moments.exponent * n,
        ];
        around(moments.column, by_ray, &shape, moments.density)
    }

    fn inv_column(&self, ray: &Ray<R>, column: R) -> R {
        self.bell(ray).inv_column(column)
    }

    fn bounds(&self, ray: &Ray<R>, t: R) -> (R, R) {
        self.between(self.sphere.range(ray, t))
    }

    fn bounds_in_box(&self, lo: Vector<R>, hi: Vector<R>) -> (R, R) {
        self.between(self.sphere.range_in_box(lo, hi))
    }

    fn detach(&self) -> Self {
        Self {
            sphere: self.sphere.detach(),
            falloff: self.falloff.detach(),
        }
    }
}
