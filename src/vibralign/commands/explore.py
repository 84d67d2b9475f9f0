"""``vibralign explore``: make a page that runs a device live, in a browser and without network."""

import argparse
import shlex
import sys
from pathlib import Path
from typing import Any

from model.events.insertion import INSERTION
from model.events.scenes import ALIGNMENT
from model.physics.variants import Variants
from model.sweeps.files import write_text
from vibralign.answers.assumptions import assumptions
from vibralign.commands.arguments import add_model_options, pairs, read_inputs, set_options
from vibralign.commands.files import check_file, writing
from vibralign.commands.program import add_command
from vibralign.device import StatedDevice
from vibralign.device.instead import SOURCES


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "explore",
        _explore,
        "make a page that runs a device live in a browser",
        ", with sliders, an animated drawing and maps. The page is one file that needs no network. "
        "Without --device it runs the device of the paper.",
        epilog="exit code: 0 the page was made; 1 it could not be written; 2 bad input",
    )
    words = "page to write (.html); an old one is replaced when the new one is complete"
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help=words)
    add_model_options(parser)


def _explore(arguments: argparse.Namespace) -> int:
    check_file(arguments.out, "--out", ["html"])
    given = read_inputs(arguments)
    settings = given.settings
    if settings.readings != Variants.consistent():
        raise ValueError(
            "explore: the page runs the consistent readings only; leave out --readings and "
            "--reading"
        )
    if settings.insertion_depth is not None:
        raise ValueError(
            "explore: the page has the default depth only; leave out --insertion-depth"
        )
    # Imported here: a second that only this command needs.
    from model.runs.in_browser import is_cached, module_for  # noqa: PLC0415
    from vibralign.explorer.content import device_model  # noqa: PLC0415
    from vibralign.explorer.page import build_page  # noqa: PLC0415

    shape = settings.shape or "square"
    # The page follows a part into the hole, unless only a part of its mouth is modelled.
    chamfered = given.stated is not None and given.stated.is_chamfered
    scene = ALIGNMENT if chamfered else INSERTION
    if sys.stderr.isatty() and not is_cached(shape, scene):
        print("compiling the engine for the page, this once: some seconds …", file=sys.stderr)
    engine = module_for(shape, scene)
    file, origin = str(arguments.device or ""), _origin(arguments, given.stated)
    assumed = assumptions(given.parameters, settings, given.stated)
    model = device_model(
        given.values, given.units, file, settings, engine.interface, origin, assumed
    )
    with writing():
        write_text(build_page(model, engine), arguments.out)
    print(f"open {arguments.out} in a browser")
    return 0


def _origin(arguments: argparse.Namespace, stated: StatedDevice | None) -> dict[str, Any]:
    """Return the options that made the page, and what its file holds (content.py)."""
    options = []
    for name in ("device", "shape", "start", "horizon", "tolerance"):
        if (given := getattr(arguments, name)) is not None:
            options += [f"--{name}", shlex.quote(str(given))]
    changes, held = pairs(arguments.changes, "--set"), {}
    if stated is not None:
        present = {*stated.quantities, *(() if stated.materials is None else ("materials",))}
        held = {
            name: [each for each in sources if each in present]
            for name, sources in SOURCES.items()
            if name not in present
        }
    horizon = None if stated is None else stated.horizon
    return {"options": options, "sets": set_options(changes), "held": held, "horizon": horizon}
