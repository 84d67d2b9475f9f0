"""The package as a method: both engines by ``align``, and single runs of the batch engine."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from model.compile.entries import compiled
from model.engine import scheduling
from model.engine.lane_events import lane_events_of
from model.engine.queue import new_queue
from model.engine.record import STATE
from model.engine.results import RunResult
from model.engine.scheduling import new_batch_memory
from model.events.outcomes import Outcome, Reason
from model.physics.notation import STATE_SIZE
from model.physics.parameters import Batch, Parameters
from model.runs.align import align, run_once
from model.runs.engines import Engine, batch_engine
from model.runs.errors import estimate
from model.runs.settings import Settings
from verification.bench.methods.base import Method
from verification.bench.problems import Floats, Problem, Solution, failure_of, simulated

_begin_all, _integrate_all = compiled(scheduling.begin_all), compiled(scheduling.integrate_all)


class Package(Method):
    """``align``: all events located, with an error estimate.

    The batch engine runs most sets once, with the errors that they carry, the reference engine at
    least twice. States come from the reference engine, because ``align`` returns none.
    """

    formulation = "align, with error estimate"

    def __init__(self, name: str, engine: Engine = "batch", batch: int = 1024) -> None:
        self.name, self.engine, self.batch = name, engine, batch
        self.vectorized = engine != "scalar"

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], resolution: float, _deadline: float, /
    ) -> Solution:
        """As ``Method.solve``."""
        runs = align(cases, _settings(problem, resolution), cores=1, engine=self.engine)
        return _of_times(problem, runs.tau_align, runs.rhs_evaluations)

    def answer(self, problem: Problem, resolution: float, deadline: float = math.inf) -> Solution:
        """As ``Method.answer``."""
        if problem.checkpoints or self.engine == "scalar":
            return simulated(problem, _settings(problem, resolution))
        return super().answer(problem, resolution, deadline)


class OneRun(Package):
    """The batch engine used like a peer: one run of a set up to alignment, no error estimate."""

    formulation = "one run each up to alignment, no error estimate"

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], resolution: float, _deadline: float, /
    ) -> Solution:
        """As ``Method.solve``."""
        settings = replace(_settings(problem, resolution), alignment_only=True, may_settle=False)
        runs = run_once(Batch.stack(cases), settings, cores=1)
        return _of_times(problem, runs["tau_align"], runs["rhs_evaluations"])


class BatchEngine(Package):
    """The batch engine with the final state of a run, which ``align`` does not return."""

    def answer(self, problem: Problem, resolution: float, _deadline: float = math.inf) -> Solution:
        """As ``Method.answer``, for one case."""
        settings = _settings(problem, resolution)
        rows = settings.rows(Batch.stack(problem.cases))
        carrying = batch_engine(settings, carries_error=True)
        found = estimate(batch_engine(settings), rows, resolution, carrying)
        tau_align, outcome, state = _last_run(settings, rows, found.tolerance)
        failure = failure_of(outcome, Reason(int(found.columns()["reason"][0])))
        evaluations = int(found.rhs_evaluations[0])
        return Solution(np.array([tau_align]), state.reshape(1, 1, -1), evaluations, failure)


def _last_run(settings: Settings, rows: Floats, tolerance: Floats) -> tuple[float, Outcome, Floats]:
    """Return (alignment time, outcome, final state) of one run of the batch engine."""
    results = np.empty((1, len(RunResult._fields)))
    scene, control = settings.for_kernels
    lanes, queue = lane_events_of(scene.events), new_queue(waiting=1, threads=1)
    many = new_batch_memory(lanes, settings.may_settle)
    arguments = rows, tolerance, scene, lanes, control, queue, results, many
    _begin_all(*arguments)
    while (missing := _integrate_all(*arguments)) >= 0:
        lanes.series.load(missing)
    result = RunResult(*results[0].tolist())
    state = many.runs[0, STATE : STATE + STATE_SIZE].copy()
    return result.tau_align, Outcome(int(result.outcome)), state


def _settings(problem: Problem, resolution: float) -> Settings:
    return replace(problem.settings, tolerance=resolution)


def _of_times(problem: Problem, tau: Floats, evaluations: np.ndarray) -> Solution:
    states = np.full((tau.size, len(problem.stops), 6), math.nan)
    return Solution(tau, states, int(evaluations.sum()))
