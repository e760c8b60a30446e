"""What is compared with what: a method is an integrator on one form of the media."""

from dataclasses import dataclass, replace

EXACT = "exact"
TRACKED = "tracked"
# Values of analyticvolpath's spectral_sampling other than its default.
STRATEGIES = ("single", "average", "tracking")


@dataclass(frozen=True)
class Method:
    """`medium` is EXACT, TRACKED (the same, with a boundary where stock integrators need one), or
    the number of voxels along a side of the grid. `strategy` is the integrator's spectral_sampling,
    None for its default."""

    integrator: str
    medium: str | int
    strategy: str | None = None

    @property
    def key(self):
        return f"{self.name}@{self.medium}"

    @property
    def label(self):
        medium = f"{self.medium}³ grid" if self.uses_grid else "exact medium"
        return f"{self.name}, {medium}"

    @property
    def name(self):
        return f"{self.integrator} ({self.strategy})" if self.strategy else self.integrator

    @property
    def plugin(self):
        """The integrator as mi.load_dict takes it, but for what the scene says about depths."""
        properties = {"spectral_sampling": self.strategy} if self.strategy else {}
        return {"type": self.integrator, **properties}

    @property
    def uses_grid(self):
        return self.medium not in (EXACT, TRACKED)

    @property
    def converges_to(self):
        """The medium whose reference image is the method's own."""
        return self.medium if self.uses_grid else EXACT


OURS = Method("analyticvolpath", EXACT)


def methods_for(variant, resolutions, strategies=False):
    """All methods that `variant` can run; volpathmis refuses polarised light.

    `strategies`: those of our integrator, too.
    """
    ours = [OURS, *(replace(OURS, strategy=name) for name in STRATEGIES if strategies)]
    stock = ["volpath"] if variant.endswith("polarized") else ["volpath", "volpathmis"]
    grids = [Method(name, n) for n in resolutions for name in stock]
    return [*ours, *(Method(name, TRACKED) for name in stock), *grids]


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
