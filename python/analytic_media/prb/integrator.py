"""The integrator `prbanalyticvolpath`: `analyticvolpath`, differentiated by path replay.

The class derives from one of Mitsuba's that is made anew for each variant: so is this module.
"""

from contextlib import contextmanager
from dataclasses import dataclass, field

import drjit as dr
import mitsuba as mi

from . import baseline, camera, flight, media

common = mi.ad.integrators.common  # an import would find that of the first variant

VARIANT = mi.variant()
# How much more probable than in nature collisions are, and up to which probability: on rays from
# the camera that leave the scene, on others that do, and on rays from the camera that meet a
# surface. Measured by benches/gradient_noise.py, as is the depth of roulette.
CAMERA_GAIN, SCATTERED_GAIN, SURFACE_GAIN = (16.0, 1.0), (2.0, 1.0), (3.0, 0.7)
ROULETTE_DEPTH = 4
MAX_SURVIVAL = 0.95


class PrbAnalyticVolpath(common.RBIntegrator):
    """Path tracing through analytic media: images, and their derivatives.

    Distances and directions are drawn without derivatives, and weighted with them, by the replay of
    each path: memory does not depend on its length.
    """

    def __init__(self, props):
        roulette = props.get("rr_depth", ROULETTE_DEPTH)
        super().__init__(props)  # whose default is another
        self.rr_depth = roulette
        self._lights = props.get("emitter_samples", 1)
        if not 1 <= self._lights <= 64:
            raise ValueError(f"emitter_samples must be between 1 and 64, got {self._lights}")
        self.follow_adjoint = props.get("follow_adjoint", True)
        self._known = media.Known()
        self._medium = None
        self._differentiates = False

    def render_forward(self, *args, **options):
        with self._differentiating():
            return super().render_forward(*args, **options)

    def render_backward(self, scene, params, grad_in, sensor=0, seed=0, spp=0):
        sensor = scene.sensors()[sensor] if isinstance(sensor, int) else sensor
        # Strata of other samplers are those of pixels that have as many paths each.
        follows = self.follow_adjoint and _is_independent(sensor.sampler())
        with self._differentiating():
            if follows:
                self._follow(scene, sensor, grad_in, seed, spp)
            else:
                super().render_backward(scene, params, grad_in, sensor, seed, spp)

    @contextmanager
    def _differentiating(self):
        self._differentiates = True
        try:
            yield
        finally:
            self._differentiates = False

    def _follow(self, scene, sensor, derivative, seed, spp):
        """Reverse mode, with paths where the derivative by the image is large."""
        film = sensor.film()
        self._medium = sensor.get_medium()
        with dr.suspend_grad():
            sampler, spp = self.prepare(sensor, seed, spp)
            importance = camera.importance(film, derivative)
            start = camera.start(sensor, sampler, camera.counts(importance, spp))
            path = {"scene": scene, "ray": start.ray}
            δL = camera.adjoint(film, start, derivative)
            *_, state = self.sample(dr.ADMode.Primal, sampler=sampler.clone(), **path)
            self.sample(dr.ADMode.Backward, sampler=sampler, δL=δL, state_in=state, **path)
            dr.eval()

    def sample_rays(self, scene, sensor, sampler):
        self._medium = sensor.get_medium()
        return super().sample_rays(scene, sensor, sampler)

    @dr.syntax
    def sample(
        self,
        mode,
        scene,
        sampler,
        ray,
        δL=None,
        state_in=None,
        active=True,
        **_,
    ):
        primal = mode == dr.ADMode.Primal
        with dr.resume_grad():
            matter = media.find(scene, self._medium, self._known)
        permeable = _permeable(scene)
        lights = self._lights

        ray = mi.Ray3f(dr.detach(ray))
        depth = mi.UInt32(0)
        L, baselines = (mi.Spectrum(0), []) if primal else state_in
        L = mi.Spectrum(L)
        records = [baseline.Record() for _ in range(3 if primal and self._differentiates else 0)]
        δL = mi.Spectrum(δL if δL is not None else 0)
        throughput = mi.Spectrum(1)
        η = mi.Float(1)
        active = mi.Bool(active) & (self.max_depth > 0)
        medium = mi.MediumPtr(self._medium)
        last = dr.zeros(mi.Interaction3f)
        last_pdf = mi.Float(1)
        count_emission = mi.Bool(True)
        valid = mi.Bool(False)

        while dr.hint(active, label=f"prbanalyticvolpath ({mode.name})"):
            # ---- The segment: where it would end, and where it collides
            si = scene.ray_intersect(ray, active)
            if dr.hint(permeable, mode="scalar"):
                # Outside of all media there is no flight: the segment begins at their boundary.
                enters = active & (medium == None) & _invisible(si, ray)  # noqa: E711
                ray, medium = _go_on(si, ray, medium, enters)
                si[enters] = scene.ray_intersect(ray, enters)
            reach = mi.Float(si.t)
            if dr.hint(permeable, mode="scalar"):
                # Where nothing is behind the boundary of a medium, the ray leaves the scene there.
                exits = active & _invisible(si, ray)
                exits &= si.target_medium(ray.d) == None  # noqa: E711
                behind = scene.ray_intersect(si.spawn_ray(ray.d), exits)
                si[exits & ~behind.is_valid()] = behind
            if dr.hint(self.hide_emitters, mode="scalar"):
                hidden = active & si.is_valid() & (depth == 0)
                hidden &= si.shape.is_emitter()
                beyond = si.spawn_ray(ray.d)
                pi = self.skip_area_emitters(scene, beyond, True, hidden)
                si[hidden] = pi.compute_surface_interaction(beyond, mi.RayFlags.All, hidden)
                reach[hidden] = dr.select(si.is_valid(), dr.norm(si.p - ray.o), dr.inf)

            with dr.resume_grad(when=not primal):
                goes_on = active & (depth + 1 < self.max_depth)
                bsdf = si.bsdf(ray)
                # Elsewhere more collisions would leave it open what alpha a ray has.
                solid = si.is_valid() & ~mi.has_flag(bsdf.flags(), mi.BSDFFlags.Null)
                gain = _gain(~si.is_valid(), solid, depth == 0)
                through, event = self._fly(
                    matter, sampler, ray, reach, medium, throughput, gain, goes_on, active
                )
                Lo = mi.Spectrum(0)

                # ---- Light from behind
                emitter = si.emitter(scene)
                shines = active & (emitter != None)  # noqa: E711, an array of pointers
                if dr.hint(self.hide_emitters, mode="scalar"):
                    shines &= depth > 0
                ds = mi.DirectionSample3f(scene, si, last)
                light_pdf = lights * scene.pdf_emitter_direction(last, ds, shines & ~count_emission)
                mis = dr.select(count_emission, 1, common.mis_weight(last_pdf, light_pdf))
                seen = dr.select(shines, throughput * through * emitter.eval(si, shines) * mis, 0)
                if dr.hint(primal, mode="scalar"):
                    L += seen
                else:
                    L -= dr.detach(seen)
                    Lo += seen

                # ---- The event: a collision, or the surface
                collided = event.collided
                surface = active & ~collided & si.is_valid()
                mei = _interaction(ray, event.t, medium)
                albedo = _ratio(event.scattering, event.extinction)
                weight = dr.select(
                    collided, event.weight * dr.detach(albedo), dr.select(surface, event.passing, 0)
                )
                if dr.hint(len(records) > 0, mode="scalar"):
                    inside = medium != None  # noqa: E711
                    records[0].note(collided & (depth == 0), throughput * event.weight, L)
                    records[1].note(collided & (depth > 0), throughput * event.weight, L)
                    records[2].note(surface & inside, throughput * event.passing, L)
                if dr.hint(not primal, mode="scalar"):
                    usual = dr.select(depth == 0, baselines[0], baselines[1])
                    behind = dr.select(event.may_collide & si.is_valid(), baselines[2], 0)
                    Lo += dr.select(
                        collided,
                        (L - throughput * event.weight * usual) * event.log_density
                        + L * _relative(albedo),
                        dr.select(
                            surface,
                            (L - throughput * event.passing * behind) * _relative(through),
                            0,
                        ),
                    )
                    Lo += dr.select(event.may_collide, throughput * (behind - usual) * through, 0)
                throughput *= weight

                # ---- Light sources
                context = mi.BSDFContext()
                phase_context = mi.PhaseFunctionContext(sampler)
                bsdf = dr.select(surface, bsdf, dr.zeros(mi.BSDFPtr))
                phase = medium.phase_function()
                phase = dr.select(collided, phase, dr.zeros(mi.PhaseFunctionPtr))
                medium_samples = collided & medium.use_emitter_sampling()
                lit = goes_on & (
                    medium_samples | (surface & mi.has_flag(bsdf.flags(), mi.BSDFFlags.Smooth))
                )
                here = dr.select(collided, mi.Interaction3f(mei), mi.Interaction3f(si))
                here = dr.detach(here)
                for i in range(lights):
                    # The first coordinate chooses the light source: a stratum for each sample.
                    u = sampler.next_2d(lit)
                    u.x = (u.x + i) / lights
                    ds, light = scene.sample_emitter_direction(here, u, False, lit)
                    ds = dr.detach(ds)
                    sees = lit & (ds.pdf != 0)
                    wo = si.to_local(ds.d)
                    bsdf_value, bsdf_pdf = bsdf.eval_pdf(context, si, wo, sees & surface)
                    phase_value, phase_pdf = phase.eval_pdf(
                        phase_context, mei, ds.d, sees & collided
                    )
                    value = dr.select(surface, bsdf_value, phase_value)
                    pdf = dr.detach(dr.select(surface, bsdf_pdf, phase_pdf))
                    mis = common.mis_weight(ds.pdf * lights, dr.select(ds.delta, 0, pdf))
                    side = mi.MediumPtr(medium)
                    side[surface & si.is_medium_transition()] = si.target_medium(ds.d)
                    infinite = mi.has_flag(ds.emitter.flags(), mi.EmitterFlags.Infinite)
                    # The size of the scene is no part of it: a frozen function would not know it.
                    shadow = dr.select(infinite, here.spawn_ray(ds.d), here.spawn_ray_to(ds.p))
                    sees &= (pdf > 0) & dr.any(dr.detach(light) != 0)
                    if dr.hint(permeable, mode="scalar"):
                        through_first, beyond, farther, goes_on = self._segment(
                            scene, matter, shadow, side, infinite, sees
                        )
                        rest = scene, matter, beyond, farther, infinite
                        with dr.suspend_grad():
                            passed, meets = self._pass(*rest, goes_on, dr.ADMode.Primal, None, None)
                        passed *= through_first
                    else:
                        passed = self._unobstructed(scene, matter, shadow, side, infinite, sees)
                    direct = dr.select(
                        sees, throughput * value * light * passed * (mis / lights), 0
                    )
                    if dr.hint(primal, mode="scalar"):
                        L += direct
                    else:
                        L -= dr.detach(direct)
                        Lo += direct
                        if dr.hint(permeable, mode="scalar"):
                            goes_on &= meets & dr.any(dr.detach(direct) != 0)
                            δL = self._pass(*rest, goes_on, mode, dr.detach(direct), δL)

                # ---- The next direction
                u1, u2 = sampler.next_1d(active), sampler.next_2d(active)
                with dr.suspend_grad():
                    bs, bsdf_weight = bsdf.sample(context, si, u1, u2, surface)
                    wo, phase_weight, phase_pdf = phase.sample(phase_context, mei, u1, u2, collided)
                if dr.hint(not primal, mode="scalar"):
                    smooth = surface & ~mi.has_flag(bs.sampled_type, mi.BSDFFlags.Delta)
                    smooth &= ~mi.has_flag(bs.sampled_type, mi.BSDFFlags.Null)
                    bsdf_value = bsdf.eval(context, si, bs.wo, smooth)
                    phase_value, _ = phase.eval_pdf(phase_context, mei, wo, collided)
                    Lo += dr.select(smooth, L * _relative(bsdf_value), 0)
                    Lo += dr.select(collided, L * _relative(phase_value), 0)
                    δL += _propagate(mode, δL, Lo)

            # ---- Move on
            null = surface & mi.has_flag(bs.sampled_type, mi.BSDFFlags.Null)
            scattered = collided | (surface & ~null)
            throughput *= dr.select(collided, phase_weight, bsdf_weight)
            pdf = dr.select(collided, phase_pdf, bs.pdf)
            η[surface] *= bs.eta
            direction = dr.select(collided, wo, si.to_world(bs.wo))
            ray = dr.detach(here.spawn_ray(direction))
            medium[surface & si.is_medium_transition()] = si.target_medium(direction)
            valid |= scattered & (event.natural | surface | solid) & (depth == 0)
            valid |= shines & si.is_valid() & (depth == 0)
            last[scattered] = here
            last_pdf[scattered] = pdf
            depth[scattered] += 1
            specular = surface & mi.has_flag(bs.sampled_type, mi.BSDFFlags.Delta)
            count_emission[scattered] = specular | (collided & ~medium_samples)
            active &= (collided | surface) & (pdf > 0) & (depth < self.max_depth)
            active &= dr.any(throughput != 0)

            # ---- Roulette
            plays = active & scattered & (depth > self.rr_depth)
            survival = dr.minimum(dr.max(throughput) * dr.square(η), MAX_SURVIVAL)
            active &= ~plays | (sampler.next_1d(plays) < survival)
            throughput[plays] *= dr.rcp(survival)

        if dr.hint(len(records) > 0, mode="scalar"):
            dr.eval(L, records)  # sums over paths would run the loop once for each
            samples = sampler.sample_count()
            independent = _is_independent(sampler)
            baselines = [record.mean(L, samples, independent) for record in records]
        return L if primal else δL, valid, [], (L, baselines)

    def _fly(self, matter, sampler, ray, reach, medium, throughput, gain, may_collide, active):
        """The flight of a ray: what gets through, and its event."""
        through = mi.Spectrum(1)
        event = _Event()
        u = sampler.next_1d(active)
        count = max((len(m.components) for m in matter), default=0)
        variates = [sampler.next_1d(active) for _ in range(count)]
        for one in matter:
            inside = active & (medium == one.pointer)
            passes, own = self._fly_in(
                one, variates, u, ray, reach, throughput, gain, may_collide & inside, inside
            )
            through = dr.select(inside, passes, through)
            event = dr.select(inside, own, event)
        return through, event

    def _fly_in(self, one, variates, u, ray, reach, throughput, gain, may_collide, inside):
        place = media.Place(one, _interaction(ray, mi.Float(0), one.pointer))
        o, near, length = _clip(one, ray, reach, inside)
        columns = place.columns(o, ray.d, length)
        depth = place.depth(columns)
        through = dr.exp(-depth)

        event = _Event()
        chances = flight.channel_chances(throughput)
        with dr.suspend_grad():
            losses = flight.opacity(dr.detach(depth))
            natural = dr.select(may_collide, dr.sum(chances * losses), 0)
            chance = dr.maximum(natural, dr.minimum(gain[0] * natural, gain[1]))
            event.collided = may_collide & (u < chance)
            event.may_collide = may_collide
            event.natural = event.collided & (u < natural)
            channel = flight.choose(
                chances * losses / dr.maximum(natural, flight.TINY),
                u / dr.maximum(chance, flight.TINY),
            )
            own = variates[: len(columns)]
            lost = flight.pick(losses, channel)
            t, known = flight.first_collision(place, columns, o, ray.d, length, channel, lost, own)
            event.collided &= dr.isfinite(t)
            t = dr.detach(dr.select(event.collided, t, 0))
        event.t = near + t
        sofar = place.depth(place.columns(o, ray.d, t))
        event.extinction, event.scattering = place.at(o + t * ray.d)
        event.log_density = dr.log(dr.maximum(event.extinction, flight.TINY)) - sofar
        passed = dr.detach(place.depth(known) if known else sofar)
        event.weight = flight.collision_weight(
            chances, natural, chance, passed, dr.detach(event.extinction)
        )
        event.passing = dr.detach(through) / dr.maximum(1 - chance, flight.TINY)
        return through, event

    def _unobstructed(self, scene, matter, ray, medium, infinite, active):
        """Transmittance of a shadow ray that one medium fills, 0 behind a surface."""
        through = self._through(matter, ray, medium, ray.maxt, infinite, active)
        return dr.select(scene.ray_test(ray, active), 0, through)

    def _segment(self, scene, matter, ray, medium, infinite, active):
        """A shadow ray up to a surface and through it: what passes, and the ray from there on."""
        with dr.suspend_grad():
            si = scene.ray_intersect(ray, active)
        surface = active & si.is_valid()
        end = dr.select(surface, si.t, ray.maxt)
        through = self._through(matter, ray, medium, end, infinite & ~surface, active)
        bsdf = si.bsdf(ray)
        through *= dr.select(surface, bsdf.eval_null_transmission(si, surface), 1)
        left = ray.maxt - end
        ray, medium = _go_on(si, ray, medium, surface)
        goes_on = surface & (left > 0) & dr.any(dr.detach(through) != 0)

        # Outside of all media there is nothing to do: on to the next boundary.
        ray.maxt = left
        outside = goes_on & (medium == None)  # noqa: E711
        with dr.suspend_grad():
            si = scene.ray_intersect(ray, outside)
            enters = outside & _invisible(si, ray)
            ray, medium = _go_on(si, ray, medium, enters)
            ray.maxt = dr.select(enters, left - si.t, left)
        goes_on &= ~outside | si.is_valid()
        return through, ray, medium, goes_on

    @dr.syntax
    def _pass(self, scene, matter, ray, medium, infinite, active, mode, light, δL):
        """Transmittance of a shadow ray through the boundaries of media, and whether it meets one.

        With the light that passes, `light`, and its adjoint, differentiates it instead: the
        result is the new adjoint.
        """
        primal = mode == dr.ADMode.Primal
        ray, medium, active = mi.Ray3f(ray), mi.MediumPtr(medium), mi.Bool(active)
        passed, meets = mi.Spectrum(1), mi.Bool(False)
        δL = mi.Spectrum(0 if primal else δL)
        light = mi.Spectrum(0 if primal else light)
        while dr.hint(active, label=f"prbanalyticvolpath shadow ({mode.name})"):
            meets |= active & (medium != None)  # noqa: E711
            with dr.resume_grad(when=not primal):
                through, ray, medium, goes_on = self._segment(
                    scene, matter, ray, medium, infinite, active
                )
                if dr.hint(not primal, mode="scalar"):
                    Lo = dr.select(active, light * _relative(through), 0)
                    δL += _propagate(mode, δL, Lo)
            passed[active] *= dr.detach(through)
            active &= goes_on
        return (passed, meets) if primal else δL

    def _through(self, matter, ray, medium, end, infinite, active):
        """Transmittance of a segment up to `end`, or of all that is behind it, too."""
        through = mi.Spectrum(1)
        reach = dr.select(infinite, dr.inf, end)
        for one in matter:
            inside = active & (medium == one.pointer)
            place = media.Place(one, _interaction(ray, mi.Float(0), one.pointer))
            o, _, length = _clip(one, ray, reach, inside)
            passes = dr.exp(-place.depth(place.columns(o, ray.d, length)))
            through = dr.select(inside, passes, through)
        return through

    def to_string(self):
        return (
            f"PrbAnalyticVolpath[\n  max_depth = {self.max_depth},\n  rr_depth = {self.rr_depth},\n"
            f"  hide_emitters = {self.hide_emitters},\n  emitter_samples = {self._lights},\n"
            f"  follow_adjoint = {self.follow_adjoint}\n]"
        )


