// analytic-media for C++17: values instead of pointers, exceptions instead of status codes.
//
// Units, ranges and formulas are those of analytic_media.h. Questions take and return float
// or double; both precisions are computed in their own arithmetic. Batches take vectors that
// hold one item per ray, or a single item that serves all rays.

#ifndef ANALYTIC_MEDIA_HPP
#define ANALYTIC_MEDIA_HPP

#include "analytic_media.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace am {

// A call has failed; what() names argument, range and value.
class Error : public std::runtime_error {
public:
    Error(am_status status, const std::string &what) : std::runtime_error(what), m_status(status) {}
    am_status status() const noexcept { return m_status; }

private:
    am_status m_status;
};

// A point, a direction or an axis.
template <typename T> using Vector = std::array<T, 3>;

// Infimum and supremum.
template <typename T> struct Bounds {
    T inf, sup;
};

namespace detail {

inline void check(am_status status) {
    if (status != AM_STATUS_OK)
        throw Error(status, am_last_error());
}

// The functions and arrays of one precision.
template <typename T> struct Abi;

#define AM_DETAIL_QUESTION(name, suffix)                                                           \
    static constexpr auto name = am_##name##_##suffix;                                             \
    static constexpr auto name##_batch = am_##name##_batch_##suffix;

#define AM_DETAIL_ABI(T, suffix)                                                                   \
    template <> struct Abi<T> {                                                                    \
        using Array = am_array_##suffix;                                                           \
        AM_DETAIL_QUESTION(profile_density, suffix)                                                \
        AM_DETAIL_QUESTION(profile_column, suffix)                                                 \
        AM_DETAIL_QUESTION(profile_inv_column, suffix)                                             \
        AM_DETAIL_QUESTION(profile_inv_reached_column, suffix)                                     \
        AM_DETAIL_QUESTION(profile_column_value_and_gradient, suffix)                              \
        AM_DETAIL_QUESTION(profile_inv_column_value_and_gradient, suffix)                          \
        AM_DETAIL_QUESTION(profile_bounds, suffix)                                                 \
        AM_DETAIL_QUESTION(profile_bounds_in_box, suffix)                                          \
        AM_DETAIL_QUESTION(medium_extinction, suffix)                                              \
        AM_DETAIL_QUESTION(medium_optical_depth, suffix)                                           \
        AM_DETAIL_QUESTION(medium_optical_depth_value_and_gradient, suffix)                        \
        AM_DETAIL_QUESTION(medium_free_flight_value_and_gradient, suffix)                          \
        AM_DETAIL_QUESTION(medium_transmittance, suffix)                                           \
        AM_DETAIL_QUESTION(medium_opacity, suffix)                                                 \
        AM_DETAIL_QUESTION(medium_bounds, suffix)                                                  \
        AM_DETAIL_QUESTION(medium_bounds_in_box, suffix)                                           \
        AM_DETAIL_QUESTION(medium_free_flight, suffix)                                             \
        AM_DETAIL_QUESTION(medium_pdf, suffix)                                                     \
        AM_DETAIL_QUESTION(medium_pdf_within, suffix)                                              \
        AM_DETAIL_QUESTION(airlight_radiance, suffix)                                              \
        AM_DETAIL_QUESTION(airlight_radiance_within, suffix)                                       \
    };

AM_DETAIL_ABI(double, f64)
AM_DETAIL_ABI(float, f32)

#undef AM_DETAIL_ABI
#undef AM_DETAIL_QUESTION

// Number of rays of a batch: the longest of its arguments, where one item serves all.
inline std::size_t count(std::initializer_list<std::size_t> sizes) {
    std::size_t n = 1;
    for (std::size_t size : sizes)
        n = size != 1 ? size : n;
    for (std::size_t size : sizes)
        if (size != 1 && size != n)
            throw Error(AM_STATUS_INVALID_ARGUMENT, "arrays must have 1 or " + std::to_string(n) +
                                                        " items, got " + std::to_string(size));
    return n;
}

template <typename T> auto array(const std::vector<T> &items) {
    return typename Abi<T>::Array{ items.data(), items.size() == 1 ? 0u : 1u };
}

template <typename T> auto array(const std::vector<Vector<T>> &items) {
    const T *first = items.empty() ? nullptr : items.front().data();
    return typename Abi<T>::Array{ first, items.size() == 1 ? 0u : 3u };
}

} // namespace detail

