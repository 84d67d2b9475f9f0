"""Hold-out: what a search on half of the figures shows of the other half.

In figures that the search has not seen, its structure and random ones take operating points in
three ways. ``drawn``: from the priors. ``regime``: in each figure the draw that rests, tilts little
and aligns; no claim is read. ``claims``: as a search would choose. So the first two predict, and
the third is fitted, as is all in the figures ``seen``. Claims on every figure are about the regime,
which the search asks for, and are not counted.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from study.claims.claims import CLAIMS, EVERY_FIGURE
from study.claims.data import Tables
from study.config.identification import Grid, HoldOut
from study.identification.candidates import (
    Scores,
    chosen,
    costs_alone,
    judge_here,
    numbers_of,
    picked_tables,
    scores_of,
    shortfall_at_last,
)
from study.identification.search import bounds_of, evolve, final, pool, random_of
from study.identification.space import Array, Space

_RESTING = 2.0  # claims that the share not resting counts as, where the regime chooses
_DRAWS = 2_000_000  # number in seeds, beside those of the search
_HOW = ["structure", "points"]


def hold_out(seen: Space, unseen: Space, spec: HoldOut) -> pd.DataFrame:
    """Return what devices show of figures that the search has not seen, a row each.

    The first row is of what was found, in the figures seen. Columns: ``structure``, "searched" or
    "random", of the same third of the half-widths; ``points``, as operating points were taken; and
    by claim 1.0 if the device shows it, NaN if the figures cannot check it.
    """
    (searched, tables), random = _searched(seen, spec), random_of(unseen, _DRAWS, 0)
    low, high = bounds_of(spec.start, searched.size).T
    drawn = low + (high - low) * random.random((spec.structures, searched.size))
    rows: list[dict[str, Any]] = [{"structure": "searched", "points": "seen", **_shown(tables)}]
    for structure in [searched] * spec.repeats + [*drawn]:
        points = {
            figure: random.random((spec.points, len(priors)))
            for figure, priors in unseen.problem.operating_points.items()
        }
        name = "searched" if structure is searched else "random"
        shown = devices_of(unseen, structure, points, unseen.grid(spec.grid))
        rows += [{"structure": name, **each} for each in shown]
    return pd.DataFrame(rows)


def _searched(space: Space, spec: HoldOut) -> tuple[Array, Tables]:
    """Return the best structure of a short search, shape (7,), and the tables of its figures."""
    drawn = pool(space, spec.pool.structures, spec.pool.stages, spec.start)
    found = evolve(space, spec.round, 0, spec.start, drawn)

    def result(number: int) -> tuple[float, Array, Tables]:
        choice, tables = final(space, spec.final.stages, number, found)
        values = space.values(choice.point)
        numbers = {name: numbers_of(name, tables, values) for name in space.figures}
        return shortfall_at_last(space.problem, choice.shortfall, numbers), choice.point, tables

    _, point, tables = min(map(result, range(spec.final.sets)), key=lambda each: each[0])
    return point[space.places["structure"]], tables


def devices_of(
    space: Space, structure: Array, points: Mapping[str, Array], grid: Grid
) -> list[dict[str, Any]]:
    """Return what devices of a structure show: one a draw, one by regime, and one by claims.

    ``points`` are the draws of each figure's operating point, each of shape (t, unknowns).
    """
    made = {name: scores_of(space, structure, name, points[name], grid) for name in space.figures}
    regime = {name: _by_regime(space, name, each) for name, each in made.items()}
    picks: list[tuple[str, Mapping[str, int]]] = [
        *(("drawn", dict.fromkeys(made, row)) for row in range(len(points[space.figures[0]]))),
        ("regime", regime),
        ("claims", chosen(space, structure, made).picked),
    ]
    return [{"points": how, **_shown(picked_tables(made, picked))} for how, picked in picks]


def _by_regime(space: Space, figure: str, made: Scores) -> int:
    """Return the number of the operating point of a figure that the regime alone chooses."""
    blind = replace(made, shorts=np.zeros_like(made.shorts))
    return int(np.argmin(costs_alone(space, figure, blind, _RESTING)))


def _shown(tables: Tables) -> dict[str, float]:
    asked = (claim for claim in CLAIMS if claim.figures != EVERY_FIGURE)
    judged = {claim.id: judge_here(claim, tables).verdict for claim in asked}
    return {
        name: float(each == "reproduced")
        for name, each in judged.items()
        if each != "not checkable"
    }


def summary_of(halves: Mapping[str, pd.DataFrame]) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return how many claims devices show, and the share of devices that show each claim.

    ``halves`` are the rows of ``hold_out`` by the half that the search has not seen.
    """
    counts, shares = {}, {}
    for half, rows in halves.items():
        shown = rows.drop(columns=_HOW)
        by = [rows[name] for name in _HOW]
        count = shown.sum(axis=1).groupby(by).agg(["count", "mean", "min", "max"])
        counts[half] = count.assign(claims=shown.notna().sum(axis=1).groupby(by).max())
        share = shown.groupby(by).mean().T
        share.columns = [", ".join(each) for each in share.columns]
        shares[half] = share
    return (
        pd.concat(counts, names=["half"]).reset_index(),
        pd.concat(shares, names=["half", "claim"]).reset_index(),
    )


def summary() -> str:
    """Return in a sentence what was found of the figures that a search has not seen."""
    counts = measured().query("points != 'seen'").groupby(_HOW)[["mean", "claims"]].sum()
    searched, random = (counts.loc[each, "mean"] for each in ("searched", "random"))
    return (
        f"In figures that a search has not seen, the structures that it finds show "
        f"{searched.min():.0f} to {searched.max():.0f} of {counts['claims'].max()} claims, random "
        f"structures {random.min():.0f} to {random.max():.0f}"
    )


def measured() -> pd.DataFrame:
    """Return how many claims devices show, as ``make hold-out`` last found: hold_out.csv."""
    return pd.read_csv(Path(__file__).with_suffix(".csv"))
