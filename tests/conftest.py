"""Shared fixtures. Floating-point accidents are errors: no test may pass on a silent NaN."""

import importlib
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import yaml

from model.physics.parameters import Constants
from model.sweeps.axes import Family
from study.config import Curves, Map, Study, check_study, read_study, study_path
from tests.build import built, copy_of_built, make_workspace, results, tiny, workspace
from vibralign import Batch, Parameters, Variants, align, simulate
from vibralign.device.paper import baseline

__all__ = ["built", "copy_of_built", "make_workspace", "results", "tiny", "workspace"]

LANE_CONSTANTS = Variants.consistent()


def pytest_configure(config: pytest.Config) -> None:
    """Compile the kernels once where several processes share the tests, before they start."""
    if getattr(config.option, "numprocesses", None) and not hasattr(config, "workerinput"):
        simulate(baseline(), horizon=0.1)
        align([baseline()], horizon=0.1)


# Files that take longest. The second begins while the study of the first is built.
_FIRST = [
    "test_workflow", "test_in_browser", "test_nothing_lost", "test_record", "test_reruns",
    "test_mutations",
]  # fmt: skip


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the longest files, since a process runs whole files."""
    place = {stem: n for n, stem in enumerate(_FIRST)}
    items.sort(key=lambda item: place.get(item.path.stem, len(_FIRST)))


@pytest.fixture(autouse=True)
def _floating_point_errors() -> Iterator[None]:
    with np.errstate(divide="raise", over="raise", invalid="raise"):
        yield


@pytest.fixture(scope="session")
def device() -> Parameters:
    """The structural set of physics.md at a working point that aligns."""
    return Parameters(
        half_width=1.0476,
        half_height=4.1057,
        inertia=15.434,
        lateral_stiffness=0.04793,
        tilt_stiffness=10.0,
        lateral_damping=1.5969,
        axial_damping=0.17288,
        tilt_damping=4.5182,
        friction=0.12,
        press_force=3.0,
        frequency=10.0,
    )


@pytest.fixture(scope="session")
def constants() -> Callable[..., Constants]:
    """Constants that kernels take: ``constants(parameters, readings)``."""

    def make(parameters: Parameters, readings: Variants = LANE_CONSTANTS) -> Constants:
        return Constants(*Batch.stack([parameters]).constants(readings)[0].tolist())

    return make


@pytest.fixture(scope="session")
def random_states() -> Callable[..., list[np.ndarray]]:
    """Seeded states (x, y, φ, ẋ, ẏ, φ̇) around the working range, tilts of both signs."""

    def make(count: int, seed: int = 1) -> list[np.ndarray]:
        low = np.array([-1.5, 3.0, -0.9, -2.0, -2.0, -1.0])
        high = np.array([1.5, 5.0, 0.9, 2.0, 2.0, 1.0])
        return list(np.random.default_rng(seed).uniform(low, high, size=(count, 6)))

    return make


@pytest.fixture(scope="session")
def fixed_study() -> Study:
    """The study of the project, of the tests' own device and law of random sets."""
    own = yaml.safe_load((Path(__file__).parent / "device.yaml").read_text(encoding="utf-8"))
    stated = read_study(study_path())
    stated["structure"], stated["operating_point"] = own["structure"], own["operating_point"]
    stated["accuracy"]["ranges"] = own["ranges"]
    for name, held in own["held"].items():
        stated["figures"][name]["held"] = held
    return check_study(stated)


@pytest.fixture(scope="session")
def small_study(fixed_study: Study) -> Callable[[int, int], Study]:
    """The same with two curves of ``points``, and maps of ``cells`` squared with few starts."""

    def make(points: int, cells: int) -> Study:
        small = dict(fixed_study.figures)
        for name, spec in fixed_study.figures.items():
            if isinstance(spec, Curves):
                swept = spec.swept.model_copy(update={"count": points})
                few = Family(parameter=spec.family.parameter, values=spec.family.values[:2])
                small[name] = spec.model_copy(update={"swept": swept, "family": few})
            elif isinstance(spec, Map):
                x, y = (axis.model_copy(update={"count": cells}) for axis in (spec.x, spec.y))
                small[name] = spec.model_copy(update={"x": x, "y": y})
        every = fixed_study.maps.ensemble.model_copy(update={"phases": 2, "every": 2})
        maps = fixed_study.maps.model_copy(update={"ensemble": every})
        return fixed_study.model_copy(update={"figures": small, "maps": maps})

    return make


@pytest.fixture
def _no_leeways(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave out the leeways, or the reliable values beside: most runs of an assessment."""
    module = importlib.import_module("vibralign.answers.assess")  # not the function
    for name, nothing in {"leeways": (), "nearest": ()}.items():
        monkeypatch.setattr(module, name, lambda *_, nothing=nothing: nothing)


# --- A dataset of a figure ------------------------------------------------------------------------


def _dataset(shift: float = 0.0, figure: str = "fig06") -> xr.Dataset:
    """A figure's dataset of 2 × 2 points, one of which does not align."""
    dims = ("tilt_stiffness", "press_force")
    tau = np.array([[1.0, 2.0], [3.0 + shift, np.nan]])
    return xr.Dataset(
        {
            "tau_align": (dims, tau),
            "tau_error": (dims, np.where(np.isnan(tau), np.nan, 1e-8)),
            "outcome": (dims, np.isnan(tau).astype(np.int8)),
            "reason": (dims, np.zeros((2, 2), dtype=np.int8)),
            "sensitive": (dims, np.zeros((2, 2), dtype=np.int8)),
        },
        {"tilt_stiffness": [5.0, 7.0], "press_force": [1.0, 2.0]},
        {"figure": figure, "config_hash": "0", "kind": "curves"},
    )


@pytest.fixture
def make_dataset() -> Callable[..., xr.Dataset]:
    return _dataset