// Where the matter is: relative density along rays.
class Profile {
public:
    using Parameters = std::initializer_list<std::pair<const char *, std::vector<double>>>;

    // The profile called `kind` (for example "exponential"). Parameters that are not
    // given take their defaults.
    explicit Profile(const char *kind, Parameters parameters = {}) {
        detail::check(am_profile_kind(kind, &m_data.kind));
        std::size_t used = 0;
        char name[AM_NAME_SIZE];
        std::uint32_t count = 0;
        detail::check(am_profile_describe(m_data.kind, &name, &count));
        for (std::uint32_t i = 0; i < count; ++i)
            used += set(i, parameters);
        if (used != parameters.size())
            throw Error(AM_STATUS_INVALID_ARGUMENT,
                        std::string(kind) + " does not have all of the given parameters");
        detail::check(am_profile_check(&m_data));
    }

    const am_profile &data() const noexcept { return m_data; }

    // Relative density at a point.
    template <typename T> T density(const Vector<T> &point) const {
        T out;
        detail::check(detail::Abi<T>::profile_density(&m_data, point.data(), &out));
        return out;
    }

    // Integral of the density from the origin to the distance t, which may be infinite.
    template <typename T> T column(const Vector<T> &origin, const Vector<T> &direction, T t) const {
        T out;
        detail::check(
            detail::Abi<T>::profile_column(&m_data, origin.data(), direction.data(), t, &out));
        return out;
    }

    // The smallest distance at which the ray has gathered `column`; infinite if it never does.
    template <typename T>
    T inv_column(const Vector<T> &origin, const Vector<T> &direction, T column) const {
        T out;
        detail::check(detail::Abi<T>::profile_inv_column(&m_data, origin.data(), direction.data(),
                                                         column, &out));
        return out;
    }

    // The same for a column that the ray is known to gather, at less cost.
    template <typename T>
    T inv_reached_column(const Vector<T> &origin, const Vector<T> &direction, T column) const {
        T out;
        detail::check(detail::Abi<T>::profile_inv_reached_column(&m_data, origin.data(),
                                                                 direction.data(), column, &out));
        return out;
    }

    // The column; its derivatives by the parameters in their order, the origin, the direction as a
    // free vector, and t. 1 + gradient_size() numbers.
    template <typename T>
    std::vector<T> column_value_and_gradient(const Vector<T> &origin, const Vector<T> &direction,
                                             T t) const {
        std::vector<T> out(1 + gradient_size());
        detail::check(detail::Abi<T>::profile_column_value_and_gradient(
            &m_data, origin.data(), direction.data(), t, out.data()));
        return out;
    }

    // The distance at which the ray has gathered `column`; its derivatives likewise, the last one
    // by `column`.
    template <typename T>
    std::vector<T> inv_column_value_and_gradient(const Vector<T> &origin,
                                                 const Vector<T> &direction, T column) const {
        std::vector<T> out(1 + gradient_size());
        detail::check(detail::Abi<T>::profile_inv_column_value_and_gradient(
            &m_data, origin.data(), direction.data(), column, out.data()));
        return out;
    }

    // Number of derivatives: of the parameters, origin, direction and distance.
    std::size_t gradient_size() const {
        std::size_t size = 0;
        detail::check(am_profile_gradient_size(&m_data, &size));
        return size;
    }

    // Bounds of the density on a segment.
    template <typename T>
    Bounds<T> bounds(const Vector<T> &origin, const Vector<T> &direction, T t) const {
        Bounds<T> out;
        detail::check(detail::Abi<T>::profile_bounds(&m_data, origin.data(), direction.data(), t,
                                                     &out.inf, &out.sup));
        return out;
    }

    // Bounds of the density in a box.
    template <typename T> Bounds<T> bounds_in_box(const Vector<T> &lo, const Vector<T> &hi) const {
        Bounds<T> out;
        detail::check(detail::Abi<T>::profile_bounds_in_box(&m_data, lo.data(), hi.data(), &out.inf,
                                                            &out.sup));
        return out;
    }

    // The same for many rays.
    template <typename T> std::vector<T> density(const std::vector<Vector<T>> &points) const {
        std::vector<T> out(points.size());
        detail::check(detail::Abi<T>::profile_density_batch(&m_data, out.size(),
                                                            detail::array(points), out.data()));
        return out;
    }

