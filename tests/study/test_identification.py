"""The search for the unstated parameters: its unknowns, its judgement and its parts."""

import itertools
import os
import subprocess
import sys
from typing import Any

import numpy as np
import pandas as pd
import pytest

from study.claims import CLAIMS, Tables, judge
from study.claims.claims import EVERY_FIGURE
from study.claims.ledger import Judgement
from study.config import FIGURES, Study, check_study, load_study, read_study, study_path
from study.config.identification import HoldOut, Round, Stage
from study.identification import candidates, search
from study.identification.candidates import (
    Numbers,
    Scores,
    short_of,
    short_of_aims,
)
from study.identification.hold_out import devices_of, hold_out, measured, summary_of
from study.identification.space import Space, bare_inertia, space_of, structure_of
from study.identification.tables import (
    found_text,
    read_found,
    read_scored,
    scored_text,
    summary_texts,
)
from study.plans import sweep_of

COARSE = Stage(grid="tiny", points=2)


@pytest.fixture(scope="module")
def study() -> Study:
    """The study with a tiny grid of the search."""
    stated = read_study(study_path())
    counts = {**dict.fromkeys(FIGURES[4:], 4), "fig05": 1, "rubbing": 3, "by_frequency": 3}
    tiny = {"counts": counts, "horizon": 10.0, "tolerance": 1e-5}
    stated["identification"]["grids"]["tiny"] = tiny
    return check_study(stated)


@pytest.fixture(scope="module")
def space(study: Study) -> Space:
    """Its space."""
    return space_of(study)


def test_a_point_has_the_values_that_make_it(space):
    point = np.random.default_rng(1).random(len(space.names))
    values = space.values(point)
    assert space.point(values) == pytest.approx(point, abs=1e-12)
    for prior, name in zip(space.problem.structure.values(), space.names, strict=False):
        assert prior.low <= values[name] <= prior.high


def test_damping_ratios_and_the_inertia_follow_their_definitions():
    values = {
        "half_width": 1.2, "slenderness": 2.5, "inertia_ratio": 2.0, "lateral_stiffness": 0.25,
        "lateral_damping_ratio": 0.1, "axial_damping_ratio": 0.2, "tilt_damping_ratio": 0.3,
    }  # fmt: skip
    found = structure_of(values)
    assert found["half_height"] == pytest.approx(3.0)
    assert found["inertia"] == pytest.approx(2.0 * (1.44 + 9.0) / 3.0)
    assert found["lateral_damping"] == pytest.approx(2.0 * 0.1 * 0.5)
    assert found["axial_damping"] == pytest.approx(0.4)
    assert found["tilt_damping"] == pytest.approx(0.6 * np.sqrt(10.0 * found["inertia"]))


def test_another_device_is_the_same_search(study, space):
    other = study.model_copy(update={"structure": {**study.structure, "half_width": 0.7}})
    assert space_of(other).identity == space.identity


def test_the_search_is_stated_in_the_same_order_in_every_process():
    """Snakemake runs a part again, hours of it, if the text of its parameters differs."""
    code = (
        "from study.config import load_study, study_path\n"
        "from study.identification.space import space_of\n"
        "print(space_of(load_study(study_path())).model_dump())"
    )

    command, environment = [sys.executable, "-c", code], {**os.environ, "PYTHONHASHSEED": "1"}
    there = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert there.stdout == f"{space_of(load_study(study_path())).model_dump()}\n"


