"""The study as data: config.yaml, checked strictly before anything is computed.

Every error names the key's path, the value, and the rule. The structural baseline stands in the
configuration only; ``baseline`` reads it from there.
"""

import difflib
import itertools
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

import yaml
from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    ValidationError,
    model_validator,
)

from model.physics.parameters import (
    FIELDS,
    PARAMETER_NAMES,
    REQUIRED_NAMES,
    Batch,
    Parameters,
    check_name,
)
from model.physics.readings import READING_NAMES, Readings
from model.runs.settings import Settings

SCHEMATICS = ("fig01", "fig02", "fig03", "fig04")
HISTORIES = ("fig05",)
CURVES = ("fig06", "fig07", "fig08", "fig09", "fig10", "fig11", "fig12")
MAPS = ("fig13", "fig14")
FIGURES = SCHEMATICS + HISTORIES + CURVES + MAPS
LARGEST_MISALIGNMENT = "largest_misalignment"  # the map that is not one of outcomes
# What the identification searches of the structure; see identification/candidate.py.
SEARCHED = (
    "half_width",
    "half_height",
    "inertia_ratio",
    "lateral_stiffness",
    "lateral_damping_ratio",
    "axial_damping_ratio",
    "tilt_damping_ratio",
)


Value = TypeVar("Value")


class ConfigError(ValueError):
    """A configuration that breaks a rule; the message has one line for each fault."""


def _parameter_name(name: str) -> str:
    check_name(name, PARAMETER_NAMES, "parameter")
    return name


def _parameter_names(values: dict[str, Value]) -> dict[str, Value]:
    for name in values:
        _parameter_name(name)
    return values


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


ParameterName = Annotated[str, AfterValidator(_parameter_name)]
ParameterValues = Annotated[dict[str, float], AfterValidator(_parameter_names)]


class Span(_Strict):
    """A range of one parameter."""

    parameter: ParameterName
    start: float
    stop: float

    @model_validator(mode="after")
    def _is_a_range(self) -> "Span":
        if not self.start < self.stop:
            raise ValueError(f"start = {self.start} must be smaller than stop = {self.stop}")
        return self


class Axis(Span):
    """Equidistant values of one parameter, both ends included."""

    count: int = Field(ge=2)

    @property
    def values(self) -> list[float]:
        """The values, rounded to 12 digits so that decimal steps read as decimals."""
        step = (self.stop - self.start) / (self.count - 1)
        return [float(f"{self.start + i * step:.12g}") for i in range(self.count)]


class Family(_Strict):
    """Values of the parameter that tells the curves of a figure apart."""

    parameter: ParameterName
    values: list[float] = Field(min_length=1)

    @model_validator(mode="after")
    def _is_distinct(self) -> "Family":
        if len(set(self.values)) < len(self.values):
            raise ValueError(f"values = {self.values} must differ from each other")
        return self


class _Figure(_Strict):
    title: str = Field(min_length=1)
    caption: str = Field(min_length=1)
    held: ParameterValues = {}


class Schematic(_Figure):
    """A drawing of the model (Figs. 1 to 4)."""

    kind: Literal["schematic"]


class History(_Figure):
    """One trajectory over time (Fig. 5)."""

    kind: Literal["history"]


class Curves(_Figure):
    """Alignment duration over one parameter, a curve for each value of another (Figs. 6 to 12)."""

    kind: Literal["curves"]
    swept: Axis
    family: Family
    chunks: int = Field(ge=1, le=64)


class Map(_Figure):
    """Outcome and duration over two parameters (Figs. 13 and 14)."""

    kind: Literal["map"]
    x: Axis
    y: Axis
    chunks: int = Field(ge=1, le=64)


FigureSpec = Annotated[Schematic | History | Curves | Map, Discriminator("kind")]
_KIND = dict.fromkeys(SCHEMATICS, "schematic") | dict.fromkeys(HISTORIES, "history")
_KIND |= dict.fromkeys(CURVES, "curves") | dict.fromkeys(MAPS, "map")


