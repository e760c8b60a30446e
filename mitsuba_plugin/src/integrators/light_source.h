// Light sources whose scattered light is a formula: what they are, read from the emitters of a
// scene.

#pragma once

#include <map>
#include <string>
#include <string_view>
#include <typeinfo>

#include <mitsuba/core/object.h>
#include <mitsuba/core/transform.h>
#include <mitsuba/render/emitter.h>
#include <mitsuba/render/texture.h>

namespace mitsuba {

/// The parameters of an object by name, as its `traverse` exposes them.
class Exposed final : public TraversalCallback {
public:
    explicit Exposed(Object *object) : m_object(object) { object->traverse(this); }

    /// The parameter `name`, which must be there, and of this type.
    template <typename T> const T &value(std::string_view name) const {
        auto found = m_values.find(name);
        if (found == m_values.end() || *found->second.type != typeid(T))
            Throw("%s \"%s\" has no parameter \"%s\" of the type that is known of it",
                  m_object->class_name(), m_object->id(), name);
        return *static_cast<const T *>(found->second.value);
    }

    /// The nested object `name`, which must be there.
    template <typename T> const T *object(std::string_view name) const {
        auto found = m_objects.find(name);
        auto *object = found == m_objects.end() ? nullptr : dynamic_cast<T *>(found->second);
        if (!object)
            Throw("%s \"%s\" has no object \"%s\" of the class that is known of it",
                  m_object->class_name(), m_object->id(), name);
        return object;
    }

protected:
    void put_value(std::string_view name, void *value, uint32_t,
                   const std::type_info &type) override {
        m_values.emplace(name, Value{ value, &type });
    }
    void put_object(std::string_view name, Object *value, uint32_t) override {
        m_objects.emplace(name, value);
    }

private:
    struct Value {
        const void *value;
        const std::type_info *type;
    };
    Object *m_object;
    std::map<std::string, Value, std::less<>> m_values;
    std::map<std::string, Object *, std::less<>> m_objects;
};

/// A light source: `point`, `spot` or `directional`.
template <typename Float, typename Spectrum> struct LightSource {
    MI_IMPORT_TYPES(Emitter, Texture)

    enum class Kind { Point, Spot, Directional };

    Kind kind = Kind::Point;
    Emitter *emitter = nullptr;
    /// Where it is, unless it is directional.
    Point3f position = 0.f;
    /// Where it shines, unless it is a point.
    Vector3f axis = Vector3f(0.f, 0.f, 1.f);
    /// Angles of a spot from its axis, in radians: up to the beam's width it has its full
    /// intensity, beyond the cutoff none.
    Float beam_width = 0.f, cutoff = 0.f;

    /// Reads an emitter; others than the known ones are an error.
    explicit LightSource(Emitter *source) : emitter(source) {
        const std::string_view name = source->class_name();
        if (name == "PointLight") {
            const Exposed exposed(source);
            kind = Kind::Point;
            position = exposed.template value<Point3f>("position");
            m_spectrum = exposed.template object<Texture>("intensity");
        } else if (name == "SpotLight") {
            const Exposed exposed(source);
            if (exposed.template object<Texture>("texture")->is_spatially_varying())
                Throw("airlight: the spot light \"%s\" projects a texture, which it cannot render",
                      source->id());
            kind = Kind::Spot;
            const auto &to_world = exposed.template value<AffineTransform4f>("to_world");
            position = Point3f(to_world.translation());
            axis = dr::normalize(to_world * Vector3f(0.f, 0.f, 1.f));
            beam_width = dr::deg_to_rad(exposed.template value<Float>("beam_width"));
            cutoff = dr::deg_to_rad(exposed.template value<Float>("cutoff_angle"));
            m_spectrum = exposed.template object<Texture>("intensity");
        } else if (name == "DirectionalEmitter") {
            const Exposed exposed(source);
            kind = Kind::Directional;
            axis = dr::normalize(exposed.template value<AffineTransform4f>("to_world") *
                                 Vector3f(0.f, 0.f, 1.f));
            m_spectrum = exposed.template object<Texture>("irradiance");
        } else {
            Throw("airlight: cannot render the light of %s \"%s\"; it knows the emitters point, "
                  "spot and directional",
                  name, source->id());
        }
    }

    bool directional() const { return kind == Kind::Directional; }

    /// Intensity in the direction where it is greatest, or irradiance of a directional light.
    UnpolarizedSpectrum spectrum(const Wavelength &wavelengths, Mask active) const {
        SurfaceInteraction3f si = dr::zeros<SurfaceInteraction3f>();
        si.wavelengths = wavelengths;
        return m_spectrum->eval(si, active);
    }

    /// From a place in the medium up to the light, at the time and the wavelengths of `like`.
    Ray3f ray_from(const Point3f &p, const Ray3f &like) const {
        if (directional())
            return Ray3f(p, -axis, like.time, like.wavelengths);
        const Vector3f way = position - p;
        const Float distance = dr::norm(way);
        return Ray3f(p, way / distance, distance * (1.f - math::ShadowEpsilon<Float>), like.time,
                     like.wavelengths);
    }

private:
    const Texture *m_spectrum = nullptr;
};

} // namespace mitsuba
