//! Questions to a fog that scatters light once: air-light in closed form.

use super::array::Array;
use super::query::{
    self, Model, RecordedModel, argument_check, argument_type, argument_value, queries,
};
use super::{
    AmArrayF32, AmArrayF64, AmHostTable, AmNode, AmProfile, AmProfileNodes, AmStatus, Failure, arg,
    describe, guard,
};
use crate::airlight::sunlit::{self, SunlitFog};
use crate::error::{self, Error};
use crate::geometry::Ray;
use crate::profile::Kind;
use crate::real::Real;
use crate::real::lanes::{F32Lanes, F64Lanes, Lanes};
use crate::real::node::Node;

/// A fog in the sun: a constant or exponential profile with coefficients per channel
/// (wavelength, colour). It borrows the arrays.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct AmSunlitFog {
    /// The profile, of the kind "constant" or "exponential".
    pub profile: AmProfile,
    /// Scattering coefficients at relative density 1, 1/length, ≥ 0, one per channel.
    pub sigma_s: *const f64,
    /// Attenuation coefficients at relative density 1, 1/length, ≥ 0, one per channel.
    pub sigma_t: *const f64,
    /// Number of channels, at least 1.
    pub n_channels: usize,
}

/// A fog in the sun whose numbers are slots of a host's tape.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct AmSunlitFogNodes {
    /// The profile.
    pub profile: AmProfileNodes,
    /// Slots of the scattering coefficients.
    pub sigma_s: *const AmNode,
    /// Slots of the attenuation coefficients.
    pub sigma_t: *const AmNode,
    /// Number of channels, at least 1.
    pub n_channels: usize,
}

/// The two coefficients of each channel, if the profile is of a kind that has an answer.
///
/// # Safety
/// Pointers are null or point to `n_channels` items.
unsafe fn parts<'a, T>(
    kind: u32,
    sigma_s: *const T,
    sigma_t: *const T,
    n_channels: usize,
) -> Result<[&'a [T]; 2], Failure> {
    sunlit::check_kind(describe::known(kind)?)?;
    // SAFETY: promised by the caller.
    unsafe { arg::coefficients(sigma_s, sigma_t, n_channels) }
}

impl AmSunlitFog {
    fn parts(&self) -> Result<[&[f64]; 2], Failure> {
        // SAFETY: promised by the caller who made the struct.
        unsafe {
            parts(
                self.profile.kind,
                self.sigma_s,
                self.sigma_t,
                self.n_channels,
            )
        }
    }
}

impl Model for AmSunlitFog {
    type In<R: Real> = SunlitFog<R>;

    fn check(&self) -> Result<(), Failure> {
        self.parts().map(drop)
    }

    fn lift<R: Real>(&self, lift: impl Fn(f64) -> R) -> SunlitFog<R> {
        let [sigma_s, sigma_t] = self.parts().ok().expect("the fog has been checked");
        let channels = |sigma: &[f64]| sigma.iter().map(|s| lift(*s)).collect();
        SunlitFog::new(
            self.profile.lift(&lift),
            channels(sigma_s),
            channels(sigma_t),
        )
    }
}

impl RecordedModel for AmSunlitFogNodes {
    type In<R: Real> = SunlitFog<R>;

    unsafe fn nodes<'h>(&self, host: &'h AmHostTable) -> Result<SunlitFog<Node<'h>>, Failure> {
        let (kind, n) = (self.profile.kind, self.n_channels);
        // SAFETY: promised by the caller.
        let [sigma_s, sigma_t] = unsafe { parts(kind, self.sigma_s, self.sigma_t, n) }?;
        let channels = |slots: &[AmNode]| slots.iter().map(|s| Node::new(host, *s)).collect();
        let profile = self.profile.lift(host)?;
        Ok(SunlitFog::new(
            profile,
            channels(sigma_s),
            channels(sigma_t),
        ))
    }
}

