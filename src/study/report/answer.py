"""Section at the head of the page: the answer in a sentence, numbers, six figures, one map."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from study.claims import CLAIMS, figure_of
from study.claims.ledger import Line, read_ledger
from study.claims.regime import Regime, regime_of
from study.evidence.cases import KINDS
from study.evidence.null import SHOWN
from study.report.figures import HEAD, Counts, article, counts_of
from study.report.ledger import SIGNS, count, held_out
from study.report.section import Results, Section, Table, link
from vibralign.plots.words import figure_number, figure_title, percent, short

_SHOWN = 3  # figures that read most, and least, like the paper
_STRAYS = 0.05  # share of parts up to which nearly every part does otherwise
_SEEN = 0.005  # from which a share is not printed as none
_CLAIM = {claim.id: claim for claim in CLAIMS}


class Finding(NamedTuple):
    """A number of the answer, and what it is of."""

    number: str
    label: str


class Read(NamedTuple):
    """A figure, and what the paper says of it, each statement with the sign of its verdict."""

    name: str
    title: str
    aligned: float  # share of its points
    said: list[tuple[str, str]]

    @property
    def shown(self) -> float:
        """Share of the statements that are shown."""
        return [sign for sign, _ in self.said].count(SIGNS["shown"]) / len(self.said)


def section(results: Results) -> Section:
    """Return the section with the answer."""
    counts = counts_of(results)
    regimes = {name: regime_of(figure_of(each.dataset)) for name, each in counts.items()}
    lines = read_ledger(results.file("claims.csv"))
    reliable = {name: _reliable(results, counts[name]) for name in results.study.named("map")}
    goes_in = {name: each.inserted_share for name, each in counts.items()}
    resting = {name: 1.0 - regime.not_resting for name, regime in regimes.items()}
    of = [line for line in lines if _CLAIM[line.claim].is_conclusion]
    findings = [
        _paper(lines, results.dataset("data/cases.nc")),
        Finding(f"{count(of)} of {len(of)}", "statements of the numbered conclusions shown"),
        _counted(
            "nearly every part keeps contact until it aligns",
            regimes,
            lambda regime: regime.lift_offs <= _STRAYS,
            "; the paper, as we read its “non-impact regime”: in all",
        ),
        _counted(
            "most parts align within the first period of the vibration",
            regimes,
            lambda regime: regime.first_period > 0.5,
        ),
        _shares("rests on the edge unless it is vibrated", resting),
        _going_in(counts, goes_in),
        _shares("still aligns if it starts a little differently, where that is tried", reliable),
    ]
    rows = [_row(name, counts[name], regimes[name], goes_in[name]) for name in counts]
    figures = _figures(lines, counts)
    content = {
        "answer": _plainly(results, counts),
        "findings": findings,
        "half": held_out(results, lines),
        "alike": sorted(figures, key=lambda it: (-it.shown, -len(it.said)))[:_SHOWN],
        "unlike": sorted(figures, key=lambda it: (it.shown, -len(it.said)))[:_SHOWN],
        "creeps_alone": " and ".join(
            f"{percent(regime.creeps_static)} in {figure_title(name)}"
            for name, regime in regimes.items() if regime.creeps_static >= _SEEN
        ),
        "figures": Table(
            ("figure", ">align", ">τ", ">hop", ">one period", ">creep", ">rest", ">go in"), rows),
        "article": article(results, HEAD),
    }  # fmt: skip
    return Section("answer", "The answer", Path(__file__).with_suffix(".html.j2"), content)


def _plainly(results: Results, counts: Mapping[str, Counts]) -> str:
    """Return when, how fast and how safely a part aligns, by the maps and by all that aligns."""
    of_maps = np.concatenate([counts[name].tau for name in results.study.named("map")])
    if not of_maps.size:
        return "No part aligns."
    tau = float(np.median(of_maps))
    every = sum(own.tau.size for own in counts.values())
    lost = sum(own.lost for own in counts.values())
    return (
        "The stiffer its tilt spring, the harder our part can be pressed and still align; it then "
        f"takes {short(tau / (2.0 * np.pi))} natural periods along the axis in the median "
        f"(τ = {short(tau, 3)}), and all but {lost:,} of the {every:,} that align go in."
    )


def _row(name: str, own: Counts, regime: Regime, goes_in: float) -> Sequence[object]:
    """Return a figure's row: what aligns, and of that what hops, is pushed in, needs vibration."""
    moved = regime.lift_offs, regime.first_period, regime.creeps
    shares = *moved, 1.0 - regime.not_resting, goes_in
    tau = short(float(np.median(own.tau)), 3) if own.tau.size else "–"
    title = link(figure_title(name), f"#{name}")
    return title, percent(own.aligned_share), tau, *map(percent, shares)


