"""Sections on findings beyond the figures: vibration, jamming."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from model.events.outcomes import REASON_TEXT, Outcome, Reason
from model.sweeps.vibration import overshoot_of
from study import jamming_plot
from study.claims import figure_of
from study.claims.regime import regime_of
from study.jamming import entered, in_jamming_diagram, jammed, wedging_side
from study.report.section import Results, Section, Table, settings_of
from vibralign.plots.words import figure_title, percent

VIBRATION_CAPTION = (
    "What vibration adds over tilt stiffness and pressing force. On the ticked side of the line "
    "the part rests on the edge if it is pressed slowly."
)
_FOLDER = Path(__file__).parent


# --- Vibration ----------------------------------------------------------------------------------


def vibration(results: Results) -> Section:
    """Return the section on vibration, which compares runs with their unvibrated controls."""
    own = {name: results.dataset(f"data/{name}.nc") for name in results.study.computed}
    shares = Table(
        ("figure", ">aligned", ">also unvibrated", ">of these by overshoot", ">do not rest",
         ">tilt, median", ">largest", ">corners inside"),
        [_shares(name, dataset) for name, dataset in own.items()],
    )  # fmt: skip
    added = results.picture("figures/fig13_vibration", VIBRATION_CAPTION)
    content = {"added": added, "shares": shares}
    template = _FOLDER / "findings.vibration.html.j2"
    return Section("vibration", "What vibration adds", template, content)


def _shares(name: str, dataset: xr.Dataset) -> Sequence[object]:
    regime = regime_of(figure_of(dataset))
    outcome = dataset["outcome"].values
    shares = regime.static, overshoot_of(dataset), regime.not_resting
    *unvibrated, corners = (
        "" if math.isnan(share) else percent(share) for share in (*shares, regime.corners)
    )
    tilts = (f"{np.degrees(tilt):.1f}°" for tilt in (regime.tilt, regime.tilt_largest))
    aligned = np.count_nonzero(outcome == Outcome.ALIGNED)
    head = figure_title(name), f"{aligned:,} of {outcome.size:,}"
    return *head, *unvibrated, *tilts, corners


# --- Jamming ------------------------------------------------------------------------------------


def jamming(results: Results) -> Section:
    """Return the section on jamming: outcomes of parts that fall in, compared with statics."""
    dataset = results.dataset("data/jamming.nc")
    falls, stuck, beyond = entered(dataset), jammed(dataset), wedging_side(dataset)
    gone_in = dataset["outcome"].values == Outcome.INSERTED
    counted = falls, gone_in, stuck, stuck & beyond, falls & beyond
    rows = [
        (f"{clearance:g}", *(int(each[place].sum()) for each in counted))
        for place, clearance in enumerate(dataset["clearance"].values)
    ]
    sideways, turning = in_jamming_diagram(dataset)
    undriven = int((stuck & ((abs(sideways) > 1.0) | (abs(turning) > 1.0))).sum())
    reasons = dataset["reason"].values[stuck]
    held = [
        (REASON_TEXT[Reason(each)], int((reasons == each).sum())) for each in np.unique(reasons)
    ]
    shares = [float(of[falls].mean()) if falls.any() else np.nan for of in (gone_in, stuck)]
    lead = (
        f"Of {int(falls.sum()):,} parts that fall in, {percent(shares[0])} go in and "
        f"{percent(shares[1])} jam. {wedging_words(stuck, beyond, falls, undriven)}"
    )
    content = {
        "picture_of": results.picture("figures/jamming", jamming_plot.CAPTION),
        "files": (("dataset (netCDF)", "data/jamming.nc"),),
        "held": settings_of(results.study.jamming.held),
        "counts": Table(
            ("clearance δ", ">fall in", ">go in", ">jam", ">of these above the limit",
             ">above the limit"), rows),
        "reasons": Table(("held by", ">parts"), held),
    }  # fmt: skip
    return Section("jamming", "Jamming", _FOLDER / "findings.jamming.html.j2", content, lead)


def wedging_words(stuck: np.ndarray, beyond: np.ndarray, falls: np.ndarray, undriven: int) -> str:
    """Compare the parts that jam with the wedging limit, and with the jamming diagram.

    The masks are True for parts that jam, lie above the limit, and fall in; ``undriven`` is the
    number of jammed parts outside the diagram.
    """
    below = falls & ~beyond
    if not stuck.any():
        return (
            f"{int((falls & beyond).sum())} of them lie above the textbook's wedging limit at "
            "their tilt at entry, where two points at rest would hold a part: vibrated, it goes in."
        )
    high, low = int((stuck & beyond).sum()), int((stuck & below).sum())
    return (
        f"{high} of the {int(stuck.sum())} that jam lie above the textbook's wedging limit at "
        f"their tilt at entry; below it {low} of {int(below.sum()):,} jam. {undriven} of them all "
        "lie outside the jamming diagram: press and springs cannot drive them on at two points."
    )
