"""The device sheet: self-contained, the same bytes, with the numbers of its device."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from matplotlib.patches import Rectangle

from model.runs.settings import Settings
from vibralign.answers.assess import Assessment
from vibralign.answers.leeways import Leeway
from vibralign.commands import sheet
from vibralign.device import load_device
from vibralign.plots import device_sheet

PEG = Path(__file__).resolve().parents[2] / "square" / "devices" / "peg.yaml"
VERDICT = ("reliable at the stated values; yield 100 % under the tolerances", True)
LEEWAY = Leeway("misalignment", 0.6e-3, 0.2e-3, 0.7e-3, fails_above=0.71e-3)
RESULT = Assessment(load_device(PEG), 32, 32, 2.0, 3.0, None, leeways=(LEEWAY,))
GROUPS = {
    "Verdict": ["starts   aligns from 32 of 32 starts", "at most  19 N"],
    "Leeways": ["friction to 0.3"],
    "Yield": ["yield 100 %"],
}


def test_a_sheet_is_self_contained_and_has_the_same_bytes(tmp_path, monkeypatch):
    monkeypatch.setattr(sheet, "_COUNT", 9)
    stated, settings = (
        load_device(PEG, {"press_force": "12 N"}),
        Settings(horizon=40.0, tolerance=1e-6),
    )
    pages = []
    for name in ("one.html", "two.html"):
        sheet.write_sheet(tmp_path / name, stated, VERDICT, GROUPS, RESULT, settings)
        pages.append((tmp_path / name).read_bytes())
    assert pages[0] == pages[1]
    page = pages[0].decode()
    assert page.count("data:image/svg+xml;base64,") == 3
    assert re.findall(r'(?:src|href)="(?!data:)([^"]*)', page) == []
    assert f'<p class="verdict good">{VERDICT[0]}</p>' in page
    assert f"<p>{PEG}, with press_force=12 N; vibralign " in page  # the footer
    assert re.search(r"<td>press force</td><td>12 N</td><td>± 1.2 N</td>", page)
    assert re.search(r"<td>amplitude</td><td>1 mm</td><td>± 0.05 mm</td>", page)
    assert "@page { size: A4" in page


def test_the_cross_stands_at_the_stated_point_in_the_units_of_the_axes(tmp_path, monkeypatch):
    """Both axes are drawn in mm, the device is in m."""
    monkeypatch.setattr(sheet, "_COUNT", 3)
    drawn = []
    monkeypatch.setattr(device_sheet, "_picture", lambda figure: drawn.append(figure) or "")
    stated = replace(load_device(PEG), free={})
    more = Leeway("amplitude", 1e-3, 0.9e-3, 4e-3, fails_below=0.89e-3)
    result = replace(RESULT, leeways=(LEEWAY, more))
    settings = Settings(horizon=40.0, tolerance=1e-6)
    sheet.write_sheet(tmp_path / "sheet.html", stated, VERDICT, GROUPS, result, settings)
    drawn = [figure for figure in drawn if figure.legends]
    axes = drawn[0].axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("amplitude (mm)", "misalignment (mm)")
    [cross] = [line for line in axes.lines if line.get_marker() == "P"]
    own = stated.quantities
    [[x], [y]] = cross.get_data()
    assert (x, y) == pytest.approx((1e3 * own["amplitude"], 1e3 * own["misalignment"]))
    legend = [text.get_text() for text in drawn[0].legends[0].get_texts()]
    assert legend[-2:] == ["as stated", "its tolerances"]
    drawn[0].draw_without_rendering()
    title = axes.title.get_window_extent()
    assert 0.0 <= title.x0 < title.x1 <= drawn[0].bbox.x1
    [box] = [each for each in axes.patches if isinstance(each, Rectangle)]
    assert box.get_width() == pytest.approx(2e3 * stated.tolerances["amplitude"].around(x / 1e3))
