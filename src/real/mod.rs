//! The arithmetic that formulas need, and nothing else.
//!
//! A formula is written once, generic over [`Real`], and runs on `f32` and `f64`
//! ([`scalar`]), on SIMD lanes ([`lanes`]), on dual numbers ([`dual`]) and on nodes of a
//! host's computation graph ([`node`]). Three rules follow:
//!
//! * no `if` on a `Real`: both sides are evaluated and [`Real::select`] picks, so the side
//!   that is not taken must be finite, in value and in derivative;
//! * constants are lifted from a value, `x.lit(1.0)`, so there is no global recorder;
//! * loops have fixed trip counts; `if !mask.any() { break }` lets scalars stop early.

pub mod dual;
pub mod lanes;
pub mod node;
pub mod scalar;

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// A real number, a vector of them, or a recorded one.
pub trait Real:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Result of a comparison.
    type Mask: Mask;

    /// Whether a value may carry derivatives.
    const DERIVATIVES: bool = false;

    /// The constant `value`, in the format of `self`.
    #[must_use]
    fn lit(self, value: f64) -> Self;

    /// Bits of the significand: 24 (single) or 53 (double). Picks the length of a series.
    fn digits(self) -> u32;

    /// √self.
    #[must_use]
    fn sqrt(self) -> Self;
    /// e^self; 0 or ∞ beyond the range of the format.
    #[must_use]
    fn exp(self) -> Self;
    /// e^x of each; faster than one by one where the hardware has lanes.
    #[must_use]
    fn exp_each<const N: usize>(exponents: [Self; N]) -> [Self; N] {
        exponents.map(Self::exp)
    }
    /// Natural logarithm; −∞ at 0, ∞ at ∞.
    #[must_use]
    fn ln(self) -> Self;
    /// |self|.
    #[must_use]
    fn abs(self) -> Self;
    /// The smaller of two numbers; neither may be NaN.
    #[must_use]
    fn min(self, other: Self) -> Self;
    /// The larger of two numbers; neither may be NaN.
    #[must_use]
    fn max(self, other: Self) -> Self;
    /// self · a + b, with one rounding where the hardware has it.
    #[must_use]
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// What rounding took from the product: self · other − fl(self · other), exactly where
    /// [`Real::mul_add`] has one rounding, and nothing elsewhere.
    #[must_use]
    fn product_rest(self, other: Self) -> Self {
        self.mul_add(other, -(self * other))
    }
    /// The value without its derivatives.
    #[must_use]
    fn detach(self) -> Self;

    /// self < other.
    fn lt(self, other: Self) -> Self::Mask;
    /// self ≤ other.
    fn le(self, other: Self) -> Self::Mask;

    /// `a` where the mask is set, else `b`.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;

    /// Unit roundoff: half the distance from 1 to the next number.
    #[must_use]
    fn unit_roundoff(self) -> Self {
        self.lit(0.5f64.powi(self.digits() as i32))
    }

    /// self < ∞. Not meant for NaN.
    fn is_bounded(self) -> Self::Mask {
        self.lt(self.lit(f64::INFINITY))
    }
}

/// A truth value, a vector of them, or a recorded one.
pub trait Mask:
    Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// Whether any lane is set; a recorded mask cannot know and answers true.
    fn any(self) -> bool;

    /// What all lanes are, if they are equal and known while the formula is evaluated.
    fn uniform(self) -> Option<bool> {
        None
    }
}

/// `a` where the mask is set, else `b`; each is computed only if some lane needs it.
pub(crate) fn either<R: Real>(mask: R::Mask, a: impl FnOnce() -> R, b: impl FnOnce() -> R) -> R {
    match mask.uniform() {
        Some(true) => a(),
        Some(false) => b(),
        None => R::select(mask, a(), b()),
    }
}

/// [`either`] for several numbers.
pub(crate) fn either_each<R: Real, const M: usize>(
    mask: R::Mask,
    a: impl FnOnce() -> [R; M],
    b: impl FnOnce() -> [R; M],
) -> [R; M] {
    match mask.uniform() {
        Some(true) => a(),
        Some(false) => b(),
        None => {
            let (a, b) = (a(), b());
            std::array::from_fn(|i| R::select(mask, a[i], b[i]))
        }
    }
}

/// Polynomial with `coefficients` in ascending powers, by Horner's rule.
pub(crate) fn polynomial<R: Real>(x: R, coefficients: &[f64]) -> R {
    let (last, rest) = coefficients
        .split_last()
        .expect("a polynomial has a coefficient");
    rest.iter()
        .rev()
        .fold(x.lit(*last), |sum, &c| sum.mul_add(x, x.lit(c)))
}

/// a − b, and what its rounding loses: their sum is exact.
pub(crate) fn difference<R: Real>(a: R, b: R) -> (R, R) {
    let rounded = a - b;
    let from_b = rounded - a;
    let from_a = rounded - from_b;
    (rounded, (a - from_a) - (b + from_b))
}
