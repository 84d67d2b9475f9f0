"""Assess a device: success in every case, leeways of its parameters, and why it fails.

Phase and tilt at touch-down cannot be controlled, and a base that is not stated is not known: a
*reliable* device succeeds from every start, on every base that is tried (cases.py). Success is to
align in the alignment scene, and to go in in the insertion scene.
"""

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.events.insertion import INSERTION
from model.physics.parameters import Batch, Parameters
from model.physics.tables import Value
from model.physics.units import UNITS
from model.runs.settings import Settings
from model.runs.simulate import Trajectory, simulate_once
from model.sweeps.settings import Ensemble
from model.sweeps.starts import Starts
from vibralign.answers.approaches import ApproachVerdict, with_each_approach, worst_of
from vibralign.answers.cases import (
    OF_BASE,
    approach_of,
    cases_of,
    on_bases,
    parameters_in,
    stated_case,
    without_approach,
)
from vibralign.answers.causes import cause_of, first_change
from vibralign.answers.leeways import (
    ADDED,
    VARIED,
    Leeway,
    Nearest,
    a_step_inside,
    leeways,
    nearest,
    together,
)
from vibralign.answers.reliability import (
    FORCES,
    STATISTICAL_TOLERANCE,
    are_late,
    are_reliable,
    from_every_start,
)
from vibralign.device import StatedDevice
from vibralign.device.approach import Approach
from vibralign.device.batches import Values
from vibralign.device.mouth import GRIPPER_TILT
from vibralign.device.runs import AnyDevice, device_of, of_device

_HOPPING = 8  # number of cases whose touch-downs are examined
_SAME_TIME = 0.02  # relative difference below which two times count as equal
_PAIRED = "press_force", "tilt_stiffness", "friction", "amplitude"  # changed two together


