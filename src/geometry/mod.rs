//! Rays, and altitudes above a plane; those above a sphere are in [`planet`].

pub mod planet;

use crate::real::Real;
use glam::{DVec3, Vec3};

/// A point, a direction or an axis.
pub type Vector<R> = [R; 3];

/// Scalar product.
pub fn dot<R: Real>(a: Vector<R>, b: Vector<R>) -> R {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// Length of a vector, without overflow on the way; its derivative at zero is zero.
pub fn norm<R: Real, const N: usize>(vector: [R; N]) -> R {
    let zero = vector[0].lit(0.0);
    let least = zero.lit(if zero.digits() <= 24 { 1e-37 } else { 1e-300 });
    let largest = vector.iter().fold(least, |m, x| m.max(x.abs()));
    let scale = zero.lit(1.0) / largest;
    let sum = vector
        .iter()
        .map(|x| *x * scale)
        .fold(zero, |sum, x| x.mul_add(x, sum));
    let length = largest * sum.max(zero.lit(1.0)).sqrt();
    R::select(least.lt(largest), length, zero)
}

/// A ray `origin + t direction`; `direction` is a unit vector.
#[derive(Clone, Copy, Debug)]
pub struct Ray<R> {
    /// Where t = 0.
    pub origin: Vector<R>,
    /// Unit vector.
    pub direction: Vector<R>,
}

impl<R: Real> Ray<R> {
    /// The point at distance `t`, which must be finite.
    pub fn at(&self, t: R) -> Vector<R> {
        std::array::from_fn(|i| t.mul_add(self.direction[i], self.origin[i]))
    }
}

impl<R: Real> Ray<R> {
    /// The same ray without derivatives.
    pub fn detach(&self) -> Self {
        Self {
            origin: self.origin.map(Real::detach),
            direction: self.direction.map(Real::detach),
        }
    }
}

impl Ray<f64> {
    /// The ray from `origin` along the unit vector `direction`.
    #[must_use]
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self {
            origin: origin.to_array(),
            direction: direction.to_array(),
        }
    }
}

impl Ray<f32> {
    /// The ray from `origin` along the unit vector `direction`.
    #[must_use]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self {
            origin: origin.to_array(),
            direction: direction.to_array(),
        }
    }
}

/// The plane that altitudes are counted from.
#[derive(Clone, Copy, Debug)]
pub struct Plane<R> {
    /// Unit normal; altitude grows along it.
    pub up: Vector<R>,
    /// `up · x` on the plane.
    pub base_height: R,
}

impl<R: Real> Plane<R> {
    /// Altitude of `point`, length.
    pub fn altitude(&self, point: Vector<R>) -> R {
        dot(self.up, point) - self.base_height
    }

    /// μ: altitude gained per unit of distance along `direction`.
    pub fn cos_zenith(&self, direction: Vector<R>) -> R {
        dot(self.up, direction)
    }

    /// Altitudes of both ends of a segment of length `t`, which may be infinite.
    pub fn ends(&self, ray: &Ray<R>, t: R) -> (R, R) {
        let start = self.altitude(ray.origin);
        (start, start + climb(self.cos_zenith(ray.direction), t))
    }

    /// Rounding error of the altitude of a point whose coordinates are at most
    /// `magnitude` in absolute value. Bounds are widened by it.
    fn rounding(&self, magnitude: Vector<R>) -> R {
        let up = self.up.map(Real::abs);
        let sum = (0..3).fold(self.base_height.abs(), |sum, i| {
            sum + climb(up[i], magnitude[i])
        });
        let error = sum * sum.unit_roundoff() * sum.lit(8.0);
        R::select(error.is_bounded(), error, error.lit(0.0))
    }

    /// Lowest and highest altitude on a segment, rounding included.
    pub fn range(&self, ray: &Ray<R>, t: R) -> (R, R) {
        let (a, b) = self.ends(ray, t);
        let finite = t.is_bounded();
        let far = ray.at(R::select(finite, t, t.lit(0.0)));
        let magnitude = std::array::from_fn(|i| ray.origin[i].abs().max(far[i].abs()));
        let error = self.rounding(magnitude);
        (a.min(b) - error, a.max(b) + error)
    }

    /// Lowest and highest altitude in the box between the corners `lo` and `hi`,
    /// rounding included. Corners may be infinite.
    pub fn range_in_box(&self, lo: Vector<R>, hi: Vector<R>) -> (R, R) {
        let mut range = (-self.base_height, -self.base_height);
        for i in 0..3 {
            let (a, b) = (climb(self.up[i], lo[i]), climb(self.up[i], hi[i]));
            range = (range.0 + a.min(b), range.1 + a.max(b));
        }
        let magnitude = std::array::from_fn(|i| lo[i].abs().max(hi[i].abs()));
        let error = self.rounding(magnitude);
        (range.0 - error, range.1 + error)
    }

    /// The same plane without derivatives.
    pub fn detach(&self) -> Self {
        Self {
            up: self.up.map(Real::detach),
            base_height: self.base_height.detach(),
        }
    }
}

/// slope · t, where an infinite t makes nothing of a slope of zero.
pub fn climb<R: Real>(slope: R, t: R) -> R {
    let (zero, infinity) = (slope.lit(0.0), slope.lit(f64::INFINITY));
    let endless = R::select(
        slope.lt(zero),
        -infinity,
        R::select(zero.lt(slope), infinity, zero),
    );
    let finite = t.abs().is_bounded();
    let product = slope * R::select(finite, t, zero);
    let sign = R::select(t.lt(zero), -endless, endless);
    R::select(finite, product, sign)
}
