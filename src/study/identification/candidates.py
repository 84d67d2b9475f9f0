"""Figures of a structure at several operating points, how short they fall, and the best choice.

A claim falls short by 0 where it is shown with a margin to spare, by 1 and more where it is not.
Given the structure, figures meet in sums and maxima only: a claim on several figures falls short by
the mean of what it does in the worst one and in all. So each figure is computed and scored alone,
and to choose an operating point for each costs no further run.
"""

import itertools
import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from model.events.outcomes import Outcome
from model.physics.parameters import FIELDS, Batch
from model.runs.align import run_once
from model.runs.insertion_outcome import insertion_outcomes
from model.runs.unvibrated import unvibrated
from model.sweeps.sweep import Sweep, merge, run
from study.claims.claims import CLAIMS, Claim
from study.claims.data import Tables, table_of, with_columns
from study.claims.ledger import Judgement, judge_claim
from study.claims.regime import regime_of
from study.claims.statistics import share
from study.config.identification import Aims, Grid, Problem
from study.identification.space import REST_HORIZON, REST_TOLERANCE, TRACKED, Array, Space

SAFE = 0.03  # margin from which a claim counts as shown; less may be lost on another grid
TOWARDS = 0.25  # of a claim, for the distance to what is claimed, so that the search sees a slope
AGAINST = 0.5  # of a claim, if it is contradicted rather than shown in part
AIM, LIMIT = 4.0, 8.0  # claims that an aim and a limit missed by its whole size count as
_MISSED = 1.0  # claims that a set counts as more in small steps, if it misses any limit
_MOST_EXCESS = 2.0
_PREFERENCE = 0.5  # claims that a friction of twice the preferred one counts as
_SHARED_WEIGHT = 0.4  # of a claim on several figures, while each is scored alone
BEARING = np.array([max(len(claim.figures), 1) for claim in CLAIMS])
SHARED = np.array([len(claim.figures) > 1 and not claim.compares for claim in CLAIMS])


class Numbers(NamedTuple):
    """Numbers of a figure that the aims are stated in; see ``Aims`` and ``Regime``."""

    aligned: float
    aligned_mean: float
    not_resting: float
    tilt: float
    corners: float
    friction: float


_NOTHING = Numbers(0.0, 0.0, 1.0, math.pi / 2.0, 0.0, 0.0)  # of a figure that never aligns


@dataclass(frozen=True)
class Scores:
    """A figure of one structure at t operating points.

    Attributes:
        points: coordinates of the operating points, shape (t, unknowns of the figure).
        shorts: by how much each claim falls short, 0 where this figure does not bear on it, shape
            (t, claims).
        numbers: fields of ``Numbers``, shape (t, 6).
        tables: of the figure and its runs of the claims; operating points are their devices.
    """

    points: Array
    shorts: Array
    numbers: Array
    tables: Tables


@dataclass(frozen=True)
class Choice:
    """An operating point for each figure of a structure.

    Attributes:
        point: coordinates of all unknowns, shape (n,).
        shortfall: in claims; the search makes it least.
        picked: number of the operating point of each figure.
    """

    point: Array
    shortfall: float
    picked: Mapping[str, int]


# --- Figures --------------------------------------------------------------------------------------


def scores_of(space: Space, structure: Array, figure: str, points: Array, grid: Grid) -> Scores:
    """Compute and score a figure of a structure at operating points, shape (t, unknowns)."""
    names = space.of_figure(figure, grid)
    whole = np.full((len(points), len(space.names)), 0.5)
    whole[:, space.places["structure"]] = structure
    whole[:, space.places[figure]] = points
    values = [space.values(point) for point in whole]
    sweeps = [[space.sweep(each, name, grid) for name in names] for each in values]
    tables = tables_of(sweeps, space.figures)
    devices = [tables.at(row) for row in range(len(points))]
    shorts = np.array([_shorts(space, each) for each in devices])
    numbers = [numbers_of(figure, *each) for each in zip(devices, values, strict=True)]
    return Scores(points, shorts, np.array(numbers), tables)


def tables_of(devices: Sequence[Sequence[Sweep]], figures: Sequence[str]) -> Tables:
    """Return the tables of the sweeps of each device.

    All grids are run as one batch, and no errors are estimated. Runs of the claims, which are not
    in ``figures``, have no unvibrated controls, which none of their claims reads.
    """
    pairs = [(device, each) for device, sweeps in enumerate(devices) for each in sweeps]
    gridded = [each.dimensions and each.name not in TRACKED for _, each in pairs]
    parts = defaultdict(list)
    for (device, sweep), is_gridded in zip(pairs, gridded, strict=True):
        if not is_gridded:
            table = table_of(merge(sweep, "", [run(sweep)]))
            parts[sweep.name].append(table.assign(device=device, sensitive=0))
    tables = {name: pd.concat(each) for name, each in parts.items()}
    return Tables(tables | _of_grids([*itertools.compress(pairs, gridded)], figures))


