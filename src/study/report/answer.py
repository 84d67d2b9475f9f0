"""Section at the head of the page: the ledger in two numbers, four of the figures, one map."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from study.claims import CLAIMS, figure_of
from study.claims.ledger import Line, read_ledger
from study.claims.regime import Regime, regime_of
from study.report.figures import HEAD, Counts, article, counts_of
from study.report.ledger import SIGNS, conclusions, count, held_out
from study.report.section import Results, Section, Table, link
from vibralign.plots.words import figure_number, figure_title, percent, short

_SHOWN = 3  # figures that read most, and least, like the paper


class Finding(NamedTuple):
    """A number of the answer, and what it is of."""

    number: str
    label: str


class Read(NamedTuple):
    """A figure, and what the paper says of it, each statement with the sign of its verdict."""

    name: str
    title: str
    said: list[tuple[str, str]]


def section(results: Results) -> Section:
    """Return the section with the answer."""
    counts = counts_of(results)
    regimes = {name: regime_of(figure_of(each.dataset)) for name, each in counts.items()}
    lines = read_ledger(results.file("claims.csv"))
    reliable = {name: _reliable(results, counts[name]) for name in results.study.named("map")}
    goes_in = {name: each.inserted_share for name, each in counts.items()}
    of = conclusions(lines)
    findings = [
        _paper(lines, results.dataset("data/cases.nc")["random"].values),
        Finding(f"{count(of)} of {len(of)}", "statements of the numbered conclusions shown"),
        _contact(regimes),
        _first_period(regimes),
        _shares("rests on the edge unless it is vibrated", _resting(regimes)),
        _shares("goes in", goes_in),
        _shares("still aligns if it starts a little differently, where that is tried", reliable),
    ]
    rows = [_row(name, counts[name], regimes[name], goes_in[name]) for name in counts]
    ranked = _ranked(lines)
    content = {
        "findings": findings,
        "held_out": held_out(results),
        "alike": ranked[:_SHOWN],
        "unlike": ranked[-_SHOWN:],
        "figures": Table(
            ("figure", ">align", ">τ", ">hop", ">one period", ">creep", ">rest", ">go in"), rows),
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


def _paper(lines: list[Line], random: NDArray[np.int8]) -> Finding:
    label = (
        "statements of the paper shown, by a device that was searched for by this very list; "
        f"random devices show {np.median(random):g} in the median, {random.max()} at most"
    )
    return Finding(f"{count(lines)} of {len(lines)}", label)


def _ranked(lines: list[Line]) -> list[Read]:
    """Return the figures with two entries of their own or more, those most like the paper first."""
    figures = {claim.id: claim.figures for claim in CLAIMS}
    own: dict[str, list[Line]] = {}
    for line in lines:
        for name in figures[line.claim] if len(figures[line.claim]) < 3 else ():
            own.setdefault(name, []).append(line)
    ranked = sorted(
        (name for name, said in own.items() if len(said) > 1 and name.startswith("fig")),
        key=lambda name: (-count(own[name]) / len(own[name]), name),
    )
    return [
        Read(name, figure_title(name), [(SIGNS[each.verdict], each.says) for each in own[name]])
        for name in ranked
    ]


def _contact(regimes: Mapping[str, Regime]) -> Finding:
    """Return in how many figures nearly every part keeps contact, to a twentieth."""
    some = [name for name, regime in regimes.items() if regime.lift_offs <= 0.05]
    words = "of our figures in which nearly every part keeps contact until it aligns"
    return Finding(f"{len(some)} of {len(regimes)}", f"{words}{_named(some)}; the paper: in all")


def _first_period(regimes: Mapping[str, Regime]) -> Finding:
    some = [name for name, regime in regimes.items() if regime.first_period > 0.5]
    words = "of our figures in which most parts align within the first period of the vibration"
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
