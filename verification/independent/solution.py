"""An independent solution of the alignment runs, to judge the integrator by.

Everything is stated a second time and shares no code with the floors below: vectors of the plane
are complex numbers, a contact is a place, a tangent and a normal, forces act by r × F, and the
switches are sought on scipy's dense output of its own DOP853, in many more places of a step, and
then met by integrating up to them. Slow, and for the consistent readings and the full scene only.
"""

import cmath
import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853, solve_ivp
from scipy.optimize import brentq, minimize_scalar

from model.physics.parameters import Parameters

State = NDArray[np.float64]
Function = Callable[[Any, State], Any]

SMALLEST_TOLERANCE = 2.3e-14  # scipy raises a smaller rtol to 100 units in the last place
RIGHT, LEFT = 1, -1
_NODES = np.concatenate([[0.0, 1e-4, 1e-3, 1e-2], np.linspace(1 / 24, 1.0, 24)])
_ON_ZERO = 1e-9  # a switching function below this, as a mode begins, begins on its zero
_AT_REST = 1e-11
_NO_LOAD = 1e-11
_FLAT = 1e-8  # a part tilted by less stands on its edge
_MOMENT = 1e-5
_FIRST_STEP = 1e-3
_MOST_SWITCHES = 100_000


class Solution(NamedTuple):
    """How the independent run ended: ``tau`` of alignment, else NaN; the switches met, in order.

    ``ending`` is "aligned", "horizon", or what made the part leave the scene.
    """

    ending: str
    time: float
    tau: float
    switches: tuple[str, ...]


@dataclass(frozen=True)
class _Mode:
    """States of the contacts, "on", "off" or "released", and signs of the slips (0 sticks)."""

    edge: int = RIGHT
    face: str = "on"
    corner: str = "off"
    offset: float = 0.0
    slip_at_corner: bool = False
    slides: int = 0
    side: str = "off"
    side_slides: int = 0


class _Body(NamedTuple):
    """Mass centre, direction e_t of the bottom face, their rates: complex, scalar or arrays."""

    centre: Any
    along: Any
    velocity: Any
    turn: Any


class _Touch(NamedTuple):
    """A contact: place from the centre, tangent, normal, load, slip, and its free drift."""

    place: Any
    tangent: Any
    normal: Any
    depth: Any
    load: Any
    slip: Any
    drift: Any


def _dot(a: Any, b: Any) -> Any:
    return (a * b.conjugate()).real


def _body(z: State) -> _Body:
    if z.ndim == 1:
        x, y, tilt, x_rate, y_rate, turn = z.tolist()
        return _Body(complex(x, y), cmath.exp(1j * tilt), complex(x_rate, y_rate), turn)
    return _Body(z[0] + 1j * z[1], np.exp(1j * z[2]), z[3] + 1j * z[4], z[5])


def _with(mode: _Mode, what: str, state: str) -> _Mode:
    """The mode with another state of one contact; a corner that opens forgets its offset."""
    if what == "face":
        return replace(mode, face=state)
    if what == "side":
        return replace(mode, side=state)
    return replace(mode, corner=state, offset=mode.offset if state != "off" else 0.0)


def _highest(*values: Any) -> Any:
    return np.maximum.reduce(values)


