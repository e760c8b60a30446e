//! The ways to state what matter does to light: extinction, absorption, scattering and albedo.

use super::array::Array;
use super::function::{self, functions};
use super::{AmArrayF32, AmArrayF64, AmHostTable, AmNode, AmStatus, arg, guard, query};
use crate::coefficients::{self, RGB_WAVELENGTHS, STANDARD_NUMBER_DENSITY};
use crate::error;
use crate::real::lanes::{F32Lanes, F64Lanes, Lanes};
use crate::real::node::Node;

/// What red, green and blue stand for, nm: Bruneton and Neyret (2008). Light without colour is green.
#[unsafe(no_mangle)]
pub static AM_RGB_WAVELENGTHS: [f64; 3] = RGB_WAVELENGTHS;

/// Number of molecules of air at 288.15 K and 1013.25 hPa, 1/m³: Bodhaine et al. (1999).
#[unsafe(no_mangle)]
pub static AM_STANDARD_NUMBER_DENSITY: f64 = STANDARD_NUMBER_DENSITY;

functions! {
    /// Extinction coefficient `sigma_a` + `sigma_s`, all in 1/length. Source: article, Eq. 1.
    ///
    /// # Safety
    /// `value` points to one number.
    am_sigma_t_from_parts_f64 am_sigma_t_from_parts_f32 am_sigma_t_from_parts_batch_f64
    am_sigma_t_from_parts_batch_f32 am_sigma_t_from_parts_record
    |sigma_a: not_negative, sigma_s: not_negative| => coefficients::sigma_t_from_parts

    /// Single-scattering albedo `sigma_s` / (`sigma_a` + `sigma_s`), coefficients in 1/length; 0 where both
    /// are. Source: article, Eq. 2.
    ///
    /// # Safety
    /// `value` points to one number.
    am_albedo_from_parts_f64 am_albedo_from_parts_f32 am_albedo_from_parts_batch_f64
    am_albedo_from_parts_batch_f32 am_albedo_from_parts_record
    |sigma_a: not_negative, sigma_s: not_negative| => coefficients::albedo_from_parts

    /// Absorption coefficient (1 − `albedo`) `sigma_t`, 1/length. Source: article, Eq. 1 and 2.
    ///
    /// # Safety
    /// `value` points to one number.
    am_sigma_a_from_albedo_f64 am_sigma_a_from_albedo_f32 am_sigma_a_from_albedo_batch_f64
    am_sigma_a_from_albedo_batch_f32 am_sigma_a_from_albedo_record
    |sigma_t: not_negative, albedo: fraction| => coefficients::sigma_a_from_albedo

    /// Scattering coefficient `albedo` · `sigma_t`, 1/length. Source: article, Eq. 2.
    ///
    /// # Safety
    /// `value` points to one number.
    am_sigma_s_from_albedo_f64 am_sigma_s_from_albedo_f32 am_sigma_s_from_albedo_batch_f64
    am_sigma_s_from_albedo_batch_f32 am_sigma_s_from_albedo_record
    |sigma_t: not_negative, albedo: fraction| => coefficients::sigma_s_from_albedo

    /// Extinction coefficient, 1/length, of a mean free path, a length. Source: article, Eq. 3.
    ///
    /// # Safety
    /// `value` points to one number.
    am_sigma_t_from_mean_free_path_f64 am_sigma_t_from_mean_free_path_f32
    am_sigma_t_from_mean_free_path_batch_f64 am_sigma_t_from_mean_free_path_batch_f32
    am_sigma_t_from_mean_free_path_record
    |mean_free_path: positive_or_infinite| => coefficients::sigma_t_from_mean_free_path

    /// Mean free path, a length, of an extinction coefficient, 1/length; ∞ where that is 0.
    /// Source: article, Eq. 3.
    ///
    /// # Safety
    /// `value` points to one number.
    am_mean_free_path_f64 am_mean_free_path_f32 am_mean_free_path_batch_f64 am_mean_free_path_batch_f32
    am_mean_free_path_record
    |sigma_t: not_negative| => coefficients::mean_free_path

    /// Extinction coefficient −ln(`transmittance`) / `at_distance`, 1/length. Source: article, Eq. 21.
    ///
    /// # Safety
    /// `value` points to one number.
    am_sigma_t_from_transmittance_f64 am_sigma_t_from_transmittance_f32
    am_sigma_t_from_transmittance_batch_f64 am_sigma_t_from_transmittance_batch_f32
    am_sigma_t_from_transmittance_record
    |transmittance: some_fraction, at_distance: positive| =>
        coefficients::sigma_t_from_transmittance

    /// Transmittance exp(−`sigma_t` · `at_distance`). Source: article, Eq. 21.
    ///
    /// # Safety
    /// `value` points to one number.
    am_transmittance_f64 am_transmittance_f32 am_transmittance_batch_f64 am_transmittance_batch_f32
    am_transmittance_record
    |sigma_t: not_negative, at_distance: positive| => coefficients::transmittance

    /// Extinction coefficient −ln(1 − `opacity`) / `at_distance`, 1/length; as precise for small
    /// opacities. Source: article, Eq. 21.
    ///
    /// # Safety
    /// `value` points to one number.
    am_sigma_t_from_opacity_f64 am_sigma_t_from_opacity_f32 am_sigma_t_from_opacity_batch_f64
    am_sigma_t_from_opacity_batch_f32 am_sigma_t_from_opacity_record
    |opacity: partial_fraction, at_distance: positive| => coefficients::sigma_t_from_opacity

    /// Opacity 1 − exp(−`sigma_t` · `at_distance`), as precise for small opacities.
    /// Source: article, Eq. 21.
    ///
    /// # Safety
    /// `value` points to one number.
    am_opacity_f64 am_opacity_f32 am_opacity_batch_f64 am_opacity_batch_f32 am_opacity_record
    |sigma_t: not_negative, at_distance: positive| => coefficients::opacity

    /// Extinction coefficient −ln(`contrast`) / `visibility`, 1/length. Source: Koschmieder (1924).
    ///
    /// `visibility` is the distance, a length, at which a black object against the horizon keeps
    /// `contrast`: 0.05 for the meteorological optical range (WMO-No. 8), 0.02 in Koschmieder's work.
    ///
    /// # Safety
    /// `value` points to one number.
    am_sigma_t_from_visibility_f64 am_sigma_t_from_visibility_f32 am_sigma_t_from_visibility_batch_f64
    am_sigma_t_from_visibility_batch_f32 am_sigma_t_from_visibility_record
    |visibility: positive_or_infinite, contrast: proper_fraction| =>
        coefficients::sigma_t_from_visibility

    /// Visibility −ln(`contrast`) / `sigma_t`, a length; ∞ where `sigma_t` is 0.
    /// Source: Koschmieder (1924).
    ///
    /// # Safety
    /// `value` points to one number.
    am_visibility_f64 am_visibility_f32 am_visibility_batch_f64 am_visibility_batch_f32
    am_visibility_record
    |sigma_t: not_negative, contrast: proper_fraction| => coefficients::visibility

    /// Absorption coefficient 4π `extinction_index` / `wavelength`, 1/m. Source: article, Eq. 4.
    ///
    /// `extinction_index` is the imaginary part of the index of refraction, `wavelength` that in vacuum,
    /// in nm.
    ///
    /// # Safety
    /// `value` points to one number.
    am_sigma_a_from_extinction_index_f64 am_sigma_a_from_extinction_index_f32
    am_sigma_a_from_extinction_index_batch_f64 am_sigma_a_from_extinction_index_batch_f32
    am_sigma_a_from_extinction_index_record
    |extinction_index: not_negative, wavelength: positive| =>
        coefficients::sigma_a_from_extinction_index

    /// Extinction index, the imaginary part of the index of refraction, of an absorption coefficient
    /// in 1/m at a `wavelength` in nm. Source: article, Eq. 4.
    ///
    /// # Safety
    /// `value` points to one number.
    am_extinction_index_f64 am_extinction_index_f32 am_extinction_index_batch_f64
    am_extinction_index_batch_f32 am_extinction_index_record
    |sigma_a: not_negative, wavelength: positive| => coefficients::extinction_index

    /// Extinction coefficient `mass_density` · `mass_attenuation`, 1/m, from kg/m³ and m²/kg.
    /// Source: article, Eq. 5.
    ///
    /// # Safety
    /// `value` points to one number.
    am_sigma_t_from_mass_f64 am_sigma_t_from_mass_f32 am_sigma_t_from_mass_batch_f64
    am_sigma_t_from_mass_batch_f32 am_sigma_t_from_mass_record
    |mass_density: not_negative, mass_attenuation: not_negative| => coefficients::sigma_t_from_mass

    /// Mass density `sigma_t` / `mass_attenuation`, kg/m³, from 1/m and m²/kg. Source: article, Eq. 5.
    ///
    /// # Safety
    /// `value` points to one number.
    am_mass_density_f64 am_mass_density_f32 am_mass_density_batch_f64 am_mass_density_batch_f32
    am_mass_density_record
    |sigma_t: not_negative, mass_attenuation: positive| => coefficients::mass_density

    /// Extinction coefficient `number_density` · `cross_section`, 1/m, from 1/m³ and m².
    /// Source: article, Eq. 5.
    ///
    /// # Safety
    /// `value` points to one number.
    am_sigma_t_from_number_f64 am_sigma_t_from_number_f32 am_sigma_t_from_number_batch_f64
    am_sigma_t_from_number_batch_f32 am_sigma_t_from_number_record
    |number_density: not_negative, cross_section: not_negative| => coefficients::sigma_t_from_number

    /// Number density `sigma_t` / `cross_section`, 1/m³, from 1/m and m². Source: article, Eq. 5.
    ///
    /// # Safety
    /// `value` points to one number.
    am_number_density_f64 am_number_density_f32 am_number_density_batch_f64 am_number_density_batch_f32
    am_number_density_record
    |sigma_t: not_negative, cross_section: positive| => coefficients::number_density

    /// Polarisability volume α/(4π ε₀), m³, of a polarisability α in C m²/V, which is too small for all
    /// the digits of single precision. Tables have volumes in Å³ = 1e-30 m³.
    ///
    /// # Safety
    /// `value` points to one number.
    am_polarizability_volume_f64 am_polarizability_volume_f32 am_polarizability_volume_batch_f64
    am_polarizability_volume_batch_f32 am_polarizability_volume_record
    |polarizability: not_negative| => coefficients::polarizability_volume

    /// Polarisability, C m²/V, of a polarisability volume, m³.
    ///
    /// # Safety
    /// `value` points to one number.
    am_polarizability_f64 am_polarizability_f32 am_polarizability_batch_f64 am_polarizability_batch_f32
    am_polarizability_record
    |polarizability_volume: not_negative| => coefficients::polarizability

    /// Refraction L = (η² − 1)/(η² + 2), by the Lorentz–Lorenz equation, of matter of a density in kg/m³
    /// whose molecules have a mass in kg and a polarisability volume in m³. Source: article, Eq. 6.
    ///
    /// Refractions add up: that of a mixture is the sum of those of its parts, each weighted by the
    /// fraction of the volume that it has before mixing.
    ///
    /// # Safety
    /// `value` points to one number.
    am_refraction_from_density_f64 am_refraction_from_density_f32 am_refraction_from_density_batch_f64
    am_refraction_from_density_batch_f32 am_refraction_from_density_record
    |mass_density: not_negative, molecular_mass: positive,
     polarizability_volume: not_negative| =>
        coefficients::refraction_from_density

    /// Density, kg/m³, of matter of a refraction L: the inverse of `am_refraction_from_density_f64`.
    ///
    /// # Safety
    /// `value` points to one number.
    am_density_from_refraction_f64 am_density_from_refraction_f32 am_density_from_refraction_batch_f64
    am_density_from_refraction_batch_f32 am_density_from_refraction_record
    |refraction: partial_fraction, molecular_mass: positive,
     polarizability_volume: positive| =>
        coefficients::density_from_refraction

    /// Refractivity η − 1 of a refraction L in [0, 1), which may be the sum of those of a mixture; as
    /// precise for gases. Source: article, Eq. 6.
    ///
    /// # Safety
    /// `value` points to one number.
    am_refractivity_from_refraction_f64 am_refractivity_from_refraction_f32
    am_refractivity_from_refraction_batch_f64 am_refractivity_from_refraction_batch_f32
    am_refractivity_from_refraction_record
    |refraction: partial_fraction| => coefficients::refractivity_from_refraction

    /// Refraction L = (η² − 1)/(η² + 2) of a refractivity η − 1; as precise for gases.
    /// Source: article, Eq. 6.
    ///
    /// # Safety
    /// `value` points to one number.
    am_refraction_from_refractivity_f64 am_refraction_from_refractivity_f32
    am_refraction_from_refractivity_batch_f64 am_refraction_from_refractivity_batch_f32
    am_refraction_from_refractivity_record
    |refractivity: not_negative| => coefficients::refraction_from_refractivity

    /// Refractive index η of a refraction L in [0, 1). Source: article, Eq. 6.
    ///
    /// # Safety
    /// `value` points to one number.
    am_refractive_index_f64 am_refractive_index_f32 am_refractive_index_batch_f64
    am_refractive_index_batch_f32 am_refractive_index_record
    |refraction: partial_fraction| => coefficients::refractive_index

    /// Refraction L = (η² − 1)/(η² + 2) of a refractive index η. Source: article, Eq. 6.
    ///
    /// # Safety
    /// `value` points to one number.
    am_refraction_from_index_f64 am_refraction_from_index_f32 am_refraction_from_index_batch_f64
    am_refraction_from_index_batch_f32 am_refraction_from_index_record
    |refractive_index: at_least_one| => coefficients::refraction_from_index

    /// Refractivity η − 1 of a gas of a density in kg/m³ whose molecules have a mass in kg and a
    /// polarisability volume in m³. Low by (η − 1)/6 of itself. Source: article, Eq. 7.
    ///
    /// # Safety
    /// `value` points to one number.
    am_gas_refractivity_f64 am_gas_refractivity_f32 am_gas_refractivity_batch_f64
    am_gas_refractivity_batch_f32 am_gas_refractivity_record
    |mass_density: not_negative, molecular_mass: positive,
     polarizability_volume: not_negative| =>
        coefficients::gas_refractivity

    /// Density, kg/m³, of a gas of a refractivity η − 1: the inverse of `am_gas_refractivity_f64`.
    ///
    /// # Safety
    /// `value` points to one number.
    am_gas_density_f64 am_gas_density_f32 am_gas_density_batch_f64 am_gas_density_batch_f32
    am_gas_density_record
    |refractivity: not_negative, molecular_mass: positive, polarizability_volume: positive| =>
        coefficients::gas_density

    /// Rayleigh cross-section of a molecule of dry air, m², at a `wavelength` in vacuum from 200 to
    /// 2000 nm. Off their computation by 0.01 % from 250 to 850 nm, by 0.4 % and 3 % at the ends.
    /// Source: Bodhaine et al. (1999), Eq. 29.
    ///
    /// # Safety
    /// `value` points to one number.
    am_rayleigh_air_f64 am_rayleigh_air_f32 am_rayleigh_air_batch_f64 am_rayleigh_air_batch_f32
    am_rayleigh_air_record
    |wavelength: rayleigh_wavelength| => coefficients::rayleigh_air

    /// Rayleigh cross-section of a molecule of a gas, m²: (24π³/λ⁴) (L/n)² F at a `wavelength` λ in nm,
    /// where the gas has the refractivity η − 1 if there are n = `number_density` molecules in a m³, and
    /// the King factor F. Source: Sneep and Ubachs (2005), Eq. 1.
    ///
    /// # Safety
    /// `value` points to one number.
    am_rayleigh_cross_section_f64 am_rayleigh_cross_section_f32 am_rayleigh_cross_section_batch_f64
    am_rayleigh_cross_section_batch_f32 am_rayleigh_cross_section_record
    |wavelength: positive, refractivity: not_negative, number_density: positive,
     king_factor: at_least_one| =>
        coefficients::rayleigh_cross_section
}
