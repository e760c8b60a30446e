"""The doctor: finds what works, and says why the rest does not."""

import pytest

mi = pytest.importorskip("mitsuba")

from analytic_media import doctor as clinic  # noqa: E402


def test_report_names_every_variant(monkeypatch):
    """One variant works, so the verdict is good; the others state their reason."""
    monkeypatch.setattr(
        clinic, "probe", lambda variant: None if variant == "scalar_rgb" else "no such device"
    )
    lines = []
    assert clinic.doctor(lines.append)
    text = "\n".join(lines)
    assert all(variant in text for variant in mi.variants())
    assert "no such device" in text
    assert f"1 of {len(mi.variants())} variants work." in text


def test_verdict_is_bad_when_nothing_works(monkeypatch):
    monkeypatch.setattr(clinic, "probe", lambda variant: "broken")
    assert not clinic.doctor(lambda line: None)


def test_probe_renders_in_scalar_rgb():
    assert clinic.probe("scalar_rgb") is None


@pytest.mark.parametrize(
    ("variant", "code", "stderr", "words"),
    [
        ("scalar_rgb", 1, "Traceback\nRuntimeError: no plugin\n", "RuntimeError: no plugin"),
        ("scalar_rgb", -11, "", "signal 11"),
        ("scalar_rgb", 3, "", "code 3"),
    ],
)
def test_reason_is_the_telling_line(variant, code, stderr, words):
    assert words in clinic.reason(variant, code, stderr)


def test_cuda_without_driver_is_explained(monkeypatch):
    monkeypatch.setattr(clinic.ctypes.util, "find_library", lambda name: None)
    assert "NVIDIA driver" in clinic.reason("cuda_ad_rgb", 1, "whatever")


def test_llvm_path_that_does_not_exist_is_shown(monkeypatch):
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", "/nowhere/libLLVM.so")
    assert clinic.llvm_library() == "DRJIT_LIBLLVM_PATH=/nowhere/libLLVM.so does not exist"
