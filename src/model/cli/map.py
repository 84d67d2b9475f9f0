"""``vibralign map``: compute a stability map over any two parameters of any device."""

import argparse
import importlib.util
import math
import os
from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

from model.cli.arguments import (
    Inputs,
    add_command,
    add_model_options,
    announce_compilation,
    number,
    read_inputs,
)
from model.cli.files import check_file, check_picture, writing
from model.cli.progress import ProgressLine
from model.events.outcomes import SUCCESS_TEXT
from model.physics.parameters import PARAMETER_NAMES, check_name
from model.show.assumptions import as_attribute, assumptions, assumptions_with, at_corners, lines_of
from model.study.config import RunSettings, Span, check_plane
from model.study.devices.amounts import read_amount
from model.study.devices.stated import QUANTITIES, StatedDevice, unit_of

if TYPE_CHECKING:
    import xarray as xr

    from model.study.config import Ensemble
    from model.study.maps.plan import MapPlan

_NEEDED = ("netCDF4", "scipy", "xarray")
_FINEST = 8192
_DEFAULT = 256
_ENSEMBLE = 32  # least cells along a side of the ensemble's lattice, if the map has as many
_STEPS = {"nominal": "outcomes", "unvibrated": "unvibrated", "ensemble": "reliability"}


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "map",
        _map,
        "map outcome, duration and reliability of a device over two parameters",
        ". Nodes are computed along the border of the "
        "aligning area and where the duration jumps, and filled in between. A reliable device "
        "goes in (or aligns, with --scene alignment) from every phase of the excitation and "
        "initial tilt that the study tries. With "
        "--device, the ranges of --x and --y and the map are in SI units, else dimensionless.",
        epilog="exit code: 0 the map was made; 1 it could not be written; 2 bad input",
    )
    add = parser.add_argument
    for side in ("x", "y"):
        words = f"parameter along {side}, with its least and largest value; with --device any "
        words += "quantity of its file, and values such as 10um"
        add(f"--{side}", nargs=3, required=True, metavar=("NAME", "FROM", "TO"), help=words)
    words = f"finest cells along a side, a power of two (default: {_DEFAULT})"
    add("--resolution", default=str(_DEFAULT), metavar="N", help=words)
    words = "netCDF file to write; an old one is replaced when the new one is complete"
    add("--out", type=Path, required=True, metavar="FILE", help=words)
    words = "draw the map into FILE (.png, .svg, .pdf and others)"
    add("--plot", type=Path, metavar="FILE", help=words)
    add_model_options(parser, scene="insertion")


def _map(arguments: argparse.Namespace) -> int:
    missing = [name for name in _NEEDED if importlib.util.find_spec(name) is None]
    if missing:
        raise ValueError(
            f"map needs {', '.join(missing)}, not installed: pip install 'vibralign[study]'"
        )
    check_file(arguments.out, "--out", ["nc"])
    if arguments.plot is not None:
        check_picture(arguments.plot)
    plan, assumed = _plan(arguments)
    announce_compilation()
    # Imported here: half a second that only this command needs.
    from model.study.io import write_dataset  # noqa: PLC0415
    from model.study.maps.compute import MapNodes  # noqa: PLC0415
    from model.study.maps.dataset import map_dataset  # noqa: PLC0415

    title = f"Area of stable alignment over {plan.x.parameter} and {plan.y.parameter}"
    cores = os.cpu_count() or 1
    with ProgressLine() as line:

        def show(step: str, done: int, left: int) -> None:
            line.begin(f"{_STEPS[step]}: {left:,} nodes left, {done:,} starts done")

        dataset = map_dataset(plan, MapNodes(plan), title, cores=cores, progress=show)
    dataset = dataset.assign_attrs(assumptions=as_attribute(assumed))
    with writing():
        write_dataset(dataset, arguments.out)
        if arguments.plot is not None:
            from model.show import plots, style  # noqa: PLC0415

            style.write(plots.draw(dataset), arguments.plot)
    print("\n".join([*_report(dataset), *lines_of(assumed)]))
    return 0


