"""The reference: small datasets kept with the code, with which a build is compared.

Tolerances follow from the estimated error of every point. Outcomes may differ only at points that
the reference flags as sensitive or chaotic. An intended difference is accepted: ``accepted.csv``
states its reason and its size.
"""

import csv
import io
import shutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from model.engine.results import RESULTS, TRACK_VARIABLES, UNVIBRATED_CONTROL
from model.engine.tolerances import Compared
from model.events.outcomes import Reason
from model.sweeps.files import atomic_write, write_text
from model.sweeps.io import read_dataset
from study.tracking import TrackingError
from study.tracking.checkout import git_state
from study.tracking.compare import (
    CLAIMS,
    change_of,
    changed_verdicts,
    changes_of,
    common_points,
)

if TYPE_CHECKING:
    import xarray as xr

LOG = "accepted.csv"
LOG_COLUMNS = "date", "what", "reason", "commit", "changed"

NEW_SENSITIVE_SHARE = 0.02
_FLAGS = "sensitive", "reason", "outcome"
# A course between the ends of steps, linear where the reference's is: relative to its range.
COURSE_TOLERANCE = 2e-3


@dataclass(frozen=True)
class Disagreement:
    """A difference that the tolerances do not allow; ``words`` describe it for the user."""

    figure: str
    variable: str
    points: int
    words: str


# --- The comparison -----------------------------------------------------------------------------


def compare_with_reference(reference: "xr.Dataset", built: "xr.Dataset") -> list[Disagreement]:
    """Return the differences between two datasets of a figure that the tolerances do not allow."""
    figure = str(reference.attrs["figure"])
    differing = [
        str(name)
        for name, coordinate in reference.coords.items()
        if name != "time"
        and (name not in built.coords or not coordinate.variable.equals(built[name].variable))
    ]
    if differing:
        words = f"is not computed with the reference's parameters: {', '.join(differing)}"
        return [Disagreement(figure, "parameters", 0, words)]
    findings = [*_points(reference, built)]
    if "time" in reference.coords:
        findings += _courses(reference, built)
    return [Disagreement(figure, *each) for each in findings]


_Found = tuple[str, int, str]


def _points(reference: "xr.Dataset", built: "xr.Dataset") -> Iterator[_Found]:
    """Yield what differs at points with a certain outcome: neither sensitive nor chaotic."""

    def both(name: str) -> list[NDArray[Any]]:
        return [np.atleast_1d(each[name].values).ravel() for each in (reference, built)]

    (sensitive, now_sensitive), (reason, _), (outcome, _) = map(both, _FLAGS)
    regular = (sensitive == 0) & (reason != Reason.CHAOTIC)
    for name in ("outcome", "reason"):
        flipped = regular & np.not_equal(*both(name))
        if flipped.any():
            where = _place(reference, int(flipped.argmax()))
            yield name, int(flipped.sum()), f"differs at points that are not sensitive, as {where}"
    fresh = regular & (now_sensitive != 0)
    most = max(2, int(NEW_SENSITIVE_SHARE * regular.size))
    if fresh.sum() > most:
        words = f"is set at {fresh.sum()} more points than in the reference, {most} are allowed"
        yield "sensitive", int(fresh.sum()), words
    same_end, error = regular & np.equal(*both("outcome")), both("tau_error")[0].astype(np.float64)
    for name, result in {**RESULTS, **UNVIBRATED_CONTROL}.items():
        if result.tolerance is None or not result.stored:
            continue
        old, new = (each.astype(np.float64) for each in both(name))
        distance, allowed = np.abs(new - old), result.tolerance(Compared(old, error, outcome))
        one_sided = np.isnan(old) != np.isnan(new)
        wrong = same_end & (one_sided | (distance > allowed))
        if wrong.any():
            excess = np.full(distance.shape, np.inf)
            np.divide(distance, allowed, out=excess, where=~one_sided & (allowed > 0.0))
            worst = int(np.argmax(np.where(wrong, excess, -1.0)))
            became = f"{old[worst]:.9g} became {new[worst]:.9g} ({allowed[worst]:.1e} allowed)"
            yield name, int(wrong.sum()), f"{became} at {_place(reference, worst)}"


def _courses(reference: "xr.Dataset", built: "xr.Dataset") -> Iterator[_Found]:
    old, new = common_points(reference, built)
    for name in (name for name, each in TRACK_VARIABLES.items() if each.stored):
        extent = float(np.ptp(reference[name].values)) or 1.0
        change = change_of(old[name], new[name], "")
        if change.largest > COURSE_TOLERANCE * extent:
            moment = change.at.get("time", float("nan"))
            yield name, change.differing, f"differs by {change.largest:.2e} at τ = {moment:.4g}"


