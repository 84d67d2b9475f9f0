"""Bad input to the functions: refused before anything is computed, with the name and the rule."""

import math
from pathlib import Path

import numpy as np
import pytest

from benchmarks.hard_cases import read_judged
from benchmarks.work_precision import read_timings
from model import Batch, Parameters, Scene, Settings, Variants, align, simulate
from model.study.csv_tables import TableError
from model.study.io import DatasetError, read_dataset
from verification.accuracy import read_tables
from verification.fuzz import try_sets
from verification.independent import solve

NAN, INF = math.nan, math.inf

# (name, value, what the message must hold)
PARAMETERS = [
    ("half_width", 0.0, ["half_width", "> 0"]),
    ("half_width", INF, ["half_width", "finite"]),
    ("half_height", -1.0, ["half_height", "> 0"]),
    ("inertia", NAN, ["inertia", "finite"]),
    ("inertia", 10**400, ["inertia", "finite"]),
    ("friction", -1e-300, ["friction", ">= 0"]),
    ("friction", "0.1", ["friction", "'0.1'"]),
    ("friction", True, ["friction", "True"]),
    ("friction", 1j, ["friction", "1j"]),
    ("friction", np.array([0.1, 0.2]), ["friction", "finite number"]),
    ("press_force", None, ["press_force", "None"]),
    ("frequency", -5.0, ["frequency", ">= 0"]),
    ("contact_stiffness", 0.0, ["contact_stiffness", "> 0"]),
    ("clearance", 0.0, ["clearance", "> 0"]),
    ("misalignment", -0.1, ["misalignment", ">= 0"]),
    ("misalignment", 50.0, ["misalignment", "beside the slot"]),
    ("rest_y", INF, ["rest_y", "half_height"]),
    ("press_forse", 1.0, ["press_forse", "Did you mean 'press_force'"]),
]


@pytest.mark.parametrize(("name", "value", "words"), PARAMETERS)
def test_a_parameter(device, name, value, words):
    with pytest.raises((TypeError, ValueError)) as refusal:
        device.replace(**{name: value})
    assert "\n" not in str(refusal.value)
    for word in words:
        assert word in str(refusal.value)


CALLS = {
    "an empty batch": (lambda _: align([]), ["empty", "at least one"]),
    "no core": (lambda p: align([p], cores=0), ["cores = 0", ">= 1"]),
    "half a core": (lambda p: align([p], cores=0.5), ["cores = 0.5"]),
    "an engine that is none": (lambda p: align([p], engine="fast"), ["'fast'", "'batch'"]),
    "lanes for printed readings": (
        lambda p: align([p], readings=Variants.printed(), engine="batch"), ["batch", "scalar"],
    ),
    "something else than parameters": (lambda _: align([{"friction": 0.1}]), ["Parameters"]),
    "one set in place of many": (align, ["Parameters"]),
    "many sets in place of one": (lambda p: simulate([p]), ["Parameters"]),
    "a setting that is none": (lambda p: simulate(p, horizn=1.0), ["horizn"]),
    "settings that are none": (lambda p: simulate(p, {"horizon": 1.0}), ["Settings"]),
    "no horizon": (lambda p: simulate(p, horizon=0.0), ["horizon = 0.0", "> 0"]),
    "an infinite horizon": (lambda p: simulate(p, horizon=INF), ["horizon", "finite"]),
    "a horizon in words": (lambda p: simulate(p, horizon="long"), ["horizon", "'long'"]),
    "a tolerance too fine": (lambda p: simulate(p, tolerance=1e-16), ["tolerance", "1e-14"]),
    "a tolerance that is none": (lambda p: simulate(p, tolerance=NAN), ["tolerance = nan"]),
    "a tolerance in words": (lambda p: simulate(p, tolerance="fine"), ["tolerance", "'fine'"]),
    "no evaluation": (lambda p: simulate(p, max_evaluations=0), ["max_evaluations = 0", ">= 1"]),
    "readings that are none": (lambda p: simulate(p, readings="printed"), ["readings", "Readings"]),
    "a reading that is none": (lambda _: Variants(preload="both"), ["preload", "'both'"]),
    "a contact that is none": (
        lambda _: Scene("mine", frozenset({"edge"})), ["'edge'", "edge_on_face"],
    ),
    "a sweep of nothing": (lambda p: Batch.of(p, friction=[]), ["friction", "non-empty"]),
    "a sweep of two dimensions": (lambda p: Batch.of(p, friction=[[0.1]]), ["one dimension"]),
    "sweeps of two lengths": (
        lambda p: Batch.of(p, friction=[0.1], frequency=[1.0, 2.0]), ["length", "frequency: 2"],
    ),
    "a sweep with a bad value": (lambda p: Batch.of(p, friction=[0.1, -1.0]), ["friction[1]"]),
    "a sweep that is no number": (lambda p: Batch.of(p, friction=["much"]), ["friction", "much"]),
}  # fmt: skip