@dataclass(frozen=True, eq=False, repr=False)
class BaseVerdict(Value):
    """Results of a device on one base; dimensionless.

    Attributes:
        contact_stiffness: contact stiffness over axial stiffness.
        restitution: coefficient of restitution; None where the damping is the device's own.
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
    """Numbers of starts and of successes, and the times of these, dimensionless; NaN if none."""

    starts: int
    aligned: int
    tau_best: float
    tau_worst: float


class TiltVerdict(NamedTuple):
    """Results of a device that is held with one tilt, in rad, on all bases; as ``Successes``."""

    tilt: float
    starts: int
    aligned: int
    tau_best: float
    tau_worst: float

    @property
    def reliable(self) -> bool:
        """True if the device succeeds from every start at this tilt."""
        return self.aligned == self.starts


@dataclass(frozen=True, eq=False, repr=False)
class Assessment(Value):
    """Results of a device in every case, dimensionless, and its leeways.

    Attributes:
        starts: number of cases: starts, on each of the bases if bases are tried.
        aligned: number of cases in which the device succeeds.
        tau_best, tau_worst: shortest and longest alignment time of these, NaN without any.
        failing_start: the first case in which the device does not succeed, or None; in SI units
            for a device of a file, with stiffness and restitution of the base if it is not its own.
        contact_force_max, tilt_max: largest value over all cases, the force at any place.
        separations: smallest and largest number of lift-offs over all cases.
        impact_speed: largest closing rate at a touch-down, of the eight cases that lift off most.
        leeways: of the values in ``VARIED`` that are not 0, in SI units for a device of a file;
            empty if a case fails.
        nearest: nearest reliable values of these; empty if no case fails.
        bases: verdicts on the bases; empty if the base is stated.
        forces: largest force over all cases by the place of contact.
        inserted: shortest and longest time until inserted, NaN without any.
        cause: why the failing case fails, in words; empty if none fails.
        change: the first change that makes it reliable, tried: values of one parameter or two, in
            SI units for a device of a file; empty if none was found. Of one parameter it is a step
            (6 %) beyond the nearest reliable value, where that is reliable as well.
        if_square: successes of a square part in its place; None if the shape is stated.
        tilts: verdicts on the gripper's tilts that are tried, its own first; empty if only one is.
        tilt_range: tilts of the gripper at which it succeeds in every other respect; None if only
            one tilt is tried, or it fails at that.
        approaches: verdicts on the approaches that are tried; empty if only one is. The leeways,
            the nearest values and the change are those with ``worst``.
        failing_approach: approach of the failing case, None if it has none of its own.
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
    forces: Mapping[str, float] = field(default_factory=dict)
    inserted: tuple[float, float] = (math.nan, math.nan)
    cause: str = ""
    change: Mapping[str, float] = field(default_factory=dict)
    if_square: Successes | None = None
    tilts: tuple[TiltVerdict, ...] = ()
    tilt_range: Leeway | None = None
    approaches: tuple[ApproachVerdict, ...] = ()
    failing_approach: Approach | None = None

    @property
    def worst(self) -> Approach | None:
        """Approach with which most cases fail, of these the slowest; None if only one is tried."""
        return worst_of(self.approaches)

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
                like_it = [b for b in self.bases if b.restitution == each.restitution]
                limit = like_it[-1] if len(like_it) > 1 else self.bases[-1]
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
        bases: try bases of a device that states one as well; only ``bases`` are then of these.
        vary: seek the leeways, or the nearest reliable values if a case fails.
    """
    device, settings = device_of(device), settings or Settings(scene=INSERTION)
    ensemble = ensemble or Ensemble()
    cases, tried = cases_of(device, ensemble), cases_of(device, ensemble, bases=bases)
    of = device.quantities if isinstance(device, StatedDevice) else device.given()
    own = {"friction": np.array([of["friction"]])}
    found, units = from_every_start(device, own, tried, settings, cores)
    on_all = {name: column[0] for name, column in found.items()}
    results = {name: column[: len(cases)] for name, column in on_all.items()}  # tried first
    goes_in, tau, hops = results["goes_in"], results["tau_align"], results["separations"]
    approaches = with_each_approach(tried, on_all)
    whole, worst = device, worst_of(approaches)
    every, of_worst = cases, [approach_of(case) in (None, worst) for case in cases]
    slowest_first = np.lexsort((-np.nan_to_num(tau + results["tau_inserted"]), goes_in))
    hardest = [without_approach(cases[i]) for i in slowest_first if of_worst[i]]  # fail first
    hopping = [i for i in np.argsort(-hops, kind="stable")[:_HOPPING] if hops[i] > 0]
    runs = [_run_in(device, cases[i], settings) for i in hopping]

    if isinstance(device, StatedDevice):
        device = device.lowered(worst)
        settings = device.run_settings(settings, units[0])
    cases = [without_approach(case) for case, own in zip(cases, of_worst, strict=True) if own]

    def is_reliable(values: Values) -> NDArray[np.bool_]:
        return are_reliable(device, values, hardest, settings, cores)

    def roughly(values: Values) -> NDArray[np.bool_]:
        loose = replace(settings, tolerance=STATISTICAL_TOLERANCE)
        return are_reliable(device, values, hardest, loose, cores)

    def is_late(values: Values) -> NDArray[np.bool_]:
        return are_late(device, values, cases, settings, cores)

    inserted = (tau + results["tau_inserted"])[goes_in]
    result = Assessment(
        *_successes(goes_in, tau),
        failing_start=None,
        contact_force_max=float(np.fmax.reduce(results["contact_force_max"])),
        tilt_max=float(np.fmax.reduce(results["tilt_max"])),
        separations=(int(hops.min()), int(hops.max())),
        impact_speed=max((impact_speed(run) for run in runs), default=0.0),
        bases=_on_each_base(device, tried, on_all["goes_in"], on_all["tau_align"]),
        forces={place: float(np.fmax.reduce(results[name])) for place, name in FORCES.items()},
        inserted=_ends(inserted),
        if_square=_if_square(device, ensemble, settings, cores),
        tilts=_at_each_tilt(every, goes_in, tau),
        approaches=approaches,
    )
    held = _held(device, cases)
    if vary and result.tilts and result.tilts[0].reliable:
        ranged = _tilt_range(device, ensemble, settings, cores)
        result = replace(result, tilt_range=ranged)
    if goes_in.all():
        quicker = roughly if settings.tolerance < STATISTICAL_TOLERANCE else None
        ranges = leeways(device, is_reliable, is_late, held, quicker) if vary else ()
        return replace(result, leeways=ranges)
    failing = every[int(np.argmin(goes_in))]
    failed = _run_in(whole, failing, settings)
    cause = cause_of(failed, settings.shape or "square")
    result = replace(
        result,
        failing_start=stated_case(whole, failing),
        failing_approach=approach_of(failing),
        cause=cause.words,
    )
    if not vary:
        return result
    near = nearest(device, is_reliable, held)
    change = a_step_inside(device, is_reliable, first_change(cause, near))
    change = change or together(device, is_reliable, _PAIRED)
    if change and worst is not None:  # of the other approaches, too
        of_change = {name: np.array([value]) for name, value in change.items()}
        holds = are_reliable(whole, of_change, every, settings, cores)[0]
        change = change if holds else {}
    return replace(result, nearest=near, change=change)


def _run_in(
    device: Parameters | StatedDevice, case: Mapping[str, float], settings: Settings
) -> Trajectory:
    """Return the run of a device in a case, without an estimate of its error."""
    parameters = parameters_in(device, case)
    if isinstance(device, StatedDevice):
        own = device.lowered(approach_of(case))
        settings = own.run_settings(settings, own.units)
    run = simulate_once(parameters, settings)
    return of_device(run, device) if isinstance(device, StatedDevice) else run


def _at_each_tilt(
    cases: Starts, goes_in: NDArray[np.bool_], tau: NDArray[np.float64]
) -> tuple[TiltVerdict, ...]:
    """Return the verdicts on the gripper's tilts of the cases; empty without."""
    tilts = np.array([case.get(GRIPPER_TILT, math.nan) for case in cases])
    return tuple(
        TiltVerdict(tilt, *_successes(goes_in[tilts == tilt], tau[tilts == tilt]))
        for tilt in dict.fromkeys(tilts[~np.isnan(tilts)].tolist())
    )


