"""The comparison with heyoka: its checks of agreement.

heyoka is not in this environment; `make truth` runs it.
"""

import numpy as np

from verification.bench.truth import Sets, judge
from vibralign import align


def sets_apart(device, apart):
    """Sets whose times are ``apart`` from the true one, with estimates of 1e-9; and the truth."""
    truth = np.full(apart.size, align([device], tolerance=1e-12, cores=1).tau_align[0])
    return Sets([device] * apart.size, truth + apart, np.full(apart.size, 1e-9)), truth


def failing(sets, heyoka):
    return [check.what for check in judge(sets, heyoka) if check.holds is False]


def test_a_set_outside_its_estimate_is_run_again_more_accurately(device):
    apart = np.where(np.arange(1000) == 7, 4e-9, 1e-10)
    sets, truth = sets_apart(device, apart)
    nothing = np.full(1000, 1e-12)
    told = {check.what: check for check in judge(sets, (truth, nothing))}
    assert told["error below tau_error, heyoka"].found == "99.90 % (999 of 1000)"
    # The package agrees with heyoka at the smaller tolerance: it was the estimate.
    assert failing(sets, (truth, nothing)) == []
    # heyoka's own time is off: the two solve different problems, and one set is one too many.
    other = np.where(np.arange(1000) == 7, truth - 6e-9, truth)
    (missed,) = failing(sets, (other, nothing))
    assert missed == "beyond it at a smaller tolerance as well"
    told = {check.what: check.found for check in judge(sets, (other, nothing))}
    assert told[missed] == "set 7: 10.0 times"


def test_errors_beyond_ten_times_the_estimates_fail(device):
    sets, truth = sets_apart(device, np.where(np.arange(1000) < 3, 2e-8, 1e-10))
    assert failing(sets, (truth, np.zeros(1000))) == ["error below 10 tau_error, heyoka"]
