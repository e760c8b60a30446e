/* Every recorded question on a host that computes at once: the answers of the scalar form.
 * Then on a host that fails at each operation in turn. */

#include "check.h"
#include "host.h"
#include "media.h"

static tape the_tape;

enum { MOST = 30 }; /* results of a question */

/* Slots of the arguments and of the models, new for each recording. */
typedef struct arguments {
    am_node origin[3], up[3], top[3], t, t_max, tau, column;
    am_profile_nodes profile, components[2];
    am_node sigma_t[4];
    am_medium_nodes medium;
    am_planet_nodes planet;
} arguments;

static const double origin[3] = { 0, 0, 0 }, up[3] = { 0, 0, 1 }, top[3] = { 0, 0, LENGTH };
static const am_planet planet = { { 0, 0, -10 }, 10 };
static const double t_max = 3, tau = 0.75, column = 0.75;

static am_planet_nodes put_planet(tape *t, const am_planet *planet) {
    am_planet_nodes nodes;
    int i;
    for (i = 0; i < 3; ++i)
        nodes.center[i] = put(t, planet->center[i]);
    nodes.radius = put(t, planet->radius);
    return nodes;
}

static am_profile_nodes put_profile(tape *t, const am_profile *profile) {
    am_profile_nodes nodes;
    int i;
    nodes.kind = profile->kind;
    for (i = 0; i < AM_PROFILE_VALUES; ++i)
        nodes.values[i] = put(t, profile->values[i]);
    return nodes;
}

static void put_arguments(arguments *a) {
    int i;
    for (i = 0; i < 3; ++i) {
        a->origin[i] = put(&the_tape, origin[i]);
        a->up[i] = put(&the_tape, up[i]);
        a->top[i] = put(&the_tape, top[i]);
    }
    a->t = put(&the_tape, LENGTH);
    a->t_max = put(&the_tape, t_max);
    a->tau = put(&the_tape, tau);
    a->column = put(&the_tape, column);
    a->profile = put_profile(&the_tape, &exponential);
    for (i = 0; i < 2; ++i)
        a->components[i] = put_profile(&the_tape, &profiles[i]);
    for (i = 0; i < 4; ++i)
        a->sigma_t[i] = put(&the_tape, sigma_t[i]);
    a->medium.profiles = a->components;
    a->medium.sigma_t = a->sigma_t;
    a->medium.n_components = 2;
    a->medium.n_channels = 2;
    a->planet = put_planet(&the_tape, &planet);
}

/* Records `call`, which writes `count` slots to `out`, and compares with `expected`. Then lets
 * each operation fail. */
#define RECORDS(call, count, expected)                                                             \
    do {                                                                                           \
        am_host_table table = host_on(&the_tape), *host = &table;                                  \
        arguments a;                                                                               \
        am_node out[MOST], first, last, fails_at;                                                  \
        int i_;                                                                                    \
        for (i_ = 0; i_ < MOST; ++i_)                                                              \
            out[i_] = 77;                                                                          \
        put_arguments(&a);                                                                         \
        first = the_tape.used;                                                                     \
        CHECK_OK(call);                                                                            \
        last = the_tape.used;                                                                      \
        for (i_ = 0; i_ < (count); ++i_)                                                           \
            CHECK_NEAR(the_tape.values[out[i_]], (expected)[i_], 1e-14);                           \
        for (; i_ < MOST; ++i_)                                                                       \
            CHECK(out[i_] == 77);                                                                  \
        for (fails_at = first + 1; fails_at <= last; ++fails_at) {                                 \
            for (i_ = 0; i_ < MOST; ++i_)                                                           \
                out[i_] = 77;                                                                      \
            the_tape.used = first;                                                                 \
            the_tape.fails_at = fails_at;                                                          \
            CHECK_FAILS(call, AM_STATUS_HOST_ERROR, "slot 0");                                     \
            for (i_ = 0; i_ < MOST; ++i_)                                                           \
                CHECK(out[i_] == 77);                                                              \
        }                                                                                          \
    } while (0)

static void profile_questions(void) {
    double e[MOST];
    CHECK_OK(am_profile_density_f64(&exponential, top, e));
    RECORDS(am_profile_density_record(host, &a.profile, a.top, out), 1, e);
    CHECK_OK(am_profile_column_f64(&exponential, origin, up, LENGTH, e));
    RECORDS(am_profile_column_record(host, &a.profile, a.origin, a.up, a.t, out), 1, e);
    CHECK_OK(am_profile_inv_column_f64(&exponential, origin, up, column, e));
    RECORDS(am_profile_inv_column_record(host, &a.profile, a.origin, a.up, a.column, out), 1, e);
    CHECK_OK(am_profile_inv_reached_column_f64(&exponential, origin, up, column, e));
    RECORDS(am_profile_inv_reached_column_record(host, &a.profile, a.origin, a.up, a.column, out),
            1, e);
    CHECK_OK(am_profile_column_value_and_gradient_f64(&exponential, origin, up, LENGTH, e));
    RECORDS(am_profile_column_value_and_gradient_record(host, &a.profile, a.origin, a.up, a.t, out),
            13, e);
    CHECK_OK(am_profile_inv_column_value_and_gradient_f64(&exponential, origin, up, column, e));
    RECORDS(am_profile_inv_column_value_and_gradient_record(host, &a.profile, a.origin, a.up,
                                                            a.column, out),
            13, e);
    CHECK_OK(am_profile_bounds_f64(&exponential, origin, up, LENGTH, e, e + 1));
    RECORDS(am_profile_bounds_record(host, &a.profile, a.origin, a.up, a.t, out, out + 1), 2, e);
    CHECK_OK(am_profile_bounds_in_box_f64(&exponential, origin, top, e, e + 1));
    RECORDS(am_profile_bounds_in_box_record(host, &a.profile, a.origin, a.top, out, out + 1), 2, e);
}

