"""Speed against error: the picture shows the numbers of the table, and advice follows from them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from verification.bench.methods import METHODS
from verification.bench.problems import Verdict
from verification.bench.report.advice import advice, nearest, needs
from verification.bench.report.work_precision_plots import LOOKS, time_over_error

CASES = ("aligned", "sticking", "bouncing", "never_aligning")
TITLES = {
    "aligned": "slides", "sticking": "sticks", "bouncing": "bounces", "never_aligning": "never",
}  # fmt: skip


def test_a_panel_shows_the_right_settings_of_its_case(timed_settings):
    assert list(LOOKS) == list(METHODS)
    figure = time_over_error(timed_settings, TITLES)
    assert len(figure.axes) == len(TITLES)
    points = 0
    for axes, (case, title) in zip(figure.axes, TITLES.items(), strict=True):
        assert title in axes.get_title(loc="left")
        for name, method in METHODS.items():
            expected = [
                (setting.error, setting.microseconds)
                for setting in timed_settings
                if (setting.case, setting.method) == (case, name)
                and setting.verdict == Verdict.RIGHT_OUTCOME
            ]
            (line,) = [line for line in axes.lines if line.get_label() == method.name]
            assert np.column_stack(line.get_data()).tolist() == [[*each] for each in expected]
            points += len(expected)
        (uncertainty,) = {each.uncertainty for each in timed_settings if each.case == case}
        (shade,) = axes.patches
        assert shade.get_x() + shade.get_width() == pytest.approx(
            max(uncertainty, axes.get_xlim()[1])
        )
    assert points == 19
    assert figure.axes[0].get_xscale() == figure.axes[0].get_yscale() == "log"
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert legend == [method.name for method in METHODS.values()]


def test_what_a_method_needs_is_the_cheapest_setting_that_all_finer_ones_confirm(timed_settings):
    need = needs(timed_settings, 1e-5)
    assert need["rk4_fixed", "aligned"].rhs_evaluations == 4000, "the lucky setting does not count"
    assert ("rk4_fixed", "sticking") not in need
    assert ("semi_implicit_euler_fixed", "bouncing") not in need
    assert need["taylor_located", "bouncing"].microseconds == 80.0
    assert needs(timed_settings, 1e-8)["taylor_located", "bouncing"].resolution == 1e-9
    assert needs(timed_settings, 1e-10) == {}


def test_a_wrong_outcome_at_a_finer_setting_takes_the_coarser_ones_away(timed_settings):
    settings = [
        replace(setting, verdict=Verdict.WRONG_OUTCOME, error=math.nan)
        if (setting.method, setting.resolution) == ("taylor_located", 1e-9)
        else setting
        for setting in timed_settings
    ]
    assert ("taylor_located", "aligned") not in needs(settings, 1e-5)


def test_the_nearest_setting_has_the_smallest_known_error(timed_settings):
    bouncing = [each for each in timed_settings if (each.method, each.case) == (
        "semi_implicit_euler_fixed", "bouncing")]  # fmt: skip
    assert nearest(bouncing).error == 2e-3
    assert nearest(bouncing[:1]) is bouncing[0]


def test_advice_names_what_was_measured(timed_settings):
    numbers, scans = advice(timed_settings, CASES)
    label = METHODS["taylor_located"].name
    assert f"choose {label}: it keeps the true error below 10⁻⁸ in every case, at 160 µs" in (
        numbers
    )
    assert "fixed steps keep it in none of 4 cases" in numbers
    assert f"choose {label}: it keeps the true error below 10⁻⁵ in every case, at 80 µs" in scans
    # RK4 takes 0.2 ms, Euler 0.4 ms.
    assert "fixed steps take 2.5 times as long in 1 of 4 cases" in scans


def test_advice_changes_with_what_was_measured(timed_settings):
    better = [
        replace(setting, method="rk4_fixed", microseconds=10.0)
        for setting in timed_settings
        if (setting.method, setting.resolution) == ("taylor_located", 1e-6)
    ]
    _, scans = advice([*timed_settings, *better], CASES)
    assert f"choose {METHODS['rk4_fixed'].name}: it keeps" in scans
    none = [setting for setting in timed_settings if setting.case != "bouncing"]
    numbers, scans = advice(none, CASES)
    assert numbers == "No method keeps the true error below 10⁻⁸ in every kind of motion."
    assert scans == "No method keeps the true error below 10⁻⁵ in every kind of motion."
