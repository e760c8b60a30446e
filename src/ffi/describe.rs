//! Profiles as plain data, and the description of their parameters.
//!
//! Hosts read names, sizes and defaults from here instead of repeating them.

use super::{AmStatus, Failure, arg, guard};
use crate::profile::{AnyProfile, Kind};
use std::ffi::{CStr, c_char};

/// Numbers that a profile has room for.
pub const AM_PROFILE_VALUES: usize = 16;

/// Bytes of a name, its final zero included.
pub const AM_NAME_SIZE: usize = 32;

/// A profile: its kind, and the values of its parameters one after the other, in the order
/// that `am_profile_parameter` gives. Values beyond those are ignored.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct AmProfile {
    /// Kind of profile, from `am_profile_kind`.
    pub kind: u32,
    /// Values of the parameters.
    pub values: [f64; AM_PROFILE_VALUES],
}

/// A parameter of a profile.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct AmParameter {
    /// Name, as in a scene; ends with a zero.
    pub name: [c_char; AM_NAME_SIZE],
    /// Number of values: 1, or 3 for a vector.
    pub size: u32,
    /// Index of its first value in `am_profile.values`.
    pub offset: u32,
    /// 1 if there is no default.
    pub required: u32,
    /// Default values; 0 where there are none.
    pub defaults: [f64; 3],
}

impl AmProfile {
    /// The checked profile.
    pub(super) fn check(&self) -> Result<AnyProfile<f64>, Failure> {
        let kind = self.kind()?;
        Ok(AnyProfile::new(kind, &self.values[..kind.size()])?)
    }

    pub(super) fn kind(&self) -> Result<Kind, Failure> {
        known(self.kind)
    }
}

/// The kind with this number.
pub(super) fn known(kind: u32) -> Result<Kind, Failure> {
    Kind::from_number(kind).ok_or_else(|| {
        let names: Vec<_> = Kind::ALL.iter().map(|k| k.name()).collect();
        let message = format!(
            "kind must be one of am_profile_kind({}), got {kind}",
            names.join(", ")
        );
        Failure::new(AmStatus::InvalidArgument, message)
    })
}

fn write_name(name: &str, out: &mut [c_char; AM_NAME_SIZE]) {
    *out = [0; AM_NAME_SIZE];
    for (to, from) in out[..AM_NAME_SIZE - 1].iter_mut().zip(name.bytes()) {
        *to = from as c_char;
    }
}

/// The number of the kind of profile called `name`, for example "exponential".
///
/// # Safety
/// `name` is a string that ends with a zero; `kind` points to one number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn am_profile_kind(name: *const c_char, kind: *mut u32) -> AmStatus {
    guard(|| {
        // SAFETY: promised by the caller.
        let first = unsafe { arg::reference(name, "name") }?;
        arg::output(kind, 1, "kind")?;
        // SAFETY: not null, and ends with a zero.
        let name = unsafe { CStr::from_ptr(first) }.to_string_lossy();
        let found = Kind::from_name(&name).ok_or_else(|| {
            let names: Vec<_> = Kind::ALL.iter().map(|k| k.name()).collect();
            let message = format!("profile must be one of {}, got {name:?}", names.join(", "));
            Failure::new(AmStatus::InvalidArgument, message)
        })?;
        // SAFETY: not null.
        unsafe { *kind = found as u32 };
        Ok(())
    })
}

/// Name of a kind of profile, and the number of its parameters.
///
/// # Safety
/// `name` points to `AM_NAME_SIZE` characters, `parameters` to one number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn am_profile_describe(
    kind: u32,
    name: *mut [c_char; AM_NAME_SIZE],
    parameters: *mut u32,
) -> AmStatus {
    guard(|| {
        let kind = known(kind)?;
        arg::output(name, 1, "name")?;
        arg::output(parameters, 1, "parameters")?;
        // SAFETY: not null.
        unsafe {
            write_name(kind.name(), &mut *name);
            *parameters = kind.parameters().len() as u32;
        }
        Ok(())
    })
}

/// The parameter number `index` of a kind of profile.
///
/// # Safety
/// `parameter` points to one struct.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn am_profile_parameter(
    kind: u32,
    index: u32,
    parameter: *mut AmParameter,
) -> AmStatus {
    guard(|| {
        let parameters = known(kind)?.parameters();
        let Some(found) = parameters.get(index as usize) else {
            let count = parameters.len();
            let message = format!("index must be < {count}, got {index}");
            return Err(Failure::new(AmStatus::InvalidArgument, message));
        };
        arg::output(parameter, 1, "parameter")?;
        let offset: usize = parameters[..index as usize].iter().map(|p| p.size).sum();
        let mut described = AmParameter {
            name: [0; AM_NAME_SIZE],
            size: found.size as u32,
            offset: offset as u32,
            required: u32::from(found.default.is_none()),
            defaults: [0.0; 3],
        };
        write_name(found.name, &mut described.name);
        let defaults = found.default.unwrap_or(&[]);
        described.defaults[..defaults.len()].copy_from_slice(defaults);
        // SAFETY: not null.
        unsafe { *parameter = described };
        Ok(())
    })
}

/// Checks kind and values of a profile. The questions below check the kind only: they
/// answer a profile that does not pass with NaN or nonsense, but never fail.
///
/// # Safety
/// `profile` points to one struct.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn am_profile_check(profile: *const AmProfile) -> AmStatus {
    guard(|| {
        // SAFETY: promised by the caller.
        unsafe { arg::reference(profile, "profile") }?.check()?;
        Ok(())
    })
}
