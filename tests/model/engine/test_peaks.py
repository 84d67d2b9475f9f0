"""Largest forces and tilts on stiff bases: the same at every tolerance.

The oscillation of such a base decays, steps grow to several of its radians, and only a remainder of
it at the tolerance is left. Each set here once had a force wrong by a factor of up to 10⁵.
"""

import numpy as np
import pytest

from model.engine.results import RunResult
from model.runs.engine import engine_for
from vibralign import INSERTION, Batch, Settings, simulate

# A shaft on a steel base at rest, in which Newton's iteration for a peak ran out of the step.
SHAFT = {
    "half_width": 43.596571428721035, "half_height": 139.50902857190732, "clearance": 0.002,
    "misalignment": 1.6040000399515324, "initial_tilt": 0.003, "inertia": 7135.086946970001,
    "lateral_stiffness": 0.1, "tilt_stiffness": 24481.35770292186,
    "lateral_damping": 0.06407761394086826, "axial_damping": 0.18307889697390933,
    "tilt_damping": 2227.0139314345756, "contact_stiffness": 1e6,
    "contact_damping": 323.76640555692546, "friction": 0.14547424223273991,
    "press_force": 2.169314033375487, "frequency": 12.69823339599731, "phase": 5.890486225480862,
    "rest_x": None, "rest_y": None, "rest_tilt": 0.0,
}  # fmt: skip
# A block on a hard base.
BLOCK = {
    "half_width": 13.5, "half_height": 32.1, "inertia": 568.0, "contact_stiffness": 6.27e7,
    "contact_damping": 14300.0, "tilt_stiffness": 353.0, "tilt_damping": 131.0,
    "lateral_stiffness": 0.494, "lateral_damping": 0.0511, "axial_damping": 0.134,
    "friction": 0.493, "press_force": 0.353, "frequency": 0.556, "clearance": 0.00524,
    "misalignment": 0.475, "initial_tilt": 0.00044, "phase": 1.91, "rest_tilt": 0.002,
}  # fmt: skip
# A block that tilts over level.
LEVEL = {
    "half_width": 22.089062195350714, "half_height": 98.34946890215669,
    "inertia": 4361.130767640286, "contact_stiffness": 3025692.998311886,
    "contact_damping": 674.2424402358737, "tilt_stiffness": 12731.786237657969,
    "tilt_damping": 390.1743086410597, "lateral_stiffness": 0.20233922762810838,
    "lateral_damping": 0.08977427971820949, "axial_damping": 0.23445375501168844,
    "friction": 0.10344023634214278, "press_force": 1.6387455472026133,
    "frequency": 1.372104742065615, "clearance": 0.00501320147653233,
    "misalignment": 0.45018960629313826, "initial_tilt": 0.00011399440608044657,
    "phase": 2.7826313827867137, "rest_tilt": 0.0,
}  # fmt: skip
# Set, horizon, largest force at a tolerance of 1e-12.
RUNS = {"shaft": (SHAFT, 53.0, 2.963774), "block": (BLOCK, 0.4, 1.329384),
        "level": (LEVEL, 8.0, 2.964241)}  # fmt: skip


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize("name", RUNS)
def test_largest_force_on_a_stiff_base(device, name, tolerance):
    changes, horizon, force = RUNS[name]
    settings = Settings(scene=INSERTION, horizon=horizon)
    rows = settings.rows(Batch.of(device.replace(**changes)))
    found = RunResult(*engine_for(settings)(rows, np.array([tolerance]))[0])
    assert found.contact_force_max == pytest.approx(force, rel=5e-3)


def test_forces_of_a_trajectory_on_a_stiff_base(device):
    run = simulate(device.replace(**BLOCK), scene=INSERTION, horizon=0.4, tolerance=1e-6)
    assert run.contact_force.max() <= 1.005 * RUNS["block"][2]


def test_largest_force_between_samples(device):
    # On a soft base steps are long, and a peak between two samples is up to 1e-3 above them.
    batch = Batch.of(device, press_force=np.linspace(0.5, 8.0, 12))
    settings = Settings(horizon=30.0)
    rows = settings.rows(batch)
    loose, tight = (
        RunResult(*engine_for(settings)(rows, np.full(len(rows), tolerance)).T)
        for tolerance in (1e-8, 1e-13)
    )
    assert np.abs(loose.contact_force_max / tight.contact_force_max - 1.0).max() < 1e-7
    assert np.abs(loose.tilt_max / tight.tilt_max - 1.0).max() < 1e-6
