/* Air-light: every form and every light has the known answer; every mistake is named. */

#include "check.h"
#include "host.h"

/* A ray along z passes the light at the distance 2. Without extinction the air-light of the whole
 * ray is sigma_s/(4 * 2), that between the points which see the light at 45 degrees half of it. */
#define HALF_PI 1.5707963267948966
static const double sigma_s[2] = { 1, 3 }, sigma_t[2] = { 0, 0 };
static const double origin[3] = { 0, 0, -5 }, direction[3] = { 0, 0, 1 };
static const double t0 = 3, t1 = 7, from = 0, infinity = INFINITY;
static const double expected[2] = { 0.0625, 0.1875 };
static const am_airlight lamp = {
    { AM_LIGHT_KIND_ISOTROPIC, 0, { 0, 2, 0 }, { 0, -1, 0 }, 0, 0 },
    { AM_PHASE_KIND_ISOTROPIC, 0 },
    sigma_s,
    sigma_t,
    2,
};

static void forms(void) {
    static const float origin_f32[3] = { 0, 0, -5 }, direction_f32[3] = { 0, 0, 1 };
    static const float t0_f32 = 3, t1_f32 = 7;
    static const am_array_f64 origins = { origin, 0 }, directions = { direction, 0 };
    static const am_array_f64 starts = { &t0, 0 }, ends = { &t1, 0 };
    static const am_array_f32 origins_f32 = { origin_f32, 0 },
                              directions_f32 = { direction_f32, 0 };
    static const am_array_f32 starts_f32 = { &t0_f32, 0 }, ends_f32 = { &t1_f32, 0 };
    double a[6];
    float b[6];
    int i;
    CHECK_OK(am_airlight_check(&lamp));
    CHECK_OK(am_airlight_radiance_f64(&lamp, origin, direction, t0, t1, a));
    CHECK_OK(am_airlight_radiance_f32(&lamp, origin_f32, direction_f32, t0_f32, t1_f32, b));
    for (i = 0; i < 2; ++i) {
        CHECK_NEAR(a[i], expected[i], 1e-14);
        CHECK_NEAR(b[i], expected[i], 1e-6);
    }
    CHECK_OK(am_airlight_radiance_batch_f64(&lamp, 3, origins, directions, starts, ends, a));
    CHECK_OK(am_airlight_radiance_batch_f32(&lamp, 3, origins_f32, directions_f32, starts_f32,
                                            ends_f32, b));
    for (i = 0; i < 6; ++i) {
        CHECK_NEAR(a[i], expected[i % 2], 1e-14);
        CHECK_NEAR(b[i], expected[i % 2], 1e-6);
    }
}

static void lights(void) {
    am_airlight other = lamp;
    double a[2];
    /* Light that leaves within 45 degrees of the axis reaches no other point of the ray. */
    other.light.kind = AM_LIGHT_KIND_CONE;
    other.light.cutoff_angle = other.light.beam_width = HALF_PI / 2;
    CHECK_OK(am_airlight_check(&other));
    CHECK_OK(am_airlight_radiance_f64(&other, origin, direction, from, 20, a));
    CHECK_NEAR(a[1], expected[1], 1e-12);
    /* The integrals of cos^2 and, along the ray, of sin^2 from -45 to 45 degrees. */
    other.light.exponent = 2;
    other.light.kind = AM_LIGHT_KIND_SPOT;
    CHECK_OK(am_airlight_check(&other));
    CHECK_OK(am_airlight_radiance_f64(&other, origin, direction, t0, t1, a));
    CHECK_NEAR(a[0], (HALF_PI / 2 + 0.5) / (8 * HALF_PI * 2), 1e-13);
    other.light.kind = AM_LIGHT_KIND_LOBES;
    other.light.axis[1] = 0;
    other.light.axis[2] = 1;
    CHECK_OK(am_airlight_check(&other));
    CHECK_OK(am_airlight_radiance_f64(&other, origin, direction, t0, t1, a));
    CHECK_NEAR(a[0], (HALF_PI / 2 - 0.5) / (8 * HALF_PI * 2), 1e-13);
}

