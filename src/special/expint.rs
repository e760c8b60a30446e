//! Exponential integrals: Ei of a complex and E₁ of a positive number, and both without their
//! exponential.
//!
//!     Ei(z) = γ + ln z + Σ zᵏ/(k k!)                                         (21)
//!     Ei(z) = iπ sgn(y) + e^z S(z),   z = x + iy                             (24)
//!     S(z)  = Σ k!/z^(k+1) as |z| → ∞
//!     S(z)  = 1/(z − 1 − 1/(z − 3 − 4/(z − 5 − 9/(…))))
//!     E₁(x) = −Ei(−x), x > 0
//!
//! Equation numbers are those of Pegoraro, Schott, Parker (2009). S is bounded by about 1/|z|: it
//! neither overflows nor has the jump of Ei, and without it differences of Ei in thick media are
//! differences of roundings. Their rule between series (27) bounds the absolute error. Here it is
//! the relative one, and all depends on one number, p = |z| − x, which is 0 on the positive axis:
//!
//! * the sum (21) has terms up to e^|z|, and Ei ~ e^x: it cancels by e^p;
//! * n steps of the fraction leave e^(−4 √(n p/2));
//! * the asymptotic sum leaves e^(−|z|).
//!
//! | where                       | method            | terms f64, f32 |
//! |-----------------------------|-------------------|----------------|
//! | p ≥ 4 (f32: 1.5)            | fraction          | 40, 24         |
//! | else, \|z\| < 40 (f32: 18)  | power series (21) | 130, 60        |
//! | else                        | asymptotic series | 40, 18         |
//!
//! Measured on all rows of `expint.json`: |error| over |value|, 5e-14 in f64 and 1e-6 in f32.

use super::angle::{atan2, sin_cos};
use crate::real::{Mask, Real, either};

const EULER: f64 = 0.577_215_664_901_532_9;

/// Real and imaginary part.
pub type Complex<R> = [R; 2];

