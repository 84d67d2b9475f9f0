"""Located switches: convergence with the tolerance, and a second solver with its own switches."""

from functools import partial
from math import cos, sin

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from model import PRINTED_CONTACTS, Batch, Outcome, Reason, Settings, align, simulate
from model.runs.batch import each_by_itself, side_by_side
from model.solver.record import Ending
from model.solver.tableaux import DOP853, DORMAND_PRINCE

# One run for each kind of switch; what it goes through is asserted in the tests.
RUNS = {
    "sliding only": {"friction": 0.0, "frequency": 1.0},
    "reversals and sticking": {"frequency": 0.5, "press_force": 2.0},
    "hops, reversals, sticking": {"frequency": 10.0},
    "hops and corner landings": {
        "press_force": 0.5,
        "frequency": 1.7,
        "tilt_stiffness": 46.0,
        "friction": 0.05,
    },
}
each_run = pytest.mark.parametrize("changes", RUNS.values(), ids=list(RUNS))


def test_the_runs_go_through_what_they_are_named_after(device):
    runs = {name: simulate(device.replace(**changes)) for name, changes in RUNS.items()}
    assert all(run.outcome is Outcome.ALIGNED for run in runs.values())
    assert runs["sliding only"].separations == runs["sliding only"].sticking_share == 0
    assert runs["reversals and sticking"].separations == 0
    assert 0.2 < runs["reversals and sticking"].sticking_share < 0.8
    assert runs["hops, reversals, sticking"].separations >= 5
    assert runs["hops, reversals, sticking"].sticking_share > 0.1
    p = device.replace(**RUNS["hops and corner landings"])
    without = simulate(p, scene=PRINTED_CONTACTS)  # what the print does not have: B1 on the base
    assert without.reason is Reason.UNDECLARED_CONTACT
    assert without.time[-1] < runs["hops and corner landings"].tau_align


def alignment_times(batch, tolerance, method):
    """Of one run of each set: `align` would run again what is less accurate than promised."""
    settings = Settings(method=method)
    engine = side_by_side if method is DOP853 else each_by_itself
    endings = engine(settings)(batch.constants(settings.readings), np.full(len(batch), tolerance))
    return endings[:, Ending._fields.index("tau_align")]


@each_run
@pytest.mark.parametrize("method", [DOP853, DORMAND_PRINCE], ids=lambda method: method.name)
def test_alignment_time_converges_with_the_tolerance_across_switches(device, changes, method):
    # An error per step proportional to the tolerance gives a global error proportional to it, if no
    # switch adds an error of its own; steps shrink with tol^(1/order), with which the sum of local
    # errors loses that much at most: slopes of 7/8 and 4/5 to 1. The error of one run scatters by a
    # factor of ten, since steps and switches fall differently on each other at each tolerance: the
    # geometric mean over 32 neighbouring devices does not. A switch located only to a step's length
    # would show 1/8 or 1/5, one located on a dense output of lower order 1/2 to 7/8. Above 1e-8 a
    # step is so long, for the contact's own period of 0.6, that errors are not asymptotic yet.
    p = device.replace(**changes)
    near = Batch.of(p, press_force=p.press_force * np.linspace(0.97, 1.03, 32))
    exact = align(near, tolerance=1e-14)
    assert set(exact.outcome) == {Outcome.ALIGNED}
    tolerances, means = 10.0 ** -np.arange(8.0, 12.1, 0.5), []
    for tolerance in tolerances:
        error = np.abs(alignment_times(near, tolerance, method) - exact.tau_align)
        means.append(np.exp(np.mean(np.log(np.maximum(error, 1e-15)))))  # rounding of times
    slope = np.polyfit(np.log(tolerances), np.log(means), 1)[0]
    assert 0.8 < slope < 1.2
    assert means[-1] < 1e-9


def test_a_short_release_is_met_at_every_tolerance(device):
    # At ν = 0.5 the side contact's load goes below zero for 0.003 only, a tenth of a step, anywhere
    # in it. Missed, it would move the alignment time by 3.6e-8 whatever the tolerance.
    p = device.replace(frequency=0.5)
    exact = simulate(p, tolerance=1e-14)
    tolerances = 10.0 ** -np.arange(8.5, 13.0, 0.1)
    runs = [simulate(p, tolerance=tolerance) for tolerance in tolerances]
    assert {run.switches for run in runs} == {exact.switches}
    errors = [abs(run.tau_align - exact.tau_align) for run in runs]
    # Errors are of the order of the tolerance (0.1 to 1 times it), never of another.
    assert (np.array(errors) < 10 * tolerances + 1e-12).all()


# --------------------------------------------------------------------------- a second solver


