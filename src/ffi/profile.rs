//! Questions to a profile.

use super::array::Array;
use super::query::{
    self, Model, RecordedModel, argument_check, argument_type, argument_value, queries,
};
use super::{
    AM_PROFILE_VALUES, AmArrayF32, AmArrayF64, AmHostTable, AmNode, AmProfile, AmStatus, Failure,
    arg, describe, guard,
};
use crate::geometry::Ray;
use crate::profile::{AnyProfile, Profile};
use crate::real::Real;
use crate::real::lanes::{F32Lanes, F64Lanes, Lanes};
use crate::real::node::Node;

/// A profile whose parameters are slots of a host's tape, so that they can change without
/// recording again, and carry derivatives.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct AmProfileNodes {
    /// Kind of profile, from `am_profile_kind`.
    pub kind: u32,
    /// Slots of the values of the parameters, in the order of `am_profile.values`.
    pub values: [AmNode; AM_PROFILE_VALUES],
}

/// Derivatives by origin, direction and the last argument.
pub(super) const RAY_DERIVATIVES: usize = 7;

impl Model for AmProfile {
    type In<R: Real> = AnyProfile<R>;

    fn check(&self) -> Result<(), Failure> {
        self.kind().map(drop)
    }

    fn lift<R: Real>(&self, lift: impl Fn(f64) -> R) -> AnyProfile<R> {
        let kind = self.kind().ok().expect("the profile has been checked");
        AnyProfile::from_values(kind, &self.values.map(lift))
    }
}

impl AmProfileNodes {
    pub(super) fn lift<'h>(&self, host: &'h AmHostTable) -> Result<AnyProfile<Node<'h>>, Failure> {
        let values = self.values.map(|slot| Node::new(host, slot));
        Ok(AnyProfile::from_values(
            describe::known(self.kind)?,
            &values,
        ))
    }
}

impl RecordedModel for AmProfileNodes {
    type In<R: Real> = AnyProfile<R>;

    unsafe fn nodes<'h>(&self, host: &'h AmHostTable) -> Result<AnyProfile<Node<'h>>, Failure> {
        self.lift(host)
    }
}

/// Number of derivatives of a column: by the values of the parameters of `profile`, by origin,
/// direction and distance.
///
/// # Safety
/// `profile` points to one struct, `size` to one number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn am_profile_gradient_size(
    profile: *const AmProfile,
    size: *mut usize,
) -> AmStatus {
    guard(|| {
        // SAFETY: promised by the caller.
        let kind = unsafe { arg::reference(profile, "profile") }?.kind()?;
        arg::output(size, 1, "size")?;
        // SAFETY: not null.
        unsafe { *size = kind.size() + RAY_DERIVATIVES };
        Ok(())
    })
}

