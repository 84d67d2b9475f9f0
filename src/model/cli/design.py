"""``vibralign design``: choose the free quantities of a device within its limits."""

import argparse
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from model.cli.arguments import (
    Inputs,
    add_command,
    add_json,
    add_model_options,
    announce_compilation,
    number,
    read_inputs,
)
from model.cli.assess import headline
from model.cli.files import check_file, check_picture, writing
from model.cli.progress import ProgressLine
from model.cli.tables import in_columns, print_json
from model.device.stated import VIBRATION, StatedDevice
from model.physics.quantities import ANGLE, FORCE, TIME
from model.show.assumptions import as_attribute, assumptions_with, lines_of
from model.show.forces import forces_words
from model.show.si import named_words, quantity_of, si_words

if TYPE_CHECKING:
    from model.device.assess import Assessment
    from model.device.design import Design
    from model.device.design_changes import Change
    from model.device.design_trials import Trials
    from model.runs.settings import Settings

_MEASURES = {"time": TIME, "contact_force": FORCE, "tilt": ANGLE}
_line = "{:<23}{}".format


class _Answer(NamedTuple):
    """What is printed: the design, its trials, what assess says, and changes that were tried."""

    design: "Design"
    trials: "Trials"
    assessed: "Assessment"
    relaxed: "list[Change]"
    widened: "list[Change]"
    halved: "dict[str, Design]"

    @property
    def verdict(self) -> str:
        """The verdict on the recommended setting, as ``assess`` gives it."""
        check = self.design.check
        if check is not None and check.devices:
            return headline(self.assessed, check)
        words = headline(self.assessed, None).partition(";")[0]
        return f"{words}; no others within the tolerances were tried"


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "design",
        _design,
        "choose the free quantities of a device for the largest margin, then time",
        ". The device file names what is free (free: {press_force: 5 to 20 N}) and the limits "
        "(limits: {contact_force: 60 N, time: 0.2 s, tilt: 10 deg, vibration: needed}, or not "
        "needed; time and tilt until alignment, the force until inserted). Each setting is tried "
        "quickly, by devices within one, two and three times the tolerances. Of the settings with "
        "which all devices within the tolerances go in, the best is the one whose nearest failure "
        "is farthest, then the fastest. It is checked as `vibralign assess` checks it; if it does "
        "not hold, the next best is. Then what binds is widened, and tried.",
        epilog="exit code: 0 a setting keeps the limits; 1 none of those tried does; 2 bad input",
    )
    add_model_options(parser, scene="insertion")
    add = parser.add_argument
    words = "netCDF file with every setting tried; an old one is replaced"
    add("--out", type=Path, metavar="FILE", help=words)
    add("--plot", type=Path, metavar="FILE", help="draw time against margin into FILE")
    add("--generations", default="12", metavar="N", help="of the search (default: 12)")
    add("--population", default="24", metavar="N", help="settings a generation (default: 24)")
    add("--seed", default="0", metavar="N", help="of the search (default: 0)")
    words = "devices by which the recommended setting is checked, a power of two (default: 4096)"
    add("--devices", metavar="N", default="4096", help=words)
    add_json(parser)


def _design(arguments: argparse.Namespace) -> int:
    if arguments.device is None:
        raise ValueError("design needs --device FILE, with free quantities")
    if arguments.out is not None:
        check_file(arguments.out, "--out", ["nc"])
    if arguments.plot is not None:
        check_picture(arguments.plot)
    generations, population, seed = (
        _count(name, getattr(arguments, name), least)
        for name, least in (("generations", 1), ("population", 5), ("seed", 0))
    )
    given = read_inputs(arguments)
    trials, assumed_tolerances = _trials(arguments, given, seed)
    announce_compilation()
    from model.device.design import search  # noqa: PLC0415  (only this command)
    from model.device.design_changes import halved, relaxed, widened  # noqa: PLC0415

    with ProgressLine() as line:

        def after(generation: int, tried: int) -> None:
            line.begin(f"generation {generation} done, {tried:,} settings tried")

        line.begin("generation 1")
        design, known = search(trials, generations, population, after)
        line.begin("recommended setting")
        assessed = _assessed(design, trials, given)
        line.begin("what to change")
        changes = relaxed(trials, design, known), widened(trials, design, known)
        answer = _Answer(design, trials, assessed, *changes, halved(trials, design))
    assumed = assumptions_with(
        trials.stated, design.setting, given.settings, given.study.maps.ensemble,
        tolerances_assumed=assumed_tolerances,
    )  # fmt: skip
    _write(arguments, design, trials.stated, assumed)
    if arguments.json:
        print_json(_record(answer) | {"assumptions": assumed})
    else:
        print("\n".join([*_report(answer), *lines_of(assumed)]))
    return int(not design.feasible)


