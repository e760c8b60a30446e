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
