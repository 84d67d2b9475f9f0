"""The examples run, are short, make one picture each, and what they find is right.

Some run here on fewer nodes, or for a shorter time, than on the pages that `make docs` builds.
"""

import io
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest

from model.events.outcomes import Unvibrated
from model.runs.unvibrated import unvibrated
from model.sweeps.io import write_dataset
from model.sweeps.sweep import dataset_of
from study.plans import sweep_of
from vibralign import Batch, Outcome, Settings, load_device, reliable_at, simulate

EXAMPLES = Path(__file__).parents[2] / "examples"
SCRIPTS = sorted(EXAMPLES.glob("*.py"))
Names = dict[str, Any]


@pytest.fixture
def example(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Names]]:
    """Names of an example after its run, in its folder; the picture is in `plt`."""
    mpl.use("agg")
    monkeypatch.chdir(EXAMPLES)

    def names_of(name: str, *arguments: str, less: Mapping[str, str] | None = None) -> Names:
        monkeypatch.setattr(sys, "argv", [name, *arguments])
        plt.close("all")  # what another test left
        names: Names = {"__name__": "example"}
        source = (EXAMPLES / name).read_text("utf-8")
        for stated, fewer in (less or {}).items():
            assert stated in source
            source = source.replace(stated, fewer)
        exec(compile(source, name, "exec"), names)  # noqa: S102 - our own example
        assert len(plt.get_fignums()) == 1
        plt.savefig(io.BytesIO())
        return names

    yield names_of
    plt.close("all")


def test_eleven_short_scripts_begin_with_a_title_and_a_sentence():
    *numbered, known, last = (path.name for path in SCRIPTS)
    assert [name[0] for name in numbered] == [*"123456789"]
    assert (known, last) == ("known_in_part.py", "round_and_square.py")
    for path in SCRIPTS:
        lines = path.read_text(encoding="utf-8").splitlines()
        text = "\n".join(lines).split('"""')[1].partition("==\n\n")[2]
        assert text.strip().endswith(".")
        assert len(lines) <= 40, path.name


def test_one_run_with_its_forces(example):
    names = example("1_one_run.py")
    found = names["run"]
    assert found.outcome is Outcome.INSERTED
    finer = simulate(names["device"], scene=names["INSERTION"], tolerance=1e-13)
    assert abs(found.tau_align - finer.tau_align) <= found.tau_error + finer.tau_error
    assert abs(found.tau_inserted - finer.tau_inserted) <= (
        found.insertion_error + finer.insertion_error
    )
    for force in names["forces"].values():
        assert (force >= 0.0).all()  # a contact never pulls
    largest = names["forces"]["under both tips"].max() / names["units"].force
    assert largest == pytest.approx(found.edge_force_max, rel=0.01)  # rows are steps


def test_every_error_bar_of_the_sweep_holds(example):
    names = example("2_sweep.py")
    coarse, fine = names["coarse"], names["fine"]
    assert (coarse.outcome == Outcome.ALIGNED).all()
    assert (np.abs(coarse.tau_align - fine.tau_align) <= coarse.tau_error + fine.tau_error).all()
    assert (names["true"] > 0.0).all()  # bars of a finer run would hold without being needed


def test_the_map_is_reliable_only_where_it_aligns(example):
    names = example("3_map.py", less={", 24)": ", 12)"})
    duration, reliable = names["duration"], names["reliable"]
    aligns = np.isfinite(duration)
    assert 0 < reliable.sum() < aligns.sum() < aligns.size
    assert aligns[reliable].all()
    row, column = 6, 4
    stated = names["stated"].changed(
        frequency=names["frequency"][row], tilt_stiffness=names["tilt_stiffness"][column]
    )
    one = simulate(stated)
    assert 1e3 * one.tau_align * stated.units.time == pytest.approx(duration[row, column])


def test_without_vibration_the_peg_rests_on_the_edge(example):
    vibrated, pressed = example("4_without_vibration.py")["runs"].values()
    assert vibrated.outcome is Outcome.ALIGNED
    assert pressed.outcome is Outcome.SETTLED
    lowered = Settings(shape="round", start="running")
    control = unvibrated(Batch.stack([vibrated.parameters]), lowered)
    assert control.outcome[0] == Unvibrated.RESTS
    assert pressed.state[-1][2] == pytest.approx(control.tilt[0], rel=1e-6)


def test_the_yield_lies_in_its_interval_and_failures_among_the_drawn(example):
    names = example("5_tolerances.py")
    found, drawn, stated = names["found"], names["drawn"], names["stated"]
    assert 0.0 < found.low < found.share < found.high < 1.0
    assert found.share == drawn.goes_in.mean()
    for name in ("friction", "misalignment"):
        values, stated_value = drawn.values[name], stated.quantities[name]
        within = stated.tolerances[name].around(stated_value)
        assert np.abs(values - stated_value).max() <= within
        assert values[~drawn.goes_in].mean() > values[drawn.goes_in].mean()
    assert found.sobol_indices[0].quantity == "misalignment"
    failing = int(np.argmin(drawn.goes_in))
    own = {name: float(values[failing]) for name, values in drawn.values.items()}
    start = names["starts"][drawn.failing[failing]]
    failed = simulate(stated.changed(**own, **start))
    assert failed.outcome is not Outcome.ALIGNED


