"""The search: its unknowns, figures of many devices at once, and the choice of operating points."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
import yaml

from model.runs.unvibrated import unvibrated
from model.sweeps.sweep import merge, run
from study.claims import judge
from study.claims.data import figure_of
from study.claims.regime import regime_of
from study.config import load_study, study_path
from study.config.identification import Effort, Grid, Limits
from study.identification.batch import REST_HORIZON, REST_TOLERANCE, figures_of
from study.identification.search import Choice, Objective, missed, result_text, search
from study.identification.space import configuration, own_values, space_of, structure_of
from tests.study.made import NAN, made

TINY = Grid(
    counts={f"fig{number:02}": 6 for number in range(6, 15)} | {"fig05": 1, "fig14": [5, 4]},
    horizon=5.0,
    tolerance=1e-6,
)
EFFORT = {"seed": 5, "half_width": {"low": 0.8, "high": 1.2}, "limited": True,
          "drawn": 2, "moved": 1, "refined": 1}  # fmt: skip


@pytest.fixture(scope="module")
def study():
    return load_study(study_path())


@pytest.fixture(scope="module")
def space(study):
    found = space_of(study)
    rough = {"fig06": 6, "fig09": 6, "fig13": 6}
    grids = {"rough": TINY.model_copy(update={"counts": rough}), "coarse": TINY, "fine": TINY}
    problem = found.problem.model_copy(update={"grids": grids})
    return found.model_copy(update={"problem": problem})


@pytest.fixture(scope="module")
def structure(study, space):
    """Coordinates of the study's own structure."""
    return space.point(own_values(study, space))[space.places["structure"]]


def points_of(space, counts, seed=0):
    """Random operating points, as many of each figure as ``counts`` states, or 2."""
    random = np.random.default_rng(seed)
    return {
        name: random.random((counts.get(name, 2), where.stop - where.start))
        for name, where in space.places.items() if name != "structure"
    }  # fmt: skip


def test_the_unknowns_of_the_study_make_its_own_device(study, space) -> None:
    values = own_values(study, space)
    for name, value in structure_of(values).items():
        assert value == pytest.approx(study.structure[name], rel=1e-14), name
    stated = configuration(space, values)
    for name, value in stated["structure"].items():
        assert value == pytest.approx(study.structure[name], rel=1e-3)
    for figure, held in stated["held"].items():
        assert held == pytest.approx({**study.figures[figure].held}, rel=1e-3)


def test_coordinates_are_values_on_log_axes(space) -> None:
    point = np.random.default_rng(1).random(len(space.names))
    np.testing.assert_allclose(space.point(space.values(point)), point, atol=1e-12)
    assert space.values(np.zeros(len(space.names)))["half_width"] == 0.15
    low, high = space.half_widths(space.problem.structure["half_width"])
    assert (low, high) == (0.0, 1.0)


def test_figures_of_many_devices_are_those_that_their_sweeps_give(space) -> None:
    random = np.random.default_rng(3)
    values = [space.values(random.random(len(space.names))) for _ in range(2)]
    sweeps = [
        [space.sweep(each, name, TINY) for name in ("fig05", "fig06", "fig14")] for each in values
    ]
    for figures, of_device in zip(figures_of(sweeps), sweeps, strict=True):
        for sweep in of_device:
            alone = figure_of(merge(sweep, "", [run(sweep)]).assign(sensitive=_regular(sweep)))
            for result in ("outcome", "tau_align", "separations"):
                found = figures[sweep.name].results[result]
                np.testing.assert_array_equal(found, alone.results[result])
        assert figures["fig14"].results["outcome"].shape == (5, 4)


def _regular(sweep):
    return [*sweep.swept], np.zeros(sweep.shape)


def test_aligned_runs_have_the_controls_of_their_sweep(space, study) -> None:
    sweep = space.sweep(own_values(study, space), "fig09", TINY)
    figure = figures_of([[sweep]])[0]["fig09"]
    runs = figure.whole
    batch = sweep.batch(np.flatnonzero(runs.aligned))
    still = replace(sweep.settings.settings, horizon=REST_HORIZON, tolerance=REST_TOLERANCE)
    ends = unvibrated(batch, still)
    np.testing.assert_array_equal(runs.result("unvibrated")[runs.aligned], ends.outcome)


def test_figure_10_is_about_the_inertia_of_the_device(space) -> None:
    values = space.values(np.full(len(space.names), 0.3))
    axis = space.sweep(values, "fig10", TINY).dimensions[1]
    inertia = structure_of(values)["inertia"]
    assert (axis.start, axis.stop) == (0.5 * inertia, 2.0 * inertia)


