"""The command `analytic-media`."""

import argparse
import shlex
import sys
from pathlib import Path

USAGE_ERROR = 2


def main(arguments=None):
    """Run a command; returns the exit code: 0 done, 1 failed, 2 bad usage."""
    arguments = sys.argv[1:] if arguments is None else arguments
    options = parser().parse_args(arguments)
    options.command_line = shlex.join(["analytic-media", *arguments])
    return options.command(options)


def parser():
    top = argparse.ArgumentParser(
        prog="analytic-media",
        description="Participating media in closed form, for Mitsuba 3: comparisons and tools.",
    )
    commands = top.add_subparsers(required=True, metavar="COMMAND")
    add_compare(commands)
    add_voxelize(commands)
    add_figures(commands)
    add_doctor(commands)
    return top


def add_compare(commands):
    command = commands.add_parser(
        "compare",
        help="render a scene with our media and with its voxelised stock twin; write a report",
        description="Renders SCENE with analyticvolpath and, its media voxelised, with stock "
        "volpath and volpathmis, in turn and for equal CPU time. Writes report.html and "
        "summary.json.",
    )
    command.add_argument("scene", type=Path, metavar="SCENE", help="Mitsuba XML scene")
    command.add_argument(
        "--variant", action="append", metavar="NAME", dest="variants",
        help="Mitsuba variant, may be repeated (default: scalar_rgb and llvm_ad_rgb)",
    )  # fmt: skip
    command.add_argument(
        "--resolutions", type=resolutions, default=(64, 256), metavar="N,N",
        help="voxels along a side of the grids (default: 64,256)",
    )  # fmt: skip
    command.add_argument(
        "--rounds", type=positive(int), default=5, metavar="N",
        help="interleaved rounds (default: 5)",
    )  # fmt: skip
    command.add_argument(
        "--time", type=positive(float), default=6.0, metavar="SECONDS",
        help="process CPU time of each method in each round (default: 6)",
    )  # fmt: skip
    command.add_argument(
        "--reference-time", type=positive(float), metavar="SECONDS",
        help="process CPU time of each reference (default: 7.5 times --time)",
    )  # fmt: skip
    command.add_argument(
        "--spp", type=positive(int), metavar="N",
        help="samples per pixel of each method in each round, instead of equal time",
    )  # fmt: skip
    command.add_argument(
        "--strategies", action="store_true",
        help="compare the other values of analyticvolpath's spectral_sampling, too",
    )  # fmt: skip
    add_output(command, "report")
    add_define(command)
    command.set_defaults(command=run_compare)


def add_voxelize(commands):
    command = commands.add_parser(
        "voxelize",
        help="write the stock twin of a scene: grids, and an XML that uses them",
        description="Samples the analytic media of SCENE on N x N x N voxels and writes .vol files "
        "with a scene for stock Mitsuba.",
    )
    command.add_argument("scene", type=Path, metavar="SCENE", help="Mitsuba XML scene")
    command.add_argument("--medium", metavar="ID", help="this medium only (default: all)")
    command.add_argument(
        "--resolution", type=resolution, default=64, metavar="N",
        help="voxels along every side (default: 64)",
    )  # fmt: skip
    add_output(command, "voxels")
    add_define(command)
    command.set_defaults(command=run_voxelize)


def add_figures(commands):
    command = commands.add_parser(
        "figures",
        help="draw the figures of the article from our own functions",
        description="Writes each figure NAME as NAME.png. Needs no Mitsuba.",
    )
    command.add_argument(
        "names", nargs="*", metavar="NAME", help="figure (default: all; an unknown one lists them)"
    )
    add_output(command, "figures")
    command.set_defaults(command=run_figures)


def add_doctor(commands):
    command = commands.add_parser(
        "doctor", help="what is installed, which variants of Mitsuba work, and why not"
    )
    command.set_defaults(command=run_doctor)


def add_output(command, default):
    command.add_argument(
        "--output", "--out", type=Path, default=Path(default), metavar="DIR",
        help=f"folder for the results (default: {default})",
    )  # fmt: skip


def add_define(command):
    command.add_argument(
        "-D", action="append", type=definition, default=[], metavar="NAME=VALUE",
        dest="definitions", help="value of a $NAME of the scene, may be repeated",
    )  # fmt: skip


