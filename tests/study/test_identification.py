"""The identification: what a candidate stands for, how it is judged, and that a search repeats."""

import math
from pathlib import Path

import numpy as np
import pytest

from model.events.outcomes import Outcome, Unvibrated
from model.physics.parameters import Parameters
from model.study.claims import CLAIMS
from model.study.claims.reading import Data
from model.study.claims.regime import regime_of, summary_of
from model.study.config import (
    CURVES,
    HISTORIES,
    MAPS,
    ConfigError,
    Descent,
    Evolution,
    Pool,
    Study,
    check_study,
    load_study,
    study_path,
)
from model.study.csv_tables import TableError
from model.study.identification import band_table, bands
from model.study.identification.candidate import (
    Space,
    bare_inertia,
    readings_of,
    searched_of,
    space_of,
    space_of_figures,
    structure_of,
)
from model.study.identification.committed import IdentificationError, read_identified
from model.study.identification.descent import descended
from model.study.identification.evaluate import datasets_of
from model.study.identification.front import Wanted
from model.study.identification.refine import refined, trials_of
from model.study.identification.results import configured, made_with, search_of, split_of
from model.study.identification.score import Judge, judge_of, reproduced_shares
from model.study.identification.search import Found, joined

CONFIGURED = load_study(study_path())
LAW = CONFIGURED.identification.law
SEARCHED_CURVES = tuple(name for name in CURVES if name in LAW.counts)  # those of the paper
SEARCHED_MAPS = tuple(name for name in MAPS if name in LAW.counts)
COMPUTED = HISTORIES + SEARCHED_CURVES + SEARCHED_MAPS
COMMITTED = study_path().parent / "identification"


@pytest.fixture(scope="module")
def study() -> Study:
    return load_study(study_path())


def coarsest(study: Study) -> Study:
    """The study with the smallest grids that the law admits."""
    law = study.identification.law
    few = law.model_copy(
        update={
            "counts": dict.fromkeys(law.counts, 4),
            "run_counts": dict.fromkeys(law.run_counts, 2),
            "horizon": 10.0,
        }
    )
    identification = study.identification.model_copy(update={"law": few})
    return study.model_copy(update={"identification": identification})


@pytest.fixture(scope="module")
def space(study: Study) -> Space:
    return space_of(coarsest(study))


@pytest.fixture(scope="module")
def judge(space: Space) -> Judge:
    return judge_of(space)


def test_a_point_and_its_values_are_one_another(space: Space) -> None:
    points = np.random.default_rng(1).random((20, len(space.names)))
    np.testing.assert_allclose(space.point(space.values(points)), points, atol=1e-12)
    ends = space.values(np.array([np.zeros(len(space.names)), np.ones(len(space.names))]))
    law = space.law
    ranges = [*law.structure.values()]
    ranges += [each for part in law.operating_points.values() for each in part.values()]
    np.testing.assert_allclose(ends[0], [each.low for each in ranges])
    np.testing.assert_allclose(ends[1], [each.high for each in ranges])


def test_a_structure_and_what_is_searched_of_it_are_one_another(study: Study) -> None:
    searched = searched_of(study.structure)
    for name, value in structure_of(searched).items():
        assert value == pytest.approx(study.structure[name], rel=1e-12), name


def test_damping_ratios_are_those_of_single_springs() -> None:
    searched = {
        "half_width": 1.0,
        "half_height": math.sqrt(2.0),
        "inertia_ratio": 2.5,
        "lateral_stiffness": 0.25,
        "lateral_damping_ratio": 1.0,
        "axial_damping_ratio": 1.0,
        "tilt_damping_ratio": 1.0,
    }
    found = structure_of(searched)
    # ẍ + h ẋ + k x has a double root, and does not oscillate, where h² = 4 k; I = 2.5 · (1 + 2)/3.
    assert found["inertia"] == pytest.approx(2.5)
    assert found["lateral_damping"] ** 2 == pytest.approx(4.0 * 0.25)
    assert found["axial_damping"] ** 2 == pytest.approx(4.0)
    assert (found["tilt_damping"] / 2.5) ** 2 == pytest.approx(4.0 * 10.0 / 2.5)


