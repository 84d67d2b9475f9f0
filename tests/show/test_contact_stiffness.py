"""The report's section on the base, and its picture."""

import numpy as np
import pytest
import xarray as xr

from model.show.contact_plots import draw_bases
from model.show.report.contact_stiffness import numbers, sentences, verdicts
from model.study.contact_comparison import claims_on_bases
from model.study.contact_stiffness import RATIO, VARIATION
from tests.study.claims_data import NAN, curves, falling, plane

BASES = ((100.0, 0.05), (30.0, 0.05), (1e4, 0.05), (100.0, 0.0), (100.0, 1.0))


def on_bases(parts: list[xr.Dataset], kind: str) -> xr.Dataset:
    placed = [
        part.assign_coords(contact_stiffness=k, damping_ratio=ratio)
        for part, (k, ratio) in zip(parts, BASES, strict=True)
    ]
    varied = ["contact_stiffness", RATIO]
    joined = xr.concat(placed, VARIATION, coords=varied, combine_attrs="override")
    return joined.assign_attrs(kind=kind)


@pytest.fixture(scope="module")
def datasets() -> dict[str, xr.Dataset]:
    """Fig. 6 with durations that fall on soft bases only, and Fig. 13 the same on all bases."""
    soft, stiff = curves("fig06", falling)["fig06"], curves("fig06", lambda _, f: 1.0 + f)["fig06"]
    area = plane("fig13", lambda f, k: 5.0 if k > 2.0 * f else NAN, cells=8)["fig13"]
    return {
        "fig06": on_bases([soft, soft, stiff, soft, stiff], "curves"),
        "fig13": on_bases([area] * len(BASES), "map"),
    }


def test_sentences_name_the_features_that_depend_on_the_base(datasets) -> None:
    changing, same, claims = sentences(datasets, claims_on_bases(datasets))
    assert "Fig. 6: at the device's k_a = 100, 0 % of the runs end differently from" in changing
    assert "depends in part on the base" in changing
    assert "Some runs still change between the two stiffest bases" in changing
    assert "Fig. 13" in same
    assert "does not depend on the base. From k_a = 30 upward nothing changes visibly" in same
    assert "F6d (reproduced, then contradicted)" in claims
    assert "F13 " not in claims


def test_tables_have_a_row_for_each_base_and_a_sign_for_each_claim(datasets) -> None:
    judged = claims_on_bases(datasets)
    for name, dataset in datasets.items():
        rows = numbers(name, dataset).rows
        assert [row[:2] for row in rows] == [
            ("100", "0.05"), ("30", "0.05"), ("10\N{NARROW NO-BREAK SPACE}000", "0.05"),
            ("100", "0"), ("100", "1"),
        ]  # fmt: skip
    table = verdicts(judged, datasets["fig06"])
    assert len(table.columns) == 1 + len(BASES)
    signs = {each.claim.id: row[1:] for each, row in zip(judged, table.rows, strict=True)}
    assert signs["F6d"] == ("✓", "✓", "✗", "✓", "✗")
    assert signs["F13"] == ("✓",) * 5


def test_bases_are_drawn_by_stiffness_and_by_damping(datasets) -> None:
    figure = draw_bases(datasets)
    curves_left, curves_right, map_left, map_right = figure.axes
    assert len(curves_left.lines) == 3, "the bases with the device's damping ratio"
    assert len(curves_right.lines) == 3, "the stiffness of which several dampings are tried"
    softest = datasets["fig06"]["tau_align"].values[1, 2]
    assert np.array_equal(curves_left.lines[0].get_ydata(), softest)
    assert len(map_left.collections) == len(map_right.collections) == 3
    words = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert len(words) == 6
    assert any("$ζ$ = 1" in each for each in words)
