"""Amounts as text: a number with a unit and a tolerance, such as ``0.8 mm ± 0.1 mm``.

A bare number is in SI units. ``±`` (or ``+-``) states the half-width of a uniform distribution,
``σ`` (or ``sigma``) the standard deviation of a normal one. A tolerance in per cent is a share of
the value. pint reads the units, ``spelling`` what pint does not know; frequencies may also be in
revolutions or radians per time. An amplitude is the peak of the vibration; it may be stated from
peak to peak, as rms, or as the velocity or acceleration (5 g) that it has at the frequency.
"""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from model.physics.parameters import FIELDS
from vibralign.device.spelling import NUMBER, clearer, ends_of, peak, plain, spelled

_AMOUNT = re.compile(rf"\s*({NUMBER})\s*(.*?)\s*")
_SPREAD = re.compile(r"\s*(±|\+/-|\+-|σ|sigma\b)\s*")
_BRACKETS = re.compile(rf"\((.+)({_SPREAD.pattern}.+)\)(.*)")  # (12 ± 3) N
_QUOTIENT = re.compile(rf"(.*?)/\s*({NUMBER})\s*(.*?)\s*")  # 0.05 mm / 6 mm
_UNIT = re.compile(r"(?:1?\s*/\s*)?[^\W\d_][^,]*|°.*|%")  # pint reads ", 1 N" as a unit, too
_Read = TypeVar("_Read")
SIGMAS = 3.0  # standard deviations that count as the end of a normal tolerance


@dataclass(frozen=True)
class Tolerance:
    """Tolerance of one quantity.

    Attributes:
        kind: "uniform" within ± ``width``, or "normal" with the standard deviation ``width``.
        width: >= 0, in SI units, or as a share of the value if ``relative``.
        relative: True if the width is proportional to the value.
    """

    kind: Literal["uniform", "normal"]
    width: float
    relative: bool = False

    def around(self, value: float) -> float:
        """Return the width around ``value``, in SI units."""
        return self.width * abs(value) if self.relative else self.width

    def end(self, value: float) -> float:
        """Return the deviation from ``value`` that counts as its end, in SI units."""
        return self.around(value) * (1.0 if self.kind == "uniform" else SIGMAS)


@dataclass(frozen=True)
class Amount:
    """A value in SI units, with its tolerance if one is stated."""

    value: float
    tolerance: Tolerance | None = None


def read_amount(name: str, given: object, unit: str, frequency: float | None = None) -> Amount:
    """Read the amount of the quantity ``name``, whose SI unit is ``unit``.

    An amplitude that is stated as a velocity or acceleration needs the ``frequency`` in Hz.

    Raises:
        ValueError: no number, an unknown unit, a unit of another quantity, or a tolerance < 0.
    """
    if name.endswith("amplitude") and isinstance(given, str):
        amount, factor = _to_peak(_read_amount, name, given, frequency)
        tolerance = amount.tolerance
        if tolerance is not None and not tolerance.relative:
            tolerance = replace(tolerance, width=tolerance.width * factor)
        return Amount(amount.value * factor, tolerance)
    return _read_amount(name, given, unit)


def _read_amount(name: str, given: object, unit: str) -> Amount:
    if given is None:
        raise ValueError(f"{name} is not filled in: {_rule(unit)}")
    _check_play(name, given, plain(str(given)))
    if isinstance(given, (int, float)) and not isinstance(given, bool):
        return Amount(float(given))
    if not isinstance(given, str):
        raise ValueError(f"{name} = {given!r}: {_rule(unit)}")  # noqa: TRY004  (of a file)
    written = _BRACKETS.sub(r"\1\4\2\4", plain(given))
    text, *spread = _SPREAD.split(written, maxsplit=1)
    if not spread:
        if ends_of(written):
            raise ValueError(
                f"{name} = {given!r}: is a range; state one value, or a value ± its tolerance "
                "(ranges stand below free:)"
            )
        return Amount(_number(name, given, text, unit))
    sign, width = spread
    value, tolerance = _with_tolerance(name, given, text, sign, width, unit)
    if not 0.0 <= tolerance.width < math.inf:
        raise ValueError(f"{name} = {given!r}: the tolerance must be >= 0")
    return Amount(value, tolerance if tolerance.width > 0.0 else None)


