"""Loops over lanes are compiled to vector code."""

import re

import pytest
from numba.core import types

from model.compile import jit
from model.engines.batch.event_kernels import in_vector_kernels
from model.events.insertion import INSERTION
from model.events.scenes import ALIGNMENT, Scene

ARGUMENTS = types.int64, types.Array(types.float64, 1, "C")  # applicable, w


@pytest.mark.parametrize("name", ["sample_lanes", "enter_bounds"])
@pytest.mark.parametrize("scene", [ALIGNMENT, INSERTION], ids=lambda scene: scene.name)
def test_event_functions_are_written_a_vector_at_a_time(name, scene: Scene, tmp_path, monkeypatch):
    monkeypatch.setattr(jit, "_CACHE_FOLDER", str(tmp_path))  # what a cache holds cannot be read
    whole = getattr(in_vector_kernels(scene).events, name).whole()
    whole.compile(ARGUMENTS)
    code = whole.overloads[ARGUMENTS].library.get_llvm_str()
    assert re.search(r"store <\d+ x double>", code)
    assert "store double" not in code
