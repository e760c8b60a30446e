// Properties whose values are names.

#pragma once

#include <string>
#include <utility>
#include <vector>

#include <mitsuba/core/logger.h>
#include <mitsuba/core/properties.h>

namespace mitsuba {

/// What a property may be, and how a scene says it.
template <typename Value> using Names = std::vector<std::pair<const char *, Value>>;

template <typename Value>
const char *name_of(const Names<Value> &names, const std::common_type_t<Value> &value) {
    for (const auto &[name, candidate] : names)
        if (candidate == value)
            return name;
    return "";
}

/// Reads a property; an unknown name is an error that lists the known ones.
template <typename Value>
Value one_of(const Properties &props, const char *property, const Names<Value> &names,
             const std::common_type_t<Value> &otherwise) {
    const auto given = props.get<std::string>(property, name_of(names, otherwise));
    std::string known;
    for (const auto &[name, value] : names) {
        if (given == name)
            return value;
        known += (known.empty() ? "" : ", ") + std::string(name);
    }
    Throw("\"%s\" must be one of %s, got \"%s\"", property, known, given);
}

} // namespace mitsuba
