"""Reading of device files: YAML with a line NAME: VALUE for each quantity."""

import contextlib
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import yaml

from model.physics.parameters import Shape, check_name
from model.physics.units import device
from model.sweeps import files
from vibralign.device.amounts import Amount, read_amount, read_range
from vibralign.device.approach import SPEED, SUDDEN, read_start, with_changes
from vibralign.device.base import BASE
from vibralign.device.instead import (
    INSTEAD,
    check_centre,
    parameter_of,
    replaced_by,
    with_parameters,
)
from vibralign.device.limits import read_limits
from vibralign.device.mouth import as_parameters
from vibralign.device.plausibility import DeviceError, NoNeedError, check_press
from vibralign.device.quantities import unit_of
from vibralign.device.stated import StatedDevice, amounts_of, by_quantity, kept_amplitude
from vibralign.device.unknown import SAMPLES, SECTION, read_unknown


def load_device(
    path: Path | str, changes: Mapping[str, object] | None = None, *, needless: bool = False
) -> StatedDevice:
    """Return the device in a YAML file as it is stated.

    Args:
        path: file with lines NAME: VALUE, in SI units or with units.
        changes: quantities by name that replace the file's, numbers in SI units or text with
            units. A changed quantity keeps its tolerance unless the text states another; a play
            keeps that of the file's fit. A stiffness or damping also replaces the quantities
            from which it would be computed, a damping ratio the damping; if such a quantity has a
            tolerance, the change has to state one.
        needless: return a device that needs no alignment as stated, too.

    Raises:
        DeviceError: the file cannot be read, is not YAML, breaks a rule, or makes no sense.
        NoNeedError: it is a valid device, which needs no alignment, unless ``needless``.
    """
    path, changes, missing = Path(path), {} if changes is None else changes, ""
    replaced = replaced_by(changes) | ({SPEED} if changes.get(SPEED) == SUDDEN else set())
    whole = _mapping(path)
    mapping = {name: value for name, value in whole.items() if name not in replaced}
    lost = {name: value for name, value in whole.items() if name in replaced}
    try:
        check_centre(whole, changes)
        ranges, samples, mapping = _unknown(path, mapping, changes)
        at, now = _one_frequency(mapping), {**mapping, **changes}
        vibrator, sudden = read_start(with_changes(mapping, changes))
        amounts = amounts_of(mapping, at, _diameter(now))
        others = amounts_of(changes, _one_frequency(now), _diameter(now))
        others = _with_tolerance_of_fit(others, lost, _diameter(now))
        parts, changed = by_quantity(amounts), by_quantity(others)
        both: dict[str, Any] = {part: each | changed[part] for part, each in parts.items()}
        stated = StatedDevice(
            source=path,
            **both,
            materials=None if now.get("materials") is None else _text("materials", now),
            free={n: read_range(n, v, unit_of(n), at) for n, v in _section("free", mapping)},
            limits=read_limits(_section("limits", mapping)),
            changes=dict(changes),
            vibrator=vibrator,
            sudden=sudden,
            stated_shape=now.get("shape"),
            notes=kept_amplitude(parts["quantities"], parts["written"], changes),
            unknown=ranges,
            samples=samples,
        )
        _check_shape(now.get("shape"))
        missing = f"; {stated.needed_in_part}" if ranges and stated.needed_in_part else ""
        # Refuses unknown and missing quantities, before anything is computed from them.
        known = {n: v for n, v in stated.quantities.items() if n not in BASE}
        device(as_parameters(with_parameters(known)))
        with contextlib.suppress(NoNeedError):
            stated.admitted({})
        _check_tolerances(stated)
        _check_ranges("free", stated.free, stated)
        _check_ranges("unknown", stated.unknown, stated)
    except ValueError as error:
        raise DeviceError(f"{path}: {error}{missing}") from None
    if stated.needless and not needless:
        raise NoNeedError(f"{path}: {stated.needless}")
    return stated


def _with_tolerance_of_fit(
    changed: Mapping[str, Amount], lost: Mapping[str, object], diameter: float | None
) -> dict[str, Amount]:
    """Return amounts of changes, a play with the tolerance of the fit that it replaces.

    Args:
        changed: the amounts of the changes.
        lost: quantities of the file that these replace.
        diameter: in m, None if none is stated.

    Raises:
        ValueError: a change would lose the tolerance of another quantity for the same parameter.
    """
    found = dict(changed)
    for name in lost.keys() & {"fit", *INSTEAD, *(each.parameter for each in INSTEAD.values())}:
        amounts = dict[str, Amount]()
        with contextlib.suppress(ValueError):  # what is replaced may break its rule
            amounts = amounts_of({name: lost[name]}, None, diameter)
        for stated, each in amounts.items():
            twins = [n for n in found if parameter_of(n) == parameter_of(stated)]
            for twin in (n for n in twins if each.tolerance and not found[n].tolerance):
                if twin != stated:
                    raise ValueError(
                        f"{twin}: would replace {name} of the file without its tolerance: state "
                        f"one, as in {twin}=VALUE ± WIDTH, or set {stated}"
                    )
                found[twin] = replace(found[twin], tolerance=each.tolerance)
    return found


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
    except (ValueError, yaml.YAMLError, TypeError, RecursionError) as error:
        reason = " ".join(str(error).split())
        raise DeviceError(f"{path}: cannot be read as YAML: {reason}") from None
    if not isinstance(mapping, dict):
        raise DeviceError(f"{path}: must be lines of NAME: VALUE, one for each quantity")
    return {str(name): value for name, value in mapping.items()}


