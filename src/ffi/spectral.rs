//! Functions of spectra: arrays of `n_wavelengths` numbers.
//!
//! One macro makes the five forms, as those of `query.rs` and `function.rs` do. A function has
//! *choices* (numbers of an enum, the same for all items), *arguments* (`spectrum`, or `number`: one
//! for all wavelengths), each with its check, and *outputs* of a given width.

use super::array::Array;
use super::function::{self, Check};
use super::query::{self, Items, Results};
use super::{AmArrayF32, AmArrayF64, AmHostTable, AmNode, AmStatus, Failure, arg, guard};
use crate::error::{self, Error};
use crate::real::Real;
use crate::real::lanes::{F32Lanes, F64Lanes, Lanes};
use crate::real::node::Node;
use crate::spectral::{self, Absorption, Collision, EventRule, Spectrum};

/// What the probability of an event at a collision is in proportion to. Numbers are fixed for ever.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum AmEventRule {
    /// The largest coefficient of all wavelengths.
    Maximum = 0,
    /// The mean coefficient.
    Average = 1,
    /// The mean of the coefficients, each weighted by the path weight so far.
    History = 2,
}

/// What becomes of absorption. Numbers are fixed for ever.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum AmAbsorption {
    /// It is an event, at which a path ends.
    Sampled = 0,
    /// It is in the weights of the other events. Right where nothing is emitted.
    Weighted = 1,
}

/// A choice that comes from C as a number.
trait Choice: Sized {
    fn known(number: u32) -> Result<Self, Failure>;
}

impl Choice for EventRule {
    fn known(number: u32) -> Result<Self, Failure> {
        const MAXIMUM: u32 = AmEventRule::Maximum as u32;
        const AVERAGE: u32 = AmEventRule::Average as u32;
        const HISTORY: u32 = AmEventRule::History as u32;
        match number {
            MAXIMUM => Ok(Self::Maximum),
            AVERAGE => Ok(Self::Average),
            HISTORY => Ok(Self::History),
            _ => Err(unknown("rule must be one of am_event_rule", number)),
        }
    }
}

impl Choice for Absorption {
    fn known(number: u32) -> Result<Self, Failure> {
        const SAMPLED: u32 = AmAbsorption::Sampled as u32;
        const WEIGHTED: u32 = AmAbsorption::Weighted as u32;
        match number {
            SAMPLED => Ok(Self::Sampled),
            WEIGHTED => Ok(Self::Weighted),
            _ => Err(unknown("absorption must be one of am_absorption", number)),
        }
    }
}

fn unknown(rule: &str, number: u32) -> Failure {
    Failure::new(AmStatus::InvalidArgument, format!("{rule}, got {number}"))
}

// ---- Ranges

