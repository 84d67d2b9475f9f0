"""Each check passes on data made to satisfy its claim, and fails on data made to violate it."""

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from model.events.outcomes import InsertionOutcome, Unvibrated
from model.sweeps.axes import Family
from model.sweeps.sweep import merge, run
from model.sweeps.tracks import TRACK_QUANTITIES
from study.claims import CLAIMS, VERDICTS, Judgement, Tables, judge, tally
from study.claims.claims import ClaimsError, claims_of, limit_of
from study.claims.data import table_of
from study.claims.ledger import judge_claim, ledger_text, lines_of, read_ledger
from study.claims.statistics import explained, trend
from study.config import FIGURES, load_study, study_path
from study.plans import sweep_of
from tests.study.claims_cases import CASES
from tests.study.claims_data import (
    NAN,
    Course,
    bump,
    falling,
    one_run,
    ragged,
    rising,
    runs,
    with_sensitive_noise,
)

BY_ID = {claim.id: claim for claim in CLAIMS}
CHECKED = [claim.id for claim in CLAIMS if claim.check is not None]


def found(claim: str, datasets: dict[str, xr.Dataset]) -> Judgement:
    return judge_claim(BY_ID[claim], Tables.of(datasets))


def test_every_claim_has_made_up_data() -> None:
    assert sorted(CASES) == sorted(CHECKED)


@pytest.mark.parametrize("claim", CHECKED)
@pytest.mark.parametrize("verdict", ["reproduced", "contradicted"])
def test_made_up_data_decide_a_claim_and_sensitive_points_do_not(claim: str, verdict: str) -> None:
    datasets = CASES[claim][verdict == "contradicted"]
    judgement = found(claim, datasets)
    assert judgement.verdict == verdict, judgement
    assert (
        0.0 < judgement.margin < 1.0 if verdict == "reproduced" else -1.0 <= judgement.margin < 0.0
    )
    noisy = found(claim, with_sensitive_noise(datasets))
    assert noisy.verdict == verdict, (judgement, noisy)


@pytest.mark.parametrize("claim", CHECKED)
def test_without_its_data_a_claim_is_not_checkable(claim: str) -> None:
    judgement = found(claim, {})
    assert judgement.verdict == "not checkable"
    assert math.isnan(judgement.margin)
    assert "there is no dataset" in judgement.seen


def test_what_cannot_be_measured_says_why() -> None:
    for claim, judgement in judge(Tables({})):
        if claim.check is None:
            assert judgement.verdict == "not checkable"
            assert judgement.seen == claim.limit.reason


def test_some_parts_of_a_claim_make_it_mixed() -> None:
    mixed = found("F6d", runs("fig06", lambda k, f: falling(k, f) if k < 6.0 else 1.0 + f))
    assert mixed.verdict == "mixed"
    assert -1.0 < mixed.margin < 0.0
    assert mixed.value == pytest.approx(1.0), "the part that decides is the worst"
    assert mixed.seen == "k_φ = 5: -1; k_φ = 7: 1"


def test_a_curve_that_never_aligns_contradicts_what_is_said_of_it() -> None:
    judgement = found("F6d", runs("fig06", NAN))
    assert judgement.verdict == "contradicted"
    assert judgement.margin == -1.0
    assert judgement.seen == "k_φ = 5: nothing to measure; k_φ = 7: nothing to measure"


def test_curves_that_a_claim_names_may_be_missing() -> None:
    family = runs("fig06")["fig06"].isel(tilt_stiffness=[3])
    judgement = found("F6d", {"fig06": family})
    assert judgement.verdict == "not checkable"
    assert "no run with 5 <= tilt_stiffness <= 7" in judgement.seen
    without = {"fig06": runs("fig06")["fig06"].drop_vars("unvibrated")}
    assert "no column for 'unvibrated == 1" in found("M4b", without).seen


