"""Design: choose the free quantities of a device within their ranges and limits.

A *setting* gives each free quantity a value, with the digits that are printed. It is tried by
devices within the tolerances around it (design_trials.py). Its *yield* is the share of devices that
go in from every start. Its *margin* is the distance, in tolerances, of the nearest failing device
on ``LINES`` lines from the setting, at most ``FARTHEST``. The best setting has the largest yield,
keeps the limits, has the largest margin in steps of ``MARGIN_STEP``, and is then the fastest.
Differential evolution (scipy) seeks it by quick trials. The best settings are then checked as
``assess`` does, until one holds. The search is seeded.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import optimize, stats

from model.physics.tables import Value
from model.runs.settings import Settings
from model.sweeps.settings import Ensemble
from vibralign.answers.approaches import in_worst_approach
from vibralign.answers.cases import cases_of
from vibralign.answers.design_trials import MEASURES, Check, Row, Trials
from vibralign.answers.reliability import Floats
from vibralign.answers.yields import check_devices, interval
from vibralign.device import StatedDevice, Tolerance
from vibralign.device.instead import name_in
from vibralign.device.quantities import unit_of
from vibralign.device.runs import AnyDevice, settings_for, stated_of

MARGIN_STEP = 0.25
GENERATIONS, POPULATION = 10, 16  # of the search, by default
DEVICES = 1024  # of a check, by default; a power of two
DRAWS = 8  # of a population, until a setting goes in, from the best of which the search begins
FAILS = 10.0  # least score of a setting with which no device goes in
DIGITS = 4  # of the values of a setting, as they are printed
CHECKS = 12  # most settings that are checked
ASSUMED = Tolerance("uniform", 0.1, relative=True)  # for a device that states no tolerance
ASSUMED_OF = ("press_force", "tilt_stiffness", "frequency", "friction", "misalignment", "clearance")
_GROWING = slice(2, 5)  # time, force and tilt in the results of a setting
NEARBY = 0.2  # of the ranges: settings that near a failure are checked last
NEAR = 0.05  # share of a limit or range within which it binds

Setting = tuple[float, ...]
"""Values of the free quantities in SI units, in the order of the device's file."""
Known = dict[Setting, Row]
"""Results of quick trials."""


@dataclass(frozen=True, eq=False, repr=False)
class Tried(Value):
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
        excesses = [
            np.abs(self.measures[name] - limit)
            if name == "vibration"
            else self.measures[name] / limit - 1.0
            for name, limit in limits.items()
        ]
        return np.nan_to_num(np.max([*excesses, np.full(self.share.size, -1.0)], axis=0), nan=9.0)

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
        return np.where(self.keeps(limits), kept, FAILS * (1.0 - self.share) + excess)


class Limiting(NamedTuple):
    """A limit of a setting.

    Attributes:
        kind: "limit", "lower end" or "upper end" of a range, or "tolerance".
        name: name of the limit or quantity.
        passed: True if the setting exceeds it, or devices within it fail.
    """

    kind: str
    name: str
    passed: bool = False


