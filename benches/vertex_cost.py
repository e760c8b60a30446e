"""Cost of a path vertex: analyticvolpath against stock volpath on a homogeneous fog.

    python benches/vertex_cost.py [VARIANT ...]

The valley of scenes/height_fog.xml, filled with a fog that is all but uniform: an exponential
profile with a scale height of 1e7 m for us, stock `homogeneous` in a cube with a null BSDF for
`volpath`. Both trace the same paths, so the ratio of their process CPU times is the ratio of the
cost of a vertex. One light sample per vertex and no roulette, whose rules differ, on both sides;
rounds are interleaved.
"""

import argparse
import re
import time
from pathlib import Path

import mitsuba as mi
import numpy as np

SCENES = Path(__file__).parent.parent / "scenes"
ROUNDS = 9
SAMPLES = {"scalar": 8, "llvm": 64}
SIGMA_T = 0.002  # 1/m

FOG = f"""
    <float name="sigma_t" value="{SIGMA_T}"/>
    <float name="albedo" value="0.97"/>
    <phase type="hg"><float name="g" value="0.6"/></phase>
</medium>"""
ANALYTIC = """<medium type="analytic" id="fog">
    <string name="profile" value="exponential"/>
    <float name="scale_height" value="1e7"/>"""
BOX = """
    <point name="bbox_min" value="-800, -800, 0"/>
    <point name="bbox_max" value="800, 800, 300"/>"""
HOMOGENEOUS = """<medium type="homogeneous" id="fog">
    <boolean name="has_spectral_extinction" value="false"/>"""
CUBE = """<shape type="cube">
    <transform name="to_world">
        <scale x="800" y="800" z="150"/><translate z="150"/>
    </transform>
    <bsdf type="null"/>
    <ref name="interior" id="fog"/>
</shape>"""


def scene(integrator, medium, boundary=""):
    """The valley with another fog and integrator."""
    text = (SCENES / "height_fog.xml").read_text()
    text = re.sub(r"<medium.*?</medium>", medium + FOG, text, flags=re.S)
    text = re.sub(r'<default name="(sigma_t|scale_height|max_depth|paths)".*?/>', "", text)
    text = re.sub(r"<integrator.*?</integrator>", integrator, text, flags=re.S)
    text = text.replace("</scene>", boundary + "</scene>")
    return mi.load_string(text, res_x="160", res_y="100")


def integrator(name, extra=""):
    depth = '<integer name="max_depth" value="32"/><integer name="rr_depth" value="32"/>'
    return f'<integrator type="{name}">{depth}{extra}</integrator>'


def measure(variant):
    import analytic_media  # noqa: F401, registers the plugins

    mi.set_variant(variant)
    mi.file_resolver().prepend(str(SCENES))
    ours = integrator("analyticvolpath", '<integer name="emitter_samples" value="1"/>')
    scenes = {
        "stock": scene(integrator("volpath"), HOMOGENEOUS, CUBE),
        "ours, bbox": scene(ours, ANALYTIC + BOX),
        "ours, cube": scene(ours, ANALYTIC, CUBE),
    }
    samples = SAMPLES[variant.split("_")[0]]
    seconds = {name: [] for name in scenes}
    images = {name: [] for name in scenes}
    for seed in range(-1, ROUNDS):
        for name, one in scenes.items():
            start = time.process_time()
            image = np.array(mi.render(one, spp=samples, seed=seed + 1))
            if seed >= 0:  # the first round compiles the kernels
                seconds[name].append(time.process_time() - start)
                images[name].append(image)
    variance = {name: np.var(passes, axis=0, ddof=1).mean() for name, passes in images.items()}
    for name in ("ours, bbox", "ours, cube"):
        ratio = np.array(seconds[name]) / np.array(seconds["stock"])
        print(
            f"{variant}: {name}: cost {np.median(ratio):.2f} of stock homogeneous "
            f"(quartiles {np.quantile(ratio, 0.25):.2f} to {np.quantile(ratio, 0.75):.2f}), "
            f"variance {variance[name] / variance['stock']:.2f} of it"
        )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("variants", nargs="*", default=["scalar_rgb", "llvm_ad_rgb"])
    for variant in parser.parse_args().variants:
        measure(variant)
