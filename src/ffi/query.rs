//! One macro makes the five functions of a question: `_f64`, `_f32`, `_batch_f64`,
//! `_batch_f32` and `_record`.
//!
//! A question has a *model* (a profile or a medium), *arguments* (`point`: three numbers,
//! `number`, or `index`: a number of something, the same for all rays) and *outputs*. Its
//! body is generic over `Real`; it pushes the results of the first output, then those of the
//! second, and so on: one per output for a profile, one per channel for a medium.

use super::{AmHostTable, AmNode, Failure, arg};
use crate::geometry::Vector;
use crate::real::Real;
use crate::real::lanes::Lanes;
use crate::real::node::Node;

/// Results of a question: few, so that a scalar call needs no allocation.
pub type Results<R> = smallvec::SmallVec<[R; 4]>;

/// What questions are asked of.
pub trait Model {
    /// The model in arithmetic `R`.
    type In<R: Real>;

    /// Checks what evaluation relies on.
    fn check(&self) -> Result<(), Failure>;

    /// The model with its numbers lifted from `f64`. It has been checked.
    fn lift<R: Real>(&self, lift: impl Fn(f64) -> R) -> Self::In<R>;
}

/// A model whose numbers are slots of a tape.
pub trait RecordedModel {
    /// The model in arithmetic `R`.
    type In<R: Real>;

    /// The model with its slots as nodes.
    ///
    /// # Safety
    /// Pointers in the model are null or valid.
    unsafe fn nodes<'h>(&self, host: &'h AmHostTable) -> Result<Self::In<Node<'h>>, Failure>;
}

/// Three numbers from C.
///
/// # Safety
/// `pointer` is null or points to three numbers.
pub unsafe fn point<T: Copy>(pointer: *const T, name: &str) -> Result<Vector<T>, Failure> {
    // SAFETY: promised by the caller.
    let numbers = unsafe { arg::slice(pointer, 3, name) }?;
    Ok([numbers[0], numbers[1], numbers[2]])
}

/// The items that the lanes hold.
#[derive(Clone, Copy)]
pub struct Items {
    first: usize,
    last: usize,
}

impl Items {
    /// All of `n` items, lanes at a time.
    pub fn of<L: Lanes>(n: usize) -> impl Iterator<Item = Self> {
        let last = n.wrapping_sub(1);
        (0..n)
            .step_by(L::COUNT)
            .map(move |first| Self { first, last })
    }

    /// The item of a lane; lanes beyond the end repeat the last item.
    #[inline(always)]
    pub fn at(self, lane: usize) -> usize {
        (self.first + lane).min(self.last)
    }

    /// Writes the results of these items to `output`, which has `results.len()` numbers for each.
    /// Those of lanes beyond the end are dropped.
    pub fn write<L: Lanes>(self, results: &[L], output: *mut L::Scalar) {
        let width = results.len();
        for (channel, result) in results.iter().enumerate() {
            result.scatter(|lane, value| {
                let item = self.first + lane;
                if item <= self.last {
                    // SAFETY: the caller of the batch promises n · width numbers per output.
                    unsafe { *output.add(item * width + channel) = value };
                }
            });
        }
    }
}

/// Runs `question(items, results)` for `n` items, lanes at a time.
pub fn in_lanes<L: Lanes>(
    n: usize,
    outputs: &[*mut L::Scalar],
    mut question: impl FnMut(Items, &mut Results<L>),
) {
    let mut results = Results::new();
    for items in Items::of::<L>(n) {
        results.clear();
        question(items, &mut results);
        let width = results.len() / outputs.len();
        for (output, part) in outputs.iter().zip(results.chunks(width)) {
            items.write(part, *output);
        }
    }
}

/// Writes the results for one item to the outputs.
pub fn write_numbers<T: Copy>(results: &[T], outputs: &[*mut T]) {
    let width = results.len() / outputs.len();
    for (k, result) in results.iter().enumerate() {
        // SAFETY: the caller promises `width` numbers per output.
        unsafe { *outputs[k / width].add(k % width) = *result };
    }
}

