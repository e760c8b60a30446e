/* Every question in its scalar and its batched form, in the precision NUMBER.
 *
 * Included once per precision. Each function asks for known answers, then makes each mistake
 * that the form allows and checks that the outputs stay as they were. */

#define CAT_(a, b, c) a##b##c
#define CAT(a, b, c) CAT_(a, b, c)
#define ASK(name) CAT(am_, name, SUFFIX)
#define ASK_BATCH(name) CAT(am_, name, CAT(_batch, SUFFIX, ))
#define TEST(name) CAT(test_, name, SUFFIX)

#ifndef QUESTIONS_H
#define QUESTIONS_H
enum { N = 11, CHANNELS = 2 }; /* no multiple of the number of lanes */
#define UNTOUCHED (-77)
#endif

static const NUMBER CAT(origin, SUFFIX, )[3] = { 0, 0, 0 };
static const NUMBER CAT(up, SUFFIX, )[3] = { 0, 0, 1 };
static const NUMBER CAT(top, SUFFIX, )[3] = { 0, 0, (NUMBER) LENGTH };
static const NUMBER CAT(t, SUFFIX, )[1] = { (NUMBER) LENGTH };
#define O CAT(origin, SUFFIX, )
#define UP CAT(up, SUFFIX, )
#define TOP CAT(top, SUFFIX, )

static void CAT(reset, SUFFIX, )(NUMBER *out) {
    int i;
    for (i = 0; i < N * CHANNELS; ++i)
        out[i] = UNTOUCHED;
}
#define RESET(out) CAT(reset, SUFFIX, )(out)

static void CAT(check_untouched, SUFFIX, )(const NUMBER *out) {
    int i;
    for (i = 0; i < N * CHANNELS; ++i)
        CHECK(out[i] == UNTOUCHED);
}
#define CHECK_UNTOUCHED(out) CAT(check_untouched, SUFFIX, )(out)

/* `items` times the results `expected[0..width]`. */
static void CAT(check_items, SUFFIX, )(const NUMBER *out, int items, int width,
                                       const double *expected) {
    int i;
    for (i = 0; i < items * width; ++i)
        CHECK_NEAR(out[i], expected[i % width], TOLERANCE);
    for (; i < N * CHANNELS; ++i)
        CHECK(out[i] == UNTOUCHED);
}
#define CHECK_ITEMS(out, items, width, expected)                                                   \
    CAT(check_items, SUFFIX, )(out, items, width, expected)

/* An array of N points or numbers, `stride` numbers apart. */
static ARRAY CAT(array, SUFFIX, )(NUMBER *memory, const NUMBER *item, int size, int stride) {
    ARRAY a;
    int i;
    for (i = 0; i < N * size; ++i)
        memory[i / size * stride + i % size] = item[i % size];
    a.data = memory;
    a.stride = (size_t) stride;
    return a;
}
#define SPREAD(memory, item, size, stride) CAT(array, SUFFIX, )(memory, item, size, stride)

static ARRAY CAT(one, SUFFIX, )(const NUMBER *item) {
    ARRAY a;
    a.data = item;
    a.stride = 0;
    return a;
}
#define ONE(item) CAT(one, SUFFIX, )(item)

static ARRAY CAT(none, SUFFIX, )(void) {
    ARRAY a;
    a.data = NULL;
    a.stride = 0;
    return a;
}
#define NONE CAT(none, SUFFIX, )()

static ARRAY CAT(narrow, SUFFIX, )(const NUMBER *item) {
    ARRAY a;
    a.data = item;
    a.stride = 2;
    return a;
}
#define NARROW CAT(narrow, SUFFIX, )(O)

#define NULL_ERROR(call, name) CHECK_FAILS(call, AM_STATUS_NULL_POINTER, name " must not be null")
#define NULL_DATA(call, name)                                                                      \
    CHECK_FAILS(call, AM_STATUS_NULL_POINTER, name ".data must not be null")
#define STRIDE_ERROR(call, name)                                                                   \
    CHECK_FAILS(call, AM_STATUS_INVALID_ARGUMENT, name ".stride must be 0 or >= 3, got 2")

