"""Section at the head of the page: the answer in six numbers, a table of these, and one figure."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from model.events.outcomes import Outcome
from model.show.report.figures import HEAD, Counts, article, counts_of
from model.show.report.section import Results, Section, Table
from model.show.words import figure_title, percent, short
from model.study.claims.ledger import Line, read_ledger
from model.study.config.figures import HISTORIES
from model.study.evidence.worth import shown_by


class Finding(NamedTuple):
    """A number of the answer: what it is of, and its least and largest over the figures."""

    number: str
    label: str
    least: str = ""
    most: str = ""


def section(results: Results) -> Section:
    """Return the section with the answer."""
    counts = {name: of for name, of in counts_of(results).items() if name not in HISTORIES}
    dataset = results.dataset(f"data/{HEAD}.nc")
    every = results.study.maps.ensemble.every
    aligned = dataset["outcome"].values[::every, ::every] == Outcome.ALIGNED
    starts = dataset["start_outcome"][0, 0].size
    findings = [
        _aligned(counts),
        _duration(counts),
        _share(
            float((dataset["reliable"].values[aligned] == 1).mean()) if aligned.any() else np.nan,
            f"of what aligns in {figure_title(HEAD)} aligns from each of {starts} starts",
        ),
        _of_aligned(counts, "unvibrated", "rests", "rests on the edge unless it is vibrated"),
        _of_aligned(counts, "insertion", "inserted", "goes in"),
        _paper(read_ledger(results.file("claims.csv")), results.dataset("data/null.nc")),
    ]
    known = [finding for finding in findings if finding is not None]
    content = {
        "findings": known,
        "spread": Table((">", "", "least in a figure", "most"), [f for f in known if f.least]),
        "article": article(results, HEAD),
    }
    return Section("answer", "The answer", Path(__file__).with_suffix(".html.j2"), content)


def _share(share: float, label: str, shares: Mapping[str, float] | None = None) -> Finding | None:
    """Return a finding on a share, None if it is unknown; ``shares`` are those of the figures."""
    if np.isnan(share):
        return None
    ends = () if shares is None else _ends(shares)
    return Finding(percent(share), label, *ends)


def _ends(shares: Mapping[str, float]) -> tuple[str, str]:
    """Return the smallest and the largest share, each with its figure."""
    low, high = (of(shares, key=lambda name: shares[name]) for of in (min, max))
    least, most = (f"{percent(shares[each])} ({figure_title(each)})" for each in (low, high))
    return least, most


def _aligned(counts: Mapping[str, Counts]) -> Finding | None:
    runs = sum(each.runs for each in counts.values())
    aligned = sum(each.number_of(Outcome.ALIGNED) for each in counts.values())
    shares = {name: each.aligned_share for name, each in counts.items()}
    return _share(aligned / runs, f"of {runs:,} parameter sets align", shares)


def _duration(counts: Mapping[str, Counts]) -> Finding | None:
    tau = np.concatenate([each.tau for each in counts.values()])
    if not tau.size:
        return None
    low, middle, high = (short(time) for time in np.quantile(tau, (0.05, 0.5, 0.95)))
    label = f"alignment duration, median; of nine in ten, {low} to {high}"
    return Finding(f"τ = {middle}", label)


def _of_aligned(
    counts: Mapping[str, Counts], variable: str, meaning: str, words: str
) -> Finding | None:
    """Return the share of all aligned runs with a flag."""
    known = {name: each.share_of(variable, meaning) for name, each in counts.items()}
    shares = {name: share for name, share in known.items() if not np.isnan(share)}
    if not shares:
        return None
    weights = [counts[name].number_of(Outcome.ALIGNED) for name in shares]
    share = float(np.average([*shares.values()], weights=weights))
    return _share(share, f"of what aligns {words}", shares)


def _paper(lines: Sequence[Line], null: xr.Dataset) -> Finding:
    judged = [line.verdict for line in lines if line.verdict != "not checkable"]
    right, wrong = (judged.count(word) for word in ("reproduced", "contradicted"))
    random = shown_by(null)[0].numbers
    label = (
        f"claims of the paper reproduced, where random devices show {random.min()} to "
        f"{random.max()}; {wrong} contradicted, the others in part"
    )
    return Finding(f"{right} of {len(judged)}", label)
