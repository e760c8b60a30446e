//! Inverse columns of spherical layers, by iteration along a ray as their centre sees it.
//!
//! What a ray has in common at all distances is worked out once, as its [`Passage`].

use super::Profile;
use crate::geometry::Ray;
use crate::geometry::planet::{Passage, Sphere};
use crate::real::Real;
use crate::solve::{self, Start};

/// A profile of spherical layers whose column has no closed inverse.
pub(super) trait Layers<R: Real>: Profile<R> + Sized {
    /// What altitudes are counted from.
    fn sphere(&self) -> &Sphere<R>;

    /// N(t).
    fn column_of(&self, passage: &Passage<R>, t: R) -> R;

    /// ρ(t) and ρ′(t).
    fn slopes(&self, passage: &Passage<R>, t: R) -> (R, R);

    /// Where to look for the distance at which `column` is gathered.
    fn start(&self, passage: &Passage<R>, column: R) -> Start<R>;
}

/// The smallest distance at which the ray has gathered `column`, infinite if it never does:
/// `reaches` tells that from the column and that of the whole ray.
pub(super) fn inv_column<R: Real>(
    profile: &impl Layers<R>,
    ray: &Ray<R>,
    column: R,
    reaches: impl Fn(R, R) -> R::Mask,
) -> R {
    let (zero, one, infinity) = (column.lit(0.0), column.lit(1.0), column.lit(f64::INFINITY));
    let plain = profile.detach();
    let passage = plain.sphere().passage(&ray.detach());
    let total = plain.column_of(&passage, infinity);
    let some = zero.lt(column);
    let reached = some & reaches(column, total);

    let target = R::select(reached, column, total.min(one) * column.lit(0.5));
    let t = solve::increasing(
        |t| plain.column_of(&passage, t),
        |t| plain.slopes(&passage, t),
        |t| profile.column(ray, t),
        target,
        plain.start(&passage, target.detach()),
    );
    R::select(reached, t, R::select(some, infinity, zero))
}

/// The same for a column that the ray is known to gather, without derivatives.
pub(super) fn inv_reached_column<R: Real>(profile: &impl Layers<R>, ray: &Ray<R>, column: R) -> R {
    let (plain, goal) = (profile.detach(), column.detach());
    let passage = plain.sphere().passage(&ray.detach());
    let (t, _) = solve::iterate(
        |t| plain.column_of(&passage, t),
        |t| plain.slopes(&passage, t),
        goal,
        plain.start(&passage, goal),
    );
    let zero = goal.lit(0.0);
    R::select(zero.lt(goal), t, zero)
}