def test_the_chosen_points_are_the_best_of_all_combinations(space, structure) -> None:
    tried = dict.fromkeys(("fig06", "fig08", "fig12"), 2)
    points = points_of(space, dict.fromkeys(space.figures, 1) | tried, seed=7)
    choice = Choice(space, Objective(space.problem.limits), structure, points, TINY)
    every = [
        choice.score(dict.fromkeys(space.figures, 0) | dict(zip(tried, rows, strict=True)))
        for rows in itertools.product(range(2), repeat=3)
    ]
    assert choice.best(np.random.default_rng(7)).score == pytest.approx(max(every))


def limits() -> Limits:
    return Limits(
        not_resting=0.1, not_resting_most=0.5, tilt=0.2, corners=0.97, aligned_least=0.05,
        aligned={"fig06": 0.4}, hops={"fig06": 0.3},
    )  # fmt: skip


@pytest.mark.parametrize(
    ("changes", "sizes"),
    [
        ({}, 0.0),
        ({"separations": 1}, 2.0),  # all hop: more than three times the limit
        ({"tilt_at_alignment": 0.3}, 0.5),  # half of the limit more
        ({"unvibrated": 0}, 1.0),  # none rests: twice the limit
    ],
)
def test_a_limit_counts_by_how_much_it_is_missed(changes, sizes) -> None:
    regime = regime_of(made("fig06", lambda _, f: 1.0 if f <= 10.0 else NAN, **changes))
    assert missed(limits(), "fig06", regime) == pytest.approx(sizes)
    dear = Objective(limits(), limit=9.0)
    assert dear.missed("fig06", regime) == pytest.approx(9.0 * sizes)
    assert Objective(None).missed("fig06", regime) == 0.0
    free = limits().model_copy(update={"hops": {}})  # may hop
    hopping = 2.0 if "separations" in changes else 0.0
    assert missed(free, "fig06", regime) == pytest.approx(sizes - hopping)


def test_figures_computed_before_are_those_that_are_computed_anew(space, structure) -> None:
    points = points_of(space, {}, seed=4)
    rule = Objective(space.problem.limits)
    anew = Choice(space, rule, structure, points, TINY)
    first = {name: figures[0] for name, figures in anew.figures.items()}
    again = Choice(space, rule, structure, points, TINY, first)
    for name, figures in again.figures.items():
        assert figures[0] is first[name]
        for result, values in figures[1].results.items():
            np.testing.assert_array_equal(values, anew.figures[name][1].results[result])


def test_a_figure_that_never_aligns_misses_every_limit() -> None:
    nothing = regime_of(made("fig06", lambda _, __: NAN))
    assert missed(limits(), "fig06", nothing) > 7.0


def test_the_same_seed_ends_at_the_same_set_within_its_bounds(space, monkeypatch) -> None:
    monkeypatch.setattr("study.identification.search._OF_ONE_RUN", 8)  # a search tries a thousand
    effort = Effort.model_validate(EFFORT)
    found, again = search(space, effort), search(space, effort)
    np.testing.assert_array_equal(found.point, again.point)
    assert 0.8 <= space.values(found.point)["half_width"] <= 1.2
    stated = yaml.safe_load(result_text(space, found))
    assert stated["entries"] == len(found.shown) == len(stated["shown"].split())
    assert set(stated["held"]) == set(space.figures)


def test_a_search_by_an_entry_that_is_none_is_refused(space) -> None:
    effort = Effort.model_validate(EFFORT | {"entries": ["L01", "L99"]})
    with pytest.raises(ValueError, match="the ledger has no L99"):
        search(space, effort)


def test_an_entry_of_a_conclusion_counts_as_often_as_it_is_asked_to(space, structure) -> None:
    points = points_of(space, dict.fromkeys(space.figures, 1), seed=1)
    row = dict.fromkeys(points, 0)
    for entry, weight in (("L12", 3.0), ("L01", 1.0)):  # of conclusion 1; of section 3
        nothing, once, asked = (
            Choice(space, Objective(None, entries, times), structure, points, TINY).score(row)
            for entries, times in (([], 1.0), ([entry], 1.0), ([entry], 3.0))
        )
        assert once > nothing == 0.0
        assert asked == pytest.approx(weight * once)


def test_entries_held_out_judge_no_set_but_are_told(space, structure) -> None:
    points = points_of(space, {}, seed=2)
    none, one, other, both = (
        Choice(space, Objective(space.problem.limits, entries), structure, points, TINY)
        for entries in ([], ["L01"], ["L12"], ["L01", "L12"])
    )
    for row in range(2):
        limits, first, second, together = (
            each.score(dict.fromkeys(points, row)) for each in (none, one, other, both)
        )
        assert together - limits == pytest.approx(first + second - 2.0 * limits)
        assert first > limits
    found = none.best(np.random.default_rng(3))
    rows = {name: int(np.flatnonzero((points[name] == found.point[space.places[name]]).all(1))[0])
            for name in points}  # fmt: skip
    chosen = {name: none.figures[name][row] for name, row in rows.items()}
    told = {claim.id for claim, verdict in judge(chosen) if verdict.verdict == "shown"}
    assert {*found.shown} == told
