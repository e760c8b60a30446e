//! Gauss–Legendre quadrature with as many points as the number format deserves.
//!
//!     ∫₀ᴸ f(x) dx ≈ L Σ_k w_k f(L x_k),   x_k, w_k on [0, 1]            (1)
//!
//! Points and weights are the zeros of the Legendre polynomials, computed with 60 digits by
//! Newton's method; `tests/special.rs` checks that (1) is exact for polynomials. Both rules
//! are made for the integrands of [`super::decay`]: 24 points leave 2e-14 of them in double
//! precision, 10 points 1.3e-7 in single precision.

use crate::real::Real;
use std::f64::consts::PI;
use std::sync::OnceLock;

/// x_k, w_k of the rule with 10 points.
const SINGLE: [(f64, f64); 10] = [
    (0.01304673574141414, 0.03333567215434407),
    (0.06746831665550775, 0.0747256745752903),
    (0.1602952158504878, 0.10954318125799102),
    (0.2833023029353764, 0.13463335965499817),
    (0.4255628305091844, 0.14776211235737644),
    (0.5744371694908156, 0.14776211235737644),
    (0.7166976970646236, 0.13463335965499817),
    (0.8397047841495122, 0.10954318125799102),
    (0.9325316833444922, 0.0747256745752903),
    (0.9869532642585859, 0.03333567215434407),
];

/// x_k, w_k of the rule with 24 points.
const DOUBLE: [(f64, f64); 24] = [
    (0.00240639000148932, 0.0061706148999936),
    (0.012635722014345251, 0.014265694314466832),
    (0.030862723998633622, 0.022138719408709904),
    (0.056792236497799485, 0.02964929245771839),
    (0.08999900701304854, 0.03667324070554015),
    (0.12993790421072282, 0.04309508076597664),
    (0.17595317403151223, 0.04880932605205694),
    (0.22728926430558022, 0.05372213505798282),
    (0.2831032461869774, 0.0577528340268628),
    (0.3424786601519183, 0.060835236463901696),
    (0.40444056626319186, 0.06291872817341415),
    (0.4679715535686972, 0.06396909767337608),
    (0.5320284464313028, 0.06396909767337608),
    (0.5955594337368082, 0.06291872817341415),
    (0.6575213398480817, 0.060835236463901696),
    (0.7168967538130225, 0.0577528340268628),
    (0.7727107356944197, 0.05372213505798282),
    (0.8240468259684878, 0.04880932605205694),
    (0.8700620957892772, 0.04309508076597664),
    (0.9100009929869515, 0.03667324070554015),
    (0.9432077635022005, 0.02964929245771839),
    (0.9691372760013663, 0.022138719408709904),
    (0.9873642779856547, 0.014265694314466832),
    (0.9975936099985107, 0.0061706148999936),
];

/// ∫₀ᴸ e^(−`exponent`(x)) `factor`(x) dx by (1), L the `length`; with 10 points in single and
/// 24 in double precision.
///
/// The exponentials are the cost: 10 or 24 of them, which scalars compute as lanes.
pub fn integrate<R: Real>(length: R, exponent: impl Fn(R) -> R, factor: impl Fn(R) -> R) -> R {
    if length.digits() <= 24 {
        sum(&SINGLE, length, exponent, factor)
    } else {
        sum(&DOUBLE, length, exponent, factor)
    }
}

/// [`integrate`] for several factors, with the exponentials of one.
pub fn integrate_each<R: Real, const M: usize>(
    length: R,
    exponent: impl Fn(R) -> R,
    factors: impl Fn(R) -> [R; M],
) -> [R; M] {
    if length.digits() <= 24 {
        sums(&SINGLE, length, exponent, factors)
    } else {
        sums(&DOUBLE, length, exponent, factors)
    }
}

fn sums<R: Real, const N: usize, const M: usize>(
    rule: &[(f64, f64); N],
    length: R,
    exponent: impl Fn(R) -> R,
    factors: impl Fn(R) -> [R; M],
) -> [R; M] {
    let decay = R::exp_each(rule.map(|(x, _)| -exponent(length * length.lit(x))));
    let mut sums = [length.lit(0.0); M];
    for (k, (x, w)) in rule.iter().enumerate() {
        let weight = length.lit(*w) * decay[k];
        for (sum, factor) in sums.iter_mut().zip(factors(length * length.lit(*x))) {
            *sum = factor.mul_add(weight, *sum);
        }
    }
    sums.map(|sum| length * sum)
}

fn sum<R: Real, const N: usize>(
    rule: &[(f64, f64); N],
    length: R,
    exponent: impl Fn(R) -> R,
    factor: impl Fn(R) -> R,
) -> R {
    let decay = R::exp_each(rule.map(|(x, _)| -exponent(length * length.lit(x))));
    let terms: [R; N] = std::array::from_fn(|k| {
        let (x, w) = rule[k];
        length.lit(w) * factor(length * length.lit(x)) * decay[k]
    });
    length * terms.into_iter().fold(length.lit(0.0), |a, b| a + b)
}

/// x_k, w_k of the rule with `points` ≤ 64 points, computed at the first call: zeros of the Legendre
/// polynomial by Newton's method, to 1e-15.
///
/// # Panics
/// If there are no points, or more than 64.
pub fn rule(points: usize) -> &'static [(f64, f64)] {
    static RULES: [OnceLock<Vec<(f64, f64)>>; 65] = [const { OnceLock::new() }; 65];
    assert!((1..=64).contains(&points), "a rule has 1 to 64 points");
    RULES[points].get_or_init(|| (0..points).map(|k| point(points, k)).collect())
}

/// √(2j + 1) P_j at the points of `rule(points)` for the four highest degrees j < `points`, the
/// highest first: orthonormal on [0, 1]. Sums of the rule with them are coefficients of the integrand.
pub fn highest(points: usize) -> &'static [[f64; 4]] {
    static VALUES: [OnceLock<Vec<[f64; 4]>>; 65] = [const { OnceLock::new() }; 65];
    let at = |x: f64| {
        std::array::from_fn(|i| {
            let degree = points - 1 - i;
            (2.0 * degree as f64 + 1.0).sqrt() * legendre(degree, 2.0 * x - 1.0).0
        })
    };
    VALUES[points].get_or_init(|| rule(points).iter().map(|(x, _)| at(*x)).collect())
}

/// Number k of n points on [0, 1], and its weight.
fn point(n: usize, k: usize) -> (f64, f64) {
    let mut x = -(PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos();
    // Quadratic convergence from three digits.
    for _ in 0..5 {
        let (value, slope) = legendre(n, x);
        x -= value / slope;
    }
    let (_, slope) = legendre(n, x);
    (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
}

/// P_n(x) and its derivative.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (before, value) = (
            value,
            ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k,
        );
    }
    (value, n as f64 * (x * value - before) / (x * x - 1.0))
}
