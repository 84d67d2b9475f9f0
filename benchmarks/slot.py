"""Insertion against two solutions that share no code: ``python -m benchmarks.slot``.

Sets are drawn by the law of ``make fuzz SCENE=insertion`` and kept where a run aligns, is not
flagged, and the base is soft enough for MuJoCo's step. The independent solution runs the whole
scene from its own statement of the contacts. MuJoCo is given bodies, joints and soft contacts, and
begins with the state at alignment; its edges and corners are small balls, so that it is off by a
share of their radius. ``--speed`` instead compares the time of a step, before and after alignment,
with that of a step of the alignment scene, by figure.
"""

import argparse
import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from time import process_time
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.truth import OPTIONS, modelled, suspension
from model import INSERTION, Batch, Outcome, Parameters, Reason, align, simulate
from model.engines.results import RunResult
from model.runs.align import run_once
from model.runs.engines import batch_engine
from model.study.config import GRIDDED, load_study, study_path
from model.study.sweep import sweep_of
from verification.accuracy import LEAVING, Check, judge_estimate
from verification.fuzz import IN_SLOT, LAWS_IN_SLOT, draw
from verification.independent import insert

Floats = NDArray[np.float64]

# Rest is told by both sides sticking, as in the independent solution, and not by periods; and the
# reference engine, which gives the trajectories, takes more evaluations than the fuzz allows.
SETTINGS = replace(IN_SLOT, may_settle=False, max_evaluations=1_000_000)
_ENDS = Outcome.INSERTED, Outcome.JAMMED, Outcome.CLIMBED_OUT
_TOLERANCE = 1e-12  # of the independent solution
_RADIUS = 0.002  # of edges and corners, over the part's half-width
_SOFT = 2e3  # largest contact stiffness
_DEEP = 20.0  # size of the base
_AT_ONCE = 500
_CLOSE, _SAME = 0.05, 0.95  # relative difference of times in the median; share of the same ends
_ROUNDS, _LEAST_SETS = 12, 2_000  # of a measured time
_SHALLOW = 1e-9  # depth at which a part counts as inserted at once


def sets_of(count: int, seed: int = 2007) -> list[tuple[Parameters, Any]]:
    """Return ``count`` sets with their trajectories in the insertion scene."""
    found: list[tuple[Parameters, Any]] = []
    for first in range(0, 100 * count, _AT_ONCE):
        batch = draw(seed, first, _AT_ONCE, LAWS_IN_SLOT)
        runs = align(batch, SETTINGS, cores=1)
        # The independent solution starts on the edge, and not flat or where it falls in at once.
        fits = (batch.values["initial_tilt"] > 0.0) & (runs.tau_align > 0.0)
        fits &= (batch.values["contact_stiffness"] <= _SOFT) & np.isin(runs.outcome, _ENDS)
        for row in np.flatnonzero(fits & ~runs.sensitive):
            found.append((batch[int(row)], simulate(batch[int(row)], SETTINGS)))
            if len(found) == count:
                return found
    raise ValueError(f"only {len(found)} of {count} sets qualify")


def ends_as(run: Any, ending: str) -> bool:
    """Return whether an ending of the independent solution is the run's outcome and reason."""
    if run.outcome is Outcome.INSERTED:
        return ending == "inserted"
    if run.outcome is Outcome.JAMMED:
        return ending == {Reason.WEDGED: "wedged"}.get(run.reason, "lack of force")
    return ending in {Reason.ON_EDGE: ("climbed out",), **LEAVING}.get(run.reason, ())


def by_independent(p: Parameters, run: Any, depth: float) -> tuple[float, bool]:
    """Return (time until inserted, whether the end is the run's); NaN for one not inserted."""
    try:
        solution = insert(p, SETTINGS.horizon, depth, _TOLERANCE)
    except ArithmeticError:
        return math.nan, False
    time = solution.time if solution.ending == "inserted" else math.nan
    return time, ends_as(run, solution.ending)


