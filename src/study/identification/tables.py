"""Files of the search: the sets of a part, a set scored on the study's grids, and a summary."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from study.claims.data import Tables
from study.claims.ledger import VERDICTS, judge
from study.claims.regime import regime_of
from study.csv_tables import csv_text, read_rows
from study.identification.candidates import (
    Choice,
    Numbers,
    meets_limits,
    numbers_of,
    shortfall_at_last,
)
from study.identification.search import Found
from study.identification.space import Array, Space, structure_of

_SHORTFALL = "shortfall"


def found_text(space: Space, found: Found) -> str:
    """Return sets as a table: the shortfall, and the value of every unknown."""
    rows = [
        {_SHORTFALL: f"{short:.6g}"} | {name: f"{v:.9g}" for name, v in space.values(point).items()}
        for short, point in zip(found.shortfalls, found.points, strict=True)
    ]
    return csv_text((_SHORTFALL, *space.names), rows)


def read_found(space: Space, paths: Sequence[Path]) -> Found:
    """Return the sets of tables."""

    def read(row: dict[str, str]) -> tuple[float, Array]:
        values = {name: float(text) for name, text in row.items()}
        return values[_SHORTFALL], space.point(values)

    rows = [row for path in paths for row in read_rows(path, "sets", read)]
    return Found(np.array([point for _, point in rows]), np.array([short for short, _ in rows]))


def scored_text(space: Space, choice: Choice, tables: Tables) -> str:
    """Return a set with its claims and the regime of its figures, as JSON."""
    values = space.values(choice.point)
    figures = {
        name: regime_of(tables, name)._asdict() | numbers_of(name, tables, values)._asdict()
        for name in space.figures
    }
    return json.dumps(
        {
            "shortfall": choice.shortfall,
            "values": values,
            "claims": {claim.id: found.verdict for claim, found in judge(tables)},
            "figures": figures,
        },
        indent=1,
    )


def read_scored(space: Space, paths: Sequence[Path]) -> Found:
    """Return scored sets; one that misses a limit falls short by a claim more."""
    sets = [json.loads(path.read_text(encoding="utf-8")) for path in paths]
    return Found(
        np.array([space.point(each["values"]) for each in sets]),
        np.array(
            [shortfall_at_last(space.problem, each[_SHORTFALL], _numbers(each)) for each in sets]
        ),
    )


def _misses(space: Space, scored: Mapping[str, Any]) -> bool:
    """Return whether a scored set misses a limit."""
    return not meets_limits(space.problem, _numbers(scored))


def summary_texts(space: Space, paths: Sequence[Path]) -> dict[str, str]:
    """Return the tables of all scored sets, and the best one as it stands in the configuration.

    Sets that miss no limit come first. Beside the sets: what they say of each unknown and of each
    claim.
    """
    sets = sorted(
        (json.loads(path.read_text(encoding="utf-8")) for path in paths),
        key=lambda each: (_misses(space, each), each[_SHORTFALL]),
    )
    rows = [_row(space, each) for each in sets]
    return {
        "sets": csv_text([*rows[0]], rows),
        "ranges": _ranges_text(sets),
        "claims": _claims_text(sets),
        "device": _configuration(space, sets[0]["values"]),
    }


def _numbers(scored: Mapping[str, Any]) -> dict[str, Numbers]:
    return {
        figure: Numbers(*(found[name] for name in Numbers._fields))
        for figure, found in scored["figures"].items()
    }


def _row(space: Space, scored: Mapping[str, Any]) -> dict[str, Any]:
    """Return a scored set as a row: numbers over all figures, of some by figure, and its values."""
    verdicts, figures = [*scored["claims"].values()], scored["figures"]
    resting = [each["not_resting"] for each in figures.values()]
    row = {
        _SHORTFALL: scored[_SHORTFALL],
        "meets_limits": not _misses(space, scored),
        **{name.replace(" ", "_"): verdicts.count(name) for name in VERDICTS},
        "not_resting": float(np.mean(resting)),
        "not_resting_most": max(resting),
        "tilt": max(each["tilt"] for each in figures.values()),
        "corners": min(each["corners"] for each in figures.values()),
        "aligned": min(each["aligned"] for each in figures.values()),
        **{f"{name}.aligned_mean": each["aligned_mean"] for name, each in figures.items()},
        **scored["values"],
    }
    return {name: f"{value:.6g}" for name, value in row.items()}


def _ranges_text(sets: Sequence[Mapping[str, Any]]) -> str:
    """Return by unknown the least, the median and the greatest value of the sets."""
    rows = []
    for name in sets[0]["values"]:
        values = [each["values"][name] for each in sets]
        least, median, greatest = (f"{value:.4g}" for value in np.quantile(values, (0.0, 0.5, 1.0)))
        rows.append({"unknown": name, "least": least, "median": median, "greatest": greatest})
    return csv_text(("unknown", "least", "median", "greatest"), rows)


def _claims_text(sets: Sequence[Mapping[str, Any]]) -> str:
    """Return by claim the shares that show and contradict it, and the verdict of the best set."""
    rows = []
    for name, best in sets[0]["claims"].items():
        verdicts = [each["claims"][name] for each in sets]
        shares = {
            share: f"{verdicts.count(verdict) / len(sets):.3f}"
            for share, verdict in (("shown", "reproduced"), ("contradicted", "contradicted"))
        }
        rows.append({"claim": name, **shares, "best": best})
    return csv_text(("claim", "shown", "contradicted", "best"), rows)


def _configuration(space: Space, values: Mapping[str, float]) -> str:
    """Return the device and the operating points of a set as they stand in the configuration."""

    def rounded(stated: Mapping[str, float]) -> dict[str, float]:
        return {name: float(f"{value:.4g}") for name, value in stated.items()}

    figures = {
        figure: rounded(
            space.problem.stated.get(figure, {})
            | {name: values[f"{figure}.{name}"] for name in priors}
        )
        for figure, priors in space.problem.operating_points.items()
    }
    stated = {"structure": rounded(structure_of(values)), "held": figures}
    return yaml.safe_dump(stated, sort_keys=False, default_flow_style=None, width=100)
