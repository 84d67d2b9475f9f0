"""Parameters of the device and its excitation: named, validated, frozen; all dimensionless.

The fields of ``Parameters`` are the one table of parameters: name, symbol, meaning, quantity,
rule and default. Through ``FIELDS``, batches, ``Constants`` for kernels, SI units, the command
line, the study's configuration and the datasets are made from it.
"""

import dataclasses
import difflib
import math
import struct
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from model.compile.kernels import inlined_kernel
from model.physics.fields import Field, entry, parameter_table
from model.physics.quantities import (
    ANGLE,
    DAMPING,
    FORCE,
    FREQUENCY,
    INERTIA,
    LENGTH,
    PLAIN,
    SPEED,
    STIFFNESS,
    TILT_DAMPING,
    TILT_STIFFNESS,
)
from model.physics.tables import Value, described, entries, numbers
from model.physics.variants import SWITCHES, VARIANT_NAMES, Variants

Shape = Literal["round", "square"]
"""Shape of the part and the hole: round, or the paper's plane one, of a square peg and a slot."""


def check_name(name: str, valid: Sequence[str], what: str) -> None:
    """Raise ValueError unless ``name`` is in ``valid``; the message names the closest, and all."""
    if name in valid:
        return
    near = difflib.get_close_matches(name, valid, n=1)
    hint = f" Did you mean {near[0]!r}?" if near else ""
    raise ValueError(f"unknown {what} {name!r}.{hint} Valid: {', '.join(valid)}")


def _misplaced(values: Mapping[str, Any]) -> Any:
    """Return whether a part of any shape would start wholly beside the slot, or left of it.

    ``values`` are parameters by name: numbers or arrays. Either the mass centre or the middle of
    the face must be in place.
    """
    x = values["misalignment"]
    middle = x + values["half_height"] * np.sin(values["initial_tilt"])
    beside = np.minimum(x, middle) >= values["half_width"] * (2.0 + values["clearance"])
    return beside | (np.maximum(x, middle) < 0.0)


_MISPLACED_RULE = (
    "must be smaller than half_width * (2 + clearance): the part would start wholly beside the "
    "slot; and >= 0, or the tilt must bring the middle of the face, misalignment + half_height * "
    "sin(initial_tilt), to where it is >= 0"
)


@parameter_table
class Parameters(Value):
    """One device, its excitation and its start; every value dimensionless (paper, sect. 2).

    ``None`` for ``rest_x`` and ``rest_y`` means that the suspension is relaxed at the start of the
    part: at ``misalignment`` and ``half_height``. ``None`` for ``approach_speed`` means a sudden
    start, without an approach.

    Raises:
        TypeError: a value that is not a real number.
        ValueError: a value that breaks its rule; the message names the rule.
    """

    half_width: float = entry("a", "half-width of the part", LENGTH, "> 0")
    half_height: float = entry("b", "half-height of the part", LENGTH, "> 0")
    clearance: float = entry(
        "δ", "joining clearance (l - a)/a", PLAIN, "> 0", measured=True, default=0.09
    )
    misalignment: float = entry(
        "x(0)", "axial misalignment at the start", LENGTH, measured=True, default=0.2
    )
    initial_tilt: float = entry("φ(0)", "tilt at the start", ANGLE, default=0.001)
    inertia: float = entry("I_φ", "moment of inertia about the mass centre", INERTIA, "> 0")
    lateral_stiffness: float = entry(
        "k_x", "lateral stiffness of the suspension", STIFFNESS, ">= 0"
    )
    tilt_stiffness: float = entry("k_φ", "tilt stiffness of the suspension", TILT_STIFFNESS, ">= 0")
    lateral_damping: float = entry("h_x", "lateral damping of the suspension", DAMPING, ">= 0")
    axial_damping: float = entry("h_y", "axial damping of the suspension", DAMPING, ">= 0")
    tilt_damping: float = entry("h_φ", "tilt damping of the suspension", TILT_DAMPING, ">= 0")
    contact_stiffness: float = entry(
        "k_a", "stiffness of the base at a contact", STIFFNESS, "> 0", default=100.0
    )
    contact_damping: float = entry(
        "h_a", "damping of the base at a contact", DAMPING, ">= 0", default=1.0
    )
    friction: float = entry("μ", "coefficient of dry friction", PLAIN, ">= 0")
    press_force: float = entry("f0", "initial pressing force", FORCE)
    frequency: float = entry(
        "ν", "excitation frequency; 0 holds the excitation at sin(phase)", FREQUENCY, ">= 0"
    )
    phase: float = entry("phase", "phase of the excitation at the start", ANGLE, default=0.0)
    rest_x: float | None = entry(
        "x_st",
        "x at which the lateral spring is relaxed",
        LENGTH,
        derived="misalignment",
        default=None,
    )
    rest_y: float | None = entry(
        "y_st",
        "y at which the axial spring is relaxed",
        LENGTH,
        derived="half_height",
        default=None,
    )
    rest_tilt: float = entry("φ_st", "tilt at which the tilt spring is relaxed", ANGLE, default=0.0)
    approach_speed: float | None = entry(
        "v",
        "speed at which the holder is lowered until it presses",
        SPEED,
        "> 0",
        optional=True,
        default=None,
    )

    def __post_init__(self) -> None:
        row = []
        for name, field in FIELDS.items():
            value = getattr(self, name)
            if value is None and (field.derived or field.optional):
                row.append(math.nan)
                continue
            if isinstance(value, bool) or not isinstance(value, (int, float, np.number)):
                raise TypeError(f"{name} = {value!r}: {field.rule}")
            number = _as_float(value)
            if math.isnan(number) or not field.admits(number):
                raise ValueError(f"{name} = {value!r}: {field.rule}")
            object.__setattr__(self, name, number)
            row.append(number)
        # ``Batch.stack`` joins these bytes, which is faster than to read every attribute.
        object.__setattr__(self, "_row", _ROW.pack(*row))
        if _misplaced(self.given()):
            raise ValueError(f"misalignment = {self.misalignment!r}: {_MISPLACED_RULE}")

    @property
    def slot_half_width(self) -> float:
        """Half-width of the slot, l = a (1 + δ)."""
        return self.half_width * (1.0 + self.clearance)

    def given(self) -> dict[str, float | None]:
        """Return every parameter by name, None where it is derived, without optional ones."""
        values = {name: getattr(self, name) for name in PARAMETER_NAMES}
        return {n: v for n, v in values.items() if v is not None or not FIELDS[n].optional}

    def replace(self, **changes: float | None) -> "Parameters":
        """Return a copy with ``changes``; an unknown name raises ValueError with the valid ones."""
        for name in changes:
            check_name(name, PARAMETER_NAMES, "parameter")
        return dataclasses.replace(self, **changes)  # type: ignore[arg-type]


