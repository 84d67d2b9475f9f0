"""Yield of a device under its tolerances in words, and as a record for --json."""

import math
import shlex
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from model.physics.quantities import FORCE, TIME
from vibralign.answers import si
from vibralign.answers.forces import forces_words
from vibralign.commands.arguments import set_options
from vibralign.commands.tables import in_columns
from vibralign.commands.tables import report_line as _line

if TYPE_CHECKING:
    from model.runs.settings import Settings
    from vibralign.answers.design_trials import Check
    from vibralign.answers.yields import FailingDevice, Yield
    from vibralign.device import StatedDevice

_LARGEST = {"alignment time": "time", "contact force": "contact_force"}  # lines of the yield


def yield_words(drawn: "Yield | Check") -> str:
    """Return the share of drawn devices that go in, its interval and its level of confidence."""
    from vibralign.answers.yields import CONFIDENCE, interval  # noqa: PLC0415  (scipy)

    if not drawn.devices:
        return "of no device, as all that are drawn start inside the hole,"
    low, high = interval(drawn.going_in, drawn.devices)
    places = max(1 - math.floor(math.log10(100.0 * (high - low))), 0)  # two digits of the interval
    shares = drawn.going_in / drawn.devices, low, high
    share, least, most = (f"{round(100.0 * each, places):.12g} %" for each in shares)
    return f"{share} ({least} to {most}, {100.0 * CONFIDENCE:.4g} % confidence)"


def required_words(required: float | None, drawn: "Yield", *, kept: bool) -> str:
    """Return whether the yield of --require is met, and why not; empty without --require."""
    if required is None:
        return ""
    faults = ["the yield is too low"] * (not drawn.meets(required))
    faults += ["a limit is exceeded"] * (not kept)
    met = "met" if not faults else f"not met, as {' and '.join(faults)}"
    return f"{100.0 * required:.4g} %: {met}"


def yield_rows(
    drawn: "Yield",
    failing: "FailingDevice | None",
    stated: "StatedDevice",
    required: str,
) -> list[tuple[str, str]]:
    """Return the rows of the sheet on the yield; ``required`` says if that of --require is met."""
    words = f"{yield_words(drawn)}: {drawn.going_in:,} of {drawn.devices:,} "
    goal = "reach the chamfers" if stated.is_chamfered else "go in"
    words += f"devices within the tolerances {goal} from every touch-down"
    words += "" if stated.base_is_stated else ", on every base"
    rows = [("yield", words + _approach(stated))]
    if drawn.on_chamfers:
        words = f"{drawn.on_chamfers:,} of these land with chamfer on chamfer and slide in under "
        rows.append(("on chamfers", f"{words}the press; forces on the flanks are not modelled"))
    if drawn.inside:
        words = f"{drawn.inside:,} more start inside the hole and are not counted"
        rows.append(("inside", f"{words}: they need no alignment"))
    if drawn.impossible:
        words = f"{drawn.impossible} of these are impossible (no play, a negative friction or the "
        rows.append(("impossible", f"{words}like) and count as not going in"))
    if required:
        rows.append(("required", required))
    if drawn.blame:
        rows.append(("to blame", drawn.blame))
    if failing is not None:
        words = f"{si.named_words(failing.quantities, stated)}: deviations of up to "
        rows.append(("fails nearest", f"{words}{100.0 * failing.distance:.3g} % of the tolerances"))
    return rows


def yield_lines(
    drawn: "Yield", failing: "FailingDevice | None", stated: "StatedDevice", settings: "Settings"
) -> list[str]:
    """Return the detailed lines on the yield: times, forces, indices, the command that fails."""
    lines = [f"devices within the tolerances{_approach(stated)}:"]
    times = [("alignment time", drawn.time, TIME, si.DIGITS)] if drawn.going_in else []
    if drawn.going_in and not math.isnan(drawn.insertion[0]):
        times.append(("inserted after", drawn.insertion, TIME, si.DIGITS))
    # At the tolerance of these runs one in a thousand forces is off by 5 % (docs/measurements.md).
    for name, values, quantity, digits in (*times, ("contact force", drawn.force, FORCE, 2)):
        if values[0] == values[0]:
            listed = si.si_list(values, quantity, digits=digits)
            words = f"{listed} (5, 50, 95 %)"
            largest = drawn.largest.get(_LARGEST.get(name, ""))
            if largest is not None:
                words += f"; at most {si.si_list((largest,), quantity, digits=digits)} of all drawn"
            lines.append(_line(name, words))
    if drawn.forces:
        words = forces_words(drawn.forces, None, settings, in_si=True)
        lines.append(_line("  at most", words))
    if any(math.isfinite(each) for e in drawn.sobol_indices for each in (e.failure, e.time)):
        lines.append("total Sobol' indices of the tolerances:")
        rows: list[tuple[str, ...]] = [("", "of failures", "of the spread of times")]
        rows += [(e.quantity, *map(_share, (e.failure, e.time))) for e in drawn.sobol_indices]
        lines += in_columns(rows)
    if failing is not None:
        lines += ["nearest failing device:", f"  {_command(failing, stated, settings)}"]
    return lines


def _approach(stated: "StatedDevice") -> str:
    """Return the approach with which devices are drawn."""
    return f", with the approach {stated.approaches()[0]}" if stated.approaches() else ""


def _share(index: float) -> str:
    return "not known" if math.isnan(index) else f"{100.0 * index:.0f} %"


def yield_record(
    drawn: "Yield",
    failing: "FailingDevice | None",
    stated: "StatedDevice",
    settings: "Settings",
) -> dict[str, Any]:
    """Return the yield for --json."""
    nearest = failing and asdict(failing) | {"command": _command(failing, stated, settings)}
    record = asdict(drawn)
    record["blame"] = record.pop("sobol_indices")
    return record | {"share": drawn.share, "nearest_failing": nearest}


def _command(failing: "FailingDevice", stated: "StatedDevice", settings: "Settings") -> str:
    """Return the command line that runs a failing device, in the units of its file."""
    from vibralign.answers.yields import DIGITS  # noqa: PLC0415  (scipy)

    written = {
        name: si.written_words(name, value, stated, DIGITS) if name in stated.written else value
        for name, value in failing.quantities.items()
    }
    changes = {**stated.changes, **written, **stated.stated_start, **failing.start}
    words = [f"vibralign simulate --device {shlex.quote(str(stated.source))}"]
    words.append(f"--scene {settings.scene.name}")
    if stated.horizon is not None:
        words.append(f"--horizon {stated.horizon!r}")
    if stated.insertion_depth is not None:
        words.append(f"--insertion-depth {stated.insertion_depth!r}")
    for name, reading in asdict(settings.readings).items():
        words += [f"--reading {name}={reading}"] if reading == "printed" else []
    return " ".join([*words, *set_options(changes).values()])
