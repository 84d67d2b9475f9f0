"""``vibralign calibrate``: what trials tell of the unknowns of a device, and what to do next."""

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vibralign.answers.si import named_words, rounded, written_words
from vibralign.commands.arguments import add_model_options, announce_compilation, read_device
from vibralign.commands.files import check_file, writing
from vibralign.commands.program import add_command, add_json
from vibralign.commands.progress import ProgressLine
from vibralign.commands.tables import in_columns, print_json
from vibralign.commands.tables import report_line as _line

if TYPE_CHECKING:
    from vibralign.known.calibrate import Calibration
    from vibralign.known.next_trial import Next

_LISTED = 3  # trials that are proposed
_POOR = 0.5  # share of what is possible up to which a setting is better changed


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "calibrate",
        _calibrate,
        "say what trials tell of the unknown quantities of a device, and what to do next",
        ". The device file has their ranges (unknown: {friction: 0.1 to 0.35}). The table of "
        "trials, as a spreadsheet saves it, has a column for each quantity that was set, and "
        "`result`: the alignment time (91.6 ms, or 91.6 ± 5 ms), fails, fails after 2 s, or > 500 "
        "ms if it was stopped. First, calibrate says whether the model fits the trials at all.",
        epilog="exit code: 0 the trials tell something; 1 the model does not fit, or the sample is "
        "too small to conclude; 2 bad input",
    )
    add = parser.add_argument
    add("--trials", type=Path, required=True, metavar="FILE", help="table of trials (.csv)")
    words = "device file to write (.yaml), with samples beside it (.nc): assess and design read it"
    add("--out", type=Path, metavar="FILE", help=words)
    words = "do not seek the trial to make next; seeking it takes about as many runs again"
    add("--no-next", action="store_true", help=words)
    add_model_options(parser, scene="insertion")
    add_json(parser)


def _calibrate(arguments: argparse.Namespace) -> int:
    if arguments.out is not None:
        check_file(arguments.out, "--out", ["yaml", "yml"])
        check_file(arguments.out.with_suffix(".nc"), "--out", ["nc"])
        if arguments.out.exists() and arguments.out.samefile(arguments.device):
            raise ValueError(f"--out {arguments.out}: is the device file: choose another name")
    device, settings = read_device(arguments, known_in_part=True)
    from vibralign.known.calibrate import calibrate  # noqa: PLC0415  (scipy)

    if arguments.out is not None:
        from vibralign.known.files import device_text  # noqa: PLC0415  (xarray)

        device_text(device, "")  # refuses before anything is computed
    announce_compilation()
    cores = os.cpu_count() or 1
    with ProgressLine() as line:

        def tell(words: str) -> None:
            line.begin(f"trials: {words}")

        found = calibrate(device, arguments.trials, settings, cores, tell=tell)
    lines = [] if arguments.json else report(found)
    print("\n".join(lines), end="\n" if lines else "", flush=True)
    after: Next | None = None
    if found.concludes and not arguments.no_next:
        with ProgressLine() as line:
            after = found.next(settings, cores, line.begin)
    if arguments.json:
        print_json(_record(found, after))
    elif after is not None:
        print("\n".join(next_lines(after, found)))
    if found.concludes and arguments.out is not None:
        from vibralign.known.files import write  # noqa: PLC0415  (xarray)

        with writing():
            samples = write(found, arguments.out)
        if not arguments.json:
            print(f"wrote {arguments.out} and {samples}: vibralign assess --device {arguments.out}")
    return int(not found.concludes)


