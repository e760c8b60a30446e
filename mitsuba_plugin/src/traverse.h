// Variables in the parts of an object, which are classes that Dr.Jit knows nothing of.

#pragma once

#include <drjit/traversable_base.h>

/// Shows members to Dr.Jit, which keeps track of the variables that objects hold. No std::vector
/// of variables: Dr.Jit would change copies of its elements.
#define AM_TRAVERSE_MEMBERS(...)                                                                   \
public:                                                                                            \
    template <typename Payload, typename Callback>                                                 \
    void traverse_1_cb_ro(Payload *payload, Callback fn) const {                                   \
        DRJIT_MAP(DR_TRAVERSE_MEMBER_RO, __VA_ARGS__)                                              \
    }                                                                                              \
    template <typename Payload, typename Callback>                                                 \
    void traverse_1_cb_rw(Payload *payload, Callback fn) {                                         \
        DRJIT_MAP(DR_TRAVERSE_MEMBER_RW, __VA_ARGS__)                                              \
    }
