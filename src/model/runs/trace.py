"""Trace of a run: its track with the mode, the contact forces and the event of every row."""

from typing import NamedTuple

from model.physics.parameters import Batch, Parameters
from model.runs.engine import Array, run_tracked
from model.runs.settings import Settings


class Trace(NamedTuple):
    """Results of a run by name, and its track, shape (rows, columns); see ``COLUMNS``.

    At an event two rows have the same time, before and after it; the second has its number.
    """

    results: dict[str, float]
    track: Array


def trace_run(parameters: Parameters, settings: Settings) -> Trace:
    """Run one parameter set once, without an estimate of the error; dimensionless."""
    (row,) = settings.rows(Batch.stack([parameters]))
    found, track = run_tracked(row, settings.tolerance, settings)
    return Trace(found._asdict(), track)
