"""Limits that a device file states: does the device keep them, and do all within its tolerances?"""

import math
from dataclasses import dataclass

from model.runs.settings import Settings
from vibralign.answers.assess import Assessment
from vibralign.answers.reliability import as_stated, need_vibration
from vibralign.answers.yields import Yield
from vibralign.device import StatedDevice
from vibralign.device.limits import of_vibrator


@dataclass(frozen=True)
class LimitResult:
    """Numbers of a device that a limit bounds; SI units.

    Attributes:
        name: name of the limit.
        limit: largest admissible value; of "vibration" the only admissible share.
        itself: largest value over all starts at the stated values; NaN if none goes in.
        drawn: largest value over all devices drawn, NaN if none goes in; None without tolerances.
    """

    name: str
    limit: float
    itself: float
    drawn: float | None

    @property
    def exceeding(self) -> float | None:
        """The value that exceeds the limit, at the stated values first; None if it is kept."""
        values = [self.itself, *([] if self.drawn is None else [self.drawn])]
        return next((value for value in values if self._is_exceeded_by(value)), None)

    @property
    def only_drawn(self) -> bool:
        """True if the limit is kept at the stated values, and not within the tolerances."""
        return self.exceeding is not None and not self._is_exceeded_by(self.itself)

    def _is_exceeded_by(self, value: float) -> bool:
        if self.name == "vibration":
            return not math.isnan(value) and value != self.limit
        return value > self.limit


def limit_results(
    stated: StatedDevice,
    assessed: Assessment | None,
    drawn: Yield | None,
    settings: Settings,
) -> tuple[LimitResult, ...]:
    """Return the results of every limit of the file, in its order.

    ``assessed`` is None for a device that needs no alignment at its stated values.
    """
    if not stated.limits:
        return ()
    assessed = assessed or Assessment(stated, 0, 0, math.nan, math.nan, failing_start=None)
    units = stated.units
    itself = {
        "time": units.time * assessed.tau_worst,
        "contact_force": units.force * assessed.contact_force_max,
        "tilt": assessed.tilt_max,
        **of_vibrator(units.amplitude, stated.quantities["frequency"]),
    }
    if "vibration" in stated.limits:
        needs = not stated.needless and need_vibration(stated, as_stated(stated), settings)[0]
        itself["vibration"] = float(needs)

    def largest(name: str) -> float | None:
        return None if drawn is None else drawn.largest.get(name, math.nan)

    return tuple(
        LimitResult(name, limit, itself[name], largest(name))
        for name, limit in stated.limits.items()
    )
