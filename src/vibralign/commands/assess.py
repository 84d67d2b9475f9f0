"""``vibralign assess``: assess a device: verdict, bases, leeways and yield."""

import argparse
import os
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from model.events.outcomes import SUCCESS_TEXT
from model.physics.parameters import Parameters
from model.physics.quantities import ANGLE, FORCE, SPEED, STIFFNESS, TIME
from model.physics.units import Units
from model.runs.unvibrated import unvibrated_words
from vibralign.answers import si
from vibralign.answers.assumptions import assumptions, lines_of, source_words
from vibralign.answers.forces import forces_words, tip_record
from vibralign.answers.lever import lever_record, lever_words, wall_words
from vibralign.commands.arguments import (
    add_model_options,
    announce_compilation,
    number,
    read_inputs,
)
from vibralign.commands.files import check_file, check_picture
from vibralign.commands.known import assess_in_part
from vibralign.commands.limits import exceeded_words, limit_lines
from vibralign.commands.program import add_command, add_json
from vibralign.commands.progress import ProgressLine
from vibralign.commands.simulate import unvibrated_record
from vibralign.commands.tables import in_columns, print_json
from vibralign.commands.tables import report_line as _line
from vibralign.commands.yields import yield_record, yield_report, yield_words
from vibralign.device.plausibility import DISTRUSTED, NoNeedError

if TYPE_CHECKING:
    from model.runs.settings import Settings
    from model.sweeps.starts import Starts
    from vibralign.answers.approaches import ApproachVerdict
    from vibralign.answers.assess import Assessment, BaseVerdict, TiltVerdict
    from vibralign.answers.design_trials import Check
    from vibralign.answers.leeways import Leeway, Nearest
    from vibralign.answers.limits import LimitResult
    from vibralign.answers.yields import FailingDevice, Yield
    from vibralign.device import StatedDevice

_FEW = 256  # devices drawn where the stated device goes in from no start: the yield is low


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "assess",
        _assess,
        "assess the reliability and speed of a device, its leeways and its yield",
        ". A reliable device goes in (or aligns, with --scene alignment) from every phase of the "
        "excitation and initial tilt that the study tries; if its file states no base, on bases of "
        "100 times its axial stiffness up to that of steel as well. Each parameter is varied, the "
        "others held, by up to a factor of four or until the device is not reliable. If the file "
        "states tolerances, devices are drawn within them: their yield, and what is to blame for "
        "failures. If it states ranges of what is unknown: for which share of what is possible it "
        "is reliable, what decides, and what to measure.",
        epilog="exit code: 0 the device was assessed; 1 the yield of --require is not met, or a "
        "limit of the file is exceeded with it; "
        "2 bad input",
    )
    add = parser.add_argument
    add("--bases", action="store_true", help="try the span of bases even if the base is stated")
    words = (
        "exit with 1 unless the yield, or the share of what is possible, is at least this, with "
    )
    words += "95 %% confidence"
    add("--require", metavar="YIELD", help=words)
    words = "devices drawn within the tolerances, a power of two (default: 4096)"
    add("--devices", metavar="N", default="4096", help=words)
    words = "write the device sheet FILE (.html): numbers, verdict, map, run; prints on A4"
    add(
        "--plot", type=Path, metavar="FILE", help="draw a verdict over unknown quantities into FILE"
    )
    add("--sheet", type=Path, metavar="FILE", help=words)
    add_model_options(parser, scene="insertion", dimensionless=True)
    add_json(parser)


