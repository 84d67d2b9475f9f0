"""Section on the ledger: what the paper says, judged, beside what other devices show."""

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from study.claims import CLAIMS, VERDICTS, tally
from study.claims.ledger import Line, read_ledger
from study.evidence.cases import KINDS
from study.evidence.null import SHOWN
from study.report.section import Results, Section, Table, link, subscripts
from vibralign.plots.words import figure_title, number, percent

SIGNS: Mapping[str, str] = dict(zip(VERDICTS, ("✓", "✗", "–"), strict=True))
_CLAIM = {claim.id: claim for claim in CLAIMS}


def section(results: Results) -> Section:
    """Return the section on the paper's statements and their verdicts."""
    lines, cases = read_ledger(results.file("claims.csv")), results.dataset("data/cases.nc")
    totals, beside = _beside(lines, cases, _halves(results))
    content = {
        "tally": tally([line.verdict for line in lines]),
        "totals": totals,
        "beside": beside,
        "until": number(results.study.evidence.grid.horizon),
        "counts": _counts(cases),
        "assumptions": _assumptions(cases),
        "entries": [
            (line, _CLAIM[line.claim].reading, _parts(line), _sources(line)) for line in lines
        ],
        "shared": _shared(),
        "signs": SIGNS,
        "files": [("the ledger (CSV)", "claims.csv"), ("other cases (netCDF)", "data/cases.nc")],
    }
    template = Path(__file__).with_suffix(".html.j2")
    return Section("claims", "What the paper says, judged", template, content)


def _halves(results: Results) -> dict[str, list[str]]:
    """Return the searches that judge by a part of the entries, each with this part."""
    searches = results.study.identification.searches
    return {name: each.entries for name, each in searches.items() if each.entries is not None}


class Half(NamedTuple):
    """Numbers of entries that a device shows of those its search judged by, and of the others."""

    unseen: int  # of the others
    of_unseen: int
    seen: int  # of those that judged
    of_seen: int
    random: float  # of the others, by random devices in the mean


def held_out(results: Results, lines: list[Line]) -> Half | None:
    """Return what the device shows whose search judged by a part of the entries, None without."""
    cases = results.dataset("data/cases.nc")
    titles = cases["case"].values.tolist()
    for name, judged in _halves(results).items():
        if name in titles:
            is_shown = cases["verdict"].values[titles.index(name)] == SHOWN
            seen = np.isin(cases["entry"].values, judged)
            random = sum(line.random for line in lines if line.claim not in judged)
            shown = int(is_shown[~seen].sum()), int(is_shown[seen].sum())
            return Half(shown[0], int((~seen).sum()), shown[1], int(seen.sum()), random)
    return None


def count(lines: list[Line]) -> int:
    """Return how many entries are shown."""
    return sum(line.verdict == "shown" for line in lines)


def _sources(line: Line) -> list[tuple[str, str]]:
    """Return words and addresses of the figures by which an entry is judged, at most three."""
    named = [name for name in _CLAIM[line.claim].figures if name.startswith("fig")]
    if len(named) > 3:
        return [("Figs. 5 to 12", "#figures")]
    return [(figure_title(name), f"#{name}") for name in named] or [("Figs. 5 to 12", "#figures")]


def _parts(line: Line) -> list[tuple[str, str, str]]:
    """Return of each part: the measure with its numbers, the demand, and its reason."""
    seen = dict(each.split(": ", 1) for each in line.seen.split("; ") if ": " in each)
    fails = line.fails.split("; ")
    return [
        (
            f"{'✗ ' if part in fails else ''}{limit.measure}: {seen.get(part, 'not checkable')}",
            limit.demand,
            f"“{limit.shared}”" if limit.shared else limit.reason,
        )
        for part, limit in _CLAIM[line.claim].limits.items()
    ]


def _shared() -> Table:
    """List the limits that several parts share, with their reasons."""
    named = {each.shared: each for claim in CLAIMS for each in claim.limits.values()}
    rows = [(name, each.demand, each.reason) for name, each in named.items() if name]
    return Table(("limit", "must be", "since"), rows)


def _beside(lines: list[Line], cases: xr.Dataset, without: Collection[str]) -> tuple[Table, Table]:
    """List by entry the verdict of the figures, and those of cases on the grid of random devices.

    These are the device and those of other searches but some, under both starts. A table before
    counts entries, and those of conclusions.
    """
    heads = {}
    for row, title in enumerate(cases["case"].values.tolist()):
        name, _, start = title.partition(", ")
        kind = KINDS[cases["kind"].values[row]]
        if kind == "device":
            heads[row] = "ours"
        elif kind == "assumption" and name == "first the press":
            heads[row] = "ours,\npressed first"
        elif kind == "other" and name not in without:
            heads[row] = f"{name},\n{start}" if start else name
    chosen = [*heads]
    verdicts = cases["verdict"].values[chosen]
    rows: list[tuple[object, ...]] = [
        (
            link(line.claim, f"#claim-{line.claim}"),
            subscripts(line.says),
            SIGNS[line.verdict],
            *(SIGNS[VERDICTS[verdict]] for verdict in column),
            percent(line.random),
        )
        for line, column in zip(lines, verdicts.T, strict=True)
    ]
    totals: list[tuple[object, ...]] = []
    ends = [_CLAIM[line.claim].is_conclusion for line in lines]
    for words, kept in (("all", np.ones(len(lines), bool)), ("of conclusions", np.array(ends))):
        own = count([line for line, keep in zip(lines, kept, strict=True) if keep])
        shown = (verdicts[:, kept] == SHOWN).sum(axis=1).tolist()
        totals.append((f"{words} ({int(kept.sum())})", own, *shown))
    columns = (">our figures", *(f">{head}" for head in heads.values()))
    return (
        Table(("entries shown", *columns), totals),
        Table(("entry", "the paper says", *columns, ">random"), rows),
    )


def _counts(cases: xr.Dataset) -> Table:
    """List how many entries devices show on one grid: ours, off by a little, random ones."""
    shown = (cases["verdict"].values == SHOWN).sum(axis=1)
    kinds = np.array([KINDS[kind] for kind in cases["kind"].values])
    own, near = shown[kinds == "device"], shown[kinds == "near"]
    rows = [
        (words, each.size, each.min(), f"{np.median(each):g}", each.max())
        for words, each in (
            ("our device, on the same grid", own),
            ("the same, every unknown off by 5 %", near),
            ("random devices", cases["random"].values),
        )
    ]
    return Table(("", ">devices", ">entries: least", ">median", ">most"), rows)


def _assumptions(cases: xr.Dataset) -> Table:
    """List the entries that turn under each assumption; the study's own first."""
    shown = cases["verdict"].values == SHOWN
    entries = cases["entry"].values
    rows = [
        (
            title,
            int(shown[row].sum()),
            " ".join(entries[shown[0] & ~shown[row]]),
            " ".join(entries[shown[row] & ~shown[0]]),
        )
        for row, title in enumerate(cases["case"].values)
        if KINDS[cases["kind"].values[row]] in ("device", "assumption")
    ]
    return Table(("", ">entries", "no longer shown", "shown instead"), rows)
