"""One trajectory, with its whole course."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.physics.parameters import Batch, Parameters
from model.runs.errors import COLUMNS, NO_TRACK, Record, run_rows
from model.runs.settings import Settings
from model.solver.loop import TRACK_COLUMNS
from model.solver.outcomes import OUTCOME_TEXT, REASON_TEXT, Outcome, Reason, remedy

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
    settings = replace(settings or Settings(), **changes)
    rows = Batch.stack([parameters]).constants(settings.readings)
    out = np.empty((1, len(COLUMNS)))

    def run(track: NDArray[np.float64]) -> Record:
        run_rows(rows, *settings.for_kernels, track, NO_TRACK, out)
        return Record(*out[0].tolist())

    track = np.empty((_USUAL_TRACK, TRACK_COLUMNS))
    record = run(track)
    if record.tracked > len(track):
        track = np.empty((int(record.tracked), TRACK_COLUMNS))
        record = run(track)
    track = track[: int(record.tracked)].copy()
    return Trajectory(
        parameters=parameters,
        time=track[:, 0],
        state=track[:, 1:7],
        contact_force=track[:, 7],
        side_force=track[:, 8],
        outcome=Outcome(int(record.outcome)),
        reason=Reason(int(record.reason)),
        tau_align=record.tau_align,
        tau_error=record.tau_error,
        tau_corners_inside=record.tau_corners_inside,
        sensitive=bool(record.sensitive),
        tilt_at_alignment=record.tilt_at_alignment,
        tilt_max=record.tilt_max,
        separations=int(record.separations),
        contact_force_max=record.contact_force_max,
        sticking_share=record.sticking_share,
        rhs_evaluations=int(record.rhs_evaluations),
        steps=int(record.steps),
        switches=int(record.switches),
        period=int(record.period),
    )
