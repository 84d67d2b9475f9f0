"""The sheet of an assessment: its answer in some ten lines, each a label and words."""

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from model.events.outcomes import SUCCESS_TEXT, Outcome
from model.physics.quantities import FORCE, LENGTH, TIME
from model.physics.units import Units
from model.runs.settings import Settings
from vibralign.answers.assumptions import depth_of, source_words
from vibralign.answers.forces import tip_force
from vibralign.answers.leeways import Leeway, Nearest, steps_between
from vibralign.answers.si import (
    in_words,
    range_words,
    si_words,
    written_words,
)
from vibralign.answers.verdicts import Verdict
from vibralign.device import StatedDevice
from vibralign.device.approach import SPEED
from vibralign.device.base import restitution_at
from vibralign.device.mouth import GRIPPER_TILT
from vibralign.device.quantities import quantity_of
from vibralign.device.stated import FOLLOWED

if TYPE_CHECKING:
    from vibralign.answers.assess import Assessment

Rows = list[tuple[str, str]]
DIGITS = 3
_NEAREST = 4  # borders that are named


def verdict_words(result: "Assessment") -> str:
    """Return the verdict on a device at its stated values."""
    good = [str(each.of) for each in result.approaches if each.reliable]
    if result.approaches and not result.reliable:
        which = f"only with the approach {' or '.join(good)}" if good else "with no approach tried"
        return f"reliable {which}" + (", and it depends on the base" * result.depends_on_base)
    if result.depends_on_base:
        return "depends on the base: measure it"
    words = f"{'' if result.reliable else 'not '}reliable at the stated values"
    words = f"{words}, whatever the approach" if result.approaches else words
    return f"{words}, up to where the chamfers meet" if result.device.is_chamfered else words


def sheet_rows(
    result: "Assessment", verdict: str = "", more: Sequence[tuple[str, str]] = ()
) -> Rows:
    """Return the rows of the sheet.

    Args:
        result: the assessment.
        verdict: words of the verdict, by default those at the stated values.
        more: further rows, such as those on the yield.
    """
    stated, settings = result.device, result.settings or Settings()
    units = stated.units
    rows = [("device", device_words(stated)), ("verdict", verdict or verdict_words(result))]
    rows.append((SUCCESS_TEXT[settings.success], f"{_tried(result)}{_followed(stated, settings)}"))
    if result.failing_start is not None:
        rows += [("for example", _example(result)), ("cause", result.cause)]
        rows += [("first to change", change_words(result))] if result.change else []
    if result.aligned:
        rows.append(("time", _times(result, units, settings)))
    rows.append(("largest force", _forces(result, units, settings)))
    rows.append(("vibration", _vibration(result)))
    label = "reliable with" if result.failing_start is not None else "fails from"
    found = "; ".join(_borders(result)) or "nothing that was tried, within a factor of four"
    found += "; each of these exceeds a limit" if result.change_exceeds else ""
    if result.leeways and result.worst is not None:
        found += f"; all this with the approach that is slowest, {result.worst}"
    rows += [(label, found)] if result.leeways or result.nearest else []
    rows += more
    rows.append(("not stated", _not_stated(result, stated)))
    words = f"computed to a local error of {settings.tolerance:g} a step; the error of the model "
    return [*rows, ("numbers", f"{words}itself is not included")]


def device_words(stated: StatedDevice) -> str:
    """Return the file of a device and what the part is."""
    return f"{source_words(stated)}: {part_words(stated)}"


def part_words(stated: StatedDevice) -> str:
    """Return shape, size and place of a part, in the units of its file."""
    given = {**stated.values, **stated.quantities}

    def words(parameter: str, *instead: str, times: float = 1.0) -> str:
        for name in instead:
            if name in stated.quantities:
                return written_words(name, given[name], stated, DIGITS)
        return written_words(parameter, times * given[parameter], stated, DIGITS)

    play = 2.0 * given["clearance"] * given["half_width"]
    gap = written_words("play", play, stated, DIGITS)
    length = f" by {words('half_height', 'length', times=2.0)}"
    if "centre_height" in stated.quantities:  # the file states no length
        length = f", mass centre {words('centre_height')} over its face"
    assumed = " (not stated)" if stated.stated_shape is None else ""
    return (
        f"{stated.shape}{assumed}, {words('half_width', 'diameter', times=2.0)}{length}, "
        f"play {gap}, {words('misalignment')} beside the hole"
    )


