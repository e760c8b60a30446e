//! The spherical exponential medium as *Sampling Analytic Participating Media* has it, for
//! comparison: a column is the difference of two Chapman functions (Eq. 44), and the Chapman
//! function the first two terms of an expansion for large z (46–48).
//!
//! Errata: (38) and (39) are printed with the brace of the cosine closed too late, here it is
//! 2 cos θ + s/r. (46) is right as printed, but for large z only; (47) is used down to z sin θ = 0,
//! where it diverges. The fit of erfcx has a relative error of 1.7e-6 for large x, not 1.1e-6.

use analytic_media::real::Real;
use analytic_media::special::approximations::{chapman_horizontal_huestis, chapman_huestis};

/// Numbers that formulas may branch on.
pub trait Scalar: Real + PartialOrd {}
impl<R: Real + PartialOrd> Scalar for R {}

fn sine<R: Scalar>(mu: R) -> R {
    (mu.lit(1.0) - mu * mu).max(mu.lit(0.0)).sqrt()
}

/// (43) with (46) and (48): exp(`surface` − z) C(z, θ).
fn rescaled<R: Scalar>(z: R, surface: R, mu: R) -> R {
    let near = chapman_huestis(z, mu.abs()) * (surface - z).exp();
    if mu < mu.lit(0.0) {
        let perigee = z * sine(mu);
        mu.lit(2.0) * chapman_horizontal_huestis(perigee) * (surface - perigee).exp() - near
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
    let far = chapman_huestis(z_end, end_mu.abs()) * (surface - z_end).exp();
    (near - far).abs() * scale_height
}
