/* Checks that count failures and print where and what. */
#ifndef CHECK_H
#define CHECK_H

#include "analytic_media.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static int failures;

#define CHECK(condition)                                                                           \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            ++failures;                                                                            \
            fprintf(stderr, "%s:%d: not true: %s (last error: %s)\n", __FILE__, __LINE__,          \
                    #condition, am_last_error());                                                  \
        }                                                                                          \
    } while (0)

#define CHECK_OK(call) CHECK((call) == AM_STATUS_OK)

/* `got` is `expected` within the relative `tolerance`; infinities are equal to themselves. */
#define CHECK_NEAR(got, expected, tolerance)                                                       \
    do {                                                                                           \
        double got_ = (double) (got), expected_ = (double) (expected);                             \
        if (got_ != expected_ && !(fabs(got_ - expected_) <= (tolerance) * fabs(expected_))) {     \
            ++failures;                                                                            \
            fprintf(stderr, "%s:%d: %s is %.17g, expected %.17g\n", __FILE__, __LINE__, #got,      \
                    got_, expected_);                                                              \
        }                                                                                          \
    } while (0)

/* `call` fails with `status`, and the last error of this thread contains `text`. */
#define CHECK_FAILS(call, status, text)                                                            \
    do {                                                                                           \
        CHECK((call) == (status));                                                                 \
        if (!strstr(am_last_error(), (text))) {                                                    \
            ++failures;                                                                            \
            fprintf(stderr, "%s:%d: last error \"%s\" does not contain \"%s\"\n", __FILE__,        \
                    __LINE__, am_last_error(), (text));                                            \
        }                                                                                          \
    } while (0)

#define REPORT() (failures ? (fprintf(stderr, "%d failures\n", failures), 1) : 0)

#endif
