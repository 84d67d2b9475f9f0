"""Runs of the independent solution: events and transitions up to alignment.

It shares no code with ``model`` but the class ``Parameters``. Events are located on the dense
output of scipy's DOP853, and the state at an event is integrated anew. It is slow. insertion.py
continues runs in the slot.
"""

import itertools
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import DOP853, solve_ivp

from model.physics.parameters import Parameters
from verification.independent.crossings import Function, first_event
from verification.independent.motion import (
    LEFT,
    RIGHT,
    Body,
    Device,
    Mode,
    State,
    body,
    descend,
    highest,
)

SMALLEST_TOLERANCE = 2.3e-14  # scipy raises a smaller rtol to 100 units in the last place
_ABSOLUTE = 1e-2  # scipy's atol over its rtol
_AT_REST = 1e-11  # a slip below this is none
_NO_LOAD = 1e-11  # a load, friction force or slip acceleration below this is none
FLAT = 1e-8  # a part tilted by less rests on its edge
RESTS = 1e-3  # speed and acceleration of a part at rest; as in physics/approach.py
MOMENT = 1e-5  # time ahead at which friction without load is decided
_FIRST_STEP = 1e-3
_MOST_EVENTS = 100_000
_CONTACTS = "face", "side", "corner", "right_side", "right_wall", "left_wall"


class Solution(NamedTuple):
    """Result of a run.

    ``ending`` is "aligned", "horizon", or the event at which the part left the scene. ``tau`` is
    the alignment time, NaN without an alignment; ``events`` are in order of time; ``state`` is that
    at the end, shape (6,).
    """

    ending: str
    time: float
    tau: float
    events: tuple[str, ...]
    state: State


def _with(mode: Mode, what: str, state: str) -> Mode:
    """Return the mode with one contact in ``state``; a corner that opens loses its offset."""
    if what == "corner" and state == "off":
        mode = replace(mode, offset=0.0)
    changes: dict[str, Any] = {what: state}
    return replace(mode, **changes)