def _unknown(
    path: Path, mapping: Mapping[str, Any], changes: Mapping[str, object]
) -> tuple[dict[str, Any], Path | None, dict[str, Any]]:
    """Return the ranges of a file, the file of samples, and the lines with the ranges' middles."""
    others = {n: v for n, v in mapping.items() if n not in (SECTION, SAMPLES)}
    free = dict(_section("free", mapping))
    given = _section(SECTION, mapping)
    blank = {name for name, _ in given} | replaced_by(name for name, _ in given)
    others = {n: v for n, v in others.items() if v is not None or n not in blank}
    ranges, middles = read_unknown(given, others, free, changes, unit_of)
    samples = None
    if mapping.get(SAMPLES) is not None:
        samples = path.parent / _text(SAMPLES, mapping)
        if not samples.is_file():
            raise ValueError(f"{SAMPLES}: {samples}: is not there: run vibralign calibrate again")
        if not ranges:
            samples = None
    return ranges, samples, others | middles


def _one_frequency(mapping: Mapping[str, Any]) -> float | None:
    """Return the frequency in Hz, or None if it is missing, free or has a tolerance."""
    if mapping.get("frequency") is None or "frequency" in dict(_section("free", mapping)):
        return None
    amount = read_amount("frequency", mapping["frequency"], "Hz")
    return None if amount.tolerance else amount.value


def _diameter(given: Mapping[str, object]) -> float | None:
    """Return the stated diameter in m, None without."""
    for name, times in (("diameter", 1.0), ("half_width", 2.0)):
        if given.get(name) is not None:
            return times * read_amount(name, given[name], "m").value
    return None


def _check_shape(given: object) -> None:
    try:
        check_name("round" if given is None else str(given), get_args(Shape), "shape")
    except ValueError as error:
        words = "of any part with flat sides write square, and as diameter its width along the "
        raise ValueError(f"{error} ({words}misalignment)") from None


def _text(name: str, given: Mapping[str, Any]) -> str:
    if not isinstance(given[name], str):
        raise ValueError(f"{name} = {given[name]!r}: must be a text")  # noqa: TRY004  (of a file)
    return given[name]


def _section(name: str, mapping: Mapping[str, Any]) -> Iterable[tuple[str, object]]:
    given = mapping.get(name, {})
    if not isinstance(given, dict):
        raise ValueError(f"{name} = {given!r}: must be lines of NAME: VALUE")  # noqa: TRY004
    return [(str(key), value) for key, value in given.items()]


def _check_tolerances(stated: StatedDevice) -> None:
    """Refuse tolerances without effect, or within which the part starts wholly beside the hole."""
    if "phase" in stated.tolerances:
        raise ValueError("phase: a tolerance has no effect, since every phase is tried")
    for name, each in stated.tolerances.items():
        if each.end(stated.quantities[name]) == 0.0:
            raise ValueError(f"{name}: a tolerance in per cent of 0 has no effect: write an amount")
    worst = {}
    narrow = dict.fromkeys(("half_width", "diameter", "clearance", "play"), -1.0)
    for name, sign in {**narrow, "misalignment": 1.0}.items():
        if name in stated.tolerances:
            own = stated.quantities[name]
            spread = stated.tolerances[name].around(own)
            spread *= 1.0 if stated.tolerances[name].kind == "uniform" else 4.0
            worst[name] = max(own + sign * spread, 1e-3 * own)
    try:
        stated.at(worst)
    except ValueError as error:
        raise ValueError(f"at the ends of the tolerances: {error}") from None


def _check_ranges(
    section: str, ranges: Mapping[str, tuple[float, float]], stated: StatedDevice
) -> None:
    """Refuse ranges with an end that breaks the rule of its quantity."""
    for name, ends in ranges.items():
        for end in ends:
            try:
                check_press(end if name == "press_force" else 1.0)
                stated.at({name: end})
            except ValueError as error:
                raise ValueError(f"{section}: {error}") from None