def test_sweeps_are_those_of_a_study_with_this_device(study, space):
    """A figure that the search computes is the one that the study would compute."""
    values = space.values(np.full(len(space.names), 0.4))
    held: dict[str, dict[str, float]] = {name: {} for name in space.figures}
    for unknown, value in values.items():
        figure, dot, name = unknown.partition(".")
        if dot:
            held[figure][name] = value
    bare = bare_inertia(structure_of(values))
    figures = {
        name: spec.model_copy(update={"held": {**spec.held, **held[name]}} if name in held else {})
        for name, spec in study.figures.items()
    }
    fig10 = figures["fig10"]
    axis = fig10.swept.model_copy(update={"start": bare, "stop": 4.0 * bare})  # type: ignore[union-attr]
    figures["fig10"] = fig10.model_copy(update={"swept": axis})
    structure = {**study.structure, **structure_of(values)}
    theirs = study.model_copy(update={"structure": structure, "figures": figures})
    grid = space.grid("own")
    for name in ("fig05", "fig06", "fig10", "rubbing", "centred"):
        mine, wanted = space.sweep(values, name, grid), sweep_of(theirs, name)
        assert mine.kind == wanted.kind
        axes = [
            [(each.parameter, each.values) for each in one.dimensions] for one in (mine, wanted)
        ]
        assert axes[0] == axes[1]
        for parameter in wanted.parameters.keys() - {swept for swept, _ in axes[0]}:
            assert mine.parameters[parameter] == wanted.parameters[parameter], (name, parameter)


def test_a_claim_falls_short_by_less_the_nearer_it_is():
    def short(margin: float, verdict: str = "mixed", is_whole: bool = True) -> float:
        return short_of(Judgement(0.0, margin, verdict, ""), is_whole)  # type: ignore[arg-type]

    assert short(0.5) == short(candidates.SAFE) == 0.0
    assert short(0.0) == 1.0
    assert 1.0 < short(-0.1) < short(-0.5) < short(-0.5, "contradicted")
    assert short(-0.5, "contradicted", is_whole=False) == short(-0.5)
    assert short(np.nan) == 0.0


def test_an_aim_that_is_met_costs_nothing(space):
    problem = space.problem
    good = Numbers(1.0, 0.8, 0.0, 0.1, 1.0, 0.1)
    assert short_of_aims(problem, "fig06", np.array(good)) == 0.0
    for field, value in {"aligned": 0.05, "tilt": 0.3, "corners": 0.9, "friction": 0.5}.items():
        worse = good._replace(**{field: value})
        assert short_of_aims(problem, "fig06", np.array(worse)) > 0.0, field
    full = good._replace(aligned_mean=1.0)
    assert short_of_aims(problem, "fig13", np.array(full)) > 0.0


def test_missing_a_limit_costs_more_than_missing_an_aim(space):
    aim, limit = space.problem.aims.tilt, space.problem.limits.tilt
    tilts = np.array([aim, limit, limit + 0.01])
    numbers = np.array([Numbers(1.0, 0.8, 0.0, tilt, 1.0, 0.1) for tilt in tilts])
    missed = short_of_aims(space.problem, "fig06", numbers)
    assert missed[0] == 0.0
    assert missed[1] == pytest.approx(candidates.AIM * (limit / aim - 1.0))
    further = candidates.AIM * 0.01 / aim + candidates.LIMIT * 0.01 / limit
    assert missed[2] - missed[1] == pytest.approx(further)


def test_a_set_meets_the_limits_if_every_figure_does(space):
    good = dict.fromkeys(space.figures, Numbers(0.5, 0.5, 0.1, 0.1, 1.0, 0.3))
    assert candidates.meets_limits(space.problem, good)
    for worse in ({"tilt": 0.21}, {"not_resting": 0.5}, {"corners": 0.9}, {"aligned_mean": 0.3}):
        bad = {**good, "fig06": good["fig06"]._replace(**worse)}
        assert not candidates.meets_limits(space.problem, bad), worse