def _tilt_range(
    device: Parameters | StatedDevice, ensemble: Ensemble, settings: Settings, cores: int
) -> Leeway | None:
    """Return the leeway of the gripper's tilt of a device that is reliable at its own."""
    cases = cases_of(device, ensemble, varied=ADDED)

    def is_reliable(values: Values) -> NDArray[np.bool_]:
        return are_reliable(device, values, cases, settings, cores)

    def is_late(values: Values) -> NDArray[np.bool_]:
        return are_late(device, values, cases, settings, cores)

    return next(iter(leeways(device, is_reliable, is_late, (*UNITS, *VARIED))), None)


def _if_square(
    device: Parameters | StatedDevice, ensemble: Ensemble, settings: Settings, cores: int
) -> Successes | None:
    """Return the successes of a square part in place of one whose shape is not stated."""
    if not isinstance(device, StatedDevice) or device.stated_shape is not None:
        return None
    square = replace(device, stated_shape="square")
    settings = replace(settings, shape="square")
    cases = cases_of(square, ensemble)
    starts = [each for each in cases if math.isnan(each.get("level", math.nan))]
    own = {"friction": np.array([square.quantities["friction"]])}
    results, _ = from_every_start(square, own, starts, settings, cores)
    return _successes(results["goes_in"][0], results["tau_align"][0])


def _held(device: Parameters | StatedDevice, cases: Starts) -> tuple[str, ...]:
    """Return the quantities that the cases replace: those of the base, the gripper's tilt."""
    tilts = tuple(ADDED if GRIPPER_TILT in cases[0] else ())
    if isinstance(device, Parameters) or OF_BASE[0] not in cases[0]:
        return tilts
    own_damping = "contact_damping" in device.quantities
    return ("contact_stiffness", *(() if own_damping else ("contact_damping",)), *tilts)


def _on_each_base(
    device: Parameters | StatedDevice,
    cases: Starts,
    goes_in: NDArray[np.bool_],
    tau: NDArray[np.float64],
) -> tuple[BaseVerdict, ...]:
    """Return the verdicts on the bases of the cases, the device's own first; empty without."""
    if isinstance(device, Parameters) or OF_BASE[0] not in cases[0]:
        return ()
    one = Batch.stack([device.parameters])
    found = on_bases(one, [device.units], cases, device.shape, device.fixture)
    stiffness = found["contact_stiffness"][0]
    keys = [tuple(str(case[name]) for name in OF_BASE) for case in cases]
    verdicts = []
    for key in dict.fromkeys(keys):
        rows = np.array([each == key for each in keys])
        first = int(np.argmax(rows))
        impact = cases[first]["restitution"]
        verdicts.append(
            BaseVerdict(
                float(stiffness[first]),
                None if math.isnan(impact) else impact,
                *_successes(goes_in[rows], tau[rows]),
            )
        )
    return tuple(verdicts)


def _successes(goes_in: NDArray[np.bool_], tau: NDArray[np.float64]) -> Successes:
    return Successes(goes_in.size, int(goes_in.sum()), *_ends(tau[goes_in]))


def _ends(values: NDArray[np.float64]) -> tuple[float, float]:
    """Return the smallest and the largest value, NaN without any."""
    return (float(values.min()), float(values.max())) if values.size else (math.nan, math.nan)


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
    return float(max([0.0, *rates]))
