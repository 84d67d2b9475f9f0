"""Every entry is shown by data made for it, and each part fails on data made against it."""

from dataclasses import replace

import numpy as np
import pytest

from study.claims import CLAIMS, judge, tally
from study.claims.claims import claims_of
from study.claims.data import figure_of
from study.claims.ledger import Number, judge_claim, ledger_text, lines_of, read_ledger
from study.claims.measures import (
    Trace,
    edge_shift,
    fast_rectangle,
    largest_area,
    line,
    moves,
    slopes,
)
from study.claims.regime import regime_of
from tests.study.made import HELD, NAN, WORLD, WRONG, history, made

BY_ID = {claim.id: claim for claim in CLAIMS}
SHARES = dict.fromkeys(BY_ID, 0.25)


def test_every_entry_is_shown_by_the_made_up_device() -> None:
    assert {c.id: found.verdict for c, found in judge(WORLD)} == dict.fromkeys(BY_ID, "shown")


def test_there_are_no_more_than_thirty_measures_and_a_conclusion_says_so() -> None:
    assert len(CLAIMS) == 30
    assert sum(claim.is_conclusion for claim in CLAIMS) == 13


@pytest.mark.parametrize("entry", BY_ID)
def test_every_part_of_an_entry_fails_on_data_made_against_it(entry: str) -> None:
    claim, failed = BY_ID[entry], set()
    for figure in WRONG[entry]:
        found = judge_claim(claim, {**WORLD, figure.name: figure})
        assert found.verdict == "not shown", (figure.name, found)
        failed |= {number.part for number in found.numbers if number.margin < 0.0}
    assert failed == {*claim.limits}


@pytest.mark.parametrize("entry", BY_ID)
def test_a_missing_figure_is_not_checkable_whatever_the_others_show(entry: str) -> None:
    for name in BY_ID[entry].figures:
        found = judge_claim(BY_ID[entry], {n: f for n, f in WORLD.items() if n != name})
        assert found.verdict == "not checkable"
        assert name in found.missing
        assert not found.numbers


@pytest.mark.parametrize("entry", BY_ID)
def test_sensitive_runs_decide_nothing(entry: str) -> None:
    noisy = {"locked": WORLD["locked"], "fig05": WORLD["fig05"]}
    for name in WORLD.keys() - noisy.keys():
        results = WORLD[name].results
        odd = np.zeros(results["outcome"].shape, bool)
        odd[:, 10] = True
        changes = {
            "sensitive": odd.astype(np.int8),
            "outcome": np.where(odd, 1 - results["outcome"], results["outcome"]),
            "tau_align": np.where(odd, 1e6, results["tau_align"]),
        }
        noisy[name] = replace(WORLD[name], results={**results, **changes})
    assert judge_claim(BY_ID[entry], noisy).verdict == "shown"


def test_a_result_that_is_missing_is_named() -> None:
    figure = WORLD["fig06"]
    without = {n: v for n, v in figure.results.items() if n != "separations"}
    found = judge_claim(BY_ID["L05"], {**WORLD, "fig06": replace(figure, results=without)})
    assert found.verdict == "not checkable"
    assert "'separations'" in found.missing


def test_a_figure_of_which_half_of_the_curves_align_nowhere_is_not_checkable() -> None:
    lone = made("fig10", lambda v, i: i if v == 1.0 else NAN)
    assert judge_claim(BY_ID["L28"], {**WORLD, "fig10": lone}).verdict == "not checkable"


def test_a_named_curve_that_does_not_align_fails() -> None:
    nothing = made("fig06", lambda k, f: 40.0 / (0.5 + f) if k != 7.0 else NAN)
    assert judge_claim(BY_ID["L22"], {**WORLD, "fig06": nothing}).verdict == "not shown"


def test_a_run_that_does_not_align_has_no_history_to_judge() -> None:
    lost = history(outcome=1, tau_align=NAN)
    for entry in ("L02", "L03", "L04", "L05"):
        assert judge_claim(BY_ID[entry], {**WORLD, "fig05": lost}).verdict == "not shown"


# --- Measures -------------------------------------------------------------------------------------


def trace(y: list[float], noise: float = 0.1) -> Trace:
    return Trace(1.0, np.arange(float(len(y))), np.array(y), noise)


def test_movements_up_to_the_noise_are_none() -> None:
    assert moves(trace([5.0, 3.0, 3.05, 2.0, 4.0, 3.95, 4.5, 1.0])) == [
        (-1.0, 0.0, 3.0), (1.0, 3.0, 6.0), (-1.0, 6.0, 7.0),
    ]  # fmt: skip
    assert moves(trace([1.0, 1.05, 0.98])) == []


