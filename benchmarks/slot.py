"""Insertion against two solutions that share no code: ``python -m benchmarks.slot``.

Sets are drawn by the law of ``make fuzz SCENE=insertion`` and kept where a run aligns, is not
flagged, and the base is soft enough for MuJoCo's step. The independent solution runs the whole
scene from its own statement of the contacts. MuJoCo is given bodies, joints and soft contacts, and
begins with the state at alignment; its edges and corners are small balls, so that it is off by a
share of their radius.
"""

import argparse
import math
import sys
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.truth import OPTIONS, modelled, suspension
from model import Batch, Outcome, Parameters, Reason, align, simulate
from verification.accuracy import LEAVING, Check, judge_estimate
from verification.fuzz import IN_SLOT, LAWS_IN_SLOT, draw
from verification.independent import insert

Floats = NDArray[np.float64]

# Without an end by settling: in the independent solution a part rests if both sides stick. The
# reference engine, which gives the trajectories, needs more evaluations than the fuzz allows.
SETTINGS = replace(IN_SLOT, may_settle=False, max_evaluations=1_000_000)
_ENDS = Outcome.INSERTED, Outcome.JAMMED, Outcome.CLIMBED_OUT
_TOLERANCE = 1e-12  # of the independent solution
_RADIUS = 0.002  # of edges and corners, over the part's half-width
_SOFT = 2e3  # largest contact stiffness
_DEEP = 20.0  # size of the base
_AT_ONCE = 500
_CLOSE, _SAME = 0.05, 0.95  # relative difference of times in the median; share of the same ends


def sets_of(count: int, seed: int = 2007) -> list[tuple[Parameters, Any]]:
    """Return ``count`` sets with their trajectories in the insertion scene."""
    found: list[tuple[Parameters, Any]] = []
    for first in range(0, 100 * count, _AT_ONCE):
        batch = draw(seed, first, _AT_ONCE, LAWS_IN_SLOT)
        runs = align(batch, SETTINGS, cores=1)
        # The independent solution starts tilted, on the edge, and not in the slot.
        fits = (batch.values["initial_tilt"] > 0.0) & (runs.tau_align > 0.0)
        fits &= (batch.values["contact_stiffness"] <= _SOFT) & np.isin(runs.outcome, _ENDS)
        for row in np.flatnonzero(fits & ~runs.sensitive):
            found.append((batch[int(row)], simulate(batch[int(row)], SETTINGS)))
            if len(found) == count:
                return found
    raise ValueError(f"only {len(found)} of {count} sets qualify")


def ends_as(run: Any, ending: str) -> bool:
    """Return whether an ending of the independent solution agrees with outcome and reason."""
    if run.outcome is Outcome.INSERTED:
        return ending == "inserted"
    if run.outcome is Outcome.JAMMED:
        return ending == {Reason.WEDGED: "wedged"}.get(run.reason, "lack of force")
    return ending in {Reason.ON_EDGE: ("climbed out",), **LEAVING}.get(run.reason, ())


def by_independent(p: Parameters, run: Any, depth: float) -> tuple[float, bool]:
    """Return (time of insertion, NaN without one; whether the ending agrees with the run)."""
    try:
        solution = insert(p, SETTINGS.horizon, depth, _TOLERANCE)
    except ArithmeticError:
        return math.nan, False
    time = solution.time if solution.ending == "inserted" else math.nan
    return time, ends_as(run, solution.ending)


def scene_of(p: Parameters) -> str:
    """Return MuJoCo's scene: edges meet the faces of the part, its bottom corners the base."""
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
    """Return the time from alignment until both corners are at ``depth``, NaN if never."""
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
    # MuJoCo goes on after a part has left the scene: it may go in later.
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


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the comparison; return the exit code, 1 if a check fails."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.slot", description=__doc__)
    parser.add_argument("--sets", type=int, default=200)
    given = parser.parse_args(arguments)
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
