// A quantity in a scene: a float, a colour, a spectrum, a texture or a volume.

#pragma once

#include <functional>
#include <string>
#include <vector>

#include <mitsuba/core/plugin.h>
#include <mitsuba/core/properties.h>
#include <mitsuba/core/spectrum.h>
#include <mitsuba/core/string.h>
#include <mitsuba/render/texture.h>
#include <mitsuba/render/volume.h>

#include "traverse.h"

namespace mitsuba {

template <typename Float, typename Spectrum> class Quantity {
public:
    MI_IMPORT_TYPES(Texture, Volume)

    /// What is wrong with a value: empty if nothing is.
    using Check = std::function<std::string(double)>;

    /// Stands for what a medium does not have.
    Quantity() = default;

    /// Reads `name`, or takes it for `otherwise`. `bounded`: no value exceeds 1.
    Quantity(const Properties &props, const char *name, double otherwise, bool bounded, Check check)
        : m_name(name), m_check(std::move(check)), m_grey(is_number(props, name)) {
        check_given(props);
        if (m_grey)
            m_volume = constant(is_given(props) ? props.get<double>(name) : otherwise);
        else if (is_given(props, Properties::Type::Color) && !bounded)
            m_volume = constant(colour(props));
        else if (is_given(props, Properties::Type::Spectrum) && !bounded)
            // get_volume() takes it for a reflectance: it refuses or clamps what exceeds 1.
            m_volume = constant(ref<Object>(props.get_unbounded_texture<Texture>(name)));
        else
            m_volume = props.get_volume<Volume>(name);
        check_value();
    }

    explicit operator bool() const { return m_volume; }
    /// Whether it is the same at all wavelengths because a scene gives a number.
    bool grey() const { return m_grey; }
    ScalarFloat max() const { return m_factor * m_volume->max(); }

    template <typename Interaction>
    UnpolarizedSpectrum eval(const Interaction &it, Mask active) const {
        return m_factor * m_volume->eval(it, active);
    }

    /// Throws if the largest value is out of range.
    void check_value() const { require(m_check(max())); }

    /// Throws unless it is the same everywhere.
    void require_uniform() const {
        if (m_volume->class_name() != "ConstVolume")
            Throw("%s must be constant in space (float, rgb or spectrum), got %s: variation in "
                  "space belongs to the profile",
                  m_name, m_volume->class_name());
    }

    void traverse(TraversalCallback *cb) { cb->put(m_name, m_volume, ParamFlags::Differentiable); }

    /// A line for to_string().
    std::string to_string() const {
        std::ostringstream oss;
        oss << "  " << m_name << " = ";
        if (m_factor != 1.f)
            oss << m_factor << " * ";
        oss << string::indent(m_volume) << "," << std::endl;
        return oss.str();
    }

    AM_TRAVERSE_MEMBERS(m_volume)

private:
    static bool is_number(const Properties &props, const char *name) {
        return !props.has_property(name) || props.type(name) == Properties::Type::Float ||
               props.type(name) == Properties::Type::Integer;
    }

    bool is_given(const Properties &props) const { return props.has_property(m_name); }

    bool is_given(const Properties &props, Properties::Type type) const {
        return is_given(props) && props.type(m_name) == type;
    }

    static void require(const std::string &problem) {
        if (!problem.empty())
            Throw("%s", problem);
    }

    /// Checks every number of a scene; of others, that is textures, the largest value is known.
    void check_given(const Properties &props) const {
        if (is_given(props) && m_grey)
            require(m_check(props.get<double>(m_name)));
        if (is_given(props, Properties::Type::Color)) {
            const auto colour = props.get<Color<double, 3>>(m_name);
            for (size_t i = 0; i < 3; ++i)
                require(m_check(colour[i]));
        }
        if (is_given(props, Properties::Type::Spectrum))
            check_spectrum(props.get<Properties::Spectrum>(m_name));
    }

    void check_spectrum(const Properties::Spectrum &spectrum) const {
        for (double value : spectrum.values)
            require(m_check(value));
        if (!is_spectral_v<Spectrum> || spectrum.is_uniform())
            return;
        const double first = spectrum.wavelengths.front(), last = spectrum.wavelengths.back();
        const std::string problem = m_check(0.0);
        if ((first > MI_CIE_MIN || last < MI_CIE_MAX) && !problem.empty())
            Throw("%s outside of the wavelengths of its spectrum, %g to %g nm: give %g to %g nm",
                  problem, first, last, (double) MI_CIE_MIN, (double) MI_CIE_MAX);
    }

    /// The volume that has a number, or a texture, everywhere.
    template <typename Value> static ref<Volume> constant(Value value) {
        Properties props("constvolume");
        props.set("value", std::move(value));
        return PluginManager::instance()->create_object<Volume>(props);
    }

    /// The texture of a colour without bounds.
    ref<Object> colour(const Properties &props) {
        const auto colour = props.get<Color<double, 3>>(m_name);
        const double peak = dr::max(colour);
        // Spectra that stand for colours are those of reflectances, and none of the darkest.
        if (!is_spectral_v<Spectrum> || peak == 0.0 || (peak >= 1e-5 && peak <= 1.0))
            return ref<Object>(props.get_unbounded_texture<Texture>(m_name));
        m_factor = (ScalarFloat) peak;
        Properties srgb("srgb");
        srgb.set("color", colour / peak);
        return ref<Object>(PluginManager::instance()->create_object<Texture>(srgb));
    }

    const char *m_name = nullptr;
    Check m_check;
    bool m_grey = true;
    ref<Volume> m_volume;
    /// What values of the volume are multiplied by.
    ScalarFloat m_factor = 1.f;
};

} // namespace mitsuba
