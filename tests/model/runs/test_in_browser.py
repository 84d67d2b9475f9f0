"""The engine as WebAssembly, run without a browser, against the engine in Python."""

import os
import platform
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from model.engine.results import TRACK_VARIABLES, RunResult
from model.engine.track import COLUMNS
from model.events.insertion import INSERTION
from model.physics.modes import CLOSED
from model.physics.parameters import PARAMETER_NAMES
from model.runs.engine import engine_for
from model.runs.errors import SENSITIVE, outcomes_differ
from model.runs.in_browser import module_for
from model.runs.settings import Settings
from model.runs.simulate import simulate_once
from study.config import Study, load_study, study_path
from tests.model.runs.browser import Browser
from verification.trials import trial_of
from vibralign import Batch, align

pytest.importorskip("wasmtime")

SETS = int(os.environ.get("VIBRALIGN_SETS", "60"))  # `make nightly` takes more
SETTINGS = Settings(scene=INSERTION)  # a shown run goes on into the slot; a map asks for alignment


@pytest.fixture(scope="module")
def engine() -> Browser:
    made = module_for()
    return Browser(made.binary, made.interface)


@pytest.fixture(scope="module")
def batch(fixed_study: Study) -> Batch:
    return trial_of(fixed_study, "error").batch(np.arange(SETS))


@pytest.fixture(scope="module")
def sets(batch: Batch) -> np.ndarray:
    return np.column_stack([batch.values[name] for name in PARAMETER_NAMES])


def tilted_towards_the_hole(batch: Batch) -> Batch:
    """The devices of a batch at misalignments from which the press tilts a round part."""
    wider = 1.0 + batch.values["clearance"]
    farthest = batch.values["half_width"] * np.sqrt(wider * wider - 1.0)
    shares = np.random.default_rng(55).uniform(0.2, 0.9, len(batch))
    return Batch({**batch.values, "misalignment": shares * farthest})


@pytest.fixture(scope="module")
def ran(engine: Browser, sets: np.ndarray) -> np.ndarray:
    """Results, shape (sets, fields)."""
    return engine.run(sets, rows=0)[0]


def test_outcomes_and_times_are_those_of_python(batch: Batch, ran: np.ndarray) -> None:
    """Python's processor may round a product and a sum once; only in sensitive sets it shows.

    A periodic motion may be seen to settle later: see ``outcomes_differ``.
    """
    agree(SETTINGS, batch, ran)


def test_a_map_ends_runs_at_alignment(engine: Browser, batch: Batch, sets: np.ndarray) -> None:
    found = engine.run(sets, rows=0, alignment_only=1.0)[0]
    agree(Settings(alignment_only=True), batch, found)


def test_outcomes_and_times_of_round_parts_are_those_of_python(batch: Batch) -> None:
    """The module of a page knows the shape by its code."""
    made, batch = module_for("round"), tilted_towards_the_hole(batch)
    assert made.interface["shape"] == "round"
    sets = np.column_stack([batch.values[name] for name in PARAMETER_NAMES])
    found = Browser(made.binary, made.interface).run(sets, rows=0)[0]
    agree(replace(SETTINGS, shape="round"), batch, found)


def agree(settings: Settings, batch: Batch, ran: np.ndarray) -> None:
    rows = settings.rows(batch)
    there = RunResult(*engine_for(settings)(rows, np.full(SETS, settings.tolerance)).T)
    here = RunResult(*ran.T)
    differ = outcomes_differ(here.outcome, there.outcome, alike=True)
    times = np.where(np.isnan(here.tau_align + there.tau_align), 0.0,
                     np.abs(here.tau_align - there.tau_align))  # fmt: skip
    suspects = np.flatnonzero(differ | (times > SENSITIVE))
    assert suspects.size <= 0.02 * SETS
    if suspects.size:
        again = [batch[int(row)] for row in suspects]
        assert align(again, settings).sensitive.all()
    assert np.median(times[np.isfinite(there.tau_align)]) < 1e-12


_REFERENCE = """
import sys
import numpy as np
from model.physics.parameters import PARAMETER_NAMES, Batch
from model.runs.engine import engine_for
from model.runs.settings import SCENES, Settings
from model.runs.simulate import simulate_once
from study.config import load_study, study_path
scene, sets, found = sys.argv[1], np.load(sys.argv[2]), sys.argv[3]
settings = Settings(scene=SCENES[scene])
rows = settings.rows(Batch(dict(zip(PARAMETER_NAMES, sets.T.copy()))))
results = engine_for(settings)(rows, np.full(len(rows), settings.tolerance))
run = simulate_once(load_study(study_path()).parameters("fig05"), settings)
np.savez(found, results=results, time=run.time, **run.track_variables)
"""


@pytest.mark.skipif(
    platform.machine() not in ("x86_64", "AMD64"),
    reason="only x86 has a generic processor without fused multiply-add, as WebAssembly has none",
)
def test_every_field_is_equal_to_the_bit_without_fused_multiply_add(
    sets: np.ndarray, ran: np.ndarray, shown: dict[str, np.ndarray], tmp_path: Path
) -> None:
    given, found = tmp_path / "sets.npy", tmp_path / "found.npz"
    np.save(given, sets)
    command = [sys.executable, "-c", _REFERENCE, SETTINGS.scene.name, str(given), str(found)]
    subprocess.run(command, check=True, env=os.environ | {"VIBRALIGN_CPU": "x86-64"})
    with np.load(found) as python:
        np.testing.assert_array_equal(ran, python["results"])
        for name in ("time", *TRACK_VARIABLES):
            np.testing.assert_array_equal(shown[name], python[name])


@pytest.fixture(scope="module")
def shown_row() -> np.ndarray:
    """Parameters of the run whose track is looked at."""
    parameters = load_study(study_path()).parameters("fig05")
    return np.array([[np.nan if v is None else v for v in parameters.given().values()]])


@pytest.fixture(scope="module")
def shown(engine: Browser, shown_row: np.ndarray) -> dict[str, np.ndarray]:
    """Columns of the track."""
    results, track = engine.run(shown_row)
    tracked = int(RunResult(*results[0]).tracked)
    return dict(zip(COLUMNS, track[:tracked].T, strict=True))


def test_track_has_modes_and_events(
    engine: Browser, shown_row: np.ndarray, shown: dict[str, np.ndarray]
) -> None:
    result = RunResult(*engine.run(shown_row)[0][0])
    run = simulate_once(load_study(study_path()).parameters("fig05"), SETTINGS)
    assert result.tau_align == pytest.approx(run.tau_align, abs=1e-9)
    events = shown["event"] != 0.0
    assert events.sum() == result.events
    np.testing.assert_array_equal(shown["time"][events], shown["time"][np.roll(events, -1)])
    # The contact is lost at alignment, and the part falls.
    assert shown["mode_dropped"][-1] == 1.0
    dropped = int(np.argmax(shown["mode_dropped"]))
    assert shown["time"][dropped] == result.tau_align
    # The motion in each row is that of its mode: its load is the track's.
    closed = (shown["mode_face"] == CLOSED) & (shown["mode_in_slot"] == 0.0)
    loads = np.where(closed, shown["at_support_load"], 0.0)[~events]
    np.testing.assert_allclose(np.maximum(loads, 0.0), shown["contact_force"][~events], atol=1e-9)


def test_the_module_asks_for_nothing_but_powers(engine: Browser) -> None:
    assert engine.functions <= {"pow", "exp2", "memset"}
