"""Answers for a device that is known in part, in words and for --json: assess and design."""

import argparse
import os
import shlex
from typing import TYPE_CHECKING, Any

from model.physics.quantities import TIME
from vibralign.answers.assumptions import assumptions, lines_of
from vibralign.answers.reliability import counted
from vibralign.answers.si import named_words, si_list, si_words, written_words
from vibralign.commands.arguments import announce_compilation, set_options
from vibralign.commands.progress import ProgressLine
from vibralign.commands.tables import in_columns, print_json
from vibralign.commands.tables import report_line as _line
from vibralign.device.plausibility import DISTRUSTED

if TYPE_CHECKING:
    from model.runs.settings import Settings
    from vibralign.device import StatedDevice
    from vibralign.known.doubt import Unknown
    from vibralign.known.possible import Possible
    from vibralign.known.settings import Covering

_NOTHING = "no trial is worth making"
_FEW = 8  # sets of a verdict, below which nothing is said of what decides


def assess_in_part(
    arguments: argparse.Namespace,
    device: "StatedDevice",
    settings: "Settings",
    required: float | None,
) -> int:
    """Answer ``assess`` for a device with unknown quantities; return the exit code."""
    if arguments.sheet is not None:
        raise ValueError(
            "--sheet: has no sheet while quantities are unknown: give each of these with --set, or "
            "leave out --sheet"
        )
    from vibralign.known.possible import check_known, known_in_part  # noqa: PLC0415  (scipy)

    check_known(device)
    announce_compilation()
    with ProgressLine() as line:
        line.begin("what is possible, from every touch-down")
        found = known_in_part(device, settings, os.cpu_count() or 1)
    met = required is None or found.interval[0] >= required
    if arguments.json:
        print_json(_record(found) | {"required": required, "met": met})
    else:
        head = [_line("device", device.source), *_unknown_lines(device)]
        print("\n".join([*head, *possible_lines(found, device, _horizon(device, settings))]))
        if required is not None:
            print(_line("required", f"{100.0 * required:.4g} %: {'met' if met else 'not met'}"))
        if arguments.details:
            assumed = assumptions(device.parameters, counted(settings), device)
            del assumed["touch-down"]  # of one run
            print("\n".join(lines_of(assumed)))
    return int(not met)


def design_in_part(
    arguments: argparse.Namespace, device: "StatedDevice", settings: "Settings"
) -> int:
    """Answer ``design`` for a device with unknown quantities; return the exit code."""
    from vibralign.known.settings import covering  # noqa: PLC0415  (scipy)

    announce_compilation()
    with ProgressLine() as line:
        found = covering(device, settings, os.cpu_count() or 1, line.begin)
    own = device.changed(**found.setting)
    if arguments.json:
        print_json({"setting": found.setting, "knowing_adds": found.knowing_adds,
                    "tried": found.tried} | _record(found.possible))  # fmt: skip
    else:
        head = [_line("device", device.source), *_unknown_lines(device)]
        words = f"{named_words(found.setting, own)} (of {found.tried} settings tried)"
        lines = possible_lines(found.possible, own, _horizon(own, settings))
        print("\n".join([*head, _line("setting", words), *lines, *_worth_lines(found)]))
    return int(not found.possible.reliable.all())


def _of_middle(device: "StatedDevice") -> str:
    """Return the command that assesses the device in the middle of its ranges."""
    middle = {name: written_words(name, device.quantities[name], device) for name in device.unknown}
    words = " ".join(set_options({**device.changes, **middle}).values())
    return f"vibralign assess --device {shlex.quote(str(device.source))} {words}"


def _horizon(device: "StatedDevice", settings: "Settings") -> float:
    """Return the horizon in s of the runs of a device that states what else it has."""
    return device.horizon or settings.horizon * device.units.time


def _worth_lines(found: "Covering") -> list[str]:
    from vibralign.known.settings import NOTHING  # noqa: PLC0415  (scipy)

    adds = f"knowing everything would add {100.0 * found.knowing_adds:.2g} % to this share"
    if found.knowing_adds < NOTHING:
        adds += f": {_NOTHING}"
    return [_line("trials", adds)]


