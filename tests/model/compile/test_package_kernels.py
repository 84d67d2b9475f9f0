"""Every kernel of physics and events gives the same numbers as its own Python, to the bit."""

import importlib
import inspect
import pkgutil
from collections.abc import Callable
from types import FunctionType
from typing import Any, NamedTuple

import numpy as np
import pytest

import model.events
import model.physics
from model.compile.kernels import marks_of, python_of
from model.events.event_functions import NEVER
from model.events.insertion import INSERTION
from model.events.kernels import MOST_SAMPLES, in_kernels
from model.events.scenes import ALIGNMENT, Declared
from model.events.sources import ContactState, CornerPositions
from model.events.steady_state import HISTORY, LONGEST_PERIOD
from model.events.table import GROUPS, OF_FRICTION, OF_LENGTH, OF_LOAD
from model.physics.contacts import Contact
from model.physics.modes import Mode
from model.physics.motion import Forces, Motion, Support
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, STATE_SIZE, State
from model.physics.parameters import PARAMETER_NAMES, Constants, Given
from model.physics.rest import _Balance
from tests.model.compile.sources import bits, exactly
from vibralign import Batch, Parameters, Variants

DRAWS = 24
LEAST = 4  # draws at least for which Python finds numbers
EVENTS = tuple(
    in_kernels(scene, is_round).events
    for is_round in (False, True)
    for scene in (ALIGNMENT, INSERTION)
)
Place = NamedTuple("Place", [(name, float) for name in dict.fromkeys(  # type: ignore[misc]
    (*CornerPositions._fields, *ContactState._fields, *Motion._fields)
)])  # fmt: skip


def _stated(kernel: Any) -> Any:
    """Return the Python of a kernel; of one for each edge, the function that is called with it."""
    python = python_of(kernel)
    cells = dict(zip(python.__code__.co_freevars, python.__closure__ or (), strict=True))
    is_of_edge = [*inspect.signature(python).parameters] == ["arguments"]
    return cells["function"].cell_contents if is_of_edge else python


def _kernels() -> dict[str, Any]:
    found = {}
    for package in (model.physics, model.events):
        for each in pkgutil.iter_modules(package.__path__, f"{package.__name__}."):
            for name, value in vars(importlib.import_module(each.name)).items():
                if not isinstance(value, FunctionType) or marks_of(value) is None:
                    continue
                if _stated(value).__module__ == each.name:
                    found[f"{each.name.removeprefix('model.')}.{name}"] = value
    return found


KERNELS = _kernels()


_VARIANTS = Variants.printed(), Variants.consistent()


class Draw:
    """Random arguments, by the names of parameters: methods that are called as these."""

    def __init__(self, device: Parameters, seed: int) -> None:
        self.rng, self.device = np.random.default_rng(seed), device
        self.scene_events = EVENTS[seed % len(EVENTS)]

    def number(self) -> float:
        return float(self.rng.choice([0.0, 1.0, self.rng.normal(), self.rng.uniform(-1e-3, 1e-3)]))

    def numbers(self, made_by: Any) -> Any:
        return made_by(*(float(each) for each in self.rng.normal(size=len(made_by._fields))))

    def one_of(self, *values: Any) -> Any:
        return values[self.rng.integers(len(values))]

    def q(self) -> State:
        low, high = [-1.5, 3.0, -0.9, -2.0, -2.0, -1.0], [1.5, 5.0, 0.9, 2.0, 2.0, 1.0]
        if self.rng.random() < 0.3:
            low[3:], high[3:] = [-1e-9] * 3, [1e-9] * 3
        return State(*self.rng.uniform(low, high).tolist())

    def p(self) -> Constants:
        constants = self.scene_events.constants
        variants = Variants.consistent() if constants.is_round else self.one_of(*_VARIANTS)
        lowered = self.device.replace(approach_speed=0.1)
        row = Batch.stack([lowered]).constants(variants)[0]
        found = constants(*(row * self.rng.uniform(0.8, 1.25, row.size)).tolist())
        return found._replace(ramp_end=self.number())

    def given(self) -> Given:
        values = (getattr(self.device, name) for name in PARAMETER_NAMES)
        return Given(*(float("nan") if each is None else float(each) for each in values))

    def mode(self) -> Mode:
        states, flag = (0, 1, 2), lambda: self.one_of(False, True)
        return Mode(
            self.edge(), self.one_of(*states), self.one_of(*states), self.one_of(0.0, 0.01), flag(),
            self.slip_state(), self.one_of(*states), self.slip_state(), flag(), flag(),
            self.one_of(*states), flag(), flag(),
        )  # fmt: skip

    def edge(self) -> float:
        return float(self.one_of(RIGHT_EDGE, LEFT_EDGE))

    def slip_state(self) -> int:
        return int(self.rng.integers(-1, 2))

    def flag(self) -> bool:
        return bool(self.rng.random() < 0.5)

    def events(self) -> Any:
        return self.scene_events

    def each(self) -> Any:
        return self.scene_events.all[self.which()]

    def which(self) -> int:
        return int(self.rng.integers(self.scene_events.count))

    def vector(self) -> State:
        found = np.array(self.numbers(State)) * 10.0 ** self.rng.integers(-5, 1)
        return State(*found.tolist())

    def states(self) -> Any:
        around = np.linspace(1.0, 2.0, STATE_SIZE) * np.ones((HISTORY, 1))
        size = 10.0 ** self.rng.integers(-6, 0)
        return around + size * 0.5 ** np.arange(HISTORY)[:, None] * self.rng.normal(size=STATE_SIZE)

    def lowest(self) -> Any:
        values = self.rng.uniform(0.0, 1.0, (LONGEST_PERIOD, self.scene_events.count))
        return np.where(values < 0.2, NEVER, values)


