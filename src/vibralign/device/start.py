"""How a robot brings the part: the keys of a device file that state its start.

``approach_speed`` is the speed at which the holder is lowered, or ``sudden``: press and vibration
set in at once on a part that touches without load. ``vibrator`` is ``running`` while the holder
comes down, or ``still`` until the part rests under the press. What is held and where it touches
down stands in mouth.py.
"""

from collections.abc import Mapping
from typing import Any, get_args

from model.physics.approach import Start
from model.physics.parameters import check_name

SPEED, VIBRATOR, SUDDEN = "approach_speed", "vibrator", "sudden"
VIBRATORS = ("running", "still")
USUAL_SPEED = 10e-3  # m/s, of one run of a device that states the vibrator only

_OLD: Mapping[str, str] = {
    "simultaneous": f"{SPEED}: {SUDDEN}",
    "pressed": f"{VIBRATOR}: still, with a slow {SPEED} such as 3 mm/s",
}


def check_old_start(given: Any) -> None:
    """Refuse ``start``, of a file or of --start with a device, with what to write instead."""
    keys = f"state {SPEED}, a speed or {SUDDEN}, and {VIBRATOR}, {' or '.join(VIBRATORS)}"
    instead = f"write {_OLD[given]}" if given in _OLD else keys
    raise ValueError(f"start = {given!r}: is no key of a device: {instead}")


def start_of(given: Mapping[str, Any], usual: Start | None = None) -> Start | None:
    """Return the start that a device states, ``usual`` if it states none.

    A device that states a speed only has a vibrator that runs.

    Raises:
        ValueError: an unknown word, or a vibrator without effect.
    """
    vibrator = given.get(VIBRATOR)
    if vibrator is not None:
        check_name(str(vibrator), VIBRATORS, VIBRATOR)
    if is_sudden(given.get(SPEED)):
        if vibrator is not None:
            raise ValueError(
                f"{VIBRATOR} = {vibrator}: has no effect on {SPEED}: {SUDDEN}, where press and "
                "vibration set in at once: leave it out, or state a speed"
            )
        return "simultaneous"
    if vibrator is not None:
        return next(each for each in get_args(Start) if each == vibrator)
    return usual if given.get(SPEED) is None else "running"


def is_sudden(speed: Any) -> bool:
    """Return whether an approach speed is the word for none."""
    return isinstance(speed, str) and speed.strip() == SUDDEN


def start_words(start: Start | None) -> dict[str, str]:
    """Return what states a start in a device file, besides a speed."""
    if start == "simultaneous":
        return {SPEED: SUDDEN}
    return {} if start is None else {VIBRATOR: start}