def _trials(arguments: argparse.Namespace, given: Inputs, seed: int) -> tuple["Trials", bool]:
    """Return the trials of the device's settings, and whether its tolerances are assumed."""
    from model.device.cases import cases_of  # noqa: PLC0415
    from model.device.design import with_tolerances  # noqa: PLC0415  (as in _design)
    from model.device.design_trials import Trials  # noqa: PLC0415
    from model.device.yields import check_devices  # noqa: PLC0415

    assert given.stated is not None  # noqa: S101  (--device is given)
    stated, devices = (
        with_tolerances(given.stated),
        check_devices(number("devices", arguments.devices)),
    )
    starts = cases_of(stated, given.study.maps.ensemble)
    trials = Trials(stated, starts, given.settings, os.cpu_count() or 1, seed, devices)
    return trials, stated is not given.stated


def _assessed(design: "Design", trials: "Trials", given: Inputs) -> "Assessment":
    """Return what ``assess`` says of the recommended setting."""
    from model.device.assess import assess  # noqa: PLC0415  (as in _design)

    stated = trials.stated.changed(**design.setting)
    settings = stated.run_settings(given.settings, stated.units)
    helpless = not design.tried.share[design.best] > 0.0  # as stated it does not go in
    return assess(stated, settings, given.study.maps.ensemble, trials.cores, vary=helpless)


def _write(
    arguments: argparse.Namespace,
    design: "Design",
    stated: StatedDevice,
    assumed: Mapping[str, str],
) -> None:
    """Write the files that are asked for."""
    if arguments.out is None and arguments.plot is None:
        return
    from model.device.design_files import design_dataset  # noqa: PLC0415  (as in _design)

    dataset = design_dataset(stated, design).assign_attrs(assumptions=as_attribute(assumed))
    with writing():
        if arguments.out is not None:
            from model.sweeps.io import write_dataset  # noqa: PLC0415

            write_dataset(dataset, arguments.out)
        if arguments.plot is not None:
            from model.show.curves import draw_front  # noqa: PLC0415
            from model.show.style import write  # noqa: PLC0415

            write(draw_front(dataset), arguments.plot)


def _count(name: str, text: str, least: int) -> int:
    rule = f"must be a whole number >= {least}"
    value = number(name, text, rule)
    if not value.is_integer() or value < least:
        raise ValueError(f"{name} = {text}: {rule}")
    return int(value)


def _report(answer: _Answer) -> list[str]:
    from model.device.design_trials import POINTS  # noqa: PLC0415  (as in _design)

    design, tried, best = answer.design, answer.design.tried, answer.design.best
    word = "recommended" if design.feasible else "nearest to it"
    margin = tried.margin[best]
    all_go_in = tried.share[best] >= 1.0
    lines = []
    if not design.feasible:
        rule = "keeps the limits" if all_go_in else "goes in with all devices within the tolerances"
        lines = [f"no setting of those tried {rule}"]
    lines += [_line(word, named_words(design.setting)), _line("verdict", answer.verdict)]
    if answer.assessed.cause:
        lines.append(_line("cause", answer.assessed.cause))
    if answer.assessed.change:
        words = f"{named_words(answer.assessed.change)}: with it, it is reliable (tried)"
        lines.append(_line("first to change", words))
    words = f"{margin:.3g} tolerances away" if margin < 3.0 else "none within three tolerances"
    words += f", on {POINTS} lines from every start" if design.feasible else ""
    lines += [_line("nearest failure", words), *_largest(design, answer.trials.settings)]
    if "vibration" in design.limits:
        share, asked = tried.measures["vibration"][best], _asked(design.limits["vibration"])
        words = f"needed by {100.0 * share:.3g} % of the devices within the tolerances"
        lines.append(_line("vibration", f"{words} (limit: {asked})"))
    binding = [*design.binding, *([] if all_go_in else [_BINDS[bool(tried.share[best] > 0.0)]])]
    lines.append(_line("what binds", ", ".join(binding) or "nothing: it lies inside"))
    words = f"{tried.share.size} settings, quickly; {len(design.checks)} as assess checks them"
    if design.check is not None:
        words += f", this one by {design.check.devices} devices"
    lines += [_line("tried", words), *_changes(answer)]
    if design.feasible and len(design.front) > 1:
        words = "front of time against margin, by quick trials: assess one before you take it"
        lines += [words, *_front(design)]
    return lines


_BINDS = {True: "the tolerances", False: "the device itself: as stated it does not go in"}


