"""Outcomes and reasons: texts and remedies."""

import pytest

from model.events.outcomes import OUTCOME_TEXT, REASON_TEXT, Outcome, Reason, remedy


def test_values_are_those_stored_in_datasets():
    # Datasets on disk hold these flags: a renumbering would falsify them.
    names = ["ALIGNED", "SETTLED", "LEFT_SCENE", "HORIZON_REACHED", "FAILED"]
    assert [Outcome(i).name for i in range(5)] == names
    assert Reason.NONE == 0
    assert sorted(Reason) == list(range(len(Reason)))


@pytest.mark.parametrize("outcome", Outcome)
def test_every_outcome_has_a_text_and_a_remedy(outcome):
    assert OUTCOME_TEXT[outcome].strip()
    assert remedy(outcome, Reason.NONE).strip()


@pytest.mark.parametrize("reason", [reason for reason in Reason if reason is not Reason.NONE])
def test_every_reason_has_a_text_and_a_remedy(reason):
    assert REASON_TEXT[reason].strip()
    for outcome in (Outcome.LEFT_SCENE, Outcome.FAILED):
        assert remedy(outcome, reason).strip()


def test_texts_tell_outcomes_and_reasons_apart():
    assert len(set(OUTCOME_TEXT.values())) == len(Outcome)
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
