//! Anisotropic Gaussian profile: a soft ellipsoid.
//!
//!     ρ(x) = exp(−½ Σₖ wₖ²),   wₖ = aₖ · (x − c)/|aₖ|²                    (1)
//!
//! The axes a₁, a₂, a₃ are orthogonal; their lengths are the standard deviations. In the
//! coordinates w the profile is the isotropic one, see [`super::gaussian`], and so are its
//! errors.
//!
//! In them N has the derivatives of (4) of [`super::gradient`], with ρ′/r = −ρ; with
//! bₖ = aₖ/|aₖ|², those of w(0) and of dw/ds give
//!
//!     ∂N/∂o = Σ bₖ ∂N/∂wₖ,   ∂N/∂bₖ = (o − c) ∂N/∂wₖ + d ∂N/∂w′ₖ,
//!     ∂N/∂aₖ = (∂N/∂bₖ − 2 aₖ (bₖ · ∂N/∂bₖ))/|aₖ|²                        (2)
//!
//! Boxes are bounded by what they span along each axis and by their distance from the centre
//! over the greatest standard deviation: exact for axes along those of the coordinates, true
//! bounds for all.

use super::gradient::{Gradient, Parameters, Pull, across, around};
use super::{Parameter, Profile};
use crate::error::{self, Error};
use crate::geometry::{Ray, Vector, climb, dot, norm};
use crate::real::Real;
use crate::special::gaussian::{Bell, between, in_box, on_segment};

/// ρ(x) = exp(−½ Σₖ (`inverse_axes`ₖ · (x − c))²).
#[derive(Clone, Copy, Debug)]
pub struct AnisotropicGaussian<R> {
    /// c, where ρ = 1.
    pub center: Vector<R>,
    /// aₖ/|aₖ|², orthogonal, 1/length.
    pub inverse_axes: [Vector<R>; 3],
}

pub(super) const PARAMETERS: &[Parameter] = &[
    Parameter::CENTER,
    Parameter::axis("axis_u"),
    Parameter::axis("axis_v"),
    Parameter::axis("axis_w"),
];

pub(super) fn check(values: &[f64]) -> Result<(), Error> {
    let vector = |i: usize| [values[i], values[i + 1], values[i + 2]];
    error::finite_vector("center", vector(0))?;
    let names = ["axis_u", "axis_v", "axis_w"];
    let axes = [vector(3), vector(6), vector(9)];
    let lengths = axes.map(norm);
    for k in 0..3 {
        error::finite_vector(names[k], axes[k])?;
        let next = (k + 1) % 3;
        if lengths[k] <= 0.0 {
            return Err(Error::new(names[k], "must not be zero", axes[k]));
        }
        let unit = |k: usize| axes[k].map(|x| x / lengths[k]);
        if dot(unit(k), unit(next)).abs() > 1e-5 {
            let reason = "must be orthogonal to the other axes";
            return Err(Error::new(names[next], reason, axes[next]));
        }
    }
    Ok(())
}

pub(super) fn from_values<R: Real>(values: &[R]) -> AnisotropicGaussian<R> {
    let inverse = |i: usize| {
        let axis = [values[i], values[i + 1], values[i + 2]];
        let length = norm(axis);
        axis.map(|x| x / length / length)
    };
    AnisotropicGaussian {
        center: [values[0], values[1], values[2]],
        inverse_axes: [inverse(3), inverse(6), inverse(9)],
    }
}

impl<R: Real> AnisotropicGaussian<R> {
    /// w of a difference of points.
    fn along_axes(&self, vector: Vector<R>) -> Vector<R> {
        self.inverse_axes.map(|axis| dot(axis, vector))
    }

    fn standard(&self, point: Vector<R>) -> Vector<R> {
        self.along_axes(std::array::from_fn(|i| point[i] - self.center[i]))
    }

    fn bell(&self, ray: &Ray<R>) -> Bell<R> {
        Bell::standard(self.standard(ray.origin), self.along_axes(ray.direction))
    }

