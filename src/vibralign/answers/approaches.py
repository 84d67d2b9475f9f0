"""Verdicts on the approaches of a device, and the worst of them."""

from collections.abc import Sequence

import numpy as np

from model.runs.settings import Settings
from model.sweeps.settings import Ensemble
from vibralign.answers.cases import OF_BASE, approach_of, cases_of
from vibralign.answers.reliability import as_stated, from_every_start
from vibralign.answers.verdicts import Verdict, verdicts_on
from vibralign.device import StatedDevice
from vibralign.device.approach import Approach


def worst_of(verdicts: Sequence[Verdict]) -> Approach | None:
    """Return the approach with which most cases fail, the slowest of several; None without one."""

    def rank(each: Verdict) -> tuple[float, float]:
        return each.aligned / each.starts, -float(np.nan_to_num(each.tau_worst))

    return min(verdicts, key=rank).of if verdicts else None


def in_worst_approach(
    device: StatedDevice, settings: Settings, ensemble: Ensemble, cores: int = 1
) -> StatedDevice:
    """Return a device with the worst of its approaches stated.

    It is found at the device's own values, from every start, on the base of a single run; at the
    largest misalignment within the tolerances if the device needs no alignment at its own.
    """
    if len(device.approaches()) < 2:
        return device.lowered()
    cases = [case for case in cases_of(device, ensemble) if np.isnan(case.get(OF_BASE[0], np.nan))]
    values, tolerance = as_stated(device), device.tolerances.get("misalignment")
    if device.needless and tolerance is not None:
        own = device.quantities["misalignment"]
        values = {"misalignment": np.array([own + tolerance.end(own)])}
    found, _ = from_every_start(device, values, cases, settings, cores)
    results = {name: column[0] for name, column in found.items()}
    return device.lowered(worst_of(verdicts_on([*map(approach_of, cases)], cases, results)))
