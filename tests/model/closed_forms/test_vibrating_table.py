"""A ball on a vibrating table: where it bounces once a period, and where that motion doubles.

In the frame of a table at sin(θ)/ν², θ = ντ + θ0, the ball feels the force sin θ besides its weight
g: the excitation of this model with g the press force and Γ = 1/g the table's acceleration over the
weight. The axial spring is weak against both at a high frequency, by some 5/ν². A ball that meets
the table once in T = 2π/ν leaves it and comes back with gT/2, so that the table's velocity cos θ/ν
is gT/2 (1 - e)/(1 + e), or cos θ = Γ0/Γ with Γ0 = π(1 - e)/(1 + e). Source of the stability limit:
P. J. Holmes, The dynamics of repeated impacts with a sinusoidally vibrating table, J. Sound Vib. 84
(1982) 173-189; with e in this form: J. M. Luck and A. Mehta, Phys. Rev. E 48 (1993) 3988.
"""

from math import acos, cos, pi, sqrt

import numpy as np
import pytest

from model.physics.modes import OPEN, START
from tests.model.closed_forms.restitution import damping_for

E, FREQUENCY, STIFFNESS = 0.5, 100.0, 1e11
PERIOD = 2 * pi / FREQUENCY
EXISTS = pi * (1 - E) / (1 + E)
DOUBLES = sqrt(EXISTS**2 + (2 * (1 + E**2) / (1 + E) ** 2) ** 2)


@pytest.fixture(scope="module")
def impacts(stepped_run, ball, at):
    """Times of the impacts in periods, from a start on the periodic orbit or, without one, near."""

    def make(acceleration, periods, stiffness=STIFFNESS):
        gravity = 1 / acceleration
        phase = acos(min(EXISTS / acceleration, 1.0))
        up = gravity * PERIOD / 2 - cos(phase) / FREQUENCY
        p = ball(
            stiffness, damping_for(E, stiffness), press_force=gravity, frequency=FREQUENCY,
            phase=phase + pi,
        )  # fmt: skip
        run = stepped_run(p, at(0.0, up), START._replace(face=OPEN), horizon=periods * PERIOD)
        return np.array([step.end for step in run.impacts()]) / PERIOD, phase

    return make


def test_the_limits_are_the_published_ones():
    assert pytest.approx(1.0472, abs=5e-5) == EXISTS
    assert pytest.approx(1.5268, abs=5e-5) == DOUBLES


@pytest.mark.parametrize("acceleration", [1.02 * EXISTS, 1.2, 0.98 * DOUBLES])
def test_between_the_limits_it_bounces_once_a_period(impacts, acceleration):
    times, phase = impacts(acceleration, 200)
    last = times[-20:]
    assert np.diff(last) == pytest.approx(1.0, abs=1e-6)
    # The impact's phase: contacts last π/√k, a share 1.5e-4 of the period, and the spring takes a
    # share 5e-5 of the weight; cos θ is that near, θ as near as 1/sin θ lets it.
    found = (2 * pi * last + phase) % (2 * pi)
    assert np.cos(found) == pytest.approx(EXISTS / acceleration, abs=2e-3)


def test_below_the_first_limit_no_such_motion_exists(impacts):
    # It loses the rhythm, comes to rest on the table and is thrown off anew as that outruns it:
    # long flights, then short ones. (Softer, since at rest every step follows the base.)
    times, _ = impacts(0.98 * EXISTS, 12, stiffness=1e8)
    flights = np.diff(times)
    assert len(flights) > 15
    assert flights.min() < 0.1


def test_above_the_second_limit_long_and_short_bounces_alternate(impacts):
    times, _ = impacts(1.02 * DOUBLES, 400)
    flights = np.diff(times[-20:])
    assert flights[2:] == pytest.approx(flights[:-2], abs=1e-5)
    assert flights[1:] + flights[:-1] == pytest.approx(2.0, abs=1e-5)
    assert np.abs(flights - 1.0).min() > 0.01
