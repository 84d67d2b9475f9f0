"""Speed against error: figures show the numbers of the dataset, and advice follows from them."""

import math
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from benchmarks.fixed_steps import Wrong
from benchmarks.methods import METHODS
from benchmarks.plans import PICTURES
from benchmarks.problems import Verdict
from benchmarks.report import work_precision_plots
from benchmarks.report.advice import advice, needs
from benchmarks.report.work_precision_plots import (
    CAPTIONS,
    LABELS,
    evaluations_over_error,
    time_over_error,
    wrong_points,
)
from benchmarks.work_precision import columns_of

TITLES = {
    "aligned": "slides", "sticking": "sticks", "bouncing": "bounces", "never_aligning": "never",
}  # fmt: skip


def stored(settings) -> xr.Dataset:
    """The settings as the study's dataset holds them."""
    columns = columns_of(settings, list(TITLES), rungs=4)
    names = {"case": list(TITLES), "method": list(METHODS)}
    return xr.Dataset(
        {name: (("case", "method", "rung"), column) for name, column in columns.items()},
        {
            name: (name, np.arange(len(each)), {"flag_meanings": " ".join(each)})
            for name, each in names.items()
        },
    )


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
    if work == "microseconds":
        figure = time_over_error(timed_settings, TITLES)
    else:
        figure = evaluations_over_error(stored(timed_settings), TITLES)
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
    assert points == 19
    assert figure.axes[0].get_xscale() == figure.axes[0].get_yscale() == "log"
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert legend == [METHODS[name].name for name in METHODS if name in PRESENT]


PRESENT = {"dop853_located", "rk4_fixed", "scipy_rk45"}


# --- Wrong points -------------------------------------------------------------------------------


def test_wrong_points_stand_where_they_are(wrong_datasets):
    figure = wrong_points(list(wrong_datasets.values()))
    assert len(figure.axes) == 4
    for column, (name, dataset) in enumerate(wrong_datasets.items()):
        y, x = dataset["tau_located"].dims
        for row in range(2):
            axes = figure.axes[2 * row + column]
            part = dataset.isel(scheme=0, step=row)
            for kind, label in LABELS.items():
                rows, columns = np.nonzero(part["wrong"].values == kind)
                if name == "fig13":
                    heights = part[y].values[rows]
                else:  # what came out, or what should have where nothing came out
                    tau = part["tau_align"].values[rows, columns]
                    true = part["tau_located"].values[rows, columns]
                    heights = (
                        tau if kind == Wrong.WRONG_TIME else np.where(np.isnan(true), tau, true)
                    )
                expected = list(zip(part[x].values[columns], heights, strict=True))
                assert drawn(axes, label) == expected
            share = (3 if row == 0 else 1) / 8
            number = name.removeprefix("fig").lstrip("0")
            assert axes.get_title() == (
                f"Fig. {number}, $h$ = {0.01 if row == 0 else 0.001:g}: {100 * share:.2g} % wrong"
            )


# --- What it needs ------------------------------------------------------------------------------


def test_what_a_method_needs_is_the_cheapest_setting_that_all_finer_ones_confirm(timed_settings):
    need = needs(timed_settings, 1e-5)
    assert need["rk4_fixed", "aligned"].rhs_evaluations == 4000, "the lucky setting does not count"
    assert ("rk4_fixed", "sticking") not in need
    assert ("scipy_rk45", "bouncing") not in need
    assert need["dop853_located", "bouncing"].microseconds == 80.0
    assert needs(timed_settings, 1e-8)["dop853_located", "bouncing"].resolution == 1e-9
    assert needs(timed_settings, 1e-10) == {}


def test_a_wrong_outcome_at_a_finer_setting_takes_the_coarser_ones_away(timed_settings):
    settings = [
        replace(setting, verdict=Verdict.WRONG_OUTCOME, error=math.nan)
        if (setting.method, setting.resolution) == ("dop853_located", 1e-9)
        else setting
        for setting in timed_settings
    ]
    assert ("dop853_located", "aligned") not in needs(settings, 1e-5)


# --- Advice -------------------------------------------------------------------------------------


def test_advice_names_what_was_measured(timed_settings, wrong_datasets):
    numbers, scans, fixed = advice(timed_settings, wrong_datasets, TITLES)
    label = METHODS["dop853_located"].name
    assert f"choose {label}: it keeps the true error below 10⁻⁸ in every case, at 160 µs" in (
        numbers
    )
    assert "no method without event location gets there in any case" in numbers
    assert f"choose {label}: it keeps the true error below 10⁻⁵ in every case, at 80 µs" in scans
    assert "takes 2.5 times as long, and gets there in 1 of 4 cases" in scans
    assert fixed.endswith(
        "RK4 gets wrong 38 % of Fig. 6 and 38 % of Fig. 13 with h = 0.01, "
        "12 % of Fig. 6 and 12 % of Fig. 13 with h = 0.001."
    )


def test_advice_changes_with_what_was_measured(timed_settings, wrong_datasets):
    better = [
        replace(setting, method="scipy_rk45", microseconds=10.0)
        for setting in timed_settings
        if (setting.method, setting.resolution) == ("dop853_located", 1e-6)
    ]
    _, scans, _ = advice([*timed_settings, *better], wrong_datasets, TITLES)
    assert f"choose {METHODS['scipy_rk45'].name}: it keeps" in scans
    none = [setting for setting in timed_settings if setting.case != "bouncing"]
    numbers, scans, _ = advice(none, wrong_datasets, TITLES)
    assert numbers == "No method keeps the true error below 10⁻⁸ in every case."
    assert scans == "No method keeps the true error below 10⁻⁵ in every case."
