"""The campaign of `make fuzz`: many random sets, checked in parts whose reports are added up."""

import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from verification.fuzz import SCENES, UNEXPLAINED_SHARE, Finding, Report, try_sets

_AT_ONCE = 2000
_SHOWN = 10  # findings printed for each property
HOLDS = "every property holds"


def added(reports: Sequence[Report]) -> Report:
    """Return the sum of several reports."""
    total = reports[0]
    for report in reports[1:]:
        numbers: Any = zip(total, report, strict=True)
        total = Report(*(one + other for one, other in numbers))
    return total


def try_part(scene: str, seed: int, first: int, count: int) -> Report:
    """Check ``count`` sets of a scene from number ``first`` on."""
    starts = range(first, first + count, _AT_ONCE)
    return added(
        [try_sets(seed, n, min(_AT_ONCE, first + count - n), *SCENES[scene]) for n in starts]
    )


def report_text(report: Report) -> str:
    """Return a report as JSON."""
    told = {
        name: [list(each) for each in getattr(report, name)] for name in ("findings", "unexplained")
    }
    return json.dumps(report._asdict() | told, indent=1) + "\n"


def read_report(path: Path) -> Report:
    """Read what ``report_text`` returned."""
    stored = json.loads(path.read_text(encoding="utf-8"))
    stored["endings"] = Counter(stored["endings"])
    for name in ("findings", "unexplained"):
        stored[name] = [Finding(*each) for each in stored[name]]
    return Report(**stored)


def summary(report: Report, seed: int, scene: str = "alignment") -> str:
    """Return a report as text; the last line is ``HOLDS`` if no property is broken."""
    settings, _ = SCENES[scene]
    head = (
        f"{report.sets} sets of seed {seed}, scene {scene}, horizon {settings.horizon:g}, "
        f"tolerance {settings.tolerance:g}, at most {settings.max_evaluations} evaluations a run; "
        f"{report.sensitive} sensitive; {report.against_neighbour} compared with a neighbour, "
        f"{report.against_tighter} with a tighter tolerance"
    )
    often = sorted(report.endings.items(), key=lambda each: (-each[1], each[0]))
    lines = [head, *(f"{number:9}  {name}" for name, number in often)]
    told = report.findings + report.unexplained
    for what, number in Counter(finding.what for finding in told).items():
        lines.append(f"{number} sets: {what}")
        shown = [each for each in told if each.what == what][:_SHOWN]
        lines += [f"    set {finding.number}: {finding.found}" for finding in shown]
    if len(report.unexplained) > UNEXPLAINED_SHARE * report.sets:
        lines.append(
            f"more than a share of {UNEXPLAINED_SHARE:g} failed without a reason of its own"
        )
    elif not report.findings:
        lines.append(HOLDS)
    return "\n".join(lines) + "\n"