CLIMBS_OUT = runs(
    "fig08",
    lambda v, k: 10.0 / k if k > 3.0 + v else NAN,
    insertion=lambda _, k: InsertionOutcome.CLIMBED_OUT if k < 13.0 else InsertionOutcome.INSERTED,
)
ALIGNS_UNVIBRATED, TOPPLES_UNVIBRATED = (
    runs("fig06", unvibrated=float(end), unvibrated_tilt=NAN)
    for end in (Unvibrated.ALIGNS, Unvibrated.LEAVES)
)


@pytest.mark.parametrize(
    ("claim", "datasets", "verdict"),
    [
        # A ragged curve has no rise within a small range; a coarse one may.
        ("F6b", runs("fig06", ragged), "contradicted"),
        ("F6b", runs("fig06", bump, points=25), "reproduced"),
        # More force is to be faster where the tilt spring is stiff.
        ("F8e", runs("fig09", lambda f, k: 10.0 * f if k < 10 else 10.0 / f), "reproduced"),
        ("F8e", runs("fig09", lambda f, k: 10.0 / f if k < 10 else 10.0 * f), "contradicted"),
        # One run that does not align contradicts the drop of the force, and shows nothing of a
        # history that did not begin.
        ("F5e", one_run(outcome=1, tau_align=NAN), "contradicted"),
        ("F5a", {"fig05": one_run(outcome=3)["fig05"].isel(time=[0])}, "not checkable"),
        # What leans on both edges does not rest on one, and has no resting tilt.
        ("M2", runs("pressed", NAN, tilt_end=lambda _, f: f, side_force_max=1.0), "contradicted"),
        # What climbs out again aligns, but does not stay.
        ("F8c", CLIMBS_OUT, "contradicted"),
        ("F8b", CLIMBS_OUT, "reproduced"),
        # What aligns or topples unvibrated is no vibratory alignment.
        ("M4b", ALIGNS_UNVIBRATED, "contradicted"),
        ("M4b", TOPPLES_UNVIBRATED, "contradicted"),
        ("M4b", {**ALIGNS_UNVIBRATED, **runs("fig07")}, "mixed"),
        ("M4b", {**TOPPLES_UNVIBRATED, **runs("fig07")}, "mixed"),
    ],
)
def test_where_a_claim_turns(claim, datasets, verdict) -> None:
    assert found(claim, datasets).verdict == verdict


def test_a_margin_grows_with_the_number_and_stays_bounded() -> None:
    least, most = (
        limit_of({side: 1.0, "scale": 0.5, "reason": "why"}) for side in ("least", "most")
    )
    margins = [least.margin(value) for value in (-1e9, 0.0, 0.9, 1.0, 1.1, 2.0, math.inf)]
    assert margins == sorted(margins)
    assert margins[3] == 0.0
    assert max(map(abs, margins)) <= 1.0
    assert most.margin(0.7) == -least.margin(0.7) > 0.0
    assert least.margin(NAN) == most.margin(NAN) == -1.0


def test_the_margin_of_a_claim_is_continuous_where_a_part_changes_sides() -> None:
    def margin(shift: float) -> float:
        # The share of aligning points of one curve passes the threshold, that of the others stays.
        data = runs("fig09", lambda f, k: NAN if f > 2.0 and k < 10.0 else 5.0, points=2001)
        aligned = (data["fig09"]["tilt_stiffness"] > 10.0 - shift).values
        data["fig09"]["outcome"].values[1] = np.where(aligned, 0, 1)
        return found("F9b", data).margin

    margins = [margin(shift) for shift in np.linspace(0.3, 0.6, 31)]
    assert min(margins) < 0.0 < max(margins)
    assert np.abs(np.diff(margins)).max() < 0.01


def test_the_areas_of_a_map_hang_together_across_sensitive_cells() -> None:
    datasets = runs("fig13", lambda f, k: 5.0 if k > 2.0 * f else NAN)
    datasets["fig13"]["outcome"].values[:, 15] = 1
    assert found("F13b", datasets).verdict == "contradicted", "a gap parts the area in two"
    datasets["fig13"]["sensitive"].values[:, 15] = 1
    assert found("F13b", datasets).verdict == "reproduced", "it is unknown"


