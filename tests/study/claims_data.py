"""Made-up datasets for the claims ledger: of each claim data that satisfy it, and that do not.

Only what a check reads has a shape worth looking at; the rest is filled with what decides nothing.
"""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

Function = Callable[[Any, Any], Any]
Datasets = dict[str, xr.Dataset]
NAN = np.nan
POINTS = 40

AXES: Mapping[str, tuple[str, list[float], str, float, float]] = {
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
}
MAPS = {"fig13": ("press_force", 0.25, 10.0), "fig14": ("frequency", 0.2, 15.0)}


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
    shape = (first.size, second.size)
    if not callable(function):
        return np.full(shape, function)
    values = [[function(float(a), float(b)) for b in second] for a in first]
    return np.array(values, dtype=np.float64)


def curves(
    figure: str, tau: Function | float = 5.0, points: int = POINTS, **others: Function | float
) -> Datasets:
    """A figure with curves: ``tau`` and other variables as functions of (family, swept)."""
    family, values, swept, low, high = AXES[figure]
    at, x = np.array(values), np.linspace(low, high, points)
    rows = _filled(_values(tau, at, x))
    rows |= {name: _values(each, at, x) for name, each in others.items()}
    variables = {name: ((family, swept), row) for name, row in rows.items()}
    coordinates = {family: at, swept: x, **_held({family, swept})}
    return {figure: xr.Dataset(variables, coordinates, {"figure": figure})}


def plane(figure: str, tau: Function | float, cells: int = 24) -> Datasets:
    """A map: ``tau`` as a function of (y, x), x being the tilt stiffness."""
    name, low, high = MAPS[figure]
    y, x = np.linspace(low, high, cells), np.linspace(1.0, 30.0, cells)
    rows = _filled(_values(tau, y, x))
    variables = {each: ((name, "tilt_stiffness"), row) for each, row in rows.items()}
    coordinates = {name: y, "tilt_stiffness": x, **_held({name})}
    return {figure: xr.Dataset(variables, coordinates, {"figure": figure})}


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
        return {"fig05": xr.Dataset(variables, coordinates, {"figure": "fig05"})}


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


def durations(figure: str, satisfied: Function | float, violated: Function | float) -> Case:
    """Durations of a figure that satisfy a claim, and that do not."""
    made = plane if figure in MAPS else curves
    return made(figure, satisfied), made(figure, violated)


def values(
    figure: str,
    name: str,
    satisfied: Function | float,
    violated: Function | float,
    tau: Function | float = 5.0,
) -> Case:
    """Values of another variable that satisfy a claim, and that do not; the durations are equal."""
    return curves(figure, tau, **{name: satisfied}), curves(figure, tau, **{name: violated})


