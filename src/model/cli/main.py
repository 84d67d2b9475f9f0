"""The command ``vibralign``: the model at the prompt.

Whatever the user gives is checked before anything is computed, and refused in one line that names
the value, the rule and the valid choices. What is slow to import is imported where it is needed.
"""

import argparse
import contextlib
import errno
import importlib.metadata
import io
import json
import math
import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, NoReturn

from model.cli import assess, claims, export, map, reference, tracking  # noqa: A004
from model.cli.arguments import (
    add_model_options,
    announce_compilation,
    check_picture,
    device_of,
    settings_of,
)
from model.engines.results import RESULTS
from model.events.outcomes import Outcome
from model.physics.notation import State
from model.physics.units import Units
from model.runs.settings import Settings
from model.runs.simulate import Trajectory, simulate
from model.study.config import Study, load_study, study_path
from model.study.files import whole_file

DONE, FAILED, REFUSED, INTERRUPTED = 0, 1, 2, 130


class _Parser(argparse.ArgumentParser):
    appendix: Callable[[], str] | None = None  # what the help ends with, made when it is asked for

    def error(self, message: str) -> NoReturn:
        """One line instead of the usage and the line."""
        self.exit(REFUSED, f"{self.prog}: error: {message} (see {self.prog} --help)\n")

    def format_help(self) -> str:
        """Help, with what takes reading the study at its end."""
        return super().format_help() + (f"\n{self.appendix()}" if self.appendix else "")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; the exit code is 0 done, 1 failed, 2 bad input, 130 interrupted."""
    if isinstance(sys.stdout, io.TextIOWrapper):  # a terminal that cannot show τ gets a ? for it
        sys.stdout.reconfigure(errors="replace")
    try:
        return _run(argv)
    except SystemExit as ending:  # argparse: help, version, a refusal
        return ending.code if isinstance(ending.code, int) else DONE
    except ValueError as refusal:
        print(f"vibralign: error: {refusal}", file=sys.stderr)
        return REFUSED
    except KeyboardInterrupt:
        print("vibralign: interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:  # `vibralign … | head`: nobody reads on, so nothing is left to say
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    except OSError as error:
        denied = error.errno in (errno.EACCES, errno.EPERM, errno.EROFS)
        remedy = "allow access to it" if denied else "free some space"
        print(f"vibralign: error: {error}: {remedy} or choose another place and run it again",
              file=sys.stderr)  # fmt: skip
        # What is left unwritten would be tried again, and fail again, as Python ends.
        with contextlib.suppress(OSError, ValueError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED


def _run(argv: Sequence[str] | None) -> int:
    arguments = _parser().parse_args(argv)
    code = int(arguments.run(arguments))
    sys.stdout.flush()  # here, where a broken pipe can still be handled
    return code


def _parser() -> _Parser:
    parser = _Parser(
        prog="vibralign",
        description="Vibratory alignment of a peg with a hole: choose press force, tilt stiffness "
        "and excitation frequency.",
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"%(prog)s {_version()}")
    commands = parser.add_subparsers(required=True, metavar="command", parser_class=_Parser)
    _add_simulate(commands)
    assess.add_commands(commands)
    map.add_commands(commands)
    tracking.add_commands(commands)
    export.add_commands(commands)
    reference.add_commands(commands)
    claims.add_commands(commands)
    return parser


def _version() -> str:
    try:
        return importlib.metadata.version("vibralign")
    except importlib.metadata.PackageNotFoundError:
        return "(not installed)"


def _study() -> Study:
    return load_study(study_path())


# --- vibralign simulate -------------------------------------------------------------------------


def _add_simulate(commands: Any) -> None:
    words = "run one device and say whether, when and how it aligns"
    parser = commands.add_parser(
        "simulate",
        help=words,
        description=f"{words[0].upper()}{words[1:]}. All values are dimensionless, but for those "
        "of a device file.",
        epilog="exit code: 0 the run was done, whatever its outcome; 1 it failed; 2 bad input",
        allow_abbrev=False,
    )
    add = parser.add_argument
    add_model_options(parser)
    words = "draw x, y, tilt and contact force over time into FILE (.png, .svg, .pdf and others)"
    add("--plot", type=Path, metavar="FILE", help=words)
    add("--json", action="store_true", help="print everything as JSON")
    parser.set_defaults(run=_simulate)


def _simulate(arguments: argparse.Namespace) -> int:
    study = _study()
    units, parameters = device_of(study.baseline, arguments)
    settings = settings_of(study.settings.settings, arguments)
    if arguments.plot is not None:
        check_picture(arguments.plot)
    announce_compilation()
    run = simulate(parameters, settings)
    if arguments.json:
        record = _record(run, settings)
        if units:
            record["si"] = {name: _or_null(value) for name, value in _in_si(run, units).items()}
        print(json.dumps(record, indent=2))
    else:
        print("\n".join([*_report(run), *(_report_in_si(run, units) if units else [])]))
    if arguments.plot is not None and not _draw(run, arguments.plot):
        return FAILED
    return FAILED if run.outcome == Outcome.FAILED else DONE


def _draw(run: Trajectory, path: Path) -> bool:
    from model.show import plots, style  # noqa: PLC0415  (as in check_picture)

    figure = plots.trajectory(run)
    try:
        with whole_file(path) as part, style.context():
            figure.savefig(part, format=path.suffix.lower().lstrip("."))
    except (OSError, ValueError) as error:  # a full disk, a picture library that is missing
        print(f"vibralign: error: --plot {path}: {error}", file=sys.stderr)
        return False
    return True


# --- What is printed ----------------------------------------------------------------------------


def _name(outcome: Any) -> str:
    return str(outcome.name).lower()


def _within(value: float, error: float) -> str:
    """``value`` with as many digits as ``error`` leaves certain."""
    if math.isnan(error):
        return f"{value:.6g} (error unknown)"
    places = min(max(-math.floor(math.log10(error)), 0), 13) if error > 0.0 else 13
    return f"{value:.{places}f} ± {error:.1g}"


def _report(run: Trajectory) -> list[str]:
    rows = [("outcome", f"{_name(run.outcome)}: {run.message}")]
    if run.outcome == Outcome.ALIGNED:
        rows.append(("tau_align", _within(run.tau_align, run.tau_error)))
    else:
        rows += [("what to do", run.remedy), ("tau_align", "none: it does not align")]
    printed = [(name, each.printed(getattr(run, name))) for name, each in RESULTS.items()]
    rows += [(name, text) for name, text in printed if text]
    rows.append(("final state", f"at τ = {run.time[-1]:.9g}"))
    rows += [(f"  {name}", f"{value: .9g}") for name, value in _final_state(run).items()]
    lines = [f"{name:<20}{value}" for name, value in rows]
    if run.sensitive:
        lines.append(
            "note: sensitive: at another tolerance this run ends differently or at another time; "
            "do not rely on its digits"
        )
    return lines


def _in_si(run: Trajectory, units: Units) -> dict[str, float]:
    """What a designer asks for, in SI units; NaN for the time of a part that does not align."""
    return {
        "alignment_time_s": run.tau_align * units.time,
        "alignment_time_error_s": run.tau_error * units.time,
        "contact_force_max_N": run.contact_force_max * units.force,
        "time_unit_s": units.time,
        "length_unit_m": units.amplitude,
        "force_unit_N": units.force,
    }


def _report_in_si(run: Trajectory, units: Units) -> list[str]:
    time, error, force, *scales = _in_si(run, units).values()
    rows = [("contact force", f"{force:.4g} N at most")]
    if run.outcome == Outcome.ALIGNED:
        rows.insert(0, ("alignment time", f"{_within(time, error)} s"))
    rows.append(("units", "time {:.4g} s, length {:.4g} m, force {:.4g} N".format(*scales)))
    return ["in SI units:", *(f"  {name:<18}{value}" for name, value in rows)]


def _final_state(run: Trajectory) -> dict[str, float]:
    return dict(zip(State._fields, run.state[-1].tolist(), strict=True))


def _or_null(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _record(run: Trajectory, settings: Settings) -> dict[str, Any]:
    """Everything about a run, as JSON can hold it: what is not a number is null."""
    final_state = {name: _or_null(value) for name, value in _final_state(run).items()}
    return {
        **{name: _or_null(getattr(run, name)) for name in RESULTS},
        "outcome": _name(run.outcome),
        "reason": _name(run.reason),
        "message": run.message,
        "remedy": run.remedy,
        "final_time": float(run.time[-1]),
        "final_state": final_state,
        "parameters": asdict(run.parameters),
        "readings": asdict(settings.readings),
        "scene": settings.scene.name,
        "method": settings.method.name,
        "horizon": settings.horizon,
        "tolerance": settings.tolerance,
        "version": _version(),
    }


if __name__ == "__main__":
    sys.exit(main())