/* Questions at a point. */
#define AT_POINT(question, MODEL, model, out_name)                                                 \
    static void TEST(question)(const MODEL *m, int width, const double *expected) {                \
        NUMBER out[N * CHANNELS], memory[N * 4];                                                   \
        RESET(out);                                                                                \
        CHECK_OK(ASK(question)(m, TOP, out));                                                      \
        CHECK_ITEMS(out, 1, width, expected);                                                      \
        CHECK_OK(ASK_BATCH(question)(m, N, SPREAD(memory, TOP, 3, 4), out));                       \
        CHECK_ITEMS(out, N, width, expected);                                                      \
        RESET(out);                                                                                \
        NULL_ERROR(ASK(question)(NULL, TOP, out), model);                                          \
        NULL_ERROR(ASK(question)(m, NULL, out), "point");                                          \
        NULL_ERROR(ASK(question)(m, TOP, NULL), out_name);                                         \
        NULL_ERROR(ASK_BATCH(question)(NULL, N, ONE(TOP), out), model);                            \
        NULL_DATA(ASK_BATCH(question)(m, N, NONE, out), "point");                                  \
        STRIDE_ERROR(ASK_BATCH(question)(m, N, NARROW, out), "point");                             \
        NULL_ERROR(ASK_BATCH(question)(m, N, ONE(TOP), NULL), out_name);                           \
        CHECK_OK(ASK_BATCH(question)(m, 0, NONE, NULL));                                           \
        CHECK_UNTOUCHED(out);                                                                      \
    }

/* Questions along a ray, with one number. */
#define ALONG(question, MODEL, model, number_name, out_name)                                       \
    static void TEST(question)(const MODEL *m, NUMBER x, int width, const double *expected) {      \
        NUMBER out[N * CHANNELS], origins[N * 3], directions[N * 5], numbers[N * 2];               \
        RESET(out);                                                                                \
        CHECK_OK(ASK(question)(m, O, UP, x, out));                                                 \
        CHECK_ITEMS(out, 1, width, expected);                                                      \
        CHECK_OK(ASK_BATCH(question)(m, N, SPREAD(origins, O, 3, 3), SPREAD(directions, UP, 3, 5), \
                                     SPREAD(numbers, &x, 1, 2), out));                             \
        CHECK_ITEMS(out, N, width, expected);                                                      \
        RESET(out);                                                                                \
        NULL_ERROR(ASK(question)(NULL, O, UP, x, out), model);                                     \
        NULL_ERROR(ASK(question)(m, NULL, UP, x, out), "origin");                                  \
        NULL_ERROR(ASK(question)(m, O, NULL, x, out), "direction");                                \
        NULL_ERROR(ASK(question)(m, O, UP, x, NULL), out_name);                                    \
        NULL_ERROR(ASK_BATCH(question)(NULL, N, ONE(O), ONE(UP), ONE(&x), out), model);            \
        NULL_DATA(ASK_BATCH(question)(m, N, NONE, ONE(UP), ONE(&x), out), "origin");               \
        NULL_DATA(ASK_BATCH(question)(m, N, ONE(O), NONE, ONE(&x), out), "direction");             \
        NULL_DATA(ASK_BATCH(question)(m, N, ONE(O), ONE(UP), NONE, out), number_name);             \
        NULL_ERROR(ASK_BATCH(question)(m, N, ONE(O), ONE(UP), ONE(&x), NULL), out_name);           \
        STRIDE_ERROR(ASK_BATCH(question)(m, N, NARROW, ONE(UP), ONE(&x), out), "origin");          \
        STRIDE_ERROR(ASK_BATCH(question)(m, N, ONE(O), NARROW, ONE(&x), out), "direction");        \
        CHECK_OK(ASK_BATCH(question)(m, 0, NONE, NONE, NONE, NULL));                               \
        CHECK_UNTOUCHED(out);                                                                      \
    }

