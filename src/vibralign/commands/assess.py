"""``vibralign assess``: assess a device: its sheet, its details, and all of it as JSON."""

import argparse
import os
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from model.physics.quantities import FORCE, STIFFNESS, TIME
from model.physics.tables import vars_of
from model.physics.units import Units
from vibralign.answers import si
from vibralign.answers.assumptions import assumptions, lines_of
from vibralign.answers.forces import tip_record
from vibralign.answers.lever import lever_record
from vibralign.commands.arguments import (
    add_model_options,
    announce_compilation,
    number,
    read_device,
)
from vibralign.commands.files import check_file, writing
from vibralign.commands.known import assess_in_part
from vibralign.commands.limits import exceeded_words, limit_rows
from vibralign.commands.program import add_command, add_json
from vibralign.commands.progress import ProgressLine
from vibralign.commands.simulate import unvibrated_record
from vibralign.commands.tables import print_json
from vibralign.commands.tables import report_line as _line
from vibralign.commands.yields import (
    required_words,
    yield_lines,
    yield_record,
    yield_rows,
    yield_words,
)
from vibralign.device.approach import Approach
from vibralign.device.plausibility import DISTRUSTED

if TYPE_CHECKING:
    from model.runs.settings import Settings
    from model.sweeps.starts import Starts
    from vibralign.answers.assess import Assessment
    from vibralign.answers.design_trials import Check
    from vibralign.answers.limits import LimitResult
    from vibralign.answers.verdicts import Verdict
    from vibralign.answers.yields import FailingDevice, Yield
    from vibralign.device import StatedDevice


_NO_CHANGE = "no change that was tried helps: map it, such as over press_force and amplitude"


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "assess",
        _assess,
        "assess the reliability and speed of a device, its leeways and its yield",
        ". A reliable device goes in (or aligns, with --scene alignment) from every phase of the "
        "excitation, tilt and approach tried; if its file states no base, also on every base "
        "tried, from 100 times its axial stiffness up to steel. Each parameter is varied, the "
        "others held, by up to a factor of four or until the device is not reliable. If the file "
        "states tolerances, devices are drawn within them: assess prints their yield, and what is "
        "to blame for failures. If it states ranges of unknown quantities, assess prints for "
        "which share of what is possible the device is reliable, what decides, and what to "
        "measure.",
        epilog="exit code: 0 the device was assessed; 1 with --require, the yield or the "
        "share of what is possible is too low, or a limit of the file is exceeded; 2 bad input",
    )
    add = parser.add_argument
    words = "exit with 1 unless, with 95 %% confidence, the yield is at least this, or the share "
    words += "of what is possible"
    add("--require", metavar="YIELD", help=words)
    words = "most devices drawn within the tolerances, a power of two (default: 4096); fewer once "
    words += "the interval of the yield is below 95 %%, narrower than 10 %%, and excludes --require"
    add("--devices", metavar="N", default="4096", help=words)
    words = "print below the sheet each approach, base and tilt, all leeways, and what is assumed"
    add("--details", action="store_true", help=words)
    words = "write the device sheet FILE (.html): numbers, verdict, map, run; prints on A4"
    add("--sheet", type=Path, metavar="FILE", help=words)
    add_model_options(parser, scene="insertion")
    add_json(parser)


