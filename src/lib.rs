//! Participating media that need no voxels.
//!
//! A medium is a sum of components. A component is a *profile* (where the matter is: a
//! relative density) times *coefficients* (what it does to light). Everything a renderer asks
//! is answered from one primitive per profile, the *column*: the line integral of relative
//! density along a ray segment, in closed form.
//!
//! | paper | in code | unit | note |
//! |---|---|---|---|
//! | ρ(h) | `density` | 1 | relative to the reference density; the profile's own quantity |
//! | N(t) = ∫₀ᵗ ρ ds | `column` | length | inverse: `inv_column` |
//! | σ_a, σ_s, σ_t | `sigma_a`, `sigma_s`, `sigma_t` | 1/length | at ρ = 1 |
//! | τ = σ_t N, T = e^(−τ) | `optical_depth`, `transmittance` | 1 | |
//! | h, H | `altitude`, `scale_height` | length | |
//! | μ | `cos_zenith` | 1 | of the direction of travel; up is positive |
//! | t | `t` | length | distance along the ray |
//! | ξ | `u` | 1 | uniform variate in [0, 1) |
//!
//! Lengths are scene units, angles are cosines.
//!
//! Equation numbers are those of the article "Sampling Analytic Participating Media".
//!
//! Map: [`real`] (the arithmetic) ← [`special`] (functions) ← [`profile`] ← [`medium`] ←
//! [`sampling`] ← [`ffi`] (the C ABI). The dependency runs one way. [`spectral`] and [`airlight`]
//! stand beside `sampling`, the latter with equation numbers and symbols of its own paper;
//! [`coefficients`] has the ways to state σ_t, which the C ABI offers.

pub mod airlight;
pub mod coefficients;
pub mod error;
pub mod ffi;
pub mod geometry;
pub mod medium;
pub mod profile;
pub mod real;
pub mod sampling;
mod solve;
pub mod special;
pub mod spectral;

pub use error::Error;