/* Bounds on the segment from O to TOP, and in the box between them. */
#define BOUNDS(question, MODEL, model, low_name, high_name)                                        \
    static void TEST(question)(const MODEL *m, int width, const double *low, const double *high) { \
        NUMBER inf[N * CHANNELS], sup[N * CHANNELS];                                               \
        const NUMBER *x = CAT(t, SUFFIX, );                                                        \
        RESET(inf);                                                                                \
        RESET(sup);                                                                                \
        CHECK_OK(ASK(question)(m, O, UP, *x, inf, sup));                                           \
        CHECK_ITEMS(inf, 1, width, low);                                                           \
        CHECK_ITEMS(sup, 1, width, high);                                                          \
        CHECK_OK(ASK_BATCH(question)(m, N, ONE(O), ONE(UP), ONE(x), inf, sup));                    \
        CHECK_ITEMS(inf, N, width, low);                                                           \
        CHECK_ITEMS(sup, N, width, high);                                                          \
        RESET(inf);                                                                                \
        RESET(sup);                                                                                \
        CHECK_OK(ASK(CAT(question, _in_box, ))(m, O, TOP, inf, sup));                              \
        CHECK_ITEMS(inf, 1, width, low);                                                           \
        CHECK_ITEMS(sup, 1, width, high);                                                          \
        CHECK_OK(ASK_BATCH(CAT(question, _in_box, ))(m, N, ONE(O), ONE(TOP), inf, sup));           \
        CHECK_ITEMS(inf, N, width, low);                                                           \
        CHECK_ITEMS(sup, N, width, high);                                                          \
        RESET(inf);                                                                                \
        RESET(sup);                                                                                \
        NULL_ERROR(ASK(question)(NULL, O, UP, *x, inf, sup), model);                               \
        NULL_ERROR(ASK(question)(m, NULL, UP, *x, inf, sup), "origin");                            \
        NULL_ERROR(ASK(question)(m, O, NULL, *x, inf, sup), "direction");                          \
        NULL_ERROR(ASK(question)(m, O, UP, *x, NULL, sup), low_name);                              \
        NULL_ERROR(ASK(question)(m, O, UP, *x, inf, NULL), high_name);                             \
        NULL_ERROR(ASK_BATCH(question)(NULL, N, ONE(O), ONE(UP), ONE(x), inf, sup), model);        \
        NULL_DATA(ASK_BATCH(question)(m, N, NONE, ONE(UP), ONE(x), inf, sup), "origin");           \
        NULL_DATA(ASK_BATCH(question)(m, N, ONE(O), NONE, ONE(x), inf, sup), "direction");         \
        NULL_DATA(ASK_BATCH(question)(m, N, ONE(O), ONE(UP), NONE, inf, sup), "t");                \
        NULL_ERROR(ASK_BATCH(question)(m, N, ONE(O), ONE(UP), ONE(x), NULL, sup), low_name);       \
        NULL_ERROR(ASK_BATCH(question)(m, N, ONE(O), ONE(UP), ONE(x), inf, NULL), high_name);      \
        CHECK_OK(ASK_BATCH(question)(m, 0, NONE, NONE, NONE, NULL, NULL));                         \
        NULL_ERROR(ASK(CAT(question, _in_box, ))(NULL, O, TOP, inf, sup), model);                  \
        NULL_ERROR(ASK(CAT(question, _in_box, ))(m, NULL, TOP, inf, sup), "lo");                   \
        NULL_ERROR(ASK(CAT(question, _in_box, ))(m, O, NULL, inf, sup), "hi");                     \
        NULL_ERROR(ASK(CAT(question, _in_box, ))(m, O, TOP, NULL, sup), low_name);                 \
        NULL_ERROR(ASK(CAT(question, _in_box, ))(m, O, TOP, inf, NULL), high_name);                \
        STRIDE_ERROR(ASK_BATCH(CAT(question, _in_box, ))(m, N, ONE(O), NARROW, inf, sup), "hi");   \
        CHECK_OK(ASK_BATCH(CAT(question, _in_box, ))(m, 0, NONE, NONE, NULL, NULL));               \
        CHECK_UNTOUCHED(inf);                                                                      \
        CHECK_UNTOUCHED(sup);                                                                      \
    }