fn each(
    name: &'static str,
    spectrum: &[f64],
    range: fn(&'static str, f64) -> Result<f64, Error>,
) -> Result<(), Error> {
    spectrum.iter().enumerate().try_for_each(|(i, value)| {
        range(name, *value).map(drop).map_err(|error| Error {
            value: format!("{} (wavelength {i})", error.value),
            ..error
        })
    })
}

fn coefficients(name: &'static str, spectrum: &[f64]) -> Result<(), Error> {
    each(name, spectrum, error::not_negative)
}

fn coefficient(name: &'static str, number: &[f64]) -> Result<(), Error> {
    error::not_negative(name, number[0]).map(drop)
}

fn finite(name: &'static str, spectrum: &[f64]) -> Result<(), Error> {
    each(name, spectrum, error::finite)
}

fn logarithms(name: &'static str, spectrum: &[f64]) -> Result<(), Error> {
    each(name, spectrum, error::below_infinity)
}

/// Probabilities whose sum is one to within 1e-5: what `f32` keeps of it.
fn distribution(name: &'static str, spectrum: &[f64]) -> Result<(), Error> {
    each(name, spectrum, error::probability)?;
    let sum: f64 = spectrum.iter().sum();
    if (sum - 1.0).abs() <= 1e-5 {
        return Ok(());
    }
    Err(Error::new(name, "must have the sum 1", sum))
}

fn check<T: Copy + Into<f64>>(
    name: &'static str,
    given: &[T],
    check: Check,
) -> Result<(), Failure> {
    let numbers: Spectrum<f64> = given.iter().map(|x| (*x).into()).collect();
    Ok(check(name, &numbers)?)
}

// ---- Forms

/// Where the results go: `width` numbers per item.
struct Output<T> {
    numbers: *mut T,
    width: usize,
}

/// Calls `write(part, numbers)` with the part of the results that belongs to each output.
fn share<R, T>(results: &[R], outputs: &[Output<T>], mut write: impl FnMut(&[R], *mut T)) {
    let mut rest = results;
    for output in outputs {
        let (part, others) = rest.split_at(output.width);
        write(part, output.numbers);
        rest = others;
    }
}

fn write<T: Copy>(results: &[T], outputs: &[Output<T>]) {
    share(results, outputs, |part, numbers| {
        query::write_numbers(part, &[numbers]);
    });
}

fn in_lanes<L: Lanes>(
    n: usize,
    outputs: &[Output<L::Scalar>],
    mut function: impl FnMut(Items, &mut Results<L>),
) {
    let mut results = Results::new();
    for items in Items::of::<L>(n) {
        results.clear();
        function(items, &mut results);
        share(&results, outputs, |part, numbers| {
            items.write(part, numbers)
        });
    }
}

/// Type of an argument.
macro_rules! argument {
    (spectrum $number:ty) => { *const $number };
    (number $number:ty) => { $number };
}

/// Numbers of an argument.
macro_rules! width {
    ($n:ident spectrum) => {
        $n
    };
    ($n:ident number) => {
        1
    };
}

/// The numbers behind an argument.
macro_rules! numbers {
    ($n:ident spectrum $name:ident) => {
        // SAFETY: promised by the caller.
        unsafe { arg::slice($name, $n, stringify!($name)) }?
    };
    ($n:ident number $name:ident) => {
        std::slice::from_ref(&$name)
    };
}

/// Makes the five forms of each function; see the head of this file.
macro_rules! spectra {
    ($(
        $(#[$doc:meta])*
        $f64:ident $f32:ident $batch_f64:ident $batch_f32:ident $record:ident
        [$n:ident; $($choice:ident : $Choice:ident),*]
        |$($arg:ident : $kind:ident $check:ident),+| -> ($($out:ident [$width:expr]),+)
        $results:ident => $body:block
    )*) => { $(
        spectra!(@scalar f64 $f64 [$(#[$doc])*] [$n; $($choice: $Choice),*]
            |$($arg: $kind $check),+| -> ($($out [$width]),+) $results => $body);
        spectra!(@scalar f32 $f32 [
            #[doc = concat!("`", stringify!($f64), "` in single precision.\n\n# Safety\nAs there.")]]
            [$n; $($choice: $Choice),*]
            |$($arg: $kind $check),+| -> ($($out [$width]),+) $results => $body);
        spectra!(@batch F64Lanes f64 AmArrayF64 $batch_f64 $f64 [$n; $($choice: $Choice),*]
            |$($arg: $kind $check),+| -> ($($out [$width]),+) $results => $body);
        spectra!(@batch F32Lanes f32 AmArrayF32 $batch_f32 $f64 [$n; $($choice: $Choice),*]
            |$($arg: $kind $check),+| -> ($($out [$width]),+) $results => $body);

        #[doc = concat!("`", stringify!($f64), "` recorded on the tape of `host`: arguments and ",
            "results are slots. Ranges of arguments are not checked.\n\n# Safety\nPointers are ",
            "valid, and the functions of `host` do what `am_host_table` says.")]
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $record(
            host: *const AmHostTable,
            $n: usize,
            $($choice: u32,)*
            $($arg: argument!($kind AmNode),)+
            $($out: *mut AmNode,)+
        ) -> AmStatus {
            guard(|| {
                // SAFETY: promised by the caller.
                let host = unsafe { arg::reference(host, "host") }?;
                arg::count($n, stringify!($n))?;
                $( let $choice = $Choice::known($choice)?; )*
                $( let $arg = numbers!($n $kind $arg); )+
                $( arg::output($out, 1, stringify!($out))?; )+
                let nodes = |slots: &[AmNode]| -> Spectrum<_> {
                    slots.iter().map(|slot| Node::new(host, *slot)).collect()
                };
                let mut results = Results::new();
                spectra!(@eval [$($choice: $Choice),*] |$($arg),+| $results => $body);
                eval($($choice,)* $(&nodes($arg),)+ &mut results);
                let outputs = [$( Output { numbers: $out, width: $width } ),+];
                write(&query::slots(&results)?, &outputs);
                Ok(())
            })
        }
    )* };

    (@eval [$($choice:ident : $Choice:ident),*] |$($arg:ident),+| $results:ident => $body:block) => {
        #[inline(always)]
        fn eval<R: Real>(
            $($choice: $Choice,)*
            $($arg: &[R],)+
            $results: &mut Results<R>,
        ) $body
    };

    (@scalar $float:ident $name:ident [$(#[$doc:meta])*]
        [$n:ident; $($choice:ident : $Choice:ident),*]
        |$($arg:ident : $kind:ident $check:ident),+| -> ($($out:ident [$width:expr]),+)
        $results:ident => $body:block
    ) => {
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            $n: usize,
            $($choice: u32,)*
            $($arg: argument!($kind $float),)+
            $($out: *mut $float,)+
        ) -> AmStatus {
            guard(|| {
                arg::count($n, stringify!($n))?;
                $( let $choice = $Choice::known($choice)?; )*
                $(
                    let $arg = numbers!($n $kind $arg);
                    check(stringify!($arg), $arg, $check)?;
                )+
                $( arg::output($out, 1, stringify!($out))?; )+
                let mut results = Results::new();
                spectra!(@eval [$($choice: $Choice),*] |$($arg),+| $results => $body);
                eval($($choice,)* $($arg,)+ &mut results);
                write(&results, &[$( Output { numbers: $out, width: $width } ),+]);
                Ok(())
            })
        }
    };

    (@batch $Lanes:ident $float:ident $array:ident $name:ident $scalar:ident
        [$n:ident; $($choice:ident : $Choice:ident),*]
        |$($arg:ident : $kind:ident $check:ident),+| -> ($($out:ident [$width:expr]),+)
        $results:ident => $body:block
    ) => {
        #[doc = concat!("`", stringify!($scalar), "` for `n` items. Items of spectra are ",
            "`", stringify!($n), "` numbers. Outputs are contiguous: the results of item 0, of ",
            "item 1, and so on.\n\n# Safety\nArrays hold `n` items (one, if the stride is 0), ",
            "outputs have room for the results of `n` items, and do not overlap the inputs.")]
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            n: usize,
            $n: usize,
            $($choice: u32,)*
            $($arg: $array,)+
            $($out: *mut $float,)+
        ) -> AmStatus {
            guard(|| {
                arg::count($n, stringify!($n))?;
                $( let $choice = $Choice::known($choice)?; )*
                $(
                    let width = width!($n $kind);
                    // SAFETY: promised by the caller.
                    unsafe { function::check_batch(&$arg, n, width, stringify!($arg), $check) }?;
                )+
                $( arg::output($out, n, stringify!($out))?; )+
                spectra!(@eval [$($choice: $Choice),*] |$($arg),+| $results => $body);
                let outputs = [$( Output { numbers: $out, width: $width } ),+];
                in_lanes(n, &outputs, |items, results| {
                    $(
                        // SAFETY: the array has been checked, and the caller promises n items.
                        let lanes = |i| $Lanes::gather(|lane| unsafe { $arg.get(items.at(lane), i) });
                        let $arg: Spectrum<_> = (0..width!($n $kind)).map(lanes).collect();
                    )+
                    eval($($choice,)* $(&$arg,)+ results);
                });
                Ok(())
            })
        }
    };
}

spectra! {
    /// Probabilities of the events at a collision in flight against a majorant, and what each
    /// multiplies the path weights by, per wavelength. Events are 0: absorption, 1: scattering,
    /// 2: null.
    ///
    /// `rule` is an `am_event_rule`, `absorption` an `am_absorption`. Coefficients `sigma_a`,
    /// `sigma_s` and `majorant` are in 1/length, finite and ≥ 0; the null coefficient is what they
    /// leave of the majorant, and may be negative. `path_weights` are finite, of either sign, and
    /// are of use with `AM_EVENT_RULE_HISTORY` only.
    ///
    /// Probabilities sum to 1. One is 0 only where no wavelength has both the coefficient and, by
    /// history, a path weight; weights of such an event are 0. Path weights that are all 0 count as
    /// equal. If absorption is weighted and nothing else can happen, the event is null, with weight
    /// 0; without a majorant it is null, with weight 1. Weights are limited to ±1e150, in single
    /// precision ±1e15. Source: article, Eq. 68 to 74; Kutz et al. (2017).
    ///
    /// # Safety
    /// Spectra point to `n_wavelengths` numbers, `probabilities` to 3, `weights` to
    /// 3 `n_wavelengths`: those of event 0 for all wavelengths, of event 1, of event 2.
    am_null_collision_probabilities_f64 am_null_collision_probabilities_f32
    am_null_collision_probabilities_batch_f64 am_null_collision_probabilities_batch_f32
    am_null_collision_probabilities_record
    [n_wavelengths; rule: EventRule, absorption: Absorption]
    |sigma_a: spectrum coefficients, sigma_s: spectrum coefficients, majorant: number coefficient,
        path_weights: spectrum finite|
    -> (probabilities [3], weights [3 * n_wavelengths])
    results => {
        let collision = Collision { sigma_a, sigma_s, majorant: majorant[0], path_weights };
        let events = spectral::null_collision_probabilities(rule, absorption, &collision);
        results.extend(events.probabilities);
        results.extend(events.weights.into_iter().flatten());
    }

    /// Weights of spectral multiple importance sampling, by the balance heuristic: the density of a
    /// path under each wavelength, over the mean of all densities by `hero_probabilities`.
    ///
    /// `log_densities` are natural logarithms, < ∞, and −∞ for a path that the wavelength does not
    /// have; what all have in common may be left out. For a free flight that is minus its optical
    /// depth, plus the logarithm of the attenuation coefficient if it ends in a collision.
    /// `hero_probabilities` are those by which the wavelength that draws paths is chosen, in
    /// [0, 1] and of sum 1 to within 1e-5.
    ///
    /// A wavelength's share of an image is contribution over density, times this weight; over its
    /// own probability density if wavelengths are drawn, which is no part of `log_densities`.
    /// The mean of the weights by `hero_probabilities` is 1, or 0 if no hero has such a path. Only
    /// differences of logarithms count, so optical depths may be of any size. A weight is at most
    /// 1 over the hero probability; where that is 0, it is limited to 1e150, in single precision
    /// 1e15. Source: article, Eq. 61 to 66, corrected; Wilkie et al. (2014).
    ///
    /// # Safety
    /// Spectra and `weights` point to `n_wavelengths` numbers.
    am_spectral_mis_weights_f64 am_spectral_mis_weights_f32
    am_spectral_mis_weights_batch_f64 am_spectral_mis_weights_batch_f32
    am_spectral_mis_weights_record
    [n_wavelengths;]
    |log_densities: spectrum logarithms, hero_probabilities: spectrum distribution|
    -> (weights [n_wavelengths])
    results => { results.extend(spectral::spectral_mis_weights(log_densities, hero_probabilities)); }

    /// Probabilities of the wavelengths as heroes in proportion to the size of their path weights,
    /// which are finite; equal where all are 0.
    ///
    /// # Safety
    /// Both arrays point to `n_wavelengths` numbers.
    am_hero_probabilities_f64 am_hero_probabilities_f32
    am_hero_probabilities_batch_f64 am_hero_probabilities_batch_f32 am_hero_probabilities_record
    [n_wavelengths;] |path_weights: spectrum finite| -> (hero_probabilities [n_wavelengths])
    results => { results.extend(spectral::hero_probabilities(path_weights)); }
}
