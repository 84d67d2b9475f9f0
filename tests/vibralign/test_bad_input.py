"""Bad input to the functions: refused before anything is computed, with the name and the rule."""

import numpy as np
import pytest

from model.sweeps.io import DatasetError, read_dataset
from verification.fuzz import try_sets
from verification.independent import solve
from vibralign import Batch, Parameters, Scene, Variants, align, simulate

CALLS = {
    "a value beyond floating point": (
        lambda p: p.replace(inertia=10**400), ["inertia = ", "finite number"],
    ),
    "an array for a value": (
        lambda p: p.replace(friction=np.array([0.1])), ["friction = ", "finite number"],
    ),
    "parameters without values": (lambda _: Parameters(), ["half_width"]),
    "an empty batch": (lambda _: align([]), ["empty", "at least one"]),
    "no core": (lambda p: align([p], cores=0), ["cores = 0", ">= 1"]),
    "half a core": (lambda p: align([p], cores=0.5), ["cores = 0.5"]),
    "an engine to choose": (lambda p: align([p], engine="batch"), ["engine", "leave it out"]),
    "a word for a truth value": (
        lambda p: align([p], may_settle="False"), ["may_settle = 'False'", "True or False"],
    ),
    "a number for a truth value": (
        lambda p: align([p], alignment_only=1), ["alignment_only = 1", "True or False"],
    ),
    "a truth value for a number": (lambda p: align([p], horizon=True), ["horizon = True"]),
    "a truth value for a depth": (
        lambda p: align([p], scene="insertion", insertion_depth=True), ["insertion_depth = True"],
    ),
    "something else than parameters": (lambda _: align([{"friction": 0.1}]), ["Parameters"]),
    "no device": (lambda _: align(0.3), ["Parameters", "load_device", "float"]),
    "quantities in place of devices": (lambda _: align({"mass": 0.3}), ["Parameters", "dict"]),
    "a scene that is none": (lambda p: simulate(p, scene="inserting"), ["insertion", "alignment"]),
    "many sets in place of one": (lambda p: simulate([p]), ["Parameters"]),
    "settings that are none": (lambda p: simulate(p, {"horizon": 1.0}), ["Settings"]),
    "a horizon in words": (lambda p: simulate(p, horizon="long"), ["horizon", "'long'"]),
    "a tolerance in words": (lambda p: simulate(p, tolerance="fine"), ["tolerance", "'fine'"]),
    "a reading that is none": (lambda _: Variants(preload="both"), ["preload", "'both'"]),
    "a contact that is none": (
        lambda _: Scene("mine", frozenset({"edge"})), ["'edge'", "edge_on_face"],
    ),
    "the independent solution of what it does not model": (
        lambda p: solve(p.replace(initial_tilt=-0.01), 1.0), ["initial_tilt"],
    ),
    "a campaign of nothing": (lambda _: try_sets(1, 0, 0), ["sets"]),
    "a campaign of less": (lambda _: try_sets(1, 0, -1), ["sets"]),
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


FILES = {
    "missing": lambda _path: None,
    "a folder": lambda path: path.mkdir(),
    "a netCDF signature and no more": lambda path: path.write_bytes(b"\x89HDF\r\n\x1a\n"),
}


@pytest.mark.parametrize("make", FILES.values(), ids=list(FILES))
def test_a_dataset(tmp_path, make):
    path = tmp_path / "fig06.nc"
    make(path)
    with pytest.raises(DatasetError) as refusal:
        read_dataset(path)
    assert str(path) in str(refusal.value)
    assert "build it again" in str(refusal.value)