static void medium_questions(void) {
    double e[MOST];
    CHECK_OK(am_medium_extinction_f64(&medium, top, e));
    RECORDS(am_medium_extinction_record(host, &a.medium, a.top, out), 2, e);
    CHECK_OK(am_medium_optical_depth_f64(&medium, origin, up, LENGTH, e));
    RECORDS(am_medium_optical_depth_record(host, &a.medium, a.origin, a.up, a.t, out), 2, e);
    CHECK_OK(am_medium_optical_depth_value_and_gradient_f64(&medium, origin, up, LENGTH, e));
    RECORDS(am_medium_optical_depth_value_and_gradient_record(host, &a.medium, a.origin, a.up, a.t,
                                                              out),
            30, e);
    CHECK_OK(am_medium_transmittance_f64(&medium, origin, up, LENGTH, e));
    RECORDS(am_medium_transmittance_record(host, &a.medium, a.origin, a.up, a.t, out), 2, e);
    CHECK_OK(am_medium_opacity_f64(&medium, origin, up, LENGTH, e));
    RECORDS(am_medium_opacity_record(host, &a.medium, a.origin, a.up, a.t, out), 2, e);
    CHECK_OK(am_medium_bounds_f64(&medium, origin, up, LENGTH, e, e + 2));
    RECORDS(am_medium_bounds_record(host, &a.medium, a.origin, a.up, a.t, out, out + 2), 4, e);
    CHECK_OK(am_medium_bounds_in_box_f64(&medium, origin, top, e, e + 2));
    RECORDS(am_medium_bounds_in_box_record(host, &a.medium, a.origin, a.top, out, out + 2), 4, e);
    CHECK_OK(am_medium_pdf_f64(&medium, origin, up, LENGTH, e));
    RECORDS(am_medium_pdf_record(host, &a.medium, a.origin, a.up, a.t, out), 2, e);
    CHECK_OK(am_medium_pdf_within_f64(&medium, origin, up, t_max, LENGTH, e));
    RECORDS(am_medium_pdf_within_record(host, &a.medium, a.origin, a.up, a.t_max, a.t, out), 2, e);
    CHECK_OK(am_medium_free_flight_f64(&medium, 1, origin, up, t_max, tau, e));
    RECORDS(am_medium_free_flight_record(host, &a.medium, 1, a.origin, a.up, a.t_max, a.tau, out),
            1, e);
    CHECK_OK(am_medium_free_flight_value_and_gradient_f64(&medium, 1, origin, up, t_max, tau, e));
    RECORDS(am_medium_free_flight_value_and_gradient_record(host, &a.medium, 1, a.origin, a.up,
                                                            a.t_max, a.tau, out),
            15, e);
}

static void planet_questions(void) {
    double e[2];
    CHECK_OK(am_planet_altitude_f64(&planet, top, e));
    RECORDS(am_planet_altitude_record(host, &a.planet, a.top, out), 1, e);
    CHECK_OK(am_planet_horizon_f64(&planet, top, e));
    RECORDS(am_planet_horizon_record(host, &a.planet, a.top, out), 1, e);
    CHECK_OK(am_planet_hit_f64(&planet, top, up, e));
    RECORDS(am_planet_hit_record(host, &a.planet, a.top, a.up, out), 1, e);
    CHECK_OK(am_planet_shell_f64(&planet, top, up, t_max, e, e + 1));
    RECORDS(am_planet_shell_record(host, &a.planet, a.top, a.up, a.t_max, out, out + 1), 2, e);
}

static void mistakes(void) {
    am_host_table host = host_on(&the_tape);
    arguments a;
    am_node out = 77;
    put_arguments(&a);
    CHECK_FAILS(am_profile_density_record(NULL, &a.profile, a.top, &out), AM_STATUS_NULL_POINTER,
                "host must not be null");
    CHECK_FAILS(am_profile_density_record(&host, NULL, a.top, &out), AM_STATUS_NULL_POINTER,
                "profile must not be null");
    CHECK_FAILS(am_profile_density_record(&host, &a.profile, NULL, &out), AM_STATUS_NULL_POINTER,
                "point must not be null");
    CHECK_FAILS(am_profile_density_record(&host, &a.profile, a.top, NULL), AM_STATUS_NULL_POINTER,
                "density must not be null");
    CHECK_FAILS(
        am_medium_free_flight_record(&host, &a.medium, 2, a.origin, a.up, a.t_max, a.tau, &out),
        AM_STATUS_INVALID_ARGUMENT, "channel must be < 2, got 2");
    a.components[1].kind = 99;
    CHECK_FAILS(am_medium_extinction_record(&host, &a.medium, a.top, &out),
                AM_STATUS_INVALID_ARGUMENT, "got 99");
    CHECK(out == 77);
}

int main(void) {
    profile_questions();
    medium_questions();
    planet_questions();
    mistakes();
    return REPORT();
}
