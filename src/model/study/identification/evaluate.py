"""Coarse figures of many candidates at once, and how well they show what the paper says.

All trajectories of all candidates are one batch, so that no lane of the engine waits for another.
Each is run once: an estimated error of every point would double the cost and decide nothing here.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from model.engines.results import RESULTS, RunResult
from model.physics.readings import Readings
from model.runs.engines import batch_engine, scalar_engine
from model.runs.simulate import simulate_once
from model.study.claims import CLAIMS, Claim
from model.study.claims.ledger import judge_claim
from model.study.claims.reading import Data
from model.study.claims.runs import COURSED, course_variables
from model.study.identification.candidate import Space
from model.study.sweeps import Sweep

Array = NDArray[np.float64]
_STORED = [name for name, each in RESULTS.items() if each.stored and not each.estimated]
_WORST = -1.0  # margin of a claim for which there is nothing to measure
_REQUIRED = 3.0  # claims that one which must hold weighs as many as


@dataclass(frozen=True)
class Judge:
    """The claims that count in a score, and how.

    Attributes:
        claims: those that something can be measured by.
        counted: which of them count, shape (claims,).
        goal: margin from which more of it is worth little.
        required: which must hold, as claims of their own that do not count, shape (claims,).
    """

    claims: tuple[Claim, ...]
    counted: NDArray[np.bool_]
    goal: float
    required: NDArray[np.bool_]

    @property
    def ids(self) -> tuple[str, ...]:
        """The claims' names."""
        return tuple(claim.id for claim in self.claims)

    def score(self, margins: Array) -> Array:
        """Sum over the claims that count of what their margins are worth; shape (..., claims) in.

        A margin is worth itself over the goal up to 1, and a tenth of the rest beyond it, so that
        one claim shown clearly does not make up for another not shown.
        """
        return np.asarray(self.worth(margins).sum(axis=-1))

    def worth(self, margins: Array) -> Array:
        """What each claim adds to the score; 0 where it neither counts nor is required."""
        short = np.minimum(margins, self.goal) / self.goal
        worth = np.where(margins < 0.0, 2.0 * margins, short)
        worth = worth + 0.1 * np.maximum(margins - self.goal, 0.0)
        return np.asarray(worth * (self.counted + _REQUIRED * self.required))

    def counting(self, counted: NDArray[np.bool_]) -> "Judge":
        """The same with only some of the claims that count, and none required."""
        none = np.zeros_like(self.required)
        return Judge(self.claims, self.counted & counted, self.goal, none)

    def reproduced(self, margins: Array) -> NDArray[np.int64]:
        """How many of the claims that count are reproduced; shape (..., claims) in."""
        return np.asarray((margins[..., self.counted] > 0.0).sum(axis=-1))

    def holds(self, margins: Array) -> NDArray[np.bool_]:
        """Whether all that is required holds; shape (..., claims) in."""
        return np.asarray((margins[..., self.required] > 0.0).all(axis=-1))


def judge_of(space: Space) -> Judge:
    """The judge of the study: every claim that can be checked and is not set aside.

    What is required of a figure stands behind the claims, as a claim on that figure alone.
    """
    claims = [claim for claim in CLAIMS if claim.check is not None]
    counted = [claim.id not in space.law.set_aside for claim in claims]
    required = [
        replace(claim, id=f"{claim.id} (Fig. {int(figure[3:])})", figures=(figure,))
        for figure, names in space.law.required.items()
        for claim in claims
        if claim.id in names
    ]
    return Judge(
        claims=(*claims, *required),
        counted=np.array(counted + [False] * len(required)),
        goal=space.law.goal,
        required=np.array([False] * len(claims) + [True] * len(required)),
    )


