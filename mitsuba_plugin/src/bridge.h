// The host side of the recorder: a tape of Dr.Jit variables that Rust formulas are recorded on.
//
// Rust calls back through am_host_table for every operation and holds slot numbers only, so
// reference counts stay on this side and a recording is released with its tape. An exception
// must not cross Rust frames: the tape keeps the first one, returns the poison slot 0 from then
// on, and throws it again once Rust has returned.

#pragma once

#include <array>
#include <exception>
#include <vector>

#include <analytic_media.h>
#include <drjit/autodiff.h>
#include <drjit/math.h>

namespace mitsuba {

namespace dr = drjit;

/// Numbers and masks in the order in which they were recorded.
template <typename Float> class Tape {
public:
    using Mask = dr::mask_t<Float>;
    using ScalarFloat = dr::scalar_t<Float>;

    Tape() : m_numbers(1, Float(0)), m_masks(1, Mask(false)), m_table(make_table(this)) {}
    Tape(const Tape &) = delete;
    Tape &operator=(const Tape &) = delete;

    const am_host_table *table() const { return &m_table; }

    /// A new slot that holds `value`.
    am_node input(const Float &value) {
        return keep(m_numbers, [&] { return value; });
    }

    /// New slots that hold the components of a vector, or channels.
    template <typename Array> auto inputs(const Array &values) {
        std::array<am_node, dr::size_v<Array>> slots;
        for (size_t i = 0; i < slots.size(); ++i)
            slots[i] = input(values[i]);
        return slots;
    }

    /// The number in a slot.
    const Float &operator[](am_node slot) const { return m_numbers[slot]; }

    /// Throws what went wrong while recording, if anything did.
    void finish(am_status status) const {
        if (m_error)
            std::rethrow_exception(m_error);
        if (status != AM_STATUS_OK)
            throw std::runtime_error(std::string("analytic-media: ") + am_last_error());
    }

private:
    template <typename T, typename Operation>
    am_node keep(std::vector<T> &slots, Operation &&operation) noexcept {
        if (m_error)
            return 0;
        try {
            slots.push_back(operation());
            return (am_node) slots.size() - 1;
        } catch (...) {
            m_error = std::current_exception();
            return 0;
        }
    }

    /// Entry of the table for an operation on numbers.
    template <typename Operation, typename... Slots>
    static am_node number(void *tape, Operation &&operation, Slots... slots) noexcept {
        Tape &t = *static_cast<Tape *>(tape);
        return t.keep(t.m_numbers, [&]() -> Float { return operation(t.m_numbers[slots]...); });
    }

    /// Entry of the table for a comparison.
    template <typename Operation>
    static am_node compare(void *tape, Operation &&operation, am_node a, am_node b) noexcept {
        Tape &t = *static_cast<Tape *>(tape);
        return t.keep(t.m_masks,
                      [&]() -> Mask { return operation(t.m_numbers[a], t.m_numbers[b]); });
    }

    /// Entry of the table for an operation on masks.
    template <typename Operation, typename... Slots>
    static am_node logic(void *tape, Operation &&operation, Slots... slots) noexcept {
        Tape &t = *static_cast<Tape *>(tape);
        return t.keep(t.m_masks, [&]() -> Mask { return operation(t.m_masks[slots]...); });
    }

    static am_host_table make_table(Tape *tape) {
        using F = const Float &;
        using M = const Mask &;
        using Slot = am_node;
        am_host_table table{};
        table.tape = tape;
        table.digits = std::numeric_limits<ScalarFloat>::digits;
        table.literal = [](void *t, double value) noexcept {
            return number(t, [value] { return Float((ScalarFloat) value); });
        };
        table.neg = [](void *t, Slot a) noexcept { return number(t, [](F x) { return -x; }, a); };
        table.abs = [](void *t, Slot a) noexcept {
            return number(t, [](F x) { return dr::abs(x); }, a);
        };
        table.sqrt = [](void *t, Slot a) noexcept {
            return number(t, [](F x) { return dr::sqrt(x); }, a);
        };
        table.exp = [](void *t, Slot a) noexcept {
            return number(t, [](F x) { return dr::exp(x); }, a);
        };
        table.log = [](void *t, Slot a) noexcept {
            return number(t, [](F x) { return dr::log(x); }, a);
        };
        table.detach = [](void *t, Slot a) noexcept {
            return number(t, [](F x) { return Float(dr::detach(x)); }, a);
        };
        table.add = [](void *t, Slot a, Slot b) noexcept {
            return number(t, [](F x, F y) { return x + y; }, a, b);
        };
        table.sub = [](void *t, Slot a, Slot b) noexcept {
            return number(t, [](F x, F y) { return x - y; }, a, b);
        };
        table.mul = [](void *t, Slot a, Slot b) noexcept {
            return number(t, [](F x, F y) { return x * y; }, a, b);
        };
        table.div = [](void *t, Slot a, Slot b) noexcept {
            return number(t, [](F x, F y) { return x / y; }, a, b);
        };
        table.min = [](void *t, Slot a, Slot b) noexcept {
            return number(t, [](F x, F y) { return dr::minimum(x, y); }, a, b);
        };
        table.max = [](void *t, Slot a, Slot b) noexcept {
            return number(t, [](F x, F y) { return dr::maximum(x, y); }, a, b);
        };
        table.fma = [](void *t, Slot a, Slot b, Slot c) noexcept {
            return number(t, [](F x, F y, F z) { return dr::fmadd(x, y, z); }, a, b, c);
        };
        table.less = [](void *t, Slot a, Slot b) noexcept {
            return compare(t, [](F x, F y) { return x < y; }, a, b);
        };
        table.less_equal = [](void *t, Slot a, Slot b) noexcept {
            return compare(t, [](F x, F y) { return x <= y; }, a, b);
        };
        table.mask_and = [](void *t, Slot p, Slot q) noexcept {
            return logic(t, [](M x, M y) { return x & y; }, p, q);
        };
        table.mask_or = [](void *t, Slot p, Slot q) noexcept {
            return logic(t, [](M x, M y) { return x | y; }, p, q);
        };
        table.mask_not = [](void *t, Slot p) noexcept {
            return logic(t, [](M x) { return !x; }, p);
        };
        table.select = [](void *t, Slot p, Slot a, Slot b) noexcept {
            const Mask &mask = static_cast<Tape *>(t)->m_masks[p];
            return number(t, [&](F x, F y) { return dr::select(mask, x, y); }, a, b);
        };
        return table;
    }

    std::vector<Float> m_numbers;
    std::vector<Mask> m_masks;
    std::exception_ptr m_error;
    am_host_table m_table;
};

} // namespace mitsuba
