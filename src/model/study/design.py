"""Design: choose the free quantities of a device within their ranges and limits.

Every candidate setting is judged by devices drawn within its tolerances. *Yield* is the share that
goes in from every start; *margin* is the distance of the nearest failing device on ``POINTS`` lines
from the setting, in tolerances, at most ``FARTHEST``. The best setting has the largest yield, keeps
the limits, has the largest margin in steps of ``MARGIN_STEP``, and is then the fastest.
Differential evolution (scipy) seeks it; it is seeded, and what was computed is kept, so that a
search that was interrupted is replayed up to where it stood.
"""

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy import optimize, stats

from model.events.outcomes import Unvibrated
from model.physics.parameters import FIELDS
from model.runs.settings import Settings
from model.runs.unvibrated import unvibrated
from model.study.assessment.yields import Floats, batch_of, run_devices
from model.study.devices import StatedDevice, Tolerance
from model.study.maps.starts import Starts

POINTS = 16  # devices drawn within the tolerances of a candidate, a power of two
SCALES = (1.0, 2.0, 3.0)  # multiples of the tolerances that are tried
FARTHEST = SCALES[-1]
HALVINGS = 3  # of the interval that holds the nearest failure on a line: known to 1/8
MARGIN_STEP = 0.25
ASSUMED = Tolerance("uniform", 0.1, relative=True)  # of a device that states none
ASSUMED_OF = ("press_force", "tilt_stiffness", "frequency", "friction", "misalignment", "clearance")
_SIGMAS = 2.0  # of a normal tolerance, taken as its end
NEAR = 0.05  # of a limit or of a range: so near, it binds
MEASURES = ("time", "contact_force", "tilt", "vibration")


@dataclass(frozen=True)
class Judged:
    """Results of candidate settings in SI units, arrays of shape (n,).

    Attributes:
        settings: the free quantities, each of shape (n,).
        share: share of the devices within the tolerances that go in from every start.
        margin: distance of the nearest failing device, in tolerances.
        measures: longest time, largest contact force and largest tilt within the tolerances, and
            the share of those devices that do not align without vibration; NaN if not asked for.
    """

    settings: Mapping[str, Floats]
    share: Floats
    margin: Floats
    measures: Mapping[str, Floats]

    def excess(self, limits: Mapping[str, float]) -> Floats:
        """Return the largest excess over the limits, relative; <= 0 where all are kept."""
        if not limits:
            return np.full(self.share.size, -1.0)
        each = [
            np.abs(self.measures[name] - limit)
            if name == "vibration"
            else self.measures[name] / limit - 1.0
            for name, limit in limits.items()
        ]
        return np.nan_to_num(np.max(each, axis=0), nan=9.0)

    def keeps(self, limits: Mapping[str, float]) -> NDArray[np.bool_]:
        """Return where every device goes in and the limits are kept."""
        return (self.share == 1.0) & (self.excess(limits) <= 0.0)

    def score(self, limits: Mapping[str, float]) -> Floats:
        """Return the order of the candidates, the best first: < 0 where all is kept."""
        excess = np.clip(self.excess(limits), 0.0, 9.0)
        steps = np.floor(self.margin / MARGIN_STEP) * MARGIN_STEP
        time = np.nan_to_num(self.measures["time"], nan=np.inf)
        fast = 1.0 / (1.0 + time)  # between 0 and 1: decides between equal margins
        fine = -1.0 - steps - MARGIN_STEP * fast
        return np.where(self.keeps(limits), fine, 10.0 * (1.0 - self.share) + excess)


@dataclass(frozen=True)
class Design:
    """Result of a search.

    Attributes:
        judged: every candidate, in the order in which it was computed.
        best: number of the recommended one.
        limits: limits of the search.
    """

    judged: Judged
    best: int
    limits: Mapping[str, float]

    @property
    def setting(self) -> dict[str, float]:
        """The recommended setting, SI units."""
        return {name: float(values[self.best]) for name, values in self.judged.settings.items()}

    @property
    def feasible(self) -> bool:
        """True if the recommended setting goes in with every device and keeps the limits."""
        return bool(self.judged.keeps(self.limits)[self.best])

    @property
    def front(self) -> NDArray[np.int64]:
        """Numbers of the candidates that no other beats in time and margin, fastest first."""
        order = np.lexsort((-self.judged.margin, self.judged.measures["time"]))
        found, most = [], -1.0
        for i in order[self.judged.keeps(self.limits)[order]]:
            if self.judged.margin[i] > most:
                found.append(int(i))
                most = float(self.judged.margin[i])
        return np.array(found, dtype=np.int64)

    def binding(self, free: Mapping[str, tuple[float, float]]) -> list[str]:
        """Return limits and ends of ranges on which the recommended setting lies."""
        found = [
            f"limit of {name}"
            for name, limit in self.limits.items()
            if name != "vibration" and self.judged.measures[name][self.best] > (1.0 - NEAR) * limit
        ]
        for name, (low, high) in free.items():
            value, near = self.setting[name], NEAR * (high - low)
            if value < low + near:
                found.append(f"lower end of {name}")
            if value > high - near:
                found.append(f"upper end of {name}")
        return found

    def to_relax(self) -> dict[str, float]:
        """Return the least value of each limit that alone would have to be raised, if any is."""
        found = {}
        for name in self.limits:
            others = {other: limit for other, limit in self.limits.items() if other != name}
            kept = self.judged.keeps(others)
            if kept.any():
                found[name] = float(self.judged.measures[name][kept].min())
        return found


