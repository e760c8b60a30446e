// The C header serves C++17, and may be included twice.

#include "analytic_media.h"

#include "analytic_media.h"

int main() {
    const am_profile exponential{ 2, { 0, 0, 1, 0, 2 } };
    const double point[] = { 0, 0, 0 };
    double density = 0;
    am_status status = am_profile_density_f64(&exponential, point, &density);
    return status == AM_STATUS_OK && density == 1 ? 0 : 1;
}
