"""Figs. 5-14: what is drawn is what the datasets hold, and nothing where nothing aligns."""

import json

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import LineCollection, PolyCollection, QuadMesh
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline

from model.events.outcomes import Outcome
from model.physics.parameters import FIELDS
from model.runs.simulate import simulate
from model.show import plots, style
from model.study.config import Curves, History
from model.study.datasets import compute_chunk, history_dataset, merge_chunks
from model.study.sweeps import sweep_of

NAN = np.nan
# Gaps at the start, inside and at the end; single points between gaps; a curve without any.
DURATIONS = np.array(
    [
        [5.0, 4.5, 4.0, 3.8, 3.5, 3.2, 3.0, 2.9, 2.8, 2.7],
        [NAN, NAN, 6.0, NAN, 5.0, 4.8, NAN, NAN, 4.0, NAN],
        [9.0, NAN, NAN, 7.0, 6.9, 6.8, NAN, 6.6, 6.5, 6.4],
        [NAN] * 10,
    ]
)


def grid(kind: str, y: str, x: str, durations: np.ndarray) -> xr.Dataset:
    """A dataset in the study's format with these durations, settled where there is none."""
    rows, columns = durations.shape

    def described(name, values):
        field = FIELDS[name]
        return name, values, {"long_name": field.description, "symbol": field.symbol, "units": "1"}

    outcome = np.where(np.isnan(durations), Outcome.SETTLED, Outcome.ALIGNED).astype(np.int8)
    return xr.Dataset(
        {
            "tau_align": ((y, x), durations, {"long_name": "alignment duration", "symbol": "τ"}),
            "outcome": ((y, x), outcome),
            "sensitive": ((y, x), np.zeros_like(outcome)),
        },
        {
            y: described(y, np.linspace(1.0, 4.0, rows)),
            x: described(x, np.linspace(0.25, 9.25, columns)),
        },
        {"kind": kind, "figure": "fig00", "readings": json.dumps({})},
    )


@pytest.fixture
def family() -> xr.Dataset:
    return grid("curves", "tilt_stiffness", "press_force", DURATIONS.copy())


@pytest.fixture
def area() -> xr.Dataset:
    durations = np.add.outer(np.linspace(2.0, 4.0, 7), np.linspace(0.0, 2.0, 9))
    durations[:, :3] = NAN
    durations[4:, 3] = NAN
    durations[2, 6] = NAN  # an island
    dataset = grid("map", "press_force", "tilt_stiffness", durations)
    dataset["outcome"][5:, 0] = Outcome.LEFT_SCENE
    dataset["outcome"][0, 1] = Outcome.FAILED
    return dataset


def named(artists, label: str) -> list:
    return [artist for artist in artists if artist.get_label() == label]


def curve_lines(axes) -> list:
    return [line for line in axes.lines if " = " in line.get_label() and line.get_label()[0] == "$"]


def segments(line) -> list[tuple[np.ndarray, np.ndarray]]:
    """Straight pieces as a renderer gets them, NaN taken out."""
    pieces, previous = [], None
    for vertices, code in line.get_path().iter_segments(remove_nans=True, simplify=False):
        if code == Outline.LINETO:
            pieces.append((previous, vertices))
        previous = vertices
    return pieces


# --- Figs. 6-12 ---------------------------------------------------------------------------------


def test_a_curve_holds_the_row_of_its_family_value_with_its_gaps(family):
    figure = plots.curves(family)
    lines = curve_lines(figure.axes[0])
    assert len(lines) == len(DURATIONS)
    for line, row in zip(lines, DURATIONS, strict=True):
        np.testing.assert_array_equal(line.get_ydata(), row)
        np.testing.assert_array_equal(line.get_xdata(), family["press_force"])


def test_no_piece_of_a_line_crosses_a_gap(family):
    swept = family["press_force"].values.tolist()
    lines = plots.curves(family).axes[0].lines
    drawn = 0
    for line in lines:
        if line.get_linestyle() == "None":
            continue
        for start, end in segments(line):
            assert swept.index(end[0]) - swept.index(start[0]) == 1
            drawn += 1
    aligned = ~np.isnan(DURATIONS)
    assert drawn == (aligned[:, 1:] & aligned[:, :-1]).sum()