def _check_play(name: str, given: object, text: str) -> None:
    """Refuse a clearance, or an end of its range, with which the hole is not the wider."""
    stated = _AMOUNT.fullmatch(text) if name == "clearance" else None
    if stated and float(stated[1]) <= 0.0 and not stated[2].startswith(","):  # 0,1 is refused later
        raise ValueError(
            f"{name} = {given!r}: no play or an interference (a transition fit) is not modelled: "
            "the hole must be wider than the part. State the smallest clearance > 0 of the pairs "
            "that have play, (hole - peg) / peg, and count the others as not going in"
        )


def _with_tolerance(
    name: str, given: str, text: str, sign: str, width: str, unit: str
) -> tuple[float, Tolerance]:
    """Return the value in ``text``, and the tolerance of this ``width`` around it."""
    kind: Literal["uniform", "normal"] = "uniform" if sign in ("±", "+/-", "+-") else "normal"
    if not width.strip().endswith("%") or "%" in text:
        suffix = _unit_of(width)
        value = _number(name, given, text if _unit_of(text) else f"{text} {suffix}", unit)
        width = width if suffix else f"{width} {_unit_of(text)}"
        return value, Tolerance(kind, _number(name, given, width, unit))
    value, share = _number(name, given, text, unit), _number(name, given, width, "1")
    if unit == "1" and 100.0 * share <= value:
        raise ValueError(
            f"{name} = {given!r}: is the value in per cent, too? Write {text.strip()} % {sign} "
            f"{width.strip()}, or {text.strip()} {sign} {value * share:.4g}"
        )
    return value, Tolerance(kind, share, relative=True)


def read_range(
    name: str, given: object, unit: str, frequency: float | None = None
) -> tuple[float, float]:
    """Read a range such as ``2 to 30 N`` or ``2–30 N``; the unit may stand at the second end only.

    ``frequency`` is that of ``read_amount``.

    Raises:
        ValueError: not two amounts, or the second not above the first.
    """
    if name.endswith("amplitude") and isinstance(given, str):
        (low, high), factor = _to_peak(_read_range, name, given, frequency)
        return low * factor, high * factor
    return _read_range(name, given, unit)


def _to_peak(
    read: Callable[[str, str, str], _Read], name: str, given: str, frequency: float | None
) -> tuple[_Read, float]:
    """Read an amplitude, velocity or acceleration; return it and its factor to the peak in m."""
    if instead := clearer(plain(given)):
        raise ValueError(f"{name} = {given!r}: write {instead}")
    try:
        text, factor = peak(plain(given))
    except ValueError as two:
        raise ValueError(f"{name} = {given!r}: {two}") from None
    refusals = []
    for power, unit in enumerate(("m", "m/s", "m/s^2")):
        try:
            found = read(name, text, unit)
        except ValueError as refusal:
            refusals.append(refusal)
            continue
        if power and not frequency:
            raise ValueError(
                f"{name} = {given!r}: is {'an acceleration' if power > 1 else 'a velocity'}, which "
                "gives an amplitude at one frequency only, and frequency is no single value > 0 "
                "here: write the amplitude in mm"
            )
        return found, factor / (math.tau * (frequency or 1.0)) ** power
    raise refusals[0]


def _read_range(name: str, given: object, unit: str) -> tuple[float, float]:
    ends = ends_of(plain(given)) if isinstance(given, str) else []
    if not ends:
        example = "2 to 30" if unit == "1" else f"2 to 30 {unit}"
        raise ValueError(f"{name} = {given!r}: must be a range such as {example}")
    _check_play(name, given, ends[0])
    high = _number(name, given, ends[1], unit)
    suffix = "" if _unit_of(ends[0]) else _unit_of(ends[1])
    low = _number(name, given, f"{ends[0]} {suffix}", unit)
    if not low < high:
        raise ValueError(f"{name} = {given!r}: must rise from the first value to the second")
    return low, high


