"""Verdicts on devices drawn at random: the share of them that shows a claim is what it is worth.

Devices are drawn from the priors of the search, or the study's structure is kept and operating
points are drawn, or every unknown of the study is off by a share of its value, up or down.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from model.sweeps.axes import Plan
from model.sweeps.sweep import Sweep
from study.claims.claims import CLAIMS
from study.claims.data import Tables
from study.claims.ledger import VERDICTS, judge
from study.config.evidence import Drawing
from study.config.identification import Grid
from study.identification.candidates import tables_of
from study.identification.space import Array, Space, own_values, space_of

if TYPE_CHECKING:
    import xarray as xr

    from study.config.study import Study

Verdicts = NDArray[np.int8]
REPRODUCED = VERDICTS.index("reproduced")
VERDICT = {
    "long_name": "verdict on the claim",
    "flag_values": np.arange(len(VERDICTS), dtype=np.int8),
    "flag_meanings": " ".join(verdict.replace(" ", "_") for verdict in VERDICTS),
}
_DRAW = {"units": "1", "long_name": "number of the draw"}
CLAIM = {"long_name": "claim of the paper, by its identifier"}


class NullPlan(Plan):
    """Random draws of one kind as data.

    Attributes:
        space: unknowns and their priors.
        own: values of the study's own device, empty where none of them is kept.
        draws: what is drawn.
        grid: on which the figures are computed.
        seed: of the draws, and the number of the kind.
    """

    space: Space
    own: dict[str, float]
    draws: Drawing
    grid: Grid
    seed: tuple[int, int]


def null_plan(study: "Study", kind: str) -> NullPlan:
    """Return the plan of a kind of draws; ``everything`` is drawn whatever the study's device."""
    spec, space = study.evidence, space_of(study)
    draws = spec.draws[kind]
    own = {} if draws.drawn == "everything" else own_values(study, space)
    seed = spec.seed, [*spec.draws].index(kind)
    drawing = Drawing(**draws.model_dump(exclude={"title"}))
    return NullPlan(space=space, own=own, draws=drawing, grid=spec.grid, seed=seed)


def drawn(plan: NullPlan) -> Array:
    """Return the coordinates of all draws, shape (count, unknowns)."""
    space, draws = plan.space, plan.draws
    points = np.random.default_rng(plan.seed).random((draws.count, len(space.names)))
    if draws.drawn == "signs":
        up = {name: value * (1.0 + draws.step) for name, value in plan.own.items()}
        own = space.point(plan.own)
        step = space.point(up) - own
        return np.clip(own + np.where(points < 0.5, -step, step), 0.0, 1.0)
    if draws.drawn == "operating points":
        structure = space.places["structure"]
        points[:, structure] = space.point(plan.own)[structure]
    return points


def part_of(plan: NullPlan, part: int) -> "xr.Dataset":
    """Return the verdicts on the draws of one part, over (draw, claim)."""
    import xarray as xr  # noqa: PLC0415  (slow)

    rows = np.array_split(np.arange(plan.draws.count), plan.draws.parts)[part]
    values = [plan.space.values(point) for point in drawn(plan)[rows]]
    verdicts = verdicts_of(tables_at(plan.space, values, plan.grid), len(rows))
    return xr.Dataset(
        {"verdict": (("draw", "claim"), verdicts, VERDICT)},
        {
            "draw": ("draw", rows, _DRAW),
            "claim": ("claim", [claim.id for claim in CLAIMS], CLAIM),
        },
        {
            "title": "A part of the verdicts on random devices",
            "summary": "Verdicts on some of the devices that are drawn at random, of one kind.",
            "figure": "null",
            "config_hash": plan.identity,
        },
    )


def tables_at(
    space: Space,
    devices: Sequence[Mapping[str, float]],
    grid: Grid,
    changed: Callable[[Sweep], Sweep] = lambda sweep: sweep,
) -> Tables:
    """Return the tables of devices, given by the values of their unknowns, with all figures.

    Every sweep is passed through ``changed``.
    """
    frames: dict[str, pd.DataFrame] = {}
    for figure in space.figures:
        names = space.of_figure(figure, grid)
        sweeps = [[changed(space.sweep(each, n, grid)) for n in names] for each in devices]
        frames |= tables_of(sweeps, space.figures).frames
    return Tables(frames)


def verdicts_of(tables: Tables, devices: int) -> Verdicts:
    """Return the verdicts on the devices of tables as places in ``VERDICTS``, (devices, claims)."""
    judged = [[found.verdict for _, found in judge(tables.at(row))] for row in range(devices)]
    return np.array([[VERDICTS.index(each) for each in row] for row in judged], dtype=np.int8)


def merged(
    plans: Mapping[str, NullPlan], titles: Sequence[str], parts: Sequence["xr.Dataset"]
) -> "xr.Dataset":
    """Return the dataset of all draws, with the share of each kind that shows a claim.

    Args:
        plans: of the kinds, by name.
        titles: what is drawn, in words, by kind.
        parts: in the order of the plans.

    Raises:
        ValueError: parts that are not those of the plans.
    """
    import xarray as xr  # noqa: PLC0415  (slow)

    kinds, wanted = (
        [*plans],
        [(p.identity, n) for p in plans.values() for n in range(p.draws.count)],
    )
    found = [(part.attrs["config_hash"], n) for part in parts for n in part["draw"].values.tolist()]
    if found != wanted:
        raise ValueError("the parts are not those of the plan: delete them and build them again")
    verdicts = np.concatenate([part["verdict"].values for part in parts])
    of_draw = np.repeat(np.arange(len(kinds)), [p.draws.count for p in plans.values()])
    shares = [(verdicts[of_draw == row] == REPRODUCED).mean(axis=0) for row in range(len(kinds))]
    share = {"units": "1", "long_name": "share of the draws of a kind that reproduce the claim"}
    kind_of_draw = {
        "long_name": "kind of the draw",
        "flag_values": np.arange(len(kinds), dtype=np.int8),
        "flag_meanings": " ".join(kinds),
    }
    return xr.Dataset(
        {
            "verdict": (("draw", "claim"), verdicts, VERDICT),
            "share": (("kind", "claim"), np.array(shares), share),
            "title": ("kind", [*titles], {"long_name": "what is drawn, in words"}),
        },
        {
            "kind": ("kind", kinds, {"long_name": "kind of draws"}),
            "claim": ("claim", parts[0]["claim"].values, CLAIM),
            "draw": ("draw", np.arange(len(verdicts)), _DRAW),
            "kind_of_draw": ("draw", of_draw.astype(np.int8), kind_of_draw),
        },
        {
            "title": "What random devices show of the claims",
            "summary": "Verdicts on devices that are drawn at random, and the shares that "
            "reproduce each claim.",
            "figure": "null",
        },
    )
