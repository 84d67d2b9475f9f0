"""The simulated scheduling of a campaign, against what can be said without one."""

import numpy as np
import pytest

from verification.cluster_efficiency import Costs, part_times, simulated

COSTS = Costs(job=5.0, part=1.0, question=10.0)


def test_one_job_on_one_core_takes_its_work_and_its_costs():
    work = np.full(10, 7.0)
    wall = simulated(work, cores=1, parts=10, costs=COSTS, most=2)
    # 70 + 5 + 10 s after a submission of 0.3 s; asked after 10, 30, 60 and 100 s.
    assert wall == 100.0


def test_jobs_side_by_side_are_seen_at_the_same_time():
    wall = simulated(np.full(4, 4.0), cores=4, parts=1, costs=COSTS, most=8)
    assert wall == 30.0  # 10 s each: nothing has ended after 10 s, everything after 30


@pytest.mark.parametrize("cores", [1, 3, 8])
@pytest.mark.parametrize("parts", [1, 4])
def test_no_campaign_is_faster_than_its_cores(cores, parts):
    work = np.random.default_rng(1).uniform(5.0, 50.0, 64)
    jobs = work.size / parts
    spent = work.sum() + COSTS.part * work.size + COSTS.job * jobs
    wall = simulated(work, cores, parts, COSTS, most=2 * cores)
    largest = max(work[i : i + parts].sum() for i in range(0, 64, parts)) + 5.0 + parts
    assert spent / cores <= wall
    assert wall <= spent / cores + largest + 0.3 * jobs + 190.0 * jobs


def test_a_build_without_such_jobs_is_refused(tmp_path):
    with pytest.raises(ValueError, match="no job of the rule 'map_part' is recorded there"):
        part_times(tmp_path)
