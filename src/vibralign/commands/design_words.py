"""Words and records of ``vibralign design``: a design, and the changes that were tried."""

import shlex
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from model.physics.quantities import TIME
from vibralign.answers.forces import forces_words
from vibralign.answers.si import named_words, quantity_of, si_words
from vibralign.commands.arguments import set_options
from vibralign.commands.assess import headline
from vibralign.commands.limits import MEASURES
from vibralign.commands.tables import in_columns
from vibralign.device.limits import VIBRATION

if TYPE_CHECKING:
    from model.runs.settings import Settings
    from vibralign.answers.assess import Assessment
    from vibralign.answers.design import Design, Known
    from vibralign.answers.design_changes import Change, Proposal
    from vibralign.answers.design_trials import Trials

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
            passed = " and ".join(_excess(self.design, name) for name in self.design.passed)
            return headline(self.assessed, check) + (f", but {passed}" if passed else "")
        words = headline(self.assessed, None).partition(";")[0]
        return f"{words}; no others within the tolerances were tried"


class Changes(NamedTuple):
    """Changes that were tried, those that were not, and why not."""

    tried: "list[Change]"
    left: "Sequence[Proposal]" = ()
    why: str = ""


def so_far(trials: "Trials", known: "Known") -> str:
    """Return a line on the best setting of a search that is interrupted."""
    from vibralign.answers.design import tried_of  # noqa: PLC0415  (scipy)

    if not known:
        return "no setting was tried yet"
    stated, source = trials.stated, shlex.quote(str(trials.stated.source))
    tried = tried_of([*known], [*known.values()], stated.free)
    best = int(tried.score(stated.limits).argmin())
    setting = {name: float(values[best]) for name, values in tried.settings.items()}
    holds = "keeps" if tried.keeps(stated.limits)[best] else "does not keep"
    changes = {**stated.changes, **{name: f"{value:.4g}" for name, value in setting.items()}}
    sets = " ".join(set_options(changes).values())
    return (
        f"best of {len(known):,} settings so far, by quick trials: {named_words(setting, stated)}; "
        "by them "
        f"it {holds} what is asked. Check it: vibralign assess --device {source} {sets}"
    )


def report(answer: Answer) -> list[str]:
    """Return lines on the recommended setting, or on the nearest to the limits."""
    from vibralign.answers.design_trials import POINTS  # noqa: PLC0415  (as in _design)

    design, tried, best = answer.design, answer.design.tried, answer.design.best
    margin = tried.margin[best]
    stated = answer.trials.stated
    setting = named_words(design.setting, stated)
    if design.feasible:
        lines = [_line("recommended", setting)]
    else:
        failing = not tried.share[best] >= 1.0
        rules = ["goes in"] if failing else []
        rules += ["keeps the limits"] if tried.excess(design.limits)[best] > 0.0 else []
        whole = " with all devices within the tolerances" if failing else ""
        lines = [f"no setting of those tried {' and '.join(rules)}{whole}"]
        lines.append(_line("nearest to it", f"{setting}: {'; '.join(_faults(design))}"))
    lines.append(_line("verdict", answer.verdict))
    if answer.assessed.cause:
        lines.append(_line("cause", answer.assessed.cause))
    if answer.assessed.change:
        words = f"{named_words(answer.assessed.change, stated)}: with it, it is reliable (tried)"
        lines.append(_line("first to change", words))
    words = f"{margin:.3g} tolerances away" if margin < 3.0 else "none within three tolerances"
    words += f", on {POINTS} lines from every start" if design.feasible else ""
    lines += [_line("nearest failure", words), *_largest(design, answer.trials.settings)]
    if "vibration" in design.limits:
        share, asked = tried.measures["vibration"][best], _asked(design.limits["vibration"])
        words = f"needed by {100.0 * share:.3g} % of the devices within the tolerances"
        lines.append(_line("vibration", f"{words} (limit: {asked})"))
    lines.append(_line("what binds", ", ".join(_binding(design)) or "nothing: it lies inside"))
    words = f"{tried.share.size} settings, quickly; {len(design.checks)} as assess checks them"
    if design.check is not None:
        words += f", this one by {design.check.devices:,} devices"
    lines.append(_line("tried", words))
    if design.feasible and len(design.front) > 1:
        words = "front of time against margin, by quick trials: assess one before you take it"
        lines += [words, *_front(design)]
    return lines