queries! { AmProfile, AmProfileNodes;
    /// Relative density at a point: dimensionless, ≥ 0.
    ///
    /// # Safety
    /// `profile` points to one struct, `point` to three numbers, `density` to one.
    am_profile_density_f64 am_profile_density_f32
    am_profile_density_batch_f64 am_profile_density_batch_f32 am_profile_density_record
    |profile: AnyProfile, point: point| -> (density)
    [] results => { results.push(profile.density(point)); }

    /// Column: the integral of the density from the origin to the distance `t`, a length.
    ///
    /// `direction` is a unit vector, 0 ≤ `t` ≤ ∞. The column may be infinite. It does
    /// not decrease with `t` by more than rounding.
    ///
    /// # Safety
    /// `profile` points to one struct, `origin` and `direction` to three numbers, `column`
    /// to one.
    am_profile_column_f64 am_profile_column_f32
    am_profile_column_batch_f64 am_profile_column_batch_f32 am_profile_column_record
    |profile: AnyProfile, origin: point, direction: point, t: number| -> (column)
    [] results => { results.push(profile.column(&Ray { origin, direction }, t)); }

    /// The smallest distance at which the ray has gathered `column`, a length ≥ 0; infinite
    /// if it never does.
    ///
    /// # Safety
    /// `profile` points to one struct, `origin` and `direction` to three numbers, `t` to one.
    am_profile_inv_column_f64 am_profile_inv_column_f32
    am_profile_inv_column_batch_f64 am_profile_inv_column_batch_f32 am_profile_inv_column_record
    |profile: AnyProfile, origin: point, direction: point, column: number| -> (t)
    [] results => { results.push(profile.inv_column(&Ray { origin, direction }, column)); }

    /// The same for a column that the ray is known to gather, at less cost: the distance means
    /// nothing otherwise. For free flights that are known to end in a collision. A host's
    /// derivatives do not go through it.
    ///
    /// # Safety
    /// As for `am_profile_inv_column_f64`.
    am_profile_inv_reached_column_f64 am_profile_inv_reached_column_f32
    am_profile_inv_reached_column_batch_f64 am_profile_inv_reached_column_batch_f32
    am_profile_inv_reached_column_record
    |profile: AnyProfile, origin: point, direction: point, column: number| -> (t)
    [] results => { results.push(profile.inv_reached_column(&Ray { origin, direction }, column)); }

    /// The column, and its derivatives by everything that it depends on: one row of numbers.
    ///
    /// First the column; then its derivatives by the values of the parameters, in the order of
    /// `am_profile.values`, by the three components of the origin, by those of the direction,
    /// and by `t`: 1 + `am_profile_gradient_size` numbers in all.
    ///
    /// The direction counts as a free vector: the derivatives are those of the integral of the
    /// density over `origin + s direction`, 0 ≤ s ≤ `t`. All are 0 where the column is infinite.
    ///
    /// # Safety
    /// `profile` points to one struct, `origin` and `direction` to three numbers,
    /// `value_and_gradient` to as many as there are in a row.
    am_profile_column_value_and_gradient_f64 am_profile_column_value_and_gradient_f32
    am_profile_column_value_and_gradient_batch_f64 am_profile_column_value_and_gradient_batch_f32
    am_profile_column_value_and_gradient_record
    |profile: AnyProfile, origin: point, direction: point, t: number| -> (value_and_gradient)
    [] results => {
        let (value, gradient) = profile.column_value_and_gradient(&Ray { origin, direction }, t);
        results.push(value);
        results.extend(gradient.row());
    }

    /// The distance at which the ray has gathered `column`, and its derivatives: a row as that
    /// of `am_profile_column_value_and_gradient_f64`, whose last number is the derivative by
    /// `column`. By the implicit function theorem; all are 0 where the distance is infinite, and
    /// where there is no matter at that distance.
    ///
    /// # Safety
    /// As for `am_profile_column_value_and_gradient_f64`.
    am_profile_inv_column_value_and_gradient_f64 am_profile_inv_column_value_and_gradient_f32
    am_profile_inv_column_value_and_gradient_batch_f64
    am_profile_inv_column_value_and_gradient_batch_f32
    am_profile_inv_column_value_and_gradient_record
    |profile: AnyProfile, origin: point, direction: point, column: number| -> (value_and_gradient)
    [] results => {
        let ray = Ray { origin, direction };
        let (value, gradient) = profile.inv_column_value_and_gradient(&ray, column);
        results.push(value);
        results.extend(gradient.row());
    }

    /// Infimum and supremum of the density on the segment of length `t`, which may be
    /// infinite. True bounds: they are widened by the rounding error.
    ///
    /// # Safety
    /// `profile` points to one struct, `origin` and `direction` to three numbers, `inf` and
    /// `sup` to one.
    am_profile_bounds_f64 am_profile_bounds_f32
    am_profile_bounds_batch_f64 am_profile_bounds_batch_f32 am_profile_bounds_record
    |profile: AnyProfile, origin: point, direction: point, t: number| -> (inf, sup)
    [] results => { results.extend(<[R; 2]>::from(profile.bounds(&Ray { origin, direction }, t))); }

    /// Infimum and supremum of the density in the box with the corners `lo` and `hi`, which
    /// may be infinite. True bounds: they are widened by the rounding error.
    ///
    /// # Safety
    /// `profile` points to one struct, `lo` and `hi` to three numbers, `inf` and `sup` to one.
    am_profile_bounds_in_box_f64 am_profile_bounds_in_box_f32
    am_profile_bounds_in_box_batch_f64 am_profile_bounds_in_box_batch_f32
    am_profile_bounds_in_box_record
    |profile: AnyProfile, lo: point, hi: point| -> (inf, sup)
    [] results => { results.extend(<[R; 2]>::from(profile.bounds_in_box(lo, hi))); }
}
