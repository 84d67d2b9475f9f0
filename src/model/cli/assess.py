"""``vibralign assess``: assess a device: verdict, base, leeways, and its yield."""

import argparse
import os
import shlex
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from model.cli.arguments import (
    add_command,
    add_json,
    add_model_options,
    announce_compilation,
    device_of,
    number,
    settings_of,
    stated_device,
)
from model.cli.files import check_file, check_picture
from model.cli.simulate import unvibrated_record
from model.cli.tables import in_columns, labelled, print_json
from model.events.outcomes import SUCCESS_TEXT
from model.physics.parameters import FIELDS
from model.physics.quantities import ANGLE, FORCE, SPEED, STIFFNESS, TIME
from model.physics.units import Units
from model.runs.simulate import simulate
from model.runs.unvibrated import unvibrated_words
from model.show.si import in_words, quantity_of, range_words, scale, si_list, si_words
from model.study.config import load_study, study_path

if TYPE_CHECKING:
    from model.runs.settings import Settings
    from model.study.assessment import Assessment, Leeway, Nearest
    from model.study.assessment.yields import FailingDevice, Yield
    from model.study.devices import StatedDevice

_line = partial(labelled, width=16)
_FEW = 256  # devices drawn around one that goes in from no start


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "assess",
        _assess,
        "assess the reliability and speed of a device, its leeways and its yield",
        ". A reliable device goes in (or aligns, with --scene alignment) from every phase of the "
        "excitation and initial tilt that the study tries; if its file states no base, on bases of "
        "100 to 1,000,000 times its axial stiffness as well. Each parameter is then varied, the "
        "others held, by up to a factor of four or until the device is not reliable. If the file "
        "states tolerances, devices are drawn within them: their yield, and what is to blame for "
        "failures.",
        epilog="exit code: 0 the device was assessed; 1 the yield of --require is not met; "
        "2 bad input",
    )
    add = parser.add_argument
    add("--bases", action="store_true", help="try the span of bases even if the base is stated")
    words = "exit with 1 unless the yield is at least this, with 95 %% confidence"
    add("--require", metavar="YIELD", help=words)
    words = "devices drawn within the tolerances, a power of two (default: 4096)"
    add("--devices", metavar="N", default="4096", help=words)
    words = (
        "write the device sheet FILE (.html): numbers, verdict, map, run; prints on A4; links to "
        "the page of `vibralign explore` if it lies beside it as DEVICE.html"
    )
    add("--sheet", type=Path, metavar="FILE", help=words)
    add_model_options(parser, scene="insertion")
    add_json(parser)


def _assess(arguments: argparse.Namespace) -> int:
    study = load_study(study_path())
    stated = stated_device(arguments)
    if stated is None:
        units, device, start = device_of(study.baseline, arguments)
    else:
        (units, device), start = stated.device, stated.start
    settings = settings_of(study.settings.settings, arguments, units, start)
    required, devices = _required(arguments, stated)
    if arguments.sheet is not None:
        check_file(arguments.sheet, "--sheet", ["html"])
        check_picture(arguments.sheet.with_suffix(".png"))
        if stated is None:
            raise ValueError("--sheet needs --device FILE")
    announce_compilation()
    from model.study.assessment import assess  # noqa: PLC0415  (only this command)

    ensemble, cores = study.maps.ensemble, os.cpu_count() or 1
    found = assess(device, settings, ensemble, cores, stated=stated, bases=arguments.bases)
    drawn, nearest = None, None
    if stated is not None and stated.tolerances:
        drawn, nearest = _drawn(found, stated, ensemble, settings, cores, devices)
    met = drawn is None or required is None or drawn.low >= required
    if arguments.json:
        print_json(
            _record(found, units)
            | unvibrated_record(device, settings)
            | {"yield": drawn and _yield_record(drawn, nearest, stated, settings)}
        )
        return int(not met)
    shown = None if arguments.dimensionless else units
    verb = SUCCESS_TEXT[settings.success]
    groups = {"Verdict": _report(found, shown, stated, verb)}
    groups["Verdict"].append(unvibrated_words(device, settings))
    if found.failing_start is not None:
        run = simulate(device.replace(**found.failing_start), settings)
        failing = ", ".join(f"{name} = {value:.4g}" for name, value in found.failing_start.items())
        groups["Verdict"].append(_line("for example", f"{failing}: {run.message}"))
    from_materials = stated is not None and stated.materials is not None
    groups["Leeways"] = [*_advice(found, shown), *_varied(found, shown, from_materials)]
    if drawn is not None and stated is not None:
        groups["Yield"] = _yield_report(found, drawn, nearest, stated, required, settings)
    print("\n".join(line for lines in groups.values() for line in lines))
    if arguments.sheet is not None and stated is not None:
        from model.cli.sheet import write_sheet  # noqa: PLC0415  (as above)

        write_sheet(arguments.sheet, stated, groups, study, settings)
    return int(not met)