def _faults(design: "Design") -> list[str]:
    """Return how many devices go in at a setting that does not hold, and the limits it passes."""
    check = design.check
    if check is None or not check.devices:
        return ["as stated it does not go in"]
    words = [f"{check.going_in:,} of {check.devices:,} drawn devices go in"]
    return words + [_excess(design, name) for name in design.passed]


def _excess(design: "Design", name: str) -> str:
    """Return by how much the recommended setting passes a limit."""
    if name == "vibration":
        return f"the vibration is not always {_asked(design.limits[name])}"
    values = float(design.tried.measures[name][design.best]), design.limits[name]
    value, limit = (si_words(each, MEASURES[name]) for each in values)
    return f"its largest {name} {value} exceeds the limit of {limit} ({_more(*values)})"


def _more(value: float, than: float) -> str:
    """Return how much more a value is: per cent, or from the double on the factor."""
    ratio = value / than
    return f"{100.0 * (ratio - 1.0):+.2g} %" if ratio < 2.0 else f"{ratio:.3g} times as much"


def _binding(design: "Design") -> list[str]:
    """Return what keeps a design from a larger margin, or from its limits."""
    share = design.tried.share[design.best]
    if not share > 0.0:  # its measures are those of no device
        ends = [f"{side} end of {name}" for name, side in design.near_ends]
        return [*ends, "the device itself: as stated it does not go in"]
    passed = [f"limit of {name}" for name in design.passed]
    words = [f"{each} (passed)" if each in passed else each for each in design.binding]
    words += [f"{each} (passed)" for each in passed if each not in design.binding]
    return [*words, *([] if share >= 1.0 else ["the tolerances: some devices fail"])]


def _largest(design: "Design", settings: "Settings") -> list[str]:
    """Return lines on the largest time, force and tilt of the recommended setting."""
    lines = []
    all_go_in = design.tried.share[design.best] >= 1.0
    for name, quantity in MEASURES.items():
        limit = design.limits.get(name)
        most = "" if limit is None else f" (limit {si_words(limit, quantity)})"
        if name == "time":  # what does not go in has none
            most = f" until alignment{'' if all_go_in else ', of the runs that go in'}{most}"
        value = si_words(float(design.tried.measures[name][design.best]), quantity)
        lines.append(_line(f"largest {name}", value + most))
        if name == "contact_force" and design.check is not None and design.check.forces:
            words = forces_words(design.check.forces, None, settings, in_si=True)
            lines.append(_line("  of the force", words))
    return lines


