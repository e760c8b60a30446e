//! Dual numbers: a value with its derivatives by `N` variables (forward mode).
//!
//! They serve derivatives in Rust, and check every derivative that is written by hand.

use super::Real;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value and its gradient.
#[derive(Clone, Copy, Debug)]
pub struct Dual<R, const N: usize> {
    /// The value.
    pub value: R,
    /// Derivative of the value by each variable.
    pub gradient: [R; N],
}

impl<R: Real, const N: usize> Dual<R, N> {
    /// A number that depends on no variable.
    pub fn constant(value: R) -> Self {
        Self {
            value,
            gradient: [value.lit(0.0); N],
        }
    }

    /// The variable number `index`.
    pub fn variable(value: R, index: usize) -> Self {
        let mut dual = Self::constant(value);
        dual.gradient[index] = value.lit(1.0);
        dual
    }

    /// Chain rule: `value` = f(self), `slope` = f′(self).
    fn chain(self, value: R, slope: R) -> Self {
        Self {
            value,
            gradient: self.gradient.map(|g| times(slope, g)),
        }
    }

    fn zip(self, other: Self, value: R, f: impl Fn(R, R) -> R) -> Self {
        let gradient = std::array::from_fn(|i| f(self.gradient[i], other.gradient[i]));
        Self { value, gradient }
    }
}

/// slope · gradient, and 0 where the gradient is 0, however steep the function is.
fn times<R: Real>(slope: R, gradient: R) -> R {
    let zero = gradient.lit(0.0);
    let still = gradient.le(zero) & zero.le(gradient);
    R::select(still, zero, slope * gradient)
}

impl<R: Real, const N: usize> Add for Dual<R, N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.zip(other, self.value + other.value, |a, b| a + b)
    }
}

impl<R: Real, const N: usize> Sub for Dual<R, N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.zip(other, self.value - other.value, |a, b| a - b)
    }
}

// The product and quotient rules are sums.
#[allow(clippy::suspicious_arithmetic_impl)]
impl<R: Real, const N: usize> Mul for Dual<R, N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (x, y) = (self.value, other.value);
        self.zip(other, x * y, |a, b| times(y, a) + times(x, b))
    }
}

#[allow(clippy::suspicious_arithmetic_impl)]
impl<R: Real, const N: usize> Div for Dual<R, N> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let y = other.value;
        let quotient = self.value / y;
        self.zip(other, quotient, |a, b| (a - times(quotient, b)) / y)
    }
}

impl<R: Real, const N: usize> Neg for Dual<R, N> {
    type Output = Self;
    fn neg(self) -> Self {
        self.chain(-self.value, self.value.lit(-1.0))
    }
}

impl<R: Real, const N: usize> Real for Dual<R, N> {
    type Mask = R::Mask;
    const DERIVATIVES: bool = true;

    fn lit(self, value: f64) -> Self {
        Self::constant(self.value.lit(value))
    }
    fn digits(self) -> u32 {
        self.value.digits()
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, root.lit(0.5) / root)
    }
    fn exp(self) -> Self {
        let exp = self.value.exp();
        self.chain(exp, exp)
    }
    fn ln(self) -> Self {
        self.chain(self.value.ln(), self.value.lit(1.0) / self.value)
    }
    fn abs(self) -> Self {
        let zero = self.value.lit(0.0);
        let sign = R::select(self.value.lt(zero), zero.lit(-1.0), zero.lit(1.0));
        self.chain(self.value.abs(), sign)
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
        Self::constant(self.value.detach())
    }
    fn lt(self, other: Self) -> R::Mask {
        self.value.lt(other.value)
    }
    fn le(self, other: Self) -> R::Mask {
        self.value.le(other.value)
    }
    fn select(mask: R::Mask, a: Self, b: Self) -> Self {
        a.zip(b, R::select(mask, a.value, b.value), |x, y| {
            R::select(mask, x, y)
        })
    }
}