def _required(
    arguments: argparse.Namespace, stated: "StatedDevice | None"
) -> tuple[float | None, int]:
    from model.study.assessment.yields import check_devices  # noqa: PLC0415  (only this command)

    devices = check_devices(number("devices", arguments.devices))
    if arguments.require is None:
        return None, devices
    required = number("require", arguments.require)
    if not 0.0 < required < 1.0:
        raise ValueError(f"require = {arguments.require}: must be between 0 and 1")
    if stated is None or not stated.tolerances:
        raise ValueError("--require needs a device with tolerances, such as friction: 0.15 ± 0.05")
    return required, devices


def _drawn(
    found: "Assessment",
    stated: "StatedDevice",
    ensemble: Any,
    settings: Any,
    cores: int,
    devices: int,
) -> tuple["Yield", "FailingDevice | None"]:
    from dataclasses import replace  # noqa: PLC0415

    from model.study.assessment.yields import (  # noqa: PLC0415
        STATISTICAL_TOLERANCE,
        nearest_failing,
        yield_of,
    )
    from model.study.maps.starts import starts_of  # noqa: PLC0415

    settings = replace(settings, tolerance=max(settings.tolerance, STATISTICAL_TOLERANCE))
    starts = starts_of(stated.device.parameters, ensemble)
    if not found.aligned:  # the yield is low: a few devices say so
        devices = min(devices, _FEW)
    drawn, known = yield_of(stated, starts, settings, cores, devices=devices)
    if found.failing_start is not None:
        return drawn, None
    return drawn, nearest_failing(stated, known, starts)


def _report(
    found: "Assessment", units: Units | None, stated: "StatedDevice | None", verb: str
) -> list[str]:
    device = str(stated.source) if stated else "the study's, dimensionless (no --device)"
    starts = f"{verb} from {found.aligned} of {found.starts} starts"
    if found.bases and _open(stated):
        starts += ", on a base of 100 times the axial stiffness"
    lines = [_line("device", device)]
    if found.depends_on_base:
        lines += ["depends on the base: measure it", _line("", starts)]
    else:
        lines.append(_line("reliable" if found.reliable else "not reliable", starts))
    if found.aligned:
        times = range_words(found.tau_best, found.tau_worst, TIME, units)
        lines.append(_line("alignment time", f"{times}, by the start"))
    few, most = found.separations
    hops = f"{few} to {most}" if few != most else str(few)
    speed = in_words(found.impact_speed, SPEED, units)
    lines.append(_line("lift-offs", hops + (f"; touches down at up to {speed}" if most else "")))
    force = in_words(found.contact_force_max, FORCE, units)
    tilt = in_words(found.tilt_max, ANGLE, units)
    lines.append(_line("at most", f"contact force {force}, tilt {tilt}"))
    return lines + _bases(found, units, verb)


def _open(stated: "StatedDevice | None") -> bool:
    return stated is not None and not stated.base_is_stated


def _bases(found: "Assessment", units: Units | None, verb: str) -> list[str]:
    if not found.bases:
        return []
    rows = []
    for each in found.bases:
        impact = (
            "damping as stated"
            if each.restitution is None
            else (f"restitution {each.restitution:g}")
        )
        times = range_words(each.tau_best, each.tau_worst, TIME, units) if each.aligned else "-"
        stiffness = in_words(each.contact_stiffness, STIFFNESS, units)
        ratio = f"({each.contact_stiffness:,.0f} × axial)"
        rows.append((stiffness, ratio, impact, f"{each.aligned} of {each.starts}", times))
    head = f"contact stiffness, impact, starts from which it {verb}, alignment time:"
    return [head, *in_columns(rows), _line("stiff bases", _stiff_bases(found, units))]


def _stiff_bases(found: "Assessment", units: Units | None) -> str:
    stiffest = found.bases[-1].contact_stiffness
    rigid, decided = (
        f"from {in_words(each, STIFFNESS, units)} on" if each and each < stiffest else None
        for each in (found.rigid_from, found.decided_from)
    )
    if rigid:
        return f"neither verdict nor time changes {rigid} (2 %)"
    if decided is None:
        return "the verdict still changes at the stiffest"
    return (
        f"the verdict does not change {decided}; the time changes by "
        f"{100.0 * found.last_change:.2g} % over the last decade"
    )


def _advice(found: "Assessment", units: Units | None) -> list[str]:
    if found.failing_start is None:
        return []
    if not found.nearest:
        words = "no single parameter makes it reliable within a factor of four: change two (map)"
        return [_line("what to do", words)]
    lines = ["reliable instead, one parameter at a time, with"]
    return lines + in_columns([_nearest_row(each, units) for each in found.nearest])


def _varied(found: "Assessment", units: Units | None, from_materials: bool) -> list[str]:
    if not found.leeways:
        return []
    held = "; the contact stiffness is held" if from_materials else ""
    lines = [f"stays reliable while, one parameter at a time (ends known to 0.4 %{held}),"]
    return lines + in_columns([_row(each, units) for each in found.leeways])


