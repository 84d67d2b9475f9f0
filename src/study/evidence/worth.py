"""The ledger weighed: how many random devices show a claim, and the evidence in bits."""

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from study.claims.ledger import Line
from study.evidence.null import REPRODUCED

if TYPE_CHECKING:
    import xarray as xr

NEARLY_ANY = 0.8  # share of random devices from which nearly any shows a claim


class Shown(NamedTuple):
    """Numbers of claims that the draws of a kind reproduce, and their evidence, shape (draws,)."""

    title: str
    numbers: NDArray[np.int64]
    bits: NDArray[np.float64]


def shown_by(null: "xr.Dataset") -> list[Shown]:
    """Return how many claims the draws of each kind reproduce, in the order of the kinds."""
    of_draw, titles = null["kind_of_draw"].values, null["title"].values
    verdicts = [null["verdict"].values[of_draw == place] for place in range(len(titles))]
    return [_shown(str(title), of, null) for title, of in zip(titles, verdicts, strict=True)]


def shown_by_own(null: "xr.Dataset", assumptions: "xr.Dataset") -> Shown:
    """Return the same of the study's device, on the grid of the draws."""
    own = assumptions["verdict"].values[:1]
    return _shown("the study's device, on the same grid", own, null)


def _shown(title: str, verdicts: NDArray[np.int8], null: "xr.Dataset") -> Shown:
    draws = int(np.count_nonzero(null["kind_of_draw"].values == 0))
    worth = np.array([bits(share, draws) for share in null["share"].values[0].tolist()])
    shown = verdicts == REPRODUCED
    return Shown(title, shown.sum(axis=1), shown @ worth)


def bits(share: float, draws: int) -> float:
    """Return the evidence of a reproduced claim, -log2 of the share of random devices that show it.

    A share below one draw cannot be told from one draw.
    """
    return math.log2(1.0 / max(share, 1.0 / draws))


def weighed(lines: Iterable[Line], null: "xr.Dataset") -> list[Line]:
    """Return rows of the ledger with the shares of the first two kinds of draws, and the evidence.

    The evidence is by the first kind; a claim that is not reproduced has none.
    """
    devices, points = (null["share"].isel(kind=place).to_series() for place in (0, 1))
    draws = int((null["kind_of_draw"] == 0).sum())
    rows = []
    for line in lines:
        share, of_points = devices.get(line.claim, math.nan), points.get(line.claim, math.nan)
        known = line.demand != "" and not math.isnan(share)
        shown = known and line.verdict == "reproduced"
        rows.append(
            replace(
                line,
                random_devices=f"{share:.3f}" if known else "",
                random_points=f"{of_points:.3f}" if known else "",
                bits=f"{bits(share, draws):.2f}" if shown else "",
            )
        )
    return rows


def evidence(lines: Iterable[Line]) -> float:
    """Return the evidence of all reproduced claims in bits, as if each stood for itself."""
    return sum(float(line.bits) for line in lines if line.bits)


def is_shown_by_nearly_any(line: Line) -> bool:
    """Return whether nearly any random device shows a claim."""
    return line.random_devices != "" and float(line.random_devices) >= NEARLY_ANY


def summary(lines: Iterable[Line], null: "xr.Dataset") -> str:
    """Return the ledger in a sentence: reproduced claims, and what random devices show of them."""
    judged = [line for line in lines if line.demand]
    own = sum(line.verdict == "reproduced" for line in judged)
    random = shown_by(null)[0].numbers
    trivial = sum(is_shown_by_nearly_any(each) for each in judged if each.bits)
    return (
        f"{own} of {len(judged)} reproduced, where {random.size} random devices show "
        f"{random.min()} to {random.max()} (median {np.median(random):g}); nearly any of them "
        f"shows {trivial} of the {own}. The evidence is {evidence(judged):.0f} bits."
    )
