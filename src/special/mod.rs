//! Functions of one variable that profiles are made of.
//!
//! | function | is | domain | relative error f64, f32 |
//! |---|---|---|---|
//! | [`rel::phi`] | (1 − e⁻ˣ)/x | x ≥ 0 | 4e-16, 2e-7 |
//! | [`rel::psi`] | −ln(1 − y)/y | y < 1 | 5e-16, 2e-7 |

pub mod rel;