@dataclass
class Search:
    """A search that can be continued: results by candidate, kept across interruptions.

    Attributes:
        stated: device with free quantities.
        starts: phases and tilts at touch-down.
        run_settings: settings of the runs.
        cores: number of threads.
        seed: of the drawn devices and of the optimiser.
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
            own = {n: ASSUMED for n in ASSUMED_OF if n in self.stated.quantities}
            self.stated = replace(self.stated, tolerances=own)

    @property
    def identity(self) -> str:
        """Hash of all that the results depend on."""
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
        """Search and return the design; ``after`` is called with every generation's number."""
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
        judged = self.all_known()
        return Design(judged, int(np.argmin(judged.score(self.stated.limits))), self.stated.limits)

    def judge(self, points: Floats) -> Judged:
        """Return the results of candidates, shape (n, free quantities); known ones are not run."""
        points = np.array([[float(f"{v:.5g}") for v in row] for row in points])
        keys = [tuple(row) for row in points.tolist()]
        new = [key for key in dict.fromkeys(keys) if key not in self.known]
        if new:
            self._compute(np.array(new))
        return self._as_judged(keys)

    def all_known(self) -> Judged:
        """Return the results of every candidate so far."""
        return self._as_judged(list(self.known))

    def _as_judged(self, keys: list[tuple[float, ...]]) -> Judged:
        columns = np.array([self.known[key] for key in keys]).T
        places = np.array(keys).T
        return Judged(
            dict(zip(self.stated.free, places, strict=True)),
            columns[0],
            columns[1],
            dict(zip(MEASURES, columns[2:], strict=True)),
        )

    def _compute(self, points: Floats) -> None:
        inner, lines = self._offsets()
        shape = len(points), len(inner)
        every = np.repeat(points, len(inner), axis=0), np.tile(inner, (len(points), 1))
        values = self._values(*every)
        found = run_devices(self.stated, values, self.starts, self.run_settings, self.cores)
        goes_in = found.goes_in.reshape(shape)
        margin = np.where(goes_in, FARTHEST, np.abs(inner).max(axis=1)).min(axis=1)
        margin = self._nearest_failure(points, lines, goes_in[:, -len(lines) :], margin)
        needs = np.full(len(points), np.nan)
        if "vibration" in self.stated.limits:
            controls = unvibrated(batch_of(self.stated, values), self.run_settings, self.cores)
            needs = (controls.outcome != Unvibrated.ALIGNS).reshape(shape).mean(axis=1)
        measures = [
            np.fmax.reduce(each.reshape(shape), axis=1)
            for each in (found.time, found.force, found.tilt)
        ]
        share = goes_in[:, : 1 + POINTS].mean(axis=1)
        columns = share, margin, *measures, needs
        for key, *row in zip(map(tuple, points.tolist()), *columns, strict=True):
            self.known[key] = tuple(float(each) for each in row)

    def _nearest_failure(
        self, points: Floats, lines: Floats, goes_in: NDArray[np.bool_], margin: Floats
    ) -> Floats:
        """Return the margin of candidates: of failures on ``lines``, and at most ``margin``.

        ``goes_in``, shape (n, lines), is the result at one tolerance.
        """
        low, high = np.where(goes_in, 1.0, 0.0), np.where(goes_in, np.inf, 1.0)
        for further in (*SCALES[1:], *[None] * HALVINGS):
            open_ones = np.isinf(high) if further else np.isfinite(high)
            row, line = np.nonzero(open_ones & (low < margin[:, None]))
            if not row.size:
                continue
            at = np.full(row.size, further) if further else 0.5 * (low + high)[row, line]
            values = self._values(points[row], lines[line] * at[:, None])
            found = run_devices(self.stated, values, self.starts, self.run_settings, self.cores)
            low[row, line] = np.where(found.goes_in, at, low[row, line])
            high[row, line] = np.where(found.goes_in, high[row, line], at)
            margin = np.minimum(margin, high.min(axis=1))
        return margin

    def _values(self, points: Floats, offsets: Floats) -> dict[str, Floats]:
        """Return the quantities of devices that are off candidates by ``offsets`` (tolerances)."""
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
        """Return the devices within the tolerances of a candidate, and their lines outwards.

        In tolerances: the candidate, ``POINTS`` drawn ones, and the ends of as many lines.
        """
        size = len(self.stated.tolerances)
        cube = stats.qmc.Sobol(size, rng=np.random.default_rng(self.seed)).random(POINTS)
        around = 2.0 * cube - 1.0
        lines = around / np.abs(around).max(axis=1, keepdims=True)
        return np.concatenate([np.zeros((1, size)), around, lines]), lines