def test_a_point_alone_between_gaps_is_drawn_as_a_dot(family):
    figure = plots.curves(family)
    dots = [line for line in figure.axes[0].lines if line.get_label().startswith("_alone")]
    found = sorted((x, y) for line in dots for x, y in line.get_xydata().tolist())
    swept = family["press_force"].values
    # By eye from DURATIONS: row 1 has two points alone, row 2 its first.
    assert found == sorted([(swept[2], 6.0), (swept[8], 4.0), (swept[0], 9.0)])
    assert all(line.get_marker() not in ("", "None") for line in dots)


def test_the_strip_says_exactly_where_each_curve_does_not_align(family):
    strip = plots.curves(family).axes[1]
    bars = [each for each in strip.collections if isinstance(each, PolyCollection)]
    assert len(bars) == len(DURATIONS)
    for row, (collection, durations) in enumerate(zip(bars, DURATIONS, strict=True)):
        points = [(x, row) for x in family["press_force"].values]
        covered = np.zeros(len(points), dtype=bool)
        for path in collection.get_paths():
            covered |= path.contains_points(points)
        np.testing.assert_array_equal(covered, np.isnan(durations))
    assert "does not" in strip.get_ylabel()


def test_curve_and_bar_have_one_colour(family):
    axes, strip = plots.curves(family).axes
    for line, bar in zip(curve_lines(axes), strip.collections, strict=True):
        if len(bar.get_paths()):
            assert mpl.colors.same_color(line.get_color(), bar.get_facecolor()[0])


def test_the_legend_has_one_entry_for_each_value_and_words_for_them(family):
    legend = plots.curves(family).legends[0]
    texts = [text.get_text() for text in legend.get_texts()]
    assert texts == ["$k_{φ}$ = 1", "$k_{φ}$ = 2", "$k_{φ}$ = 3", "$k_{φ}$ = 4"]
    assert legend.get_title().get_text() == "tilt stiffness of the suspension $k_{φ}$"


def test_lines_of_a_family_differ_without_colour(family):
    lines = curve_lines(plots.curves(family).axes[0])
    looks = {(str(line._unscaled_dash_pattern), line.get_marker()) for line in lines}
    assert len(looks) == len(lines)


def test_axes_of_curves_have_words_and_symbols_and_start_at_zero(family):
    axes, strip = plots.curves(family).axes
    assert strip.get_xlabel() == "initial pressing force $f_{0}$"
    assert axes.get_ylabel() == "alignment duration $τ$"
    low, high = axes.get_ylim()
    assert low == 0.0
    assert np.nanmax(DURATIONS) < high < 1.2 * np.nanmax(DURATIONS)
    assert axes.get_yscale() == "linear"


def test_sensitive_points_are_circled_and_explained(family):
    family["sensitive"][0, 3] = 1
    family["sensitive"][1, 0] = 1  # does not align: there is nothing to circle
    figure = plots.curves(family)
    (circles,) = named(figure.axes[0].lines, plots.SENSITIVE_LABEL)
    assert circles.get_xydata().tolist() == [[family["press_force"].values[3], 3.8]]
    assert circles.get_markerfacecolor() == "none"
    notes = [text.get_text() for text in figure.legends[1].get_texts()]
    assert notes == [plots.SENSITIVE_LABEL]


def test_failed_runs_are_marked_as_such(family):
    family["outcome"][3, 2] = Outcome.FAILED
    figure = plots.curves(family)
    (crosses,) = named(figure.axes[1].lines, plots.FAILED_LABEL)
    assert crosses.get_xydata().tolist() == [[family["press_force"].values[2], 3.0]]


def test_curves_without_gaps_need_no_strip():
    figure = plots.curves(grid("curves", "friction", "clearance", DURATIONS[:1].repeat(3, axis=0)))
    assert len(figure.axes) == 1
    assert figure.axes[0].get_xlabel() == "joining clearance $δ$"


def test_a_family_that_never_aligns_is_drawn_too(family, tmp_path):
    family["tau_align"][:] = NAN
    figure = plots.curves(family)
    assert all(not segments(line) for line in figure.axes[0].lines)
    style.save(figure, tmp_path / "never")


# --- Figs. 13, 14 -------------------------------------------------------------------------------


def centres(dataset: xr.Dataset) -> np.ndarray:
    y, x = (dataset[name].values for name in dataset["tau_align"].dims)
    return np.array([(each, row) for row in y for each in x])


def covered(patch: PathPatch, dataset: xr.Dataset) -> np.ndarray:
    inside = patch.get_path().contains_points(centres(dataset))
    return inside.reshape(dataset["tau_align"].shape)