class _Device:
    """The device and its equations of motion, for one parameter set."""

    def __init__(self, p: Parameters) -> None:
        self.p = p
        self.a, self.b, self.l = p.half_width, p.half_height, p.slot_half_width
        self.rest = complex(
            p.misalignment if p.rest_x is None else p.rest_x,
            p.half_height if p.rest_y is None else p.rest_y,
        )

    def edge_on_face(self, side: int, at: _Body) -> _Touch:
        place = side * self.l - at.centre
        return self._touch(at, place, at.along, 1j * at.along, self.b, fixed_to_base=True)

    def edge_on_side(self, at: _Body) -> _Touch:
        place = -self.l - at.centre
        return self._touch(at, place, 1j * at.along, at.along, self.a, fixed_to_base=True)

    def corner_on_flat(self, side: int, at: _Body, offset: float) -> _Touch:
        place = complex(side * self.a, -self.b) * at.along
        depth = -at.centre.imag - offset
        return self._touch(at, place, 1.0 + 0.0j, 1.0j, depth, fixed_to_base=False)

    def _touch(
        self, at: _Body, place: Any, tangent: Any, normal: Any, reach: Any, *, fixed_to_base: bool
    ) -> _Touch:
        """Depth is how far the base's point lies inside; an edge stays while the part moves by."""
        of_part = at.velocity + 1j * at.turn * place
        depth = reach + _dot(place, normal) if fixed_to_base else reach - _dot(place, normal)
        load = self.p.contact_stiffness * depth - self.p.contact_damping * _dot(of_part, normal)
        if fixed_to_base:
            drift = at.turn * (_dot(of_part, 1j * tangent) - _dot(1j * at.velocity, tangent))
        else:
            drift = -at.turn * at.turn * _dot(place, tangent)
        return _Touch(place, tangent, normal, depth, load, _dot(of_part, tangent), drift)

    def corner(self, side: int, at: _Body) -> Any:
        return at.centre + complex(side * self.a, -self.b) * at.along

    def depths(self, side: int, at: _Body) -> tuple[Any, Any, Any, Any]:
        """How deep an edge is behind the bottom, left, right and top face."""
        place = (side * self.l - at.centre) * at.along.conjugate()
        return self.b + place.imag, self.a + place.real, self.a - place.real, self.b - place.imag

    def not_aligned(self, at: _Body) -> Any:
        """Negative with A1 beyond B1 and B2 in the slot."""
        corner = self.corner(LEFT, at)
        return _highest(self.depths(RIGHT, at)[2], -corner.real - self.l, corner.imag)

    def rates(self, time: Any, z: State, mode: _Mode) -> tuple[Any, ...]:
        """(acceleration, angular one, support, side, their frictions, their slip accelerations).

        ``support`` is a list of (contact, share of the friction); the first one's slip counts.
        """
        p, at = self.p, _body(z)
        support = []
        if mode.face == "on":
            support.append(self.edge_on_face(mode.edge, at))
        if mode.corner == "on":
            support.append(self.corner_on_flat(mode.edge, at, mode.offset))
        total = sum(touch.load for touch in support)
        shares = [touch.load / total if len(support) > 1 else 1.0 for touch in support]
        if mode.slip_at_corner:
            support.reverse()
            shares.reverse()
        side = [self.edge_on_side(at)] if mode.side == "on" else []
        beside = side[0].load if side else 0.0
        groups = [
            (support, shares, mode.slides, total),
            (side, [1.0] * len(side), mode.side_slides, beside),
        ]

        spring = self.rest - at.centre
        force = (
            p.lateral_stiffness * spring.real
            - p.lateral_damping * at.velocity.real
            + 1j
            * (
                spring.imag
                - p.axial_damping * at.velocity.imag
                - p.press_force
                - np.sin(p.frequency * time + p.phase)
            )
        )
        moment = p.tilt_stiffness * (p.rest_tilt - z[2]) - p.tilt_damping * at.turn
        frictions: list[Any] = [0.0, 0.0]
        for i, (touches, weights, slides, load) in enumerate(groups):
            frictions[i] = -slides * p.friction * load
            for touch, weight in zip(touches, weights, strict=True):
                push = touch.load * touch.normal + frictions[i] * weight * touch.tangent
                force = force + push
                moment = moment + (touch.place.conjugate() * push).imag

        def slip_rate(i: int, force: Any, moment: Any) -> Any:
            first = groups[i][0][0]
            return _dot(force + 1j * first.place * moment / p.inertia, first.tangent)

        def unit(i: int) -> tuple[Any, Any]:
            touches, weights = groups[i][0], groups[i][1]
            pairs = list(zip(touches, weights, strict=True))
            return (
                sum(weight * touch.tangent for touch, weight in pairs),
                sum(weight * (touch.place.conjugate() * touch.tangent).imag
                    for touch, weight in pairs),
            )  # fmt: skip

        stuck = [i for i in (0, 1) if groups[i][0] and groups[i][2] == 0 and p.friction > 0.0]
        drives = {i: slip_rate(i, force, moment) + groups[i][0][0].drift
                  for i in (0, 1) if groups[i][0]}  # fmt: skip
        if len(stuck) == 1:
            (i,) = stuck
            extra = {i: -drives[i] / slip_rate(i, *unit(i))}
        elif stuck:
            g00, g01 = slip_rate(0, *unit(0)), slip_rate(0, *unit(1))
            g10, g11 = slip_rate(1, *unit(0)), slip_rate(1, *unit(1))
            det = g00 * g11 - g01 * g10
            extra = {
                0: (g01 * drives[1] - g11 * drives[0]) / det,
                1: (g10 * drives[0] - g00 * drives[1]) / det,
            }
        else:
            extra = {}
        for i, friction in extra.items():
            one_force, one_moment = unit(i)
            force = force + friction * one_force
            moment = moment + friction * one_moment
            frictions[i] = frictions[i] + friction
        drives = {i: slip_rate(i, force, moment) + groups[i][0][0].drift for i in drives}
        return force, moment / p.inertia, groups, frictions, drives

    def derivative(self, time: float, z: State, mode: _Mode) -> State:
        force, turn, *_ = self.rates(time, z, mode)
        return np.array([z[3], z[4], z[5], force.real, force.imag, turn])


