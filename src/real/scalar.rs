//! `Real` for `f32` and `f64`.

use super::lanes::{F32Lanes, F64Lanes, Lanes};
use super::{Mask, Real};

impl Mask for bool {
    fn any(self) -> bool {
        self
    }

    fn uniform(self) -> Option<bool> {
        Some(self)
    }
}

macro_rules! scalar {
    ($($float:ident in $Lanes:ident)*) => { $(
        impl Real for $float {
            type Mask = bool;

            #[inline]
            fn lit(self, value: f64) -> Self {
                value as $float
            }
            #[inline]
            fn digits(self) -> u32 {
                $float::MANTISSA_DIGITS
            }
            #[inline]
            fn sqrt(self) -> Self {
                $float::sqrt(self)
            }
            #[inline]
            fn exp(self) -> Self {
                $float::exp(self)
            }
            #[inline]
            fn exp_each<const N: usize>(mut exponents: [Self; N]) -> [Self; N] {
                for some in exponents.chunks_mut($Lanes::COUNT) {
                    let lane = |i: usize| some[i.min(some.len() - 1)];
                    let decay = $Lanes::gather(lane).exp();
                    decay.scatter(|i, value| {
                        if let Some(slot) = some.get_mut(i) {
                            *slot = value;
                        }
                    });
                }
                exponents
            }
            #[inline]
            fn ln(self) -> Self {
                $float::ln(self)
            }
            #[inline]
            fn abs(self) -> Self {
                $float::abs(self)
            }
            #[inline]
            fn min(self, other: Self) -> Self {
                $float::min(self, other)
            }
            #[inline]
            fn max(self, other: Self) -> Self {
                $float::max(self, other)
            }
            #[inline]
            fn mul_add(self, a: Self, b: Self) -> Self {
                // Without the instruction, `mul_add` is a slow library call.
                if cfg!(target_feature = "fma") {
                    $float::mul_add(self, a, b)
                } else {
                    self * a + b
                }
            }
            #[inline]
            fn product_rest(self, other: Self) -> Self {
                $float::mul_add(self, other, -(self * other))
            }
            #[inline]
            fn detach(self) -> Self {
                self
            }
            #[inline]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline]
            fn le(self, other: Self) -> bool {
                self <= other
            }
            #[inline]
            fn select(mask: bool, a: Self, b: Self) -> Self {
                if mask { a } else { b }
            }
        }
    )* };
}

scalar!(f32 in F32Lanes f64 in F64Lanes);
