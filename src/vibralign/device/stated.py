"""Devices in SI units as their files state them: quantities, tolerances, base, ranges, limits."""

import math
import warnings
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NoReturn

from model.events.scenes import ALIGNMENT
from model.physics.parameters import Parameters, Shape
from model.physics.tables import Value, vars_of
from model.physics.units import Device, Units, device
from model.runs.settings import Settings
from vibralign.device.amounts import Amount, Tolerance, read_amount
from vibralign.device.approach import (
    SPEED,
    SUDDEN,
    USUAL,
    Approach,
    Vibrator,
    approaches_to_try,
    read_start,
    with_changes,
)
from vibralign.device.base import pair_of, with_base
from vibralign.device.fits import play_of
from vibralign.device.instead import check_centre, replaced_by, with_parameters
from vibralign.device.limits import OF_VIBRATOR, of_vibrator
from vibralign.device.mouth import (
    CHAMFERS,
    GRIPPER_TILT,
    MOUTH,
    REPLACED,
    as_parameters,
)
from vibralign.device.plausibility import (
    NoNeedError,
    check_place,
    check_press,
    doubts,
    wide_tilts,
    without_unit,
)
from vibralign.device.quantities import check_quantity, unit_of
from vibralign.device.unknown import Range
from vibralign.doubts import DoubtWarning

FOLLOWED = "a part with chamfers is followed until its face has reached them, no further"
BESIDES = ("materials", "fit", "free", "limits", "vibrator", "shape")


@dataclass(frozen=True, eq=False, repr=False)
class StatedDevice(Value):
    """A device as its file states it, in SI units.

    Attributes:
        source: the file.
        quantities: values of the stated quantities, the base's included.
        tolerances: tolerances by quantity.
        materials: materials of part and base, such as "steel on aluminium", or None.
        free: ranges within which a design may choose a quantity.
        limits: largest admissible values by the names in ``LIMITS``; for "vibration" the share of
            devices that must not align without it, 1 or 0.
        changes: quantities that replace the file's, as they were given.
        vibrator: "running" or "still" during the approach, or None.
        sudden: True if press and vibration set in at once, without an approach.
        stated_shape: shape of part and hole (``Settings.shape``), or None.
        horizon: latest time of its runs in s, or None for that of the settings in units of 1/p.
        insertion_depth: depth in m at which it counts as inserted, or None for the default.
        notes: lines on entries of the file whose meaning ``changes`` may have altered.
        written: the unit in which a quantity is stated, such as "mm p-p", and its size in SI units;
            of those that are stated with one.
        unknown: ranges of what nobody has measured; ``quantities`` has their middles.
        samples: file of what trials leave possible of these, or None.
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
    written: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    unknown: Mapping[str, Range] = field(default_factory=dict)
    samples: Path | None = None

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

    @property
    def needless(self) -> str:
        """Why the part needs no alignment at its stated values, in words; empty if it does."""
        try:
            self.admitted({})
        except NoNeedError as found:
            return str(found)
        return ""

    def resolved(self, changes: Mapping[str, float]) -> dict[str, float]:
        """Return the parameters in SI units, and the units, with ``changes`` of quantities."""
        stated = None if "materials" in replaced_by(changes) else self.materials
        pair = None if stated is None else pair_of(stated)
        return with_base(as_parameters(self._of_part(changes)), pair, self.shape)

    def _of_part(self, changes: Mapping[str, float]) -> dict[str, float]:
        """Return the quantities with ``changes``, those of ``INSTEAD`` converted to parameters."""
        replaced = replaced_by(changes)
        kept = {name: v for name, v in self.quantities.items() if name not in replaced}
        approach = {} if self.sudden else {SPEED: USUAL}
        return with_parameters({**approach, **kept, **changes})

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

    @property
    def start(self) -> NoReturn:
        """Refuse, as ``start`` was that of release 1."""
        raise AttributeError("StatedDevice.start: since release 2 write `vibrator` and `sudden`")

    @property
    def stated_start(self) -> dict[str, float | str]:
        """Quantities that state its start, as ``changed`` takes them."""
        speed = SUDDEN if self.sudden else self.quantities.get(SPEED)
        stated = {SPEED: speed, "vibrator": self.vibrator}
        return {name: each for name, each in stated.items() if each is not None}

    def changed(self, **changes: float | str) -> "StatedDevice":
        """Return the device with other values and the same tolerances.

        Numbers are in SI units; a text has a unit, and may state another tolerance.

        Quantities that the new values replace, such as ``materials``, go with their tolerances.

        Raises:
            ValueError: an unknown quantity, or a text that is no amount.
        """
        for name in changes:
            if name != "vibrator":
                check_quantity(name)
        check_centre(self.quantities, changes)
        vibrator, sudden = read_start(with_changes(self.stated_start, changes))
        changed = by_quantity(amounts_of(changes, self.quantities.get("frequency")))
        replaced = replaced_by(changes) | ({SPEED} if sudden else set())
        merged: dict[str, Any] = {
            part: {n: v for n, v in getattr(self, part).items() if n not in replaced} | values
            for part, values in changed.items()
        }
        materials = None if "materials" in replaced else self.materials
        all_changes: dict[str, object] = {**self.changes, **changes}
        kept = kept_amplitude(self.quantities, self.written, changes)
        notes = tuple(dict.fromkeys([*self.notes, *kept]))
        unknown = {n: v for n, v in self.unknown.items() if n not in {*replaced, *changes}}
        merged |= {"vibrator": vibrator, "sudden": sudden, "unknown": unknown}
        return replace(self, **merged, materials=materials, changes=all_changes, notes=notes)

    def run_settings(self, settings: Settings, units: Units) -> Settings:
        """Return ``settings`` with what the device states of its runs, in its ``units``.

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
    def needed_in_part(self) -> str:
        """Words on the lines that a device known in part needs, and that its file does not have."""
        is_missing = {
            "approach_speed: 10 mm/s": not self.sudden and "approach_speed" not in self.quantities,
            "vibrator: running (or still)": not self.sudden and self.vibrator is None,
            "gripper_tilt: 0 ± 0.1 deg": GRIPPER_TILT not in self.quantities,
            "contact_stiffness: 1 MN/m (or materials and edge_radius)": not self.base_is_stated,
        }
        lines = "; ".join(line for line, is_so in is_missing.items() if is_so)
        words = "for a share of what is possible, add these lines, or ranges of them below unknown"
        return f"{words}: {lines}" if lines else ""

    def warn(self, at: Mapping[str, float] | None = None) -> None:
        """Warn of what is doubtful, or of what is doubtful only with the values ``at`` of axes."""
        found = self.doubts
        if at is not None:
            there = self.changed(**at).doubts
            words = (
                f"{n} = {value:.4g} {unit_of(n)}".removesuffix(" 1") for n, value in at.items()
            )
            place = ", ".join(words)
            found = [f"at {place}: {doubt}" for doubt in there if doubt not in found]
        for doubt in found:
            warnings.warn(f"{self.source}: {doubt}", DoubtWarning, stacklevel=3)

    @property
    def fixture(self) -> float:
        """Stiffness in N/m in series with the base; infinite where none is stated."""
        return self.quantities.get("fixture_stiffness", math.inf)

    @property
    def doubts(self) -> list[str]:
        """Lines on values that are possible but probably not meant."""
        found = doubts({**self.values, **self.quantities}, self.device, self.shape)
        drive = of_vibrator(self.units.amplitude, self.quantities["frequency"])
        for name in (each for each in OF_VIBRATOR if each in self.limits):
            if drive[name] > self.limits[name]:
                found.append(f"the vibration exceeds the vibrator's limit of {name}")
        if self.stated_shape is None:
            found.append(
                "shape is not stated: taken as round, a peg in a round hole; state shape: round, "
                "or shape: square for a plane part beside a slot"
            )
        bare = {
            n: (value, unit_of(n)) for n, value in self.quantities.items()
            if n not in self.written and isinstance(self.changes.get(n, ""), str)
        }  # fmt: skip
        if len(bare) < len(self.written):
            found += without_unit(bare, found)
        if GRIPPER_TILT in bare and GRIPPER_TILT in self.tolerances:
            found += wide_tilts(self.tolerances[GRIPPER_TILT].end(0.0))
        return [*self.notes, *found]