def _assess(arguments: argparse.Namespace) -> int:
    try:
        given = read_inputs(arguments, known_in_part=True)
    except NoNeedError as found:
        return _without_need(str(found), as_json=arguments.json)
    stated, device, settings = given.stated, given.parameters, given.settings
    required, devices = _required(arguments, stated)
    if stated is not None and stated.unknown:
        return assess_in_part(arguments, given, required)
    if arguments.plot is not None:
        raise ValueError("--plot draws the unknown quantities of a device, and none is unknown")
    if arguments.sheet is not None:
        check_file(arguments.sheet, "--sheet", ["html"])
        check_picture(arguments.sheet.with_suffix(".png"), "--sheet")
        if stated is None:
            raise ValueError("--sheet needs --device FILE")
    announce_compilation()
    from model.sweeps.settings import Ensemble  # noqa: PLC0415
    from vibralign.answers.assess import assess  # noqa: PLC0415  (only this command)
    from vibralign.answers.cases import cases_of  # noqa: PLC0415
    from vibralign.answers.limits import limit_results  # noqa: PLC0415

    ensemble, cores = Ensemble(), os.cpu_count() or 1
    drawn, nearest = None, None
    with ProgressLine() as line:
        line.begin("starts, bases and leeways")
        result = assess(stated or device, settings, ensemble, cores, bases=arguments.bases)
        if stated is not None and stated.tolerances:
            line.begin("devices within the tolerances")
            stated = stated.lowered(result.worst)
            cases = cases_of(stated, ensemble, varied=stated.tolerances)
            drawn, nearest = _drawn(result, stated, cases, settings, cores, devices)
    limits = limit_results(stated, result, drawn, settings) if stated is not None else ()
    kept = all(each.exceeding is None for each in limits)
    met = drawn is None or required is None or (drawn.low >= required and kept)
    assumed = assumptions(device, settings, given.stated, ensemble)  # not the worst approach's
    if stated is not None and not stated.base_is_stated:
        assumed["base"] = (
            f"worst of {len(result.bases)} that are tried, this one first: " + (assumed["base"])
        )
    verdict = headline(result, drawn, limits)
    if stated is not None and any(DISTRUSTED in each for each in stated.doubts):
        verdict += f"; {DISTRUSTED}: the base is soft"
    if arguments.json:
        print_json(
            _record(result, given.units)
            | tip_record(result.forces.get("edge", 0.0) * si.scale(given.units, FORCE), settings)
            | {"verdict": verdict}
            | unvibrated_record(device, settings)
            | si.natural_record(device, given.units)
            | lever_record(device, settings, given.units)
            | {"yield": drawn and stated and yield_record(drawn, nearest, stated, settings)}
            | {"limits": [asdict(each) | {"kept": each.exceeding is None} for each in limits]}
            | {"assumptions": assumed}
        )
        return int(not met)
    units = None if arguments.dimensionless else given.units
    source = "the paper's, dimensionless (no --device)"
    if stated is not None:
        source = source_words(stated)
    groups = {"Verdict": [*_verdict(result, units, device, settings), *limit_lines(limits)]}
    value = partial(_value, stated=stated, units=units)
    groups["Leeways"] = [*_advice(result, value), *_varied(result, value)]
    if drawn is not None and stated is not None:
        words = ""
        if required is not None:
            faults = ["the yield is too low"] if drawn.low < required else []
            faults += [] if kept else ["a limit is exceeded"]
            words = f"{100.0 * required:.4g} %: {'met' if met else 'not met'}"
            words += f", as {' and '.join(faults)}" if faults else ""
        groups["Yield"] = yield_report(result, drawn, nearest, stated, words, settings)
    groups["Assumptions"] = lines_of(assumed)
    head = [_line("device", source), _line("verdict", verdict)]
    print("\n".join([*head, *(line for lines in groups.values() for line in lines)]))
    if arguments.sheet is not None and stated is not None:
        from vibralign.commands.sheet import write_sheet  # noqa: PLC0415  (as above)

        good = result.reliable and kept and (drawn is None or drawn.share == 1.0)
        with ProgressLine() as line:
            line.begin("map of the sheet")
            write_sheet(arguments.sheet, stated, (verdict, good), groups, settings)
    return int(not met)


def _without_need(words: str, *, as_json: bool) -> int:
    """Answer for a device whose place at the mouth says that it needs no alignment."""
    if as_json:
        print_json({"verdict": words, "needs_alignment": False})
    else:
        print(_line("verdict", words))
    return 0


