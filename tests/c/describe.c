/* Versions, descriptions and checks: what a host asks before it asks questions. The header
 * is included twice, as larger programs do. */

#include "check.h"
#include "media.h"

#include "analytic_media.h"

static void versions(void) {
    CHECK(am_abi_version() == AM_ABI_VERSION);
    CHECK(strchr(am_version(), '.') != NULL);
    CHECK(am_last_error()[0] == '\0');
    CHECK(strcmp(am_status_message(AM_STATUS_OK), "ok") == 0);
    CHECK(strcmp(am_status_message(AM_STATUS_NULL_POINTER), "null pointer") == 0);
    CHECK(strcmp(am_status_message(AM_STATUS_INVALID_ARGUMENT), "invalid argument") == 0);
    CHECK(strcmp(am_status_message(4711), "unknown status") == 0);
}

static void kinds(void) {
    const char *names[] = { "constant", "linear",   "exponential",          "spherical",
                            "tent",     "gaussian", "anisotropic_gaussian", "radial_gaussian" };
    const uint32_t counts[] = { 0, 4, 3, 3, 4, 2, 4, 3 };
    uint32_t kind, count;
    char name[AM_NAME_SIZE];
    for (uint32_t i = 0; i < 8; ++i) {
        CHECK_OK(am_profile_kind(names[i], &kind));
        CHECK(kind == i);
        CHECK_OK(am_profile_describe(i, &name, &count));
        CHECK(strcmp(name, names[i]) == 0);
        CHECK(count == counts[i]);
    }
    kind = 77;
    CHECK_FAILS(am_profile_kind("cubic", &kind), AM_STATUS_INVALID_ARGUMENT,
                "profile must be one of constant, linear, exponential, spherical, tent, gaussian, "
                "anisotropic_gaussian, radial_gaussian, got \"cubic\"");
    CHECK_FAILS(am_profile_kind(NULL, &kind), AM_STATUS_NULL_POINTER, "name");
    CHECK_FAILS(am_profile_kind("linear", NULL), AM_STATUS_NULL_POINTER, "kind");
    CHECK(kind == 77);
    CHECK_FAILS(am_profile_describe(99, &name, &count), AM_STATUS_INVALID_ARGUMENT,
                "kind must be one of");
    CHECK_FAILS(am_profile_describe(0, NULL, &count), AM_STATUS_NULL_POINTER, "name");
    CHECK_FAILS(am_profile_describe(0, &name, NULL), AM_STATUS_NULL_POINTER, "parameters");
}

static void parameters(void) {
    am_parameter p;
    CHECK_OK(am_profile_parameter(2, 0, &p));
    CHECK(strcmp(p.name, "up") == 0 && p.size == 3 && p.offset == 0 && !p.required);
    CHECK(p.defaults[0] == 0 && p.defaults[1] == 0 && p.defaults[2] == 1);
    CHECK_OK(am_profile_parameter(2, 2, &p));
    CHECK(strcmp(p.name, "scale_height") == 0 && p.size == 1 && p.offset == 4 && p.required);
    CHECK_FAILS(am_profile_parameter(2, 3, &p), AM_STATUS_INVALID_ARGUMENT,
                "index must be < 3, got 3");
    CHECK_FAILS(am_profile_parameter(99, 0, &p), AM_STATUS_INVALID_ARGUMENT, "got 99");
    CHECK_FAILS(am_profile_parameter(2, 0, NULL), AM_STATUS_NULL_POINTER, "parameter");
    CHECK(strcmp(p.name, "scale_height") == 0);
}

static void profile_checks(void) {
    am_profile p = exponential;
    CHECK_OK(am_profile_check(&constant));
    CHECK_OK(am_profile_check(&linear));
    CHECK_OK(am_profile_check(&exponential));
    CHECK_FAILS(am_profile_check(NULL), AM_STATUS_NULL_POINTER, "profile");
    p.values[4] = -3;
    CHECK_FAILS(am_profile_check(&p), AM_STATUS_INVALID_ARGUMENT,
                "scale_height must be finite and > 0, got -3");
    p.values[4] = NAN;
    CHECK_FAILS(am_profile_check(&p), AM_STATUS_INVALID_ARGUMENT, "scale_height");
    p = exponential;
    p.values[2] = 2;
    CHECK_FAILS(am_profile_check(&p), AM_STATUS_INVALID_ARGUMENT, "up must be a unit vector");
    p = linear;
    p.values[3] = INFINITY;
    CHECK_FAILS(am_profile_check(&p), AM_STATUS_INVALID_ARGUMENT,
                "base_height must be finite, got inf");
    p.kind = 99;
    CHECK_FAILS(am_profile_check(&p), AM_STATUS_INVALID_ARGUMENT, "got 99");
}

static void medium_checks(void) {
    const double negative[4] = { 0.1, 0.2, -1, 3 };
    double out[2] = { 77, 77 };
    const double point[3] = { 0, 0, 0 };
    am_profile strange[2];
    am_medium m = medium;
    CHECK_OK(am_medium_check(&medium));
    CHECK_FAILS(am_medium_check(NULL), AM_STATUS_NULL_POINTER, "medium");
    m.sigma_t = negative;
    CHECK_FAILS(am_medium_check(&m), AM_STATUS_INVALID_ARGUMENT,
                "sigma_t must be finite and >= 0, got -1");
    m.sigma_t = NULL;
    CHECK_FAILS(am_medium_extinction_f64(&m, point, out), AM_STATUS_NULL_POINTER, "sigma_t");
    m = medium;
    m.profiles = NULL;
    CHECK_FAILS(am_medium_extinction_f64(&m, point, out), AM_STATUS_NULL_POINTER, "profiles");
    m = medium;
    m.n_components = 0;
    CHECK_FAILS(am_medium_extinction_f64(&m, point, out), AM_STATUS_INVALID_ARGUMENT,
                "n_components must be >= 1, got 0");
    m = medium;
    m.n_channels = 0;
    CHECK_FAILS(am_medium_check(&m), AM_STATUS_INVALID_ARGUMENT, "n_channels must be >= 1, got 0");
    strange[0] = constant;
    strange[1] = constant;
    strange[1].kind = 99;
    m = medium;
    m.profiles = strange;
    CHECK_FAILS(am_medium_extinction_f64(&m, point, out), AM_STATUS_INVALID_ARGUMENT, "got 99");
    CHECK(out[0] == 77 && out[1] == 77);
}

int main(void) {
    versions();
    kinds();
    parameters();
    profile_checks();
    medium_checks();
    return REPORT();
}