class _Run:
    """One run of a device: its modes one after the other."""

    def __init__(self, device: _Device, tolerance: float) -> None:
        self.device, self.tolerance = device, tolerance

    def functions(self, mode: _Mode) -> dict[str, Function]:
        """Switching functions of the mode by name, positive while it holds; arrays are fine."""
        d = self.device
        found: dict[str, Function] = {}

        def add(name: str, function: Callable[[Any, State, _Body], Any]) -> None:
            found[name] = lambda time, z: function(time, z, _body(z))

        def contact(name: str, state: str, touch: Callable[[_Body], _Touch]) -> None:
            if state == "on":
                add(f"{name} load", lambda _t, _z, at: touch(at).load)
            elif state == "released":
                add(f"{name} gap", lambda _t, _z, at: touch(at).depth)
                add(f"{name} reload", lambda _t, _z, at: -touch(at).load)

        contact("face", mode.face, lambda at: d.edge_on_face(mode.edge, at))
        contact("side", mode.side, d.edge_on_side)
        contact("corner", mode.corner, lambda at: d.corner_on_flat(mode.edge, at, mode.offset))
        if mode.face != "off":
            add("face end", lambda _t, _z, at: d.depths(mode.edge, at)[1 + (mode.edge == RIGHT)])
            add("face far", lambda _t, _z, at: d.depths(mode.edge, at)[1 + (mode.edge == LEFT)])
        if mode.side != "off":
            add("side end", lambda _t, _z, at: np.minimum(*d.depths(LEFT, at)[::3]))
        if mode.corner != "off":
            add("corner end", lambda _t, _z, at: mode.edge * d.corner(mode.edge, at).real - d.l)
        self._add_friction(mode, found)
        right_face = mode.edge == RIGHT and mode.face != "off"
        left_face = mode.edge == LEFT and mode.face != "off"
        if not right_face:
            add("right enters", lambda _t, _z, at: -np.minimum.reduce(d.depths(RIGHT, at)))
            add("aligned", lambda _t, _z, at: d.not_aligned(at))
        if not left_face and mode.side == "off":
            add("left enters", lambda _t, _z, at: -np.minimum.reduce(d.depths(LEFT, at)))
        for side, name, faced in ((RIGHT, "right", right_face), (LEFT, "left", left_face)):
            if mode.edge == side and mode.corner != "off":
                continue
            self._add_corner(side, name, faced, mode, add)
        add("overturned", lambda _t, z, _at: 0.5 * math.pi - 1e-3 - abs(z[2]))
        return found

    def _add_corner(self, side: int, name: str, faced: bool, mode: _Mode, add: Any) -> None:
        d = self.device

        def beside(at: _Body) -> tuple[Any, Any]:
            corner = d.corner(side, at)
            return d.l - side * corner.real, corner.imag

        def lands(_time: Any, z: State, at: _Body) -> Any:
            place = complex(side * d.a, -d.b) * at.along
            rising = (at.velocity + 1j * at.turn * place).imag
            return _highest(*beside(at), side * z[2] + _FLAT, rising)

        if side == RIGHT or mode.side == "off":  # else B2 has come through the slot's wall
            add(f"{name} lands", lands)
        if not faced:
            add(f"{name} wall", lambda _t, z, at: _highest(*beside(at), -side * z[2] - _FLAT))

    def _add_friction(self, mode: _Mode, found: dict[str, Function]) -> None:
        mu = self.device.p.friction
        if mu == 0.0:
            return
        pressing = (mode.face == "on" or mode.corner == "on", mode.side == "on")
        for i, name in enumerate(("slip", "side slip")):
            if not pressing[i]:
                continue

            def margin(time: Any, z: State, i: int = i) -> Any:
                _, _, groups, frictions, _ = self.device.rates(time, z, mode)
                touches, _, slides, load = groups[i]
                return slides * touches[0].slip if slides else mu * load - abs(frictions[i])

            found[name] = margin

    def first(
        self, sol: Any, start: float, end: float, mode: _Mode, muted: str
    ) -> tuple[str, float] | None:
        """The earliest switch on the dense output ``sol`` between two times.

        The ``muted`` one changed nothing where the mode began: it counts once it has been positive.
        """
        times = start + _NODES * (end - start)
        states = sol(times)
        earliest: tuple[str, float] | None = None
        for name, function in self.functions(mode).items():
            values = function(times, states)
            found = _crossing(partial(_at, function, sol), times, values, name == muted)
            if found is not None and (earliest is None or found < earliest[1]):
                earliest = name, found
        return earliest

    def align(self, horizon: float) -> Solution:
        """Run from the start until the part aligns, leaves the scene, or the horizon is reached."""
        p = self.device.p
        reach = self.device.l - p.misalignment
        y = (self.device.b - reach * math.sin(p.initial_tilt)) / math.cos(p.initial_tilt)
        z = np.array([p.misalignment, y, p.initial_tilt, 0.0, 0.0, 0.0])
        mode, time = self.decided(0.0, z, _Mode(), True, False), 0.0
        met: list[str] = []
        muted = ""
        while len(met) < _MOST_SWITCHES:
            began = time
            name, time, z = self.segment(time, z, mode, horizon, muted)
            if not name:
                return Solution("horizon", time, math.nan, tuple(met))
            met.append(name)
            after = self.after(name, time, z, mode)
            if isinstance(after, str):
                tau = time if after == "aligned" else math.nan
                return Solution(after, time, tau, tuple(met))
            muted = name if time == began and after == mode else ""
            mode = after
        return Solution("endless", time, math.nan, tuple(met))

    def segment(
        self, time: float, z: State, mode: _Mode, end: float, muted: str
    ) -> tuple[str, float, State]:
        """Integrate in one mode up to its switch: (name or "", time, state)."""

        def derivative(t: float, y: State) -> State:
            return self.device.derivative(t, y, mode)

        options = {"rtol": self.tolerance, "atol": self.tolerance}
        solver = DOP853(
            derivative, time, z, end, first_step=min(_FIRST_STEP, end - time), **options
        )
        while solver.status == "running":
            before = solver.y.copy()
            message = solver.step()
            if solver.status == "failed":
                raise ArithmeticError(f"the independent solution fails: {message}")
            sol = solver.dense_output()
            found = self.first(sol, solver.t_old, solver.t, mode, muted)
            muted = ""
            if found is None:
                continue
            name, met = found
            if met <= solver.t_old:
                return name, solver.t_old, before
            state = solve_ivp(
                derivative, (solver.t_old, met), before, method="DOP853", **options
            ).y[:, -1]
            # What the dense output leaves of the switching function: one step of Newton's.
            function, near = self.functions(mode)[name], 1e-4 * (solver.t - solver.t_old)
            slope = float(function(met + near, sol(met + near)) - function(met, sol(met))) / near
            move = -float(function(met, state)) / slope if slope else 0.0
            if abs(move) < near:
                met, state = met + move, state + move * derivative(met, state)
            return name, met, state
        return "", end, solver.y

    def decided(
        self, time: float, z: State, mode: _Mode, support_rests: bool, side_rests: bool
    ) -> _Mode:
        """The mode with friction that fits the slips: at rest the first that is consistent."""
        at_corner = mode.corner == "on" and (mode.slip_at_corner or mode.face != "on")
        # What stuck at one place may slip at the other.
        support_rests = support_rests and at_corner == mode.slip_at_corner
        mode = replace(mode, slip_at_corner=at_corner)
        mu = self.device.p.friction
        if mu == 0.0:
            return mode
        groups = self.device.rates(time, z, mode)[2]
        choices: list[tuple[int, ...]] = []
        rests = []
        for touches, was, rest in (
            (groups[0][0], mode.slides, support_rests),
            (groups[1][0], mode.side_slides, side_rests),
        ):
            resting = bool(touches) and (rest or abs(touches[0].slip) <= _AT_REST)
            rests.append(resting)
            moving = int(np.sign(touches[0].slip)) if touches else was
            choices.append((0, -1, 1) if resting else (moving,))
        unloaded = any(r and groups[i][3] <= _NO_LOAD for i, r in enumerate(rests))
        for slides, side_slides in itertools.product(*choices):
            trial = replace(mode, slides=slides, side_slides=side_slides)
            at, now = z, time
            holds = True
            if unloaded:  # nothing decides yet: look a moment ahead
                at, now = z.copy(), time + _MOMENT
                rate = self.device.derivative(time, z, trial)
                at[:3] += _MOMENT * (z[3:] + 0.5 * _MOMENT * rate[3:])
                at[3:] += _MOMENT * rate[3:]
                frictions = self.device.rates(time, z, trial)[3]
                for i, slide in enumerate((slides, side_slides)):
                    if rests[i] and not slide and groups[i][3] <= _NO_LOAD:
                        holds &= abs(frictions[i]) <= _NO_LOAD  # it holds nothing
            _, _, ahead, frictions, drives = self.device.rates(now, at, trial)
            for i, slide in enumerate((slides, side_slides)):
                if rests[i] and slide:
                    holds &= drives[i] * slide >= 0.0
                elif rests[i]:
                    load = ahead[i][3]
                    holds &= load > 0.0 and abs(frictions[i]) <= mu * load
            if holds:
                return trial
        raise ArithmeticError("no friction fits the slips")

    def _next(self, time: float, z: State, was: _Mode, mode: _Mode) -> _Mode:
        """A contact that sticks goes on sticking if friction still suffices."""
        rests = was.slides == 0 and "on" in (was.face, was.corner)
        return self.decided(time, z, mode, rests, was.side == "on" and was.side_slides == 0)

    def after(self, name: str, time: float, z: State, mode: _Mode) -> _Mode | str:
        """What follows a switch: a mode, or the end's name."""
        d, at = self.device, _body(z)
        if name in ("aligned", "overturned", "left wall", "right wall", "face far"):
            return name
        if name == "face end":
            corner = d.corner(LEFT, at)
            inside = corner.real >= -d.l and corner.imag < 0.0
            return "aligned" if mode.edge == RIGHT and inside else replace(mode, face="off")
        if name in ("slip", "side slip"):
            return self._after_slip(name == "side slip", time, z, mode)
        what, _, event = name.partition(" ")
        if event in ("enters", "lands"):
            return self._after_meeting(event, RIGHT if what == "right" else LEFT, time, z, mode)
        state = {"reload": "on", "gap": "off", "end": "off", "load": "off"}[event]
        if event == "load" and d.p.contact_damping > 0.0:
            touch = {
                "face": lambda: d.edge_on_face(mode.edge, at),
                "side": lambda: d.edge_on_side(at),
                "corner": lambda: d.corner_on_flat(mode.edge, at, mode.offset),
            }[what]()
            state = "released" if touch.depth > 0.0 else "off"
        bottom, _, _, top = d.depths(LEFT, at)
        if name == "side end" and top < bottom:
            return "other face"
        changed = _with(mode, what, state)
        return changed if name in ("face gap", "side gap") else self._next(time, z, mode, changed)

    def _after_meeting(
        self, event: str, side: int, time: float, z: State, mode: _Mode
    ) -> _Mode | str:
        """An edge enters through the face behind which it is least deep, or a corner lands."""
        d, at = self.device, _body(z)
        elsewhere = mode.edge != side and (mode.face != "off" or mode.corner != "off")
        bottom, left, right, top = d.depths(side, at)
        if event == "lands":
            met = replace(mode, edge=side, corner="on", offset=-d.corner(side, at).imag)
        elif bottom <= min(left, right, top):
            met = replace(mode, edge=side, face="on")
        elif side == LEFT and left <= min(right, top):
            return self._next(time, z, mode, replace(mode, side="on"))
        else:
            return "other face"
        return "both sides" if elsewhere else self._next(time, z, mode, met)

    def _after_slip(self, beside: bool, time: float, z: State, mode: _Mode) -> _Mode:
        sticks = (mode.side_slides if beside else mode.slides) == 0
        if sticks:
            frictions = self.device.rates(time, z, mode)[3]
            sign = -int(np.sign(frictions[beside]))
            return replace(mode, side_slides=sign) if beside else replace(mode, slides=sign)
        support = mode.slides == 0 and "on" in (mode.face, mode.corner)
        other = mode.side == "on" and mode.side_slides == 0
        return self.decided(time, z, mode, support or not beside, other or beside)


