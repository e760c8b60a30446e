//! Linear profile: density affine in altitude, clamped at zero.
//!
//!     ρ(h) = max(0, k + a h)                                         (article, Eq. 28)
//!
//! Along a ray the affine function goes from b to e = b + m t, m = a μ. With b₊ = max(b, 0):
//!
//!     N(t) = t/2 (b₊ + e₊)²/(|b| + |e|)                              (30, with the clamp)
//!     t(N) = t₀ + 2 N/(b₊ + √(b₊² + 2 m N)),  t₀ = max(−b, 0)/m      (31, stable form)
//!
//! Both are smooth through m = 0, where the medium is uniform along the ray. Where both
//! ends are positive, (30) is the trapezoid t (b + e)/2; where the density reaches zero on
//! the way, it is the triangle that is left. In (31) a negative radicand means that the
//! density reaches zero before the ray has gathered N. The article's root (b − √…)/m
//! cancels for small m.
//!
//! Of the segment the part S = t (b₊ + e₊)/(|b| + |e|) has matter, with its middle at s̄, and
//!
//!     ∂N/∂k = S,   ∂N/∂a = S h(s̄),   ∂N/∂o = a S up,   ∂N/∂d = a S s̄ up     (32)
//!
//! for the density is 0 at the ends that the clamp makes.
//!
//! Relative error, times the condition of k + a h: below 6e-16 (f64), 4e-7 (f32).

use super::gradient::Gradient;
use super::{Parameter, Profile};
use crate::error::{self, Error};
use crate::geometry::{Plane, Ray, Vector, climb};
use crate::real::Real;

/// ρ(h) = max(0, `density` + `gradient` h), h the altitude above `plane`.
#[derive(Clone, Copy, Debug)]
pub struct Linear<R> {
    /// Where h = 0.
    pub plane: Plane<R>,
    /// a: change of density per unit of altitude, 1/length.
    pub gradient: R,
    /// k: density at h = 0.
    pub density: R,
}

pub(super) const PARAMETERS: &[Parameter] = &[
    Parameter::UP,
    Parameter::BASE_HEIGHT,
    Parameter::required("gradient"),
    Parameter::required("density"),
];

pub(super) fn check(values: &[f64]) -> Result<(), Error> {
    error::unit("up", [values[0], values[1], values[2]])?;
    error::finite("base_height", values[3])?;
    error::finite("gradient", values[4])?;
    error::finite("density", values[5])?;
    Ok(())
}

pub(super) fn from_values<R: Real>(values: &[R]) -> Linear<R> {
    Linear {
        plane: Plane {
            up: [values[0], values[1], values[2]],
            base_height: values[3],
        },
        gradient: values[4],
        density: values[5],
    }
}

impl<R: Real> Linear<R> {
    /// k + a h, not clamped.
    fn affine(&self, altitude: R) -> R {
        self.gradient.mul_add(altitude, self.density)
    }

    /// (b, m): the affine function at the origin of the ray, and its slope along it.
    fn along(&self, ray: &Ray<R>) -> (R, R) {
        let start = self.affine(self.plane.altitude(ray.origin));
        (start, self.gradient * self.plane.cos_zenith(ray.direction))
    }

    /// Infimum and supremum of the density between two altitudes.
    fn between(&self, (low, high): (R, R)) -> (R, R) {
        let zero = low.lit(0.0);
        let a = climb(self.gradient, low) + self.density;
        let b = climb(self.gradient, high) + self.density;
        // The sum itself is rounded once more.
        let up = zero.lit(1.0) + zero.unit_roundoff() * zero.lit(4.0);
        let down = zero.lit(1.0) - zero.unit_roundoff() * zero.lit(4.0);
        (a.min(b).max(zero) * down, a.max(b).max(zero) * up)
    }
}

impl<R: Real> Profile<R> for Linear<R> {
    /// (28)
    fn density(&self, point: Vector<R>) -> R {
        let value = self.affine(self.plane.altitude(point));
        value.max(value.lit(0.0))
    }

