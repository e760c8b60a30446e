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
#include "traverse.h"

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
        for (const Parameter &parameter : m_parameters)
            read(props, parameter);
        if constexpr (dr::is_jit_v<Float>) {
            am_profile checked = values();
            require(am_profile_check(&checked));
        }
        update();
    }

    /// Name of the kind, as in a scene.
    const std::string &name() const { return m_name; }

    /// The parameters as slots of `tape`; for JIT variants.
    am_profile_nodes record_parameters(Tape<Float> &tape) const {
        am_profile_nodes profile{};
        profile.kind = m_kind;
        for (const Parameter &p : m_parameters)
            for (uint32_t i = 0; i < p.size; ++i)
                profile.values[p.offset + i] = tape.input(value(p, i));
        return profile;
    }
    /// The parameters as plain data; for scalar variants.
    const am_profile &plain() const { return m_profile; }

    /// Exposes every parameter under its own name.
    void traverse(TraversalCallback *cb) {
        for (const Parameter &p : m_parameters) {
            if (p.size == 3)
                cb->put(p.name, m_vectors[p.index], ParamFlags::Differentiable);
            else
                cb->put(p.name, m_scalars[p.index], ParamFlags::Differentiable);
        }
    }

    /// After a change of parameters: keeps them out of compiled kernels; scalar variants check
    /// them.
    void update() {
        if constexpr (dr::is_jit_v<Float>) {
            // One by one: dr::make_opaque() does not look into arrays of C++.
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
        return along(am_profile_column_record, am_profile_column_f32, o, d, t);
    }

    /// Distance at which the ray has gathered `column`, infinite if it never does.
    Float inv_column(const Point3f &o, const Vector3f &d, const Float &column) const {
        return along(am_profile_inv_column_record, am_profile_inv_column_f32, o, d, column);
    }

    /// The same for a column that the ray is known to gather.
    Float inv_reached_column(const Point3f &o, const Vector3f &d, const Float &column) const {
        return along(am_profile_inv_reached_column_record, am_profile_inv_reached_column_f32, o, d,
                     column);
    }

    /// Distance, at most `t_max`, at which a sum of profiles has gathered the optical depth `tau`:
    /// each with its extinction coefficient at density 1. Infinite if it gathers less.
    static Float free_flight(const std::vector<const Profile *> &profiles,
                             const std::vector<Float> &sigma_t, const Point3f &o, const Vector3f &d,
                             const Float &t_max, const Float &tau) {
        if constexpr (dr::is_jit_v<Float>) {
            Tape<Float> tape;
            std::vector<am_profile_nodes> parts;
            std::vector<am_node> coefficients;
            for (size_t i = 0; i < profiles.size(); ++i) {
                parts.push_back(profiles[i]->record_parameters(tape));
                coefficients.push_back(tape.input(sigma_t[i]));
            }
            const am_medium_nodes sum{ parts.data(), coefficients.data(), parts.size(), 1 };
            const auto origin = tape.inputs(o), direction = tape.inputs(d);
            am_node t = 0;
            tape.finish(am_medium_free_flight_record(tape.table(), &sum, 0, origin.data(),
                                                     direction.data(), tape.input(t_max),
                                                     tape.input(tau), &t));
            return tape[t];
        } else {
            std::vector<am_profile> parts;
            for (const Profile *profile : profiles)
                parts.push_back(profile->m_profile);
            const std::vector<double> coefficients(sigma_t.begin(), sigma_t.end());
            const am_medium sum{ parts.data(), coefficients.data(), parts.size(), 1 };
            float t = 0.f;
            am_medium_free_flight_f32(&sum, 0, o.data(), d.data(), t_max, tau, &t);
            return t;
        }
    }

    /// Supremum of the density in a box.
    Float max_in_box(const Point3f &lo, const Point3f &hi) const {
        if constexpr (dr::is_jit_v<Float>) {
            Tape<Float> tape;
            am_profile_nodes profile = record_parameters(tape);
            const auto a = tape.inputs(lo), b = tape.inputs(hi);
            am_node inf = 0, sup = 0;
            tape.finish(am_profile_bounds_in_box_record(tape.table(), &profile, a.data(), b.data(),
                                                        &inf, &sup));
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
        for (const Parameter &p : m_parameters) {
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

    AM_TRAVERSE_MEMBERS(m_scalars, m_vectors)

private:
    static void require(am_status status) {
        if (status != AM_STATUS_OK)
            Throw("%s", am_last_error());
    }

    /// A parameter, and which of the scalars or of the vectors it is.
    struct Parameter : am_parameter {
        uint32_t index;
    };

    static std::vector<Parameter> describe(uint32_t kind) {
        char name[AM_NAME_SIZE];
        uint32_t count = 0, scalars = 0, vectors = 0;
        require(am_profile_describe(kind, &name, &count));
        std::vector<Parameter> parameters(count);
        for (uint32_t i = 0; i < count; ++i) {
            require(am_profile_parameter(kind, i, &parameters[i]));
            parameters[i].index = parameters[i].size == 3 ? vectors++ : scalars++;
        }
        return parameters;
    }

    /// A parameter of another profile is an error, not a leftover.
    void refuse_foreign(const Properties &props) const {
        char name[AM_NAME_SIZE];
        uint32_t count = 0;
        for (uint32_t kind = 0; am_profile_describe(kind, &name, &count) == AM_STATUS_OK; ++kind) {
            for (const Parameter &foreign : describe(kind)) {
                auto known = [&](const Parameter &p) { return !strcmp(p.name, foreign.name); };
                if (props.has_property(foreign.name) &&
                    std::none_of(m_parameters.begin(), m_parameters.end(), known))
                    Throw("profile \"%s\" has no parameter \"%s\"; it has %s", m_name, foreign.name,
                          parameter_names());
            }
        }
    }

    std::string parameter_names() const {
        std::string names;
        for (const Parameter &parameter : m_parameters)
            names += (names.empty() ? "" : ", ") + std::string(parameter.name);
        return names.empty() ? "none" : names;
    }

    void read(const Properties &props, const Parameter &p) {
        if (p.required && !props.has_property(p.name))
            Throw("profile \"%s\" needs the parameter \"%s\"", m_name, p.name);
        if (p.size == 3)
            m_vectors[p.index] = props.get<ScalarVector3f>(
                p.name, ScalarVector3f(p.defaults[0], p.defaults[1], p.defaults[2]));
        else
            m_scalars[p.index] = props.get<ScalarFloat>(p.name, (ScalarFloat) p.defaults[0]);
    }

    /// The value of a parameter, or a component of it.
    const Float &value(const Parameter &p, uint32_t i) const {
        return p.size == 3 ? m_vectors[p.index][i] : m_scalars[p.index];
    }

    /// The parameters as plain data. Reads JIT variables back: not for use while recording.
    am_profile values() const {
        am_profile profile{};
        profile.kind = m_kind;
        for (const Parameter &p : m_parameters)
            for (uint32_t i = 0; i < p.size; ++i)
                profile.values[p.offset + i] = dr::slice(dr::detach(value(p, i)));
        return profile;
    }

    /// A question about a point.
    template <typename Question> Float record(Question question, const Point3f &p) const {
        Tape<Float> tape;
        am_profile_nodes profile = record_parameters(tape);
        am_node out = 0;
        tape.finish(question(tape.table(), &profile, tape.inputs(p).data(), &out));
        return tape[out];
    }

    /// A question about a ray and a length, in both forms.
    template <typename Recorded, typename Scalar>
    Float along(Recorded recorded, Scalar scalar, const Point3f &o, const Vector3f &d,
                const Float &x) const {
        if constexpr (dr::is_jit_v<Float>) {
            Tape<Float> tape;
            am_profile_nodes profile = record_parameters(tape);
            const auto origin = tape.inputs(o), direction = tape.inputs(d);
            am_node out = 0;
            tape.finish(recorded(tape.table(), &profile, origin.data(), direction.data(),
                                 tape.input(x), &out));
            return tape[out];
        } else {
            float answer = 0.f;
            scalar(&m_profile, o.data(), d.data(), x, &answer);
            return answer;
        }
    }

    std::string m_name;
    uint32_t m_kind = 0;
    std::vector<Parameter> m_parameters;
    Float m_scalars[AM_PROFILE_VALUES];
    Vector3f m_vectors[AM_PROFILE_VALUES / 3];
    am_profile m_profile{};
};

} // namespace mitsuba
