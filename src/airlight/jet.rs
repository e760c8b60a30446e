//! Taylor arithmetic: a function near a point as the first coefficients of its power series.
//!
//!     f(x₀ + δ) = c₀ + c₁ δ + … + c_(N−1) δ^(N−1)
//!
//! A [`Jet`] is a [`Real`], so phase functions and lights written for any `Real` give their own series,
//! to any order, without derivatives made by hand (the paper, Appendix B).

use crate::real::Real;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The first `N` Taylor coefficients.
#[derive(Clone, Copy, Debug)]
pub struct Jet<R, const N: usize>(pub [R; N]);

impl<R: Real, const N: usize> Jet<R, N> {
    /// A number that does not depend on the variable.
    pub fn constant(value: R) -> Self {
        let mut c = [value.lit(0.0); N];
        c[0] = value;
        Self(c)
    }

    /// The variable near `value`.
    pub fn variable(value: R) -> Self {
        let mut jet = Self::constant(value);
        if let Some(slope) = jet.0.get_mut(1) {
            *slope = value.lit(1.0);
        }
        jet
    }

    /// The first `terms` coefficients, and zeros.
    #[must_use]
    pub fn first(mut self, terms: usize) -> Self {
        let zero = self.zero();
        self.0.iter_mut().skip(terms).for_each(|c| *c = zero);
        self
    }

    /// Coefficients of the powers of x, where these are of the powers of x − `point` (Eq. 42).
    #[must_use]
    pub fn about_zero(self, point: R) -> [R; N] {
        let Self(mut c) = self;
        // Horner's rule, once for each power.
        for lowest in 0..N {
            for k in (lowest..N - 1).rev() {
                c[k] = c[k] - point * c[k + 1];
            }
        }
        c
    }

    fn zero(&self) -> R {
        self.0[0].lit(0.0)
    }

    /// Σ a_j b_(k−j) for j from `first` to `last`.
    fn sum(a: &[R; N], b: &[R; N], k: usize, terms: std::ops::Range<usize>) -> R {
        terms.fold(a[0].lit(0.0), |sum, j| a[j].mul_add(b[k - j], sum))
    }
}

impl<R: Real, const N: usize> Add for Jet<R, N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }
}

impl<R: Real, const N: usize> Sub for Jet<R, N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] - other.0[k]))
    }
}

impl<R: Real, const N: usize> Mul for Jet<R, N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| {
            Self::sum(&self.0, &other.0, k, 0..k + 1)
        }))
    }
}

impl<R: Real, const N: usize> Div for Jet<R, N> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let mut c = [self.zero(); N];
        for k in 0..N {
            c[k] = (self.0[k] - Self::sum(&c, &other.0, k, 0..k)) / other.0[0];
        }
        Self(c)
    }
}

impl<R: Real, const N: usize> Neg for Jet<R, N> {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|c| -c))
    }
}

impl<R: Real, const N: usize> Real for Jet<R, N> {
    type Mask = R::Mask;
    const DERIVATIVES: bool = true;

    fn lit(self, value: f64) -> Self {
        Self::constant(self.0[0].lit(value))
    }
    fn digits(self) -> u32 {
        self.0[0].digits()
    }
    /// From c² = self.
    fn sqrt(self) -> Self {
        let mut c = [self.zero(); N];
        c[0] = self.0[0].sqrt();
        for k in 1..N {
            let twice = c[0] + c[0];
            c[k] = (self.0[k] - Self::sum(&c, &c, k, 1..k)) / twice;
        }
        Self(c)
    }
    /// From c′ = self′ c.
    fn exp(self) -> Self {
        let mut c = [self.zero(); N];
        c[0] = self.0[0].exp();
        for k in 1..N {
            let sum = (1..=k).fold(self.zero(), |sum, j| {
                (self.0[j] * sum.lit(j as f64)).mul_add(c[k - j], sum)
            });
            c[k] = sum / sum.lit(k as f64);
        }
        Self(c)
    }
    /// From self c′ = self′.
    fn ln(self) -> Self {
        let mut c = [self.zero(); N];
        c[0] = self.0[0].ln();
        for k in 1..N {
            let sum = (1..k).fold(self.zero(), |sum, j| {
                (c[j] * sum.lit(j as f64)).mul_add(self.0[k - j], sum)
            });
            c[k] = (self.0[k] - sum / sum.lit(k as f64)) / self.0[0];
        }
        Self(c)
    }
    fn abs(self) -> Self {
        Self::select(self.lt(self.lit(0.0)), -self, self)
    }
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
    fn max(self, other: Self) -> Self {
        Self::select(self.lt(other), other, self)
    }
    fn mul_add(self, a: Self, b: Self) -> Self {
        self * a + b
    }
    fn detach(self) -> Self {
        Self::constant(self.0[0].detach())
    }
    fn lt(self, other: Self) -> R::Mask {
        self.0[0].lt(other.0[0])
    }
    fn le(self, other: Self) -> R::Mask {
        self.0[0].le(other.0[0])
    }
    fn select(mask: R::Mask, a: Self, b: Self) -> Self {
        Self(std::array::from_fn(|k| R::select(mask, a.0[k], b.0[k])))
    }
}
