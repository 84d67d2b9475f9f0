"""Points of a figure that fixed steps without event location get wrong."""

from enum import IntEnum
from typing import Any, get_args

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from benchmarks.methods.by_hand import Scheme, solve_by_hand
from benchmarks.plans import FixedStepPlan
from model.study.io import DatasetError, flags

FIXED_SCHEMES: tuple[Scheme, ...] = get_args(Scheme)
KIND = "fixed_steps"


class Wrong(IntEnum):
    """Error of a point; the values are the flags in the dataset."""

    NOT_WRONG = 0
    WRONG_OUTCOME = 1
    WRONG_TIME = 2


def judged(
    tau: NDArray[np.float64], located: NDArray[np.float64], tau_tolerance: float
) -> NDArray[np.int8]:
    """Return ``Wrong`` for alignment times against ``located`` ones; shapes broadcast.

    A time is NaN without an alignment. A point is wrong if only one of its runs aligns, or if the
    times differ by more than ``tau_tolerance``.
    """
    aligned, should = ~np.isnan(tau), ~np.isnan(located)
    both = aligned & should
    off = np.abs(np.subtract(tau, located, where=both, out=np.zeros(both.shape)))
    found = np.where(off > tau_tolerance, Wrong.WRONG_TIME, Wrong.NOT_WRONG)
    return np.where(aligned != should, Wrong.WRONG_OUTCOME, found).astype(np.int8)


def fixed_step_dataset(plan: FixedStepPlan, located: xr.Dataset) -> xr.Dataset:
    """Return alignment times by scheme and step beside those of the figure's dataset.

    Raises:
        DatasetError: ``located`` belongs to another sweep.
    """
    sweep = plan.sweep
    of = located.attrs.get("config_hash")
    if of != sweep.identity:
        raise DatasetError(
            f"{sweep.figure}: the dataset belongs to sweep {of!r}, not {sweep.identity!r}: "
            "build it again"
        )
    dims = tuple(dimension.parameter for dimension in sweep.dimensions)
    part = located.isel(dict(zip(dims, plan.kept, strict=True)))
    true = part["tau_align"].transpose(*dims).values
    points = np.arange(np.prod(sweep.shape)).reshape(sweep.shape)[plan.kept]
    batch = sweep.batch(points.ravel())
    settings = sweep.settings.settings
    tau = np.array(
        [
            [
                solve_by_hand(batch, scheme, step, settings).tau_align.reshape(true.shape)
                for step in plan.steps
            ]
            for scheme in FIXED_SCHEMES
        ]
    )
    every = ("scheme", "step", *dims)
    wrong = judged(tau, true, plan.tau_tolerance)
    variables: dict[str, Any] = {
        "tau_align": (every, tau, {"long_name": "alignment duration", "symbol": "τ", "units": "1"}),
        "wrong": (
            every,
            wrong,
            {"long_name": "whether the point comes out wrong", "units": "1", **flags(Wrong)},
        ),
        "tau_located": part["tau_align"],
        "sensitive": part["sensitive"],
    }
    names = {
        "long_name": "fixed-step method",
        "units": "1",
        "flag_values": np.arange(len(FIXED_SCHEMES), dtype=np.int8),
        "flag_meanings": " ".join(FIXED_SCHEMES),
    }
    coordinates: dict[str, Any] = {
        "scheme": ("scheme", np.arange(len(FIXED_SCHEMES), dtype=np.int8), names),
        "step": ("step", plan.steps, {"long_name": "length of a step", "units": "1"}),
    }
    attributes = located.attrs | {
        "title": f"{located.attrs['title']}: with fixed steps, without event location",
        "kind": KIND,
        "figure_kind": sweep.kind,
        "config_hash": plan.identity,
        "tau_tolerance": plan.tau_tolerance,
    }
    return xr.Dataset(variables, coordinates | dict(part.coords), attributes)


def wrong_counts(dataset: xr.Dataset) -> dict[tuple[str, float], dict[str, int]]:
    """Return counts by scheme and step: all points, points by ``Wrong``, wrong sensitive points."""
    sensitive = dataset["sensitive"].values == 1
    counts = {}
    for row, scheme in enumerate(str(dataset["scheme"].attrs["flag_meanings"]).split()):
        for column, step in enumerate(dataset["step"].values):
            wrong = dataset["wrong"].values[row, column]
            counts[scheme, float(step)] = {
                "points": int(wrong.size),
                "wrong_outcome": int((wrong == Wrong.WRONG_OUTCOME).sum()),
                "wrong_time": int((wrong == Wrong.WRONG_TIME).sum()),
                "sensitive": int(((wrong != Wrong.NOT_WRONG) & sensitive).sum()),
            }
    return counts