fn times<R: Real>(a: Complex<R>, b: Complex<R>) -> Complex<R> {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

/// c/z, without overflow on the way.
fn over<R: Real>(c: R, [x, y]: Complex<R>) -> Complex<R> {
    let scale = c.lit(1.0) / x.abs().max(y.abs());
    let (x, y) = (x * scale, y * scale);
    let factor = c * scale / (x * x + y * y);
    [x * factor, -y * factor]
}

fn pick<R: Real>(mask: R::Mask, a: Complex<R>, b: Complex<R>) -> Complex<R> {
    [R::select(mask, a[0], b[0]), R::select(mask, a[1], b[1])]
}

/// `a` where the mask is set, else `b`; each is computed only if some lane needs it.
fn choose<R: Real>(
    mask: R::Mask,
    a: impl FnOnce() -> Complex<R>,
    b: impl FnOnce() -> Complex<R>,
) -> Complex<R> {
    match mask.uniform() {
        Some(true) => a(),
        Some(false) => b(),
        None => pick::<R>(mask, a(), b()),
    }
}

/// By precision.
fn by_digits<R: Real, T>(x: R, single: T, double: T) -> T {
    if x.digits() <= 24 { single } else { double }
}

/// Ei(x + iy), principal branch; on the real axis the principal value, which is real. −∞ at 0, ±∞
/// where it overflows.
///
/// |error| ≤ 1e-12 |Ei| in f64, 2e-6 |Ei| in f32, for |y| ≤ 1000.
pub fn ei<R: Real>(x: R, y: R) -> Complex<R> {
    let [re, im] = unjumped(x, y);
    [re, im + jump(y)]
}

/// S(z) = e^(−z) (Ei(z) − iπ sgn(y)) of z = x + iy, about 1/z where |z| is large.
///
/// |error| ≤ 1e-12 |S| in f64, 2e-6 |S| in f32.
pub fn ei_scaled<R: Real>(x: R, y: R) -> Complex<R> {
    let size = modulus(x, y);
    let z = [x, y];
    let safe = [x.lit(-1.0), x.lit(0.0)];
    let away = x.lit(by_digits(x, 1.5, 4.0)).le(size - x);
    let near = size.lt(x.lit(by_digits(x, 18.0, 40.0)));
    choose::<R>(
        away,
        || fraction(pick::<R>(away, z, safe)),
        || {
            choose::<R>(
                near,
                || {
                    let [x, y] = pick::<R>(near, z, safe);
                    let (sin, cos) = sin_cos(y);
                    let decay = (-x).exp();
                    times([decay * cos, -(decay * sin)], series(x, y))
                },
                || asymptotic(pick::<R>(near, safe, z)),
            )
        },
    )
}

/// Ei(z) − iπ sgn(y) = −E₁(−z): what is left beyond the jump.
pub fn unjumped<R: Real>(x: R, y: R) -> Complex<R> {
    let size = modulus(x, y);
    let small = size.lt(x.lit(1.0));
    choose::<R>(
        small,
        || {
            let safe = [x.lit(-0.5), x.lit(0.0)];
            let [x, y] = pick::<R>(small, [x, y], safe);
            series(x, y)
        },
        || {
            let (sin, cos) = sin_cos(y);
            let grow = x.exp();
            times([grow * cos, grow * sin], ei_scaled(x, y))
        },
    )
}

fn modulus<R: Real>(x: R, y: R) -> R {
    crate::geometry::norm([x, y])
}

/// π sgn(y), 0 for y = 0.
fn jump<R: Real>(y: R) -> R {
    let (zero, pi) = (y.lit(0.0), y.lit(std::f64::consts::PI));
    R::select(y.lt(zero), -pi, R::select(zero.lt(y), pi, zero))
}

/// The fraction from inside.
fn fraction<R: Real>(z: Complex<R>) -> Complex<R> {
    let steps = by_digits(z[0], 24, 40);
    let term = |k: i32| [z[0] - z[0].lit(f64::from(2 * k + 1)), z[1]];
    let mut inner = term(steps);
    for k in (1..=steps).rev() {
        let part = over(z[0].lit(f64::from(k * k)), inner);
        let outer = term(k - 1);
        inner = [outer[0] - part[0], outer[1] - part[1]];
    }
    over(z[0].lit(1.0), inner)
}

/// Ei(z) − iπ sgn(y) by (21).
fn series<R: Real>(x: R, y: R) -> Complex<R> {
    let (zero, one) = (x.lit(0.0), x.lit(1.0));
    let least = x.lit(by_digits(x, 1e-37, 1e-300));
    let mut power = [one, zero];
    let mut sum = [zero, zero];
    let enough = x.unit_roundoff() * x.lit(0.01);
    for k in 1..=by_digits(x, 60, 130) {
        let [re, im] = times(power, [x, y]);
        let k = x.lit(1.0 / f64::from(k));
        power = [re * k, im * k];
        let term = [power[0] * k, power[1] * k];
        sum = [sum[0] + term[0], sum[1] + term[1]];
        let more = |i: usize| (sum[i].abs() * enough).lt(term[i].abs());
        if !(more(0) | more(1)).any() {
            break;
        }
    }
    let logarithm = modulus(x, y).max(least).ln();
    // The angle of −z is that of z without the jump.
    let real = y.le(zero) & zero.le(y);
    let angle = R::select(real, zero, atan2(-y, -x));
    [sum[0] + (logarithm + x.lit(EULER)), sum[1] + angle]
}

/// The asymptotic series.
fn asymptotic<R: Real>(z: Complex<R>) -> Complex<R> {
    let one = z[0].lit(1.0);
    let inverse = over(one, z);
    let zero = z[0].lit(0.0);
    // Horner: 1/z (1 + 1/z (1 + 2/z (1 + …))).
    let mut sum = [one, zero];
    for k in (1..by_digits(one, 18, 40)).rev() {
        let [re, im] = times(sum, inverse);
        let k = one.lit(f64::from(k));
        sum = [k.mul_add(re, one), k * im];
    }
    times(sum, inverse)
}

/// E₁(x) = ∫ e^(−t)/t dt from x to ∞, x > 0; ∞ at 0. Relative error 1e-12 in f64, 2e-6 in f32.
pub fn e1<R: Real>(x: R) -> R {
    let small = x.lt(x.lit(1.0));
    either(
        small,
        || e1_series(R::select(small, x, x.lit(0.5))),
        || (-x).exp() * e1_fraction(R::select(small, x.lit(1.0), x)),
    )
}

/// e^x E₁(x), x > 0, about 1/x where x is large. Relative error as of [`e1`].
pub fn e1_scaled<R: Real>(x: R) -> R {
    let small = x.lt(x.lit(1.0));
    either(
        small,
        || {
            let x = R::select(small, x, x.lit(0.5));
            x.exp() * e1_series(x)
        },
        || e1_fraction(R::select(small, x.lit(1.0), x)),
    )
}

/// x < 1: −γ − ln x − Σ (−x)ᵏ/(k k!).
fn e1_series<R: Real>(x: R) -> R {
    let mut power = x.lit(-1.0);
    let mut sum = x.lit(0.0);
    for k in 1..=by_digits(x, 11, 20) {
        let inverse = x.lit(1.0 / f64::from(k));
        power = -(power * x) * inverse;
        sum = power.mul_add(inverse, sum);
    }
    sum - (x.ln() + x.lit(EULER))
}

/// x ≥ 1: the fraction of e^x E₁.
fn e1_fraction<R: Real>(x: R) -> R {
    let steps = by_digits(x, 20, 70);
    let term = |k: i32| x + x.lit(f64::from(2 * k + 1));
    let inner = (1..=steps).rev().fold(term(steps), |inner, k| {
        term(k - 1) - x.lit(f64::from(k * k)) / inner
    });
    x.lit(1.0) / inner
}
