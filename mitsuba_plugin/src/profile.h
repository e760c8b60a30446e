// A density profile in a scene: its parameters, and the questions of the C ABI to it.
//
// Names, order and defaults of the parameters come from the library, so a new profile needs no
// change here. Scalar variants call the formulas; JIT variants record them.

#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <mitsuba/core/properties.h>
#include <mitsuba/core/ray.h>

#include "bridge.h"

namespace mitsuba {

template <typename Float, typename Spectrum> class Profile {
public:
    MI_IMPORT_TYPES()

    /// Reads `profile` and its parameters from a scene.
    Profile(const Properties &props) {
        const std::string name = props.get<std::string>("profile", "constant");
        require(am_profile_kind(name.c_str(), &m_kind));
        m_name = name;
        m_parameters = describe(m_kind);
        refuse_foreign(props);
        for (const am_parameter &parameter : m_parameters)
            read(props, parameter);
        update();
        am_profile checked = values();
        require(am_profile_check(&checked));
    }

    /// Exposes every parameter under its own name.
    void traverse(TraversalCallback *cb) {
        size_t scalar = 0, vector = 0;
        for (const am_parameter &parameter : m_parameters) {
            if (parameter.size == 3)
                cb->put(parameter.name, m_vectors[vector++], ParamFlags::Differentiable);
            else
                cb->put(parameter.name, m_scalars[scalar++], ParamFlags::Differentiable);
        }
    }

    /// After a change of parameters: keeps them out of compiled kernels; scalar variants check
    /// them.
    void update() {
        if constexpr (dr::is_jit_v<Float>) {
            // One by one: dr::make_opaque() does not look into a std::vector.
            for (Float &scalar : m_scalars)
                dr::make_opaque(scalar);
            for (Vector3f &vector : m_vectors)
                dr::make_opaque(vector);
        } else {
            am_profile checked = values();
            require(am_profile_check(&checked));
            m_profile = checked;
        }
    }

    /// Relative density at `p`.
    Float density(const Point3f &p) const {
        if constexpr (dr::is_jit_v<Float>) {
            return record(am_profile_density_record, p);
        } else {
            float density = 0.f;
            am_profile_density_f32(&m_profile, p.data(), &density);
            return density;
        }
    }

    /// Integral of the density over the segment of length `t`, which may be infinite.
    Float column(const Point3f &o, const Vector3f &d, const Float &t) const {
        if constexpr (dr::is_jit_v<Float>) {
            return record(am_profile_column_record, o, d, t);
        } else {
            float column = 0.f;
            am_profile_column_f32(&m_profile, o.data(), d.data(), t, &column);
            return column;
        }
    }

    /// Distance at which the ray has gathered `column`, infinite if it never does.
    Float inv_column(const Point3f &o, const Vector3f &d, const Float &column) const {
        if constexpr (dr::is_jit_v<Float>) {
            return record(am_profile_inv_column_record, o, d, column);
        } else {
            float t = 0.f;
            am_profile_inv_column_f32(&m_profile, o.data(), d.data(), column, &t);
            return t;
        }
    }

    /// Supremum of the density in a box.
    Float max_in_box(const Point3f &lo, const Point3f &hi) const {
        if constexpr (dr::is_jit_v<Float>) {
            Tape<Float> tape;
            am_profile_nodes profile = record_parameters(tape);
            am_node a[3], b[3], inf = 0, sup = 0;
            slots(tape, lo, a);
            slots(tape, hi, b);
            tape.finish(am_profile_bounds_in_box_record(tape.table(), &profile, a, b, &inf, &sup));
            return tape[sup];
        } else {
            float inf = 0.f, sup = 0.f;
            am_profile_bounds_in_box_f32(&m_profile, lo.data(), hi.data(), &inf, &sup);
            return sup;
        }
    }

    /// Name and parameters with their values, a line each, for to_string().
    std::string to_string() const {
        std::ostringstream oss;
        oss << "  profile = \"" << m_name << "\"," << std::endl;
        const am_profile profile = values();
        for (const am_parameter &p : m_parameters) {
            const double *value = profile.values + p.offset;
            oss << "  " << p.name << " = ";
            if (p.size == 3)
                oss << "[" << value[0] << ", " << value[1] << ", " << value[2] << "]";
            else
                oss << value[0];
            oss << "," << std::endl;
        }
        return oss.str();
    }

    /// Shows the parameters to Dr.Jit, which keeps track of the variables that objects hold.
    template <typename Payload, typename Callback>
    void traverse_1_cb_ro(Payload *payload, Callback fn) const {
        dr::traverse_1_fn_ro(m_scalars, payload, fn);
        dr::traverse_1_fn_ro(m_vectors, payload, fn);
    }
    template <typename Payload, typename Callback>
    void traverse_1_cb_rw(Payload *payload, Callback fn) {
        dr::traverse_1_fn_rw(m_scalars, payload, fn);
        dr::traverse_1_fn_rw(m_vectors, payload, fn);
    }

private:
    static void require(am_status status) {
        if (status != AM_STATUS_OK)
            Throw("%s", am_last_error());
    }

    static std::vector<am_parameter> describe(uint32_t kind) {
        char name[AM_NAME_SIZE];
        uint32_t count = 0;
        require(am_profile_describe(kind, &name, &count));
        std::vector<am_parameter> parameters(count);
        for (uint32_t i = 0; i < count; ++i)
            require(am_profile_parameter(kind, i, &parameters[i]));
        return parameters;
    }

    /// A parameter of another profile is an error, not a leftover.
    void refuse_foreign(const Properties &props) const {
        char name[AM_NAME_SIZE];
        uint32_t count = 0;
        for (uint32_t kind = 0; am_profile_describe(kind, &name, &count) == AM_STATUS_OK; ++kind) {
            for (const am_parameter &foreign : describe(kind)) {
                auto known = [&](const am_parameter &p) { return !strcmp(p.name, foreign.name); };
                if (props.has_property(foreign.name) &&
                    std::none_of(m_parameters.begin(), m_parameters.end(), known))
                    Throw("profile \"%s\" has no parameter \"%s\"; it has %s", m_name, foreign.name,
                          parameter_names());
            }
        }
    }

    std::string parameter_names() const {
        std::string names;
        for (const am_parameter &parameter : m_parameters)
            names += (names.empty() ? "" : ", ") + std::string(parameter.name);
        return names.empty() ? "none" : names;
    }

    void read(const Properties &props, const am_parameter &p) {
        if (p.required && !props.has_property(p.name))
            Throw("profile \"%s\" needs the parameter \"%s\"", m_name, p.name);
        if (p.size == 3) {
            ScalarVector3f value(p.defaults[0], p.defaults[1], p.defaults[2]);
            m_vectors.push_back(props.get<ScalarVector3f>(p.name, value));
        } else {
            m_scalars.push_back(props.get<ScalarFloat>(p.name, (ScalarFloat) p.defaults[0]));
        }
    }

    /// The parameters as plain data. Reads JIT variables back: not for use while recording.
    am_profile values() const {
        am_profile profile{};
        profile.kind = m_kind;
        size_t scalar = 0, vector = 0;
        for (const am_parameter &p : m_parameters) {
            for (uint32_t i = 0; i < p.size; ++i) {
                const Float &value = p.size == 3 ? m_vectors[vector][i] : m_scalars[scalar];
                profile.values[p.offset + i] = dr::slice(dr::detach(value));
            }
            ++(p.size == 3 ? vector : scalar);
        }
        return profile;
    }

    am_profile_nodes record_parameters(Tape<Float> &tape) const {
        am_profile_nodes profile{};
        profile.kind = m_kind;
        size_t scalar = 0, vector = 0;
        for (const am_parameter &p : m_parameters) {
            for (uint32_t i = 0; i < p.size; ++i)
                profile.values[p.offset + i] =
                    tape.input(p.size == 3 ? m_vectors[vector][i] : m_scalars[scalar]);
            ++(p.size == 3 ? vector : scalar);
        }
        return profile;
    }

    template <typename Vector>
    static void slots(Tape<Float> &tape, const Vector &v, am_node (&out)[3]) {
        for (size_t i = 0; i < 3; ++i)
            out[i] = tape.input(v[i]);
    }

    /// A question about a point.
    template <typename Question> Float record(Question question, const Point3f &p) const {
        Tape<Float> tape;
        am_profile_nodes profile = record_parameters(tape);
        am_node point[3], out = 0;
        slots(tape, p, point);
        tape.finish(question(tape.table(), &profile, point, &out));
        return tape[out];
    }

    /// A question about a ray and a length.
    template <typename Question>
    Float record(Question question, const Point3f &o, const Vector3f &d, const Float &x) const {
        Tape<Float> tape;
        am_profile_nodes profile = record_parameters(tape);
        am_node origin[3], direction[3], out = 0;
        slots(tape, o, origin);
        slots(tape, d, direction);
        tape.finish(question(tape.table(), &profile, origin, direction, tape.input(x), &out));
        return tape[out];
    }

    std::string m_name;
    uint32_t m_kind = 0;
    std::vector<am_parameter> m_parameters;
    std::vector<Float> m_scalars;
    std::vector<Vector3f> m_vectors;
    am_profile m_profile{};
};

} // namespace mitsuba
