"""The claims ledger: what the paper says, and what the datasets say of it.

``ledger`` holds what a claim is and how it is judged, ``reading`` how checks read datasets,
``mechanism``, ``durations``, ``stiffness`` and ``areas`` the claims by subject, ``runs`` the
trajectories that the ledger needs beside the figures', ``table`` what is written to disk.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from model.study.claims.areas import AREAS
from model.study.claims.durations import FIGURE_6, FIGURE_7, FIGURE_12, FIGURES_10_11
from model.study.claims.ledger import VERDICTS, Claim, Finding, Part, judge_all, tally
from model.study.claims.mechanism import HISTORY, MECHANISM
from model.study.claims.stiffness import FIGURE_8, FIGURE_9

if TYPE_CHECKING:
    import xarray as xr

CLAIMS: tuple[Claim, ...] = (
    *MECHANISM,
    *HISTORY,
    *FIGURE_6,
    *FIGURE_7,
    *FIGURE_8,
    *FIGURE_9,
    *FIGURES_10_11,
    *FIGURE_12,
    *AREAS,
)


def judge(datasets: "Mapping[str, xr.Dataset]") -> tuple[tuple[Claim, Finding], ...]:
    """Every claim of the paper with what the datasets say of it.

    Args:
        datasets: by name: of figures ("fig06", as in ``data/fig06.nc``) and of the ledger's own
            runs ("pressed", as in ``data/claims/pressed.nc``), of whatever grid. A claim whose
            dataset is missing is not checkable.
    """
    return judge_all(CLAIMS, datasets)


__all__ = ["CLAIMS", "VERDICTS", "Claim", "Finding", "Part", "judge", "tally"]