def test_the_priors_are_what_they_are_said_to_be(study: Study) -> None:
    law = study.identification.law
    # Fig. 5: the start is misaligned, 0.2 - δ a >= 0.05 with δ = 0.09.
    assert 0.2 - 0.09 * law.structure["half_width"].high >= 0.05 - 1e-4
    assert law.structure["inertia_ratio"].low >= 1.0
    for name in ("lateral", "axial", "tilt"):
        assert law.structure[f"{name}_damping_ratio"].high <= 1.0


def test_the_studys_own_device_keeps_the_priors(study: Study) -> None:
    law = study.identification.law
    for name, value in searched_of(study.structure).items():
        assert law.structure[name].low <= value * 1.001, name
        assert value <= law.structure[name].high * 1.001, name
    for figure, ranges in law.operating_points.items():
        held = study.parameters(figure)
        for name, each in ranges.items():
            assert each.low <= getattr(held, name) <= each.high, (figure, name)


def test_what_the_paper_states_is_not_searched(study: Study, space: Space) -> None:
    point = np.random.default_rng(2).random(len(space.names))
    assert space.sweep(point, "fig06").parameters["frequency"] == 10.0
    assert space.sweep(point, "fig12").parameters["frequency"] == 0.5
    for figure in COMPUTED:
        parameters = space.sweep(point, figure).parameters
        assert parameters["contact_stiffness"] == 100.0
        assert parameters["rest_y"] is None
    assert study.parameters("fig06").frequency == 10.0
    assert study.parameters("fig12").frequency == 0.5


def test_own_runs_stand_at_their_figures_operating_point(study: Study, space: Space) -> None:
    point = np.random.default_rng(6).random(len(space.names))
    assert sorted(space.everything) == sorted([*COMPUTED, *study.claims_runs])
    for name, run in study.claims_runs.items():
        sweep = space.sweep(point, name)
        expected = space.sweep(point, run.figure).parameters | run.held
        if run.centred:
            start = Parameters(**expected)
            assert sweep.parameters["misalignment"] == pytest.approx(start.slot_half_width)
            expected["misalignment"] = sweep.parameters["misalignment"]
        assert sweep.parameters == expected
    # What is not vibrated is given the time to come to rest.
    assert space.sweep(point, "pressed").settings.horizon > space.law.horizon


def test_fig_10_begins_at_the_inertia_of_the_bare_part(space: Space) -> None:
    point = np.random.default_rng(3).random(len(space.names))
    axis = space.sweep(point, "fig10").dimensions[1]
    assert axis.parameter == "inertia"
    assert axis.values[0] == pytest.approx(bare_inertia(space.structure(point)))


def test_readings_are_presets_or_one_correction() -> None:
    assert set(readings_of("consistent").values()) == {"consistent"}
    assert set(readings_of("printed").values()) == {"printed"}
    alone = readings_of("preload")
    assert alone.pop("preload") == "consistent"
    assert set(alone.values()) == {"printed"}
    with pytest.raises(ValueError, match="unknown reading 'preloaded'"):
        readings_of("preloaded")


def test_a_batch_of_candidates_is_scalar_engine(space: Space) -> None:
    points = np.random.default_rng(4).random((3, len(space.names)))
    together = datasets_of(space, points, ("fig07", "fig13"))
    for point, datasets in zip(points, together, strict=True):
        (alone,) = datasets_of(space, point[None], ("fig07", "fig13"))
        for name in ("fig07", "fig13"):
            assert alone[name].identical(datasets[name])


def test_what_can_be_checked_is_judged_and_what_is_set_aside_does_not_count(judge: Judge) -> None:
    measured = [claim for claim in CLAIMS if claim.check is not None]
    computed = {*COMPUTED, *CONFIGURED.claims_runs}
    checked = {claim.id for claim in measured if computed.intersection(claim.figures)}
    assert set(judge.ids) == checked | {"N1 (Fig. 5)"}
    assert {"M3", "M4", "F8d", "F8f", "C1b", "C2a", "C6"} <= set(judge.ids)
    counted = dict(zip(judge.ids, judge.counted.tolist(), strict=True))
    aside = [name for name, counts in counted.items() if not counts]
    assert aside == ["C6", "C2a", "N1 (Fig. 5)"]


