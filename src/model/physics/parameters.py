"""Parameters of the device and its excitation: named, validated, frozen. All dimensionless.

``FIELDS`` is the one table of what can be set: symbol, meaning and rule of every parameter. Command
line, study configuration and datasets read it. Kernels take the flat ``Constants`` made from it.
"""

import dataclasses
import difflib
import math
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from model.physics.readings import READING_NAMES, Readings


@dataclass(frozen=True)
class Field:
    """One settable parameter: its symbol in the paper, meaning, and admissible range.

    ``derived`` says in words what ``None`` stands for, where ``None`` is admissible.
    """

    symbol: str
    description: str
    lower: float = -math.inf
    strict: bool = False
    derived: str | None = None

    @property
    def rule(self) -> str:
        """The admissible range in words."""
        if self.lower == -math.inf:
            rule = "must be a finite number"
        else:
            rule = f"must be a finite number {'>' if self.strict else '>='} {self.lower:g}"
        return f"{rule}, or None for {self.derived}" if self.derived else rule

    def admits(self, values: Any) -> Any:
        """Which of ``values``, a float or an array, keep the rule; NaN stands for None."""
        inside = values > self.lower if self.strict else values >= self.lower
        inside = inside & (abs(values) < math.inf)
        return inside | (values != values) if self.derived else inside  # noqa: PLR0124 - NaN


FIELDS: Mapping[str, Field] = {
    "half_width": Field("a", "half-width of the part", 0.0, strict=True),
    "half_height": Field("b", "half-height of the part", 0.0, strict=True),
    "clearance": Field("δ", "joining clearance (l - a)/a", 0.0, strict=True),
    "misalignment": Field("x(0)", "axial misalignment at the start", 0.0),
    "initial_tilt": Field("φ(0)", "tilt at the start"),
    "inertia": Field("I_φ", "moment of inertia about the mass centre", 0.0, strict=True),
    "lateral_stiffness": Field("k_x", "lateral stiffness of the suspension", 0.0),
    "tilt_stiffness": Field("k_φ", "tilt stiffness of the suspension", 0.0),
    "lateral_damping": Field("h_x", "lateral damping of the suspension", 0.0),
    "axial_damping": Field("h_y", "axial damping of the suspension", 0.0),
    "tilt_damping": Field("h_φ", "tilt damping of the suspension", 0.0),
    "contact_stiffness": Field("k_a", "stiffness of the base at a contact", 0.0, strict=True),
    "contact_damping": Field("h_a", "damping of the base at a contact", 0.0),
    "friction": Field("μ", "coefficient of dry friction", 0.0),
    "press_force": Field("f0", "initial pressing force"),
    "frequency": Field("ν", "excitation frequency; 0 holds the excitation at sin(phase)", 0.0),
    "phase": Field("phase", "phase of the excitation at the start"),
    "rest_x": Field("x_st", "x at which the lateral spring is relaxed", derived="misalignment"),
    "rest_y": Field("y_st", "y at which the axial spring is relaxed", derived="half_height"),
    "rest_tilt": Field("φ_st", "tilt at which the tilt spring is relaxed"),
}
PARAMETER_NAMES: tuple[str, ...] = tuple(FIELDS)
_ROW = struct.Struct(f"{len(FIELDS)}d")


def check_name(name: str, valid: Sequence[str], what: str) -> None:
    """Refuse ``name`` unless it is one of ``valid``, naming the nearest and all valid ones."""
    if name in valid:
        return
    near = difflib.get_close_matches(name, valid, n=1)
    hint = f" Did you mean {near[0]!r}?" if near else ""
    raise ValueError(f"unknown {what} {name!r}.{hint} Valid: {', '.join(valid)}")


def _misplaced(half_width: Any, clearance: Any, misalignment: Any) -> Any:
    """Whether the part would start wholly beside the slot's edge (any shape)."""
    return misalignment >= half_width * (2.0 + clearance)


