"""Cause of a failure, from the run itself: in words, and what cures it first."""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from model.events.outcomes import REASON_TEXT, Outcome, Reason
from model.physics.contacts import support_on_face
from model.physics.notation import RIGHT_EDGE, State
from model.physics.parameters import Shape, constants_of
from model.runs.simulate import Trajectory
from vibralign.answers.leeways import Nearest, steps_between
from vibralign.answers.si import in_words_of, rounded
from vibralign.device.instead import parameter_of

STICKS = 0.99  # share of the time
_SOME_WAY = 0.1  # share of the way to the hole: what has come less takes ten horizons and more
_SOFTER = (("tilt_stiffness", -1), ("friction", -1), ("amplitude", 1), ("press_force", 1))
_OF_PARTS = {"friction", "clearance", "misalignment", "inertia", "mass", "half_width",
             "half_height", "contact_stiffness", "contact_damping"}  # fmt: skip
_HOLDS = (("press_force", -1), ("tilt_stiffness", 1), ("tilt_damping", 1))


class Cause(NamedTuple):
    """Cause of a failure.

    Attributes:
        words: a sentence.
        cures: parameters that cure it, in the order to try, each with its direction, 1 or -1.
    """

    words: str
    cures: Sequence[tuple[str, int]]


class _Lean(NamedTuple):
    """Largest angle by which the support's common normal leans, with the friction angle there."""

    tilt: float
    normal: float
    friction: float


def cause_of(run: Trajectory, shape: Shape) -> Cause:
    """Return the cause for which a run of a part of this shape has failed."""
    found = _cause_of(run, shape)
    return found._replace(words=in_words_of(shape, found.words))


def _cause_of(run: Trajectory, shape: Shape) -> Cause:
    tilt = f"{math.degrees(run.tilt_max):.2g}°"
    why = REASON_TEXT[run.reason]
    if not math.isnan(run.tau_align):
        return _in_hole(run, tilt)
    if run.outcome in (Outcome.SETTLED, Outcome.HORIZON_REACHED):
        against = _against(run, shape)
        if run.sticking_share >= STICKS:
            place = "the rim" if shape == "round" else "the edge"
            place = place if run.state[-1, 2] >= 0.0 else "its corner"
            words = f"it hardly slips: it sticks on {place} {100.0 * run.sticking_share:.3g} % of "
            return Cause(f"{words}the time, {against}", _SOFTER)
        way = 100.0 * way_of(run)
        come = f"it has come {rounded(way, 2)} % of the way to the hole"
        if way < 0.0:
            times = f"{rounded(-way / 100.0, 2)} times the way"
            far = times if way < -200.0 else f"{rounded(-way, 2)} % of the way"
            come = f"it has moved away from the hole, by {far}"
        lifted = f"lifts off {run.separations} times" if run.separations else "never lifts off"
        if way > 100.0:
            past = (
                f"at the horizon it has passed the hole's edge by {rounded(way - 100.0, 2)} % of "
            )
            return Cause(f"it does not drop: {past}the way; it slips, {lifted}", _SOFTER)
        words = f"it slips, {lifted}, {against}"
        if run.outcome == Outcome.SETTLED:
            return Cause(f"the vibration moves it no further: {come}; {words}", _SOFTER)
        slow = "too slow" if way >= 0.0 else "it does not come nearer"
        return Cause(f"{slow}: at the horizon {come}; {words}", _SOFTER)
    if run.reason == Reason.ON_FLANK:
        words = f"the answer is not known: {why}; tilted by up to {tilt}"
        return Cause(words, (("tilt_stiffness", 1), ("press_force", -1)))
    if run.reason == Reason.MOVED_AWAY:
        words = f"it is pressed too little or topples: {why}, tilted by up to {tilt}"
        return Cause(words, (("press_force", 1), ("tilt_stiffness", 1), ("press_force", -1)))
    if run.outcome == Outcome.LEFT_SCENE:
        return Cause(f"it topples or jumps off: {why}, tilted by up to {tilt}", _HOLDS)
    return Cause(f"the run cannot be finished: {why}", ())


