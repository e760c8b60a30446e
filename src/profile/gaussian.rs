//! Gaussian profile: a soft ball.
//!
//!     ρ(x) = exp(−|x − c|²/(2σ²))                                         (1)
//!
//! Along a ray this is a Gaussian in t, whose integral is a difference of error functions; that
//! and its inverse are in [`crate::special::gaussian`], where nothing cancels.
//!
//! Its derivatives are moments of it, from the exponentials of the column itself: ρ′/r = −ρ/σ²
//! in (4) of [`super::gradient`], and with E of [`crate::special::gaussian`]
//!
//!     ∂N/∂σ = ∫ r²/σ³ ρ ds = 2/σ ∫E ρ ds                                  (2)
//!
//! Relative error of the column, times the condition of |x − c|²/(2σ²): below 2e-14 (f64),
//! 6e-7 (f32).

use super::gradient::{Gradient, Pull, around, to_perigee};
use super::{Parameter, Profile};
use crate::error::{self, Error};
use crate::geometry::{Ray, Vector, dot};
use crate::real::Real;
use crate::special::gaussian::{Bell, between, in_box, on_segment};

/// ρ(x) = exp(−|x − c|²/(2σ²)).
#[derive(Clone, Copy, Debug)]
pub struct Gaussian<R> {
    /// c, where ρ = 1.
    pub center: Vector<R>,
    /// 1/σ, 1/length; σ is the standard deviation.
    pub inverse_sigma: R,
}

pub(super) const PARAMETERS: &[Parameter] = &[Parameter::CENTER, Parameter::required("sigma")];

pub(super) fn check(values: &[f64]) -> Result<(), Error> {
    error::finite_vector("center", [values[0], values[1], values[2]])?;
    error::positive("sigma", values[3])?;
    Ok(())
}

pub(super) fn from_values<R: Real>(values: &[R]) -> Gaussian<R> {
    Gaussian {
        center: [values[0], values[1], values[2]],
        inverse_sigma: values[3].lit(1.0) / values[3],
    }
}

impl<R: Real> Gaussian<R> {
    /// (x − c)/σ
    fn standard(&self, point: Vector<R>) -> Vector<R> {
        std::array::from_fn(|i| (point[i] - self.center[i]) * self.inverse_sigma)
    }

    fn bell(&self, ray: &Ray<R>) -> Bell<R> {
        let direction = ray.direction.map(|x| x * self.inverse_sigma);
        Bell::standard(self.standard(ray.origin), direction)
    }
}

impl<R: Real> Profile<R> for Gaussian<R> {
    /// (1)
    fn density(&self, point: Vector<R>) -> R {
        let d = self.standard(point);
        (-(dot(d, d) * d[0].lit(0.5))).exp()
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
        let by_ray =
            Pull::of_bell(bell.rate, &moments).by_ray(to_perigee(self.center, ray), ray.direction);
        let by_sigma = (moments.exponent + moments.exponent) * self.inverse_sigma;
        around(moments.column, by_ray, &[by_sigma], moments.density)
    }

    fn inv_column(&self, ray: &Ray<R>, column: R) -> R {
        self.bell(ray).inv_column(column)
    }

    fn bounds(&self, ray: &Ray<R>, t: R) -> (R, R) {
        let magnitude: Vector<R> = std::array::from_fn(|i| {
            (ray.origin[i].abs() + self.center[i].abs()) * self.inverse_sigma
        });
        let d = self.standard(ray.origin);
        let e = ray.direction.map(|x| x * self.inverse_sigma);
        between(on_segment(d, e, t, magnitude))
    }

    fn bounds_in_box(&self, lo: Vector<R>, hi: Vector<R>) -> (R, R) {
        let scaled = |x: Vector<R>| x.map(|x| x * self.inverse_sigma);
        let center = scaled(self.center.map(Real::abs));
        between(in_box(self.standard(lo), self.standard(hi), center))
    }

    fn detach(&self) -> Self {
        Self {
            center: self.center.map(Real::detach),
            inverse_sigma: self.inverse_sigma.detach(),
        }
    }
}
