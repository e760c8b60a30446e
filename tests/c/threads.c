/* The last error belongs to the thread that made it. */

#include "check.h"
#include "media.h"

#include <pthread.h>

static void *other_thread(void *unused) {
    am_parameter p;
    CHECK(am_last_error()[0] == '\0');
    CHECK_FAILS(am_profile_parameter(2, 9, &p), AM_STATUS_INVALID_ARGUMENT, "got 9");
    return unused;
}

int main(void) {
    pthread_t thread;
    CHECK_FAILS(am_profile_check(NULL), AM_STATUS_NULL_POINTER, "profile must not be null");
    CHECK(pthread_create(&thread, NULL, other_thread, NULL) == 0);
    CHECK(pthread_join(thread, NULL) == 0);
    CHECK(strstr(am_last_error(), "profile must not be null") != NULL);
    CHECK_OK(am_profile_check(&constant));
    CHECK(strstr(am_last_error(), "profile must not be null") != NULL);
    return REPORT();
}