class RunSettings(_Strict):
    """How every run of the study is computed."""

    readings: Literal["consistent", "printed"] | dict[str, Literal["consistent", "printed"]]
    horizon: float = Field(gt=0.0)
    tolerance: float = Field(ge=1e-14, le=1e-2)

    @model_validator(mode="after")
    def _readings_exist(self) -> "RunSettings":
        if isinstance(self.readings, dict):
            for name in self.readings:
                check_name(name, READING_NAMES, "reading")
        return self

    @property
    def settings(self) -> Settings:
        """The form that ``simulate`` and ``align`` take."""
        if isinstance(self.readings, dict):
            readings = Readings(**self.readings)
        else:
            readings = getattr(Readings, self.readings)()
        return Settings(readings=readings, horizon=self.horizon, tolerance=self.tolerance)


class Range(_Strict):
    """How one parameter is drawn: log-uniform from low to high, or 0 in a share of the sets."""

    low: float = Field(gt=0.0)
    high: float
    zero: float = Field(default=0.0, ge=0.0, lt=1.0)

    @model_validator(mode="after")
    def _is_a_range(self) -> "Range":
        if not self.low < self.high:
            raise ValueError(f"low = {self.low} must be smaller than high = {self.high}")
        return self

    def holds(self, value: float) -> bool:
        """Whether sets with this value, or with values on both sides of it, can be drawn."""
        return self.low <= value <= self.high or (value == 0.0 and self.zero > 0.0)


class SettledTrial(_Strict):
    """How many sets are drawn for the trial of settled runs, and how long they are run on."""

    sets: int = Field(ge=1)
    chunks: int = Field(ge=1, le=1000)
    longer: float = Field(gt=1.0)


class Accuracy(_Strict):
    """The law by which the integrator's accuracy is tried on random sets; see accuracy.py."""

    seed: int = Field(ge=0)
    horizon: float = Field(gt=0.0)
    sets: int = Field(ge=1)
    chunks: int = Field(ge=1, le=1000)
    settled: SettledTrial
    ranges: Annotated[dict[str, Range], AfterValidator(_parameter_names)]


class Pool(_Strict):
    """The first samples of a search: structures, and operating points tried with each of them."""

    structures: int = Field(ge=1)
    operating_points: int = Field(ge=1)
    chunks: int = Field(ge=1, le=1000)


class Evolution(_Strict):
    """How far a search is carried on from its first samples.

    A population of structures evolves; with each structure ``trials`` operating points of every
    figure are tried. Then, with the ``polished`` best structures, ``polish`` more in each of
    ``passes``.
    """

    population: int = Field(ge=5)
    generations: int = Field(ge=1)
    trials: int = Field(ge=2)
    polished: int = Field(ge=1)
    passes: int = Field(ge=1)
    polish: int = Field(ge=2)


Counts = dict[str, Annotated[int, Field(ge=4)]]
Ranges = Annotated[dict[str, Range], Field(min_length=1)]


class SearchLaw(_Strict):
    """What is searched, and what is looked at; see identification/candidate.py.

    Attributes:
        seed: of every draw.
        horizon: latest time of the search's runs.
        tolerance: of the search's runs, each of which is run once.
        counts: values along each axis of a figure with a grid; other figures are not computed.
        run_counts: values along the axis of each of the claims' own runs that are computed.
        structure: ranges of what all figures share.
        stated: what the paper says of a figure's operating point.
        operating_points: ranges of what it leaves open, by figure.
        set_aside: claims that do not count in the score, with the reason.
        required: claims that a figure must show, by figure.
        goal: margin from which more of it is worth little.
    """

    seed: int = Field(ge=0)
    horizon: float = Field(gt=0.0)
    tolerance: float = Field(ge=1e-14, le=1e-2)
    counts: Counts
    run_counts: dict[str, Annotated[int, Field(ge=2)]]
    structure: Ranges
    stated: dict[str, ParameterValues]
    operating_points: dict[str, Annotated[Ranges, AfterValidator(_parameter_names)]]
    set_aside: dict[str, str]
    required: dict[str, list[str]]
    goal: float = Field(gt=0.0, lt=1.0)

    @model_validator(mode="after")
    def _names_figures(self) -> "SearchLaw":
        for name in (*self.counts, *self.stated, *self.operating_points, *self.required):
            check_name(name, HISTORIES + CURVES + MAPS, "figure that is computed")
        missing = [name for name in self.operating_points if name not in (*self.counts, *HISTORIES)]
        if missing:
            raise ValueError(f"counts: missing {', '.join(missing)}")
        for name in self.structure:
            check_name(name, SEARCHED, "parameter that is searched")
        if len(self.structure) < len(SEARCHED):
            lacking = [name for name in SEARCHED if name not in self.structure]
            raise ValueError(f"structure: missing {', '.join(lacking)}")
        return self


