"""Devices in SI units, read from YAML files: quantities, tolerances, base, free ranges, limits."""

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, get_args

import yaml

from model.events.scenes import ALIGNMENT
from model.physics.fields import Bound
from model.physics.parameters import FIELDS, Parameters, Shape, check_name
from model.physics.quantities import LENGTH, PLAIN, Quantity
from model.physics.tables import Value, vars_of
from model.physics.units import UNITS, Device, Units, device
from model.runs.settings import Settings
from model.sweeps import files
from vibralign.device.amounts import Tolerance, read_amount, read_range
from vibralign.device.approach import (
    SPEED,
    SUDDEN,
    USUAL,
    Approach,
    Vibrator,
    approaches_to_try,
    read_start,
)
from vibralign.device.base import BASE, CENTRE, CENTRE_WORDS, SOURCES, pair_of, with_base
from vibralign.device.holder import RATIOS, with_damping
from vibralign.device.mouth import (
    CHAMFERS,
    GRIPPER_TILT,
    MOUTH,
    REPLACED,
    as_parameters,
    check_not_replaced,
)
from vibralign.device.plausibility import (
    DeviceError,
    NoNeedError,
    check_place,
    check_press,
    doubts,
)

# Upper limits that a design may have to keep: meaning and SI unit.
LIMITS: Mapping[str, tuple[str, str]] = {
    "contact_force": ("largest contact force", "N"),
    "time": ("longest time until alignment, not until insertion", "s"),
    "tilt": ("largest tilt until alignment", "rad"),
}
# Limit "vibration" of a design: the share of devices that must not align without vibration.
VIBRATION: Mapping[str, float] = {"needed": 1.0, "not needed": 0.0}
_OWN = {**{n: each for n, each in FIELDS.items() if n not in REPLACED}, **UNITS, **MOUTH}
QUANTITIES = (*UNITS, *(n for n in _OWN if n not in UNITS), *RATIOS, *BASE, CENTRE)
FOLLOWED = "a part with chamfers is followed until its face has reached them, no further"
_BESIDES = ("materials", "free", "limits", "vibrator", "shape")