def positive(kind):
    """An argparse type: a finite number above 0."""

    def convert(text):
        value = kind(text)
        if not 0 < value < float("inf"):
            raise argparse.ArgumentTypeError(f"must be finite and > 0, got {text}")
        return value

    convert.__name__ = kind.__name__  # what argparse calls it in "invalid int value"
    return convert


def resolution(text):
    value = int(text)
    if not 2 <= value <= 1024:
        raise argparse.ArgumentTypeError(f"must be between 2 and 1024 voxels, got {text}")
    return value


def resolutions(text):
    values = tuple(resolution(part) for part in text.split(","))
    if len(set(values)) != len(values):
        raise argparse.ArgumentTypeError(f"each resolution once, got {text}")
    return values


def definition(text):
    name, equals, value = text.partition("=")
    if not name or not equals:
        raise argparse.ArgumentTypeError(f"must be NAME=VALUE, got {text}")
    return name, value


def complain(message, code):
    print(f"analytic-media: {message}", file=sys.stderr)
    return code


def needs_mitsuba(command):
    """Turn the errors that a user can do something about into one line and an exit code."""

    def guarded(options):
        try:
            import mitsuba as mi
        except ImportError as error:
            return complain(f"this command needs Mitsuba: {error}", 1)
        unknown = set(getattr(options, "variants", None) or ()) - set(mi.variants())
        if unknown:
            known = ", ".join(mi.variants())
            return complain(f"unknown variant {', '.join(sorted(unknown))}; known: {known}", 2)

        from .compare.twin import SceneError
        from .compare.worker import WorkerError

        try:
            return command(options)
        except (SceneError, ValueError) as error:
            return complain(error, USAGE_ERROR)
        except WorkerError as error:
            return complain(f"a render failed\n{error}", 1)

    return guarded


@needs_mitsuba
def run_compare(options):
    from .compare import compare
    from .compare.protocol import Options

    summary = compare(
        Options(
            scene=str(options.scene),
            variants=tuple(dict.fromkeys(options.variants or default_variants())),
            resolutions=options.resolutions,
            rounds=options.rounds,
            seconds=options.time,
            reference_seconds=options.reference_time or 7.5 * options.time,
            spp=options.spp,
            strategies=options.strategies,
            parameters=dict(options.definitions),
        ),
        options.output,
        options.command_line,
    )
    for variant, numbers in summary["variants"].items():
        print_ratios(variant, numbers)
    print(f"Report: {options.output / 'report.html'}")
    return 0


def print_ratios(variant, numbers):
    """Our efficiency over that of the best stock methods, and of our other strategies."""
    named = {
        "best_grid": "the best grid method",
        "best_tracking": "the best stock method on our own medium",
        **{key: m["label"] for key, m in numbers["methods"].items() if m["strategy"]},
    }
    for key, name in named.items():
        ratio = numbers["efficiency_ratios"]["mse"].get(key)
        if ratio:
            print(
                f"{variant}: {ratio['median']:.2f} times the efficiency of {name} "
                f"({ratio['min']:.2f} to {ratio['max']:.2f} over {len(ratio['values'])} rounds)"
            )


def default_variants():
    """scalar_rgb, and llvm_ad_rgb where there is an LLVM."""
    import drjit as dr

    from .doctor import MISSING_LLVM

    if not dr.has_backend(dr.JitBackend.LLVM):
        complain(f"comparing in scalar_rgb only; LLVM {MISSING_LLVM}", 0)
        return ("scalar_rgb",)
    return ("scalar_rgb", "llvm_ad_rgb")


@needs_mitsuba
def run_voxelize(options):
    from .compare.twin_file import write_twin

    scene, grids = write_twin(
        options.scene,
        options.resolution,
        options.output,
        medium=options.medium,
        parameters=dict(options.definitions),
    )
    for grid in grids:
        lower, upper = (", ".join(f"{c:g}" for c in corner) for corner in grid.bbox)
        print(f"{grid.path}: {grid.nbytes / 2**20:.1f} MiB, box ({lower}) to ({upper})")
    print(f"{scene}: renders with stock Mitsuba")
    return 0


def run_figures(options):
    from .figures import UnknownFigure, draw

    try:
        for path in draw(options.names, options.output):
            print(path, flush=True)
    except UnknownFigure as error:
        return complain(error, USAGE_ERROR)
    except OSError as error:
        return complain(error, 1)
    return 0


def run_doctor(_):
    from .doctor import doctor

    return 0 if doctor() else 1


if __name__ == "__main__":
    sys.exit(main())
