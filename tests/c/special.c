/* Special functions: every form has the known value, and names bad arguments. */

#include "functions.h"

static const double z = 795, surface = 790, cosine = 0.3, down = -0.3, x = 1.5;

/* Values of the reference tables' definitions, to 17 digits. */
#define CHAPMAN 3.292604737667649
#define CHAPMAN_DOWN 5.5257244536609069e17
#define K1 35.354787400043253
#define ERFCX 0.3215854164543175
#define EI_RE (-0.04270549007307789)
#define EI_IM 3.0585303212434343
#define EI_SCALED_RE (-0.39378646478378809)
#define EI_SCALED_IM (-0.14191746503414099)
#define E1 0.10001958240663265

static void accurate(void) {
    TWO(chapman, CHAPMAN, 0, z, cosine);
    TWO(chapman_upper, CHAPMAN, 0, z, cosine);
    TWO(chapman_lower, CHAPMAN_DOWN, 0, z, down);
    TWO(log_chapman, log(CHAPMAN), 0, z, cosine);
    THREE(chapman_rescaled, exp(surface - z) * CHAPMAN, 0, z, surface, cosine);
    THREE(log_chapman_rescaled, surface - z + log(CHAPMAN), 0, z, surface, cosine);
    ONE(bessel_k1_scaled, K1, 0, z);
    ONE(erfcx, ERFCX, 0, x);
}

/* All forms of a function of x + i y whose value is complex. */
#define COMPLEX(name, re, im)                                                                      \
    do {                                                                                           \
        static const double left = -1.5, up = 0.75;                                                \
        static const float left_f32 = -1.5f, up_f32 = 0.75f;                                       \
        const am_array_f64 xs = { &left, 0 }, ys = { &up, 0 };                                     \
        const am_array_f32 xs_f32 = { &left_f32, 0 }, ys_f32 = { &up_f32, 0 };                     \
        const double expected[2] = { re, im };                                                     \
        double a[2], many[6];                                                                      \
        float b[2], many_f32[6];                                                                   \
        am_host_table host = host_on(&the_tape);                                                   \
        am_node out[2];                                                                            \
        int i;                                                                                     \
        CHECK_OK(am_##name##_f64(left, up, a));                                                    \
        CHECK_OK(am_##name##_f32(left_f32, up_f32, b));                                            \
        CHECK_OK(am_##name##_batch_f64(3, xs, ys, many));                                          \
        CHECK_OK(am_##name##_batch_f32(3, xs_f32, ys_f32, many_f32));                              \
        CHECK_OK(am_##name##_record(&host, SLOT(left), SLOT(up), out));                            \
        for (i = 0; i < 2; ++i) {                                                                  \
            CHECK_NEAR(a[i], expected[i], 1e-13);                                                  \
            CHECK_NEAR(b[i], expected[i], 2e-6);                                                   \
            CHECK_NEAR(many[4 + i], expected[i], 1e-13);                                           \
            CHECK_NEAR(many_f32[4 + i], expected[i], 2e-6);                                        \
            CHECK_NEAR(the_tape.values[out[i]], expected[i], 1e-13);                               \
        }                                                                                          \
    } while (0)

/* Values of their definition, to 17 digits. */
static void exponential_integrals(void) {
    COMPLEX(expint_ei, EI_RE, EI_IM);
    COMPLEX(expint_ei_scaled, EI_SCALED_RE, EI_SCALED_IM);
    ONE(expint_e1, E1, 1e-13, x);
    ONE(expint_e1_scaled, exp(x) * E1, 1e-13, x);
}

/* Within the errors of their documentation. */
static void approximations(void) {
    TWO(chapman_huestis, CHAPMAN, 1.2e-6, z, cosine);
    TWO(chapman_schueler, CHAPMAN, 0.15, z, cosine);
    TWO(chapman_kocifaj, CHAPMAN, 3.5e-3, z, cosine);
    ONE(chapman_horizontal_huestis, K1, 2.1e-10, z);
    ONE(erfcx_golubev, ERFCX, 1.6e-6, x);
    ONE(erfcx_ren_mackenzie, ERFCX, 3.4e-3, x);
}

static void mistakes(void) {
    static const double cosines[3] = { 0.5, -0.5, 1.5 };
    static const am_array_f64 some = { cosines, 1 }, all = { &z, 0 }, none = { NULL, 1 };
    double out[3] = { 77, 77, 77 };
    CHECK_FAILS(am_chapman_f64(-1, cosine, out), AM_STATUS_INVALID_ARGUMENT,
                "z must be finite and >= 0, got -1");
    CHECK_FAILS(am_chapman_f32(1, 1.5f, (float *) out), AM_STATUS_INVALID_ARGUMENT,
                "cos_zenith must be in [-1, 1], got 1.5");
    CHECK_FAILS(am_chapman_f64(1, NAN, out), AM_STATUS_INVALID_ARGUMENT, "cos_zenith");
    CHECK_FAILS(am_chapman_upper_f64(1, down, out), AM_STATUS_INVALID_ARGUMENT, "[0, 1]");
    CHECK_FAILS(am_chapman_lower_f64(1, cosine, out), AM_STATUS_INVALID_ARGUMENT, "[-1, 0]");
    CHECK_FAILS(am_chapman_huestis_f64(0, cosine, out), AM_STATUS_INVALID_ARGUMENT, "> 0");
    CHECK_FAILS(am_chapman_batch_f64(3, all, some, out), AM_STATUS_INVALID_ARGUMENT,
                "cos_zenith must be in [-1, 1], got 1.5 at item 2");
    CHECK_FAILS(am_chapman_batch_f64(3, none, all, out), AM_STATUS_NULL_POINTER, "z.data");
    CHECK_FAILS(am_expint_e1_f64(0, out), AM_STATUS_INVALID_ARGUMENT,
                "x must be finite and > 0, got 0");
    CHECK_FAILS(am_expint_ei_f64(1, INFINITY, out), AM_STATUS_INVALID_ARGUMENT, "y must be finite");
    CHECK_FAILS(am_erfcx_f64(x, NULL), AM_STATUS_NULL_POINTER, "value");
    CHECK(out[0] == 77 && out[1] == 77 && out[2] == 77);
    CHECK_OK(am_chapman_batch_f64(0, none, none, NULL));
}

/* Each operation of a recording fails in turn. */
static void failing_hosts(void) {
    am_host_table host = host_on(&the_tape);
    const am_node p = SLOT(z), q = SLOT(cosine), first = the_tape.used;
    am_node out = 77, last;
    CHECK_OK(am_chapman_record(&host, p, q, &out));
    last = the_tape.used;
    out = 77;
    for (the_tape.fails_at = first + 1; the_tape.fails_at <= last; ++the_tape.fails_at) {
        the_tape.used = first;
        CHECK_FAILS(am_chapman_record(&host, p, q, &out), AM_STATUS_HOST_ERROR, "slot 0");
        CHECK(out == 77);
    }
    CHECK_FAILS(am_chapman_record(NULL, p, q, &out), AM_STATUS_NULL_POINTER, "host");
}

int main(void) {
    accurate();
    exponential_integrals();
    approximations();
    mistakes();
    failing_hosts();
    return REPORT();
}
