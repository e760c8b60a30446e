//! `Real` for SIMD lanes: eight `f32` or four `f64`, through the crate `wide`.
//!
//! `wide` rounds `exp` to zero near the ends of its range and for NaN, which is mended here.
//! Its `ln` in f64 is 1e-13 off (its ln 2 has too few digits), so `ln` is written here:
//!
//!     x = 2ᵏ m, ½√2 ≤ m < √2,  f = m − 1,  s = f/(2 + f)
//!     ln x = k ln 2 + f − f²/2 + s (f²/2 + R),  R = 2/3 s² + 2/5 s⁴ + …
//!
//! R is the rest of 2 artanh(s); 10 terms in f64 and 5 in f32 leave less than a quarter ulp.
//! `tests/real.rs` states the errors against the scalar functions.

use super::{Mask, Real, polynomial};
use std::f64::consts::{FRAC_1_SQRT_2, LN_2};
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

/// 2/(2j + 3)
const ARTANH_REST: [f64; 10] = {
    let mut c = [0.0; 10];
    let mut j = 0;
    while j < c.len() {
        c[j] = 2.0 / (2.0 * j as f64 + 3.0);
        j += 1;
    }
    c
};

macro_rules! lanes {
    ($Lanes:ident, $LanesMask:ident, $wide:ident, $scalar:ident as $bits:ident, $count:literal,
     exp_max: $exp_max:literal, ln_terms: $ln_terms:literal, doc: $doc:literal) => {
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

        impl $Lanes {
            /// (k, m) with self = 2ᵏ m and ½√2 ≤ m < √2; self is positive and normal.
            #[inline]
            fn split(self) -> (Self, Self) {
                const FRACTION: u32 = $scalar::MANTISSA_DIGITS - 1;
                const LOWEST: $bits = (FRAC_1_SQRT_2 as $scalar).to_bits();
                const ONE: $bits = (1.0 as $scalar).to_bits();
                // A number whose last bit counts ones: the exponent becomes its fraction.
                const COUNTER: $scalar = (1u64 << FRACTION) as $scalar;
                const BIAS: $scalar = (ONE >> FRACTION) as $scalar;

                let shifted = self
                    .0
                    .to_array()
                    .map(|x| x.to_bits().wrapping_add(ONE - LOWEST));
                let k = shifted.map(|b| $scalar::from_bits((b >> FRACTION) | COUNTER.to_bits()));
                let fraction = (1 << FRACTION) - 1;
                let m = shifted.map(|b| $scalar::from_bits((b & fraction) + LOWEST));
                (
                    Self($wide::from(k) - $wide::splat(COUNTER + BIAS)),
                    Self($wide::from(m)),
                )
            }

            /// The logarithm of positive normal numbers.
            #[inline]
            fn ln_normal(self) -> Self {
                // So few digits that k times it is exact.
                const HIGH: $scalar = {
                    let digits = $scalar::MANTISSA_DIGITS / 2;
                    $scalar::from_bits((LN_2 as $scalar).to_bits() >> digits << digits)
                };
                const LOW: f64 = LN_2 - HIGH as f64;
                let (k, m) = self.split();
                let one = self.lit(1.0);
                let f = m - one;
                let s = f / (one + m);
                let square = s * s;
                let rest = square * polynomial(square, &ARTANH_REST[..$ln_terms]);
                let half = self.lit(0.5) * f * f;
                let low = k.mul_add(self.lit(LOW), s * (half + rest));
                k.mul_add(self.lit(f64::from(HIGH)), f - (half - low))
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
                let inside = Self(self.0.exp());
                let usual = self.abs().le(self.lit($exp_max));
                if !(!usual).any() {
                    return inside;
                }
                // Near the ends of the range and beyond: eˣ = (e^(x/2))².
                let half = (self * self.lit(0.5))
                    .max(self.lit(-$exp_max))
                    .min(self.lit($exp_max));
                let root = Self(half.0.exp());
                let value = Self::select(usual, inside, root * root);
                Self::select(self.le(self), value, self)
            }
            #[inline]
            fn ln(self) -> Self {
                let zero = self.lit(0.0);
                let normal = self.lit(f64::from($scalar::MIN_POSITIVE));
                let strange = self.lt(normal) | !self.is_bounded();
                if !strange.any() {
                    return self.ln_normal();
                }
                let small = self.lt(normal) & zero.lt(self);
                let scale = (1u64 << $scalar::MANTISSA_DIGITS) as f64;
                let usual = Self::select(strange, self.lit(1.0), self);
                let scaled = Self::select(small, self * self.lit(scale), usual).ln_normal();
                let value = Self::select(small, scaled - self.lit(scale.ln()), scaled);
                let value = Self::select(self.is_bounded(), value, self);
                Self::select(self.le(zero), self.lit(f64::NEG_INFINITY), value)
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
            // Baseline x86-64 has no vector fma, and then `mul_add` has two roundings.
            #[inline]
            fn product_rest(self, other: Self) -> Self {
                let (a, b) = (self.0.to_array(), other.0.to_array());
                Self($wide::from(std::array::from_fn::<_, $count, _>(|i| {
                    a[i].product_rest(b[i])
                })))
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
            #[inline]
            fn uniform(self) -> Option<bool> {
                if !self.0.any() {
                    Some(false)
                } else if self.0.all() {
                    Some(true)
                } else {
                    None
                }
            }
        }
    };
}

lanes!(F32Lanes, F32LanesMask, f32x8, f32 as u32, 8, exp_max: 80.0, ln_terms: 5,
    doc: "Eight single-precision numbers.");
lanes!(F64Lanes, F64LanesMask, f64x4, f64 as u64, 4, exp_max: 700.0, ln_terms: 10,
    doc: "Four double-precision numbers.");
