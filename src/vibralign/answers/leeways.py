"""Leeways of a device: ranges in which it stays reliable, one parameter at a time.

Each parameter is scanned from its value, downwards and upwards, in steps of one ratio, a few steps
of all parameters in one batch; the gripper's tilt, whose value may be 0, in steps that add. More
batches divide the step in which the verdict changes, and then such a part, so that the end of the
range is known to ``FINEST``. Values are tried with the digits that are printed.

The border of a part that hops is *ragged*: values that fail lie among values that hold, down to
slivers of 0.01 %. So ``UNBROKEN`` values ``FINEST`` apart are tried inwards from an end, ``BEYOND``
outwards, and from a ragged end ``ACROSS`` more to the device's own value. The end moves inwards
past any that fails, until all of these hold.

The same scan finds the nearest reliable values of a device that is not reliable, to a quarter of a
step: each value that holds costs all cases of all approaches. All values are in SI units. Mass,
axial stiffness and amplitude, which are the units of the dimensionless parameters, are scanned as
well.
"""

import itertools
import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from model.physics.units import UNITS
from vibralign.device import StatedDevice
from vibralign.device.instead import name_in
from vibralign.device.mouth import GRIPPER_TILT

VARIED = (
    "press_force", "frequency", "tilt_stiffness", "lateral_stiffness", "inertia", "friction",
    "misalignment", "clearance", "lateral_damping", "axial_damping", "tilt_damping",
    "contact_stiffness", "contact_damping",
)  # fmt: skip
STEP = 2.0 ** (1.0 / 12.0)  # ratio of neighbouring values, 6 %
ADDED: Mapping[str, float] = {GRIPPER_TILT: math.radians(0.1)}  # steps of values that add
STEPS = 24  # steps of a scan: from a quarter to four times the value
AT_ONCE = 4  # values of each scan that are tried together
PARTS = 4, 5  # of the step in which the verdict changes; then of such a part
DIGITS = 4  # of the values
FINEST = STEP ** (1.0 / math.prod(PARTS)) * (1.0 + 10.0 ** (1 - DIGITS)) - 1.0  # 0.4 %
_FINEST_STEP = math.log(1.0 + FINEST) / math.log(STEP)  # in steps
UNBROKEN, BEYOND, ACROSS = 8, 3, 24  # values inwards from an end, outwards, and to the own value

Names = Collection[str]
IsReliable = Callable[[Mapping[str, np.ndarray]], np.ndarray]
"""Takes parameters that vary together, shape (n,) each; returns where the device is reliable."""


@dataclass(frozen=True)
class Leeway:
    """The range of one parameter in which the device stays reliable.

    Attributes:
        parameter: name of the parameter.
        value: the device's own value.
        low, high: smallest and largest value such that all values tried between are reliable.
        fails_below, fails_above: value beyond that was tried and is not reliable, at most
            ``FINEST`` away unless the border is ragged; None if the scan ends there, after
            ``STEPS`` or at the parameter's bound.
        late_below, late_above: True if this value fails by the horizon only: a longer one may let
            it go in.
        ragged_below, ragged_above: True if values that fail lie among values that hold there.
    """

    parameter: str
    value: float
    low: float
    high: float
    fails_below: float | None = None
    fails_above: float | None = None
    late_below: bool = False
    late_above: bool = False
    ragged_below: bool = False
    ragged_above: bool = False


@dataclass(frozen=True)
class Nearest:
    """Nearest values of one parameter with which an unreliable device becomes reliable.

    Attributes:
        parameter: name of the parameter.
        value: the device's own value.
        below, above: nearest reliable value on either side, None if no value tried is reliable.
    """

    parameter: str
    value: float
    below: float | None
    above: float | None


class _End(NamedTuple):
    """End of a scan.

    Attributes:
        parameter: name of the parameter.
        value: the device's own value.
        alike: last value with the verdict of the device.
        other: first value with the other verdict, None if no value tried has it.
        ragged: True if values of both verdicts were found in turn.
    """

    parameter: str
    value: float
    alike: float
    other: float | None
    ragged: bool = False


def moved(name: str, value: float, steps: float) -> float:
    """Return a value some steps of a scan away, outwards from 0 for steps of a ratio > 0."""
    if name in ADDED:
        return value + steps * ADDED[name]
    return value * STEP**steps


def steps_between(name: str, value: float, other: float) -> float:
    """Return how many steps of a scan lie between two values, as ``moved`` counts them."""
    if name in ADDED:
        return (other - value) / ADDED[name]
    return math.log(other / value) / math.log(STEP)