static void phases(void) {
    am_airlight other = lamp;
    double a[2], whole = 0;
    /* A phase function has the integral 1, however it is aimed: the mean over a ray and the same
     * ray with Rayleigh scattering, 3/4 (1 + 1/2) of it on the whole ray. */
    static const double infinitely_far[3] = { 0, 0, -1e9 };
    other.phase.kind = AM_PHASE_KIND_RAYLEIGH;
    CHECK_OK(am_airlight_check(&other));
    CHECK_OK(am_airlight_radiance_f64(&other, infinitely_far, direction, from, infinity, a));
    CHECK_NEAR(a[0], 0.125 * 1.125, 1e-8);
    other.phase.kind = AM_PHASE_KIND_HENYEY_GREENSTEIN;
    other.phase.g = 0;
    CHECK_OK(am_airlight_check(&other));
    CHECK_OK(am_airlight_radiance_f64(&other, infinitely_far, direction, from, infinity, &whole));
    CHECK_NEAR(whole, 0.125, 1e-8);
}

static double rayleigh(double cosine, void *data) {
    return *(const double *) data * (1 + cosine * cosine);
}

/* A tolerance, and a method of choice. */
static void choices(void) {
    static const am_array_f64 origins = { origin, 0 }, directions = { direction, 0 };
    static const am_array_f64 starts = { &t0, 0 }, ends = { &t1, 0 };
    static const double loose = 1e-3;
    static const am_array_f64 tolerances = { &loose, 0 };
    am_airlight other = lamp;
    double a[6], error[6];
    int i;
    other.phase.kind = AM_PHASE_KIND_HENYEY_GREENSTEIN;
    other.phase.g = 0;
    CHECK_OK(am_airlight_radiance_within_f64(&other, origin, direction, t0, t1, loose, a, error));
    for (i = 0; i < 2; ++i) {
        CHECK_NEAR(a[i], expected[i], 1e-3);
        CHECK(error[i] >= 0 && error[i] <= loose);
    }
    CHECK_OK(am_airlight_radiance_within_batch_f64(&other, 3, origins, directions, starts, ends,
                                                   tolerances, a, error));
    for (i = 0; i < 6; ++i) {
        CHECK_NEAR(a[i], expected[i % 2], 1e-3);
        CHECK(error[i] >= 0 && error[i] <= loose);
    }
    CHECK_OK(am_airlight_radiance_by(&other, AM_AIRLIGHT_METHOD_QUADRATURE, 24, 3, origins,
                                     directions, starts, ends, a));
    for (i = 0; i < 6; ++i)
        CHECK_NEAR(a[i], expected[i % 2], 1e-12);
    CHECK_FAILS(am_airlight_radiance_by(&other, 7, 24, 3, origins, directions, starts, ends, a),
                AM_STATUS_INVALID_ARGUMENT, "method must be one of am_airlight_method, got 7");
    CHECK_FAILS(am_airlight_radiance_by(&other, AM_AIRLIGHT_METHOD_FIRST, 0, 3, origins, directions,
                                        starts, ends, a),
                AM_STATUS_INVALID_ARGUMENT, "terms must be in [1, 20], got 0");
}

/* The caller's own phase function. */
static void own_phase(void) {
    am_airlight other = lamp;
    double a[2], b[2], scale = 3 / (32 * HALF_PI);
    other.phase.kind = AM_PHASE_KIND_RAYLEIGH;
    CHECK_OK(am_airlight_radiance_f64(&other, origin, direction, t0, t1, a));
    CHECK_OK(
        am_airlight_radiance_with_phase(&lamp, rayleigh, &scale, origin, direction, t0, t1, b));
    CHECK_NEAR(a[0], b[0], 1e-13);
    CHECK_NEAR(a[1], b[1], 1e-13);
    CHECK_FAILS(am_airlight_radiance_with_phase(&lamp, NULL, &scale, origin, direction, t0, t1, b),
                AM_STATUS_NULL_POINTER, "phase must not be null");
}