    /// What coordinates of this magnitude amount to along the axes.
    fn size(&self, magnitude: Vector<R>) -> Vector<R> {
        self.inverse_axes
            .map(|axis| dot(axis.map(Real::abs), magnitude))
    }
}

impl<R: Real> Profile<R> for AnisotropicGaussian<R> {
    /// (1)
    fn density(&self, point: Vector<R>) -> R {
        let w = self.standard(point);
        (-(dot(w, w) * w[0].lit(0.5))).exp()
    }

    fn density_along(&self, ray: &Ray<R>, t: R) -> (R, R) {
        self.bell(ray).density_along(t)
    }

    fn column(&self, ray: &Ray<R>, t: R) -> R {
        self.bell(ray).column(t)
    }

    /// (2)
    fn column_value_and_gradient(&self, ray: &Ray<R>, t: R) -> (R, Gradient<R>) {
        let from_center = std::array::from_fn(|i| ray.origin[i] - self.center[i]);
        let (w, e) = (self.along_axes(from_center), self.along_axes(ray.direction));
        let bell = Bell::standard(w, e);
        let moments = bell.moments(t);
        // In units of the standard deviation ρ′/r = −ρ; here −2κ² ρ = −|e|² ρ.
        let speed = norm(e);
        let unit = e.map(|x| x / speed);
        let by_standard = Pull::of_bell(bell.rate, &moments)
            .by_ray(across(w, unit), e)
            .map(|by| by.map(|x| x / speed / speed));

        let axes = self.inverse_axes;
        let by_ray = by_standard
            .map(|by| std::array::from_fn(|i| dot([axes[0][i], axes[1][i], axes[2][i]], by)));
        let [by_w, by_e] = by_standard;
        let by_axes = std::array::from_fn::<_, 3, _>(|k| {
            let inverse = axes[k];
            let by: Vector<R> =
                std::array::from_fn(|i| from_center[i] * by_w[k] + ray.direction[i] * by_e[k]);
            // 1/|a|² = |b|², and a/|a|² = b.
            let square = dot(inverse, inverse);
            let twice = dot(inverse, by) + dot(inverse, by);
            by.map(|x| x * square)
                .into_iter()
                .zip(inverse)
                .map(move |(x, b)| x - b * twice)
        });
        let shape: Parameters<R> = by_axes.into_iter().flatten().collect();
        around(moments.column, by_ray, &shape, moments.density)
    }

    fn inv_column(&self, ray: &Ray<R>, column: R) -> R {
        self.bell(ray).inv_column(column)
    }

    fn bounds(&self, ray: &Ray<R>, t: R) -> (R, R) {
        let magnitude = std::array::from_fn(|i| ray.origin[i].abs() + self.center[i].abs());
        let (d, e) = (self.standard(ray.origin), self.along_axes(ray.direction));
        between(on_segment(d, e, t, self.size(magnitude)))
    }

    fn bounds_in_box(&self, lo: Vector<R>, hi: Vector<R>) -> (R, R) {
        let zero = self.center[0].lit(0.0);
        let ends: [(R, R); 3] = self.inverse_axes.map(|axis| {
            (0..3).fold((zero, zero), |(low, high), i| {
                let a = climb(axis[i], lo[i] - self.center[i]);
                let b = climb(axis[i], hi[i] - self.center[i]);
                (low + a.min(b), high + a.max(b))
            })
        });
        let size = self.size(self.center.map(Real::abs));
        let spans = between(in_box(ends.map(|e| e.0), ends.map(|e| e.1), size));

        let least = self.inverse_axes.map(norm);
        let least = least[0].min(least[1]).min(least[2]);
        let scaled = |x: Vector<R>| std::array::from_fn(|i| climb(least, x[i] - self.center[i]));
        let center = self.center.map(|x| x.abs() * least);
        let ball = between(in_box(scaled(lo), scaled(hi), center));
        (spans.0, spans.1.min(ball.1))
    }

    fn detach(&self) -> Self {
        Self {
            center: self.center.map(Real::detach),
            inverse_axes: self.inverse_axes.map(|axis| axis.map(Real::detach)),
        }
    }
}
