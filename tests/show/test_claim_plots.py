"""The picture of the ledger's own runs: a panel for each, with its curves."""

import numpy as np
import pytest

from model.show.claim_plots import draw_runs
from tests.study.claims_data import curves, falling, within

NAMES = ("centred", "pressed", "misaligned", "displaced", "rubbing")


@pytest.fixture(scope="module")
def figure():
    datasets = {
        "centred": curves("centred", falling)["centred"],
        "pressed": curves("pressed", within(2.0, 3.0))["pressed"],
        "misaligned": curves("misaligned", falling)["misaligned"],
        "displaced": curves("displaced", within(5.0, 30.0))["displaced"],
        "rubbing": curves("rubbing", within(0.0, 0.5))["rubbing"],
    }
    named = {name: each.assign_attrs(title=f"Title of {name}") for name, each in datasets.items()}
    return draw_runs(named), named


def test_each_run_has_a_panel_with_its_title_and_curves(figure) -> None:
    drawn, datasets = figure
    shown = [axes for axes in drawn.axes if axes.get_visible()]
    assert len(shown) == len(NAMES)
    for axes, (name, dataset) in zip(shown, datasets.items(), strict=True):
        assert f"Title of {name}" in axes.get_title(loc="left")
        family = dataset["tau_align"].dims[0]
        lines = [line for line in axes.lines if "=" in str(line.get_label())]
        assert len(lines) == dataset.sizes[family]


def test_a_panel_shows_what_the_ledger_looks_at(figure) -> None:
    drawn, datasets = figure
    looked_at = ("excursion", "tilt_end", "tau_align", "way", "tau_align")
    for axes, name, variable in zip(drawn.axes, NAMES, looked_at, strict=False):
        values = datasets[name][variable].values[0]
        assert np.array_equal(axes.lines[0].get_ydata(), values, equal_nan=True)


def test_runs_that_align_are_crossed_where_no_duration_is_shown(figure) -> None:
    drawn, datasets = figure
    crosses = [line for line in drawn.axes[1].lines if line.get_marker() == "x"]
    aligned = np.isfinite(datasets["pressed"]["tau_align"].values)
    assert sum(len(line.get_xdata()) for line in crosses) == aligned.sum()
    assert not [line for line in drawn.axes[4].lines if line.get_marker() == "x"]