def test_trend_is_kendalls_rank_correlation() -> None:
    x = np.arange(6.0)
    assert trend(np.array([1.0, 2.0, 3.0, 5.0, 4.0, 6.0]), x) == pytest.approx(13 / 15)
    assert trend(-x, x) == -1.0
    assert trend(1.0 + 1e-6 * x, x) == 0.0, "what cannot be told apart is equal"
    assert trend(np.array([1.0, NAN, 2.0, NAN, NAN, 3.0]), x) == 1.0
    assert math.isnan(trend(np.full(6, NAN), x))


def test_explained_variance() -> None:
    x = np.linspace(0.03, 0.15, 20)
    line = np.array([np.ones(20), x])
    assert explained(line, 3.0 - 4.0 * x) == pytest.approx(1.0)
    assert explained(np.array([1.0 / x]), 3.0 - 4.0 * x) == 0.0
    assert math.isnan(explained(line, np.full(20, 2.0)))


def test_the_ledger_is_complete_and_consistent() -> None:
    study = load_study(study_path())
    names = {*FIGURES, *study.claims_runs}
    assert len(BY_ID) == len(CLAIMS)
    for claim in CLAIMS:
        assert set(claim.figures) <= names, claim.id
        assert bool(claim.figures) == (claim.check is not None), claim.id
        assert claim.statement
        assert claim.limit.reason
    read = {name for claim in CLAIMS for name in claim.figures}
    assert read >= {name for name, spec in study.figures.items() if spec.kind != "schematic"}
    assert read >= set(study.claims_runs)


TABLE = """
limits: {visible: {least: 0.05, scale: 0.2, reason: seen}}
claims:
  X1:
    stated: Fig. 6
    statement: it falls
    measure: trend
    check: {figures: [fig06], of: tau, CHECK}
"""


@pytest.mark.parametrize(
    ("check", "message"),
    [
        ("number: tendency, must: visible", "X1: number = 'tendency': must be"),
        ("number: spread, colum: tau, must: visible", "argument 'colum'"),
        ("number: trend, must: visible", "argument: 'over'"),
        ("number: spread, combine: sum, must: visible", "combine = 'sum'"),
        ("number: spread, must: glaring", "X1: 'glaring'"),
        ("number: spread, must: {least: 1, scale: 0, reason: r}", "scale"),
        ("number: spread", "X1: 'must'"),
        ("number: spread, must: visible}\n    colour: {", "unknown colour"),
    ],
)
def test_a_table_of_claims_that_breaks_a_rule_is_refused(check: str, message: str) -> None:
    with pytest.raises(ClaimsError, match=message):
        claims_of(TABLE.replace("CHECK", check))


def test_tally_counts_every_verdict() -> None:
    words = tally(["reproduced", "mixed", "reproduced"])
    assert words == "reproduced 2, mixed 1, contradicted 0, not checkable 0"
    assert tally([]).count(" 0") == len(VERDICTS)


# --- The tables -----------------------------------------------------------------------------------


def test_a_table_has_the_runs_of_one_sweep() -> None:
    dataset = runs("fig06", falling)["fig06"]
    dataset["starts"] = (("start", "half_width_of_start"), np.ones((3, 4)))  # of another sweep
    table = table_of(dataset)
    assert len(table) == dataset["outcome"].size
    assert "starts" not in table
    first = table.iloc[0]
    assert first["curve"] == first["tilt_stiffness"] == 5.0
    assert first["tau"] == dataset["tau_align"].values[0, 0]
    assert set(table_of(runs("fig13")["fig13"])["curve"]) == {0.0}, "a map is no curve"


def test_the_table_of_a_history_ends_as_the_part_aligns() -> None:
    table = table_of(Course().datasets["fig05"])
    assert table["time"].iloc[-1] == table["tau"].iloc[-1] == 10.0
    assert table["tilt"].iloc[-1] == pytest.approx(0.101)


def test_tables_of_several_devices_are_judged_one_by_one() -> None:
    alone = [runs("fig06", falling), runs("fig06", rising), runs("fig06", bump)]
    tables = [table_of(each["fig06"]).assign(device=row) for row, each in enumerate(alone)]
    together = Tables({"fig06": pd.concat(tables)})
    for row, datasets in enumerate(alone):
        expected = repr(judge(Tables.of(datasets)))
        assert repr(judge(together.at(row))) == expected
        assert repr(judge(Tables(together.at(row).alone()))) == expected


