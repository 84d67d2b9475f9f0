"""Options that several commands of ``vibralign`` share, read and checked.

Every refusal is a ValueError of one line that names the value, the rule and the valid choices.
"""

import argparse
import math
import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, get_args

from model.compile.cache import cache_folder
from model.events.insertion import INSERTION
from model.physics.approach import Start
from model.physics.parameters import FIELDS, PARAMETER_NAMES, Parameters, Shape, check_name
from model.physics.quantities import LENGTH, TIME
from model.physics.variants import VARIANT_NAMES, Variants
from model.runs.settings import SCENES, Settings
from vibralign.commands.tables import in_columns
from vibralign.device import StatedDevice, load_device
from vibralign.device.amounts import read_positive
from vibralign.device.approach import read_start
from vibralign.device.mouth import MOUTH
from vibralign.device.paper import baseline
from vibralign.device.quantities import QUANTITIES, quantity_of, unit_of
from vibralign.device.spelling import plain
from vibralign.device.stated import FOLLOWED
from vibralign.device.unknown import refusal

_ALL = "all"  # of the equations


def add_model_options(parser: Any, scene: str = "alignment", *, needs_device: bool = True) -> None:
    """Add the options of a device and its run, and end the help with the table of parameters.

    ``scene`` is the default of --scene.
    """
    parser.appendix = lambda: parameter_table(baseline())
    with_device = "" if needs_device else " with --device"
    add = parser.add_argument
    words = "file of the device, with numbers in SI units or with units as in docs/peg.yaml; --set "
    words += "and --horizon are then read in the same way (12 N, 0.8 mm); answers are in SI units"
    add("--device", type=Path, metavar="FILE", required=needs_device, help=words)
    words = "set a parameter of the table below; may be repeated"
    add("--set", action="append", default=[], metavar="NAME=VALUE", dest="changes", help=words)
    names = ", ".join((_ALL, *VARIANT_NAMES))
    words = "variant of a disputed equation of the paper, consistent (the default) or printed; may "
    words += f"be repeated: {names}"
    metavar = "NAME=READING"
    add("--reading", action="append", default=[], metavar=metavar, dest="switches", help=words)
    words = "start without --device: press and vibration set in together (simultaneous, the "
    words += "default); the part rests under a slow press, then is vibrated (pressed); or it is "
    words += "lowered at approach_speed, vibrating (running) or not (still). With --device, state "
    words += "approach_speed and vibrator in the file or by --set"
    # Hidden where a device is needed: there it is refused, with what to write instead.
    add("--start", choices=get_args(Start), help=argparse.SUPPRESS if needs_device else words)
    words = "round part in a round hole, or square part beside a slot, as in the paper (default: "
    words += "as the device's file states, round if it states none"
    words += ")" if needs_device else "; square without --device)"
    add("--shape", choices=get_args(Shape), help=words)
    words = "how far a run is followed: to alignment, or to insertion, jamming or climbing out "
    words += f"(default: {scene})"
    add("--scene", choices=list(SCENES), help=words)
    parser.set_defaults(usual_scene=scene)
    words = f"depth at which a part counts as inserted, in metres{with_device}; needs --scene "
    words += "insertion (default: half of what the press reaches, and at most the half-width)"
    add("--insertion-depth", metavar="DEPTH", help=words)
    words = "latest time until alignment, and as long again until insertion; in seconds"
    words += "" if needs_device else " with --device, else in units of 1/p"
    words += " (default: 300/p)"
    add("--horizon", metavar="H", help=words)
    add("--tolerance", metavar="T", help="largest local error of a step (default: 1e-10)")


def announce_compilation() -> None:
    """Say at a terminal that the kernels are compiled first, unless they are cached."""
    if sys.stderr.isatty() and not any(cache_folder().rglob("*.o")):
        print("compiling the model, this once: some seconds …", file=sys.stderr)


def set_options(changes: Mapping[str, object]) -> dict[str, str]:
    """Return the option --set of each change as it is typed in a shell, by the change's name."""
    return {name: f"--set {shlex.quote(f'{name}={value}')}" for name, value in changes.items()}


def pairs(given: Sequence[str], option: str) -> dict[str, str]:
    """Return the values by name of an option that is given as NAME=VALUE, several times."""
    values: dict[str, str] = {}
    for pair in given:
        name, equals, value = pair.partition("=")
        if not equals:
            raise ValueError(f"{option} {pair!r}: must be NAME=VALUE")
        if name in values:
            raise ValueError(f"{option} {name}: given twice, as {values[name]!r} and {value!r}")
        values[name] = value
    return values


def number(name: str, text: str, rule: str = "must be a number") -> float:
    """Return ``text`` as a number.

    Raises:
        ValueError: it is no number; the message has the ``name`` of the quantity and the ``rule``.
    """
    try:
        return float(plain(text))
    except ValueError:
        raise ValueError(f"{name} = {text!r}: {rule}") from None


def whole_number(name: str, text: str, least: int, most: float = math.inf) -> int:
    """Return ``text`` as a whole number from ``least`` to ``most``; errors as ``number``."""
    rule = f"must be a whole number >= {least}"
    if most < math.inf:
        rule = f"must be a whole number, {least} to {most}"
    value = number(name, text, rule)
    if not (value.is_integer() and least <= value <= most):
        raise ValueError(f"{name} = {text}: {rule}")
    return int(value)