def _front(design: "Design") -> list[str]:
    """Return a table of some eight settings on the front."""
    tried, rows = design.tried, []
    for i in design.front[:: max(len(design.front) // 8, 1)]:
        setting = {name: float(values[i]) for name, values in tried.settings.items()}
        time = si_words(float(tried.measures["time"][i]), TIME)
        rows.append((time, f"{tried.margin[i]:.3g} tolerances", named_words(setting)))
    return in_columns(rows)


def change_line(design: "Design", change: "Change") -> str:
    """Return a line on a change that was tried; empty for one that is listed at the end."""
    kind, name = change.proposal
    gives = _gives(change.design)
    if kind in _NOT_ENOUGH:
        if not change.better:
            return ""
        if kind == "tolerance":
            return _line("what to narrow", f"half the tolerance of {name}: {gives}")
        if name == "vibration":
            words = f"vibration: leave out that it is {_asked(design.limits[name])}"
        else:
            quantity, limit = MEASURES[name], design.limits[name]
            ends = f"{si_words(limit, quantity)} to {si_words(change.value, quantity)}"
            words = f"{name} from {ends} ({_more(change.value, limit)})"
        return _line("what to relax", f"{words}: {gives}")
    quantity = MEASURES[name] if kind == "limit" else quantity_of(name)
    words = f"{_WIDER[kind].format(name)} {si_words(change.value, quantity)}: "
    return _line("what to widen", words + (gives if change.better else "no better (tried)"))


def last_lines(changes: Changes) -> list[str]:
    """Return lines on what is not enough alone, and on what was not tried."""
    lines = []
    for kind, (label, words) in _NOT_ENOUGH.items():
        some = [each for each in changes.tried if each.proposal.kind == kind and not each.better]
        if names := ", ".join(each.proposal.name for each in some):
            lines.append(_line(label, f"{names}: {words} (tried)"))
    if changes.left:
        names = ", ".join(proposal_words(each) for each in changes.left)
        lines.append(_line("not tried", f"{names} ({changes.why})"))
    return lines


def proposal_words(proposal: "Proposal") -> str:
    """Return a change in words."""
    kind, name = proposal
    if kind == "tolerance":
        return f"half the tolerance of {name}"
    return f"{'wider ' if kind == 'limit' else ''}{kind} of {name}".replace(
        "relax of", "no limit of"
    )


_NOT_ENOUGH = {
    "relax": ("what to relax", "not enough alone; without it none goes in and keeps the rest"),
    "tolerance": ("what to narrow", "not enough alone; with half of it none keeps the limits"),
}
_WIDER = {"limit": "{} up to", "upper end": "{} up to", "lower end": "{} down to"}


def _gives(design: "Design") -> str:
    """Return the results of a setting in words, as they were checked."""
    tried, best = design.tried, design.best
    margin = tried.margin[best]
    words = f"margin {margin:.2g}" if margin < 3.0 else "margin 3 or more"
    parts = [f"{words} tolerances"]
    for name, quantity in MEASURES.items():
        parts.append(f"{name} {si_words(float(tried.measures[name][best]), quantity)}")
    return f"{', '.join(parts)} with {named_words(design.setting)} (tried)"


def _asked(share: float) -> str:
    """Return the words by which a device file states this limit of the vibration."""
    return next(words for words, each in VIBRATION.items() if each == share)


def record(answer: Answer, changes: Changes) -> dict[str, Any]:
    """Return what ``--json`` prints."""
    from vibralign.answers.yields import CONFIDENCE  # noqa: PLC0415  (as in _design)

    design, tried, best = answer.design, answer.design.tried, answer.design.best
    return {
        "feasible": design.feasible,
        "verdict": answer.verdict,
        "cause": answer.assessed.cause,
        "setting": design.setting,
        "yield": float(tried.share[best]),
        "yield_interval": design.interval,
        "yield_confidence": CONFIDENCE,
        "devices": design.check and design.check.devices,
        "margin": float(tried.margin[best]),
        **{name: float(values[best]) for name, values in tried.measures.items()},
        "forces": design.check.forces if design.check else {},
        "binding": design.binding,
        "passed": design.passed,
        "relax": {
            each.proposal.name: _change_record(each)
            for each in changes.tried
            if each.proposal.kind == "relax" and each.better
        },
        "widen": [
            {**each.proposal._asdict(), "better": each.better, **_change_record(each)}
            for each in changes.tried
            if each.proposal.kind not in _NOT_ENOUGH
        ],
        "narrow": {
            each.proposal.name: each.design.setting
            for each in changes.tried
            if each.proposal.kind == "tolerance" and each.better
        },
        "not_tried": [proposal_words(each) for each in changes.left],
        "not_tried_because": changes.why,
        "tried": int(tried.share.size),
        "checked": len(design.checks),
    }


def _change_record(change: "Change") -> dict[str, Any]:
    tried, best = change.design.tried, change.design.best
    measures = {name: float(values[best]) for name, values in tried.measures.items()}
    margin = float(tried.margin[best])
    return {"value": change.value, "setting": change.design.setting, "margin": margin, **measures}