def headline(
    result: "Assessment", drawn: "Yield | Check | None", limits: "Sequence[LimitResult]" = ()
) -> str:
    """Return the verdict on a device at its stated values, and within its tolerances."""
    words = f"{'' if result.reliable else 'not '}reliable at the stated values"
    if result.depends_on_base:
        words = "depends on the base: measure it"
    good = [str(each.approach) for each in result.approaches if each.reliable]
    if result.approaches and not result.reliable:
        which = f"only with the approach {'; '.join(good)}" if good else "with no approach tried"
        words = f"reliable {which}" + (", and it depends on the base" * result.depends_on_base)
    elif result.approaches:
        words = f"{words}, whatever the approach"
    exceeds, drawn_exceed = (exceeded_words(limits, only_drawn=only) for only in (False, True))
    if exceeds:
        words += f", {'but' if result.reliable else 'and'} {exceeds}"
    if drawn is None:
        return f"{words}; no tolerances are stated"
    words += f"; yield {yield_words(drawn)} under the tolerances"
    return f"{words}, but within them it {drawn_exceed}" if drawn_exceed else words


def _required(
    arguments: argparse.Namespace, stated: "StatedDevice | None"
) -> tuple[float | None, int]:
    """Return the yield of --require, or None, and the number of --devices."""
    from vibralign.answers.yields import check_devices  # noqa: PLC0415  (only this command)

    devices = check_devices(number("devices", arguments.devices))
    if arguments.require is None:
        return None, devices
    required = number("require", arguments.require)
    if not 0.0 < required < 1.0:
        raise ValueError(f"require = {arguments.require}: must be between 0 and 1")
    if stated is None or not (stated.tolerances or stated.unknown):
        raise ValueError("--require needs a device with tolerances, such as friction: 0.15 ± 0.05")
    return required, devices


def _drawn(
    result: "Assessment",
    stated: "StatedDevice",
    cases: "Starts",
    settings: "Settings",
    cores: int,
    devices: int,
) -> tuple["Yield", "FailingDevice | None"]:
    """Return the yield of a device, and the nearest drawn device that fails."""
    from vibralign.answers import yields  # noqa: PLC0415  (scipy)
    from vibralign.answers.reliability import STATISTICAL_TOLERANCE  # noqa: PLC0415

    settings = replace(settings, tolerance=max(settings.tolerance, STATISTICAL_TOLERANCE))
    if not result.aligned:
        devices = min(devices, _FEW)
    drawn, results = yields.yield_of(stated, cases, settings, cores, devices=devices)
    if result.failing_start is not None:
        return drawn, None
    return drawn, yields.nearest_failing(stated, results, cases)


def _verdict(
    result: "Assessment",
    units: Units | None,
    device: Parameters,
    settings: "Settings",
) -> list[str]:
    verb = SUCCESS_TEXT[settings.success]
    starts = f"{verb} from {result.aligned} of {result.starts} starts"
    together = result.starts == sum(base.starts for base in result.bases)  # none is stated
    if together:
        starts += f", on {len(result.bases)} bases together"
    lines = [_line("starts", starts)]
    if result.aligned:
        by = "by start and base" if together else "by the start"
        times = si.range_words(result.tau_best, result.tau_worst, TIME, units)
        lines.append(_line("alignment time", f"{times}, {by}"))
        if result.inserted[0] == result.inserted[0]:  # no NaN
            lines.append(_line("inserted after", si.range_words(*result.inserted, TIME, units)))
    fewest, most = result.separations
    hops = f"{fewest} to {most}" if fewest != most else str(fewest)
    if most:
        speed = si.in_words(result.impact_speed, SPEED, units)
        landed = f"touches down at up to {speed}" if result.impact_speed else "touches down no more"
        hops = f"{hops}; {landed}"
    lines.append(_line("lift-offs", hops))
    force = si.in_words(result.contact_force_max, FORCE, units)
    tilt = si.in_words(result.tilt_max, ANGLE, units)
    lines.append(_line("at most", f"contact force {force}, tilt {tilt}, over all starts"))
    lines.append(_line("  of the force", forces_words(result.forces, units, settings)))
    lines += lever_words(device, settings, units)
    lines += wall_words(device, settings, result.tilt_max, units)
    if result.if_square is not None:
        words = f"{verb} from {result.if_square.aligned} of {result.if_square.starts} starts"
        if result.if_square.aligned:
            ends = result.if_square.tau_best, result.if_square.tau_worst
            words += f", aligned in {si.range_words(*ends, TIME, units)}"
        lines.append(_line("if it is square", words))
    if result.bases:
        head = f"contact stiffness, impact, starts from which it {verb}, alignment time:"
        lines += [head, *in_columns([_base_row(base, units) for base in result.bases])]
        lines.append(_line("stiff bases", _stiff_bases(result, units)))
    if result.approaches:
        lines.append(f"approach, cases in which it {verb}, alignment time, largest force by base:")
        lines += in_columns([_approach_row(each, units) for each in result.approaches])
    if result.tilts:
        lines.append(f"gripper's tilt, starts from which it {verb}, alignment time:")
        lines += in_columns([_tilt_row(each, units) for each in result.tilts])
    lines += [si.natural_words(device, units), unvibrated_words(device, settings)]
    if result.failing_start is not None:
        start = ", ".join(f"{name} = {value:.4g}" for name, value in result.failing_start.items())
        if result.failing_approach is not None:
            start = f"{result.failing_approach}: {start}"
        lines += [_line("for example", start), _line("cause", result.cause)]
    return lines


