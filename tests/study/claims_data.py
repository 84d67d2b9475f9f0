"""Made-up datasets for the claims ledger: of each claim data that satisfy it, and that do not.

Only what a check reads has a shape worth looking at; the rest is filled with what decides nothing.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from model.study.config.figures import MAPS

Function = Callable[[Any, Any], Any]
Datasets = dict[str, xr.Dataset]
NAN = np.nan
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
    "rubbing": ("press_force", [1.0, 3.0], "friction", 0.0, 1.0),
    "by_frequency": ("frequency", [0.5, 10.0], "press_force", 0.25, 10.0),
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
        "tilt_end": np.full(tau.shape, 0.05),
        "way": np.where(aligned, 1.0, 0.0),
        "excursion": np.full(tau.shape, 0.5),
        "side_force_max": np.zeros(tau.shape),
    }


def _held(varied: set[str]) -> dict[str, float]:
    held = {"half_width": 1.0, "clearance": 0.1, "initial_tilt": 0.001, "frequency": 5.0}
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


def zigzag(_at: float, x: float) -> float:
    """No trend along x."""
    return 1.0 + 0.3 * np.sin(300.0 * x)


def falling(_at: float, x: float) -> float:
    return 10.0 / (1.0 + x)


def rising(_at: float, x: float) -> float:
    return 1.0 + x


Case = tuple[Datasets, Datasets]


def case(
    figure: str,
    satisfied: Function | float,
    violated: Function | float,
    of: str = "tau",
    **others: Function | float,
) -> Case:
    """Values of a variable, the duration if not named, that satisfy a claim, and that do not."""
    return runs(figure, **{of: satisfied, **others}), runs(figure, **{of: violated, **others})


# Of each claim: data that satisfy it, and data that do not.
CASES: dict[str, Case] = {
    "N1": ({**runs("fig06"), **runs("fig13", 5.0)}, runs("fig06", separations=2.0)),
    "M1": (
        {**runs("centred", excursion=0.0), **runs("misaligned")},
        {**runs("centred", excursion=0.1), **runs("misaligned")},
    ),
    "M1b": (
        {**runs("centred", excursion=lambda t, _: 10.0 * t), **runs("misaligned")},
        {**runs("centred", excursion=0.1), **runs("misaligned")},
    ),
    "M2": case("pressed", lambda k, f: f / k, 0.1, of="tilt_end", tau=NAN),
    "M2b": case("fig07", 5.0, within(0.01, 0.3)),
    "M2c": case("pressed", lambda k, f: f / k, lambda k, f: f * k, of="tilt_end", tau=NAN),
    "M3": case(
        "misaligned",
        lambda f, _: 5.0 if f == 1.0 else NAN,
        lambda f, m: 5.0 if f == 1.0 and m < 0.35 else NAN,
    ),
    "M4": case("pressed", NAN, 5.0),
    "M4b": (
        {**Course().datasets, **runs("fig06", unvibrated_tilt=lambda _, f: 0.03 * f)},
        runs("fig06", unvibrated_tilt=lambda _, f: 0.06 * f),
    ),
    "M9": (
        {**Course().datasets, **runs("fig06", lambda _, f: 5.0 if f < 4.0 else NAN)},
        runs("fig06", lambda k, f: 5.0 if k > 5.0 or f < 0.6 else NAN),
    ),
    "M2d": ({**Course().datasets, **runs("fig06")}, runs("fig06", tilt_at_alignment=-0.2)),
    "M2e": (runs("fig06"), runs("fig06", tilt_max=0.2)),
    "M5": (
        runs("displaced", side_force_max=lambda _, k: 1.0 if k < 5.0 else 0.0),
        runs("displaced"),
    ),
    "M6": ({**Course().datasets, **runs("fig06")}, runs("fig06", tau_corners_inside=8.0)),
    "M7": (runs("fig06", contact_force_max=lambda _, f: 1.0 + f), runs("fig06")),
    "F5a": (Course().datasets, Course(x=lambda t: 0.2 + 0.0 * t).datasets),
    "F5b": (
        Course().datasets,
        Course(y=lambda t: 4.1 + 0.01 * t, tilt=lambda t: 0.1 - 0.01 * t).datasets,
    ),
    "F5c": (Course().datasets, Course(force=lambda t: np.where(t < 10.0, 1.5, 0.0)).datasets),
    "F5d": (Course().datasets, Course(tilt=lambda t: 0.04 * t).datasets),
    "F5e": (Course().datasets, Course(force=lambda t: np.maximum(3.0 - 0.3 * t, 0.0)).datasets),
    "F5f": case("fig11", lambda _, d: 1.0 - d, zigzag, of="tilt_at_alignment"),
    "F6a": case(
        "fig06", lambda _, f: 9.0 if f < 2.0 else 5.0, lambda _, f: 4.0 if f < 2.0 else 5.0
    ),
    "F6b": case("fig06", bump, falling),
    "F6c": case("fig06", within(1.0, 6.0), 5.0),
    "F6d": case("fig06", falling, rising),
    "F6e": (
        {**runs("fig06", falling), **runs("fig12", falling)},
        {**runs("fig06"), **runs("fig12", lambda _, f: 5.0 + 0.01 * f)},
    ),
    "F7a": case("fig07", rising, falling),
    "F7b": case(
        "fig07",
        lambda _, m: 5.0 + 10.0 * min(m, 0.1) + m,
        lambda _, m: 5.0 + 10.0 * max(m - 0.1, 0.0) + m,
    ),
    "F7c": case(
        "fig07", lambda _, m: 5.0 + 10.0 * m, lambda f, m: 5.0 + m if f < 3.0 else 5.0 + 50.0 * m
    ),
    "F7d": case("fig07", lambda f, m: 5.0 + 20.0 * m / f, lambda _, m: 5.0 + 20.0 * m),
    "F7e": case(
        "fig07",
        lambda f, m: 5.0 + (20.0 if f < 3.0 else 2.0) * min(m, 0.15),
        lambda f, m: 5.0 + (2.0 if f < 3.0 else 9.0) * m**2,
    ),
    "F8a": case("fig08", within(8.0, 30.0), 5.0),
    "F8b": case("fig08", falling, rising),
    "F8c": case(
        "fig08", lambda v, k: 5.0 if k > 3.0 + v else NAN, lambda v, k: 5.0 if k > 14.0 - v else NAN
    ),
    "F8d": case(
        "displaced",
        lambda v, k: float(k > 3.0 + 2.0 * v),
        lambda v, k: float(k > 23.0 - v),
        of="way",
        tau=NAN,
    ),
    "F8e": case("fig09", lambda f, _: 10.0 / f, lambda f, _: 10.0 * f),
    "F8f": case("rubbing", within(0.0, 0.6), 5.0),
    "F8g": case("fig08", lambda v, k: 5.0 if k > 3.0 + v else NAN, within(5.0, 30.0)),
    "F8h": case("fig08", lambda _, k: 1.0 / k, lambda _, k: k, of="tilt_max"),
    "F8i": case(
        "fig08", lambda _, k: 1.0 / k, lambda _, k: k, of="tilt_max", tau=within(8.0, 30.0)
    ),
    "F8j": case("fig08", lambda v, _: 5.0 + v, lambda v, _: 5.0 + 0.01 * v),
    "F9a": case("fig09", falling, rising),
    "F9b": case("fig09", lambda f, k: NAN if f > 2.0 and k < 10.0 else 5.0, 5.0),
    "F9c": case(
        "fig09",
        within(10.0, 30.0, lambda _, k: 4.0 + 40.0 / (k - 8.0)),
        within(10.0, 30.0, lambda _, k: 6.0 - 0.01 * k),
    ),
    "F9d": case(
        "fig09",
        within(10.0, 30.0, lambda f, k: 4.0 + f * 20.0 / k),
        within(10.0, 30.0, lambda f, k: 4.0 + 20.0 / (f * k)),
    ),
    "F9e": case("fig09", lambda _, k: 1.0 / k, lambda _, k: k, of="tilt_max"),
    "F9f": case("fig09", falling, rising),
    "F9g": case("fig09", lambda _, k: 0.001 + 1.0 / k**2, 0.2, of="tilt_max"),
    "F9h": case(
        "fig09",
        within(10.0, 30.0, lambda _, k: 4.0 + 40.0 / (k - 8.0)),
        within(10.0, 30.0, lambda _, k: 9.0 - 0.001 * k**2),
    ),
    "F10": case("fig10", rising, falling),
    "F11a": case("fig11", lambda m, d: 9.0 - 20.0 * d + m, lambda _, d: 2.0 + abs(d - 0.09)),
    "F11b": case(
        "fig11", lambda m, d: 9.0 - 20.0 * d + 10.0 * m, lambda m, d: 9.0 - 20.0 * d - 10.0 * m
    ),
    "F11c": case("fig11", lambda _, d: 9.0 - 20.0 * d, lambda _, d: 9.0 + 20.0 * d),
    "F11d": case("fig11", lambda m, d: 9.0 - 20.0 * d + m, lambda m, d: 9.0 - 200.0 * m * d),
    "C6": case("fig11", lambda _, d: 0.5 / d, lambda _, d: 9.0 - 20.0 * d),
    "F12": case("fig12", lambda d, f: 5.0 + (f - 5.0) ** 2 if d > 0.06 else 5.0, falling),
    "F12b": (
        {**runs("fig06", falling), **runs("fig12", rising)},
        {**runs("fig06", falling), **runs("fig12", lambda _, f: 40.0 / (1.0 + f))},
    ),
    "C1b": case(
        "by_frequency",
        lambda v, f: 5.0 + abs(f - (3.0 if v > 1.0 else 7.0)),
        lambda v, f: 5.0 + v + abs(f - 3.0),
    ),
    "F13": case("fig13", lambda f, k: 5.0 if k > 2.0 * f else NAN, 5.0),
    "F13b": case(
        "fig13",
        lambda f, k: 5.0 if k > 2.0 * f else NAN,
        lambda _, k: 5.0 if round(3.0 * k) % 3 else NAN,
    ),
    "F14": case("fig14", lambda v, k: 5.0 if k > v else NAN, NAN),
    "F14b": case(
        "fig14", lambda v, k: 5.0 if k > v else NAN, lambda _, k: 5.0 if round(3.0 * k) % 3 else NAN
    ),
    "C1a": case(
        "fig13", lambda f, k: 5.0 if k > 2.0 * f else NAN, lambda f, _: 5.0 if f < 4.0 else NAN
    ),
    "C2": (
        {**runs("fig08", falling), **runs("fig09", falling)},
        {**runs("fig08"), **runs("fig09")},
    ),
    "C2a": (
        {
            **runs("fig08", within(1.0, 9.9)),
            **runs("fig06", lambda k, _: 5.0 if k < 10.0 else NAN),
            **runs("fig13", lambda _, k: 5.0 if k < 10.0 else NAN),
        },
        {**runs("fig08"), **runs("fig14", 5.0)},
    ),
    "C2b": (
        {**runs("fig13", falling), **runs("fig14", falling)},
        {**runs("fig13", rising), **runs("fig14", rising)},
    ),
    "C2c": case(
        "fig14", lambda v, k: 5.0 if k < 10.0 + v else NAN, lambda v, k: 5.0 if k > v else NAN
    ),
    "C8": (
        {**runs("fig13", within(5.0, 25.0)), **runs("fig14", within(5.0, 25.0))},
        {**runs("fig13", within(5.0, 6.0)), **runs("fig14", within(5.0, 6.0))},
    ),
    "C8c": ({**Course().datasets, **runs("fig06")}, runs("fig06", tau_corners_inside=NAN)),
}


def with_sensitive_noise(datasets: Datasets) -> Datasets:
    """Every fifth point of curves and maps turned into its opposite, and flagged as sensitive."""
    noisy = {}
    for name, dataset in datasets.items():
        outcome = dataset["outcome"]
        hit = xr.zeros_like(outcome, dtype=bool)
        # Where a claim looks at one end alone, that end stays known.
        if outcome.ndim:
            hit.values[...] = np.arange(outcome.size).reshape(outcome.shape) % 5 == 2
            hit.values[..., 0] = False
        changed = dataset.where(~hit, 37.0)
        changed["outcome"] = xr.where(hit, 1 - outcome, outcome)
        noisy[name] = changed.assign(sensitive=hit.astype(np.int8))
    return noisy