def test_the_mesh_holds_the_durations_and_is_an_image_in_vector_files(area):
    (mesh,) = [
        each for each in plots.stability_map(area).axes[0].collections if isinstance(each, QuadMesh)
    ]
    drawn = mesh.get_array()
    np.testing.assert_array_equal(drawn.filled(NAN), area["tau_align"].values)
    assert mesh.get_rasterized()
    # Each value stands in the middle of its cell.
    corners = mesh.get_coordinates()
    middles = 0.25 * (corners[1:, 1:] + corners[1:, :-1] + corners[:-1, 1:] + corners[:-1, :-1])
    np.testing.assert_allclose(middles.reshape(-1, 2), centres(area))


def test_the_hatched_area_is_where_the_part_does_not_align(area):
    (hatched,) = named(plots.stability_map(area).axes[0].patches, plots.NOT_ALIGNED)
    assert hatched.get_hatch() == style.NON_ALIGNING["hatch"]
    np.testing.assert_array_equal(covered(hatched, area), np.isnan(area["tau_align"].values))


def test_cells_that_left_the_scene_or_failed_can_be_told(area):
    patches = plots.stability_map(area).axes[0].patches
    for label, outcome in (
        (plots.LEFT_LABEL, Outcome.LEFT_SCENE),
        (plots.FAILED_LABEL, Outcome.FAILED),
    ):
        (patch,) = named(patches, label)
        np.testing.assert_array_equal(covered(patch, area), area["outcome"].values == outcome)


def test_the_legend_of_a_map_names_only_what_is_there(area):
    legend = [text.get_text() for text in plots.stability_map(area).legends[0].get_texts()]
    assert legend == [plots.NOT_ALIGNED, plots.LEFT_LABEL, plots.FAILED_LABEL]
    area["outcome"][:] = Outcome.SETTLED
    legend = [text.get_text() for text in plots.stability_map(area).legends[0].get_texts()]
    assert legend == [plots.NOT_ALIGNED]


def test_the_border_runs_between_cells_that_differ(area):
    figure = plots.stability_map(area)
    (border,) = [each for each in figure.axes[0].collections if isinstance(each, LineCollection)]
    gaps = np.isnan(area["tau_align"].values)
    step = {
        name: float(np.diff(area[name].values)[0]) for name in ("press_force", "tilt_stiffness")
    }
    upright = sum(abs(b[1] - a[1]) for a, b in border.get_segments()) / step["press_force"]
    level = sum(abs(b[0] - a[0]) for a, b in border.get_segments()) / step["tilt_stiffness"]
    assert upright == pytest.approx((gaps[:, 1:] != gaps[:, :-1]).sum())
    assert level == pytest.approx((gaps[1:] != gaps[:-1]).sum())


def test_axes_and_colour_bar_of_a_map_have_words_and_symbols(area):
    axes, bar = plots.stability_map(area).axes
    assert axes.get_xlabel() == "tilt stiffness of the suspension $k_{φ}$"
    assert axes.get_ylabel() == "initial pressing force $f_{0}$"
    assert bar.get_ylabel() == "alignment duration $τ$"


def test_colours_are_logarithmic_only_where_durations_spread_and_say_so(area):
    area["tau_align"][0, 8] = 100.0
    assert plots.stability_map(area).axes[1].get_ylabel().endswith("logarithmic")


def test_a_map_of_200_by_200_cells_with_islands_stays_small(tmp_path):
    rng = np.random.default_rng(7)
    durations = np.add.outer(np.linspace(2.0, 4.0, 200), np.linspace(0.0, 40.0, 200))
    durations[:, :60] = NAN
    durations[rng.random(durations.shape) < 0.01] = NAN
    figure = plots.draw(grid("map", "frequency", "tilt_stiffness", durations))
    for path in style.save(figure, tmp_path / "map"):
        assert path.stat().st_size < 1_000_000, path.name


@pytest.mark.parametrize("value", [NAN, 3.0])
def test_a_map_may_align_nowhere_or_everywhere(area, value, tmp_path):
    area["tau_align"][:] = value
    style.save(plots.stability_map(area), tmp_path / "map")


# --- Fig. 5 -------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def study(small_study):
    return small_study(points=5, cells=4)


@pytest.fixture(scope="module")
def course(study) -> xr.Dataset:
    return history_dataset(sweep_of(study, "fig05"), "title", "summary")


