"""Words and records of ``vibralign design``: a design, and what limits it."""

import math
import shlex
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from vibralign.answers.forces import forces_words
from vibralign.answers.si import named_words, si_words, written_words
from vibralign.commands.arguments import set_options
from vibralign.commands.assess import headline
from vibralign.commands.limits import exceeded_words, limit_rows
from vibralign.device.limits import LIMITS

if TYPE_CHECKING:
    from vibralign.answers.assess import Assessment
    from vibralign.answers.design import Design, Limiting
    from vibralign.answers.design_trials import Trials
    from vibralign.answers.limits import LimitResult
    from vibralign.device import StatedDevice

_line = "{:<23}{}".format


class Answer(NamedTuple):
    """Answer that is printed first: the design, its trials and what assess says."""

    design: "Design"
    trials: "Trials"
    assessed: "Assessment"

    @property
    def verdict(self) -> str:
        """The verdict on the recommended setting, as ``assess`` gives it."""
        check = self.design.check
        if check is not None and check.devices:
            return headline(self.assessed, check, self.limits)
        words = headline(self.assessed, None).partition(";")[0]
        return f"{words}; no others within the tolerances were tried"

    @property
    def limits(self) -> "tuple[LimitResult, ...]":
        """What the devices within the tolerances have of what a limit bounds."""
        from vibralign.answers.limits import LimitResult  # noqa: PLC0415  (scipy)

        of, best = self.design.tried.measures, self.design.best
        return tuple(
            LimitResult(name, limit, float(of[name][best]), None)
            for name, limit in self.design.limits.items()
        )


def _assess_command(stated: "StatedDevice", setting: Mapping[str, float]) -> str:
    """Return the command that assesses a device with a setting (SI units)."""
    changes = {**stated.changes, **{n: written_words(n, v, stated) for n, v in setting.items()}}
    sets = " ".join(set_options(changes).values())
    return f"vibralign assess --device {shlex.quote(str(stated.source))} {sets}"


def report(answer: Answer) -> list[str]:
    """Return lines on the recommended setting, or on the nearest to the limits."""
    design, tried, best = answer.design, answer.design.tried, answer.design.best
    stated, margin = answer.trials.stated, answer.design.tried.margin[answer.design.best]
    setting = named_words(design.setting, stated)
    if design.feasible:
        lines = [_line("recommended", setting)]
    else:
        lines = [nothing_found(design), _line("nearest to it", f"{setting}: {_faults(answer)}")]
    lines.append(_line("verdict", answer.verdict))
    doubts = stated.changed(**design.setting).doubts
    lines += [_line("doubtful", each) for each in doubts if each not in stated.doubts]
    if answer.assessed.cause:
        lines.append(_line("cause", answer.assessed.cause))
    if not tried.share[best] > 0.0:
        words = f"see what to change: {_assess_command(stated, design.setting)}"
        lines.append(_line("next", words))
    words = f"with deviations of {margin:.3g} times the tolerances"
    words = words if margin < 3.0 else "none within three times the tolerances"
    lines += [_line("nearest failure", words)] if margin > 0.0 else []
    some_fail = not tried.share[best] >= 1.0
    for name, after in (("time", " until alignment"), ("contact_force", ""), ("tilt", "")):
        value = float(tried.measures[name][best])
        if not math.isnan(value):  # something goes in; what does not has no time
            after += ", of the runs that go in" if some_fail and name == "time" else ""
            lines.append(_line(f"largest {name}", si_words(value, LIMITS[name][1]) + after))
    if design.check is not None and design.check.forces:
        words = forces_words(design.check.forces, None, answer.trials.settings, in_si=True)
        lines.append(_line("  of the force", words))
    lines += [_line(*row) for row in limit_rows(answer.limits)]
    words = f"{tried.share.size} settings quickly, {len(design.checks)} as assess checks them"
    if design.check is not None:
        drawn = f"{design.check.devices:,} devices" if design.check.devices else "none drawn"
        words += f", this one with {drawn}"
    return [*lines, _line("tried", words), *_limiting_lines(answer)]


def nothing_found(design: "Design") -> str:
    """Return why no setting is recommended."""
    failing = not design.tried.share[design.best] >= 1.0
    rules = ["goes in"] if failing else []
    rules += ["keeps the limits"] if _exceeded(design) else []
    whole = " with all devices within the tolerances" if failing else ""
    return f"no setting of those tried {' and '.join(rules)}{whole}"


def _exceeded(design: "Design") -> list[str]:
    return [each.name for each in design.limiting if each.kind == "limit" and each.passed]


def _faults(answer: Answer) -> str:
    """Return how many devices go in at a setting that does not hold, and the limits it passes."""
    check, words = answer.design.check, "as stated it does not go in"
    if check is not None and check.devices:
        words = f"{check.going_in:,} of {check.devices:,} drawn devices go in"
    exceeds = exceeded_words(answer.limits, only_drawn=False)
    return f"{words}; {exceeds}" if exceeds else words


def _limiting_lines(answer: Answer) -> list[str]:
    """Return the list of what limits the setting."""
    rows = [_limiting_words(answer, each) for each in answer.design.limiting]
    if not answer.design.tried.share[answer.design.best] > 0.0:
        rows.insert(0, "the device itself: as stated it does not go in")
    if not rows:
        return [_line("what limits it", "nothing: no limit and no end of a range is near")]
    return ["what limits it:", *(f"  {row}" for row in rows)]


def _limiting_words(answer: Answer, of: "Limiting") -> str:
    kind, name, passed = of
    if kind == "tolerance":
        return f"the tolerance of {name}"
    if kind == "limit":
        return f"the limit of {name}{', exceeded' * passed}"
    low, high = answer.design.free[name]
    end = low if kind == "lower end" else high
    return f"the {kind} of the range of {name}, {written_words(name, end, answer.trials.stated)}"


def record(answer: Answer) -> dict[str, Any]:
    """Return what ``--json`` prints."""
    from vibralign.answers.yields import CONFIDENCE  # noqa: PLC0415  (as in _design)

    design, stated = answer.design, answer.trials.stated
    measures = {n: float(each[design.best]) for n, each in design.tried.measures.items()}
    return {
        "feasible": design.feasible,
        "verdict": answer.verdict,
        "cause": answer.assessed.cause,
        "setting": design.setting,
        "setting_as_stated": {n: written_words(n, v, stated) for n, v in design.setting.items()},
        "margin": float(design.tried.margin[design.best]),
        **measures,
        "yield": float(design.tried.share[design.best]),
        "yield_interval": design.interval,
        "yield_confidence": CONFIDENCE,
        "devices": design.check and design.check.devices,
        "forces": design.check.forces if design.check else {},
        "limiting": [each._asdict() for each in design.limiting],
        "tried": int(design.tried.share.size),
        "checked": len(design.checks),
    }
