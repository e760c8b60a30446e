// Functions of numbers of the C ABI, in the arithmetic of a variant.

#pragma once

#include <string>

#include <mitsuba/core/logger.h>

#include "bridge.h"

namespace mitsuba {

/// A function of one or more numbers; made by AM_FUNCTION.
template <typename F64, typename F32, typename Record> struct Function {
    F64 f64;
    F32 f32;
    Record record;

    /// What is wrong with arguments: name, range and value. Empty if nothing is.
    template <typename... Numbers> std::string problem(Numbers... x) const {
        double value = 0.0;
        return f64(x..., &value) == AM_STATUS_OK ? "" : am_last_error();
    }

    /// The value for arguments in their range.
    template <typename Float, typename... Floats>
    Float number(const Float &first, const Floats &...rest) const {
        if constexpr (dr::is_jit_v<Float>) {
            Tape<Float> tape;
            am_node out = 0;
            tape.finish(record(tape.table(), tape.input(first), tape.input(rest)..., &out));
            return tape[out];
        } else {
            float value = 0.f;
            f32(first, rest..., &value);
            return value;
        }
    }

    /// The value in every channel.
    template <typename Channels, typename... Others>
    Channels channels(const Channels &first, const Others &...rest) const {
        Channels result;
        for (size_t i = 0; i < dr::size_v<Channels>; ++i)
            result[i] = number(first[i], rest[i]...);
        return result;
    }
};

template <typename F64, typename F32, typename Record>
Function(F64, F32, Record) -> Function<F64, F32, Record>;

/// The function `name` of the C ABI, without its forms.
#define AM_FUNCTION(name)                                                                          \
    mitsuba::Function { name##_f64, name##_f32, name##_record }

} // namespace mitsuba
