/* Every question, scalar and batched, in both precisions: known answers, and every mistake. */

#include "check.h"
#include "media.h"

#define NUMBER double
#define ARRAY am_array_f64
#define SUFFIX _f64
#define TOLERANCE 1e-14
#include "questions.h"
#undef NUMBER
#undef ARRAY
#undef SUFFIX
#undef TOLERANCE

#define NUMBER float
#define ARRAY am_array_f32
#define SUFFIX _f32
#define TOLERANCE 2e-6
#include "questions.h"

int main(void) {
    test_profiles_f64();
    test_medium_f64();
    test_profiles_f32();
    test_medium_f32();
    return REPORT();
}
