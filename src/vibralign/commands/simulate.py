"""``vibralign simulate``: run one device and print its outcome and results."""

import argparse
import math
from dataclasses import asdict
from pathlib import Path
from typing import Any

from model.engine.results import RESULTS, TRACK_VARIABLES
from model.engine.series_layout import METHOD
from model.events.insertion import INSERTION
from model.events.outcomes import SUCCESSES, Outcome, Unvibrated
from model.physics.notation import State
from model.physics.parameters import Batch, Parameters
from model.physics.quantities import FORCE, LENGTH, PLAIN, TIME, Quantity
from model.physics.units import Units
from model.runs.settings import Settings
from model.runs.simulate import Trajectory, simulate
from model.runs.unvibrated import unvibrated_results, unvibrated_words
from model.sweeps.version import version
from vibralign.answers.assumptions import assumptions, lines_of
from vibralign.answers.forces import forces_words, tip_record, until
from vibralign.answers.lever import lever_record, lever_words, wall_words
from vibralign.answers.reliability import FORCES
from vibralign.answers.si import (
    DIGITS,
    in_words,
    in_words_of,
    natural_record,
    natural_words,
    rounded,
    scale,
)
from vibralign.commands.arguments import add_model_options, announce_compilation, read_inputs
from vibralign.commands.files import check_picture, writing
from vibralign.commands.program import add_command, add_json
from vibralign.commands.tables import print_json
from vibralign.device import StatedDevice
from vibralign.device.runs import of_device


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "simulate",
        _simulate,
        "run one device and print its outcome and results",
        ". With --device, values are read and printed in SI units; without, the paper's device "
        "runs, dimensionless.",
        epilog="exit code: 0 the run ended, with any outcome; 1 it failed; 2 bad input",
    )
    add_model_options(parser, needs_device=False)
    words = "draw x, y, tilt and contact force over time into FILE (.png, .svg, .pdf and others)"
    parser.add_argument("--plot", type=Path, metavar="FILE", help=words)
    add_json(parser)


def _simulate(arguments: argparse.Namespace) -> int:
    stated, parameters, settings = read_inputs(arguments)
    units = None if stated is None else stated.units
    if arguments.plot is not None:
        check_picture(arguments.plot)
    announce_compilation()
    run = simulate(parameters, settings)
    run = run if stated is None else of_device(run, stated)
    assumed = assumptions(parameters, settings, stated)
    if arguments.json:
        print_json(_record(run, stated, settings) | {"assumptions": assumed})
    else:
        chamfered = stated is not None and stated.is_chamfered
        scene = "" if chamfered or settings.scene is INSERTION else _SCENE
        lines = _report(run, units, settings, scene)
        lines += lever_words(parameters, settings, units)
        lines += wall_words(parameters, settings, run.tilt_max, units)
        lines.append(natural_words(parameters, units))
        lines.append(f"without vibration: {unvibrated_words(parameters, settings)}")
        lines += lines_of(assumed)
        print("\n".join(lines))
    if arguments.plot is not None:
        # ValueError: the library for this format is missing.
        with writing(f"--plot {arguments.plot}", (OSError, ValueError)):
            from vibralign.plots.history import trajectory  # noqa: PLC0415  (as in check_picture)
            from vibralign.plots.style import write  # noqa: PLC0415

            write(trajectory(run, units), arguments.plot)
    return int(run.outcome == Outcome.FAILED)


def _name(outcome: Any) -> str:
    return str(outcome.name).lower()


def _within(value: float, error: float) -> str:
    """Return ``value`` ± ``error``, without the digits that the error makes uncertain."""
    if math.isnan(error):
        return f"{value:.6g} (error unknown)"
    places = min(max(-math.floor(math.log10(error)), 0), 13) if error > 0.0 else 13
    return f"{value:.{places}f} ± {error:.1g}"


_SCENE = "alignment: the run ends there; --scene insertion goes on into the hole, as assess does"


