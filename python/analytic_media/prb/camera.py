"""Where paths start: pixels of an image, by how much depends on them.

In reverse mode it is known before a path is traced what its pixel's derivative will be multiplied
by: the adjoint image, which is 0 where the render is as it should be. A pixel gets paths in
proportion, beside a share that all get alike. Each pixel remains the mean of its paths.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi

# Of all paths, the part that every pixel gets an equal share of.
EVEN = 0.1


@dataclass
class Start:
    """Rays of paths, and where they count in the image.

    `share` is the reciprocal of how many paths a pixel has, up to a factor.
    """

    ray: object
    weight: object
    position: object
    share: object


def counts(importance, samples: int):
    """How many paths pixels get, of `samples` for each in the mean: at least a tenth of those.

    Returns the numbers of paths up to and with each pixel.
    """
    pixels = dr.width(importance)
    least = max(int(EVEN * samples), 1)
    rest = pixels * (samples - least)
    # Rounded down, and a bit less, for the sum must not be more than there is.
    wanted = importance * (rest * (1 - 1e-5) / dr.maximum(dr.sum(importance), 1e-30))
    ends = dr.cumsum(least + mi.UInt32(wanted))
    left = pixels * samples - dr.gather(mi.UInt32, ends, pixels - 1)
    index = dr.arange(mi.UInt32, pixels) + 1
    # What has been left goes round.
    return ends + left // pixels * index + dr.minimum(left % pixels, index)


def start(sensor, sampler, ends) -> Start:
    """Rays through the pixels, as many as `ends` says, uniform in each."""
    film = sensor.film()
    size, corner = _grid(film)
    count = size[0] * size[1] * sampler.sample_count()
    index = dr.arange(mi.UInt32, count)
    pixel = dr.binary_search(
        0, size[0] * size[1] - 1, lambda i: dr.gather(mi.UInt32, ends, i) <= index
    )
    before = dr.gather(mi.UInt32, ends, pixel - 1, pixel > 0)
    share = dr.rcp(mi.Float(dr.gather(mi.UInt32, ends, pixel) - before))

    pixel = _pixel(pixel, size, corner)
    position = pixel + sampler.next_2d()
    aperture = sampler.next_2d() if sensor.needs_aperture_sample() else mi.Point2f(0)
    time = sensor.shutter_open()
    if sensor.shutter_open_time() > 0:
        time += sampler.next_1d() * sensor.shutter_open_time()
    wavelength = sampler.next_1d() if mi.is_spectral else 0
    crop = mi.ScalarVector2f(film.crop_size())
    place = (position - mi.ScalarVector2f(film.crop_offset())) / crop
    ray, weight = sensor.sample_ray_differential(time, wavelength, place, aperture)
    return Start(ray, weight, _splat_position(film, pixel, position), share)


def adjoint(film, start: Start, derivative):
    """What the light of each path is to be multiplied by, of the `derivative` by the image."""
    splat = mi.ad.integrators.common.ADIntegrator._splat_to_block
    with dr.resume_grad():
        light = dr.ones(mi.Spectrum, dr.width(start.position))
        dr.enable_grad(light)
        block = film.create_block()
        block.set_coalesce(False)
        splat(
            block,
            film,
            start.position,
            value=light * start.weight * start.share,
            weight=start.share,
            alpha=1.0,
            aovs=[],
            wavelengths=start.ray.wavelengths,
        )
        film.put_block(block)
        image = film.develop()
        dr.set_grad(image, derivative)
        dr.enqueue(dr.ADMode.Backward, image)
        dr.traverse(dr.ADMode.Backward)
        found = dr.grad(light)
    film.clear()
    return found


def importance(film, derivative):
    """How much depends on each pixel: the adjoint of one path through its middle."""
    size, corner = _grid(film)
    pixel = _pixel(dr.arange(mi.UInt32, size[0] * size[1]), size, corner)
    ray = dr.zeros(mi.RayDifferential3f)
    if mi.is_spectral:
        ray.wavelengths, _ = mi.sample_rgb_spectrum(mi.sample_shifted(mi.Float(0.5)))
    place = _splat_position(film, pixel, pixel + 0.5)
    middle = Start(ray, mi.Spectrum(1), place, mi.Float(1))
    found = dr.sum(dr.abs(adjoint(film, middle, derivative)))
    return dr.select(dr.isfinite(found), found, 0)


def _grid(film):
    """Size of the grid of pixels that paths go through, and its first pixel."""
    border = film.rfilter().border_size() if film.sample_border() else 0
    size = mi.ScalarVector2u(film.crop_size()) + 2 * border
    return (int(size[0]), int(size[1])), mi.ScalarVector2i(film.crop_offset()) - border


def _pixel(index, size, corner):
    row = index // size[0]
    return mi.Vector2f(mi.Vector2i(index - row * size[0], row) + corner)


def _splat_position(film, pixel, position):
    """Where a path counts: with a box filter in its pixel, however its position is rounded."""
    return pixel if film.rfilter().is_box_filter() else position
