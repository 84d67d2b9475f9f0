"""Changes of ranges, limits and tolerances that would help a design; each is tried.

A range is widened by ``STEP`` of its width beyond an end: the best settings are tried quickly with
values of that quantity beyond it. A limit is widened by ``STEP`` as well, or relaxed as far as a
setting of the search needs that keeps all others. A tolerance is halved. What is said of a change
is what the check of its setting found.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from vibralign.answers.design import Design, Known, Tried, checked, rounded
from vibralign.answers.design_trials import Trials
from vibralign.answers.reliability import Floats

STEP = 0.5  # of a range or limit, by which it is widened
_BEST = 4  # settings that are tried beyond an end of a range
_BEYOND = (1.0 / 3.0, 2.0 / 3.0, 1.0)  # of a step
_CHECKS = 4  # most settings that are checked for one change
_HALVED = 0.5


class Proposal(NamedTuple):
    """A change that may help.

    Attributes:
        kind: "relax" for a limit that is relaxed as far as needed; "limit", "upper end" or "lower
            end" for one that is widened by ``STEP``; "tolerance" for one that is halved.
        name: name of the limit or quantity.
    """

    kind: str
    name: str


@dataclass(frozen=True)
class Change:
    """A change that was tried, and the design with it.

    Attributes:
        proposal: the change.
        value: value of the limit, end or width after the change, in SI units.
        design: the best setting with it, checked; other limits, ranges and tolerances hold.
        better: True if the setting keeps the limits and has a better score than without.
    """

    proposal: Proposal
    value: float
    design: Design
    better: bool


def proposed(design: Design, tolerances: Iterable[str]) -> list[Proposal]:
    """Return the changes that may help, the most promising first.

    If no setting keeps the limits, each limit is relaxed, that first which needs least by the
    settings of the search; else those that bind are widened. Ends of ranges are widened that bind,
    and all if no device goes in. Tolerances are halved if some devices, but not all, go in; that
    comes first if no limit is passed.
    """
    share, free, limits = design.tried.share[design.best], design.free, design.limits
    ends: Sequence[tuple[str, str]] = design.near_ends
    if not share > 0.0:
        ends = [(name, side) for name in free for side in ("lower", "upper")]
    wider = [Proposal("limit", name) for name in (design.near_limits if design.feasible else [])]
    wider += [Proposal(f"{side} end", name) for name, side in ends]
    relax = [] if design.feasible else sorted(limits, key=lambda name: _needed(design, name))
    relaxed = [Proposal("relax", name) for name in relax]
    halved = [Proposal("tolerance", name) for name in tolerances if 0.0 < share < 1.0]
    passed = design.tried.excess(limits)[design.best] > 0.0
    return [*relaxed, *wider, *halved] if passed else [*halved, *relaxed, *wider]


def attempted(trials: Trials, design: Design, known: Known, proposal: Proposal) -> Change | None:
    """Return a change with the design that it gives, None if the device cannot have it.

    Raises:
        SpentError: it takes more runs than are left to the trials.
    """
    kind, name = proposal
    if kind == "relax":
        return _relaxed(trials, design, known, proposal)
    if kind == "tolerance":
        return _halved(trials, design, proposal)
    if kind == "limit":
        value = (1.0 + STEP) * design.limits[name]
        wide = _with(trials, limits={**design.limits, name: value})
        return _change(proposal, value, wide, design, known)
    return _beyond_end(trials, design, known, proposal)


def _needed(design: Design, name: str) -> float:
    """Return the least share of a limit by which a setting of the search keeps all others."""
    others = {each: limit for each, limit in design.limits.items() if each != name}
    keeps = design.tried.keeps(others)
    if not keeps.any():
        return np.inf
    if name == "vibration":  # which is left out, not relaxed
        return 1.0
    return float(design.tried.measures[name][keeps].min() / design.limits[name])


def _relaxed(trials: Trials, design: Design, known: Known, proposal: Proposal) -> Change:
    """Return the least value of a limit with which a setting of the search keeps all others."""
    name = proposal.name

    def least(tried: Tried) -> Floats:
        return tried.measures[name]

    others = {each: limit for each, limit in design.limits.items() if each != name}
    rank = None if name == "vibration" else least  # which is left out, not relaxed
    found = checked(_with(trials, limits=others), known, rank, _CHECKS)
    value = float(found.tried.measures[name][found.best])
    return Change(proposal, value, found, found.feasible)


def _halved(trials: Trials, design: Design, proposal: Proposal) -> Change:
    """Return the design of the recommended setting with half of a tolerance."""
    place, stated = tuple(design.setting.values()), trials.stated
    measures = [float(values[design.best]) for values in design.tried.measures.values()]
    known: Known = {place: (1.0, 0.0, *measures)}
    whole = stated.tolerances[proposal.name]
    half = replace(whole, width=_HALVED * whole.width)
    narrow = {**stated.tolerances, proposal.name: half}
    found = checked(replace(trials, stated=replace(stated, tolerances=narrow)), known, most=1)
    return Change(proposal, half.width, found, found.feasible)


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
    proposal: Proposal, value: float, trials: Trials, design: Design, known: Known
) -> Change:
    """Return a change with the design that holds for these trials."""
    found = checked(trials, known, most=_CHECKS)
    now, before = (float(each.tried.score(found.limits)[each.best]) for each in (found, design))
    return Change(proposal, value, found, better=found.feasible and now < before)


def _beyond_end(trials: Trials, design: Design, known: Known, proposal: Proposal) -> Change | None:
    """Return the change of an end of a range, None if the device may not have such values."""
    side, name = proposal.kind.removesuffix(" end"), proposal.name
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
        return None
    wide, points = _with(trials, free=ends), list(dict.fromkeys(points))
    rows = dict(zip(points, wide.quick(np.array(points)), strict=True))
    value = float(f"{far:.4g}")
    return _change(proposal, value, wide, design, {**known, **rows})
