//! The spherical exponential medium as *Sampling Analytic Participating Media* has it, for
//! comparison: a column is the difference of two Chapman functions (Eq. 44), and the Chapman
//! function the first two terms of an expansion for large z (46–48).
//!
//! Errata: (38) and (39) are printed with the brace of the cosine closed too late, here it is
//! 2 cos θ + s/r. (46) is right as printed, but for large z only; (47) is used down to z sin θ = 0,
//! where it diverges. The fit of erfcx has a relative error of 1.7e-6 for large x, not 1.1e-6.

use analytic_media::real::Real;
use std::f64::consts::{FRAC_PI_2, PI};

/// Numbers that formulas may branch on.
pub trait Scalar: Real + PartialOrd {}
impl<R: Real + PartialOrd> Scalar for R {}

/// exp(x²) erfc(x) for x ≥ 0: the article's fit, a polynomial in t − 1/2, t = a/(x + a).
fn erfcx<R: Scalar>(x: R) -> R {
    const RANGE: f64 = 3.978_860_8;
    const FIT: [f64; 10] = [
        -0.010_297_533_124_685,
        0.288_184_314_966_202,
        0.805_188_119_411_469,
        1.203_098_773_956_299,
        1.371_236_562_728_882,
        1.312_000_870_704_651,
        1.079_175_233_840_942,
        0.774_399_876_594_543,
        0.490_166_693_925_858,
        0.275_374_621_152_878,
    ];
    let t = x.lit(RANGE) / (x + x.lit(RANGE));
    let u = t - x.lit(0.5);
    let polynomial = FIT
        .iter()
        .fold(x.lit(0.0), |sum, c| sum.mul_add(u, x.lit(*c)));
    polynomial * t
}

fn sine<R: Scalar>(mu: R) -> R {
    (mu.lit(1.0) - mu * mu).max(mu.lit(0.0)).sqrt()
}

/// (46): C(z, θ) for cos θ = `mu` ≥ 0.
fn upper<R: Scalar>(z: R, mu: R) -> R {
    let lit = |x: f64| z.lit(x);
    let sum = lit(1.0) + sine(mu);
    let x = z.sqrt() * mu / sum.sqrt();
    let first = mu / sum * (lit(1.0) - lit(0.5) / sum);
    let factor = lit(PI.sqrt()) * erfcx(x) / sum.sqrt();
    let leading = z.sqrt() * (sum - lit(1.5) + lit(1.0) / sum);
    let correction = (lit(2.0) * sum - lit(1.0)) / (lit(4.0) * sum * z.sqrt());
    first + factor * (leading + correction)
}

/// (47): C(z, 90°).
fn horizontal<R: Scalar>(z: R) -> R {
    let lit = |x: f64| z.lit(x * FRAC_PI_2.sqrt());
    let polynomial = lit(-15.0 / 128.0) + z * (lit(3.0 / 8.0) + z * lit(1.0));
    polynomial / (z * z.sqrt())
}

/// (43) with (46) and (48): exp(`surface` − z) C(z, θ).
fn rescaled<R: Scalar>(z: R, surface: R, mu: R) -> R {
    let near = upper(z, mu.abs()) * (surface - z).exp();
    if mu < mu.lit(0.0) {
        let perigee = z * sine(mu);
        mu.lit(2.0) * horizontal(perigee) * (surface - perigee).exp() - near
    } else {
        near
    }
}

/// A ray in a spherical medium: radius and cosine where it starts.
#[derive(Clone, Copy)]
pub struct Start<R> {
    pub radius: R,
    pub mu: R,
}

/// (50), (51): the column of a segment of length `t`, which may be infinite.
pub fn column<R: Scalar>(start: Start<R>, t: R, planet_radius: R, scale_height: R) -> R {
    let Start { radius, mu } = start;
    let (zero, one) = (t.lit(0.0), t.lit(1.0));
    let (z, surface) = (radius / scale_height, planet_radius / scale_height);
    if t == t.lit(f64::INFINITY) {
        return rescaled(z, surface, mu) * scale_height;
    }
    // (38) and (39)
    let s = t / radius;
    let stretch = (one + s * (s + mu + mu)).sqrt();
    let (end, end_mu) = (radius * stretch, (s + mu) / stretch);
    // A segment that leads down is the same segment seen from its other end.
    let mu = if end_mu < zero { -mu } else { mu };
    let z_end = end / scale_height;
    let near = rescaled(z, surface, mu);
    let far = upper(z_end, end_mu.abs()) * (surface - z_end).exp();
    (near - far).abs() * scale_height
}