@dataclass(frozen=True, eq=False, repr=False)
class Design(Value):
    """Result of a search.

    Attributes:
        tried: every setting, in the order in which they were computed; the results of a check stand
            in place of those of its quick trial, and nothing is extrapolated.
        best: number of the recommended setting.
        limits: limits of the search.
        checks: results of the settings that were checked, by their numbers.
        free: ranges of the search.
        tolerances: names of the quantities with tolerances.
    """

    tried: Tried
    best: int
    limits: Mapping[str, float]
    checks: Mapping[int, Check]
    free: Mapping[str, tuple[float, float]]
    tolerances: tuple[str, ...] = ()

    def __repr__(self) -> str:
        words = "recommended" if self.feasible else "none found; nearest"
        setting = ", ".join(f"{n} = {v:.4g} {unit_of(n)}" for n, v in self.setting.items())
        setting = f"{setting},".replace(" 1,", ",")[:-1]
        exceeded = [each.name for each in self.limiting if each.passed and each.kind == "limit"]
        return f"<Design: {words} {setting}{''.join(f'; exceeds {n}' for n in exceeded)}>"

    def _shown(self) -> dict[str, Any]:
        """Return the results of the recommended setting by name, SI units."""
        tried, best = self.tried, self.best
        results = {"share": tried.share, "margin": tried.margin, **tried.measures}
        numbers = {name: float(each[best]) for name, each in results.items()}
        checked = {} if self.check is None else {"devices": self.check.devices}
        limiting = ", ".join(f"{kind} of {name}" for kind, name, _ in self.limiting)
        return self.setting | numbers | checked | {"limiting": limiting}

    @property
    def check(self) -> Check | None:
        """Check of the recommended setting, None if it was not checked."""
        return self.checks.get(self.best)

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
        if self.check is None or not self.check.devices:
            return 0.0, 1.0
        return interval(self.check.going_in, self.check.devices)

    @property
    def limiting(self) -> list[Limiting]:
        """Return what keeps the recommended setting from the limits, or from a larger margin.

        If no setting keeps the limits, these are all of them, those first that it exceeds; else the
        limits that it is ``NEAR`` to. Then come the ends of ranges that it is ``NEAR`` to, and the
        tolerances, if some devices fail within them, and not all.
        """
        share = float(self.tried.share[self.best])
        excess = {
            name: float(self.tried.excess({name: limit})[self.best])
            for name, limit in self.limits.items()
        }
        known = {n: not math.isnan(self.tried.measures[n][self.best]) for n in self.limits}
        found = [Limiting("limit", name, passed=each > 0.0 and known[name])
                 for name, each in excess.items()
                 if not self.feasible or (each > -NEAR and name != "vibration")]  # fmt: skip
        found.sort(key=lambda each: (not each.passed, excess[each.name]))
        for name, (low, high) in self.free.items():
            near = NEAR * (high - low) if share > 0.0 else math.inf
            found += [Limiting("lower end", name)] if self.setting[name] < low + near else []
            found += [Limiting("upper end", name)] if self.setting[name] > high - near else []
        some = self.tolerances if 0.0 < share < 1.0 else ()
        return [*found, *(Limiting("tolerance", name, passed=True) for name in some)]


def design(
    device: AnyDevice,
    settings: Settings | None = None,
    ensemble: Ensemble | None = None,
    cores: int = 1,
    *,
    generations: int = GENERATIONS,
    population: int = POPULATION,
    seed: int = 0,
    devices: int = DEVICES,
) -> Design:
    """Return the recommended setting of a device, as ``vibralign design`` does.

    Args:
        device: a device of a file, as ``simulate`` takes it, which states what is free and limits.
        settings: as for ``assess``.
        ensemble: as for ``assess``.
        cores: as for ``assess``.
        generations: number of generations of the search.
        population: number of settings in a generation.
        seed: seed of the search.
        devices: number of devices of a check, a power of two.

    Raises:
        TypeError: a dimensionless device.
        ValueError: nothing is free, or ``devices`` is no power of two.
    """
    trials = trials_of(device, settings, ensemble, cores, seed, devices)
    return search(trials, generations, population)


def trials_of(
    device: AnyDevice,
    settings: Settings | None = None,
    ensemble: Ensemble | None = None,
    cores: int = 1,
    seed: int = 0,
    devices: float = DEVICES,
) -> Trials:
    """Return the trials of a device's settings; arguments and errors as for ``design``.

    A device that states no approach is tried with the worst at its own values.
    """
    stated = with_tolerances(stated_of(device))
    settings, ensemble = settings_for(stated, settings), ensemble or Ensemble()
    stated = in_worst_approach(stated, settings, ensemble, cores)
    cases = cases_of(stated, ensemble, varied=(*stated.free, *stated.tolerances))
    return Trials(stated, cases, settings, cores, seed, check_devices(devices))


def with_tolerances(stated: StatedDevice) -> StatedDevice:
    """Return a device with ``ASSUMED`` tolerances if it states none.

    Raises:
        ValueError: nothing is free.
    """
    if not stated.free:
        raise ValueError(
            f"{stated.source}: nothing is free; state, for example, "
            "free: {press_force: 5 to 20 N}"
        )
    if stated.tolerances:
        return stated
    names = [name_in(stated.quantities, name) for name in ASSUMED_OF]
    return replace(stated, tolerances={n: ASSUMED for n in names if n in stated.quantities})