def _unknown_lines(device: "StatedDevice") -> list[str]:
    if device.samples is not None:
        import numpy as np  # noqa: PLC0415

        from vibralign.known.possible import SETS, sets_of  # noqa: PLC0415  (scipy)

        after = []
        for name, column in sets_of(device, SETS).items():
            ends = np.quantile(column, (0.05, 0.5, 0.95)).tolist()
            after.append((name, ", ".join(written_words(name, each, device) for each in ends)))
        head = f"unknown, as the trials in {device.samples.name} leave it (5, 50, 95 %):"
        return [head, *in_columns(after)]
    rows = [
        (name, " to ".join(written_words(name, end, device) for end in each),
         "log-uniform" if each.is_log else "")
        for name, each in device.unknown.items()
    ]  # fmt: skip
    return ["unknown:", *in_columns(rows)]


def possible_lines(found: "Possible", device: "StatedDevice", horizon: float) -> list[str]:
    """Return the lines of the verdict over what is possible; ``horizon``: that of its runs in s."""
    low, high = found.interval
    share = f"{100.0 * found.share:.3g} %"
    words = f"reliable for {share} of what is possible"
    if found.reliable.all():
        words = "reliable for all that is possible"
    elif not found.reliable.any():
        words = "reliable for none of what is possible"
    words += f" ({100.0 * low:.3g} to {100.0 * high:.3g} %, 95 % confidence)"
    if any(DISTRUSTED in each for each in device.doubts):
        words += f"; {DISTRUSTED}: the base is soft"
    tried = f"{found.reliable.size} sets of the unknowns, each from {found.touch_downs} touch-downs"
    lines = [_line("verdict", words), _line("tried", f"{tried} within the tolerances")]
    if found.undecided:
        words = f"too short for {100.0 * found.undecided:.3g} % of what is possible: "
        words += f"the part still moves after {si_words(horizon, TIME)}; try --horizon "
        lines.append(_line("horizon", f"{words}'{si_words(4.0 * horizon, TIME)}'"))
    longest = found.longest[found.reliable]
    if longest.size:
        import numpy as np  # noqa: PLC0415  (as above)

        times = si_list(np.quantile(longest, (0.05, 0.5, 0.95)).tolist(), TIME)
        lines.append(
            _line("longest time", f"{times} until aligned (5, 50, 95 % of the reliable sets)")
        )
    if not found.reliable.any():
        words = f"see the cause in the middle of the ranges: `{_of_middle(device)}`"
        lines.append(_line("next", words))
    if "vibration" in device.limits:
        lines.append(_line("not checked", "the limit of vibration, over what is possible"))
    fewest = min(int(found.reliable.sum()), int((~found.reliable).sum()))
    if 0 < fewest < _FEW:
        lines.append(_line("what decides", f"cannot be told: only {fewest} sets differ"))
    elif fewest:
        lines.append(
            "what decides (first-order share of the verdict's variance, 90 % interval), and how "
            "much of the doubt goes if it is measured to a tenth of its range:"
        )
        rows = [
            (each.name, f"{each.share:.2f} ({each.low:.2f} to {each.high:.2f})",
             f"{100.0 * max(each.worth, 0.0):.0f} %", _borders(each, device))
            for each in found.unknowns
        ]  # fmt: skip
        lines += in_columns(rows)
    return lines


def _borders(each: "Unknown", device: "StatedDevice") -> str:
    words = []
    for side, value, verdict in each.borders:
        known = "reliable" if verdict else "not reliable"
        words.append(f"{side} {written_words(each.name, value, device)} {known}")
    return f"{'; '.join(words)}, whatever the other unknowns are" if words else ""


def _record(found: "Possible") -> dict[str, Any]:
    return {
        "share": found.share,
        "interval": list(found.interval),
        "sets": int(found.reliable.size),
        "touch_downs": found.touch_downs,
        "doubt": found.doubt,
        "undecided": found.undecided,
        "unknowns": [each._asdict() for each in found.unknowns],
    }
