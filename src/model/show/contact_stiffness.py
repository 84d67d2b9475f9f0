"""The report's section on the base's stiffness; its wording is in ``contact_stiffness.html.j2``."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from model.study.claims import VERDICTS
from model.study.contact_comparison import (
    SAME,
    ClaimOnBases,
    OnBase,
    claims_on_bases,
    on_bases,
    settled_from,
    stiffest,
)

if TYPE_CHECKING:
    import xarray as xr

CAPTION = (
    "Durations, and the border of the aligning area, on bases of other stiffness (left) and other "
    "damping (right), on coarse grids."
)
_SIGNS: Mapping[str, str] = dict(zip(VERDICTS, ("✓", "±", "✗", "–"), strict=True))


@dataclass(frozen=True)
class Bases:
    """What the report says of the base: figures on several bases, and a picture of them."""

    datasets: "Mapping[str, xr.Dataset]"
    picture: Path


@dataclass(frozen=True)
class ContactSection:
    """What the page says of the base.

    Attributes:
        sentences: what follows, in words.
        heads: (k_a, damping ratio) of each base.
        numbers: of each figure a row for each base: aligned, in contact, other end, apart.
        claims: id and signs of each claim, a sign for each base.
        caption: of the picture.
        files: names of the figures.
    """

    sentences: tuple[str, ...]
    heads: tuple[tuple[str, str], ...]
    numbers: tuple[tuple[str, tuple[tuple[str, ...], ...]], ...]
    claims: tuple[tuple[str, str, tuple[str, ...]], ...]
    caption: str
    files: tuple[str, ...]


def contact_section(datasets: "Mapping[str, xr.Dataset]") -> ContactSection:
    """The section on contact stiffness.

    Args:
        datasets: figures on several bases, by name; all on the same bases.
    """
    rows = {name: on_bases(dataset) for name, dataset in datasets.items()}
    judged = claims_on_bases(datasets)
    first = next(iter(datasets.values()))
    limit = stiffest(first)
    heads = [(_stiffness(row.stiffness), f"{row.ratio:.2g}") for row in next(iter(rows.values()))]
    return ContactSection(
        sentences=(
            *(_of_figure(name, each, limit) for name, each in rows.items()),
            *(_of_damping(name, each) for name, each in rows.items() if _damped(each)),
            _of_claims(judged, limit),
        ),
        heads=tuple(heads),
        numbers=tuple(
            (name, tuple((*heads[i], *_numbers(row)) for i, row in enumerate(each)))
            for name, each in rows.items()
        ),
        claims=tuple(
            (row.claim.id, row.claim.statement, tuple(_SIGNS[f.verdict] for f in row.findings))
            for row in judged
        ),
        caption=CAPTION,
        files=tuple(datasets),
    )


def _stiffness(value: float) -> str:
    return f"{value:,.0f}".replace(",", "\N{NARROW NO-BREAK SPACE}")


def _percent(share: float) -> str:
    return "–" if math.isnan(share) else f"{100.0 * share:.2g} %"


def _numbers(row: OnBase) -> tuple[str, ...]:
    return tuple(_percent(e) for e in (row.aligned, row.in_contact, row.other_end, row.apart))


def _figure(name: str) -> str:
    return f"Fig. {int(name.removeprefix('fig'))}"


def _of_figure(name: str, rows: Sequence[OnBase], limit: int) -> str:
    own, stiff = rows[0], rows[limit]
    words = (
        f"{_figure(name)}: at the device's k_a = {_stiffness(own.stiffness)}, "
        f"{_percent(own.other_end)} of the runs end otherwise than at {_stiffness(stiff.stiffness)}"
        f", and durations differ by {_percent(own.apart)} in the median: "
    )
    same = own.other_end <= SAME and not own.apart > SAME
    words += f"what it shows is {'the part’s' if same else 'in part the penalty’s'}. "
    settled = settled_from(rows)
    if math.isinf(settled):
        return words + "Some runs still change between the two stiffest bases."
    return words + f"From k_a = {_stiffness(settled)} on no change can be seen."


def _damped(rows: Sequence[OnBase]) -> bool:
    return any(row.ratio != rows[0].ratio for row in rows)


def _of_damping(name: str, rows: Sequence[OnBase]) -> str:
    words = []
    for stiffness in sorted({row.stiffness for row in rows if row.ratio != rows[0].ratio}):
        tried = sorted(
            (row for row in rows if row.stiffness == stiffness), key=lambda row: row.ratio
        )
        low, high = tried[0], tried[-1]
        words.append(
            f"from {_percent(low.aligned)} to {_percent(high.aligned)} at k_a = "
            f"{_stiffness(stiffness)}"
        )
    ends = f"{low.ratio:.2g} to {high.ratio:.2g} of the critical"
    return (
        f"{_figure(name)}: as the damping goes from {ends}, the share of runs that align goes "
        f"{' and '.join(words)}."
    )


def _of_claims(judged: Sequence[ClaimOnBases], limit: int) -> str:
    same = [row for row in judged if row.findings[0].verdict == row.findings[limit].verdict]
    other = [row for row in judged if row not in same]
    words = (
        f"Of {len(judged)} claims that these figures let one judge, {len(same)} have the same "
        "verdict on the device's base and on the stiffest: they speak of the part."
    )
    if other:
        changes = ", ".join(
            f"{row.claim.id} ({row.findings[0].verdict}, then {row.findings[limit].verdict})"
            for row in other
        )
        words += f" The others turn on the base: {changes}."
    return words
