"""Sweeps made for the claims alone: starts, frictions and rests that the figures lack.

Their datasets are those of curves, with ``COURSE_VARIABLES``: quantities of each trajectory that
claims on displacement and rest read.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from model.events.outcomes import Outcome
from model.physics.parameters import Batch
from model.runs.simulate import Trajectory, simulate
from model.study.datasets import compute_chunk, merge_chunks
from model.study.sweeps import Sweep

COURSE_VARIABLES: dict[str, dict[str, Any]] = {
    "tilt_end": {
        "long_name": "tilt at the end, mean over the last excitation period",
        "units": "rad",
        "symbol": "φ",
    },
    "way": {
        "long_name": "share of the way to the slot that the edge has slid along the bottom face at "
        "the end, mean over the last excitation period"
    },
    "excursion": {"long_name": "largest distance of x from its start until alignment"},
    "side_force_max": {"long_name": "largest force of A2 on the side face until alignment"},
}
_STATIC = 1.0  # time over which the end is averaged where nothing is excited


def claim_run_dataset(sweep: Sweep, title: str) -> xr.Dataset:
    """Return the dataset of a sweep: that of curves, and ``COURSE_VARIABLES``."""
    size = int(np.prod(sweep.shape))
    dataset = merge_chunks(sweep, title, title, [compute_chunk(sweep, 0, 1)])
    batch: Batch = sweep.batch(np.arange(size))
    settings = sweep.settings.settings
    added = course_variables(sweep, [simulate(batch[row], settings) for row in range(size)])
    return dataset.assign(added)


def course_variables(sweep: Sweep, runs: Sequence[Trajectory]) -> dict[str, tuple[Any, ...]]:
    """Return ``COURSE_VARIABLES`` of a sweep's trajectories, as variables over its dimensions."""
    names = [dimension.parameter for dimension in sweep.dimensions]
    values = [_course_values(run) for run in runs]
    return {
        name: (
            names,
            np.array([each[name] for each in values]).reshape(sweep.shape),
            {"units": "1", **known},
        )
        for name, known in COURSE_VARIABLES.items()
    }


def _course_values(run: Trajectory) -> dict[str, float]:
    aligned = run.outcome == Outcome.ALIGNED
    until = run.time <= (run.tau_align if aligned else np.inf)
    time, state = run.time[until], run.state[until]
    x, y, tilt = state[:, 0], state[:, 1], state[:, 2]
    device = run.parameters
    arm = (device.slot_half_width - x) * np.cos(tilt) - y * np.sin(tilt)
    # s in the paper's frame: the edge is at s on the bottom face and leaves it at s = a.
    slid = (arm - arm[0]) / (device.half_width - arm[0])
    period = 2.0 * np.pi / device.frequency if device.frequency > 0.0 else _STATIC
    last = time >= time[-1] - period
    return {
        "tilt_end": _mean(time[last], tilt[last]),
        "way": 1.0 if aligned else _mean(time[last], slid[last]),
        "excursion": float(np.abs(x - x[0]).max()),
        "side_force_max": float(run.side_force[until].max()),
    }


def _mean(time: NDArray[np.float64], values: NDArray[np.float64]) -> float:
    """Mean over time of values at uneven moments."""
    length = float(time[-1] - time[0])
    if length <= 0.0:
        return float(values[-1])
    return float(np.trapezoid(values, time) / length)
