"""Assess a device: its alignment from every start, and the leeway of its parameters.

A device is made with tolerances and wears; a single run covers neither. A reliable device aligns
from every start (starts.py). The leeway of a parameter is the range, in steps of one ratio, in
which the device stays reliable while its other parameters are held.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from model.physics.parameters import Parameters
from model.runs.settings import Settings
from model.study.config import Ensemble
from model.study.starts import Starts, from_every_start, starts_of

VARIED = (
    "press_force", "tilt_stiffness", "frequency", "friction", "misalignment", "clearance",
)  # fmt: skip
STEP = 2.0 ** (1.0 / 12.0)  # ratio of neighbouring values, 6 %
STEPS = 24  # to either side: from a quarter to four times the value
_AT_ONCE = 4  # steps tried together, to either side of each parameter


@dataclass(frozen=True)
class Leeway:
    """The range of one parameter in which the device stays reliable.

    Attributes:
        parameter, value: its name, and the device's own value.
        low, high: outermost values tried such that all values tried between them are reliable.
        bounded_below, bounded_above: True if the next value was tried and is not reliable; False
            if the trials end there, after ``STEPS`` or at the bound of the parameter.
    """

    parameter: str
    value: float
    low: float
    high: float
    bounded_below: bool
    bounded_above: bool


@dataclass(frozen=True)
class Assessment:
    """Results of a device from every start, and its leeways; times are dimensionless.

    Attributes:
        starts, aligned: number of starts, and of those from which the device aligns.
        tau_best, tau_worst: shortest and longest duration of aligning runs, NaN if there is none.
        failing_start: the first start from which the device does not align, or None.
        leeways: of the parameters in ``VARIED`` that are not 0; empty if not reliable.
    """

    starts: int
    aligned: int
    tau_best: float
    tau_worst: float
    failing_start: Mapping[str, float] | None
    leeways: tuple[Leeway, ...]

    @property
    def reliable(self) -> bool:
        """True if the device aligns from every start."""
        return self.failing_start is None


def assess(
    device: Parameters, settings: Settings, ensemble: Ensemble, cores: int = 1
) -> Assessment:
    """Assess ``device`` by some thousand runs on ``cores``."""
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
    """Trials of one parameter, up or down from its own value, which comes first."""

    parameter: str
    values: list[float]
    reliable: int = 1  # leading values known to be reliable
    failed: bool = False

    @property
    def pending(self) -> list[float]:
        """The values to try next."""
        return [] if self.failed else self.values[self.reliable : self.reliable + _AT_ONCE]

    @property
    def reached(self) -> float:
        """The outermost value up to which all are reliable."""
        return self.values[self.reliable - 1]

    def learn(self, reliable: Sequence[bool]) -> None:
        """Enter the results of the pending values."""
        self.failed = self.failed or not all(reliable)
        self.reliable += [*reliable, False].index(False)


def _leeways(
    device: Parameters, starts: Starts, settings: Settings, cores: int
) -> tuple[Leeway, ...]:
    own = {name: getattr(device, name) for name in VARIED if getattr(device, name) != 0.0}
    searches = [
        _Search(name, _values(device, name, ratio)) for name in own for ratio in (1.0 / STEP, STEP)
    ]
    while pending := [(each, value) for each in searches for value in each.pending]:
        swept = {
            name: np.array(
                [value if each.parameter == name else own[name] for each, value in pending]
            )
            for name in {each.parameter: None for each, _ in pending}
        }
        reliable = iter(from_every_start(device, swept, starts, settings, cores).reliable.tolist())
        for search in searches:
            search.learn([next(reliable) for _ in search.pending])
    return tuple(
        Leeway(name, own[name], down.reached, up.reached, down.failed, up.failed)
        for name, down, up in zip(own, searches[::2], searches[1::2], strict=True)
    )


def _values(device: Parameters, name: str, ratio: float) -> list[float]:
    """The parameter's own value and those to try, nearest first, within its bounds."""
    found = [getattr(device, name)]
    for step in range(1, STEPS + 1):
        value = getattr(device, name) * ratio**step
        try:
            device.replace(**{name: value})
        except ValueError:
            break
        found.append(value)
    return found
