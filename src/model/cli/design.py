"""``vibralign design``: choose the free quantities of a device within its limits."""

import argparse
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

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
from model.show.si import named_words, si_words

if TYPE_CHECKING:
    from model.device.design import Design
    from model.device.design_trials import Trials

_MEASURES = {"time": TIME, "contact_force": FORCE, "tilt": ANGLE}
_line = "{:<23}{}".format


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "design",
        _design,
        "choose the free quantities of a device for the largest margin, then time",
        ". The device file names what is free (free: {press_force: 5 to 20 N}) and the limits "
        "(limits: {contact_force: 60 N, time: 0.2 s, tilt: 10 deg, vibration: needed}, or not "
        "needed; time and tilt until alignment, not until insertion). Each setting is tried "
        "quickly, by devices within one, two and three times the tolerances. Of the settings with "
        "which all devices within the tolerances go in, the best is the one whose nearest failure "
        "is farthest, then the fastest. It is checked as `vibralign assess` checks it; if it does "
        "not hold, the next best is.",
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

    with ProgressLine() as line:

        def after(generation: int, tried: int) -> None:
            line.begin(f"generation {generation} done, {tried:,} settings tried")

        line.begin("generation 1")
        design = search(trials, generations, population, after)
        line.begin("recommended setting")
        verdict = _verdict(design, trials, given)
    assumed = assumptions_with(
        trials.stated, design.setting, given.settings, given.study.maps.ensemble,
        tolerances_assumed=assumed_tolerances,
    )  # fmt: skip
    _write(arguments, design, trials.stated, assumed)
    if arguments.json:
        print_json(_record(design, trials) | {"verdict": verdict, "assumptions": assumed})
    else:
        print("\n".join([*_report(design, trials, verdict), *lines_of(assumed)]))
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


def _verdict(design: "Design", trials: "Trials", given: Inputs) -> str:
    """Return what ``assess`` says of the recommended setting."""
    from model.device.assess import assess  # noqa: PLC0415  (as in _design)

    stated = trials.stated.changed(**design.setting)
    settings = stated.run_settings(given.settings, stated.units)
    result = assess(stated, settings, given.study.maps.ensemble, trials.cores, vary=False)
    return headline(result, design.check if design.check and design.check.devices else None)


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


def _report(design: "Design", trials: "Trials", verdict: str) -> list[str]:
    from model.device.design_trials import POINTS  # noqa: PLC0415  (as in _design)

    tried, best = design.tried, design.best
    word = "recommended" if design.feasible else "nearest to it"
    margin = tried.margin[best]
    all_go_in = tried.share[best] >= 1.0
    lines = []
    if not design.feasible:
        rule = "keeps the limits" if all_go_in else "goes in with all devices within the tolerances"
        lines = [f"no setting of those tried {rule}"]
    lines += [_line(word, named_words(design.setting)), _line("verdict", verdict)]
    words = f"{margin:.3g} tolerances away" if margin < 3.0 else "none within three tolerances"
    words += f", on {POINTS} lines from every start" if design.feasible else ""
    lines.append(_line("nearest failure", words))
    for name, quantity in _MEASURES.items():
        limit = design.limits.get(name)
        most = "" if limit is None else f" (limit {si_words(limit, quantity)})"
        if name == "time":  # what does not go in has none
            most = f" until alignment{'' if all_go_in else ', of the runs that go in'}{most}"
        value = si_words(float(tried.measures[name][best]), quantity)
        lines.append(_line(f"largest {name}", value + most))
    if "vibration" in design.limits:
        share, asked = tried.measures["vibration"][best], _asked(design.limits["vibration"])
        words = f"needed by {100.0 * share:.3g} % of the devices within the tolerances"
        lines.append(_line("vibration", f"{words} (limit: {asked})"))
    binding = design.binding(trials.stated.free)
    if not all_go_in:
        binding.append("the tolerances")
    lines.append(_line("what binds", ", ".join(binding) or "nothing: it lies inside"))
    words = f"{tried.share.size} settings, quickly; {len(design.checks)} as assess checks them"
    if design.check is not None:
        words += f", this one by {design.check.devices} devices"
    lines.append(_line("tried", words))
    if not design.feasible:
        lines += _relaxed(design)
    elif len(design.front) > 1:
        words = "front of time against margin, by quick trials: assess one before you take it"
        lines += [words, *_front(design)]
    return lines


def _front(design: "Design") -> list[str]:
    """Return a table of some eight settings on the front."""
    tried, rows = design.tried, []
    for i in design.front[:: max(len(design.front) // 8, 1)]:
        setting = {name: float(values[i]) for name, values in tried.settings.items()}
        time = si_words(float(tried.measures["time"][i]), TIME)
        rows.append((time, f"{tried.margin[i]:.3g} tolerances", named_words(setting)))
    return in_columns(rows)


def _relaxed(design: "Design") -> list[str]:
    """Return a line for each limit that would suffice if it were relaxed."""
    relaxed = design.to_relax()
    if not relaxed:
        share = design.tried.share[design.best]
        words = "no limit alone: relax two, widen the free ranges or tighten the tolerances"
        if share < 1.0:
            words = "no limit: widen the free ranges, or tighten the tolerances (see assess)"
        return [_line("what to relax", words)]
    lines = []
    for name, value in relaxed.items():
        if name == "vibration":
            words = f"vibration: leave out that it is {_asked(design.limits[name])}"
            lines.append(_line("what to relax", words))
            continue
        limit, quantity = design.limits[name], _MEASURES[name]
        change = 100.0 * (value / limit - 1.0)
        words = f"{name} from {si_words(limit, quantity)} to {si_words(value, quantity)}"
        number = design.relaxing()[name]
        place = {n: float(v[number]) for n, v in design.tried.settings.items()}
        known = "as assess checks it" if number in design.checks else "by a quick trial"
        words += f" ({change:+.2g} %): {named_words(place)}, {known}"
        lines.append(_line("what to relax", words))
    return lines


def _asked(share: float) -> str:
    """Return the words by which a device file states this limit of the vibration."""
    return next(words for words, each in VIBRATION.items() if each == share)


def _record(design: "Design", trials: "Trials") -> dict[str, Any]:
    from model.device.yields import CONFIDENCE  # noqa: PLC0415  (as in _design)

    tried, best = design.tried, design.best
    return {
        "feasible": design.feasible,
        "setting": design.setting,
        "yield": float(tried.share[best]),
        "yield_interval": design.interval,
        "yield_confidence": CONFIDENCE,
        "devices": design.check and design.check.devices,
        "margin": float(tried.margin[best]),
        **{name: float(values[best]) for name, values in tried.measures.items()},
        "binding": design.binding(trials.stated.free),
        "relax": {} if design.feasible else design.to_relax(),
        "tried": int(tried.share.size),
        "checked": len(design.checks),
    }
