"""``vibralign explore``: make a page that runs a device live, in a browser and without network."""

import argparse
import sys
from pathlib import Path
from typing import Any

from model.events.insertion import INSERTION
from model.events.scenes import ALIGNMENT
from model.physics.variants import Variants
from model.sweeps.files import write_text
from vibralign.answers.assumptions import assumptions
from vibralign.commands.arguments import add_model_options, read_device
from vibralign.commands.files import check_file, writing
from vibralign.commands.program import add_command


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "explore",
        _explore,
        "make a page that runs a device live in a browser",
        ", with sliders, an animated drawing and maps. The page is one file that needs no network.",
        epilog="exit code: 0 the page was made; 1 it could not be written; 2 bad input",
    )
    words = "page to write (.html); an old one is replaced when the new one is complete"
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help=words)
    add_model_options(parser)


def _explore(arguments: argparse.Namespace) -> int:
    check_file(arguments.out, "--out", ["html"])
    stated, settings = read_device(arguments)
    if settings.readings != Variants.consistent():
        raise ValueError("explore: the page runs the consistent readings only; leave out --reading")
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
    scene = ALIGNMENT if stated.is_chamfered else INSERTION
    if sys.stderr.isatty() and not is_cached(shape, scene):
        print("compiling the engine for the page, this once: some seconds …", file=sys.stderr)
    engine = module_for(shape, scene)
    assumed = assumptions(stated.parameters, settings, stated)
    model = device_model(stated, settings, engine.interface, assumed)
    with writing():
        write_text(build_page(model, engine), arguments.out)
    print(f"open {arguments.out} in a browser")
    return 0