@dataclass(frozen=True, eq=False, repr=False)
class StatedDevice(Value):
    """A device as its file states it, in SI units.

    Attributes:
        source: the file.
        quantities: values of the stated quantities, the base's included.
        tolerances: tolerances by quantity.
        materials: materials of part and base, such as "steel on aluminium", or None.
        free: ranges within which a design may choose a quantity.
        limits: largest admissible values of the names in ``LIMITS``; for "vibration" the share of
            devices that must not align without it, 1 or 0.
        changes: quantities that replace the file's, as they were given.
        vibrator: "running" or "still" during the approach, or None.
        sudden: True if press and vibration set in at once, without an approach.
        stated_shape: shape of part and hole (``Settings.shape``), or None.
        horizon: latest time of its runs in s, or None for that of the settings in units of 1/p.
        insertion_depth: depth in m at which it counts as inserted, or None for the default.
        notes: lines on words of the file that ``changes`` may have made mean something else.
    """

    source: Path
    quantities: Mapping[str, float]
    tolerances: Mapping[str, Tolerance] = field(default_factory=dict)
    materials: str | None = None
    free: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    limits: Mapping[str, float] = field(default_factory=dict)
    changes: Mapping[str, object] = field(default_factory=dict)
    vibrator: Vibrator | None = None
    sudden: bool = False
    stated_shape: Shape | None = None
    horizon: float | None = None
    insertion_depth: float | None = None
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        changes = "".join(f", {name}={value}" for name, value in self.changes.items())
        return f"<StatedDevice: {self.source}{changes}>"

    def _shown(self) -> dict[str, Any]:
        """Return the rows of the table in a notebook, with what is doubtful."""
        return vars_of(self) | {"doubts": self.doubts}

    def __getstate__(self) -> dict[str, Any]:
        """Return what copies and pickles hold: nothing that is computed from it."""
        return vars_of(self)

    @cached_property
    def device(self) -> Device:
        """Units and dimensionless parameters of the device."""
        return self.at({})

    @property
    def units(self) -> Units:
        """Units of the device."""
        return self.device.units

    @property
    def parameters(self) -> Parameters:
        """Dimensionless parameters of the device."""
        return self.device.parameters

    @property
    def shape(self) -> Shape:
        """Shape of part and hole; "round" where none is stated."""
        return self.stated_shape or "round"

    @property
    def values(self) -> dict[str, float]:
        """Value of every quantity in SI units, stated or not, without those of the base."""
        given, resolved = self.units.in_si(self.parameters).given(), self.resolved({})
        part = self._of_part({})
        stated = {n: part[n] for n in (*MOUTH, "half_width", "clearance") if n in part}
        usual = {**vars(self.units), **given, **resolved, GRIPPER_TILT: 0.0, **stated}
        return {n: v for n, v in usual.items() if v is not None and n not in REPLACED}

    def at(self, changes: Mapping[str, float]) -> Device:
        """Return units and dimensionless parameters with some quantities (SI units) changed.

        As with ``--set``, contact stiffness and damping are computed from the file's materials and
        restitution, or replace these if they are among the changes.

        Raises:
            ValueError: a quantity that is unknown or outside its rule.
        """
        return device(self.resolved(changes))

    def admitted(self, changes: Mapping[str, float]) -> Device:
        """Return ``at`` for values that a file may state.

        Raises:
            ValueError: as ``at``, or the part is not pressed.
            NoNeedError: the part starts inside the hole, or its chamfer meets the hole's.
        """
        check_press(changes.get("press_force", self.quantities["press_force"]))
        found = device(self.resolved(changes))
        check_place(self._of_part(changes))
        return found

    def resolved(self, changes: Mapping[str, float]) -> dict[str, float]:
        """Return the parameters in SI units, and the units, with ``changes`` of quantities."""
        stated = None if "materials" in _replaced_by(changes) else self.materials
        pair = None if stated is None else pair_of(stated)
        return with_base(as_parameters(self._of_part(changes)), pair, self.shape)

    def _of_part(self, changes: Mapping[str, float]) -> dict[str, float]:
        """Return the quantities with ``changes``, of the holder and the part as ``MOUTH`` is."""
        replaced = _replaced_by(changes)
        kept = {name: v for name, v in self.quantities.items() if name not in replaced}
        approach = {} if self.sudden else {SPEED: USUAL}
        return _of_holder_and_part({**approach, **kept, **changes})

    def approaches(self, varied: Collection[str] = ()) -> tuple[Approach, ...]:
        """Return the approaches that it meets: the stated one, or those to try; none if sudden.

        The first is that of a single run. They have no speed if it is among the ``varied``.
        """
        if self.sudden:
            return ()
        own = self.quantities.get(SPEED)
        return approaches_to_try(own, self.vibrator, varies=SPEED in varied)

    def lowered(self, approach: Approach | None = None) -> "StatedDevice":
        """Return the device with this approach stated, by default that of a single run."""
        if self.sudden:
            return self
        vibrator, speed = approach or self.approaches()[0]
        own = {} if speed is None else {SPEED: speed}
        return replace(self, vibrator=vibrator, quantities={**self.quantities, **own})

    def changed(self, **changes: float | str) -> "StatedDevice":
        """Return the device with other values and the same tolerances.

        Numbers are in SI units; a text has a unit, and may state another tolerance.

        Quantities that the new values replace, such as ``materials``, go with their tolerances.

        Raises:
            ValueError: an unknown quantity, or a text that is no amount.
        """
        for name in changes:
            if name not in ("vibrator", SPEED):
                check_quantity(name)
        vibrator, sudden = read_start(self.stated_start | changes)
        values, tolerances = _amounts(changes, self.quantities.get("frequency"))
        replaced = _replaced_by(changes) | ({SPEED} if sudden else set())
        return replace(
            self,
            quantities={n: v for n, v in self.quantities.items() if n not in replaced} | values,
            tolerances={n: each for n, each in self.tolerances.items() if n not in replaced}
            | tolerances,
            materials=None if "materials" in replaced else self.materials,
            vibrator=vibrator,
            sudden=sudden,
            changes={**self.changes, **changes},
        )

    @property
    def stated_start(self) -> dict[str, float | str]:
        """What states its start, as ``changed`` takes it."""
        speed = SUDDEN if self.sudden else self.quantities.get(SPEED)
        stated = {SPEED: speed, "vibrator": self.vibrator}
        return {name: each for name, each in stated.items() if each is not None}

    def run_settings(self, settings: Settings, units: Units) -> Settings:
        """Return ``settings`` with what is stated for runs; ``units`` are those of the device.

        Devices with other quantities have other units, and the same horizon and depth in SI units.
        """
        changes: dict[str, Any] = {
            "start": "simultaneous" if self.sudden else self.lowered().vibrator,
            "shape": settings.shape or self.shape,
        }
        if self.is_chamfered:
            changes |= {"scene": ALIGNMENT, "insertion_depth": None, "alignment_only": False}
            if self.insertion_depth is not None or settings.insertion_depth is not None:
                raise ValueError(f"insertion_depth: leave it out: {FOLLOWED}")
        if self.horizon is not None:
            changes["horizon"] = self.horizon / units.time
        if self.insertion_depth is not None:
            changes["insertion_depth"] = self.insertion_depth / units.amplitude
        return replace(settings, **changes)

    @property
    def is_chamfered(self) -> bool:
        """True if the file states a chamfer, be it 0: runs then end at the chamfers."""
        return not self.quantities.keys().isdisjoint(CHAMFERS)

    @property
    def base_is_stated(self) -> bool:
        """True if the file states how stiff the base is."""
        return self.materials is not None or "contact_stiffness" in self.quantities

    @property
    def doubts(self) -> list[str]:
        """Lines on values that are possible but probably not meant."""
        cut_off = [
            f"{name} = {self.quantities[name]:.4g} ± {each.around(self.quantities[name]):.4g}: the "
            "tolerance reaches below 0, where it is cut off"
            for name, each in self.tolerances.items()
            if each.kind == "uniform"
            and each.around(self.quantities[name]) > abs(self.quantities[name])
            and bound_of(name)
        ]
        found = doubts({**self.values, **self.quantities}, self.device, self.shape)
        if self.stated_shape is None:
            found.append(
                "shape is not stated: taken as round, a peg in a round hole; state shape: round, "
                "or shape: square for a plane part beside a slot"
            )
        return [*self.notes, *found, *cut_off]