def _is_independent(sampler):
    return sampler.class_name() == "IndependentSampler"


def _zero():
    return mi.Spectrum(0)


def _no():
    return mi.Bool(False)


@dataclass
class _Event:
    """Where a flight ends, by channel where it is a spectrum."""

    may_collide: object = field(default_factory=_no)
    collided: object = field(default_factory=_no)
    # Collides in nature, too.
    natural: object = field(default_factory=_no)
    t: object = field(default_factory=lambda: mi.Float(0))
    # 1/length, at the collision.
    extinction: object = field(default_factory=_zero)
    scattering: object = field(default_factory=_zero)
    # The logarithm of the density of collisions.
    log_density: object = field(default_factory=_zero)
    # Contribution over probability, of a collision but for the albedo, and of the end.
    weight: object = field(default_factory=_zero)
    passing: object = field(default_factory=lambda: mi.Spectrum(1))


def _gain(leaves, solid, first):
    """The factor of a ray's probability to collide, and the probability up to which it counts."""
    return [
        dr.select(
            leaves,
            dr.select(first, camera, scattered),
            dr.select(solid & first, surface, 1),
        )
        for camera, scattered, surface in zip(
            CAMERA_GAIN, SCATTERED_GAIN, SURFACE_GAIN, strict=True
        )
    ]


