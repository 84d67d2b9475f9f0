"""Runs once more with the tilt held at zero, with and without the vibration (L14)."""

from dataclasses import replace

import numpy as np

from model.physics.parameters import PARAMETER_NAMES, Parameters
from model.runs.settings import Settings
from model.runs.simulate import simulate_once
from study.claims.data import Curve, Figure, Figures

_FROM = tuple(f"fig{number:02}" for number in range(6, 13))
_DRAWN = 20
_HELD = {"inertia": 1e12, "initial_tilt": 0.0, "rest_tilt": 0.0}  # no moment turns such a part


def locked_of(figures: Figures, settings: Settings) -> Figure:
    """Return the runs of Fig. 5 and of evenly drawn aligned runs of Figs. 6 to 12, tilt locked.

    Curves 0 and 1 are without and with the vibration. ``x_end`` is the mean of x over the last
    excitation period before the free part's alignment time; NaN where Fig. 5 does not align.
    """
    aligned = [figures[name].whole.where(figures[name].whole.aligned) for name in _FROM]
    every = [(runs, row) for runs in aligned for row in range(runs.x.size)]
    places = np.linspace(0, len(every) - 1, min(_DRAWN, len(every))).round().astype(int)
    drawn = [every[place] for place in places]
    runs = [(figures["fig05"].whole, 0), *drawn]
    # The pressed start would tilt the part at once.
    settings = replace(settings, start="simultaneous")
    ends = np.array(
        [[_end(curve, row, settings, is_on) for curve, row in runs] for is_on in (False, True)]
    )
    results = {"x_end": ends, "sensitive": np.zeros(ends.shape, np.int8)}
    axes = {"vibrated": np.array([0.0, 1.0]), "run": np.arange(float(len(runs)))}
    return Figure("locked", "curves", axes, results, {}, {})


def _end(runs: Curve, row: int, settings: Settings, is_on: bool) -> float:
    tau = runs.tau[row]
    if not tau > 0.0:
        return float("nan")
    stated = {n: float(runs.results[n][row]) for n in PARAMETER_NAMES if n in runs.results}
    stated = {name: value for name, value in stated.items() if np.isfinite(value)} | _HELD
    period = 2.0 * np.pi / stated["frequency"]
    still = {} if is_on else {"frequency": 0.0, "phase": 0.0}
    track = simulate_once(Parameters(**stated | still), replace(settings, horizon=float(tau)))
    moments = np.linspace(max(0.0, tau - period), tau, 100)
    return float(np.interp(moments, track.time, track.state[:, 0]).mean())