def test_the_choice_is_near_the_best_of_all_combinations(space):
    random = np.random.default_rng(3)
    names = space.figures[:4]
    made = {
        name: Scores(
            points=random.random((4, len(space.problem.operating_points[name]))),
            shorts=random.random((4, len(CLAIMS))),
            numbers=np.column_stack([random.random((4, 5)), np.zeros(4)]),
            tables=Tables({}),
        )
        for name in names
    }
    found = candidates.chosen(space, np.full(7, 0.5), made)
    problem = space.problem
    missed = {name: short_of_aims(problem, name, made[name].numbers) for name in names}

    def cost(rows: tuple[int, ...]) -> float:
        pairs = list(zip(names, rows, strict=True))
        return candidates.shortfall(
            problem,
            np.array([made[name].shorts[row] for name, row in pairs]),
            np.array([made[name].numbers[row] for name, row in pairs]),
            sum(missed[name][row] for name, row in pairs),
        )

    every = sorted(cost(rows) for rows in itertools.product(range(4), repeat=4))
    assert found.shortfall == pytest.approx(cost(tuple(found.picked.values())))
    assert found.shortfall <= every[2]


@pytest.fixture(scope="module")
def found(space: Space) -> search.Found:
    """The first part of a search over two structures."""
    return search.pool(space, 2, [COARSE], 0)


def test_a_part_is_the_same_whenever_it_is_computed(space, found, tmp_path):
    again, other = (search.pool(space, 2, [COARSE], part) for part in (0, 1))
    assert np.array_equal(found.points, again.points)
    assert not np.array_equal(found.points[0], other.points[0])
    assert np.all(np.diff(found.shortfalls) >= 0.0)

    path = tmp_path / "sets.csv"
    path.write_text(found_text(space, found))
    read = read_found(space, [path])
    assert read.points == pytest.approx(found.points, abs=1e-8)

    turn = Round(generations=1, population=5, stages=[COARSE])
    moved = search.evolve(space, turn, 0, 0, read)
    assert np.array_equal(moved.points, search.evolve(space, turn, 0, 0, read).points)


def test_small_steps_keep_the_best_set_and_count_a_missed_limit(space, found, tmp_path):
    path = tmp_path / "judged.json"
    choice, tables = search.polish(space, [COARSE], 0, 0, found)
    path.write_text(scored_text(space, choice, tables))
    judged = read_scored(space, [path])
    assert judged.points[0] == pytest.approx(found.points[0], abs=1e-12)
    assert judged.shortfalls[0] == pytest.approx(choice.shortfall + 1.0)

    moved, _ = search.polish(space, [COARSE], 3, 0, judged)
    again, _ = search.polish(space, [COARSE], 3, 0, judged)
    assert np.array_equal(moved.point, again.point)
    assert moved.shortfall < choice.shortfall
    assert 0.0 < np.abs(moved.point - judged.points[0])[:7].max() < 0.2


def test_a_set_judged_at_last_has_the_verdicts_of_its_tables(space, found, tmp_path):
    choice, tables = search.final(space, [COARSE], 0, found)
    paths = []
    for number in range(2):
        paths.append(tmp_path / f"{number}.json")
        paths[-1].write_text(scored_text(space, choice, tables))
    texts = summary_texts(space, paths)
    verdicts = [judgement.verdict for _, judgement in judge(tables)]
    row = dict(zip(*(line.split(",") for line in texts["sets"].splitlines()[:2]), strict=True))
    judged = {
        name: candidates.numbers_of(name, tables, space.values(choice.point))
        for name in space.figures
    }
    assert float(row["meets_limits"]) == candidates.meets_limits(space.problem, judged)
    assert int(row["reproduced"]) == verdicts.count("reproduced")
    assert "half_width" in texts["device"]
    values = space.values(choice.point)
    for line in texts["ranges"].splitlines()[1:]:
        unknown, *numbers = line.split(",")
        assert numbers == [f"{values[unknown]:.4g}"] * 3
    for line, verdict in zip(texts["claims"].splitlines()[1:], verdicts, strict=True):
        _, shown, contradicted, best = line.split(",")
        assert float(shown) == (verdict == "reproduced")
        assert float(contradicted) == (verdict == "contradicted")
        assert best == verdict
    with pytest.raises(LookupError, match=r"final\.sets"):
        search.final(space, [COARSE], 99, found)


# --- Hold-out -------------------------------------------------------------------------------------

SEEN, UNSEEN = ("fig07", "fig11"), ("fig08", "fig10")


