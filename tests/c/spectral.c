/* Functions of spectra: every form has the values that follow from the equations by hand, and names
 * bad arguments. */

#include "check.h"
#include "host.h"

static tape the_tape;

enum { N = 2 };
static const double sigma_a[N] = { 0.25, 0 }, sigma_s[N] = { 0.5, 0.25 }, majorant = 1,
                    path_weights[N] = { 1, 3 };
static const float sigma_a_f32[N] = { 0.25f, 0 }, sigma_s_f32[N] = { 0.5f, 0.25f },
                   majorant_f32 = 1, path_weights_f32[N] = { 1, 3 };

/* Coefficients over the majorant are 1/4 and 0, 1/2 and 1/4, 1/4 and 3/4. Probabilities by rule;
 * absorption sampled, then weighted. */
static const double chances[3][2][3] = {
    { { 0.25 / 1.5, 0.5 / 1.5, 0.75 / 1.5 }, { 0, 0.5 / 1.25, 0.75 / 1.25 } },
    { { 0.25 / 2, 0.75 / 2, 0.5 }, { 0, 0.75 / 1.75, 1 / 1.75 } },
    { { 0.25 / 4, 1.25 / 4, 2.5 / 4 }, { 0, 1.25 / 3.75, 2.5 / 3.75 } },
};

static double share(int event, int i) {
    const double sigma[3] = { sigma_a[i], sigma_s[i], majorant - sigma_a[i] - sigma_s[i] };
    return sigma[event] / majorant;
}

static void check_events(const double *p, const double *w, const double *expected,
                         double tolerance) {
    int event, i;
    for (event = 0; event < 3; ++event) {
        CHECK_NEAR(p[event], expected[event], tolerance);
        for (i = 0; i < N; ++i)
            CHECK_NEAR(w[event * N + i],
                       expected[event] > 0 ? share(event, i) / expected[event] : 0, tolerance);
    }
}

static void check_events_f32(const float *p, const float *w, const double *expected) {
    double p64[3], w64[3 * N];
    int i;
    for (i = 0; i < 3; ++i)
        p64[i] = p[i];
    for (i = 0; i < 3 * N; ++i)
        w64[i] = w[i];
    check_events(p64, w64, expected, 5e-7);
}

static void put_spectrum(const double *from, am_node *to) {
    int i;
    for (i = 0; i < N; ++i)
        to[i] = put(&the_tape, from[i]);
}

static void null_collisions(void) {
    const am_array_f64 a = { sigma_a, 0 }, s = { sigma_s, 0 }, m = { &majorant, 0 },
                       w = { path_weights, 0 };
    const am_array_f32 a_f32 = { sigma_a_f32, 0 }, s_f32 = { sigma_s_f32, 0 },
                       m_f32 = { &majorant_f32, 0 }, w_f32 = { path_weights_f32, 0 };
    uint32_t rule, absorption;
    for (rule = AM_EVENT_RULE_MAXIMUM; rule <= AM_EVENT_RULE_HISTORY; ++rule)
        for (absorption = AM_ABSORPTION_SAMPLED; absorption <= AM_ABSORPTION_WEIGHTED;
             ++absorption) {
            const double *expected = chances[rule][absorption];
            double p[9], weights[9 * N];
            float p_f32[9], weights_f32[9 * N];
            am_host_table host = host_on(&the_tape);
            am_node an[N], sn[N], wn[N], pn[3], weights_n[3 * N];
            int i;
            CHECK_OK(am_null_collision_probabilities_f64(N, rule, absorption, sigma_a, sigma_s,
                                                         majorant, path_weights, p, weights));
            check_events(p, weights, expected, 1e-15);
            CHECK_OK(am_null_collision_probabilities_f32(N, rule, absorption, sigma_a_f32,
                                                         sigma_s_f32, majorant_f32,
                                                         path_weights_f32, p_f32, weights_f32));
            check_events_f32(p_f32, weights_f32, expected);
            CHECK_OK(am_null_collision_probabilities_batch_f64(3, N, rule, absorption, a, s, m, w,
                                                               p, weights));
            check_events(p + 6, weights + 6 * N, expected, 1e-15);
            CHECK_OK(am_null_collision_probabilities_batch_f32(3, N, rule, absorption, a_f32, s_f32,
                                                               m_f32, w_f32, p_f32, weights_f32));
            check_events_f32(p_f32 + 6, weights_f32 + 6 * N, expected);

            put_spectrum(sigma_a, an);
            put_spectrum(sigma_s, sn);
            put_spectrum(path_weights, wn);
            CHECK_OK(am_null_collision_probabilities_record(
                &host, N, rule, absorption, an, sn, put(&the_tape, majorant), wn, pn, weights_n));
            for (i = 0; i < 3; ++i)
                p[i] = the_tape.values[pn[i]];
            for (i = 0; i < 3 * N; ++i)
                weights[i] = the_tape.values[weights_n[i]];
            check_events(p, weights, expected, 1e-15);
        }
}

