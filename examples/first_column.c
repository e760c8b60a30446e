/* First use: how much fog a ray meets, and where a photon is stopped.
 *
 *     cc -I include examples/first_column.c -lanalytic_media -lm
 */

#include <analytic_media.h>

#include <math.h>
#include <stdio.h>

int main(void) {
    const double origin[3] = { 0, 0, 1.5 };      /* the eye, above the ground */
    const double direction[3] = { 0.6, 0, 0.8 }; /* a unit vector, upwards */
    const double sigma_t[1] = { 0.05 };          /* attenuation at the ground, 1/length */
    am_profile fog = { 0, { 0, 0, 1, /* up */ 0, /* base_height */ 20 /* scale_height */ } };
    am_medium medium = { &fog, sigma_t, 1, 1 };
    double column, transmittance, t;

    if (am_profile_kind("exponential", &fog.kind) || am_medium_check(&medium) ||
        am_profile_column_f64(&fog, origin, direction, 100, &column) ||
        am_medium_transmittance_f64(&medium, origin, direction, INFINITY, &transmittance) ||
        am_medium_free_flight_f64(&medium, 0, origin, direction, INFINITY, 0.5, &t)) {
        fprintf(stderr, "%s\n", am_last_error());
        return 1;
    }
    printf("column over 100 units of length: %g\n", column);
    printf("transmittance to the sky:        %g\n", transmittance);
    printf("optical depth 0.5 is reached at: %g\n", t);
    return 0;
}
