"""Properties of every run, on random sets over the whole domain of the parameters."""

from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from model.physics.parameters import FIELDS
from verification.fuzz import (
    LAWS,
    SCENES,
    SETTINGS,
    UNEXPLAINED_SHARE,
    broken_properties,
    draw,
    try_sets,
)
from vibralign import Alignments, Batch, Outcome, Parameters, Reason, Settings, align

SEED, OTHER_SEED = 2007, 2008
PATIENT = replace(SETTINGS, max_evaluations=10_000)  # enough for a device to align
BOUNCES_ON_EDGE = (4017, 5696)  # in flight or not, as a part in 10⁹ of its start decides
SETTLES = 24_390  # as hardly one set in ten thousand does before the horizon
# Sets that one engine or both got wrong without a flag; decision 8 says why.
ONCE_WRONG = (
    61987, 115174, 138461, 307496, 488748, 518930, 567408, 624176, 690504, 764952, 813861, 837068,
    846441, 1016048,
)  # fmt: skip
ALSO_WRONG = 50385  # of another seed: it is aligned for 1e-8 of a step only
SETTLES_STICKING = (62, 21603)  # of that seed, within a step
# These were wrong too: a tilt of 1e-7 decides them, so that they must be sensitive or fail.
NEARLY_FLAT = (137368, 147806, 634297, 689932, 734897, 814978, 875933, 1027689)
# Of the insertion scene, by cause: carried error too small, inserted as the part falls in,
# sensitive, missed by the former engine, settled in one engine only; an edge's return not seen,
# sensitive where a neighbour decides, and jammed by chance.
ONCE_WRONG_IN_SLOT = (
    24813, 51099, 72020, 35053, 50366, 99830, 8382, 16213, 17103, 38056, 80389,
    18624, 29640, 30541, 58259, 85461, 90745, 59380,
)  # fmt: skip


@pytest.mark.parametrize("count", [2500, pytest.param(10_000, marks=pytest.mark.nightly)])
def test_sets_keep_every_property(count):
    reports = [try_sets(SEED, first, 2500) for first in range(0, count, 2500)]
    findings = [finding for report in reports for finding in report.findings]
    assert sum(report.sets for report in reports) == count
    assert findings == []
    # Half of the sets stop at the limit of evaluations, two in a hundred are sensitive; the others,
    # 4,257 and 3,965 of ten thousand, are compared.
    assert sum(report.against_neighbour for report in reports) > 0.42 * count
    assert sum(report.against_tighter for report in reports) > 0.39 * count
    # A declared failure is allowed, but only in a small share.
    assert sum(len(report.unexplained) for report in reports) <= UNEXPLAINED_SHARE * count
    reports.append(try_sets(SEED, SETTLES, 1))
    endings = {name.split(":")[0] for report in reports for name in report.endings}
    after = Outcome.INSERTED, Outcome.JAMMED, Outcome.CLIMBED_OUT  # of the insertion scene
    assert endings == {each.name.lower() for each in Outcome if each not in after}


@pytest.mark.parametrize("count", [400, pytest.param(1000, marks=pytest.mark.nightly)])
def test_parts_that_fall_in_keep_every_property(count):
    report = try_sets(SEED, 0, count, *SCENES["insertion"])
    assert report.findings == []
    assert report.unexplained == []
    assert report.against_tighter > 0.8 * count
    ends = {name.split(":")[0] for name in report.endings}
    assert {"inserted", "climbed_out"} <= ends


@pytest.mark.parametrize("number", BOUNCES_ON_EDGE)
def test_a_part_that_bounces_on_an_edge_at_the_horizon_has_climbed_out(number):
    report = try_sets(SEED, number, 1, *SCENES["insertion"])
    assert report.findings == []
    assert report.endings == {"climbed_out: on_edge": 1}


# Errors of the solver that random sets have found, now corrected.
FOUND = (
    # At rest without load, the friction state that fits a moment later did not fit now: it ended
    # at once and came back, without time passing. The second stands on its corner, on a hard base.
    140, 6,
    117,  # the load of a moment later depended on the friction state tried: none was consistent
    31,  # lanes that only stepped on never looked at their limit of evaluations
    279,  # a part beyond the corner, lifted off at once, had aligned or not
)  # fmt: skip
ONE_BY_ONE = [
    *((SEED, number, "alignment", True) for number in ONCE_WRONG),
    (OTHER_SEED, ALSO_WRONG, "alignment", True),
    *((SEED, number, "alignment", False) for number in FOUND),
    *((SEED, number, "insertion", False) for number in ONCE_WRONG_IN_SLOT),
]


