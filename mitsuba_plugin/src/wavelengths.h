// Wavelengths of channels.

#pragma once

#include <analytic_media.h>
#include <mitsuba/core/spectrum.h>
#include <mitsuba/render/fwd.h>

namespace mitsuba {

/// Wavelengths of the channels at an interaction, nm: those of the ray, or what colours stand for.
template <typename Spectrum, typename Interaction>
unpolarized_spectrum_t<Spectrum> wavelengths([[maybe_unused]] const Interaction &it) {
    using Channels = unpolarized_spectrum_t<Spectrum>;
    using Number = dr::scalar_t<Channels>;
    const double *rgb = AM_RGB_WAVELENGTHS;
    if constexpr (is_spectral_v<Spectrum>)
        return Channels(it.wavelengths);
    else if constexpr (is_rgb_v<Spectrum>)
        return Channels((Number) rgb[0], (Number) rgb[1], (Number) rgb[2]);
    else
        return Channels((Number) rgb[1]);
}

/// The shortest of them.
template <typename Spectrum> double shortest_wavelength() {
    if constexpr (is_spectral_v<Spectrum>)
        return MI_CIE_MIN;
    else
        return AM_RGB_WAVELENGTHS[is_rgb_v<Spectrum> ? 2 : 1];
}

} // namespace mitsuba