def read_values(name: str, given: Any, unit: str, points: int) -> NDArray[np.float64]:
    """Read values in one of three forms: a range in a text, a list, or one value.

    Returns:
        ``points`` equidistant values of the range, or those of the list, shape (n,); the one value,
        shape ().

    Raises:
        ValueError: as ``read_amount`` and ``read_range``, a value with a tolerance, or a list that
            is empty or has a value twice.
    """
    if isinstance(given, str) and ends_of(plain(given)):
        steps = np.linspace(*read_range(name, given, unit), points)
        return np.array([float(f"{each:.12g}") for each in steps])  # decimal steps are decimals
    if hasattr(given, "magnitude"):  # of a library of units, which an array would drop
        raise ValueError(f"{name} = {given}: give numbers in {unit}, or texts such as '1 {unit}'")
    listed = given if isinstance(given, str) else np.asarray(given, dtype=object).tolist()
    each = [read_amount(name, v, unit) for v in (listed if isinstance(listed, list) else [listed])]
    if any(one.tolerance for one in each):
        raise ValueError(f"{name} = {given!r}: no tolerance here, {_rule(unit)}")
    values = [one.value for one in each]
    if not values or len({*values}) < len(values):
        raise ValueError(f"{name} = {given!r}: must be distinct values, at least one")
    return np.array(values if isinstance(listed, list) else values[0])


def _rule(unit: str) -> str:
    units = "" if unit == "1" else f" in {unit}, or with a unit"
    return f"must be a number{units}"


def _meaning(name: str) -> str:
    of = ", of the radii of hole and part" if name == "clearance" else ""
    return f"; it is the {FIELDS[name].description}{of}" if name in FIELDS else ""


def _unit_of(text: str) -> str:
    match = _AMOUNT.fullmatch(text)
    return match[2] if match else ""


def _number(name: str, given: Any, text: str, unit: str) -> float:
    """Return the value of ``text``, a number with or without a unit, in ``unit``.

    The message of a refusal quotes ``given``, the whole text of which this is a part.
    """
    match = _AMOUNT.fullmatch(text)
    if match is None:
        raise ValueError(f"{name} = {given!r}: {_rule(unit)}")
    value, own = float(match[1]), match[2]
    if instead := clearer(text):
        raise ValueError(f"{name} = {given!r}: write {instead}")
    if re.search(r"\+\s*\d", own):
        raise ValueError(
            f"{name} = {given!r}: a tolerance is symmetric: write the middle of the limits ± half "
            "their distance"
        )
    if unit == "1" and (two := _QUOTIENT.fullmatch(text)) and float(two[2]):
        ratio = _number(name, given, two[1], two[3] or "1") / float(two[2])
        raise ValueError(
            f"{name} = {given!r}: write the ratio, {ratio:.4g} or {100.0 * ratio:.4g} %"
            f"{_meaning(name)}"
        )
    gram, grain = (re.sub(r"(?i)\b(k?)gr\b", rf"\1{each}", text.strip()) for each in ("g", "grain"))
    if gram != text.strip():
        raise ValueError(f"{name} = {given!r}: gr is gram or grain: write {gram} or {grain}")
    if own and not _UNIT.fullmatch(own):
        raise ValueError(f"{name} = {given!r}: unknown unit {own!r}; {_rule(unit)}")
    return value if own in ("", unit) else value * _factor(name, given, own, unit)


def _factor(name: str, given: Any, own: str, unit: str) -> float:
    """Return the size of the unit ``own`` in the SI unit ``unit``."""
    import pint  # noqa: PLC0415  (a third of a second, for files with units only)

    registry = _registry()
    try:
        one = registry.Quantity(1.0, registry.parse_units(spelled(own, unit)))
        # For pint a cycle is an angle of 2π; a frequency counts it as 1.
        turning = unit == "Hz" and "radian" in one.to_root_units().units._units
        return float(one.to("" if unit == "1" else unit).magnitude) / (
            2.0 * math.pi if turning else 1.0
        )
    except pint.DimensionalityError:
        hint = "a ratio, without a unit or in %" if unit == "1" else f"in {unit} or alike"
        words = f"must be {hint}, not in {own}{_meaning(name)}"
        raise ValueError(f"{name} = {given!r}: {words}") from None
    except Exception:  # noqa: BLE001  (on a malformed unit pint raises errors of many kinds)
        raise ValueError(f"{name} = {given!r}: unknown unit {own!r}; {_rule(unit)}") from None


@cache
def _registry() -> Any:
    import pint  # noqa: PLC0415  (as in _factor)

    return pint.UnitRegistry()
