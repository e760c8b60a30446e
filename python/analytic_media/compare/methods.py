"""What is compared with what: a method is an integrator on one form of the media."""

from dataclasses import dataclass

EXACT = "exact"
TRACKED = "tracked"


@dataclass(frozen=True)
class Method:
    """`medium` is EXACT, TRACKED (the same, with a boundary where stock integrators need one), or
    the number of voxels along a side of the grid."""

    integrator: str
    medium: str | int

    @property
    def key(self):
        return f"{self.integrator}@{self.medium}"

    @property
    def label(self):
        if not self.uses_grid:
            return f"{self.integrator}, exact medium"
        return f"{self.integrator}, {self.medium}³ grid"

    @property
    def uses_grid(self):
        return self.medium not in (EXACT, TRACKED)

    @property
    def converges_to(self):
        """The medium whose reference image is the method's own."""
        return self.medium if self.uses_grid else EXACT


OURS = Method("analyticvolpath", EXACT)


def methods_for(variant, resolutions):
    """All methods that `variant` can run; volpathmis refuses polarised light."""
    stock = ["volpath"] if variant.endswith("polarized") else ["volpath", "volpathmis"]
    grids = [Method(name, n) for n in resolutions for name in stock]
    return [OURS, *(Method(name, TRACKED) for name in stock), *grids]


def reference_integrator(medium, is_grey, variant):
    """(plugin, whether to switch Russian roulette off) for the converged image of a medium.

    Stock volpath draws one channel and follows it without spectral MIS: with chromatic
    extinction its error bars lie. volpathmis is biased while it plays Russian roulette.
    """
    if medium == EXACT:
        return "analyticvolpath", False
    if is_grey or variant.endswith("polarized"):
        return "volpath", False
    return "volpathmis", True


def colour_mode(variant):
    """'rgb', 'spectral', 'mono', ...: variants of one mode converge to the same image."""
    return variant.removeprefix("scalar_").split("_ad_")[-1]