class Second:
    """The A1 contact of physics.md as its own hybrid system, solved by scipy with its own events.

    States of the normal force: "on", "off" (in flight) or "released"; friction: sign of the slip,
    or 0 for sticking. Good for runs that meet neither A2 nor the flat base.
    """

    def __init__(self, parameters):
        self.p = parameters
        self.rest_x = parameters.misalignment if parameters.rest_x is None else parameters.rest_x

    def contact(self, z):
        p = self.p
        e_t, e_n = np.array([cos(z[2]), sin(z[2])]), np.array([-sin(z[2]), cos(z[2])])
        r = np.array([p.slot_half_width - z[0], -z[1]])
        u = z[3:5] + z[5] * np.array([-r[1], r[0]])
        d = p.half_height + r @ e_n
        load = p.contact_stiffness * d - p.contact_damping * (u @ e_n)
        return e_t, e_n, r, d, load, u @ e_t

    def acceleration(self, time, z, n, friction):
        """(ẍ, ÿ, φ̈) for normal force n and friction T at the edge."""
        p = self.p
        e_t, e_n, r, *_ = self.contact(z)
        force = n * e_n + friction * e_t
        return np.array(
            [
                force[0] - p.lateral_damping * z[3] - p.lateral_stiffness * (z[0] - self.rest_x),
                force[1] - p.axial_damping * z[4] - (z[1] - p.half_height) - p.press_force
                - sin(p.frequency * time + p.phase),
                (r[0] * force[1] - r[1] * force[0] - p.tilt_damping * z[5]
                 - p.tilt_stiffness * z[2]) / p.inertia,
            ]
        )  # fmt: skip

    def slip_acceleration(self, time, z, n, friction):
        """d(u·e_t)/dτ, differentiated by hand: u·e_t = v·e_t - φ̇ r·e_n."""
        e_t, e_n, r, *_ = self.contact(z)
        a = self.acceleration(time, z, n, friction)
        v, w = z[3:5], z[5]
        r_n_rate = -v @ e_n - w * (r @ e_t)
        return a[:2] @ e_t + w * (v @ e_n) - a[2] * (r @ e_n) - w * r_n_rate

    def sticking(self, time, z, n):
        """T that cancels the slip acceleration, which is linear in T."""
        without, unit = (self.slip_acceleration(time, z, n, t) for t in (0.0, 1.0))
        return -without / (unit - without)

    def forces(self, time, z, state, slides):
        if state != "on":
            return 0.0, 0.0
        n = self.contact(z)[4]
        return n, -slides * self.p.friction * n if slides else self.sticking(time, z, n)

    def rate(self, time, z, state, slides):
        return np.concatenate(
            [z[3:], self.acceleration(time, z, *self.forces(time, z, state, slides))]
        )

    def decide(self, time, z):
        """Friction of a contact at rest: sticking if the force suffices, else the drive's way."""
        n = self.contact(z)[4]
        if n > 0.0 and abs(self.sticking(time, z, n)) <= self.p.friction * n:
            return 0
        return int(np.sign(self.slip_acceleration(time, z, n, 0.0)))

    def events(self, state, slides):
        """{name: function}, each falling through zero where its event happens."""
        p = self.p

        def margin(time, z):
            n, friction = self.forces(time, z, "on", 0)
            return p.friction * n - abs(friction)

        found = {"aligned": lambda _, z: p.half_width - self.contact(z)[2] @ self.contact(z)[0]}
        if state == "on":
            found["load"] = lambda _, z: self.contact(z)[4]
            if slides:
                found["slip"] = lambda _, z: slides * self.contact(z)[5]
            else:
                found["break"] = margin
        elif state == "released":
            found["gap"] = lambda _, z: self.contact(z)[3]
            found["reload"] = lambda _, z: -self.contact(z)[4]
        else:
            found["touch"] = lambda _, z: -self.contact(z)[3]
        return found

    def align(self, horizon=50.0):
        """(τ of alignment, names of the events met)."""
        p = self.p
        r_x = p.slot_half_width - p.misalignment
        y = (p.half_height - r_x * sin(p.initial_tilt)) / cos(p.initial_tilt)
        time, z = 0.0, np.array([p.misalignment, y, p.initial_tilt, 0.0, 0.0, 0.0])
        state, slides, met = "on", self.decide(0.0, z), []
        while time < horizon:
            functions = self.events(state, slides)
            for event in functions.values():
                event.terminal, event.direction = True, -1
            solution = solve_ivp(
                partial(self.rate, state=state, slides=slides), (time, horizon), z,
                method="DOP853", rtol=1e-10, atol=1e-11, first_step=1e-4,
                events=list(functions.values()),
            )  # fmt: skip
            which = next(i for i, times in enumerate(solution.t_events) if times.size)
            name = list(functions)[which]
            met.append(name)
            time, z = solution.t[-1], solution.y[:, -1]
            if name == "aligned":
                corner_y = z[1] - p.half_width * sin(z[2]) - p.half_height * cos(z[2])
                assert corner_y < 0.0  # B2 is in the slot: no jump beside it
                return time, met
            if name == "load":
                state = "released" if self.contact(z)[3] > 0.0 else "off"
            elif name == "gap":
                state = "off"
            elif name in ("reload", "touch"):
                state, slides = "on", int(np.sign(self.contact(z)[5]))
            elif name == "slip":
                slides = self.decide(time, z)
            else:
                slides = -int(np.sign(self.sticking(time, z, self.contact(z)[4])))
        raise AssertionError("no alignment before the horizon")


SECOND_RUNS = {
    "slides one way": ({"friction": 0.1, "frequency": 1.0, "initial_tilt": 0.2}, set()),
    "reversals and sticking": (RUNS["reversals and sticking"], {"slip", "break"}),
    "hops": ({"frequency": 10.0}, {"slip", "break", "load", "touch"}),
}


@pytest.mark.parametrize(("changes", "kinds"), SECOND_RUNS.values(), ids=list(SECOND_RUNS))
def test_a_second_solver_with_its_own_switches_agrees(device, changes, kinds):
    p = device.replace(**changes)
    run = simulate(p, tolerance=1e-12)
    assert run.state[run.time <= run.tau_align, 2].min() > 0.0  # B1 never on the flat
    assert not run.side_force.any()  # nor A2 on the side
    tau, met = Second(p).align()
    if kinds:
        assert kinds <= set(met)
    else:
        assert met == ["aligned"]
    # rtol 1e-10 on values of order 1 to 10, and an amplification by contacts of order 10, which
    # tau_error shows too for a run at that tolerance.
    assert tau == pytest.approx(run.tau_align, abs=2e-9)
