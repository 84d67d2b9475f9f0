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
from model.physics.quantities import PLAIN, TIME
from model.physics.units import Units
from model.runs.settings import Settings
from model.runs.simulate import Trajectory, simulate
from model.runs.unvibrated import unvibrated_results, unvibrated_words
from model.sweeps.version import version
from vibralign.answers.assumptions import assumptions, lines_of
from vibralign.answers.forces import forces_words, tip_record, until
from vibralign.answers.lever import lever_record, lever_words, wall_words
from vibralign.answers.reliability import FORCES
from vibralign.answers.si import in_words, in_words_of, natural_record, natural_words, rounded
from vibralign.commands.arguments import add_model_options, announce_compilation, read_inputs
from vibralign.commands.files import check_picture, writing
from vibralign.commands.program import add_command, add_json
from vibralign.commands.tables import print_json
from vibralign.device.runs import of_device


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "simulate",
        _simulate,
        "run one device and print its outcome and results",
        ". With --device, values are read and printed in SI units, else dimensionless.",
        epilog="exit code: 0 the run ended, with any outcome; 1 it failed; 2 bad input",
    )
    add_model_options(parser)
    words = "draw x, y, tilt and contact force over time into FILE (.png, .svg, .pdf and others)"
    parser.add_argument("--plot", type=Path, metavar="FILE", help=words)
    add_json(parser)


def _simulate(arguments: argparse.Namespace) -> int:
    given = read_inputs(arguments)
    units, parameters, settings = given.units, given.parameters, given.settings
    if arguments.plot is not None:
        check_picture(arguments.plot)
    announce_compilation()
    run = simulate(parameters, settings)
    run = run if given.stated is None else of_device(run, given.stated)
    assumed = assumptions(parameters, settings, given.stated)
    if arguments.json:
        record = _record(run, settings) | {"assumptions": assumed}
        if units:
            lever = lever_record(parameters, settings, units)
            record["si"] = _in_si(run, units) | natural_record(parameters, units) | lever
        print_json(record)
    else:
        chamfered = given.stated is not None and given.stated.is_chamfered
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
    """Return the printed lines on a run: words and SI units, or variable names without units.

    ``scene`` says how far the part is followed, if it can be followed further.
    """
    aligned = not math.isnan(run.tau_align)
    message = in_words_of(settings.shape or "square", run.message)
    rows = [("outcome", f"{_name(run.outcome)}: {message}")]
    rows += [("scene", scene)] if scene else []
    if run.outcome not in SUCCESSES:
        from vibralign.answers.causes import waits_in_vain, way_of  # noqa: PLC0415  (of failures only)

        words = f"it has come {rounded(100.0 * max(way_of(run), 0.0), 2)} % of the way and sticks "
        words += f"{100.0 * run.sticking_share:.3g} % of the time: a longer horizon does not help; "
        words += "change friction, press_force, amplitude or tilt_stiffness"
        rows.append(("what to do", words if waits_in_vain(run) else run.remedy))
    duration = "none: it does not align"
    if aligned:
        error = _within(run.tau_align, run.tau_error)
        duration = in_words(run.tau_align, TIME, units) if units else error
    rows.append(("alignment time" if units else "tau_align", duration))
    at_places = {place: getattr(run, name) for place, name in FORCES.items()}
    for name, result in RESULTS.items():
        if units and name in FORCES.values():
            continue  # they stand in one line
        text = result.printed(getattr(run, name))
        if text and not (units and name == "tau_error"):
            if units and result.quantity is not PLAIN:
                text = in_words(getattr(run, name), result.quantity, units)
            meaning = result.meaning
            meaning += ", from this start" if meaning.startswith("largest") else ""
            rows.append((meaning if units else name, text))
        if name == "contact_force_max":
            words = forces_words(at_places, units, settings) if units else until(settings)
            rows.append(("  of the force" if units else "  known", words))
    end = in_words(float(run.time[-1]), TIME, units) if units else f"τ = {run.time[-1]:.9g}"
    rows.append(("final state", f"at {end}"))
    for name, number in _final_state(run).items():
        variable = TRACK_VARIABLES[name]
        text = in_words(number, variable.quantity, units) if units else f"{number: .9g}"
        rows.append((f"  {variable.meaning if units else name}", text))
    width = max(20, *(2 + len(name) for name, _ in rows))
    lines = [f"{name:<{width}}{value}" for name, value in rows]
    if run.sensitive:
        words = "note: sensitive: at another tolerance this run ends differently or at another "
        lines.append(f"{words}time; do not rely on its digits")
    return lines


def _in_si(run: Trajectory, units: Units) -> dict[str, Any]:
    """Return the results of a run in SI units, for --json; NaN where there is none."""
    physical = {n: each.quantity for n, each in RESULTS.items() if each.quantity is not PLAIN}
    return {
        "alignment_time_s": run.tau_align * units.time,
        "alignment_time_error_s": run.tau_error * units.time,
        "contact_force_max_N": run.contact_force_max * units.force,
        "time_unit_s": units.time,
        "length_unit_m": units.amplitude,
        "force_unit_N": units.force,
        "results": {n: getattr(run, n) * units.of(quantity) for n, quantity in physical.items()},
        "final_time": float(run.time[-1]) * units.time,
        "final_state": {
            name: value * units.of(TRACK_VARIABLES[name].quantity)
            for name, value in _final_state(run).items()
        },
    }


def _final_state(run: Trajectory) -> dict[str, float]:
    return dict(zip(State._fields, run.state[-1].tolist(), strict=True))


def unvibrated_record(parameters: Parameters, settings: Settings) -> dict[str, Any]:
    """Return how the unvibrated control ends, for --json."""
    columns = unvibrated_results(Batch.stack([parameters]), settings)
    values = {name: column[0].item() for name, column in columns.items()}
    return values | {"unvibrated": _name(Unvibrated(values["unvibrated"]))}


def _record(run: Trajectory, settings: Settings) -> dict[str, Any]:
    """Return the record of a run, for --json."""
    return {
        **{name: getattr(run, name) for name in RESULTS},
        **tip_record(run.edge_force_max, settings),
        "outcome": _name(run.outcome),
        "reason": _name(run.reason),
        "message": run.message,
        "remedy": run.remedy,
        **unvibrated_record(run.parameters, settings),
        **natural_record(run.parameters, None),
        **lever_record(run.parameters, settings, None),
        "final_time": float(run.time[-1]),
        "final_state": _final_state(run),
        "parameters": asdict(run.parameters),
        "readings": asdict(settings.readings),
        "start": settings.start or "simultaneous",
        "scene": settings.scene.name,
        "insertion_depth": settings.insertion_depth,
        "forces_known": until(settings),
        "method": METHOD,
        "horizon": settings.horizon,
        "tolerance": settings.tolerance,
        "version": version(),
    }
