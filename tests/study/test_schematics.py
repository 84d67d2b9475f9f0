"""Figs. 1-4: part and slot are drawn where the model has them; a figure has the same bytes."""

import os
import subprocess
import sys
from math import cos, sin
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure

from model.physics import geometry
from study import schematics
from tests.vibralign.plots.drawn import named
from vibralign.device.paper import baseline
from vibralign.plots import style

BASELINE = baseline()
OTHER = BASELINE.replace(half_width=1.9, half_height=3.5, clearance=0.15, misalignment=0.6)
EITHER = pytest.mark.parametrize("parameters", [BASELINE, OTHER], ids=["baseline", "other"])


def drawn_parts(figure: Figure) -> list[np.ndarray]:
    """Return the corners of every polygon that is drawn as the part, in drawing order."""
    patches = [patch for axes in figure.axes for patch in named(axes.patches, "part")]
    return [patch.get_xy()[:-1] for patch in patches]


def drawn_edges(figure: Figure) -> list[tuple[float, float]]:
    """Return the edges of the slot as drawn: at the height of the base, nearest to the axis."""
    edges = []
    for line in (line for axes in figure.axes for line in named(axes.lines, "base")):
        points = line.get_xydata()
        level = points[points[:, 1] == 0.0]
        inmost = np.abs(level[:, 0]).min()
        edges += [tuple(point) for point in level if abs(point[0]) == inmost]
    return edges


@EITHER
@pytest.mark.parametrize("name", sorted(schematics.DRAWINGS))
def test_the_slot_is_as_wide_as_the_parameters_say(name, parameters):
    edges = drawn_edges(schematics.DRAWINGS[name](parameters))
    # l = a (1 + δ) by hand, not through the model's property.
    half = parameters.half_width * (1.0 + parameters.clearance)
    assert sorted({edge[0] for edge in edges}) == pytest.approx([-half, half])


def test_a_wider_clearance_widens_the_slot_and_not_the_part():
    wider = BASELINE.replace(clearance=0.2)
    before, after = schematics.fig01.draw(BASELINE), schematics.fig01.draw(wider)
    growth = max(drawn_edges(after))[0] - max(drawn_edges(before))[0]
    assert growth == pytest.approx(BASELINE.half_width * 0.11)
    for figure in (before, after):
        side = np.linalg.norm(drawn_parts(figure)[0][0] - drawn_parts(figure)[0][3])
        assert side == pytest.approx(2 * BASELINE.half_width)


@EITHER
@pytest.mark.parametrize("name", ["fig01", "fig02", "fig03"])
def test_the_part_rests_with_its_bottom_face_on_the_right_edge(name, parameters):
    (corners,) = drawn_parts(schematics.DRAWINGS[name](parameters))
    right, top_right, top_left, left = corners
    edge = np.array([parameters.half_width * (1.0 + parameters.clearance), 0.0])
    face, reach = right - left, edge - left
    assert face[0] * reach[1] - face[1] * reach[0] == pytest.approx(0.0, abs=1e-12)
    assert 0.0 < reach @ face < face @ face
    assert left[1] < 0.0 < right[1]  # B2 dips into the slot, so the tilt is counter-clockwise
    assert corners.mean(axis=0)[0] == pytest.approx(parameters.misalignment)
    assert np.linalg.norm(top_right - right) == pytest.approx(2 * parameters.half_height)
    assert top_left - left == pytest.approx(top_right - right)


@EITHER
def test_the_parts_of_fig_4_have_the_models_corners(parameters):
    poses = schematics.fig04.contact_poses(parameters)
    parts = drawn_parts(schematics.fig04.draw(parameters))
    assert len(parts) == len(poses) == 3
    for corners, pose in zip(parts, poses, strict=True):
        place = pose.x, pose.y, pose.tilt, pose.constants
        assert corners[0] == pytest.approx(geometry.bottom_corner(1.0, *place), abs=1e-12)
        assert corners[3] == pytest.approx(geometry.bottom_corner(-1.0, *place), abs=1e-12)
        # D2 = C - a e_t + b e_n, written out.
        a, b, c, s = parameters.half_width, parameters.half_height, cos(pose.tilt), sin(pose.tilt)
        assert corners[2] == pytest.approx((pose.x - a * c - b * s, pose.y - a * s + b * c))


@EITHER
def test_fig_4_shows_the_two_kinds_of_contact(parameters):
    start, below, beside = schematics.fig04.contact_poses(parameters)
    a, b = parameters.half_width, parameters.half_height
    at_start, at_face = start.edge_place(1.0), below.edge_place(1.0)
    assert at_start.along_axis == pytest.approx(-b)
    assert at_face.along_axis > -b  # d > 0
    assert at_face.along_face == pytest.approx(at_start.along_face)
    at_side = beside.edge_place(-1.0)
    assert -a < at_side.along_face < 0.0  # w > 0
    assert -b < at_side.along_axis < b  # between the corners B2 and D2


@pytest.mark.parametrize("name", sorted(schematics.DRAWINGS))
def test_no_label_leaves_the_page(name):
    figure = schematics.DRAWINGS[name](BASELINE)
    with style.context():
        renderer = figure.canvas.get_renderer()
        page = figure.bbox
        for axes in figure.axes:
            for text in axes.texts:
                box = text.get_window_extent(renderer)
                assert page.x0 <= box.x0 < box.x1 <= page.x1, text.get_text()
                assert page.y0 <= box.y0 < box.y1 <= page.y1, text.get_text()


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, ...]:
    return style.save(schematics.fig04.draw(BASELINE), tmp_path_factory.mktemp("here") / "fig04")


def test_saved_figures_carry_text_and_no_date(saved):
    assert [path.name for path in saved] == ["fig04.png", "fig04.svg", "fig04.pdf"]
    assert sorted(saved[0].parent.iterdir()) == sorted(saved)  # no temporary file is left
    picture = saved[1].read_text(encoding="utf-8")
    assert "<text" in picture
    assert "date" not in picture
    for path in saved:
        assert mpl.__version__.encode() not in path.read_bytes()


_SAVE = """
import sys
from pathlib import Path
from study import schematics
from vibralign.plots import style
from vibralign.device.paper import baseline
style.save(schematics.fig04.draw(baseline()), Path(sys.argv[1]))
"""


def test_two_processes_write_the_same_bytes(saved, tmp_path):
    # This one and another, with a hash seed of its own: the order of sets must not reach the files.
    source = str(Path(schematics.__file__).parents[3])
    environment = {**os.environ, "PYTHONHASHSEED": "1", "PYTHONPATH": source}
    command = [sys.executable, "-c", _SAVE, str(tmp_path / "fig04")]
    subprocess.run(command, check=True, env=environment)
    for path in saved:
        assert path.read_bytes() == (tmp_path / path.name).read_bytes(), path.suffix