def kept_amplitude(
    values: Mapping[str, float], written: Mapping[str, tuple[str, float]], changes: Iterable[str]
) -> tuple[str, ...]:
    """Return a line if an amplitude is stated by an acceleration, and the frequency is changed."""
    unit, one = written.get("amplitude", ("", 1.0))
    if not unit or "frequency" not in changes or "amplitude" in changes:
        return ()
    try:
        read_amount("amplitude", f"1 {unit}", "m")
    except ValueError:  # a velocity or an acceleration
        kept, at = values["amplitude"], values["frequency"]
        words = f"amplitude = {kept / one:.4g} {unit} is {1e3 * kept:.4g} mm at {at:.4g} Hz, and "
        words += "stays so at another frequency: set amplitude, too, if the acceleration is to stay"
        return (words,)
    return ()


def amounts_of(
    given: Mapping[str, object], frequency: float | None, diameter: float | None = None
) -> dict[str, Amount]:
    """Return the amounts of what is ``given`` besides ``BESIDES``; the play of a fit, too."""
    amounts = {
        name: read_amount(name, value, unit_of(name), frequency)
        for name, value in given.items()
        if name not in BESIDES and value != SUDDEN
    }
    if given.get("fit") is not None:
        low, high = play_of(given["fit"], diameter or 0.0)
        if low + high <= 0.0:
            raise ValueError(
                f"fit = {given['fit']!r}: has a play of {1e6 * low:.3g} to {1e6 * high:.3g} µm, an "
                "interference or none for half of the pairs: it is not modelled; state a fit with "
                "play, such as H7/g6, or the play of your parts, such as play: 0.01 mm ± 0.005 mm"
            )
        half = Tolerance("uniform", 0.5 * (high - low))
        amounts["play"] = Amount(0.5 * (low + high), half, "mm", 1e-3)
    return amounts


def by_quantity(amounts: Mapping[str, Amount]) -> dict[str, dict[str, Any]]:
    """Return values, tolerances and units of amounts, as ``StatedDevice`` has them."""
    return {
        "quantities": {name: each.value for name, each in amounts.items()},
        "tolerances": {n: each.tolerance for n, each in amounts.items() if each.tolerance},
        "written": {n: (each.unit, each.one) for n, each in amounts.items() if each.unit},
    }