    template <typename T>
    std::vector<T> column(const std::vector<Vector<T>> &origins,
                          const std::vector<Vector<T>> &directions, const std::vector<T> &t) const {
        std::vector<T> out(detail::count({ origins.size(), directions.size(), t.size() }));
        detail::check(detail::Abi<T>::profile_column_batch(
            &m_data, out.size(), detail::array(origins), detail::array(directions),
            detail::array(t), out.data()));
        return out;
    }

    template <typename T>
    std::vector<T> inv_column(const std::vector<Vector<T>> &origins,
                              const std::vector<Vector<T>> &directions,
                              const std::vector<T> &columns) const {
        std::vector<T> out(detail::count({ origins.size(), directions.size(), columns.size() }));
        detail::check(detail::Abi<T>::profile_inv_column_batch(
            &m_data, out.size(), detail::array(origins), detail::array(directions),
            detail::array(columns), out.data()));
        return out;
    }

    template <typename T>
    std::vector<T> inv_reached_column(const std::vector<Vector<T>> &origins,
                                      const std::vector<Vector<T>> &directions,
                                      const std::vector<T> &columns) const {
        std::vector<T> out(detail::count({ origins.size(), directions.size(), columns.size() }));
        detail::check(detail::Abi<T>::profile_inv_reached_column_batch(
            &m_data, out.size(), detail::array(origins), detail::array(directions),
            detail::array(columns), out.data()));
        return out;
    }

private:
    // Sets parameter number `index`; returns how many of `parameters` that used.
    std::size_t set(std::uint32_t index, Parameters parameters) {
        am_parameter p;
        detail::check(am_profile_parameter(m_data.kind, index, &p));
        for (const auto &[name, values] : parameters) {
            if (std::string(name) != p.name)
                continue;
            if (values.size() != p.size)
                throw Error(AM_STATUS_INVALID_ARGUMENT,
                            std::string(name) + " must have " + std::to_string(p.size) +
                                " values, got " + std::to_string(values.size()));
            for (std::uint32_t i = 0; i < p.size; ++i)
                m_data.values[p.offset + i] = values[i];
            return 1;
        }
        if (p.required)
            throw Error(AM_STATUS_INVALID_ARGUMENT, std::string(p.name) + " must be given");
        for (std::uint32_t i = 0; i < p.size; ++i)
            m_data.values[p.offset + i] = p.defaults[i];
        return 0;
    }

    am_profile m_data{};
};

// The sum of components: a profile and one attenuation coefficient per channel each.
class Medium {
public:
    struct Component {
        Profile profile;
        std::vector<double> sigma_t; // 1/length, at relative density 1
    };

    explicit Medium(const std::vector<Component> &components) {
        for (const Component &component : components) {
            m_profiles.push_back(component.profile.data());
            m_sigma_t.insert(m_sigma_t.end(), component.sigma_t.begin(), component.sigma_t.end());
            m_channels = component.sigma_t.size();
        }
        if (m_sigma_t.size() != m_profiles.size() * m_channels)
            throw Error(AM_STATUS_INVALID_ARGUMENT,
                        "sigma_t must have the same number of channels in every component");
        am_medium m = data();
        detail::check(am_medium_check(&m));
    }

    // Valid as long as this object.
    am_medium data() const noexcept {
        return { m_profiles.data(), m_sigma_t.data(), m_profiles.size(), m_channels };
    }

    std::size_t channels() const noexcept { return m_channels; }

    // Attenuation coefficient at a point, per channel.
    template <typename T> std::vector<T> extinction(const Vector<T> &point) const {
        am_medium m = data();
        std::vector<T> out(m_channels);
        detail::check(detail::Abi<T>::medium_extinction(&m, point.data(), out.data()));
        return out;
    }

    // Optical depth from the origin to the distance t, per channel.
    template <typename T>
    std::vector<T> optical_depth(const Vector<T> &origin, const Vector<T> &direction, T t) const {
        return along(detail::Abi<T>::medium_optical_depth, origin, direction, t);
    }

