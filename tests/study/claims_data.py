"""Made-up datasets for the claims ledger.

Only what a check reads has a shape worth looking at; the rest is filled with what decides nothing.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from model.events.outcomes import InsertionOutcome
from study.config.figures import MAPS

Function = Callable[[Any, Any], Any]
Datasets = dict[str, xr.Dataset]
NAN = np.nan
IN_SLOT = InsertionOutcome
POINTS, CELLS = 40, 24  # along a curve, and along a side of a map

AXES: Mapping[str, tuple[str, Sequence[float] | np.ndarray, str, float, float]] = {
    "fig06": ("tilt_stiffness", [5.0, 7.0, 10.0, 15.0, 20.0], "press_force", 0.25, 10.0),
    "fig07": ("press_force", [1.0, 2.0, 3.0, 5.0], "friction", 0.0, 0.3),
    "fig08": ("frequency", [0.5, 1.0, 5.0, 10.0], "tilt_stiffness", 1.0, 30.0),
    "fig09": ("press_force", [1.0, 2.5, 5.0], "tilt_stiffness", 1.0, 30.0),
    "fig10": ("frequency", [1.0, 10.0], "inertia", 5.0, 45.0),
    "fig11": ("friction", [0.05, 0.1, 0.2], "clearance", 0.03, 0.15),
    "fig12": ("clearance", [0.05, 0.09], "press_force", 0.25, 10.0),
    "centred": ("initial_tilt", [0.0, 0.001], "frequency", 1.0, 10.0),
    "pressed": ("tilt_stiffness", [7.0, 12.0, 20.0], "press_force", 0.5, 5.0),
    "misaligned": ("press_force", [1.0, 2.0], "misalignment", 0.2, 1.0),
    "displaced": ("frequency", [0.5, 1.0, 5.0, 10.0], "tilt_stiffness", 1.0, 30.0),
    "rocking": ("press_force", [1.0], "tilt_stiffness", 15.0, 30.0),
    "rubbing": ("press_force", [1.0, 3.0], "friction", 0.0, 1.0),
    "by_frequency": ("frequency", [0.5, 10.0], "press_force", 0.25, 10.0),
    "coarse_13": ("press_force", [2.0, 5.0, 8.0], "tilt_stiffness", 1.0, 30.0),
    "fig13": ("press_force", np.linspace(0.25, 10.0, CELLS), "tilt_stiffness", 1.0, 30.0),
    "fig14": ("frequency", np.linspace(0.2, 15.0, CELLS), "tilt_stiffness", 1.0, 30.0),
}


def _filled(tau: np.ndarray) -> dict[str, np.ndarray]:
    aligned = np.isfinite(tau)
    return {
        "tau_align": tau,
        "outcome": np.where(aligned, 0, 1).astype(np.int8),
        "sensitive": np.zeros(tau.shape, np.int8),
        "separations": np.zeros(tau.shape, np.int32),
        "tau_corners_inside": tau * 1.001,
        "tilt_at_alignment": np.where(aligned, 0.1, NAN),
        "tilt_max": np.full(tau.shape, 0.1),
        "contact_force_max": np.full(tau.shape, 5.0),
        "unvibrated": np.ones(tau.shape, np.int8),
        "unvibrated_tilt": np.full(tau.shape, 0.05),
        "insertion": np.where(aligned, IN_SLOT.INSERTED, IN_SLOT.NOT_ALIGNED).astype(np.int8),
        "tilt_end": np.full(tau.shape, 0.05),
        "way": np.where(aligned, 1.0, 0.0),
        "unvibrated_way": np.zeros(tau.shape),
        "excursion": np.full(tau.shape, 0.5),
        "tilt_min": np.full(tau.shape, 0.04),
        "side_force_max": np.zeros(tau.shape),
    }


def _held(varied: set[str]) -> dict[str, float]:
    held = {
        "half_width": 1.0, "clearance": 0.1, "initial_tilt": 0.001, "frequency": 5.0,
        "press_force": 2.0, "tilt_stiffness": 12.0,
    }  # fmt: skip
    return {name: value for name, value in held.items() if name not in varied}


def _values(function: Function | float, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    if not callable(function):
        return np.full((first.size, second.size), function)
    return np.vectorize(function, otypes=[np.float64])(first[:, None], second)


def runs(
    figure: str, tau: Function | float = 5.0, points: int = POINTS, **others: Function | float
) -> Datasets:
    """A figure: ``tau`` and other variables as functions of the slow and the swept parameter."""
    slow, values, swept, low, high = AXES[figure]
    is_map = figure in MAPS
    at, x = np.array(values), np.linspace(low, high, CELLS if is_map else points)
    rows = _filled(_values(tau, at, x))
    rows |= {name: _values(each, at, x) for name, each in others.items()}
    variables = {name: ((slow, swept), row) for name, row in rows.items()}
    coordinates = {slow: at, swept: x, **_held({slow, swept})}
    stated = {"figure": figure, "kind": "map" if is_map else "curves"}
    return {figure: xr.Dataset(variables, coordinates, stated)}


class Course(NamedTuple):
    """Fig. 5 as functions of time; it aligns at τ = 10."""

    x: Callable[[Any], Any] = lambda t: 0.2 - 0.02 * t
    y: Callable[[Any], Any] = lambda t: 4.1 - 0.01 * t + 0.05 * np.sin(5.0 * t)
    tilt: Callable[[Any], Any] = lambda t: 0.001 + 0.01 * t
    force: Callable[[Any], Any] = lambda t: np.where(t < 10.0, 1.5 + np.sin(5.0 * t), 0.0)

    @property
    def datasets(self) -> Datasets:
        time = np.linspace(0.0, 11.0, 1101)
        time = np.sort(np.append(time, 10.0 - 1e-12))
        courses = {"x": self.x, "y": self.y, "tilt": self.tilt, "contact_force": self.force}
        variables: dict[str, Any] = {
            name: ("time", np.broadcast_to(course(time), time.shape).astype(np.float64))
            for name, course in courses.items()
        }
        rows = _filled(np.array(10.0))
        rows["tilt_at_alignment"] = np.asarray(self.tilt(10.0), dtype=np.float64)
        variables |= {name: ((), row) for name, row in rows.items()}
        coordinates = {"time": time, **_held(set())}
        return {"fig05": xr.Dataset(variables, coordinates, {"figure": "fig05", "kind": "history"})}


def within(low: float, high: float, function: Function | float = 5.0) -> Function:
    """``function`` where low <= x <= high, no alignment elsewhere."""

    def inside(at: float, x: float) -> float:
        if not low <= x <= high:
            return NAN
        return float(function(at, x) if callable(function) else function)

    return inside


def bump(_at: float, x: float) -> float:
    """Falls, rises between f0 = 1 and 1.6, falls again."""
    return float(np.interp(x, [0.25, 1.0, 1.6, 10.0], [10.0, 6.0, 8.0, 3.0]))


def ragged(_at: float, x: float) -> float:
    """Up and down all along."""
    return 6.0 - 0.2 * x + (1.0 if round(4.0 * x) % 2 else 0.0)


def falling(_at: float, x: float) -> float:
    return 10.0 / (1.0 + x)


def rising(_at: float, x: float) -> float:
    return 1.0 + x


def one_run(**changed: float) -> Datasets:
    """Fig. 5 with variables changed."""
    dataset = Course().datasets["fig05"].copy(deep=True)
    for name, value in changed.items():
        dataset[name].values[...] = value
    return {"fig05": dataset}


def with_sensitive_noise(datasets: Datasets) -> Datasets:
    """Every fifth point of curves and maps turned into its opposite, and flagged as sensitive."""
    noisy = {}
    for name, dataset in datasets.items():
        outcome = dataset["outcome"]
        hit = xr.zeros_like(outcome, dtype=bool)
        # Where a claim looks at one end alone, that end stays known; each run of "centred" is one.
        if outcome.ndim and name != "centred":
            hit.values[...] = np.arange(outcome.size).reshape(outcome.shape) % 5 == 2
            hit.values[..., 0] = False
        changed = dataset.where(~hit, 37.0)
        changed["outcome"] = xr.where(hit, 1 - outcome, outcome)
        noisy[name] = changed.assign(sensitive=hit.astype(np.int8))
    return noisy
