//! Derivatives of columns and of their inverses: by the parameters of a profile, and by the ray.
//!
//!     N(o, d, t; θ) = ∫₀ᵗ ρ(o + s d; θ) ds                            (1)
//!     ∂N/∂t = ρ(t),   ∂N/∂o = ∫ ∇ρ ds,   ∂N/∂d = ∫ s ∇ρ ds            (2)
//!     ∂t/∂θ = −(∂N/∂θ)/ρ(t),   ∂t/∂N = 1/ρ(t)                         (3)
//!
//! The direction counts as a free vector in (1), whose length need not stay 1, and so do an
//! `up` and the axes of a profile, which the density is written with. Who only turns a
//! direction uses the part of its derivative that is perpendicular to it. Along the ray there
//! is nothing new: d · ∂N/∂o = ρ(t) − ρ(0) and d · ∂N/∂d = t ρ(t) − N.
//!
//! Where ρ depends on the distance r from a centre, x being the distance along the ray from
//! the perigee and q⊥ the vector from the centre to the perigee, ∇ρ = ρ′/r (q⊥ + x d), and
//! (2) comes down to four integrals:
//!
//!     ∂N/∂o = q⊥ ∫ρ′/r ds + d ∫ρ′ x/r ds,   ∂N/∂d = q⊥ ∫s ρ′/r ds + d ∫s ρ′ x/r ds   (4)
//!
//! (3) is the implicit function theorem: nothing is differentiated through an iteration.
//!
//! Where a column is infinite, or is never reached, its derivatives are 0; and so is a derivative
//! that the number format cannot hold.

use crate::geometry::{Ray, Vector};
use crate::real::Real;
use crate::special::gaussian::Moments;
use smallvec::SmallVec;

/// A derivative by each parameter; no profile has more.
pub type Parameters<R> = SmallVec<[R; 12]>;

/// The derivatives of a number that was asked of a ray.
#[derive(Clone, Debug)]
pub struct Gradient<R> {
    /// By the values of the parameters, in their order.
    pub parameters: Parameters<R>,
    /// By the origin of the ray.
    pub origin: Vector<R>,
    /// By its direction, as a free vector.
    pub direction: Vector<R>,
    /// By the last argument of the question: the distance, or the column.
    pub last: R,
}

impl<R: Real> Gradient<R> {
    /// All derivatives in one row: parameters, origin, direction, last argument.
    pub fn row(&self) -> impl Iterator<Item = R> {
        let ray = self.origin.iter().chain(&self.direction);
        self.parameters
            .iter()
            .chain(ray)
            .chain([&self.last])
            .copied()
    }

    /// The same, each derivative through `f`.
    #[must_use]
    pub(crate) fn map(self, mut f: impl FnMut(R) -> R) -> Self {
        Self {
            parameters: self.parameters.into_iter().map(&mut f).collect(),
            origin: self.origin.map(&mut f),
            direction: self.direction.map(&mut f),
            last: f(self.last),
        }
    }

    /// That of `value`: 0 where it is infinite, as is what the number format cannot hold.
    #[must_use]
    pub fn of(self, value: R) -> Self {
        let bounded = value.is_bounded();
        self.map(|x| held(x, bounded))
    }

    /// (3): that of the distance at which the number is reached, if this is that of the number
    /// by the distance, here.
    #[must_use]
    pub fn implicit(self, reached: R::Mask) -> Self {
        let (by_goal, dense) = reciprocal(self.last, reached);
        let by = |x: R| implicit(x, by_goal, dense);
        Self {
            parameters: self.parameters.into_iter().map(by).collect(),
            origin: self.origin.map(by),
            direction: self.direction.map(by),
            last: by_goal,
        }
    }
}

/// −(∂N/∂θ)/ρ of (3).
pub(crate) fn implicit<R: Real>(x: R, by_goal: R, dense: R::Mask) -> R {
    -(R::select(dense, x, x.lit(0.0)) * by_goal)
}

/// `x` where the mask is set and the number format holds it, else 0.
pub(crate) fn held<R: Real>(x: R, mask: R::Mask) -> R {
    R::select(mask & x.abs().is_bounded(), x, x.lit(0.0))
}

/// 1/ρ of (3), and 0 outside of the mask: where the goal is not reached, or where there is nothing.
pub(crate) fn reciprocal<R: Real>(density: R, reached: R::Mask) -> (R, R::Mask) {
    let (zero, one) = (density.lit(0.0), density.lit(1.0));
    let dense = reached & zero.lt(density) & density.is_bounded();
    let inverse = one / R::select(dense, density, one);
    (R::select(dense, inverse, zero), dense)
}

/// The integrals of (4).
#[derive(Clone, Copy, Debug)]
pub(super) struct Pull<R> {
    /// ∫ρ′/r ds and ∫s ρ′/r ds.
    pub across: [R; 2],
    /// ∫ρ′ x/r ds and ∫s ρ′ x/r ds.
    pub along: [R; 2],
}

impl<R: Real> Pull<R> {
    /// Those of a Gaussian, where ρ′/r = −2κ² ρ with the `rate` κ along the ray.
    pub fn of_bell(rate: R, moments: &Moments<R>) -> Self {
        let slope = -(rate + rate);
        let [along, along_distance] = moments.along;
        Self {
            across: [rate * slope * moments.column, slope * moments.distance],
            along: [slope * along, -(along_distance + along_distance)],
        }
    }

    /// (4): by origin and direction.
    pub fn by_ray(&self, across: Vector<R>, direction: Vector<R>) -> [Vector<R>; 2] {
        [0, 1].map(|k| {
            std::array::from_fn(|i| across[i] * self.across[k] + direction[i] * self.along[k])
        })
    }
}

/// The part of `vector` that is perpendicular to the unit vector `direction`.
pub(super) fn across<R: Real>(vector: Vector<R>, direction: Vector<R>) -> Vector<R> {
    cross(direction, cross(vector, direction))
}

fn cross<R: Real>(a: Vector<R>, b: Vector<R>) -> Vector<R> {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}

/// Derivatives of a column by the centre and by further parameters, for a profile around a
/// centre: moving the centre is moving the origin the other way.
pub(super) fn around<R: Real>(
    value: R,
    [origin, direction]: [Vector<R>; 2],
    shape: &[R],
    last: R,
) -> (R, Gradient<R>) {
    let center = origin.map(|x| -x);
    let gradient = Gradient {
        parameters: center.iter().chain(shape).copied().collect(),
        origin,
        direction,
        last,
    };
    (value, gradient.of(value))
}

/// `number` of the ray `distance` far away, and 0 if that is infinite.
pub(super) fn at_end<R: Real>(t: R, number: impl FnOnce(R) -> R) -> R {
    let (zero, finite) = (t.lit(0.0), t.is_bounded());
    R::select(finite, number(R::select(finite, t, zero)), zero)
}

/// (3) for the distance `t` at which a ray gathers a column: its derivatives from those of
/// the column there, `of_column(t)`.
pub(super) fn of_inverse<R: Real>(
    t: R,
    of_column: impl FnOnce(R) -> (R, Gradient<R>),
) -> (R, Gradient<R>) {
    let reached = t.is_bounded();
    let (_, gradient) = of_column(R::select(reached, t, t.lit(0.0)));
    (t, gradient.implicit(reached))
}

/// The vector from `center` to the perigee of the ray.
pub(super) fn to_perigee<R: Real>(center: Vector<R>, ray: &Ray<R>) -> Vector<R> {
    let from_center = std::array::from_fn(|i| ray.origin[i] - center[i]);
    across(from_center, ray.direction)
}
