#include "selfcheck.h"

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include <analytic_media.h>
#include <mitsuba/core/plugin.h>
#include <mitsuba/core/properties.h>
#include <mitsuba/core/util.h>
#include <mitsuba/render/interaction.h>
#include <mitsuba/render/medium.h>
#include <mitsuba/render/phase.h>
#include <mitsuba/render/volume.h>

#include "lists.h"

namespace mitsuba {

/// The types of scalar_rgb, the variant that every build of Mitsuba holds.
struct ScalarRgb {
    using Float = float;
    using Spectrum = Color<float, 3>;
    MI_IMPORT_TYPES(Medium, PhaseFunction, PhaseFunctionContext, Volume)

    static void check_layout();
};

// Layout of the wheel. Dr.Jit's static arrays grow and shrink with the instruction set.
#define AM_WRONG_LAYOUT "layout differs from Mitsuba's wheel: compile with -march=haswell"
static_assert(sizeof(ScalarRgb::Color3f) == 16 && alignof(ScalarRgb::Color3f) == 16,
              AM_WRONG_LAYOUT);
static_assert(sizeof(dr::mask_t<ScalarRgb::Color3f>) == 16, AM_WRONG_LAYOUT);
static_assert(sizeof(ScalarRgb::Vector3d) == 32 && alignof(ScalarRgb::Vector3d) == 32,
              AM_WRONG_LAYOUT);
static_assert(alignof(dr::Array<uint64_t, 4>) == 32, AM_WRONG_LAYOUT);
static_assert(sizeof(ScalarRgb::MediumInteraction3f) == 224, AM_WRONG_LAYOUT);
#undef AM_WRONG_LAYOUT

[[noreturn]] static void refuse(const std::string &what, const std::string &found,
                                const std::string &expected) {
    throw std::runtime_error("analytic-media does not fit the running Mitsuba: " + what + " is " +
                             found + ", expected " + expected +
                             ". Install mitsuba==" AM_MITSUBA_VERSION
                             " or rebuild analytic-media.");
}

/// The library reports "Mitsuba version 3.9.1 (..., 8-wide SIMD)".
static void check_version() {
    const std::string report = util::info_build(1);

    const std::string prefix = "Mitsuba version ";
    const std::string found = report.substr(prefix.size(), report.find(" (") - prefix.size());
    if (report.compare(0, prefix.size(), prefix) != 0 || found != AM_MITSUBA_VERSION)
        refuse("its version", '"' + found + '"', AM_MITSUBA_VERSION);

    const std::string simd = std::to_string(dr::Packet<float>::Size) + "-wide SIMD";
    if (report.find(", " + simd) == std::string::npos)
        refuse("its instruction set", '"' + report + '"', simd);
}

static void check_core() {
    if (am_abi_version() != AM_ABI_VERSION)
        refuse("the C ABI of the Rust core", std::to_string(am_abi_version()),
               std::to_string(AM_ABI_VERSION));
}

static void check_value(const char *what, float found, double expected) {
    if (std::abs(found - expected) <= 1e-5 * std::abs(expected))
        return;
    std::ostringstream found_text, expected_text;
    found_text << found;
    expected_text << expected;
    refuse(std::string("the binary interface (") + what + ")", found_text.str(),
           expected_text.str());
}

/// Values known by heart, through the same structures and virtual functions that our own plugins
/// use: a field or an argument in another place shows.
void ScalarRgb::check_layout() {
    const double g = 0.5, sigma_t = 2.0, albedo = 0.25;

    // A colour travels in registers: where its size is wrong, this shows it without touching memory
    // that is not ours. It must come first, the structures below would overflow.
    Properties volume_props("constvolume");
    volume_props.set("value", albedo);
    ref<Volume> volume = PluginManager::instance()->create_object<Volume>(volume_props);
    Color3f colour = volume->eval(dr::zeros<Interaction3f>(), true);
    for (size_t i = 0; i < 3; ++i)
        check_value("colour", colour[i], albedo);

    Properties phase_props("hg");
    phase_props.set("g", g);
    ref<PhaseFunction> phase = PluginManager::instance()->create_object<PhaseFunction>(phase_props);

    Properties medium_props("homogeneous");
    medium_props.set("sigma_t", sigma_t);
    medium_props.set("albedo", albedo);
    medium_props.set("phase", ref<Object>(phase.get()));
    ref<Medium> medium = PluginManager::instance()->create_object<Medium>(medium_props);

    // Half of all free flights are shorter than ln 2 / sigma_t.
    const double half = std::log(2.0) / sigma_t;
    Ray3f ray(Point3f(1.f, 2.f, 3.f), Vector3f(0.6f, 0.f, 0.8f));
    MediumInteraction3f mi = medium->sample_interaction(ray, 0.5f, 0, true);
    check_value("mi.t", mi.t, half);
    check_value("mi.p.z", mi.p.z(), 3.0 + 0.8 * half);
    check_value("mi.wi.x", mi.wi.x(), -0.6);
    if (mi.medium != medium.get())
        refuse("the binary interface (mi.medium)", "not the medium", "the medium");

    auto [sigma_s, sigma_n, total] = medium->get_scattering_coefficients(mi, true);
    for (size_t i = 0; i < 3; ++i) {
        check_value("mi.combined_extinction", mi.combined_extinction[i], sigma_t);
        check_value("sigma_s", sigma_s[i], albedo * sigma_t);
        check_value("sigma_t", total[i], sigma_t);
    }

    // Henyey and Greenstein's phase function; here wi points backwards along the ray.
    const double cos_theta = -(0.6 * 0.8 + 0.8 * 0.6);
    const double expected =
        (1.0 - g * g) / (4.0 * dr::Pi<double> * std::pow(1.0 + g * g + 2.0 * g * cos_theta, 1.5));
    auto [value, pdf] = medium->phase_function()->eval_pdf(PhaseFunctionContext(nullptr), mi,
                                                           Vector3f(0.8f, 0.f, 0.6f), true);
    check_value("phase function", value[2], expected);
    check_value("phase pdf", pdf, expected);
}

void require_matching_mitsuba() {
    // A check that throws leaves `passed` unset, so the next object is refused as well.
    static const bool passed = [] {
        check_version();
        check_core();
        ScalarRgb::check_layout();
        return true;
    }();
    (void) passed;
}

} // namespace mitsuba