def test_what_is_required_of_a_figure_is_judged_by_it_alone(space: Space, judge: Judge) -> None:
    point = np.random.default_rng(11).random(len(space.names))
    (made,) = datasets_of(space, point[None], ("fig05", "fig12"))
    fifth, whole = judge.ids.index("N1 (Fig. 5)"), judge.ids.index("N1")
    for separations, holds in ((0, True), (3, False)):
        fig05 = made["fig05"].assign(separations=separations, outcome=float(Outcome.ALIGNED))
        hopping = made["fig12"].assign(separations=made["fig12"]["separations"] + 1.0)
        margins, _ = judge.judged({"fig05": fig05, "fig12": hopping})
        assert (margins[fifth] > 0.0) == judge.holds(margins) == holds
        assert margins[whole] < 0.0


def test_what_is_required_weighs_more_than_a_claim_and_in_no_half(judge: Judge) -> None:
    fifth = judge.ids.index("N1 (Fig. 5)")
    shown = np.full(len(judge.claims), judge.goal)
    lacking, one_less = shown.copy(), shown.copy()
    lacking[fifth], one_less[0] = -0.5, -0.5
    assert judge.score(lacking) < judge.score(one_less) < judge.score(shown)
    assert judge.reproduced(lacking) == judge.reproduced(shown) == judge.counted.sum()
    half = judge.counting(judge.halves(2007, 0)[0])
    assert half.score(lacking) == half.score(shown)
    assert half.holds(lacking)


def test_contenders_hold_what_is_required_and_differ_in_structure(judge: Judge) -> None:
    fifth = judge.ids.index("N1 (Fig. 5)")
    assert judge.counted[:3].all()
    margins = np.full((4, len(judge.claims)), 0.1)
    margins[0, fifth] = -0.1  # reproduces all that counts, but lifts off
    margins[1, :2] = -0.1
    margins[2, :1] = -0.1
    margins[3, :3] = -0.1
    structures = np.array([[0.1] * 7, [0.2] * 7, [0.2] * 7, [0.3] * 7])
    assert judge.contenders(structures, margins, 4).tolist() == [2, 3, 0]
    assert judge.contenders(structures, margins, 1).tolist() == [2]


def test_a_claim_not_shown_is_not_made_up_for_by_others_shown_clearly(judge: Judge) -> None:
    size = len(judge.claims)
    barely = np.full(size, judge.goal)
    clearly = np.full(size, 0.9)
    clearly[0] = -0.1
    assert judge.counted[0]
    assert judge.score(barely) > judge.score(clearly) - 0.1 * 0.9 * size
    better, worse = barely.copy(), barely.copy()
    worse[0] = -0.2
    assert judge.score(better) > judge.score(worse)
    aside = judge.ids.index("C2a")
    better[aside] = -1.0
    assert judge.score(better) == judge.score(barely)


def test_each_half_asks_something_of_every_figure(judge: Judge) -> None:
    first, second = judge.halves(2007, 0)
    for figure in ("fig05", "fig06", "fig07", "fig08", "fig09", "fig11", "fig14"):
        shown_by = np.array([claim.figures[0] == figure for claim in judge.claims])
        assert (shown_by & first).any(), figure
        assert (shown_by & second).any(), figure


def test_halves_share_no_claim_and_hold_all(judge: Judge) -> None:
    splits = [judge.halves(2007, number) for number in range(5)]
    for first, second in splits:
        assert not (first & second).any()
        assert ((first | second) == judge.counted).all()
        assert abs(int(first.sum()) - int(second.sum())) <= 1
    assert len({first.tobytes() for first, _ in splits}) == 5


def test_a_claim_that_weighs_more_decides_between_sets(judge: Judge) -> None:
    rest, other = judge.ids.index("M4b"), judge.ids.index("F6a")
    margins = np.full((2, len(judge.claims)), judge.goal)
    margins[0, rest], margins[1, [other, other + 1]] = -0.3, -0.3
    assert judge.score(margins).argmax() == 0, "one claim less, not two"
    heavy = judge.weighing(["M4b"], 8.0)
    assert heavy.score(margins).argmax() == 1
    np.testing.assert_array_equal(heavy.reproduced(margins), judge.reproduced(margins))
    np.testing.assert_allclose(reproduced_shares(margins)[[rest, other]], [0.5, 0.5])


