"""Many parameter sets at once, over the cores."""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.physics.parameters import Batch, Parameters
from model.runs.errors import COLUMNS, NO_TRACK, run_rows
from model.runs.settings import Settings

_BLOCK = 32  # rows a thread takes at a time: small enough to level, large enough to cost nothing


@dataclass(frozen=True)
class Alignments:
    """Results of a batch; every array has shape (n,), in the order of the batch, dimensionless.

    Attributes:
        outcome: values of ``Outcome``.
        reason: values of ``Reason``.
        tau_align: alignment time, NaN where not aligned.
        tau_error: estimated error of ``tau_align``, NaN where it cannot be estimated.
        tau_corners_inside: when the paper's four corner conditions hold, NaN if they never do.
        sensitive: whether a run at another tolerance ends differently or at another time.
        tilt_at_alignment: tilt at ``tau_align``, radians.
        tilt_max: largest |tilt| until alignment or the end, radians.
        separations: how often the part lost the base before alignment.
        contact_force_max: largest normal force at one place, in units of F1.
        sticking_share: share of the time in which the supporting contact sticks.
        rhs_evaluations: right-hand sides evaluated, both runs together.
        period: excitation periods after which a settled motion repeats itself, else 0.
    """

    outcome: NDArray[np.int8]
    reason: NDArray[np.int8]
    tau_align: NDArray[np.float64]
    tau_error: NDArray[np.float64]
    tau_corners_inside: NDArray[np.float64]
    sensitive: NDArray[np.bool_]
    tilt_at_alignment: NDArray[np.float64]
    tilt_max: NDArray[np.float64]
    separations: NDArray[np.int64]
    contact_force_max: NDArray[np.float64]
    sticking_share: NDArray[np.float64]
    rhs_evaluations: NDArray[np.int64]
    period: NDArray[np.int64]

    def __len__(self) -> int:
        return int(self.outcome.size)


_DTYPES = {
    "outcome": np.int8,
    "reason": np.int8,
    "sensitive": np.bool_,
    "separations": np.int64,
    "rhs_evaluations": np.int64,
    "period": np.int64,
}


def align(
    batch: Batch | Sequence[Parameters],
    settings: Settings | None = None,
    *,
    cores: int | None = None,
    **changes: Any,
) -> Alignments:
    """Run every parameter set of ``batch`` to its end.

    Each result depends on its own parameter set only: ``align(batch)`` at row i is to the bit
    ``align([batch[i]])``, whatever the order and the number of cores.

    Args:
        batch: a ``Batch``, or a sequence of ``Parameters``.
        settings: how to run.
        cores: threads to use, all by default.
        **changes: fields of ``Settings`` by name, over those of ``settings`` (``horizon=100``).

    Raises:
        ValueError: an empty batch, fewer than one core, or a setting outside its range.
    """
    settings = replace(settings or Settings(), **changes)
    rows_of = batch if isinstance(batch, Batch) else Batch.stack(batch)
    if len(rows_of) == 0:
        raise ValueError("the batch is empty: give at least one parameter set")
    cores = os.cpu_count() or 1 if cores is None else cores
    if cores < 1:
        raise ValueError(f"cores = {cores!r}: must be >= 1")
    rows = rows_of.constants(settings.readings)
    out = np.empty((len(rows), len(COLUMNS)))

    def run(first: int) -> None:
        part = slice(first, first + _BLOCK)
        run_rows(rows[part], *settings.for_kernels, NO_TRACK, NO_TRACK, out[part])

    firsts = range(0, len(rows), _BLOCK)
    if cores == 1 or len(firsts) == 1:
        for first in firsts:
            run(first)
    else:
        with ThreadPoolExecutor(cores) as pool:  # kernels hold no lock of the interpreter
            list(pool.map(run, firsts))
    return Alignments(
        **{
            field.name: out[:, COLUMNS.index(field.name)].astype(_DTYPES.get(field.name, float))
            for field in fields(Alignments)
        }
    )