def _approach_row(at: "ApproachVerdict", units: Units | None) -> tuple[str, ...]:
    times = si.range_words(at.tau_best, at.tau_worst, TIME, units) if at.aligned else "-"
    if at.by_press:
        times += f" ({at.by_press} by the press alone)"
    force = si.range_words(at.force_least, at.force_most, FORCE, units)
    return str(at.approach), f"{at.aligned} of {at.starts}", times, force


def _tilt_row(at: "TiltVerdict", units: Units | None) -> tuple[str, ...]:
    times = si.range_words(at.tau_best, at.tau_worst, TIME, units) if at.aligned else "-"
    return si.si_words(at.tilt, ANGLE), f"{at.aligned} of {at.starts}", times


def _base_row(base: "BaseVerdict", units: Units | None) -> tuple[str, ...]:
    impact = "its own damping"
    if base.restitution is not None:
        impact = f"restitution {base.restitution:g}"
    times = si.range_words(base.tau_best, base.tau_worst, TIME, units) if base.aligned else "-"
    stiffness = si.in_words(base.contact_stiffness, STIFFNESS, units)
    ratio = f"({base.contact_stiffness:,.0f} × axial)"
    return stiffness, ratio, impact, f"{base.aligned} of {base.starts}", times


def _stiff_bases(result: "Assessment", units: Units | None) -> str:
    stiffest = result.bases[-1].contact_stiffness
    rigid, decided = (
        f"from {si.in_words(each, STIFFNESS, units)} on" if each and each < stiffest else None
        for each in (result.rigid_from, result.decided_from)
    )
    if rigid:
        return f"neither verdict nor time changes {rigid} (2 %)"
    if decided is None:
        return "the verdict still changes at the stiffest"
    return (
        f"the verdict does not change {decided}; the time changes by "
        f"{100.0 * result.last_change:.2g} % over the last step of stiffness"
    )


def _advice(result: "Assessment", value: Callable[[str, float], str]) -> list[str]:
    if result.failing_start is None:
        return []
    lines = []
    if result.worst is not None:
        lines.append(f"with the approach on which most cases fail ({result.worst}):")
    if result.change:
        words = " and ".join(f"{name} to {value(name, v)}" for name, v in result.change.items())
        borders = [{each.parameter: v} for each in result.nearest for v in (each.below, each.above)]
        tried = "tried; 6 % further it is not" if result.change in borders else "tried"
        lines = [_line("first to change", f"{words}: with it, it is reliable ({tried})")]
    if not result.nearest:
        words = "no single parameter makes it reliable within a factor of four"
        return [*lines, words if lines else f"{words}, nor do two of those tried"]
    lines.append("reliable instead, one parameter at a time, with")
    return lines + in_columns([_nearest_row(each, value) for each in result.nearest])


