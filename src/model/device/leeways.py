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

from model.device import StatedDevice
from model.physics.parameters import Parameters
from model.physics.units import UNITS

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
        alike: number of leading values known to have the verdict of the device.
        ended: True once a value has the other verdict.
    """

    parameter: str
    values: list[float]
    alike: int = 1
    ended: bool = False

    @property
    def pending(self) -> list[float]:
        """The values to try next."""
        return [] if self.ended else self.values[self.alike : self.alike + _AT_ONCE]

    def learn(self, alike: Sequence[bool]) -> None:
        """Enter the results of the pending values."""
        self.ended = self.ended or not all(alike)
        self.alike += [*alike, False].index(False)


def leeways(device: Stated, is_reliable: IsReliable) -> tuple[Leeway, ...]:
    """Return the leeways of a reliable device."""
    scans = _scanned(device, is_reliable)
    ends = [scan.values[scan.alike - 1] for scan in scans]
    brackets = [
        (scan.parameter, end, scan.values[scan.alike])
        for scan, end in zip(scans, ends, strict=True)
        if scan.ended
    ]
    refined = iter(_halved(device, brackets, is_reliable))
    ends = [next(refined) if scan.ended else end for scan, end in zip(scans, ends, strict=True)]
    return tuple(
        Leeway(down.parameter, down.values[0], low, high, down.ended, up.ended)
        for down, up, low, high in zip(scans[::2], scans[1::2], ends[::2], ends[1::2], strict=True)
    )


def nearest(device: Stated, is_reliable: IsReliable) -> tuple[Nearest, ...]:
    """Return the nearest reliable values of a device that is not reliable, by parameter.

    A parameter of which no value tried is reliable is left out.
    """
    scans = _scanned(device, lambda values: ~is_reliable(values))
    brackets = [
        (scan.parameter, scan.values[scan.alike], scan.values[scan.alike - 1])
        for scan in scans
        if scan.ended
    ]
    refined = iter(_halved(device, brackets, is_reliable))
    ends = [next(refined) if scan.ended else None for scan in scans]
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


def _scanned(device: Stated, are_alike: IsReliable) -> list[_Scan]:
    """Return the scans, each tried until a value has not the verdict of the device."""
    scans = _scans(device)
    while pending := [(scan.parameter, value) for scan in scans for value in scan.pending]:
        alike = iter(_try(device, pending, are_alike))
        for scan in scans:
            scan.learn([next(alike) for _ in scan.pending])
    return scans


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
