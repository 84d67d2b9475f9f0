"""Verdicts of random devices, which are stored beside this module.

Nobody searched for these devices. Drawing and judging them takes minutes, so that it is done once
for priors, list, physics and grid, by ``make null``; the key of these four stands in the file.
"""

import ast
import hashlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.events import event_functions, friction, steady_state, table, transitions
from model.physics import contacts, forces, geometry, modes, motion, rest
from model.sweeps.axes import Plan
from model.sweeps.sweep import Sweep
from study.claims import checks, data, locked, measures
from study.claims.claims import CLAIMS
from study.claims.data import Figures
from study.claims.ledger import VERDICTS, judge
from study.config.identification import Grid
from study.identification.batch import figures_of
from study.identification.space import Space, space_of
from study.outline import outline

if TYPE_CHECKING:
    from study.config.study import Study

Verdicts = NDArray[np.int8]
FILE = Path(__file__).with_name("null.csv")
SHOWN = VERDICTS.index("shown")
_SIGNS = "+-?"  # of the verdicts, in their order
_PART = 10  # devices that are run together
_PHYSICS = (
    geometry, contacts, forces, modes, motion, rest,
    event_functions, friction, steady_state, table, transitions,
)  # fmt: skip
_MEND = "draw the random devices anew: make null"


class Null(NamedTuple):
    """Verdicts of random devices as places in ``VERDICTS``, shape (devices, entries)."""

    verdicts: Verdicts

    @property
    def counts(self) -> NDArray[np.int64]:
        """Number of entries that each device shows, shape (devices,)."""
        return np.asarray((self.verdicts == SHOWN).sum(axis=1))

    @property
    def shares(self) -> dict[str, float]:
        """Share of the devices that shows an entry, by entry."""
        shares = (self.verdicts == SHOWN).mean(axis=0).tolist()
        return dict(zip((claim.id for claim in CLAIMS), shares, strict=True))


class NullPlan(Plan):
    """Random devices as data.

    Attributes:
        space: unknowns and their priors.
        grid: on which the figures are computed.
        seed: of the draws.
        count: number of devices.
    """

    space: Space
    grid: Grid
    seed: int
    count: int

    @property
    def devices(self) -> list[dict[str, float]]:
        """Values of the unknowns of each device."""
        size = self.count, len(self.space.names)
        return [self.space.values(p) for p in np.random.default_rng(self.seed).random(size)]

    @property
    def key(self) -> str:
        """Hash of priors, list, physics and grid, the same under every version of Python."""
        middle = self.space.values(np.full(len(self.space.names), 0.5))
        axes = [
            (name, each.parameter, each.values)
            for name in self.space.figures
            for each in self.space.sweep(middle, name, self.grid).dimensions
        ]
        limits = [
            (claim.id, claim.figures, part, limit.threshold, limit.is_least)
            for claim in CLAIMS
            for part, limit in claim.limits.items()
        ]
        settings = self.space.settings
        priors = self.space.problem.model_dump_json(include={"structure", "operating_points"})
        grid = axes, self.grid.horizon, self.grid.tolerance, settings.start, settings.readings
        parts = priors, sorted(self.space.fixed.items()), grid, limits, _code()
        return hashlib.sha256(repr((*parts, self.seed, self.count)).encode()).hexdigest()[:16]


def _code() -> list[str]:
    """Return what checks and equations say, without comments, docstrings or layout."""
    modules = (checks, data, locked, measures, *_PHYSICS)
    files = [Path(str(each.__file__)) for each in modules]
    trees = (ast.parse(file.read_text(encoding="utf-8")) for file in files)
    return [repr(outline(tree, [])) for tree in trees]


def null_plan(study: "Study") -> NullPlan:
    """Return the plan of the random devices."""
    spec = study.evidence
    return NullPlan(space=space_of(study), grid=spec.grid, seed=spec.seed, count=spec.random)


def verdicts_of(
    space: Space,
    devices: Sequence[Mapping[str, float]],
    grid: Grid,
    changed: Callable[[Sweep], Sweep] = lambda sweep: sweep,
) -> Verdicts:
    """Return the verdicts on devices, given by the values of their unknowns, (devices, entries).

    Every sweep is passed through ``changed``.
    """
    rows = []
    for first in range(0, len(devices), _PART):
        part = devices[first : first + _PART]
        sweeps = [[changed(space.sweep(d, n, grid)) for n in space.figures] for d in part]
        settings = sweeps[0][0].settings.settings
        for figures in figures_of(sweeps):
            whole: Figures = {**figures, "locked": locked.locked_of(figures, settings)}
            rows.append([VERDICTS.index(found.verdict) for _, found in judge(whole)])
    return np.array(rows, dtype=np.int8)


def null_text(plan: NullPlan) -> str:
    """Draw and judge the devices; return the file: the key, and a line of signs by entry."""
    verdicts = verdicts_of(plan.space, plan.devices, plan.grid)
    lines = [
        f"{claim.id},{''.join(_SIGNS[place] for place in column)}"
        for claim, column in zip(CLAIMS, verdicts.T, strict=True)
    ]
    return "\n".join([f"key,{plan.key}", *lines, ""])


def stored_null(plan: NullPlan, file: Path = FILE) -> Null:
    """Return the stored verdicts.

    Raises:
        ValueError: there are none, or their key is another; the message names the command.
    """
    try:
        lines = file.read_text(encoding="utf-8").splitlines()
        rows = dict(line.split(",") for line in lines)
        key = rows.pop("key")
        found = {name: [_SIGNS.index(sign) for sign in row] for name, row in rows.items()}
    except (OSError, KeyError, ValueError) as error:
        raise ValueError(
            f"{file}: holds no verdicts of random devices ({error}); {_MEND}"
        ) from None
    if key != plan.key or [*found] != [claim.id for claim in CLAIMS]:
        raise ValueError(f"{file.name}: is of other priors, another list, physics or grid; {_MEND}")
    return Null(np.array([*found.values()], dtype=np.int8).T)
