"""Spellings of engineers for numbers, units and ranges, turned into those that pint reads."""

import math
import re

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_SIGNS = str.maketrans("\u2212\u00a0\u2009\u202f", "-   ")  # minus sign, narrow spaces
_GROUPED = re.compile(r"(?<![\d.,])[1-9]\d{0,2}(?:[ ,'’_]\d{3})+(?![\d.]*,)(?!\d)")
_COMMA = re.compile(r"(?<=\d),(?=\d)")
_RANGES = (r"\s+to\s+", r"\s*(?:[–—…]|\.{2,3})\s*", r"\s+-\s+|(?<=\d)-(?=\d)")
_LETTER = "[A-Za-zµμ]"
# Names run together: a force or a mass, then a length, then a time.
_TOGETHER = re.compile(r"([kMmuµμ]?N|k?g)([mcuµμ]?m)?(m?s)?")
# Names that have the same meaning in upper and lower case.
_CASES = {name.casefold(): name for name in ("Hz", "kHz", "kg", "kN", "rpm", "rad", "deg")}
_FORCES = {"lb": "lbf", "lbs": "lbf", "oz": "ozf"}  # where the quantity has newtons in its unit
# Names of a turn and of turns a minute, where the quantity is a frequency.
_TURNS = {**dict.fromkeys(("rev", "revs", "r", "u", "tr"), "turn"), "cpm": "turn / minute"}
_GRAVITY = "g", "gn"  # where the quantity is an acceleration
# Words beside the height of a vibration, and the factor from it to the peak.
_END = r"(?:pk|peak|p)"
_HEIGHTS = {
    rf"{_END}[-–. ]*(?:to|t|2)?[-–. ]*{_END}\.?": 0.5,
    rf"(?:0|zero)[- ]?(?:to)?[- ]?{_END}|pk|peak|(?<=[\s(])p": 1.0,
    r"rms|r\.m\.s\.|eff": math.sqrt(2.0),
}


def plain(text: str) -> str:
    """Return ``text`` with ASCII signs and spaces."""
    return text.translate(_SIGNS)


def clearer(text: str) -> str | None:
    """Return what to write in place of a number with a comma or grouped digits; None for others."""
    grouped = _GROUPED.search(text)
    if grouped:
        whole = _GROUPED.sub(re.sub(r"\D", "", grouped[0]), text).strip()
        if re.fullmatch(r"\d+,\d+", grouped[0]) and text[grouped.end() :][:1] != ".":
            decimal = _COMMA.sub(".", text).strip()
            return f"{whole} if the comma groups thousands, {decimal} if it is decimal"
        return whole
    if _COMMA.search(text):
        return _COMMA.sub(".", re.sub(r"(?<=\d)\.(?=\d+[.,])", "", text)).strip()
    return None


def peak(text: str) -> tuple[str, float]:
    """Return the height of a vibration without "p-p", "rms" and the like, and its factor to peak.

    Raises:
        ValueError: it says two different ones.
    """
    factors = set()
    for words, factor in _HEIGHTS.items():
        found = re.compile(rf"(?<=[^\W_])[\s_-]*\(?(?:{words})\)?(?!\w)", re.IGNORECASE)
        text, count = found.subn("", text)
        factors |= {factor} if count else set()
    if len(factors) > 1:
        raise ValueError("states two of peak, peak-to-peak and rms: write one")
    return text, factors.pop() if factors else 1.0


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
    own = re.sub(rf"(?<={_LETTER})-(?={_LETTER})", " ", own.replace("r.p.m.", "rpm"))  # N-m
    own = re.sub(r"^\s*/", "1 / ", own)  # /min
    own = re.sub(rf"{_LETTER}+", lambda match: _name(match[0], unit), own)
    return re.sub(rf"(?<={_LETTER})(-?\d)(?!\d)", r"**\1", own)  # cm2, m-1


def _name(name: str, unit: str) -> str:
    """Return one name of a unit as pint spells it."""
    if name in {"mil", "mils"} and unit == "m":  # for pint an angle
        return "thou"
    if "N" in unit and name in _FORCES:
        return _FORCES[name]
    if unit == "Hz" and name.lower() in _TURNS:
        return _TURNS[name.lower()]
    if unit == "m/s^2" and name.lower() in _GRAVITY:
        return "standard_gravity"
    if together := _TOGETHER.fullmatch(name):  # for pint Nm is a fineness of yarn
        return " ".join(filter(None, together.groups()))
    return name.lower() if len(name) > 4 else _CASES.get(name.casefold(), name)
