"""``vibralign design``: choose the free quantities of a device within its limits."""

import argparse
import os
import sys
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from model.sweeps.settings import Ensemble
from vibralign.answers.assumptions import as_attribute, assumptions_with, lines_of
from vibralign.commands.arguments import (
    Inputs,
    add_model_options,
    announce_compilation,
    number,
    read_inputs,
)
from vibralign.commands.design_words import (
    Answer,
    Changes,
    change_line,
    last_lines,
    proposal_words,
    record,
    report,
    so_far,
)
from vibralign.commands.files import check_file, check_picture, writing
from vibralign.commands.program import add_command, add_json
from vibralign.commands.progress import ProgressLine
from vibralign.commands.tables import print_json
from vibralign.device.stated import StatedDevice

if TYPE_CHECKING:
    from vibralign.answers.assess import Assessment
    from vibralign.answers.design import Design, Known
    from vibralign.answers.design_changes import Change
    from vibralign.answers.design_trials import Trials


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
        "not hold, the next best is. This is printed and written. Then what binds is widened, and "
        "tried with as many runs as the search took; an interrupt ends this part only. One before "
        "prints the best setting so far, not checked, and writes nothing.",
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
    from vibralign.answers.design import Known, search, trials_of  # noqa: PLC0415  (only this command)

    assert given.stated is not None  # noqa: S101  (--device is given)
    trials = trials_of(
        given.stated, given.settings, Ensemble(), os.cpu_count() or 1, seed,
        number("devices", arguments.devices),
    )  # fmt: skip
    announce_compilation()
    known: Known = {}
    try:
        with ProgressLine() as line:
            design, _ = search(trials, generations, population, line.begin, known)
            line.begin("recommended setting, as assess has it")
            answer = Answer(design, trials, _assessed(design, trials, given))
    except KeyboardInterrupt:
        print(f"vibralign: {so_far(trials, known)}", file=sys.stderr)
        raise
    assumed = assumptions_with(
        trials.stated, design.setting, given.settings, Ensemble(),
        tolerances_assumed=trials.stated is not given.stated,
    )  # fmt: skip
    if not arguments.json:
        print("\n".join([*report(answer), *lines_of(assumed)]), flush=True)
    _write(arguments, design, trials.stated, assumed)
    if arguments.json:
        changes = _try_changes(answer, known, lambda _: None)
        print_json(record(answer, changes) | {"assumptions": assumed})
    else:

        def tell(change: "Change") -> None:
            if words := change_line(design, change):
                print(words, flush=True)

        for words in last_lines(_try_changes(answer, known, tell)):
            print(words)
    return int(not design.feasible)


def _try_changes(answer: Answer, known: "Known", tell: "Callable[[Change], None]") -> Changes:
    """Try the changes that may help, until as many runs are taken as by the search.

    An interrupt ends it too; what was tried is kept. ``tell`` is called after each change.
    """
    from vibralign.answers.design_changes import attempted, proposed  # noqa: PLC0415  (as in _design)
    from vibralign.answers.design_trials import Runs, SpentError  # noqa: PLC0415

    design, trials = answer.design, answer.trials
    proposals, changes = proposed(design, trials.stated.tolerances), list["Change"]()
    some, number = replace(trials, runs=Runs(trials.runs.taken)), 0
    try:
        for number, each in enumerate(proposals):
            with ProgressLine() as line:
                line.begin(f"change {number + 1} of {len(proposals)}: {proposal_words(each)}")
                change = attempted(some, design, known, each)
            if change is not None:
                changes.append(change)
                tell(change)
    except SpentError:
        return Changes(changes, proposals[number:], "no runs left: as many as the search took")
    except KeyboardInterrupt:
        return Changes(changes, proposals[number:], "interrupted; all else is complete")
    return Changes(changes)


def _assessed(design: "Design", trials: "Trials", given: Inputs) -> "Assessment":
    """Return what ``assess`` says of the recommended setting."""
    from vibralign.answers.assess import assess  # noqa: PLC0415  (as in _design)

    stated = trials.stated.changed(**design.setting)
    if given.stated is not None:  # all approaches, where none is stated
        stated = given.stated.changed(**design.setting)
        stated = replace(stated, tolerances=trials.stated.tolerances)
    settings = stated.run_settings(given.settings, stated.units)
    helpless = not design.tried.share[design.best] > 0.0  # as stated it does not go in
    return assess(stated, settings, Ensemble(), trials.cores, vary=helpless)


def _write(
    arguments: argparse.Namespace,
    design: "Design",
    stated: StatedDevice,
    assumed: Mapping[str, str],
) -> None:
    """Write the files that are asked for."""
    if arguments.out is None and arguments.plot is None:
        return
    from vibralign.answers.design_files import design_dataset  # noqa: PLC0415  (as in _design)

    dataset = design_dataset(stated, design).assign_attrs(assumptions=as_attribute(assumed))
    with writing():
        if arguments.out is not None:
            from model.sweeps.io import write_dataset  # noqa: PLC0415

            write_dataset(dataset, arguments.out)
        if arguments.plot is not None:
            from vibralign.plots.curves import draw_front  # noqa: PLC0415
            from vibralign.plots.style import write  # noqa: PLC0415

            write(draw_front(dataset), arguments.plot)


def _count(name: str, text: str, least: int) -> int:
    rule = f"must be a whole number >= {least}"
    value = number(name, text, rule)
    if not value.is_integer() or value < least:
        raise ValueError(f"{name} = {text}: {rule}")
    return int(value)