def _assess(arguments: argparse.Namespace) -> int:
    own, settings = read_device(arguments, known_in_part=True, needless=True)
    required, devices = _required(arguments, own)
    needless = "" if own.unknown else own.needless
    _check_sheet(arguments, needless)
    if own.unknown:
        return assess_in_part(arguments, own, settings, required)
    announce_compilation()
    from model.sweeps.settings import Ensemble  # noqa: PLC0415
    from vibralign.answers.approaches import in_worst_approach  # noqa: PLC0415
    from vibralign.answers.assess import assess  # noqa: PLC0415  (only this command)
    from vibralign.answers.cases import cases_of  # noqa: PLC0415
    from vibralign.answers.limits import limit_results  # noqa: PLC0415

    ensemble, cores, stated = Ensemble(), os.cpu_count() or 1, own
    result, drawn, nearest = None, None, None
    with ProgressLine() as line:
        if not needless:
            line.begin("starts, bases and leeways")
            result = assess(own, settings, ensemble, cores)
        if own.tolerances:
            line.begin("devices within the tolerances")
            worst = result and own.lowered(result.worst)
            stated = worst or in_worst_approach(own, settings, ensemble, cores)
            cases = cases_of(stated, ensemble, varied=stated.tolerances)
            drawn, nearest = _drawn(
                result, stated, cases, settings, cores, devices=devices, required=required
            )
    limits = limit_results(stated, result, drawn, settings)
    kept = all(each.exceeding is None for each in limits)
    met = drawn is None or required is None or (drawn.meets(required) and kept)
    assumed = assumptions(own.parameters, settings, own, ensemble)  # not the worst approach's
    if result is not None and not own.base_is_stated:
        assumed["base"] = (
            f"worst of {len(result.bases)} that are tried, this one first: " + (assumed["base"])
        )
    verdict = headline(result, drawn, limits, needless)
    soft = [] if needless else [each for each in own.doubts if DISTRUSTED in each]
    verdict += f"; {DISTRUSTED}: the base is soft" if soft else ""
    if arguments.json:
        print_json(
            (_record(result, settings) if result else {"needs_alignment": False})
            | {"verdict": verdict}
            | {"yield": drawn and yield_record(drawn, nearest, stated, settings)}
            | {"limits": [asdict(each) | {"kept": each.exceeding is None} for each in limits]}
            | {"assumptions": assumed}
        )
        return int(not met)
    from vibralign.answers.sheet import device_words, sheet_rows  # noqa: PLC0415  (as above)
    from vibralign.commands.details import leeway_lines, verdict_lines  # noqa: PLC0415

    more, rest = limit_rows(limits), list[str]()
    more += [("to trust it", each.partition(f"{DISTRUSTED}: ")[2]) for each in soft]
    if result and result.failing_start is not None and not result.change:
        more = [("next", _NO_CHANGE), *more]
    if drawn is not None:
        of_yield = yield_rows(drawn, nearest, stated, required_words(required, drawn, kept=kept))
        more, rest = of_yield + more, yield_lines(drawn, nearest, stated, settings)
    rows, details = [("device", device_words(stated)), ("verdict", verdict), *more], []
    if result is not None:
        rows, details = sheet_rows(result, verdict, more), leeway_lines(result)
        details = [*verdict_lines(result, settings), *details]
    groups = {
        "Sheet": [_line(*row) for row in rows],
        "Details": details,
        "Yield": rest,
        "Assumptions": lines_of(assumed),
    }
    shown = groups.values() if arguments.details else [groups["Sheet"]]
    print("\n".join(line for lines in shown for line in lines))
    if not arguments.details:
        words = "--details (every approach, base and tilt, all leeways, what is assumed), "
        words += "--sheet FILE, --json"
        print(_line("more", words if result else "--details (forces, what is assumed), --json"))
    if result is not None and arguments.sheet is not None:
        from vibralign.commands import sheet  # noqa: PLC0415  (as above)

        good = result.reliable and kept and (drawn is None or drawn.share == 1.0)
        with line, writing():
            line.begin("map of what goes in")
            titled = {title: lines for title, lines in groups.items() if lines}
            sheet.write_sheet(arguments.sheet, own, (verdict, good), titled, result, settings)
    return int(not met)


def _check_sheet(arguments: argparse.Namespace, needless: str) -> None:
    if arguments.sheet is not None:
        check_file(arguments.sheet, "--sheet", ["html"])
        if needless:
            raise ValueError(
                f"--sheet: there is no run to draw, as {needless}; `vibralign map --x "
                "misalignment FROM TO` draws beyond"
            )


def headline(
    result: "Assessment | None",
    drawn: "Yield | Check | None",
    limits: "Sequence[LimitResult]" = (),
    needless: str = "",
) -> str:
    """Return the verdict on a device at its stated values, and within its tolerances."""
    from vibralign.answers.sheet import verdict_words  # noqa: PLC0415  (as in _assess)

    words = verdict_words(result) if result else needless
    exceeds, drawn_exceed = (exceeded_words(limits, only_drawn=only) for only in (False, True))
    if exceeds:
        words += f", {'and' if result and not result.reliable else 'but'} {exceeds}"
    if drawn is None:
        return f"{words}; no tolerances are stated"
    words += f"; yield {yield_words(drawn)} under the tolerances"
    return f"{words}; some of the devices drawn {drawn_exceed}" if drawn_exceed else words


