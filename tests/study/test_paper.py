"""Numbers in docs/paper.md and in captions, on the fine grid of the search."""

import re
from pathlib import Path

import numpy as np
import pytest

from model.events.outcomes import Unvibrated
from study.claims import CLAIMS, VERDICTS, judge
from study.claims.locked import locked_of
from study.claims.regime import regime_of
from study.config import load_study, study_path
from study.evidence.null import null_plan, stored_null, verdicts_of
from study.identification.batch import figures_of
from study.identification.search import missed
from study.identification.space import own_values, space_of

PAGE = (Path(__file__).parents[2] / "docs/paper.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def study():
    return load_study(study_path())


@pytest.fixture(scope="module")
def figures(study):
    space = space_of(study)
    fine = space.problem.grids["fine"]
    # The study's own forces in Fig. 13: the highest that aligns lies near the limit of L11.
    grid = fine.model_copy(update={"counts": fine.counts | {"fig13": [301, 31]}})
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
    for words, beyond in of.items():
        rows = re.findall(rf"^\| {words}.*", PAGE, re.MULTILINE)
        if not beyond:
            assert not rows
            continue
        (row,) = rows
        _, limit, numbers, _, _ = row.split("|")
        assert re.findall(r"\d+(?=,| *$| that| \(rad)", limit.split("Fig", 1)[1]) == [
            str(int(name[3:])) for name in beyond
        ]
        assert [float(each) for each in numbers.split(",")] == pytest.approx(
            [*beyond.values()], abs=0.02
        )
    assert not [n for n, r in regimes.items() if r.corners < limits.corners - 0.005]
    assert np.mean([r.not_resting for r in regimes.values()]) <= limits.not_resting
    sizes = sum(missed(limits, name, regime) for name, regime in regimes.items())
    assert f"misses the limits by {sizes:.2f} of their sizes in all" in PAGE


def share(runs, name, kept) -> float:
    return float((runs.result(name)[runs.aligned & kept] > 0).mean())


def hops(figure, at) -> float:
    (curve,) = [each for each in figure.curves if each.at == at]
    return share(curve, "separations", True)


def falls(figure) -> list[bool]:
    """Return of each curve whether it ends lower than it begins, by a tenth."""
    taus = [each.tau[each.aligned] for each in figure.curves]
    return [bool(tau[-1] <= 0.9 * tau[0]) for tau in taus]


def unvibrated(curve) -> float:
    """Return the share of the aligned points that would align without vibration."""
    return float((curve.result("unvibrated")[curve.aligned] == Unvibrated.ALIGNS).mean())


CAPTIONS = {
    ("fig05", "lifts off twelve times"): lambda f, _: f.whole.result("separations") == 12,
    ("fig05", "tilted by 0.08 radians"): lambda f, _: abs(
        f.whole.result("tilt_at_alignment") - 0.08) < 0.005,
    ("fig06", "those with the stiffest spring pressed harder than f0 = 4"): lambda f, _: [
        hops(f, each.at) for each in f.curves][:3] == [1.0, 1.0, 1.0] and all(
        (f.curves[-1].result("separations") > 0)[f.curves[-1].aligned]
        == (f.curves[-1].x < 4.02)[f.curves[-1].aligned]),
    ("fig07", "No part hops; nearly all align within the first period"): lambda _, r: (
        r.lift_offs == 0.0 and r.first_period > 0.95),
    ("fig07", "then without vibration too, as half of the parts do"): lambda f, _: (
        unvibrated(f.curves[-1]) == 1.0 and abs(unvibrated(f.curves[-2]) - 0.5) < 0.05),
    ("fig08", "rises again at ν = 0.5 and 15, many times over"): lambda f, _: [
        each.tau[each.aligned][-1] > 5.0 * np.nanmin(each.tau) for each in f.curves
    ] == [True, False, False, False, True],
    ("fig08", "the resonance of the base, every part hops; elsewhere none"): lambda f, _: [
        hops(f, each.at) for each in f.curves] == [0.0, 0.0, 0.0, 1.0, 0.0],
    ("fig09", "at 3.5 and 5 it rises"): lambda f, _: falls(f) == [True, True, False, False],
    ("fig09", "Up to f0 = 2.5 every part that aligns hops, at 3.5 and 5 none"): lambda f, _: [
        hops(f, each.at) for each in f.curves] == [1.0, 1.0, 0.0, 0.0],
    ("fig10", "ν = 10 every part hops"): lambda f, _: hops(f, 10.0) == 1.0,
    ("fig11", "by a tenth to a sixth"): lambda f, _: all(
        0.1 < 1.0 - each.tau[-1] / each.tau[0] < 0.17 for each in f.curves),
    ("fig11", "Every part aligns within the first period"): lambda _, r: r.first_period == 1.0,
    ("fig12", "Nearly every part aligns within the first period"): lambda _, r: (
        0.85 < r.first_period < 0.95),
    ("fig12", "Below f0 = 0.9 every part hops, beyond none"): lambda f, _: all(
        ((c.result("separations") > 0) == (c.x < 0.9))[c.aligned].all() for c in f.curves),
    ("fig13", "harder than f0 = 9 none does"): lambda f, _: not any(
        each.aligned.any() for each in f.curves if each.at > 9.0),
    ("fig13", "hops, below f0 = 1.3"): lambda f, _: all(
        (share(each, "separations", True) > 0.5) == (each.at < 1.3)
        for each in f.curves if each.aligned.any()),
    ("fig13", "most parts creep"): lambda _, r: r.creeps > 0.5,
    ("fig14", "aligns at every frequency"): lambda f, _: all(
        each.aligned.any() for each in f.curves),
    ("fig14", "elsewhere most parts creep"): lambda _, r: r.creeps > 0.5,
    ("fig14", "k_φ from 8 to 15, a quarter of what aligns"): lambda f, r: (
        abs(r.static - 0.25) < 0.04 and all((unvibrated(c) > 0.9) == (7.8 < c.at < 15.2)
        for c in f.columns if c.aligned.any())),
}  # fmt: skip


@pytest.mark.parametrize("words", CAPTIONS, ids=": ".join)
def test_captions_say_what_the_figures_show(study, figures, regimes, words) -> None:
    name, said = words
    assert said in study.figures[name].caption
    assert CAPTIONS[words](figures[name], regimes[name])