fn require_constant(kind: u32) -> Result<(), Failure> {
    match describe::known(kind)? {
        Kind::Constant => Ok(()),
        kind => Err(Error::new("profile", "must be constant in a box", kind.name()).into()),
    }
}

/// Checks profile and coefficients of a fog. The question below checks counts, kinds and
/// pointers only: it answers a fog that does not pass with NaN or nonsense, but never fails.
///
/// # Safety
/// `fog` points to one struct, and its arrays have `n_channels` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn am_sunlit_fog_check(fog: *const AmSunlitFog) -> AmStatus {
    guard(|| {
        // SAFETY: promised by the caller.
        let fog = unsafe { arg::reference(fog, "fog") }?;
        let [sigma_s, sigma_t] = fog.parts()?;
        fog.profile.check()?;
        for (name, sigmas) in [("sigma_s", sigma_s), ("sigma_t", sigma_t)] {
            for sigma in sigmas {
                error::not_negative(name, *sigma)?;
            }
        }
        Ok(())
    })
}

queries! { AmSunlitFog, AmSunlitFogNodes;
    /// Radiance of the fog in the sun, seen from the origin along the segment of length `t`
    /// (0 ≤ `t` ≤ ∞): light that is scattered once, per unit of the irradiance of a surface
    /// perpendicular to it; 1/sr, one per channel. It may be infinite where a channel is clear.
    ///
    /// `direction` is that of the ray and `sun_direction` that towards the sun, unit vectors.
    /// `phase` is the value of the phase function at the angle between them, 1/sr: looking
    /// into the sun is forward scattering. In an exponential profile the light comes from
    /// beyond the fog; from a sun at the horizon or below it none is left, and the radiance is
    /// 0 (unless the attenuation coefficient is). A constant profile has no end, and there the
    /// irradiance is that at the origin of the ray. Nothing but the fog is in the way of light.
    ///
    /// Relative error below 1e-15 (1 + τ + |h|/H), in single precision 5e-7 (1 + τ + |h|/H). τ is
    /// the optical depth of the way from the sun to the origin or, if less, over the far end of
    /// the segment; h/H are the altitudes of its ends in scale heights.
    /// Source: docs/airlight.md.
    ///
    /// # Safety
    /// `fog` points to one struct, `origin`, `direction` and `sun_direction` to three numbers,
    /// `radiance` to one per channel.
    am_sunlit_fog_radiance_f64 am_sunlit_fog_radiance_f32
    am_sunlit_fog_radiance_batch_f64 am_sunlit_fog_radiance_batch_f32
    am_sunlit_fog_radiance_record
    |fog: SunlitFog, origin: point, direction: point, t: number, sun_direction: point,
        phase: number| -> (radiance)
    [] results => {
        results.extend(fog.radiance(&Ray { origin, direction }, t, sun_direction, phase));
    }

    /// `am_sunlit_fog_radiance_f64` of a constant fog that fills a box and nothing else: the
    /// irradiance is that of a surface outside of it. The segment, 0 ≤ `t` < ∞, is in the box, whose
    /// corners are `box_min` < `box_max`.
    ///
    /// Relative error below 1e-14 (1 + τ), in single precision 2e-6 (1 + τ), where τ is the greatest
    /// optical depth of a way through the box.
    /// Source: docs/airlight.md.
    ///
    /// # Safety
    /// As for `am_sunlit_fog_radiance_f64`; corners are three numbers.
    am_sunlit_fog_radiance_in_box_f64 am_sunlit_fog_radiance_in_box_f32
    am_sunlit_fog_radiance_in_box_batch_f64 am_sunlit_fog_radiance_in_box_batch_f32
    am_sunlit_fog_radiance_in_box_record
    |fog: SunlitFog, origin: point, direction: point, t: number, sun_direction: point,
        phase: number, box_min: point, box_max: point| -> (radiance)
    [require_constant(fog.profile.kind)?;] results => {
        let (ray, bounds) = (Ray { origin, direction }, [box_min, box_max]);
        results.extend(fog.radiance_in_box(&ray, t, sun_direction, phase, bounds));
    }
}
