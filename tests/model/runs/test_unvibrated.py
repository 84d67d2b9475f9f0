"""The unvibrated control of a run: how it ends, against one run of `simulate`."""

import numpy as np
import pytest

from model.events.outcomes import Outcome, Unvibrated
from model.physics.parameters import Batch, Parameters
from model.runs.settings import Settings
from model.runs.simulate import simulate
from model.runs.unvibrated import unvibrated
from vibralign.device.paper import baseline

SETTINGS = Settings(tolerance=1e-8)
# Pressed lightly it rests on the edge, harder it falls in, on a soft tilt spring it topples.
CASES = {
    "rests": (Unvibrated.RESTS, {"press_force": 1.0, "tilt_stiffness": 15.0}),
    "aligns": (Unvibrated.ALIGNS, {"press_force": 4.0, "tilt_stiffness": 22.0, "friction": 0.05}),
    "leaves": (Unvibrated.LEAVES, {"press_force": 8.0, "tilt_stiffness": 5.0, "friction": 0.3}),
}
DEVICE = baseline().replace(
    half_width=0.8891, half_height=4.067, inertia=5.863, lateral_stiffness=0.359,
    lateral_damping=0.1073, axial_damping=0.1553, tilt_damping=0.2513,
)  # fmt: skip


def of(**changes: float) -> Parameters:
    return DEVICE.replace(**changes)


@pytest.mark.parametrize("name", CASES)
def test_the_control_ends_as_a_run_without_excitation_does(name: str) -> None:
    expected, changes = CASES[name]
    found = unvibrated(Batch.stack([of(**changes)]), SETTINGS)
    assert found.outcome[0] == expected
    run = simulate(of(**changes, frequency=0.0), SETTINGS)
    assert (run.outcome == Outcome.ALIGNED) == (expected == Unvibrated.ALIGNS)
    if expected == Unvibrated.RESTS:
        assert run.outcome == Outcome.SETTLED
        assert found.tilt[0] == pytest.approx(run.state[-1, 2], abs=1e-6)
        assert found.tilt[0] > 0.0
    else:
        assert np.isnan(found.tilt[0])


def test_frequency_and_phase_do_not_matter_and_the_order_of_sets_is_kept() -> None:
    sets = [of(**changes) for _, changes in CASES.values()]
    other = [each.replace(frequency=1.0 + i, phase=0.3 * i) for i, each in enumerate(sets)]
    found = unvibrated(Batch.stack([*sets, *other[::-1]]), SETTINGS)
    assert found.outcome.tolist()[:3] == [expected for expected, _ in CASES.values()]
    np.testing.assert_array_equal(found.outcome[:3], found.outcome[:2:-1])
    np.testing.assert_array_equal(found.tilt[:3], found.tilt[:2:-1])


def test_a_part_that_leans_on_both_edges_does_not_rest_on_one() -> None:
    """Of the settled runs those with the side pressing on A2 are told apart by the contact."""
    forces = np.linspace(0.5, 8.0, 16)
    batch = Batch.of(of(tilt_stiffness=5.0, friction=0.3), press_force=forces)
    found = unvibrated(batch, SETTINGS)
    for row, outcome in enumerate(found.outcome):
        run = simulate(batch[row].replace(frequency=0.0), SETTINGS)
        jammed = run.outcome == Outcome.SETTLED and run.side_force[-1] > 0.0
        if jammed:
            assert outcome == Unvibrated.LEAVES
