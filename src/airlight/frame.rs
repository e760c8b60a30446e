//! A ray as the light sees it.

use super::light::{Light, Toward};
use super::phase::Deflection;
use crate::geometry::{Ray, Vector, dot, norm};
use crate::real::Real;

/// Ray and light. Distances s along the ray are counted from the foot.
#[derive(Clone, Copy, Debug)]
pub struct Frame<R> {
    /// h > 0: distance of the light from the ray, length.
    pub height: R,
    /// s of the point t = 0 of the ray: −x_h, length.
    pub start: R,
    /// d_el: cosine between the ray and the axis of the light.
    pub axial: R,
    /// h d_c: the foot as seen from the light, along its axis, length.
    pub lateral: R,
    /// The same two across the axis.
    axial_across: Vector<R>,
    lateral_across: Vector<R>,
}

fn cross<R: Real>(a: Vector<R>, b: Vector<R>) -> Vector<R> {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}

impl<R: Real> Frame<R> {
    /// The frame of `ray` and `light`.
    ///
    /// A ray through the light has no finite radiance: h is kept at 1e-18 (f32) or 1e-150 (f64).
    pub fn new(ray: &Ray<R>, light: &Light<R>) -> Self {
        let offset: Vector<R> = std::array::from_fn(|i| light.position[i] - ray.origin[i]);
        let along = dot(offset, ray.direction);
        let foot = std::array::from_fn(|i| along.mul_add(ray.direction[i], -offset[i]));
        let least = if along.digits() <= 24 { 1e-18 } else { 1e-150 };
        Self {
            height: norm(foot).max(along.lit(least)),
            start: -along,
            axial: dot(ray.direction, light.axis),
            lateral: dot(foot, light.axis),
            axial_across: cross(ray.direction, light.axis),
            lateral_across: cross(foot, light.axis),
        }
    }

    /// The same frame in another arithmetic.
    pub fn map<S>(&self, lift: impl Fn(R) -> S) -> Frame<S> {
        Frame {
            height: lift(self.height),
            start: lift(self.start),
            axial: lift(self.axial),
            lateral: lift(self.lateral),
            axial_across: self.axial_across.map(&lift),
            lateral_across: self.lateral_across.map(&lift),
        }
    }

    /// What stands for an infinite distance: its square is a number of the format.
    pub(crate) fn far(&self) -> R {
        let single = self.height.digits() <= 24;
        self.height.lit(if single { 1e15 } else { 1e120 })
    }

    /// A square that is next to nothing.
    pub(crate) fn least(&self) -> f64 {
        if self.height.digits() <= 24 {
            1e-36
        } else {
            1e-300
        }
    }

    /// Square of the sine between the ray and the axis of the light.
    pub(crate) fn oblique(&self) -> R {
        dot(self.axial_across, self.axial_across)
    }

    /// √(h² + s²): distance from the light, length.
    pub fn distance(&self, s: R) -> R {
        s.mul_add(s, self.height * self.height).sqrt()
    }

    /// The angle at the light of the point `point`.
    pub fn toward(&self, point: &Point<R>) -> Toward<R> {
        let Point { sign, norm, .. } = *point;
        let along = sign * (norm.lit(1.0) - point.w_square) * norm;
        let across = (point.q + point.q) * norm;
        Toward {
            cos: along.mul_add(self.axial, across * self.lateral),
            across: std::array::from_fn(|i| {
                along.mul_add(self.axial_across[i], across * self.lateral_across[i])
            }),
        }
    }
}

/// A point of the ray by w = hq = h/(D + |s|), D its distance from the light: |s|/D = (1 − w²)/(1 + w²).
#[derive(Clone, Copy, Debug)]
pub struct Point<R> {
    /// −1 before the foot, 1 beyond it.
    sign: R,
    q: R,
    w_square: R,
    /// 1/(1 + w²)
    pub(crate) norm: R,
}

impl<R: Real> Point<R> {
    /// The point at `q` = w/`height` on the side `sign`.
    pub fn new(sign: R, q: R, height: R) -> Self {
        let (one, w) = (q.lit(1.0), height * q);
        let w_square = w * w;
        Self {
            sign,
            q,
            w_square,
            norm: one / (one + w_square),
        }
    }

    /// The angle of scattering: light that arrives before the foot goes on forward.
    pub fn deflection(&self) -> Deflection<R> {
        let Self { sign, norm, .. } = *self;
        let (near, far) = ((self.w_square + self.w_square) * norm, norm + norm);
        let before = sign.lt(sign.lit(0.0));
        Deflection {
            cos: sign * (near - sign.lit(1.0)),
            from_forward: R::select(before, near, far),
            from_backward: R::select(before, far, near),
        }
    }
}
