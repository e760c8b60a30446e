"""The profiles as pictures: density over altitude.

    python docs/images/make_profiles.py

writes profiles.png beside this file.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import analytic_media as am

PROFILES = {
    "constant": am.Constant(),
    "linear, density 1, gradient −0.02": am.Linear(density=1, gradient=-0.02),
    "exponential, scale height 20": am.Exponential(scale_height=20),
}


def main():
    altitude = np.linspace(-10, 80, 500)
    points = altitude[:, None] * np.array([0, 0, 1])
    figure, axis = plt.subplots(figsize=(5, 3.2), layout="constrained")
    for name, profile in PROFILES.items():
        axis.plot(profile.density(points), altitude, label=name)
    axis.axhline(0, color="grey", linewidth=0.8, linestyle=":")
    axis.set(xlabel="relative density", ylabel="altitude, length", xlim=(0, 1.8))
    axis.legend(frameon=False, fontsize=8)
    axis.spines[["top", "right"]].set_visible(False)
    figure.savefig(Path(__file__).with_name("profiles.png"), dpi=110)


if __name__ == "__main__":
    main()
