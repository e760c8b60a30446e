"""What the Python tests share."""

import numpy as np
import pytest


@pytest.fixture
def rng():
    """Random numbers, the same in every run."""
    return np.random.default_rng(20261122)


@pytest.fixture
def rays(rng):
    """200 rays in all directions: origins (200, 3), unit directions (200, 3)."""
    origins = rng.uniform(-20, 20, (200, 3))
    directions = rng.normal(size=(200, 3))
    return origins, directions / np.linalg.norm(directions, axis=-1, keepdims=True)


@pytest.fixture
def llvm():
    """Dr.Jit types of the variant llvm_ad_rgb; skips where there is no LLVM."""
    dr = pytest.importorskip("drjit", reason="Dr.Jit is not installed")
    mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed")
    if not dr.has_backend(dr.JitBackend.LLVM):
        pytest.skip("Dr.Jit found no LLVM library: run tools/ensure_llvm.sh")
    mi.set_variant("llvm_ad_rgb")
    import drjit.llvm.ad

    return drjit.llvm.ad


@pytest.fixture(scope="module")
def variant(request):
    """A variant of Mitsuba, by indirect parameters; skips where it cannot run."""
    dr = pytest.importorskip("drjit", reason="Dr.Jit is not installed")
    mi = pytest.importorskip("mitsuba", reason="Mitsuba is not installed")
    from analytic_media import _build

    if request.param not in _build.VARIANTS:
        pytest.skip(f"the plugins were built without {request.param}")
    if request.param.startswith("llvm") and not dr.has_backend(dr.JitBackend.LLVM):
        pytest.skip("Dr.Jit found no LLVM library: run tools/ensure_llvm.sh")
    mi.set_variant(request.param)
    return request.param
