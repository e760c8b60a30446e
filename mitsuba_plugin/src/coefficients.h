// What a medium does to light: extinction and albedo, in one of several ways to state them.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "functions.h"
#include "quantity.h"
#include "wavelengths.h"

namespace mitsuba {

template <typename Float, typename Spectrum> class Coefficients {
public:
    MI_IMPORT_TYPES()
    using Quantity = mitsuba::Quantity<Float, Spectrum>;

    /// Reads the parameters of one parametrisation; and `scale`.
    Coefficients(const Properties &props) : m_by(choose(props)) {
        const auto problem = m_by.formula.problem;
        m_first = read(props, m_by.first, [=](double x) { return problem(x, Valid); });
        if (m_by.second.name)
            m_second = read(props, m_by.second, [=](double y) { return problem(Valid, y); });
        if (m_by.parts()) {
            m_sigma_s = read(props, m_by.scattering, range("sigma_s", dr::Infinity<double>));
        } else {
            const Parameter &albedo = m_by.scattering;
            m_albedo = Quantity(props, albedo.name, albedo.otherwise, true, range("albedo", 1.0));
        }
        m_scale = props.get<ScalarFloat>("scale", 1.f);
        require_scale();
        update();
        m_scatters = (m_albedo ? m_albedo : m_sigma_s).max() > 0.f;
    }

    /// Whether a scene states the extinction by colour or wavelength.
    bool chromatic() const {
        return m_by.by_wavelength || !m_first.grey() || !m_second.grey() || !m_sigma_s.grey();
    }
    /// False if a scene gives the albedo 0, and has not changed anything since.
    bool scatters() const { return m_scatters; }

    void traverse(TraversalCallback *cb) {
        cb->put("scale", m_scale, ParamFlags::Differentiable);
        for (Quantity *quantity : { &m_first, &m_second, &m_albedo, &m_sigma_s })
            if (*quantity)
                quantity->traverse(cb);
    }

    /// Keeps the scale out of compiled kernels; scalar variants check it and the coefficients.
    void update() {
        if constexpr (dr::is_jit_v<Float>) {
            dr::make_opaque(m_scale);
        } else {
            require_scale();
            for (const Quantity *quantity : quantities())
                quantity->check_value();
        }
        if constexpr (Remembers)
            m_remembered = evaluate(dr::zeros<Interaction3f>(), true);
        // To look at a new albedo would be to wait for it.
        m_scatters = true;
    }

    /// Extinction coefficient at relative density 1.
    template <typename Interaction>
    UnpolarizedSpectrum sigma_t(const Interaction &it, Mask active) const {
        if constexpr (Remembers)
            return m_remembered;
        else
            return evaluate(it, active);
    }

    /// Single-scattering albedo, 0 where there is no extinction.
    template <typename Interaction>
    UnpolarizedSpectrum albedo(const Interaction &it, Mask active) const {
        if (m_albedo)
            return m_albedo.eval(it, active);
        const UnpolarizedSpectrum scattered = m_sigma_s.eval(it, active),
                                  lost = scattered + stated(it, active);
        return dr::select(lost > 0.f, scattered / lost, 0.f);
    }

    /// Throws unless the albedo is the same everywhere, as the other quantities are.
    void require_uniform() const {
        if (m_albedo)
            m_albedo.require_uniform();
    }

    std::string to_string() const {
        std::ostringstream oss;
        for (const Quantity *quantity : quantities())
            oss << quantity->to_string();
        oss << "  scale = " << dr::slice(dr::detach(m_scale)) << "," << std::endl;
        return oss.str();
    }

    AM_TRAVERSE_MEMBERS(m_first, m_second, m_albedo, m_sigma_s, m_scale)

private:
    /// Whether the extinction is the same for every ray, and cheaper to keep than to ask for:
    /// volumes make up a surface for their texture each time.
    static constexpr bool Remembers = !dr::is_jit_v<Float> && !is_spectral_v<Spectrum>;
    /// A value in the range of every argument of every formula.
    static constexpr double Valid = 0.5;

    /// A parameter, and what it is if a scene does not give it: NaN if it has to.
    struct Parameter {
        const char *name = nullptr;
        double otherwise = dr::NaN<double>;
    };

    /// The extinction, or the absorption beside sigma_s, from the first parameter and the second;
    /// where there is no second, from the wavelengths in nm.
    struct Formula {
        std::string (*problem)(double, double);
        UnpolarizedSpectrum (*value)(const UnpolarizedSpectrum &, const UnpolarizedSpectrum &);
    };

    struct Parametrisation {
        Parameter first, second, scattering;
        Formula formula;
        bool by_wavelength = false;

        bool has(const char *name) const {
            auto is = [&](const Parameter &p) { return p.name && !strcmp(p.name, name); };
            return is(first) || is(second) || is(scattering);
        }
        /// Whether absorption and scattering are stated, instead of extinction and albedo.
        bool parts() const { return !strcmp(scattering.name, "sigma_s"); }
        std::vector<Parameter> parameters() const {
            return second.name ? std::vector{ first, second, scattering }
                               : std::vector{ first, scattering };
        }
        /// The names of its parameters, for messages.
        std::string names() const {
            std::string names;
            for (const Parameter &p : parameters())
                names += (names.empty() ? "" : ", ") + std::string(p.name);
            return "(" + names + ")";
        }
    };

#define AM_OF_ONE(function)                                                                        \
    { [](double x, double) { return AM_FUNCTION(function).problem(x); },                           \
      [](const UnpolarizedSpectrum &x, const UnpolarizedSpectrum &) {                              \
          return AM_FUNCTION(function).channels(x);                                                \
      } }
#define AM_OF_TWO(function)                                                                        \
    { [](double x, double y) { return AM_FUNCTION(function).problem(x, y); },                      \
      [](const UnpolarizedSpectrum &x, const UnpolarizedSpectrum &y) {                             \
          return AM_FUNCTION(function).channels(x, y);                                             \
      } }
#define AM_AS_IT_IS(name)                                                                          \
    { [](double x, double) { return range(name, dr::Infinity<double>)(x); },                       \
      [](const UnpolarizedSpectrum &x, const UnpolarizedSpectrum &) { return x; } }

    /// All of them. The first is what a medium has that states nothing.
    static const std::vector<Parametrisation> &parametrisations() {
        const Parameter albedo{ "albedo", 0.75 }, sigma_s{ "sigma_s" }, none;
        static const std::vector<Parametrisation> all{
            { { "sigma_t", 1.0 }, none, albedo, AM_AS_IT_IS("sigma_t") },
            { { "sigma_a" }, none, sigma_s, AM_AS_IT_IS("sigma_a") },
            { { "mean_free_path" }, none, albedo, AM_OF_ONE(am_sigma_t_from_mean_free_path) },
            { { "transmittance" },
              { "at_distance" },
              albedo,
              AM_OF_TWO(am_sigma_t_from_transmittance) },
            { { "opacity" }, { "at_distance" }, albedo, AM_OF_TWO(am_sigma_t_from_opacity) },
            { { "visibility" },
              { "contrast", 0.05 },
              albedo,
              AM_OF_TWO(am_sigma_t_from_visibility) },
            { { "mass_density" }, { "mass_attenuation" }, albedo, AM_OF_TWO(am_sigma_t_from_mass) },
            { { "number_density" },
              { "cross_section" },
              albedo,
              AM_OF_TWO(am_sigma_t_from_number) },
            { { "extinction_index" },
              none,
              sigma_s,
              AM_OF_TWO(am_sigma_a_from_extinction_index),
              true },
        };
        return all;
    }

#undef AM_OF_ONE
#undef AM_OF_TWO
#undef AM_AS_IT_IS

    /// The parametrisation whose parameters a scene gives, and no others.
    static const Parametrisation &choose(const Properties &props) {
        const std::vector<const char *> names = given(props);
        for (const Parametrisation &one : parametrisations()) {
            if (!std::all_of(names.begin(), names.end(), [&](auto name) { return one.has(name); }))
                continue;
            for (const Parameter &p : one.parameters())
                if (!props.has_property(p.name) && std::isnan(p.otherwise))
                    Throw("\"%s\" is missing: %s go together", p.name, one.names());
            return one;
        }
        refuse(names);
    }

    /// Which of all parameters a scene gives.
    static std::vector<const char *> given(const Properties &props) {
        std::vector<const char *> names;
        auto is_new = [&](const char *name) {
            return std::none_of(names.begin(), names.end(),
                                [&](auto other) { return !strcmp(other, name); });
        };
        for (const Parametrisation &one : parametrisations())
            for (const Parameter &p : one.parameters())
                if (props.has_property(p.name) && is_new(p.name))
                    names.push_back(p.name);
        return names;
    }

    /// Names two that do not go together: where there are none, all of them do.
    [[noreturn]] static void refuse(const std::vector<const char *> &names) {
        std::string alternatives;
        for (const Parametrisation &one : parametrisations())
            alternatives += (alternatives.empty() ? "" : ", ") + one.names();
        for (const char *a : names)
            for (const char *b : names)
                if (std::none_of(parametrisations().begin(), parametrisations().end(),
                                 [&](const auto &one) { return one.has(a) && one.has(b); }))
                    Throw("\"%s\" and \"%s\" exclude each other: give one of %s", a, b,
                          alternatives);
        Throw("give one of %s", alternatives);
    }

    static typename Quantity::Check range(const char *name, double max) {
        return [name, max](double value) -> std::string {
            if (value >= 0.0 && value <= max && dr::isfinite(value))
                return "";
            if (dr::isfinite(max))
                return tfm::format("%s must be between 0 and %g, got %g", name, max, value);
            return tfm::format("%s must be finite and >= 0, got %g", name, value);
        };
    }

    /// A quantity that is the same everywhere.
    static Quantity read(const Properties &props, const Parameter &parameter,
                         typename Quantity::Check check) {
        Quantity quantity(props, parameter.name, parameter.otherwise, false, std::move(check));
        quantity.require_uniform();
        return quantity;
    }

    void require_scale() const {
        const std::string problem =
            range("scale", dr::Infinity<double>)(dr::slice(dr::detach(m_scale)));
        if (!problem.empty())
            Throw("%s", problem);
    }

    /// Those that the parametrisation has.
    std::vector<const Quantity *> quantities() const {
        std::vector<const Quantity *> quantities;
        for (const Quantity *quantity : { &m_first, &m_second, &m_albedo, &m_sigma_s })
            if (*quantity)
                quantities.push_back(quantity);
        return quantities;
    }

    template <typename Interaction>
    UnpolarizedSpectrum evaluate(const Interaction &it, Mask active) const {
        if (m_albedo)
            return m_scale * stated(it, active);
        return m_scale * (stated(it, active) + m_sigma_s.eval(it, active));
    }

    /// What the formula gives.
    template <typename Interaction>
    UnpolarizedSpectrum stated(const Interaction &it, Mask active) const {
        const UnpolarizedSpectrum second =
            m_second ? m_second.eval(it, active) : wavelengths<Spectrum>(it);
        return m_by.formula.value(m_first.eval(it, active), second);
    }

    const Parametrisation &m_by;
    Quantity m_first, m_second, m_albedo, m_sigma_s;
    Float m_scale;
    bool m_scatters = true;
    /// Extinction at relative density 1, in scalar variants without wavelengths.
    UnpolarizedSpectrum m_remembered;
};

} // namespace mitsuba
