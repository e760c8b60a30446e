//! Questions to a medium: a sum of profiles, in one or more channels.

use super::array::Array;
use super::profile::RAY_DERIVATIVES;
use super::query::{
    self, Model, RecordedModel, argument_check, argument_type, argument_value, queries,
};
use super::{
    AmArrayF32, AmArrayF64, AmHostTable, AmNode, AmProfile, AmProfileNodes, AmStatus, Failure, arg,
    guard,
};
use crate::error;
use crate::geometry::Ray;
use crate::medium::{self, Medium};
use crate::real::Real;
use crate::real::lanes::{F32Lanes, F64Lanes, Lanes};
use crate::real::node::Node;
use crate::sampling;

/// A medium: `n_components` profiles, each with an attenuation coefficient per channel
/// (wavelength, colour). It borrows the arrays.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct AmMedium {
    /// The profiles.
    pub profiles: *const AmProfile,
    /// Attenuation coefficients at relative density 1, 1/length, ≥ 0: those of the first
    /// component for all channels, then those of the second, and so on.
    pub sigma_t: *const f64,
    /// Number of components, at least 1.
    pub n_components: usize,
    /// Number of channels, at least 1.
    pub n_channels: usize,
}

/// A medium whose numbers are slots of a host's tape.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct AmMediumNodes {
    /// The profiles.
    pub profiles: *const AmProfileNodes,
    /// Slots of the attenuation coefficients, in the order of `am_medium.sigma_t`.
    pub sigma_t: *const AmNode,
    /// Number of components, at least 1.
    pub n_components: usize,
    /// Number of channels, at least 1.
    pub n_channels: usize,
}

fn check_channel(channel: usize, n_channels: usize) -> Result<(), Failure> {
    if channel < n_channels {
        return Ok(());
    }
    let message = format!("channel must be < {n_channels}, got {channel}");
    Err(Failure::new(AmStatus::InvalidArgument, message))
}

impl AmMedium {
    /// Profiles and coefficients.
    fn parts(&self) -> Result<(&[AmProfile], &[f64]), Failure> {
        arg::count(self.n_components, "n_components")?;
        arg::count(self.n_channels, "n_channels")?;
        // SAFETY: promised by the caller who made the struct.
        unsafe {
            let profiles = arg::slice(self.profiles, self.n_components, "profiles")?;
            let n = self.n_components * self.n_channels;
            Ok((profiles, arg::slice(self.sigma_t, n, "sigma_t")?))
        }
    }
}

impl Model for AmMedium {
    type In<R: Real> = Medium<R>;

    fn check(&self) -> Result<(), Failure> {
        let (profiles, _) = self.parts()?;
        profiles.iter().try_for_each(Model::check)
    }

    fn lift<R: Real>(&self, lift: impl Fn(f64) -> R) -> Medium<R> {
        let (profiles, sigma_t) = self.parts().ok().expect("the medium has been checked");
        let profiles = profiles.iter().map(|profile| profile.lift(&lift)).collect();
        Medium::new(profiles, sigma_t.iter().map(|s| lift(*s)).collect())
    }
}

impl RecordedModel for AmMediumNodes {
    type In<R: Real> = Medium<R>;

    unsafe fn nodes<'h>(&self, host: &'h AmHostTable) -> Result<Medium<Node<'h>>, Failure> {
        arg::count(self.n_components, "n_components")?;
        arg::count(self.n_channels, "n_channels")?;
        // SAFETY: promised by the caller.
        let (profiles, sigma_t) = unsafe {
            let n = self.n_components * self.n_channels;
            (
                arg::slice(self.profiles, self.n_components, "profiles")?,
                arg::slice(self.sigma_t, n, "sigma_t")?,
            )
        };
        let profiles = profiles.iter().map(|profile| profile.lift(host));
        let sigma_t = sigma_t.iter().map(|slot| Node::new(host, *slot)).collect();
        Ok(Medium::new(profiles.collect::<Result<_, _>>()?, sigma_t))
    }
}

/// Checks profiles and coefficients of a medium. The questions below check counts, kinds
/// and pointers only: they answer a medium that does not pass with NaN or nonsense, but
/// never fail.
///
/// # Safety
/// `medium` points to one struct, and its arrays have the lengths that it says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn am_medium_check(medium: *const AmMedium) -> AmStatus {
    guard(|| {
        // SAFETY: promised by the caller.
        let medium = unsafe { arg::reference(medium, "medium") }?;
        let (profiles, sigma_t) = medium.parts()?;
        for profile in profiles {
            profile.check()?;
        }
        for sigma in sigma_t {
            error::not_negative("sigma_t", *sigma)?;
        }
        Ok(())
    })
}