@pytest.mark.parametrize(("call", "words"), CALLS.values(), ids=list(CALLS))
def test_a_call(device, call, words):
    with pytest.raises((TypeError, ValueError)) as refusal:
        call(device)
    assert "\n" not in str(refusal.value)
    for word in words:
        assert word in str(refusal.value)


# ------------------------------------------------------------------------------------------- files


def truncated(path: Path, make_dataset) -> None:
    whole = path.with_name("whole.nc")
    from model.study.io import write_dataset  # noqa: PLC0415

    write_dataset(make_dataset(), whole)
    path.write_bytes(whole.read_bytes()[: whole.stat().st_size // 2])


def foreign(path: Path, make_dataset) -> None:
    data = make_dataset()
    data.attrs.clear()
    data.to_netcdf(path, engine="netcdf4")


FILES = {
    "missing": lambda _path, _make: None,
    "empty": lambda path, _make: path.touch(),
    "text": lambda path, _make: path.write_text("figure,sweep\n1,2\n"),
    "zeros": lambda path, _make: path.write_bytes(bytes(4096)),
    "a folder": lambda path, _make: path.mkdir(),
    "truncated": truncated,
    "foreign": foreign,
    "a netCDF signature and no more": lambda path, _make: path.write_bytes(b"\x89HDF\r\n\x1a\n"),
}


@pytest.mark.parametrize("make", FILES.values(), ids=list(FILES))
def test_a_dataset(tmp_path, make_dataset, make):
    path = tmp_path / "fig06.nc"
    make(path, make_dataset)
    with pytest.raises(DatasetError) as refusal:
        read_dataset(path)
    assert str(path) in str(refusal.value)
    assert "build it again" in str(refusal.value)


TABLES = {"hard cases": read_judged, "timings": read_timings}


@pytest.mark.parametrize("read", TABLES.values(), ids=list(TABLES))
@pytest.mark.parametrize(
    "content", [None, b"", b"a,b\n1,2\n", b"\xff\xfe\x00", b"case,method\nx\n"]
)
def test_a_table(tmp_path, read, content):
    path = tmp_path / "table.csv"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(TableError) as refusal:
        read(path)
    assert str(path) in str(refusal.value)
    assert "build it again" in str(refusal.value)


@pytest.mark.parametrize("content", [b"", b"set,outcome\n0\n", b"set\nx\n", b"set\n5\n", b"\xff"])
def test_a_chunk_of_a_trial(tmp_path, content):
    path = tmp_path / "0.csv"
    path.write_bytes(content)
    with pytest.raises(ValueError, match="run again"):
        read_tables([path])


def test_the_independent_solution_of_what_it_does_not_model(device):
    with pytest.raises(ValueError, match="initial_tilt"):
        solve(device.replace(initial_tilt=-0.01), 1.0)


@pytest.mark.parametrize("count", [0, -1])
def test_a_campaign_of_nothing(count):
    with pytest.raises(ValueError, match="sets"):
        try_sets(1, 0, count)


def test_settings_do_not_take_what_is_not_theirs():
    with pytest.raises(TypeError, match="step"):
        Settings(step=0.1)


def test_parameters_need_every_value():
    with pytest.raises(TypeError, match="half_width"):
        Parameters()
