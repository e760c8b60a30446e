//! Point lights: intensity by the angle θ from an axis, 1 on it.
//!
//!     isotropic    1
//!     lobes        cosᵖ θ, p even                         two lobes (the paper, Eq. 41)
//!     spot         max(0, cos θ)ᵖ                         one
//!     cone         1 up to the beam width, then linear in θ down to 0 at the cutoff angle,
//!                  as Mitsuba's `spot` emitter
//!
//! `Intensity::lit` is the part of a ray where the intensity is not 0, and what lies between its
//! kinks: nothing is integrated, and no series is summed, across them.

use super::frame::Frame;
use crate::geometry::Vector;
use crate::real::Real;
use crate::special::angle::{atan2, sin_cos};

/// A point light.
#[derive(Clone, Copy, Debug)]
pub struct Light<R> {
    /// Where it is.
    pub position: Vector<R>,
    /// Unit vector that angles are counted from.
    pub axis: Vector<R>,
    /// How its intensity depends on them.
    pub intensity: Intensity<R>,
}

/// Intensity by the angle from the axis.
#[derive(Clone, Copy, Debug)]
pub enum Intensity<R> {
    /// The same in all directions.
    Isotropic,
    /// cosᵖ θ.
    Lobes {
        /// p, even.
        exponent: u32,
    },
    /// max(0, cos θ)ᵖ.
    Spot {
        /// p ≥ 1.
        exponent: u32,
    },
    /// A cone with a linear edge.
    Cone {
        /// Angle from the axis where the light ends, in (0, π/2), radians.
        cutoff_angle: R,
        /// Angle from the axis where it begins to fall, in [0, `cutoff_angle`], radians.
        beam_width: R,
    },
}

/// x to the power n.
pub(crate) fn power<R: Real>(x: R, n: u32) -> R {
    let (mut result, mut square) = (None, x);
    for bit in 0..u32::BITS - n.leading_zeros() {
        if n >> bit & 1 == 1 {
            result = Some(result.map_or(square, |r| r * square));
        }
        square = square * square;
    }
    result.unwrap_or(x.lit(1.0))
}

/// Where a light is seen from: cosine and sine of the angle from its axis, times the same number.
#[derive(Clone, Copy, Debug)]
pub struct Toward<R> {
    /// cos θ.
    pub cos: R,
    /// sin θ ≥ 0 as a vector across the axis.
    pub across: Vector<R>,
}

impl<R: Real> Intensity<R> {
    /// Relative intensity in [0, 1].
    pub fn value(&self, toward: &Toward<R>) -> R {
        let cos = toward.cos;
        let (zero, one) = (cos.lit(0.0), cos.lit(1.0));
        match *self {
            Intensity::Isotropic => one,
            Intensity::Lobes { exponent } => power(cos, exponent),
            Intensity::Spot { exponent } => power(cos.max(zero), exponent),
            Intensity::Cone {
                cutoff_angle,
                beam_width,
            } => {
                let least = cos.lit(if cos.digits() <= 24 { 1e-18 } else { 1e-150 });
                let [x, y, z] = toward.across;
                let square = x * x + y * y + z * z;
                let sin = square.max(least * least).sqrt();
                let width = (cutoff_angle - beam_width).max(least);
                ((cutoff_angle - atan2(sin, cos)) / width)
                    .max(zero)
                    .min(one)
            }
        }
    }

    /// The same intensity in another arithmetic.
    pub fn map<S>(&self, lift: impl Fn(R) -> S) -> Intensity<S> {
        match *self {
            Intensity::Isotropic => Intensity::Isotropic,
            Intensity::Lobes { exponent } => Intensity::Lobes { exponent },
            Intensity::Spot { exponent } => Intensity::Spot { exponent },
            Intensity::Cone {
                cutoff_angle,
                beam_width,
            } => Intensity::Cone {
                cutoff_angle: lift(cutoff_angle),
                beam_width: lift(beam_width),
            },
        }
    }

    /// p, which says how slowly the intensity grows from 0 at the edge.
    pub(crate) fn exponent(&self) -> u32 {
        match *self {
            Intensity::Isotropic => 0,
            Intensity::Cone { .. } => 1,
            Intensity::Lobes { exponent } | Intensity::Spot { exponent } => exponent,
        }
    }

