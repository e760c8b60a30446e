"""Errors of images and what becomes of them."""

from dataclasses import dataclass

import numpy as np

TRIMMED_FRACTION = 0.001


@dataclass
class Reference:
    """A converged image, with the variance of its own noise: mean over pixels and channels."""

    image: np.ndarray
    noise_variance: float
    trimmed_noise_variance: float
    details: dict

    @classmethod
    def from_halves(cls, first, second, details):
        """Two images with equal sample counts and independent seeds; their mean is the image.

        Var((a + b)/2) = E[(a - b)²]/4.
        """
        squared = ((first - second) / 2) ** 2
        return cls((first + second) / 2, float(np.mean(squared)), trimmed_mean(squared), details)


def trimmed_mean(squared_error):
    """Mean over pixels without the brightest TRIMMED_FRACTION of them (channels averaged)."""
    per_pixel = np.sort(np.mean(squared_error, axis=-1).ravel())
    keep = len(per_pixel) - int(np.ceil(TRIMMED_FRACTION * len(per_pixel)))
    return float(np.mean(per_pixel[: max(keep, 1)]))


def mse(image, reference):
    """Mean squared error over pixels and channels, less the reference's own noise."""
    return float(np.mean((image - reference.image) ** 2)) - reference.noise_variance


def trimmed_mse(image, reference):
    squared = (image - reference.image) ** 2
    return trimmed_mean(squared) - reference.trimmed_noise_variance


def errors(image, own, exact):
    """Against the reference of the method's own medium (noise), and of the exact one (bias too)."""
    return {
        "mse": mse(image, own),
        "mse_trimmed": trimmed_mse(image, own),
        "mse_exact": mse(image, exact),
        "mse_exact_trimmed": trimmed_mse(image, exact),
    }


def spread(values):
    """Median, range and quartiles of those numbers that are finite; None without any."""
    finite = [float(v) for v in values if np.isfinite(v)]
    if not finite:
        return None
    low, lower, median, upper, high = np.percentile(finite, [0, 25, 50, 75, 100])
    return {
        "values": finite,
        "median": float(median),
        "min": float(low),
        "quartile_1": float(lower),
        "quartile_3": float(upper),
        "max": float(high),
    }


def efficiency(record, kind="mse"):
    """1/(MSE · process CPU time); NaN where the noise of the reference hides the error."""
    error = record[kind]
    return 1.0 / (error * record["cpu_seconds"]) if error > 0 else float("nan")
