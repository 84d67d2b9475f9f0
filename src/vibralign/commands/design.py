"""``vibralign design``: choose the free quantities of a device within its limits."""

import argparse
import os
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from model.sweeps.settings import Ensemble
from vibralign.answers.assumptions import assumptions_with, lines_of
from vibralign.commands.arguments import (
    add_model_options,
    announce_compilation,
    number,
    read_device,
    whole_number,
)
from vibralign.commands.design_words import Answer, record, report
from vibralign.commands.known import design_in_part
from vibralign.commands.program import add_command, add_json
from vibralign.commands.progress import ProgressLine
from vibralign.commands.tables import print_json

if TYPE_CHECKING:
    from model.runs.settings import Settings
    from vibralign.answers.assess import Assessment
    from vibralign.answers.design import Design
    from vibralign.answers.design_trials import Trials
    from vibralign.device import StatedDevice

_USUAL = {"generations": 10, "population": 16, "seed": 0, "devices": 1024}  # those of design


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "design",
        _design,
        "choose the free quantities of a device for the largest margin, then time",
        ". The device file names what is free (free: {press_force: 5 to 20 N}) and the limits "
        "(limits: {contact_force: 60 N, time: 0.2 s, tilt: 10 deg, vibration: needed}, or not "
        "needed; acceleration: 10 g and stroke: 2 mm limit the vibrator). Time and tilt count "
        "until alignment, the force until inserted. Each setting is tried quickly. Of the settings "
        "with which all devices within the tolerances go in, the best is the one whose nearest "
        "failure is farthest, then the fastest. It is checked as `vibralign assess` checks it; if "
        "it does not hold, the next best is checked. If the file has ranges of unknown "
        "quantities, design prints the setting that is reliable for most of what is possible (of "
        "several the fastest), and what knowing everything would add.",
        epilog="exit code: 0 a setting keeps the limits; 1 none of those tried does; 2 bad input",
    )
    add_model_options(parser, scene="insertion")
    for name, words in (
        ("generations", "of the search"), ("population", "settings a generation"),
        ("seed", "of the search"),
        ("devices", "devices by which a setting is checked, a power of two"),
    ):  # fmt: skip
        usual = str(_USUAL[name])
        words = f"{words} (default: {usual})"
        parser.add_argument(f"--{name}", default=usual, metavar="N", help=words)
    add_json(parser)


def _design(arguments: argparse.Namespace) -> int:
    generations, population, seed = (
        whole_number(name, getattr(arguments, name), least)
        for name, least in (("generations", 1), ("population", 5), ("seed", 0))
    )
    stated, settings = read_device(arguments, known_in_part=True)
    if stated.unknown:
        return design_in_part(arguments, stated, settings)
    from vibralign.answers.design import search, trials_of  # noqa: PLC0415  (only this command)

    trials = trials_of(
        stated, settings, Ensemble(), os.cpu_count() or 1, seed,
        number("devices", arguments.devices),
    )  # fmt: skip
    announce_compilation()
    with ProgressLine() as line:
        design = search(trials, generations, population, line.begin)
        line.begin("assessing the recommended setting")
        answer = Answer(design, trials, _assessed(design, trials, stated, settings))
    assumed = assumptions_with(
        trials.stated, design.setting, settings, Ensemble(),
        tolerances_assumed=not stated.tolerances,
    )  # fmt: skip
    if arguments.json:
        print_json(record(answer) | {"assumptions": assumed})
    else:
        print("\n".join([*report(answer), *lines_of(assumed)]))
    return int(not design.feasible)


def _assessed(
    design: "Design", trials: "Trials", stated: "StatedDevice", settings: "Settings"
) -> "Assessment":
    """Return what ``assess`` says of the recommended setting, with all approaches to try."""
    from vibralign.answers.assess import assess  # noqa: PLC0415  (as in _design)

    own = replace(stated.changed(**design.setting), tolerances=trials.stated.tolerances)
    settings = own.run_settings(settings, own.units)
    return assess(own, settings, Ensemble(), trials.cores, vary=False)