/// Number of derivatives of an optical depth: by the coefficient and the values of the parameters
/// of each component, by origin, direction and distance.
///
/// # Safety
/// `medium` points to one struct, and its arrays have the lengths that it says; `size` points to
/// one number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn am_medium_gradient_size(
    medium: *const AmMedium,
    size: *mut usize,
) -> AmStatus {
    guard(|| {
        // SAFETY: promised by the caller.
        let (profiles, _) = unsafe { arg::reference(medium, "medium") }?.parts()?;
        arg::output(size, 1, "size")?;
        let mut sum = RAY_DERIVATIVES;
        for profile in profiles {
            sum += 1 + profile.kind()?.size();
        }
        // SAFETY: not null.
        unsafe { *size = sum };
        Ok(())
    })
}

queries! { AmMedium, AmMediumNodes;
    /// Attenuation coefficient at a point, 1/length, one per channel.
    ///
    /// # Safety
    /// `medium` points to one struct, `point` to three numbers, `extinction` to one per
    /// channel.
    am_medium_extinction_f64 am_medium_extinction_f32
    am_medium_extinction_batch_f64 am_medium_extinction_batch_f32 am_medium_extinction_record
    |medium: Medium, point: point| -> (extinction)
    [] results => { results.extend(medium.extinction(point)); }

    /// Optical depth from the origin to the distance `t` (0 ≤ `t` ≤ ∞), dimensionless, one
    /// per channel. It may be infinite, and does not decrease with `t` by more than rounding.
    ///
    /// # Safety
    /// `medium` points to one struct, `origin` and `direction` to three numbers,
    /// `optical_depth` to one per channel.
    am_medium_optical_depth_f64 am_medium_optical_depth_f32
    am_medium_optical_depth_batch_f64 am_medium_optical_depth_batch_f32
    am_medium_optical_depth_record
    |medium: Medium, origin: point, direction: point, t: number| -> (optical_depth)
    [] results => { results.extend(medium.optical_depth(&Ray { origin, direction }, t)); }

    /// Transmittance from the origin to the distance `t`: exp(−optical depth), one per
    /// channel.
    ///
    /// # Safety
    /// As for `am_medium_optical_depth_f64`.
    am_medium_transmittance_f64 am_medium_transmittance_f32
    am_medium_transmittance_batch_f64 am_medium_transmittance_batch_f32
    am_medium_transmittance_record
    |medium: Medium, origin: point, direction: point, t: number| -> (transmittance)
    [] results => {
        results.extend(medium.optical_depth(&Ray { origin, direction }, t).map(medium::transmittance));
    }

    /// Opacity from the origin to the distance `t`: 1 − transmittance without cancellation,
    /// one per channel.
    ///
    /// # Safety
    /// As for `am_medium_optical_depth_f64`.
    am_medium_opacity_f64 am_medium_opacity_f32
    am_medium_opacity_batch_f64 am_medium_opacity_batch_f32 am_medium_opacity_record
    |medium: Medium, origin: point, direction: point, t: number| -> (opacity)
    [] results => {
        results.extend(medium.optical_depth(&Ray { origin, direction }, t).map(medium::opacity));
    }

    /// Bounds of the attenuation coefficient on the segment of length `t`, 1/length, one
    /// pair per channel. True bounds, and tight for a single component.
    ///
    /// # Safety
    /// As for `am_medium_optical_depth_f64`, with room for one number per channel in each
    /// output.
    am_medium_bounds_f64 am_medium_bounds_f32
    am_medium_bounds_batch_f64 am_medium_bounds_batch_f32 am_medium_bounds_record
    |medium: Medium, origin: point, direction: point, t: number| -> (minorant, majorant)
    [] results => {
        let (inf, sup): (Vec<_>, Vec<_>) = medium.bounds(&Ray { origin, direction }, t).unzip();
        results.extend(inf.into_iter().chain(sup));
    }

    /// Bounds of the attenuation coefficient in the box with the corners `lo` and `hi`,
    /// 1/length, one pair per channel. True bounds, and tight for a single component.
    ///
    /// # Safety
    /// `medium` points to one struct, `lo` and `hi` to three numbers, each output to one
    /// number per channel.
    am_medium_bounds_in_box_f64 am_medium_bounds_in_box_f32
    am_medium_bounds_in_box_batch_f64 am_medium_bounds_in_box_batch_f32
    am_medium_bounds_in_box_record
    |medium: Medium, lo: point, hi: point| -> (minorant, majorant)
    [] results => {
        let (inf, sup): (Vec<_>, Vec<_>) = medium.bounds_in_box(lo, hi).unzip();
        results.extend(inf.into_iter().chain(sup));
    }

    /// Free flight: the smallest distance up to `t_max` at which the ray has gathered the
    /// optical depth `tau` ≥ 0 in `channel`; infinite if it gathers less.
    ///
    /// # Safety
    /// `medium` points to one struct, `origin` and `direction` to three numbers, `t` to one.
    am_medium_free_flight_f64 am_medium_free_flight_f32
    am_medium_free_flight_batch_f64 am_medium_free_flight_batch_f32 am_medium_free_flight_record
    |medium: Medium, channel: index, origin: point, direction: point, t_max: number, tau: number|
        -> (t)
    [check_channel(channel, medium.n_channels)?;] results => {
        let ray = Ray { origin, direction };
        results.push(sampling::free_flight(medium, channel, &ray, t_max, tau));
    }

    /// Optical depth, and its derivatives by everything that it depends on: one row of numbers
    /// per channel.
    ///
    /// First the optical depth; then, for each component, its derivatives by the attenuation
    /// coefficient of the component in this channel and by the values of the parameters of its
    /// profile, in the order of `am_profile.values`; then by the three components of the
    /// origin, by those of the direction, and by `t`: 1 + `am_medium_gradient_size` numbers in
    /// all. The optical depth does not depend on the coefficients of other channels.
    ///
    /// The direction counts as a free vector, see `am_profile_column_value_and_gradient_f64`.
    /// All derivatives are 0 where the optical depth is infinite.
    ///
    /// # Safety
    /// `medium` points to one struct, `origin` and `direction` to three numbers,
    /// `value_and_gradient` to a row per channel.
    am_medium_optical_depth_value_and_gradient_f64 am_medium_optical_depth_value_and_gradient_f32
    am_medium_optical_depth_value_and_gradient_batch_f64
    am_medium_optical_depth_value_and_gradient_batch_f32
    am_medium_optical_depth_value_and_gradient_record
    |medium: Medium, origin: point, direction: point, t: number| -> (value_and_gradient)
    [] results => {
        let ray = Ray { origin, direction };
        for (value, gradient) in medium.optical_depth_value_and_gradient(&ray, t) {
            results.push(value);
            results.extend(gradient.row());
        }
    }

    /// Free flight, and its derivatives: a row as that of
    /// `am_medium_optical_depth_value_and_gradient_f64` for `channel` alone, whose last number
    /// is the derivative by `tau`. By the implicit function theorem; all are 0 where there is
    /// no collision. On `t_max` the distance of a collision does not depend.
    ///
    /// # Safety
    /// `medium` points to one struct, `origin` and `direction` to three numbers,
    /// `value_and_gradient` to one row.
    am_medium_free_flight_value_and_gradient_f64 am_medium_free_flight_value_and_gradient_f32
    am_medium_free_flight_value_and_gradient_batch_f64
    am_medium_free_flight_value_and_gradient_batch_f32
    am_medium_free_flight_value_and_gradient_record
    |medium: Medium, channel: index, origin: point, direction: point, t_max: number, tau: number|
        -> (value_and_gradient)
    [check_channel(channel, medium.n_channels)?;] results => {
        let ray = Ray { origin, direction };
        let (value, gradient) =
            sampling::free_flight_value_and_gradient(medium, channel, &ray, t_max, tau);
        results.push(value);
        results.extend(gradient.row());
    }

    /// Density of the distance `t` as a free flight, 1/length, one per channel: attenuation
    /// coefficient times transmittance; 0 for an infinite `t`.
    ///
    /// # Safety
    /// As for `am_medium_optical_depth_f64`.
    am_medium_pdf_f64 am_medium_pdf_f32
    am_medium_pdf_batch_f64 am_medium_pdf_batch_f32 am_medium_pdf_record
    |medium: Medium, origin: point, direction: point, t: number| -> (pdf)
    [] results => { results.extend(sampling::pdf(medium, &Ray { origin, direction }, t)); }

    /// Density of the distance `t` as a free flight that must end before `t_max`, 1/length,
    /// one per channel: `am_medium_pdf_f64` over the opacity of the segment; 0 beyond it.
    ///
    /// # Safety
    /// As for `am_medium_optical_depth_f64`.
    am_medium_pdf_within_f64 am_medium_pdf_within_f32
    am_medium_pdf_within_batch_f64 am_medium_pdf_within_batch_f32 am_medium_pdf_within_record
    |medium: Medium, origin: point, direction: point, t_max: number, t: number| -> (pdf)
    [] results => {
        results.extend(sampling::pdf_within(medium, &Ray { origin, direction }, t_max, t));
    }
}
