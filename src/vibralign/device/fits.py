"""Play of an ISO fit such as H7/g6, for diameters up to 50 mm.

The limits of hole and part are a fundamental deviation and a grade of tolerance (ISO 286-1:2010,
tables 1 to 5). The letters A to C, whose deviations jump within a range of sizes, are left out, and
of the holes those above H, which leave no play.
"""

import bisect
import re
from collections.abc import Mapping

_UP_TO = 3, 6, 10, 18, 30, 50  # mm, the end of a range of sizes
# Grades of tolerance by number, and deviations by letter, in µm, one for each range of sizes.
_GRADES: Mapping[int, tuple[float, ...]] = {
    4: (3, 4, 4, 5, 6, 7),
    5: (4, 5, 6, 8, 9, 11),
    6: (6, 8, 9, 11, 13, 16),
    7: (10, 12, 15, 18, 21, 25),
    8: (14, 18, 22, 27, 33, 39),
    9: (25, 30, 36, 43, 52, 62),
    10: (40, 48, 58, 70, 84, 100),
    11: (60, 75, 90, 110, 130, 160),
    12: (100, 120, 150, 180, 210, 250),
}
_UPPER: Mapping[str, tuple[float, ...]] = {  # of a part; a hole has the opposite as its lower one
    "d": (-20, -30, -40, -50, -65, -80),
    "e": (-14, -20, -25, -32, -40, -50),
    "f": (-6, -10, -13, -16, -20, -25),
    "g": (-2, -4, -5, -6, -7, -9),
    "h": (0, 0, 0, 0, 0, 0),
}
_LOWER: Mapping[str, tuple[float, ...]] = {  # of a part
    "k": (0, 1, 1, 1, 2, 2),  # grades 4 to 7, else 0
    "m": (2, 4, 6, 7, 8, 9),
    "n": (4, 8, 10, 12, 15, 17),
    "p": (6, 12, 15, 18, 22, 26),
}
_CLASS = re.compile(r"\s*([A-Za-z]{1,2})\s*(\d{1,2})\s*")
_RULE = (
    "must be the hole's tolerance class and the part's, such as H7/g6, of the letters D to H and "
    "JS for the hole, d to h, js, k, m, n, p for the part, and the grades 4 to 12; for others "
    "state play: 0.02 mm ± 0.01 mm"
)


def play_of(fit: object, diameter: float) -> tuple[float, float]:
    """Return the least and the largest play in m of a fit at a nominal diameter in m.

    Raises:
        ValueError: no fit, a letter or grade that is not in the tables, or a diameter above 50 mm.
    """
    texts = re.split(r"/|(?<=\d)[\s-]+(?=[A-Za-z])", str(fit))
    classes = [_CLASS.fullmatch(each) for each in texts]
    if len(classes) != 2:
        raise ValueError(f"fit = {fit!r}: {_RULE}")
    if not 0.0 < diameter <= 1e-3 * _UP_TO[-1]:
        raise ValueError(f"fit = {fit!r}: needs a diameter up to 50 mm; else state play")
    size = bisect.bisect_left(_UP_TO, round(1e3 * diameter, 9))
    limits = dict[str, tuple[float, float]]()
    for each in filter(None, classes):
        if found := _limits(each[1], int(each[2]), size):
            limits["hole" if each[1].isupper() else "part"] = found
    if len(limits) != 2:
        raise ValueError(f"fit = {fit!r}: {_RULE}")
    hole, part = limits["hole"], limits["part"]
    return 1e-6 * (hole[0] - part[1]), 1e-6 * (hole[1] - part[0])


def _limits(letters: str, grade: int, size: int) -> tuple[float, float] | None:
    """Return the lower and the upper deviation of a tolerance class in µm, None if unknown."""
    width = _GRADES[grade][size] if grade in _GRADES else None
    if width is None:
        return None
    if letters in {"JS", "js"}:
        return -0.5 * width, 0.5 * width
    if letters in _UPPER:
        return _UPPER[letters][size] - width, _UPPER[letters][size]
    if letters.isupper() and letters.lower() in _UPPER:
        return -_UPPER[letters.lower()][size], width - _UPPER[letters.lower()][size]
    if letters in _LOWER:
        low = 0.0 if letters == "k" and not 4 <= grade <= 7 else _LOWER[letters][size]
        return low, low + width
    return None
