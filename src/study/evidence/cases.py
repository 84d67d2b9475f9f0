"""Verdicts on the study's device off by a little, under other assumptions, and on other devices."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.sweeps.axes import Plan
from model.sweeps.settings import RunSettings
from model.sweeps.sweep import Sweep
from study.claims.claims import CLAIMS
from study.claims.ledger import VERDICTS
from study.config.evidence import Change
from study.config.identification import Grid
from study.evidence.null import verdicts_of
from study.identification.space import Space, own_values, space_of

if TYPE_CHECKING:
    import xarray as xr

    from study.config.study import Study

KINDS = ("device", "near", "assumption", "other")


class Case(NamedTuple):
    """A device, and what is changed of its runs; ``kind`` is one of ``KINDS``."""

    kind: str
    title: str
    device: dict[str, float]
    change: Change


class CasesPlan(Plan):
    """Cases as data.

    Attributes:
        space: makes sweeps of unknowns.
        own: values of the unknowns of the study's device.
        grid: on which the figures are computed.
        near: number of devices of which every unknown is off.
        step: share of its value by which it is off, up or down.
        seed: of the signs.
        assumptions: by title.
        others: values of the unknowns of further devices, by title.
    """

    space: Space
    own: dict[str, float]
    grid: Grid
    near: int
    step: float
    seed: int
    assumptions: dict[str, Change]
    others: dict[str, dict[str, float]]

    @property
    def cases(self) -> Iterator[Case]:
        """The cases, the study's own first."""
        as_stated, pressed = Change(), Change(settings={"start": "pressed"})
        yield Case("device", "as the study assumes", self.own, as_stated)
        random = np.random.default_rng(self.seed)
        for number in range(self.near):
            signs = random.choice([-1.0, 1.0], len(self.own))
            off = {
                name: value * (1.0 + sign * self.step)
                for (name, value), sign in zip(self.own.items(), signs.tolist(), strict=True)
            }
            inside = self.space.values(self.space.point(off))
            yield Case("near", f"off by {self.step:.0%}, {number + 1}", inside, as_stated)
        for title, change in self.assumptions.items():
            yield Case("assumption", title, self.own, change)
        for title, device in self.others.items():
            yield Case("other", title, device, as_stated)
            yield Case("other", f"{title}, pressed first", device, pressed)


def cases_plan(study: "Study") -> CasesPlan:
    """Return the plan of the cases."""
    spec, space = study.evidence, space_of(study)
    changes = {
        each.title: Change(**each.model_dump(exclude={"title"})) for each in spec.assumptions
    }
    return CasesPlan(
        space=space,
        own=own_values(study, space),
        grid=spec.grid,
        near=spec.near,
        step=spec.step,
        seed=spec.seed,
        assumptions=changes,
        others=spec.others,
    )


def cases_dataset(plan: CasesPlan, random: NDArray[np.int64]) -> "xr.Dataset":
    """Return the verdicts on all cases, over (case, entry).

    Beside them stand the numbers of entries that ``random`` devices show, shape (devices,).
    """
    import xarray as xr  # noqa: PLC0415  (slow)

    cases = [*plan.cases]
    plain = [case for case in cases if case.change == Change()]
    found = iter(verdicts_of(plan.space, [case.device for case in plain], plan.grid))
    rows = [next(found) if c.change == Change() else _changed(plan, c) for c in cases]
    verdict = {
        "long_name": "verdict on the entry",
        "flag_values": np.arange(len(VERDICTS), dtype=np.int8),
        "flag_meanings": " ".join(each.replace(" ", "_") for each in VERDICTS),
    }
    shown = {"units": "1", "long_name": "number of entries that a random device shows"}
    kind = {
        "long_name": "kind of the case",
        "flag_values": np.arange(len(KINDS), dtype=np.int8),
        "flag_meanings": " ".join(KINDS),
    }
    return xr.Dataset(
        {
            "verdict": (("case", "entry"), np.array(rows, np.int8), verdict),
            "kind": ("case", np.array([KINDS.index(c.kind) for c in cases], np.int8), kind),
            "random": ("device", random.astype(np.int8), shown),
        },
        {
            "case": ("case", [c.title for c in cases], {"long_name": "the case in words"}),
            "entry": ("entry", [c.id for c in CLAIMS], {"long_name": "entry of the ledger"}),
            "device": ("device", np.arange(random.size), {"long_name": "random device"}),
        },
        {
            "title": "Verdicts by case",
            "summary": "Verdicts on the entries for the device of the study, for the same off by a "
            "little or under other assumptions, and for other devices.",
            "figure": "cases",
            "config_hash": plan.identity,
        },
    )


def _changed(plan: CasesPlan, case: Case) -> np.ndarray:
    def changed(sweep: Sweep) -> Sweep:
        settings = RunSettings.model_validate(sweep.settings.model_dump() | case.change.settings)
        parameters = sweep.parameters | case.change.held
        return sweep.model_copy(update={"settings": settings, "parameters": parameters})

    return np.asarray(verdicts_of(plan.space, [case.device], plan.grid, changed)[0])
