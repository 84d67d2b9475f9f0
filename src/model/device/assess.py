"""Assess a device: success from every start and on other bases, and leeways of its parameters.

Phase and tilt at touch-down cannot be controlled: a *reliable* device succeeds from every start
(starts.py). Success is to align in the alignment scene, and to go in in the insertion scene.
Where the base is not stated, bases of several stiffnesses are tried, each with a low and a high
coefficient of restitution.
"""

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.device import StatedDevice
from model.device.batches import Values
from model.device.leeways import Leeway, Nearest, leeways, nearest
from model.device.reliability import are_reliable
from model.device.runs import AnyDevice, as_run, device_of
from model.events.insertion import INSERTION
from model.physics.parameters import Batch
from model.physics.tables import Value
from model.runs.settings import Settings
from model.runs.simulate import Trajectory, simulate_once
from model.sweeps.settings import Ensemble
from model.sweeps.starts import Starts, every_start, starts_of

DECADES = (1e2, 1e3, 1e4, 1e5, 1e6)  # contact stiffness over axial stiffness
RESTITUTIONS = (0.3, 0.8)  # tried where no impact is stated
_BASE_STARTS = 4  # every fourth start is tried on a base
_HOPPING = 8  # number of starts whose touch-downs are examined
_SAME_TIME = 0.02  # relative difference below which two times count as equal


@dataclass(frozen=True, eq=False, repr=False)
class BaseVerdict(Value):
    """Results of a device on one base, from every start; dimensionless.

    Attributes:
        contact_stiffness: contact stiffness over axial stiffness.
        restitution: coefficient of restitution; None where the device states the damping.
        starts: number of starts.
        aligned: number of starts from which the device succeeds.
        tau_best, tau_worst: shortest and longest alignment time of these, NaN without any.
    """

    contact_stiffness: float
    restitution: float | None
    starts: int
    aligned: int
    tau_best: float
    tau_worst: float

    @property
    def reliable(self) -> bool:
        """True if the device succeeds from every start on this base."""
        return self.aligned == self.starts

    @property
    def times(self) -> tuple[float, float]:
        """Shortest and longest alignment time."""
        return self.tau_best, self.tau_worst

    def agrees_with(self, other: "BaseVerdict") -> bool:
        """Return whether as many starts succeed, in the same time within 2 %."""
        return self.aligned == other.aligned and all(
            math.isnan(one) or abs(one - two) <= _SAME_TIME * two
            for one, two in zip(self.times, other.times, strict=True)
        )


class Successes(NamedTuple):
    """Number of starts from which a device succeeds, and its times, dimensionless; NaN if none."""

    aligned: int
    tau_best: float
    tau_worst: float


@dataclass(frozen=True, eq=False, repr=False)
class Assessment(Value):
    """Results of a device from every start and on its bases, dimensionless, and its leeways.

    Attributes:
        starts: number of starts.
        aligned: number of starts from which the device succeeds.
        tau_best, tau_worst: shortest and longest alignment time of these, NaN without any.
        failing_start: the first start from which the device does not succeed, or None.
        contact_force_max, tilt_max: largest value over all starts.
        separations: smallest and largest number of lift-offs over all starts.
        impact_speed: largest closing rate at a touch-down, of the eight starts that lift off most.
        leeways: of the values in ``VARIED`` that are not 0, in SI units for a device of a file;
            empty if a start fails.
        nearest: nearest reliable values of these; empty if no start fails.
        bases: verdicts on other bases; empty if none was tried.
        if_square: successes of a square part in its place; None if the shape is stated.
    """

    starts: int
    aligned: int
    tau_best: float
    tau_worst: float
    failing_start: Mapping[str, float] | None
    contact_force_max: float = math.nan
    tilt_max: float = math.nan
    separations: tuple[int, int] = (0, 0)
    impact_speed: float = 0.0
    leeways: tuple[Leeway, ...] = ()
    nearest: tuple[Nearest, ...] = ()
    bases: tuple[BaseVerdict, ...] = ()
    if_square: Successes | None = None

    def __repr__(self) -> str:
        words = "reliable" if self.reliable else "not reliable"
        words = "depends on the base" if self.depends_on_base else words
        return f"<Assessment: {words}, goes in from {self.aligned} of {self.starts} starts>"

    @property
    def reliable(self) -> bool:
        """True if the device succeeds from every start, on every base that was tried."""
        return self.failing_start is None and all(each.reliable for each in self.bases)

    @property
    def depends_on_base(self) -> bool:
        """True if the device is reliable on some of the bases and not on others."""
        verdicts = {self.failing_start is None, *(each.reliable for each in self.bases)}
        return len(verdicts) > 1

    @property
    def rigid_from(self) -> float | None:
        """Smallest contact stiffness tried above which neither verdict nor time changes."""
        return self._alike_from(BaseVerdict.agrees_with)

    @property
    def decided_from(self) -> float | None:
        """Smallest contact stiffness tried above which the verdict does not change."""
        return self._alike_from(lambda one, limit: one.reliable == limit.reliable)

    @property
    def last_change(self) -> float:
        """Largest relative change of a time between the two stiffest bases; NaN without one."""
        changes = [
            abs(limit_time / time - 1.0)
            for base, limit in itertools.pairwise(self.bases)
            if limit.contact_stiffness == max(each.contact_stiffness for each in self.bases)
            for time, limit_time in zip(base.times, limit.times, strict=True)
        ]
        return max(filter(math.isfinite, changes), default=math.nan)

    def _alike_from(self, alike: Callable[[BaseVerdict, BaseVerdict], bool]) -> float | None:
        """Return the stiffness from which on all bases are like the stiffest of their restitution.

        None if there is no such stiffness.
        """
        least = None
        for stiffness in sorted({each.contact_stiffness for each in self.bases}, reverse=True):
            for each in self.bases:
                limit = [b for b in self.bases if b.restitution == each.restitution][-1]
                if each.contact_stiffness == stiffness and not alike(each, limit):
                    return least
            least = stiffness
        return least