static void recorded(void) {
    static tape the_tape;
    am_host_table host = host_on(&the_tape);
    am_airlight_nodes nodes;
    am_node s[2], t[2], o[3], d[3], out[2] = { 77, 77 }, start, end, first, last, fails_at;
    int i;
    nodes.light.kind = lamp.light.kind;
    nodes.light.exponent = lamp.light.exponent;
    for (i = 0; i < 3; ++i) {
        nodes.light.position[i] = put(&the_tape, lamp.light.position[i]);
        nodes.light.axis[i] = put(&the_tape, lamp.light.axis[i]);
        o[i] = put(&the_tape, origin[i]);
        d[i] = put(&the_tape, direction[i]);
    }
    nodes.light.cutoff_angle = put(&the_tape, 0);
    nodes.light.beam_width = put(&the_tape, 0);
    nodes.phase.kind = lamp.phase.kind;
    nodes.phase.g = put(&the_tape, 0);
    for (i = 0; i < 2; ++i) {
        s[i] = put(&the_tape, sigma_s[i]);
        t[i] = put(&the_tape, sigma_t[i]);
    }
    nodes.sigma_s = s;
    nodes.sigma_t = t;
    nodes.n_channels = 2;
    start = put(&the_tape, t0);
    end = put(&the_tape, t1);
    first = the_tape.used;
    CHECK_OK(am_airlight_radiance_record(&host, &nodes, o, d, start, end, out));
    last = the_tape.used;
    for (i = 0; i < 2; ++i)
        CHECK_NEAR(the_tape.values[out[i]], expected[i], 1e-14);
    out[0] = 77;
    for (fails_at = first + 1; fails_at <= last; fails_at += 37) {
        the_tape.used = first;
        the_tape.fails_at = fails_at;
        CHECK_FAILS(am_airlight_radiance_record(&host, &nodes, o, d, start, end, out),
                    AM_STATUS_HOST_ERROR, "slot 0");
        CHECK(out[0] == 77);
    }
    nodes.phase.kind = 99;
    CHECK_FAILS(am_airlight_radiance_record(&host, &nodes, o, d, start, end, out),
                AM_STATUS_INVALID_ARGUMENT, "phase.kind must be one of am_phase_kind, got 99");
}

#define REFUSED(change, text)                                                                      \
    do {                                                                                           \
        am_airlight other = lamp;                                                                  \
        change;                                                                                    \
        CHECK_FAILS(am_airlight_check(&other), AM_STATUS_INVALID_ARGUMENT, text);                  \
    } while (0)

static void mistakes(void) {
    static const double negative[2] = { 1, -3 };
    am_airlight other = lamp;
    double out[2] = { 77, 77 };
    REFUSED(other.light.kind = 9, "light.kind must be one of am_light_kind, got 9");
    REFUSED(other.phase.kind = 9, "phase.kind must be one of am_phase_kind, got 9");
    REFUSED(other.light.position[1] = INFINITY, "light.position must be finite");
    REFUSED((other.light.kind = AM_LIGHT_KIND_LOBES, other.light.exponent = 3),
            "light.exponent must be even and in [2, 1024], got 3");
    REFUSED((other.light.kind = AM_LIGHT_KIND_SPOT, other.light.exponent = 0),
            "light.exponent must be in [1, 1024], got 0");
    REFUSED(
        (other.light.kind = AM_LIGHT_KIND_SPOT, other.light.exponent = 2, other.light.axis[0] = 1),
        "light.axis must be a unit vector");
    REFUSED((other.light.kind = AM_LIGHT_KIND_CONE, other.light.cutoff_angle = 2),
            "light.cutoff_angle must be in (0, pi/2) radians, got 2");
    REFUSED((other.light.kind = AM_LIGHT_KIND_CONE, other.light.cutoff_angle = 1,
             other.light.beam_width = 1.25),
            "light.beam_width must be in [0, cutoff_angle], got 1.25");
    REFUSED((other.phase.kind = AM_PHASE_KIND_HENYEY_GREENSTEIN, other.phase.g = 1),
            "phase.g must be in (-1, 1), got 1");
    REFUSED(other.sigma_s = negative, "sigma_s must be finite and >= 0, got -3");
    REFUSED(other.sigma_t = negative, "sigma_t must be finite and >= 0, got -3");
    REFUSED(other.n_channels = 0, "n_channels must be >= 1, got 0");
    CHECK_FAILS(am_airlight_check(NULL), AM_STATUS_NULL_POINTER, "airlight must not be null");
    CHECK_FAILS(am_airlight_radiance_f64(&lamp, NULL, direction, t0, t1, out),
                AM_STATUS_NULL_POINTER, "origin must not be null");
    CHECK_FAILS(am_airlight_radiance_f64(&lamp, origin, direction, t0, t1, NULL),
                AM_STATUS_NULL_POINTER, "radiance must not be null");
    other.sigma_t = NULL;
    CHECK_FAILS(am_airlight_radiance_f64(&other, origin, direction, t0, t1, out),
                AM_STATUS_NULL_POINTER, "sigma_t must not be null");
    CHECK(out[0] == 77 && out[1] == 77);
}

int main(void) {
    forms();
    lights();
    phases();
    choices();
    own_phase();
    recorded();
    mistakes();
    return REPORT();
}
