"""Worst corner of a device with tolerances: the failing combination nearest to its own values.

Distances are in tolerances: 1 is the end of a uniform one, and three standard deviations of a
normal one; of a combination the largest counts. The search starts from failing devices that were
drawn and from the corners of the box, moves each along the line to the device's own values as long
as it fails, and then each quantity by itself.
"""

import itertools
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from model.runs.settings import Settings
from model.study.assessment.yields import Devices, Floats, distribution, run_devices
from model.study.devices import StatedDevice
from model.study.starts import Starts

_SIGMAS = 3.0
_CORNERS = 128  # of the box, at most
_CANDIDATES = 8  # failing combinations that are followed
_LINE = 16  # points tried together on a line
_DIGITS = 6  # of the values on the command line


@dataclass(frozen=True)
class WorstCorner:
    """The nearest failing combination found.

    Attributes:
        quantities: values of the quantities that are off, in SI units.
        distance: largest deviation, in tolerances.
        start: phase and tilt at touch-down of a failing run.
        scene: name of the scene of its runs.
        insertion_depth: depth at which they count as inserted, in m; None for the default one.
    """

    quantities: Mapping[str, float]
    distance: float
    start: Mapping[str, float]
    scene: str
    insertion_depth: float | None = None

    def command(self, stated: StatedDevice) -> str:
        """Return the command line that runs it."""
        changes = {n: f"{v}" for n, v in stated.changes.items()}
        changes |= {n: f"{v:.{_DIGITS}g}" for n, v in self.quantities.items()}
        changes |= {n: repr(v) for n, v in self.start.items()}
        words = " ".join(
            f"--set {name}={value}" if " " not in value else f"--set '{name}={value}'"
            for name, value in changes.items()
        )
        if self.insertion_depth is not None:
            words = f"--insertion-depth {self.insertion_depth!r} {words}"
        return f"vibralign simulate --device {stated.source} --scene {self.scene} {words}"


def worst_corner(
    stated: StatedDevice, known: Devices, starts: Starts, settings: Settings, cores: int = 1
) -> WorstCorner | None:
    """Return the nearest failing combination found; None if none fails.

    Args:
        stated: device with tolerances.
        known: devices drawn within them.
        starts: phases and tilts at touch-down.
        settings: settings of the runs.
        cores: number of threads.
    """
    names = list(stated.tolerances)
    own = np.array([stated.quantities[name] for name in names])
    ends = np.array([_ends(stated, name) for name in names])

    def span_of(places: Floats) -> Floats:
        return np.where(places > 0.0, ends[:, 1] - own, own - ends[:, 0])

    def values_at(places: Floats) -> Floats:
        return own + places * span_of(places)

    def fails(places: Floats) -> np.ndarray:
        rounded = _rounded(values_at(places))
        values = {name: rounded[:, i] for i, name in enumerate(names)}
        return ~run_devices(stated, values, starts, settings, cores).goes_in

    drawn = np.stack([known.values[name] for name in names], axis=1)[~known.goes_in] - own
    span = span_of(drawn)
    places = np.divide(drawn, span, out=np.zeros_like(drawn), where=span > 0.0)
    places = np.concatenate([places[np.abs(places).max(axis=1) <= 1.0], _corners(len(names))])
    order = np.argsort(np.abs(places).max(axis=1), kind="stable")
    tried = places[order[: _CANDIDATES + _CORNERS]]
    failing = tried[fails(tried)]
    if not len(failing):
        return None
    followed = [_towards(place, fails) for place in failing[:_CANDIDATES]]
    best = min((_alone(place, fails) for place in followed), key=lambda p: float(np.abs(p).max()))
    return _described(stated, names, _rounded(values_at(best)), best, starts, settings, cores)


def _ends(stated: StatedDevice, name: str) -> tuple[float, float]:
    value, tolerance = stated.quantities[name], stated.tolerances[name]
    low, high = distribution(name, value, tolerance).support()
    spread = _SIGMAS * tolerance.around(value)
    return (
        (low, high)
        if tolerance.kind == "uniform"
        else (max(low, value - spread), min(high, value + spread))
    )


def _rounded(values: Floats) -> Floats:
    """Return the values as the command line states them."""
    return np.array([[float(f"{v:.{_DIGITS}g}") for v in row] for row in np.atleast_2d(values)])


def _corners(size: int) -> Floats:
    if 2**size <= _CORNERS:
        return np.array(list(itertools.product((-1.0, 1.0), repeat=size)))
    return np.random.default_rng(0).choice((-1.0, 1.0), size=(_CORNERS, size))


def _towards(place: Floats, fails: object) -> Floats:
    """Return the failing point nearest to 0 on the line to ``place``, of those tried twice."""
    low, high = 0.0, 1.0
    for _ in range(2):
        shares = np.linspace(low, high, _LINE + 1)[1:-1]
        failing = np.flatnonzero(fails(shares[:, None] * place))  # type: ignore[operator]
        first = float(shares[failing[0]]) if failing.size else high
        low, high = max(first - (high - low) / _LINE, low), first
    return high * place


def _alone(place: Floats, fails: object) -> Floats:
    """Return ``place`` with every quantity at its own value that need not be off."""
    for index in np.argsort(np.abs(place)):
        without = place.copy()
        without[index] = 0.0
        if without.any() and fails(without[None])[0]:  # type: ignore[operator]
            place = without
    return place


def _described(
    stated: StatedDevice,
    names: list[str],
    values: Floats,
    place: Floats,
    starts: Starts,
    settings: Settings,
    cores: int,
) -> WorstCorner:
    each = {name: values[0, i : i + 1] for i, name in enumerate(names)}
    found = run_devices(stated, each, starts, settings, cores)
    off = {name: float(values[0, i]) for i, name in enumerate(names) if place[i] != 0.0}
    start, depth = starts[max(int(found.failing[0]), 0)], settings.insertion_depth
    if depth is not None:
        depth *= stated.device.units.amplitude
    return WorstCorner(off, float(np.abs(place).max()), dict(start), settings.scene.name, depth)
