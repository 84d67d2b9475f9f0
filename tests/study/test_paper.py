"""Numbers in docs/paper.md and in captions, on the fine grid of the search."""

import re
from pathlib import Path

import numpy as np
import pytest

from study.claims import CLAIMS, VERDICTS, judge
from study.claims.locked import locked_of
from study.claims.regime import regime_of
from study.config import load_study, study_path
from study.evidence.null import null_plan, stored_null, verdicts_of
from study.identification.batch import figures_of
from study.identification.space import own_values, space_of

PAGE = (Path(__file__).parents[2] / "docs/paper.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def study():
    return load_study(study_path())


@pytest.fixture(scope="module")
def figures(study):
    space = space_of(study)
    grid = space.problem.grids["fine"]
    sweeps = [space.sweep(own_values(study, space), name, grid) for name in space.figures]
    (found,) = figures_of([sweeps])
    return {**found, "locked": locked_of(found, sweeps[0].settings.settings)}


@pytest.fixture(scope="module")
def regimes(study, figures):
    return {name: regime_of(figures[name]) for name in study.identification.operating_points}


def test_the_page_lists_the_entries_that_are_not_shown_and_counts_the_others(figures) -> None:
    shown = {claim.id: found.verdict == "shown" for claim, found in judge(figures)}
    rows = re.findall(r"^\| ((?:L\d\d(?:, )?)+) \|", PAGE, re.MULTILINE)
    assert sorted(entry for row in rows for entry in row.split(", ")) == sorted(
        entry for entry, is_shown in shown.items() if not is_shown
    )
    of = [claim.id for claim in CLAIMS if claim.is_conclusion]
    assert f"shows {sum(shown.values())} of {len(shown)} entries" in PAGE
    assert f"{sum(shown[entry] for entry in of)} of the {len(of)} that carry parts of" in PAGE


def test_the_page_counts_what_random_devices_show(study) -> None:
    found = stored_null(null_plan(study))
    most = found.counts.max()
    best = (found.counts == most).sum()
    words = f"the median shows {np.median(found.counts):g} and the best {best} show {most}"
    assert f"Of {len(found.counts)} devices drawn at random {words}" in PAGE
    for entry in ("L02", "L13", "L15"):  # next to none
        assert found.shares[entry] <= 0.05


def test_the_page_counts_what_other_devices_show(study) -> None:
    space, grid, others = space_of(study), study.evidence.grid, study.evidence.others
    pressed = space.settings.model_copy(update={"start": "pressed"})
    then_vibrated = space.model_copy(update={"settings": pressed})
    narrow, wide, later = (
        int((verdicts_of(each, [others[name]], grid)[0] == VERDICTS.index("shown")).sum())
        for each, name in ((space, "narrow"), (space, "unlimited"), (then_vibrated, "unlimited"))
    )
    assert f"shows {later} entries in place\n  of {wide} on the grid" in PAGE
    assert f"so shows {narrow} entries on the grid" in PAGE


def test_the_page_counts_what_the_search_by_half_of_the_entries_shows(study) -> None:
    random = stored_null(null_plan(study)).verdicts == 0
    device, judged = study.evidence.others["odd"], study.identification.searches["odd"].entries
    shown = verdicts_of(space_of(study), [device], study.evidence.grid)[0] == 0
    unseen = np.array([claim.id not in judged for claim in CLAIMS])
    count = shown[unseen].sum()
    assert f"shows {count} of the {unseen.sum()} entries held out" in PAGE
    assert f"shows only {shown[~unseen].sum()} of the {(~unseen).sum()} that it judged" in PAGE
    usual = np.median(random[:, unseen].sum(axis=1))
    as_many = (random[:, unseen].sum(axis=1) >= count).mean()
    words = f"random devices show {usual:g} of them in the\nmedian, and {as_many:.0%} show as many"
    assert words.replace("%", " %") in PAGE


def test_the_page_lists_the_limits_that_are_missed(study, regimes) -> None:
    limits = study.identification.limits
    of = {
        "median tilt": {n: r.tilt for n, r in regimes.items() if r.tilt > limits.tilt},
        "share up to": {n: r.aligned_shown for n, r in regimes.items()
                        if r.aligned_shown < limits.aligned.get(n, 0.0)},
        "share of Fig": {n: r.lift_offs for n, r in regimes.items()
                         if r.lift_offs > limits.hops.get(n, 1.0)},
    }  # fmt: skip
    for words, missed in of.items():
        (row,) = re.findall(rf"^\| {words}.*", PAGE, re.MULTILINE)
        _, limit, numbers, _, _ = row.split("|")
        assert re.findall(r"\d+(?=,| *$| that| \(rad)", limit.split("Fig", 1)[1]) == [
            str(int(name[3:])) for name in missed
        ]
        assert [float(each) for each in numbers.split(",")] == pytest.approx(
            [*missed.values()], abs=0.02
        )
    assert not [n for n, r in regimes.items() if r.corners < limits.corners - 0.005]
    assert np.mean([r.not_resting for r in regimes.values()]) <= limits.not_resting


def share(runs, name, kept) -> float:
    return float((runs.result(name)[runs.aligned & kept] > 0).mean())


def hops(figure, at) -> float:
    (curve,) = [each for each in figure.curves if each.at == at]
    return share(curve, "separations", True)


CAPTIONS = {
    ("fig05", "lifts off nine times"): lambda f, _: f.whole.result("separations") == 9,
    ("fig05", "a tenth of a radian"): lambda f, _: abs(
        f.whole.result("tilt_at_alignment") - 0.1) < 0.005,
    ("fig06", "nearly every part that aligns hops"): lambda _, r: r.lift_offs > 0.9,
    ("fig07", "No part hops; nearly all align within the first period"): lambda _, r: (
        r.lift_offs == 0.0 and r.first_period > 0.95),
    ("fig07", "then without vibration too"): lambda f, _: (
        f.curves[-1].result("unvibrated")[f.curves[-1].aligned] == 0).all(),
    ("fig08", "the resonance of the base, every part hops; elsewhere none"): lambda f, _: [
        hops(f, each.at) for each in f.curves] == [0.0, 0.0, 0.0, 1.0, 0.0],
    ("fig09", "Up to f0 = 3.5 every part that aligns hops, at 5 none"): lambda f, _: [
        hops(f, each.at) for each in f.curves] == [1.0, 1.0, 1.0, 0.0],
    ("fig10", "at ν = 10 every part hops"): lambda f, _: hops(f, 10.0) == 1.0,
    ("fig11", "Every part aligns within the first period"): lambda _, r: r.first_period == 1.0,
    ("fig12", "Nearly every part aligns within the first period"): lambda _, r: (
        r.first_period > 0.95 and 0.0 < r.lift_offs < 0.4),
    ("fig13", "harder than f0 = 8 none does"): lambda f, _: not any(
        each.aligned.any() for each in f.curves if each.at > 8.0),
    ("fig13", "hops, below f0 = 1.6"): lambda f, _: all(
        (share(each, "separations", True) > 0.5) == (each.at < 1.6)
        for each in f.curves if each.aligned.any()),
    ("fig13", "most parts creep"): lambda _, r: r.creeps > 0.5,
    ("fig14", "aligns at every frequency"): lambda f, _: all(
        each.aligned.any() for each in f.curves),
    ("fig14", "elsewhere most parts creep"): lambda _, r: r.creeps > 0.5,
}  # fmt: skip


@pytest.mark.parametrize("words", CAPTIONS, ids=": ".join)
def test_captions_say_what_the_figures_show(study, figures, regimes, words) -> None:
    name, said = words
    assert said in study.figures[name].caption
    assert CAPTIONS[words](figures[name], regimes[name])
