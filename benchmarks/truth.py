"""Alignment times against engines that share no code: ``python -m benchmarks.truth``.

Sets are drawn by the law of ``make accuracy`` and kept where a run aligns, is not flagged, and
meets nothing but the edge A1 under the bottom face, which is what the peers model. heyoka solves
the peers' own statement of the equations (equations.py) with event location; MuJoCo is given
bodies, joints and a soft contact, no equations at all. The independent solution in
``verification.independent`` covers the whole scene: ``make accuracy``.

An error estimate is now and then too small (decision 3): the rule of ``make accuracy`` judges it
here as well. A set beyond its estimate is run again at a hundredth of the tolerance. Only if the
package then agrees with heyoka was it the estimate; else the two solve different problems, and one
such set is one too many.
"""

import argparse
import csv
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.problems import Problem
from benchmarks.trajectories import with_right_edge_only
from study.config import load_study, study_path
from verification.accuracy import Check, judge_estimate
from verification.trials import trial_of
from vibralign import Parameters, Settings, align

Floats = NDArray[np.float64]

_HEYOKA_TOLERANCES = (1e-15, 1e-12)
_CLOSE = 0.05  # largest median of MuJoCo's relative differences
_FAR = 0.2  # relative difference above which a set is counted
_SHARPER = 1e-12  # tolerance at which sets beyond their estimate are run again
_TIME_STEP = 5e-4
_EDGE_RADIUS = 0.01  # radius of the ball that represents an edge
_BEYOND = 10.0  # length by which MuJoCo's face is longer than the part's
_IMPEDANCE = 0.001  # MuJoCo's impedance of the constraint: small, so that it is a plain spring
_NO_CREEP = 1e6  # stiffness of friction over that of the normal constraint


class Sets(NamedTuple):
    """Sets that the peers can run: parameters, the package's alignment times and their errors."""

    cases: list[Parameters]
    tau: Floats
    error: Floats


def draw(count: int) -> Sets:
    """Return the first ``count`` random sets that the peers can run."""
    study = load_study(study_path())
    trial = trial_of(study, "error").model_copy(update={"sets": 8 * count})
    settings = trial.settings.settings
    found: list[tuple[Parameters, float, float]] = []
    for first in range(0, 8 * count, 500):
        batch = trial.batch(np.arange(first, min(first + 500, 8 * count)))
        for each in with_right_edge_only(batch, settings):
            found.append(each)
            if len(found) == count:
                cases, times, errors = zip(*found, strict=True)
                return Sets(list(cases), np.array(times), np.array(errors))
    raise ValueError(f"only {len(found)} of {count} sets qualify")


def by_heyoka(sets: Sets) -> tuple[Floats, Floats]:
    """Return heyoka's alignment times, and their errors: the difference from coarser runs."""
    from benchmarks.methods.heyoka_batch import HeyokaBatch  # noqa: PLC0415  (a peer)

    problem = Problem("truth", tuple(sets.cases), Settings(horizon=float(sets.tau.max()) + 1.0))
    engine = HeyokaBatch()
    fine, coarse = (
        engine.solve(problem, sets.cases, tolerance, math.inf).tau_align
        for tolerance in _HEYOKA_TOLERANCES
    )
    return fine, np.abs(fine - coarse) + _HEYOKA_TOLERANCES[1]