def read_inputs(
    arguments: argparse.Namespace,
) -> tuple[StatedDevice | None, Parameters, Settings]:
    """Return device, parameters and settings of one run; without --device, the paper's."""
    if arguments.device is None:
        return None, _changed(baseline(), arguments.changes), _settings(arguments, stated=False)
    stated, settings = read_device(arguments)
    return stated, stated.parameters, settings


def read_device(
    arguments: argparse.Namespace, *, known_in_part: bool = False, needless: bool = False
) -> tuple[StatedDevice, Settings]:
    """Return the device and the settings of a command, and warn of doubtful values.

    A device with unknown quantities is refused unless it may be ``known_in_part``, one that needs
    no alignment as stated unless it may be ``needless``.
    """
    stated = _stated_device(arguments)
    if stated.needless and not needless:
        raise ValueError(
            f"{stated.source}: {stated.needless}. There is nothing to run: `vibralign assess` "
            "judges the device with its tolerances and limits, `vibralign map --x misalignment "
            "FROM TO` also where the misalignment is larger"
        )
    if stated.unknown and not known_in_part:
        one = next(iter(stated.unknown))
        instead = f"give each with --set {one}=VALUE; assess, design and calibrate take ranges"
        raise refusal(stated.source, stated.unknown, instead)
    settings = _settings(arguments, stated=True)
    if stated.is_chamfered and arguments.scene == INSERTION.name:
        words = f"{arguments.device} states a chamfer: {FOLLOWED}"
        raise ValueError(f"--scene {arguments.scene}: {words}")
    return stated, stated.run_settings(settings, stated.units)


def _stated_device(arguments: argparse.Namespace) -> StatedDevice:
    if arguments.start is not None:
        read_start({"start": arguments.start})
    stated = load_device(arguments.device, pairs(arguments.changes, "--set"), needless=True)
    for name, quantity in (("horizon", TIME), ("insertion_depth", LENGTH)):
        if (text := getattr(arguments, name)) is not None:
            value = read_positive(name, text, quantity.unit)
            stated = replace(stated, **{name: value})  # type: ignore[arg-type]
    if arguments.shape is not None:
        stated = replace(stated, stated_shape=arguments.shape)
    stated.warn()
    return stated


def _changed(device: Parameters, given: Sequence[str]) -> Parameters:
    changes: dict[str, float | None] = {}
    for name, text in pairs(given, "--set").items():
        check_name(name, PARAMETER_NAMES, "parameter")
        field = FIELDS[name]
        if field.derived and text.lower() == "none":
            changes[name] = None
        else:
            changes[name] = number(name, text, field.rule)
    return device.replace(**changes)


def _settings(arguments: argparse.Namespace, *, stated: bool) -> Settings:
    """Return the default settings, changed by the options.

    Horizon and depth of a ``stated`` device are in SI units, and not changed here.
    """
    switches: dict[str, Any] = asdict(Variants())
    for name, value in pairs(arguments.switches, "--reading").items():
        check_name(name, (*VARIANT_NAMES, _ALL), "reading")
        switches |= dict.fromkeys(VARIANT_NAMES if name == _ALL else [name], value)
    horizon, tolerance, depth = Settings.horizon, Settings.tolerance, None
    if arguments.horizon is not None and not stated:
        horizon = number("horizon", arguments.horizon)
    if arguments.insertion_depth is not None and arguments.scene != "insertion":
        raise ValueError(
            f"insertion_depth = {arguments.insertion_depth!r}: needs --scene insertion"
        )
    if arguments.insertion_depth is not None and not stated:
        depth = number("insertion_depth", arguments.insertion_depth)
    if arguments.tolerance is not None:
        tolerance = number("tolerance", arguments.tolerance)
    return Settings(
        readings=Variants(**switches),
        scene=SCENES[arguments.scene or arguments.usual_scene],
        shape=arguments.shape,
        start=None if stated else arguments.start or "simultaneous",
        insertion_depth=depth,
        horizon=horizon,
        tolerance=tolerance,
    )


def parameter_table(device: Parameters) -> str:
    """List name, symbol, value, SI unit and meaning of every quantity that a device states."""
    rows = [("name", "symbol", "paper's", "SI unit", "meaning")]
    for name, field in FIELDS.items():
        value = getattr(device, name)
        paper = f"as {field.derived}" if value is None else f"{value:g}"
        rule = field.rule.removeprefix("must be a finite number").removeprefix(",").strip()
        words = field.description + (f"; {rule}" if rule else "")
        rows.append((name, field.symbol, paper, field.quantity.unit, words))
    lines = ["parameters that --set takes, each a finite number:", *in_columns(rows)]
    others = [name for name in QUANTITIES if name not in FIELDS or name in MOUTH]
    units = [(name, unit_of(name), quantity_of(name)[0]) for name in others]
    lines += ["further quantities of a device file, or other ways to state the same ones:"]
    lines += in_columns(units)
    lines.append("  and fit, such as H7/g6, in place of play")
    return "\n".join(lines) + "\n"
