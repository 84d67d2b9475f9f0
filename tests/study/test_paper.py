"""Numbers in docs/paper.md and in captions; curves have the study's own points, maps fewer."""

import re
from pathlib import Path

import numpy as np
import pytest

from model.events.outcomes import Unvibrated
from model.sweeps.sweep import merge, run
from model.sweeps.vibration import overshoot_of
from study.claims import CLAIMS, VERDICTS, checks, figure_of, judge, measures
from study.claims.locked import locked_of
from study.claims.measures import Trace, moves, slopes
from study.claims.regime import regime_of
from study.config import load_study, study_path
from study.evidence.null import null_plan, stored_null, verdicts_of
from study.identification.batch import figures_of
from study.identification.search import missed
from study.identification.space import own_values, space_of
from study.plans import sweep_of

BUILT = sweep_of(load_study(study_path()), "fig06").variables
PAGE = (Path(__file__).parents[2] / "docs/paper.md").read_text(encoding="utf-8")
WORDS = " ".join(PAGE.split())


@pytest.fixture(scope="module")
def study():
    return load_study(study_path())


def own_grid(study, more=()):
    """The fine grid of the search, with the study's own points on all curves, and its horizon."""
    fine = study.identification.grids["fine"]
    curves = {name: study.figures[name].swept.count for name in study.named("curves")}
    counts = fine.counts | curves | dict(more)
    runs = {"horizon": study.settings.horizon, "tolerance": study.settings.tolerance}
    return fine.model_copy(update={"counts": counts, **runs})


def computed(sweep):
    """The dataset of a sweep, as a build makes it."""
    whole = sweep.model_copy(update={"variables": BUILT})
    return merge(whole, "", [run(whole)])


def found_for(space, device, grid, figures_by=None):
    """The figures of a device as a build makes them, and its runs with the tilt locked."""
    sweeps = [space.sweep(device, name, grid) for name in space.figures]
    found = figures_by([sweeps])[0] if figures_by else {
        each.name: figure_of(computed(each)) for each in sweeps
    }  # fmt: skip
    return {**found, "locked": locked_of(found, sweeps[0].settings.settings)}


def shown_by(figures) -> list[str]:
    return [claim.id for claim, found in judge(figures) if found.verdict == "shown"]


@pytest.fixture(scope="module")
def figures(study):
    space = space_of(study)
    # The study's own forces in Fig. 13: the highest that aligns lies near the limit of L11.
    return found_for(space, own_values(study, space), own_grid(study, {"fig13": [301, 31]}))


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
    assert f"shows {sum(shown.values())} of {len(shown)} entries" in WORDS
    assert f"{sum(shown[entry] for entry in of)} of the {len(of)} that carry parts of" in WORDS


def test_the_page_counts_what_random_devices_show(study) -> None:
    found = stored_null(null_plan(study))
    most = found.counts.max()
    best = (found.counts == most).sum()
    words = f"the median shows {np.median(found.counts):g} and the best {best} show {most}"
    assert f"Of {len(found.counts)} devices drawn at random {words}" in WORDS
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
    assert f"shows {later} entries in place of {wide} on the grid" in WORDS
    assert f"so shows {narrow} entries on the grid" in WORDS


def test_the_page_counts_what_the_search_by_half_of_the_entries_shows(study) -> None:
    random = stored_null(null_plan(study)).verdicts == 0
    device, judged = study.evidence.others["odd"], study.identification.searches["odd"].entries
    shown = verdicts_of(space_of(study), [device], study.evidence.grid)[0] == 0
    unseen = np.array([claim.id not in judged for claim in CLAIMS])
    count = shown[unseen].sum()
    assert f"shows {count} of the {unseen.sum()} entries held out" in WORDS
    assert f"shows only {shown[~unseen].sum()} of the {(~unseen).sum()} that it judged" in WORDS
    usual = np.median(random[:, unseen].sum(axis=1))
    as_many = (random[:, unseen].sum(axis=1) >= count).mean()
    words = f"random devices show {usual:g} of them in the median, and {as_many:.0%} show as many"
    assert words.replace("%", " %") in WORDS


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
    assert f"misses the limits by {sizes:.2f} of their sizes in all" in WORDS


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


def raw(curve, noise=0.3):
    """The duration along a curve, not smoothed."""
    return Trace(curve.at, curve.x[curve.aligned], curve.tau[curve.aligned], noise)


def rises_once(figure) -> list[float]:
    """Return by how much each curve rises, once, at forces from 0.33 to 0.5."""
    found = []
    for trace in map(raw, figure.curves):
        (_, rise, _) = moves(trace)[:3]
        assert [sign for sign, _, _ in moves(trace)] == [-1.0, 1.0, -1.0]
        assert 0.33 < rise[1] < rise[2] < 0.5
        found.append(float(np.subtract(*trace.y[np.isin(trace.x, rise[1:])][::-1])))
    return found