def test_the_panels_show_the_coordinates_and_the_force(course):
    panels = plots.history(course).axes
    assert len(panels) == 4
    for axes, name, symbol in zip(
        panels, ("x", "y", "tilt", "contact_force"), ("$x$", "$y$", "$φ$", "$n$"), strict=True
    ):
        np.testing.assert_array_equal(axes.lines[0].get_xdata(), course["time"])
        np.testing.assert_array_equal(axes.lines[0].get_ydata(), course[name])
        assert symbol in axes.get_ylabel()
    assert panels[-1].get_xlabel() == "time $τ$"
    assert [axes.get_title(loc="left") for axes in panels] == list("abcd")


def test_alignment_is_marked_in_every_panel_and_the_drop_of_n_in_the_last(course):
    moment = float(course["tau_align"])
    panels = plots.history(course).axes
    for axes in panels:
        (mark,) = named(axes.lines, "alignment")
        assert set(mark.get_xdata()) == {moment}
    (note,) = panels[-1].texts
    assert f"drops to 0 at $τ$ = {moment:.4g}" in note.get_text()
    x, before = note.xy
    assert x == moment
    # The moment stands twice in the dataset: with the force before the jump, and after it.
    jump = np.flatnonzero(np.isclose(course["time"], moment, rtol=0.0, atol=1e-9))
    force = course["contact_force"].values
    assert before == force[jump[0]] > 0.0
    assert np.all(force[jump[-1] :] == 0.0)


def test_the_drop_is_drawn_as_a_jump():
    time, force = np.array([0.0, 1.0, 2.0, 2.0, 3.0]), np.array([1.0, 2.0, 1.5, 0.0, 0.0])
    assert plots.force_before(time, force, 2.0) == 1.5
    assert plots.force_before(time, np.zeros(5), 2.0) == 0.0


def test_a_part_that_does_not_align_has_no_mark(course):
    stuck = course.copy()
    stuck["outcome"] = np.int8(Outcome.HORIZON_REACHED)
    stuck["tau_align"] = NAN
    panels = plots.history(stuck).axes
    assert not any(named(axes.lines, "alignment") for axes in panels)
    assert not panels[-1].texts
    assert panels[0].get_title(loc="right") == "does not align (horizon reached)"


def test_a_trajectory_is_drawn_as_its_dataset_is(study, course):
    run = simulate(study.parameters("fig05"), study.settings.settings)
    for one, other in zip(plots.trajectory(run).axes, plots.history(course).axes, strict=True):
        for line, same in zip(one.lines, other.lines, strict=True):
            np.testing.assert_array_equal(line.get_xydata(), same.get_xydata())


# --- All of them --------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["fig05", "fig06", "fig12", "fig13", "fig14"])
def test_every_kind_of_dataset_of_the_study_can_be_drawn(study, course, name):
    sweep = sweep_of(study, name)
    if isinstance(study.figures[name], History):
        dataset = course
    else:
        dataset = merge_chunks(sweep, "title", "summary", [compute_chunk(sweep, 0, 1)])
    figure = plots.draw(dataset)
    figure.canvas.draw()
    if isinstance(study.figures[name], Curves):
        for line, row in zip(curve_lines(figure.axes[0]), dataset["tau_align"].values, strict=True):
            np.testing.assert_array_equal(line.get_ydata(), row)


def test_a_dataset_of_no_known_kind_is_refused(family):
    family.attrs["kind"] = "pie"
    with pytest.raises(ValueError, match=r"'pie'.*history, curves, map"):
        plots.draw(family)


def test_drawing_leaves_the_settings_of_matplotlib_alone(family):
    before = dict(mpl.rcParams)
    plots.draw(family)
    assert dict(mpl.rcParams) == before


@pytest.mark.parametrize(
    ("symbol", "text"),
    [
        ("f0", "$f_{0}$"),
        ("k_φ", "$k_{φ}$"),
        ("x_st", r"$x_{\mathrm{st}}$"),
        ("x(0)", "$x(0)$"),
        ("μ", "$μ$"),
    ],
)
def test_symbols_are_set_as_in_the_paper(symbol, text):
    assert plots.math(symbol) == text


def test_edges_of_cells_lie_halfway():
    np.testing.assert_allclose(plots.cell_edges(np.array([1.0, 2.0, 4.0])), [0.5, 1.5, 3.0, 5.0])