def scene_of(p: Parameters) -> str:
    """Return the scene: edges meet the part's faces, its bottom corners the base."""
    a, b, gap, r = p.half_width, p.half_height, p.slot_half_width, _RADIUS * p.half_width
    edges = "".join(
        f'<geom type="sphere" size="{r!r}" pos="{side * (gap + r)!r} {-r!r} 0" contype="1" '
        'conaffinity="2"/>'
        f'<geom type="box" size="{_DEEP} {_DEEP} 1" pos="{side * (gap + _DEEP)!r} {-_DEEP} 0" '
        'contype="4" conaffinity="8"/>'
        for side in (1, -1)
    )
    corners = "".join(
        f'<geom type="sphere" size="{r!r}" pos="{side * (a - r)!r} {r - b!r} 0" contype="8" '
        'conaffinity="4"/>'
        for side in (1, -1)
    )
    return f"""
<mujoco>
  {OPTIONS}
  <worldbody>
    {edges}
    <body name="part">
      {suspension(p)}
      <geom type="box" size="{a!r} {b!r} 1" contype="2" conaffinity="1"/>
      {corners}
    </body>
  </worldbody>
</mujoco>"""


def by_mujoco(p: Parameters, run: Any, depth: float) -> float:
    """Return the time from alignment until both corners are that deep, NaN if they are not."""
    import mujoco  # noqa: PLC0415  (a peer)

    model = modelled(scene_of(p), p)
    data = mujoco.MjData(model)
    first = int(np.searchsorted(run.time, run.tau_align))
    data.qpos[:], data.qvel[:] = run.state[first, :3], run.state[first, 3:]
    while data.time < SETTINGS.horizon:
        time = run.tau_align + data.time
        data.qfrc_applied[1] = -p.press_force - math.sin(p.frequency * time + p.phase)
        mujoco.mj_step(model, data)
        _, y, tilt = (float(each) for each in data.qpos)
        low = p.half_height * math.cos(tilt) - y - p.half_width * abs(math.sin(tilt))
        if low >= depth:
            return float(data.time)
    return math.nan


def judge(
    runs: Sequence[Any], independent: Sequence[tuple[float, bool]], mujoco: Floats
) -> list[Check]:
    """Judge the comparison of runs with both solutions."""
    after = np.array([run.tau_inserted for run in runs])
    time, alike = (np.array(each) for each in zip(*independent, strict=True))
    apart = np.abs(np.array([run.tau_align for run in runs]) + after - time)
    # MuJoCo follows a part that leaves the scene, and may see it go in later.
    stays = np.array([run.outcome is not Outcome.CLIMBED_OUT for run in runs])
    same = (np.isnan(after) == np.isnan(mujoco))[stays]
    both = np.isfinite(mujoco) & (after > 0.0)
    off = np.abs(mujoco - after)[both] / after[both]
    inserted = np.isfinite(after) & np.isfinite(time)
    error = np.array([run.insertion_error for run in runs])[inserted]
    middle = float(np.median(off))
    covered = judge_estimate("independent solution", apart[inserted], error)[:2]
    return [
        Check("sets", f"{after.size}, of which {int(np.isnan(after).sum())} do not go in"),
        Check("other ends, independent solution", f"{int((~alike).sum())}", "0", bool(alike.all())),
        Check("independent solution apart: median", f"{np.median(apart[inserted]):.1e}"),
        *covered,
        Check("MuJoCo goes in or not alike", f"{100 * same.mean():.1f} %", f">= {100 * _SAME:g} %",
                bool(same.mean() >= _SAME)),
        Check("MuJoCo off: median", f"{100 * middle:.2f} %", f"<= {100 * _CLOSE:g} %",
                middle <= _CLOSE),
        Check("MuJoCo off: 90 % of the sets below", f"{100 * np.quantile(off, 0.9):.1f} %"),
    ]  # fmt: skip