_MISPLACED_RULE = (
    "must be smaller than half_width * (2 + clearance): the part would start wholly beside the slot"
)


@dataclass(frozen=True, kw_only=True)
class Parameters:
    """One device, its excitation and its start; every value dimensionless (paper, sect. 2).

    The names, symbols and rules stand in ``FIELDS``. ``None`` for ``rest_x`` and ``rest_y`` means
    the suspension is relaxed where the part starts: ``misalignment`` and ``half_height``.

    Raises:
        TypeError: a value is not a real number.
        ValueError: a value outside its rule, named with the rule.
    """

    half_width: float
    half_height: float
    inertia: float
    lateral_stiffness: float
    tilt_stiffness: float
    lateral_damping: float
    axial_damping: float
    tilt_damping: float
    friction: float
    press_force: float
    frequency: float
    clearance: float = 0.09
    misalignment: float = 0.2
    initial_tilt: float = 0.001
    contact_stiffness: float = 100.0
    contact_damping: float = 1.0
    phase: float = 0.0
    rest_x: float | None = None
    rest_y: float | None = None
    rest_tilt: float = 0.0

    def __post_init__(self) -> None:
        row = []
        for name, field in FIELDS.items():
            value = getattr(self, name)
            if value is None and field.derived:
                row.append(math.nan)
                continue
            if isinstance(value, bool) or not isinstance(value, (int, float, np.number)):
                raise TypeError(f"{name} = {value!r}: {field.rule}")
            number = _as_float(value)
            if math.isnan(number) or not field.admits(number):
                raise ValueError(f"{name} = {value!r}: {field.rule}")
            object.__setattr__(self, name, number)
            row.append(number)
        # What batches are stacked of: a set is made once, and run more often.
        object.__setattr__(self, "_row", _ROW.pack(*row))
        if _misplaced(self.half_width, self.clearance, self.misalignment):
            raise ValueError(f"misalignment = {self.misalignment!r}: {_MISPLACED_RULE}")

    @property
    def slot_half_width(self) -> float:
        """L = a (1 + δ), half-width of the slot."""
        return self.half_width * (1.0 + self.clearance)

    def given(self) -> dict[str, float | None]:
        """Every parameter by name, None where it is derived."""
        return {name: getattr(self, name) for name in PARAMETER_NAMES}

    def replace(self, **changes: float | None) -> "Parameters":
        """A copy with ``changes``; an unknown name raises ValueError with the valid ones."""
        for name in changes:
            check_name(name, PARAMETER_NAMES, "parameter")
        return dataclasses.replace(self, **changes)  # type: ignore[arg-type]


