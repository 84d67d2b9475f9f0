"""The engines as WebAssembly, run without a browser, against the same engines in Python."""

import os
import platform
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from model.engine.results import TRACK_VARIABLES, RunResult
from model.events.insertion import INSERTION
from model.physics.modes import CLOSED
from model.physics.parameters import PARAMETER_NAMES
from model.runs.engines import Engine, engine_for
from model.runs.errors import SENSITIVE, outcomes_differ
from model.runs.in_browser import modules
from model.runs.settings import Settings
from model.runs.simulate import simulate_once
from model.runs.trace import COLUMNS
from study.config import Study, load_study, study_path
from tests.model.runs.browser import Browser
from verification.trials import trial_of
from vibralign import Batch, align

pytest.importorskip("wasmtime")

SETS = int(os.environ.get("VIBRALIGN_SETS", "60"))  # `make nightly` takes more
# A shown run goes on into the slot; a map asks for alignment.
SETTINGS: dict[Engine, Settings] = {"scalar": Settings(scene=INSERTION), "batch": Settings()}


@pytest.fixture(scope="module")
def engines() -> dict[str, Browser]:
    made = modules()
    return {
        name: Browser(getattr(made, name), name, made.interface) for name in ("run_one", "run_many")
    }


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


def _one_at_a_time(engine: Browser, sets: np.ndarray) -> np.ndarray:
    return np.vstack([engine.run(row[np.newaxis], rows=0)[0] for row in sets])


@pytest.fixture(scope="module")
def ran(engines: dict[str, Browser], sets: np.ndarray) -> dict[str, np.ndarray]:
    """Results of both modules, shape (sets, fields)."""
    return {
        "scalar": _one_at_a_time(engines["run_one"], sets),
        "batch": engines["run_many"].run(sets)[0],
    }


@pytest.mark.parametrize("engine", ["scalar", "batch"])
def test_outcomes_and_times_are_those_of_python(
    engine: Engine, batch: Batch, ran: dict[str, np.ndarray]
) -> None:
    """Python's processor may round a product and a sum once; only in sensitive sets it shows.

    A periodic motion may be seen to settle later: see ``outcomes_differ``.
    """
    agree(SETTINGS[engine], engine, batch, ran[engine])


@pytest.mark.parametrize("engine", ["scalar", "batch"])
def test_outcomes_and_times_of_round_parts_are_those_of_python(
    engine: Engine, batch: Batch
) -> None:
    """The modules of a page know the shape by their code."""
    made, batch = modules("round"), tilted_towards_the_hole(batch)
    assert made.interface["shape"] == "round"
    sets = np.column_stack([batch.values[name] for name in PARAMETER_NAMES])
    if engine == "scalar":
        found = _one_at_a_time(Browser(made.run_one, "run_one", made.interface), sets)
    else:
        found = Browser(made.run_many, "run_many", made.interface).run(sets)[0]
    agree(replace(SETTINGS[engine], shape="round"), engine, batch, found)


def agree(settings: Settings, engine: Engine, batch: Batch, ran: np.ndarray) -> None:
    rows = settings.rows(batch)
    there = RunResult(*engine_for(settings, engine)(rows, np.full(SETS, settings.tolerance)).T)
    here = RunResult(*ran.T)
    differ = outcomes_differ(here.outcome, there.outcome, alike=True)
    times = np.where(np.isnan(here.tau_align + there.tau_align), 0.0,
                     np.abs(here.tau_align - there.tau_align))  # fmt: skip
    suspects = np.flatnonzero(differ | (times > SENSITIVE))
    assert suspects.size <= 0.02 * SETS
    if suspects.size:
        again = [batch[int(row)] for row in suspects]
        assert align(again, settings, engine=engine).sensitive.all()
    assert np.median(times[np.isfinite(there.tau_align)]) < 1e-12


_REFERENCE = """
import sys
import numpy as np
from model.physics.parameters import PARAMETER_NAMES, Batch
from model.runs.engines import engine_for
from model.runs.settings import SCENES, Settings
from model.runs.simulate import simulate_once
from study.config import load_study, study_path
name, scene, sets, found = *sys.argv[1:3], np.load(sys.argv[3]), sys.argv[4]
settings = Settings(scene=SCENES[scene])
rows = settings.rows(Batch(dict(zip(PARAMETER_NAMES, sets.T.copy()))))
results = engine_for(settings, name)(rows, np.full(len(rows), settings.tolerance))
run = simulate_once(load_study(study_path()).parameters("fig05"), settings)
np.savez(found, results=results, time=run.time, **run.track_variables)
"""


@pytest.mark.skipif(
    platform.machine() not in ("x86_64", "AMD64"),
    reason="only x86 has a generic processor without fused multiply-add, as WebAssembly has none",
)
@pytest.mark.parametrize("engine", ["scalar", pytest.param("batch", marks=pytest.mark.nightly)])
def test_every_field_is_equal_to_the_bit_without_fused_multiply_add(
    engine: Engine,
    sets: np.ndarray,
    ran: dict[str, np.ndarray],
    shown: dict[str, np.ndarray],
    tmp_path: Path,
) -> None:
    given, found = tmp_path / "sets.npy", tmp_path / "found.npz"
    np.save(given, sets)
    scene = SETTINGS[engine].scene.name
    command = [sys.executable, "-c", _REFERENCE, engine, scene, str(given), str(found)]
    subprocess.run(command, check=True, env=os.environ | {"VIBRALIGN_CPU": "x86-64"})
    with np.load(found) as python:
        np.testing.assert_array_equal(ran[engine], python["results"])
        for name in ("time", *TRACK_VARIABLES) if engine == "scalar" else ():
            np.testing.assert_array_equal(shown[name], python[name])


@pytest.fixture(scope="module")
def shown_row() -> np.ndarray:
    """Parameters of the run whose track is looked at."""
    parameters = load_study(study_path()).parameters("fig05")
    return np.array([[np.nan if v is None else v for v in parameters.given().values()]])


@pytest.fixture(scope="module")
def shown(engines: dict[str, Browser], shown_row: np.ndarray) -> dict[str, np.ndarray]:
    """Columns of the track."""
    results, track = engines["run_one"].run(shown_row)
    tracked = int(RunResult(*results[0]).tracked)
    return dict(zip(COLUMNS, track[:tracked].T, strict=True))


def test_track_has_modes_and_events(
    engines: dict[str, Browser], shown_row: np.ndarray, shown: dict[str, np.ndarray]
) -> None:
    result = RunResult(*engines["run_one"].run(shown_row)[0][0])
    run = simulate_once(load_study(study_path()).parameters("fig05"), SETTINGS["scalar"])
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


def test_modules_ask_for_nothing_but_powers(engines: dict[str, Browser]) -> None:
    assert engines["run_one"].functions | engines["run_many"].functions <= {"pow", "exp2", "memset"}