def leaps(curve) -> np.ndarray:
    return np.diff(curve.tau[curve.aligned])


def without_contact(figure) -> float:
    """Return the share of the time until alignment in which the contact force is zero."""
    time, until = figure.course["time"], figure.whole.tau[0]
    return float(np.diff(time)[(figure.course["contact_force"][:-1] == 0) & (time[1:] <= until)]
                 .sum() / until)  # fmt: skip


def in_first(curves) -> float:
    """Return the share of what aligns that does so within the first period."""
    return float(np.concatenate([c.tau[c.aligned] * c.at < 2.0 * np.pi for c in curves]).mean())


CAPTIONS = {
    ("fig05", "lifts off twelve times"): lambda f, _: f.whole.result("separations") == 12,
    ("fig05", "At τ = 5 the tilt reaches 0.083 radians"): lambda f, _: (
        abs(f.course["tilt"].max() - 0.083) < 5e-4
        and abs(f.course["time"][f.course["tilt"].argmax()] - 5.0) < 0.1),
    ("fig05", "the tilt ends at 0.078"): lambda f, _: abs(
        f.whole.result("tilt_at_alignment") - 0.078) < 5e-4,
    ("fig05", "zero for 57 % of the time"): lambda f, _: abs(without_contact(f) - 0.57) < 0.01,
    ("fig06", "once at f0 = 0.3 to 0.5 by 1.6 to 5.7 periods"): lambda f, _: [
        round(each(rises_once(f)) * 10.0 / (2.0 * np.pi), 1) for each in (min, max)] == [1.6, 5.7],
    ("fig06", "those with the stiffest spring pressed harder than f0 = 4"): lambda f, _: [
        hops(f, each.at) for each in f.curves][:3] == [1.0, 1.0, 1.0] and all(
        (f.curves[-1].result("separations") > 0)[f.curves[-1].aligned]
        == (f.curves[-1].x < 4.02)[f.curves[-1].aligned]),
    ("fig07", "with f0 = 1 and 3 more so below μ = 0.1"): lambda f, _: all(
        slopes(raw(f.curves[place]), 0.1) > 1.25 for place in (0, 2)),
    ("fig07", "ends of the other two curves the duration leaps"): lambda f, _: [
        leaps(each).max() > 3.0 for each in f.curves] == [False, True, False, True],
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
    ("fig10", "up to an inertia of 7.3 earlier, by 1 %"): lambda f, _: (
        abs(f.curves[0].x[f.curves[0].tau.argmin()] - 7.3) < 0.05
        and abs(f.curves[0].tau.min() / f.curves[0].tau[0] - 0.99) < 0.005),
    ("fig11", "by an eighth to a sixth"): lambda f, _: all(
        0.115 < 1.0 - each.tau[-1] / each.tau[0] < 0.17 for each in f.curves),
    ("fig11", "Every part aligns within the first period"): lambda _, r: r.first_period == 1.0,
    ("fig12", "in one step at a light press, f0 = 0.3 to 0.6"): lambda f, _: all(
        leaps(c).min() < -4.0 and 0.3 < raw(c).x[leaps(c).argmin() + 1] < 0.6 for c in f.curves),
    ("fig12", "with δ = 0.05 it first leaps up to 20.2"): lambda f, _: abs(
        f.curves[0].tau[f.curves[0].x < 1.0].max() - 20.2) < 0.05,
    ("fig12", "With δ = 0.15 it is least at f0 = 2.15, with the others"): lambda f, _: [
        round(float(raw(c).x[raw(c).y.argmin()]), 2) for c in f.curves] == [0.58, 0.50, 2.15],
    ("fig12", "Only 11 % of the points align, most of them within the first"): lambda _, r: (
        abs(r.aligned - 0.11) < 0.005 and abs(r.first_period - 0.89) < 0.005),
    ("fig12", "Below f0 = 0.9 every part hops, beyond none"): lambda f, _: all(
        ((c.result("separations") > 0) == (c.x < 0.9))[c.aligned].all() for c in f.curves),
    ("fig13", "harder than f0 = 9 none does"): lambda f, _: not any(
        each.aligned.any() for each in f.curves if each.at > 9.0),
    ("fig13", "hops, below f0 = 1.3"): lambda f, _: all(
        (share(each, "separations", True) > 0.5) == (each.at < 1.3)
        for each in f.curves if each.aligned.any()),
    ("fig13", "from k_φ = 16 on, in a band below the border"): lambda f, _: all(
        (unvibrated(c) > 0.0) == (c.at > 15.6) for c in f.columns if c.aligned.any()),
    ("fig13", "most parts creep"): lambda _, r: r.creeps > 0.5,
    ("fig14", "aligns at every frequency"): lambda f, _: all(
        each.aligned.any() for each in f.curves),
    ("fig14", "near ν = 10, the resonance of the base, where it hops. Elsewhere it creeps"):
        lambda f, _: all((share(c, "separations", True) == 0.0) and in_first([c]) < 0.05
                         for c in f.curves if 2.6 < c.at < 6.5 or c.at > 13.0),
    ("fig14", "below ν = 2, where 78 % of what aligns"): lambda f, _: abs(
        in_first([c for c in f.curves if c.at < 2.0]) - 0.78) < 0.02,
    ("fig14", "k_φ from 8 to 15, a quarter of what aligns"): lambda f, r: (
        abs(r.static - 0.25) < 0.04 and all((unvibrated(c) > 0.9) == (7.8 < c.at < 15.2)
        for c in f.columns if c.aligned.any())),
}  # fmt: skip


