"""Section on jamming: what becomes of parts that fall in, beside the statics of two points."""

from pathlib import Path

import numpy as np

from model.events.outcomes import REASON_TEXT, Outcome, Reason
from model.show.jamming import CAPTION
from model.show.report.section import Results, Section, Table, settings_of
from model.show.words import percent
from model.study.jamming import entered, in_jamming_diagram, jammed, wedging_side


def section(results: Results) -> Section:
    """Return the section on jamming."""
    dataset = results.dataset("data/jamming.nc")
    falls, stuck, beyond = entered(dataset), jammed(dataset), wedging_side(dataset)
    gone_in = dataset["outcome"].values == Outcome.INSERTED
    rows = [
        (
            f"{clearance:g}",
            *(int(each[place].sum()) for each in (falls, gone_in, stuck, stuck & beyond)),
            int((falls & beyond)[place].sum()),
        )
        for place, clearance in enumerate(dataset["clearance"].values)
    ]
    sideways, turning = in_jamming_diagram(dataset)
    undriven = int((stuck & ((abs(sideways) > 1.0) | (abs(turning) > 1.0))).sum())
    reasons = dataset["reason"].values[stuck]
    held = [
        (REASON_TEXT[Reason(each)], int((reasons == each).sum())) for each in np.unique(reasons)
    ]
    lead = (
        f"Of {int(falls.sum()):,} parts that fall in, {percent(_share(gone_in, falls))} go in and "
        f"{percent(_share(stuck, falls))} jam. {_beyond(stuck, beyond, falls, undriven)}"
    )
    content = {
        "picture_of": results.picture("figures/jamming", CAPTION),
        "files": (("dataset (netCDF)", "data/jamming.nc"),),
        "held": settings_of(results.study.jamming.held),
        "counts": Table(
            ("clearance δ", ">fall in", ">go in", ">jam", ">of these above the limit",
             ">above the limit"), rows),
        "reasons": Table(("held by", ">parts"), held),
    }  # fmt: skip
    return Section("jamming", "Jamming", Path(__file__).with_suffix(".html.j2"), content, lead)


def _share(part: np.ndarray, of: np.ndarray) -> float:
    return float(part[of].mean()) if of.any() else np.nan


def _beyond(stuck: np.ndarray, beyond: np.ndarray, falls: np.ndarray, undriven: int) -> str:
    """Compare the jammed parts with the wedging limit."""
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
