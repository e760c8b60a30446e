//! Phase functions: how much light changes its direction by an angle φ. 1/sr, of integral 1.
//!
//!     isotropic           1/(4π)
//!     Rayleigh            3/(16π) (1 + cos² φ)
//!     Henyey–Greenstein   (1 − g²)/(4π) (1 + g² − 2g cos φ)^(−3/2)

use crate::real::Real;
use std::f64::consts::PI;

/// Cosine of the angle between the directions in which light arrives and leaves: 1 is forward.
#[derive(Clone, Copy, Debug)]
pub struct Deflection<R> {
    /// cos φ.
    pub cos: R,
    /// 1 − cos φ, which keeps its digits where light goes on forward.
    pub from_forward: R,
    /// 1 + cos φ, which keeps its digits where light is thrown back.
    pub from_backward: R,
}

/// A phase function.
pub trait PhaseFunction<R> {
    /// Scattered share per steradian, ≥ 0.
    fn value(&self, deflection: Deflection<R>) -> R;

    /// Half-width of the forward peak as tan(φ/2), and of the backward peak as cot(φ/2): what a
    /// quadrature has to resolve. 1 if there is none.
    fn peaks(&self, like: R) -> [R; 2];
}

/// The phase functions that the library knows.
#[derive(Clone, Copy, Debug)]
pub enum Phase<R> {
    /// The same in all directions.
    Isotropic,
    /// Of particles that are small against the wavelength.
    Rayleigh,
    /// Henyey and Greenstein (1941).
    HenyeyGreenstein {
        /// Mean cosine, −1 < g < 1; positive is forward.
        g: R,
    },
}

impl<R: Copy> Phase<R> {
    /// The same phase function in another arithmetic.
    pub fn map<S>(&self, lift: impl Fn(R) -> S) -> Phase<S> {
        match *self {
            Phase::Isotropic => Phase::Isotropic,
            Phase::Rayleigh => Phase::Rayleigh,
            Phase::HenyeyGreenstein { g } => Phase::HenyeyGreenstein { g: lift(g) },
        }
    }
}

impl<R: Real> PhaseFunction<R> for Phase<R> {
    fn value(&self, deflection: Deflection<R>) -> R {
        let cos = deflection.cos;
        match *self {
            Phase::Isotropic => cos.lit(0.25 / PI),
            Phase::Rayleigh => cos.lit(3.0 / (16.0 * PI)) * cos.mul_add(cos, cos.lit(1.0)),
            Phase::HenyeyGreenstein { g } => henyey_greenstein(g, deflection),
        }
    }

    fn peaks(&self, like: R) -> [R; 2] {
        let one = like.lit(1.0);
        match *self {
            Phase::Isotropic | Phase::Rayleigh => [one, one],
            // The zeros of 1 + g² − 2g cos φ, as tan(φ/2), are ±i (1 − g)/(1 + g).
            Phase::HenyeyGreenstein { g } => {
                let width = (one - g) / (one + g);
                [width.min(one), (one / width).min(one)]
            }
        }
    }
}

fn henyey_greenstein<R: Real>(g: R, deflection: Deflection<R>) -> R {
    let (zero, one, two) = (g.lit(0.0), g.lit(1.0), g.lit(2.0));
    // 1 + g² − 2g cos φ as a sum of positive terms.
    let (rest, size) = (one - g.abs(), two * g.abs());
    let away = R::select(
        g.lt(zero),
        deflection.from_backward,
        deflection.from_forward,
    );
    let square = size.mul_add(away, rest * rest);
    g.lit(0.25 / PI) * (one - g) * (one + g) / (square * square.sqrt())
}
