"""The comparison with heyoka: its checks of agreement.

heyoka is not in this environment; `make truth` runs it.
"""

import numpy as np
import pytest

from verification.bench.truth import (
    Outside,
    Sets,
    explain,
    judge,
    outside,
)
from vibralign import align


@pytest.fixture
def sets(device):
    return Sets([device] * 4, np.array([2.0, 4.0, 5.0, 10.0]), np.full(4, 1e-9))


def found(checks):
    return {check.what: check for check in checks}


def failing(checks):
    return [check.what for check in checks if check.holds is False]


def test_agreement_is_told_with_every_set_outside(sets):
    heyoka = sets.tau + [0.0, 5e-10, 3e-9, 0.0], np.full(4, 1e-9)
    beyond = [Outside(2, 1.5, explained=True)]
    told = found(judge(sets, heyoka, beyond))
    assert told["error below tau_error, heyoka"].found == "75.00 % (3 of 4)"
    assert told["error below 10 tau_error, heyoka"].holds
    (line,) = explain(sets, heyoka, beyond)
    assert line.startswith("    set 2: tau 5, 1.5 times the estimates 1.0e-09 + 1.0e-09")


def test_one_set_that_is_not_explained_fails(device):
    many = Sets([device] * 1000, np.ones(1000), np.full(1000, 1e-9))
    heyoka = np.where(np.arange(1000) == 7, 1.0 + 4e-9, 1.0 + 1e-10), np.zeros(1000)
    small = [Outside(7, 4.0, explained=True)]
    assert failing(judge(many, heyoka, small)) == []
    other = [Outside(7, 4.0, explained=False)]
    (what,) = failing(judge(many, heyoka, other))
    assert what == "beyond it at a smaller tolerance as well"
    assert "NOT EXPLAINED" in explain(many, heyoka, other)[0]


def test_a_set_outside_is_run_again_more_accurately(device):
    right = align([device] * 2, tolerance=1e-12, cores=1)
    # As if both runs of the first set had the same error: a sharper run then explains it.
    sets = Sets([device] * 2, right.tau_align + [3e-9, 0.0], np.full(2, 1e-9))
    for shift, explained in ((0.0, True), (6e-9, False)):
        (one,) = outside(sets, (right.tau_align + [shift, 0.0], np.full(2, 1e-12)))
        assert (one.row, one.explained) == (0, explained)
        assert one.factor == pytest.approx(3.0, rel=0.01)
    assert outside(sets._replace(error=np.full(2, 1e-8)), (right.tau_align, np.zeros(2))) == []
