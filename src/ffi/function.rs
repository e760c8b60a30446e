//! One macro makes the five forms of a function of numbers: `_f64`, `_f32`, `_batch_f64`,
//! `_batch_f32` and `_record`.
//!
//! A function has *arguments*, each with the check of its range, and one value, which may be complex.
//! Numbers are checked before anything is written; slots of a tape cannot be.

use super::array::Array;
use super::{AmStatus, Failure, arg, query};
use crate::error::Error;

/// The range of an item, which may be several numbers.
pub type Check = fn(&'static str, &[f64]) -> Result<(), Error>;

/// Checks an array of `n` items of `width` numbers.
///
/// # Safety
/// `array` holds `n` items, or one if its stride is 0.
pub unsafe fn check_batch<A: Array>(
    array: &A,
    n: usize,
    width: usize,
    name: &'static str,
    check: Check,
) -> Result<(), Failure>
where
    A::Number: Into<f64>,
{
    array.check(n, width, name)?;
    let mut numbers = query::Results::new();
    for item in 0..n {
        numbers.clear();
        // SAFETY: promised by the caller.
        numbers.extend((0..width).map(|i| unsafe { array.get(item, i) }.into()));
        check(name, &numbers).map_err(|error| {
            let message = format!("{error} at item {item}");
            Failure::new(AmStatus::InvalidArgument, message)
        })?;
    }
    Ok(())
}

/// What a function gives: a number, or a complex one.
pub trait Value<R> {
    /// Its numbers.
    fn numbers(self) -> query::Results<R>;
}

impl<R> Value<R> for R {
    fn numbers(self) -> query::Results<R> {
        smallvec::smallvec![self]
    }
}

impl<R> Value<R> for [R; 2] {
    fn numbers(self) -> query::Results<R> {
        self.into_iter().collect()
    }
}

/// Checks that there is room for a value.
pub fn check_output<T>(value: *mut T, n: usize) -> Result<(), Failure> {
    arg::output(value, n, "value")
}

/// Makes the five forms of each function; see the head of this file.
macro_rules! functions {
    ($(
        $(#[$doc:meta])*
        $f64:ident $f32:ident $batch_f64:ident $batch_f32:ident $record:ident
        |$($arg:ident : $range:ident),+| => $function:path
    )*) => { $(
        functions!(@scalar f64 $f64 [$(#[$doc])*] |$($arg: $range),+| => $function);
        functions!(@scalar f32 $f32 [
            #[doc = concat!("`", stringify!($f64), "` in single precision.\n\n# Safety\nAs there.")]]
            |$($arg: $range),+| => $function);
        functions!(@batch F64Lanes f64 AmArrayF64 $batch_f64 $f64 |$($arg: $range),+| => $function);
        functions!(@batch F32Lanes f32 AmArrayF32 $batch_f32 $f64 |$($arg: $range),+| => $function);

        #[doc = concat!("`", stringify!($f64), "` recorded on the tape of `host`: arguments and ",
            "the value are slots. Ranges are not checked.\n\n# Safety\nPointers are valid, and the ",
            "functions of `host` do what `am_host_table` says.")]
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $record(
            host: *const AmHostTable,
            $($arg: AmNode,)+
            value: *mut AmNode,
        ) -> AmStatus {
            guard(|| {
                // SAFETY: promised by the caller.
                let host = unsafe { arg::reference(host, "host") }?;
                function::check_output(value, 1)?;
                let result = $function($(Node::new(host, $arg)),+);
                query::write_slots(&function::Value::<Node>::numbers(result), &[value])
            })
        }
    )* };

    (@scalar $float:ident $name:ident [$(#[$doc:meta])*]
        |$($arg:ident : $range:ident),+| => $function:path
    ) => {
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name($($arg: $float,)+ value: *mut $float) -> AmStatus {
            guard(|| {
                $( error::$range(stringify!($arg), f64::from($arg))?; )+
                function::check_output(value, 1)?;
                let result = function::Value::<$float>::numbers($function($($arg),+));
                query::write_numbers(&result, &[value]);
                Ok(())
            })
        }
    };

    (@batch $Lanes:ident $float:ident $array:ident $name:ident $scalar:ident
        |$($arg:ident : $range:ident),+| => $function:path
    ) => {
        #[doc = concat!("`", stringify!($scalar), "` for `n` items.\n\n# Safety\nArrays hold `n` ",
            "items (one, if the stride is 0), `value` has room for `n` numbers, and does not ",
            "overlap the inputs.")]
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            n: usize,
            $($arg: $array,)+
            value: *mut $float,
        ) -> AmStatus {
            guard(|| {
                $(
                    let check: function::Check =
                        |name, numbers| error::$range(name, numbers[0]).map(drop);
                    // SAFETY: promised by the caller.
                    unsafe { function::check_batch(&$arg, n, 1, stringify!($arg), check) }?;
                )+
                function::check_output(value, n)?;
                query::in_lanes(n, &[value], |item, results| {
                    $(
                        // SAFETY: the array has been checked, and the caller promises n items.
                        let $arg = $Lanes::gather(|lane| unsafe { $arg.get(item.at(lane), 0) });
                    )+
                    results.extend(function::Value::<$Lanes>::numbers($function($($arg),+)));
                });
                Ok(())
            })
        }
    };
}

pub(super) use functions;
