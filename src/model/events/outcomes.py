"""Outcomes of runs, their reasons, and their remedies."""

from enum import IntEnum
from typing import Any

from model.physics.tables import numbers


class Named(IntEnum):
    """Numbers that print as their names: ``f"{Outcome.ALIGNED}"`` is "aligned"."""

    def __str__(self) -> str:
        return self.name.lower()

    def __format__(self, spec: str) -> str:
        return format(int(self) if spec.endswith("d") else str(self), spec)


class Outcome(Named):
    """Outcome of a run; the values are the flags stored in datasets."""

    ALIGNED = 0
    SETTLED = 1
    LEFT_SCENE = 2
    HORIZON_REACHED = 3
    FAILED = 4
    INSERTED = 5
    JAMMED = 6
    CLIMBED_OUT = 7


class InsertionOutcome(Named):
    """End of an aligned run in the insertion scene, as in ``Outcome``; NOT_ALIGNED: not run."""

    NOT_ALIGNED = -1
    HORIZON_REACHED = Outcome.HORIZON_REACHED
    FAILED = Outcome.FAILED
    INSERTED = Outcome.INSERTED
    JAMMED = Outcome.JAMMED
    CLIMBED_OUT = Outcome.CLIMBED_OUT


class Unvibrated(Named):
    """End of the unvibrated control; the values are the flags stored in datasets."""

    ALIGNS = 0
    RESTS = 1
    LEAVES = 2


class Reason(Named):
    """Reason of an outcome; NONE where the outcome says it all."""

    NONE = 0
    MOVED_AWAY = 1
    OVERSHOT = 2
    CORNER_ON_WALL = 3
    EDGE_ON_OTHER_FACE = 4
    BOTH_SIDES = 5
    OVERTURNED = 6
    UNDECLARED_CONTACT = 7
    IMPOSSIBLE_START = 8
    STEP_TOO_SMALL = 9
    TOO_MANY_EVALUATIONS = 10
    CHATTER = 11
    NOT_FINITE = 12
    NO_FRICTION_SOLUTION = 13
    CHAOTIC = 14
    NO_REST = 15
    WEDGED = 16
    LACK_OF_FORCE = 17
    ON_EDGE = 18
    BY_PRESS = 19
    NO_TOUCH = 20
    STILL_MOVES = 21
    ON_FLANK = 22


OUTCOME: Any = numbers("OUTCOME", [*Outcome.__members__])(*map(int, Outcome))
REASON: Any = numbers("REASON", [*Reason.__members__])(*map(int, Reason))
"""``Outcome`` and ``Reason`` as plain integers by name, for kernels."""

OUTCOME_TEXT: dict[Outcome, str] = {
    Outcome.ALIGNED: "the part fell into the slot",
    Outcome.SETTLED: "the motion repeats itself without aligning",
    Outcome.LEFT_SCENE: "the part left the scene that the model describes",
    Outcome.HORIZON_REACHED: "the part did not align within the horizon",
    Outcome.FAILED: "the run could not be finished",
    Outcome.INSERTED: "the part went into the slot",
    Outcome.JAMMED: "the part fell into the slot and stays there, not inserted",
    Outcome.CLIMBED_OUT: "the part fell into the slot and came out of it again",
}

SUCCESS_TEXT: dict[Outcome, str] = {Outcome.ALIGNED: "aligns", Outcome.INSERTED: "goes in"}
SUCCESSES = tuple(SUCCESS_TEXT)
"""Outcomes of a run in which the part goes in."""