def _row(leeway: "Leeway", units: Units | None) -> tuple[str, ...]:
    low, high, own = (
        _value(leeway.parameter, each, units) for each in (leeway.low, leeway.high, leeway.value)
    )
    low += "" if leeway.bounded_below else " or less"
    high += "" if leeway.bounded_above else " or more"
    return leeway.parameter, f"from {low}", f"to {high}", f"its value {own}"


def _nearest_row(each: "Nearest", units: Units | None) -> tuple[str, ...]:
    ends = [
        f"{_value(each.parameter, end, units)} or a little {word}"
        for end, word in ((each.below, "less"), (each.above, "more"))
        if end is not None
    ]
    return (
        each.parameter,
        ", or ".join(ends),
        f"its value {_value(each.parameter, each.value, units)}",
    )


def _value(parameter: str, value: float, units: Units | None) -> str:
    return in_words(value, FIELDS[parameter].quantity, units)


def _yield_report(
    found: "Assessment",
    drawn: "Yield",
    failing: "FailingDevice | None",
    stated: "StatedDevice",
    required: float | None,
    settings: "Settings",
) -> list[str]:
    percent = [f"{100.0 * each:.4g} %" for each in (drawn.share, drawn.low, drawn.high)]
    lines = [
        _line(
            "yield",
            f"{percent[0]} ({percent[1]} to {percent[2]}): {drawn.going_in} of {drawn.devices} "
            "devices within the tolerances go in from every start",
        )
    ]
    if required is not None:
        word = "met" if drawn.low >= required else "not met"
        lines.append(_line("required", f"{100.0 * required:.4g} %: {word}"))
    times = [("alignment time", drawn.time, TIME)] if drawn.going_in else []
    for name, values, quantity in (*times, ("contact force", drawn.force, FORCE)):
        lines.append(_line(name, f"{si_list(values, quantity)} (5, 50, 95 %)"))
    if drawn.blame:
        lines.append("to blame, Sobol' indices: first order and total, of failure and of time")
        lines += in_columns(
            [
                (each.quantity, *(_index(v) for v in (
                    each.failure, each.failure_total, each.time, each.time_total)))
                for each in drawn.blame
            ]
        )  # fmt: skip
    if found.failing_start is not None:
        lines.append(_line("fails nearest", "the device itself is not reliable"))
    elif failing is None:
        lines.append(_line("fails nearest", "none of the devices drawn fails"))
    else:
        off = ", ".join(
            f"{name} = {si_words(value, quantity_of(name))}"
            for name, value in failing.quantities.items()
        )
        words = f"{off}: fails at {100.0 * failing.distance:.3g} % of the tolerances"
        lines += [_line("fails nearest", words), f"  {_command(failing, stated, settings)}"]
    return lines


def _index(value: float) -> str:
    return "-" if value != value else f"{value:.2f}"  # noqa: PLR0124 - NaN


def _yield_record(
    drawn: "Yield",
    failing: "FailingDevice | None",
    stated: "StatedDevice | None",
    settings: "Settings",
) -> dict[str, Any]:
    nearest = None
    if failing is not None and stated is not None:
        nearest = asdict(failing) | {"command": _command(failing, stated, settings)}
    return asdict(drawn) | {"share": drawn.share, "nearest_failing": nearest}


def _command(failing: "FailingDevice", stated: "StatedDevice", settings: "Settings") -> str:
    """Return the command line that runs a device which fails."""
    changes = {**stated.changes, **failing.quantities, **failing.start}
    words = [f"--set {shlex.quote(f'{name}={value}')}" for name, value in changes.items()]
    if settings.insertion_depth is not None:
        depth = settings.insertion_depth * stated.device.units.amplitude
        words.insert(0, f"--insertion-depth {depth!r}")
    scene = f"--scene {settings.scene.name}"
    return f"vibralign simulate --device {stated.source} {scene} {' '.join(words)}"


def _record(found: "Assessment", units: Units | None) -> dict[str, Any]:
    """The assessment as JSON, in SI units for a device in SI; NaN becomes null."""
    record = asdict(found) | {
        "reliable": found.reliable,
        "depends_on_base": found.depends_on_base,
        "rigid_from": found.rigid_from,
    }
    time, stiffness = scale(units, TIME), scale(units, STIFFNESS)
    for each in (record, *record["bases"]):
        for name in ("tau_best", "tau_worst"):
            each[name] = time * each[name] if each["aligned"] else None
    record["contact_force_max"] *= scale(units, FORCE)
    record["impact_speed"] *= scale(units, SPEED)
    for each in record["bases"]:
        each["contact_stiffness"] *= stiffness
    if record["rigid_from"] is not None:
        record["rigid_from"] *= stiffness
    for each in (*record["leeways"], *record["nearest"]):
        one = scale(units, FIELDS[each["parameter"]].quantity)
        for name in ("value", "low", "high", "below", "above"):
            if each.get(name) is not None:
                each[name] *= one
    return {"units": "1" if units is None else "SI", **record}
