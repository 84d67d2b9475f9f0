"""Outcomes and reasons: texts and remedies."""

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
