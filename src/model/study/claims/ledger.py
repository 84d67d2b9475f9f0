"""The verdicts on claims: a number, a threshold, a margin."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from model.study.claims.claims import CLAIMS, Claim
from model.study.claims.reading import Data, MissingDataError

if TYPE_CHECKING:
    import xarray as xr

Verdict = Literal["reproduced", "mixed", "contradicted", "not checkable"]
VERDICTS: tuple[Verdict, ...] = ("reproduced", "mixed", "contradicted", "not checkable")


@dataclass(frozen=True)
class Finding:
    """The verdict of the datasets on a claim.

    Attributes:
        value: number of the deciding part, the one with the least margin.
        margin: in [-1, 1] and continuous: the least of the parts' where all are positive, otherwise
            the mean of what the others lack, negative. NaN where the claim is not checkable.
        verdict: "reproduced" (all parts), "contradicted" (no part), "mixed", or "not checkable".
        seen: number of every part, or the missing dataset.
    """

    value: float
    margin: float
    verdict: Verdict
    seen: str


def judge_claim(claim: Claim, data: Data) -> Finding:
    """Return the verdict of ``data`` on one claim."""
    if claim.check is None:
        return Finding(math.nan, math.nan, "not checkable", claim.limit.reason)
    try:
        parts = claim.check(data, claim.figures)
    except MissingDataError as missing:
        return Finding(math.nan, math.nan, "not checkable", f"{missing}")
    margins = [claim.limit.margin(part.value) for part in parts]
    lacking = [max(0.0, -margin) for margin in margins]
    holding = sum(margin > 0.0 for margin in margins)
    verdict: Verdict = "mixed"
    if holding == len(parts):
        verdict = "reproduced"
    elif holding == 0:
        verdict = "contradicted"
    margin = min(margins) if verdict == "reproduced" else -sum(lacking) / len(parts)
    worst = parts[margins.index(min(margins))]
    seen = "; ".join(
        f"{where}: {_shown(value)}" if where else _shown(value) for where, value in parts
    )
    return Finding(worst.value, margin, verdict, seen)


def _shown(value: float) -> str:
    return "nothing to measure" if math.isnan(value) else f"{value:.3g}"


def judge(datasets: "Mapping[str, xr.Dataset]") -> tuple[tuple[Claim, Finding], ...]:
    """Return every claim of the paper with its verdict.

    Args:
        datasets: by name: of figures ("fig06", as in ``data/fig06.nc``) and of the ledger's own
            runs ("pressed", as in ``data/claims/pressed.nc``), of any grid. A claim whose dataset
            is missing is not checkable.
    """
    data = Data(datasets)
    return tuple((claim, judge_claim(claim, data)) for claim in CLAIMS)


def tally(verdicts: Sequence[str]) -> str:
    """Return the number of claims with each verdict, in one line."""
    return ", ".join(f"{name} {list(verdicts).count(name)}" for name in VERDICTS)
