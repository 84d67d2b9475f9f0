"""Amounts as text: a number with a unit and a tolerance, such as ``0.8 mm ± 0.1 mm``.

A bare number is in SI units. ``±`` (or ``+-``) states the half-width of a uniform distribution,
``σ`` (or ``sigma``) the standard deviation of a normal one. A tolerance in per cent is a share of
the value. pint reads the units, after ``spelling`` has replaced what it does not know; frequencies
may be in revolutions or radians per time. An amplitude is the peak of the vibration, also stated
from peak to peak, as rms, or as the velocity or acceleration (5 g) that it has at the frequency.
"""

import math
import numbers
import re
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from model.physics.parameters import FIELDS
from vibralign.device.spelling import AMBIGUOUS, NUMBER, ends_of, is_grouped, peak, plain, spelled

_AMOUNT = re.compile(rf"\s*({NUMBER})\s*(.*?)\s*")
_SPREAD = re.compile(r"\s*(±|\+/-|\+-|σ|sigma\b)\s*")
_BRACKETS = re.compile(rf"\((.+)({_SPREAD.pattern}.+)\)(.*)")  # (12 ± 3) N
_UNIT = re.compile(r"(?:1?\s*/\s*)?[^\W\d_][^,]*|°.*|%")  # pint reads ", 1 N" as a unit, too
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

    @property
    def sign(self) -> str:
        """Sign by which a file states it."""
        return "±" if self.kind == "uniform" else "σ"

    def around(self, value: float) -> float:
        """Return the width around ``value``, in SI units."""
        return self.width * abs(value) if self.relative else self.width

    def end(self, value: float) -> float:
        """Return the deviation from ``value`` that counts as its end, in SI units."""
        return self.around(value) * (1.0 if self.kind == "uniform" else SIGMAS)


@dataclass(frozen=True)
class Amount:
    """A value in SI units, with its tolerance if one is stated.

    Attributes:
        value: in SI units.
        tolerance: None if none is stated.
        unit: the unit in which it is stated, such as "mm p-p"; empty for a bare number.
        one: size of that unit in SI units.
    """

    value: float
    tolerance: Tolerance | None = None
    unit: str = ""
    one: float = 1.0


def read_amount(name: str, given: object, unit: str, frequency: float | None = None) -> Amount:
    """Read the amount of the quantity ``name``, whose SI unit is ``unit``.

    An amplitude that is stated as a velocity or acceleration needs the ``frequency`` in Hz.

    Raises:
        ValueError: no number, an unknown unit, a unit of another quantity, or a tolerance < 0.
    """
    if not isinstance(given, str):
        return Amount(_bare(name, given, unit))
    reader, text = _reader(name, given, unit, frequency)
    value, *spread = _SPREAD.split(_BRACKETS.sub(r"\1\4\2\4", text), maxsplit=1)
    if not spread:
        if ends := ends_of(text):
            low, high = reader.ends(ends)
            middle, half = f"{0.5 * (low + high):.6g}", f"{0.5 * (high - low):.6g}"
            raise reader.refusal(
                f"is a range; state one value, or {f'{middle} ± {half} {unit}'.removesuffix(' 1')} "
                "if it varies from part to part; if nobody has measured it, write "
                f"`unknown: {{{name}: {given}}}`; if it may be chosen, put it below `free:`"
            )
        return reader.amount(value)
    sign, width = spread
    if not (value and width):
        raise reader.refusal(f"a number must stand before and after {sign}, or leave {sign} out")
    kind: Literal["uniform", "normal"] = "uniform" if sign in ("±", "+/-", "+-") else "normal"
    if width.endswith("%") and "%" not in value:
        amount, share = reader.amount(value), read_amount(f"{name}'s width", width, "1").value
        if unit == "1" and 100.0 * share <= amount.value:
            raise reader.refusal(
                f"is the value in per cent, too? Write {value.strip()} % {sign} {width}, or "
                f"{value.strip()} {sign} {amount.value * share:.4g}"
            )
        tolerance = Tolerance(kind, share, relative=True)
    else:
        amount = reader.amount(value, _unit_of(width))
        tolerance = Tolerance(kind, reader.amount(width, _unit_of(value)).value)
    if not 0.0 <= tolerance.width < math.inf:
        raise reader.refusal("the tolerance must be >= 0")
    return Amount(amount.value, tolerance if tolerance.width else None, amount.unit, amount.one)


