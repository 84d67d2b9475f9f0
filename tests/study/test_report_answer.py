"""The head of the report: the answer, numbers, and figures like and unlike the paper."""

import re
import shutil
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import xarray as xr

from model.events.outcomes import InsertionOutcome, Outcome, Unvibrated
from model.sweeps.io import write_dataset
from study.claims import CLAIMS
from study.claims.ledger import ledger_text
from study.report.ledger import held_out
from study.report.section import Results
from tests.study.report_data import plain, render_report, words_of
from vibralign.plots.words import figure_title, percent, short


def answer_part(text: str) -> str:
    return text[text.index('id="answer"') : text.index('id="figures"')]


def answer_of(text: str) -> str:
    return plain(answer_part(text))


def test_the_page_opens_with_the_ledger_and_numbers_of_the_figures(rendered, datasets, lines):
    text = answer_of(rendered)
    shown = [line for line in lines if line.verdict == "shown"]
    words = (
        f"very list: {len(CLAIMS)} on the coarse grid on which random devices show 8 in the median"
    )
    assert f"{len(shown)} of {len(CLAIMS)} statements of the paper shown" in text
    assert words in text
    of = {claim.id for claim in CLAIMS if claim.is_conclusion}
    assert f"{len([each for each in shown if each.claim in of])} of {len(of)} statements" in text
    kept, pushed = [], []
    for name, dataset in datasets.items():
        aligned = dataset["outcome"].values == Outcome.ALIGNED
        known = aligned & (dataset["sensitive"].values == 0)
        periods = (dataset["tau_align"] * dataset["frequency"]).transpose(*dataset["outcome"].dims)
        in_one = (periods.values[known] < 2.0 * np.pi).mean()
        hops = (dataset["separations"].values[known] > 0).mean()
        lower = (dataset["separations"].values == 0) & (periods.values >= 2.0 * np.pi)
        if hops <= 0.05:
            kept.append(f"{int(name[3:])}")
        if in_one > 0.5:
            pushed.append(f"{int(name[3:])}")
        tau = short(np.median(dataset["tau_align"].values[aligned]), 3)
        row = f"{figure_title(name)} {percent(aligned.mean())} {tau} {percent(hops)} "
        row += f"{percent(in_one)} {percent(lower[known].mean())} "
        assert row in words_of(answer_part(rendered))
    words = "of our figures in which nearly every part keeps contact until it aligns"
    where = f": Figs. {', '.join(kept)}" if kept else ""
    assert f"{len(kept)} of {len(datasets)} {words}{where}; the paper, as we read its" in text
    words = "of our figures in which most parts align within the first period of the vibration"
    assert f"{len(pushed)} of {len(datasets)} {words}: Figs. {', '.join(pushed)}" in text


def test_the_answer_says_when_how_fast_and_how_safely(rendered, datasets, study):
    text = answer_of(rendered)
    aligned = {
        name: data["tau_align"].values[data["outcome"].values == Outcome.ALIGNED]
        for name, data in datasets.items()
    }
    tau = np.median(np.concatenate([aligned[name] for name in study.named("map")]))
    every = sum(each.size for each in aligned.values())
    assert f"{short(tau / (2.0 * np.pi))} natural periods along the axis in the median" in text
    assert f"(τ = {short(tau, 3)}), and all but 0 of the {every} that align go in" in text


def test_shares_of_the_answer_are_the_least_and_the_most_of_the_figures(
    study, root, datasets, tmp_path
):
    some = shutil.copytree(root, tmp_path / "some")
    first, *others = study.named("map")
    nodes = datasets[first]["outcome"].values[::2, ::2] == Outcome.ALIGNED
    reliable = np.where(nodes, np.cumsum(nodes.ravel()).reshape(nodes.shape) % 2, -1)
    changed = datasets[first].copy(deep=True)
    changed["reliable"].values[:] = reliable
    write_dataset(changed, some / f"data/{first}.nc")
    least = (reliable[nodes] == 1).mean()
    words = "of what aligns still aligns if it starts a little differently, where that is tried"
    where = f"(least in {figure_title(first)}, most in {figure_title(others[0])})"
    text = answer_of(render_report(Results(some, study)))
    assert f"{percent(least).removesuffix(' %')} to 100 % {words} {where}" in text
    text = answer_of(render_report(Results(root, study)))
    assert f"100 % {words} " in text
    assert f"{words} (" not in text, "where both figures have all, none has the least"


