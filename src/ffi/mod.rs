//! The C ABI.
//!
//! Every function returns a status; [`AmStatus::Ok`] is 0. On failure nothing is written to
//! the outputs, and [`am_last_error`] tells, per thread, which argument was wrong and why. No
//! panic leaves a function, nothing is allocated that the caller would have to free, and
//! there is no other global state: every function may be called from several threads at once.
//!
//! Names are `am_<object>_<question>`, followed by the form:
//!
//! * `_f64`, `_f32`: one ray, results through pointers;
//! * `_batch_f64`, `_batch_f32`: `n` rays from strided arrays, computed in SIMD lanes;
//! * `_record`: operations on the tape of a host, see [`AmHostTable`].

mod airlight;
mod arg;
mod array;
mod coefficients;
mod describe;
mod function;
mod geometry;
mod medium;
mod profile;
mod query;
mod special;
mod spectral;
mod status;
mod sunlit;

pub use crate::real::node::{AmHostTable, AmNode};
pub use airlight::*;
pub use array::{AmArrayF32, AmArrayF64};
pub use coefficients::*;
pub use describe::*;
pub use geometry::*;
pub use medium::*;
pub use profile::*;
pub use special::*;
pub use spectral::*;
pub use status::*;
pub use sunlit::*;

use crate::error::Error;
use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Version of this ABI. It changes whenever a signature, a struct or a number does.
pub const AM_ABI_VERSION: u32 = 1;

/// Version of the ABI that the library was built with; compare it with `AM_ABI_VERSION`.
#[unsafe(no_mangle)]
pub extern "C" fn am_abi_version() -> u32 {
    AM_ABI_VERSION
}

/// Version of the library, for example "0.1.0". The string lives for ever.
#[unsafe(no_mangle)]
pub extern "C" fn am_version() -> *const c_char {
    const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    VERSION.as_ptr().cast()
}

/// What went wrong in the last call of this thread that failed: argument, range and value.
///
/// Never null; empty if no call has failed. Valid until the next call of this thread fails.
#[unsafe(no_mangle)]
pub extern "C" fn am_last_error() -> *const c_char {
    LAST_ERROR.with_borrow(|message| message.as_ptr())
}

thread_local! {
    static LAST_ERROR: RefCell<CString> = RefCell::default();
}

/// A failure on its way to the caller.
pub(crate) struct Failure {
    status: AmStatus,
    message: String,
}

impl Failure {
    fn new(status: AmStatus, message: impl Into<String>) -> Self {
        let message = message.into();
        Self { status, message }
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::new(AmStatus::InvalidArgument, error.to_string())
    }
}

/// Runs `body`; turns errors and panics into a status and keeps their message.
fn guard(body: impl FnOnce() -> Result<(), Failure>) -> AmStatus {
    let outcome = catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(|payload| {
        let text = payload
            .downcast_ref::<&str>()
            .map(ToString::to_string)
            .or_else(|| payload.downcast_ref::<String>().cloned())
            .unwrap_or_default();
        Err(Failure::new(
            AmStatus::Panic,
            format!("internal error: {text}"),
        ))
    });
    match outcome {
        Ok(()) => AmStatus::Ok,
        Err(failure) => {
            let message = failure.message.replace('\0', " ");
            LAST_ERROR.set(CString::new(message).unwrap_or_default());
            failure.status
        }
    }
}
