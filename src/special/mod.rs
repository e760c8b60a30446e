//! Functions that profiles are made of.
//!
//! | function | is | domain | relative error f64, f32 |
//! |---|---|---|---|
//! | [`rel::phi`] | (1 − e⁻ˣ)/x | x ≥ 0 | 4e-16, 2e-7 |
//! | [`rel::psi`] | −ln(1 − y)/y | y < 1 | 5e-16, 2e-7 |
//! | [`erfcx::erfcx`] | exp(x²) erfc(x) | all x | 5e-16, 5e-7 |
//! | [`bessel::k1_scaled`] | z e^z K₁(z) | z ≥ 0 | 2e-14, 6e-7 |
//! | [`chapman::chapman`] | column of a ray around a planet | z ≥ 0, all angles | 9e-14, 1e-6 |
//! | [`expint::ei`], [`expint::ei_scaled`] | exponential integral of x + iy | \|y\| ≤ 1000 | 6e-15, 4e-7 |
//! | [`expint::e1`], [`expint::e1_scaled`] | exponential integral E₁ | x > 0 | 6e-14, 5e-7 |
//! | [`decay::decay`] | ∫ e^(a − x²) g(x²) dx | Y ≥ 0 | 2e-14, 2e-7 |

pub mod angle;
pub mod approximations;
pub mod arc;
pub mod bessel;
pub mod chapman;
pub mod decay;
pub mod erfcx;
pub mod expint;
pub mod gauss_legendre;
pub mod gaussian;
pub mod rel;
pub mod tail;