# Of each claim: data that satisfy it, and data that do not.
CASES: dict[str, Case] = {
    "N1": ({**curves("fig06"), **plane("fig13", 5.0)}, curves("fig06", separations=2.0)),
    "M1": (
        {**curves("centred", excursion=0.0), **curves("misaligned")},
        {**curves("centred", excursion=0.1), **curves("misaligned")},
    ),
    "M1b": (
        {**curves("centred", excursion=lambda t, _: 10.0 * t), **curves("misaligned")},
        {**curves("centred", excursion=0.1), **curves("misaligned")},
    ),
    "M2": values("pressed", "tilt_end", lambda k, f: f / k, 0.1, tau=NAN),
    "M2b": durations("fig07", 5.0, within(0.01, 0.3)),
    "M2c": values("pressed", "tilt_end", lambda k, f: f / k, lambda k, f: f * k, tau=NAN),
    "M3": durations(
        "misaligned",
        lambda f, _: 5.0 if f == 1.0 else NAN,
        lambda f, m: 5.0 if f == 1.0 and m < 0.35 else NAN,
    ),
    "M4": durations("pressed", NAN, 5.0),
    "M4b": (
        {**Course().datasets, **curves("fig06", unvibrated_tilt=lambda _, f: 0.03 * f)},
        curves("fig06", unvibrated_tilt=lambda _, f: 0.06 * f),
    ),
    "M9": (
        {**Course().datasets, **curves("fig06", lambda _, f: 5.0 if f < 4.0 else NAN)},
        curves("fig06", lambda k, f: 5.0 if k > 5.0 or f < 0.6 else NAN),
    ),
    "M2d": ({**Course().datasets, **curves("fig06")}, curves("fig06", tilt_at_alignment=-0.2)),
    "M2e": (curves("fig06"), curves("fig06", tilt_max=0.2)),
    "M5": (
        curves("displaced", side_force_max=lambda _, k: 1.0 if k < 5.0 else 0.0),
        curves("displaced"),
    ),
    "M6": ({**Course().datasets, **curves("fig06")}, curves("fig06", tau_corners_inside=8.0)),
    "M7": (curves("fig06", contact_force_max=lambda _, f: 1.0 + f), curves("fig06")),
    "F5a": (Course().datasets, Course(x=lambda t: 0.2 + 0.0 * t).datasets),
    "F5b": (
        Course().datasets,
        Course(y=lambda t: 4.1 + 0.01 * t, tilt=lambda t: 0.1 - 0.01 * t).datasets,
    ),
    "F5c": (Course().datasets, Course(force=lambda t: np.where(t < 10.0, 1.5, 0.0)).datasets),
    "F5d": (Course().datasets, Course(tilt=lambda t: 0.04 * t).datasets),
    "F5e": (Course().datasets, Course(force=lambda t: np.maximum(3.0 - 0.3 * t, 0.0)).datasets),
    "F5f": values("fig11", "tilt_at_alignment", lambda _, d: 1.0 - d, zigzag),
    "F6a": durations(
        "fig06", lambda _, f: 9.0 if f < 2.0 else 5.0, lambda _, f: 4.0 if f < 2.0 else 5.0
    ),
    "F6b": durations("fig06", bump, falling),
    "F6c": durations("fig06", within(1.0, 6.0), 5.0),
    "F6d": durations("fig06", falling, rising),
    "F6e": (
        {**curves("fig06", falling), **curves("fig12", falling)},
        {**curves("fig06"), **curves("fig12", lambda _, f: 5.0 + 0.01 * f)},
    ),
    "F7a": durations("fig07", rising, falling),
    "F7b": durations(
        "fig07",
        lambda _, m: 5.0 + 10.0 * min(m, 0.1) + m,
        lambda _, m: 5.0 + 10.0 * max(m - 0.1, 0.0) + m,
    ),
    "F7c": durations(
        "fig07", lambda _, m: 5.0 + 10.0 * m, lambda f, m: 5.0 + m if f < 3.0 else 5.0 + 50.0 * m
    ),
    "F7d": durations("fig07", lambda f, m: 5.0 + 20.0 * m / f, lambda _, m: 5.0 + 20.0 * m),
    "F7e": durations(
        "fig07",
        lambda f, m: 5.0 + (20.0 if f < 3.0 else 2.0) * min(m, 0.15),
        lambda f, m: 5.0 + (2.0 if f < 3.0 else 9.0) * m**2,
    ),
    "F8a": durations("fig08", within(8.0, 30.0), 5.0),
    "F8b": durations("fig08", falling, rising),
    "F8c": durations(
        "fig08", lambda v, k: 5.0 if k > 3.0 + v else NAN, lambda v, k: 5.0 if k > 14.0 - v else NAN
    ),
    "F8d": values(
        "displaced",
        "way",
        lambda v, k: float(k > 3.0 + 2.0 * v),
        lambda v, k: float(k > 23.0 - v),
        tau=NAN,
    ),
    "F8e": durations("fig09", lambda f, _: 10.0 / f, lambda f, _: 10.0 * f),
    "F8f": durations("rubbing", within(0.0, 0.6), 5.0),
    "F8g": durations("fig08", lambda v, k: 5.0 if k > 3.0 + v else NAN, within(5.0, 30.0)),
    "F8h": values("fig08", "tilt_max", lambda _, k: 1.0 / k, lambda _, k: k),
    "F8i": values("fig08", "tilt_max", lambda _, k: 1.0 / k, lambda _, k: k, tau=within(8.0, 30.0)),
    "F8j": durations("fig08", lambda v, _: 5.0 + v, lambda v, _: 5.0 + 0.01 * v),
    "F9a": durations("fig09", falling, rising),
    "F9b": durations("fig09", lambda f, k: NAN if f > 2.0 and k < 10.0 else 5.0, 5.0),
    "F9c": durations(
        "fig09",
        within(10.0, 30.0, lambda _, k: 4.0 + 40.0 / (k - 8.0)),
        within(10.0, 30.0, lambda _, k: 6.0 - 0.01 * k),
    ),
    "F9d": durations(
        "fig09",
        within(10.0, 30.0, lambda f, k: 4.0 + f * 20.0 / k),
        within(10.0, 30.0, lambda f, k: 4.0 + 20.0 / (f * k)),
    ),
    "F9e": values("fig09", "tilt_max", lambda _, k: 1.0 / k, lambda _, k: k),
    "F9f": durations("fig09", falling, rising),
    "F9g": values("fig09", "tilt_max", lambda _, k: 0.001 + 1.0 / k**2, 0.2),
    "F9h": durations(
        "fig09",
        within(10.0, 30.0, lambda _, k: 4.0 + 40.0 / (k - 8.0)),
        within(10.0, 30.0, lambda _, k: 9.0 - 0.001 * k**2),
    ),
    "F10": durations("fig10", rising, falling),
    "F11a": durations("fig11", lambda m, d: 9.0 - 20.0 * d + m, lambda _, d: 2.0 + abs(d - 0.09)),
    "F11b": durations(
        "fig11", lambda m, d: 9.0 - 20.0 * d + 10.0 * m, lambda m, d: 9.0 - 20.0 * d - 10.0 * m
    ),
    "F11c": durations("fig11", lambda _, d: 9.0 - 20.0 * d, lambda _, d: 9.0 + 20.0 * d),
    "F11d": durations("fig11", lambda m, d: 9.0 - 20.0 * d + m, lambda m, d: 9.0 - 200.0 * m * d),
    "C6": durations("fig11", lambda _, d: 0.5 / d, lambda _, d: 9.0 - 20.0 * d),
    "F12": durations("fig12", lambda d, f: 5.0 + (f - 5.0) ** 2 if d > 0.06 else 5.0, falling),
    "F12b": (
        {**curves("fig06", falling), **curves("fig12", rising)},
        {**curves("fig06", falling), **curves("fig12", lambda _, f: 40.0 / (1.0 + f))},
    ),
    "C1b": durations(
        "by_frequency",
        lambda v, f: 5.0 + abs(f - (3.0 if v > 1.0 else 7.0)),
        lambda v, f: 5.0 + v + abs(f - 3.0),
    ),
    "F13": durations("fig13", lambda f, k: 5.0 if k > 2.0 * f else NAN, 5.0),
    "F13b": durations(
        "fig13",
        lambda f, k: 5.0 if k > 2.0 * f else NAN,
        lambda _, k: 5.0 if round(3.0 * k) % 3 else NAN,
    ),
    "F14": durations("fig14", lambda v, k: 5.0 if k > v else NAN, NAN),
    "F14b": durations(
        "fig14", lambda v, k: 5.0 if k > v else NAN, lambda _, k: 5.0 if round(3.0 * k) % 3 else NAN
    ),
    "C1a": durations(
        "fig13", lambda f, k: 5.0 if k > 2.0 * f else NAN, lambda f, _: 5.0 if f < 4.0 else NAN
    ),
    "C2": (
        {**curves("fig08", falling), **curves("fig09", falling)},
        {**curves("fig08"), **curves("fig09")},
    ),
    "C2a": (
        {
            **curves("fig08", within(1.0, 9.9)),
            **curves("fig06", lambda k, _: 5.0 if k < 10.0 else NAN),
            **plane("fig13", lambda _, k: 5.0 if k < 10.0 else NAN),
        },
        {**curves("fig08"), **plane("fig14", 5.0)},
    ),
    "C2b": (
        {**plane("fig13", falling), **plane("fig14", falling)},
        {**plane("fig13", rising), **plane("fig14", rising)},
    ),
    "C2c": durations(
        "fig14", lambda v, k: 5.0 if k < 10.0 + v else NAN, lambda v, k: 5.0 if k > v else NAN
    ),
    "C8": (
        {**plane("fig13", within(5.0, 25.0)), **plane("fig14", within(5.0, 25.0))},
        {**plane("fig13", within(5.0, 6.0)), **plane("fig14", within(5.0, 6.0))},
    ),
    "C8c": ({**Course().datasets, **curves("fig06")}, curves("fig06", tau_corners_inside=NAN)),
}


def with_sensitive_noise(datasets: Datasets) -> Datasets:
    """Every fifth point of curves and maps turned into its opposite, and flagged as sensitive."""
    noisy = {}
    for name, dataset in datasets.items():
        if not dataset["outcome"].ndim:
            noisy[name] = dataset
            continue
        changed = dataset.copy(deep=True)
        shape = dataset["outcome"].shape
        hit = (np.arange(np.prod(shape)).reshape(shape) % 5) == 2
        hit[..., 0] = False  # where a claim looks at one end alone, that end stays known
        outcome = changed["outcome"].values
        outcome[hit] = 1 - outcome[hit]
        changed["outcome"].values[:] = outcome
        for variable in set(changed.data_vars) - {"outcome", "sensitive"}:
            values = changed[variable].values
            values[hit] = (37 * np.arange(hit.sum()) % 100).astype(values.dtype)
        changed["tau_align"].values[outcome == 1] = NAN
        changed["sensitive"].values[hit] = 1
        noisy[name] = changed
    return noisy
