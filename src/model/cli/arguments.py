"""What several commands of ``vibralign`` take: parameters, settings, pictures; read and checked.

Every refusal is a ValueError of one line that names the value, the rule and the valid choices.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from model.physics.compiled import cache_folder
from model.physics.parameters import FIELDS, PARAMETER_NAMES, Parameters, check_name
from model.physics.readings import READING_NAMES, Readings
from model.physics.units import UNITS, Units
from model.runs.settings import Settings
from model.study.config import load_study, study_path
from model.study.devices import load_device

_READINGS = ("consistent", "printed")
# Formats of matplotlib that are no pictures, or that need a LaTeX installation.
_NOT_PICTURES = {"pgf", "raw", "rgba"}


def add_model_options(parser: Any) -> None:
    """Add --device, --set, --readings, --reading, --horizon and --tolerance, and their table."""
    parser.appendix = lambda: parameter_table(load_study(study_path()).baseline)
    add = parser.add_argument
    words = "the device, its quantities in SI units as in docs/peg.yaml; --set is then in SI too"
    add("--device", type=Path, metavar="FILE", help=words)
    words = "set a parameter of the table below; may be repeated"
    add("--set", action="append", default=[], metavar="NAME=VALUE", dest="changes", help=words)
    words = "how the paper's equations are read, all switches together (default: as in the study)"
    add("--readings", choices=_READINGS, help=words)
    words = f"one switch, consistent or printed; may be repeated: {', '.join(READING_NAMES)}"
    add(
        "--reading",
        action="append",
        default=[],
        metavar="NAME=READING",
        dest="switches",
        help=words,
    )
    words = "latest time, in units of 1/p (default: that of the study)"
    add("--horizon", metavar="H", help=words)
    add("--tolerance", metavar="T", help="local error of a step (default: that of the study)")


def announce_compilation() -> None:
    """Say at a terminal that the kernels are compiled first, where they are not yet."""
    if sys.stderr.isatty() and not any(cache_folder().rglob("*.nbi")):
        print("compiling the model, this once: about half a minute …", file=sys.stderr)


def pairs(given: Sequence[str], option: str) -> dict[str, str]:
    """NAME=VALUE, …: as a dictionary."""
    found: dict[str, str] = {}
    for pair in given:
        name, equals, value = pair.partition("=")
        if not equals:
            raise ValueError(f"{option} {pair!r}: must be NAME=VALUE")
        if name in found:
            raise ValueError(f"{option} {name}: given twice, as {found[name]!r} and {value!r}")
        found[name] = value
    return found


def number(name: str, text: str, rule: str = "must be a number") -> float:
    """``text`` as a number, else a refusal that names what it is of."""
    try:
        return float(text)
    except ValueError:
        raise ValueError(f"{name} = {text!r}: {rule}") from None


def device_of(
    baseline: Parameters, arguments: argparse.Namespace
) -> tuple[Units | None, Parameters]:
    """What --device and --set say, and the units of a device that is stated in SI.

    Without a device file --set changes the ``baseline``, which has no units.
    """
    if arguments.device is None:
        return None, _changed(baseline, arguments.changes)
    changes = pairs(arguments.changes, "--set").items()
    return load_device(arguments.device, {name: number(name, text) for name, text in changes})


def _changed(baseline: Parameters, given: Sequence[str]) -> Parameters:
    changes: dict[str, float | None] = {}
    for name, text in pairs(given, "--set").items():
        check_name(name, PARAMETER_NAMES, "parameter")
        field = FIELDS[name]
        if field.derived and text.lower() == "none":
            changes[name] = None
        else:
            changes[name] = number(name, text, field.rule)
    return baseline.replace(**changes)


def settings_of(of_study: Settings, arguments: argparse.Namespace) -> Settings:
    """The study's settings with what the options of ``add_model_options`` give."""
    switches: dict[str, Any] = asdict(of_study.readings)
    if arguments.readings:
        switches = dict.fromkeys(READING_NAMES, arguments.readings)
    for name, value in pairs(arguments.switches, "--reading").items():
        check_name(name, READING_NAMES, "reading")
        switches[name] = value
    horizon, tolerance = of_study.horizon, of_study.tolerance
    if arguments.horizon is not None:
        horizon = number("horizon", arguments.horizon)
    if arguments.tolerance is not None:
        tolerance = number("tolerance", arguments.tolerance)
    return Settings(readings=Readings(**switches), horizon=horizon, tolerance=tolerance)


def check_picture(path: Path) -> None:
    """Refuse a picture that could not be written, before the run is computed."""
    try:
        # Half a second that only a plot is worth, and a package that only a plot needs.
        from matplotlib.backend_bases import FigureCanvasBase  # noqa: PLC0415
    except ImportError:
        raise ValueError(
            "--plot needs matplotlib, which is not installed: pip install 'vibralign[plot]'"
        ) from None
    valid = sorted(set(FigureCanvasBase.get_supported_filetypes()) - _NOT_PICTURES)
    check_file(path, "--plot", valid)


def check_file(path: Path, option: str, extensions: Sequence[str]) -> None:
    """Refuse a file that could not be written."""
    if path.suffix.lower().lstrip(".") not in extensions:
        one = "in" if len(extensions) == 1 else "in one of"
        raise ValueError(f"{option} {path}: must end {one} .{', .'.join(extensions)}")
    if not path.parent.is_dir():
        raise ValueError(f"{option} {path}: the folder {path.parent} does not exist")
    if path.is_dir():
        raise ValueError(f"{option} {path}: is a folder, must be a file")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise ValueError(f"{option} {path}: cannot be written, permission denied")


def parameter_table(baseline: Parameters) -> str:
    """Name, symbol, baseline, SI unit and meaning of every parameter; what a device has besides."""
    rows = [("name", "symbol", "baseline", "SI unit", "meaning")]
    for name, field in FIELDS.items():
        value = getattr(baseline, name)
        shown = f"as {field.derived}" if value is None else f"{value:g}"
        rule = field.rule.removeprefix("must be a finite number").removeprefix(",").strip()
        words = field.description + (f"; {rule}" if rule else "")
        rows.append((name, field.symbol, shown, field.quantity.unit, words))
    lines = ["parameters that --set takes, each a finite number:", *in_columns(rows)]
    units = [(name, unit, words) for name, (words, unit) in UNITS.items()]
    lines += ["what a file for --device states besides:", *in_columns(units)]
    return "\n".join(lines) + "\n"


def in_columns(rows: Sequence[tuple[str, ...]]) -> list[str]:
    """Lines of a table, each column as wide as its widest cell."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  " + "  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]
