//! A real number that counts how often a solver asks whether it may stop.

use analytic_media::real::{Mask, Real};
use std::cell::Cell;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

thread_local! {
    static QUESTIONS: Cell<usize> = const { Cell::new(0) };
}

/// Number of times that `Mask::any` was called by `body`: once per step of a solver.
pub fn questions<T>(body: impl FnOnce() -> T) -> (T, usize) {
    QUESTIONS.set(0);
    let result = body();
    (result, QUESTIONS.get())
}

/// `R`, whose masks count.
#[derive(Clone, Copy, Debug)]
pub struct Counted<R>(pub R);

/// A truth value that counts.
#[derive(Clone, Copy, Debug)]
pub struct CountedMask<M>(M);

macro_rules! operator {
    ($($Trait:ident $method:ident)*) => { $(
        impl<R: Real> $Trait for Counted<R> {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0))
            }
        }
    )* };
}

operator!(Add add Sub sub Mul mul Div div);

impl<R: Real> Neg for Counted<R> {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl<R: Real> Real for Counted<R> {
    type Mask = CountedMask<R::Mask>;
    const DERIVATIVES: bool = R::DERIVATIVES;

    fn lit(self, value: f64) -> Self {
        Self(self.0.lit(value))
    }
    fn digits(self) -> u32 {
        self.0.digits()
    }
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    fn exp(self) -> Self {
        Self(self.0.exp())
    }
    fn ln(self) -> Self {
        Self(self.0.ln())
    }
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }
    fn mul_add(self, a: Self, b: Self) -> Self {
        Self(self.0.mul_add(a.0, b.0))
    }
    fn detach(self) -> Self {
        self
    }
    fn lt(self, other: Self) -> Self::Mask {
        CountedMask(self.0.lt(other.0))
    }
    fn le(self, other: Self) -> Self::Mask {
        CountedMask(self.0.le(other.0))
    }
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self {
        Self(R::select(mask.0, a.0, b.0))
    }
}

impl<M: Mask> BitAnd for CountedMask<M> {
    type Output = Self;
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl<M: Mask> BitOr for CountedMask<M> {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl<M: Mask> Not for CountedMask<M> {
    type Output = Self;
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl<M: Mask> Mask for CountedMask<M> {
    fn any(self) -> bool {
        QUESTIONS.set(QUESTIONS.get() + 1);
        self.0.any()
    }
}
