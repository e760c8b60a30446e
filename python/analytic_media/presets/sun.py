"""Sunlight above the atmosphere."""

import numpy as np

# Spectral irradiance at 1 au, W/m²/nm: ASTM G173-03, extraterrestrial, in bins of 10 nm from
# 360 nm on. The bins are those of Bruneton's reference implementation (2017),
# github.com/ebruneton/precomputed_atmospheric_scattering, atmosphere/demo/demo.cc,
# kSolarIrradiance.
IRRADIANCE = (
    1.11776, 1.14259, 1.01249, 1.14716, 1.72765, 1.73054, 1.6887, 1.61253,
    1.91198, 2.03474, 2.02042, 2.02212, 1.93377, 1.95809, 1.91686, 1.8298,
    1.8685, 1.8931, 1.85149, 1.8504, 1.8341, 1.8345, 1.8147, 1.78158,
    1.7533, 1.6965, 1.68194, 1.64654, 1.6048, 1.52143, 1.55622, 1.5113,
    1.474, 1.4482, 1.41018, 1.36775, 1.34188, 1.31429, 1.28303, 1.26758,
    1.2367, 1.2082, 1.18737, 1.14683, 1.12362, 1.1058, 1.07124, 1.04992,
)  # fmt: skip
BINS = np.arange(365.0, 836.0, 10.0)  # their centres, nm


def direction(zenith: float, azimuth: float) -> np.ndarray:
    """Unit vector to the sun; `azimuth` in degrees from +y towards +x."""
    z, a = np.radians([zenith, azimuth])
    return np.array([np.sin(z) * np.sin(a), np.sin(z) * np.cos(a), np.cos(z)])


def emitter(zenith: float, azimuth: float, distance: float) -> dict:
    """The sun as a `directional` emitter, `distance` astronomical units away.

    In colour variants Mitsuba turns the spectrum into linear sRGB.
    """
    table = np.array(IRRADIANCE) / distance**2
    wavelengths = [360.0, *BINS.tolist()]
    values = [float(table[0]), *table.tolist()]
    return {
        "type": "directional",
        "direction": (-direction(zenith, azimuth)).tolist(),
        "irradiance": {
            "type": "spectrum",
            "value": list(zip(wavelengths, values, strict=True)),
        },
    }