    fn density_along(&self, ray: &Ray<R>, t: R) -> (R, R) {
        let (b, m) = self.along(ray);
        let value = m.mul_add(t, b);
        let zero = value.lit(0.0);
        (value.max(zero), R::select(zero.lt(value), m, zero))
    }

    /// (30); infinite segments have the limit for t → ∞.
    fn column(&self, ray: &Ray<R>, t: R) -> R {
        let (b, m) = self.along(ray);
        let (zero, half, infinity) = (t.lit(0.0), t.lit(0.5), t.lit(f64::INFINITY));
        let finite = t.is_bounded();
        let t = R::select(finite, t, zero);

        let e = m.mul_add(t, b);
        let positive = b.max(zero) + e.max(zero);
        let span = b.abs() + e.abs();
        let dense = zero.lt(positive);
        let mean = half * positive * (positive / R::select(dense, span, zero.lit(1.0)));

        let thins = m.lt(zero);
        let start = b.max(zero);
        let triangle = half * start * (start / R::select(thins, -m, zero.lit(1.0)));
        let grows = zero.lt(m) | zero.lt(b);
        let endless = R::select(thins, triangle, R::select(grows, infinity, zero));
        R::select(finite, t * mean, endless)
    }

    /// (30) and (32)
    fn column_value_and_gradient(&self, ray: &Ray<R>, t: R) -> (R, Gradient<R>) {
        let value = self.column(ray, t);
        let (b, m) = self.along(ray);
        let (zero, half, one) = (t.lit(0.0), t.lit(0.5), t.lit(1.0));
        let finite = t.is_bounded();
        let t = R::select(finite, t, zero);
        let e = m.mul_add(t, b);
        let span = b.abs() + e.abs();
        let some = zero.lt(span);
        let part = (b.max(zero) + e.max(zero)) / R::select(some, span, one);
        let thins = m.lt(zero);
        let endless = b.max(zero) / R::select(thins, -m, one);
        let length = R::select(finite, t * part, endless);

        let behind = half * length;
        let middle = R::select(b.lt(zero), t - behind, behind);
        let (a, up) = (self.gradient, self.plane.up);
        let slope = a * length;
        let moment = slope * middle;
        let point = |i: usize| ray.origin[i] * slope + ray.direction[i] * moment;
        let mean = self.plane.altitude(ray.origin) + self.plane.cos_zenith(ray.direction) * middle;
        let gradient = Gradient {
            parameters: [0, 1, 2]
                .map(point)
                .into_iter()
                .chain([-slope, mean * length, length])
                .collect(),
            origin: up.map(|x| x * slope),
            direction: up.map(|x| x * moment),
            last: R::select(finite, e.max(zero), zero),
        };
        (value, gradient.of(value))
    }

    /// (31)
    fn inv_column(&self, ray: &Ray<R>, column: R) -> R {
        let (b, m) = self.along(ray);
        let (zero, one, two) = (column.lit(0.0), column.lit(1.0), column.lit(2.0));
        let start = b.max(zero);
        let radicand = start.mul_add(start, two * m * column);
        let grows = zero.lt(m);
        let some = zero.lt(column) & column.is_bounded();
        let reached = zero.le(radicand) & (zero.lt(b) | grows) & some;

        let wait = (-b).max(zero) / R::select(grows, m, one);
        let root = R::select(reached, radicand, one).sqrt();
        let sum = R::select(reached, start + root, one);
        let distance = wait + two * R::select(reached, column, zero) / sum;
        let none = R::select(zero.lt(column), zero.lit(f64::INFINITY), zero);
        R::select(reached, distance, none)
    }

    fn bounds(&self, ray: &Ray<R>, t: R) -> (R, R) {
        self.between(self.plane.range(ray, t))
    }

    fn bounds_in_box(&self, lo: Vector<R>, hi: Vector<R>) -> (R, R) {
        self.between(self.plane.range_in_box(lo, hi))
    }

    fn detach(&self) -> Self {
        Self {
            plane: self.plane.detach(),
            gradient: self.gradient.detach(),
            density: self.density.detach(),
        }
    }
}