def _of_holder_and_part(quantities: Mapping[str, float]) -> dict[str, float]:
    """Return quantities with dampings in place of ratios, and half_height of centre_height."""
    found = with_damping(quantities)
    if CENTRE in found:
        found["half_height"] = found.pop(CENTRE)
    return found


def _replaced_by(changes: Iterable[str]) -> set[str]:
    """Return the quantities from which those in ``changes`` would be computed."""
    from_others = {
        n: (*SOURCES.get(n, ()), *((RATIOS[n],) if n in RATIOS else ())) for n in changes
    }
    return {each for others in from_others.values() for each in others} - set(changes)


def load_device(path: Path | str, changes: Mapping[str, object] | None = None) -> StatedDevice:
    """Return the device in a YAML file as it is stated.

    Args:
        path: file with lines NAME: VALUE, in SI units or with units.
        changes: quantities by name that replace the file's, numbers in SI units or text with
            units. A changed quantity keeps its tolerance unless the text states another. A
            stiffness or damping also replaces the quantities from which it would be computed, a
            damping ratio the damping.

    Raises:
        DeviceError: the file cannot be read, is not YAML, breaks a rule, or makes no sense.
        NoNeedError: it is a valid device, which needs no alignment.
    """
    path, changes = Path(path), {} if changes is None else changes
    replaced = _replaced_by(changes) | ({SPEED} if changes.get(SPEED) == SUDDEN else set())
    mapping = {name: value for name, value in _mapping(path).items() if name not in replaced}
    try:
        vibrator, sudden = read_start({**mapping, **changes})
        at = _one_frequency(mapping)
        values, tolerances = _amounts(mapping, at)
        changed, others = _amounts(changes, _one_frequency({**mapping, **changes}))
        materials = changes.get("materials", mapping.get("materials"))
        stated = StatedDevice(
            source=path,
            quantities={**values, **changed},
            tolerances={**tolerances, **others},
            materials=None if materials is None else str(materials),
            free={n: read_range(n, v, unit_of(n), at) for n, v in _section("free", mapping)},
            limits=_limits(mapping),
            changes=dict(changes),
            vibrator=vibrator,
            sudden=sudden,
            stated_shape=mapping.get("shape"),
            notes=_kept_amplitude(mapping, values, changes),
        )
        if mapping.get("shape") is not None:
            check_name(str(mapping["shape"]), get_args(Shape), "shape")
        # Refuses unknown and missing quantities, before anything is computed from them.
        known = {n: v for n, v in stated.quantities.items() if n not in BASE}
        device(as_parameters(_of_holder_and_part(known)))
        stated.admitted({})
        _check_tolerances(stated)
        _check_free(stated)
    except ValueError as error:
        needless = isinstance(error, NoNeedError)
        raise (NoNeedError if needless else DeviceError)(f"{path}: {error}") from None
    return stated


