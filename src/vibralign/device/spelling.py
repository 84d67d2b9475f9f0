"""Spellings of engineers for numbers, units and ranges, turned into those that pint reads."""

import math
import re
from collections.abc import Mapping

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_SIGNS = str.maketrans("\u2212\u00a0\u2009\u202f", "-   ")  # minus sign, narrow spaces
_GROUPED = re.compile(r"\d[,'’_ ]+\d")  # 0,1 and 15,000 and 15 000
_RANGES = (r"\s+to\s+", r"\s*(?:[–—…]|\.{2,3})\s*", r"\s+-\s+|(?<=\d)-(?=\d)")
# Names of units with two meanings: a unit for each, and the meaning in words.
AMBIGUOUS: Mapping[str, Mapping[str, str]] = {
    "gr": {"g": "gram", "grain": "grain"},
    "grad": {"deg": "degree", "gon": "gon"},
}
_L = "[A-Za-zµμ]"
# Names run together: a force or a mass, then a length, then a time; for pint Nm is of yarn.
_TOGETHER = re.compile(rf"(?<!{_L})([kMmuµμ]?N|k?g)([mcuµμ]?m)?(m?s)?(?!{_L})")
# What engineers write, what pint reads, and a text in the SI unit of the quantities that have it.
_SPELLINGS: tuple[tuple[str, str, str], ...] = (
    (r"r\.p\.m\.", "rpm", ""),
    (r"^\s*/", "1 / ", ""),  # /min
    (r"\b[mM][iI][lL][sS]?\b", "thou", "m"),  # for pint an angle
    (r"\b(lb|oz)s?\b", r"\1f", "N"),
    (r"\b(?i:revs?|r|u|tr)\b", "turn", "Hz"),
    (r"\b(?i:cpm)\b", "turn / minute", "Hz"),
    (r"\b(?i:gn?)\b", "standard_gravity", "m/s^2"),
    (rf"(?<={_L})(-?\d)(?!\d)", r"**\1", ""),  # cm2, m-1
)
# Names that have the same meaning in upper and lower case, as have those of more than four letters.
_CASES = {name.casefold(): name for name in ("Hz", "kHz", "kg", "kN", "rpm", "rad", "deg")}
# Words beside the height of a vibration, and the factor from it to the peak.
_END = r"(?:pk|peak|p)"
_HEIGHTS = {
    rf"{_END}[-–. ]*(?:to|t|2)?[-–. ]*{_END}\.?": 0.5,
    rf"(?:0|zero)[- ]?(?:to)?[- ]?{_END}|pk|peak|(?<=[\s(])p": 1.0,
    r"rms|r\.m\.s\.|eff": math.sqrt(2.0),
}


def plain(text: str) -> str:
    """Return ``text`` with ASCII signs and spaces.

    In an ASCII locale a command line has bytes in place of its other signs.
    """
    return text.encode(errors="surrogateescape").decode(errors="replace").translate(_SIGNS)


def is_grouped(text: str) -> bool:
    """Return whether a number has a comma, or digits in groups."""
    return _GROUPED.search(text) is not None


def peak(text: str) -> tuple[str, str, float]:
    """Return a vibration's height without words such as "p-p", these words, and their factor.

    Raises:
        ValueError: there are two different such words.
    """
    found = dict[float, str]()
    for words, factor in _HEIGHTS.items():
        height = re.compile(rf"(?<=[^\W_])[\s_-]*\(?(?:{words})\)?(?!\w)", re.IGNORECASE)
        if said := height.search(text):
            found[factor] = said[0].strip(" _-()")
        text = height.sub("", text)
    if len(found) > 1:
        raise ValueError("states two of peak, peak-to-peak and rms: write one")
    factor, words = next(iter(found.items()), (1.0, ""))
    return text, words, factor


def in_per_cent(value: float) -> str:
    """Return what to write for a ratio that is too large, if it is in per cent."""
    return f"; write {value / 100.0:.4g}, or '{value:.4g} %', if it is in per cent"


def ends_of(text: str) -> list[str]:
    """Return the two ends of a range such as "2 to 30 N" or "20–150 Hz"; empty for none."""
    for separator in _RANGES:
        ends = re.split(separator, text.strip())
        if len(ends) == 2 and all(re.match(NUMBER, end) for end in ends):
            return ends
    return []


def spelled(own: str, unit: str) -> str:
    """Return the unit ``own`` as pint spells it, for a quantity whose SI unit is ``unit``."""
    own = re.sub(rf"(?<={_L})-(?={_L})", " ", own)  # N-m
    own = _TOGETHER.sub(lambda match: " ".join(filter(None, match.groups())), own)
    for pattern, replacement, only in _SPELLINGS:
        own = re.sub(pattern, replacement, own) if only in unit else own
    return re.sub(rf"{_L}+", lambda match: _cased(match[0]), own)


def _cased(name: str) -> str:
    return name.lower() if len(name) > 4 else _CASES.get(name.casefold(), name)
