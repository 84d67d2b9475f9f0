"""Verdicts on a device: what it does in the cases of one approach, base or gripper's tilt."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.events.outcomes import Reason
from model.physics.parameters import Batch
from model.sweeps.starts import Starts
from vibralign.answers.cases import OF_BASE, on_bases
from vibralign.device import StatedDevice


class Base(NamedTuple):
    """Base that is tried.

    Attributes:
        contact_stiffness: contact stiffness over axial stiffness.
        restitution: coefficient of restitution; None where the damping is the device's own.
        own: True for the base that a single run of the device takes.
    """

    contact_stiffness: float
    restitution: float | None
    own: bool = False


class Verdict(NamedTuple):
    """Results of a device in some cases; dimensionless.

    Attributes:
        of: what the cases have in common: an ``Approach``, a ``Base``, a gripper's tilt in rad.
        starts: number of cases.
        aligned: number of cases in which the device succeeds.
        tau_best, tau_worst: shortest and longest alignment time of these, NaN without any.
        force_least, force_most: smallest and largest of the largest contact forces on the bases.
        by_press: number of cases in which the press alone brings it in.
    """

    of: Any
    starts: int
    aligned: int
    tau_best: float
    tau_worst: float
    force_least: float = math.nan
    force_most: float = math.nan
    by_press: int = 0

    @property
    def reliable(self) -> bool:
        """True if the device succeeds in all of these cases."""
        return self.aligned == self.starts

    @property
    def times(self) -> tuple[float, float]:
        """Shortest and longest alignment time."""
        return self.tau_best, self.tau_worst


def verdicts_on(
    each_of: Sequence[Any], cases: Starts, results: Mapping[str, NDArray[Any]]
) -> tuple[Verdict, ...]:
    """Return a verdict on each approach, base or tilt that cases have in common.

    ``each_of`` has that of each case, or None: such a case counts in no verdict. ``results`` are
    those of one device by name, each of shape (cases,).
    """
    bases = np.array([str([case.get(name) for name in OF_BASE]) for case in cases])
    verdicts = []
    for of in dict.fromkeys(each for each in each_of if each is not None):
        own = np.array([each == of for each in each_of])
        goes_in, force = results["goes_in"] & own, results["contact_force_max"]
        forces = [
            float(np.fmax.reduce(force[own & (bases == b)])) for b in dict.fromkeys(bases[own])
        ]
        by_press = int((results["reason"][own] == Reason.BY_PRESS).sum())
        times, ends = ends_of(results["tau_align"][goes_in]), (min(forces), max(forces))
        verdicts.append(Verdict(of, int(own.sum()), int(goes_in.sum()), *times, *ends, by_press))
    return tuple(verdicts)


def bases_in(device: StatedDevice, cases: Starts) -> list[Base | None]:
    """Return the base of each case; None of cases without."""
    if OF_BASE[0] not in cases[0]:
        return [None] * len(cases)
    one = Batch.stack([device.parameters])
    found = on_bases(one, [device.units], cases, device.shape, device.fixture)
    bases = list[Base | None]()
    for case, stiffness in zip(cases, found["contact_stiffness"][0].tolist(), strict=True):
        impact = None if math.isnan(case["restitution"]) else case["restitution"]
        bases.append(Base(stiffness, impact, math.isnan(case["level"])))
    return bases


def ends_of(values: NDArray[np.float64]) -> tuple[float, float]:
    """Return the smallest and the largest value, NaN without any."""
    return (float(values.min()), float(values.max())) if values.size else (math.nan, math.nan)
