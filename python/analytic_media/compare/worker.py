"""A renderer in a process of its own: one variant, one form of the media, several integrators.

Separate processes give each medium its own CPU clock, and kernels that hold its code only: a JIT
call traces every living medium of the variant in the process.
"""

import math
import multiprocessing
import time
import traceback
from dataclasses import dataclass, field

from .methods import EXACT, TRACKED

# Samples per JIT launch, which bounds memory: a path's state takes some 200 bytes.
LAUNCH_SAMPLES = 1 << 23


@dataclass(frozen=True)
class Job:
    """What a worker loads. `resolution` is methods.EXACT or the voxels along a side."""

    scene: str
    variant: str
    resolution: str | int
    folder: str
    first_seed: int
    parameters: dict = field(default_factory=dict)


class WorkerError(RuntimeError):
    """A worker process failed; the message holds its traceback."""


class Worker:
    """The caller's side: starts the process, sends requests, waits for answers."""

    def __init__(self, job):
        context = multiprocessing.get_context("spawn")
        self._connection, remote = context.Pipe()
        self._process = context.Process(target=_serve, args=(remote, job), daemon=True)
        self._process.start()
        remote.close()
        self._receive()  # the scene is loaded

    def render(self, plugin, spp, roulette=True):
        """(image (height, width, 3) of float32, process CPU seconds, wall seconds).

        `plugin` is the integrator's dictionary; the scene's depths are added.
        """
        self._connection.send((plugin, spp, roulette))
        return self._receive()

    def close(self):
        self._connection.close()
        self._process.join(timeout=20)
        if self._process.is_alive():
            self._process.terminate()

    def _receive(self):
        try:
            status, value = self._connection.recv()
        except EOFError:
            self._process.join(timeout=5)
            code = self._process.exitcode
            raise WorkerError(f"a render process ended unexpectedly, exit code {code}") from None
        if status == "error":
            raise WorkerError(value)
        return value


def _serve(connection, job):
    try:
        renderer = _Renderer(job)
        connection.send(("ok", None))
        while True:
            connection.send(("ok", renderer.render(*connection.recv())))
    except EOFError:  # the caller closed its end
        pass
    except Exception:
        connection.send(("error", traceback.format_exc()))


class _Renderer:
    def __init__(self, job):
        from . import twin

        state = twin.parse(job.scene, job.variant, job.parameters)
        self._depths = twin.integrator_parameters(state)
        self._own = twin.own_parameters(state)
        if job.resolution == TRACKED:
            state = twin.enclosed(state)
        elif job.resolution != EXACT:
            state, _ = twin.voxelised(state, job.resolution, job.variant, job.folder)
            twin.set_integrator(state, "volpath")
        self._scene = twin.instantiate(state, job.variant)
        self._is_jit = not job.variant.startswith("scalar")
        self._integrators = {}
        self._seed = job.first_seed
        self._pixels = math.prod(int(n) for n in self._scene.sensors()[0].film().size())

    def render(self, plugin, spp, roulette):
        import numpy as np

        image, cpu, wall = 0.0, 0.0, 0.0
        for launch in self._launches(spp):
            part, part_cpu, part_wall = self._timed(self._integrator(plugin, roulette), launch)
            image = image + np.asarray(part)[..., :3] * np.float32(launch / spp)
            cpu, wall = cpu + part_cpu, wall + part_wall
        return image, cpu, wall

    def _launches(self, spp):
        most = max(1, LAUNCH_SAMPLES // self._pixels) if self._is_jit else spp
        return [most] * (spp // most) + [spp % most] * (spp % most > 0)

    def _timed(self, integrator, spp):
        import drjit as dr
        import mitsuba as mi

        self._seed += 1
        wall, cpu = time.perf_counter(), time.process_time()
        image = mi.render(self._scene, integrator=integrator, spp=spp, seed=self._seed)
        dr.eval(image)
        dr.sync_thread()
        return image, time.process_time() - cpu, time.perf_counter() - wall

    def _integrator(self, plugin, roulette):
        import mitsuba as mi

        from . import twin

        key = (*plugin.items(), roulette)
        if key not in self._integrators:
            settings = plugin | self._depths
            if plugin["type"] == twin.OUR_INTEGRATOR:
                settings = self._own | settings
            if "spectral_sampling" in plugin:
                settings.pop("event_probabilities", None)
            if not roulette:
                settings["rr_depth"] = _no_roulette(settings.get("max_depth", -1))
            self._integrators[key] = mi.load_dict(settings)
        return self._integrators[key]


def _no_roulette(max_depth):
    """An rr_depth that is never passed."""
    return max_depth if max_depth > 0 else 1 << 30
