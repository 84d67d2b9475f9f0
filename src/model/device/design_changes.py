"""Changes of ranges, limits and tolerances that would help a design; each is tried.

A range is widened by ``STEP`` of its width beyond an end: the best settings are tried quickly with
values of that quantity beyond it. A limit is widened by ``STEP`` as well, or relaxed as far as a
setting of the search needs that keeps all others. A tolerance is halved. What is said of a change
is what the check of its setting found.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from model.device.design import Design, Known, Tried, checked, rounded
from model.device.design_trials import Trials
from model.device.reliability import Floats

STEP = 0.5  # of a range or limit, by which it is widened
_BEST = 4  # settings that are tried beyond an end of a range
_BEYOND = (1.0 / 3.0, 2.0 / 3.0, 1.0)  # of a step
_CHECKS = 4  # most settings that are checked for one change
_HALVED = 0.5


@dataclass(frozen=True)
class Change:
    """A change of a limit, or of an end of a range, and the design with it.

    Attributes:
        kind: "limit", "upper end" or "lower end".
        name: name of the limit or quantity.
        value: its value after the change, in SI units.
        design: the best setting with it, checked; other limits and ranges hold.
        better: True if the setting keeps the limits and has a better score than without.
    """

    kind: str
    name: str
    value: float
    design: Design
    better: bool


def relaxed(trials: Trials, design: Design, known: Known) -> list[Change]:
    """Return for each limit the least value with which a setting of the search keeps all others.

    A limit without such a setting is left out, and all are if the design is feasible.
    """
    changes = []
    for name in {} if design.feasible else design.limits:

        def least(tried: Tried, name: str = name) -> Floats:
            return tried.measures[name]

        others = {each: limit for each, limit in design.limits.items() if each != name}
        rank = None if name == "vibration" else least  # which is left out, not relaxed
        found = checked(_with(trials, limits=others), known, rank, _CHECKS)
        if found.feasible:
            value = float(found.tried.measures[name][found.best])
            changes.append(Change("limit", name, value, found, better=True))
    return changes


def widened(trials: Trials, design: Design, known: Known) -> list[Change]:
    """Return the design with each limit or end of a range widened that binds.

    All ends of ranges are, if no device goes in at the recommended setting.
    """
    limits = design.near_limits if design.feasible else []
    changes = [_beyond_limit(trials, design, known, name) for name in limits]
    ends: Sequence[tuple[str, str]] = design.near_ends
    if not design.tried.share[design.best] > 0.0:
        ends = [(name, side) for name in design.free for side in ("lower", "upper")]
    for name, side in ends:
        changes += _beyond_end(trials, design, known, name, side)
    return changes


def halved(trials: Trials, design: Design) -> dict[str, Design]:
    """Return by tolerance the design of the recommended setting with half of that tolerance.

    Only where it then keeps the limits; empty unless some, and not all, devices go in as it is.
    """
    if not 0.0 < design.tried.share[design.best] < 1.0:
        return {}
    place, stated = tuple(design.setting.values()), trials.stated
    measures = [float(values[design.best]) for values in design.tried.measures.values()]
    known: Known = {place: (1.0, 0.0, *measures)}
    found = {}
    for name, each in stated.tolerances.items():
        narrow = {**stated.tolerances, name: replace(each, width=_HALVED * each.width)}
        some = replace(trials, stated=replace(stated, tolerances=narrow))
        found[name] = checked(some, known, most=1)
    return {name: each for name, each in found.items() if each.feasible}


def _with(
    trials: Trials,
    *,
    limits: Mapping[str, float] | None = None,
    free: Mapping[str, tuple[float, float]] | None = None,
) -> Trials:
    stated = trials.stated
    limits, free = stated.limits if limits is None else limits, free or stated.free
    return replace(trials, stated=replace(stated, limits=limits, free=free))


def _change(
    kind: str, name: str, value: float, trials: Trials, design: Design, known: Known
) -> Change:
    """Return a change with the design that holds for these trials."""
    found = checked(trials, known, most=_CHECKS)
    now, before = (float(each.tried.score(found.limits)[each.best]) for each in (found, design))
    return Change(kind, name, value, found, better=found.feasible and now < before)


def _beyond_limit(trials: Trials, design: Design, known: Known, name: str) -> Change:
    value = (1.0 + STEP) * design.limits[name]
    wide = _with(trials, limits={**design.limits, name: value})
    return _change("limit", name, value, wide, design, known)


def _beyond_end(
    trials: Trials, design: Design, known: Known, name: str, side: str
) -> Iterator[Change]:
    """Yield the change of an end of a range, if the device may have such values."""
    low, high = design.free[name]
    far = high + STEP * (high - low)
    if side == "lower":
        far = max(low - STEP * (high - low), STEP * low) if low > 0.0 else low - STEP * (high - low)
    ends = {**design.free, name: (min(low, far), max(high, far))}
    end = high if side == "upper" else low
    order = np.argsort(design.tried.score(design.limits), kind="stable")[:_BEST].tolist()
    best = dict.fromkeys([design.best, *order])
    points = []
    for share in _BEYOND:
        for number in best:
            own = {n: float(values[number]) for n, values in design.tried.settings.items()}
            point = {**own, name: end + share * (far - end)}
            try:
                trials.stated.admitted(point)
            except ValueError:
                continue
            points.append(rounded(list(point.values()), ends))
    if not points:
        return
    wide, points = _with(trials, free=ends), list(dict.fromkeys(points))
    rows = dict(zip(points, wide.quick(np.array(points)), strict=True))
    value = float(f"{far:.4g}")
    yield _change(f"{side} end", name, value, wide, design, {**known, **rows})
