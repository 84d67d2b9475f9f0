"""Design: choose the free quantities of a device within their ranges and limits.

A *setting* gives each free quantity a value, with the digits that are printed. It is judged by
devices within the tolerances around it (design_judges.py). Its *yield* is the share of devices that
go in from every start. Its *margin* is the distance, in tolerances, of the nearest failing device
on ``POINTS`` lines from the setting, at most ``FARTHEST``. The best setting has the largest yield,
keeps the limits, has the largest margin in steps of ``MARGIN_STEP``, and is then the fastest.
Differential evolution (scipy) seeks it by the quick judge. The thorough one confirms it, or sends
the search on. The search is seeded and its results are kept: run again after an interruption, it
repeats its steps without computing the results that it has.
"""

import hashlib
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import optimize, stats

from model.device import StatedDevice, Tolerance
from model.device.design_judges import HALVINGS, MEASURES, POINTS, QUARTERS, Judges, Row, Thorough
from model.device.reliability import Floats
from model.device.yields import interval

MARGIN_STEP = 0.25
DIGITS = 4  # of the values of a setting, as they are printed
ROUNDS, CHECKS = 3, 8  # times that the search goes on, and settings judged thoroughly each time
FEW = 256  # devices for a setting that is not recommended
ASSUMED = Tolerance("uniform", 0.1, relative=True)  # for a device that states no tolerance
ASSUMED_OF = ("press_force", "tilt_stiffness", "frequency", "friction", "misalignment", "clearance")
NEAR = 0.05  # share of a limit or range within which it binds

Setting = tuple[float, ...]
"""Values of the free quantities in SI units, in the order of the device's file."""


@dataclass(frozen=True)
class Tried:
    """Results of settings, in SI units.

    Attributes:
        settings: values of the free quantities, each of shape (n,).
        share: share of the devices within the tolerances that go in from every start, shape (n,).
        margin: distance of the nearest failing device, in tolerances, shape (n,).
        measures: by the names of ``MEASURES``, shape (n,): longest time until alignment (of the
            runs that go in), largest contact force and largest tilt within the tolerances, and the
            share of devices that do not align without vibration (NaN if no limit asks for it).
    """

    settings: Mapping[str, Floats]
    share: Floats
    margin: Floats
    measures: Mapping[str, Floats]

    def excess(self, limits: Mapping[str, float]) -> Floats:
        """Return the largest relative excess over a limit, <= 0 where all are kept."""
        if not limits:
            return np.full(self.share.size, -1.0)
        excesses = [
            np.abs(self.measures[name] - limit)
            if name == "vibration"
            else self.measures[name] / limit - 1.0
            for name, limit in limits.items()
        ]
        return np.nan_to_num(np.max(excesses, axis=0), nan=9.0)

    def keeps(self, limits: Mapping[str, float]) -> NDArray[np.bool_]:
        """Return where every device goes in and all limits are kept."""
        return (self.share == 1.0) & (self.excess(limits) <= 0.0)

    def score(self, limits: Mapping[str, float]) -> Floats:
        """Return a number to minimise over the settings: < 0 where they keep the limits."""
        excess = np.clip(self.excess(limits), 0.0, 9.0)
        steps = np.floor(self.margin / MARGIN_STEP) * MARGIN_STEP
        time = np.nan_to_num(self.measures["time"], nan=np.inf)
        speed = 1.0 / (1.0 + time)  # between 0 and 1: decides between equal margins
        kept = -1.0 - steps - MARGIN_STEP * speed
        return np.where(self.keeps(limits), kept, 10.0 * (1.0 - self.share) + excess)


