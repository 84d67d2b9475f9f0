"""Leeways of a device: ranges in which it stays reliable, one parameter at a time.

Each parameter is scanned from its value, downwards and upwards, in steps of one ratio. The step in
which the verdict changes is halved until the end of the range is known to ``FINEST``. The same scan
finds the nearest reliable values of a device that is not reliable. The values of a device that its
file states are in SI units. Its mass, axial stiffness and amplitude, which are the units of its
dimensionless parameters, are scanned as well.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from model.physics.parameters import Parameters
from model.physics.units import UNITS
from model.study.devices import StatedDevice

VARIED = (
    "press_force", "frequency", "tilt_stiffness", "lateral_stiffness", "inertia", "friction",
    "misalignment", "clearance", "lateral_damping", "axial_damping", "tilt_damping",
    "contact_stiffness", "contact_damping",
)  # fmt: skip
STEP = 2.0 ** (1.0 / 12.0)  # ratio of neighbouring values, 6 %
STEPS = 24  # steps of a scan: from a quarter to four times the value
HALVINGS = 4  # of the last step
FINEST = STEP ** (0.5**HALVINGS) - 1.0  # 0.4 %
_AT_ONCE = 4  # steps of a scan that are tried together

Stated = Parameters | StatedDevice
IsReliable = Callable[[Mapping[str, np.ndarray]], np.ndarray]
"""Takes parameters that vary together, shape (n,) each; returns where the device is reliable."""


@dataclass(frozen=True)
class Leeway:
    """The range of one parameter in which the device stays reliable.

    Attributes:
        parameter: name of the parameter.
        value: the device's own value.
        low, high: smallest and largest value such that all values tried between are reliable.
        bounded_below, bounded_above: True if a value at most ``FINEST`` beyond was tried and is not
            reliable; False if the scan ends there, after ``STEPS`` or at the parameter's bound.
    """

    parameter: str
    value: float
    low: float
    high: float
    bounded_below: bool
    bounded_above: bool


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


@dataclass
class _Scan:
    """Trials of one parameter upwards or downwards.

    Attributes:
        parameter: name of the parameter.
        values: values to try, the device's own first.
        reliable: number of leading values known to be reliable.
        failed: True once a value is not reliable.
    """

    parameter: str
    values: list[float]
    reliable: int = 1
    failed: bool = False

    @property
    def pending(self) -> list[float]:
        """The values to try next."""
        return [] if self.failed else self.values[self.reliable : self.reliable + _AT_ONCE]

    def learn(self, reliable: Sequence[bool]) -> None:
        """Enter the results of the pending values."""
        self.failed = self.failed or not all(reliable)
        self.reliable += [*reliable, False].index(False)


def leeways(device: Stated, is_reliable: IsReliable) -> tuple[Leeway, ...]:
    """Return the leeways of a reliable device."""
    scans = _scans(device)
    while pending := [(scan.parameter, value) for scan in scans for value in scan.pending]:
        reliable = iter(_try(device, pending, is_reliable))
        for scan in scans:
            scan.learn([next(reliable) for _ in scan.pending])
    ends = [scan.values[scan.reliable - 1] for scan in scans]
    brackets = [
        (scan.parameter, end, scan.values[scan.reliable])
        for scan, end in zip(scans, ends, strict=True)
        if scan.failed
    ]
    refined = iter(_halved(device, brackets, is_reliable))
    ends = [next(refined) if scan.failed else end for scan, end in zip(scans, ends, strict=True)]
    return tuple(
        Leeway(down.parameter, down.values[0], low, high, down.failed, up.failed)
        for down, up, low, high in zip(scans[::2], scans[1::2], ends[::2], ends[1::2], strict=True)
    )


def nearest(device: Stated, is_reliable: IsReliable) -> tuple[Nearest, ...]:
    """Return the nearest reliable values of a device that is not reliable, by parameter.

    A parameter of which no value tried is reliable is left out.
    """
    scans = _scans(device)
    tried = [(scan.parameter, value) for scan in scans for value in scan.values[1:]]
    reliable = iter(_try(device, tried, is_reliable))
    firsts = []  # index of the first reliable value of a scan, 0 without any
    for scan in scans:
        results = [False, *(next(reliable) for _ in scan.values[1:])]
        firsts.append(results.index(True) if any(results) else 0)
    brackets = [
        (scan.parameter, scan.values[first], scan.values[first - 1])
        for scan, first in zip(scans, firsts, strict=True)
        if first
    ]
    refined = iter(_halved(device, brackets, is_reliable))
    ends = [next(refined) if first else None for first in firsts]
    return tuple(
        Nearest(scan.parameter, scan.values[0], below, above)
        for scan, below, above in zip(scans[::2], ends[::2], ends[1::2], strict=True)
        if (below, above) != (None, None)
    )


def _own(device: Stated) -> dict[str, float]:
    """Return the device's own values of what is varied, in SI units for a device of a file."""
    if isinstance(device, Parameters):
        return {name: getattr(device, name) for name in VARIED}
    values = device.values
    return {name: values[name] for name in (*UNITS, *VARIED)}


def _scans(device: Stated) -> list[_Scan]:
    """Return the scans of the values that are not 0, downwards and upwards in turn."""
    own = _own(device)
    names = [name for name, value in own.items() if value != 0.0]
    return [
        _Scan(name, _values(device, name, own[name], ratio))
        for name in names
        for ratio in (1.0 / STEP, STEP)
    ]


def _try(device: Stated, tried: Sequence[tuple[str, float]], is_reliable: IsReliable) -> list[bool]:
    """Return whether the device is reliable with one parameter at another value, for each pair."""
    if not tried:
        return []
    own = _own(device)
    swept = {
        name: np.array([value if varied == name else own[name] for varied, value in tried])
        for name in dict.fromkeys(name for name, _ in tried)
    }
    return [bool(each) for each in is_reliable(swept)]


def _halved(
    device: Stated, brackets: Sequence[tuple[str, float, float]], is_reliable: IsReliable
) -> list[float]:
    """Halve brackets (parameter, reliable value, failing value) and return their reliable ends."""
    ends = [(good, bad) for _, good, bad in brackets]
    for _ in range(HALVINGS):
        middles = [float(np.sqrt(good * bad)) for good, bad in ends]
        tried = [(name, middle) for (name, _, _), middle in zip(brackets, middles, strict=True)]
        reliable = _try(device, tried, is_reliable)
        ends = [
            (middle, bad) if works else (good, middle)
            for (good, bad), middle, works in zip(ends, middles, reliable, strict=True)
        ]
    return [good for good, _ in ends]


def _values(device: Stated, name: str, own: float, ratio: float) -> list[float]:
    """Return the parameter's own value and the values of a scan that its rule admits."""
    values = [own]
    for step in range(1, STEPS + 1):
        value = own * ratio**step
        try:
            if isinstance(device, Parameters):
                device.replace(**{name: value})
            else:
                device.admitted({name: value})
        except ValueError:
            break
        values.append(value)
    return values
