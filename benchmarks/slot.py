"""Insertion against MuJoCo, given bodies, joints and soft contacts: ``python -m benchmarks.slot``.

Sets are drawn by the law of ``make fuzz SCENE=insertion`` and kept where a run aligns, is not
flagged, and the base is soft enough for MuJoCo's step. MuJoCo begins with the state at alignment.
Its edges and corners are small balls, so that it is off by a share of their radius.
"""

import argparse
import math
import sys
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.truth import OPTIONS, modelled, suspension
from model import Batch, Outcome, Parameters, align, simulate
from verification.fuzz import IN_SLOT, LAWS_IN_SLOT, draw

# The reference engine, which gives the trajectories, takes more evaluations than the fuzz allows.
_SETTINGS = replace(IN_SLOT, max_evaluations=1_000_000)
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
        runs = align(batch, _SETTINGS, cores=1)
        soft = batch.values["contact_stiffness"] <= _SOFT
        ends = np.isin(runs.outcome, (Outcome.INSERTED, Outcome.JAMMED))
        for row in np.flatnonzero(soft & ends & ~runs.sensitive):
            found.append((batch[int(row)], simulate(batch[int(row)], _SETTINGS)))
            if len(found) == count:
                return found
    raise ValueError(f"only {len(found)} of {count} sets qualify")


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
    while data.time < _SETTINGS.horizon:
        time = run.tau_align + data.time
        data.qfrc_applied[1] = -p.press_force - math.sin(p.frequency * time + p.phase)
        mujoco.mj_step(model, data)
        _, y, tilt = (float(each) for each in data.qpos)
        low = p.half_height * math.cos(tilt) - y - p.half_width * abs(math.sin(tilt))
        if low >= depth:
            return float(data.time)
    return math.nan


def main(arguments: Sequence[str] | None = None) -> int:
    """Read the command line and do it; the exit code is 1 where the two disagree."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.slot", description=__doc__)
    parser.add_argument("--sets", type=int, default=200)
    given = parser.parse_args(arguments)
    sets = sets_of(given.sets)
    mine = np.array([run.tau_inserted for _, run in sets])
    depths = Batch.stack([p for p, _ in sets]).insertion_depths()
    theirs = np.array([by_mujoco(p, run, h) for (p, run), h in zip(sets, depths, strict=True)])
    same = np.isnan(mine) == np.isnan(theirs)
    both = np.isfinite(mine) & np.isfinite(theirs)
    off = np.abs(theirs - mine)[both] / mine[both]
    lines = (
        f"sets                      {len(sets)}, {int(np.isnan(mine).sum())} do not go in",
        f"the same end              {same.sum()} (>= {100 * _SAME:g} %)",
        f"times off: median         {100 * np.median(off):.2f} % (<= {100 * _CLOSE:g} %)",
        f"times off: 90 % below     {100 * np.quantile(off, 0.9):.2f} %",
    )
    sys.stdout.write("\n".join(lines) + "\n")
    return int(same.mean() < _SAME or np.median(off) > _CLOSE)


if __name__ == "__main__":
    sys.exit(main())