/* Optical depths of 1000 and 1000 + ln 2: densities of 2 to 1. */
static void mis(void) {
    static const double heroes[N] = { 0.25, 0.75 }, expected[N] = { 1.6, 0.8 };
    static const float logs_f32[N] = { -1000, -INFINITY }, heroes_f32[N] = { 0.25f, 0.75f };
    const double logs[N] = { -1000, -1000 - log(2) };
    const am_array_f64 l = { logs, 0 }, h = { heroes, 0 };
    const am_array_f32 l_f32 = { logs_f32, 0 }, h_f32 = { heroes_f32, 0 };
    am_host_table host = host_on(&the_tape);
    am_node ln[N], hn[N], wn[N];
    double w[3 * N];
    float w_f32[3 * N];
    int i;
    put_spectrum(logs, ln);
    put_spectrum(heroes, hn);
    CHECK_OK(am_spectral_mis_weights_record(&host, N, ln, hn, wn));
    CHECK_OK(am_spectral_mis_weights_f64(N, logs, heroes, w));
    for (i = 0; i < N; ++i) {
        CHECK_NEAR(w[i], expected[i], 1e-12);
        CHECK_NEAR(the_tape.values[wn[i]], expected[i], 1e-12);
    }
    CHECK_OK(am_spectral_mis_weights_batch_f64(3, N, l, h, w));
    CHECK_NEAR(w[2 * N], expected[0], 1e-12);
    CHECK_NEAR(w[2 * N + 1], expected[1], 1e-12);
    CHECK_OK(am_spectral_mis_weights_f32(N, logs_f32, heroes_f32, w_f32));
    CHECK(w_f32[0] == 4 && w_f32[1] == 0);
    CHECK_OK(am_spectral_mis_weights_batch_f32(3, N, l_f32, h_f32, w_f32));
    CHECK(w_f32[2 * N] == 4 && w_f32[2 * N + 1] == 0);
}

static void heroes(void) {
    const am_array_f64 w = { path_weights, 0 };
    const am_array_f32 w_f32 = { path_weights_f32, 0 };
    am_host_table host = host_on(&the_tape);
    am_node wn[N], qn[N];
    double q[3 * N];
    float q_f32[3 * N];
    put_spectrum(path_weights, wn);
    CHECK_OK(am_hero_probabilities_record(&host, N, wn, qn));
    CHECK_NEAR(the_tape.values[qn[0]], 0.25, 1e-15);
    CHECK_OK(am_hero_probabilities_f64(N, path_weights, q));
    CHECK_NEAR(q[1], 0.75, 1e-15);
    CHECK_OK(am_hero_probabilities_batch_f64(3, N, w, q));
    CHECK_NEAR(q[2 * N], 0.25, 1e-15);
    CHECK_OK(am_hero_probabilities_f32(N, path_weights_f32, q_f32));
    CHECK_NEAR(q_f32[1], 0.75, 1e-7);
    CHECK_OK(am_hero_probabilities_batch_f32(3, N, w_f32, q_f32));
    CHECK_NEAR(q_f32[2 * N], 0.25, 1e-7);
}

/* Calls that must fail: `R` and `A` are choices. */
#define EVENTS(n, R, A, a, s, m, w) am_null_collision_probabilities_f64(n, R, A, a, s, m, w, p, out)
#define BAD AM_STATUS_INVALID_ARGUMENT

