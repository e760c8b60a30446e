//! The ways to state what matter does to light, and those back: σ_t, σ_a, σ_s and the albedo α from
//! what is measured, tabulated or seen.
//!
//!     σ_t = σ_a + σ_s                                                     (1)
//!     α = σ_s/σ_t                                                         (2)
//!     d = 1/σ_t                                                           (3)
//!     κ = λ σ_a/4π                                                        (4)
//!     σ_t = ρ (σ_t/ρ) = n C                                               (5)
//!     L = (η² − 1)/(η² + 2) = (ρ/m) α_m/(3 ε₀)                            (6)
//!     η − 1 ≈ (ρ/m) α_m/(2 ε₀)                                            (7)
//!     T = 1 − O = e^(−σ_t d)                                              (21)
//!
//! Equation numbers are those of the article; (5) is by mass and by number of particles. L, the
//! *refraction*, adds up: that of a mixture is the sum of those of its parts, each weighted by the
//! fraction of the volume that it has before mixing.
//!
//! Lengths are in any one unit, unless a function says metres or nanometres.
//!
//! | functions | relative error f64, f32 |
//! |---|---|
//! | (1) to (5) | 6e-16, 3e-7 |
//! | (21) and visibility, those with an exponential times 1 + σ_t d | 7e-16, 3e-7 |
//! | (6), (7) | 1e-15, 5e-7 |
//! | Rayleigh cross-sections | 2e-15, 8e-7 |
//!
//! Pairs undo each other to 1e-12, in `f64`, as far as the number between them holds what is asked
//! for: an albedo near 1 tells little of σ_a, a transmittance near 1 little of σ_t. An opacity holds
//! that. `tests/coefficients.rs` asserts all of it.

use crate::medium::{self, attenuate};
use crate::real::Real;
use crate::special::rel::psi;
use std::f64::consts::PI;

// ---- Absorption, scattering, albedo

/// σ_t, 1/length, of (1) from `sigma_a` and `sigma_s` ≥ 0, 1/length.
pub fn sigma_t_from_parts<R: Real>(sigma_a: R, sigma_s: R) -> R {
    sigma_a + sigma_s
}

/// α of (2) from `sigma_a` and `sigma_s` ≥ 0, 1/length; 0 where both are.
pub fn albedo_from_parts<R: Real>(sigma_a: R, sigma_s: R) -> R {
    let (zero, one) = (sigma_a.lit(0.0), sigma_a.lit(1.0));
    let sum = sigma_a + sigma_s;
    sigma_s / R::select(zero.lt(sum), sum, one)
}

/// σ_a = (1 − α) σ_t, 1/length, of (1) and (2) from `sigma_t` ≥ 0, 1/length, and `albedo` in [0, 1].
pub fn sigma_a_from_albedo<R: Real>(sigma_t: R, albedo: R) -> R {
    (albedo.lit(1.0) - albedo) * sigma_t
}

/// σ_s = α σ_t, 1/length, of (2) from `sigma_t` ≥ 0, 1/length, and `albedo` in [0, 1].
pub fn sigma_s_from_albedo<R: Real>(sigma_t: R, albedo: R) -> R {
    albedo * sigma_t
}

// ---- Distances

/// σ_t, 1/length, of (3) from `mean_free_path` > 0, a length that may be infinite.
pub fn sigma_t_from_mean_free_path<R: Real>(mean_free_path: R) -> R {
    mean_free_path.lit(1.0) / mean_free_path
}

/// d, a length, of (3) from `sigma_t` ≥ 0, 1/length; infinite where that is 0.
pub fn mean_free_path<R: Real>(sigma_t: R) -> R {
    sigma_t.lit(1.0) / sigma_t
}

/// σ_t, 1/length, of (21) from `transmittance` in (0, 1] over `at_distance` > 0, a length.
pub fn sigma_t_from_transmittance<R: Real>(transmittance: R, at_distance: R) -> R {
    // Not −ln T, which is −0 for T = 1.
    (transmittance.lit(0.0) - transmittance.ln()) / at_distance
}

/// T of (21) from `sigma_t` ≥ 0, 1/length, over `at_distance` > 0, a length.
pub fn transmittance<R: Real>(sigma_t: R, at_distance: R) -> R {
    medium::transmittance(sigma_t * at_distance)
}

/// σ_t, 1/length, of (21) from `opacity` in [0, 1) over `at_distance` > 0, a length; as precise for
/// small opacities.
pub fn sigma_t_from_opacity<R: Real>(opacity: R, at_distance: R) -> R {
    opacity * psi(opacity) / at_distance
}

/// O of (21) from `sigma_t` ≥ 0, 1/length, over `at_distance` > 0, a length; as precise for small
/// opacities.
pub fn opacity<R: Real>(sigma_t: R, at_distance: R) -> R {
    medium::opacity(sigma_t * at_distance)
}

