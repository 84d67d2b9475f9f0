"""The identification's result as tables, committed in config/identification.

``make identification`` writes these tables anew. A search takes an hour; figures and report read
its result here. The tables name the search and the claims that they were made with, so that a
change of either since is said where they are shown, and stops nothing else.
"""

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

TABLES = ("ensemble", "claims", "splits", "readings", "made_with", "front", "budget")
# Its pictures, and where each belongs in the results root, without extension.
PICTURES: Mapping[str, str] = {
    "front": "figures/identified_front",
    "budget": "figures/identified_budget",
    "structure": "figures/identified_structure",
    "claims": "figures/identified_claims",
    "bands": "figures/identified_bands",
    "readings": "figures/identified_readings",
}

Array = NDArray[np.float64]


class IdentificationError(ValueError):
    """A committed table that is missing, broken, or of another search."""


class Split(NamedTuple):
    """One split: claims searched for and those held out, and how many of each are reproduced.

    ``possible`` are those held out that some admissible set shows: the most to be reproduced.
    """

    number: int
    searched: int
    searched_reproduced: int
    held_out: int
    held_out_reproduced: int
    possible: int
    possible_reproduced: int

    @property
    def rate(self) -> float:
        """Share of the claims held out that is reproduced."""
        return self.held_out_reproduced / self.held_out

    @property
    def rate_of_possible(self) -> float:
        """The same of those that some admissible set shows."""
        return self.possible_reproduced / max(self.possible, 1)


class FrontSet(NamedTuple):
    """A set judged on the finer grids, or the chosen one; numbers as in ``claims.regime.Summary``.

    ``claims`` are those shown without the ones that ask what the aims ask; ``best`` is true if no
    other set is better in claims, in the share not resting, and in tilt; ``lacks`` names the claims
    that count and that it does not reproduce.
    """

    best: bool
    chosen: bool
    claims: int
    lacks: str
    not_resting: float
    not_resting_most: float
    tilt: float
    corners: float
    aligned: float

    @property
    def lacking(self) -> frozenset[str]:
        """Names of the claims that it does not reproduce."""
        return frozenset(self.lacks.split())


class BudgetFront(NamedTuple):
    """A set on the front that the first ``candidates`` found, on the coarse grids."""

    candidates: int
    claims: int
    not_resting: float
    not_resting_most: float
    tilt: float
    corners: float
    aligned: float


@dataclass(frozen=True)
class Identified:
    """The result of an identification.

    Attributes:
        ensemble: values of the admissible sets by unknown, each of shape (sets,).
        claims: their names.
        counted: whether a claim counted in the score, shape (claims,).
        margins: of the best set, on the study's own grids, shape (claims,).
        ensemble_shares: share of the ensemble that reproduces each claim, shape (claims,).
        prior_shares: share of draws from the prior that does, NaN where unknown, shape (claims,).
        splits: identified on one half of the claims, judged on the other.
        readings: margins of the best set under each reading, each of shape (claims,).
        made_with: hashes of the "search" and of the "claims".
        front: the sets judged on the finer grids, and last the chosen one on the study's own.
        budget: fronts of parts of the budget, by rising number of candidates.
    """

    ensemble: Mapping[str, Array]
    claims: tuple[str, ...]
    counted: NDArray[np.bool_]
    margins: Array
    ensemble_shares: Array
    prior_shares: Array
    splits: tuple[Split, ...]
    readings: Mapping[str, Array]
    made_with: Mapping[str, str]
    front: tuple[FrontSet, ...]
    budget: tuple[BudgetFront, ...]

    def points(self, names: Sequence[str]) -> Array:
        """Return the values of the admissible sets, shape (sets, names).

        Raises:
            IdentificationError: a name that was not searched.
        """
        missing = [name for name in names if name not in self.ensemble]
        if missing:
            raise IdentificationError(
                f"the committed ensemble lacks {', '.join(missing)}: run `make identification` and "
                "commit its tables"
            )
        return np.array([self.ensemble[name] for name in names]).T


_CLAIMS = ("claim", "counted", "margin", "ensemble", "prior")


def tables_of(found: Identified) -> dict[str, str]:
    """Return the tables as CSV text by name; numbers to six digits."""
    values = np.array(list(found.ensemble.values())).T
    by_claim = zip(
        found.claims,
        found.counted.astype(int).tolist(),
        *(each.tolist() for each in (found.margins, found.ensemble_shares, found.prior_shares)),
        strict=True,
    )
    return {
        "ensemble": _text(found.ensemble, values.tolist()),
        "claims": _text(_CLAIMS, by_claim),
        "splits": _text(Split._fields, found.splits),
        "readings": _text(
            ("reading", *found.claims),
            [(name, *margins.tolist()) for name, margins in found.readings.items()],
        ),
        "made_with": _text(("part", "hash"), found.made_with.items()),
        "front": _text(FrontSet._fields, found.front),
        "budget": _text(BudgetFront._fields, found.budget),
    }


def _text(header: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    for row in rows:
        writer.writerow(f"{each:.6g}" if isinstance(each, float) else each for each in row)
    return text.getvalue()


def read_identified(folder: Path) -> Identified:
    """Return what ``tables_of`` wrote to ``folder``.

    Raises:
        IdentificationError: a table is missing, empty, or has other columns than it should.
    """
    read = {name: _read(folder / f"{name}.csv") for name in TABLES}
    try:
        header, *rows = read["ensemble"]
        values = np.array(rows, dtype=np.float64)
        claims = {row[0]: [float(cell) for cell in row[1:]] for row in read["claims"][1:]}
        counted, margins, ensemble_shares, prior_shares = np.array(list(claims.values())).T
        return Identified(
            ensemble=dict(zip(header, values.T, strict=True)),
            claims=tuple(claims),
            counted=counted == 1.0,
            margins=margins,
            ensemble_shares=ensemble_shares,
            prior_shares=prior_shares,
            splits=tuple(Split(*(int(cell) for cell in row)) for row in read["splits"][1:]),
            readings=_by_claim(read["readings"], tuple(claims)),
            made_with=dict(read["made_with"][1:]),
            front=tuple(
                FrontSet(
                    row[0] == "True", row[1] == "True", int(row[2]), row[3], *map(float, row[4:])
                )
                for row in read["front"][1:]
            ),
            budget=tuple(
                BudgetFront(int(row[0]), int(row[1]), *map(float, row[2:]))
                for row in read["budget"][1:]
            ),
        )
    except (ValueError, TypeError, IndexError) as error:
        raise IdentificationError(
            f"{folder}: is not what `make identification` writes ({error}): take its tables anew"
        ) from None


def _by_claim(table: list[list[str]], claims: tuple[str, ...]) -> dict[str, Array]:
    header, *rows = table
    if tuple(header[1:]) != claims:
        raise ValueError("readings.csv and claims.csv name other claims")
    return {row[0]: np.array(row[1:], dtype=np.float64) for row in rows}


def _read(path: Path) -> list[list[str]]:
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
    except (OSError, UnicodeDecodeError) as error:
        raise IdentificationError(f"{path}: cannot be read ({error})") from None
    if len(rows) < 2:
        raise IdentificationError(f"{path}: holds no row: take it anew from `make identification`")
    return rows