    // A row per channel: the optical depth; its derivatives by the coefficient and the parameters
    // of each component, the origin, the direction as a free vector, and t. Rows have
    // 1 + gradient_size() numbers.
    template <typename T>
    std::vector<T> optical_depth_value_and_gradient(const Vector<T> &origin,
                                                    const Vector<T> &direction, T t) const {
        am_medium m = data();
        std::vector<T> out(m_channels * (1 + gradient_size()));
        detail::check(detail::Abi<T>::medium_optical_depth_value_and_gradient(
            &m, origin.data(), direction.data(), t, out.data()));
        return out;
    }

    // The free flight of a channel; its derivatives likewise, the last one by tau.
    template <typename T>
    std::vector<T> free_flight_value_and_gradient(std::size_t channel, const Vector<T> &origin,
                                                  const Vector<T> &direction, T t_max,
                                                  T tau) const {
        am_medium m = data();
        std::vector<T> out(1 + gradient_size());
        detail::check(detail::Abi<T>::medium_free_flight_value_and_gradient(
            &m, channel, origin.data(), direction.data(), t_max, tau, out.data()));
        return out;
    }

    // Number of derivatives of an optical depth.
    std::size_t gradient_size() const {
        am_medium m = data();
        std::size_t size = 0;
        detail::check(am_medium_gradient_size(&m, &size));
        return size;
    }

    // exp(-optical depth), per channel.
    template <typename T>
    std::vector<T> transmittance(const Vector<T> &origin, const Vector<T> &direction, T t) const {
        return along(detail::Abi<T>::medium_transmittance, origin, direction, t);
    }

    // 1 - transmittance, per channel.
    template <typename T>
    std::vector<T> opacity(const Vector<T> &origin, const Vector<T> &direction, T t) const {
        return along(detail::Abi<T>::medium_opacity, origin, direction, t);
    }

    // Density of t as a free flight, per channel.
    template <typename T>
    std::vector<T> pdf(const Vector<T> &origin, const Vector<T> &direction, T t) const {
        return along(detail::Abi<T>::medium_pdf, origin, direction, t);
    }

    // Density of t as a free flight that must end before t_max, per channel.
    template <typename T>
    std::vector<T> pdf_within(const Vector<T> &origin, const Vector<T> &direction, T t_max,
                              T t) const {
        am_medium m = data();
        std::vector<T> out(m_channels);
        detail::check(detail::Abi<T>::medium_pdf_within(&m, origin.data(), direction.data(), t_max,
                                                        t, out.data()));
        return out;
    }

    // The distance up to t_max at which the ray has gathered the optical depth tau in a
    // channel; infinite if it gathers less.
    template <typename T>
    T free_flight(std::size_t channel, const Vector<T> &origin, const Vector<T> &direction, T t_max,
                  T tau) const {
        am_medium m = data();
        T out;
        detail::check(detail::Abi<T>::medium_free_flight(&m, channel, origin.data(),
                                                         direction.data(), t_max, tau, &out));
        return out;
    }

    // Bounds of the attenuation coefficient on a segment, per channel.
    template <typename T>
    std::vector<Bounds<T>> bounds(const Vector<T> &origin, const Vector<T> &direction, T t) const {
        am_medium m = data();
        std::vector<T> inf(m_channels), sup(m_channels);
        detail::check(detail::Abi<T>::medium_bounds(&m, origin.data(), direction.data(), t,
                                                    inf.data(), sup.data()));
        return pairs(inf, sup);
    }

    // Bounds of the attenuation coefficient in a box, per channel.
    template <typename T>
    std::vector<Bounds<T>> bounds_in_box(const Vector<T> &lo, const Vector<T> &hi) const {
        am_medium m = data();
        std::vector<T> inf(m_channels), sup(m_channels);
        detail::check(
            detail::Abi<T>::medium_bounds_in_box(&m, lo.data(), hi.data(), inf.data(), sup.data()));
        return pairs(inf, sup);
    }

    // Optical depths of many rays: the channels of the first ray, of the second, and so on.
    template <typename T>
    std::vector<T> optical_depth(const std::vector<Vector<T>> &origins,
                                 const std::vector<Vector<T>> &directions,
                                 const std::vector<T> &t) const {
        am_medium m = data();
        std::size_t n = detail::count({ origins.size(), directions.size(), t.size() });
        std::vector<T> out(n * m_channels);
        detail::check(detail::Abi<T>::medium_optical_depth_batch(&m, n, detail::array(origins),
                                                                 detail::array(directions),
                                                                 detail::array(t), out.data()));
        return out;
    }

