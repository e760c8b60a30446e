/* A host for recording: it computes every operation at once, in double precision. */
#ifndef HOST_H
#define HOST_H

#include "analytic_media.h"

#include <math.h>

enum { TAPE_SIZE = 1 << 16 };

typedef struct tape {
    double values[TAPE_SIZE]; /* masks are 0 and 1; slot 0 is the poison */
    am_node used;
    am_node fails_at; /* the slot that cannot be made, or 0 */
} tape;

static am_node put(void *tape_, double value) {
    tape *t = (tape *) tape_;
    if (t->used + 1 >= TAPE_SIZE || (t->fails_at && t->used + 1 >= t->fails_at))
        return 0;
    t->values[++t->used] = value;
    return t->used;
}

static double get(void *tape_, am_node slot) { return ((tape *) tape_)->values[slot]; }

#define UNARY(name, expression)                                                                    \
    static am_node host_##name(void *t, am_node slot) {                                            \
        double a = get(t, slot);                                                                   \
        return slot ? put(t, expression) : 0;                                                      \
    }
#define BINARY(name, expression)                                                                   \
    static am_node host_##name(void *t, am_node first, am_node second) {                           \
        double a = get(t, first), b = get(t, second);                                              \
        return first && second ? put(t, expression) : 0;                                           \
    }
#define TERNARY(name, expression)                                                                  \
    static am_node host_##name(void *t, am_node first, am_node second, am_node third) {            \
        double a = get(t, first), b = get(t, second), c = get(t, third);                           \
        return first && second && third ? put(t, expression) : 0;                                  \
    }

UNARY(neg, -a)
UNARY(abs, fabs(a))
UNARY(sqrt, sqrt(a))
UNARY(exp, exp(a))
UNARY(log, log(a))
UNARY(detach, a)
UNARY(mask_not, !(a != 0))
BINARY(add, a + b)
BINARY(sub, a - b)
BINARY(mul, a *b)
BINARY(div, a / b)
BINARY(min, fmin(a, b))
BINARY(max, fmax(a, b))
BINARY(less, a < b)
BINARY(less_equal, a <= b)
BINARY(mask_and, a != 0 && b != 0)
BINARY(mask_or, a != 0 || b != 0)
TERNARY(fma, fma(a, b, c))
TERNARY(select, a != 0 ? b : c)

static am_host_table host_on(tape *t) {
    am_host_table host = {
        t,
        53,
        put,
        host_neg,
        host_abs,
        host_sqrt,
        host_exp,
        host_log,
        host_detach,
        host_add,
        host_sub,
        host_mul,
        host_div,
        host_min,
        host_max,
        host_fma,
        host_less,
        host_less_equal,
        host_mask_and,
        host_mask_or,
        host_mask_not,
        host_select,
    };
    t->used = 0;
    t->fails_at = 0;
    return host;
}

#endif
