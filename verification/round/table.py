"""Truth for a round peg, in three dimensions: ``python -m benchmarks.truth_round``.

Every point of verification/round/points.yaml is run by the reference of ``verification.round`` at
three smoothings of friction, each half of the last, from which the time without smoothing is
extrapolated. The places of contact of the reference shift in proportion to the depth, so the middle
run is repeated on bases four times softer and stiffer, of the same restitution. MuJoCo is given a
cylinder and a hole of convex wedges; it is no judge where the peg tilts by more than some 0.08 rad
(see ``by_mujoco``).

The table is verification/round/truth.csv.
"""

import argparse
import csv
import math
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml

from verification.round.motion import ALIGNED, Run, simulate

FOLDER = Path(__file__).parents[1] / "verification" / "round"
BASES = 4.0  # ratio of the stiffnesses of the softer and stiffer base
_CREEP = 0.6  # ratio of the creep at two smoothings below which it is friction's smoothing alone
_FLAT = 1e-5  # tilt in rad of a peg that stands flat
_LARGEST_RATIO = 0.8  # of differences that may be extrapolated by their ratio
_LATE = 0.6  # share of the horizon after which creep is measured
WEDGES, _TIME_STEP = 128, 1e-4  # of MuJoCo's hole; in units of 1/p
_OUTER, _DEEP = 2.5, 1.0  # radius and depth of the block around the hole, in radii of the peg
_IMPEDANCE, _NO_CREEP = 0.001, 1e4  # as in benchmarks.truth

COLUMNS = (
    "device", "outcome", "time_ms", "settled_ms", "tip_n", "plane_n", "forces_settled_n",
    "mujoco_ms", "first_ms", "second_ms", "third_ms", "softer_ms", "stiffer_ms",
)  # fmt: skip

Quantities = Mapping[str, Any]


class Truth(NamedTuple):
    """Knowledge of one point; times in ms, forces in N, NaN where the peg does not align."""

    outcome: str
    time: float
    settled: float
    tip: float
    plane: float
    forces_settled: float
    mujoco: float
    times: tuple[float, ...]


def points() -> list[dict[str, Any]]:
    """Return the points as quantities in SI units, with ``device``, ``horizon``, ``smoothing``."""
    stated = yaml.safe_load((FOLDER / "points.yaml").read_text(encoding="utf-8"))
    return [{**stated["devices"][each["device"]], **each} for each in stated["points"]]


def run(q: Quantities, exponent: int, stiffer: float = 1.0) -> Run:
    """Return the reference's run at one smoothing; another base has the same restitution."""
    speed = q["amplitude"] * 2.0 * math.pi * q["frequency"]
    base = {
        "contact_stiffness": q["contact_stiffness"] * stiffer,
        "contact_damping": q["contact_damping"] * math.sqrt(stiffer),
    }
    return simulate({**q, **base}, epsilon=1e-3 * speed * 2.0**-exponent, horizon=q["horizon"])


def creep(found: Run, horizon: float) -> float:
    """Return the mean lateral speed of the centre of mass late in a run, m/s."""
    late = found.track[found.track[:, 0] > _LATE * horizon]
    return float(np.polyfit(late[:, 0], late[:, 1], 1)[0])


def settle(q: Quantities) -> Truth:
    """Return what the reference finds, and to what it has settled."""
    first, before, last = (run(q, each) for each in q["smoothing"])
    softer, stiffer = (run(q, q["smoothing"][1], each) for each in (1.0 / BASES, BASES))
    runs = (first, before, last, softer, stiffer)
    times = tuple(1e3 * each.time if each.code == ALIGNED else math.nan for each in runs)
    time = settled = math.nan
    outcome = "aligns"
    if last.code == ALIGNED:
        time, settled = extrapolated(times)
    else:
        outcome = outcome_of(before, last, q["horizon"])
    forces = abs(last.tip - before.tip)
    return Truth(outcome, time, settled, last.tip, last.plane, forces, math.nan, times)


def extrapolated(times: Sequence[float]) -> tuple[float, float]:
    """Return the time without smoothing, and what friction and base leave open.

    ``times`` are those at three smoothings and, at the middle one, on a softer and a stiffer base.
    The rest of a sequence whose differences fall by the ratio r is r/(1 - r) of the last difference
    (Aitken). An error in proportion to 1/k is a third of the change to k/4, and 4/3 of that to 4 k.
    """
    coarse, middle, fine, soft, hard = times
    ratio = (fine - middle) / (middle - coarse) if middle != coarse else 0.5
    rest = (fine - middle) * (ratio / (1.0 - ratio) if 0.0 < ratio < _LARGEST_RATIO else 1.0)
    base = max(abs(soft - middle) / (BASES - 1.0), abs(hard - middle) * BASES / (BASES - 1.0))
    return fine + rest, abs(rest) + base


def outcome_of(before: Run, last: Run, horizon: float) -> str:
    """Return how a peg that does not align ends, from its creep at the last two smoothings."""
    if abs(last.track[-1, 6]) < _FLAT:
        return "stands flat"
    held = before.code == ALIGNED
    held = held or abs(creep(last, horizon)) < _CREEP * abs(creep(before, horizon))
    return "sticks" if held else "creeps"


def hole(clearance: float, wedges: int) -> str:
    """Return MuJoCo's meshes of a block whose hole is a polygon as wide as the hole."""
    middle = (1.0 + clearance) * 2.0 / (1.0 + math.cos(math.pi / wedges))
    meshes = []
    for i in range(wedges):
        corners = []
        for side in (i - 0.5, i + 0.5):
            angle = 2.0 * math.pi * side / wedges
            for radius in (middle, _OUTER):
                for y in (0.0, -_DEEP):
                    corners += [radius * math.cos(angle), y, radius * math.sin(angle)]
        vertices = " ".join(map(repr, corners))
        meshes.append(f'<mesh name="wedge{i}" vertex="{vertices}" inertia="shell"/>')
    return "".join(meshes)