REASON_TEXT: dict[Reason, str] = {
    Reason.NONE: "",
    Reason.MOVED_AWAY: "it slid off the slot's edge, away from the slot",
    Reason.OVERSHOT: "it jumped over the slot and passed the far edge",
    Reason.CORNER_ON_WALL: "a bottom corner ran against a wall of the slot from inside",
    Reason.EDGE_ON_OTHER_FACE: "an edge met a face on which the scene has no contact",
    Reason.BOTH_SIDES: "the part stood on both sides of the slot at once",
    Reason.OVERTURNED: "the tilt reached 90 degrees",
    Reason.UNDECLARED_CONTACT: "it reached a contact that the scene does not declare",
    Reason.IMPOSSIBLE_START: "the start has the part inside the base, or not on the edge",
    Reason.STEP_TOO_SMALL: "the step size fell below the resolution of time",
    Reason.TOO_MANY_EVALUATIONS: "the limit of right-hand-side evaluations was reached",
    Reason.CHATTER: "two modes alternate without time passing",
    Reason.NOT_FINITE: "the state is no longer finite",
    Reason.NO_FRICTION_SOLUTION: "no friction force satisfies this reading's friction law",
    Reason.WEDGED: "it is wedged: friction holds it between two points without any outer force",
    Reason.LACK_OF_FORCE: "the press is too weak against friction and suspension",
    Reason.ON_EDGE: "an edge of the slot carries it",
    Reason.CHAOTIC: "its motion is chaotic, and whether it ever aligns is chance: another "
    "tolerance may answer otherwise",
    Reason.NO_REST: "pressed slowly it does not come to rest on the edge: it topples or slides off "
    "before the vibration sets in",
    Reason.STILL_MOVES: "pressed without vibration it has not come to rest within the horizon",
    Reason.NO_TOUCH: "the press does not bring it down to the base within the horizon",
    Reason.BY_PRESS: "by the press alone: no vibration needed",
    Reason.ON_FLANK: "it is tilted so far, or so far aside, that it meets a flank of the chamfers: "
    "that is not modelled",
}

UNVIBRATED_TEXT: dict[Unvibrated, str] = {
    Unvibrated.ALIGNS: "aligns all the same",
    Unvibrated.RESTS: "rests on the edge",
    Unvibrated.LEAVES: "does not come to rest on the edge within the horizon",
}

_USUAL = "amplitude, press_force, tilt_stiffness or frequency"  # what is changed first

_REMEDY_OF_OUTCOME: dict[Outcome, str] = {
    Outcome.ALIGNED: "none needed",
    Outcome.SETTLED: f"change {_USUAL}: a longer horizon changes nothing",
    Outcome.LEFT_SCENE: "lower press_force or raise tilt_stiffness so that the part stays on the "
    "edge",
    Outcome.HORIZON_REACHED: f"raise the horizon, or change {_USUAL}",
    Outcome.INSERTED: "none needed",
    Outcome.JAMMED: "raise press_force, or lower friction",
    Outcome.CLIMBED_OUT: "lower press_force or raise tilt_stiffness and tilt_damping, so that the "
    "part falls in upright and slowly",
    Outcome.FAILED: "loosen the tolerance, or change what is extreme among the parameters",
}

_REMEDY_OF_REASON: dict[Reason, str] = {
    Reason.WEDGED: "lower friction, raise clearance, or raise tilt_stiffness so that the tilt "
    "stays below clearance / friction: a higher press_force changes nothing",
    Reason.LACK_OF_FORCE: "raise press_force, lower friction, or accept a smaller insertion_depth",
    Reason.UNDECLARED_CONTACT: "declare the contact in the scene",
    Reason.IMPOSSIBLE_START: "lower initial_tilt or raise clearance",
    Reason.TOO_MANY_EVALUATIONS: "raise max_evaluations, or lower contact_stiffness or the horizon",
    Reason.CHATTER: "change the tolerance; report the parameters if it stays",
    Reason.CHAOTIC: f"change {_USUAL}: a longer horizon leaves it to chance",
    Reason.NO_REST: "lower press_force, or raise tilt_stiffness or friction, so that it rests; or "
    "start = 'simultaneous'",
    Reason.STILL_MOVES: "raise the damping of the suspension, or the horizon",
    Reason.NO_TOUCH: "raise press_force",
    Reason.BY_PRESS: "none needed",
    Reason.ON_FLANK: "widen the chamfers, or raise tilt_stiffness so that it tilts less",
    Reason.NO_FRICTION_SOLUTION: "use the consistent readings normal_sign and side_force, under "
    "which friction always has a solution",
}


def remedy(outcome: Outcome, reason: Reason) -> str:
    """Return what the user can do about a run with this outcome and reason."""
    return _REMEDY_OF_REASON.get(reason, _REMEDY_OF_OUTCOME[outcome])
