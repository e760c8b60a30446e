//! Functions that profiles are made of.
//!
//! | function | is | domain | relative error f64, f32 |
//! |---|---|---|---|
//! | [`rel::phi`] | (1 − e⁻ˣ)/x | x ≥ 0 | 4e-16, 2e-7 |
//! | [`rel::psi`] | −ln(1 − y)/y | y < 1 | 5e-16, 2e-7 |
//! | [`decay::decay`] | ∫ e^(a − x²) g(x²) dx | Y ≥ 0 | 2e-14, 2e-7 |

pub mod chapman;
pub mod decay;
pub mod gauss_legendre;
pub mod gaussian;
pub mod rel;
pub mod tail;