def _varied(result: "Assessment", value: Callable[[str, float], str]) -> list[str]:
    ranges, lines = list(result.leeways), []
    if result.worst is not None and (result.leeways or result.tilt_range):
        lines.append(f"with the slowest approach ({result.worst}):")
    if result.tilt_range is not None:
        lines.append("goes in while the gripper holds it with one tilt (ends known to 0.005°),")
        lines += in_columns([_leeway_row(result.tilt_range, value)])
        ranges.append(result.tilt_range)
    if result.leeways:
        lines.append("stays reliable while, one parameter at a time (ends known to 0.4 %),")
        lines += in_columns([_leeway_row(each, value) for each in result.leeways])
    if any(each.ragged_below or each.ragged_above for each in ranges):
        lines.append("  ragged: values that fail lie among values that hold; keep well inside")
    return lines


def _leeway_row(leeway: "Leeway", words: Callable[[str, float], str]) -> tuple[str, ...]:
    def end(
        word: str, value: float, fails: float | None, further: str, *, late: bool, ragged: bool
    ) -> str:
        said = f"{word} {words(leeway.parameter, value)}"
        if fails is None:
            return f"{said} or {further}"
        notes = ["by the horizon"] * late
        notes += [f"ragged: {words(leeway.parameter, fails)} fails"] * ragged
        return f"{said} ({', '.join(notes)})" if notes else said

    low = end("from", leeway.low, leeway.fails_below, "less",
              late=leeway.late_below, ragged=leeway.ragged_below)  # fmt: skip
    high = end("to", leeway.high, leeway.fails_above, "more",
               late=leeway.late_above, ragged=leeway.ragged_above)  # fmt: skip
    return leeway.parameter, low, high, f"its value {words(leeway.parameter, leeway.value)}"


def _nearest_row(nearest: "Nearest", words: Callable[[str, float], str]) -> tuple[str, ...]:
    ends = [
        f"{words(nearest.parameter, end)} or a little {word}"
        for end, word in ((nearest.below, "less"), (nearest.above, "more"))
        if end is not None
    ]
    own = words(nearest.parameter, nearest.value)
    return nearest.parameter, ", or ".join(ends), f"its value {own}"


def _value(parameter: str, value: float, stated: "StatedDevice | None", units: Units | None) -> str:
    """Return a value of a device in words; with --dimensionless, without ``units``, in its own."""
    quantity = si.quantity_of(parameter)
    if stated is not None and units is not None:
        return si.written_words(parameter, value, stated)
    if stated is None:
        return si.in_words(value, quantity, None)
    return si.in_words(value / stated.units.of(quantity), quantity, None)


def _record(result: "Assessment", units: Units | None) -> dict[str, Any]:
    """Return the assessment for --json, in SI units for a device with ``units``."""
    record = asdict(result) | {
        "reliable": result.reliable,
        "depends_on_base": result.depends_on_base,
        "rigid_from": result.rigid_from,
    }
    record["tilts"] = [each._asdict() for each in result.tilts]
    record["approaches"] = [
        {**each._asdict(), "approach": each.approach._asdict()} for each in result.approaches
    ]
    for name in ("failing_approach", "worst"):
        approach = getattr(result, name)
        record[name] = approach and approach._asdict()
    time, stiffness = si.scale(units, TIME), si.scale(units, STIFFNESS)
    for each in (record, *record["bases"], *record["tilts"], *record["approaches"]):
        for name in ("tau_best", "tau_worst"):
            each[name] = time * each[name] if each["aligned"] else None
    for each in record["bases"]:
        each["contact_stiffness"] *= stiffness
    force = si.scale(units, FORCE)
    record["contact_force_max"] *= force
    for each in record["approaches"]:
        each["force_least"], each["force_most"] = (
            force * each[name] for name in ("force_least", "force_most")
        )
    record["forces"] = {name: force * each for name, each in record["forces"].items()}
    record["inserted"] = [time * each for each in record["inserted"]]
    record["impact_speed"] = record["impact_speed"] * si.scale(units, SPEED) or None  # never lands
    if record["rigid_from"] is not None:
        record["rigid_from"] *= stiffness
    return {"units": "1" if units is None else "SI", "needs_alignment": True, **record}