def _is_positive(name: str) -> bool:
    return name not in FIELDS or bool(FIELDS[name].bound) or name == "press_force"


def _keep_on_edge(stated: StatedDevice, values: dict[str, Floats]) -> None:
    """Keep misalignments at which the part starts on the edge; beyond, it cannot go in anyway."""
    if "misalignment" in values:
        own = {n: values.get(n, stated.quantities[n]) for n in ("half_width", "clearance")}
        most = 0.999 * own["half_width"] * (2.0 + own["clearance"])
        values["misalignment"] = np.minimum(values["misalignment"], most)


def misjudged(search: Search, friction: float, generations: int, population: int) -> "Misjudged":
    """Return the recommendation at another ``friction``, and results of the first one there."""
    other = replace(search, stated=search.stated.changed(friction=friction), known={})
    found = Design(search.all_known(), 0, search.stated.limits)
    own = replace(found, best=int(np.argmin(found.judged.score(found.limits))))
    design = other.run(generations, population)
    there = other.judge(np.array([list(own.setting.values())]))
    keeps = bool(there.keeps(search.stated.limits)[0])
    return Misjudged(friction, design.setting, design.feasible, float(there.share[0]), keeps)


@dataclass(frozen=True)
class Misjudged:
    """Consequences of another friction than that of the search.

    Attributes:
        friction: the other friction.
        setting: the setting recommended there, SI units.
        feasible: it keeps the limits there, and every device goes in.
        share: share of the devices with the first recommendation that go in there.
        keeps: the first recommendation keeps the limits there, and every device goes in.
    """

    friction: float
    setting: Mapping[str, float]
    feasible: bool
    share: float
    keeps: bool


# --- Files --------------------------------------------------------------------------------------

_NAMES = {
    "share": ("share of the devices within the tolerances that go in from every start", "1"),
    "margin": ("distance of the nearest failing device, in tolerances", "1"),
    "time": ("longest alignment time within the tolerances", "s"),
    "contact_force": ("largest contact force within the tolerances", "N"),
    "tilt": ("largest tilt within the tolerances", "rad"),
    "vibration": ("share of the devices within the tolerances that need the vibration", "1"),
}


def design_dataset(search: Search, design: Design) -> xr.Dataset:
    """Return every candidate of a search with its results, dim "candidate", in SI units."""
    judged = design.judged
    columns = {"share": judged.share, "margin": judged.margin, **judged.measures}
    variables: dict[str, Any] = {
        name: ("candidate", values, {"long_name": _NAMES[name][0], "units": _NAMES[name][1]})
        for name, values in columns.items()
    }
    for name, values in judged.settings.items():
        unit = FIELDS[name].quantity.unit if name in FIELDS else ""
        attributes = {"long_name": f"setting: {name}", "units": unit}
        variables[f"setting_{name}"] = ("candidate", values, attributes)
    front = np.isin(np.arange(judged.share.size), design.front).astype(np.int8)
    variables["front"] = ("candidate", front, {"long_name": "1 on the front of time and margin"})
    facts: dict[str, Any] = {
        "title": "Settings of a device: yield, margin and time",
        "identity": search.identity,
        "free": list(search.stated.free),
        "recommended": design.best,
    }
    return xr.Dataset(variables, attrs=facts)


def known_of(dataset: xr.Dataset, search: Search) -> dict[tuple[float, ...], tuple[float, ...]]:
    """Return the results in a dataset of the same search; none of another one."""
    if dataset.attrs.get("identity") != search.identity:
        return {}
    keys = np.stack([dataset[f"setting_{name}"].values for name in search.stated.free], axis=1)
    rows = np.stack([dataset[name].values for name in ("share", "margin", *MEASURES)], axis=1)
    pairs = zip(keys.tolist(), rows.tolist(), strict=True)
    return {tuple(key): tuple(row) for key, row in pairs}