def search(
    trials: Trials,
    generations: int,
    population: int,
    tell: Callable[[str], None] = lambda _: None,
) -> Design:
    """Return the best setting of a device.

    Args:
        trials: trials of its settings; their seed is also that of the optimiser.
        generations: number of generations of differential evolution.
        population: number of settings in a generation.
        tell: called with the step under way and the number of steps, in words.
    """
    free, limits = trials.stated.free, trials.stated.limits
    low, high = np.array(list(free.values())).T
    known, done = Known(), 0

    def score(points: Floats) -> Floats:
        keys = [rounded(point, free) for point in np.atleast_2d(points.T).tolist()]
        new = [key for key in dict.fromkeys(keys) if key not in known]
        if new:
            known.update(zip(new, trials.quick(np.array(new)), strict=True))
        return tried_of(keys, [known[key] for key in keys], free).score(limits)

    def report(intermediate_result: Any) -> None:  # noqa: ARG001 - by its name, for scipy
        nonlocal done
        done += 1
        tell(f"generation {done} of {generations} done, {len(known):,} settings tried")

    tell(f"first settings of the search, then {generations} generations")
    first = stats.qmc.LatinHypercube(len(low), rng=np.random.default_rng(trials.seed))
    points, scores = np.empty((0, len(low))), np.empty(0)
    while len(points) < DRAWS * population and not (scores < FAILS).any():
        drawn = low + first.random(population) * (high - low)
        points = np.concatenate([points, drawn])
        scores = np.concatenate([scores, score(drawn.T)])
    optimize.differential_evolution(
        score,
        list(free.values()),
        init=points[np.sort(np.argsort(scores, kind="stable")[:population])],
        maxiter=generations,
        rng=np.random.default_rng(trials.seed),
        vectorized=True,
        updating="deferred",
        polish=False,
        tol=0.0,
        atol=-1.0,  # settings that all fail alike do not end the search
        callback=report,
    )
    return _checked(trials, known, tell)


def _checked(trials: Trials, known: Known, tell: Callable[[str], None]) -> Design:
    """Check the best settings until one holds; return the design.

    If none of ``CHECKS`` holds, the design is the checked setting that fails least.
    """
    free, limits = trials.stated.free, trials.stated.limits
    keys, quick, checks = list(known), np.array(list(known.values())), dict[int, Check]()
    accepted, rows = tried_of(keys, quick, free).keeps(limits), quick.copy()
    while True:
        names = tuple(trials.stated.tolerances)
        design = Design(tried_of(keys, rows, free), 0, limits, checks, free, names)
        score, numbers = design.tried.score(limits), list(checks)
        open_ones = np.setdiff1d(np.flatnonzero(accepted), numbers)
        if numbers and (score[numbers].min() < 0.0 or not open_ones.size or len(numbers) == CHECKS):
            return replace(design, best=numbers[int(np.argmin(score[numbers]))])
        order = tried_of(keys, _expected(keys, quick, checks, free), free).score(limits)
        among = open_ones if open_ones.size else np.arange(len(keys))
        best = int(among[np.argmin(order[among])])
        tell(f"check {len(checks) + 1} of at most {CHECKS}")
        checks[best] = trials.check(replace(design, best=best).setting)
        rows[best] = checks[best].row


def _expected(
    keys: Sequence[Setting],
    quick: Floats,
    checks: Mapping[int, Check],
    free: Mapping[str, tuple[float, float]],
) -> Floats:
    """Return what checks of settings are expected to find, for the choice of the next one.

    Times, forces and tilts are expected to grow from the quick trial to the check as they did at
    the nearest checked setting; near a setting at which devices fail, as large a share fails.
    """
    if not checks:
        return quick
    rows, numbers, found = quick.copy(), list(checks), np.array([c.row for c in checks.values()])
    low, high = np.array(list(free.values())).T
    places = (np.array(keys) - low) / (high - low)
    apart = np.linalg.norm(places[:, None] - places[numbers], axis=2)
    nearest, near = apart.argmin(axis=1), apart.min(axis=1) < NEARBY
    growth = found[:, _GROWING] / quick[numbers, _GROWING]
    rows[:, _GROWING] *= np.nan_to_num(growth, nan=1.0)[nearest]
    rows[near, 0] = np.minimum(rows[near, 0], found[nearest[near], 0])
    return rows


def tried_of(keys: Sequence[Setting], rows: Any, free: Mapping[str, Any]) -> Tried:
    """Return the results of settings as columns."""
    columns, settings = np.array(rows, dtype=np.float64).T.copy(), np.array(keys).T.copy()
    return Tried(
        dict(zip(free, settings, strict=True)),
        columns[0],
        columns[1],
        dict(zip(MEASURES, columns[2:], strict=True)),
    )


def rounded(point: list[float], free: Mapping[str, tuple[float, float]]) -> Setting:
    """Return a setting with the digits that are printed."""
    return tuple(as_printed(v, *ends) for v, ends in zip(point, free.values(), strict=True))


def as_printed(value: float, low: float, high: float) -> float:
    """Return a value > 0 with ``DIGITS`` digits, within its range if that holds such a value."""
    digits = float(f"{value:.{DIGITS}g}")
    step = 10.0 ** (math.floor(math.log10(abs(digits))) - DIGITS + 1) if digits else 0.0
    if digits > high:
        digits -= step
    elif digits < low:
        digits += step
    return float(f"{digits:.{DIGITS}g}")
