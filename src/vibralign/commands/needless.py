"""``vibralign assess`` of a device that needs no alignment at its stated values.

Its tolerances may reach farther, and its limits bind all the same: the devices within the
tolerances are run, and judged as those of any other device.
"""

import argparse
import os
from dataclasses import asdict, replace
from typing import TYPE_CHECKING

from vibralign.answers.assumptions import assumptions, lines_of, source_words
from vibralign.commands.arguments import announce_compilation
from vibralign.commands.limits import exceeded_words, limit_lines, limit_rows
from vibralign.commands.progress import ProgressLine
from vibralign.commands.tables import print_json
from vibralign.commands.tables import report_line as _line
from vibralign.commands.yields import (
    required_words,
    yield_lines,
    yield_record,
    yield_rows,
    yield_words,
)

if TYPE_CHECKING:
    from model.runs.settings import Settings
    from vibralign.answers.yields import FailingDevice, Yield
    from vibralign.device import StatedDevice


def assess_needless(
    arguments: argparse.Namespace,
    stated: "StatedDevice",
    settings: "Settings",
    required: float | None,
    devices: int,
) -> int:
    """Answer ``assess`` for a device that needs no alignment as stated; return the exit code."""
    for option in ("plot", "sheet"):
        if getattr(arguments, option) is not None:
            raise ValueError(
                f"--{option}: there is no run to draw, as {stated.needless}; `vibralign map` draws "
                "over the misalignment"
            )
    from model.sweeps.settings import Ensemble  # noqa: PLC0415  (scipy, as below)
    from vibralign.answers.limits import limit_results  # noqa: PLC0415
    from vibralign.answers.sheet import part_words  # noqa: PLC0415

    drawn, failing, run = None, None, stated
    if stated.tolerances:
        announce_compilation()
        with ProgressLine() as line:
            line.begin("devices within the tolerances")
            drawn, failing, run = _drawn(stated, settings, devices)
    limits = limit_results(stated, None, drawn, settings)
    kept = all(each.exceeding is None for each in limits)
    met = required is None or drawn is None or (drawn.meets(required) and kept)
    assumed = assumptions(stated.parameters, settings, stated, Ensemble())
    verdict = stated.needless + "".join(
        f", but it {words}" for words in (exceeded_words(limits, only_drawn=False),) if words
    )
    if drawn is not None:
        verdict += f"; yield {yield_words(drawn)} under the tolerances"
    if arguments.json:
        found = drawn and yield_record(drawn, failing, run, settings)
        of_limits = [asdict(each) | {"kept": each.exceeding is None} for each in limits]
        print_json({"verdict": verdict, "needs_alignment": False, "yield": found,
                    "limits": of_limits, "assumptions": assumed})  # fmt: skip
        return int(not met)
    rows, rest = [("device", f"{source_words(stated)}: {part_words(stated)}")], []
    rows.append(("verdict", verdict))
    if drawn is not None:
        rows += yield_rows(drawn, failing, run, required_words(required, drawn, kept=kept))
        rest = yield_lines(drawn, failing, run, settings)
    lines = [_line(*row) for row in [*rows, *limit_rows(limits)]]
    if arguments.details:
        lines += [*rest, *limit_lines(limits), *lines_of(assumed)]
    print("\n".join(lines))
    return int(not met)


def _drawn(
    stated: "StatedDevice", settings: "Settings", devices: int
) -> tuple["Yield", "FailingDevice | None", "StatedDevice"]:
    """Return yield, nearest failing device, and the device with the approach that was run.

    If the file states none, it is the worst at the farthest misalignment within the tolerances.
    """
    from model.sweeps.settings import Ensemble  # noqa: PLC0415  (scipy, as below)
    from vibralign.answers import yields  # noqa: PLC0415
    from vibralign.answers.approaches import in_worst_approach  # noqa: PLC0415
    from vibralign.answers.cases import cases_of  # noqa: PLC0415
    from vibralign.answers.reliability import STATISTICAL_TOLERANCE  # noqa: PLC0415

    cores, own = os.cpu_count() or 1, stated.quantities["misalignment"]
    tolerance = stated.tolerances.get("misalignment")
    far = own if tolerance is None else own + tolerance.end(own)
    farthest = replace(stated, quantities={**stated.quantities, "misalignment": far})
    lowered = in_worst_approach(farthest, settings, Ensemble(), cores)
    lowered = replace(lowered, quantities={**lowered.quantities, "misalignment": own})
    cases = cases_of(lowered, Ensemble(), varied=stated.tolerances)
    settings = replace(settings, tolerance=max(settings.tolerance, STATISTICAL_TOLERANCE))
    drawn, results = yields.yield_of(lowered, cases, settings, cores, devices=devices)
    return drawn, yields.nearest_failing(lowered, results, cases), lowered
