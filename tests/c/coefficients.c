/* Coefficients: every form has the known value, and names bad arguments. */

#include "functions.h"

static const double sigma_a = 0.5, sigma_s = 1.5, sigma_t = 2, albedo = 0.75, path = 0.5, far = 3,
                    half = 0.5, small = 1e-12, contrast = 0.02, kappa = 1e-9, wavelength = 500,
                    density = 1.25, attenuation = 0.4, number = 2.5e25, section = 4e-31,
                    mass = 5e-26, volume = 1.6e-30, term = 0.25, index_of_term = 1.4142135623730951,
                    excess = 3e-4, king = 1.05, unit = 1;

#define PI 3.141592653589793
#define FOUR_PI_EPSILON 1.1126500562e-10

static void parts_and_distances(void) {
    TWO(sigma_t_from_parts, 2, 0, sigma_a, sigma_s);
    TWO(albedo_from_parts, 0.75, 0, sigma_a, sigma_s);
    TWO(sigma_a_from_albedo, 0.5, 0, sigma_t, albedo);
    TWO(sigma_s_from_albedo, 1.5, 0, sigma_t, albedo);
    ONE(sigma_t_from_mean_free_path, 2, 0, path);
    ONE(mean_free_path, 0.5, 0, sigma_t);
    TWO(sigma_t_from_transmittance, log(2) / 3, 0, half, far);
    TWO(transmittance, exp(-6), 0, sigma_t, far);
    TWO(sigma_t_from_opacity, 1e-12 / 3, 1e-12, small, far);
    TWO(opacity, 3e-12, 1.6e-12, small, far);
    TWO(sigma_t_from_visibility, log(50) / 3, 0, far, contrast);
    TWO(visibility, log(50) / 2, 0, sigma_t, contrast);
}

static void matter(void) {
    TWO(sigma_a_from_extinction_index, 4 * PI * 1e-9 / 500e-9, 0, kappa, wavelength);
    TWO(extinction_index, 2 * 500e-9 / (4 * PI), 0, sigma_t, wavelength);
    TWO(sigma_t_from_mass, 0.5, 0, density, attenuation);
    TWO(mass_density, 5, 0, sigma_t, attenuation);
    TWO(sigma_t_from_number, 1e-5, 0, number, section);
    TWO(number_density, 5e30, 0, sigma_t, section);
}

static void refraction(void) {
    const double refraction = 4 * PI / 3 * density / mass * volume;
    ONE(polarizability_volume, 1 / FOUR_PI_EPSILON, 1e-9, unit);
    ONE(polarizability, FOUR_PI_EPSILON, 1e-9, unit);
    THREE(refraction_from_density, refraction, 0, density, mass, volume);
    THREE(density_from_refraction, 1.25 * 0.25 / refraction, 0, term, mass, volume);
    ONE(refractivity_from_refraction, sqrt(2) - 1, 0, term);
    ONE(refraction_from_refractivity, excess * (2 + excess) / (3 + excess * (2 + excess)), 0,
        excess);
    ONE(refractive_index, sqrt(2), 0, term);
    ONE(refraction_from_index, 0.25, 0, index_of_term);
    THREE(gas_refractivity, 1.5 * refraction, 0, density, mass, volume);
    THREE(gas_density, 1.25 * 3e-4 / (1.5 * refraction), 0, excess, mass, volume);
}

static void rayleigh(void) {
    const double refraction = excess * (2 + excess) / (3 + excess * (2 + excess));
    const double amplitude = refraction / number / (500e-9 * 500e-9);
    /* The optical depth of Bodhaine et al. (1999), Table 3, over their column of molecules. */
    ONE(rayleigh_air, 0.14336 / (0.0021520 / 1e-32), 2e-4, wavelength);
    FOUR(rayleigh_cross_section, 24 * PI * PI * PI * amplitude * amplitude * king, 0, wavelength,
         excess, number, king);
}

static void constants(void) {
    CHECK(AM_RGB_WAVELENGTHS[0] == 680 && AM_RGB_WAVELENGTHS[2] == 440);
    CHECK_NEAR(AM_STANDARD_NUMBER_DENSITY, 2.546899e25, 0);
}

static void mistakes(void) {
    static const double some[3] = { 0.5, 1, -2 };
    static const am_array_f64 lengths = { some, 1 }, same = { &half, 0 };
    double out[3] = { 77, 77, 77 };
    const am_status bad = AM_STATUS_INVALID_ARGUMENT;
    CHECK_FAILS(am_sigma_t_from_parts_f64(-1, 1, out), bad,
                "sigma_a must be finite and >= 0, got -1");
    CHECK_FAILS(am_sigma_a_from_albedo_f64(1, 1.5, out), bad, "albedo must be in [0, 1], got 1.5");
    CHECK_FAILS(am_sigma_t_from_mean_free_path_f64(0, out), bad,
                "mean_free_path must be > 0 and may be infinite, got 0");
    CHECK_FAILS(am_sigma_t_from_transmittance_f64(0, 1, out), bad,
                "transmittance must be in (0, 1], got 0");
    CHECK_FAILS(am_sigma_t_from_transmittance_f64(0.5, 0, out), bad,
                "at_distance must be finite and > 0, got 0");
    CHECK_FAILS(am_sigma_t_from_opacity_f32(1, 1, (float *) out), bad,
                "opacity must be in [0, 1), got 1");
    CHECK_FAILS(am_sigma_t_from_visibility_f64(NAN, 0.05, out), bad,
                "visibility must be > 0 and may be infinite, got NaN");
    CHECK_FAILS(am_visibility_f64(1, 1, out), bad, "contrast must be in (0, 1), got 1");
    CHECK_FAILS(am_extinction_index_f64(1, 0, out), bad,
                "wavelength must be finite and > 0, got 0");
    CHECK_FAILS(am_refractive_index_f64(1, out), bad, "refraction must be in [0, 1), got 1");
    CHECK_FAILS(am_refraction_from_index_f64(0.9, out), bad,
                "refractive_index must be finite and >= 1, got 0.9");
    CHECK_FAILS(am_rayleigh_air_f64(0.55, out), bad,
                "wavelength must be in [200, 2000] nm, got 0.55");
    CHECK_FAILS(am_sigma_t_from_transmittance_batch_f64(3, same, lengths, out), bad,
                "at_distance must be finite and > 0, got -2.0 at item 2");
    CHECK_FAILS(am_opacity_f64(1, 1, NULL), AM_STATUS_NULL_POINTER, "value");
    CHECK(out[0] == 77 && out[1] == 77 && out[2] == 77);
}

int main(void) {
    parts_and_distances();
    matter();
    refraction();
    rayleigh();
    constants();
    mistakes();
    return REPORT();
}
