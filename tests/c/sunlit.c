/* Fog in the sun: every form has the known answer and the same. */

#include "check.h"
#include "host.h"
#include "media.h"

enum { N = 11, CHANNELS = 2 }; /* no multiple of the number of lanes */
#define UNTOUCHED (-77)

/* A horizontal, endless ray from the base of the layers, with the sun in the zenith: the light
 * that arrives is exp(-sigma_t H), and sigma_s/sigma_t of it is scattered. */
static const double sigma_s[CHANNELS] = { 0.25, 0.125 }, fog_sigma_t[CHANNELS] = { 0.5, 1 };
static const am_sunlit_fog fog = {
    { 2, { 0, 0, 1, 0, SCALE_HEIGHT } }, sigma_s, fog_sigma_t, CHANNELS
};
static const double origin[3] = { 0, 0, 0 }, aside[3] = { 1, 0, 0 }, up[3] = { 0, 0, 1 };
static const float origin_f32[3] = { 0, 0, 0 }, aside_f32[3] = { 1, 0, 0 }, up_f32[3] = { 0, 0, 1 };
static const double t = INFINITY, phase = 0.5;
static const float t_f32 = INFINITY, phase_f32 = 0.5f;
static const double expected[CHANNELS] = { 0.25 * 0.36787944117144233,
                                           0.0625 * 0.1353352832366127 };

static tape the_tape;

static void numbers(void) {
    const am_array_f64 o = { origin, 0 }, d = { aside, 0 }, s = { up, 0 }, ts = { &t, 0 },
                       p = { &phase, 0 };
    const am_array_f32 o_f32 = { origin_f32, 0 }, d_f32 = { aside_f32, 0 }, s_f32 = { up_f32, 0 },
                       ts_f32 = { &t_f32, 0 }, p_f32 = { &phase_f32, 0 };
    double a[N * CHANNELS];
    float b[N * CHANNELS];
    int i;
    CHECK_OK(am_sunlit_fog_radiance_f64(&fog, origin, aside, t, up, phase, a));
    CHECK_OK(am_sunlit_fog_radiance_f32(&fog, origin_f32, aside_f32, t_f32, up_f32, phase_f32, b));
    for (i = 0; i < CHANNELS; ++i) {
        CHECK_NEAR(a[i], expected[i], 1e-15);
        CHECK_NEAR(b[i], expected[i], 1e-6);
    }
    CHECK_OK(am_sunlit_fog_radiance_batch_f64(&fog, N, o, d, ts, s, p, a));
    CHECK_OK(am_sunlit_fog_radiance_batch_f32(&fog, N, o_f32, d_f32, ts_f32, s_f32, p_f32, b));
    for (i = 0; i < N * CHANNELS; ++i) {
        CHECK_NEAR(a[i], expected[i % CHANNELS], 1e-15);
        CHECK_NEAR(b[i], expected[i % CHANNELS], 1e-6);
    }
}

/* A box without extinction is as bright as it is deep; one with it, seen along the way of the
 * light, as if all of it came from where it enters. */
static void in_a_box(void) {
    static const double clear[1] = { 0 }, scattering[1] = { 0.25 }, dense[1] = { 0.5 };
    static const double low[3] = { -1, -1, -1 }, high[3] = { 1, 1, 3 }, ahead = 2;
    static const float low_f32[3] = { -1, -1, -1 }, high_f32[3] = { 1, 1, 3 };
    am_sunlit_fog box = { { 0, { 0 } }, scattering, clear, 1 };
    const am_array_f64 o = { origin, 0 }, u = { up, 0 }, ts = { &ahead, 0 }, p = { &phase, 0 },
                       lows = { low, 0 }, highs = { high, 0 };
    const am_array_f32 o_f32 = { origin_f32, 0 }, u_f32 = { up_f32, 0 }, p_f32 = { &phase_f32, 0 },
                       lows_f32 = { low_f32, 0 }, highs_f32 = { high_f32, 0 };
    static const float ahead_f32 = 2;
    const am_array_f32 ts_f32 = { &ahead_f32, 0 };
    double a[N];
    float b[N];
    int i;
    CHECK_OK(am_sunlit_fog_radiance_in_box_f64(&box, origin, up, ahead, up, phase, low, high, a));
    CHECK_NEAR(a[0], 0.25 * 0.5 * 2, 1e-15);
    box.sigma_t = dense;
    CHECK_OK(am_sunlit_fog_radiance_in_box_batch_f64(&box, N, o, u, ts, u, p, lows, highs, a));
    CHECK_OK(am_sunlit_fog_radiance_in_box_f32(&box, origin_f32, up_f32, ahead_f32, up_f32,
                                               phase_f32, low_f32, high_f32, b));
    CHECK_NEAR(b[0], 0.25 * 0.5 * 2 * 0.22313016014842982, 1e-6);
    CHECK_OK(am_sunlit_fog_radiance_in_box_batch_f32(&box, N, o_f32, u_f32, ts_f32, u_f32, p_f32,
                                                     lows_f32, highs_f32, b));
    for (i = 0; i < N; ++i) {
        CHECK_NEAR(a[i], 0.25 * 0.5 * 2 * 0.22313016014842982, 1e-14);
        CHECK_NEAR(b[i], 0.25 * 0.5 * 2 * 0.22313016014842982, 1e-6);
    }
    CHECK_FAILS(am_sunlit_fog_radiance_in_box_f64(&fog, origin, up, ahead, up, phase, low, high, a),
                AM_STATUS_INVALID_ARGUMENT,
                "profile must be constant in a box, got \"exponential\"");
}