FIELDS: Mapping[str, Field] = entries(Parameters)
PARAMETER_NAMES: tuple[str, ...] = tuple(FIELDS)
OF_PAPER = tuple(name for name, field in FIELDS.items() if not field.optional)
"""The parameters of the paper's device, whose start is sudden."""
# The parameters without a default.
REQUIRED_NAMES = tuple(f.name for f in dataclasses.fields(Parameters) if f.default is MISSING)
Parameters.__doc__ = described(Parameters.__doc__, FIELDS)
_ROW = struct.Struct(f"{len(FIELDS)}d")

# Kernels take the slot's half-width in place of the clearance, and the rate of the press.
_RESOLVED = {"clearance": "slot_half_width", "approach_speed": "press_rate"}
_BEYOND_REACH = 1e9  # depth of insertion, dimensionless
_CONSTANTS = (
    *(_RESOLVED.get(name, name) for name in PARAMETER_NAMES),
    "ramp_end",
    "insertion_depth",
    *(f"printed_{name}" for name in SWITCHES),
)


class Constants(numbers("Constants", _CONSTANTS)):  # type: ignore[misc]
    """Numbers that kernels compute with: defaults resolved, variants as 0.0 or 1.0.

    Parameters keep their names, but ``slot_half_width`` replaces ``clearance``, and ``press_rate``
    ``approach_speed``: the press grows at this rate (K_Y = 1) until the time ``ramp_end``. Both are
    0 for a sudden start; ``ramp_end`` is found as a run begins. Added are ``insertion_depth``, from
    the settings, and ``printed_*``, from the fields of ``Variants``.

    Attributes:
        is_round: True for a round part in a round hole, False for a plane one. Code is compiled for
            one of them.
    """

    __slots__ = ()
    is_round = False


class RoundConstants(Constants):
    """The ``Constants`` of a round part in a round hole.

    ``half_width`` is the part's radius, ``slot_half_width`` that of the hole, and ``half_height``
    the height of the mass centre over the bottom face.
    """

    __slots__ = ()
    is_round = True


class Given(numbers("Given", PARAMETER_NAMES)):  # type: ignore[misc]
    """The parameters as numbers, NaN for None."""

    __slots__ = ()


_DERIVED = {name: field.derived for name, field in FIELDS.items() if field.derived}


@inlined_kernel
def _constant(name, given):
    """Return a constant by its name, of numbers or of arrays; the variants are consistent."""
    if name == "slot_half_width":
        return given.half_width * (1.0 + given.clearance)
    if name == "press_rate":
        speed = given.approach_speed
        return np.where(np.isnan(speed), 0.0, speed)
    if name == "insertion_depth":
        rest_y = _constant("rest_y", given)
        depth = 0.5 * (given.press_force - (rest_y - given.half_height))
        depth = np.where(depth > 0.0, depth, 0.0)
        return np.where(depth < given.half_width, depth, given.half_width)
    if name not in FIELDS:
        return 0.0  # a printed variant, or the end of the ramp
    value = getattr(given, name)
    if name in _DERIVED:
        return np.where(np.isnan(value), getattr(given, _DERIVED[name]), value)
    return value