def _plan(arguments: argparse.Namespace) -> tuple["MapPlan", dict[str, str]]:
    """Return the map, and what it assumes."""
    given = read_inputs(arguments)
    stated, parameters, starts = given.stated, given.parameters, given.study.maps.ensemble
    resolution = _resolution(arguments.resolution)
    x, y = (_span(f"--{side}", getattr(arguments, side), stated) for side in ("x", "y"))
    check_plane(stated.at if stated else lambda values: parameters.replace(**values), x, y)
    from model.study.maps.plan import plan_of  # noqa: PLC0415

    every = min(starts.every, max(resolution // _ENSEMBLE, 1))
    starts = starts.model_copy(update={"every": every})
    settings = RunSettings.of(given.settings)
    plan = plan_of("map", parameters, settings, (x, y), resolution, starts, stated)
    corners = product(
        *([(span.parameter, end) for end in (span.start, span.stop)] for span in (x, y))
    )
    assumed = [_assumed(given, starts, dict(each)) for each in corners]
    return plan, at_corners(assumed)


def _assumed(given: Inputs, starts: "Ensemble", values: Mapping[str, float]) -> dict[str, str]:
    """Return what the answer at one place of the map assumes."""
    if given.stated is None:
        return assumptions(given.parameters.replace(**values), given.settings, None, starts)
    return assumptions_with(given.stated, values, given.settings, starts)


def _resolution(text: str) -> int:
    rule = f"must be a power of two, 2 to {_FINEST}"
    value = number("resolution", text, rule)
    if not (2 <= value <= _FINEST and value == int(value) and not int(value) & (int(value) - 1)):
        raise ValueError(f"resolution = {text}: {rule}, since cells are halved")
    return int(value)


def _span(option: str, given: Sequence[str], stated: StatedDevice | None) -> Span:
    """Return a range; that of a ``stated`` device in SI units, or with its units."""
    from model.study.maps.plan import QuantitySpan  # noqa: PLC0415  (as in _map)

    name, *ends = given
    check_name(name, PARAMETER_NAMES if stated is None else QUANTITIES, "parameter")
    if stated is None:
        start, stop = (number(f"{option} {name}", end) for end in ends)
    else:
        unit = unit_of(name)
        start, stop = (read_amount(f"{option} {name}", end, unit).value for end in ends)
    if not (math.isfinite(start) and math.isfinite(stop) and start < stop):
        raise ValueError(
            f"{option} {name} {ends[0]} {ends[1]}: must be two finite numbers, the smaller first"
        )
    kind = Span if stated is None else QuantitySpan
    return kind(parameter=name, start=start, stop=stop)


def _report(dataset: "xr.Dataset") -> list[str]:
    from model.study.vibration import ONLY_VIBRATED, added, success_of  # noqa: PLC0415  (as in _map)

    by_vibration = float((added(dataset) == ONLY_VIBRATED).mean())
    success = success_of(dataset)
    share = float((dataset["outcome"] == success).mean())
    nodes = dataset["outcome"].size
    rows = [
        (SUCCESS_TEXT[success], f"{100.0 * share:.3g} % of the map"),
        ("reliable", f"{100.0 * float(dataset['reliable'].mean()):.3g} % of the map"),
        ("vibration", f"{100.0 * by_vibration:.3g} % of the map: does not align without it"),
        ("flagged", f"{100.0 * float(dataset['flagged'].mean()):.3g} %: may end differently"),
        ("computed", f"{100.0 * dataset.attrs['computed_share']:.3g} % of {nodes:,} nodes"),
        ("trajectories", f"{dataset.attrs['trajectories']:,} starts, the ensemble's included"),
    ]
    return [f"{name:<14}{words}" for name, words in rows]