def change_words(result: "Assessment") -> str:
    """Return the first change of a device that is not reliable."""
    [(name, value)] = result.change.items()
    borders = [{each.parameter: v} for each in result.nearest for v in (each.below, each.above)]
    tried = "tried; 6 % further it is not" if result.change in borders else "tried"
    said = f"{name} to {value_words(result, name, value)}: with it, it is reliable ({tried})"
    exceeded = " and ".join(result.change_exceeds)
    none = "no change that was tried keeps the limits"
    return f"{said}; {none}: this one exceeds the limit of {exceeded}" if exceeded else said


def value_words(result: "Assessment", name: str, value: float, digits: int = 4) -> str:
    """Return a value of the device in the unit of its file."""
    return written_words(name, value, result.device, digits)


def texts(result: "Assessment", of: Leeway | Nearest) -> dict[str, str]:
    """Return the values of a leeway, or of nearest values, in the unit of the file."""
    numbers = {name: each for name, each in vars(of).items() if type(each) is float}
    return {name: value_words(result, of.parameter, each) for name, each in numbers.items()}


def _tried(result: "Assessment") -> str:
    counts = {
        "approach": len(result.approaches), "base": len(result.bases),
        "tilt of the gripper": len(result.tilts),
    }  # fmt: skip
    words = ", ".join(_counted(each, number) for each, number in counts.items() if number > 1)
    share = "all" if result.aligned == result.starts else f"{result.aligned:,} of"
    return f"from {share} {result.starts:,} touch-downs tried{words and f': {words}'}"


def _followed(stated: StatedDevice, settings: Settings) -> str:
    """Return how far a part is followed."""
    if settings.success is not Outcome.INSERTED:
        return f"; {FOLLOWED}" if stated.is_chamfered else ""
    depth = in_words(depth_of(stated.parameters, settings), LENGTH, stated.units, DIGITS)
    return f"; followed to a depth of {depth}"


def _counted(what: str, number: int) -> str:
    one, _, rest = what.partition(" ")
    return f"{number} {one}{'es' if one.endswith('ch') else 's'}{rest and f' {rest}'}"


def _example(result: "Assessment") -> str:
    assert result.failing_start is not None  # noqa: S101 - the caller's
    words = ", ".join(
        f"{name} = {si_words(value, quantity_of(name)[1], DIGITS)}"
        for name, value in result.failing_start.items()
    )
    return words if result.failing_approach is None else f"{result.failing_approach}: {words}"


def _times(result: "Assessment", units: Units, settings: Settings) -> str:
    words = f"{range_words(*result.times, TIME, units, DIGITS)} until aligned"
    if result.inserted[0] == result.inserted[0]:  # no NaN
        words += f", {range_words(*result.inserted, TIME, units, DIGITS)} until inserted"
    starts = {"running": "from the first touch", "still": "from the onset of the vibration"}
    if result.approaches:
        return f"{words}; from the first touch, or the onset of a still vibrator"
    return f"{words}; {starts.get(settings.start or '', 'from the touch')}"


def _forces(result: "Assessment", units: Units, settings: Settings) -> str:
    def words(force: float) -> str:
        return in_words(force, FORCE, units, DIGITS)

    places = sorted(result.forces, key=lambda each: -result.forces[each])
    tips = f" ({words(tip_force(result.forces['edge']))} at each tip)" if result.forces else ""
    named = [
        f"{words(result.forces[n])} at the {n}{tips * (n == 'edge' and settings.shape == 'round')}"
        for n in places
        if result.forces[n] > 0.0
    ]
    said = ", ".join(named) or words(result.contact_force_max)
    each = [v for v in (*result.approaches, *result.bases) if not math.isnan(v.force_least)]
    if len(each) > 1:
        least = min(v.force_least for v in each)
        most = max(v.force_most for v in each)
        which = "approach and base" if result.approaches and result.bases else "base"
        which = which if result.bases else "approach"
        said += f"; {range_words(least, most, FORCE, units, DIGITS)} by {which}"
    return said