/// The slots of results, unless the host failed.
pub fn slots(results: &[Node<'_>]) -> Result<Vec<AmNode>, Failure> {
    if results.iter().any(|node| node.slot() == 0) {
        let message = "the host returned slot 0 while recording";
        return Err(Failure::new(super::AmStatus::HostError, message));
    }
    Ok(results.iter().map(|node| node.slot()).collect())
}

/// Writes slots to the outputs of a recording, unless the host failed.
pub fn write_slots(results: &[Node<'_>], outputs: &[*mut AmNode]) -> Result<(), Failure> {
    write_numbers(&slots(results)?, outputs);
    Ok(())
}

/// Type of an argument in each form.
macro_rules! argument_type {
    (scalar $float:ident $array:ident point) => { *const $float };
    (scalar $float:ident $array:ident number) => { $float };
    (batch $float:ident $array:ident point) => { $array };
    (batch $float:ident $array:ident number) => { $array };
    (record $float:ident $array:ident point) => { *const $float };
    (record $float:ident $array:ident number) => { $float };
    ($form:ident $float:ident $array:ident index) => { usize };
    (real $real:ident point) => { $crate::geometry::Vector<$real> };
    (real $real:ident number) => { $real };
    (real $real:ident index) => { usize };
}

/// Value of an argument in each form.
macro_rules! argument_value {
    (scalar $name:ident point) => {
        // SAFETY: promised by the caller.
        unsafe { $crate::ffi::query::point($name, stringify!($name)) }?
    };
    (scalar $name:ident number) => {
        $name
    };
    (batch $lanes:ident $item:ident $name:ident point) => {
        // SAFETY: the array has been checked, and the caller promises n items.
        std::array::from_fn(|i| $lanes::gather(|lane| unsafe { $name.get($item.at(lane), i) }))
    };
    (batch $lanes:ident $item:ident $name:ident number) => {
        // SAFETY: as above.
        $lanes::gather(|lane| unsafe { $name.get($item.at(lane), 0) })
    };
    (record $host:ident $name:ident point) => {
        // SAFETY: promised by the caller.
        unsafe { $crate::ffi::query::point($name, stringify!($name)) }?
            .map(|slot| $crate::real::node::Node::new($host, slot))
    };
    (record $host:ident $name:ident number) => {
        $crate::real::node::Node::new($host, $name)
    };
    (scalar $name:ident index) => {
        $name
    };
    (batch $lanes:ident $item:ident $name:ident index) => {
        $name
    };
    (record $host:ident $name:ident index) => {
        $name
    };
}

/// Check of a batched argument.
macro_rules! argument_check {
    ($name:ident $n:ident point) => {
        $name.check($n, 3, stringify!($name))?
    };
    ($name:ident $n:ident number) => {
        $name.check($n, 1, stringify!($name))?
    };
    ($name:ident $n:ident index) => {
        ()
    };
}

/// Makes the five functions of each question; see the head of this file.
macro_rules! queries {
    ($Model:ident, $Recorded:ident; $(
        $(#[$doc:meta])*
        $f64:ident $f32:ident $batch_f64:ident $batch_f32:ident $record:ident
        |$model:ident : $In:ident $(, $arg:ident : $kind:ident)*| -> ($($out:ident),*)
        [$($check:tt)*]
        $results:ident => $body:block
    )*) => { $(
        queries!(@scalar $Model f64 AmArrayF64 $f64 [$(#[$doc])*] |$model: $In $(, $arg: $kind)*|
            -> ($($out),*) [$($check)*] $results => $body);
        queries!(@scalar $Model f32 AmArrayF32 $f32 [
            #[doc = concat!("`", stringify!($f64), "` in single precision.\n\n# Safety\nAs there.")]]
            |$model: $In $(, $arg: $kind)*| -> ($($out),*) [$($check)*] $results => $body);
        queries!(@batch $Model f64 AmArrayF64 F64Lanes $batch_f64 $f64
            |$model: $In $(, $arg: $kind)*| -> ($($out),*) [$($check)*] $results => $body);
        queries!(@batch $Model f32 AmArrayF32 F32Lanes $batch_f32 $f32
            |$model: $In $(, $arg: $kind)*| -> ($($out),*) [$($check)*] $results => $body);

        #[doc = concat!("`", stringify!($f64), "` recorded on the tape of `host`: arguments, ",
            "parameters and results are slots.\n\n# Safety\nPointers are valid, and the ",
            "functions of `host` do what `am_host_table` says.")]
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $record(
            host: *const AmHostTable,
            $model: *const $Recorded,
            $($arg: argument_type!(record AmNode AmNode $kind),)*
            $($out: *mut AmNode,)*
        ) -> AmStatus {
            guard(|| {
                // SAFETY: promised by the caller.
                let host = unsafe { arg::reference(host, "host") }?;
                // SAFETY: promised by the caller.
                let $model = unsafe { arg::reference($model, stringify!($model)) }?;
                $($check)*
                $( arg::output($out, 1, stringify!($out))?; )*
                // SAFETY: promised by the caller.
                let model = unsafe { $model.nodes(host) }?;
                let mut results = query::Results::new();
                queries!(@eval |$model: $In $(, $arg: $kind)*| $results => $body);
                eval(&model, $(argument_value!(record host $arg $kind),)* &mut results);
                query::write_slots(&results, &[$($out),*])
            })
        }
    )* };

    (@eval |$model:ident : $In:ident $(, $arg:ident : $kind:ident)*| $results:ident => $body:block) => {
        #[inline(always)]
        #[allow(clippy::too_many_arguments, reason = "as many as the question has")]
        fn eval<R: Real>(
            $model: &$In<R>,
            $($arg: argument_type!(real R $kind),)*
            $results: &mut $crate::ffi::query::Results<R>,
        ) $body
    };

    (@scalar $Model:ident $float:ident $array:ident $name:ident [$(#[$doc:meta])*]
        |$model:ident : $In:ident $(, $arg:ident : $kind:ident)*| -> ($($out:ident),*)
        [$($check:tt)*] $results:ident => $body:block
    ) => {
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            $model: *const $Model,
            $($arg: argument_type!(scalar $float $array $kind),)*
            $($out: *mut $float,)*
        ) -> AmStatus {
            guard(|| {
                // SAFETY: promised by the caller.
                let $model = unsafe { arg::reference($model, stringify!($model)) }?;
                Model::check($model)?;
                $($check)*
                $( arg::output($out, 1, stringify!($out))?; )*
                let lifted = $model.lift(|value| value as $float);
                let mut results = query::Results::new();
                queries!(@eval |$model: $In $(, $arg: $kind)*| $results => $body);
                eval(&lifted, $(argument_value!(scalar $arg $kind),)* &mut results);
                query::write_numbers(&results, &[$($out),*]);
                Ok(())
            })
        }
    };

    (@batch $Model:ident $float:ident $array:ident $Lanes:ident $name:ident $scalar:ident
        |$model:ident : $In:ident $(, $arg:ident : $kind:ident)*| -> ($($out:ident),*)
        [$($check:tt)*] $results:ident => $body:block
    ) => {
        #[doc = concat!("`", stringify!($scalar), "` for `n` items. Outputs are contiguous: ",
            "the results of item 0, of item 1, and so on.\n\n# Safety\nArrays hold `n` items ",
            "(one, if the stride is 0), outputs have room for the results of `n` items, and ",
            "do not overlap the inputs.")]
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            $model: *const $Model,
            n: usize,
            $($arg: argument_type!(batch $float $array $kind),)*
            $($out: *mut $float,)*
        ) -> AmStatus {
            guard(|| {
                // SAFETY: promised by the caller.
                let $model = unsafe { arg::reference($model, stringify!($model)) }?;
                Model::check($model)?;
                $($check)*
                $( argument_check!($arg n $kind); )*
                $( arg::output($out, n, stringify!($out))?; )*
                let lifted = $model.lift(|value| $Lanes::splat(value as $float));
                queries!(@eval |$model: $In $(, $arg: $kind)*| $results => $body);
                query::in_lanes(n, &[$($out),*], |item, results| {
                    eval(&lifted, $(argument_value!(batch $Lanes item $arg $kind),)* results);
                });
                Ok(())
            })
        }
    };
}

pub(super) use {argument_check, argument_type, argument_value, queries};