def _paper(lines: list[Line], cases: xr.Dataset) -> Finding:
    random, own = cases["random"].values, cases["kind"].values == KINDS.index("device")
    on_grid = (cases["verdict"].values[own] == SHOWN).sum()
    label = (
        "statements of the paper shown, by a device that was searched for by this very list: "
        f"{on_grid} on the coarse grid on which random devices show {np.median(random):g} "
        f"in the median, {random.max()} at most"
    )
    return Finding(f"{count(lines)} of {len(lines)}", label)


def _figures(lines: list[Line], counts: Mapping[str, Counts]) -> list[Read]:
    """Return the figures with their own statements.

    These are the entries that are judged by one figure or two, and the parts of others that name
    Fig. 5 alone.
    """
    own: dict[str, list[tuple[str, str]]] = {}
    for line in lines:
        claim = _CLAIM[line.claim]
        for name in claim.figures if len(claim.figures) < 3 else ():
            own.setdefault(name, []).append((SIGNS[line.verdict], _said(line)))
        for part, limit in claim.limits.items():
            if "Fig. 5" in limit.measure:
                fails = line.verdict != "shown" and part in line.fails.split("; ")
                verdict = "not shown" if fails else "shown"
                own.setdefault("fig05", []).append((SIGNS[verdict], line.says))
    return [
        Read(name, figure_title(name), counts[name].aligned_share, own[name])
        for name in counts if name in own
    ]  # fmt: skip


def _said(line: Line) -> str:
    """Return an entry's words; where they are read loosely, how."""
    reading = _CLAIM[line.claim].reading
    return f"{line.says} (read {reading.partition(':')[0]})" if "loosely" in reading else line.says


def _counted(
    words: str, regimes: Mapping[str, Regime], flag: Callable[[Regime], bool], more: str = ""
) -> Finding:
    """Return in how many figures something is so, with these figures, and what else to say."""
    some = [name for name, regime in regimes.items() if flag(regime)]
    named = f": Figs. {', '.join(str(figure_number(name)) for name in some)}" if some else ""
    label = f"of our figures in which {words}{named}{more}"
    return Finding(f"{len(some)} of {len(regimes)}", label)


def _reliable(results: Results, own: Counts) -> float:
    """Return the share of a map's aligned nodes that align from every start, where all are run."""
    every = results.study.maps.ensemble.every
    aligned = own.aligned[::every, ::every]
    reliable = own.dataset["reliable"].values[aligned] == 1
    return float(reliable.mean()) if reliable.size else np.nan


def _going_in(counts: Mapping[str, Counts], shares: Mapping[str, float]) -> Finding:
    """Return the range of the shares that go in, with every figure in which some do not."""
    lost = [
        f"{own.lost:,} of {own.tau.size:,} in {figure_title(name)}"
        for name, own in counts.items() if own.lost
    ]  # fmt: skip
    where = f": all but {', '.join(lost)}" if lost else ""
    return Finding(_span(shares), f"of what aligns goes in{where}")


def _span(shares: Mapping[str, float]) -> str:
    """Return the least and the greatest share, "–" if none is known."""
    known = [share for share in shares.values() if not np.isnan(share)]
    if not known:
        return "–"
    low, high = percent(min(known)), percent(max(known))
    return high if low == high else f"{low.removesuffix(' %')} to {high}"


def _shares(words: str, shares: Mapping[str, float]) -> Finding:
    """Return the least and the greatest share of what aligns in a figure, each with its figure.

    A figure is named only if no other has its share.
    """
    seen = {name: percent(share) for name, share in shares.items() if not np.isnan(share)}
    known = {name: share for name, share in shares.items() if name in seen}
    ends = []
    for which, of in (("least", min), ("most", max)) if known else ():
        name = of(known, key=lambda each: known[each])
        if [*seen.values()].count(seen[name]) == 1:
            ends.append(f"{which} in {figure_title(name)}")
    where = f" ({', '.join(ends)})" if ends else ""
    return Finding(_span(shares), f"of what aligns {words}{where}")