@dataclass(frozen=True)
class Design:
    """Result of a search.

    Attributes:
        tried: every setting, in the order in which they were computed.
        best: number of the recommended setting.
        limits: limits of the search.
        thorough: results of the recommended setting by the thorough judge, None before it is asked.
        judged: number of settings that the thorough judge was asked for.
    """

    tried: Tried
    best: int
    limits: Mapping[str, float]
    thorough: Thorough | None = None
    judged: int = 0

    @property
    def key(self) -> Setting:
        """Values of the recommended setting."""
        return tuple(self.setting.values())

    @property
    def setting(self) -> dict[str, float]:
        """The recommended setting, SI units."""
        return {name: float(values[self.best]) for name, values in self.tried.settings.items()}

    @property
    def feasible(self) -> bool:
        """True if every device goes in at the recommended setting and the limits are kept."""
        return bool(self.tried.keeps(self.limits)[self.best])

    @property
    def interval(self) -> tuple[float, float]:
        """Interval of the yield, of 95 % confidence; (0, 1) if no device was drawn."""
        if self.thorough is None or not self.thorough.devices:
            return 0.0, 1.0
        return interval(self.thorough.going_in, self.thorough.devices)

    @property
    def front(self) -> NDArray[np.int64]:
        """Numbers of the settings on the Pareto front of time and margin, fastest first."""
        order = np.lexsort((-self.tried.margin, self.tried.measures["time"]))
        front, margin = [], -1.0
        for i in order[self.tried.keeps(self.limits)[order]]:
            if self.tried.margin[i] > margin:
                front.append(int(i))
                margin = float(self.tried.margin[i])
        return np.array(front, dtype=np.int64)

    def binding(self, free: Mapping[str, tuple[float, float]]) -> list[str]:
        """Return the limits, and ends of ranges, that the recommended setting is ``NEAR`` to."""
        binding = [
            f"limit of {name}"
            for name, limit in self.limits.items()
            if name != "vibration" and self.tried.measures[name][self.best] > (1.0 - NEAR) * limit
        ]
        for name, (low, high) in free.items():
            value, near = self.setting[name], NEAR * (high - low)
            if value < low + near:
                binding.append(f"lower end of {name}")
            if value > high - near:
                binding.append(f"upper end of {name}")
        return binding

    def to_relax(self) -> dict[str, float]:
        """Return by name the least value of a limit that some setting keeps with all others."""
        least = {}
        for name in self.limits:
            others = {other: limit for other, limit in self.limits.items() if other != name}
            kept = self.tried.keeps(others)
            if kept.any():
                least[name] = float(self.tried.measures[name][kept].min())
        return least


@dataclass
class Search:
    """A search that can be continued after an interruption.

    Attributes:
        judges: judges of its settings; their seed is also that of the optimiser.
        known: results of the quick judge by setting.
        checked: results of the thorough judge by setting.
        settled: results in ``checked`` that this run of the search has reached; it uses them in
            place of the quick judge's.
        lessons: devices that failed at settled settings, as offsets in tolerances.
        refused: settings at which a lesson fails.
        chosen: the setting that the thorough judge has confirmed, or None.
        tolerances_assumed: True if the device states none.
    """

    judges: Judges
    known: dict[Setting, Row] = field(default_factory=dict)
    checked: dict[Setting, Thorough] = field(default_factory=dict)
    settled: dict[Setting, Thorough] = field(default_factory=dict)
    lessons: list[Row] = field(default_factory=list)
    refused: set[Setting] = field(default_factory=set)
    chosen: Setting | None = None
    tolerances_assumed: bool = False

    def __post_init__(self) -> None:
        if not self.stated.free:
            raise ValueError(
                f"{self.stated.source}: nothing is free; state, for example, "
                "free: {press_force: 5 to 20 N}"
            )
        if not self.stated.tolerances:
            assumed = {n: ASSUMED for n in ASSUMED_OF if n in self.stated.quantities}
            stated = replace(self.stated, tolerances=assumed)
            self.judges, self.tolerances_assumed = replace(self.judges, stated=stated), True

    @property
    def stated(self) -> StatedDevice:
        """The device, with free quantities and tolerances."""
        return self.judges.stated

    @property
    def identity(self) -> str:
        """Hash of everything that determines the results."""
        judges, run = self.judges, self.judges.settings
        whole = asdict(replace(self.stated, source=None, changes={}))  # type: ignore[arg-type]
        whole |= {"starts": list(judges.starts), "seed": judges.seed, "devices": judges.devices}
        whole |= {"points": (POINTS, HALVINGS, QUARTERS, DIGITS)}
        whole |= {"run": (run.scene.name, run.insertion_depth, run.tolerance, run.horizon)}
        whole |= {"start": run.start}
        text = json.dumps(whole, sort_keys=True, default=str)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def run(
        self, generations: int, population: int, after: Callable[[int], None] = lambda _: None
    ) -> Design:
        """Search and return the design; call ``after`` with the number of every generation.

        The best setting is judged thoroughly. If it does not hold, the next best at which no lesson
        fails is judged. After ``CHECKS`` such settings the search goes on from the best found so
        far, ``ROUNDS`` times at most.
        """
        low, high = np.array(list(self.stated.free.values())).T
        rng = np.random.default_rng(self.judges.seed)
        first = stats.qmc.LatinHypercube(len(low), rng=rng).random(population)
        first, done = low + first * (high - low), 0
        self.settled, self.lessons, self.refused, self.chosen = {}, [], set(), None

        def score(points: Floats) -> Floats:
            return self.judge(np.atleast_2d(points.T)).score(self.stated.limits)

        def report(intermediate_result: Any) -> None:  # noqa: ARG001 - by its name, for scipy
            nonlocal done
            done += 1
            after(done)

        for number in range(ROUNDS):
            optimize.differential_evolution(
                score,
                list(self.stated.free.values()),
                init=first,
                maxiter=generations,
                rng=np.random.default_rng(self.judges.seed + number),
                vectorized=True,
                updating="deferred",
                polish=False,
                tol=0.0,
                callback=report,
            )
            if self._confirm():
                break
            order = np.argsort(self.tried().score(self.stated.limits), kind="stable")
            first = np.array(list(self.known))[order[:population]]
        best = self.best()
        self.check(best.key, FEW)
        return self._design(best.best)

    def _confirm(self) -> bool:
        """Judge the best settings thoroughly until one holds; return whether the search is over.

        It is also over if the quick judge accepts no setting, and none was judged thoroughly.
        """
        for _ in range(CHECKS):
            while (best := self.best()).feasible and not self._survive([best.key])[0]:
                pass
            if not best.feasible:
                return not self.settled
            self.lessons += self.check(best.key).lessons
            if self._results([best.key]).keeps(self.stated.limits)[0]:
                self.chosen = best.key
                return True
        return False

    def best(self) -> Design:
        """Return the design by all settings that were tried so far."""
        if self.chosen is not None:
            return self._design(list(self.known).index(self.chosen))
        return self._design(int(np.argmin(self.tried().score(self.stated.limits))))

    def _design(self, best: int) -> Design:
        thorough = self.settled.get(list(self.known)[best])
        return Design(self.tried(), best, self.stated.limits, thorough, len(self.settled))

    def judge(self, points: Floats) -> Tried:
        """Return the results of settings, shape (n, free quantities); run those not known."""
        ends = list(self.stated.free.values())
        keys = [
            tuple(as_printed(value, *end) for value, end in zip(row, ends, strict=True))
            for row in points.tolist()
        ]
        new = [key for key in dict.fromkeys(keys) if key not in self.known]
        if new:
            self.known |= dict(zip(new, self.judges.quick(np.array(new)), strict=True))
            self._survive(new)
        return self._results(keys)

    def _survive(self, keys: list[Setting]) -> list[bool]:
        """Return at which settings no lesson fails; refuse the others."""
        survive = self.judges.survive(np.array(keys), self.lessons).tolist()
        self.refused |= {key for key, good in zip(keys, survive, strict=True) if not good}
        return survive

    def check(self, key: Setting, least: int = 0) -> Thorough:
        """Return the results of a setting by the thorough judge, and use them from now on.

        Once the setting does not hold, no more than ``least`` devices are run.
        """
        found = self.checked.get(key)
        if found is None or found.devices < min(least, self.judges.devices):
            setting = dict(zip(self.stated.free, key, strict=True))
            found = self.checked[key] = self.judges.thorough(setting, least)
        self.settled[key] = found
        return found

    def tried(self) -> Tried:
        """Return the results of every setting so far."""
        return self._results(list(self.known))

    def _results(self, keys: list[Setting]) -> Tried:
        rows = [self.settled[k].row if k in self.settled else self.known[k] for k in keys]
        columns, settings = np.array(rows).T, np.array(keys).T
        fails = [key in self.refused and key not in self.settled for key in keys]
        columns[0][fails] = np.minimum(columns[0][fails], 1.0 - 1.0 / (1.0 + POINTS))
        return Tried(
            dict(zip(self.stated.free, settings, strict=True)),
            columns[0],
            columns[1],
            dict(zip(MEASURES, columns[2:], strict=True)),
        )