def read_exact(name: str, given: object, unit: str, frequency: float | None = None) -> Amount:
    """Read an amount that has no tolerance; arguments as for ``read_amount``.

    Raises:
        ValueError: as ``read_amount``, or it has a tolerance.
    """
    amount = read_amount(name, given, unit, frequency)
    if amount.tolerance is not None:
        raise ValueError(f"{name} = {given!r}: no tolerance here, {_rule(unit)}")
    return amount


def read_positive(name: str, given: object, unit: str, words: str = "") -> float:
    """Return the value of an amount > 0 without a tolerance, such as a limit, in SI units.

    ``words`` are its meaning.

    Raises:
        ValueError: as ``read_exact``, or it is not > 0 and finite.
    """
    value = read_exact(name, given, unit).value
    if not 0.0 < value < math.inf:
        raise ValueError(f"{name} = {given!r}: must be a finite number > 0{words and f', {words}'}")
    return value


def read_range(
    name: str, given: object, unit: str, frequency: float | None = None
) -> tuple[float, float]:
    """Read a range such as ``2 to 30 N`` or ``2–30 N``; the unit may stand at the second end only.

    ``frequency`` is that of ``read_amount``.

    Raises:
        ValueError: not two amounts, or the second not above the first.
    """
    reader, text = _reader(name, given if isinstance(given, str) else "", unit, frequency)
    if not (ends := ends_of(text)):
        example = "2 to 30" if unit == "1" else f"2 to 30 {unit}"
        raise ValueError(f"{name} = {given!r}: must be a range such as {example}")
    low, high = reader.ends(ends)
    if not low < high:
        raise reader.refusal("must rise from the first value to the second")
    return low, high


def read_values(name: str, given: Any, unit: str, points: int) -> NDArray[np.float64]:
    """Read values in one of three forms: a range in a text, a list, or one value.

    Returns:
        ``points`` equidistant values of the range, or those of the list, shape (n,); the one value,
        shape ().

    Raises:
        ValueError: as ``read_exact`` and ``read_range``, or a list that is empty, has a value twice
            or one that is masked.
    """
    if isinstance(given, str) and ends_of(plain(given)):
        steps = np.linspace(*read_range(name, given, unit), points)
        return np.array([float(f"{each:.12g}") for each in steps])  # decimal steps are decimals
    if hasattr(given, "magnitude"):  # of a library of units, which an array would drop
        raise ValueError(f"{name} = {given}: give numbers in {unit}, or texts such as '1 {unit}'")
    if np.ma.is_masked(given):
        raise ValueError(f"{name} = {given}: has masked values; leave them out")
    listed = given if isinstance(given, str) else np.asarray(given, dtype=object).tolist()
    each = listed if isinstance(listed, list) else [listed]
    values = [read_exact(name, one, unit).value for one in each]
    if not values or len({*values}) < len(values):
        raise ValueError(f"{name} = {given!r}: must be distinct values, at least one")
    return np.array(values if isinstance(listed, list) else values[0])


def _rule(unit: str) -> str:
    units = "" if unit == "1" else f" in {unit}, or with a unit"
    return f"must be a number{units}"


def _bare(name: str, given: object, unit: str) -> float:
    """Return a value that is not a text as a number."""
    if given is None:
        raise ValueError(f"{name} is not filled in: {_rule(unit)}")
    if isinstance(given, np.ndarray) and not given.ndim and not np.ma.is_masked(given):
        given = given.item()
    if not isinstance(given, numbers.Real) or isinstance(given, bool):
        words = "is masked" if np.ma.is_masked(given) else _rule(unit)
        raise ValueError(f"{name} = {given!r}: {words}")  # noqa: TRY004  (of a file)
    _check_play(name, given, float(given))
    return float(given)


def _check_play(name: str, given: object, value: float) -> None:
    """Refuse a clearance, or an end of its range, that leaves the hole no wider than the part."""
    if name in ("clearance", "play") and value <= 0.0:
        raise ValueError(
            f"{name} = {given!r}: no play or an interference (a transition fit) is not modelled: "
            "the hole must be wider than the part. State the smallest clearance > 0 of the pairs "
            "that have play, (hole - peg) / peg, and count the others as not going in"
        )


def _meaning(name: str) -> str:
    if name == "clearance":
        return "; a length is the play: write play: 0.05 mm, of the diameters"
    return f"; it is the {FIELDS[name].description}" if name in FIELDS else ""


def _unit_of(text: str) -> str:
    match = _AMOUNT.fullmatch(text)
    return match[2] if match else ""


