"""Leeways of a device: ranges in which it stays reliable, one parameter at a time.

Each parameter is scanned from its value, downwards and upwards, in steps of one ratio, all in one
batch. A second batch divides the step in which the verdict changes, so that the end of the range is
known to ``FINEST``. The same scan finds the nearest reliable values of a device that is not
reliable. The values of a device that its file states are in SI units. Its mass, axial stiffness and
amplitude, which are the units of its dimensionless parameters, are scanned as well.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

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
PARTS = 16  # of the step in which the verdict changes
FINEST = STEP ** (1.0 / PARTS) - 1.0  # 0.4 %

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


class _End(NamedTuple):
    """End of a scan.

    Attributes:
        parameter: name of the parameter.
        value: the device's own value.
        alike: last value with the verdict of the device.
        other: first value with the other verdict, None if no value tried has it.
    """

    parameter: str
    value: float
    alike: float
    other: float | None


def leeways(device: Stated, is_reliable: IsReliable) -> tuple[Leeway, ...]:
    """Return the leeways of a reliable device."""
    ends = _ends(device, is_reliable)
    return tuple(
        Leeway(d.parameter, d.value, d.alike, u.alike, d.other is not None, u.other is not None)
        for d, u in zip(ends[::2], ends[1::2], strict=True)
    )


def nearest(device: Stated, is_reliable: IsReliable) -> tuple[Nearest, ...]:
    """Return the nearest reliable values of a device that is not reliable, by parameter.

    A parameter of which no value tried is reliable is left out.
    """
    ends = _ends(device, lambda values: ~is_reliable(values))
    return tuple(
        Nearest(down.parameter, down.value, down.other, up.other)
        for down, up in zip(ends[::2], ends[1::2], strict=True)
        if (down.other, up.other) != (None, None)
    )


def _ends(device: Stated, are_alike: IsReliable) -> list[_End]:
    """Return the end of the scan of each value that is not 0, downwards and upwards in turn."""
    own = _own(device)
    scans = [
        (name, _values(device, name, value, ratio))
        for name, value in own.items()
        if value != 0.0
        for ratio in (1.0 / STEP, STEP)
    ]
    known = _leading(own, scans, are_alike)
    parts = [
        (name, np.geomspace(values[n - 1], values[n], PARTS + 1).tolist()[:-1])
        for (name, values), n in zip(scans, known, strict=True)
        if n < len(values)
    ]
    finer = iter(zip(parts, _leading(own, parts, are_alike), strict=True))
    ends = []
    for (name, values), n in zip(scans, known, strict=True):
        alike, other = values[n - 1], None
        if n < len(values):
            (_, between), m = next(finer)
            alike, other = between[m - 1], [*between, values[n]][m]
        ends.append(_End(name, values[0], alike, other))
    return ends


def _leading(
    own: Mapping[str, float], scans: Sequence[tuple[str, list[float]]], are_alike: IsReliable
) -> list[int]:
    """Return how many leading values of each scan have the verdict of the device, its own first."""
    tried = [(name, value) for name, values in scans for value in values[1:]]
    if not tried:
        return [1] * len(scans)
    swept = {
        name: np.array([value if varied == name else own[name] for varied, value in tried])
        for name in dict.fromkeys(name for name, _ in scans)
    }
    alike = iter(are_alike(swept).tolist())
    return [[True, *(next(alike) for _ in values[1:]), False].index(False) for _, values in scans]


def _own(device: Stated) -> dict[str, float]:
    """Return the device's own values of what is varied, in SI units for a device of a file."""
    if isinstance(device, Parameters):
        return {name: getattr(device, name) for name in VARIED}
    values = device.values
    return {name: values[name] for name in (*UNITS, *VARIED)}


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
