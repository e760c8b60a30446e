"""Sums of analytic media: against one medium, against stock, and part by part."""

import gc

import mitsuba as mi
import numpy as np
import pytest
import render_scenes as scenes
from zscores import assert_agree, render_passes

SPP = 4
SIZE = 64

OURS = {"type": "analyticvolpath", "max_depth": 6}
VOLPATH = {"type": "volpath", "max_depth": 6}
# Too dark whenever Russian roulette is active, so it gets none.
VOLPATHMIS = {"type": "volpathmis", "max_depth": 6, "rr_depth": 1000}

scalar_and_llvm = pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_rgb"], indirect=True)
scalar_rgb = pytest.mark.parametrize("variant", ["scalar_rgb"], indirect=True)
llvm_ad_rgb = pytest.mark.parametrize("variant", ["llvm_ad_rgb"], indirect=True)


def hg(g):
    return {"type": "hg", "g": g}


def rgb(*value):
    return {"type": "rgb", "value": list(value)}


def analytic(**options):
    return {"type": "analytic"} | options


LOW = analytic(profile="exponential", scale_height=0.5, sigma_t=0.9, albedo=0.95, phase=hg(0.7))
HIGH = analytic(
    profile="exponential",
    scale_height=3.0,
    base_height=0.25,
    sigma_t=0.3,
    albedo=0.5,
    phase=hg(-0.4),
)


def overlap(**options):
    """Two layers, which differ in everything."""
    return {"type": "overlap", "low": LOW, "high": HIGH} | scenes.VALLEY_BOX | options


def render(scene, integrator, side, spp=SPP):
    gc.collect()  # a living medium would be part of every kernel
    return render_passes(scene | {"integrator": integrator}, spp, first_seed=1000 * side)


@scalar_and_llvm
@pytest.mark.parametrize("stock", [VOLPATH, VOLPATHMIS], ids=lambda stock: stock["type"])
def test_overlap_agrees_with_stock_integrators(variant, stock):
    scene = scenes.valley(overlap(), size=SIZE)
    assert_agree(render(scene, stock, 0), render(scene, OURS, 1))
