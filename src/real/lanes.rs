//! `Real` for SIMD lanes: eight `f32` or four `f64`, through the crate `wide`.
//!
//! `wide` rounds `exp` to zero above the range and gives `ln` no small arguments; both are
//! mended here, so that lanes and scalars agree at the ends of the range too. Its `ln` in f64
//! has a relative error of 1e-13, larger than everything else here.

use super::{Mask, Real};
use std::f64::consts::LN_2;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};
use wide::{CmpLe, CmpLt, f32x8, f64x4};

/// Several reals of one scalar type that are computed together.
pub trait Lanes: Real {
    /// The type of one lane.
    type Scalar: Real;
    /// Number of lanes.
    const COUNT: usize;
    /// All lanes equal.
    fn splat(value: Self::Scalar) -> Self;
    /// Lane `i` is `value(i)`.
    fn gather(value: impl FnMut(usize) -> Self::Scalar) -> Self;
    /// Calls `store(i, lane i)` for every lane.
    fn scatter(self, store: impl FnMut(usize, Self::Scalar));
}

macro_rules! lanes {
    ($Lanes:ident, $LanesMask:ident, $wide:ident, $scalar:ident, $count:literal,
     exp_max: $exp_max:literal, ln_min: $ln_min:literal, doc: $doc:literal) => {
        #[doc = $doc]
        #[derive(Clone, Copy, Debug)]
        pub struct $Lanes($wide);

        #[doc = concat!("Mask of [`", stringify!($Lanes), "`].")]
        #[derive(Clone, Copy, Debug)]
        pub struct $LanesMask($wide);

        impl Lanes for $Lanes {
            type Scalar = $scalar;
            const COUNT: usize = $count;

            #[inline]
            fn splat(value: $scalar) -> Self {
                Self($wide::splat(value))
            }
            #[inline]
            fn gather(value: impl FnMut(usize) -> $scalar) -> Self {
                Self($wide::from(std::array::from_fn::<_, $count, _>(value)))
            }
            #[inline]
            fn scatter(self, mut store: impl FnMut(usize, $scalar)) {
                for (i, value) in self.0.to_array().into_iter().enumerate() {
                    store(i, value);
                }
            }
        }

        impl Add for $Lanes {
            type Output = Self;
            #[inline]
            fn add(self, other: Self) -> Self {
                Self(self.0 + other.0)
            }
        }
        impl Sub for $Lanes {
            type Output = Self;
            #[inline]
            fn sub(self, other: Self) -> Self {
                Self(self.0 - other.0)
            }
        }
        impl Mul for $Lanes {
            type Output = Self;
            #[inline]
            fn mul(self, other: Self) -> Self {
                Self(self.0 * other.0)
            }
        }
        impl Div for $Lanes {
            type Output = Self;
            #[inline]
            fn div(self, other: Self) -> Self {
                Self(self.0 / other.0)
            }
        }
        impl Neg for $Lanes {
            type Output = Self;
            #[inline]
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }

        impl Real for $Lanes {
            type Mask = $LanesMask;

            #[inline]
            fn lit(self, value: f64) -> Self {
                Self($wide::splat(value as $scalar))
            }
            #[inline]
            fn digits(self) -> u32 {
                $scalar::MANTISSA_DIGITS
            }
            #[inline]
            fn sqrt(self) -> Self {
                Self(self.0.sqrt())
            }
            #[inline]
            fn exp(self) -> Self {
                let high = self.lit($exp_max).lt(self);
                let low = self.lt(self.lit(-$exp_max));
                let inside = Self(self.0.exp());
                if !(high | low).any() {
                    return inside;
                }
                // Near the ends of the range: e^x = 2^±32 e^(x ∓ 32 ln 2).
                let shift = self.lit(32.0 * LN_2);
                let above = Self((self - shift).0.exp()) * self.lit(4_294_967_296.0);
                let below = Self((self + shift).0.exp()) / self.lit(4_294_967_296.0);
                let above = Self::select(
                    self.lit($exp_max + 32.0 * LN_2).lt(self),
                    self.lit(f64::INFINITY),
                    above,
                );
                Self::select(high, above, Self::select(low, below, inside))
            }
            #[inline]
            fn ln(self) -> Self {
                let small = self.lt(self.lit($ln_min));
                if !small.any() {
                    return Self(self.0.ln());
                }
                let scaled = Self::select(small, self * self.lit(1.0 / $ln_min), self);
                let shift = Self::select(small, self.lit(f64::ln($ln_min)), self.lit(0.0));
                let zero = self.le(self.lit(0.0));
                let value = Self(Self::select(zero, self.lit(1.0), scaled).0.ln()) + shift;
                Self::select(zero, self.lit(f64::NEG_INFINITY), value)
            }
            #[inline]
            fn abs(self) -> Self {
                Self(self.0.abs())
            }
            #[inline]
            fn min(self, other: Self) -> Self {
                Self(self.0.fast_min(other.0))
            }
            #[inline]
            fn max(self, other: Self) -> Self {
                Self(self.0.fast_max(other.0))
            }
            #[inline]
            fn mul_add(self, a: Self, b: Self) -> Self {
                Self(self.0.mul_add(a.0, b.0))
            }
            #[inline]
            fn detach(self) -> Self {
                self
            }
            #[inline]
            fn lt(self, other: Self) -> $LanesMask {
                $LanesMask(self.0.cmp_lt(other.0))
            }
            #[inline]
            fn le(self, other: Self) -> $LanesMask {
                $LanesMask(self.0.cmp_le(other.0))
            }
            #[inline]
            fn select(mask: $LanesMask, a: Self, b: Self) -> Self {
                Self(mask.0.blend(a.0, b.0))
            }
        }

        impl BitAnd for $LanesMask {
            type Output = Self;
            #[inline]
            fn bitand(self, other: Self) -> Self {
                Self(self.0 & other.0)
            }
        }
        impl BitOr for $LanesMask {
            type Output = Self;
            #[inline]
            fn bitor(self, other: Self) -> Self {
                Self(self.0 | other.0)
            }
        }
        impl Not for $LanesMask {
            type Output = Self;
            #[inline]
            fn not(self) -> Self {
                Self(!self.0)
            }
        }
        impl Mask for $LanesMask {
            #[inline]
            fn any(self) -> bool {
                self.0.any()
            }
        }
    };
}

lanes!(F32Lanes, F32LanesMask, f32x8, f32, 8, exp_max: 80.0, ln_min: 1e-30,
    doc: "Eight single-precision numbers.");
lanes!(F64Lanes, F64LanesMask, f64x4, f64, 4, exp_max: 700.0, ln_min: 1e-30,
    doc: "Four double-precision numbers.");
