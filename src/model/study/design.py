"""Design: choose the free quantities of a device within their ranges and limits.

A *setting* gives each free quantity a value. It is judged by devices drawn within the tolerances
around it. Its *yield* is the share of devices that go in from every start. Its *margin* is the
distance, in tolerances, of the nearest failing device on ``POINTS`` lines from the setting, at most
``FARTHEST``. The best setting has the largest yield, keeps the limits, has the largest margin in
steps of ``MARGIN_STEP``, and is then the fastest. Differential evolution (scipy) seeks it. The
search is seeded and its results are kept: run again after an interruption, it repeats its steps
without computing the results that it has.
"""

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import optimize, stats

from model.events.outcomes import Unvibrated
from model.physics.parameters import FIELDS
from model.runs.settings import Settings
from model.runs.unvibrated import unvibrated
from model.study.assessment.yields import Floats, batch_of, run_devices
from model.study.devices import StatedDevice, Tolerance
from model.study.maps.starts import Starts

POINTS = 16  # devices drawn within the tolerances of a setting, a power of two
SCALES = (1.0, 2.0, 3.0)  # distances along a line that are tried, in tolerances
FARTHEST = SCALES[-1]
HALVINGS = 3  # a failure along a line is located to 1/8 of a tolerance
MARGIN_STEP = 0.25
ASSUMED = Tolerance("uniform", 0.1, relative=True)  # for a device that states no tolerance
ASSUMED_OF = ("press_force", "tilt_stiffness", "frequency", "friction", "misalignment", "clearance")
_SIGMAS = 2.0  # standard deviations that count as the end of a normal tolerance
NEAR = 0.05  # share of a limit or range within which it binds
MEASURES = ("time", "contact_force", "tilt", "vibration")