/// σ_t = −ln(contrast)/V, 1/length: Koschmieder's law, "Theorie der horizontalen Sichtweite",
/// Beitr. Phys. freien Atmos. 12 (1924).
///
/// `visibility` V > 0 is the distance, a length that may be infinite, at which a black object against
/// the horizon keeps `contrast`, in (0, 1): 0.05 for the meteorological optical range of the World
/// Meteorological Organization (WMO-No. 8), 0.02 in Koschmieder's work.
pub fn sigma_t_from_visibility<R: Real>(visibility: R, contrast: R) -> R {
    -contrast.ln() / visibility
}

/// V, a length, the inverse of [`sigma_t_from_visibility`], for `sigma_t` ≥ 0, 1/length; infinite
/// where that is 0.
pub fn visibility<R: Real>(sigma_t: R, contrast: R) -> R {
    -contrast.ln() / sigma_t
}

// ---- Matter

/// 4π times the nanometres in a metre.
const FOUR_PI_PER_NM: f64 = 4e9 * PI;

/// σ_a, 1/m, of (4) from the extinction index κ ≥ 0, the imaginary part of the index of refraction,
/// and the `wavelength` > 0 in vacuum, nm.
pub fn sigma_a_from_extinction_index<R: Real>(extinction_index: R, wavelength: R) -> R {
    wavelength.lit(FOUR_PI_PER_NM) * extinction_index / wavelength
}

/// κ, 1, of (4) from `sigma_a` ≥ 0, 1/m, and the `wavelength` > 0 in vacuum, nm.
pub fn extinction_index<R: Real>(sigma_a: R, wavelength: R) -> R {
    sigma_a * wavelength / wavelength.lit(FOUR_PI_PER_NM)
}

/// σ_t, 1/m, of (5) from `mass_density` ρ ≥ 0, kg/m³, and `mass_attenuation` σ_t/ρ ≥ 0, m²/kg.
pub fn sigma_t_from_mass<R: Real>(mass_density: R, mass_attenuation: R) -> R {
    mass_density * mass_attenuation
}

/// ρ, kg/m³, of (5) from `sigma_t` ≥ 0, 1/m, and `mass_attenuation` > 0, m²/kg.
pub fn mass_density<R: Real>(sigma_t: R, mass_attenuation: R) -> R {
    sigma_t / mass_attenuation
}

/// σ_t, 1/m, of (5) from `number_density` n ≥ 0, 1/m³, and `cross_section` C ≥ 0, m².
pub fn sigma_t_from_number<R: Real>(number_density: R, cross_section: R) -> R {
    number_density * cross_section
}

/// n, 1/m³, of (5) from `sigma_t` ≥ 0, 1/m, and `cross_section` > 0, m².
pub fn number_density<R: Real>(sigma_t: R, cross_section: R) -> R {
    sigma_t / cross_section
}

// ---- Refraction

/// 4π ε₀, F/m: CODATA 2022.
const FOUR_PI_VACUUM_PERMITTIVITY: f64 = 4.0 * PI * 8.8541878188e-12;

/// α' = α_m/(4π ε₀), m³, from the `polarizability` α_m ≥ 0 in C m²/V. Tables have α' in Å³ = 1e-30 m³.
///
/// That of a molecule, 1e-40 C m²/V, is below what `f32` holds with all its digits: the functions
/// below ask for α'.
pub fn polarizability_volume<R: Real>(polarizability: R) -> R {
    polarizability / polarizability.lit(FOUR_PI_VACUUM_PERMITTIVITY)
}

/// α_m, C m²/V, from the `polarizability_volume` α' ≥ 0, m³.
pub fn polarizability<R: Real>(polarizability_volume: R) -> R {
    polarizability_volume * polarizability_volume.lit(FOUR_PI_VACUUM_PERMITTIVITY)
}

/// L of (6), the Lorentz–Lorenz equation, from `mass_density` ρ ≥ 0, kg/m³, `molecular_mass` m > 0,
/// kg, and `polarizability_volume` α' ≥ 0, m³: L = (4π/3) (ρ/m) α'. Where (6) holds, L < 1.
pub fn refraction_from_density<R: Real>(
    mass_density: R,
    molecular_mass: R,
    polarizability_volume: R,
) -> R {
    let factor = mass_density.lit(4.0 / 3.0 * PI);
    attenuate(
        mass_density,
        factor * polarizability_volume / molecular_mass,
    )
}

/// ρ, kg/m³, of (6): the inverse of [`refraction_from_density`], for `refraction` L in [0, 1) and
/// α' > 0.
pub fn density_from_refraction<R: Real>(
    refraction: R,
    molecular_mass: R,
    polarizability_volume: R,
) -> R {
    let factor = refraction.lit(4.0 / 3.0 * PI);
    refraction / (factor * polarizability_volume) * molecular_mass
}