def test_points_that_align_carry_their_unvibrated_twin(space: Space) -> None:
    point = np.random.default_rng(12).random((3, len(space.names)))
    for made in datasets_of(space, point, ("fig05", "fig06", "fig14", "rubbing")):
        assert "unvibrated" not in made["rubbing"]
        for name in ("fig05", "fig06", "fig14"):
            dataset = made[name]
            aligned = dataset["outcome"].values == Outcome.ALIGNED
            ends = dataset["unvibrated"].values
            np.testing.assert_array_equal(np.isfinite(ends), aligned)
            tilts = dataset["unvibrated_tilt"].values
            np.testing.assert_array_equal(np.isfinite(tilts), ends == Unvibrated.RESTS)
        # The twin of a map over the frequency does not depend on it.
        known = np.ma.masked_invalid(made["fig14"]["unvibrated"].values)
        assert (known.max(axis=0) == known.min(axis=0)).all()


def test_of_sets_that_show_as_much_the_one_contradicted_least_is_chosen(judge: Judge) -> None:
    margins = np.full((3, len(judge.claims)), 0.1)
    margins[0, :2], margins[1, 1:3], margins[2, 0] = -0.1, -0.9, -0.9
    assert judge.order(margins, [1, 2, 1])[0] == 2  # reproduces one more
    assert judge.order(margins[:2], [2, 1])[0] == 1
    assert judge.order(margins[:2], [1, 1])[0] == 0  # the score decides
    margins[2, judge.ids.index("N1 (Fig. 5)")] = -0.1
    assert judge.order(margins, [1, 2, 1])[0] == 0  # the other does not show what it must


def test_a_split_counts_each_half_by_itself() -> None:
    first, second = np.array([True, True, False, False]), np.array([False, False, True, True])
    possible = np.array([True, True, True, False])
    split = split_of(0, (first, second), np.array([0.1, 0.2, 0.3, -0.1]), possible)
    assert (split.searched_reproduced, split.held_out_reproduced) == (2, 1)
    assert split.rate == 0.5
    assert (split.possible, split.possible_reproduced, split.rate_of_possible) == (1, 1, 1.0)


def test_a_search_repeats_itself_with_the_margins_of_its_points(space: Space, judge: Judge) -> None:
    search = search_of(space)
    pool = Pool(structures=6, operating_points=2, chunks=2)
    samples = search.sample(pool, 0)
    assert samples.points.shape == (3, 2, len(space.names))
    structure = space.places["structure"]
    np.testing.assert_array_equal(samples.points[:, 0, structure], samples.points[:, 1, structure])
    evolution = Evolution(population=5, generations=1, trials=2, polished=1, passes=1, polish=3)
    whole = search.sample(Pool(structures=5, operating_points=2, chunks=1), 0)
    first = search.run(whole, evolution, 0, 0)
    found = search.run(whole, evolution, 0, 1, first)
    np.testing.assert_array_equal(found.points, search.run(whole, evolution, 0, 1, first).points)
    np.testing.assert_array_equal(found.points[: len(first.points)], first.points)
    assert 6 + 6 <= len(found.points) <= 22  # hopeless ones are not kept
    begun = search.first_population(whole, 5)
    np.testing.assert_allclose(found.points[:5, structure], begun[:, structure], atol=1e-15)
    known = found.points[-1:]
    from_known = search.run(whole, evolution, 0, 0, known=known)
    np.testing.assert_allclose(from_known.points[0, structure], known[0, structure], atol=1e-15)
    # The margins and the regime are those of the figures of the point; what is left to the finer
    # grids has the worst margin.
    (datasets,) = datasets_of(space, known, space.searched)
    margins, _ = judge.judged(datasets)
    np.testing.assert_array_equal(margins, found.margins[-1])
    regimes = [regime_of(Data(datasets), name) for name in space.figures]
    np.testing.assert_array_equal(summary_of(regimes), found.regimes[-1])
    assert margins[judge.ids.index("M4")] == -1.0
    again, against = search.judged(known)
    assert again.margins[0, judge.ids.index("M1")] > 0.0
    failing = judge.counted & (again.margins[0] <= 0.0)
    assert 0 <= against[0] <= failing.sum()


def test_a_structure_without_hope_is_not_judged_to_the_end(space: Space) -> None:
    search = search_of(space)
    trials = np.repeat(np.random.default_rng(13).random((1, len(space.names))), 2, axis=0)
    others: list[float] = []
    assert search.fit(trials, 1e3, others) is not None, "nothing is known of the other figures"
    assert len(others) == 1
    assert search.fit(trials, 1e3, others) is None
    assert len(others) == 1


