"""Truth for a round peg, in three dimensions: ``python -m verification.round.table``.

Every point of verification/round/points.yaml is run by the reference of ``verification.round`` at
three smoothings of friction, each half of the last, from which the time without smoothing is
extrapolated. The places of contact of the reference shift in proportion to the depth, so the middle
run is repeated on bases four times softer and stiffer, of the same restitution.

The table is verification/round/truth.csv. Parts that are lowered while they vibrate hop, and their
paths depart from each other: they are run once, at the middle smoothing (running.csv).
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

FOLDER = Path(__file__).parent
TABLES = {"truth": "points", "running": "running"}
"""Tables, and the points of points.yaml that they hold."""
BASES = 4.0  # ratio of the stiffnesses of the softer and stiffer base
_CREEP = 0.6  # ratio of the creep at two smoothings below which it is friction's smoothing alone
_FLAT = 1e-5  # tilt in rad of a peg that stands flat
_LARGEST_RATIO = 0.8  # of differences that may be extrapolated by their ratio
_LATE = 0.6  # share of the horizon after which creep is measured

COLUMNS = (
    "device", "outcome", "time_ms", "settled_ms", "tip_n", "plane_n", "forces_settled_n",
    "first_ms", "second_ms", "third_ms", "softer_ms", "stiffer_ms",
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
    times: tuple[float, ...]


def points(table: str) -> list[dict[str, Any]]:
    """Return the points as quantities in SI units, with ``device``, ``horizon``, ``smoothing``."""
    stated = yaml.safe_load((FOLDER / "points.yaml").read_text(encoding="utf-8"))
    return [{**stated["devices"][each["device"]], **each} for each in stated[TABLES[table]]]


def run(q: Quantities, exponent: int, stiffer: float = 1.0) -> Run:
    """Return the reference's run at one smoothing; another base has the same restitution."""
    speed = q["amplitude"] * 2.0 * math.pi * q["frequency"]
    base = {
        "contact_stiffness": q["contact_stiffness"] * stiffer,
        "contact_damping": q["contact_damping"] * math.sqrt(stiffer),
    }
    start = {name: q[name] for name in ("phase", "tilt") if name in q}
    epsilon = 1e-3 * speed * 2.0**-exponent
    return simulate({**q, **base}, epsilon=epsilon, horizon=q["horizon"], **start)


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
    return Truth(outcome, time, settled, last.tip, last.plane, forces, times)


def once(q: Quantities) -> Truth:
    """Return what the reference finds at the middle smoothing."""
    found = run(q, q["smoothing"][1])
    outcome = "aligns" if found.code == ALIGNED else "does not align"
    time = 1e3 * found.time if found.code == ALIGNED else math.nan
    return Truth(outcome, time, math.nan, found.tip, found.plane, math.nan, (math.nan,) * 5)


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


def row_of(q: Quantities, truth: Truth) -> list[str]:
    """Return a row of the table: what was found, then the quantities."""
    found = [f"{value:.5g}" for value in (*truth[1:-1], *truth.times)]
    return [q["device"], truth.outcome, *found, *(repr(q[name]) for name in names_of(q))]


def names_of(q: Quantities) -> list[str]:
    """Return the names of the quantities that stand in the table."""
    return [name for name in q if name not in {"device", "smoothing"}]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the points, one after the other; print them and write them into the table."""
    parser = argparse.ArgumentParser(prog="python -m verification.round.table", description=__doc__)
    parser.add_argument("--table", choices=[*TABLES], default="truth", help="of which points")
    parser.add_argument("--points", type=int, nargs="*", help="run these anew, counted from 0")
    given = parser.parse_args(arguments)
    every, table = points(given.table), FOLDER / f"{given.table}.csv"
    rows = [[""]] * len(every)
    if given.points is not None:
        with table.open(newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))[1:]
    for number in given.points or range(len(every)):
        q = every[number]
        truth = settle(q) if given.table == "truth" else once(q)
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