def _required(arguments: argparse.Namespace, stated: "StatedDevice") -> tuple[float | None, int]:
    """Return the yield of --require, or None, and the number of --devices."""
    from vibralign.answers.yields import check_devices  # noqa: PLC0415  (only this command)

    devices = check_devices(number("devices", arguments.devices))
    if arguments.require is None:
        return None, devices
    required = number("require", arguments.require)
    if not 0.0 < required < 1.0:
        raise ValueError(f"require = {arguments.require}: must be between 0 and 1")
    if not (stated.tolerances or stated.unknown):
        raise ValueError("--require needs a device with tolerances, such as friction: 0.15 ± 0.05")
    return required, devices


def _drawn(
    result: "Assessment | None",
    stated: "StatedDevice",
    cases: "Starts",
    settings: "Settings",
    cores: int,
    **options: Any,
) -> tuple["Yield", "FailingDevice | None"]:
    """Return the yield of a device, and the nearest drawn device that fails."""
    from vibralign.answers import yields  # noqa: PLC0415  (scipy)
    from vibralign.answers.reliability import counted  # noqa: PLC0415

    drawn, results = yields.yield_of(stated, cases, counted(settings), cores, **options)
    if result is not None and result.failing_start is not None:
        return drawn, None
    return drawn, yields.nearest_failing(stated, results, cases)


def _record(result: "Assessment", settings: "Settings") -> dict[str, Any]:
    """Return the assessment for --json, in SI units."""
    from vibralign.answers.sheet import texts, value_words  # noqa: PLC0415  (as in _assess)

    units, device = result.device.units, result.device.parameters
    shown = {n: v for n, v in vars_of(result).items() if n not in ("device", "settings")}
    shown["leeways"], shown["nearest"] = (
        [asdict(each) | {"as_stated": texts(result, each)} for each in shown[name]]
        for name in ("leeways", "nearest")
    )
    ranged = result.tilt_range
    named = {n: value_words(result, n, v) for n, v in result.change.items()}
    approaches = {n: getattr(result, n) for n in ("failing_approach", "worst")}
    return {
        "units": "SI",
        "needs_alignment": True,
        **shown,
        **_times(result, units),
        "contact_force_max": result.contact_force_max * si.scale(units, FORCE),
        "forces": {place: each * si.scale(units, FORCE) for place, each in result.forces.items()},
        "inserted": [each * si.scale(units, TIME) for each in result.inserted],
        "reliable": result.reliable,
        "depends_on_base": result.depends_on_base,
        "change_as_stated": named,
        "tilt_range": ranged and asdict(ranged) | {"as_stated": texts(result, ranged)},
        **{n: [_of_verdict(each, units) for each in shown[n]]
           for n in ("bases", "tilts", "approaches")},
        **{n: each and each._asdict() for n, each in approaches.items()},
        **tip_record(result.forces.get("edge", 0.0) * si.scale(units, FORCE), settings),
        **unvibrated_record(device, settings),
        **si.natural_record(device, units),
        **lever_record(device, settings, units),
    }  # fmt: skip


def _times(found: "Assessment | Verdict", units: Units) -> dict[str, float | None]:
    one = si.scale(units, TIME)
    best, worst = (one * each if found.aligned else None for each in found.times)
    return {"tau_best": best, "tau_worst": worst}


def _of_verdict(found: "Verdict", units: Units) -> dict[str, Any]:
    force, of = si.scale(units, FORCE), found.of
    what: dict[str, Any] = {"tilt": of} if isinstance(of, float) else {}
    if isinstance(of, Approach):
        what = {"approach": of._asdict()}
    elif hasattr(of, "contact_stiffness"):
        stiffness = of.contact_stiffness * si.scale(units, STIFFNESS)
        what = of._asdict() | {"contact_stiffness": stiffness}
    counts = {"starts": found.starts, "aligned": found.aligned, "by_press": found.by_press}
    forces = {"force_least": force * found.force_least, "force_most": force * found.force_most}
    return what | counts | _times(found, units) | forces