def scene(q: Quantities, wedges: int) -> str:
    """Return MuJoCo's scene, in units of the peg's radius, 1/p and the mass."""
    a, mass, stiffness = q["half_width"], q["mass"], q["axial_stiffness"]
    damping, b = math.sqrt(mass * stiffness), q["half_height"] / a
    inertia = q["inertia"] / (mass * a * a)
    joint = '<joint name="{}" type="{}" axis="{}" stiffness="{}" damping="{}" springref="{}"/>'
    rows = (
        ("x", "slide", "1 0 0", "lateral", 1.0, q["misalignment"] / a),
        ("y", "slide", "0 1 0", "axial", 1.0, b),
        ("tilt", "hinge", "0 0 1", "tilt", a * a, 0.0),
    )
    joints = "".join(
        joint.format(name, kind, axis, q[f"{of}_stiffness"] / stiffness / square,
                     q[f"{of}_damping"] / damping / square, rest)
        for name, kind, axis, of, square, rest in rows
    )  # fmt: skip
    wall = "".join(
        f'<geom type="mesh" mesh="wedge{i}" contype="1" conaffinity="2"/>' for i in range(wedges)
    )
    return f"""
<mujoco>
  <compiler angle="radian" autolimits="true"/>
  <option timestep="{_TIME_STEP}" gravity="0 0 0" integrator="implicitfast" cone="elliptic"
    impratio="{_NO_CREEP}" tolerance="1e-14" iterations="200"><flag multiccd="enable"/></option>
  <asset>{hole(q["clearance"], wedges)}</asset>
  <worldbody>
    {wall}
    <body name="peg">
      {joints}
      <inertial pos="0 0 0" mass="1" diaginertia="{inertia!r} {inertia!r} {inertia!r}"/>
      <geom type="cylinder" size="1 {b!r}" euler="{math.pi / 2} 0 0" contype="2" conaffinity="1"
        condim="3" friction="{q["friction"]!r} 0 0"/>
    </body>
  </worldbody>
</mujoco>"""


def by_mujoco(q: Quantities, start: float, wedges: int = WEDGES) -> float:
    """Return MuJoCo's alignment time in ms, NaN without one; ``start`` is the height in m.

    Two tips share the base: each has half of its stiffness and damping (see ``benchmarks.truth``).
    MuJoCo parts each wedge from the cylinder by the shortest way. At a large tilt that is the wall
    of the wedge that the rim just crosses, pushed aside, and not the common normal of the rims.
    """
    import mujoco  # noqa: PLC0415  (a peer)

    a, mass, stiffness = q["half_width"], q["mass"], q["axial_stiffness"]
    unit, slot = math.sqrt(mass / stiffness), 1.0 + q["clearance"]
    model = mujoco.MjModel.from_xml_string(scene(q, wedges))
    weight = 0.5 * float(model.body_invweight0[1, 0])
    model.geom_solref[:] = (
        -q["contact_stiffness"] / stiffness * weight,
        -q["contact_damping"] / math.sqrt(mass * stiffness) * weight,
    )
    model.geom_solimp[:] = (_IMPEDANCE, _IMPEDANCE, 1e-3, 0.5, 2.0)
    model.geom_friction[:, 0] = q["friction"]
    data = mujoco.MjData(model)
    data.qpos[:] = (q["misalignment"] / a, start / a, 1e-3)
    height, swing = q["half_height"] / a, q["amplitude"] / a
    rate, press = 2.0 * math.pi * q["frequency"] * unit, q["press_force"] / (stiffness * a)
    while data.time * unit < q["horizon"]:
        data.qfrc_applied[1] = -press - swing * math.sin(rate * data.time)
        mujoco.mj_step(model, data)
        x, y, tilt = data.qpos
        cos, sin = math.cos(tilt), math.sin(tilt)
        if (slot - x) * cos - y * sin >= 1.0 and y - sin - height * cos < 0.0:
            return float(1e3 * data.time * unit)
    return math.nan


def row_of(q: Quantities, truth: Truth) -> list[str]:
    """Return a row of the table: what was found, then the quantities."""
    found = [f"{value:.5g}" for value in (*truth[1:-1], *truth.times)]
    return [q["device"], truth.outcome, *found, *(repr(q[name]) for name in names_of(q))]


def names_of(q: Quantities) -> list[str]:
    """Return the names of the quantities that stand in the table."""
    return [name for name in q if name not in {"device", "smoothing"}]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the points, one after the other; print them and write them into the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.truth_round", description=__doc__)
    parser.add_argument("--points", type=int, nargs="*", help="run these anew, counted from 0")
    given = parser.parse_args(arguments)
    every, table = points(), FOLDER / "truth.csv"
    rows = [[""]] * len(every)
    if given.points is not None:
        with table.open(newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))[1:]
    for number in given.points or range(len(every)):
        q = every[number]
        truth = settle(q)
        if truth.outcome == "aligns":
            start = float(simulate(q, epsilon=1.0, horizon=1e-9).track[0, 2])
            truth = truth._replace(mujoco=by_mujoco(q, start))
        rows[number] = row_of(q, truth)
        sys.stdout.write(f"{number} {q['device']} {truth}\n")
        sys.stdout.flush()
    with table.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*COLUMNS, *names_of(every[0])])
        writer.writerows(rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