    // Free flights of many rays.
    template <typename T>
    std::vector<T> free_flight(std::size_t channel, const std::vector<Vector<T>> &origins,
                               const std::vector<Vector<T>> &directions,
                               const std::vector<T> &t_max, const std::vector<T> &tau) const {
        am_medium m = data();
        std::vector<T> out(
            detail::count({ origins.size(), directions.size(), t_max.size(), tau.size() }));
        detail::check(detail::Abi<T>::medium_free_flight_batch(
            &m, out.size(), channel, detail::array(origins), detail::array(directions),
            detail::array(t_max), detail::array(tau), out.data()));
        return out;
    }

private:
    template <typename Question, typename T>
    std::vector<T> along(Question question, const Vector<T> &origin, const Vector<T> &direction,
                         T t) const {
        am_medium m = data();
        std::vector<T> out(m_channels);
        detail::check(question(&m, origin.data(), direction.data(), t, out.data()));
        return out;
    }

    template <typename T>
    std::vector<Bounds<T>> pairs(const std::vector<T> &inf, const std::vector<T> &sup) const {
        std::vector<Bounds<T>> out(m_channels);
        for (std::size_t c = 0; c < m_channels; ++c)
            out[c] = { inf[c], sup[c] };
        return out;
    }

    std::vector<am_profile> m_profiles;
    std::vector<double> m_sigma_t;
    std::size_t m_channels = 0;
};

// A point light in a uniform medium, in one or more channels.
class AirLight {
public:
    // Coefficients in 1/length, one of each per channel.
    AirLight(const am_light &light, const am_phase &phase, std::vector<double> sigma_s,
             std::vector<double> sigma_t)
        : m_light(light), m_phase(phase), m_sigma_s(std::move(sigma_s)),
          m_sigma_t(std::move(sigma_t)) {
        if (m_sigma_s.size() != m_sigma_t.size())
            throw Error(AM_STATUS_INVALID_ARGUMENT,
                        "sigma_s and sigma_t must have the same number of channels");
        am_airlight a = data();
        detail::check(am_airlight_check(&a));
    }

    // Valid as long as this object.
    am_airlight data() const noexcept {
        return { m_light, m_phase, m_sigma_s.data(), m_sigma_t.data(), m_sigma_s.size() };
    }

    std::size_t channels() const noexcept { return m_sigma_s.size(); }

    // Radiance scattered towards t0 between t0 and t1 per unit intensity, per channel.
    template <typename T>
    std::vector<T> radiance(const Vector<T> &origin, const Vector<T> &direction, T t0, T t1) const {
        am_airlight a = data();
        std::vector<T> out(channels());
        detail::check(detail::Abi<T>::airlight_radiance(&a, origin.data(), direction.data(), t0, t1,
                                                        out.data()));
        return out;
    }

    // The same at the least cost that keeps a relative error, and an estimate of the error.
    template <typename T>
    std::pair<std::vector<T>, std::vector<T>> radiance_within(const Vector<T> &origin,
                                                              const Vector<T> &direction, T t0,
                                                              T t1, T tolerance) const {
        am_airlight a = data();
        std::vector<T> out(channels()), error(channels());
        detail::check(detail::Abi<T>::airlight_radiance_within(
            &a, origin.data(), direction.data(), t0, t1, tolerance, out.data(), error.data()));
        return { out, error };
    }

    // Of many rays: the channels of the first ray, of the second, and so on.
    template <typename T>
    std::vector<T> radiance(const std::vector<Vector<T>> &origins,
                            const std::vector<Vector<T>> &directions, const std::vector<T> &t0,
                            const std::vector<T> &t1) const {
        am_airlight a = data();
        std::size_t n = detail::count({ origins.size(), directions.size(), t0.size(), t1.size() });
        std::vector<T> out(n * channels());
        detail::check(detail::Abi<T>::airlight_radiance_batch(
            &a, n, detail::array(origins), detail::array(directions), detail::array(t0),
            detail::array(t1), out.data()));
        return out;
    }

private:
    am_light m_light;
    am_phase m_phase;
    std::vector<double> m_sigma_s, m_sigma_t;
};

} // namespace am

#endif // ANALYTIC_MEDIA_HPP