@pytest.mark.parametrize("words", CAPTIONS, ids=": ".join)
def test_captions_say_what_the_figures_show(study, figures, regimes, words) -> None:
    name, said = words
    assert said in study.figures[name].caption
    assert CAPTIONS[words](figures[name], regimes[name])


# --- Numbers of the page ------------------------------------------------------------------------


def numbers_of(figures, entry) -> dict[str, float]:
    """Return the first number of every part of an entry."""
    (found,) = [found for claim, found in judge(figures) if claim.id == entry]
    return {each.part: each.value for each in reversed(found.numbers)}


def near(value, *stated, within=0.005) -> bool:
    return np.ravel(value) == pytest.approx(stated, abs=within)


def of_figure(figures, name, check) -> float:
    """Return the number of an entry on all aligned runs, for one figure alone."""
    return next(check(dict.fromkeys(("fig05", *CURVES), figures[name])))[2]


def unsmoothed(figures, monkeypatch) -> dict[str, str]:
    monkeypatch.setattr(measures.ndimage, "median_filter", lambda y, *_, **__: y)
    return {claim.id: found.verdict for claim, found in judge(figures)}


CURVES = [f"fig{number:02}" for number in range(6, 13)]
NUMBERS = {
    "for 0.22, 0.29 and 0.31 and creep, as the paper describes, for 0.48, 0.72 and 0.61":
        lambda _, r: near([getattr(r[n], of) for of in ("lift_offs", "creeps")
                           for n in ("fig08", "fig13", "fig14")],
                          0.22, 0.29, 0.31, 0.48, 0.72, 0.61, within=0.015),
    "in Figs. 13 and 14, 0.24 and 0.26 would align without vibration too": lambda _, r: near(
        [r[name].creeps_static for name in ("fig13", "fig14")], 0.24, 0.26, within=0.03),
    "No more than a third of the parts hops in Figs. 7, 8 and 10 to 14": lambda _, r: [
        name for name, each in r.items() if each.lift_offs > 1.0 / 3.0
    ] == ["fig05", "fig06", "fig09"],
    "the 18 of 64 points with $k_\\varphi = 20$ that are pressed harder than 4": lambda f, _: [
        int(kept.sum()) for c in [f["fig06"].curves[-1]] for kept in (
            c.aligned, c.aligned & (c.x > 4.0), c.aligned & (c.result("separations") == 0))
    ] == [64, 18, 18],
    "its curve ends in leaps, from 7 to 90": lambda f, _: near(
        [raw(f["fig07"].curves[1]).y[:-1][leaps(f["fig07"].curves[1]) > 3.0][0],
         raw(f["fig07"].curves[1]).y[-1]], 7.0, 90.0, within=0.5),
    "by 3.6, 1.0, 2.2 and 2.1 ($k_\\varphi = 5$, 7, 10, 20)": lambda f, _: near(
        rises_once(f["fig06"]), 3.6, 1.0, 2.2, 2.1, within=0.05),
    "L11 fails with 0.886": lambda f, _: near(numbers_of(f, "L11")["up to"], 0.886, within=5e-4),
    "L15 and L28 reach three of four curves": lambda f, _: near(
        [numbers_of(f, "L15")["bends"], numbers_of(f, "L28")["most"]], 0.75, 0.75, within=0.0),
    "L29 has 1.30": lambda f, _: near(numbers_of(f, "L29")["longer"], 1.30),
    "each curve drops once, from its first values by 4.4 to 5.3": lambda f, _: near(
        [c.tau[(c.tau > 13.4) & (c.tau < 13.8)][-1] - raw(c).y[leaps(c).argmin() + 1]
         for c in f["fig12"].curves], 4.4, 4.6, 5.3, within=0.05),
    "its last point, at $f_0 = 1.90$, leaps by 12.8 to 22.5": lambda f, _: near(
        [raw(f["fig12"].curves[0]).x[-1], leaps(f["fig12"].curves[0])[-1],
         raw(f["fig12"].curves[0]).y[-1]], 1.90, 12.8, 22.5, within=0.05),
    "L02 and L13 are shown by 0.95 and 0.94": lambda f, _: near(
        [numbers_of(f, entry)["all"] for entry in ("L02", "L13")], 0.95, 0.94),
    "Fig. 7 has 0.71 for L02; Figs. 6, 7 and 12 have 0.83, 0.71 and 0.80 for L13": lambda f, _: (
        [n for n in CURVES if of_figure(f, n, checks.l02) < 0.9] == ["fig07"]
        and [n for n in CURVES if of_figure(f, n, checks.l13) < 0.9] == ["fig06", "fig07", "fig12"]
        and near([of_figure(f, "fig07", checks.l02), *(of_figure(f, n, checks.l13) for n in (
            "fig06", "fig07", "fig12"))], 0.71, 0.83, 0.71, 0.80)),
    "It falls by 12 to 16 % while the clearance grows fivefold": lambda f, _: near(
        np.percentile([1.0 - c.tau[-1] / c.tau[0] for c in f["fig11"].curves], [0, 100]),
        0.12, 0.165),
    "0.29 of what aligns in our Fig. 7 needs no vibration": lambda _, r: near(
        r["fig07"].static, 0.29),
}  # fmt: skip


