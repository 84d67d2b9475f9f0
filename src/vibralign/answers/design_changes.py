"""Changes of what limits a design; each is tried.

If no setting keeps the limits, each limit is left out in turn, and the setting that exceeds it
least is sought; else a limit that is near is widened by ``STEP``. A range is widened by ``STEP`` of
its width beyond an end: the best settings are tried quickly with values of that quantity beyond it.
A tolerance is halved. The results of a change are those of the check of its setting.
"""

from dataclasses import dataclass, replace

import numpy as np

from vibralign.answers.design import Design, Known, Limiting, Tried, checked, rounded
from vibralign.answers.design_trials import Trials
from vibralign.answers.reliability import Floats

STEP = 0.5  # of a range or limit, by which it is widened
_BEST = 4  # settings that are tried beyond an end of a range
_BEYOND = (1.0 / 3.0, 2.0 / 3.0, 1.0)  # of a step
_CHECKS = 4  # most settings that are checked for one change


@dataclass(frozen=True)
class Change:
    """A change that was tried, and the design with it.

    Attributes:
        of: what is changed.
        value: value of the limit, end or width after the change, in SI units.
        design: the best setting with it, checked; other limits, ranges and tolerances hold.
        better: True if the setting keeps the limits and has a better score than before the change.
    """

    of: Limiting
    value: float
    design: Design
    better: bool


def attempted(trials: Trials, design: Design, known: Known, of: Limiting) -> Change | None:
    """Return a change with the design that it gives, None if the device cannot have it.

    Raises:
        SpentError: it takes more runs than are left to the trials.
    """
    kind, name, _ = of
    left_out = kind == "limit" and not design.feasible
    stated, rank, most, value = trials.stated, None, _CHECKS, 0.0
    if kind == "tolerance":
        whole = stated.tolerances[name]
        half = replace(whole, width=0.5 * whole.width)
        stated = replace(stated, tolerances={**stated.tolerances, name: half})
        measures = [float(values[design.best]) for values in design.tried.measures.values()]
        known, most = {tuple(design.setting.values()): (1.0, 0.0, *measures)}, 1
        value = half.width
    elif kind == "limit":
        others = {each: limit for each, limit in design.limits.items() if each != name}
        value = (1.0 + STEP) * design.limits[name]
        stated = replace(stated, limits=others if left_out else {**others, name: value})

        def least(tried: Tried) -> Floats:
            return tried.measures[name]

        rank = least if left_out and name != "vibration" else None
    else:
        beyond = _beyond_end(trials, design, of)
        if beyond is None:
            return None
        stated, more, value = replace(stated, free=beyond[0]), *beyond[1:]
        known = {**known, **more}
    found = checked(replace(trials, stated=stated), known, rank, most)
    if left_out:
        return Change(of, float(found.tried.measures[name][found.best]), found, found.feasible)
    now, before = (float(each.tried.score(found.limits)[each.best]) for each in (found, design))
    return Change(of, value, found, found.feasible and now < before)


def _beyond_end(
    trials: Trials, design: Design, of: Limiting
) -> tuple[dict[str, tuple[float, float]], Known, float] | None:
    """Return the wider ranges, quick trials beyond the end, and the new end.

    None if the device may not have such values.
    """
    name, upper = of.name, of.kind == "upper end"
    low, high = design.free[name]
    far = high + STEP * (high - low)
    if not upper:
        far = max(low - STEP * (high - low), STEP * low) if low > 0.0 else low - STEP * (high - low)
    far = float(f"{far:.4g}")
    ends, end = {**design.free, name: (min(low, far), max(high, far))}, high if upper else low
    order = np.argsort(design.tried.score(design.limits), kind="stable")[:_BEST].tolist()
    points = []
    for share in _BEYOND:
        for number in dict.fromkeys([design.best, *order]):
            own = {n: float(values[number]) for n, values in design.tried.settings.items()}
            point = {**own, name: end + share * (far - end)}
            try:
                trials.stated.admitted(point)
            except ValueError:
                continue
            points.append(rounded(list(point.values()), ends))
    if not points:
        return None
    points = list(dict.fromkeys(points))
    wide = replace(trials, stated=replace(trials.stated, free=ends))
    return ends, dict(zip(points, wide.quick(np.array(points)), strict=True)), far
