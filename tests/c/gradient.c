/* Values and gradients, scalar and batched, in both precisions: known answers, and the mistakes. */

#include "check.h"
#include "media.h"

enum { N = 11, PROFILE_ROW = 13, MEDIUM_ROW = 15, CHANNELS = 2 };
#define UNTOUCHED (-77)

static double moment(void) { /* the integral of s exp(-s/H) */
    const double x = LENGTH / SCALE_HEIGHT;
    return SCALE_HEIGHT * SCALE_HEIGHT * (1 - (1 + x) * exp(-x));
}

/* The column of the exponential layer straight up, and its derivatives. */
static void column_row(double *row) {
    const double x = LENGTH / SCALE_HEIGHT, column = SCALE_HEIGHT * (1 - exp(-x));
    const double h = SCALE_HEIGHT, m = moment();
    const double expected[PROFILE_ROW] = { column, 0, 0, -m / h, column / h, m / (h * h), 0, 0,
                                           -column / h, 0, 0, -m / h, exp(-x) };
    memcpy(row, expected, sizeof expected);
}

/* The optical depth of both components in a channel, and its derivatives. */
static void depth_row(int channel, double *row) {
    double own[PROFILE_ROW];
    const double fog = sigma_t[channel], layer = sigma_t[CHANNELS + channel];
    int i;
    column_row(own);
    row[0] = fog * LENGTH + layer * own[0];
    row[1] = LENGTH;
    row[2] = own[0];
    for (i = 1; i < PROFILE_ROW; ++i)
        row[2 + i] = layer * own[i];
    row[MEDIUM_ROW - 1] += fog;
}

/* The same for the distance at which the value is reached. */
static void invert(double *row, int count, double value) {
    const double density = row[count - 1];
    int i;
    for (i = 1; i < count - 1; ++i)
        row[i] /= -density;
    row[count - 1] = 1 / density;
    row[0] = value;
}

#define CHECK_ROWS(out, rows, count, expected, tolerance)                                          \
    do {                                                                                           \
        int i_;                                                                                    \
        for (i_ = 0; i_ < (rows) * (count); ++i_)                                                  \
            CHECK_NEAR((out)[i_], (expected)[i_ % (count)], tolerance);                            \
        for (; i_ < N * CHANNELS * MEDIUM_ROW; ++i_)                                               \
            CHECK((out)[i_] == UNTOUCHED);                                                         \
    } while (0)

#define RESET(out)                                                                                 \
    do {                                                                                           \
        int i_;                                                                                    \
        for (i_ = 0; i_ < N * CHANNELS * MEDIUM_ROW; ++i_)                                         \
            (out)[i_] = UNTOUCHED;                                                                 \
    } while (0)

#define NULL_ERROR(call, name) CHECK_FAILS(call, AM_STATUS_NULL_POINTER, name " must not be null")

