"""Causes of failures in words: that they are true of the run, for both shapes."""

import math
import re
from dataclasses import replace
from pathlib import Path

import pytest

from model.events.outcomes import Outcome, Reason
from model.physics.geometry import crescent
from model.physics.parameters import Batch, RoundConstants
from model.physics.variants import Variants
from model.runs.simulate import simulate_once
from model.sweeps.settings import Ensemble
from vibralign import INSERTION, Settings, load_device
from vibralign.answers.assess import assess
from vibralign.answers.causes import Cause, _lean, cause_of, first_change, waits_in_vain
from vibralign.answers.leeways import Nearest
from vibralign.commands import main as cli

PEG = Path(__file__).resolve().parents[2] / "square" / "peg.yaml"
STIFF = {"contact_stiffness": 4.8e6}
SETTINGS = Settings(scene=INSERTION, tolerance=1e-7, horizon=60.0)


def run_of(shape, **changes):
    settings = replace(SETTINGS, shape=shape)
    return simulate_once(load_device(PEG, STIFF | changes).parameters, settings)


def test_a_part_that_hardly_slips_sticks_on_its_edge_or_on_the_rim():
    square, round_one = run_of("square", friction=0.9), run_of("round", friction=0.4)
    for run, shape, place in ((square, "square", "edge"), (round_one, "round", "rim")):
        words = cause_of(run, shape).words
        assert words.startswith(f"it hardly slips: it sticks on the {place} ")
        assert "never slips" not in words
        share = float(words.partition(f"the {place} ")[2].partition(" %")[0])
        assert share == pytest.approx(100.0 * run.sticking_share, abs=0.06)
    words = cause_of(square, "square").words
    friction = math.degrees(math.atan(0.9))
    assert f"by friction it slides only from {friction:.2g}° on" in words
    assert f"tilted by at most {math.degrees(square.tilt_max):.2g}°" in words


def test_a_round_part_has_a_hole_and_no_slot(capsys):
    run = replace(run_of("square"), outcome=Outcome.LEFT_SCENE, reason=Reason.MOVED_AWAY,
                  tau_align=math.nan)  # fmt: skip
    assert "off the slot's edge, away from the slot" in cause_of(run, "square").words
    assert "off the hole's edge, away from the hole" in cause_of(run, "round").words
    docs = PEG.parents[2] / "docs" / "peg.yaml"
    for device, place in ((PEG, "slot"), (docs, "hole")):
        assert cli.main(["simulate", "--device", str(device)]) == cli.DONE
        assert f"aligned: the part fell into the {place}\n" in capsys.readouterr().out


def test_the_angle_of_a_round_part_is_that_of_the_wedge():
    run = run_of("round", friction=0.4)
    found = _lean(run, "round")
    row = Batch.stack([run.parameters]).constants(Variants.consistent())[0].tolist()
    p = RoundConstants(*row)
    x, y, tilt = run.state[run.state[:, 2].argmax(), :3].tolist()
    s, c = math.sin(tilt), math.cos(tilt)
    at = crescent(x, y, s, c, p)
    lean = math.atan(at.rim_x * s / at.offset)  # (T2)
    wedge = math.hypot(at.offset, p.slot_half_width * s) / math.hypot(at.offset, at.rim_x * s)
    assert found.tilt == pytest.approx(run.tilt_max, rel=1e-3)
    assert found.normal == pytest.approx(lean, rel=1e-9)
    assert found.friction == pytest.approx(math.atan(0.4 * wedge), rel=1e-3)  # (T5)
    assert found.normal > found.tilt  # near the hole, X > p
    assert found.friction > math.atan(0.4)
    assert found.normal < found.friction  # it sticks


@pytest.mark.parametrize(
    ("move", "said"),
    [
        (-0.2, "it has come"), (0.2, "it has moved away from the hole, by"),
        (-3.0, "it has passed the hole's edge by"),
    ],
)  # fmt: skip
def test_a_share_of_the_way_is_between_nothing_and_all(move, said):
    run = run_of("square", friction=0.9)
    state = run.state.copy()
    state[-1, 0] += move
    late = {"outcome": Outcome.HORIZON_REACHED, "reason": Reason.NONE, "sticking_share": 0.5}
    words = cause_of(replace(run, state=state, tau_align=math.nan, **late), "square").words
    assert said in words
    assert not re.search(r"-[\d.]+ %", words)
    assert words.startswith("too slow") == ("it has come" in words)


def test_a_part_that_sticks_or_hardly_moves_is_not_told_to_wait_longer(capsys):
    run = run_of("square", friction=0.9)
    slow = replace(run, outcome=Outcome.HORIZON_REACHED, sticking_share=0.986)
    assert waits_in_vain(slow)
    state = run.state.copy()
    state[-1, 0] -= 0.5 * (run.parameters.slot_half_width + run.parameters.half_width)
    assert not waits_in_vain(replace(slow, state=state))
    sets = ["--set", "friction=0.9", "--set", "contact_stiffness=4.8e6"]
    given = ["--device", str(PEG), *sets, "--horizon", "0.1 s", "--tolerance", "1e-6"]
    assert cli.main(["simulate", *given]) == cli.DONE
    told = capsys.readouterr().out.partition("what to do")[2].partition("\n")[0]
    assert "a longer horizon does not help" in told
    assert "raise the horizon" not in told


def test_what_the_parts_give_is_changed_last():
    cause = Cause("it sticks", (("friction", -1), ("amplitude", 1)))
    friction = Nearest("friction", 0.2, 0.19, None)
    farther = Nearest("axial_frequency", 18.0, None, 43.7)
    assert first_change(cause, [friction, farther]) == {"axial_frequency": 43.7}
    cure = Nearest("amplitude", 1e-3, None, 3e-3)
    assert first_change(cause, [friction, farther, cure]) == {"amplitude": 3e-3}
    assert first_change(cause, [friction]) == {"friction": 0.19}


@pytest.mark.parametrize(
    ("shape", "friction"),
    [("round", 0.2), pytest.param("square", 0.3, marks=pytest.mark.nightly)],
)
def test_what_is_to_change_first_cures_it(shape, friction):
    device = replace(load_device(PEG, STIFF | {"friction": friction}), stated_shape=shape)
    few = Ensemble(phases=2, tilts=[1.0], every=1)
    found = assess(device, SETTINGS, few)
    assert found.cause
    assert found.change
    cured = assess(device.changed(**found.change), SETTINGS, few, vary=False)
    assert cured.reliable
