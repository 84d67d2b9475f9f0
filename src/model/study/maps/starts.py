"""Starts of an ensemble (phase of the excitation, initial tilt), and the choice of those to try.

A start cannot be controlled at touch-down: a device is *reliable* if it aligns within the horizon
from all starts. At nodes where the nominal start fails, no other is tried. Elsewhere:

- Nodes beside a failing node try all starts, because most of the border of the reliable area is the
  border of the nominal one.
- Some nodes inside, far apart, try a few starts; in a map of at most ``COARSE`` intervals all
  nodes try all starts.
- Where a start fails, nodes near it try the same start, then the phases next to it at all tilts.

This goes on until no start is left to try: the border is followed in a third, periodic dimension. A
node is settled by one failure, so that the starts most likely to fail are tried first.

Areas that touch a computed failure are exact. An island of failing nodes is missed if no node in it
was computed from a start that fails.
"""

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.events.outcomes import SUCCESSES
from model.physics.parameters import Batch, Parameters
from model.runs.align import run_once
from model.runs.settings import Settings
from model.study.config.figures import Ensemble
from model.study.maps.lattice import Bools, Floats, Ints

Starts = Sequence[Mapping[str, float]]

COARSE = 32  # intervals along a side between the nodes inside that try starts
INSIDE = 4  # such a node tries, at each tilt, one phase of every four
NEAR = 2  # distance in nodes to which a failing start is tried
NOT_TRIED, FAILS, ALIGNS = -1, 0, 1


def starts_of(device: Parameters, ensemble: Ensemble) -> list[dict[str, float]]:
    """Return phase and tilt of all starts of the ensemble; the first has the device's phase."""
    phases = [device.phase + 2.0 * math.pi * k / ensemble.phases for k in range(ensemble.phases)]
    tilts = [device.initial_tilt * factor for factor in ensemble.tilts]
    return [
        {"phase": phase, "initial_tilt": tilt} for tilt, phase in itertools.product(tilts, phases)
    ]


def every_start(
    devices: Batch, starts: Starts, settings: Settings, cores: int = 1
) -> dict[str, NDArray[Any]]:
    """Run all devices from all starts.

    Returns:
        The fields of ``RunResult``, and ``goes_in``; each of shape (devices, starts).
    """
    values = {name: np.repeat(column, len(starts)) for name, column in devices.values.items()}
    for name in starts[0]:
        values[name] = np.tile([start[name] for start in starts], len(devices))
    results = run_once(Batch(values), settings, cores=cores)
    shaped = {name: flat.reshape(len(devices), len(starts)) for name, flat in results.items()}
    return {**shaped, "goes_in": np.isin(shaped["outcome"], SUCCESSES)}


# --- Which starts a map tries ---------------------------------------------------------------------


def starts_to_try(
    fails: Bools, nominal_fails: Bools, untried: Bools, inside: Bools, phases: int
) -> Bools:
    """Return the starts that nodes try next, shape (rows, columns, starts); none at the end.

    Args:
        fails: starts that were tried and fail, shape (rows, columns, starts).
        nominal_fails: nodes at which the nominal start fails, shape (rows, columns).
        untried: starts that may still be tried, in the shape of ``fails``.
        inside: ``starts_inside``.
        phases: number of phases; the starts of one tilt follow each other.
    """
    from scipy.ndimage import binary_dilation, maximum_filter  # noqa: PLC0415  (slow)

    settled = nominal_fails | fails.any(axis=2)
    untried = untried & ~settled[:, :, None]
    near = maximum_filter(fails, size=(2 * NEAR + 1, 2 * NEAR + 1, 1))
    beside = binary_dilation(settled)[:, :, None]  # along rows and columns
    for wanted in (inside | near, adjacent_in_phase(near, phases), beside):
        more: Bools = wanted & untried
        if more.any():
            break
    return more


def starts_inside(shape: tuple[int, ...], phases: int) -> Bools:
    """Return the starts that nodes inside try first, shape (rows, columns, starts)."""
    if shape[0] - 1 <= COARSE:
        return np.ones(shape, dtype=np.bool_)
    apart = (shape[0] - 1) // COARSE
    inside = np.zeros(shape, dtype=np.bool_)
    inside[::apart, ::apart] = alternating(inside[::apart, ::apart].shape, phases)
    return inside


def alternating(shape: tuple[int, ...], phases: int) -> Bools:
    """Return a few starts for each node, shape (rows, columns, starts).

    The phases differ between neighbouring nodes, and from one tilt to the next.
    """
    every = min(INSIDE, phases)
    row, column, start = np.ogrid[tuple(map(slice, shape))]
    between = max(every // 2, 1)
    phase = start % phases + between * (start // phases)
    chosen: Bools = (phase - row - between * column) % every == 0
    return chosen


def adjacent_in_phase(fails: Bools, phases: int) -> Bools:
    """Return the starts at all tilts whose phase, or one next to it, fails at any tilt."""
    by_phase = fails.reshape(*fails.shape[:2], -1, phases)
    phase = by_phase.any(axis=2)
    near: Bools = np.tile(phase | np.roll(phase, 1, 2) | np.roll(phase, -1, 2), by_phase.shape[2])
    return near


def sum_up_starts(
    end: NDArray[np.int8], tau: Floats, nominal_aligns: Bools, nominal_tau: Floats
) -> tuple[Floats, Floats, Ints]:
    """Return (share of tried starts that align, excess of durations, number of runs).

    Each has the shape of the lattice. The share includes the nominal start. The excess is the
    longest duration minus ``nominal_tau``, taken from the nearest node at which starts were tried
    and all align.

    Args:
        end: NOT_TRIED, FAILS or ALIGNS, shape (rows, columns, starts).
        tau: alignment durations, in the same shape.
        nominal_aligns: whether the nominal start aligns, shape (rows, columns).
        nominal_tau: its alignment duration, shape (rows, columns).
    """
    from scipy.ndimage import distance_transform_edt  # noqa: PLC0415  (slow)

    runs = (end != NOT_TRIED).sum(axis=2)
    share = (nominal_aligns + (end == ALIGNS).sum(axis=2)) / (1 + runs)
    excess = np.fmax.reduce(tau, axis=2, initial=0.0) - nominal_tau
    unknown = (share < 1.0) | (runs == 0)
    if unknown.all():
        return share, np.zeros(share.shape), runs
    nearest = distance_transform_edt(unknown, return_distances=False, return_indices=True)
    return share, np.maximum(excess[tuple(nearest)], 0.0), runs