def _report(run: Trajectory, units: Units | None, settings: Settings, scene: str = "") -> list[str]:
    """Return the printed lines on a run, in SI units if it has ``units``.

    ``scene`` says how far the part is followed, if it can be followed further.
    """

    def words(value: float, quantity: Quantity) -> str:
        return in_words(value, quantity, units, DIGITS if units else 9)

    message = in_words_of(settings.shape or "square", run.message)
    rows = [("outcome", f"{_name(run.outcome)}: {message}")]
    rows += [("scene", scene)] if scene else []
    if run.outcome not in SUCCESSES:
        from vibralign.answers.causes import waits_in_vain, way_of  # noqa: PLC0415  (of failures only)

        said = f"it has come {rounded(100.0 * max(way_of(run), 0.0), 2)} % of the way and sticks "
        said += f"{100.0 * run.sticking_share:.3g} % of the time: a longer horizon does not help; "
        said += "change friction, press_force, amplitude or tilt_stiffness"
        rows.append(("what to do", said if waits_in_vain(run) else run.remedy))
    duration = "none: it does not align"
    if not math.isnan(run.tau_align):
        error = _within(run.tau_align, run.tau_error)
        duration = words(run.tau_align, TIME) if units else error
    rows.append(("alignment time", duration))
    for name, result in RESULTS.items():
        text = result.printed(value := getattr(run, name))
        if text and name not in (*FORCES.values(), "tau_error"):
            text = text if result.quantity is PLAIN else words(value, result.quantity)
            start = ", from this start" if result.meaning.startswith("largest") else ""
            rows.append((f"{result.meaning}{start}", text))
        if name == "contact_force_max":
            at_places = {place: getattr(run, each) for place, each in FORCES.items()}
            rows.append(("  of the force", forces_words(at_places, units, settings)))
    rows.append(("final state", f"at {words(float(run.time[-1]), TIME)}"))
    for name, value in zip(State._fields, run.state[-1].tolist(), strict=True):
        variable = TRACK_VARIABLES[name]
        rows.append((f"  {variable.meaning}", words(value, variable.quantity)))
    width = max(20, *(2 + len(name) for name, _ in rows))
    lines = [f"{name:<{width}}{value}" for name, value in rows]
    if run.sensitive:
        said = "note: sensitive: at another tolerance this run ends differently or at another "
        lines.append(f"{said}time; do not rely on its digits")
    return lines


def unvibrated_record(parameters: Parameters, settings: Settings) -> dict[str, Any]:
    """Return how the unvibrated control ends, for --json."""
    columns = unvibrated_results(Batch.stack([parameters]), settings)
    values = {name: column[0].item() for name, column in columns.items()}
    return values | {"unvibrated": _name(Unvibrated(values["unvibrated"]))}


def _record(run: Trajectory, stated: StatedDevice | None, settings: Settings) -> dict[str, Any]:
    """Return the record of a run, for --json: in SI units for a device of a file."""
    units, depth = None if stated is None else stated.units, settings.insertion_depth

    def own(value: Any, quantity: Quantity) -> Any:
        return value if quantity is PLAIN else value * scale(units, quantity)

    state = zip(State._fields, run.state[-1].tolist(), strict=True)
    return {
        "units": "1" if units is None else "SI",
        **{name: own(getattr(run, name), each.quantity) for name, each in RESULTS.items()},
        **tip_record(own(run.edge_force_max, FORCE), settings),
        "outcome": _name(run.outcome),
        "reason": _name(run.reason),
        "message": run.message,
        "remedy": run.remedy,
        **unvibrated_record(run.parameters, settings),
        **natural_record(run.parameters, units),
        **lever_record(run.parameters, settings, units),
        "final_time": own(float(run.time[-1]), TIME),
        "final_state": {n: own(value, TRACK_VARIABLES[n].quantity) for n, value in state},
        "parameters": asdict(run.parameters) if stated is None else stated.values,
        "readings": asdict(settings.readings),
        "start": settings.start or "simultaneous",
        "scene": settings.scene.name,
        "insertion_depth": depth and own(depth, LENGTH),
        "forces_known": until(settings),
        "method": METHOD,
        "horizon": own(settings.horizon, TIME),
        "tolerance": settings.tolerance,
        "version": version(),
    }