def _against(run: Trajectory, shape: Shape) -> str:
    """Return the largest tilt of a run in words, against the friction angle of its support.

    The support of a plane part slides under a vertical force if it is tilted by more than its
    friction angle. Of a round part the common normal of the tips leans otherwise than the part,
    and the wedge makes the friction angle larger.
    """
    found = _lean(run, shape)
    tilt, normal, friction = (f"{math.degrees(each):.2g}°" for each in found)
    leans = f", so that the contact leans by {normal}" if shape == "round" else ""
    wedges = found.friction > 1.1 * math.atan(run.parameters.friction)
    wedged = ", as the hole wedges its two tips" if wedges else ""
    return f"tilted by at most {tilt}{leans}; by friction it slides only from {friction} on{wedged}"


def _lean(run: Trajectory, shape: Shape) -> _Lean:
    """Return lean and friction angle at the largest tilt towards the hole, from the contact."""
    p = constants_of(run.parameters, shape)
    state = State(*run.state[int(np.argmax(run.state[:, 2]))].tolist())
    contact = support_on_face(RIGHT_EDGE, state, p)
    normal = math.hypot(*contact.normal[:2])  # 1/w of the wedge
    lean = math.atan2(contact.tangent[1], contact.tangent[0])
    return _Lean(state.tilt, lean, math.atan(run.parameters.friction / normal))


def _in_hole(run: Trajectory, tilt: str) -> Cause:
    """Return the cause for which an aligned run has not gone in."""
    why = REASON_TEXT[run.reason]
    if run.outcome == Outcome.CLIMBED_OUT:
        words = f"it falls in, tilted by up to {tilt}, and climbs out" + (why and f": {why}")
        return Cause(words, _HOLDS)
    if run.reason == Reason.WEDGED:
        most = math.degrees(run.parameters.clearance / run.parameters.friction)
        words = f"it wedges in the hole, tilted by {math.degrees(run.state[-1, 2]):.2g}°, where "
        words += f"clearance / friction allows {most:.2g}°"
        return Cause(words, (("friction", -1), ("clearance", 1), ("tilt_stiffness", 1)))
    if run.outcome == Outcome.JAMMED:
        words = "it is pressed too little: in the hole friction and suspension hold it"
    else:
        words = "it falls in, but has not come to depth at the horizon"
    return Cause(words, (("press_force", 1), ("friction", -1), ("tilt_stiffness", 1)))


def way_of(run: Trajectory) -> float:
    """Return the share of the way to the hole that the edge has slid along the bottom face."""
    device, (x, y, tilt) = run.parameters, run.state[:, :3].T
    arm = (device.slot_half_width - x) * np.cos(tilt) - y * np.sin(tilt)
    return float((arm[-1] - arm[0]) / (device.half_width - arm[0]))


def waits_in_vain(run: Trajectory) -> bool:
    """Return whether a longer horizon would hardly help a run that has not aligned."""
    late = run.outcome == Outcome.HORIZON_REACHED and math.isnan(run.tau_align)
    return late and (run.sticking_share >= STICKS or way_of(run) < _SOME_WAY)


def first_change(cause: Cause, nearest: Sequence[Nearest]) -> Mapping[str, float]:
    """Return the change of one parameter that makes a device reliable; empty if none does.

    It is the first of the cause's cures that does, else the parameter that has to change least.
    What the parts give, such as friction, comes last.
    """
    found = {parameter_of(each.parameter): each for each in nearest}
    for of_parts in (False, True):
        for name, direction in cause.cures:
            if name in found and (name in _OF_PARTS) == of_parts:
                end = found[name].above if direction > 0 else found[name].below
                if end is not None:
                    return {found[name].parameter: end}
        ends = [(each, end) for name, each in found.items() if (name in _OF_PARTS) == of_parts
                for end in (each.below, each.above) if end is not None]  # fmt: skip
        if ends:
            each, end = min(ends, key=_steps)
            return {each.parameter: end}
    return {}


def _steps(change: tuple[Nearest, float]) -> float:
    """Return the size of a change, in steps of a scan."""
    return abs(steps_between(change[0].parameter, change[0].value, change[1]))
