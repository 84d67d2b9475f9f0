"""Identified values: tables read whole or refused, pictures that show their numbers."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from model.show.identification import (
    band_curves,
    claim_shares,
    readings_by_claims,
    structure_pairs,
)
from model.show.report.identification import content_of, exclusions, in_brief, pair_table
from model.study.claims.regime import Regime
from model.study.config import Aims, Range
from model.study.identification.band_table import Band
from model.study.identification.committed import (
    BudgetFront,
    FrontSet,
    IdentificationError,
    Identified,
    Split,
    read_identified,
    tables_of,
)
from model.study.identification.regimes import Row

RANGES = {"half_width": Range(low=0.5, high=2.0), "half_height": Range(low=1.0, high=4.0)}
CHOSEN = {"half_width": 1.0, "half_height": 2.0}
BAND = Band(
    at=2.0,
    x=np.array([0.0, 0.1, 0.2]),
    aligned=np.array([1.0, 0.8, 0.2]),
    low=np.array([1.0, 1.5, np.nan]),
    middle=np.array([2.0, 2.5, np.nan]),
    high=np.array([3.0, 4.0, np.nan]),
)
CLAIMS = ("N1", "F6a", "C2a")
AIMS = Aims(
    missing=1,
    beside=[],
    not_resting=0.1,
    not_resting_most=0.4,
    tilt=0.2,
    corners=0.9,
    aligned=0.2,
)


@pytest.fixture
def found() -> Identified:
    rng = np.random.default_rng(1)
    return Identified(
        ensemble={
            "half_width": 0.5 * 4.0 ** rng.random(4000),
            "half_height": np.full(4000, 2.0),
        },
        claims=CLAIMS,
        counted=np.array([True, True, False]),
        margins=np.array([0.1, -0.2, -0.9]),
        ensemble_shares=np.array([0.75, 0.25, 0.0]),
        prior_shares=np.array([0.5, 0.1, 0.02]),
        splits=(Split(0, 1, 1, 1, 1, 1, 1), Split(1, 1, 1, 1, 0, 1, 0)),
        readings={"consistent": np.array([0.1, 0.2, -0.9]), "printed": np.array([-1, -0.1, 0.3])},
        made_with={"search": "0123", "claims": "4567"},
        front=(
            FrontSet(True, False, 52, "N1 M4", 0.2, 0.6, 0.25, 0.9, 0.4),
            FrontSet(False, False, 49, "N1 M4", 0.3, 0.7, 0.3, 0.8, 0.4),
            FrontSet(True, True, 51, "N1 M4", 0.1, 0.4, 0.2, 0.95, 0.4),
        ),
        budget=(
            BudgetFront(1000, 50, 0.3, 0.9, 0.3, 0.9, 0.4),
            BudgetFront(4000, 48, 0.1, 0.5, 0.2, 0.9, 0.4),
            BudgetFront(4000, 51, 0.2, 0.6, 0.2, 0.9, 0.4),
        ),
    )


def write(folder: Path, found: Identified) -> None:
    for name, text in tables_of(found).items():
        (folder / f"{name}.csv").write_text(text, encoding="utf-8")


def test_tables_are_read_as_they_were_written(tmp_path: Path, found: Identified) -> None:
    write(tmp_path, found)
    again = read_identified(tmp_path)
    assert again.claims == found.claims
    assert again.splits == found.splits
    assert again.made_with == found.made_with
    assert again.front == found.front
    assert again.budget == found.budget
    np.testing.assert_array_equal(again.counted, found.counted)
    for name in ("margins", "ensemble_shares", "prior_shares"):
        np.testing.assert_array_equal(getattr(again, name), getattr(found, name))
    for name, values in found.ensemble.items():
        np.testing.assert_allclose(again.ensemble[name], values, rtol=1e-5)
    for name, margins in found.readings.items():
        np.testing.assert_array_equal(again.readings[name], margins)


@pytest.mark.parametrize(
    ("name", "content", "named"),
    [
        ("claims", None, "claims.csv: cannot be read"),
        ("splits", "number\n", "splits.csv: holds no row"),
        ("ensemble", "half_width\nwide\n", "is not what `make identification` writes"),
        ("readings", "reading,N1\nprinted,0.1\n", "name other claims"),
        ("splits", "number\n1,2\n", "is not what `make identification` writes"),
    ],
)
def test_a_table_that_is_none_is_refused(
    tmp_path: Path, found: Identified, name: str, content: str | None, named: str
) -> None:
    write(tmp_path, found)
    path = tmp_path / f"{name}.csv"
    path.unlink()
    if content is not None:
        path.write_text(content, encoding="utf-8")
    with pytest.raises(IdentificationError, match=named):
        read_identified(tmp_path)


def test_a_pair_shows_every_set_and_the_chosen_one(found: Identified) -> None:
    figure = structure_pairs(found.ensemble, CHOSEN, RANGES)
    axes = {each.get_ylabel() + each.get_xlabel(): each for each in figure.axes}["ba"]
    sets, chosen = axes.lines
    np.testing.assert_array_equal(sets.get_xdata(), found.ensemble["half_width"])
    np.testing.assert_array_equal(sets.get_ydata(), found.ensemble["half_height"])
    assert (chosen.get_xdata()[0], chosen.get_ydata()[0]) == (1.0, 2.0)
    assert axes.get_xlim() == (0.5, 2.0)
    assert axes.get_ylim() == (1.0, 4.0)


def test_claims_that_the_device_does_not_show_look_different(found: Identified) -> None:
    figure = claim_shares(
        found.claims, found.ensemble_shares, found.prior_shares, found.margins > 0.0
    )
    left = figure.axes[0]
    assert [label.get_text() for label in left.get_yticklabels()] == ["N1", "F6a"]
    prior, shown, missing = left.lines
    assert prior.get_xdata().tolist() == [0.5, 0.1]
    assert shown.get_xdata().tolist() == [0.75]
    assert missing.get_xdata().tolist() == [0.25]
    assert shown.get_marker() != missing.get_marker()


def test_readings_are_marked_where_they_fail(found: Identified) -> None:
    margins = np.array(list(found.readings.values()))
    figure = readings_by_claims(list(found.readings), found.claims, margins, found.counted)
    axes = figure.axes[0]
    crosses = {(line.get_xdata()[0], line.get_ydata()[0]) for line in axes.lines}
    assert crosses == {(2, 0), (0, 1), (1, 1)}
    names = [label.get_text() for label in axes.get_yticklabels()]
    assert names == ["consistent (2)", "as printed (0)"]  # the third claim does not count


def test_a_band_stands_behind_the_curve_of_its_parameter() -> None:
    friction = ("friction", [0.0, 0.1, 0.2], {"long_name": "friction", "symbol": "μ"})
    force = ("press_force", [1.0, 2.0], {"long_name": "force", "symbol": "f0"})
    taus = np.array([[1.0, 2.0, 3.0], [1.1, 2.2, 3.3]])
    dataset = xr.Dataset(
        {"tau_align": (("press_force", "friction"), taus)},
        {"friction": friction, "press_force": force},
        {"figure": "fig07"},
    )
    figure = band_curves({"fig07": (BAND,)}, [dataset])
    axes = figure.axes[0]
    assert "2" in axes.get_title(loc="left")
    middle, curve = axes.lines
    np.testing.assert_array_equal(curve.get_ydata(), taus[1])
    np.testing.assert_array_equal(middle.get_ydata(), BAND.middle)
    light = axes.collections[0].get_paths()[0].get_extents()
    assert (light.y0, light.y1) == (1.0, 4.0)


def test_the_section_counts_only_what_counts(found: Identified) -> None:
    section = content_of(found, CHOSEN, RANGES)
    assert (section["sets"], section["reproduced"], section["counted"]) == (4000, 1, 2)
    assert (section["rate"], section["rate_of_possible"]) == (0.5, 0.5)
    assert section["prior_rate"] == pytest.approx(0.3)
    wide, narrow = section["unknowns"]
    assert wide[-1] == pytest.approx(1.0, abs=0.03)  # as wide as the prior: nothing was learnt
    assert narrow[-1] == 0.0
    assert section["readings"] == [("consistent", 2, ""), ("as printed", 0, "N1, F6a")]


def test_the_section_names_what_no_admissible_set_shows_and_a_draw_does(found: Identified) -> None:
    def named(ensemble: list[float], prior: list[float]) -> str:
        shares = {"ensemble_shares": np.array(ensemble), "prior_shares": np.array(prior)}
        return content_of(replace(found, **shares), CHOSEN, RANGES)["never_together"]

    # The last claim does not count; of NaN, where one figure does not suffice, nothing is said.
    assert named([0.0, 0.0, 0.0], [0.5, 0.1, 0.02]) == "N1, F6a"
    assert named([0.0, 0.25, 0.0], [0.5, 0.1, 0.02]) == "N1"
    assert named([0.0, 0.0, 0.0], [0.0, np.nan, 0.02]) == ""


def test_the_section_says_which_claims_hang_on_which_correction(found: Identified) -> None:
    margins = {
        "consistent": [1.0, 1.0, 1.0], "printed": [-1.0, -1.0, 1.0],
        "normal_sign": [1.0, -1.0, 1.0], "preload": [-1.0, -1.0, -1.0],
    }  # fmt: skip
    readings = {name: np.array(values) for name, values in margins.items()}
    section = content_of(replace(found, readings=readings), CHOSEN, RANGES)
    assert section["mended"] == [("R1 corrected: sign of U1", "N1")]
    assert (section["together"], section["printed_only"], section["nowhere"]) == ("F6a", "", "")
    readings["consistent"], readings["printed"] = readings["preload"], readings["normal_sign"]
    readings["normal_sign"] = readings["preload"]
    section = content_of(replace(found, readings=readings), CHOSEN, RANGES)
    assert (section["printed_only"], section["nowhere"]) == ("N1", "F6a")


def test_what_was_found_is_told_in_brief(found: Identified) -> None:
    rows = [
        Row(device, figure, Regime(0.7, 0.1, share, 0.3, 0.5, 0.94, 1.0))
        for device, figure, share in (
            ("former", "fig06", 0.65), ("present", "fig06", 0.25), ("present", "fig07", 0.15),
        )
    ]  # fmt: skip
    text = in_brief(found, rows, AIMS)
    assert "without it 80 % of the points that align" in text
    assert "35 % of the former device's. It shows 51 of 53 claims" in text
    assert "among 4,000 candidates" in text
    assert text.endswith("falls short in claims.")


def test_claims_that_no_set_near_an_aim_shows_are_named() -> None:
    sets = (
        FrontSet(True, False, 52, "N1 M4b", 0.5, 0.6, 0.3, 0.9, 0.4),
        FrontSet(True, False, 40, "N1 F8a F9a F9b", 0.1, 0.6, 0.3, 0.9, 0.4),
        FrontSet(True, False, 41, "N1 F8a F6a F6b", 0.14, 0.6, 0.3, 0.9, 0.4),
    )
    assert exclusions(sets, AIMS) == [
        ("rest unvibrated in nearly all figures (2 sets)", "F8a"),
        ("align over the stated share of every figure (3 sets)", "none"),
        ("show most claims (1 sets)", "M4b"),
    ]
    pairs = {row[0]: row[1:] for row in pair_table(sets, AIMS).rows}
    assert pairs["claims"] == ["2.00", "4.00", "2.00", "2.00", "2.00", "2.00"]
    assert pairs["rest"][1:3] == ["1.00", "1.50"]