class Identification(_Strict):
    """How unstated parameters are identified, and how much is spent on it.

    Attributes:
        law: what is searched.
        pool: the first samples under the study's reading.
        rounds: of each search over all claims.
        starts: searches over all claims, which draw differently.
        known: sets found before, by unknown, that the last of these sets out from as well.
        finer: how many of the best are judged again, with three times the values along each axis;
            of these are the admissible sets.
        final: how many of the best of these are judged on the study's own grids, where the one that
            shows most is the study's device.
        finer_each: how many of each search over half of the claims, and of each reading's.
        half: rounds of each search over half of the claims.
        splits: how often the claims are halved.
        admissible: how many claims fewer than the best an admissible set may reproduce.
        reading_counts: as the law's, in the searches under each reading.
        reading_rounds: of each reading's search, the consistent one's again.
    """

    law: SearchLaw
    pool: Pool
    rounds: Annotated[list[Evolution], Field(min_length=1)]
    starts: int = Field(ge=1)
    known: dict[str, dict[str, float]]
    finer: int = Field(ge=1)
    final: int = Field(ge=1)
    finer_each: int = Field(ge=1)
    half: Annotated[list[Evolution], Field(min_length=1)]
    splits: int = Field(ge=1)
    admissible: int = Field(ge=0)
    reading_counts: Counts
    reading_rounds: Annotated[list[Evolution], Field(min_length=1)]

    @model_validator(mode="after")
    def _same_figures(self) -> "Identification":
        if set(self.reading_counts) != set(self.law.counts):
            raise ValueError("reading_counts: must name the figures that law.counts names")
        return self


class Case(_Strict):
    """One operating point at which methods are compared, from a figure of the study.

    Without ``until`` it aligns, and the error is that of the alignment time; with it, the error is
    that of the state at τ = ``until``, which must come before any alignment.
    """

    title: str = Field(min_length=1)
    reason: str = Field(min_length=1)
    figure: str
    at: ParameterValues
    until: float | None = Field(default=None, gt=0.0)


class Ladder(_Strict):
    """How finely each method is run: tolerances of the adaptive ones, steps of the others."""

    tolerances: list[float] = Field(min_length=1)
    steps: list[float] = Field(min_length=1)
    true_tolerance: float = Field(ge=1e-14, le=1e-2)
    max_evaluations: int = Field(ge=1)
    max_evaluations_scipy: int = Field(ge=1)

    @model_validator(mode="after")
    def _gets_finer(self) -> "Ladder":
        if min(self.tolerances) < 1e-14 or max(self.tolerances) > 1e-2:
            raise ValueError(f"tolerances = {self.tolerances}: must be between 1e-14 and 1e-2")
        if not self.true_tolerance < min(self.tolerances):
            raise ValueError(
                f"true_tolerance = {self.true_tolerance}: must be smaller than all tolerances, "
                "since their errors are measured against it"
            )
        for name, values in {"tolerances": self.tolerances, "steps": self.steps}.items():
            _check_falling(name, values)
        return self


class FixedSteps(_Strict):
    """Figures computed anew with fixed steps, to count the points that come out wrong.

    ``figures`` says of each how much of it: every n-th value along its axes.
    """

    steps: list[float] = Field(min_length=1)
    tau_tolerance: float = Field(gt=0.0)
    figures: dict[str, Annotated[int, Field(ge=1)]] = Field(min_length=1)

    @model_validator(mode="after")
    def _can_be_run(self) -> "FixedSteps":
        _check_falling("steps", self.steps)
        for name in self.figures:
            check_name(name, CURVES + MAPS, "figure with a grid")
        return self


def _check_falling(name: str, values: list[float]) -> None:
    falling = all(later < earlier for earlier, later in itertools.pairwise(values))
    if not (falling and values[-1] > 0.0):
        raise ValueError(f"{name} = {values}: must fall from one to the next and stay > 0")


class Precision(_Strict):
    """The section on speed against error."""

    cases: dict[str, Case] = Field(min_length=1)
    ladder: Ladder
    fixed_steps: FixedSteps


class HardCase(_Strict):
    """One scene that is hard to integrate, and how long it is run: the baseline but for ``at``.

    ``max_evaluations`` takes the place of the section's for a case that is long by itself.
    """

    title: str = Field(min_length=1)
    at: ParameterValues
    until: float = Field(gt=0.0)
    max_evaluations: int | None = Field(default=None, ge=1)