def leeways(
    device: StatedDevice,
    is_reliable: IsReliable,
    is_late: IsReliable | None = None,
    held: Names = (),
    roughly: IsReliable | None = None,
) -> tuple[Leeway, ...]:
    """Return the leeways of a reliable device.

    ``is_late`` tells where devices fail by the horizon only; ``held`` are not varied. The steps are
    tried by ``roughly``, if given; ends, and parts of steps, by ``is_reliable``.
    """
    may_differ = None if roughly is None else lambda values: ~roughly(values)
    ends = _ends(device, is_reliable, held, may_differ, None, PARTS)
    ends, late = _unbroken(device, is_reliable, ends), []
    beyond = [(each.parameter, each.other) for each in ends if each.other is not None]
    if is_late is not None and beyond:
        late = is_late(_swept(_own(device, held), beyond)).tolist()
    found = iter(late or [False] * len(beyond))
    hang = [each.other is not None and next(found) for each in ends]
    return tuple(
        Leeway(d.parameter, d.value, d.alike, u.alike, d.other, u.other,
               below, above, d.ragged, u.ragged)
        for d, u, below, above in zip(ends[::2], ends[1::2], hang[::2], hang[1::2], strict=True)
    )  # fmt: skip


def nearest(
    device: StatedDevice,
    is_reliable: IsReliable,
    held: Names = (),
    may_be: IsReliable | None = None,
) -> tuple[Nearest, ...]:
    """Return the nearest reliable values of a device that is not reliable, by parameter.

    A parameter of which no value tried is reliable is left out; ``held`` are not varied. Values
    that ``may_be`` excludes, at less cost, are not tried.
    """
    ends = _ends(device, lambda values: ~is_reliable(values), held, may_be, may_be, PARTS[:1])
    return tuple(
        Nearest(down.parameter, down.value, down.other, up.other)
        for down, up in zip(ends[::2], ends[1::2], strict=True)
        if (down.other, up.other) != (None, None)
    )


def a_step_inside(
    device: StatedDevice, is_reliable: IsReliable, change: Mapping[str, float]
) -> Mapping[str, float]:
    """Return a change of one parameter a step further from its own value, where that is reliable.

    Else the change itself; an empty one is returned as it is.
    """
    if not change:
        return change
    [(name, border)] = change.items()
    way = math.copysign(1.0, steps_between(name, _own(device)[name], border))
    inside = _values(device, name, border, way, 1)[1:]
    if inside and is_reliable({name: np.array(inside)}).all():
        return {name: inside[0]}
    return change


def _ends(
    device: StatedDevice,
    are_alike: IsReliable,
    held: Names,
    may_differ: IsReliable | None,
    parts_may_differ: IsReliable | None,
    parts_of_step: Sequence[int],
) -> list[_End]:
    """Return the end of the scan of each value that is not 0, downwards and upwards in turn.

    ``may_differ`` and ``parts_may_differ`` exclude steps, and parts of steps, at less cost.
    """
    own = _own(device, held)
    names = [n for n, value in own.items() if value != 0.0 or n in ADDED for _ in range(2)]
    scans = [
        _values(device, name, own[name], step)
        for name, step in zip(names, itertools.cycle((-1.0, 1.0)), strict=False)
    ]
    judged: dict[tuple[str, float], bool] = {}  # by ``are_alike``
    known = _leading(own, names, scans, are_alike, judged, may_differ)
    for count in parts_of_step:
        open_ones = [i for i, (values, n) in enumerate(zip(scans, known, strict=True))
                     if n < len(values)]  # fmt: skip
        parts = [
            _divided(names[i], scans[i][known[i] - 1], scans[i][known[i]], count) for i in open_ones
        ]
        finer = _leading(
            own, [names[i] for i in open_ones], parts, are_alike, judged, parts_may_differ
        )
        for i, between, n in zip(open_ones, parts, finer, strict=True):
            scans[i], known[i] = [*between, scans[i][known[i]]], n
    return [
        _End(name, own[name], values[n - 1], values[n] if n < len(values) else None)
        for name, values, n in zip(names, scans, known, strict=True)
    ]


def _divided(name: str, start: float, stop: float, count: int) -> list[float]:
    """Return the first of two values, and the values that divide their interval."""
    between = np.linspace if name in ADDED else np.geomspace
    return [start, *map(_printed, between(start, stop, count + 1)[1:-1].tolist())]


def _unbroken(device: StatedDevice, is_reliable: IsReliable, ends: Sequence[_End]) -> list[_End]:
    """Return the ends of scans, moved inwards until all values tried inside hold."""
    own, found = {each.parameter: each.value for each in ends}, list(ends)
    left = [i for i, end in enumerate(found) if end.other is not None]
    while left:
        rows = [(_inwards(device, found[i]), _beyond(device, found[i])) for i in left]
        tried = [(found[i].parameter, value) for i, (inside, beyond) in zip(left, rows, strict=True)
                 for value in (*inside[:-1], *beyond)]  # fmt: skip
        holds, moved = iter(is_reliable(_swept(own, tried)).tolist()), []
        for i, (inside, beyond) in zip(left, rows, strict=True):
            fails = [n for n, _ in enumerate(inside[:-1]) if not next(holds)]
            again, end = True in [next(holds) for _ in beyond], found[i]
            if fails:
                end = end._replace(alike=inside[fails[-1] + 1], other=inside[fails[-1]])
            found[i] = end._replace(ragged=end.ragged or bool(fails) or again)
            if fails or found[i].ragged > end.ragged:
                moved.append(i)
        left = moved
    return found


