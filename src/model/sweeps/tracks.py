"""Quantities of trajectories that claims on displacement and rest read."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.events.outcomes import Outcome
from model.physics.parameters import Batch
from model.runs.settings import Settings
from model.runs.simulate import Trajectory, simulate_once
from model.runs.unvibrated import unvibrated_sets

Column = NDArray[np.float64]

TRACK_QUANTITIES: Mapping[str, dict[str, Any]] = {
    "tilt_end": {
        "units": "radian",
        "long_name": "tilt at the end, mean over the last excitation period",
        "symbol": "φ",
    },
    "way": {
        "units": "1",
        "long_name": "share of the way to the slot that the edge has slid along the bottom face at "
        "the end, mean over the last excitation period",
    },
    "unvibrated_way": {
        "units": "1",
        "long_name": "share of the way to the slot that the press alone moves the edge, as above",
    },
    "excursion": {
        "units": "1",
        "long_name": "largest distance of x from its start until alignment",
    },
    "tilt_min": {
        "units": "radian",
        "long_name": "least tilt until alignment, from where it first reaches its rest without "
        "vibration; NaN without a rest, or where it does not reach it",
        "symbol": "φ",
    },
    "side_force_max": {
        "units": "1",
        "long_name": "largest force of A2 on the side face until alignment",
    },
}
_STATIC = 1.0  # time over which the end is averaged without an excitation


def quantities_of(
    tracks: Sequence[Trajectory], batch: Batch, rests: Column, settings: Settings
) -> dict[str, Column]:
    """Return ``TRACK_QUANTITIES`` of the trajectories of a batch, each of shape (n,).

    ``rests``, shape (n,), are the tilts in which the runs rest without vibration, NaN without one.
    """
    rows = [_of_track(*each) for each in zip(tracks, rests, strict=True)]
    columns = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    return {**columns, "unvibrated_way": _ways(unvibrated_sets(batch), settings)}


def _ways(batch: Batch, settings: Settings) -> Column:
    """Return ``way`` of the runs of ``batch``, shape (n,); equal sets are run once."""
    _, first, which = np.unique(
        batch.constants(settings.readings), axis=0, return_index=True, return_inverse=True
    )
    ways = [_of_track(simulate_once(batch[row], settings), np.nan)["way"] for row in first]
    return np.array(ways)[which.reshape(-1)]


def _of_track(track: Trajectory, rest: float) -> dict[str, float]:
    """Return ``TRACK_QUANTITIES`` of a trajectory, but for that of the unvibrated run.

    ``rest`` is the tilt in which that run rests, NaN without one.
    """
    aligned = track.outcome == Outcome.ALIGNED
    until = track.time <= (track.tau_align if aligned else np.inf)
    time, state = track.time[until], track.state[until]
    x, y, tilt = state[:, 0], state[:, 1], state[:, 2]
    device = track.parameters
    arm = (device.slot_half_width - x) * np.cos(tilt) - y * np.sin(tilt)
    # s in the paper's frame: the edge is at s on the bottom face and leaves it at s = a.
    slid = (arm - arm[0]) / (device.half_width - arm[0])
    period = 2.0 * np.pi / device.frequency if device.frequency > 0.0 else _STATIC
    last = time >= time[-1] - period
    later = np.logical_or.accumulate(tilt >= rest)
    return {
        "tilt_end": _mean(time[last], tilt[last]),
        "way": 1.0 if aligned else _mean(time[last], slid[last]),
        "excursion": float(np.abs(x - x[0]).max()),
        "tilt_min": float(tilt[later].min()) if later.any() else np.nan,
        "side_force_max": float(track.side_force[until].max()),
    }


def _mean(time: NDArray[np.float64], values: NDArray[np.float64]) -> float:
    """Return the mean over time of values at unevenly spaced times."""
    length = float(time[-1] - time[0])
    if length <= 0.0:
        return float(values[-1])
    return float(np.trapezoid(values, time) / length)
