"""What a claim of the paper is, and how it is judged: a number, a threshold, a verdict.

A claim may speak of several curves: its check then gives a number for each, all on one scale, and
the claim is reproduced where all of them are on the right side of the threshold. Thresholds are set
by what the sentence says and by what can be seen in a printed figure, never by what comes out.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple

from model.study.claims.limits import Limit
from model.study.claims.reading import Curve, Data, MissingDataError

if TYPE_CHECKING:
    import xarray as xr

Kind = Literal["stated in figure text", "conclusion", "interpretation"]
Verdict = Literal["reproduced", "mixed", "contradicted", "not checkable"]
VERDICTS: tuple[Verdict, ...] = ("reproduced", "mixed", "contradicted", "not checkable")


class Part(NamedTuple):
    """What was seen of one part of a claim: ``where``, such as "k_φ = 5", and the number.

    NaN says that what the paper describes is not there to be measured, as the duration of a part
    that never aligns: that contradicts the claim as far as it goes.
    """

    where: str
    value: float


Check = Callable[[Data], Sequence[Part]]


@dataclass(frozen=True)
class Claim:
    """One statement of the paper.

    Attributes:
        id: such as "F6a".
        place: where it stands.
        kind: whether it is said of a figure, concluded, or how an unclear sentence is understood.
        statement: the paper's words, shortened.
        figures: figures and own runs of the ledger that it is judged by; the first shows it.
        measure: what the number is, in words.
        limit: what the number must reach, and why.
        check: the number of each part; None where nothing can be measured.
    """

    id: str
    place: str
    kind: Kind
    statement: str
    figures: tuple[str, ...]
    measure: str
    limit: Limit
    check: Check | None


@dataclass(frozen=True)
class Finding:
    """What the datasets say of a claim.

    Attributes:
        value: the number of the part that decides, the one with the least margin.
        threshold: that of the claim.
        margin: in [-1, 1] and continuous: the least of the parts' where all are positive, otherwise
            the mean of what the others lack, negative. NaN where the claim is not checkable.
        verdict: "reproduced" (all parts), "contradicted" (no part), "mixed", or "not checkable".
        seen: the number of every part, or what is missing.
    """

    value: float
    threshold: float
    margin: float
    verdict: Verdict
    seen: str


def labelled(symbol: str, curve: Curve, value: float) -> Part:
    """A part named by its curve."""
    return Part(f"{symbol} = {curve.at:g}", value)


def judge_claim(claim: Claim, data: Data) -> Finding:
    """What ``data`` say of one claim."""
    if claim.check is None:
        return Finding(
            math.nan, claim.limit.threshold, math.nan, "not checkable", claim.limit.reason
        )
    try:
        parts = claim.check(data)
    except MissingDataError as missing:
        return Finding(math.nan, claim.limit.threshold, math.nan, "not checkable", f"{missing}")
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
    return Finding(worst.value, claim.limit.threshold, margin, verdict, seen)


def _shown(value: float) -> str:
    return "nothing to measure" if math.isnan(value) else f"{value:.3g}"


def judge_all(
    claims: Sequence[Claim], datasets: "Mapping[str, xr.Dataset]"
) -> tuple[tuple[Claim, Finding], ...]:
    """Each claim with what the datasets say of it.

    Args:
        claims: the ledger, or a part of it.
        datasets: by name, as in ``Claim.figures``: the figures' and those of the ledger's own runs.
            A claim whose dataset is missing is not checkable.
    """
    data = Data(datasets)
    return tuple((claim, judge_claim(claim, data)) for claim in claims)


def tally(verdicts: Sequence[str]) -> str:
    """How many claims have which verdict, in one line."""
    return ", ".join(f"{name} {list(verdicts).count(name)}" for name in VERDICTS)
