"""One trajectory, with its whole course."""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.engines.record import Ending
from model.engines.scalar.loop import TRACK_COLUMNS
from model.events.outcomes import OUTCOME_TEXT, REASON_TEXT, Outcome, Reason, remedy
from model.physics.parameters import Batch, Parameters
from model.runs.align import each_by_itself
from model.runs.errors import Array, estimate
from model.runs.settings import Settings, settings_with

_USUAL_TRACK = 4096  # rows; a longer trajectory is run again with as many as it has


@dataclass(frozen=True)
class Trajectory:
    """One run; dimensionless, tilts in radians.

    ``time`` has shape (n,), ``state`` (n, 6) in the order of ``State``, ``contact_force`` and
    ``side_force`` (n,): the normal force under the part and that of A2 on its side face. Where a
    force jumps, the same time stands twice. An aligned run is followed until the corners are
    inside. The other attributes are those of ``Alignments``, for one run.
    """

    parameters: Parameters
    time: NDArray[np.float64]
    state: NDArray[np.float64]
    contact_force: NDArray[np.float64]
    side_force: NDArray[np.float64]
    outcome: Outcome
    reason: Reason
    tau_align: float
    tau_error: float
    tau_corners_inside: float
    sensitive: bool
    tilt_at_alignment: float
    tilt_max: float
    separations: int
    contact_force_max: float
    sticking_share: float
    rhs_evaluations: int
    steps: int
    switches: int
    period: int

    @property
    def message(self) -> str:
        """What happened, in words."""
        why = REASON_TEXT[self.reason]
        return f"{OUTCOME_TEXT[self.outcome]}{': ' + why if why else ''}"

    @property
    def remedy(self) -> str:
        """What to do about it, in words."""
        return remedy(self.outcome, self.reason)


def simulate(
    parameters: Parameters, settings: Settings | None = None, **changes: Any
) -> Trajectory:
    """Run one parameter set and keep its course.

    Args:
        parameters: the device, its excitation and its start.
        settings: how to run.
        **changes: fields of ``Settings`` by name, over those of ``settings`` (``horizon=100``).

    Raises:
        ValueError: a setting outside its range.
    """
    settings = settings_with(settings, changes)
    rows = Batch.stack([parameters]).constants(settings.readings)

    found = estimate(each_by_itself(settings), rows, settings.tolerance)
    followed = _followed(parameters, settings, found.tolerance)
    return replace(
        followed,
        reason=Reason(int(found.column("reason")[0])),
        tau_error=float(found.tau_error[0]),
        sensitive=bool(found.sensitive[0]),
        rhs_evaluations=int(found.rhs_evaluations[0]),
    )


def simulate_once(parameters: Parameters, settings: Settings) -> Trajectory:
    """Run as ``simulate`` does, without an estimate of the error.

    A third of the cost, for statistics over many sets; ``tau_error`` is NaN.
    """
    return _followed(parameters, settings, np.array([settings.tolerance]))


def _followed(parameters: Parameters, settings: Settings, tolerances: Array) -> Trajectory:
    """One run at a tolerance, shape (1,), with its course."""
    rows = Batch.stack([parameters]).constants(settings.readings)

    def run(track: Array) -> Ending:
        return Ending(*each_by_itself(settings, track)(rows, tolerances)[0].tolist())

    track = np.empty((_USUAL_TRACK, TRACK_COLUMNS))
    ending = run(track)
    if ending.tracked > len(track):
        track = np.empty((int(ending.tracked), TRACK_COLUMNS))
        ending = run(track)
    track = track[: int(ending.tracked)].copy()
    return Trajectory(
        parameters=parameters,
        time=track[:, 0],
        state=track[:, 1:7],
        contact_force=track[:, 7],
        side_force=track[:, 8],
        outcome=Outcome(int(ending.outcome)),
        reason=Reason(int(ending.reason)),
        tau_align=ending.tau_align,
        tau_error=math.nan,
        tau_corners_inside=ending.tau_corners_inside,
        sensitive=False,
        tilt_at_alignment=ending.tilt_at_alignment,
        tilt_max=ending.tilt_max,
        separations=int(ending.separations),
        contact_force_max=ending.contact_force_max,
        sticking_share=ending.sticking_share,
        rhs_evaluations=int(ending.rhs_evaluations),
        steps=int(ending.steps),
        switches=int(ending.switches),
        period=int(ending.period),
    )