def _place(dataset: "xr.Dataset", point: int) -> str:
    """Return the coordinates of a point, given by its flat index, in words."""
    variable = dataset["outcome"]
    named = zip(variable.dims, np.unravel_index(point, variable.shape), strict=False)
    return ", ".join(f"{name} = {dataset[name].values[i]:g}" for name, i in named) or "the run"


def verify(root: Path, reference: Path, figures: Sequence[str]) -> list[Disagreement]:
    """Return the differences of a build from the reference that are not allowed.

    ``figures`` are those with datasets that are compared.
    """
    findings = []
    for figure in figures:
        accepted, built = reference / f"{figure}.nc", root / "data" / f"{figure}.nc"
        if not accepted.is_file():
            words = f"has no reference: python -m study accept --figure {figure} --reason ..."
            findings.append(Disagreement(figure, "dataset", 0, words))
        elif not built.is_file():
            findings.append(Disagreement(figure, "dataset", 0, f"{built} is missing: build it"))
        else:
            try:
                findings += compare_with_reference(read_dataset(accepted), read_dataset(built))
            except KeyError as missing:
                reason = str(missing.args[0]).partition(". ")[0]
                words = f"{built} cannot be compared with {accepted} ({reason}): build it again"
                findings.append(Disagreement(figure, "dataset", 0, words))
    if (reference / CLAIMS).is_file():
        findings += _claims(reference / CLAIMS, root / CLAIMS)
    return findings


def _claims(accepted: Path, built: Path) -> list[Disagreement]:
    if not built.is_file():
        return [Disagreement(CLAIMS, "verdict", 0, f"{built} is missing: build it")]
    return [
        Disagreement(CLAIMS, each.name, 1, f"{each.before} became {each.after}")
        for each in changed_verdicts(accepted, built)
    ]


# --- Accepting ----------------------------------------------------------------------------------


def accept(root: Path, reference: Path, what: Mapping[str, bool], reason: str) -> list[str]:
    """Make results of a build of the small study the reference; return a line for each of them.

    ``what`` has the names of figures, and "claims" for the verdicts; True for those that have a
    dataset. The log keeps the reason beside the numbers.

    Raises:
        TrackingError: the reason is not in words, or results are missing.
    """
    if len(reason.split()) < 2:
        raise TrackingError(f"--reason {reason!r}: say in a few words why it is right")
    sources = {name: _sources(root, name, computed=computed) for name, computed in what.items()}
    now, commit = datetime.now(UTC).date().isoformat(), git_state().get("commit")
    rows, words = [], []
    for name, files in sources.items():
        changed = _changed(files, reference)
        rows.append((now, name, reason, commit, changed))
        words.append(f"{name}: {changed or 'nothing'} changed")
        for file in files:
            with atomic_write(reference / file.name) as part:
                shutil.copyfile(file, part)
    log, added = reference / LOG, io.StringIO()
    before = log.read_text(encoding="utf-8") if log.is_file() else ""
    csv.writer(added, lineterminator="\n").writerows(rows if before else [LOG_COLUMNS, *rows])
    write_text(before + added.getvalue(), log)
    return words


def _sources(root: Path, name: str, *, computed: bool) -> list[Path]:
    """Return the files to copy: a figure's dataset, if it has one, then its picture."""
    files = [root / "data" / f"{name}.nc"] if computed else []
    files.append(root / CLAIMS if name == "claims" else root / "figures" / f"{name}.png")
    for file in files:
        if not file.is_file():
            raise TrackingError(f"{file} is missing: build the study that is to be accepted")
    return files


def _changed(files: Sequence[Path], reference: Path) -> str:
    """Return what has changed in a result: names of claims, or variables with their numbers."""
    if not (reference / files[0].name).is_file():
        return "(first)"
    said = []
    for built in files:
        accepted = reference / built.name
        if built.name == CLAIMS:
            said += [each.name for each in changed_verdicts(accepted, built)]
        elif built.suffix != ".nc":
            same = accepted.is_file() and accepted.read_bytes() == built.read_bytes()
            said += [] if same else ["picture"]
        else:
            old, new = read_dataset(accepted), read_dataset(built)
            if old["outcome"].dims != new["outcome"].dims:
                return "(another grid)"
            said += [
                f"{each.variable} at {each.differing} of {each.points} by {each.largest:.3g}"
                for each in changes_of(old, new, "")
            ]
    return ", ".join(said)