def test_the_page_says_what_vibration_adds_and_what_goes_in(study, root, datasets, tmp_path):
    some = shutil.copytree(root, tmp_path / "some")
    lost, went_in, resting = [], {}, {}
    for name, dataset in datasets.items():
        of, aligned = dataset.copy(deep=True), dataset["outcome"].values == Outcome.ALIGNED
        stays = aligned & (np.cumsum(aligned).reshape(aligned.shape) % 4 == 0) & (name > "fig11")
        of["insertion"].values[stays] = InsertionOutcome.JAMMED
        of["unvibrated"].values[stays] = Unvibrated.ALIGNS
        write_dataset(of, some / f"data/{name}.nc")
        inserted = of["insertion"].values == InsertionOutcome.INSERTED
        went_in[name] = inserted.sum() / aligned.sum()
        tilted = of["unvibrated_tilt"].values > of["initial_tilt"].values
        resting[name] = (tilted & (of["unvibrated"].values == Unvibrated.RESTS))[aligned].mean()
        if stays.any():
            lost.append(f"{stays.sum()} of {aligned.sum()} in {figure_title(name)}")
    text = render_report(Results(some, study))
    answer = answer_of(text)
    assert len(lost) == 3
    spans = [
        f"{percent(min(each.values())).removesuffix(' %')} to {percent(max(each.values()))} of what"
        for each in (went_in, resting)
    ]
    assert f"{spans[0]} aligns goes in: all but {', '.join(lost)}" in answer
    assert f"{spans[1]} aligns rests on the edge unless it is vibrated" in answer
    assert text.count("<dt>") == 7


def test_what_creeps_and_needs_no_vibration_is_told(rendered, study, root, datasets, tmp_path):
    assert not re.search("of what creeps, [^A-Z]*Fig. 9", answer_of(rendered))
    some, data = shutil.copytree(root, tmp_path / "some"), datasets["fig09"].copy(deep=True)
    aligned = data["outcome"].values == Outcome.ALIGNED
    data["separations"].values[:] = 0
    data["tau_align"].values[aligned] = 1e3
    data["unvibrated"].values[aligned] = np.where(np.arange(aligned.sum()) % 2, 0, 1)
    write_dataset(data, some / "data/fig09.nc")
    share = percent((aligned.sum() // 2) / aligned.sum())
    text = answer_of(render_report(Results(some, study)))
    creeping = re.search("as the paper describes; of what creeps, (.*?) aligns without", text)
    assert creeping
    assert f"{share} in Fig. 9" in creeping[1]


def test_figures_are_listed_by_the_share_of_their_own_statements_that_is_shown(
    rendered, lines, datasets
):
    own: dict[str, list[bool]] = {}
    for line, claim in zip(lines, CLAIMS, strict=True):
        for name in claim.figures if len(claim.figures) < 3 else ():
            own.setdefault(name, []).append(line.verdict == "shown")
        if claim.id in ("L02", "L05", "L14"):  # with a part on the run of Fig. 5
            own.setdefault("fig05", []).append("one" not in line.fails.split("; "))
    del own["locked"]
    items = re.findall("<li>(.*?)</li>", answer_part(rendered))
    found = [
        re.match(r"Fig\. (\d+), where ([\d.]+ %) aligns: (.*)", plain(i)).groups() for i in items
    ]
    named = [f"fig{int(number):02}" for number, _, _ in found]
    for name, (_, aligned, said) in zip(named, found, strict=True):
        assert aligned == percent((datasets[name]["outcome"].values == Outcome.ALIGNED).mean())
        assert (said.count("✓ "), len(re.findall("[✓✗–] ", said))) == (
            sum(own[name]), len(own[name]))  # fmt: skip
    for listed, sign in ((named[:3], -1.0), (named[3:], 1.0)):
        keys = {name: (sign * np.mean(each), -len(each)) for name, each in own.items()}
        assert [keys[name] for name in listed] == sorted(keys.values())[:3]


def test_what_is_read_loosely_is_said_so(study, root, lines, tmp_path):
    """Fig. 11 is put first."""
    some = shutil.copytree(root, tmp_path / "some")
    own = [
        replace(each, verdict="shown" if each.claim in ("L18", "L19") else "not shown")
        for each in lines
    ]
    (some / "claims.csv").write_text(ledger_text(own), encoding="utf-8")
    text = answer_of(render_report(Results(some, study)))
    assert "inversely proportional to the clearance (read loosely, that it falls)" in text


def test_entries_held_out_are_counted(study) -> None:
    verdicts = np.array([[0, 0, 0, *[1] * (len(CLAIMS) - 3)]], np.int8)
    cases = xr.Dataset(
        {"verdict": (("case", "entry"), verdicts)},
        {"case": ["odd"], "entry": [claim.id for claim in CLAIMS]},
    )
    results = SimpleNamespace(study=study, dataset=lambda _: cases)
    lines = [SimpleNamespace(claim=claim.id, random=0.25) for claim in CLAIMS]
    assert held_out(results, lines) == (1, 15, 2, 15, 3.75), "judged by L01, L03, …; it shows L02"
    results.dataset = lambda _: cases.isel(case=[])
    assert held_out(results, lines) is None