def _scene(p: Parameters) -> str:
    """Return MuJoCo's scene; the joints of the mass centre are relaxed where the springs are.

    MuJoCo pushes a ball out of a box by the nearest face. On a soft base A1 is often deeper behind
    the bottom face than it is away from the end of the face. The box is therefore longer than the
    part; this matters only after A1 has passed the part's end.
    """
    rest_x = p.misalignment if p.rest_x is None else p.rest_x
    rest_y = p.half_height if p.rest_y is None else p.rest_y

    def joint(
        name: str, kind: str, axis: str, stiffness: float, damping: float, rest: float
    ) -> str:
        return (
            f'<joint name="{name}" type="{kind}" axis="{axis}" stiffness="{stiffness!r}" '
            f'damping="{damping!r}" springref="{rest!r}"/>'
        )

    return f"""
<mujoco>
  <compiler angle="radian" autolimits="true"/>
  <option timestep="{_TIME_STEP}" gravity="0 0 0" integrator="implicitfast" cone="elliptic"
    impratio="{_NO_CREEP}"/>
  <worldbody>
    <geom type="sphere" size="{_EDGE_RADIUS}" pos="{p.slot_half_width!r} {-_EDGE_RADIUS} 0"
      contype="1" conaffinity="2"/>
    <body name="part">
      {joint("x", "slide", "1 0 0", p.lateral_stiffness, p.lateral_damping, rest_x)}
      {joint("y", "slide", "0 1 0", 1.0, p.axial_damping, rest_y)}
      {joint("tilt", "hinge", "0 0 1", p.tilt_stiffness, p.tilt_damping, p.rest_tilt)}
      <inertial pos="0 0 0" mass="1" diaginertia="{p.inertia!r} {p.inertia!r} {p.inertia!r}"/>
      <geom name="face" type="box" size="{p.half_width + _BEYOND!r} {p.half_height!r} 1" contype="2"
        conaffinity="1" condim="3" friction="{p.friction!r} 0 0"/>
    </body>
  </worldbody>
</mujoco>"""


def by_mujoco(p: Parameters, horizon: float) -> float:
    """Return MuJoCo's alignment time, NaN without an alignment up to ``horizon``.

    A constraint of small impedance gives the force f = (k r + b v)/w, with w the inverse weight of
    the body. Its k and b are therefore the stiffness and damping of the base times w.
    """
    import mujoco  # noqa: PLC0415  (a peer)

    model = mujoco.MjModel.from_xml_string(_scene(p))
    weight = float(model.body_invweight0[1, 0])
    model.geom_solref[:] = (-p.contact_stiffness * weight, -p.contact_damping * weight)
    model.geom_solimp[:] = (_IMPEDANCE, _IMPEDANCE, 1e-3, 0.5, 2.0)
    model.geom_friction[:, 0] = p.friction
    data = mujoco.MjData(model)
    reach, tilt = p.slot_half_width - p.misalignment, p.initial_tilt
    touch = (p.half_height - reach * math.sin(tilt)) / math.cos(tilt)
    data.qpos[:] = (p.misalignment, touch, tilt)
    before, along = 0.0, _along_face(data.qpos, p)
    while data.time < horizon:
        data.qfrc_applied[1] = -p.press_force - math.sin(p.frequency * data.time + p.phase)
        mujoco.mj_step(model, data)
        place = _along_face(data.qpos, p)
        if place >= p.half_width and _left_corner_is_in(data.qpos, p):
            if along >= p.half_width:  # A1 passed earlier; now the other corner is in
                return float(data.time)
            return before + _TIME_STEP * (p.half_width - along) / (place - along)
        before, along = float(data.time), place
    return math.nan


def _along_face(pose: Any, p: Parameters) -> float:
    """Return the coordinate s of A1 along the bottom face."""
    x, y, tilt = (float(each) for each in pose)
    return (p.slot_half_width - x) * math.cos(tilt) - y * math.sin(tilt)


def _left_corner_is_in(pose: Any, p: Parameters) -> bool:
    """Return whether B2 is in the slot."""
    x, y, tilt = (float(each) for each in pose)
    c, s = math.cos(tilt), math.sin(tilt)
    corner_x = x - p.half_width * c + p.half_height * s
    return corner_x >= -p.slot_half_width and y - p.half_width * s - p.half_height * c < 0.0


class Outside(NamedTuple):
    """A set whose two alignment times differ by more than the sum of their errors."""

    row: int
    factor: float  # difference over the sum of the errors
    explained: bool  # whether the package agrees with heyoka at ``_SHARPER``


