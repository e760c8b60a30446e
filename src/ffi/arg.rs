//! Checks of pointers that come from C.

use super::{AmStatus, Failure};

fn null(name: &str) -> Failure {
    Failure::new(AmStatus::NullPointer, format!("{name} must not be null"))
}

/// The object behind a pointer.
///
/// # Safety
/// `pointer` is null or points to a valid `T` that lives as long as `'a`.
pub unsafe fn reference<'a, T>(pointer: *const T, name: &str) -> Result<&'a T, Failure> {
    // SAFETY: promised by the caller.
    unsafe { pointer.as_ref() }.ok_or_else(|| null(name))
}

/// The `n` items behind a pointer, which may be null if `n` is 0.
///
/// # Safety
/// `pointer` is null or points to `n` valid items that live as long as `'a`.
pub unsafe fn slice<'a, T>(pointer: *const T, n: usize, name: &str) -> Result<&'a [T], Failure> {
    if n == 0 {
        return Ok(&[]);
    }
    if pointer.is_null() {
        return Err(null(name));
    }
    // SAFETY: promised by the caller.
    Ok(unsafe { std::slice::from_raw_parts(pointer, n) })
}

/// Fails if `pointer` is null although there is something to write to it.
pub fn output<T>(pointer: *mut T, n: usize, name: &str) -> Result<(), Failure> {
    if n > 0 && pointer.is_null() {
        Err(null(name))
    } else {
        Ok(())
    }
}

/// Fails if there is none of something.
pub fn count(n: usize, name: &str) -> Result<(), Failure> {
    if n > 0 {
        return Ok(());
    }
    let message = format!("{name} must be >= 1, got 0");
    Err(Failure::new(AmStatus::InvalidArgument, message))
}

/// Scattering and extinction coefficients, one of each per channel; there is at least one channel.
///
/// # Safety
/// Pointers are null or point to `n_channels` items that live as long as `'a`.
pub unsafe fn coefficients<'a, T>(
    sigma_s: *const T,
    sigma_t: *const T,
    n_channels: usize,
) -> Result<[&'a [T]; 2], Failure> {
    count(n_channels, "n_channels")?;
    // SAFETY: promised by the caller.
    unsafe {
        Ok([
            slice(sigma_s, n_channels, "sigma_s")?,
            slice(sigma_t, n_channels, "sigma_t")?,
        ])
    }
}