def report(found: "Calibration") -> list[str]:
    """Return the lines on the fit and, if the model fits, on the posterior."""
    from vibralign.known.fit import BETTER, LEAST  # noqa: PLC0415  (scipy)

    fit, device = found.fit, found.device
    share = f"{100.0 * fit.share:.3g} %"
    words = f"trials made by the model are at least as far out with a probability of {share}"
    rival, odds = max(fit.rivals.items(), key=lambda each: each[1], default=("", 0.0))
    better = f"{rival} makes the trials {_factor(odds)} times as probable"
    supported = fit.odds > 0.0 or not fit.fits
    if fit.fits and supported:
        words = f"the model fits the trials: {words}"
    elif fit.fits:
        words = f"the trials neither contradict the model nor support it: {words}, but chance, "
        words += f"fitted to them, makes them {_factor(-fit.odds)} times as probable"
    elif fit.share < LEAST:
        words = f"THE MODEL DOES NOT FIT THESE TRIALS: {words} (less than {100.0 * LEAST:.2g} %)"
    else:
        words = f"THE MODEL DOES NOT FIT THESE TRIALS: {better} (the limit is {BETTER:g})"
    lines = [_line("fit", words), _line("device", device.source)]
    more, less = ("the model", "chance")[:: 1 if fit.odds > 0.0 else -1]
    words = f"; {more} makes them {_factor(abs(fit.odds))} times as probable as {less} does"
    lines.append(_line("trials", f"{len(found.trials)}{words if supported else ''}"))
    if odds > 0.0 and better not in lines[0]:
        words = f"{better} (from {BETTER:g} times on, the model does not fit)"
        lines.append(_line("  rival", words))
    for number in fit.outside:
        share = f"{100.0 * fit.predicted[number]:.3g} %"
        text = f"{found.trials[number].words}: the other trials give it a probability of {share}"
        lines.append(_line("  outside", text))
    lines += [_line("  note", each) for each in found.notes]
    if not fit.fits:
        words = "widen the ranges, check the trials above, or look for what the model leaves out"
        return [*lines, _line("so", f"nothing can be concluded: {words}")]
    effective = found.samples.effective
    words = f"effective sample size {effective:.0f} of {len(found.samples.z)} sets"
    if not found.concludes:
        words += ": too small to conclude; narrow the ranges, or state larger errors of the times "
        words += "(120 ± 10 ms)"
        lines.append(_line("posterior", words))
        return lines
    lines.append(_line("posterior", f"{words}, {found.seconds:.0f} core-seconds"))
    lines.append("unknown; its range; 5, 50, 95 % after the trials; share of the range left:")
    rows = []
    for name, (low, middle, high) in found.intervals().items():
        ends = device.unknown[name]
        left = (high - low) / (0.9 * (ends.high - ends.low))
        after = ", ".join(written_words(name, each, device) for each in (low, middle, high))
        before = " to ".join(written_words(name, each, device) for each in ends)
        rows.append((name, before, after, f"{100.0 * left:.0f} %"))
    return [*lines, *in_columns(rows), *(_line("  but", each) for each in found.piled)]


def _factor(odds: float) -> str:
    return rounded(10.0**odds, 2) if odds < 4.0 else f"10^{odds:.0f}"


def next_lines(after: "Next", found: "Calibration") -> list[str]:
    """Return the lines on the verdict at the intended setting and what to do next."""
    from vibralign.known.next_trial import NOISE  # noqa: PLC0415  (scipy)

    at = "the setting of the device file"
    if after.intended:
        at = named_words(after.intended, found.device)
    words = f"reliable for {100.0 * after.share:.3g} % of what is possible, a doubt of "
    lines = [_line("intended", at), _line("verdict", f"{words}{after.doubt:.2f} bits")]
    if after.knowing_adds == after.knowing_adds:  # no NaN
        words = f"everything would add {100.0 * after.knowing_adds:.2g} % to this share"
        lines.append(_line("knowing", words))
    if not after.is_worth_it:
        return [*lines, _line("next", _without_trial(after, found))]
    best = after.trials[0].bits
    if best < NOISE:
        lines.append(_line("next", f"no trial would tell more than {NOISE} bits about the verdict"))
    told = [each for each in after.trials[:_LISTED] if each.bits >= NOISE]
    rows = [(each.words, f"{each.bits:.2f} bits", "") for each in told]
    for each in (one for one in after.bench if one.bits >= NOISE):
        count = f"worth {each.bits / best:.1f} trials" if told else ""
        rows.append((each.words, f"{each.bits:.2f} bits", count))
    head = ["next, and the doubt that it takes away:"] if rows else []
    return [*lines, *head, *in_columns(rows)]


def _without_trial(after: "Next", found: "Calibration") -> str:
    """Return words on what to do where no trial is worth making."""
    words = "no trial is worth making"
    if after.share > _POOR:
        return words
    if found.device.free:
        return f"{words}: no setting is much better; widen the ranges below free"
    return f"{words}: change the setting; state below free what may change, for vibralign design"


def _record(found: "Calibration", after: "Next | None") -> dict[str, Any]:
    fit = found.fit
    record: dict[str, Any] = {
        "fits": fit.fits,
        "fit": fit.share,
        "odds": fit.odds,
        "rivals": dict(fit.rivals),
        "outside": [found.trials[i].row for i in fit.outside],
        "effective_sample_size": found.samples.effective,
        "sets": len(found.samples.z),
        "core_seconds": found.seconds,
        "notes": list(found.notes),
        "unknowns": {},
        "next": None,
    }
    if found.concludes:
        record["unknowns"] = {name: list(each) for name, each in found.intervals().items()}
        record["piled"] = found.piled
    if after is not None:
        record["next"] = {
            "intended": dict(after.intended), "share": after.share, "doubt": after.doubt,
            "knowing_adds": after.knowing_adds, "worth_it": after.is_worth_it,
            "trials": [each._asdict() for each in after.trials[:_LISTED]],
            "bench": [each._asdict() for each in after.bench],
        }  # fmt: skip
    return record