class StiffnessCases(_Strict):
    """A case for each pair of stiffness and damping of the base."""

    stiffness: list[float] = Field(min_length=1)
    damping: list[float] = Field(min_length=1)
    at: ParameterValues
    until: float = Field(gt=0.0)


class HardCases(_Strict):
    """The section on hard cases: every method on every case, and when its answer counts.

    Adaptive methods run at ``tolerance``, the others with steps of ``step``. An answer is accurate
    if it is off by no more than ``accurate``; a method is broken where it needs more evaluations
    than it may.
    """

    tolerance: float = Field(ge=1e-14, le=1e-2)
    step: float = Field(gt=0.0)
    true_tolerance: float = Field(ge=1e-14, le=1e-2)
    accurate: float = Field(gt=0.0)
    max_evaluations: int = Field(ge=1)
    max_evaluations_scipy: int = Field(ge=1)
    base: StiffnessCases
    cases: dict[str, HardCase] = Field(min_length=1)

    @property
    def all_cases(self) -> dict[str, HardCase]:
        """The cases by name: those of the base first, stiffness by stiffness."""
        found = {}
        for stiffness in self.base.stiffness:
            for damping in self.base.damping:
                values = {"contact_stiffness": stiffness, "contact_damping": damping}
                found[f"base_{stiffness:g}_{damping:g}"] = HardCase(
                    title=f"base k_a = {stiffness:g}, h_a = {damping:g}",
                    at=self.base.at | values,
                    until=self.base.until,
                )
        return found | self.cases


class Plane(_Figure):
    """A map over two parameters that is not a figure of the paper."""

    x: Span
    y: Span


class Ensemble(_Strict):
    """The starts that a part must align from to count as reliable; see maps.py."""

    phases: int = Field(ge=1)
    tilts: list[Annotated[float, Field(gt=0.0)]] = Field(min_length=1)
    every: int = Field(ge=1)

    @model_validator(mode="after")
    def _can_be_halved(self) -> "Ensemble":
        if self.every & (self.every - 1):
            raise ValueError(f"every = {self.every}: must be a power of two: cells are halved")
        return self


class Resolution(_Strict):
    """Finest cells along a side of a map, a power of two: of the paper's, and of the others."""

    figures: int = Field(ge=2, le=8192)
    planes: int = Field(ge=2, le=8192)

    @model_validator(mode="after")
    def _can_be_halved(self) -> "Resolution":
        for name, value in {"figures": self.figures, "planes": self.planes}.items():
            if value & (value - 1):
                raise ValueError(f"{name} = {value}: must be a power of two: cells are halved")
        return self


class Maps(_Strict):
    """Maps that follow their boundary: those of the paper over their figures' ranges, and more."""

    resolution: Resolution
    chunks: int = Field(ge=1, le=64)
    ensemble: Ensemble
    planes: dict[str, Plane]
    largest_misalignment: Plane
    trials: int = Field(ge=2)

    @model_validator(mode="after")
    def _names_are_new(self) -> "Maps":
        for name in set(self.planes) & {*FIGURES, LARGEST_MISALIGNMENT}:
            raise ValueError(f"planes.{name}: is the name of a map that the study has already")
        return self


class ClaimRun(_Strict):
    """Curves that only the claims ledger reads, at the operating point of a figure.

    ``centred`` starts the part with its mass centre above the edge, where the press has no arm.
    """

    title: str = Field(min_length=1)
    figure: str
    held: ParameterValues = {}
    centred: bool = False
    swept: Axis
    family: Family

    def changes(self, half_width: float, clearance: float) -> dict[str, float]:
        """What the run holds otherwise than its figure, for a part and a slot of these sizes."""
        centred = {"misalignment": half_width * (1.0 + clearance)} if self.centred else {}
        return {**self.held, **centred}


class CoarseGrid(_Strict):
    """A figure on fewer points along each axis, and on these values of its family only."""

    points: int = Field(ge=2)
    family: list[float] | None = Field(default=None, min_length=1)


