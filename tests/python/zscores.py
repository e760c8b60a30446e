"""Do two ways to render the same scene agree? Welch's t statistic, pixel by pixel.

A side is rendered in independent passes. Where both sides have the same mean, the difference of
their means over its standard error follows Student's distribution, in every pixel: the statistics
of an image have mean 0 and the standard deviation of that distribution. A bias moves the mean, a
wrong variance or correlated passes move the deviation.

Paths are not normal: where one side is more skewed than the other, t has a mean of its own, to
first order -κ₃ / (2 n² s³) for the third cumulant κ₃ of the difference of n passes and its
standard error s (Johnson 1978). It is estimated, and taken off.
"""

import gc
from dataclasses import dataclass

import mitsuba as mi
import numpy as np

PASSES = 32


def render_passes(scene, integrator, side, spp, passes=PASSES):
    """Images of a scene, a dict or loaded, by an integrator (a dict): (passes, pixels, channels).

    Sides that are compared have numbers of their own, and with them other random numbers.
    """
    gc.collect()  # a living medium would be part of every kernel
    loaded = mi.load_dict(scene) if isinstance(scene, dict) else scene
    integrator = mi.load_dict(integrator)
    images = []
    for seed in range(1000 * side, 1000 * side + passes):
        image = mi.render(loaded, integrator=integrator, spp=spp, seed=seed)
        image = np.array(image, dtype=np.float64)
        assert np.isfinite(image).all(), f"{np.sum(~np.isfinite(image))} values are not finite"
        images.append(image.reshape(-1, image.shape[2]))
    return np.stack(images)


@dataclass(frozen=True)
class Comparison:
    """Statistics of one channel: channels of a pixel are correlated, so each is tested alone."""

    pixels: int  # that are noisy: in the others both sides must be equal
    mean: float  # of t less its own mean
    raw_mean: float
    deviation: float
    expected_deviation: float
    relative_difference: float  # of the means over the image

    @property
    def mean_in_standard_errors(self):
        return self.mean * np.sqrt(self.pixels) / self.expected_deviation

    def __str__(self):
        return (
            f"{self.pixels} pixels: mean z {self.mean:+.4f} "
            f"({self.mean_in_standard_errors:+.1f} standard errors; "
            f"{self.raw_mean:+.4f} as it is), "
            f"deviation {self.deviation:.3f} (Student: {self.expected_deviation:.3f}), "
            f"means differ by {self.relative_difference:+.2%}"
        )


def compare(a, b):
    """A `Comparison` for each channel of two sets of passes."""
    return [_compare(a[..., i], b[..., i]) for i in range(a.shape[2])]


def _compare(a, b):
    mean_a, mean_b = a.mean(0), b.mean(0)
    error_a, error_b = a.var(0, ddof=1) / len(a), b.var(0, ddof=1) / len(b)
    # A pixel without noise holds rounding errors only.
    noisy = np.sqrt(error_a + error_b) > 1e-6 * np.maximum(abs(mean_a), abs(mean_b))
    np.testing.assert_allclose(mean_a[~noisy], mean_b[~noisy], rtol=1e-5, atol=1e-7)
    a, b, mean_a, mean_b, error_a, error_b = (
        x[..., noisy] for x in (a, b, mean_a, mean_b, error_a, error_b)
    )
    error = np.sqrt(error_a + error_b)
    z = (mean_a - mean_b) / error
    own_mean = -(third_cumulant(a) - third_cumulant(b)) / (2 * len(a) ** 2 * error**3)
    freedom = (error_a + error_b) ** 2 / (error_a**2 / (len(a) - 1) + error_b**2 / (len(b) - 1))
    return Comparison(
        pixels=len(z),
        mean=(z - own_mean).mean(),
        raw_mean=z.mean(),
        deviation=z.std(),
        expected_deviation=np.sqrt(np.mean(freedom / (freedom - 2))),
        relative_difference=mean_a.mean() / mean_b.mean() - 1,
    )


def third_cumulant(passes):
    """Unbiased, of each column."""
    n = len(passes)
    return ((passes - passes.mean(0)) ** 3).sum(0) * n / ((n - 1) * (n - 2))


def assert_agree(a, b, pixels=4096):
    """The means of two sets of passes agree within the noise, and the noise is what it should be.

    Both sides have as many passes. The mean may be 4 of its standard errors off (1 of 16 000
    correct images is), the deviation 0.05, which is 4 to 5 standard errors of 4096 pixels.
    """
    for channel, result in enumerate(compare(a, b)):
        print(f"\n    channel {channel}, {result}", end="")
        assert result.pixels >= pixels, result
        assert abs(result.mean_in_standard_errors) <= 4, result
        assert abs(result.deviation - result.expected_deviation) <= 0.05, result
