"""Simulation of one parameter set, with its whole trajectory."""

import math
from collections.abc import Mapping
from dataclasses import field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.engine.results import (
    RESULTS,
    TRACK_VARIABLES,
    VALUE_TYPES,
    Results,
    results_table,
)
from model.events.outcomes import OUTCOME_TEXT, REASON_TEXT, Outcome, Reason, remedy
from model.physics.notation import STATE_SIZE
from model.physics.parameters import Batch, Parameters
from model.physics.tables import described
from model.physics.units import Units
from model.runs.engine import Array, engine_for, run_tracked
from model.runs.errors import estimate
from model.runs.settings import Settings, settings_with


@results_table
class Trajectory(Results[Outcome, Reason, float, int, bool]):
    """Results and trajectory of one run; dimensionless, tilts in radians.

    ``time`` has shape (n,), ``state`` (n, 6) in the order of ``State``. ``contact_force``, the
    normal force under the part, ``side_force``, that on the left side (A2, and B2 on the wall), and
    ``right_force``, that on the right side of the slot, have shape (n,). Where a force jumps, its
    time occurs twice. Before the first touch of a part that is lowered, or the onset of its
    vibration, ``time`` is negative. An aligned run continues until the corners are inside, in the
    insertion scene until the part is inserted. ``units`` are those of a device in SI units, else
    None: ``tau_align`` times ``units.time`` is in seconds.
    """

    parameters: Parameters
    time: NDArray[np.float64]
    state: NDArray[np.float64]
    contact_force: NDArray[np.float64]
    side_force: NDArray[np.float64]
    right_force: NDArray[np.float64]
    units: Units | None = field(default=None, compare=False)

    def __repr__(self) -> str:
        time = f"τ = {self.tau_align:.7g} ± {self.tau_error:.1g}"
        if self.units is not None:
            time = f"{self.tau_align * self.units.time:.4g} s ({time})"
        ended = "" if self.outcome is Outcome.ALIGNED else f"{self.outcome}, "
        aligned = "" if math.isnan(self.tau_align) else f"aligned after {time}, "
        return f"<Trajectory: {ended}{aligned}{len(self.time):,} samples>"

    @property
    def track_variables(self) -> dict[str, NDArray[np.float64]]:
        """Variables of the trajectory by the names of ``TRACK_VARIABLES``, each of shape (n,)."""
        columns = *self.state.T, self.contact_force, self.side_force, self.right_force
        return dict(zip(TRACK_VARIABLES, columns, strict=True))

    @property
    def depth(self) -> NDArray[np.float64]:
        """Depth of the higher bottom corner below the plane over time, shape (n,)."""
        _, y, tilt = self.state.T[:3]
        a, b = self.parameters.half_width, self.parameters.half_height
        depth: NDArray[np.float64] = b * np.cos(tilt) - y - a * np.abs(np.sin(tilt))
        return depth

    @property
    def message(self) -> str:
        """Outcome and reason in words."""
        why = REASON_TEXT[self.reason]
        return f"{OUTCOME_TEXT[self.outcome]}{': ' + why if why else ''}"

    @property
    def remedy(self) -> str:
        """Remedy in words: parameters or settings to change."""
        return remedy(self.outcome, self.reason)


Trajectory.__doc__ = described(Trajectory.__doc__, RESULTS)


def simulate(
    parameters: Parameters, settings: Settings | None = None, **changes: Any
) -> Trajectory:
    """Run one parameter set and return its trajectory, as ``vibralign.simulate`` of any device."""
    settings = settings_with(settings, changes)
    rows = settings.rows(Batch.stack([parameters]))
    run, carrying = engine_for(settings), engine_for(settings, carries_error=True)
    found = estimate(run, carrying, rows, settings.tolerance, settings.horizon)
    results = {name: column[0] for name, column in found.columns().items()}
    track = run_tracked(rows[0], float(found.tolerance[0]), settings, carries_error=True)[1]
    return _trajectory(parameters, results, track)


def simulate_once(parameters: Parameters, settings: Settings) -> Trajectory:
    """Run as ``simulate`` does, without an estimate of the error: ``tau_error`` is NaN.

    ``sensitive`` is False. Costs a third as much; meant for statistics over many sets.
    """
    rows = settings.rows(Batch.stack([parameters]))
    result, track = run_tracked(rows[0], settings.tolerance, settings)
    results = {**result._asdict(), "tau_error": math.nan, "sensitive": False}
    results["insertion_error"] = math.nan
    return _trajectory(parameters, results, track)


def _trajectory(parameters: Parameters, results: Mapping[str, Any], track: Array) -> Trajectory:
    """Make the trajectory of a run from its results, by name, and its track.

    Columns are copied, so that copies are like them in memory too: joblib's keys follow this.
    """
    time, *columns = track[:, : 1 + len(TRACK_VARIABLES)].T.copy()
    for last in np.flatnonzero(np.diff(time) < 0.0)[::-1]:  # counted anew: see lifecycle.py
        time[: last + 1] -= time[last]
    variables = dict(zip(TRACK_VARIABLES, columns, strict=True))
    return Trajectory(
        parameters=parameters,
        time=time,
        state=track[:, 1 : 1 + STATE_SIZE].copy(),
        contact_force=variables["contact_force"],
        side_force=variables["side_force"],
        right_force=variables["right_force"],
        **{name: VALUE_TYPES[name].scalar(results[name]) for name in RESULTS},
    )
