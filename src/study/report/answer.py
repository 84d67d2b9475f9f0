"""Section at the head of the page: six numbers of the paper's figures, these by figure, one map."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from study.claims import Tables
from study.claims.ledger import Line, read_ledger
from study.claims.regime import Regime, regime_of
from study.config.figures import MAPS
from study.evidence.worth import shown_by
from study.identification.hold_out import summary
from study.report.figures import HEAD, Counts, article, counts_of
from study.report.section import Results, Section, Table, link
from vibralign.plots.words import figure_number, figure_title, percent, short


class Finding(NamedTuple):
    """A number of the answer, and what it is of."""

    number: str
    label: str


def section(results: Results) -> Section:
    """Return the section with the answer."""
    counts = counts_of(results)
    regimes = {
        name: regime_of(Tables.of({name: each.dataset}), name) for name, each in counts.items()
    }
    lines = read_ledger(results.file("claims.csv"))
    reliable = {name: _reliable(results, counts[name]) for name in MAPS}
    goes_in = {name: each.share_of("insertion", "inserted") for name, each in counts.items()}
    findings = [
        _paper(lines, results.dataset("data/null.nc")),
        _contact(lines),
        _first_period(regimes),
        _shares("rests on the edge unless it is vibrated", _resting(regimes)),
        _shares("goes in", goes_in),
        _shares("still aligns if it starts a little differently, where that is tried", reliable),
    ]
    rows = [_row(name, counts[name], regimes[name], goes_in[name]) for name in counts]
    content = {
        "findings": findings,
        "figures": Table(
            ("figure", ">align", ">τ", ">hop", ">one period", ">creep", ">rest", ">go in"), rows),
        "hold_out": summary(),
        "article": article(results, HEAD),
    }  # fmt: skip
    return Section("answer", "The answer", Path(__file__).with_suffix(".html.j2"), content)


def _row(name: str, own: Counts, regime: Regime, goes_in: float) -> Sequence[object]:
    """Return a figure's row: what aligns, and of that what hops, is pushed in, needs vibration."""
    moved = regime.lift_offs, regime.first_period, regime.creeps
    shares = *moved, 1.0 - regime.not_resting, goes_in
    tau = short(float(np.median(own.tau)), 3) if own.tau.size else "–"
    title = link(figure_title(name), f"#{name}")
    return title, percent(own.aligned_share), tau, *map(percent, shares)


def _paper(lines: Sequence[Line], null: xr.Dataset) -> Finding:
    judged = [line.verdict for line in lines if line.verdict != "not checkable"]
    right, wrong = (judged.count(word) for word in ("reproduced", "contradicted"))
    random = shown_by(null)[0].numbers
    label = (
        "claims of the paper reproduced by a device that was searched for; random devices show "
        f"{np.median(random):g} in the median, {random.max()} at most; {wrong} contradicted, the "
        "others in part"
    )
    return Finding(f"{right} of {len(judged)}", label)


def _contact(lines: Sequence[Line]) -> Finding:
    """Return in how many figures the part keeps contact, as the claims N05 to N14 judge it."""
    kept = {line.shown_by: line.verdict for line in lines if line.claim.startswith("N")}
    some = [name for name, verdict in kept.items() if verdict == "reproduced"]
    words = "figures in which nearly every part keeps contact until it aligns"
    return Finding(f"{len(some)} of {len(kept)}", f"{words}{_named(some)}; in the others many hop")


def _first_period(regimes: Mapping[str, Regime]) -> Finding:
    some = [name for name, regime in regimes.items() if regime.first_period > 0.5]
    words = "figures in which most parts align within the first period of the vibration"
    return Finding(f"{len(some)} of {len(regimes)}", f"{words}{_named(some)}")


def _named(figures: Iterable[str]) -> str:
    """Return figures as ": Figs. 7, 11", nothing without any."""
    numbers = ", ".join(str(figure_number(name)) for name in figures)
    return numbers and f": Figs. {numbers}"


def _resting(regimes: Mapping[str, Regime]) -> Mapping[str, float]:
    return {name: 1.0 - regime.not_resting for name, regime in regimes.items()}


def _reliable(results: Results, own: Counts) -> float:
    """Return the share of a map's aligned nodes that align from every start, where all are run."""
    every = results.study.maps.ensemble.every
    aligned = own.aligned[::every, ::every]
    reliable = own.dataset["reliable"].values[aligned] == 1
    return float(reliable.mean()) if reliable.size else np.nan


def _shares(words: str, shares: Mapping[str, float]) -> Finding:
    """Return the least and the greatest share of what aligns in a figure, each with its figure."""
    known = {name: share for name, share in shares.items() if not np.isnan(share)}
    if not known:
        return Finding("–", f"of what aligns {words}")
    low, high = (of(known, key=lambda name: known[name]) for of in (min, max))
    least, most = percent(known[low]).removesuffix(" %"), percent(known[high])
    where = f"(least in {figure_title(low)}, most in {figure_title(high)})"
    return Finding(f"{least} to {most}", f"of what aligns {words} {where}")
