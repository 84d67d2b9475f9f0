"""Section at the head of the page: the answer in a few sentences, six numbers and one figure."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from model.events.outcomes import OUTCOME_TEXT, Outcome
from model.show.report.figures import HEAD, Counts, article, counts_of
from model.show.report.section import Results, Section
from model.show.words import figure_title, percent, short
from model.study.claims.ledger import Line, read_ledger
from model.study.config.figures import HISTORIES

_CONCLUSION = re.compile(r"concl\. (\d+)")


@dataclass(frozen=True)
class Finding:
    """A number of the answer, with its label, the question and a sentence that explains it."""

    number: str
    label: str
    question: str
    sentence: str


def section(results: Results) -> Section:
    """Return the section with the answer."""
    counts = {name: of for name, of in counts_of(results).items() if name not in HISTORIES}
    findings = (
        _aligned(counts),
        _duration(counts),
        _reliable(results),
        _vibration(counts),
        _inserted(counts),
        _paper(read_ledger(results.file("claims.csv"))),
    )
    content = {
        "findings": [finding for finding in findings if finding is not None],
        "article": article(results, HEAD),
    }
    return Section("answer", "The answer", Path(__file__).with_suffix(".html.j2"), content)


def _aligned(counts: Mapping[str, Counts]) -> Finding:
    runs = sum(each.runs for each in counts.values())
    aligned = sum(each.number_of(Outcome.ALIGNED) for each in counts.values())
    shares = {name: each.aligned_share for name, each in counts.items()}
    sentence = f"Of the runs of a figure {_by_figure(shares)} align."
    failing = {end: sum(each.number_of(end) for each in counts.values()) for end in Outcome}
    del failing[Outcome.ALIGNED]
    if aligned < runs:
        usual = max(failing, key=lambda end: failing[end])
        share = percent(failing[usual] / (runs - aligned))
        sentence += f" Of those that do not, {share} end so: {OUTCOME_TEXT[usual]}."
    label = f"of {runs:,} parameter sets align"
    return Finding(percent(aligned / runs), label, "What aligns", sentence)


def _duration(counts: Mapping[str, Counts]) -> Finding | None:
    tau = np.concatenate([each.tau for each in counts.values()])
    if not tau.size:
        return None
    frequency = np.concatenate([
        np.broadcast_to(_along(each, "frequency"), each.aligned.shape)[each.aligned]
        for each in counts.values()
    ])  # fmt: skip
    low, middle, high = (short(time) for time in np.quantile(tau, (0.05, 0.5, 0.95)))
    periods = short(float(np.median(tau * frequency)) / (2.0 * np.pi))
    sentence = (
        f"Nine in ten of the parts that align take τ = {low} to {high}, in units of the inverse "
        f"natural frequency along the axis; in the median {middle}, or {periods} periods of the "
        "excitation."
    )
    return Finding(f"τ = {middle}", "alignment duration, median", "How fast", sentence)


def _along(counts: Counts, name: str) -> np.ndarray:
    """Return a parameter's values in a shape that broadcasts over the runs."""
    values, dims = counts.dataset[name], counts.dataset["outcome"].dims
    return np.reshape(values.values, [-1 if each in values.dims else 1 for each in dims])


def _reliable(results: Results) -> Finding | None:
    dataset = results.dataset(f"data/{HEAD}.nc")
    starts, every = dataset["start_outcome"][0, 0].size, results.study.maps.ensemble.every
    aligned = dataset["outcome"].values[::every, ::every] == Outcome.ALIGNED
    if not aligned.any():
        return None
    share = float((dataset["reliable"].values[aligned] == 1).mean())
    sentence = (
        f"Phase of the vibration and tilt at touch-down cannot be controlled. {percent(share)} of "
        f"the area that aligns in {figure_title(HEAD)} aligns from each of {starts} such starts: "
        "there it is reliable. Elsewhere it depends on the start."
    )
    label = f"of what aligns in {figure_title(HEAD)} aligns from every start"
    return Finding(percent(share), label, "How safely", sentence)


def _vibration(counts: Mapping[str, Counts]) -> Finding | None:
    rest, alone = (_of_aligned(counts, "unvibrated", end) for end in ("rests", "aligns"))
    if rest is None or alone is None:
        return None
    sentence = (
        f"Pressed without vibration, {rest[0]} of the parts that align rest on the edge: vibration "
        f"aligns them. {alone[0]} align by the press alone, and the others topple or leave. Of "
        f"those of a figure, {rest[1]} rest."
    )
    label = "of what aligns rests on the edge unless it is vibrated"
    return Finding(rest[0], label, "What vibration adds", sentence)


def _inserted(counts: Mapping[str, Counts]) -> Finding | None:
    inserted = _of_aligned(counts, "insertion", "inserted")
    if inserted is None:
        return None
    sentence = (
        "Aligned is the moment of falling in. Followed further, with contact on both walls of the "
        f"slot, {inserted[0]} go in; the others jam, climb out or leave. Of those of a figure, "
        f"{inserted[1]} go in."
    )
    return Finding(inserted[0], "of what aligns goes in", "Does it go in", sentence)


def _of_aligned(
    counts: Mapping[str, Counts], variable: str, meaning: str
) -> tuple[str, str] | None:
    """Return the share of all aligned runs with a flag, and its range over the figures."""
    known = {name: each.share_of(variable, meaning) for name, each in counts.items()}
    shares = {name: share for name, share in known.items() if not np.isnan(share)}
    if not shares:
        return None
    weights = [counts[name].number_of(Outcome.ALIGNED) for name in shares]
    return percent(float(np.average([*shares.values()], weights=weights))), _by_figure(shares)


def _by_figure(shares: Mapping[str, float]) -> str:
    """Say the smallest and the largest share, each with its figure."""
    low, high = (of(shares, key=lambda name: shares[name]) for of in (min, max))
    if percent(shares[low]) == percent(shares[high]):
        return percent(shares[low])
    return (
        f"from {percent(shares[low])} ({figure_title(low)}) to {percent(shares[high])} "
        f"({figure_title(high)})"
    )


def _paper(lines: Sequence[Line]) -> Finding:
    judged = [line for line in lines if line.verdict != "not checkable"]
    right = [line for line in judged if line.verdict == "reproduced"]
    wrong = sum(line.verdict == "contradicted" for line in judged)
    conclusions: dict[int, bool] = {}
    for line in judged:
        for digits in _CONCLUSION.findall(line.place):
            conclusions[int(digits)] = conclusions.get(int(digits), True) and line in right
    holding = [str(number) for number, holds in sorted(conclusions.items()) if holds]
    sentence = (
        f"Of {len(judged)} checkable claims {len(right)} are reproduced, {wrong} contradicted, "
        f"{len(judged) - len(right) - wrong} hold in part."
    )
    if conclusions:
        sentence += (
            f" Of its {len(conclusions)} conclusions that can be checked, these hold in every "
            f"part: {', '.join(holding) or 'none'}."
        )
    label = "claims of the paper reproduced"
    return Finding(
        f"{len(right)} of {len(judged)}", label, "What the paper got right and wrong", sentence
    )
