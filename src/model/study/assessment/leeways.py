"""Leeways of a device: ranges in which it stays reliable, one parameter at a time.

Each parameter is moved off its value in steps of one ratio; the last step is halved until the end
is known to ``FINEST``. For a device that is not reliable, the nearest reliable value on either
side is sought alike.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from model.physics.parameters import Parameters

VARIED = (
    "press_force", "tilt_stiffness", "frequency", "friction", "misalignment", "clearance",
    "lateral_damping", "axial_damping", "tilt_damping", "contact_stiffness", "contact_damping",
)  # fmt: skip
STEP = 2.0 ** (1.0 / 12.0)  # ratio of neighbouring values, 6 %
STEPS = 24  # to either side: from a quarter to four times the value
HALVINGS = 4  # of the last step
FINEST = STEP ** (0.5**HALVINGS) - 1.0  # 0.4 %
_AT_ONCE = 4  # steps tried together, to either side of each parameter

Try = Callable[[Mapping[str, np.ndarray]], np.ndarray]
"""Parameters varied together, each of shape (n,) -> True where the device is reliable."""


@dataclass(frozen=True)
class Leeway:
    """The range of one parameter in which the device stays reliable.

    Attributes:
        parameter, value: its name, and the device's own value.
        low, high: outermost values tried such that all values tried between them are reliable.
        bounded_below, bounded_above: True if a value at most ``FINEST`` further was tried and is
            not reliable; False if the trials end there, after ``STEPS`` or at the bound of the
            parameter.
    """

    parameter: str
    value: float
    low: float
    high: float
    bounded_below: bool
    bounded_above: bool


@dataclass(frozen=True)
class Nearest:
    """The reliable values of one parameter nearest to that of a device that is not reliable.

    Attributes:
        parameter, value: its name, and the device's own value.
        below, above: the nearest values found, None where none of those tried is reliable.
    """

    parameter: str
    value: float
    below: float | None
    above: float | None


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

    def learn(self, reliable: Sequence[bool]) -> None:
        """Enter the results of the pending values."""
        self.failed = self.failed or not all(reliable)
        self.reliable += [*reliable, False].index(False)


def leeways(device: Parameters, is_reliable: Try) -> tuple[Leeway, ...]:
    """Return the leeways of a reliable device."""
    searches = _searches(device)
    while pending := [(each, value) for each in searches for value in each.pending]:
        reliable = iter(_try(device, [(e.parameter, v) for e, v in pending], is_reliable))
        for search in searches:
            search.learn([next(reliable) for _ in search.pending])
    ends = [each.values[each.reliable - 1] for each in searches]
    brackets = [
        (each.parameter, end, each.values[each.reliable])
        for each, end in zip(searches, ends, strict=True)
        if each.failed
    ]
    refined = iter(_halved(device, brackets, is_reliable))
    ends = [next(refined) if each.failed else end for each, end in zip(searches, ends, strict=True)]
    return tuple(
        Leeway(down.parameter, down.values[0], low, high, down.failed, up.failed)
        for down, up, low, high in zip(
            searches[::2], searches[1::2], ends[::2], ends[1::2], strict=True
        )
    )


def nearest(device: Parameters, is_reliable: Try) -> tuple[Nearest, ...]:
    """Return the nearest reliable values of a device that is not reliable; none if all fail."""
    searches = _searches(device)
    tried = [(each.parameter, value) for each in searches for value in each.values[1:]]
    reliable = iter(_try(device, tried, is_reliable))
    firsts = []
    for search in searches:
        works = [False, *(next(reliable) for _ in search.values[1:])]
        firsts.append(works.index(True) if any(works) else 0)
    brackets = [
        (each.parameter, each.values[first], each.values[first - 1])
        for each, first in zip(searches, firsts, strict=True)
        if first
    ]
    refined = iter(_halved(device, brackets, is_reliable))
    ends = [next(refined) if first else None for first in firsts]
    found = [
        Nearest(search.parameter, search.values[0], below, above)
        for search, below, above in zip(searches[::2], ends[::2], ends[1::2], strict=True)
    ]
    return tuple(each for each in found if (each.below, each.above) != (None, None))


def _searches(device: Parameters) -> list[_Search]:
    own = [name for name in VARIED if getattr(device, name) != 0.0]
    return [
        _Search(name, _values(device, name, ratio)) for name in own for ratio in (1.0 / STEP, STEP)
    ]


def _try(device: Parameters, tried: Sequence[tuple[str, float]], is_reliable: Try) -> list[bool]:
    """Return whether the device is reliable with each parameter at its value, one at a time."""
    if not tried:
        return []
    names = dict.fromkeys(name for name, _ in tried)
    swept = {
        name: np.array([value if own == name else getattr(device, name) for own, value in tried])
        for name in names
    }
    return [bool(each) for each in is_reliable(swept)]


def _halved(
    device: Parameters, brackets: Sequence[tuple[str, float, float]], is_reliable: Try
) -> list[float]:
    """Return the reliable ends of brackets (parameter, reliable value, failing value), halved."""
    ends = [(good, bad) for _, good, bad in brackets]
    for _ in range(HALVINGS):
        middles = [float(np.sqrt(good * bad)) for good, bad in ends]
        tried = [(name, middle) for (name, _, _), middle in zip(brackets, middles, strict=True)]
        works = _try(device, tried, is_reliable)
        ends = [
            (middle, bad) if fine else (good, middle)
            for (good, bad), middle, fine in zip(ends, middles, works, strict=True)
        ]
    return [good for good, _ in ends]


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
