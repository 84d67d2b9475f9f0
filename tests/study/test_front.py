"""The front: which sets no other beats, and the ratio to the aims by which one is chosen."""

from dataclasses import replace

import numpy as np

from model.study import claims
from model.study.claims.regime import Regime, Summary, summary_of
from model.study.config import Aims
from model.study.identification.front import Wanted, on_front, promising
from model.study.identification.score import Judge

AIMS = Aims(
    missing=2,
    beside=["M4b"],
    not_resting=0.1,
    not_resting_most=0.4,
    tilt=0.2,
    corners=0.95,
    aligned=0.25,
)


CLAIMS = {claim.id: claim for claim in claims.CLAIMS}


def judge_of(*names: str) -> Judge:
    size = len(names)
    return Judge(
        tuple(CLAIMS[name] for name in names),
        np.ones(size, dtype=np.bool_),
        0.1,
        np.zeros(size, dtype=np.bool_),
        np.ones(size),
    )


def test_the_ratios_are_those_to_each_aim() -> None:
    regimes = np.array(
        [
            Summary(0.1, 0.4, 0.2, 0.95, 0.25),
            Summary(0.3, 0.4, 0.2, 0.95, 0.25),
            Summary(0.1, 0.6, 0.2, 0.95, 0.25),
            Summary(0.1, 0.4, 0.5, 0.95, 0.25),
            Summary(0.1, 0.4, 0.2, 0.75, 0.25),
            Summary(0.1, 0.4, 0.2, 0.95, 0.1),
            Summary(0.05, 0.1, 0.1, 1.0, 0.5),
        ]
    )
    judge, wanted = judge_of("F6a", "M4b", "M3"), Wanted(AIMS, ["fig06"])
    shown = np.full((7, 3), 0.1)
    ratios = wanted.ratios(judge, shown, regimes)
    np.testing.assert_allclose(ratios[:, 0], 0.0)
    np.testing.assert_allclose(ratios[1], [0.0, 3.0, 1.0, 1.0, 1.0, 1.0])
    worst = wanted.worst(judge, shown, regimes)
    # The sixth aligns too little of a curve.
    np.testing.assert_allclose(worst, [1.0, 3.0, 1.5, 2.5, 5.0, np.inf, 0.5])
    # M4b asks what another aim asks, and M3 what is not computed.
    assert wanted.asked(judge).tolist() == [True, False, False]
    assert wanted.ratios(judge, -shown, regimes)[0, 0] == 1.0 / 2.0
    required = replace(judge, required=np.array([True, False, False]))
    assert wanted.worst(required, -shown, regimes)[0] == np.inf


def test_a_claim_shown_barely_counts_in_part() -> None:
    judge = judge_of("F6a", "F6c", "F6d")
    margins, regime = np.array([[0.1, 0.01, -0.1]]), np.array([Summary(0.0, 0.0, 0.0, 1.0, 0.25)])
    ratios = Wanted(AIMS, ["fig06"], safe=0.04).ratios(judge, margins, regime)
    assert ratios[0, 0] == 1.75 / 2.0


def test_an_aim_missed_by_far_in_one_figure_is_no_bar() -> None:
    ratios = np.array([[1.5, 1.5, 1.5], [1.0, 1.0, 9.0], [1.6, 1.7, 1.8]])
    assert promising(ratios).tolist() == [1, 0, 2]


def test_the_front_holds_what_no_other_set_beats() -> None:
    shown = np.array([52, 50, 50, 52, 48, 60])
    regimes = np.array(
        [
            Summary(0.3, 1.0, 0.2, 1.0, 0.25),
            Summary(0.1, 1.0, 0.3, 1.0, 0.25),
            Summary(0.2, 1.0, 0.3, 1.0, 0.25),  # beaten by the one before
            Summary(0.3, 1.0, 0.2, 1.0, 0.25),  # as good as the first
            Summary(0.5, 1.0, 0.1, 1.0, 0.25),
            Summary(0.0, 0.0, 0.0, 1.0, 0.1),  # aligns too little of a figure, and beats none
        ]
    )
    assert on_front(shown, regimes, 0.25).tolist() == [True, True, False, True, True, False]


def test_a_figure_that_never_aligns_counts_as_the_worst() -> None:
    good = Regime(0.25, 0.0, 0.1, 0.1, 0.2, 1.0, 0.0)
    never = Regime(0.0, *[np.nan] * 6)
    both = summary_of([good, never])
    assert both.not_resting == 0.55
    assert (both.not_resting_most, both.corners, both.aligned) == (1.0, 0.0, 0.0)
    assert summary_of([good, good]) == Summary(0.1, 0.1, 0.1, 1.0, 0.25)