def _interaction(ray, t, medium):
    """A place in a medium, at the distance `t` on a ray."""
    it = dr.zeros(mi.MediumInteraction3f)
    it.t = t
    it.p = ray(t)
    it.wi = -ray.d
    it.sh_frame = mi.Frame3f(it.wi)
    it.time = ray.time
    it.wavelengths = ray.wavelengths
    it.medium = medium
    return it


def _clip(one, ray, reach, active):
    """The part of a ray inside a medium: its origin, how far that is, and its length."""
    hit, near, far = one.pointer.intersect_aabb(ray)
    hit &= active
    near = dr.select(hit, near, 0)
    length = dr.select(hit, dr.maximum(dr.minimum(reach, far) - near, 0), 0)
    return dr.detach(ray(near)), dr.detach(near), dr.detach(length)


def _invisible(si, ray):
    """Whether a ray goes on from the boundary of a medium as if no surface were there."""
    bsdf = si.bsdf(ray)
    kind = bsdf.flags() & (mi.BSDFFlags.All | +mi.BSDFFlags.Null)
    invisible = (bsdf != None) & (kind == +mi.BSDFFlags.Null)  # noqa: E711
    return invisible & si.is_valid() & si.is_medium_transition() & ~si.shape.is_emitter()


def _go_on(si, ray, medium, active):
    """The ray behind a surface, and the medium there."""
    ray = dr.detach(dr.select(active, si.spawn_ray(ray.d), ray))
    crosses = active & si.is_medium_transition()
    return ray, dr.select(crosses, si.target_medium(ray.d), medium)


def _ratio(a, b):
    return flight.each(b > 0, a / dr.maximum(b, flight.TINY), 0)


def _relative(value):
    """1, with the derivative of the logarithm of `value`; 0 where that is 0."""
    now = dr.detach(value)
    return flight.each(now > 0, value / flight.each(now > 0, now, 1), 0)


def _propagate(mode, δL, Lo):
    """Takes the derivative of `Lo` to the parameters, or from them: the result is added to δL."""
    if not dr.grad_enabled(Lo):
        return mi.Spectrum(0)
    if mode == dr.ADMode.Backward:
        dr.backward_from(δL * Lo)
        return mi.Spectrum(0)
    return dr.forward_to(Lo, flags=dr.ADFlag.Default | dr.ADFlag.AllowNoGrad)


def _permeable(scene) -> bool:
    """Whether some surface lets light through without scattering it, or bounds a medium."""
    return any(
        shape.is_medium_transition()
        or (shape.bsdf() is not None and mi.has_flag(shape.bsdf().flags(), mi.BSDFFlags.Null))
        for shape in scene.shapes()
    )
