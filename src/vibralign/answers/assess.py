"""Assess a device: success in every case, leeways of its parameters, and why it fails.

Phase and tilt at touch-down cannot be controlled, and a base that is not stated is not known: a
*reliable* device succeeds from every start, on every base that is tried (cases.py). Success is to
align in the alignment scene, and to go in in the insertion scene.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.physics.tables import Value
from model.physics.units import UNITS
from model.runs.settings import Settings
from model.runs.simulate import Trajectory, simulate_once
from model.runs.unvibrated import unvibrated_words
from model.sweeps.settings import Ensemble
from model.sweeps.starts import Starts
from vibralign.answers.approaches import worst_of
from vibralign.answers.cases import (
    OF_BASE,
    approach_of,
    cases_of,
    parameters_in,
    stated_case,
    without_approach,
)
from vibralign.answers.causes import Cause, cause_of, first_change
from vibralign.answers.leeways import (
    ADDED,
    VARIED,
    Leeway,
    Nearest,
    a_step_inside,
    leeways,
    nearest,
)
from vibralign.answers.reliability import (
    FORCES,
    STATISTICAL_TOLERANCE,
    are_late,
    are_reliable,
    as_stated,
    from_every_start,
)
from vibralign.answers.sheet import sheet_rows
from vibralign.answers.verdicts import Verdict, bases_in, ends_of, verdicts_on
from vibralign.device import StatedDevice
from vibralign.device.approach import Approach
from vibralign.device.batches import Values
from vibralign.device.limits import of_vibrator
from vibralign.device.mouth import GRIPPER_TILT
from vibralign.device.runs import AnyDevice, of_device, settings_for, stated_of


@dataclass(frozen=True, eq=False, repr=False)
class Assessment(Value):
    """Results of a device in every case, dimensionless, and its leeways in SI units.

    Attributes:
        device: the device.
        starts: number of cases: starts, on each of the bases if bases are tried.
        aligned: number of cases in which the device succeeds.
        tau_best, tau_worst: shortest and longest alignment time of these, NaN without any.
        failing_start: the first case in which the device does not succeed, or None; in SI units,
            with stiffness and restitution of a base that is not the device's.
        contact_force_max, tilt_max: largest value over all cases, the force at any place.
        separations: smallest and largest number of lift-offs over all cases.
        leeways: of the values in ``VARIED`` that are not 0, in SI units; empty if a case fails.
        nearest: nearest reliable values of these; empty if no case fails.
        bases: verdicts on the bases; empty if the base is stated.
        forces: largest force over all cases by the place of contact.
        inserted: shortest and longest time until inserted, NaN without any.
        cause: why the failing case fails, in words; empty if none fails.
        change: the first change that makes it reliable, tried: the value of one parameter, in SI
            units; empty if none was found. It goes a step (6 %) beyond the nearest reliable value,
            if that is reliable as well. It keeps the limits of the file, if any change tried does.
        change_exceeds: names of the limits that the change exceeds; empty if one tried keeps all.
        tilts: verdicts on the gripper's tilts that are tried, its own first; empty if only one is.
        tilt_range: range of the gripper's tilt in which it succeeds in all other cases; None if
            only one tilt is tried, or the device fails at its own.
        approaches: verdicts on the approaches that are tried; empty if only one is. The leeways,
            the nearest values and the change are those with ``worst``.
        failing_approach: approach of the failing case, None if it has none of its own.
        settings: settings of its runs.
        unvibrated: how it ends if it is only pressed, in words.
    """

    device: StatedDevice
    starts: int
    aligned: int
    tau_best: float
    tau_worst: float
    failing_start: Mapping[str, float] | None
    contact_force_max: float = math.nan
    tilt_max: float = math.nan
    separations: tuple[int, int] = (0, 0)
    leeways: tuple[Leeway, ...] = ()
    nearest: tuple[Nearest, ...] = ()
    bases: tuple[Verdict, ...] = ()
    forces: Mapping[str, float] = field(default_factory=dict)
    inserted: tuple[float, float] = (math.nan, math.nan)
    cause: str = ""
    change: Mapping[str, float] = field(default_factory=dict)
    change_exceeds: tuple[str, ...] = ()
    tilts: tuple[Verdict, ...] = ()
    tilt_range: Leeway | None = None
    approaches: tuple[Verdict, ...] = ()
    failing_approach: Approach | None = None
    settings: Settings | None = None
    unvibrated: str = ""

    @property
    def times(self) -> tuple[float, float]:
        """Shortest and longest alignment time."""
        return self.tau_best, self.tau_worst

    @property
    def worst(self) -> Approach | None:
        """Approach with which most cases fail (the slowest of several); None if one is tried."""
        return worst_of(self.approaches)

    def __str__(self) -> str:
        return "\n".join(f"{label:<16}{words}" for label, words in sheet_rows(self))

    def _shown(self) -> dict[str, Any]:
        """Return the rows of the sheet."""
        return dict(sheet_rows(self))

    def __repr__(self) -> str:
        words = "reliable" if self.reliable else "not reliable"
        words = "depends on the base" if self.depends_on_base else words
        return f"<Assessment: {words}, goes in from {self.aligned} of {self.starts} starts>"

    @property
    def reliable(self) -> bool:
        """True if the device succeeds from every start, on every base that was tried."""
        return self.failing_start is None

    @property
    def depends_on_base(self) -> bool:
        """True if the device is reliable on some of the bases and not on others."""
        return len({each.reliable for each in self.bases}) > 1


@dataclass(frozen=True)
class _Asked:
    """Questions on devices with other values, in the same cases; the failing ones stand first.

    ``failures`` counts by case the devices that failed, shape (cases,): these cases come first.
    """

    device: StatedDevice
    cases: Starts
    settings: Settings
    cores: int
    failures: NDArray[np.int64]
    limits: Mapping[str, float] = field(default_factory=dict)
    also: "_Asked | None" = None  # further cases in which the devices have to be reliable

    @classmethod
    def of(cls, device: StatedDevice, cases: Starts, settings: Settings, cores: int) -> "_Asked":
        return cls(device, cases, settings, cores, np.zeros(len(cases), np.int64))

    def reliable(self, values: Values) -> NDArray[np.bool_]:
        found = are_reliable(
            self.device, values, self.cases, self.settings, self.cores, self.limits, self.failures
        )
        if self.also is not None and found.any():
            found[found] = self.also.reliable({n: column[found] for n, column in values.items()})
        return found

    def within(self, limits: Mapping[str, float]) -> "_Asked":
        return replace(self, limits=limits, also=self.also and self.also.within(limits))

    def roughly(self, values: Values) -> NDArray[np.bool_]:
        loose = replace(self.settings, tolerance=STATISTICAL_TOLERANCE)
        return are_reliable(self.device, values, self.cases, loose, self.cores)

    def late(self, values: Values) -> NDArray[np.bool_]:
        return are_late(self.device, values, self.cases, self.settings, self.cores)


def assess(
    device: AnyDevice,
    settings: Settings | None = None,
    ensemble: Ensemble | None = None,
    cores: int = 1,
    *,
    vary: bool = True,
) -> Assessment:
    """Assess a device by some thousand runs.

    Args:
        device: of a file, as ``simulate`` takes it.
        settings: settings of the runs; None for the defaults, in the insertion scene.
        ensemble: the starts; None for those of the study.
        cores: number of threads.
        vary: seek the leeways, or the nearest reliable values if a case fails.

    Raises:
        TypeError: a dimensionless device.
    """
    device = stated_of(device)
    settings, ensemble = settings_for(device, settings), ensemble or Ensemble()
    cases = cases_of(device, ensemble)
    found, units = from_every_start(device, as_stated(device), cases, settings, cores)
    results = {name: column[0] for name, column in found.items()}
    goes_in, tau, hops = results["goes_in"], results["tau_align"], results["separations"]
    tilts = [case.get(GRIPPER_TILT) for case in cases]
    settings = device.run_settings(settings, units[0])
    result = Assessment(
        device,
        len(cases),
        int(goes_in.sum()),
        *ends_of(tau[goes_in]),
        failing_start=None,
        contact_force_max=float(np.fmax.reduce(results["contact_force_max"])),
        tilt_max=float(np.fmax.reduce(results["tilt_max"])),
        separations=(int(hops.min()), int(hops.max())),
        bases=verdicts_on(bases_in(device, cases), cases, results),
        forces={place: float(np.fmax.reduce(results[name])) for place, name in FORCES.items()},
        inserted=ends_of((tau + results["tau_inserted"])[goes_in]),
        tilts=verdicts_on(tilts, cases, results),
        approaches=verdicts_on([*map(approach_of, cases)], cases, results),
        settings=settings,
        unvibrated=unvibrated_words(device.parameters, settings),
    )
    lowered = device.lowered(result.worst)
    own = lowered.run_settings(settings, units[0])
    failing = None if goes_in.all() else cases[int(np.argmin(goes_in))]
    cause = None
    if failing is not None:
        cause = cause_of(_run_in(device, failing, own), own.shape or "square")
        result = replace(
            result,
            failing_start=stated_case(device, failing),
            failing_approach=approach_of(failing),
            cause=cause.words,
        )
    slowest_first = np.lexsort((-np.nan_to_num(tau + results["tau_inserted"]), goes_in))
    of_worst = [approach_of(case) in (None, result.worst) for case in cases]
    hardest = [cases[i] for i in slowest_first if of_worst[i]]
    if not vary:
        return result
    asked = _Asked.of(lowered, [without_approach(case) for case in hardest], own, cores)
    if result.tilts and result.tilts[0].reliable:
        at_tilts = _Asked.of(lowered, cases_of(lowered, ensemble, varied=ADDED), own, cores)
        of_tilt = leeways(lowered, at_tilts.reliable, at_tilts.late, (*UNITS, *VARIED))
        result = replace(result, tilt_range=next(iter(of_tilt), None))
    held = _held(lowered, cases)
    if cause is None:
        quicker = asked.roughly if own.tolerance < STATISTICAL_TOLERANCE else None
        return replace(result, leeways=leeways(lowered, asked.reliable, asked.late, held, quicker))
    if not all(of_worst):
        others = [cases[i] for i in slowest_first if not of_worst[i]]
        asked = replace(asked, also=_Asked.of(device, others, own, cores))
    limits, beyond = _limits_of(lowered), tuple[str, ...]()
    near, change = _advice(cause, asked.within(limits), held)
    if limits and not change:
        near, change = _advice(cause, asked, held)
        of_change = {name: np.array([value]) for name, value in change.items()}
        beyond = tuple(
            name
            for name, limit in limits.items()
            if change and not asked.within({name: limit}).reliable(of_change)[0]
        )
    return replace(result, nearest=near, change=change, change_exceeds=beyond)


def _advice(
    cause: Cause, asked: _Asked, held: tuple[str, ...]
) -> tuple[tuple[Nearest, ...], Mapping[str, float]]:
    """Return the nearest reliable values, and the first change that makes a device reliable."""
    if asked.also is None:
        near = nearest(asked.device, asked.reliable, held)
    else:  # the cases of the other approaches only where those of the worst succeed
        own = replace(asked, also=None)
        near = nearest(asked.device, asked.also.reliable, held, own.reliable)
    return near, a_step_inside(asked.device, asked.reliable, first_change(cause, near))


def _limits_of(device: StatedDevice) -> dict[str, float]:
    """Return the limits that advice keeps, a vibrator's raised to what the device needs now."""
    needs = of_vibrator(device.units.amplitude, device.quantities["frequency"])
    limits = {n: max(limit, needs.get(n, 0.0)) for n, limit in device.limits.items()}
    return {name: limit for name, limit in limits.items() if name != "vibration"}


def _run_in(device: StatedDevice, case: Mapping[str, float], settings: Settings) -> Trajectory:
    """Return the run of a device in a case, without an estimate of its error."""
    own = device.lowered(approach_of(case))
    run = simulate_once(parameters_in(device, case), own.run_settings(settings, own.units))
    return of_device(run, device)


def _held(device: StatedDevice, cases: Starts) -> tuple[str, ...]:
    """Return the quantities that the cases replace: those of the base, the gripper's tilt."""
    tilts = tuple(ADDED if GRIPPER_TILT in cases[0] else ())
    if OF_BASE[0] not in cases[0]:
        return tilts
    own_damping = "contact_damping" in device.quantities
    return ("contact_stiffness", *(() if own_damping else ("contact_damping",)), *tilts)
