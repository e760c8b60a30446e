//! erfcx(x) = exp(x²) erfc(x), the scaled complementary error function.
//!
//! erfcx(0) = 1; erfcx(−x) = 2 exp(x²) − erfcx(x); erfcx(x) → 1/(x√π) as x → ∞.
//!
//! | interval | method                                                   | terms f64, f32 | relative error f64, f32 |
//! |----------|----------------------------------------------------------|----------------|-------------------------|
//! | x ≥ 0    | (1 + 2x) erfcx(x), a polynomial in u = (x − 3)/(x + 3)   | 25, 12         | 5e-16, 5e-7             |
//! | x < 0    | the reflection above                                     |                | 5e-16, 5e-7             |
//!
//! u maps [0, ∞] to [−1, 1], where (1 + 2x) erfcx(x) is smooth, between 1 and 1.26. The coefficients
//! are those of the Chebyshev interpolant, computed with 60 digits; the first Chebyshev term left
//! out is 6e-18 (f64) and 2e-9 (f32). Two divisions and no exponential for x ≥ 0; one exponential
//! more for x < 0, whose argument x² is taken with its rounding.
//!
//! Overflows to ∞ below x = −26.6 (f64) and −9.3 (f32).

use crate::real::{Real, either, polynomial};

const DOUBLE: [f64; 25] = [
    1.2530080582697296,
    -0.13562110612458117,
    -0.04756229435345087,
    0.1296451587027606,
    -0.11927366341530699,
    0.06830802734397848,
    -0.023770514918645888,
    0.002529391816066239,
    0.0018886903591561553,
    -0.0007798322721083991,
    -0.00010515979981501177,
    0.00012509935235563107,
    4.949484992570595e-6,
    -2.0100567931289227e-5,
    -7.315105164159062e-7,
    3.472414602875686e-6,
    3.5683839153992204e-7,
    -6.166496077604353e-7,
    -1.4160064940265987e-7,
    1.0187000600072885e-7,
    4.180784698845582e-8,
    -1.3326364813003834e-8,
    -8.500397929772615e-9,
    9.885798831139365e-10,
    8.864219016427092e-10,
];

const SINGLE: [f64; 12] = [
    1.2530080563514496,
    -0.13562110005839803,
    -0.047562156146354076,
    0.1296447209153884,
    -0.11927528136881009,
    0.06831319671956372,
    -0.023763559702172088,
    0.0025067786718598333,
    0.001875060245867973,
    -0.0007340820503933423,
    -9.25376912641456e-5,
    8.007454974776248e-5,
];

/// exp(x²) erfc(x) for any x; in (0, 1] for x ≥ 0.
pub fn erfcx<R: Real>(x: R) -> R {
    let zero = x.lit(0.0);
    let reflects = x.lt(zero);
    let tail = positive(x.abs());
    let reflected = || {
        // Beyond −30 it is ∞ in every format.
        let x = R::select(reflects, x, zero).max(x.lit(-30.0));
        let two = x.lit(2.0);
        (x * x).exp() * x.product_rest(x).mul_add(two, two) - tail
    };
    either(reflects, reflected, || tail)
}

/// For x ≥ 0, ∞ included.
fn positive<R: Real>(x: R) -> R {
    let (one, three) = (x.lit(1.0), x.lit(3.0));
    let t = three / (x + three);
    let coefficients = if x.digits() <= 24 {
        &SINGLE[..]
    } else {
        &DOUBLE[..]
    };
    polynomial(one - t - t, coefficients) / (one + x + x)
}