def outside(sets: Sets, heyoka: tuple[Floats, Floats]) -> list[Outside]:
    """Return the sets that disagree with heyoka."""
    factors = np.abs(heyoka[0] - sets.tau) / (sets.error + heyoka[1])
    rows = np.flatnonzero(~(factors <= 1.0))
    if not rows.size:
        return []
    few, horizon = [sets.cases[row] for row in rows], float(sets.tau[rows].max()) + 1.0
    runs = align(few, cores=1, horizon=horizon, tolerance=_SHARPER)
    explained = np.abs(heyoka[0][rows] - runs.tau_align) <= runs.tau_error + heyoka[1][rows]
    found = zip(rows.tolist(), factors[rows].tolist(), explained.tolist(), strict=True)
    return [Outside(*each) for each in found]


def judge(
    sets: Sets, heyoka: tuple[Floats, Floats], mujoco: Floats, beyond: Sequence[Outside]
) -> list[Check]:
    """Judge the comparison; ``beyond`` are the sets of ``outside``."""
    apart = np.abs(heyoka[0] - sets.tau)
    off = np.abs(mujoco - sets.tau) / sets.tau
    known = off[np.isfinite(off)]
    middle = float(np.median(known))
    unexplained = [each.row for each in beyond if not each.explained]
    return [
        Check("sets", f"{sets.tau.size}"),
        Check("heyoka apart: median", f"{np.nanmedian(apart):.1e}"),
        Check("heyoka apart: largest", f"{np.nanmax(apart):.1e}"),
        *judge_estimate("heyoka", apart, sets.error + heyoka[1]),
        Check("beyond it at a smaller tolerance as well", f"{len(unexplained)}", "0",
                not unexplained),
        Check("MuJoCo off: median", f"{100 * middle:.2f} %", f"<= {100 * _CLOSE:g} %",
                middle <= _CLOSE),
        Check("MuJoCo off: 90 % of the sets below", f"{100 * np.quantile(known, 0.9):.1f} %"),
        Check(f"MuJoCo off by more than {100 * _FAR:g} %", f"{int((known > _FAR).sum())}"),
        Check("MuJoCo does not align", f"{int((~np.isfinite(off)).sum())}"),
    ]  # fmt: skip


def explain(sets: Sets, heyoka: tuple[Floats, Floats], beyond: Sequence[Outside]) -> list[str]:
    """Return a line for each set beyond the sum of its error estimates."""
    return [
        f"    set {row}: tau {sets.tau[row]:.12g}, {factor:.1f} times the estimates "
        f"{sets.error[row]:.1e} + {heyoka[1][row]:.1e} from heyoka, "
        + (f"which it agrees with at tolerance {_SHARPER:g}" if explained else "NOT EXPLAINED")
        for row, factor, explained in beyond
    ]


def write(sets: Sets, heyoka: tuple[Floats, Floats], mujoco: Floats, path: Path) -> None:
    """Write all sets into a CSV file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    names = ("tau", "tau_error", "heyoka", "heyoka_error", "mujoco", *sets.cases[0].given())
    columns = (sets.tau, sets.error, *heyoka, mujoco)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(names)
        for case, *values in zip(sets.cases, *(each.tolist() for each in columns), strict=True):
            writer.writerow([*values, *case.given().values()])


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the comparison; return the exit code, 1 if a check fails."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.truth", description=__doc__)
    parser.add_argument("--sets", type=int, default=500)
    given = parser.parse_args(arguments)
    if given.sets < 1:
        parser.error(f"--sets {given.sets}: must be >= 1")
    sets = draw(given.sets)
    heyoka = by_heyoka(sets)
    mujoco = np.array(
        [by_mujoco(case, 3.0 * tau + 5.0) for case, tau in zip(sets.cases, sets.tau, strict=True)]
    )
    write(sets, heyoka, mujoco, Path("results/benchmarks/truth.csv"))
    beyond = outside(sets, heyoka)
    checks = judge(sets, heyoka, mujoco, beyond)
    lines = [*map(str, checks), *explain(sets, heyoka, beyond)]
    sys.stdout.write("\n".join(lines) + "\n")
    return 1 if any(check.holds is False for check in checks) else 0


if __name__ == "__main__":
    sys.exit(main())