_NUMBERS = (
    "time", "along", "c", "x", "y", "tilt", "moment", "depth", "closing_rate", "load",
    "load_of_edge", "gap", "before",
    "corner_load", "drive", "side_drive", "g11", "g12", "g21", "g22", "s", "share", "first",
    "angle", "value", "friction", "least", "noise", "period", "cycles", "touching",
)  # fmt: skip
_FLAGS = (
    "in_slot", "slip_at_corner", "support_sticks", "side_sticks", "support_at_rest", "side_at_rest",
    "vibrates",
)  # fmt: skip
_SAME = {
    "direction": "edge", "side": "edge", "r": "vector", "reach": "vector", "d0": "vector",
    "d1": "vector", "d2": "vector", "support_slip": "slip_state", "side_slip": "slip_state",
    **dict.fromkeys(_NUMBERS, "number"), **dict.fromkeys(_FLAGS, "flag"),
}  # fmt: skip


def _row(draw: Draw) -> tuple[float, ...]:
    return tuple(draw.number() for _ in range(3))


def _contact(draw: Draw) -> Contact:
    rows = {name: _row(draw) for name in ("normal", "tangent", "slip_row")}
    return draw.numbers(Contact)._replace(**rows)


def _support(draw: Draw) -> Support:
    return draw.numbers(Support)._replace(tangent=_row(draw), slip_row=_row(draw))


def _forces(draw: Draw) -> Forces:
    return draw.numbers(Forces)._replace(support=_support(draw), side=_support(draw))


_OTHERS: dict[str, Callable[[Draw], Any]] = {
    "at": lambda draw: draw.numbers(Place),
    "closest": lambda draw: draw.lowest()[0],
    "contact": _contact,
    "corner": _contact,
    "corner_state": lambda draw: draw.one_of(0, 1, 2),
    "count": lambda draw: int(draw.rng.integers(1, 60)),
    "declared": lambda draw: Declared(*(draw.flag() for _ in Declared._fields)),
    "edge_state": lambda draw: draw.one_of(0, 1, 2),
    "forces": _forces,
    "kind": lambda draw: draw.one_of(OF_LENGTH, OF_LOAD, OF_FRICTION),
    "n": lambda draw: int(draw.rng.integers(1, LONGEST_PERIOD + 1)),
    "name": lambda draw: draw.one_of(*Constants._fields),
    "out": lambda _: np.zeros(MOST_SAMPLES),
    "outcome": lambda draw: draw.one_of(0, 1, 2),
    "group": lambda draw: draw.one_of(*GROUPS),
    "quantities": lambda draw: tuple(draw.number() for _ in range(4)),
    "reason": lambda draw: draw.one_of(0, 1, 2),
    "row": _row,
    "slip_row": _row,
    "sample": lambda draw: draw.rng.choice([NEVER, 0.5, -0.25], MOST_SAMPLES),
    "state": lambda draw: draw.one_of(0, 1, 2),
    "admitted": lambda draw: draw.one_of(1e-3, 1.0),
    "y of record_state": lambda draw: np.array(draw.q()),
    "edge of _with_corner": _support,
    "at of _slides_by": lambda draw: draw.numbers(_Balance),
    "at of _advanced": lambda draw: draw.numbers(Motion),
    "tangent": _row,
}


def parameters_of(kernel: Any) -> list[str]:
    """Return the names of a kernel's parameters; of one for each edge, those of its function."""
    stated = _stated(kernel)
    names = [*inspect.signature(stated).parameters][stated is not python_of(kernel) :]
    return [name.removeprefix("_") for name in names]


def drawn(draw: Draw, kernel: Any, name: str) -> Any:
    """Draw an argument of a kernel."""
    other = _OTHERS.get(f"{name} of {python_of(kernel).__name__}", _OTHERS.get(name))
    if other is not None:
        return other(draw)
    return getattr(draw, _SAME.get(name, name))()


@pytest.mark.parametrize("name", KERNELS)
def test_a_kernel_computes_what_its_python_computes(name: str, device: Parameters) -> None:
    kernel, found = KERNELS[name], 0
    native = exactly(kernel)
    for seed in range(DRAWS):
        mine, pythons = (
            [drawn(draw, kernel, each) for each in parameters_of(kernel)]
            for draw in (Draw(device, seed), Draw(device, seed))
        )
        with np.errstate(all="ignore"):
            try:
                expected = kernel(*pythons)
            except (ZeroDivisionError, ValueError):
                continue  # a number in machine code: infinity or NaN
        found += 1
        assert bits(native(*mine)) == bits(expected), mine
        assert bits(tuple(mine)) == bits(tuple(pythons))
    assert found >= LEAST
