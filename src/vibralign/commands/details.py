"""Details of an assessment: what ``vibralign assess --details`` prints below its sheet."""

from typing import TYPE_CHECKING

from model.events.outcomes import SUCCESS_TEXT
from model.physics.quantities import ANGLE, FORCE, STIFFNESS, TIME
from model.physics.units import Units
from vibralign.answers import si
from vibralign.answers.lever import lever_words, wall_words
from vibralign.answers.sheet import value_words
from vibralign.commands.tables import in_columns
from vibralign.commands.tables import report_line as _line

if TYPE_CHECKING:
    from model.runs.settings import Settings
    from vibralign.answers.assess import Assessment
    from vibralign.answers.leeways import Leeway, Nearest
    from vibralign.answers.verdicts import Verdict


def verdict_lines(result: "Assessment", settings: "Settings") -> list[str]:
    """Return lines on lift-offs, tilt, lever, and every base, approach and tilt that is tried."""
    units, device = result.device.units, result.device.parameters
    verb, (fewest, most) = SUCCESS_TEXT[settings.success], result.separations
    hops = f"{fewest} to {most}" if fewest != most else str(fewest)
    tilt = f"{si.in_words(result.tilt_max, ANGLE, units)}, until aligned"
    lines = [_line("lift-offs", hops), _line("largest tilt", tilt)]
    lines += lever_words(device, settings, units)
    lines += wall_words(device, settings, result.tilt_max, units)
    for head, verdicts in (
        ("base, impact", result.bases), ("approach", result.approaches),
        ("gripper's tilt", result.tilts),
    ):  # fmt: skip
        if verdicts:
            lines.append(
                f"{head}; touch-downs from which it {verb}, alignment time, largest force:"
            )
            lines += in_columns([(*_of(each, units), *_row(each, units)) for each in verdicts])
    return [*lines, si.natural_words(device, units)]


def _of(at: "Verdict", units: Units) -> tuple[str, ...]:
    if isinstance(at.of, float):
        return (si.si_words(at.of, ANGLE),)
    if not hasattr(at.of, "restitution"):
        return (str(at.of),)
    impact = "its own damping"
    if at.of.restitution is not None:
        impact = f"restitution {at.of.restitution:g}"
    stiffness = si.in_words(at.of.contact_stiffness, STIFFNESS, units)
    return stiffness, f"({at.of.contact_stiffness:,.0f} × axial)", impact


def _row(at: "Verdict", units: Units) -> tuple[str, ...]:
    times = si.range_words(*at.times, TIME, units) if at.aligned else "-"
    if at.by_press:
        times += f" ({at.by_press} by the press alone)"
    return f"{at.aligned} of {at.starts}", times, si.in_words(at.force_most, FORCE, units)


def leeway_lines(result: "Assessment") -> list[str]:
    """Return lines on the leeways of a device, or on the nearest values that make it reliable."""
    ranges, lines = list(result.leeways), []
    if result.worst is not None and (ranges or result.tilt_range):
        word = "that fails most often" if result.failing_start is not None else "that is slowest"
        lines.append(f"with the approach {word} ({result.worst}):")
    if result.failing_start is not None and result.nearest:
        lines.append("becomes reliable if one parameter is changed, to:")
        lines += in_columns([_nearest_row(each, result) for each in result.nearest])
    elif result.failing_start is not None:
        lines.append("no single parameter makes it reliable within a factor of four")
    if result.tilt_range is not None:
        lines.append("goes in with any one tilt of the gripper in this range (known to 0.005°):")
        lines += in_columns([_leeway_row(result.tilt_range, result)])
        ranges.append(result.tilt_range)
    if result.leeways:
        lines.append("stays reliable in these ranges, one parameter at a time (known to 0.4 %):")
        lines += in_columns([_leeway_row(each, result) for each in result.leeways])
    if any(each.ragged_below or each.ragged_above for each in ranges):
        lines.append("  ragged: values that fail lie among values that hold; keep well inside")
    return lines


def _leeway_row(leeway: "Leeway", result: "Assessment") -> tuple[str, ...]:
    def words(value: float) -> str:
        return value_words(result, leeway.parameter, value)

    def end(
        word: str, value: float, fails: float | None, further: str, *, late: bool, ragged: bool
    ) -> str:
        said = f"{word} {words(value)}"
        if fails is None:
            return f"{said} or {further}"
        notes = ["too slow beyond"] * late + [f"ragged: {words(fails)} fails"] * ragged
        return f"{said} ({', '.join(notes)})" if notes else said

    low = end("from", leeway.low, leeway.fails_below, "less",
              late=leeway.late_below, ragged=leeway.ragged_below)  # fmt: skip
    high = end("to", leeway.high, leeway.fails_above, "more",
               late=leeway.late_above, ragged=leeway.ragged_above)  # fmt: skip
    return leeway.parameter, low, high, f"its value {words(leeway.value)}"


def _nearest_row(nearest: "Nearest", result: "Assessment") -> tuple[str, ...]:
    ends = [
        f"{value_words(result, nearest.parameter, end)} or a little {word}"
        for end, word in ((nearest.below, "less"), (nearest.above, "more"))
        if end is not None
    ]
    own = value_words(result, nearest.parameter, nearest.value)
    return nearest.parameter, ", or ".join(ends), f"its value {own}"