@pytest.mark.parametrize("words", NUMBERS)
def test_the_page_says_what_the_figures_show(figures, regimes, words) -> None:
    assert words in WORDS
    assert NUMBERS[words](figures, regimes)


def test_unsmoothed_the_rise_of_fig_6_is_shown_and_the_fall_is_not(figures, monkeypatch) -> None:
    assert "Unsmoothed the device would show L23, and not L22" in WORDS
    found = unsmoothed(figures, monkeypatch)
    assert (found["L23"], found["L22"]) == ("shown", "not shown")


def test_the_page_says_what_the_limits_cost(study, figures) -> None:
    space = space_of(study)
    device, own = study.evidence.others["unlimited"], own_values(study, space)
    found, ours = found_for(space, device, own_grid(study)), shown_by(figures)
    shown = shown_by(found)
    assert f"shows {len(shown)} of 30 entries on the study's own grids, where ours" in WORDS
    assert f"A search without limits ended at {len(shown)}, and misses them by about 7." in WORDS
    assert [each for each in shown if each not in ours] == ["L06", "L07", "L11", "L27"]
    assert not {*ours} - {*shown}
    assert near(numbers_of(found, "L13")["all"], 0.902, within=5e-4)
    names = study.identification.operating_points
    sizes = sum(missed(study.identification.limits, n, regime_of(found[n])) for n in names)
    assert near(sizes, 7.0, within=0.7)  # 6.8 with the maps' own points
    fine = study.identification.grids["fine"]
    shown, ours = (shown_by(found_for(space, each, fine, figures_of)) for each in (device, own))
    assert f"grid of the search it shows {len(shown)}, where ours shows {len(ours)}" in WORDS
    assert {*ours} - {*shown} == {"L13"}


def test_the_page_says_what_the_press_does_alone(study, regimes) -> None:
    """A sudden press, a slow one, and one before the vibration."""
    space = space_of(study)
    pressed = space.settings.model_copy(update={"start": "pressed"})
    device, grid = own_values(study, space), own_grid(study)
    both = ("fig07", "fig13")
    at_once = [space.sweep(device, name, grid) for name in both]
    overshot = [overshoot_of(computed(sweep)) for sweep in at_once]
    assert near(overshot, 0.0, 0.05, within=0.006)
    assert "0.17 of our Fig. 13 (0.05 by this overshoot" in WORDS
    assert near(overshot[1] / regimes["fig13"].static, 0.28, within=0.03)
    assert "in Fig. 13 all but 0.28 of them" in WORDS
    first = [each.model_copy(update={"settings": pressed}) for each in at_once]
    found = {each.name: regime_of(figure_of(computed(each))) for each in first}
    assert near([found[name].static for name in both], 0.0, 0.06, within=0.01)
    assert near([found["fig07"].aligned, regimes["fig07"].aligned], 0.60, 0.84)
    assert "Pressed first it is 0.00 and 0.06. But then less aligns, 0.60 in place of 0.84" in WORDS


def test_the_page_says_by_how_much_the_base_amplifies_the_force(study) -> None:
    held, nu = study.baseline, 10.0
    for damping, stated in ((0.0, 10.0), (held.axial_damping, 3.6)):
        base = complex(held.contact_stiffness, held.contact_damping * nu)
        whole = base + 1.0 - nu**2 + 1j * damping * nu
        assert near(abs(base / whole), stated, within=0.05)
    assert "3.6-fold with our $h_y$" in WORDS
