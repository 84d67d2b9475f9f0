"""``vibralign design``: choose the free quantities of a device within its limits."""

import argparse
import os
import sys
from collections.abc import Mapping
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
    whole_number,
)
from vibralign.commands.design_words import Answer, nothing_found, record, report, so_far
from vibralign.commands.files import check_file, check_picture, writing
from vibralign.commands.known import design_in_part
from vibralign.commands.program import add_command, add_json
from vibralign.commands.progress import ProgressLine
from vibralign.commands.tables import print_json
from vibralign.device.stated import StatedDevice

if TYPE_CHECKING:
    from vibralign.answers.assess import Assessment
    from vibralign.answers.design import Design
    from vibralign.answers.design_trials import Trials

_USUAL = {"generations": 10, "population": 16, "seed": 0, "devices": 1024}  # those of design
_FEWER = (
    "of the search, if all settings go in (fewer with smaller --population, --generations and "
    "--devices, or with a stated base)"
)


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
        "it does not hold, the next best is checked. Interrupting the search prints the best "
        "setting found so far, unchecked, and writes nothing. If the file has ranges of unknown "
        "quantities, design prints the setting that is reliable for most of what is possible (of "
        "several the fastest), and what knowing everything would add.",
        epilog="exit code: 0 a setting keeps the limits; 1 none of those tried does; 2 bad input",
    )
    add_model_options(parser, scene="insertion")
    add = parser.add_argument
    words = "netCDF file with every setting tried; an old one is replaced"
    add("--out", type=Path, metavar="FILE", help=words)
    add("--plot", type=Path, metavar="FILE", help="draw the settings tried into FILE")
    for name, words in (
        ("generations", "of the search"), ("population", "settings a generation"),
        ("seed", "of the search"),
        ("devices", "devices by which a setting is checked, a power of two"),
    ):  # fmt: skip
        usual = str(_USUAL[name])
        add(f"--{name}", default=usual, metavar="N", help=f"{words} (default: {usual})")
    add_json(parser)


def _design(arguments: argparse.Namespace) -> int:
    if arguments.device is None:
        raise ValueError("design needs --device FILE, with free quantities")
    if arguments.out is not None:
        check_file(arguments.out, "--out", ["nc"])
    if arguments.plot is not None:
        check_picture(arguments.plot)
    generations, population, seed = (
        whole_number(name, getattr(arguments, name), least)
        for name, least in (("generations", 1), ("population", 5), ("seed", 0))
    )
    given = read_inputs(arguments, known_in_part=True)
    if given.stated is not None and given.stated.unknown:
        return design_in_part(arguments, given)
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

            def tell(step: str) -> None:
                line.begin(step)
                if step.startswith("generation 1 "):
                    line.forecast(trials.most_runs(population * generations), _FEWER)

            design = search(trials, generations, population, tell, known)
            line.begin("assessing the recommended setting")
            answer = Answer(design, trials, _assessed(design, trials, given))
    except KeyboardInterrupt:
        print(f"vibralign: {so_far(trials, known)}", file=sys.stderr)
        raise
    assumed = assumptions_with(
        trials.stated, design.setting, given.settings, Ensemble(),
        tolerances_assumed=not given.stated.tolerances,
    )  # fmt: skip
    if arguments.json:
        print_json(record(answer) | {"assumptions": assumed})
    else:
        print("\n".join([*report(answer), *lines_of(assumed)]))
    _write(arguments, design, trials.stated, assumed)
    return int(not design.feasible)


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
    why = "" if design.feasible else nothing_found(design)
    with writing():
        if arguments.out is not None:
            from model.sweeps.io import write_dataset  # noqa: PLC0415

            write_dataset(dataset, arguments.out)
        if arguments.plot is not None:
            from vibralign.plots.curves import draw_settings  # noqa: PLC0415
            from vibralign.plots.style import write  # noqa: PLC0415

            write(draw_settings(dataset, why), arguments.plot)