/* The same on a tape; then on a host that fails at each operation in turn. */
static am_status record(const am_host_table *host, am_node *radiance) {
    am_node o[3], d[3], s[3], scattering[CHANNELS], attenuation[CHANNELS];
    am_sunlit_fog_nodes nodes;
    int i;
    for (i = 0; i < 3; ++i) {
        o[i] = put(&the_tape, origin[i]);
        d[i] = put(&the_tape, aside[i]);
        s[i] = put(&the_tape, up[i]);
    }
    for (i = 0; i < CHANNELS; ++i) {
        scattering[i] = put(&the_tape, sigma_s[i]);
        attenuation[i] = put(&the_tape, fog_sigma_t[i]);
    }
    nodes.profile.kind = fog.profile.kind;
    for (i = 0; i < AM_PROFILE_VALUES; ++i)
        nodes.profile.values[i] = put(&the_tape, fog.profile.values[i]);
    nodes.sigma_s = scattering;
    nodes.sigma_t = attenuation;
    nodes.n_channels = CHANNELS;
    return am_sunlit_fog_radiance_record(host, &nodes, o, d, put(&the_tape, t), s,
                                         put(&the_tape, phase), radiance);
}

static void recorded(void) {
    am_host_table host = host_on(&the_tape);
    am_node radiance[CHANNELS] = { UNTOUCHED, UNTOUCHED }, first, used, i;
    CHECK_OK(record(&host, radiance));
    for (i = 0; i < CHANNELS; ++i)
        CHECK_NEAR(the_tape.values[radiance[i]], expected[i], 1e-15);
    used = the_tape.used;
    first = 3 * 3 + 2 * CHANNELS + AM_PROFILE_VALUES + 3;
    for (i = first; i <= used; ++i) {
        host = host_on(&the_tape);
        the_tape.fails_at = i;
        radiance[0] = radiance[1] = UNTOUCHED;
        CHECK(record(&host, radiance) == AM_STATUS_HOST_ERROR);
        CHECK(radiance[0] == (am_node) UNTOUCHED && radiance[1] == (am_node) UNTOUCHED);
    }
}

#define BAD AM_STATUS_INVALID_ARGUMENT
#define RADIANCE(fog, o, d, s, out) am_sunlit_fog_radiance_f64(fog, o, d, t, s, phase, out)

static void mistakes(void) {
    static const double negative[CHANNELS] = { 0.25, -1 };
    am_sunlit_fog other = fog;
    double out = UNTOUCHED;
    CHECK_OK(am_sunlit_fog_check(&fog));
    CHECK_FAILS(am_sunlit_fog_check(NULL), AM_STATUS_NULL_POINTER, "fog");
    other.profile.values[4] = -3;
    CHECK_FAILS(am_sunlit_fog_check(&other), BAD, "scale_height must be finite and > 0, got -3");
    other = fog;
    other.sigma_s = negative;
    CHECK_FAILS(am_sunlit_fog_check(&other), BAD, "sigma_s must be finite and >= 0, got -1");
    other = fog;
    other.sigma_t = NULL;
    CHECK_FAILS(RADIANCE(&other, origin, aside, up, &out), AM_STATUS_NULL_POINTER, "sigma_t");
    other = fog;
    other.n_channels = 0;
    CHECK_FAILS(RADIANCE(&other, origin, aside, up, &out), BAD, "n_channels must be >= 1, got 0");
    other = fog;
    other.profile = linear;
    CHECK_FAILS(RADIANCE(&other, origin, aside, up, &out), BAD,
                "profile must be constant or exponential, got \"linear\"");
    other.profile.kind = 99;
    CHECK_FAILS(RADIANCE(&other, origin, aside, up, &out), BAD, "kind must be one of");
    CHECK_FAILS(RADIANCE(NULL, origin, aside, up, &out), AM_STATUS_NULL_POINTER, "fog");
    CHECK_FAILS(RADIANCE(&fog, NULL, aside, up, &out), AM_STATUS_NULL_POINTER, "origin");
    CHECK_FAILS(RADIANCE(&fog, origin, NULL, up, &out), AM_STATUS_NULL_POINTER, "direction");
    CHECK_FAILS(RADIANCE(&fog, origin, aside, NULL, &out), AM_STATUS_NULL_POINTER, "sun_direction");
    CHECK_FAILS(RADIANCE(&fog, origin, aside, up, NULL), AM_STATUS_NULL_POINTER, "radiance");
    CHECK(out == UNTOUCHED);
}

int main(void) {
    /* The medium of media.h is for other programs. */
    (void) medium;
    (void) constant;
    (void) exponential;
    numbers();
    in_a_box();
    recorded();
    mistakes();
    return REPORT();
}
