"""``vibralign design``: choose the free quantities of a device within its limits."""

import argparse
import os
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from model.cli.arguments import (
    add_command,
    add_json,
    add_model_options,
    announce_compilation,
    number,
    settings_of,
    stated_device,
)
from model.cli.files import check_file, check_picture, save_picture
from model.cli.tables import in_columns, labelled, print_json
from model.physics.quantities import ANGLE, FORCE, TIME
from model.show.si import quantity_of, si_words
from model.study.config import load_study, study_path
from model.study.devices.stated import VIBRATION

if TYPE_CHECKING:
    from model.study.design import Design, Misjudged, Search

_MEASURES = {"time": TIME, "contact_force": FORCE, "tilt": ANGLE}
_MISJUDGED = (2.0 / 3.0, 4.0 / 3.0)  # of the friction
_STARTS = 4  # every so many starts of the study
_TOLERANCE = 1e-6  # local error of a step, at least
_line = partial(labelled, width=23)


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "design",
        _design,
        "choose the free quantities of a device for the largest margin, then time",
        ". The device file names what is free (free: {press_force: 5 to 20 N}) and the limits "
        "(limits: {contact_force: 60 N, time: 0.2 s, tilt: 10 deg, vibration: needed}, or not "
        "needed). Every setting that is tried "
        "is judged by devices within the tolerances, and within twice and three times them; of "
        "settings with which all go in, the one whose nearest failure is farthest, then the "
        "fastest.",
        epilog="exit code: 0 a setting keeps the limits; 1 none of those tried does; 2 bad input",
    )
    add_model_options(parser, scene="insertion")
    add = parser.add_argument
    words = "netCDF file with every setting tried; a search that finds its own continues from it"
    add("--out", type=Path, metavar="FILE", help=words)
    add("--plot", type=Path, metavar="FILE", help="draw time against margin into FILE")
    add("--generations", default="12", metavar="N", help="of the search (default: 12)")
    add("--population", default="24", metavar="N", help="settings a generation (default: 24)")
    add("--seed", default="0", metavar="N", help="of the search (default: 0)")
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
    search = _search(arguments, seed)
    announce_compilation()
    design = search.run(generations, population, lambda _: _keep(search, arguments.out))
    _keep(search, arguments.out, design)
    if arguments.plot is not None:
        from model.show.curves import draw_front  # noqa: PLC0415
        from model.study.design import design_dataset  # noqa: PLC0415

        save_picture(draw_front(design_dataset(search, design)), arguments.plot)
    others = _misjudged(search, max(generations // 2, 1), population) if design.feasible else []
    if arguments.json:
        print_json(_record(design, search, others))
    else:
        print("\n".join(_report(design, search, others)))
    return int(not design.feasible)


def _search(arguments: argparse.Namespace, seed: int) -> "Search":
    from model.study.design import Search  # noqa: PLC0415  (only this command)
    from model.study.maps.starts import starts_of  # noqa: PLC0415

    study = load_study(study_path())
    stated = stated_device(arguments)
    assert stated is not None  # noqa: S101  (--device is given)
    settings = settings_of(study.settings.settings, arguments, stated.device.units, stated.start)
    settings = replace(settings, tolerance=max(settings.tolerance, _TOLERANCE))
    starts = starts_of(stated.device.parameters, study.maps.ensemble)[::_STARTS]
    search = Search(stated, starts, settings, os.cpu_count() or 1, seed)
    if arguments.out is not None and arguments.out.exists():
        import xarray as xr  # noqa: PLC0415

        from model.study.design import known_of  # noqa: PLC0415

        with xr.open_dataset(arguments.out) as dataset:
            search.known.update(known_of(dataset, search))
    return search


def _keep(search: "Search", path: Path | None, design: "Design | None" = None) -> None:
    """Write what is known, so that an interrupted search is continued."""
    if path is None:
        return
    from model.study.design import Design, design_dataset  # noqa: PLC0415
    from model.study.io import write_dataset  # noqa: PLC0415

    design = design or Design(search.all_known(), 0, search.stated.limits)
    write_dataset(design_dataset(search, design), path)


def _misjudged(search: "Search", generations: int, population: int) -> "list[Misjudged]":
    from model.study.design import misjudged  # noqa: PLC0415

    friction = search.stated.quantities["friction"]
    return [misjudged(search, friction * by, generations, population) for by in _MISJUDGED]


def _count(name: str, text: str, least: int) -> int:
    value = number(name, text, f"must be a whole number >= {least}")
    if value != int(value) or value < least:
        raise ValueError(f"{name} = {text}: must be a whole number >= {least}")
    return int(value)


def _setting(setting: Any) -> str:
    return ", ".join(f"{name} = {_value(name, value)}" for name, value in setting.items())


def _value(name: str, value: float) -> str:
    return si_words(value, _MEASURES.get(name) or quantity_of(name))


def _report(design: "Design", search: "Search", others: "list[Misjudged]") -> list[str]:
    judged, best = design.judged, design.best
    word = "recommended" if design.feasible else "nearest to it"
    share = f"{100.0 * judged.share[best]:.4g} % of the devices within the tolerances go in"
    margin = judged.margin[best]
    lines = [] if design.feasible else ["no setting of those tried keeps the limits"]
    lines += [_line(word, _setting(design.setting)), _line("yield", share)]
    words = f"{margin:.3g} tolerances away" if margin < 3.0 else "none within three tolerances"
    lines.append(_line("nearest failure", words))
    for name, quantity in _MEASURES.items():
        limit = design.limits.get(name)
        most = "" if limit is None else f" (limit {si_words(limit, quantity)})"
        value = si_words(float(judged.measures[name][best]), quantity)
        lines.append(_line(f"largest {name}", value + most))
    if "vibration" in design.limits:
        needs, asked = judged.measures["vibration"][best], _asked(design.limits["vibration"])
        words = f"needed by {100.0 * needs:.3g} % of the devices within the tolerances"
        lines.append(_line("vibration", f"{words} (limit: {asked})"))
    binding = design.binding(search.stated.free)
    lines.append(_line("what binds", ", ".join(binding) or "nothing: it lies inside"))
    lines.append(_line("tried", f"{judged.share.size} settings"))
    if not design.feasible:
        lines += _relax(design)
    elif len(design.front) > 1:
        lines.append("front of time against margin:")
        lines += in_columns(
            [
                (
                    si_words(float(judged.measures["time"][i]), TIME),
                    f"{judged.margin[i]:.3g} tolerances",
                    _setting({n: float(v[i]) for n, v in judged.settings.items()}),
                )
                for i in design.front[:: max(len(design.front) // 8, 1)]
            ]
        )
    for each in others:
        lines += _misjudged_lines(each)
    return lines


def _relax(design: "Design") -> list[str]:
    relaxed = design.to_relax()
    if not relaxed:
        words = "no limit alone: relax two, widen the free ranges or tighten the tolerances"
        return [_line("what to relax", words)]
    lines = []
    for name, value in relaxed.items():
        if name == "vibration":
            words = f"vibration: leave out that it is {_asked(design.limits[name])}"
            lines.append(_line("what to relax", words))
            continue
        limit, quantity = design.limits[name], _MEASURES[name]
        by = 100.0 * (value / limit - 1.0)
        words = f"{name} from {si_words(limit, quantity)} to {si_words(value, quantity)}"
        lines.append(_line("what to relax", f"{words} ({by:+.2g} %)"))
    return lines


def _asked(share: float) -> str:
    """Return the limit of the vibration as the file states it."""
    return next(words for words, each in VIBRATION.items() if each == share)


def _misjudged_lines(each: "Misjudged") -> list[str]:
    first = (
        "still keeps the limits"
        if each.keeps
        else (
            f"does not: {100.0 * each.share:.3g} % go in" if each.share < 1.0 else "exceeds a limit"
        )
    )
    moved = f"recommended there: {_setting(each.setting)}"
    if not each.feasible:
        moved = "no setting of those tried keeps the limits there"
    return [_line(f"friction {each.friction:.3g}", f"this setting {first}; {moved}")]


def _record(design: "Design", search: "Search", others: "list[Misjudged]") -> dict[str, Any]:
    judged, best = design.judged, design.best
    return {
        "feasible": design.feasible,
        "setting": design.setting,
        "yield": float(judged.share[best]),
        "margin": float(judged.margin[best]),
        **{name: float(values[best]) for name, values in judged.measures.items()},
        "binding": design.binding(search.stated.free),
        "relax": {} if design.feasible else design.to_relax(),
        "tried": int(judged.share.size),
        "misjudged": [asdict(each) for each in others],
    }