def test_operating_points_chosen_by_the_aims_are_no_worse(study: Study, space: Space) -> None:
    search, aims = search_of(space), study.identification.aims
    wanted = Wanted(aims, space.everything)
    points = np.random.default_rng(14).random((3, len(space.names)))
    trials = trials_of(search, points[0], points, 5, 0)
    np.testing.assert_array_equal(trials[0], points[0])
    assert (trials[:, : search.size] == points[0, : search.size]).all()
    np.testing.assert_array_equal(trials[2, search.size :], points[1, search.size :])
    assert refined(search, trials, wanted, most=0.0) is None, "given up at the first figure"
    found = refined(search, trials, wanted)
    own, _ = search.judged(points[:1])
    before, after = (
        wanted.worst(search.judge, each.margins, each.regimes)[0] for each in (own, found)
    )
    assert round(after, 2) <= round(before, 2)
    # Margins and regime are those of the point that is returned.
    again, _ = search.judged(found.points)
    np.testing.assert_array_equal(again.margins, found.margins)
    np.testing.assert_array_equal(again.regimes, found.regimes)


def test_the_search_by_the_aims_begins_from_the_best_and_varies_structures(
    study: Study, space: Space
) -> None:
    search = search_of(space)
    wanted = Wanted(study.identification.aims, space.searched)
    drawn = np.random.default_rng(15).random((2, len(space.names)))
    known = joined([search.fit(each[None], -np.inf, []) for each in drawn])
    found = descended(search, known, wanted, Descent(structures=3, trials=2), 0)
    assert len(found.points) == 3

    def worst(candidates: Found) -> dict[tuple[float, ...], tuple[bool, float]]:
        ratios = wanted.ratios(search.judge, candidates.margins, candidates.regimes).max(axis=1)
        held = search.judge.holds(candidates.margins)
        return {
            tuple(point[: search.size]): (not holds, round(ratio, 2))
            for point, holds, ratio in zip(candidates.points, held, ratios, strict=True)
        }

    before, after = worst(known), worst(found)
    assert set(before) < set(after), "the best as they are, and one beside"
    assert all(after[structure] <= before[structure] for structure in before)


def test_the_device_is_chosen_on_the_grids_of_the_figures(study: Study) -> None:
    own = space_of_figures(study)
    for name in SEARCHED_CURVES:
        swept = study.figures[name].swept
        if name == "fig10":  # in units of the bare part's inertia, which is the candidate's
            swept = swept.model_copy(update={"start": 1.0, "stop": 4.0})
        assert own.dimensions[name] == [study.figures[name].family, swept]
    for name in SEARCHED_MAPS:
        figure = study.figures[name]
        assert [axis.count for axis in own.dimensions[name]] == [figure.y.count // 2] * 2
    for name, run in study.claims_runs.items():
        assert own.dimensions[name] == [run.family, run.swept]


def test_another_device_of_the_study_is_no_other_search(study: Study) -> None:
    changed = study.model_dump()
    changed["structure"]["half_width"] *= 1.1
    changed["figures"]["fig06"]["held"]["friction"] *= 1.1
    changed["figures"]["fig10"]["swept"]["stop"] *= 1.1
    assert space_of(check_study(changed)).identity == space_of(study).identity


def test_a_candidate_as_configured_is_the_candidate(study: Study, space: Space) -> None:
    point = np.random.default_rng(7).random(len(space.names))
    stated = configured(space, point)
    changed = study.model_dump()
    changed["structure"] |= stated["structure"]
    for figure, held in stated["held"].items():
        changed["figures"][figure]["held"] = held
    again = check_study(changed)
    for figure in COMPUTED:
        expected = space.sweep(point, figure).baseline
        found = again.parameters(figure)
        for name, value in found.given().items():
            if value is not None:
                assert value == pytest.approx(getattr(expected, name), rel=1e-3), (figure, name)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"counts": {"fig06": 10}}, "counts: missing fig07"),
        ({"structure": {"half_widht": {"low": 1.0, "high": 2.0}}}, "Did you mean 'half_width'"),
        ({"run_counts": {"presed": 4}}, "Did you mean 'pressed'"),
        ({"counts": dict.fromkeys((*LAW.counts, "fig99"), 4)}, "fig99"),
        ({"counts": dict.fromkeys((*LAW.counts, "fig05"), 4)}, "reading_counts: must name"),
        ({"stated": {"fig01": {"frequency": 1.0}}}, "fig01"),
        ({"required": {"fig03": ["N1"]}}, "fig03"),
    ],
)
def test_a_law_that_cannot_be_searched_is_refused(
    study: Study, change: dict[str, object], message: str
) -> None:
    mapping = study.model_dump()
    mapping["identification"]["law"] |= change
    with pytest.raises(ConfigError, match=message):
        check_study(mapping)


