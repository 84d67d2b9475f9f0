"""Speed against error: what a case needs, and the sentence that follows from it."""

import math
from dataclasses import replace

from verification.bench.problems import Verdict
from verification.bench.report.speed import cost_of, nearest, needs

CASES = ("aligned", "sticking", "bouncing", "never_aligning")


def test_what_a_case_needs_is_the_cheapest_setting_that_all_finer_ones_confirm(timed_settings):
    need = needs(timed_settings, 1e-5)
    assert need["aligned"].rhs_evaluations == 4000, "the lucky setting does not count"
    assert need["bouncing"].microseconds == 80.0
    assert needs(timed_settings, 1e-8)["bouncing"].tolerance == 1e-9
    assert not {"base_100_0", "overturning", "slow"} & set(need)
    assert needs(timed_settings, 1e-10) == {}


def test_a_wrong_outcome_at_a_finer_setting_takes_the_coarser_ones_away(timed_settings):
    settings = [
        replace(each, verdict=Verdict.WRONG_OUTCOME, error=math.nan)
        if each.tolerance == 1e-9
        else each
        for each in timed_settings
    ]
    assert needs(settings, 1e-5) == {}


def test_the_nearest_setting_has_the_smallest_known_error(timed_settings):
    hard = [each for each in timed_settings if each.case == "base_100_0"]
    assert nearest(hard).error == 3e-4
    assert nearest(hard[:1]) is hard[0]


def test_the_cost_is_told_if_every_case_keeps_the_error(timed_settings):
    assert "takes 160 to 200 µs of one core" in cost_of(timed_settings, CASES)
    some = [each for each in timed_settings if each.case != "bouncing"]
    assert cost_of(some, CASES) == "The true error stays below 10⁻⁸ in 3 of 4 motions."
