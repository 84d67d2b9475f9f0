"""Verdicts on the study's device off by a little, under other assumptions, and on other devices."""

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.sweeps.axes import Plan
from model.sweeps.settings import RunSettings
from model.sweeps.sweep import Sweep
from study.claims.claims import CLAIMS
from study.claims.ledger import VERDICTS
from study.config.evidence import Evidence
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
    settings: Mapping[str, Any] = MappingProxyType({})
    held: Mapping[str, float] = MappingProxyType({})

    @property
    def changes(self) -> bool:
        """True if its runs differ from the study's but for the device."""
        return bool(self.settings or self.held)


class CasesPlan(Plan):
    """Cases as data.

    Attributes:
        space: makes sweeps of unknowns.
        own: values of the unknowns of the study's device.
        stated: grid, assumptions and other devices.
    """

    space: Space
    own: dict[str, float]
    stated: Evidence

    @property
    def cases(self) -> Iterator[Case]:
        """The cases, the study's own first."""
        stated = self.stated
        yield Case("device", "as the study assumes", self.own)
        random = np.random.default_rng(stated.seed)
        for number in range(stated.near):
            signs = random.choice([-1.0, 1.0], len(self.own))
            off = {
                name: value * (1.0 + sign * stated.step)
                for (name, value), sign in zip(self.own.items(), signs.tolist(), strict=True)
            }
            inside = self.space.values(self.space.point(off))
            yield Case("near", f"off by {stated.step:.0%}, {number + 1}", inside)
        for each in stated.assumptions:
            yield Case("assumption", each.title, self.own, each.settings, each.held)
        for title, device in stated.others.items():
            yield Case("other", title, device)
            yield Case("other", f"{title}, pressed first", device, {"start": "pressed"})


def cases_plan(study: "Study") -> CasesPlan:
    """Return the plan of the cases."""
    space = space_of(study)
    return CasesPlan(space=space, own=own_values(study, space), stated=study.evidence)


def cases_dataset(plan: CasesPlan, random: NDArray[np.int64]) -> "xr.Dataset":
    """Return the verdicts on all cases, over (case, entry).

    Beside them stand the numbers of entries that ``random`` devices show, shape (devices,).
    """
    import xarray as xr  # noqa: PLC0415  (slow)

    cases = [*plan.cases]
    plain = [case.device for case in cases if not case.changes]
    found = iter(verdicts_of(plan.space, plain, plan.stated.grid))
    rows = [_changed(plan, case) if case.changes else next(found) for case in cases]
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
        settings = RunSettings.model_validate({**sweep.settings.model_dump(), **case.settings})
        parameters = {**sweep.parameters, **case.held}
        return sweep.model_copy(update={"settings": settings, "parameters": parameters})

    return np.asarray(verdicts_of(plan.space, [case.device], plan.stated.grid, changed)[0])