class Run:
    """A run of a device through its modes."""

    def __init__(self, device: Device, tolerance: float, start: str = "simultaneous") -> None:
        self.device, self.tolerance, self.start = device, tolerance, start
        if start == "simultaneous" and device.p.initial_tilt < 0.0:
            raise ValueError(
                f"initial_tilt = {device.p.initial_tilt!r}: must be >= 0 for the independent "
                "solution, which starts on the edge"
            )

    def functions(self, mode: Mode) -> dict[str, Function]:
        """Return the event functions of the mode by name, positive while it holds."""
        d = self.device
        found: dict[str, Function] = {}

        def add(name: str, function: Callable[[Any, State, Body], Any]) -> None:
            found[name] = lambda time, z: function(time, z, body(z))

        def contact(name: str) -> None:
            state = getattr(mode, name)
            if state == "on":
                add(f"{name} load", lambda _t, _z, at: d.touch(name, mode, at).load)
            elif state == "released":
                add(f"{name} gap", lambda _t, _z, at: d.touch(name, mode, at).depth)
                add(f"{name} reload", lambda _t, _z, at: -d.touch(name, mode, at).load)

        for name in _CONTACTS:
            contact(name)
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

    def _add_corner(self, side: int, name: str, faced: bool, mode: Mode, add: Any) -> None:
        d = self.device

        def beside(at: Body) -> tuple[Any, Any]:
            corner = d.corner(side, at)
            return d.l - side * corner.real, corner.imag

        def lands(_time: Any, z: State, at: Body) -> Any:
            place = complex(side * d.a, -d.b) * at.along
            rising = (at.velocity + 1j * at.turn * place).imag
            return highest(*beside(at), side * z[2] + FLAT, rising)

        if side == RIGHT or mode.side == "off":  # else B2 came through the slot's wall
            add(f"{name} lands", lands)
        if not faced:
            add(f"{name} wall", lambda _t, z, at: highest(*beside(at), -side * z[2] - FLAT))

    def _add_friction(self, mode: Mode, found: dict[str, Function]) -> None:
        mu = self.device.p.friction
        if mu == 0.0 or "friction_law" in self.device.printed:
            return
        pressing = mode.supported, mode.beside
        for i, name in enumerate(("slip", "side slip")):
            if not pressing[i]:
                continue

            def margin(time: Any, z: State, i: int = i) -> Any:
                _, _, groups, frictions, _ = self.device.rates(time, z, mode)
                touches, _, slides, load = groups[i]
                return slides * touches[0].slip if slides else mu * load - abs(frictions[i])

            found[name] = margin

    def continued(self, _time: float, _z: State, _mode: Mode) -> Mode | str:
        """Return the mode in which a run goes on after alignment, or its end."""
        return "aligned"

    def end_at_horizon(self, _z: State, _mode: Mode) -> str:
        """Return the name of the end of a run that reaches the horizon."""
        return "horizon"

    def begin(self) -> tuple[State, Mode]:
        """Return the state at the start and its mode, and set the drive."""
        d, p = self.device, self.device.p
        if self.start == "simultaneous":
            z = np.array([p.misalignment, d.height(p.initial_tilt), p.initial_tilt, 0.0, 0.0, 0.0])
            return z, self.decided(0.0, z, Mode(), True, False)
        y, velocity = descend(d, self.start == "running")
        return np.array([p.misalignment, y, p.rest_tilt, 0.0, velocity, 0.0]), Mode(face="off")

    def stop(self, time: float, end: float, *, waits: bool) -> float:
        """Return the time of the next stop: end of the ramp, look for rest, or of the run."""
        ramp = self.device.drive.reaches
        if time < ramp:
            return min(ramp, end)
        looks = math.floor((time - ramp) / (2.0 * math.pi) + 1e-9) + 1
        return min(ramp + looks * 2.0 * math.pi, end) if waits else end

    def rests(self, time: float, z: State, mode: Mode) -> bool:
        """Return whether no point of the part moves, or is about to."""
        rate = np.abs(self.device.derivative(time, z, mode))
        arms = np.array([1.0, 1.0, self.device.a + self.device.b])
        return max(rate[:3] @ arms, rate[3:] @ arms) <= RESTS

    def run(self, horizon: float) -> Solution:
        """Run from the start to the end; after alignment the horizon begins anew.

        Of a part that is lowered, time counts from the first touch, and from the onset of the
        vibration if it waits for rest.
        """
        z, mode = self.begin()
        stage = "vibrates" if self.start == "simultaneous" else "descends"
        time, tau, end = 0.0, math.nan, horizon + self.device.drive.reaches
        met: list[str] = []
        muted = ""
        while len(met) < _MOST_EVENTS:
            began, stop = time, self.stop(time, end, waits=stage == "waits")
            name, time, z = self.segment(time, z, mode, stop, muted)
            if not name:
                if time >= end:
                    return Solution(self.end_at_horizon(z, mode), time, tau, tuple(met), z)
                muted = ""
                if stage == "waits" and self.rests(time, z, mode):
                    drive = self.device.drive.later(time)
                    self.device.drive = drive._replace(size=1.0, phase=self.device.p.phase)
                    stage, time, tau, end = "vibrates", 0.0, tau - time, horizon
                    mode = self._next(time, z, mode, mode)
                continue
            met.append(name)
            after = self.after(name, time, z, mode)
            if after == "aligned":
                if math.isnan(tau):
                    tau, end = time, time + horizon
                after = self.continued(time, z, mode)
            if isinstance(after, str):
                return Solution(after, time, tau, tuple(met), z)
            muted = name if time == began and after == mode else ""
            mode = after
            if stage == "descends" and (mode.supported or mode.beside):
                stage = "vibrates" if self.start == "running" else "waits"
                drive = self.device.drive = self.device.drive.later(time)
                time, end = 0.0, horizon + drive.reaches
        return Solution("endless", time, tau, tuple(met), z)

    def segment(
        self, time: float, z: State, mode: Mode, end: float, muted: str
    ) -> tuple[str, float, State]:
        """Integrate in one mode; return (name of the event or "" at ``end``, time, state)."""

        def derivative(t: float, y: State) -> State:
            return self.device.derivative(t, y, mode)

        # The absolute tolerance is smaller, because positions, tilts and rates are small beside 1.
        options = {"rtol": self.tolerance, "atol": _ABSOLUTE * self.tolerance}
        solver = DOP853(
            derivative, time, z, end, first_step=min(_FIRST_STEP, end - time), **options
        )
        while solver.status == "running":
            before = solver.y.copy()
            message = solver.step()
            if solver.status == "failed":
                raise ArithmeticError(f"the independent solution fails: {message}")
            sol = solver.dense_output()
            found = first_event(self.functions(mode), sol, solver.t_old, solver.t, muted)
            muted = ""
            if found is None:
                continue
            name, met = found
            if met <= solver.t_old:
                return name, solver.t_old, before
            state = solve_ivp(
                derivative, (solver.t_old, met), before, method="DOP853", **options
            ).y[:, -1]
            # One step of Newton's method removes the error of the dense output.
            function, near = self.functions(mode)[name], 1e-4 * (solver.t - solver.t_old)
            slope = float(function(met + near, sol(met + near)) - function(met, sol(met))) / near
            move = -float(function(met, state)) / slope if slope else 0.0
            if abs(move) < near:
                met, state = met + move, state + move * derivative(met, state)
            return name, met, state
        return "", end, solver.y

    def decided(
        self, time: float, z: State, mode: Mode, support_rests: bool, side_rests: bool
    ) -> Mode:
        """Return the mode with friction that fits the slips; at rest the first that is consistent.

        ``support_rests`` and ``side_rests`` are True if the contact stuck before.
        """
        on_edge = "on" in (mode.face, mode.right_side)
        on_corner = "on" in (mode.corner, mode.right_wall)
        at_corner = on_corner and (mode.slip_at_corner or not on_edge)
        at_wall = mode.left_wall == "on" and (mode.slip_at_wall or mode.side != "on")
        # Where the friction moves from edge to corner or back, a contact that stuck may slip.
        support_rests = support_rests and at_corner == mode.slip_at_corner
        side_rests = side_rests and at_wall == mode.slip_at_wall
        mode = replace(mode, slip_at_corner=at_corner, slip_at_wall=at_wall)
        mu = self.device.p.friction
        if "friction_law" in self.device.printed:
            return replace(mode, slides=-1, side_slides=-1)
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
            holds, begins = True, {}
            if unloaded:  # no friction without load: decide by the state a moment ahead
                at, now = z.copy(), time + MOMENT
                rate = self.device.derivative(time, z, trial)
                at[:3] += MOMENT * (z[3:] + 0.5 * MOMENT * rate[3:])
                at[3:] += MOMENT * rate[3:]
                *_, frictions, drives = self.device.rates(time, z, trial)
                for i, slide in enumerate((slides, side_slides)):
                    if not rests[i] or groups[i][3] > _NO_LOAD:
                        continue
                    if not slide:
                        holds &= abs(frictions[i]) <= _NO_LOAD
                    elif abs(drives[i]) > _NO_LOAD:
                        begins[i] = drives[i]  # friction may grow to stop it within the moment
            _, _, ahead, frictions, drives = self.device.rates(now, at, trial)
            drives |= begins
            for i, slide in enumerate((slides, side_slides)):
                if rests[i] and slide:
                    holds &= drives[i] * slide >= 0.0
                elif rests[i]:
                    load = ahead[i][3]
                    holds &= load > 0.0 and abs(frictions[i]) <= mu * load
            if holds:
                return trial
        raise ArithmeticError("no friction fits the slips")

    def _next(self, time: float, z: State, was: Mode, mode: Mode) -> Mode:
        """Return ``decided``; a contact that sticks goes on sticking if friction suffices."""
        rests = was.slides == 0 and was.supported
        return self.decided(time, z, mode, rests, was.beside and was.side_slides == 0)

    def after(self, name: str, time: float, z: State, mode: Mode) -> Mode | str:
        """Return the mode that follows an event, or the ending."""
        d, at = self.device, body(z)
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
            state = "released" if d.touch(what, mode, at).depth > 0.0 else "off"
        bottom, _, _, top = d.depths(LEFT, at)
        if name == "side end" and top < bottom:
            return "other face"
        changed = _with(mode, what, state)
        return (
            changed if event == "gap" and what != "corner" else self._next(time, z, mode, changed)
        )

    def _after_meeting(
        self, event: str, side: int, time: float, z: State, mode: Mode
    ) -> Mode | str:
        """Return the mode after an edge enters the part or a corner lands, or the ending."""
        d, at = self.device, body(z)
        elsewhere = mode.edge != side and (mode.face != "off" or mode.corner != "off")
        bottom, left, right, top = d.depths(side, at)
        if event == "lands":
            met = replace(mode, edge=side, corner="on", offset=-d.corner(side, at).imag)
            met = self._loaded("corner", met, at)
        elif bottom <= min(left, right, top):
            met = self._loaded("face", replace(mode, edge=side, face="on"), at)
        elif side == LEFT and left <= min(right, top):
            met = self._loaded("side", replace(mode, side="on"), at)
            return self._next(time, z, mode, met)
        else:
            return "other face"
        return "both sides" if elsewhere else self._next(time, z, mode, met)

    def _loaded(self, what: str, mode: Mode, at: Body) -> Mode:
        """Return the mode after a touch, which does not press at once under the printed damping."""
        pulls = "contact_damping_law" in self.device.printed and self.device.p.contact_damping > 0.0
        return (
            _with(mode, what, "released")
            if pulls and self.device.touch(what, mode, at).load <= _NO_LOAD
            else mode
        )

    def _after_slip(self, beside: bool, time: float, z: State, mode: Mode) -> Mode:
        sticks = (mode.side_slides if beside else mode.slides) == 0
        if sticks:
            frictions = self.device.rates(time, z, mode)[3]
            sign = -int(np.sign(frictions[beside]))
            return replace(mode, side_slides=sign) if beside else replace(mode, slides=sign)
        support = mode.slides == 0 and mode.supported
        other = mode.beside and mode.side_slides == 0
        return self.decided(time, z, mode, support or not beside, other or beside)


def solve(
    parameters: Parameters,
    horizon: float,
    tolerance: float = SMALLEST_TOLERANCE,
    start: str = "simultaneous",
) -> Solution:
    """Solve the alignment scene for one parameter set, with the consistent variant.

    Args:
        parameters: the device, tilted toward the slot at a simultaneous start, or upright.
        horizon: latest time, dimensionless; longer by the time for which the holder is lowered.
        start: "simultaneous", "running" or "still".
        tolerance: scipy's rtol; its atol is a hundredth of it. The default is scipy's smallest.

    Raises:
        ArithmeticError: scipy fails, or no friction force is consistent.
        ValueError: the part starts tilted away from the slot, on its corner.
    """
    return Run(Device(parameters), tolerance, start).run(horizon)
