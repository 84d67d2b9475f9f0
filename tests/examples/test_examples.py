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

from model.sweeps.io import write_dataset
from model.sweeps.sweep import dataset_of
from study.plans import sweep_of
from vibralign import Outcome, load_device, simulate

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


def is_part(reliable: np.ndarray, aligns: np.ndarray) -> bool:
    """Return whether some, but not all, of what aligns is reliable, and nothing else."""
    return 0 < reliable.sum() < aligns.sum() < aligns.size and bool(aligns[reliable].all())


# What each example says of its picture; fewer nodes, devices or sets than on the page.
SAID: dict[str, tuple[dict[str, str], Callable[[Names], bool]]] = {
    "1_one_run.py": ({}, lambda n: n["run"].outcome is Outcome.INSERTED),
    "3_map.py": (
        {", 24)": ", 12)"}, lambda n: is_part(n["reliable"], np.isfinite(n["duration"]))
    ),
    "4_without_vibration.py": (
        {},
        lambda n: [run.outcome for run in n["runs"].values()]
        == [Outcome.ALIGNED, Outcome.SETTLED],
    ),
    "5_tolerances.py": (
        {},
        lambda n: 0.0 < n["found"].low < n["drawn"].goes_in.mean() < n["found"].high < 1.0
        and n["found"].sobol_indices[0].quantity == "misalignment",
    ),
    "6_data_sheet.py": (
        {}, lambda n: is_part(n["reliable"], n["runs"].outcome == Outcome.ALIGNED)
    ),
    "round_and_square.py": (
        {", 12)": ", 5)"},
        lambda n: all(0.0 < n["shares"][each, "round"] < n["shares"][each, "square"] <= 1.0
                      for each in n["planes"]),
    ),
    "known_in_part.py": (
        {"sets=256, touch_downs_tried=16": "sets=32, touch_downs_tried=8"},
        lambda n: 0.5 < n["possible"].share < 1.0 and n["found"].fit.fits and n["found"].concludes,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SAID)
def test_an_example_shows_what_it_says(example, name):
    less, holds = SAID[name]
    assert holds(example(name, less=less))


def test_every_error_bar_of_the_sweep_holds(example):
    names = example("2_sweep.py")
    coarse, fine = names["coarse"], names["fine"]
    assert (coarse.outcome == Outcome.ALIGNED).all()
    assert (np.abs(coarse.tau_align - fine.tau_align) <= coarse.tau_error + fine.tau_error).all()
    assert (names["true"] > 0.0).all()  # bars of a finer run would hold without being needed


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
