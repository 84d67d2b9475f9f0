"""Speed against error: figures show the numbers of the table, and advice follows from them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from verification.bench.methods import METHODS
from verification.bench.plans import PICTURES
from verification.bench.problems import Verdict
from verification.bench.report import work_precision_plots
from verification.bench.report.advice import advice, nearest, needs
from verification.bench.report.work_precision_plots import (
    CAPTIONS,
    evaluations_over_error,
    time_over_error,
)

CASES = ("aligned", "sticking", "bouncing", "never_aligning")
TITLES = {
    "aligned": "slides", "sticking": "sticks", "bouncing": "bounces", "never_aligning": "never",
}  # fmt: skip


def drawn(axes, label: str) -> list[tuple[float, float]]:
    (line,) = [line for line in axes.lines if line.get_label() == label]
    return [tuple(point) for point in np.column_stack(line.get_data()).tolist()]


# --- Work over error ----------------------------------------------------------------------------


def test_every_method_and_picture_has_its_look_and_words():
    assert list(work_precision_plots.LOOKS) == list(METHODS)
    looks = [(look["color"], look["marker"]) for look in work_precision_plots.LOOKS.values()]
    assert len(set(looks)) == len(METHODS)
    assert len({look["marker"] for look in work_precision_plots.LOOKS.values()}) == len(METHODS)
    assert set(CAPTIONS) == set(PICTURES)


@pytest.mark.parametrize("work", ["rhs_evaluations", "microseconds"])
def test_a_panel_shows_the_right_settings_of_its_case(timed_settings, work):
    draw = time_over_error if work == "microseconds" else evaluations_over_error
    figure = draw(timed_settings, TITLES)
    assert len(figure.axes) == len(TITLES)
    points = 0
    for axes, (case, title) in zip(figure.axes, TITLES.items(), strict=True):
        assert title in axes.get_title(loc="left")
        for method in METHODS:
            expected = [
                (setting.error, getattr(setting, work))
                for setting in timed_settings
                if (setting.case, setting.method) == (case, method)
                and setting.verdict == Verdict.RIGHT_OUTCOME
            ]
            assert drawn(axes, method) == expected
            points += len(expected)
        (uncertainty,) = {each.uncertainty for each in timed_settings if each.case == case}
        (shade,) = axes.patches
        assert shade.get_x() + shade.get_width() == pytest.approx(
            max(uncertainty, axes.get_xlim()[1])
        )
    assert points == 19
    assert figure.axes[0].get_xscale() == figure.axes[0].get_yscale() == "log"
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert legend == [METHODS[name].name for name in METHODS if name in PRESENT]


PRESENT = {"taylor_located", "rk4_fixed", "scipy_rk45"}


# --- What it needs ------------------------------------------------------------------------------


def test_what_a_method_needs_is_the_cheapest_setting_that_all_finer_ones_confirm(timed_settings):
    need = needs(timed_settings, 1e-5)
    assert need["rk4_fixed", "aligned"].rhs_evaluations == 4000, "the lucky setting does not count"
    assert ("rk4_fixed", "sticking") not in need
    assert ("scipy_rk45", "bouncing") not in need
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
        "scipy_rk45", "bouncing")]  # fmt: skip
    assert nearest(bouncing).error == 2e-3
    assert nearest(bouncing[:1]) is bouncing[0]


# --- Advice -------------------------------------------------------------------------------------


def test_advice_names_what_was_measured(timed_settings):
    numbers, scans = advice(timed_settings, CASES)
    label = METHODS["taylor_located"].name
    assert f"choose {label}: it keeps the true error below 10⁻⁸ in every case, at 160 µs" in (
        numbers
    )
    assert "no method without event location gets there in any case" in numbers
    assert f"choose {label}: it keeps the true error below 10⁻⁵ in every case, at 80 µs" in scans
    # 1000 evaluations in .08 ms, beside scipy's 900 in 4 ms and RK4's 4000 in .2 ms.
    assert "needs 0.9 times as many evaluations in 1 of 4 cases and gets there in no other" in scans
    assert "the best whose steps are compiled takes 2.5 times as long in 1 of 4 cases" in scans


def test_advice_changes_with_what_was_measured(timed_settings):
    better = [
        replace(setting, method="scipy_rk45", microseconds=10.0)
        for setting in timed_settings
        if (setting.method, setting.resolution) == ("taylor_located", 1e-6)
    ]
    _, scans = advice([*timed_settings, *better], CASES)
    assert f"choose {METHODS['scipy_rk45'].name}: it keeps" in scans
    rare = [each for each in timed_settings if each.method != "rk4_fixed"]
    assert "the best whose steps are compiled gets there in no case" in advice(rare, CASES)[1]
    none = [setting for setting in timed_settings if setting.case != "bouncing"]
    numbers, scans = advice(none, CASES)
    assert numbers == "No method keeps the true error below 10⁻⁸ in every kind of motion."
    assert scans == "No method keeps the true error below 10⁻⁵ in every kind of motion."