def test_what_the_law_does_not_name_is_not_searched(study: Study) -> None:
    """A run that the study gains changes neither the search nor its committed tables."""
    law = study.identification.law
    turned = dict(reversed(study.figures.items()))
    assert space_of(study.model_copy(update={"figures": turned})) == space_of(study), "any order"
    gained = study.claims_runs | {"more": study.claims_runs["rubbing"]}
    assert space_of(study.model_copy(update={"claims_runs": gained})) == space_of(study)
    fewer = {
        "counts": {name: count for name, count in law.counts.items() if name != "fig10"},
        "operating_points": {
            name: each for name, each in law.operating_points.items() if name != "fig10"
        },
        "run_counts": {"pressed": 4},
    }
    identification = study.identification.model_copy(update={"law": law.model_copy(update=fewer)})
    space = space_of(study.model_copy(update={"identification": identification}))
    assert "fig10" not in space.figures
    assert [name for name in space.everything if name not in space.figures] == ["pressed"]
    assert not {"F10", "M3", "F8f"} & set(judge_of(space).ids)
    assert {"F6a", "M4", "N1"} <= set(judge_of(space).ids)


def test_the_committed_tables_name_the_search_and_the_claims_they_were_made_with(
    study: Study,
) -> None:
    space, found = space_of(study), read_identified(COMMITTED)
    judge = judge_of(space)
    now = made_with(space, judge)
    assert set(found.made_with) == set(now), "whether they are the study's is said in the report"
    sets = found.points(space.names)
    assert sets.shape == (len(next(iter(found.ensemble.values()))), len(space.names))
    with pytest.raises(IdentificationError, match=r"lacks fig15\.friction: run"):
        found.points([*space.names, "fig15.friction"])
    other = space_of(study, finer=3)
    assert made_with(other, judge)["search"] != now["search"]
    fewer = Judge(
        judge.claims[1:], judge.counted[1:], judge.goal, judge.required[1:], judge.weights[1:]
    )
    assert made_with(space, fewer)["claims"] != now["claims"]


def test_a_set_found_before_must_name_every_unknown(study: Study, space: Space) -> None:
    for stated in study.identification.known.values():
        np.testing.assert_allclose(space.values(space.point_of(stated)), list(stated.values()))
    with pytest.raises(ValueError, match="known: missing half_height"):
        space.point_of({"half_width": 1.0})


def test_bands_are_quantiles_of_the_sets_that_align(space: Space, tmp_path: Path) -> None:
    taus = np.array([[[1.0, 5.0, np.nan]], [[2.0, np.nan, np.nan]], [[3.0, 7.0, 1.0]]])
    point = np.random.default_rng(8).random(len(space.names))
    (band,) = bands.of_durations([0.3], np.array([1.0, 2.0, 3.0]), taus)
    assert band.at == 0.3
    np.testing.assert_allclose(band.aligned, [1.0, 2.0 / 3.0, 1.0 / 3.0])
    np.testing.assert_allclose(band.middle, [2.0, 6.0, np.nan])
    np.testing.assert_allclose(band.high, [2.9, 6.9, np.nan])
    found = bands.bands_of(space.only(SEARCHED_CURVES), point[None])
    assert set(found) == set(SEARCHED_CURVES)
    assert found["fig10"][0].x[0] == pytest.approx(1.0)
    table = tmp_path / "bands.csv"
    table.write_text(band_table.bands_text(found), "utf-8")
    again = band_table.read_bands(table)
    for name, each in found.items():
        for one, other in zip(each, again[name], strict=True):
            np.testing.assert_allclose(other.middle, one.middle, rtol=1e-3)
    table.write_text("figure,at,x\nfig06,5,1\n", "utf-8")
    with pytest.raises(TableError, match="is not a table of bands"):
        band_table.read_bands(table)