@dataclass(frozen=True)
class Tried:
    """Results of settings, in SI units.

    Attributes:
        settings: values of the free quantities, each of shape (n,).
        share: share of the devices within the tolerances that go in from every start, shape (n,).
        margin: distance of the nearest failing device, in tolerances, shape (n,).
        measures: by the names of ``MEASURES``, shape (n,): longest time, largest contact force and
            largest tilt within the tolerances, and the share of devices that do not align without
            vibration (NaN if no limit asks for it).
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
    """

    tried: Tried
    best: int
    limits: Mapping[str, float]

    @property
    def setting(self) -> dict[str, float]:
        """The recommended setting, SI units."""
        return {name: float(values[self.best]) for name, values in self.tried.settings.items()}

    @property
    def feasible(self) -> bool:
        """True if every device goes in at the recommended setting and the limits are kept."""
        return bool(self.tried.keeps(self.limits)[self.best])

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
        stated: device with free quantities.
        starts: phases and tilts at touch-down.
        run_settings: settings of the runs.
        cores: number of threads.
        seed: seed of the drawn devices and of the optimiser.
        known: results of a setting (share, margin, measures) by its values.
    """

    stated: StatedDevice
    starts: Starts
    run_settings: Settings
    cores: int = 1
    seed: int = 0
    known: dict[tuple[float, ...], tuple[float, ...]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.stated.free:
            raise ValueError(
                f"{self.stated.source}: nothing is free; state, for example, "
                "free: {press_force: 5 to 20 N}"
            )
        if not self.stated.tolerances:
            assumed = {n: ASSUMED for n in ASSUMED_OF if n in self.stated.quantities}
            self.stated = replace(self.stated, tolerances=assumed)

    @property
    def identity(self) -> str:
        """Hash of everything that determines the results."""
        whole = asdict(replace(self.stated, source=None, changes={}))  # type: ignore[arg-type]
        whole |= {"starts": list(self.starts), "seed": self.seed, "points": (POINTS, HALVINGS)}
        run = self.run_settings
        whole |= {"run": (run.scene.name, run.insertion_depth, run.tolerance, run.horizon)}
        text = json.dumps(whole, sort_keys=True, default=str)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def run(
        self,
        generations: int,
        population: int,
        after: Callable[[int], None] = lambda _: None,
    ) -> Design:
        """Search and return the design; call ``after`` with the number of every generation."""
        free = self.stated.free
        done = 0

        def score(points: Floats) -> Floats:
            return self.judge(np.atleast_2d(points.T)).score(self.stated.limits)

        def report(intermediate_result: Any) -> None:  # noqa: ARG001 - by its name, for scipy
            nonlocal done
            done += 1
            after(done)

        rng = np.random.default_rng(self.seed)
        first = stats.qmc.LatinHypercube(len(free), rng=rng).random(population)
        low, high = np.array(list(free.values())).T
        optimize.differential_evolution(
            score,
            list(free.values()),
            init=low + first * (high - low),
            maxiter=generations,
            rng=np.random.default_rng(self.seed),
            vectorized=True,
            updating="deferred",
            polish=False,
            tol=0.0,
            callback=report,
        )
        return self.best()

    def best(self) -> Design:
        """Return the design by all settings that were tried so far."""
        tried = self.tried()
        return Design(tried, int(np.argmin(tried.score(self.stated.limits))), self.stated.limits)

    def judge(self, points: Floats) -> Tried:
        """Return the results of settings, shape (n, free quantities); run those not known."""
        points = np.array([[float(f"{v:.5g}") for v in row] for row in points])
        keys = [tuple(row) for row in points.tolist()]
        new = [key for key in dict.fromkeys(keys) if key not in self.known]
        if new:
            self._compute(np.array(new))
        return self._results(keys)

    def tried(self) -> Tried:
        """Return the results of every setting so far."""
        return self._results(list(self.known))

    def _results(self, keys: list[tuple[float, ...]]) -> Tried:
        columns = np.array([self.known[key] for key in keys]).T
        settings = np.array(keys).T
        return Tried(
            dict(zip(self.stated.free, settings, strict=True)),
            columns[0],
            columns[1],
            dict(zip(MEASURES, columns[2:], strict=True)),
        )

    def _compute(self, points: Floats) -> None:
        inner, lines = self._offsets()
        shape = len(points), len(inner)
        centres, offsets = np.repeat(points, len(inner), axis=0), np.tile(inner, (len(points), 1))
        values = self._values(centres, offsets)
        results = run_devices(self.stated, values, self.starts, self.run_settings, self.cores)
        goes_in = results.goes_in.reshape(shape)
        margin = np.where(goes_in, FARTHEST, np.abs(inner).max(axis=1)).min(axis=1)
        margin = self._nearest_failure(points, lines, goes_in[:, -len(lines) :], margin)
        needs = np.full(len(points), np.nan)
        if "vibration" in self.stated.limits:
            controls = unvibrated(batch_of(self.stated, values), self.run_settings, self.cores)
            needs = (controls.outcome != Unvibrated.ALIGNS).reshape(shape).mean(axis=1)
        measures = [
            np.fmax.reduce(each.reshape(shape), axis=1)
            for each in (results.time, results.force, results.tilt)
        ]
        share = goes_in[:, : 1 + POINTS].mean(axis=1)
        columns = share, margin, *measures, needs
        for key, *row in zip(map(tuple, points.tolist()), *columns, strict=True):
            self.known[key] = tuple(float(each) for each in row)

    def _nearest_failure(
        self, points: Floats, lines: Floats, goes_in: NDArray[np.bool_], margin: Floats
    ) -> Floats:
        """Return the margins of settings by failures on ``lines``, at most ``margin``.

        The search goes outwards until a device fails, and then halves the interval. ``goes_in``,
        shape (n, lines), is the result at one tolerance.
        """
        low, high = np.where(goes_in, 1.0, 0.0), np.where(goes_in, np.inf, 1.0)
        for further in (*SCALES[1:], *[None] * HALVINGS):
            open_ones = np.isinf(high) if further else np.isfinite(high)
            row, line = np.nonzero(open_ones & (low < margin[:, None]))
            if not row.size:
                continue
            at = np.full(row.size, further) if further else 0.5 * (low + high)[row, line]
            values = self._values(points[row], lines[line] * at[:, None])
            results = run_devices(self.stated, values, self.starts, self.run_settings, self.cores)
            low[row, line] = np.where(results.goes_in, at, low[row, line])
            high[row, line] = np.where(results.goes_in, high[row, line], at)
            margin = np.minimum(margin, high.min(axis=1))
        return margin

    def _values(self, points: Floats, offsets: Floats) -> dict[str, Floats]:
        """Return the quantities of devices at ``offsets``, in tolerances, from settings."""
        names = list(dict.fromkeys((*self.stated.free, *self.stated.tolerances)))
        values = {name: np.full(len(points), self.stated.quantities[name]) for name in names}
        values |= dict(zip(self.stated.free, points.T, strict=True))
        for i, (name, tolerance) in enumerate(self.stated.tolerances.items()):
            own = values[name]
            width = np.array([tolerance.around(value) for value in own.tolist()])
            width *= 1.0 if tolerance.kind == "uniform" else _SIGMAS
            least = 1e-3 * own if _is_positive(name) else -np.inf
            values[name] = np.maximum(own + width * offsets[:, i], least)
        _keep_on_edge(self.stated, values)
        return values

    def _offsets(self) -> tuple[Floats, Floats]:
        """Return offsets of devices from a setting, in tolerances, and directions of lines.

        The devices are the setting itself, ``POINTS`` drawn ones, and the ends of as many lines
        through these.
        """
        size = len(self.stated.tolerances)
        cube = stats.qmc.Sobol(size, rng=np.random.default_rng(self.seed)).random(POINTS)
        around = 2.0 * cube - 1.0
        lines = around / np.abs(around).max(axis=1, keepdims=True)
        return np.concatenate([np.zeros((1, size)), around, lines]), lines


def _is_positive(name: str) -> bool:
    return name not in FIELDS or bool(FIELDS[name].bound) or name == "press_force"


def _keep_on_edge(stated: StatedDevice, values: dict[str, Floats]) -> None:
    """Cut misalignments off at the largest with which the part starts on the edge.

    With a larger one it cannot go in anyway.
    """
    if "misalignment" in values:
        sizes = {n: values.get(n, stated.quantities[n]) for n in ("half_width", "clearance")}
        most = 0.999 * sizes["half_width"] * (2.0 + sizes["clearance"])
        values["misalignment"] = np.minimum(values["misalignment"], most)


@dataclass(frozen=True)
class OtherFriction:
    """Results if the friction is another than a search took it to be.

    Attributes:
        friction: the other friction.
        setting: setting recommended for it, SI units.
        feasible: True if every device goes in at that setting and the limits are kept.
        share: share of the devices that go in at the setting that the search recommends.
        keeps: True if every device goes in there and the limits are kept.
    """

    friction: float
    setting: Mapping[str, float]
    feasible: bool
    share: float
    keeps: bool


def at_other_friction(
    search: Search, friction: float, generations: int, population: int
) -> OtherFriction:
    """Return what a search recommends for another ``friction``, and how its own setting does."""
    other = replace(search, stated=search.stated.changed(friction=friction), known={})
    design = other.run(generations, population)
    own = other.judge(np.array([list(search.best().setting.values())]))
    keeps = bool(own.keeps(search.stated.limits)[0])
    return OtherFriction(friction, design.setting, design.feasible, float(own.share[0]), keeps)
