"""``vibralign map``: compute a stability map over any two parameters of any device."""

import argparse
import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from model.events.outcomes import SUCCESS_TEXT
from model.physics.quantities import FORCE
from model.sweeps.settings import RunSettings
from vibralign.answers.assumptions import (
    as_attribute,
    assumptions_with,
    at_corners,
    lines_of,
)
from vibralign.answers.forces import until
from vibralign.answers.si import si_list
from vibralign.commands.arguments import (
    add_model_options,
    announce_compilation,
    read_device,
    whole_number,
)
from vibralign.commands.files import check_file, check_picture, writing
from vibralign.commands.program import add_command
from vibralign.commands.progress import ProgressLine
from vibralign.device.amounts import read_amount, read_range
from vibralign.device.quantities import unit_of
from vibralign.device.spelling import ends_of, plain
from vibralign.device.stated import StatedDevice

if TYPE_CHECKING:
    import xarray as xr

    from model.runs.settings import Settings
    from vibralign.answers.maps import DeviceMap, QuantityAxis

_FINEST = 1025
_DEFAULT = 129


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "map",
        _map,
        "map outcome, duration and reliability of a device over two parameters",
        ". Every node of a grid is computed. A reliable device "
        "goes in (or aligns, with --scene alignment) in every case that `vibralign assess` tries; "
        "they are tried at every few nodes only.",
        epilog="exit code: 0 the map was made; 1 it could not be written; 2 bad input",
    )
    add = parser.add_argument
    for side in ("x", "y"):
        words = f"quantity of the device along {side}, with its least and largest value, in SI "
        words += "units or with a unit (0 1, or 0..1, or 10um 20um)"
        add(f"--{side}", nargs="+", required=True, metavar=("NAME", "RANGE"), help=words)
    words = f"values along each side (default: {_DEFAULT})"
    add("--resolution", default=str(_DEFAULT), metavar="N", help=words)
    words = "netCDF file to write; an old one is replaced when the new one is complete"
    add("--out", type=Path, required=True, metavar="FILE", help=words)
    words = "draw the map into FILE (.png, .svg, .pdf and others)"
    add("--plot", type=Path, metavar="FILE", help=words)
    add_model_options(parser, scene="insertion")


def _map(arguments: argparse.Namespace) -> int:
    check_file(arguments.out, "--out", ["nc"])
    if arguments.plot is not None:
        check_picture(arguments.plot)
    device, settings = read_device(arguments, needless=True)
    sweep, assumed = _sweep(arguments, device, settings)
    announce_compilation()
    # Imported here: half a second that only this command needs.
    from model.sweeps.io import write_dataset  # noqa: PLC0415
    from model.sweeps.settings import Ensemble  # noqa: PLC0415
    from model.sweeps.sweep import merge, run  # noqa: PLC0415
    from vibralign.answers.maps import in_every_case  # noqa: PLC0415

    cores, (y, x) = os.cpu_count() or 1, sweep.swept
    with ProgressLine() as line:
        line.begin("nodes and starts")
        parts = [run(sweep, cores=cores)]
        dataset = merge(sweep, f"Area of stable alignment over {x} and {y}", parts)
        line.begin("other approaches and bases")
        dataset = in_every_case(dataset, device, settings, Ensemble(), cores)
    known = until(sweep.settings.settings)
    dataset["contact_force_max"].attrs["comment"] = f"from the stated start, {known}"
    dataset = dataset.assign_attrs(assumptions=as_attribute(assumed))
    with writing():
        write_dataset(dataset, arguments.out)
        if arguments.plot is not None:
            from vibralign.plots.maps import stability_map  # noqa: PLC0415
            from vibralign.plots.style import write  # noqa: PLC0415

            write(stability_map(dataset), arguments.plot)
    print("\n".join([*_report(dataset, device), *lines_of(assumed)]))
    return 0


def _sweep(
    arguments: argparse.Namespace, device: StatedDevice, settings: "Settings"
) -> tuple["DeviceMap", dict[str, str]]:
    """Return the sweep of the map, and what it assumes."""
    count = whole_number("resolution", arguments.resolution, 2, _FINEST)
    from model.sweeps.settings import Ensemble  # noqa: PLC0415  (as in _map)

    starts = Ensemble()
    axes, at = {"--x": arguments.x, "--y": arguments.y}, None
    if "frequency" not in {name for name, *_ in axes.values()}:
        at = device.quantities["frequency"]
    x, y = (_axis(option, words, count, at) for option, words in axes.items())
    from vibralign.answers.maps import corners_of, map_of  # noqa: PLC0415

    sweep = map_of(device, RunSettings.of(settings), (x, y), starts)
    corners = corners_of({axis.parameter: [axis.start, axis.stop] for axis in (x, y)})
    return sweep, at_corners([assumptions_with(device, each, settings, starts) for each in corners])


def _axis(option: str, given: Sequence[str], count: int, frequency: float | None) -> "QuantityAxis":
    """Return ``count`` values of a range, which is given in SI or its own units.

    ``frequency`` in Hz is that of the whole map, None if it has several.
    """
    from vibralign.answers.maps import QuantityAxis  # noqa: PLC0415  (as in _map)

    name, *words = given
    unit = unit_of(name)
    what, text = f"{option} {name}", " ".join(words)
    ends = ends_of(plain(text)) or words
    if len(ends) != 2:
        raise ValueError(f"{what} {text}: must be two values, such as 0 1 or 0..1")
    if ends != words:
        start, stop = read_range(what, text, unit, frequency)
    else:
        start, stop = (read_amount(what, end, unit, frequency).value for end in ends)
    if not -math.inf < start < stop < math.inf:
        raise ValueError(f"{what} {text}: must be two finite numbers, the smaller first")
    return QuantityAxis(parameter=name, start=start, stop=stop, count=count)


def _report(dataset: "xr.Dataset", stated: StatedDevice) -> list[str]:
    from model.sweeps.vibration import ONLY_VIBRATED, added, success_of  # noqa: PLC0415  (as in _map)

    by_vibration = float((added(dataset) == ONLY_VIBRATED).mean())
    success = success_of(dataset)
    share = float((dataset["outcome"] == success).mean())
    rows = [
        (SUCCESS_TEXT[success], f"{100.0 * share:.3g} % of {dataset['outcome'].size:,} nodes"),
        ("vibration", f"{100.0 * by_vibration:.3g} %: does not align without it"),
        ("sensitive", f"{100.0 * float(dataset['sensitive'].mean()):.3g} %: may end differently"),
    ]
    meet = float((dataset["tau_align"] == 0.0).mean())
    if stated.is_chamfered and meet:
        words = f"at {100.0 * meet:.3g} % the chamfers meet, or the part starts inside; "
        rows.append(("at once", f"{words}assess says whether the press slides it in, and how far"))
    force = dataset["contact_force_max"].where(dataset["outcome"] == success)
    if force.notnull().any():
        least, most = float(force.min()), float(force.max())
        words = si_list([least, most], FORCE, " to ")
        words += f" where it {SUCCESS_TEXT[success]}, {force.attrs['comment']}"
        rows.append(("largest force", words))
    if "reliable" in dataset:
        share, nodes = float(dataset["reliable"].mean()), dataset["reliable"].size
        starts = dataset["start_outcome"].size // nodes
        cases = dataset["reliable"].attrs.get("comment", f"from each of {starts} starts")
        words = f"{100.0 * share:.3g} % of {nodes:,} nodes, {cases}"
        rows.insert(1, ("reliable", words))
    return [f"{name:<15}{words}" for name, words in rows]
