// What a medium does to light: extinction and albedo, in one of two ways to state them.

#pragma once

#include <mitsuba/core/plugin.h>
#include <mitsuba/core/properties.h>
#include <mitsuba/core/string.h>
#include <mitsuba/render/interaction.h>
#include <mitsuba/render/texture.h>
#include <mitsuba/render/volume.h>

#include "traverse.h"

namespace mitsuba {

template <typename Float, typename Spectrum> class Coefficients {
public:
    MI_IMPORT_TYPES(Texture, Volume)

    /// Reads `sigma_t` and `albedo`, or `sigma_a` and `sigma_s`; and `scale`.
    Coefficients(const Properties &props) {
        const bool by_parts = props.has_property("sigma_a") || props.has_property("sigma_s");
        if (by_parts) {
            for (const char *name : { "sigma_t", "albedo" })
                if (props.has_property(name))
                    Throw("\"%s\" and \"%s\" exclude each other: give sigma_t and albedo, or "
                          "sigma_a and sigma_s",
                          name, props.has_property("sigma_a") ? "sigma_a" : "sigma_s");
            for (const char *name : { "sigma_a", "sigma_s" })
                if (!props.has_property(name))
                    Throw("\"%s\" is missing: sigma_a and sigma_s go together", name);
            m_sigma_a = uniform(props, "sigma_a", 0.f);
            m_sigma_s = uniform(props, "sigma_s", 0.f);
            m_chromatic = !is_float(props, "sigma_a") || !is_float(props, "sigma_s");
        } else {
            m_sigma_t = uniform(props, "sigma_t", 1.f);
            m_albedo = quantity(props, "albedo", 0.75f, 1.f);
            m_chromatic = !is_float(props, "sigma_t");
        }
        const auto scale = props.get<ScalarFloat>("scale", 1.f);
        check("scale", scale, dr::Infinity<double>);
        m_scale = scale;
        update();
        m_scatters = (m_albedo ? m_albedo : m_sigma_s)->max() > 0.f;
    }

    /// Whether a scene states the extinction by colour or wavelength.
    bool chromatic() const { return m_chromatic; }
    /// False if a scene gives the albedo 0, and has not changed anything since.
    bool scatters() const { return m_scatters; }

    void traverse(TraversalCallback *cb) {
        cb->put("scale", m_scale, ParamFlags::Differentiable);
        if (m_sigma_t) {
            cb->put("sigma_t", m_sigma_t, ParamFlags::Differentiable);
            cb->put("albedo", m_albedo, ParamFlags::Differentiable);
        } else {
            cb->put("sigma_a", m_sigma_a, ParamFlags::Differentiable);
            cb->put("sigma_s", m_sigma_s, ParamFlags::Differentiable);
        }
    }

    /// Keeps the scale out of compiled kernels; scalar variants check it.
    void update() {
        if constexpr (dr::is_jit_v<Float>)
            dr::make_opaque(m_scale);
        else
            check("scale", m_scale, dr::Infinity<double>);
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
            return m_albedo->eval(it, active);
        UnpolarizedSpectrum scattered = m_sigma_s->eval(it, active),
                            lost = scattered + m_sigma_a->eval(it, active);
        return dr::select(lost > 0.f, scattered / lost, 0.f);
    }

    std::string to_string() const {
        std::ostringstream oss;
        auto line = [&](const char *name, const auto &value) {
            oss << "  " << name << " = " << string::indent(value) << "," << std::endl;
        };
        if (m_sigma_t) {
            line("sigma_t", m_sigma_t);
            line("albedo", m_albedo);
        } else {
            line("sigma_a", m_sigma_a);
            line("sigma_s", m_sigma_s);
        }
        oss << "  scale = " << dr::slice(dr::detach(m_scale)) << "," << std::endl;
        return oss.str();
    }

    AM_TRAVERSE_MEMBERS(m_sigma_t, m_albedo, m_sigma_a, m_sigma_s, m_scale)

private:
    /// Whether the extinction is the same for every ray, and cheaper to keep than to ask for:
    /// volumes make up a surface for their texture each time.
    static constexpr bool Remembers = !dr::is_jit_v<Float> && !is_spectral_v<Spectrum>;

    template <typename Interaction>
    UnpolarizedSpectrum evaluate(const Interaction &it, Mask active) const {
        if (m_sigma_t)
            return m_scale * m_sigma_t->eval(it, active);
        return m_scale * (m_sigma_a->eval(it, active) + m_sigma_s->eval(it, active));
    }

    static bool is_float(const Properties &props, const char *name) {
        return !props.has_property(name) || props.type(name) == Properties::Type::Float ||
               props.type(name) == Properties::Type::Integer;
    }

    static void check(const char *name, double value, double max) {
        if (value >= 0.0 && value <= max && dr::isfinite(value))
            return;
        if (dr::isfinite(max))
            Throw("%s must be between 0 and %g, got %g", name, max, value);
        Throw("%s must be finite and >= 0, got %g", name, value);
    }

    /// A quantity with values between 0 and `max`.
    static ref<Volume> quantity(const Properties &props, const char *name, ScalarFloat otherwise,
                                double max) {
        if (props.has_property(name) && is_float(props, name))
            check(name, props.get<ScalarFloat>(name), max);
        if (props.has_property(name) && props.type(name) == Properties::Type::Color) {
            auto colour = props.get<Color<double, 3>>(name);
            for (size_t i = 0; i < 3; ++i)
                check(name, colour[i], max);
        }
        if (props.has_property(name) && props.type(name) == Properties::Type::Spectrum) {
            for (double value : props.get<Properties::Spectrum>(name).values)
                check(name, value, max);
        }
        ref<Volume> volume = load(props, name, otherwise, !dr::isfinite(max));
        check(name, volume->max(), max);
        return volume;
    }

    /// A volume from what a scene gives: float, colour, spectrum, texture or volume.
    static ref<Volume> load(const Properties &props, const char *name, ScalarFloat otherwise,
                            bool unbounded) {
        const bool coloured =
            props.has_property(name) && (props.type(name) == Properties::Type::Color ||
                                         props.type(name) == Properties::Type::Spectrum);
        if (!coloured || !unbounded)
            return props.get_volume<Volume>(name, otherwise);
        // get_volume() takes every colour for a reflectance: it refuses or clamps what exceeds 1.
        Properties volume("constvolume");
        volume.set("value", ref<Object>(props.get_unbounded_texture<Texture>(name)));
        return PluginManager::instance()->create_object<Volume>(volume);
    }

    /// A quantity that is constant in space.
    static ref<Volume> uniform(const Properties &props, const char *name, ScalarFloat otherwise) {
        ref<Volume> volume = quantity(props, name, otherwise, dr::Infinity<double>);
        if (volume->class_name() != "ConstVolume")
            Throw("%s must be constant in space (float, rgb or spectrum), got %s: variation in "
                  "space belongs to the profile",
                  name, volume->class_name());
        return volume;
    }

    ref<Volume> m_sigma_t, m_albedo, m_sigma_a, m_sigma_s;
    Float m_scale;
    bool m_chromatic = false;
    bool m_scatters = true;
    /// Extinction at relative density 1, in scalar variants without wavelengths.
    UnpolarizedSpectrum m_remembered;
};

} // namespace mitsuba