    /// Ends of the lit part of the ray, and its kinks, as ascending signed distances from the foot;
    /// all equal where nothing is lit. Distances from `from` to `to` count.
    pub(crate) fn lit(&self, frame: &Frame<R>, from: R, to: R) -> Lit<R> {
        let clip = |s: R| s.max(from).min(to);
        match *self {
            Intensity::Isotropic | Intensity::Lobes { .. } => Lit::whole(from, to),
            Intensity::Spot { .. } => {
                let (first, last) = half_space(frame);
                Lit::whole(clip(first), clip(last))
            }
            Intensity::Cone {
                cutoff_angle,
                beam_width,
            } => {
                let (first, last) = cone(frame, cutoff_angle);
                let (first, last) = (clip(first), clip(last));
                let (begin, end) = cone(frame, beam_width);
                let inside = |s: R| s.max(first).min(last);
                Lit {
                    first,
                    last,
                    kinks: Some((inside(begin), inside(end))),
                }
            }
        }
    }
}

/// A part of a ray, by signed distances from the foot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lit<R> {
    pub first: R,
    pub last: R,
    /// Between them, in this order.
    pub kinks: Option<(R, R)>,
}

impl<R> Lit<R> {
    fn whole(first: R, last: R) -> Self {
        let kinks = None;
        Self { first, last, kinks }
    }
}

/// Where cos θ > 0: s d_el + h d_c > 0.
fn half_space<R: Real>(frame: &Frame<R>) -> (R, R) {
    let zero = frame.axial.lit(0.0);
    let far = frame.far();
    let edge = -frame.lateral / away_from_zero(frame.axial);
    let edge = edge.max(-far).min(far);
    let along = zero.le(frame.axial);
    (R::select(along, edge, -far), R::select(along, far, edge))
}

/// Where θ ≤ `angle` < π/2. The points whose cosine is ±cos(angle) are the zeros of
///
///     (s d_el + h d_c)² − C² (s² + h²) = a s² + 2 b s + c,   C = cos(angle).
///
/// For a < 0 the ray passes through the cone, or misses it: then both ends are the point that is
/// nearest to the axis. For a > 0 it stays inside towards one of its ends.
fn cone<R: Real>(frame: &Frame<R>, angle: R) -> (R, R) {
    let (zero, far) = (angle.lit(0.0), frame.far());
    let (height, axial, lateral) = (frame.height, frame.axial, frame.lateral);
    let (sin, cos) = sin_cos(angle);
    // d_el² + |d × axis|² = 1 for a unit vector.
    let a = sin * sin - frame.oblique();
    let b = lateral * axial;
    let c = (lateral - cos * height) * (lateral + cos * height);
    let root_square = lateral.mul_add(lateral, height * height * a);
    let root = cos * root_square.max(zero.lit(frame.least())).sqrt();

    let sum = -(b + R::select(b.lt(zero), -root, root));
    let sum = away_from_zero(sum);
    let (one, other) = (sum / away_from_zero(a), c / sum);
    let (one, other) = (one.max(-far).min(far), other.max(-far).min(far));
    let (low, high) = (one.min(other), one.max(other));

    let inside = zero.lt(a);
    let forward = zero.le(axial);
    let nearest = axial * height * height / lateral.max(zero.lit(frame.least()));
    let nearest = nearest.max(-far).min(far);
    let through = zero.lt(root_square) & zero.lt((low + high).mul_add(axial, lateral + lateral));
    let first = R::select(forward, high, -far);
    let last = R::select(forward, far, low);
    (
        R::select(inside, first, R::select(through, low, nearest)),
        R::select(inside, last, R::select(through, high, nearest)),
    )
}

/// x, or a number of its sign that can divide.
fn away_from_zero<R: Real>(x: R) -> R {
    let least = x.lit(if x.digits() <= 24 { 1e-30 } else { 1e-250 });
    let tiny = R::select(x.lt(x.lit(0.0)), -least, least);
    R::select(x.abs().lt(least), tiny, x)
}
