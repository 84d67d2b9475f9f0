"""Settings of a run: accepted and refused values."""

import math

import pytest

from vibralign import INSERTION, SUSPENDED, Settings, Variants, simulate


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"horizon": 0.0}, r"horizon = 0\.0: must be a finite number > 0"),
        ({"horizon": float("inf")}, "horizon = inf: must be a finite number > 0"),
        ({"horizon": float("nan")}, "horizon = nan: must be a finite number > 0"),
        ({"tolerance": 0.0}, r"tolerance = 0\.0: must be between 1e-14 and 1e-2"),
        ({"tolerance": 0.1}, r"tolerance = 0\.1: must be between 1e-14 and 1e-2"),
        ({"tolerance": float("nan")}, "tolerance = nan: must be between"),
        ({"max_evaluations": 0}, "max_evaluations = 0: must be finite and >= 1"),
        ({"max_evaluations": math.inf}, "max_evaluations = inf: must be finite and >= 1"),
        ({"start": "press"}, "unknown start 'press'. Did you mean 'pressed'"),
        ({"start": "pressed", "scene": SUSPENDED}, "'suspended' must declare edge_on_face"),
        ({"start": "pressed", "readings": Variants.printed()}, "needs the consistent readings"),
        ({"insertion_depth": 0.2}, r"insertion_depth = 0\.2: .* insertion scene"),
        ({"scene": INSERTION, "insertion_depth": 0.0}, "insertion_depth"),
        ({"scene": INSERTION, "insertion_depth": -1.0}, "insertion_depth"),
        ({"scene": INSERTION, "insertion_depth": float("nan")}, "insertion_depth"),
    ],
)
def test_values_outside_their_range_are_refused(device, change, message):
    with pytest.raises(ValueError, match=message):
        Settings(**change)
    with pytest.raises(ValueError, match=message):
        simulate(device, **change)


@pytest.mark.parametrize(
    ("change", "kind"),
    [
        ({"readings": "printed"}, "Readings"),
        ({"scene": "alignment"}, "Scene"),
    ],
)
def test_values_of_another_type_are_refused(change, kind):
    with pytest.raises(TypeError, match=f"must be a {kind}"):
        Settings(**change)


def test_an_unknown_setting_is_refused(device):
    with pytest.raises(ValueError, match=r"unknown setting 'tolerence'\. Did you mean 'tolerance'"):
        simulate(device, tolerence=1e-8)


def test_changes_stand_over_given_settings(device):
    settings = Settings(horizon=2.0, tolerance=1e-8)
    changed = simulate(device, settings, horizon=0.5)
    assert changed.time[-1] == 0.5
    whole = simulate(device, Settings(horizon=0.5, tolerance=1e-8))
    assert changed.rhs_evaluations == whole.rhs_evaluations