@inlined_kernel
def resolved(given):
    """Return the ``Constants`` of ``Given``, of numbers or of arrays."""
    return Constants(*(_constant(name, given) for name in _CONSTANTS))


@dataclass(frozen=True, eq=False, repr=False)
class Batch(Value):
    """Parameter sets: ``values[name]`` is an array of shape (n,), where NaN stands for None.

    ``of`` and ``stack`` make checked batches; the constructor does not check.
    """

    values: Mapping[str, NDArray[np.float64]]

    @classmethod
    def of(cls, baseline: Parameters, **swept: ArrayLike) -> "Batch":
        """Return n sets: ``baseline`` with the parameters in ``swept``, of shape (n,), varied.

        Row i takes element i of every array.

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
        columns = {
            name: arrays.get(name, np.full(size, getattr(baseline, name), dtype=np.float64))
            for name in PARAMETER_NAMES
        }
        return cls(columns).checked(*swept)

    def checked(self, *names: str) -> "Batch":
        """Return the batch itself, in which the parameters of these names keep their rules.

        Raises:
            ValueError: a value outside its rule; the message names its row.
        """
        columns = self.values
        for name in names:
            outside = ~FIELDS[name].admits(columns[name])
            if outside.any():
                row = int(np.argmax(outside))
                raise ValueError(
                    f"{name}[{row}] = {float(columns[name][row])!r}: {FIELDS[name].rule}"
                )
        misplaced = _misplaced(columns)
        if misplaced.any():
            row = int(np.argmax(misplaced))
            raise ValueError(
                f"misalignment[{row}] = {float(columns['misalignment'][row])!r}: {_MISPLACED_RULE}"
            )
        return self

    @classmethod
    def stack(cls, parameters: Sequence[Parameters]) -> "Batch":
        """Return the batch of these ``parameters``, in order.

        Raises:
            TypeError: not a sequence of ``Parameters``.
        """
        given: Any = parameters
        if isinstance(given, Parameters) or not all(isinstance(each, Parameters) for each in given):
            raise TypeError(
                "a batch is a Batch or a sequence of Parameters such as [parameters], got "
                f"{type(given).__name__}"
            )
        rows = np.frombuffer(b"".join([each._row for each in given]))
        columns = rows.reshape((-1, len(PARAMETER_NAMES))).T.copy()
        return cls(dict(zip(PARAMETER_NAMES, columns, strict=True)))

    def __len__(self) -> int:
        return int(self.values["half_width"].size)

    def __repr__(self) -> str:
        ends = {n: (v.min(), v.max()) for n, v in self.values.items() if np.ptp(v) > 0.0}
        varied = ", ".join(f"{n} {low:.6g} to {high:.6g}" for n, (low, high) in ends.items())
        return f"<Batch: {len(self):,} parameter sets; {varied or 'none varies'}>"

    def __getitem__(self, row: int) -> Parameters:
        """Return the parameter set in ``row``, as a validated ``Parameters``."""
        values: dict[str, Any] = {name: float(value[row]) for name, value in self.values.items()}
        values |= {name: None for name, value in values.items() if math.isnan(value)}
        return Parameters(**values)

    def insertion_depths(self) -> NDArray[np.float64]:
        """Return the default depths, shape (n,): half of ``reaches``, at most half_width."""
        return np.asarray(resolved(Given(**self.values)).insertion_depth)

    def reaches(self) -> NDArray[np.float64]:
        """Return the depths to which f0 presses the parts against the axial spring, shape (n,)."""
        given = resolved(Given(**self.values))
        return np.asarray(given.press_force - (given.rest_y - given.half_height))

    def constants(
        self, variants: Variants, insertion_depth: float | None = None
    ) -> NDArray[np.float64]:
        """Return the ``Constants`` of each parameter set as a row, shape (n, constants).

        ``insertion_depth`` replaces the default, ``insertion_depths``; one at which the press does
        not hold the part is beyond reach.
        """
        columns = resolved(Given(**self.values))._asdict()
        if variants.preload == "printed":
            columns["rest_y"] = 0.0  # an axial spring relaxed at 0
        if insertion_depth is not None:
            columns["insertion_depth"] = np.where(
                self.reaches() > insertion_depth, insertion_depth, _BEYOND_REACH
            )
        columns |= {f"printed_{name}": variants.is_printed(name) for name in VARIANT_NAMES}
        rows = np.empty((len(self), len(_CONSTANTS)))
        for place, name in enumerate(_CONSTANTS):
            rows[:, place] = columns[name]
        return rows


def _as_float(value: Any) -> float:
    try:
        return float(value)
    except OverflowError:  # an integer beyond all floats
        return math.inf


def constants_of(parameters: Parameters, shape: Shape) -> Constants:
    """Return the constants of one parameter set, consistent readings, for a part of this shape."""
    row = Batch.stack([parameters]).constants(Variants.consistent())[0].tolist()
    return (RoundConstants if shape == "round" else Constants)(*row)