def _of_grids(
    pairs: Sequence[tuple[int, Sweep]], figures: Sequence[str]
) -> dict[str, pd.DataFrame]:
    """Return the tables of sweeps over grids, each with the number of its device, by name."""
    if not pairs:
        return {}
    sweeps, settings = [each for _, each in pairs], pairs[0][1].settings.settings
    batches = [each.batch(np.arange(math.prod(each.shape))) for each in sweeps]
    together = Batch({n: np.concatenate([each.values[n] for each in batches]) for n in FIELDS})
    # In a drawn order the long runs do not come together, and few lanes idle at the end.
    order = np.random.default_rng(0).permutation(len(together))
    found = run_once(_rows(together, order), settings)
    back = np.argsort(order)
    columns = {name: found[name][back] for name in found}
    sizes = [len(each) for each in batches]
    names = np.repeat([each.name for each in sweeps], sizes)
    outcome = columns["outcome"].astype(np.int8)
    columns["insertion"] = insertion_outcomes(together, outcome, settings).astype(np.float64)
    columns["device"] = np.repeat([device for device, _ in pairs], sizes)
    columns["sensitive"] = np.zeros(len(together))
    columns["unvibrated"] = np.zeros(len(together))
    columns["unvibrated_tilt"] = np.full(len(together), math.nan)
    needed = np.flatnonzero(np.isin(names, figures) & (outcome == Outcome.ALIGNED))
    if needed.size:
        still = replace(settings, horizon=REST_HORIZON, tolerance=REST_TOLERANCE)
        rest = unvibrated(_rows(together, needed), still)
        columns["unvibrated"][needed] = rest.outcome
        columns["unvibrated_tilt"][needed] = rest.tilt
    frame = pd.DataFrame({**together.values, **columns})
    return {
        each.name: with_columns(frame[names == each.name], each.kind, each.dimensions[0].parameter)
        for each in {each.name: each for each in sweeps}.values()
    }


def _rows(batch: Batch, rows: NDArray[np.int64]) -> Batch:
    """Return the parameter sets in some rows of a batch."""
    return Batch({name: column[rows] for name, column in batch.values.items()})


# --- Score of a figure alone ----------------------------------------------------------------------


def _shorts(space: Space, tables: Tables) -> Array:
    """Return by how much each claim falls short in the tables of one figure, shape (claims,)."""
    shorts = np.zeros(len(CLAIMS))
    for row, claim in enumerate(CLAIMS):
        if claim.id not in space.problem.set_aside:
            shorts[row] = short_of(judge_here(claim, tables), is_whole=not SHARED[row])
    return shorts


def judge_here(claim: Claim, tables: Tables) -> Judgement:
    """Return the verdict on a claim by those of its figures that are at hand."""
    here = tuple(name for name in claim.figures if name in tables.frames)
    if here and not claim.compares:
        claim = replace(claim, figures=here)
    return judge_claim(claim, tables)


def short_of(judgement: Judgement, is_whole: bool) -> float:
    """Return by how much a claim falls short; 0 where the data say nothing.

    ``is_whole`` tells that no other figure bears on the claim, so that the verdict is final.
    """
    margin = judgement.margin
    if math.isnan(margin):
        return 0.0
    short = min(max(1.0 - margin / SAFE, 0.0), 1.0) + TOWARDS * max(-margin, 0.0)
    return short + AGAINST * (is_whole and judgement.verdict == "contradicted")


def numbers_of(figure: str, tables: Tables, values: Mapping[str, float]) -> Numbers:
    """Return the numbers of a figure; those of one that never aligns are the worst."""
    regime = regime_of(tables, figure)
    found = Numbers(
        aligned=regime.aligned,
        aligned_mean=share(tables.values(figure, "aligned")),
        not_resting=regime.not_resting,
        tilt=regime.tilt,
        corners=regime.corners,
        friction=values.get(f"{figure}.friction", 0.0),
    )
    return Numbers(*np.where(np.isnan(found), _NOTHING, found).tolist())


# --- Shortfalls and choice ------------------------------------------------------------------------


def short_of_aims(problem: Problem, figure: str, numbers: Array) -> Array:
    """Return by how much a figure misses its aims and limits, in claims, shape (..., 6) to (...).

    Those for the mean share not resting are left to ``shortfall``.
    """
    friction = numbers[..., Numbers._fields.index("friction")]
    preferred = np.maximum(friction / problem.aims.friction - 1.0, 0.0)
    missed = AIM * _excess(problem.aims, figure, numbers)
    missed += LIMIT * _excess(problem.limits, figure, numbers)
    return np.asarray(missed + _PREFERENCE * preferred)