class ContactStiffness(_Strict):
    """Figures on bases of other stiffness and damping; see contact_stiffness.py.

    ``stiffnesses`` are tried at the device's damping ratio, ``damping_ratios`` at each of
    ``damped_at``.
    """

    horizon: float = Field(gt=0.0)
    tolerance: float = Field(ge=1e-14, le=1e-2)
    stiffnesses: list[Annotated[float, Field(gt=0.0)]] = Field(min_length=1)
    damping_ratios: list[Annotated[float, Field(ge=0.0)]]
    damped_at: list[Annotated[float, Field(gt=0.0)]]
    figures: dict[str, CoarseGrid] = Field(min_length=1)

    @model_validator(mode="after")
    def _can_be_run(self) -> "ContactStiffness":
        for name in self.figures:
            check_name(name, CURVES + MAPS, "figure with a grid")
        return self


class Study(_Strict):
    """The whole study; see config/config.yaml."""

    results_root: str = Field(min_length=1)
    settings: RunSettings
    structure: ParameterValues
    operating_point: ParameterValues
    figures: dict[str, FigureSpec]
    maps: Maps
    accuracy: Accuracy
    precision: Precision
    identification: Identification
    hard_cases: HardCases
    claims_runs: dict[str, ClaimRun]
    contact_stiffness: ContactStiffness

    @model_validator(mode="after")
    def _figures_exist(self) -> "Study":
        for name in self.figures:
            check_name(name, FIGURES, "figure")
        missing = [name for name in FIGURES if name not in self.figures]
        if missing:
            raise ValueError(f"figures: missing {', '.join(missing)}")
        for name in self.identification.law.run_counts:
            check_name(name, tuple(self.claims_runs), "run of the claims")
        twice = sorted(set(self.structure) & set(self.operating_point))
        if twice:
            raise ValueError(f"{', '.join(twice)}: stated in both structure and operating_point")
        return self

    @property
    def baseline(self) -> Parameters:
        """The device at its default operating point."""
        return Parameters(**self.structure, **self.operating_point)

    def parameters(self, figure: str) -> Parameters:
        """What a figure holds, before it sweeps anything."""
        return self.baseline.replace(**self.figures[figure].held)

    def plane(self, name: str) -> Plane | Map:
        """A map's ranges and wording: a figure's, one of ``maps.planes``, "largest_misalignment".

        Raises:
            ValueError: no map of that name.
        """
        check_name(name, self.map_names, "map")
        if name == LARGEST_MISALIGNMENT:
            return self.maps.largest_misalignment
        found = self.maps.planes.get(name) or self.figures[name]
        assert isinstance(found, (Plane, Map)), name  # noqa: S101  (checked with the figures)
        return found

    @property
    def map_names(self) -> tuple[str, ...]:
        """Every map of the study, those of the paper first."""
        return *MAPS, *self.maps.planes, LARGEST_MISALIGNMENT

    def claim_parameters(self, name: str) -> Parameters:
        """What a run of the claims ledger holds, before it sweeps anything."""
        run = self.claims_runs[name]
        parameters = self.parameters(run.figure)
        return parameters.replace(**run.changes(parameters.half_width, parameters.clearance))

    def case(self, name: str) -> Parameters:
        """The operating point of a case: what its figure holds, and what the case adds."""
        case = self.precision.cases[name]
        return self.parameters(case.figure).replace(**case.at)


def _line(source: str, error: Mapping[str, Any]) -> str:
    """One fault in one line: path, value, rule."""
    place = [str(part) for part in error["loc"] if _is_key(part)]
    path = ".".join(place) or "(top level)"
    if error["type"] == "extra_forbidden":
        return f"{source}: {path}: unknown key"
    if error["type"] == "missing":
        return f"{source}: {path}: missing"
    message = error["msg"].removeprefix("Value error, ")
    value = error["input"]
    shown = "" if isinstance(value, (dict, BaseModel)) else f" = {value!r}"
    return f"{source}: {path}{shown}: {message}"


def _is_key(part: int | str) -> bool:
    """Whether a part of a fault's place is a key, and not pydantic's name of an alternative."""
    return str(part) not in set(_KIND.values()) and "[" not in str(part)