def test_slopes_are_compared_at_a_cut_that_lies_between_points() -> None:
    assert slopes(trace([0.0, 2.0, 3.0, 4.0]), 1.0) == 2.0
    assert slopes(trace([0.0, 2.0, 2.0]), 1.0) == np.inf
    assert np.isnan(slopes(trace([0.0, -1.0, -1.0]), 1.0))
    assert np.isnan(slopes(trace([0.0, 2.0]), 3.0))


def test_a_parabola_departs_from_its_line() -> None:
    # The line of least squares through 0, 1, 4, 9, 16 is 4 x - 2; the ends lie 2 above it.
    slope, departure = line(trace([0.0, 1.0, 4.0, 9.0, 16.0]))
    assert (slope, departure) == pytest.approx((4.0, 2.0 / 16.0))


def test_areas_have_holes_and_sensitive_cells_connect_them() -> None:
    cells = np.ones((5, 5), np.int8)
    cells[2, 2], cells[0, 4] = 0, -1
    assert largest_area(cells) == (1.0, 1.0 / 23.0)
    cells[:, 3] = [-1, 0, 0, 0, 0]
    assert largest_area(cells)[0] == 1.0


def test_the_best_rectangle_is_fast_only_if_half_of_it_is() -> None:
    cells = np.ones((10, 10), np.int8)
    tau = np.arange(100.0).reshape(10, 10)
    assert fast_rectangle(cells, tau, 0.05) == 1.0
    cells[:5] = 0  # fast ones fail
    cells[::2, :] = 0
    assert np.isnan(fast_rectangle(cells, tau, 0.2))


def test_an_edge_shifts_by_what_four_fifths_of_the_lines_span() -> None:
    figure = made("fig13", lambda f, k: 1.0 if f <= k / 2.0 else NAN)
    # The highest f0 rises from 0.5 to 20 over the columns: four fifths of it, to a step.
    assert edge_shift(figure.columns, np.max) == pytest.approx(0.8, abs=0.03)


def test_a_figure_is_read_from_a_dataset(datasets) -> None:
    figure = figure_of(datasets["fig06"])
    assert [*figure.axes] == ["tilt_stiffness", "press_force"]
    assert figure.held["frequency"] == 10.0
    run = figure_of(datasets["fig05"])
    assert run.course["time"][-1] >= run.whole.tau[0]


def test_the_regime_counts_what_aligns() -> None:
    regime = regime_of(made("fig06", lambda _, f: 0.5 if f <= 10.0 else NAN, separations=1))
    assert regime.aligned == pytest.approx(79 / 159)
    assert regime.aligned_shown == 1.0
    assert (regime.lift_offs, regime.first_period, regime.creeps) == (1.0, 1.0, 0.0)
    assert regime.not_resting == 0.0
    assert HELD["frequency"] * 0.5 < 2.0 * np.pi


# --- The list -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("{L01: {says: x}}", "L01: 'place'"),
        ("{L99: {place: x, says: y, figures: [], parts: {}}}", "L99: module .* has no attribute"),
        ("{L01: {place: x, says: y, figures: [], parts: {}, why: z}}", "L01: unknown why"),
        ("{L01: {place: x, says: y, figures: [], parts: {a: {is: b, least: 1, most: 2}}}}",
         "L01: .*least or most"),
    ],
)  # fmt: skip
def test_an_entry_that_breaks_a_rule_is_named(text: str, fault: str) -> None:
    with pytest.raises(ValueError, match=fault):
        claims_of(f"{{limits: {{}}, entries: {text}}}")


def test_the_ledger_is_read_as_it_was_written(tmp_path) -> None:
    lines = lines_of(judge({**WORLD, "fig06": WRONG["L22"][0]}), SHARES)
    path = tmp_path / "claims.csv"
    path.write_text(ledger_text(lines), encoding="utf-8")
    assert read_ledger(path) == lines
    (found,) = [each for each in lines if each.claim == "L22"]
    assert found.fails == "slower; falls; falls, back"
    assert "slower: 0.8" in found.seen
    assert tally([e.verdict for e in lines]) == "27 shown, 2 not shown, 1 not checkable"


def test_a_number_without_a_measure_says_why() -> None:
    told = {value: str(Number("p", "f0 = 5", value, 1.0)) for value in (NAN, np.inf, 2.0)}
    assert [*told.values()] == [
        "f0 = 5: nothing to measure", "f0 = 5: nothing to compare with", "f0 = 5: 2"
    ]  # fmt: skip


def test_what_creeps_is_counted_apart_by_whether_it_needs_the_vibration() -> None:
    regime = regime_of(made("fig06", lambda _, f: 500.0 + f, separations=0, unvibrated=0))
    assert (regime.creeps, regime.creeps_static) == (1.0, 1.0)
    regime = regime_of(made("fig06", lambda _, f: 500.0 + f, separations=1, unvibrated=0))
    assert regime.creeps == 0.0
    assert np.isnan(regime.creeps_static)