def unit_of(name: str) -> str:
    """Return the SI unit of a quantity of a device, "1" if it has none.

    Raises:
        ValueError: an unknown quantity.
    """
    return quantity_of(name)[1].unit


def quantity_of(name: str) -> tuple[str, Quantity, str]:
    """Return meaning, physical quantity and symbol of a quantity of a device; "" without a symbol.

    Raises:
        ValueError: an unknown quantity.
    """
    check_quantity(name)
    if name in _OWN:
        return _OWN[name].description, _OWN[name].quantity, _OWN[name].symbol
    if name in RATIOS:
        return f"damping ratio, in place of {RATIOS[name]}", PLAIN, ""
    words, unit = BASE.get(name, (CENTRE_WORDS, LENGTH.unit))
    return words, LENGTH if unit == LENGTH.unit else PLAIN, ""


def bound_of(name: str) -> Bound:
    """Return the admissible range of a quantity of a device."""
    return _OWN[name].bound if name in _OWN else "> 0"


def check_quantity(name: str) -> None:
    """Refuse a name that is no quantity of a device; of an old one, say what to write instead."""
    check_not_replaced(name)
    check_name(name, QUANTITIES, "quantity of a device")


class _Loader(files.Loader):  # type: ignore[misc]
    """Loader of YAML that leaves numbers as text: for YAML 050 is 40, and 1:30 is 90."""

    yaml_implicit_resolvers = {  # noqa: RUF012 - never changed
        first: [each for each in resolvers if each[0].rpartition(":")[2] in {"bool", "null"}]
        for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
    }


def _mapping(path: Path) -> dict[str, Any]:
    try:
        mapping = files.parse_yaml(files.read_text(path), _Loader)
    except OSError as error:
        raise DeviceError(f"{path}: cannot be read: {error.strerror}") from None
    except (ValueError, yaml.YAMLError, TypeError) as error:
        reason = " ".join(str(error).split())
        raise DeviceError(f"{path}: cannot be read as YAML: {reason}") from None
    if not isinstance(mapping, dict):
        raise DeviceError(f"{path}: must be lines of NAME: VALUE, one for each quantity")
    return {str(name): value for name, value in mapping.items()}