def _inwards(device: StatedDevice, end: _End) -> list[float]:
    """Return an end, the values to try inwards from it, and the value after these."""
    assert end.other is not None  # noqa: S101 - the caller's
    name, outwards = end.parameter, _way(end)
    row = _values(device, name, end.alike, -outwards * _FINEST_STEP, UNBROKEN)
    row = [each for each in row if steps_between(name, end.value, each) * outwards > 0.0]
    if len(row) <= UNBROKEN:
        return [*row, end.value]
    across = _divided(name, row[-1], end.value, ACROSS)[1:] if end.ragged else []
    return [*dict.fromkeys([*row, *across]), *([end.value] if end.ragged else [])]


def _way(end: _End) -> float:
    """Return 1.0 if an end lies above its value in steps of a scan, else -1.0."""
    assert end.other is not None  # noqa: S101 - the caller's
    return math.copysign(1.0, steps_between(end.parameter, end.value, end.other))


def _beyond(device: StatedDevice, end: _End) -> list[float]:
    """Return ``BEYOND`` values outwards from an end, without it."""
    return _values(device, end.parameter, end.alike, _way(end) * _FINEST_STEP, BEYOND)[1:]


def _printed(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _leading(
    own: Mapping[str, float],
    names: Sequence[str],
    scans: Sequence[list[float]],
    are_alike: IsReliable,
    judged: dict[tuple[str, float], bool],
    may_differ: IsReliable | None = None,
) -> list[int]:
    """Return how many leading values of each scan, its own first, have the device's verdict.

    Verdicts are added to ``judged``; values that have one are not tried again. A scan ends with the
    few values among which the verdict changes. With ``may_differ``, values that cannot differ are
    alike, and of the others each scan tries one at a time, until its verdict changes.
    """
    some, known = {name: own[name] for name in names}, [1] * len(scans)

    def judge(tried: list[tuple[str, float]], verdict: IsReliable) -> dict[Any, bool]:
        return dict(zip(tried, verdict(_swept(some, tried)).tolist(), strict=True)) if tried else {}

    for begin in range(1, max(map(len, scans), default=0), AT_ONCE):
        parts = {
            i: [(names[i], value) for value in scans[i][begin : begin + AT_ONCE]]
            for i, n in enumerate(known)
            if n == begin < len(scans[i])
        }
        tried = [each for each in _of_all(parts.values()) if each not in judged]
        if may_differ is None:
            judged |= judge(tried, are_alike)
        else:
            judged |= {each: True for each, may in judge(tried, may_differ).items() if not may}
        while tried := _of_all(_next_to_try(part, judged) for part in parts.values()):
            judged |= judge(tried, are_alike)
        for i, part in parts.items():
            known[i] += [*(judged.get(each, False) for each in part), False].index(False)
    return known


def _of_all(parts: Iterable[Sequence[tuple[str, float]]]) -> list[tuple[str, float]]:
    """Return the distinct values of all parts, in their order."""
    return list(dict.fromkeys(itertools.chain.from_iterable(parts)))


def _next_to_try(
    part: Sequence[tuple[str, float]], judged: Mapping[tuple[str, float], bool]
) -> Sequence[tuple[str, float]]:
    """Return the first value of a part without a verdict, if all before it are alike."""
    alike = list(itertools.takewhile(lambda each: judged.get(each, False), part))
    return [each for each in part[len(alike) : len(alike) + 1] if each not in judged]


def _swept(own: Mapping[str, float], tried: Sequence[tuple[str, float]]) -> dict[str, np.ndarray]:
    """Return the values of devices each of which has one value of its own."""
    return {
        name: np.array([value if varied == name else usual for varied, value in tried])
        for name, usual in own.items()
    }


def _own(device: StatedDevice, held: Names = ()) -> dict[str, float]:
    """Return the device's own values of what is varied, in SI units.

    These are by the names by which the file states them, such as ``play`` for the clearance.
    """
    values = {**device.values, **device.quantities}
    names = [name for name in (*UNITS, *VARIED, *ADDED) if name not in held]
    return {each: values[each] for each in (name_in(device.quantities, name) for name in names)}


def _values(
    device: StatedDevice, name: str, own: float, step: float, steps: int | None = None
) -> list[float]:
    """Return the parameter's own value and the values of a scan that its rule admits."""
    values = [own]
    for number in range(1, (steps or STEPS) + 1):
        value = _printed(moved(name, own, number * step))
        try:
            device.admitted({name: value})
        except ValueError:
            break
        values.append(value)
    return values
