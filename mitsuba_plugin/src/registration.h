// Makes a plugin class known to Mitsuba.

#pragma once

#include <mitsuba/core/object.h>
#include <mitsuba/core/properties.h>

#include "selfcheck.h"

namespace mitsuba {

/// Offers `Class` under the name `plugin`; no object is made before the self-check has passed.
template <typename Class> void register_class(std::string_view plugin, PluginRegisterFn add) {
    add(plugin, Class::Variant, Class::Type, [](void *, const Properties &props) -> ref<Object> {
        require_matching_mitsuba();
        return new Class(props);
    });
}

} // namespace mitsuba