def _kept_amplitude(
    mapping: Mapping[str, Any], values: Mapping[str, float], changes: Mapping[str, object]
) -> tuple[str, ...]:
    """Return a line if the file's amplitude is an acceleration at a frequency that is changed."""
    if "frequency" not in changes or "amplitude" not in values or "amplitude" in changes:
        return ()
    given, kept = mapping["amplitude"], values["amplitude"]
    if math.isclose(read_amount("amplitude", given, "m", 1.0).value, kept):
        return ()
    at, now = f"{values['frequency']:.4g} Hz", changes["frequency"]
    words = f"amplitude = {given} is {1e3 * kept:.4g} mm at {at}, and stays so at frequency = {now}"
    return (f"{words}: set amplitude, too, if the acceleration is to stay",)


def _one_frequency(mapping: Mapping[str, Any]) -> float | None:
    """Return the frequency in Hz, or None if it is missing, free or has a tolerance."""
    if mapping.get("frequency") is None or "frequency" in dict(_section("free", mapping)):
        return None
    amount = read_amount("frequency", mapping["frequency"], "Hz")
    return None if amount.tolerance else amount.value


def _amounts(
    given: Mapping[str, object], frequency: float | None
) -> tuple[dict[str, float], dict[str, Tolerance]]:
    """Return values and tolerances of what is ``given`` besides ``_BESIDES``, in SI units."""
    amounts = {
        name: read_amount(name, value, unit_of(name), frequency)
        for name, value in given.items()
        if name not in _BESIDES and value != SUDDEN
    }
    tolerances = {n: each.tolerance for n, each in amounts.items() if each.tolerance is not None}
    return {name: each.value for name, each in amounts.items()}, tolerances


def _section(name: str, mapping: Mapping[str, Any]) -> Iterable[tuple[str, object]]:
    given = mapping.get(name, {})
    if not isinstance(given, dict):
        raise ValueError(f"{name} = {given!r}: must be lines of NAME: VALUE")  # noqa: TRY004
    return [(str(key), value) for key, value in given.items()]


def _limits(mapping: Mapping[str, Any]) -> dict[str, float]:
    limits = {}
    for name, value in _section("limits", mapping):
        check_name(name, (*LIMITS, "vibration"), "limit of a design")
        if name == "vibration":
            if value not in VIBRATION:
                words = " or ".join(VIBRATION)
                raise ValueError(f"limits: vibration = {value!r}: must be {words}")
            limits[name] = VIBRATION[str(value)]
            continue
        limits[name] = read_amount(name, value, LIMITS[name][1]).value
        if not 0.0 < limits[name] < math.inf:
            rule = f"must be a finite number > 0, the {LIMITS[name][0]}"
            raise ValueError(f"limits: {name} = {value!r}: {rule}")
    return limits


def _check_tolerances(stated: StatedDevice) -> None:
    """Refuse tolerances without effect, or within which the part starts wholly beside the hole."""
    if "phase" in stated.tolerances:
        raise ValueError("phase: a tolerance has no effect, since every phase is tried")
    for name, each in stated.tolerances.items():
        if each.end(stated.quantities[name]) == 0.0:
            raise ValueError(f"{name}: a tolerance in per cent of 0 has no effect: write an amount")
    worst = {}
    for name, sign in (("half_width", -1.0), ("clearance", -1.0), ("misalignment", 1.0)):
        if name in stated.tolerances:
            own = stated.quantities[name]
            spread = stated.tolerances[name].around(own)
            spread *= 1.0 if stated.tolerances[name].kind == "uniform" else 4.0
            worst[name] = max(own + sign * spread, 1e-3 * own)
    try:
        stated.at(worst)
    except ValueError as error:
        raise ValueError(f"at the ends of the tolerances: {error}") from None


def _check_free(stated: StatedDevice) -> None:
    """Refuse ranges with an end that breaks the rule of its quantity."""
    for name, ends in stated.free.items():
        for end in ends:
            try:
                check_press(end if name == "press_force" else 1.0)
                stated.at({name: end})
            except ValueError as error:
                raise ValueError(f"free: {error}") from None
