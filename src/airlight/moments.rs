//! The integrals of the closed form: powers of v or w times the kernel of either reformulation.
//!
//!     before the foot   m_n = ∫ e^(−H(w − a)) wⁿ/(1 + w²) dw          from a to b   (the paper's v = w)
//!     beyond it         m_n = ∫ e^(−H(1/w − 1/b)) wⁿ/(1 + w²) dw      from a to b   (its w = −w)
//!
//! m₀ and m₁ are I₀, I₁ (Eq. 11) and J₀, J₁ (Eq. 17), which (32) to (35) make differences of the same
//! functions. With S(z) of [`crate::special::expint`] and z = −H(t + i),
//!
//!     i₁(t) − i i₀(t) = e^(−Ht) S(z) + constant,
//!
//! so no sine or cosine is left, and nothing overflows. The others follow from
//!
//!     m_(n+2) = p_n − m_n,   p_n the same integral without 1/(1 + w²),
//!
//! where (13) and (19) have sums of powers of 1/H that cancel. p_n is a recurrence, taken in the
//! direction in which it is stable.

use crate::real::Real;
use crate::special::expint::{e1_scaled, ei_scaled};

/// Steps of the recurrence of p_n before the foot that begin at nothing.
const DEPTH: usize = 120;

/// e^(−H(t − start)) S(−H(t + i)), and nothing at infinity.
fn scaled<R: Real>(optical: R, t: R, start: R) -> [R; 2] {
    let finite = t.lt(t.lit(1e30));
    let t = R::select(finite, t, start);
    let decay = (-optical * (t - start)).exp();
    let decay = R::select(finite, decay, decay.lit(0.0));
    let [re, im] = ei_scaled(-(optical * t), -optical);
    [decay * re, decay * im]
}

/// m_n from m₀, m₁ and p_n.
fn recur<R: Real, const N: usize>(first: [R; 2], powers: [R; N]) -> [R; N] {
    let mut m = [first[0]; N];
    for n in 1..N {
        m[n] = if n == 1 {
            first[1]
        } else {
            powers[n - 2] - m[n - 2]
        };
    }
    m
}

/// m_n before the foot, 0 ≤ `a` < `b` ≤ 1; `optical` is H > 0.
pub fn before<R: Real, const N: usize>(optical: R, a: R, b: R) -> [R; N] {
    let (from, to) = (scaled(optical, a, a), scaled(optical, b, a));
    recur(
        [from[1] - to[1], to[0] - from[0]],
        plain_before(optical, a, b),
    )
}

/// p_n = ∫ wⁿ e^(−H(w − a)) dw: n p_(n−1) = H p_n + [wⁿ e^(−H(w − a))].
fn plain_before<R: Real, const N: usize>(optical: R, a: R, b: R) -> [R; N] {
    let zero = a.lit(0.0);
    let decay = (-optical * (b - a)).exp();
    let thick = zero.lit(30.0).lt(optical);
    let thin = R::select(thick, zero, optical);
    let ends = |n: u32| super::light::power(b, n) * decay - super::light::power(a, n);
    let mut down = zero;
    let mut p = [zero; N];
    for n in (1..=N + DEPTH).rev() {
        down = thin.mul_add(down, ends(n as u32)) * zero.lit(1.0 / n as f64);
        if n <= N {
            p[n - 1] = down;
        }
    }
    let inverse = zero.lit(1.0) / R::select(thick, optical, zero.lit(30.0));
    let mut up = -ends(0) * inverse;
    for (n, p) in p.iter_mut().enumerate() {
        if n > 0 {
            up = (up * zero.lit(n as f64) - ends(n as u32)) * inverse;
        }
        *p = R::select(thick, up, *p);
    }
    p
}

/// m_n beyond the foot, 0 ≤ `a` < `b` ≤ 1; `optical` is H > 0.
pub fn beyond<R: Real, const N: usize>(optical: R, a: R, b: R) -> [R; N] {
    let one = a.lit(1.0);
    let least = a.lit(1e-31);
    let (near, far) = (one / b, one / a.max(least));
    let (from, to) = (scaled(optical, near, near), scaled(optical, far, near));
    // ∫ e^(−H(t − 1/b))/t dt: Jₑ (35).
    let open = far.lt(one.lit(1e30));
    let end = R::select(open, far, near);
    let decay = (-optical * (end - near)).exp();
    let tail = R::select(open, decay * e1_scaled(optical * end), one.lit(0.0));
    let integral = e1_scaled(optical * near) - tail;
    let decay = R::select(open, decay, one.lit(0.0));
    recur(
        [from[1] - to[1], integral - (to[0] - from[0])],
        plain_beyond(optical, [a, b], decay, integral),
    )
}

/// p_n = ∫ wⁿ e^(−H(1/w − 1/b)) dw: (n + 1) p_n + H p_(n−1) = [w^(n+1) e^(−H(1/w − 1/b))], with
/// p_(−1) = `integral`.
fn plain_beyond<R: Real, const N: usize>(
    optical: R,
    [a, b]: [R; 2],
    decay: R,
    integral: R,
) -> [R; N] {
    let zero = a.lit(0.0);
    let ends = |n: u32| super::light::power(b, n) - super::light::power(a, n) * decay;
    let thick = zero.lit(8.0).lt(optical);
    let mut up = integral;
    let mut p = [zero; N];
    for (n, p) in p.iter_mut().enumerate() {
        up = (ends(n as u32 + 1) - optical * up) * zero.lit(1.0 / (n as f64 + 1.0));
        *p = up;
    }
    let optical = R::select(thick, optical, zero.lit(8.0));
    let inverse = zero.lit(1.0) / optical;
    let last = |w: R| {
        let order = N as u32 + 1;
        super::light::power(w, order) / w * expint_scaled(order, optical / w)
    };
    let mut down = last(b) - decay * last(a.max(zero.lit(1e-31)));
    for n in (0..N).rev() {
        p[n] = R::select(thick, down, p[n]);
        down = (ends(n as u32 + 1) - zero.lit(n as f64 + 1.0) * down) * inverse;
    }
    p
}

/// e^x E_m(x) = 1/(x + m − m/(x + m + 2 − 2(m + 1)/(x + m + 4 − …))), x ≥ 8: the generalised
/// exponential integral, to 1e-15.
fn expint_scaled<R: Real>(m: u32, x: R) -> R {
    let term = |k: u32| x + x.lit(f64::from(m + 2 * k));
    let inner = (1..=30u32).rev().fold(term(30), |inner, k| {
        term(k - 1) - x.lit(f64::from(k * (m + k - 1))) / inner
    });
    x.lit(1.0) / inner
}