def _largest(design: "Design", settings: "Settings") -> list[str]:
    """Return lines on the largest time, force and tilt of the recommended setting."""
    lines = []
    all_go_in = design.tried.share[design.best] >= 1.0
    for name, quantity in _MEASURES.items():
        limit = design.limits.get(name)
        most = "" if limit is None else f" (limit {si_words(limit, quantity)})"
        if name == "time":  # what does not go in has none
            most = f" until alignment{'' if all_go_in else ', of the runs that go in'}{most}"
        value = si_words(float(design.tried.measures[name][design.best]), quantity)
        lines.append(_line(f"largest {name}", value + most))
        if name == "contact_force" and design.check is not None and design.check.forces:
            words = forces_words(design.check.forces, None, settings, in_si=True)
            lines.append(_line("  of the force", words))
    return lines


def _front(design: "Design") -> list[str]:
    """Return a table of some eight settings on the front."""
    tried, rows = design.tried, []
    for i in design.front[:: max(len(design.front) // 8, 1)]:
        setting = {name: float(values[i]) for name, values in tried.settings.items()}
        time = si_words(float(tried.measures["time"][i]), TIME)
        rows.append((time, f"{tried.margin[i]:.3g} tolerances", named_words(setting)))
    return in_columns(rows)


def _changes(answer: _Answer) -> list[str]:
    """Return lines on what to relax, to widen or to narrow, each tried."""
    design, lines = answer.design, []
    for each in answer.relaxed:
        if each.name == "vibration":
            words = f"vibration: leave out that it is {_asked(design.limits[each.name])}"
        else:
            quantity, limit = _MEASURES[each.name], design.limits[each.name]
            ends = f"{si_words(limit, quantity)} to {si_words(each.value, quantity)}"
            words = f"{each.name} from {ends} ({100.0 * (each.value / limit - 1.0):+.2g} %)"
        lines.append(_line("what to relax", f"{words}: {_gives(each.design)}"))
    for wide in answer.widened:
        words = _WIDER[wide.kind].format(wide.name)
        quantity = _MEASURES[wide.name] if wide.kind == "limit" else quantity_of(wide.name)
        words += f" {si_words(wide.value, quantity)}: "
        words += _gives(wide.design) if wide.better else "no better (tried)"
        lines.append(_line("what to widen", words))
    for name, narrow in answer.halved.items():
        words = f"half the tolerance of {name}: {_gives(narrow)}"
        lines.append(_line("what to narrow", words))
    share = design.tried.share[design.best]
    if not design.feasible and design.limits and not answer.relaxed:
        words = "no limit alone" if share == 1.0 else "no limit"
        lines.append(_line("what to relax", f"{words} (tried)"))
    if 0.0 < share < 1.0 and not answer.halved:
        words = "no tolerance alone: with half of it some still fail (tried)"
        lines.append(_line("what to narrow", words))
    return lines


_WIDER = {"limit": "{} up to", "upper end": "{} up to", "lower end": "{} down to"}


def _gives(design: "Design") -> str:
    """Return the results of a setting in words, as they were checked."""
    tried, best = design.tried, design.best
    margin = tried.margin[best]
    words = f"margin {margin:.2g}" if margin < 3.0 else "margin 3 or more"
    parts = [f"{words} tolerances"]
    for name, quantity in _MEASURES.items():
        parts.append(f"{name} {si_words(float(tried.measures[name][best]), quantity)}")
    return f"{', '.join(parts)} with {named_words(design.setting)} (tried)"


def _asked(share: float) -> str:
    """Return the words by which a device file states this limit of the vibration."""
    return next(words for words, each in VIBRATION.items() if each == share)


def _record(answer: _Answer) -> dict[str, Any]:
    from model.device.yields import CONFIDENCE  # noqa: PLC0415  (as in _design)

    design, tried, best = answer.design, answer.design.tried, answer.design.best
    return {
        "feasible": design.feasible,
        "verdict": answer.verdict,
        "cause": answer.assessed.cause,
        "setting": design.setting,
        "yield": float(tried.share[best]),
        "yield_interval": design.interval,
        "yield_confidence": CONFIDENCE,
        "devices": design.check and design.check.devices,
        "margin": float(tried.margin[best]),
        **{name: float(values[best]) for name, values in tried.measures.items()},
        "forces": design.check.forces if design.check else {},
        "binding": design.binding,
        "relax": {each.name: _change_record(each) for each in answer.relaxed},
        "widen": [
            {"kind": each.kind, "name": each.name, "better": each.better, **_change_record(each)}
            for each in answer.widened
        ],
        "narrow": {name: each.setting for name, each in answer.halved.items()},
        "tried": int(tried.share.size),
        "checked": len(design.checks),
    }


def _change_record(change: "Change") -> dict[str, Any]:
    tried, best = change.design.tried, change.design.best
    measures = {name: float(values[best]) for name, values in tried.measures.items()}
    margin = float(tried.margin[best])
    return {"value": change.value, "setting": change.design.setting, "margin": margin, **measures}