def _in_turn(tasks: Sequence[Callable[[], object]]) -> Floats:
    """Return the CPU seconds of tasks, the least of several rounds."""
    times = np.zeros((_ROUNDS, len(tasks)))
    for each in range(times.size):
        started = process_time()
        tasks[each % len(tasks)]()
        times[divmod(each, len(tasks))] = process_time() - started
    least: Floats = times.min(axis=0)
    return least


class Cost(NamedTuple):
    """CPU seconds, steps and events of the same sets, each of shape (3,).

    In the alignment scene; in the insertion scene up to alignment; and in the whole of it.
    """

    times: Floats
    steps: Floats
    events: Floats

    def __str__(self) -> str:
        """The costs of steps over that of a step in the alignment scene."""
        step = self.times[0] / self.steps[0]
        before, after = self.times[1] / self.steps[1], np.diff(self.times)[1]
        added, events = np.diff(self.steps)[1], np.diff(self.events)[1]
        return (
            f"{1e6 * step:.2f} us a step, in the insertion scene {before / step:.2f} times as much "
            f"before alignment and {after / added / step:.2f} times after it, with "
            f"{self.events[0] / self.steps[0]:.2f} and {events / added:.2f} events "
            f"a step; whole runs {self.times[2] / self.times[0]:.2f} times, of "
            f"{self.steps[2] / self.steps[0]:.2f} times the steps"
        )


def speed_of(figure: str, count: int) -> tuple[Cost, str]:
    """Return the cost of ``count`` points of a figure in the batch engine, and who aligns of them.

    Every set is run several times at once, as in a large batch: few lanes wait at its end. A run
    that counts as inserted at once tells the steps before alignment from those after it. Sets are
    counted as handed over if the reference engine made some of their steps.
    """
    sweep = sweep_of(load_study(study_path()), figure)
    settings = sweep.settings.settings
    points = np.random.default_rng(0).permutation(int(np.prod(sweep.shape)))[:count]
    inserts = replace(settings, scene=INSERTION)
    aligns = run_once(sweep.batch(points), settings)["outcome"] == Outcome.ALIGNED
    sets = np.tile(points[aligns], -(-_LEAST_SETS // int(aligns.sum())))
    tasks = [
        partial(
            batch_engine(each, carries_error=True), each.rows(sweep.batch(sets)),
            np.full(len(sets), each.tolerance),
        )
        for each in (settings, replace(inserts, insertion_depth=_SHALLOW), inserts)
    ]  # fmt: skip
    found = [RunResult(*run().T) for run in tasks]
    steps, events = (
        np.array([getattr(each, name).sum() for each in found]) for name in ("steps", "events")
    )
    handed = np.isnan(found[2].largest_error).mean()
    who = f"{aligns.sum()} align, {100 * handed:.0f} % handed over"
    return Cost(_in_turn(tasks), steps, events), who


def main(arguments: Sequence[str] | None = None) -> int:
    """Read the command line and do it; the exit code is 1 where an agreement fails."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.slot", description=__doc__)
    parser.add_argument("--sets", type=int, default=200)
    parser.add_argument("--speed", action="store_true", help="only measure the time of steps")
    given = parser.parse_args(arguments)
    if given.speed:
        costs = []
        for figure in GRIDDED:
            cost, who = speed_of(figure, given.sets)
            sys.stdout.write(f"{figure}: {who}; {cost}\n")
            sys.stdout.flush()
            costs.append(cost)
        sys.stdout.write(f"all: {Cost(*(sum(each) for each in zip(*costs, strict=True)))}\n")
        return 0
    sets = sets_of(given.sets)
    depths = Batch.stack([p for p, _ in sets]).insertion_depths().tolist()
    tried = [(p, run, depth) for (p, run), depth in zip(sets, depths, strict=True)]
    independent = [by_independent(*each) for each in tried]
    mujoco = np.array([by_mujoco(*each) for each in tried])
    checks = judge([run for _, run in sets], independent, mujoco)
    sys.stdout.write("\n".join(map(str, checks)) + "\n")
    return int(any(check.holds is False for check in checks))


if __name__ == "__main__":
    sys.exit(main())
