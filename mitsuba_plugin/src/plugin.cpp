// Entry point: Mitsuba calls init_plugin with the name of the plugin it looks for.

#include <stdexcept>
#include <string>

#include <mitsuba/core/object.h>
#include <mitsuba/core/properties.h>

#include "lists.h"

namespace mitsuba {

#define X(variant) void register_##variant(std::string_view plugin, PluginRegisterFn add);
AM_BUILT_VARIANTS(X)
#undef X

/// Object type of one of our plugins, Unknown for any other name.
static ObjectType type_of(std::string_view plugin) {
#define X(name, interface, class_template)                                                         \
    if (plugin == #name)                                                                           \
        return ObjectType::interface;
    AM_PLUGINS(X)
#undef X
    return ObjectType::Unknown;
}

[[noreturn, maybe_unused]] static void throw_absent(const Properties &props, const char *variant) {
    throw std::runtime_error(std::string(props.plugin_name()) +
                             ": this build of analytic-media holds " + AM_BUILT_VARIANT_NAMES +
                             " but not " + variant + "; configure it with -DAM_VARIANTS=all");
}

/// Variants left out of this build are registered too: Mitsuba asks scalar_rgb for the type of a
/// plugin, and a user of another variant should read why it is missing.
static void register_absent([[maybe_unused]] std::string_view plugin,
                            [[maybe_unused]] PluginRegisterFn add) {
#define X(variant)                                                                                 \
    add(plugin, #variant, type_of(plugin),                                                         \
        [](void *, const Properties &props) -> ref<Object> { throw_absent(props, #variant); });
    AM_ABSENT_VARIANTS(X)
#undef X
}

} // namespace mitsuba

extern "C" MI_EXPORT void init_plugin(std::string_view plugin, mitsuba::PluginRegisterFn add) {
    if (mitsuba::type_of(plugin) == mitsuba::ObjectType::Unknown)
        return;
#define X(variant) mitsuba::register_##variant(plugin, add);
    AM_BUILT_VARIANTS(X)
#undef X
    mitsuba::register_absent(plugin, add);
}
