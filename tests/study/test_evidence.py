"""Worth of the verdicts: random draws, other assumptions, and evidence in bits."""

import numpy as np
import pytest

from study.claims import CLAIMS, VERDICTS
from study.claims.ledger import Line
from study.config import FIGURES, ConfigError, Study, check_study, read_study, study_path
from study.evidence import worth
from study.evidence.assumptions import OWN, assumptions_dataset, assumptions_plan
from study.evidence.null import REPRODUCED, drawn, merged, null_plan, part_of
from study.identification.space import own_values, space_of, structure_of

TITLES = ["random", "points", "near", "farther"]


@pytest.fixture(scope="module")
def study() -> Study:
    """The study with few draws on a tiny grid."""
    stated = read_study(study_path())
    counts = {**dict.fromkeys(FIGURES[4:], 3), "fig05": 1, "rubbing": 2, "pressed": 2}
    few = {"count": 3, "parts": 2}
    stated["evidence"] |= {
        "grid": {"counts": counts, "horizon": 5.0, "tolerance": 1e-5},
        "draws": {name: each | few for name, each in stated["evidence"]["draws"].items()},
        "assumptions": {
            name: stated["evidence"]["assumptions"][name] for name in ("stiff", "inserted")
        },
    }
    return check_study(stated)


@pytest.fixture(scope="module")
def plans(study):
    return {kind: null_plan(study, kind) for kind in study.evidence.draws}


@pytest.fixture(scope="module")
def parts(plans):
    return [part_of(plan, part) for plan in plans.values() for part in range(2)]


@pytest.fixture(scope="module")
def null(plans, parts):
    return merged(plans, TITLES, parts)


def test_the_unknowns_of_the_study_make_its_own_device(study):
    values = own_values(study, space_of(study))
    for name, value in structure_of(values).items():
        assert value == pytest.approx(study.structure[name], rel=1e-14), name
    assert values["fig08.press_force"] == study.figures["fig08"].held["press_force"]


def test_draws_are_the_same_whenever_and_in_however_many_parts_they_are_computed(plans, parts):
    plan = plans["devices"]
    assert part_of(plan, 1).identical(parts[1])
    whole = part_of(
        plan.model_copy(update={"draws": plan.draws.model_copy(update={"parts": 1})}), 0
    )
    assert np.array_equal(whole["verdict"], np.concatenate([each["verdict"] for each in parts[:2]]))
    assert len(np.unique(drawn(plan)[:, 0])) == plan.draws.count


def test_a_kind_of_draws_keeps_what_it_says(plans):
    space, own = plans["points"].space, plans["points"].own
    where = space.places["structure"]
    points = drawn(plans["points"])
    assert np.all(points[:, where] == space.point(own)[where])
    assert np.all(np.ptp(points[:, where.stop :], axis=0) > 0.0)
    for kind, step in (("off_2", 0.02), ("off_5", 0.05)):
        ratios = [
            value / own[name]
            for point in drawn(plans[kind])
            for name, value in space.values(point).items()
            if name != "inertia_ratio"  # of the study's device it is at the end of its prior
        ]
        sides = np.abs(np.log(ratios))
        assert sides.max() == pytest.approx(np.log1p(step), rel=1e-9)
        assert np.mean(np.isclose(sides, np.log1p(step))) > 0.9  # the others are held in the priors
        assert min(ratios) < 1.0 < max(ratios)


def test_random_devices_stay_those_they_are_if_the_study_has_another(study, plans):
    other = study.model_copy(update={"structure": {**study.structure, "half_width": 1.0}})
    assert null_plan(other, "devices").identity == plans["devices"].identity
    assert null_plan(other, "points").identity != plans["points"].identity


def test_a_share_counts_the_draws_of_its_kind_that_reproduce_a_claim(plans, parts, null):
    made = [each.copy(deep=True) for each in parts]
    for part in made:
        part["verdict"][:] = VERDICTS.index("mixed")
    made[0]["verdict"][0, 4] = REPRODUCED
    found = merged(plans, TITLES, made)["share"]
    assert found[0, 4] == pytest.approx(1 / 3)
    assert found.sum() == pytest.approx(1 / 3)
    assert [each.numbers.tolist() for each in worth.shown_by(merged(plans, TITLES, made))] == [
        [1, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0],
    ]  # fmt: skip
    assert null["claim"].values.tolist() == [claim.id for claim in CLAIMS]
    with pytest.raises(ValueError, match="build them again"):
        merged(plans, TITLES, parts[1:])


def line(claim: str, verdict: str = "reproduced", demand: str = "at least 1") -> Line:
    return Line(claim, verdict, *[""] * 5, demand, *[""] * 5)


def test_evidence_is_added_up_in_bits_and_no_share_is_below_one_draw(null):
    shares = null.copy(deep=True)
    shares["share"][0] = 0.5
    first, second, third, fourth, *_ = shares["claim"].values.tolist()
    shares["share"][0, :4] = [1.0, 0.5, 0.0, 0.0]
    lines = [line(first), line(second), line(third), line(fourth, "mixed"), line("M8", "", "")]
    weighed = worth.weighed(lines, shares)
    floor = np.log2(3.0)  # of three draws
    bits = [each.bits for each in weighed]
    assert bits == ["0.00", "1.00", f"{floor:.2f}", "", ""]
    assert [each.random_devices for each in weighed] == ["1.000", "0.500", "0.000", "0.000", ""]
    assert worth.evidence(weighed) == pytest.approx(1.0 + floor, abs=0.01)
    assert [worth.is_shown_by_nearly_any(each) for each in weighed] == [True, *[False] * 4]
    assert worth.summary(weighed, shares).startswith("3 of 4 reproduced, where 3 random devices")


def test_an_assumption_changes_the_runs_and_not_the_study(study):
    plan = assumptions_plan(study)
    dataset = assumptions_dataset(plan, {"stiff": "a stiff base", "inserted": "it goes in"})
    assert dataset["assumption"].values.tolist() == [OWN, "stiff", "inserted"]
    assert dataset["title"].values.tolist()[1:] == ["a stiff base", "it goes in"]
    own, stiff, inserted = dataset["verdict"].values
    assert not np.array_equal(own, stiff)
    # Claims on the share that stays can only lose if what does not go in does not count.
    least = [n for n, each in enumerate(CLAIMS) if each.id in ("F8a", "C1a")]
    assert np.all((own[least] == REPRODUCED) | (inserted[least] != REPRODUCED))
    again = assumptions_dataset(plan, {})
    assert np.array_equal(again["verdict"], dataset["verdict"])


def test_an_assumption_with_an_unknown_setting_is_refused_before_anything_runs():
    stated = read_study(study_path())
    stated["evidence"]["assumptions"]["pressed"]["settings"] = {"begin": "pressed"}
    with pytest.raises(ConfigError, match="begin"):
        check_study(stated)