@pytest.mark.parametrize("claim", CHECKED)
def test_sensitive_runs_alone_show_nothing(claim: str) -> None:
    datasets = {
        name: dataset.assign(sensitive=xr.ones_like(dataset["outcome"]))
        for name, dataset in CASES[claim][0].items()
    }
    assert found(claim, datasets).verdict == "contradicted"


def test_a_curve_of_sensitive_runs_counts_against_what_is_said_of_it() -> None:
    curves = runs("fig06", falling)
    curves["fig06"]["sensitive"].values[1] = 1
    assert found("F6d", curves).seen == "k_φ = 5: -1; k_φ = 7: nothing to measure"


# --- The ledger on disk -------------------------------------------------------------------------


def test_the_ledger_is_read_as_it_was_written(tmp_path: Path) -> None:
    lines = lines_of(judge(Tables.of({**runs("fig06", bump), **runs("fig11")})))
    path = tmp_path / "claims.csv"
    path.write_text(ledger_text(lines), encoding="utf-8")
    assert read_ledger(path) == lines
    assert ledger_text(read_ledger(path)) == path.read_text(encoding="utf-8")
    (line,) = [line for line in lines if line.claim == "F6b"]
    assert (line.verdict, line.sources, line.demand) == ("reproduced", ["fig06"], "at least 0.05")


# --- The ledger's own runs ----------------------------------------------------------------------


@pytest.fixture(scope="module")
def own_runs() -> dict[str, xr.Dataset]:
    """Two of the ledger's runs on three points a curve, from a rest that is the study's."""
    study = load_study(study_path())
    small = {
        name: run.model_copy(update={"swept": run.swept.model_copy(update={"count": 3})})
        for name, run in study.claims_runs.items()
    }
    coarse = study.model_copy(update={"claims_runs": small})
    names = ("centred", "misaligned")
    sweeps = [sweep_of(coarse, name) for name in names]
    return {each.name: merge(each, "title", [run(each)]) for each in sweeps}


def test_a_start_without_asymmetry_is_one(own_runs: dict[str, xr.Dataset]) -> None:
    centred = own_runs["centred"]
    assert float(centred["misalignment"]) == pytest.approx(
        float(centred["half_width"]) * (1.0 + float(centred["clearance"]))
    )
    still = centred["excursion"].sel(initial_tilt=0.0)
    assert (still == 0.0).all(), "forces through one line move nothing sideways"
    assert (centred["excursion"].sel(initial_tilt=0.001) > 0.0).all()


def test_own_runs_say_how_far_the_part_came(own_runs: dict[str, xr.Dataset]) -> None:
    misaligned = own_runs["misaligned"]
    assert set(TRACK_QUANTITIES) <= set(misaligned.data_vars)
    aligned = misaligned["outcome"].values == 0
    assert (misaligned["way"].values[aligned] == 1.0).all()
    assert (misaligned["way"].values[~aligned] < 1.0).all()
    assert (misaligned["side_force_max"].values >= 0.0).all()
    assert np.isfinite(misaligned["tilt_end"].values).all()
    assert (misaligned["tilt_min"] <= misaligned["tilt_max"]).all()


def test_what_the_press_alone_moves_is_the_way_of_the_run_without_vibration() -> None:
    sweep = sweep_of(load_study(study_path()), "displaced")
    few = {"frequency": [0.0, 5.0], "tilt_stiffness": [2.0, 20.0]}
    dimensions = [Family(parameter=name, values=values) for name, values in few.items()]
    found = run(sweep.model_copy(update={"dimensions": dimensions}))
    way, alone = (found[name].values.reshape(2, 2) for name in ("way", "unvibrated_way"))
    assert np.array_equal(alone[0], way[0])
    assert np.array_equal(alone[1], way[0])
    assert not np.isclose(way[1], way[0]).any()
