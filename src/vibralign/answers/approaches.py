"""Verdicts on the approaches of a device, and the worst of them."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.events.outcomes import Reason
from model.runs.settings import Settings
from model.sweeps.settings import Ensemble
from model.sweeps.starts import Starts
from vibralign.answers.cases import OF_BASE, approach_of, cases_of
from vibralign.answers.reliability import from_every_start
from vibralign.device import StatedDevice
from vibralign.device.approach import Approach


class ApproachVerdict(NamedTuple):
    """Results of a device that is lowered in one way, at all tilts and on all bases; dimensionless.

    ``tau_best`` and ``tau_worst`` are the shortest and longest alignment time, NaN without any.
    ``force_least`` and ``force_most`` are the smallest and largest of its largest contact forces on
    the bases; ``by_press`` counts the cases in which the press alone brings it in.
    """

    approach: Approach
    starts: int
    aligned: int
    tau_best: float
    tau_worst: float
    force_least: float
    force_most: float
    by_press: int

    @property
    def reliable(self) -> bool:
        """True if the device succeeds in every case with this approach."""
        return self.aligned == self.starts


def worst_of(verdicts: Sequence[ApproachVerdict]) -> Approach | None:
    """Return the approach with which most cases fail, of these the slowest; None of none."""

    def rank(each: ApproachVerdict) -> tuple[float, float]:
        return each.aligned / each.starts, -float(np.nan_to_num(each.tau_worst))

    return min(verdicts, key=rank).approach if verdicts else None


def with_each_approach(
    cases: Starts, results: Mapping[str, NDArray[Any]]
) -> tuple[ApproachVerdict, ...]:
    """Return the verdicts on the approaches of the cases; empty if the cases have none.

    ``results`` are those of one device by name, each of shape (cases,).
    """
    keys = [approach_of(case) for case in cases]
    bases = [str([case.get(name) for name in OF_BASE]) for case in cases]
    verdicts = []
    for approach in dict.fromkeys(keys):
        if approach is None:
            continue
        own = np.array([each == approach for each in keys])
        goes_in, force = results["goes_in"] & own, results["contact_force_max"]
        times = results["tau_align"][goes_in]
        on_base = [
            float(np.fmax.reduce(force[own & np.array([each == base for each in bases])]))
            for base in dict.fromkeys(bases)
        ]
        verdicts.append(
            ApproachVerdict(
                approach,
                int(own.sum()),
                int(goes_in.sum()),
                float(times.min(initial=np.inf)) if times.size else np.nan,
                float(times.max(initial=-np.inf)) if times.size else np.nan,
                min(on_base),
                max(on_base),
                int((results["reason"][own] == Reason.BY_PRESS).sum()),
            )
        )
    return tuple(verdicts)


def in_worst_approach(
    device: StatedDevice, settings: Settings, ensemble: Ensemble, cores: int = 1
) -> StatedDevice:
    """Return a device with the worst of its approaches, as a first look at its own values finds it.

    The look takes the base of a single run, and every start.
    """
    cases = cases_of(device, ensemble)
    cases = [case for case in cases if np.isnan(case.get(OF_BASE[0], np.nan))]
    if len(device.approaches()) < 2:
        return device.lowered()
    own = {"friction": np.array([device.quantities["friction"]])}
    found, _ = from_every_start(device, own, cases, settings, cores)
    verdicts = with_each_approach(cases, {name: column[0] for name, column in found.items()})
    return device.lowered(worst_of(verdicts))
