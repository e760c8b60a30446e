// Variables in the parts of an object, which are classes that Dr.Jit knows nothing of.

#pragma once

#include <drjit/traversable_base.h>

/// Shows members to Dr.Jit, which keeps track of the variables that objects hold: frozen functions
/// need to know them all. No templates: Dr.Jit would not find them, and say nothing. No std::vector
/// of variables: it would change copies of the elements.
#define AM_TRAVERSE_MEMBERS(...)                                                                   \
public:                                                                                            \
    void traverse_1_cb_ro(void *payload, drjit::detail::traverse_callback_ro fn) const {           \
        DRJIT_MAP(DR_TRAVERSE_MEMBER_RO, __VA_ARGS__)                                              \
    }                                                                                              \
    void traverse_1_cb_rw(void *payload, drjit::detail::traverse_callback_rw fn) {                 \
        DRJIT_MAP(DR_TRAVERSE_MEMBER_RW, __VA_ARGS__)                                              \
    }