def _known_keys(path: tuple[Any, ...]) -> list[str]:
    """Keys admissible beside an unknown one, for the hint."""
    models: dict[int, type[BaseModel]] = {1: Study}
    kinds: dict[str, type[BaseModel]] = {
        "schematic": Schematic,
        "history": History,
        "curves": Curves,
        "map": Map,
    }
    if path[0] == "settings":
        models[2] = RunSettings
    elif path[0] == "accuracy":
        models[2], models[3], models[4] = Accuracy, SettledTrial, Range
    elif path[0] == "precision":
        parts: dict[str, type[BaseModel]] = {"ladder": Ladder, "fixed_steps": FixedSteps}
        models |= {2: Precision, 3: parts.get(path[1], Case), 4: Case}
    elif path[0] == "maps":
        named: dict[str, type[BaseModel]] = {"ensemble": Ensemble, "resolution": Resolution}
        models |= {2: Maps, 3: named.get(path[1], Plane)}
        models |= {4: Plane if path[1] == "planes" else Span, 5: Span}
    elif path[0] == "contact_stiffness":
        models |= {2: ContactStiffness, 4: CoarseGrid}
    elif path[0] == "claims_runs":
        models[3] = ClaimRun
        models[4] = Family if path[2] == "family" else Axis
    elif path[0] == "hard_cases":
        models[2] = HardCases
        models[3] = StiffnessCases if path[1] == "base" else HardCase
        models[4] = HardCase
    elif path[0] == "figures" and len(path) > 3:
        models[4] = kinds[path[2]]
        models[5] = Family if path[3] == "family" else Axis
    model = models.get(len(path))
    return list(model.model_fields) if model else []


def _with_hint(line: str, error: Mapping[str, Any]) -> str:
    if error["type"] != "extra_forbidden":
        return line
    known = _known_keys(error["loc"])
    near = difflib.get_close_matches(str(error["loc"][-1]), known, n=1)
    hint = f"; did you mean {near[0]!r}?" if near else ""
    return f"{line}{hint}" + (f" Valid: {', '.join(known)}" if known else "")


def _value_faults(place: str, values: Mapping[str, float]) -> list[str]:
    return [
        f"{place}.{name} = {value!r}: {FIELDS[name].rule}"
        for name, value in values.items()
        if not FIELDS[name].admits(value)
    ]


def _check_figures(study: Study, source: str) -> list[str]:
    """Faults that need the whole study: values against the rules of their parameters."""
    faults = _value_faults(f"{source}: structure", study.structure)
    faults += _value_faults(f"{source}: operating_point", study.operating_point)
    stated = set(study.structure) | set(study.operating_point)
    faults += [
        f"{source}: structure.{name}: missing ({FIELDS[name].description})"
        for name in REQUIRED_NAMES
        if name not in stated
    ]
    for name, figure in study.figures.items():
        faults += _value_faults(f"{source}: figures.{name}.held", figure.held)
    if faults:
        return faults
    faults += _check_law(study, source)
    for name, figure in study.figures.items():
        if figure.kind != _KIND[name]:
            faults.append(
                f"{source}: figures.{name}.kind = {figure.kind!r}: must be {_KIND[name]!r}"
            )
        varied: dict[str, Axis | Family] = {}
        if isinstance(figure, Curves):
            varied = {"swept": figure.swept, "family": figure.family}
        elif isinstance(figure, Map):
            varied = {"x": figure.x, "y": figure.y}
        names = [part.parameter for part in varied.values()]
        if len(set(names)) < len(names):
            faults.append(f"{source}: figures.{name}: {names[0]!r} is varied twice")
        for held in set(names) & set(figure.held):
            faults.append(f"{source}: figures.{name}.held.{held}: is varied in the same figure")
        try:
            parameters = study.parameters(name)
        except (TypeError, ValueError) as error:
            faults.append(f"{source}: figures.{name}.held: {error}")
            continue
        for key, part in varied.items():
            try:
                Batch.of(parameters, **{part.parameter: part.values})
            except ValueError as error:
                faults.append(f"{source}: figures.{name}.{key}: {error}")
    faults += _case_faults(study, source) + _plane_faults(study, source)
    return faults + _claims_faults(study, source) + _hard_case_faults(study, source)


def check_plane(parameters: Parameters, x: Span, y: Span) -> None:
    """Refuse a map whose parameters are one, or whose corners break a rule.

    Raises:
        ValueError: naming the parameter, its value and its rule.
    """
    if x.parameter == y.parameter:
        raise ValueError(f"{x.parameter!r} is varied twice: x and y must be two parameters")
    for x_value, y_value in itertools.product((x.start, x.stop), (y.start, y.stop)):
        parameters.replace(**{x.parameter: x_value, y.parameter: y_value})


