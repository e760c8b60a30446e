//! Status codes: numbers fixed for ever.

use std::ffi::c_char;

/// Outcome of a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum AmStatus {
    /// Done.
    Ok = 0,
    /// A pointer was null that must not be.
    NullPointer = 1,
    /// A value was outside its range.
    InvalidArgument = 2,
    /// The host of a recording failed; its own error tells why.
    HostError = 3,
    /// A bug in the library. The process may go on.
    Panic = 4,
}

/// What a status means, in a few words. Never null; the string lives for ever.
/// Numbers that are no status give "unknown status".
#[unsafe(no_mangle)]
pub extern "C" fn am_status_message(status: i32) -> *const c_char {
    let message = match status {
        0 => c"ok",
        1 => c"null pointer",
        2 => c"invalid argument",
        3 => c"the host failed while recording",
        4 => c"internal error",
        _ => c"unknown status",
    };
    message.as_ptr()
}