AT_POINT(profile_density, am_profile, "profile", "density")
ALONG(profile_column, am_profile, "profile", "t", "column")
ALONG(profile_inv_column, am_profile, "profile", "column", "t")
ALONG(profile_inv_reached_column, am_profile, "profile", "column", "t")
BOUNDS(profile_bounds, am_profile, "profile", "inf", "sup")
AT_POINT(medium_extinction, am_medium, "medium", "extinction")
ALONG(medium_optical_depth, am_medium, "medium", "t", "optical_depth")
ALONG(medium_transmittance, am_medium, "medium", "t", "transmittance")
ALONG(medium_opacity, am_medium, "medium", "t", "opacity")
ALONG(medium_pdf, am_medium, "medium", "t", "pdf")
BOUNDS(medium_bounds, am_medium, "medium", "minorant", "majorant")

static void TEST(medium_free_flight)(size_t channel, double tau_, double expected) {
    NUMBER out[N * CHANNELS], endless = (NUMBER) INFINITY, tau = (NUMBER) tau_;
    RESET(out);
    CHECK_OK(ASK(medium_free_flight)(&medium, channel, O, UP, endless, tau, out));
    CHECK_ITEMS(out, 1, 1, &expected);
    CHECK_OK(ASK_BATCH(medium_free_flight)(&medium, N, channel, ONE(O), ONE(UP), ONE(&endless),
                                           ONE(&tau), out));
    CHECK_ITEMS(out, N, 1, &expected);
    RESET(out);
    CHECK_FAILS(ASK(medium_free_flight)(&medium, 2, O, UP, endless, tau, out),
                AM_STATUS_INVALID_ARGUMENT, "channel must be < 2, got 2");
    CHECK_FAILS(ASK_BATCH(medium_free_flight)(&medium, N, 7, ONE(O), ONE(UP), ONE(&endless),
                                              ONE(&tau), out),
                AM_STATUS_INVALID_ARGUMENT, "channel must be < 2, got 7");
    NULL_ERROR(ASK(medium_free_flight)(NULL, 0, O, UP, endless, tau, out), "medium");
    NULL_ERROR(ASK(medium_free_flight)(&medium, 0, NULL, UP, endless, tau, out), "origin");
    NULL_ERROR(ASK(medium_free_flight)(&medium, 0, O, NULL, endless, tau, out), "direction");
    NULL_ERROR(ASK(medium_free_flight)(&medium, 0, O, UP, endless, tau, NULL), "t");
    NULL_DATA(ASK_BATCH(medium_free_flight)(&medium, N, 0, ONE(O), ONE(UP), NONE, ONE(&tau), out),
              "t_max");
    NULL_DATA(
        ASK_BATCH(medium_free_flight)(&medium, N, 0, ONE(O), ONE(UP), ONE(&endless), NONE, out),
        "tau");
    CHECK_OK(ASK_BATCH(medium_free_flight)(&medium, 0, 0, NONE, NONE, NONE, NONE, NULL));
    CHECK_UNTOUCHED(out);
}

static void TEST(medium_pdf_within)(NUMBER t_max, NUMBER x, const double *expected) {
    NUMBER out[N * CHANNELS];
    RESET(out);
    CHECK_OK(ASK(medium_pdf_within)(&medium, O, UP, t_max, x, out));
    CHECK_ITEMS(out, 1, CHANNELS, expected);
    CHECK_OK(ASK_BATCH(medium_pdf_within)(&medium, N, ONE(O), ONE(UP), ONE(&t_max), ONE(&x), out));
    CHECK_ITEMS(out, N, CHANNELS, expected);
    RESET(out);
    NULL_ERROR(ASK(medium_pdf_within)(NULL, O, UP, t_max, x, out), "medium");
    NULL_ERROR(ASK(medium_pdf_within)(&medium, O, UP, t_max, x, NULL), "pdf");
    NULL_DATA(ASK_BATCH(medium_pdf_within)(&medium, N, ONE(O), ONE(UP), ONE(&t_max), NONE, out),
              "t");
    CHECK_OK(ASK_BATCH(medium_pdf_within)(&medium, 0, NONE, NONE, NONE, NONE, NULL));
    CHECK_UNTOUCHED(out);
}