def _excess(aims: Aims, figure: str, numbers: Array) -> Array:
    each = Numbers(*np.moveaxis(numbers, -1, 0))
    least = aims.aligned_mean.get(figure, aims.aligned)
    ratios = [
        each.not_resting / aims.not_resting_most,
        each.tilt / aims.tilt,
        (1.0 - np.asarray(each.corners)) / (1.0 - aims.corners),
        aims.aligned / np.maximum(each.aligned, 0.01),
        least / np.maximum(each.aligned_mean, 0.01),
        np.asarray(each.aligned_mean) / aims.aligned_most.get(figure, 1.0),
    ]
    excesses = np.clip(np.stack(np.broadcast_arrays(*ratios)) - 1.0, 0.0, _MOST_EXCESS)
    return np.asarray(excesses.sum(axis=0))


def shortfall(problem: Problem, shorts: Array, numbers: Array, missed: float) -> float:
    """Return the shortfall of a set, in claims.

    Args:
        problem: what it should reach besides the claims.
        shorts: by how much claims fall short in each figure, shape (figures, claims).
        numbers: of each figure, shape (figures, 6).
        missed: sum of ``short_of_aims`` over the figures.
    """
    mean = float(numbers[:, Numbers._fields.index("not_resting")].mean())
    for aims, weight in ((problem.aims, AIM), (problem.limits, LIMIT)):
        missed += weight * min(max(mean / aims.not_resting - 1.0, 0.0), _MOST_EXCESS)
    worst = shorts.max(axis=0)
    claims = np.where(SHARED, 0.5 * (worst + shorts.sum(axis=0) / BEARING), worst)
    return float(claims.sum() + missed)


def meets_limits(problem: Problem, numbers: Mapping[str, Numbers]) -> bool:
    """Return whether a set meets every limit; ``numbers`` are those of each figure."""
    limits = problem.limits
    mean = float(np.mean([each.not_resting for each in numbers.values()]))
    return mean <= limits.not_resting and not any(
        _excess(limits, figure, np.array(each)) for figure, each in numbers.items()
    )


def shortfall_at_last(problem: Problem, shortfall: float, numbers: Mapping[str, Numbers]) -> float:
    """Return the shortfall of a set, and a claim more if it misses a limit."""
    return shortfall + (0.0 if meets_limits(problem, numbers) else _MISSED)


def chosen(space: Space, structure: Array, figures: Mapping[str, Scores]) -> Choice:
    """Return the operating points of least shortfall: from several starts, one figure at a time."""
    problem, names = space.problem, list(figures)
    missed = {name: short_of_aims(problem, name, figures[name].numbers) for name in names}

    def cost(picked: Sequence[int]) -> float:
        pairs = list(zip(names, picked, strict=True))
        shorts = np.array([figures[name].shorts[row] for name, row in pairs])
        numbers = np.array([figures[name].numbers[row] for name, row in pairs])
        return shortfall(problem, shorts, numbers, sum(missed[name][row] for name, row in pairs))

    best, least = None, math.inf
    for weight in (0.0, 2.0, 6.0, 15.0):
        alone = [costs_alone(space, name, figures[name], weight) for name in names]
        picked, value = [int(np.argmin(each)) for each in alone], math.inf
        while (now := cost(picked)) < value - 1e-9:
            value = now
            for place, name in enumerate(names):
                options = [
                    [*picked[:place], row, *picked[place + 1 :]]
                    for row in range(len(figures[name].points))
                ]
                picked = min(options, key=cost)
        if value < least:
            best, least = picked, value
    assert best is not None  # noqa: S101  (a shortfall is finite)
    point = np.full(len(space.names), 0.5)
    point[space.places["structure"]] = structure
    for name, row in zip(names, best, strict=True):
        point[space.places[name]] = figures[name].points[row]
    return Choice(point, least, dict(zip(names, best, strict=True)))


def costs_alone(
    space: Space,
    figure: str,
    made: Scores,
    weight: float = 0.0,
    shared: float = _SHARED_WEIGHT,
) -> Array:
    """Return the cost of each operating point of a figure scored alone, shape (t,), in claims.

    Args:
        space: of the search.
        figure: its name.
        made: the figure at t operating points.
        weight: of its share not resting.
        shared: weight of a claim on several figures.
    """
    own = (made.shorts * np.where(SHARED, shared, 1.0)).sum(axis=-1)
    resting = made.numbers[:, Numbers._fields.index("not_resting")]
    missed = short_of_aims(space.problem, figure, made.numbers)
    return np.asarray(own + missed + weight * resting)


def picked_tables(figures: Mapping[str, Scores], picked: Mapping[str, int]) -> Tables:
    """Return the tables of one operating point of each figure, by their numbers."""
    each = [figures[name].tables.at(row).alone() for name, row in picked.items()]
    return Tables({name: table for tables in each for name, table in tables.items()})