def test_the_data_sheet_in_si_is_the_dimensionless_device(example):
    names = example("6_data_sheet.py")
    stated = names["stated"]
    units, parameters = stated.units, stated.parameters
    back = units.in_si(parameters).given()
    for name, value in stated.values.items():
        if name in back:
            assert back[name] == pytest.approx(value), name
    aligns = names["runs"].outcome == Outcome.ALIGNED
    assert 0 < names["reliable"].sum() < aligns.sum() < aligns.size
    assert aligns[names["reliable"]].all()


def test_a_redrawn_figure_has_the_points_of_its_dataset(example, small_study, tmp_path):
    sweep = sweep_of(small_study(4, 3), "fig06")
    columns = {name: np.zeros(8) for name in sweep.variables}
    columns["tau_align"] = np.array([8.0, 4.0, 3.0, 2.5, np.nan, 6.0, 5.0, 4.5])
    dataset = dataset_of(sweep, "Duration over press force", columns)
    write_dataset(dataset, tmp_path / "fig06.nc")
    example("7_redraw.py", str(tmp_path / "fig06.nc"))
    (axes,) = plt.gcf().axes
    assert len(axes.lines) == 2
    for line, durations in zip(axes.lines, dataset["tau_align"].values, strict=True):
        np.testing.assert_array_equal(line.get_xdata(), dataset[sweep.dimensions[1].parameter])
        np.testing.assert_array_equal(line.get_ydata(), durations)
    assert dataset["tau_align"].attrs["symbol"] in axes.get_ylabel()


def test_a_pull_moves_the_peg_as_a_lateral_spring_does_whose_rest_is_elsewhere(example):
    example("8_own_force.py", less={"horizon=11.0": "horizon=3.0"})
    device = load_device(EXAMPLES / "peg.yaml")
    units, p = device.units, device.parameters
    (axes,) = plt.gcf().axes
    assert len(axes.lines) == 3
    for line in axes.lines:
        force = float(line.get_label().split()[-2]) / units.force
        moved = p.replace(rest_x=p.misalignment + force / p.lateral_stiffness)
        expected = simulate(moved, shape="round", start="running", horizon=3.0, tolerance=1e-6)
        # Two ways of the same sum: rounding alone is between them.
        assert line.get_xdata()[-1] == pytest.approx(expected.time[-1], rel=1e-6)
        assert line.get_ydata()[-1] == pytest.approx(expected.state[-1][0], rel=1e-5)


def test_the_study_draws_the_longest_time_of_the_runs_that_align(example):
    names = example(
        "9_study.py", less={"points=24": "points=6", "2.0 * np.pi, 8": "2.0 * np.pi, 4"}
    )
    study, longest = names["study"], names["longest"]
    assert 0 < int(np.isfinite(longest).sum()) < longest.size
    place = {"frequency": 3, "amplitude": 4}
    runs = [
        simulate(load_device(EXAMPLES / "peg.yaml").changed(
            phase=phase, **{n: float(study[n][i]) for n, i in place.items()}
        ))
        for phase in names["phases"].tolist()
    ]  # fmt: skip
    seconds = [run.tau_align * load_device(EXAMPLES / "peg.yaml").units.time for run in runs]
    assert float(longest.isel(place)) == pytest.approx(max(seconds), abs=1e-7)
    axes, bar = plt.gcf().axes
    assert (axes.get_xlabel(), bar.get_ylabel()) == (
        "excitation frequency [Hz]",
        "alignment duration [s]",
    )


def test_a_round_peg_is_reliable_on_less_of_both_planes_than_a_square_one(example):
    names = example("round_and_square.py", less={", 12)": ", 5)"})
    shares, stated = names["shares"], names["stated"]
    for across in names["planes"]:
        assert 0.0 < shares[across, "round"] < shares[across, "square"] <= 1.0
    x, y = np.meshgrid(np.linspace(0.25e-3, 2e-3, 5), np.linspace(1.0, 25.0, 5))
    far = x.ravel() > names["a"] * np.sqrt(2.0 * names["delta"])
    given = {"misalignment": x.ravel()[far], "press_force": y.ravel()[far]}
    hops = given["press_force"] < stated.values["axial_stiffness"] * stated.values["amplitude"]
    assert not reliable_at(stated, **given)[~hops].any()  # the others stand flat


def test_trials_leave_less_possible_than_the_ranges(example):
    less = {"sets=256, touch_downs_tried=16": "sets=32, touch_downs_tried=8"}
    names = example("known_in_part.py", less=less)
    possible, found = names["possible"], names["found"]
    assert 0.5 < possible.share < 1.0
    assert found.fit.fits
    assert found.concludes
    for name, (low, middle, high) in found.intervals().items():
        ends = names["device"].unknown[name]
        assert ends.low <= low < middle < high <= ends.high
    low, _, high = found.intervals()["friction"]
    assert high - low < 0.9 * (0.4 - 0.05)
