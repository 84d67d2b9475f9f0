"""Sections on findings beyond the figures: vibration, the paper's claims, jamming."""

import itertools
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from string import ascii_lowercase

import numpy as np
import xarray as xr

from model.events.outcomes import REASON_TEXT, Outcome, Reason
from model.sweeps.vibration import overshoot_of
from study import jamming_plot
from study.claims import VERDICTS, Tables, tally
from study.claims.ledger import Line, read_ledger
from study.claims.regime import regime_of
from study.config.figures import COMPUTED
from study.evidence.worth import is_shown_by_nearly_any, shown_by, shown_by_own, summary
from study.identification import hold_out
from study.jamming import entered, in_jamming_diagram, jammed, wedging_side
from study.report.section import Results, Section, Table, settings_of
from vibralign.plots.words import figure_title, percent, short

VIBRATION_CAPTION = (
    "What vibration adds over tilt stiffness and pressing force. On the ticked side of the line "
    "the part rests on the edge if it is pressed slowly."
)
CLAIMS_CAPTION = (
    "Runs made for the claims alone. Where the duration is shown, a curve ends where the part does "
    "not align and where the duration jumps; where another quantity is shown, a pale band "
    "marks runs that align."
)
POINTS: Mapping[str, str] = {
    "seen": "the figures that it saw",
    "drawn": "the others, at points drawn from the priors",
    "regime": "the others, at points chosen by regime",
    "claims": "the others, at points fitted to their claims",
}
SIGNS: Mapping[str, str] = dict(zip(VERDICTS, ("✓", "±", "✗", "–"), strict=True))
_FOLDER = Path(__file__).parent


# --- Vibration ----------------------------------------------------------------------------------


def vibration(results: Results) -> Section:
    """Return the section on vibration, which compares runs with their unvibrated controls."""
    own = {name: results.dataset(f"data/{name}.nc") for name in COMPUTED}
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
    regime = regime_of(Tables.of({name: dataset}), name)
    outcome = dataset["outcome"].values
    shares = regime.static, overshoot_of(dataset), regime.not_resting
    *unvibrated, corners = (
        "" if math.isnan(share) else percent(share) for share in (*shares, regime.corners)
    )
    tilts = (f"{np.degrees(tilt):.1f}°" for tilt in (regime.tilt, regime.tilt_largest))
    aligned = np.count_nonzero(outcome == Outcome.ALIGNED)
    head = figure_title(name), f"{aligned:,} of {outcome.size:,}"
    return *head, *unvibrated, *tilts, corners


# --- Claims -------------------------------------------------------------------------------------


def claims(results: Results) -> Section:
    """Return the section on the paper's claims: verdicts, and runs made for the claims alone."""
    titles = {name: run.title for name, run in results.study.claims_runs.items()}
    letters = dict(zip(titles, ascii_lowercase, strict=False))
    lines = read_ledger(results.file("claims.csv"))
    null, assumptions = (results.dataset(f"data/{name}.nc") for name in ("null", "assumptions"))

    def source(name: str) -> tuple[str, str]:
        own = name in letters
        return (f"run {letters[name]}", "#claims-runs") if own else (figure_title(name), f"#{name}")

    content = {
        "tally": tally([line.verdict for line in lines]),
        "worth": summary(lines, null),
        "by_kind": _by_kind(lines),
        "draws": _draws(null, assumptions),
        "null_horizon": short(results.study.evidence.grid.horizon),
        "assumptions": _assumptions(assumptions),
        "nearly_any": is_shown_by_nearly_any,
        "hold_out": _hold_out(),
        "hold_out_words": hold_out.summary(),
        "lines": lines,
        "signs": SIGNS,
        "source": source,
        "runs": results.picture("figures/claims", CLAIMS_CAPTION),
        "files": [
            ("the ledger (CSV)", "claims.csv"),
            ("random devices (netCDF)", "data/null.nc"),
            ("other assumptions (netCDF)", "data/assumptions.nc"),
            *((f"{of.lower()} (netCDF)", f"data/claims/{name}.nc") for name, of in titles.items()),
        ],
    }
    template = _FOLDER / "findings.claims.html.j2"
    return Section("claims", "What the paper says, judged", template, content)


def _by_kind(lines: Sequence[Line]) -> str:
    """Return in a sentence how many numbered conclusions are reproduced, and how much else."""
    numbers = []
    for is_concluded in (True, False):
        of = [x.verdict for x in lines
              if x.demand and x.place.startswith("concl.") == is_concluded]  # fmt: skip
        numbers.append(f"{of.count('reproduced')} of {len(of)}")
    return "Of the numbered conclusions {} are reproduced, of all else {}.".format(*numbers)


def _draws(null: xr.Dataset, assumptions: xr.Dataset) -> Table:
    """List how many claims the study's device and the draws of each kind show on one grid."""
    device = shown_by_own(null, assumptions)
    own = device.numbers[0]
    rows = [
        (title, each.size, each.min(), f"{np.median(each):g}", each.max(), (each >= own).sum(),
         f"{np.median(bits):.0f}", f"{bits.max():.0f}")
        for title, each, bits in (device, *shown_by(null))
    ]  # fmt: skip
    claims = ">draws", ">claims: least", ">median", ">most", ">as many as the device"
    return Table(("", *claims, ">bits: median", ">most"), rows)


def _assumptions(dataset: xr.Dataset) -> Table:
    """List the verdicts under each assumption, and the claims that turn; the study's own first."""
    verdicts, claims = dataset["verdict"].values, dataset["claim"].values
    shown = verdicts == VERDICTS.index("reproduced")
    counts = [(verdicts == VERDICTS.index(each)).sum(axis=1) for each in VERDICTS[:3]]
    rows = [
        (title, *(int(count[row]) for count in counts), " ".join(claims[shown[0] & ~shown[row]]),
         " ".join(claims[shown[row] & ~shown[0]]))
        for row, title in enumerate(dataset["title"].values)
    ]  # fmt: skip
    heads = (f">{verdict}" for verdict in VERDICTS[:3])
    return Table(("", *heads, "no longer reproduced", "reproduced instead"), rows)


def _hold_out() -> Table:
    """List what a search on half of the figures shows of the other, beside random structures."""
    counts = hold_out.measured().set_index(["half", "points", "structure"])

    def spread(*which: str) -> str:
        if which not in counts.index:
            return "–"
        mean, least, most = counts.loc[which, ["mean", "min", "max"]]
        return f"{mean:.1f} ({least:.0f} to {most:.0f})" if least < most else f"{mean:g}"

    rows = [
        (half, words, int(counts.loc[(half, points, "searched"), "claims"]),
         spread(half, points, "random"), spread(half, points, "searched"))
        for half, (points, words) in itertools.product(counts.index.unique("half"), POINTS.items())
    ]  # fmt: skip
    heads = ">claims", ">random structures show", ">the structure found shows"
    return Table(("half not seen", "judged by", *heads), rows)


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
