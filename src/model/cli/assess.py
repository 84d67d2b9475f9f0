"""``vibralign assess``: assess the reliability of a device and the leeway of its parameters."""

import argparse
import os
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from model.cli.arguments import (
    add_command,
    add_json,
    add_model_options,
    announce_compilation,
    device_of,
    settings_of,
)
from model.cli.simulate import twin_record
from model.cli.tables import in_columns, print_json
from model.physics.parameters import FIELDS
from model.physics.quantities import TIME, Quantity
from model.physics.units import Units
from model.runs.simulate import simulate
from model.runs.twin import twin_words
from model.study.config import load_study, study_path

if TYPE_CHECKING:
    from model.study.assessment import Assessment, Leeway


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "assess",
        _assess,
        "assess the reliability and speed of a device and the leeway of its parameters",
        ". A reliable device aligns from every phase of "
        "the excitation and initial tilt that the study tries. Each parameter is then varied, the "
        "others held, by up to a factor of four or until the device is not reliable.",
        epilog="exit code: 0 the device was assessed, with any result; 2 bad input",
    )
    add_model_options(parser)
    add_json(parser)


def _assess(arguments: argparse.Namespace) -> int:
    study = load_study(study_path())
    units, device, start = device_of(study.baseline, arguments)
    settings = settings_of(study.settings.settings, arguments, units, start)
    announce_compilation()
    from model.study.assessment import assess  # noqa: PLC0415  (only this command)

    found = assess(device, settings, study.maps.ensemble, cores=os.cpu_count() or 1)
    if arguments.json:
        print_json(_record(found, units) | twin_record(device, settings))
        return 0
    print("\n".join(_report(found, units)))
    print(twin_words(device, settings))
    if found.failing_start is not None:
        run = simulate(device.replace(**found.failing_start), settings)
        failing = ", ".join(f"{name} = {value:.4g}" for name, value in found.failing_start.items())
        print(f"{'for example':<16}{failing}: {run.message}")
        print(f"{'what to do':<16}{run.remedy}")
    return 0


def _scale(units: Units | None, quantity: Quantity) -> tuple[float, str]:
    """Value of one dimensionless ``quantity`` in the units of the user, and its unit."""
    if units is None:
        return 1.0, ""
    return units.of(quantity), "" if quantity.unit == "1" else f" {quantity.unit}"


def _report(found: "Assessment", units: Units | None) -> list[str]:
    time, second = _scale(units, TIME)
    words = "reliable" if found.reliable else "not reliable"
    lines = [f"{words:<16}aligns from {found.aligned} of {found.starts} starts"]
    if found.aligned:
        shortest, longest = time * found.tau_best, time * found.tau_worst
        lines.append(f"{'alignment time':<16}{shortest:.4g} to {longest:.4g}{second}, by the start")
    if found.leeways:
        lines.append("stays reliable while, one parameter at a time,")
        lines += in_columns([_row(each, units) for each in found.leeways])
    return lines


def _row(leeway: "Leeway", units: Units | None) -> tuple[str, ...]:
    one, unit = _scale(units, FIELDS[leeway.parameter].quantity)
    low = f"{one * leeway.low:.4g}" + ("" if leeway.bounded_below else " or less")
    high = f"{one * leeway.high:.4g}" + ("" if leeway.bounded_above else " or more")
    own = f"its value {one * leeway.value:.4g}{unit}"
    return leeway.parameter, f"from {low}", f"to {high}", own


def _record(found: "Assessment", units: Units | None) -> dict[str, Any]:
    """The assessment as JSON, in SI units for a device in SI; NaN becomes null."""
    record = asdict(found) | {"reliable": found.reliable}
    time, _ = _scale(units, TIME)
    for name in ("tau_best", "tau_worst"):
        record[name] = time * record[name] if found.aligned else None
    for leeway in record["leeways"]:
        one, _ = _scale(units, FIELDS[leeway["parameter"]].quantity)
        leeway |= {name: one * leeway[name] for name in ("value", "low", "high")}
    return {"units": "1" if units is None else "SI", **record}
