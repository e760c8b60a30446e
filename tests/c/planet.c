/* Altitudes, horizons and shells of a planet: every form has the known answer and the same. */

#include "check.h"

/* A ray down the axis of a planet of radius 10, from 6 above its surface; it leaves the shell at
 * the altitude 5 on the other side of the planet. */
static const am_planet planet = { { 0, 0, -10 }, 10 };
static const double point[3] = { 0, 0, 6 }, down[3] = { 0, 0, -1 };
static const float point_f32[3] = { 0, 0, 6 }, down_f32[3] = { 0, 0, -1 };
static const am_array_f64 points = { point, 3 }, directions = { down, 3 };
static const am_array_f32 points_f32 = { point_f32, 3 }, directions_f32 = { down_f32, 3 };

/* sqrt(16² - 10²)/16 below the horizontal. */
#define ALTITUDE 6.0
#define HORIZON (-0.78062474979979979)
#define HIT 6.0
#define ENTER 1.0
#define LEAVE 31.0

static void altitudes(void) {
    double a = 0;
    float b = 0;
    CHECK_OK(am_planet_altitude_f64(&planet, point, &a));
    CHECK_NEAR(a, ALTITUDE, 1e-14);
    CHECK_OK(am_planet_altitude_f32(&planet, point_f32, &b));
    CHECK_NEAR(b, ALTITUDE, 1e-6);
    CHECK_OK(am_planet_altitude_batch_f64(&planet, 1, points, &a));
    CHECK_NEAR(a, ALTITUDE, 1e-14);
    CHECK_OK(am_planet_altitude_batch_f32(&planet, 1, points_f32, &b));
    CHECK_NEAR(b, ALTITUDE, 1e-6);
}

static void horizons(void) {
    double a = 0;
    float b = 0;
    CHECK_OK(am_planet_horizon_f64(&planet, point, &a));
    CHECK_NEAR(a, HORIZON, 1e-14);
    CHECK_OK(am_planet_horizon_f32(&planet, point_f32, &b));
    CHECK_NEAR(b, HORIZON, 1e-6);
    CHECK_OK(am_planet_horizon_batch_f64(&planet, 1, points, &a));
    CHECK_NEAR(a, HORIZON, 1e-14);
    CHECK_OK(am_planet_horizon_batch_f32(&planet, 1, points_f32, &b));
    CHECK_NEAR(b, HORIZON, 1e-6);
}

static void hits(void) {
    double a = 0;
    float b = 0;
    CHECK_OK(am_planet_hit_f64(&planet, point, down, &a));
    CHECK_NEAR(a, HIT, 1e-14);
    CHECK_OK(am_planet_hit_f32(&planet, point_f32, down_f32, &b));
    CHECK_NEAR(b, HIT, 1e-6);
    CHECK_OK(am_planet_hit_batch_f64(&planet, 1, points, directions, &a));
    CHECK_NEAR(a, HIT, 1e-14);
    CHECK_OK(am_planet_hit_batch_f32(&planet, 1, points_f32, directions_f32, &b));
    CHECK_NEAR(b, HIT, 1e-6);
}

static void shells(void) {
    static const double altitude = 5;
    static const float altitude_f32 = 5;
    static const am_array_f64 altitudes = { &altitude, 1 };
    static const am_array_f32 altitudes_f32 = { &altitude_f32, 1 };
    double a[2] = { 0, 0 };
    float b[2] = { 0, 0 };
    CHECK_OK(am_planet_shell_f64(&planet, point, down, altitude, a, a + 1));
    CHECK_NEAR(a[0], ENTER, 1e-14);
    CHECK_NEAR(a[1], LEAVE, 1e-14);
    CHECK_OK(am_planet_shell_f32(&planet, point_f32, down_f32, altitude_f32, b, b + 1));
    CHECK_NEAR(b[0], ENTER, 1e-6);
    CHECK_NEAR(b[1], LEAVE, 1e-6);
    CHECK_OK(am_planet_shell_batch_f64(&planet, 1, points, directions, altitudes, a, a + 1));
    CHECK_NEAR(a[0], ENTER, 1e-14);
    CHECK_NEAR(a[1], LEAVE, 1e-14);
    CHECK_OK(
        am_planet_shell_batch_f32(&planet, 1, points_f32, directions_f32, altitudes_f32, b, b + 1));
    CHECK_NEAR(b[0], ENTER, 1e-6);
    CHECK_NEAR(b[1], LEAVE, 1e-6);
}

static void mistakes(void) {
    am_planet flat = planet;
    double out = 77;
    CHECK_OK(am_planet_check(&planet));
    CHECK_FAILS(am_planet_check(NULL), AM_STATUS_NULL_POINTER, "planet");
    flat.radius = -3;
    CHECK_FAILS(am_planet_check(&flat), AM_STATUS_INVALID_ARGUMENT,
                "radius must be finite and > 0, got -3");
    CHECK_FAILS(am_planet_altitude_f64(&flat, point, &out), AM_STATUS_INVALID_ARGUMENT, "radius");
    CHECK_FAILS(am_planet_altitude_f64(&planet, NULL, &out), AM_STATUS_NULL_POINTER, "point");
    CHECK_FAILS(am_planet_altitude_f64(&planet, point, NULL), AM_STATUS_NULL_POINTER, "altitude");
    CHECK(out == 77);
}

int main(void) {
    altitudes();
    horizons();
    hits();
    shells();
    mistakes();
    return REPORT();
}
