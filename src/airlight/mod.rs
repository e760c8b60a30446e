//! Air-light: light of a point source that a uniform medium scatters once towards the eye.
//!
//!     L = κ_s ∫ e^(−κ_t (x − x_a + D)) / D² I(θ) Φ(φ) dx,   D² = h² + (x − x_h)²          (4)
//!
//! The ray passes the light at the distance h, at its *foot* x_h. Equation numbers here are those of
//! Pegoraro, Schott, Parker, "An Analytical Approach to Single Scattering for Anisotropic Media and
//! Light Distributions" (2009); `docs/airlight.md` has what we changed.
//!
//! | paper | in code | unit | note |
//! |---|---|---|---|
//! | κ_s, κ_t | `sigma_s`, `sigma_t` | 1/length | uniform, one per channel |
//! | h, x_h | `height`, foot | length | of the light above the ray |
//! | H = κ_t h | | 1 | |
//! | d_el | `axial` | 1 | cosine between ray and axis of the light |
//! | h d_c | `lateral` | length | distance of the foot from the light along its axis |
//! | v/h, −w/h | `q` | 1/length | half the angle at the light, see [`piece`] |
//!
//! Map: [`phase`], [`light`] ← [`frame`] (ray and light) ← [`piece`] (the variable of integration) ←
//! [`quadrature`], which [`AirLight::radiance`] is, and [`closed_form`] with its [`jet`] and
//! [`moments`]. `docs/airlight.md` says why. [`estimate`] chooses among them for a tolerance;
//! [`published`] has the paper's formulas as they are printed, for comparison. [`sunlit`] is directional
//! light, which needs none of them.

pub mod closed_form;
pub mod estimate;
pub mod frame;
pub mod jet;
pub mod light;
pub mod moments;
pub mod phase;
pub mod piece;
pub mod published;
pub mod quadrature;
mod segment;
pub mod sunlit;
pub mod sunlit_box;

use crate::geometry::Ray;
use crate::real::Real;
use light::Light;
use phase::Phase;

/// A point light in a uniform medium, in one or more channels.
#[derive(Clone, Debug)]
pub struct AirLight<R> {
    /// The light.
    pub light: Light<R>,
    /// The phase function of the medium.
    pub phase: Phase<R>,
    /// Scattering coefficient per channel, 1/length, ≥ 0.
    pub sigma_s: Vec<R>,
    /// Extinction coefficient per channel, 1/length, ≥ 0.
    pub sigma_t: Vec<R>,
}

impl<R: Real> AirLight<R> {
    /// Radiance scattered towards the point `t0` of `ray` on its segment from `t0` to `t1` ≤ ∞, per
    /// unit intensity on the axis of the light, in every channel; 1/length² per steradian.
    ///
    /// Between the light and the ray the medium is everywhere. What lies in front of `t0` does not
    /// count: multiply by its transmittance. 0 where `t1` ≤ `t0`.
    ///
    /// By quadrature, or where that costs less in closed form: isotropic lights and media in double
    /// precision. Relative error 1e-9 in `f64`, 1e-4 in `f32`.
    pub fn radiance(&self, ray: &Ray<R>, t0: R, t1: R) -> Vec<R> {
        closed_form::isotropic(self, ray, t0, t1)
            .unwrap_or_else(|| quadrature::radiance(self, &self.phase, ray, t0, t1))
    }

    /// L from the integrals of every channel.
    fn scattered(&self, integrals: Vec<R>) -> Vec<R> {
        let scatter = |(integral, sigma): (R, &R)| integral * *sigma;
        integrals
            .into_iter()
            .zip(&self.sigma_s)
            .map(scatter)
            .collect()
    }
}