static void TEST(profiles)(void) {
    const double thin = exp(-LENGTH / SCALE_HEIGHT), one = 1, length = LENGTH, two = 2;
    const double trapezoid = LENGTH + LENGTH * LENGTH / 4;
    const double layer = SCALE_HEIGHT * (1 - thin), whole = SCALE_HEIGHT;
    const double half = SCALE_HEIGHT * log(2), never = INFINITY;

    TEST(profile_density)(&constant, 1, &one);
    TEST(profile_density)(&linear, 1, &two);
    TEST(profile_density)(&exponential, 1, &thin);

    TEST(profile_column)(&constant, (NUMBER) LENGTH, 1, &length);
    TEST(profile_column)(&linear, (NUMBER) LENGTH, 1, &trapezoid);
    TEST(profile_column)(&exponential, (NUMBER) LENGTH, 1, &layer);
    TEST(profile_column)(&exponential, (NUMBER) INFINITY, 1, &whole);

    TEST(profile_inv_column)(&constant, (NUMBER) LENGTH, 1, &length);
    TEST(profile_inv_column)(&linear, (NUMBER) trapezoid, 1, &length);
    TEST(profile_inv_column)(&exponential, (NUMBER) (SCALE_HEIGHT / 2), 1, &half);
    TEST(profile_inv_column)(&exponential, (NUMBER) (SCALE_HEIGHT + 1), 1, &never);

    TEST(profile_inv_reached_column)(&linear, (NUMBER) trapezoid, 1, &length);
    TEST(profile_inv_reached_column)(&exponential, (NUMBER) (SCALE_HEIGHT / 2), 1, &half);

    TEST(profile_bounds)(&constant, 1, &one, &one);
    TEST(profile_bounds)(&linear, 1, &one, &two);
    TEST(profile_bounds)(&exponential, 1, &thin, &one);
}

static void TEST(medium)(void) {
    double extinction[CHANNELS], depth[CHANNELS], transmittance[CHANNELS], opacity[CHANNELS];
    double low[CHANNELS], high[CHANNELS], pdf[CHANNELS], within[CHANNELS];
    const double thin = exp(-LENGTH / SCALE_HEIGHT);
    int c;
    for (c = 0; c < CHANNELS; ++c) {
        extinction[c] = sigma_t[c] + sigma_t[CHANNELS + c] * thin;
        depth[c] = sigma_t[c] * LENGTH + sigma_t[CHANNELS + c] * SCALE_HEIGHT * (1 - thin);
        transmittance[c] = exp(-depth[c]);
        opacity[c] = 1 - transmittance[c];
        low[c] = extinction[c];
        high[c] = sigma_t[c] + sigma_t[CHANNELS + c];
        pdf[c] = extinction[c] * transmittance[c];
        within[c] = pdf[c] / opacity[c];
    }
    TEST(medium_extinction)(&medium, CHANNELS, extinction);
    TEST(medium_optical_depth)(&medium, (NUMBER) LENGTH, CHANNELS, depth);
    TEST(medium_transmittance)(&medium, (NUMBER) LENGTH, CHANNELS, transmittance);
    TEST(medium_opacity)(&medium, (NUMBER) LENGTH, CHANNELS, opacity);
    TEST(medium_pdf)(&medium, (NUMBER) LENGTH, CHANNELS, pdf);
    TEST(medium_bounds)(&medium, CHANNELS, low, high);
    for (c = 0; c < CHANNELS; ++c)
        TEST(medium_free_flight)((size_t) c, depth[c], LENGTH);
    TEST(medium_pdf_within)((NUMBER) LENGTH, (NUMBER) LENGTH, within);
}

#undef CAT_
#undef CAT
#undef ASK
#undef ASK_BATCH
#undef TEST
#undef O
#undef UP
#undef TOP
#undef RESET
#undef CHECK_UNTOUCHED
#undef CHECK_ITEMS
#undef SPREAD
#undef ONE
#undef NONE
#undef NARROW
#undef NULL_ERROR
#undef NULL_DATA
#undef STRIDE_ERROR
#undef AT_POINT
#undef ALONG
#undef BOUNDS