def _at(function: Function, sol: Any, time: float) -> float:
    return float(function(time, sol(time)))


def _crossing(
    function: Callable[[float], float], times: State, values: State, muted: bool
) -> float | None:
    """The first time at which a sampled function falls through zero."""
    first = 0
    if values[0] <= _ON_ZERO:  # a mode may begin on a zero of its own functions, or beyond it
        if not muted and values[1] < min(values[0], 0.0) and values[2] < values[1]:
            return float(times[0])
        above = np.flatnonzero(values > 0.0)
        if not above.size:
            return None
        first = int(above[0])
    for i in range(first, len(times) - 1):
        low, high = times[i], times[i + 1]
        if values[i + 1] < 0.0:
            return float(brentq(function, low, high, xtol=1e-15, rtol=1e-15))
        if i == first:
            continue
        drop, rise = values[i - 1] - values[i], values[i + 1] - values[i]
        if drop >= 0.0 and rise >= 0.0 and values[i] < drop + rise:
            lowest = minimize_scalar(
                function, bounds=(times[i - 1], high), method="bounded",
                options={"xatol": 1e-3 * (high - low)},
            )  # fmt: skip
            if lowest.fun < 0.0:
                return float(brentq(function, times[i - 1], lowest.x, xtol=1e-15, rtol=1e-15))
    return None


def solve(
    parameters: Parameters, horizon: float, tolerance: float = SMALLEST_TOLERANCE
) -> Solution:
    """The independent solution for one parameter set (consistent readings, alignment scene).

    Args:
        parameters: the device, tilted toward the slot at the start or upright.
        horizon: latest time, dimensionless.
        tolerance: scipy's rtol and atol; by default the smallest rtol that it takes.

    Raises:
        ArithmeticError: scipy gives up, or no friction force is consistent.
        ValueError: a part that starts tilted away from the slot, on its corner.
    """
    if parameters.initial_tilt < 0.0:
        raise ValueError(
            f"initial_tilt = {parameters.initial_tilt!r}: must be >= 0 for the independent "
            "solution, which starts on the edge"
        )
    return _Run(_Device(parameters), tolerance).align(horizon)