/// η − 1 from `refraction` L in [0, 1), the sum of those of a mixture; as precise for gases.
pub fn refractivity_from_refraction<R: Real>(refraction: R) -> R {
    let (one, three) = (refraction.lit(1.0), refraction.lit(3.0));
    let excess = three * refraction / (one - refraction); // η² − 1
    excess / ((one + excess).sqrt() + one)
}

/// L of (6) from `refractivity` η − 1 ≥ 0; as precise for gases.
pub fn refraction_from_refractivity<R: Real>(refractivity: R) -> R {
    // The numerator is (η − 1) (η + 1), the denominator that + 3.
    let sum = refractivity + refractivity.lit(2.0);
    refractivity / (refractivity + refractivity.lit(3.0) / sum)
}

/// η from `refraction` L in [0, 1), the sum of those of a mixture.
pub fn refractive_index<R: Real>(refraction: R) -> R {
    refraction.lit(1.0) + refractivity_from_refraction(refraction)
}

/// L of (6) from `refractive_index` η ≥ 1.
pub fn refraction_from_index<R: Real>(refractive_index: R) -> R {
    refraction_from_refractivity(refractive_index - refractive_index.lit(1.0))
}

/// η − 1 of (7), for gases, from the arguments of [`refraction_from_density`]: 2π (ρ/m) α'. Low by
/// (η − 1)/6 of itself: 5e-5 for air.
pub fn gas_refractivity<R: Real>(
    mass_density: R,
    molecular_mass: R,
    polarizability_volume: R,
) -> R {
    let factor = mass_density.lit(2.0 * PI);
    attenuate(
        mass_density,
        factor * polarizability_volume / molecular_mass,
    )
}

/// ρ, kg/m³, of (7): the inverse of [`gas_refractivity`], for α' > 0.
pub fn gas_density<R: Real>(refractivity: R, molecular_mass: R, polarizability_volume: R) -> R {
    let factor = refractivity.lit(2.0 * PI);
    refractivity / (factor * polarizability_volume) * molecular_mass
}

// ---- Rayleigh scattering

/// Number of molecules of a gas at 288.15 K and 1013.25 hPa, 1/m³: Bodhaine, Wood, Dutton and Slusser,
/// "On Rayleigh Optical Depth Calculations", J. Atmos. Oceanic Technol. 16 (1999), Section 2.
pub const STANDARD_NUMBER_DENSITY: f64 = 2.546899e25;

/// What red, green and blue stand for, nm: Bruneton and Neyret, "Precomputed Atmospheric Scattering"
/// (2008), Section 4. Light without colour is green.
pub const RGB_WAVELENGTHS: [f64; 3] = [680.0, 550.0, 440.0];

/// Rayleigh cross-section of a molecule of dry air with 360 ppm of carbon dioxide, m², for a
/// `wavelength` in vacuum, nm.
///
/// Bodhaine et al. (1999), Eq. 29: a fit to their computation, which has the King factor of each gas.
/// It is off by 0.01 % from 250 to 850 nm, by 0.4 % at 200 nm and by 3 % at 2000 nm.
pub fn rayleigh_air<R: Real>(wavelength: R) -> R {
    let lit = |value| wavelength.lit(value);
    let x = wavelength / lit(1000.0);
    let x = x * x; // µm²
    let numerator = lit(1.0455996) - lit(341.29061) / x - lit(0.90230850) * x;
    let denominator = lit(1.0) + lit(0.0027059889) / x - lit(85.968563) * x;
    lit(1e-32) * (numerator / denominator)
}

/// Rayleigh cross-section of a molecule of a gas, m²: (24π³/λ⁴) (L/n)² F.
///
/// `wavelength` λ > 0 in vacuum, nm; `refractivity` η − 1 ≥ 0 of the gas where there are
/// `number_density` n > 0 of its molecules, 1/m³; `king_factor` F ≥ 1, for molecules that are not
/// round. Sneep and Ubachs, "Direct measurement of the Rayleigh scattering cross section in various
/// gases", JQSRT 92 (2005), Eq. 1.
pub fn rayleigh_cross_section<R: Real>(
    wavelength: R,
    refractivity: R,
    number_density: R,
    king_factor: R,
) -> R {
    // A square at the end: neither n² nor (L/n)² is a number that f32 holds.
    let factor = wavelength.lit((24.0 * PI * PI * PI).sqrt() * 1e18); // (nm/m)²
    let amplitude = refraction_from_refractivity(refractivity) * factor
        / (wavelength * wavelength)
        / number_density;
    amplitude * amplitude * king_factor
}
