"""Independent solutions that are kept: found by what is solved and by the code that solves it."""

import numpy as np
import pytest

from study.config import load_study, study_path
from verification.bench.plans import independent_cases
from verification.independent import solve, stored
from verification.independent.stored import key_of, solution_of

CASES = independent_cases(load_study(study_path()))


def test_the_study_finds_all_its_solutions():
    keys = {name: key_of(*case) for name, case in CASES.items()}
    assert len(set(keys.values())) == len(CASES)
    missing = [name for name, key in keys.items() if key not in stored._stored()]
    assert not missing, "python -m verification.bench.store"


@pytest.mark.parametrize(
    "name",
    ["bouncing", *(pytest.param(each, marks=pytest.mark.nightly) for each in CASES)],
)
def test_what_is_kept_is_what_is_solved(name):
    kept, anew = solution_of(*CASES[name]), solve(*CASES[name])
    assert kept.ending == anew.ending
    # Another machine rounds otherwise; a state may gain from it what a stiff base multiplies.
    np.testing.assert_allclose(kept.state, anew.state, rtol=0.0, atol=1e-8)
    np.testing.assert_allclose([kept.time, kept.tau], [anew.time, anew.tau], rtol=1e-9)


def test_another_case_or_other_code_has_another_key(monkeypatch):
    device, horizon = CASES["bouncing"]
    keys = {key_of(device, horizon), key_of(device.replace(friction=0.2), horizon)}
    keys.add(key_of(device, 2.0 * horizon))
    monkeypatch.setattr(stored, "_code", lambda: "other code")
    assert len({*keys, key_of(device, horizon)}) == 4
