/* Functions of numbers: every form of one, against a known value. Of the tests of special functions
 * and coefficients. */

#ifndef FUNCTIONS_H
#define FUNCTIONS_H

#include "check.h"
#include "host.h"

static tape the_tape;

/* All forms of a function of `ARGUMENTS`, once as they are and once in single precision. */
#define FORMS(name, expected, tolerance, ARGUMENTS, SINGLE, ARRAYS, SINGLE_ARRAYS, SLOTS)          \
    do {                                                                                           \
        double a = 0, many[3] = { 0, 0, 0 };                                                       \
        float b = 0, many_f32[3] = { 0, 0, 0 };                                                    \
        am_host_table host = host_on(&the_tape);                                                   \
        am_node out = 0;                                                                           \
        CHECK_OK(am_##name##_f64(ARGUMENTS, &a));                                                  \
        CHECK_NEAR(a, expected, (tolerance) + 2e-14);                                              \
        CHECK_OK(am_##name##_f32(SINGLE, &b));                                                     \
        CHECK_NEAR(b, expected, (tolerance) + 5e-6);                                               \
        CHECK_OK(am_##name##_batch_f64(3, ARRAYS, many));                                          \
        CHECK_NEAR(many[2], expected, (tolerance) + 2e-14);                                        \
        CHECK_OK(am_##name##_batch_f32(3, SINGLE_ARRAYS, many_f32));                               \
        CHECK_NEAR(many_f32[2], expected, (tolerance) + 5e-6);                                     \
        CHECK_OK(am_##name##_record(&host, SLOTS, &out));                                          \
        CHECK_NEAR(the_tape.values[out], expected, (tolerance) + 2e-14);                           \
    } while (0)

#define COMMA ,
#define SLOT(value) put(&the_tape, value)
#define ONE(name, expected, tolerance, p)                                                          \
    do {                                                                                           \
        const float p##_f32 = (float) p;                                                           \
        const am_array_f64 ps = { &p, 0 };                                                         \
        const am_array_f32 ps_f32 = { &p##_f32, 0 };                                               \
        FORMS(name, expected, tolerance, p, p##_f32, ps, ps_f32, SLOT(p));                         \
    } while (0)
#define TWO(name, expected, tolerance, p, q)                                                       \
    do {                                                                                           \
        const float p##_f32 = (float) p, q##_f32 = (float) q;                                      \
        const am_array_f64 ps = { &p, 0 }, qs = { &q, 0 };                                         \
        const am_array_f32 ps_f32 = { &p##_f32, 0 }, qs_f32 = { &q##_f32, 0 };                     \
        FORMS(name, expected, tolerance, p COMMA q, p##_f32 COMMA q##_f32, ps COMMA qs,            \
              ps_f32 COMMA qs_f32, SLOT(p) COMMA SLOT(q));                                         \
    } while (0)
#define THREE(name, expected, tolerance, p, q, r)                                                  \
    do {                                                                                           \
        const float p##_f32 = (float) p, q##_f32 = (float) q, r##_f32 = (float) r;                 \
        const am_array_f64 ps = { &p, 0 }, qs = { &q, 0 }, rs = { &r, 0 };                         \
        const am_array_f32 ps_f32 = { &p##_f32, 0 }, qs_f32 = { &q##_f32, 0 },                     \
                           rs_f32 = { &r##_f32, 0 };                                               \
        FORMS(name, expected, tolerance, p COMMA q COMMA r, p##_f32 COMMA q##_f32 COMMA r##_f32,   \
              ps COMMA qs COMMA rs, ps_f32 COMMA qs_f32 COMMA rs_f32,                              \
              SLOT(p) COMMA SLOT(q) COMMA SLOT(r));                                                \
    } while (0)
#define FOUR(name, expected, tolerance, p, q, r, s)                                                \
    do {                                                                                           \
        const float p##_f32 = (float) p, q##_f32 = (float) q, r##_f32 = (float) r,                 \
                    s##_f32 = (float) s;                                                           \
        const am_array_f64 ps = { &p, 0 }, qs = { &q, 0 }, rs = { &r, 0 }, ss = { &s, 0 };         \
        const am_array_f32 ps_f32 = { &p##_f32, 0 }, qs_f32 = { &q##_f32, 0 },                     \
                           rs_f32 = { &r##_f32, 0 }, ss_f32 = { &s##_f32, 0 };                     \
        FORMS(name, expected, tolerance, p COMMA q COMMA r COMMA s,                                \
              p##_f32 COMMA q##_f32 COMMA r##_f32 COMMA s##_f32, ps COMMA qs COMMA rs COMMA ss,    \
              ps_f32 COMMA qs_f32 COMMA rs_f32 COMMA ss_f32,                                       \
              SLOT(p) COMMA SLOT(q) COMMA SLOT(r) COMMA SLOT(s));                                  \
    } while (0)

#endif
