"""Limits of a device file in words: what the device has, and that it keeps or exceeds them."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from vibralign.answers.si import si_words
from vibralign.device.limits import LIMITS

if TYPE_CHECKING:
    from vibralign.answers.limits import LimitResult


def limit_rows(results: "Sequence[LimitResult]") -> list[tuple[str, str]]:
    """Return the row of the sheet on all limits; none without limits."""
    words = []
    for each in results:
        values = (each.exceeding, each.itself, each.drawn)
        known = [v for v in values if v is not None and not math.isnan(v)]
        exceeded = ": exceeded" if each.exceeding is not None else ""
        words.append(
            f"{each.name} {_value(each, known[0])} {_against(each)}{exceeded}"
            if known
            else f"no {each.name} is known (limit {_limit(each)})"
        )
    kept = "all kept: " if all(each.exceeding is None for each in results) else ""
    return [("limits", f"{kept}{', '.join(words)}")] if results else []


def exceeded_words(results: "Sequence[LimitResult]", *, only_drawn: bool) -> str:
    """Return words on the limits exceeded as stated, or ``only_drawn``; empty if none is."""
    words = [
        f"{each.name} ({_value(each, each.exceeding)} {_against(each)})"
        for each in results
        if each.exceeding is not None and each.only_drawn == only_drawn
    ]
    verb = "exceed" if only_drawn else "exceeds"
    return f"{verb} the limit of {' and of '.join(words)}" if words else ""


def _against(result: "LimitResult") -> str:
    exceeds = result.exceeding is not None
    if result.name == "vibration":
        return "although the file says not needed" if exceeds else "as the file allows"
    return f"{'>' if exceeds else 'of'} {_limit(result)}"


def _limit(result: "LimitResult") -> str:
    if result.name == "vibration":
        return "needed" if result.limit else "not needed"
    return si_words(result.limit, LIMITS[result.name][1])


def _value(result: "LimitResult", value: float) -> str:
    if result.name == "vibration":
        share = f"needed by {100.0 * value:.3g} %"
        return {0.0: "not needed", 1.0: "needed"}.get(value, share)
    return si_words(value, LIMITS[result.name][1])
