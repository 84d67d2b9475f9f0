"""Approaches: how a robot brings the part onto the base, as a device file states it.

``approach_speed`` is the speed at which the holder is lowered until it presses, and ``vibrator``
says if it vibrates meanwhile. What a file does not state is tried, as a base is (answers/cases.py).
``approach_speed: sudden`` lets press and vibration set in at once, as in the paper.
"""

from collections.abc import Mapping
from typing import Any, Literal, NamedTuple, get_args

from model.physics.approach import Start
from model.physics.parameters import check_name

SPEED = "approach_speed"
SUDDEN = "sudden"
Vibrator = Literal["running", "still"]
"""Vibrator during the approach: it runs, or it sets in when the pressed part has come to rest."""
TRIED = (0.1, 0.03, 0.01, 0.003)  # m/s, tried where no speed is stated
USUAL = 0.01  # m/s, at which one run is made, and at which a still holder is lowered


class Approach(NamedTuple):
    """Approach of a holder: state of the vibrator, and the speed in m/s, None if it varies."""

    vibrator: Vibrator
    speed: float | None

    def __str__(self) -> str:
        words = "running" if self.vibrator == "running" else "still until pressed and at rest"
        return words if self.speed is None else f"{words}, {1e3 * self.speed:.4g} mm/s"


def approaches_to_try(
    speed: float | None, vibrator: Vibrator | None, *, varies: bool
) -> tuple[Approach, ...]:
    """Return the approaches that a device meets; the one that a single run takes comes first.

    ``speed`` in m/s and ``vibrator`` are None where they are not stated; where the speed ``varies``
    the approaches have none.
    """
    if vibrator is None:
        still = (speed or USUAL,)
        return (*approaches_to_try(speed, "running", varies=varies),
                *(Approach("still", None if varies else each) for each in still))  # fmt: skip
    if varies:
        return (Approach(vibrator, None),)
    speeds = sorted(TRIED, key=lambda each: each != USUAL) if speed is None else (speed,)
    return tuple(Approach(vibrator, each) for each in speeds)


def with_changes(stated: Mapping[str, Any], changes: Mapping[str, object]) -> dict[str, Any]:
    """Return the entries that state a start, changed: a start made sudden loses its vibrator."""
    left = {"vibrator"} if changes.get(SPEED) == SUDDEN else set()
    return {name: each for name, each in stated.items() if name not in left} | dict(changes)


def read_start(mapping: Mapping[str, Any]) -> tuple[Vibrator | None, bool]:
    """Return what a file says of its vibrator, and whether its start is sudden.

    Raises:
        ValueError: an old start, with what to write instead; or a vibrator of a sudden start.
    """
    if "start" in mapping:
        check_name(str(mapping["start"]), get_args(Start), "start")
        instead = {
            "simultaneous": f"{SPEED}: {SUDDEN}",
            "pressed": f"vibrator: still, and {SPEED}: 3 mm/s for a slow press",
        }.get(str(mapping["start"]), f"vibrator: {mapping['start']}, and {SPEED}")
        raise ValueError(f"start: {mapping['start']}: is no longer stated: write {instead}")
    sudden, vibrator = mapping.get(SPEED) == SUDDEN, mapping.get("vibrator")
    if vibrator is not None:
        check_name(str(vibrator), get_args(Vibrator), "vibrator")
        if sudden:
            raise ValueError(f"vibrator: {vibrator}: has no effect with {SPEED}: {SUDDEN}")
    return vibrator, sudden