def datasets_of(
    space: Space, wanted: Sequence[tuple[Array, Sequence[str]]]
) -> list[dict[str, xr.Dataset]]:
    """The coarse figures of many candidates.

    Args:
        space: what the candidates are points of.
        wanted: for each candidate its point, shape (n,), and the names of figures and own runs.

    Returns:
        For each candidate its datasets by name, with what the claims read of them.
    """
    sweeps = [{name: space.sweep(point, name) for name in names} for point, names in wanted]
    settings = space.settings.settings
    pieces = [
        sweep.batch(np.arange(math.prod(sweep.shape))).constants(settings.readings)
        for each in sweeps
        for name, sweep in each.items()
        if sweep.dimensions and name not in COURSED
    ]
    rows = np.concatenate(pieces) if pieces else np.empty((0, 0))
    fast = settings.readings == Readings.consistent()
    run = batch_engine(settings) if fast else scalar_engine(settings)
    endings = np.empty((len(rows), len(RunResult._fields)))
    # In a drawn order the long runs do not come together, and few lanes idle at the end.
    order = np.random.default_rng(0).permutation(len(rows))
    if len(rows):
        endings[order] = run(rows[order], np.full(len(rows), settings.tolerance))
    found, start = [], 0
    for each in sweeps:
        made = {}
        for name, sweep in each.items():
            if name in COURSED:
                made[name] = _own_run(sweep)
            elif sweep.dimensions:
                size = math.prod(sweep.shape)
                ended = endings[start : start + size].T
                made[name] = _grid(sweep, dict(zip(RunResult._fields, ended, strict=True)))
                start += size
            else:
                made[name] = _course(sweep)
        found.append(made)
    return found


def _grid(sweep: Sweep, endings: Mapping[str, Array]) -> xr.Dataset:
    names = [dimension.parameter for dimension in sweep.dimensions]
    columns = {name: (names, endings[name].reshape(sweep.shape)) for name in _STORED}
    columns["sensitive"] = (names, np.zeros(sweep.shape, dtype=np.int8))
    held = {
        name: ((), math.nan if value is None else value)
        for name, value in sweep.parameters.items()
        if name not in names
    }
    along = {each.parameter: (each.parameter, np.array(each.values)) for each in sweep.dimensions}
    return xr.Dataset({**columns, **held, **along})


def _own_run(sweep: Sweep) -> xr.Dataset:
    batch, settings = sweep.batch(np.arange(math.prod(sweep.shape))), sweep.settings.settings
    runs = [simulate_once(batch[row], settings) for row in range(math.prod(sweep.shape))]
    stored = {name: np.array([float(getattr(run, name)) for run in runs]) for name in _STORED}
    return _grid(sweep, stored).assign(course_variables(sweep, runs))


def _course(sweep: Sweep) -> xr.Dataset:
    run = simulate_once(sweep.baseline, sweep.settings.settings)
    scalars = {name: float(getattr(run, name)) for name in _STORED}
    held = {name: math.nan if value is None else value for name, value in sweep.parameters.items()}
    return xr.Dataset(
        {name: ("time", values) for name, values in run.course.items()}
        | {name: ((), value) for name, value in {**scalars, **held, "sensitive": 0}.items()},
        {"time": ("time", run.time)},
    )


def margins_of(judge: Judge, datasets: Mapping[str, xr.Dataset]) -> Array:
    """Margin of each claim, shape (claims,); NaN where none of its figures is there."""
    data = Data(datasets)
    found = np.full(len(judge.claims), math.nan)
    for i, claim in enumerate(judge.claims):
        known = [name for name in claim.figures if name in datasets]
        if known:
            alone = judge.required[i]  # what is required of one figure is judged by it alone
            read = Data({name: datasets[name] for name in known}) if alone else data
            found[i] = judge_claim(claim, read).margin
    return found


def contradicted(judge: Judge, datasets: Mapping[str, xr.Dataset]) -> int:
    """How many of the claims that count are contradicted, rather than mixed."""
    data = Data(datasets)
    found = [judge_claim(claim, data).verdict == "contradicted" for claim in judge.claims]
    return int((np.array(found) & judge.counted).sum())


def known_margins(judge: Judge, datasets: Mapping[str, xr.Dataset]) -> Array:
    """Margin of each claim, shape (claims,), the worst where there is nothing to measure."""
    margins = margins_of(judge, datasets)
    return np.where(np.isfinite(margins), margins, _WORST)
