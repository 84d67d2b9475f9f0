"""How safely a device aligns: from every start, and with each parameter off its value.

A device is made with tolerances and wears; a single run says nothing of either. Reliable is what
aligns from every start (starts.py). The leeway of a parameter is how far it alone may go from its
value, in steps of one ratio, until the device is not reliable; the rest is held.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from model.physics.parameters import Parameters
from model.runs.settings import Settings
from model.study.config import Ensemble
from model.study.starts import FromEveryStart, Starts, from_every_start, starts_of

VARIED = (
    "press_force", "tilt_stiffness", "frequency", "friction", "misalignment", "clearance",
)  # fmt: skip
STEP = 2.0 ** (1.0 / 12.0)  # ratio of neighbouring values, 6 %
STEPS = 24  # to either side: from a quarter to four times the value
_AT_ONCE = 4  # steps that are tried together, to either side of each parameter


@dataclass(frozen=True)
class Leeway:
    """How far one parameter may go while the device stays reliable.

    Attributes:
        parameter, value: which, and the device's own value.
        low, high: the outermost values tried that are reliable with all between.
        bounded_below, bounded_above: whether the next value tried is not; if it is, what was tried
            ends there, by ``STEPS`` or by the rule of the parameter.
    """

    parameter: str
    value: float
    low: float
    high: float
    bounded_below: bool
    bounded_above: bool


@dataclass(frozen=True)
class Assessment:
    """A device from every start, and its leeways; times dimensionless.

    Attributes:
        starts: how many there are; ``aligned`` says of how many it aligns.
        tau_best, tau_worst: shortest and longest duration of those that align, NaN if none does.
        failing_start: the first start from which it does not align, None if there is none.
        leeways: of the parameters of ``VARIED`` that are not 0; none of a device not reliable.
    """

    starts: int
    aligned: int
    tau_best: float
    tau_worst: float
    failing_start: Mapping[str, float] | None
    leeways: tuple[Leeway, ...]

    @property
    def reliable(self) -> bool:
        """Whether it aligns from every start."""
        return self.failing_start is None


def assess(
    device: Parameters, settings: Settings, ensemble: Ensemble, cores: int = 1
) -> Assessment:
    """How safely ``device`` aligns; some thousand runs."""
    starts = starts_of(device, ensemble)
    own = {"friction": np.array([device.friction])}
    found = from_every_start(device, own, starts, settings, cores)
    tau = found.tau_align[found.aligned]
    failing = [start for start, aligns in zip(starts, found.aligned[0], strict=True) if not aligns]
    return Assessment(
        starts=len(starts),
        aligned=int(found.aligned.sum()),
        tau_best=float(tau.min()) if tau.size else float("nan"),
        tau_worst=float(tau.max()) if tau.size else float("nan"),
        failing_start=failing[0] if failing else None,
        leeways=() if failing else _leeways(device, starts, settings, cores),
    )


@dataclass
class _Search:
    """One parameter, going up or down from its value."""

    parameter: str
    values: list[float]  # still to be tried, the nearest first
    reached: float
    failed: bool = False

    @property
    def tried_next(self) -> list[float]:
        return [] if self.failed else self.values[:_AT_ONCE]

    def learn(self, reliable: Sequence[bool]) -> None:
        for value, holds in zip(self.tried_next, reliable, strict=True):
            if not holds:
                self.failed = True
                return
            self.reached = value
        del self.values[: len(reliable)]


def _leeways(
    device: Parameters, starts: Starts, settings: Settings, cores: int
) -> tuple[Leeway, ...]:
    names = [name for name in VARIED if getattr(device, name) != 0.0]
    searches = {
        (name, up): _Search(name, _values(device, name, up), getattr(device, name))
        for name in names
        for up in (False, True)
    }
    while waiting := [each for each in searches.values() if each.tried_next]:
        found = _try(device, waiting, starts, settings, cores)
        reliable = iter(found.reliable.tolist())
        for each in waiting:
            each.learn([next(reliable) for _ in each.tried_next])
    return tuple(
        Leeway(
            parameter=name,
            value=getattr(device, name),
            low=searches[name, False].reached,
            high=searches[name, True].reached,
            bounded_below=searches[name, False].failed,
            bounded_above=searches[name, True].failed,
        )
        for name in names
    )


def _values(device: Parameters, name: str, up: bool) -> list[float]:
    """Values to be tried, the nearest first, as far as the parameter's rule lets them."""
    ratio = STEP if up else 1.0 / STEP
    found = []
    for step in range(1, STEPS + 1):
        value = getattr(device, name) * ratio**step
        try:
            device.replace(**{name: value})
        except ValueError:
            break
        found.append(value)
    return found


def _try(
    device: Parameters,
    searches: Sequence[_Search],
    starts: Starts,
    settings: Settings,
    cores: int,
) -> FromEveryStart:
    """The next values of every search, as one batch."""
    count = sum(len(each.tried_next) for each in searches)
    swept = {each.parameter: np.full(count, getattr(device, each.parameter)) for each in searches}
    first = 0
    for each in searches:
        last = first + len(each.tried_next)
        swept[each.parameter][first:last] = each.tried_next
        first = last
    return from_every_start(device, swept, starts, settings, cores)