static void mistakes(void) {
    static const double negative[N] = { 0.25, -1 }, endless[N] = { INFINITY, 1 },
                        many[3 * N] = { 0.5, 0.5, 0.5, 0.5, 0.5, 0.4 };
    const am_array_f64 some = { many, N }, all = { sigma_a, 0 }, none = { NULL, N },
                       narrow = { many, 1 };
    double p[3] = { 77, 77, 77 }, out[3 * N] = { 77, 77, 77, 77, 77, 77 };
    const double *a = sigma_a, *s = sigma_s, *w = path_weights;
    CHECK_FAILS(EVENTS(N, 3, 0, a, s, 1, w), BAD, "rule must be one of am_event_rule, got 3");
    CHECK_FAILS(EVENTS(N, 0, 2, a, s, 1, w), BAD, "absorption must be one of am_absorption, got 2");
    CHECK_FAILS(EVENTS(0, 0, 0, a, s, 1, w), BAD, "n_wavelengths must be >= 1, got 0");
    CHECK_FAILS(EVENTS(N, 0, 0, negative, s, 1, w), BAD,
                "sigma_a must be finite and >= 0, got -1.0 (wavelength 1)");
    CHECK_FAILS(EVENTS(N, 0, 0, a, endless, 1, w), BAD, "sigma_s must be finite and >= 0, got inf");
    CHECK_FAILS(EVENTS(N, 0, 0, a, s, -2, w), BAD, "majorant must be finite and >= 0, got -2.0");
    CHECK_FAILS(EVENTS(N, 0, 0, a, s, 1, endless), BAD, "path_weights must be finite, got inf");
    CHECK_FAILS(EVENTS(N, 0, 0, NULL, s, 1, w), AM_STATUS_NULL_POINTER, "sigma_a");
    CHECK_FAILS(am_null_collision_probabilities_f64(N, 0, 0, a, s, 1, w, NULL, out),
                AM_STATUS_NULL_POINTER, "probabilities");
    CHECK_FAILS(am_null_collision_probabilities_f64(N, 0, 0, a, s, 1, w, p, NULL),
                AM_STATUS_NULL_POINTER, "weights");
    CHECK_FAILS(am_spectral_mis_weights_f64(N, endless, many, out), BAD,
                "log_densities must be a number < inf, got inf (wavelength 0)");
    CHECK_FAILS(am_spectral_mis_weights_f64(N, a, endless, out), BAD,
                "hero_probabilities must be in [0, 1], got inf (wavelength 0)");
    CHECK_FAILS(am_spectral_mis_weights_f64(N, a, sigma_s, out), BAD,
                "hero_probabilities must have the sum 1, got 0.75");
    CHECK_FAILS(am_spectral_mis_weights_batch_f64(3, N, all, some, out), BAD,
                "hero_probabilities must have the sum 1, got 0.9 at item 2");
    CHECK_FAILS(am_spectral_mis_weights_batch_f64(3, N, none, some, out), AM_STATUS_NULL_POINTER,
                "log_densities.data");
    CHECK_FAILS(am_spectral_mis_weights_batch_f64(3, N, narrow, some, out), BAD,
                "log_densities.stride must be 0 or >= 2, got 1");
    CHECK_FAILS(am_hero_probabilities_f64(N, endless, out), BAD, "path_weights must be finite");
    CHECK(p[0] == 77 && p[2] == 77 && out[0] == 77 && out[3 * N - 1] == 77);
    CHECK_OK(am_spectral_mis_weights_batch_f64(0, N, none, none, NULL));
}

/* Each operation of a recording fails in turn. */
static void failing_hosts(void) {
    am_host_table host = host_on(&the_tape);
    am_node a[N], s[N], w[N], m = put(&the_tape, majorant), p[3] = { 77, 77, 77 }, out[3 * N];
    am_node first, last;
    int i;
    put_spectrum(sigma_a, a);
    put_spectrum(sigma_s, s);
    put_spectrum(path_weights, w);
    first = the_tape.used;
    CHECK_OK(am_null_collision_probabilities_record(&host, N, 2, 0, a, s, m, w, p, out));
    last = the_tape.used;
    for (the_tape.fails_at = first + 1; the_tape.fails_at <= last; ++the_tape.fails_at) {
        p[0] = p[2] = 77;
        for (i = 0; i < 3 * N; ++i)
            out[i] = 77;
        the_tape.used = first;
        CHECK_FAILS(am_null_collision_probabilities_record(&host, N, 2, 0, a, s, m, w, p, out),
                    AM_STATUS_HOST_ERROR, "slot 0");
        CHECK(p[0] == 77 && p[2] == 77 && out[0] == 77 && out[3 * N - 1] == 77);
    }
    the_tape.fails_at = 0;
    CHECK_FAILS(am_null_collision_probabilities_record(&host, N, 3, 0, a, s, m, w, p, out), BAD,
                "rule");
    CHECK_FAILS(am_spectral_mis_weights_record(NULL, N, a, s, out), AM_STATUS_NULL_POINTER, "host");
}

int main(void) {
    null_collisions();
    mis();
    heroes();
    mistakes();
    failing_hosts();
    return REPORT();
}
