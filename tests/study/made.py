"""A made-up device of which every entry of the ledger is shown, figure by figure."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from model.events.outcomes import Outcome, Unvibrated
from study.claims.data import Figure

NAN = np.nan
HELD = {"frequency": 2.0 * np.pi, "press_force": 1.0, "initial_tilt": 0.001}
AXES: Mapping[str, tuple[str, Sequence[float] | np.ndarray, str, np.ndarray]] = {
    "fig06": ("tilt_stiffness", [5, 7, 10, 20], "press_force", np.linspace(0.25, 20.0, 159)),
    "fig07": ("press_force", [1, 2, 3, 5], "friction", np.linspace(0.01, 0.3, 30)),
    "fig08": ("frequency", [0.5, 1, 5, 10, 15], "tilt_stiffness", np.linspace(1.0, 40.0, 79)),
    "fig09": ("press_force", [1, 2.5, 3.5, 5], "tilt_stiffness", np.linspace(1.0, 40.0, 79)),
    "fig10": ("frequency", [0.5, 1, 5, 10], "inertia", np.linspace(1.0, 4.0, 16)),
    "fig11": ("friction", [0.05, 0.1, 0.15, 0.2], "clearance", np.linspace(0.03, 0.15, 25)),
    "fig12": ("clearance", [0.05, 0.09, 0.15], "press_force", np.linspace(0.25, 20.0, 159)),
    "fig13": ("press_force", np.linspace(0.25, 20.0, 80), "tilt_stiffness",
              np.linspace(1.0, 40.0, 40)),
    "fig14": ("frequency", np.linspace(0.2, 20.0, 100), "tilt_stiffness",
              np.linspace(1.0, 40.0, 40)),
}  # fmt: skip


def made(name: str, tau: Callable[[Any, Any], Any], **results: Any) -> Figure:
    """Return a figure with a duration, NaN where it does not align, and further results.

    Each is a function of the values by which curves differ and those along them, or a number.
    """
    by_name, by, x_name, x = AXES[name]
    rows, columns = np.meshgrid(np.asarray(by, float), x, indexing="ij")
    times = np.vectorize(tau, otypes=[float])(rows, columns)
    aligned = np.isfinite(times)
    usual: dict[str, Any] = {
        "separations": 0, "tilt_at_alignment": 0.05, "tilt_max": 0.1, "sensitive": 0,
        "unvibrated": Unvibrated.RESTS, "unvibrated_tilt": 0.05,
    }  # fmt: skip
    found = {
        key: np.vectorize(of, otypes=[float])(rows, columns)
        if callable(of)
        else np.full(times.shape, of)
        for key, of in {**usual, **results}.items()
    }
    found |= {
        "tau_align": times,
        "tau_corners_inside": times,
        "outcome": np.where(aligned, Outcome.ALIGNED, Outcome.SETTLED),
    }
    kind = "map" if len(by) > 5 else "curves"
    held = {key: value for key, value in HELD.items() if key not in (by_name, x_name)}
    return Figure(name, kind, {by_name: np.asarray(by, float), x_name: x}, found, held, {})


def history(**changes: Any) -> Figure:
    """Return Fig. 5: over ten periods x and y fall, the tilt grows, and the force drops at last."""
    time = np.sort(np.concatenate([np.linspace(0.0, 10.5, 400), [10.0, 10.0]]))
    gone = np.arange(time.size) > np.flatnonzero(time == 10.0)[0]
    course = {
        "time": time, "x": 0.2 - 0.02 * time, "tilt": 0.001 + 0.005 * time,
        "y": 3.0 - 0.01 * time, "contact_force": np.where(gone, 0.0, 2.0),
    }  # fmt: skip
    results = {
        "outcome": Outcome.ALIGNED, "tau_align": 10.0, "tau_corners_inside": 10.1, "sensitive": 0,
        "tilt_at_alignment": 0.05, "tilt_max": 0.06, "separations": 0,
        "unvibrated": Unvibrated.RESTS, "unvibrated_tilt": 0.05,
    }  # fmt: skip
    course |= {n: of(time) for n, of in changes.items() if n in course}
    results |= {n: value for n, value in changes.items() if n in results}
    grid = {name: np.full((1, 1), value) for name, value in results.items()}
    return Figure("fig05", "history", {}, grid, HELD, course)


def locked(drift: float) -> Figure:
    """Return the runs with the tilt held, which the vibration moves by ``drift``."""
    ends = np.array([np.full(21, 0.2), np.full(21, 0.2 - drift)])
    axes = {"vibrated": np.array([0.0, 1.0]), "run": np.arange(21.0)}
    return Figure("locked", "curves", axes, {"x_end": ends, "sensitive": 0 * ends}, {}, {})


def bumpy(k: float, f: float) -> float:
    """Fig. 6: soft springs align slowly and at every force, stiff ones up to 9, with a bump."""
    if k < 10.0:
        return 40.0 / (0.5 + f)
    return float(np.interp(f, [0.25, 1.0, 1.5, 9.0], [20.0, 10.0, 14.0, 5.0], right=NAN))


def tilting(v: float, k: float) -> float:
    """Fig. 8: at high frequencies a narrower range of springs aligns."""
    low, high = (4.0, 36.0) if v < 10.0 else (12.0, 30.0)
    return (1.0 + v) * 100.0 / k if low <= k <= high else NAN


WORLD: Mapping[str, Figure] = {
    "fig05": history(),
    "fig06": made("fig06", bumpy),
    "fig07": made("fig07", lambda f, m: 10.0 + (9.0 if f < 3.0 else 3.0) * m**0.4),
    "fig08": made("fig08", tilting, tilt_max=lambda v, k: 0.3 if np.isnan(tilting(v, k)) else 0.1),
    "fig09": made(
        "fig09",
        lambda f, k: f * 100.0 / k if k >= (10.0 if f > 1.0 else 2.0) else NAN,
        tilt_max=lambda _, k: 1.0 / k,
    ),
    "fig10": made("fig10", lambda v, i: i * (1.0 + v)),
    "fig11": made("fig11", lambda m, d: 10.0 + m - 30.0 * d),
    "fig12": made("fig12", lambda _, f: 5.0 + (f - 3.0) ** 2 if f < 7.0 else NAN),
    "fig13": made("fig13", lambda f, k: 20.0 / k + f / 10.0 if f <= k / 4.0 else NAN),
    "fig14": made(
        "fig14",
        lambda v, k: 20.0 / k + v if 3.0 <= k <= (35.0 if v <= 1.0 else 25.0 - v / 2.0) else NAN,
    ),
    "locked": locked(0.0),
}
SLIDES = made("fig06", bumpy, unvibrated=Unvibrated.ALIGNS)
HOPS = made("fig06", bumpy, separations=1)
TOPPLES = made("fig06", bumpy, unvibrated=Unvibrated.LEAVES)
# What makes an entry fail, one part after the other where it has several.
WRONG: Mapping[str, Sequence[Figure]] = {
    "L01": [
        made("fig13", lambda f, k: f + k if f < 5.0 else NAN),
        made("fig14", lambda v, k: v + k),
    ],
    "L02": [SLIDES, history(unvibrated=Unvibrated.ALIGNS)],
    "L03": [
        history(x=lambda t: 0.2 + 0.02 * t),
        history(tilt=lambda t: 0.05 - 0.004 * t),
        history(y=lambda t: 3.0 - 0.01 * t + 0.03 * np.sin(t)),
    ],
    "L04": [
        history(tau_corners_inside=11.0),
        history(tilt_at_alignment=0.2),
        history(tilt_at_alignment=-0.05),
        history(contact_force=lambda t: np.where(t < 9.3, 2.0, np.where(t < 10.0, 0.1, 0.0))),
        history(contact_force=lambda t: np.full(t.shape, 2.0)),
    ],
    "L05": [HOPS, history(separations=1)],
    "L06": [made("fig14", lambda v, k: k if 3.0 <= k <= (20.0 if v <= 1.0 else 25.0) else NAN)],
    "L07": [made("fig08", lambda _, k: k), made("fig09", lambda f, k: f * k)],
    "L08": [made("fig12", lambda _, f: 50.0 - f if f < 15.0 else NAN)],
    "L09": [
        made("fig13", lambda _, k: k),
        made("fig13", lambda f, k: NAN if (2 < f < 8 and 10 < k < 20) or f > 15 else k),
        made("fig14", lambda _, k: k if int(k) % 4 else NAN),
    ],
    "L10": [
        made("fig13", lambda _, k: k if int(k) % 2 else NAN),
        made(
            "fig14",
            lambda v, k: (
                1.0 + 0.001 * v if k > 34.0 or v < 0.3 else (0.1 if int(5.0 * v) % 2 else NAN)
            ),
        ),
    ],
    "L11": [
        made("fig13", lambda f, k: k if f <= k / 2.0 else NAN),
        made("fig13", lambda f, k: k if f <= k / 8.0 else NAN),
    ],
    "L12": [made("fig13", lambda f, k: k if f < 19.0 or k < 5.0 else NAN)],
    "L13": [TOPPLES],
    "L14": [locked(0.02)],
    "L15": [
        made("fig07", lambda f, m: 10.0 - 3.0 * f * m),
        made("fig07", lambda f, m: 10.0 + f * m**2),
        made("fig07", lambda _, m: 10.0 + 9.0 * m**0.4),
    ],
    "L16": [
        made("fig07", lambda _, m: 10.0 + m**0.4),
        made("fig07", lambda f, m: 1.0 + m * (5.0 - f)),
        made("fig07", lambda _, m: 10.0 + 9.0 * m**0.4),
    ],
    "L17": [
        made("fig09", lambda f, k: 100.0 / f / k),
        made("fig09", lambda f, k: 100.0 / k if f != 2.5 else 60.0 / k),
    ],
    "L18": [made("fig11", lambda _, d: 10.0 + 30.0 * d)],
    "L19": [made("fig11", lambda _, d: 1.0 / d), made("fig11", lambda m, d: 30.0 - 500.0 * m * d)],
    "L20": [made("fig14", lambda _, k: k), made("fig14", lambda _, k: k if k < 20.0 else NAN)],
    "L21": [
        made("fig06", lambda k, f: 40.0 / f if k > 8.0 or f < 5.0 else NAN),
        made("fig06", lambda k, f: 40.0 / f if f < k / 3.0 else NAN),
    ],
    "L22": [
        made("fig06", lambda _, f: 10.0 + f),
        made("fig06", lambda _, f: 40.0 / f if f < 9.0 else 40.0),
        made("fig06", lambda k, f: (40.0 if k < 10.0 else 160.0) / (0.5 + f)),
    ],
    "L23": [
        made("fig06", lambda _, f: 40.0 / f),
        made("fig06", lambda _, f: float(np.interp(f, [0.25, 3.0, 4.0, 9.0], [20, 10, 14, 5]))),
        made("fig06", lambda _, f: float(np.interp(f, [0.25, 0.5, 1.9, 9.0], [20, 10, 14, 5]))),
    ],
    "L24": [
        made("fig12", lambda _, f: 30.0 - f),
        made("fig12", lambda _, f: 50.0 + (f - 10.0) ** 2 / 30.0),
    ],
    "L25": [made("fig08", lambda v, k: k if 4.0 <= k <= (30.0 if v != 10.0 else 35.0) else NAN)],
    "L26": [made("fig08", lambda _, k: k), made("fig08", tilting, tilt_max=0.1)],
    "L27": [made("fig09", lambda f, k: f / k if k >= 8.0 else NAN)],
    "L28": [made("fig10", lambda _, i: 5.0 - i)],
    "L29": [
        made("fig09", lambda _, k: 10.0 - 0.01 * k, tilt_max=lambda _, k: 1.0 / k),
        made("fig09", lambda _, k: 100.0 / k, tilt_max=lambda _, k: k / 100.0),
        made("fig09", lambda _, k: 100.0 / k, tilt_max=lambda _, k: 10.0 / k),
        made("fig09", lambda _, k: 200.0 if k <= 15.0 else 3.0 * k, tilt_max=lambda _, k: 1.0 / k),
    ],
    "L30": [made("fig08", lambda _, k: 100.0 / k)],
}
