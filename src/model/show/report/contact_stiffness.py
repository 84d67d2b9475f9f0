"""The section on the contact stiffness: which features of the figures depend on it."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from markupsafe import Markup

from model.show.report.claims import SIGNS
from model.show.report.section import Results, Section, Table
from model.show.words import figure_title, percent
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
_CLAIM = Markup('<a class="nobreak" href="#claim-{}" title="{}">{}</a>')


def section(results: Results) -> Section:
    """Return the section on contact stiffness."""
    places = {
        name: f"data/contact_stiffness/{name}.nc"
        for name in results.study.contact_stiffness.figures
    }
    datasets = {name: results.dataset(place) for name, place in places.items()}
    judged = claims_on_bases(datasets)
    found = sentences(datasets, judged)
    content = {
        "sentences": found[:-1],
        "bases": results.picture("figures/contact_stiffness", CAPTION),
        "files": [
            (f"{figure_title(name)} on all bases (netCDF)", place) for name, place in places.items()
        ],
        "numbers": [numbers(name, dataset) for name, dataset in datasets.items()],
        "claims": verdicts(judged, next(iter(datasets.values()))),
    }
    title = "Which features depend on the contact stiffness"
    return Section("contact", title, Path(__file__).with_suffix(".html.j2"), content, found[-1])


def sentences(
    datasets: "Mapping[str, xr.Dataset]", judged: Sequence[ClaimOnBases]
) -> tuple[str, ...]:
    """Return the findings on all bases as sentences: by figure, and last on the claims.

    Args:
        datasets: figures on several bases, by name; all on the same bases.
        judged: the claims on them.
    """
    rows = {name: on_bases(dataset) for name, dataset in datasets.items()}
    limit = stiffest(next(iter(datasets.values())))
    figures = [_of_figure(name, each, limit) for name, each in rows.items()]
    return (*figures, _of_claims(judged, limit))


def numbers(name: str, dataset: "xr.Dataset") -> Table:
    """Return the numbers of a figure on each base."""
    columns = (f"{figure_title(name)}: k_a", ">damping ratio", ">aligned", ">in contact",
               ">ends differently", ">difference")  # fmt: skip
    return Table(
        columns,
        [
            (*_base(row), *map(percent, (row.aligned, row.in_contact, row.other_end, row.apart)))
            for row in on_bases(dataset)
        ],
    )


def verdicts(judged: Sequence[ClaimOnBases], dataset: "xr.Dataset") -> Table:
    """Return the sign of each claim's verdict on each base."""
    bases = [f">{stiffness}\n{ratio}" for stiffness, ratio in map(_base, on_bases(dataset))]
    return Table(
        ("k_a, damping ratio", *bases),
        [
            (
                _CLAIM.format(row.claim.id, row.claim.statement, row.claim.id),
                *(SIGNS[finding.verdict] for finding in row.findings),
            )
            for row in judged
        ],
    )


def _base(row: OnBase) -> tuple[str, str]:
    return _stiffness(row.stiffness), f"{row.ratio:.2g}"


def _stiffness(value: float) -> str:
    return f"{value:,.0f}".replace(",", "\N{NARROW NO-BREAK SPACE}")


def _of_figure(name: str, rows: Sequence[OnBase], limit: int) -> str:
    own, stiff = rows[0], rows[limit]
    words = (
        f"{figure_title(name)}: at the device's k_a = {_stiffness(own.stiffness)}, "
        f"{percent(own.other_end)} of the runs end differently from {_stiffness(stiff.stiffness)}"
        f", and durations differ by {percent(own.apart)} in the median: "
    )
    same = own.other_end <= SAME and not own.apart > SAME
    words += f"the figure {'does not depend' if same else 'depends in part'} on the base. "
    settled = settled_from(rows)
    if math.isinf(settled):
        return words + "Some runs still change between the two stiffest bases."
    return words + f"From k_a = {_stiffness(settled)} upward nothing changes visibly."


def _of_claims(judged: Sequence[ClaimOnBases], limit: int) -> str:
    same = [row for row in judged if row.findings[0].verdict == row.findings[limit].verdict]
    other = [row for row in judged if row not in same]
    words = (
        f"Of {len(judged)} claims that these figures can decide, {len(same)} have the same "
        "verdict on the device's base and on the stiffest: they do not depend on it."
    )
    if other:
        changes = ", ".join(
            f"{row.claim.id} ({row.findings[0].verdict}, then {row.findings[limit].verdict})"
            for row in other
        )
        words += f" The others depend on it: {changes}."
    return words
