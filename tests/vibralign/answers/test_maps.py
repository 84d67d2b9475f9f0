"""Stability maps: a full grid, and the starts that are tried at every few of its nodes."""

import math
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from model.events.outcomes import Outcome
from model.sweeps.axes import Axis
from model.sweeps.io import DatasetError, read_chunks, write_dataset
from model.sweeps.settings import Ensemble, RunSettings
from model.sweeps.starts import starts_of
from model.sweeps.sweep import Sweep, margin_of, merge, run
from study.config import load_study, study_path
from study.plans import sweep_of
from vibralign import align
from vibralign.answers.assumptions import at_corners
from vibralign.answers.cases import cases_of
from vibralign.answers.maps import QuantityAxis, in_every_case, map_of
from vibralign.answers.reliability import are_reliable, from_every_start
from vibralign.device import load_device

PEG = Path(__file__).parents[2] / "square" / "peg.yaml"
SETTINGS = RunSettings(readings="consistent", horizon=40.0, tolerance=1e-8)
X = Axis(parameter="tilt_stiffness", start=2.0, stop=16.0, count=17)
Y = Axis(parameter="press_force", start=1.0, stop=9.0, count=13)
ENSEMBLE = Ensemble(phases=3, tilts=[1.0, 3.0], every=4)


@pytest.fixture(scope="module")
def sweep(device) -> Sweep:
    variables = "outcome", "tau_align", "tau_error"
    return Sweep(name="map", kind="map", parameters=device.given(), settings=SETTINGS,
                 dimensions=[Y, X], variables=variables, ensemble=ENSEMBLE)  # fmt: skip


@pytest.fixture(scope="module")
def found(sweep) -> xr.Dataset:
    return merge(sweep, "title", [run(sweep)])


def test_every_node_is_run(found, sweep):
    batch = sweep.batch(np.arange(X.count * Y.count))
    expected = align(batch, SETTINGS.settings)
    for name in ("outcome", "tau_align", "tau_error"):
        values = getattr(expected, name).reshape(Y.count, X.count)
        np.testing.assert_array_equal(found[name].values, values, err_msg=name)
    assert {Outcome.ALIGNED, Outcome.SETTLED} <= set(found["outcome"].values.ravel())


def test_starts_are_tried_at_every_few_nodes(found, device):
    assert found["start_outcome"].dims == (
        "start_press_force", "start_tilt_stiffness", "start_initial_tilt", "start_phase",
    )  # fmt: skip
    for name in ("press_force", "tilt_stiffness"):
        np.testing.assert_array_equal(found[f"start_{name}"], found[name][::4])
    starts = starts_of(device, ENSEMBLE)
    tilts, phases = ([s[name] for s in starts] for name in ("initial_tilt", "phase"))
    assert found["start_initial_tilt"].values.tolist() == list(dict.fromkeys(tilts))
    assert found["start_phase"].values.tolist() == list(dict.fromkeys(phases))
    # The first start is the device's own: there the map's node and the start's are one run.
    own = found["start_outcome"].values[:, :, 0, 0]
    np.testing.assert_array_equal(own, found["outcome"].values[::4, ::4])


def test_a_reliable_node_aligns_from_every_start(found, device):
    """The nodes one by one, start by start."""
    reliable = found["reliable"].values
    assert 0 < reliable.sum() < reliable.size
    for (row, column), is_reliable in np.ndenumerate(reliable):
        point = {name: float(found[f"start_{name}"][i])
                 for name, i in (("press_force", row), ("tilt_stiffness", column))}  # fmt: skip
        each = [device.replace(**point, **start) for start in starts_of(device, ENSEMBLE)]
        runs = align(each, SETTINGS.settings)
        assert is_reliable == (runs.outcome == Outcome.ALIGNED).all()
        longest = float(found["start_tau_align"][row, column].max())
        if is_reliable:
            assert longest == pytest.approx(runs.tau_align.max(), abs=1e-6)


def test_the_margin_is_the_distance_to_the_nearest_unreliable_node(found):
    reliable, margin = found["reliable"].values == 1, found["margin"].values
    rows, columns = np.nonzero(~reliable)
    below = np.array(reliable.shape) - 1
    for (row, column), value in np.ndenumerate(margin):
        nearest = np.hypot((rows - row) / below[0], (columns - column) / below[1]).min()
        assert value == pytest.approx(nearest, abs=1e-12)
    assert margin_of(np.ones((3, 3), dtype=np.bool_)).min() == math.inf
    assert margin_of(np.array([[True], [False]])).tolist() == [[1.0], [0.0]]


def test_chunks_and_cores_do_not_change_the_map(sweep, found, tmp_path):
    chunks = 5
    paths = [tmp_path / f"{chunk}.nc" for chunk in range(chunks)]
    for chunk, path in enumerate(paths):
        write_dataset(run(sweep, chunk, chunks, cores=1 + chunk % 2), path)
    again = merge(sweep, "title", read_chunks(paths, sweep.name, sweep.identity))
    xr.testing.assert_identical(again, found)