#define PRECISION(NUMBER, S, TOLERANCE)                                                            \
    static void test_##S(void) {                                                                   \
        static NUMBER out[N * CHANNELS * MEDIUM_ROW];                                              \
        const NUMBER o[3] = { 0, 0, 0 }, up[3] = { 0, 0, 1 }, t = (NUMBER) LENGTH;                 \
        const NUMBER endless = (NUMBER) INFINITY;                                                  \
        const am_array_##S origins = { o, 0 }, ups = { up, 0 }, none = { NULL, 0 };                \
        const am_array_##S lengths = { &t, 0 }, limits = { &endless, 0 };                          \
        double row[CHANNELS * MEDIUM_ROW];                                                         \
        NUMBER reached;                                                                            \
        am_array_##S goals = { &reached, 0 };                                                      \
                                                                                                   \
        column_row(row);                                                                           \
        reached = (NUMBER) row[0];                                                                 \
        RESET(out);                                                                                \
        CHECK_OK(am_profile_column_value_and_gradient_##S(&exponential, o, up, t, out));           \
        CHECK_ROWS(out, 1, PROFILE_ROW, row, TOLERANCE);                                           \
        CHECK_OK(am_profile_column_value_and_gradient_batch_##S(&exponential, N, origins, ups,     \
                                                                lengths, out));                    \
        CHECK_ROWS(out, N, PROFILE_ROW, row, TOLERANCE);                                           \
                                                                                                   \
        invert(row, PROFILE_ROW, LENGTH);                                                          \
        RESET(out);                                                                                \
        CHECK_OK(                                                                                  \
            am_profile_inv_column_value_and_gradient_##S(&exponential, o, up, reached, out));      \
        CHECK_ROWS(out, 1, PROFILE_ROW, row, 4 * TOLERANCE);                                       \
        CHECK_OK(am_profile_inv_column_value_and_gradient_batch_##S(&exponential, N, origins, ups, \
                                                                    goals, out));                  \
        CHECK_ROWS(out, N, PROFILE_ROW, row, 4 * TOLERANCE);                                       \
                                                                                                   \
        depth_row(0, row);                                                                         \
        depth_row(1, row + MEDIUM_ROW);                                                            \
        RESET(out);                                                                                \
        CHECK_OK(am_medium_optical_depth_value_and_gradient_##S(&medium, o, up, t, out));          \
        CHECK_ROWS(out, 1, CHANNELS * MEDIUM_ROW, row, TOLERANCE);                                 \
        CHECK_OK(am_medium_optical_depth_value_and_gradient_batch_##S(&medium, N, origins, ups,    \
                                                                      lengths, out));              \
        CHECK_ROWS(out, N, CHANNELS *MEDIUM_ROW, row, TOLERANCE);                                  \
                                                                                                   \
        reached = (NUMBER) row[MEDIUM_ROW];                                                        \
        depth_row(1, row);                                                                         \
        invert(row, MEDIUM_ROW, LENGTH);                                                           \
        RESET(out);                                                                                \
        CHECK_OK(am_medium_free_flight_value_and_gradient_##S(&medium, 1, o, up, endless, reached, \
                                                              out));                               \
        CHECK_ROWS(out, 1, MEDIUM_ROW, row, 4 * TOLERANCE);                                        \
        CHECK_OK(am_medium_free_flight_value_and_gradient_batch_##S(&medium, N, 1, origins, ups,   \
                                                                    limits, goals, out));          \
        CHECK_ROWS(out, N, MEDIUM_ROW, row, 4 * TOLERANCE);                                        \
                                                                                                   \
        RESET(out);                                                                                \
        NULL_ERROR(am_profile_column_value_and_gradient_##S(NULL, o, up, t, out), "profile");      \
        NULL_ERROR(am_profile_column_value_and_gradient_##S(&exponential, o, up, t, NULL),         \
                   "value_and_gradient");                                                          \
        NULL_ERROR(am_profile_inv_column_value_and_gradient_##S(&exponential, NULL, up, t, out),   \
                   "origin");                                                                      \
        NULL_ERROR(am_medium_optical_depth_value_and_gradient_##S(&medium, o, NULL, t, out),       \
                   "direction");                                                                   \
        NULL_ERROR(am_medium_optical_depth_value_and_gradient_batch_##S(&medium, N, none, ups,     \
                                                                        lengths, out),             \
                   "origin.data");                                                                 \
        CHECK_FAILS(am_medium_free_flight_value_and_gradient_##S(&medium, 2, o, up, endless,       \
                                                                 reached, out),                    \
                    AM_STATUS_INVALID_ARGUMENT, "channel must be < 2, got 2");                     \
        CHECK_ROWS(out, 0, 1, row, 0);                                                             \
    }

PRECISION(double, f64, 2e-14)
PRECISION(float, f32, 4e-6)

static void sizes(void) {
    am_profile unknown = { 99, { 0 } };
    size_t size = 0;
    CHECK_OK(am_profile_gradient_size(&exponential, &size));
    CHECK(size == PROFILE_ROW - 1);
    CHECK_OK(am_medium_gradient_size(&medium, &size));
    CHECK(size == MEDIUM_ROW - 1);
    NULL_ERROR(am_profile_gradient_size(NULL, &size), "profile");
    NULL_ERROR(am_profile_gradient_size(&exponential, NULL), "size");
    NULL_ERROR(am_medium_gradient_size(NULL, &size), "medium");
    NULL_ERROR(am_medium_gradient_size(&medium, NULL), "size");
    CHECK_FAILS(am_profile_gradient_size(&unknown, &size), AM_STATUS_INVALID_ARGUMENT, "kind");
    CHECK(size == MEDIUM_ROW - 1);
}

int main(void) {
    sizes();
    test_f64();
    test_f32();
    return REPORT();
}