@dataclass(frozen=True)
class Batch:
    """Many parameter sets: ``values[name]`` is an array of shape (n,), NaN standing for None."""

    values: Mapping[str, NDArray[np.float64]]

    @classmethod
    def of(cls, baseline: Parameters, **swept: ArrayLike) -> "Batch":
        """``baseline`` with the parameters in ``swept`` varied together, each of shape (n,).

        Raises:
            ValueError: an unknown name, shapes that differ, or a value outside its rule.
        """
        arrays = {}
        for name, values in swept.items():
            check_name(name, PARAMETER_NAMES, "parameter")
            try:
                arrays[name] = np.array(values, dtype=np.float64)
            except (TypeError, ValueError):
                raise ValueError(f"{name}: must be an array of numbers, got {values!r}") from None
            if arrays[name].ndim != 1 or arrays[name].size == 0:
                raise ValueError(f"{name}: must be a non-empty array of one dimension")
        sizes = {array.size for array in arrays.values()} or {1}
        if len(sizes) > 1:
            lengths = ", ".join(f"{name}: {array.size}" for name, array in arrays.items())
            raise ValueError(f"swept parameters must have one common length, got {lengths}")
        size = sizes.pop()
        return cls._checked(
            {
                name: arrays.get(name, np.full(size, _or_nan(getattr(baseline, name))))
                for name in PARAMETER_NAMES
            },
            swept=tuple(swept),
        )

    @classmethod
    def stack(cls, parameters: Sequence[Parameters]) -> "Batch":
        """One row for each of ``parameters``, in order.

        Raises:
            TypeError: something else than a sequence of ``Parameters``.
        """
        given: Any = parameters
        each_of = [None] if isinstance(given, Parameters) else given
        if not all(isinstance(each, Parameters) for each in each_of):
            raise TypeError(
                "a batch is a Batch or a sequence of Parameters such as [parameters], got "
                f"{type(given).__name__}"
            )
        rows = np.frombuffer(b"".join([each._row for each in given]))
        columns = rows.reshape((-1, len(PARAMETER_NAMES))).T.copy()
        return cls(dict(zip(PARAMETER_NAMES, columns, strict=True)))

    @classmethod
    def _checked(cls, values: dict[str, NDArray[np.float64]], swept: Sequence[str]) -> "Batch":
        for name in swept:
            outside = ~FIELDS[name].admits(values[name])
            if outside.any():
                row = int(np.argmax(outside))
                raise ValueError(
                    f"{name}[{row}] = {float(values[name][row])!r}: {FIELDS[name].rule}"
                )
        misplaced = _misplaced(values["half_width"], values["clearance"], values["misalignment"])
        if misplaced.any():
            row = int(np.argmax(misplaced))
            raise ValueError(
                f"misalignment[{row}] = {float(values['misalignment'][row])!r}: {_MISPLACED_RULE}"
            )
        return cls(values)

    def __len__(self) -> int:
        return int(self.values["half_width"].size)

    def __getitem__(self, row: int) -> Parameters:
        """The parameter set in ``row``, as a validated ``Parameters``."""
        values: dict[str, Any] = {name: float(value[row]) for name, value in self.values.items()}
        values |= {name: None for name, value in values.items() if math.isnan(value)}
        return Parameters(**values)

    def constants(self, readings: Readings) -> NDArray[np.float64]:
        """Shape (n, len(Constants._fields)): a row of ``Constants`` for each parameter set."""
        columns: dict[str, Any] = dict(self.values)
        columns["slot_half_width"] = columns["half_width"] * (1.0 + columns["clearance"])
        columns["rest_x"] = _filled(columns["rest_x"], columns["misalignment"])
        columns["rest_y"] = _filled(columns["rest_y"], columns["half_height"])
        if readings.preload == "printed":
            columns["rest_y"] = np.zeros(len(self))
        columns |= {f"printed_{name}": 1.0 for name in READING_NAMES if readings.is_printed(name)}
        rows = np.zeros((len(self), len(Constants._fields)))
        for place, name in enumerate(Constants._fields):
            if name in columns:
                rows[:, place] = columns[name]
        return rows


def _as_float(value: Any) -> float:
    try:
        return float(value)
    except OverflowError:  # an integer beyond all floats
        return math.inf


def _or_nan(value: float | None) -> float:
    return math.nan if value is None else value


def _filled(values: NDArray[np.float64], default: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where(np.isnan(values), default, values)


class Constants(NamedTuple):
    """What kernels compute with: floats only, defaults resolved, switches as 0.0 or 1.0."""

    half_width: float
    half_height: float
    slot_half_width: float
    misalignment: float
    initial_tilt: float
    inertia: float
    lateral_stiffness: float
    tilt_stiffness: float
    lateral_damping: float
    axial_damping: float
    tilt_damping: float
    contact_stiffness: float
    contact_damping: float
    friction: float
    press_force: float
    frequency: float
    phase: float
    rest_x: float
    rest_y: float
    rest_tilt: float
    printed_normal_sign: float
    printed_friction_law: float
    printed_contact_damping_law: float
    printed_side_gap: float
    printed_side_force: float
    printed_alignment_criterion: float
    printed_moment_arms: float
