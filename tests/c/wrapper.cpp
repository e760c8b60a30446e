// The C++ wrapper: the answers of closed forms, in both precisions, and an exception for
// every mistake.

#include "analytic_media.hpp"

#include "analytic_media.hpp"

#include "check.h"

#include <limits>

template <typename T> static void answers(double tolerance) {
    using V = am::Vector<T>;
    const V origin{ 0, 0, 0 }, up{ 0, 0, 1 }, top{ 0, 0, 2 };
    const T infinity = std::numeric_limits<T>::infinity();
    const double thin = std::exp(-1.0), layer = 2 * (1 - thin);

    am::Profile fog("exponential", { { "scale_height", { 2 } } });
    CHECK_NEAR(fog.density(top), thin, tolerance);
    CHECK_NEAR(fog.column(origin, up, T(2)), layer, tolerance);
    CHECK_NEAR(fog.column(origin, up, infinity), 2, tolerance);
    CHECK_NEAR(fog.inv_column(origin, up, T(1)), 2 * std::log(2.0), tolerance);
    CHECK(fog.inv_column(origin, up, T(3)) == infinity);
    CHECK_NEAR(fog.inv_reached_column(origin, up, T(1)), 2 * std::log(2.0), tolerance);
    const std::vector<T> by = fog.column_value_and_gradient(origin, up, T(2));
    CHECK(by.size() == 1 + fog.gradient_size());
    CHECK_NEAR(by.front(), layer, tolerance);
    CHECK_NEAR(by[4], layer / 2, tolerance); // base_height
    CHECK_NEAR(by.back(), thin, tolerance);
    CHECK_NEAR(fog.inv_column_value_and_gradient(origin, up, T(1)).back(), 2, 4 * tolerance);
    CHECK_NEAR(fog.bounds(origin, up, T(2)).inf, thin, tolerance);
    CHECK_NEAR(fog.bounds_in_box(origin, top).sup, 1, tolerance);

    const std::vector<V> many(19, origin);
    const std::vector<T> distances(19, T(2)), column = fog.column(many, { up }, distances);
    CHECK(column.size() == 19);
    CHECK_NEAR(column[18], layer, tolerance);
    CHECK_NEAR(fog.inv_column(many, { up }, column)[18], 2, tolerance);
    CHECK_NEAR(fog.density(std::vector<V>(9, top))[8], thin, tolerance);

    am::Medium medium({ { am::Profile("constant"), { 0.1, 0.2 } }, { fog, { 1, 3 } } });
    const double depth = 0.2 * 2 + 3 * layer, extinction = 0.2 + 3 * thin;
    CHECK_NEAR(medium.extinction(top)[1], extinction, tolerance);
    CHECK_NEAR(medium.optical_depth(origin, up, T(2))[1], depth, tolerance);
    CHECK_NEAR(medium.transmittance(origin, up, T(2))[1], std::exp(-depth), 4 * tolerance);
    CHECK_NEAR(medium.opacity(origin, up, T(2))[1], 1 - std::exp(-depth), tolerance);
    CHECK_NEAR(medium.pdf(origin, up, T(2))[1], extinction * std::exp(-depth), 4 * tolerance);
    CHECK_NEAR(medium.pdf_within(origin, up, T(2), T(2))[1],
               extinction * std::exp(-depth) / (1 - std::exp(-depth)), 4 * tolerance);
    CHECK_NEAR(medium.free_flight(1, origin, up, infinity, T(depth)), 2, 4 * tolerance);
    const std::size_t row = 1 + medium.gradient_size();
    const std::vector<T> rows = medium.optical_depth_value_and_gradient(origin, up, T(2));
    CHECK(rows.size() == 2 * row);
    CHECK_NEAR(rows[row], depth, tolerance);
    CHECK_NEAR(rows[row + 2], layer, tolerance); // sigma_t of the layer
    const std::vector<T> flight =
        medium.free_flight_value_and_gradient(1, origin, up, infinity, T(depth));
    CHECK(flight.size() == row);
    CHECK_NEAR(flight.front(), 2, 4 * tolerance);
    CHECK_NEAR(flight.back(), 1 / extinction, 4 * tolerance);
    CHECK_NEAR(medium.bounds(origin, up, T(2))[1].sup, 3.2, tolerance);
    CHECK_NEAR(medium.bounds_in_box(origin, top)[1].inf, extinction, tolerance);
    CHECK_NEAR(medium.optical_depth(many, { up }, distances)[37], depth, tolerance);
    CHECK_NEAR(medium.free_flight(1, many, { up }, { infinity }, { T(depth) })[18], 2,
               4 * tolerance);

    // A line past a light at the distance 2 without extinction: sigma_s/(4 * 2).
    am_light light{};
    light.kind = AM_LIGHT_KIND_ISOTROPIC;
    light.position[0] = 2;
    const am::AirLight lamp(light, { AM_PHASE_KIND_ISOTROPIC, 0 }, { 1, 3 }, { 0, 0 });
    const T start = T(-2), end = T(2); // half of it: 45 degrees to both sides
    CHECK_NEAR(lamp.radiance(origin, up, start, end)[1], 3.0 / 16, tolerance);
    CHECK_NEAR(lamp.radiance(many, { up }, { start }, { end })[37], 3.0 / 16, tolerance);
    const auto [about, error] = lamp.radiance_within(origin, up, start, end, T(1e-3));
    CHECK_NEAR(about[1], 3.0 / 16, 1e-3);
    CHECK(error[1] >= 0 && error[1] <= T(1e-3));
}

// `call` throws an error that contains `text`.
template <typename Call> static void throws(const char *text, Call call) {
    try {
        call();
        CHECK(!"an exception");
    } catch (const am::Error &error) {
        CHECK(error.status() == AM_STATUS_INVALID_ARGUMENT);
        CHECK(std::string(error.what()).find(text) != std::string::npos);
    }
}

int main() {
    answers<double>(1e-14);
    answers<float>(2e-6);
    throws("got \"cubic\"", [] { am::Profile("cubic"); });
    throws("scale_height must be given", [] { am::Profile("exponential"); });
    throws("scale_height must be finite and > 0, got -3",
           [] { am::Profile("exponential", { { "scale_height", { -3 } } }); });
    throws("up must have 3 values, got 1", [] { am::Profile("linear", { { "up", { 1 } } }); });
    throws("does not have", [] { am::Profile("constant", { { "radius", { 1 } } }); });
    throws("sigma_t must be finite and >= 0, got -1",
           [] { am::Medium({ { am::Profile("constant"), { -1 } } }); });
    throws("light.position must be finite", [] {
        am_light far{};
        far.position[2] = INFINITY;
        am::AirLight(far, { AM_PHASE_KIND_ISOTROPIC, 0 }, { 1 }, { 1 });
    });
    throws("the same number of channels",
           [] { am::AirLight(am_light{}, am_phase{}, { 1 }, { 1, 2 }); });
    throws("n_components must be >= 1", [] { am::Medium(std::vector<am::Medium::Component>{}); });
    throws("must have 1 or 3 items, got 2", [] {
        am::Vector<double> v{ 0, 0, 1 };
        am::Profile("constant").column(std::vector{ v, v }, std::vector{ v }, { 1.0, 2.0, 3.0 });
    });
    return REPORT();
}