def _vibration(result: "Assessment") -> str:
    words = result.unvibrated
    pressed = sum(each.by_press for each in result.approaches)
    needed = "not needed" if words.startswith("aligns") else "needed"
    words = f"{needed}: only pressed, it {words}"
    return f"{words}; the press alone brings it in from {pressed} touch-downs" if pressed else words


def _borders(result: "Assessment") -> Iterator[str]:
    """Yield the nearest values at which the verdict changes, the nearest first."""
    found = _changing(result)
    for name, own, value in found[:_NEAREST]:
        for digits in range(DIGITS, 8):  # until they differ
            at, stated = (value_words(result, name, each, digits) for each in (value, own))
            if at != stated:
                break
        yield f"{name} {at} (stated {stated})"
    if len(found) > _NEAREST:
        yield "others farther away"


def _changing(result: "Assessment") -> list[tuple[str, float, float]]:
    """Return (name, own value, value at which the verdict changes), the nearest change first."""
    ranges = [*result.leeways, *([result.tilt_range] if result.tilt_range else [])]
    ends = [(e.parameter, e.value, v) for e in ranges for v in (e.fails_below, e.fails_above)]
    if result.failing_start is not None:
        ends = [(e.parameter, e.value, v) for e in result.nearest for v in (e.below, e.above)]
    found = [(name, own, value) for name, own, value in ends if value is not None]
    return sorted(found, key=lambda each: abs(steps_between(*each)))


def deciding(result: "Assessment") -> list[str]:
    """Return the quantities that decide the verdict, the one that has to change least first."""
    return list(dict.fromkeys(name for name, _, _ in _changing(result)))


def _not_stated(result: "Assessment", stated: StatedDevice) -> str:
    """Return what the file leaves open, and which of it decides most."""
    open_ones: dict[str, Sequence[Verdict]] = {}
    if result.approaches:
        known = {SPEED: SPEED in stated.quantities, "vibrator": bool(stated.vibrator)}
        open_ones[" and ".join(name for name, is_known in known.items() if not is_known)] = (
            result.approaches
        )
    if not stated.base_is_stated:
        fixed = math.isfinite(stated.fixture)
        open_ones["the base on its fixture" if fixed else "the base"] = result.bases
    if GRIPPER_TILT not in stated.quantities:
        open_ones[GRIPPER_TILT] = result.tilts
    impact = ""
    if stated.base_is_stated and not stated.quantities.keys() & {"restitution", "contact_damping"}:
        taken = restitution_at(stated.parameters, stated.shape)
        impact = f"restitution: the model's damping gives {taken:.2g}, whatever the materials are "
        impact += "(metals: 0.6 to 0.9, plastics: 0.3 to 0.6), so state it"
    if not open_ones:
        return impact or "nothing: approach, base and gripper's tilt are stated"
    words = f"{impact and f'{impact}; '}{', '.join(open_ones)}: tried as above"
    tried = {name: each for name, each in open_ones.items() if len(each) > 1}
    if not tried:
        return words
    spread = {name: _spread(each) for name, each in tried.items()}
    first = max(spread, key=lambda name: spread[name])
    turns = "turns the verdict" if spread[first][0] > 0.0 else "changes the force most"
    return f"{words}; state {first} first: this {turns}"


def _spread(verdicts: Sequence[Verdict]) -> tuple[float, float]:
    """Return by how much the shares of success differ, and the ratio of the largest forces."""
    shares = [each.aligned / each.starts for each in verdicts]
    forces = [each.force_most for each in verdicts]
    ratio = max(forces) / min(forces) if min(forces) > 0.0 else math.inf
    return max(shares) - min(shares), 0.0 if math.isnan(ratio) else ratio