@pytest.mark.parametrize(("seed", "number", "scene", "compared"), ONE_BY_ONE)
def test_what_was_once_wrong_stays_mended(seed, number, scene, compared):
    limits, laws = SCENES[scene]
    report = try_sets(seed, number, 1, PATIENT if scene == "alignment" else limits, laws)
    assert report.findings == []
    assert report.unexplained == []
    assert not compared or report.against_tighter == 1


def test_time_after_a_run_has_settled_is_none_in_which_it_sticks():
    # One settles after more than 2,500 evaluations, the other after τ = 5.
    patient = replace(SETTINGS, horizon=10.0, max_evaluations=10_000)
    for number in SETTLES_STICKING:
        runs = align(draw(OTHER_SEED, number, 1), patient)
        assert runs.outcome[0] == Outcome.SETTLED
        assert 0.9 < runs.sticking_share[0] <= 1.0


@pytest.mark.parametrize("number", NEARLY_FLAT)
def test_what_no_tilt_of_a_device_decides_is_flagged(number):
    assert align(draw(SEED, number, 1), SETTINGS).sensitive.all()


def test_a_set_depends_on_its_number_only():
    many, one = draw(SEED, 0, 50), draw(SEED, 37, 1)
    for name, values in many.values.items():
        assert np.array_equal(values[37:38], one.values[name], equal_nan=True)
    assert many[37] == one[0]  # and is one that the parameters' rules admit
    # A lowered part has sets of its own, in test_approach.py: starts of these are sudden.
    assert set(LAWS) | {"misalignment", "approach_speed"} == set(FIELDS)


@pytest.mark.parametrize(
    ("outcome", "fits"), [(Outcome.HORIZON_REACHED, True), (Outcome.SETTLED, False)]
)
def test_only_what_reaches_the_horizon_is_chaotic(device, outcome, fits):
    good = align([device], PATIENT)
    chaotic = replace(good, outcome=np.array([outcome]), reason=np.array([Reason.CHAOTIC]))
    assert broken_properties(chaotic, PATIENT)["has a reason that fits its outcome"][0] != fits


@pytest.mark.parametrize(
    ("field", "value", "what"),
    [
        ("rhs_evaluations", 10**9, "ends within its evaluations"),
        ("outcome", 99, "ends in a declared outcome"),
        ("reason", int(Reason.OVERTURNED), "has a reason that fits its outcome"),
        ("tau_align", np.nan, "has an alignment time if and only if it aligns"),
        ("tau_align", -1.0, "has an alignment time if and only if it aligns"),
        ("tau_error", 0.0, "has a positive error or says that it is sensitive"),
        ("tau_error", np.nan, "has a positive error or says that it is sensitive"),
        ("tilt_max", np.inf, "is finite"),
        ("contact_force_max", np.nan, "is finite"),
        ("sticking_share", 1.5, "sticks for a share of its time"),
    ],
)
def test_a_property_that_is_broken_is_found(device, field, value, what):
    good = align([device], PATIENT)
    assert good.outcome[0] == Outcome.ALIGNED
    assert not any(broken.any() for broken in broken_properties(good, PATIENT).values())
    bad = replace(good, **{field: np.full_like(getattr(good, field), value)})
    assert broken_properties(bad, PATIENT)[what].all()


ANY = {
    name: st.floats(0.0, 1e6) if field.bound else st.floats(-1e6, 1e6)
    for name, field in FIELDS.items()
    if name not in ("misalignment", "initial_tilt", "approach_speed")
} | {"initial_tilt": st.floats(-1.6, 1.6), "share": st.floats(0.0, 0.999)}


@settings(max_examples=150, deadline=None, derandomize=True)
@given(values=st.fixed_dictionaries(ANY))
def test_any_parameters_end_in_a_declared_way_and_again_so(values):
    share = values.pop("share")
    for name in ("half_width", "half_height", "clearance", "inertia", "contact_stiffness"):
        values[name] = max(values[name], 1e-6)
    values["misalignment"] = share * values["half_width"] * (2.0 + values["clearance"])
    p = Parameters(**values)
    given_limits = Settings(horizon=2.0, tolerance=1e-8, max_evaluations=2_000)
    runs = align([p, p], given_limits, cores=1)
    broken = broken_properties(runs, given_limits)
    assert [what for what, which in broken.items() if which.any()] == []
    again = align(Batch.stack([p]), given_limits)
    for field in fields(Alignments):
        one, other = getattr(runs, field.name), getattr(again, field.name)
        assert np.array_equal(one, np.repeat(other, 2), equal_nan=one.dtype.kind == "f")