def as_printed(value: float, low: float, high: float) -> float:
    """Return a value > 0 with ``DIGITS`` digits, within its range if that holds such a value."""
    digits = float(f"{value:.{DIGITS}g}")
    step = 10.0 ** (math.floor(math.log10(abs(digits))) - DIGITS + 1) if digits else 0.0
    if digits > high:
        digits -= step
    elif digits < low:
        digits += step
    return float(f"{digits:.{DIGITS}g}")


@dataclass(frozen=True)
class OtherFriction:
    """Results at another friction than the one that a search assumed.

    Attributes:
        friction: the other friction.
        setting: setting recommended for it, SI units.
        feasible: True if every device goes in at that setting and the limits are kept.
        share: share of the devices that go in at the setting that the search recommends.
        keeps: True if every device goes in there and the limits are kept.
        devices: number of devices by which both settings are judged at most.
    """

    friction: float
    setting: Mapping[str, float]
    feasible: bool
    share: float
    keeps: bool
    devices: int


def at_other_friction(
    search: Search, friction: float, generations: int, population: int
) -> OtherFriction:
    """Return what a search recommends for another ``friction``, and how its own setting does."""
    stated, devices = search.stated.changed(friction=friction), min(search.judges.devices, FEW)
    other = Search(replace(search.judges, stated=stated, devices=devices))
    own = search.best().key
    other.judge(np.array([own]))
    share = other.check(own, devices).row[0]
    keeps = bool(other._results([own]).keeps(search.stated.limits)[0])
    design = other.run(generations, population)
    return OtherFriction(friction, design.setting, design.feasible, share, keeps, devices)
