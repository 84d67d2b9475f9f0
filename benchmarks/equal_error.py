"""Time at equal true error: the loosest tolerance that meets a target, and the cost at it.

A setting that meets a tighter target meets a looser one: the lower of the two costs counts.
"""

import math
import statistics
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from time import process_time

from benchmarks.methods.base import Method, NotReachedError
from benchmarks.problems import Problem
from model.physics.parameters import Parameters

TIGHTEST, LOOSEST = -28, -4  # tolerances are 10 ** (k/2): 1e-14 to 1e-2
_LEAST_TIME = 0.05  # seconds a timed call lasts at least, where the batch allows
_SLOW = 4.0  # seconds; a call longer than this is timed once


@dataclass(frozen=True)
class Setting:
    """A method at its loosest tolerance; NaN, with the reason, if the target was not reached."""

    method: Method
    problem: Problem
    target: float
    tolerance: float
    error: float
    reason: str = ""


@dataclass(frozen=True)
class Cost:
    """CPU microseconds and right-hand sides of a trajectory (NaN where not known)."""

    setting: Setting
    microseconds: float
    evaluations: float


def tolerance_of(step: int) -> float:
    """Return the tolerance at a step of the half-decade ladder."""
    return float(f"{10.0 ** (step / 2.0):.3g}")


def loosest(
    error_at: Callable[[int], float], target: float, first: int, every: int = 1
) -> int | None:
    """Return the loosest step of the ladder whose error keeps ``target``, or None.

    Walks from ``first`` toward tighter tolerances until one keeps it, or if ``first`` does, toward
    looser ones until one does not: near their limit errors fall with the tolerance.
    """
    step = first
    if error_at(step) <= target:
        while step + every <= LOOSEST and error_at(step + every) <= target:
            step += every
        return step
    while step - every >= TIGHTEST:
        step -= every
        if error_at(step) <= target:
            return step
    return None


def find_setting(method: Method, problem: Problem, target: float, budget: float) -> Setting:
    """Find the setting of ``method`` within ``budget`` seconds of CPU time, without compilation."""
    if problem.name in method.given_up:
        return Setting(method, problem, target, math.nan, math.nan, "nor was a looser target")
    deadline = process_time() + budget

    def error_at(step: int) -> float:
        nonlocal deadline
        if process_time() > deadline:
            raise NotReachedError("out of time")
        known = method.errors.get((problem.name, step))
        if known is None:
            started = process_time()
            method.warm(problem, tolerance_of(step))
            deadline += process_time() - started
            known = method.error(problem, tolerance_of(step), deadline)
            method.errors[problem.name, step] = known
        return known

    first = 2 * round(math.log10(target))
    try:
        step = loosest(error_at, target, first, method.ladder_step)
    except NotReachedError as reason:  # a tighter target need not be tried
        method.given_up.add(problem.name)
        return Setting(method, problem, target, math.nan, math.nan, str(reason))
    if step is None:
        return Setting(method, problem, target, math.nan, math.nan, "not at any tolerance")
    error = method.errors[problem.name, step]
    return Setting(method, problem, target, tolerance_of(step), error)


def time_in_turn(settings: Sequence[Setting], rounds: int) -> Iterable[Cost]:
    """Yield the cost of every setting: medians of ``rounds`` in which the settings take turns."""
    cases: dict[int, tuple[Sequence[Parameters], int]] = {}
    times: dict[int, list[float]] = {}
    failed: dict[int, Setting] = {}
    counted: dict[int, float] = {}
    for i, setting in enumerate(settings):  # warm, and how many trajectories fill a call
        once: Sequence[Parameters] = setting.problem.cases
        if setting.method.batch > 1:
            once = setting.problem.batch(setting.method.batch)
        try:
            spent, evaluations = _spend(setting, once)
        except NotReachedError as reason:  # neighbours of the cases can be harder
            failed[i] = replace(setting, reason=str(reason))
            continue
        counted[i] = math.nan if evaluations is None else evaluations / len(once)
        repeats = 1 if spent > _LEAST_TIME else math.ceil(_LEAST_TIME / max(spent, 1e-4))
        cases[i], times[i] = (once, repeats), [] if spent < _SLOW else [spent / len(once)]
    slow = {i for i in times if times[i]}
    for _ in range(rounds):
        for i in cases.keys() - slow:
            once, repeats = cases[i]
            spent = sum(_spend(settings[i], once)[0] for _ in range(repeats))
            times[i].append(spent / (repeats * len(once)))
    for i, setting in enumerate(settings):
        if i in failed:
            yield Cost(failed[i], math.nan, math.nan)
        else:
            yield Cost(setting, 1e6 * statistics.median(times[i]), counted[i])


def cheapest(costs: Sequence[Cost]) -> list[Cost]:
    """Return each cost, or that of the same method at a tighter target where it is less."""

    def least(cost: Cost) -> Cost:
        wanted = cost.setting
        as_exact = [
            other
            for other in costs
            if other.setting.method is wanted.method
            and other.setting.problem.name == wanted.problem.name
            and other.setting.target <= wanted.target
        ]
        best = min(as_exact, key=lambda each: (math.isnan(each.microseconds), each.microseconds))
        return replace(best, setting=replace(best.setting, target=wanted.target))

    return [least(cost) for cost in costs]


def _spend(setting: Setting, cases: Sequence[Parameters]) -> tuple[float, int | None]:
    """(CPU seconds, right-hand sides) of solving ``cases``."""
    started = process_time()
    solution = setting.method.solve(setting.problem, cases, setting.tolerance, math.inf)
    spent = process_time() - started
    return spent, solution.evaluations
