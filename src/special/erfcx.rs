//! erfcx(x) = exp(x²) erfc(x), the scaled complementary error function.
//!
//! erfcx(0) = 1; erfcx(−x) = 2 exp(x²) − erfcx(x); erfcx(x) → 1/(x√π) as x → ∞.
//!
//! | interval | method                                                   | terms f64, f32 | relative error f64, f32 |
//! |----------|----------------------------------------------------------|----------------|-------------------------|
//! | x ≥ 0    | (1 + 2x) erfcx(x), a polynomial in u = (x − 3)/(x + 3)   | 25, 12         | 5e-16, 3e-7             |
//! | x < 0    | the reflection above                                     |                | 5e-16, 3e-7             |
//!
//! u maps [0, ∞] to [−1, 1], where (1 + 2x) erfcx(x) is smooth, between 1 and 1.26. The coefficients
//! are those of the Chebyshev interpolant, computed with 60 digits; the first Chebyshev term left
//! out is 6e-18 (f64) and 2e-9 (f32). Two divisions and no exponential for x ≥ 0; one exponential
//! more for x < 0, whose argument x² is taken with its rounding.
//!
//! Overflows to ∞ below x = −26.6 (f64) and −9.3 (f32).

use crate::real::{Real, either, polynomial};

const DOUBLE: [f64; 25] = [
    1.2530080582697296529,
    -0.13562110612458117271,
    -0.047562294353450872048,
    0.12964515870276061969,
    -0.11927366341530699196,
    0.068308027343978475049,
    -0.023770514918645886956,
    0.002529391816066239156,
    0.0018886903591561552193,
    -0.00077983227210839912488,
    -0.00010515979981501177668,
    0.00012509935235563107558,
    4.9494849925705951714e-6,
    -0.000020100567931289228112,
    -7.3151051641590619093e-7,
    3.4724146028756860322e-6,
    3.5683839153992204616e-7,
    -6.1664960776043527766e-7,
    -1.4160064940265986074e-7,
    1.0187000600072885081e-7,
    4.1807846988455821994e-8,
    -1.3326364813003833048e-8,
    -8.5003979297726153534e-9,
    9.8857988311393649365e-10,
    8.8642190164270920236e-10,
];

const SINGLE: [f64; 12] = [
    1.2530080563514495554,
    -0.1356211000583980251,
    -0.047562156146354076736,
    0.12964472091538838429,
    -0.11927528136881008481,
    0.068313196719563726029,
    -0.023763559702172086571,
    0.0025067786718598330893,
    0.0018750602458679729038,
    -0.00073408205039334236168,
    -0.000092537691264145602692,
    0.000080074549747762477959,
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
