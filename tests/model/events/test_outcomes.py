"""Outcomes and reasons: texts and remedies."""

import pytest

from model.events.outcomes import OUTCOME_TEXT, REASON_TEXT, Outcome, Reason, remedy


def test_values_are_those_stored_in_datasets():
    # Datasets on disk hold these flags: a renumbering would falsify them.
    names = ["ALIGNED", "SETTLED", "LEFT_SCENE", "HORIZON_REACHED", "FAILED"]
    assert [Outcome(i).name for i in range(5)] == names
    assert Reason.NONE == 0
    assert sorted(Reason) == list(range(len(Reason)))


def test_every_outcome_and_reason_has_its_own_text_and_a_remedy():
    reasons = [reason for reason in Reason if reason is not Reason.NONE]
    assert all(remedy(outcome, Reason.NONE).strip() for outcome in Outcome)
    for outcome in (Outcome.LEFT_SCENE, Outcome.FAILED):
        assert all(remedy(outcome, reason).strip() for reason in reasons)
    outcome_texts = {OUTCOME_TEXT[outcome].strip() for outcome in Outcome}
    reason_texts = {REASON_TEXT[reason].strip() for reason in reasons}
    assert len(outcome_texts - {""}) == len(Outcome)
    assert len(reason_texts - {""}) == len(reasons)
    assert len(set(REASON_TEXT.values())) == len(Reason)


@pytest.mark.parametrize(
    ("reason", "word"),
    [
        (Reason.TOO_MANY_EVALUATIONS, "max_evaluations"),
        (Reason.UNDECLARED_CONTACT, "scene"),
        (Reason.IMPOSSIBLE_START, "initial_tilt"),
    ],
)
def test_a_remedy_names_the_setting_or_parameter_to_change(reason, word):
    outcome = Outcome.LEFT_SCENE if reason is Reason.UNDECLARED_CONTACT else Outcome.FAILED
    assert word in remedy(outcome, reason)


@pytest.mark.parametrize(
    ("outcome", "reason"),
    [
        (Outcome.SETTLED, Reason.NONE),
        (Outcome.HORIZON_REACHED, Reason.NONE),
        (Outcome.HORIZON_REACHED, Reason.CHAOTIC),
    ],
)
def test_a_part_that_stays_on_the_edge_is_to_be_vibrated_otherwise_first_of_all(outcome, reason):
    words = "change amplitude, press_force, tilt_stiffness or frequency"
    assert words in remedy(outcome, reason)