@pytest.fixture(scope="module")
def devices(study: Study) -> pd.DataFrame:
    """Findings of devices about figures that a tiny search has not seen."""
    stages = [COARSE]
    effort = HoldOut(
        halves={},
        start=2,
        pool={"structures": 2, "parts": 1, "stages": stages},
        round={"generations": 1, "population": 5, "stages": stages},
        final={"sets": 1, "stages": stages},
        grid="tiny",
        points=3,
        repeats=1,
        structures=2,
    )
    return hold_out(space_of(study, SEEN), space_of(study, UNSEEN), effort)


def test_a_search_knows_only_its_figures(study, space):
    part = space_of(study, SEEN)
    assert part.figures == SEEN
    assert not [name for name in part.names if name.startswith(UNSEEN)]
    assert part.identity != space.identity


def checked_by(space: Space, grid: str) -> set[str]:
    """Return the claims that only some figures can check, those on every figure left out."""
    names = {name for each in space.figures for name in space.of_figure(each, space.grid(grid))}
    return {
        claim.id
        for claim in CLAIMS
        if names & {*claim.figures} and claim.figures != EVERY_FIGURE
        and not (claim.check and claim.check.together and {*claim.figures} - names)
    }  # fmt: skip


def test_the_hold_out_judges_the_figures_that_the_search_has_not_seen(study, devices):
    shown = devices.drop(columns=["structure", "points"])
    for figures, rows in ((SEEN, shown[:1]), (UNSEEN, shown[1:])):
        claims = rows.columns[rows.notna().all()]
        assert set(claims) == checked_by(space_of(study, figures), "tiny")
        assert rows.drop(columns=claims).isna().all(axis=None)
    counts = devices.groupby(["structure", "points"]).size()
    assert counts["random"].to_dict() == {"claims": 2, "drawn": 6, "regime": 2}
    assert counts["searched"].to_dict() == {"claims": 1, "drawn": 3, "regime": 1, "seen": 1}


def test_points_chosen_by_regime_depend_on_no_claim(study, monkeypatch):
    unseen, random = space_of(study, UNSEEN), np.random.default_rng(4)
    priors = unseen.problem.operating_points
    points = {name: random.random((6, len(priors[name]))) for name in UNSEEN}

    def devices() -> list[dict[str, Any]]:
        return devices_of(unseen, np.full(7, 0.5), points, unseen.grid("tiny"))

    before = devices()
    monkeypatch.setattr(candidates, "short_of", lambda *_, **__: random.random())
    after = devices()
    assert [each["points"] for each in before] == ["drawn"] * 6 + ["regime", "claims"]
    assert before[:7] == after[:7]
    most = max(
        sum(value for name, value in each.items() if name != "points") for each in before[:7]
    )
    assert sum(value for name, value in before[7].items() if name != "points") >= most - 2


def test_shares_of_a_hold_out_add_up_to_its_counts(devices):
    counts, shares = summary_of({"even": devices})
    assert set(counts["half"]) == set(shares["half"]) == {"even"}
    for _, row in counts.iterrows():
        column = shares[f"{row.structure}, {row.points}"].dropna()
        assert column.sum() == pytest.approx(row["mean"])
        assert row["min"] <= row["mean"] <= row["max"] <= row.claims == len(column)


def test_the_hold_out_on_record_is_of_the_claims_and_halves_of_today(study):
    """Claims read anew, other figures in a half or another grid: `make hold-out` again."""
    spec, counts = study.identification.hold_out, measured()
    assert set(counts["half"]) == set(spec.halves)
    for half, rows in counts.groupby("half"):
        numbers = rows.set_index(["structure", "points"])
        claims = checked_by(space_of(study, spec.halves[half]), spec.grid)
        assert set(numbers["claims"].drop(("searched", "seen"))) == {len(claims)}
        assert numbers["count"]["searched", "drawn"] == spec.repeats * spec.points
        assert numbers["count"]["random", "claims"] == spec.structures