def assess(
    device: AnyDevice,
    settings: Settings | None = None,
    ensemble: Ensemble | None = None,
    cores: int = 1,
    *,
    bases: bool = False,
    vary: bool = True,
) -> Assessment:
    """Assess a device by some thousand runs.

    Args:
        device: as ``simulate`` takes it.
        settings: settings of the runs; None for the defaults, in the insertion scene.
        ensemble: the starts; None for those of the study.
        cores: number of threads.
        bases: try other bases of a device of a file, even if it states one.
        vary: seek the leeways, or the nearest reliable values if a start fails.
    """
    device = device_of(device)
    parameters, settings = as_run(device, settings or Settings(scene=INSERTION), {})
    starts = starts_of(parameters, ensemble or Ensemble())
    results = every_start(Batch.stack([parameters]), starts, settings, cores)
    aligned, tau = results["goes_in"][0], results["tau_align"][0]
    failing = [start for start, aligns in zip(starts, aligned, strict=True) if not aligns]
    hops = results["separations"][0]
    hopping = [starts[i] for i in np.argsort(-hops, kind="stable")[:_HOPPING] if hops[i] > 0]
    speeds = [impact_speed(simulate_once(parameters.replace(**s), settings)) for s in hopping]

    def is_reliable(values: Values) -> NDArray[np.bool_]:
        return are_reliable(device, values, starts, settings, cores)

    others: tuple[BaseVerdict, ...] = ()
    if isinstance(device, StatedDevice) and (bases or not device.base_is_stated):
        others = on_bases(device, starts, settings, cores)
    return Assessment(
        len(starts),
        *_successes(aligned, tau),
        failing_start=failing[0] if failing else None,
        contact_force_max=float(np.fmax.reduce(results["contact_force_max"][0])),
        tilt_max=float(np.fmax.reduce(results["tilt_max"][0])),
        separations=(int(hops.min()), int(hops.max())),
        impact_speed=max(speeds, default=0.0),
        leeways=leeways(device, is_reliable) if vary and not failing else (),
        nearest=nearest(device, is_reliable) if vary and failing else (),
        bases=others,
        if_square=_if_square(device, starts, settings, cores),
    )


def _if_square(
    device: AnyDevice, starts: Starts, settings: Settings, cores: int
) -> Successes | None:
    """Return the successes of a square part in place of one whose shape is not stated."""
    if not isinstance(device, StatedDevice) or device.stated_shape is not None:
        return None
    square = replace(device, stated_shape="square").parameters
    settings = replace(settings, shape="square")
    results = every_start(Batch.stack([square]), starts, settings, cores)
    return _successes(results["goes_in"][0], results["tau_align"][0])


def on_bases(
    stated: StatedDevice, starts: Starts, settings: Settings, cores: int = 1
) -> tuple[BaseVerdict, ...]:
    """Return the verdicts on bases of every stiffness in ``DECADES``, the softest first.

    The impact is as the device states it. Where it states none, ``RESTITUTIONS`` are tried in turn.
    """
    axial = stated.resolved({})["axial_stiffness"]
    own = stated.quantities.get("restitution")
    impacts: tuple[float | None, ...] = RESTITUTIONS if own is None else (own,)
    if "contact_damping" in stated.quantities:
        impacts = (None,)
    tried = [(ratio, impact) for impact in impacts for ratio in DECADES]
    devices = [
        stated.at(
            {"contact_stiffness": ratio * axial}
            | ({} if impact is None else {"restitution": impact})
        ).parameters
        for ratio, impact in tried
    ]
    starts = starts[::_BASE_STARTS]
    quick = replace(settings.quickest, tolerance=max(settings.tolerance, 1e-6))
    results = every_start(Batch.stack(devices), starts, quick, cores)
    runs = zip(tried, results["goes_in"], results["tau_align"], strict=True)
    return tuple(
        BaseVerdict(ratio, impact, len(starts), *_successes(aligned, tau))
        for (ratio, impact), aligned, tau in runs
    )


def _successes(aligned: NDArray[np.bool_], tau: NDArray[np.float64]) -> Successes:
    times = tau[aligned]
    ends = (float(times.min()), float(times.max())) if times.size else (math.nan, math.nan)
    return Successes(times.size, *ends)


def impact_speed(run: Trajectory) -> float:
    """Return the largest closing rate of edge A1 at a touch-down, dimensionless; 0 without one."""
    force = run.contact_force
    landings = np.flatnonzero((force[:-1] == 0.0) & (force[1:] > 0.0) & (run.time[:-1] > 0.0))
    edge = run.parameters.slot_half_width
    rates = []
    for x, y, tilt, x_rate, y_rate, tilt_rate in run.state[landings]:
        # Velocity of the point of the part at the edge, across the bottom face.
        point_x_rate = x_rate + tilt_rate * y
        point_y_rate = y_rate + tilt_rate * (edge - x)
        rates.append(point_x_rate * math.sin(tilt) - point_y_rate * math.cos(tilt))
    return float(max(rates, default=0.0))