def test_a_chunk_of_another_map_is_refused(sweep, tmp_path):
    path, first = tmp_path / "0.nc", run(sweep, 0, 20)
    other = sweep.model_copy(update={"ensemble": ENSEMBLE.model_copy(update={"every": 2})})
    for change in ({"config_hash": other.identity}, {"chunk": 1}, {"chunks": 3}, {"figure": "x"}):
        write_dataset(first.assign_attrs({"chunks": 1} | change), path)
        with pytest.raises(DatasetError, match=r"0\.nc: is not chunk 0 of map; deleted"):
            read_chunks([path], sweep.name, sweep.identity)
        assert not path.exists()
    with pytest.raises(DatasetError, match="do not hold each of 221 points once"):
        merge(sweep, "title", [first])


def test_bad_maps_are_refused_and_one_over_the_start_tries_no_others():
    peg, x = load_device(PEG), QuantityAxis(parameter="mass", start=0.2, stop=0.4, count=2)
    with pytest.raises(ValueError, match="'mass' is varied twice"):
        map_of(peg, SETTINGS, (x, x), ENSEMBLE)
    wide = QuantityAxis(parameter="friction", start=-1.0, stop=0.5, count=3)
    with pytest.raises(ValueError, match=r"friction = -1\.0: must be a finite number >= 0"):
        map_of(peg, SETTINGS, (x, wide), ENSEMBLE)
    phases = QuantityAxis(parameter="phase", start=0.0, stop=6.0, count=3)
    assert map_of(peg, SETTINGS, (x, phases), ENSEMBLE).ensemble is None


def test_a_map_of_a_device_runs_its_devices_from_every_start():
    """Over a unit of the device, and over a ratio that stands for a parameter."""
    peg = load_device(PEG)
    x = QuantityAxis(parameter="mass", start=0.2, stop=0.4, count=2)
    y = QuantityAxis(parameter="tilt_damping_ratio", start=0.05, stop=0.2, count=2)
    sweep = map_of(peg, SETTINGS, (x, y), ENSEMBLE)
    found = merge(sweep, "title", [run(sweep)])
    assert found["start_tau_align"].attrs["units"] == "s"
    for row, column in np.ndindex(2, 2):
        one = peg.changed(mass=x.values[column], tilt_damping_ratio=y.values[row])
        cases = [each for each in cases_of(one, ENSEMBLE) if np.isnan(each["level"])]
        own = {"friction": np.array([one.values["friction"]])}
        runs, _ = from_every_start(one, own, cases, SETTINGS.settings)
        outcome = found["start_outcome"].values[row, column].ravel()
        np.testing.assert_array_equal(outcome, runs["outcome"][0])
        seconds = found["start_tau_align"].values[row, column].ravel()
        np.testing.assert_allclose(seconds, runs["tau_align"][0] * one.units.time, rtol=1e-12)


def test_a_reliable_node_of_a_device_is_so_in_every_case():
    """Of a device that states neither approach nor base, the map tries one; then all others."""
    peg = load_device(PEG.parents[2] / "docs" / "peg.yaml")
    few, settings = Ensemble(phases=4, tilts=[1.0], every=1), SETTINGS.settings
    x = QuantityAxis(parameter="press_force", start=2.0, stop=8.0, count=3)
    y = QuantityAxis(parameter="amplitude", start=1e-3, stop=2.5e-3, count=3)
    sweep = map_of(peg, SETTINGS, (x, y), few)
    first = merge(sweep, "title", [run(sweep)])
    found = in_every_case(first, peg, settings, few)
    across, up = np.meshgrid(x.values, y.values)
    values = {"press_force": across.ravel(), "amplitude": up.ravel()}
    every = are_reliable(peg, values, cases_of(peg, few), settings)
    assert found["reliable"].values.ravel().tolist() == every.tolist()
    assert 0 < every.sum() < first["reliable"].values.sum()
    np.testing.assert_array_equal(found["margin"], margin_of(every.reshape(3, 3)))


def test_every_map_of_the_study_has_its_starts():
    study = load_study(study_path())
    for name in ("fig13", "fig14", *study.maps.planes):
        sweep = sweep_of(study, name)
        assert sweep.starts is not None
        every_eighth = [-(-each.count // 8) for each in sweep.dimensions]
        assert sweep.starts.shape == (*every_eighth, 2, 16)


def test_a_map_lists_the_assumptions_of_its_corners_that_differ():
    found = at_corners([{"goal": f"a depth of {n} mm"} for n in (1, 2, 1)])
    assert found == {"goal": "varies over the map: a depth of 1 mm; a depth of 2 mm"}