def _plane_faults(study: Study, source: str) -> list[str]:
    faults = []
    for name in study.map_names:
        plane = study.plane(name)
        if isinstance(plane, Map):  # a figure's: checked there
            continue
        own = name == LARGEST_MISALIGNMENT
        place = f"{source}: maps.{name}" if own else f"{source}: maps.planes.{name}"
        varied = {plane.x.parameter, plane.y.parameter}
        if own and varied & {"misalignment", "clearance", "half_width"}:
            faults.append(f"{place}: varies the misalignment or what bounds it")
        faults += [
            f"{place}.held.{held}: is varied in the same map"
            for held in sorted(varied & set(plane.held))
        ]
        try:
            check_plane(study.baseline.replace(**plane.held), plane.x, plane.y)
        except ValueError as error:
            faults.append(f"{place}: {error}")
    return faults


def _hard_case_faults(study: Study, source: str) -> list[str]:
    faults = []
    for name, case in study.hard_cases.all_cases.items():
        try:
            study.baseline.replace(**case.at)
        except (TypeError, ValueError) as error:
            faults.append(f"{source}: hard_cases.cases.{name}.at: {error}")
    return faults


def _case_faults(study: Study, source: str) -> list[str]:
    faults = []
    for name, case in study.precision.cases.items():
        place = f"{source}: precision.cases.{name}"
        try:
            check_name(case.figure, HISTORIES + CURVES + MAPS, "figure")
            study.case(name)
        except ValueError as error:
            faults.append(f"{place}: {error}")
    return faults


def _claims_faults(study: Study, source: str) -> list[str]:
    faults = []
    for name, run in study.claims_runs.items():
        place = f"{source}: claims_runs.{name}"
        names = {run.family.parameter, run.swept.parameter}
        if len(names) == 1:
            faults.append(f"{place}: {run.swept.parameter!r} is varied twice")
        varied = sorted(names & set(run.held))
        faults += [f"{place}.held.{held}: is varied in the same run" for held in varied]
        try:
            check_name(run.figure, HISTORIES + CURVES + MAPS, "figure")
            parameters = study.claim_parameters(name)
            for part in (run.family, run.swept):
                Batch.of(parameters, **{part.parameter: part.values})
        except ValueError as error:
            faults.append(f"{place}: {error}")
    return faults


def _check_law(study: Study, source: str) -> list[str]:
    """Faults of the accuracy trial's law: the ends of its ranges against the parameters' rules."""
    place, ranges = f"{source}: accuracy.ranges", study.accuracy.ranges
    faults = _value_faults(place, {name: law.low for name, law in ranges.items()})
    faults += _value_faults(place, {name: 0.0 for name, law in ranges.items() if law.zero > 0.0})
    if faults:
        return faults
    # The worst combination of the ends: the farthest start on the narrowest part.
    narrow = {"half_width", "clearance"}
    ends = {name: law.low if name in narrow else law.high for name, law in ranges.items()}
    try:
        study.baseline.replace(**ends)
    except ValueError as error:
        faults.append(f"{place}: {error}")
    return faults


def check_study(mapping: Mapping[str, Any], source: str = "config") -> Study:
    """The study in ``mapping``, checked.

    Raises:
        ConfigError: every fault found, each with the key's path, the value and the rule.
    """
    try:
        study = Study.model_validate(mapping)
    except ValidationError as invalid:
        lines = [_with_hint(_line(source, error), error) for error in invalid.errors()]
        raise ConfigError("\n".join(dict.fromkeys(lines))) from None
    faults = _check_figures(study, source)
    if faults:
        raise ConfigError("\n".join(faults))
    return study


def load_study(path: Path) -> Study:
    """The study in the YAML file ``path``, checked.

    Raises:
        ConfigError: a file that cannot be read, is not YAML, or breaks a rule.
    """
    try:
        mapping = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise ConfigError(f"{path}: cannot be read as YAML: {error}") from None
    if not isinstance(mapping, dict):
        raise ConfigError(f"{path}: must be a mapping of keys to values")
    return check_study(mapping, str(path))


def study_path() -> Path:
    """config.yaml of the project: beside the sources, or as installed with the package."""
    in_checkout = Path(__file__).resolve().parents[3] / "config" / "config.yaml"
    if in_checkout.is_file():
        return in_checkout
    return Path(str(resources.files("model.study") / "config.yaml"))


def baseline() -> Parameters:
    """The study's device at its default operating point."""
    return load_study(study_path()).baseline
