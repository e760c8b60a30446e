//! Exponential and logarithm relative to their argument: what keeps profiles smooth at 0.
//!
//!     φ(x) = (1 − e⁻ˣ)/x  = 1 − x/2 + x²/6 − …                         (1)
//!     ψ(y) = −ln(1 − y)/y = 2 artanh(s)/y, s = y/(2 − y)               (2)
//!
//!     φ₁(x) = −φ′(x) = (1 − (1 + x) e⁻ˣ)/x² = 1/2 − x/3 + x²/8 − …      (3)
//!
//! φ and ψ undo each other: with y = x φ(x), x = y ψ(y). φ(0) = ψ(0) = 1 exactly.
//!
//! | function, interval | method                    | terms f64, f32 | first term left out |
//! |--------------------|---------------------------|----------------|---------------------|
//! | φ, x < 1           | Taylor series (1)         | 18, 10         | 8e-18, 3e-8         |
//! | φ, x ≥ 1           | as written                |                |                     |
//! | φ₁, x < 1          | Taylor series (3)         | 18, 11         | 8e-18, 2e-9         |
//! | φ₁, x ≥ 1          | (φ(x) − e⁻ˣ)/x            |                |                     |
//! | ψ, −1 < y < 1/2    | artanh series (2) in s²   | 16, 7          | 2e-17, 2e-8         |
//! | ψ, elsewhere       | as written                |                |                     |
//!
//! Measured errors: see the table in [`crate::special`]; `tests/special.rs` asserts them.

use crate::real::{Real, either, polynomial};

/// (−1)ᵏ/(k + 1)!
const PHI: [f64; 18] = {
    let mut c = [1.0; 18];
    let mut k = 1;
    while k < c.len() {
        c[k] = -c[k - 1] / (k as f64 + 1.0);
        k += 1;
    }
    c
};

/// (−1)ᵏ/((k + 2) k!)
const PHI_MOMENT: [f64; 18] = {
    let mut c = [0.0; 18];
    let mut k = 0;
    while k < c.len() {
        c[k] = PHI[k] * (k as f64 + 1.0) / (k as f64 + 2.0);
        k += 1;
    }
    c
};

/// 1/(2k + 1)
const ARTANH: [f64; 16] = {
    let mut c = [1.0; 16];
    let mut k = 1;
    while k < c.len() {
        c[k] = 1.0 / (2.0 * k as f64 + 1.0);
        k += 1;
    }
    c
};

/// The coefficients that the format of `x` can tell apart.
fn terms<R: Real>(x: R, series: &[f64], single: usize) -> &[f64] {
    if x.digits() <= 24 {
        &series[..single]
    } else {
        series
    }
}

/// φ(x) = (1 − e⁻ˣ)/x for x ≥ 0, in (0, 1].
pub fn phi<R: Real>(x: R) -> R {
    let one = x.lit(1.0);
    let small = x.lt(one);
    either(
        small,
        || polynomial(R::select(small, x, one), terms(x, &PHI, 10)),
        || {
            let large = R::select(small, one, x);
            (one - (-large).exp()) / large
        },
    )
}

/// What a uniform piece of an exponential consists of, relative to its denser end.
#[derive(Clone, Copy, Debug)]
pub struct PhiMoment<R> {
    /// φ(x) of (1).
    pub phi: R,
    /// φ₁(x) of (3), positive: ∫ s e^(−xs) ds from 0 to 1.
    pub moment: R,
    /// e⁻ˣ.
    pub exp: R,
}

/// (1) and (3) with one exponential, for x ≥ 0.
pub fn phi_moment<R: Real>(x: R) -> PhiMoment<R> {
    let one = x.lit(1.0);
    let small = x.lt(one);
    let exp = (-x).exp();
    let near = R::select(small, x, one);
    let large = R::select(small, one, x);
    let far = (one - exp) / large;
    PhiMoment {
        phi: R::select(small, polynomial(near, terms(x, &PHI, 10)), far),
        moment: R::select(
            small,
            polynomial(near, terms(x, &PHI_MOMENT, 11)),
            (far - exp) / large,
        ),
        exp,
    }
}

/// ψ(y) = −ln(1 − y)/y for y < 1, positive.
pub fn psi<R: Real>(y: R) -> R {
    let (half, one, two) = (y.lit(0.5), y.lit(1.0), y.lit(2.0));
    let small = (-one).lt(y) & y.lt(half);
    either(
        small,
        || {
            let near = R::select(small, y, y.lit(0.0));
            let s = near / (two - near);
            polynomial(s * s, terms(y, &ARTANH, 7)) * (two / (two - near))
        },
        || {
            let far = R::select(small, -one, y);
            -(one - far).ln() / far
        },
    )
}
