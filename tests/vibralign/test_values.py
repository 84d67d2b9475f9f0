"""Public values are copied, pickled, compared and printed, in this process and in others."""

import copy
import html
import importlib
import math
import multiprocessing
import pickle
from concurrent.futures import ProcessPoolExecutor
from dataclasses import FrozenInstanceError, is_dataclass, replace
from enum import Enum
from functools import partial
from pathlib import Path
from typing import Any

import joblib
import numpy as np
import pytest

import vibralign
from model.events.table import EVENTS
from model.sweeps.settings import Ensemble
from vibralign import (
    INSERTION,
    PRINTED_CONTACTS,
    Batch,
    Outcome,
    Reason,
    Scene,
    Settings,
    Variants,
    align,
    assess,
    baseline,
    calibrate,
    design,
    load_device,
    simulate,
    yield_of,
)
from vibralign.answers.leeways import Leeway, Nearest
from vibralign.answers.sheet import sheet_rows

PEG = Path(__file__).parents[2] / "docs" / "devices" / "peg.yaml"
BENCH = Path(__file__).parents[2] / "examples" / "bench.yaml"
TRIALS = [{"result": "60 ms"}, {"press_force": "14 N", "result": "fails after 2 s"}]
QUICK = Settings(horizon=20.0, tolerance=1e-6)
STARTS = [{"phase": 0.0, "initial_tilt": 0.001}]


def values():
    """Values of every public class, with and without what is not a number."""
    device, peg = baseline(), load_device(PEG, {"press_force": "12 N ± 1 N"})
    batch = Batch.of(device, press_force=np.linspace(0.2, 4.0, 9))
    found, results = yield_of(peg, STARTS, QUICK, devices=4)
    free = replace(peg, free={"press_force": (8.0, 12.0)})
    few = Ensemble(phases=1, tilts=[1.0], every=1)
    best = design(free, QUICK, few, generations=1, population=5, devices=4)
    return [
        device, batch, peg, Variants.printed(), Outcome.ALIGNED, Reason.NO_REST,
        INSERTION, PRINTED_CONTACTS, Scene("mine", frozenset({"edge_on_face"})),
        Settings(), replace(QUICK, scene=INSERTION, readings=Variants(), start="pressed"),
        simulate(device, QUICK), simulate(device, QUICK, horizon=1.0), align(batch, QUICK),
        found, results, replace(found, low=math.nan), best,
        calibrate(BENCH, TRIALS, touch_downs_tried=2, target=5),
        assess(peg, QUICK, vary=False),
    ]  # fmt: skip


KINDS = (
    "Parameters", "Batch", "StatedDevice", "Variants", "Outcome", "Reason", "Scene", "printed",
    "mine",
    "Settings", "insertion", "Trajectory", "short", "Alignments", "Yield", "results", "no bound",
    "Design", "Calibration", "Assessment",
)  # fmt: skip
VALUES: list[Any] = []  # filled by the first test


@pytest.fixture(scope="module", autouse=True)
def _made():
    VALUES.extend(values())
    assert len(VALUES) == len(KINDS)
    yield
    VALUES.clear()


def echo(value):
    """Take a value to another process and back."""
    return value


@pytest.fixture(scope="module", params=["fork", "spawn"])
def elsewhere(request, _made):
    """The values after a way to another process and back."""
    with ProcessPoolExecutor(1, multiprocessing.get_context(request.param)) as pool:
        return list(pool.map(echo, VALUES))


pytestmark = pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
each_value = pytest.mark.parametrize("n", range(len(KINDS)), ids=KINDS)


def test_every_public_class_is_tried():
    public = {getattr(vibralign, name) for name in vibralign.__all__}
    classes = {each for each in public if isinstance(each, type)} - {vibralign.DoubtWarning}
    assert classes <= {type(each) for each in VALUES}  # a warning is no value


@each_value
def test_a_copy_is_equal_and_has_the_same_hash(n):
    value = VALUES[n]
    for copied in (copy.copy(value), copy.deepcopy(value), pickle.loads(pickle.dumps(value))):  # noqa: S301
        assert copied == value
        assert hash(copied) == hash(value)
    assert all(other != value for other in VALUES[:n] + VALUES[n + 1 :])
    assert len({*VALUES}) == len(VALUES)


@each_value
def test_it_comes_back_from_another_process(elsewhere, n):
    assert elsewhere[n] == VALUES[n]
    assert repr(elsewhere[n]) == repr(VALUES[n])


def test_joblib_has_one_key_for_equal_values():
    assert joblib.hash(VALUES) == joblib.hash(copy.deepcopy(VALUES))


@each_value
def test_it_prints_in_a_line_and_as_a_table(n):
    value = VALUES[n]
    assert len(repr(value)) < 500
    assert "\n" not in repr(value)
    if is_dataclass(value) and not isinstance(value, (Enum, Scene, Variants)):
        assert value._repr_html_().startswith("<table>")
        with pytest.raises(FrozenInstanceError):
            value.friction = 0.2


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_settings_reach_the_runs_of_other_processes(method):
    task = partial(simulate, settings=replace(QUICK, scene=INSERTION))
    with ProcessPoolExecutor(1, multiprocessing.get_context(method)) as pool:
        assert list(pool.map(task, [baseline()])) == [task(baseline())]


def test_a_scene_with_events_of_its_own_says_that_it_stays():
    with pytest.raises(TypeError, match="scene 'mine' has a table of events of its own"):
        copy.deepcopy(Scene("mine", frozenset(), EVENTS[:3]))


def test_outcomes_print_as_words():
    assert (
        f"{Outcome.LEFT_SCENE} {Outcome.LEFT_SCENE:d} {Outcome.ALIGNED:>8}"
        == "left_scene 2  aligned"
    )
    assert repr(Settings(horizon=3.0)) == "Settings(horizon=3.0)"
    run = simulate(baseline(), QUICK)
    assert repr(run).startswith(f"<Trajectory: aligned after τ = {run.tau_align:.7g} ± ")
    assert "1 aligned" in repr(align(baseline(), QUICK))
    assert (
        importlib.import_module("vibralign").load_device(PEG).__repr__() == f"<StatedDevice: {PEG}>"
    )


def test_a_run_of_a_device_prints_seconds():
    peg = load_device(PEG)
    run = simulate(PEG, QUICK)
    seconds = run.tau_align * run.units.time
    assert seconds == pytest.approx(float(vibralign.sweep(PEG, QUICK).tau_align), rel=1e-6)
    for printed in (repr(run), run._repr_html_()):
        assert f"aligned after {seconds:.4g} s (τ = {run.tau_align:.7g} ± " in printed
    same = simulate(peg.parameters, peg.run_settings(QUICK, peg.units))
    assert same.units is None
    assert " s (" not in repr(same)
    assert same == run
    assert hash(same) == hash(run)


def test_a_table_has_words_for_what_it_holds():
    """No class names of what stands in rows; the doubts of a device are among them."""
    thin = load_device(PEG, {"tilt_stiffness": "500 N m/rad"})
    shown = thin._repr_html_()
    assert thin.doubts
    assert html.escape(thin.doubts[0]) in shown
    assert "<th>notes</th><td>none</td>" in shown
    leeway, near = Leeway("friction", 0.2, 0.1, 0.3), Nearest("mass", 1.0, None, 2.0)
    found = replace(VALUES[-1], leeways=(leeway, leeway), nearest=(near,))
    sheet = dict(sheet_rows(found))
    assert str(found).splitlines() == [f"{label:<16}{words}" for label, words in sheet.items()]
    assert f"<th>verdict</th><td>{sheet['verdict']}</td>" in found._repr_html_()