def _reader(name: str, given: str, unit: str, frequency: float | None) -> "tuple[_Reader, str]":
    """Return what reads the parts of a text, and the text with plain signs and without "p-p"."""
    text, words, factor = plain(given), "", 1.0
    if name.endswith("amplitude"):
        try:
            text, words, factor = peak(text)
        except ValueError as two:
            raise ValueError(f"{name} = {given!r}: {two}") from None
    return _Reader(name, given, unit, words, factor, frequency), text


@dataclass(frozen=True)
class _Reader:
    """Reader of the parts of the text ``given``, which its refusals quote.

    Attributes:
        words: such as "p-p" beside an amplitude.
        factor: from the height of a vibration to its peak.
    """

    name: str
    given: str
    unit: str
    words: str = ""
    factor: float = 1.0
    frequency: float | None = None

    def refusal(self, words: str) -> ValueError:
        """Return the refusal of the text."""
        return ValueError(f"{self.name} = {self.given!r}: {words}")

    def amount(self, text: str, usual: str = "") -> Amount:
        """Return the amount of a number; ``usual`` is the unit of one that states none."""
        match = _AMOUNT.fullmatch(text)
        if match is None:
            raise self.refusal(_rule(self.unit))
        value, own = float(match[1]), match[2] or usual
        _check_play(self.name, self.given, value)
        if is_grouped(text):
            raise self.refusal(
                "write a decimal point and no other sign or space between digits: 0.15, 15000"
            )
        self._check(text, own)
        one = self.factor if own in ("", self.unit) else self._size(own)
        return Amount(
            value if one == 1.0 else value * one, None, f"{own} {self.words}".strip(), one
        )

    def ends(self, ends: list[str]) -> tuple[float, float]:
        """Return the two ends of a range."""
        high = self.amount(ends[1])
        return self.amount(ends[0], _unit_of(ends[1])).value, high.value

    def _check(self, text: str, own: str) -> None:
        """Refuse what may mean two things."""
        if re.search(r"\+\s*\d", own):
            raise self.refusal(
                "a tolerance is symmetric: write the middle of the limits ± half their distance"
            )
        for name, meant in AMBIGUOUS.items():
            texts = [re.sub(rf"(?i)\b(k?){name}\b", rf"\1{each}", text.strip()) for each in meant]
            if texts[0] != text.strip():
                words = " or ".join(meant.values())
                raise self.refusal(f"{name} is {words}: write {' or '.join(texts)}")
        if own and not _UNIT.fullmatch(own):
            raise self.refusal(f"unknown unit {own!r}; {_rule(self.unit)}")

    def _size(self, own: str) -> float:
        """Return the size of the unit ``own`` in the SI unit, of an amplitude to its peak in m."""
        if not self.name.endswith("amplitude"):
            return self._size_in(own, self.unit)
        refusals = list[ValueError]()
        for power, unit in enumerate(("m", "m/s", "m/s^2")):
            try:
                size = self.factor * self._size_in(own, unit)
            except ValueError as refusal:
                refusals.append(refusal)
                continue
            if power and not self.frequency:
                raise self.refusal(
                    f"is {'an acceleration' if power > 1 else 'a velocity'}, which gives an "
                    "amplitude at one frequency only, and frequency is no single value > 0 here: "
                    "write the amplitude in mm"
                )
            return size / (math.tau * (self.frequency or 1.0)) ** power
        raise refusals[0]

    def _size_in(self, own: str, unit: str) -> float:
        """Return the size of the unit ``own`` in ``unit``."""
        import pint  # noqa: PLC0415  (a third of a second, for files with units only)

        registry = _registry()
        try:
            one = registry.Quantity(1.0, registry.parse_units(spelled(own, unit)))
            names = one.to_root_units().units._units
            size = float(one.to("" if unit == "1" else unit).magnitude)
        except pint.DimensionalityError:
            hint = "a ratio, without a unit or in %" if unit == "1" else f"in {unit} or alike"
            words = f"must be {hint}, not in {own}{_meaning(self.name)}"
            raise self.refusal(words) from None
        except Exception:  # noqa: BLE001  (on a malformed unit pint raises errors of many kinds)
            raise self.refusal(f"unknown unit {own!r}; {_rule(unit)}") from None
        # For pint a cycle is an angle of 2π, and an angle a ratio; a frequency counts cycles.
        if ("%" in own and (unit, own) != ("1", "%")) or (unit == "1" and "radian" in names):
            raise self.refusal(f"{own} is no unit of it, {_rule(unit)}")
        return size / math.tau if unit == "Hz" and "radian" in names else size


@cache
def _registry() -> Any:
    import pint  # noqa: PLC0415  (as in _size_in)

    return pint.UnitRegistry()
